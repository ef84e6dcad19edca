/* Costs of random requests: processor time of each answer on one thread, and the work that it counts. The worst
 * of many should be a small multiple of the median.
 *
 *   costs [--each] [--deussen | --all] [--seed S] [--from NUMBER] [--times N] [--runs N] COUNT PACK...
 *
 * COUNT requests a pack. --times: a request may take N times the work of an ordinary one of the scene
 * (server/typical.h); default: any work. --runs: answers each N times and counts the least time. --deussen: plans
 * by that rule. --all: answers by either rule, as a stream or as JSON with or without explanations, with a next
 * view or without. Prints a line a pack; --each: before it a line a request with a hash of its plans, which is
 * the same for builds that plan the same. */
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <xxhash.h>

#include "ecofiles/base/random.h"
#include "ecofiles/format/wire.h"
#include "server/describe.h"
#include "server/typical.h"
#include "tests/support/serve/random_request.h"

#define SOMETHING 1000u                  /* vertices: half of all random requests see less */

#define JSON_MOST (64u << 20)            /* as a server's */
#define ALL_SEED 0x5bd1e995u             /* of the parameters that --all adds */

enum form { PLAN_ALONE, STREAM, JSON, JSON_EXPLAINED };
static const char *const form_names[] = { "plan", "stream", "json", "explained" };

struct run { uint64_t seed, from, count, times, runs; lod_rule *rule; bool each, all; };
struct cost { uint64_t number; double ms, q; uint64_t work, vertices, hash, bytes; uint32_t steps; };
struct question { struct eco_request request; lod_rule *rule; enum form form; };

