/* Different texts, each kept once, numbered from 0 in the order in which they first came.
 *
 *   struct eco_texts texts = { 0 };
 *   if (!eco_texts_add(&texts, "oak", &number))
 *           return out of memory; the texts are as they were
 *   texts.items[number]                           stays where it is until eco_texts_free(&texts) */
#ifndef ECO_TEXTS_H
#define ECO_TEXTS_H

#include <stdbool.h>
#include <stdint.h>

struct eco_texts {
	char **items;
	uint32_t count, capacity;
	uint32_t *slots, slot_count; /* a hash table of numbers; private */
};

/* The number of a text, which is copied where it is new. False: no memory. */
bool eco_texts_add(struct eco_texts *texts, const char *text, uint32_t *number);
void eco_texts_free(struct eco_texts *texts); /* leaves a zeroed one, which may be freed, too */

#endif
