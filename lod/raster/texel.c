#include "lod/raster/texel.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "ecofiles/format/list.h"
#include "lod/lanes.h"
#include "lod/light.h"
#include "lod/sort.h"

static uint32_t wrap(double texel, uint32_t size)
{
	double turns = floor(texel / size), inside = texel - turns * size;
	return inside >= 0 && inside < size ? (uint32_t)inside : 0;
}

const uint8_t *lod_texel_at(const struct eco_image *image, double u, double v)
{
	uint32_t x = wrap(floor(u * image->width), image->width),
		y = wrap(floor(v * image->height), image->height);
	return image->rgba + 4 * ((size_t)y * image->width + x);
}

void lod_texel_tint(const uint8_t *texel, const uint8_t tint[3], uint8_t rgb[3])
{
	for (int k = 0; k < 3; k++)
		rgb[k] = tint[k] == 255 ? texel[k]
			: lod_light_byte((double)lod_light_of[texel[k]] * lod_light_of[tint[k]] / 65535);
}

/* ---- Means ---- */

#define BLOCKS_MAX (1u << 21)
#define ROWS_MIN 64
#define ROWS_MAX 1024
#define SAMPLES 64                   /* of a triangle that is a line in the texture */
#define LEAST 1e-6                   /* a share below counts as nothing */
#define SEEN 1024u                   /* cached answers; a power of two */

/* Light, and how many texels are opaque; whole numbers in the sums of a row: exact. */
struct lod_texel_sum { double light[3], opaque; };
struct lod_texel_seen { int32_t uv[6]; uint8_t rgb[3]; bool used; double share; };
struct mean { struct lod_texel_sum sum; double all; };

static void add_texels(const struct lod_texels *texels, struct lod_texel_sum *to, const uint8_t *texel,
	uint32_t count)
{
	uint64_t light[3] = { 0 }, opaque = 0;
	for (const uint8_t *end = texel + 4 * (size_t)count; texel < end; texel += 4) {
		if (texels->cutout && texel[3] < 128)
			continue;
		opaque++;
		for (int k = 0; k < 3; k++)
			light[k] += lod_light_of[texel[k]];
	}
	for (int k = 0; k < 3; k++)
		to->light[k] += (double)light[k];
	to->opaque += (double)opaque;
}

static void add_block(const struct lod_texels *texels, struct lod_texel_sum *to, uint32_t x, uint32_t y)
{
	const struct eco_image *image = texels->image;
	uint32_t size = 1u << texels->shift, first = x * size, left = image->width - first;
	for (uint32_t j = y * size; j < (y + 1) * size && j < image->height; j++)
		add_texels(texels, to, image->rgba + 4 * ((size_t)j * image->width + first),
			left < size ? left : size);
}

void lod_texels_open(struct lod_texels *texels, const struct eco_image *image, bool cutout,
	struct lod_arena *arena)
{
	*texels = (struct lod_texels){ .image = image, .cutout = cutout };
	do {
		uint32_t size = 1u << texels->shift;
		texels->width = (image->width + size - 1) / size;
		texels->height = (image->height + size - 1) / size;
	} while ((uint64_t)texels->width * texels->height > BLOCKS_MAX && ++texels->shift);
	texels->seen = lod_arena_take(arena, SEEN, sizeof *texels->seen);
	texels->before = lod_arena_take(arena, (size_t)texels->height * (texels->width + 1),
		sizeof *texels->before);
	struct lod_texel_sum all = { .opaque = 0 };
	for (uint32_t y = 0; y < texels->height; y++) {
		struct lod_texel_sum *row = texels->before + (size_t)y * (texels->width + 1);
		for (uint32_t x = 0; x < texels->width; x++) {
			row[x + 1] = row[x];
			add_block(texels, &row[x + 1], x, y);
		}
		for (int k = 0; k < 3; k++)
			all.light[k] += row[texels->width].light[k];
		all.opaque += row[texels->width].opaque;
	}
	for (int k = 0; k < 3; k++)
		texels->rgb[k] = all.opaque > 0 ? lod_light_byte(all.light[k] / all.opaque) : 255;
}

/* A place in an endlessly repeating row: turns of the whole row, blocks, and the share of the next one. */
struct place { double turns, part; uint32_t block; };

static struct place place_of(const struct lod_texels *texels, double x)
{
	double width = texels->width, turns = floor(x / width), rest = x - turns * width;
	uint32_t block = rest < width ? (uint32_t)rest : texels->width - 1;
	return (struct place){ turns, rest - block, block };
}

static double texels_before(const struct lod_texels *texels, uint32_t block)
{
	uint32_t end = block << texels->shift;
	return end < texels->image->width ? end : texels->image->width;
}

/* Texels of the row before the place, without its turns. */
static double all_before(const struct lod_texels *texels, const struct place *p)
{
	return texels_before(texels, p->block) * (1 - p->part) + texels_before(texels, p->block + 1) * p->part;
}

/* Adds the texels in [from, end) of row y; blocks that are cut count in part. The whole row's sum, which lies
 * elsewhere in memory, is asked for only where its turns do not cancel. */
static void add_row(const struct lod_texels *texels, struct mean *mean, uint32_t y, double from, double end)
{
	const struct lod_texel_sum *row = texels->before + (size_t)y * (texels->width + 1);
	const struct place a = place_of(texels, from), b = place_of(texels, end);
	const double turns = b.turns - a.turns;
	uint32_t size = 1u << texels->shift, left = texels->image->height - y * size;
	lod_d4 to, b0, b1, a0, a1, whole;
	memcpy(&to, &mean->sum, sizeof to);
	memcpy(&b0, row + b.block, sizeof b0);
	memcpy(&b1, row + b.block + 1, sizeof b1);
	memcpy(&a0, row + a.block, sizeof a0);
	memcpy(&a1, row + a.block + 1, sizeof a1);
	to = to + b0 * (1 - b.part) + b1 * b.part - a0 * (1 - a.part) - a1 * a.part;
	if (turns != 0) {
		memcpy(&whole, row + texels->width, sizeof whole);
		to += whole * turns;
	}
	memcpy(&mean->sum, &to, sizeof to);
	mean->all += (all_before(texels, &b) - all_before(texels, &a) + turns * texels->image->width)
		* (left < size ? left : size);
}

