/* A map from 32-bit ids to positions in an array: what a stream names is sparse, what the client keeps is
 * dense. Open addressing; ids are spread by a multiplicative hash, so that a hostile stream can at worst make
 * it slow in its own linear size. */
#ifndef VIEW_TABLE_H
#define VIEW_TABLE_H

#include <stdbool.h>
#include <stdint.h>

struct view_table { uint32_t *slots; uint32_t *keys; uint32_t room, count; };   /* zero is empty */

/* UINT32_MAX if it is not there */
uint32_t view_table_get(const struct view_table *table, uint32_t key);
/* false: no memory; value < UINT32_MAX */
bool view_table_put(struct view_table *table, uint32_t key, uint32_t value);
/* Nothing happens where it is not there. */
void view_table_remove(struct view_table *table, uint32_t key);
void view_table_free(struct view_table *table);

#endif
