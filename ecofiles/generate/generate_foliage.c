/* Leaves of library plants, at their true size: a few triangles for each where the plant has few, else cards, each of a
 * spray of leaves that a texture shows. */
#include "ecofiles/generate/generate_growth.h"

#include <math.h>
#include <string.h>

#include "build/words/leaves.table"

#define COUNT(table) (sizeof(table) / sizeof *(table))
#define TRIANGLES_MAX 16000.0 /* of the leaves of a plant with LARGE_M2 of them or more, */
#define LARGE_M2 200.0
#define TRIANGLES_SMALL 0.45 /* and a share of these for a small one */
#define SPRAY_LEAST 5.0      /* leaves */
#define SPRAY_MOST 225.0
#define CARDS 5000.0
#define CARDS_MAX 10000.0   /* a larger crown is thinner */
#define SHADE_SPREAD 0.25
#define GOLDEN_DEG 137.50776405

static const struct leaves_row *row_of(const char *shape)
{
	size_t i = 0;
	while (i + 1 < COUNT(leaves_rows) && strcmp(leaves_rows[i].shape, shape) != 0)
		i++;
	return &leaves_rows[i];
}

/* Area and triangles of an outline of length and width 1. */
static const struct outline {
	const char *name;
	enum gen_leaf_shape shape;
	double area, triangles;
} outlines[] = { { "rhomb", GEN_LEAF_RHOMB, 0.5, 2 }, { "blade", GEN_LEAF_BLADE, 0.68, 3 }, { "card", GEN_LEAF_CARD, 1, 1e9 } };

/* Cards of as many leaves as the plant's triangles ask for. */
static void plan_sprays(struct gen_foliage *f, const struct leaves_row *row, double area, double cards)
{
	struct gen_spray *s = &f->spray;
	*s = (struct gen_spray){ .slim = f->width / f->length,
		.strip = row->strip,
		.teeth = row->teeth,
		.lobes = row->lobes,
		.skew = row->skew };
	/* area of a leaf as it is painted */
	double one = f->length * f->width * (0.69 + 0.14 * s->strip) * (1 - 0.5 * s->teeth);
	gen_spray_layout(s, (uint32_t)gen_clamp(area / one / cards + 1, SPRAY_LEAST, SPRAY_MOST), f->pieces);
	f->pieces = 1;
	f->outline = GEN_LEAF_CARD;
	f->count = (uint32_t)fmin(area / (one * s->twigs * s->leaves), CARDS_MAX);
	f->angle_deg *= 0.75;
	f->width = f->length * s->width;
	f->length *= s->height;
}

void gen_foliage_plan(struct gen_foliage *f, const struct gen_plant_look *look, double area, double most_m,
	double part_m, double slim)
{
	const struct leaves_row *row = row_of(look->shape);
	const struct outline *outline = outlines;
	while (strcmp(outline->name, row->outline) != 0)
		outline++;
	f->outline = outline->shape;
	f->pieces = part_m > 0 ? 1 : (uint32_t)row->pieces;
	f->length = fmax(look->leaf_cm * row->times, row->least_cm) / 100;
	f->length = part_m > 0 ? part_m : fmin(f->length, most_m * (f->pieces > 1 ? row->times : 1));
	f->width = f->length * (slim > 0 ? slim : look->slim > 0 ? look->slim : row->slim);
	f->angle_deg = row->angle_deg;
	f->droop = row->droop;
	f->flowers = look->flowers;
	f->is_bare = look->is_bare;
	double share = gen_clamp(sqrt(area / LARGE_M2), TRIANGLES_SMALL, 1),
	       wanted = area / (f->pieces * outline->area * f->length * f->width);
	f->count = (uint32_t)fmax(wanted, area > 0 ? 24 : 0);
	if (part_m <= 0 && f->arrangement != GEN_RIBBON && wanted * f->pieces * outline->triangles > share * TRIANGLES_MAX)
		plan_sprays(f, row, area, share * CARDS);
}

uint8_t gen_foliage_shade(const struct gen_foliage *f, double light)
{
	return (uint8_t)gen_random_shade(f->random, light, SHADE_SPREAD, GEN_SHADES);
}

static void place_piece(const struct gen_foliage *f, struct gen_v3 at, struct gen_v3 along,
	struct gen_v3 face, double light, bool flower)
{
	double size = gen_random_in(f->random, 0.82, 1.16);
	bool spray = f->spray.leaves > 0;
	if (spray)                                   /* turned anyhow, it stays above the ground */
		at.z = fmax(at.z, f->lowest + 0.5 * f->width);
	along = gen_unit(along);
	if (at.z + fmin(along.z, 0) * size * f->length < f->lowest)
		along.z = fabs(along.z) * 0.3;
	if (at.z < f->lowest || (f->is_bare && !flower))
		return;
	uint32_t shade = gen_random_shade(f->random, light, SHADE_SPREAD, spray ? GEN_CELLS : GEN_SHADES);
	gen_leaf(f->mesh, (uint8_t)(spray ? f->cards[flower] : (flower ? f->flower : f->leaf) + shade),
		&(struct gen_leaf){ .at = at,
			.cell = shade,
			.along = along,
			.face = face,
			.length = f->length * size * (flower ? 0.8 : 1),
			.width = f->width * size * (flower ? 0.9 : 1),
			.bend = 0.5 * f->droop,
			.shape = f->outline });
}

