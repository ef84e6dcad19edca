/* Wood of library plants: stems, boughs, twigs and shoots, each a bent path that ends at the crown's edge (after Weber
 * and Penn 1995, with lengths from a profile of the crown instead of curves for each species). All differences between
 * habits are columns of words/habits.tsv. The wood is scaled so that its leaves end where the plant does. */
#include "ecofiles/generate/generate_growth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "build/words/habits.table"
#include "ecofiles/base/angle16.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/format/pack.h"
#include "ecofiles/generate/generate_scenes.h"

#define COUNT(table) (sizeof(table) / sizeof *(table))
#define POINTS 12u
#define GOLDEN_DEG 137.50776405
#define DIRECTIONS 8u
#define TWIG_M 0.0025      /* least radius of drawn wood */
#define SHOOTS_MOST 2400.0 /* of a plant, and boughs, twigs that it may have beside */
#define LEAF_MOST 0.2      /* of leaves, as a share of the plant's height and width */
#define WALL_DEPTH 0.16    /* of a plant on a wall, as a share of its width */
#define YOUNG 0.5          /* of the usual height: smaller plants have neither heads, nor arms where stems are leaves */
#define ROWS 4u            /* of a field, in one plant */

enum plan { PLAN_ROUND, PLAN_BOX, PLAN_WALL, PLAN_ROWS };

struct branch {
	struct gen_v3 at[POINTS];
	double radius[POINTS], length;
	uint32_t count;
};

struct grower {
	const struct habits_row *h;
	struct gen_mesh *mesh;
	struct gen_random *random;
	struct gen_foliage foliage;
	double height, half, lowest;  /* metres; lowest: no branch goes below */
	double boughs, twigs, shoots; /* numbers by habit, fewer in small plants */
	enum plan plan;
	uint64_t noise;
	uint8_t bark, head;
	struct gen_bearer *bearers;
	uint32_t bearer_count, bearer_capacity;
};

static unsigned one_of(const char *name, const char *const *names)
{
	unsigned i = 0;
	while (names[i + 1] && strcmp(names[i], name) != 0)
		i++;
	return i;
}

/* ---- The crown ---- */

/* Half width of the crown at a share of its height, in the direction of a point. */
static double reach_at(const struct grower *g, double t, struct gen_v3 at)
{
	const double r[5] = { g->h->r0, g->h->r25, g->h->r50, g->h->r75, g->h->r100 };
	double k = 4 * gen_clamp(t, 0, 1), flat = sqrt(at.x * at.x + at.y * at.y) + 1e-9;
	uint32_t i = k < 3 ? (uint32_t)k : 3;
	double lump = gen_noise(g->noise, 1.6 * at.x / flat + 2.3 * t, 1.6 * at.y / flat - 1.9 * t) - 0.5;
	return g->half * (r[i] + (r[i + 1] - r[i]) * (k - i)) * (1 + 1.3 * g->h->ragged * lump);
}

static bool is_inside(const struct grower *g, struct gen_v3 at)
{
	double t = (at.z / g->height - g->h->base) / (1 - g->h->base), reach = reach_at(g, t, at);
	if (t > 1 || at.z < g->lowest)
		return false;
	if (g->plan == PLAN_WALL)
		return fabs(at.x) <= reach && fabs(at.y) <= WALL_DEPTH * g->half;
	if (g->plan != PLAN_ROUND)
		return fmax(fabs(at.x), fabs(at.y)) <= reach;
	return at.x * at.x + at.y * at.y <= reach * reach;
}

/* Metres from a point to the crown's edge, `most` at most. */
static double room(const struct grower *g, struct gen_v3 from, struct gen_v3 way, double most)
{
	double inside = 0, step = most / 24;
	while (inside < most && is_inside(g, gen_mad(from, way, inside + step)))
		inside += step;
	for (int i = 0; i < 5 && inside < most; i++) {
		step /= 2;
		if (is_inside(g, gen_mad(from, way, inside + step)))
			inside += step;
	}
	return fmin(inside, most);
}

/* 0 deep inside, 1 at the outside and the top */
static double light_at(const struct grower *g, struct gen_v3 at)
{
	double t = gen_clamp((at.z / g->height - g->h->base) / (1 - g->h->base), 0, 1),
	       out = sqrt(at.x * at.x + at.y * at.y) / (reach_at(g, t, at) + 1e-9);
	return gen_clamp(0.1 + 0.45 * out * out + 0.4 * t, 0, 1);
}

