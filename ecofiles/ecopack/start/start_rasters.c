/* The rasters: which holds the heights of the ground, and which its picture. */
#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/start/start.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/import/model/import_file.h"

static struct eco_raster_extent *read_extent(const struct start *s, const char *path)
{
	struct eco_raster_extent *extent = eco_alloc(1, sizeof *extent);
	eco_check(eco_raster_extent(path, extent, s->error));
	return extent;
}

/* A raster without an option is sorted by its bands. */
static void sort_raster(struct start *s, const char *path)
{
	struct eco_raster_extent *extent = read_extent(s, path);
	bool heights = extent->kind == ECO_RASTER_HEIGHTS;
	struct start_raster *raster = heights ? &s->dem : &s->image;
	if (extent->kind == ECO_RASTER_DOUBTFUL)
		eco_stop(ECO_BAD_INPUT, "%.200s: heights, or a picture of the ground? %s; say --dem %.200s or --image "
			"%.200s", path, extent->bands, path, path);
	if (raster->path)
		eco_stop(ECO_BAD_INPUT, "%.200s and %.200s: both are rasters of %s; name one, or several as an array in the "
			"scene (%s FILE says what a file is)", raster->path, path, heights ? "heights" : "colours",
			heights ? "--dem" : "--image");
	*raster = (struct start_raster){ path, extent, NULL };
	start_guess(s, heights ? "terrain" : "picture", path, "--dem, --image", "%s", extent->bands);
}

void start_rasters(struct start *s)
{
	const struct start_options *o = s->options;
	if (o->dem)
		s->dem = (struct start_raster){ o->dem, read_extent(s, o->dem), NULL };
	if (o->image)
		s->image = (struct start_raster){ o->image, read_extent(s, o->image), NULL };
	for (uint32_t i = 0; i < o->raster_count; i++)
		sort_raster(s, o->rasters[i]);
}

/* CSV may be read as a grid of points. */
void start_told_raster(struct start *s, enum eco_code code)
{
	static const char *const text[] = { "csv", "tsv", "txt" };
	struct eco_raster_extent *extent = eco_alloc(1, sizeof *extent);
	struct eco_error own = { .code = ECO_OK };
	bool raster = code == ECO_BAD_INPUT;
	for (size_t i = 0; i < sizeof text / sizeof *text && raster; i++)
		raster = !eco_path_ends_with(s->options->table, text[i]);
	if (raster && !eco_raster_extent(s->options->table, extent, &own)) {
		*s->error = own;
		eco_stop(ECO_BAD_INPUT, "%.300s is a raster, no table of plants: rasters come last, as in ecopack start TREES "
			"MODELS RASTER... -o DIR", s->options->table);
	}
	eco_check(code);
	abort();
}

/* The picture's CRS, where its file says none: the scene's, if the plants' middle lies on it then. */
void start_image_crs(struct start *s)
{
	const struct eco_raster_extent *e = s->image.extent;
	const struct eco_place_guess *p = &s->place;
	if (e && s->options->image_crs) {
		s->image.crs = s->options->image_crs;
		start_guess(s, "crs of the picture", s->image.crs, "--image-crs", "as you say");
		return;
	}
	if (!e || e->crs[0] != 0 || p->scene_crs[0] == 0)        /* plain metres, as the scene */
		return;
	for (int k = 0; k < 2; k++)
		if (p->origin[k] < e->low[k] || p->origin[k] > e->high[k])
			eco_stop(ECO_BAD_INPUT, "%.200s: in which CRS is it? Its file says none, and in the "
				"scene's, %s, it lies from %.0f, %.0f to %.0f, %.0f, where the plants are not; say "
				"--image-crs EPSG:...", s->image.path, p->scene_crs, e->low[0], e->low[1], e->high[0],
				e->high[1]);
	s->image.crs = p->scene_crs;
	start_guess(s, "crs of the picture", s->image.crs, "--image-crs", "its file says none, and in the "
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

void start_check_order(char **names)
{
	static const char *const says[] = { "absent", "a folder", "a model", "a raster", "a table" };
	enum kind trees = kind_of(names[0]), models = kind_of(names[1]);
	bool trees_bad = trees == FOLDER || trees == MODEL;
	bool models_bad = trees != ABSENT && (models == RASTER || models == TABLE);
	if (trees_bad || models_bad)
		eco_stop(ECO_BAD_INPUT, "the order is TREES MODELS [RASTER...], and TREES, %.250s, is %s, MODELS, %.250s, %s: "
			"the first is the table of plants, such as trees.csv, the second a folder or a model ("
			START_FORMATS ")", names[0], says[trees], names[1], says[models]);
}
