/* The client's half of the stream: bytes in any portions -> whole, checked frames.
 *
 * Two layers. The assembler (feed) knows frames: it bounds a frame's length by its type before it keeps a
 * byte, collects the frame and checks its hash. The readers know payloads: each reads all fields, checks
 * them, and checks that nothing is left. They check against a few counts from the SCENE frame and values
 * of the frame before, so the parser's memory does not grow with the stream. */
#include "ecofiles/format/wire.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/ground_tile.h"
#include "ecofiles/base/text.h"

#define BAD(...) eco_fail(e, ECO_DAMAGED, __VA_ARGS__)

struct eco_wire_parser {
	struct eco_wire_events events;
	void *ctx;
	struct eco_error failure;            /* the first error, which is final */

	struct eco_writer frame;             /* the part of it that has come */
	uint32_t payload_size;               /* from the header */
	uint32_t number;                     /* of the frame being read */
	uint64_t offset;                     /* of that frame's header in the stream */

	uint32_t last_type;                  /* 0 before the first frame */
	uint32_t last_list, last_ordinal;    /* of the last chunk; ECO_NONE before it */
	struct eco_wire_items items;         /* what the next item is told by */
	uint8_t (*palette)[3];               /* the last one that came */
	struct eco_group *groups;            /* of the last list */
	bool planned, ahead;                 /* a PLAN has come; AHEAD has */
	uint64_t vertices;                   /* of the last one */
	uint32_t plant_count, list_count;
	bool ground;
};

/* ---- Fields ---- */

/* Copies into text[64] with a terminating NUL. */
static bool read_string(struct eco_reader *r, char text[64])
{
	uint64_t size = eco_read_varint(r);
	const uint8_t *bytes = size < 64 ? eco_read_bytes(r, size) : NULL;
	memset(text, 0, 64);
	if (!bytes || !eco_utf8_valid((const char *)bytes, size))
		return false;
	memcpy(text, bytes, size);
	return true;
}

static enum eco_code whole(const struct eco_reader *r, struct eco_error *e)
{
	if (r->failed)
		return BAD("its fields end early");
	if (r->at != r->size)
		return BAD("%zu bytes follow its last field", r->size - r->at);
	return ECO_OK;
}

/* ---- One reader a frame type ---- */

static enum eco_code read_scene(struct eco_wire_parser *p, struct eco_reader *r, struct eco_error *e)
{
	struct eco_scene scene = { .root = ECO_NONE };
	struct eco_chunk_id pack_id;
	uint32_t version = eco_read_u32(r);
	const uint8_t *id = eco_read_bytes(r, sizeof pack_id.bytes);
	if (version != ECO_WIRE_VERSION)
		return eco_fail(e, ECO_UNSUPPORTED, "it has version %u, this program reads version %u",
			version, ECO_WIRE_VERSION);
	scene.near_m = eco_read_f64(r);
	scene.needs = eco_read_u32(r);
	scene.ground_columns = eco_read_u32(r);
	scene.ground_rows = eco_read_u32(r);
	scene.ground_margin = eco_read_u32(r);
	scene.plant_count = eco_read_u32(r);
	scene.list_count = eco_read_u32(r);
	bool named = read_string(r, scene.name);
	if (whole(r, e) != ECO_OK)
		return ECO_DAMAGED;
	if (!named)
		return BAD("the scene's name is too long or not UTF-8");
	if (!isfinite(scene.near_m) || scene.near_m <= 0)
		return BAD("the near plane is not a positive number");
	if (scene.needs & ~(uint32_t)ECO_NEEDS_ALL)
		return eco_fail(e, ECO_UNSUPPORTED, "the scene needs features 0x%x, which this program does "
			"not know", scene.needs & ~(uint32_t)ECO_NEEDS_ALL);
	if (!eco_ground_size_fits(scene.ground_columns, scene.ground_rows, scene.ground_margin))
		return BAD("the ground has %u x %u samples with margins of %u", scene.ground_columns,
			scene.ground_rows, scene.ground_margin);
	memcpy(pack_id.bytes, id, sizeof pack_id.bytes);
	p->plant_count = scene.plant_count;
	p->list_count = scene.list_count;
	p->ground = scene.ground_columns != 0;
	return p->events.scene ? p->events.scene(p->ctx, &scene, &pack_id, e) : ECO_OK;
}

