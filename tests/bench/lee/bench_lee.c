/* Lee's table: which leaves to keep under a budget, seen from where the orders were not made for.
 *
 * For a generated crown of 6,143 leaves, as many as Lee's, and models of at least 1,000 (the quick bench
 * takes a few of the data folder's; other generated plants have rows of their own, and count only where there
 * is no data folder): pixels that are wrong against the picture with all leaves, over the pixels of that
 * picture (wood is whole in both), and pixels that show another leaf. Lee draws leaves as they are; beside it
 * stands the same with leaves scaled, each method by what suits it best on other views. What a choice for the
 * very picture reaches, and what none can be better than: lod/EXPERIMENTS.md, "A proved bound".
 *
 * Sectors are cones around directions all over the upper sphere: 12 degrees wide, and 1.5. Their lists are
 * built from 16 or 24 directions in a cone and tested with others in it; one static list is built from
 * directions all around. Lee's orders are made anew for each view. */
#include <math.h>

#include "tests/bench/baseline/lee.h"
#include "tests/bench/bench.h"
#include "tests/bench/lee/bench_crown.h"
#include "tests/bench/lee/bench_lee_layers.h"
#include "tests/bench/lee/bench_lee_study.h"

#define LEAVES_LEAST 1000u
#define MODELS_QUICK 1u          /* of the data folder's, in the quick bench: those with the fewest leaves */

/* ---- Units ---- */

/* `model` NULL: the crown. */
static enum eco_code unit(struct bench *bench, const struct bench_model *model, json_t **out,
struct eco_error *error)
{
	const struct bench_lee_extent extent = { { bench->full ? 12 : 4, bench->full ? 12 : 1 },
		bench->full ? 4 : 2 };
	char name[96], stamp[64];
	snprintf(name, sizeof name, "lee-%s", model ? model->name : "crown-6143");
	snprintf(stamp, sizeof stamp, "%u %u sectors %u views %016llx", extent.sectors[LEE_NARROW],
		extent.sectors[LEE_WIDE], extent.views,
		(unsigned long long)(model ? bench_file_hash(model->path) : 0));
	if ((*out = bench_recall(bench, name, stamp)))
		return ECO_OK;
	struct eco_model read;
	enum eco_code code = model ? bench_model_read(bench, model, &read, error)
		: bench_crown_make(&read, error);
	if (!code)
		code = bench_lee_study(bench, &read, &extent, out, error);
	if (!code)
		*out = bench_keep(bench, name, stamp, *out);
	return code;
}

/* ---- Figures ---- */

static double figure(const json_t *unit, enum bench_lee_width width, int method, int share, int column)
{
	const json_t *rows = json_array_get(json_array_get(json_object_get(unit, "widths"), (size_t)width),
		(size_t)method);
	return json_number_value(json_array_get(json_array_get(rows, (size_t)share), (size_t)column));
}

static double entry(const json_t *unit, const char *key, size_t at)
{
	return json_number_value(json_array_get(json_object_get(unit, key), at));
}

static double over(double ours, double lee)
{
	return lee > 0 ? ours / lee : ours > 0 ? INFINITY : 1;
}

/* Wrong pixels of the best of Lee's three, leaves unscaled or scaled. */
static double best_of_lee(const json_t *unit, enum bench_lee_width width, int share, bool scaled)
{
	double best = INFINITY;
	for (int m = LEE_DISTANCE; m <= LEE_LAYER; m++)
		best = fmin(best, figure(unit, width, m, share, scaled ? 3 : 0));
	return best;
}

static double ratio(const json_t *unit, enum bench_lee_width width, int method, int share, bool scaled)
{
	return over(figure(unit, width, method, share, scaled ? 3 : 0),
		best_of_lee(unit, width, share, scaled));
}

/* Wrong pixels over those of the best of Lee's three. */
static const struct { enum bench_lee_width width; enum bench_lee_method method; bool scaled; const char *key,
	*name, *bars[LEE_SHARES]; } contests[] = {
	{ LEE_NARROW, LEE_SECTOR, true, "lee_ratio", "lists per 1.5-degree sector (scaled)",
		{ "<= 0.5", "<= 0.5", "<= 0.5", "<= 0.6" } },
	{ LEE_WIDE, LEE_SECTOR, true, "lee_wide_ratio", "lists per 12-degree sector (scaled)",
	{ "", "", "", "" } },
	{ LEE_NARROW, LEE_SECTOR, false, "lee_unscaled_ratio", "lists per 1.5-degree sector (unscaled)",
		{ "<= 0.5", "<= 0.5", "<= 0.5", "<= 0.6" } },
	{ LEE_WIDE, LEE_SECTOR, false, "lee_unscaled_wide_ratio", "lists per 12-degree sector (unscaled)",
	{ "", "", "", "" } },
	{ LEE_NARROW, LEE_STATIC, true, "lee_static", "one list (scaled)",
	{ "", "<= 0.8", "<= 0.7", "<= 0.75" } },
	{ LEE_NARROW, LEE_STATIC, false, "lee_unscaled_static", "one list (unscaled)",
	{ "", "<= 0.8", "<= 0.7", "<= 0.75" } },
};
#define CONTESTS (sizeof contests / sizeof *contests)

