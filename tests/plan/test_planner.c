/* Invariants of plans, on random scenes, views and budgets; checked by a simple twin that evaluates the rules
 * plant by plant, as a client would. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/wire.h"
#include "lod/ladder.h"
#include "lod/plan/planner.h"
#include "lod/plan/visible_tree.h"
#include "lod/eye.h"
#include "tests/support/plan_twin.h"
#include "tests/support/scene_random.h"
#include "tests/support/unit_test.h"

static struct scene_builder scene;

static struct eco_request random_request(struct scene_builder *r)
{
	static const uint32_t sizes[] = { 1, 64, 800, 16384 };
	struct eco_request q = { .bytes = ECO_BYTES_UNBOUNDED };
	double reach = random_below(r, 2) ? 100 : 3000;
	for (int i = 0; i < 3; i++) {
		q.view.eye[i] = random_real(r, -reach, reach) / (i == 2 ? 4 : 1);
		q.view.target[i] = random_real(r, -60, 60);
		q.view.up[i] = i == 2;
	}
	q.view.fov_y_deg = random_real(r, 1, 120);
	q.view.width = sizes[random_below(r, 4)];
	q.view.height = sizes[random_below(r, 4)];
	/* from 0 over a few to far more than there is */
	uint64_t limit = (uint64_t)1 << random_below(r, 27);
	q.vertices = random_bits(r) % limit;
	return q;
}

static struct lod_planner_stats plan_it(struct eco_plan *plan, const struct eco_request *request)
{
	return plan_make(plan, (struct lod_planner_input){ .scene = &scene.scene, .request = request });
}

static void check_plan(const struct eco_plan *plan, const struct eco_request *request)
{
	const struct eco_prediction *p = &plan->prediction;
	assert_true(plan->vertices <= request->vertices);
	assert_int_equal(plan->vertices, plan_twin_vertices(&scene.scene, plan, &request->view, NULL));
	assert_true(p->tp >= 0 && p->fp >= 0 && p->fn >= 0 && isfinite(p->tp + p->fp + p->fn)
		&& eco_predicted_q(p) <= 1);
	for (uint32_t i = 0; i < plan->cut_count; i++) {
		const struct eco_cut *cut = &plan->cuts[i];
		assert_true(cut->first < cut->end);
		assert_true(cut->end <= scene.scene.lists[cut->list].primitive_count);
		assert_true(cut->scale > 0 && isfinite(cut->scale));
		assert_true(cut->share_first < cut->share_end && cut->share_end <= ECO_SHARE_ONE);
		if (scene.lists[cut->list].kind == ECO_LIST_IMPOSTOR)
			assert_true(cut->end == cut->first + 1 && cut->scale == 1);
		if (cut->anchor != ECO_NONE)
			assert_true(cut->band_first < cut->band_end && cut->band_end <= ECO_BANDS);
		else
			assert_true(cut->placement < plan->placement_count);
		assert_true(cut->halvings <= (cut->anchor == ECO_NONE && scene.lists[cut->list].kind
			== ECO_LIST_POINTS ? ECO_HALVINGS_MAX : 0));
	}
}

static void check_needs(const struct eco_plan *plan)
{
	struct eco_holdings needs;
	assert_int_equal(lod_plan_needs(&scene.scene, plan, &needs, NULL), ECO_OK);
	for (uint32_t i = 1; i < needs.count; i++)
		assert_true(needs.items[i - 1].list < needs.items[i].list);
	for (uint32_t i = 0; i < plan->cut_count; i++) {
		uint32_t list = plan->cuts[i].list;
		uint64_t have = 0;
		for (uint32_t c = 0; c < eco_holdings_chunks(&needs, list); c++)
			have += scene.chunks[scene.lists[list].chunk_first + c].primitive_count;
		assert_true(have >= plan->cuts[i].end);
	}
	free(needs.items);
}

/* Cuts of ladders that show the whole plant. */
static uint32_t count_whole(const struct eco_plan *plan)
{
	uint32_t sum = 0;
	for (uint32_t i = 0; i < plan->cut_count; i++)
		sum += plan->cuts[i].anchor != ECO_NONE
			&& (scene.lists[plan->cuts[i].list].kind == ECO_LIST_IMPOSTOR
			|| scene.lists[plan->cuts[i].list].attributes & ECO_ATTR_SPLAT);
	return sum;
}

