/* The kinds of plants: sizes, colours and habits. Leaves are darker inside a crown and brighter near the
 * sky, as shade leaves are; this gives a crown depth without lighting. Cards take these shades from the
 * quarters of a texture, other leaves from materials. */
#include "ecofiles/generate/generate_plants.h"

#include <math.h>
#include <string.h>

#define SHOOTS_MAX 400

static uint32_t shade_of(double light, uint32_t shades, struct gen_random *random)
{
	return gen_random_shade(random, light, 0.22, shades);
}

static double detail_of(const struct gen_mesh *mesh) { return mesh->detail > 0 ? mesh->detail : 1; }

/* ---- Broad-leaved trees ---- */

struct foliage {
	uint32_t shades, twigs, leaves;          /* per shoot; per twig */
	double twig_m, leaf_m, width_m, spread;  /* spread: how far twigs fan out */
	enum gen_leaf_shape shape;
};

/* A kind of broad-leaved trees. Leaves are shades from dark to bright; cards have the texture's colours. */
struct broad { struct gen_crown crown; struct foliage foliage; uint32_t bark, dark, bright; };

static void grow_twig(struct gen_mesh *mesh, const struct foliage *f, uint8_t bark, uint8_t leaf,
	const struct gen_shoot *shoot, struct gen_random *random)
{
	struct gen_v3 way = gen_unit(gen_add(gen_mad(shoot->along, gen_random_way(random), f->spread),
		gen_v3(0, 0, 0.15)));
	double length = f->twig_m * gen_random_in(random, 0.7, 1.2);
	struct gen_v3 points[2] = { shoot->at, gen_mad(shoot->at, way, length) };
	double radius[2] = { 0.006, 0 };
	gen_tube(mesh, bark, &(struct gen_tube){ points, radius, 2, 3 });
	struct gen_v3 across = gen_across(way);
	for (uint32_t i = 0; i < f->leaves; i++) {
		double t = (i + 1.0) / f->leaves;
		struct gen_v3 side = gen_turned(across, way, 137.5 * i + gen_random_in(random, -30, 30));
		struct gen_v3 along = i + 1 == f->leaves ? way : gen_add(side, gen_mul(way, 0.7));
		along.z -= 0.25;
		struct gen_v3 face = gen_add(gen_mad(gen_v3(0, 0, 1), shoot->along, 0.7),
			gen_mul(gen_random_way(random), 0.6));
		double size = gen_random_in(random, 0.8, 1.15);
		uint32_t shade = shade_of(shoot->light, f->shades, random);
		gen_leaf(mesh, (uint8_t)(leaf + (f->shape == GEN_LEAF_CARD ? 0 : shade)),
			&(struct gen_leaf){ .cell = shade, .at = gen_mad(shoot->at, way, length * t),
			.along = along, .face = face, .length = f->leaf_m * size, .width = f->width_m * size,
			.bend = 0.18, .shape = f->shape });
	}
}

static void grow_broad(struct gen_mesh *mesh, const void *kind, struct gen_random *random)
{
	const struct broad *tree = kind;
	struct gen_shoot shoots[SHOOTS_MAX];
	struct foliage fine = tree->foliage;
	double detail = detail_of(mesh);
	uint8_t bark = gen_material(mesh, "bark", tree->bark, NULL);
	uint8_t leaf = fine.shape == GEN_LEAF_CARD ? gen_material(mesh, "leaf", 0xffffff, "spray.png")
		: gen_material_shades(mesh, "leaf", tree->dark, tree->bright, fine.shades);
	fine.twigs = (uint32_t)(fine.twigs * detail + 0.5);
	fine.twigs += fine.twigs == 0;
	fine.leaf_m /= sqrt(detail);
	fine.width_m /= sqrt(detail);
	gen_tree(mesh, bark, &tree->crown, random, shoots);
	for (uint32_t i = 0; i < tree->crown.shoots; i++)
		for (uint32_t k = 0; k < fine.twigs; k++)
			grow_twig(mesh, &fine, bark, leaf, &shoots[i], random);
}

static const struct broad oak = {
	{ .height = 14, .base = 3.0, .radius = 6.2, .trunk_radius = 0.38, .lean = 0.5, .lobes = 17,
		.shoots = 260 },
	{ .shades = 6, .twigs = 5, .leaves = 5, .twig_m = 0.75, .leaf_m = 0.38, .width_m = 0.27,
		.spread = 0.9, .shape = GEN_LEAF_HEXAGON },
	.bark = 0x584838, .dark = 0x223a16, .bright = 0x749436 };

