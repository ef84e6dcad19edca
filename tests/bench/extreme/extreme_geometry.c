/* Geometry: broken models, as scanners make them. Each is built into a plant, packed,
 * planned and drawn; or refused with a reason. Every triangle of the source is stored or counted as dropped,
 * and no number that is written is not a number. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "lod/ladder.h"
#include "tests/bench/extreme/extreme_scene.h"

/* ---- Plants of a soup ---- */

static void corner_triangle(struct soup *s, uint32_t material, struct lod_v3 a, struct lod_v3 b,
	struct lod_v3 c)
{
	uint32_t i = soup_vertex(s, a, 0, 0), k = soup_vertex(s, b, 1, 0), l = soup_vertex(s, c, 0, 1);
	soup_triangle(s, material, i, k, l);
}

/* Corners (0, 0, 0), (x, 0, 0), (0, y, z). */
static void right_triangle(struct soup *s, uint32_t material, double x, double y, double z)
{
	corner_triangle(s, material, (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ x, 0, 0 },
		(struct lod_v3){ 0, y, z });
}

static uint32_t begin(struct soup *s)
{
	soup_begin(s);
	return soup_material(s, 60, 140, 50, ECO_NONE, false);
}

/* A small sound crown around the broken part. */
static void some_leaves(struct soup *s, uint32_t material, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		soup_leaf(s, material,
			lod_v3_add((struct lod_v3){ 0, 0, 1.5 },
			lod_v3_scale(soup_direction(s), soup_random(s, 0, 1))), 0.15, 0.1);
}

/* The numbers of its tables are checked where its pack is opened. */
static void counts_sound(struct extreme *x, const struct lod_plant *plant)
{
	uint64_t dropped = 0;
	for (int d = 0; d < ECO_DROP_COUNT; d++)
		dropped += plant->dropped[d];
	extreme_must(x, isfinite(plant->plant.height_m) && isfinite(plant->plant.area) && plant->plant.area >= 0,
		"%s: %g m high, %g m^2", plant->plant.name, (double)plant->plant.height_m,
		(double)plant->plant.area);
	extreme_must(x, plant->triangles_in == plant->triangles_stored + dropped,
		"%s: of %u triangles %u are stored and %llu dropped", plant->plant.name, plant->triangles_in,
		plant->triangles_stored, (unsigned long long)dropped);
}

/* Packs, plans and draws it, alone in its world; returns how many pixels it covers. */
static uint64_t grow(struct extreme *x, struct extreme_stand *stand)
{
	const struct eco_anchor *whole = &stand->plants[0].anchors[0];
	const float *c = whole->center;
	struct extreme_world world = { 0 };
	struct view_picture picture = { 0 };
	double r = whole->radius > 0 ? whole->radius : 1;
	struct eco_request request =
		{ .view = { { c[0] - 3 * r, c[1] - 2 * r, c[2] + r }, { c[0], c[1], c[2] }, { 0, 0, 1 }, 45,
		200, 200 }, .bytes = ECO_BYTES_UNBOUNDED };
	extreme_stand_place(stand, &(struct eco_source_instance){ .scale = 1 });
	extreme_world_open(x, &world, stand, &(struct extreme_site){ 0 });
	for (int i = 0; i < 4; i++) {
		struct eco_plan plan = { 0 };
		request.vertices = (const uint64_t[]){ 1, 3, 100, ECO_VERTICES_MAX }[i];
		extreme_plan(x, extreme_tables(&world), &request, &plan);
		eco_plan_free(&plan);
	}
	extreme_draw(x, &world, &request, &picture);
	uint64_t covered = extreme_covered(&picture);
	view_picture_free(&picture);
	extreme_world_close(&world);
	return covered;
}

enum wanted { SEEN, REFUSED, ANSWERED };     /* ANSWERED: sound or refused */

