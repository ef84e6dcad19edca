/* The index of a published scene: plans made from it are the pack's own, once the places that they ask for
 * are there; what is damaged is refused; nobody's rows are in what is published. */
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "ecofiles/format/wire.h"
#include "server/publish/index.h"
#include "server/stream.h"
#include "tests/support/input_files.h"
#include "tests/support/scene_packs.h"
#include "tests/support/serve/random_request.h"
#include "tests/support/unit_test.h"

#define DIR "build/tmp/test_index"
#define VIEWS 14u
#define ROUNDS_MOST 2u

static struct srv_store store;
static struct eco_writer made;
static uint64_t chunk_bytes;

static int start(void **state)
{
	(void)state;
	struct scene_builder b;
	folder_make(DIR);
	srv_store_init(&store);
	if (sample_pack_write(DIR "/sample.eco", &cause) || small_pack_write(&b, DIR "/small.eco", NULL, &cause)
			|| srv_store_add(&store, "sample", DIR "/sample.eco", &cause)
			|| srv_store_add(&store, "small", DIR "/small.eco", &cause))
		return 1;
	scene_free(&b);
	srv_typical_find_all(&store, NULL);
	return srv_index_write(&made, store.scenes[0], NULL, &chunk_bytes, &cause);
}

static int stop(void **state)
{
	(void)state;
	eco_writer_free(&made);
	srv_store_free(&store);
	return 0;
}

/* The list's chunks, as a client would fetch them. */
static void take_list(struct srv_index *index, uint32_t list)
{
	const struct eco_scene *scene = &store.scenes[0]->pack->scene;
	for (uint32_t c = 0; c < scene->lists[list].chunk_count; c++) {
		const uint8_t *bytes;
		size_t size;
		assert_good(srv_scene_payload(store.scenes[0], scene->lists[list].chunk_first + c, &bytes, &size, &cause));
		assert_good(srv_index_take(index, list, c, bytes, size, &cause));
	}
}

/* Returns how many lists were asked for. */
static uint32_t take_wanted(struct srv_index *index)
{
	uint32_t taken = 0;
	for (uint32_t g = 0; g < index->pack.scene.group_count; g++) {
		if (index->known[g] != LOD_PLACES_WANTED)
			continue;
		take_list(index, index->pack.scene.groups[g].list);
		taken++;
	}
	return taken;
}

static void assert_same_answer(struct srv_index *index, const struct eco_request *request)
{
	struct srv_stream theirs, ours;
	struct srv_stream_input input = { .scene = store.scenes[0], .request = request,
		.work_max = SRV_INDEX_PLAN_TIMES * store.scenes[0]->typical_work };
	assert_good(srv_stream_plan(&theirs, &input, &cause));
	input.scene = &index->scene;
	input.places = index->known;
	uint32_t rounds = 0;
	for (enum eco_code code; (code = srv_stream_plan(&ours, &input, &cause)) != ECO_OK; rounds++) {
		assert_int_equal(code, ECO_INTERRUPTED);
		assert_true(rounds < ROUNDS_MOST && take_wanted(index) > 0);
	}
	assert_int_equal(ours.body_bytes, theirs.body_bytes);
	assert_int_equal(ours.step_count, theirs.step_count);
	assert_int_equal(ours.work, theirs.work);
	for (uint32_t i = 0; i < ours.step_count; i++) {
		struct eco_writer a = { 0 }, b = { 0 };
		eco_wire_write_plan(&a, &ours.steps[i].plan);
		eco_wire_write_plan(&b, &theirs.steps[i].plan);
		assert_true(a.size == b.size && memcmp(a.bytes, b.bytes, a.size) == 0);
		eco_writer_free(&a);
		eco_writer_free(&b);
	}
	srv_stream_free(&ours);
	srv_stream_free(&theirs);
}

