/* Broken, tiny, huge and odd plants: each is built, packed, planned and drawn, or refused with a reason;
 * triangles in are those stored and dropped; all numbers are finite. And corners, which are integers: for
 * each list it is stated from which distance on rounding them moves nothing by more than half a pixel
 * (lod/build/grid.h); here every stored corner is looked up among those of the source. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "lod/build/grid.h"
#include "lod/build/order/order.h"
#include "lod/ladder.h"
#include "tests/bench/extreme/extreme_scene.h"

/* ---- Plants of a soup ---- */

static void corner_triangle(struct soup *s, uint32_t material, struct lod_v3 a, struct lod_v3 b, struct lod_v3 c)
{
	uint32_t i = soup_vertex(s, a, 0, 0), k = soup_vertex(s, b, 1, 0), l = soup_vertex(s, c, 0, 1);
	soup_triangle(s, material, i, k, l);
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
		soup_leaf(s, material, lod_v3_add((struct lod_v3){ 0, 0, 1.5 },
			lod_v3_scale(soup_direction(s), soup_random(s, 0, 1))), 0.15, 0.1);
}

/* The numbers of its tables are checked where its pack is opened. */
static void counts_sound(const struct lod_plant *plant)
{
	uint64_t dropped = 0;
	for (int d = 0; d < ECO_DROP_COUNT; d++)
		dropped += plant->dropped[d];
	must_hold(isfinite(plant->plant.height_m) && isfinite(plant->plant.area) && plant->plant.area >= 0
		&& plant->triangles_in == plant->triangles_stored + dropped,
		"%s: %g m high, %g m^2; of %u triangles %u are stored and %llu dropped", plant->plant.name,
		(double)plant->plant.height_m, (double)plant->plant.area, plant->triangles_in,
		plant->triangles_stored, (unsigned long long)dropped);
}

/* Packs, plans and draws it, alone in its world; returns how many pixels it covers. */
static uint64_t grow(struct extreme_stand *stand)
{
	const struct eco_anchor *whole = &stand->plants[0].anchors[0];
	const float *c = whole->center;
	struct extreme_world world = { 0 };
	struct view_picture picture = { 0 };
	double r = whole->radius > 0 ? whole->radius : 1;
	struct eco_request request = { .view = { { c[0] - 3 * r, c[1] - 2 * r, c[2] + r }, { c[0], c[1], c[2] },
		{ 0, 0, 1 }, 45, 200, 200 }, .bytes = ECO_BYTES_UNBOUNDED };
	extreme_stand_place(stand, &(struct eco_source_instance){ .scale = 1 });
	extreme_world_open(&world, stand, &(struct extreme_site){ 0 });
	for (int i = 0; i < 4; i++) {
		struct eco_plan plan = { 0 };
		request.vertices = (const uint64_t[]){ 1, 3, 100, ECO_VERTICES_MAX }[i];
		extreme_plan(extreme_tables(&world), &request, &plan);
		eco_plan_free(&plan);
	}
	extreme_draw(&world, &request, &picture);
	uint64_t covered = extreme_covered(&picture);
	view_picture_free(&picture);
	extreme_world_close(&world);
	return covered;
}

enum wanted { SEEN, REFUSED, ANSWERED };     /* ANSWERED: sound or refused */

/* Builds the soup and frees it: the build must be refused with a reason, or the plant must be visible. */
static void try_soup(struct soup *soup, const char *name, enum wanted wanted)
{
	struct extreme_stand stand = { .plant_count = 0 };
	struct eco_error error = { 0 };
	enum eco_code code = extreme_stand_add(&stand, soup, name, &error);
	if (wanted == REFUSED || (wanted == ANSWERED && code)) {
		must_hold((code == ECO_BAD_INPUT || (wanted == ANSWERED && code == ECO_TOO_LARGE))
			&& strlen(error.text) > 10, "%s: status %d (%s)", name, code, error.text);
		return;
	}
	must_hold(!code, "%s: %s", name, error.text);
	counts_sound(&stand.plants[0]);
	uint64_t covered = grow(&stand);
	must_hold(wanted == ANSWERED || covered > 0, "%s: nothing of it is seen", name);
	extreme_stand_free(&stand);
}

