#include "lod/texel.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "ecofiles/list.h"
#include "lod/light.h"
#include "lod/sort.h"

#define TEXELS_MAX (1 << 16)         /* looked at for one triangle */
#define MARGIN 2.0

static uint32_t wrap(double texel, uint32_t size)
{
	double turns = floor(texel / size), inside = texel - turns * size;
	return inside >= 0 && inside < size ? (uint32_t)inside : 0;
}

const uint8_t *lod_texel_at(const struct eco_image *image, double u, double v)
{
	uint32_t x = wrap(floor(u * image->width), image->width), y = wrap(floor(v * image->height), image->height);
	return image->rgba + 4 * ((size_t)y * image->width + x);
}

/* Twice the signed area of the triangle a, b, p, and how much p may be off the line's side by a margin in both directions. */
static double side(const double a[2], const double b[2], double x, double y)
{
	return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
}

static bool near_triangle(double p[3][2], double sign, double x, double y)
{
	for (int k = 0; k < 3; k++) {
		const double *a = p[k], *b = p[(k + 1) % 3];
		double slack = MARGIN * (fabs(b[0] - a[0]) + fabs(b[1] - a[1]));
		if (sign * side(a, b, x, y) < -slack)
			return false;
	}
	return true;
}

bool lod_texel_hidden(const struct eco_image *image, const int32_t uv[6])
{
	double p[3][2], low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
	for (int k = 0; k < 3; k++) {
		p[k][0] = (double)uv[2 * k] * image->width / ECO_UV_ONE;
		p[k][1] = (double)uv[2 * k + 1] * image->height / ECO_UV_ONE;
		for (int a = 0; a < 2; a++) {
			low[a] = fmin(low[a], floor(p[k][a] - MARGIN));
			high[a] = fmax(high[a], ceil(p[k][a] + MARGIN));
		}
	}
	if ((high[0] - low[0] + 1) * (high[1] - low[1] + 1) > TEXELS_MAX)
		return false;
	double area = side(p[0], p[1], p[2][0], p[2][1]), sign = area < 0 ? -1 : 1;
	for (double y = low[1]; y <= high[1]; y++)
		for (double x = low[0]; x <= high[0]; x++) {
			size_t at = (size_t)wrap(y, image->height) * image->width + wrap(x, image->width);
			const uint8_t *texel = image->rgba + 4 * at;
			if (texel[3] >= 128 && (area == 0 || near_triangle(p, sign, x + 0.5, y + 0.5)))
				return false;
		}
	return true;
}

void lod_texel_tint(const uint8_t *texel, const uint8_t tint[3], uint8_t rgb[3])
{
	for (int k = 0; k < 3; k++)
		rgb[k] = tint[k] == 255 ? texel[k] : lod_light_byte((double)lod_light_of[texel[k]] * lod_light_of[tint[k]] / 65535);
}

/* ---- Means ---- */

#define BLOCKS_MAX (1u << 21)
#define ROWS_MAX 1024
#define SAMPLES 8                    /* along a side: 64 in all */
#define SEEN 1024u                   /* answers kept; a power of two */

struct lod_texel_sum { uint64_t light[3], opaque, all; };
struct lod_texel_seen { int32_t uv[6]; uint8_t rgb[3]; bool used; double share; };

static void add_texel(const struct lod_texels *texels, struct lod_texel_sum *sum, const uint8_t *texel)
{
	sum->all++;
	if (texels->cutout && texel[3] < 128)
		return;
	sum->opaque++;
	for (int k = 0; k < 3; k++)
		sum->light[k] += lod_light_of[texel[k]];
}

static void add_block(const struct lod_texels *texels, struct lod_texel_sum *sum, uint32_t x, uint32_t y)
{
	const struct eco_image *image = texels->image;
	uint32_t size = 1u << texels->shift;
	for (uint32_t j = y * size; j < (y + 1) * size && j < image->height; j++)
		for (uint32_t i = x * size; i < (x + 1) * size && i < image->width; i++)
			add_texel(texels, sum, image->rgba + 4 * ((size_t)j * image->width + i));
}

void lod_texels_open(struct lod_texels *texels, const struct eco_image *image, bool cutout, struct lod_arena *arena)
{
	*texels = (struct lod_texels){ .image = image, .cutout = cutout };
	do {
		uint32_t size = 1u << texels->shift;
		texels->width = (image->width + size - 1) / size;
		texels->height = (image->height + size - 1) / size;
	} while ((uint64_t)texels->width * texels->height > BLOCKS_MAX && ++texels->shift);
	texels->seen = lod_arena_take(arena, SEEN, sizeof *texels->seen);
	texels->before = lod_arena_take(arena, (size_t)texels->height * (texels->width + 1), sizeof *texels->before);
	for (uint32_t y = 0; y < texels->height; y++) {
		struct lod_texel_sum *row = texels->before + (size_t)y * (texels->width + 1);
		for (uint32_t x = 0; x < texels->width; x++) {
			row[x + 1] = row[x];
			add_block(texels, &row[x + 1], x, y);
		}
	}
}

