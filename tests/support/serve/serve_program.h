/* The program ecoserve, as a process of its own. */
#pragma once

#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>

#define PROGRAM_SAYS 8192

extern char program_path[PATH_MAX];      /* empty: it has not been built */
/* Beside the folder that the running test lies in. */
void program_find(void);

/* From now on this process starts it within its sandbox, in sanitizer builds, too: there leaks are not looked
 * for at its end, which the sandbox does not allow. */
void program_sandboxed(void);

struct program {
	pid_t pid;
	int out_fd, err_fd;
	uint16_t port;
	char line[256];                  /* its first, which says that it is ready */
	char out[PROGRAM_SAYS], err[PROGRAM_SAYS];       /* what it said afterwards, once it has ended */
};
/* Skips the test if the program has not been built. `arguments` end with NULL; `prepare` (or NULL) is called
 * in the child, before the program is. However the test ends, the program does not outlive it. */
struct program program_start(const char *const *arguments, void (*prepare)(void));
/* Reads the line that says it is ready, byte by byte; false: it ended. */
bool program_ready(struct program *program);
/* Both; it must become ready. */
struct program program_serve(const char *const *arguments, void (*prepare)(void));
/* Waits for its end; its exit status, or -1. */
int program_finish(struct program *program);
/* Asks it to end, by SIGTERM; it must end well. */
void program_stop(struct program *program);
/* Runs it to its end: it must have this status and say so on stderr, and nothing on stdout. */
void program_fails(const char *const *arguments, int status, const char *says);
