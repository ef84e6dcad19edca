/* Splats in a plant: the colours that were fitted, chunks by level, and their curve with the impostor's. */

#include <stdlib.h>

#include "lod/build/impostor/impostor_make.h"
#include "lod/build/measure/probe.h"
#include "lod/build/splat/splat_fit.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

#define MOST 16u
#define VIEWS 12u                /* as a draft has them */
#define PIXELS 48u

static const struct lod_plant_options draft = { .name = "p", .seed = 1, .order = LOD_ORDER_STOCHASTIC,
	.grid_bits = 12, .views = 3, .pixels = 48 };

static void build_with(struct lod_plant *plant, const struct soup *soup, const struct lod_plant_options *options)
{
	struct eco_error error = { 0 };
	assert_ok(lod_plant_build(plant, &soup->model, options, &error), error);
	assert_ok(lod_plant_measure(plant, &soup->model, options, &error), error);
}

static void build(struct lod_plant *plant, const struct soup *soup) { build_with(plant, soup, &draft); }

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

/* ---- Curves ---- */

/* With cells. */
static const struct lod_plant_options quick = { .name = "tree", .grid_bits = 14, .cell_triangles = 400,
	.order = LOD_ORDER_STOCHASTIC, .views = 6, .pixels = 96 };

static const struct eco_ladder *whole_of(const struct lod_plant *plant)
{
	for (uint32_t i = 0; i < plant->ladder_count; i++)
		if (plant->ladders[i].flags & ECO_LADDER_WHOLE)
			return &plant->ladders[i];
	fail_msg("no ladder of splats");
	return NULL;
}

/* This holds for a plant with cells, too: its whole-plant lists do not stand for what the cells hold. */
UNIT_TEST(the_curve_of_splats_compares_with_the_whole_plant)
{
	struct soup soup;
	struct lod_plant plant;
	struct lod_probe probe;
	struct lod_probe_result result;
	struct eco_error error = { 0 };
	soup_tree(&soup, 3000, 0, false);
	build_with(&plant, &soup, &quick);
	assert_true(plant.plant.anchor_count > 2);
	const struct eco_ladder *whole = whole_of(&plant);
	const struct eco_curve *last = &plant.curves[whole->curve_first + whole->curve_count - 1];
	const struct lod_probe_options size = { quick.views, quick.pixels, NULL, NULL };
	assert_ok(lod_probe_init(&probe, &plant, &soup.model, &size, &error), error);
	assert_true(lod_probe_keep_model(&probe));
	uint32_t levels = whole->level_count;
	struct eco_cut all = { .list = whole->points, .first = levels > 1 ? whole->level_end[levels - 2] : 0,
		.end = whole->level_end[levels - 1], .scale = 1 };
	lod_probe_clear(&probe);
	assert_ok(lod_probe_add(&probe, &all, &error), error);
	lod_probe_compare(&probe, 1, &result);
	assert_true(last->share == 1 && result.fn > 0.001);
	double measured = (double)last->fp + (double)last->fn, drawn = result.fp + result.fn;
	assert_true(measured > 0.97 * drawn && measured < 1.03 * drawn);
	lod_probe_free(&probe);
	lod_plant_free(&plant);
	soup_free(&soup);
}

/* ---- Impostors ---- */

static void assert_sample(const struct eco_curve *sample, double share)
{
	assert_true(sample->share == (float)share && sample->scale == 1 && sample->reach == 1);
	assert_true(sample->fp >= 0 && sample->fn >= 0 && sample->fn <= 1);
	assert_in_range(1000 * ((double)sample->fp + (double)sample->fn), 0, 2000);
}

/* The error of a level as a probe measures it that draws nothing else. */
static struct lod_probe_result drawn_level(const struct lod_plant *plant, const struct soup *soup,
	const struct lod_plant_options *options, uint32_t level)
{
	const struct lod_probe_options size = { options->views, options->pixels, NULL, NULL };
	struct lod_probe probe;
	struct lod_probe_result result;
	struct lod_impostor impostor;
	struct eco_error error = { 0 };
	assert_ok(lod_probe_init(&probe, plant, &soup->model, &size, &error), error);
	assert_true(lod_probe_keep_model(&probe));
	assert_ok(lod_plant_open_impostor(&impostor, plant, level, &error), error);
	lod_probe_clear(&probe);
	lod_probe_add_impostor(&probe, &impostor);
	lod_probe_compare(&probe, 1, &result);
	lod_impostor_close(&impostor);
	lod_probe_free(&probe);
	return result;
}

