/* Holdings are one number per list, as lists hold prefixes of their chunks; a plan of any later
 * frame is a set of ranges over that, and GPU copies are extended and never rewritten. Longer than 600 lines:
 * one structure, which every event of a stream changes.
 *
 * Within a limit of memory, chunks go while a stream comes (view_cache.h). The server counts on what it was
 * told before the stream began, so a plan may turn out to need what has gone meanwhile: then the same is
 * asked again, with what is held by then, and what that plan needs stays. Nothing else on the wire has to
 * change for it. */
#include "client-min/view_store.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "client-min/view_cache.h"
#include "ecofiles/base/array_grow.h"
#include "ecofiles/base/order.h"

#define MEMORY_MAX_DEFAULT ((uint64_t)8 << 30)
#define REPEATS_MAX 4u                   /* of one request; with a budget of bytes its plans may differ */
#define REPEATS_EASY 1u                  /* when so many were in vain, all else has gone */

#define BAD(...) eco_fail(error, ECO_DAMAGED, __VA_ARGS__)

struct view_store {
	struct view_store_options options;
	struct view_store_stats stats;
	struct eco_scene scene;          /* without its tables */
	struct eco_chunk_id pack;
	view_store_find *find;           /* of chunks that are named; NULL: none can be */
	void *find_ctx;
	bool has_scene, has_plan, ahead, complete;
	uint64_t evictions_planned;      /* when the last plan came, or was looked at since */
	uint64_t came_bytes, evicted_before;         /* decoded: of this stream; evicted before it */
	bool lacks;                      /* the last plan needs what is not held any more */
	uint32_t repeats;                /* of the request under way */
	struct view_cache cache;
	struct view_plant **plants;      uint32_t plant_count, plant_room;
	struct view_table plant_table;
	struct eco_plan plan;
	/* of a store that counts: chunks of lists, in order of arrival */
	struct eco_holding *counted;     uint32_t counted_count, counted_room;
	struct view_table counted_table;
};

double view_clock_ms(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec * 1e3 + (double)now.tv_nsec / 1e6;
}

enum eco_code view_store_new(struct view_store **out, const struct view_store_options *options,
	struct eco_error *error)
{
	struct view_store *store = calloc(1, sizeof *store);
	*out = store;
	if (!store)
		return eco_no_memory(error, "the client's store");
	store->options = *options;
	if (!store->options.memory_max)
		store->options.memory_max = MEMORY_MAX_DEFAULT;
	store->cache.memory_max = store->options.memory_max;
	return ECO_OK;
}

void view_store_free(struct view_store *store)
{
	if (!store)
		return;
	for (uint32_t i = 0; i < store->plant_count; i++) {
		free(store->plants[i]->anchors);
		free(store->plants[i]);
	}
	view_cache_free(&store->cache);
	view_table_free(&store->plant_table);
	eco_plan_free(&store->plan);
	view_table_free(&store->counted_table);
	eco_free(store->counted, store->plants, store);
}

static void forget_plan(struct view_store *store)
{
	eco_plan_free(&store->plan);
	store->plan = (struct eco_plan){ 0 };
	store->has_plan = store->ahead = store->complete = store->lacks = false;
}

void view_store_begin(struct view_store *store)
{
	struct view_cache *cache = &store->cache;
	forget_plan(store);
	store->repeats = 0;
	store->stats.decode_ms = 0;
	/* memory is short: room is made for as much as came the last time, else the server counts on chunks
	 * that go while the stream comes, and it is asked again */
	if (cache->evicted_bytes > store->evicted_before)
		view_cache_make_room(cache, store->came_bytes, false);
	store->evicted_before = cache->evicted_bytes;
	store->came_bytes = 0;
	view_cache_want_nothing(cache);
	view_cache_begin(cache);
}

static void notice_evictions(struct view_store *store);

/* Makes room for a description, which nothing comes without: all chunks may go for it. */
static enum eco_code describe(struct view_store *store, uint64_t bytes, struct eco_error *error)
{
	bool fits = view_cache_make_room(&store->cache, bytes, false)
		|| view_cache_make_room(&store->cache, bytes, true);
	notice_evictions(store);
	return fits ? ECO_OK : eco_fail(error, ECO_TOO_LARGE, "the descriptions of the plants and lists in "
		"view do not fit in %.3f MiB of memory: allow more (ecoview --memory), or ask for fewer vertices",
		(double)store->options.memory_max / (1 << 20));
}

