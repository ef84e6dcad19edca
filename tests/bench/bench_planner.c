/* The planner against what could be: the best there is for the same vertices in scenes so small that
 * everything can be tried; Deussen's rule on large ones, with the same lists; its own prediction against what
 * is then counted; and the time it takes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/ladder/bench_best.h"
#include "tests/bench/bench_shots.h"
#include "tests/bench/bench_times.h"

/* ---- Against the best there is ---- */

#define SMALL_SCENES 1000u
#define GAP_TOLD 0.05

static json_t *gaps_of(const struct bench_best *found, uint32_t count)
{
	json_t *all = json_array();
	for (uint32_t i = 0; i < count; i++)
		json_array_append_new(all,
			json_pack("{s:f, s:f, s:f, s:f, s:i, s:i}", "planner", found[i].planner, "best",
			found[i].best, "empty", found[i].empty, "vertices", (double)found[i].vertices,
			"structures", (int)found[i].structures, "things", (int)found[i].things));
	return all;
}

static enum eco_code small_scenes(struct bench *bench, json_t **unit, struct eco_error *error)
{
	struct bench_best *found = malloc(SMALL_SCENES * sizeof *found);
	enum eco_code code = found ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for %u small scenes",
		SMALL_SCENES);
	for (uint32_t i = 0; i < SMALL_SCENES && !code; i++)
		code = bench_stopped(bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
			: bench_best_find(i + 1, false, &found[i], error);
	if (!code)
		*unit = bench_keep(bench, "planner-best", NULL, gaps_of(found, SMALL_SCENES));
	free(found);
	return code;
}

/* (E - E of the best) / E of nothing; scenes in which nothing is in view do not count. */
static enum eco_code against_best(struct bench *bench, struct eco_error *error)
{
	bench_progress(bench, 0, "small scenes");
	json_t *unit = bench_recall(bench, "planner-best", NULL), *row;
	enum eco_code code = unit ? ECO_OK : small_scenes(bench, &unit, error);
	double sum = 0, worst = 0;
	uint32_t count = 0, told = 0;
	size_t i;
	if (code)
		return code;
	struct bench_table *table = bench_table_open(bench, "planner_best",
		"scene,vertices,planner,best,nothing drawn,gap,structures tried,plants and "
		"summaries", false);
	json_array_foreach(unit, i, row) {
		double empty = bench_shot_number(row, "empty"), planner = bench_shot_number(row, "planner"),
			best = bench_shot_number(row, "best");
		if (!(empty > 0))
			continue;
		double gap = (planner - best) / empty;
		bench_table_row(table, "%zu,%.0f,%.4f,%.4f,%.4f,%.5f,%.0f,%.0f", i + 1,
			bench_shot_number(row, "vertices"), planner, best, empty, gap,
			bench_shot_number(row, "structures"), bench_shot_number(row, "things"));
		sum += gap;
		worst = fmax(worst, gap);
		told += gap > GAP_TOLD;
		count++;
	}
	bench_table_close(table);
	bench_say(bench, "In %u of %u small random scenes something is in view; every choice of tiles and "
		"of bands that draw cells was tried there, with "
		"the best amount for each single plant. In %u of them the plan is more than %.0f %% of an "
		"empty picture's error from the best.", count, SMALL_SCENES, told, 100 * GAP_TOLD);
	bench_key(bench, "planner_gap", count ? sum / count : NAN, "<= 0.01: mean of (E - E*) / E(empty)");
	bench_key(bench, "planner_gap_worst", count ? worst : NAN, "<= 0.05: the worst scene");
	return ECO_OK;
}

/* ---- Against Deussen's rule, and the prediction ---- */

static const char *const large[] = { "scbi", "trees5000", "outdoor" };
#define LARGE (sizeof large / sizeof *large)
static const char *const predicted[] = { "scbi", "trees5000", "outdoor", "crown", "trees640", "palms",
	"sunflowers", "trees1276" };
#define PREDICTED (sizeof predicted / sizeof *predicted)

/* wrong pixels; of the prediction */
struct sums { double ours, theirs, gap, gap_worst, signed_gap; uint32_t frames; };

