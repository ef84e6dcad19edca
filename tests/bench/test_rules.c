/* The papers' rules on whole scenes: what each is printed to do, and that its plan is what it counts. */
#include <math.h>

#include "ecofiles/format/ground_tile.h"
#include "tests/bench/baseline/paper_lee.h"
#include "tests/bench/baseline/paper_neubert.h"
#include "tests/bench/baseline/paper_rules.h"
#include "tests/support/ground_tiles.h"
#include "tests/support/scene_packs.h"
#include "tests/support/scratch.h"

static bool near(double a, double b)
{
	return fabs(a - b) <= 1e-9 * (fabs(b) + 1);
}

/* ---- Deussen ---- */

UNIT_TEST(points_follow_equation_1_and_the_splat_factor)
{
	assert_true(near(paper_deussen_points(40, 10, 0.01, 1.2), 1.2 * 0.2 / 1e-4));
	assert_true(near(paper_deussen_points(40, 20, 0.01, 1.5) * 4,
		paper_deussen_points(40, 10, 0.01, 1.5)));
}

/* Half the surface is seen; together they cover c_p times that. */
UNIT_TEST(splats_cover_the_projected_area_and_the_splat_factor)
{
	double area = 7, k = 500, all = area / 2 / (2 * k);
	for (double p = 1; p < 3 * k; p *= 1.7)
		assert_true(near(p * all * paper_deussen_scale(p, k, 1.4), 1.4 * area / 2));
}

UNIT_TEST(a_blend_draws_exactly_p_vertices)
{
	const uint32_t k = 37;
	for (uint32_t p = 0; p <= 4 * k; p++) {
		struct paper_blend b = paper_deussen_blend(p + 0.25, k);
		assert_int_equal(3 * b.triangles + b.end - b.first, p < 3 * k ? p : 3 * k);
		assert_int_equal(b.triangles, p < 2 * k ? 0 : p < 3 * k ? p - 2 * k : k);
		/* points of triangles that are drawn are not */
		assert_int_equal(b.first, 2 * b.triangles);
		assert_true(b.end <= 2 * k);
	}
	assert_int_equal(paper_deussen_blend(-1, k).end, 0);
}

UNIT_TEST(lines_follow_equation_2)
{
	double r = 50, d = 0.01, area = 6, length = 30, q = paper_deussen_lines(area / length, r, d);
	/* q n lines of half their length, as wide as d', cover the projected area A / (2 r^2) */
	assert_true(near(q * length / (2 * r) * d, area / (2 * r * r)));
}

/* Ten lines of a metre, 1 to 10 mm wide. */
UNIT_TEST(lines_are_as_wide_as_they_are_asked_for_but_for_trunks)
{
	uint8_t corners[10];
	int32_t position[60] = { 0 }, extra[10];
	for (int i = 0; i < 10; i++) {
		corners[i] = 2;
		position[6 * i] = 10000 * i;
		position[6 * i + 3] = 10000 * i + 10000;
		extra[i] = 10 * (i + 1);
	}
	struct view_list from = { .list = { .kind = ECO_LIST_LINES, .attributes = ECO_ATTR_WIDTH,
		.grid_step = { 1e-4, 1e-4, 1e-4 } } };
	from.list.primitive_count = from.list.element_count = 10;
	from.elements = (struct eco_elements){ .element_count = 10, .corner_count = 20, .primitive_count = 10,
		.extra_count = 1, .corners = corners, .position = position, .extra = extra };
	struct paper_lines made = { 0 };
	struct eco_elements out;
	uint32_t seen = 0;
	assert_true(paper_make_lines(&from, 0.00701, &made, &out));
	assert_int_equal(made.thick, 3);
	assert_true(near(made.thin, 0.004));             /* of 1 to 7 mm */
	for (int i = 0; i < 10; i++) {
		int line = out.position[6 * i] / 10000;
		assert_int_equal(out.extra[i], i < 3 ? 10 * (line + 1) : 70);
		assert_true(i < 3 ? line >= 7 : line < 7);
		seen |= 1u << line;
	}
	assert_int_equal(seen, 1023);
	eco_elements_free(&out);
}

static double by_steps(void *ctx)
{
	uint32_t *i = ctx;
	return (double)((*i += 7919) % 10007) / 10007;
}

