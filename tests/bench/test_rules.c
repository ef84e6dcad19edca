/* The papers' rules, each against a table of what it is printed to do; and on a scene: a plan is what it
 * counts. */
#include <math.h>

#include "ecofiles/format/ground_tile.h"
#include "lod/sort.h"
#include "tests/bench/baseline/paper_rules.h"
#include "tests/support/ground_tiles.h"
#include "tests/support/scene_packs.h"
#include "tests/support/scratch.h"

static bool near(double a, double b) { return fabs(a - b) <= 1e-9 * (fabs(b) + 1); }

/* ---- Deussen 2002, section 5 ---- */

/* Blends of k = 37 triangles, by the vertices that are asked for: triangles, points [first, end). */
static const struct { double p; struct paper_blend blend; } blends[] = { { -1, { 0, 0, 0 } }, { 0.9, { 0, 0,
	0 } },
	{ 73.5, { 0, 0, 73 } }, { 74, { 0, 0, 74 } }, { 80, { 6, 12, 74 } }, { 110.2, { 36, 72, 74 } },
	{ 111, { 37, 74, 74 } }, { 1e9, { 37, 74, 74 } } };

UNIT_TEST(deussen_points_lines_and_blend)
{
	double area = 40, r = 10, d = 0.01, length = 30;
	/* equation 1 without its misprint; splats cover c_p times the projected area */
	assert_true(near(paper_deussen_points(area, r, d, 1.2), 1.2 * area / (2 * r * r) / (d * d)));
	assert_true(near(700 * (area / 2 / 1000) * paper_deussen_scale(700, 500, 1.4), 1.4 * area / 2));
	/* equation 2: q n lines of half their length, as wide as d', cover the projected area */
	assert_true(near(paper_deussen_lines(area / length, r, d) * length / (2 * r) * d, area / (2 * r
		* r)));
	for (size_t i = 0; i < sizeof blends / sizeof *blends; i++) {
		const struct paper_blend want = blends[i].blend, b = paper_deussen_blend(blends[i].p, 37);
		assert_int_equal(b.triangles, want.triangles);
		assert_int_equal(b.first, want.first);
		assert_int_equal(b.end, want.end);
	}
}

/* ---- Cook 2007 and Neubert 2011 ---- */

static double covered(uint32_t count, double share) { return 1 - pow(1 - share, count); }

static const struct { uint32_t kept, count; double share; } pruned[] = { { 1, 10, 0.05 }, { 3, 1000, 0.002 },
	{ 50, 60, 0.1 }, { 500, 5000, 0.001 }, { 2, 100000, 1e-5 } };

UNIT_TEST(cook_keeps_what_is_expected_to_be_visible)
{
	for (size_t i = 0; i < sizeof pruned / sizeof *pruned; i++) {
		uint32_t m = pruned[i].kept, n = pruned[i].count;
		double a = pruned[i].share, s = lod_cook_scale_depth(m, n, a);
		assert_true(lod_cook_scale(m, n) == (double)n / m && lod_cook_scale_depth(m, n,
			0) == (double)n / m);
		assert_true(s >= 1 && s <= (double)n / m && s * a <= 1);
		assert_true(fabs(covered(m, s * a) - covered(n, a)) < 1e-9);
		assert_true(fabs(lod_cook_share(n, n * a * 5000, 5000 * covered(n, a)) - a) < 1e-6 * a);
	}
	assert_true(lod_cook_scale(0, 100) == 0 && lod_cook_share(10, 5, 5) == 0);
	/* the mean of k colours has 1 / k of their variance; what is larger than a pixel needs no correction
	 * */
	assert_true(near(lod_cook_contrast(1, 4, 16), 0.5) && lod_cook_contrast(1, 100, 0.2) == 1);
	/* leaves keep their size in pixels beyond the distance where pruning begins */
	assert_true(paper_cook_lambda(5, 10) == 1 && near(1 / paper_cook_lambda(50, 10) / (50 * 50), 0.01));
}

UNIT_TEST(neubert_takes_the_smallest_lambda_of_cooks_quality)
{
	struct paper_table t = { .leaves = 1000 };
	for (uint32_t i = 0; i < PAPER_LAMBDAS; i++) {
		t.lambda[i] = pow(1e-3, 1 - (double)i / (PAPER_LAMBDAS - 1));
		t.q_cook[i] = (double)i / (PAPER_LAMBDAS - 1);
		t.q_opt[i] = fmin(1, (i + 2.0) / (PAPER_LAMBDAS - 1)); /* two rows ahead */
	}
	for (uint32_t i = 3; i + 1 < PAPER_LAMBDAS; i++)
		assert_true(near(paper_table_optimal(&t, t.lambda[i]), t.lambda[i - 2]));
	t.q_cook[5] = 2;                         /* no row of the table is as good */
	assert_true(paper_table_optimal(&t, t.lambda[5]) == t.lambda[5] && paper_table_optimal(&t, 1) == 1);
}

