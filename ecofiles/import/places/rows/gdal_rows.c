/* Tables with geometry, as OGR opens them: GeoJSON, GeoPackage, Shapefile, KML, GML, FlatGeobuf, ... Runs
 * in the child process of rows_child.c. Points are places; each point of a multipoint is a row of its own.
 * Surfaces and lines are handed over whole if areas are wanted, else by their type's name. */
#include "ecofiles/import/places/rows/rows.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <ctype.h>
#include <gdal.h>
#include <math.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/import/ground/gdal_module.h"
#include "ecofiles/import/model/import_file.h"

#define LOOKED_AT 64                 /* features looked at to judge the coordinates */
#define AREA_BYTES_MAX (1u << 28)

struct ogr_rows {
	struct eco_rows rows;
	GDALDatasetH data;
	OGRLayerH layer;
	OGRFeatureH feature;
	OGRGeometryH points;         /* a multipoint of the feature, owned by it; NULL: none */
	int point;
	bool areas, partial;
	bool trees;                  /* of a city model */
	char *path;
	char broken[200]; /* the first error by which GDAL says that the file does not hold together */
	uint8_t *wkb; size_t wkb_capacity;
	char *copies[ECO_COLUMNS_MAX];   /* of the row's fields that are not texts */
	struct eco_rows_point text_point;        /* of a table without geometry; found is false if it has none */
};

/* Drivers go on after what they cannot parse, with fewer rows or none. */
static void keep_error(CPLErr kind, CPLErrorNum number, const char *text)
{
	struct ogr_rows *r = CPLGetErrorHandlerUserData();
	(void)number;
	if (r && kind >= CE_Failure && !r->broken[0] && strcasestr(text, "parsing"))
		eco_phrase_cut(r->broken, sizeof r->broken,
			snprintf(r->broken, sizeof r->broken, "%s", text));
}

static void quiet(struct ogr_rows *r)
{
	CPLPushErrorHandlerEx(keep_error, r);
	CPLSetConfigOption("OGR_GEOJSON_MAX_OBJ_SIZE", "512");
	CPLSetConfigOption("OGR_XLSX_HEADERS", "FORCE");
	CPLSetConfigOption("OGR_ODS_HEADERS", "FORCE");
	GDALAllRegister();
}

bool gdal_rows_knows(const char *path)
{
	quiet(NULL);
	GDALDriverH driver = GDALIdentifyDriverEx(path, GDAL_OF_VECTOR, NULL, NULL);
	CPLPopErrorHandler();
	return driver && strcmp(GDALGetDriverShortName(driver), "CSV") != 0;
}

static enum eco_code gdal_says(const char *path, enum eco_code code, const char *doing,
	struct eco_error *error)
{
	const char *why = CPLGetLastErrorMsg();
	return eco_fail(error, code, "%.200s: %s%s%s", path, doing, *why != 0 ? ": " : "", why);
}

static enum eco_code cannot_read(const struct ogr_rows *r, const char *why, struct eco_error *error)
{
	return eco_fail(error, ECO_DAMAGED,
		"%.200s: it cannot be read, as it is damaged or breaks off: %s; copy, download or "
		"export it again",
		r->path, r->broken[0] ? r->broken : why);
}

/* ---- The layer ---- */

static bool is_point(OGRwkbGeometryType type)
{
	type = wkbFlatten(type);
	return type == wkbPoint || type == wkbMultiPoint;
}

static bool is_surface(OGRwkbGeometryType type)
{
	type = wkbFlatten(type);
	return type == wkbPolygon || type == wkbMultiPolygon || type == wkbCurvePolygon
		|| type == wkbMultiSurface;
}

