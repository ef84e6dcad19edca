/* Geometry saved against Cook's stochastic simplification at equal quality, species by species: Neubert's
 * protocol (2011, section 5) for the orders of that paper and for ours (bench_savings.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/ladder/bench_savings.h"

/* plants of the data folder, in the quick bench: those with the fewest leaves */
#define READ_QUICK 3u
#define MADE_QUICK 1u            /* generated ones */

#define SPECIES_MOST 256u
#define CLOSED_VERTICES 50000u   /* of leaves; with layers of them, as the paper's crowns */
#define CLOSED_LAYERS 4.0

/* Savings of a method: mean over the distances, over those beyond the half, of all vertices together. */
enum { MEAN, FAR, TOTAL, KINDS };

struct species { struct bench_model model; struct bench_savings s; double saved[BENCH_METHODS][KINDS];
	bool closed; };
struct all { struct species *of; uint32_t count; };

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return x < y ? -1 : x > y;
}

/* In per cent, over all species or those with closed crowns. */
static double median(const struct all *all, int method, int kind, bool closed)
{
	double values[SPECIES_MOST];
	uint32_t count = 0;
	for (uint32_t i = 0; i < all->count; i++)
		if (!closed || all->of[i].closed)
			values[count++] = 100 * all->of[i].saved[method][kind];
	qsort(values, count, sizeof *values, ascending);
	return count ? (values[(count - 1) / 2] + values[count / 2]) / 2 : NAN;
}

static void write_species(struct bench *bench, const struct all *all)
{
	struct bench_table *table = bench_table_open(bench, "species", "plant,leaves,pruned: mean %,"
		"pruned: of all vertices %,simpler leaves: mean %,simpler leaves: of all vertices %", true);
	struct bench_table *layers = bench_table_open(bench, "species_layers", "plant,vertices of leaves,"
		"layers of leaves,stochastic %,at d >= .5 %,density %,density at d >= .5 %,orientation %,"
		"orientation at d >= .5 %,orientation with much noise %,orientation with much noise at d >= "
		".5 %,"
		"combined %,combined at d >= .5 %,combined with much noise %,combined with much noise at d "
		">= .5 %", true);
	for (uint32_t i = 0; i < all->count; i++) {
		const struct species *one = &all->of[i];
		const double (*v)[KINDS] = one->saved;
		char row[256];
		int at = snprintf(row, sizeof row, "%s,%u,%.1f", one->model.name, one->s.vertices,
			one->s.layers);
		for (int m = BENCH_STOCHASTIC; m <= BENCH_COMBINED_NOISY; m++)
			at += snprintf(row + at, sizeof row - (size_t)at, ",%.1f,%.1f", 100 * v[m][MEAN],
				100 * v[m][FAR]);
		bench_table_row(layers, "%s", row);
		bench_table_row(table, "%s,%u,%.1f,%.1f,%.1f,%.1f", one->model.name, one->s.elements,
			100 * v[BENCH_PRUNED][MEAN], 100 * v[BENCH_PRUNED][TOTAL], 100
			* v[BENCH_TRIANGLES][MEAN], 100 * v[BENCH_TRIANGLES][TOTAL]);
	}
	bench_table_close(table);
	bench_table_close(layers);
}

static void write_medians(struct bench *bench, const struct all *all)
{
	static const char *const printed[BENCH_METHODS] = { "10.1", "17.4", "40.7", "-", "30.1", "-", "-",
		"-", "-", "-" };
	uint32_t closed = 0;
	struct bench_table *table = bench_table_open(bench, "species_medians",
		"order (each with its best scale),median of savings %,at d >= .5 %,closed crowns: median %,"
		"closed crowns: at d >= .5 %,Neubert 2011 table 2 %", true);
	for (int m = 0; m < BENCH_METHODS; m++)
		bench_table_row(table, "%s,%.1f,%.1f,%.1f,%.1f,%s", bench_method_names[m],
			median(all, m, MEAN, false), median(all, m, FAR, false), median(all, m, MEAN, true),
			median(all, m, FAR, true), printed[m]);
	bench_table_close(table);
	for (uint32_t i = 0; i < all->count; i++)
		closed += all->of[i].closed;
	bench_say(bench, "Medians over %u plants, %u of them with closed crowns: %u vertices of leaves or "
		"more in %g layers or more. The paper's plants have 50,000 to 260,000.", all->count, closed,
		CLOSED_VERTICES, CLOSED_LAYERS);
	bench_say(bench,
		"The paper's four rows are of one camera path through 1,276 trees of its own, with depth d "
		"normalised by a distance that it does not give, and its Cook keeps areas only. Here Cook "
		"has the better "
		"of 1/lambda and of the scale that corrects for depth complexity; lambda is over foliage "
		"alone, and all "
		"distances weigh alike, evenly over [0, 1). Density and orientation (the paper's "
		"\"silhouette\") take whole "
		"regions out: on crowns in which every leaf shows that opens holes, which random thinning "
		"does not, and "
		"they fall behind what they save on the paper's closed crowns of many small leaves.");
}

