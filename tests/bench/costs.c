/* What random requests cost: the processor time of the plan of each, on one thread, and the work that it
 * counts. A request's cost is bounded where the worst of many is a small multiple of the median.
 *
 *   costs [--each] [--deussen] [--seed S] [--from NUMBER] [--times N] COUNT PACK...
 *
 * COUNT requests a pack. --times: one may take so much of the work that an ordinary one of the scene does
 * (server/typical.h); else any. --deussen: by that rule. Prints a line a pack; with --each one a request
 * before it, for sort. */
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "server/typical.h"
#include "tests/support/random_request.h"

#define SOMETHING 1000u                  /* vertices: half of all random requests see less */

struct run { uint64_t seed, from, count, times; lod_rule *rule; bool each; };
struct cost { uint64_t number; double ms, q; uint64_t work, vertices; uint32_t steps; };

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

static void print_request(const struct eco_request *request, const struct cost *cost,
	const struct srv_stream *stream)
{
	printf("%10.3f ms %9llu work %llu  %ux%u vertices=%llu bytes=%lld: %llu vertices, %u steps\n",
		cost->ms, (unsigned long long)cost->work, (unsigned long long)cost->number,
		request->view.width, request->view.height, (unsigned long long)request->vertices,
		request->bytes == ECO_BYTES_UNBOUNDED ? -1 : (long long)request->bytes,
		(unsigned long long)cost->vertices, stream->step_count);
}

/* False where the request layer refuses the view. */
static bool one_request(const struct srv_scene *scene, uint64_t number, uint64_t work_max,
	const struct run *run, struct cost *cost)
{
	struct eco_request request;
	struct srv_stream stream;
	struct eco_error error = { 0 };
	if (!random_request(&request, &scene->pack->scene, run->seed, number))
		return false;
	double begun = processor_ms();
	if (srv_stream_plan(&stream, &(struct srv_stream_input){ .scene = scene, .request = &request,
			.rule = run->rule, .work_max = work_max }, &error))
		random_stop("planning", &error);
	*cost = (struct cost){ .number = number, .ms = processor_ms() - begun, .work = stream.work,
		.q = eco_predicted_q(&stream.steps[stream.step_count - 1].plan.prediction),
		.vertices = stream.steps[stream.step_count - 1].plan.vertices, .steps = stream.step_count };
	if (run->each)
		print_request(&request, cost, &stream);
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

static void print_costs(const char *path, struct cost *costs, uint64_t count)
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
	printf("%s: %llu requests; plan CPU median %.3f ms, p90 %.3f, p99 %.3f, worst %.3f (request %llu), "
		"%.1f x the median; mean Q predicted %.4f, in %.2f steps; %llu "
		"draw %u vertices or more, their median %.3f ms, the worst %.1f times that\n", slash ? slash + 1 : path,
		(unsigned long long)count, median, costs[count * 9 / 10].ms, costs[count * 99 / 100].ms,
		worst->ms, (unsigned long long)worst->number, worst->ms / median, q, steps,
		(unsigned long long)drawing, SOMETHING, busy, worst->ms / busy);
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
	print_costs(path, costs, made);
	srv_store_free(&scenes);
	free(costs);
}

int main(int argc, char **argv)
{
	static const struct option options[] = { { "each", no_argument, NULL, 'e' },
		{ "deussen", no_argument, NULL, 'd' }, { "seed", required_argument, NULL, 's' },
		{ "from", required_argument, NULL, 'f' }, { "times", required_argument, NULL, 't' },
		{ NULL, 0, NULL, 0 } };
	struct run run = { .seed = 1 };
	bool usable = true;
	for (int c; (c = getopt_long(argc, argv, "", options, NULL)) != -1;) {
		uint64_t value = optarg ? strtoull(optarg, NULL, 10) : 0;
		usable = usable && c != '?';
		run.each = run.each || c == 'e';
		run.rule = c == 'd' ? lod_rule_deussen : run.rule;
		run.seed = c == 's' ? value : run.seed;
		run.from = c == 'f' ? value : run.from;
		run.times = c == 't' ? value : run.times;
	}
	run.count = argc - optind >= 2 ? strtoull(argv[optind], NULL, 10) : 0;
	if (!usable || !run.count) {
		fputs("usage: costs [--each] [--deussen] [--seed S] [--from NUMBER] [--times N] COUNT "
			"PACK...\n", stderr);
		return 2;
	}
	for (int i = optind + 1; i < argc; i++)
		run_pack(argv[i], &run);
	return 0;
}
