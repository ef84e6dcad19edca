/* Curves of crowns: their shape whatever the plant, cells that share the whole plant's, and drawings that are
 * what was measured. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/build/grid.h"
#include "lod/build/measure/curve_ways.h"
#include "lod/ladder.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

#define ROUNDED (1.0 / 1024)     /* errors have 10 bits */
#define GAP_LEAST 100.0          /* vertices: fewer are rough */

/* Made by the test under way, until finish. */
static struct soup soup;
static struct lod_plant plant;

static const struct lod_plant_options quick = { .name = "crown", .seed = 1, .order = LOD_ORDER_STOCHASTIC,
	.grid_bits = 12, .no_splats = true, .views = 8, .pixels = 128 };

/* Leaves all over a ball. */
static void make_crown(uint32_t leaves, double length)
{
	soup_begin(&soup);
	soup.state = leaves;
	soup_leaves(&soup, soup_material(&soup, 60, 150, 40, ECO_NONE, false), (int)leaves,
		(struct lod_v3){ 0, 0, 3 }, 2, length);
}

static void measure(const struct lod_plant_options *options)
{
	assert_good(lod_plant_build(&plant, &soup.model, options, &cause));
	assert_good(lod_plant_measure(&plant, &soup.model, options, &cause));
}

static void finish(void)
{
	lod_plant_free(&plant);
	soup_free(&soup);
}

static double error_of(const struct eco_curve *sample)
{
	return (double)sample->fp + sample->fn;
}

static void check_curve(const struct eco_ladder *ladder, uint32_t least)
{
	const struct eco_curve *curve = plant.curves + ladder->curve_first;
	assert_in_range(ladder->curve_count, least, LOD_CURVE_SAMPLES_MAX);
	assert_true(ladder->flags & ECO_LADDER_ABOVE);
	assert_true(ladder->curve_first + 2 * ladder->curve_count <= plant.curve_count);
	for (uint32_t i = 0; i < 2 * ladder->curve_count; i++) {
		uint32_t k = i % ladder->curve_count;            /* then seen from above, at the same shares */
		assert_true(curve[i].share == curve[k].share && curve[i].reach == curve[k].reach);
		assert_true(curve[i].share > 0 && curve[i].share <= 1);
		assert_true(curve[i].scale >= 0.25f && curve[i].scale <= 64);
		assert_true(curve[i].fp >= 0 && curve[i].fn >= 0);
		assert_true(k == 0 || (curve[i].share > curve[i - 1].share
			&& error_of(&curve[i]) <= error_of(&curve[i - 1]) * (1 + ROUNDED)));
	}
	assert_true(curve[ladder->curve_count - 1].share == 1);
	assert_int_equal(error_of(&curve[ladder->curve_count - 1]) == 0, !(ladder->flags & ECO_LADDER_FAR));
}

UNIT_TEST(curves_fall_from_one_vertex_to_all_and_wood_keeps_its_size)
{
	soup_tree(&soup, 3000, 0, false);
	struct lod_plant_options options = quick;
	uint32_t far = 0;
	options.cell_triangles = 400;
	measure(&options);
	assert_true(plant.plant.anchor_count > 2);
	for (uint32_t i = 0; i < plant.ladder_count; i++) {
		const struct eco_ladder *ladder = &plant.ladders[i];
		check_curve(ladder, 2);
		for (uint32_t k = 0; k < i; k++)
			assert_int_equal(plant.ladders[k].curve_first == ladder->curve_first,
				plant.ladders[k].organ == ladder->organ
				&& !((plant.ladders[k].flags ^ ladder->flags) & ECO_LADDER_FAR));
		for (uint32_t k = 0; k < 2 * ladder->curve_count && ladder->organ == ECO_ORGAN_WOOD; k++)
			assert_true(plant.curves[ladder->curve_first + k].scale == 1);
		far += !!(ladder->flags & ECO_LADDER_FAR);
	}
	assert_true(far > 0 && error_of(&plant.curves[plant.ladders[0].curve_first]) > 0.3);
	finish();
}

/* Adds what a ladder draws at a share, larger by a factor; cells beside a whole-plant list show as many of
 * its elements as `density` says. */
static void add_share(struct lod_probe *probe, const struct eco_ladder *ladder, double share, double density,
	double larger)
{
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
	struct lod_way way;
	lod_way_begin(&way, &probe->scene, ladder);
	uint64_t vertices = lod_way_vertices(&way, share);
	double own = lod_way_density(&way, vertices);
	uint32_t count = lod_way_cuts(&way, vertices, own > density ? own : density, 0, cuts);
	for (uint32_t i = 0; i < count; i++) {
		cuts[i].scale *= (float)larger;
		lod_probe_add(probe, &cuts[i]);
	}
}

