/* An explanation says of every cut what it draws and why, adds up to the plan, and changes nothing of it. */
#include <math.h>
#include <string.h>

#include "ecofiles/format/wire.h"
#include "lod/plan/explain.h"
#include "lod/plan/planner.h"
#include "tests/support/plan_twin.h"
#include "tests/support/scene_random.h"
#include "tests/support/unit_test.h"

static struct scene_builder scene;

/* Plants far away, as many as a summary replaces when vertices are few. */
static void make_crowd(uint64_t seed)
{
	random_stand_make(&scene, &(struct random_stand){ .height_m = 10, .leaves = 300, .area = 30,
		.shares = { .01f, .1f, .5f, 1 }, .errors = { .4f, .3f, .2f, 0 } });
	scene.state = seed;
	scene_add_tile(&scene, (struct eco_tile){ .low = { -30, -30, 0 }, .high = { 600, 600, 20 },
		.instance_count = 600, .area = 30 * 600, .summary = ECO_NONE });
	uint32_t tile = random_crowd(&scene, (struct eco_tile){ .low = { 400, 400, 0 }, .high = { 600, 600, 10 },
		.instance_count = 600, .area = 30 * 600 }, (const double[]){ 400, 400 }, 200);
	scene.tiles[tile].summary = scene_add_bare(&scene, &(struct scene_row){ .kind = ECO_LIST_POINTS,
		.attributes = ECO_ATTR_PLANT, .owner = tile, .other = ECO_NONE }, 200, 200);
}

static void make_scene(uint64_t seed)
{
	if (seed > 80)
		make_crowd(seed);
	else
		(seed <= 40 ? random_scene_make : random_scene_splats)(&scene, seed, seed % 3 ? 0 : 4);
}

static struct eco_request request_of(uint64_t vertices)
{
	return (struct eco_request){ .view = random_view(&scene), .bytes = ECO_BYTES_UNBOUNDED,
		.vertices = vertices };
}

static void explain(struct eco_plan *plan, struct lod_explanation *why, const struct eco_request *request,
	lod_rule *rule)
{
	plan_make(plan, (struct lod_planner_input){ .scene = &scene.scene, .request = request, .rule = rule,
		.explanation = why });
}

static bool covers(const struct eco_cut *cut, const struct eco_cut *row)
{
	return cut->list == row->list && cut->first == row->first && cut->end == row->end
		&& cut->anchor == row->anchor && cut->placement == row->placement
		&& cut->share_first == row->share_first && cut->share_end == row->share_end
		&& (cut->anchor == ECO_NONE
		|| (cut->band_first <= row->band_first && row->band_end <= cut->band_end));
}

/* Every cut has its rows, one for each of its bands that plants stand in; the rows without a cut are tiles
 * that draw their plants. */
static void check_cuts(const struct eco_plan *plan, const struct lod_explanation *why)
{
	for (uint32_t i = 0; i < why->count; i++) {
		uint32_t found = 0;
		for (uint32_t c = 0; c < plan->cut_count; c++)
			found += covers(&plan->cuts[c], &why->rows[i].cut);
		assert_int_equal(found, why->rows[i].reason.why != LOD_WHY_PLANTS);
	}
	for (uint32_t c = 0; c < plan->cut_count; c++) {
		const struct eco_cut *cut = &plan->cuts[c];
		bool first = false, last = false;        /* no cut begins or ends where nothing stands */
		for (uint32_t i = 0; i < why->count; i++) {
			const struct eco_cut *row = &why->rows[i].cut;
			bool covered = covers(cut, row);
			first |= covered && (cut->anchor == ECO_NONE || row->band_first == cut->band_first);
			last |= covered && (cut->anchor == ECO_NONE || row->band_end == cut->band_end);
		}
		assert_true(first && last);
	}
}

static void check_rows(const struct eco_plan *plan, const struct lod_explanation *why, lod_rule *rule,
	uint64_t seen[LOD_WHY_COUNT])
{
	uint64_t vertices = 0;
	for (uint32_t i = 0; i < why->count; i++) {
		const struct lod_explained *row = &why->rows[i];
		const struct lod_reason *reason = &row->reason;
		char text[200], line[400];
		vertices += row->vertices;
		seen[reason->why]++;
		assert_true(isfinite(reason->gain) && reason->next >= 0 && isfinite(reason->next)
			&& reason->margin >= 0);
		if (reason->why == LOD_WHY_STEP)
			assert_true(reason->next <= why->lambda * (1 + 1e-6));
		if (reason->why == LOD_WHY_ALL)
			assert_true(reason->next == 0);
		if (rule == lod_rule_deussen)
			assert_true(reason->why == LOD_WHY_DISTANCE || reason->why == LOD_WHY_LEFT_OVER
				|| reason->why == LOD_WHY_GROUND);
		lod_explain_text(text, sizeof text, why, row);
		assert_true(strlen(text) > 8 && strlen(text) <= 120);
		lod_explain_line(line, sizeof line, &scene.scene, why, row);
		assert_true(strlen(line) <= 300);
	}
	assert_int_equal(vertices, plan->vertices);
}

