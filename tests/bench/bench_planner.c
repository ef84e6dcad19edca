/* The planner on large scenes: its prediction against what is then counted, and its time. (The section rules:
 * against Deussen's rule; tests/bench/test_best.c: against the best there is, on small scenes.) */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_store.h"
#include "ecofiles/format/pack.h"
#include "tests/bench/bench_shots.h"

/* ---- The prediction ---- */

static const char *const scenes[] = { "scbi", "trees5000", "outdoor", "crown", "trees640", "palms",
	"sunflowers", "trees1276" };
#define SCENES (sizeof scenes / sizeof *scenes)
#define LARGE 3u                 /* the first ones: their plans are timed */

struct gap { double sum, of_signs, worst; };

/* Returns the sum of all gaps; *frames are counted. */
static double add_scene(struct bench *bench, const char *scene, struct bench_table *table, uint32_t *frames)
{
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	uint64_t budgets[BENCH_BUDGETS_MAX];
	struct gap gaps[BENCH_BUDGETS_MAX] = { { 0 } };
	uint32_t count = bench_budgets(bench, scene, budgets), views = bench_shot_views(bench, scene,
		requests);
	double sum = 0;
	for (uint32_t v = 0; v < views; v++) {
		const json_t *rows = bench_shots(bench, scene, BENCH_OURS, v);
		for (uint32_t b = 0; b < count; b++) {
			const json_t *row = json_array_get(rows, b);
			double gap = bench_shot_number(row, "predicted_q") - bench_shot_number(row, "q");
			gaps[b].sum += fabs(gap);
			gaps[b].of_signs += gap;
			gaps[b].worst = fmax(gaps[b].worst, fabs(gap));
		}
	}
	for (uint32_t b = 0; b < count; b++) {
		sum += gaps[b].sum;
		*frames += views;
		bench_table_row(table, "%s,%llu,%.4f,%.4f,%.4f", scene, (unsigned long long)budgets[b],
			gaps[b].sum / views, gaps[b].of_signs / views, gaps[b].worst);
	}
	return sum;
}

static void predict(struct bench *bench)
{
	double sum = 0;
	uint32_t frames = 0;
	char pack[512];
	struct bench_table *table = bench_table_open(bench, "planner_prediction",
		"scene,vertices,mean |predicted Q - Q|,mean predicted Q - Q,worst", true);
	for (size_t i = 0; i < SCENES; i++) {
		bench_progress(bench, 0.1 + 0.07 * (double)i, scenes[i]);
		bool asked = bench_scene_there(bench, scenes[i], pack);
		sum += asked ? add_scene(bench, scenes[i], table, &frames) : 0;
	}
	bench_table_close(table);
	bench_key(bench, "predicted_q_gap", frames ? sum / frames : NAN, "<= 0.03: mean |predicted Q - Q|");
}

/* ---- Time ---- */

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
	predict(bench);
	struct bench_table *table = bench_table_open(bench, "planner_times",
		"scene,view,ms,candidates,cuts,gains computed,gains over cuts,looks at a "
		"price,plants looked at,vertices", true);
	for (size_t i = 0; i < LARGE; i++) {
		bench_progress(bench, 0.7 + 0.03 * (double)i, scenes[i]);
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

const struct bench_section bench_planner = { "planner", "The planner: its prediction and its time", run };
