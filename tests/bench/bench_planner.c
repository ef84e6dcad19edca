/* The planner on large scenes: against Deussen's rule, with the same lists; its own prediction against what is
 * then counted; and its time. (tests/bench/test_best.c: against the best there is, on small ones.) */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/pack.h"
#include "tests/bench/bench_shots.h"
#include "tests/bench/bench_state.h"

/* ---- Against Deussen's rule, and the prediction ---- */

static const char *const scenes[] = { "scbi", "trees5000", "outdoor", "crown", "trees640", "palms",
	"sunflowers", "trees1276" };
#define SCENES (sizeof scenes / sizeof *scenes)
#define LARGE 3u                 /* the first ones */

/* wrong pixels of ours and of Deussen's rule; of the prediction of Q */
struct sums { double ours, theirs, gap, gap_worst, signed_gap; uint32_t frames; };

static enum eco_code add_view(struct bench *bench, const char *scene, bool large, uint32_t view,
	uint32_t count, struct sums *sums, struct eco_error *error)
{
	json_t *ours, *theirs = NULL;
	enum eco_code code = bench_shots(bench, scene, BENCH_OURS, view, &ours, error);
	if (!code && large)
		code = bench_shots(bench, scene, BENCH_DEUSSEN_RULE, view, &theirs, error);
	for (uint32_t b = 0; b < count && !code; b++) {
		const json_t *row = json_array_get(ours, b);
		double gap = bench_shot_number(row, "predicted_q") - bench_shot_number(row, "q");
		sums[b].ours += bench_shot_number(row, "wrong");
		sums[b].theirs += bench_shot_number(json_array_get(theirs, b), "wrong");
		sums[b].gap += fabs(gap);
		sums[b].signed_gap += gap;
		sums[b].gap_worst = fmax(sums[b].gap_worst, fabs(gap));
		sums[b].frames++;
	}
	return code;
}

struct drawn { struct bench_table *rules, *prediction; double worst, gap; uint32_t frames; };

static enum eco_code add_scene(struct bench *bench, const char *scene, bool large, struct drawn *all,
	struct eco_error *error)
{
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	uint64_t budgets[BENCH_BUDGETS_MAX];
	struct sums sums[BENCH_BUDGETS_MAX] = { { 0 } };
	double ours = 0, theirs = 0;
	uint32_t count = bench_budgets(bench, scene, budgets), views = bench_shot_views(bench, scene,
		requests);
	enum eco_code code = ECO_OK;
	for (uint32_t v = 0; v < views && !code; v++)
		code = add_view(bench, scene, large, v, count, sums, error);
	for (uint32_t b = 0; b < count && !code; b++) {
		const struct sums *s = &sums[b];
		unsigned long long budget = budgets[b];
		ours += s->ours;
		theirs += s->theirs;
		all->gap += s->gap;
		all->frames += s->frames;
		bench_table_row(all->prediction, "%s,%llu,%.4f,%.4f,%.4f", scene, budget, s->gap / s->frames,
			s->signed_gap / s->frames, s->gap_worst);
		if (large)
			bench_table_row(all->rules, "%s,%llu,%.0f,%.0f,%.1f", scene, budget,
				s->ours / s->frames, s->theirs / s->frames, 100 * (1 - s->ours / s->theirs));
	}
	if (!code && large) {
		bench_table_row(all->rules, "%s,all,%.0f,%.0f,%.1f", scene, ours, theirs, 100 * (1
			- ours / theirs));
		all->worst = fmin(all->worst, 1 - ours / theirs);
	}
	return code;
}

static enum eco_code on_scenes(struct bench *bench, struct eco_error *error)
{
	struct drawn all = { .worst = NAN };
	enum eco_code code = ECO_OK;
	all.rules = bench_table_open(bench, "planner_rules",
		"scene,vertices,wrong pixels,by Deussen's rule,fewer %", true);
	bench_say(bench,
		"Both rules draw the same lists, each primitive as large as was measured for its list.");
	all.prediction = bench_table_open(bench, "planner_prediction",
		"scene,vertices,mean |predicted Q - Q|,mean predicted Q - Q,worst", true);
	for (size_t i = 0; i < SCENES && !code; i++) {
		char pack[512];
		bench_progress(bench, 0.1 + 0.07 * (double)i, scenes[i]);
		if (bench_shot_scene(bench, scenes[i], pack, &code, error) && !code)
			code = add_scene(bench, scenes[i], i < LARGE, &all, error);
	}
	bench_table_close(all.rules);
	bench_table_close(all.prediction);
	if (code)
		return code;
	/* wrong pixels of all budgets and views together */
	bench_key(bench, "versus_deussen", all.worst,
		">= 0.3: fewer wrong pixels than by Deussen's rule, same lists " "and vertices, worst scene");
	bench_key(bench, "predicted_q_gap", all.frames ? all.gap / all.frames : NAN,
		"<= 0.03: mean |predicted Q - Q|");
	return ECO_OK;
}

/* ---- Time ---- */

#define REPETITIONS_MAX 200u
#define REPETITIONS_LEAST 3u

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return x < y ? -1 : x > y;
}

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
		double from = bench_now_s();
		eco_plan_free(plan);
		code = lod_plan(plan, &input, error);
		sum += ms[count++] = 1e3 * (bench_now_s() - from);
	}
	lod_plan_tables_free(input.tables);
	qsort(ms, count, sizeof *ms, ascending);
	*median_ms = code ? NAN : ms[count / 2];
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
	bench_key(bench, "planning_ms", trees, "<= 10 where copying 1 GB takes 200 ms: 1,000,000 vertices of the "
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

const struct bench_section bench_planner = { "planner", "The planner: against Deussen's rule, against itself", run,
	.objects = BENCH_OBJECTS_FRAMES "tests/bench/bench_planner.o tests/bench/bench_shots.o "
	"tests/bench/bench_frame.o" };
