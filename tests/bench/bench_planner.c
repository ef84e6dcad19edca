/* Time of the planner on large scenes. (The section frames: its prediction; rules: beside Deussen's rule;
 * tests/bench/test_best.c: beside the best there is, on small scenes.) */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_store.h"
#include "ecofiles/format/pack.h"
#include "tests/bench/bench_shots.h"

static const char *const scenes[] = { "scbi", "trees5000", "outdoor" };
#define SCENES (sizeof scenes / sizeof *scenes)

#define REPETITIONS_MAX 200u
#define REPETITIONS_LEAST 3u

double bench_plan_time(struct lod_planner_stats *stats, struct eco_plan *plan, const struct eco_scene *scene,
	const struct eco_request *request, double least_ms)
{
	double ms[REPETITIONS_MAX], sum = 0;
	struct lod_planner_input input = { .scene = scene, .request = request, .stats = stats };
	uint32_t count = 0;
	*plan = (struct eco_plan){ 0 };
	must(lod_plan_tables_make(&input.tables, scene, must_error));
	while (count < REPETITIONS_LEAST || (count < REPETITIONS_MAX && sum < least_ms)) {
		double from = view_clock_ms();
		eco_plan_free(plan);
		must(lod_plan(plan, &input, must_error));
		sum += ms[count++] = view_clock_ms() - from;
	}
	lod_plan_tables_free(input.tables);
	return bench_median(ms, count);
}

/* Plans of 1,000,000 vertices: returns the middle of up to three views; *gains: the most for a cut. */
static double time_scene(struct bench *bench, const char *scene, const char *path, struct bench_table *table,
	double *gains)
{
	struct eco_request requests[3];
	struct eco_pack *pack = NULL;
	double all[3] = { NAN, NAN, NAN };
	uint32_t views = bench_scene_views(bench, scene, requests, 3);
	must(eco_pack_open(&pack, path, must_error));
	for (uint32_t v = 0; v < views; v++) {
		struct lod_planner_stats stats = { 0 };
		struct eco_plan plan;
		requests[v].vertices = 1000000;
		all[v] = bench_plan_time(&stats, &plan, &pack->scene, &requests[v], 500);
		double per_cut = (double)stats.gains / plan.cut_count;
		*gains = fmax(*gains, per_cut);
		bench_table_row(table, "%s,%u,%.3f,%llu,%u,%llu,%.2f,%llu,%llu,%llu", scene, v, all[v],
			(unsigned long long)stats.candidates, plan.cut_count, (unsigned long long)stats.gains,
			per_cut, (unsigned long long)stats.looks, (unsigned long long)stats.places,
			(unsigned long long)plan.vertices);
		eco_plan_free(&plan);
	}
	eco_pack_close(pack);
	return fmax(fmin(all[0], all[1]), fmin(fmax(all[0], all[1]), all[2]));
}

static void run(struct bench *bench)
{
	double gains = NAN, trees = NAN;
	char pack[512];
	struct bench_table *table = bench_table_open(bench, "planner_times",
		"scene,view,ms,candidates,cuts,gains computed,gains over cuts,looks at a "
		"price,plants looked at,vertices", true);
	for (size_t i = 0; i < SCENES; i++) {
		bench_progress((double)i / SCENES, scenes[i]);
		bool asked = bench_scene_there(bench, scenes[i], pack);
		double ms = asked ? time_scene(bench, scenes[i], pack, table, &gains) : NAN;
		trees = strcmp(scenes[i], "trees5000") == 0 ? ms : trees;
	}
	bench_table_close(table);
	bench_key(bench, "planning_ms", trees,
		"<= 10 where copying 1 GB takes 200 ms: 1,000,000 vertices of the "
		"5,000 trees, median of the views");
	bench_key(bench, "planning_candidates_per_cut", gains,
		"<= 4, worst view: candidates whose gain was computed");
}

const struct bench_section bench_planner = { "planner", "Time of the planner", run };
