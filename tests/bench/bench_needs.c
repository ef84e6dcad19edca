/* Costs of each feature, and that a scene which does not use it does not pay: the table of
 * tests/bench/needs.sh, which tests/ecopack/test_needs.sh holds to its counts. */
#include <stdlib.h>
#include <string.h>

#include "tests/bench/bench.h"

/* Columns of needs.sh, and their order here. */
static const char head[] = "scene,pack bytes,needs listed,lists,stream bytes,server kB,server libraries,"
	"server ready ms,viewer libraries,packer libraries,packer modules,shaders";
static const unsigned columns[] = { 0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 9, 10 };
#define COLUMNS (sizeof columns / sizeof *columns)
#define FIELDS 13
enum { PACK_BYTES = 1, STREAM_BYTES = 4, PACKER_LIBRARIES = 11 };

/* An array of fields a line, without the head. */
static json_t *read_rows(const char *path)
{
	FILE *file = fopen(path, "r");
	json_t *rows = json_array();
	char line[4096];
	for (bool first = true; file && fgets(line, sizeof line, file); first = false) {
		json_t *row = json_array();
		char *rest = line, *field;
		line[strcspn(line, "\n")] = 0;
		while ((field = strsep(&rest, ",")))
			json_array_append_new(row, json_string(field));
		if (!first && json_array_size(row) == FIELDS)
			json_array_append(rows, row);
		json_decref(row);
	}
	if (file)
		fclose(file);
	return rows;
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
	*rows = read_rows(path);
	return json_array_size(*rows) ? ECO_OK
		: eco_fail(error, ECO_IO, "%s: holds no table of needs", path);
}

static const char *text(const json_t *row, size_t i) { return json_string_value(json_array_get(row, i)); }

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	json_t *rows, *row;
	size_t i;
	enum eco_code code = bench_unit(bench, "table", NULL, measure, bench, &rows, error);
	if (code)
		return code;
	struct bench_table *table = bench_table_open(bench, "needs", head, true);
	json_array_foreach(rows, i, row) {
		char cells[4096] = "";
		for (size_t c = 0; c < COLUMNS; c++)
			strcat(strcat(cells, c ? "," : ""), text(row, columns[c]));
		bench_table_row(table, "%s", cells);
	}
	bench_table_close(table);
	const json_t *bare = json_array_get(rows, 0), *all = json_array_get(rows, json_array_size(rows) - 1);
	bench_say(bench, "A hundred plants each; every scene has one thing more than the one before. The first "
		"is drawn with lines alone (1,000 vertices), the others with 20,000. ecopack loads GDAL for "
		"rasters and layers, PROJ for other coordinates, assimp for models other than OBJ and glTF, "
		"OpenImageIO for pictures other than PNG, each as a module at its first call.");
	bench_key(bench, "needs_bare_pack_bytes", atof(text(bare, PACK_BYTES)), "only what lines need");
	bench_key(bench, "needs_bare_stream_bytes", atof(text(bare, STREAM_BYTES)), "only what lines need");
	bench_key(bench, "needs_bare_packer_libraries", atof(text(bare, PACKER_LIBRARIES)), "");
	bench_key(bench, "needs_everything_pack_bytes", atof(text(all, PACK_BYTES)), "");
	return ECO_OK;
}

const struct bench_section bench_needs = { "needs", "Leaving out what a scene does not need", run };