/* An anchor takes at least four bits: allocates no more than can be there. */
static enum eco_code read_anchors(struct eco_wire_parser *p, struct eco_range *r,
	const struct eco_wire_item *item, struct eco_error *e)
{
	uint32_t all = item->plant.anchor_count, count = item->cells ? all : 1;
	enum eco_code code = ECO_OK;
	if (all == 0 || count > eco_wire_items_bits(r) / 4 || item->plant.anchor_first > ECO_NONE - all)
		return BAD("plant %u has %u anchors from %u, in %zu bytes", item->id, all,
			item->plant.anchor_first, r->size);
	struct eco_anchor *anchors = calloc(count, sizeof *anchors);
	if (!anchors)
		return eco_fail(e, ECO_NO_MEMORY, "no memory for %u anchors", count);
	for (uint32_t i = 0; i < count && !code; i++) {
		eco_wire_anchor_code(r, &p->items, &anchors[i]);
		if (p->items.bad || !eco_anchor_sound(&anchors[i]))
			code = BAD("anchor %u of plant %u is not a sphere", i, item->id);
	}
	if (!code && p->events.plant)
		code = p->events.plant(p->ctx, item->id, &item->plant, anchors, count, e);
	free(anchors);
	return code;
}

static enum eco_code read_plant(struct eco_wire_parser *p, struct eco_range *r,
	const struct eco_wire_item *item, struct eco_error *e)
{
	const char *name = item->plant.name;
	if (item->id >= p->plant_count)
		return BAD("it describes plant %u of %u", item->id, p->plant_count);
	if (!eco_utf8_valid(name, strlen(name)))
		return BAD("the name of plant %u is not UTF-8", item->id);
	if (!isfinite(item->plant.height_m) || item->plant.height_m < 0)
		return BAD("the height of plant %u is not a finite number from 0 on", item->id);
	return read_anchors(p, r, item, e);
}

/* A stream has the whole record of a list; its partner's is checked by the receiver, which holds both. */
static enum eco_code check_list(const struct eco_wire_parser *p, uint32_t id, const struct eco_list *list,
	struct eco_error *e)
{
	bool ground = list->kind == ECO_LIST_GROUND || list->kind == ECO_LIST_GROUND_IMAGE;
	const char *fault = eco_list_fault(list);
	if (fault)
		return BAD("list %u: %s", id, fault);
	if (list->kind == ECO_LIST_INVENTORY || list->chunk_count > ECO_HOLDINGS_MAX)
		return BAD("list %u: kind %u with %u chunks does not travel", id, list->kind, list->chunk_count);
	if ((ground && !p->ground)
			|| (list->kind == ECO_LIST_GROUND_IMAGE && list->grid_step[0] != list->grid_step[1]))
		return BAD("list %u is ground, but the scene has none, or its texels are not square", id);
	if ((list->image != ECO_NONE && list->image >= p->list_count) || list->partner == id
			|| (list->partner != ECO_NONE && list->partner >= p->list_count))
		return BAD("list %u names image %u and partner %u of %u lists", id,
			list->image, list->partner, p->list_count);
	return ECO_OK;
}

/* A colour takes 24 bits: allocates no more than can be there. */
static enum eco_code read_palette(struct eco_wire_parser *p, struct eco_range *r, uint32_t id,
	const struct eco_list *list, struct eco_error *e)
{
	if (list->palette_count > eco_wire_items_bits(r) / 24)
		return BAD("list %u: a palette of %u colours in %zu bytes", id, list->palette_count, r->size);
	uint8_t (*palette)[3] = realloc(p->palette, 3 * (size_t)list->palette_count);
	if (!palette)
		return eco_fail(e, ECO_NO_MEMORY, "no memory for a palette of %u colours",
			list->palette_count);
	p->palette = palette;
	for (uint32_t i = 0; i < list->palette_count; i++)
		eco_wire_colour_code(r, palette[i]);
	return ECO_OK;
}

