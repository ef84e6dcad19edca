/* The stream parser. The first byte says what the rest is:
 *
 *   0   a stream as it is, mostly to shake the frame assembler
 *   1   frames without hashes, { u8 type, u16 length, payload }: here they get their hashes, lengths and
 *       chunk ids, so that a fuzzer
 *       reaches the readers behind them
 *   2   one PLAN payload
 *
 * A stream is fed whole and in portions of the second byte + 1, which must not make a difference. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/wire.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

struct seen { uint64_t events, sum; };

static enum eco_code saw(void *ctx, uint64_t what)
{
	struct seen *seen = ctx;
	seen->events++;
	seen->sum = (seen->sum ^ what) * 0x9E3779B97F4A7C15u;
	return ECO_OK;
}

static enum eco_code on_scene(void *ctx, const struct eco_scene *scene, const struct eco_chunk_id *id,
	struct eco_error *e)
{
	(void)e;
	assert(memchr(scene->name, 0, sizeof scene->name) && scene->near_m > 0);
	return saw(ctx, 1 + id->bytes[3]);
}

static enum eco_code on_plant(void *ctx, uint32_t id, const struct eco_plant *plant,
	const struct eco_anchor *anchors, struct eco_error *e)
{
	(void)e;
	assert(memchr(plant->name, 0, sizeof plant->name) && plant->anchor_count > 0);
	for (uint32_t i = 0; i < plant->anchor_count; i++)
		assert(isfinite(anchors[i].center[0]) && anchors[i].radius >= 0);
	return saw(ctx, id);
}

static enum eco_code on_list(void *ctx, uint32_t id, const struct eco_list *list, const uint8_t (*palette)[3],
	const struct eco_group *groups, struct eco_error *e)
{
	uint64_t sum = id, plants = 0;
	(void)e;
	for (uint32_t i = 0; i < list->palette_count; i++)
		sum += palette[i][0] + palette[i][1] + palette[i][2];
	for (uint32_t i = 0; i < list->group_count; plants += groups[i++].count) {
		assert(groups[i].first == plants && groups[i].count > 0);
		sum += groups[i].plant;
	}
	assert(!list->group_count || plants == list->primitive_count);
	return saw(ctx, sum);
}

static enum eco_code on_chunk(void *ctx, uint32_t list, uint32_t ordinal, const struct eco_chunk *chunk,
	const uint8_t *payload, struct eco_error *e)
{
	(void)e;
	assert(chunk->size_bytes > 0 && chunk->element_count <= ECO_CHUNK_ELEMENTS_MAX);
	return saw(ctx, list + ordinal + payload[0] + payload[chunk->size_bytes - 1]);
}

static enum eco_code on_plan(void *ctx, struct eco_plan *plan, struct eco_error *e)
{
	uint64_t vertices = plan->vertices;
	(void)e;
	assert(eco_plan_check(plan, NULL) == ECO_OK);
	eco_plan_free(plan);
	return saw(ctx, vertices);
}

static enum eco_code on_end(void *ctx, uint64_t vertices, struct eco_error *e)
{
	(void)e;
	return saw(ctx, vertices);
}

/* No host has it. */
static enum eco_code on_fetch(void *ctx, const struct eco_chunk *chunk, const uint8_t **payload,
	struct eco_error *e)
{
	(void)payload, (void)e;
	return saw(ctx, chunk->size_bytes);
}

static enum eco_code on_ahead(void *ctx, struct eco_error *e)
{
	(void)e;
	return saw(ctx, 2);
}

static enum eco_code parse(const uint8_t *bytes, size_t size, size_t portion, struct seen *seen)
{
	static const struct eco_wire_events events = { on_scene, on_plant, on_list, on_chunk, on_plan,
		on_end, on_fetch, on_ahead };
	struct eco_wire_parser *parser;
	struct eco_error error = { 0 };
	enum eco_code code = eco_wire_parser_new(&parser, &events, seen, &error);
	for (size_t at = 0; at < size && !code; at += portion)
		code = eco_wire_feed(parser, bytes + at, size - at < portion ? size - at : portion, &error);
	if (!code)
		code = eco_wire_finish(parser, &error);
	assert(code == error.code && (code == ECO_OK || error.text[0]));
	eco_wire_parser_free(parser);
	return code;
}

static void parse_twice(const uint8_t *bytes, size_t size, size_t portion)
{
	struct seen whole = { 0 }, parts = { 0 };
	enum eco_code code = parse(bytes, size, size ? size : 1, &whole);
	assert(parse(bytes, size, portion, &parts) == code);
	assert(whole.events == parts.events && whole.sum == parts.sum);
}

/* An END's byte count is right. */
static void mend(struct eco_writer *w, struct eco_frame_mark mark, uint8_t type)
{
	uint8_t *payload = w->bytes + mark.at + ECO_FRAME_HEADER_BYTES;
	size_t size = w->size - mark.at - ECO_FRAME_HEADER_BYTES;
	for (size_t i = 0; type == ECO_FRAME_END && size == 16 && i < 8; i++)
		payload[8 + i] = (uint8_t)((uint64_t)w->size >> (8 * i));
}

static void parse_frames(const uint8_t *bytes, size_t size, size_t portion)
{
	struct eco_reader r = { .bytes = bytes, .size = size };
	struct eco_writer w = { 0 };
	for (uint32_t number = 0; r.at < r.size && !r.failed; number++) {
		uint8_t type = eco_read_u8(&r);
		uint16_t length = eco_read_u16(&r);
		const uint8_t *payload = eco_read_bytes(&r, length);
		if (!payload || !eco_frame_name(type))
			break;
		struct eco_frame_mark mark = eco_frame_begin(&w, type, number);
		eco_write_bytes(&w, payload, length);
		if (w.failed)
			break;
		mend(&w, mark, type);
		eco_frame_end(&w, mark);
		if (w.failed)
			break;
	}
	if (!w.failed)
		parse_twice(w.bytes, w.size, portion);
	eco_writer_free(&w);
}

static void read_plan(const uint8_t *bytes, size_t size)
{
	struct eco_reader r = { .bytes = bytes, .size = size };
	struct eco_plan plan;
	if (eco_wire_read_plan(&r, &plan, NULL))
		return;
	struct eco_writer w = { 0 };
	eco_wire_write_plan(&w, &plan);
	assert(!w.failed && w.size == r.at && memcmp(w.bytes, bytes, w.size) == 0);
	eco_writer_free(&w);
	eco_plan_free(&plan);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	if (size < 2)
		return 0;
	if (bytes[0] == 0)
		parse_twice(bytes + 2, size - 2, bytes[1] + 1u);
	else if (bytes[0] == 1)
		parse_frames(bytes + 2, size - 2, bytes[1] + 1u);
	else
		read_plan(bytes + 1, size - 1);
	return 0;
}
