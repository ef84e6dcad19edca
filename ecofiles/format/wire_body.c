#define XXH_STATIC_LINKING_ONLY
#include <xxhash.h>

#include "ecofiles/format/wire_body.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"

#define BUNDLE_BYTES (32u << 10)  /* from which on a bundle is full: it is drawn once it is whole */

static void find_cells(struct eco_wire_body *body)
{
	const struct eco_scene *s = body->scene;
	for (uint32_t i = 0; i < s->ladder_count; i++) {
		const struct eco_ladder *l = &s->ladders[i];
		const uint32_t lists[] = { l->points, l->lines, l->simple, l->triangles, l->impostor };
		bool whole = l->anchor == s->plants[l->plant].anchor_first;
		for (size_t k = 0; k < sizeof lists / sizeof *lists && !whole; k++)
			if (lists[k] < s->list_count)
				body->of_cell[lists[k]] = true;
	}
}

enum eco_code eco_wire_body_init(struct eco_wire_body *body, const struct eco_scene *scene, const struct eco_pack *pack,
	const struct eco_holdings *holdings, uint64_t name_from, struct eco_error *error)
{
	*body = (struct eco_wire_body){ .scene = scene, .pack = pack, .name_from = name_from };
	body->have = malloc((scene->list_count + (size_t)1) * sizeof *body->have);
	body->known = malloc((scene->plant_count + (size_t)1) * sizeof *body->known);
	body->of_cell = calloc(scene->list_count + (size_t)1, sizeof *body->of_cell);
	if (!body->have || !body->known || !body->of_cell) {
		eco_wire_body_free(body);
		return eco_fail(error, ECO_NO_MEMORY, "no memory to follow %u lists", scene->list_count);
	}
	find_cells(body);
	eco_wire_body_restart(body, holdings);
	return ECO_OK;
}

void eco_wire_body_free(struct eco_wire_body *body)
{
	eco_free(body->have, body->known, body->of_cell, body->payloads);
	eco_writer_free(&body->frames);
	eco_wire_bundle_free(&body->bundle);
	*body = (struct eco_wire_body){ 0 };
}

/* The plant that a list is of, or ECO_NONE. */
static uint32_t plant_of(const struct eco_scene *scene, const struct eco_list *list)
{
	bool of_plant = list->kind != ECO_LIST_GROUND && list->kind != ECO_LIST_INSTANCES
		&& !(list->attributes & ECO_ATTR_PLANT);
	return of_plant && list->owner < scene->plant_count ? list->owner : ECO_NONE;
}

void eco_wire_body_restart(struct eco_wire_body *body, const struct eco_holdings *holdings)
{
	const struct eco_scene *scene = body->scene;
	memset(body->have, 0, scene->list_count * sizeof *body->have);
	memset(body->known, 0, scene->plant_count * sizeof *body->known);
	for (uint32_t i = 0; holdings && i < holdings->count; i++) {
		const struct eco_holding *item = &holdings->items[i];
		const struct eco_list *list = &scene->lists[item->list];
		body->have[item->list] = item->chunks;
		uint32_t plant = plant_of(scene, list);
		if (item->chunks && plant != ECO_NONE && body->known[plant] < 2)
			body->known[plant] = body->of_cell[item->list] ? 2 : 1;
	}
	eco_wire_items_start(&body->items);
	body->bundle_open = false;
	body->frames.size = 0;
	body->payload_count = body->number = 0;
	body->bytes = body->chunk_count = body->chunk_bytes = body->named_bytes = 0;
}

static struct eco_frame_mark begin(struct eco_wire_body *body, enum eco_frame_type type)
{
	if (!body->pack)
		body->frames.size = 0;
	return eco_frame_begin(&body->frames, type, body->number++);
}

static void end(struct eco_wire_body *body, struct eco_frame_mark mark)
{
	eco_frame_end(&body->frames, mark);
	body->bytes += body->frames.size - mark.at;
}