static void add_rows(struct sums *sums, const json_t *ours, const json_t *theirs, uint32_t budget)
{
	const json_t *a = json_array_get(ours, budget), *b = json_array_get(theirs, budget);
	double gap = bench_shot_number(a, "predicted_q") - bench_shot_number(a, "q");
	sums->ours += bench_shot_number(a, "wrong");
	sums->theirs += b ? bench_shot_number(b, "wrong") : 0;
	sums->gap += fabs(gap);
	sums->signed_gap += gap;
	sums->gap_worst = fmax(sums->gap_worst, fabs(gap));
	sums->frames++;
}

/* Both rules at all budgets: sums[budget]. */
static enum eco_code compare_rules(struct bench *bench, const char *scene, bool rules, struct sums *sums,
	struct eco_error *error)
{
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	uint64_t budgets[BENCH_BUDGETS_MAX];
	char pack[512];
	enum eco_code code = bench_scene(bench, scene, NULL, pack, error);
	uint32_t count = bench_budgets(bench, scene, budgets),
		views = code ? 0 : bench_shot_views(bench, scene, requests);
	for (uint32_t v = 0; v < views && !code; v++) {
		json_t *ours, *theirs = NULL;
		code = bench_shots(bench, scene, BENCH_OURS, v, &ours, error);
		if (!code && rules)
			code = bench_shots(bench, scene, BENCH_DEUSSEN_RULE, v, &theirs, error);
		for (uint32_t b = 0; b < count && !code; b++)
			add_rows(&sums[b], ours, theirs, b);
	}
	return code;
}

/* Wrong pixels of all budgets and views together; the worst scene counts. */
static enum eco_code versus_deussen(struct bench *bench, struct eco_error *error)
{
	struct bench_table *table = bench_table_open(bench, "planner_rules",
		"scene,vertices,wrong pixels,by Deussen's rule,fewer %", true);
	double worst = NAN;
	char pack[512];
	enum eco_code code = ECO_OK;
	for (size_t i = 0; i < LARGE && !code; i++) {
		uint64_t budgets[BENCH_BUDGETS_MAX];
		struct sums sums[BENCH_BUDGETS_MAX] = { { 0 } };
		double ours = 0, theirs = 0;
		bench_progress(bench, 0.1 + 0.1 * (double)i, large[i]);
		if (!bench_shot_scene(bench, large[i], pack, &code, error))
			continue;
		code = code ? code : compare_rules(bench, large[i], true, sums, error);
		for (uint32_t b = 0, count = bench_budgets(bench, large[i], budgets); b < count && !code;
				b++) {
			const struct sums *s = &sums[b];
			ours += s->ours;
			theirs += s->theirs;
			bench_table_row(table, "%s,%llu,%.0f,%.0f,%.1f", large[i],
				(unsigned long long)budgets[b], s->ours / s->frames, s->theirs / s->frames,
				100 * (1 - s->ours / s->theirs));
		}
		if (!code) {
			bench_table_row(table, "%s,all,%.0f,%.0f,%.1f", large[i], ours, theirs,
				100 * (1 - ours / theirs));
			worst = fmin(worst, 1 - ours / theirs);
		}
	}
	bench_table_close(table);
	bench_say(bench, "Both rules draw the same lists, each primitive as large as was measured for its "
		"list.");
	if (!code)
		bench_key(bench, "versus_deussen", worst, ">= 0.3: fewer wrong pixels than by Deussen's "
			"rule, same lists and vertices, worst scene");
	return code;
}

