/* Numerical stability: cases at the edge of what numbers can say, each with what must hold there.
 *
 *   a case is a row of its kind's table (extreme_KIND.c): name, what must hold, a function and what that is
 * to make
 *   extreme_run(row, quick, &x)             runs it: x.failed, and x.measured in words
 *
 * `ecobench --only extreme` runs all of them, tests/bench/test_extreme.c those that are not marked `lengthy`.
 * A case that cannot run has failed. */
#pragma once

#include <setjmp.h>
#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

struct extreme {                     /* a case while it runs */
	const void *made;            /* what the row names */
	bool quick;                  /* in the tests: fewer repetitions of the same */
	bool failed;
	/* result in words; the failure only, if there is one */
	char measured[400];
	struct eco_error error;      /* that functions fail to */
	jmp_buf failure;
};

struct extreme_case {
	const char *name, *must;
	void (*run)(struct extreme *x);
	const void *made;            /* NULL where `run` makes one thing only */
	bool lengthy;                /* seconds, or much memory */
};
#define EXTREME_CASE(name, must, run) { name, must, run, NULL, false }
/* Tables end with a case without a name. */
extern const struct extreme_case extreme_place[], extreme_camera[], extreme_stiff[], extreme_geometry[],
	extreme_quantization[], extreme_time[];
struct extreme_kind { const char *name; const struct extreme_case *cases; };
#define EXTREME_KINDS 6u
extern const struct extreme_kind extreme_kinds[EXTREME_KINDS];
#define EXTREME_CASES 56u

void extreme_run(const struct extreme_case *row, bool quick, struct extreme *x);

/* Adds to `measured`. */
void extreme_say(struct extreme *x, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* A condition that must hold, and what to say if it does not: then the case ends as failed. */
void extreme_must(struct extreme *x, bool holds, const char *format,
	...) __attribute__((format(printf, 3, 4)));
/* A number that must be at most, at least, or equal to another; `what` names it. */
void extreme_most(struct extreme *x, const char *what, double value, double most);
void extreme_least(struct extreme *x, const char *what, double value, double least);
void extreme_same(struct extreme *x, const char *what, uint64_t value, uint64_t expected);
/* An answer that must be ECO_OK; x->error says why it is not. */
void extreme_good(struct extreme *x, enum eco_code code);
