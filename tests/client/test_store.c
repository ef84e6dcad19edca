/* The store of a client, and the instances that a plan's cuts draw: streams of a small scene, whole, repeated
 * and wrong. */
#include <stdlib.h>
#include <string.h>

#include "client-min/view_record.h"
#include "client-min/view_table.h"
#include "client-min/view_select.h"
#include "tests/support/plan_twin.h"
#include "tests/support/unit_test.h"
#include "tests/support/view_scene.h"

/* Keys that share a slot stay found when others before them go: the twin is an array. */
UNIT_TEST(table_forgets_what_was_removed)
{
	FREED(view_table) table = { 0 };
	uint32_t twin[600], count = 0, random = 1;
	memset(twin, 0xff, sizeof twin);
	view_table_remove(&table, 5);
	for (uint32_t step = 0; step < 60000; step++) {
		random = random * 1664525u + 1013904223u;
		uint32_t key = (random >> 8) % 600;
		if (random >> 30) {
			view_table_remove(&table, key);
			count -= twin[key] != UINT32_MAX;
			twin[key] = UINT32_MAX;
		} else {
			assert_true(view_table_put(&table, key, step));
			count += twin[key] == UINT32_MAX;
			twin[key] = step;
		}
		assert_int_equal(table.count, count);
		for (uint32_t k = step % 7; k < 600; k += 7)
			assert_int_equal(view_table_get(&table, k), twin[k]);
	}
}

UNIT_TEST(stream_fills_the_store)
{
	struct eco_view view = scene_view();
	struct eco_plan plan;
	struct eco_error error = { 0 };
	scene_plan(&grove, &view, 1, &plan);
	struct view_store *store = scene_store(&grove, &plan, &error);
	assert_string_equal(error.text, "");
	assert_non_null(store);
	assert_true(view_store_complete(store));
	assert_string_equal(view_store_scene_name(store), "test");
	assert_true(view_store_near_m(store) == 0.1);
	assert_true(view_store_plan(store)->vertices == plan.vertices);
	uint32_t columns, rows;
	view_store_ground(store, &columns, &rows);
	assert_true(columns == 17 && rows == 15);
	assert_true(view_store_list(store, L_GROUND)->tile.level == 0
		&& view_store_list(store, L_GROUND)->tile.column == 0);
	assert_int_equal(view_store_plant(store, 0)->plant.anchor_count, 3);
	assert_null(view_store_plant(store, 2));
	assert_null(view_store_list(store, L_COUNT));
	for (uint32_t id = 0; id < L_COUNT; id++) {
		const struct view_list *list = view_store_list(store, id);
		uint32_t chunks = scene_needs(&grove, &plan, id), elements = 0;
		for (uint32_t c = 0; c < chunks; c++)
			elements += grove.chunks[grove.lists[id].chunk_first + c].element_count;
		if (!chunks) {
			assert_null(list);
			continue;
		}
		assert_int_equal(list->chunk_count, chunks);
		assert_int_equal(list->elements.element_count, elements);
		assert_int_equal(list->marks[chunks - 1].corners, list->elements.corner_count);
	}
	assert_true(view_store_stats(store).memory_bytes > 0);
	view_store_free(store);
	eco_plan_free(&plan);
}

/* ---- Streams that are wrong ---- */

enum fault { SAME_CHUNK_TWICE, CHUNK_SKIPPED, CHUNK_WITHOUT_LIST, PLAN_BEYOND_HELD, PLAN_OF_UNKNOWN_LIST,
	PLAN_OF_INSTANCES, END_DISAGREES, GROUND_MISSING,
	GROUND_IN_PART, GROUND_ELSEWHERE, COLOR_OUTSIDE, FAULTS };

