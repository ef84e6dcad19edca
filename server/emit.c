#define XXH_STATIC_LINKING_ONLY
#include <xxhash.h>

#include "server/emit.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"

#define BUNDLE_BYTES (32u << 10)  /* from which on a bundle is full: it is drawn once it is whole */

enum eco_code srv_emit_init(struct srv_emit *emit, const struct srv_scene *scene,
	const struct eco_holdings *holdings, uint64_t name_from, bool dry, struct eco_error *error)
{
	const struct eco_scene *tables = &scene->pack->scene;
	*emit = (struct srv_emit){ .scene = scene, .name_from = name_from, .dry = dry };
	emit->have = malloc((tables->list_count + (size_t)1) * sizeof *emit->have);
	emit->known = malloc((tables->plant_count + (size_t)1) * sizeof *emit->known);
	if (!emit->have || !emit->known) {
		srv_emit_free(emit);
		return eco_fail(error, ECO_NO_MEMORY, "no memory to follow %u lists", tables->list_count);
	}
	srv_emit_restart(emit, holdings);
	return ECO_OK;
}

void srv_emit_free(struct srv_emit *emit)
{
	free(emit->have);
	free(emit->known);
	free(emit->payloads);
	eco_writer_free(&emit->frames);
	eco_wire_bundle_free(&emit->bundle);
	*emit = (struct srv_emit){ 0 };
}

/* The plant that a list is of, or ECO_NONE. */
static uint32_t plant_of(const struct eco_scene *scene, const struct eco_list *list)
{
	bool of_plant = list->kind != ECO_LIST_GROUND && list->kind != ECO_LIST_INSTANCES
		&& !(list->attributes & ECO_ATTR_PLANT);
	return of_plant && list->owner < scene->plant_count ? list->owner : ECO_NONE;
}

void srv_emit_restart(struct srv_emit *emit, const struct eco_holdings *holdings)
{
	const struct eco_scene *scene = &emit->scene->pack->scene;
	memset(emit->have, 0, scene->list_count * sizeof *emit->have);
	memset(emit->known, 0, scene->plant_count * sizeof *emit->known);
	for (uint32_t i = 0; holdings && i < holdings->count; i++) {
		const struct eco_holding *item = &holdings->items[i];
		const struct eco_list *list = &scene->lists[item->list];
		emit->have[item->list] = item->chunks;
		uint32_t plant = plant_of(scene, list);
		if (item->chunks && plant != ECO_NONE)
			emit->known[plant] = true;
	}
	eco_wire_items_start(&emit->items);
	emit->bundle_open = false;
	emit->frames.size = 0;
	emit->payload_count = emit->number = 0;
	emit->bytes = emit->chunk_count = emit->chunk_bytes = emit->named_bytes = 0;
}

static struct eco_frame_mark begin(struct srv_emit *emit, enum eco_frame_type type)
{
	if (emit->dry)
		emit->frames.size = 0;
	return eco_frame_begin(&emit->frames, type, emit->number++);
}

static void end(struct srv_emit *emit, struct eco_frame_mark mark)
{
	eco_frame_end(&emit->frames, mark);
	emit->bytes += emit->frames.size - mark.at;
}

void srv_emit_scene(struct srv_emit *emit)
{
	struct eco_frame_mark mark = begin(emit, ECO_FRAME_SCENE);
	eco_wire_write_scene(&emit->frames, &emit->scene->pack->scene, &emit->scene->pack->id);
	end(emit, mark);
}

void srv_emit_ahead(struct srv_emit *emit)
{
	end(emit, begin(emit, ECO_FRAME_AHEAD));
}

void srv_emit_end(struct srv_emit *emit, uint64_t vertices)
{
	struct eco_frame_mark mark = begin(emit, ECO_FRAME_END);
	eco_wire_write_end(&emit->frames, vertices, emit->bytes - emit->named_bytes + ECO_END_FRAME_BYTES);
	end(emit, mark);
}

static void put(uint8_t *at, uint64_t value, int count)
{
	for (int i = 0; i < count; i++)
		at[i] = (uint8_t)(value >> 8 * i);
}

/* As eco_frame_end, for a bundle, whose payloads lie in the mapped pack and follow all that is written: what
 * wire.h says of length and hash, over all its parts. */
static void seal(struct srv_emit *emit, struct eco_frame_mark mark)
{
	struct eco_writer *w = &emit->frames;
	uint8_t *header = w->bytes + mark.at, number[4];
	size_t at = mark.at + ECO_FRAME_HEADER_BYTES;
	uint64_t size = w->size - at + emit->bundle_bytes;
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
	for (uint32_t i = emit->bundle_payload; i < emit->payload_count; i++) {
		emit->payloads[i].at = w->size;
		XXH3_64bits_update(&state, emit->payloads[i].bytes, emit->payloads[i].size);
	}
	put(header + 8, XXH3_64bits_digest(&state), 8);
}

static void end_bundle(struct srv_emit *emit)
{
	if (!emit->bundle_open)
		return;
	emit->bundle_open = false;
	struct eco_frame_mark mark = begin(emit, ECO_FRAME_BUNDLE);
	eco_wire_bundle_end(&emit->bundle, &emit->frames);
	emit->bytes += emit->frames.size - mark.at + emit->bundle_bytes;
	if (!emit->dry && !emit->frames.failed)
		seal(emit, mark);
}

/* Opens a bundle where none is open or one is full. */
static void begin_item(struct srv_emit *emit)
{
	if (emit->bundle_open && emit->bundle_bytes + emit->bundle.directory.size >= BUNDLE_BYTES)
		end_bundle(emit);
	if (emit->bundle_open)
		return;
	eco_wire_bundle_begin(&emit->bundle, &emit->items);
	emit->bundle_open = true;
	emit->bundle_bytes = 0;
	emit->bundle_payload = emit->payload_count;
}

