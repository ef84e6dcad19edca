/* Footprints to meshes; building_rings.c has their rings.
 *
 * A pitched roof is the lower envelope of planes: each rises from a side of the rectangle that lies along the longest
 * wall. Convex pieces of the footprint are cut where planes meet, so that no footprint is too odd for a ridge; walls go
 * up to the same points. */
#include "ecofiles/generate/buildings.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/random.h"
#include "ecofiles/generate/building_rings.h"

#define RISE 0.7 /* of a pitched roof, metres a metre: 35 degrees */
#define SHED_RISE 0.2
#define ROOF_MOST 0.5 /* of the height of the ridge */
#define PLANES_MAX 4
#define GRID 4096.0 /* steps a metre */
#define COVER_NEAR_M 0.004 /* corners are rounded, covers are not */

/* Plaster, brick and concrete; flat roofs; tiles and slates. */
static const uint8_t walls[][3] = { { 214, 204, 186 }, { 196, 184, 168 }, { 205, 190, 160 },
	{ 178, 150, 132 }, { 188, 188, 184 } },
		     flats[][3] = { { 138, 136, 132 }, { 120, 118, 116 }, { 152, 148, 140 } },
		     pitches[][3] = { { 140, 84, 66 }, { 122, 78, 64 }, { 96, 92, 92 } };
enum {
	WALLS = sizeof walls / sizeof *walls,
	FLATS = sizeof flats / sizeof *flats,
	PITCHES = sizeof pitches / sizeof *pitches,
	MATERIALS = WALLS + FLATS + PITCHES
};

struct builder {
	struct eco_model *model;
	uint32_t capacity; /* triangles */
	const struct eco_building *building;
	double from[3]; /* first corner of the building and its base, relative to the origin */
	struct gen_rings rings;
	uint32_t wall, cover; /* materials */
	double planes[PLANES_MAX][3];
	int plane_count; /* z over the eaves = a x + b y + c, metres; count 0: flat */
	double eaves_m;  /* above the base */
};

/* ---- Mesh ---- */

struct point {
	double x, y, z;
}; /* metres from the first corner, above the base */

static bool same_point(const struct point *p, const struct point *q)
{
	return p->x == q->x && p->y == q->y && p->z == q->z;
}

static void add_triangle(struct builder *b, uint32_t material, struct point p, struct point q, struct point r)
{
	struct eco_model *m = b->model;
	const struct point all[3] = { p, q, r };
	if (same_point(&p, &q) || same_point(&q, &r) || same_point(&r, &p))
		return;
	if (m->triangle_count == b->capacity) {
		b->capacity = b->capacity ? 2 * b->capacity : 256;
		m->position = eco_realloc(m->position, 9 * (size_t)b->capacity, sizeof *m->position);
		m->index = eco_realloc(m->index, 3 * (size_t)b->capacity, sizeof *m->index);
		m->material = eco_realloc(m->material, b->capacity, sizeof *m->material);
	}
	m->material[m->triangle_count] = material;
	for (int i = 0; i < 3; i++) {
		float *to = m->position + 3 * (size_t)m->vertex_count;
		to[0] = (float)(b->from[0] + all[i].x);
		to[1] = (float)(b->from[1] + all[i].y);
		to[2] = (float)(b->from[2] + all[i].z);
		m->index[3 * (size_t)m->triangle_count + (size_t)i] = m->vertex_count++;
	}
	m->triangle_count++;
}

static void add_fan(struct builder *b, uint32_t material, const struct point *points, uint32_t count)
{
	for (uint32_t i = 1; i + 1 < count; i++)
		add_triangle(b, material, points[0], points[i], points[i + 1]);
}

/* ---- Roofs ---- */

static double plane_at(const struct builder *b, int plane, const struct point *p)
{
	return b->planes[plane][0] * p->x + b->planes[plane][1] * p->y + b->planes[plane][2];
}

/* The point of an edge at which two planes meet, the same from both of its ends. */
static struct point meeting(const struct builder *b, int one, int other, struct point p, struct point q)
{
	if (p.x > q.x || (p.x == q.x && p.y > q.y)) {
		struct point swap = p;
		p = q;
		q = swap;
	}
	double at_p = plane_at(b, one, &p) - plane_at(b, other, &p),
	       at_q = plane_at(b, one, &q) - plane_at(b, other, &q), t = at_p / (at_p - at_q);
	return (struct point){ p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), 0 };
}

#define NEARLY 1e-9 /* metres: planes that differ by less meet there */