static double outcome(const json_t *unit, size_t contest, int share)
{
	return ratio(unit, contests[contest].width, (int)contests[contest].method, share,
		contests[contest].scaled);
}

/* The worst over plants, and whose they are. */
struct worst { double ratio[LEE_SHARES], sum[LEE_SHARES]; char of[LEE_SHARES][64]; uint32_t count; };

static void note_worst(struct worst *worst, const char *name, const json_t *unit)
{
	for (size_t c = 0; c < CONTESTS; c++) {
		for (int share = 0; share < LEE_SHARES; share++) {
			double now = outcome(unit, c, share);
			worst[c].sum[share] += now;
			if (worst[c].count && now <= worst[c].ratio[share])
				continue;
			worst[c].ratio[share] = now;
			snprintf(worst[c].of[share], sizeof worst[c].of[share], "%s", name);
		}
		worst[c].count++;
	}
}

/* ---- Report ---- */

/* Size of all lists of a width: an order is n log2 n bits, and three more a leaf say how far it follows the
 * scale. */
static double lists_mb(const json_t *unit, enum bench_lee_width width)
{
	double leaves = (double)json_integer_value(json_object_get(unit, "leaves"));
	return entry(unit, "lists", (size_t)width) * leaves * (log2(leaves) + 3) / 8e6;
}

static void write_rows(struct bench_table *table, struct bench_table *ratios, const char *name,
	const json_t *unit)
{
	int leaves = (int)json_integer_value(json_object_get(unit, "leaves"));
	for (int width = 0; width < LEE_WIDTHS; width++)
		for (int m = 0; m < LEE_METHODS; m++)
			for (int share = 0; share < LEE_SHARES && (width == LEE_NARROW || m == LEE_SECTOR);
					share++)
				bench_table_row(table, "%s,%d,%s%s,%u,%.2f,%.2f,%.2f,%.2f,%.2f,%.3f,%.3f",
					name, leaves, bench_lee_methods[m], width == LEE_NARROW ? ""
					: " (12 degrees)", bench_lee_percent[share],
					100 * figure(unit, (enum bench_lee_width)width, m, share, 0),
					100 * figure(unit, (enum bench_lee_width)width, m, share, 1),
					figure(unit, (enum bench_lee_width)width, m, share, 2),
					100 * figure(unit, (enum bench_lee_width)width, m, share, 3),
					100 * figure(unit, (enum bench_lee_width)width, m, share, 4),
					ratio(unit, (enum bench_lee_width)width, m, share, false),
					ratio(unit, (enum bench_lee_width)width, m, share, true));
	for (size_t c = 0; c < CONTESTS; c++) {
		char size[32] = "";
		if (contests[c].method == LEE_SECTOR)
			snprintf(size, sizeof size, "%.2f", lists_mb(unit, contests[c].width));
		bench_table_row(ratios, "%s,%d,%s,%.3f,%.3f,%.3f,%.3f,%s", name, leaves, contests[c].name,
			outcome(unit, c, 0), outcome(unit, c, 1), outcome(unit, c, 2), outcome(unit, c, 3),
			size);
	}
}

/* Lee's table, as it is printed in the paper, with ours below. */
static void write_crown(struct bench *bench, const json_t *unit)
{
	struct bench_table *table = bench_table_open(bench, "lee_crown",
		"crown of 6143 leaves: wrong %,at 80 %,at 50 %,at 30 %,at 10 %,scaled: at 80 %,"
		"scaled: at 50 %,scaled: at 30 %,scaled: at 10 %,other leaf: at 80 %,other leaf: at 50 "
		"%,other leaf: at 30 %,other leaf: at 10 %", true);
	static const int columns[] = { 0, 3, 1 };
	for (int width = 0; width < LEE_WIDTHS; width++)
		for (int m = 0; m < LEE_METHODS; m++) {
			char row[256];
			int at = snprintf(row, sizeof row, "%s%s", bench_lee_methods[m],
				width == LEE_NARROW ? "" : " (12 degrees)");
			for (int i = 0; i < 3 * LEE_SHARES; i++)
				at += snprintf(row + at, sizeof row - (size_t)at, ",%.1f",
					100 * figure(unit, (enum bench_lee_width)width, m, i % LEE_SHARES,
					columns[i / LEE_SHARES]));
			if (width == LEE_NARROW || m == LEE_SECTOR)
				bench_table_row(table, "%s", row);
		}
	bench_table_close(table);
}