static enum eco_code emit_chunk(struct srv_emit *emit, uint32_t list, uint32_t ordinal,
	struct eco_error *error)
{
	const struct eco_scene *scene = &emit->scene->pack->scene;
	uint32_t chunk = scene->lists[list].chunk_first + ordinal;
	size_t size = scene->chunks[chunk].size_bytes;
	bool named = emit->name_from && size >= emit->name_from;
	begin_item(emit);
	eco_wire_bundle_chunk(&emit->bundle, scene, list, ordinal, named);
	emit->bundle_bytes += named ? 0 : size;
	emit->chunk_count++;
	emit->chunk_bytes += size;
	emit->bytes += named ? size : 0;
	emit->named_bytes += named ? size : 0;
	if (emit->dry || named)
		return ECO_OK;
	const uint8_t *bytes;
	enum eco_code code = srv_scene_payload(emit->scene, chunk, &bytes, &size, error);
	if (code)
		return code;
	if (eco_array_grow(&emit->payloads, &emit->payload_capacity, emit->payload_count, sizeof *emit->payloads))
		emit->payloads[emit->payload_count++] = (struct srv_payload){ 0, bytes, size };
	else
		emit->frames.failed = true;
	return ECO_OK;
}

static void emit_plant(struct srv_emit *emit, uint32_t plant)
{
	if (plant == ECO_NONE || emit->known[plant])
		return;
	begin_item(emit);
	eco_wire_bundle_plant(&emit->bundle, &emit->scene->pack->scene, plant);
	emit->known[plant] = true;
}

/* Plants whose records a client must know to use a list. */
static void emit_plants(struct srv_emit *emit, uint32_t list)
{
	const struct eco_scene *scene = &emit->scene->pack->scene;
	const struct eco_list *l = &scene->lists[list];
	emit_plant(emit, plant_of(scene, l));
	for (uint32_t i = 0; i < l->group_count; i++)
		emit_plant(emit, eco_list_groups(scene, list)[i].plant);
}

static enum eco_code emit_list(struct srv_emit *emit, uint32_t list, uint32_t chunks, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	if (emit->cancelled && atomic_load_explicit(emit->cancelled, memory_order_relaxed))
		return eco_fail(error, ECO_INTERRUPTED, "the client closed the connection");
	if (emit->have[list] == 0 && chunks > 0) {
		begin_item(emit);
		eco_wire_bundle_list(&emit->bundle, &emit->scene->pack->scene, list);
	}
	for (; !code && emit->have[list] < chunks; emit->have[list]++)
		code = emit_chunk(emit, list, emit->have[list], error);
	return code;
}

/* Ground, coarse to fine as lists are numbered; then what others refer to: where things stand, and the images
 * that triangles are textured with; then what stands there. */
static int turn_of(const struct eco_list *list)
{
	if (list->kind == ECO_LIST_GROUND)
		return 0;
	return list->kind == ECO_LIST_INSTANCES || eco_list_has_texels(list) ? 1 : 2;
}

static enum eco_code check(const struct srv_emit *emit, struct eco_error *error)
{
	return emit->frames.failed ? eco_fail(error, ECO_NO_MEMORY, "no memory for the response's frames, or "
		"one of them beyond its limit") : ECO_OK;
}

enum eco_code srv_emit_needs(struct srv_emit *emit, const struct eco_holdings *needs, struct eco_error *error)
{
	const struct eco_scene *scene = &emit->scene->pack->scene;
	for (uint32_t i = 0; i < needs->count; i++)
		emit_plants(emit, needs->items[i].list);
	for (int round = 0; round < 3; round++)
		for (uint32_t i = 0; i < needs->count; i++) {
			const struct eco_holding *need = &needs->items[i];
			if (turn_of(&scene->lists[need->list]) != round)
				continue;
			enum eco_code code = emit_list(emit, need->list, need->chunks, error);
			if (code)
				return code;
		}
	end_bundle(emit);
	return check(emit, error);
}

enum eco_code srv_emit_step(struct srv_emit *emit, const struct eco_plan *plan,
	const struct eco_holdings *needs, struct eco_error *error)
{
	enum eco_code code = srv_emit_needs(emit, needs, error);
	if (code)
		return code;
	struct eco_frame_mark mark = begin(emit, ECO_FRAME_PLAN);
	eco_wire_write_plan(&emit->frames, plan);
	end(emit, mark);
	return check(emit, error);
}

enum eco_code srv_emit_take(struct srv_emit *emit, struct srv_body *body, struct eco_error *error)
{
	assert(!emit->dry);
	*body = (struct srv_body){ 0 };
	body->pieces = malloc((2 * (size_t)emit->payload_count + 1) * sizeof *body->pieces);
	if (!body->pieces || emit->frames.failed) {
		srv_body_free(body);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for the response's frames");
	}
	body->frames = emit->frames;
	emit->frames = (struct eco_writer){ 0 };
	size_t at = 0;
	for (uint32_t i = 0; i < emit->payload_count; i++) {
		const struct srv_payload *payload = &emit->payloads[i];
		if (payload->at > at)
			body->pieces[body->piece_count++] = (struct srv_piece){ body->frames.bytes + at,
				payload->at - at };
		body->pieces[body->piece_count++] = (struct srv_piece){ payload->bytes, payload->size };
		at = payload->at;
	}
	body->pieces[body->piece_count++] = (struct srv_piece){ body->frames.bytes + at,
		body->frames.size - at };
	body->size_bytes = emit->bytes - emit->named_bytes;
	return ECO_OK;
}
