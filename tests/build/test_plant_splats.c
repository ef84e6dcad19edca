/* Splats in a plant: they have the colours that were fitted, whatever colours the plant's parts have. */

#include <stdlib.h>

#include "lod/build/splat/splat_fit.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

#define MOST 16u
#define VIEWS 12u                /* as a draft has them */
#define PIXELS 48u

static const struct lod_plant_options draft = { .name = "p", .seed = 1, .order = LOD_ORDER_STOCHASTIC,
	.grid_bits = 12, .views = 3, .pixels = 48 };

static void build(struct lod_plant *plant, const struct soup *soup)
{
	struct eco_error error = { 0 };
	assert_ok(lod_plant_build(plant, &soup->model, &draft, &error), error);
	assert_ok(lod_plant_measure(plant, &soup->model, &draft, &error), error);
}

/* The list of splats, which comes last; its colours lie behind those of the other lists. */
static const struct lod_list_draft *splats_of(const struct lod_plant *plant)
{
	const struct lod_list_draft *last = &plant->lists[plant->list_count - 1];
	assert_true(last->list.attributes & ECO_ATTR_SPLAT);
	assert_in_range(last->list.palette_count, 1, MOST);
	assert_int_equal(last->list.palette_first + last->list.palette_count, plant->palette_count);
	for (uint32_t i = 0; i + 1 < plant->list_count; i++)
		assert_true(plant->lists[i].list.palette_first + plant->lists[i].list.palette_count
			<= last->list.palette_first);
	return last;
}

static const uint8_t *color_of(const struct lod_plant *plant, const struct lod_list_draft *draft_list,
	uint32_t splat)
{
	const struct eco_elements *e = &draft_list->elements;
	uint32_t color = (uint32_t)e->extra[(size_t)e->extra_count * splat];
	assert_true(color < draft_list->list.palette_count);
	return plant->palette[draft_list->list.palette_first + color];
}

/* Mean distance of a channel from the splats as they are fitted. */
static double mean_error(const struct lod_plant *plant, const struct soup *soup)
{
	const struct lod_list_draft *list = splats_of(plant);
	struct lod_splats fitted;
	struct eco_error error = { 0 };
	double sum = 0;
	assert_ok(lod_splats_fit(&fitted, &soup->model,
		&(struct lod_splats_options){ .views = VIEWS, .pixels = PIXELS }, &error), error);
	uint32_t count = fitted.level_end[fitted.level_count - 1];
	assert_int_equal(count, list->elements.element_count);
	for (uint32_t i = 0; i < count; i++)
		for (int k = 0; k < 3; k++)
			sum += abs(color_of(plant, list, i)[k] - fitted.items[i].rgb[k]);
	lod_splats_free(&fitted);
	return sum / (3.0 * count);
}

/* Green leaves and white blossoms: a splat's mean of them is far from both. */
UNIT_TEST(mixed_colours_are_kept)
{
	for (int blossoms = 0; blossoms <= 300; blossoms += 300) {
		struct soup soup;
		struct lod_plant plant;
		soup_begin(&soup);
		soup.state = 11;
		uint32_t green = soup_material(&soup, 40, 110, 20, ECO_NONE, false),
			white = soup_material(&soup, 250, 245, 255, ECO_NONE, false);
		soup_leaves(&soup, green, 300, (struct lod_v3){ 0, 0, 3 }, 1.5, 0.3);
		soup_leaves(&soup, white, blossoms, (struct lod_v3){ 0, 0, 3.2 }, 1.5, 0.2);
		build(&plant, &soup);
		double error = mean_error(&plant, &soup);
		if (error > 6)
			fail_msg("%d blossoms: splats are %.2f off", blossoms, error);
		lod_plant_free(&plant);
		soup_free(&soup);
	}
}

/* A mesh without a colour in its file is drawn in its organ's: in splats, too. */
UNIT_TEST(splats_of_colourless_models_are_not_grey)
{
	struct soup soup;
	struct lod_plant plant;
	soup_tree(&soup, 300, 0, false);
	for (uint32_t i = 0; i < soup.model.material_count; i++) {
		memset(soup.model.materials[i].rgb, 153, 3);
		soup.model.materials[i].colourless = true;
	}
	build(&plant, &soup);
	const struct lod_list_draft *list = splats_of(&plant);
	for (uint32_t i = 0; i < list->elements.element_count; i++) {
		const uint8_t *rgb = color_of(&plant, list, i);
		assert_false(rgb[0] == rgb[1] && rgb[1] == rgb[2]);
		assert_true(rgb[0] > rgb[2]);            /* brown to green */
	}
	lod_plant_free(&plant);
	soup_free(&soup);
}

/* A beginning of a level is drawn alone, and fetched without the rest: no chunk but the first is more than a
 * quarter of its level and of 96 splats. Chunks end where levels do. */
UNIT_TEST(a_part_of_a_level_is_fetched_in_part)
{
	struct soup soup;
	struct lod_plant plant;
	soup_tree(&soup, 3000, 0, false);
	build(&plant, &soup);
	const struct lod_list_draft *list = splats_of(&plant);
	const struct eco_ladder *ladder = &plant.ladders[plant.ladder_count - 1];
	uint32_t i = 0, first = 0;
	assert_true(ladder->flags & ECO_LADDER_WHOLE);
	for (uint32_t level = 0; level < ladder->level_count; level++) {
		uint32_t end = ladder->level_end[level],
			size = end - (level ? ladder->level_end[level - 1] : 0);
		for (; i < list->end_count && list->ends[i] <= end; first = list->ends[i++])
			assert_true(!first || list->ends[i] - first < 96
				|| list->ends[i] - first <= size / 4);
		assert_true(end <= 16 || first == end);
	}
	assert_int_equal(i, list->end_count);
	assert_true(ladder->level_end[ladder->level_count - 1] > 500 && list->end_count > 8);
	lod_plant_free(&plant);
	soup_free(&soup);
}

int main(void)
{
	return unit_tests_run(NULL, NULL);
}