/* The part of a convex polygon, or of a line of two points, where plane `one` is not above `other`. */
static uint32_t keep_below(const struct builder *b, int one, int other, const struct point *from,
	uint32_t count, struct point *to)
{
	uint32_t kept = 0;
	for (uint32_t i = 0; i < count; i++) {
		const struct point *p = &from[i], *q = &from[(i + 1) % count];
		double at_p = plane_at(b, one, p) - plane_at(b, other, p),
		       at_q = plane_at(b, one, q) - plane_at(b, other, q);
		if (at_p <= NEARLY)
			to[kept++] = *p;
		if ((count > 2 || i == 0) &&
			((at_p > NEARLY && at_q < -NEARLY) || (at_p < -NEARLY && at_q > NEARLY)))
			to[kept++] = meeting(b, one, other, *p, *q);
	}
	return kept;
}

/* The part of a polygon or line that plane `one` covers, in points[0] or [1], which is returned. */
static struct point *keep_plane(const struct builder *b, int one, struct point *points[2], uint32_t *count)
{
	int now = 0;
	for (int other = 0; other < b->plane_count; other++)
		if (other != one) {
			*count = keep_below(b, one, other, points[now], *count, points[1 - now]);
			now = 1 - now;
		}
	return points[now];
}

static struct point metres(struct gen_corner c)
{
	return (struct point){ (double)c.x / 1000, (double)c.y / 1000, 0 };
}

/* Puts a point on the least of the planes. A point reached by two ways differs in its last bits: pitched roofs
 * have a grid. */
static void put_on_roof(const struct builder *b, struct point *p)
{
	double z = b->plane_count ? INFINITY : 0;
	for (int i = 0; i < b->plane_count; i++)
		z = fmin(z, plane_at(b, i, p));
	p->z = b->eaves_m + floor(fmax(z, 0) * GRID + 0.5) / GRID;
	if (b->plane_count) {
		p->x = floor(p->x * GRID + 0.5) / GRID;
		p->y = floor(p->y * GRID + 0.5) / GRID;
	}
}

static void cover_piece(void *ctx, const struct gen_corner *corners, uint32_t count)
{
	struct builder *b = ctx;
	size_t most = count + 2 * PLANES_MAX;
	struct point *points[2] = { eco_alloc(most, sizeof(struct point)), eco_alloc(most, sizeof(struct point)) };
	for (int plane = 0; plane < (b->plane_count ? b->plane_count : 1); plane++) {
		uint32_t kept = count;
		for (uint32_t i = 0; i < count; i++)
			points[0][i] = metres(corners[i]);
		struct point *part = keep_plane(b, plane, points, &kept);
		for (uint32_t i = 0; i < kept; i++)
			put_on_roof(b, &part[i]);
		add_fan(b, b->cover, part, kept);
	}
	free(points[0]);
	free(points[1]);
}

/* Along the longest wall: ends of the footprint along u, and along v across it, so that u is the longer way. */
struct frame {
	double u[2], low[2], high[2];
}; /* low, high: along u, along v */

static struct frame frame_of(const struct gen_ring *r)
{
	struct frame f = { { 1, 0 }, { INFINITY, INFINITY }, { -INFINITY, -INFINITY } };
	double longest = 0;
	for (uint32_t i = 0; i < r->count; i++) {
		struct point p = metres(r->corners[i]), q = metres(r->corners[(i + 1) % r->count]);
		double x = q.x - p.x, y = q.y - p.y, length = sqrt(x * x + y * y);
		if (length > longest) {
			longest = length;
			f.u[0] = x / length;
			f.u[1] = y / length;
		}
	}
	for (uint32_t i = 0; i < r->count; i++) {
		struct point p = metres(r->corners[i]);
		double at[2] = { f.u[0] * p.x + f.u[1] * p.y, f.u[0] * p.y - f.u[1] * p.x };
		for (int k = 0; k < 2; k++) {
			f.low[k] = fmin(f.low[k], at[k]);
			f.high[k] = fmax(f.high[k], at[k]);
		}
	}
	if (f.high[1] - f.low[1] >
		f.high[0] - f.low[0]) { /* v is the longer way: it becomes u, and -u becomes v */
		double x = f.u[0], low = f.low[0], high = f.high[0];
		f.u[0] = -f.u[1];
		f.u[1] = x;
		f.low[0] = f.low[1];
		f.high[0] = f.high[1];
		f.low[1] = -high;
		f.high[1] = -low;
	}
	return f;
}

/* A plane that is 0 where the way along the axis (0: u, 1: v) is `from`, and rises by `slope` a metre from there on. */
static void add_plane(struct builder *b, const struct frame *f, int axis, double from, double slope)
{
	double *plane = b->planes[b->plane_count++], x = axis ? -f->u[1] : f->u[0],
	       y = axis ? f->u[0] : f->u[1];
	plane[0] = slope * x;
	plane[1] = slope * y;
	plane[2] = -slope * from;
}

