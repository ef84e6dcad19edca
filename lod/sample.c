#include "lod/sample.h"

#include <math.h>
#include <string.h>

#include "ecofiles/list.h"
#include "lod/sort.h"
#include "lod/texel.h"

#define TRIES 48                 /* random points in a half, then in the whole triangle */
#define LATTICE 24               /* then a fixed lattice of this many steps a side */

/* Barycentric coordinates of the corners of the half-triangle that contains corner `own`: own, apex and the middle of the cut. */
struct weights { double w[3]; };

static double side2(const struct lod_sample_input *in, int a, int b)
{
	double sum = 0;
	for (int k = 0; k < 3; k++) {
		double d = (double)in->corner[a][k] - in->corner[b][k];
		sum += d * d;
	}
	return sum;
}

static int apex_of(const struct lod_sample_input *in)
{
	int apex = 0;                /* opposite to the longest edge */
	double longest = side2(in, 1, 2);
	for (int k = 1; k < 3; k++) {
		double d = side2(in, (k + 1) % 3, (k + 2) % 3);
		if (d > longest) {
			longest = d;
			apex = k;
		}
	}
	return apex;
}

static struct weights anywhere(uint64_t hash)
{
	double u = (double)(uint32_t)hash / 4294967296.0, v = (double)(uint32_t)(hash >> 32) / 4294967296.0;
	if (u + v > 1) {
		u = 1 - u;
		v = 1 - v;
	}
	return (struct weights){ { 1 - u - v, u, v } };
}

/* The same inside half `half` of the triangle. */
static struct weights in_half(uint64_t hash, int apex, int half)
{
	struct weights local = anywhere(hash), out = { { 0, 0, 0 } };
	int own = (apex + 1 + half) % 3, other = (apex + 2 - half) % 3;
	out.w[apex] = local.w[0];
	out.w[own] = local.w[1] + local.w[2] / 2;
	out.w[other] = local.w[2] / 2;
	return out;
}

static const uint8_t *texel(const struct lod_sample_input *in, struct weights at)
{
	return lod_texel_at(in->texels->image, (at.w[0] * in->uv[0] + at.w[1] * in->uv[2] + at.w[2] * in->uv[4]) / ECO_UV_ONE,
		(at.w[0] * in->uv[1] + at.w[1] * in->uv[3] + at.w[2] * in->uv[5]) / ECO_UV_ONE);
}

static bool opaque(const struct lod_sample_input *in, struct weights at)
{
	return !in->texels || !in->texels->cutout || texel(in, at)[3] >= 128;
}

static struct weights choose(const struct lod_sample_input *in, int apex, int half)
{
	uint64_t hash = lod_mix(in->seed * 2 + (uint64_t)half);
	struct weights at = in_half(hash, apex, half);
	for (int i = 0; i < 2 * TRIES && !opaque(in, at); i++) {
		hash = lod_mix(hash);
		at = i + 1 < TRIES ? in_half(hash, apex, half) : anywhere(hash);
	}
	for (int i = 0; i <= LATTICE && !opaque(in, at); i++)
		for (int j = 0; i + j <= LATTICE && !opaque(in, at); j++)
			at = (struct weights){ { (double)i / LATTICE, (double)j / LATTICE, (double)(LATTICE - i - j) / LATTICE } };
	return opaque(in, at) ? at : (struct weights){ { 1 / 3.0, 1 / 3.0, 1 / 3.0 } };
}

/* Texture coordinates of half `half` of the triangle. */
static void half_uv(const struct lod_sample_input *in, int apex, int half, int32_t uv[6])
{
	int own = (apex + 1 + half) % 3, other = (apex + 2 - half) % 3;
	for (int a = 0; a < 2; a++) {
		uv[a] = in->uv[2 * apex + a];
		uv[2 + a] = in->uv[2 * own + a];
		uv[4 + a] = in->uv[2 * own + a] + (in->uv[2 * other + a] - in->uv[2 * own + a]) / 2;
	}
}

void lod_sample_triangle(const struct lod_sample_input *in, int32_t position[2][3], uint8_t rgb[2][3])
{
	int apex = apex_of(in);
	for (int half = 0; half < 2; half++) {
		struct weights at = choose(in, apex, half);
		int32_t uv[6];
		for (int k = 0; k < 3; k++)
			position[half][k] = (int32_t)floor(0.5 + at.w[0] * in->corner[0][k] + at.w[1] * in->corner[1][k]
				+ at.w[2] * in->corner[2][k]);
		memcpy(rgb[half], in->tint, 3);
		if (!in->texels)
			continue;
		half_uv(in, apex, half, uv);
		if (lod_texels_mean(in->texels, in->tint, uv, rgb[half]) > 0 || lod_texels_mean(in->texels, in->tint, in->uv, rgb[half]) > 0)
			continue;
		if (opaque(in, at))          /* thinner than what is sampled for the mean */
			lod_texel_tint(texel(in, at), in->tint, rgb[half]);
	}
}
