/* The body of a stream, on random scenes: what is sent is what is needed, its size is known exactly, and no
 * budget is exceeded. */
#include <stdlib.h>
#include <string.h>

#include "client-min/view_store.h"
#include "ecofiles/format/wire.h"
#include "lod/plan/planner.h"
#include "server/stream.h"
#include "tests/support/scene_random.h"
#include "tests/support/unit_test.h"

#define ROUNDS 24u
#define OWNED_MAX 64u
#define PLANTS_MOST 16u

/* A scene as the store of a server would hold it; a client that counts what comes, and fails where a chunk
 * comes twice or out of order, or a plan that draws what has not been sent; and what was made for them. */
struct bench {
	struct random_pack *pack;
	struct srv_scene scene;
	struct view_store *client;
	uint64_t budget_vertices;
	uint32_t plans, lists;               /* of the last stream */
	uint64_t chunks;
	uint32_t anchors[PLANTS_MOST];       /* of each plant that the client was told */
	void *owned[OWNED_MAX];
	uint32_t owned_count;
};

static struct bench *reading;

static enum eco_code on_plant(void *store, uint32_t id, const struct eco_plant *plant,
	const struct eco_anchor *anchors, uint32_t anchor_count, struct eco_error *error)
{
	assert_true(id < PLANTS_MOST);
	if (anchor_count > reading->anchors[id])
		reading->anchors[id] = anchor_count;
	return view_store_events.plant(store, id, plant, anchors, anchor_count, error);
}

static enum eco_code on_list(void *store, uint32_t id, const struct eco_list *list, const uint8_t (*palette)[3],
	const struct eco_group *groups, struct eco_error *error)
{
	reading->lists++;
	return view_store_events.list(store, id, list, palette, groups, error);
}

static enum eco_code on_plan(void *store, struct eco_plan *plan, struct eco_error *error)
{
	struct eco_holdings needs, held;
	assert_good(lod_plan_needs(&reading->pack->pack.scene, plan, &needs, &cause));
	assert_good(view_store_holdings(store, &held, &cause));
	for (uint32_t i = 0; i < needs.count; i++)
		assert_true(needs.items[i].chunks <= eco_holdings_chunks(&held, needs.items[i].list));
	assert_true(plan->vertices <= reading->budget_vertices);
	for (uint32_t i = 0; i < plan->cut_count; i++)
		for (uint32_t k = 0; k < reading->pack->pack.scene.plant_count; k++) {
			const struct eco_plant *plant = &reading->pack->pack.scene.plants[k];
			uint32_t anchor = plan->cuts[i].anchor - plant->anchor_first;
			if (plan->cuts[i].anchor != ECO_NONE && anchor < plant->anchor_count)
				assert_true(anchor < reading->anchors[k]);
		}
	reading->plans++;
	free(needs.items);
	free(held.items);
	return view_store_events.plan(store, plan, error);
}

static void begin_client(struct bench *b)
{
	view_store_free(b->client);
	memset(b->anchors, 0, sizeof b->anchors);
	assert_good(view_store_new(&b->client, &(struct view_store_options){ .counts = true }, &cause));
}

static void own(struct bench *b, void *memory)
{
	assert_true(b->owned_count < OWNED_MAX);
	b->owned[b->owned_count++] = memory;
}

static struct bench bench_make(uint64_t seed, uint32_t factor)
{
	struct bench b = { .pack = random_pack_make(seed, seed % 3 ? 0 : 2, factor) };
	b.scene = (struct srv_scene){ .name = "random", .pack = &b.pack->pack };
	b.scene.checked = calloc(b.pack->pack.scene.chunk_count + 1, 1);
	begin_client(&b);
	return b;
}

static void bench_free(struct bench *b)
{
	while (b->owned_count)
		free(b->owned[--b->owned_count]);
	free(b->scene.checked);
	view_store_free(b->client);
	random_pack_free(b->pack);
}

struct body { uint8_t *bytes; size_t size; bool fits; uint32_t steps; uint64_t smallest; };

