#include "tests/support/wire_random.h"

#include <assert.h>
#include <math.h>

#include "ecofiles/format/pack_record.h"
#include "tests/support/unit_test.h"

/* The order in which C evaluates operands and initialisers is open: below, no expression draws twice. */
static uint64_t wire_random_bits(struct wire_random *r)
{
	return eco_random_next(&r->state);
}

uint32_t wire_random_below(struct wire_random *r, uint32_t n)
{
	return (uint32_t)(wire_random_bits(r) % n);
}

uint32_t wire_random_size(struct wire_random *r, uint32_t most)
{
	uint32_t shift = wire_random_below(r, 32), v = (uint32_t)wire_random_bits(r) >> shift;
	return most == UINT32_MAX ? v : v % (most + 1);
}

static float wire_random_scale(struct wire_random *r)
{
	float s = (float)(wire_random_below(r, 1u << 20) + 1) / 1024;
	switch (wire_random_below(r, 5)) {
	case 0:
		return 1;
	case 1:
		return s;
	case 2:
		return 0;
	default:
		return eco_wire_scale_round(s);
	}
}

static struct eco_cut wire_random_cut(struct wire_random *r, const struct eco_cut *before,
	uint32_t placements, uint32_t lists, bool summary)
{
	struct eco_cut cut = { .list = wire_random_below(r, lists) };
	cut.anchor = wire_random_size(r, ECO_NONE - 1);
	cut.scale = wire_random_scale(r);
	if (before && wire_random_below(r, 3))
		cut.list = before->list;
	if (before && before->anchor != ECO_NONE && wire_random_below(r, 3))
		cut.anchor = before->anchor;
	cut.end = wire_random_size(r, UINT32_MAX);
	cut.end += cut.end == 0;
	cut.first = wire_random_below(r, 3) ? 0 : wire_random_below(r, cut.end);
	if (before && wire_random_below(r, 4) == 0 && before->first < cut.end)
		cut.first = before->first;
	cut.band_first = (uint8_t)wire_random_below(r, ECO_BANDS);
	cut.band_end = (uint8_t)(cut.band_first + 1 + wire_random_below(r, ECO_BANDS - cut.band_first));
	if (before && before->band_end < ECO_BANDS && wire_random_below(r, 2)) {
		cut.band_first = before->band_end;
		cut.band_end = (uint8_t)(before->band_end + 1);
	}
	cut.share_end = ECO_SHARE_ONE;
	if (wire_random_below(r, 3) == 0) {
		cut.share_first = wire_random_below(r, ECO_SHARE_ONE);
		cut.share_end = cut.share_first + 1 + wire_random_below(r, ECO_SHARE_ONE - cut.share_first);
	}
	if (summary) {
		cut.anchor = ECO_NONE;
		cut.placement = wire_random_below(r, placements);
		cut.band_first = 0;
		cut.band_end = ECO_BANDS;
		cut.share_first = 0;
		cut.share_end = ECO_SHARE_ONE;
		cut.halvings = (uint8_t)wire_random_below(r, ECO_HALVINGS_MAX + 1);
	}
	return cut;
}

static struct eco_placement wire_random_placement(struct wire_random *r)
{
	struct eco_placement p = { .scale = 1 };
	for (int i = 0; i < 3; i++) {
		double v = (double)(int64_t)wire_random_bits(r) / 9223372036854775808.0;
		switch (wire_random_below(r, 4)) {
		case 0:
			p.at[i] = 0;
			break;
		case 1:
			p.at[i] = (double)(int32_t)wire_random_size(r, UINT32_MAX) / 1000.0;
			break;
		case 2:
			p.at[i] = v * 1e12;
			break;
		default:
			p.at[i] = v * 1000;
		}
	}
	p.turn = wire_random_below(r, 2) ? (uint16_t)wire_random_bits(r) : 0;
	p.path = wire_random_below(r, 2) ? (uint32_t)wire_random_bits(r) : 0;
	p.scale = wire_random_below(r, 2) ? 1 : wire_random_below(r, 2) ? 0.75f : 1.1;
	return p;
}

