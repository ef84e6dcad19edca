/* Packs, as they are and with their hashes made to fit, which is what opens the way to the tables' checks. A
 * pack that opens must be consistent enough to read everything in it. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/inventory.h"
#include "lod/ground_choice.h"
#include "tests/support/pack_resign.h"

/* The payload's hash is passed over here, too. */
static void read_rows(const struct eco_pack *pack, const struct eco_chunk *chunk, uint32_t ordinal)
{
	uint64_t left = pack->scene.place_count - (uint64_t)ordinal * ECO_INVENTORY_PLACES;
	uint32_t count = left < ECO_INVENTORY_PLACES ? (uint32_t)left : ECO_INVENTORY_PLACES;
	struct eco_inventory_block block;
	if (eco_inventory_decode(&block, pack->map + chunk->offset, chunk->size_bytes, count, NULL) == ECO_OK)
		for (uint32_t i = 0; i < count; i++)
			assert(!block.rows[i].file == !block.rows[i].row
				&& (!block.rows[i].species || block.rows[i].species[0]));
	eco_inventory_free(&block);
}

static void read_chunks(const struct eco_pack *pack, const struct eco_list *list)
{
	for (uint32_t i = 0; i < list->chunk_count && i < 8; i++) {
		const struct eco_chunk *chunk = &pack->scene.chunks[list->chunk_first + i];
		struct eco_elements elements;
		const uint8_t *payload;
		size_t size;
		eco_pack_payload(pack, list->chunk_first + i, &payload, &size, NULL);
		if (list->kind == ECO_LIST_INVENTORY)
			read_rows(pack, chunk, i);
		if (list->coder == ECO_CODER_BYTES || chunk->element_count > 4096)
			continue;
		/* The payload's hash is passed over on purpose. */
		eco_chunk_decode(list, chunk, i, pack->map + chunk->offset, chunk->size_bytes, &elements,
			NULL);
		eco_elements_free(&elements);
	}
}

/* Any table of ground that passes must be safe to walk. */
static void choose_ground(const struct eco_scene *s)
{
	const struct eco_view view = { { 3, -4, 9 }, { 20, 30, 0 }, { 0, 0, 1 }, 60, 640, 480 };
	const struct lod_ground_limits limits = { .tolerance_px = 0.5 };
	struct lod_ground_choice choice;
	struct lod_eye eye;
	lod_eye_make(&eye, &view);
	if (lod_ground_select(&choice, s, &eye, &limits, NULL) != ECO_OK)
		return;
	for (uint32_t i = 0; i < choice.count; i++)
		assert(choice.tiles[i] < s->ground_count
			&& (i == 0 || choice.tiles[i] > choice.tiles[i - 1]));
	free(choice.tiles);
}

static void read_all(const struct eco_pack *pack)
{
	const struct eco_scene *s = &pack->scene;
	uint64_t sum = 0;
	for (uint32_t i = 0; i < s->list_count && i < 64; i++)
		read_chunks(pack, &s->lists[i]);
	for (uint64_t i = 0; i < s->place_count; i++)
		sum += eco_place_read(s, i).scale;
	for (uint32_t i = 0; i < s->palette_count; i++)
		sum += s->palette[i][2];
	for (size_t i = 0; i < pack->meta_size; i++)
		sum += (unsigned char)pack->meta[i];
	choose_ground(s);
	assert(sum < UINT64_MAX);
}

static void open_and_read(const uint8_t *bytes, size_t size)
{
	struct eco_error error = { 0 };
	struct eco_pack *pack;
	if (eco_pack_open_memory(&pack, bytes, size, &error) == ECO_OK) {
		read_all(pack);
		eco_pack_close(pack);
	} else {
		assert(!pack && error.text[0] != 0);
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	uint8_t *copy = malloc(size > 0 ? size : 1);
	if (!copy)
		return 0;
	open_and_read(bytes, size);
	memcpy(copy, bytes, size);
	pack_resign(copy, size);
	open_and_read(copy, size);
	free(copy);
	return 0;
}