/* Builds the soup and frees it: the build must be refused with a reason, or the plant must be visible. */
static void try_soup(struct extreme *x, struct soup *soup, const char *name, enum wanted wanted)
{
	struct extreme_stand stand = { .plant_count = 0 };
	struct eco_error error = { 0 };
	enum eco_code code = extreme_stand_add(&stand, soup, name, &error);
	if (wanted == REFUSED || (wanted == ANSWERED && code)) {
		extreme_must(x, (code == ECO_BAD_INPUT || (wanted == ANSWERED && code == ECO_TOO_LARGE))
			&& strlen(error.text) > 10, "%s: status %d (%s)", name, code, error.text);
		extreme_say(x, "%s: refused", name);
		return;
	}
	extreme_must(x, !code, "%s: %s", name, error.text);
	counts_sound(x, &stand.plants[0]);
	uint64_t covered = grow(x, &stand);
	extreme_must(x, wanted == ANSWERED || covered > 0, "%s: nothing of it is seen", name);
	if (wanted == ANSWERED)
		extreme_say(x, "%s: built", name);
	else
		extreme_say(x, "%s: %u of %u triangles stored, %llu pixels", name,
			stand.plants[0].triangles_stored, stand.plants[0].triangles_in,
			(unsigned long long)covered);
	extreme_stand_free(&stand);
}

/* ---- Triangles ---- */

static void zero_area(struct extreme *x)
{
	for (int alone = 0; alone < 2; alone++) {
		struct soup s;
		uint32_t m = begin(&s);
		if (!alone)
			some_leaves(&s, m, 60);
		for (int i = 0; i < 40; i++) {
			struct lod_v3 a = { soup_random(&s, -1, 1), 0, soup_random(&s, 0, 2) },
				d = soup_direction(&s);
			corner_triangle(&s, m, a, a, lod_v3_add(a, d));
			corner_triangle(&s, m, (struct lod_v3){ i, 0, 0 }, (struct lod_v3){ i, 0, 1 },
				(struct lod_v3){ i, 0, 2 });
			corner_triangle(&s, m, a, a, a);
		}
		try_soup(x, &s, alone ? "nothing else" : "among leaves", alone ? REFUSED : SEEN);
	}
}

static void needles(struct extreme *x)
{
	static const double ratio[] = { 1e3, 1e6, 1e9 };
	for (int i = 0; i < 3; i++) {
		struct soup s;
		char name[40];
		uint32_t m = begin(&s);
		some_leaves(&s, m, 20);
		for (int k = 0; k < 300; k++) {
			struct lod_v3 u = soup_direction(&s),
				v = lod_v3_unit(lod_v3_cross(u, soup_direction(&s)));
			struct lod_v3 at = { soup_random(&s, -0.5, 0.5), soup_random(&s, -0.5, 0.5),
				soup_random(&s, 0.5, 2) };
			corner_triangle(&s, m, at, lod_v3_add(at, u),
				lod_v3_add(at, lod_v3_scale(v, 1 / ratio[i])));
		}
		snprintf(name, sizeof name, "%.0e:1", ratio[i]);
		try_soup(x, &s, name, SEEN);
	}
}

static void coincident(struct extreme *x)
{
	struct soup s;
	uint32_t m = begin(&s), other = soup_material(&s, 200, 40, 60, ECO_NONE, false);
	some_leaves(&s, m, 50);
	uint32_t once = s.model.triangle_count;
	for (int copy = 0; copy < 4; copy++)
		for (uint32_t t = 0; t < once; t++)
			soup_triangle(&s, copy == 3 ? other : m, s.model.index[3 * t],
				s.model.index[3 * t + 1], s.model.index[3 * t + 2]);
	try_soup(x, &s, "each five times; once in another colour", SEEN);
	m = begin(&s);
	for (int i = 0; i < 300; i++)
		right_triangle(&s, m, 1, 0, 1);
	try_soup(x, &s, "one triangle 300 times", SEEN);
	m = begin(&s);
	for (int i = 0; i < 300; i++)
		corner_triangle(&s, m, (struct lod_v3){ 1e-7 * i, 0, 0 }, (struct lod_v3){ 1, 1e-7 * i, 0 },
			(struct lod_v3){ 0, 0, 1 + 1e-7 * i });
	try_soup(x, &s, "nearly the same", SEEN);
}

