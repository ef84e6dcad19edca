/* Arrays that grow as they are filled: twice as large whenever they are full, so that adding costs the same however many there are.
 *
 *   struct eco_edge *edges = NULL; uint32_t count = 0, capacity = 0;
 *   if (!eco_room(&edges, &capacity, count, sizeof *edges))
 *           return out of memory; the array is as it was
 *   edges[count++] = edge;                                        the caller frees it */
#ifndef ECO_ROOM_H
#define ECO_ROOM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Room for one more item of `size` bytes behind `count` of them. array: the address of the pointer to the items, which may move. False
 * where there is no memory, or where 2^31 items are there already. */
bool eco_room(void *array, uint32_t *capacity, uint32_t count, size_t size);

#endif
