#include "tests/support/serve/stream_reader.h"

void stream_reader_init(struct stream_reader *r, const struct eco_scene *truth)
{
	*r = (struct stream_reader){ .truth = truth };
	r->have = calloc(truth->list_count + 1, sizeof *r->have);
	r->knows_list = calloc(truth->list_count + 1, sizeof *r->knows_list);
	r->knows_plant = calloc(truth->plant_count + 1, sizeof *r->knows_plant);
}

void stream_reader_free(struct stream_reader *r)
{
	free(r->have);
	free(r->knows_list);
	free(r->knows_plant);
}

static enum eco_code reader_plant(void *ctx, uint32_t id, const struct eco_plant *plant,
	const struct eco_anchor *anchors, struct eco_error *e)
{
	struct stream_reader *r = ctx;
	const struct eco_plant *truth = &r->truth->plants[id];
	if (plant->anchor_first != truth->anchor_first || plant->anchor_count != truth->anchor_count
		|| memcmp(anchors, r->truth->anchors + truth->anchor_first,
		truth->anchor_count * sizeof *anchors) != 0)
		return eco_fail(e, ECO_DAMAGED, "plant %u is not what the pack has", id);
	r->knows_plant[id] = true;
	r->plants++;
	return ECO_OK;
}

static enum eco_code reader_list(void *ctx, uint32_t id, const struct eco_list *list,
	const uint8_t (*palette)[3], const struct eco_group *groups, struct eco_error *e)
{
	struct stream_reader *r = ctx;
	const struct eco_group *truth = list->group_count ? eco_list_groups(r->truth, id) : NULL;
	(void)palette;
	if (r->knows_list[id])
		return eco_fail(e, ECO_DAMAGED, "list %u is described twice", id);
	if (list->kind != r->truth->lists[id].kind || list->chunk_count != r->truth->lists[id].chunk_count)
		return eco_fail(e, ECO_DAMAGED, "list %u is not what the pack has", id);
	for (uint32_t g = 0; g < list->group_count; g++)
		if (groups[g].plant != truth[g].plant || groups[g].first != truth[g].first
				|| groups[g].count != truth[g].count)
			return eco_fail(e, ECO_DAMAGED, "group %u of list %u is not the pack's", g, id);
	r->knows_list[id] = true;
	r->lists++;
	return ECO_OK;
}

static enum eco_code reader_chunk(void *ctx, uint32_t list, uint32_t ordinal, const struct eco_chunk *chunk,
	const uint8_t *payload, struct eco_error *e)
{
	struct stream_reader *r = ctx;
	(void)payload;
	if (!r->knows_list[list])
		return eco_fail(e, ECO_DAMAGED, "a chunk of list %u before its description", list);
	if (ordinal != r->have[list])
		return eco_fail(e, ECO_DAMAGED, "chunk %u of list %u, of which %u are held", ordinal, list,
			r->have[list]);
	if (chunk->size_bytes != r->truth->chunks[r->truth->lists[list].chunk_first + ordinal].size_bytes)
		return eco_fail(e, ECO_DAMAGED, "chunk %u of list %u is not what the pack has", ordinal,
			list);
	r->have[list]++;
	r->chunks++;
	return ECO_OK;
}

static enum eco_code reader_needs(struct stream_reader *r, const struct eco_plan *plan, struct eco_error *e)
{
	struct eco_holdings needs;
	enum eco_code code = lod_plan_needs(r->truth, plan, &needs, e);
	for (uint32_t i = 0; !code && i < needs.count; i++) {
		uint32_t id = needs.items[i].list;
		const struct eco_list *list = &r->truth->lists[id];
		uint32_t plant = list->kind == ECO_LIST_INSTANCES || list->attributes & ECO_ATTR_PLANT
			? ECO_NONE : list->owner;
		if (needs.items[i].chunks > r->have[id])
			code = eco_fail(e, ECO_DAMAGED, "the plan needs %u chunks of list %u, %u are held",
				needs.items[i].chunks, id, r->have[id]);
		else if (list->kind != ECO_LIST_GROUND && plant != ECO_NONE && !r->knows_plant[plant])
			code = eco_fail(e, ECO_DAMAGED, "the plan draws list %u of an unknown plant", id);
		for (uint32_t g = 0; !code && g < list->group_count; g++)
			if (!r->knows_plant[eco_list_groups(r->truth, id)[g].plant])
				code = eco_fail(e, ECO_DAMAGED, "the plan draws unknown plants of list %u",
					id);
	}
	free(needs.items);
	return code;
}

static enum eco_code reader_plan(void *ctx, struct eco_plan *plan, struct eco_error *e)
{
	struct stream_reader *r = ctx;
	enum eco_code code = reader_needs(r, plan, e);
	if (!code && plan->vertices > r->budget_vertices)
		code = eco_fail(e, ECO_DAMAGED, "the plan draws %llu of %llu vertices",
			(unsigned long long)plan->vertices, (unsigned long long)r->budget_vertices);
	r->vertices = plan->vertices;
	r->plans++;
	eco_plan_free(plan);
	return code;
}

static enum eco_code reader_end(void *ctx, uint64_t vertices, struct eco_error *e)
{
	struct stream_reader *r = ctx;
	r->ended = true;
	return vertices == r->vertices ? ECO_OK : eco_fail(e, ECO_DAMAGED, "END is not of the last plan");
}

enum eco_code stream_reader_read(struct stream_reader *r, const void *bytes, size_t size,
	uint64_t budget_vertices, struct eco_error *error)
{
	static const struct eco_wire_events events = { .plant = reader_plant, .list = reader_list,
		.chunk = reader_chunk,
		.plan = reader_plan, .end = reader_end };
	struct eco_wire_parser *parser;
	r->plans = r->chunks = r->lists = r->plants = 0;
	r->ended = false;
	r->budget_vertices = budget_vertices;
	enum eco_code code = eco_wire_parser_new(&parser, &events, r, error);
	if (code)
		return code;
	code = eco_wire_feed(parser, bytes, size, error);
	if (!code)
		code = eco_wire_finish(parser, error);
	eco_wire_parser_free(parser);
	return code;
}

struct eco_writer stream_reader_holdings(const struct stream_reader *r)
{
	struct eco_holdings holdings = { .items = calloc(r->truth->list_count + 1, sizeof *holdings.items) };
	struct eco_writer w = { 0 };
	for (uint32_t i = 0; i < r->truth->list_count; i++)
		if (r->have[i])
			holdings.items[holdings.count++] = (struct eco_holding){ i, r->have[i] };
	eco_wire_write_holdings(&w, &holdings);
	free(holdings.items);
	return w;
}
