/* The headline: geometry that packs' own ladders save against Cook at equal Q, of plants that no constant was
 * chosen on. bench_ladder_plant.h says how. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "tests/bench/ladder/bench_ladder_plant.h"

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
} grown[] = { { "park", 7, "2", { "azalea", "palm", "birch" } },
	{ "forest", 5, "0.6", { "maple", "pine", "shrub", "spruce" } },
	{ "grove", 11, "0.4", { "beech", "oak", "linden" } } };

struct plant {
	struct bench_model model;
	struct bench_ladder_curve splats;
	struct bench_ladder seeds[SEEDS];
	uint32_t seed_count;
};

struct headline {
	struct plant plants[PLANTS_MOST];
	uint32_t count;
};

/* ---- Plants ---- */

static bool is_tuned(const char *name)
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

static void find_read(struct bench *bench, struct headline *h)
{
	struct bench_model *models = NULL;
	uint32_t count = 0;
	models = bench_models(bench, &count);
	for (uint32_t i = 0; i < count; i++)
		if (!models[i].generated && !is_tuned(models[i].name) &&
			models[i].leaves >= BENCH_ELEMENTS_LEAST && models[i].leaves <= LEAVES_MOST)
			add_or_leave(bench, h, &models[i], h->count < READ_QUICK);
	free(models);
}

static void find_made(struct bench *bench, struct headline *h)
{
	uint32_t before = h->count;
	for (size_t i = 0; i < sizeof grown / sizeof *grown; i++) {
		char folder[400];
		snprintf(folder, sizeof folder, "%s/scenes/ladder-%s", bench->cache, grown[i].scene);
		bench_command("[ -d '%s' ] || { mkdir -p '%s.tmp' && "
			"'%s/ecopack' generate %s -o '%s.tmp' --plants 20 --seed %u --detail %s --quiet && mv "
			"'%s.tmp' '%s'; }", folder, folder, bench->build, grown[i].scene, folder, grown[i].seed, grown[i].detail, folder, folder);
		for (size_t k = 0; k < 5 && grown[i].plants[k]; k++) {
			struct bench_model model = { .generated = true };
			snprintf(model.name, sizeof model.name, "generated-%s", grown[i].plants[k]);
			snprintf(model.path, sizeof model.path, "%s/models/%s.obj", folder,
				grown[i].plants[k]);
			add_or_leave(bench, h, &model, k == 0 && h->count - before < MADE_QUICK);
		}
	}
}

/* ---- Units ---- */

struct work { struct bench *bench; const struct bench_model *model; uint32_t seed; };

/* Seed 0: the curve of the splats; else all but these. Both are doubles alone. */
static json_t *measure(void *ctx)
{
	const struct work *w = ctx;
	struct eco_model model;
	struct bench_ladder l;
	struct bench_ladder_curve splats;
	bench_model_read(w->model, &model);
	if (w->seed)
		bench_ladder_measure(w->bench, &l, &model, w->seed);
	else
		bench_ladder_splats(w->bench, &splats, &model);
	eco_model_free(&model);
	return w->seed ? bench_reals((const double *)&l, sizeof l / sizeof(double))
		: bench_reals((const double *)&splats, sizeof splats / sizeof(double));
}

static void measure_unit(struct bench *bench, struct plant *p, uint32_t seed)
{
	char unit[96];
	json_t *kept;
	snprintf(unit, sizeof unit, "ladder-%016llx-%u", (unsigned long long)bench_file_hash(p->model.path),
		seed);
	kept = bench_unit(bench, unit, NULL, measure, &(struct work){ bench, &p->model, seed });
	bench_cells(kept, seed ? (double *)&p->seeds[p->seed_count++] : (double *)&p->splats,
		(uint32_t)json_array_size(kept));
}

/* Seed by seed, so that what a run that was stopped has kept is whole for the first seeds. */
static void measure_all(struct bench *bench, struct headline *h)
{
	uint32_t seeds = bench->full ? SEEDS : SEEDS_QUICK, all = (seeds + 1) * h->count;
	for (uint32_t i = 0; i < all; i++) {
		struct plant *p = &h->plants[i % h->count];
		bench_progress(bench, (double)i / all, p->model.name);
		measure_unit(bench, p, i / h->count);
	}
}

/* ---- Tables ---- */

