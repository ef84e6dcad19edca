/* Numerical stability: cases at the edge of what numbers can say, each with what must hold there, told in one table.
 *
 *   a family is a file bench_extreme_NAME.c with one `const struct extreme_family`; a case is a row {name, what must hold, function}
 *   extreme_run(family, quick, told, ctx)     runs the cases one after the other and tells each; returns how many failed
 *
 * `ecobench --extreme` runs all of them, tests/bench/test_extreme.c those that are not marked `lengthy`. A case that cannot run has failed. */
#ifndef TESTS_BENCH_EXTREME_H
#define TESTS_BENCH_EXTREME_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

struct extreme {                     /* a case while it runs */
	bool quick;                  /* in the tests: fewer repetitions of the same */
	bool failed;
	char measured[400];          /* what was found, in words; where it failed, what failed first comes first */
};

struct extreme_case {
	const char *name, *must;
	bool lengthy;                /* seconds, or much memory */
	void (*run)(struct extreme *x);
};

struct extreme_family {
	const char *name;
	const struct extreme_case *cases;
	uint32_t count;
};

extern const struct extreme_family *const extreme_families[];        /* ends with NULL */

/* Adds to what was measured. */
void extreme_say(struct extreme *x, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* What must hold, and what to say where it does not; returns `holds`. */
bool extreme_must(struct extreme *x, bool holds, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* An answer that must be ECO_OK. */
bool extreme_good(struct extreme *x, enum eco_code code, const struct eco_error *error);

/* `told` hears of each case, also of those that were left to the bench (measured empty, not failed): then `ran` is false. */
typedef void extreme_told(void *ctx, const struct extreme_family *family, const struct extreme_case *row, const struct extreme *x, bool ran);
uint32_t extreme_run(const struct extreme_family *family, bool quick, extreme_told *told, void *ctx);

#endif
