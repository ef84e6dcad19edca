#include "ecofiles/base/array_grow.h"

#include <stdlib.h>
#include <string.h>

#define FIRST 64u
#define MOST (1u << 31)

bool eco_array_grow(void *array, uint32_t *capacity, uint32_t count, size_t size)
{
	uint32_t wanted = *capacity ? 2 * *capacity : FIRST;
	void *items, *bigger;
	if (count < *capacity)
		return true;
	/* memcpy: pointers of all types look alike here, but aliasing forbids reading one as another */
	memcpy(&items, array, sizeof items);
	bigger = *capacity < MOST ? realloc(items, wanted * size) : NULL;
	if (!bigger)
		return false;
	memcpy(array, &bigger, sizeof bigger);
	*capacity = wanted;
	return true;
}