static bool same_cut(const struct eco_cut *a, const struct eco_cut *b)
{
	return a->list == b->list && a->first == b->first && a->end == b->end && a->scale == b->scale
		&& a->placement == b->placement && a->anchor == b->anchor && a->band_first == b->band_first
		&& a->band_end == b->band_end && a->share_first == b->share_first
		&& a->share_end == b->share_end && a->halvings == b->halvings;
}

void assert_same_plan(const struct eco_plan *a, const struct eco_plan *b)
{
	assert_true(a->vertices == b->vertices);
	assert_memory_equal(&a->prediction, &b->prediction, sizeof a->prediction);
	assert_true(a->m16 == b->m16);
	assert_true(a->placement_count == b->placement_count && a->run_count == b->run_count);
	assert_true(a->gate_count == b->gate_count && a->cut_count == b->cut_count);
	for (uint32_t i = 0; i < a->placement_count; i++) {
		const struct eco_placement *p = &a->placements[i], *q = &b->placements[i];
		assert_memory_equal(p->at, q->at, sizeof p->at);
		assert_true(p->turn == q->turn && p->scale == q->scale && p->path == q->path);
	}
	for (uint32_t i = 0; i < a->run_count; i++)
		assert_memory_equal(&a->runs[i], &b->runs[i], sizeof *a->runs);
	for (uint32_t i = 0; i < a->gate_count; i++)
		assert_true(a->gates[i].plant == b->gates[i].plant && a->gates[i].end == b->gates[i].end);
	for (uint32_t i = 0; i < a->cut_count; i++)
		assert_true(same_cut(&a->cuts[i], &b->cuts[i]));
}

/* Removes identical cuts, overlapping runs and second gates, which sorting leaves. */
static void wire_random_prune(struct eco_plan *plan)
{
	uint32_t kept = 0;
	for (uint32_t i = 0; i < plan->run_count; i++)
		if (!kept || plan->runs[i].placement != plan->runs[kept - 1].placement ||
			plan->runs[i].list_first >= plan->runs[kept - 1].list_end)
			plan->runs[kept++] = plan->runs[i];
	plan->run_count = kept;
	kept = 0;
	for (uint32_t i = 0; i < plan->gate_count; i++)
		if (!kept || plan->gates[i].plant != plan->gates[kept - 1].plant)
			plan->gates[kept++] = plan->gates[i];
	plan->gate_count = kept;
	kept = 0;
	for (uint32_t i = 0; i < plan->cut_count; i++)
		if (!kept || !same_cut(&plan->cuts[i], &plan->cuts[kept - 1]))
			plan->cuts[kept++] = plan->cuts[i];
	plan->cut_count = kept;
}

struct eco_plan wire_random_plan(struct wire_random *r, uint32_t most, uint32_t lists, uint32_t plants)
{
	struct eco_plan plan = { .vertices = wire_random_bits(r) >> 1, .prediction = { 33333.3125, 12, 0 },
		.m16 = wire_random_below(r, 9000) / 1000.0 };
	plan.vertices >>= wire_random_below(r, 63);
	plan.placement_count = 1 + wire_random_below(r, most);
	plan.run_count = wire_random_below(r, most + 1);
	plan.gate_count = wire_random_below(r, most + 1);
	plan.cut_count = wire_random_below(r, most + 1);
	plan.placements = calloc(most + 1, sizeof *plan.placements);
	plan.runs = calloc(most + 1, sizeof *plan.runs);
	plan.gates = calloc(most + 1, sizeof *plan.gates);
	plan.cuts = calloc(most + 1, sizeof *plan.cuts);
	for (uint32_t i = 0; i < plan.placement_count; i++)
		plan.placements[i] = i ? wire_random_placement(r) : (struct eco_placement){ .scale = 1 };
	for (uint32_t i = 0; i < plan.run_count; i++) {
		uint32_t first = wire_random_below(r, lists),
			placement = wire_random_below(r, plan.placement_count);
		plan.runs[i] = (struct eco_run){ placement, first,
			first + 1 + wire_random_size(r, lists - first - 1), wire_random_below(r, 3) ? 0
			: wire_random_below(r, ECO_SHARE_ONE) };
	}
	for (uint32_t i = 0; i < plan.gate_count; i++) {
		plan.gates[i].plant = wire_random_below(r, plants);
		plan.gates[i].end = wire_random_below(r, ECO_BANDS + 1) * ECO_SHARE_ONE;
		if (plan.gates[i].end < ECO_GATE_OPEN && wire_random_below(r, 2))
			plan.gates[i].end += wire_random_below(r, ECO_SHARE_ONE);
	}
	uint32_t summaries = wire_random_below(r, plan.cut_count + 1);
	for (uint32_t i = 0; i < plan.cut_count; i++)
		plan.cuts[i] = wire_random_cut(r, i ? &plan.cuts[i - 1] : NULL, plan.placement_count, lists,
			i < summaries);
	eco_plan_sort(&plan);
	wire_random_prune(&plan);
	return plan;
}

