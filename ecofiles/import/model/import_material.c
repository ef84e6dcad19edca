/* Shared by readers of models: colours, materials. */
#include "ecofiles/base/memory.h"
#include "ecofiles/import/model/import_model.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/image.h"

#define ALPHA_SLACK 1e-3         /* alpha equal to the cutoff is opaque, whatever the rounding */

uint8_t eco_byte_from_share(double share)
{
	return share > 0 ? share < 1 ? (uint8_t)(share * 255 + 0.5) : 255 : 0;
}

uint8_t eco_srgb_from_linear(double linear)
{
	return eco_byte_from_share(
		linear <= 0.0031308 ? linear * 12.92 : 1.055 * pow(linear, 1 / 2.4) - 0.055);
}

bool eco_alpha_shows(double alpha) { return alpha * 255 + ALPHA_SLACK >= 127.5; }

double eco_linear_from_srgb(uint8_t srgb)
{
	double s = srgb / 255.0;
	return s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
}

#define HUE_LEAST 8u                  /* least difference between a colour's channels that is a hue, sRGB */
#define LIGHT_LEAST 96u               /* least value of a default grey; somebody chose a darker one */

static bool is_grey(const uint8_t rgb[3])
{
	uint8_t low = rgb[0] < rgb[1] ? rgb[0] : rgb[1], high = rgb[0] > rgb[1] ? rgb[0] : rgb[1];
	return (rgb[2] > high ? rgb[2] : high) - (rgb[2] < low ? rgb[2] : low) < (int)HUE_LEAST;
}

/* White of glTF, and .8 of other programs, linear or not. */
static bool is_default(const uint8_t rgb[3])
{
	return (rgb[0] == 255 || rgb[0] == 231 || rgb[0] == 204) && rgb[1] == rgb[0] && rgb[2] == rgb[0];
}

static bool is_one_grey(const struct eco_model *model)
{
	const uint8_t *first = NULL;
	bool defaults = true;
	for (uint32_t t = 0; t < model->triangle_count; t++) {
		const struct eco_material *m = &model->materials[model->material[t]];
		defaults = defaults && (m->colourless || is_default(m->rgb));
		if (m->image != ECO_NONE || (first && memcmp(first, m->rgb, 3) != 0 && !defaults))
			return false;
		first = m->rgb;
	}
	return first && (defaults || (is_grey(first) && first[0] >= LIGHT_LEAST));
}

#define RAMP_STEPS 8u                 /* of a channel, as eco_tint_step makes them */
#define RAMP_OTHER 64u                /* values of the other channels are below */
#define RAMP_LEAST 4u                 /* of them are there, from the lowest two to the highest two */

/* Whether all colours are shades of one primary, from black to full; or (channel 3) shades of white in
 * steps of vertex colours, which so are shade. */
static bool is_ramp(const struct eco_model *model, int channel)
{
	bool there[RAMP_STEPS] = { false };
	uint32_t count = 0;
	for (uint32_t t = 0; t < model->triangle_count; t++) {
		const struct eco_material *m = &model->materials[model->material[t]];
		const uint8_t *rgb = m->rgb;
		uint8_t step[3] = { rgb[0], rgb[1], rgb[2] };
		eco_tint_step(step);
		if (m->image != ECO_NONE ||
			(channel == 3 && (rgb[1] != rgb[0] || rgb[2] != rgb[0] || step[0] != rgb[0])))
			return false;
		if (channel < 3 && (m->colourless || is_default(rgb)))
			continue;
		if (channel < 3 &&
			(rgb[(channel + 1) % 3] >= RAMP_OTHER || rgb[(channel + 2) % 3] >= RAMP_OTHER))
			return false;
		there[rgb[channel % 3] * RAMP_STEPS / 256] = true;
	}
	for (uint32_t i = 0; i < RAMP_STEPS; i++)
		count += there[i];
	return count >= RAMP_LEAST && (channel == 3 || there[0] || there[1])
		&& (there[RAMP_STEPS - 2] || there[RAMP_STEPS - 1]);
}

