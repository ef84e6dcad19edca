/* A file that nobody else can change: a copy without a name, which ends with its last descriptor or
 * mapping.
 *
 *   eco_private_copy(&copy, file, "forest.eco", "/var/tmp", NULL, &error);
 *   map = mmap(NULL, size, PROT_READ, MAP_SHARED, copy, 0); close(copy);
 *
 * It takes as much room in `folder` as the file has, none where that file system shares blocks (FICLONE:
 * btrfs, XFS). Copying needs no memory. */
#ifndef ECO_PRIVATE_COPY_H
#define ECO_PRIVATE_COPY_H

#include <stdatomic.h>
#include <stdbool.h>

#include "ecofiles/base/status.h"

/* Copies the regular file open as `file` from its beginning. `name` is for messages. The caller closes
 * *copy, which is -1 on failure. ECO_BAD_INPUT: the file changed its size meanwhile. ECO_IO: no room, or
 * no such folder; the text says which. ECO_INTERRUPTED: *cancelled was set; NULL: it never is. */
enum eco_code eco_private_copy(int *copy, int file, const char *name, const char *folder,
	const atomic_bool *cancelled, struct eco_error *error);

#endif