static void non_manifold(struct extreme *x)
{
	struct soup s;
	uint32_t m = begin(&s), foot = soup_vertex(&s, (struct lod_v3){ 0, 0, 0 }, 0, 0),
		top = soup_vertex(&s, (struct lod_v3){ 0, 0, 2 }, 0, 0);
	for (int i = 0; i < 200; i++)
		soup_triangle(&s, m, foot, top, soup_vertex(&s, (struct lod_v3){ cos(i), sin(i), 1 }, 0, 0));
	try_soup(x, &s, "200 triangles at one edge", SEEN);
	m = begin(&s);
	uint32_t middle = soup_vertex(&s, (struct lod_v3){ 0, 0, 1 }, 0, 0);
	for (int i = 0; i < 200; i++)
		soup_triangle(&s, m, middle,
			soup_vertex(&s, lod_v3_add((struct lod_v3){ 0, 0, 1 }, soup_direction(&s)), 0, 0),
			soup_vertex(&s, lod_v3_add((struct lod_v3){ 0, 0, 1 }, soup_direction(&s)), 0, 0));
	try_soup(x, &s, "200 triangles at one corner", SEEN);
	m = begin(&s);
	enum { TURNS = 400 };
	for (int i = 0; i < TURNS; i++)              /* a strip with half a twist: no side is out */
		for (int side = -1; side <= 1; side += 2) {
			double a = 2 * LOD_PI * i / TURNS, w = 0.3 * side;
			soup_vertex(&s,
				(struct lod_v3){ (1 + w * cos(a / 2)) * cos(a), (1 + w * cos(a / 2)) * sin(a),
				1 + w * sin(a / 2) }, 0, 0);
		}
	for (uint32_t i = 0; i < TURNS; i++) {
		uint32_t p = 2 * i, q = i + 1 < TURNS ? p + 2 : 1, r = i + 1 < TURNS ? p + 3 : 0;
		soup_triangle(&s, m, p, p + 1, q);
		soup_triangle(&s, m, p + 1, r, q);
	}
	try_soup(x, &s, "a strip with one side", SEEN);
}

static void not_finite(struct extreme *x)
{
	static const struct { const char *name; float value; } rows[] =
		{ { "NaN", NAN }, { "infinite", INFINITY }, { "minus infinite", -INFINITY },
		{ "denormal", 1e-42f },
		{ "1e-30", 1e-30f }, { "3e38", 3e38f }, { "-1e30", -1e30f }, { "1e10", 1e10f } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		for (int alone = 0; alone < 2; alone++) {
			struct soup s;
			uint32_t m = begin(&s);
			some_leaves(&s, m, 40);
			for (uint32_t v = 0; v < s.model.vertex_count; v++)
				if (alone || v % 7 == 3)
					s.model.position[3 * v + v % 3] = rows[i].value;
			try_soup(x, &s, rows[i].name, ANSWERED);
		}
}

static void few(struct extreme *x)
{
	static const struct { const char *name; double corner[3]; } rows[] = { { "one triangle", { 1, 0.5,
		1 } },
		{ "one of 10 micrometres", { 1e-5, 0, 1e-5 } }, { "one of 100 km", { 1e5, 0, 1e5 } } };
	struct soup s;
	begin(&s);
	try_soup(x, &s, "empty", REFUSED);
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		const double *c = rows[i].corner;
		uint32_t m = begin(&s);
		right_triangle(&s, m, c[0], c[1], c[2]);
		try_soup(x, &s, rows[i].name, SEEN);
	}
	uint32_t m = begin(&s);
	soup_quad(&s, m, (struct lod_v3){ 0, 0, 1 }, (struct lod_v3){ 1, 0, 0 }, (struct lod_v3){ 0, 0.3,
		1 });
	try_soup(x, &s, "one leaf", SEEN);
}

