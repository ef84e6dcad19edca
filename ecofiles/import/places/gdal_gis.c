/* ecogdal.so, the part of this system that calls GDAL: the extent of a raster and rasters of heights; plants
 * to a GeoPackage or GeoJSON, in GDAL's memory: what is not complete never becomes a file. */
#include "ecofiles/import/places/gis_files.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal.h>
#include <math.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/ground/gdal_module.h"

static void measure(GDALDatasetH file, const double transform[6], struct eco_raster_extent *extent)
{
	double columns = GDALGetRasterXSize(file), rows = GDALGetRasterYSize(file);
	for (int k = 0; k < 2; k++) {
		extent->low[k] = INFINITY;
		extent->high[k] = -INFINITY;
		for (int corner = 0; corner < 4; corner++) {
			double at = transform[3 * k] + transform[3 * k + 1] * (corner & 1 ? columns : 0)
				+ transform[3 * k + 2] * (corner & 2 ? rows : 0);
			extent->low[k] = fmin(extent->low[k], at);
			extent->high[k] = fmax(extent->high[k], at);
		}
	}
}

/* A CRS too long to keep is as good as none: the user will be asked. */
static void copy_crs(GDALDatasetH file, char *text, size_t size)
{
	OGRSpatialReferenceH own = GDALGetSpatialRef(file);
	const char *const options[] = { "FORMAT=WKT2_2019", NULL };
	char *wkt = NULL;
	text[0] = 0;
	if (own && (OSRIsProjected(own) || OSRIsGeographic(own)) && OSRExportToWktEx(own, &wkt, options)
			== OGRERR_NONE && strlen(wkt) < size)
		snprintf(text, size, "%s", wkt);
	CPLFree(wkt);
}

/* One band of finer or larger numbers than bytes are heights; three and more, or a table of colours, are a
 * picture. One band of bytes may be either: grey, whole metres, or classes without colours. */
static void find_kind(GDALDatasetH file, struct eco_raster_extent *extent)
{
	int count = GDALGetRasterCount(file), alpha = 0;
	GDALRasterBandH first = GDALGetRasterBand(file, 1);
	GDALDataType type = first ? GDALGetRasterDataType(first) : GDT_Unknown;
	bool named = false;
	for (int b = 1; b <= count; b++) {
		GDALColorInterp is = GDALGetRasterColorInterpretation(GDALGetRasterBand(file, b));
		alpha += is == GCI_AlphaBand;
		named = named || is == GCI_RedBand;
	}
	count -= alpha;
	bool table = first && GDALGetRasterColorTable(first);
	extent->kind = (table && count == 1) || (count >= 3 && (named || type == GDT_Byte
		|| type == GDT_UInt16))
		? ECO_RASTER_PICTURE
		: count == 1 && type != GDT_Byte && !GDALDataTypeIsComplex(type) ? ECO_RASTER_HEIGHTS
		: ECO_RASTER_DOUBTFUL;
	snprintf(extent->bands, sizeof extent->bands, "it has %d band%s of %s%s%s", count, count == 1 ? ""
		: "s",
		GDALGetDataTypeName(type), table ? " with a table of colours" : "", alpha ? " and alpha"
		: "");
}

static enum eco_code raster_extent(const char *path, struct eco_raster_extent *extent, struct eco_error *error)
{
	double transform[6];
	GDALAllRegister();
	CPLPushErrorHandler(CPLQuietErrorHandler);
	GDALDatasetH file = GDALOpen(path, GA_ReadOnly);
	enum eco_code code = ECO_OK;
	if (!file)
		code = eco_fail(error, ECO_BAD_INPUT, "%.200s: no raster that GDAL opens: %.200s", path,
			CPLGetLastErrorMsg());
	else if (GDALGetGeoTransform(file, transform) != CE_None)
		code = eco_fail(error, ECO_BAD_INPUT, "%.200s: the raster does not say where it lies; make a "
			"GeoTIFF of it, or start without it and add \"ground\" with \"north_west\" and "
			"\"pixel\" to the scene", path);
	else
		measure(file, transform, extent);
	if (!code)
		copy_crs(file, extent->crs, sizeof extent->crs);
	if (!code)
		find_kind(file, extent);
	if (file)
		GDALClose(file);
	CPLPopErrorHandler();
	return code;
}

enum field { SPECIES, PLANT, HEIGHT, CROWN, SOURCE_FILE, SOURCE_ROW, SOURCE_LINE, CLASS, OBJECT, FIELD_COUNT };

static const struct { const char *name; OGRFieldType type; } fields[FIELD_COUNT] = {
	[SPECIES] = { "species", OFTString }, [PLANT] = { "plant", OFTString },
	[HEIGHT] = { "height_m", OFTReal }, [CROWN] = { "crown_m", OFTReal }, [SOURCE_FILE] = { "file", OFTString },
	[SOURCE_ROW] = { "row", OFTInteger64 }, [SOURCE_LINE] = { "line", OFTInteger64 },
	[CLASS] = { "class", OFTString }, [OBJECT] = { "object", OFTString } };