static const struct broad birch = {
	{ .height = 13, .base = 2.8, .radius = 2.7, .trunk_radius = 0.14, .lean = 0.6, .lobes = 11,
		.shoots = 170, .cone = 0.45 },
	{ .shades = 5, .twigs = 5, .leaves = 6, .twig_m = 0.8, .leaf_m = 0.21, .width_m = 0.17,
		.spread = 0.8, .shape = GEN_LEAF_RHOMB },
	.bark = 0xcdcac0, .dark = 0x425a1e, .bright = 0xa4b64c };

static const struct broad linden = {
	{ .height = 12, .base = 2.6, .radius = 3.9, .trunk_radius = 0.22, .lean = 0.25, .lobes = 13,
		.shoots = 190, .cone = 0.3 },
	{ .shades = 4, .twigs = 4, .leaves = 3, .twig_m = 0.55, .leaf_m = 0.62, .width_m = 0.52,
		.spread = 0.9, .shape = GEN_LEAF_CARD }, .bark = 0x605446 };

/* A beech grown in a stand: a long stem, and a narrow crown above its neighbours' shade. */
static const struct broad beech = {
	{ .height = 22, .base = 8.5, .radius = 3.6, .trunk_radius = 0.24, .lean = 0.8, .lobes = 13,
		.shoots = 200, .cone = 0.2 },
	{ .shades = 6, .twigs = 5, .leaves = 5, .twig_m = 0.8, .leaf_m = 0.36, .width_m = 0.24,
		.spread = 0.9, .shape = GEN_LEAF_HEXAGON },
	.bark = 0x807c72, .dark = 0x244018, .bright = 0x7ca03a };

static const struct broad maple = {
	{ .height = 20, .base = 7, .radius = 3.2, .trunk_radius = 0.2, .lean = 0.6, .lobes = 12,
		.shoots = 170, .cone = 0.35 },
	{ .shades = 4, .twigs = 4, .leaves = 3, .twig_m = 0.6, .leaf_m = 0.66, .width_m = 0.55,
		.spread = 0.9, .shape = GEN_LEAF_CARD }, .bark = 0x685e50 };

/* ---- Trees of cards, as games and cities have them ---- */

struct cards {
	double height, base, radius, trunk_radius, card_m;
	uint32_t boughs, cards;                  /* cards: per bough */
	uint32_t bark;
};

/* Two cards cross at the end of a bough, and the others stand anyhow along its outer half. */
static void grow_card_bough(struct gen_mesh *mesh, const struct cards *tree, const struct gen_v3 points[2],
	double light, struct gen_random *random)
{
	double detail = detail_of(mesh);
	struct gen_v3 along = gen_sub(points[1], points[0]), way = gen_unit(along),
		side = gen_turned(gen_across(way), way, gen_random_in(random, 0, 360));
	gen_tube(mesh, 0, &(struct gen_tube){ points, (double[]){ 0.05, 0 }, 2, 3 });
	for (uint32_t k = 0; k < 2 || k < tree->cards * detail; k++) {
		double size = tree->card_m * gen_random_in(random, 0.8, 1.2) / sqrt(detail);
		struct gen_v3 out = k < 2 ? way : gen_unit(gen_add(way, gen_random_way(random))),
			foot = gen_mad(points[0], along, k < 2 ? 1 : gen_random_in(random, 0.5, 1));
		gen_leaf(mesh, 1, &(struct gen_leaf){ .at = gen_mad(foot, out, -0.4 * size), .along = out,
			.face = k < 2 ? gen_turned(side, way, 90 * k) : gen_random_way(random),
			.length = size, .width = size, .cell = shade_of(light, 4, random),
			.shape = GEN_LEAF_CARD });
	}
}

