/* A client with little memory: it draws what one with enough draws, never holds more than it may, and fetches
 * again what it gave up; and the order in which chunks go, against a model that looks at all of them. */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_cache.h"
#include "client-min/view_reference.h"
#include "client-min/view_select.h"
#include "tests/support/serve/served.h"
#include "tests/support/unit_test.h"

#define PATH "build/tmp/cache.eco"
#define SIDE 257u
#define STEP_M 3.0
#define WIDTH 120u
#define HEIGHT 80u

static struct srv_store packs;
static const struct srv_scene *scene;

static double hills(double x, double y) { return 8 * sin(0.021 * x) * cos(0.017 * y); }

static int open_pack(void **state)
{
	scene = served_sample(&packs, PATH, SIDE, STEP_M, false, hills);
	return 0;
}

static int close_pack(void **state)
{
	srv_store_free(&packs);
	return 0;
}

/* ---- Which chunk goes ---- */

#define LISTS 3u

static void push(struct view_cache *cache, uint32_t id, uint32_t count)
{
	struct view_list *list = view_cache_find(cache, id);
	FREED(view_piece) piece = { .elements = { .element_count = count, .corner_count = count,
		.primitive_count = count, .corners = calloc(count, 1), .position = calloc(count, 12) },
		.bytes = (uint64_t)count * 13 };
	struct eco_chunk chunk = { .primitive_count = count, .element_count = count };
	uint64_t before = list->bytes;
	assert_int_equal(view_list_push(list, &piece, &chunk, NULL), ECO_OK);
	view_cache_charge(cache, list, before);
	view_cache_touch(cache, list, list->chunk_count);
}

/* Makes room for one byte more, and says which list has lost a chunk. */
static uint32_t next_to_go(struct view_cache *cache)
{
	uint32_t held[LISTS];
	for (uint32_t id = 0; id < LISTS; id++)
		held[id] = view_cache_find(cache, id)->chunk_count;
	if (!view_cache_make_room(cache, cache->memory_max - cache->memory_bytes + 1, false))
		return LISTS;
	for (uint32_t id = 0; id < LISTS; id++)
		if (view_cache_find(cache, id)->chunk_count < held[id])
			return id;
	return LISTS;
}

/* Lists 0 and 1 come in one tick, 1 with larger chunks; then list 2 comes, and the first chunk of 0 is used
 * again.
 * One of list 2 is wanted. */
UNIT_TEST(what_was_needed_least_recently_goes_first_and_what_is_wanted_stays)
{
	static const uint32_t order[] = { 1, 1, 0, 0, 2, LISTS };
	FREED(view_cache) cache = { .memory_max = 1 << 20 };
	struct eco_list record = { .kind = ECO_LIST_POINTS, .coder = ECO_CODER_KD, .chunk_count = 2,
		.element_count = 200, .primitive_count = 200 };
	for (uint32_t id = 0; id < LISTS; id++) {
		assert_true(view_cache_add(&cache, view_list_new(id, &record, NULL, NULL)));
		cache.tick += id == 2;
		for (uint32_t c = 0; c < 2; c++)
			push(&cache, id, id == 1 ? 51 : 50);
	}
	view_cache_touch(&cache, view_cache_find(&cache, 0), 1);
	view_cache_tick(&cache);
	assert_true(view_cache_want(&cache, 2, 1));
	for (size_t i = 0; i < sizeof order / sizeof *order; i++)
		assert_int_equal(next_to_go(&cache), order[i]);
	assert_true(view_cache_had(&cache, 0, 1) && view_cache_had(&cache, 2, 1) && !view_cache_had(&cache, 0,
		2));
	view_cache_begin(&cache);
	assert_true(cache.list_count == 1 && view_cache_wanted_bytes(&cache) == cache.memory_bytes);
}