static void write_fault(enum fault fault, struct eco_plan *plan, struct eco_writer *w)
{
	uint32_t number = 0;
	struct scene_builder other = grove;
	struct eco_list lists[L_COUNT];
	other.scene.lists = other.lists = memcpy(lists, grove.lists, sizeof lists);
	*w = (struct eco_writer){ 0 };
	scene_frame(w, &grove, ECO_FRAME_SCENE, &number, 0, 0);
	scene_frame(w, &grove, ECO_FRAME_BUNDLE, &number, 0, SCENE_PLANT);
	if (fault == COLOR_OUTSIDE) {
		other.lists[L_LEAVES].palette_count = 1;
		scene_frame(w, &other, ECO_FRAME_BUNDLE, &number, L_LEAVES, SCENE_RECORD);
	} else if (fault != CHUNK_WITHOUT_LIST) {
		scene_frame(w, &grove, ECO_FRAME_BUNDLE, &number, L_LEAVES, SCENE_RECORD);
	}
	scene_frame(w, &grove, ECO_FRAME_BUNDLE, &number, L_LEAVES, fault == CHUNK_SKIPPED);
	plan->cuts[0] = scene_rule(A_TREE, L_LEAVES, 0, fault == PLAN_BEYOND_HELD ? 500 : 10, 1, 0,
		ECO_BANDS);
	plan->cut_count = 1;
	plan->run_count = 0;
	plan->vertices = 0;
	if (fault == GROUND_MISSING || fault == GROUND_IN_PART)
		plan->cuts[0] = (struct eco_cut){ .list = L_GROUND, .end = fault == GROUND_IN_PART ? 17
			: 17 * 15, .scale = 1, .anchor = ECO_NONE };
	switch (fault) {
	case SAME_CHUNK_TWICE:
		scene_frame(w, &grove, ECO_FRAME_BUNDLE, &number, L_LEAVES, 0);
		break;
	case GROUND_IN_PART:
	case GROUND_ELSEWHERE:
		if (fault == GROUND_ELSEWHERE)
			other.lists[L_GROUND].level = 2;
		scene_frame(w, &other, ECO_FRAME_BUNDLE, &number, L_GROUND, SCENE_RECORD);
		scene_frame(w, &other, ECO_FRAME_BUNDLE, &number, L_GROUND, 0);
		break;
	case PLAN_OF_UNKNOWN_LIST:
		plan->cuts[0].list = L_WOOD;
		break;
	case PLAN_OF_INSTANCES:
		scene_frame(w, &grove, ECO_FRAME_BUNDLE, &number, L_TREES, SCENE_RECORD);
		scene_frame(w, &grove, ECO_FRAME_BUNDLE, &number, L_TREES, 0);
		plan->cuts[0].list = L_TREES;
		break;
	default:
		break;
	}
	wire_put_plan(w, &number, plan);
	wire_put_end(w, &number, fault == END_DISAGREES, 0);
}

/* Anchors of cells come with the first list of a cell: the plant once more. */
UNIT_TEST(cells_are_known_once_they_are_described)
{
	OWNED(view_store) *store;
	struct view_store_options options = { 0 };
	FREED(eco_writer) w = { 0 };
	struct eco_error error = { 0 };
	uint32_t number = 0;
	scene_frame(&w, &grove, ECO_FRAME_SCENE, &number, 0, 0);
	for (int turn = 0; turn < 3; turn++) {
		struct eco_wire_bundle bundle;
		struct eco_frame_mark mark = wire_bundle_begin(&w, &number, &bundle);
		eco_wire_bundle_plant(&bundle, &grove.scene, 0, turn == 1);
		wire_bundle_end(&w, mark, &bundle, NULL, 0);
	}
	assert_int_equal(view_store_new(&store, &options, NULL), ECO_OK);
	struct eco_wire_parser *parser;
	assert_int_equal(eco_wire_parser_new(&parser, &view_store_events, store, &error), ECO_OK);
	view_store_begin(store);
	for (size_t at = 0, all = 0; at < w.size; at++) {
		assert_int_equal(eco_wire_feed(parser, w.bytes + at, 1, &error), ECO_OK);
		const struct view_plant *plant = view_store_plant(store, 0);
		if (!plant)
			continue;
		assert_true(plant->anchor_count == 1 || plant->anchor_count == plant->plant.anchor_count);
		assert_true(plant->anchor_count >= all && plant->plant.anchor_count == 3);
		all = plant->anchor_count;
		assert_memory_equal(plant->anchors, grove.scene.anchors, all * sizeof *plant->anchors);
	}
	assert_int_equal(view_store_plant(store, 0)->anchor_count, 3);
	assert_int_equal(view_store_stats(store).memory_bytes,
		sizeof(struct view_plant) + 3 * sizeof(struct eco_anchor));
	eco_wire_parser_free(parser);
}

UNIT_TEST(wrong_streams_are_refused_with_a_reason)
{
	static const char *const reasons[FAULTS] = { "chunk 0", "chunk", "", "are held", "was not sent",
		"not drawable", "vertices", "was not sent", "a tile of ground",
		"a tile of ground", "palette" };
	struct eco_view view = scene_view();
	for (int fault = 0; fault < FAULTS; fault++) {
		OWNED(view_store) *store;
		struct view_store_options options = { 0 };
		struct eco_error error = { 0 };
		FREED(eco_writer) w;
		FREED(eco_plan) plan;
		scene_plan(&grove, &view, 1, &plan);
		assert_int_equal(view_store_new(&store, &options, NULL), ECO_OK);
		write_fault((enum fault)fault, &plan, &w);
		enum eco_code code = scene_feed(store, &w, &error);
		if (code == ECO_OK || !strstr(error.text, reasons[fault]))
			print_message("fault %d: code %d, '%s'\n", fault, code, error.text);
		assert_int_not_equal(code, ECO_OK);
		assert_non_null(strstr(error.text, reasons[fault]));
	}
}

/* ---- Selection ---- */