/* By either rule. */
UNIT_TEST(never_above_the_budget_and_counted_as_drawn)
{
	uint64_t unused = 0, asked = 0, ended = 0, whole = 0, by_distance = 0;
	for (uint64_t seed = 1; seed <= 120; seed++) {
		(seed <= 60 ? random_scene_make : random_scene_splats)(&scene, seed, seed % 3 ? 0 : 5);
		for (int i = 0; i < 20; i++) {
			struct eco_request request = random_request(&scene);
			struct eco_plan plan, all;
			struct lod_planner_stats stats = plan_it(&plan, &request);
			check_plan(&plan, &request);
			check_needs(&plan);
			assert_true(plan.sample_distance == 0);
			struct eco_request everything = request;
			everything.vertices = ECO_VERTICES_MAX;
			plan_it(&all, &everything);
			check_plan(&all, &everything);
			/* left over is less than any step takes; or everything that can be seen is as it
			 * should be */
			assert_true(request.vertices - plan.vertices < stats.cheapest);
			assert_int_equal(count_whole(&all), 0);
			whole += count_whole(&plan) > 0;
			ended += stats.cheapest == UINT64_MAX;
			if (stats.cheapest != UINT64_MAX) {
				asked += request.vertices;
				unused += request.vertices - plan.vertices;
			}
			eco_plan_free(&plan);
			eco_plan_free(&all);
			if (i % 3)
				continue;
			assert_true(plan_make(&plan, (struct lod_planner_input){ .scene = &scene.scene,
				.request = &request, .rule = lod_rule_deussen }).converged);
			check_plan(&plan, &request);
			assert_true(isfinite(plan.sample_distance) && plan.sample_distance >= 0);
			by_distance += plan.vertices;
			eco_plan_free(&plan);
		}
	}
	print_message("          unused of what could be used: %.4f %%; in %llu plans every curve has "
		"ended\n", 100.0 * (double)unused / (double)asked, (unsigned long long)ended);
	print_message("          %llu plans draw whole plants by one ladder\n", (unsigned long long)whole);
	assert_true(unused * 200 <= asked);
	assert_true(whole > 200 && by_distance > 0);
}

/* A plan is predicted as it is drawn, and it is chosen by other errors than Q: along growing budgets Q rises but for a
 * few plans of few vertices. */
UNIT_TEST(more_budget_is_hardly_ever_predicted_to_be_worse)
{
	uint32_t plans = 0, worse = 0, shown = 0;
	for (uint64_t seed = 1; seed <= 60; seed++) {
		random_scene_splats(&scene, 700 + seed, seed % 3 ? 0 : 5);
		struct eco_request request = random_request(&scene);
		double last = -INFINITY;
		for (request.vertices = 0; request.vertices < 400000;
				request.vertices += 1 + request.vertices / 3) {
			struct eco_plan plan;
			struct lod_planner_stats stats = plan_it(&plan, &request);
			const struct eco_prediction *p = &plan.prediction;
			double q = eco_predicted_q(p), pixels = (double)request.view.width * request.view.height;
			/* differences of colors are a part of the objective */
			assert_true(plan.m16 * LOD_SEEN_COLOR * pixels <= stats.wrong + 0.001 * pixels);
			shown += plan.m16 > 0 && plan.m16 * LOD_SEEN_COLOR * pixels < 0.99 * stats.wrong;
			/* pixels are sixteenths */
			worse += q < last - 0.25 / fmax(0.5, p->tp + fmin(p->fp, p->fn));
			plans++;
			last = q;
			eco_plan_free(&plan);
		}
	}
	print_message("          %u of %u plans predict a lower Q than one of fewer vertices\n", worse, plans);
	assert_true(100 * worse <= plans);
	assert_true(shown > 100);
}

static void add_crowd(double x, uint32_t count)
{
	random_crowd(&scene, (struct eco_tile){ .low = { x - 30, -30, 0 }, .high = { x + 30, 30, 20 },
		.instance_count = count, .area = 30.0 * count, .summary = ECO_NONE }, (const double[]){ x, 0 }, 20);
}