UNIT_TEST(two_points_lie_on_their_triangle)
{
	static const float corner[9] = { 1, 1, 0, 3, 1, 0, 1, 5, 0 };
	uint32_t state = 1;
	double sum[2] = { 0, 0 };
	for (int i = 0; i < 2000; i++) {
		double at[2][3];
		paper_two_points(corner, by_steps, &state, at);
		for (int k = 0; k < 2; k++) {
			double a = (at[k][0] - 1) / 2, b = (at[k][1] - 1) / 4;
			assert_true(a >= 0 && b >= 0 && a + b <= 1 + 1e-12 && at[k][2] == 0);
			sum[0] += a;
			sum[1] += b;
		}
	}
	assert_true(fabs(sum[0] / 4000 - 1 / 3.0) < 0.02 && fabs(sum[1] / 4000 - 1 / 3.0) < 0.02);
}

/* ---- Cook and Neubert ---- */

UNIT_TEST(leaves_keep_their_size_in_pixels_from_where_pruning_begins)
{
	assert_true(paper_cook_lambda(5, 10) == 1 && paper_cook_lambda(10, 10) == 1);
	for (double r = 11; r < 1000; r *= 1.5) /* area over r^2, grown by 1 / lambda */
		assert_true(near(1 / paper_cook_lambda(r, 10) / (r * r), 0.01));
}

UNIT_TEST(the_optimal_lambda_is_the_smallest_of_cooks_quality)
{
	struct paper_table t = { .leaves = 1000 };
	for (uint32_t i = 0; i < PAPER_LAMBDAS; i++) {
		t.lambda[i] = pow(1e-3, 1 - (double)i / (PAPER_LAMBDAS - 1));
		t.q_cook[i] = (double)i / (PAPER_LAMBDAS - 1);
		t.q_opt[i] = fmin(1, (i + 2.0) / (PAPER_LAMBDAS - 1)); /* two rows ahead */
	}
	for (uint32_t i = 3; i + 1 < PAPER_LAMBDAS; i++)
		assert_true(near(paper_table_optimal(&t, t.lambda[i]), t.lambda[i - 2]));
	assert_true(paper_table_optimal(&t, 1) == 1);
	/* never more than Cook's, though no row of the table is as good */
	t.q_cook[5] = 2;
	assert_true(paper_table_optimal(&t, t.lambda[5]) == t.lambda[5]);
	/* nor one of nearly that quality */
	for (uint32_t i = 0; i < 6; i++)
		t.q_opt[i] = 0.5;
	t.q_cook[5] = 0.52;
	assert_true(paper_table_optimal(&t, t.lambda[5]) == t.lambda[5]);
}

UNIT_TEST(no_plant_is_hidden_so_far_that_it_keeps_less_than_a_tenth)
{
	assert_true(paper_sight_share(0) == 0.1 && paper_sight_share(0.05) == 0.1);
	assert_true(paper_sight_share(0.7) == 0.7 && paper_sight_share(1) == 1);
}

UNIT_TEST(occlusion_is_held_and_smoothed_in_time)
{
	struct paper_sight_state s = { 1, 1 };
	paper_sight_step(&s, 1 - 0.9 * PAPER_SIGHT_HYSTERESIS);
	assert_true(s.held == 1 && s.smooth == 1); /* flicker below the hysteresis is not followed */
	paper_sight_step(&s, 0.2);
	assert_true(s.held == 0.2 && s.smooth > 0.2 + 0.3 && s.smooth < 1); /* not at once */
	for (int i = 0; i < 40; i++)
		paper_sight_step(&s, i % 2 ? 0.2 : 0.25);
	assert_true(s.held == 0.2 && fabs(s.smooth - 0.2) < 1e-6);
}

/* ---- Lee ---- */

static struct lod_arena arena;

static void ring(struct lod_lee_group groups[8])
{
	for (uint32_t i = 0; i < 8; i++) {
		double turn = (i + 0.5) * 2 * LOD_PI / 8;
		groups[i] = (struct lod_lee_group){ .center = { 3 * cos(turn), 3 * sin(turn), 5 },
			.count = 100,
			.facing = { 1, 1, 1, 0, 0, 0 } };
	}
}