UNIT_TEST(selection_draws_what_the_plan_says)
{
	for (int step = 0; step < 12; step++) {
		struct eco_view view = scene_view();
		view.eye[0] += 5 * step;
		view.eye[1] += step;
		AT_END(scene_release) struct scene_held h = scene_hold_view(&grove, view, 0.5 + step / 24.0);
		scene_select(&h);
		const struct view_selection s = h.selection;
		assert_true(s.vertices == h.plan.vertices && s.visible_plants == h.plan.visible_plants);
		uint32_t pairs = 0;
		for (uint32_t c = 0; c < s.cut_count; c++)
			for (uint32_t m = s.member_first[c]; m < s.member_first[c + 1]; m++, pairs++) {
				uint32_t i = s.members[m], found = 0;
				for (uint32_t p = s.cut_first[i]; p < s.cut_first[i + 1]; p++)
					found += s.cuts[p] == c;
				assert_int_equal(found, 1);
			}
		assert_int_equal(pairs, s.cut_first[s.instance_count]);
	}
}

/* The summary, and trees without their cells: none, all that are not near, or all. */
UNIT_TEST(selection_counts_what_is_not_full_detail)
{
	const uint32_t ends[] = { ECO_GATE_OPEN, eco_gate_place(97, 0), 1 };
	uint64_t coarse[3], trees = 0;
	for (int k = 0; k < 3; k++) {
		AT_END(scene_release) struct scene_held h = scene_hold(&grove);
		view_store_free(h.store);
		h.plan.gates[0].end = ends[k];
		h.plan.vertices = plan_twin_vertices(&grove.scene, &h.plan, &h.view, &h.plan.visible_plants);
		h.store = scene_store(&grove, &h.plan, NULL);
		scene_select(&h);
		coarse[k] = h.selection.coarse;
		trees = 0;
		for (uint32_t i = 0; i < h.selection.instance_count; i++)
			trees += h.selection.instances[i].plant == 0;
	}
	assert_int_equal(coarse[0], 1);
	assert_int_equal(coarse[2], 1 + trees);
	assert_true(coarse[1] > coarse[0] && coarse[1] < coarse[2]);
}

UNIT_TEST(selection_refuses_a_plan_that_miscounts)
{
	struct eco_view view = scene_view();
	FREED(eco_plan) plan;
	struct lod_eye eye;
	struct view_selection s;
	scene_plan(&grove, &view, 1, &plan);
	plan.vertices++;
	lod_eye_make(&eye, &view);
	OWNED(view_store) *store = scene_store(&grove, &plan, NULL);
	assert_code(view_select_make(&s, store, &eye, &cause), ECO_DAMAGED, "disagree");
	assert_null(s.instances);
}

UNIT_TEST(blends_are_recognised)
{
	AT_END(scene_release) struct scene_held h = scene_hold(&grove);
	scene_select(&h);
	const struct view_selection s = h.selection;
	for (uint32_t c = 0; c < s.cut_count; c++) {
		static const uint8_t roles[L_COUNT] = { [L_WOOD] = VIEW_ROLE_TRIANGLES,
			[L_LINES] = VIEW_ROLE_LINES, [L_LEAVES] = VIEW_ROLE_TRIANGLES,
			[L_POINTS] = VIEW_ROLE_POINTS, [L_LOW] = VIEW_ROLE_BLEND_TRIANGLES,
			[L_LOW_POINTS] = VIEW_ROLE_BLEND_POINTS, [L_SIMPLE] = VIEW_ROLE_BLEND_SIMPLE,
			[L_HIGH_POINTS] = VIEW_ROLE_BLEND_POINTS,
				[L_BUSH] = VIEW_ROLE_TRIANGLES, [L_SUMMARY] = VIEW_ROLE_SUMMARY };
		assert_int_equal(s.roles[c], roles[view_store_plan(h.store)->cuts[c].list]);
	}
}

/* The shader adds a placement's path to a record's owner; that must be what the library says. */
UNIT_TEST(summary_records_carry_owners)
{
	AT_END(scene_release) struct scene_held h = scene_hold(&grove);
	const struct view_list *list = view_store_list(h.store, L_SUMMARY);
	FREED_MEMORY uint32_t *words = malloc((size_t)list->elements.primitive_count * 8 * 4);
	assert_int_equal(view_record_texels(&list->list), 2);
	assert_int_equal(view_record_write(list, 0, list->chunk_count, words, NULL), ECO_OK);
	for (uint32_t i = 0; i < list->elements.primitive_count; i++)
		for (uint32_t path = 0; path < 3; path++) {
			const uint32_t *t = words + 8 * i + 4;
			uint32_t key = eco_owner_child(path),
				high = (t[1] & ~t[2]) | ((t[1] + view_record_path(key)) & t[2]);
			assert_true((t[0] | (uint64_t)high << 32) == view_summary_owner(list, i, key));
		}
}

UNIT_MAIN(scene_open, scene_close)
