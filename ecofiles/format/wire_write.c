/* The server's messages about a scene, except plans (wire_plan.c). The scene has passed eco_scene_check. */
#include "ecofiles/format/wire.h"

#include <assert.h>
#include <string.h>

#include "ecofiles/base/utf8.h"

static void write_string(struct eco_writer *w, const char *text, size_t room)
{
	size_t size = strnlen(text, room - 1);
	bool utf8 = eco_utf8_valid(text, size);
	eco_write_varint(w, size);
	/* in a name of another encoding each byte above 127 becomes `?`; the stream goes on */
	for (size_t i = 0; i < size; i++)
		eco_write_u8(w, utf8 || (uint8_t)text[i] < 0x80 ? (uint8_t)text[i] : '?');
}

void eco_wire_write_scene(struct eco_writer *w, const struct eco_scene *scene,
	const struct eco_chunk_id *pack_id)
{
	eco_write_u32(w, ECO_WIRE_VERSION);
	eco_write_bytes(w, pack_id->bytes, sizeof pack_id->bytes);
	eco_write_f64(w, scene->near_m);
	eco_write_u32(w, scene->needs);
	eco_write_u32(w, scene->ground_columns);
	eco_write_u32(w, scene->ground_rows);
	eco_write_u32(w, scene->ground_margin);
	eco_write_u32(w, scene->plant_count);
	eco_write_u32(w, scene->list_count);
	write_string(w, scene->name, sizeof scene->name);
}

void eco_wire_write_plant(struct eco_writer *w, const struct eco_scene *scene, uint32_t plant)
{
	assert(plant < scene->plant_count);
	const struct eco_plant *p = &scene->plants[plant];
	eco_write_u32(w, plant);
	write_string(w, p->name, sizeof p->name);
	eco_write_f32(w, p->height_m);
	eco_write_u32(w, p->anchor_first);
	eco_write_u32(w, p->anchor_count);
	for (uint32_t i = 0; i < p->anchor_count; i++)
		eco_anchor_write(w, &scene->anchors[p->anchor_first + i]);
}

void eco_wire_write_record(struct eco_writer *w, const struct eco_list *list, struct eco_wire_record *before)
{
	struct eco_wire_record record;
	uint8_t bits[ECO_WIRE_RECORD_BITS] = { 0 };
	uint16_t some = 0;
	struct eco_list sent = *list;
	sent.chunk_first = 0;
	sent.primitive_count -= sent.element_count;
	eco_list_write(w, &sent);
	if (w->failed)
		return;
	w->size -= sizeof record.bytes;
	memcpy(record.bytes, w->bytes + w->size, sizeof record.bytes);
	for (uint32_t i = 0; i < sizeof record.bytes; i++)
		bits[i / 8] |= (uint8_t)((record.bytes[i] != before->bytes[i]) << i % 8);
	for (uint32_t i = 0; i < sizeof bits; i++)
		some |= (uint16_t)((bits[i] != before->bits[i]) << i);
	eco_write_u16(w, some);
	for (uint32_t i = 0; i < sizeof bits; i++)
		if (bits[i] != before->bits[i])
			eco_write_u8(w, bits[i] ^ before->bits[i]);
	for (uint32_t i = 0; i < sizeof record.bytes; i++)
		if (bits[i / 8] >> i % 8 & 1)
			eco_write_u8(w, record.bytes[i]);
	memcpy(before->bytes, record.bytes, sizeof before->bytes);
	memcpy(before->bits, bits, sizeof before->bits);
}

static void write_head(struct eco_writer *w, uint32_t list, bool chunk, struct eco_wire_record *before)
{
	int64_t step = (int64_t)list - before->list;
	uint64_t zigzag = step < 0 ? 2 * (uint64_t)-step - 1 : 2 * (uint64_t)step;
	eco_write_varint(w, 2 * zigzag + chunk);
	before->list = list;
}

bool eco_wire_same_palette(const struct eco_wire_record *before, const struct eco_list *list)
{
	return before->palette_count == list->palette_count && before->palette_first == list->palette_first;
}

static void write_groups(struct eco_writer *w, const struct eco_scene *scene, uint32_t list)
{
	const struct eco_group *group = eco_list_groups(scene, list);
	const struct eco_group *end = group + scene->lists[list].group_count;
	for (uint32_t before = 0; group < end; before = group++->plant) {
		eco_write_zigzag(w, (int64_t)group->plant - before);
		eco_write_varint(w, group->count - 1);
	}
}

void eco_wire_write_list(struct eco_writer *w, const struct eco_scene *scene, uint32_t list,
	struct eco_wire_record *before)
{
	assert(list < scene->list_count);
	const struct eco_list *l = &scene->lists[list];
	write_head(w, list, false, before);
	before->alone = l->chunk_count == 1;
	eco_wire_write_record(w, l, before);
	if (l->group_count)
		write_groups(w, scene, list);
	if (!l->palette_count || eco_wire_same_palette(before, l))
		return;
	eco_write_bytes(w, scene->palette + l->palette_first, 3 * (size_t)l->palette_count);
	before->palette_first = l->palette_first;
	before->palette_count = l->palette_count;
}

void eco_wire_write_chunk(struct eco_writer *w, const struct eco_scene *scene, uint32_t list,
	uint32_t ordinal, bool named, struct eco_wire_record *before)
{
	assert(list < scene->list_count && ordinal < scene->lists[list].chunk_count);
	const struct eco_chunk *chunk = &scene->chunks[scene->lists[list].chunk_first + ordinal];
	bool alone = before->alone && before->list == list;
	write_head(w, list, true, before);
	before->alone = false;
	if (!alone) {
		eco_write_varint(w, ordinal);
		eco_write_varint(w, chunk->element_count);
		eco_write_varint(w, chunk->primitive_count - chunk->element_count);
	}
	if (named)
		eco_write_varint(w, 0);
	eco_write_varint(w, chunk->size_bytes);
	if (named)
		eco_write_bytes(w, chunk->id.bytes, sizeof chunk->id.bytes);
}

void eco_wire_write_end(struct eco_writer *w, uint64_t vertices, uint64_t body_bytes)
{
	eco_write_u64(w, vertices);
	eco_write_u64(w, body_bytes);
}
