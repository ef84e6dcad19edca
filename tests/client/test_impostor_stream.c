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

static const uint8_t *payload_of(uint32_t level, size_t *size)
{
	uint32_t chunk = grove.lists[L_IMPOSTOR].chunk_first + level;
	*size = grove.chunks[chunk].size_bytes;
	return grove.payloads[chunk];
}

/* ---- What is held ---- */

/* A plan of one level needs those before it, too; what is held already is not sent again. */
UNIT_TEST(levels_are_held_as_a_prefix_and_extended)
{
	struct eco_plan small = plan_levels(0, 1), large = plan_levels(LEVELS - 1, LEVELS);
	struct eco_error error = { 0 };
	struct eco_writer w;
	struct view_store *store = scene_store(&grove, &small, &error);
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
	eco_writer_free(&w);
	view_store_free(store);
	eco_plan_free(&small);
	eco_plan_free(&large);
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
	[TOO_MANY_CHUNKS] = { ECO_DAMAGED, LIST ": its levels are too many, or not a chunk each" },
};

/* The scene, with a list, chunks and payloads of impostors that may be written to. */
struct forged {
	struct scene_builder b;
	struct eco_list lists[L_COUNT];
	struct eco_chunk *chunks;
	uint8_t **payloads, *made[2];        /* made: of the first two levels, or NULL */
	uint32_t first;                      /* chunk of the list */
};

static void forge(struct forged *f)
{
	uint32_t count = grove.scene.chunk_count;
	*f = (struct forged){ .b = grove, .first = grove.lists[L_IMPOSTOR].chunk_first };
	f->b.scene.lists = f->b.lists = memcpy(f->lists, grove.lists, sizeof f->lists);
	f->chunks = malloc(count * sizeof *f->chunks);
	f->payloads = malloc(count * sizeof *f->payloads);
	f->b.scene.chunks = f->b.chunks = memcpy(f->chunks, grove.chunks, count * sizeof *f->chunks);
	f->b.payloads = memcpy(f->payloads, grove.payloads, count * sizeof *f->payloads);
}

static void forged_free(struct forged *f)
{
	free(f->chunks);
	free(f->payloads);
	free(f->made[0]);
	free(f->made[1]);
}

/* Chunk `to` has the payload of level `from`, or its first bytes, under a hash that is right. */
static void put_level(struct forged *f, uint32_t to, uint32_t from, size_t size)
{
	size_t whole;
	const uint8_t *payload = payload_of(from, &whole);
	struct eco_chunk *chunk = &f->chunks[f->first + to];
	free(f->made[to]);
	f->made[to] = memcpy(malloc(whole), payload, whole);
	chunk->size_bytes = (uint32_t)(size < whole ? size : whole);
	chunk->id = eco_chunk_hash(f->made[to], chunk->size_bytes);
	f->payloads[f->first + to] = f->made[to];
}

static void damage(struct forged *f, enum fault fault)
{
	struct eco_chunk *chunks = f->chunks + f->first;
	struct eco_list *list = &f->lists[L_IMPOSTOR];
	const float none = NAN;
	put_level(f, 1, 1, SIZE_MAX);
	switch (fault) {
	case SWAPPED:
	case TWICE:
		put_level(f, fault == TWICE, fault == SWAPPED, SIZE_MAX);
		break;
	case NO_BODY:
		memcpy(f->made[1], &none, sizeof none);
		break;
	case NO_LEVEL:
		f->made[1][24] = LEVELS;
		break;
	case CUT_OFF:
	case ONE_BYTE:
		put_level(f, 1, 1, fault == ONE_BYTE ? 1 : chunks[1].size_bytes - 1);
		break;
	case TWO_PRIMITIVES:
	case TWO_ELEMENTS:
		chunks[0].primitive_count = 2;
		chunks[0].element_count += fault == TWO_ELEMENTS;
		break;
	case TOO_MANY_CHUNKS:
		list->primitive_count = list->element_count = list->chunk_count = LEVELS + 1;
		break;
	default:
		break;
	}
	chunks[1].id = eco_chunk_hash(f->payloads[f->first + 1], chunks[1].size_bytes);
}

/* Two levels, and a plan of the second. */
static struct eco_writer stream_of(struct forged *f, enum fault fault)
{
	struct eco_plan plan = plan_levels(fault == NOT_HELD ? 2 : fault != BOTH_LEVELS,
		fault == NOT_HELD ? 3 : 2);
	struct eco_writer w = { 0 };
	uint32_t number = 0;
	plan.run_count = 0;
	plan.vertices = 0;
	scene_frame(&w, &grove, ECO_FRAME_SCENE, &number, 0, 0);
	scene_frame(&w, &grove, ECO_FRAME_BUNDLE, &number, 0, SCENE_PLANT);
	scene_frame(&w, &f->b, ECO_FRAME_BUNDLE, &number, L_IMPOSTOR, SCENE_RECORD);
	for (uint32_t i = 0; i < 2; i++)
		scene_frame(&w, &f->b, ECO_FRAME_BUNDLE, &number, L_IMPOSTOR, i);
	wire_put_plan(&w, &number, &plan);
	wire_put_end(&w, &number, 0, 0);
	eco_plan_free(&plan);
	return w;
}

static struct view_store *feed(struct forged *f, enum fault fault, uint64_t memory_max, enum eco_code *code,
	struct eco_error *error)
{
	struct view_store *store;
	struct view_store_options options = { .memory_max = memory_max };
	struct eco_writer w = stream_of(f, fault);
	assert_int_equal(view_store_new(&store, &options, NULL), ECO_OK);
	*code = scene_feed(store, &w, error);
	eco_writer_free(&w);
	return store;
}

UNIT_TEST(wrong_levels_are_refused_by_list_and_chunk)
{
	for (int fault = 0; fault < FAULTS; fault++) {
		struct forged f;
		struct eco_error error = { 0 };
		enum eco_code code;
		forge(&f);
		damage(&f, (enum fault)fault);
		struct view_store *store = feed(&f, (enum fault)fault, 0, &code, &error);
		if (code != faults[fault].code || !strstr(error.text, faults[fault].says))
			fail_msg("fault %d: code %d, '%s'", fault, code, error.text);
		view_store_free(store);
		forged_free(&f);
	}
}

int main(void)
{
	return unit_tests_run(open_all, scene_close);
}