/* Two levels, of 16 + 8 rows and of 16 + 16: rows of a level go one strip after the other, and come again. */
UNIT_TEST(strips_of_a_texture_come_and_go)
{
	static const uint32_t rows[] = { 16, 8, 16, 16 },
		heights[][2] = { { 16, 0 }, { 24, 0 }, { 24, 16 }, { 24, 32 } };
	const struct eco_list record = { .kind = ECO_LIST_IMAGE, .coder = ECO_CODER_BYTES, .chunk_count = 4,
		.element_count = 2, .primitive_count = 2 };
	struct view_list *list = view_list_new(0, &record, NULL, NULL);
	uint64_t empty = list->bytes;
	for (int turn = 0; turn < 2; turn++) {
		for (uint32_t i = 0; i < 4; i++) {
			FREED(view_piece) piece = { .part = { 5, rows[i], 3, malloc(15 * rows[i]) }, .bytes = 100 };
			const struct eco_chunk chunk = { .primitive_count = i % 2, .element_count = i % 2 };
			memset(piece.part.texels, (int)i, 15 * rows[i]);
			assert_int_equal(view_list_push(list, &piece, &chunk, NULL), ECO_OK);
			assert_int_equal(list->parts[0].height, heights[i][0]);
			assert_int_equal(list->parts[1].height, heights[i][1]);
			if (i == 3)
				assert_int_equal(view_list_push(list, &piece, &chunk, NULL), ECO_DAMAGED);
		}
		assert_true(list->parts[0].texels[15 * 16 - 1] == 0 && list->parts[0].texels[15 * 16] == 1);
		for (uint32_t i = 4; i-- > 0;) {
			view_list_pop(list);
			assert_int_equal(list->parts[0].height, i ? heights[i - 1][0] : 0);
			assert_int_equal(list->parts[1].height, i ? heights[i - 1][1] : 0);
		}
		assert_true(list->bytes == empty && !list->parts[0].texels && !list->parts[1].texels);
	}
	view_list_free(list);
}

/* ---- A client that asks a server's half in this process ---- */

struct client { struct view_store *store; uint64_t memory_max, bytes; uint32_t requests, answers; };

static struct client client_new(uint64_t memory_max)
{
	struct client c = { .memory_max = memory_max };
	struct view_store_options options = { .memory_max = memory_max };    /* images are no pictures here */
	assert_int_equal(view_store_new(&c.store, &options, NULL), ECO_OK);
	return c;
}

/* Memory of a list, counted from its arrays. */
static uint64_t list_bytes(const struct view_list *list)
{
	const struct eco_elements *e = &list->elements;
	uint64_t bytes = view_list_bytes(&list->list) + e->element_count * (1 + 4ull * e->extra_count)
		+ e->corner_count * (e->uv ? 20ull : 12ull);
	/* with the image that a part may be shown in */
	for (uint32_t i = 0; list->parts && i < list->chunk_count; i++)
		bytes += sizeof list->parts[i] + (uint64_t)list->parts[i].width * list->parts[i].height
			* (list->parts[i].channels + 4);
	for (uint32_t i = 0; list->impostors && i < list->chunk_count; i++)
		bytes += sizeof list->impostors[i] + lod_impostor_bytes(&list->impostors[i]);
	return bytes;
}

static void check_bytes(const struct client *c)
{
	uint64_t bytes = 0;
	for (uint32_t i = 0; i < view_store_list_count(c->store); i++)
		bytes += list_bytes(view_store_list_at(c->store, i));
	for (uint32_t i = 0; i < scene->pack->scene.plant_count; i++) {
		const struct view_plant *plant = view_store_plant(c->store, i);
		bytes += plant ? sizeof *plant + plant->anchor_count * sizeof *plant->anchors : 0;
	}
	struct view_store_stats stats = view_store_stats(c->store);
	assert_true(bytes == stats.memory_bytes);
	assert_true(bytes <= stats.memory_peak_bytes && stats.memory_peak_bytes
		<= (c->memory_max ? c->memory_max : UINT64_MAX));
	assert_int_equal(stats.chunks_twice, 0);
}

static enum eco_code answer(struct client *c, const struct eco_request *request, struct eco_error *error)
{
	struct eco_holdings holdings;
	FREED(srv_stream) stream;
	uint64_t bytes;
	assert_int_equal(view_store_holdings(c->store, &holdings, NULL), ECO_OK);
	struct srv_stream_input input = { .scene = scene, .request = request, .holdings = &holdings };
	assert_int_equal(srv_holdings_check(&scene->pack->scene, &holdings, NULL), ECO_OK);
	assert_int_equal(srv_stream_plan(&stream, &input, NULL), ECO_OK);
	assert_true(stream.fits && stream.body_bytes <= request->bytes);
	enum eco_code code = served_feed(c->store, &stream, &bytes, error);
	assert_true(!c->memory_max || view_store_stats(c->store).memory_peak_bytes <= c->memory_max);
	c->answers++;
	c->bytes += bytes;
	free(holdings.items);
	return code;
}

static enum eco_code visit(struct client *c, const struct eco_request *request, struct eco_error *error)
{
	struct eco_request now = *request;
	c->requests++;
	view_store_begin(c->store);
	for (uint32_t i = 0; i < view_store_list_count(c->store); i++)
		assert_true(view_store_list_at(c->store, i)->chunk_count > 0);
	enum eco_code code = answer(c, &now, error);
	for (uint64_t vertices; !code && view_store_again(c->store, &vertices);) {
		now.vertices = request->bytes == ECO_BYTES_UNBOUNDED ? request->vertices : vertices;
		check_bytes(c);
		code = answer(c, &now, error);
	}
	check_bytes(c);
	assert_int_equal(view_store_complete(c->store), !code);
	return code;
}

