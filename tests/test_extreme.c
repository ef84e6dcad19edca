/* The extreme cases that take little time: see tests/bench/bench_extreme.h. One test a family; each case is told. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/bench/bench_extreme.h"

static void tell(void *ctx, const struct extreme_family *family, const struct extreme_case *row, const struct extreme *x, bool ran)
{
	(void)ctx;
	if (!ran)
		print_message("          %s, %s: in ecobench --extreme only\n", family->name, row->name);
	else
		print_message("          %s%s, %s: %s\n", x->failed ? "FAILED: " : "", family->name, row->name, x->measured);
}

static void every_case_holds(void **state)
{
	assert_int_equal(extreme_run(*state, true, tell, NULL), 0);
}

int main(void)
{
	struct CMUnitTest tests[16];
	size_t count = 0;
	for (const struct extreme_family *const *f = extreme_families; *f; f++)
		tests[count++] = (struct CMUnitTest){ (*f)->name, every_case_holds, NULL, NULL, (void *)*f };
	return _cmocka_run_group_tests("extreme", tests, count, NULL, NULL);
}
