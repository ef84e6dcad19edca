/* Neubert 2011: Precision and Recall by share and scale (figures 2, 3 and 5), the best scale beside Cook's
 * and in two views (figures 6 and 7). Leaves at random, wood drawn whole. */
#include <math.h>
#include <string.h>

#include "tests/bench/bench_leaves.h"

#define VIEWS 8u
#define SEED 40961u
#define PLANTS_QUICK 4u          /* these have diagrams */
#define STEP_LEAST (-12)         /* eighths of an octave about Cook's scale */
#define STEPS 25u

static const double lambdas[] = { 0.05, 0.1, 0.2, 0.4, 0.6, 0.8 };
#define LAMBDAS (sizeof lambdas / sizeof *lambdas)

static double scale_of(double lambda, uint32_t step)
{
	return exp2((STEP_LEAST + (double)step) / 8) / lambda;
}

/* Q also in the first view and in the second. */
enum { P, R, Q, Q_FIRST, Q_SECOND, FIGURES };
typedef double figures[LAMBDAS][STEPS][FIGURES];

/* The unit: the number of leaves, then figures by lambda and step. The first two views look level, a quarter
 * of a turn apart, as those of the paper's study; the others from all around. */
static json_t *study(void *ctx, struct bench_leaves *leaves)
{
	static const double level[2][3] = { { 0.8, 0.6, 0 }, { -0.6, 0.8, 0 } };
	static double values[1 + LAMBDAS * STEPS * FIGURES];
	struct lod_sights sights;
	double to[VIEWS][3], *v = values;
	const uint32_t *order = bench_leaves_order(leaves, LOD_ORDER_STOCHASTIC, 0);
	(void)ctx;
	lod_directions_spread(to, VIEWS, SEED);
	memcpy(to, level, sizeof level);
	bench_leaves_sights(leaves, &sights, (const double (*)[3])to, VIEWS);
	*v++ = leaves->foliage.count;
	for (uint32_t i = 0; i < LAMBDAS * STEPS; i++, v += FIGURES) {
		struct bench_wrong sum = { 0 };
		double lambda = lambdas[i / STEPS];
		const struct lod_sights_drawing drawing = { .order = order,
			.count = (uint32_t)fmax(1, lambda * leaves->foliage.count + 0.5),
			.scale = (float)scale_of(lambda, i % STEPS) };
		for (uint32_t view = 0; view < VIEWS; view++) {
			struct bench_wrong one = { 0 };
			bench_leaves_compare(leaves, &sights, view, &drawing, &one);
			if (view < 2)
				v[Q_FIRST + view] = bench_wrong_q(&one);
			sum.fp += one.fp;
			sum.fn += one.fn;
			sum.pixels += one.pixels;
		}
		v[P] = bench_wrong_precision(&sum);
		v[R] = bench_wrong_recall(&sum);
		v[Q] = bench_wrong_q(&sum);
	}
	return bench_reals(values, sizeof values / sizeof *values);
}

static double best_scale(figures figure, size_t lambda, int column)
{
	uint32_t best = 0;
	for (uint32_t step = 1; step < STEPS; step++)
		best = figure[lambda][step][column] > figure[lambda][best][column] ? step : best;
	return scale_of(lambdas[lambda], best);
}

static void plot(struct bench *bench, const char *name, figures figure)
{
	static const char *const words[LAMBDAS] = { "5 %", "10 %", "20 %", "40 %", "60 %",
		"80 % of the leaves" };
	double p[LAMBDAS][STEPS], r[LAMBDAS][STEPS], cook[LAMBDAS], best[LAMBDAS];
	struct bench_series series[LAMBDAS], scales[2] = { { "1 / lambda (Cook)", lambdas, cook, LAMBDAS,
		false }, { "best", lambdas, best, LAMBDAS, false } };
	char file[96], title[160];
	for (size_t l = 0; l < LAMBDAS; l++) {
		for (uint32_t step = 0; step < STEPS; step++) {
			p[l][step] = figure[l][step][P];
			r[l][step] = figure[l][step][R];
		}
		series[l] = (struct bench_series){ words[l], p[l], r[l], STEPS, true };
		cook[l] = 1 / lambdas[l];
		best[l] = best_scale(figure, l, Q);
	}
	snprintf(file, sizeof file, "neubert-pr-%s", name);
	snprintf(title, sizeof title, "%s: Precision and Recall, scales of 1/2.8 to 2.8 of Cook's", name);
	bench_plot(bench, &(struct bench_plot){ .name = file, .title = title, .x = "Precision",
		.y = "Recall", .series = series, .series_count = LAMBDAS });
	snprintf(file, sizeof file, "neubert-scale-%s", name);
	snprintf(title, sizeof title, "%s: area factor of leaves", name);
	bench_plot(bench, &(struct bench_plot){ .name = file, .title = title, .x = "lambda",
		.y = "s", .log_y = true, .series = scales, .series_count = 2 });
}

static void run(struct bench *bench)
{
	struct bench_walk walk = { .bench = bench, .leaves = 500, .most = 12, .quick = PLANTS_QUICK };
	bench_head(bench, "Precision and Recall by share and scale (figures 2, 3, 5, 6 and 7)");
	struct bench_table *table = bench_table_open(bench, "neubert_scales",
		"plant,leaves,lambda,s of Cook,best s,"
		"best s in view 1,best s in view 2,Q at Cook's,Q at best", true);
	bench_table_row(table, "%s", "Fagus Sylvatica (printed; users' choice),-,0.2,5.00,-,6.89,6.75,-,-");
	bench_table_row(table, "%s", "Fagus Sylvatica (printed; users' choice),-,0.6,1.67,-,1.94,1.81,-,-");
	for (const struct bench_model *model; (model = bench_walk(&walk));) {
		struct { double leaves; figures figure; } unit;
		bench_leaves_unit(bench, "neubert", model, study, NULL, &unit.leaves, sizeof unit / sizeof(double));
		for (size_t l = 0; l < LAMBDAS; l++) {
			double best_q = unit.figure[l][0][Q];
			for (uint32_t step = 1; step < STEPS; step++)
				best_q = fmax(best_q, unit.figure[l][step][Q]);
			bench_table_row(table, "%s,%.0f,%g,%.2f,%.2f,%.2f,%.2f,%.3f,%.3f", model->name,
				unit.leaves, lambdas[l], 1 / lambdas[l], best_scale(unit.figure, l, Q),
				best_scale(unit.figure, l, Q_FIRST), best_scale(unit.figure, l, Q_SECOND),
				unit.figure[l][-STEP_LEAST][Q], best_q);
		}
		if (walk.found[0] + walk.found[1] < PLANTS_QUICK)
			plot(bench, model->name, unit.figure);
		walk.found[model->generated]++;
	}
	bench_table_close(table);
}

const struct bench_section bench_neubert = { "neubert", "Neubert 2011: scales and views", run };