/* ---- Many ---- */

static void materials(struct extreme *x)
{
	struct soup s;
	uint32_t count = x->quick ? 5000 : 100000;
	struct eco_material *all = eco_alloc(count, sizeof *all);
	begin(&s);
	s.model.materials = all;
	s.model.material_count = count;
	for (uint32_t i = 0; i < count; i++) {
		all[i] = (struct eco_material){ .rgb = { (uint8_t)i, (uint8_t)(i >> 8), (uint8_t)(i * 37) },
			.image = ECO_NONE };
		soup_leaf(&s, i, lod_v3_add((struct lod_v3){ 0, 0, 2 }, lod_v3_scale(soup_direction(&s), 2)),
			0.05, 0.05);
	}
	try_soup(x, &s, "a colour a leaf", SEEN);
	free(all);
}

static void ten_million(struct extreme *x)
{
	struct soup s;
	struct lod_plant plant = { 0 };
	uint32_t m = begin(&s), leaves = 5000000;
	for (uint32_t i = 0; i < leaves; i++)
		soup_leaf(&s, m,
			lod_v3_add((struct lod_v3){ 0, 0, 20 },
			lod_v3_scale(soup_direction(&s), 15 * sqrt(soup_random(&s, 0, 1)))), 0.03, 0.02);
	struct lod_plant_options options = { .name = "ten million", .seed = 1, .order = LOD_ORDER_STOCHASTIC,
		.grid_bits = 16, .views = 2, .pixels = 64 };
	extreme_good(x, lod_plant_build(&plant, &s.model, &options, &x->error));
	extreme_good(x, lod_plant_measure(&plant, &s.model, &options, &x->error));
	soup_free(&s);
	counts_sound(x, &plant);
	extreme_say(x, "%u of %u triangles stored, %u cells", plant.triangles_stored, plant.triangles_in,
		plant.plant.anchor_count - 1);
	lod_plant_free(&plant);
}

/* ---- Orders and amounts ---- */

