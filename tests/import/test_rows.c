/* Tables in every format that is read, row by row, and files that are none. Those that only OGR can write are
 * made with it here. Longer than 600 lines: a test a format, with the same helpers. */
#include <cpl_error.h>
#include <gdal.h>
#include <math.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>
#include <stdlib.h>

#include "ecofiles/import/places/rows/rows.h"
#include "tests/support/cases.h"
#include "tests/support/input_files.h"
#include "tests/support/unit_test.h"

/* "columns / row / row ...", a row as "place fields", places as (x y) or (x y z), none, empty or what they
 * are; ends with the error's text if there was one. Closes the rows. */
static const char *rows_text_of(struct eco_rows *rows, char *text, size_t size)
{
	struct eco_error error = { .code = ECO_OK };
	bool more = true;
	size_t used = 0;
#define ROWS_PUT(...) (used += used < size ? (size_t)snprintf(text + used, size - used, __VA_ARGS__) : 0)
	*text = 0;
	for (uint32_t i = 0; i < rows->column_count; i++)
		ROWS_PUT("%s%s", i > 0 ? "," : "", rows->columns[i]);
	while (rows->next(rows, &more, &error) == ECO_OK && more) {
		const struct eco_rows_place *place = &rows->place;
		ROWS_PUT(" /");
		if (place->kind == ECO_PLACE_POINT && place->width > 0)
			ROWS_PUT(" (%.9g %.9g, %.3g m wide)", place->at[0], place->at[1], place->width);
		else if (place->kind == ECO_PLACE_POINT && !isnan(place->at[2]))
			ROWS_PUT(" (%.9g %.9g %.9g)", place->at[0], place->at[1], place->at[2]);
		else if (place->kind == ECO_PLACE_POINT)
			ROWS_PUT(" (%.9g %.9g)", place->at[0], place->at[1]);
		else if (place->kind != ECO_PLACE_NONE)
			ROWS_PUT(" %s", place->kind == ECO_PLACE_EMPTY ? "empty" : place->what);
		for (uint32_t i = 0; i < rows->field_count; i++)
			ROWS_PUT("%s%s", i > 0 ? "," : " ", rows->fields[i]);
	}
	if (error.code != ECO_OK)
		ROWS_PUT(" ! %s", error.text);
#undef ROWS_PUT
	eco_rows_close(rows);
	return text;
}

static struct eco_rows *open_good(const struct eco_rows_source *source)
{
	struct eco_rows *rows;
	assert_good(eco_rows_open_here(&rows, source, &cause));
	return rows;
}

/* Its rows; it has a note that says this (NULL: none), and this CRS (NULL: none). */
static void expect_source(const struct eco_rows_source *source, const char *wanted, const char *note,
	const char *crs)
{
	struct eco_rows *rows = open_good(source);
	char got[4000];
	if ((rows->note_count > 0) != (note != NULL) || (note != NULL && !strstr(rows->notes[0], note)))
		fail_msg("%s: %u notes, the first: %s", source->path, rows->note_count, rows->note_count > 0
			? rows->notes[0] : "none");
	assert_string_equal(rows->crs ? rows->crs : "", crs ? crs : "");
	assert_string_equal(rows_text_of(rows, got, sizeof got), wanted);
}

static void expect(const char *name, const char *text, const char *wanted, const char *note, const char *crs)
{
	expect_source(&(struct eco_rows_source){ .path = input_text("rows", name, text) }, wanted, note, crs);
}

static void expect_error(const char *path, const char *layer, const char *says)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_rows_source source = { .path = path, .layer = layer };
	struct eco_rows *rows;
	if (eco_rows_open_here(&rows, &source, &error) == ECO_OK)
		fail_msg("%s is read", path);
	assert_null(rows);
	if (!strstr(error.text, says))
		fail_msg("%s\n  wanted ... %s", error.text, says);
	if (getenv("ECO_SHOW"))
		print_message("%s\n", error.text);
}

/* ---- Files and their rows ---- */

#define FEATURE(geometry, \
	properties) "{\"type\":\"Feature\",\"geometry\":" geometry ",\"properties\":{" properties "}}"
#define POINT(coordinates) "{\"type\":\"Point\",\"coordinates\":[" coordinates "]}"
#define COLLECTION(crs, features) "{\"type\":\"FeatureCollection\"," crs "\"features\":[" features "]}"

