/* Rasters become ground: GDAL opens and converts. Heights and images are placed alike, by their CRS and
 * their extent in the scene's. Each raster of heights is read as metres (gdal_samples.c) and put on the
 * ground's grid: copied if its samples lie on that grid, else resampled. Missing samples grow in from their
 * neighbours. */
#include "ecofiles/import/ground/gdal_ground.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <errno.h>
#include <gdal.h>
#include <gdal_alg.h>
#include <gdal_utils.h>
#include <math.h>
#include <ogr_srs_api.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/import/ground/gdal_module.h"

void ground_gdal_check(bool good, const char *path, const char *doing)
{
	const char *why = CPLGetLastErrorMsg();
	if (!good)
		eco_stop(ECO_BAD_INPUT, "%.150s: %s: %.200s; gdalinfo says whether it is whole", path, doing,
			why[0] != 0 ? why : "GDAL gives no reason");
}

GDALDatasetH ground_warp(const char *path, GDALDatasetH from, OGRSpatialReferenceH crs, const double box[4],
	const int size[2], const char *const *more)
{
	char **arguments = CSLAddString(CSLAddString(NULL, "-of"), "MEM"), *wkt = NULL;
	GDALDatasetH to = NULL;
	int usage = 0;
	for (; *more; more++)
		arguments = CSLAddString(arguments, *more);
	for (int i = 0; i < 4; i++)
		arguments = CSLAddString(i ? arguments : CSLAddString(arguments, "-te"),
			CPLSPrintf("%.17g", box[i]));
	for (int i = 0; i < 2; i++)
		arguments = CSLAddString(i ? arguments : CSLAddString(arguments, "-ts"),
			CPLSPrintf("%d", size[i]));
	if (crs && OSRExportToWkt(crs, &wkt) == OGRERR_NONE)
		arguments = CSLAddString(CSLAddString(arguments, "-t_srs"), wkt);
	GDALWarpAppOptions *options = GDALWarpAppOptionsNew(arguments, NULL);
	if (options)
		to = GDALWarp("", NULL, 1, &from, options, &usage);
	GDALWarpAppOptionsFree(options);
	CSLDestroy(arguments);
	CPLFree(wkt);
	ground_gdal_check(to, path, "it cannot be brought into the scene's CRS");
	return to;
}

/* ---- CRS ---- */

static OGRSpatialReferenceH make_crs(const char *text, const char *where)
{
	OGRSpatialReferenceH crs = OSRNewSpatialReference(NULL);
	if (OSRSetFromUserInput(crs, text) != OGRERR_NONE)
		eco_stop(ECO_BAD_INPUT, "%.200s: the CRS \"%.100s\" is not known; write a code such as \"EPSG:26917\"",
			where, text);
	OSRSetAxisMappingStrategy(crs, OAMS_TRADITIONAL_GIS_ORDER);
	return crs;
}

/* Removes the vertical part of a CRS, which says what heights are, not where the raster lies. */
static void split_vertical(OGRSpatialReferenceH crs, char vertical[64], double *unit_m)
{
	const char *name = OSRIsCompound(crs) ? OSRGetAttrValue(crs, "COMPD_CS|VERT_CS", 0) : NULL;
	if (!name)
		return;
	snprintf(vertical, 64, "%s", name);
	*unit_m = OSRGetTargetLinearUnits(crs, "COMPD_CS|VERT_CS", NULL);
	OSRStripVertical(crs);
}

void ground_scene_check(struct ground_scene *job)
{
	double unit;
	if (!job->scene_crs)
		return;
	job->crs = make_crs(job->scene_crs, "the scene");
	split_vertical(job->crs, job->vertical, &unit);
	if (!OSRIsProjected(job->crs) || fabs(OSRGetLinearUnits(job->crs, NULL) - 1) > 1e-9)
		eco_stop(ECO_BAD_INPUT, "the scene's CRS \"%.100s\" is not one in metres; take a projected one such as the "
			"UTM zone, \"EPSG:32617\"", job->scene_crs);
}

