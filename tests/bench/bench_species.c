/* Geometry saved against Cook's stochastic simplification at equal quality, species by species: Neubert's protocol (2011, section 5) for the
 * orders of that paper and for ours. bench_savings.h says how. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/bench_leaves.h"
#include "tests/bench/bench_savings.h"

#define READ_QUICK 5u            /* plants of the data folder, in the quick bench */
#define MADE_QUICK 2u            /* generated ones */

struct totals { double mean[BENCH_METHODS], total[BENCH_METHODS]; uint32_t count; };

struct summary {
	struct totals read, made;            /* of models; of generated ones */
	double worst_mean, worst_total;
	char worst_mean_of[64], worst_total_of[64];
	double owner_worse, colour_worse;    /* ours over Cook's, at the worst */
	double saved[BENCH_METHODS][BENCH_DISTANCES];        /* means over species */
};

static void add(struct summary *sum, const struct bench_model *model, const struct bench_savings *s)
{
	struct totals *t = model->generated ? &sum->made : &sum->read;
	double mean = bench_saving_mean(s, BENCH_QUADS), total = bench_saving_total(s, BENCH_QUADS);
	t->count++;
	for (int m = 0; m < BENCH_METHODS; m++) {
		t->mean[m] += bench_saving_mean(s, (enum bench_method)m);
		t->total[m] += bench_saving_total(s, (enum bench_method)m);
		for (uint32_t d = 0; d < BENCH_DISTANCES && !model->generated; d++)
			sum->saved[m][d] += 1 - s->lambda[m][d] / s->cook_lambda[d];
	}
	if (model->generated)
		return;
	if (mean < sum->worst_mean) {
		sum->worst_mean = mean;
		memcpy(sum->worst_mean_of, model->name, sizeof sum->worst_mean_of);
	}
	if (total < sum->worst_total) {
		sum->worst_total = total;
		memcpy(sum->worst_total_of, model->name, sizeof sum->worst_total_of);
	}
	for (int m = BENCH_PRUNED; m <= BENCH_QUADS; m++) {
		sum->owner_worse = fmax(sum->owner_worse, s->cook.owner_q - s->beside[m].owner_q);
		sum->colour_worse = fmax(sum->colour_worse, s->beside[m].colour_rms - s->cook.colour_rms);
	}
}

static void write_rows(struct bench_table *table, struct bench_table *curves, const struct bench_model *model, const struct bench_savings *s)
{
	for (int m = 0; m < BENCH_METHODS; m++) {
		const struct bench_beside *b = &s->beside[m];
		bench_table_row(table, "%s,%s,%u,%u,%s,%.1f,%.1f,%.3f,%.3f,%.3f,%.3f", model->name, model->generated ? "yes" : "no", s->elements, s->vertices,
			bench_method_names[m], 100 * bench_saving_mean(s, (enum bench_method)m), 100 * bench_saving_total(s, (enum bench_method)m), b->owner_q,
			s->cook.owner_q, b->colour_rms, s->cook.colour_rms);
		for (uint32_t d = 0; d < BENCH_DISTANCES; d++)
			bench_table_row(curves, "%s,%s,%.2f,%.4f,%.4f,%.5f", model->name, bench_method_names[m], bench_distance(d), s->cook_lambda[d],
				s->cook_q[d], s->lambda[m][d]);
	}
}

static double percent(const struct totals *t, const double *sums, int method)
{
	return t->count ? 100 * sums[method] / t->count : NAN;
}

static void write_means(struct bench *bench, const struct summary *sum)
{
	static const char *const printed[BENCH_METHODS] = { "10.1", "17.4", "40.7", "30.1", "-", "-", "-" };
	struct bench_table *table = bench_table_open(bench, "species_means", "order (each with its best scale),mean of savings %,of all vertices %,"
		"generated: mean %,of all vertices %,Neubert 2011 table 2 %", true);
	for (int m = 0; m < BENCH_METHODS; m++)
		bench_table_row(table, "%s,%.1f,%.1f,%.1f,%.1f,%s", bench_method_names[m], percent(&sum->read, sum->read.mean, m),
			percent(&sum->read, sum->read.total, m), percent(&sum->made, sum->made.mean, m), percent(&sum->made, sum->made.total, m), printed[m]);
	bench_table_close(table);
	bench_say(bench, "Means over %u species (and %u generated ones). The paper's four rows are of one camera path through 1,276 trees of its own, with "
		"depth d normalised by a distance that it does not give, and its Cook keeps areas only. Here Cook has the better of 1/lambda and of the scale "
		"that corrects for depth complexity; lambda is over foliage alone, so that wood does not dilute savings; and all distances weigh alike. "
		"Density and orientation take whole regions out: on crowns in which every leaf shows that opens holes, which random thinning does "
		"not, and they fall behind the paper's closed crowns of many small leaves.", sum->read.count, sum->made.count);
	bench_say(bench, "Owners and colours at equal Q, ours against Cook's (means over distances): owner Q at most %.3f lower, RMS colour error at most %.3f "
		"higher on any species. Colours are those of facing the eye; Cook's are the better of with and without the correction of contrast.",
		fmax(0, sum->owner_worse), fmax(0, sum->colour_worse));
}

