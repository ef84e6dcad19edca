/* The extreme cases that take little time, as tests: one a family; each case is told. See tests/bench/bench_extreme.h. */
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

static inline void every_case_holds(void **state)
{
	assert_int_equal(extreme_run(*state, true, extreme_tell, NULL), 0);
}

static inline int extreme_test(const struct extreme_family *const *families, size_t count)
{
	struct CMUnitTest tests[8];
	for (size_t i = 0; i < count; i++)
		tests[i] = (struct CMUnitTest){ families[i]->name, every_case_holds, NULL, NULL, (void *)families[i] };
	return _cmocka_run_group_tests("extreme", tests, count, NULL, NULL);
}

#endif