/* A group takes at least a bit: allocates no more than can be there. */
static enum eco_code read_groups(struct eco_wire_parser *p, struct eco_range *r, uint32_t id,
	const struct eco_list *list, struct eco_error *e)
{
	uint32_t first = 0, count = list->group_count;
	if (count > eco_wire_items_bits(r))
		return BAD("list %u: %u groups of plants in %zu bytes", id, count, r->size);
	struct eco_group *groups = realloc(p->groups, count * sizeof *groups);
	if (!groups)
		return eco_fail(e, ECO_NO_MEMORY, "no memory for %u groups of plants", count);
	p->groups = groups;
	for (uint32_t i = 0; i < count; i++) {
		groups[i] = (struct eco_group){ .tile = list->owner, .list = id, .first = first };
		eco_wire_group_code(r, &p->items, i, &groups[i]);
		if (p->items.bad || groups[i].plant >= p->plant_count)
			return BAD("list %u: group %u ends early, or its plant is none of %u", id, i,
				p->plant_count);
		if (groups[i].count - 1 >= list->primitive_count - first)
			return BAD("list %u: group %u has %u plants, %u are left of the list", id, i,
				groups[i].count, list->primitive_count - first);
		first += groups[i].count;
	}
	return first == list->primitive_count ? ECO_OK : BAD("list %u: its groups have %u of %u plants", id,
		first, list->primitive_count);
}

static enum eco_code read_list(struct eco_wire_parser *p, struct eco_range *r,
	const struct eco_wire_item *item, struct eco_error *e)
{
	const struct eco_list *list = &item->list;
	uint32_t id = item->id;
	if (id >= p->list_count)
		return BAD("it has list %u of %u", id, p->list_count);
	enum eco_code code = check_list(p, id, list, e);
	if (!code && list->group_count)
		code = read_groups(p, r, id, list, e);
	if (!code && list->palette_count && !eco_wire_same_palette(&p->items, list))
		code = read_palette(p, r, id, list, e);
	if (!code && !eco_wire_items_bits(r))
		code = BAD("list %u ends early", id);
	return code || !p->events.list ? code : p->events.list(p->ctx, id, list, p->palette, p->groups, e);
}

static enum eco_code check_chunk(const struct eco_wire_parser *p, uint32_t list, uint32_t ordinal,
	const struct eco_chunk *chunk, struct eco_error *e)
{
	if (chunk->size_bytes == 0 || chunk->size_bytes > ECO_CHUNK_BYTES_MAX
			|| chunk->element_count > ECO_CHUNK_ELEMENTS_MAX
			|| chunk->primitive_count > (ECO_CORNERS_MAX - 2) * (uint64_t)chunk->element_count + 1)
		return BAD("chunk %u of list %u has %u bytes, %u elements and %u primitives", ordinal, list,
			chunk->size_bytes, chunk->element_count, chunk->primitive_count);
	if (ordinal >= ECO_HOLDINGS_MAX || (list == p->last_list && ordinal != p->last_ordinal + 1))
		return BAD("chunk %u of list %u follows chunk %u", ordinal, list, p->last_ordinal);
	return ECO_OK;
}

