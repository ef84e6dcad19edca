/* Packs: what is written is read, whatever is damaged is found, nothing half written stays. Long, as each table has its damages written
 * out. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <dirent.h>
#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/pack_resign.h"
#include "tests/scene_pack.h"

#define FOLDER "build/tmp/pack"
#define PATH FOLDER "/small.eco"
#define GOLDEN_PATH "tests/fuzz/corpus/pack/small.eco"

static uint8_t *read_file(const char *path, size_t *size)
{
	FILE *file = fopen(path, "rb");
	uint8_t *bytes;

	assert_non_null(file);
	fseek(file, 0, SEEK_END);
	*size = (size_t)ftell(file);
	rewind(file);
	bytes = malloc(*size + 1);
	assert_int_equal(fread(bytes, 1, *size, file), *size);
	fclose(file);
	return bytes;
}

static int count_files(void)
{
	DIR *folder = opendir(FOLDER);
	int count = 0;

	assert_non_null(folder);
	for (struct dirent *entry; (entry = readdir(folder)) != NULL;)
		count += entry->d_name[0] != '.';
	closedir(folder);
	return count;
}

static void empty_folder(void)
{
	mkdir("build", 0777);
	mkdir("build/tmp", 0777);
	mkdir(FOLDER, 0777);
	unlink(PATH);
	assert_int_equal(count_files(), 0);
}

/* The small pack as bytes; the caller frees them. */
static uint8_t *small_pack(size_t *size)
{
	struct scene_pack p;
	struct eco_error error = { 0 };

	empty_folder();
	if (scene_pack_write(&p, PATH, NULL, &error) != ECO_OK)
		fail_msg("%s", error.text);
	scene_pack_free(&p);
	return read_file(PATH, size);
}

/* Opens without a trailing byte to read over. */
static enum eco_code open_exact(const uint8_t *bytes, size_t size, struct eco_error *error)
{
	uint8_t *copy = malloc(size > 0 ? size : 1);
	struct eco_pack *pack;
	enum eco_code code;

	memcpy(copy, bytes, size);
	code = eco_pack_open_memory(&pack, copy, size, error);
	for (uint32_t i = 0; code == ECO_OK && i < pack->scene.chunk_count; i++) {
		const uint8_t *payload;
		size_t payload_size;

		code = eco_pack_payload(pack, i, &payload, &payload_size, error);
	}
	eco_pack_close(pack);
	free(copy);
	return code;
}

#define ASSERT_TABLE(field, name) do { \
	assert_int_equal(got->name##_count, want->name##_count); \
	for (uint32_t i = 0; i < want->name##_count; i++) { \
		struct eco_writer a = { 0 }, b = { 0 }; \
		eco_##name##_write(&a, &got->field[i]); \
		eco_##name##_write(&b, &want->field[i]); \
		assert_int_equal(a.size, b.size); \
		assert_memory_equal(a.bytes, b.bytes, a.size); \
		eco_writer_free(&a); \
		eco_writer_free(&b); \
	} } while (0)