static enum eco_code ask_for_layer(struct ogr_rows *r, const char *wanted, struct eco_error *error)
{
	char names[300] = "";
	int count = GDALDatasetGetLayerCount(r->data);
	for (int i = 0; i < count; i++) {
		OGRLayerH layer = GDALDatasetGetLayer(r->data, i);
		char name[200];
		snprintf(name, sizeof name, "%.150s (%s)", OGR_L_GetName(layer),
			OGRGeometryTypeToName(OGR_L_GetGeomType(layer)));
		eco_phrase_add(names, sizeof names, name);
	}
	if (wanted)
		return eco_fail(error, ECO_BAD_INPUT, "%.150s: no layer \"%.60s\"; there are: %s", r->path,
			wanted, names);
	return eco_fail(error, ECO_BAD_INPUT, "%.150s: it has several layers; add \"layer\": \"%.60s\" or "
		"another of: %s", r->path, OGR_L_GetName(GDALDatasetGetLayer(r->data, 0)), names);
}

/* CityGML names its trees; OGR reads them as any GML. */
static bool find_trees(struct ogr_rows *r)
{
	r->layer = GDALDatasetGetLayerByName(r->data, "SolitaryVegetationObject");
	r->trees = r->layer && !r->areas;
	if (r->trees && GDALDatasetGetLayerByName(r->data, "PlantCover"))
		eco_rows_note(&r->rows,
			"its PlantCover features are skipped: they are areas; as GeoJSON polygons, "
			"\"scatter\" "
			"fills them with plants");
	return r->trees;
}

/* Chooses the layer asked for, or the only one, or the only one whose geometries fit. */
static enum eco_code find_layer(struct ogr_rows *r, const char *wanted, struct eco_error *error)
{
	int count = GDALDatasetGetLayerCount(r->data), fitting = 0, unknown = 0, found = 0;
	if (count == 0)
		return cannot_read(r, "it has no layer", error);
	if (wanted) {
		r->layer = GDALDatasetGetLayerByName(r->data, wanted);
		return r->layer ? ECO_OK : ask_for_layer(r, wanted, error);
	}
	if (find_trees(r))
		return ECO_OK;
	for (int i = 0; i < count; i++) {
		OGRwkbGeometryType type = OGR_L_GetGeomType(GDALDatasetGetLayer(r->data, i));
		bool fits = r->areas ? is_surface(type) : is_point(type);
		unknown += wkbFlatten(type) == wkbUnknown;
		if (fits && fitting++ == 0)
			found = i;
	}
	if (count > 1 && (fitting != 1 || unknown > 0))
		return ask_for_layer(r, NULL, error);
	r->layer = GDALDatasetGetLayer(r->data, found);
	if (count > 1)
		eco_rows_note(&r->rows, "it has %d layers; \"%.60s\" is taken, the only one of %s; "
			"\"layer\" names "
			"another", count, OGR_L_GetName(r->layer), r->areas ? "polygons" : "points");
	return r->layer ? ECO_OK : gdal_says(r->path, ECO_BAD_INPUT, "its layer cannot be read", error);
}

/* A Shapefile is several files, and people often send one. */
static bool lacks_part(const char *path, const char *extension)
{
	size_t length = strlen(path);
	char beside[4096];
	if (length < 4 || length + 1 > sizeof beside || strcasecmp(path + length - 4, ".shp") != 0)
		return false;
	memcpy(beside, path, length - 3);
	strcpy(beside + length - 3, extension);
	if (access(beside, F_OK) == 0)
		return false;
	for (char *c = beside + length - 3; *c != 0; c++)
		*c = (char)toupper((unsigned char)*c);
	return access(beside, F_OK) != 0;
}

/* ---- CRS ---- */

static bool is_of(const struct ogr_rows *r, const char *format)
{
	GDALDriverH driver = GDALGetDatasetDriver(r->data);
	return driver && strcmp(GDALGetDriverShortName(driver), format) == 0;
}

/* "urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH" of German surveys, which PROJ does not know. */
static void take_german_crs(struct ogr_rows *r)
{
	static const char name[] = "\"urn:adv:crs:ETRS89_UTM";
	size_t size;
	char *head = eco_file_read_head(r->path, &size), *at = strstr(head, name);
	int zone = at ? atoi(at + strlen(name)) : 0;
	if (zone >= 28 && zone <= 38 && asprintf(&r->rows.crs, "EPSG:%d", 25800 + zone) < 0)
		r->rows.crs = NULL;
	free(head);
}

