/* A raster becomes ground: GDAL opens, converts and averages; what is missing is grown in from its neighbours. All of GDAL happens in
 * a child process, which hands back struct eco_ground and its samples. */
#include "ecofiles/ground.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <errno.h>
#include <gdal.h>
#include <gdal_alg.h>
#include <gdal_utils.h>
#include <gdalwarper.h>
#include <math.h>
#include <ogr_srs_api.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "ecofiles/guard.h"

#define HEIGHT_MAX_M 1e5
#define NOTE_BYTES 512u

struct job {
	const struct eco_ground_options *options;
	uint32_t side_max;
	char note[NOTE_BYTES];
};

struct raster {
	GDALDatasetH file, floats, warped;   /* floats: a view of band 1 as floats; warped: a view of that in the scene's CRS, or NULL */
	OGRSpatialReferenceH crs, scene_crs;
	double transform[6];
};

static enum eco_code gdal_fail(const char *path, const char *doing, struct eco_error *error)
{
	const char *why = CPLGetLastErrorMsg();

	return eco_fail(error, ECO_BAD_INPUT, "%.200s: %s: %.250s", path, doing, why[0] != 0 ? why : "GDAL gives no reason");
}

/* ---- CRS ---- */

static enum eco_code make_crs(OGRSpatialReferenceH *crs, const char *text, const char *where, struct eco_error *error)
{
	*crs = OSRNewSpatialReference(NULL);
	if (OSRSetFromUserInput(*crs, text) != OGRERR_NONE)
		return eco_fail(error, ECO_BAD_INPUT, "%.200s: the CRS \"%.100s\" is not known; write a code such as \"EPSG:26917\"", where, text);
	OSRSetAxisMappingStrategy(*crs, OAMS_TRADITIONAL_GIS_ORDER);
	return ECO_OK;
}

/* The raster's CRS as stated, else as the file has it; errors say which line to add. */
static enum eco_code raster_crs(struct raster *r, const struct eco_ground_options *o, struct job *job, struct eco_error *error)
{
	OGRSpatialReferenceH own = GDALGetSpatialRef(r->file);
	const char *stated = o->crs;

	if (o->scene_crs == NULL) {
		if (own != NULL && (OSRIsProjected(own) || OSRIsGeographic(own)))
			return eco_fail(error, ECO_BAD_INPUT, "%.200s: the raster is in %.100s, but the scene has no CRS; add \"crs\" and \"origin\" to the "
				"scene", o->path, OSRGetName(own));
		return ECO_OK;
	}
	if (stated == NULL && own == NULL)
		return eco_fail(error, ECO_BAD_INPUT, "%.200s: the file has no CRS; say it in the scene: \"ground\": {\"heights\": ..., \"crs\": \"%.80s\"} "
			"(if it is the scene's)", o->path, o->scene_crs);
	if (make_crs(&r->scene_crs, o->scene_crs, "the scene", error) != ECO_OK)
		return error->code;
	if (!OSRIsProjected(r->scene_crs) || fabs(OSRGetLinearUnits(r->scene_crs, NULL) - 1) > 1e-9)
		return eco_fail(error, ECO_BAD_INPUT, "the scene's CRS \"%.100s\" is not one in metres; take a projected one such as the UTM zone, "
			"\"EPSG:32617\"", o->scene_crs);
	if (stated == NULL) {
		r->crs = OSRClone(own);
		OSRSetAxisMappingStrategy(r->crs, OAMS_TRADITIONAL_GIS_ORDER);
		return ECO_OK;
	}
	if (make_crs(&r->crs, stated, o->path, error) != ECO_OK)
		return error->code;
	if (own != NULL && !OSRIsSame(own, r->crs))
		snprintf(job->note, sizeof job->note, "%.200s says it is in %.80s; the scene says %.80s, which is used", o->path, OSRGetName(own),
			stated);
	return ECO_OK;
}

/* ---- The view of the raster that is read: north up, in the scene's CRS ---- */

static enum eco_code warp(struct raster *r, const char *path, struct eco_error *error)
{
	char *from = NULL, *to = NULL;

