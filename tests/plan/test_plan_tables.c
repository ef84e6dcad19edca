/* The planner's tables of a scene: with them it gives the same answers as without, whoever asks first. */
#include <pthread.h>

#include "lod/plan/planner.h"
#include "lod/plan/plan_tables.h"
#include "tests/support/plan_twin.h"
#include "tests/support/scene_random.h"
#include "tests/support/unit_test.h"
#include "tests/support/wire_random.h"

static struct scene_builder scene;

/* Its simple twin walks along the curve for each question. */
UNIT_TEST(kept_ways_answer_as_walks_do)
{
	uint64_t asked = 0;
	for (uint64_t seed = 1; seed <= 40; seed++) {
		struct lod_plan_tables *tables;
		random_scene_make(&scene, seed, 0);
		assert_false(lod_plan_tables_make(&tables, &scene.scene, NULL));
		for (uint32_t l = 0; l < scene.scene.ladder_count; l++) {
			const struct lod_way *way = &lod_plan_tables_ladder(tables, l)->way;
			struct lod_way walk;
			lod_way_begin(&walk, &scene.scene, &scene.ladders[l]);
			assert_true(way->full == walk.full);
			assert_true(lod_way_stage_end(way) == lod_way_stage_end(&walk));
			for (uint64_t v = 0; v <= way->full + 2; v += 1 + v / 40, asked++) {
				uint64_t floor = lod_way_floor(way, v);
				double share = random_real(&scene, -0.1, 1.1);
				assert_true(floor == lod_way_floor(&walk, v));
				assert_true(lod_way_next(way, v) == lod_way_next(&walk, v));
				assert_true(lod_way_share(way, floor) == lod_way_share(&walk, floor));
				assert_true(lod_way_density(way, floor) == lod_way_density(&walk, floor));
				assert_true(lod_way_vertices(way, share) == lod_way_vertices(&walk, share));
			}
		}
		lod_plan_tables_free(tables);
	}
	assert_true(asked > 10000);
}

UNIT_TEST(plans_are_the_same_with_tables_as_without)
{
	static lod_rule *rules[] = { lod_rule_optimal, lod_rule_deussen };
	for (uint64_t seed = 1; seed <= 30; seed++) {
		struct lod_plan_tables *tables;
		random_scene_make(&scene, seed, seed % 2);
		assert_false(lod_plan_tables_make(&tables, &scene.scene, NULL));
		for (int i = 0; i < 6; i++) {
			const struct eco_request request = { .view = random_view(&scene),
				.vertices = 1u << random_below(&scene, 14), .bytes = ECO_BYTES_UNBOUNDED };
			struct lod_planner_input input = { .scene = &scene.scene, .request = &request,
				.rule = rules[i % 2] };
			struct eco_plan with, without;
			plan_make(&without, input);
			input.tables = tables;
			plan_make(&with, input);
			assert_same_plan(&with, &without);
			eco_plan_free(&with);
			eco_plan_free(&without);
		}
		lod_plan_tables_free(tables);
	}
}

#define THREADS 4u
#define LADDERS_MOST 512u

/* A crown is that of leaves, however wood lies; wood below it is the stem. The plant is 12 m high, its leaves lie from
 * 4 m on in two cells, and a cell below has all of its wood. */
UNIT_TEST(a_crown_is_of_leaves_and_stands_on_its_stem)
{
	static const struct { float z, radius, leaves, wood; } cells[] = { { 2, 3.4641f, 0, 5.0265f }, { 6, 3.4641f, 80, 0 },
		{ 10, 3.4641f, 80, 0 } };
	struct scene_builder b = { .state = 0 };
	struct lod_plan_tables *tables;
	uint32_t plant = scene_add_plant(&b, (struct eco_plant){ .height_m = 12, .area = 165 }),
		anchor = scene_add_anchor(&b, (struct eco_anchor){ { 0, 0, 6 }, 6.5f });
	for (int i = -1; i < 3; i++) {
		if (i >= 0)
			anchor = scene_add_anchor(&b, (struct eco_anchor){ { 0, 0, cells[i].z }, cells[i].radius });
		for (int wood = 0; wood < 2; wood++) {
			struct eco_ladder l = scene_ladder(plant, anchor, wood ? ECO_ORGAN_WOOD : ECO_ORGAN_FOLIAGE);
			l.area = i < 0 ? wood ? 5 : 160 : wood ? cells[i].wood : cells[i].leaves;
			if (l.area > 0)
				scene_add_ladder(&b, l);
		}
	}
	assert_false(lod_plan_tables_make(&tables, &b.scene, NULL));
	const struct lod_proxy_shape *shape = lod_plan_tables_proxy_shapes(tables);
	double foot = shape->rise - shape->crown_up + shape->up;
	assert_float_equal(shape->rise, 2, 1e-3);
	assert_float_equal(shape->leaf_area, 160, 1e-3);
	assert_true(foot > 1.5 && foot < 4);
	/* its cylinder, as far as it stands below the crown, of 20 cm across */
	assert_float_equal(shape->stem, 0.2, 0.03);
	lod_plan_tables_free(tables);
	scene_free(&b);
}

struct asker { struct lod_plan_tables *tables; const struct lod_plan_tables_ladder *found[LADDERS_MOST]; };

static void *ask_all(void *ctx)
{
	struct asker *asker = ctx;
	for (uint32_t l = 0; l < scene.scene.ladder_count; l++)
		asker->found[l] = lod_plan_tables_ladder(asker->tables, l);
	return NULL;
}

UNIT_TEST(threads_that_ask_at_a_time_are_given_the_same)
{
	static struct asker askers[THREADS];
	pthread_t threads[THREADS];
	struct lod_plan_tables *tables;
	random_scene_make(&scene, 3, 0);
	assert_true(scene.scene.ladder_count <= LADDERS_MOST);
	assert_false(lod_plan_tables_make(&tables, &scene.scene, NULL));
	for (uint32_t i = 0; i < THREADS; i++) {
		askers[i].tables = tables;
		assert_false(pthread_create(&threads[i], NULL, ask_all, &askers[i]));
	}
	for (uint32_t i = 0; i < THREADS; i++)
		pthread_join(threads[i], NULL);
	for (uint32_t l = 0; l < scene.scene.ladder_count; l++)
		for (uint32_t i = 0; i < THREADS; i++)
			assert_ptr_equal(askers[i].found[l], lod_plan_tables_ladder(tables, l));
	lod_plan_tables_free(tables);
}