/* Boughs around a trunk, longest in the middle of the crown, rising towards its top. */
static void grow_cards(struct gen_mesh *mesh, const void *kind, struct gen_random *random)
{
	const struct cards *tree = kind;
	struct gen_v3 top = gen_mad(gen_v3(0, 0, 0.9 * tree->height), gen_random_way(random), 0.3);
	gen_material(mesh, "bark", tree->bark, NULL);
	gen_material(mesh, "leaf", 0xffffff, "branch.png");
	gen_tube(mesh, 0, &(struct gen_tube){ (struct gen_v3[]){ gen_v3(0, 0, 0), gen_mul(top, 0.4), top },
		(double[]){ tree->trunk_radius, 0.7 * tree->trunk_radius, 0 }, 3, 6 });
	for (uint32_t i = 0; i < tree->boughs; i++) {
		double t = (i + gen_random_unit(random)) / tree->boughs, low = tree->base / tree->height,
			reach = tree->radius * 2 * sqrt((0.06 + t) * (1.06 - t))
			* gen_random_in(random, 0.6, 0.95);
		struct gen_v3 foot = gen_mul(top, low + (0.98 - low) * t);
		struct gen_v3 points[2] = { foot, gen_mad(foot, gen_heading(137.5 * i, 5 + 55 * t), reach) };
		grow_card_bough(mesh, tree, points, 0.25 + 0.6 * t, random);
	}
}

static const struct cards street_tree = { .height = 11, .base = 2.8, .radius = 2.9, .trunk_radius = 0.2,
	.card_m = 1.15, .boughs = 34, .cards = 8, .bark = 0x5e5244 };

/* ---- Conifers ---- */

struct whorls {
	double height, base, radius, trunk_radius;
	double droop_deg, rise_deg;              /* lowest and topmost branches */
	double gap_m, needle_m, needle_width;
	uint32_t branches;
	uint32_t bark, dark, bright;             /* colours: needles from dark to bright */
};
#define NEEDLE_SHADES 5

static void grow_bough(struct gen_mesh *mesh, const struct whorls *w, uint8_t bark, struct gen_v3 at,
	double azimuth, double elevation, double length, struct gen_random *random)
{
	struct gen_v3 points[5];
	double radius[5];
	points[0] = at;
	for (int i = 0; i < 5; i++) {
		double t = i / 4.0;
		if (i)
			points[i] = gen_mad(points[i - 1],
				gen_heading(azimuth, elevation - 14 * t + 26 * t * t), length / 4);
		radius[i] = i == 4 ? 0 : (0.006 + 0.007 * length) * (1 - t);
	}
	gen_tube(mesh, bark, &(struct gen_tube){ points, radius, 5, 3 });
	double detail = detail_of(mesh);
	uint32_t sprays = 2 * (uint32_t)(length / 0.16 * detail) + 3;
	for (uint32_t i = 0; i < sprays; i++) {
		double t = i + 1 == sprays ? 1 : 0.16 + 0.82 * (i / 2 * 2 + 1.0) / sprays;
		struct gen_v3 way, foot = gen_along(points, 5, 4 * t, &way);
		struct gen_v3 side = gen_unit(gen_cross(way, gen_v3(0, 0, 1)));
		struct gen_v3 out = i + 1 == sprays ? way
			: gen_add(gen_mul(side, i % 2 ? 1 : -1),
			gen_mul(way, gen_random_in(random, 0.5, 0.9)));
		out.z += gen_random_in(random, -0.35, 0.10);
		double size = w->needle_m * (1.15 - 0.55 * t) * gen_random_in(random, 0.8,
			1.2) * (0.4 + 0.6 * gen_clamp(length, 0, 1));
		gen_leaf(mesh, (uint8_t)(bark + 1 + shade_of(0.25 + 0.55 * t, NEEDLE_SHADES, random)),
			&(struct gen_leaf){ .at = foot, .along = out,
			.face = gen_add(gen_v3(0, 0, 1), gen_mul(gen_random_way(random), 0.5)),
			.length = size / sqrt(detail),
			.width = w->needle_width / sqrt(detail), .bend = 0.2, .shape = GEN_LEAF_RHOMB });
	}
}

