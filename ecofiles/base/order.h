/* Orders for qsort and bsearch, and the place in what is ordered. A member is written as it stands behind a pointer:
 *
 *   ECO_ORDER(by_key, struct placed, ->key)          ascending
 *   ECO_ORDER(by_value, float, [0])                  of numbers
 *   ECO_ORDER_FALLING(by_area, struct part, ->area)
 *   ECO_ORDER_TWO(by_run, struct eco_run, ->placement, ->list_first)           ties by the second
 *   ECO_ORDER_FALLING_TWO(by_rows, struct value, ->rows, ->line)               the first falls, the second rises
 *
 *   uint32_t low = 0, high = count;
 *   ECO_LEAST(low, high, i, reach[i] > target)       low: the first i of [low, high) for which that holds, which it does
 *                                                    for all after it; high where it does for none */
#pragma once

#include <stdint.h>

#define ECO_ORDER_BY(name, type, order) \
	static int name(const void *one, const void *two) \
	{ \
		const type *x = one, *y = two; \
		return order; \
	}
#define ECO_RISES(x, y, member) ((x member > y member) - (x member < y member))
#define ECO_ORDER(name, type, member) ECO_ORDER_BY(name, type, ECO_RISES(x, y, member))
#define ECO_ORDER_FALLING(name, type, member) ECO_ORDER_BY(name, type, ECO_RISES(y, x, member))
#define ECO_ORDER_TWO(name, type, first, second) \
	ECO_ORDER_BY(name, type, x first != y first ? ECO_RISES(x, y, first) : ECO_RISES(x, y, second))
#define ECO_ORDER_FALLING_TWO(name, type, first, second) \
	ECO_ORDER_BY(name, type, x first != y first ? ECO_RISES(y, x, first) : ECO_RISES(x, y, second))

/* Along a Morton curve through cells of `axes` numbers, without interleaving bits: the axis whose highest
 * differing bit is highest decides (Chan 2002), of equals the first. */
static inline int eco_order_cells(const uint32_t *a, const uint32_t *b, int axes)
{
	uint32_t most = 0;
	int axis = 0;
	for (int i = 0; i < axes; i++) {
		uint32_t d = a[i] ^ b[i];
		if (most < d && most < (most ^ d)) {
			most = d;
			axis = i;
		}
	}
	return ECO_RISES(a, b, [axis]);
}

#define ECO_LEAST(low, high, i, holds) \
	while (low < high) { \
		const __typeof__(low) i = low + (high - low) / 2; \
		if (holds) \
			high = i; \
		else \
			low = i + 1; \
	}
