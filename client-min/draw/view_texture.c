#include "client-min/draw/view_texture.h"

#include <math.h>

#include "lod/light.h"
#include "lod/raster/texel.h"

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