static void grow_conifer(struct gen_mesh *mesh, const void *kind, struct gen_random *random)
{
	enum { RINGS = 12 };
	const struct whorls *w = kind;
	struct gen_v3 points[RINGS];
	double radius[RINGS], z = w->base;
	uint8_t bark = gen_material(mesh, "bark", w->bark, NULL);
	gen_material_shades(mesh, "needles", w->dark, w->bright, NEEDLE_SHADES);   /* they follow the bark */
	for (int i = 0; i < RINGS; i++) {
		double t = i / (RINGS - 1.0);
		points[i] = gen_v3(gen_random_in(random, -0.01, 0.01) * (i > 0),
			gen_random_in(random, -0.01, 0.01) * (i > 0), t * w->height);
		radius[i] = i + 1 == RINGS ? 0 : w->trunk_radius * (1 - t) * (i ? 1 : 1.4);
	}
	gen_tube(mesh, bark, &(struct gen_tube){ points, radius, RINGS, 8 });
	for (uint32_t ring = 0; z < w->height - 0.12; ring++) {
		double t = (z - w->base) / (w->height - w->base), left = 1 - t;
		uint32_t n = (uint32_t)(w->branches * (0.55 + 0.45 * left) + gen_random_unit(random));
		for (uint32_t i = 0; i < n; i++) {
			double length = w->radius * (0.10 + 0.90 * left) * gen_smooth(-0.18, 0.14,
				t) * gen_random_in(random, 0.78, 1.06);
			double azimuth = 137.5 * ring + 360.0 * i / n + gen_random_in(random, -12, 12);
			grow_bough(mesh, w, bark, gen_v3(0, 0, z + gen_random_in(random, -0.06, 0.06)),
				azimuth, w->droop_deg + (w->rise_deg - w->droop_deg) * t * t
				+ gen_random_in(random, -5, 5), length, random);
		}
		z += w->gap_m * (0.70 + 0.50 * left);
	}
}

static const struct whorls spruce = { .height = 16, .base = 0.9, .radius = 3.7, .trunk_radius = 0.22,
	.droop_deg = -14, .rise_deg = 48, .gap_m = 0.5, .needle_m = 0.74, .needle_width = 0.12, .branches = 7,
	.bark = 0x544234, .dark = 0x142c1e, .bright = 0x486842 };

static const struct whorls pine = { .height = 17, .base = 8.2, .radius = 3.6, .trunk_radius = 0.24,
	.droop_deg = 4, .rise_deg = 52, .gap_m = 0.5, .needle_m = 0.72, .needle_width = 0.16, .branches = 6,
	.bark = 0x885a3c, .dark = 0x263c28, .bright = 0x668054 };

/* ---- Palms, ferns ---- */

static void palm(struct gen_mesh *mesh, const void *kind, struct gen_random *random)
{
	(void)kind;
	enum { RINGS = 22 };
	uint8_t bark = gen_material(mesh, "bark", 0x7c6850, NULL),
		rib = gen_material(mesh, "rib", 0x969654, NULL);
	uint8_t leaf = gen_material_shades(mesh, "leaflet", 0x28461e, 0x8aa646, 5);
	uint8_t dry = gen_material_shades(mesh, "dry", 0x78623a, 0x9e8854, 2);
	struct gen_v3 points[RINGS], lean = gen_heading(gen_random_in(random, 0, 360), 0);
	double radius[RINGS], height = 7.2;
	for (int i = 0; i < RINGS; i++) {
		double t = i / (RINGS - 1.0);
		points[i] = gen_mad(gen_v3(0, 0, t * height), lean, 0.9 * t * t);
		radius[i] = 0.15 * (1 - 0.35 * t) * (i % 2 ? 1.08 : 0.95)
			+ 0.10 * (1 - gen_smooth(0, 0.1, t));
	}
	gen_tube(mesh, bark, &(struct gen_tube){ points, radius, RINGS, 9 });
	for (uint32_t i = 0; i < 26; i++) {
		double age = i / 25.0;
		bool old = i >= 23;
		gen_frond(mesh,
			&(struct gen_frond){ .at = gen_mad(points[RINGS - 1], gen_v3(0, 0, 1),
			0.1 - 0.25 * age), .azimuth_deg = 137.5 * i,
			.elevation_deg = old ? -35 : 78 - 82 * age, .sink_deg = old ? 50 : 70 + 20 * age,
			.length = gen_random_in(random, 2.5, 3.1),
			.leaflet = 0.72, .width = 0.062 / detail_of(mesh),
			.pairs = (uint32_t)(34 * detail_of(mesh) + 0.5), .rib = rib,
			.leaf = old ? dry : leaf, .shades = old ? 2 : 5,
			.rib_radius = 0.024, .shape = GEN_LEAF_BLADE }, random);
	}
}

