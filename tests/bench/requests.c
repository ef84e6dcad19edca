/* Random views and budgets against packs, through everything but the socket: plan, stream, parse, decode,
 * select. These rules hold for any request:
 *
 *   vertices     in every state of a stream the client draws as many vertices as planned, within the budget
 *   bytes        the body is within its budget
 *   twice        no chunk is sent to a client that holds it
 *   undrawn      an answer that draws nothing brings chunks of its ground only; a budget of bytes in which
 *                some answer draws something has no answer that draws nothing
 *   same         the same request has the same answer
 *   rises        more vertices hardly ever leave more wrong, by the errors that are seen
 *   unused       budget is left over only where it buys nothing: no remaining step that gains is as cheap,
 *                and no better plan of a greater budget fits
 *   whole        next to nothing is expected to be wrong where every plant in view is drawn whole
 *   senseless    predictions are finite and not negative, errors do not exceed the picture
 *
 *   requests [--seed S] [--only NUMBER] [--times N] COUNT PACK...
 *
 * COUNT requests, shared among the packs. --times: a plan may take N times the work of an ordinary one of the
 * scene (server/stream.h); default: any work.
 *
 * Prints a JSON object for each pack and describes the first violations. Exit 1 if there was one. */
#include <getopt.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "client-min/view_query.h"
#include "client-min/view_select.h"
#include "ecofiles/base/order.h"
#include "lod/plan/planner.h"
#include "server/stream.h"
#include "tests/support/serve/random_request.h"

enum violation { OVER_VERTICES, OVER_BYTES, SENT_TWICE, UNDRAWN, NOT_SAME, RISES, UNUSED, WHOLE, SENSELESS,
	FAILED,
VIOLATION_COUNT };
static const char *const violation_names[] = { "vertices", "bytes", "twice", "undrawn", "same", "rises",
	"unused", "whole", "senseless", "failed" };

#define CLIENT_EVERY 500         /* a new client now and then, so that both full and empty hands are tried */
#define TWICE_EVERY 10
#define CHAIN_EVERY 4            /* planning for many budgets takes its time */
#define CHAIN 10u
#define FEW_EVERY 4              /* first visits within few bytes */
#define FEW_VERTICES 3000u       /* of an answer whose bytes these are, at most */
#define DESCRIBED_MOST 8
/* A plan may be worse than another that fits by this share of what is wrong with nothing drawn. Plants of one
 * hash cannot be told apart, and the rest of a budget is spent on the next step, however little of it fits.
 */
#define WORSE_MOST 0.01
/* From one budget to a greater one, at one level of tiles, since others expect other errors: where all vertices are
 * asked for, plants are drawn that expect more to be wrong than the summary does in their place. */
#define RISE_MOST 0.1
#define RISE_PIXELS 4
#define WHOLE_MOST 0.05          /* of the pixels that are covered, and one more */

struct run {
	const struct srv_scene *scene;
	const char *pack;
	unsigned long long seed, number;     /* of the request at hand */
	uint64_t work_max;           /* of a plan; 0: any */
	struct eco_request request;
	struct view_store *store;
	bool *came;                  /* per list: a chunk of it came with the last answer */
	unsigned long long count[VIOLATION_COUNT], requests, refused, empty, states, chains, few, described;
	/* share of a budget that was left over while something was to be gained */
	double unused_most;
};

/* ---- What went wrong ---- */

static void violated(struct run *run, enum violation what, const char *format,
	...) __attribute__((format(printf, 3, 4)));
static void violated(struct run *run, enum violation what, const char *format, ...)
{
	char query[VIEW_QUERY_BYTES];
	va_list args;
	run->count[what]++;
	if (run->described++ >= DESCRIBED_MOST)
		return;
	fprintf(stderr, "%s: %s: ", run->pack, violation_names[what]);
	va_start(args, format);
	vfprintf(stderr, format, args);
	va_end(args);
	view_query_write(&run->request, NULL, query, sizeof query);
	fprintf(stderr, "\n    --seed %llu --only %llu: %s\n", run->seed, run->number, query);
}

