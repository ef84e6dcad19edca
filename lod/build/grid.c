/* The choice of a plant's grid. The error of rounding corners is proportional to the step, and so, to first
 * order, are the wrong pixels along edges: one measurement predicts the bits, a second confirms them. One
 * grid serves all of a plant, also where cells divide it (lod/EXPERIMENTS.md, A grid for each cell). */
#include "lod/build/grid.h"

#include <math.h>

#include "lod/ladder.h"
#include "lod/build/measure/probe.h"
#include "lod/build/model_draw.h"

#define VIEWS 8u
#define HIGH_PX 512.0
#define SIDE_MAX 2048.0

double lod_grid_nearest_m(const struct eco_list *list, double pixel_rad)
{
	double square = 0;
	for (int i = 0; i < 3; i++)
		square += 0.25 * list->grid_step[i] * list->grid_step[i];
	return 2 * sqrt(square) / pixel_rad;
}

uint32_t lod_grid_bits_least(const struct eco_model *model)
{
	float low[3] = { 0 }, high[3] = { 0 };
	double extent = 0;
	uint32_t bits = LOD_GRID_BITS_MIN;
	lod_model_bounds(model, low, high);
	for (int a = 0; a < 3; a++)
		extent = fmax(extent, (double)high[a] - low[a]);
	for (; bits < LOD_GRID_BITS_MAX; bits++) {
		double step = ldexp(extent, -(int)bits);
		if (lod_grid_nearest_m(&(struct eco_list){ .grid_step = { step, step, step } },
				LOD_GRID_PIXEL_RAD) <= LOD_GRID_NEAR_M)
			break;
	}
	return bits;
}

/* Side of pictures in which the plant's height, seen from the side, is HIGH_PX. */
static uint32_t picture_side(const struct lod_plant *plant, const struct lod_probe *probe)
{
	double height = plant->plant.height_m > 0 ? plant->plant.height_m : 2 * probe->radius,
		side = HIGH_PX * 2 * probe->radius / height;
	return side < HIGH_PX ? (uint32_t)HIGH_PX : side > SIDE_MAX ? (uint32_t)SIDE_MAX : (uint32_t)side;
}

static void add_full_detail(struct lod_probe *probe)
{
	for (uint32_t i = 0; i < probe->plant->ladder_count; i++) {
		const struct eco_ladder *ladder = &probe->plant->ladders[i];
		struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
		struct lod_way way;
		if (ladder->flags & (ECO_LADDER_FAR | ECO_LADDER_WHOLE))
			continue;
		lod_way_begin(&way, &probe->scene, ladder);
		uint32_t count = lod_way_cuts(&way, way.full, 1, 0, cuts);
		for (uint32_t k = 0; k < count; k++)
			lod_probe_add(probe, &cuts[k]);
	}
}

double lod_grid_loss(const struct lod_plant *plant, const struct eco_model *model,
	const struct lod_plant_options *options)
{
	struct lod_probe probe;
	struct lod_probe_result result = { 0 };
	lod_probe_init(&probe, plant, model, &(struct lod_probe_options){ .views = 1, .pixels = 1 });
	uint32_t side = picture_side(plant, &probe);
	lod_probe_free(&probe);
	lod_probe_init(&probe, plant, model,
		&(struct lod_probe_options){ VIEWS, side, options->each, options->ctx });
	if (lod_probe_keep_model(&probe)) {
		add_full_detail(&probe);
		lod_probe_compare(&probe, 1, &result);
	}
	lod_probe_free(&probe);
	return result.worst;
}

static enum eco_code rebuild(struct lod_plant *plant, const struct eco_model *model,
	const struct lod_plant_options *options, uint32_t bits, double *loss, struct eco_error *error)
{
	struct lod_plant_options finer = *options;
	if (finer.order == LOD_ORDER_GREEDY)         /* a draft: full detail decides the grid */
		finer.order = LOD_ORDER_COMBINED;
	finer.grid_bits = bits;
	finer.progress = NULL;
	lod_plant_free(plant);
	enum eco_code code = lod_plant_build(plant, model, &finer, error);
	lod_plant_enter(options, LOD_STAGE_CURVES);
	*loss = code ? 0 : lod_grid_loss(plant, model, options);
	return code;
}

static uint32_t predict(uint32_t bits, double loss)
{
	do {
		bits++;
		loss /= 2;
	} while (loss > LOD_GRID_LOSS && bits < LOD_GRID_BITS_MAX);
	return bits;
}

/* Sets *chosen to the bits of `plant`, and *found if they suffice or more do not help. */
static enum eco_code choose(struct lod_plant *plant, const struct eco_model *model,
	const struct lod_plant_options *options, uint32_t *chosen, bool *found, struct eco_error *error)
{
	uint32_t bits = *chosen, failed = bits - 1;
	double loss = lod_grid_loss(plant, model, options);
	enum eco_code code = ECO_OK;
	*found = true;
	while (!code && loss > LOD_GRID_LOSS && bits < LOD_GRID_BITS_MAX) {
		double before = loss;
		failed = bits;
		bits = predict(bits, loss);
		code = rebuild(plant, model, options, *chosen = bits, &loss, error);
		if (!code && loss > 0.75 * before)
			return rebuild(plant, model, options, *chosen = failed, &loss, error);
	}
	*found = loss <= LOD_GRID_LOSS;
	while (!code && loss < LOD_GRID_LOSS / 2 && bits > failed + 1) {
		code = rebuild(plant, model, options, *chosen = --bits, &loss, error);
		if (!code && loss > LOD_GRID_LOSS)
			return rebuild(plant, model, options, *chosen = bits + 1, &loss, error);
	}
	return code;
}

/* ---- The slow order, once the grid is known ---- */

static enum eco_code rebuild_greedily(struct lod_plant *plant, const struct eco_model *model,
	const struct lod_plant_options *options, uint32_t bits, struct eco_error *error)
{
	struct lod_plant_options final = *options;
	final.grid_bits = bits;
	final.progress_end = 0.5;
	lod_plant_free(plant);
	enum eco_code code = lod_plant_build(plant, model, &final, error);
	lod_plant_enter(options, LOD_STAGE_CURVES);
	return code;
}

enum eco_code lod_grid_choose(struct lod_plant *plant, const struct eco_model *model,
	const struct lod_plant_options *options, struct eco_error *error)
{
	uint32_t bits = lod_grid_bits_least(model);
	bool found;
	enum eco_code code = choose(plant, model, options, &bits, &found, error);
	if (!code && options->order == LOD_ORDER_GREEDY)
		code = rebuild_greedily(plant, model, options, bits, error);
	if (!code)
		lod_solved_add(&plant->solved[LOD_SOLVER_GRID], found);
	return code;
}
