#include "lod/build/element.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "lod/vector.h"

#define FAN (ECO_CORNERS_MAX - 2)
#define PLANAR 1e-4

static struct lod_v3 place(const struct lod_mesh *mesh, uint32_t vertex)
{
	return lod_v3_of(mesh->place + 3 * (size_t)vertex);
}

static uint32_t vertex_at(const struct lod_mesh *mesh, uint32_t t, uint32_t k)
{
	return mesh->index[3 * (size_t)t + k % 3];
}

/* ---- Turning diagonals ---- */

/* Edge of t behind which u lies, or 3. */
static uint32_t edge_to(const struct lod_mesh *mesh, uint32_t t, uint32_t u)
{
	uint32_t k = 0;
	while (k < 3 && (lod_mesh_across(mesh, t, k) == ECO_NONE || mesh->across[3 * (size_t)t + k] / 3 != u))
		k++;
	return k;
}

/* Whether the quad a b c d (in turn) is planar and convex at b and d, so that b d may replace the diagonal a
 * c. */
static bool planar_quad(struct lod_v3 a, struct lod_v3 b, struct lod_v3 c, struct lod_v3 d)
{
	struct lod_v3 normal = lod_v3_unit(lod_v3_cross(lod_v3_sub(c, a), lod_v3_sub(d, b)));
	double size = lod_v3_distance(a, c) + lod_v3_distance(b, d);
	bool flat = fabs(lod_v3_dot(normal, lod_v3_sub(b, a))) < PLANAR * size
		&& fabs(lod_v3_dot(normal, lod_v3_sub(c, b))) < PLANAR * size;
	double abd = lod_v3_dot(normal, lod_v3_cross(lod_v3_sub(b, a), lod_v3_sub(d, a)));
	double bcd = lod_v3_dot(normal, lod_v3_cross(lod_v3_sub(c, b), lod_v3_sub(d, b)));
	return flat && abd > 0 && bcd > 0;
}

/* Whether the texture over the quad is one linear map, within a fraction of a texel. */
static bool linear_texture(const struct lod_v3 p[4], const int32_t *uv[4])
{
	struct lod_v3 u = lod_v3_sub(p[1], p[0]), v = lod_v3_sub(p[3], p[0]), w = lod_v3_sub(p[2], p[0]);
	double uu = lod_v3_dot(u, u), uv_ = lod_v3_dot(u, v), vv = lod_v3_dot(v, v),
		det = uu * vv - uv_ * uv_;
	if (det <= 0)
		return false;
	double s = (lod_v3_dot(w, u) * vv - lod_v3_dot(w, v) * uv_) / det,
		t = (lod_v3_dot(w, v) * uu - lod_v3_dot(w, u) * uv_) / det;
	for (int a = 0; a < 2; a++)
		if (fabs(uv[0][a] + s * (uv[1][a] - uv[0][a]) + t * (uv[3][a] - uv[0][a]) - uv[2][a]) > 2)
			return false;
	return true;
}

/* Turns the diagonal at edge k of t. Does not update `across`. */
static bool turn(struct lod_mesh *mesh, uint32_t t, uint32_t k)
{
	uint32_t edge = mesh->across[3 * (size_t)t + k], u = edge / 3, j = edge % 3;
	uint32_t a = vertex_at(mesh, t, k), c = vertex_at(mesh, t, k + 1), d = vertex_at(mesh, t, k + 2),
		b = vertex_at(mesh, u, j + 2);
	bool alike = vertex_at(mesh, u, j) == c; /* wound as t is: its edge runs from c to a */
	int32_t uv[4][2];                                        /* of a b c d */
	memcpy(uv[0], mesh->uv + 6 * (size_t)t + 2 * k, sizeof uv[0]);
	memcpy(uv[1], mesh->uv + 6 * (size_t)u + 2 * ((j + 2) % 3), sizeof uv[1]);
	memcpy(uv[2], mesh->uv + 6 * (size_t)t + 2 * ((k + 1) % 3), sizeof uv[2]);
	memcpy(uv[3], mesh->uv + 6 * (size_t)t + 2 * ((k + 2) % 3), sizeof uv[3]);
	const int32_t *ua = mesh->uv + 6 * (size_t)u + 2 * (alike ? (j + 1) % 3 : j);
	const int32_t *uc = mesh->uv + 6 * (size_t)u + 2 * (alike ? j : (j + 1) % 3);
	struct lod_v3 p[4] = { place(mesh, a), place(mesh, b), place(mesh, c), place(mesh, d) };
	const int32_t *corners[4] = { uv[0], uv[1], uv[2], uv[3] };
	if (memcmp(ua, uv[0], sizeof uv[0]) || memcmp(uc, uv[2], sizeof uv[2])
			|| !planar_quad(p[0], p[1], p[2], p[3])
		|| !linear_texture(p, corners) || lod_mesh_flat(mesh, (uint32_t[]){ a, b, d })
		|| lod_mesh_flat(mesh, (uint32_t[]){ b, c, d }))
		return false;
	uint32_t first[3] = { 0, 1, 3 }, second[3] = { 1, 2, 3 }, all[4] = { a, b, c, d };
	for (int i = 0; i < 3; i++) {
		mesh->index[3 * (size_t)t + i] = all[first[i]];
		mesh->index[3 * (size_t)u + i] = all[second[i]];
		memcpy(mesh->uv + 6 * (size_t)t + 2 * i, uv[first[i]], sizeof uv[0]);
		memcpy(mesh->uv + 6 * (size_t)u + 2 * i, uv[second[i]], sizeof uv[0]);
	}
	return true;
}

