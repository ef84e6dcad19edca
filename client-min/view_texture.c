#include "client-min/view_texture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/light.h"
#include "lod/raster/texel.h"

#define LEVELS_MAX 33

/* RGB, and in place of alpha how much of it is opaque: 0 none, 255 all. */
struct level { uint32_t width, height; uint8_t *texels; };

static size_t count_of(const struct level *level) { return (size_t)level->width * level->height; }

/* Each texel is the mean of up to four, by how much of them is opaque. The mean is not clear if one of the
 * four is not. */
static void pull(const struct level *fine, const struct level *coarse)
{
	for (uint32_t y = 0; y < coarse->height; y++)
		for (uint32_t x = 0; x < coarse->width; x++) {
			uint32_t sum[3] = { 0 }, weight = 0, of = 0;
			for (uint32_t v = 2 * y; v < 2 * y + 2 && v < fine->height; v++)
				for (uint32_t u = 2 * x; u < 2 * x + 2 && u < fine->width; u++, of++) {
					const uint8_t *texel = fine->texels
						+ 4 * ((size_t)v * fine->width + u);
					for (int k = 0; k < 3; k++)
						sum[k] += texel[3] * texel[k];
					weight += texel[3];
				}
			uint8_t *mean = coarse->texels + 4 * ((size_t)y * coarse->width + x);
			for (int k = 0; k < 3; k++)
				mean[k] = (uint8_t)(weight ? (sum[k] + weight / 2) / weight : 0);
			mean[3] = (uint8_t)((weight + of - 1) / of);
		}
}

/* Clear texels take the colour of the coarser level. */
static void push(const struct level *coarse, const struct level *fine)
{
	for (uint32_t y = 0; y < fine->height; y++)
		for (uint32_t x = 0; x < fine->width; x++) {
			uint8_t *texel = fine->texels + 4 * ((size_t)y * fine->width + x);
			if (texel[3] == 0)
				memcpy(texel, coarse->texels + 4 * ((size_t)(y / 2) * coarse->width + x / 2),
					3);
		}
}

uint8_t *view_texture_fill(const struct eco_image *image)
{
	struct level levels[LEVELS_MAX] = { { image->width, image->height, NULL } };
	size_t sum = count_of(&levels[0]);
	int count = 1;
	for (; levels[count - 1].width > 1 || levels[count - 1].height > 1; count++) {
		levels[count] = (struct level){ (levels[count - 1].width + 1) / 2,
			(levels[count - 1].height + 1) / 2, NULL };
		sum += count_of(&levels[count]);
	}
	uint8_t *texels = malloc(4 * sum), *at = texels;
	if (!texels)
		return NULL;
	for (int i = 0; i < count; at += 4 * count_of(&levels[i++]))
		levels[i].texels = at;
	memcpy(texels, image->rgba, 4 * count_of(&levels[0]));
	for (size_t i = 0; i < count_of(&levels[0]); i++)
		texels[4 * i + 3] = image->rgba[4 * i + 3] >= 128 ? 255 : 0;
	for (int i = 1; i < count; i++)
		pull(&levels[i - 1], &levels[i]);
	bool any = levels[count - 1].texels[3] > 0;
	for (int i = count - 1; i > 0 && any; i--)
		push(&levels[i], &levels[i - 1]);
	for (size_t i = 0; i < count_of(&levels[0]); i++)
		texels[4 * i + 3] = image->rgba[4 * i + 3];
	return texels;
}

/* ---- In software ---- */

#define STEPS_MAX 6                      /* samples along each side of a pixel */

/* A pixel's side in the texture: at least a texel long. Returns its length in texels. */
static double side_of(const struct eco_image *image, const double from[2], const double to[2], int axis,
	double side[2])
{
	double size[2] = { image->width, image->height }, texels = 0;
	for (int k = 0; k < 2; k++) {
		side[k] = to[k] - from[k];
		texels += side[k] * size[k] * side[k] * size[k];
	}
	texels = sqrt(texels);
	if (texels >= 1)
		return texels;
	side[axis] = 1 / size[axis];
	side[1 - axis] = 0;
	return 1;
}

void view_texture_mean(const struct eco_image *image, const double uv[3][2], double light[3])
{
	struct lod_light sum = { .weight = 0 };
	double side[2][2];
	int steps[2];
	for (int a = 0; a < 2; a++) {
		double texels = side_of(image, uv[0], uv[1 + a], a, side[a]);
		steps[a] = texels < STEPS_MAX - 1 ? 1 + (int)ceil(texels) : STEPS_MAX;
	}
	for (int i = 0; i < steps[0]; i++)
		for (int j = 0; j < steps[1]; j++) {
			double a = (i + 0.5) / steps[0] - 0.5, b = (j + 0.5) / steps[1] - 0.5;
			const uint8_t *texel = lod_texel_at(image, uv[0][0] + a * side[0][0] + b * side[1][0],
				uv[0][1] + a * side[0][1] + b * side[1][1]);
			if (texel[3] >= 128)
				lod_light_add(&sum, texel, 1);
		}
	if (!(sum.weight > 0))
		lod_light_add(&sum, lod_texel_at(image, uv[0][0], uv[0][1]), 1);
	for (int k = 0; k < 3; k++)
		light[k] = sum.sum[k] / sum.weight;
}
