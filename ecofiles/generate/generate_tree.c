/* Wood of broad crowns and of fronds. Points are scattered over the lobes of a crown. A curved shoot
 * reaches each from the nearest wood below, inner points first (a light version of space colonisation: one
 * pass). A piece of wood gets its radius from the number of shoots it carries, so branches taper and fork
 * as real ones do. */
#include "ecofiles/base/memory.h"
#include "ecofiles/generate/generate_plants.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>


#define STEP_M 0.45              /* length of wood between two rings */
#define LOBES_MAX 24

struct node {
	struct gen_v3 at;
	uint32_t parent, tips, main_child;
	double radius;
};

struct skeleton {
	struct node *nodes;
	uint32_t count, capacity;
};

static uint32_t add_node(struct skeleton *s, struct gen_v3 at, uint32_t parent)
{
	eco_grow(&s->nodes, &s->capacity, s->count, sizeof *s->nodes);
	s->nodes[s->count] = (struct node){ .at = at, .parent = parent, .main_child = ECO_NONE };
	return s->count++;
}

static void grow_trunk(struct skeleton *s, const struct gen_crown *crown, struct gen_random *random)
{
	double top = crown->height * (0.72 + 0.24 * crown->cone), azimuth = gen_random_in(random, 0, 360);
	uint32_t steps = (uint32_t)(top / STEP_M) + 2, before = ECO_NONE;
	struct gen_v3 lean = gen_mul(gen_heading(azimuth, 0), crown->lean), sway = gen_v3(0, 0, 0);
	for (uint32_t i = 0; i <= steps; i++) {
		double t = (double)i / steps;
		sway = gen_mad(sway, gen_heading(gen_random_in(random, 0, 360), 0),
			0.003 * crown->height * (i > 1));
		before = add_node(s, gen_add(gen_mad(gen_v3(0, 0, t * top), lean, t * t), sway), before);
	}
}

/* The wood nearest to a point of the crown; growth sideways and upwards counts as nearer than downwards. */
static uint32_t nearest_wood(const struct skeleton *s, struct gen_v3 to, double lowest)
{
	uint32_t best = 0;
	double least = INFINITY;
	for (uint32_t i = 0; i < s->count; i++) {
		struct gen_v3 d = gen_sub(to, s->nodes[i].at);
		double flat = sqrt(d.x * d.x + d.y * d.y), cost = gen_length(d);
		double too_high = s->nodes[i].at.z - (to.z - 0.35 * flat);
		if (too_high > 0)
			cost += 1.6 * too_high;
		if (s->nodes[i].at.z < lowest)
			cost += 4 * (lowest - s->nodes[i].at.z);
		if (cost < least) {
			least = cost;
			best = i;
		}
	}
	return best;
}

/* A quadratic curve that leaves along a mix of outwards and up, and ends at `to`. */
static uint32_t grow_shoot(struct skeleton *s, uint32_t from, struct gen_v3 to, struct gen_random *random)
{
	struct gen_v3 a = s->nodes[from].at, d = gen_sub(to, a);
	double length = gen_length(d);
	struct gen_v3 bend = gen_mul(gen_random_way(random), 0.12 * length);
	struct gen_v3 control = gen_add(gen_mad(gen_mad(a, d, 0.5), gen_v3(0, 0, 1), -0.10 * length), bend);
	uint32_t steps = (uint32_t)(length / STEP_M) + 1, before = from;
	for (uint32_t i = 1; i <= steps; i++) {
		double t = (double)i / steps, u = 1 - t;
		struct gen_v3 p = gen_add(gen_add(gen_mul(a, u * u), gen_mul(control, 2 * u * t)),
			gen_mul(to, t * t));
		if (i < steps)
			p = gen_mad(p, gen_random_way(random), 0.03);
		before = add_node(s, p, before);
	}
	return before;
}