static enum eco_code failed(const char *path, struct eco_error *error)
{
	return eco_fail(error, ECO_IO, "%s: %s", path, CPLGetLastErrorMsg());
}

/* Classes come last, so that the others' numbers stay. */
static bool add_fields(OGRLayerH layer, const struct eco_point_table *table)
{
	bool good = true;
	for (int i = 0; i < (table->shape_count ? FIELD_COUNT : table->has_classes ? OBJECT : CLASS) && good; i++) {
		OGRFieldDefnH field = OGR_Fld_Create(fields[i].name, fields[i].type);
		good = OGR_L_CreateField(layer, field, TRUE) == OGRERR_NONE;
		OGR_Fld_Destroy(field);
	}
	return good;
}

/* An empty text, or 0, is null. */
static void set_text(OGRFeatureH feature, enum field field, const char *text)
{
	if (*text)
		OGR_F_SetFieldString(feature, (int)field, text);
	else
		OGR_F_SetFieldNull(feature, (int)field);
}

static void set_count(OGRFeatureH feature, enum field field, uint64_t count)
{
	if (count)
		OGR_F_SetFieldInteger64(feature, (int)field, (GIntBig)count);
	else
		OGR_F_SetFieldNull(feature, (int)field);
}

static void set_size(OGRFeatureH feature, enum field field, double metres)
{
	if (metres > 0)
		OGR_F_SetFieldDouble(feature, (int)field, metres);
	else
		OGR_F_SetFieldNull(feature, (int)field);
}

static bool add_point(OGRLayerH layer, const struct eco_point *point, bool classes)
{
	OGRFeatureH feature = OGR_F_Create(OGR_L_GetLayerDefn(layer));
	OGRGeometryH at = OGR_G_CreateGeometry(wkbPoint);
	OGR_G_SetPoint_2D(at, 0, point->at[0], point->at[1]);
	OGR_F_SetGeometryDirectly(feature, at);
	set_text(feature, SPECIES, point->species);
	set_text(feature, PLANT, point->plant);
	set_size(feature, HEIGHT, point->height_m);
	set_size(feature, CROWN, point->crown_m);
	set_text(feature, SOURCE_FILE, point->row ? point->file : "");
	set_count(feature, SOURCE_ROW, point->row);
	set_count(feature, SOURCE_LINE, point->row ? point->line : 0);
	if (classes)
		set_text(feature, CLASS, point->class);
	bool good = OGR_L_CreateFeature(layer, feature) == OGRERR_NONE;
	OGR_F_Destroy(feature);
	return good;
}

/* A ring, or a line, from edge `from` on; *end: behind its last edge. */
static OGRGeometryH line_of(const struct eco_point_table *table, const struct eco_shape *s, uint32_t from, uint32_t most,
	OGRwkbGeometryType type, uint32_t *end)
{
	OGRGeometryH line = OGR_G_CreateGeometry(type);
	const double *e = s->ends + 4 * (size_t)from;
	uint32_t i = from;
	OGR_G_AddPoint_2D(line, table->origin[0] + e[0], table->origin[1] + e[1]);
	do {
		e = s->ends + 4 * (size_t)i;
		OGR_G_AddPoint_2D(line, table->origin[0] + e[2], table->origin[1] + e[3]);
	} while (++i < most && s->ends[4 * (size_t)i] == e[2] && s->ends[4 * (size_t)i + 1] == e[3] &&
		(type == wkbLineString || e[2] != s->ends[4 * (size_t)from] || e[3] != s->ends[4 * (size_t)from + 1]));
	*end = i;
	return line;
}

/* The area that an odd number of polygons cover, halves first, since a step costs what is there; NULL: GEOS
 * does not know, as for rings that cross. */
static OGRGeometryH odd_of(OGRGeometryH polygons, int first, int count)
{
	if (count == 1)
		return OGR_G_Clone(OGR_G_GetGeometryRef(polygons, first));
	OGRGeometryH halves[2] = { odd_of(polygons, first, count / 2), odd_of(polygons, first + count / 2, count - count / 2) };
	OGRGeometryH odd = halves[0] && halves[1] ? OGR_G_SymDifference(halves[0], halves[1]) : NULL;
	OGR_G_DestroyGeometry(halves[0]);
	OGR_G_DestroyGeometry(halves[1]);
	return odd;
}

