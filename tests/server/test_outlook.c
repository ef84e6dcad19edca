/* The first look at a scene: all of a small one; of a wide one a part where plants stand, also within what is
 * placed in it. */
#include <math.h>

#include "server/store.h"
#include "tests/support/scene_builder.h"
#include "tests/support/unit_test.h"

#define HEIGHT_M 6

static struct scene_builder scene;

static int scene_begin(void **state)
{
	scene = (struct scene_builder){ .like = { .grid_step = { 1, 1, 1 } } };
	scene_add_plant(&scene, (struct eco_plant){ .height_m = HEIGHT_M });
	return 0;
}

static int scene_end(void **state)
{
	scene_free(&scene);
	return 0;
}

#define OUTLOOK_TEST(name) UNIT_TEST_BETWEEN(name, scene_begin, scene_end)

static uint32_t add_tile(double x, double y, double width, uint32_t plants)
{
	return scene_add_tile(&scene, (struct eco_tile){ .low = { x, y, 0 }, .high = { x + width, y + width, 9 },
		.summary = ECO_NONE, .instance_count = plants });
}

/* `rows` rows of as many plants of twice their size, `apart` metres. */
static void add_stand(uint32_t tile, int x, int y, int side, int apart)
{
	uint32_t count = (uint32_t)(side * side), list = scene_add_bare(&scene,
		&(struct scene_row){ ECO_LIST_INSTANCES, ECO_CODER_ROWS, 0, 0, ECO_NONE, 0, 0 }, count, count);
	scene_add_group(&scene, (struct eco_group){ tile, 0, list, scene.scene.place_count, 0, 0 });
	for (int i = 0; i < side * side; i++)
		scene_add_place(&scene, (struct eco_place){ { x + i % side * apart, y + i / side * apart, 3 },
			0, 2 << 16, 0, 0 });
}

static void assert_look(const double low[3], const double high[3])
{
	struct srv_outlook found;
	assert_good(srv_outlook_find(&scene.scene, &found, &cause));
	for (int k = 0; k < 3; k++)
		assert_true(fabs(found.low[k] - low[k]) < 1e-6 && fabs(found.high[k] - high[k]) < 1e-6);
}

OUTLOOK_TEST(a_small_scene_is_looked_at_as_a_whole)
{
	uint32_t tile = add_tile(-400, 100, 1000, 104);
	add_stand(tile, -400, 100, 2, 999);
	add_stand(tile, 0, 300, 10, 5);
	assert_look((const double[]){ -400, 100, 0 }, (const double[]){ 600, 1100, 9 });
}

OUTLOOK_TEST(a_scene_without_plants_has_a_look)
{
	assert_look((const double[]){ 0, 0, 0 }, (const double[]){ 0, 0, 0 });
	add_tile(0, 0, 5000, 0);
	assert_look((const double[]){ 0, 0, 0 }, (const double[]){ 5000, 5000, 9 });
}

/* Single trees all over, and two stands: the smaller one is more than half of the other, and nearer to the
 * middle. */
OUTLOOK_TEST(a_wide_scene_is_looked_at_where_many_plants_stand)
{
	uint32_t root = add_tile(0, 0, 6000, 400 + 100 + 81 + 36), one = add_tile(0, 0, 6000, 400 + 36),
		other = add_tile(0, 0, 6000, 100 + 81);
	scene_add_child(&scene, root, (struct eco_child){ .tile = one, .scale = 1 });
	scene_add_child(&scene, root, (struct eco_child){ .tile = other, .scale = 1 });
	add_stand(one, 0, 0, 20, 310);
	add_stand(one, 3010, 3010, 6, 10);
	add_stand(other, 5210, 5210, 10, 10);
	add_stand(other, 2410, 2820, 9, 20);
	assert_look((const double[]){ 2410, 2820, 3 },
		(const double[]){ 2410 + 8 * 20, 2820 + 8 * 20, 3 + 2 * HEIGHT_M });
}

OUTLOOK_TEST(plants_that_are_alone_are_not_looked_at_from_too_near)
{
	add_stand(add_tile(0, 0, 3000, 1), 1490, 1490, 1, 1);
	assert_look((const double[]){ 1470, 1470, 3 }, (const double[]){ 1510, 1510, 15 });
}

/* A wood that is empty but for a stand is placed twice, turned by a right angle and half as large. */
OUTLOOK_TEST(a_stand_is_found_within_what_is_placed)
{
	uint32_t root = add_tile(0, 0, 9000, 2 * 51), wood = add_tile(0, 0, 4000, 51),
		quarter = add_tile(0, 0, 4000, 51);
	scene_add_child(&scene, root, (struct eco_child){ .tile = wood, .placed = true, .at = { 2000, 0, 0 },
		.turn = 16384, .scale = 0.5f });
	scene_add_child(&scene, root, (struct eco_child){ .tile = wood, .placed = true, .at = { 5000, 4000, 20 },
		.turn = 16384, .scale = 0.5f });
	scene_add_child(&scene, wood, (struct eco_child){ .tile = quarter, .scale = 1 });
	add_stand(quarter, 1010, 2010, 7, 20);
	add_stand(quarter, 3800, 100, 1, 1);
	add_stand(quarter, 100, 100, 1, 1);
	assert_look((const double[]){ 5000 - 2130 / 2.0, 4000 + 1010 / 2.0, 21.5 },
		(const double[]){ 5000 - 2010 / 2.0, 4000 + 1130 / 2.0, 21.5 + HEIGHT_M });
}