static void check_samples(const struct lod_plant *plant, const struct soup *soup,
	const struct lod_plant_options *options)
{
	const struct eco_ladder *whole = whole_of(plant);
	uint32_t levels = plant->impostor_count;
	double full = whole->level_end[whole->level_count - 1]
		- (whole->level_count > 1 ? whole->level_end[whole->level_count - 2] : 0);
	assert_int_equal(whole->impostor, plant->list_count);
	assert_true(whole->curve_count > levels);
	for (uint32_t from = 0; from < eco_ladder_samples(whole); from += whole->curve_count) {
		const struct eco_curve *samples = plant->curves + whole->curve_first + from;
		for (uint32_t i = 0; i < levels; i++)
			assert_sample(&samples[i], (i + 1.0) / levels / full);
		for (uint32_t i = 1; i < whole->curve_count; i++)
			assert_true(samples[i].share > samples[i - 1].share);
		/* after them come splats: no sample of one is left */
		assert_true((double)samples[levels].share * full > 1.5);
		assert_true(samples[whole->curve_count - 1].share == 1);
	}
	for (uint32_t i = 0; i < levels; i++) {
		const struct eco_curve *sample = &plant->curves[whole->curve_first + i];
		struct lod_probe_result result = drawn_level(plant, soup, options, i);
		double measured = (double)sample->fp + (double)sample->fn, drawn = result.fp + result.fn;
		assert_true(measured > 0.99 * drawn && measured < 1.01 * drawn);
	}
}

/* A draft has two levels, a plant all. */
UNIT_TEST(the_first_samples_are_the_levels_of_the_impostor)
{
	static const uint32_t pixels[] = { 96, 160 }, levels[] = { 2, ECO_IMPOSTOR_LEVELS };
	for (int i = 0; i < 2; i++) {
		struct lod_plant_options options = quick;
		struct soup soup;
		struct lod_plant plant;
		options.pixels = pixels[i];
		soup_tree(&soup, 300, 20, false);
		build_with(&plant, &soup, &options);
		assert_int_equal(plant.impostor_count, levels[i]);
		for (uint32_t k = 0; k < plant.ladder_count; k++)
			assert_true(plant.ladders[k].flags & ECO_LADDER_WHOLE
				|| plant.ladders[k].impostor == ECO_NONE);
		check_samples(&plant, &soup, &options);
		lod_plant_free(&plant);
		soup_free(&soup);
	}
}

static void few_leaves(struct soup *soup, bool textured)
{
	soup_begin(soup);
	uint32_t leaf = soup_material(soup, 60, 150, 40, textured ? soup_disc_image(soup, 256) : ECO_NONE,
		textured);
	for (uint32_t i = 0; i < 40; i++)
		soup_leaf(soup, leaf, (struct lod_v3){ 0, 0, 0.1 * i }, 1, 0.2);
}

/* Unless the plant has a picture, which is larger still. */
UNIT_TEST(levels_larger_than_the_plant_are_left_out)
{
	struct lod_plant_options options = quick;
	uint32_t levels[2];
	options.pixels = 160;
	for (int textured = 0; textured < 2; textured++) {
		struct soup soup;
		struct lod_plant plant;
		few_leaves(&soup, textured);
		build_with(&plant, &soup, &options);
		levels[textured] = plant.impostor_count;
		for (uint32_t i = 1; i < plant.impostor_count && !textured; i++)
			assert_true(plant.impostor[i].size <= 12u * soup.model.triangle_count);
		check_samples(&plant, &soup, &options);
		lod_plant_free(&plant);
		soup_free(&soup);
	}
	assert_in_range(levels[0], 1, ECO_IMPOSTOR_LEVELS - 1);
	assert_int_equal(levels[1], ECO_IMPOSTOR_LEVELS);
}