static void fern(struct gen_mesh *mesh, const void *kind, struct gen_random *random)
{
	(void)kind;
	uint8_t rib = gen_material(mesh, "rib", 0x605c2e, NULL);
	uint8_t leaf = gen_material_shades(mesh, "leaflet", 0x2c4a1c, 0x7ea23e, 4);
	for (uint32_t i = 0; i < 11; i++)
		gen_frond(mesh,
			&(struct gen_frond){ .azimuth_deg = 137.5 * i,
			.elevation_deg = gen_random_in(random, 52, 74),
			.sink_deg = gen_random_in(random, 70, 100), .length = gen_random_in(random, 0.6, 0.9),
			.leaflet = 0.17, .width = 0.045,
			.pairs = 15, .rib = rib, .leaf = leaf, .shades = 4, .rib_radius = 0.005,
			.shape = GEN_LEAF_RHOMB }, random);
}

/* ---- Shrubs ---- */

struct bush {
	double height, radius;
	uint32_t stems, leaves;                  /* leaves per stem */
	double leaf_m, width_m;
	uint8_t bark, leaf, flower;
	uint32_t shades, flower_shades;          /* 0: none */
	enum gen_leaf_shape shape;
};

static void grow_blossom(struct gen_mesh *mesh, const struct bush *b, struct gen_v3 at, struct gen_v3 out,
	struct gen_random *random)
{
	for (uint32_t i = 0; i < 7; i++) {
		struct gen_v3 way = gen_unit(gen_add(gen_mul(out, 0.9), gen_random_way(random)));
		gen_leaf(mesh, (uint8_t)(b->flower + shade_of(0.5, b->flower_shades, random)),
			&(struct gen_leaf){ .at = at, .along = way,
			.face = gen_add(out, gen_random_way(random)), .length = 0.10, .width = 0.08,
			.shape = GEN_LEAF_RHOMB });
	}
}

static void grow_stem(struct gen_mesh *mesh, const struct bush *b, uint32_t stem, struct gen_random *random)
{
	struct gen_v3 points[6],
		foot = gen_mul(gen_heading(137.5 * stem, 0), 0.12 * b->radius * gen_random_unit(random));
	double radius[6], reach = sqrt((stem + 0.5) / b->stems),
		azimuth = 137.5 * stem + gen_random_in(random, -20, 20);
	double length = b->height * gen_random_in(random, 0.85, 1.08) * (1 - 0.18 * reach);
	points[0] = foot;
	for (int i = 0; i < 6; i++) {
		double t = i / 5.0, elevation = 86 - reach * (30 + 34 * t) + gen_random_in(random, -7, 7);
		if (i)
			points[i] = gen_mad(points[i - 1], gen_heading(azimuth, elevation), length / 5);
		radius[i] = i == 5 ? 0 : 0.014 * b->height / 2 * (1 - t) + 0.003;
	}
	gen_tube(mesh, b->bark, &(struct gen_tube){ points, radius, 6, 3 });
	for (uint32_t i = 0; i < b->leaves; i++) {
		double t = 0.18 + 0.82 * sqrt((i + gen_random_unit(random)) / b->leaves);
		struct gen_v3 way, at = gen_along(points, 6, t * 4.999, &way), out = gen_random_way(random),
			spot = gen_add(at, gen_mul(out, 0.13 * b->radius));
		double light = 0.15 + 0.5 * spot.z / b->height + 0.35 * gen_length(gen_v3(spot.x, spot.y, 0))
			/ b->radius;
		uint32_t shade = shade_of(light, b->shades, random);
		gen_leaf(mesh, (uint8_t)(b->leaf + (b->shape == GEN_LEAF_CARD ? 0 : shade)),
			&(struct gen_leaf){ .cell = shade, .at = spot,
			.along = gen_add(gen_mad(out, way, 0.5), gen_v3(0, 0, -0.1)),
			.face = gen_add(gen_v3(0, 0, 1), gen_mul(gen_random_way(random), 0.8)),
			.length = b->leaf_m * gen_random_in(random, 0.75, 1.15), .width = b->width_m,
			.bend = 0.15, .shape = b->shape });
	}
	if (b->flower_shades && stem % 3)
		grow_blossom(mesh, b, points[5], gen_unit(gen_sub(points[5], gen_v3(0, 0, 0.4 * b->height))),
			random);
}

