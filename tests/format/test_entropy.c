/* The replacement of Draco's count of symbols gives Draco's result to the bit, so that streams are the same.
 */
#include "tests/support/unit_test.h"

/* As the linker names them (--wrap in the Makefile): Draco's own, and ours. */
int64_t draco_own(const uint32_t *symbols, int count, int largest, int *unique)
	__asm__("__real__ZN5draco21ComputeShannonEntropyEPKjiiPi");
int64_t draco_ours(const uint32_t *symbols, int count, int largest, int *unique)
	__asm__("__wrap__ZN5draco21ComputeShannonEntropyEPKjiiPi");

static uint32_t next_random(uint64_t *state)
{
	*state = *state * 6364136223846793005u + 1442695040888963407u;
	return (uint32_t)(*state >> 33);
}

UNIT_TEST(sparse_symbols_weigh_what_they_do_in_draco)
{
	static uint32_t symbols[5000];
	uint64_t random = 7;
	for (int round = 0; round < 400; round++) {
		int count = 1 + (int)(next_random(&random) % (round % 4 == 0 ? 5000u : 40u)), largest = 0,
			own_unique = -1, our_unique = -2;
		uint32_t range = 1u << (next_random(&random) % 21), step = 1 + next_random(&random) % 3;
		for (int i = 0; i < count; i++) {
			symbols[i] = next_random(&random) % range / step * step;
			largest = (int)symbols[i] > largest ? (int)symbols[i] : largest;
		}
		assert_int_equal(draco_ours(symbols, count, largest, &our_unique),
			draco_own(symbols, count, largest, &own_unique));
		assert_int_equal(our_unique, own_unique);
		assert_int_equal(draco_ours(symbols, count, largest, NULL),
			draco_own(symbols, count, largest, NULL));
	}
}
