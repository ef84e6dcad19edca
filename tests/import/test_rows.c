/* Tables in every format that is read, row by row, and files that are none. Those that only OGR can write are
 * made with it here. Longer than 600 lines: a test a format, with the same helpers. */
#include <cpl_error.h>
#include <gdal.h>
#include <math.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>
#include <stdlib.h>

#include "ecofiles/import/places/rows/rows.h"
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

#define SAYS(name) "\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"" name "\"}},"
#define GML(crs, at) "<?xml version=\"1.0\"?><ogr:FeatureCollection xmlns:ogr=\"http://ogr.maptools.org/\" " \
	"xmlns:gml=\"http://www.opengis.net/gml/3.2\"><ogr:featureMember><ogr:boom gml:id=\"b1\"><ogr:geometry>" \
	"<gml:Point srsName=\"" crs "\"><gml:pos>" at "</gml:pos></gml:Point></ogr:geometry>" \
	"<ogr:soort>Tilia</ogr:soort></ogr:boom></ogr:featureMember></ogr:FeatureCollection>"

#define KML(description) "<kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document><Placemark><name>7</name>" \
	"<description>" description "</description><Point><coordinates>11.5,48.1</coordinates></Point></Placemark>" \
	"</Document></kml>"
#define KML_COLUMNS "Name,description,timestamp,begin,end,altitudeMode,tessellate,extrude,visibility,drawOrder,icon,"

