/* Geometry saved against Cook's stochastic simplification at equal quality, species by species: Neubert's
 * protocol (2011, section 5) for the orders of that paper and for ours. bench_savings.h says how. */
#include <math.h>
#include <stdlib.h>

#include "tests/bench/ladder/bench_savings.h"

/* plants of the data folder, in the quick bench: those with the fewest leaves */
#define READ_QUICK 3u
#define MADE_QUICK 1u            /* generated ones */

#define SPECIES_MOST 256u        /* in medians */
#define CLOSED_VERTICES 50000u   /* of leaves; with layers of them, as the paper's crowns */
#define CLOSED_LAYERS 4.0

struct totals { double mean[BENCH_SPACINGS][BENCH_METHODS], total[BENCH_SPACINGS][BENCH_METHODS];
	uint32_t count; };

/* Of each species: the mean over all distances, and over those beyond the half. */
struct medians { double all[BENCH_METHODS][SPECIES_MOST], far[BENCH_METHODS][SPECIES_MOST];
	uint32_t count; };

struct worst { double mean, total; char mean_of[64], total_of[64]; };

struct summary {
	struct totals read, made;            /* of models; of generated ones */
	struct medians every, closed;        /* of both; of those with closed crowns */
	struct worst worst[BENCH_SPACINGS];  /* with simpler leaves */
	double owner_worse, colour_worse;    /* ours over Cook's, at the worst */
	double saved[BENCH_METHODS][BENCH_DISTANCES];        /* means over species, even distances */
};

static void note_least(double *least, char of[64], double now, const char *name)
{
	if (now >= *least)
		return;
	*least = now;
	snprintf(of, 64, "%s", name);
}

static void add_species(struct medians *medians, const struct bench_savings *s)
{
	if (medians->count == SPECIES_MOST)
		return;
	for (int m = 0; m < BENCH_METHODS; m++) {
		enum bench_method method = (enum bench_method)m;
		medians->all[m][medians->count] = bench_saving_mean(s, BENCH_EVEN, method);
		medians->far[m][medians->count] = bench_saving_beyond(s, BENCH_EVEN, method, 0.5);
	}
	medians->count++;
}

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return x < y ? -1 : x > y;
}

/* In per cent; sorts the values. */
static double median(double *values, uint32_t count)
{
	qsort(values, count, sizeof *values, ascending);
	return count ? 50 * (values[(count - 1) / 2] + values[count / 2]) : NAN;
}

static void add(struct summary *sum, const struct bench_model *model, const struct bench_savings *s)
{
	struct totals *t = model->generated ? &sum->made : &sum->read;
	t->count++;
	add_species(&sum->every, s);
	if (s->vertices >= CLOSED_VERTICES && s->layers >= CLOSED_LAYERS)
		add_species(&sum->closed, s);
	for (int i = 0; i < BENCH_SPACINGS * BENCH_METHODS; i++) {
		enum bench_spacing g = (enum bench_spacing)(i / BENCH_METHODS);
		enum bench_method m = (enum bench_method)(i % BENCH_METHODS);
		t->mean[g][m] += bench_saving_mean(s, g, m);
		t->total[g][m] += bench_saving_total(s, g, m);
	}
	if (model->generated)
		return;
	for (int i = 0; i < BENCH_METHODS * (int)BENCH_DISTANCES; i++) {
		int m = i / (int)BENCH_DISTANCES, d = i % (int)BENCH_DISTANCES;
		sum->saved[m][d] += 1 - s->at[BENCH_EVEN].lambda[m][d] / s->at[BENCH_EVEN].cook_lambda[d];
	}
	for (int g = 0; g < BENCH_SPACINGS; g++) {
		note_least(&sum->worst[g].mean, sum->worst[g].mean_of,
			bench_saving_mean(s, (enum bench_spacing)g, BENCH_TRIANGLES), model->name);
		note_least(&sum->worst[g].total, sum->worst[g].total_of,
			bench_saving_total(s, (enum bench_spacing)g, BENCH_TRIANGLES), model->name);
	}
	for (int m = BENCH_PRUNED; m <= BENCH_TRIANGLES; m++) {
		sum->owner_worse = fmax(sum->owner_worse, s->cook.owner_q - s->beside[m].owner_q);
		sum->colour_worse = fmax(sum->colour_worse, s->beside[m].colour_rms - s->cook.colour_rms);
	}
}

struct tables { struct bench_table *ours, *all, *curves, *layers; };