static enum eco_code plot_means(struct bench *bench, const struct summary *sum, struct eco_error *error)
{
	double x[BENCH_DISTANCES], y[BENCH_METHODS][BENCH_DISTANCES];
	struct bench_series series[BENCH_METHODS];
	for (int m = 0; m < BENCH_METHODS; m++) {
		for (uint32_t d = 0; d < BENCH_DISTANCES; d++) {
			x[d] = bench_distance(d);
			y[m][d] = 100 * sum->saved[m][d] / sum->read.count;
		}
		series[m] = (struct bench_series){ bench_method_names[m], x, y[m], BENCH_DISTANCES, false };
	}
	return bench_plot(bench, &(struct bench_plot){ .name = "species-savings", .title = "Geometry saved against Cook at equal Q, mean over species",
		.x = "distance d; Cook draws (1-d)^2 of the vertices", .y = "saved, %", .series = series, .series_count = BENCH_METHODS }, error);
}

static void write_keys(struct bench *bench, const struct summary *sum)
{
	const struct totals *t = &sum->read;
	bool any = t->count > 0;
	bench_key(bench, "saving_pruned_mean", percent(t, t->mean, BENCH_PRUNED) / 100, ">= 0.76");
	bench_key(bench, "saving_pruned_total", percent(t, t->total, BENCH_PRUNED) / 100, ">= 0.60");
	bench_key(bench, "saving_mean", percent(t, t->mean, BENCH_QUADS) / 100, ">= 0.85");
	bench_key(bench, "saving_total", percent(t, t->total, BENCH_QUADS) / 100, ">= 0.70");
	bench_key(bench, "saving_worst_mean", any ? sum->worst_mean : NAN, ">= 0.65");
	bench_key(bench, "saving_worst_total", any ? sum->worst_total : NAN, ">= 0.50");
	if (any)
		bench_say(bench, "Fewest saved, leaves simplified: %.0f %% mean (%s), %.0f %% of all vertices (%s).", 100 * sum->worst_mean, sum->worst_mean_of,
			100 * sum->worst_total, sum->worst_total_of);
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct bench_model *models = NULL;
	uint32_t count = 0;
	struct summary *sum = calloc(1, sizeof *sum);
	enum eco_code code = sum ? bench_models(bench, &models, &count, error) : eco_fail(error, ECO_NO_MEMORY, "no memory for savings");
	if (code) {
		free(sum);
		return code;
	}
	sum->worst_mean = sum->worst_total = INFINITY;
	sum->owner_worse = sum->colour_worse = -INFINITY;
	struct bench_table *table = bench_table_open(bench, "species", "plant,generated,leaves,vertices,order,saved: mean %,of all vertices %,owner Q,"
		"Cook's,colour RMS,Cook's", true);
	struct bench_table *curves = bench_table_open(bench, "species_curves", "plant,order,distance,lambda of Cook,Q of Cook,lambda of the same Q", false);
	for (uint32_t i = 0; i < count && !code; i++) {
		struct bench_savings s;
		const struct bench_model *model = &models[bench->full ? i : bench_spread(i, count)];
		if (!bench->full && (model->generated ? sum->made.count == MADE_QUICK : sum->read.count == READ_QUICK))
			continue;
		bench_progress(bench, (double)i / count, model->name);
		code = bench_stopped(bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted") : bench_savings_of(bench, &s, model->name, model->path, error);
		if (code || s.elements < BENCH_ELEMENTS_LEAST)
			continue;
		add(sum, model, &s);
		write_rows(table, curves, model, &s);
	}
	bench_table_close(table);
	bench_table_close(curves);
	if (!code && sum->read.count + sum->made.count) {
		write_means(bench, sum);
		write_keys(bench, sum);
		if (sum->read.count)
			code = plot_means(bench, sum, error);
	}
	free(models);
	free(sum);
	return code;
}

const struct bench_section bench_species = { "species", "Geometry saved against Cook at equal quality", run };