UNIT_TEST(plans_from_an_index_are_the_packs)
{
	struct srv_index *index;
	assert_good(srv_index_read(&index, made.bytes, made.size, &cause));
	assert_memory_equal(&index->pack.id, &store.scenes[0]->pack->id, sizeof index->pack.id);
	assert_int_equal(index->scene.typical_work, store.scenes[0]->typical_work);
	for (uint32_t i = 0; i < VIEWS; i++) {
		struct eco_request request = { .view = random_outlook(&store.scenes[0]->pack->scene, 1, i),
			.vertices = 1000u << i % 8, .bytes = i % 3 ? ECO_BYTES_UNBOUNDED : 30000,
			.ground_px = ECO_GROUND_PX, .texel_px = ECO_TEXEL_PX };
		assert_same_answer(index, &request);
	}
	srv_index_free(index);
}

UNIT_TEST(offsets_lead_to_the_packs_chunks)
{
	struct srv_index *index;
	const struct eco_scene *scene = &store.scenes[0]->pack->scene;
	assert_good(srv_index_read(&index, made.bytes, made.size, &cause));
	for (uint32_t i = 0; i < scene->chunk_count; i++) {
		assert_int_equal(index->pack.scene.chunks[i].offset, scene->chunks[i].offset - scene->chunks[0].offset);
		assert_true(index->pack.scene.chunks[i].offset + scene->chunks[i].size_bytes <= chunk_bytes);
	}
	srv_index_free(index);
}

UNIT_TEST(a_damaged_index_is_refused)
{
	struct srv_index *index;
	for (size_t at = 0; at < made.size; at += 1 + made.size / 300) {
		made.bytes[at] ^= 1;
		assert_code(srv_index_read(&index, made.bytes, made.size, &cause), ECO_DAMAGED, "hash");
		assert_null(index);
		made.bytes[at] ^= 1;
	}
	for (size_t size = 0; size < made.size; size += 1 + made.size / 50)
		assert_int_equal(srv_index_read(&index, made.bytes, size, NULL), ECO_DAMAGED);
}

/* Under a hash that fits: whoever made it, it ends in an error, or is a scene. */
UNIT_TEST(a_hostile_index_is_refused_or_sound)
{
	struct dice dice = { 1 };
	for (uint32_t i = 0; i < 400; i++) {
		struct srv_index *index;
		struct eco_writer hash = { 0 };
		uint8_t *bytes = malloc(made.size);
		memcpy(bytes, made.bytes, made.size);
		size_t at = i < 200 ? 8 + dice_bits(&dice) % 400 : 8 + dice_bits(&dice) % (made.size - 16);
		bytes[at] = (uint8_t)dice_bits(&dice);
		eco_write_u64(&hash, XXH3_64bits(bytes, made.size - 8));
		memcpy(bytes + made.size - 8, hash.bytes, 8);
		if (!srv_index_read(&index, bytes, made.size, NULL))
			srv_index_free(index);
		eco_writer_free(&hash);
		free(bytes);
	}
}

/* Sizes of tables wrap around in 32 bits, which a browser's planner has. */
UNIT_TEST(impossible_counts_are_refused)
{
	const size_t first = 44 + eco_record_bytes(ECO_SECTION_SCENE);
	for (size_t at = first, kind = 0; kind < ECO_SECTION_KIND_END; kind++) {
		if (!srv_index_has((enum eco_section_kind)kind))
			continue;
		struct srv_index *index;
		struct eco_writer hash = { 0 };
		uint8_t *bytes = malloc(made.size);
		memcpy(bytes, made.bytes, made.size);
		memset(bytes + at, 0xff, 4);
		eco_write_u64(&hash, XXH3_64bits(bytes, made.size - 8));
		memcpy(bytes + made.size - 8, hash.bytes, 8);
		assert_code(srv_index_read(&index, bytes, made.size, &cause), ECO_DAMAGED, "too many");
		eco_writer_free(&hash);
		free(bytes);
		at += 4;
	}
}

UNIT_TEST(rows_of_inventories_are_not_published)
{
	const struct srv_scene *scene = store.scenes[1];
	const struct eco_list *rows = eco_inventory_list(&scene->pack->scene);
	struct eco_writer index = { 0 };
	uint64_t bytes;
	assert_non_null(rows);
	assert_good(srv_index_write(&index, scene, NULL, &bytes, &cause));
	const struct eco_chunk *chunks = scene->pack->scene.chunks;
	assert_int_equal(bytes, chunks[rows->chunk_first].offset - chunks[0].offset);
	eco_writer_free(&index);
}

UNIT_MAIN(start, stop)