void eco_wire_body_scene(struct eco_wire_body *body)
{
	static const struct eco_chunk_id any;    /* of the same size */
	struct eco_frame_mark mark = begin(body, ECO_FRAME_SCENE);
	eco_wire_write_scene(&body->frames, body->scene, body->pack ? &body->pack->id : &any);
	end(body, mark);
}

void eco_wire_body_ahead(struct eco_wire_body *body)
{
	end(body, begin(body, ECO_FRAME_AHEAD));
}

void eco_wire_body_end(struct eco_wire_body *body, uint64_t vertices)
{
	struct eco_frame_mark mark = begin(body, ECO_FRAME_END);
	eco_wire_write_end(&body->frames, vertices, body->bytes - body->named_bytes + ECO_END_FRAME_BYTES);
	end(body, mark);
}

static void put(uint8_t *at, uint64_t value, int count)
{
	for (int i = 0; i < count; i++)
		at[i] = (uint8_t)(value >> 8 * i);
}

/* As eco_frame_end, for a bundle, whose payloads lie in the mapped pack and follow all that is written: what
 * wire.h says of length and hash, over all its parts. */
static void seal(struct eco_wire_body *body, struct eco_frame_mark mark)
{
	struct eco_writer *w = &body->frames;
	uint8_t *header = w->bytes + mark.at, number[4];
	size_t at = mark.at + ECO_FRAME_HEADER_BYTES;
	uint64_t size = w->size - at + body->bundle_bytes;
	if (size > ECO_FRAME_PAYLOAD_MAX) {
		w->failed = true;
		return;
	}
	put(header + 4, size, 4);
	put(number, mark.number, 4);
	XXH3_state_t state;
	XXH3_INITSTATE(&state);
	XXH3_64bits_reset(&state);
	XXH3_64bits_update(&state, header, 8);
	XXH3_64bits_update(&state, number, sizeof number);
	XXH3_64bits_update(&state, w->bytes + at, w->size - at);
	for (uint32_t i = body->bundle_payload; i < body->payload_count; i++) {
		body->payloads[i].at = w->size;
		if (body->payloads[i].bytes)     /* else the frame is not final */
			XXH3_64bits_update(&state, body->payloads[i].bytes, body->payloads[i].size);
	}
	put(header + 8, XXH3_64bits_digest(&state), 8);
}

static void end_bundle(struct eco_wire_body *body)
{
	if (!body->bundle_open)
		return;
	body->bundle_open = false;
	struct eco_frame_mark mark = begin(body, ECO_FRAME_BUNDLE);
	eco_wire_bundle_end(&body->bundle, &body->frames);
	body->bytes += body->frames.size - mark.at + body->bundle_bytes;
	if (body->pack && !body->frames.failed)
		seal(body, mark);
}

/* Opens a bundle where none is open or one is full. */
static void begin_item(struct eco_wire_body *body)
{
	if (body->bundle_open && body->bundle_bytes + body->bundle.directory.size >= BUNDLE_BYTES)
		end_bundle(body);
	if (body->bundle_open)
		return;
	eco_wire_bundle_begin(&body->bundle, &body->items);
	body->bundle_open = true;
	body->bundle_bytes = 0;
	body->bundle_payload = body->payload_count;
}

static void emit_chunk(struct eco_wire_body *body, uint32_t list, uint32_t ordinal)
{
	const struct eco_scene *scene = body->scene;
	uint32_t chunk = scene->lists[list].chunk_first + ordinal;
	size_t size = scene->chunks[chunk].size_bytes;
	bool named = body->name_from && size >= body->name_from;
	begin_item(body);
	eco_wire_bundle_chunk(&body->bundle, scene, list, ordinal, named);
	body->bundle_bytes += named ? 0 : size;
	body->chunk_count++;
	body->chunk_bytes += size;
	body->bytes += named ? size : 0;
	body->named_bytes += named ? size : 0;
	if (!body->pack || named)
		return;
	if (eco_array_grow(&body->payloads, &body->payload_capacity, body->payload_count, sizeof *body->payloads))
		body->payloads[body->payload_count++] = (struct eco_wire_payload){ 0, chunk,
			eco_pack_bytes(body->pack, chunk), size };
	else
		body->frames.failed = true;
}

