/* The inside of leaf collapse: nodes and quads (leaf_collapse_quad.c), and the search for the best partner
 * (leaf_collapse_search.c). */
#ifndef TESTS_BENCH_BASELINE_LEAF_COLLAPSE_STATE_H
#define TESTS_BENCH_BASELINE_LEAF_COLLAPSE_STATE_H

#include <stdbool.h>

#include "tests/bench/baseline/leaf_collapse.h"

/* lod_collapse_cost if that is below `least`; else anything that is not. */
double lod_collapse_cost_below(const struct lod_collapse_node *a, const struct lod_collapse_node *b,
	const struct lod_collapse_crown *crown, const struct lod_collapse_options *options, double least);
/* The quad in place of nodes a and b, as the last node. Sets the parents of both. */
void lod_collapse_pair(struct lod_collapse *collapse, const struct lod_collapse_leaves *leaves, uint32_t a,
	uint32_t b);
/* From a node for each leaf. */
void lod_collapse_extent(struct lod_collapse_crown *crown, const struct lod_collapse_node *node,
	const struct lod_collapse_leaves *leaves);
/* Fills place and level from the finished forest. */
void lod_collapse_place(struct lod_collapse *collapse, struct lod_arena *arena);

/* A k-d tree over the nodes that are alive. It is made anew whenever half of its nodes are gone. */
struct lod_collapse_box {
	double low[3], high[3];      /* of all that was ever put into it */
	double at;                   /* the plane between its halves */
	uint32_t side[2], parent;    /* boxes, or ECO_NONE */
	uint32_t alive, axis;
	uint32_t head;               /* of its list of nodes, or ECO_NONE; only where it has no halves */
};
struct lod_collapse_search {
	const struct lod_collapse_node *node;
	const struct lod_collapse_options *options;
	struct lod_collapse_crown crown;
	struct lod_collapse_box *box;
	uint32_t box_count, alive, built;
	bool *dead;                  /* per node */
	uint32_t *next, *box_of;     /* per node: the list of its box; its box */
	uint32_t *ids;               /* scratch of building */
};
/* Room for so many nodes, of which the first `count` are alive. */
void lod_collapse_search_make(struct lod_collapse_search *search, const struct lod_collapse *collapse,
	const struct lod_collapse_options *options, uint32_t room, uint32_t count, struct lod_arena *arena);
void lod_collapse_search_add(struct lod_collapse_search *search, uint32_t node);
void lod_collapse_search_remove(struct lod_collapse_search *search, uint32_t node);
/* The partner of least cost; ECO_NONE if no other is within the cut-offs. */
uint32_t lod_collapse_search_best(struct lod_collapse_search *search, uint32_t node, double *cost);

#endif