UNIT_TEST(occlusion_is_held_and_smoothed_in_time)
{
	struct paper_sight_state s = { 1, 1 };
	paper_sight_step(&s, 1 - 0.9 * PAPER_SIGHT_HYSTERESIS);
	assert_true(s.held == 1 && s.smooth == 1);       /* flicker below the hysteresis is not followed */
	paper_sight_step(&s, 0.2);
	assert_true(s.held == 0.2 && s.smooth > 0.2 + 0.3 && s.smooth < 1);      /* not at once */
	for (int i = 0; i < 40; i++)
		paper_sight_step(&s, i % 2 ? 0.2 : 0.25);
	assert_true(s.held == 0.2 && fabs(s.smooth - 0.2) < 1e-6);
	assert_true(paper_sight_share(0.05) == 0.1 && paper_sight_share(0.7) == 0.7);
}

/* ---- Lee 2007 ---- */

static struct lod_arena arena;

/* n[i] leaves in layer i from the front, 4 layers: what of a budget each gets (equation 1 and its two
 * passes). */
static const struct { uint32_t n[4], budget, expected[4]; } layered[] = {
	{ { 50, 50, 50, 50 }, 100, { 40, 30, 20, 10 } },
	{ { 10, 50, 50, 50 }, 100, { 10, 50, 30, 10 } }, /* 30 over go to the second; it uses 20 of them */
	{ { 50, 50, 50, 2 }, 100, { 48, 30, 20, 2 } },   /* what the last cannot use goes to the front */
	{ { 50, 50, 0, 1 }, 100, { 50, 49, 0, 1 } }, { { 5, 5, 5, 5 }, 100, { 5, 5, 5, 5 } },
	{ { 50, 50, 50, 50 }, 0, { 0, 0, 0, 0 } }, { { 50, 50, 50, 50 }, 3, { 1, 1, 0, 1 } },
};

UNIT_TEST(lee_shares_the_budget_among_layers)
{
	/* the outermost leaves say how thick layers are */
	static const double depth[4] = { 4, 2.5, 1.5, 0 };
	const struct lod_lee_view from_x = { .eye = { 100, 0, 0 }, .forward = { -1, 0, 0 }, .layers = 4 };
	struct lod_v3 center[200], normal[200] = { { 0, 0, 0 } };
	uint32_t kept[200], layer_of[200];
	for (size_t r = 0; r < sizeof layered / sizeof *layered; r++) {
		uint32_t count = 0, got[4] = { 0 };
		for (uint32_t layer = 0; layer < 4; layer++)
			for (uint32_t i = 0; i < layered[r].n[layer]; i++, count++) {
				center[count] = (struct lod_v3){ depth[layer], 0, 0 };
				layer_of[count] = layer;
			}
		count = lod_lee_keep(kept, LOD_LEE_LAYER, &(struct lod_lee_leaves){ .count = count,
			.center = center, .normal = normal }, &from_x, layered[r].budget, &arena);
		while (count--)
			got[layer_of[kept[count]]]++;
		assert_memory_equal(got, layered[r].expected, sizeof got);
	}
}

/* The nearest of a ring of leaves, or the one that faces the eye. */
UNIT_TEST(lee_ranks_leaves_by_distance_and_normal)
{
	struct lod_v3 center[8], normal[8];
	uint32_t kept[8];
	for (uint32_t i = 0; i < 8; i++) {
		double turn = (i + 0.5) * 2 * LOD_PI / 8;
		center[i] = (struct lod_v3){ 3 * cos(turn), 3 * sin(turn), 5 };
		normal[i] = (struct lod_v3){ i == 5, 0, i == 5 ? 0 : 2 };
	}
	for (uint32_t i = 0; i < 8; i++) {
		double turn = (i + 0.3) * 2 * LOD_PI / 8;
		const struct lod_lee_view from = { { 40 * cos(turn), 40 * sin(turn), 5 }, { 1, 0, 0 }, 1 };
		for (enum lod_lee_method method = 0; method < LOD_LEE_COUNT; method++)
			for (uint32_t budget = 0; budget < 10; budget++) {
				assert_int_equal(lod_lee_keep(kept, method, &(struct lod_lee_leaves){
					.count = 8, .center = center, .normal = normal }, &from, budget,
					&arena), budget < 8 ? budget : 8);
				assert_true(!budget || kept[0] == (method == LOD_LEE_DISTANCE ? i : 5));
			}
	}
	lod_arena_free(&arena);
}