static void write_rows(const struct tables *t, const struct bench_model *model, const struct bench_savings *s)
{
	double percent[BENCH_METHODS][BENCH_SPACINGS][2];
	for (int m = 0; m < BENCH_METHODS; m++)
		for (int g = 0; g < BENCH_SPACINGS; g++) {
			const struct bench_reach *at = &s->at[g];
			percent[m][g][0] = 100 * bench_saving_mean(s, (enum bench_spacing)g,
				(enum bench_method)m);
			percent[m][g][1] = 100 * bench_saving_total(s, (enum bench_spacing)g,
				(enum bench_method)m);
			for (uint32_t d = 0; d < BENCH_DISTANCES; d++)
				bench_table_row(t->curves, "%s,%s,%s,%.2f,%.4f,%.4f,%.5f", model->name,
					bench_method_names[m], g == BENCH_EVEN ? "even" : "paper's",
					bench_distance((enum bench_spacing)g, d), at->cook_lambda[d],
					at->cook_q[d], at->lambda[m][d]);
		}
	for (int m = 0; m < BENCH_METHODS; m++)
		bench_table_row(t->all, "%s,%s,%u,%u,%s,%.1f,%.1f,%.1f,%.1f,%.3f,%.3f,%.3f,%.3f", model->name,
			model->generated ? "yes" : "no", s->elements, s->vertices, bench_method_names[m],
			percent[m][0][0], percent[m][0][1], percent[m][1][0], percent[m][1][1],
			s->beside[m].owner_q, s->cook.owner_q, s->beside[m].colour_rms, s->cook.colour_rms);
	char row[256];
	int at = snprintf(row, sizeof row, "%s,%u,%.1f", model->name, s->vertices, s->layers);
	for (int m = BENCH_STOCHASTIC; m <= BENCH_COMBINED_NOISY; m++)
		at += snprintf(row + at, sizeof row - (size_t)at, ",%.1f,%.1f", percent[m][0][0],
			100 * bench_saving_beyond(s, BENCH_EVEN, (enum bench_method)m, 0.5));
	bench_table_row(t->layers, "%s", row);
	bench_table_row(t->ours, "%s,%u,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f,%.3f,%.3f,%.3f,%.3f,%.3f,"
		"%.3f", model->name, s->elements, percent[BENCH_PRUNED][0][0], percent[BENCH_PRUNED][0][1],
		percent[BENCH_TRIANGLES][0][0], percent[BENCH_TRIANGLES][0][1], percent[BENCH_PRUNED][1][0],
		percent[BENCH_PRUNED][1][1], percent[BENCH_TRIANGLES][1][0], percent[BENCH_TRIANGLES][1][1],
		s->beside[BENCH_PRUNED].owner_q, s->beside[BENCH_TRIANGLES].owner_q, s->cook.owner_q,
		s->beside[BENCH_PRUNED].colour_rms, s->beside[BENCH_TRIANGLES].colour_rms,
		s->cook.colour_rms);
}

static double percent(const struct totals *t, const double *sums, int method)
{
	return t->count ? 100 * sums[method] / t->count : NAN;
}

