/* Drawing of splats, shared by the rasteriser and by what fits splats.
 *
 * Half axes h_k are taken to the picture linearly at the centre, whose distance is w: in pixels d_k = J h_k,
 * and q_k, the part of h_k along the line of sight over w. With C = sum d_k d_k^T, s = sum q_k d_k and r =
 * sum q_k^2 the outline in perspective is the ellipse (x + s / (1 - r))^T E^-1 (x + s / (1 - r)) <= 1 around
 * the centre's pixel, E = (C (1 - r) + s s^T) / (1 - r)^2: the dual conic of the ellipsoid (Hartley and
 * Zisserman 2004, section 8.3), written without differences of large numbers. If it is not opaque a fixed
 * hash of pixel and splat says which pixels it covers. Its depth is that of the side of the ellipsoid that
 * faces the eye. */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "lod/hash.h"

/* The ellipse around (x, y) from the pixel of the ellipsoid's centre: the row y lower than that holds the
 * pixels with |x - lean y| <= half sqrt(1 - (y / high)^2). With u = (x - lean y) / half and v = y / high the
 * ellipsoid's near side is aside u + below v - bulge sqrt(1 - u^2 - v^2) metres farther than its centre
 * (linearly at the centre). */
struct lod_ellipse { float x, y, wide, high, lean, half, aside, below, bulge; };

/* From the half axes, in pixels to the right and down, and farther away over the centre's distance w. False
 * where nothing can be covered, and where the ellipsoid reaches the eye's plane. */
static inline bool lod_ellipse_make(struct lod_ellipse *ellipse, const float across[3], const float down[3],
	const float farther[3], float w)
{
	float xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, zz = 0;
	for (int k = 0; k < 3; k++) {
		xx += across[k] * across[k];
		xy += across[k] * down[k];
		yy += down[k] * down[k];
		xz += across[k] * farther[k];
		yz += down[k] * farther[k];
		zz += farther[k] * farther[k];
	}
	if (!(xx > 0 && yy > 0 && xx < 1e30f && yy < 1e30f && zz < 1))
		return false;
	float part = 1 / (1 - zz);
	ellipse->x = -xz * part;
	ellipse->y = -yz * part;
	xx = (xx + xz * xz * part) * part;
	xy = (xy + xz * yz * part) * part;
	yy = (yy + yz * yz * part) * part;
	ellipse->wide = sqrtf(xx);
	ellipse->high = sqrtf(yy);
	ellipse->lean = xy / yy;
	float rest = xx - ellipse->lean * xy;
	ellipse->half = rest > 0 ? sqrtf(rest) : 0;
	ellipse->below = yz / ellipse->high;
	ellipse->aside = rest > 0 ? (xz - ellipse->lean * yz) / ellipse->half : 0;
	rest = zz - ellipse->aside * ellipse->aside - ellipse->below * ellipse->below;
	ellipse->bulge = rest > 0 ? w * sqrtf(rest) : 0;
	ellipse->aside *= w;
	ellipse->below *= w;
	return true;
}

/* Half the length of the row at height y, pixels; negative beyond the ellipse. */
static inline float lod_ellipse_row(const struct lod_ellipse *ellipse, float y)
{
	float t = y / ellipse->high, rest = 1 - t * t;
	return rest >= 0 ? ellipse->half * sqrtf(rest) : -1;
}

/* Distance of the near side at (x, y) behind the centre, metres; negative in front of it. */
static inline float lod_ellipse_farther(const struct lod_ellipse *ellipse, float x, float y)
{
	float u = ellipse->half > 0 ? (x - ellipse->lean * y) / ellipse->half : 0, v = y / ellipse->high,
		rest = 1 - u * u - v * v;
	return ellipse->aside * u + ellipse->below * v - ellipse->bulge * (rest > 0 ? sqrtf(rest) : 0);
}

/* The salt of a splat, from its centre in object space and the number of a pixel's sample. */
static inline uint32_t lod_splat_salt(const float centre[3], uint32_t nth)
{
	uint32_t bits[3], salt;
	memcpy(bits, centre, sizeof bits);
	const uint32_t x = bits[0], y = bits[1], z = bits[2];
	LOD_HASH_SALT;
	return salt;
}

/* In [0, 1): less than what opacity a splat needs in order to cover the pixel. */
static inline float lod_splat_need(uint32_t salt, uint32_t column, uint32_t row)
{
	uint32_t hash;
	LOD_HASH_SPLAT;
	return (float)(hash >> 24) / 256;
}

/* Opaque splats cover all pixels, others a share of them. */
static inline bool lod_splat_covers(uint32_t salt, uint32_t column, uint32_t row, float opacity)
{
	return lod_splat_need(salt, column, row) < opacity;
}