/* name: NULL: as above; note, crs NULL: none */
static const struct { const char *name, *file, *text, *wanted, *note, *crs; } cases[] = {
	{ "separators_are_found_in_the_header", "a.csv", "x,y\n1,2\n", "x,y / 1,2", NULL, NULL },
	{ NULL, "b.csv", "x;y;\"a,b,c,d\"\n1,5;2,5;z\n", "x,y,a,b,c,d / 1,5,2,5,z", "separated by \";\"",
		NULL },
	{ NULL, "c.txt", "x\ty\n1\t2\n", "x,y / 1,2", "tabs", NULL },
	{ NULL, "d.psv", "x|y\n1|2\n", "x,y / 1,2", "separated by \"|\"", NULL },
	{ NULL, "e.csv", "sep=;\r\nx;y\r\n1;2\r\n", "x,y / 1,2", NULL, NULL },
	{ NULL, "f.csv", "x\n1\n", "x / 1", NULL, NULL },
	{ NULL, "noextension", "x,y\n1,2\n", "x,y / 1,2", NULL, NULL },
	{ NULL, "g.tab", "x\ty\n1\t2\n", "x,y / 1,2", "tabs", NULL },
	{ "text_of_western_pages_becomes_utf8", "latin.csv", "Art,x\nB\xe4rlauch,1\nutf \xc3\xa4,2\n"
		"\x80\x84\x93,3\n", "Art,x / Bärlauch,1 / utf ä,2 / €„“,3", "first in line 2", NULL },
	{ NULL, "header.csv", "H\xf6he,x\n1,2\n", "Höhe,x / 1,2", "Windows-1252", NULL },
	{ "other_encodings_are_told_by_their_words", "japan.csv", "\x8e\xf7\x8e\xed"",x\n\x83""P\x83\x84\x83""L,1\n", "樹種,x / ケヤキ,1", "CP932", NULL },
	{ NULL, "china.csv", "\xca\xf7\xb8\xdf"",x\n12,1\n", "树高,x / 12,1", "GB18030", NULL },
	{ NULL, "russia.csv", "\xc2\xfb\xf1\xee\xf2\xe0"",x\n12,1\n", "Высота,x / 12,1", "CP1251", NULL },
	{ NULL, "israel.csv", "\xf9\xed \xee\xe3\xf2\xe9"",\xe2\xe5\xe1\xe4"",x\n\xe0\xec\xe5\xef"",12,1\n",
		"שם מדעי,גובה,x / אלון,12,1", "CP1255", NULL },
	{ "rows_may_be_short_or_long", "short.csv", "a,b,c\n1\n1,2,3,4\n,,\n", "a,b,c / 1 / 1,2,3,4 / ,,",
		NULL, NULL },
	{ NULL, "old.csv", "a,b\r1,2\r3,4\r", "a,b / 1,2 / 3,4", NULL, NULL },
	{ "points_as_text_are_the_geometry", "wkt.csv",
		"WKT,species\n\"POINT (11.5 48.1)\",oak\n,ash\n\"LINESTRING (1 2,3 4)\",\"elm\n"
		"red\"\nPOINT EMPTY,fir\nPOINT (x y),bad\n", "WKT,species / (11.5 48.1) POINT (11.5 48.1),"
		"oak / empty ,ash / LINESTRING LINESTRING (1 2,3 4),elm\nred / empty POINT EMPTY,fir / "
		"POINT POINT (x y),bad", NULL, NULL },
	{ NULL, "crown.csv", "id,WKT\n1,\"POLYGON ((0 0,4 0,4 4,0 4,0 0))\"\n",
		"id,WKT / (2 2, 4.51 m wide) 1,POLYGON ((0 0,4 0,4 4,0 4,0 0))", NULL, NULL },
	{ NULL, "degrees.csv", "WKT\n\"POLYGON Z ((0 60 9,0 60.0001 9,0.0002 60.0001 9,0.0002 60 9,0 60 9))\"\n",
		"WKT / (0.0001 60.00005, 12.5 m wide) POLYGON Z ((0 60 9,0 60.0001 9,0.0002 60.0001 9,0.0002 60 9,0 60 9))",
		NULL, NULL },
	{ NULL, "several.csv", "id,WKT\n1,MULTIPOINT ((1 2))\n", "id,WKT / (1 2) 1,MULTIPOINT ((1 2))", NULL, NULL },
	{ NULL, "postgis.csv", "id,geom\n1,0101000020E6100000000000000000F83F0000000000000440\n",
		"id,geom / (1.5 2.5) 1,0101000020E6100000000000000000F83F0000000000000440", NULL, NULL },
	{ NULL, "the_geom.csv", "id;the_geom\n1;SRID=4326;POINT(1 2)\n",
		"id,the_geom / 1,SRID=4326,POINT(1 2)", "separated by", NULL },
	{ NULL, "ewkt.csv", "id,geom\n1,SRID=4326;POINT Z (1 2.5 -3e1)\n",
		"id,geom / (1 2.5 -30) 1,SRID=4326;POINT Z (1 2.5 -3e1)", NULL, NULL },
	{ "latitude_and_longitude_in_one_field_are_the_geometry", "pair.csv",
		"id,geo_point_2d\n1,\n2,\"48.88398, 2.36\"\n3,\"-33.5,151.25\"\n4,\"n.n., 5\"\n",
		"id,geo_point_2d / empty 1, / (2.36 48.88398) 2,48.88398, 2.36 / (151.25 -33.5) 3,-33.5,"
		"151.25 / n.n., 4,n.n., 5", "latitude and longitude in one field", "EPSG:4326" },
	{ NULL, "address.csv", "id,Location\n1,\"5 Elm (rear)\n(40.7128, -74.0060)\"\n",
		"id,Location / (-74.006 40.7128) 1,5 Elm (rear)\n(40.7128, -74.0060)",
		"latitude and longitude in one field", "EPSG:4326" },
	{ NULL, "both.csv", "a,b\n\"48.8839, 2.3600\",POINT (1 2)\n",
		"a,b / (1 2) 48.8839, 2.3600,POINT (1 2)", NULL, NULL },
	{ NULL, "numbers.csv", "a,b,c\n\"12, 14\",\"1.5, 2.5\",\"91.0000, 2.3600\"\n",
		"a,b,c / 12, 14,1.5, 2.5,91.0000, 2.3600", NULL, NULL },
	{ "each_feature_is_a_row_whatever_its_geometry", "e.geojson",
		COLLECTION("", FEATURE("null", "\"id\":1") ","
		FEATURE("{\"type\":\"Point\",\"coordinates\":[]}", "\"id\":2") ","
		FEATURE("{\"type\":\"Polygon\",\"coordinates\":[[[0,0],[1,0],[1,1],[0,0]]]}", "\"id\":3") ","
		FEATURE("{\"type\":\"MultiPoint\",\"coordinates\":[[5,6],[7,8]]}", "\"id\":4") ","
		FEATURE("{\"type\":\"MultiPoint\",\"coordinates\":[]}", "\"id\":5") ","
		FEATURE("{\"type\":\"LineString\",\"coordinates\":[[5,6],[7,8]]}", "\"id\":6") ","
		FEATURE("{\"type\":\"GeometryCollection\",\"geometries\":[" POINT("1,2") "]}", "\"id\":7")),
		"id / empty 1 / empty 2 / Polygon 3 / (5 6) 4 / (7 8) 4 / empty 5 / Line String 6 / "
		"Geometry Collec 7", NULL, "EPSG:4326" },
	{ NULL, "f.geojsonl", FEATURE(POINT("1,2"), "\"s\":\"oak\"") "\n"
		FEATURE(POINT("3,4"), "\"s\":\"ash\"") "\n", "s / (1 2) oak / (3 4) ash", NULL, "EPSG:4326" },
	{ NULL, "g.geojson", "\xef\xbb\xbf" COLLECTION("", FEATURE(POINT("1,2"), "\"Größe\":3.5")),
		"Größe / (1 2) 3.5", NULL, "EPSG:4326" },
	{ "geojson_is_degrees_unless_it_says_otherwise", "a.geojson", COLLECTION("",
		FEATURE(POINT("2.35,48.85"),
		"\"genre\":\"Platanus\",\"hauteurenm\":12,\"ok\":true,\"no\":null")),
		"genre,hauteurenm,ok,no / (2.35 48.85) Platanus,12,1,", NULL, "EPSG:4326" },
	{ NULL, "b.geojson", COLLECTION(SAYS("urn:ogc:def:crs:EPSG::28992"), FEATURE(POINT("121000,487000"),
		"\"id\":1")),
		"id / (121000 487000) 1", NULL, "EPSG:28992" },
	{ NULL, "c.geojson", COLLECTION(SAYS("urn:ogc:def:crs:OGC:1.3:CRS84"), FEATURE(POINT("2,48"),
		"\"id\":1")),
		"id / (2 48) 1", NULL, "EPSG:4326" },
	{ NULL, "d.json", FEATURE(POINT("2,48,35.5"), "\"id\":1"), "id / (2 48 35.5) 1", NULL, "EPSG:4979" },
	{ "gml_has_easting_or_longitude_first_in_the_end", "boom.gml", GML("urn:ogc:def:crs:EPSG::28992",
		"121000 487000"),
		"gml_id,soort / (121000 487000) b1,Tilia", NULL, "EPSG:28992" },
	{ NULL, "degrees.gml", GML("urn:ogc:def:crs:EPSG::4326", "52.4 4.9"),
		"gml_id,soort / (4.9 52.4) b1,Tilia", NULL,
		"EPSG:4326" },
	{ NULL, "short.gml", GML("EPSG:4326", "4.9 52.4"), "gml_id,soort / (4.9 52.4) b1,Tilia", NULL,
		"EPSG:4326" },
	{ NULL, "north.gml", GML("urn:ogc:def:crs:EPSG::31467", "5335000 3560000"),
		"gml_id,soort / (3560000 5335000) b1,Tilia", NULL, "EPSG:31467" },
	{ "fields_of_kml_are_columns", "a.kml",
		"<kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document><Placemark>"
		"<name>oak</name><ExtendedData><Data name=\"dbh\"><value>30</value></Data></ExtendedData><Point>"
		"<coordinates>11.5,48.1,0</coordinates></Point></Placemark></Document></kml>",
		"Name,description,timestamp,begin,end,altitudeMode,tessellate,extrude,visibility,drawOrder,icon,dbh / "
		"(11.5 48.1 0) oak,,,,,,-1,0,-1,,,30", NULL, "EPSG:4326" },
	{ "lines_and_tables_of_kml_descriptions_are_columns", "lines.kml", KML("Art: Linde&lt;br&gt;Höhe: 12 m"),
		KML_COLUMNS "Art,Höhe / (11.5 48.1) 7,Art: Linde<br>Höhe: 12 m,,,,,-1,0,-1,,,Linde,12 m",
		"its 2 rows are columns", "EPSG:4326" },
	{ NULL, "table.kml", KML("<![CDATA[<table><tr><td>x</td></tr><tr><td><table><tr><td>Art</td><td>Linde</td></tr>"
		"<tr><td>H</td><td>9</td></tr></table></td></tr></table>]]>"), KML_COLUMNS "Art,H / (11.5 48.1) 7,"
		"<table><tr><td>x</td></tr><tr><td><table><tr><td>Art</td><td>Linde</td></tr><tr><td>H</td><td>9</td>"
		"</tr></table></td></tr></table>,,,,,-1,0,-1,,,Linde,9", "its 2 rows are columns", "EPSG:4326" },
	{ "attributes_of_a_plans_blocks_are_columns_and_lettering_is_none", "plan.dxf", "0\nSECTION\n2\nHEADER\n9\n"
		"$INSUNITS\n70\n6\n0\nENDSEC\n0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nTREE\n10\n0\n20\n0\n0\nPOINT\n"
		"8\n0\n10\n0\n20\n0\n0\nENDBLK\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nINSERT\n8\nT\n66\n1\n2\nTREE\n10\n"
		"5\n20\n6\n0\nATTRIB\n8\nT\n10\n5\n20\n6\n40\n1\n1\nTilia\n2\nART\n0\nSEQEND\n8\nT\n0\nTEXT\n8\nT\n10\n1\n20\n"
		"2\n40\n1\n1\nGate\n0\nENDSEC\n0\nEOF\n",
		"Layer,PaperSpace,SubClasses,Linetype,EntityHandle,Text,BlockName,scale,yaw_deg,BlockOCSNormal,"
		"BlockOCSCoords,BlockAttributes,Block,AttributeTag,ART / (5 6 0) T,,,,,,TREE,1,0,(3:0,0,1),"
		"(3:5,6,0),(1:ART Tilia),,,Tilia / text T,,,,,Gate,,,,,,,,,", "\"entities\" is taken", NULL },
};