	if (r->crs != NULL) {
		OSRExportToWkt(r->crs, &from);
		OSRExportToWkt(r->scene_crs, &to);
	}
	r->warped = GDALAutoCreateWarpedVRT(r->floats, from, to, GRA_Bilinear, 0.0, NULL);
	CPLFree(from);
	CPLFree(to);
	if (r->warped == NULL)
		return gdal_fail(path, "it cannot be brought into the scene's CRS", error);
	return GDALGetGeoTransform(r->warped, r->transform) == CE_None ? ECO_OK : gdal_fail(path, "no place on Earth", error);
}

/* Whole-number rasters would be averaged and interpolated to whole numbers, in steps. */
static enum eco_code view_as_floats(struct raster *r, const char *path, struct eco_error *error)
{
	char *arguments[] = { "-of", "VRT", "-ot", "Float32", "-b", "1", NULL };
	GDALTranslateOptions *options = GDALTranslateOptionsNew(arguments, NULL);
	int usage = 0;

	if (options != NULL)
		r->floats = GDALTranslate("", r->file, options, &usage);
	GDALTranslateOptionsFree(options);
	return r->floats != NULL ? ECO_OK : gdal_fail(path, "its first band cannot be read", error);
}

static enum eco_code open_raster(struct raster *r, struct job *job, struct eco_error *error)
{
	const struct eco_ground_options *o = job->options;
	bool rotated;
	enum eco_code code;

	r->file = GDALOpenEx(o->path, GDAL_OF_RASTER | GDAL_OF_READONLY, NULL, NULL, NULL);
	if (r->file == NULL)
		return gdal_fail(o->path, "not a raster that GDAL can read", error);
	if (GDALGetRasterCount(r->file) < 1)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: it has no band", o->path);
	code = raster_crs(r, o, job, error);
	if (code == ECO_OK)
		code = view_as_floats(r, o->path, error);
	if (code != ECO_OK)
		return code;
	if (GDALGetGeoTransform(r->file, r->transform) != CE_None)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: it does not say where it lies (no geotransform); use a GeoTIFF, or a file with a world "
			"file beside it", o->path);
	for (int i = 0; i < 6; i++)
		if (!isfinite(r->transform[i]))
			return eco_fail(error, ECO_DAMAGED, "%.300s: its place on Earth is not finite", o->path);
	rotated = r->transform[2] != 0 || r->transform[4] != 0 || r->transform[1] <= 0;
	if (rotated || (r->crs != NULL && !OSRIsSame(r->crs, r->scene_crs)))
		return warp(r, o->path, error);
	return ECO_OK;
}

/* ---- Samples ---- */

static uint32_t bounded_side(int size, uint32_t side_max)
{
	return (uint32_t)size > side_max ? side_max : (uint32_t)size;
}

/* Columns, rows and where they are. Averaging down keeps the raster's extent: a sample is the centre of a larger pixel. */
static enum eco_code place_grid(struct eco_ground *g, const struct raster *r, struct job *job, struct eco_error *error)
{
	GDALDatasetH from = r->warped != NULL ? r->warped : r->floats;
	const struct eco_ground_options *o = job->options;
	int columns = GDALGetRasterXSize(from), rows = GDALGetRasterYSize(from);
	const double *t = r->transform;
	double south;

	if (columns < 2 || rows < 2)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: %d x %d samples are no ground, at least 2 x 2 are needed", o->path, columns, rows);
	g->columns = bounded_side(columns, job->side_max);
	g->rows = bounded_side(rows, job->side_max);
	if (g->columns < (uint32_t)columns || g->rows < (uint32_t)rows)
		snprintf(job->note, sizeof job->note, "%.300s: %d x %d samples, averaged down to %u x %u; cut out the part that is needed to keep its "
			"resolution", o->path, columns, rows, g->columns, g->rows);
	g->step_x_m = t[1] * columns / g->columns;
	g->step_y_m = fabs(t[5]) * rows / g->rows;
	south = t[5] < 0 ? t[3] + t[5] * rows : t[3];
	g->x_m = t[0] + g->step_x_m / 2 - o->origin[0];
	g->y_m = south + g->step_y_m / 2 - o->origin[1];
	if (!(g->step_x_m > 0) || !(g->step_y_m > 0) || !isfinite(g->x_m) || !isfinite(g->y_m))
		return eco_fail(error, ECO_DAMAGED, "%.300s: its pixels have no size", o->path);
	return ECO_OK;
}

