/* The headline: geometry that packs' own ladders save against Cook at equal Q, of plants that no constant was
 * chosen on. bench_ladder_plant.h says how. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/bench/ladder/bench_ladder_plant.h"
#include "tests/bench/bench_state.h"

#define SEEDS 5u
#define SEEDS_QUICK 1u
#define PLANTS_MOST 64u
#define READ_QUICK 2u /* plants of the data folder, and generated ones, in the quick bench */
#define MADE_QUICK 1u
#define LEAVES_MOST 12000u /* larger plants take minutes for each seed */

/* Models that constants were chosen on, by the beginnings of their files' names (lod/EXPERIMENTS.md). */
static const char *const tuned[] = { "sapling_quaking_aspen", "sapling_callistemon", "sapling_white_birch",
	"bush.", "poplar.", "eztree_oak_large", "eztree_pine_medium", "coconutTree", "augalas", "plant.",
	"orchids", "cypress" };

/* Generated scenes of other seeds and details than those that constants were chosen on. */
static const struct {
	const char *scene;
	uint32_t seed;
	const char *detail, *plants[5];
} made[] = { { "park", 7, "2", { "azalea", "palm", "birch" } },
	{ "forest", 5, "0.6", { "maple", "pine", "shrub", "spruce" } },
	{ "grove", 11, "0.4", { "beech", "oak", "linden" } } };

struct plant {
	struct bench_model model;
	struct bench_ladder_curve splats;
	struct bench_ladder *seeds;
	uint32_t seed_count;
};

struct headline {
	struct plant plants[PLANTS_MOST];
	uint32_t count;
};

/* ---- Plants ---- */

bool bench_ladder_tuned(const char *name)
{
	for (size_t i = 0; i < sizeof tuned / sizeof *tuned; i++)
		if (!strncmp(name, tuned[i], strlen(tuned[i])))
			return true;
	return false;
}

/* `quick`: the quick bench looks at it, too. */
static void add_or_leave(struct bench *bench, struct headline *h, const struct bench_model *model, bool quick)
{
	if (!bench->full && !quick)
		bench_left_out(bench, model->name);
	else if (h->count < PLANTS_MOST)
		h->plants[h->count++] = (struct plant){ .model = *model };
}

static enum eco_code find_read(struct bench *bench, struct headline *h, struct eco_error *error)
{
	struct bench_model *models = NULL;
	uint32_t count = 0;
	enum eco_code code = bench_models(bench, &models, &count, error);
	for (uint32_t i = 0; i < count && !code; i++)
		if (!models[i].generated && !bench_ladder_tuned(models[i].name) &&
			models[i].leaves >= BENCH_ELEMENTS_LEAST && models[i].leaves <= LEAVES_MOST)
			add_or_leave(bench, h, &models[i], h->count < READ_QUICK);
	free(models);
	return code;
}

static enum eco_code find_made(struct bench *bench, struct headline *h, struct eco_error *error)
{
	uint32_t before = h->count;
	enum eco_code code = ECO_OK;
	for (size_t i = 0; i < sizeof made / sizeof *made && !code; i++) {
		char folder[400];
		snprintf(folder, sizeof folder, "%s/scenes/ladder-%s", bench->cache, made[i].scene);
		if (access(folder, R_OK))
			code = bench_command(bench, error,
				"mkdir -p '%s.tmp' && '%s/ecopack' generate %s -o "
				"'%s.tmp' --plants 20 --seed %u --detail %s --quiet && mv '%s.tmp' '%s'",
				folder, bench->build, made[i].scene, folder, made[i].seed, made[i].detail,
				folder, folder);
		for (size_t k = 0; k < 5 && made[i].plants[k] && !code; k++) {
			struct bench_model model = { .generated = true };
			snprintf(model.name, sizeof model.name, "generated-%s", made[i].plants[k]);
			snprintf(model.path, sizeof model.path, "%s/models/%s.obj", folder,
				made[i].plants[k]);
			add_or_leave(bench, h, &model, k == 0 && h->count - before < MADE_QUICK);
		}
	}
	return code;
}

/* ---- Units ---- */

