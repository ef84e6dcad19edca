/* Buildings from footprints: closed but at the bottom, of the right volume, whatever the rings are like. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/random.h"
#include "ecofiles/generate/buildings.h"
#include "tests/support/unit_test.h"

static struct eco_edge edges[4096];
static uint32_t edge_count;

/* Adds a ring of `count` corners. */
static void ring(const double (*corners)[2], uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		memcpy(edges[edge_count].a, corners[i], sizeof corners[i]);
		memcpy(edges[edge_count++].b, corners[(i + 1) % count], sizeof corners[i]);
	}
}

static void box(double x, double y, double wide, double deep)
{
	ring((const double[][2]){ { x, y }, { x + wide, y }, { x + wide, y + deep }, { x, y + deep } }, 4);
}

static struct eco_model model;
static struct eco_buildings_notes notes;

/* One building of the rings so far, on ground at 100 m. */
static void build(enum eco_roof roof, double height_m, bool to_eaves)
{
	struct eco_building building = { .edges = edges, .edge_count = edge_count, .base_m = 100, .height_m = height_m,
		.to_eaves = to_eaves, .roof = roof };
	notes = (struct eco_buildings_notes){ 0 };
	eco_buildings_make(&model, &building, 1, (const double[]){ 0, 0, 100 }, &notes);
	edge_count = 0;
}

static const float *corner(uint32_t t, uint32_t k)
{
	return model.position + 3 * (size_t)model.index[3 * t + k % 3];
}

/* Volume above the bottom by the divergence theorem; without a floor there, as it is moved to z = 0. */
static double volume(void)
{
	double sum = 0;
	for (uint32_t t = 0; t < model.triangle_count; t++) {
		double p[3][3];
		for (uint32_t k = 0; k < 3; k++)
			for (int i = 0; i < 3; i++)
				p[k][i] = corner(t, k)[i] + (i == 2 ? ECO_BUILDING_SINK_M : 0);
		sum += (p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) -
			       p[0][1] * (p[1][0] * p[2][2] - p[1][2] * p[2][0]) +
			       p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0])) /
			6;
	}
	return sum;
}

static double top(void)
{
	double z = -INFINITY;
	for (uint32_t i = 0; i < model.vertex_count; i++)
		z = fmax(z, (double)model.position[3 * (size_t)i + 2]);
	return z;
}

struct side {
	float from[3], to[3];
	int count;
};

static int compare(const void *a, const void *b)
{
	return memcmp(a, b, 6 * sizeof(float));
}

static void add_side(struct side *side, const float *p, const float *q)
{
	bool turned = memcmp(p, q, 3 * sizeof *p) > 0;
	memcpy(side->from, turned ? q : p, sizeof side->from);
	memcpy(side->to, turned ? p : q, sizeof side->to);
	side->count = turned ? -1 : 1;
}

/* Sides of triangles that no other runs along in the opposite direction, but those at the bottom. */
static uint32_t open_sides(void)
{
	uint32_t count = 0, open = 0;
	struct side *sides = eco_alloc(3 * (size_t)model.triangle_count + 1, sizeof *sides);
	for (uint32_t t = 0; t < model.triangle_count; t++)
		for (uint32_t k = 0; k < 3; k++)
			add_side(&sides[count++], corner(t, k), corner(t, k + 1));
	qsort(sides, count, sizeof *sides, compare);
	for (uint32_t i = 0, end; i < count; i = end) {
		int sum = 0;
		for (end = i; end < count && compare(&sides[i], &sides[end]) == 0; end++)
			sum += sides[end].count;
		bool bottom = sides[i].from[2] == (float)-ECO_BUILDING_SINK_M &&
			sides[i].to[2] == (float)-ECO_BUILDING_SINK_M;
		open += sum != 0 && !bottom;
	}
	free(sides);
	return open;
}

#define assert_building(cubic_metres, high) \
	do { \
		assert_int_equal(open_sides(), 0); \
		assert_true(fabs(volume() - (cubic_metres)) < 1e-3 * (cubic_metres)); \
		assert_true(fabs(top() - (high)) < 1e-3); \
		assert_true(model.object); \
		eco_model_free(&model); \
	} while (0)

UNIT_TEST(a_box_has_ten_triangles)
{
	box(5, 7, 10, 8);
	build(ECO_ROOF_FLAT, 6, false);
	assert_int_equal(model.triangle_count, 10);
	assert_building(10 * 8 * 6.5, 6);
}

