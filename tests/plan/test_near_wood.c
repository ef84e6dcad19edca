/* An eye at a trunk is sent more of it: of equal budgets, wood has a greater share near by than from afar.
 * The test fails where organs have the shares of a far view. */
#include "lod/plan/planner.h"
#include "tests/support/scene_builder.h"
#include "tests/support/unit_test.h"

#define HEIGHT 12.0

static struct scene_builder scene;
static uint32_t wood_list;

static uint32_t add_ladder(uint32_t plant, uint32_t anchor, uint32_t organ, float area)
{
	const uint32_t count = 3000;
	struct eco_ladder l = scene_ladder(plant, anchor, organ);
	l.area = area;
	l.length = 20;
	l.total = count;
	l.curve_first = scene.scene.curve_count;
	l.curve_count = sizeof scene_falling / sizeof *scene_falling;
	l.triangles = scene_add_bare(&scene, &(struct scene_row){ ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, 0,
		plant, ECO_NONE, 0, 0 }, 2 * count, count);
	for (uint32_t i = 0; i < l.curve_count; i++)
		scene_add_curve(&scene, scene_falling[i]);
	scene_add_ladder(&scene, l);
	return l.triangles;
}

static int tree_make(void **state)
{
	(void)state;
	scene = (struct scene_builder){ .scene.near_m = 0.1,
		.like = { .grid_step = { 1e-3, 1e-3, 1e-3 }, .unit_area = 1e-3f } };
	uint32_t plant = scene_add_plant(&scene, (struct eco_plant){ .height_m = HEIGHT, .area = 220 }),
		anchor = scene_add_anchor(&scene, (struct eco_anchor){ { 0, 0, HEIGHT / 2 }, 7 });
	add_ladder(plant, anchor, ECO_ORGAN_FOLIAGE, 200);
	wood_list = add_ladder(plant, anchor, ECO_ORGAN_WOOD, 20);
	scene_add_tile(&scene, (struct eco_tile){ .low = { -5, -5, 0 }, .high = { 5, 5, HEIGHT },
		.summary = ECO_NONE, .instance_count = 1, .area = 220 });
	uint32_t list = scene_add_bare(&scene, &(struct scene_row){ ECO_LIST_INSTANCES, ECO_CODER_ROWS, 0, 0,
		ECO_NONE, 0, 0 }, 1, 1);
	scene_add_group(&scene, (struct eco_group){ 0, plant, list, scene.scene.place_count, 0, 0 });
	scene_add_place(&scene, (struct eco_place){ { 0, 0, 0 }, 0, 65536 });
	return 0;
}

static int tree_free(void **state)
{
	(void)state;
	scene_free(&scene);
	return 0;
}

/* Share of what is drawn that is wood, from so many metres away. */
static double wood_share(double away, uint64_t vertices)
{
	struct eco_request request = { .view = { .eye = { 0, -away, 1.7 }, .target = { 0, 0, 1.7 },
		.up = { 0, 0, 1 }, .fov_y_deg = 60, .width = 800, .height = 600 }, .vertices = vertices,
		.bytes = ECO_BYTES_UNBOUNDED };
	struct lod_planner_input input = { .scene = &scene.scene, .request = &request, .rule = lod_rule_optimal };
	struct eco_error error = { 0 };
	struct eco_plan plan;
	assert_ok(lod_plan(&plan, &input, &error), error);
	uint64_t all = plan.vertices, wood = 0;
	for (uint32_t i = 0; i < plan.cut_count; i++)
		wood += plan.cuts[i].list == wood_list ? plan.cuts[i].end - plan.cuts[i].first : 0;
	eco_plan_free(&plan);
	assert_true(all > vertices / 2 && all <= vertices);
	return 6.0 * (double)wood / (double)all;         /* two triangles each */
}

UNIT_TEST_BETWEEN(who_stands_at_a_trunk_is_sent_more_of_it, tree_make, tree_free)
{
	double far = 0, near = 0;
	for (uint64_t vertices = 1500; vertices <= 15000; vertices += 1500) {
		double far_share = wood_share(60, vertices), near_share = wood_share(2.5, vertices);
		assert_true(near_share >= far_share);
		far += far_share;
		near += near_share;
	}
	assert_true(far > 0 && near > 1.5 * far);
}