static void all_tables_come_back(void **state)
{
	struct scene_pack p;
	struct eco_error error = { 0 };
	struct eco_pack *pack;
	const struct eco_scene *got, *want = &p.scene;

	(void)state;
	empty_folder();
	if (scene_pack_write(&p, PATH, NULL, &error) != ECO_OK || eco_pack_open(&pack, PATH, &error) != ECO_OK)
		fail_msg("%s", error.text);
	assert_int_equal(count_files(), 1);
	got = &pack->scene;
	assert_string_equal(got->name, "small");
	assert_int_equal(got->needs, want->needs);
	assert_int_equal(got->root, want->root);
	assert_true(got->ground_columns == 70 && got->ground_rows == 20);
	assert_true(got->ground[0].child_first == 1 && got->ground[2].column == 1 && got->ground[2].list == 8);
	assert_int_equal(got->ground_count, want->ground_count);
	for (uint32_t i = 0; i < want->ground_count; i++)
		assert_true(got->ground[i].list == want->ground[i].list && got->ground[i].error_m == want->ground[i].error_m
			&& got->ground[i].low_m == want->ground[i].low_m && got->ground[i].high_m == want->ground[i].high_m
			&& got->ground[i].level == want->ground[i].level && got->ground[i].column == want->ground[i].column);
	assert_true(got->near_m == want->near_m);
	ASSERT_TABLE(plants, plant);
	ASSERT_TABLE(anchors, anchor);
	ASSERT_TABLE(ladders, ladder);
	ASSERT_TABLE(curves, curve);
	ASSERT_TABLE(tiles, tile);
	ASSERT_TABLE(groups, group);
	ASSERT_TABLE(children, child);
	/* Written by eye, so that a field which writer and reader both forget is noticed. */
	assert_string_equal(got->plants[0].name, "oak");
	assert_int_equal(got->plants[0].triangles, 150);
	assert_int_equal(got->ladders[1].level_end[1], 30);
	assert_true(got->ladders[0].total == 40 && got->ladders[0].simple == 11);
	assert_true(got->curves[1].scale == 1.5f && got->curves[1].fn == 0.3f);
	assert_true(got->tiles[0].high[2] == 12 && got->tiles[0].instance_count == 14 && got->tiles[1].summary == 9);
	assert_true(got->children[1].placed && got->children[1].at[2] == 5 && got->children[1].turn == 16384);
	assert_true(got->children[1].scale == 1.5f);
	assert_int_equal(got->lists[6].columns, 36);
	assert_int_equal(got->lists[2].partner, 1);
	assert_true(got->lists[2].unit_area == 0.01f && got->lists[2].grid_step[2] == 0.01 && got->lists[2].grid_origin[0] == -5);
	assert_int_equal(got->palette_count, 4);
	assert_memory_equal(got->palette, want->palette, 12);
	assert_int_equal(got->place_count, SCENE_PACK_PLANTS);
	assert_int_equal(pack->meta_size, strlen("{\"name\": \"small\"}"));
	assert_memory_equal(pack->meta, "{\"name\": \"small\"}", pack->meta_size);
	eco_pack_close(pack);
	scene_pack_free(&p);
}

/* Every payload decodes to what its list says, and the planner's copy of the instances is the coded one. */
static void all_payloads_decode(void **state)
{
	struct eco_pack *pack;
	uint32_t places = 0;
	size_t size;
	uint8_t *bytes = small_pack(&size);

	(void)state;
	assert_int_equal(eco_pack_open_memory(&pack, bytes, size, NULL), ECO_OK);
	for (uint32_t i = 0; i < pack->scene.list_count; i++) {
		const struct eco_list *list = &pack->scene.lists[i];

		for (uint32_t k = 0; k < list->chunk_count; k++) {
			struct eco_error error = { 0 };
			struct eco_elements e;
			const uint8_t *payload;
			size_t payload_size;

			if (eco_pack_payload(pack, list->chunk_first + k, &payload, &payload_size, &error) != ECO_OK)
				fail_msg("%s", error.text);
			if (list->coder == ECO_CODER_BYTES) {
				assert_memory_equal(payload, "not really a PNG", payload_size);
				continue;
			}
			if (eco_chunk_decode(list, &pack->scene.chunks[list->chunk_first + k], k, payload, payload_size, &e, &error) != ECO_OK)
				fail_msg("list %u: %s", i, error.text);
			for (uint32_t n = 0; list->kind == ECO_LIST_INSTANCES && n < e.element_count; n++, places++) {
				struct eco_place a = eco_place_of(&e, n), b = eco_place_read(&pack->scene, places);

				assert_memory_equal(a.position, b.position, sizeof a.position);
				assert_int_equal(a.turn, b.turn);
				assert_int_equal(a.scale, b.scale);
			}
			eco_elements_free(&e);
		}
	}
	assert_int_equal(places, SCENE_PACK_PLANTS);
	assert_int_equal(eco_pack_payload(pack, pack->scene.chunk_count, &(const uint8_t *){ NULL }, &(size_t){ 0 }, NULL), ECO_NOT_FOUND);
	eco_pack_close(pack);
	free(bytes);
}

