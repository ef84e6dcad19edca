/* Each thread draws every n-th cut of the selection for all plants that draw it, so a cut's geometry is made
 * once; the highest of a texel stays, so the map is the same whatever their number.
 *
 * Triangles and lines are drawn as polygons. Points are discs across the beams, and splats the outlines of
 * their ellipsoids, both flat, at the height of their middle: what of them is beyond it shades itself. */
#include "client-min/draw/view_shadow.h"

#include <math.h>
#include <stdlib.h>

#include "client-min/draw/view_mesh.h"
#include "lod/vec3.h"
#include "client-min/draw/view_picture.h"
#include "lod/impostor.h"
#include "lod/raster/texel.h"
#include "lod/splat.h"

#define FAR_RADII 64.0f                  /* from where an impostor is looked at */

struct caster {                          /* of a thread */
	const struct view_shadow_job *job;
	const struct view_shadow *shadow;
	float *top;
	uint32_t number, count;
	enum eco_code code;
	struct eco_error error;
};

/* One plant: the map's rows of its coordinates (row[i] times a place, plus at[i]), and the sun in them. */
struct object { vec3 row[4], sun; float at[4]; };

/* Texture coordinates s, t only where there is a texture. */
struct corner { float u, v, w, height, s, t; };

static vec3 vec_of(const float *p) { return vec3(p[0], p[1], p[2]); }

/* World's axes to the plant's, times `size`. */
static vec3 turned(const float *r, const struct lod_place *place, double size)
{
	const double s = place->sine, q = place->cosine, across = size * lod_place_width(place);
	return vec3((float)(((double)r[0] * q + (double)r[1] * s) * across),
		(float)(((double)r[1] * q - (double)r[0] * s) * across), (float)((double)r[2] * size));
}

static void place_object(struct object *o, const struct caster *c, const struct lod_place *place)
{
	for (int i = 0; i < 4; i++) {
		const float *r = c->shadow->row[i];
		double offset = (double)r[3];
		for (int k = 0; k < 3; k++)
			offset += (double)r[k] * (place->at[k] - c->job->eye->at[k]);
		o->row[i] = turned(r, place, place->scale);
		o->at[i] = (float)offset;
	}
	o->sun = turned(c->shadow->row[3], place, 1);
}

static struct corner corner_of(const struct object *o, vec3 p)
{
	return (struct corner){ dot(o->row[0], p) + o->at[0], dot(o->row[1], p) + o->at[1],
		dot(o->row[2], p) + o->at[2], dot(o->row[3], p) + o->at[3], 0, 0 };
}

/* ---- Triangles ---- */

/* Texels [from, to] whose middles lie between two places; false: none. */
static bool span_of(const struct caster *c, float low, float high, int span[2])
{
	float last = (float)c->shadow->size - 0.5f;
	if (!(low <= last && high >= 0.5f))
		return false;
	low = low > 0.5f ? low - 0.5f : 0;
	span[0] = (int)low + ((float)(int)low < low);
	span[1] = (int)((high < last ? high : last) - 0.5f);
	return span[0] <= span[1];
}

static bool span_of_three(const struct caster *c, const float at[3], int span[2])
{
	float low = at[0] < at[1] ? at[0] : at[1], high = at[0] < at[1] ? at[1] : at[0];
	return span_of(c, at[2] < low ? at[2] : low, at[2] > high ? at[2] : high, span);
}

static float *top_of(const struct caster *c, int x, int y)
{
	return c->top + (size_t)y * c->shadow->size + (size_t)x;
}

static void raise(const struct caster *c, int x, int y, float height)
{
	float *top = top_of(c, x, y);
	*top = height > *top ? height : *top;
}

/* A triangle in the map: its first corner, its sides, and by corner all that is 1 / W times as much there, so
 * that it is linear in the map. */
struct piece { float x, y, ax, ay, bx, by, part, per_w[3], height[3], s[3], t[3]; };

static float mixed(const float share[3], const float v[3])
{
	return share[0] * v[0] + share[1] * v[1] + share[2] * v[2];
}

static void draw_texel(const struct caster *c, const struct piece *p, const struct eco_image *cutout, int x,
	int y)
{
	float dx = (float)x + 0.5f - p->x, dy = (float)y + 0.5f - p->y, *top = top_of(c, x, y);
	float share[3] = { 0, (dx * p->by - p->bx * dy) * p->part, (p->ax * dy - dx * p->ay) * p->part };
	share[0] = 1 - share[1] - share[2];
	if (!(share[0] >= 0 && share[1] >= 0 && share[2] >= 0))
		return;
	float w = 1 / mixed(share, p->per_w), height = mixed(share, p->height) * w;
	if (height > *top && (!cutout || lod_texel_at(cutout, (double)(mixed(share, p->s) * w),
			(double)(mixed(share, p->t) * w))[3] >= 128))
		*top = height;
}