static struct body build(struct bench *b, const struct eco_request *request, const struct eco_holdings *holdings)
{
	struct srv_stream_input input = { .scene = &b->scene, .request = request, .holdings = holdings };
	struct srv_stream stream;
	struct srv_body body = { 0 };
	assert_good(srv_stream_plan(&stream, &input, &cause));
	if (stream.fits)
		assert_good(srv_stream_write(&stream, &body, &cause));
	assert_true(!stream.fits || body.size_bytes == stream.body_bytes);
	struct body out = { .bytes = malloc(body.size_bytes + 1), .fits = stream.fits, .steps =
		stream.step_count, .smallest = stream.body_bytes };
	for (uint32_t i = 0; i < body.piece_count; i++) {
		if (body.pieces[i].size)
			memcpy(out.bytes + out.size, body.pieces[i].bytes, body.pieces[i].size);
		out.size += body.pieces[i].size;
	}
	assert_true(out.size == body.size_bytes);
	srv_body_free(&body);
	srv_stream_free(&stream);
	own(b, out.bytes);
	return out;
}

static void read_all(struct bench *b, const struct body *body, uint64_t vertices)
{
	struct eco_wire_events events = view_store_events;
	struct eco_wire_parser *parser;
	uint64_t before = view_store_stats(b->client).chunks;
	events.plant = on_plant;
	events.list = on_list;
	events.plan = on_plan;
	reading = b;
	b->budget_vertices = vertices;
	b->plans = b->lists = 0;
	view_store_begin(b->client);
	assert_good(eco_wire_parser_new(&parser, &events, b->client, &cause));
	assert_good(eco_wire_feed(parser, body->bytes, body->size, &cause));
	assert_good(eco_wire_finish(parser, &cause));
	eco_wire_parser_free(parser);
	b->chunks = view_store_stats(b->client).chunks - before;
	assert_true(view_store_complete(b->client) && !view_store_stats(b->client).chunks_twice);
	assert_int_equal(b->plans, body->steps);
}

/* The client's holdings as the server reads them from a request. */
static struct eco_holdings held_by(struct bench *b)
{
	FREED(eco_writer) w = { 0 };
	struct eco_holdings holdings;
	assert_good(view_store_write_holdings(b->client, &w, &cause));
	assert_good(eco_wire_read_holdings(w.bytes, w.size, &holdings, &cause));
	assert_good(srv_holdings_check(&b->pack->pack.scene, &holdings, &cause));
	own(b, holdings.items);
	return holdings;
}

static struct eco_request random_request(struct scene_builder *r)
{
	static const uint64_t budgets[] = { 0, 1, 100, 1000, 10000, 100000, 100000000 };
	return (struct eco_request){ .view = random_view(r),
		.vertices = budgets[random_below(r, 7)] + random_below(r, 50),
		.bytes = ECO_BYTES_UNBOUNDED };
}

UNIT_TEST(what_is_held_is_not_sent_again)
{
	for (uint64_t seed = 1; seed <= ROUNDS; seed++) {
		struct bench b = bench_make(100 + seed, 2);
		struct eco_request request = random_request(&b.pack->r);
		struct body first = build(&b, &request, NULL);
		read_all(&b, &first, request.vertices);
		struct eco_holdings held = held_by(&b);
		struct body again = build(&b, &request, &held);
		read_all(&b, &again, request.vertices);
		assert_int_equal(b.chunks, 0);
		assert_int_equal(b.lists, 0);
		assert_true(again.size <= first.size);
		/* a walk through the scene: every stream on top of what is held by then */
		for (int i = 0; i < 6; i++) {
			struct eco_holdings now = held_by(&b);
			request = random_request(&b.pack->r);
			struct body next = build(&b, &request, &now);
			read_all(&b, &next, request.vertices);
		}
		bench_free(&b);
	}
}

UNIT_TEST(byte_budgets_are_never_exceeded_and_well_used)
{
	uint32_t fitting = 0, refused = 0, bounded = 0;
	double used = 0;
	for (uint64_t seed = 1; seed <= 10; seed++) {
		struct bench b = bench_make(300 + seed, 3);
		struct eco_request request = random_request(&b.pack->r);
		request.vertices = 200000;
		struct body whole = build(&b, &request, NULL);
		request.bytes = 0;
		struct body none = build(&b, &request, NULL);
		assert_true(whole.fits && !none.fits && none.smallest > 0 && none.smallest <= whole.size);
		for (int i = 0; i < 20; i++) {
			request.bytes = random_below(&b.pack->r, i ? (uint32_t)whole.size + 1000
				: (uint32_t)none.smallest);
			begin_client(&b);
			struct body body = build(&b, &request, NULL);
			assert_int_equal(body.fits, request.bytes >= none.smallest);
			if (body.fits) {
				assert_true(body.size <= request.bytes);
				read_all(&b, &body, request.vertices);
				fitting++;
				if (request.bytes < whole.size && request.bytes > 4 * none.smallest) {
					used += (double)body.size / (double)request.bytes;
					bounded++;
				}
			}
			refused += !body.fits;
		}
		/* the smallest fits, and clearly less does not */
		request.bytes = none.smallest;
		struct body least = build(&b, &request, NULL);
		assert_true(least.fits && least.size <= none.smallest);
		request.bytes = none.smallest - none.smallest / 16;
		struct body less = build(&b, &request, NULL);
		assert_false(less.fits);
		bench_free(&b);
	}
	assert_true(fitting > 100 && refused > 0 && bounded > 50);
	/* chunks here are coarse: a third of a list each, or a tile of ground */
	print_message("          %.3f of the bytes used\n", used / bounded);
	assert_true(used / bounded > 0.65);
}