/* A plant of 300 leaves, and of 16 splats; fp and fn of the first of them, and of all. */
static void make_plant_of_splats(const float errors[2][2])
{
	struct random_stand stand = { .height_m = 10, .leaves = 300, .area = 30,
		.shares = { .01f, .1f, .5f, 1 }, .errors = { .4f, .3f, .2f, 0 }, .splats = 16 };
	memcpy(stand.splat_errors, errors, sizeof stand.splat_errors);
	random_stand_make(&scene, &stand);
	scene_add_tile(&scene, (struct eco_tile){ .low = { -30, -30, 0 }, .high = { 4000, 30, 20 },
		.instance_count = 2100, .area = 30.0 * 2100, .summary = ECO_NONE });
}

static struct eco_request at_the_crowd(uint64_t vertices)
{
	return (struct eco_request){ .view = { .target = { 60, 10, 5 }, .eye = { 0, 10, 40 },
		.up = { 0, 0, 1 }, .fov_y_deg = 60, .width = 800, .height = 600 }, .vertices = vertices,
		.bytes = ECO_BYTES_UNBOUNDED };
}

/* A budget of a thousand times a plant's organs draws them, though splats are nearly as good. */
UNIT_TEST(splats_that_are_nearly_right_leave_near_plants_their_organs)
{
	make_plant_of_splats((const float[2][2]){ { .2f, .2f }, { .02f, .02f } });
	add_crowd(60, 100);
	add_crowd(3000, 2000);
	struct eco_request request = at_the_crowd(500000);
	struct eco_plan plan;
	plan_it(&plan, &request);
	double whole[2] = { 0 };
	for (uint32_t i = 0; i < plan.cut_count; i++)
		if (scene.lists[plan.cuts[i].list].attributes & ECO_ATTR_SPLAT)
			whole[lod_band_distance_m((uint8_t)plan.cuts[i].band_first) > 1000] +=
				(double)(plan.cuts[i].share_end - plan.cuts[i].share_first) / ECO_SHARE_ONE;
	print_message("          %llu vertices, splats near %.2f, far %.2f\n",
		(unsigned long long)plan.vertices, whole[0], whole[1]);
	assert_true(whole[0] == 0 && whole[1] > 0);
	eco_plan_free(&plan);
}

/* If curves are equal but for noise, the sharper splats are better. */
UNIT_TEST(splats_that_are_as_right_and_sharper_are_drawn)
{
	make_plant_of_splats((const float[2][2]){ { .180f, .151f }, { .167f, .165f } });
	add_crowd(60, 100);
	struct eco_request request = at_the_crowd(1600);
	struct eco_plan plan;
	plan_it(&plan, &request);
	uint32_t most = 0;
	for (uint32_t i = 0; i < plan.cut_count; i++)
		if (scene.lists[plan.cuts[i].list].attributes & ECO_ATTR_SPLAT && plan.cuts[i].end > most)
			most = plan.cuts[i].end;
	assert_int_equal(most, 16);
	eco_plan_free(&plan);
}

/* Whether a cut is what stands before the splats of a list: leaves of the whole plant, or of its cells. */
static bool stands_before(const struct eco_cut *cut, uint32_t splats)
{
	for (uint32_t i = 0; i < scene.scene.ladder_count; i++) {
		const struct eco_ladder *l = &scene.ladders[i];
		uint32_t cells[ECO_FRONT_MAX], all = scene.lists[cut->list].primitive_count;
		if (l->points != splats || l->triangles == ECO_NONE)
			continue;
		bool before = l->triangles == cut->list && cut->first == (all > l->total ? all - l->total : 0);
		for (uint32_t k = eco_ladder_front(&scene.scene, l, cells); k-- > 0;)
			before |= cells[k] == cut->list && cut->first == 0;
		return before && cut->scale == 1;
	}
	return false;
}

