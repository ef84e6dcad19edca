/* The extreme cases that take little time. Each case is told; see tests/bench/extreme/extreme.h. */
#include "tests/bench/extreme/extreme.h"
#include "tests/support/unit_test.h"

UNIT_TEST(extreme_cases_hold)
{
	uint32_t failed = 0, told = 0;
	for (uint32_t k = 0; k < EXTREME_KINDS; k++)
		for (const struct extreme_case *row = extreme_kinds[k].cases; row->name; row++, told++) {
			struct extreme x = { .failed = false };
			if (!row->lengthy)
				extreme_run(row, true, &x);
			failed += x.failed;
			print_message("          %s%s, %s: %s\n", x.failed ? "FAILED: " : "",
				extreme_kinds[k].name, row->name,
				row->lengthy ? "in ecobench --only extreme only" : x.measured);
		}
	assert_int_equal(failed, 0);
	assert_int_equal(told, EXTREME_CASES);
}