void wire_put_scene(struct eco_writer *w, uint32_t *number, uint32_t version)
{
	struct eco_scene scene = { .name = "Wäldchen", .needs = ECO_NEED_POINTS | ECO_NEED_GROUND,
		.ground_columns = 80, .ground_rows = 60, .ground_margin = 7, .near_m = 0.1,
		.plant_count = WIRE_RANDOM_PLANTS, .list_count = WIRE_RANDOM_LISTS };
	struct eco_chunk_id id = { { 1, 2, 3 } };
	eco_wire_items_start(&wire_items);
	struct eco_frame_mark mark = eco_frame_begin(w, ECO_FRAME_SCENE, (*number)++);
	size_t at = w->size;
	eco_wire_write_scene(w, &scene, &id);
	if (!w->failed)
		w->bytes[at] = (uint8_t)version;
	eco_frame_end(w, mark);
}

struct eco_frame_mark wire_bundle_begin(struct eco_writer *w, uint32_t *number,
	struct eco_wire_bundle *bundle)
{
	*bundle = (struct eco_wire_bundle){ .items = NULL };
	eco_wire_bundle_begin(bundle, &wire_items);
	return eco_frame_begin(w, ECO_FRAME_BUNDLE, (*number)++);
}

void wire_bundle_end(struct eco_writer *w, struct eco_frame_mark mark, struct eco_wire_bundle *bundle,
	const void *payload, size_t size)
{
	eco_wire_bundle_end(bundle, w);
	eco_write_bytes(w, payload, size);
	eco_frame_end(w, mark);
	eco_wire_bundle_free(bundle);
}

void wire_put_plant(struct eco_writer *w, uint32_t *number, uint32_t plant, const struct eco_anchor *anchors,
	uint32_t anchor_count)
{
	struct eco_plant plants[WIRE_RANDOM_PLANTS] = { { .name = "oak", .height_m = 18 },
		{ .name = "ash", .height_m = 11.5f } };
	struct eco_scene scene = { .plants = plants, .plant_count = WIRE_RANDOM_PLANTS, .anchors = anchors,
		.anchor_count = anchor_count };
	plants[plant].anchor_count = anchor_count;
	struct eco_wire_bundle bundle;
	struct eco_frame_mark mark = wire_bundle_begin(w, number, &bundle);
	for (int cells = 0; cells < (anchor_count > 1 ? 2 : 1); cells++)
		eco_wire_bundle_plant(&bundle, &scene, plant, cells);
	wire_bundle_end(w, mark, &bundle, NULL, 0);
}

struct eco_list wire_random_list(uint32_t id)
{
	static const uint8_t kinds[WIRE_RANDOM_LISTS] = { ECO_LIST_TRIANGLES, ECO_LIST_POINTS, ECO_LIST_LINES,
		ECO_LIST_INSTANCES, ECO_LIST_IMAGE, ECO_LIST_GROUND };
	static const uint8_t coders[WIRE_RANDOM_LISTS] = { ECO_CODER_ELEMENTS, ECO_CODER_FORM,
		ECO_CODER_ELEMENTS, ECO_CODER_ROWS, ECO_CODER_BYTES, ECO_CODER_ROWS };
	static const uint8_t attributes[WIRE_RANDOM_LISTS] = { ECO_ATTR_COLOR | ECO_ATTR_GROWTH,
		ECO_ATTR_COLOR | ECO_ATTR_SIZE, ECO_ATTR_COLOR, ECO_ATTR_PLACE };
	return (struct eco_list){ .kind = kinds[id], .coder = coders[id], .attributes = attributes[id],
		.group_count = id == 3 ? 2 : 0, .owner = id == 5 ? ECO_NONE : 0,
		.grid_step = { 1e-3, 1e-3, 1e-3 }, .unit_area = 0.01f, .palette_count = id < 3 ? 2 : 0,
		.image = ECO_NONE,
		.partner = id == 1 ? 0 : ECO_NONE, .columns = id == 5 ? 8 : 0, .primitive_count = id == 4 ? 8
		: id == 1 ? 900 : 1000, .element_count = id == 4 ? 8 : 900, .chunk_count = id == 4 ? 8 : 9 };
}

