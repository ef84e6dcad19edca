/* Objects: whatever level of one is drawn, its walls are closed and all of its parts are there. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/generate/buildings.h"
#include "lod/build/plant.h"
#include "tests/support/unit_test.h"

#define HOUSES 24u
#define CORNERS 40u

static struct eco_edge edges[HOUSES * CORNERS];
static struct eco_model model;
static struct lod_plant plant;

/* Round houses with notches, of three forms of roofs. */
static void make_model(void)
{
	struct eco_building buildings[HOUSES];
	struct eco_buildings_notes notes = { 0 };
	for (uint32_t h = 0; h < HOUSES; h++) {
		struct eco_edge *e = edges + h * CORNERS;
		for (uint32_t i = 0; i < CORNERS; i++) {
			double turn = 6.283185307179586 * i / CORNERS, reach = i % 5 ? 6 : 5.8;
			e[i].a[0] = 20.0 * (h % 6) + reach * cos(turn);
			e[i].a[1] = 20.0 * (h / 6) + reach * sin(turn);
		}
		for (uint32_t i = 0; i < CORNERS; i++)
			memcpy(e[i].b, e[(i + 1) % CORNERS].a, sizeof e[i].b);
		buildings[h] =
			(struct eco_building){ .edges = e, .edge_count = CORNERS, .height_m = 5 + h % 4, .roof = (enum eco_roof)(h % 3) };
	}
	eco_buildings_make(&model, buildings, HOUSES, (const double[]){ 0, 0, 0 }, &notes);
}

static void build(bool measured)
{
	struct lod_plant_options options = { .name = "test",
		.seed = 1,
		.order = LOD_ORDER_COMBINED,
		.views = 3,
		.pixels = 64 };
	make_model();
	assert_good(lod_plant_build(&plant, &model, &options, &cause));
	if (measured)
		assert_good(lod_plant_measure(&plant, &model, &options, &cause));
}

static void finish(void)
{
	lod_plant_free(&plant);
	eco_model_free(&model);
}

UNIT_TEST(an_object_is_wood_in_levels_and_nothing_else)
{
	build(true);
	assert_int_equal(plant.ladder_count, 1);
	assert_int_equal(plant.plant.anchor_count, 1);
	assert_int_equal(plant.list_count, 1);
	assert_int_equal(plant.impostor_count, 0);
	const struct eco_ladder *ladder = &plant.ladders[0];
	assert_int_equal(ladder->organ, ECO_ORGAN_WOOD);
	assert_true(ladder->points == ECO_NONE && ladder->lines == ECO_NONE && ladder->simple == ECO_NONE);
	assert_int_equal(ladder->level_count, 3);
	assert_int_equal(plant.organ[ECO_ORGAN_FOLIAGE].triangles + plant.organ[ECO_ORGAN_FLOWER].triangles,
		0);
	/* curves know its levels, and the last is all of it */
	assert_int_equal(ladder->curve_count, 3);
	assert_true(plant.curves[ladder->curve_first + 2].share == 1 &&
		plant.curves[ladder->curve_first + 2].fn == 0);
	finish();
}

struct side {
	int32_t from[3], to[3];
	int count;
};
static struct side sides[3 * 40000];
static uint32_t side_count;

static int compare(const void *a, const void *b) { return memcmp(a, b, 6 * sizeof(int32_t)); }

/* Takes the sides of triangles [first, end) of a list. */
static void take_sides(uint32_t list, uint32_t first, uint32_t end)
{
	for (uint32_t t = first; t < end; t++)
		for (uint32_t k = 0; k < 3; k++) {
			const int32_t *position = plant.lists[list].elements.position,
				      *p = position + 3 * (size_t)(3 * t + k),
				      *q = position + 3 * (size_t)(3 * t + (k + 1) % 3);
			bool turned = memcmp(p, q, 3 * sizeof *p) > 0;
			struct side *side = &sides[side_count++];
			memcpy(side->from, turned ? q : p, sizeof side->from);
			memcpy(side->to, turned ? p : q, sizeof side->to);
			side->count = turned ? -1 : 1;
		}
}

/* Those of the sides taken that no other runs along in the opposite direction, but at the least z. */
static uint32_t open_sides(void)
{
	uint32_t open = 0;
	int32_t bottom = INT32_MAX;
	qsort(sides, side_count, sizeof *sides, compare);
	for (uint32_t i = 0; i < side_count; i++)
		bottom = sides[i].from[2] < bottom ? sides[i].from[2] : bottom;
	for (uint32_t i = 0, next; i < side_count; i = next) {
		int sum = 0;
		for (next = i; next < side_count && compare(&sides[i], &sides[next]) == 0; next++)
			sum += sides[next].count;
		open += sum != 0 && (sides[i].from[2] != bottom || sides[i].to[2] != bottom);
	}
	side_count = 0;
	return open;
}