UNIT_TEST(orders_by_view_and_by_sector_keep_the_near_cell_and_static_ones_all)
{
	struct lod_lee_group groups[8];
	struct lod_v3 center = { 0, 0, 5 };
	uint32_t kept[8];
	assert_int_equal(setjmp(arena.failed), 0);
	ring(groups);
	for (uint32_t i = 0; i < 8; i++) {
		double turn = (i + 0.3) * 2 * LOD_PI / 8;
		struct lod_v3 eye = { 40 * cos(turn), 40 * sin(turn), 5 };
		for (uint32_t order = PAPER_LEE_VIEW; order <= PAPER_LEE_SECTOR; order++) {
			paper_lee_keep(kept, LOD_LEE_DISTANCE * PAPER_LEE_ORDERS + order, groups, 8, &center,
				&eye, 80, &arena);
			assert_int_equal(kept[i], 80);
		}
		paper_lee_keep(kept, LOD_LEE_DISTANCE * PAPER_LEE_ORDERS + PAPER_LEE_STATIC, groups, 8,
			&center, &eye, 80, &arena);
		for (uint32_t k = 0; k < 8; k++)
			assert_int_equal(kept[k], 10);
	}
	lod_arena_free(&arena);
}

UNIT_TEST(every_order_keeps_the_whole_budget)
{
	struct lod_lee_group groups[8];
	struct lod_v3 center = { 0, 0, 5 }, eye = { 20, 3, 2 };
	uint32_t kept[8];
	assert_int_equal(setjmp(arena.failed), 0);
	ring(groups);
	for (uint32_t rule = 0; rule < PAPER_LEE_RULES; rule++)
		for (uint64_t budget = 0; budget <= 900; budget += 90) {
			uint64_t sum = 0;
			paper_lee_keep(kept, rule, groups, 8, &center, &eye, budget, &arena);
			for (uint32_t i = 0; i < 8; i++)
				sum += kept[i];
			assert_int_equal(sum, budget < 800 ? budget : 800);
		}
	lod_arena_free(&arena);
}

/* ---- A scene ---- */

static struct paper_scene *scene;
static const struct eco_view view = { { 50, -60, 25 }, { 50, 30, 3 }, { 0, 0, 1 }, 45, 240, 160 };

static double hills(double x, double y)
{
	return 2 + 0.01 * (x + y);
}

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
	scratch_remove(scratch_root);
	return 0;
}

/* Solves and draws; the client counts the plan's vertices anew, and refuses it where they differ. */
static uint64_t solve(paper_rule *rule, void *ctx, double few, double many, uint64_t budget,
	struct paper_frame *frame)
{
	struct eco_request request = { .view = view, .vertices = budget };
	struct eco_error error = { 0 };
	struct eco_plan plan = { 0 };
	struct paper paper;
	double x;
	assert_ok(paper_begin(&paper, scene, &request, &error), error);
	assert_ok(paper_solve(&paper, rule, ctx, few, many, &x, &plan, &error), error);
	paper_end(&paper);
	uint64_t vertices = plan.vertices;
	assert_ok(paper_draw(scene, &plan, &view, false, frame, &error), error);
	assert_int_equal(frame->picture.vertices, vertices);
	assert_true(vertices <= budget);
	return vertices;
}

UNIT_TEST(rules_spend_their_budget_and_draw_what_they_count)
{
	struct paper_cook cook = { 0 };
	static const uint64_t budgets[] = { 0, 500, 5000, 2000000 };
	for (size_t i = 0; i < sizeof budgets / sizeof *budgets; i++) {
		struct paper_frame frame;
		uint64_t by_cook = solve(paper_cook, &cook, 1e-3, 1e5, budgets[i], &frame);
		paper_frame_free(&frame);
		uint64_t by_deussen = solve(paper_deussen, NULL, 2, 1e-6, budgets[i], &frame);
		paper_frame_free(&frame);
		assert_true(budgets[i] < 5000 || by_cook > 0.9 * (double)budgets[i]);
		/* between all points of the summary and the first plants, whose bushes have no points, is
		 * nothing */
		assert_true(budgets[i] == 5000 ? by_deussen > 1900 : by_deussen >= 0.9 * (double)budgets[i]);
	}
}