/* Figures of the data folder's species. */
static enum eco_code write_keys(struct bench *bench, const struct all *all, struct eco_error *error)
{
	static const struct { const char *key, *bar; enum bench_method method; int kind; bool worst; } keys[]
		= {
		{ "saving_pruned_mean", ">= 0.76: mean over species, leaves as they are", BENCH_PRUNED, MEAN,
			false },
		{ "saving_pruned_total", ">= 0.60: of all vertices, leaves as they are", BENCH_PRUNED, TOTAL,
		false },
		{ "saving_mean", ">= 0.85: mean over species, simpler leaves too", BENCH_TRIANGLES, MEAN,
		false },
		{ "saving_total", ">= 0.70: of all vertices, simpler leaves too", BENCH_TRIANGLES, TOTAL,
		false },
		{ "saving_worst_mean", ">= 0.65: the worst species, simpler leaves too", BENCH_TRIANGLES,
		MEAN, true },
		{ "saving_worst_total", ">= 0.50: of all vertices of the worst species", BENCH_TRIANGLES,
		TOTAL, true } };
	double x[BENCH_DISTANCES], y[BENCH_METHODS][BENCH_DISTANCES] = { { 0 } };
	struct bench_series series[BENCH_METHODS];
	uint32_t count = 0;
	for (uint32_t i = 0; i < all->count; i++)
		count += !all->of[i].model.generated;
	for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
		double sum = 0, worst = INFINITY;
		for (uint32_t i = 0; i < all->count; i++) {
			double saved = all->of[i].saved[keys[k].method][keys[k].kind];
			if (!all->of[i].model.generated) {
				sum += saved / count;
				worst = fmin(worst, saved);
			}
		}
		bench_key(bench, keys[k].key, !count ? NAN : keys[k].worst ? worst : sum, keys[k].bar);
	}
	bench_key(bench, "saving_species", count, "species that count");
	for (int m = 0; m < BENCH_METHODS; m++) {
		for (uint32_t d = 0; d < BENCH_DISTANCES; d++) {
			x[d] = bench_distance(BENCH_EVEN, d);
			for (uint32_t i = 0; i < all->count; i++) {
				const struct bench_reach *at = &all->of[i].s.at[BENCH_EVEN];
				if (!all->of[i].model.generated)
					y[m][d] += 100 * (1 - at->lambda[m][d] / at->cook_lambda[d]) / count;
			}
		}
		series[m] = (struct bench_series){ bench_method_names[m], x, y[m], BENCH_DISTANCES, false };
	}
	return !count ? ECO_OK : bench_plot(bench, &(struct bench_plot){ .name = "species-savings",
		.title = "Geometry saved against Cook at equal Q, mean over species",
		.x = "distance d; Cook draws (1-d)^2 of the vertices", .y = "saved, %", .series = series,
		.series_count = BENCH_METHODS }, error);
}

static enum eco_code measure(struct bench *bench, const struct bench_model *models, uint32_t count, struct all
	*all, struct eco_error *error)
{
	uint32_t found[2] = { 0 };           /* of the data folder, generated */
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < count && !code && all->count < SPECIES_MOST; i++) {
		struct species *one = &all->of[all->count];
		uint32_t *of_kind = &found[models[i].generated];
		if (models[i].leaves < BENCH_ELEMENTS_LEAST)
			continue;
		if (*of_kind == (models[i].generated ? MADE_QUICK : READ_QUICK) && !bench->full) {
			bench_left_out(bench, models[i].name);
			continue;
		}
		bench_progress(bench, (double)i / count, models[i].name);
		one->model = models[i];
		code = bench_savings_of(bench, &one->s, models[i].name, models[i].path, error);
		if (code || one->s.elements < BENCH_ELEMENTS_LEAST)
			continue;
		one->closed = one->s.vertices >= CLOSED_VERTICES && one->s.layers >= CLOSED_LAYERS;
		for (int m = 0; m < BENCH_METHODS; m++) {
			enum bench_method method = (enum bench_method)m;
			one->saved[m][MEAN] = bench_saving_beyond(&one->s, BENCH_EVEN, method, 0);
			one->saved[m][FAR] = bench_saving_beyond(&one->s, BENCH_EVEN, method, 0.5);
			one->saved[m][TOTAL] = bench_saving_total(&one->s, BENCH_EVEN, method);
		}
		all->count++;
		++*of_kind;
	}
	return code;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct bench_model *models = NULL;
	uint32_t count = 0;
	struct all all = { calloc(SPECIES_MOST, sizeof *all.of), 0 };
	enum eco_code code = all.of ? bench_models(bench, &models, &count, error)
		: eco_fail(error, ECO_NO_MEMORY, "no memory for savings");
	code = code ? code : measure(bench, models, count, &all, error);
	if (!code && all.count) {
		write_species(bench, &all);
		write_medians(bench, &all);
		code = write_keys(bench, &all, error);
	}
	free(models);
	free(all.of);
	return code;
}

const struct bench_section bench_species = { "species", "Geometry saved against Cook at equal quality", run,
	.objects = BENCH_OBJECTS_PLANTS BENCH_OBJECTS_SAVINGS };