static void write_means(struct bench *bench, struct summary *sum)
{
	static const char *const printed[BENCH_METHODS] = { "10.1", "17.4", "40.7", "-", "30.1", "-", "-",
		"-", "-", "-" };
	struct bench_table *table = bench_table_open(bench, "species_means",
		"order (each with its best scale),mean of savings %,of all vertices %,"
		"paper's distances: mean %,paper's distances: of all vertices %,generated plants: mean "
		"%,generated plants: of all vertices %,"
		"Neubert 2011 table 2 %", true);
	struct bench_table *medians = bench_table_open(bench, "species_medians",
		"order (each with its best scale),median of savings %,at d >= .5 %,closed crowns: median %,"
		"closed crowns: at d >= .5 %,Neubert 2011 table 2 %", true);
	for (int m = 0; m < BENCH_METHODS; m++)
		bench_table_row(table, "%s,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f,%s", bench_method_names[m],
			percent(&sum->read, sum->read.mean[BENCH_EVEN], m),
			percent(&sum->read, sum->read.total[BENCH_EVEN], m),
			percent(&sum->read, sum->read.mean[BENCH_NEAR], m),
			percent(&sum->read, sum->read.total[BENCH_NEAR], m),
			percent(&sum->made, sum->made.mean[BENCH_EVEN], m),
			percent(&sum->made, sum->made.total[BENCH_EVEN], m), printed[m]);
	for (int m = 0; m < BENCH_METHODS; m++)
		bench_table_row(medians, "%s,%.1f,%.1f,%.1f,%.1f,%s", bench_method_names[m],
			median(sum->every.all[m], sum->every.count),
			median(sum->every.far[m], sum->every.count),
			median(sum->closed.all[m], sum->closed.count),
			median(sum->closed.far[m], sum->closed.count), printed[m]);
	bench_table_close(table);
	bench_table_close(medians);
	bench_say(bench, "Medians over %u plants, %u of them with closed crowns: %u vertices of leaves or "
		"more in %g layers or more. The paper's plants have 50,000 to 260,000.", sum->every.count,
		sum->closed.count, CLOSED_VERTICES, CLOSED_LAYERS);
	bench_say(bench, "Means over %u species (and %u generated ones). Two ways to space the 20 distances "
		"stand side by side: evenly over [0, "
		"1), which "
		"weighs a plant at any distance alike and is what the bars are about; and the points at "
		"which the paper tabulates its curves, ten of "
		"them within [0, 0.1), where Cook draws over 81 %% of all vertices and hardly anything can "
		"be saved at equal quality. The paper's points "
		"say where its table is fine, not where plants stand.", sum->read.count, sum->made.count);
	bench_say(bench, "The paper's four rows are of one camera path through 1,276 trees of its own, with "
		"depth d normalised by a distance that it "
		"does not give, and its Cook keeps areas only. Here Cook has the better of 1/lambda and of "
		"the scale that corrects for depth "
		"complexity; lambda "
		"is over foliage alone, so that wood does not dilute savings; and all distances weigh "
		"alike. Density and orientation (the paper's "
		"\"silhouette\") take whole regions out: on crowns in which every leaf shows that opens "
		"holes, which random thinning does not, and they "
		"fall behind what they save on the paper's closed crowns of many small leaves.");
	bench_say(bench, "Owners and colours at equal Q, ours against Cook's (means over distances): owner "
		"Q at most %.3f lower, RMS colour error at "
		"most %.3f higher on any species. An owner here is a single leaf. Colours are those of "
		"facing the eye; Cook's are the better of with and "
		"without the correction of contrast.", fmax(0, sum->owner_worse), fmax(0, sum->colour_worse));
	bench_say(bench, "What is drawn in place of several leaves hides whose pixels they are. For four of "
		"sixteen species Cook's owner Q is out of reach "
		"where so much is saved, which was proved (lod/EXPERIMENTS.md, \"Owners and colours\").");
}

static enum eco_code plot_means(struct bench *bench, const struct summary *sum, struct eco_error *error)
{
	double x[BENCH_DISTANCES], y[BENCH_METHODS][BENCH_DISTANCES];
	struct bench_series series[BENCH_METHODS];
	for (int m = 0; m < BENCH_METHODS; m++) {
		for (uint32_t d = 0; d < BENCH_DISTANCES; d++) {
			x[d] = bench_distance(BENCH_EVEN, d);
			y[m][d] = 100 * sum->saved[m][d] / sum->read.count;
		}
		series[m] = (struct bench_series){ bench_method_names[m], x, y[m], BENCH_DISTANCES, false };
	}
	return bench_plot(bench,
		&(struct bench_plot){ .name = "species-savings", .title = "Geometry saved against Cook at "
		"equal Q, mean over species",
		.x = "distance d; Cook draws (1-d)^2 of the vertices", .y = "saved, %", .series = series,
		.series_count = BENCH_METHODS }, error);
}