UNIT_TEST(direction_and_order_of_rings_do_not_matter)
{
	for (int turned = 0; turned < 2; turned++) {
		const double hole[][2] = { { 4, 4 }, { 4, 8 }, { 8, 8 }, { 8, 4 } },
			     back[][2] = { { 8, 4 }, { 8, 8 }, { 4, 8 }, { 4, 4 } };
		if (turned)
			ring(hole, 4);
		box(0, 0, 20, 12);
		if (!turned)
			ring(back, 4);
		box(5, 5, 2, 2);  /* an island in the hole */
		box(30, 0, 5, 5); /* another part */
		build(ECO_ROOF_FLAT, 9.5, false);
		assert_int_equal(notes.nothing + notes.crossed, 0);
		assert_building(10 * (20 * 12 - 16 + 4 + 25), 9.5);
	}
}

/* A square of 10 m whose ring begins at one of its corners. */
static void square(double x, double y, uint32_t first)
{
	const double all[4][2] = { { x, y }, { x + 10, y }, { x + 10, y + 10 }, { x, y + 10 } };
	double corners[4][2];
	for (uint32_t i = 0; i < 4; i++)
		memcpy(corners[i], all[(first + i) % 4], sizeof corners[i]);
	ring((const double(*)[2])corners, 4);
}

UNIT_TEST(parts_that_share_a_wall_are_both_there)
{
	static const double beside[][2] = { { 0, 10 }, { 0, -10 }, { 10, 0 }, { -10, 0 } };
	for (uint32_t i = 0; i < 64; i++) {
		square(0, 0, i / 4 % 4);
		square(beside[i % 4][0], beside[i % 4][1], i / 16);
		build(ECO_ROOF_FLAT, 4.5, false);
		assert_int_equal(notes.nothing + notes.crossed, 0);
		assert_building(5 * 200, 4.5);
	}
	box(0, 0, 10, 10);
	box(3, 0, 4, 4); /* a hole that ends at the wall around it */
	build(ECO_ROOF_FLAT, 4.5, false);
	assert_true(fabs(volume() - 5 * (100 - 16)) < 0.1);
	eco_model_free(&model);
}

UNIT_TEST(a_ring_that_crosses_itself_is_cut_there)
{
	ring((const double[][2]){ { 0, 0 }, { 10, 10 }, { 10, 0 }, { 0, 10 } }, 4);
	build(ECO_ROOF_FLAT, 4.5, false);
	assert_int_equal(notes.crossed, 1);
	assert_building(5 * 50, 4.5);
	/* two squares that touch in a corner, as one ring */
	ring((const double[][2]){ { 0, 0 }, { 4, 0 }, { 4, 4 }, { 9, 4 }, { 9, 9 }, { 4, 9 }, { 4, 4 },
		     { 0, 4 } },
		8);
	build(ECO_ROOF_FLAT, 4.5, false);
	assert_building(5 * (16 + 25), 4.5);
}

UNIT_TEST(repeated_corners_and_spikes_go)
{
	ring((const double[][2]){ { 0, 0 }, { 5, 0 }, { 5, 0 }, { 10, 0 }, { 10, 5 }, { 15, 5 }, { 10, 5 },
		     { 10, 10 }, { 0, 10 } },
		9);
	build(ECO_ROOF_FLAT, 4.5, false);
	assert_int_equal(model.triangle_count, 10);
	assert_building(5 * 100, 4.5);
}

UNIT_TEST(what_has_no_surface_is_counted)
{
	ring((const double[][2]){ { 0, 0 }, { 5, 5 }, { 10, 10 } }, 3);
	build(ECO_ROOF_FLAT, 4, false);
	assert_int_equal(notes.nothing, 1);
	assert_int_equal(model.triangle_count, 0);
	eco_model_free(&model);
	box(0, 0, 2 * ECO_BUILDING_WIDE_M, 5);
	build(ECO_ROOF_FLAT, 4, false);
	assert_int_equal(notes.nothing, 1);
	eco_model_free(&model);
}

UNIT_TEST(pitched_roofs_are_as_high_as_told)
{
	const double wide = 12, deep = 8, half = 4, rise = 0.7 * half;
	const struct {
		enum eco_roof roof;
		double rise, share;
	} forms[] = { { ECO_ROOF_GABLED, rise, 0.5 },
		{ ECO_ROOF_HIPPED, rise, (wide - half * 2 / 3 * 2 + half * 2 / 3) / wide / 2 },
		{ ECO_ROOF_PYRAMIDAL, rise, 1.0 / 3 }, { ECO_ROOF_SHED, 0.2 * deep, 0.5 } };
	for (size_t i = 0; i < sizeof forms / sizeof *forms; i++)
		for (int to_eaves = 0; to_eaves < 2; to_eaves++) {
			double walls = to_eaves ? 9 : 9 - forms[i].rise;
			box(0, 0, wide, deep);
			build(forms[i].roof, 9, to_eaves);
			/* a hip takes a sixth of the prism over its square at each end */
			double roof = forms[i].roof == ECO_ROOF_HIPPED
				? forms[i].rise * deep * (wide / 2 - deep / 6)
				: forms[i].rise * wide * deep * forms[i].share;
			assert_building(wide * deep * (walls + ECO_BUILDING_SINK_M) + roof,
				walls + forms[i].rise);
		}
}