/* No plant draws both a ladder for the whole plant and anything else. */
UNIT_TEST(a_whole_plant_is_drawn_alone)
{
	uint64_t alone = 0, beside = 0;
	for (uint64_t seed = 1; seed <= 80; seed++) {
		random_scene_splats(&scene, 900 + seed, 0);
		struct eco_request request = random_request(&scene);
		struct eco_plan plan;
		plan_it(&plan, &request);
		for (uint32_t i = 0; i < plan.cut_count; i++)
			for (uint32_t k = 0; k < plan.cut_count; k++) {
				const struct eco_cut *a = &plan.cuts[i], *b = &plan.cuts[k];
				if (a->anchor == ECO_NONE || a->anchor != b->anchor || a->list == b->list
						|| !(scene.lists[a->list].attributes & ECO_ATTR_SPLAT)
						|| stands_before(b, a->list))
					continue;
				bool bands = a->band_first < b->band_end && b->band_first < a->band_end;
				assert_false(bands && a->share_first < b->share_end
					&& b->share_first < a->share_end);
				beside += bands;
				alone += !bands;
			}
		eco_plan_free(&plan);
	}
	assert_true(alone && beside);
}

UNIT_TEST(an_unlimited_budget_draws_every_visible_triangle_once)
{
	random_scene_make(&scene, 7, 0);
	struct eco_request request =
		{ .view = { .eye = { -300, -300, 200 }, .target = { 50, 50, 0 }, .up = { 0, 0, 1 },
		.fov_y_deg = 90,
		.width = 800, .height = 600 }, .vertices = ECO_VERTICES_MAX, .bytes = ECO_BYTES_UNBOUNDED };
	struct eco_plan plan;
	plan_it(&plan, &request);
	uint64_t expected = 0, plants = 0;
	for (uint32_t g = 0; g < scene.scene.group_count; g++) {
		const struct eco_plant *p = &scene.plants[scene.groups[g].plant];
		uint64_t each = 0;
		for (uint32_t l = p->ladder_first; l < p->ladder_first + p->ladder_count; l++)
			if (!(scene.ladders[l].flags & ECO_LADDER_FAR))
				each += lod_ladder_full(&scene.scene, &scene.ladders[l]);
		expected += each * scene.groups[g].count;
		plants += scene.groups[g].count;
	}
	assert_int_equal(plan.visible_plants, plants);
	assert_int_equal(plan.vertices, expected);
	for (uint32_t i = 0; i < plan.cut_count; i++)
		assert_true(plan.cuts[i].anchor != ECO_NONE && plan.cuts[i].scale == 1);
	eco_plan_free(&plan);
}

/* A plan of everything needs no search: the work of four such plans suffices. A smaller budget, which has to be
 * searched, gets a coarser level for it. */
UNIT_TEST(everything_is_full_detail_in_little_work)
{
	uint32_t coarser = 0;
	for (uint32_t i = 0; i < 40; i++) {
		random_scene_sized(&scene, 500 + i, i % 2 ? 6 : 0, (struct random_sizes){ .species = 3, .leaves = 12,
			.elements = 20, .places = 60, .cells = 6 });
		struct eco_request request = random_request(&scene);
		request.vertices = ECO_VERTICES_MAX;
		struct eco_plan full, bounded, searched;
		struct lod_planner_input input = { .scene = &scene.scene, .request = &request };
		input.work_max = 4 * plan_make(&full, input).work;
		assert_true(plan_make(&bounded, input).work <= input.work_max);
		request.vertices--;
		plan_make(&searched, input);
		assert_int_equal(bounded.vertices, full.vertices);
		coarser += searched.vertices < full.vertices;
		eco_plan_free(&full);
		eco_plan_free(&bounded);
		eco_plan_free(&searched);
	}
	print_message("          %u of 40 smaller budgets get less\n", coarser);
	assert_true(coarser > 0);
}

