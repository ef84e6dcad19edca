/* Importance (Deussen 2002, 4.3 and 6.2): an important ladder keeps more of its elements at an equal budget,
 * and its share grows with its importance. Both rules are asked. The tests fail when either takes all ladders
 * for equally important; and where organs near by have the shares of a far view. */
#include <stdlib.h>

#include "lod/plan/planner.h"
#include "tests/support/plan_twin.h"
#include "tests/support/scene_builder.h"
#include "tests/support/unit_test.h"

#define SIDE 8u                  /* places along a side of the stand */
#define PLACE_M 6.0
#define SPECIES 2u

enum { LEAVES, FLOWERS, LADDERS };

static struct scene_builder scene;
static uint32_t ladder_of_list[4 * LADDERS * SPECIES];
static lod_rule *const rules[] = { lod_rule_optimal, lod_rule_deussen };

/* ---- A stand of two species in turn, each with many leaves and a few flowers, in tables ---- */

static struct eco_ladder *add_ladder(uint32_t plant, uint32_t anchor, enum eco_organ organ, uint32_t count,
	float area)
{
	struct eco_ladder l = scene_ladder(plant, anchor, organ);
	l.area = area;
	l.length = 20;
	l.total = count;
	l.curve_first = scene.scene.curve_count;
	l.curve_count = sizeof scene_falling / sizeof *scene_falling;
	l.triangles = scene_add_bare(&scene, &(struct scene_row){ ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, 0, plant,
		ECO_NONE, 0, 0 }, 2 * count, count);
	ladder_of_list[l.triangles] = scene.scene.ladder_count;
	for (uint32_t i = 0; i < l.curve_count; i++)
		scene_add_curve(&scene, scene_falling[i]);
	scene_add_ladder(&scene, l);
	return &scene.ladders[scene.scene.ladder_count - 1];
}

/* Points of a ladder's triangles. */
static void add_points(struct eco_ladder *l, uint32_t plant)
{
	l->points = scene_add_bare(&scene, &(struct scene_row){ ECO_LIST_POINTS, ECO_CODER_FORM, 0, plant,
		l->triangles, 0, 0 }, l->total, l->total);
	ladder_of_list[l->points] = ladder_of_list[l->triangles];
}

static void add_species(void)
{
	uint32_t plant = scene_add_plant(&scene, (struct eco_plant){ .height_m = 6, .area = 60 });
	uint32_t anchor = scene_add_anchor(&scene, (struct eco_anchor){ { 0, 0, 3 }, 3 });
	add_points(add_ladder(plant, anchor, ECO_ORGAN_FOLIAGE, 4000, 50), plant);
	add_points(add_ladder(plant, anchor, ECO_ORGAN_FLOWER, 1000, 10), plant);
}

/* Every second place of a square, in turn with the other species. */
static void add_places(uint32_t plant, uint32_t side)
{
	uint32_t count = side > 1 ? side * side / SPECIES : 1;
	uint32_t list = scene_add_bare(&scene, &(struct scene_row){ ECO_LIST_INSTANCES, ECO_CODER_ROWS, 0, 0,
		ECO_NONE, 0, 0 }, count, count);
	scene_add_group(&scene, (struct eco_group){ 0, plant, list, scene.scene.place_count, 0, 0 });
	for (uint32_t i = 0; i < side * side; i++)
		if ((i % side + i / side) % SPECIES == plant)
			scene_add_place(&scene, (struct eco_place){ { (int32_t)(1000 * PLACE_M * (i % side)),
				(int32_t)(1000 * PLACE_M * (i / side)), 0 }, 0, 65536, 0, 0 });
}

static const struct scene_builder nothing = { .scene.near_m = 0.1,
	.like = { .grid_step = { 1e-3, 1e-3, 1e-3 }, .unit_area = 1e-3f } };

static int stand_make(void **state)
{
	double size = SIDE * PLACE_M;
	scene = nothing;
	for (uint32_t i = 0; i < SPECIES; i++)
		add_species();
	scene_add_tile(&scene, (struct eco_tile){ .low = { -3, -3, 0 }, .high = { size + 3, size + 3, 6 },
		.summary = ECO_NONE, .instance_count = SIDE * SIDE, .area = 60.0 * SIDE * SIDE });
	for (uint32_t i = 0; i < SPECIES; i++)
		add_places(i, SIDE);
	return 0;
}

static int stand_free(void **state)
{
	scene_free(&scene);
	return 0;
}

#define IMPORTANCE_TEST(name) UNIT_TEST_BETWEEN(name, stand_make, stand_free)

/* ---- Shares of a plan ---- */

static struct eco_view view_of(const double eye[3], const double target[3])
{
	return (struct eco_view){ .eye = { eye[0], eye[1], eye[2] }, .target = { target[0], target[1], target[2] },
		.up = { 0, 0, 1 }, .fov_y_deg = 60, .width = 800, .height = 600 };
}

