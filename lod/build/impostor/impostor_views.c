/* Pictures of a model from the directions of an impostor. Each is taken from both sides: the middle between
 * the nearest and the farthest surface serves opposite directions alike. */
#include <math.h>
#include <string.h>

#include "lod/build/impostor/impostor_state.h"
#include "lod/build/model_draw.h"
#include "lod/build/weld.h"
#include "lod/light.h"

#define AWAY 512.0               /* of the camera, radii: as good as parallel */
#define SIDE (VIEW_TEXELS * VIEW_SAMPLES)
#define PARTS 4u
#define EXTENT_MIN 1e-5f         /* of the smaller side of the cylinder, metres */

struct drawing {
	struct impostor_view *views;
	struct eco_impostor_axes axes[ECO_IMPOSTOR_TILES_MAX];
	uint32_t tiles, parts;
	const struct eco_impostor_body *body;
	const struct eco_model *model;
	const struct lod_mask *masks;
	const uint8_t (*rgb)[3];
	double radius;
	struct lod_raster near[PARTS], far[PARTS];
};

bool impostor_body_find(struct eco_impostor_body *body, const struct eco_model *model)
{
	float low[3], high[3], wide2 = 0;
	if (!lod_model_bounds(model, low, high))
		return false;
	for (int k = 0; k < 3; k++)
		body->center[k] = 0.5f * (low[k] + high[k]);
	for (size_t i = 0; i < 3 * (size_t)model->triangle_count; i++) {
		if (!lod_mesh_usable(model, (uint32_t)(i / 3), NULL))
			continue;
		const float *at = model->position + 3 * (size_t)model->index[i];
		float x = at[0] - body->center[0], y = at[1] - body->center[1];
		wide2 = fmaxf(wide2, x * x + y * y);
	}
	body->wide = fmaxf(sqrtf(wide2), EXTENT_MIN);
	body->high = fmaxf(0.5f * (high[2] - low[2]), EXTENT_MIN);
	body->thick = 0;
	return true;
}

/* From the direction of a tile, or from the opposite one; then the picture is mirrored. */
static void start(const struct drawing *d, uint32_t tile, bool opposite, struct lod_raster *raster)
{
	const struct eco_impostor_axes *axes = &d->axes[tile];
	double away = AWAY * d->radius, side = opposite ? -1 : 1;
	struct lod_eye eye = { .tan_x = d->body->wide / away,
		.tan_y = eco_impostor_reach_up(d->body, axes) / away };
	eye.pixel_rad = 2 * eye.tan_y / SIDE;
	for (int k = 0; k < 3; k++) {
		eye.at[k] = (double)d->body->center[k] + side * away * axes->toward[k];
		eye.forward[k] = -side * axes->toward[k];
		eye.right[k] = side * axes->right[k];
		eye.up[k] = axes->up[k];
	}
	lod_raster_look(raster, &eye, (AWAY - 2) * d->radius);
	lod_model_draw(d->model, d->masks, raster);
}

static void add_sample(const struct drawing *d, uint32_t tile, uint32_t part, uint32_t x, uint32_t y)
{
	const struct lod_raster *near = &d->near[part], *far = &d->far[part];
	struct impostor_view *view = &d->views[tile];
	size_t at = (size_t)y * SIDE + x, mirrored = (size_t)y * SIDE + (SIDE - 1 - x);
	if (!near->cover[at])
		return;
	view->count[y / VIEW_SAMPLES * VIEW_TEXELS + x / VIEW_SAMPLES]++;
	struct impostor_cell *cell = &view->cell[y * VIEW_CELLS / SIDE * VIEW_CELLS + x * VIEW_CELLS / SIDE];
	double front = AWAY - 1 / (double)near->depth[at] / d->radius,
		back = far->cover[mirrored] ? 1 / (double)far->depth[mirrored] / d->radius - AWAY : front;
	double u = (x + 0.5) / SIDE * 2 - 1, v = 1 - (y + 0.5) / SIDE * 2, out2 = u * u + v * v;
	view->thick += back < front ? 0.5 * (front - back) : 0;
	view->ball += out2 < 1 ? sqrt(1 - out2) : 0;
	cell->middle += 0.5 * (front + back);
	cell->count++;
	for (int k = 0; k < 3; k++)
		cell->light[k] += lod_light_of[d->rgb[near->item[at]][k]];
}

static void draw_part(void *pieces, uint32_t part)
{
	struct drawing *d = pieces;
	for (uint32_t tile = part; tile < d->tiles; tile += d->parts) {
		start(d, tile, false, &d->near[part]);
		start(d, tile, true, &d->far[part]);
		for (uint32_t i = 0; i < SIDE * SIDE; i++)
			add_sample(d, tile, part, i % SIDE, i / SIDE);
	}
}

enum eco_code impostor_views_make(struct impostor_view **views, enum eco_impostor_set set,
	const struct eco_impostor_body *body, const struct eco_model *model,
	const struct lod_impostors_options *options, const uint8_t (*rgb)[3], struct lod_arena *arena,
	struct eco_error *error)
{
	struct drawing *d = lod_arena_take(arena, 1, sizeof *d);
	enum eco_code code = ECO_OK;
	*d = (struct drawing){ .tiles = eco_impostor_tiles(set), .parts = options->each ? PARTS : 1,
		.body = body, .model = model,
		.masks = lod_model_masks(model, arena), .rgb = rgb, .radius = eco_impostor_radius(body) };
	*views = d->views = lod_arena_take(arena, d->tiles, sizeof **views);
	eco_impostor_axes(set, d->axes);
	for (uint32_t i = 0; i < d->parts && !code; i++) {
		code = lod_raster_init(&d->near[i], &(struct lod_raster_options){ .width = SIDE,
			.height = SIDE, .item = true }, error);
		if (!code)
			code = lod_raster_init(&d->far[i], &(struct lod_raster_options){ .width = SIDE,
				.height = SIDE }, error);
	}
	if (!code && options->each)
		options->each(options->ctx, d->parts, draw_part, d);
	else if (!code)
		draw_part(d, 0);
	for (uint32_t i = 0; i < d->parts; i++) {
		lod_raster_free(&d->near[i]);
		lod_raster_free(&d->far[i]);
	}
	return code;
}
