/* A plant's ladders for more and more vertices, on views that took no part in making lists and curves: no
 * fewer right pixels for more vertices, and the scale of the curve is about the best. */

#include "lod/ladder.h"
#include "lod/build/plant.h"
#include "lod/build/measure/probe.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

#define VIEWS 7u                 /* none of the curves' */
#define PIXELS 128u
#define LITTLE 0.0125            /* of Q */

static const struct { const char *what; uint32_t leaves; bool textured; double from; } crowns[] = {
	{ "solid leaves", 900, false, 0.005 }, { "leaves cut out of quads", 700, true, 0.05 } };

static void make(struct lod_plant *plant, struct lod_probe *probe, struct soup *soup, uint32_t leaves,
	bool textured)
{
	struct eco_error error = { 0 };
	const struct lod_plant_options options = { .name = "crown", .grid_bits = 14, .pixels = PIXELS,
		.cell_triangles = UINT32_MAX };
	soup_tree(soup, leaves, 0, textured);
	if (lod_plant_build(plant, &soup->model, &options, &error)
			|| lod_plant_measure(plant, &soup->model, &options, &error)
		|| lod_probe_init(probe, plant, &soup->model,
		&(struct lod_probe_options){ .views = VIEWS, .pixels = PIXELS }, &error))
		fail_msg("%s", error.text);
}

static double quality(struct lod_probe *probe, const struct lod_way *way, uint64_t vertices,
	double factor, bool keep)
{
	struct eco_error error = { 0 };
	struct lod_probe_result result;
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
	uint32_t count = lod_way_cuts(way, vertices, lod_way_density(way, vertices), 0, cuts);
	lod_probe_clear(probe);
	for (uint32_t i = 0; i < count; i++) {
		cuts[i].scale *= (float)factor;
		assert_int_equal(lod_probe_add(probe, &cuts[i], &error), ECO_OK);
	}
	if (keep)
		assert_true(lod_probe_keep(probe));
	lod_probe_compare(probe, 1, &result);
	return 1 - result.loss;
}

static const struct eco_ladder *leaves_of(const struct lod_plant *plant)
{
	uint32_t i = 0;
	while (plant->ladders[i].organ != ECO_ORGAN_FOLIAGE || (plant->ladders[i].flags & ECO_LADDER_FAR))
		assert_true(++i < plant->ladder_count);
	return &plant->ladders[i];
}

UNIT_TEST(more_vertices_are_no_worse_and_the_scale_is_about_the_best)
{
	for (size_t c = 0; c < sizeof crowns / sizeof *crowns; c++) {
		struct soup soup;
		struct lod_plant plant;
		struct lod_probe probe;
		make(&plant, &probe, &soup, crowns[c].leaves, crowns[c].textured);
		struct lod_way way;
		lod_way_begin(&way, &probe.scene, leaves_of(&plant));
		double best = quality(&probe, &way, way.full, 1, true) - 1;
		for (double share = crowns[c].from; share < 1; share *= 1.1) {
			uint64_t vertices = lod_way_floor(&way, (uint64_t)(share * (double)way.full));
			double q = quality(&probe, &way, vertices, 1, false);
			for (int turn = -1; turn <= 1; turn += 2) {
				double other = quality(&probe, &way, vertices, turn < 0 ? 0.7 : 1.4, false);
				if (other > q + LITTLE)
					fail_msg("%s, %.4f of all vertices: Q %.4f, with another scale %.4f",
						crowns[c].what, share, q, other);
			}
			if (q < best - LITTLE)
				fail_msg("%s: Q %.4f at %.4f of all vertices, but %.4f with fewer",
					crowns[c].what, q, share, best);
			best = q > best ? q : best;
		}
		lod_probe_free(&probe);
		lod_plant_free(&plant);
		soup_free(&soup);
	}
}
