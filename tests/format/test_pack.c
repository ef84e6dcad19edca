/* Packs: what is written is read, whatever is damaged is found, nothing half written stays. */
#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/format/chunk/chunk.h"
#include "tests/support/files.h"
#include "tests/support/pack_resign.h"
#include "tests/support/scene_packs.h"
#include "tests/support/unit_test.h"

#define FOLDER "build/tmp/pack"
#define PATH FOLDER "/small.eco"
#define GOLDEN_PATH "tests/fuzz/corpus/pack/small.eco"

static int count_files(void)
{
	DIR *folder = opendir(FOLDER);
	int count = 0;
	assert_non_null(folder);
	for (struct dirent *entry; (entry = readdir(folder));)
		count += entry->d_name[0] != '.';
	closedir(folder);
	return count;
}

static void empty_folder(void)
{
	folder_make(FOLDER);
	unlink(PATH);
	assert_int_equal(count_files(), 0);
}

/* The small pack as bytes; the caller frees them. */
static uint8_t *small_pack(size_t *size)
{
	AT_END(scene_free) struct scene_builder p;
	empty_folder();
	assert_good(small_pack_write(&p, PATH, NULL, &cause));
	return file_read(PATH, size);
}

/* Opens without a trailing byte to read over. */
static enum eco_code open_exact(const uint8_t *bytes, size_t size, struct eco_error *error)
{
	FREED_MEMORY uint8_t *copy = malloc(size > 0 ? size : 1);
	OWNED(eco_pack) *pack;
	enum eco_code code;
	memcpy(copy, bytes, size);
	code = eco_pack_open_memory(&pack, copy, size, error);
	for (uint32_t i = 0; code == ECO_OK && i < pack->scene.chunk_count; i++) {
		const uint8_t *payload;
		size_t payload_size;
		code = eco_pack_payload(pack, i, &payload, &payload_size, error);
	}
	return code;
}

