#include "tests/support/wire_told.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "ecofiles/base/random.h"
#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/pack_record.h"

static enum eco_code tell(struct wire_told *t, uint8_t what)
{
	eco_write_u8(&t->w, what);
	return ++t->events == t->fail_at ? ECO_INTERRUPTED : ECO_OK;
}

static enum eco_code on_scene(void *ctx, const struct eco_scene *scene, const struct eco_chunk_id *id,
	struct eco_error *e)
{
	struct wire_told *t = ctx;
	(void)e;
	assert(memchr(scene->name, 0, sizeof scene->name) && scene->near_m > 0);
	assert(!scene->plants && !scene->lists && scene->root == ECO_NONE);
	eco_wire_write_scene(&t->w, scene, id);
	return tell(t, 1);
}

static enum eco_code on_plant(void *ctx, uint32_t id, const struct eco_plant *plant,
	const struct eco_anchor *anchors, struct eco_error *e)
{
	struct wire_told *t = ctx;
	(void)e;
	assert(memchr(plant->name, 0, sizeof plant->name) && plant->anchor_count > 0);
	eco_write_u32(&t->w, id);
	eco_write_bytes(&t->w, plant->name, sizeof plant->name);
	for (uint32_t i = 0; i < plant->anchor_count; i++) {
		assert(isfinite(anchors[i].center[0]) && anchors[i].radius >= 0);
		eco_record_write(&t->w, ECO_SECTION_ANCHORS, &anchors[i]);
	}
	return tell(t, 2);
}

static enum eco_code on_list(void *ctx, uint32_t id, const struct eco_list *list, const uint8_t (*palette)[3],
	const struct eco_group *groups, struct eco_error *e)
{
	struct wire_told *t = ctx;
	uint64_t plants = 0;
	(void)e;
	eco_write_u32(&t->w, id);
	eco_record_write(&t->w, ECO_SECTION_LISTS, list);
	eco_write_bytes(&t->w, palette, 3 * (size_t)list->palette_count);
	for (uint32_t i = 0; i < list->group_count; plants += groups[i++].count) {
		assert(groups[i].first == plants && groups[i].count > 0);
		eco_record_write(&t->w, ECO_SECTION_GROUPS, &groups[i]);
	}
	assert(!list->group_count || plants == list->primitive_count);
	return tell(t, 3);
}

static enum eco_code on_chunk(void *ctx, uint32_t list, uint32_t ordinal, const struct eco_chunk *chunk,
	const uint8_t *payload, struct eco_error *e)
{
	struct wire_told *t = ctx;
	(void)e;
	assert(chunk->size_bytes > 0 && chunk->element_count <= ECO_CHUNK_ELEMENTS_MAX);
	eco_write_u32(&t->w, list);
	eco_write_u32(&t->w, ordinal);
	eco_write_u32(&t->w, chunk->primitive_count);
	eco_write_u32(&t->w, chunk->element_count);
	eco_write_bytes(&t->w, payload, chunk->size_bytes);
	return tell(t, 4);
}

static enum eco_code on_plan(void *ctx, struct eco_plan *plan, struct eco_error *e)
{
	struct wire_told *t = ctx;
	(void)e;
	assert(eco_plan_check(plan, NULL) == ECO_OK);
	eco_wire_write_plan(&t->w, plan);
	eco_plan_free(plan);
	return tell(t, 5);
}

static enum eco_code on_end(void *ctx, uint64_t vertices, struct eco_error *e)
{
	struct wire_told *t = ctx;
	(void)e;
	eco_write_u64(&t->w, vertices);
	return tell(t, 6);
}

static enum eco_code on_fetch(void *ctx, const struct eco_chunk *chunk, const uint8_t **payload,
	struct eco_error *e)
{
	const struct wire_told *t = ctx;
	(void)e;
	assert(!t->hosted || strlen(t->hosted) == chunk->size_bytes);
	*payload = (const uint8_t *)t->hosted;
	return ECO_OK;
}

static enum eco_code on_ahead(void *ctx, struct eco_error *e)
{
	(void)e;
	return tell(ctx, 8);
}

const struct eco_wire_events wire_telling = { on_scene, on_plant, on_list, on_chunk, on_plan, on_end, on_fetch,
	on_ahead };

enum eco_code wire_tell(const uint8_t *bytes, size_t size, size_t portion, struct wire_told *told,
	struct eco_error *error)
{
	struct eco_wire_parser *parser;
	uint64_t state = size + portion;
	enum eco_code code = eco_wire_parser_new(&parser, &wire_telling, told, error);
	for (size_t at = 0; at < size && !code;) {
		size_t n = portion ? portion : eco_random_next(&state) % 200;
		n = n < size - at ? n : size - at;
		code = eco_wire_feed(parser, bytes + at, n, error);
		at += n;
	}
	code = code ? code : eco_wire_finish(parser, error);
	eco_wire_parser_free(parser);
	return code;
}
