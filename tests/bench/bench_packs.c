/* The packs that other sections look at, built before them, and what that takes: the first run's longest
 * part, and none of the others'. */
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "tests/bench/bench_shots.h"

static enum eco_code add_pack(struct bench *bench, struct bench_table *table, const char *scene,
	const char *order, double *sum_s, struct eco_error *error)
{
	char pack[512];
	double cpu_s, wall_s;
	struct stat status = { 0 };
	enum eco_code code = bench_scene(bench, scene, order, pack, error);
	if (code)
		return code;
	bench_pack_times(pack, &cpu_s, &wall_s);
	stat(pack, &status);
	bench_table_row(table, "%s,%s,%.1f,%.1f,%.1f", scene, order ? order : "greedy", cpu_s, wall_s,
		(double)status.st_size / 1e6);
	*sum_s += cpu_s;
	return ECO_OK;
}

/* In the orders of all methods that are looked at. */
static enum eco_code add_scene(struct bench *bench, struct bench_table *table, const char *scene,
	double *sum_s, struct eco_error *error)
{
	char pack[512];
	enum eco_code code;
	if (!bench_shot_scene(bench, scene, pack, &code, error))
		return ECO_OK;
	for (uint32_t m = 0; m < BENCH_METHODS && !code; m++) {
		const char *order = bench_methods[m].order;
		bool twice = false;
		for (uint32_t k = 0; k < m; k++)
			twice = twice
				|| (order && bench_methods[k].order ? !strcmp(bench_methods[k].order, order)
				: bench_methods[k].order == order);
		bool quick = !bench_methods[m].full_only
			&& (!order || bench_scene_quick(scene) == BENCH_ALL_ORDERS);
		if (!twice && (bench->full || quick))
			code = add_pack(bench, table, scene, order, sum_s, error);
	}
	return code;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct bench_model *models = NULL;
	uint32_t model_count;
	struct bench_table *table = bench_table_open(bench, "packs", "scene,order of leaves,processor "
		"s,wall-clock s,MB", true);
	double sum_s = 0;
	enum eco_code code = ECO_OK;
	uint32_t count = 0;
	while (bench_scene_names[count])
		count++;
	for (uint32_t i = 0; i < count && !code; i++) {
		bench_progress(bench, (double)i / count, bench_scene_names[i]);
		code = add_scene(bench, table, bench_scene_names[i], &sum_s, error);
	}
	bench_table_close(table);
	if (!code)
		code = bench_request_packs(bench, error);
	if (!code)                           /* those of the sections on single plants, read once for all */
		code = bench_models(bench, &models, &model_count, error);
	free(models);
	bench_say(bench, "Times are those of the run that built a pack; a plant that another pack has had "
		"before comes from a cache and costs nothing anew.");
	if (!code)
		bench_key(bench, "packs_cpu_s", sum_s, "processor time of all packs of this bench");
	return code;
}

const struct bench_section bench_packs = { "packs", "Packs: what it takes to build them", run,
	.alone = true };
