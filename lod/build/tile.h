/* A quadtree over the contents of an eco file: square tiles, split until each holds few enough items (Deussen
 * 2002, 6.2); items at one place are split by their number.
 *
 *   lod_tiles_build(&tiles, items, count, 128);
 *   for each node, parents first: bounds, children; a leaf's items, by plant, then by number
 *   lod_tiles_free(&tiles);
 *
 * An item belongs to the tile of its foot; bounds hold whole bodies. */
#pragma once

#include <stdint.h>

#include "ecofiles/base/status.h"

struct lod_tile_item {
	double at[3];
	double reach, below, above;  /* body: within `reach` of the vertical through `at`, z from at - below
	                              * to at + above */
	uint32_t plant;              /* ECO_NONE: not a plant, such as a nested eco file */
	uint32_t index;              /* the caller's, unused */
	uint32_t weight;             /* counts as so many items; 0: as one */
};

struct lod_tile_node {
	double low[3], high[3];      /* of the bodies of its items */
	uint32_t item_first, item_count;         /* in lod_tiles.order; a parent has those of its children */
	uint32_t child[4], child_count;          /* nodes; 0: a leaf */
};

struct lod_tiles {               /* owns its arrays */
	struct lod_tile_node *nodes; /* depth first; [0] is the root */
	uint32_t node_count;
	uint32_t *order;             /* indices into items */
};

/* `most` >= 1. A leaf holds items of total weight `most`, except a single item. Deterministic; positions must
 * be finite. Without items there is one empty leaf at the origin. */
void lod_tiles_build(struct lod_tiles *tiles, const struct lod_tile_item *items, uint32_t count, uint32_t most);
void lod_tiles_free(struct lod_tiles *tiles);