/* Adds `times` whole rows' or part of a row's sums. */
static void add_sum(struct lod_texel_sum *to, const struct lod_texel_sum *sum, int64_t times)
{
	for (int k = 0; k < 3; k++)
		to->light[k] += (uint64_t)times * sum->light[k];
	to->opaque += (uint64_t)times * sum->opaque;
	to->all += (uint64_t)times * sum->all;
}

/* Adds blocks [from, end) of a row that repeats for ever. */
static void add_span(const struct lod_texels *texels, struct lod_texel_sum *to, int64_t row, int64_t from, int64_t end)
{
	int64_t width = texels->width, height = texels->height, y = row % height;
	const struct lod_texel_sum *before = texels->before + (size_t)(y < 0 ? y + height : y) * (size_t)(width + 1);
	int64_t turn[2] = { from / width - (from % width < 0), end / width - (end % width < 0) };
	add_sum(to, &before[width], turn[1] - turn[0]);
	add_sum(to, &before[end - turn[1] * width], 1);
	add_sum(to, &before[from - turn[0] * width], -1);
}

/* Where the triangle's outline crosses the height y. */
static void cross(double p[3][2], double y, double *low, double *high)
{
	*low = INFINITY;
	*high = -INFINITY;
	for (int k = 0; k < 3; k++) {
		const double *a = p[k], *b = p[(k + 1) % 3];
		if ((a[1] <= y) == (b[1] <= y))
			continue;
		double x = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
		*low = fmin(*low, x);
		*high = fmax(*high, x);
	}
}

/* Returns the blocks whose centres are inside. */
static int64_t sum_rows(const struct lod_texels *texels, const int32_t uv[6], struct lod_texel_sum *sum)
{
	double p[3][2], low = INFINITY, high = -INFINITY;
	int64_t blocks = 0;
	for (int k = 0; k < 3; k++) {
		p[k][0] = (double)uv[2 * k] * texels->width / ECO_UV_ONE;
		p[k][1] = (double)uv[2 * k + 1] * texels->height / ECO_UV_ONE;
		low = fmin(low, p[k][1]);
		high = fmax(high, p[k][1]);
	}
	int64_t first = (int64_t)ceil(low - 0.5), count = (int64_t)ceil(high - 0.5) - first, rows = count < ROWS_MAX ? count : ROWS_MAX;
	for (int64_t i = 0; i < rows; i++) {
		int64_t y = first + (2 * i + 1) * count / (2 * rows);
		double from, end;
		cross(p, (double)y + 0.5, &from, &end);
		if (!(from < end))
			continue;
		int64_t x0 = (int64_t)ceil(from - 0.5), x1 = (int64_t)ceil(end - 0.5);
		add_span(texels, sum, y, x0, x1);
		blocks += x1 - x0;
	}
	return blocks;
}

/* SAMPLES^2 congruent parts, sampled at their centres. */
static void sum_samples(const struct lod_texels *texels, const int32_t uv[6], struct lod_texel_sum *sum)
{
	for (int i = 0; i < SAMPLES; i++)
		for (int j = 0; i + j < SAMPLES; j++)
			for (int flip = 0; flip < (i + j < SAMPLES - 1 ? 2 : 1); flip++) {
				double b = (3 * i + 1 + flip) / (3.0 * SAMPLES), c = (3 * j + 1 + flip) / (3.0 * SAMPLES), a = 1 - b - c;
				add_texel(texels, sum, lod_texel_at(texels->image, (a * uv[0] + b * uv[2] + c * uv[4]) / ECO_UV_ONE,
					(a * uv[1] + b * uv[3] + c * uv[5]) / ECO_UV_ONE));
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
	struct lod_texel_sum sum = { .all = 0 };
	if (sum_rows(texels, uv, &sum) < SAMPLES * SAMPLES) {
		sum = (struct lod_texel_sum){ .all = 0 };
		sum_samples(texels, uv, &sum);
	}
	*seen = (struct lod_texel_seen){ .used = true, .share = sum.all ? (double)sum.opaque / (double)sum.all : 0 };
	memcpy(seen->uv, uv, sizeof seen->uv);
	for (int k = 0; k < 3 && sum.opaque; k++)
		seen->rgb[k] = lod_light_byte((double)sum.light[k] / (double)sum.opaque);
	return seen;
}

double lod_texels_mean(struct lod_texels *texels, const uint8_t tint[3], const int32_t uv[6], uint8_t rgb[3])
{
	const struct lod_texel_seen *seen = look_up(texels, uv);
	if (seen->share > 0)
		lod_texel_tint(seen->rgb, tint, rgb);
	else
		memcpy(rgb, tint, 3);
	return seen->share;
}
