/* One triangle's contribution to the point that stands for its leaf: the middle, area and colour of its
 * opaque part. */
#ifndef LOD_SAMPLE_H
#define LOD_SAMPLE_H

#include <stdbool.h>
#include <stdint.h>

#include "lod/raster/texel.h"

struct lod_sample_input {
	const int32_t *corner[3];    /* on the grid */
	const int32_t *uv;           /* 6, in 1/ECO_UV_ONE; used with an image only */
	struct lod_texels *texels;   /* of its image, or NULL */
	const uint8_t *tint;         /* 3: the material's colour, times the texel */
};

struct lod_sample {
	double at[3];                /* on the grid, not rounded */
	double area;                 /* grid steps^2 of the opaque part; 0 if nothing opaque was found */
	uint8_t rgb[3]; /* sRGB: mean light of the opaque part, or of the image's if there is none */
};

/* A cut-out without any opaque texel found gives the triangle's middle. */
void lod_sample_triangle(const struct lod_sample_input *input, struct lod_sample *sample);

#endif
