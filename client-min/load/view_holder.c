#include "client-min/load/view_holder.h"

#include <stdlib.h>
#include <string.h>

#include "client-min/view_select.h"
#include "ecofiles/base/array_grow.h"

struct view_holder {
	struct view_holder_options options;
	struct view_store *store;                /* decodes; NULL: chunks are counted, as follows */
	struct eco_holding *lists;               /* in order of arrival */
	uint32_t count, room;
	struct view_table places;                /* of lists in `lists` */
	struct eco_chunk_id pack;
	bool has_pack;
	uint64_t vertices;                       /* of the last plan */
	struct view_holder_counts counts;        /* without those of the store */
};

enum eco_code view_holder_forget(struct view_holder *holder, struct eco_error *error)
{
	const struct view_holder_options *o = &holder->options;
	holder->counts = view_holder_counts(holder);
	view_store_free(holder->store);
	holder->store = NULL;
	view_table_free(&holder->places);
	holder->count = 0;
	holder->has_pack = false;
	holder->vertices = 0;
	enum eco_code code = o->decodes ? view_store_new(&holder->store, &(struct view_store_options){
		.planned = o->planned, .ctx = o->ctx }, error) : ECO_OK;
	if (holder->store)
		view_store_find_by(holder->store, o->find, o->ctx);
	return code;
}

enum eco_code view_holder_new(struct view_holder **out, const struct view_holder_options *options,
	struct eco_error *error)
{
	struct view_holder *holder = *out = calloc(1, sizeof *holder);
	if (!holder)
		return eco_no_memory(error, "a client");
	holder->options = *options;
	return view_holder_forget(holder, error);
}

void view_holder_free(struct view_holder *holder)
{
	if (!holder)
		return;
	view_store_free(holder->store);
	view_table_free(&holder->places);
	free(holder->lists);
	free(holder);
}

/* ---- A stream that is counted ---- */

static enum eco_code on_scene(void *ctx, const struct eco_scene *scene, const struct eco_chunk_id *pack,
	struct eco_error *error)
{
	struct view_holder *holder = ctx;
	(void)scene, (void)error;
	holder->pack = *pack;
	holder->has_pack = true;
	return ECO_OK;
}

static enum eco_code on_chunk(void *ctx, uint32_t list, uint32_t ordinal, const struct eco_chunk *chunk,
	const uint8_t *payload, struct eco_error *error)
{
	struct view_holder *holder = ctx;
	(void)chunk, (void)payload;
	uint32_t at = view_table_get(&holder->places, list);
	if (at == UINT32_MAX) {
		at = holder->count;
		if (!eco_array_grow(&holder->lists, &holder->room, at, sizeof *holder->lists)
				|| !view_table_put(&holder->places, list, at))
			return eco_no_memory(error, "a list that is held");
		holder->lists[holder->count++] = (struct eco_holding){ list, 0 };
	}
	struct eco_holding *held = &holder->lists[at];
	holder->counts.chunks++;
	holder->counts.chunks_twice += ordinal < held->chunks;
	if (ordinal > held->chunks)
		return eco_fail(error, ECO_DAMAGED, "chunk %u of list %u comes where chunk %u is the next",
			ordinal, list, held->chunks);
	held->chunks += ordinal == held->chunks;
	return ECO_OK;
}

static enum eco_code on_plan(void *ctx, struct eco_plan *plan, struct eco_error *error)
{
	struct view_holder *holder = ctx;
	double predicted_q = eco_predicted_q(&plan->prediction);
	(void)error;
	holder->vertices = plan->vertices;
	eco_plan_free(plan);
	holder->options.planned(holder->options.ctx, predicted_q);
	return ECO_OK;
}

static enum eco_code on_end(void *ctx, uint64_t vertices, struct eco_error *error)
{
	const struct view_holder *holder = ctx;
	return vertices == holder->vertices ? ECO_OK : eco_fail(error, ECO_DAMAGED,
		"the stream ends with %llu vertices, its plan has %llu", (unsigned long long)vertices,
		(unsigned long long)holder->vertices);
}

static enum eco_code on_fetch(void *ctx, const struct eco_chunk *chunk, const uint8_t **payload,
	struct eco_error *error)
{
	const struct view_holder *holder = ctx;
	return holder->options.find ? holder->options.find(holder->options.ctx, chunk, payload, error)
		: eco_fail(error, ECO_DAMAGED, "a chunk is named that was to be carried");
}

enum eco_code view_holder_begin(struct view_holder *holder, struct eco_wire_parser **parser,
	struct eco_error *error)
{
	static const struct eco_wire_events counts = { .scene = on_scene, .chunk = on_chunk, .plan = on_plan,
		.end = on_end, .fetch = on_fetch };
	holder->vertices = 0;
	if (!holder->store)
		return eco_wire_parser_new(parser, &counts, holder, error);
	view_store_begin(holder->store);
	return eco_wire_parser_new(parser, &view_store_events, holder->store, error);
}

/* ---- What there is ---- */

static int by_list(const void *a, const void *b)
{
	uint32_t x = ((const struct eco_holding *)a)->list, y = ((const struct eco_holding *)b)->list;
	return (x > y) - (x < y);
}

enum eco_code view_holder_holdings(const struct view_holder *holder, struct eco_holdings *holdings,
	struct eco_error *error)
{
	if (holder->store)
		return view_store_holdings(holder->store, holdings, error);
	*holdings = (struct eco_holdings){ malloc((holder->count + 1) * sizeof *holdings->items),
		holder->count };
	if (!holdings->items)
		return eco_no_memory(error, "a request");
	if (holder->count)
		memcpy(holdings->items, holder->lists, holder->count * sizeof *holdings->items);
	qsort(holdings->items, holdings->count, sizeof *holdings->items, by_list);
	return ECO_OK;
}

const struct eco_chunk_id *view_holder_pack(const struct view_holder *holder)
{
	return holder->store ? view_store_pack(holder->store) : holder->has_pack ? &holder->pack : NULL;
}

struct view_holder_counts view_holder_counts(const struct view_holder *holder)
{
	struct view_holder_counts counts = holder->counts;
	if (holder->store) {
		struct view_store_stats stats = view_store_stats(holder->store);
		counts.chunks += stats.chunks;
		counts.decoded += stats.chunks;
		counts.chunks_twice += stats.chunks_twice;
	}
	return counts;
}

enum eco_code view_holder_vertices(const struct view_holder *holder, const struct eco_view *view,
	uint64_t *vertices, struct eco_error *error)
{
	struct view_selection selection;
	struct lod_eye eye;
	*vertices = holder->vertices;
	if (!holder->store)
		return ECO_OK;
	lod_eye_make(&eye, view);
	enum eco_code code = view_select_make(&selection, holder->store, &eye, error);
	if (code)
		return code;
	*vertices = selection.vertices;
	view_select_free(&selection);
	return ECO_OK;
}
