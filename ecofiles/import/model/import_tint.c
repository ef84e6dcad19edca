/* Vertex colours become materials, one for each colour: lists have a colour per primitive, not per vertex.
 *
 * Colours of textured materials are multiplied into their images, in linear light as glTF means it. Lists
 * of triangles have an image and no colour beside it, while points and lines take their colours from
 * texels and materials: with the product in the texels all of them agree. Each further colour of an image
 * needs a copy of it; beyond a limit the nearest existing colour is used.
 *
 * Afterwards an image of one colour is that colour, and images that are equal texel by texel become one, so
 * that names, alpha modes and cut-offs without effect cost nothing in a pack. */
#include "ecofiles/base/memory.h"
#include "ecofiles/import/model/import_model.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TINTS_MAX 32u                            /* per image */
#define COPIED_PIXELS_MAX ((uint64_t)1 << 26)    /* per model */

/* ---- Colours of vertices ---- */

void eco_tints_start(struct eco_tints *t, struct eco_model *model)
{
	*t = (struct eco_tints){ .model = model, .base = model->material_count };
	model->materials = eco_realloc(model->materials, (size_t)model->material_count + ECO_TINTS_MAX,
		sizeof *model->materials);
	t->key = eco_alloc(ECO_TINTS_MAX, sizeof *t->key);
	t->table = eco_alloc(4 * ECO_TINTS_MAX, sizeof *t->table);
}

static uint32_t distance(const uint8_t a[3], const uint8_t b[3])
{
	uint32_t sum = 0;
	for (int k = 0; k < 3; k++)
		sum += (uint32_t)((a[k] - b[k]) * (a[k] - b[k]));
	return sum;
}

static void tinted(const struct eco_material *from, const uint8_t tint[3], uint8_t rgb[3])
{
	for (int k = 0; k < 3; k++)
		rgb[k] = eco_srgb_from_linear(eco_linear_from_srgb(from->rgb[k])
			* eco_linear_from_srgb(tint[k]));
}

uint32_t eco_tints_get(struct eco_tints *t, uint32_t material, const uint8_t rgb[3])
{
	struct eco_model *m = t->model;
	uint64_t key = (uint64_t)material << 24 | (uint64_t)rgb[0] << 16 | (uint64_t)rgb[1] << 8 | rgb[2];
	uint32_t slot = (uint32_t)((key * 0x9e3779b97f4a7c15u) >> 40) % (4 * ECO_TINTS_MAX);
	if (rgb[0] == 255 && rgb[1] == 255 && rgb[2] == 255)
		return material;
	while (t->table[slot] != 0 && t->key[t->table[slot] - 1] != key)
		slot = (slot + 1) % (4 * ECO_TINTS_MAX);
	if (t->table[slot] != 0)
		return t->base + t->table[slot] - 1;
	if (t->count == ECO_TINTS_MAX)
		return material;
	t->key[t->count++] = key;
	t->table[slot] = t->count;
	/* lod_organs_split knows a surface by its material's name, whatever its colours */
	if (m->materials[material].name[0] == 0)
		snprintf(m->materials[material].name, sizeof m->materials[material].name, "vertex colours %u",
			(unsigned)material + 1);
	struct eco_material *to = &m->materials[m->material_count];
	*to = m->materials[material];
	to->colourless = false;
	tinted(&m->materials[material], rgb, to->rgb);
	return m->material_count++;
}

void eco_tint_step(uint8_t rgb[3])
{
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)((rgb[k] * 7 + 127) / 255 * 255 / 7);
}

void eco_tints_end(struct eco_tints *t)
{
	free(t->key);
	free(t->table);
	*t = (struct eco_tints){ .model = NULL };
}

/* ---- Colours of textures ---- */

struct variant {                 /* an image with one colour */
	uint32_t source, image;      /* the first variant of a source takes its place */
	uint8_t rgb[3];
};

struct tints {
	struct eco_model *model;
	struct variant *variants;
	uint32_t count;
	uint64_t copied_pixels;
	uint32_t replaced;           /* materials that got the nearest colour instead of theirs */
};

/* The variant of `source` nearest in colour, NULL if there is none; and their number. */
static const struct variant *nearest(const struct tints *t, uint32_t source, const uint8_t rgb[3],
	uint32_t *count)
{
	const struct variant *best = NULL;
	*count = 0;
	for (uint32_t i = 0; i < t->count; i++) {
		const struct variant *v = &t->variants[i];
		if (v->source != source)
			continue;
		(*count)++;
		if (!best || distance(v->rgb, rgb) < distance(best->rgb, rgb))
			best = v;
	}
	return best;
}

/* Appends a copy of image `source` to the model's; returns its number. */
static uint32_t copy_image(struct tints *t, uint32_t source)
{
	struct eco_model *m = t->model;
	m->images = eco_realloc(m->images, (size_t)m->image_count + 1, sizeof *m->images);
	struct eco_image *from = &m->images[source], *to = &m->images[m->image_count];
	*to = *from;
	size_t pixels = (size_t)to->width * to->height;
	to->rgba = eco_alloc(pixels + 1, 4);
	memcpy(to->rgba, from->rgba, pixels * 4);
	t->copied_pixels += pixels;
	return m->image_count++;
}

/* Gives the material the variant of its image with its colour; texels do not change until all variants are
 * known. */