/* A client that stays where it is. */
UNIT_TEST(what_has_no_room_in_an_answer_comes_in_parts)
{
	uint32_t whole_at_last = 0, parts = 0;
	for (uint64_t seed = 1; seed <= 30; seed++) {
		struct bench b = bench_make(700 + seed, 3);
		struct eco_request request = random_request(&b.pack->r);
		request.vertices = 200000;
		struct body whole = build(&b, &request, NULL);
		request.bytes = whole.size / 3;
		for (int visit = 0; visit < 12; visit++) {
			struct eco_holdings held = held_by(&b);
			struct body body = build(&b, &request, &held);
			if (body.fits) {
				assert_true(body.size <= request.bytes);
				read_all(&b, &body, request.vertices);
				parts += visit > 0 && b.chunks > 0;
			}
		}
		request.bytes = ECO_BYTES_UNBOUNDED;
		struct eco_holdings held = held_by(&b);
		struct body rest = build(&b, &request, &held);
		read_all(&b, &rest, request.vertices);
		whole_at_last += b.chunks == 0;
		bench_free(&b);
	}
	print_message("          %u of 30 have all at last; %u answers brought parts\n", whole_at_last,
		parts);
	assert_true(whole_at_last >= 27 && parts >= 30);
}

/* An explanation is a by-product of the plan: it costs no further one, and changes nothing. */
static void assert_same_steps(const struct srv_stream *explained, const struct srv_stream *plain)
{
	assert_in_range(explained->work, plain->work, 3 * plain->work / 2);
	assert_int_equal(explained->step_count, plain->step_count);
	assert_int_equal(explained->body_bytes, plain->body_bytes);
	for (uint32_t i = 0; i < plain->step_count; i++) {
		struct eco_writer bytes[2] = { { 0 }, { 0 } };
		eco_wire_write_plan(&bytes[0], &explained->steps[i].plan);
		eco_wire_write_plan(&bytes[1], &plain->steps[i].plan);
		assert_int_equal(bytes[0].size, bytes[1].size);
		assert_memory_equal(bytes[0].bytes, bytes[1].bytes, bytes[0].size);
		eco_writer_free(&bytes[0]);
		eco_writer_free(&bytes[1]);
	}
}

UNIT_TEST(explanations_are_of_the_plan_that_is_sent)
{
	uint32_t bounded = 0;
	for (uint64_t seed = 1; seed <= ROUNDS; seed++) {
		struct bench b = bench_make(500 + seed, 3);
		struct eco_request request = random_request(&b.pack->r);
		request.vertices = 1000 + random_below(&b.pack->r, 200000);
		request.bytes = 1000 + random_below(&b.pack->r, 60000);
		struct srv_stream_input input = { .scene = &b.scene, .request = &request, .explain = true,
			.rule = seed % 3 ? NULL : lod_rule_deussen };
		struct srv_stream stream, plain;
		assert_good(srv_stream_plan(&stream, &input, &cause));
		input.explain = false;
		assert_good(srv_stream_plan(&plain, &input, &cause));
		const struct srv_step *last = &stream.steps[stream.step_count - 1];
		uint64_t vertices = 0;
		for (uint32_t i = 0; i < last->why.count; i++)
			vertices += last->why.rows[i].vertices;
		if (stream.fits && !last->why.omitted)
			assert_int_equal(vertices, last->plan.vertices);
		bounded += stream.fits && vertices < request.vertices / 2;
		assert_same_steps(&stream, &plain);
		srv_stream_free(&plain);
		srv_stream_free(&stream);
		bench_free(&b);
	}
	assert_true(bounded > ROUNDS / 8);
}

/* Chunks that the next view lacks come after the answer, changes nothing of it, and is not asked for again
 * there. */
