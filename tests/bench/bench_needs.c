/* Costs of each feature, and that a scene which does not use it does not pay: the table of
 * tests/bench/needs.sh, which tests/ecopack/test_needs.sh holds to its counts. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/bench.h"

enum { PACK_BYTES = 1, STREAM_BYTES = 4, PACKER_LIBRARIES = 11 };        /* columns of needs.sh */

static double field(const char *line, int column)
{
	while (column-- > 0 && line)
		line = strchr(line, ',') ? strchr(line, ',') + 1 : NULL;
	return line ? atof(line) : NAN;
}

static void run(struct bench *bench)
{
	char path[512], head[4096] = "", bare[4096] = "", line[4096] = "";
	struct bench_table *table = NULL;
	snprintf(path, sizeof path, "%s/needs/table.csv", bench->cache);
	bench_command("mkdir -p '%s/needs' && BUILD='%s' sh "
		"tests/bench/needs.sh '%s/needs' >'%s'", bench->cache, bench->build, bench->cache, path);
	FILE *file = fopen(path, "r");
	while (file && fgets(table ? line : head, sizeof line, file)) {
		if (table) {
			line[strcspn(line, "\n")] = 0;
			bench_table_row(table, "%s", line);
			if (!*bare)
				memcpy(bare, line, sizeof bare);
		} else {
			head[strcspn(head, "\n")] = 0;
			table = bench_table_open(bench, "needs", head, true);
		}
	}
	if (file)
		fclose(file);
	must(table ? ECO_OK : eco_fail(must_error, ECO_IO, "%s: holds no table of needs", path));
	bench_table_close(table);
	bench_say(bench, "A hundred plants each; every scene has one thing more than the one before. The first is "
		"drawn as lines and splats (1,000 vertices), sparse as splats (300), the others in full. Unplanted: "
		"the ground's scene, where no plant is in sight or casts a shadow; covered: from above, with an "
		"image on the ground. ecopack loads GDAL for rasters and layers, PROJ for other coordinates, assimp "
		"for models other than OBJ and glTF, OpenImageIO for pictures other than PNG, each as a module at "
		"its first call.");
	bench_key(bench, "needs_bare_pack_bytes", field(bare, PACK_BYTES), "only what lines need");
	bench_key(bench, "needs_bare_stream_bytes", field(bare, STREAM_BYTES), "only what lines need");
	bench_key(bench, "needs_bare_packer_libraries", field(bare, PACKER_LIBRARIES), "");
	bench_key(bench, "needs_everything_pack_bytes", field(line, PACK_BYTES), "");
}

const struct bench_section bench_needs = { "needs", "Leaving out what a scene does not need", run };