void eco_model_see_colourless(struct eco_model *model, struct eco_notes *notes)
{
	bool red = is_ramp(model, 0), blue = is_ramp(model, 2), shaded = is_ramp(model, 3);
	if (shaded)
		eco_note(notes, "its vertex colours are shades of grey alone, on white: they are taken for "
			"shade, not for colours; give its materials colours if it is white or grey");
	if (red || blue)
		eco_note(notes, "its vertex colours run from black to %s: they are taken for weights of wind "
			"and shade, not for colours", red ? "red" : "blue");
	bool colourless = red || blue || shaded || is_one_grey(model);
	for (uint32_t i = 0; colourless && i < model->material_count; i++)
		model->materials[i].colourless = true;
}

void eco_model_see_invisible(bool *invisible, uint32_t count, struct eco_notes *notes)
{
	for (uint32_t i = 0; i < count; i++)
		if (!invisible[i])
			return;
	if (count == 0)
		return;
	memset(invisible, 0, count * sizeof *invisible);
	eco_note(notes, "all of its materials are fully transparent (d, Tr, opacity): taken for opaque");
}

/* ---- Pictures ----
 * Textures of models: found, decoded, brought to one rule of alpha, each once.
 *
 * Alpha: afterwards the threshold is 128 everywhere; a cutoff and the material's own alpha are multiplied
 * into the texels. Lists of triangles say which image they have, not whether its alpha counts. An image
 * that is not cut out gets alpha 255 all over, and a texture used both ways becomes two images. */

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

#define FAINT 13                 /* texels of less alpha are clear */
#define SHOWN_LEAST 4            /* one of so many that are not clear is to show at 0.5 */

/* The factor of a blended picture's alpha: where 0.5 would cut away most of what is not clear, the largest
 * alpha becomes 1, so that the cut is at half of it. */
static double blended_gain(const struct eco_image *image, double gain)
{
	uint64_t seen = 0, shown = 0;
	uint8_t most = 0;
	for (size_t i = 0; i < (size_t)image->width * image->height; i++) {
		uint8_t alpha = image->rgba[i * 4 + 3];
		seen += alpha >= FAINT;
		shown += eco_alpha_shows(alpha * gain / 255);
		most = alpha > most ? alpha : most;
	}
	return most >= FAINT && SHOWN_LEAST * shown < seen ? 255.0 / most : gain;
}

/* Applies the key's alpha rule; returns whether any texel is cut out. If none is, alpha becomes 255. */
static bool apply_alpha(struct eco_image *image, const struct eco_image_key *key)
{
	size_t count = (size_t)image->width * image->height;
	uint8_t table[256];
	bool cutout = false;
	double gain = key->alpha == ECO_ALPHA_BY_IMAGE ? blended_gain(image, (double)key->gain) : (double)key->gain;
	for (int i = 0; i < 256; i++) {
		double alpha = i * gain + ALPHA_SLACK;
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

void eco_images_start(struct eco_images *images)
{
	images->model->images = eco_alloc(ECO_MODEL_IMAGES_MAX, sizeof *images->model->images);
	images->model->image_count = 0;
	images->keys = eco_alloc(ECO_MODEL_IMAGES_MAX, sizeof *images->keys);
	images->pixels = 0;
}

/* Index of the decoded image. Its alpha is 255 all over unless some of it is cut out; then 128 is the
 * threshold. ECO_NONE: it cannot be read, which is noted once; failures are remembered, too, as images
 * without rgba. */
static uint32_t get_image(struct eco_images *images, const struct eco_image_wanted *wanted, bool *cutout)
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
		*key = (struct eco_image_key){ .texture = eco_copy_text(wanted->texture),
			.opacity = wanted->opacity ? eco_copy_text(wanted->opacity) : NULL,
			.alpha = wanted->alpha, .gain = wanted->gain };
		m->image_count++;
		load_image(images, key, &m->images[i]);
	}
	*cutout = images->keys[i].cutout;
	return m->images[i].rgba ? i : ECO_NONE;
}

void eco_material_take_picture(struct eco_material *material, struct eco_images *images,
	const struct eco_image_wanted *wanted, bool replaces)
{
	material->image = wanted->texture ? get_image(images, wanted, &material->cutout) : ECO_NONE;
	if (material->image == ECO_NONE)
		material->colourless = is_grey(material->rgb);
	else if (replaces)
		memset(material->rgb, 255, 3);
}

void eco_images_end(struct eco_images *images)
{
	struct eco_model *m = images->model;
	uint32_t as[ECO_MODEL_IMAGES_MAX];
	for (uint32_t i = 0; i < m->image_count; i++) {
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