/* ---- Events ---- */

static enum eco_code on_scene(void *ctx, const struct eco_scene *scene, const struct eco_chunk_id *pack,
	struct eco_error *error)
{
	struct view_store *store = ctx;
	if (store->has_scene && memcmp(&store->pack, pack, sizeof *pack) != 0)
		return BAD("the scene changed on the server since the first frame: start again");
	if (!(scene->near_m > 0))
		return BAD("the scene's near plane is not positive");
	store->has_scene = true;
	store->pack = *pack;
	store->scene = *scene;
	store->scene.name[sizeof scene->name - 1] = '\0';
	return ECO_OK;
}

static enum eco_code on_plant(void *ctx, uint32_t id, const struct eco_plant *plant,
	const struct eco_anchor *anchors, uint32_t anchor_count, struct eco_error *error)
{
	struct view_store *store = ctx;
	struct view_plant *known = (struct view_plant *)view_store_plant(store, id);
	if (store->options.counts || (known && known->anchor_count >= anchor_count))
		return ECO_OK;
	if (plant->anchor_count == 0 || plant->anchor_first > UINT32_MAX - plant->anchor_count)
		return BAD("plant %u has no anchors, or too many", id);
	size_t anchor_bytes = (size_t)anchor_count * sizeof *anchors,
		before = known ? sizeof *known + known->anchor_count * sizeof *anchors : 0,
		more = sizeof *known + anchor_bytes - before;
	ECO_PASS(describe(store, more, error));
	struct view_plant *copy = known ? known : calloc(1, sizeof *copy);
	struct eco_anchor *moved = copy ? realloc(copy->anchors, anchor_bytes) : NULL;
	if (moved) {
		copy->anchors = moved;
		memcpy(copy->anchors, anchors, anchor_bytes);
		copy->anchor_count = anchor_count;
		copy->plant = *plant;
		view_cache_charge_bytes(&store->cache, more);
	}
	if (moved && known)
		return ECO_OK;
	if (!moved || !eco_array_grow(&store->plants, &store->plant_room, store->plant_count,
			sizeof *store->plants) ||
		!view_table_put(&store->plant_table, id, store->plant_count)) {
		if (copy && !known) {
			free(copy->anchors);
			free(copy);
		}
		return eco_no_memory(error, "a plant");
	}
	store->plants[store->plant_count++] = copy;
	return ECO_OK;
}

/* A list that is held may be described once more, as a plant: the pack is the same, and so are they. */
static enum eco_code on_list(void *ctx, uint32_t id, const struct eco_list *list, const uint8_t (*palette)[3],
	const struct eco_group *groups, struct eco_error *error)
{
	struct view_store *store = ctx;
	if (store->options.counts || view_store_list(store, id))
		return ECO_OK;
	ECO_PASS(describe(store, view_list_bytes(list), error));
	struct view_list *copy = view_list_new(id, list, palette, groups);
	if (copy && view_cache_add(&store->cache, copy))
		return ECO_OK;
	view_list_free(copy);
	return eco_no_memory(error, "a list");
}

/* ---- Chunks ---- */

static enum eco_code check_chunk(struct view_store *store, const struct view_list *list, uint32_t ordinal,
	const struct eco_chunk *chunk, struct eco_error *error)
{
	if (ordinal < list->served) {
		store->stats.chunks_twice++;
		return BAD("chunk %u of list %u was sent again, though the client holds it", ordinal,
			list->id);
	}
	if (ordinal != list->served || ordinal >= list->list.chunk_count)
		return BAD("chunk %u of list %u came where chunk %u of %u was due",
			ordinal, list->id, list->served, list->list.chunk_count);
	struct view_mark before = view_list_before(list, ordinal);
	if (chunk->primitive_count > list->list.primitive_count - before.primitives ||
		chunk->element_count > list->list.element_count - before.elements)
		return BAD("chunk %u of list %u holds more than the list declares", ordinal, list->id);
	struct eco_error cause = { 0 };
	enum eco_code code = eco_chunk_check(&list->list, chunk, &cause);
	return code ? eco_fail(error, code, "list %u, chunk %u: %s", list->id, ordinal, cause.text) : ECO_OK;
}