static void open_probe(struct lod_probe *probe, uint32_t views, uint32_t pixels)
{
	lod_probe_init(probe, &plant, &soup.model,
		&(struct lod_probe_options){ .views = views, .pixels = pixels });
	assert_true(lod_probe_keep_model(probe));
}

static struct lod_probe_result draw_share(struct lod_probe *probe, double share, double density, double larger)
{
	struct lod_probe_result result;
	lod_probe_clear(probe);
	for (uint32_t l = 0; l < plant.ladder_count; l++)
		if (!(plant.ladders[l].flags & ECO_LADDER_FAR))
			add_share(probe, &plant.ladders[l], share, plant.ladders[l].anchor ? 0 : density, larger);
	lod_probe_compare(probe, 1, &result);
	return result;
}

UNIT_TEST(the_scale_is_better_than_its_neighbours)
{
	FREED(lod_probe) probe;
	make_crown(2000, 0.2);
	measure(&quick);
	open_probe(&probe, quick.views, quick.pixels);
	for (double share = 0.02; share < 0.5; share *= 4) {
		double here = draw_share(&probe, share, 0, 1).loss;
		assert_true(here < draw_share(&probe, share, 0, 1.5).loss + 0.01);
		assert_true(here < draw_share(&probe, share, 0, 1 / 1.5).loss + 0.01);
	}
	finish();
}

static double seen_of(const struct eco_seen *seen, uint32_t size)
{
	return ECO_SEEN_UNIT * (seen->color[size][1] + 0.5 * seen->contrast[size][1]);
}

/* Errors that are seen are those of a missing crown at first, fall, and are none at full detail. */
UNIT_TEST(what_is_seen_falls_from_nothing_to_full_detail)
{
	make_crown(2000, 0.2);
	measure(&quick);
	const struct eco_ladder *ladder = &plant.ladders[0];
	const struct eco_curve *curve = &plant.curves[ladder->curve_first];
	for (uint32_t size = 0; size < ECO_SEEN_SIZES; size++) {
		double nothing = seen_of(&ladder->nothing, size);
		assert_true(nothing > 10);
		for (uint32_t quarter = ladder->curve_count / 4, i = quarter; i + quarter < ladder->curve_count; i += quarter)
			assert_true(seen_of(&curve[i + quarter].seen, size) < 0.8 * seen_of(&curve[i].seen, size));
		assert_true(seen_of(&curve[ladder->curve_count - 1].seen, size) < 0.01 * nothing);
	}
	finish();
}

/* A log of one welded piece, which lines show badly. */
static const struct eco_ladder *measure_log(double rough)
{
	soup_begin(&soup);
	uint32_t bark = soup_material(&soup, 90, 60, 40, ECO_NONE, false);
	strcpy(soup.material[bark].name, "bark");
	soup_tube(&soup, bark, (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 0.2, 0, 1 }, 0.8, 0.2, 24, 24);
	for (uint32_t i = 0; i < 3 * soup.model.vertex_count; i++)
		soup.model.position[i] += (float)soup_random(&soup, -rough, rough);
	measure(&quick);
	assert_true(plant.ladder_count == 1 && plant.ladders[0].organ == ECO_ORGAN_WOOD);
	return &plant.ladders[0];
}

/* Between its line and all of its triangles there are levels, and what is seen is measured of each. */
UNIT_TEST(levels_of_wood_leave_no_gap)
{
	const struct eco_ladder *ladder = measure_log(0.02);
	const struct eco_curve *level = &plant.curves[ladder->curve_first + ladder->curve_count - ladder->level_count];
	assert_true(ladder->level_count > 4 && level->share < 0.2f);
	for (uint32_t i = 1; i < ladder->level_count; i++) {
		assert_true(level[i].share < 2.2f * level[i - 1].share);
		assert_true(seen_of(&level[i].seen, 0) < seen_of(&level[i - 1].seen, 0));
	}
	finish();
}