/* ---- Branches ---- */

/* Towards +Z by some degrees, or towards -Z; not beyond. */
static struct gen_v3 bent(struct gen_v3 way, double degrees)
{
	struct gen_v3 to = gen_v3(0, 0, degrees < 0 ? -1 : 1), axis = gen_cross(way, to);
	double s, c;
	eco_angle16_sincos(eco_angle16_from_deg(fabs(degrees)), &s, &c);
	if (way.z * to.z >= c || gen_length(axis) < 1e-6)
		return fabs(degrees) > 0.01 && way.z * to.z >= c ? to : way;
	return gen_turned(way, gen_unit(axis), fabs(degrees));
}

struct path {
	struct gen_v3 from, way;
	double length, curve_deg, radius, tip, sway;
	uint32_t steps;
	bool is_free;
};

/* A path that ends at the crown's edge unless it is free; tapers to the share `tip`. */
static void grow_branch(struct grower *g, struct branch *b, const struct path *p)
{
	struct gen_v3 way = gen_unit(p->way);
	b->at[0] = p->from;
	b->count = 1;
	b->length = 0;
	for (uint32_t i = 1; i <= p->steps; i++) {
		way = gen_unit(gen_mad(bent(way, p->curve_deg / p->steps), gen_random_way(g->random),
			p->sway * g->h->sway));
		struct gen_v3 next = gen_mad(b->at[i - 1], way, p->length / p->steps);
		if (i > 1 && !p->is_free && !is_inside(g, next))
			break;
		if (next.z < 0.2 * g->lowest)
			next.z = 0.2 * g->lowest;
		b->at[b->count++] = next;
		b->length += p->length / p->steps;
	}
	for (uint32_t i = 0; i < b->count; i++)
		b->radius[i] = p->radius * (1 - (1 - p->tip) * i / (b->count - 1));
}

static void draw_branch(struct grower *g, const struct branch *b, uint32_t sides)
{
	gen_tube(g->mesh, g->bark, &(struct gen_tube){ b->at, b->radius, b->count, sides });
}

/* The last branches of habits with blades: a strip along the path, widest in its lower part; wide ones are rounder. */
static void draw_ribbon(struct grower *g, const struct branch *b)
{
	double light = light_at(g, b->at[b->count - 1]), width = b->length * g->h->slim / 2;
	uint8_t material = (uint8_t)(g->foliage.leaf + gen_foliage_shade(&g->foliage, light));
	struct gen_v3 side = gen_across(gen_sub(b->at[1], b->at[0]));
	for (uint32_t i = 0; i < b->count; i++) {
		double t = (double)i / (b->count - 1), round = 2 * sqrt(t * (1 - t)),
		       half = width * (round * g->h->slim + (0.55 + 1.5 * t * (1 - t)) * (1 - t * t * t) * (1 - g->h->slim));
		uint32_t first = gen_vertex(g->mesh, gen_mad(b->at[i], side, -half));
		if (i + 1 < b->count)
			gen_vertex(g->mesh, gen_mad(b->at[i], side, half));
		if (i == 0)
			continue;
		gen_triangle(g->mesh, material, (uint32_t[]){ first - 2, first - 1, first });
		if (i + 1 < b->count)
			gen_triangle(g->mesh, material, (uint32_t[]){ first - 1, first + 1, first });
	}
}

static struct gen_v3 point_on(const struct branch *b, double t, struct gen_v3 *way, double *radius)
{
	double at = gen_clamp(t, 0, 0.99999) * (b->count - 1);
	uint32_t k = (uint32_t)at;
	*radius = b->radius[k] + (b->radius[k + 1] - b->radius[k]) * (at - k);
	return gen_along(b->at, b->count, at, way);
}

/* Leaves grow on the branch from the share `from` on. */
static void bear(struct grower *g, const struct branch *b, double from)
{
	uint32_t steps = b->count - 1;
	for (uint32_t i = 0; i < steps; i++) {
		double low = fmax(from * steps - i, 0);
		if (low >= 1)
			continue;
		struct gen_v3 step = gen_sub(b->at[i + 1], b->at[i]), foot = gen_mad(b->at[i], step, low);
		eco_grow(&g->bearers, &g->bearer_capacity, g->bearer_count, sizeof *g->bearers);
		g->bearers[g->bearer_count++] = (struct gen_bearer){ foot, gen_mul(step, 1 - low), light_at(g, b->at[i + 1]),
			((i + low) / steps - from) / (1 - from), (1 - low) / steps / (1 - from), i + 1 == steps };
	}
}