static enum eco_code plot_crown(struct bench *bench, const json_t *unit, struct eco_error *error)
{
	static const int shown[] = { LEE_DISTANCE, LEE_NORMAL, LEE_LAYER, LEE_STOCHASTIC, LEE_COMBINED,
		LEE_STATIC, LEE_SECTOR };
	double x[LEE_SHARES], y[LEE_METHODS][LEE_SHARES];
	struct bench_series series[LEE_METHODS];
	uint32_t count = 0;
	for (size_t i = 0; i < sizeof shown / sizeof *shown; i++) {
		for (int share = 0; share < LEE_SHARES; share++) {
			x[share] = bench_lee_percent[share];
			y[i][share] = 100 * figure(unit, LEE_NARROW, shown[i], share, 0);
		}
		series[count++] = (struct bench_series){ bench_lee_methods[shown[i]], x, y[i], LEE_SHARES,
			false };
	}
	return bench_plot(bench,
		&(struct bench_plot){ .name = "lee-crown", .title = "Crown of 6,143 leaves, unscaled",
		.x = "leaves kept, %",
		.y = "wrong pixels, % of the reference", .series = series, .series_count = count }, error);
}

static void write_keys(struct bench *bench, const struct worst *worst)
{
	for (size_t c = 0; c < CONTESTS; c++) {
		const struct worst *w = &worst[c];
		for (int share = 0; share < LEE_SHARES; share++) {
			char key[48], bar[96];
			const char *words = contests[c].bars[share];
			snprintf(key, sizeof key, "%s_%u", contests[c].key, bench_lee_percent[share]);
			snprintf(bar, sizeof bar, "%s%s%s", words, *words ? ": " : "", contests[c].name);
			bench_key(bench, key, w->ratio[share], bar);
		}
		bench_say(bench, "Wrong pixels over those of the best of Lee's three at 80, 50, 30 and 10 "
			"%% of the leaves, %s: mean over %u plants %.2f, "
			"%.2f, %.2f, %.2f; worst %.2f (%s), %.2f (%s), %.2f (%s), %.2f (%s).",
			contests[c].name, w->count, w->sum[0] / w->count, w->sum[1] / w->count,
			w->sum[2] / w->count, w->sum[3] / w->count, w->ratio[0], w->of[0], w->ratio[1],
			w->of[1], w->ratio[2], w->of[2], w->ratio[3], w->of[3]);
	}
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct bench_model *models = NULL;
	uint32_t count = 0;
	struct worst worst[CONTESTS] = { 0 };
	enum eco_code code = bench_models(bench, &models, &count, error);
	if (code)
		return code;
	struct bench_table *table = bench_table_open(bench, "lee", "plant,leaves,method,kept %,wrong "
		"%,other leaf %,scale,scaled wrong %,"
		"scaled other leaf %,wrong over Lee's best,scaled wrong over Lee's best", false);
	struct bench_table *ratios = bench_table_open(bench, "lee_ratios",
		"plant,leaves,wrong over Lee's best,80 %,50 %,30 %,10 %,lists MB", true);
	for (uint32_t i = 0, found = 0; i <= count && !code; i++) {
		json_t *one;
		const struct bench_model *model = i ? &models[i - 1] : NULL;
		const char *name = model ? model->name : "crown of 6143 leaves";
		if (model
				&& (model->leaves < LEAVES_LEAST
				|| (model->generated && !bench->full && bench->data)))
			continue;
		if (!bench->full && found > MODELS_QUICK) {
			bench_left_out(bench, name);
			continue;
		}
		bench_progress(bench, (double)i / (count + 1), name);
		code = unit(bench, model, &one, error);
		if (code || json_integer_value(json_object_get(one, "leaves")) < (json_int_t)LEAVES_LEAST)
			continue;
		found++;
		if (!model || !model->generated || !bench->data)
			note_worst(worst, name, one);
		write_rows(table, ratios, name, one);
		if (i == 0) {
			write_crown(bench, one);
			code = plot_crown(bench, one, error);
		}
	}
	bench_table_close(table);
	bench_table_close(ratios);
	free(models);
	if (!code) {
		bench_say(bench, "Lee, Peng and Kuo print, for a tree of 6,143 leaves at 80, 50, 30 and 10 "
			"%%: distance 3.03, 9.09, 14.03, 18.42; "
			"normal 5.31, 12.87, 16.49, 19.13; layer+normal 2.86, 10.06, 15.07, 18.75 %% "
			"incorrect pixels, without saying of what. Ours are "
			"of the reference's pixels; layers: %u.", LOD_LEE_LAYERS);
		bench_say(bench, "Lists per sector are many: lists MB is what all of a width take as n log2 "
			"n + 3 n bits each, side and top views.");
		write_keys(bench, worst);
		code = bench_lee_layers(bench, error);
	}
	return code;
}

const struct bench_section bench_lee = { "lee", "Which leaves to keep: Lee's orders and ours", run,
	.objects = BENCH_OBJECTS_PLANTS "tests/bench/lee/bench_lee.o tests/bench/lee/bench_lee_study.o "
	"tests/bench/lee/bench_lee_layers.o tests/bench/lee/bench_crown.o" };