static enum eco_code prediction(struct bench *bench, struct eco_error *error)
{
	struct bench_table *table = bench_table_open(bench, "planner_prediction",
		"scene,vertices,mean |predicted Q - Q|,mean predicted Q - "
		"Q,worst", true);
	double gap = 0;
	uint32_t frames = 0;
	char pack[512];
	enum eco_code code = ECO_OK;
	for (size_t i = 0; i < PREDICTED && !code; i++) {
		uint64_t budgets[BENCH_BUDGETS_MAX];
		struct sums sums[BENCH_BUDGETS_MAX] = { { 0 } };
		bench_progress(bench, 0.4 + 0.05 * (double)i, predicted[i]);
		if (!bench_shot_scene(bench, predicted[i], pack, &code, error))
			continue;
		code = code ? code : compare_rules(bench, predicted[i], false, sums, error);
		for (uint32_t b = 0, count = bench_budgets(bench, predicted[i], budgets);
				b < count && !code; b++) {
			const struct sums *s = &sums[b];
			bench_table_row(table, "%s,%llu,%.4f,%.4f,%.4f", predicted[i],
				(unsigned long long)budgets[b], s->gap / s->frames, s->signed_gap / s->frames,
				s->gap_worst);
			gap += s->gap;
			frames += s->frames;
		}
	}
	bench_table_close(table);
	if (!code)
		bench_key(bench, "predicted_q_gap", frames ? gap / frames : NAN,
			"<= 0.03: mean |predicted Q - Q|");
	return code;
}

/* ---- Time ---- */

static json_t *json_of(const struct bench_plan_time *t)
{
	return json_pack("{s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "ms", t->ms, "candidates",
		(double)t->candidates, "gains", (double)t->gains,
		"looks", (double)t->looks, "places", (double)t->places, "vertices",
		(double)t->vertices, "cuts", (double)t->cuts, "repetitions", (double)t->repetitions);
}

static enum eco_code time_choice(struct bench *bench, uint32_t species, json_t **unit,
	struct eco_error *error)
{
	struct bench_choice choice = { 0 };
	struct bench_plan_time time = { 0 };
	char name[64];
	snprintf(name, sizeof name, "planner-choice-%u", species);
	if ((*unit = bench_recall(bench, name, NULL)))
		return ECO_OK;
	bench_choice_make(&choice, species);
	choice.request.vertices = (uint64_t)species * 4000;      /* 500 a plant */
	enum eco_code code = bench_plan_time(&time, &choice.made.scene, &choice.request, 300, error);
	bench_choice_free(&choice);
	if (!code)
		*unit = bench_keep(bench, name, NULL, json_of(&time));
	return code;
}

static enum eco_code growth(struct bench *bench, struct eco_error *error)
{
	static const uint32_t species[] = { 13, 40, 125, 400, 1250, 4000, 14000 };
	struct bench_table *table = bench_table_open(bench, "planner_growth",
		"candidates,plants,cuts,ms,ns a candidate", true);
	enum eco_code code = ECO_OK;
	double x[sizeof species / sizeof *species], y[sizeof species / sizeof *species], ns = NAN;
	uint32_t count = sizeof species / sizeof *species;
	for (uint32_t i = 0; i < count && !code; i++) {
		json_t *unit;
		bench_progress(bench, 0.8 + 0.02 * i, "growth of planning");
		code = time_choice(bench, species[i], &unit, error);
		if (code)
			break;
		x[i] = bench_shot_number(unit, "candidates");
		y[i] = bench_shot_number(unit, "ms");
		ns = 1e6 * y[i] / x[i];
		bench_table_row(table, "%.0f,%.0f,%.0f,%.3f,%.1f", x[i], bench_shot_number(unit, "places"),
			bench_shot_number(unit, "cuts"), y[i], ns);
	}
	bench_table_close(table);
	if (code)
		return code;
	bench_key(bench, "planning_ns_per_candidate", ns, "at a million candidates");
	bench_key(bench, "planning_growth", log(y[count - 1] / y[0]) / log(x[count - 1] / x[0]),
		"about 1: exponent of the time over candidates");
	return bench_plot(bench, &(struct bench_plot){ .name = "planner-growth", .title = "Planning",
		.x = "candidates", .y = "ms", .log_x = true,
		.log_y = true, .series = &(struct bench_series){ "time of a plan", x, y, count, false },
		.series_count = 1 }, error);
}

struct planned { double ms[3], worst_gains; };      /* medians of up to three views */