#define ASSERT_TABLE(kind, field, name) do { \
	assert_int_equal(got->name##_count, want->name##_count); \
	for (uint32_t i = 0; i < want->name##_count; i++) { \
		struct eco_writer a = { 0 }, b = { 0 }; \
		eco_record_write(&a, ECO_SECTION_##kind, &got->field[i]); \
		eco_record_write(&b, ECO_SECTION_##kind, &want->field[i]); \
		assert_int_equal(a.size, b.size); \
		assert_memory_equal(a.bytes, b.bytes, a.size); \
		eco_writer_free(&a); \
		eco_writer_free(&b); \
	} } while (0)

UNIT_TEST(all_tables_come_back)
{
	AT_END(scene_free) struct scene_builder p;
	struct eco_error error = { 0 };
	OWNED(eco_pack) *pack = NULL;
	const struct eco_scene *got, *want = &p.scene;
	empty_folder();
	if (small_pack_write(&p, PATH, NULL, &error) != ECO_OK || eco_pack_open(&pack, PATH, &error)
			!= ECO_OK)
		fail_msg("%s", error.text);
	assert_int_equal(count_files(), 1);
	got = &pack->scene;
	assert_string_equal(got->name, "small");
	assert_int_equal(got->needs, want->needs);
	assert_int_equal(got->root, want->root);
	assert_true(got->ground_columns == 38 && got->ground_rows == 20);
	assert_true(got->near_m == want->near_m);
	ASSERT_TABLE(GROUND, ground, ground);
	ASSERT_TABLE(PLANTS, plants, plant);
	ASSERT_TABLE(ANCHORS, anchors, anchor);
	ASSERT_TABLE(LADDERS, ladders, ladder);
	ASSERT_TABLE(CURVES, curves, curve);
	ASSERT_TABLE(TILES, tiles, tile);
	ASSERT_TABLE(GROUPS, groups, group);
	ASSERT_TABLE(CHILDREN, children, child);
	/* Written by eye, so that a field which writer and reader both forget is noticed. */
	assert_string_equal(got->plants[0].name, "oak");
	assert_int_equal(got->plants[0].triangles, 150);
	assert_int_equal(got->ladders[1].level_end[1], 30);
	assert_true(got->ladders[0].total == 40 && got->ladders[0].simple == 11);
	assert_true(got->curves[1].scale == 1.5f && got->curves[1].fn == 0.3f);
	assert_true(got->tiles[0].high[2] == 12 && got->tiles[0].instance_count == 14 && got->tiles[1].summary
		== 9);
	assert_true(got->children[1].placed && got->children[1].at[2] == 5 && got->children[1].turn == 16384);
	assert_true(got->children[1].scale == 1.5f);
	assert_int_equal(got->lists[6].columns, 20);
	assert_int_equal(got->lists[2].partner, 1);
	assert_true(got->lists[2].unit_area == 0.01f && got->lists[2].grid_step[2] == 0.01
		&& got->lists[2].grid_origin[0] == -5);
	assert_int_equal(got->palette_count, 4);
	assert_memory_equal(got->palette, want->palette, 12);
	assert_int_equal(got->place_count, SMALL_PACK_PLANTS);
	assert_int_equal(pack->meta_size, strlen("{\"name\": \"small\"}"));
	assert_memory_equal(pack->meta, "{\"name\": \"small\"}", pack->meta_size);
}

/* Every payload decodes to what its list says, and the planner's copy of the instances is the coded one. */
UNIT_TEST(all_payloads_decode)
{
	struct eco_pack *pack;
	uint32_t places = 0;
	size_t size;
	uint8_t *bytes = small_pack(&size);
	assert_int_equal(eco_pack_open_memory(&pack, bytes, size, NULL), ECO_OK);
	for (uint32_t i = 0; i < pack->scene.list_count; i++) {
		const struct eco_list *list = &pack->scene.lists[i];
		for (uint32_t k = 0; k < list->chunk_count; k++) {
			struct eco_error error = { 0 };
			struct eco_elements e;
			const uint8_t *payload;
			size_t payload_size;
			assert_ok(eco_pack_payload(pack, list->chunk_first + k, &payload, &payload_size,
				&error), error);
			if (list->kind == ECO_LIST_INVENTORY)
				continue;
			if (list->coder == ECO_CODER_BYTES) {
				const char *texts[] = { "no WebP file", "and no other", "level 0", "level 1",
					"level 2", "level 3" };
				assert_memory_equal(payload,
					texts[list->kind == ECO_LIST_GROUND_IMAGE ? 2 + k : k], payload_size);
				continue;
			}
			if (eco_chunk_decode(list, &pack->scene.chunks[list->chunk_first + k], k, payload,
					payload_size, &e, &error) != ECO_OK)
				fail_msg("list %u: %s", i, error.text);
			for (uint32_t n = 0; list->kind == ECO_LIST_INSTANCES && n < e.element_count;
					n++, places++) {
				struct eco_place a = eco_place_of(list, &e, n),
					b = eco_place_read(&pack->scene, places);
				assert_memory_equal(a.position, b.position, sizeof a.position);
				assert_int_equal(a.turn, b.turn);
				assert_int_equal(a.scale, b.scale);
			}
			eco_elements_free(&e);
		}
	}
	assert_int_equal(places, SMALL_PACK_PLANTS);
	assert_int_equal(eco_pack_payload(pack, pack->scene.chunk_count, &(const uint8_t *){ NULL },
		&(size_t){ 0 }, NULL), ECO_NOT_FOUND);
	eco_pack_close(pack);
	free(bytes);
}

/* The format: the committed file, which is also a seed of fuzz_pack, is what this version writes.
 * WRITE_SEEDS=1 build/tests/test_pack writes it anew, once the format has changed. */
UNIT_TEST(the_small_pack_is_the_golden_one)
{
	size_t size, golden_size;
	FREED_MEMORY uint8_t *bytes = small_pack(&size);
	if (getenv("WRITE_SEEDS"))
		file_write(GOLDEN_PATH, bytes, size);
	FREED_MEMORY uint8_t *golden = file_read(GOLDEN_PATH, &golden_size);
	assert_good(open_exact(golden, golden_size, &cause));
	assert_int_equal(size, golden_size);
	assert_memory_equal(bytes, golden, size);
}

UNIT_TEST(every_truncation_is_found)
{
	size_t size;
	FREED_MEMORY uint8_t *bytes = small_pack(&size);
	assert_int_equal(open_exact(bytes, size, NULL), ECO_OK);
	for (size_t cut = 0; cut < size; cut++)
		assert_int_not_equal(open_exact(bytes, cut, NULL), ECO_OK);
	bytes[size] = 0;
	assert_int_not_equal(open_exact(bytes, size + 1, NULL), ECO_OK);
}

/* All single bits, then pairs of bits. No byte of a pack is without a hash or a required value. */
UNIT_TEST(every_flipped_bit_is_found)
{
	uint64_t seed = 1;
	size_t size;
	uint8_t *bytes = small_pack(&size);
	for (size_t bit = 0; bit < 8 * size; bit++) {
		bytes[bit / 8] ^= (uint8_t)(1 << bit % 8);
		assert_int_not_equal(open_exact(bytes, size, NULL), ECO_OK);
		bytes[bit / 8] ^= (uint8_t)(1 << bit % 8);
	}
	for (int i = 0; i < 50000; i++) {
		size_t bit[2];
		for (int k = 0; k < 2; k++)
			bit[k] = (size_t)((seed = seed * 6364136223846793005u + 1442695040888963407u) >> 33)
				% (8 * size);
		if (bit[0] == bit[1])
			continue;
		for (int k = 0; k < 4; k++) {
			bytes[bit[k % 2] / 8] ^= (uint8_t)(1 << bit[k % 2] % 8);
			if (k == 1)
				assert_int_not_equal(open_exact(bytes, size, NULL), ECO_OK);
		}
	}
	free(bytes);
}

/* Damage made on purpose, hashes and all, is refused by the checks or harmless. */
UNIT_TEST(forged_tables_do_no_harm)
{
	uint64_t seed = 7;
	int accepted = 0;
	size_t size;
	FREED_MEMORY uint8_t *bytes = small_pack(&size), *forged = malloc(size);
	for (int i = 0; i < 20000; i++) {
		memcpy(forged, bytes, size);
		for (int k = 0; k <= i % 3; k++) {
			seed = seed * 6364136223846793005u + 1442695040888963407u;
			forged[(seed >> 33) % size] = seed >> 60 == 0 ? 0xff : (uint8_t)(seed >> 24);
		}
		pack_resign(forged, size);
		accepted += open_exact(forged, size, NULL) == ECO_OK;
	}
	assert_true(accepted > 0 && accepted < 20000);
}

UNIT_TEST(equal_payloads_are_stored_once)
{
	struct eco_pack_writer *w = NULL;
	struct eco_error error = { 0 };
	AT_END(scene_free) struct scene_builder p;
	OWNED(eco_pack) *pack;
	uint32_t first = 0, last = 0;
	empty_folder();
	assert_int_equal(small_pack_write(&p, PATH, &w, &error), ECO_OK);
	struct eco_list list =
		scene_list(&p, &(struct scene_row){ ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, 0, 0, ECO_NONE, 0,
		0 });
	FREED(eco_elements) e = small_pack_elements(&list, 9, 4);
	for (int i = 0; i < 300; i++) {
		last = eco_pack_add_list(w, &list, &e, (const uint32_t[]){ 3, 9 }, 2, NULL);
		if (i == 0)
			first = last;
	}
	assert_int_equal(eco_pack_list(w, last)->primitive_count, 18);
	assert_int_equal(eco_pack_commit(w, &p.scene, "", &error), ECO_OK);
	assert_int_equal(eco_pack_open(&pack, PATH, &error), ECO_OK);
	assert_true(pack->scene.chunks[pack->scene.lists[first].chunk_first].offset
		== pack->scene.chunks[pack->scene.lists[last].chunk_first].offset);
	assert_int_equal(pack->meta_size, 0);
	assert_true(pack->map_size < 64000);
}

UNIT_TEST(a_failed_pack_leaves_the_old_one)
{
	size_t size, size_after;
	FREED_MEMORY uint8_t *bytes = small_pack(&size), *after;
	struct eco_error error = { 0 };
	struct eco_pack_writer *w = NULL;
	struct scene_builder p;
	assert_int_equal(small_pack_write(&p, PATH, &w, &error), ECO_OK);
	assert_int_equal(count_files(), 2);
	eco_pack_abort(w);
	assert_int_equal(count_files(), 1);
	scene_free(&p);
	/* A scene that does not fit together is not written. */
	assert_int_equal(small_pack_write(&p, PATH, &w, &error), ECO_OK);
	p.plants[0].ladder_count++;
	assert_int_equal(eco_pack_commit(w, &p.scene, "{}", &error), ECO_DAMAGED);
	assert_int_equal(count_files(), 1);
	scene_free(&p);
	after = file_read(PATH, &size_after);
	assert_int_equal(size, size_after);
	assert_memory_equal(bytes, after, size);
	eco_pack_abort(NULL);
}

/* A limit on file sizes acts as a full disk does: at every size, nothing half written stays. */
static void put_file(const char *path)
{
	FILE *file = fopen(path, "wb");
	assert_non_null(file);
	assert_true(fputs("unfinished", file) >= 0);
	assert_int_equal(fclose(file), 0);
}

UNIT_TEST(what_a_killed_process_left_goes_with_the_next_pack)
{
	static const char *const left[] = { PATH ".tmp-1", PATH ".tmp-99999999" },
		*const kept[] = { PATH ".tmp-backup", PATH ".tmp-", PATH ".tmp-7.old",
		FOLDER "/other.eco.tmp-1", PATH ".tmp-3" };
	AT_END(scene_free) struct scene_builder p;
	struct eco_error error = { 0 };
	empty_folder();
	for (size_t i = 0; i < sizeof left / sizeof *left; i++)
		put_file(left[i]);
	for (size_t i = 0; i < 5; i++)
		put_file(kept[i]);
	int running = open(kept[4], O_RDONLY | O_CLOEXEC);
	assert_int_equal(flock(running, LOCK_EX), 0);        /* another process writes it */
	if (small_pack_write(&p, PATH, NULL, &error))
		fail_msg("%s", error.text);
	for (size_t i = 0; i < sizeof left / sizeof *left; i++)
		assert_int_equal(access(left[i], F_OK), -1);
	for (size_t i = 0; i < 5; i++)
		assert_int_equal(access(kept[i], F_OK), 0);
	assert_int_equal(count_files(), 6);
	close(running);
	for (size_t i = 0; i < 5; i++)
		unlink(kept[i]);
}

UNIT_TEST(a_full_disk_is_reported_and_leaves_nothing)
{
	struct rlimit old, limit;
	size_t size;
	free(small_pack(&size));
	signal(SIGXFSZ, SIG_IGN);
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
	for (size_t most = 0; most < size; most += 97) {
		struct eco_error error = { 0 };
		AT_END(scene_free) struct scene_builder p;
		enum eco_code code;
		empty_folder();
		limit = old;
		limit.rlim_cur = most;
		assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
		code = small_pack_write(&p, PATH, NULL, &error);
		assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
		assert_int_equal(code, ECO_IO);
		assert_non_null(strstr(error.text, "free some space"));
		assert_int_equal(count_files(), 0);
	}
}

UNIT_TEST(impossible_targets_are_named)
{
	static const char *const paths[] = { FOLDER "/missing/x.eco", FOLDER, "/dev/null", "" };
	struct eco_pack *pack;
	empty_folder();
	for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++) {
		struct eco_error error = { 0 };
		struct eco_pack_writer *w = NULL;
		assert_int_not_equal(eco_pack_create(&w, paths[i], &error), ECO_OK);
		assert_null(w);
		assert_non_null(strstr(error.text, paths[i]));
		error = (struct eco_error){ 0 };
		assert_int_not_equal(eco_pack_open(&pack, paths[i], &error), ECO_OK);
		assert_null(pack);
		assert_non_null(strstr(error.text, paths[i]));
	}
	assert_int_equal(count_files(), 0);
}

UNIT_TEST(only_packs_and_empty_files_are_replaced)
{
	static const struct { const char *content; enum eco_code code; } rows[] = {
		{ "{\"name\": \"my only scene\"}", ECO_BAD_INPUT }, { "x", ECO_BAD_INPUT }, { "", ECO_OK },
			{ "ECOPACK1, cut off", ECO_OK },
	};

	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		struct eco_error error = { 0 };
		struct eco_pack_writer *w = NULL;
		FREED_MEMORY uint8_t *bytes;
		size_t size;
		empty_folder();
		file_write_text(PATH, rows[i].content);
		assert_int_equal(eco_pack_create(&w, PATH, &error), rows[i].code);
		eco_pack_abort(w);
		bytes = file_read(PATH, &size);
		assert_int_equal(size, strlen(rows[i].content));
		assert_memory_equal(bytes, rows[i].content, size);
		assert_int_equal(count_files(), 1);
	}
}

static void add_nothing(void *writer)
{
	const struct eco_list list = { .kind = ECO_LIST_IMAGE, .coder = ECO_CODER_BYTES };
	eco_pack_add_bytes(writer, &list, &(const struct eco_bytes){ NULL, 0 }, 1);
}

UNIT_TEST(files_have_bytes)
{
	struct eco_pack_writer *w = NULL;
	empty_folder();
	assert_int_equal(eco_pack_create(&w, PATH, NULL), ECO_OK);
	assert_int_equal(eco_try(add_nothing, w, NULL), ECO_TOO_LARGE);
	eco_pack_abort(w);
	assert_int_equal(count_files(), 0);
}

/* A number would go out of date in one of two places. */
UNIT_TEST(the_described_version_is_the_constant)
{
	static const char *const headers[] = { "ecofiles/format/pack.h", "ecofiles/format/wire.h" };
	for (size_t i = 0; i < sizeof headers / sizeof *headers; i++) {
		size_t size;
		FREED_MEMORY char *text = (char *)file_read(headers[i], &size);
		const char *version = strstr(text, "u32 version = ");
		assert_non_null(version);
		assert_int_equal(strncmp(version + strlen("u32 version = "), "ECO_", 4), 0);
	}
}
