/* Arrays that grow: what is in them stays, and what cannot be had leaves them as they were. */

#include "ecofiles/base/array_grow.h"
#include "tests/support/unit_test.h"

UNIT_TEST(what_cannot_be_had_leaves_the_array_alone)
{
	static const struct { uint32_t capacity; size_t size; } rows[] = { { 1u << 31, 1 }, { UINT32_MAX, 1 },
		{ 1u << 30, SIZE_MAX >> 33 } };
	char byte, *items = &byte;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		uint32_t capacity = rows[i].capacity;
		if (i == 2)
			items = NULL;
		assert_false(eco_array_grow(&items, &capacity, capacity, rows[i].size));
		assert_int_equal(capacity, rows[i].capacity);
		assert_ptr_equal(items, i == 2 ? NULL : &byte);
	}
}