/* Draws the last branch of a plant, with its leaves. */
static void end_branch(struct grower *g, const struct branch *b, uint32_t sides, double bare)
{
	if (g->foliage.arrangement == GEN_RIBBON && g->foliage.count > 0) {
		draw_ribbon(g, b);
		return;
	}
	draw_branch(g, b, sides);
	bear(g, b, bare);
}

/* The way of child number i: under an angle with its parent's, to one side or around it. */
static struct gen_v3 child_way(struct grower *g, struct gen_v3 way, double degrees, uint32_t i)
{
	bool flat = gen_random_unit(g->random) < g->h->flat;
	double turn = flat ? 180 * (i % 2) + gen_random_in(g->random, -14, 14)
			   : GOLDEN_DEG * i + gen_random_in(g->random, -25, 25);
	return gen_way_off(way, degrees * gen_random_in(g->random, 0.8, 1.2), turn);
}

static uint32_t whole(struct grower *g, double number)
{
	return (uint32_t)(number + gen_random_unit(g->random));
}

static void grow_shoots(struct grower *g, const struct branch *twig)
{
	struct branch b;
	uint32_t count = whole(g, g->shoots);
	for (uint32_t i = 0; i < count; i++) {
		double t = 0.2 + 0.8 * (i + gen_random_unit(g->random)) / count, radius;
		struct gen_v3 way, from = point_on(twig, t, &way, &radius);
		struct path p = { .from = from, .sway = 1, .curve_deg = 10, .radius = fmax(0.6 * radius, TWIG_M) };
		/* one random number a statement: compilers differ in the order of others */
		p.way = child_way(g, way, g->h->twig_deg, i);
		p.length = g->h->shoot * twig->length * (1 - 0.45 * t) * gen_random_in(g->random, 0.75, 1.25);
		if (g->h->hang > 0) {
			p.curve_deg = -150;
			p.steps = 3;
			p.length = g->h->hang * g->height * gen_random_in(g->random, 0.4, 1.1);
		} else
			p.steps = p.length > 0.9 ? 2 : 1;
		grow_branch(g, &b, &p);
		end_branch(g, &b, 3, 0);
	}
}

static void grow_twigs(struct grower *g, const struct branch *bough)
{
	struct branch b;
	uint32_t count = whole(g, g->twigs * fmin(0.35 + 0.65 * bough->length / g->half, 2.2));
	for (uint32_t i = 0; i < count; i++) {
		double t = g->h->bare + (0.98 - g->h->bare) * (i + gen_random_unit(g->random)) / count,
		       radius;
		struct gen_v3 way, from = point_on(bough, t, &way, &radius);
		struct gen_v3 out = child_way(g, way, g->h->twig_deg, i);
		double length =
			g->h->twig * bough->length * (1 - 0.6 * t) * gen_random_in(g->random, 0.8, 1.25);
		length = fmax(room(g, from, out, length), 0.25 * length);
		grow_branch(g, &b, &(struct path){ .from = from,
				.way = out,
				.length = length,
				.steps = length > 1.2 ? 3 : 2,
				.sway = 1,
				.curve_deg = 0.5 * g->h->curve_deg,
				.radius = fmax(0.55 * radius, TWIG_M) });
		if (g->shoots < 0.5) {
			end_branch(g, &b, 3, 0);
			continue;
		}
		draw_branch(g, &b, 3);
		bear(g, &b, 0.6);
		grow_shoots(g, &b);
	}
}

/* Stems that are leaves: a cactus. */
static bool is_blunt(const struct habits_row *h)
{
	return h->lai == 0 && h->twigs == 0;
}