static json_t *pack_curve(const struct bench_ladder_curve *curve)
{
	json_t *rows = json_array();
	for (uint32_t i = 0; i < curve->count; i++)
		json_array_append_new(rows,
			json_pack("[f,f,f]", curve->at[i].lambda, curve->at[i].tuned, curve->at[i].q));
	return rows;
}

static double cell(const json_t *row, size_t i)
{
	return json_number_value(json_array_get(row, i));
}

static void read_curve(struct bench_ladder_curve *curve, const json_t *rows)
{
	curve->count = 0;
	for (size_t i = 0; i < json_array_size(rows) && i < BENCH_LADDER_POINTS; i++) {
		const json_t *row = json_array_get(rows, i);
		curve->at[curve->count++] =
			(struct bench_ladder_point){ cell(row, 0), cell(row, 1), cell(row, 2) };
	}
}

static json_t *pack(const struct bench_ladder *l)
{
	json_t *kinds = json_array(), *cook = json_array();
	for (int k = 0; k < BENCH_LADDER_KINDS; k++)
		json_array_append_new(kinds, pack_curve(&l->kind[k]));
	for (uint32_t i = 0; i < BENCH_SPACINGS * BENCH_DISTANCES; i++)
		json_array_append_new(cook, json_real(l->cook_q[i / BENCH_DISTANCES][i % BENCH_DISTANCES]));
	return json_pack("{s:i,s:i,s:f,s:f,s:o,s:o}", "elements", (int)l->elements, "vertices",
		(int)l->vertices, "greedy_cpu_s", l->greedy_cpu_s, "random_cpu_s", l->random_cpu_s, "cook_q",
		cook, "kinds", kinds);
}

static void unpack(struct bench_ladder *l, const json_t *kept)
{
	*l = (struct bench_ladder){ .elements =
					    (uint32_t)json_number_value(json_object_get(kept, "elements")),
		.vertices = (uint32_t)json_number_value(json_object_get(kept, "vertices")),
		.greedy_cpu_s = json_number_value(json_object_get(kept, "greedy_cpu_s")),
		.random_cpu_s = json_number_value(json_object_get(kept, "random_cpu_s")) };
	for (uint32_t i = 0; i < BENCH_SPACINGS * BENCH_DISTANCES; i++)
		l->cook_q[i / BENCH_DISTANCES][i % BENCH_DISTANCES] =
			cell(json_object_get(kept, "cook_q"), i);
	for (size_t k = 0; k < BENCH_LADDER_KINDS; k++)
		read_curve(&l->kind[k], json_array_get(json_object_get(kept, "kinds"), k));
}

/* Unit 0 is the splats, unit s the orders of seed s. */
static enum eco_code measure_unit(struct bench *bench, struct plant *p, uint32_t seed,
	struct eco_error *error)
{
	char unit[96];
	struct eco_model model;
	struct bench_ladder ladder;
	snprintf(unit, sizeof unit, "ladder-%016llx-%u", (unsigned long long)bench_file_hash(p->model.path),
		seed);
	json_t *kept = bench_recall(bench, unit, NULL);
	enum eco_code code = kept ? ECO_OK : bench_model_read(bench, &p->model, &model, error);
	if (code)
		return code;
	if (!kept) {
		code = seed ? bench_ladder_measure(bench, &ladder, &model, seed, error)
			    : bench_ladder_splats(bench, &p->splats, &model, error);
		eco_model_free(&model);
		if (code)
			return code;
		kept = bench_keep(bench, unit, NULL, seed ? pack(&ladder) : pack_curve(&p->splats));
	}
	if (seed)
		unpack(&p->seeds[p->seed_count++], kept);
	else
		read_curve(&p->splats, kept);
	return ECO_OK;
}

/* Seed by seed, so that what a run that was stopped has kept is whole for the first seeds. */
static enum eco_code measure_all(struct bench *bench, struct headline *h, struct eco_error *error)
{
	uint32_t seeds = bench->full ? SEEDS : SEEDS_QUICK, all = (seeds + 1) * h->count;
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < all && !code; i++) {
		struct plant *p = &h->plants[i % h->count];
		if (!p->seeds && !(p->seeds = calloc(seeds, sizeof *p->seeds)))
			return eco_fail(error, ECO_NO_MEMORY, "no memory for the ladders of %s",
				p->model.name);
		bench_progress(bench, (double)i / all, p->model.name);
		code = bench_stopped(bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
					    : measure_unit(bench, p, i / h->count, error);
	}
	return code;
}

