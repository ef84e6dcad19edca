/* A shape that many elements have: one leaf, placed many times.
 *
 *   eco_shapes_find(&shapes, ...);                     encoder: finds elements that are one shape, moved,
 *                                                      turned, and scaled or stretched
 *   eco_shape_fit(&shapes, shape, corners, &placing);  encoder: one element's placing; false: not near enough
 *   eco_shape_turn(&shapes, shape, &placing, offset);  both: corners from the centre, in exact integers
 *   eco_shapes_free(&shapes);
 *
 * A shape lies in its own frame: middle of the corners at 0, long axis along x, normal along z; root mean
 * square of the corners' distances ECO_SHAPE_ONE. A placing has the direction of x, as a point of the
 * octahedron of eight triangles (Meyer et al. 2010, "On floating-point normal vectors"), the leaf's roll
 * about x, and the lengths of its three axes. A narrow leaf's roll moves its corners little, so roll has
 * coarser steps than direction. Roll counts from level: a leaf that faces the sky has a small roll,
 * whatever its direction. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "ecofiles/format/list.h"

#define ECO_SHAPES_MAX 64u
#define ECO_SHAPE_ONE 4096
#define ECO_SHAPE_COORDINATE_MAX (3 * ECO_SHAPE_ONE)     /* a corner is at most sqrt(6) from the middle */
#define ECO_SHAPE_TURN_BITS_MAX 14u
#define ECO_SHAPE_SIZE_MAX (1 << 20)
#define ECO_SHAPE_SHIFT_MAX 7u

struct eco_shape {
	uint8_t corners;
	int32_t position[3 * ECO_CORNERS_MAX];
	int32_t uv[2 * ECO_CORNERS_MAX];
};

/* The axes whose lengths a placing stores beside that of x. */
enum eco_stretch {
	ECO_STRETCH_NONE,            /* none: y and z are scaled as x */
	ECO_STRETCH_WIDTH,           /* y; z is scaled as x */
	ECO_STRETCH_LENGTH,          /* y; z is scaled as y */
	ECO_STRETCH_ALL              /* y and z */
};

struct eco_shapes {
	struct eco_shape *items;
	uint32_t count;
	uint8_t stretch;
	/* 0..ECO_EXACT_SHIFT: centres are multiples of 2^place_shift of the grid */
	uint8_t place_shift;
	uint8_t size_shift[3];       /* and lengths of axes of 2^size_shift; 0..ECO_SHAPE_SHIFT_MAX */
	uint8_t way_bits;            /* x: one of 2^(way_bits + 1) squared squares of the octahedron */
	uint8_t roll_bits;           /* a whole turn has 2^(roll_bits + 2) steps */
};

struct eco_placing {
	int32_t center[3];           /* in 2^place_shift of the grid */
	int32_t way[2];              /* 0..2^(way_bits + 1) - 1 */
	int32_t roll;                /* 0..2^(roll_bits + 2) - 1 */
	int32_t size[3];             /* of x, y, z, in 2^size_shift; some are ignored: see stretch */
};

/* The corners of the placed shape relative to its centre, on the grid. False, with offset unspecified: a
 * value of the placing is out of range. Shapes must be within their bounds. */
bool eco_shape_turn(const struct eco_shapes *shapes, const struct eco_shape *shape,
	const struct eco_placing *placing, int32_t *offset);
/* Its two steps: the axes, of length 2^ECO_AXIS_BITS, from direction and roll, then the corners from the
 * lengths along them. */
bool eco_shape_axes(const struct eco_shapes *shapes, const struct eco_placing *placing, int64_t axis[3][3]);
bool eco_shape_offset(const struct eco_shapes *shapes, const struct eco_shape *shape,
	const struct eco_placing *placing, int64_t axis[3][3], int32_t *offset);

/* offset + center; false where that is beyond ECO_ROWS_VALUE_MAX. */
bool eco_shape_place(const struct eco_shapes *shapes, const struct eco_placing *placing,
	const int32_t *offset, uint32_t corners, int32_t *position);

/* Axes at right angles, of length 2^ECO_AXIS_BITS: the first along x (the world's x where x is 0); the
 * second as near to y as possible, or level where y is NULL or along x. Coordinates must be below 2^30.
 * eco_axes_first returns the length of x. */
#define ECO_AXIS_BITS 24
int64_t eco_axes_first(const int64_t x[3], int64_t axis[3][3]);
void eco_axes_others(const int64_t *y, int64_t axis[3][3]);

/* Elements [first, end) of a list: `at[i]` says where the corners of element first + i begin. */
struct eco_shapes_input {
	const struct eco_elements *elements;         /* with `exact` */
	uint32_t first, end;
	const size_t *at;
};
#define ECO_SHAPE_NONE UINT32_MAX
/* Fills shapes, and of[i] (end - first values) with the shape of element first + i, or ECO_SHAPE_NONE; shapes
 * of fewer than `uses` elements are dropped. Steps are set to the finest of use. */
void eco_shapes_find(struct eco_shapes *shapes, const struct eco_shapes_input *input, uint32_t uses, uint32_t *of);
void eco_shapes_free(struct eco_shapes *shapes);
/* Drops shapes of fewer than `uses` of the `count` elements and renumbers the others. Returns the elements
 * that have a shape. */
uint32_t eco_shapes_keep(struct eco_shapes *shapes, uint32_t *of, uint32_t count, uint32_t uses);

/* Finds a placing that moves no corner further from `exact` than rounding to the list's grid could. False:
 * there is none. */
bool eco_shape_fit(const struct eco_shapes *shapes, const struct eco_shape *shape, const int32_t *exact,
	struct eco_placing *placing);

/* Its two steps: the nearest pose, which steps and bits do not change, then its rounding to them. */
struct eco_pose { double center[3], axis[3][3], size[3]; };
bool eco_shape_pose(const struct eco_shapes *shapes, const struct eco_shape *shape, const int32_t *exact,
	struct eco_pose *pose);
bool eco_shape_round(const struct eco_shapes *shapes, const struct eco_shape *shape, const int32_t *exact,
	const struct eco_pose *pose, struct eco_placing *placing);