/* A chunk that finds no room, or whose list has lost one before it, is not kept. */
static enum eco_code keep(struct view_store *store, struct view_list *list, uint32_t ordinal,
	const struct eco_chunk *chunk, struct view_piece *piece, struct eco_error *error)
{
	struct view_cache *cache = &store->cache;
	view_cache_touch(cache, list, ordinal);
	if (ordinal > list->chunk_count || !view_cache_make_room(cache, piece->bytes, false)
			|| ordinal > list->chunk_count) {
		view_list_mark(list, ordinal, chunk, piece->bytes);
		view_cache_remember(cache, list->id, ordinal);
		return ECO_OK;
	}
	uint64_t before = list->bytes;
	ECO_PASS(view_list_push(list, piece, chunk, error));
	view_cache_charge(cache, list, before);
	view_cache_touch(cache, list, ordinal + 1);
	return ECO_OK;
}

static void count_chunk(struct view_store *store, uint32_t list, uint32_t ordinal,
	const struct eco_chunk *chunk)
{
	store->stats.chunks++;
	store->stats.chunk_bytes += chunk->size_bytes;
	if (!view_cache_had(&store->cache, list, ordinal))
		return;
	store->stats.chunks_again++;
	store->stats.again_bytes += chunk->size_bytes;
}

static enum eco_code count_only(struct view_store *store, uint32_t id, uint32_t ordinal, struct eco_error *error)
{
	uint32_t at = view_table_get(&store->counted_table, id);
	if (at == UINT32_MAX) {
		at = store->counted_count;
		if (!eco_array_grow(&store->counted, &store->counted_room, at, sizeof *store->counted)
				|| !view_table_put(&store->counted_table, id, at))
			return eco_no_memory(error, "a list that is held");
		store->counted[store->counted_count++] = (struct eco_holding){ id, 0 };
	}
	struct eco_holding *held = &store->counted[at];
	store->stats.chunks++;
	store->stats.chunks_twice += ordinal < held->chunks;
	if (ordinal > held->chunks)
		return BAD("chunk %u of list %u comes where chunk %u is the next", ordinal, id, held->chunks);
	held->chunks += ordinal == held->chunks;
	return ECO_OK;
}

static enum eco_code on_chunk(void *ctx, uint32_t id, uint32_t ordinal, const struct eco_chunk *chunk,
	const uint8_t *payload, struct eco_error *error)
{
	struct view_store *store = ctx;
	struct view_list *list = view_cache_find(&store->cache, id);
	if (store->options.counts)
		return count_only(store, id, ordinal, error);
	if (!list)
		return BAD("chunk %u of list %u came before the list's description", ordinal, id);
	ECO_PASS(check_chunk(store, list, ordinal, chunk, error));
	struct view_piece piece;
	double start = view_clock_ms();
	enum eco_code code = view_piece_decode(&piece, &(struct view_piece_input){ list, chunk, ordinal, payload,
		store->options.images, &store->scene }, error);
	store->stats.decode_ms += view_clock_ms() - start;
	if (code)
		return code;
	store->came_bytes += piece.bytes;
	count_chunk(store, id, ordinal, chunk);
	code = keep(store, list, ordinal, chunk, &piece, error);
	view_piece_free(&piece);
	notice_evictions(store);
	if (!code)
		list->served++;
	return code;
}

/* ---- Plans ---- */

/* Chunks of a list that hold its first `end` primitives; the list is served so far. */
static uint32_t chunks_for(const struct view_list *list, uint32_t end)
{
	uint32_t low = 0, high = list->served;
	while (low < high) {                     /* the first chunk that ends at `end` or later */
		uint32_t middle = low + (high - low) / 2;
		if (list->marks[middle].primitives < end)
			low = middle + 1;
		else
			high = middle;
	}
	return end ? low + 1 : 0;
}

typedef void visit_need(struct view_store *store, struct view_list *list, uint32_t chunks);

/* Calls `visit` with all chunks that the store's plan needs, as lod_plan_needs names them; lists more than
 * once. */
static void each_need(struct view_store *store, visit_need *visit)
{
	const struct eco_plan *plan = &store->plan;
	const struct view_cache *cache = &store->cache;
	for (uint32_t i = 0; i < plan->cut_count; i++) {
		struct view_list *list = view_cache_find(cache, plan->cuts[i].list);
		visit(store, list, chunks_for(list, plan->cuts[i].end));
	}
	for (uint32_t i = 0; i < plan->run_count; i++)
		for (uint32_t id = plan->runs[i].list_first; id < plan->runs[i].list_end; id++) {
			struct view_list *list = view_cache_find(cache, id);
			if (!list)
				break;                   /* view_select_make says what is missing */
			visit(store, list, list->list.chunk_count);
		}
}