static void choose_planes(struct builder *b, const struct gen_ring *r)
{
	const struct eco_building *building = b->building;
	struct frame f = frame_of(r);
	double across = f.high[1] - f.low[1], along = f.high[0] - f.low[0], half = across / 2;
	double rise = building->roof == ECO_ROOF_SHED ? SHED_RISE * across : RISE * half;
	rise = fmin(rise, ROOF_MOST / (building->to_eaves ? 1 - ROOF_MOST : 1) * building->height_m);
	b->eaves_m = building->height_m - (building->to_eaves ? 0 : rise);
	if (building->roof == ECO_ROOF_SHED) {
		add_plane(b, &f, 1, f.low[1], rise / across);
		return;
	}
	add_plane(b, &f, 1, f.low[1], rise / half);
	add_plane(b, &f, 1, f.high[1], -rise / half);
	if (building->roof == ECO_ROOF_GABLED)
		return;
	double reach = building->roof == ECO_ROOF_PYRAMIDAL ? along / 2 : half;
	add_plane(b, &f, 0, f.low[0], rise / reach);
	add_plane(b, &f, 0, f.high[0], -rise / reach);
}

/* ---- Walls ---- */

static double way_to(const struct point *from, const struct point *p)
{
	return (p->x - from->x) * (p->x - from->x) + (p->y - from->y) * (p->y - from->y);
}

/* A wall below the roof's points: ends of the parts of its line that each plane covers. */
static void add_wall(struct builder *b, struct gen_corner from, struct gen_corner to)
{
	struct point p = metres(from), q = metres(to), parts[2][8], *points[2] = { parts[0], parts[1] },
		     wall[2 + 2 * PLANES_MAX + 2];
	uint32_t tops = 0;
	for (int plane = 0; plane < b->plane_count; plane++) {
		uint32_t kept = 2;
		parts[0][0] = p;
		parts[0][1] = q;
		const struct point *part = keep_plane(b, plane, points, &kept);
		for (uint32_t i = 0; i < kept; i++)
			wall[2 + tops++] = part[i];
	}
	/* from q back to p, each once */
	wall[2 + tops++] = q;
	wall[2 + tops++] = p;
	for (uint32_t i = 1; i < tops; i++)
		for (uint32_t k = i; k > 0 && way_to(&p, &wall[2 + k]) > way_to(&p, &wall[1 + k]); k--) {
			struct point swap = wall[2 + k];
			wall[2 + k] = wall[1 + k];
			wall[1 + k] = swap;
		}
	uint32_t count = 2;
	for (uint32_t i = 0; i < tops; i++)
		if (i == 0 || wall[2 + i].x != wall[count - 1].x || wall[2 + i].y != wall[count - 1].y)
			wall[count++] = wall[2 + i];
	for (uint32_t i = 2; i < count; i++)
		put_on_roof(b, &wall[i]);
	wall[0] = p;
	wall[1] = q;
	wall[0].z = wall[1].z = -ECO_BUILDING_SINK_M;
	add_fan(b, b->wall, wall, count);
}

/* Ends of a cover along a wall of `length`, from 0 to 1, as metres; false: it is not in its line. */
static bool find_cover(const struct builder *b, const struct eco_edge *cover, const struct point *p, const struct point *q,
	double at[2])
{
	const double *first = b->building->edges[0].a;
	double x = q->x - p->x, y = q->y - p->y, length = sqrt(x * x + y * y);
	for (int k = 0; k < 2; k++) {
		const double *end = k ? cover->b : cover->a;
		double dx = end[0] - first[0] - p->x, dy = end[1] - first[1] - p->y;
		at[k] = (dx * x + dy * y) / length;
		if (!(fabs(dy * x - dx * y) <= COVER_NEAR_M * length))
			return false;
	}
	if (at[0] > at[1]) {
		double swap = at[0];
		at[0] = at[1];
		at[1] = swap;
	}
	return at[1] > 0 && at[0] < length;
}

/* The stretches of a wall that no other building draws: those from `from` metres on. */
static void add_open_wall(struct builder *b, struct gen_corner c, struct gen_corner d)
{
	struct point p = metres(c), q = metres(d);
	double length = sqrt(way_to(&p, &q)), from = 0, at[2];
	for (bool moved = true; moved && from < length;) {
		double next = length, skip = from;
		for (uint32_t i = 0; i < b->building->cover_count; i++)
			if (find_cover(b, &b->building->covers[i], &p, &q, at) && at[1] > from + COVER_NEAR_M) {
				next = fmin(next, fmax(at[0], from));
				skip = at[0] <= from + COVER_NEAR_M ? fmax(skip, at[1]) : skip;
			}
		moved = skip > from || next < length;
		if (skip > from) {
			from = skip;
			continue;
		}
		struct gen_corner ends[2] = { c, d };
		for (int k = 0; k < 2; k++) {
			double t = (k ? next : from) / length;
			if (t > 0 && t < 1)
				ends[k] = (struct gen_corner){ c.x + (int64_t)floor(t * (double)(d.x - c.x) + 0.5),
					c.y + (int64_t)floor(t * (double)(d.y - c.y) + 0.5) };
		}
		add_wall(b, ends[0], ends[1]);
		from = next;
	}
}