#define GML(crs, at) "<?xml version=\"1.0\"?><ogr:FeatureCollection xmlns:ogr=\"http://ogr.maptools.org/\" " \
	"xmlns:gml=\"http://www.opengis.net/gml/3.2\"><ogr:featureMember><ogr:boom gml:id=\"b1\"><ogr:geometry>" \
	"<gml:Point srsName=\"" crs "\"><gml:pos>" at "</gml:pos></gml:Point></ogr:geometry>" \
	"<ogr:soort>Tilia</ogr:soort></ogr:boom></ogr:featureMember></ogr:FeatureCollection>"

struct rows_case { const char *name, *file, *text, *wanted, *note, *crs; };

UNIT_TEST(files_become_rows)
{
	uint32_t count;
	const struct rows_case *cases = cases_read("tests/import/cases/rows.tsv", sizeof *cases, &count);
	for (uint32_t i = 0; i < count; i++)
		expect(cases[i].file, cases[i].text, cases[i].wanted, cases[i].note, cases[i].crs);
}

/* ---- CSV ---- */

UNIT_TEST(quotes_line_breaks_marks_and_endings_are_read)
{
	static const char csv[] = "\xef\xbb\xbfname, x ,\"y\"\r\n\"a, \"\"b\"\"\nsecond line\", 1 ,2\r\n\r\n"
		"plain\"quote,3,\"4\"\n,-5.5e1,6.25";
	struct eco_rows *rows;
	bool more;

	assert_good(eco_rows_open_csv(&rows, input_text("rows", "quotes.csv", csv), ',', &cause));
	assert_int_equal(rows->column_count, 3);
	assert_string_equal(rows->columns[0], "name");
	assert_string_equal(rows->columns[1], "x");
	assert_string_equal(rows->columns[2], "y");
	assert_good(rows->next(rows, &more, &cause));
	assert_string_equal(rows->fields[0], "a, \"b\"\nsecond line");
	assert_string_equal(rows->fields[2], "2");
	assert_int_equal(rows->line, 2);
	assert_good(rows->next(rows, &more, &cause));
	assert_string_equal(rows->fields[0], "plain\"quote");
	assert_int_equal(rows->line, 5);
	assert_good(rows->next(rows, &more, &cause));
	assert_string_equal(rows->fields[0], "");
	assert_int_equal(rows->row, 3);
	assert_good(rows->next(rows, &more, &cause));
	assert_false(more);
	eco_rows_close(rows);
}

UNIT_TEST(titles_before_the_names_are_passed_over)
{
	static const char *const titles[] = { "Trees of a town, 2024\n", "Trees\n\n\"exported\n2024\"\n",
		"Trees;;;\n;;;\n" };
	static const char *const lines[] = { "", "line 5", "line 3" };
	for (size_t i = 0; i < sizeof titles / sizeof *titles; i++) {
		char text[200];
		snprintf(text, sizeof text, "%sspecies;x;y\noak;1;2\n", titles[i]);
		struct eco_rows_source source = { .path = input_text("rows", "titles.csv", text) };
		struct eco_rows *rows = open_good(&source);
		bool more;
		bool comma = i == 0;     /* two fields are no title */
		assert_string_equal(rows->columns[0], comma ? "Trees of a town" : "species");
		assert_good(rows->next(rows, &more, &cause));
		if (!comma) {
			assert_non_null(strstr(rows->notes[0], lines[i]));
			assert_int_equal(rows->line, atoi(lines[i] + 5) + 1);
			assert_string_equal(rows->fields[2], "2");
		}
		eco_rows_close(rows);
	}
}

UNIT_TEST(files_that_are_no_csv_are_refused_with_a_line)
{
	static const struct { const char *bytes; size_t size; const char *says; } inputs[] = {
		{ "", 0, "empty file" }, { "x,y\n1,\"2", 8, ":2: a quoted field" },
			{ "x\0,\0y\0\n\0", 8, ":1: a zero byte" },
	};

	for (size_t i = 0; i < sizeof inputs / sizeof *inputs; i++) {
		struct eco_error error = { .code = ECO_OK };
		struct eco_rows *rows;
		bool more = true;
		enum eco_code code =
			eco_rows_open_csv(&rows,
			input_bytes("rows", "bad.csv", inputs[i].bytes, inputs[i].size), ',', &error);
		while (code == ECO_OK && more)
			code = rows->next(rows, &more, &error);
		assert_int_not_equal(code, ECO_OK);
		assert_non_null(strstr(error.text, inputs[i].says));
		eco_rows_close(rows);
	}
}