static enum eco_code fetch_named(struct eco_wire_parser *p, uint32_t list, struct eco_chunk *chunk,
	const uint8_t **payload, struct eco_error *e)
{
	if (!p->events.fetch)
		return eco_fail(e, ECO_UNSUPPORTED, "a chunk of list %u is named, not carried, and nothing "
			"here fetches it: ask without name_from", list);
	enum eco_code code = p->events.fetch(p->ctx, chunk, payload, e);
	if (code || !*payload)
		return code;
	struct eco_chunk_id id = eco_chunk_hash(*payload, chunk->size_bytes);
	return memcmp(id.bytes, chunk->id.bytes, sizeof id.bytes) == 0 ? ECO_OK
		: BAD("what was fetched for a chunk of list %u, %u bytes, does not have the hash that names "
		"it", list, chunk->size_bytes);
}

static enum eco_code read_chunk(struct eco_wire_parser *p, struct eco_reader *payloads,
	const struct eco_wire_item *item, struct eco_error *e)
{
	struct eco_chunk chunk = item->chunk;
	uint32_t list = item->id, ordinal = item->ordinal;
	if (list >= p->list_count)
		return BAD("it has a chunk of list %u of %u", list, p->list_count);
	enum eco_code code = check_chunk(p, list, ordinal, &chunk, e);
	if (code)
		return code;
	if (!item->named && chunk.size_bytes > payloads->size - payloads->at)
		return BAD("chunk %u of list %u has %u bytes, %zu are left of the bundle", ordinal, list,
			chunk.size_bytes, payloads->size - payloads->at);
	p->last_list = list;
	p->last_ordinal = ordinal;
	const uint8_t *payload = item->named ? NULL : eco_read_bytes(payloads, chunk.size_bytes);
	if (item->named)
		code = fetch_named(p, list, &chunk, &payload, e);
	else
		chunk.id = eco_chunk_hash(payload, chunk.size_bytes);
	return code || !payload || !p->events.chunk ? code
		: p->events.chunk(p->ctx, list, ordinal, &chunk, payload, e);
}

static enum eco_code read_item(struct eco_wire_parser *p, struct eco_range *r, struct eco_reader *payloads,
	struct eco_wire_item *item, struct eco_error *e)
{
	*item = (struct eco_wire_item){ .kind = ECO_ITEM_END };
	eco_wire_item_code(r, &p->items, item);
	if (p->items.bad || !eco_wire_items_bits(r))
		return BAD("its directory ends early, or an item of it is impossible or said in vain");
	switch (item->kind) {
	case ECO_ITEM_PLANT: return read_plant(p, r, item, e);
	case ECO_ITEM_LIST: return read_list(p, r, item, e);
	case ECO_ITEM_CHUNK: return read_chunk(p, payloads, item, e);
	default: return ECO_OK;
	}
}

static enum eco_code read_bundle(struct eco_wire_parser *p, struct eco_reader *r, struct eco_error *e)
{
	struct eco_wire_item item;
	struct eco_range range;
	uint64_t size = eco_read_varint(r);
	uint32_t zeros = eco_read_u8(r);
	const uint8_t *directory = size <= r->size ? eco_read_bytes(r, (size_t)size) : NULL;
	if (!directory || r->failed)
		return BAD("a directory of %llu bytes is longer than the bundle", (unsigned long long)size);
	eco_range_read(&range, directory, (size_t)size);
	do {
		ECO_PASS(read_item(p, &range, r, &item, e));
	} while (item.kind != ECO_ITEM_END);
	if (eco_range_end(&range) != zeros)
		return BAD("its directory is not as long as it says");
	return whole(r, e);
}

static enum eco_code check_plan_ids(const struct eco_wire_parser *p, const struct eco_plan *plan,
	struct eco_error *e)
{
	for (uint32_t i = 0; i < plan->run_count; i++)
		if (plan->runs[i].list_end > p->list_count)
			return BAD("run %u of the plan ends at list %u of %u", i,
				plan->runs[i].list_end, p->list_count);
	for (uint32_t i = 0; i < plan->gate_count; i++)
		if (plan->gates[i].plant >= p->plant_count)
			return BAD("gate %u of the plan is of plant %u of %u", i,
				plan->gates[i].plant, p->plant_count);
	for (uint32_t i = 0; i < plan->cut_count; i++)
		if (plan->cuts[i].list >= p->list_count)
			return BAD("cut %u of the plan draws list %u of %u", i,
				plan->cuts[i].list, p->list_count);
	return ECO_OK;
}