static void write_keys(struct bench *bench, const struct summary *sum)
{
	static const struct { const char *key, *near, *bar; enum bench_method method; bool total, worst;
		} keys[] = {
		{ "saving_pruned_mean", "saving_pruned_mean_near",
			">= 0.76: mean over species, leaves as they are", BENCH_PRUNED, false, false },
		{ "saving_pruned_total", "saving_pruned_total_near",
			">= 0.60: of all vertices, leaves as they are", BENCH_PRUNED, true, false },
		{ "saving_mean", "saving_mean_near", ">= 0.85: mean over species, simpler leaves too",
			BENCH_TRIANGLES, false, false },
		{ "saving_total", "saving_total_near", ">= 0.70: of all vertices, simpler leaves too",
			BENCH_TRIANGLES, true, false },
		{ "saving_worst_mean", "saving_worst_mean_near", ">= 0.65: the worst species, simpler "
			"leaves too", BENCH_TRIANGLES, false, true },
		{ "saving_worst_total", "saving_worst_total_near",
			">= 0.50: of all vertices of the worst species", BENCH_TRIANGLES, true, true } };
	const struct totals *t = &sum->read;
	bool any = t->count > 0;
	for (int i = 0; i < BENCH_SPACINGS * (int)(sizeof keys / sizeof *keys); i++) {
		int g = i / (int)(sizeof keys / sizeof *keys), k = i % (int)(sizeof keys / sizeof *keys);
		const struct worst *w = &sum->worst[g];
		double mean = percent(t, keys[k].total ? t->total[g] : t->mean[g], keys[k].method) / 100,
			least = keys[k].total ? w->total : w->mean;
		bench_key(bench, g == BENCH_EVEN ? keys[k].key : keys[k].near, !any ? NAN : keys[k].worst
			? least : mean, g == BENCH_EVEN ? keys[k].bar
			: "beside it: the distances of the paper's table");
	}
	bench_key(bench, "saving_species", t->count, "species that count");
	bench_key(bench, "saving_owner_q_lost", any ? fmax(0, sum->owner_worse) : NAN,
		"<= 0: owner Q below Cook's at equal Q, worst species");
	bench_key(bench, "saving_colour_lost", any ? fmax(0, sum->colour_worse) : NAN,
		"<= 0: colour RMS above Cook's at equal Q, worst species");
	if (any)
		bench_say(bench, "Fewest saved, leaves simplified: %.0f %% mean (%s), %.0f %% of all "
			"vertices (%s).", 100 * sum->worst[BENCH_EVEN].mean, sum->worst[BENCH_EVEN].mean_of,
			100 * sum->worst[BENCH_EVEN].total, sum->worst[BENCH_EVEN].total_of);
}

static struct tables open_tables(struct bench *bench)
{
	return (struct tables){
		.ours = bench_table_open(bench, "species", "plant,leaves,pruned: mean %,pruned: of all "
			"vertices %,simpler leaves: mean %,"
			"simpler leaves: of all vertices %,paper's distances; pruned: mean %,paper's; "
			"pruned: of all vertices %,paper's; simpler leaves: mean %,"
			"paper's; simpler leaves: of all vertices %,owner Q: pruned,owner Q: simpler "
			"leaves,owner Q: Cook's,"
			"colour RMS: pruned,colour RMS: simpler leaves,colour RMS: Cook's", true),
		.all = bench_table_open(bench, "species_orders", "plant,generated,leaves,vertices,order,"
		"saved: mean %,saved: of all vertices %,paper's "
			"distances: mean %,paper's distances: of all vertices %,owner Q,owner Q of "
			"Cook's,colour RMS,colour RMS of Cook's", false),
		.curves = bench_table_open(bench, "species_curves",
		"plant,order,distances,distance,lambda of Cook,Q of Cook,lambda of the same Q", false),
		.layers = bench_table_open(bench, "species_layers", "plant,vertices of leaves,"
		"layers of leaves,"
		"stochastic %,at d >= .5 %,density %,density at d >= .5 %,orientation %,"
		"orientation at d >= .5 %,orientation with much noise %,"
		"orientation with much noise at d >= .5 %,"
		"combined %,combined at d >= .5 %,combined with much noise %,"
		"combined with much noise at d >= .5 %", true) };
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct bench_model *models = NULL;
	uint32_t count = 0;
	struct summary *sum = calloc(1, sizeof *sum);
	enum eco_code code = sum ? bench_models(bench, &models, &count, error)
		: eco_fail(error, ECO_NO_MEMORY, "no memory for savings");
	if (code) {
		free(sum);
		return code;
	}
	for (int g = 0; g < BENCH_SPACINGS; g++)
		sum->worst[g].mean = sum->worst[g].total = INFINITY;
	sum->owner_worse = sum->colour_worse = -INFINITY;
	const struct tables tables = open_tables(bench);
	for (uint32_t i = 0; i < count && !code; i++) {
		struct bench_savings s;
		const struct bench_model *model = &models[i];
		bool enough = model->generated ? sum->made.count == MADE_QUICK : sum->read.count
			== READ_QUICK;
		if (model->leaves < BENCH_ELEMENTS_LEAST)
			continue;
		if (enough && !bench->full) {
			bench_left_out(bench, model->name);
			continue;
		}
		bench_progress(bench, (double)i / count, model->name);
		code = bench_stopped(bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
			: bench_savings_of(bench, &s, model->name, model->path, error);
		if (code || s.elements < BENCH_ELEMENTS_LEAST)
			continue;
		add(sum, model, &s);
		write_rows(&tables, model, &s);
	}
	bench_table_close(tables.ours);
	bench_table_close(tables.all);
	bench_table_close(tables.curves);
	bench_table_close(tables.layers);
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

const struct bench_section bench_species = { "species", "Geometry saved against Cook at equal quality", run,
	.objects = BENCH_OBJECTS_PLANTS BENCH_OBJECTS_SAVINGS };