struct meaning { bool has_no_data; double no_data, scale, offset; };

static struct meaning meaning_of(GDALRasterBandH band)
{
	int has_no_data = 0, has_scale = 0, has_offset = 0;
	struct meaning m = { .no_data = GDALGetRasterNoDataValue(band, &has_no_data), .scale = GDALGetRasterScale(band, &has_scale),
		.offset = GDALGetRasterOffset(band, &has_offset) };

	m.has_no_data = has_no_data != 0;
	if (!has_scale || !isfinite(m.scale) || m.scale == 0)
		m.scale = 1;
	if (!has_offset || !isfinite(m.offset))
		m.offset = 0;
	return m;
}

/* Metres, or NaN for what is no height. */
static double metres_of(const struct meaning *m, float raw)
{
	double metres = raw * m->scale + m->offset;

	if (m->has_no_data && raw == (float)m->no_data)
		return NAN;
	return fabs(metres) <= HEIGHT_MAX_M ? metres : NAN;
}

struct strip {                       /* one row of the raster, and sums for one row of the ground */
	float *raw;
	double *sum;
	uint32_t *count;
};

/* Means of the raster's rows [first, end) into one row of the ground. */
static bool average_rows(const struct eco_ground *g, GDALRasterBandH band, const struct meaning *meaning, struct strip *strip, int first,
	int end, int columns, float *to, double origin_z)
{
	memset(strip->sum, 0, g->columns * sizeof *strip->sum);
	memset(strip->count, 0, g->columns * sizeof *strip->count);
	for (int y = first; y < end; y++) {
		if (GDALRasterIO(band, GF_Read, 0, y, columns, 1, strip->raw, columns, 1, GDT_Float32, 0, 0) != CE_None)
			return false;
		for (int x = 0; x < columns; x++) {
			double metres = metres_of(meaning, strip->raw[x]);
			uint32_t c = (uint32_t)((uint64_t)x * g->columns / (uint32_t)columns);

			if (isnan(metres))
				continue;
			strip->sum[c] += metres;
			strip->count[c]++;
		}
	}
	for (uint32_t c = 0; c < g->columns; c++)
		to[c] = strip->count[c] > 0 ? (float)(strip->sum[c] / strip->count[c] - origin_z) : NAN;
	return true;
}

static bool average_all(struct eco_ground *g, GDALDatasetH from, bool north_first, struct strip *strip, double origin_z)
{
	GDALRasterBandH band = GDALGetRasterBand(from, 1);
	struct meaning meaning = meaning_of(band);
	int columns = GDALGetRasterXSize(from), rows = GDALGetRasterYSize(from);

	for (uint32_t r = 0; r < g->rows; r++) {
		int first = (int)((uint64_t)r * (uint32_t)rows / g->rows), end = (int)((uint64_t)(r + 1) * (uint32_t)rows / g->rows);
		float *to = &g->height_m[(size_t)(north_first ? g->rows - 1 - r : r) * g->columns];

		if (!average_rows(g, band, &meaning, strip, first, end, columns, to, origin_z))
			return false;
	}
	return true;
}

/* Reads row by row: GDAL's own averaging rounds to the file's number type and knows nothing of absurd values. */
static enum eco_code read_samples(struct eco_ground *g, const struct raster *r, const struct job *job, struct eco_error *error)
{
	GDALDatasetH from = r->warped != NULL ? r->warped : r->floats;
	struct strip strip = { .raw = malloc((size_t)GDALGetRasterXSize(from) * sizeof *strip.raw),
		.sum = malloc(g->columns * sizeof *strip.sum), .count = malloc(g->columns * sizeof *strip.count) };
	enum eco_code code = ECO_OK;