/* ---- Tables ---- */

static double saving(const struct plant *p, int row, int spacing, bool total)
{
	double sum = 0;
	for (uint32_t s = 0; s < p->seed_count; s++)
		sum += bench_ladder_saving(&p->seeds[s], &p->splats, (enum bench_ladder_row)row,
			       (enum bench_spacing)spacing, total) /
			p->seed_count;
	return sum;
}

/* Of the total: the pack's order over a random one. */
static double order_share(const struct plant *p, bool lists, int spacing)
{
	return saving(p, lists ? BENCH_LADDER_LISTS : BENCH_LADDER_OURS, spacing, true) -
		saving(p, lists ? BENCH_LADDER_RANDOM_LISTS : BENCH_LADDER_RANDOM, spacing, true);
}

/* Every seed's rows; returns in `range` the least and the most of the pack's ladder. */
static void write_seeds(struct bench_table *table, const struct plant *p, double range[2])
{
	range[0] = INFINITY;
	range[1] = -INFINITY;
	for (uint32_t i = 0; i < p->seed_count * BENCH_LADDER_ROWS; i++) {
		const struct bench_ladder *l = &p->seeds[i / BENCH_LADDER_ROWS];
		enum bench_ladder_row r = (enum bench_ladder_row)(i % BENCH_LADDER_ROWS);
		double x[4];
		for (int k = 0; k < 4; k++)
			x[k] = 100 *
				bench_ladder_saving(l, &p->splats, r, k < 2 ? BENCH_NEAR : BENCH_EVEN,
					k % 2 == 0);
		if (r == BENCH_LADDER_OURS) {
			range[0] = fmin(range[0], x[0]);
			range[1] = fmax(range[1], x[0]);
		}
		bench_table_row(table, "%s,%s,%u,%u,%s,%u,%.2f,%.2f,%.2f,%.2f", p->model.name,
			p->model.generated ? "yes" : "no", l->elements, l->vertices, bench_ladder_names[r],
			i / BENCH_LADDER_ROWS + 1, x[0], x[1], x[2], x[3]);
	}
}

static void write_plants(struct bench *bench, const struct headline *h)
{
	struct bench_table *all = bench_table_open(bench, "ladder_rows",
		"plant,generated,leaves,vertices,row,seed,paper's distances: of all vertices %,"
		"paper's distances: mean %,of all vertices %,mean %",
		false);
	struct bench_table *table = bench_table_open(bench, "ladder_plants",
		"plant,generated,leaves,pack's ladder %,lists only %,random order all else ours %,"
		"random lists only %,greedy without forms %,Cook with leaves as one triangle %,"
		"least of the seeds %,most of the seeds %,greedy CPU s,random CPU s",
		true);
	for (uint32_t i = 0; i < h->count; i++) {
		const struct plant *p = &h->plants[i];
		double range[2], v[BENCH_LADDER_ROWS];
		write_seeds(all, p, range);
		for (int r = 0; r < BENCH_LADDER_ROWS; r++)
			v[r] = 100 * saving(p, r, BENCH_NEAR, true);
		bench_table_row(table, "%s,%s,%u,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f",
			p->model.name, p->model.generated ? "yes" : "no", p->seeds[0].elements, v[0], v[1],
			v[2], v[3], v[4], v[5], range[0], range[1], p->seeds[0].greedy_cpu_s,
			p->seeds[0].random_cpu_s);
	}
	bench_table_close(table);
	bench_table_close(all);
}

static struct bench_interval row_interval(const struct headline *h, int row, int spacing, bool total)
{
	double values[PLANTS_MOST];
	for (uint32_t i = 0; i < h->count; i++)
		values[i] = 100 * saving(&h->plants[i], row, spacing, total);
	return bench_interval_of(values, h->count);
}