/* ---- A scene ---- */

static struct paper_scene *scene;
static const struct eco_view view = { { 50, -60, 25 }, { 50, 30, 3 }, { 0, 0, 1 }, 45, 240, 160 };

static double hills(double x, double y) { return 2 + 0.01 * (x + y); }

static int open_scene(void **state)
{
	struct eco_error error = { 0 };
	struct eco_ground ground = ground_make(16, 16, -8, -8, 8, hills);
	scratch_open("rules");
	enum eco_code code = sample_pack_write_on(in_root("sample.eco"), &ground, true, &error);
	eco_ground_free(&ground);
	if (!code)
		code = paper_scene_open(&scene, in_root("sample.eco"), &error);
	if (code)
		print_error("%s\n", error.text);
	return code != ECO_OK;
}

static int close_scene(void **state)
{
	paper_scene_close(scene);
	return scratch_close(state);
}

/* The client counts the plan's vertices anew, and refuses it if they differ. */
static uint64_t solve(paper_rule *rule, void *ctx, uint64_t budget, struct paper_frame *frame)
{
	struct eco_request request = { .view = view, .vertices = budget };
	double x = 0;
	paper_shoot(scene, &request, rule, ctx, &x, 0, frame);
	assert_true(frame->picture.vertices <= budget);
	return frame->picture.vertices;
}

UNIT_TEST(rules_spend_their_budget_and_draw_what_they_count)
{
	struct paper_cook cook = { 0 };
	struct paper_lee lee = { .method = LOD_LEE_LAYER };
	static const uint64_t budgets[] = { 0, 500, 5000, 2000000 };
	paper_lee_begin(&lee, scene);
	for (size_t i = 0; i < sizeof budgets / sizeof *budgets; i++) {
		struct paper_frame frame;
		double least = budgets[i] < 5000 ? 0 : 0.9 * (double)budgets[i];
		assert_true((double)solve(paper_cook, &cook, budgets[i], &frame) >= least);
		paper_frame_free(&frame);
		assert_true((double)solve(paper_lee, &lee, budgets[i], &frame) >= least);
		paper_frame_free(&frame);
		/* between all points of the summary and the first plants, whose bushes have no points, is
		 * nothing */
		assert_true((double)solve(paper_deussen, NULL, budgets[i], &frame)
			>= (budgets[i] == 5000 ? 1900 : 0.9 * (double)budgets[i]));
		paper_frame_free(&frame);
	}
	paper_lee_end(&lee);
}

/* Figures of each plant's table: Neubert's are no worse than Cook's, with fewer leaves. */
UNIT_TEST(tables_keep_cooks_quality_with_fewer_leaves)
{
	struct paper_table *tables = paper_tables_make(scene);
	for (uint32_t plant = 0; plant < 2; plant++) {
		const struct paper_table *t = &tables[plant];
		assert_true(t->leaves == (plant ? 400 : 30000) && t->share > 0 && t->share <= 1);
		for (uint32_t i = 0; i < PAPER_LAMBDAS; i++) {
			assert_true(t->q_opt[i] >= t->q_cook[i]);
			assert_true(paper_table_optimal(t, t->lambda[i]) <= t->lambda[i]);
			assert_true(near(paper_table_scale(t, t->lambda[i]), t->s_opt[i]));
		}
		assert_true(t->q_opt[PAPER_LAMBDAS - 1] == 1);
		assert_true(paper_table_optimal(t, t->lambda[4]) < t->lambda[4]);
	}
	free(tables);
}

UNIT_TEST(plants_behind_others_lose_leaves)
{
	struct paper_cook cook = { .sight = paper_sight_new(scene) };
	struct paper_frame frame;
	uint32_t hidden = 0, visible = 0;
	for (int i = 0; i < 4; i++) {
		solve(paper_cook, &cook, 200000, &frame);
		paper_sight_update(cook.sight, &frame, &view);
		for (uint32_t k = 0; i == 3 && k < frame.selection.instance_count; k++) {
			const struct view_instance *instance = &frame.selection.instances[k];
			double f = instance->plant == ECO_NONE ? 0.7
				: paper_sight_of(cook.sight, instance->plant, instance->hash);
			assert_true(f >= 0 && f <= 1);
			hidden += f < 0.5;
			visible += f > 0.9;
		}
		paper_frame_free(&frame);
	}
	assert_true(hidden > 5 && visible > 5);
	paper_sight_free(cook.sight);
}

UNIT_MAIN(open_scene, close_scene)
