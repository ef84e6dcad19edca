/* Whether more vertices look better, and whether the planner chooses the best kind: each plant alone with 1,
 * 2, 4, ... vertices, as the planner draws it; then drawn by its organs, its splats or its impostor alone.
 * Models of the data folder and generated plants. */
#include <math.h>
#include <stdlib.h>

#include "tests/bench/bench_shots.h"
#include "tests/support/plant_walk.h"

#define FALL_MOST 0.005          /* of Q that is allowed */
#define QUICK 1u                /* plants of the data folder, and generated ones, in the quick bench */
static const char *const kinds[PLANT_KINDS] = { "none", "organs", "splats", "impostor" };

enum figure { FALL, FALL_AT, REGRET, WORST, WORST_AT, BETTER, BUDGETS, WITHIN, FIGURES };

/* `ctx` is a plant's pack. */
static json_t *measure(void *ctx)
{
	struct eco_pack *pack;
	struct plant_walk walk;
	struct plant_regret regret;
	must(eco_pack_open(&pack, ctx, must_error));
	must(plant_walk(&walk, pack, 0, &(struct plant_walk_options){ .views = 24, .pixels = 128 }, must_error));
	must(plant_regret(&regret, pack, 0, &(struct plant_walk_options){ .views = 8, .pixels = 128 }, must_error));
	eco_pack_close(pack);
	return bench_reals((double[]){ walk.fall, (double)walk.fall_at, regret.mean, regret.worst,
		(double)regret.worst_at, regret.best, regret.count, regret.within }, FIGURES);
}

/* `within`: budgets where the choice is as good as the best kind. */
struct sums { uint32_t plants, fallen; double worst, regret, budgets, within; };

static void study_plant(struct bench *bench, const struct bench_model *model, struct bench_table *table,
	struct sums *sums)
{
	char pack[512], stamp[40], key[80];
	double f[FIGURES];
	json_t *unit;
	bench_model_pack(bench, model, false, pack);
	snprintf(stamp, sizeof stamp, "pack %016llx", (unsigned long long)bench_file_hash(pack));
	snprintf(key, sizeof key, "monotone-%s", model->name);
	unit = bench_unit(bench, key, stamp, measure, pack);
	bench_cells(unit, f, FIGURES);
	sums->plants++;
	sums->fallen += f[FALL] > FALL_MOST;
	sums->worst = fmax(sums->worst, f[FALL]);
	sums->regret += f[REGRET] * f[BUDGETS];
	sums->budgets += f[BUDGETS];
	sums->within += f[WITHIN];
	bench_table_row(table, "%s,%.4f,%.0f,%.4f,%.4f,%.0f,%s", model->name, f[FALL], f[FALL_AT], f[REGRET],
		f[WORST], f[WORST_AT], kinds[(int)f[BETTER]]);
}

static void run(struct bench *bench)
{
	struct bench_model *models = NULL;
	uint32_t count = 0, seen[2] = { 0, 0 };
	struct sums sums = { 0 };
	models = bench_models(bench, &count);
	struct bench_table *table = bench_table_open(bench, "monotone", "plant,fall,at vertices,regret,worst "
		"regret,regret at vertices,better kind", true);
	for (uint32_t i = 0; i < count; i++) {
		bench_progress(bench, (double)i / count, models[i].name);
		if (!bench->full && seen[models[i].generated]++ >= QUICK)
			bench_left_out(bench, models[i].name);
		else
			study_plant(bench, &models[i], table, &sums);
	}
	bench_table_close(table);
	free(models);
	double regret = sums.budgets > 0 ? sums.regret / sums.budgets : NAN;
	bench_say(bench, "Fall: the most that Q lies below that of fewer vertices; %u of %u plants fall by "
		"more than %g.", sums.fallen, sums.plants, FALL_MOST);
	bench_say(bench, "Regret: how far Q lies below that of the best kind alone, at 8, 16, ... vertices "
		"up to half of full detail, 8 views; mean %.4f, within %g at %.0f of %.0f budgets.", regret,
		PLANT_REGRET_FREE, sums.within, sums.budgets);
	bench_key(bench, "choice_regret", regret, "<= 0.005: mean over plants and budgets");
	bench_key(bench, "monotone_fall", sums.plants ? sums.worst : NAN, "<= 0.005");
}

const struct bench_section bench_monotone = { "monotone", "Whether more vertices look better", run };
