/* The planner against what could be: the best there is for the same vertices in scenes so small that
 * everything can be tried; Deussen's rule on large ones, with the same lists; its own prediction against what
 * is then counted; and its time. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/bench_shots.h"
#include "tests/bench/bench_times.h"
#include "tests/bench/ladder/bench_best.h"

/* ---- Against the best there is ---- */

#define SMALL_SCENES 1000u
#define GAP_TOLD 0.05

enum { PLANNER, BEST, EMPTY, BUDGET, STRUCTURES, THINGS, SMALL };

static enum eco_code small_scenes(void *ctx, json_t **made, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	*made = json_array();
	for (uint32_t i = 0; i < SMALL_SCENES && !code; i++) {
		struct bench_best b;
		code = bench_go_on(ctx, error);
		code = code ? code : bench_best_find(i + 1, false, &b, error);
		if (!code)
			json_array_append_new(*made, bench_reals((double[]){ b.planner, b.best, b.empty,
				(double)b.vertices, b.structures, b.things }, SMALL));
	}
	return code;
}

/* (E - E of the best) / E of nothing; scenes in which nothing is in view do not count. */
static enum eco_code against_best(struct bench *bench, struct eco_error *error)
{
	json_t *unit, *row;
	double sum = 0, worst = 0;
	uint32_t count = 0, told = 0;
	size_t i;
	bench_progress(bench, 0, "small scenes");
	enum eco_code code = bench_unit(bench, "planner-best", NULL, small_scenes, bench, &unit, error);
	if (code)
		return code;
	struct bench_table *table = bench_table_open(bench, "planner_best",
		"scene,vertices,planner,best,nothing drawn,gap,structures tried,plants and summaries", false);
	json_array_foreach(unit, i, row) {
		double v[SMALL];
		bench_cells(row, v, SMALL);
		if (!(v[EMPTY] > 0))
			continue;
		double gap = (v[PLANNER] - v[BEST]) / v[EMPTY];
		bench_table_row(table, "%zu,%.0f,%.4f,%.4f,%.4f,%.5f,%.0f,%.0f", i + 1, v[BUDGET], v[PLANNER],
			v[BEST], v[EMPTY], gap, v[STRUCTURES], v[THINGS]);
		sum += gap;
		worst = fmax(worst, gap);
		told += gap > GAP_TOLD;
		count++;
	}
	bench_table_close(table);
	bench_say(bench, "In %u of %u small random scenes something is in view; every choice of tiles and "
		"of bands that draw cells was tried there, with the best amount for each single plant. In %u "
		"of them the " "plan is more than %.0f %% of an empty picture's error from the best.", count,
		SMALL_SCENES, told, 100 * GAP_TOLD);
	bench_key(bench, "planner_gap", count ? sum / count : NAN, "<= 0.01: mean of (E - E*) / E(empty)");
	bench_key(bench, "planner_gap_worst", count ? worst : NAN, "<= 0.05: the worst scene");
	return ECO_OK;
}

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

enum { MS, CANDIDATES, CUTS, GAINS, LOOKS, PLACES, VERTICES, TIMES };

struct plan { const struct eco_scene *scene; const struct eco_request *request; double least_ms; };

static enum eco_code time_plan(void *ctx, json_t **made, struct eco_error *error)
{
	const struct plan *plan = ctx;
	struct bench_plan_time t = { 0 };
	enum eco_code code = bench_plan_time(&t, plan->scene, plan->request, plan->least_ms, error);
	*made = bench_reals((double[]){ t.ms, (double)t.candidates, (double)t.cuts, (double)t.gains,
		(double)t.looks, (double)t.places, (double)t.vertices }, TIMES);
	return code;
}

static enum eco_code time_choice(void *ctx, json_t **made, struct eco_error *error)
{
	uint32_t species = *(const uint32_t *)ctx;
	struct bench_choice choice = { 0 };
	bench_choice_make(&choice, species);
	choice.request.vertices = (uint64_t)species * 4000;      /* 500 a plant */
	enum eco_code code = time_plan(&(struct plan){ &choice.made.scene, &choice.request, 300 }, made,
		error);
	bench_choice_free(&choice);
	return code;
}

static enum eco_code growth(struct bench *bench, struct eco_error *error)
{
	static uint32_t species[] = { 13, 40, 125, 400, 1250, 4000, 14000 };
	enum { COUNT = sizeof species / sizeof *species };
	double x[COUNT], y[COUNT], v[TIMES];
	enum eco_code code = ECO_OK;
	struct bench_table *table = bench_table_open(bench, "planner_growth",
		"candidates,plants,cuts,ms,ns a candidate", true);
	for (int i = 0; i < COUNT && !code; i++) {
		char name[64];
		json_t *unit;
		bench_progress(bench, 0.8 + 0.02 * i, "growth of planning");
		snprintf(name, sizeof name, "planner-choice-%u", species[i]);
		code = bench_unit(bench, name, NULL, time_choice, &species[i], &unit, error);
		if (code)
			break;
		bench_cells(unit, v, TIMES);
		x[i] = v[CANDIDATES];
		y[i] = v[MS];
		bench_table_row(table, "%.0f,%.0f,%.0f,%.3f,%.1f", x[i], v[PLACES], v[CUTS], y[i], 1e6
			* y[i] / x[i]);
	}
	bench_table_close(table);
	if (code)
		return code;
	bench_key(bench, "planning_ns_per_candidate", 1e6 * y[COUNT - 1] / x[COUNT - 1],
		"at a million candidates");
	bench_key(bench, "planning_growth", log(y[COUNT - 1] / y[0]) / log(x[COUNT - 1] / x[0]),
		"about 1: exponent of the time over candidates");
	return bench_plot(bench, &(struct bench_plot){ .name = "planner-growth", .title = "Planning",
		.x = "candidates", .y = "ms", .log_x = true, .log_y = true,
		.series = &(struct bench_series){ "time of a plan", x, y, COUNT, false }, .series_count = 1 },
		error);
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
		struct plan plan = { &pack->scene, &requests[v], 500 };
		requests[v].vertices = 1000000;
		snprintf(name, sizeof name, "planner-time-%s-%u", scene, v);
		code = bench_unit(bench, name, bench_pack_stamp(path), time_plan, &plan, &unit, error);
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
	double copy = bench_copy_ms();
	bench_key(bench, "planning_ms", trees,
		"<= 10 where copying 1 GB takes 200 ms: 1,000,000 vertices of the 5,000 "
		"trees, median of the views");
	bench_key(bench, "copy_1gb_ms", copy, "of this machine");
	bench_key(bench, "planning_candidates_per_cut", gains,
		"<= 4, worst view: candidates whose gain was computed");
	return ECO_OK;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	enum eco_code code = against_best(bench, error);
	code = code ? code : on_scenes(bench, error);
	code = code ? code : times(bench, error);
	return code ? code : growth(bench, error);
}

const struct bench_section bench_planner = { "planner", "The planner: against the best, against Deussen's "
	"rule, against itself", run,
	.objects = BENCH_OBJECTS_FRAMES "tests/bench/bench_[bpst]*.o tests/bench/bench_frame.o "
	"tests-support.a", .alone = true };