/* ---- Triangles ---- */

UNIT_TEST(triangles_of_no_area)
{
	for (int alone = 0; alone < 2; alone++) {
		struct soup s;
		uint32_t m = begin(&s);
		if (!alone)
			some_leaves(&s, m, 60);
		for (int i = 0; i < 40; i++) {
			struct lod_v3 a = { soup_random(&s, -1, 1), 0, soup_random(&s, 0, 2) }, d = soup_direction(&s);
			corner_triangle(&s, m, a, a, lod_v3_add(a, d));
			corner_triangle(&s, m, (struct lod_v3){ i, 0, 0 }, (struct lod_v3){ i, 0, 1 },
				(struct lod_v3){ i, 0, 2 });
			corner_triangle(&s, m, a, a, a);
		}
		try_soup(&s, alone ? "nothing else" : "among leaves", alone ? REFUSED : SEEN);
	}
}

UNIT_TEST(needles_of_a_thousand_to_a_billion)
{
	for (double ratio = 1e3; ratio <= 1e9; ratio *= 1e3) {
		struct soup s;
		uint32_t m = begin(&s);
		some_leaves(&s, m, 20);
		for (int k = 0; k < 300; k++) {
			struct lod_v3 u = soup_direction(&s), v = lod_v3_unit(lod_v3_cross(u, soup_direction(&s))),
				at = { soup_random(&s, -0.5, 0.5), soup_random(&s, -0.5, 0.5), soup_random(&s, 0.5, 2) };
			corner_triangle(&s, m, at, lod_v3_add(at, u), lod_v3_add(at, lod_v3_scale(v, 1 / ratio)));
		}
		try_soup(&s, "needles", SEEN);
	}
}

UNIT_TEST(coincident_triangles)
{
	struct soup s;
	uint32_t m = begin(&s), other = soup_material(&s, 200, 40, 60, ECO_NONE, false);
	some_leaves(&s, m, 50);
	uint32_t once = s.model.triangle_count;
	for (uint32_t t = 0; t < 4 * once; t++) {
		const uint32_t *index = s.model.index + 3 * (t % once);
		soup_triangle(&s, t < 3 * once ? m : other, index[0], index[1], index[2]);
	}
	try_soup(&s, "each five times, once in another colour", SEEN);
	for (double apart = 0; apart < 2e-7; apart += 1e-7) {
		m = begin(&s);
		for (int i = 0; i < 300; i++)
			corner_triangle(&s, m, (struct lod_v3){ apart * i, 0, 0 }, (struct lod_v3){ 1, apart * i, 0 },
				(struct lod_v3){ 0, 0, 1 + apart * i });
		try_soup(&s, "300 times nearly the same", SEEN);
	}
}

UNIT_TEST(surfaces_that_are_no_manifold)
{
	struct soup s;
	uint32_t m = begin(&s), foot = soup_vertex(&s, (struct lod_v3){ 0, 0, 0 }, 0, 0),
		top = soup_vertex(&s, (struct lod_v3){ 0, 0, 2 }, 0, 0);
	for (int i = 0; i < 200; i++)
		soup_triangle(&s, m, foot, top, soup_vertex(&s, (struct lod_v3){ cos(i), sin(i), 1 }, 0, 0));
	try_soup(&s, "200 triangles at one edge", SEEN);
	m = begin(&s);
	uint32_t middle = soup_vertex(&s, (struct lod_v3){ 0, 0, 1 }, 0, 0);
	for (int i = 0; i < 200; i++) {
		struct lod_v3 a = soup_direction(&s), b = soup_direction(&s);
		a.z += 1, b.z += 1;
		soup_triangle(&s, m, middle, soup_vertex(&s, a, 0, 0), soup_vertex(&s, b, 0, 0));
	}
	try_soup(&s, "200 triangles at one corner", SEEN);
	m = begin(&s);
	enum { TURNS = 400 };
	for (uint32_t i = 0; i < 2 * TURNS; i++) {   /* a strip with half a twist: no side is out */
		double a = 2 * LOD_PI * (i / 2) / TURNS, w = i % 2 ? 0.3 : -0.3, r = 1 + w * cos(a / 2);
		soup_vertex(&s, (struct lod_v3){ r * cos(a), r * sin(a), 1 + w * sin(a / 2) }, 0, 0);
	}
	for (uint32_t i = 0; i < TURNS; i++) {
		uint32_t p = 2 * i, q = i + 1 < TURNS ? p + 2 : 1, r = i + 1 < TURNS ? p + 3 : 0;
		soup_triangle(&s, m, p, p + 1, q);
		soup_triangle(&s, m, p + 1, r, q);
	}
	try_soup(&s, "a strip with one side", SEEN);
}