struct edge { double x, y, slope; };

static struct edge edge_of(const double a[2], const double b[2])
{
	return (struct edge){ a[0], a[1], b[1] > a[1] ? (b[0] - a[0]) / (b[1] - a[1]) : 0 };
}

static double edge_at(const struct edge *edge, double y) { return edge->x + (y - edge->y) * edge->slope; }

/* Corners in blocks, by height. */
static void corners_of(const struct lod_texels *texels, const int32_t uv[6], double p[3][2])
{
	for (int k = 0; k < 3; k++) {
		double x = (double)uv[2 * k] * texels->width / ECO_UV_ONE,
			y = (double)uv[2 * k + 1] * texels->height / ECO_UV_ONE;
		int at = k;
		for (; at > 0 && p[at - 1][1] > y; at--)
			memcpy(p[at], p[at - 1], sizeof *p);
		p[at][0] = x;
		p[at][1] = y;
	}
}

static void sum_rows(const struct lod_texels *texels, const int32_t uv[6], struct mean *mean)
{
	double p[3][2];
	corners_of(texels, uv, p);
	const struct edge whole = edge_of(p[0], p[2]), lower = edge_of(p[0], p[1]), upper = edge_of(p[1], p[2]);
	double low = p[0][1], high = p[2][1], by = high - low;
	int rows = by < ROWS_MIN ? ROWS_MIN : by < ROWS_MAX ? (int)by : ROWS_MAX;
	for (int i = 0; i < rows && by > 0; i++) {
		double y = low + (i + 0.5) / rows * by, from = edge_at(&whole, y),
			end = edge_at(y < p[1][1] ? &lower : &upper, y);
		if (from != end)
			add_row(texels, mean, wrap(floor(y), texels->height), from < end ? from : end,
				from < end ? end : from);
	}
}

/* For triangles that are a line or a point in the texture: samples their longest side. */
static void sum_line(const struct lod_texels *texels, const int32_t uv[6], struct mean *mean)
{
	int from = 0;
	double longest = -1;
	for (int k = 0; k < 3; k++) {
		double u = (double)uv[2 * k] - uv[2 * ((k + 1) % 3)],
			v = (double)uv[2 * k + 1] - uv[2 * ((k + 1) % 3) + 1];
		if (u * u + v * v > longest) {
			longest = u * u + v * v;
			from = k;
		}
	}
	const int32_t *a = uv + 2 * from, *b = uv + 2 * ((from + 1) % 3);
	for (int i = 0; i < SAMPLES; i++) {
		double at = (i + 0.5) / SAMPLES;
		mean->all++;
		add_texels(texels, &mean->sum,
			lod_texel_at(texels->image, (a[0] + at * ((double)b[0] - a[0])) / ECO_UV_ONE,
			(a[1] + at * ((double)b[1] - a[1])) / ECO_UV_ONE), 1);
	}
}

static struct lod_texel_seen *look_up(struct lod_texels *texels, const int32_t uv[6])
{
	uint64_t hash = 0;
	for (int k = 0; k < 6; k++)
		hash = lod_mix(hash + (uint32_t)uv[k]);
	struct lod_texel_seen *seen = &texels->seen[hash & (SEEN - 1)];
	if (seen->used && memcmp(seen->uv, uv, sizeof seen->uv) == 0)
		return seen;
	struct mean mean = { .all = 0 };
	sum_rows(texels, uv, &mean);
	if (!(mean.all > 0)) {
		mean = (struct mean){ .all = 0 };
		sum_line(texels, uv, &mean);
	}
	/* Differences of large sums leave a small rest where there is nothing. */
	bool any = mean.sum.opaque > LEAST * mean.all;
	*seen = (struct lod_texel_seen){ .used = true, .share = any ? fmin(mean.sum.opaque / mean.all, 1) : 0 };
	memcpy(seen->uv, uv, sizeof seen->uv);
	for (int k = 0; k < 3; k++)
		seen->rgb[k] = any ? lod_light_byte(mean.sum.light[k] / mean.sum.opaque) : texels->rgb[k];
	return seen;
}

double lod_texels_mean(struct lod_texels *texels, const uint8_t tint[3], const int32_t uv[6], uint8_t rgb[3])
{
	const struct lod_texel_seen *seen = look_up(texels, uv);
	lod_texel_tint(seen->rgb, tint, rgb);
	return seen->share;
}

/* ---- Masks ---- */

/* A triangle is tested row by row of texels: it is convex, so it meets a row in an interval whose ends lie on
 * edges. An interval is tested 64 texels at once. */
#define MASK_ROWS 65536.0        /* of one triangle; one with more counts as visible */
#define MASK_ROW 4u              /* cost of a row, in words */
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
	if (last - first >= MASK_ROWS)
		return false;
	for (double y = first; y <= last; y++) {
		*work += MASK_ROW + mask->words;
		if (*work > LOD_MASK_WORK)
			return false;
		meet(p, (double[2]){ y - margin[1], y + 1 + margin[1] }, &low, &high);
		if (low <= high && any_between(mask, y, floor(low - margin[0]), floor(high + margin[0])))
			return false;
	}
	return true;
}