struct eco_wire_items wire_items;

static void wire_put_list(struct eco_writer *w, uint32_t *number, uint32_t id, const struct eco_list *list)
{
	static const uint8_t palette[2][3] = { { 10, 100, 20 }, { 90, 80, 30 } };
	struct eco_list lists[WIRE_RANDOM_LISTS];
	static const struct eco_group groups[] = { { .list = 3, .plant = 1, .count = 600 },
		{ .list = 3, .plant = 0, .first = 600, .count = 400 } };
	static const struct eco_tile tile = { .group_count = 2 };
	struct eco_scene scene = { .lists = lists, .list_count = WIRE_RANDOM_LISTS, .palette = palette,
		.palette_count = 2, .tiles = &tile, .tile_count = 1, .groups = groups, .group_count = 2 };
	lists[id] = *list;
	struct eco_wire_bundle bundle;
	struct eco_frame_mark mark = wire_bundle_begin(w, number, &bundle);
	eco_wire_bundle_list(&bundle, &scene, id);
	wire_bundle_end(w, mark, &bundle, NULL, 0);
}

static void put_chunk(struct eco_writer *w, uint32_t *number, uint32_t list, uint32_t ordinal,
	const void *payload, size_t size, bool whole, bool named)
{
	struct eco_list lists[WIRE_RANDOM_LISTS] = { 0 };
	struct eco_chunk chunk = { .id = eco_chunk_hash(payload, size), .primitive_count = 100,
		.element_count = 90, .size_bytes = (uint32_t)size + !whole };
	struct eco_scene scene = { .lists = lists, .list_count = WIRE_RANDOM_LISTS, .chunks = &chunk };
	lists[list].chunk_first = 0u - ordinal;      /* the one chunk is number `ordinal` */
	lists[list].chunk_count = ordinal + 1;
	struct eco_wire_bundle bundle;
	struct eco_frame_mark mark = wire_bundle_begin(w, number, &bundle);
	eco_wire_bundle_chunk(&bundle, &scene, list, ordinal, named);
	wire_bundle_end(w, mark, &bundle, payload, named ? 0 : size);
}

void wire_put_chunk(struct eco_writer *w, uint32_t *number, uint32_t list, uint32_t ordinal,
	const void *payload, size_t size, bool whole)
{
	put_chunk(w, number, list, ordinal, payload, size, whole, false);
}

void wire_put_name(struct eco_writer *w, uint32_t *number, uint32_t list, uint32_t ordinal,
	const void *payload, size_t size)
{
	put_chunk(w, number, list, ordinal, payload, size, true, true);
}

void wire_put_plan(struct eco_writer *w, uint32_t *number, const struct eco_plan *plan)
{
	struct eco_frame_mark mark = eco_frame_begin(w, ECO_FRAME_PLAN, (*number)++);
	eco_wire_write_plan(w, plan);
	eco_frame_end(w, mark);
}

void wire_put_end(struct eco_writer *w, uint32_t *number, uint64_t vertices, int64_t bytes_off)
{
	struct eco_frame_mark mark = eco_frame_begin(w, ECO_FRAME_END, (*number)++);
	eco_wire_write_end(w, vertices, (uint64_t)((int64_t)mark.at + ECO_END_FRAME_BYTES + bytes_off));
	eco_frame_end(w, mark);
}