/* Branches of one welded piece each give way one by one: steps are small, and each is drawn as the curve says. */
UNIT_TEST(levels_of_wood_give_way_in_parts)
{
	soup_begin(&soup);
	uint32_t bark = soup_material(&soup, 90, 60, 40, ECO_NONE, false), mixed = 0;
	strcpy(soup.material[bark].name, "bark");
	for (int i = 0; i < 12; i++)
		soup_tube(&soup, bark, (struct lod_v3){ 0, 0, 0.3 * i }, (struct lod_v3){ i % 4 - 1.5, i % 3 - 1, 1 + 0.3 * i },
			0.2, 0.05, 12, 8);
	for (uint32_t i = 0; i < 3 * soup.model.vertex_count; i++)
		soup.model.position[i] += (float)soup_random(&soup, -0.01, 0.01);
	measure(&quick);
	const struct eco_ladder *ladder = &plant.ladders[0];
	const struct eco_curve *curve = &plant.curves[ladder->curve_first];
	assert_true(plant.ladder_count == 1 && ladder->level_count > 1);
	struct lod_probe probe;
	open_probe(&probe, 8, 128);
	for (uint32_t i = 1; i < ladder->curve_count; i++)
		if (curve[i].reach < 1) {
			struct lod_probe_result drawn = draw_share(&probe, curve[i].share, curve[i].reach, 1);
			assert_true(curve[i].share < (curve[i].share < 0.02f ? 2.5f : 1.25f) * curve[i - 1].share);
			assert_true(error_of(&curve[i]) <= error_of(&curve[i - 1]));
			assert_true(fabs(drawn.fp + drawn.fn - error_of(&curve[i])) < 0.02);
			mixed++;
		}
	assert_true(mixed > 8 && curve[ladder->curve_count - 1].share == 1);
	lod_probe_free(&probe);
	finish();
}

UNIT_TEST(levels_that_are_as_good_as_finer_ones_stand_for_them)
{
	const struct eco_ladder *ladder = measure_log(0);
	assert_true(ladder->level_count > 1 && ladder->level_count < 4);
	finish();
}

/* Greatest difference between the errors of the curve and of drawings at its samples and between them, from
 * GAP_LEAST vertices on. */
static double curve_gap(uint32_t views)
{
	struct lod_probe probe;
	const struct eco_ladder *first = &plant.ladders[0];
	double gap = 0;
	uint64_t full = 0;
	open_probe(&probe, views, 160);
	for (uint32_t i = 0; i < plant.ladder_count; i++)
		full += lod_ladder_full(&probe.scene, &plant.ladders[i]);
	for (uint32_t i = 0; i + 1 < 2 * first->curve_count; i++) {
		const struct eco_curve *sample = &plant.curves[first->curve_first + i / 2];
		double share = i % 2 ? (sample[0].share + (double)sample[1].share) / 2 : sample->share;
		if (share * (double)full < GAP_LEAST)
			continue;
		struct eco_curve said = lod_ladder_curve(&probe.scene, first, share);
		struct lod_probe_result drawn = draw_share(&probe, share, said.reach, 1);
		gap = fmax(gap, fabs(drawn.fp + drawn.fn - said.fp - said.fn));
	}
	lod_probe_free(&probe);
	return gap;
}

/* At the samples and between them, on the curve's own views and on others, in one list and in cells. */
UNIT_TEST(ladders_draw_what_their_curve_was_measured_with)
{
	static const struct { uint32_t leaves; double length; uint32_t cell_triangles; } rows[] =
		{ { 900, 0.4, 0 }, { 1500, 0.2, 0 }, { 1600, 0.3, 600 } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct lod_plant_options options = quick;
		options.pixels = 160;
		options.cell_triangles = rows[i].cell_triangles;
		make_crown(rows[i].leaves, rows[i].length);
		measure(&options);
		assert_int_equal(plant.plant.anchor_count > 1, rows[i].cell_triangles > 0);
		double own = curve_gap(8), other = curve_gap(11);
		if (own > 0.02 || other > 0.04)
			fail_msg("crown %zu: the curve's own views differ from it by %g, others by %g", i,
				own, other);
		finish();
	}
}

