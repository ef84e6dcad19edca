/* Files that belong to a program: in the build tree beside its executable, installed where `make install`
 * puts them. Both are looked for from the executable's own folder, so that a tree may be moved. */
#ifndef ECO_DATA_PATH_H
#define ECO_DATA_PATH_H

#include <limits.h>
#include <stdbool.h>

/* Writes to `path` the first of `places` in which `file` is. A place is a path from the executable's folder:
 * "", or "/" and what follows; the last one is followed by NULL. False where it is in none, or /proc is not
 * there. */
bool eco_data_path(const char *const *places, const char *file, char path[PATH_MAX]);

#endif
