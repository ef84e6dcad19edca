/* Textures of models: found, decoded, brought to one rule of alpha, each once.
 *
 * Alpha: afterwards the threshold is 128 everywhere; a cutoff and the material's own alpha are multiplied
 * into the texels. Lists of triangles say which image they have, not whether its alpha counts. An image
 * that is not cut out gets alpha 255 all over, and a texture used both ways becomes two images. */
#include "ecofiles/import/model/import_model.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/image.h"

#define ALPHA_SLACK 1e-3          /* alpha equal to the cutoff is opaque, whatever the rounding */
#define ALL_PIXELS_MAX ((uint64_t)1 << 28)

struct eco_image_key {           /* one decoded image per key */
	char *texture, *opacity;
	enum eco_alpha alpha;
	float gain;
	bool cutout;
};

static enum eco_code decode(struct eco_images *r, struct eco_image *image, const char *name,
	struct eco_error *error)
{
	char path[4096];
	enum eco_code code;
	if (r->embedded && r->embedded(r->ctx, name, image, &code, error))
		return code;
	if (!eco_model_find_beside(r->path, name, path, sizeof path))
		return eco_fail(error, ECO_NOT_FOUND, "no such file beside the model");
	return eco_image_read(image, path, error);
}

/* ---- Alpha ---- */

/* Applies a separate opacity map: its own alpha if it has some, else its brightness; nearest texel. */
static void merge_opacity(struct eco_image *image, const struct eco_image *opacity)
{
	bool own = false;
	for (size_t i = 0; i < (size_t)opacity->width * opacity->height && !own; i++)
		own = opacity->rgba[i * 4 + 3] != 255;
	for (uint32_t y = 0; y < image->height; y++)
		for (uint32_t x = 0; x < image->width; x++) {
			uint32_t ox = (uint32_t)((uint64_t)x * opacity->width / image->width);
			uint32_t oy = (uint32_t)((uint64_t)y * opacity->height / image->height);
			const uint8_t *o = &opacity->rgba[((size_t)oy * opacity->width + ox) * 4];
			image->rgba[((size_t)y * image->width + x) * 4 + 3] = own ? o[3]
				: (uint8_t)((o[0] + o[1] + o[2]) / 3);
		}
}

/* Applies the key's alpha rule; returns whether any texel is cut out. If none is, alpha becomes 255. */
static bool apply_alpha(struct eco_image *image, const struct eco_image_key *key)
{
	size_t count = (size_t)image->width * image->height;
	uint8_t table[256];
	bool cutout = false;
	for (int i = 0; i < 256; i++) {
		double alpha = i * (double)key->gain + ALPHA_SLACK;
		table[i] = key->alpha == ECO_ALPHA_OPAQUE ? 255 : alpha < 255 ? (uint8_t)(alpha + 0.5) : 255;
	}
	for (size_t i = 0; i < count && !cutout; i++)
		cutout = table[image->rgba[i * 4 + 3]] < 128;
	for (size_t i = 0; i < count; i++)
		image->rgba[i * 4 + 3] = cutout ? table[image->rgba[i * 4 + 3]] : 255;
	return cutout;
}

/* ---- Images ---- */

static bool same_key(const struct eco_image_key *a, const struct eco_image_wanted *b)
{
	return strcmp(a->texture, b->texture) == 0 && a->alpha == b->alpha && a->gain == b->gain
		&& (!a->opacity) == (!b->opacity) && (!a->opacity || strcmp(a->opacity, b->opacity) == 0);
}

static bool load_image(struct eco_images *r, struct eco_image_key *key, struct eco_image *image)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_image opacity = { .rgba = NULL };
	if (decode(r, image, key->texture, &error) != ECO_OK) {
		eco_note(r->notes, "texture %.200s: %.300s; its material keeps one colour", key->texture,
			error.text);
		return false;
	}
	if (key->opacity) {
		if (decode(r, &opacity, key->opacity, &error) == ECO_OK)
			merge_opacity(image, &opacity);
		else
			eco_note(r->notes, "opacity map %.200s: %.300s; it is not applied", key->opacity,
				error.text);
		eco_image_free(&opacity);
	}
	r->pixels += (uint64_t)image->width * image->height;
	if (r->pixels > ALL_PIXELS_MAX) {
		eco_note(r->notes, "texture %.200s: the images have more than %llu pixels together; its "
			"material keeps one colour", key->texture, (unsigned long long)ALL_PIXELS_MAX);
		eco_image_free(image);
		return false;
	}
	key->cutout = apply_alpha(image, key);
	return true;
}

bool eco_images_start(struct eco_images *images)
{
	images->model->images = calloc(ECO_MODEL_IMAGES_MAX, sizeof *images->model->images);
	images->model->image_count = 0;
	images->keys = calloc(ECO_MODEL_IMAGES_MAX, sizeof *images->keys);
	images->pixels = 0;
	return images->model->images && images->keys;
}

/* Failures are remembered too, as images without rgba. */
uint32_t eco_images_get(struct eco_images *images, const struct eco_image_wanted *wanted, bool *cutout)
{
	struct eco_model *m = images->model;
	uint32_t i = 0;
	*cutout = false;
	while (i < m->image_count && !same_key(&images->keys[i], wanted))
		i++;
	if (i == ECO_MODEL_IMAGES_MAX)
		return ECO_NONE;
	if (i == m->image_count) {
		struct eco_image_key *key = &images->keys[i];
		*key = (struct eco_image_key){ .texture = strdup(wanted->texture), .opacity = wanted->opacity
			? strdup(wanted->opacity) : NULL, .alpha = wanted->alpha, .gain = wanted->gain };
		if (!key->texture || (wanted->opacity && !key->opacity)) {
			free(key->texture);
			free(key->opacity);
			return ECO_NONE;
		}
		m->image_count++;
		load_image(images, key, &m->images[i]);
	}
	*cutout = images->keys[i].cutout;
	return m->images[i].rgba ? i : ECO_NONE;
}

void eco_images_end(struct eco_images *images)
{
	struct eco_model *m = images->model;
	uint32_t as[ECO_MODEL_IMAGES_MAX];
	for (uint32_t i = 0; i < m->image_count && images->keys; i++) {
		free(images->keys[i].texture);
		free(images->keys[i].opacity);
		as[i] = m->images[i].rgba ? i : ECO_NONE;
	}
	eco_images_keep(m, as);
	free(images->keys);
	images->keys = NULL;
}

void eco_images_keep(struct eco_model *m, const uint32_t *as)
{
	uint32_t number[ECO_MODEL_IMAGES_MAX], kept = 0;
	for (uint32_t i = 0; i < m->image_count; i++) {
		if (as[i] == i) {
			m->images[kept] = m->images[i];
			number[i] = kept++;
		} else {
			free(m->images[i].rgba);
			number[i] = as[i] == ECO_NONE ? ECO_NONE : number[as[i]];
		}
	}
	for (uint32_t k = 0; k < m->material_count; k++)
		if (m->materials[k].image != ECO_NONE)
			m->materials[k].image = number[m->materials[k].image];
	m->image_count = kept;
}
