/* Files that are written whole or not at all, and private copies. */
#pragma once

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

/* Outputs are written beside their place, as PATH.tmp-PID, and renamed when they are whole. A process that is
 * killed leaves one; the next that writes the same file removes it, unless a process still writes it: the
 * writer holds the lock of its file, which the system lets go of however the process dies. */

/* Whether `name` is that of an unfinished file of `of`: "OF.tmp-4711". */
bool eco_unfinished_is(const char *name, const char *of);

/* Locks what was just made. False: another process took it for left over and removed it, so make it again. A
 * file system without locks is no failure: nobody removes anything there. */
bool eco_unfinished_lock(int file);

/* Removes files of that name in a folder that no process writes. */
void eco_unfinished_remove_file(int folder, const char *name);
/* Removes unfinished files of `path`. */
void eco_unfinished_remove(const char *path);
/* Removes a folder that this process made, with all in it. */
void eco_folder_remove(const char *path);

/* Writes path.tmp-PID, then renames it: a file that appears complete or not at all. */
enum eco_code eco_file_write(const char *path, const void *bytes, size_t size, struct eco_error *error);

/* Reads a whole file, or a pipe, of at most `most` bytes, followed by a 0 that *size does not count. *bytes
 * is malloc'ed; NULL on failure. */
enum eco_code eco_file_read(const char *path, uint64_t most, uint8_t **bytes, size_t *size,
	struct eco_error *error);

/* All that was written to the folder's file system is on the disk: one wait for any number of files. */
enum eco_code eco_folder_sync(const char *path, struct eco_error *error);

/* Opens a new file without a name in `folder`, for reading and writing; -1: errno says why. */
int eco_file_nameless(const char *folder);

/* A file that nobody else can change: a copy without a name, which ends with its last descriptor or
 * mapping.
 *
 *   eco_private_copy(&copy, file, "forest.eco", "/var/tmp", NULL, &error);
 *   map = mmap(NULL, size, PROT_READ, MAP_SHARED, copy, 0); close(copy);
 *
 * It takes as much room in `folder` as the file has, none where that file system shares blocks (FICLONE:
 * btrfs, XFS). Copying needs no memory. */

/* Copies the regular file open as `file` from its beginning. `name` is for messages. The caller closes
 * *copy, which is -1 on failure. ECO_BAD_INPUT: the file changed its size meanwhile. ECO_IO: no room, or
 * no such folder; the text says which. ECO_INTERRUPTED: *cancelled was set; NULL: it never is. */
enum eco_code eco_private_copy(int *copy, int file, const char *name, const char *folder,
	const atomic_bool *cancelled, struct eco_error *error);