UNIT_TEST(files_become_rows)
{
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
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

#define TREE(inside) "<core:cityObjectMember><veg:SolitaryVegetationObject gml:id=\"t\">" inside \
	"</veg:SolitaryVegetationObject></core:cityObjectMember>"
#define AT(pos) "<gml:Point><gml:pos srsDimension=\"3\">" pos "</gml:pos></gml:Point>"
#define RING(corners) \
"<gml:surfaceMember><gml:Polygon><gml:exterior><gml:LinearRing><gml:posList srsDimension=\"3\">" \
	corners "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon></gml:surfaceMember>"

UNIT_TEST(trees_of_city_models_are_rows)
{
	static const struct { const char *name, *srs, *inside, *wanted, *note, *crs; } models[] = {
		/* an implicit geometry stands at its reference point */
		{ "implicit.gml", "urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH",
			TREE("<veg:species>1640</veg:species>"
			"<veg:height uom=\"m\">12.5</veg:height><gen:stringAttribute name=\"Art\"><gen:value>Linde"
			"</gen:value></gen:stringAttribute><veg:lod2ImplicitRepresentation><core:ImplicitGeometry>"
			"<core:relativeGMLGeometry>" AT("1 2 3")
			"</core:relativeGMLGeometry><core:referencePoint>"
			AT("690100.5 5335200.25 515") "</core:referencePoint></core:ImplicitGeometry>"
			"</veg:lod2ImplicitRepresentation>"),
			"gml_id,species,height,height_uom,Art / (690100.5 5335200.25 515) t,1640,12.5,m,Linde", NULL,
			"EPSG:25832" },
		/* another on the middle of its lowest part, a trunk under a leaning crown; buildings are none
		 * */
		{ "foot.gml", "EPSG:25832", TREE("<veg:lod1Geometry><gml:MultiSurface>"
			RING("10 20 500 12 20 500 12 22 500 "
			"10 22 500 10 20 500") RING("10 20 505 40 20 505 40 60 510 10 20 505")
			"</gml:MultiSurface></veg:lod1Geometry>")
			"<core:cityObjectMember><bldg:Building><bldg:height>9</bldg:height></bldg:Building>"
			"</core:cityObjectMember><core:cityObjectMember><veg:PlantCover><veg:averageHeight>3"
			"</veg:averageHeight></veg:PlantCover></core:cityObjectMember>",
			"gml_id / (11 21 500) t", "its PlantCover features are skipped", "EPSG:25832" },
		{ "globe.gml", "urn:ogc:def:crs:EPSG::4979", TREE("<veg:lod1Geometry>" AT("48.1 11.5 520")
			"</veg:lod1Geometry>") TREE(""), "gml_id / (11.5 48.1 520) t / empty t", NULL,
			"EPSG:4979" },
		{ "nowhere.gml", "urn:adv:crs:plan", TREE("<veg:lod1Geometry>" AT("1 2 3")
			"</veg:lod1Geometry>"),
			"gml_id / (1 2 3) t", NULL, NULL },
	};
	for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
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
