#include "lod/build/sample.h"

#include <math.h>
#include <string.h>

#include "ecofiles/format/list.h"

#define LATTICE 24               /* steps a side of the lattice that searches opaque texels */

static double area_of(const struct lod_sample_input *in)
{
	double u[3], v[3];
	for (int k = 0; k < 3; k++) {
		u[k] = (double)in->corner[1][k] - in->corner[0][k];
		v[k] = (double)in->corner[2][k] - in->corner[0][k];
	}
	double n[3] = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0] };
	return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2;
}

static const uint8_t *texel(const struct lod_sample_input *in, const double w[3])
{
	double at[2];
	for (int a = 0; a < 2; a++)
		at[a] = (w[0] * in->uv[a] + w[1] * in->uv[2 + a] + w[2] * in->uv[4 + a]) / ECO_UV_ONE;
	return lod_texel_at(in->texels->image, at[0], at[1]);
}

/* Mean barycentric coordinates of opaque points on an even lattice; returns their share, and their last texel
 * in *seen. */
static double opaque_middle(const struct lod_sample_input *in, double middle[3], const uint8_t **seen)
{
	uint32_t hits = 0, all = 0;
	double sum[3] = { 0, 0, 0 };
	for (int i = 0; i < LATTICE; i++)
		for (int j = 0; i + j < LATTICE; j++) {
			double w[3] = { (i + 1 / 3.0) / LATTICE, (j + 1 / 3.0) / LATTICE, 0 };
			w[2] = 1 - w[0] - w[1];
			const uint8_t *at = texel(in, w);
			all++;
			if (at[3] < 128)
				continue;
			hits++;
			*seen = at;
			for (int k = 0; k < 3; k++)
				sum[k] += w[k];
		}
	for (int k = 0; k < 3 && hits; k++)
		middle[k] = sum[k] / hits;
	return (double)hits / all;
}

void lod_sample_triangle(const struct lod_sample_input *in, struct lod_sample *sample)
{
	double middle[3] = { 1 / 3.0, 1 / 3.0, 1 / 3.0 }, found = 1;
	const uint8_t *seen = NULL;
	sample->area = area_of(in);
	memcpy(sample->rgb, in->tint, 3);
	if (in->texels) {
		double share = lod_texels_mean(in->texels, in->tint, in->uv, sample->rgb);
		if (in->texels->cutout)
			found = opaque_middle(in, middle, &seen);
		if (share <= 0 && seen)      /* thinner than the rows that the mean samples */
			lod_texel_tint(seen, in->tint, sample->rgb);
		sample->area *= share > 0 ? share : found;
	}
	for (int k = 0; k < 3; k++)
		sample->at[k] = middle[0] * in->corner[0][k] + middle[1] * in->corner[1][k]
			+ middle[2] * in->corner[2][k];
}
