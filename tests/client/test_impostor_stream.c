/* Streams of impostors: what a store holds of them, level by level, and which it refuses. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk.h"
#include "lod/impostor.h"
#include "tests/support/plan_twin.h"
#include "tests/support/unit_test.h"
#include "tests/support/view_scene.h"

#define LEVELS ECO_IMPOSTOR_LEVELS
#define LIST "list 15"
_Static_assert(L_IMPOSTOR == 15, "LIST says which it is");

static int open_all(void **state)
{
	scene_open(state);
	scene_make_impostor(&grove, 200);
	assert_int_equal(grove.lists[L_IMPOSTOR].chunk_count, LEVELS);
	return 0;
}

/* Every tree as the levels [first, end) of its impostor, and nothing else. */
static struct eco_plan plan_levels(uint32_t first, uint32_t end)
{
	struct eco_view view = scene_view();
	struct eco_plan plan;
	scene_plan(&grove, &view, 1, &plan);
	plan.cuts[0] = scene_rule(A_TREE, L_IMPOSTOR, first, end, 1, 0, ECO_BANDS);
	plan.cut_count = 1;
	plan.vertices = plan_twin_vertices(&grove.scene, &plan, &view, &plan.visible_plants);
	return plan;
}

/* ---- What is held ---- */

/* A plan of one level needs those before it, too; what is held already is not sent again. */
UNIT_TEST(levels_are_held_as_a_prefix_and_extended)
{
	FREED(eco_plan) small = plan_levels(0, 1), large = plan_levels(LEVELS - 1, LEVELS);
	struct eco_error error = { 0 };
	FREED(eco_writer) w;
	OWNED(view_store) *store = scene_store(&grove, &small, &error);
	assert_string_equal(error.text, "");
	const struct view_list *list = view_store_list(store, L_IMPOSTOR);
	assert_int_equal(list->chunk_count, 1);
	uint64_t before = view_store_stats(store).memory_bytes, more = 0;
	uint32_t held[L_COUNT];
	scene_holdings(store, held);
	assert_int_equal(held[L_IMPOSTOR], 1);
	scene_stream(&grove, &large, held, &w);
	assert_ok(scene_feed(store, &w, &error), error);
	assert_int_equal(list->chunk_count, LEVELS);
	for (uint32_t i = 0; i < LEVELS; i++) {
		assert_memory_equal(&list->impostors[i].size, &eco_impostor_sizes[i],
			sizeof *eco_impostor_sizes);
		assert_int_equal(list->marks[i].primitives, i + 1);
		more += i ? sizeof *list->impostors + lod_impostor_bytes(&list->impostors[i]) : 0;
	}
	assert_true(view_store_stats(store).memory_bytes == before + more);
}

/* ---- What is refused ---- */

enum fault { SOUND, SWAPPED, TWICE, NO_BODY, NO_LEVEL, CUT_OFF, ONE_BYTE, TWO_PRIMITIVES, TWO_ELEMENTS,
	NOT_HELD, BOTH_LEVELS, TOO_MANY_CHUNKS, FAULTS };

static const struct { enum eco_code code; const char *says; } faults[FAULTS] = {
	[SOUND] = { ECO_OK, "" },
	[SWAPPED] = { ECO_DAMAGED, LIST ", chunk 0: level 1 of an impostor" },
	[TWICE] = { ECO_DAMAGED, LIST ", chunk 1: level 0 of an impostor" },
	[NO_BODY] = { ECO_DAMAGED, LIST ", chunk 1: " },
	[NO_LEVEL] = { ECO_DAMAGED, LIST ", chunk 1: impostor: " },
	[CUT_OFF] = { ECO_DAMAGED, LIST ", chunk 1: impostor: level 1 is damaged" },
	[ONE_BYTE] = { ECO_DAMAGED, LIST ", chunk 1: impostor: " },
	[TWO_PRIMITIVES] = { ECO_DAMAGED, LIST ", chunk 0: chunk: 1 elements cannot have 2 primitives" },
	[TWO_ELEMENTS] = { ECO_DAMAGED, LIST ", chunk 0: chunk: a file is one element, not 2" },
	[NOT_HELD] = { ECO_DAMAGED, "cut 0 of the plan draws [2,3) of " LIST ", of which 2 are held" },
	[BOTH_LEVELS] = { ECO_DAMAGED, "cut 0 of the plan draws 2 levels of " LIST ", an impostor, not one" },
	[TOO_MANY_CHUNKS] = { ECO_DAMAGED, LIST ": its levels are too many, or not an element each" },
};

