/* The cost of a request: counted work, bounded by that of an ordinary request to the scene. */
#include <stdio.h>
#include <string.h>

#include "server/exchange.h"
#include "server/stream.h"
#include "tests/support/serve/random_request.h"
#include "tests/support/serve/serve_daemon.h"

#define REQUESTS 400u
#define SCARCE 300000u           /* work that many plans of the sample exceed */
/* Tenths: nothing is begun any more at the bound, but what has begun ends: an answer at the coarsest level, a
 * price of bytes that fits; and three coarser answers come. */
#define OVER 15u

#define sample (store.scenes[0])

static uint64_t work_of(const struct eco_request *request, lod_rule *rule, bool explain, uint64_t work_max,
	bool *cut_short)
{
	struct srv_stream stream;
	assert_good(srv_stream_plan(&stream, &(struct srv_stream_input){ .scene = sample, .request = request,
		.rule = rule, .explain = explain, .work_max = work_max }, &cause));
	uint64_t work = stream.work;
	assert_true(!stream.fits || stream.body_bytes <= request->bytes);
	assert_true(stream.steps[stream.step_count - 1].plan.vertices <= request->vertices);
	*cut_short = stream.cut_short;
	srv_stream_free(&stream);
	return work;
}

/* Every third request says where its eye will be. */
static bool any_request(struct eco_request *request, uint64_t seed, uint64_t number)
{
	struct eco_request next;
	if (!random_request(request, &sample->pack->scene, seed, number))
		return false;
	if (number % 3 == 0 && random_request(&next, &sample->pack->scene, seed + 1, number)) {
		request->next.given = true;
		memcpy(request->next.eye, next.view.eye, sizeof request->next.eye);
		memcpy(request->next.target, next.view.target, sizeof request->next.target);
	}
	return true;
}

/* By either rule, within bytes or not, explained or not, with a next view or without. */
UNIT_TEST(no_request_costs_much_more_than_it_may)
{
	lod_rule *const rules[] = { NULL, lod_rule_deussen };
	uint64_t may = SCARCE, most = 0;
	uint32_t bounded = 0, cut = 0;
	for (uint32_t i = 0; i < 4 * REQUESTS; i++) {
		struct eco_request request;
		bool cut_short, free_cut, explain = i / 2 % 2;
		if (!any_request(&request, 9, i / 4))
			continue;
		uint64_t work = work_of(&request, rules[i % 2], explain, may, &cut_short);
		most = work > most ? work : most;
		cut += cut_short;
		if (cut_short)
			bounded += work_of(&request, rules[i % 2], explain, 0, &free_cut) > work && !free_cut;
	}
	print_message("          most: %.2f of what a request may cost; %u ended early\n",
		(double)most / (double)may, cut);
	assert_true(10 * most <= OVER * may);
	assert_true(bounded > 10);
}

/* Searches look at the flag, of whatever kind they are. */
UNIT_TEST(a_plan_that_nobody_waits_for_ends_soon)
{
	static const atomic_bool cancelled = true;
	lod_rule *const rules[] = { NULL, lod_rule_deussen };
	for (int r = 0; r < 2; r++) {
		uint64_t work[2] = { 0 };
		for (uint32_t i = 0; i < REQUESTS; i++) {
			struct eco_request request;
			if (!any_request(&request, 12, i))
				continue;
			for (int k = 0; k < 2; k++) {
				struct lod_planner_stats stats = { 0 };
				struct eco_error error = { 0 };
				struct eco_plan plan;
				enum eco_code code = lod_plan(&plan, &(struct lod_planner_input){
					.scene = &sample->pack->scene, .tables = sample->tables, .request = &request,
					.rule = rules[r], .cancelled = k ? &cancelled : NULL, .stats = &stats }, &error);
				assert_int_equal(code, k ? ECO_INTERRUPTED : ECO_OK);
				work[k] += stats.work;
				eco_plan_free(&plan);
			}
		}
		print_message("          %.2f of the work\n", (double)work[1] / (double)work[0]);
		assert_true(2 * work[1] < work[0]);
	}
}

/* An answer that was planned before its client left ends likewise. */
UNIT_TEST(an_answer_that_nobody_waits_for_is_not_written)
{
	static atomic_bool cancelled;
	struct eco_request request = { .view = { .eye = { 50, -30, 12 }, .target = { 50, 30, 2 },
		.up = { 0, 0, 1 }, .fov_y_deg = 45, .width = 800, .height = 600 },
		.bytes = ECO_BYTES_UNBOUNDED, .vertices = 100000 };
	struct srv_stream stream;
	struct srv_body body;
	struct srv_json json = { .cancelled = &cancelled };
	assert_good(srv_stream_plan(&stream, &(struct srv_stream_input){ .scene = sample, .request = &request,
		.explain = true, .cancelled = &cancelled }, &cause));
	atomic_store(&cancelled, true);
	assert_code(srv_stream_write(&stream, &body, &cause), ECO_INTERRUPTED, "");
	srv_describe_plan(&json, &stream);
	assert_in_range(json.out.size, 0, 100);
	assert_int_equal(srv_json_end(&json), ECO_INTERRUPTED);
	srv_stream_free(&stream);
}