/* The component's triangles as a strip from end to end; false if they are none. */
static bool as_strip(const struct lod_mesh *mesh, const uint32_t *member, uint32_t strip[4])
{
	uint32_t ends = 0, start = 0;
	for (uint32_t i = 0; i < 4; i++) {
		uint32_t neighbours = 0;
		for (uint32_t k = 0; k < 3; k++)
			neighbours += lod_mesh_across(mesh, member[i], k) != ECO_NONE;
		if (neighbours == 0 || neighbours == 3 || mesh->collapsed[member[i]])
			return false;
		if (neighbours == 1) {
			start = i;
			ends++;
		}
	}
	if (ends != 2)
		return false;
	strip[0] = member[start];
	for (uint32_t i = 1; i < 4; i++) {
		uint32_t k = 0;
		while (k < 3 && (lod_mesh_across(mesh, strip[i - 1], k) == ECO_NONE
			|| (i > 1 && mesh->across[3 * (size_t)strip[i - 1] + k] / 3 == strip[i - 2])))
			k++;
		if (k == 3)
			return false;
		strip[i] = mesh->across[3 * (size_t)strip[i - 1] + k] / 3;
	}
	return true;
}

static bool has_vertex(const struct lod_mesh *mesh, uint32_t t, uint32_t vertex)
{
	return vertex_at(mesh, t, 0) == vertex || vertex_at(mesh, t, 1) == vertex
		|| vertex_at(mesh, t, 2) == vertex;
}

void lod_elements_turn_diagonals(struct lod_mesh *mesh, struct lod_arena *arena)
{
	bool turned = false;
	for (uint32_t c = 0; c < mesh->component_count; c++) {
		const uint32_t *member = mesh->member + mesh->member_first[c];
		uint32_t strip[4];
		if (mesh->member_first[c + 1] - mesh->member_first[c] != 4 || !as_strip(mesh, member, strip))
			continue;
		bool fan = false;
		for (uint32_t k = 0; k < 3 && !fan; k++) {
			uint32_t v = vertex_at(mesh, strip[0], k);
			fan = has_vertex(mesh, strip[1], v) && has_vertex(mesh, strip[2], v)
				&& has_vertex(mesh, strip[3], v);
		}
		/* A zigzag: the first three triangles turn about one end of the middle edge, the last three
		 * about the other. Turning the diagonal at either end of the strip makes it one fan. */
		if (fan)
			continue;
		uint32_t k = edge_to(mesh, strip[0], strip[1]);
		if (turn(mesh, strip[0], k) || turn(mesh, strip[3], edge_to(mesh, strip[3], strip[2])))
			turned = true;
	}
	if (turned)
		lod_weld_neighbours(mesh, arena);
}

/* ---- Cutting into fans ---- */

struct cutter {
	const struct lod_mesh *mesh;
	uint8_t *free_around;        /* per triangle: free neighbours, or TAKEN */
	uint32_t *queue[4];          /* triangles by free neighbours; stale entries are skipped */
	uint32_t length[4], capacity[4];
};
#define TAKEN 255

static const int32_t *uv_of(const struct lod_mesh *mesh, uint32_t t, uint32_t vertex)
{
	for (uint32_t k = 0; k < 3; k++)
		if (vertex_at(mesh, t, k) == vertex)
			return mesh->uv + 6 * (size_t)t + 2 * k;
	assert(!"vertex is not of the triangle");
	return mesh->uv;
}

