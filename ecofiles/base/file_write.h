/* Files that appear complete or not at all. */
#ifndef ECO_FILE_WRITE_H
#define ECO_FILE_WRITE_H

#include <stddef.h>

#include "ecofiles/base/status.h"

/* Writes path.tmp-PID, then renames it. */
enum eco_code eco_file_write(const char *path, const void *bytes, size_t size, struct eco_error *error);

/* All that was written to the folder's file system is on the disk: one wait for any number of files. */
enum eco_code eco_folder_sync(const char *path, struct eco_error *error);

#endif