UNIT_TEST(the_next_view_comes_last_and_within_the_same_bytes)
{
	uint32_t saved = 0;
	for (uint64_t seed = 1; seed <= ROUNDS; seed++) {
		struct bench b = bench_make(600 + seed, 2 + seed % 4);
		struct eco_request request = random_request(&b.pack->r), there = request;
		struct eco_view next = random_view(&b.pack->r);
		request.vertices = there.vertices = 1 + random_below(&b.pack->r, 100000);
		memcpy(there.view.eye, next.eye, sizeof next.eye);
		memcpy(there.view.target, next.target, sizeof next.target);
		struct body alone = build(&b, &request, NULL);
		memcpy(request.next.eye, next.eye, sizeof next.eye);
		memcpy(request.next.target, next.target, sizeof next.target);
		request.next.given = true;
		struct body whole = build(&b, &request, NULL);
		assert_true(whole.fits && whole.size >= alone.size);
		assert_memory_equal(whole.bytes, alone.bytes, alone.size - ECO_END_FRAME_BYTES);
		read_all(&b, &whole, request.vertices);
		struct eco_holdings held = held_by(&b);
		struct body then = build(&b, &there, &held);
		read_all(&b, &then, there.vertices);
		assert_int_equal(b.chunks, 0);
		saved += whole.size > alone.size;
		assert_int_equal(whole.bytes[alone.size - ECO_END_FRAME_BYTES], whole.size > alone.size
			? ECO_FRAME_AHEAD : ECO_FRAME_END);
		/* a budget of bytes is the answer's first: it has the same steps */
		request.bytes = alone.size
			+ random_below(&b.pack->r, (uint32_t)(whole.size - alone.size) + 1);
		struct body tight = build(&b, &request, NULL);
		request.next.given = false;
		struct body without = build(&b, &request, NULL);
		assert_true(tight.fits && tight.size <= request.bytes && tight.steps == without.steps);
		bench_free(&b);
	}
	assert_true(saved > ROUNDS / 4);
}

UNIT_TEST(large_answers_come_coarse_first)
{
	uint32_t stepped = 0;
	for (uint64_t seed = 1; seed <= 6; seed++) {
		struct bench b = bench_make(400 + seed, 200);
		struct eco_request request = random_request(&b.pack->r);
		request.vertices = 50000;
		struct body body = build(&b, &request, NULL);
		read_all(&b, &body, request.vertices);
		stepped += body.steps > 1;
		/* with everything held, one plan says it all */
		struct eco_holdings held = held_by(&b);
		struct body again = build(&b, &request, &held);
		assert_int_equal(again.steps, 1);
		/* a byte budget of just this size keeps no step that would break it */
		request.bytes = body.size - 1;
		struct body tight = build(&b, &request, NULL);
		assert_true(tight.fits && tight.size <= request.bytes);
		bench_free(&b);
	}
	assert_true(stepped >= 3);
}

UNIT_TEST(limits_are_answers_not_crashes)
{
	struct bench b = bench_make(500, 100);
	struct eco_request request = random_request(&b.pack->r);
	struct srv_stream_input input = { .scene = &b.scene, .request = &request, .body_max = 1000 };
	struct srv_stream stream;
	atomic_bool cancelled = true;
	request.vertices = 100000;
	assert_code(srv_stream_plan(&stream, &input, &cause), ECO_TOO_LARGE, "at most 1000");
	input.cancelled = &cancelled;
	assert_code(srv_stream_plan(&stream, &input, &cause), ECO_INTERRUPTED, "");
	bench_free(&b);
}

UNIT_TEST(a_damaged_payload_is_named_and_the_rest_still_served)
{
	struct bench b = bench_make(501, 2);
	const struct eco_scene *scene = &b.pack->pack.scene;
	struct eco_request request = random_request(&b.pack->r);
	request.vertices = 1000000;
	struct srv_stream_input input = { .scene = &b.scene, .request = &request };
	struct srv_stream stream;
	struct srv_body body;
	for (uint32_t i = 0; i < scene->ground_count; i++)
		b.pack->map[scene->chunks[scene->lists[scene->ground[i].list].chunk_first].offset] ^= 1;
	assert_good(srv_stream_plan(&stream, &input, &cause));
	assert_code(srv_stream_write(&stream, &body, &cause), ECO_DAMAGED, "");
	assert_true(cause.text[0] != 0);
	srv_stream_free(&stream);
	const uint8_t *bytes;
	size_t size;
	assert_good(srv_scene_payload(&b.scene, 0, &bytes, &size, &cause));
	bench_free(&b);
}

