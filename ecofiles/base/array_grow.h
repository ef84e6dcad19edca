/* Arrays that grow and are freed together, and texts each kept once. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The capacity doubles whenever an array is full, so that adding an item costs the same
 * however many there are.
 *
 *   struct eco_edge *edges = NULL; uint32_t count = 0, capacity = 0;
 *   if (!eco_array_grow(&edges, &capacity, count, sizeof *edges))
 *           return out of memory; the array is as it was
 *   edges[count++] = edge;                                        the caller frees it */

/* Makes room for one more item of `size` bytes behind `count` items. array: address of the pointer to the
 * items, which may move. False: no memory, or 2^31 items are there already. */
bool eco_array_grow(void *array, uint32_t *capacity, uint32_t count, size_t size);

/* Frees each of its arguments, as free does: eco_free(list->places, list->names). */
#define eco_free(...) \
	eco_free_all((void *const[]){ __VA_ARGS__ }, sizeof((void *const[]){ __VA_ARGS__ }) / sizeof(void *))
void eco_free_all(void *const *pointers, size_t count);

/* Different texts, each kept once, numbered from 0 in the order in which they first came.
 *
 *   struct eco_string_pool texts = { 0 };
 *   if (!eco_string_pool_add(&texts, "oak", &number))
 *           return out of memory; the texts are as they were
 *   texts.items[number]                           stays where it is until eco_string_pool_free(&texts) */

struct eco_string_pool {
	char **items;
	uint32_t count, capacity;
	uint32_t *slots, slot_count; /* a hash table of numbers; private */
};

/* The number of a text, which is copied where it is new. False: no memory. */
bool eco_string_pool_add(struct eco_string_pool *texts, const char *text, uint32_t *number);
void eco_string_pool_free(struct eco_string_pool *texts); /* leaves a zeroed one, which may be freed, too */