/* The first two levels of the grove, with copies of payloads that may be written to, under hashes that are right. */
static void damage(struct eco_list *list, struct eco_chunk *chunks, uint8_t **payloads, enum fault fault)
{
	const uint32_t from[2] = { fault == SWAPPED, fault != TWICE };
	const struct eco_chunk sound[2] = { chunks[0], chunks[1] };
	const uint8_t *whole[2] = { payloads[0], payloads[1] };
	for (int i = 0; i < 2; i++) {
		uint32_t size = chunks[i].size_bytes = sound[from[i]].size_bytes;
		payloads[i] = memcpy(malloc(size), whole[from[i]], size);
	}
	if (fault == NO_BODY)
		memcpy(payloads[1], &(float){ NAN }, sizeof(float));
	if (fault == NO_LEVEL)
		payloads[1][24] = LEVELS;
	if (fault == CUT_OFF || fault == ONE_BYTE)
		chunks[1].size_bytes = fault == ONE_BYTE ? 1 : chunks[1].size_bytes - 1;
	if (fault == TWO_PRIMITIVES || fault == TWO_ELEMENTS)
		chunks[0].primitive_count = 2;
	chunks[0].element_count += fault == TWO_ELEMENTS;
	if (fault == TOO_MANY_CHUNKS)
		list->primitive_count = list->element_count = list->chunk_count = LEVELS + 1;
	for (int i = 0; i < 2; i++)
		chunks[i].id = eco_chunk_hash(payloads[i], chunks[i].size_bytes);
}

/* Two levels, and a plan of the second. */
static struct eco_writer stream_of(enum fault fault)
{
	struct eco_list *list = &grove.lists[L_IMPOSTOR], kept = *list;
	struct eco_chunk *chunks = grove.chunks + list->chunk_first, sound[2] = { chunks[0], chunks[1] };
	uint8_t **payloads = grove.payloads + list->chunk_first, *whole[2] = { payloads[0], payloads[1] };
	FREED(eco_plan) plan = plan_levels(fault == NOT_HELD ? 2 : fault != BOTH_LEVELS,
		fault == NOT_HELD ? 3 : 2);
	struct eco_writer w = { 0 };
	uint32_t number = 0;
	plan.run_count = 0;
	plan.vertices = 0;
	damage(list, chunks, payloads, fault);
	scene_frame(&w, &grove, ECO_FRAME_SCENE, &number, 0, 0);
	scene_frame(&w, &grove, ECO_FRAME_BUNDLE, &number, 0, SCENE_PLANT);
	scene_frame(&w, &grove, ECO_FRAME_BUNDLE, &number, L_IMPOSTOR, SCENE_RECORD);
	for (uint32_t i = 0; i < 2; i++)
		scene_frame(&w, &grove, ECO_FRAME_BUNDLE, &number, L_IMPOSTOR, i);
	wire_put_plan(&w, &number, &plan);
	wire_put_end(&w, &number, 0, 0);
	*list = kept;
	for (int i = 0; i < 2; i++) {
		free(payloads[i]);
		payloads[i] = whole[i];
		chunks[i] = sound[i];
	}
	return w;
}

UNIT_TEST(wrong_levels_are_refused_by_list_and_chunk)
{
	for (int fault = 0; fault < FAULTS; fault++) {
		struct eco_error error = { 0 };
		OWNED(view_store) *store;
		FREED(eco_writer) w = stream_of((enum fault)fault);
		assert_int_equal(view_store_new(&store, &(struct view_store_options){ 0 }, NULL), ECO_OK);
		enum eco_code code = scene_feed(store, &w, &error);
		if (code != faults[fault].code || !strstr(error.text, faults[fault].says))
			fail_msg("fault %d: code %d, '%s'", fault, code, error.text);
	}
}

UNIT_MAIN(open_all, scene_close)