void wire_random_stream(struct wire_random *r, struct eco_writer *w, uint32_t steps)
{
	static const struct eco_anchor anchors[3] = { { { 0, 0, 9 }, 10 }, { { 1, 1, 12 }, 3 },
		{ { -1, 2, 14 }, 2.5f } };
	uint32_t number = 0, ordinals[WIRE_RANDOM_LISTS] = { 0 };
	uint64_t vertices = 0;
	wire_put_scene(w, &number, ECO_WIRE_VERSION);
	wire_put_plant(w, &number, 0, anchors, 3);
	wire_put_plant(w, &number, 1, anchors, 1);
	for (uint32_t i = 0; i < WIRE_RANDOM_LISTS; i++) {
		struct eco_list list = wire_random_list(i);
		wire_put_list(w, &number, i, &list);
	}
	for (uint32_t step = 0; step < steps; step++) {
		for (uint32_t n = wire_random_below(r, 4); n > 0; n--) {
			uint8_t payload[128];
			uint32_t list = wire_random_below(r, 4),
				size = 1 + wire_random_below(r, sizeof payload);
			for (uint32_t i = 0; i < size; i++)
				payload[i] = (uint8_t)wire_random_bits(r);
			wire_put_chunk(w, &number, list, ordinals[list]++, payload, size, true);
		}
		struct eco_plan plan = wire_random_plan(r, 4 + 2 * step, WIRE_RANDOM_LISTS,
			WIRE_RANDOM_PLANTS);
		wire_put_plan(w, &number, &plan);
		vertices = plan.vertices;
		eco_plan_free(&plan);
	}
	if (wire_random_below(r, 2)) {           /* for a next view */
		uint8_t payload[4] = { 1, 2, 3, (uint8_t)wire_random_bits(r) };
		wire_put_chunk(w, &number, 0, ordinals[0]++, payload, sizeof payload, true);
	}
	wire_put_end(w, &number, vertices, 0);
}

/* ---- Telling ---- */

static enum eco_code tell(struct wire_told *t, uint8_t what)
{
	eco_write_u8(&t->w, what);
	return ++t->events == t->fail_at ? ECO_INTERRUPTED : ECO_OK;
}

static enum eco_code on_scene(void *ctx, const struct eco_scene *scene, const struct eco_chunk_id *id,
	struct eco_error *e)
{
	struct wire_told *t = ctx;
	assert(memchr(scene->name, 0, sizeof scene->name) && scene->near_m > 0);
	assert(!scene->plants && !scene->lists && scene->root == ECO_NONE);
	eco_wire_write_scene(&t->w, scene, id);
	return tell(t, 1);
}

static enum eco_code on_plant(void *ctx, uint32_t id, const struct eco_plant *plant,
	const struct eco_anchor *anchors, uint32_t anchor_count, struct eco_error *e)
{
	struct wire_told *t = ctx;
	assert(memchr(plant->name, 0, sizeof plant->name));
	assert(anchor_count == 1 || anchor_count == plant->anchor_count);
	eco_write_u32(&t->w, id);
	eco_write_bytes(&t->w, plant->name, sizeof plant->name);
	for (uint32_t i = 0; i < anchor_count; i++) {
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
	assert(eco_plan_check(plan, NULL) == ECO_OK);
	eco_wire_write_plan(&t->w, plan);
	eco_plan_free(plan);
	return tell(t, 5);
}

static enum eco_code on_end(void *ctx, uint64_t vertices, struct eco_error *e)
{
	struct wire_told *t = ctx;
	eco_write_u64(&t->w, vertices);
	return tell(t, 6);
}

static enum eco_code on_fetch(void *ctx, const struct eco_chunk *chunk, const uint8_t **payload,
	struct eco_error *e)
{
	const struct wire_told *t = ctx;
	assert(!t->hosted || strlen(t->hosted) == chunk->size_bytes);
	*payload = (const uint8_t *)t->hosted;
	return ECO_OK;
}

static enum eco_code on_ahead(void *ctx, struct eco_error *e)
{
	return tell(ctx, 8);
}

const struct eco_wire_events wire_telling = { on_scene, on_plant, on_list, on_chunk, on_plan, on_end,
	on_fetch, on_ahead };

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