static double processor_ms(void)
{
	struct timespec now;
	clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
	return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

static int by_ms(const void *a, const void *b)
{
	double x = ((const struct cost *)a)->ms, y = ((const struct cost *)b)->ms;
	return (x > y) - (x < y);
}

static uint64_t hash_of_plans(const struct srv_stream *stream)
{
	struct eco_writer bytes = { 0 };
	for (uint32_t i = 0; i < stream->step_count; i++)
		eco_wire_write_plan(&bytes, &stream->steps[i].plan);
	uint64_t hash = XXH3_64bits(bytes.bytes, bytes.size);
	eco_writer_free(&bytes);
	return hash;
}

static void print_request(const struct question *question, const struct cost *cost,
	const struct srv_stream *stream)
{
	const struct eco_request *request = &question->request;
	printf("%10.3f ms %9llu work %llu  %ux%u vertices=%llu bytes=%lld: %llu vertices, %u steps, "
		"plans %016llx, %s%s%s, %llu bytes\n", cost->ms, (unsigned long long)cost->work,
		(unsigned long long)cost->number, request->view.width, request->view.height,
		(unsigned long long)request->vertices,
		request->bytes == ECO_BYTES_UNBOUNDED ? -1 : (long long)request->bytes,
		(unsigned long long)cost->vertices, stream->step_count, (unsigned long long)cost->hash,
		form_names[question->form], question->rule ? ", deussen" : "",
		request->next.given ? ", ahead" : "", (unsigned long long)cost->bytes);
}

static enum eco_code answer_json(struct srv_stream *stream, struct cost *cost)
{
	struct srv_json json = { .most = JSON_MOST };
	srv_describe_plan(&json, stream);
	cost->bytes = json.out.size;
	enum eco_code code = srv_json_end(&json);
	eco_writer_free(&json.out);
	return code;
}

static enum eco_code answer(struct srv_stream *stream, enum form form, struct cost *cost, struct eco_error *error)
{
	struct srv_body body;
	if (form == JSON || form == JSON_EXPLAINED)
		return answer_json(stream, cost);
	if (form == PLAN_ALONE || !stream->fits)
		return ECO_OK;
	enum eco_code code = srv_stream_write(stream, &body, error);
	cost->bytes = code ? 0 : body.size_bytes;
	if (!code)
		srv_body_free(&body);
	return code;
}

/* An answer that is refused for its size costs what it takes to find that out. */
static void answer_once(struct srv_stream *stream, const struct srv_stream_input *input, enum form form,
	struct cost *cost)
{
	struct eco_error error = { 0 };
	double begun = processor_ms();
	if (srv_stream_plan(stream, input, &error))
		random_stop("planning", &error);
	enum eco_code code = answer(stream, form, cost, &error);
	if (code && code != ECO_TOO_LARGE)
		random_stop("answering", &error);
	double ms = processor_ms() - begun;
	cost->ms = cost->ms > 0 && cost->ms < ms ? cost->ms : ms;
}

/* A rule, a form and a next view, by the request's number. */
static void add_parameters(struct question *question, const struct eco_scene *scene, uint64_t seed,
	uint64_t number)
{
	uint64_t dice = eco_random(seed ^ ALL_SEED, number);
	struct eco_view next = question->request.view;
	struct eco_request other;
	question->rule = dice % 2 ? lod_rule_deussen : NULL;
	question->form = STREAM + dice / 2 % 3;
	if (dice / 8 % 4 != 0)
		return;
	if (dice / 32 % 2) {
		for (int i = 0; i < 3; i++)
			next.eye[i] += 0.1 * (next.target[i] - next.eye[i]);
	} else if (random_request(&other, scene, seed ^ ALL_SEED, number)) {
		memcpy(next.eye, other.view.eye, sizeof next.eye);
		memcpy(next.target, other.view.target, sizeof next.target);
	}
	if (eco_view_check(&next, NULL))
		return;
	question->request.next.given = true;
	memcpy(question->request.next.eye, next.eye, sizeof next.eye);
	memcpy(question->request.next.target, next.target, sizeof next.target);
}

/* False where the request layer refuses the view. */
static bool one_request(const struct srv_scene *scene, uint64_t number, uint64_t work_max,
	const struct run *run, struct cost *cost)
{
	struct question question = { .rule = run->rule, .form = PLAN_ALONE };
	struct srv_stream stream;
	if (!random_request(&question.request, &scene->pack->scene, run->seed, number))
		return false;
	if (run->all)
		add_parameters(&question, &scene->pack->scene, run->seed, number);
	const struct srv_stream_input input = { .scene = scene, .request = &question.request,
		.rule = question.rule, .explain = question.form == JSON_EXPLAINED, .work_max = work_max };
	*cost = (struct cost){ .number = number };
	for (uint64_t i = 1; i < run->runs; i++) {
		answer_once(&stream, &input, question.form, cost);
		srv_stream_free(&stream);
	}
	answer_once(&stream, &input, question.form, cost);
	const struct srv_step *last = &stream.steps[stream.step_count - 1];
	cost->work = stream.work;
	cost->q = eco_predicted_q(&last->plan.prediction);
	cost->vertices = last->plan.vertices;
	cost->steps = stream.step_count;
	cost->hash = run->each ? hash_of_plans(&stream) : 0;
	if (run->each)
		print_request(&question, cost, &stream);
	srv_stream_free(&stream);
	return true;
}

/* The median of the sorted costs of requests that draw so many vertices; NAN: none does. */
static double median_ms(const struct cost *costs, uint64_t count, uint64_t vertices, uint64_t *drawing)
{
	uint64_t seen = 0, i = 0;
	*drawing = 0;
	for (uint64_t k = 0; k < count; k++)
		*drawing += costs[k].vertices >= vertices;
	for (; i < count && seen <= *drawing / 2; i++)
		seen += costs[i].vertices >= vertices;
	return *drawing ? costs[i - 1].ms : NAN;
}

static void print_costs(const char *path, struct cost *costs, uint64_t count, uint64_t work_max)
{
	const char *slash = strrchr(path, '/');
	double q = 0, steps = 0;
	for (uint64_t i = 0; i < count; i++) {
		q += costs[i].q / (double)count;
		steps += (double)costs[i].steps / (double)count;
	}
	qsort(costs, count, sizeof *costs, by_ms);
	const struct cost *worst = &costs[count - 1];
	uint64_t drawing;
	double median = costs[count / 2].ms, busy = median_ms(costs, count, SOMETHING, &drawing);
	printf("%s: %llu requests; CPU median %.3f ms, p90 %.3f, p99 %.3f, worst %.3f (request %llu), "
		"%.1f x the median; mean Q predicted %.4f, in %.2f steps; %llu "
		"draw %u vertices or more, their median %.3f ms, the worst %.1f times that; each may take %llu work\n", slash ? slash + 1 : path,
		(unsigned long long)count, median, costs[count * 9 / 10].ms, costs[count * 99 / 100].ms,
		worst->ms, (unsigned long long)worst->number, worst->ms / median, q, steps,
		(unsigned long long)drawing, SOMETHING, busy, worst->ms / busy, (unsigned long long)work_max);
	fflush(stdout);
}

static void run_pack(const char *path, const struct run *run)
{
	struct srv_store scenes;
	struct eco_error error = { 0 };
	struct cost *costs = malloc((run->count + 1) * sizeof *costs);
	uint64_t made = 0;
	srv_store_init(&scenes);
	if (!costs || srv_store_add(&scenes, "scene", path, &error))
		random_stop(path, &error);
	uint64_t work_max = run->times ? run->times * srv_typical_work(scenes.scenes[0]) : 0;
	for (uint64_t number = run->from; made < run->count; number++)
		made += one_request(scenes.scenes[0], number, work_max, run, &costs[made]);
	print_costs(path, costs, made, work_max);
	srv_store_free(&scenes);
	free(costs);
}

int main(int argc, char **argv)
{
	static const struct option options[] = { { "each", no_argument, NULL, 'e' }, { "all", no_argument, NULL, 'a' },
		{ "deussen", no_argument, NULL, 'd' }, { "seed", required_argument, NULL, 's' },
		{ "from", required_argument, NULL, 'f' }, { "times", required_argument, NULL, 't' },
		{ "runs", required_argument, NULL, 'r' },
		{ NULL, 0, NULL, 0 } };
	struct run run = { .seed = 1, .runs = 1 };
	bool usable = true;
	for (int c; (c = getopt_long(argc, argv, "", options, NULL)) != -1;) {
		uint64_t value = optarg ? strtoull(optarg, NULL, 10) : 0;
		usable = usable && c != '?';
		run.each = run.each || c == 'e';
		run.all = run.all || c == 'a';
		run.rule = c == 'd' ? lod_rule_deussen : run.rule;
		run.seed = c == 's' ? value : run.seed;
		run.from = c == 'f' ? value : run.from;
		run.times = c == 't' ? value : run.times;
		run.runs = c == 'r' && value ? value : run.runs;
	}
	run.count = argc - optind >= 2 ? strtoull(argv[optind], NULL, 10) : 0;
	if (!usable || !run.count) {
		fputs("usage: costs [--each] [--deussen | --all] [--seed S] [--from NUMBER] [--times N] "
			"[--runs N] COUNT PACK...\n", stderr);
		return 2;
	}
	for (int i = optind + 1; i < argc; i++)
		run_pack(argv[i], &run);
	return 0;
}