/* The free triangle behind the edge from center to rim of t, if it continues t's texture; else ECO_NONE. */
static uint32_t step(const struct cutter *c, uint32_t t, uint32_t center, uint32_t rim)
{
	for (uint32_t k = 0; k < 3; k++) {
		uint32_t p = vertex_at(c->mesh, t, k), q = vertex_at(c->mesh, t, k + 1), edge;
		if (!((p == center && q == rim) || (q == center && p == rim)))
			continue;
		edge = lod_mesh_across(c->mesh, t, k);
		if (edge == ECO_NONE || c->free_around[edge / 3] == TAKEN)
			return ECO_NONE;
		if (memcmp(uv_of(c->mesh, t, center), uv_of(c->mesh, edge / 3, center), 2 * sizeof(int32_t))
			|| memcmp(uv_of(c->mesh, t, rim), uv_of(c->mesh, edge / 3, rim), 2 * sizeof(int32_t)))
			return ECO_NONE;
		return edge / 3;
	}
	return ECO_NONE;
}

static uint32_t third(const struct lod_mesh *mesh, uint32_t t, uint32_t a, uint32_t b)
{
	uint32_t k = 0;
	while (k < 2 && (vertex_at(mesh, t, k) == a || vertex_at(mesh, t, k) == b))
		k++;
	return vertex_at(mesh, t, k);
}

/* A run of free triangles around corner k of t: triangle[i] lies between rim[i] and rim[i+1]; t is number
 * `at`. */
struct run { uint32_t triangle[2 * FAN - 1], rim[2 * FAN], count, at; };

static bool in_run(const struct run *run, uint32_t t)
{
	for (uint32_t i = 0; i < run->count; i++)
		if (run->triangle[i] == t)
			return true;
	return false;
}

static void walk(const struct cutter *c, uint32_t t, uint32_t k, struct run *run)
{
	uint32_t center = vertex_at(c->mesh, t, k), next;
	*run = (struct run){ .triangle = { t },
		.rim = { vertex_at(c->mesh, t, k + 1), vertex_at(c->mesh, t, k + 2) }, .count = 1 };
	while (run->count < FAN) {
		uint32_t rim = run->rim[run->count];
		next = step(c, run->triangle[run->count - 1], center, rim);
		if (next == ECO_NONE || in_run(run, next))
			break;
		run->triangle[run->count++] = next;
		run->rim[run->count] = third(c->mesh, next, center, rim);
	}
	while (run->at + 1 < FAN) {
		next = step(c, run->triangle[0], center, run->rim[0]);
		if (next == ECO_NONE || in_run(run, next))
			break;
		memmove(run->triangle + 1, run->triangle, run->count * sizeof *run->triangle);
		memmove(run->rim + 1, run->rim, (run->count + 1) * sizeof *run->rim);
		run->triangle[0] = next;
		run->rim[0] = third(c->mesh, next, center, run->rim[1]);
		run->count++;
		run->at++;
	}
}

/* The best fan that contains t: the most triangles, then those with the fewest free neighbours. */
static void best_fan(const struct cutter *c, uint32_t t, struct lod_element *element)
{
	int best = -1;
	for (uint32_t k = 0; k < 3; k++) {
		struct run run;
		walk(c, t, k, &run);
		uint32_t size = run.count < FAN ? run.count : FAN;
		for (uint32_t first = run.at + 1 > size ? run.at + 1 - size : 0;
				first <= run.at && first + size <= run.count; first++) {
			int score = 64 * (int)size;
			for (uint32_t i = first; i < first + size; i++)
				score -= c->free_around[run.triangle[i]];
			if (score <= best)
				continue;
			best = score;
			element->corners = (uint8_t)(size + 2);
			element->vertex[0] = vertex_at(c->mesh, t, k);
			memcpy(element->vertex + 1, run.rim + first, (size + 1) * sizeof *run.rim);
			memcpy(element->triangle, run.triangle + first, size * sizeof *run.triangle);
		}
	}
}

static void enqueue(struct cutter *c, uint32_t t)
{
	uint32_t n = c->free_around[t];
	assert(c->length[n] < c->capacity[n]);
	c->queue[n][c->length[n]++] = t;
}

/* Neighbour counts only fall, so a triangle enters each queue at most once. */
static void take(struct cutter *c, const struct lod_element *element)
{
	for (uint32_t i = 0; i + 2 < element->corners; i++)
		c->free_around[element->triangle[i]] = TAKEN;
	for (uint32_t i = 0; i + 2 < element->corners; i++)
		for (uint32_t k = 0; k < 3; k++) {
			uint32_t edge = lod_mesh_across(c->mesh, element->triangle[i], k);
			if (edge == ECO_NONE || c->free_around[edge / 3] == TAKEN)
				continue;
			c->free_around[edge / 3]--;
			enqueue(c, edge / 3);
		}
}