static enum eco_code take_crs(struct ogr_rows *r, struct eco_error *error)
{
	OGRSpatialReferenceH crs = OGR_L_GetSpatialRef(r->layer);
	const char *authority = crs ? OSRGetAuthorityName(crs, NULL) : NULL, *number = crs
		? OSRGetAuthorityCode(crs, NULL) : NULL;
	const char *options[] = { "FORMAT=WKT2_2019", NULL };
	char *wkt = NULL, text[64];
	if (!crs) {
		if (r->trees)
			take_german_crs(r);
		if (is_of(r, "ESRI Shapefile"))
			snprintf(r->rows.no_crs, sizeof r->rows.no_crs,
				lacks_part(r->path, "prj") ? " (there is no .prj beside it)"
							   : " (its .prj cannot be read)");
		return ECO_OK;
	}
	if (OSRIsLocal(crs) || (!OSRIsProjected(crs) && !OSRIsGeographic(crs))) {
		snprintf(r->rows.no_crs, sizeof r->rows.no_crs, " (it names \"%.60s\", which has no place "
			"on Earth)", OSRGetName(crs) != NULL ? OSRGetName(crs) : "");
		return ECO_OK;
	}
	if (authority && number && snprintf(text, sizeof text, "%s:%s", authority, number)
			< (int)sizeof text) {
		r->rows.crs = eco_copy_text(text);
	} else if (OSRExportToWktEx(crs, &wkt, options) == OGRERR_NONE && strlen(wkt) < ECO_ROWS_CRS_BYTES) {
		r->rows.crs = eco_copy_text(wkt);
	} else {
		CPLFree(wkt);
		return eco_fail(error, ECO_UNSUPPORTED, "%.300s: its CRS cannot be told; add \"crs\" to its "
			"entry", r->path);
	}
	CPLFree(wkt);
	return ECO_OK;
}

/* Checks whether the first features' coordinates fit degrees and have heights. A few absurd ones count
 * only as bad rows. */
static void look_at_some(struct ogr_rows *r)
{
	OGRSpatialReferenceH crs = OGR_L_GetSpatialRef(r->layer);
	int beyond = 0, within = 0;
	OGR_L_ResetReading(r->layer);
	for (int i = 0; i < LOOKED_AT; i++) {
		OGRFeatureH feature = OGR_L_GetNextFeature(r->layer);
		OGRGeometryH geometry = feature ? OGR_F_GetGeometryRef(feature) : NULL;
		OGREnvelope box;
		if (!feature)
			break;
		if (geometry && !OGR_G_IsEmpty(geometry)) {
			OGR_G_GetEnvelope(geometry, &box);
			bool is_beyond = fabs(box.MinX) > 360 || fabs(box.MaxX) > 360 || fabs(box.MinY) > 90
				|| fabs(box.MaxY) > 90;
			beyond += is_beyond;
			within += !is_beyond;
			r->rows.has_z |= OGR_G_Is3D(geometry) != 0;
		}
		OGR_F_Destroy(feature);
	}
	OGR_L_ResetReading(r->layer);
	r->rows.degrees_doubted = crs && OSRIsGeographic(crs) && beyond > within;
}

/* ---- Columns ---- */

static enum eco_code take_columns(struct ogr_rows *r, struct eco_error *error)
{
	OGRFeatureDefnH definition = OGR_L_GetLayerDefn(r->layer);
	int count = OGR_FD_GetFieldCount(definition);
	if (count > (int)ECO_COLUMNS_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%.300s: %d columns, at most %u are possible", r->path,
			count, ECO_COLUMNS_MAX);
	r->rows.columns = eco_alloc((size_t)count + 1, sizeof *r->rows.columns);
	r->rows.fields = eco_alloc((size_t)count + 1, sizeof *r->rows.fields);
	for (int i = 0; i < count; i++)
		r->rows.columns[r->rows.column_count++] =
			eco_copy_text(OGR_Fld_GetNameRef(OGR_FD_GetFieldDefn(definition, i)));
	return ECO_OK;
}