static enum eco_code read_plan(struct eco_wire_parser *p, struct eco_reader *r, struct eco_error *e)
{
	struct eco_plan plan;
	ECO_PASS(eco_wire_read_plan(r, &plan, e));
	enum eco_code code = whole(r, e);
	code = code ? code : check_plan_ids(p, &plan, e);
	p->planned = true;
	p->vertices = plan.vertices;
	if (!code && p->events.plan)
		return p->events.plan(p->ctx, &plan, e);
	eco_plan_free(&plan);
	return code;
}

static enum eco_code read_end(struct eco_wire_parser *p, struct eco_reader *r, struct eco_error *e)
{
	uint64_t vertices = eco_read_u64(r), bytes = eco_read_u64(r), came = p->offset + ECO_END_FRAME_BYTES;
	ECO_PASS(whole(r, e));
	if (vertices != p->vertices)
		return BAD("it states %llu vertices, the last plan has %llu",
			(unsigned long long)vertices, (unsigned long long)p->vertices);
	if (bytes != came)
		return BAD("it states %llu bytes, %llu came", (unsigned long long)bytes,
			(unsigned long long)came);
	return p->events.end ? p->events.end(p->ctx, vertices, e) : ECO_OK;
}

static enum eco_code read_ahead(struct eco_wire_parser *p, struct eco_reader *r, struct eco_error *e)
{
	(void)r;
	p->ahead = true;
	return p->events.ahead ? p->events.ahead(p->ctx, e) : ECO_OK;
}

/* ---- Frames ---- */

static enum eco_code (*const readers[])(struct eco_wire_parser *, struct eco_reader *, struct eco_error *) = {
	[ECO_FRAME_SCENE] = read_scene, [ECO_FRAME_BUNDLE] = read_bundle, [ECO_FRAME_PLAN] = read_plan,
	[ECO_FRAME_END] = read_end, [ECO_FRAME_AHEAD] = read_ahead,
};

/* The order of frames at the top of wire.h. */
static bool may_follow(const struct eco_wire_parser *p, uint32_t type)
{
	if (type == ECO_FRAME_SCENE)
		return p->last_type == 0;
	if (type == ECO_FRAME_END)
		return p->planned;
	if (type == ECO_FRAME_AHEAD)
		return p->last_type == ECO_FRAME_PLAN;
	if (type == ECO_FRAME_PLAN && p->ahead)
		return false;
	return p->last_type != 0 && p->last_type != ECO_FRAME_END;
}

static enum eco_code check_header(struct eco_wire_parser *p, struct eco_error *e)
{
	struct eco_reader r = { .bytes = p->frame.bytes, .size = ECO_FRAME_HEADER_BYTES };
	uint32_t first = eco_read_u32(&r), type = first & 0xFF, least, most;
	p->payload_size = eco_read_u32(&r);
	if (first > 0xFF || !eco_frame_name(type))
		return BAD("it is of type 0x%x, which does not exist", first);
	if (!may_follow(p, type))
		return BAD("a %s frame cannot %s%s", eco_frame_name(type),
			p->last_type ? "follow a frame of type " :
			"be the first", p->last_type ? eco_frame_name(p->last_type) : "");
	eco_frame_limits(type, &least, &most);
	if (p->payload_size < least || p->payload_size > most)
		return BAD("a %s frame of %u bytes: [%u, %u] is possible",
			eco_frame_name(type), p->payload_size, least, most);
	return ECO_OK;
}

