/* Files that appear complete or not at all. */
#ifndef ECO_FILE_WRITE_H
#define ECO_FILE_WRITE_H

#include <stddef.h>

#include "ecofiles/base/status.h"

/* Writes path.tmp-PID, then renames it. */
enum eco_code eco_file_write(const char *path, const void *bytes, size_t size, struct eco_error *error);

#endif