/* Rings stand side by side where their odd parts are not known. */
static OGRGeometryH shape_of(const struct eco_point_table *table, const struct eco_shape *s)
{
	const bool rings = s->ring_edges > 0;
	const uint32_t most = rings ? s->ring_edges : s->edge_count;
	OGRGeometryH all = OGR_G_CreateGeometry(rings ? wkbMultiPolygon : wkbMultiLineString);
	for (uint32_t i = 0; i < most;) {
		OGRGeometryH part = line_of(table, s, i, most, rings ? wkbLinearRing : wkbLineString, &i);
		if (rings) {
			OGRGeometryH polygon = OGR_G_CreateGeometry(wkbPolygon);
			OGR_G_AddGeometryDirectly(polygon, part);
			part = polygon;
		}
		OGR_G_AddGeometryDirectly(all, part);
	}
	OGRGeometryH odd = rings && most ? odd_of(all, 0, OGR_G_GetGeometryCount(all)) : NULL;
	if (!odd)
		return all;
	OGR_G_DestroyGeometry(all);
	return odd;
}

static bool add_shape(OGRLayerH layer, const struct eco_point_table *table, const struct eco_shape *s)
{
	OGRFeatureH feature = OGR_F_Create(OGR_L_GetLayerDefn(layer));
	OGR_F_SetGeometryDirectly(feature, shape_of(table, s));
	set_size(feature, HEIGHT, s->height_m);
	set_text(feature, SOURCE_FILE, s->file);
	set_text(feature, CLASS, s->class);
	set_text(feature, OBJECT, s->object);
	bool good = OGR_L_CreateFeature(layer, feature) == OGRERR_NONE;
	OGR_F_Destroy(feature);
	return good;
}

static enum eco_code fill(GDALDatasetH file, const struct eco_point_table *table, OGRSpatialReferenceH crs,
	bool json, const char *path, struct eco_error *error)
{
	char **options = json ? CSLSetNameValue(NULL, "RFC7946", crs ? "YES" : "NO") : NULL;
	OGRLayerH layer = GDALDatasetCreateLayer(file, table->name, crs,
		table->shape_count ? wkbUnknown : wkbPoint, options);
	CSLDestroy(options);
	bool good = layer && add_fields(layer, table)
		&& (json || GDALDatasetStartTransaction(file, FALSE) == OGRERR_NONE);
	for (uint64_t i = 0; i < table->count && good; i++) {
		struct eco_point point;
		table->point(table->ctx, i, &point);
		good = add_point(layer, &point, table->has_classes || table->shape_count);
	}
	for (uint64_t i = 0; i < table->shape_count && good; i++)
		good = add_shape(layer, table, &table->shapes[i]);
	good = good && (json || GDALDatasetCommitTransaction(file) == OGRERR_NONE);
	return good ? ECO_OK : failed(path, error);
}

static enum eco_code take(const char *name, const char *path, uint8_t **bytes, size_t *size,
	struct eco_error *error)
{
	vsi_l_offset length = 0;
	const GByte *content = VSIGetMemFileBuffer(name, &length, FALSE);
	*bytes = content && length ? malloc(length) : NULL;
	if (!*bytes)
		return eco_fail(error, ECO_NO_MEMORY, "%s: no memory for its content", path);
	memcpy(*bytes, content, length);
	*size = length;
	return ECO_OK;
}

static enum eco_code write_to(const char *name, const struct eco_point_table *table, OGRSpatialReferenceH crs,
	bool json, const char *path, struct eco_error *error)
{
	GDALDriverH driver = GDALGetDriverByName(json ? "GeoJSON" : "GPKG");
	GDALDatasetH file = driver ? GDALCreate(driver, name, 0, 0, 0, GDT_Unknown, NULL) : NULL;
	if (!file)
		return failed(path, error);
	enum eco_code code = fill(file, table, crs, json, path, error);
	CPLErrorReset();
	GDALClose(file);
	return code || CPLGetLastErrorType() < CE_Failure ? code : failed(path, error);
}

static enum eco_code points_write(const struct eco_point_table *table, const char *path, uint8_t **bytes,
	size_t *size, struct eco_error *error)
{
	bool json = strcmp(CPLGetExtension(path), "geojson") == 0;
	const char *name = json ? "/vsimem/eco/points.geojson" : "/vsimem/eco/points.gpkg";
	OGRSpatialReferenceH crs = NULL;
	enum eco_code code = ECO_OK;
	GDALAllRegister();
	CPLPushErrorHandler(CPLQuietErrorHandler);
	if (table->crs) {
		crs = OSRNewSpatialReference(NULL);
		OSRSetAxisMappingStrategy(crs, OAMS_TRADITIONAL_GIS_ORDER);
		if (OSRSetFromUserInput(crs, table->crs) != OGRERR_NONE)
			code = eco_fail(error, ECO_BAD_INPUT, "%s: GDAL does not know the CRS \"%.100s\"",
				path, table->crs);
	}
	if (!code)
		code = write_to(name, table, crs, json, path, error);
	if (!code)
		code = take(name, path, bytes, size, error);
	VSIUnlink(name);
	if (crs)
		OSRDestroySpatialReference(crs);
	CPLPopErrorHandler();
	return code;
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

static enum eco_code raster_write(const struct eco_raster *raster, const char *path, struct eco_error *error)
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
	.raster_write = raster_write, .raster_extent = raster_extent,
	.points_write = points_write,
};
