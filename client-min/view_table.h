/* A map from ids to positions in an array. Open addressing; a multiplicative hash spreads ids, so that a
 * hostile stream makes it at worst slow in its own linear size. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

struct view_table { uint64_t *keys; uint32_t *slots; uint32_t room, count; };   /* zero is empty */

/* UINT32_MAX: not there. */
uint32_t view_table_get(const struct view_table *table, uint64_t key);
/* false: no memory; value < UINT32_MAX */
bool view_table_put(struct view_table *table, uint64_t key, uint32_t value);
void view_table_remove(struct view_table *table, uint64_t key);  /* a key that is not there is fine */
void view_table_free(struct view_table *table);