UNIT_TEST(a_row_without_end_is_bounded)
{
	size_t size = ECO_ROW_BYTES_MAX + 100;
	char *bytes = malloc(size);
	struct eco_rows *rows;
	memset(bytes, 'a', size);
	assert_code(eco_rows_open_csv(&rows, input_bytes("rows", "long.csv", bytes, size), ',', &cause),
		ECO_TOO_LARGE, "");
	memset(bytes, ',', size);
	assert_code(eco_rows_open_csv(&rows, input_bytes("rows", "long.csv", bytes, size), ',', &cause),
		ECO_TOO_LARGE, "");
	free(bytes);
}

/* ---- Which reader ---- */

UNIT_TEST(a_file_that_is_no_table_is_refused_with_what_to_do)
{
	expect_error(input_bytes("rows", "utf16.csv", "\xff\xfex\0,\0y\0\n\0", 10), NULL,
		"UTF-16; save it as UTF-8");
	expect_error(input_bytes("rows", "unmarked.csv", "x\0,\0y\0\n\0", 8), NULL,
		"UTF-16; save it as UTF-8");
	expect_error(input_text("rows", "city.json", "{\"type\":\"CityJSON\",\"version\":\"1.1\"}"), NULL,
		"CityJSON is not read; convert it");
	expect_error(input_text("rows", "features.jsonl", "{\"type\":\"CityJSONFeature\"}"), NULL,
		"CityJSON is not read; convert it");
	expect_error("build/tmp", NULL, "it is a folder");
	expect_error("build/tmp/rows/gone.csv", NULL, "No such file");
	expect_error("/dev/null", NULL, "it is not a file");
	expect_error(input_bytes("rows", "empty.geojson", "", 0), NULL, "the file is empty");
	expect_error(input_bytes("rows", "picture.png", "\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16), NULL,
		"cannot be read: it is damaged or breaks off, or is no table of a known format");
	expect_error(input_text("rows", "page.csv", "<!DOCTYPE html><html><body>404</body></html>"), NULL,
		"web page");
	expect_error(input_text("rows", "pointer.csv", "version https://git-lfs.github.com/spec/v1\noid "
		"sha256:0\nsize 1\n"), NULL, "git lfs pull");
	expect_error(input_bytes("rows", "trees.csv.gz", "\x1f\x8b\x08\0\0\0\0\0\0\3", 10), NULL, "packed");
	expect_error(input_bytes("rows", "book.csv", "PK\3\4\x14\0\0\0\0\0[Content_Types].xml", 29), NULL,
		"an Excel workbook; give it its name .xlsx");
	expect_error(input_bytes("rows", "old.xls", "\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1\0\0", 10), NULL,
		"an old Excel");
	expect_error(input_text("rows", "scene.gltf", "{\"asset\":{}}"), NULL,
		"glTF is a model, not a table");
	expect_error(input_text("rows", "a.shx", "x"), NULL, "name the one that ends in .shp");
	expect_error(input_bytes("rows", "trees.zip", "PK\3\4\x14\0\0\0\0\0trees.shp", 19), NULL, "packed");
	expect_error(input_text("rows", "topo.json", "{\"type\":\"Topology\",\"objects\":{}}"), NULL,
		"topo.json");
	expect_error(input_text("rows", "cut.geojson", "{\"type\":\"FeatureCollection\","
		"\"features\":[{\"type\":\"Feature\","), NULL, "cut.geojson");
	expect_error(input_text("rows", "records.json", "[{\"x\":1,\"y\":2}]"), NULL,
		"JSON, but not GeoJSON");
}

/* ---- GeoJSON ---- */

UNIT_TEST(numbers_that_cannot_be_degrees_are_doubted)
{
	struct eco_rows_source source = { .path = input_text("rows", "metres.geojson",
		COLLECTION("", FEATURE(POINT("690000,5335000"), ""))) };
	struct eco_rows *rows = open_good(&source);
	assert_true(rows->degrees_doubted);
	eco_rows_close(rows);
}

/* ---- Others of OGR ---- */

struct made { const char *layer; int epsg; OGRwkbGeometryType type; const char *wkt, *species; };

static void make_file(const char *driver, const char *path, const struct made *layers, size_t count)
{
	GDALDatasetH data;
	GDALAllRegister();
	CPLPushErrorHandler(CPLQuietErrorHandler);
	GDALDeleteDataset(GDALGetDriverByName(driver), path);
	data = GDALCreate(GDALGetDriverByName(driver), path, 0, 0, 0, GDT_Unknown, NULL);
	assert_non_null(data);
	for (size_t i = 0; i < count; i++) {
		OGRSpatialReferenceH crs = layers[i].epsg != 0 ? OSRNewSpatialReference(NULL) : NULL;
		OGRFieldDefnH field = OGR_Fld_Create("species", OFTString);
		OGRGeometryH geometry = NULL;
		OGRFeatureH feature;
		OGRLayerH layer;
		char *wkt = (char *)layers[i].wkt;
		if (crs) {
			OSRImportFromEPSG(crs, layers[i].epsg);
			OSRSetAxisMappingStrategy(crs, OAMS_TRADITIONAL_GIS_ORDER);
		}
		layer = GDALDatasetCreateLayer(data, layers[i].layer, crs, layers[i].type, NULL);
		assert_non_null(layer);
		OGR_L_CreateField(layer, field, 1);
		feature = OGR_F_Create(OGR_L_GetLayerDefn(layer));
		OGR_F_SetFieldString(feature, 0, layers[i].species);
		if (wkt && OGR_G_CreateFromWkt(&wkt, NULL, &geometry) == OGRERR_NONE)
			OGR_F_SetGeometryDirectly(feature, geometry);
		assert_int_equal(OGR_L_CreateFeature(layer, feature), OGRERR_NONE);
		OGR_F_Destroy(feature);
		OGR_Fld_Destroy(field);
		if (crs)
			OSRRelease(crs);
	}
	GDALClose(data);
	CPLPopErrorHandler();
}

static const struct made oak = { "trees", 25832, wkbPoint, "POINT (690000 5335000)", "oak" },
	degrees = { "trees", 4326, wkbPoint, "POINT (11.5 48.1)", "oak" }, nowhere = { "trees", 0, wkbPoint,
		"POINT (3 4)", "oak" },
	table = { "trees", 0, wkbNone, NULL, "oak" }, high = { "trees", 25832, wkbPoint25D,
		"POINT Z (690000 5335000 512)", "oak" },
	pair = { "trees", 0, wkbNone, NULL, "48.88398, 2.36" }, wkt = { "trees", 0, wkbNone, NULL,
		"POINT (3 4)" },
	layers[] = { { "trees", 25832, wkbPoint, "POINT (1 2)", "oak" }, { "beds", 25832, wkbPolygon, NULL,
		"rose" },
		{ "shrubs", 25832, wkbPoint, "POINT (3 4)", "hazel" } };

static const struct { const char *driver, *file; const struct made *layers; size_t count; const char *layer,
	*wanted, *note, *crs;
} files[] = {
	{ "GPKG", "a.gpkg", &oak, 1, NULL, "species / (690000 5335000) oak", NULL, "EPSG:25832" },
	{ "GPKG", "b.gpkg", &degrees, 1, NULL, "species / (11.5 48.1) oak", NULL, "EPSG:4326" },
	{ "GPKG", "c.gpkg", &high, 1, NULL, "species / (690000 5335000 512) oak", NULL, "EPSG:25832" },
	{ "ESRI Shapefile", "a.shp", &oak, 1, NULL, "species / (690000 5335000) oak", NULL, "EPSG:25832" },
	{ "ESRI Shapefile", "b.shp", &degrees, 1, NULL, "species / (11.5 48.1) oak", NULL, "EPSG:4326" },
	{ "ESRI Shapefile", "c.shp", &nowhere, 1, NULL, "species / (3 4) oak", NULL, NULL },
	{ "XLSX", "a.xlsx", &table, 1, NULL, "species / oak", NULL, NULL },
	{ "ODS", "a.ods", &table, 1, NULL, "species / oak", NULL, NULL },
	{ "FlatGeobuf", "a.fgb", &oak, 1, NULL, "species / (690000 5335000) oak", NULL, "EPSG:25832" },
	/* a workbook may have its places as text */
	{ "XLSX", "p.xlsx", &pair, 1, NULL, "species / (2.36 48.88398) 48.88398, 2.36",
		"latitude and longitude in one field", "EPSG:4326" },
	{ "ODS", "p.ods", &wkt, 1, NULL, "species / (3 4) POINT (3 4)", NULL, NULL },
	/* the layer that fits is taken, or asked for: below */
	{ "GPKG", "two.gpkg", layers, 2, NULL, "species / (1 2) oak", "it has 2 layers; \"trees\" is taken",
		"EPSG:25832" },
	{ "GPKG", "named.gpkg", layers, 3, "shrubs", "species / (3 4) hazel", NULL, "EPSG:25832" },
};

UNIT_TEST(files_of_gis_bring_points_and_their_crs)
{
	static const char *const others[] = { "height" };
	char got[2000];
	unlink("build/tmp/rows/c.prj");
	for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
		struct eco_rows_source source = { .path = input_path("rows", files[i].file),
			.layer = files[i].layer };
		make_file(files[i].driver, source.path, files[i].layers, files[i].count);
		expect_source(&source, files[i].wanted, files[i].note, files[i].crs);
	}
	/* read, though it is not among the columns wanted */
	struct eco_rows_source source = { .path = input_path("rows", "p.gpkg"), .wanted = others,
		.wanted_count = 1 };
	make_file("GPKG", source.path, &wkt, 1);
	assert_string_equal(rows_text_of(open_good(&source), got, sizeof got), "species / (3 4) POINT (3 4)");
	expect_error("build/tmp/rows/named.gpkg", NULL,
		"name one, with --layer or, in a scene, \"layer\": trees (Point), beds (Polygon), "
		"shrubs (Point)");
	expect_error("build/tmp/rows/named.gpkg", "herbs", "no layer \"herbs\"; there are: trees");
}

