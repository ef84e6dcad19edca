/* Outputs are written beside their place, as PATH.tmp-PID, and renamed when they are whole. A process that is
 * killed leaves one; the next that writes there removes it, unless a process still writes it: the writer
 * holds the lock of its file or folder, which the system lets go of however the process dies. */
#ifndef ECO_UNFINISHED_H
#define ECO_UNFINISHED_H

#include <stdbool.h>

/* Whether `name` is that of an unfinished file or folder of `of`: "OF.tmp-4711" or "OF.tmp-4711-payloads". */
bool eco_unfinished_is(const char *name, const char *of);

/* Locks what was just made. False: another process took it for left over and removed it, so make it again. A
 * file system without locks is no failure: nobody removes anything there. */
bool eco_unfinished_lock(int file);

/* Removes files of that name in a folder that no process writes. */
void eco_unfinished_remove_file(int folder, const char *name);
/* Removes what is left of `path`: files, or with `below` folders. These have to hold nothing but files whose
 * names begin with below[0], and folders of files with the names that follow, up to NULL; else they are kept.
 */
void eco_unfinished_remove(const char *path, const char *const *below);
/* Removes such a folder, whoever writes it. */
void eco_unfinished_remove_folder(int folder, const char *name, const char *const *below);

#endif