/* ---- A stream, state by state ---- */

static void check_state(struct run *run)
{
	struct lod_eye eye;
	struct view_selection selection;
	struct eco_error error = { 0 };
	const struct eco_plan *plan = view_store_plan(run->store);
	lod_eye_make(&eye, &run->request.view);
	if (view_select_make(&selection, run->store, &eye, &error)) {
		violated(run, FAILED, "the client cannot draw it: %s", error.text);
		return;
	}
	run->states++;
	if (selection.vertices > run->request.vertices)
		violated(run, OVER_VERTICES, "%llu vertices drawn", (unsigned long long)selection.vertices);
	if (plan && selection.vertices != plan->vertices)
		violated(run, OVER_VERTICES, "%llu vertices drawn, %llu planned",
			(unsigned long long)selection.vertices, (unsigned long long)plan->vertices);
	view_select_free(&selection);
}

/* The store takes all events of a parser; two of them are checked for this run. */
static struct run *receiving;

static enum eco_code on_plan(void *store, struct eco_plan *plan, struct eco_error *error)
{
	enum eco_code code = view_store_events.plan(store, plan, error);
	if (!code)
		check_state(receiving);
	return code;
}

static enum eco_code on_chunk(void *store, uint32_t list, uint32_t ordinal, const struct eco_chunk *chunk,
	const uint8_t *payload, struct eco_error *error)
{
	if (list < receiving->scene->pack->scene.list_count)
		receiving->came[list] = true;
	return view_store_events.chunk(store, list, ordinal, chunk, payload, error);
}

/* Its ground has cuts, too. */
static void check_came(struct run *run)
{
	const struct eco_plan *plan = view_store_plan(run->store);
	if (!plan || plan->vertices)
		return;
	for (uint32_t i = 0; i < plan->cut_count; i++)
		run->came[plan->cuts[i].list] = false;
	for (uint32_t list = 0; list < run->scene->pack->scene.list_count; list++)
		if (run->came[list]) {
			violated(run, UNDRAWN, "chunks of list %u come, and nothing is drawn", list);
			return;
		}
}

static bool receive(struct run *run, const struct srv_body *body)
{
	struct eco_wire_events events = view_store_events;
	struct eco_wire_parser *parser;
	struct eco_error error = { 0 };
	events.plan = on_plan;
	events.chunk = on_chunk;
	receiving = run;
	view_store_begin(run->store);
	memset(run->came, false, run->scene->pack->scene.list_count);
	if (eco_wire_parser_new(&parser, &events, run->store, &error))
		random_stop("parser", &error);
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < body->piece_count && !code; i++)
		code = eco_wire_feed(parser, body->pieces[i].bytes, body->pieces[i].size, &error);
	if (!code)
		code = eco_wire_finish(parser, &error);
	eco_wire_parser_free(parser);
	if (code)
		violated(run, FAILED, "%s", error.text);
	else
		check_came(run);
	return !code;
}

static uint64_t body_hash(const struct srv_body *body)
{
	XXH3_state_t *hash = XXH3_createState();
	XXH3_64bits_reset(hash);
	for (uint32_t i = 0; i < body->piece_count; i++)
		XXH3_64bits_update(hash, body->pieces[i].bytes, body->pieces[i].size);
	uint64_t h = XXH3_64bits_digest(hash);
	XXH3_freeState(hash);
	return h;
}

static void new_client(struct run *run)
{
	struct eco_error error = { 0 };
	if (run->store && view_store_stats(run->store).chunks_twice)
		violated(run, SENT_TWICE, "%llu chunks of one of the requests before",
			(unsigned long long)view_store_stats(run->store).chunks_twice);
	view_store_free(run->store);
	run->store = NULL;
	if (view_store_new(&run->store, &(struct view_store_options){ 0 }, &error))
		random_stop("store", &error);
}

