#include "client-min/load/view_holder.h"

#include <stdlib.h>
#include <string.h>

#include "client-min/view_select.h"
#include "client-min/view_table.h"
#include "ecofiles/base/array_grow.h"

struct view_holder {
	struct view_store *store;                /* decodes; NULL: chunks are counted */
	bool decodes;
	struct eco_holding *lists;               /* in order of arrival */
	uint32_t count, room;
	struct view_table places;                /* of lists in `lists` */
	struct eco_chunk_id pack;
	bool has_pack;
	uint64_t vertices;                       /* of the last plan */
	struct view_holder_counts counts;        /* without those of the store */
	view_store_find *find;
	void *find_ctx;
	view_holder_passed *passed;
	void *ctx;
};

static void keep_counts(struct view_holder *holder)
{
	holder->counts = view_holder_counts(holder);
	view_store_free(holder->store);
	holder->store = NULL;
}

enum eco_code view_holder_forget(struct view_holder *holder, struct eco_error *error)
{
	struct view_store_options options = { 0 };
	keep_counts(holder);
	view_table_free(&holder->places);
	holder->places = (struct view_table){ 0 };
	holder->count = 0;
	holder->has_pack = false;
	holder->vertices = 0;
	return holder->decodes ? view_store_new(&holder->store, &options, error) : ECO_OK;
}

enum eco_code view_holder_new(struct view_holder **out, bool decodes, struct eco_error *error)
{
	struct view_holder *holder = *out = calloc(1, sizeof *holder);
	if (!holder)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a client");
	holder->decodes = decodes;
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

void view_holder_begin(struct view_holder *holder, view_holder_passed *passed, void *ctx)
{
	holder->passed = passed;
	holder->ctx = ctx;
	holder->vertices = 0;
	if (holder->store)
		view_store_begin(holder->store);
}

void view_holder_find_by(struct view_holder *holder, view_store_find *find, void *ctx)
{
	holder->find = find;
	holder->find_ctx = ctx;
}

/* ---- A stream ---- */

static enum eco_code on_scene(void *ctx, const struct eco_scene *scene, const struct eco_chunk_id *pack_id,
	struct eco_error *error)
{
	struct view_holder *holder = ctx;
	holder->pack = *pack_id;
	holder->has_pack = true;
	return holder->store ? view_store_events.scene(holder->store, scene, pack_id, error) : ECO_OK;
}

static enum eco_code on_plant(void *ctx, uint32_t id, const struct eco_plant *plant,
	const struct eco_anchor *anchors, struct eco_error *error)
{
	struct view_holder *holder = ctx;
	return holder->store ? view_store_events.plant(holder->store, id, plant, anchors, error) : ECO_OK;
}

static enum eco_code on_list(void *ctx, uint32_t id, const struct eco_list *list,
	const uint8_t (*palette)[3], const struct eco_group *groups, struct eco_error *error)
{
	struct view_holder *holder = ctx;
	return holder->store ? view_store_events.list(holder->store, id, list, palette, groups, error)
		: ECO_OK;
}

static enum eco_code count_chunk(struct view_holder *holder, uint32_t list, uint32_t ordinal,
	struct eco_error *error)
{
	uint32_t at = view_table_get(&holder->places, list);
	if (at == UINT32_MAX) {
		at = holder->count;
		if (!eco_array_grow(&holder->lists, &holder->room, at, sizeof *holder->lists)
				|| !view_table_put(&holder->places, list, at))
			return eco_fail(error, ECO_NO_MEMORY, "no memory for a list that is held");
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

static enum eco_code on_chunk(void *ctx, uint32_t list, uint32_t ordinal, const struct eco_chunk *chunk,
	const uint8_t *payload, struct eco_error *error)
{
	struct view_holder *holder = ctx;
	return holder->store ? view_store_events.chunk(holder->store, list, ordinal, chunk, payload, error)
		: count_chunk(holder, list, ordinal, error);
}

static enum eco_code on_plan(void *ctx, struct eco_plan *plan, struct eco_error *error)
{
	struct view_holder *holder = ctx;
	double predicted_q = eco_predicted_q(&plan->prediction);
	enum eco_code code = ECO_OK;
	holder->vertices = plan->vertices;
	if (holder->store)
		code = view_store_events.plan(holder->store, plan, error);
	else
		eco_plan_free(plan);
	if (!code)
		holder->passed(holder->ctx, predicted_q);
	return code;
}

static enum eco_code on_end(void *ctx, uint64_t vertices, struct eco_error *error)
{
	struct view_holder *holder = ctx;
	if (holder->store)
		return view_store_events.end(holder->store, vertices, error);
	return vertices == holder->vertices ? ECO_OK : eco_fail(error, ECO_DAMAGED,
		"the stream ends with %llu vertices, its plan has %llu", (unsigned long long)vertices,
		(unsigned long long)holder->vertices);
}

static enum eco_code on_fetch(void *ctx, const struct eco_chunk *chunk, const uint8_t **payload,
	struct eco_error *error)
{
	struct view_holder *holder = ctx;
	return holder->find ? holder->find(holder->find_ctx, chunk, payload, error)
		: eco_fail(error, ECO_DAMAGED, "a chunk is named that was to be carried");
}

const struct eco_wire_events view_holder_events = { on_scene, on_plant, on_list, on_chunk, on_plan, on_end,
	on_fetch, NULL };

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
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a request");
	if (holder->count)
		memcpy(holdings->items, holder->lists, holder->count * sizeof *holdings->items);
	qsort(holdings->items, holdings->count, sizeof *holdings->items, by_list);
	return ECO_OK;
}

const struct eco_chunk_id *view_holder_pack(const struct view_holder *holder)
{
	return holder->has_pack ? &holder->pack : NULL;
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
