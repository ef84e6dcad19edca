/* Inside buildings.c: a footprint's rings, by the even-odd rule, and convex pieces of the surfaces between them.
 *
 *   gen_rings_take(&rings, edges, count);
 *   for each ring that is no hole          joined = gen_rings_join(&rings, i); gen_ring_pieces(&joined, on, ctx);
 *   gen_rings_free(&rings); */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/generate/buildings.h"

#define GEN_RINGS_MAX 256u /* of a footprint, after cuts */

struct gen_corner {
	int64_t x, y;
}; /* millimetres from the first edge's beginning: products of two are exact */
struct gen_ring {
	struct gen_corner *corners;
	uint32_t count;
	bool hole;
	uint32_t outer;
}; /* outer: the ring around a hole */
struct gen_rings {
	struct gen_ring items[GEN_RINGS_MAX];
	uint32_t count;
	bool crossed;
};

/* The rings that have a surface; surfaces run counter-clockwise, holes clockwise. False: the footprint is beyond the limits of
 * buildings.h. In any case gen_rings_free is the caller's. */
bool gen_rings_take(struct gen_rings *rings, const struct eco_edge *edges, uint32_t edge_count);
void gen_rings_free(struct gen_rings *rings);

/* A surface with its holes as one ring. The caller frees its corners. */
struct gen_ring gen_rings_join(const struct gen_rings *rings, uint32_t outer);

/* Calls on(ctx, corners, count) for convex pieces of a ring: itself, or triangles. */
typedef void gen_on_piece(void *ctx, const struct gen_corner *corners, uint32_t count);
void gen_ring_pieces(const struct gen_ring *ring, gen_on_piece *on, void *ctx);