/* Radii from cross-sections that add up; the foot flares. */
static void thicken(struct skeleton *s, const struct gen_crown *crown)
{
	for (uint32_t i = s->count; i-- > 0;) {
		struct node *n = &s->nodes[i];
		n->tips += n->tips == 0;
		if (n->parent == ECO_NONE)
			continue;
		struct node *p = &s->nodes[n->parent];
		p->tips += n->tips;
		if (p->main_child == ECO_NONE || s->nodes[p->main_child].tips <= n->tips)
			p->main_child = i;
	}
	double unit = crown->trunk_radius / sqrt(s->nodes[0].tips);
	for (uint32_t i = 0; i < s->count; i++) {
		double z = s->nodes[i].at.z, flare = 1 + 0.5 * (1 - gen_smooth(0, 0.06 * crown->height, z));
		s->nodes[i].radius = unit * sqrt(s->nodes[i].tips) * (s->nodes[i].parent == ECO_NONE
			|| z < 1 ? flare : 1);
	}
}

static void draw_wood(const struct skeleton *s, struct gen_mesh *mesh, uint8_t bark)
{
	struct gen_v3 *points = eco_alloc(s->count + 1u, sizeof *points);
	double *radius = eco_alloc(s->count + 1u, sizeof *radius);
	for (uint32_t i = 0; i < s->count; i++) {
		uint32_t parent = s->nodes[i].parent, n = 0;
		if (parent != ECO_NONE && s->nodes[parent].main_child == i)
			continue;
		if (parent != ECO_NONE) {
			points[n] = s->nodes[parent].at;
			radius[n++] = s->nodes[i].radius;
		}
		for (uint32_t at = i; at != ECO_NONE; at = s->nodes[at].main_child) {
			points[n] = s->nodes[at].at;
			radius[n++] = s->nodes[at].radius;
		}
		if (n < 2)
			continue;
		double r = radius[0];
		radius[n - 1] = 0;
		gen_tube(mesh, bark,
			&(struct gen_tube){ points, radius, n, r > 0.09 ? 10 : r > 0.04 ? 6 : r > 0.018 ? 4
			: 3 });
	}
	free(points);
	free(radius);
}

/* ---- Crowns ---- */

static double crown_width(const struct gen_crown *crown, double t)
{
	double round = sqrt(gen_clamp(4 * t * (1 - t), 0, 1)), cone = 1.05 - t;
	return crown->radius * (round + (cone - round) * crown->cone);
}

static void scatter_lobes(const struct gen_crown *crown, struct gen_random *random, struct gen_v3 lobe[],
	double size[])
{
	double span = crown->height - crown->base;
	for (uint32_t i = 0; i < crown->lobes; i++) {
		double t = 0.10 + 0.70 * (i + 0.5) / crown->lobes, width = crown_width(crown, t);
		size[i] = width * gen_random_in(random, 0.42, 0.58);
		double azimuth = 137.50776405 * i + gen_random_in(random, -25, 25);
		lobe[i] = gen_mul(gen_heading(azimuth, 0),
			(width - size[i]) * gen_random_in(random, 0.8, 1.05));
		lobe[i].z = crown->base + t * span;
	}
}

static int by_reach(const void *a, const void *b)
{
	const struct gen_shoot *x = a, *y = b;
	double dx = gen_length(gen_v3(x->at.x, x->at.y, 0)), dy = gen_length(gen_v3(y->at.x, y->at.y, 0));
	return dx < dy ? -1 : dx > dy;
}