/* The raster's CRS as the scene states it, else from the file; the error names the line to add. */
static void find_crs(struct ground_raster *r, struct ground_scene *job)
{
	OGRSpatialReferenceH file = GDALGetSpatialRef(r->file), own = file ? OSRClone(file) : NULL;
	if (own)
		split_vertical(own, r->vertical, &r->crs_unit_m);
	if (!job->scene_crs) {
		if (own && (OSRIsProjected(own) || OSRIsGeographic(own)))
			eco_stop(ECO_BAD_INPUT, "%.200s: the raster is in %.100s, but the scene has no CRS; add \"crs\" and "
				"\"origin\" to the scene", r->path, OSRGetName(own));
	} else if (job->stated) {
		r->crs = make_crs(job->stated, r->path);
		if (r->vertical[0] == 0)
			split_vertical(r->crs, r->vertical, &r->crs_unit_m);
		if (own && !OSRIsSame(own, r->crs))
			eco_note(job->notes, "%.200s says it is in %.80s; the scene says %.80s, which is used", r->path,
				OSRGetName(own), job->stated);
	} else if (!own) {
		eco_stop(ECO_BAD_INPUT, "%.200s: the file has no CRS; say it in the scene: \"ground\": {%s, \"crs\": "
			"\"%.80s\"}%s (if it is the scene's)", r->path, job->where[0], job->scene_crs, job->where[1]);
	} else {
		r->crs = own;
		OSRSetAxisMappingStrategy(r->crs, OAMS_TRADITIONAL_GIS_ORDER);
	}
}

/* ---- The place of a raster ---- */

static void find_transform(struct ground_raster *r, const struct ground_scene *job)
{
	double *t = r->transform;
	if (job->has_place) {
		double stated[6] = { job->corner[0], job->pixel[0], 0, job->corner[1], 0, -job->pixel[1] };
		memcpy(t, stated, sizeof stated);
	} else if (GDALGetGeoTransform(r->file, t) != CE_None)
		eco_stop(ECO_BAD_INPUT, "%.200s: it does not say where it lies; add to the %s \"north_west\": [x, y], the outer "
			"corner of its first pixel, and \"pixel\": their size; or put a world file beside it", r->path,
			job->what);
	for (int i = 0; i < 6; i++)
		if (!isfinite(t[i]))
			eco_stop(ECO_DAMAGED, "%.300s: its place on Earth is not finite", r->path);
	if (t[1] * t[5] - t[2] * t[4] == 0)
		eco_stop(ECO_DAMAGED, "%.300s: its pixels have no size", r->path);
}

/* Extent and resolution in the scene's CRS to which GDAL would resample. */
static void suggest(struct ground_raster *r, const struct ground_scene *job)
{
	GDALDriverH memory = GDALGetDriverByName("MEM");
	/* GDAL only needs a raster of this place and size, without samples */
	GDALDatasetH frame = memory ? GDALCreate(memory, "", r->columns, r->rows, 0, GDT_Byte, NULL) : NULL;
	char *from = NULL, *to = NULL;
	double t[6];
	int columns = 0, rows = 0;
	ground_gdal_check(frame, r->path, "no room for its place");
	GDALSetGeoTransform(frame, r->transform);
	if (r->crs) {
		OSRExportToWkt(r->crs, &from);
		OSRExportToWkt(job->crs, &to);
	}
	void *transformer = GDALCreateGenImgProjTransformer(frame, from, NULL, to, FALSE, 0, 1);
	ground_gdal_check(transformer && GDALSuggestedWarpOutput(frame, GDALGenImgProjTransform, transformer, t, &columns,
		&rows) == CE_None && columns > 0 && rows > 0, r->path, "it cannot be brought into the scene's CRS");
	GDALDestroyGenImgProjTransformer(transformer);
	r->low[0] = t[0];
	r->high[0] = t[0] + t[1] * columns;
	r->low[1] = t[3] + t[5] * rows;
	r->high[1] = t[3];
	r->step[0] = t[1];
	r->step[1] = -t[5];
}

void ground_raster_open(struct ground_raster *r, struct ground_scene *job)
{
	r->file = GDALOpenEx(r->path, GDAL_OF_RASTER | GDAL_OF_READONLY, NULL, NULL, NULL);
	ground_gdal_check(r->file, r->path, "not a raster that GDAL can read");
	if (GDALGetRasterCount(r->file) < 1)
		eco_stop(ECO_BAD_INPUT, "%.300s: it has no band", r->path);
	r->columns = GDALGetRasterXSize(r->file);
	r->rows = GDALGetRasterYSize(r->file);
	find_crs(r, job);
}

void ground_raster_place(struct ground_raster *r, const struct ground_scene *job)
{
	const double *t = r->transform;
	find_transform(r, job);
	r->direct = t[2] == 0 && t[4] == 0 && t[1] > 0 && (!r->crs || OSRIsSame(r->crs, job->crs));
	if (!r->direct) {
		suggest(r, job);
		return;
	}
	r->low[0] = t[0];
	r->high[0] = t[0] + t[1] * r->columns;
	r->low[1] = fmin(t[3], t[3] + t[5] * r->rows);
	r->high[1] = fmax(t[3], t[3] + t[5] * r->rows);
	r->step[0] = t[1];
	r->step[1] = fabs(t[5]);
}

