/* Confines a process to files below some folders, for reading or for writing, and what its
 * own libraries need. For programs that read what strangers wrote (a VRT, a CSV or a glTF may name any
 * file that the user may read), and for those that strangers talk to.
 *
 *   static const char *const in[] = { "/srv/in", NULL }, *const out[] = { "/srv/out", NULL };
 *   code = eco_confine(&(struct eco_confined_paths){ .readable = in, .writable = out }, &error);
 *
 * By Landlock, for the calling thread and for the threads and children that it starts afterwards: call it
 * before any. It cannot be undone. Once a program is confined, children of guard.h may not even read what
 * is writable, and refuse to run without their filter. */
#pragma once

#include <stdbool.h>

#include "ecofiles/base/status.h"

/* Folders or files that exist, lists that end with NULL; lists and strings must live as long as the
 * process. What is writable may be read, too. */
struct eco_confined_paths {
	const char *const *readable, *const *writable;   /* NULL: none */
	bool without_libraries;          /* all are loaded: not even the system's folders may be read */
};

/* ECO_UNSUPPORTED: this kernel has no Landlock, and nothing is confined. ECO_NOT_FOUND names a path that
 * is not there. */
enum eco_code eco_confine(const struct eco_confined_paths *paths, struct eco_error *error);
/* In a child of a confined program: from now on it reads what is readable and writes nothing. True where
 * the program is not confined. */
bool eco_confine_child(void);
bool eco_is_confined(void);
/* Links followed, below one of the readable paths, or not there; true where the program is not confined.
 * For a clear message, not for safety. */
bool eco_confined_may_read(const char *path);

/* The child of guard.h, and threads that it starts from now on, may make system calls that read files, use
 * memory and start threads, but write no files, use no network and start no programs: these fail with EPERM.
 * Open files stay open. False where the kernel or a container allows no filters: then only the limits hold. */
bool eco_guard_filter(void);