/* A bough from the stem's point at height share t of the part with boughs. */
static void grow_bough(struct grower *g, const struct branch *stem, double t, double azimuth, double light_t)
{
	const struct habits_row *h = g->h;
	struct branch b;
	double radius, elevation =
		h->low_deg + (h->top_deg - h->low_deg) * light_t + gen_random_in(g->random, -6, 6);
	struct gen_v3 way, from = point_on(stem, t, &way, &radius), out = gen_heading(azimuth, elevation);
	double length = h->reach > 0 ? h->reach * g->half * gen_random_in(g->random, 0.88, 1.1)
				     : room(g, from, out, 2.5 * fmax(g->half, 0.3 * g->height)) *
			gen_random_in(g->random, 0.86, 1.04);
	bool last = g->twigs < 0.5;
	length = fmax(length, 0.05 * g->half);
	radius = fmax(h->thick * radius * gen_clamp(0.3 + 0.7 * length / g->half, 0.3, 1.1), TWIG_M);
	grow_branch(g, &b, &(struct path){ .from = from,
			.way = out,
			.length = length,
			.radius = radius,
			.sway = 1,
			.curve_deg = h->curve_deg,
			.steps = last && h->reach > 0 ? 8 : 6,
			.is_free = h->reach > 0,
			.tip = is_blunt(h) ? 0.8 : 0 });
	if (is_blunt(h))
		b.radius[b.count - 1] = 0;
	if (last) {
		end_branch(g, &b, radius > 0.05 ? 8 : 3, h->bare);
		return;
	}
	draw_branch(g, &b, radius > 0.06 ? 6 : radius > 0.02 ? 5 : 3);
	bear(g, &b, 0.86);
	grow_twigs(g, &b);
}

static void grow_boughs(struct grower *g, const struct branch *stem, uint32_t number)
{
	const struct habits_row *h = g->h;
	uint32_t count = whole(g, g->boughs), whorl = (uint32_t)h->whorl;
	double low = h->foot / h->leader, start = gen_random_in(g->random, 0, 360) + 70 * number;
	for (uint32_t i = 0; i < count; i++) {
		double at = whorl ? (double)(i / whorl) / ((count - 1) / whorl + 1)
				  : (i + gen_random_unit(g->random)) / count;
		double azimuth =
			whorl ? 360.0 / whorl * (i % whorl) + 0.5 * GOLDEN_DEG * (i / whorl) : GOLDEN_DEG * i;
		double t = low + (0.985 - low) * at + (whorl ? gen_random_in(g->random, 0, 0.012) : 0);
		grow_bough(g, stem, t, start + azimuth + gen_random_in(g->random, -10, 10), at);
	}
}

/* ---- Heads ---- */

static void draw_flower(struct grower *g, struct gen_v3 at, struct gen_v3 way, double length)
{
	struct gen_v3 across = gen_across(way);
	for (uint32_t k = 0; k < 7; k++) {
		struct gen_v3 out = gen_turned(across, way, 360.0 * k / 7);
		gen_leaf(g->mesh, (uint8_t)(g->foliage.flower + gen_foliage_shade(&g->foliage, 0.5)),
			&(struct gen_leaf){ .at = at,
				.along = gen_mad(out, way, 0.6),
				.face = way,
				.length = 0.6 * length,
				.width = 0.42 * length,
				.bend = 0.1,
				.shape = GEN_LEAF_HEXAGON });
	}
}

static void draw_head(struct grower *g, const struct branch *stem)
{
	static const char *const kinds[] = { "none", "flower", "plume", "ear", NULL };
	double length = g->h->head_part * g->height * gen_random_in(g->random, 0.85, 1.15);
	struct gen_v3 at = stem->at[stem->count - 1], way = gen_unit(gen_sub(at, stem->at[stem->count - 2]));
	unsigned kind = g->height < YOUNG * g->h->height_m ? 0 : one_of(g->h->head, kinds);
	if (kind == 1 && g->foliage.flowers > 0)
		draw_flower(g, at, way, length);
	for (uint32_t k = 0; kind == 2 && k < 14; k++) {
		struct gen_leaf leaf = { .at = gen_mad(at, way, -0.3 * length * (k % 4) / 4), .length = 0.8 * length,
			.width = 0.1 * length, .shape = GEN_LEAF_RHOMB };
		leaf.along = gen_mad(way, gen_random_way(g->random), 0.25);
		leaf.face = gen_random_way(g->random);
		gen_leaf(g->mesh, (uint8_t)(g->foliage.flower + gen_foliage_shade(&g->foliage, 0.5)), &leaf);
	}
	if (kind == 3)
		gen_tube(g->mesh, (uint8_t)(g->foliage.flower + 2),
			&(struct gen_tube){ (struct gen_v3[]){ at, gen_mad(at, way, 0.3 * length),
						    gen_mad(at, way, length) },
				(double[]){ 0.03 * length, 0.09 * length, 0 }, 3, 5 });
}