/* Chunks that came behind a plan may have taken the place of those that it needs: then it cannot be drawn. */
static void check_needs(struct view_store *store, struct view_list *list, uint32_t chunks)
{
	store->lacks |= list->chunk_count < chunks && list->served >= chunks;
}

static void notice_evictions(struct view_store *store)
{
	if (!store->has_plan || store->cache.evictions == store->evictions_planned)
		return;
	store->evictions_planned = store->cache.evictions;
	each_need(store, check_needs);
	store->has_plan = !store->lacks;
}

static void touch_need(struct view_store *store, struct view_list *list, uint32_t chunks)
{
	view_cache_touch(&store->cache, list, chunks);
	check_needs(store, list, chunks);
}

/* Without memory to say so, what is needed may go once more, and REPEATS_MAX ends that. */
static void want_need(struct view_store *store, struct view_list *list, uint32_t chunks)
{
	view_cache_want(&store->cache, list->id, chunks);
}

/* A plan that is sound in itself (eco_plan_check) may only name what was served: nothing that draws it needs
 * checks of its own. */
static enum eco_code check_plan(const struct view_store *store, const struct eco_plan *plan,
	struct eco_error *error)
{
	for (uint32_t i = 0; i < plan->cut_count; i++) {
		const struct eco_cut *cut = &plan->cuts[i];
		const struct view_list *list = view_store_list(store, cut->list);
		bool ground = list && list->list.kind == ECO_LIST_GROUND,
			texture = list && eco_list_has_texels(&list->list);
		if (!list || (!eco_list_vertices(&list->list) && !ground && !texture))
			return BAD("cut %u of the plan draws list %u, which %s", i,
				cut->list, list ? "is not drawable" : "was not sent");
		uint32_t held = view_list_before(list, list->served).primitives;
		if (cut->end > held)
			return BAD("cut %u of the plan draws [%u,%u) of list %u, "
				"of which %u are held", i, cut->first, cut->end, cut->list, held);
		if (cut->halvings && !(list->list.kind == ECO_LIST_POINTS
				&& list->list.attributes & ECO_ATTR_PLANT))
			return BAD("cut %u of the plan scatters list %u, which is no summary", i, cut->list);
		if (eco_cut_primitives(cut) > ECO_CUT_PRIMITIVES_MAX)
			return BAD("cut %u of the plan draws list %u as %llu points, at most %u are allowed",
				i, cut->list, (unsigned long long)eco_cut_primitives(cut),
				ECO_CUT_PRIMITIVES_MAX);
		if (list->list.kind == ECO_LIST_IMPOSTOR && cut->end != cut->first + 1)
			return BAD("cut %u of the plan draws %u levels of list %u, an impostor, not one", i,
				cut->end - cut->first, cut->list);
		if (ground
			&& (cut->anchor != ECO_NONE || cut->first || cut->end != list->list.primitive_count))
			return BAD("cut %u of the plan draws a part of list %u, a "
				"tile of ground", i, cut->list);
		if (texture && (cut->anchor != ECO_NONE || cut->placement || cut->first))
			return BAD("cut %u of the plan shows [%u,%u) of list %u, a texture, to some "
				"plants", i, cut->first, cut->end, cut->list);
		const struct view_list *image = list->list.image == ECO_NONE ? NULL
			: view_store_list(store, list->list.image);
		if (list->list.image != ECO_NONE && (!image || !image->served || image->list.kind
				!= (texture ? ECO_LIST_OUTLINE : ECO_LIST_IMAGE)))
			return BAD("list %u needs image %u, which was not sent", cut->list, list->list.image);
	}
	return ECO_OK;
}

/* Levels of a texture, or of its outline, that the plan shows; 0: none. Such cuts are sorted by list, before
 * those of plants. */
static uint32_t levels_of(const struct eco_plan *plan, uint32_t list)
{
	uint32_t low = 0, high = plan->cut_count;
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		const struct eco_cut *cut = &plan->cuts[middle];
		if (cut->anchor == ECO_NONE && cut->placement == 0 && cut->list < list)
			low = middle + 1;
		else
			high = middle;
	}
	return low < plan->cut_count && plan->cuts[low].anchor == ECO_NONE && plan->cuts[low].list == list
		? plan->cuts[low].end : 0;
}