/* Houses with triangles among [first, end) that reach half of their height, by their places in rows of six. */
static uint32_t houses_in(uint32_t first, uint32_t end)
{
	const struct eco_list *list = &plant.lists[0].list;
	bool found[HOUSES] = { false };
	uint32_t count = 0;
	for (uint32_t i = 3 * first; i < 3 * end; i++) {
		double at[3];
		for (int k = 0; k < 3; k++)
			at[k] = list->grid_origin[k] +
				list->grid_step[k] *
					plant.lists[0].elements.position[3 * (size_t)i + (size_t)k];
		if (at[2] > 2.5)
			found[(uint32_t)(at[0] / 20 + 0.5) + 6 * (uint32_t)(at[1] / 20 + 0.5)] = true;
	}
	for (uint32_t h = 0; h < HOUSES; h++)
		count += found[h];
	return count;
}

UNIT_TEST(an_object_without_a_simpler_level_has_one)
{
	struct lod_plant_options options = { .name = "test", .seed = 1, .views = 3, .pixels = 64 };
	const double corners[4][2] = { { 0, 0 }, { 10, 0 }, { 10, 8 }, { 0, 8 } };
	struct eco_building box = { .edges = edges, .edge_count = 4, .height_m = 6 };
	struct eco_buildings_notes notes = { 0 };
	for (uint32_t i = 0; i < 4; i++) {
		memcpy(edges[i].a, corners[i], sizeof *corners);
		memcpy(edges[i].b, corners[(i + 1) % 4], sizeof *corners);
	}
	eco_buildings_make(&model, &box, 1, (const double[]){ 0, 0, 0 }, &notes);
	assert_good(lod_plant_build(&plant, &model, &options, &cause));
	assert_good(lod_plant_measure(&plant, &model, &options, &cause));
	assert_int_equal(plant.ladders[0].level_count, 1);
	assert_int_equal(plant.ladders[0].level_end[0], 10);
	assert_int_equal(plant.ladders[0].curve_count, 1);
	finish();
}

UNIT_TEST(walls_are_closed_at_every_level)
{
	build(false);
	const struct eco_ladder *ladder = &plant.ladders[0];
	assert_int_equal(ladder->level_count, 3);
	for (uint32_t level = 0; level < 3; level++) {
		uint32_t first = level ? ladder->level_end[level - 1] : 0, end = ladder->level_end[level];
		take_sides(0, first, end);
		assert_int_equal(open_sides(), 0);
		assert_int_equal(houses_in(first, end), HOUSES);
	}
	/* each level has at most .7 of the triangles of the next */
	assert_true(ladder->level_end[0] * 10 <= (ladder->level_end[1] - ladder->level_end[0]) * 7);
	finish();
}

/* Roofs with a picture are another ladder, whose levels go with any of the walls'. */
UNIT_TEST(walls_and_textured_roofs_meet_at_every_level)
{
	struct lod_plant_options options = { .name = "test", .seed = 1, .order = LOD_ORDER_COMBINED };
	make_model();
	model.uv = eco_alloc(2 * (size_t)model.vertex_count, sizeof *model.uv);
	model.images = eco_alloc(1, sizeof *model.images);
	model.image_count = 1;
	model.images[0] = (struct eco_image){ 1, 1, memcpy(eco_alloc(1, 4), "\x80\x40\x30\xff", 4) };
	for (uint32_t i = 0; i < model.material_count; i++)
		if (strstr(model.materials[i].name, "roof"))
			model.materials[i].image = 0;
	assert_good(lod_plant_build(&plant, &model, &options, &cause));
	assert_int_equal(plant.ladder_count, 2);
	const struct eco_ladder *l = plant.ladders;
	assert_true(l[0].level_count > 0 && l[1].level_count > 0 && l[0].level_count + l[1].level_count > 2);
	for (uint32_t i = 0; i < l[0].level_count; i++)
		for (uint32_t k = 0; k < l[1].level_count; k++) {
			take_sides(l[0].triangles, i ? l[0].level_end[i - 1] : 0, l[0].level_end[i]);
			take_sides(l[1].triangles, k ? l[1].level_end[k - 1] : 0, l[1].level_end[k]);
			assert_int_equal(open_sides(), 0);
		}
	finish();
}

UNIT_MAIN(NULL, NULL)