/* ---- Stems ---- */

static struct gen_v3 foot_of(struct grower *g, uint32_t i, uint32_t count, double *share)
{
	double ring = g->h->ring * g->half, edge = gen_random_in(g->random, -0.5, 0.5);
	*share = count > 1 ? sqrt((i + 0.3) / count) : 0;
	if (g->plan == PLAN_ROWS) {
		uint32_t row = i % ROWS, in_row = (count + ROWS - 1) / ROWS;
		return gen_v3(ring * (2 * (i / ROWS + 0.5 + 0.4 * edge) / in_row - 1),
			ring * (2 * (row + 0.5 + 0.15 * edge) / ROWS - 1), 0);
	}
	if (count == 1)
		return gen_v3(0, 0, 0);
	struct gen_v3 foot = gen_mul(gen_heading(GOLDEN_DEG * i, 0), ring * *share);
	foot.y *= g->plan == PLAN_WALL ? WALL_DEPTH : 1;
	return foot;
}

static void grow_stem(struct grower *g, uint32_t i, uint32_t count)
{
	const struct habits_row *h = g->h;
	struct branch b;
	bool ribbon = g->boughs < 0.5 && g->foliage.arrangement == GEN_RIBBON, many = count > 1;
	double share, radius = 0.5 * h->trunk * g->height / sqrt(count), lean;
	struct gen_v3 foot = foot_of(g, i, count, &share);
	lean = h->splay_deg * share;
	struct gen_v3 way =
		gen_heading(GOLDEN_DEG * i + (g->plan == PLAN_ROWS ? 0 : gen_random_in(g->random, -12, 12)),
			90 - lean);
	way.y *= g->plan == PLAN_WALL ? WALL_DEPTH : 1;
	double length = h->leader * g->height * (many ? gen_random_in(g->random, 0.74, 1.02) : 1);
	grow_branch(g, &b, &(struct path){ .from = foot, .way = way, .length = length,
			.steps = ribbon ? 5 : many ? 7 : POINTS - 1,
			.sway = many ? 1 : 0.4,
			.curve_deg = many ? h->stem_deg * (0.4 + 0.6 * share) : 0,
			.radius = radius,
			.tip = is_blunt(h)                  ? 0.8
				: h->leader >= 0.97 || many ? 0
				: h->leader > 0.9           ? 0.2
				: h->foot >= 0.7            ? 0.75
							    : 0.42,
			.is_free = ribbon || !many || h->leader > 1 || g->boughs < 0.5 });
	if (!many && h->lai + h->twigs > 0) /* the foot flares */
		b.radius[0] *= 1.4;
	if (is_blunt(h))
		b.radius[b.count - 1] = 0;
	if (ribbon) {
		end_branch(g, &b, 3, 0);
		return;
	}
	if (g->boughs < 0.5)
		end_branch(g, &b, is_blunt(h) ? 9 : 3, 0.08);
	else {
		draw_branch(g, &b, radius > 0.12 ? 12 : radius > 0.03 ? 7 : many && radius < 0.006 ? 3 : 5);
		bear(g, &b, 0.9);
		grow_boughs(g, &b, i);
	}
	draw_head(g, &b);
}

/* ---- Whole plants ---- */

/* Numbers of branches by the habit, fewer where there are fewer leaves to bear, as in small plants. */
static void count_branches(struct grower *g)
{
	const struct habits_row *h = g->h;
	double stems = h->stems, all = stems * fmax(h->boughs, 1) * fmax(h->twigs, 1) * fmax(h->shoots, 1),
	       most = fmin(SHOOTS_MOST, h->lai > 0 ? fmax(0.6 * g->foliage.count, 40) : SHOOTS_MOST),
	       fewer = fmin(most / all, 1);
	double root = sqrt(sqrt(fewer));
	g->boughs = h->boughs * (h->twigs > 0 ? root : 1);
	g->twigs = h->twigs * (h->shoots > 0 ? root : root * root);
	g->shoots = h->shoots * root * root;
	if (is_blunt(h) && g->height < YOUNG * h->height_m)
		g->boughs = 0;
	else if (h->boughs > 0)
		g->boughs = fmax(g->boughs, h->twigs > 0 ? fmin(h->boughs, 6) : h->boughs);
	if (h->twigs > 0)
		g->twigs = fmax(g->twigs, 2);
}