/* ---- Pictures ---- */

static struct eco_request request_at(double x, double y, double toward_x, double toward_y, uint64_t vertices)
{
	struct eco_request r = { .vertices = vertices, .bytes = ECO_BYTES_UNBOUNDED };
	r.view = (struct eco_view){ { x, y, hills(x, y) + 2 }, { toward_x, toward_y, hills(toward_x,
		toward_y) + 1 },
		{ 0, 0, 1 }, 50, WIDTH, HEIGHT };
	return r;
}

/* Around the plants, near and far. */
static struct eco_request step_of_walk(uint32_t step)
{
	double angle = 6.2831853 * step / 24, far = step % 3 == 2 ? 160 : 45;
	return request_at(30 + far * cos(angle), 30 + far * sin(angle), 30, 30, 12000);
}

static struct eco_writer plan_bytes(const struct client *c)
{
	struct eco_writer w = { 0 };
	eco_wire_write_plan(&w, view_store_plan(c->store));
	return w;
}

static struct view_picture picture_of(const struct client *c, const struct eco_request *request)
{
	AT_END(view_select_free) struct view_selection selection;
	struct view_picture picture;
	struct lod_eye eye;
	lod_eye_make(&eye, &request->view);
	assert_int_equal(view_select_make(&selection, c->store, &eye, NULL), ECO_OK);
	assert_int_equal(view_picture_init(&picture, WIDTH, HEIGHT, NULL), ECO_OK);
	assert_int_equal(view_reference_draw(&(struct view_draw_job){ c->store, &selection, &eye, 0.05,
		1, NULL,
		VIEW_TINT_NONE, 1, false }, &picture, NULL), ECO_OK);
	return picture;
}

static void same_picture(const struct client *a, const struct client *b, const struct eco_request *request)
{
	struct eco_writer plans[2] = { plan_bytes(a), plan_bytes(b) };
	assert_int_equal(plans[0].size, plans[1].size);
	assert_memory_equal(plans[0].bytes, plans[1].bytes, plans[0].size);
	struct view_picture pictures[2] = { picture_of(a, request), picture_of(b, request) };
	assert_memory_equal(pictures[0].rgb, pictures[1].rgb, WIDTH * HEIGHT * 3);
	assert_memory_equal(pictures[0].owner, pictures[1].owner, WIDTH * HEIGHT * sizeof *pictures[0].owner);
	for (int i = 0; i < 2; i++) {
		view_picture_free(&pictures[i]);
		eco_writer_free(&plans[i]);
	}
}

/* The need of a view alone, as the refusal of a client with too little says it. */
static uint64_t refused_need(struct client *c, const struct eco_request *request)
{
	struct eco_error error = { 0 };
	assert_int_equal(visit(c, request, &error), ECO_TOO_LARGE);
	const char *at = strstr(error.text, "needs ");
	if (!at || !strstr(error.text, "--memory"))
		fail_msg("%s", error.text);
	return (uint64_t)ceil(strtod(at + 6, NULL) * (1 << 20));
}

static uint64_t need_of(const struct eco_request *request)
{
	struct client c = client_new(60000);
	uint64_t need = refused_need(&c, request);
	view_store_free(c.store);
	return need;
}

static uint64_t largest_need(void)
{
	uint64_t most = 0;
	for (uint32_t step = 0; step < 24; step++) {
		struct eco_request request = step_of_walk(step);
		uint64_t need = need_of(&request);
		most = need > most ? need : most;
	}
	return most;
}

UNIT_TEST(little_memory_draws_the_same_pictures)
{
	struct client ample = client_new(0), tight = client_new(largest_need() * 11 / 10);
	for (uint32_t step = 0; step < 48; step++) {
		struct eco_request request = step_of_walk(step);
		assert_good(visit(&ample, &request, &cause));
		assert_good(visit(&tight, &request, &cause));
		same_picture(&ample, &tight, &request);
	}
	struct view_store_stats a = view_store_stats(ample.store), t = view_store_stats(tight.store);
	assert_true(a.evictions == 0 && a.again_bytes == 0 && ample.answers == ample.requests);
	assert_true(a.memory_bytes > tight.memory_max && t.evictions > 50 && t.chunks_again > 50);
	assert_true(t.again_bytes > 10000 && t.again_bytes <= t.chunk_bytes && tight.bytes > ample.bytes);
	/* what came is what there was, and what came again */
	assert_true(t.chunks - t.chunks_again <= a.chunks);
	view_store_free(ample.store);
	view_store_free(tight.store);
}