/* ---- All ---- */

static void choose_colors(struct builder *b)
{
	const double *at = b->building->edges[0].a;
	uint64_t bits =
		eco_random((uint64_t)(int64_t)floor(at[0] * 10), (uint64_t)(int64_t)floor(at[1] * 10));
	b->wall = (uint32_t)(bits % WALLS);
	b->cover = (uint32_t)(b->plane_count ? WALLS + FLATS + (bits >> 32) % PITCHES
					     : WALLS + (bits >> 32) % FLATS);
}

static bool is_hole_of(const struct builder *b, uint32_t k, uint32_t outer)
{
	return b->rings.items[k].hole && b->rings.items[k].outer == outer;
}

static void add_surface(struct builder *b, uint32_t outer)
{
	bool holes = false;
	for (uint32_t k = 0; k < b->rings.count; k++)
		holes = holes || is_hole_of(b, k, outer);
	b->plane_count = 0;
	b->eaves_m = b->building->height_m;
	if (b->building->roof != ECO_ROOF_FLAT && !holes)
		choose_planes(b, &b->rings.items[outer]);
	choose_colors(b);
	struct gen_ring joined = gen_rings_join(&b->rings, outer);
	gen_ring_pieces(&joined, cover_piece, b);
	free(joined.corners);
	for (uint32_t k = 0; k < b->rings.count; k++) {
		const struct gen_ring *r = &b->rings.items[k];
		for (uint32_t i = 0; (k == outer || is_hole_of(b, k, outer)) && i < r->count; i++)
			add_open_wall(b, r->corners[i], r->corners[(i + 1) % r->count]);
	}
}

static void add_building(struct builder *b, struct eco_buildings_notes *notes)
{
	bool good = gen_rings_take(&b->rings, b->building->edges, b->building->edge_count), holes = false;
	uint32_t before = b->model->triangle_count;
	for (uint32_t k = 0; k < b->rings.count && good; k++) {
		holes = holes || b->rings.items[k].hole;
		if (!b->rings.items[k].hole)
			add_surface(b, k);
	}
	notes->nothing += b->model->triangle_count == before;
	notes->crossed += good && b->rings.crossed;
	notes->flat += good && holes && b->building->roof != ECO_ROOF_FLAT;
	gen_rings_free(&b->rings);
}

bool eco_building_stands(const struct eco_building *building)
{
	struct gen_rings *rings = eco_alloc(1, sizeof *rings);
	bool good = gen_rings_take(rings, building->edges, building->edge_count), stands = false;
	for (uint32_t k = 0; k < rings->count && good; k++)
		stands = stands || !rings->items[k].hole;
	gen_rings_free(rings);
	free(rings);
	return stands;
}

static void add_material(struct eco_model *model, const char *name, const uint8_t rgb[3])
{
	struct eco_material *m = &model->materials[model->material_count];
	*m = (struct eco_material){ .image = ECO_NONE };
	snprintf(m->name, sizeof m->name, "%s %u", name, model->material_count++);
	memcpy(m->rgb, rgb, sizeof m->rgb);
}

void eco_buildings_make(struct eco_model *model, const struct eco_building *buildings, uint32_t count,
	const double origin[3], struct eco_buildings_notes *notes)
{
	struct builder *b = eco_alloc(1, sizeof *b);
	*model = (struct eco_model){ .object = true,
		.scale = 1,
		.materials = eco_alloc(MATERIALS, sizeof *model->materials),
		.source = { .format = "footprints",
			.up = ECO_UP_Z,
			.up_how = ECO_HOW_GIVEN,
			.unit_m = 1,
			.unit_how = ECO_HOW_GIVEN } };
	for (uint32_t i = 0; i < WALLS; i++)
		add_material(model, "wall", walls[i]);
	for (uint32_t i = 0; i < FLATS; i++)
		add_material(model, "flat roof", flats[i]);
	for (uint32_t i = 0; i < PITCHES; i++)
		add_material(model, "roof", pitches[i]);
	b->model = model;
	for (uint32_t i = 0; i < count; i++) {
		const double *first = buildings[i].edges[0].a;
		b->building = &buildings[i];
		b->from[0] = first[0] - origin[0];
		b->from[1] = first[1] - origin[1];
		b->from[2] = buildings[i].base_m - origin[2];
		add_building(b, notes);
	}
	model->triangles_in = model->triangle_count;
	free(b);
}