static void orders(struct extreme *x)
{
	enum { MOST = 3000 };
	static struct lod_v3 center[MOST], normal[MOST];
	static double survival[MOST];
	static const struct { const char *name; uint32_t count; int shape; } rows[] =
		{ { "one leaf", 1, 0 }, { "two in one point", 2, 0 },
		{ "all in one point", MOST, 0 },
		{ "all on a line", MOST, 1 }, { "all in a plane", MOST, 2 },
		{ "two clusters 1e6 apart", MOST, 3 }, { "no normals", 100, 4 } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		for (int method = LOD_ORDER_STOCHASTIC; method < LOD_ORDER_COUNT; method++)
			for (int tall = 0; tall < 3; tall++) {
				struct lod_arena arena = { 0 };
				uint64_t state = 7;
				for (uint32_t k = 0; k < rows[i].count; k++) {
					double u = eco_random_unit(state = lod_mix(state + 1)),
						v = eco_random_unit(state = lod_mix(state + 1));
					center[k] = rows[i].shape == 1 ? (struct lod_v3){ 0, 0, u }
						: rows[i].shape == 2 ? (struct lod_v3){ u, v, 1 }
						: rows[i].shape == 3
							? (struct lod_v3){ k % 2 ? 1e6 + u : u, v, u }
							: (struct lod_v3){ 1, 2, 3 };
					normal[k] = rows[i].shape == 4 ? (struct lod_v3){ 0, 0, 0 }
						: (struct lod_v3){ u - 0.5, v - 0.5, 0.3 };
				}
				lod_order_survival_by(survival, (enum lod_order_method)method,
					&(struct lod_order_input){ .count = rows[i].count, .center = center,
					.normal = normal, .height = tall == 0 ? 0 : tall == 1 ? 1 : 1e6,
					.seed = 3 }, &arena);
				for (uint32_t k = 0; k < rows[i].count; k++)
					extreme_must(x, isfinite(survival[k]),
						"%s, %s: leaf %u survives by %g", rows[i].name,
						lod_order_names[method], k, survival[k]);
				lod_arena_free(&arena);
			}
	for (int alike = 0; alike < 2; alike++) {
		struct soup s;
		uint32_t m = begin(&s);
		for (int i = 0; i < 200; i++)
			if (alike)
				soup_quad(&s, m, (struct lod_v3){ 0, 0, 1 }, (struct lod_v3){ 0.1, 0, 0 },
					(struct lod_v3){ 0, 1e-7 * i, 0.1 });
			else
				soup_leaf(&s, m, (struct lod_v3){ 0, 0, 1 }, 0.2, 0.1);
		try_soup(x, &s, alike ? "200 leaves alike in one point" : "200 leaves in one point", SEEN);
	}
	extreme_say(x, "%zu arrangements by 4 orders at 3 heights: finite", sizeof rows / sizeof *rows);
}

/* Shares down to the least that can be drawn: leaves grow, but not without end. */
static void lambda_to_0(struct extreme *x)
{
	static const double shares[] = { 0, 1e-308, 1e-30, 1e-9, 1e-4 };
	const struct eco_scene *s = extreme_tables(extreme_world(x));
	double largest = 0;
	uint32_t tried = 0;
	for (uint32_t i = 0; i < s->ladder_count; i++) {
		const struct eco_ladder *l = &s->ladders[i];
		struct lod_way way;
		lod_way_begin(&way, s, l);
		for (size_t k = 0; k < sizeof shares / sizeof *shares; k++) {
			struct eco_curve c = lod_ladder_curve(s, l, shares[k]);
			extreme_must(x, isfinite(c.scale) && isfinite(c.fp) && isfinite(c.fn),
				"ladder %u at a share of %g is not finite", i, shares[k]);
			extreme_must(x, lod_way_vertices(&way, shares[k]) <= way.full,
				"ladder %u at a share of %g", i, shares[k]);
		}
		uint64_t v = lod_way_next(&way, 0);
		for (int step = 0; step < 20 && v != UINT64_MAX; step++, v = lod_way_next(&way, v)) {
			struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
			uint32_t count = lod_way_cuts(&way, v, lod_way_density(&way, v), 0, cuts);
			for (uint32_t c = 0; c < count; c++, tried++) {
				extreme_must(x, cuts[c].scale > 0 && cuts[c].scale <= 1e12f,
					"ladder %u, %llu vertices: scale %g", i, (unsigned long long)v,
					(double)cuts[c].scale);
				largest = fmax(largest, (double)cuts[c].scale);
			}
		}
	}
	extreme_say(x, "%u ladders, %u cuts: the largest area factor is %.0f", s->ladder_count, tried,
		largest);
}

/* ---- Cases ---- */

#define BUILT "built, packed, planned, drawn, or refused with a reason; triangles in = stored + dropped; " \
	"all numbers finite"

const struct extreme_case extreme_geometry[] = {
	EXTREME_CASE("triangles of no area", BUILT, zero_area),
	EXTREME_CASE("needles of 1e3:1 to 1e9:1", BUILT, needles),
	EXTREME_CASE("coincident and duplicate triangles", BUILT, coincident),
	EXTREME_CASE("non-manifold surfaces", BUILT, non_manifold),
	EXTREME_CASE("NaN, infinite, denormal and huge corners", BUILT, not_finite),
	EXTREME_CASE("empty plants, one triangle", BUILT, few),
	{ "a plant of 1e7 triangles", BUILT "; stochastic order", ten_million, NULL,
		true },
	EXTREME_CASE("1e5 materials", BUILT, materials),
	EXTREME_CASE("orders of one leaf and of all in one point",
		"every order is finite, whatever the arrangement; such plants are built and drawn", orders),
	EXTREME_CASE("lambda to 0", "curves and area factors are finite and bounded down to one vertex",
		lambda_to_0),
	{ .name = NULL } };
