#include "tests/support/unit_test.h"

#include <assert.h>

#define TESTS_MAX 100u

static struct CMUnitTest tests[TESTS_MAX];
static unsigned lines[TESTS_MAX];
static unsigned count;

/* The order in which constructors run is the compiler's. */
void unit_test_add(const struct CMUnitTest *test, unsigned line)
{
	assert(count < TESTS_MAX);
	unsigned at = count++;
	for (; at && lines[at - 1] > line; at--) {
		tests[at] = tests[at - 1];
		lines[at] = lines[at - 1];
	}
	tests[at] = *test;
	lines[at] = line;
}

int unit_tests_run(CMFixtureFunction set_up, CMFixtureFunction tear_down)
{
	return _cmocka_run_group_tests("tests", tests, count, set_up, tear_down);
}
