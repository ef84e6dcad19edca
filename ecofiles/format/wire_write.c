/* The server's messages about a scene, except plans (wire_plan.c). The scene has passed eco_scene_check. */
#include "ecofiles/format/wire.h"

#include <assert.h>
#include <string.h>

#include "ecofiles/base/utf8.h"

/* A name as it travels: in one of another encoding each byte above 127 becomes `?`; the stream goes on. */
static size_t plain_name(char to[64], const char from[64])
{
	size_t size = strnlen(from, 63);
	bool utf8 = eco_utf8_valid(from, size);
	memset(to, 0, 64);
	for (size_t i = 0; i < size; i++)
		to[i] = utf8 || (uint8_t)from[i] < 0x80 ? from[i] : '?';
	return size;
}

void eco_wire_write_scene(struct eco_writer *w, const struct eco_scene *scene,
	const struct eco_chunk_id *pack_id)
{
	char name[64];
	eco_write_u32(w, ECO_WIRE_VERSION);
	eco_write_bytes(w, pack_id->bytes, sizeof pack_id->bytes);
	eco_write_f64(w, scene->near_m);
	eco_write_u32(w, scene->needs);
	eco_write_u32(w, scene->ground_columns);
	eco_write_u32(w, scene->ground_rows);
	eco_write_u32(w, scene->ground_margin);
	eco_write_u32(w, scene->plant_count);
	eco_write_u32(w, scene->list_count);
	size_t size = plain_name(name, scene->name);
	eco_write_varint(w, size);
	eco_write_bytes(w, name, size);
}

void eco_wire_bundle_begin(struct eco_wire_bundle *b, struct eco_wire_items *items)
{
	b->items = items;
	b->directory.size = 0;
	eco_range_write(&b->range, &b->directory);
}

void eco_wire_bundle_plant(struct eco_wire_bundle *b, const struct eco_scene *scene, uint32_t plant)
{
	assert(plant < scene->plant_count);
	const struct eco_plant *p = &scene->plants[plant];
	struct eco_wire_item item = { .kind = ECO_ITEM_PLANT, .id = plant, .plant = *p };
	plain_name(item.plant.name, p->name);
	eco_wire_item_code(&b->range, b->items, &item);
	for (uint32_t i = 0; i < p->anchor_count; i++) {
		struct eco_anchor anchor = scene->anchors[p->anchor_first + i];
		eco_wire_anchor_code(&b->range, b->items, &anchor);
	}
}

void eco_wire_bundle_list(struct eco_wire_bundle *b, const struct eco_scene *scene, uint32_t list)
{
	assert(list < scene->list_count);
	const struct eco_list *l = &scene->lists[list];
	struct eco_wire_item item = { .kind = ECO_ITEM_LIST, .id = list, .list = *l };
	eco_wire_item_code(&b->range, b->items, &item);
	for (uint32_t i = 0; i < l->group_count; i++) {
		struct eco_group group = eco_list_groups(scene, list)[i];
		eco_wire_group_code(&b->range, b->items, i, &group);
	}
	if (!l->palette_count || eco_wire_same_palette(b->items, l))
		return;
	for (uint32_t i = 0; i < l->palette_count; i++) {
		uint8_t colour[3];
		memcpy(colour, scene->palette[l->palette_first + i], sizeof colour);
		eco_wire_colour_code(&b->range, colour);
	}
}

void eco_wire_bundle_chunk(struct eco_wire_bundle *b, const struct eco_scene *scene, uint32_t list,
	uint32_t ordinal, bool named)
{
	assert(list < scene->list_count && ordinal < scene->lists[list].chunk_count);
	struct eco_wire_item item = { .kind = ECO_ITEM_CHUNK, .id = list, .ordinal = ordinal, .named = named,
		.chunk = scene->chunks[scene->lists[list].chunk_first + ordinal] };
	eco_wire_item_code(&b->range, b->items, &item);
}

void eco_wire_bundle_end(struct eco_wire_bundle *b, struct eco_writer *w)
{
	struct eco_wire_item item = { .kind = ECO_ITEM_END };
	eco_wire_item_code(&b->range, b->items, &item);
	uint32_t zeros = eco_range_end(&b->range);
	w->failed |= b->directory.failed;
	eco_write_varint(w, b->directory.size);
	eco_write_u8(w, (uint8_t)zeros);
	if (!b->directory.failed)
		eco_write_bytes(w, b->directory.bytes, b->directory.size);
}

void eco_wire_bundle_free(struct eco_wire_bundle *b)
{
	eco_writer_free(&b->directory);
}

void eco_wire_write_end(struct eco_writer *w, uint64_t vertices, uint64_t body_bytes)
{
	eco_write_u64(w, vertices);
	eco_write_u64(w, body_bytes);
}
