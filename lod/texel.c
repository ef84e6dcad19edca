#include "lod/texel.h"

#include <math.h>
#include <stddef.h>

#include "ecofiles/list.h"

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
		rgb[k] = (uint8_t)((texel[k] * tint[k] + 127) / 255);
}

double lod_texel_mean(const struct eco_image *image, bool cutout, const uint8_t tint[3], const int32_t uv[6], uint8_t rgb[3])
{
	uint32_t sum[3] = { 0, 0, 0 }, hits = 0, n = 0;
	for (int k = 0; k < 3; k++)
		rgb[k] = tint[k];
	/* 16 congruent quarters of quarters, sampled at their centres: (i, j) counts sixths of twelve along two sides. */
	for (int i = 0; i < 4; i++)
		for (int j = 0; i + j < 4; j++)
			for (int flip = 0; flip < (i + j < 3 ? 2 : 1); flip++) {
				double b = (3 * i + 1 + flip) / 12.0, c = (3 * j + 1 + flip) / 12.0, a = 1 - b - c;
				const uint8_t *texel = lod_texel_at(image, (a * uv[0] + b * uv[2] + c * uv[4]) / ECO_UV_ONE,
					(a * uv[1] + b * uv[3] + c * uv[5]) / ECO_UV_ONE);
				n++;
				if (cutout && texel[3] < 128)
					continue;
				hits++;
				for (int k = 0; k < 3; k++)
					sum[k] += texel[k];
			}
	if (hits == 0)
		return 0;
	uint8_t mean[3] = { (uint8_t)(sum[0] / hits), (uint8_t)(sum[1] / hits), (uint8_t)(sum[2] / hits) };
	lod_texel_tint(mean, tint, rgb);
	return (double)hits / n;
}