UNIT_TEST(a_roof_takes_no_more_than_half_of_a_low_building)
{
	box(0, 0, 30, 20);
	build(ECO_ROOF_GABLED, 4, false);
	assert_building(600 * 2.5 + 600 * 2 / 2.0, 4);
	box(0, 0, 300, 200); /* a hall of one storey */
	build(ECO_ROOF_GABLED, 4, true);
	assert_building(60000 * 4.5 + 60000 * 4 / 2.0, 8);
}

UNIT_TEST(a_footprint_with_a_hole_has_a_flat_roof)
{
	box(0, 0, 20, 20);
	box(5, 5, 5, 5);
	build(ECO_ROOF_GABLED, 9.5, false);
	assert_int_equal(notes.flat, 1);
	assert_building(10 * 375, 9.5);
}

/* A star-shaped ring of odd corners around a middle. */
static double odd_ring(uint64_t *state, double x, double y, double reach)
{
	double corners[40][2], twice = 0;
	uint32_t count = 5 + (uint32_t)(eco_random_next(state) % 35);
	for (uint32_t i = 0; i < count; i++) {
		double turn = 6.283185307179586 * (i + 0.8 * eco_random_unit(eco_random_next(state))) / count,
		       away = reach * (0.2 + 0.8 * eco_random_unit(eco_random_next(state)));
		corners[i][0] = floor(1000 * (x + away * cos(turn))) / 1000;
		corners[i][1] = floor(1000 * (y + away * sin(turn))) / 1000;
	}
	for (uint32_t i = 0; i < count; i++)
		twice += corners[i][0] * corners[(i + 1) % count][1] -
			corners[i][1] * corners[(i + 1) % count][0];
	ring((const double(*)[2])corners, count);
	return twice / 2;
}

UNIT_TEST(odd_footprints_are_closed_under_all_roofs)
{
	uint64_t state = 7;
	for (int i = 0; i < 2000; i++) {
		enum eco_roof roof = (enum eco_roof)(i % ECO_ROOF_COUNT);
		double area = odd_ring(&state, 500, -300, 20);
		if (i % 3 == 0)
			area -= odd_ring(&state, 500, -300, 2);
		build(roof, 12, true);
		assert_int_equal(open_sides(), 0);
		if (roof == ECO_ROOF_FLAT || i % 3 == 0)
			assert_true(fabs(volume() - area * 12.5) < 1e-3 * area * 12.5);
		else
			assert_true(volume() > area * 12.5);
		eco_model_free(&model);
	}
}

UNIT_TEST(rings_that_cross_themselves_and_each_other_leave_finite_meshes)
{
	uint64_t state = 11;
	uint32_t crossed = 0, triangles = 0;
	for (int i = 0; i < 600; i++) {
		uint32_t rings = 1 + (uint32_t)(eco_random_next(&state) % 4);
		for (uint32_t r = 0; r < rings; r++) {
			double corners[20][2], cell = i % 3 ? 0.001 : 4; /* on a grid they touch and repeat, too */
			uint32_t count = 3 + (uint32_t)(eco_random_next(&state) % 18);
			for (uint32_t k = 0; k < 2 * count; k++)
				corners[k / 2][k % 2] = floor(eco_random_unit(eco_random_next(&state)) * 20 / cell) * cell;
			ring((const double(*)[2])corners, count);
		}
		build((enum eco_roof)(i % ECO_ROOF_COUNT), 5, i % 2);
		for (size_t k = 0; k < 3 * (size_t)model.vertex_count; k++)
			assert_true(model.position[k] >= -0.51f && model.position[k] <= 30);
		assert_int_equal(notes.nothing, model.triangle_count == 0);
		crossed += notes.crossed;
		triangles += model.triangle_count;
		eco_model_free(&model);
	}
	assert_true(crossed > 500 && triangles > 600 * 20);
}

/* Area of upright triangles, and the number of buildings that stand on others. */
static double walls_of(struct eco_building *buildings, uint32_t count, uint32_t *twins)
{
	struct eco_building *all[8] = { NULL };
	double sum = 0;
	*twins = 0;
	for (uint32_t i = 0; i < count; i++)
		all[i] = &buildings[i];
	eco_buildings_cover(all, count);
	eco_buildings_make(&model, buildings, count, (const double[]){ 0, 0, 100 }, &notes);
	for (uint32_t t = 0; t < model.triangle_count; t++) {
		double e[2][3];
		for (int k = 0; k < 3; k++)
			for (uint32_t i = 0; i < 2; i++)
				e[i][k] = (double)(corner(t, i + 1)[k] - corner(t, 0)[k]);
		double up = e[0][0] * e[1][1] - e[0][1] * e[1][0], x = e[0][1] * e[1][2] - e[0][2] * e[1][1],
			y = e[0][2] * e[1][0] - e[0][0] * e[1][2];
		sum += fabs(up) < 1e-6 ? sqrt(x * x + y * y) / 2 : 0;
	}
	for (uint32_t i = 0; i < count; i++) {
		*twins += buildings[i].twin;
		free(buildings[i].covers);
	}
	eco_model_free(&model);
	edge_count = 0;
	return sum;
}

