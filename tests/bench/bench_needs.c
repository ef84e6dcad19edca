/* Costs of each feature, and that a scene which does not use it does not pay: the table of
 * tests/bench/needs.sh, which tests/ecopack/test_needs.sh holds to its counts. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/bench.h"

enum { PACK_BYTES = 1, STREAM_BYTES = 4, PACKER_LIBRARIES = 11 };        /* columns of needs.sh */

/* An array of lines, the head first. */
static json_t *read_lines(const char *path)
{
	FILE *file = fopen(path, "r");
	json_t *lines = json_array();
	for (char line[4096]; file && fgets(line, sizeof line, file);) {
		line[strcspn(line, "\n")] = 0;
		json_array_append_new(lines, json_string(line));
	}
	if (file)
		fclose(file);
	return lines;
}

static enum eco_code measure(void *ctx, json_t **rows, struct eco_error *error)
{
	struct bench *bench = ctx;
	char path[512];
	snprintf(path, sizeof path, "%s/needs/table.csv", bench->cache);
	enum eco_code code = bench_command(bench, error, "mkdir -p '%s/needs' && BUILD='%s' sh "
		"tests/bench/needs.sh '%s/needs' >'%s'", bench->cache, bench->build, bench->cache, path);
	if (code)
		return code;
	*rows = read_lines(path);
	return json_array_size(*rows) > 1 ? ECO_OK
		: eco_fail(error, ECO_IO, "%s: holds no table of needs", path);
}

static const char *line_of(const json_t *rows, size_t i)
{
	return json_string_value(json_array_get(rows, i));
}

static double field(const char *line, int column)
{
	while (column-- > 0 && line)
		line = strchr(line, ',') ? strchr(line, ',') + 1 : NULL;
	return line ? atof(line) : NAN;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	json_t *rows;
	enum eco_code code = bench_unit(bench, "table", NULL, measure, bench, &rows, error);
	if (code)
		return code;
	struct bench_table *table = bench_table_open(bench, "needs", line_of(rows, 0), true);
	for (size_t i = 1; i < json_array_size(rows); i++)
		bench_table_row(table, "%s", line_of(rows, i));
	bench_table_close(table);
	const char *bare = line_of(rows, 1), *all = line_of(rows, json_array_size(rows) - 1);
	bench_say(bench, "A hundred plants each; every scene has one thing more than the one before. The first "
		"is drawn with lines alone (1,000 vertices), the others with 20,000. ecopack loads GDAL for "
		"rasters and layers, PROJ for other coordinates, assimp for models other than OBJ and glTF, "
		"OpenImageIO for pictures other than PNG, each as a module at its first call.");
	bench_key(bench, "needs_bare_pack_bytes", field(bare, PACK_BYTES), "only what lines need");
	bench_key(bench, "needs_bare_stream_bytes", field(bare, STREAM_BYTES), "only what lines need");
	bench_key(bench, "needs_bare_packer_libraries", field(bare, PACKER_LIBRARIES), "");
	bench_key(bench, "needs_everything_pack_bytes", field(all, PACK_BYTES), "");
	return ECO_OK;
}

const struct bench_section bench_needs = { "needs", "Leaving out what a scene does not need", run };
