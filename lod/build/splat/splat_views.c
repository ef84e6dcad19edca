/* Pictures of a plant all around: how much of each pixel it covers, in which colour, and points of its
 * visible surface. */
#include <math.h>
#include <string.h>

#include "ecofiles/base/random.h"
#include "lod/build/model_draw.h"
#include "lod/build/splat/splat_state.h"
#include "lod/light.h"
#include "lod/vector.h"

#define SIDE 4u                  /* samples a pixel: SIDE x SIDE */
#define FRAME 1.04               /* half the picture over the radius */
#define AWAY 512.0               /* of the camera, radii: as good as orthographic */
#define LOW (-0.2)               /* heights of views on the unit sphere */
#define HIGH 0.95
/* The mean length of a line across a cell (lod/leaf.h) of volume 1 in a picture of splats: .75 (4 / its surface) in a cut
 * that faces the eye, .50 on a whole ball; of a splat the middle shows most (lod/EXPERIMENTS.md, Leaves on splats). */
#define CELL_RUN 0.63
#define SAMPLES 49152u           /* of the surface, in all views */
#define SAMPLES_DRAFT 12288u

struct drawing {
	struct splat_views *views;
	const struct eco_model *model;
	const struct lod_mask *masks;
	const uint8_t (*rgb)[3], *organ;     /* per triangle; organ and leaf may be NULL */
	const uint32_t *leaf;
	double *square;              /* of each triangle's lod_light_gray */
	struct lod_raster *rasters;
	uint32_t raster_count;
};

/* ---- Views ---- */

/* Each view is a golden angle on from the last; the spiral begins elsewhere than that of curves (probe.c). */
static void look(struct splat_views *views)
{
	double x = 0.6, y = 0.8;
	for (uint32_t i = 0; i < views->count; i++) {
		struct splat_view *view = &views->items[i];
		double z = LOW + (HIGH - LOW) * (i + 0.5) / views->count, flat = sqrt(1 - z * z);
		view->right[0] = -y, view->right[1] = x;
		view->down[0] = z * x, view->down[1] = z * y, view->down[2] = -flat;
		view->forward[0] = -flat * x, view->forward[1] = -flat * y, view->forward[2] = -z;
		lod_turn_golden(&x, &y);
	}
}

static void start(const struct splat_views *views, const struct splat_view *view, struct lod_raster *raster)
{
	struct lod_eye eye = { .tan_x = FRAME / AWAY, .tan_y = FRAME / AWAY,
		.pixel_rad = 2 * FRAME / AWAY / raster->height };
	for (int k = 0; k < 3; k++) {
		eye.at[k] = views->center[k] - AWAY * views->radius * view->forward[k];
		eye.forward[k] = view->forward[k];
		eye.right[k] = view->right[k];
		eye.up[k] = -view->down[k];
	}
	lod_raster_look(raster, &eye, (AWAY - 2) * views->radius);
}

/* ---- Drawing ---- */

static void reduce_pixel(const struct drawing *d, struct splat_view *view, const struct lod_raster *raster,
	uint32_t x, uint32_t y)
{
	struct lod_light light = { .weight = 0 };
	double more[2] = { 0, 0 };               /* wood, square */
	for (uint32_t s = 0; s < SIDE * SIDE; s++) {
		size_t i = (size_t)(SIDE * y + s / SIDE) * raster->width + SIDE * x + s % SIDE;
		if (raster->cover[i]) {
			lod_light_add(&light, d->rgb[raster->item[i]], 1);
			more[0] += d->organ && d->organ[raster->item[i]] == ECO_ORGAN_WOOD;
			more[1] += d->square[raster->item[i]];
		}
	}
	view->cover[(size_t)y * d->views->stride + x] = (float)(light.weight / (SIDE * SIDE));
	view->covered += light.weight / (SIDE * SIDE);
	for (int k = 0; k < 5; k++)
		view->light[(size_t)y * d->views->pixels + x][k] = light.weight > 0
			? (float)((k < 3 ? light.sum[k] : more[k - 3]) / light.weight) : 0;
}

/* The point that a sample shows, in radii from the centre. */
static void surface_point(float out[3], const struct splat_views *views, const struct splat_view *view,
	const struct lod_raster *raster, uint32_t x, uint32_t y)
{
	double w = 1 / (double)raster->depth[(size_t)y * raster->width + x] / views->radius,
		scale = FRAME / AWAY * w, right = ((x + 0.5) / raster->width * 2 - 1) * scale,
		down = ((y + 0.5) / raster->height * 2 - 1) * scale;
	for (int k = 0; k < 3; k++)
		out[k] = (float)(right * view->right[k] + down * view->down[k]
			+ (w - AWAY) * view->forward[k]);
}

/* The same number of samples for the same area on the screen in every view, by chance. */
static void take_samples(struct splat_views *views, uint32_t index, const struct lod_raster *raster)
{
	struct splat_view *view = &views->items[index];
	uint32_t room = views->samples;
	uint64_t seed = 0x51A7 + index;
	for (uint32_t tries = 0; tries < 8 * room && view->sample_count < room; tries++) {
		uint64_t bits = eco_random_next(&seed);
		uint32_t x = (uint32_t)(bits & 0xffffffff) % raster->width,
			y = (uint32_t)(bits >> 32) % raster->height;
		if (!raster->cover[(size_t)y * raster->width + x])
			continue;
		view->triangle[view->sample_count] = raster->item[(size_t)y * raster->width + x];
		surface_point(view->sample[view->sample_count++], views, view, raster, x, y);
	}
}

