/* Places of rasters: their CRS, and their extent in the scene's. Heights and images are placed alike. */
#include "ecofiles/import/ground/gdal_ground.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <gdal_alg.h>
#include <gdal_utils.h>
#include <math.h>
#include <string.h>
#include <gdal.h>
#include <ogr_srs_api.h>
#include "ecofiles/import/ground/gdal_module.h"

enum eco_code ground_gdal_fail(const char *path, const char *doing, struct eco_error *error)
{
	const char *why = CPLGetLastErrorMsg();
	return eco_fail(error, ECO_BAD_INPUT, "%.150s: %s: %.200s; gdalinfo says whether it is whole", path,
		doing, why[0] != 0 ? why : "GDAL gives no reason");
}

GDALDatasetH ground_warp(GDALDatasetH from, OGRSpatialReferenceH crs, const double box[4], const int size[2],
	const char *const *more)
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
	return to;
}

/* ---- CRS ---- */

static enum eco_code make_crs(OGRSpatialReferenceH *crs, const char *text, const char *where,
	struct eco_error *error)
{
	*crs = OSRNewSpatialReference(NULL);
	if (OSRSetFromUserInput(*crs, text) != OGRERR_NONE)
		return eco_fail(error, ECO_BAD_INPUT, "%.200s: the CRS \"%.100s\" is not known; write a "
			"code such as \"EPSG:26917\"", where, text);
	OSRSetAxisMappingStrategy(*crs, OAMS_TRADITIONAL_GIS_ORDER);
	return ECO_OK;
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

enum eco_code ground_scene_check(struct ground_scene *job, struct eco_error *error)
{
	const char *text = job->options->scene_crs;
	double unit;
	if (!text)
		return ECO_OK;
	enum eco_code code = make_crs(&job->crs, text, "the scene", error);
	if (code)
		return code;
	split_vertical(job->crs, job->vertical, &unit);
	if (!OSRIsProjected(job->crs) || fabs(OSRGetLinearUnits(job->crs, NULL) - 1) > 1e-9)
		return eco_fail(error, ECO_BAD_INPUT, "the scene's CRS \"%.100s\" is not one in metres; take "
			"a projected one such as the UTM zone, \"EPSG:32617\"", text);
	return ECO_OK;
}

/* The raster's CRS as the scene states it, else from the file; the error names the line to add. */
static enum eco_code raster_crs(struct ground_raster *r, struct ground_scene *job, struct eco_error *error)
{
	const struct eco_ground_options *o = job->options;
	OGRSpatialReferenceH file = GDALGetSpatialRef(r->file), own = file ? OSRClone(file) : NULL;
	const char *stated = o->source->crs;
	enum eco_code code = ECO_OK;
	if (own)
		split_vertical(own, r->vertical, &r->crs_unit_m);
	if (!o->scene_crs) {
		if (own && (OSRIsProjected(own) || OSRIsGeographic(own)))
			code = eco_fail(error, ECO_BAD_INPUT, "%.200s: the raster is in %.100s, but the "
				"scene has no CRS; add \"crs\" and \"origin\" to "
				"the scene", r->path, OSRGetName(own));
	} else if (stated) {
		code = make_crs(&r->crs, stated, r->path, error);
		if (code == ECO_OK && r->vertical[0] == 0)
			split_vertical(r->crs, r->vertical, &r->crs_unit_m);
		if (code == ECO_OK && own && !OSRIsSame(own, r->crs))
			ground_note(job->notes, "%.200s says it is in %.80s; the scene says %.80s, "
				"which is used", r->path, OSRGetName(own), stated);
	} else if (!own) {
		code = eco_fail(error, ECO_BAD_INPUT, "%.200s: the file has no CRS; say it in the scene: "
			"\"ground\": {%s, \"crs\": \"%.80s\"}%s (if it is the scene's)", r->path,
			job->where[0], o->scene_crs, job->where[1]);
	} else {
		r->crs = OSRClone(own);
		OSRSetAxisMappingStrategy(r->crs, OAMS_TRADITIONAL_GIS_ORDER);
	}
	if (own)
		OSRDestroySpatialReference(own);
	return code;
}

/* ---- The place of a raster ---- */

static enum eco_code find_transform(struct ground_raster *r, const struct ground_scene *job,
	struct eco_error *error)
{
	const struct eco_ground_source *source = job->options->source;
	double *t = r->transform;
	if (source->has_place) {
		double stated[6] = { source->corner[0], source->pixel[0], 0, source->corner[1], 0,
			-source->pixel[1] };
		memcpy(t, stated, sizeof stated);
	} else if (GDALGetGeoTransform(r->file, t) != CE_None) {
		return eco_fail(error, ECO_BAD_INPUT, "%.200s: it does not say where it lies; add to the "
			"%s \"north_west\": [x, y], the outer corner "
			"of its first pixel, and \"pixel\": their size; or put a world file beside it",
			r->path, job->what);
	}
	for (int i = 0; i < 6; i++)
		if (!isfinite(t[i]))
			return eco_fail(error, ECO_DAMAGED, "%.300s: its place on Earth is not finite",
				r->path);
	if (t[1] * t[5] - t[2] * t[4] == 0)
		return eco_fail(error, ECO_DAMAGED, "%.300s: its pixels have no size", r->path);
	return ECO_OK;
}

/* Extent and resolution in the scene's CRS to which GDAL would resample. */
static enum eco_code suggest(struct ground_raster *r, const struct ground_scene *job, struct eco_error *error)
{
	GDALDriverH memory = GDALGetDriverByName("MEM");
	/* GDAL only needs a raster of this place and size, without samples */
	GDALDatasetH frame = memory ? GDALCreate(memory, "", r->columns, r->rows, 0, GDT_Byte, NULL) : NULL;
	char *from = NULL, *to = NULL;
	double t[6];
	int columns = 0, rows = 0;
	bool good = false;
	void *transformer = NULL;