static void check_stream(struct run *run)
{
	struct eco_holdings holdings;
	struct eco_error error = { 0 };
	struct srv_body body, again;
	if (view_store_holdings(run->store, &holdings, &error))
		random_stop("holdings", &error);
	bool fits = random_answer(run->scene, &run->request, &holdings, run->work_max, &body);
	if (run->number % TWICE_EVERY == 0) {
		bool also = random_answer(run->scene, &run->request, &holdings, run->work_max,
			&again);
		if (also != fits || (fits && body_hash(&body) != body_hash(&again)))
			violated(run, NOT_SAME, "another answer the second time");
		srv_body_free(&again);
	}
	free(holdings.items);
	run->empty += !fits;
	if (fits && body.size_bytes > run->request.bytes)
		violated(run, OVER_BYTES, "%llu bytes", (unsigned long long)body.size_bytes);
	/* a client that has refused a stream cannot be trusted with the next */
	if (fits && !receive(run, &body))
		new_client(run);
	else if (fits && !view_store_complete(run->store))
		violated(run, FAILED, "the stream ends before its end");
	srv_body_free(&body);
}

/* ---- One view, few bytes ---- */

/* Plans the answer to a first visit; returns its bytes. `nothing`: it fits and draws nothing. */
static uint64_t plan_visit(struct run *run, bool *nothing)
{
	const struct srv_stream_input input = { .scene = run->scene, .request = &run->request,
		.work_max = run->work_max };
	struct srv_stream stream;
	struct eco_error error = { 0 };
	*nothing = false;
	if (srv_stream_plan(&stream, &input, &error)) {
		violated(run, FAILED, "%s", error.text);
		return 0;
	}
	const struct srv_step *last = &stream.steps[stream.step_count - 1];
	const uint64_t bytes = stream.body_bytes, chunks = stream.chunk_bytes, needed = last->missing_bytes;
	*nothing = stream.fits && !last->plan.vertices;
	if (*nothing && chunks > needed)
		violated(run, UNDRAWN, "%llu bytes of chunks, %llu of them for the ground, and nothing drawn",
			(unsigned long long)chunks, (unsigned long long)needed);
	srv_stream_free(&stream);
	return bytes;
}

/* As many bytes as few vertices take are enough for some of many. */
static void check_few(struct run *run)
{
	const struct eco_request asked = run->request;
	struct dice r = { run->seed + run->number };
	bool nothing;
	run->few++;
	run->request.view = random_outlook(&run->scene->pack->scene, run->seed, run->number);
	run->request.ground_px = 0;
	run->request.bytes = ECO_BYTES_UNBOUNDED;
	run->request.vertices = 1 + dice_bits(&r) % FEW_VERTICES;
	uint64_t bytes = plan_visit(run, &nothing), few = run->request.vertices;
	bool empty = nothing || !bytes;
	run->request.vertices = (uint64_t)dice_power(&r, 3.5, 6.5);
	run->request.bytes = bytes + dice_bits(&r) % (bytes + 1);
	plan_visit(run, &nothing);
	if (!empty && nothing)
		violated(run, UNDRAWN, "nothing drawn in as many bytes as %llu vertices take",
			(unsigned long long)few);
	run->request = asked;
}

/* ---- One view, many budgets ---- */

struct rung { unsigned long long budget, vertices; double right, wrong; bool summed;
	struct lod_planner_stats stats; };

ECO_ORDER(by_budget, struct rung, ->budget)