UNIT_TEST(each_triangle_has_two_points_of_its_own)
{
	const struct view_list *leaves = view_store_list(scene->store, scene->scene->ladders[0].triangles),
			       *points = view_store_list(scene->store, scene->points[0]);
	assert_int_equal(points->list.primitive_count, 2 * leaves->list.primitive_count);
	for (uint32_t i = 0; i < leaves->list.primitive_count; i++) /* one triangle a leaf here */
		for (uint32_t k = 0; k < 6; k++) {
			const int32_t *corner = leaves->elements.position + 9 * (size_t)i + k % 3;
			int32_t at = points->elements.position[6 * (size_t)i + k],
				low = corner[0] < corner[3] ? corner[0] : corner[3],
				high = corner[0] > corner[3] ? corner[0] : corner[3];
			low = low < corner[6] ? low : corner[6];
			high = high > corner[6] ? high : corner[6];
			assert_true(at >= low && at <= high);
		}
}

static uint64_t vertices_at(struct paper_cook *cook, double full_m)
{
	struct eco_request request = { .view = view };
	struct eco_error error = { 0 };
	struct paper paper;
	assert_ok(paper_begin(&paper, scene, &request, &error), error);
	assert_ok(paper_cook(&paper, full_m, cook, &error), error);
	uint64_t vertices = paper_vertices(&paper);
	paper_end(&paper);
	return vertices;
}

UNIT_TEST(tables_keep_cooks_quality_with_fewer_leaves)
{
	struct paper_tables *tables;
	struct eco_error error = { 0 };
	assert_ok(paper_tables_make(&tables, scene, &error), error);
	for (uint32_t plant = 0; plant < 2; plant++) {
		const struct paper_table *t = paper_tables_of(tables, plant);
		assert_true(t->leaves == (plant ? 400 : 30000) && t->share > 0 && t->share <= 1);
		for (uint32_t i = 0; i < PAPER_LAMBDAS; i++) {
			double optimal = paper_tables_optimal(tables, plant, t->lambda[i]);
			assert_true(t->q_opt[i] >= t->q_cook[i] && optimal <= t->lambda[i]);
			assert_true(t->s_cook[i] <= 1 / t->lambda[i] * 1.5); /* whole leaves */
			assert_true(near(paper_tables_scale(tables, plant, t->lambda[i]), t->s_opt[i]));
		}
		assert_true(t->q_opt[PAPER_LAMBDAS - 1] == 1);
		assert_true(paper_tables_optimal(tables, plant, t->lambda[4]) < t->lambda[4]);
	}
	paper_tables_free(tables);
}

UNIT_TEST(plants_behind_others_lose_leaves_but_keep_a_tenth)
{
	struct paper_cook cook = { 0 };
	struct paper_frame frame;
	struct eco_error error = { 0 };
	assert_ok(paper_sight_new(&cook.sight, scene, &error), error);
	uint32_t hidden = 0, visible = 0;
	for (int i = 0; i < 4; i++) {
		solve(paper_cook, &cook, 1e-3, 1e5, 200000, &frame);
		paper_sight_update(cook.sight, &frame, &view);
		for (uint32_t k = 0; i == 3 && k < frame.selection.instance_count; k++) {
			const struct view_instance *instance = &frame.selection.instances[k];
			if (instance->plant == ECO_NONE)
				continue;
			double f = paper_sight_of(cook.sight, instance->plant, instance->hash);
			assert_true(f >= 0 && f <= 1);
			hidden += f < 0.5;
			visible += f > 0.9;
		}
		paper_frame_free(&frame);
	}
	assert_true(hidden > 5 && visible > 5);
	uint64_t seen = vertices_at(&cook, 30), all = vertices_at(&(struct paper_cook){ 0 }, 30);
	assert_true(seen < 0.9 * (double)all && seen > 0.1 * (double)all);
	paper_sight_forget(cook.sight); /* a jump */
	for (uint32_t hash = 0; hash < ECO_SHARE_ONE; hash++)
		assert_true(paper_sight_of(cook.sight, 0, hash) == 1);
	paper_sight_free(cook.sight);
}

int main(void)
{
	return unit_tests_run(open_scene, close_scene);
}
