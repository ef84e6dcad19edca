/* A shape that many elements have: one leaf, placed many times. Found by looking, not by names.
 *
 *   eco_shapes_find(&shapes, ...);                          encoder: which elements are one shape, moved, turned and scaled
 *   eco_shape_fit(&shapes, shape, corners, &placing);       encoder: how one element is placed; false where it would not be itself
 *   eco_shape_place(&shapes, shape, &placing, position);    both: the element's corners on its list's grid, in integers, so that
 *                                                           all machines get the same
 *   eco_shapes_free(&shapes);
 *
 * A shape lies in its own frame: middle of the corners at 0, mean normal up, first far corner along x; root mean square of the corners'
 * distances ECO_SHAPE_ONE. Leaves that face upwards are then turned by little more than a yaw, and one entry of their quaternion,
 * the largest, need not be stored ("smallest three"). */
#ifndef ECO_SHAPE_H
#define ECO_SHAPE_H

#include <stdbool.h>
#include <stddef.h>

#include "ecofiles/list.h"

#define ECO_SHAPES_MAX 256u
#define ECO_SHAPE_ONE 4096
#define ECO_SHAPE_COORDINATE_MAX (3 * ECO_SHAPE_ONE)     /* a corner is at most sqrt(6) from the middle */
#define ECO_SHAPE_TURN_BITS_MAX 14u
#define ECO_SHAPE_SIZE_MAX (1 << 20)

struct eco_shape {
	uint8_t corners;
	int32_t position[3 * ECO_CORNERS_MAX];
	int32_t uv[2 * ECO_CORNERS_MAX];
};

struct eco_shapes {
	struct eco_shape *items;
	uint32_t count;
	uint8_t place_shift;         /* centres are multiples of 2^place_shift of the grid */
	uint8_t size_shift;          /* and radii of 2^size_shift */
	uint8_t turn_bits;           /* entries of quaternions are multiples of 2^-turn_bits * sqrt(1/2): the stored ones are at most
	                              * 2^turn_bits of them, as only the largest can exceed sqrt(1/2) */
};

struct eco_placing {
	int32_t center[3];           /* in 2^place_shift of the grid */
	int32_t turn[3];             /* the entries of the quaternion (w, x, y, z) other than `left`, in order; that one is not negative */
	uint8_t left;
	int32_t size;                /* radius in 2^size_shift of the grid, at least 1 */
};

/* The corners of `shape` placed. False, with position unspecified, where the placing is none: the quaternion longer than 1, or a corner
 * beyond ECO_ROWS_VALUE_MAX. Placing may hold anything; shapes must be within their bounds. */
bool eco_shape_place(const struct eco_shapes *shapes, const struct eco_shape *shape, const struct eco_placing *placing,
	int32_t *position);

/* Elements [first, end) of a list: `at[i]` says where the corners of element first + i begin. */
struct eco_shapes_input {
	const struct eco_elements *elements;         /* with `exact` */
	uint32_t first, end;
	const size_t *at;
	uint32_t coarse_shift;       /* soup is rounded to 2^coarse_shift of the grid */
};
#define ECO_SHAPE_NONE UINT32_MAX
/* Fills shapes, and of[i] (end - first values) with the shape of element first + i, or ECO_SHAPE_NONE: those whose shape fewer than
 * `uses` have. False: out of memory. */
bool eco_shapes_find(struct eco_shapes *shapes, const struct eco_shapes_input *input, uint32_t uses, uint32_t *of);
void eco_shapes_free(struct eco_shapes *shapes);

/* How to place the shape so that no corner is further from `exact` than rounding to the coarse grid could move it. */
bool eco_shape_fit(const struct eco_shapes *shapes, const struct eco_shape *shape, const int32_t *exact, uint32_t coarse_shift,
	struct eco_placing *placing);

#endif