static enum eco_code read_frame(struct eco_wire_parser *p, struct eco_error *e)
{
	const uint8_t *header = p->frame.bytes, *payload = header + ECO_FRAME_HEADER_BYTES;
	struct eco_reader hash = { .bytes = header + 8, .size = 8 };
	struct eco_reader r = { .bytes = payload, .size = p->payload_size };
	if (eco_frame_hash(header, p->number, payload, p->payload_size) != eco_read_u64(&hash))
		return BAD("its hash does not match: it was damaged, or a frame is missing before it");
	ECO_PASS(readers[header[0]](p, &r, e));
	p->last_type = header[0];
	p->offset += p->frame.size;
	p->number++;
	p->frame.size = 0;
	return ECO_OK;
}

/* Takes bytes for the current frame's header or payload and reads the frame once it is whole. Memory grows
 * with the bytes that came: a header's length is not believed. */
static enum eco_code feed_some(struct eco_wire_parser *p, const uint8_t *bytes, size_t size, size_t *used,
	struct eco_error *e)
{
	bool in_header = p->frame.size < ECO_FRAME_HEADER_BYTES;
	size_t whole = ECO_FRAME_HEADER_BYTES + (in_header ? 0 : (size_t)p->payload_size),
		missing = whole - p->frame.size;
	if (p->last_type == ECO_FRAME_END)
		return BAD("%zu bytes follow the end of the stream", size);
	*used = size < missing ? size : missing;
	eco_write_bytes(&p->frame, bytes, *used);
	if (p->frame.failed)
		return eco_fail(e, ECO_NO_MEMORY, "no memory for %u bytes", p->payload_size);
	if (p->frame.size < whole)
		return ECO_OK;
	enum eco_code code = in_header ? check_header(p, e) : ECO_OK;
	return code || (in_header && p->payload_size) ? code : read_frame(p, e);
}

static enum eco_code fail_for_good(struct eco_wire_parser *p, enum eco_code code,
	const struct eco_error *cause, struct eco_error *error)
{
	const char *name = p->frame.size >= ECO_FRAME_HEADER_BYTES ? eco_frame_name(p->frame.bytes[0]) : NULL;
	/* a callback may fail without a text */
	eco_fail(&p->failure, code, "stream, frame %u%s%s%s at byte %llu: %s", p->number, name ? " (" : "",
		name ? name : "", name ? ")" : "", (unsigned long long)p->offset, cause->code ? cause->text
		: eco_code_name(code));
	return eco_fail(error, code, "%s", p->failure.text);
}

enum eco_code eco_wire_feed(struct eco_wire_parser *p, const uint8_t *bytes, size_t size,
	struct eco_error *error)
{
	if (p->failure.code)
		return eco_fail(error, p->failure.code, "%s", p->failure.text);
	while (size) {
		struct eco_error cause = { 0 };
		size_t used = 0;
		enum eco_code code = feed_some(p, bytes, size, &used, &cause);
		if (code)
			return fail_for_good(p, code, &cause, error);
		bytes += used;
		size -= used;
	}
	return ECO_OK;
}

enum eco_code eco_wire_finish(struct eco_wire_parser *p, struct eco_error *error)
{
	if (p->failure.code)
		return eco_fail(error, p->failure.code, "%s", p->failure.text);
	if (p->last_type == ECO_FRAME_END)
		return ECO_OK;
	struct eco_error cause = { 0 };
	enum eco_code code = eco_fail(&cause, ECO_DAMAGED, "the stream ends here, without an end frame: it "
		"was cut off");
	return fail_for_good(p, code, &cause, error);
}

enum eco_code eco_wire_parser_new(struct eco_wire_parser **parser, const struct eco_wire_events *events,
	void *ctx, struct eco_error *error)
{
	struct eco_wire_parser *p = calloc(1, sizeof *p);
	*parser = p;
	if (!p)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a stream parser");
	p->events = *events;
	p->ctx = ctx;
	p->last_list = p->last_ordinal = ECO_NONE;
	eco_wire_items_start(&p->items);
	return ECO_OK;
}

void eco_wire_parser_free(struct eco_wire_parser *p)
{
	if (!p)
		return;
	eco_writer_free(&p->frame);
	free(p->palette);
	free(p->groups);
	free(p);
}