/* ---- Rows ---- */

static void take_point(struct eco_rows_place *place, OGRGeometryH point)
{
	place->kind = ECO_PLACE_POINT;
	place->at[0] = OGR_G_GetX(point, 0);
	place->at[1] = OGR_G_GetY(point, 0);
	place->at[2] = OGR_G_Is3D(point) ? OGR_G_GetZ(point, 0) : NAN;
}

#define FOOT_SHARE 0.05              /* of a tree's height that counts as its foot */
#define FOOT_LEAST_M 0.01

/* Widens a box by the places up to a height. */
static void widen(OGREnvelope *box, OGRGeometryH geometry, double high)
{
	for (int i = 0; i < OGR_G_GetGeometryCount(geometry); i++)
		widen(box, OGR_G_GetGeometryRef(geometry, i), high);
	for (int i = 0; i < OGR_G_GetPointCount(geometry); i++) {
		double x = OGR_G_GetX(geometry, i), y = OGR_G_GetY(geometry, i);
		if (OGR_G_GetZ(geometry, i) <= high)
			*box = (OGREnvelope){ fmin(box->MinX, x), fmax(box->MaxX, x), fmin(box->MinY, y), fmax(box->MaxY, y) };
	}
}

/* The middle of a trunk's foot: that of the whole would follow a crown that leans over a street. */
static void take_foot(struct eco_rows_place *place, OGRGeometryH tree)
{
	OGREnvelope3D whole;
	OGREnvelope foot = { INFINITY, -INFINITY, INFINITY, -INFINITY };
	OGR_G_GetEnvelope3D(tree, &whole);
	widen(&foot, tree, whole.MinZ + fmax(FOOT_SHARE * (whole.MaxZ - whole.MinZ), FOOT_LEAST_M));
	*place = (struct eco_rows_place){ .kind = ECO_PLACE_POINT, .at = { (foot.MinX + foot.MaxX) / 2,
		(foot.MinY + foot.MaxY) / 2, OGR_G_Is3D(tree) ? whole.MinZ : NAN } };
}

/* Straight edges in two dimensions, as well-known binary. */
static enum eco_code take_area(struct ogr_rows *r, OGRGeometryH geometry, struct eco_error *error)
{
	OGRGeometryH straight = OGR_G_GetLinearGeometry(geometry, 0, NULL);
	enum eco_code code = ECO_OK;
	if (!straight)
		return gdal_says(r->path, ECO_BAD_INPUT, "a geometry cannot be read", error);
	OGR_G_FlattenTo2D(straight);
	size_t size = (size_t)OGR_G_WkbSize(straight);
	if (size > AREA_BYTES_MAX) {
		code = eco_fail(error, ECO_TOO_LARGE, "%.300s: a geometry of %zu bytes, at most %u are "
			"possible; simplify it", r->path, size, AREA_BYTES_MAX);
	} else if (size > r->wkb_capacity) {
		free(r->wkb);
		r->wkb_capacity = 2 * size;
		r->wkb = eco_alloc(r->wkb_capacity, 1);
	}
	if (code == ECO_OK && OGR_G_ExportToIsoWkb(straight, wkbNDR, r->wkb) != OGRERR_NONE)
		code = gdal_says(r->path, ECO_BAD_INPUT, "a geometry cannot be read", error);
	OGR_G_DestroyGeometry(straight);
	r->rows.place.kind = ECO_PLACE_AREA;
	r->rows.place.wkb = r->wkb;
	r->rows.place.wkb_bytes = (uint32_t)size;
	return code;
}

/* To the next point of a multipoint; false after its last. */
static bool next_point(struct ogr_rows *r)
{
	if (!r->points || ++r->point >= OGR_G_GetGeometryCount(r->points))
		return false;
	take_point(&r->rows.place, OGR_G_GetGeometryRef(r->points, r->point));
	return true;
}