static bool plan_rung(struct run *run, struct rung *rung)
{
	struct eco_request request = run->request;
	struct eco_plan plan;
	struct eco_error error = { 0 };
	request.vertices = rung->budget;
	request.bytes = ECO_BYTES_UNBOUNDED;
	if (lod_plan(&plan,
			&(struct lod_planner_input){ .scene = &run->scene->pack->scene,
			.tables = run->scene->tables, .request = &request,
			.work_max = run->work_max, .stats = &rung->stats }, &error)) {
		violated(run, FAILED, "at %llu vertices: %s", rung->budget, error.text);
		return false;
	}
	const struct eco_prediction *p = &plan.prediction;
	double pixels = (double)request.view.width * request.view.height;
	rung->vertices = plan.vertices;
	rung->right = p->tp;
	rung->wrong = p->fp + p->fn;
	for (uint32_t i = 0; i < plan.cut_count; i++)
		rung->summed = rung->summed || plan.cuts[i].anchor == ECO_NONE;
	if (plan.vertices > rung->budget)
		violated(run, OVER_VERTICES, "%llu vertices planned for %llu",
			(unsigned long long)plan.vertices, rung->budget);
	if (!(p->tp >= 0 && p->fp >= 0 && p->fn >= 0 && p->tp + p->fn <= pixels * (1 + 1e-6)
			&& p->fp <= pixels * (1 + 1e-6)))
		violated(run, SENSELESS, "at %llu vertices %g right, %g too many, %g missing of %g pixels",
			rung->budget, p->tp, p->fp, p->fn, pixels);
	eco_plan_free(&plan);
	return true;
}

/* From nothing to everything, and some close together above the request's own, where what is left over would
 * have found a use. */
static void choose_budgets(const struct run *run, struct rung rungs[CHAIN])
{
	struct dice r = { run->seed + run->number };
	uint64_t own = run->request.vertices < ECO_VERTICES_MAX / 4 ? run->request.vertices
		: (uint64_t)dice_power(&r, 0, 7);
	const uint64_t chosen[CHAIN] = { 0, own, own + 1, own + 2 + dice_bits(&r) % 8, own + own / 64 + 1,
		own + own / 8 + 3, 2 * own + 4, (uint64_t)dice_power(&r, 0, 8),
		(uint64_t)dice_power(&r, 2, 6), ECO_VERTICES_MAX };
	for (uint32_t i = 0; i < CHAIN; i++)
		rungs[i] = (struct rung){ .budget = chosen[i] };
	qsort(rungs, CHAIN, sizeof *rungs, by_budget);
}

static void check_unused(struct run *run, const struct rung *rungs, uint32_t i)
{
	const struct rung *rung = &rungs[i];
	uint64_t left = rung->budget - rung->vertices;
	if (left >= rung->stats.cheapest)
		violated(run, UNUSED, "%llu of %llu vertices left over, the cheapest step takes %llu",
			(unsigned long long)left, rung->budget,
			(unsigned long long)rung->stats.cheapest);
	if (left > 0 && rung->stats.cheapest != UINT64_MAX)
		run->unused_most = fmax(run->unused_most, (double)left / (double)rung->budget);
	for (uint32_t k = i + 1; rung->stats.level == rungs[0].stats.level && k < CHAIN; k++)
		if (rungs[k].stats.level == rungs[0].stats.level && rungs[k].vertices <= rung->budget
			&& rungs[k].stats.wrong < rung->stats.wrong - WORSE_MOST * rungs[0].stats.wrong) {
			violated(run, UNUSED, "%g wrong pixels at a budget of %llu, %g at %llu with %llu "
				"vertices", rung->stats.wrong, rung->budget,
				rungs[k].stats.wrong, rungs[k].budget,
				rungs[k].vertices);
			return;
		}
}

static void check_chain(struct run *run)
{
	struct rung rungs[CHAIN];
	choose_budgets(run, rungs);
	run->chains++;
	for (uint32_t i = 0; i < CHAIN; i++)
		if (!plan_rung(run, &rungs[i]))
			return;
	for (uint32_t i = 0; i < CHAIN; i++) {
		if (i > 0 && rungs[i].stats.level == rungs[i - 1].stats.level
			&& rungs[i].stats.wrong > rungs[i - 1].stats.wrong + RISE_MOST * rungs[0].stats.wrong + RISE_PIXELS)
			violated(run, RISES, "%g wrong pixels at %llu vertices, %g at %llu, of %g", rungs[i - 1].stats.wrong,
				rungs[i - 1].budget, rungs[i].stats.wrong, rungs[i].budget, rungs[0].stats.wrong);
		check_unused(run, rungs, i);
	}
	const struct rung *all = &rungs[CHAIN - 1];
	if (!all->summed && all->wrong > 1 + WHOLE_MOST * (all->right + all->wrong))
		violated(run, WHOLE, "of %g pixels %g expected to be wrong with all there is",
			all->right + all->wrong, all->wrong);
}

