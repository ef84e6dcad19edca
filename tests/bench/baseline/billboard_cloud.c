/* A plant, its hidden parts, and clouds with their textures. */
#include "tests/bench/baseline/billboard_cloud.h"

#include <math.h>
#include <string.h>

#include "lod/build/model_draw.h"
#include "lod/raster/raster.h"

#define WELD_BITS 16u
#define RADIUS 0.05                  /* of influence in the density field */
#define TEXEL (1.0 / 256)
#define SIDE_MOST 1024u
#define AWAY 4096.0                  /* of the eye that sees a billboard's faces, over its edges: lines of sight are parallel */
#define EPSILON_FIRST (1.0 / 128)    /* of the ladder */
#define EPSILON_STEP 1.41421356
#define EPSILON_RUNGS 10
#define ERROR_MOST 0.5               /* with which epsilon is chosen: beyond it parts are mostly invalid */

/* ---- A plant ---- */

/* The sum over all other generators of (1 - (d / radius)^2)^2 within the radius (section 3.4). */
static double density_at(const struct lod_keyed *items, const struct lod_v3 *generators, uint32_t count,
	struct lod_v3 p)
{
	double sum = 0;
	for (int i = 0; i < 9; i++) {        /* a row of three cells lies together */
		uint64_t last = billboard_cell(p, RADIUS, i % 3 - 1, i / 3 - 1, 1);
		uint32_t k = billboard_find(items, count, billboard_cell(p, RADIUS, i % 3 - 1, i / 3 - 1,
			-1));
		for (; k < count && items[k].key <= last; k++) {
			struct lod_v3 d = lod_v3_sub(p, generators[items[k].value]);
			double share = lod_v3_dot(d, d) / (RADIUS * RADIUS);
			sum += share < 1 ? (1 - share) * (1 - share) : 0;
		}
	}
	return sum - 1;                      /* none hides itself */
}

/* Each node that has faces is a leaf or a piece of twig, and a generator of the density. */
static void find_occlusion(struct billboard_tree *tree, struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	struct lod_keyed *items = lod_arena_take(arena, tree->count, sizeof *items);
	uint32_t count = 0;
	double most = 0;
	for (uint32_t i = 0; i < tree->count; i++)
		if (tree->area[i] > 0)
			items[count++] = (struct lod_keyed){ billboard_cell(tree->center[i], RADIUS, 0, 0, 0),
				i };
	lod_sort(arena, items, count);
	for (uint32_t i = 0; i < tree->count; i++) {
		tree->sigma[i] = tree->area[i] > 0 ? density_at(items, tree->center, count, tree->center[i])
			: 0;
		most = fmax(most, tree->sigma[i]);
	}
	for (uint32_t i = 0; i < tree->count; i++)           /* from density to the share that is seen */
		tree->sigma[i] = tree->sigma[i] > 0 ? 1 - tree->sigma[i] / most : 1;
	lod_arena_release(arena, mark);
}

struct lod_billboard_plant *lod_billboard_plant_make(const struct eco_model *model, struct lod_arena *arena)
{
	struct lod_billboard_plant *p = lod_arena_take(arena, 1, sizeof *p);
	struct eco_model scaled = *model;
	float low[3] = { 0 }, high[3] = { 0 };
	p->model = model;
	p->rgb = lod_model_colors(model, arena);
	lod_model_bounds(model, low, high);
	p->unit = high[2] > low[2] ? (double)high[2] - (double)low[2] : 1;
	p->middle = lod_v3_scale(lod_v3_add(lod_v3_of(low), lod_v3_of(high)), 0.5);
	scaled.position = lod_arena_take(arena, 3 * (size_t)model->vertex_count, sizeof(float));
	for (size_t i = 0; i < 3 * (size_t)model->vertex_count; i++)
		scaled.position[i] = (float)(((double)model->position[i]
			- lod_v3_axis(p->middle, (int)(i % 3))) / p->unit);
	lod_weld(&p->mesh, &scaled, WELD_BITS, arena);
	billboard_tree_make(&p->tree, &p->mesh, arena);
	find_occlusion(&p->tree, arena);
	return p;
}

/* ---- Textures: faces seen straight onto a billboard, the nearest in front, texels opaque where their middle
 * is covered ---- */

static uint32_t side_of(double half)
{
	double side = ceil(2 * half / TEXEL);
	return side < 1 ? 1 : side < SIDE_MOST ? (uint32_t)side : SIDE_MOST;
}

static void aim(struct lod_raster *raster, const struct billboard_quad *quad)
{
	double away = AWAY * fmax(quad->width, quad->height);
	struct lod_v3 at = lod_v3_add(quad->center, lod_v3_scale(quad->normal, away)), u = quad->u,
		v = quad->v, n = quad->normal;
	const struct lod_eye eye = { .at = { at.x, at.y, at.z }, .right = { u.x, u.y, u.z },
		.up = { -v.x, -v.y, -v.z }, .forward = { -n.x, -n.y, -n.z }, .tan_x = quad->width / away,
		.tan_y = quad->height / away };
	lod_raster_clear(raster);
	lod_raster_camera(raster, &eye, away / 2);
	lod_raster_object(raster, &(struct lod_place){ .cosine = 1, .scale = 1 });
}