UNIT_TEST(shifting_turning_and_scaling_through_a_placement_changes_only_rounding)
{
	static const double shifts[][3] = { { 1000, -250, 3 }, { 1e6, 1e6, 0 }, { 1e7, -1e7, 100 },
		{ 0, 0, 0 }, { 5, 0, 0 } };
	static const float scales[] = { 1, 1, 1, 64, 0.3f };
	random_scene_make(&scene, 21, 0);
	struct eco_request request = random_request(&scene);
	request.vertices = 20000;
	struct eco_plan plan, moved;
	plan_it(&plan, &request);
	/* a new root that places the old one, scaled, shifted and turned by a quarter */
	uint32_t root = scene.scene.tile_count;
	for (size_t i = 0; i < sizeof shifts / sizeof *shifts; i++) {
		scene_add_tile(&scene, (struct eco_tile){ .summary = ECO_NONE });
		memmove(scene.tiles + 1, scene.tiles, root * sizeof *scene.tiles);
		for (uint32_t c = 0; c < scene.scene.child_count; c++)
			scene.children[c].tile++;
		scene.tiles[0] = (struct eco_tile){ .low = { -1e9, -1e9, -1e9 }, .high = { 1e9, 1e9, 1e9 },
			.summary = ECO_NONE };
		scene_add_child(&scene, 0,
			(struct eco_child){ .tile = 1, .placed = true,
			.at = { shifts[i][0], shifts[i][1], shifts[i][2] },
			.turn = 16384, .scale = scales[i] });
		struct eco_request there = request;
		for (int v = 0; v < 2; v++) {
			double *p = v ? there.view.target : there.view.eye, *from = v ? request.view.target
				: request.view.eye;
			p[0] = shifts[i][0] - scales[i] * from[1];
			p[1] = shifts[i][1] + scales[i] * from[0];
			p[2] = shifts[i][2] + scales[i] * from[2];
		}
		plan_it(&moved, &there);
		assert_int_equal(moved.visible_plants, plan.visible_plants);
		assert_in_range(moved.vertices, plan.vertices - plan.vertices / 100, request.vertices);
		assert_true(moved.sample_distance == plan.sample_distance);
		assert_int_equal(moved.cut_count, plan.cut_count);
		eco_plan_free(&moved);
		/* back to the scene as it was */
		scene.scene.tile_count--;
		scene.scene.child_count--;
		memmove(scene.tiles, scene.tiles + 1, root * sizeof *scene.tiles);
		for (uint32_t c = 0; c < scene.scene.child_count; c++)
			scene.children[c].tile--;
	}
	eco_plan_free(&plan);
}

UNIT_TEST(a_bounded_walk_still_answers)
{
	random_scene_make(&scene, 33, 6);
	struct eco_request request = random_request(&scene);
	request.vertices = 1 << 24;
	struct eco_plan plan;
	struct lod_planner_input input = { .scene = &scene.scene, .request = &request, .tiles_max = 3,
		.placements_max = 2 };
	struct eco_error error = { 0 };
	enum eco_code code = lod_plan(&plan, &input, &error);
	assert_true(code == ECO_OK || code == ECO_TOO_LARGE);
	if (!code) {
		assert_true(plan.vertices <= request.vertices);
		eco_plan_free(&plan);
	}
}

/* Pixels are so narrow, or wide, that numbers nearly end. */
UNIT_TEST(the_narrowest_and_the_widest_views_are_planned)
{
	static const double fov_deg[] = { ECO_FOV_LEAST_DEG, 1e-6, 180 - 1e-6, 180 - ECO_FOV_LEAST_DEG };
	random_scene_make(&scene, 33, 6);
	for (uint32_t i = 0; i < 200; i++) {
		struct eco_request request = random_request(&scene);
		struct eco_plan plan;
		request.view.fov_y_deg = fov_deg[i % 4];
		struct lod_planner_stats stats = plan_it(&plan, &request);
		assert_true(plan.vertices <= request.vertices && stats.wrong >= 0);
		assert_true(plan.prediction.fp >= 0 && plan.prediction.fn >= 0);
		eco_plan_free(&plan);
	}
}

/* All plants stand at one place, so the eye is in all tiles: those beyond the work show their summaries. */
UNIT_TEST(of_plants_around_the_eye_a_bounded_plan_looks_at_some)
{
	random_scene_sized(&scene, 33, 6, (struct random_sizes){ .species = 3, .leaves = 4, .elements = 20,
		.places = 300, .cells = 3 });
	for (uint32_t i = 0; i < scene.scene.tile_count; i++)
		for (int k = 0; k < 3; k++) {
			scene.tiles[i].low[k] -= 1e5;
			scene.tiles[i].high[k] += 1e5;
		}
	struct eco_request request = random_request(&scene);
	request.vertices = 1 << 24;
	uint64_t places[2];
	for (int bounded = 0; bounded < 2; bounded++) {
		struct eco_plan plan;
		places[bounded] = plan_make(&plan, (struct lod_planner_input){ .scene = &scene.scene,
			.request = &request, .work_max = bounded ? 1 << 14 : 0 }).places;
		assert_true(plan.vertices > 0 && plan.vertices <= request.vertices);
		eco_plan_free(&plan);
	}
	assert_true(4 * places[1] < places[0]);
}