static void grow_bush(struct gen_mesh *mesh, const struct bush *b, struct gen_random *random)
{
	for (uint32_t i = 0; i < b->stems; i++)
		grow_stem(mesh, b, i, random);
}

static void shrub(struct gen_mesh *mesh, const void *kind, struct gen_random *random)
{
	(void)kind;
	uint8_t bark = gen_material(mesh, "bark", 0x5c4a38, NULL);
	uint8_t leaf = gen_material(mesh, "leaf", 0xffffff, "leaf.png");
	grow_bush(mesh, &(struct bush){ .height = 2.1, .radius = 1.1, .stems = 34, .leaves = 40,
		.leaf_m = 0.15, .width_m = 0.1,
		.bark = bark, .leaf = leaf, .shades = 4, .shape = GEN_LEAF_CARD }, random);
}

static void azalea(struct gen_mesh *mesh, const void *kind, struct gen_random *random)
{
	(void)kind;
	uint8_t bark = gen_material(mesh, "bark", 0x584234, NULL);
	uint8_t leaf = gen_material_shades(mesh, "leaf", 0x1a341e, 0x50743c, 4);
	uint8_t flower = gen_material_shades(mesh, "flower", 0xc43a78, 0xf296be, 3);
	grow_bush(mesh, &(struct bush){ .height = 1.4, .radius = 1.0, .stems = 48, .leaves = 26,
		.leaf_m = 0.11, .width_m = 0.045, .bark = bark, .leaf = leaf, .shades = 4, .flower = flower,
		.flower_shades = 3, .shape = GEN_LEAF_HEXAGON }, random);
}

/* ---- Grass and flowers ---- */

struct blades { uint32_t dark, bright, count; double height, spread, width; };

static void grow_blades(struct gen_mesh *mesh, const void *kind, struct gen_random *random)
{
	enum { SHADES = 5 };
	const struct blades *b = kind;
	uint8_t leaf = gen_material_shades(mesh, "blade", b->dark, b->bright, SHADES);
	for (uint32_t i = 0; i < b->count; i++) {
		double r = sqrt(gen_random_unit(random)), azimuth = 137.5 * i;
		struct gen_v3 out = gen_heading(azimuth + gen_random_in(random, -40, 40), 0);
		gen_leaf(mesh, (uint8_t)(leaf + shade_of(gen_random_unit(random), SHADES, random)),
			&(struct gen_leaf){ .at = gen_mul(gen_heading(azimuth, 0), b->spread * r),
			.along = gen_add(gen_v3(0, 0, 1),
			gen_mul(out, 0.10 + 0.45 * r * gen_random_unit(random))),
			.face = gen_mul(out, -1), .length = b->height * gen_random_in(random, 0.55, 1.05),
			.width = b->width, .bend = gen_random_in(random, 0.1, 0.55),
			.shape = GEN_LEAF_BLADE });
	}
}

static const struct blades grass = { 0x4a6824, 0xb0ba5c, 110, 0.62, 0.22, 0.011 };
static const struct blades turf = { 0x3e6220, 0x8ca846, 220, 0.26, 0.75, 0.010 };

/* Several stems, each with a head of petals around a button. */
struct flower { uint32_t dark, bright, button, petals; double petal_m, petal_width, cup; };