/* ---- Heights ---- */

#define ALIGNED 1e-3                 /* in samples: a raster nearer to the grid than this lies on it */
#define GROUND_METRES_MAX 1e7

struct job {
	struct eco_ground_job *asked;
	const struct eco_ground_options *options;    /* as the caller gave them */
	struct ground_raster *rasters; uint32_t count;
	struct ground_scene scene;
	struct eco_ground ground;
	FILE *out;
};

/* ---- Vertical datum ---- */

/* Whether two datums are equal as written, or by PROJ's names. */
static bool same_datum(const char *a, const char *b)
{
	OGRSpatialReferenceH x = OSRNewSpatialReference(NULL), y = OSRNewSpatialReference(NULL);
	const char *name_x = OSRSetFromUserInput(x, a) == OGRERR_NONE ? OSRGetName(x) : a;
	const char *name_y = OSRSetFromUserInput(y, b) == OGRERR_NONE ? OSRGetName(y) : b;
	bool same = strcasecmp(a, b) == 0 || (name_x && name_y && strcasecmp(name_x, name_y) == 0);
	OSRDestroySpatialReference(x);
	OSRDestroySpatialReference(y);
	return same;
}

/* Two datums' heights differ by up to 100 m (ellipsoid and geoid): they are neither converted nor guessed. */
static void check_vertical(const struct ground_raster *r, struct job *job)
{
	const struct eco_ground_source *source = job->options->source;
	const char *own = source->vertical ? source->vertical : r->vertical;
	const char *scene = job->options->scene_vertical;
	if (!scene && job->scene.vertical[0] != 0)
		scene = job->scene.vertical;
	if (source->vertical && !scene)
		eco_stop(ECO_BAD_INPUT, "the ground states its vertical datum, the scene does not; add \"vertical\": \"%.60s\" "
			"to the scene, or the datum of its heights", source->vertical);
	if (scene && own[0] == 0)
		eco_stop(ECO_BAD_INPUT, "%.200s: the scene states its vertical datum, the ground does not; add \"vertical\": "
			"\"%.60s\" to the ground, if that is the datum of its heights", r->path, scene);
	if (scene && !same_datum(scene, own))
		eco_stop(ECO_UNSUPPORTED, "%.200s: its heights are %.60s, those of the scene %.60s, and no conversion is at "
			"hand; convert the raster first (gdalwarp -s_srs ... -t_srs ...)", r->path, own, scene);
	if (!scene && r == job->rasters)
		eco_note(&job->asked->notes, "%.200s: what its heights count from %s%.60s%s, and the "
			"scene does not say either; they are taken as they are (to be sure, add \"vertical\" "
			"to the scene and to its ground)", r->path, own[0] != 0 ? "is said to be " : "is not said", own,
			own[0] != 0 ? " by the file" : "");
}

static void open_raster(struct ground_raster *r, struct job *job)
{
	ground_raster_open(r, &job->scene);
	if (r->columns < 2 || r->rows < 2)
		eco_stop(ECO_BAD_INPUT, "%.300s: %d x %d samples are no ground, at least 2 x 2 are needed", r->path,
			r->columns, r->rows);
	check_vertical(r, job);
	ground_raster_place(r, &job->scene);
}

/* ---- The grid of the ground ---- */

struct frame { double low[2], step[2]; uint32_t samples[2]; };     /* low: outer corner */

static void place_frame(struct frame *f, struct job *job)
{
	const struct ground_raster *first = &job->rasters[0];
	double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY },
		step[2] = { INFINITY, INFINITY };
	for (uint32_t i = 0; i < job->count; i++)
		for (int k = 0; k < 2; k++) {
			low[k] = fmin(low[k], job->rasters[i].low[k]);
			high[k] = fmax(high[k], job->rasters[i].high[k]);
			step[k] = fmin(step[k], job->rasters[i].step[k]);
		}
	for (int k = 0; k < 2; k++) {
		double count = floor((high[k] - low[k]) / step[k] + 0.5);
		if (!(step[k] > 0) || !(count >= 2) || !isfinite(low[k])
				|| high[k] - low[k] > GROUND_METRES_MAX)
			eco_stop(ECO_DAMAGED, "%.200s: ground of %g m with samples every %g m is impossible", first->path,
				high[k] - low[k], step[k]);
		f->low[k] = low[k];
		f->samples[k] = count > job->asked->side_max ? job->asked->side_max : (uint32_t)count;
		f->step[k] = count > job->asked->side_max ? (high[k] - low[k]) / job->asked->side_max
			: step[k];
	}
	if (f->step[0] > step[0] || f->step[1] > step[1])
		eco_note(&job->asked->notes, "%.200s: %.0f x %.0f samples, averaged down to %u x %u; cut "
			"out the part that is needed to keep its resolution",
			first->path, (high[0] - low[0]) / step[0], (high[1] - low[1]) / step[1],
			f->samples[0], f->samples[1]);
}