static double saving(const struct plant *p, enum bench_ladder_row row, bool total)
{
	double sum = 0;
	for (uint32_t s = 0; s < p->seed_count; s++)
		sum += bench_ladder_saving(&p->seeds[s], &p->splats, row, total) / p->seed_count;
	return sum;
}

static void write_plants(struct bench *bench, const struct headline *h)
{
	static const struct bench_column columns[] = { { "pack's ladder %", 1 }, { "lists only %", 1 },
		{ "random order all else ours %", 1 }, { "random lists only %", 1 },
		{ "least of the seeds %", 1 }, { "most of the seeds %", 1 } };
	enum { COLUMNS = sizeof columns / sizeof *columns, LEAST = BENCH_LADDER_ROWS };
	struct bench_table *table = bench_table_described(bench, "ladder_plants", "plant,generated,leaves",
		columns, COLUMNS, true);
	for (uint32_t i = 0; i < h->count; i++) {
		const struct plant *p = &h->plants[i];
		double v[COLUMNS] = { [LEAST] = INFINITY, -INFINITY };
		for (int r = 0; r < BENCH_LADDER_ROWS; r++)
			v[r] = 100 * saving(p, (enum bench_ladder_row)r, true);
		for (uint32_t k = 0; k < p->seed_count; k++) {
			double one = 100 * bench_ladder_saving(&p->seeds[k], &p->splats, BENCH_LADDER_OURS,
				true);
			v[LEAST] = fmin(v[LEAST], one);
			v[LEAST + 1] = fmax(v[LEAST + 1], one);
		}
		bench_table_values(table, v, "%s,%s,%u", p->model.name, p->model.generated ? "yes" : "no",
			(unsigned)p->seeds[0].elements);
	}
	bench_table_close(table);
}

/* Over plants; `least`: of them. */
static double mean(const struct headline *h, enum bench_ladder_row row, bool total, double *least)
{
	double sum = 0;
	*least = INFINITY;
	for (uint32_t i = 0; i < h->count; i++) {
		double one = saving(&h->plants[i], row, total);
		sum += one / h->count;
		*least = fmin(*least, one);
	}
	return sum;
}

static void write_means(struct bench *bench, const struct headline *h)
{
	struct bench_table *table = bench_table_open(bench, "ladder",
		"row,paper's distances: of all vertices %,worst plant %,paper's distances: mean %", true);
	double worst, least = INFINITY, unused;
	for (enum bench_ladder_row r = 0; r < BENCH_LADDER_ROWS; r++) {
		double total = mean(h, r, true, &worst);
		bench_table_row(table, "%s,%.1f,%.1f,%.1f", bench_ladder_names[r], 100 * total, 100 * worst,
			100 * mean(h, r, false, &unused));
	}
	bench_table_close(table);
	double ours = mean(h, BENCH_LADDER_OURS, true, &worst);
	for (uint32_t i = 0; i < h->count; i++)
		least = fmin(least, saving(&h->plants[i], BENCH_LADDER_OURS, true)
			- saving(&h->plants[i], BENCH_LADDER_RANDOM, true));
	bench_key(bench, "ladder_total", ours,
		">= 0.62: packs' ladder, mean over plants not used in tuning, of all vertices");
	bench_key(bench, "ladder_total_worst", worst, ">= 0.48: the same, worst plant");
	bench_key(bench, "ladder_order_share", ours - mean(h, BENCH_LADDER_RANDOM, true, &unused),
		">= 0.05 where greedy is kept, 0.03 over all");
	bench_key(bench, "ladder_order_share_least", least, ">= -0.01: worst plant against a random order");
	bench_key(bench, "ladder_plants", h->count, ">= 12: plants");
	bench_say(bench, "Means over each plant's seeds. Splats and an impostor show wood, too, and still all their "
		"vertices count against those of the foliage. Wood is drawn whole beside lists in all rows.");
}

static void run(struct bench *bench)
{
	struct headline *h = eco_alloc(1, sizeof *h);
	find_read(bench, h);
	find_made(bench, h);
	measure_all(bench, h);
	if (h->count) {
		write_means(bench, h);
		write_plants(bench, h);
	}
	free(h);
}

const struct bench_section bench_ladder = { "ladder", "Geometry that packs' own ladders save", run };
