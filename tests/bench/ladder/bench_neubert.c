/* Neubert 2011: Precision and Recall by share and scale (figures 2, 3 and 5), the best scale beside Cook's
 * and in two views (figures 6 and 7). Leaves at random, wood drawn whole. */
#include <math.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/bench_leaves.h"
#include "tests/bench/bench.h"

#define PIXELS 256u
#define VIEWS 8u
#define SEED 40961u
#define LEAVES_LEAST 500u
#define PLANTS_QUICK 4u
#define PLANTS 12u
#define STEP_LEAST (-12)         /* eighths of an octave about Cook's scale */
#define STEPS 25u

static const double lambdas[] = { 0.05, 0.1, 0.2, 0.4, 0.6, 0.8 };
#define LAMBDAS (sizeof lambdas / sizeof *lambdas)

/* ---- One plant ---- */

static double scale_of(double lambda, uint32_t step)
{
	return exp2((STEP_LEAST + (double)step) / 8) / lambda;
}

/* Per lambda and step [P, R, Q, Q in the first view, Q in the second]. */
enum { P, R, Q, Q_FIRST, Q_SECOND, FIGURES };

static json_t *measure(struct bench_leaves *leaves, const struct lod_sights *sights, const uint32_t *order)
{
	json_t *rows = json_array();
	for (uint32_t i = 0; i < LAMBDAS * STEPS; i++) {
		struct bench_wrong sum = { 0 };
		double lambda = lambdas[i / STEPS], v[FIGURES];
		const struct lod_sights_drawing drawing = { .order = order,
			.count = (uint32_t)fmax(1, lambda * leaves->foliage.count + 0.5),
			.scale = (float)scale_of(lambda, i % STEPS) };
		for (uint32_t view = 0; view < sights->count; view++) {
			struct bench_wrong one = { 0 };
			bench_leaves_compare(leaves, sights, view, &drawing, &one);
			if (view < 2)
				v[Q_FIRST + view] = bench_wrong_q(&one);
			sum.fp += one.fp;
			sum.fn += one.fn;
			sum.pixels += one.pixels;
		}
		double right = (double)(sum.pixels - sum.fn), shown = right + (double)sum.fp;
		v[P] = shown > 0 ? right / shown : 1;
		v[R] = sum.pixels ? right / (double)sum.pixels : 1;
		v[Q] = bench_wrong_q(&sum);
		json_array_append_new(rows, bench_reals(v, FIGURES));
	}
	return rows;
}

struct work { struct bench *bench; const struct bench_model *model; };

/* {"leaves", "rows"}; no rows for a plant of few leaves. The first two views look level, a quarter of a turn
 * apart, as those of the paper's study; the others from all around. */
static enum eco_code study(void *ctx, json_t **made, struct eco_error *error)
{
	static const double level[2][3] = { { 0.8, 0.6, 0 }, { -0.6, 0.8, 0 } };
	const struct work *w = ctx;
	struct eco_model read = { 0 };
	struct bench_leaves leaves;
	struct lod_sights sights = { 0 };
	double to[VIEWS][3];
	volatile enum eco_code code = bench_model_read(w->bench, w->model, &read, error);
	if (!code)
		code = bench_leaves_open(&leaves, &read, PIXELS, error);
	if (code)
		return code;
	lod_directions_spread(to, VIEWS, SEED);
	memcpy(to, level, sizeof level);
	if (setjmp(leaves.arena.failed))
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for %u leaves", leaves.foliage.count);
	else if (leaves.foliage.count >= LEAVES_LEAST)
		code = lod_sights_make(&sights, &leaves.foliage, (const double (*)[3])to, VIEWS, PIXELS,
			&leaves.arena, error);
	if (!code)
		*made = json_pack("{s:i, s:o}", "leaves", (int)leaves.foliage.count, "rows", sights.count
			? measure(&leaves, &sights, bench_leaves_order(&leaves, LOD_ORDER_STOCHASTIC, 0))
			: json_array());
	bench_leaves_close(&leaves);
	return code;
}

/* ---- Tables ---- */

static double value(const json_t *unit, size_t lambda, uint32_t step, size_t column)
{
	return bench_cell(json_array_get(json_object_get(unit, "rows"), lambda * STEPS + step), column);
}

static uint32_t best_step(const json_t *unit, size_t lambda, size_t column)
{
	uint32_t best = 0;
	for (uint32_t step = 1; step < STEPS; step++)
		best = value(unit, lambda, step, column) > value(unit, lambda, best, column) ? step : best;
	return best;
}

