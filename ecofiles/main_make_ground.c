/* The ground of a pack: read, brought to the pack's grid of heights, cut into tiles. */
#include "ecofiles/main_make.h"

#include <math.h>
#include <stdlib.h>

#include "ecofiles/main_progress.h"
#include "lod/ground.h"
#include "lod/summary.h"

#define HEIGHT_STEP_M 0.01

static void warn(void *ctx, const char *text)
{
	(void)ctx;
	main_note("%s", text);
}

/* Heights as the pack will say them, so that plants stand on the ground that is drawn. */
static void round_heights(struct make *m)
{
	struct eco_ground *ground = &m->ground;
	size_t count = (size_t)ground->columns * ground->rows;
	double least = ground->height_m[0], most = least, low, step;
	for (size_t i = 1; i < count; i++) {
		least = fmin(least, ground->height_m[i]);
		most = fmax(most, ground->height_m[i]);
	}
	step = lod_power_below(fmin(HEIGHT_STEP_M, most > least ? (most - least) / 1024 : 1));
	while ((most - least) / step > 1 << 27)
		step *= 2;
	low = floor(least / step) * step + 0.0;
	for (size_t i = 0; i < count; i++)
		ground->height_m[i] = (float)(low + floor((ground->height_m[i] - low) / step + 0.5) * step);
	m->ground_low_m = low;
	m->ground_step_m = step;
}

enum eco_code make_ground_read(struct make *m)
{
	struct eco_source *source = &m->sources.items[0];
	if (!source->ground.height_count)
		return ECO_OK;
	if (!main_progress("reading ground", NULL, 0))
		return eco_fail(m->error, ECO_INTERRUPTED, "interrupted");
	struct eco_ground_options options = { .source = &source->ground, .scene_crs = source->crs, .scene_vertical = source->vertical,
		.origin = { source->origin[0], source->origin[1], source->origin[2] }, .warn = warn };
	enum eco_code code = eco_ground_import(&m->ground, &options, m->error);
	if (code)
		return code;
	m->has_ground = true;
	round_heights(m);
	return ECO_OK;
}

static enum eco_code add_tile(struct make *m, struct eco_ground_tile *tile)
{
	const struct eco_ground *g = &m->ground;
	struct eco_ground_span x, y;
	struct eco_elements e;
	eco_ground_spans(&x, &y, tile, g->columns, g->rows);
	struct eco_list list = { .kind = ECO_LIST_GROUND, .coder = ECO_CODER_ROWS, .level = tile->level, .owner = ECO_NONE, .plant = ECO_NONE,
		.image = ECO_NONE, .partner = ECO_NONE, .grid_origin = { g->x_m, g->y_m, m->ground_low_m },
		.grid_step = { g->step_x_m, g->step_y_m, m->ground_step_m }, .columns = x.count };
	enum eco_code code = lod_ground_elements(&e, g, tile, m->ground_low_m, m->ground_step_m, m->error);
	if (code)
		return code;
	code = make_add_list(m, &list, &e, (const uint32_t[]){ e.element_count }, 1, NULL, &tile->list);
	eco_elements_free(&e);
	return code;
}

/* One list a tile, coarse to fine. Where the ground is off by less than a step of its heights, nothing finer is stored. */
enum eco_code make_ground_pack(struct make *m)
{
	struct lod_ground_tree tree;
	if (!m->has_ground)
		return ECO_OK;
	if (!main_progress("measuring ground", NULL, 0))
		return eco_fail(m->error, ECO_INTERRUPTED, "interrupted");
	enum eco_code code = lod_ground_build(&tree, &m->ground, m->ground_step_m, m->error);
	if (code)
		return code;
	m->scene.ground = m->ground_tiles = tree.tiles;
	m->scene.ground_count = tree.count;
	m->scene.ground_columns = m->ground.columns;
	m->scene.ground_rows = m->ground.rows;
	for (uint32_t i = 0; i < tree.count && !code; i++) {
		if (!main_progress("packing ground", NULL, (double)i / tree.count))
			code = eco_fail(m->error, ECO_INTERRUPTED, "interrupted");
		else
			code = add_tile(m, &tree.tiles[i]);
	}
	return code;
}

void make_ground_free(struct make *m)
{
	eco_ground_free(&m->ground);
	free(m->ground_tiles);
}
