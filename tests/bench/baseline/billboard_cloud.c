#include "tests/bench/baseline/billboard_cloud.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/image.h"
#include "lod/raster/raster.h"
#include "tests/bench/baseline/billboard_state.h"

#define WELD_BITS 16u
#define FLAT 0.05                    /* of the diagonal: lower plants are measured by that */
#define TOLERANCE 0.001
#define EPSILON_FIRST (1.0 / 128)    /* of the ladder */
#define EPSILON_STEP 1.41421356
#define EPSILON_RUNGS 10
#define ERROR_MOST 0.5               /* with which epsilon is chosen: beyond it parts are mostly invalid */

static struct lod_billboard_options completed(const struct lod_billboard_options *given)
{
	struct lod_billboard_options o = *given;
	o.tolerance = o.tolerance > 0 ? o.tolerance : TOLERANCE;
	o.radius = o.radius > 0 ? o.radius : 0.05;
	o.node = o.node > 0 ? o.node : 1.0 / 64;
	o.sections = !o.sections ? 4 : o.sections < BILLBOARD_QUADS ? o.sections : BILLBOARD_QUADS;
	o.bend = o.bend > 0 ? o.bend : 0.5;
	o.texel = o.texel > 0 ? o.texel : o.pixels > 0 ? 1 / o.pixels : 1.0 / 256;
	o.forms = o.forms ? o.forms : (1u << LOD_BILLBOARD_FORMS) - 1;
	return o;
}

/* ---- A plant ---- */

static void scale_model(struct lod_billboard_plant *p)
{
	const struct eco_model *model = p->model;
	double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
	enum eco_drop why;
	for (size_t i = 0; i < 9 * (size_t)model->triangle_count; i++)
		if (lod_mesh_usable(model, (uint32_t)(i / 9), &why)) {
			double x = (double)model->position[3 * (size_t)model->index[i / 3] + i % 3];
			low[i % 3] = fmin(low[i % 3], x);
			high[i % 3] = fmax(high[i % 3], x);
		}
	p->scaled = *model;
	p->scaled.position = lod_arena_take(&p->arena, 3 * (size_t)model->vertex_count, sizeof(float));
	p->unit = 1;
	if (!(low[0] <= high[0]))
		return;
	const struct lod_v3 size = { high[0] - low[0], high[1] - low[1], high[2] - low[2] };
	double diagonal = lod_v3_length(size);
	p->unit = size.z > FLAT * diagonal ? size.z : diagonal > 0 ? diagonal : 1;
	p->middle = (struct lod_v3){ (low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2 };
	for (size_t i = 0; i < 3 * (size_t)model->vertex_count; i++)
		p->scaled.position[i] = (float)(((double)model->position[i]
			- lod_v3_axis(p->middle, (int)(i % 3))) / p->unit);
}

/* Each node that has faces is a leaf or a piece of twig, and a generator of the density. */
static void find_occlusion(struct lod_billboard_plant *p, double radius)
{
	struct billboard_tree *tree = &p->tree;
	struct lod_arena_piece *mark = p->arena.last;
	struct lod_v3 *generators = lod_arena_take(&p->arena, tree->count, sizeof *generators);
	double *density = lod_arena_take(&p->arena, tree->count, sizeof *density), most = 0;
	uint32_t count = 0;
	for (uint32_t i = 0; i < tree->count; i++)
		if (tree->area[i] > 0)
			generators[count++] = tree->center[i];
	billboard_density(density, generators, count, radius, &p->arena);
	for (uint32_t i = 0; i < count; i++)
		most = density[i] > most ? density[i] : most;
	for (uint32_t i = tree->count; i-- > 0;)
		tree->sigma[i] = tree->area[i] > 0 ? billboard_sigma(density[--count], most) : 1;
	lod_arena_release(&p->arena, mark);
}

enum eco_code lod_billboard_plant_open(struct lod_billboard_plant **plant, const struct eco_model *model,
	const struct lod_billboard_options *options, struct eco_error *error)
{
	const struct lod_billboard_options o = completed(options);
	struct lod_billboard_plant *p = *plant = calloc(1, sizeof *p);
	if (!p)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a plant of billboards");
	if (setjmp(p->arena.failed)) {
		lod_billboard_plant_close(p);
		*plant = NULL;
		return eco_fail(error, ECO_NO_MEMORY, "no memory for billboards of %u triangles",
			model->triangle_count);
	}
	struct billboard_nodes nodes;
	p->model = model;
	scale_model(p);
	lod_weld(&p->mesh, &p->scaled, WELD_BITS, &p->arena);
	billboard_nodes_make(&nodes, &p->mesh, o.node, &p->arena);
	billboard_tree_make(&p->tree, &nodes, &p->mesh, &p->arena);
	find_occlusion(p, o.radius);
	return ECO_OK;
}

void lod_billboard_plant_close(struct lod_billboard_plant *plant)
{
	if (plant)
		lod_arena_free(&plant->arena);
	free(plant);
}

/* ---- A cloud ---- */

/* The least epsilon of a ladder for which the error holds; it falls as epsilon grows. */
static void settle(struct billboard_work *work)
{
	const struct lod_billboard_options *o = &work->options;
	double rung[EPSILON_RUNGS] = { EPSILON_FIRST }, most = o->tolerance > TOLERANCE ? o->tolerance
		: ERROR_MOST;
	uint32_t low = 0, high = EPSILON_RUNGS - 1, last = ECO_NONE;
	if (o->epsilon > 0 || o->pixels > 0) {
		billboard_parts_settle(work, o->epsilon > 0 ? o->epsilon : 0.5 / o->pixels);
		return;
	}
	for (uint32_t i = 1; i < EPSILON_RUNGS; i++)
		rung[i] = rung[i - 1] * EPSILON_STEP;
	while (low < high) {
		last = (low + high) / 2;
		billboard_parts_settle(work, rung[last]);
		if (billboard_parts_error(work) <= most)
			high = last;
		else
			low = last + 1;
	}
	if (last != low)
		billboard_parts_settle(work, rung[low]);
}

static enum eco_code weigh_textures(struct lod_billboard_cloud *cloud, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < cloud->count && !code; i++) {
		const struct eco_image *image = &cloud->items[i].image;
		uint8_t *bytes = NULL;
		size_t size = 0;
		code = eco_png_encode(&(struct eco_pixels){ image->width, image->height, 4, image->rgba },
			&bytes, &size, error);
		free(bytes);
		cloud->texture_bytes += size;
	}
	return code;
}

