/* A client with little memory (Deussen 2002, section 6.3): bytes fetched along a path, chunks given up
 * (client-min/view_cache.h) and requests repeated, by the memory that the client may hold.
 *
 * Paths go there and back, which needs everything twice. The whole need is the memory of a client without a
 * limit at the end. Nothing is drawn: tests/client/test_view_cache.c compares the pictures. */
#include <stdlib.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/format/view.h"
#include "tests/bench/bench_fetch.h"
#include "tests/bench/bench_shots.h"

#define VERTICES 100000u
#define FRAMES_FULL 60u                  /* one way */
#define FRAMES_QUICK 20u

/* Parts of the whole need; no limit; the need of the largest view alone, and 2 % for descriptions of what
 * only its coarse steps show. */
enum { NO_LIMIT = 0, LARGEST_VIEW = UINT32_MAX };
static const uint32_t parts[] = { NO_LIMIT, 1, 2, 4, LARGEST_VIEW };
#define PARTS (sizeof parts / sizeof *parts)
static const char *const scenes[] = { "outdoor", "trees5000", "scbi" };
#define SCENES (sizeof scenes / sizeof *scenes)

struct walk { struct eco_request *requests; uint32_t count; uint64_t need, largest; };

/* ---- Cameras ---- */

static void there_and_back(struct bench *bench, const char *scene, struct walk *walk)
{
	uint32_t one_way = bench->full ? FRAMES_FULL : FRAMES_QUICK;
	walk->requests = eco_alloc(2 * (size_t)one_way, sizeof *walk->requests);
	walk->count = 2 * bench_scene_views(bench, scene, walk->requests, one_way);
	if (!walk->count)
		must(eco_fail(must_error, ECO_NOT_FOUND, "scene '%s' has no path", scene));
	for (uint32_t i = 0; i < one_way; i++)
		walk->requests[one_way + i] = walk->requests[one_way - 1 - i];
}

/* ---- One path ---- */

/* Bytes of chunks needed at tick `since` or later, and of their lists, without the spare room of arrays. */
static uint64_t held_since(const struct view_store *store, uint64_t since)
{
	uint64_t bytes = view_store_stats(store).memory_bytes;
	for (uint32_t i = 0; i < view_store_list_count(store); i++) {
		const struct view_list *list = view_store_list_at(store, i);
		bytes -= list->bytes;
		if (list->chunk_count && list->marks[0].used >= since)
			bytes += view_list_bytes(&list->list);
		for (uint32_t c = 0; c < list->chunk_count && list->marks[c].used >= since; c++)
			bytes += list->marks[c].bytes;
	}
	return bytes;
}

static void measure(struct walk *walk, const struct view_store *store)
{
	uint64_t last = 0;           /* tick of the last plan that named anything */
	for (uint32_t i = 0; i < view_store_list_count(store); i++) {
		const struct view_list *list = view_store_list_at(store, i);
		if (list->chunk_count && list->marks[0].used > last)
			last = list->marks[0].used;
	}
	uint64_t view = held_since(store, last);
	walk->need = held_since(store, 0);
	walk->largest = view > walk->largest ? view : walk->largest;
}

enum figure { MEMORY, FRAMES, BYTES, ANSWERS, EVICTIONS, AGAIN, FIGURES };

/* Without a limit (0) measures what the walk needs. A view that needs more than there is ends the walk. */
static void walk_with(const struct srv_scene *scene, struct walk *walk, uint64_t memory,
	double figure[FIGURES])
{
	struct view_store *store;
	struct view_store_options options = { .memory_max = memory ? memory : 1ull << 40, .images = true };
	must(view_store_new(&store, &options, must_error));
	for (; figure[FRAMES] < walk->count; figure[FRAMES]++) {
		struct eco_request request = walk->requests[(uint32_t)figure[FRAMES]];
		struct bench_fetch fetch = { 0 };
		struct eco_error why = { 0 };
		request.vertices = VERTICES;
		request.bytes = ECO_BYTES_UNBOUNDED;
		enum eco_code code = bench_fetch(&fetch, scene, &request, store, &why);
		if (code == ECO_TOO_LARGE)
			break;
		if (code)
			must(eco_fail(must_error, code, "%s", why.text));
		figure[BYTES] += (double)fetch.bytes;
		figure[ANSWERS] += fetch.requests;
		if (!memory)
			measure(walk, store);
	}
	figure[MEMORY] = (double)(memory ? memory : walk->need);
	figure[EVICTIONS] = (double)view_store_stats(store).evictions;
	figure[AGAIN] = (double)view_store_stats(store).again_bytes;
	view_store_free(store);
}

static uint64_t memory_of(const struct walk *walk, uint32_t part)
{
	return part == NO_LIMIT ? 0 : part == LARGEST_VIEW ? walk->largest + walk->largest / 50
		: walk->need / part;
}

struct work { struct bench *bench; size_t which; const char *pack; };

static json_t *run_path(void *ctx)
{
	const struct work *w = ctx;
	const char *scene = scenes[w->which];
	struct srv_store served;
	struct walk walk = { 0 };
	double figure[PARTS][FIGURES] = { { 0 } };
	srv_store_init(&served);
	there_and_back(w->bench, scene, &walk);
	must(srv_store_add(&served, "scene", w->pack, must_error));
	for (size_t i = 0; i < PARTS; i++) {
		bench_progress(((double)w->which + (double)i / PARTS) / SCENES, scene);
		walk_with(served.scenes[0], &walk, memory_of(&walk, parts[i]), figure[i]);
	}
	srv_store_free(&served);
	free(walk.requests);
	return bench_reals(*figure, PARTS * FIGURES);
}

static void try_path(struct bench *bench, size_t which, struct bench_table *table)
{
	char pack[512], name[96];
	double figure[PARTS][FIGURES], *all = figure[0];
	if (!bench_scene_there(bench, scenes[which], pack))
		return;
	snprintf(name, sizeof name, "cache-%s-%s", scenes[which], bench->full ? "full" : "quick");
	bench_cells(bench_unit(bench, name, bench_pack_stamp(pack), run_path, &(struct work){ bench, which,
		pack }), all, PARTS * FIGURES);
	for (size_t i = 0; i < PARTS; i++) {
		char part[24];
		const double *now = figure[i];
		snprintf(part, sizeof part, parts[i] == NO_LIMIT ? "no limit" : parts[i] == LARGEST_VIEW
			? "largest view" : "1/%u", parts[i]);
		bench_table_row(table, "%s,%s,%.2f,%.0f of %.0f,%.0f,%.2f,%.0f,%.0f,%.0f", scenes[which],
			part, now[MEMORY] / (1 << 20), now[FRAMES], all[FRAMES], now[BYTES],
			now[BYTES] / all[BYTES], now[EVICTIONS], now[AGAIN], now[ANSWERS] - now[FRAMES]);
	}
}

static void run(struct bench *bench)
{
	struct bench_table *table = bench_table_open(bench, "cache", "scene,memory,MiB,frames,bytes,"
		"times no limit,chunks evicted,bytes fetched again,requests repeated", true);
	for (size_t i = 0; i < SCENES; i++)
		try_path(bench, i, table);
	bench_table_close(table);
	bench_say(bench, "A client may hold a part of the decoded data that a whole path needs, at %u "
		"vertices a frame. The chunk that no plan needed for the longest time goes first; ties: the "
		"largest. A path ends where one view alone needs more than there is.", VERTICES);
}

const struct bench_section bench_cache = { "cache", "A client with little memory", run };
