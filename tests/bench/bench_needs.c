/* Costs of each feature, and that a scene which does not use it does not pay: the table of
 * tests/bench/needs.sh, which tests/ecopack/test_needs.sh holds to its counts. */
#include <stdlib.h>
#include <string.h>

#include "tests/bench/bench.h"

#define COLUMNS 13

static bool read_row(char *line, char *field[COLUMNS])
{
	int n = 0;
	line[strcspn(line, "\n")] = 0;
	for (char *at = line; at && n < COLUMNS; n++) {
		field[n] = at;
		at = strchr(at, ',');
		if (at)
			*at++ = 0;
	}
	return n == COLUMNS;
}

static json_t *read_rows(const char *path)
{
	FILE *file = fopen(path, "r");
	json_t *rows = file ? json_array() : NULL;
	char line[4096], *field[COLUMNS];
	for (bool first = true; file && fgets(line, sizeof line, file); first = false) {
		if (first || !read_row(line, field))
			continue;
		json_t *row = json_array();
		for (int i = 0; i < COLUMNS; i++)
			json_array_append_new(row, json_string(field[i]));
		json_array_append_new(rows, row);
	}
	if (file)
		fclose(file);
	return rows;
}

static enum eco_code measure(struct bench *bench, json_t **rows, struct eco_error *error)
{
	char path[512];
	*rows = bench_recall(bench, "table", NULL);
	if (*rows)
		return ECO_OK;
	snprintf(path, sizeof path, "%s/needs/table.csv", bench->cache);
	enum eco_code code = bench_command(bench, error, "mkdir -p '%s/needs' && BUILD='%s' sh "
		"tests/bench/needs.sh '%s/needs' >'%s'", bench->cache, bench->build, bench->cache, path);
	json_t *read = code ? NULL : read_rows(path);
	if (!code && json_array_size(read) == 0) {
		json_decref(read);
		return eco_fail(error, ECO_IO, "%s: holds no table of needs", path);
	}
	if (!code)
		*rows = bench_keep(bench, "table", NULL, read);
	return code;
}

static const char *text(const json_t *row, size_t i) { return json_string_value(json_array_get(row, i)); }

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	json_t *rows;
	enum eco_code code = measure(bench, &rows, error);
	if (code)
		return code;
	struct bench_table *table = bench_table_open(bench, "needs", "scene,pack bytes,needs "
		"listed,lists,stream bytes,server kB,server libraries,"
		"server ready ms,viewer libraries,packer libraries,packer modules,shaders", true);
	for (size_t i = 0; i < json_array_size(rows); i++) {
		const json_t *r = json_array_get(rows, i);
		bench_table_row(table, "%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s,%s", text(r, 0), text(r, 1),
			text(r, 2), text(r, 3), text(r, 4), text(r, 5), text(r, 6), text(r, 7), text(r, 8),
			text(r, 11), text(r, 9), text(r, 10));
	}
	bench_table_close(table);
	const json_t *bare = json_array_get(rows, 0), *all = json_array_get(rows, json_array_size(rows) - 1);
	bench_say(bench, "A hundred plants each, every scene with one thing more than the one before. The "
		"first is drawn with lines alone (1,000 "
		"vertices), the "
		"others with 20,000. Sections that are not listed are absent from the pack; shaders are "
		"compiled when something first needs them. "
		"ecopack loads GDAL for rasters and layers, PROJ where coordinates are converted, assimp "
		"for models other than OBJ and glTF, OpenImageIO "
		"for pictures other than PNG, each as a module when it is first called. The viewer's "
		"libraries are those of its OpenGL driver and of "
			"curl, and the same for all scenes, as are those of the daemon.");
	bench_key(bench, "needs_bare_pack_bytes", atof(text(bare, 1)), "only what lines need");
	bench_key(bench, "needs_bare_stream_bytes", atof(text(bare, 4)), "only what lines need");
	bench_key(bench, "needs_bare_packer_libraries", atof(text(bare, 11)), "");
	bench_key(bench, "needs_everything_pack_bytes", atof(text(all, 1)), "");
	return ECO_OK;
}

const struct bench_section bench_needs = { "needs", "Leaving out what a scene does not need", run,
	.alone = true };
