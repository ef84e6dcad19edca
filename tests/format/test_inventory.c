/* Rows of inventories in packs: what is written is read, what is damaged is found and hurts nothing else. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/inventory.h"
#include "tests/support/files.h"
#include "tests/support/scene_builder.h"
#include "tests/support/scene_packs.h"
#include "tests/support/unit_test.h"

#define FOLDER "build/tmp/inventory"
#define PATH FOLDER "/small.eco"

static bool same_text(const char *a, const char *b)
{
	return a && b ? strcmp(a, b) == 0 : a == b;
}

static void assert_same_row(const struct eco_inventory_row *a, const struct eco_inventory_row *b)
{
	assert_true(same_text(a->species, b->species));
	assert_true(same_text(a->file, b->file));
	assert_int_equal(a->row, b->row);
	assert_int_equal(a->line, b->line);
	for (uint32_t k = 0; k < ECO_INVENTORY_CELLS; k++)
		assert_true(same_text(a->cells[k], b->cells[k]));
}

static size_t assert_comes_back(const struct eco_inventory_row *rows, const struct eco_inventory_row *want,
	uint32_t count)
{
	struct eco_bytes bytes = eco_inventory_encode(rows, count);
	AT_END(eco_inventory_free) struct eco_inventory_block block;
	assert_good(eco_inventory_decode(&block, bytes.at, bytes.size, count, &cause));
	for (uint32_t i = 0; i < count; i++)
		assert_same_row(&block.rows[i], &want[i]);
	free(bytes.at);
	return bytes.size;
}

UNIT_TEST(many_names_and_the_greatest_rows_come_back)
{
	static struct eco_inventory_row rows[ECO_INVENTORY_PLACES];
	static char names[2 * ECO_INVENTORY_PLACES][16];
	const uint32_t most = ECO_INVENTORY_ROW_MAX;
	for (uint32_t i = 0; i < 2 * ECO_INVENTORY_PLACES; i++)
		snprintf(names[i], sizeof names[i], "B\u00e4ume %u", i);
	for (uint32_t i = 0; i < ECO_INVENTORY_PLACES; i++)
		rows[i] = (struct eco_inventory_row){ names[2 * i], names[2 * i + 1], i % 2 ? 1 : most,
			i % 3 ? i % 3 - 1 : most, { NULL } };
	assert_comes_back(rows, rows, ECO_INVENTORY_PLACES);
}

/* A block without cells is as it was before there were any. */
UNIT_TEST(cells_come_back_and_cost_nothing_where_there_are_none)
{
	const struct eco_inventory_row plain[] = { { "a", "f", 1, 2, { NULL } }, { NULL, NULL, 0, 0, { NULL } } };
	struct eco_inventory_row full[] = { plain[0], plain[1] };
	full[0].cells[0] = "12 m";
	full[1].cells[ECO_INVENTORY_CELLS - 1] = "B\u00e4ume";
	assert_true(assert_comes_back(plain, plain, 2) < assert_comes_back(full, full, 2));
	struct eco_bytes bytes = eco_inventory_encode(plain, 2);
	assert_int_equal(bytes.at[0], 2);        /* names */
	free(bytes.at);
}

/* Names are as long as they may be and UTF-8; rows beyond what is kept are none. */
UNIT_TEST(what_does_not_fit_is_cut)
{
	char wide[301], cut[256];
	memset(wide, 'x', 300);
	wide[300] = 0;
	memset(cut, 'x', 255);
	cut[255] = 0;
	const struct eco_inventory_row given[] = { { wide, "\xff", 1, 1, { NULL } },
		{ "a\xff"
		  "b",
			"f", ECO_INVENTORY_ROW_MAX + 1, 2, { NULL } },
		{ NULL, "f", 7, ECO_INVENTORY_ROW_MAX + 1, { NULL } }, { NULL, NULL, 7, 8, { NULL } },
		{ NULL, "f", 0, 0, { NULL } } };
	const struct eco_inventory_row want[] = { { cut, "?", 1, 1, { NULL } }, { "a", NULL, 0, 0, { NULL } },
		{ NULL, "f", 7, 0, { NULL } }, { 0 }, { 0 } };
	assert_comes_back(given, want, 5);
}