/* ---- All ---- */

static void one_request(struct run *run)
{
	run->requests++;
	if (!random_request(&run->request, &run->scene->pack->scene, run->seed, run->number)) {
		run->refused++;
		return;
	}
	check_stream(run);
	if (run->number % CHAIN_EVERY == 0)
		check_chain(run);
	if (run->number % FEW_EVERY == 1)
		check_few(run);
}

static unsigned long long sum_of(const struct run *run)
{
	unsigned long long sum = 0;
	for (int i = 0; i < VIOLATION_COUNT; i++)
		sum += run->count[i];
	return sum;
}

static void print_run(const struct run *run)
{
	const char *slash = strrchr(run->pack, '/');
	printf("{\"pack\": \"%s\", \"requests\": %llu, \"refused\": %llu, \"empty\": %llu, \"states\": %llu, "
		"\"chains\": %llu, \"few\": %llu, \"unused_most\": %.6f, \"violations\": %llu",
		slash ? slash + 1 : run->pack, run->requests, run->refused, run->empty, run->states,
		run->chains, run->few, run->unused_most, sum_of(run));
	for (int i = 0; i < VIOLATION_COUNT; i++)
		printf(", \"%s\": %llu", violation_names[i], run->count[i]);
	puts("}");
	fflush(stdout);
}

static uint64_t run_pack(const char *path, uint64_t first, uint64_t count, const struct run *as)
{
	struct run run = *as;
	struct srv_store scenes;
	struct eco_error error = { 0 };
	srv_store_init(&scenes);
	if (srv_store_add(&scenes, "scene", path, &error))
		random_stop(path, &error);
	run.pack = path;
	run.scene = scenes.scenes[0];
	run.came = calloc(run.scene->pack->scene.list_count + 1u, sizeof *run.came);
	if (!run.came)
		random_stop(path, &(struct eco_error){ .text = "no memory" });
	run.work_max *= run.work_max ? srv_typical_find(scenes.scenes[0], NULL) : 0;
	for (uint64_t i = 0; i < count; i++) {
		if (i % CLIENT_EVERY == 0)
			new_client(&run);
		run.number = first + i;
		one_request(&run);
	}
	new_client(&run);
	view_store_free(run.store);
	free(run.came);
	print_run(&run);
	srv_store_free(&scenes);
	return sum_of(&run);
}

int main(int argc, char **argv)
{
	static const struct option options[] = { { "seed", required_argument, NULL, 's' },
		{ "only", required_argument, NULL, 'o' }, { "times", required_argument, NULL, 't' },
		{ NULL, 0, NULL, 0 } };
	struct run run = { .seed = 1 };
	uint64_t only = UINT64_MAX, violations = 0;
	bool usable = true;
	for (int c; (c = getopt_long(argc, argv, "", options, NULL)) != -1;) {
		usable = usable && c != '?';
		run.seed = c == 's' ? strtoull(optarg, NULL, 10) : run.seed;
		run.work_max = c == 't' ? strtoull(optarg, NULL, 10) : run.work_max;
		only = c == 'o' ? strtoull(optarg, NULL, 10) : only;
	}
	int packs = argc - optind - 1;
	if (!usable || packs < 1) {
		fputs("usage: requests [--seed S] [--only NUMBER] [--times N] COUNT PACK...\n",
			stderr);
		return 2;
	}
	uint64_t count = strtoull(argv[optind], NULL, 10);
	for (int i = 0; i < packs; i++) {
		uint64_t share = count / (uint64_t)packs + ((uint64_t)i < count % (uint64_t)packs);
		violations += only == UINT64_MAX ? run_pack(argv[optind + 1 + i], 0, share, &run)
			: run_pack(argv[optind + 1 + i], only, 1, &run);
	}
	return violations ? 1 : 0;
}
