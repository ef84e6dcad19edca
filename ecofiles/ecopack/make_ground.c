/* The ground of a pack: read, continued to the horizon, rounded to the pack's heights, cut into tiles. */
#include "ecofiles/ecopack/make.h"

#include <math.h>
#include <stdlib.h>

#include "ecofiles/ecopack/jobs.h"
#include "ecofiles/ecopack/progress.h"
#include "ecofiles/import/ground/ground.h"
#include "lod/build/ground_tree.h"
#include "lod/ground_choice.h"
#include "lod/build/summary.h"

/* Steps of heights that are not whole are a centimetre, or a part of the relief where that is less; but no finer
 * than light can show: a step of 1/256 of a cell changes a slope by 1/256, and colours have 255 values
 * (lod/EXPERIMENTS.md, Smaller tiles of ground). */
#define HEIGHT_STEP_M 0.01
#define RELIEF_STEPS 1024
#define CELL_STEPS 256

/* The step of rasters in whole metres or decimetres, which keeps them exactly in a fraction of the bytes;
 * 0: heights are finer. */
static double whole_step(const struct eco_ground *ground, double least)
{
	static const double steps[] = { 1, 0.5, 0.25, 0.2, 0.1, 0.05, 0.025, 0.02 };
	size_t count = (size_t)ground->columns * ground->rows, fits = 0;
	for (size_t i = 0; i < count && fits < sizeof steps / sizeof *steps;) {
		double whole = ((double)ground->height_m[i] - least) / steps[fits];
		/* floats of thousands of metres are off by half a millimetre */
		if (fabs(whole - floor(whole + 0.5)) * steps[fits] > 0.001)
			fits++, i = 0;
		else
			i++;
	}
	return fits < sizeof steps / sizeof *steps ? steps[fits] : 0;
}

/* Chooses the heights that the pack can store. */
static void choose_steps(struct make *m)
{
	const struct eco_ground *ground = &m->ground;
	size_t count = (size_t)ground->columns * ground->rows;
	double least = ground->height_m[0], most = least, low, step;
	for (size_t i = 1; i < count; i++) {
		least = fmin(least, ground->height_m[i]);
		most = fmax(most, ground->height_m[i]);
	}
	low = least;
	step = most > least ? whole_step(ground, least) : 0;
	if (!(step > 0)) {
		double cell = fmin(ground->step_x_m, ground->step_y_m);
		step = lod_power_below(most > least ? fmax(fmin(HEIGHT_STEP_M, (most - least) / RELIEF_STEPS),
			cell / CELL_STEPS) : 1);
		while ((most - least) / step > 1 << 27)
			step *= 2;
		low = floor(least / step) * step + 0.0;
	}
	m->ground_low_m = low;
	m->ground_step_m = step;
}

/* Rounds heights as the pack stores them, so that plants stand on the drawn ground. Those beyond the border
 * lie between its own. */
enum eco_code make_ground_finish(struct make *m)
{
	choose_steps(m);
	enum eco_code code = eco_ground_extend(&m->ground, m->error);
	size_t count = (size_t)m->ground.columns * m->ground.rows;
	for (size_t i = 0; i < count; i++) {
		float *z = &m->ground.height_m[i];
		*z = (float)(m->ground_low_m + floor((*z - m->ground_low_m) / m->ground_step_m + 0.5)
			* m->ground_step_m);
	}
	m->has_ground = !code;
	return code;
}

enum eco_code make_ground_read(struct make *m)
{
	struct eco_source *source = &m->sources.items[0];
	if (!source->ground.height_count)
		return ECO_OK;
	if (!main_progress("reading ground", NULL, 0))
		return eco_fail(m->error, ECO_INTERRUPTED, "interrupted");
	struct eco_ground_options options = { .source = &source->ground, .scene_crs = source->crs,
		.scene_vertical = source->vertical, .origin = { source->origin[0], source->origin[1],
		source->origin[2] }, .side_max = ECO_GROUND_INSIDE_MAX, .warn = main_note_text };
	enum eco_code code = eco_ground_import(&m->ground, &options, m->error);
	return code ? code : make_ground_finish(m);
}

struct tile_list {               /* of one tile, made in a thread */
	struct eco_list list;
	struct eco_encoded encoded;
};

static enum eco_code encode_tile(void *ctx, uint64_t i, void *result, struct eco_error *error)
{
	const struct make *m = ctx;
	const struct eco_ground *g = &m->ground;
	const struct eco_ground_tile *tile = &m->ground_tiles[i];
	struct tile_list *made = result;
	struct eco_ground_span x, y;
	struct eco_elements e;
	eco_ground_spans(&x, &y, tile, g->columns, g->rows);
	made->list = (struct eco_list){ .kind = ECO_LIST_GROUND, .coder = ECO_CODER_ROWS,
		.level = tile->level, .owner = ECO_NONE,
		.image = ECO_NONE, .partner = ECO_NONE,
		.grid_origin = { g->x_m, g->y_m, m->ground_low_m },
		.grid_step = { g->step_x_m, g->step_y_m, m->ground_step_m }, .columns = x.count };
	enum eco_code code = lod_ground_elements(&e, g, tile, m->ground_shifts[i], m->ground_low_m,
		m->ground_step_m, error);
	if (!code)
		code = eco_pack_encode(&made->encoded, &made->list, &e, (const uint32_t[]){ e.element_count },
			1, error);
	eco_elements_free(&e);
	return code;
}

static enum eco_code add_tile(void *ctx, uint64_t i, void *result, struct eco_error *error)
{
	struct make *m = ctx;
	struct tile_list *made = result;
	if (i % 64 == 0 && !main_progress("packing ground", NULL, (double)i / m->scene.ground_count))
		return eco_fail(error, ECO_INTERRUPTED, "interrupted");
	return make_add_encoded(m, &made->list, &made->encoded, &m->ground_tiles[i].list);
}

static void drop_tile(void *result)
{
	eco_encoded_free(&((struct tile_list *)result)->encoded);
}

/* Makes one list a tile, coarse to fine. Nothing finer is stored where a tile is off by less than a
 * centimetre. */
enum eco_code make_ground_pack(struct make *m)
{
	struct lod_ground_tree tree;
	if (!m->has_ground)
		return ECO_OK;
	if (!main_progress("measuring ground", NULL, 0))
		return eco_fail(m->error, ECO_INTERRUPTED, "interrupted");
	enum eco_code code = lod_ground_build(&tree, &m->ground, m->ground_step_m,
		fmin(m->ground_step_m, HEIGHT_STEP_M), m->error);
	if (code)
		return code;
	m->scene.ground = m->ground_tiles = tree.tiles;
	m->ground_shifts = tree.shifts;
	m->scene.ground_count = tree.count;
	m->scene.ground_columns = m->ground.columns;
	m->scene.ground_rows = m->ground.rows;
	m->scene.ground_margin = m->ground.margin;
	return main_jobs_run(&(struct main_jobs){ .count = tree.count, .threads = make_threads(m),
		.result_size = sizeof(struct tile_list),
		.work = encode_tile, .take = add_tile, .drop = drop_tile, .ctx = m }, m->error);
}

void make_ground_free(struct make *m)
{
	eco_ground_free(&m->ground);
	free(m->ground_tiles);
	free(m->ground_shifts);
	free(m->ground_images);
}