	g->height_m = malloc((size_t)g->columns * g->rows * sizeof *g->height_m);
	if (g->height_m == NULL || strip.raw == NULL || strip.sum == NULL || strip.count == NULL)
		code = eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", job->options->path);
	else if (!average_all(g, from, r->transform[5] < 0, &strip, job->options->origin[2]))
		code = gdal_fail(job->options->path, "its samples cannot be read", error);
	free(strip.raw);
	free(strip.sum);
	free(strip.count);
	return code;
}

/* ---- Missing samples ---- */

/* Mean of the up to eight neighbours that have a height in `known`. */
static float neighbour_mean(const struct eco_ground *g, const uint32_t *round, uint32_t now, size_t i)
{
	int64_t column = (int64_t)(i % g->columns), row = (int64_t)(i / g->columns);
	double sum = 0;
	int count = 0;

	for (int64_t y = row > 0 ? row - 1 : 0; y <= row + 1 && y < (int64_t)g->rows; y++)
		for (int64_t x = column > 0 ? column - 1 : 0; x <= column + 1 && x < (int64_t)g->columns; x++) {
			size_t k = (size_t)y * g->columns + (size_t)x;

			if (round[k] < now) {
				sum += g->height_m[k];
				count++;
			}
		}
	return count > 0 ? (float)(sum / count) : NAN;
}

static size_t push_missing_neighbours(const struct eco_ground *g, uint32_t *round, uint32_t now, size_t i, size_t *queue, size_t end)
{
	int64_t column = (int64_t)(i % g->columns), row = (int64_t)(i / g->columns);

	for (int64_t y = row > 0 ? row - 1 : 0; y <= row + 1 && y < (int64_t)g->rows; y++)
		for (int64_t x = column > 0 ? column - 1 : 0; x <= column + 1 && x < (int64_t)g->columns; x++) {
			size_t k = (size_t)y * g->columns + (size_t)x;

			if (round[k] == UINT32_MAX) {
				round[k] = now;
				queue[end++] = k;
			}
		}
	return end;
}

/* Grows the known samples outwards ring by ring: each round gives the missing samples that touch known ones the mean of those, so
 * that the result does not depend on an order. Linear in the samples. */
static bool fill(struct eco_ground *g, uint32_t *round, size_t *queue)
{
	size_t count = (size_t)g->columns * g->rows, begin = 0, end = 0;
	uint32_t now = 1;

	for (size_t i = 0; i < count; i++) {
		round[i] = isnan(g->height_m[i]) ? UINT32_MAX : 0;
		g->filled += round[i] != 0;
	}
	if (g->filled == count)
		return false;
	for (size_t i = 0; i < count && g->filled > 0; i++)
		if (round[i] == 0)
			end = push_missing_neighbours(g, round, now, i, queue, end);
	while (begin < end) {
		size_t last = end;

		for (size_t k = begin; k < last; k++)
			g->height_m[queue[k]] = neighbour_mean(g, round, now, queue[k]);
		now++;
		for (; begin < last; begin++)
			end = push_missing_neighbours(g, round, now, queue[begin], queue, end);
	}
	return true;
}

static enum eco_code fill_missing(struct eco_ground *g, const char *path, struct eco_error *error)
{
	size_t count = (size_t)g->columns * g->rows;
	uint32_t *round = malloc(count * sizeof *round);
	size_t *queue = malloc(count * sizeof *queue);
	enum eco_code code = ECO_OK;

	if (round == NULL || queue == NULL)
		code = eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", path);
	else if (!fill(g, round, queue))
		code = eco_fail(error, ECO_BAD_INPUT, "%.300s: it holds no height at all, only NODATA", path);
	free(round);
	free(queue);
	return code;
}

/* ---- The child and its parent ---- */

