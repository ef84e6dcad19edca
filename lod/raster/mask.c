/* A triangle is tested row by row of texels: it is convex, so it meets a row in an interval whose ends lie on
 * edges. An interval is tested 64 texels at once. */
#include "lod/raster/mask.h"

#include <math.h>

#include "ecofiles/format/list.h"

#define ROWS_MOST 65536.0        /* of one triangle; one with more counts as visible */
#define ROW 4u                   /* cost of a row, in words */
#define ROUNDING 0.0625          /* texels */
#define TURNED (2.0 / ECO_UV_ONE)        /* of the image: a turned diagonal moves coordinates by as much
                                          * (element.c) */

void lod_mask_open(struct lod_mask *mask, const struct eco_image *image, struct lod_arena *arena)
{
	uint32_t words = (image->width + 63) / 64;
	uint64_t *opaque = lod_arena_take(arena, (size_t)words * image->height, sizeof *opaque);
	for (uint32_t y = 0; y < image->height; y++)
		for (uint32_t x = 0; x < image->width; x++) {
			size_t texel = (size_t)y * image->width + x;
			uint64_t bit = image->rgba[4 * texel + 3] >= 128;
			opaque[(size_t)y * words + x / 64] |= bit << x % 64;
		}
	*mask = (struct lod_mask){ image->width, image->height, words, opaque };
}

static uint32_t wrap(double texel, uint32_t size)
{
	double inside = texel - floor(texel / size) * size;
	return inside >= 0 && inside < size ? (uint32_t)inside : 0;
}

/* Whether any bit of [from, end) is set; from < end. */
static bool any_bit(const uint64_t *row, uint32_t from, uint32_t end)
{
	uint32_t first = from / 64, last = (end - 1) / 64;
	uint64_t low = ~UINT64_C(0) << from % 64, high = ~UINT64_C(0) >> (63 - (end - 1) % 64);
	if (first == last)
		return (row[first] & low & high) != 0;
	for (uint32_t i = first + 1; i < last; i++)
		if (row[i])
			return true;
	return (row[first] & low) || (row[last] & high);
}

static bool any_between(const struct lod_mask *mask, double y, double low, double high)
{
	const uint64_t *row = mask->opaque + (size_t)wrap(y, mask->height) * mask->words;
	if (high - low + 1 >= mask->width)
		return any_bit(row, 0, mask->width);
	uint32_t from = wrap(low, mask->width), count = (uint32_t)(high - low) + 1;
	if (count <= mask->width - from)
		return any_bit(row, from, from + count);
	return any_bit(row, from, mask->width) || any_bit(row, 0, count - (mask->width - from));
}

/* The extent of the triangle between the heights y[0] and y[1]; low > high if it has none there. */
static void meet(double p[3][2], const double y[2], double *low, double *high)
{
	*low = INFINITY;
	*high = -INFINITY;
	for (int k = 0; k < 3; k++) {
		const double *a = p[k], *b = p[(k + 1) % 3];
		if (fmax(a[1], b[1]) < y[0] || fmin(a[1], b[1]) > y[1])
			continue;
		for (int i = 0; i < 2; i++) {
			double clipped = fmin(fmax(i ? b[1] : a[1], y[0]), y[1]);
			double x = a[1] == b[1] ? (i ? b[0] : a[0])
				: a[0] + (clipped - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
			*low = fmin(*low, x);
			*high = fmax(*high, x);
		}
	}
}

bool lod_mask_hidden(const struct lod_mask *mask, const int32_t uv[6], uint64_t *work)
{
	double p[3][2], first = INFINITY, last = -INFINITY, low, high;
	const double margin[2] = { ROUNDING + TURNED * mask->width, ROUNDING + TURNED * mask->height };
	for (int k = 0; k < 3; k++) {
		p[k][0] = (double)uv[2 * k] * mask->width / ECO_UV_ONE;
		p[k][1] = (double)uv[2 * k + 1] * mask->height / ECO_UV_ONE;
		first = fmin(first, floor(p[k][1] - margin[1]));
		last = fmax(last, floor(p[k][1] + margin[1]));
	}
	if (last - first >= ROWS_MOST)
		return false;
	for (double y = first; y <= last; y++) {
		*work += ROW + mask->words;
		if (*work > LOD_MASK_WORK)
			return false;
		meet(p, (double[2]){ y - margin[1], y + 1 + margin[1] }, &low, &high);
		if (low <= high && any_between(mask, y, floor(low - margin[0]), floor(high + margin[0])))
			return false;
	}
	return true;
}