UNIT_TEST(rows_add_up_to_the_plan)
{
	uint64_t seen[LOD_WHY_COUNT] = { 0 };
	for (uint64_t seed = 1; seed <= 100; seed++) {
		make_scene(seed);
		for (int i = 0; i < 10; i++) {
			lod_rule *rule = i % 5 == 4 ? lod_rule_deussen : lod_rule_optimal;
			struct eco_request request = request_of((uint64_t)1 << 2 * i);
			struct lod_explanation why = { 0 };
			struct eco_plan plan;
			explain(&plan, &why, &request, rule);
			assert_int_equal(why.omitted, 0);
			check_cuts(&plan, &why);
			check_rows(&plan, &why, rule, seen);
			eco_plan_free(&plan);
			lod_explanation_free(&why);
		}
	}
	for (int w = 0; w < LOD_WHY_COUNT; w++)
		print_message("          %s: %llu\n", lod_why_name((enum lod_why)w), (unsigned long long)seen[w]);
	assert_true(seen[LOD_WHY_STEP] && seen[LOD_WHY_LEFT_OVER] && seen[LOD_WHY_ALL]
		&& seen[LOD_WHY_DISTANCE] && seen[LOD_WHY_PLANTS]);
	assert_true(seen[LOD_WHY_SUMMARY] && seen[LOD_WHY_GIVES_WAY] && seen[LOD_WHY_PART] && seen[LOD_WHY_WHOLE]);
}

/* Few bytes: ground gives way, or nothing but ground is left. */
UNIT_TEST(ground_that_gave_way_has_its_rows)
{
	for (uint64_t seed = 1; seed <= 8; seed++) {
		struct random_pack *pack = random_pack_make(seed, 0, 10);
		for (uint64_t bytes = 300; bytes < 100000; bytes *= 3)
			for (int rule = 0; rule < 2; rule++) {
				struct eco_request request = { .view = random_view(&pack->r), .vertices = 1000, .bytes = bytes };
				struct lod_explanation why = { 0 };
				struct eco_plan plan;
				plan_make(&plan, (struct lod_planner_input){ .scene = &pack->pack.scene, .request = &request,
					.rule = rule ? lod_rule_deussen : lod_rule_optimal, .explanation = &why, .sent = true });
				uint32_t cuts = 0, rows = 0;
				for (uint32_t i = 0; i < plan.cut_count; i++)
					cuts += pack->pack.scene.lists[plan.cuts[i].list].kind == ECO_LIST_GROUND;
				for (uint32_t i = 0; i < why.count; i++)
					rows += why.rows[i].reason.why == LOD_WHY_GROUND;
				assert_true(cuts > 0 && cuts == rows);
				eco_plan_free(&plan);
				lod_explanation_free(&why);
			}
		random_pack_free(pack);
	}
}

/* In a scene whose tiles are all open: of each plant by its distance. */
UNIT_TEST(expected_pixels_add_up_by_distance)
{
	static const double at[] = { 0, 7.99, 8, 63, 64, 1e9 };
	static const uint32_t bins[] = { 0, 0, 1, 3, 4, 4 };
	for (size_t i = 0; i < sizeof at / sizeof *at; i++)
		assert_int_equal(lod_distance_of(at[i]), bins[i]);
	for (uint64_t seed = 1; seed <= 20; seed++) {
		random_scene_make(&scene, seed, 0);
		struct eco_request request = request_of(ECO_VERTICES_MAX);
		struct lod_explanation why = { 0 };
		struct eco_plan plan;
		double sum = 0;
		explain(&plan, &why, &request, lod_rule_optimal);
		for (uint32_t i = 0; i < LOD_DISTANCES; i++)
			sum += why.expected_px[i];
		assert_int_equal(sum > 0, plan.visible_plants > 0);
		eco_plan_free(&plan);
		lod_explanation_free(&why);
	}
}

UNIT_TEST(a_plan_is_the_same_with_and_without)
{
	random_scene_make(&scene, 5, 3);
	for (int i = 0; i < 40; i++) {
		lod_rule *rule = i % 2 ? lod_rule_deussen : lod_rule_optimal;
		struct eco_request request = request_of((uint64_t)1 << (i % 20));
		struct lod_explanation why = { 0 };
		struct eco_writer bytes[2] = { { 0 }, { 0 } };
		for (int k = 0; k < 2; k++) {
			struct eco_plan plan;
			explain(&plan, k ? &why : NULL, &request, rule);
			eco_wire_write_plan(&bytes[k], &plan);
			eco_plan_free(&plan);
		}
		assert_int_equal(bytes[0].size, bytes[1].size);
		assert_memory_equal(bytes[0].bytes, bytes[1].bytes, bytes[0].size);
		eco_writer_free(&bytes[0]);
		eco_writer_free(&bytes[1]);
		lod_explanation_free(&why);
	}
}

/* Whatever the figures, a sentence has no word of the planner and fits. */
static void assert_plain(const char *text)
{
	static const char *const words[] = { "hull", "lambda", "summary", "ladder", "cut", "organ", "slot" };
	for (size_t i = 0; i < sizeof words / sizeof *words; i++)
		if (strstr(text, words[i]))
			fail_msg("%s: \"%s\"", words[i], text);
	if (strlen(text) > 120)
		fail_msg("%zu bytes: %s", strlen(text), text);
}

UNIT_TEST(every_reason_is_plain_and_fits)
{
	static const double margins[] = { 0, 1e-9, 0.1234567, 1, 123456789, 1e300, INFINITY };
	const struct lod_explanation why = { .lambda = 1.234567e5, .sample_distance = 1.234567e-5 };
	for (int w = 0; w < LOD_WHY_COUNT; w++)
		for (size_t i = 0; i < sizeof margins / sizeof *margins; i++)
			for (size_t k = 0; k < 6; k++) {
				char text[200];
				lod_explain_text(text, sizeof text, &why, &(struct lod_explained){ .reason = {
					.why = (enum lod_why)w, .next = margins[k], .margin = margins[i],
					.share = k % 2 } });
				assert_plain(text);
			}
}