static enum eco_code bake_all(struct lod_billboard_cloud *cloud, struct billboard_work *work,
	struct eco_error *error)
{
	double invalid = 0, area = 0;
	enum eco_code code = ECO_OK;
	cloud->items = calloc((size_t)work->quad_count + 1, sizeof *cloud->items);
	if (!cloud->items)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u billboards", work->quad_count);
	cloud->count = work->quad_count;
	cloud->parts = work->part_count;
	cloud->error = billboard_parts_error(work);
	cloud->epsilon = work->epsilon;
	cloud->splits = work->splits;
	cloud->merges = work->merges;
	for (uint32_t i = 0, first = 0; i < work->part_count && !code; i++) {
		const struct billboard_part *part = &work->parts[i];
		for (uint32_t q = 0; q < part->fit.quad_count; q++)
			cloud->items[first + q].part = i;
		cloud->forms[part->fit.form]++;
		area += part->fit.area;
		code = billboard_bake(cloud, first, work, part, &invalid, error);
		first += part->fit.quad_count;
	}
	cloud->invalid = area > 0 ? invalid / area : 0;
	return code ? code : weigh_textures(cloud, error);
}

enum eco_code lod_billboard_cloud_make(struct lod_billboard_cloud *cloud,
	const struct lod_billboard_plant *plant, const struct lod_billboard_options *options,
	struct eco_error *error)
{
	const struct lod_billboard_options o = completed(options);
	struct lod_arena arena = { 0 };
	struct billboard_work work;
	memset(cloud, 0, sizeof *cloud);
	if (!o.cap || !plant->tree.face_count)
		return ECO_OK;
	if (setjmp(arena.failed)) {
		lod_arena_free(&arena);
		lod_billboard_cloud_free(cloud);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a cloud of %u billboards", options->cap);
	}
	billboard_work_open(&work, plant, &o, &arena);
	settle(&work);
	enum eco_code code = bake_all(cloud, &work, error);
	lod_arena_free(&arena);
	if (code)
		lod_billboard_cloud_free(cloud);
	return code;
}

void lod_billboard_cloud_free(struct lod_billboard_cloud *cloud)
{
	for (uint32_t i = 0; i < cloud->count; i++)
		free(cloud->items[i].image.rgba);
	free(cloud->items);
	memset(cloud, 0, sizeof *cloud);
}

void lod_billboard_cloud_draw(const struct lod_billboard_cloud *cloud, uint64_t owner,
	struct lod_raster *raster)
{
	static const int corner[6][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 0 }, { 1, 1 }, { 0, 1 } };
	for (uint32_t i = 0; i < cloud->count; i++) {
		const struct lod_billboard *item = &cloud->items[i];
		float position[18], uv[12];
		for (int k = 0; k < 6; k++) {
			struct lod_v3 p = lod_v3_add(item->center, lod_v3_add(
				lod_v3_scale(item->u, 2 * corner[k][0] - 1),
				lod_v3_scale(item->v, 2 * corner[k][1] - 1)));
			position[3 * k] = (float)p.x, position[3 * k + 1] = (float)p.y;
			position[3 * k + 2] = (float)p.z;
			/* the last texel, not the first of the next round */
			uv[2 * k] = corner[k][0] ? 0.999999f : 0;
			uv[2 * k + 1] = corner[k][1] ? 0.999999f : 0;
		}
		for (uint32_t k = 0; k < 2; k++)
			lod_raster_triangles(raster, &(struct lod_raster_batch){ .count = 1,
				.position = position + 9 * k, .uv = uv + 6 * k, .cutout = &item->image,
				.item = i, .owner = owner });
	}
}
