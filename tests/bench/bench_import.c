/* Processor time of importing a model against its size: loose twigs and leaves, each a component of its own,
 * so that whatever looks at all pairs of them shows. tests/import/test_model_work.c holds the work to linear.
 */
#include <math.h>
#include <stdio.h>

#include "ecofiles/base/random.h"
#include "tests/bench/bench.h"
#include "tests/bench/bench_state.h"

#define SIZES 4u
static const uint32_t sizes[SIZES] = { 15000, 30000, 60000, 120000 };

static double random_unit(uint64_t *state) { return eco_random_unit(eco_random_next(state)); }

/* Two triangles of a twig, then one of a leaf. */
static void write_third(FILE *to, uint64_t *state)
{
	double x = 4 * random_unit(state), y = 4 * random_unit(state), z = 2 + 3 * random_unit(state);
	fprintf(to, "v %.4f %.4f %.4f\nv %.4f %.4f %.4f\nv %.4f %.4f %.4f\nv %.4f %.4f %.4f\nusemtl bark\n"
		"f -4 -3 -2 -1\n", x, y, z, x + .01, y, z, x + .01, y, z + .4, x, y, z + .4);
	fprintf(to, "v %.4f %.4f %.4f\nv %.4f %.4f %.4f\nv %.4f %.4f %.4f\nusemtl leaf\nf -3 -2 -1\n", x, y,
		z, x + .08, y + .02, z + .05, x + .02, y + .07, z + .1);
}

static enum eco_code measure(struct bench *bench, uint32_t triangles, json_t **result,
	struct eco_error *error)
{
	struct bench_model model = { .name = "loose" };
	struct eco_model read;
	char unit[32];
	uint64_t state = 46;
	snprintf(unit, sizeof unit, "loose-%u", triangles);
	*result = bench_recall(bench, unit, NULL);
	if (*result)
		return ECO_OK;
	snprintf(model.path, sizeof model.path, "%s/loose-%u.obj", bench->cache, triangles);
	FILE *file = fopen(model.path, "w");
	if (!file)
		return eco_fail(error, ECO_IO, "%s: cannot be written", model.path);
	for (uint32_t i = 0; i < triangles / 3; i++)
		write_third(file, &state);
	fclose(file);
	double before_s = bench_cpu_s();
	enum eco_code code = bench_model_read(bench, &model, &read, error);
	double cpu_s = bench_cpu_s() - before_s;
	eco_model_free(&read);
	remove(model.path);
	if (!code)
		*result = bench_keep(bench, unit, NULL, json_real(cpu_s));
	return code;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	double cpu_s[SIZES];
	for (uint32_t i = 0; i < SIZES && !code; i++) {
		json_t *result;
		bench_progress(bench, (double)i / SIZES, "import");
		code = measure(bench, sizes[i], &result, error);
		cpu_s[i] = code ? NAN : json_real_value(result);
	}
	if (code)
		return code;
	struct bench_table *table = bench_table_open(bench, "import",
		"triangles,processor s,us a triangle", true);
	for (uint32_t i = 0; i < SIZES; i++)
		bench_table_row(table, "%u,%.3f,%.2f", sizes[i], cpu_s[i], 1e6 * cpu_s[i] / sizes[i]);
	bench_table_close(table);
	bench_say(bench, "Import of a model of loose twigs and leaves, a component each. The time of a "
		"triangle is the same in a small model and in a large one.");
	bench_key(bench, "import_us_a_triangle", 1e6 * cpu_s[SIZES - 1] / sizes[SIZES - 1], "10 or less");
	bench_key(bench, "import_growth", cpu_s[SIZES - 1] / cpu_s[SIZES - 2] / 2,
		"1.5 or less: linear is 1");
	return ECO_OK;
}

const struct bench_section bench_import = { "import", "Importing a model", run,
	.objects = "ecofiles-*.a tests/bench/bench_import.o", .alone = true };