UNIT_TEST(corners_that_are_not_finite_or_huge)
{
	static const float values[] = { NAN, INFINITY, -INFINITY, 1e-42f, 1e-30f, 3e38f, -1e30f, 1e10f };
	for (size_t i = 0; i < 2 * sizeof values / sizeof *values; i++) {
		struct soup s;
		char name[32];
		some_leaves(&s, begin(&s), 40);
		for (uint32_t v = 0; v < s.model.vertex_count; v++)
			if (i % 2 || v % 7 == 3)
				s.model.position[3 * v + v % 3] = values[i / 2];
		snprintf(name, sizeof name, "%s %g", i % 2 ? "all" : "some", (double)values[i / 2]);
		try_soup(&s, name, ANSWERED);
	}
}

UNIT_TEST(nothing_one_triangle_one_leaf)
{
	static const double corners[][3] = { { 1, 0.5, 1 }, { 1e-5, 0, 1e-5 }, { 1e5, 0, 1e5 } };
	struct soup s;
	begin(&s);
	try_soup(&s, "empty", REFUSED);
	for (size_t i = 0; i < sizeof corners / sizeof *corners; i++) {
		const double *c = corners[i];
		corner_triangle(&s, begin(&s), (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ c[0], 0, 0 },
			(struct lod_v3){ 0, c[1], c[2] });
		try_soup(&s, "one triangle", SEEN);
	}
	soup_quad(&s, begin(&s), (struct lod_v3){ 0, 0, 1 }, (struct lod_v3){ 1, 0, 0 }, (struct lod_v3){ 0, 0.3, 1 });
	try_soup(&s, "one leaf", SEEN);
}

UNIT_TEST(a_colour_a_leaf)
{
	struct soup s;
	uint32_t count = 5000;
	struct eco_material *all = eco_alloc(count, sizeof *all);
	begin(&s);
	s.model.materials = all;
	s.model.material_count = count;
	for (uint32_t i = 0; i < count; i++) {
		all[i] = (struct eco_material){ .rgb = { (uint8_t)i, (uint8_t)(i >> 8), (uint8_t)(i * 37) },
			.image = ECO_NONE };
		soup_leaf(&s, i, lod_v3_add((struct lod_v3){ 0, 0, 2 }, lod_v3_scale(soup_direction(&s), 2)), 0.05, 0.05);
	}
	try_soup(&s, "a colour a leaf", SEEN);
	free(all);
}

/* ---- Orders and amounts ---- */

enum { MOST = 3000 };
enum arrangement { POINT, LINE, PLANE, CLUSTERS, NO_NORMALS };

static void arrange(enum arrangement shape, uint32_t count, struct lod_v3 *center, struct lod_v3 *normal)
{
	uint64_t state = 7;
	for (uint32_t k = 0; k < count; k++) {
		double u = eco_random_unit(eco_random_next(&state)), v = eco_random_unit(eco_random_next(&state));
		const struct lod_v3 at[] = { [POINT] = { 1, 2, 3 }, [LINE] = { 0, 0, u }, [PLANE] = { u, v, 1 },
			[CLUSTERS] = { k % 2 ? 1e6 + u : u, v, u }, [NO_NORMALS] = { 1, 2, 3 } };
		center[k] = at[shape];
		normal[k] = shape == NO_NORMALS ? (struct lod_v3){ 0, 0, 0 } : (struct lod_v3){ u - 0.5, v - 0.5, 0.3 };
	}
}

