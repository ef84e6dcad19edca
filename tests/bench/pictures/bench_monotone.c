/* Whether more vertices look better, and whether the planner chooses the best kind: each plant alone with 1,
 * 2, 4, ... vertices, as the planner draws it; then drawn by its organs, its splats or its impostor alone.
 * Models of the data folder and generated plants. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/bench_shots.h"
#include "tests/support/plant_walk.h"

#define FALL 0.005               /* of Q that is allowed */
#define QUICK 1u                /* plants of the data folder, and generated ones, in the quick bench */
static const char *const kinds[PLANT_KINDS] = { "none", "organs", "splats", "impostor" };

static enum eco_code measure(void *ctx, json_t **unit, struct eco_error *error)
{
	struct eco_pack *pack;
	struct plant_walk walk;
	struct plant_regret regret;
	enum eco_code code = eco_pack_open(&pack, ctx, error);
	if (code)
		return code;
	code = plant_walk(&walk, pack, 0, &(struct plant_walk_options){ .views = 24, .pixels = 128 }, error);
	if (!code)
		code = plant_regret(&regret, pack, 0,
			&(struct plant_walk_options){ .views = 8, .pixels = 128 }, error);
	eco_pack_close(pack);
	if (code)
		return code;
	*unit = json_pack("{s:f, s:I, s:f, s:f, s:I, s:s, s:i, s:i}", "fall", walk.fall, "at", (json_int_t)walk.fall_at, "regret", regret.mean, "worst regret", regret.worst,
		"regret at", (json_int_t)regret.worst_at, "better", kinds[regret.best], "budgets",
		(int)regret.count, "within", (int)regret.within);
	return ECO_OK;
}

static enum eco_code study(struct bench *bench, const char *name, const char *pack, json_t **unit,
	struct eco_error *error)
{
	char stamp[40], key[80];
	snprintf(stamp, sizeof stamp, "pack %016llx", (unsigned long long)bench_file_hash(pack));
	snprintf(key, sizeof key, "monotone-%s", name);
	return bench_unit(bench, key, stamp, measure, (void *)pack, unit, error);
}

/* `within`: budgets where the choice is as good as the best kind. */
struct sums { uint32_t plants, fallen, budgets, within; double worst, regret; };

static double number(json_t *unit, const char *key) { return json_number_value(json_object_get(unit, key)); }

static void add_row(struct bench_table *table, const char *name, json_t *unit, struct sums *sums)
{
	double fall = number(unit, "fall");
	sums->plants++;
	sums->fallen += fall > FALL;
	sums->worst = fmax(sums->worst, fall);
	sums->regret += number(unit, "regret") * number(unit, "budgets");
	sums->budgets += (uint32_t)number(unit, "budgets");
	sums->within += (uint32_t)number(unit, "within");
	bench_table_row(table, "%s,%.4f,%.0f,%.4f,%.4f,%.0f,%s", name, fall, number(unit, "at"),
		number(unit, "regret"), number(unit, "worst regret"), number(unit, "regret at"),
		json_string_value(json_object_get(unit, "better")));
}

static enum eco_code study_plant(struct bench *bench, const struct bench_model *model,
	struct bench_table *table, struct sums *sums, struct eco_error *error)
{
	char pack[512];
	json_t *unit;
	enum eco_code code = bench_model_pack(bench, model, pack, error);
	if (!code)
		code = study(bench, model->name, pack, &unit, error);
	if (!code)
		add_row(table, model->name, unit, sums);
	return code;
}

static enum eco_code study_all(struct bench *bench, const struct bench_model *models, uint32_t count,
	struct bench_table *table, struct sums *sums, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	uint32_t seen[2] = { 0, 0 };
	for (uint32_t i = 0; i < count && !code; i++) {
		bench_progress(bench, (double)i / count, models[i].name);
		if (!bench->full && seen[models[i].generated]++ >= QUICK)
			bench_left_out(bench, models[i].name);
		else
			code = study_plant(bench, &models[i], table, sums, error);
	}
	return code;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct bench_model *models = NULL;
	uint32_t count = 0;
	struct sums sums = { 0 };
	enum eco_code code = bench_models(bench, &models, &count, error);
	if (code)
		return code;
	struct bench_table *table = bench_table_open(bench, "monotone", "plant,fall,at vertices,regret,worst "
		"regret,regret at vertices,better kind", true);
	code = study_all(bench, models, count, table, &sums, error);
	bench_table_close(table);
	free(models);
	bench_say(bench, "Fall: the most that Q lies below that of fewer vertices; %u of %u plants fall by "
		"more than %g.", sums.fallen, sums.plants, FALL);
	bench_say(bench, "Regret: how far Q lies below that of the best kind alone, at 8, 16, ... vertices "
		"up to half of full detail, 8 views; mean %.4f, within %g at %u of %u budgets.",
		sums.budgets ? sums.regret / sums.budgets : NAN, PLANT_REGRET_FREE, sums.within,
		sums.budgets);
	if (!code) {
		bench_key(bench, "choice_regret", sums.budgets ? sums.regret / sums.budgets : NAN,
			"<= 0.005: mean over plants and budgets");
		bench_key(bench, "monotone_fall", sums.plants ? sums.worst : NAN, "<= 0.005");
	}
	return code;
}

const struct bench_section bench_monotone = { "monotone", "Whether more vertices look better", run };