/* Leaflets in two rows on a midrib that is not drawn, and one at its end. */
static void place_leaf(const struct gen_foliage *f, struct gen_v3 at, struct gen_v3 along, struct gen_v3 face,
	double light, bool flower)
{
	if (f->pieces <= 1) {
		place_piece(f, at, along, face, light, flower);
		return;
	}
	struct gen_v3 way = gen_unit(along), side = gen_unit(gen_cross(way, face));
	double rachis = f->length * 0.36 * f->pieces;
	for (uint32_t i = 0; i < f->pieces; i++) {
		bool end = i + 1 == f->pieces;
		double t = end ? 1 : 0.3 + 0.6 * (i / 2) / (f->pieces / 2);
		struct gen_v3 out = end ? way : gen_mad(gen_mul(side, i % 2 ? 1 : -1), way, 0.45);
		out.z -= 0.25;
		place_piece(f,
			gen_mad(gen_mad(at, way, t * rachis), gen_v3(0, 0, 1), -0.3 * f->droop * t * rachis),
			out, face, light, flower);
	}
}

struct gen_v3 gen_way_off(struct gen_v3 way, double degrees, double turn_deg)
{
	struct gen_v3 side = gen_turned(gen_across(way), way, turn_deg);
	return gen_turned(way, gen_unit(gen_cross(way, side)), degrees);
}

static void place_on(const struct gen_foliage *f, const struct gen_bearer *b, double share, uint32_t number)
{
	struct gen_v3 way = gen_unit(b->along), at = gen_mad(b->from, b->along, share), along, face;
	struct gen_v3 up =
		gen_mad(gen_v3(0, 0, 1), gen_random_way(f->random), f->arrangement == GEN_RANKS ? 0.2 : 0.7);
	if (f->arrangement == GEN_RANKS) {
		struct gen_v3 side = gen_across(way);
		double s = number % 2 ? 1 : -1;
		along = gen_mad(gen_mul(side, s), way, f->angle_deg > 45 ? 0.6 : 1.1);
		along.z += gen_random_in(f->random, -0.12, 0.2) - f->droop;
		face = up;
	} else if (f->arrangement == GEN_TUFT) {
		at = gen_mad(b->from, b->along, 1 - 0.4 * share * share);
		along = gen_mad(gen_mad(way, gen_random_way(f->random), 0.85), gen_v3(0, 0, 1), 0.15);
		face = gen_random_way(f->random);
	} else {
		along = gen_way_off(way, f->angle_deg, GOLDEN_DEG * number + gen_random_in(f->random, -30, 30));
		along.z -= f->droop;
		face = gen_mad(up, gen_v3(at.x, at.y, 0), 0.5 / (1e-3 + gen_length(gen_v3(at.x, at.y, 0))));
	}
	double end = 1 - f->flowers * gen_random_in(f->random, 0.5, 1.5); /* heads and panicles end their branches */
	place_leaf(f, at, along, face, b->light, b->start + share * b->part > end);
}

/* Leaflets around the end of a stalk, in one plane that nods a little. */
static void place_fan(const struct gen_foliage *f, const struct gen_bearer *b, uint32_t count)
{
	struct gen_v3 way = gen_unit(b->along), side = gen_across(way), normal = gen_cross(side, way),
		      at = gen_add(b->from, b->along);
	for (uint32_t i = 0; i < count; i++) {
		double turn = -135 + 270.0 * (i + 0.5) / count;
		struct gen_v3 along = gen_turned(way, normal, turn);
		along.z -= 0.12 + 0.1 * fabs(turn) / 135;
		place_piece(f, at, along, normal, b->light, false);
	}
}

void gen_foliage_place(const struct gen_foliage *f, const struct gen_bearer *bearers, uint32_t count)
{
	double sum = 0, next, at = 0;
	uint32_t number = 0, tips = 0;
	for (uint32_t i = 0; i < count; i++) {
		sum += gen_length(bearers[i].along);
		tips += bearers[i].is_tip;
	}
	if (f->arrangement == GEN_FAN) {
		for (uint32_t i = 0; i < count && f->count > 0; i++)
			if (bearers[i].is_tip)
				place_fan(f, &bearers[i], f->count / tips > 8 ? f->count / tips : 8);
		return;
	}
	if (f->count == 0 || (f->is_bare && f->flowers == 0) || f->arrangement == GEN_RIBBON || !(sum > 0))
		return;
	double step = sum / f->count;
	next = 0.5 * step;
	for (uint32_t i = 0; i < count; i++) {
		double length = gen_length(bearers[i].along);
		for (; next < at + length; next += step)
			place_on(f, &bearers[i], (next - at) / length, number++);
		at += length;
	}
}