	if (!frame)
		return ground_gdal_fail(r->path, "no room for its place", error);
	GDALSetGeoTransform(frame, r->transform);
	if (r->crs) {
		OSRExportToWkt(r->crs, &from);
		OSRExportToWkt(job->crs, &to);
	}
	transformer = GDALCreateGenImgProjTransformer(frame, from, NULL, to, FALSE, 0, 1);
	if (transformer) {
		good = GDALSuggestedWarpOutput(frame, GDALGenImgProjTransform, transformer, t, &columns,
			&rows) == CE_None && columns > 0 && rows > 0;
		GDALDestroyGenImgProjTransformer(transformer);
	}
	CPLFree(from);
	CPLFree(to);
	GDALClose(frame);
	if (!good)
		return ground_gdal_fail(r->path, "it cannot be brought into the scene's CRS", error);
	r->low[0] = t[0];
	r->high[0] = t[0] + t[1] * columns;
	r->low[1] = t[3] + t[5] * rows;
	r->high[1] = t[3];
	r->step[0] = t[1];
	r->step[1] = -t[5];
	return ECO_OK;
}

static enum eco_code find_extent(struct ground_raster *r, const struct ground_scene *job,
	struct eco_error *error)
{
	const double *t = r->transform;
	r->direct = t[2] == 0 && t[4] == 0 && t[1] > 0 && (!r->crs || OSRIsSame(r->crs, job->crs));
	if (!r->direct)
		return suggest(r, job, error);
	r->low[0] = t[0];
	r->high[0] = t[0] + t[1] * r->columns;
	r->low[1] = fmin(t[3], t[3] + t[5] * r->rows);
	r->high[1] = fmax(t[3], t[3] + t[5] * r->rows);
	r->step[0] = t[1];
	r->step[1] = fabs(t[5]);
	return ECO_OK;
}

enum eco_code ground_raster_open(struct ground_raster *r, struct ground_scene *job, struct eco_error *error)
{
	r->file = GDALOpenEx(r->path, GDAL_OF_RASTER | GDAL_OF_READONLY, NULL, NULL, NULL);
	if (!r->file)
		return ground_gdal_fail(r->path, "not a raster that GDAL can read", error);
	if (GDALGetRasterCount(r->file) < 1)
		return eco_fail(error, ECO_BAD_INPUT, "%.300s: it has no band", r->path);
	r->columns = GDALGetRasterXSize(r->file);
	r->rows = GDALGetRasterYSize(r->file);
	return raster_crs(r, job, error);
}

enum eco_code ground_raster_place(struct ground_raster *r, const struct ground_scene *job,
	struct eco_error *error)
{
	enum eco_code code = find_transform(r, job, error);
	return code ? code : find_extent(r, job, error);
}

void ground_raster_close(struct ground_raster *r)
{
	if (r->file)
		GDALClose(r->file);
	if (r->crs)
		OSRDestroySpatialReference(r->crs);
}

/* ---- The module ---- */

static enum eco_code write_samples(GDALDatasetH file, const struct eco_raster *r, const char *wkt,
	const char *path, struct eco_error *error)
{
	/* a GeoTIFF's place is the outer corner of its first pixel */
	double transform[6] = { r->west - r->step_m / 2, r->step_m, 0, r->north + r->step_m / 2, 0,
		-r->step_m };
	int side = (int)r->side;
	GDALSetGeoTransform(file, transform);
	GDALSetProjection(file, wkt);
	if (GDALRasterIO(GDALGetRasterBand(file, 1), GF_Write, 0, 0, side, side, (void *)r->samples, side,
			side, GDT_Float32, 0, 0) != CE_None)
		return eco_fail(error, ECO_IO, "%s: %s", path, CPLGetLastErrorMsg());
	return ECO_OK;
}

enum eco_code gdal_raster_write(const struct eco_raster *raster, const char *path, struct eco_error *error)
{
	OGRSpatialReferenceH crs = OSRNewSpatialReference(NULL);
	char *wkt = NULL;
	GDALDatasetH file;
	enum eco_code code;
	GDALAllRegister();
	GDALDriverH driver = GDALGetDriverByName("GTiff");
	if (!driver || OSRImportFromEPSG(crs, raster->epsg) != OGRERR_NONE || OSRExportToWkt(crs, &wkt)
			!= OGRERR_NONE) {
		code = eco_fail(error, ECO_NOT_FOUND, "GDAL cannot write GeoTIFF in EPSG:%d: is proj-data "
			"installed?", raster->epsg);
	} else if (!(file = GDALCreate(driver, path, (int)raster->side, (int)raster->side, 1, GDT_Float32,
			NULL))) {
		code = eco_fail(error, ECO_IO, "%s: %s", path, CPLGetLastErrorMsg());
	} else {
		code = write_samples(file, raster, wkt, path, error);
		GDALClose(file);
	}
	CPLFree(wkt);
	OSRDestroySpatialReference(crs);
	return code;
}

ECO_MODULE_EXPORT const struct eco_gdal_module eco_gdal_module = {
	.version = ECO_MODULE_VERSION, .ground_read = gdal_ground_read,
		.ground_image_read = gdal_image_read, .rows_knows = gdal_rows_knows,
		.rows_open = gdal_rows_open,
	.raster_write = gdal_raster_write, .raster_extent = gdal_raster_extent,
	.points_write = gdal_points_write,
};