/* Opens and reads to the end. */
static void read_whole(const char *path, struct eco_error *error)
{
	struct eco_rows_source source = { .path = path };
	struct eco_rows *rows;
	bool more = true;
	*error = (struct eco_error){ .code = ECO_OK };
	if (eco_rows_open_here(&rows, &source, error))
		return;
	while (rows->next(rows, &more, error) == ECO_OK && more)
		;
	eco_rows_close(rows);
}

static void expect_broken(const char *name, const uint8_t *bytes, size_t size, size_t where)
{
	struct eco_error error;
	read_whole(input_bytes("rows", name, bytes, size), &error);
	if (!strstr(error.text, "cannot be read"))
		fail_msg("%s, damaged at %zu: %s", name, where, error.code ? error.text : "it is read");
}

/* A file that ends early, or that lost bytes in its middle, is neither empty nor shorter than it was. */
UNIT_TEST(broken_files_cannot_be_read)
{
	static const struct { const char *driver, *good, *broken; const struct made *layer; } whole[] = {
		{ "XLSX", "whole.xlsx", "cut.xlsx", &table }, { "ODS", "whole.ods", "cut.ods", &table },
		{ "GPKG", "whole.gpkg", "cut.gpkg", &degrees }, { "FlatGeobuf", "whole.fgb", "cut.fgb",
			&degrees },
		{ "ESRI Shapefile", "cut.shp", "cut.shp", &degrees }, { "LIBKML", "whole.kmz", "cut.kmz",
			&degrees },
		{ "GML", "whole.gml", "cut.gml", &degrees }, { "GeoJSON", "whole.geojson", "cut.geojson",
			&degrees } };
	for (size_t i = 0; i < sizeof whole / sizeof *whole; i++) {
		struct eco_error error;
		const char *good = input_path("rows", whole[i].good);
		size_t size;
		make_file(whole[i].driver, good, whole[i].layer, 1);
		read_whole(good, &error);
		assert_ok(error.code, error);
		uint8_t *bytes = file_read(good, &size);
		for (size_t part = 1; part <= 19; part++)
			expect_broken(whole[i].broken, bytes, size * part / 20, size * part / 20);
		free(bytes);
	}
	for (int i = 1; i < 4; i++) {        /* texts where bytes are expected */
		expect_broken("text.xlsx", (const uint8_t *)"PK\3\4", (size_t)i, 0);
		expect_broken("text.gpkg", (const uint8_t *)"SQLite", (size_t)i, 0);
	}
	expect_broken("a.parquet", (const uint8_t *)"PAR1\0\0\0\0PAR1", 12, 0);
}

