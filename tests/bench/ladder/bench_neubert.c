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

struct point { double p, r, q; };

static struct point point_of(const struct bench_wrong *wrong)
{
	double right = (double)(wrong->pixels - wrong->fn), shown = right + (double)wrong->fp;
	return (struct point){ shown > 0 ? right / shown : 1,
		wrong->pixels ? right / (double)wrong->pixels : 1, bench_wrong_q(wrong) };
}

static double scale_of(double lambda, uint32_t step)
{
	return exp2((STEP_LEAST + (double)step) / 8) / lambda;
}

/* {"leaves", "rows": per lambda and step [P, R, Q, Q in the first view, Q in the second]} */
static json_t *measure(struct bench_leaves *leaves, const struct lod_sights *sights, const uint32_t *order)
{
	json_t *rows = json_array();
	for (size_t l = 0; l < LAMBDAS; l++)
		for (uint32_t step = 0; step < STEPS; step++) {
			struct bench_wrong sum = { 0 };
			double q[2] = { 0, 0 };
			double kept = lambdas[l] * leaves->foliage.count;
			const struct lod_sights_drawing drawing = { .order = order,
				.count = (uint32_t)fmax(1, kept + 0.5),
				.scale = (float)scale_of(lambdas[l], step) };
			for (uint32_t v = 0; v < sights->count; v++) {
				struct bench_wrong one = { 0 };
				bench_leaves_compare(leaves, sights, v, &drawing, &one);
				if (v < 2)
					q[v] = bench_wrong_q(&one);
				sum.fp += one.fp;
				sum.fn += one.fn;
				sum.pixels += one.pixels;
			}
			struct point at = point_of(&sum);
			json_array_append_new(rows, json_pack("[fffff]", at.p, at.r, at.q, q[0], q[1]));
		}
	return json_pack("{s:i, s:o}", "leaves", (int)leaves->foliage.count, "rows", rows);
}

/* The first two views look level, a quarter of a turn apart, as those of the paper's study; the others from
 * all around. */
static void directions(double out[VIEWS][3])
{
	static const double level[2][3] = { { 0.8, 0.6, 0 }, { -0.6, 0.8, 0 } };
	lod_directions_spread(out, VIEWS, SEED);
	memcpy(out, level, sizeof level);
}

static enum eco_code study_leaves(struct bench_leaves *leaves, json_t **unit, struct eco_error *error)
{
	struct lod_sights sights = { 0 };
	double to[VIEWS][3];
	volatile enum eco_code code = ECO_OK;
	directions(to);
	if (setjmp(leaves->arena.failed)) {
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for %u leaves", leaves->foliage.count);
	} else {
		code = lod_sights_make(&sights, &leaves->foliage, (const double (*)[3])to, VIEWS, PIXELS,
			&leaves->arena, error);
		if (!code)
			*unit = measure(leaves, &sights,
				bench_leaves_order(leaves, LOD_ORDER_STOCHASTIC, 0));
	}
	return code;
}

/* Kept as {"leaves": 0} for what has too few. */
static enum eco_code study(struct bench *bench, const struct bench_model *model, json_t **unit,
	struct eco_error *error)
{
	char name[96];
	snprintf(name, sizeof name, "neubert-%s", model->name);
	*unit = bench_recall(bench, name, NULL);
	if (*unit)
		return ECO_OK;
	struct eco_model read = { 0 };
	struct bench_leaves leaves;
	enum eco_code code = bench_model_read(bench, model, &read, error);
	json_t *made = NULL;
	code = code ? code : bench_leaves_open(&leaves, &read, PIXELS, error);
	if (code)
		return code;
	if (leaves.foliage.count < LEAVES_LEAST)
		made = json_pack("{s:i}", "leaves", 0);
	else
		code = study_leaves(&leaves, &made, error);
	bench_leaves_close(&leaves);
	if (!code)
		*unit = bench_keep(bench, name, NULL, made);
	return code;
}

/* ---- Tables ---- */

static double value(const json_t *unit, size_t lambda, uint32_t step, size_t column)
{
	const json_t *row = json_array_get(json_object_get(unit, "rows"), lambda * STEPS + step);
	return json_number_value(json_array_get(row, column));
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
		uint32_t best = best_step(unit, l, 2), cook = (uint32_t)-STEP_LEAST;
		bench_table_row(table, "%s,%d,%g,%.2f,%.2f,%.2f,%.2f,%.3f,%.3f", name,
			(int)json_integer_value(json_object_get(unit, "leaves")), lambdas[l], 1 / lambdas[l],
			scale_of(lambdas[l], best), scale_of(lambdas[l], best_step(unit, l, 3)),
			scale_of(lambdas[l], best_step(unit, l, 4)), value(unit, l, cook, 2),
			value(unit, l, best, 2));
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
			p[l][step] = value(unit, l, step, 0);
			r[l][step] = value(unit, l, step, 1);
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
		best[l] = scale_of(lambdas[l], best_step(unit, l, 2));
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
		json_t *unit = NULL;
		if (models[i].leaves < LEAVES_LEAST)
			continue;
		bench_progress(bench, 0.5 * found / most, models[i].name);
		code = study(bench, &models[i], &unit, error);
		if (code || !json_integer_value(json_object_get(unit, "leaves")))
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

const struct bench_section bench_neubert = { "neubert", "Neubert 2011: scales and views", write_plants,
	.objects = BENCH_OBJECTS_PLANTS "tests/bench/ladder/bench_neubert.o" };