/* The share of the budget that the lists of these ladders take: of ladder i where bit i is set. */
static double share_of(lod_rule *rule, const struct eco_view *view, uint64_t vertices, unsigned ladders)
{
	struct eco_request request = { .view = *view, .vertices = vertices, .bytes = ECO_BYTES_UNBOUNDED };
	struct eco_plan plan, part;
	plan_make(&plan, (struct lod_planner_input){ .scene = &scene.scene, .request = &request, .rule = rule });
	assert_true(plan.vertices <= vertices);
	part = plan;
	part.cut_count = 0;
	part.cuts = calloc(plan.cut_count + 1, sizeof *part.cuts);
	assert_non_null(part.cuts);
	for (uint32_t i = 0; i < plan.cut_count; i++)
		if (ladders >> ladder_of_list[plan.cuts[i].list] & 1)
			part.cuts[part.cut_count++] = plan.cuts[i];
	uint64_t drawn = plan_twin_vertices(&scene.scene, &part, view, NULL);
	free(part.cuts);
	eco_plan_free(&plan);
	return (double)drawn / (double)vertices;
}

/* The sum over the stand in view. */
static double stand_share(lod_rule *rule, uint64_t vertices, unsigned ladders)
{
	double size = SIDE * PLACE_M;
	struct eco_view view = view_of((double[]){ size / 2, -0.6 * size, 0.5 * size },
		(double[]){ size / 2, size / 2, 0 });
	return share_of(rule, &view, vertices, ladders);
}

/* Sets the importance of these ladders, and leaves the others' at 1. */
static void set_importance(unsigned ladders, float importance)
{
	for (uint32_t i = 0; i < LADDERS * SPECIES; i++)
		scene.ladders[i].importance = ladders >> i & 1 ? importance : 1;
}

/* The share never falls as importance grows; at eight times the importance it is more than `more` times as
 * large, at an eighth of it less than half as large. */
static void check_growth(unsigned ladders, double more)
{
	static const float importances[] = { 0.125f, 0.25f, 0.5f, 1, 2, 4, 8 };
	static const uint64_t budgets[] = { 10000, 40000, 120000 };
	for (int r = 0; r < 2; r++)
		for (int b = 0; b < 3; b++) {
			double last = 0, first = 1, neutral = 0;
			for (int i = 0; i < 7; i++) {
				set_importance(ladders, importances[i]);
				double share = stand_share(rules[r], budgets[b], ladders);
				assert_true(share >= last);
				last = share;
				first = i == 0 ? share : first;
				neutral = importances[i] == 1 ? share : neutral;
			}
			assert_true(last > more * neutral && first < 0.5 * neutral);
		}
}

/* ---- The tests ---- */

/* An organ of all species, one ladder as that of a part that a rule names, a species as of an eco file. */
IMPORTANCE_TEST(important_organs_parts_and_species_keep_more_of_their_elements)
{
	check_growth(1u << FLOWERS | 1u << (LADDERS + FLOWERS), 1.5);
	check_growth(1u << FLOWERS, 1.5);
	check_growth(1u << LEAVES | 1u << FLOWERS, 1.3);
}

IMPORTANCE_TEST(plants_that_are_all_as_important_share_alike)
{
	double share = stand_share(lod_rule_optimal, 40000, 1u << LEAVES | 1u << FLOWERS);
	assert_true(share > 0.4 && share < 0.6);
	for (int i = 0; i < LADDERS * (int)SPECIES; i++)
		scene.ladders[i].importance = 5;
	double scaled = stand_share(lod_rule_optimal, 40000, 1u << LEAVES | 1u << FLOWERS);
	assert_true(scaled > share - 0.01 && scaled < share + 0.01);
}

/* An eye at a trunk is sent more of it: of equal budgets, wood has a greater share near by than from afar. */
UNIT_TEST_BETWEEN(near_a_trunk_there_is_more_of_it, NULL, stand_free)
{
	const double height = 12;
	double sum[2] = { 0 };
	scene = nothing;
	uint32_t plant = scene_add_plant(&scene, (struct eco_plant){ .height_m = (float)height, .area = 220 }),
		anchor = scene_add_anchor(&scene, (struct eco_anchor){ { 0, 0, (float)height / 2 }, 7 });
	add_ladder(plant, anchor, ECO_ORGAN_FOLIAGE, 3000, 200);
	add_ladder(plant, anchor, ECO_ORGAN_WOOD, 3000, 20);
	scene_add_tile(&scene, (struct eco_tile){ .low = { -5, -5, 0 }, .high = { 5, 5, height },
		.summary = ECO_NONE, .instance_count = 1, .area = 220 });
	add_places(plant, 1);
	for (uint64_t vertices = 1500; vertices <= 15000; vertices += 1500) {
		double share[2];
		for (int near = 0; near < 2; near++) {
			struct eco_view view = view_of((double[]){ 0, near ? -0.8 : -60, 1.7 }, (double[]){ 0, 0, 1.7 });
			share[near] = share_of(lod_rule_optimal, &view, vertices, 1u << 1);
			sum[near] += share[near];
		}
		assert_true(share[1] >= share[0]);
	}
	assert_true(sum[0] > 0 && sum[1] > 1.5 * sum[0]);
}
