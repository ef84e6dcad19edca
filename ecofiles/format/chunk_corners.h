/* Corners of elements that are no placed shapes: what a prediction from the corners before them misses, in axes of the element's own.
 * Private to chunk_shapes*.c and chunk_corners*.c.
 *
 * Blades and leaves that are each bent a little differently have no shape in common, but much else: how far from the first edge and across
 * it the next corner lies, whether that is level, how far the tip is out of the plane of the first corners. So a corner is predicted as a
 * weighted sum of some vectors, its bases, and what is left is stored along axes of which the first is the first edge, the second level or
 * towards the third corner. There it is small or always alike along one axis or two, where in the axes of the plant it would be of one size
 * along all three. Elements that begin at another corner, or run the other way round, follow weights of their own: each says which trend
 * it follows, or none.
 *
 * What is left is rounded to a body-centred cubic lattice: with steps half as wide again as the grid's it has no corner further from where
 * it was than the grid has, and takes 3/4 bit less (Conway and Sloane 1988, "Sphere Packings, Lattices and Groups", chapter 2: the best
 * covering of space by balls of one size). */
#ifndef ECO_CHUNK_CORNERS_H
#define ECO_CHUNK_CORNERS_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/format/list.h"

#define ECO_TRENDS_MAX 3u        /* of elements of so many corners */
#define ECO_BASES_MAX 6u
#define ECO_WEIGHT_BITS 8u
#define ECO_WEIGHT_MAX (1 << 12)

struct eco_trend { int32_t weight[ECO_CORNERS_MAX][ECO_BASES_MAX]; };        /* of each corner's bases, in 256ths */

struct eco_frame {
	int64_t axis[3][3];          /* see eco_axes_first */
	int32_t base[ECO_BASES_MAX][3];
	uint32_t bases;
	int64_t length;              /* of the first edge */
	uint32_t of;                 /* corners that the axes are of: 0, none yet */
};

/* How corner k >= 1 is seen from those before it, at[0..3k). `frame` is 0, or that of an earlier corner of the same element, whose axes are
 * used again. Differences of corners must be below 2^30. */
void eco_corner_frame(struct eco_frame *frame, const int32_t *at, uint32_t k);
/* Bases of corner k: k - 1 edges and some vectors across them. */
uint32_t eco_corner_bases(uint32_t k);
/* Where the weights put it, along the axes, from corner 0. */
void eco_corner_guess(const struct eco_frame *frame, const int32_t *weight, int64_t guess[3]);
/* Where it is if so many steps are missed. False: out of bounds. */
bool eco_corner_place(const struct eco_frame *frame, const int64_t guess[3], const int32_t miss[3], const int32_t *from, int32_t *at);

/* In steps of the first axis; those of the others are twice as wide, and off by one where that of the first is odd. */
#define ECO_LATTICE_STEP 6

#endif
