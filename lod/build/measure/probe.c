/* A plant seen from all around. */
#include "lod/build/measure/probe.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "lod/build/model_draw.h"
#include "lod/geometry.h"
#include "lod/vector.h"

#define DISTANCE_RADII 16.0
#define FRAME 1.04 /* half the picture over the radius of the bounding sphere's silhouette */
#define PIXELS_AT_ONCE (1u << 22)    /* of all pictures drawn at a time */
#define SHARED_PRIMITIVES 8192u      /* fewer primitives are drawn faster than threads start */

/* ---- Set-up ---- */

/* An eye in direction (x, y) of the plane, at height z of the unit sphere. */
static void set_eye(const struct lod_probe *probe, struct lod_eye *eye, double x, double y, double z, uint32_t pixels)
{
	double away = DISTANCE_RADII * probe->radius, flat = sqrt(1 - z * z), from[3] = { flat * x, flat * y, z };
	double half = FRAME * probe->radius / sqrt(away * away - probe->radius * probe->radius);
	memset(eye, 0, sizeof *eye);
	for (int k = 0; k < 3; k++) {
		eye->at[k] = probe->center[k] + away * from[k];
		eye->forward[k] = -from[k];
	}
	eye->right[0] = -y, eye->right[1] = x;
	eye->up[0] = -z * x, eye->up[1] = -z * y, eye->up[2] = flat;
	eye->tan_x = eye->tan_y = half;
	eye->pixel_rad = 2 * half / pixels;
}

/* Each view is a golden angle on from the last: a rotation, without libm. */
void lod_probe_eyes(const struct lod_probe *probe, struct lod_eye *eyes, uint32_t count, uint32_t pixels, double low,
	double high)
{
	double x = 1, y = 0;
	for (uint32_t i = 0; i < count; i++) {
		set_eye(probe, &eyes[i], x, y, low + (high - low) * (i + 0.5) / count, pixels);
		lod_turn_golden(&x, &y);
	}
}

void lod_probe_look(struct lod_probe *probe, double low, double high)
{
	probe->near_m = (DISTANCE_RADII - 4) * probe->radius;
	lod_probe_eyes(probe, probe->eyes, probe->views, probe->options.pixels, low, high);
}

static size_t view_pixels(const struct lod_probe *probe)
{
	return (size_t)probe->options.pixels * probe->options.pixels;
}

/* One raster, or, if views are drawn in parallel, as many as stay small together. */
static void make_rasters(struct lod_probe *probe)
{
	size_t most = probe->options.each ? PIXELS_AT_ONCE / (view_pixels(probe) + 1) + 1 : 1;
	probe->raster_count = most < probe->views ? (uint32_t)most : probe->views;
	probe->rasters = lod_arena_take(&probe->arena, probe->raster_count, sizeof *probe->rasters);
	for (uint32_t i = 0; i < probe->raster_count; i++)
		lod_raster_init(&probe->rasters[i], &(struct lod_raster_options){ .width = probe->options.pixels,
			.height = probe->options.pixels, .silhouette = true });
}

static void take_arrays(struct lod_probe *probe)
{
	const struct lod_plant *plant = probe->plant;
	struct lod_arena *arena = &probe->arena;
	size_t chunks = 0;
	for (uint32_t i = 0; i < plant->list_count; i++)
		chunks += plant->lists[i].end_count;
	probe->eyes = lod_arena_take(arena, probe->views, sizeof *probe->eyes);
	probe->reference = lod_arena_take(arena, probe->views, view_pixels(probe));
	probe->reference_pixels = lod_arena_take(arena, probe->views, sizeof *probe->reference_pixels);
	probe->scores = lod_arena_take(arena, probe->views, sizeof *probe->scores);
	probe->lists = lod_arena_take(arena, plant->list_count, sizeof *probe->lists);
	probe->cut = lod_arena_take(arena, plant->image_count, sizeof *probe->cut);
	probe->chunks = lod_arena_take(arena, chunks, sizeof *probe->chunks);
	probe->masks = lod_model_masks(probe->model, arena);
}

/* Chunks as in the pack: ladders ask how many triangles some elements have. */
static void count_chunks(struct lod_probe *probe, struct eco_list *list, const struct lod_list_draft *draft)
{
	const struct eco_elements *e = &draft->elements;
	list->chunk_first = probe->scene.chunk_count;
	list->chunk_count = draft->end_count;
	for (uint32_t c = 0, i = 0; c < draft->end_count; c++) {
		struct eco_chunk *chunk = &probe->chunks[probe->scene.chunk_count++];
		chunk->element_count = draft->ends[c] - i;
		for (; i < draft->ends[c]; i++)
			chunk->primitive_count += e->corners[i] < 3 ? 1 : e->corners[i] - 2u;
	}
}

