/* Vertex colours become materials, one for each colour: lists have a colour per primitive, not per vertex.
 *
 * Colours of textured materials are multiplied into their images, in linear light as glTF means it. Lists
 * of triangles have an image and no colour beside it, while points and lines take their colours from
 * texels and materials: with the product in the texels all of them agree. Each further colour of an image
 * needs a copy of it; beyond a limit the nearest existing colour is used.
 *
 * Afterwards an image of one colour is that colour, and images that are equal texel by texel become one, so
 * that names, alpha modes and cut-offs without effect cost nothing in a pack. */
#include "ecofiles/import/model/import_model.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TINTS_MAX 32u                            /* per image */
#define COPIED_PIXELS_MAX ((uint64_t)1 << 26)    /* per model */

/* ---- Colours of vertices ---- */

bool eco_tints_start(struct eco_tints *t, struct eco_model *model)
{
	struct eco_material *grown =
		realloc(model->materials, ((size_t)model->material_count + ECO_TINTS_MAX) * sizeof *grown);
	*t = (struct eco_tints){ .model = model, .base = model->material_count };
	if (grown)
		model->materials = grown;
	t->key = malloc(ECO_TINTS_MAX * sizeof *t->key);
	t->table = calloc(4 * ECO_TINTS_MAX, sizeof *t->table);
	return grown && t->key && t->table;
}

static uint32_t distance(const uint8_t a[3], const uint8_t b[3])
{
	uint32_t sum = 0;
	for (int k = 0; k < 3; k++)
		sum += (uint32_t)((a[k] - b[k]) * (a[k] - b[k]));
	return sum;
}

/* The tint nearest to the one of that material for which there is no room. */
static uint32_t nearest_tint(const struct eco_tints *t, uint32_t material, const uint8_t rgb[3])
{
	const struct eco_material *all = t->model->materials, *own = &all[material];
	uint32_t best = material;
	for (uint32_t i = t->base; i < t->model->material_count; i++)
		if (all[i].image == own->image && all[i].cutout == own->cutout
				&& (best == material
				|| distance(all[i].rgb, rgb) < distance(all[best].rgb, rgb)))
			best = i;
	return best;
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
	if (t->count == ECO_TINTS_MAX) {
		uint8_t wanted[3];
		tinted(&m->materials[material], rgb, wanted);
		return nearest_tint(t, material, wanted);
	}
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

/* Appends a copy of image `source` to the model's. */
static bool copy_image(struct tints *t, uint32_t source, uint32_t *copy)
{
	struct eco_model *m = t->model;
	struct eco_image *images = realloc(m->images, ((size_t)m->image_count + 1) * sizeof *images), *to;
	if (!images)
		return false;
	m->images = images;
	to = &images[m->image_count];
	*to = images[source];
	size_t pixels = (size_t)to->width * to->height;
	to->rgba = malloc(pixels * 4 + 1);
	if (!to->rgba)
		return false;
	memcpy(to->rgba, images[source].rgba, pixels * 4);
	t->copied_pixels += pixels;
	*copy = m->image_count++;
	return true;
}

/* Gives the material the variant of its image with its colour; texels do not change until all variants are
 * known. */
static bool choose_variant(struct tints *t, struct eco_material *material)
{
	const struct eco_image *image = &t->model->images[material->image];
	uint32_t count, source = material->image;
	const struct variant *v = nearest(t, source, material->rgb, &count);
	struct variant made = { .source = source, .image = source };
	if (v && distance(v->rgb, material->rgb) > 0) {
		if (count < TINTS_MAX && t->model->image_count < ECO_MODEL_IMAGES_MAX
			&& t->copied_pixels + (uint64_t)image->width * image->height <= COPIED_PIXELS_MAX) {
			if (!copy_image(t, source, &made.image))
				return false;
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
	return true;
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

static void become_plain(struct eco_model *m, uint32_t image)
{
	for (uint32_t k = 0; k < m->material_count; k++)
		if (m->materials[k].image == image) {
			memcpy(m->materials[k].rgb, m->images[image].rgba, 3);
			m->materials[k].image = ECO_NONE;
			m->materials[k].cutout = false;
		}
}

/* Keeps the first of equal images, and none of one colour. */
static void merge_equal(struct eco_model *m)
{
	uint32_t kept = 0;
	for (uint32_t i = 0; i < m->image_count; i++) {
		uint32_t to = 0;
		if (is_plain(&m->images[i])) {
			become_plain(m, i);
			free(m->images[i].rgba);
			continue;
		}
		while (to < kept && !same_pixels(&m->images[to], &m->images[i]))
			to++;
		for (uint32_t k = 0; k < m->material_count; k++)
			if (m->materials[k].image == i)
				m->materials[k].image = to;
		if (to < kept)
			free(m->images[i].rgba);
		else
			m->images[kept++] = m->images[i];
	}
	m->image_count = kept;
}

enum eco_code eco_model_bake_tints(struct eco_model *model, const char *path, struct eco_notes *notes,
	struct eco_error *error)
{
	struct tints t = { .model = model, .variants = malloc(ECO_MODEL_IMAGES_MAX * sizeof *t.variants) };
	bool good = t.variants != NULL;
	for (uint32_t i = 0; good && i < model->material_count; i++)
		if (model->materials[i].image != ECO_NONE)
			good = choose_variant(&t, &model->materials[i]);
	for (uint32_t i = 0; good && i < t.count; i++)
		multiply(&model->images[t.variants[i].image], t.variants[i].rgb);
	free(t.variants);
	if (!good)
		return eco_fail(error, ECO_NO_MEMORY, "%s: out of memory for its textures", path);
	if (t.replaced > 0)
		eco_note(notes, "textures are used with more colours than are kept: %u materials are drawn "
			"in the nearest that is", t.replaced);
	merge_equal(model);
	return ECO_OK;
}
