/* The extreme cases that take little time, as tests. Each case is told. See tests/bench/bench_extreme.h. */
#ifndef TESTS_EXTREME_TEST_H
#define TESTS_EXTREME_TEST_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/bench/bench_extreme.h"

static inline void extreme_tell(void *ctx, const struct extreme_family *family, const struct extreme_case *row, const struct extreme *x, bool ran)
{
	(void)ctx;
	if (!ran)
		print_message("          %s, %s: in ecobench --extreme only\n", family->name, row->name);
	else
		print_message("          %s%s, %s: %s\n", x->failed ? "FAILED: " : "", family->name, row->name, x->measured);
}

/* How many of a family's quick cases do not hold. */
static inline uint32_t extreme_failed(const struct extreme_family *family)
{
	return extreme_run(family, true, extreme_tell, NULL);
}

#endif