static enum eco_code take_geometry(struct ogr_rows *r, struct eco_error *error)
{
	struct eco_rows_place *place = &r->rows.place;
	OGRGeometryH geometry = OGR_F_GetGeometryRef(r->feature);
	OGRwkbGeometryType type = geometry ? wkbFlatten(OGR_G_GetGeometryType(geometry)) : wkbUnknown;
	*place = (struct eco_rows_place){ .kind = r->rows.has_geometry ? ECO_PLACE_EMPTY : ECO_PLACE_NONE };
	r->points = NULL;
	if (!geometry || OGR_G_IsEmpty(geometry))
		return ECO_OK;
	if (r->areas)
		return take_area(r, geometry, error);
	if (type == wkbPoint) {
		take_point(place, geometry);
	} else if (type == wkbMultiPoint) {
		r->points = geometry;
		r->point = -1;
		next_point(r);
	} else if (r->trees) {
		take_foot(place, geometry);
	} else {
		place->kind = ECO_PLACE_OTHER;
		snprintf(place->what, sizeof place->what, "%.15s", OGRGeometryTypeToName(type));
	}
	return ECO_OK;
}

/* OGR formats every number into one buffer, which the next one overwrites: so numbers are copied. */
static void take_fields(struct ogr_rows *r)
{
	for (int i = 0; i < (int)r->rows.column_count; i++) {
		bool there = OGR_F_IsFieldSetAndNotNull(r->feature, i);
		const char *text = there ? OGR_F_GetFieldAsString(r->feature, i) : "";
		free(r->copies[i]);
		r->copies[i] = there && OGR_Fld_GetType(OGR_F_GetFieldDefnRef(r->feature, i)) != OFTString
			? eco_copy_text(text) : NULL;
		r->rows.fields[i] = r->copies[i] ? r->copies[i] : text;
	}
	r->rows.field_count = r->rows.column_count;
}

static enum eco_code next(struct eco_rows *rows, bool *more, struct eco_error *error)
{
	struct ogr_rows *r = (struct ogr_rows *)rows;
	*more = true;
	if (next_point(r)) {
		rows->row++;
		return ECO_OK;
	}
	if (r->feature)
		OGR_F_Destroy(r->feature);
	r->points = NULL;
	CPLErrorReset();
	r->feature = OGR_L_GetNextFeature(r->layer);
	if (!r->feature) {
		*more = false;
		/* a track is of use up to where its recorder stopped */
		if ((r->broken[0] && !r->partial) || CPLGetLastErrorType() >= CE_Failure)
			return cannot_read(r, CPLGetLastErrorMsg(), error);
		return rows->row == 0 && OGR_L_GetFeatureCount(r->layer, FALSE) > 0
			? cannot_read(r, "its rows are missing", error)
			: ECO_OK;
	}
	rows->row++;
	rows->line++;
	enum eco_code code = take_geometry(r, error);
	if (code)
		return code;
	take_fields(r);
	if (r->text_point.found)
		eco_rows_point_take(rows, &r->text_point);
	return ECO_OK;
}

/* Looks for a column with points in the first rows of a table without geometry, such as a spreadsheet. */
static void find_points(struct ogr_rows *r)
{
	bool found = r->rows.has_geometry;
	for (uint32_t i = 0; i < ECO_ROWS_POINT_LOOK && !found
			&& (r->feature = OGR_L_GetNextFeature(r->layer)); i++) {
		take_fields(r);
		found = eco_rows_point_find(&r->rows, &r->text_point);
		OGR_F_Destroy(r->feature);
	}
	r->feature = NULL;
	OGR_L_ResetReading(r->layer);
	if (r->text_point.found)
		eco_rows_point_state(&r->rows, &r->text_point);
}

static void close_ogr(struct eco_rows *rows)
{
	struct ogr_rows *r = (struct ogr_rows *)rows;
	if (r->feature)
		OGR_F_Destroy(r->feature);
	if (r->data)
		GDALClose(r->data);
	CPLPopErrorHandler();
	for (uint32_t i = 0; i < rows->column_count; i++)
		free(r->copies[i]);
	eco_rows_free_texts(rows);
	free(r->wkb);
	free(r->path);
	free(r);
}

