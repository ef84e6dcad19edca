/* The program ecoserve, as a process of its own. */
#ifndef TESTS_SERVE_PROGRAM_H
#define TESTS_SERVE_PROGRAM_H

#include <limits.h>
#include <stdint.h>
#include <sys/types.h>

#define PROGRAM_SAYS 8192

extern char program_path[PATH_MAX];      /* empty: it has not been built */
/* Beside the folder that the running test lies in. */
void program_find(void);

/* From now on this process starts it within its sandbox, in sanitizer builds, too: there leaks are not looked
 * for at its end, which the sandbox does not allow. */
void program_sandboxed(void);

struct program { pid_t pid; int out, err; };
/* `arguments` end with NULL. However the test ends, the program does not outlive it. */
struct program program_start(const char *const *arguments);
/* prepare() is called in the child, before the program is. */
struct program program_start_in(const char *const *arguments, void (*prepare)(void));
/* Reads the line that says it is ready, byte by byte, and returns the port; 0: it ended. */
uint16_t program_ready(struct program *program, char line[256]);
/* Waits for its end; its exit status, or -1. */
int program_finish(struct program *program, char out[PROGRAM_SAYS], char err[PROGRAM_SAYS]);

#endif