UNIT_TEST(parts_of_a_shapefile_that_are_missed_are_named)
{
	static const struct made tree = { "trees", 25832, wkbPoint, "POINT (3 4)", "oak" };
	static const char plan[] = "LOCAL_CS[\"plan of the garden\",UNIT[\"m\",1]]";
	struct eco_rows_source source;
	struct eco_rows *rows;
	char got[2000];
	source = (struct eco_rows_source){ .path = input_path("rows", "parts.shp") };
	make_file("ESRI Shapefile", source.path, &tree, 1);
	unlink("build/tmp/rows/parts.prj");
	rows = open_good(&source);
	assert_null(rows->crs);
	assert_string_equal(rows->no_crs, " (there is no .prj beside it)");
	assert_string_equal(rows_text_of(rows, got, sizeof got), "species / (3 4) oak");
	source.path = "build/tmp/rows/parts.shp";
	input_text("rows", "parts.prj", plan);
	rows = open_good(&source);
	assert_null(rows->crs);
	assert_string_equal(rows->no_crs, " (it names \"plan of the garden\", which has no place on Earth)");
	eco_rows_close(rows);
	unlink("build/tmp/rows/parts.dbf");
	rows = open_good(&source);
	assert_string_equal(rows->notes[0], "its .dbf is not beside it, so it has no columns");
	assert_string_equal(rows_text_of(rows, got, sizeof got), " / (3 4)");
	unlink("build/tmp/rows/parts.shx");
	expect_error(source.path, NULL, "a Shapefile is several files, and its .shx is not beside it; copy "
		"all of them");
}