void lod_probe_init(struct lod_probe *probe, const struct lod_plant *plant, const struct eco_model *model,
	const struct lod_probe_options *options)
{
	memset(probe, 0, sizeof *probe);
	probe->plant = plant;
	probe->model = model;
	probe->views = options->views;
	probe->options = *options;
	make_rasters(probe);
	take_arrays(probe);
	probe->scene = (struct eco_scene){ .lists = probe->lists, .list_count = plant->list_count,
		.plants = &plant->plant, .plant_count = 1, .ladders = plant->ladders,
		.ladder_count = plant->ladder_count, .curves = plant->curves,
		.curve_count = plant->curve_count, .chunks = probe->chunks };
	for (uint32_t i = 0; i < plant->list_count; i++) {
		probe->lists[i] = plant->lists[i].list;
		count_chunks(probe, &probe->lists[i], &plant->lists[i]);
	}
	for (uint32_t i = 0; i < plant->image_count; i++)
		probe->cut[i] = eco_image_has_holes(&model->images[plant->images[i]]);
	double radius = lod_model_sphere(model, probe->center);
	probe->radius = radius > 0 ? radius : 1;
	lod_probe_look(probe, LOD_PROBE_AROUND);
}

void lod_probe_free(struct lod_probe *probe)
{
	for (uint32_t i = 0; i < probe->raster_count; i++)
		lod_raster_free(&probe->rasters[i]);
	free(probe->drawings);
	free(probe->floats);
	lod_arena_free(&probe->arena);
	memset(probe, 0, sizeof *probe);
}

/* ---- Drawings ---- */

void lod_probe_clear(struct lod_probe *probe)
{
	probe->drawing_count = 0;
	probe->float_count = 0;
	probe->primitive_count = probe->item_count = 0;
	probe->impostor = NULL;
}

void lod_probe_add_impostor(struct lod_probe *probe, const struct lod_impostor *impostor)
{
	probe->impostor = impostor;
	probe->primitive_count++;
}

static void reserve(struct lod_probe *probe, size_t floats)
{
	eco_grow(&probe->drawings, &probe->drawing_capacity, probe->drawing_count, sizeof *probe->drawings);
	if (probe->float_count + floats > probe->float_capacity) {
		probe->float_capacity = (probe->float_count + floats) / 2 * 3 + 4096;
		probe->floats = eco_realloc(probe->floats, probe->float_capacity, sizeof *probe->floats);
	}
}

void lod_probe_add(struct lod_probe *probe, const struct eco_cut *cut)
{
	const struct lod_list_draft *draft = &probe->plant->lists[cut->list];
	const struct eco_list *list = &draft->list;
	uint32_t count = cut->end - cut->first;
	bool holes = list->image != ECO_NONE && (list->attributes & ECO_ATTR_UV) && probe->cut[list->image],
		uv = holes || (probe->colored && list->image != ECO_NONE && (list->attributes & ECO_ATTR_UV));
	if (!count)
		return;
	reserve(probe, lod_geometry_floats(list, count, uv) + (probe->colored ? count : 0));
	struct lod_drawing *drawing = &probe->drawings[probe->drawing_count++];
	*drawing = (struct lod_drawing){ .list = list, .floats = probe->float_count, .count = count, .uv = uv,
		.item = probe->item_count,
		.area = list->unit_area * cut->scale,
		.cutout = holes ? &probe->model->images[probe->plant->images[list->image]] : NULL };
	drawing->mask = lod_model_mask(probe->model, probe->masks, drawing->cutout);
	struct lod_geometry geometry = lod_probe_geometry(probe, drawing);
	lod_list_geometry(list, &draft->elements, cut->first, cut->end, cut->scale, &geometry);
	probe->float_count += lod_geometry_floats(list, count, uv) + (probe->colored ? count : 0);
	probe->primitive_count += count;
	probe->item_count += count;
}

struct lod_geometry lod_probe_geometry(const struct lod_probe *probe, const struct lod_drawing *drawing)
{
	struct lod_geometry geometry = { .color = NULL };
	float *floats = probe->floats + drawing->floats;
	lod_geometry_lay(&geometry, drawing->list, drawing->count, drawing->uv, floats);
	if (probe->colored)
		geometry.color = (int32_t *)(floats + lod_geometry_floats(drawing->list, drawing->count, drawing->uv));
	return geometry;
}