static void emit_plant(struct eco_wire_body *body, uint32_t plant, bool cells)
{
	if (plant == ECO_NONE || body->known[plant] > cells)
		return;
	begin_item(body);
	eco_wire_bundle_plant(&body->bundle, body->scene, plant, cells);
	body->known[plant] = cells ? 2 : 1;
}

/* Plants whose records a client must know to use a list. */
static void emit_plants(struct eco_wire_body *body, uint32_t list)
{
	const struct eco_scene *scene = body->scene;
	const struct eco_list *l = &scene->lists[list];
	emit_plant(body, plant_of(scene, l), body->of_cell[list]);
	for (uint32_t i = 0; i < l->group_count; i++)
		emit_plant(body, eco_list_groups(scene, list)[i].plant, false);
}

static enum eco_code emit_list(struct eco_wire_body *body, uint32_t list, uint32_t chunks, struct eco_error *error)
{
	if (body->cancelled && atomic_load_explicit(body->cancelled, memory_order_relaxed))
		return eco_fail(error, ECO_INTERRUPTED, "the client closed the connection");
	if (body->have[list] == 0 && chunks > 0) {
		begin_item(body);
		eco_wire_bundle_list(&body->bundle, body->scene, list);
	}
	for (; body->have[list] < chunks; body->have[list]++)
		emit_chunk(body, list, body->have[list]);
	return ECO_OK;
}

/* Ground, coarse to fine as lists are numbered; then what others refer to: where things stand, and the images
 * that triangles are textured with; then what stands there. */
static int turn_of(const struct eco_list *list)
{
	if (list->kind == ECO_LIST_GROUND)
		return 0;
	return list->kind == ECO_LIST_INSTANCES || eco_list_has_texels(list) ? 1 : 2;
}

static enum eco_code check(const struct eco_wire_body *body, struct eco_error *error)
{
	return body->frames.failed ? eco_fail(error, ECO_NO_MEMORY, "no memory for the response's frames, or "
		"one of them beyond its limit") : ECO_OK;
}

enum eco_code eco_wire_body_needs(struct eco_wire_body *body, const struct eco_holdings *needs, struct eco_error *error)
{
	const struct eco_scene *scene = body->scene;
	/* those with cells first, so that none comes twice */
	for (uint32_t i = 0; i < 2 * needs->count; i++) {
		uint32_t list = needs->items[i % needs->count].list;
		if (body->of_cell[list] == (i < needs->count))
			emit_plants(body, list);
	}
	for (int round = 0; round < 3; round++)
		for (uint32_t i = 0; i < needs->count; i++) {
			const struct eco_holding *need = &needs->items[i];
			if (turn_of(&scene->lists[need->list]) != round)
				continue;
			ECO_PASS(emit_list(body, need->list, need->chunks, error));
		}
	end_bundle(body);
	return check(body, error);
}

enum eco_code eco_wire_body_step(struct eco_wire_body *body, const struct eco_plan *plan,
	const struct eco_holdings *needs, struct eco_error *error)
{
	ECO_PASS(eco_wire_body_needs(body, needs, error));
	struct eco_frame_mark mark = begin(body, ECO_FRAME_PLAN);
	eco_wire_write_plan(&body->frames, plan);
	end(body, mark);
	return check(body, error);
}

enum eco_code eco_wire_body_size(struct eco_wire_body *body, const struct eco_holdings *holdings,
	const struct eco_plan *plan, const struct eco_holdings *needs, uint64_t *bytes, struct eco_error *error)
{
	eco_wire_body_restart(body, holdings);
	eco_wire_body_scene(body);
	enum eco_code code = eco_wire_body_step(body, plan, needs, error);
	if (!code)
		eco_wire_body_end(body, plan->vertices);
	*bytes = body->bytes;
	return code;
}
