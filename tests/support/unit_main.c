/* The main of test programs that have none. */
#include "tests/support/unit_test.h"

int main(void)
{
	return unit_tests_run(NULL, NULL);
}