/* A tile without a summary is opened wherever it is in view. */
UNIT_TEST(a_bounded_plan_gives_up_where_no_summary_stands_for_too_many_plants)
{
	const uint32_t leaves = 4, nested = 25000;
	random_scene_sized(&scene, 33, nested, (struct random_sizes){ .species = 3, .leaves = leaves,
		.elements = 20, .places = 300, .cells = 3 });
	struct eco_request request = random_request(&scene);
	request.view.eye[2] = 3000;
	request.view.eye[0] = request.view.target[0] = request.view.target[1] = 0;
	request.view.fov_y_deg = 60;
	scene.tiles[0].summary = ECO_NONE;
	for (int bare = 0; bare < 2; bare++) {
		struct lod_planner_stats stats = { 0 };
		struct lod_planner_input input = { .scene = &scene.scene, .request = &request,
			.work_max = 1 << 20, .stats = &stats };
		struct eco_plan plan;
		scene.tiles[1 + leaves].summary = bare ? ECO_NONE : scene.tiles[1 + leaves].summary;
		enum eco_code code = lod_plan(&plan, &input, NULL);
		if (code != (bare ? ECO_TOO_LARGE : ECO_OK) || stats.places > ECO_OPEN_PLANTS_MAX)
			fail_msg("%s: status %d, %llu plants looked at", bare ? "bare" : "summed up", code,
				(unsigned long long)stats.places);
		eco_plan_free(&plan);
	}
}

/* Tiles say how many plants they have. */
UNIT_TEST(a_walk_that_is_too_far_looks_at_no_plant)
{
	random_scene_make(&scene, 33, 6);
	uint32_t *gates = calloc(scene.scene.plant_count + 1u, sizeof *gates);
	const struct eco_tile *root = &scene.scene.tiles[scene.scene.root];
	struct eco_view view = { .up = { 0, 1, 0 }, .fov_y_deg = 90, .width = 800, .height = 600 };
	struct lod_visible_tree visible;
	for (int i = 0; i < 3; i++)
		view.target[i] = view.eye[i] = (root->low[i] + root->high[i]) / 2;
	view.eye[2] += 2 * (root->high[0] - root->low[0] + root->high[1] - root->low[1]);
	assert_good(lod_visible_tree_init(&visible, &scene.scene, &view, 1000000, 100000, &cause));
	visible.bounds.places = 1;
	assert_code(lod_visible_tree_count(&visible, 0, gates, &cause), ECO_TOO_LARGE, "");
	assert_int_equal(visible.places, 0);
	assert_good(lod_visible_tree_restart(&visible, &cause));
	visible.bounds.places = 0;
	assert_good(lod_visible_tree_count(&visible, 1, gates, &cause));
	uint32_t nodes = visible.node_count;
	uint64_t plants = visible.plants, places = visible.places;
	visible.bounds.places = 1;              /* then all stays as it was */
	assert_code(lod_visible_tree_count(&visible, 0, gates, &cause), ECO_TOO_LARGE, "");
	assert_int_equal(visible.node_count, nodes);
	assert_int_equal(visible.plants, plants);
	assert_int_equal(visible.places, places);
	assert_int_equal(visible.nodes[0].state, LOD_SUMMARY);
	visible.bounds.places = 0;
	assert_good(lod_visible_tree_count(&visible, 0, gates, &cause));
	assert_true(visible.places > 1 && visible.nodes[0].state == LOD_OPEN);
	visible.bounds.cells = 1;
	for (uint32_t i = 0; i < scene.scene.plant_count; i++)
		gates[i] = ECO_BANDS * ECO_SHARE_ONE;
	assert_code(lod_visible_tree_count(&visible, 0, gates, &cause), ECO_TOO_LARGE, "");
	assert_int_equal(visible.nodes[0].state, LOD_OPEN);
	visible.bounds.cells = 0;
	visible.cells_most = 1;
	for (uint32_t i = 0; i < scene.scene.plant_count; i++)
		gates[i] = ECO_SHARE_ONE;
	assert_code(lod_visible_tree_count(&visible, 0, gates, &cause), ECO_TOO_LARGE, "");
	lod_visible_tree_free(&visible);
	free(gates);
}

