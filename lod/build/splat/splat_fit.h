/* Levels of splats (ecofiles/format/splat.h) that look like a whole plant, fitted to its coverage in views all
 * around by gradient descent.
 *
 *   lod_splats_fit(&splats, model, &options, &error);
 *   splats.items[lod_splats_first(&splats, l) .. splats.level_end[l])       level l, in draw order
 *   lod_splats_free(&splats);
 *
 * Splats [m i, m (i + 1)) of level l + 1 stand for splat i of level l, in the order in which parents should give
 * way. The same bytes on every machine, with any number of threads. */
#pragma once

#include "ecofiles/format/model.h"
#include "ecofiles/format/splat.h"
#include "lod/build/organ/organ.h"
#include "lod/build/plant.h"

#define LOD_SPLAT_LEVELS 10u             /* most; usually 1, 3, 6, 12, 24, 48, 192, 768, 3072, 12288 splats */

struct lod_splat {
	int32_t at[3];                   /* centre = origin + at * step; 0 <= at < LOD_SPLAT_GRID */
	int32_t code[ECO_SPLAT_CODES];   /* of the shape, in units of `unit` */
	float center[3];                 /* what at and code say, plant space, metres */
	struct eco_splat shape;
	uint8_t rgb[3];                  /* sRGB */
	float wood;                      /* share of what it shows */
};
#define LOD_SPLAT_GRID 4096              /* steps of 1/1024 of the radius */

struct lod_splats {                      /* owns its items */
	struct lod_splat *items;
	uint32_t level_count, level_end[LOD_SPLAT_LEVELS];
	double origin[3], step;
	float unit;                      /* metres: sqrt(unit_area) of a list of these splats */
	double radius, center[3];        /* of the plant's bounding sphere */
	double loss[LOD_SPLAT_LEVELS];   /* 1 - soft Q of each level in the views that it was fitted to */
	/* metres: width of the cells (lod/leaf.h) in which lines are as long as those across leaves, as far as leaves
	 * are seen */
	double leaf;
	double tone;                     /* deviation of the light of what the last level stands for, over the mean */
};

struct lod_splats_options {
	bool draft;                      /* a quarter of the steps */
	uint32_t levels;                 /* at most; 0: as many as the plant's triangles suggest */
	uint32_t views, pixels;          /* fitted to; 0: 55 views of 160 pixels; pixels: a multiple of 8 */
	const uint8_t (*rgb)[3];         /* per triangle of the model; NULL: from materials and textures */
	const uint8_t *organ;            /* the same, enum eco_organ; NULL: nothing is wood */
	const uint32_t *leaf;            /* the same, number of its leaf; ECO_NONE: none; NULL: none are measured */
	/* as in lod_plant_options */
	bool (*progress)(void *ctx, double share);
	lod_each *each;
	void *ctx;
};

/* A model that shows nothing gives no levels. ECO_INTERRUPTED where progress says so. */
enum eco_code lod_splats_fit(struct lod_splats *splats, const struct eco_model *model,
	const struct lod_splats_options *options, struct eco_error *error);
void lod_splats_free(struct lod_splats *splats);

/* Fits splats to the model (splat_fit.h) and appends their list and ladder to a built plant. Appends nothing
 * to a plant that shows nothing. */
enum eco_code lod_plant_add_splats(struct lod_plant *plant, const struct eco_model *model,
	const struct lod_plant_options *options, struct eco_error *error);

static inline uint32_t lod_splats_first(const struct lod_splats *splats, uint32_t level)
{
	return level ? splats->level_end[level - 1] : 0;
}