static void start(struct cutter *c, const struct lod_organs *organs)
{
	const struct lod_mesh *mesh = c->mesh;
	for (uint32_t t = 0; t < mesh->triangle_count; t++)
		if (mesh->collapsed[t] || organs->components[mesh->component[t]].organ == ECO_ORGAN_WOOD)
			c->free_around[t] = TAKEN;
	for (uint32_t t = mesh->triangle_count; t-- > 0;) { /* stacks: the first triangles come out first */
		if (c->free_around[t] == TAKEN)
			continue;
		for (uint32_t k = 0; k < 3; k++) {
			uint32_t edge = lod_mesh_across(mesh, t, k);
			c->free_around[t] =
				(uint8_t)(c->free_around[t]
				+ (edge != ECO_NONE && c->free_around[edge / 3] != TAKEN));
		}
		enqueue(c, t);
	}
}

void lod_elements_make(struct lod_elements *elements, const struct lod_mesh *mesh,
	const struct lod_organs *organs, struct lod_arena *arena)
{
	elements->count = 0;
	elements->items = lod_arena_take(arena, mesh->triangle_count, sizeof *elements->items);
	struct lod_arena_piece *mark = arena->last;
	struct cutter c = { .mesh = mesh, .free_around = lod_arena_take(arena, mesh->triangle_count, 1) };
	for (int n = 0; n < 4; n++) {
		c.capacity[n] = mesh->triangle_count;
		c.queue[n] = lod_arena_take(arena, mesh->triangle_count, sizeof *c.queue[n]);
	}
	start(&c, organs);
	for (int n = 0; n < 4;) {
		if (c.length[n] == 0) {
			n++;
			continue;
		}
		uint32_t t = c.queue[n][--c.length[n]];
		if (c.free_around[t] != n)
			continue;
		struct lod_element *element = &elements->items[elements->count++];
		best_fan(&c, t, element);
		take(&c, element);
		n = 0;
	}
	lod_arena_release(arena, mark);
}

/* ---- Properties of an element ---- */

void lod_uv_unturn(int32_t *uv, uint32_t corners)
{
	for (int a = 0; a < 2; a++) {
		int32_t least = INT32_MAX;
		for (uint32_t i = 0; i < corners; i++)
			least = uv[2 * i + a] < least ? uv[2 * i + a] : least;
		int32_t turns = least / ECO_UV_ONE - (least % ECO_UV_ONE < 0);
		for (uint32_t i = 0; i < corners; i++)
			uv[2 * i + a] -= turns * ECO_UV_ONE;
	}
}

void lod_element_uv(const struct lod_element *element, const struct lod_mesh *mesh, int32_t *uv)
{
	for (uint32_t i = 0; i < element->corners; i++)
		memcpy(uv + 2 * i, uv_of(mesh, element->triangle[i < 2 ? 0 : i - 2], element->vertex[i]),
			2 * sizeof *uv);
	lod_uv_unturn(uv, element->corners);
}

struct lod_v3 lod_element_center(const struct lod_element *element, const struct lod_mesh *mesh)
{
	struct lod_v3 sum = { 0, 0, 0 };
	for (uint32_t i = 0; i < element->corners; i++)
		sum = lod_v3_add(sum, place(mesh, element->vertex[i]));
	return lod_v3_scale(sum, 1.0 / element->corners);
}

struct lod_v3 lod_element_normal(const struct lod_element *element, const struct lod_mesh *mesh)
{
	struct lod_v3 sum = { 0, 0, 0 }, a = place(mesh, element->vertex[0]);
	for (uint32_t i = 1; i + 1 < element->corners; i++) {
		struct lod_v3 u = lod_v3_sub(place(mesh, element->vertex[i]), a),
			v = lod_v3_sub(place(mesh, element->vertex[i + 1]), a);
		sum = lod_v3_add(sum, lod_v3_cross(u, v));
	}
	return lod_v3_scale(sum, 0.5);
}

void lod_element_axis(const struct lod_element *element, const struct lod_mesh *mesh, uint32_t ends[2])
{
	double most = -1;
	for (uint32_t i = 0; i < element->corners; i++)
		for (uint32_t j = i + 1; j < element->corners; j++) {
			double d = lod_v3_distance(place(mesh, element->vertex[i]),
				place(mesh, element->vertex[j]));
			if (d > most) {
				most = d;
				ends[0] = i;
				ends[1] = j;
			}
		}
}
