/* Pictures that are palettes: every triangle shows one colour of it, as models of few triangles have it. They
 * become colours of materials, which no coder of pictures blurs into those beside them. */
#include "ecofiles/import/model/import_model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PALETTE_MOST 256u        /* colours of one picture: more are no palette */
#define TEXELS_MOST 4096         /* under a triangle: more are no swatch */
#define SLACK 1e-3               /* of a texel */
#define PLACE_MOST 1e12          /* in texels: beyond, one texel more is no other place */

struct colours { uint8_t seen[PALETTE_MOST][3]; uint32_t count; };

struct palettes {
	struct eco_model *model;
	bool *is_palette;            /* per image */
	uint8_t (*rgb)[3];           /* per triangle, of the texels that it shows */
	struct colours *colours;     /* per image */
};

static uint32_t wrap(double texel, uint32_t size)
{
	double left = fmod(texel, size);
	return (uint32_t)(left < 0 ? left + size : left);
}

/* The texels along axis k of the image under a triangle. */
static void span(const struct eco_model *m, uint32_t t, int k, double size, double *first, double *count)
{
	double low = INFINITY, high = -INFINITY;
	for (int c = 0; c < 3; c++) {
		double at = m->uv[2 * (size_t)m->index[3 * (size_t)t + (size_t)c] + (size_t)k] * size;
		low = fmin(low, at);
		high = fmax(high, at);
	}
	*first = floor(low + SLACK);
	*count = fmax(floor(high - SLACK) - *first, 0) + 1;
}

/* False if the triangle shows several colours, or clear texels. */
static bool one_colour(const struct eco_model *m, uint32_t t, const struct eco_image *image, uint8_t rgb[3])
{
	double x, y, width, height;
	const uint8_t *one = NULL;
	span(m, t, 0, image->width, &x, &width);
	span(m, t, 1, image->height, &y, &height);
	if (!(fabs(x) + fabs(y) <= PLACE_MOST && width * height <= TEXELS_MOST))
		return false;
	for (double v = y; v < y + height; v++)
		for (double u = x; u < x + width; u++) {
			const uint8_t *texel = image->rgba + 4 * ((size_t)wrap(v, image->height) * image->width
				+ wrap(u, image->width));
			if (texel[3] < 128 || (one && memcmp(one, texel, 3) != 0))
				return false;
			one = texel;
		}
	memcpy(rgb, one, 3);
	return true;
}

static bool see_colour(struct colours *c, const uint8_t rgb[3])
{
	for (uint32_t i = c->count; i-- > 0;)
		if (memcmp(c->seen[i], rgb, 3) == 0)
			return true;
	if (c->count == PALETTE_MOST)
		return false;
	memcpy(c->seen[c->count++], rgb, 3);
	return true;
}

/* As many pictures as there is room for all colours of all their materials. */
static void keep_room(struct palettes *p)
{
	const struct eco_model *m = p->model;
	uint64_t total = 0;
	for (uint32_t i = 0; i < m->image_count; i++) {
		uint64_t users = 0;
		for (uint32_t k = 0; k < m->material_count; k++)
			users += m->materials[k].image == i;
		uint64_t own = users * p->colours[i].count;
		p->is_palette[i] = p->is_palette[i] && total + own <= ECO_TINTS_MAX;
		total += p->is_palette[i] ? own : 0;
	}
}

static void find_palettes(struct palettes *p)
{
	struct eco_model *m = p->model;
	memset(p->is_palette, true, m->image_count);
	for (uint32_t t = 0; t < m->triangle_count; t++) {
		uint32_t image = m->materials[m->material[t]].image;
		if (image != ECO_NONE && p->is_palette[image])
			p->is_palette[image] = one_colour(m, t, &m->images[image], p->rgb[t])
				&& see_colour(&p->colours[image], p->rgb[t]);
	}
	keep_room(p);
}

static void drop_palettes(struct eco_model *m, const bool *is_palette)
{
	uint32_t kept = 0;
	for (uint32_t i = 0; i < m->image_count; i++) {
		for (uint32_t k = 0; k < m->material_count; k++) {
			struct eco_material *of = &m->materials[k];
			if (of->image == i) {
				of->image = is_palette[i] ? ECO_NONE : kept;
				of->cutout &= !is_palette[i];
			}
		}
		if (is_palette[i])
			free(m->images[i].rgba);
		else
			m->images[kept++] = m->images[i];
	}
	m->image_count = kept;
}

static bool paint(struct palettes *p)
{
	struct eco_tints tints;
	struct eco_model *m = p->model;
	bool good = eco_tints_start(&tints, m);
	for (uint32_t t = 0; good && t < m->triangle_count; t++) {
		uint32_t image = m->materials[m->material[t]].image;
		if (image != ECO_NONE && p->is_palette[image])
			m->material[t] = eco_tints_get(&tints, m->material[t], p->rgb[t]);
	}
	eco_tints_end(&tints);
	if (good)
		drop_palettes(m, p->is_palette);
	return good;
}

bool eco_model_take_palettes(struct eco_model *model)
{
	struct palettes p = { .model = model, .is_palette = calloc((size_t)model->image_count + 1, 1),
		.rgb = malloc(((size_t)model->triangle_count + 1) * sizeof *p.rgb),
		.colours = calloc((size_t)model->image_count + 1, sizeof *p.colours) };
	bool good = p.is_palette && p.rgb && p.colours;
	if (good && model->uv && model->image_count > 0) {
		find_palettes(&p);
		good = paint(&p);
	}
	free(p.is_palette);
	free(p.rgb);
	free(p.colours);
	return good;
}