static void grow_flower(struct gen_mesh *mesh, const void *kind, struct gen_random *random)
{
	enum { SHADES = 3 };
	const struct flower *f = kind;
	uint8_t petal = gen_material_shades(mesh, "petal", f->dark, f->bright, SHADES);
	uint8_t button = gen_material(mesh, "button", f->button, NULL);
	uint8_t stem = gen_material(mesh, "stem", 0x5c7c38, NULL);
	uint8_t leaf = gen_material_shades(mesh, "leaf", 0x3a5c28, 0x709242, 3);
	for (uint32_t i = 0; i < 9; i++) {
		double azimuth = 137.5 * i, r = sqrt((i + 0.5) / 9),
			height = gen_random_in(random, 0.34, 0.56);
		struct gen_v3 foot = gen_mul(gen_heading(azimuth, 0), 0.16 * r),
			out = gen_heading(azimuth, 0), points[4];
		double radius[4] = { 0.004, 0.0035, 0.003, 0.0025 };
		for (int k = 0; k < 4; k++)
			points[k] = gen_mad(gen_mad(foot, gen_v3(0, 0, 1), height * k / 3), out,
				0.10 * r * (k / 3.0) * (k / 3.0));
		gen_tube(mesh, stem, &(struct gen_tube){ points, radius, 4, 3 });
		for (uint32_t k = 0; k < 4; k++)
			gen_leaf(mesh, (uint8_t)(leaf + k % 3),
				&(struct gen_leaf){ .at = gen_mad(points[0], gen_sub(points[1], points[0]),
				0.2 + 0.35 * k),
				.along = gen_add(gen_heading(azimuth + 137.5 * k, 0), gen_v3(0, 0, 0.9)),
				.face = gen_mul(gen_heading(azimuth + 137.5 * k, 0), -1),
				.length = 0.17 - 0.02 * k, .width = 0.026, .bend = 0.3,
				.shape = GEN_LEAF_HEXAGON });
		struct gen_v3 up = gen_unit(gen_add(gen_v3(0, 0, 1),
			gen_add(gen_mul(out, 0.4 * r), gen_mul(gen_random_way(random), 0.25))));
		struct gen_v3 across = gen_across(up), head = points[3];
		for (uint32_t k = 0; k < f->petals; k++) {
			struct gen_v3 way = gen_turned(across, up, 360.0 * k / f->petals);
			gen_leaf(mesh, (uint8_t)(petal + shade_of(0.5, SHADES, random)),
				&(struct gen_leaf){ .at = gen_mad(head, way, 0.008),
				.along = gen_add(way, gen_mul(up, f->cup)),
				.face = gen_sub(up, gen_mul(way, f->cup)),
				.length = f->petal_m * gen_random_in(random, 0.9, 1.1),
				.width = f->petal_width, .bend = 0.1, .shape = GEN_LEAF_HEXAGON });
		}
		struct gen_v3 cone[3] = { gen_mad(head, up, -0.006), gen_mad(head, up, 0.006),
			gen_mad(head, up, 0.014) };
		double cone_radius[3] = { 0.010, 0.013, 0 };
		gen_tube(mesh, button, &(struct gen_tube){ cone, cone_radius, 3, 6 });
	}
}

static const struct flower daisy = { 0xd6d4ce, 0xfaf9f4, 0xe8b826, 14, 0.046, 0.014, 0.12 };
static const struct flower poppy = { 0xac1612, 0xe23c22, 0x2c2824, 5, 0.062, 0.066, 0.55 };
static const struct flower cornflower = { 0x3442b2, 0x687ae2, 0x483078, 9, 0.040, 0.020, 0.45 };

/* A head on a tall stalk: rays around a disc of florets in a spiral, as in nature. */
static void grow_head(struct gen_mesh *mesh, uint8_t ray, uint8_t floret, struct gen_v3 at,
	struct gen_v3 face, struct gen_random *random)
{
	enum { RAYS = 34, FLORETS = 1240 };
	struct gen_v3 across = gen_across(face);
	const double disc = 0.085;
	for (uint32_t i = 0; i < RAYS; i++) {
		struct gen_v3 way = gen_turned(across, face, 360.0 * i / RAYS + gen_random_in(random, -4, 4));
		gen_leaf(mesh, (uint8_t)(ray + shade_of(0.55, 3, random)),
			&(struct gen_leaf){ .at = gen_mad(at, way, 0.92 * disc),
			.along = gen_mad(way, face, gen_random_in(random, 0.02, 0.3)), .face = face,
			.length = gen_random_in(random, 0.08, 0.105),
			.width = 0.028, .bend = 0.1, .shape = GEN_LEAF_HEXAGON });
	}
	for (uint32_t i = 0; i < FLORETS; i++) {
		double r = disc * sqrt((i + 0.5) / FLORETS);
		struct gen_v3 way = gen_turned(across, face, 137.50776405 * i), spot = gen_mad(at, way, r);
		gen_leaf(mesh, (uint8_t)(floret + (r > 0.6 * disc)),
			&(struct gen_leaf){ .at = gen_mad(spot, face, 0.012 * (1 - r / disc)),
			.along = gen_mad(face, way, 0.7), .face = gen_mad(way, face, -0.7), .length = 0.011,
			.width = 0.007, .bend = 0.1, .shape = GEN_LEAF_HEXAGON });
	}
}

