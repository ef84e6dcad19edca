/* The curve of a plant's splats. */
#include "lod/build/measure/curve.h"
#include "lod/build/measure/probe.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

/* small pictures: a draft */
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
	assert_ok(lod_plant_build(&plant, &soup.model, &quick, &error), error);
	assert_ok(lod_plant_measure(&plant, &soup.model, &quick, &error), error);
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