UNIT_TEST(trees_of_city_models_are_rows)
{
	struct city_case { const char *name, *srs, *inside, *wanted, *note, *crs; };
	uint32_t count;
	const struct city_case *models = cases_read("tests/import/cases/citygml.tsv", sizeof *models, &count);
	for (uint32_t i = 0; i < count; i++) {
		char text[4000];
		snprintf(text, sizeof text, "<?xml version=\"1.0\"?><core:CityModel "
			"xmlns:core=\"http://www.opengis.net/citygml/2.0\" xmlns:gml=\"http://www.opengis.net/gml\" "
			"xmlns:veg=\"http://www.opengis.net/citygml/vegetation/2.0\" xmlns:bldg=\"b\" xmlns:gen=\"g\">"
			"<gml:boundedBy><gml:Envelope srsName=\"%s\" srsDimension=\"3\"><gml:lowerCorner>0 0 0"
			"</gml:lowerCorner><gml:upperCorner>1 1 1</gml:upperCorner></gml:Envelope></gml:boundedBy>"
			"%s</core:CityModel>", models[i].srs, models[i].inside);
		expect(models[i].name, text, models[i].wanted, models[i].note, models[i].crs);
	}
}

/* ---- The child process ---- */

UNIT_TEST(a_child_hands_over_the_same_rows)
{
	struct eco_rows_source source = { .path = input_text("rows", "child.geojson",
		COLLECTION("", FEATURE(POINT("1,2,3"), "\"s\":\"oak\",\"t\":\"x\"") "," FEATURE("null",
		"\"s\":\"a\\nb\""))) };
	const char *const wanted[] = { "s" };
	struct eco_rows *rows;
	char here[1000], there[1000];
	rows_text_of(open_good(&source), here, sizeof here);
	assert_good(eco_rows_open(&rows, &source, &cause));
	assert_true(rows->has_geometry && rows->has_z);
	assert_string_equal(rows_text_of(rows, there, sizeof there), here);
	source.wanted = wanted;
	source.wanted_count = 1;
	assert_good(eco_rows_open(&rows, &source, &cause));
	assert_string_equal(rows_text_of(rows, there, sizeof there), "s,t / (1 2 3) oak, / empty a\nb,");
	source.path = input_text("rows", "child.csv", "x,y\n1,\"2\n");
	assert_good(eco_rows_open(&rows, &source, &cause));
	assert_non_null(strstr(rows_text_of(rows, there, sizeof there),
		"! build/tmp/rows/child.csv:2: a quoted field"));
}