/* Half of the mean width of the hull from above, and the top. */
static void measure(const struct gen_mesh *mesh, double *half, double *top)
{
	*half = *top = 0;
	for (uint32_t k = 0; k < DIRECTIONS; k++) {
		struct gen_v3 way = gen_heading(180.0 * k / DIRECTIONS, 0);
		double low = 0, high = 0;
		for (uint32_t i = 0; i < mesh->count; i++) {
			double at = way.x * mesh->position[i].x + way.y * mesh->position[i].y;
			low = fmin(low, at);
			high = fmax(high, at);
			*top = fmax(*top, mesh->position[i].z);
		}
		*half += (high - low) / (2 * DIRECTIONS);
	}
}

static void fit(struct grower *g, double half_m, double height_m)
{
	double half, top;
	measure(g->mesh, &half, &top);
	double wide = half_m / half, high = height_m / top;
	for (uint32_t i = 0; i < g->mesh->count; i++) {
		struct gen_v3 *p = &g->mesh->position[i];
		*p = gen_v3(p->x * wide, p->y * wide, fmax(p->z, 0) * high);
	}
	for (uint32_t i = 0; i < g->bearer_count; i++) {
		struct gen_bearer *b = &g->bearers[i];
		b->from = gen_v3(b->from.x * wide, b->from.y * wide, b->from.z * high);
		b->along = gen_v3(b->along.x * wide, b->along.y * wide, b->along.z * high);
	}
}

/* Fits the wood so that its leaves, which keep their size, end where the plant does: they are placed twice, first to see
 * how far they reach beyond the wood. */
static void fit_with_leaves(struct grower *g, double half_m, double height_m)
{
	const uint32_t vertices = g->mesh->count, faces = g->mesh->face_count;
	const struct gen_random random = *g->random;
	double half, top;
	fit(g, half_m, height_m);
	gen_foliage_place(&g->foliage, g->bearers, g->bearer_count);
	measure(g->mesh, &half, &top);
	g->mesh->count = vertices;
	g->mesh->face_count = faces;
	*g->random = random;
	fit(g, fmax(2 * half_m - half, 0.3 * half_m), fmax(2 * height_m - top, 0.3 * height_m));
	gen_foliage_place(&g->foliage, g->bearers, g->bearer_count);
	fit(g, half_m, height_m);
}

static uint32_t scaled(uint32_t rgb, double factor)
{
	uint32_t out = 0;
	for (int bit = 16; bit >= 0; bit -= 8)
		out |= (uint32_t)gen_clamp((rgb >> bit & 255) * factor + 0.5, 0, 255) << bit;
	return out;
}

static void set_cells(struct gen_spray *spray, const struct gen_plant_look *look, uint32_t dark, uint32_t bright)
{
	for (uint32_t k = 0; k < GEN_CELLS; k++)
		for (int c = 0; c < 3; c++) {
			uint32_t low = dark >> (16 - 8 * c) & 255, high = bright >> (16 - 8 * c) & 255;
			spray->rgb[k][c] = (uint8_t)(low + (high - (double)low) * k / (GEN_CELLS - 1));
			spray->wood[c] = (uint8_t)(look->bark >> (16 - 8 * c));
		}
	spray->uneven = 0.24;
}

static void make_materials(struct grower *g, uint8_t organ[GEN_MATERIALS_MAX], struct gen_spray sprays[2],
	const struct gen_plant_look *look)
{
	static const char *const names[] = { "leaf", "flower" };
	const uint32_t colors[2][2] = { { scaled(look->leaf, look->is_motley ? 0.72 : 0.56),
						scaled(look->leaf, look->is_motley ? 1.22 : 1.4) },
		{ scaled(look->flower, 0.82), scaled(look->flower, 1.04) } };
	uint8_t *first[] = { &g->foliage.leaf, &g->foliage.flower };
	g->bark = gen_material(g->mesh, "bark", look->bark, NULL);
	organ[g->bark] = ECO_ORGAN_WOOD;
	for (uint32_t k = 0; k < 2; k++) {
		*first[k] = gen_material_shades(g->mesh, names[k], colors[k][0], colors[k][1], GEN_SHADES);
		g->foliage.cards[k] = gen_material(g->mesh, names[k], 0xffffff, names[k]);
		memset(organ + *first[k], k ? ECO_ORGAN_FLOWER : ECO_ORGAN_FOLIAGE, GEN_SHADES + 1);
		sprays[k] = g->foliage.spray;
		set_cells(&sprays[k], look, k ? colors[k][0] : scaled(look->leaf, 0.72), k ? colors[k][1] : scaled(look->leaf, 1.22));
	}
	if (look->flowers == 0)
		sprays[1].leaves = 0;
}

