/* Corners of elements that are not placed shapes: each is stored as the miss of a prediction from the
 * corners before it, along axes of the element's own. Private to chunk_shapes*.c and chunk_corners*.c.
 *
 * Blades and leaves that are each bent a little differently have no shape in common, but they are alike in
 * other ways: how far along the first edge and across it the next corner lies, whether it is level, how
 * far the tip leaves the plane of the first corners. So a corner is predicted as a weighted sum of a few
 * vectors, its bases. The miss is stored along the first edge, a direction across it that is level or
 * points towards the third corner, and their normal: along one or two of these axes misses are small or
 * alike, along the plant's axes they would be equally large on all three. A trend is one set of weights.
 * Elements that begin at another corner or run the other way round need other weights, so a chunk has a
 * few trends, and each element names the one it follows, or none.
 *
 * Misses are rounded to a body-centred cubic lattice. With steps half as wide again as the grid's, no
 * corner is moved further than by the grid, and a corner takes 3/4 bit less (Conway and Sloane 1988,
 * "Sphere Packings, Lattices and Groups", chapter 2: the best covering of space by balls of one size). */
#ifndef ECO_CHUNK_CORNERS_H
#define ECO_CHUNK_CORNERS_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/format/list.h"

#define ECO_TRENDS_MAX 3u        /* per number of corners */
#define ECO_BASES_MAX 6u
#define ECO_WEIGHT_BITS 8u
#define ECO_WEIGHT_MAX (1 << 12)

struct eco_trend { int32_t weight[ECO_CORNERS_MAX][ECO_BASES_MAX]; };        /* in 256ths */

struct eco_frame {
	int64_t axis[3][3];          /* see eco_axes_first */
	int32_t base[ECO_BASES_MAX][3];
	uint32_t bases;
	int64_t length;              /* of the first edge */
	uint32_t of;                 /* corners known when the axes were set; 0: not set */
};

/* Sets axes and bases of corner k >= 1 from the corners before it, at[0..3k). `frame` is zeroed, or that
 * of an earlier corner of the same element, whose axes are used again. Differences of corners must be
 * below 2^30. */
void eco_corner_frame(struct eco_frame *frame, const int32_t *at, uint32_t k);
/* Number of bases of corner k: k - 1 edges and some vectors across them. */
uint32_t eco_corner_bases(uint32_t k);
/* The predicted place, along the axes, from corner 0. */
void eco_corner_guess(const struct eco_frame *frame, const int32_t *weight, int64_t guess[3]);
/* The place at `miss` steps from the guess. False: out of bounds. */
bool eco_corner_place(const struct eco_frame *frame, const int64_t guess[3], const int32_t miss[3],
	const int32_t *from, int32_t *at);

/* The lattice's step along the first axis. Along the other two it is twice that, offset by one where the
 * first axis has an odd number of steps. */
#define ECO_LATTICE_STEP 6

#endif