static void close_raster(struct raster *r)
{
	if (r->warped != NULL)
		GDALClose(r->warped);
	if (r->floats != NULL)
		GDALClose(r->floats);
	if (r->file != NULL)
		GDALClose(r->file);
	if (r->crs != NULL)
		OSRDestroySpatialReference(r->crs);
	if (r->scene_crs != NULL)
		OSRDestroySpatialReference(r->scene_crs);
}

static enum eco_code work(void *ctx, FILE *out, struct eco_error *error)
{
	struct job *job = ctx;
	struct raster raster = { .file = NULL };
	struct eco_ground ground = { .height_m = NULL };
	enum eco_code code;

	CPLPushErrorHandler(CPLQuietErrorHandler);
	GDALAllRegister();
	code = open_raster(&raster, job, error);
	if (code == ECO_OK)
		code = place_grid(&ground, &raster, job, error);
	if (code == ECO_OK)
		code = read_samples(&ground, &raster, job, error);
	if (code == ECO_OK)
		code = fill_missing(&ground, job->options->path, error);
	if (code == ECO_OK && (fwrite(job->note, sizeof job->note, 1, out) != 1 || fwrite(&ground, sizeof ground, 1, out) != 1
		|| fwrite(ground.height_m, sizeof *ground.height_m, (size_t)ground.columns * ground.rows, out)
			!= (size_t)ground.columns * ground.rows))
		code = eco_fail(error, ECO_IO, "%.300s: the heights could not be handed over: %s", job->options->path, strerror(errno));
	free(ground.height_m);
	close_raster(&raster);
	CPLPopErrorHandler();
	return code;
}

static bool get_ground(FILE *in, struct eco_ground *ground, struct job *job)
{
	struct eco_ground head;
	size_t count;

	if (fread(job->note, sizeof job->note, 1, in) != 1 || fread(&head, sizeof head, 1, in) != 1 || head.columns < 2 || head.rows < 2
		|| head.columns > job->side_max || head.rows > job->side_max || !(head.step_x_m > 0) || !(head.step_y_m > 0)
		|| !isfinite(head.x_m) || !isfinite(head.y_m))
		return false;
	job->note[sizeof job->note - 1] = 0;
	count = (size_t)head.columns * head.rows;
	head.height_m = malloc(count * sizeof *head.height_m);
	if (head.height_m == NULL)
		return false;
	*ground = head;
	if (fread(ground->height_m, sizeof *ground->height_m, count, in) != count)
		return false;
	for (size_t i = 0; i < count; i++)
		if (!isfinite(ground->height_m[i]))
			return false;
	return true;
}

static void tell(const struct eco_ground_options *options, const struct eco_ground *ground, const struct job *job)
{
	char text[400];

	if (options->warn == NULL)
		return;
	if (job->note[0] != 0)
		options->warn(options->ctx, job->note);
	if (ground->filled == 0)
		return;
	snprintf(text, sizeof text, "%.250s: %llu of %llu samples have no height and were filled from their neighbours", options->path,
		(unsigned long long)ground->filled, (unsigned long long)ground->columns * ground->rows);
	options->warn(options->ctx, text);
}

enum eco_code eco_ground_import(struct eco_ground *ground, const struct eco_ground_options *options, struct eco_error *error)
{
	struct job job = { .options = options, .side_max = options->side_max };
	FILE *result;
	enum eco_code code;

	*ground = (struct eco_ground){ .height_m = NULL };
	if (job.side_max < 2 || job.side_max > ECO_GROUND_SIDE_MAX)
		job.side_max = ECO_GROUND_SIDE_MAX;
	if (access(options->path, R_OK) != 0)
		return eco_fail(error, errno == ENOENT ? ECO_NOT_FOUND : ECO_IO, "%s: %s", options->path, strerror(errno));
	code = eco_guard_run(work, &job, options->path, NULL, &result, error);
	if (code != ECO_OK)
		return code;
	if (!get_ground(result, ground, &job))
		code = eco_fail(error, ECO_DAMAGED, "%.300s: what its reader handed over does not hold together", options->path);
	fclose(result);
	if (code == ECO_OK)
		tell(options, ground, &job);
	else
		eco_ground_free(ground);
	return code;
}