static void scatter_shoots(const struct gen_crown *crown, struct gen_random *random, struct gen_shoot *shoots)
{
	struct gen_v3 lobe[LOBES_MAX];
	double size[LOBES_MAX], span = crown->height - crown->base;
	scatter_lobes(crown, random, lobe, size);
	struct gen_v3 middle = gen_v3(0, 0, crown->base + 0.42 * span);
	for (uint32_t i = 0; i < crown->shoots; i++) {
		uint32_t k = i % crown->lobes;
		struct gen_v3 way = gen_random_way(random);
		if (way.z < -0.35)
			way.z = -way.z;
		double depth = gen_random_in(random, 0.45, 1);
		struct gen_v3 at = gen_mad(lobe[k], way, size[k] * depth);
		at.z = gen_clamp(lobe[k].z + way.z * gen_clamp(size[k], 0, 0.21 * span) * depth, crown->base,
			crown->height);
		struct gen_v3 out = gen_sub(at, middle);
		double reach = gen_length(gen_v3(out.x / crown->radius, out.y / crown->radius,
			out.z / (0.58 * span)));
		shoots[i] = (struct gen_shoot){ at, gen_unit(gen_add(gen_unit(out), gen_mul(way, 0.5))),
			gen_clamp(0.55 * reach * reach + 0.45 * (at.z - crown->base) / span, 0, 1) };
	}
	qsort(shoots, crown->shoots, sizeof *shoots, by_reach);
}

void gen_tree(struct gen_mesh *mesh, uint8_t bark, const struct gen_crown *crown, struct gen_random *random,
	struct gen_shoot *shoots)
{
	struct skeleton s = { 0 };
	assert(crown->lobes >= 1 && crown->lobes <= LOBES_MAX);
	scatter_shoots(crown, random, shoots);
	grow_trunk(&s, crown, random);
	for (uint32_t i = 0; i < crown->shoots; i++) {
		uint32_t from = nearest_wood(&s, shoots[i].at, 0.55 * crown->base);
		grow_shoot(&s, from, shoots[i].at, random);
	}
	thicken(&s, crown);
	draw_wood(&s, mesh, bark);
	free(s.nodes);
}

/* ---- Fronds ---- */

#define RIB_POINTS 11

void gen_frond(struct gen_mesh *mesh, const struct gen_frond *frond, struct gen_random *random)
{
	struct gen_v3 rib[RIB_POINTS];
	double radius[RIB_POINTS], step = frond->length / (RIB_POINTS - 1);
	rib[0] = frond->at;
	radius[0] = frond->rib_radius;
	for (int i = 1; i < RIB_POINTS; i++) {
		double t = (double)i / (RIB_POINTS - 1);
		rib[i] = gen_mad(rib[i - 1], gen_heading(frond->azimuth_deg,
			frond->elevation_deg - frond->sink_deg * t * (0.4 + 0.6 * t)), step);
		radius[i] = i + 1 == RIB_POINTS ? 0 : frond->rib_radius * (1 - 0.85 * t);
	}
	gen_tube(mesh, frond->rib, &(struct gen_tube){ rib, radius, RIB_POINTS, 3 });
	for (uint32_t i = 0; i < 2 * frond->pairs; i++) {
		double t = 0.10 + 0.88 * ((i / 2) + 0.5) / frond->pairs;
		struct gen_v3 way, foot = gen_along(rib, RIB_POINTS, t * (RIB_POINTS - 1), &way);
		struct gen_v3 side = gen_unit(gen_cross(way, gen_v3(0, 0, 1))), up = gen_cross(side, way);
		double length = frond->leaflet * (0.35 + 0.65 * sqrt(gen_clamp(3.2 * t * (1.02 - t), 0, 1)))
			* gen_random_in(random, 0.9, 1.08);
		struct gen_v3 along = gen_add(gen_mul(side, i % 2 ? 1 : -1),
			gen_mad(gen_mul(up, 0.18), way, 0.55 + 0.5 * t));
		uint32_t shade = gen_random_shade(random, 0.35 + 0.4 * up.z, 0.3, frond->shades);
		gen_leaf(mesh, (uint8_t)(frond->leaf + shade),
			&(struct gen_leaf){ .at = foot, .along = along, .face = gen_mad(up, side, 0.25),
			.length = length, .width = frond->width, .bend = 0.22, .shape = frond->shape });
	}
}