/* ---- Drawing ---- */

void lod_probe_draw(const struct lod_probe *probe, struct lod_raster *raster)
{
	float leaf = probe->smooth ? 0 : (float)(probe->plant->plant.leaf_width * ECO_LEAF_UNIT_M);
	for (uint32_t i = 0; i < probe->drawing_count; i++) {
		const struct lod_drawing *drawing = &probe->drawings[i];
		struct lod_geometry geometry = lod_probe_geometry(probe, drawing);
		geometry.color = NULL;
		lod_raster_list(raster, drawing->list, &geometry,
			&(struct lod_raster_batch){ .count = drawing->count, .cutout = drawing->cutout,
			.mask = drawing->mask, .area = drawing->area, .item = drawing->item, .owner = 1, .leaf = leaf });
	}
	if (probe->impostor)
		lod_raster_impostor(raster, probe->impostor, &(struct lod_raster_batch){ .owner = 1,
			.item = probe->item_count, .leaf = leaf });
}

static void draw_model(const struct lod_probe *probe, struct lod_raster *raster)
{
	lod_model_draw(probe->model, probe->masks, raster);
}

/* ---- Views, several at a time: each writes only its own data ---- */

struct drawing_views {
	struct lod_probe *probe;
	uint32_t stride;
	void (*draw)(const struct lod_probe *probe, struct lod_raster *raster);
	void (*finish)(struct lod_probe *probe, const struct lod_raster *raster, uint32_t view);
};

static void draw_part(void *pieces, uint32_t part)
{
	const struct drawing_views *d = pieces;
	struct lod_raster *raster = &d->probe->rasters[part];
	for (uint32_t view = part * d->stride; view < d->probe->views;
			view += d->probe->raster_count * d->stride) {
		lod_raster_look(raster, &d->probe->eyes[view], d->probe->near_m);
		d->draw(d->probe, raster);
		d->finish(d->probe, raster, view);
	}
}

static void draw_views(struct drawing_views *d, uint64_t primitives)
{
	const struct lod_probe_options *o = &d->probe->options;
	lod_each_run(primitives >= SHARED_PRIMITIVES ? o->each : NULL, o->ctx, d->probe->raster_count, draw_part,
		d);
}

static void keep_view(struct lod_probe *probe, const struct lod_raster *raster, uint32_t view)
{
	size_t pixels = view_pixels(probe);
	uint64_t covered = 0;
	memcpy(probe->reference + view * pixels, raster->cover, pixels);
	for (size_t i = 0; i < pixels; i++)
		covered += raster->cover[i] & 1;
	probe->reference_pixels[view] = covered;
}

static bool any_covered(const struct lod_probe *probe)
{
	for (uint32_t view = 0; view < probe->views; view++)
		if (probe->reference_pixels[view])
			return true;
	return false;
}

bool lod_probe_keep(struct lod_probe *probe)
{
	draw_views(&(struct drawing_views){ probe, 1, lod_probe_draw, keep_view }, probe->primitive_count);
	return any_covered(probe);
}

bool lod_probe_keep_model(struct lod_probe *probe)
{
	draw_views(&(struct drawing_views){ probe, 1, draw_model, keep_view }, probe->model->triangle_count);
	return any_covered(probe);
}

static void score_view(struct lod_probe *probe, const struct lod_raster *raster, uint32_t view)
{
	lod_score(&probe->scores[view],
		&(struct lod_score_input){ .width = raster->width, .height = raster->height,
		.cover = raster->cover,
		.reference = probe->reference + view * view_pixels(probe) });
}

void lod_probe_compare(struct lod_probe *probe, uint32_t stride, struct lod_probe_result *result)
{
	uint32_t used = 0;
	*result = (struct lod_probe_result){ 0 };
	draw_views(&(struct drawing_views){ probe, stride, lod_probe_draw, score_view }, probe->primitive_count);
	for (uint32_t view = 0; view < probe->views; view += stride) {
		if (!probe->reference_pixels[view])
			continue;
		const struct lod_score *score = &probe->scores[view];
		double covered = (double)probe->reference_pixels[view], loss = 1 - score->q;
		result->loss += loss;
		result->worst = loss > result->worst ? loss : result->worst;
		result->fp += (double)score->fp / covered;
		result->fn += (double)score->fn / covered;
		used++;
	}
	if (used) {
		result->loss /= used;
		result->fp /= used;
		result->fn /= used;
	}
}