/* Predicted Q of a request within a budget of bytes. */
static double q_within(struct eco_request request, uint64_t bytes)
{
	struct srv_stream stream;
	request.bytes = bytes;
	assert_good(srv_stream_plan(&stream, &(struct srv_stream_input){ .scene = sample, .request = &request,
		.work_max = SCARCE / 3 }, &cause));
	double q = eco_predicted_q(&stream.steps[stream.step_count - 1].plan.prediction);
	srv_stream_free(&stream);
	return q;
}

/* A level is too dear if more passes are expected of a search of prices than it takes: then a budget that is
 * never reached made plans coarser. A large answer shows something soon, even if its plan has no work left. */
UNIT_TEST(answers_use_bytes_and_come_in_steps)
{
	uint32_t asked = 0, worse = 0, large = 0;
	for (uint32_t i = 0; i < REQUESTS; i++) {
		struct srv_stream stream;
		struct eco_request request;
		if (!random_request(&request, &sample->pack->scene, 11, i))
			continue;
		asked++;
		worse += q_within(request, (uint64_t)1 << 40) < q_within(request, ECO_BYTES_UNBOUNDED) - 0.005;
		if (request.view.width < 100 || request.view.height < 100)
			continue;        /* where nothing is seen of most plants */
		request.bytes = ECO_BYTES_UNBOUNDED;
		assert_good(srv_stream_plan(&stream, &(struct srv_stream_input){ .scene = sample,
			.request = &request, .work_max = SCARCE / 3 }, &cause));
		if (stream.cut_short && stream.body_bytes > 60000) {
			large++;
			assert_true(stream.step_count > 1);
			assert_true(stream.steps[0].plan.vertices > 0);
		}
		srv_stream_free(&stream);
	}
	print_message("          worse: %u of %u; %u large answers\n", worse, asked, large);
	assert_true(asked > REQUESTS / 2 && 50 * worse <= asked && large > 10);
}

/* Bytes bind: a picture comes within SRV_FIRST_BYTES, and the answer is hardly worse for it. */
UNIT_TEST(a_first_picture_comes_early_within_a_byte_budget)
{
	uint32_t bound = 0, early = 0;
	double q[2] = { 0, 0 };
	for (uint32_t i = 0; i < REQUESTS; i++) {
		struct eco_request request;
		const struct eco_holdings none = { .items = &(struct eco_holding){ 0, 1 }, .count = 1 };
		struct srv_stream stream, plain;
		if (!random_request(&request, &sample->pack->scene, 13, i))
			continue;
		request.bytes = 4 * SRV_FIRST_BYTES;
		assert_good(srv_stream_plan(&stream, &(struct srv_stream_input){ .scene = sample,
			.request = &request }, &cause));
		/* who holds something has a picture */
		assert_good(srv_stream_plan(&plain, &(struct srv_stream_input){ .scene = sample, .request = &request,
			.holdings = &none }, &cause));
		assert_true(stream.fits && stream.body_bytes <= request.bytes);
		if (plain.body_bytes > request.bytes / 2 && plain.steps[plain.step_count - 1].plan.vertices > 100) {
			q[0] += eco_predicted_q(&stream.steps[stream.step_count - 1].plan.prediction);
			q[1] += eco_predicted_q(&plain.steps[plain.step_count - 1].plan.prediction);
			bound++;
			early += stream.steps[0].plan.vertices > 0 && stream.steps[0].end_bytes <= SRV_FIRST_BYTES;
			/* both together are within what is sent at most */
			struct srv_stream large;
			if (bound < 9)
				assert_code(srv_stream_plan(&large, &(struct srv_stream_input){ .scene = sample,
					.request = &request, .body_max = stream.body_bytes - 1 }, &cause), ECO_TOO_LARGE, "");
		}
		srv_stream_free(&stream);
		srv_stream_free(&plain);
	}
	print_message("          %u of %u within %u bytes; Q %.4f, without it %.4f\n", early, bound, SRV_FIRST_BYTES,
		q[0] / bound, q[1] / bound);
	assert_true(bound > 10 && 10 * early >= 9 * bound && q[0] > q[1] - 0.02 * bound);
}

UNIT_MAIN(serve_start, serve_stop)
