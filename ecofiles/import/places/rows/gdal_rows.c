/* Tables with geometry, as OGR opens them: GeoJSON, GeoPackage, Shapefile, KML, GML, FlatGeobuf, ... Runs in
 * the child process of rows_child.c. Points are places; each point of a multipoint is a row of its own.
 * Surfaces and lines are handed over whole if areas are wanted, else by their type's name. Longer than 600
 * lines: what one reader does for a dozen formats shares its struct. */
#include "ecofiles/import/places/rows/rows.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
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
#include "ecofiles/import/places/crs.h"
#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/import/places/table_columns.h"

#define LOOKED_AT 64                 /* features looked at to judge the coordinates */
#define AREA_BYTES_MAX (1u << 28)
#define HTML_MOST 256                /* columns of a table in a field */

struct ogr_rows {
	struct eco_rows rows;
	GDALDatasetH data;
	OGRLayerH layer;
	OGRFeatureH feature;
	OGRGeometryH points;         /* a multipoint of the feature, owned by it; NULL: none */
	int point;
	bool areas, partial;
	bool crowns;                 /* polygons are plants */
	double metre_per_unit;       /* of the CRS; 0: degrees */
	bool trees;                  /* of a city model */
	bool sheet;                  /* of a workbook: no geometry, perhaps titles above the names */
	int passed, titles;          /* passed: rows read; titles: rows above the first row of data, that of the names among them */
	uint32_t html_columns;       /* the last columns, from tables in that field */
	int html;                    /* the field that holds a table of HTML or attributes, -1: none */
	double unit_m;               /* of a plan's drawing */
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
	CPLSetConfigOption("DXF_INLINE_BLOCKS", "FALSE");    /* a plan's trees are inserted blocks */
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
	return eco_fail(error, ECO_BAD_INPUT, "%.150s: it has several layers; name one, with --layer or, in a "
		"scene, \"layer\": %s", r->path, names);
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

static bool is_of(const struct ogr_rows *r, const char *format)
{
	GDALDriverH driver = GDALGetDatasetDriver(r->data);
	return driver && strcmp(GDALGetDriverShortName(driver), format) == 0;
}

/* ---- Extracts of OpenStreetMap ---- */

/* Each tag that is asked for is a column, as it is written there. */
static const char osm_tags[] = "attribute_name_laundering=no\n"
	"closed_ways_are_polygons=aeroway,amenity,boundary,building,craft,geological,historic,landuse,leisure,military,natural,"
	"office,place,shop,sport,tourism,highway=platform,public_transport=platform,golf,water,man_made\n"
	"[points]\nosm_id=yes\nattributes=natural,species,genus,taxon,leaf_type,height,circumference,diameter,diameter_crown,"
	"start_date\n"
	"[lines]\nosm_id=yes\nattributes=highway,waterway,railway,aeroway,natural,surface,width,tunnel,covered,location\n"
	"[multipolygons]\nosm_id=yes\nattributes=building,height,building:levels,roof:shape,landuse,natural,leisure,amenity,"
	"highway,place,man_made,waterway,golf,landcover,railway,aeroway,location,tunnel,leaf_type\n"
	"[multilinestrings]\nosm_id=yes\n[other_relations]\nosm_id=yes\n";
#define OSM_FILE "/vsimem/osm.ini"

/* Its polygons, or its single trees; reading one layer alone, as the others would wait in memory. */
static enum eco_code find_osm(struct ogr_rows *r, const char *wanted, struct eco_error *error)
{
	const char *name = wanted ? wanted : r->areas ? "multipolygons" : "points";
	char only[100];
	r->layer = GDALDatasetGetLayerByName(r->data, name);
	if (!r->layer)
		return ask_for_layer(r, wanted, error);
	snprintf(only, sizeof only, "SET interest_layers = %.40s", name);
	GDALDatasetExecuteSQL(r->data, only, NULL, NULL);
	if (!r->areas && strcmp(name, "points") == 0)
		OGR_L_SetAttributeFilter(r->layer, "\"natural\" = 'tree'");
	return ECO_OK;
}

/* ---- Titles above the names of a workbook ---- */

#define TITLES_MOST 20               /* rows above the names */
#define NAMES_LEAST 3                /* columns that have names */

static bool is_name(OGRFeatureH row, int field)
{
	const char *text = OGR_F_IsFieldSetAndNotNull(row, field) ? OGR_F_GetFieldAsString(row, field) : "";
	double number;
	return text[strspn(text, " ")] != 0 && !eco_text_number(text, '.', &number);
}

/* A column's name says: 1 and 2 the axes of a place, 4 species. */
static int said_by(const char *name)
{
	return (eco_column_points(ECO_ROLE_X, name) >= ECO_COLUMN_ENOUGH) | (eco_column_points(ECO_ROLE_Y, name) >= ECO_COLUMN_ENOUGH) << 1
		| (eco_column_points(ECO_ROLE_SPECIES, name) >= ECO_COLUMN_ENOUGH) << 2;
}

/* A row's texts as names of columns: as said_by, if both axes of a place are among them; else 0. */
static int are_names(OGRFeatureH row, int count)
{
	int names = 0, says = 0;
	for (int i = 0; i < count; i++) {
		const char *text = is_name(row, i) ? OGR_F_GetFieldAsString(row, i) : "";
		names += *text != 0;
		says |= said_by(text);
	}
	return names >= NAMES_LEAST && (says & 3) == 3 ? says : 0;
}

/* The number of rows up to that of the names; 0: the names stand above all. *row: NULL, or gets that row;
 * *says: NULL, or what they say. */
static int find_names(struct ogr_rows *r, OGRFeatureH *row, int *says)
{
	int count = OGR_FD_GetFieldCount(OGR_L_GetLayerDefn(r->layer)), found = 0;
	OGR_L_ResetReading(r->layer);
	for (int i = 0; i < TITLES_MOST && !found; i++) {
		OGRFeatureH feature = OGR_L_GetNextFeature(r->layer);
		if (!feature)
			break;
		int own = are_names(feature, count);
		found = own ? i + 1 : 0;
		if (found && says)
			*says = own;
		if (found && row)
			*row = feature;
		else
			OGR_F_Destroy(feature);
	}
	OGR_L_ResetReading(r->layer);
	return found;
}

/* The names of a layer's columns together, as said_by; 0: no place. */
static int says_place(OGRLayerH layer)
{
	OGRFeatureDefnH definition = OGR_L_GetLayerDefn(layer);
	int says = 0;
	for (int i = 0; i < OGR_FD_GetFieldCount(definition); i++)
		says |= said_by(OGR_Fld_GetNameRef(OGR_FD_GetFieldDefn(definition, i)));
	return (says & 3) == 3 ? says : 0;
}

/* The only layer whose columns say a place, best one with species, of layers without geometry, such as a
 * workbook's sheets; -1: none, or several. */
static int find_sheet(struct ogr_rows *r)
{
	int found = -1, best = 0, alike = 0;
	for (int i = 0; i < GDALDatasetGetLayerCount(r->data); i++) {
		r->layer = GDALDatasetGetLayer(r->data, i);
		if (OGR_L_GetGeomType(r->layer) != wkbNone)
			return -1;
		int says = says_place(r->layer);
		if (!says)
			find_names(r, NULL, &says);
		alike = says > best ? 1 : alike + (says > 0 && says == best);
		found = says > best ? i : found;
		best = says > best ? says : best;
	}
	return alike == 1 ? found : -1;
}

static enum eco_code take_sheet(struct ogr_rows *r, int sheet)
{
	r->layer = GDALDatasetGetLayer(r->data, sheet);
	eco_rows_note(&r->rows, "it has several sheets; \"%.60s\" is taken, the only one whose columns say places of plants; "
		"\"layer\" names another", OGR_L_GetName(r->layer));
	return ECO_OK;
}

/* The type of a layer's geometries, where it says none that of its first. */
static OGRwkbGeometryType type_of(OGRLayerH layer)
{
	OGRwkbGeometryType type = OGR_L_GetGeomType(layer);
	OGRFeatureH feature = wkbFlatten(type) == wkbUnknown ? OGR_L_GetNextFeature(layer) : NULL;
	if (feature && OGR_F_GetGeometryRef(feature))
		type = OGR_G_GetGeometryType(OGR_F_GetGeometryRef(feature));
	if (feature)
		OGR_F_Destroy(feature);
	OGR_L_ResetReading(layer);
	return type;
}

/* Chooses the layer asked for, or the only one, or the only one with rows whose geometries fit. */
static enum eco_code find_layer(struct ogr_rows *r, const char *wanted, struct eco_error *error)
{
	int count = GDALDatasetGetLayerCount(r->data), fitting = 0, unknown = 0, found = 0;
	if (count == 0)
		return cannot_read(r, "it has no layer", error);
	if (is_of(r, "OSM"))
		return find_osm(r, wanted, error);
	if (wanted) {
		r->layer = GDALDatasetGetLayerByName(r->data, wanted);
		return r->layer ? ECO_OK : ask_for_layer(r, wanted, error);
	}
	if (find_trees(r))
		return ECO_OK;
	int sheet = count > 1 && !r->areas ? find_sheet(r) : -1;
	if (sheet >= 0)
		return take_sheet(r, sheet);
	for (int i = 0; i < count; i++) {
		OGRLayerH layer = GDALDatasetGetLayer(r->data, i);
		OGRwkbGeometryType type = count > 1 ? type_of(layer) : OGR_L_GetGeomType(layer);
		/* a GPX has five layers, a plan its blocks' drawings beside what it shows */
		if (count > 1 && (OGR_L_GetFeatureCount(layer, TRUE) == 0
				|| (is_of(r, "DXF") && strcmp(OGR_L_GetName(layer), "entities") != 0)
				|| (is_of(r, "GPX") && strcmp(OGR_L_GetName(layer), "track_points") == 0)))
			continue;
		bool fits = r->areas ? is_surface(type) : is_point(type) || (r->crowns && is_surface(type)) || is_of(r, "DXF");
		unknown += wkbFlatten(type) == wkbUnknown && !is_of(r, "DXF");
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
	r->metre_per_unit = !crs ? 1 : OSRIsGeographic(crs) ? 0 : OSRGetLinearUnits(crs, NULL);
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

/* The unit of a plan's drawing, where its head says it: $INSUNITS. */
static void take_unit(struct ogr_rows *r)
{
	static const double metres[] = { 1, 0.0254, 0.3048, 1609.344, 0.001, 0.01, 1, 1000 };
	size_t size;
	char *head = is_of(r, "DXF") ? eco_file_read_head(r->path, &size) : NULL, *at = head ? strstr(head, "$INSUNITS") : NULL;
	int group = 0, unit = 0;
	r->unit_m = 1;
	if (at && sscanf(at + 9, "%d %d", &group, &unit) == 2 && unit > 0 && unit < (int)(sizeof metres / sizeof *metres))
		r->unit_m = metres[unit];
	if (r->unit_m != 1)
		eco_rows_note(&r->rows, "its drawing is in units of %g m, by its $INSUNITS", r->unit_m);
	free(head);
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

/* ---- Pairs of names and values in a field: a table of HTML in a KML's description, attributes of a plan's block ---- */

static bool is_markup(const struct ogr_rows *r)
{
	return is_of(r, "KML") || is_of(r, "LIBKML") || is_of(r, "GPX") || is_of(r, "GeoJSON");
}

/* A text of HTML as lines, a tab between cells, without tags; other texts as they are. The caller frees it. */
static char *lines_of(const char *html)
{
	static const char *const breaks[] = { "br", "/br", "tr", "/tr", "table", "/table", "li", "/li", "p", "/p", "div", "/div", "dt", "dl" };
	char *text = eco_alloc(strlen(html) + 1, 1), *to = text;
	bool tags = strchr(html, '<') != NULL;
	for (const char *at = html; *at != 0; at++) {
		if (*at == '<') {
			size_t bytes = strcspn(at + 1, " />\t\r\n"), whole = at[1] == '/' ? 1 + strcspn(at + 2, " >") : bytes;
			bool cell = whole == 2 && (strncasecmp(at + 1, "td", 2) == 0 || strncasecmp(at + 1, "th", 2) == 0 || strncasecmp(at + 1, "dd", 2) == 0);
			for (size_t i = 0; !cell && i < sizeof breaks / sizeof *breaks; i++)
				if (strlen(breaks[i]) == whole && strncasecmp(at + 1, breaks[i], whole) == 0) {
					*to++ = '\n';
					break;
				}
			if (cell)
				*to++ = '\t';
			at += strcspn(at, ">");
			if (*at == 0)
				break;
		} else if (strncmp(at, "&nbsp;", 6) == 0) {
			*to++ = ' ';
			at += 5;
		} else if (!(tags && (*at == '\n' || *at == '\t')))
			*to++ = *at == '\r' ? ' ' : *at;
	}
	return text;
}

/* Cuts spaces, and a colon at the end. */
static char *trimmed(char *text)
{
	text += strspn(text, " \t");
	size_t length = strlen(text);
	while (length > 0 && strchr(" \t:=", text[length - 1]))
		text[--length] = 0;
	return text;
}

#define PAIR_NAME_BYTES 60           /* longer ones are sentences */

typedef void take_pair(struct ogr_rows *r, const char *name, const char *value);

/* Attributes are "SPECIES Pinus nigra". */
static void each_attribute(struct ogr_rows *r, OGRFeatureH feature, int field, take_pair *take)
{
	char **list = OGR_F_GetFieldAsStringList(feature, field);
	for (; list && *list; list++) {
		char *name = eco_copy_text(*list), *value = strchr(name, ' ');
		if (value) {
			*value = 0;
			take(r, name, value + 1);
		}
		free(name);
	}
}

/* Calls `take`, if it is not NULL, with each name and value of a line: two cells, "height: 12", "height =
 * 12". Returns how many there are. */
static unsigned each_pair(struct ogr_rows *r, OGRFeatureH feature, int field, take_pair *take)
{
	unsigned count = 0;
	if (is_of(r, "DXF")) {
		each_attribute(r, feature, field, take);
		return 1;
	}
	char *text = lines_of(OGR_F_GetFieldAsString(feature, field)), *rest = text, *line;
	while ((line = strsep(&rest, "\n"))) {
		line += strspn(line, " \t");
		char *value = line + strcspn(line, "\t");
		value = *value ? value : line + strcspn(line, ":=");
		if (*value == 0 || value - line > PAIR_NAME_BYTES || strchr(trimmed(value + 1), '\t'))
			continue;
		*value = 0;
		line = trimmed(line);
		value = trimmed(value + 1);
		if (*line == 0 || *value == 0)
			continue;
		if (take)
			take(r, line, value);
		count++;
	}
	free(text);
	return count;
}

static uint32_t column_named(const struct ogr_rows *r, const char *name, uint32_t from)
{
	uint32_t i = from;
	while (i < r->rows.column_count && strcmp(r->rows.columns[i], name) != 0)
		i++;
	return i;
}

static void add_column(struct ogr_rows *r, const char *name, const char *value)
{
	(void)value;
	if (r->html_columns < HTML_MOST && column_named(r, name, 0) == r->rows.column_count) {
		r->rows.columns[r->rows.column_count++] = eco_copy_text(name);
		r->html_columns++;
	}
}

static void set_field(struct ogr_rows *r, const char *name, const char *value)
{
	uint32_t i = column_named(r, name, r->rows.column_count - r->html_columns);
	if (i == r->rows.column_count)
		return;
	free(r->copies[i]);
	r->rows.fields[i] = r->copies[i] = eco_copy_text(value);
}

/* Columns of the tables in the first rows. */
static void find_html(struct ogr_rows *r, int count)
{
	r->html = -1;
	OGR_L_ResetReading(r->layer);
	for (int k = 0; k < LOOKED_AT && (is_markup(r) || is_of(r, "DXF")); k++) {
		OGRFeatureH feature = OGR_L_GetNextFeature(r->layer);
		for (int i = 0; feature && i < count; i++) {
			const char *text = OGR_F_GetFieldAsString(feature, i);
			bool pairs = is_of(r, "DXF") ? strcmp(r->rows.columns[i], "BlockAttributes") == 0
				: strcasestr(text, "<td") || each_pair(r, feature, i, NULL) > 1;
			if (!pairs || (r->html >= 0 && r->html != i))
				continue;
			r->html = i;
			each_pair(r, feature, i, add_column);
		}
		if (!feature)
			break;
		OGR_F_Destroy(feature);
	}
	OGR_L_ResetReading(r->layer);
	if (r->html_columns > 0)
		eco_rows_note(&r->rows, "\"%.60s\" holds a table: its %u rows are columns",
			r->rows.columns[r->html], r->html_columns);
}

/* ---- Columns ---- */

/* The names of columns, in a workbook those below its titles. */
static void name_columns(struct ogr_rows *r, int count)
{
	OGRFeatureDefnH definition = OGR_L_GetLayerDefn(r->layer);
	OGRFeatureH row = NULL;
	r->sheet = OGR_L_GetGeomType(r->layer) == wkbNone && (is_of(r, "XLSX") || is_of(r, "ODS"));
	r->titles = r->sheet && !says_place(r->layer) ? find_names(r, &row, NULL) : 0;
	for (int i = 0; i < count; i++) {
		const char *own = OGR_Fld_GetNameRef(OGR_FD_GetFieldDefn(definition, i));
		if (is_of(r, "DXF"))             /* the turn and the scale of an inserted block */
			own = strcmp(own, "BlockAngle") == 0 ? "yaw_deg" : strcmp(own, "BlockScale") == 0 ? "scale" : own;
		r->rows.columns[r->rows.column_count++] = eco_copy_text(row && is_name(row, i)
			? OGR_F_GetFieldAsString(row, i) : own);
	}
	if (row)
		OGR_F_Destroy(row);
	if (r->titles)
		eco_rows_note(&r->rows, "%d row%s of titles above the names of columns %s skipped", r->titles,
			r->titles == 1 ? "" : "s", r->titles == 1 ? "is" : "are");
}

static enum eco_code take_columns(struct ogr_rows *r, struct eco_error *error)
{
	int count = OGR_FD_GetFieldCount(OGR_L_GetLayerDefn(r->layer));
	if (count + HTML_MOST > (int)ECO_COLUMNS_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "%.300s: %d columns, at most %u are possible", r->path,
			count, ECO_COLUMNS_MAX - HTML_MOST);
	r->rows.columns = eco_alloc((size_t)count + HTML_MOST + 1, sizeof *r->rows.columns);
	r->rows.fields = eco_alloc((size_t)count + HTML_MOST + 1, sizeof *r->rows.fields);
	name_columns(r, count);
	find_html(r, count);
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

/* The middle of a crown and the width of the disc of its area. */
static void take_crown(const struct ogr_rows *r, struct eco_rows_place *place, OGRGeometryH crown)
{
	OGRGeometryH middle = OGR_G_CreateGeometry(wkbPoint);
	if (OGR_G_Centroid(crown, middle) == OGRERR_NONE && !OGR_G_IsEmpty(middle)) {
		take_point(place, middle);
		place->at[2] = NAN;
		double metre = r->metre_per_unit > 0 ? r->metre_per_unit : ECO_DEGREE_M,
		       across = r->metre_per_unit > 0 ? metre : eco_degree_m(place->at[1]);
		place->width = 2 * sqrt(fabs(OGR_G_Area(crown)) * metre * across / M_PI);
	}
	OGR_G_DestroyGeometry(middle);
}

/* To metres, with all its parts. */
static void scale(OGRGeometryH geometry, double by)
{
	for (int i = 0; i < OGR_G_GetGeometryCount(geometry); i++)
		scale(OGR_G_GetGeometryRef(geometry, i), by);
	for (int i = 0; i < OGR_G_GetPointCount(geometry); i++)
		OGR_G_SetPoint(geometry, i, by * OGR_G_GetX(geometry, i), by * OGR_G_GetY(geometry, i), by * OGR_G_GetZ(geometry, i));
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
	if (r->unit_m != 1)
		scale(geometry, r->unit_m);
	if (r->areas)
		return take_area(r, geometry, error);
	int text = is_of(r, "DXF") ? OGR_F_GetFieldIndex(r->feature, "Text") : -1;
	if (text >= 0 && *OGR_F_GetFieldAsString(r->feature, text)) {
		place->kind = ECO_PLACE_OTHER;       /* a plan's lettering */
		strcpy(place->what, "text");
	} else if (type == wkbPoint) {
		take_point(place, geometry);
	} else if (type == wkbMultiPoint) {
		r->points = geometry;
		r->point = -1;
		next_point(r);
	} else if (r->trees) {
		take_foot(place, geometry);
	} else if (r->crowns && is_surface(type)) {
		take_crown(r, place, geometry);
	} else {
		place->kind = ECO_PLACE_OTHER;
		snprintf(place->what, sizeof place->what, "%.15s", OGRGeometryTypeToName(type));
	}
	return ECO_OK;
}

/* The first number of a list, "(3:2,2,2)". */
static const char *first_of_list(const char *text)
{
	char *start = strchr(text, ':') + 1;
	start[strcspn(start, ",)")] = 0;
	return start;
}

/* OGR formats every number into one buffer, which the next one overwrites: so numbers are copied. */
static void take_fields(struct ogr_rows *r)
{
	const uint32_t own = r->rows.column_count - r->html_columns;
	for (int i = 0; i < (int)own; i++) {
		bool there = OGR_F_IsFieldSetAndNotNull(r->feature, i);
		const char *text = there ? OGR_F_GetFieldAsString(r->feature, i) : "";
		if (there && is_of(r, "DXF") && strcmp(r->rows.columns[i], "scale") == 0 && strchr(text, ':'))
			text = first_of_list(text);
		free(r->copies[i]);
		r->copies[i] = there && OGR_Fld_GetType(OGR_F_GetFieldDefnRef(r->feature, i)) != OFTString
			? eco_copy_text(text) : NULL;
		r->rows.fields[i] = r->copies[i] ? r->copies[i] : text;
	}
	for (uint32_t i = own; i < r->rows.column_count; i++)
		r->rows.fields[i] = "";
	if (r->html >= 0 && own < r->rows.column_count)
		each_pair(r, r->feature, r->html, set_field);
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
	r->points = NULL;
	CPLErrorReset();
	do {
		if (r->feature)
			OGR_F_Destroy(r->feature);
		r->feature = OGR_L_GetNextFeature(r->layer);
	} while (r->feature && r->passed++ < r->titles);
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
	ECO_PASS(take_geometry(r, error));
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
	r->passed = 0;
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
	eco_free(r->wkb, r->path, r);
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
	const char *options[] = { "AUTODETECT_TYPE=NO", "CONFIG_FILE=" OSM_FILE, "MAX_TMPFILE_SIZE=4096", NULL };

	quiet(r);
	CPLErrorReset();
	if (lacks_part(source->path, "shx"))
		return eco_fail(error, ECO_NOT_FOUND, "%.300s: a Shapefile is several files, and its .shx is "
			"not beside it; copy all of them (.shp, .shx, .dbf, .prj, .cpg)", r->path);
	if (lacks_part(source->path, "dbf"))
		eco_rows_note(&r->rows, "its .dbf is not beside it, so it has no columns");
	ECO_PASS(check_shape(r, error));
	VSIFCloseL(VSIFileFromMemBuffer(OSM_FILE, (GByte *)(uintptr_t)osm_tags, sizeof osm_tags - 1, FALSE));
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
	r->crowns = source->crowns;
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
		take_unit(r);
		look_at_some(r);
		*rows = &r->rows;
	} else {
		close_ogr(&r->rows);
	}
	return code;
}
