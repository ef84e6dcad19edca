/* What is planned with: extreme budgets and curves. */
#include "tests/extreme_test.h"

extern const struct extreme_family extreme_stiff;

int main(void)
{
	return extreme_test((const struct extreme_family *const[]){ &extreme_stiff }, 1);
}
