/* Leaves on splats and points (lod/leaf.glsl): object-space cells as wide as a leaf, on three shells around
 * the ellipsoid. A hash of the cell says on which shell its leaf lies, so outlines are ragged and some leaves
 * lie deeper; and how it is turned and toned. Mean coverage, light and colour are those of the smooth
 * ellipsoid. */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "lod/lanes.h"
#include "lod/splat.h"

typedef uint32_t uint;
#define LEAF LOD_INLINE
#define LOD_LEAF_TEXT(...) __VA_ARGS__
#define real(x) ((float)(x))
#define whole(x) ((uint32_t)(int32_t)(x))
#define abs fabsf
#define floor floorf
#define max lod_max
#define sqrt sqrtf
typedef struct leaf_splat leaf_splat;
#include "lod/leaf.glsl"
#undef real
#undef whole
#undef abs
#undef floor
#undef max
#undef sqrt
#undef LEAF
#undef LOD_LEAF_TEXT

#define LOD_LEAF_RAGGED 0.5f     /* at most: larger outlines would be balls no more */
#define LOD_LEAF_PIXEL 0.7f      /* pixels: the least cell */
#define LOD_LEAF_LATTICE 1.2599f /* between lattice points, over the side of a cube of a cell's volume: 2^(1/3) */

/* The side of a cell, where a pixel is so wide. */
static inline float lod_leaf_side(float leaf, float pixel)
{
	while (leaf < LOD_LEAF_PIXEL * pixel)
		leaf *= 2;
	return leaf;
}

/* The leaves of a splat that lod_ellipse_make was given, of half axes `half` in its plant's space. leaf: the
 * width of a leaf, radius: of the disc of the ellipse's area, pixel: width of a pixel at the splat's
 * distance, all there. nth: another number in each of a pixel's samples, splats and plants. */
static inline void lod_leaf_splat(leaf_splat *out, const struct lod_ellipse *ellipse, const float across[3],
	const float down[3], const float farther[3], float w, const float center[3], const float half[9],
	float leaf, float radius, float pixel, uint32_t nth)
{
	float to[3][4], bulge = ellipse->bulge / w, cells = 1 / (LOD_LEAF_LATTICE * lod_leaf_side(leaf, pixel));
	for (int i = 0; i < 3; i++) {
		to[i][0] = center[i] * cells;
		to[i][1] = to[i][2] = to[i][3] = 0;
	}
	for (int k = 0; k < 3; k++) {
		float u = ellipse->half > 0 ? (across[k] - ellipse->lean * down[k]) / ellipse->half : 0,
			v = down[k] / ellipse->high,
			s = -(farther[k] - (ellipse->aside * u + ellipse->below * v) / w) / fmaxf(bulge, 1e-30f);
		for (int i = 0; i < 3; i++) {
			to[i][1] += half[3 * k + i] * u * cells;
			to[i][2] += half[3 * k + i] * v * cells;
			to[i][3] += half[3 * k + i] * s * cells;
		}
	}
	*out = (leaf_splat){ to[0][0], to[0][1], to[0][2], to[0][3], to[1][0], to[1][1], to[1][2], to[1][3], to[2][0],
		to[2][1], to[2][2], to[2][3], .ragged = leaf_rim(fminf(leaf / radius, LOD_LEAF_RAGGED), radius / pixel), .opacity = 1,
		.amount = fminf(leaf / pixel, 1), .nth = nth };
}