static enum eco_code show_textures(struct view_store *store, struct eco_error *error)
{
	for (uint32_t i = 0; i < store->plan.cut_count; i++) {
		struct view_list *list = view_cache_find(&store->cache, store->plan.cuts[i].list);
		uint32_t outline = list->list.image;
		if (list->list.kind == ECO_LIST_IMAGE)
			ECO_PASS(view_list_show(list, store->plan.cuts[i].end,
				outline == ECO_NONE ? NULL : view_cache_find(&store->cache, outline),
				outline == ECO_NONE ? 0 : levels_of(&store->plan, outline), error));
	}
	return ECO_OK;
}

/* Chunks that come behind a plan, for a finer one or a later view, take no place of those that it needs.
 * An answer that is asked for again has what its last plan needed before. */
static void keep_needs(struct view_store *store)
{
	if (!store->has_plan || store->repeats)
		return;
	view_cache_want_nothing(&store->cache);
	each_need(store, want_need);
}

static enum eco_code take_plan(struct view_store *store, struct eco_error *error)
{
	store->lacks = false;
	each_need(store, touch_need);
	store->evictions_planned = store->cache.evictions;
	store->has_plan = !store->lacks;
	keep_needs(store);
	view_cache_tick(&store->cache);
	return store->has_plan ? show_textures(store, error) : ECO_OK;
}

static enum eco_code on_plan(void *ctx, struct eco_plan *plan, struct eco_error *error)
{
	struct view_store *store = ctx;
	bool counts = store->options.counts;
	enum eco_code code = counts ? ECO_OK : check_plan(store, plan, error);
	if (!code) {
		eco_plan_free(&store->plan);
		store->plan = counts ? (struct eco_plan){ .vertices = plan->vertices,
			.prediction = plan->prediction, .m16 = plan->m16 } : *plan;
		if (!counts)
			*plan = (struct eco_plan){ 0 };
	}
	eco_plan_free(plan);
	if (!code && !counts)
		code = take_plan(store, error);
	store->has_plan |= counts;
	if (!code && store->options.planned)
		store->options.planned(store->options.ctx, eco_predicted_q(&store->plan.prediction));
	return code;
}

/* To three places, and no less than it is. */
static double mebibytes_up(uint64_t bytes)
{
	return (double)(bytes * 1000 / (1 << 20) + 1) / 1000;
}

/* The last plan needs what has gone. It is asked for again, and refused only once all else has gone and it
 * still does not fit. */
static enum eco_code check_memory(struct view_store *store, struct eco_error *error)
{
	view_cache_want_nothing(&store->cache);
	each_need(store, want_need);
	uint64_t bytes = view_cache_wanted_bytes(&store->cache);
	if (store->repeats > REPEATS_EASY && bytes > store->options.memory_max)
		return eco_fail(error, ECO_TOO_LARGE, "the view alone needs %.3f MiB of decoded data, %.3f "
			"MiB are allowed: allow more (ecoview --memory), or ask for fewer vertices or "
			"for wider texels (--texel-px)",
			mebibytes_up(bytes), (double)store->options.memory_max / (1 << 20));
	if (store->repeats == REPEATS_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%.3f MiB of memory are too few for plans that change "
			"with what is held: allow more (ecoview --memory), or no budget of bytes",
			(double)store->options.memory_max / (1 << 20));
	return ECO_OK;
}

static enum eco_code on_end(void *ctx, uint64_t vertices, struct eco_error *error)
{
	struct view_store *store = ctx;
	if (vertices != store->plan.vertices)
		return BAD("the stream ends with %llu vertices, its last plan has "
			"%llu", (unsigned long long)vertices, (unsigned long long)store->plan.vertices);
	if (store->lacks)
		return check_memory(store, error);
	store->complete = true;
	return ECO_OK;
}

bool view_store_again(struct view_store *store, uint64_t *vertices)
{
	if (!store->lacks)
		return false;
	*vertices = store->plan.vertices;
	forget_plan(store);
	store->repeats++;
	view_cache_begin(&store->cache);
	return true;
}

void view_store_resume(struct view_store *store)
{
	store->ahead = false;
	view_cache_begin(&store->cache);
}

bool view_store_settle(struct view_store *store)
{
	store->complete |= store->has_plan;
	return store->has_plan;
}

bool view_store_ahead(const struct view_store *store)
{
	return store->ahead && store->has_plan;
}