/* All corners have W > 0. */
static void fill_triangle(const struct caster *c, const struct corner corner[3],
	const struct eco_image *cutout)
{
	float x[3], y[3];
	int across[2], down[2];
	struct piece p;
	for (int i = 0; i < 3; i++) {
		p.per_w[i] = 1 / corner[i].w;
		x[i] = corner[i].u * p.per_w[i];
		y[i] = corner[i].v * p.per_w[i];
	}
	if (!span_of_three(c, x, across) || !span_of_three(c, y, down))
		return;
	p.x = x[0], p.ax = x[1] - x[0], p.bx = x[2] - x[0];
	p.y = y[0], p.ay = y[1] - y[0], p.by = y[2] - y[0];
	p.part = 1 / (p.ax * p.by - p.bx * p.ay);
	if (!isfinite(p.part))
		return;
	for (int i = 0; i < 3; i++) {
		p.height[i] = corner[i].height * p.per_w[i];
		p.s[i] = corner[i].s * p.per_w[i];
		p.t[i] = corner[i].t * p.per_w[i];
	}
	for (int j = down[0]; j <= down[1]; j++)
		for (int i = across[0]; i <= across[1]; i++)
			draw_texel(c, &p, cutout, i, j);
}

static struct corner between(const struct corner *a, const struct corner *b)
{
	float t = (VIEW_SHADOW_LEAST_W - a->w) / (b->w - a->w);
	return (struct corner){ a->u + t * (b->u - a->u), a->v + t * (b->v - a->v), VIEW_SHADOW_LEAST_W,
		a->height + t * (b->height - a->height), a->s + t * (b->s - a->s),
		a->t + t * (b->t - a->t) };
}

/* The part of a triangle where W is positive, which has up to four corners. */
static void draw_triangle(const struct caster *c, const struct corner corner[3],
	const struct eco_image *cutout)
{
	struct corner kept[4];
	int count = 0;
	for (int i = 0; i < 3; i++) {
		const struct corner *a = &corner[i], *b = &corner[(i + 1) % 3];
		if (a->w >= VIEW_SHADOW_LEAST_W)
			kept[count++] = *a;
		if ((a->w >= VIEW_SHADOW_LEAST_W) != (b->w >= VIEW_SHADOW_LEAST_W))
			kept[count++] = between(a, b);
	}
	for (int i = 2; i < count; i++) {
		const struct corner part[3] = { kept[0], kept[i - 1], kept[i] };
		fill_triangle(c, part, cutout);
	}
}

static void draw_triangles(const struct caster *c, const struct object *o, const struct view_mesh *mesh)
{
	const struct lod_geometry *g = &mesh->geometry;
	const struct eco_image *cutout = g->uv ? mesh->batch.cutout : NULL;
	for (uint32_t i = 0; i < mesh->batch.count; i++) {
		struct corner corner[3];
		for (int k = 0; k < 3; k++) {
			size_t vertex = 3 * (size_t)i + (size_t)k;
			corner[k] = corner_of(o, vec_of(g->position + 3 * vertex));
			if (cutout) {
				corner[k].s = g->uv[2 * vertex];
				corner[k].t = g->uv[2 * vertex + 1];
			}
		}
		draw_triangle(c, corner, cutout);
	}
}

/* ---- Lines ---- */

static void draw_line(const struct caster *c, const struct object *o, vec3 a, vec3 b, float width)
{
	vec3 side = cross(add(b, scale(a, -1)), o->sun);
	float size = length(side), part = size > 0 ? 0.5f * width / size : 0;
	const vec3 s = scale(side, part), less = scale(s, -1);
	const struct corner corner[4] = { corner_of(o, add(a, less)), corner_of(o, add(b, less)),
		corner_of(o, add(b, s)), corner_of(o, add(a, s)) };
	draw_triangle(c, corner, NULL);
	draw_triangle(c, (const struct corner[3]){ corner[0], corner[2], corner[3] }, NULL);
}

static void draw_lines(const struct caster *c, const struct object *o, const struct view_mesh *mesh)
{
	const struct lod_geometry *g = &mesh->geometry;
	for (uint32_t i = 0; i < mesh->batch.count; i++)
		draw_line(c, o, vec_of(g->position + 6 * (size_t)i), vec_of(g->position + 6 * (size_t)i + 3),
			g->width[i]);
}

/* ---- Discs, ellipsoids and impostors ---- */

/* The part of the map that an ellipsoid covers, exactly: W is to it what distance is to a picture
 * (lod/splat.h). */
