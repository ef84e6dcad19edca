/* Numerical stability: cases at the edge of what numbers can say, each with what must hold there, in one
 * table (extreme_cases.c).
 *
 *   a case is a row: its kind, its name, what must hold, a function and what that is to make
 *   extreme_run(kind, quick, told, ctx)     runs the cases of a kind one after the other and tells each;
 *                                           returns how many failed
 *
 * `ecobench --extreme` runs all of them, tests/bench/test_extreme.c those that are not marked `lengthy`. A
 * case that cannot run has failed. */
#ifndef TESTS_BENCH_EXTREME_H
#define TESTS_BENCH_EXTREME_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

struct extreme {                     /* a case while it runs */
	const void *made;            /* what the row names */
	bool quick;                  /* in the tests: fewer repetitions of the same */
	bool failed;
	/* what was found, in words; where it failed, what failed first comes first */
	char measured[400];
};

enum extreme_kind { EXTREME_PLACE, EXTREME_CAMERA, EXTREME_STIFF, EXTREME_GEOMETRY, EXTREME_QUANTIZATION,
	EXTREME_TIME, EXTREME_KINDS };
extern const char *const extreme_kind_names[EXTREME_KINDS];

struct extreme_case {
	enum extreme_kind kind;
	const char *name, *must;
	void (*run)(struct extreme *x);
	const void *made;            /* NULL where `run` makes one thing only */
	bool lengthy;                /* seconds, or much memory */
};
#define EXTREME_CASES 57u
extern const struct extreme_case extreme_cases[EXTREME_CASES];

/* Adds to what was measured. */
void extreme_say(struct extreme *x, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* A condition that must hold, and what to say if it does not; returns `holds`. */
bool extreme_must(struct extreme *x, bool holds, const char *format,
	...) __attribute__((format(printf, 3, 4)));
/* An answer that must be ECO_OK. */
bool extreme_good(struct extreme *x, enum eco_code code, const struct eco_error *error);

/* `told` hears of each case, also of those that were left to the bench (measured empty, not failed): then
 * `ran` is false. */
typedef void extreme_told(void *ctx, const struct extreme_case *row, const struct extreme *x, bool ran);
uint32_t extreme_run(enum extreme_kind kind, bool quick, extreme_told *told, void *ctx);

#endif
