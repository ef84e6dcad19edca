/* The extreme cases that take little time. Each case is told; see tests/bench/extreme/extreme.h. */
#include "tests/bench/extreme/extreme.h"
#include "tests/support/unit_test.h"

static void tell(void *ctx, const char *kind, const struct extreme_case *row, const struct extreme *x,
	bool ran)
{
	++*(uint32_t *)ctx;
	print_message("          %s%s, %s: %s\n", x->failed ? "FAILED: " : "", kind, row->name,
		ran ? x->measured : "in ecobench --only extreme only");
}

UNIT_TEST(extreme_cases_hold)
{
	uint32_t failed = 0, told = 0;
	for (uint32_t k = 0; k < EXTREME_KINDS; k++)
		failed += extreme_run(&extreme_kinds[k], true, tell, &told);
	assert_int_equal(failed, 0);
	assert_int_equal(told, EXTREME_CASES);
}