bool eco_library_habit(size_t i, struct eco_habit *habit)
{
	if (i >= COUNT(habits_rows))
		return false;
	const struct habits_row *h = &habits_rows[i];
	unsigned form = ECO_FORM_COUNT - 1;
	while (form > 0 && strcmp(eco_form_names[form], h->like) != 0)
		form--;
	*habit = (struct eco_habit){ .name = h->habit,
		.like = (enum eco_form)form,
		.height_m = h->height_m,
		.least_m = h->least_m,
		.most_m = h->most_m,
		.young_m = h->young_m,
		.crown = h->crown,
		.widest_m = h->widest_m,
		.grown = strcmp(h->grown, "-") != 0 ? h->grown : NULL };
	return true;
}

/* Crowns narrower than usual have thinner stems, and lost lower boughs to the shade of neighbours: the base rises by the share
 * `clear` of what the crown lacks in width, or to where it was measured; what is above moves along. */
static struct habits_row raised(const struct habits_row *row, const struct eco_library_plant *plant)
{
	struct habits_row h = *row;
	double wide = plant->crown_m / fmin(h.young_m + h.crown * plant->height_m, h.widest_m), left;
	h.trunk *= sqrt(gen_clamp(wide, 0.3, 1.5));
	h.base = plant->base > 0 ? plant->base : h.base + (1 - h.base) * h.clear * fmax(1 - wide, 0);
	left = (1 - h.base) / (1 - row->base);
	h.foot = fmax(1 - left * (1 - h.foot), fmin(h.foot, 0.02));
	h.leader = 1 - left * (1 - h.leader);
	return h;
}

void gen_habit_grow(struct gen_mesh *mesh, uint8_t organ[GEN_MATERIALS_MAX], struct gen_spray sprays[2], size_t i,
	const struct eco_library_plant *plant, const struct gen_plant_look *look, uint64_t seed)
{
	static const char *const arrangements[] = { "around", "ranks", "tuft", "fan", "ribbon", NULL };
	static const char *const plans[] = { "round", "box", "wall", "rows", NULL };
	const struct habits_row raised_row = raised(&habits_rows[i], plant), *h = &raised_row;
	struct gen_random random = { seed };
	struct grower g = { .h = h,
		.mesh = mesh,
		.random = &random,
		.height = plant->height_m,
		.half = 0.5 * plant->crown_m,
		.plan = (enum plan)one_of(h->plan, plans),
		.noise = seed };
	double crown_m = g.height * (1 - fmax(h->base, h->foot >= 0.7 ? 0.5 : 0));
	/* half by the crown from above, half from the side; of a crown as wide as it is high both are alike */
	double area = 3.1416 * g.half * (0.5 * g.half * (g.plan == PLAN_WALL ? WALL_DEPTH : 1) + 0.25 * crown_m);
	g.foliage = (struct gen_foliage){ .mesh = mesh,
		.random = &random,
		.lowest = 0.004 * g.height,
		.arrangement = (enum gen_arrangement)one_of(h->leaf, arrangements) };
	g.lowest = g.height * (h->hang > 0 ? 0.05 : fmax(0.85 * fmin(h->base, h->foot), 0.012));
	gen_foliage_plan(&g.foliage, look, area * h->lai, LEAF_MOST * fmin(plant->height_m, plant->crown_m),
		h->part * g.half, h->slim);
	make_materials(&g, organ, sprays, look);
	count_branches(&g);
	for (uint32_t k = 0; k < (uint32_t)h->stems; k++)
		grow_stem(&g, k, (uint32_t)h->stems);
	fit_with_leaves(&g, 0.5 * plant->crown_m, plant->height_m);
	free(g.bearers);
}
