/* Arrays that grow: the capacity doubles whenever they are full, so that adding an item costs the same
 * however many there are.
 *
 *   struct eco_edge *edges = NULL; uint32_t count = 0, capacity = 0;
 *   if (!eco_array_grow(&edges, &capacity, count, sizeof *edges))
 *           return out of memory; the array is as it was
 *   edges[count++] = edge;                                        the caller frees it */
#ifndef ECO_ARRAY_GROW_H
#define ECO_ARRAY_GROW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Makes room for one more item of `size` bytes behind `count` items. array: address of the pointer to the
 * items, which may move. False: no memory, or 2^31 items are there already. */
bool eco_array_grow(void *array, uint32_t *capacity, uint32_t count, size_t size);

#endif