UNIT_TEST(orders_are_finite_for_any_arrangement)
{
	static const struct { uint32_t count; enum arrangement shape; } rows[] = { { 1, POINT }, { 2, POINT },
		{ MOST, POINT }, { MOST, LINE }, { MOST, PLANE }, { MOST, CLUSTERS }, { 100, NO_NORMALS } };
	static const double heights[] = { 0, 1, 1e6 };
	static struct lod_v3 center[MOST], normal[MOST];
	static double survival[MOST];
	for (size_t i = 0; i < 3 * sizeof rows / sizeof *rows; i++) {
		uint32_t count = rows[i / 3].count;
		arrange(rows[i / 3].shape, count, center, normal);
		for (int method = LOD_ORDER_STOCHASTIC; method < LOD_ORDER_COUNT; method++) {
			struct lod_arena arena = { 0 };
			lod_order_survival_by(survival, (enum lod_order_method)method, &(struct lod_order_input){ .count = count,
				.center = center, .normal = normal, .height = heights[i % 3], .seed = 3 }, &arena);
			for (uint32_t k = 0; k < count; k++)
				must_hold(isfinite(survival[k]), "row %zu, %s: leaf %u survives by %g", i / 3,
					lod_order_names[method], k, survival[k]);
			lod_arena_free(&arena);
		}
	}
}

UNIT_TEST(leaves_in_one_point)
{
	for (int alike = 0; alike < 2; alike++) {
		struct soup s;
		uint32_t m = begin(&s);
		for (int i = 0; i < 200; i++)
			if (alike)
				soup_quad(&s, m, (struct lod_v3){ 0, 0, 1 }, (struct lod_v3){ 0.1, 0, 0 },
					(struct lod_v3){ 0, 1e-7 * i, 0.1 });
			else
				soup_leaf(&s, m, (struct lod_v3){ 0, 0, 1 }, 0.2, 0.1);
		try_soup(&s, "200 leaves in one point", SEEN);
	}
}

/* Shares down to the least that can be drawn: leaves grow, but not without end. */
UNIT_TEST(area_factors_are_bounded_down_to_one_vertex)
{
	static const double shares[] = { 0, 1e-308, 1e-30, 1e-9, 1e-4 };
	const struct eco_scene *s = extreme_tables(extreme_world());
	for (uint32_t i = 0; i < s->ladder_count; i++) {
		const struct eco_ladder *l = &s->ladders[i];
		struct lod_way way;
		lod_way_begin(&way, s, l);
		for (size_t k = 0; k < sizeof shares / sizeof *shares; k++) {
			struct eco_curve c = lod_ladder_curve(s, l, shares[k]);
			assert_true(isfinite(c.scale) && isfinite(c.fp) && isfinite(c.fn));
			assert_true(lod_way_vertices(&way, shares[k]) <= way.full);
		}
		uint64_t v = lod_way_next(&way, 0);
		for (int step = 0; step < 20 && v != UINT64_MAX; step++, v = lod_way_next(&way, v)) {
			struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
			uint32_t count = lod_way_cuts(&way, v, lod_way_density(&way, v), 0, cuts);
			for (uint32_t c = 0; c < count; c++)
				assert_true(cuts[c].scale > 0 && cuts[c].scale <= 1e12f);
		}
	}
}

/* ---- Stored corners ---- */

/* The square of the distance from a place to the nearest corner of the plant's triangle lists. `cells` holds
 * these corners by their place on the grid of all lists. */
struct corners { const struct eco_list *grid; struct lod_keyed *cells; uint32_t count; };

static uint64_t key_of(const int64_t p[3])
{
	return (uint64_t)(p[0] & 0xfffff) << 40 | (uint64_t)(p[1] & 0xfffff) << 20 | (uint64_t)(p[2] & 0xfffff);
}

ECO_ORDER(by_key, struct lod_keyed, ->key)

static struct corners corners_of(const struct lod_plant *plant)
{
	struct corners c = { .grid = NULL };
	size_t most = 0;
	for (uint32_t i = 0; i < plant->list_count; i++)
		most += plant->lists[i].elements.corner_count;
	c.cells = eco_alloc(most, sizeof *c.cells);
	for (uint32_t i = 0; i < plant->list_count; i++) {
		const struct lod_list_draft *d = &plant->lists[i];
		if (d->list.kind != ECO_LIST_TRIANGLES)
			continue;
		c.grid = c.grid ? c.grid : &d->list;
		assert_memory_equal(c.grid->grid_step, d->list.grid_step, sizeof d->list.grid_step);
		assert_memory_equal(c.grid->grid_origin, d->list.grid_origin, sizeof d->list.grid_origin);
		for (size_t k = 0; k < d->elements.corner_count; k++) {
			const int32_t *p = d->elements.position + 3 * k;
			c.cells[c.count++].key = key_of((const int64_t[3]){ p[0], p[1], p[2] });
		}
	}
	qsort(c.cells, c.count, sizeof *c.cells, by_key);
	return c;
}