static bool read_bytes(const char *path, void *bytes, size_t count)
{
	FILE *file = fopen(path, "rb");
	bool good = file && fread(bytes, 1, count, file) == count;
	if (file)
		fclose(file);
	return good;
}

/* A Shapefile says its length, in words of two bytes, and GDAL takes what is missing for rows without a
 * place. */
static enum eco_code check_shape(const struct ogr_rows *r, struct eco_error *error)
{
	unsigned char head[28];
	struct stat status;
	char why[80];
	size_t length = strlen(r->path);
	if (length < 4 || strcasecmp(r->path + length - 4, ".shp") != 0 ||
		!read_bytes(r->path, head, sizeof head) || stat(r->path, &status) != 0)
		return ECO_OK;
	uint64_t bytes = 2 *
		((uint64_t)head[24] << 24 | (uint64_t)head[25] << 16 | (uint64_t)head[26] << 8 | head[27]);
	snprintf(why, sizeof why, "it has %llu of its %llu bytes", (unsigned long long)status.st_size,
		(unsigned long long)bytes);
	return head[2] == 0x27 && head[3] == 0x0a && bytes > (uint64_t)status.st_size
		? cannot_read(r, why, error)
		: ECO_OK;
}

static enum eco_code open_data(struct ogr_rows *r, const struct eco_rows_source *source,
	struct eco_error *error)
{
	const char *options[] = { "AUTODETECT_TYPE=NO", NULL };

	quiet(r);
	CPLErrorReset();
	if (lacks_part(source->path, "shx"))
		return eco_fail(error, ECO_NOT_FOUND, "%.300s: a Shapefile is several files, and its .shx is "
			"not beside it; copy all of them (.shp, .shx, .dbf, .prj, .cpg)", r->path);
	if (lacks_part(source->path, "dbf"))
		eco_rows_note(&r->rows, "its .dbf is not beside it, so it has no columns");
	enum eco_code code = check_shape(r, error);
	if (code)
		return code;
	r->data = GDALOpenEx(source->path, GDAL_OF_VECTOR | GDAL_OF_READONLY, NULL, options, NULL);
	if (!r->data)
		return gdal_says(r->path, ECO_BAD_INPUT,
			source->partial
				? "GDAL cannot read it: it is damaged, or breaks off near its beginning"
				: "it cannot be read: it is damaged or breaks off, or is "
				  "no table of a known format (CSV, Excel .xlsx, OpenDocument, GeoJSON, GeoPackage, Shapefile, GML, KML, "
				  "FlatGeobuf, CityGML)",
			error);
	if (is_of(r, "ESRI Shapefile") && !lacks_part(source->path, "dbf") &&
		OGR_FD_GetFieldCount(OGR_L_GetLayerDefn(GDALDatasetGetLayer(r->data, 0))) == 0)
		return cannot_read(r, "its .dbf has no columns", error);
	return ECO_OK;
}

enum eco_code gdal_rows_open(struct eco_rows **rows, const struct eco_rows_source *source,
	struct eco_error *error)
{
	struct ogr_rows *r = eco_alloc(1, sizeof *r);
	_Static_assert(offsetof(struct ogr_rows, rows) == 0, "struct eco_rows is the start of struct "
		"ogr_rows");
	*rows = NULL;
	r->path = eco_copy_text(source->path);
	r->rows.next = next;
	r->rows.close = close_ogr;
	r->rows.where = "feature";
	r->areas = source->areas;
	r->partial = source->partial;
	enum eco_code code = open_data(r, source, error);
	if (!code)
		code = find_layer(r, source->layer, error);
	if (!code) {
		r->rows.has_geometry = OGR_FD_GetGeomFieldCount(OGR_L_GetLayerDefn(r->layer)) > 0
			&& OGR_L_GetGeomType(r->layer) != wkbNone;
		code = take_crs(r, error);
	}
	if (!code)
		code = take_columns(r, error);
	if (!code) {
		find_points(r);
		look_at_some(r);
		*rows = &r->rows;
	} else {
		close_ogr(&r->rows);
	}
	return code;
}