static struct eco_building house(uint32_t first, double height_m)
{
	return (struct eco_building){ .edges = edges + first, .edge_count = edge_count - first, .base_m = 100, .height_m = height_m };
}

UNIT_TEST(a_wall_of_several_buildings_is_drawn_once)
{
	uint32_t twins;
	struct eco_building all[3];
	/* a party wall of 8 m, of the second building from 2 to 10 m along its side: the lower one has no wall there */
	box(0, 0, 10, 8);
	all[0] = house(0, 9);
	box(10, -2, 6, 12);
	all[1] = house(4, 6);
	double both = 9.5 * 36 + 6.5 * (36 - 8);
	assert_true(fabs(walls_of(all, 2, &twins) - both) < 1e-3 && twins == 0);
	/* the taller has all of its own, whatever the order */
	box(10, -2, 6, 12);
	all[0] = house(0, 6);
	box(0, 0, 10, 8);
	all[1] = house(4, 9);
	assert_true(fabs(walls_of(all, 2, &twins) - both) < 1e-3 && twins == 0);
	/* a part within a whole, as high: the whole's walls; its roof is lower by centimetres */
	box(0, 0, 10, 8);
	all[0] = house(0, 9);
	box(0, 0, 4, 8);
	all[1] = house(4, 9);
	assert_true(fabs(walls_of(all, 2, &twins) - 9.5 * 36 - 9.45 * 8) < 1e-3 && twins == 0);
	/* twins; turned, and from another corner */
	for (uint32_t i = 0; i < 3; i++) {
		if (i < 2)
			box(0, 0, 10, 8);
		else
			ring((const double[][2]){ { 10, 8 }, { 10, 0 }, { 0, 0 }, { 0, 8 } }, 4);
		all[i] = house(4 * i, 9);
	}
	walls_of(all, 3, &twins);
	assert_int_equal(twins, 2);
	/* a gable is no wall below it, so both stay */
	box(0, 0, 10, 8);
	all[0] = house(0, 9);
	box(10, 0, 10, 8);
	all[1] = house(4, 9);
	all[0].roof = all[1].roof = ECO_ROOF_GABLED;
	all[1].height_m = 8;
	walls_of(all, 2, &twins);
	assert_true(all[0].cover_count == 0 && all[1].cover_count == 0 && twins == 0);
}

UNIT_TEST(many_copies_of_a_building_have_few_covers)
{
	enum { COPIES = 3000 };
	FREED_MEMORY struct eco_building *copies = calloc(COPIES, sizeof *copies);
	FREED_MEMORY struct eco_building **all = calloc(COPIES, sizeof *all);
	uint64_t covers = 0, twins = 0;
	edge_count = 0;
	box(0, 0, 10, 8);
	for (uint32_t i = 0; i < COPIES; i++) {
		copies[i] = house(0, 9);
		all[i] = &copies[i];
	}
	eco_buildings_cover(all, COPIES);
	for (uint32_t i = 0; i < COPIES; i++) {
		covers += copies[i].cover_count;
		twins += copies[i].twin;
		assert_true(copies[i].cover_count <= 1024);
		free(copies[i].covers);
	}
	assert_true(twins == COPIES - 1 && covers > 0);
	edge_count = 0;
}

UNIT_TEST(forms_of_roofs_are_told_by_words)
{
	const struct {
		const char *text;
		enum eco_roof roof;
	} told[] = { { "gabled", ECO_ROOF_GABLED }, { "Satteldach", ECO_ROOF_GABLED },
		{ "half-hipped", ECO_ROOF_HIPPED }, { "3200", ECO_ROOF_HIPPED }, { "flat", ECO_ROOF_FLAT },
		{ "1000", ECO_ROOF_FLAT }, { "pyramidal", ECO_ROOF_PYRAMIDAL }, { "skillion", ECO_ROOF_SHED },
		{ "onion", ECO_ROOF_COUNT }, { "", ECO_ROOF_COUNT } };
	for (size_t i = 0; i < sizeof told / sizeof *told; i++)
		assert_int_equal(eco_roof_of(told[i].text), told[i].roof);
}

UNIT_MAIN(NULL, NULL)