static void write_scales(struct bench_table *table, const char *name, const json_t *unit)
{
	for (size_t l = 0; l < LAMBDAS; l++) {
		uint32_t best = best_step(unit, l, Q), cook = (uint32_t)-STEP_LEAST;
		bench_table_row(table, "%s,%d,%g,%.2f,%.2f,%.2f,%.2f,%.3f,%.3f", name,
			(int)json_integer_value(json_object_get(unit, "leaves")), lambdas[l], 1 / lambdas[l],
			scale_of(lambdas[l], best), scale_of(lambdas[l], best_step(unit, l, Q_FIRST)),
			scale_of(lambdas[l], best_step(unit, l, Q_SECOND)), value(unit, l, cook, Q),
			value(unit, l, best, Q));
	}
}

static enum eco_code plot_diagram(struct bench *bench, const char *name, const json_t *unit,
	struct eco_error *error)
{
	static const char *const words[LAMBDAS] = { "5 %", "10 %", "20 %", "40 %", "60 %",
		"80 % of the leaves" };
	double p[LAMBDAS][STEPS], r[LAMBDAS][STEPS];
	struct bench_series series[LAMBDAS];
	char file[96], title[160];
	for (size_t l = 0; l < LAMBDAS; l++) {
		for (uint32_t step = 0; step < STEPS; step++) {
			p[l][step] = value(unit, l, step, P);
			r[l][step] = value(unit, l, step, R);
		}
		series[l] = (struct bench_series){ words[l], p[l], r[l], STEPS, true };
	}
	snprintf(file, sizeof file, "neubert-pr-%s", name);
	snprintf(title, sizeof title, "%s: Precision and Recall, scales of 1/2.8 to 2.8 of Cook's", name);
	return bench_plot(bench, &(struct bench_plot){ .name = file, .title = title, .x = "Precision",
		.y = "Recall", .series = series, .series_count = LAMBDAS }, error);
}

static enum eco_code plot_scales(struct bench *bench, const char *name, const json_t *unit,
	struct eco_error *error)
{
	double cook[LAMBDAS], best[LAMBDAS];
	char file[96], title[160];
	for (size_t l = 0; l < LAMBDAS; l++) {
		cook[l] = 1 / lambdas[l];
		best[l] = scale_of(lambdas[l], best_step(unit, l, Q));
	}
	const struct bench_series series[2] = { { "1 / lambda (Cook)", lambdas, cook, LAMBDAS, false },
		{ "best", lambdas, best, LAMBDAS, false } };
	snprintf(file, sizeof file, "neubert-scale-%s", name);
	snprintf(title, sizeof title, "%s: area factor of leaves", name);
	return bench_plot(bench, &(struct bench_plot){ .name = file, .title = title, .x = "lambda",
		.y = "s", .log_y = true, .series = series, .series_count = 2 }, error);
}

static enum eco_code write_plants(struct bench *bench, struct eco_error *error)
{
	struct bench_model *models = NULL;
	uint32_t count = 0, found = 0, most = bench->full ? PLANTS : PLANTS_QUICK;
	enum eco_code code = bench_models(bench, &models, &count, error);
	if (code)
		return code;
	bench_head(bench, "Precision and Recall by share and scale (figures 2, 3, 5, 6 and 7)");
	struct bench_table *table = bench_table_open(bench, "neubert_scales",
		"plant,leaves,lambda,s of Cook,best s,best s in view 1,best s in view 2,Q at Cook's,"
		"Q at best",
		true);
	bench_table_row(table, "%s", "Fagus Sylvatica (printed; users' choice),-,0.2,5.00,-,6.89,6.75,-,-");
	bench_table_row(table, "%s", "Fagus Sylvatica (printed; users' choice),-,0.6,1.67,-,1.94,1.81,-,-");
	for (uint32_t i = 0; i < count && found < most && !code; i++) {
		struct work work = { bench, &models[i] };
		char name[96];
		json_t *unit;
		if (models[i].leaves < LEAVES_LEAST)
			continue;
		bench_progress(bench, (double)found / most, models[i].name);
		snprintf(name, sizeof name, "neubert-%s", models[i].name);
		code = bench_unit(bench, name, NULL, study, &work, &unit, error);
		if (code || !json_array_size(json_object_get(unit, "rows")))
			continue;
		found++;
		write_scales(table, models[i].name, unit);
		if (found <= PLANTS_QUICK)
			code = plot_diagram(bench, models[i].name, unit, error);
		if (!code && found <= PLANTS_QUICK)
			code = plot_scales(bench, models[i].name, unit, error);
	}
	bench_table_close(table);
	free(models);
	return code;
}

const struct bench_section bench_neubert = { "neubert", "Neubert 2011: scales and views", write_plants };