/* Chunks that the plan needs do not go for the next view. */
static enum eco_code on_ahead(void *ctx, struct eco_error *error)
{
	(void)error;
	struct view_store *store = ctx;
	store->ahead = true;
	if (store->has_plan)
		each_need(store, want_need);
	return ECO_OK;
}

static enum eco_code on_fetch(void *ctx, const struct eco_chunk *chunk, const uint8_t **payload,
	struct eco_error *error)
{
	const struct view_store *store = ctx;
	return store->find ? store->find(store->find_ctx, chunk, payload, error) : eco_fail(error,
		ECO_UNSUPPORTED, "a chunk is named, not carried, and nothing here fetches it");
}

void view_store_find_by(struct view_store *store, view_store_find *find, void *ctx)
{
	store->find = find;
	store->find_ctx = ctx;
}

const struct eco_wire_events view_store_events = { on_scene, on_plant, on_list, on_chunk, on_plan, on_end,
	on_fetch, on_ahead };

/* ---- Looking ---- */

const struct eco_plan *view_store_plan(const struct view_store *store)
{
	return store->has_plan ? &store->plan : NULL;
}

bool view_store_complete(const struct view_store *store)
{
	return store->complete;
}

const struct eco_chunk_id *view_store_pack(const struct view_store *store)
{
	return store->has_scene ? &store->pack : NULL;
}

double view_store_near_m(const struct view_store *store)
{
	return store->has_scene ? store->scene.near_m : 0.1;
}

uint32_t view_store_needs(const struct view_store *store) { return store->scene.needs; }

const char *view_store_scene_name(const struct view_store *store)
{
	return store->scene.name;
}

const struct view_list *view_store_list(const struct view_store *store, uint32_t id)
{
	return view_cache_find(&store->cache, id);
}

const struct view_plant *view_store_plant(const struct view_store *store, uint32_t id)
{
	uint32_t index = view_table_get(&store->plant_table, id);
	return index == UINT32_MAX ? NULL : store->plants[index];
}

void view_store_ground(const struct view_store *store, uint32_t *columns, uint32_t *rows)
{
	*columns = store->scene.ground_columns;
	*rows = store->scene.ground_rows;
}

uint32_t view_store_list_count(const struct view_store *store)
{
	return store->cache.list_count;
}

const struct view_list *view_store_list_at(const struct view_store *store, uint32_t index)
{
	assert(index < store->cache.list_count);
	return store->cache.lists[index];
}

ECO_ORDER(by_list, struct eco_holding, ->list)

enum eco_code view_store_holdings(const struct view_store *store, struct eco_holdings *holdings,
	struct eco_error *error)
{
	const struct view_cache *cache = &store->cache;
	uint32_t most = store->options.counts ? store->counted_count : cache->list_count;
	*holdings = (struct eco_holdings){ malloc((most + (size_t)1) * sizeof *holdings->items), 0 };
	if (!holdings->items)
		return eco_no_memory(error, "the list of what is held");
	for (uint32_t i = 0; i < most; i++) {
		struct eco_holding one = store->options.counts ? store->counted[i]
			: (struct eco_holding){ cache->lists[i]->id, cache->lists[i]->chunk_count };
		if (one.chunks)
			holdings->items[holdings->count++] = one;
	}
	if (holdings->count > ECO_HOLDINGS_MAX) {
		free(holdings->items);
		*holdings = (struct eco_holdings){ 0 };
		return eco_fail(error, ECO_TOO_LARGE, "more than %u lists are held", ECO_HOLDINGS_MAX);
	}
	qsort(holdings->items, holdings->count, sizeof *holdings->items, by_list);
	return ECO_OK;
}

enum eco_code view_store_write_holdings(const struct view_store *store, struct eco_writer *body,
	struct eco_error *error)
{
	struct eco_holdings holdings;
	ECO_PASS(view_store_holdings(store, &holdings, error));
	eco_wire_write_holdings(body, &holdings);
	free(holdings.items);
	return body->failed ? eco_no_memory(error, "a request") : ECO_OK;
}

struct view_store_stats view_store_stats(const struct view_store *store)
{
	struct view_store_stats stats = store->stats;
	stats.memory_bytes = store->cache.memory_bytes;
	stats.memory_peak_bytes = store->cache.peak_bytes;
	stats.evictions = store->cache.evictions;
	stats.evicted_bytes = store->cache.evicted_bytes;
	return stats;
}
