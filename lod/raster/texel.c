#include "lod/raster/texel.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "ecofiles/format/list.h"
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

struct lod_texel_sum { double light[3], opaque, all; };     /* whole numbers in the sums of a row: exact */
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

static void add_sum(struct lod_texel_sum *to, const struct lod_texel_sum *sum, double times)
{
	for (int k = 0; k < 3; k++)
		to->light[k] += times * sum->light[k];
	to->opaque += times * sum->opaque;
	to->all += times * sum->all;
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
	struct lod_texel_sum all = { .all = 0 };
	for (uint32_t y = 0; y < texels->height; y++) {
		struct lod_texel_sum *row = texels->before + (size_t)y * (texels->width + 1);
		for (uint32_t x = 0; x < texels->width; x++) {
			row[x + 1] = row[x];
			add_block(texels, &row[x + 1], x, y);
		}
		add_sum(&all, &row[texels->width], 1);
	}
	for (int k = 0; k < 3; k++)
		texels->rgb[k] = all.opaque > 0 ? lod_light_byte(all.light[k] / all.opaque) : 255;
}

/* Adds `times` the sum of texels in [0, x) of an endlessly repeating row; blocks that x cuts count in
 * part. */
static void add_before(const struct lod_texels *texels, struct lod_texel_sum *to,
	const struct lod_texel_sum *row, double x, double times)
{
	double width = texels->width, turns = floor(x / width), rest = x - turns * width;
	uint32_t i = rest < width ? (uint32_t)rest : texels->width - 1;
	double part = rest - i;
	add_sum(to, &row[texels->width], times * turns);
	add_sum(to, &row[i], times * (1 - part));
	add_sum(to, &row[i + 1], times * part);
}

/* The interval in which the triangle's outline crosses the height y. */
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

static void sum_rows(const struct lod_texels *texels, const int32_t uv[6], struct lod_texel_sum *mean)
{
	double p[3][2], low = INFINITY, high = -INFINITY;
	for (int k = 0; k < 3; k++) {
		p[k][0] = (double)uv[2 * k] * texels->width / ECO_UV_ONE;
		p[k][1] = (double)uv[2 * k + 1] * texels->height / ECO_UV_ONE;
		low = fmin(low, p[k][1]);
		high = fmax(high, p[k][1]);
	}
	int rows = high - low < ROWS_MIN ? ROWS_MIN : high - low < ROWS_MAX ? (int)(high - low) : ROWS_MAX;
	for (int i = 0; i < rows; i++) {
		double y = low + (i + 0.5) / rows * (high - low), from, end;
		cross(p, y, &from, &end);
		if (!(from < end))
			continue;
		const struct lod_texel_sum *row = texels->before + (size_t)wrap(floor(y), texels->height)
			* (texels->width + 1);
		add_before(texels, mean, row, end, 1);
		add_before(texels, mean, row, from, -1);
	}
}

/* For triangles that are a line or a point in the texture: samples their longest side. */
static void sum_line(const struct lod_texels *texels, const int32_t uv[6], struct lod_texel_sum *mean)
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
		struct lod_texel_sum sum = { .all = 0 };
		double at = (i + 0.5) / SAMPLES;
		add_texel(texels, &sum,
			lod_texel_at(texels->image, (a[0] + at * ((double)b[0] - a[0])) / ECO_UV_ONE,
			(a[1] + at * ((double)b[1] - a[1])) / ECO_UV_ONE));
		add_sum(mean, &sum, 1);
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
	struct lod_texel_sum mean = { .all = 0 };
	sum_rows(texels, uv, &mean);
	if (!(mean.all > 0)) {
		mean = (struct lod_texel_sum){ .all = 0 };
		sum_line(texels, uv, &mean);
	}
	/* Differences of large sums leave a small rest where there is nothing. */
	bool any = mean.opaque > LEAST * mean.all;
	*seen = (struct lod_texel_seen){ .used = true, .share = any ? fmin(mean.opaque / mean.all, 1) : 0 };
	memcpy(seen->uv, uv, sizeof seen->uv);
	for (int k = 0; k < 3; k++)
		seen->rgb[k] = any ? lod_light_byte(mean.light[k] / mean.opaque) : texels->rgb[k];
	return seen;
}

double lod_texels_mean(struct lod_texels *texels, const uint8_t tint[3], const int32_t uv[6], uint8_t rgb[3])
{
	const struct lod_texel_seen *seen = look_up(texels, uv);
	lod_texel_tint(seen->rgb, tint, rgb);
	return seen->share;
}
