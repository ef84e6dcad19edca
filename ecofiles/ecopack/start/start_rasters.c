/* The rasters: which holds the heights of the ground, and which its picture. */
#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/start/start.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/import/model/import_file.h"

static enum eco_code read_extent(struct start *s, const char *path, struct eco_raster_extent **extent)
{
	*extent = eco_alloc(1, sizeof **extent);
	return eco_raster_extent(path, *extent, s->error);
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
	start_guess(s, extent->kind == ECO_RASTER_HEIGHTS ? "terrain" : "picture", path, "--dem, --image", "%s",
		extent->bands);
	return ECO_OK;
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
	struct eco_raster_extent *extent = eco_alloc(1, sizeof *extent);
	struct eco_error own = { .code = ECO_OK };
	bool raster = code == ECO_BAD_INPUT;
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
		start_guess(s, "crs of the picture", s->image.crs, "--image-crs", "as you say");
		return ECO_OK;
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
	start_guess(s, "crs of the picture", s->image.crs, "--image-crs", "its file says none, and in the "
		"scene's the plants' middle lies on it");
	return ECO_OK;
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

enum eco_code start_check_order(char **names, struct eco_error *error)
{
	static const char *const says[] = { "absent", "a folder", "a model", "a raster", "a table" };
	enum kind trees = kind_of(names[0]), models = kind_of(names[1]);
	bool trees_bad = trees == FOLDER || trees == MODEL;
	bool models_bad = trees != ABSENT && (models == RASTER || models == TABLE);
	if (!trees_bad && !models_bad)
		return ECO_OK;
	return eco_fail(error, ECO_BAD_INPUT, "the order is TREES MODELS [RASTER...], and TREES, %.250s, is %s, MODELS, "
		"%.250s, %s: the first is the table of plants, such as trees.csv, the second a folder or a model ("
		START_FORMATS ")", names[0], says[trees], names[1], says[models]);
}
