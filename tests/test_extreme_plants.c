/* What is built: extreme geometry, and what rounding it to a grid comes to. */
#include "tests/extreme_test.h"

extern const struct extreme_family extreme_geometry, extreme_quantization;

int main(void)
{
	return extreme_test((const struct extreme_family *const[]){ &extreme_geometry, &extreme_quantization }, 2);
}
