/* Plants with the greedy order: growth codes, simpler forms, and when the order is made. */
#include "lod/build/plant.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

#define LEAVES 200u

static struct lod_plant_options options = { .name = "test", .seed = 3, .grid_bits = 12, .views = 3,
	.pixels = 64 };

/* Leaves of two triangles; `fans`: of four. */
static void make_tree(struct soup *soup, bool fans)
{
	soup_tree(soup, LEAVES, 25, false);
	uint32_t green = soup_material(soup, 60, 150, 40, ECO_NONE, false);
	for (uint32_t i = 0; i < LEAVES && fans; i++) {
		struct lod_v3 at = { soup_random(soup, -1, 1), soup_random(soup, -1, 1),
			soup_random(soup, 2, 4) };
		soup_quad(soup, green, at, (struct lod_v3){ 0.1, 0, 0 }, (struct lod_v3){ 0, 0.1, 0.03 });
	}
}

static void build(struct lod_plant *plant, enum lod_order_method order, uint32_t bits)
{
	struct soup soup;
	struct eco_error error = { 0 };
	struct lod_plant_options o = options;
	o.order = order;
	o.grid_bits = bits;
	make_tree(&soup, false);
	assert_ok(lod_plant_build(plant, &soup.model, &o, &error), error);
	soup_free(&soup);
}

static const struct lod_list_draft *leaves_of(const struct lod_plant *plant,
	const struct lod_list_draft **simple)
{
	for (uint32_t i = 0; i < plant->ladder_count; i++)
		if (plant->ladders[i].organ == ECO_ORGAN_FOLIAGE && plant->ladders[i].triangles != ECO_NONE) {
			*simple = plant->ladders[i].simple == ECO_NONE ? NULL
				: &plant->lists[plant->ladders[i].simple];
			return &plant->lists[plant->ladders[i].triangles];
		}
	fail_msg("no leaves");
	return NULL;
}

UNIT_TEST(each_leaf_has_a_code_and_a_simpler_form)
{
	struct lod_plant plant;
	const struct lod_list_draft *simple;
	build(&plant, LOD_ORDER_GREEDY, 12);
	const struct lod_list_draft *leaves = leaves_of(&plant, &simple);
	assert_true(leaves->list.attributes & ECO_ATTR_GROWTH);
	uint32_t extra = leaves->elements.extra_count;
	for (uint32_t i = 0; i < leaves->elements.element_count; i++)
		assert_in_range(leaves->elements.extra[(size_t)extra * i + extra - 1], 0, ECO_GROWTHS - 1);
	assert_non_null(simple);
	assert_int_equal(simple->list.coder, ECO_CODER_FORM);
	assert_int_equal(&plant.lists[simple->list.partner] - leaves, 0);
	assert_int_equal(simple->elements.element_count, leaves->elements.element_count);
	assert_true(simple->elements.primitive_count < leaves->elements.primitive_count);
	for (uint32_t i = 0; i < simple->elements.element_count; i++) {
		const uint32_t s = simple->elements.extra_count;
		assert_int_equal(simple->elements.corners[i], simple->elements.corners[0]);
		assert_int_equal(simple->elements.extra[(size_t)s * i + s - 1],
			leaves->elements.extra[(size_t)extra * i + extra - 1]);
	}
	lod_plant_free(&plant);
}

UNIT_TEST(orders_differ_and_static_ones_have_neither)
{
	struct lod_plant a, b;
	const struct lod_list_draft *simple;
	build(&a, LOD_ORDER_STOCHASTIC, 12);
	for (int order = 0; order < LOD_ORDER_COUNT; order++) {
		build(&b, (enum lod_order_method)order, 12);
		const struct lod_list_draft *leaves = leaves_of(&b, &simple);
		const struct eco_elements *x = &leaves_of(&a, &(const struct lod_list_draft *){ NULL })->elements,
			*y = &leaves->elements;
		assert_int_equal(x->corner_count, y->corner_count);
		assert_true((order == LOD_ORDER_STOCHASTIC) == !memcmp(x->position, y->position,
			3 * (size_t)x->corner_count * sizeof *x->position));
		assert_true((order == LOD_ORDER_GREEDY) == !!(leaves->list.attributes & ECO_ATTR_GROWTH));
		assert_true((order == LOD_ORDER_GREEDY) == (simple != NULL));
		lod_plant_free(&b);
	}
	lod_plant_free(&a);
}

/* All that the greedy lists have but codes. */
UNIT_TEST(random_leaves_have_a_simpler_form_and_no_code)
{
	struct lod_plant plant[2];
	const struct lod_list_draft *simple[2], *greedy, *leaves[2];
	options.random_leaves = true;
	for (uint32_t i = 0; i < 2; i++) {
		options.seed = 3 + i;
		build(&plant[i], LOD_ORDER_GREEDY, 12);
		leaves[i] = leaves_of(&plant[i], &simple[i]);
		assert_non_null(simple[i]);
		assert_false(leaves[i]->list.attributes & ECO_ATTR_GROWTH);
		assert_false(simple[i]->list.attributes & ECO_ATTR_GROWTH);
	}
	options.random_leaves = false;
	options.seed = 3;
	assert_int_equal(leaves[0]->elements.corner_count, leaves[1]->elements.corner_count);
	assert_memory_not_equal(leaves[0]->elements.position, leaves[1]->elements.position,
		3 * (size_t)leaves[0]->elements.corner_count * sizeof *leaves[0]->elements.position);
	lod_plant_free(&plant[1]);
	build(&plant[1], LOD_ORDER_GREEDY, 12);
	greedy = leaves_of(&plant[1], &simple[1]);
	assert_int_equal(leaves[0]->elements.corner_count, greedy->elements.corner_count);
	assert_memory_not_equal(leaves[0]->elements.position, greedy->elements.position,
		3 * (size_t)greedy->elements.corner_count * sizeof *greedy->elements.position);
	lod_plant_free(&plant[0]);
	lod_plant_free(&plant[1]);
}

/* While the grid is still to be chosen there is a draft, which measuring replaces. */
UNIT_TEST(order_waits_for_the_grid)
{
	struct lod_plant plant;
	struct soup soup;
	struct eco_error error = { 0 };
	struct lod_plant_options o = options;
	const struct lod_list_draft *simple;
	build(&plant, LOD_ORDER_GREEDY, 0);
	assert_false(leaves_of(&plant, &simple)->list.attributes & ECO_ATTR_GROWTH);
	o.grid_bits = 0;
	make_tree(&soup, false);
	assert_int_equal(lod_plant_measure(&plant, &soup.model, &o, &error), ECO_OK);
	assert_true(leaves_of(&plant, &simple)->list.attributes & ECO_ATTR_GROWTH);
	assert_true(plant.curve_count > 0);
	soup_free(&soup);
	lod_plant_free(&plant);
}
