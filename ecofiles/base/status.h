/* Status and error text: what was wrong, where, and what to do.
 *
 * Every fallible function returns an eco_code and takes a struct eco_error (may be NULL). The first
 * failure writes the text; later ones on the way out do not overwrite it. A bug is an assert (kept in
 * release); bad input is a status. */
#pragma once

#include <stdint.h>

/* An index that names nothing. */
#define ECO_NONE UINT32_MAX

enum eco_code {
	ECO_OK = 0,
	ECO_BAD_USAGE,     /* a command line that makes no sense: exit 2 */
	ECO_BAD_INPUT,     /* a file or request that says something impossible */
	ECO_DAMAGED,       /* a hash, count or bound does not hold */
	ECO_TOO_LARGE,     /* beyond a stated limit */
	ECO_UNSUPPORTED,   /* understood, but not handled: the text names it */
	ECO_NOT_FOUND,
	ECO_IO,            /* the operating system refused; the text carries strerror */
	ECO_NO_MEMORY,
	ECO_INTERRUPTED,
	ECO_CODE_COUNT
};

struct eco_error {
	enum eco_code code;
	char text[1024];   /* what does not fit is left out after a whole word, for " ..." */
};

/* Records `code` and the formatted text in `error` unless it already holds a failure; returns `code`
 * always, so that `return eco_fail(error, ECO_BAD_INPUT, "...")` reads well. `error` may be NULL. */
enum eco_code eco_fail(struct eco_error *error, enum eco_code code, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

/* Passes a failure on: where the call fails, the function that calls it returns its code. */
#define ECO_PASS(call) \
	do { \
		enum eco_code passed_ = (call); \
		if (passed_) \
			return passed_; \
	} while (0)

/* ECO_NO_MEMORY: "no memory for " what. */
enum eco_code eco_no_memory(struct eco_error *error, const char *what);

/* As eco_fail, of a path that the system refused to read or to write for `reason` (an errno): with what the
 * system says and what to do. The code is ECO_NOT_FOUND for a file to read that is not there, else ECO_IO. */
enum eco_code eco_fail_read(struct eco_error *error, const char *path, int reason);
enum eco_code eco_fail_write(struct eco_error *error, const char *path, int reason);
/* Advice about `reason`, after "; ", or "" if there is none. */
const char *eco_advice_read(int reason);
const char *eco_advice_write(int reason);

/* A short lower-case name of the code, such as "damaged"; never NULL. */
const char *eco_code_name(enum eco_code code);

/* Exit status of a program that ends with `code`: 0, 1 or 2 (usage). */
int eco_exit_status(enum eco_code code);