static void sunflower(struct gen_mesh *mesh, const void *kind, struct gen_random *random)
{
	(void)kind;
	enum { RINGS = 7, LEAVES = 22 };
	uint8_t stem = gen_material(mesh, "stem", 0x607c3e, NULL);
	uint8_t leaf = gen_material_shades(mesh, "leaf", 0x2e5222, 0x749446, 4);
	uint8_t ray = gen_material_shades(mesh, "petal", 0xe29610, 0xfcce2c, 3);
	uint8_t floret = gen_material_shades(mesh, "floret", 0x3e2a1a, 0x845822, 2);
	double azimuth = gen_random_in(random, 0, 360), radius[RINGS];
	struct gen_v3 points[RINGS], south = gen_heading(azimuth, 0);
	for (int i = 0; i < RINGS; i++) {
		double t = i / (RINGS - 1.0);
		points[i] = gen_mad(gen_v3(0, 0, 1.72 * t - 0.06 * gen_smooth(0.85, 1, t)), south,
			0.16 * t * t * t);
		radius[i] = 0.016 * (1 - 0.5 * t);
	}
	gen_tube(mesh, stem, &(struct gen_tube){ points, radius, RINGS, 6 });
	for (uint32_t i = 0; i < LEAVES; i++) {
		double t = 0.12 + 0.78 * (i + 0.5) / LEAVES, size = 0.12 + 0.30 * t * (1.25 - t);
		struct gen_v3 way, out = gen_heading(137.5 * i + gen_random_in(random, -15, 15), 0);
		struct gen_v3 foot = gen_along(points, RINGS, t * (RINGS - 1), &way),
			tip = gen_mad(foot, out, 0.45 * size);
		gen_tube(mesh, stem,
			&(struct gen_tube){ (struct gen_v3[]){ foot, gen_mad(tip, gen_v3(0, 0, 1), 0.04) },
			(double[]){ 0.005, 0.003 }, 2, 3 });
		gen_leaf(mesh, (uint8_t)(leaf + shade_of(0.25 + 0.6 * t, 4, random)),
			&(struct gen_leaf){ .at = gen_mad(tip, gen_v3(0, 0, 1), 0.04),
			.along = gen_mad(out, gen_v3(0, 0, 1), gen_random_in(random, -0.5, 0.1)),
			.face = gen_mad(gen_v3(0, 0, 1), gen_random_way(random), 0.3),
			.length = size, .width = 0.75 * size, .bend = 0.3, .shape = GEN_LEAF_HEXAGON });
	}
	struct gen_v3 face = gen_unit(gen_add(gen_mul(south, 0.9), gen_v3(0, 0, 0.35)));
	grow_head(mesh, ray, floret, gen_mad(points[RINGS - 1], face, 0.02), face, random);
}

const struct gen_plant gen_plants[] = {
	{ "oak", NULL, grow_broad, &oak, false },
	{ "birch", NULL, grow_broad, &birch, false },
	{ "linden", "spray.png", grow_broad, &linden, false },
	{ "beech", NULL, grow_broad, &beech, false },
	{ "maple", "spray.png", grow_broad, &maple, false },
	{ "spruce", NULL, grow_conifer, &spruce, false },
	{ "pine", NULL, grow_conifer, &pine, false },
	{ "palm", NULL, palm, NULL, false },
	{ "fern", NULL, fern, NULL, false },
	{ "shrub", "leaf.png", shrub, NULL, false },
	{ "azalea", NULL, azalea, NULL, true },
	{ "grass", NULL, grow_blades, &grass, false },
	{ "turf", NULL, grow_blades, &turf, false },
	{ "daisy", NULL, grow_flower, &daisy, true },
	{ "poppy", NULL, grow_flower, &poppy, true },
	{ "cornflower", NULL, grow_flower, &cornflower, true },
	{ "sunflower", NULL, sunflower, NULL, true },
	{ "cards-1", "branch.png", grow_cards, &street_tree, false },
	{ "cards-2", "branch.png", grow_cards, &street_tree, false },
	{ "cards-3", "branch.png", grow_cards, &street_tree, false },
};
const uint32_t gen_plant_count = sizeof gen_plants / sizeof *gen_plants;

const struct gen_plant *gen_plant_find(const char *name)
{
	for (uint32_t i = 0; i < gen_plant_count; i++)
		if (!strcmp(gen_plants[i].name, name))
			return &gen_plants[i];
	return NULL;
}
