#include "lod/build/impostor/plant_impostor.h"

#include <stdlib.h>

#include "lod/build/impostor/impostor_make.h"

#define DRAFT_PIXELS 160u        /* of curves: below, a build is a draft */
#define DRAFT_LEVELS 2u
/* A triangle takes about 6 bytes in a pack, a texel of an image 0.4 to 0.7. Beyond the first, levels that need
 * about twice the bytes of all of them are left out: the plant itself is sooner there. */
#define BYTES_OF_TRIANGLE 12u
#define BYTES_OF_TEXEL 1u

static enum eco_code write_level(struct eco_bytes *bytes, const struct lod_impostors *made, uint32_t level,
	struct eco_error *error)
{
	struct eco_writer w = { 0 };
	enum eco_code code = eco_impostor_level_write(&w, &made->body, &made->levels[level], NULL, error);
	if (code)
		eco_writer_free(&w);
	else
		*bytes = (struct eco_bytes){ w.bytes, w.size };
	return code;
}

static size_t level_bytes_most(const struct eco_model *model)
{
	size_t bytes = (size_t)BYTES_OF_TRIANGLE * model->triangle_count;
	for (uint32_t i = 0; i < model->image_count; i++)
		bytes += (size_t)BYTES_OF_TEXEL * model->images[i].width * model->images[i].height;
	return bytes;
}

/* How level the plant's leaves lie, as its points say; 0 where it has none. */
static uint8_t level_code(const struct lod_plant *plant)
{
	for (uint32_t i = 0; i < plant->list_count; i++)
		if (plant->lists[i].list.kind == ECO_LIST_POINTS && plant->lists[i].list.level)
			return plant->lists[i].list.level;
	return 0;
}

enum eco_code lod_plant_add_impostor(struct lod_plant *plant, const struct eco_model *model,
	const uint8_t (*rgb)[3], const struct lod_plant_options *options, struct eco_error *error)
{
	struct lod_impostors made;
	bool draft = options->pixels && options->pixels < DRAFT_PIXELS;
	struct lod_impostors_options how = { .levels = draft ? DRAFT_LEVELS : 0, .rgb = rgb,
		.progress = options->progress, .each = options->each, .ctx = options->ctx };
	enum eco_code code = lod_impostors_make(&made, model, &how, error);
	if (code)
		return code;
	plant->impostor = calloc(made.level_count + 1u, sizeof *plant->impostor);
	if (!plant->impostor)
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for an impostor");
	for (uint32_t i = 0; i < made.level_count && !code; i++) {
		code = write_level(&plant->impostor[i], &made, i, error);
		if (!code && i && plant->impostor[i].size > level_bytes_most(model)) {
			free(plant->impostor[i].at);
			plant->impostor[i] = (struct eco_bytes){ 0 };
			break;
		}
		plant->impostor_count += !code;
	}
	lod_impostors_free(&made);
	if (!code && plant->impostor_count) {
		plant->impostor_level = level_code(plant);
		plant->ladders[plant->ladder_count - 1].impostor = plant->list_count;
	}
	return code;
}

enum eco_code lod_plant_open_impostor(struct lod_impostor *impostor, const struct lod_plant *plant,
	uint32_t level, struct eco_error *error)
{
	struct eco_impostor_body body;
	struct eco_impostor_level read;
	enum eco_code code = eco_impostor_level_read(&read, &body, plant->impostor[level].at,
		plant->impostor[level].size, error);
	if (code)
		return code;
	code = lod_impostor_open(impostor, &body, &read, error);
	eco_impostor_level_free(&read);
	return code;
}
