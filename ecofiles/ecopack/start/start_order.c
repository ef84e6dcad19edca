/* Whether the arguments stand in their order: a table, a folder of models, rasters. */
#include "ecofiles/ecopack/start/start.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/import/model/import_file.h"

enum kind { ABSENT, FOLDER, MODEL, RASTER, TABLE };

/* By the ending, as each is told before it is read. */
static enum kind kind_of(const char *path)
{
	static const char *const rasters[] = { "tif", "tiff", "vrt", "asc", "img", "hgt", "bil", "jp2", "png",
		"jpg", "jpeg" };
	struct stat status;
	if (stat(path, &status) != 0)
		return ABSENT;
	if (S_ISDIR(status.st_mode))
		return eco_path_ends_with(path, "gdb") ? TABLE : FOLDER;
	if (start_is_model(path))
		return MODEL;
	for (size_t i = 0; i < sizeof rasters / sizeof *rasters; i++)
		if (eco_path_ends_with(path, rasters[i]))
			return RASTER;
	return TABLE;
}

static const char *name_of(enum kind kind)
{
	return kind == FOLDER    ? "a folder"
		: kind == RASTER ? "a raster"
		: kind == TABLE  ? "a table"
				 : "a model";
}

static bool is_models(enum kind kind)
{
	return kind == FOLDER || kind == MODEL;
}

/* The first argument that can be models (folders before files), or a table but for `other`; `count`: none. */
static uint32_t find(char **names, uint32_t count, bool models, uint32_t other)
{
	for (enum kind wanted = ABSENT + 1; wanted <= TABLE; wanted++)
		for (uint32_t i = 0; i < count; i++)
			if (i != other && kind_of(names[i]) == wanted &&
				(models ? is_models(wanted) : wanted == TABLE))
				return i;
	return count;
}

/* "TREES MODELS RASTER..." of arguments in any order. */
static void put_in_order(char **names, uint32_t count, uint32_t table, uint32_t models, char *text,
	size_t size)
{
	int used = snprintf(text, size, "%.100s %.100s", names[table], names[models]);
	for (uint32_t i = 0; i < count; i++)
		if (i != table && i != models)
			used += snprintf(text + used, size - (size_t)used, " %.60s", names[i]);
}

enum eco_code start_check_order(char **names, uint32_t count, struct eco_error *error)
{
	const enum kind trees = kind_of(names[0]), models = kind_of(names[1]);
	char order[360];
	bool trees_bad = trees == FOLDER || trees == MODEL;
	if (!trees_bad && (trees == ABSENT || models == ABSENT || is_models(models)))
		return ECO_OK;
	uint32_t folder = find(names, count, true, count), table = find(names, count, false, folder);
	if (folder < count && table < count && (table != 0 || folder != 1)) {
		put_in_order(names, count, table, folder, order, sizeof order);
		return eco_fail(error, ECO_BAD_INPUT,
			"the order is TREES MODELS [RASTER...], and TREES here is %s, MODELS "
			"%s: is ecopack start %s meant?",
			name_of(trees), name_of(models), order);
	}
	if (trees_bad)
		return eco_fail(error, ECO_BAD_INPUT,
			"TREES, %.250s, is %s: the first argument is the table of plants, a "
			"file such as trees.csv",
			names[0], name_of(trees));
	return eco_fail(error, ECO_BAD_INPUT,
		"MODELS, %.250s, is neither a folder nor a model by its ending: " START_FORMATS
		"; export others as GLB",
		names[1]);
}
