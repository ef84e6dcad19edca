/* Textures of billboards: faces of the part seen straight onto the billboard, the nearest in front, a texel
 * opaque where its middle is covered. */
#include <math.h>
#include <stdlib.h>

#include "tests/bench/baseline/billboard_state.h"

#define SIDE_MOST 1024u

struct canvas {
	const struct billboard_work *work;
	const struct billboard_quad *quad;
	struct eco_image *image;
	float *front;                /* height of the nearest over the billboard, per texel */
};

static uint32_t side_of(double half, double texel)
{
	double side = ceil(2 * half / texel);
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

/* The model's texel under barycentric weights; false where it is cut out. */
static bool look_up(const struct canvas *c, uint32_t triangle, const double weight[3], uint8_t rgb[3])
{
	const struct eco_model *model = c->work->plant->model;
	uint32_t source = c->work->plant->mesh.source[triangle];
	const struct eco_material *m = lod_mesh_material(model, model->material[source]);
	const struct eco_image *image = lod_mesh_image(model, model->material[source]);
	double uv[2] = { 0, 0 };
	for (int k = 0; k < 3; k++)
		rgb[k] = m->rgb[k];
	if (!image || !image->width || !image->height)
		return true;
	for (int k = 0; k < 3; k++)
		for (int i = 0; i < 2; i++)
			uv[i] += weight[k] * (double)model->uv[2 * (size_t)model->index[3 * (size_t)source
				+ (size_t)k] + (size_t)i];
	double x = (uv[0] - floor(uv[0])) * image->width, y = (uv[1] - floor(uv[1])) * image->height;
	if (!(x >= 0 && y >= 0))
		return true;
	uint32_t column = x < image->width ? (uint32_t)x : image->width - 1,
		row = y < image->height ? (uint32_t)y : image->height - 1;
	const uint8_t *texel = image->rgba + 4 * ((size_t)row * image->width + column);
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)(texel[k] * rgb[k] / 255);
	return !m->cutout || texel[3] >= 128;
}

static double clamped(double x, double most)
{
	return x < 0 ? 0 : x > most ? most : x;
}

static void paint_face(struct canvas *c, const struct billboard_face *face)
{
	struct lod_v3 p[3];
	double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
	uint32_t width = c->image->width, height = c->image->height;
	for (int k = 0; k < 3; k++) {
		p[k] = flatten(c, face->corner[k]);
		low[0] = fmin(low[0], p[k].x), high[0] = fmax(high[0], p[k].x);
		low[1] = fmin(low[1], p[k].y), high[1] = fmax(high[1], p[k].y);
	}
	double area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
	if (!(fabs(area) > 0))
		return;
	for (uint32_t y = (uint32_t)clamped(ceil(low[1] - 0.5), height); y + 0.5 <= high[1]
			&& y < height; y++)
		for (uint32_t x = (uint32_t)clamped(ceil(low[0] - 0.5), width); x + 0.5 <= high[0]
				&& x < width; x++) {
			double weight[3], at_x = x + 0.5, at_y = y + 0.5, h = 0;
			for (int k = 0; k < 3; k++) {
				const struct lod_v3 *a = &p[(k + 1) % 3], *b = &p[(k + 2) % 3];
				weight[k] = ((a->x - at_x) * (b->y - at_y)
					- (b->x - at_x) * (a->y - at_y)) / area;
				h += weight[k] * p[k].z;
			}
			size_t i = (size_t)y * width + x;
			uint8_t rgb[3], *to = c->image->rgba + 4 * i;
			if (weight[0] < 0 || weight[1] < 0 || weight[2] < 0
					|| (to[3] && !(h > (double)c->front[i]))
					|| !look_up(c, face->triangle, weight, rgb))
				continue;
			c->front[i] = (float)h;
			to[0] = rgb[0], to[1] = rgb[1], to[2] = rgb[2], to[3] = 255;
		}
}

/* All that the part's billboard number `which` shows. */
static void paint_faces(struct canvas *c, const struct billboard_fit *fit, uint32_t which, uint32_t faces,
	double *invalid)
{
	for (uint32_t i = 0; i < faces; i++) {
		const struct billboard_face *face = c->work->faces[i];
		struct billboard_validity v;
		billboard_face_judge(&v, face, fit->quads, fit->quad_count, c->work->epsilon);
		*invalid += which || v.valid ? 0 : face->area;
		if ((v.valid || !c->work->options.valid_only)
				&& (fit->form == LOD_BILLBOARD_CROSS || v.nearest == which))
			paint_face(c, face);
	}
}

static void place(struct lod_billboard *item, const struct billboard_quad *quad,
	const struct lod_billboard_plant *p)
{
	item->center = lod_v3_add(p->middle, lod_v3_scale(quad->center, p->unit));
	item->u = lod_v3_scale(quad->u, quad->width * p->unit);
	item->v = lod_v3_scale(quad->v, quad->height * p->unit);
}

enum eco_code billboard_bake(struct lod_billboard_cloud *cloud, uint32_t first, struct billboard_work *work,
	const struct billboard_part *part, double *invalid, struct eco_error *error)
{
	const struct billboard_fit *fit = &part->fit;
	uint32_t faces = billboard_part_faces(work, part->root, work->plant->tree.face_count);
	for (uint32_t q = 0; q < fit->quad_count; q++) {
		struct lod_billboard *item = &cloud->items[first + q];
		struct lod_arena_piece *mark = work->arena->last;
		struct canvas c = { work, &fit->quads[q], &item->image, NULL };
		item->form = fit->form;
		item->image.width = side_of(c.quad->width, work->options.texel);
		item->image.height = side_of(c.quad->height, work->options.texel);
		place(item, c.quad, work->plant);
		size_t texels = (size_t)item->image.width * item->image.height;
		item->image.rgba = calloc(texels, 4);
		if (!item->image.rgba)
			return eco_fail(error, ECO_NO_MEMORY, "no memory for textures of billboards");
		c.front = lod_arena_take(work->arena, texels, sizeof *c.front);
		paint_faces(&c, fit, q, faces, invalid);
		lod_arena_release(work->arena, mark);
		cloud->texels += texels;
	}
	return ECO_OK;
}
