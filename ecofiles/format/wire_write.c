/* The server's messages about a scene, except plans (wire_plan.c), and the client's holdings, which the
 * server reads. The scene has passed eco_scene_check. */
#define XXH_STATIC_LINKING_ONLY
#include <xxhash.h>

#include "ecofiles/format/wire.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/text.h"

/* ---- Frames: type, length, hash, payload ---- */

/* The hash also covers the frame's number, which is not sent: so a frame that is lost, repeated or swapped is
 * noticed although each frame is sound in itself. */

/* Bounds what decoding may take; a plan of ten thousand nested eco files stays below 1 MiB. */
#define PLAN_PAYLOAD_MAX (1u << 24)
#define SCENE_PAYLOAD_LEAST 49u
#define STRING_MAX 64u
#define BUNDLE_PAYLOAD_LEAST (1u + 2)

static const struct { const char *name; uint32_t least, most; } frames[] = {
	[ECO_FRAME_SCENE] = { "scene", SCENE_PAYLOAD_LEAST, SCENE_PAYLOAD_LEAST + STRING_MAX },
	[ECO_FRAME_BUNDLE] = { "bundle", BUNDLE_PAYLOAD_LEAST, ECO_FRAME_PAYLOAD_MAX },
	[ECO_FRAME_PLAN] = { "plan", 1, PLAN_PAYLOAD_MAX },
	[ECO_FRAME_END] = { "end", 16, 16 },
	[ECO_FRAME_AHEAD] = { "ahead", 0, 0 },
};

const char *eco_frame_name(uint32_t type)
{
	return type < sizeof frames / sizeof *frames ? frames[type].name : NULL;
}

void eco_frame_limits(enum eco_frame_type type, uint32_t *least, uint32_t *most)
{
	assert(eco_frame_name(type));
	*least = frames[type].least;
	*most = frames[type].most;
}

static void put_u32(uint8_t *p, uint32_t v)
{
	for (int i = 0; i < 4; i++)
		p[i] = (uint8_t)(v >> (8 * i));
}

uint64_t eco_frame_hash(const uint8_t header[8], uint32_t number, const uint8_t *payload, size_t size)
{
	XXH3_state_t state;
	uint8_t head[12];
	memcpy(head, header, 8);
	put_u32(head + 8, number);
	XXH3_INITSTATE(&state);
	XXH3_64bits_reset(&state);
	XXH3_64bits_update(&state, head, sizeof head);
	XXH3_64bits_update(&state, payload, size);
	return XXH3_64bits_digest(&state);
}

struct eco_frame_mark eco_frame_begin(struct eco_writer *w, enum eco_frame_type type, uint32_t number)
{
	struct eco_frame_mark mark = { w->size, number };
	assert(eco_frame_name(type));
	eco_write_u32(w, type);
	eco_write_u32(w, 0);
	eco_write_u64(w, 0);
	return mark;
}

void eco_frame_end(struct eco_writer *w, struct eco_frame_mark mark)
{
	if (w->failed)
		return;
	assert(w->size >= mark.at + ECO_FRAME_HEADER_BYTES);
	uint8_t *header = w->bytes + mark.at;
	size_t size = w->size - mark.at - ECO_FRAME_HEADER_BYTES;
	uint32_t least, most;
	eco_frame_limits(header[0], &least, &most);
	if (size < least || size > most) {
		w->failed = true;
		return;
	}
	put_u32(header + 4, (uint32_t)size);
	uint64_t hash = eco_frame_hash(header, mark.number, header + ECO_FRAME_HEADER_BYTES, size);
	put_u32(header + 8, (uint32_t)hash);
	put_u32(header + 12, (uint32_t)(hash >> 32));
}

/* ---- Messages ---- */

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

void eco_wire_bundle_plant(struct eco_wire_bundle *b, const struct eco_scene *scene, uint32_t plant,
	bool cells)
{
	assert(plant < scene->plant_count);
	const struct eco_plant *p = &scene->plants[plant];
	struct eco_wire_item item = { .kind = ECO_ITEM_PLANT, .id = plant, .plant = *p, .cells = cells };
	plain_name(item.plant.name, p->name);
	eco_wire_item_code(&b->range, b->items, &item);
	for (uint32_t i = 0; i < (cells ? p->anchor_count : 1); i++) {
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

/* ---- A client's holdings: the body of a POST, so the first bytes that a stranger sends ---- */

void eco_wire_write_holdings(struct eco_writer *w, const struct eco_holdings *holdings)
{
	uint32_t before = 0;
	eco_write_u32(w, holdings->count);
	for (uint32_t i = 0; i < holdings->count; i++) {
		eco_write_varint(w, holdings->items[i].list - before);
		eco_write_varint(w, holdings->items[i].chunks);
		before = holdings->items[i].list;
	}
}

#define BAD(...) eco_fail(error, ECO_BAD_INPUT, "holdings: " __VA_ARGS__)

static enum eco_code read_items(struct eco_reader *r, struct eco_holding *items, uint32_t count,
	struct eco_error *error)
{
	uint64_t list = 0;
	for (uint32_t i = 0; i < count; i++) {
		uint64_t step = eco_read_varint(r), chunks = eco_read_varint(r);
		if (r->failed)
			return BAD("item %u of %u is cut off or not a canonical number, near byte %zu", i, count, r->at);
		if (i && step == 0)
			return BAD("item %u repeats list %llu", i, (unsigned long long)list);
		if (step >= ECO_NONE - list)
			return BAD("item %u names a list beyond %u", i, ECO_NONE - 1);
		if (chunks == 0 || chunks > UINT32_MAX)
			return BAD("item %u holds %llu chunks: leave out lists of which nothing is held", i,
				(unsigned long long)chunks);
		list += step;
		items[i] = (struct eco_holding){ (uint32_t)list, (uint32_t)chunks };
	}
	return r->at == r->size ? ECO_OK : BAD("%zu bytes follow item %u, the last", r->size - r->at, count);
}

enum eco_code eco_wire_read_holdings(const uint8_t *bytes, size_t size, struct eco_holdings *holdings,
	struct eco_error *error)
{
	struct eco_reader r = { .bytes = bytes, .size = size };
	uint32_t count = eco_read_u32(&r);
	*holdings = (struct eco_holdings){ 0 };
	if (r.failed)
		return BAD("%zu bytes, at least 4 are needed for the count", size);
	if (count > ECO_HOLDINGS_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "holdings: %u lists, at most %u", count,
			ECO_HOLDINGS_MAX);
	/* the smallest item takes two bytes: allocate no more than can be there */
	if (count > (size - r.at) / 2)
		return BAD("%zu bytes cannot hold %u items", size, count);
	struct eco_holding *items = malloc(count ? count * sizeof *items : 1);
	if (!items)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u holdings", count);
	enum eco_code code = read_items(&r, items, count, error);
	if (code) {
		free(items);
		return code;
	}
	*holdings = (struct eco_holdings){ items, count };
	return ECO_OK;
}
