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

struct gap { double sum, of_signs, worst; uint32_t frames; };

static enum eco_code add_scene(struct bench *bench, const char *scene, struct bench_table *table,
	struct gap *all, struct eco_error *error)
{
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	uint64_t budgets[BENCH_BUDGETS_MAX];
	struct gap gaps[BENCH_BUDGETS_MAX] = { { 0 } };
	uint32_t count = bench_budgets(bench, scene, budgets), views = bench_shot_views(bench, scene,
		requests);
	enum eco_code code = ECO_OK;
	for (uint32_t v = 0; v < views && !code; v++) {
		json_t *rows;
		code = bench_shots(bench, scene, BENCH_OURS, v, &rows, error);
		for (uint32_t b = 0; b < count && !code; b++) {
			const json_t *row = json_array_get(rows, b);
			double gap = bench_shot_number(row, "predicted_q") - bench_shot_number(row, "q");
			gaps[b].sum += fabs(gap);
			gaps[b].of_signs += gap;
			gaps[b].worst = fmax(gaps[b].worst, fabs(gap));
		}
	}
	for (uint32_t b = 0; b < count && !code; b++) {
		all->sum += gaps[b].sum;
		all->frames += views;
		bench_table_row(table, "%s,%llu,%.4f,%.4f,%.4f", scene, (unsigned long long)budgets[b],
			gaps[b].sum / views, gaps[b].of_signs / views, gaps[b].worst);
	}
	return code;
}

static enum eco_code on_scenes(struct bench *bench, struct eco_error *error)
{
	struct gap all = { 0 };
	enum eco_code code = ECO_OK;
	struct bench_table *table = bench_table_open(bench, "planner_prediction",
		"scene,vertices,mean |predicted Q - Q|,mean predicted Q - Q,worst", true);
	for (size_t i = 0; i < SCENES && !code; i++) {
		char pack[512];
		bench_progress(bench, 0.1 + 0.07 * (double)i, scenes[i]);
		if (bench_shot_scene(bench, scenes[i], pack, &code, error) && !code)
			code = add_scene(bench, scenes[i], table, &all, error);
	}
	bench_table_close(table);
	if (!code)
		bench_key(bench, "predicted_q_gap", all.frames ? all.sum / all.frames : NAN,
			"<= 0.03: mean |predicted Q - Q|");
	return code;
}

/* ---- Time ---- */

#define REPETITIONS_MAX 200u
#define REPETITIONS_LEAST 3u

enum eco_code bench_plan_time(double *median_ms, struct lod_planner_stats *stats, struct eco_plan *plan,
	const struct eco_scene *scene, const struct eco_request *request, double least_ms,
	struct eco_error *error)
{
	double ms[REPETITIONS_MAX], sum = 0;
	struct lod_planner_input input = { .scene = scene, .request = request, .stats = stats };
	uint32_t count = 0;
	*plan = (struct eco_plan){ 0 };
	enum eco_code code = lod_plan_tables_make(&input.tables, scene, error);
	while (!code && (count < REPETITIONS_LEAST || (count < REPETITIONS_MAX && sum < least_ms))) {
		double from = view_clock_ms();
		eco_plan_free(plan);
		code = lod_plan(plan, &input, error);
		sum += ms[count++] = view_clock_ms() - from;
	}
	lod_plan_tables_free(input.tables);
	*median_ms = code ? NAN : bench_median(ms, count);
	return code;
}

enum { MS, CANDIDATES, CUTS, GAINS, LOOKS, PLACES, VERTICES, TIMES };

struct timed { const struct eco_scene *scene; const struct eco_request *request; };

static enum eco_code time_plan(void *ctx, json_t **made, struct eco_error *error)
{
	const struct timed *timed = ctx;
	struct lod_planner_stats stats = { 0 };
	struct eco_plan plan;
	double ms;
	enum eco_code code = bench_plan_time(&ms, &stats, &plan, timed->scene, timed->request, 500, error);
	*made = bench_reals((double[]){ ms, (double)stats.candidates, plan.cut_count, (double)stats.gains,
		(double)stats.looks, (double)stats.places, (double)plan.vertices }, TIMES);
	eco_plan_free(&plan);
	return code;
}

/* Plans of 1,000,000 vertices: *ms the middle of up to three views, *gains the most for a cut. */
static enum eco_code time_scene(struct bench *bench, const char *scene, const char *path, struct bench_table
	*table, double *ms, double *gains, struct eco_error *error)
{
	struct eco_request requests[3];
	struct eco_pack *pack = NULL;
	double all[3] = { NAN, NAN, NAN };
	uint32_t views = bench_scene_views(bench, scene, requests, 3);
	enum eco_code code = eco_pack_open(&pack, path, error);
	for (uint32_t v = 0; v < views && !code; v++) {
		char name[96];
		double t[TIMES];
		json_t *unit;
		struct timed timed = { &pack->scene, &requests[v] };
		requests[v].vertices = 1000000;
		snprintf(name, sizeof name, "planner-time-%s-%u", scene, v);
		code = bench_unit(bench, name, bench_pack_stamp(path), time_plan, &timed, &unit, error);
		if (code)
			break;
		bench_cells(unit, t, TIMES);
		all[v] = t[MS];
		*gains = fmax(*gains, t[GAINS] / t[CUTS]);
		bench_table_row(table, "%s,%u,%.3f,%.0f,%.0f,%.0f,%.2f,%.0f,%.0f,%.0f", scene, v, t[MS],
			t[CANDIDATES], t[CUTS], t[GAINS], t[GAINS] / t[CUTS], t[LOOKS], t[PLACES],
			t[VERTICES]);
	}
	eco_pack_close(pack);
	*ms = fmax(fmin(all[0], all[1]), fmin(fmax(all[0], all[1]), all[2]));
	return code;
}

static enum eco_code times(struct bench *bench, struct eco_error *error)
{
	struct bench_table *table = bench_table_open(bench, "planner_times",
		"scene,view,ms,candidates,cuts,gains computed,gains over cuts,looks at a "
		"price,plants looked at,vertices", true);
	enum eco_code code = ECO_OK;
	double gains = NAN, trees = NAN, ms;
	char pack[512];
	for (size_t i = 0; i < LARGE && !code; i++) {
		bench_progress(bench, 0.7 + 0.03 * (double)i, scenes[i]);
		if (!bench_shot_scene(bench, scenes[i], pack, &code, error) || code)
			continue;
		code = time_scene(bench, scenes[i], pack, table, &ms, &gains, error);
		trees = strcmp(scenes[i], "trees5000") == 0 ? ms : trees;
	}
	bench_table_close(table);
	if (code)
		return code;
	bench_key(bench, "planning_ms", trees,
		"<= 10 where copying 1 GB takes 200 ms: 1,000,000 vertices of the "
		"5,000 trees, median of the views");
	bench_key(bench, "planning_candidates_per_cut", gains,
		"<= 4, worst view: candidates whose gain was computed");
	return ECO_OK;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	enum eco_code code = on_scenes(bench, error);
	return code ? code : times(bench, error);
}

const struct bench_section bench_planner = { "planner", "The planner: its prediction and its time", run };