/* Its item is the triangle of the model. */
static void draw_face(struct lod_raster *raster, const struct lod_billboard_plant *plant,
	const struct billboard_face *face)
{
	const struct eco_model *model = plant->model;
	uint32_t source = plant->mesh.source[face->triangle];
	bool cut = lod_mesh_material(model, model->material[source])->cutout;
	float position[9], uv[6] = { 0 };
	for (uint32_t i = 0; i < 9; i++)
		position[i] = (float)lod_v3_axis(face->corner[i / 3], (int)(i % 3));
	for (uint32_t i = 0; i < 6 && model->uv; i++)
		uv[i] = model->uv[2 * (size_t)model->index[3 * (size_t)source + i / 2] + i % 2];
	lod_raster_triangles(raster, &(struct lod_raster_batch){ .count = 1, .position = position, .uv = uv,
		.cutout = cut && model->uv ? lod_mesh_image(model, model->material[source]) : NULL,
		.item = source, .owner = 1 });
}

static void color_texels(struct lod_billboard *item, const struct lod_raster *raster, const uint8_t (*rgb)[3])
{
	double sum[3] = { 0 }, count = 1e-9;
	for (size_t i = 0; i < (size_t)item->image.width * item->image.height; i++) {
		if (!raster->cover[i])
			continue;
		count++;
		memcpy(item->image.rgba + 4 * i, rgb[raster->item[i]], 3);
		item->image.rgba[4 * i + 3] = 255;
		for (int k = 0; k < 3; k++)
			sum[k] += rgb[raster->item[i]][k];
	}
	for (int k = 0; k < 3; k++)
		item->rgb[k] = (uint8_t)(sum[k] / count);
}

/* The texture of the part's billboard q. Adds the area of faces that no billboard holds to *invalid. */
static void bake(struct lod_billboard *item, struct billboard_work *work, const struct billboard_part *part,
	uint32_t q, uint32_t faces, double *invalid, struct lod_arena *arena)
{
	const struct billboard_fit *fit = &part->fit;
	const struct lod_billboard_plant *plant = work->plant;
	const struct billboard_quad *quad = &fit->quads[q];
	struct lod_raster raster;
	item->center = lod_v3_add(plant->middle, lod_v3_scale(quad->center, plant->unit));
	item->u = lod_v3_scale(quad->u, quad->width * plant->unit);
	item->v = lod_v3_scale(quad->v, quad->height * plant->unit);
	item->image.width = side_of(quad->width);
	item->image.height = side_of(quad->height);
	item->image.rgba = lod_arena_take(arena, (size_t)item->image.width * item->image.height, 4);
	lod_raster_init(&raster, &(struct lod_raster_options){ .width = item->image.width,
		.height = item->image.height, .item = true });
	aim(&raster, quad);
	for (uint32_t i = 0; i < faces; i++) {
		const struct billboard_face *face = work->faces[i];
		uint32_t nearest;
		double projected;
		bool valid = billboard_face_judge(face, fit->quads, fit->quad_count, work->epsilon, &nearest,
			&projected);
		*invalid += q || valid ? 0 : face->area;
		if (fit->form == LOD_BILLBOARD_CROSS || nearest == q)
			draw_face(&raster, plant, face);
	}
	color_texels(item, &raster, plant->rgb);
	lod_raster_free(&raster);
}

/* ---- A cloud ---- */

/* The least epsilon of a ladder for which the error holds; it falls as epsilon grows. */
static void settle(struct billboard_work *work)
{
	double rung[EPSILON_RUNGS] = { EPSILON_FIRST };
	uint32_t low = 0, high = EPSILON_RUNGS - 1, last = ECO_NONE;
	for (uint32_t i = 1; i < EPSILON_RUNGS; i++)
		rung[i] = rung[i - 1] * EPSILON_STEP;
	while (low < high) {
		last = (low + high) / 2;
		billboard_parts_settle(work, rung[last]);
		if (billboard_parts_error(work) <= ERROR_MOST)
			high = last;
		else
			low = last + 1;
	}
	if (last != low)
		billboard_parts_settle(work, rung[low]);
}

void lod_billboard_cloud_make(struct lod_billboard_cloud *cloud, const struct lod_billboard_plant *plant,
	uint32_t cap, struct lod_arena *arena)
{
	struct lod_arena scratch = { 0 };
	struct billboard_work work;
	double invalid = 0, area = 0;
	*cloud = (struct lod_billboard_cloud){ 0 };
	if (!cap || !plant->tree.face_count)
		return;
	billboard_work_open(&work, plant, cap, &scratch);
	settle(&work);
	cloud->items = lod_arena_take(arena, work.quad_count, sizeof *cloud->items);
	cloud->parts = work.part_count;
	cloud->error = billboard_parts_error(&work);
	cloud->epsilon = work.epsilon;
	for (const struct billboard_part *part = work.parts; part < work.parts + work.part_count; part++) {
		uint32_t faces = billboard_part_faces(&work, part->root, plant->tree.face_count);
		cloud->forms[part->fit.form]++;
		area += part->fit.area;
		for (uint32_t q = 0; q < part->fit.quad_count; q++) {
			struct lod_billboard *item = &cloud->items[cloud->count++];
			bake(item, &work, part, q, faces, &invalid, arena);
			cloud->texels += (size_t)item->image.width * item->image.height;
		}
	}
	cloud->invalid = area > 0 ? invalid / area : 0;
	lod_arena_free(&scratch);
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
			for (int axis = 0; axis < 3; axis++)
				position[3 * k + axis] = (float)lod_v3_axis(p, axis);
			/* the last texel, not the first of the next round */
			uv[2 * k] = corner[k][0] ? 0.999999f : 0;
			uv[2 * k + 1] = corner[k][1] ? 0.999999f : 0;
		}
		for (uint32_t k = 0; k < 2; k++)     /* a batch counts its items */
			lod_raster_triangles(raster, &(struct lod_raster_batch){ .count = 1,
				.position = position + 9 * k, .uv = uv + 6 * k, .cutout = &item->image,
				.item = i, .owner = owner });
	}
}