struct outline { float x, y, height; struct lod_ellipse ellipse; int across[2], down[2]; };

static bool outline_of(const struct caster *c, const struct object *o, vec3 center, const vec3 *half,
	int count, struct outline *e)
{
	struct corner m = corner_of(o, center);
	float across[3] = { 0, 0, 0 }, down[3] = { 0, 0, 0 }, farther[3] = { 0, 0, 0 };
	if (!(m.w >= VIEW_SHADOW_LEAST_W))
		return false;
	e->x = m.u / m.w;
	e->y = m.v / m.w;
	e->height = m.height;
	for (int k = 0; k < count; k++) {
		farther[k] = dot(o->row[2], half[k]) / m.w;
		across[k] = dot(o->row[0], half[k]) / m.w - e->x * farther[k];
		down[k] = dot(o->row[1], half[k]) / m.w - e->y * farther[k];
	}
	if (!lod_ellipse_make(&e->ellipse, across, down, farther, m.w))
		return false;
	e->x += e->ellipse.x;
	e->y += e->ellipse.y;
	return span_of(c, e->x - e->ellipse.wide, e->x + e->ellipse.wide, e->across)
		&& span_of(c, e->y - e->ellipse.high, e->y + e->ellipse.high, e->down);
}

static bool outline_has(const struct outline *e, int x, int y)
{
	float dx = (float)x + 0.5f - e->x, dy = (float)y + 0.5f - e->y;
	return fabsf(dx - e->ellipse.lean * dy) <= lod_ellipse_row(&e->ellipse, dy);
}

/* Two directions across the beams, of a length. */
static void disc_of(const struct object *o, float radius, vec3 half[2])
{
	bool flat = fabsf(o->sun.x) < 0.7f;
	vec3 first = cross(o->sun, vec3(flat, !flat, 0));
	half[0] = scale(first, radius / length(first));
	half[1] = cross(o->sun, half[0]);
}

static void draw_points(const struct caster *c, const struct object *o, const struct view_mesh *mesh)
{
	const struct lod_geometry *g = &mesh->geometry;
	for (uint32_t i = 0; i < mesh->batch.count; i++) {
		const float *center = g->position + 3 * (size_t)i;
		vec3 half[3];
		struct outline e;
		uint32_t salt = lod_splat_salt(center, 0);
		for (size_t k = 0; k < 3 && g->half; k++)
			half[k] = vec_of(g->half + 9 * (size_t)i + 3 * k);
		if (!g->half)
			disc_of(o, view_mesh_reach(mesh, i), half);
		if (!outline_of(c, o, vec_of(center), half, g->half ? 3 : 2, &e))
			continue;
		for (int y = e.down[0]; y <= e.down[1]; y++)
			for (int x = e.across[0]; x <= e.across[1]; x++)
				if (outline_has(&e, x, y) && (!g->opacity || lod_splat_covers(salt,
						(uint32_t)x, (uint32_t)y, g->opacity[i])))
					raise(c, x, y, e.height);
	}
}

/* Shares of two half axes at which a texel's beam meets their plane through `m`. */
static void meet_plane(const struct object *o, const struct corner *m, const vec3 half[2], int x, int y,
	float share[2])
{
	const float at[2] = { (float)x + 0.5f, (float)y + 0.5f };
	const float left[2] = { at[0] * m->w - m->u, at[1] * m->w - m->v };
	float d[2][2];
	for (int i = 0; i < 2; i++)
		for (int k = 0; k < 2; k++)
			d[i][k] = dot(o->row[i], half[k]) - at[i] * dot(o->row[2], half[k]);
	float part = 1 / (d[0][0] * d[1][1] - d[0][1] * d[1][0]);
	share[0] = (left[0] * d[1][1] - d[0][1] * left[1]) * part;
	share[1] = (d[0][0] * left[1] - left[0] * d[1][0]) * part;
}

/* The middle casts: from the eye and from the sun near sides differ by more than a shadow map forgives, and
 * plants would shade themselves. */
