/* Different texts, each kept once, numbered from 0 in the order in which they first came.
 *
 *   struct eco_string_pool texts = { 0 };
 *   if (!eco_string_pool_add(&texts, "oak", &number))
 *           return out of memory; the texts are as they were
 *   texts.items[number]                           stays where it is until eco_string_pool_free(&texts) */
#ifndef ECO_STRING_POOL_H
#define ECO_STRING_POOL_H

#include <stdbool.h>
#include <stdint.h>

struct eco_string_pool {
	char **items;
	uint32_t count, capacity;
	uint32_t *slots, slot_count; /* a hash table of numbers; private */
};

/* The number of a text, which is copied where it is new. False: no memory. */
bool eco_string_pool_add(struct eco_string_pool *texts, const char *text, uint32_t *number);
void eco_string_pool_free(struct eco_string_pool *texts); /* leaves a zeroed one, which may be freed, too */

#endif
