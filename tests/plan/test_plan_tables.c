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