/* The format: the committed file must be read by every later version, and written by this one. */
static void the_small_pack_is_the_golden_one(void **state)
{
	size_t size, golden_size;
	uint8_t *bytes = small_pack(&size), *golden = read_file(GOLDEN_PATH, &golden_size);
	struct eco_error error = { 0 };

	(void)state;
	if (open_exact(golden, golden_size, &error) != ECO_OK)
		fail_msg("%s", error.text);
	assert_int_equal(size, golden_size);
	assert_memory_equal(bytes, golden, size);
	free(bytes);
	free(golden);
}

static void every_truncation_is_found(void **state)
{
	size_t size;
	uint8_t *bytes = small_pack(&size);

	(void)state;
	assert_int_equal(open_exact(bytes, size, NULL), ECO_OK);
	for (size_t cut = 0; cut < size; cut++)
		assert_int_not_equal(open_exact(bytes, cut, NULL), ECO_OK);
	bytes[size] = 0;
	assert_int_not_equal(open_exact(bytes, size + 1, NULL), ECO_OK);
	free(bytes);
}

/* All single bits, then pairs of bits. No byte of a pack is without a hash or a required value. */
static void every_flipped_bit_is_found(void **state)
{
	uint64_t seed = 1;
	size_t size;
	uint8_t *bytes = small_pack(&size);

	(void)state;
	for (size_t bit = 0; bit < 8 * size; bit++) {
		bytes[bit / 8] ^= (uint8_t)(1 << bit % 8);
		assert_int_not_equal(open_exact(bytes, size, NULL), ECO_OK);
		bytes[bit / 8] ^= (uint8_t)(1 << bit % 8);
	}
	for (int i = 0; i < 50000; i++) {
		size_t bit[2];

		for (int k = 0; k < 2; k++)
			bit[k] = (size_t)((seed = seed * 6364136223846793005u + 1442695040888963407u) >> 33) % (8 * size);
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
static void forged_tables_do_no_harm(void **state)
{
	uint64_t seed = 7;
	int accepted = 0;
	size_t size;
	uint8_t *bytes = small_pack(&size), *forged = malloc(size);

	(void)state;
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
	free(bytes);
	free(forged);
}

static void a_damaged_payload_is_named_and_the_others_still_work(void **state)
{
	struct eco_error error = { 0 };
	struct eco_pack *pack;
	const uint8_t *payload;
	size_t size, payload_size;
	uint8_t *bytes = small_pack(&size);

	(void)state;
	assert_int_equal(eco_pack_open_memory(&pack, bytes, size, NULL), ECO_OK);
	bytes[pack->scene.chunks[3].offset + 5] ^= 1;
	assert_int_equal(eco_pack_payload(pack, 3, &payload, &payload_size, &error), ECO_DAMAGED);
	assert_null(payload);
	assert_non_null(strstr(error.text, "chunk 3 of list 2"));
	for (uint32_t i = 0; i < pack->scene.chunk_count; i++)
		if (i != 3)
			assert_int_equal(eco_pack_payload(pack, i, &payload, &payload_size, NULL), ECO_OK);
	eco_pack_close(pack);
	free(bytes);
}

static void equal_payloads_are_stored_once(void **state)
{
	struct eco_list list = scene_pack_list(ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, 0, 0);
	struct eco_pack_writer *w = NULL;
	struct eco_error error = { 0 };
	struct scene_pack p;
	struct eco_pack *pack;
	uint32_t first = 0, last = 0;

	(void)state;
	empty_folder();
	assert_int_equal(scene_pack_write(&p, PATH, &w, &error), ECO_OK);
	for (int i = 0; i < 300; i++) {
		assert_int_equal(scene_pack_add(w, list, scene_pack_elements(9, 4, 0, 0), NULL, &last, &error), ECO_OK);
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
	eco_pack_close(pack);
	scene_pack_free(&p);
}

static void a_failed_pack_leaves_the_old_one(void **state)
{
	size_t size, size_after;
	uint8_t *bytes = small_pack(&size), *after;
	struct eco_error error = { 0 };
	struct eco_pack_writer *w = NULL;
	struct scene_pack p;

	(void)state;
	assert_int_equal(scene_pack_write(&p, PATH, &w, &error), ECO_OK);
	assert_int_equal(count_files(), 2);
	eco_pack_abort(w);
	assert_int_equal(count_files(), 1);
	scene_pack_free(&p);
	/* A scene that does not fit together is not written. */
	assert_int_equal(scene_pack_write(&p, PATH, &w, &error), ECO_OK);
	p.plant.ladder_count++;
	assert_int_equal(eco_pack_commit(w, &p.scene, "{}", &error), ECO_DAMAGED);
	assert_int_equal(count_files(), 1);
	scene_pack_free(&p);
	after = read_file(PATH, &size_after);
	assert_int_equal(size, size_after);
	assert_memory_equal(bytes, after, size);
	free(bytes);
	free(after);
	eco_pack_abort(NULL);
}

/* A limit on file sizes acts as a full disk does: at every size, nothing half written stays. */
static void a_full_disk_is_reported_and_leaves_nothing(void **state)
{
	struct rlimit old, limit;
	size_t size;

	(void)state;
	free(small_pack(&size));
	signal(SIGXFSZ, SIG_IGN);
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
	for (size_t most = 0; most < size; most += 97) {
		struct eco_error error = { 0 };
		struct scene_pack p;
		enum eco_code code;

		empty_folder();
		limit = old;
		limit.rlim_cur = most;
		assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
		code = scene_pack_write(&p, PATH, NULL, &error);
		assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
		scene_pack_free(&p);
		assert_int_equal(code, ECO_IO);
		assert_non_null(strstr(error.text, "free some space"));
		assert_int_equal(count_files(), 0);
	}
}

static void impossible_targets_are_named(void **state)
{
	static const char *const paths[] = { FOLDER "/missing/x.eco", FOLDER, "/dev/null", "" };
	struct eco_pack *pack;

	(void)state;
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

static void only_packs_and_empty_files_are_replaced(void **state)
{
	static const struct { const char *content; enum eco_code code; } rows[] = {
		{ "{\"name\": \"my only scene\"}", ECO_BAD_INPUT }, { "x", ECO_BAD_INPUT }, { "", ECO_OK }, { "ECOPACK1, cut off", ECO_OK },
	};

	(void)state;
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		struct eco_error error = { 0 };
		struct eco_pack_writer *w = NULL;
		FILE *file;
		uint8_t *bytes;
		size_t size;

		empty_folder();
		file = fopen(PATH, "wb");
		assert_non_null(file);
		fputs(rows[i].content, file);
		fclose(file);
		assert_int_equal(eco_pack_create(&w, PATH, &error), rows[i].code);
		eco_pack_abort(w);
		bytes = read_file(PATH, &size);
		assert_int_equal(size, strlen(rows[i].content));
		assert_memory_equal(bytes, rows[i].content, size);
		assert_int_equal(count_files(), 1);
		free(bytes);
	}
}

static void bad_lists_are_refused(void **state)
{
	struct eco_list list = scene_pack_list(ECO_LIST_POINTS, ECO_CODER_FORM, 0, 0);
	struct eco_elements e = scene_pack_elements(10, 1, 0, 0);
	const uint32_t ends[2] = { 4, 9 };
	struct eco_error error = { 0 };
	struct eco_pack_writer *w = NULL;
	uint32_t id;

	(void)state;
	empty_folder();
	assert_int_equal(eco_pack_create(&w, PATH, &error), ECO_OK);
	assert_int_equal(eco_pack_add_list(w, &list, &e, ends, 2, NULL, &id, NULL), ECO_BAD_INPUT);
	list.partner = 3;
	assert_int_equal(eco_pack_add_list(w, &list, &e, ends, 2, &e, &id, NULL), ECO_BAD_INPUT);
	list.coder = ECO_CODER_KD;
	assert_int_equal(eco_pack_add_list(w, &list, &e, ends, 2, NULL, &id, &error), ECO_BAD_INPUT);
	assert_non_null(strstr(error.text, "element 9 of 10"));
	assert_int_equal(id, ECO_NONE);
	list.kind = ECO_LIST_IMAGE;
	list.coder = ECO_CODER_BYTES;
	assert_int_equal(eco_pack_add_bytes(w, &list, "", 0, &id, NULL), ECO_TOO_LARGE);
	eco_pack_abort(w);
	eco_elements_free(&e);
	assert_int_equal(count_files(), 0);
}

/* ---- eco_scene_check ---- */

/* A copy of the small pack's scene whose tables can be written to. */
struct loose {
	struct eco_scene scene;
	struct eco_plant plants[1];
	struct eco_anchor anchors[2];
	struct eco_ladder ladders[4];
	struct eco_curve curves[3];
	struct eco_tile tiles[2];
	struct eco_group groups[1];
	struct eco_child children[2];
	struct eco_list lists[12];
	struct eco_chunk chunks[20];
	struct eco_ground_tile grounds[3];
};

static void loosen(struct loose *l, const struct eco_scene *s)
{
	l->scene = *s;
#define COPY(field, name) \
	assert_int_equal(s->name##_count, sizeof l->field / sizeof l->field[0]); \
	memcpy(l->field, s->field, sizeof l->field); \
	l->scene.field = l->field
	COPY(plants, plant);
	COPY(anchors, anchor);
	COPY(ladders, ladder);
	COPY(curves, curve);
	COPY(tiles, tile);
	COPY(groups, group);
	COPY(children, child);
	COPY(lists, list);
	COPY(chunks, chunk);
	memcpy(l->grounds, s->ground, sizeof l->grounds);
	l->scene.ground = l->grounds;
#undef COPY
}

#define BREAK(id, what) static void break_##id(struct loose *l) { what; }
BREAK(name, memset(l->scene.name, 'x', sizeof l->scene.name))
BREAK(needs, l->scene.needs = 512)
BREAK(missing_need, l->scene.needs = 511 & ~ECO_NEED_LINES)
BREAK(missing_cells, l->scene.needs = 511 & ~ECO_NEED_CELLS)
BREAK(root, l->scene.root = 2)
BREAK(near, l->scene.near_m = NAN)
BREAK(near_zero, l->scene.near_m = 0)
BREAK(ground, l->grounds[0].list = 5)
BREAK(ground_range, l->grounds[0].list = 99)
BREAK(ground_size, l->scene.ground_columns = 71)
BREAK(ground_none, l->scene.ground_columns = 0)
BREAK(ground_rows, l->scene.ground_rows = 0)
BREAK(ground_lost, l->scene.ground_count = 2)
BREAK(ground_level, l->grounds[1].level = 1)
BREAK(ground_column, l->grounds[2].column = 2)
BREAK(ground_twice, l->grounds[2].column = 0)
BREAK(ground_children, l->grounds[0].child_count = 1)
BREAK(ground_child_first, l->grounds[0].child_first = 2)
BREAK(ground_orphans, l->grounds[0].child_count = 0; l->grounds[0].child_first = 0)
BREAK(ground_cycle, l->grounds[1].child_count = 2; l->grounds[1].child_first = 0)
BREAK(ground_error, l->grounds[0].error_m = -1)
BREAK(ground_error_nan, l->grounds[0].error_m = NAN)
BREAK(ground_error_child, l->grounds[1].error_m = 0.5f)
BREAK(ground_bounds, l->grounds[0].low_m = 1)
BREAK(ground_bounds_child, l->grounds[2].high_m = 0.75f)
BREAK(ground_grid, l->lists[7].grid_origin[0] = 0)
BREAK(ground_chunks, l->lists[8].chunk_count = 0; l->lists[8].primitive_count = l->lists[8].element_count = 0)
BREAK(level_large, l->lists[6].level = 8)
BREAK(level_other, l->lists[7].level = 1)
BREAK(plant_name, memset(l->plants[0].name, 'x', 64))
BREAK(no_anchor, l->plants[0].anchor_count = 0)
BREAK(anchors, l->plants[0].anchor_first = UINT32_MAX)
BREAK(ladders, l->plants[0].ladder_count = 5)
BREAK(orphan_ladder, l->plants[0].ladder_count = 3)
BREAK(height, l->plants[0].height_m = INFINITY)
BREAK(radius, l->anchors[1].radius = -1)
BREAK(center, l->anchors[0].center[2] = NAN)
BREAK(ladder_plant, l->ladders[2].plant = 1)
BREAK(ladder_anchor, l->ladders[2].anchor = 2)
BREAK(organ, l->ladders[0].organ = ECO_ORGAN_COUNT)
BREAK(flags, l->ladders[0].flags = 4)
BREAK(both_flags, l->ladders[0].flags = 3)
BREAK(no_list, l->ladders[3].triangles = ECO_NONE)
BREAK(wrong_kind, l->ladders[3].triangles = 4)
BREAK(summary_in_ladder, l->ladders[0].points = 9)
BREAK(pair, l->ladders[0].triangles = 5)
BREAK(levels, l->ladders[1].level_count = 7)
BREAK(level_end, l->ladders[1].level_end[1] = 31)
BREAK(level_order, l->ladders[1].level_end[1] = 8)
BREAK(level_rest, l->ladders[1].level_end[2] = 1)
BREAK(before, l->ladders[0].before = 41)
BREAK(importance, l->ladders[0].importance = -1)
BREAK(epsilon, l->ladders[1].epsilon = NAN)
BREAK(curve_range, l->ladders[0].curve_count = 4)
BREAK(share_zero, l->curves[0].share = 0)
BREAK(share_order, l->curves[1].share = 0.1f)
BREAK(share_one, l->curves[2].share = 1.5f)
BREAK(share_nan, l->curves[1].share = NAN)
BREAK(scale, l->curves[1].scale = INFINITY)
BREAK(fn, l->curves[1].fn = -0.1f)
BREAK(bounds, l->tiles[0].low[1] = 11)
BREAK(bounds_nan, l->tiles[1].high[1] = NAN)
BREAK(instance_count, l->tiles[1].instance_count = 8)
BREAK(subtree_count, l->tiles[0].instance_count = 7)
BREAK(summary, l->tiles[1].summary = 2)
BREAK(summary_tile, l->tiles[0].summary = 9)
BREAK(groups, l->tiles[1].group_first = 1)
BREAK(two_tiles_a_group, l->tiles[0].group_count = 1)
BREAK(children, l->tiles[0].child_count = 3)
BREAK(lost_child, l->tiles[0].child_count = 1)
BREAK(cycle, l->children[0].tile = 0)
BREAK(child_tile, l->children[0].tile = 2)
BREAK(child_at, l->children[1].at[0] = INFINITY)
BREAK(child_scale, l->children[1].scale = 0)
BREAK(group_tile, l->groups[0].tile = 0)
BREAK(group_plant, l->groups[0].plant = 1)
BREAK(group_list, l->groups[0].list = 12)
BREAK(group_kind, l->groups[0].list = 9)
BREAK(places, l->groups[0].place_first = 1)
BREAK(places_overflow, l->groups[0].place_first = UINT64_MAX)
BREAK(kind, l->lists[1].kind = 0)
BREAK(kind_large, l->lists[1].kind = 7)
BREAK(coder, l->lists[1].coder = ECO_CODER_KD)
BREAK(attributes, l->lists[4].attributes = ECO_ATTR_PLACE)
BREAK(level, l->lists[4].level = 1)
BREAK(no_place, l->lists[10].attributes = 0)
BREAK(owner, l->lists[4].owner = 1)
BREAK(owner_tile, l->lists[10].owner = 2)
BREAK(owner_none, l->lists[4].owner = ECO_NONE)
BREAK(list_plant, l->lists[10].plant = 1)
BREAK(list_plant_none, l->lists[10].plant = ECO_NONE)
BREAK(grid_step, l->lists[0].grid_step[1] = 0)
BREAK(grid_origin, l->lists[0].grid_origin[1] = NAN)
BREAK(unit_area, l->lists[2].unit_area = NAN)
BREAK(palette, l->lists[1].palette_first = 1)
BREAK(palette_overflow, l->lists[1].palette_first = UINT32_MAX)
BREAK(no_palette, l->lists[1].palette_count = 0)
BREAK(image, l->lists[1].image = 2)
BREAK(image_range, l->lists[1].image = 12)
BREAK(partner, l->lists[2].partner = ECO_NONE)
BREAK(partner_kind, l->lists[2].partner = 3)
BREAK(partner_range, l->lists[2].partner = 99)
BREAK(partner_of_plain, l->lists[9].partner = 1)
BREAK(columns, l->lists[6].columns = 5)
BREAK(no_columns, l->lists[6].columns = 0)
BREAK(columns_of_plain, l->lists[9].columns = 5)
BREAK(chunk_range, l->lists[10].chunk_first = 19)
BREAK(chunk_shared, l->lists[10].chunk_count = 18)
BREAK(primitives, l->lists[5].primitive_count++)
BREAK(elements, l->lists[5].element_count--)
BREAK(chunk_empty, l->chunks[9].element_count = 0)
BREAK(chunk_size, l->chunks[9].size_bytes = 0)
BREAK(chunk_huge, l->chunks[9].size_bytes = UINT32_MAX)
BREAK(chunk_primitives, l->chunks[9].primitive_count = 1)
BREAK(chunk_forms, l->chunks[3].primitive_count -= 2; l->chunks[4].primitive_count += 2; l->chunks[3].element_count -= 2;
	l->chunks[4].element_count += 2)
BREAK(form_of_form, l->lists[11].partner = 2)
BREAK(form_of_itself, l->lists[11].partner = 11)
BREAK(form_of_wood, l->lists[11].partner = 3)
BREAK(form_count, l->lists[11].partner = 5)
BREAK(form_primitives, l->lists[11].primitive_count = 60; l->chunks[18].primitive_count = 20; l->chunks[19].primitive_count = 40)
BREAK(form_shape, l->lists[11].primitive_count = 80; l->chunks[18].primitive_count = 20; l->chunks[19].primitive_count = 60)
BREAK(form_coder, l->lists[11].coder = ECO_CODER_ELEMENTS)
BREAK(simple, l->ladders[0].simple = 5)
BREAK(simple_of_other, l->ladders[0].points = ECO_NONE; l->ladders[0].triangles = 5)
BREAK(simple_kind, l->ladders[0].simple = 2)
BREAK(reach, l->curves[1].reach = 1.1f)
BREAK(reach_nan, l->curves[1].reach = NAN)

static void every_inconsistency_is_found(void **state)
{
#define CASE(id) { #id, break_##id }
	static const struct { const char *name; void (*apply)(struct loose *); } cases[] = {
		CASE(name), CASE(needs), CASE(missing_need), CASE(missing_cells), CASE(root), CASE(near), CASE(near_zero), CASE(ground), CASE(ground_range), CASE(ground_size),
		CASE(ground_none), CASE(ground_rows), CASE(ground_lost), CASE(ground_level), CASE(ground_column), CASE(ground_twice),
		CASE(ground_children), CASE(ground_child_first), CASE(ground_orphans), CASE(ground_cycle), CASE(ground_error),
		CASE(ground_error_nan), CASE(ground_error_child), CASE(ground_bounds), CASE(ground_bounds_child), CASE(ground_grid),
		CASE(ground_chunks), CASE(level_large), CASE(level_other),
		CASE(plant_name), CASE(no_anchor), CASE(anchors), CASE(ladders), CASE(orphan_ladder), CASE(height), CASE(radius),
		CASE(center), CASE(ladder_plant), CASE(ladder_anchor), CASE(organ), CASE(flags), CASE(both_flags), CASE(no_list),
		CASE(wrong_kind), CASE(summary_in_ladder), CASE(pair), CASE(levels), CASE(level_end), CASE(level_order), CASE(level_rest),
		CASE(before), CASE(importance), CASE(epsilon), CASE(curve_range), CASE(share_zero), CASE(share_order), CASE(share_one),
		CASE(share_nan), CASE(scale), CASE(fn), CASE(bounds), CASE(bounds_nan), CASE(instance_count), CASE(subtree_count),
		CASE(summary), CASE(summary_tile), CASE(groups), CASE(two_tiles_a_group), CASE(children), CASE(lost_child), CASE(cycle),
		CASE(child_tile), CASE(child_at), CASE(child_scale), CASE(group_tile), CASE(group_plant), CASE(group_list),
		CASE(group_kind), CASE(places), CASE(places_overflow), CASE(kind), CASE(kind_large), CASE(coder), CASE(attributes),
		CASE(level), CASE(no_place), CASE(owner), CASE(owner_tile), CASE(owner_none), CASE(list_plant), CASE(list_plant_none),
		CASE(grid_step), CASE(grid_origin), CASE(unit_area), CASE(palette), CASE(palette_overflow), CASE(no_palette), CASE(image),
		CASE(image_range), CASE(partner), CASE(partner_kind), CASE(partner_range), CASE(partner_of_plain), CASE(columns),
		CASE(no_columns), CASE(columns_of_plain), CASE(chunk_range), CASE(chunk_shared), CASE(primitives), CASE(elements),
		CASE(chunk_empty), CASE(chunk_size), CASE(chunk_huge), CASE(chunk_primitives), CASE(chunk_forms),
		CASE(form_of_form), CASE(form_of_itself), CASE(form_of_wood), CASE(form_count), CASE(form_primitives), CASE(form_shape),
		CASE(form_coder), CASE(simple), CASE(simple_of_other), CASE(simple_kind), CASE(reach), CASE(reach_nan),
	};
#undef CASE
	struct eco_error error = { 0 };
	struct eco_pack *pack;
	size_t size;
	uint8_t *bytes = small_pack(&size);

	(void)state;
	assert_int_equal(eco_pack_open_memory(&pack, bytes, size, NULL), ECO_OK);
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		struct loose l;

		loosen(&l, &pack->scene);
		error = (struct eco_error){ 0 };
		assert_int_equal(eco_scene_check(&l.scene, &error), ECO_OK);
		cases[i].apply(&l);
		if (eco_scene_check(&l.scene, &error) == ECO_OK)
			fail_msg("%s is not found", cases[i].name);
		assert_true(error.text[0] != 0);
	}
	eco_pack_close(pack);
	free(bytes);
}

static void records_have_the_stated_sizes(void **state)
{
	static const struct eco_scene scene;
	struct eco_writer w = { 0 };
	size_t before;

	(void)state;
#define SIZE(kind, call) before = w.size; call; assert_int_equal(w.size - before, eco_section_info[ECO_SECTION_##kind].record_bytes)
	SIZE(SCENE, eco_scene_write(&w, &scene));
	SIZE(PLANTS, eco_plant_write(&w, &(struct eco_plant){ 0 }));
	SIZE(ANCHORS, eco_anchor_write(&w, &(struct eco_anchor){ 0 }));
	SIZE(LADDERS, eco_ladder_write(&w, &(struct eco_ladder){ 0 }));
	SIZE(CURVES, eco_curve_write(&w, &(struct eco_curve){ 0 }));
	SIZE(TILES, eco_tile_write(&w, &(struct eco_tile){ 0 }));
	SIZE(GROUPS, eco_group_write(&w, &(struct eco_group){ 0 }));
	SIZE(CHILDREN, eco_child_write(&w, &(struct eco_child){ 0 }));
	SIZE(LISTS, eco_list_write(&w, &(struct eco_list){ 0 }));
	SIZE(CHUNKS, eco_chunk_write(&w, &(struct eco_chunk){ 0 }));
	SIZE(PLACES, eco_place_write(&w, &(struct eco_place){ 0 }));
#undef SIZE
	eco_writer_free(&w);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(records_have_the_stated_sizes),
		cmocka_unit_test(all_tables_come_back),
		cmocka_unit_test(all_payloads_decode),
		cmocka_unit_test(the_small_pack_is_the_golden_one),
		cmocka_unit_test(every_truncation_is_found),
		cmocka_unit_test(every_flipped_bit_is_found),
		cmocka_unit_test(forged_tables_do_no_harm),
		cmocka_unit_test(a_damaged_payload_is_named_and_the_others_still_work),
		cmocka_unit_test(equal_payloads_are_stored_once),
		cmocka_unit_test(a_failed_pack_leaves_the_old_one),
		cmocka_unit_test(a_full_disk_is_reported_and_leaves_nothing),
		cmocka_unit_test(impossible_targets_are_named), cmocka_unit_test(only_packs_and_empty_files_are_replaced),
		cmocka_unit_test(bad_lists_are_refused),
		cmocka_unit_test(every_inconsistency_is_found),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
