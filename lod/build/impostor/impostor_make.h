/* Impostors (ecofiles/format/impostor.h) of a plant, from pictures of its model.
 *
 *   lod_impostors_make(&impostors, model, &options, &error);
 *   impostors.levels[0 .. level_count)                      the smallest first
 *   lod_impostors_free(&impostors);
 *
 * Each level has as many texels as the plant covers in each of its tiles, those that are covered most. All
 * that decides is + - * / and square roots in a fixed order: the same on every machine and with any number of
 * threads. */
#pragma once

#include "ecofiles/format/impostor.h"
#include "ecofiles/format/model.h"
#include "lod/build/plant.h"
#include "lod/impostor.h"

struct lod_impostors {                   /* owns its levels */
	struct eco_impostor_body body;
	uint32_t level_count;                /* 0: the model shows nothing */
	struct eco_impostor_level levels[ECO_IMPOSTOR_LEVELS];
};

struct lod_impostors_options {
	uint32_t levels;                     /* at most; 0: all */
	const uint8_t (*rgb)[3];             /* per triangle of the model; NULL: from its materials */
	/* as in lod_plant_options */
	bool (*progress)(void *ctx, double share);
	lod_each *each;
	void *ctx;
};

/* ECO_INTERRUPTED where progress says so. */
enum eco_code lod_impostors_make(struct lod_impostors *impostors, const struct eco_model *model,
	const struct lod_impostors_options *options, struct eco_error *error);
void lod_impostors_free(struct lod_impostors *impostors);

/* A plant's impostor, as bytes for a pack. */

/* Makes the impostor's levels and adds them to the plant and its last ladder, which shows the whole plant
 * with splats. A draft has fewer levels. `rgb` as in lod_impostors_options. */
enum eco_code lod_plant_add_impostor(struct lod_plant *plant, const struct eco_model *model,
	const uint8_t (*rgb)[3], const struct lod_plant_options *options, struct eco_error *error);

/* Opens a level as a client does. Close it. */
void lod_plant_open_impostor(struct lod_impostor *impostor, const struct lod_plant *plant, uint32_t level);