/* Samples to read along an axis: a raster is read no finer than the ground. */
static uint32_t read_side(const struct ground_raster *r, const struct frame *f, int axis)
{
	uint32_t size = (uint32_t)(axis == 0 ? r->columns : r->rows);
	double wanted = floor(size * r->step[axis] / f->step[axis] + 0.5);
	return wanted >= size ? size : wanted < 2 ? 2 : (uint32_t)wanted;
}

/* Finds the ground sample that is the raster's first; false if the raster is not on the ground's grid. */
static bool on_grid(const struct ground_samples *s, const struct frame *f, int64_t first[2], int sign[2])
{
	const double *t = s->transform;
	double pixel[2] = { t[1], t[5] }, corner[2] = { t[0], t[3] };
	for (int k = 0; k < 2; k++) {
		double at = (corner[k] + pixel[k] / 2 - f->low[k]) / f->step[k] - 0.5;
		if (fabs(fabs(pixel[k]) / f->step[k] - 1) > ALIGNED / (k == 0 ? s->columns : s->rows)
				|| fabs(at - floor(at + 0.5)) > ALIGNED)
			return false;
		first[k] = (int64_t)floor(at + 0.5);
		sign[k] = pixel[k] > 0 ? 1 : -1;
	}
	return true;
}

/* The first raster with a height at a place wins. */
static void put(struct eco_ground *g, int64_t column, int64_t row, float metres, double origin_z)
{
	if (column < 0 || row < 0 || column >= g->columns || row >= g->rows || isnan(metres))
		return;
	float *to = &g->height_m[(size_t)row * g->columns + (size_t)column];
	if (isnan(*to))
		*to = (float)((double)metres - origin_z);
}

static GDALDatasetH wrap(const char *path, const struct ground_samples *s, OGRSpatialReferenceH crs)
{
	GDALDriverH driver = GDALGetDriverByName("MEM");
	GDALDatasetH data = driver ? GDALCreate(driver, "", (int)s->columns, (int)s->rows, 0,
		GDT_Float32, NULL) : NULL;
	char pointer[64], text[96];
	char *options[] = { text, NULL };
	pointer[CPLPrintPointer(pointer, s->metres, sizeof pointer - 1)] = 0;
	snprintf(text, sizeof text, "DATAPOINTER=%s", pointer);
	ground_gdal_check(data && GDALAddBand(data, GDT_Float32, options) == CE_None, path, "no room for its heights");
	GDALSetGeoTransform(data, (double *)s->transform);
	GDALSetRasterNoDataValue(GDALGetRasterBand(data, 1), NAN);
	if (crs)
		GDALSetSpatialRef(data, crs);
	return data;
}

/* The part of the ground's samples, [first, end), that a raster can reach. */
static void reach(const struct ground_raster *r, const struct frame *f, int64_t first[2], int64_t end[2])
{
	for (int k = 0; k < 2; k++) {
		first[k] = (int64_t)floor((r->low[k] - f->low[k]) / f->step[k]);
		end[k] = (int64_t)ceil((r->high[k] - f->low[k]) / f->step[k]);
		first[k] = first[k] < 0 ? 0 : first[k];
		end[k] = end[k] > f->samples[k] ? f->samples[k] : end[k];
	}
}