/* Two views that do not fit together, and two that do. */
UNIT_TEST(ping_pong_fetches_again_only_where_it_must)
{
	struct eco_request views[2] = { request_at(-20, -20, 60, 60, 9000), request_at(90, 70, -60, -40,
		9000) };
	uint64_t need[2] = { need_of(&views[0]), need_of(&views[1]) }, most = need[0] > need[1] ? need[0]
		: need[1];
	for (int fits = 0; fits < 2; fits++) {
		struct client c = client_new(fits ? 2 * (need[0] + need[1]) : most + most / 50);
		uint64_t before = 0;
		for (uint32_t step = 0; step < 12; step++) {
			assert_good(visit(&c, &views[step % 2], &cause));
			uint64_t again = view_store_stats(c.store).again_bytes;
			assert_true(step < 2 || fits ? again == 0 || !fits : again > before);
			before = again;
		}
		assert_int_equal(view_store_stats(c.store).evictions > 0, !fits);
		/* standing still costs nothing, however short memory is */
		uint64_t chunks = view_store_stats(c.store).chunks;
		for (int i = 0; i < 3; i++)
			assert_good(visit(&c, &views[1], &cause));
		assert_int_equal(view_store_stats(c.store).chunks, chunks);
		view_store_free(c.store);
	}
}

/* Exactly what the refusal names, to a thousandth of a MiB, is enough, and a little less is not. */
UNIT_TEST(refusal_names_what_is_enough)
{
	for (uint32_t step = 0; step < 24; step += 5) {
		struct eco_request request = step_of_walk(step);
		struct eco_error error = { 0 };
		uint64_t need = need_of(&request);
		struct client enough = client_new(need), less = client_new(need - (1 << 20) / 500);
		assert_ok(visit(&enough, &request, &error), error);
		assert_int_equal(visit(&less, &request, &error), ECO_TOO_LARGE);
		assert_non_null(strstr(error.text, "ask for fewer vertices"));
		error = (struct eco_error){ 0 };
		/* whatever it held of other views before */
		for (uint32_t i = 0; i < 24; i += 3) {
			struct eco_request other = step_of_walk(i);
			other.vertices = 100u << i % 7;
			other.ground_px = i % 2 ? 64 : 0.1;
			visit(&less, &other, NULL);      /* whether it fits or not */
			visit(&enough, &other, NULL);
			assert_ok(visit(&enough, &request, &error), error);
		}
		assert_true(refused_need(&less, &request) <= need);
		/* a smaller view still goes */
		error = (struct eco_error){ 0 };
		request.vertices = 500;
		request.ground_px = 64;
		assert_ok(visit(&less, &request, &error), error);
		view_store_free(enough.store);
		view_store_free(less.store);
	}
}

UNIT_TEST(memory_for_less_than_a_chunk_is_refused)
{
	static const uint64_t sizes[] = { 1, 100, 700, 2000, 5000, 20000 };
	struct eco_request request = step_of_walk(0);
	for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
		struct client c = client_new(sizes[i]);
		for (int round = 0; round < 2; round++) {
			struct eco_error error = { 0 };
			assert_int_equal(visit(&c, &request, &error), ECO_TOO_LARGE);
			assert_non_null(strstr(error.text, "MiB"));
			assert_non_null(strstr(error.text, "--memory"));
			assert_null(view_store_plan(c.store));
		}
		view_store_free(c.store);
	}
}

static void check_plan_is_held(const struct client *c)
{
	struct eco_holdings needs = { 0 };
	assert_int_equal(lod_plan_needs(&scene->pack->scene, view_store_plan(c->store), &needs, NULL), ECO_OK);
	for (uint32_t i = 0; i < needs.count; i++) {
		const struct view_list *list = view_store_list(c->store, needs.items[i].list);
		if (!list || list->chunk_count < needs.items[i].chunks)
			fail_msg("list %u: %u chunks are held, %u needed", needs.items[i].list,
				list ? list->chunk_count : 0, needs.items[i].chunks);
	}
	free(needs.items);
}

/* The rest of the bytes, and the next view's, come behind the plan: they take no place of what it needs. */
UNIT_TEST(what_comes_behind_a_plan_leaves_what_it_needs)
{
	for (uint64_t bytes = 10000; bytes <= 80000; bytes *= 2)
		for (int ahead = 0; ahead < 2; ahead++) {
			struct client c = client_new(largest_need() * 11 / 10);
			for (uint32_t step = 0; step < 24; step++) {
				struct eco_request request = step_of_walk(step), next = step_of_walk(step + 5);
				request.bytes = bytes;
				request.next.given = ahead;
				memcpy(request.next.eye, next.view.eye, sizeof next.view.eye);
				memcpy(request.next.target, next.view.target, sizeof next.view.target);
				assert_good(visit(&c, &request, &cause));
				check_plan_is_held(&c);
			}
			assert_true(view_store_stats(c.store).evictions > 0);
			view_store_free(c.store);
		}
}

UNIT_MAIN(open_pack, close_pack)