/* Needles a few grid steps thick: 12 bits are too few for them. */
UNIT_TEST(grids_are_as_fine_as_the_picture_needs_and_no_finer)
{
	struct lod_plant_options options = { .name = "needles", .seed = 1, .views = 4, .pixels = 96 };
	struct eco_error error = { 0 };
	soup_begin(&soup);
	soup.state = 11;
	uint32_t green = soup_material(&soup, 60, 150, 40, ECO_NONE, false);
	for (uint32_t i = 0; i < 400; i++)
		soup_leaf(&soup, green, lod_v3_scale(soup_direction(&soup), soup_random(&soup, 0, 2)), 0.4, 0.01);
	assert_int_equal(lod_plant_build(&plant, &soup.model, &options, &error), ECO_OK);
	assert_true(lod_grid_loss(&plant, &soup.model, &options) > LOD_GRID_LOSS);
	double coarse = plant.lists[0].list.grid_step[0];
	assert_int_equal(lod_plant_measure(&plant, &soup.model, &options, &error), ECO_OK);
	assert_true(lod_grid_loss(&plant, &soup.model, &options) <= LOD_GRID_LOSS && plant.curve_count > 0);
	assert_true(plant.solved[LOD_SOLVER_GRID].runs == 1 && plant.solved[LOD_SOLVER_GRID].converged == 1);
	assert_in_range(plant.solved[LOD_SOLVER_SCALE].converged, 1, plant.solved[LOD_SOLVER_SCALE].runs);
	uint32_t bits = LOD_GRID_BITS_MIN;
	for (double step = coarse; step > 1.5 * plant.lists[0].list.grid_step[0]; step /= 2)
		bits++;
	assert_in_range(bits, LOD_GRID_BITS_MIN + 1, LOD_GRID_BITS_MAX);
	lod_plant_free(&plant);
	options.grid_bits = bits - 1;
	assert_int_equal(lod_plant_build(&plant, &soup.model, &options, &error), ECO_OK);
	assert_true(lod_grid_loss(&plant, &soup.model, &options) > LOD_GRID_LOSS);
	finish();
}

/* Half a pixel from LOD_GRID_NEAR_M on: each doubling of the size beyond takes a bit more, up to the most. */
UNIT_TEST(large_plants_have_more_bits)
{
	static const float position[9] = { 0, 0, 0, 1, 0, 0, 0, 0, 1 };
	static const uint32_t index[6] = { 0, 1, 2, 0, 1, 7 };
	static const struct { float size; uint32_t bits; } rows[] = { { 1e-3f, 12 }, { 6, 12 }, { 36, 12 },
		{ 37, 13 }, { 72, 13 }, { 73, 14 },
		{ 146, 15 }, { 1000, 17 },
		{ 1e7f, 18 } };
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		float at[9];
		for (int k = 0; k < 9; k++)
			at[k] = rows[i].size * position[k] + 5;
		struct eco_model model = { .position = at, .vertex_count = 3, .index = (uint32_t *)index,
			.triangle_count = 2 };
		assert_int_equal(lod_grid_bits_least(&model), rows[i].bits);
	}
	assert_int_equal(lod_grid_bits_least(&(struct eco_model){ .triangle_count = 0 }), LOD_GRID_BITS_MIN);
}

/* Leaves far apart and smaller than any sample. */
UNIT_TEST(what_covers_nothing_has_no_curve)
{
	soup_begin(&soup);
	uint32_t green = soup_material(&soup, 60, 150, 40, ECO_NONE, false);
	for (int i = 0; i < 3; i++)
		soup_leaf(&soup, green, (struct lod_v3){ 5.0 * i, i, 3 * i }, 1e-3, 1e-3);
	struct lod_plant_options options = quick;
	options.grid_bits = 17;
	options.pixels = 64;
	measure(&options);
	assert_int_equal(plant.curve_count, 0);
	assert_int_equal(plant.ladders[0].curve_count, 0);
	finish();
}

static bool stop_soon(void *ctx, double share)
{
	uint32_t *calls = ctx;
	assert_true(share > 0 && share <= 1);
	return ++*calls < 5;
}

UNIT_TEST(measuring_can_be_stopped_and_repeats_to_the_bit)
{
	uint32_t calls = 0;
	struct lod_plant_options options = quick;
	struct eco_error error = { 0 };
	make_crown(200, 0.2);
	options.pixels = 64;
	assert_ok(lod_plant_build(&plant, &soup.model, &options, &error), error);
	options.progress = stop_soon;
	options.ctx = &calls;
	assert_int_equal(lod_plant_measure(&plant, &soup.model, &options, &error), ECO_INTERRUPTED);
	assert_int_equal(calls, 5);
	options.progress = NULL;
	assert_ok(lod_plant_measure(&plant, &soup.model, &options, &error), error);
	uint32_t count = plant.curve_count;
	FREED_MEMORY struct eco_curve *first = malloc(count * sizeof *first);
	memcpy(first, plant.curves, count * sizeof *first);
	assert_ok(lod_plant_measure(&plant, &soup.model, &options, &error), error);
	assert_int_equal(plant.curve_count, count);
	assert_memory_equal(first, plant.curves, count * sizeof *first);
	finish();
}