static void write_means(struct bench *bench, const struct headline *h)
{
	struct bench_table *table = bench_table_open(bench, "ladder",
		"row,paper's distances: of all vertices %,"
		"95 % of means from,to,worst plant %,paper's distances: mean %,of all vertices %,mean %",
		true);
	for (int r = 0; r < BENCH_LADDER_ROWS; r++) {
		struct bench_interval total = row_interval(h, r, BENCH_NEAR, true);
		double worst = INFINITY;
		for (uint32_t i = 0; i < h->count; i++)
			worst = fmin(worst, 100 * saving(&h->plants[i], r, BENCH_NEAR, true));
		bench_table_row(table, "%s,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f", bench_ladder_names[r],
			total.mean, total.low, total.high, worst, row_interval(h, r, BENCH_NEAR, false).mean,
			row_interval(h, r, BENCH_EVEN, true).mean,
			row_interval(h, r, BENCH_EVEN, false).mean);
	}
	bench_table_close(table);
}

static void key(struct bench *bench, const char *name, int spacing, double value, const char *bar)
{
	char key[64];
	snprintf(key, sizeof key, "%s%s", name, spacing == BENCH_NEAR ? "" : "_even");
	bench_key(bench, key, value, bar);
}

static void write_spacing(struct bench *bench, const struct headline *h, int spacing)
{
	double worst = INFINITY, shares[PLANTS_MOST], lists[PLANTS_MOST], least = INFINITY;
	for (uint32_t i = 0; i < h->count; i++) {
		worst = fmin(worst, saving(&h->plants[i], BENCH_LADDER_OURS, spacing, true));
		shares[i] = order_share(&h->plants[i], false, spacing);
		lists[i] = order_share(&h->plants[i], true, spacing);
		least = fmin(least, shares[i]);
	}
	struct bench_interval total = row_interval(h, BENCH_LADDER_OURS, spacing, true),
			      share = bench_interval_of(shares, h->count),
			      list = bench_interval_of(lists, h->count);
	key(bench, "ladder_total", spacing, total.mean / 100,
		">= 0.62: packs' ladder, mean over plants not used in tuning, of all vertices");
	key(bench, "ladder_total_worst", spacing, worst, ">= 0.48: the same, worst plant");
	key(bench, "ladder_order_share", spacing, share.mean, ">= 0.05 where greedy is kept, 0.03 over all");
	key(bench, "ladder_order_share_least", spacing, least,
		">= -0.01: worst plant against a random order");
	bench_say(bench,
		"With %s distances the order's own share, pack's ladder against a random order with all "
		"else ours, is %.1f points of all vertices (95 %% of the means of plants drawn again %.1f to "
		"%.1f); lists alone %.1f (%.1f to %.1f).",
		spacing == BENCH_NEAR ? "the paper's" : "even", 100 * share.mean, 100 * share.low,
		100 * share.high, 100 * list.mean, 100 * list.low, 100 * list.high);
}

static void write_keys(struct bench *bench, const struct headline *h)
{
	write_spacing(bench, h, BENCH_NEAR);
	write_spacing(bench, h, BENCH_EVEN);
	bench_key(bench, "ladder_plants", h->count, ">= 12: plants");
	bench_say(bench,
		"Intervals come from plants drawn with replacement, 2,000 times with a fixed seed, of each "
		"plant's mean over its seeds. Splats and an impostor show wood, too, and still all their "
		"vertices count against those of the foliage. Wood is drawn whole beside lists in all rows.");
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct headline *h = calloc(1, sizeof *h);
	enum eco_code code = h ? find_read(bench, h, error) : eco_fail(error, ECO_NO_MEMORY, "no memory");
	if (!code)
		code = find_made(bench, h, error);
	if (!code)
		code = measure_all(bench, h, error);
	if (!code && h->count) {
		write_means(bench, h);
		write_plants(bench, h);
		write_keys(bench, h);
	}
	for (uint32_t i = 0; h && i < h->count; i++)
		free(h->plants[i].seeds);
	free(h);
	return code;
}

const struct bench_section bench_ladder = { "ladder", "Geometry that packs' own ladders save", run,
	.objects = BENCH_OBJECTS_PLANTS "tests/bench/ladder/bench_ladder_plant.o " };
