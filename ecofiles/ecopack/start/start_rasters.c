/* The rasters: which holds the heights of the ground, and which its picture. */
#include "ecofiles/ecopack/start/start.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/import/model/import_file.h"

static enum eco_code read_extent(struct start *s, const char *path, struct eco_raster_extent **extent)
{
	*extent = malloc(sizeof **extent);
	return *extent ? eco_raster_extent(path, *extent, s->error)
		: eco_fail(s->error, ECO_NO_MEMORY, "out of memory");
}

static enum eco_code keep(struct start *s, struct start_raster *raster, const char *path,
	struct eco_raster_extent *extent, const char *what, const char *option)
{
	if (raster->path)
		return eco_fail(s->error, ECO_BAD_INPUT, "%.200s and %.200s: both are rasters of %s; name one, or several "
			"as an array in the scene (%s FILE says what a file is)", raster->path, path, what, option);
	*raster = (struct start_raster){ path, extent, NULL };
	return ECO_OK;
}

/* A raster without an option is sorted by its bands. */
static enum eco_code sort_raster(struct start *s, const char *path)
{
	struct eco_raster_extent *extent = NULL;
	enum eco_code code = read_extent(s, path, &extent);
	if (!code && extent->kind == ECO_RASTER_DOUBTFUL)
		code = eco_fail(s->error, ECO_BAD_INPUT, "%.200s: heights, or a picture of the ground? %s; say --dem "
			"%.200s or --image %.200s", path, extent->bands, path, path);
	if (!code)
		code = extent->kind == ECO_RASTER_HEIGHTS ? keep(s, &s->dem, path, extent, "heights", "--dem")
			: keep(s, &s->image, path, extent, "colours", "--image");
	if (code) {
		free(extent);
		return code;
	}
	return start_guess(s, extent->kind == ECO_RASTER_HEIGHTS ? "terrain" : "picture", path,
		"--dem, --image", "%s", extent->bands);
}

enum eco_code start_rasters(struct start *s)
{
	const struct start_options *o = s->options;
	enum eco_code code = ECO_OK;
	s->dem.path = o->dem;
	s->image.path = o->image;
	if (o->dem)
		code = read_extent(s, o->dem, &s->dem.extent);
	if (!code && o->image)
		code = read_extent(s, o->image, &s->image.extent);
	for (uint32_t i = 0; i < o->raster_count && !code; i++)
		code = sort_raster(s, o->rasters[i]);
	return code;
}

/* CSV may be read as a grid of points. */
enum eco_code start_told_raster(struct start *s, enum eco_code code)
{
	static const char *const text[] = { "csv", "tsv", "txt" };
	struct eco_raster_extent *extent = malloc(sizeof *extent);
	struct eco_error own = { .code = ECO_OK };
	bool raster = extent && code == ECO_BAD_INPUT;
	for (size_t i = 0; i < sizeof text / sizeof *text && raster; i++)
		raster = !eco_path_ends_with(s->options->table, text[i]);
	if (raster && !eco_raster_extent(s->options->table, extent, &own)) {
		*s->error = own;
		code = eco_fail(s->error, ECO_BAD_INPUT, "%.300s is a raster, no table of plants: rasters come last, "
			"as in ecopack start TREES MODELS RASTER... -o DIR", s->options->table);
	}
	free(extent);
	return code;
}

/* The picture's CRS, where its file says none: the scene's, if the plants' middle lies on it then. */
enum eco_code start_image_crs(struct start *s)
{
	const struct eco_raster_extent *e = s->image.extent;
	const struct eco_place_guess *p = &s->place;
	if (!e || (e->crs[0] != 0 && !s->options->image_crs))
		return ECO_OK;
	if (s->options->image_crs) {
		s->image.crs = s->options->image_crs;
		return start_guess(s, "crs of the picture", s->image.crs, "--image-crs", "as you say");
	}
	if (p->scene_crs[0] == 0)
		return ECO_OK;           /* plain metres, as the scene */
	for (int k = 0; k < 2; k++)
		if (p->origin[k] < e->low[k] || p->origin[k] > e->high[k])
			return eco_fail(s->error, ECO_BAD_INPUT, "%.200s: in which CRS is it? Its file says none, and in the "
				"scene's, %s, it lies from %.0f, %.0f to %.0f, %.0f, where the plants are not; say "
				"--image-crs EPSG:...", s->image.path, p->scene_crs, e->low[0], e->low[1], e->high[0],
				e->high[1]);
	s->image.crs = p->scene_crs;
	return start_guess(s, "crs of the picture", s->image.crs, "--image-crs", "its file says none, and in the "
		"scene's the plants' middle lies on it");
}

/* ---- Order of arguments ---- */

/* Whether the arguments stand in their order: a table, a folder of models, rasters. */

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
