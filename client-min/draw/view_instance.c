#include "client-min/draw/view_instance.h"

#include <string.h>

#include "client-min/draw/view_shade.h"

static void put_float(uint32_t *at, double v)
{
	float f = (float)v;
	memcpy(at, &f, sizeof f);
}

/* As lod/raster/raster.c makes them: differences in double, then rounded once. */
void view_instance_write(uint32_t *words, const struct lod_eye *eye, const struct view_instance *p,
	const struct view_plant *plant)
{
	const struct lod_place *place = &p->place;
	const double *axes[3] = { eye->right, eye->up, eye->forward };
	double offset[3] = { place->at[0] - eye->at[0], place->at[1] - eye->at[1],
		place->at[2] - eye->at[2] };
	double sine = place->sine * place->scale, cosine = place->cosine * place->scale;
	for (int i = 0; i < 3; i++) {
		const double *a = axes[i];
		put_float(words++, a[0] * cosine + a[1] * sine);
		put_float(words++, a[1] * cosine - a[0] * sine);
		put_float(words++, a[2] * place->scale);
		put_float(words++, a[0] * offset[0] + a[1] * offset[1] + a[2] * offset[2]);
	}
	put_float(words++, place->scale);
	put_float(words++, plant ? view_shape_of(plant).half_width : 0);
	memset(words, 0, 2 * sizeof *words);
}