static void choose_variant(struct tints *t, struct eco_material *material)
{
	const struct eco_image *image = &t->model->images[material->image];
	uint32_t count, source = material->image;
	const struct variant *v = nearest(t, source, material->rgb, &count);
	struct variant made = { .source = source, .image = source };
	if (v && distance(v->rgb, material->rgb) > 0) {
		if (count < TINTS_MAX && t->model->image_count < ECO_MODEL_IMAGES_MAX
			&& t->copied_pixels + (uint64_t)image->width * image->height <= COPIED_PIXELS_MAX) {
			made.image = copy_image(t, source);
			v = NULL;
		} else {
			t->replaced++;
		}
	}
	if (!v) {
		memcpy(made.rgb, material->rgb, 3);
		t->variants[t->count] = made;
		v = &t->variants[t->count++];
	}
	material->image = v->image;
	memset(material->rgb, 255, 3);
}

static void multiply(struct eco_image *image, const uint8_t rgb[3])
{
	size_t count = (size_t)image->width * image->height;
	uint8_t table[3][256];
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 256; i++)
			table[k][i] = rgb[k] == 255 ? (uint8_t)i
				: eco_srgb_from_linear(eco_linear_from_srgb((uint8_t)i)
				* eco_linear_from_srgb(rgb[k]));
	for (size_t i = 0; i < count; i++)
		for (int k = 0; k < 3; k++)
			image->rgba[i * 4 + (size_t)k] = table[k][image->rgba[i * 4 + (size_t)k]];
}

static bool same_pixels(const struct eco_image *a, const struct eco_image *b)
{
	return a->width == b->width && a->height == b->height
		&& memcmp(a->rgba, b->rgba, (size_t)a->width * a->height * 4) == 0;
}

/* An opaque image of one colour, such as a tool leaves in place of one that it took out. */
static bool is_plain(const struct eco_image *image)
{
	size_t bytes = (size_t)image->width * image->height * 4;
	return bytes > 0 && image->rgba[3] == 255 && memcmp(image->rgba, image->rgba + 4, bytes - 4) == 0;
}

/* Keeps the first of equal images, and none of one colour. */
static void merge_equal(struct eco_model *m)
{
	uint32_t as[ECO_MODEL_IMAGES_MAX];
	for (uint32_t k = 0; k < m->material_count; k++) {
		struct eco_material *of = &m->materials[k];
		if (of->image == ECO_NONE || !is_plain(&m->images[of->image]))
			continue;
		memcpy(of->rgb, m->images[of->image].rgba, 3);
		of->image = ECO_NONE;
		of->cutout = false;
	}
	for (uint32_t i = 0; i < m->image_count; i++) {
		as[i] = is_plain(&m->images[i]) ? ECO_NONE : 0;
		while (as[i] < i && (as[as[i]] != as[i] || !same_pixels(&m->images[as[i]], &m->images[i])))
			as[i]++;
	}
	eco_images_keep(m, as);
}

void eco_model_bake_tints(struct eco_model *model, struct eco_notes *notes)
{
	struct tints t = { .model = model, .variants = eco_alloc(ECO_MODEL_IMAGES_MAX, sizeof *t.variants) };
	for (uint32_t i = 0; i < model->material_count; i++)
		if (model->materials[i].image != ECO_NONE)
			choose_variant(&t, &model->materials[i]);
	for (uint32_t i = 0; i < t.count; i++)
		multiply(&model->images[t.variants[i].image], t.variants[i].rgb);
	free(t.variants);
	if (t.replaced > 0)
		eco_note(notes, "textures are used with more colours than are kept: %u materials are drawn "
			"in the nearest that is", t.replaced);
	merge_equal(model);
}

/* ---- Palettes: pictures whose triangles show one colour each, as models of few triangles have them. They
 * become colours of materials, which no coder of pictures blurs into those beside them ---- */

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
			const uint8_t *texel = image->rgba +
				4 * ((size_t)wrap(v, image->height) * image->width + wrap(u, image->width));
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
	uint32_t as[ECO_MODEL_IMAGES_MAX];
	for (uint32_t k = 0; k < m->material_count; k++)
		if (m->materials[k].image != ECO_NONE)
			m->materials[k].cutout &= !is_palette[m->materials[k].image];
	for (uint32_t i = 0; i < m->image_count; i++)
		as[i] = is_palette[i] ? ECO_NONE : i;
	eco_images_keep(m, as);
}

static void paint(struct palettes *p)
{
	struct eco_tints tints;
	struct eco_model *m = p->model;
	eco_tints_start(&tints, m);
	for (uint32_t t = 0; t < m->triangle_count; t++) {
		uint32_t image = m->materials[m->material[t]].image;
		if (image != ECO_NONE && p->is_palette[image])
			m->material[t] = eco_tints_get(&tints, m->material[t], p->rgb[t]);
	}
	eco_tints_end(&tints);
	drop_palettes(m, p->is_palette);
}

void eco_model_take_palettes(struct eco_model *model)
{
	struct palettes p = { .model = model, .is_palette = eco_alloc((size_t)model->image_count + 1, 1),
		.rgb = eco_alloc((size_t)model->triangle_count + 1, sizeof *p.rgb),
		.colours = eco_alloc((size_t)model->image_count + 1, sizeof *p.colours) };
	if (model->uv && model->image_count > 0) {
		find_palettes(&p);
		paint(&p);
	}
	free(p.is_palette);
	free(p.rgb);
	free(p.colours);
}