UNIT_TEST(what_is_cut_or_changed_is_found_or_harmless)
{
	struct eco_bytes bytes = eco_inventory_encode(small_pack_rows, SMALL_PACK_PLANTS);
	struct eco_inventory_block block;
	for (size_t size = 0; size < bytes.size; size++) {
		FREED_MEMORY uint8_t *exact = malloc(size + !size);
		memcpy(exact, bytes.at, size);
		assert_int_equal(eco_inventory_decode(&block, exact, size, SMALL_PACK_PLANTS, NULL),
			ECO_DAMAGED);
		assert_null(block.rows);
	}
	for (size_t i = 0; i < 8 * bytes.size; i++) {
		bytes.at[i / 8] ^= (uint8_t)(1 << i % 8);
		if (eco_inventory_decode(&block, bytes.at, bytes.size, SMALL_PACK_PLANTS, NULL) == ECO_OK)
			for (uint32_t k = 0; k < SMALL_PACK_PLANTS; k++) {
				assert_true(!block.rows[k].file == !block.rows[k].row);
				assert_true(block.rows[k].line <= ECO_INVENTORY_ROW_MAX);
			}
		eco_inventory_free(&block);
		bytes.at[i / 8] ^= (uint8_t)(1 << i % 8);
	}
	free(bytes.at);
}

static uint8_t *small_pack(size_t *size)
{
	AT_END(scene_free) struct scene_builder b;
	folder_make(FOLDER);
	assert_good(small_pack_write(&b, PATH, NULL, &cause));
	return file_read(PATH, size);
}

UNIT_TEST(a_pack_says_what_each_place_is)
{
	OWNED(eco_pack) *pack;
	AT_END(eco_inventory_free) struct eco_inventory_block block;
	size_t size;
	FREED_MEMORY uint8_t *bytes = small_pack(&size);
	assert_good(eco_pack_open_memory(&pack, bytes, size, &cause));
	assert_non_null(eco_inventory_list(&pack->scene));
	assert_good(eco_inventory_read(&block, pack, 5, &cause));
	assert_int_equal(block.first, 0);
	assert_int_equal(block.count, SMALL_PACK_PLANTS);
	for (uint32_t i = 0; i < SMALL_PACK_PLANTS; i++)
		assert_same_row(&block.rows[i], &small_pack_rows[i]);
}

static enum eco_code check_changed(struct eco_scene scene, const struct eco_list *list, uint32_t at)
{
	AT_END(scene_free) struct scene_builder b;
	scene_copy(&b, &scene);
	b.lists[at] = *list;
	enum eco_code code = eco_scene_check(&b.scene, NULL);
	return code;
}

UNIT_TEST(rows_are_the_last_list_with_a_block_for_all_places)
{
	OWNED(eco_pack) *pack;
	size_t size;
	FREED_MEMORY uint8_t *bytes = small_pack(&size);
	assert_int_equal(eco_pack_open_memory(&pack, bytes, size, NULL), ECO_OK);
	struct eco_scene scene = pack->scene;
	uint32_t last = scene.list_count - 1;
	struct eco_list list = scene.lists[last];
	assert_int_equal(check_changed(scene, &list, last), ECO_OK);
	list.owner = 0;
	assert_int_equal(check_changed(scene, &list, last), ECO_DAMAGED);
	list = scene.lists[last];
	list.chunk_count = list.primitive_count = list.element_count = 0;
	assert_int_equal(check_changed(scene, &list, last), ECO_DAMAGED);
	list = scene.lists[last - 1];
	list.kind = ECO_LIST_INVENTORY;
	assert_int_equal(check_changed(scene, &list, last - 1), ECO_DAMAGED);
}