static void put_resampled(struct job *job, const struct ground_samples *s, const struct ground_raster *r, const struct frame *f)
{
	static const char *const how[] = { "-ot", "Float32", "-r", "bilinear", "-et", "0.01", "-novshift",
		"-dstnodata", "nan", NULL };
	int64_t first[2], end[2];
	double box[4];
	reach(r, f, first, end);
	if (first[0] >= end[0] || first[1] >= end[1])
		return;
	for (int k = 0; k < 2; k++) {
		box[k] = f->low[k] + (double)first[k] * f->step[k];
		box[k + 2] = f->low[k] + (double)end[k] * f->step[k];
	}
	const int size[2] = { (int)(end[0] - first[0]), (int)(end[1] - first[1]) };
	float *line = eco_alloc((size_t)size[0], sizeof *line);
	GDALDatasetH from = wrap(r->path, s, r->crs), to = ground_warp(r->path, from, r->crs ? job->scene.crs : NULL, box, size, how);
	for (int y = 0; y < size[1]; y++) {
		ground_gdal_check(GDALRasterIO(GDALGetRasterBand(to, 1), GF_Read, 0, y, size[0], 1, line, size[0], 1,
			GDT_Float32, 0, 0) == CE_None, r->path, "it cannot be brought into the scene's CRS");
		for (int x = 0; x < size[0]; x++)
			put(&job->ground, first[0] + x, end[1] - 1 - y, line[x], job->options->origin[2]);
	}
	GDALClose(to);
	GDALClose(from);
	free(line);
}

static void add_raster(struct job *job, const struct ground_raster *r, const struct frame *f)
{
	struct ground_samples s;
	int64_t first[2];
	int sign[2];
	ground_samples_read(&s, r, job->options->source, read_side(r, f, 0), read_side(r, f, 1), &job->asked->notes);
	if (r->direct && on_grid(&s, f, first, sign)) {
		for (uint32_t y = 0; y < s.rows; y++)
			for (uint32_t x = 0; x < s.columns; x++)
				put(&job->ground, first[0] + x, first[1] + sign[1] * (int64_t)y,
					s.metres[(size_t)y * s.columns + x], job->options->origin[2]);
	} else
		put_resampled(job, &s, r, f);
	free(s.metres);
}

static void merge(struct job *job)
{
	struct eco_ground *g = &job->ground;
	struct frame frame;
	place_frame(&frame, job);
	g->columns = frame.samples[0];
	g->rows = frame.samples[1];
	g->step_x_m = frame.step[0];
	g->step_y_m = frame.step[1];
	g->x_m = frame.low[0] + frame.step[0] / 2 - job->options->origin[0];
	g->y_m = frame.low[1] + frame.step[1] / 2 - job->options->origin[1];
	size_t count = (size_t)g->columns * g->rows;
	g->height_m = eco_alloc(count, sizeof *g->height_m);
	for (size_t i = 0; i < count; i++)
		g->height_m[i] = NAN;
	for (uint32_t i = 0; i < job->count; i++)
		add_raster(job, &job->rasters[i], &frame);
}

/* ---- The whole ---- */

static void read_ground(void *ctx)
{
	struct job *job = ctx;
	const struct eco_ground_source *source = job->options->source;
	struct eco_ground *ground = &job->ground;
	struct eco_error cause = { .code = ECO_OK };
	ground_scene_check(&job->scene);
	job->rasters = eco_alloc(source->height_count, sizeof *job->rasters);
	for (uint32_t i = 0; i < source->height_count; i++) {
		job->rasters[job->count++].path = source->heights[i];
		open_raster(&job->rasters[i], job);
	}
	merge(job);
	if (eco_ground_fill(ground, &cause))
		eco_stop(cause.code, "%.300s: %s", source->heights[0], cause.text);
	size_t count = (size_t)ground->columns * ground->rows;
	if (fwrite(&job->asked->notes, sizeof job->asked->notes, 1, job->out) != 1
			|| fwrite(ground, sizeof *ground, 1, job->out) != 1
			|| fwrite(ground->height_m, sizeof *ground->height_m, count, job->out) != count)
		eco_stop(ECO_IO, "%.300s: the heights could not be handed over: %s", source->heights[0], strerror(errno));
}

enum eco_code gdal_ground_read(struct eco_ground_job *asked, FILE *out, struct eco_error *error)
{
	const struct eco_ground_source *source = asked->options->source;
	struct job job = { .asked = asked, .options = asked->options, .out = out,
		.scene = { .scene_crs = asked->options->scene_crs, .stated = source->crs, .has_place = source->has_place,
		.corner = source->corner, .pixel = source->pixel, .notes = &asked->notes, .where = { "\"heights\": ...", "" },
		.what = "ground" } };
	CPLPushErrorHandler(CPLQuietErrorHandler);
	CPLSetConfigOption("GDAL_PAM_ENABLED", "NO");
	GDALAllRegister();
	return eco_try(read_ground, &job, error);
}