/* Other leaves hide parts of one, and a card with many has gaps: pieces in the picture decide, not areas. */
static void count_leaves(const uint32_t *leaf, struct splat_view *view, const struct lod_raster *raster)
{
	for (uint32_t y = 0; y < raster->height; y++) {
		uint32_t before = ECO_NONE;
		for (uint32_t x = 0; x < raster->width; x++) {
			size_t i = (size_t)y * raster->width + x;
			uint32_t here = raster->cover[i] ? leaf[raster->item[i]] : ECO_NONE;
			view->leaf_samples += here != ECO_NONE;
			view->leaf_runs += here != ECO_NONE && here != before;
			before = here;
		}
	}
}

static void draw_part(void *pieces, uint32_t part)
{
	struct drawing *d = pieces;
	struct lod_raster *raster = &d->rasters[part];
	for (uint32_t i = part; i < d->views->count; i += d->raster_count) {
		struct splat_view *view = &d->views->items[i];
		start(d->views, view, raster);
		lod_model_draw(d->model, d->masks, raster);
		for (uint32_t y = 0; y < d->views->pixels; y++)
			for (uint32_t x = 0; x < d->views->pixels; x++)
				reduce_pixel(d, view, raster, x, y);
		take_samples(d->views, i, raster);
		if (d->leaf)
			count_leaves(d->leaf, view, raster);
	}
}

static void allocate(struct splat_views *views, struct lod_arena *arena)
{
	size_t pixels = views->pixels;
	for (uint32_t i = 0; i < views->count; i++) {
		struct splat_view *view = &views->items[i];
		view->cover = lod_arena_take(arena, pixels * views->stride, sizeof *view->cover);
		view->light = lod_arena_take(arena, pixels * pixels, sizeof *view->light);
		view->sample = lod_arena_take(arena, views->samples, sizeof *view->sample);
		view->triangle = lod_arena_take(arena, views->samples, sizeof *view->triangle);
	}
}

void splat_views_make(struct splat_views *views, const struct eco_model *model,
	const struct lod_splats_options *options, struct lod_arena *arena)
{
	uint32_t pixels = options->pixels ? options->pixels : 160, parts = options->each ? 4 : 1;
	*views = (struct splat_views){ .count = options->views ? options->views : 55, .pixels = pixels,
		.stride = pixels + 4, .planes = 1, .scale = (float)(pixels / (2 * FRAME)) };
	views->samples = (options->draft ? SAMPLES_DRAFT : SAMPLES) / views->count;
	views->items = lod_arena_take(arena, views->count, sizeof *views->items);
	look(views);
	views->radius = lod_model_sphere(model, views->center);
	if (!(views->radius > 0))
		return;
	allocate(views, arena);
	struct drawing d = { views, model, lod_model_masks(model, arena),
		options->rgb ? options->rgb : lod_model_colors(model, arena), options->organ,
		options->leaf, lod_arena_take(arena, model->triangle_count, sizeof *d.square),
		lod_arena_take(arena, parts, sizeof *d.rasters), parts };
	for (uint32_t i = 0; i < parts; i++)
		lod_raster_init(&d.rasters[i], &(struct lod_raster_options){ .width = SIDE * pixels,
			.height = SIDE * pixels, .item = true });
	for (uint32_t t = 0; t < model->triangle_count; t++) {
		const double light[3] = { lod_light_of[d.rgb[t][0]], lod_light_of[d.rgb[t][1]], lod_light_of[d.rgb[t][2]] };
		d.square[t] = lod_light_gray(light) * lod_light_gray(light);
	}
	lod_each_run(options->each, options->ctx, parts, draw_part, &d);
	for (uint32_t i = 0; i < parts; i++)
		lod_raster_free(&d.rasters[i]);
}

/* Edges lie anywhere between samples, also two between neighbours: hence half a sample less. */
double splat_views_leaf(const struct splat_views *views)
{
	double samples = 0, runs = 0;
	for (uint32_t i = 0; i < views->count; i++) {
		samples += views->items[i].leaf_samples;
		runs += views->items[i].leaf_runs;
	}
	return runs > 0 ? (samples / runs - 0.5) / (CELL_RUN * SIDE * (double)views->scale) : 0;
}

void splat_views_coarsen(struct splat_views *coarse, const struct splat_views *views,
	struct lod_arena *arena)
{
	uint32_t pixels = views->pixels / 2, stride = pixels + 4;
	size_t plane = (size_t)pixels * stride;
	*coarse = (struct splat_views){ .count = views->count, .pixels = pixels, .stride = stride,
		.planes = 4, .scale = views->scale / 2, .radius = views->radius };
	memcpy(coarse->center, views->center, sizeof coarse->center);
	coarse->items = lod_arena_take(arena, views->count, sizeof *coarse->items);
	for (uint32_t i = 0; i < views->count; i++) {
		struct splat_view *view = &coarse->items[i];
		*view = views->items[i];
		view->cover = lod_arena_take(arena, 4 * plane, sizeof *view->cover);
		view->light = NULL;
		view->sample = NULL;
		for (uint32_t y = 0; y < views->pixels; y++)
			for (uint32_t x = 0; x < views->pixels; x++) {
				size_t to = (size_t)(y / 2) * stride + x / 2,
					from = (size_t)y * views->stride + x;
				view->cover[(2 * (y % 2) + x % 2) * plane + to] = views->items[i].cover[from];
			}
	}
}
