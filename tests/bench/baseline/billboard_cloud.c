/* A plant, its hidden parts, and clouds with their textures. */
#include "tests/bench/baseline/billboard_cloud.h"

#include <math.h>
#include <string.h>

#include "lod/build/model_draw.h"
#include "lod/raster/raster.h"
#include "lod/raster/texel.h"

#define WELD_BITS 16u
#define RADIUS 0.05                  /* of influence in the density field */
#define TEXEL (1.0 / 256)
#define SIDE_MOST 1024u
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

struct canvas {
	const struct billboard_work *work;
	const struct billboard_quad *quad;
	struct eco_image *image;
	float *front;                /* height of the nearest over the billboard, per texel */
};

static uint32_t side_of(double half)
{
	double side = ceil(2 * half / TEXEL);
	return side < 1 ? 1 : side < SIDE_MOST ? (uint32_t)side : SIDE_MOST;
}

/* In texels, and the height over the billboard. */
static struct lod_v3 flatten(const struct canvas *c, struct lod_v3 p)
{
	struct lod_v3 d = lod_v3_sub(p, c->quad->center);
	return (struct lod_v3){ (lod_v3_dot(d, c->quad->u) / c->quad->width + 1) / 2 * c->image->width,
		(lod_v3_dot(d, c->quad->v) / c->quad->height + 1) / 2 * c->image->height,
		lod_v3_dot(d, c->quad->normal) };
}

/* The model's colour under barycentric weights; false where it is cut out. */
static bool look_up(const struct canvas *c, uint32_t triangle, const double weight[3], uint8_t rgb[3])
{
	const struct eco_model *model = c->work->plant->model;
	uint32_t source = c->work->plant->mesh.source[triangle];
	const struct eco_material *m = lod_mesh_material(model, model->material[source]);
	const struct eco_image *image = lod_mesh_image(model, model->material[source]);
	double uv[2] = { 0, 0 };
	memcpy(rgb, m->rgb, 3);
	if (!image || !image->width || !image->height)
		return true;
	for (int i = 0; i < 6; i++)
		uv[i % 2] += weight[i / 2] * (double)model->uv[2 * (size_t)model->index[3 * (size_t)source
			+ (size_t)(i / 2)] + (size_t)(i % 2)];
	const uint8_t *texel = lod_texel_at(image, uv[0], uv[1]);
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)(texel[k] * rgb[k] / 255);
	return !m->cutout || texel[3] >= 128;
}

static void paint_texel(struct canvas *c, const struct lod_v3 p[3], double area, uint32_t triangle,
	uint32_t x, uint32_t y)
{
	double weight[3], at_x = x + 0.5, at_y = y + 0.5, h = 0;
	for (int k = 0; k < 3; k++) {
		const struct lod_v3 *a = &p[(k + 1) % 3], *b = &p[(k + 2) % 3];
		weight[k] = ((a->x - at_x) * (b->y - at_y) - (b->x - at_x) * (a->y - at_y)) / area;
		h += weight[k] * p[k].z;
	}
	size_t i = (size_t)y * c->image->width + x;
	uint8_t rgb[3], *to = c->image->rgba + 4 * i;
	if (weight[0] < 0 || weight[1] < 0 || weight[2] < 0 || (to[3] && !(h > (double)c->front[i]))
			|| !look_up(c, triangle, weight, rgb))
		return;
	c->front[i] = (float)h;
	memcpy(to, rgb, 3);
	to[3] = 255;
}

static void paint_face(struct canvas *c, const struct billboard_face *face)
{
	struct lod_v3 p[3] = { flatten(c, face->corner[0]), flatten(c, face->corner[1]), flatten(c,
		face->corner[2]) };
	double area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y),
		low_x = fmin(p[0].x, fmin(p[1].x, p[2].x)), low_y = fmin(p[0].y, fmin(p[1].y, p[2].y)),
		high_x = fmax(p[0].x, fmax(p[1].x, p[2].x)), high_y = fmax(p[0].y, fmax(p[1].y, p[2].y));
	if (!(fabs(area) > 0))
		return;
	for (double y = fmax(0, ceil(low_y - 0.5)); y + 0.5 <= high_y && y < c->image->height; y++)
		for (double x = fmax(0, ceil(low_x - 0.5)); x + 0.5 <= high_x && x < c->image->width; x++)
			paint_texel(c, p, area, face->triangle, (uint32_t)x, (uint32_t)y);
}

/* The texture of the part's billboard q. Adds the area of faces that no billboard holds to *invalid. */
static void bake(struct lod_billboard *item, struct billboard_work *work, const struct billboard_part *part,
	uint32_t q, uint32_t faces, double *invalid, struct lod_arena *arena)
{
	const struct billboard_fit *fit = &part->fit;
	const struct lod_billboard_plant *plant = work->plant;
	struct lod_arena_piece *mark = work->arena->last;
	struct canvas c = { work, &fit->quads[q], &item->image, NULL };
	item->center = lod_v3_add(plant->middle, lod_v3_scale(c.quad->center, plant->unit));
	item->u = lod_v3_scale(c.quad->u, c.quad->width * plant->unit);
	item->v = lod_v3_scale(c.quad->v, c.quad->height * plant->unit);
	item->image.width = side_of(c.quad->width);
	item->image.height = side_of(c.quad->height);
	size_t texels = (size_t)item->image.width * item->image.height;
	item->image.rgba = lod_arena_take(arena, texels, 4);
	c.front = lod_arena_take(work->arena, texels, sizeof *c.front);
	for (uint32_t i = 0; i < faces; i++) {
		const struct billboard_face *face = work->faces[i];
		uint32_t nearest;
		double projected;
		bool valid = billboard_face_judge(face, fit->quads, fit->quad_count, work->epsilon, &nearest,
			&projected);
		*invalid += q || valid ? 0 : face->area;
		if (fit->form == LOD_BILLBOARD_CROSS || nearest == q)
			paint_face(&c, face);
	}
	lod_arena_release(work->arena, mark);
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