/* Plans of 1,000,000 vertices. */
static enum eco_code time_scene(struct bench *bench, const char *scene, struct bench_table *table,
	struct planned *planned, struct eco_error *error)
{
	struct eco_request requests[3];
	struct eco_pack *pack = NULL;
	char path[512], name[96];
	enum eco_code code = bench_scene(bench, scene, NULL, path, error);
	uint32_t views = code ? 0 : bench_scene_views(bench, scene, requests, 3);
	*planned = (struct planned){ { NAN, NAN, NAN }, 0 };
	if (!code)
		code = eco_pack_open(&pack, path, error);
	for (uint32_t v = 0; v < views && !code; v++) {
		struct bench_plan_time time;
		snprintf(name, sizeof name, "planner-time-%s-%u", scene, v);
		requests[v].vertices = 1000000;
		json_t *unit = bench_recall(bench, name, bench_pack_stamp(path));
		if (!unit) {
			code = bench_plan_time(&time, &pack->scene, &requests[v], 500, error);
			unit = code ? NULL : bench_keep(bench, name, bench_pack_stamp(path), json_of(&time));
		}
		if (!code) {
			double gains = bench_shot_number(unit, "gains"),
				cuts = bench_shot_number(unit, "cuts");
			planned->ms[v] = bench_shot_number(unit, "ms");
			planned->worst_gains = fmax(planned->worst_gains, gains / cuts);
			bench_table_row(table, "%s,%u,%.3f,%.0f,%.0f,%.0f,%.2f,%.0f,%.0f,%.0f", scene, v,
				planned->ms[v], bench_shot_number(unit, "candidates"), cuts, gains,
				gains / cuts, bench_shot_number(unit, "looks"),
				bench_shot_number(unit, "places"), bench_shot_number(unit, "vertices"));
		}
	}
	eco_pack_close(pack);
	return code;
}

static double median(const double ms[3])
{
	if (isnan(ms[1]) || isnan(ms[2]))
		return isnan(ms[1]) ? ms[0] : (ms[0] + ms[1]) / 2;
	return fmax(fmin(ms[0], ms[1]), fmin(fmax(ms[0], ms[1]), ms[2]));
}

static enum eco_code times(struct bench *bench, struct eco_error *error)
{
	struct bench_table *table = bench_table_open(bench, "planner_times",
		"scene,view,ms,candidates,cuts,gains computed,gains over cuts,looks at a "
		"price,plants looked at,vertices", true);
	enum eco_code code = ECO_OK;
	double worst = NAN, trees = NAN;
	char pack[512];
	for (size_t i = 0; i < LARGE && !code; i++) {
		struct planned planned = { .worst_gains = NAN };
		bench_progress(bench, 0.7 + 0.03 * (double)i, large[i]);
		if (!bench_shot_scene(bench, large[i], pack, &code, error))
			continue;
		code = code ? code : time_scene(bench, large[i], table, &planned, error);
		worst = fmax(worst, planned.worst_gains);
		if (strcmp(large[i], "trees5000") == 0)
			trees = median(planned.ms);
	}
	bench_table_close(table);
	if (code)
		return code;
	double copy = bench_copy_ms();
	if (!isnan(trees))
		bench_say(bench, "A plan of 1,000,000 vertices of the 5,000 trees takes %.2f ms (median, one core) "
		"on a machine that copies 1 GB in %.0f ms; "
		"10 ms are allowed where that takes 200 ms.", trees, copy);
	bench_key(bench, "planning_ms", trees, "<= 10 where copying 1 GB takes 200 ms");
	bench_key(bench, "copy_1gb_ms", copy, "of this machine");
	bench_key(bench, "planning_candidates_per_cut", worst, "<= 4, worst view: candidates whose gain was "
		"computed");
	return ECO_OK;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	enum eco_code code = against_best(bench, error);
	if (!code)
		code = versus_deussen(bench, error);
	if (!code)
		code = prediction(bench, error);
	if (!code)
		code = times(bench, error);
	if (!code)
		code = growth(bench, error);
	return code;
}

const struct bench_section bench_planner = { "planner", "The planner: against the best, against Deussen's "
	"rule, against itself", run,
	.objects = BENCH_OBJECTS_FRAMES "tests/bench/bench_[bpst]*.o tests/bench/bench_frame.o "
	"tests-support.a", .alone = true };