static void draw_impostor(const struct caster *c, const struct object *o, const struct view_mesh *mesh)
{
	vec3 center = vec_of(mesh->center), eye = scale(o->sun, FAR_RADII * mesh->radius), half[2];
	struct corner m = corner_of(o, center);
	struct lod_impostor_look look;
	struct outline e;
	uint32_t salt = lod_splat_salt(mesh->center, 0);
	disc_of(o, mesh->radius, half);
	if (!outline_of(c, o, center, half, 2, &e))
		return;
	lod_impostor_look(&look, mesh->impostor, (const float[3]){ eye.x, eye.y, eye.z });
	for (int y = e.down[0]; y <= e.down[1]; y++)
		for (int x = e.across[0]; x <= e.across[1]; x++) {
			struct lod_impostor_hit hit;
			float share[2];
			meet_plane(o, &m, half, x, y, share);
			vec3 ray = add(add(scale(half[0], share[0]), scale(half[1], share[1])), scale(eye, -1));
			if (outline_has(&e, x, y) && lod_splat_covers(salt, (uint32_t)x, (uint32_t)y,
					mesh->impostor->opacity) && lod_impostor_hit(mesh->impostor, &look,
					(const float[3]){ ray.x, ray.y, ray.z }, &hit))
				raise(c, x, y, corner_of(o, add(add(center, eye), scale(ray, hit.middle))).height);
		}
}

/* ---- Cuts ---- */

/* Whether the map may hold any of the ball around a mesh. */
static bool is_near(const struct caster *c, const struct object *o, const struct view_mesh *mesh)
{
	vec3 half[2], center = vec_of(mesh->center);
	struct outline e;
	disc_of(o, mesh->radius, half);
	float w = corner_of(o, center).w, a = dot(o->row[2], half[0]), b = dot(o->row[2], half[1]),
		reach = sqrtf(a * a + b * b);
	if (w < 1.01f * reach + VIEW_SHADOW_LEAST_W)         /* it reaches where W is 0, and has no outline */
		return w + reach > 0;
	return outline_of(c, o, center, half, 2, &e);
}

static void draw_mesh(const struct caster *c, const struct lod_place *place, const struct view_mesh *mesh)
{
	struct object o;
	place_object(&o, c, place);
	if (!is_near(c, &o, mesh))
		return;
	if (mesh->impostor)
		draw_impostor(c, &o, mesh);
	else if (mesh->list->list.kind == ECO_LIST_TRIANGLES)
		draw_triangles(c, &o, mesh);
	else if (mesh->list->list.kind == ECO_LIST_LINES)
		draw_lines(c, &o, mesh);
	else
		draw_points(c, &o, mesh);
}

static void draw_cuts(void *casters, uint32_t number)
{
	struct caster *c = (struct caster *)casters + number;
	const struct view_selection *s = c->job->casters;
	for (uint32_t cut = number; cut < s->cut_count && !c->code; cut += c->count) {
		uint32_t first = s->member_first[cut], end = s->member_first[cut + 1];
		struct view_mesh mesh = { .list = NULL };
		if (first == end)
			continue;
		uint32_t plant = s->instances[s->members[first]].plant;
		c->code = view_mesh_make(&mesh, c->job->store, &s->plan_cuts[cut],
			plant == ECO_NONE ? NULL : view_store_plant(c->job->store, plant), &c->error);
		for (uint32_t m = first; m < end && !c->code; m++)
			draw_mesh(c, &s->instances[s->members[m]].place, &mesh);
		view_mesh_free(&mesh);
	}
}

/* The first thread draws into the map itself, the others into maps that are then merged. */
static enum eco_code open_caster(struct caster *c, const struct caster *like, uint32_t number)
{
	size_t texels = (size_t)like->shadow->size * like->shadow->size;
	*c = *like;
	c->number = number;
	if (number && !(c->top = malloc(texels * sizeof *c->top)))
		return ECO_NO_MEMORY;
	for (size_t i = 0; i < texels; i++)
		c->top[i] = -INFINITY;
	return ECO_OK;
}

static void close_caster(const struct caster *c, float *top)
{
	size_t texels = (size_t)c->shadow->size * c->shadow->size;
	if (!c->number || !c->top)
		return;
	for (size_t i = 0; i < texels; i++)
		top[i] = c->top[i] > top[i] ? c->top[i] : top[i];
	free(c->top);
}

enum eco_code view_shadow_cast(struct view_shadow *shadow, const struct view_shadow_job *job,
	struct eco_error *error)
{
	uint32_t count = view_thread_count(job->threads), opened = 0;
	struct caster *casters = calloc(count, sizeof *casters);
	const struct caster like = { job, shadow, shadow->top, 0, count, ECO_OK, { .text = "" } };
	enum eco_code code = casters ? ECO_OK : ECO_NO_MEMORY;
	for (; opened < count && !code; opened++)
		code = open_caster(&casters[opened], &like, opened);
	if (code)
		eco_fail(error, code, "no memory for shadows");
	else
		view_threads_run(count, draw_cuts, casters);
	for (uint32_t i = 0; i < opened; i++) {
		if (!code && casters[i].code)
			code = eco_fail(error, casters[i].code, "%s", casters[i].error.text);
		close_caster(&casters[i], shadow->top);
	}
	free(casters);
	return code;
}