/* Metres from a place to the nearest stored corner, on its own place of the grid or one beside it; INFINITY: none. */
static double nearest_m(const struct corners *c, const float *at)
{
	double least = INFINITY;
	for (int near = 0; near < 27; near++) {
		const int beside[3] = { near % 3 - 1, near / 3 % 3 - 1, near / 9 - 1 };
		int64_t p[3];
		double square = 0;
		for (int k = 0; k < 3; k++) {
			double origin = c->grid->grid_origin[k], step = c->grid->grid_step[k];
			p[k] = (int64_t)floor(((double)at[k] - origin) / step + 0.5) + beside[k];
			square += (origin + step * (double)p[k] - at[k]) * (origin + step * (double)p[k] - at[k]);
		}
		struct lod_keyed key = { key_of(p), 0 };
		if (bsearch(&key, c->cells, c->count, sizeof key, by_key))
			least = fmin(least, sqrt(square));
	}
	return least;
}

/* Scaled and shifted; `bits` 0: the grid is found; `lost`: share of corners that may be nowhere: floats hold
 * no more far from a model's own origin. */
static const struct tree { const char *name; double factor, shift_m; uint32_t leaves, flowers, bits; double lost; } trees[] = {
	{ "moss", 1e-3, 0, 200, 0, 0, 0 }, { "herb", 0.03, 0, 200, 0, 0, 0 }, { "tree", 1, 0, 1500, 0, 0, 0 },
	{ "giant", 18, 0, 3000, 0, 0, 0 }, { "600 m", 100, 0, 2500, 0, 0, 0 }, { "12 bits", 1, 0, 400, 20, 12, 0 },
	{ "15 bits", 1, 0, 400, 20, 15, 0 }, { "18 bits", 1, 0, 400, 20, 18, 0 },
	{ "1 km from its own origin", 1, 1000, 400, 0, 0, 0.02 } };

UNIT_TEST(every_corner_is_stored_within_half_a_pixel)
{
	for (const struct tree *t = trees; t < trees + sizeof trees / sizeof *trees; t++) {
		struct soup s;
		struct lod_plant plant = { 0 };
		struct lod_plant_options options = { .name = t->name, .seed = 1,
			.order = LOD_ORDER_STOCHASTIC, .grid_bits = t->bits, .views = 2, .pixels = 64 };
		uint32_t lost = 0;
		double moved = 0;
		soup_tree(&s, t->leaves, t->flowers, false);
		for (uint32_t i = 0; i < 3 * s.model.vertex_count; i++)
			s.model.position[i] = (float)(t->factor * (double)s.model.position[i] + (i % 3 ? 0 : t->shift_m));
		assert_good(lod_plant_build(&plant, &s.model, &options, &cause));
		assert_good(lod_plant_measure(&plant, &s.model, &options, &cause));
		struct corners corners = corners_of(&plant);
		for (uint32_t v = 0; v < s.model.vertex_count; v++) {
			double off = nearest_m(&corners, s.model.position + 3 * v);
			lost += isinf(off) != 0;
			moved = isinf(off) ? moved : fmax(moved, off);
		}
		/* welding moves a corner by another 1e-6 of the plant */
		double radius = (double)plant.anchors[0].radius, stated = lod_grid_nearest_m(corners.grid, LOD_GRID_PIXEL_RAD);
		must_hold(moved <= 0.5 * stated * LOD_GRID_PIXEL_RAD + 4e-6 * radius && stated <= 2.5 * radius
			&& lost <= t->lost * s.model.vertex_count, "%s of %g m: corners moved by up to %g m, stated %g m, %u lost",
			t->name, radius, moved, stated, lost);
		free(corners.cells);
		lod_plant_free(&plant);
		soup_free(&s);
	}
}
