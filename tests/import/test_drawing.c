/* Lines and areas drawn on the ground: classes, what lies above what, squares that need no splitting, water,
 * odd input; and extracts of OpenStreetMap, which have most of it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/land/drawing.h"
#include "ecofiles/import/land/scatter.h"
#include "ecofiles/import/places/rows/rows.h"
#include "tests/support/cases.h"
#include "tests/support/model_try.h"

#define SIDE ECO_GROUND_IMAGE_SIDE
static const struct eco_frame frame = { .crs = "EPSG:32617" };

/* ---- Classes ---- */

UNIT_TEST(attributes_tell_classes)
{
	struct row { const char *columns[2], *fields[2]; bool line; const char *class; };
	uint32_t count;
	const struct row *cases = cases_rows("tests/import/cases/land_classes.tsv", "ssssbs", sizeof *cases,
		&count);
	for (size_t i = 0; i < count; i++) {
		struct eco_land_reader reader;
		struct eco_land_class class = { .name = NULL };
		eco_land_reader_open(&reader, (char *const *)(uintptr_t)cases[i].columns, 2);
		uint32_t number = eco_land_class_of(&reader, cases[i].fields, 2, cases[i].line, NULL);
		if (number != ECO_NONE)
			assert_true(eco_land_class(number, &class));
		if ((class.name != NULL) != (cases[i].class != NULL) || (class.name && strcmp(class.name, cases[i].class) != 0))
			fail_msg("%s is %s", cases[i].fields[0], class.name ? class.name : "nothing");
		eco_land_reader_close(&reader);
	}
	assert_int_equal(eco_land_class_named("asphalt"), ECO_NONE);     /* a surface */
}

/* ---- Drawing ---- */

#define HEAD "{\"type\":\"FeatureCollection\",\"crs\":{\"type\":\"name\"," \
	"\"properties\":{\"name\":\"urn:ogc:def:crs:EPSG::32617\"}},\"features\":["
#define FEATURE(properties, type, at) "{\"type\":\"Feature\",\"properties\":{" properties "},\"geometry\":{\"type\":\"" type \
	"\",\"coordinates\":" at "}}"
#define PARK FEATURE("\"leisure\":\"park\"", "Polygon", "[[[0,0],[64,0],[64,64],[0,64],[0,0]],[[40,40],[60,40],[60,60],[40,60],[40,40]]]")
#define POND FEATURE("\"natural\":\"water\"", "Polygon", "[[[8,8],[24,8],[24,24],[8,24],[8,8]]]")
#define BOW FEATURE("\"natural\":\"water\"", "Polygon", "[[[100,0],[120,20],[120,0],[100,20],[100,0]]]")
#define ROAD FEATURE("\"highway\":\"primary\",\"width\":\"8 m\"", "LineString", "[[0,32],[64,32]]")
#define WIDE FEATURE("\"highway\":\"path\",\"width\":\"4000\"", "LineString", "[[0,62],[64,62]]")
#define POINT FEATURE("\"highway\":\"crossing\"", "Point", "[5,5]")
#define STRANGE FEATURE("\"highway\":\"proposed\"", "LineString", "[[0,0],[9,9]]")

static struct eco_drawing *drawn(const char *name, const char *features, struct eco_draw_spec spec)
{
	char text[4096];
	struct eco_drawing *drawing;
	snprintf(text, sizeof text, HEAD "%s]}", features);
	static struct eco_draw_spec kept;
	kept = spec;
	kept.path = (char *)input_text("drawing", name, text);
	assert_good(eco_drawing_open(&drawing, &kept, 1, &frame, &cause));
	import_said[0] = 0;
	eco_drawing_report(drawing, import_note, NULL);
	return drawing;
}

static uint8_t rgba[ECO_GROUND_IMAGE_BYTES];
/* The texel of a square of 64 m at a place. */
static const uint8_t *at(double x, double y) { return rgba + 4 * ((size_t)((64 - y) * 4) * SIDE + (size_t)(x * 4)); }

static void paint(const struct eco_drawing *drawing, double low)
{
	const struct eco_ground_drawing *g = eco_drawing_ground(drawing);
	memset(rgba, 0, sizeof rgba);
	assert_good(g->paint(g->ctx, (const double[]){ low, 0 }, 64.0 / SIDE, rgba, &cause));
}

UNIT_TEST(what_lies_above_what_does_not_depend_on_the_order)
{
	static const char *const orders[] = { ROAD "," POND "," PARK, PARK "," POND "," ROAD };
	static uint8_t first[sizeof rgba];
	for (int i = 0; i < 2; i++) {
		struct eco_drawing *d = drawn("order.json", orders[i], (struct eco_draw_spec){ .width = (char *)"width" });
		paint(d, 0);
		assert_int_equal(at(50, 50)[3], 0);                              /* a hole */
		assert_true(at(4, 50)[1] > at(4, 50)[2] && at(4, 50)[3] < 200);  /* grass shines through */
		assert_true(at(16, 16)[2] > at(16, 16)[0] && at(16, 16)[3] == ECO_GROUND_WATER);      /* water on grass */
		for (double y = 28.5; y < 36; y += 0.5)                          /* 8 m of grey */
			assert_true(abs(at(32, y)[0] - at(32, y)[2]) < 12 && at(32, y)[3] == 255);
		assert_true(at(32, 37)[3] < 200);
		if (i)
			assert_memory_equal(first, rgba, sizeof rgba);
		memcpy(first, rgba, sizeof rgba);
		eco_drawing_close(d);
	}
}

UNIT_TEST(squares_that_nothing_crosses_are_not_worth_more)
{
	struct eco_drawing *d = drawn("split.json", PARK "," ROAD, (struct eco_draw_spec){ .width_m = 6 });
	const struct eco_ground_drawing *g = eco_drawing_ground(d);
	static const struct { double low[2], high[2]; bool touches; } boxes[] = { { { 4, 4 }, { 20, 20 }, false },
		{ { 4, 20 }, { 20, 28.9 }, false }, { { 4, 20 }, { 20, 29.1 }, true }, { { 20, 33 }, { 21, 34 }, true },
		{ { 44, 44 }, { 56, 56 }, false }, { { -9, -9 }, { -4, 80 }, false }, { { -50, -50 }, { 200, 200 }, true } };
	for (size_t i = 0; i < sizeof boxes / sizeof *boxes; i++)
		assert_int_equal(g->touches(g->ctx, boxes[i].low, boxes[i].high), boxes[i].touches);
	eco_drawing_close(d);
}

UNIT_TEST(odd_features_are_told_and_others_drawn)
{
	struct eco_drawing *d = drawn("odd.json", BOW "," WIDE "," POINT "," STRANGE, (struct eco_draw_spec){ .width = (char *)"width" });
	import_says("water 1, path 1");
	import_says("2 features left out: points, of no class that is drawn, or lines without a width");
	import_says("1 widths are none between 0 and 100 m (first: \"4000\")");
	paint(d, 64);
	assert_int_equal(at(38, 10)[3], ECO_GROUND_WATER);        /* both triangles of the bow, not between them */
	assert_int_equal(at(54, 10)[3], ECO_GROUND_WATER);
	assert_int_equal(at(46, 16)[3], 0);
	eco_drawing_close(d);
	d = drawn("none.json", POINT, (struct eco_draw_spec){ .line = 1 });
	import_says("nothing");
	assert_null(eco_drawing_ground(d));
	eco_drawing_close(d);
	d = drawn("far.json", FEATURE("\"highway\":\"path\"", "LineString", "[[-9e6,0],[9e6,0]]"), (struct eco_draw_spec){ .line = 1 });
	assert_true(eco_drawing_ground(d)->high[0] - eco_drawing_ground(d)->low[0] < 1e7);       /* as wide as an image may be */
	eco_drawing_close(d);
	d = drawn("class.json", STRANGE, (struct eco_draw_spec){ .class = (char *)"street" });
	import_says("street 1");
	eco_drawing_close(d);
}

UNIT_TEST(corners_around_a_square_are_kept)
{
	struct eco_drawing *d = drawn("around.json", FEATURE("\"natural\":\"water\"", "Polygon",
		"[[[-20,40],[-20,-10],[-10,-20],[40,-20],[200,-20],[200,200],[-20,200],[-20,40]]]"), (struct eco_draw_spec){ .line = 1 });
	paint(d, 0);
	assert_int_equal(at(2, 2)[3], ECO_GROUND_WATER);
	assert_true(eco_drawing_has_water(d));
	eco_drawing_close(d);
	d = drawn("thin.json", ROAD, (struct eco_draw_spec){ .class = (char *)"water" });
	import_says("1 of them are lines of a class of areas, which has no width");
	eco_drawing_close(d);
}

#define COAST(at) FEATURE("\"natural\":\"coastline\"", "LineString", at)
/* Whether the texel at a place of the square is sea. */
static bool sea_at(double x, double y) { return at(x, y)[3] == ECO_GROUND_WATER && at(x, y)[2] > at(x, y)[0]; }

UNIT_TEST(the_sea_lies_to_the_right_of_coastlines)
{
	/* in two parts, in any order; an island; and copies, as of two extracts */
	struct eco_drawing *d = drawn("coast.json", COAST("[[32,32],[32,64]]") "," COAST("[[40,0],[32,32]]") ","
		COAST("[[50,20],[60,20],[60,30],[50,30],[50,20]]") "," COAST("[[50,20],[60,20],[60,30],[50,30],[50,20]]") ","
		COAST("[[32,32],[32,64]]"), (struct eco_draw_spec){ .line = 1 });
	import_says("coastline 5");
	import_says("drawn: sea 1");
	paint(d, 0);
	assert_true(!sea_at(20, 10) && !sea_at(20, 60) && sea_at(50, 10) && sea_at(50, 60) && !sea_at(55, 25));
	eco_drawing_close(d);
	d = drawn("island.json", COAST("[[20,20],[40,20],[40,40],[20,40],[20,20]]"), (struct eco_draw_spec){ .line = 1 });
	paint(d, 0);
	assert_true(sea_at(10, 30) && sea_at(50, 30) && !sea_at(30, 30));
	eco_drawing_close(d);
	d = drawn("lagoon.json", COAST("[[20,20],[20,40],[40,40],[40,20],[20,20]]"), (struct eco_draw_spec){ .line = 1 });
	paint(d, 0);
	assert_true(!sea_at(10, 30) && sea_at(30, 30));
	eco_drawing_close(d);
	d = drawn("gap.json", COAST("[[40,0],[32,32]]") "," COAST("[[32,64],[32,33]]"), (struct eco_draw_spec){ .line = 1 });
	import_says("the sea is not drawn, as its coastlines have gaps");
	assert_null(eco_drawing_ground(d));
	eco_drawing_close(d);
	/* a coast beyond the box around the sea: the box has an inside yet */
	d = drawn("beyond.json", COAST("[[300000,0],[400000,10]]"), (struct eco_draw_spec){ .line = 1 });
	for (int k = 0; k < 2; k++)
		assert_true(eco_drawing_ground(d)->low[k] < eco_drawing_ground(d)->high[k]);
	eco_drawing_close(d);
}

UNIT_TEST(still_water_is_level_and_a_river_is_not)
{
	struct eco_drawing *d = drawn("water.json", POND "," BOW, (struct eco_draw_spec){ .line = 1 });
	struct eco_ground g = { .columns = 65, .rows = 13, .step_x_m = 2, .step_y_m = 2, .height_m = malloc(65 * 13 * sizeof(float)) };
	for (uint32_t i = 0; i < 65 * 13; i++)       /* 1 in 10 in the west, 1 in 2 in the east */
		g.height_m[i] = (float)(i % 65 < 40 ? 0.2 * (i % 65) : i % 65);
	import_said[0] = 0;
	eco_drawing_level(d, &g, import_note, NULL);
	import_says("1 area of water is level");
	import_says("1 slopes by more than 3 m");
	float low = g.height_m[6 * 65 + 6];
	for (uint32_t x = 5; x < 12; x++)
		assert_true(g.height_m[6 * 65 + x] == low);
	assert_true(g.height_m[6 * 65 + 3] < low && g.height_m[6 * 65 + 13] > low && g.height_m[2 * 65 + 55] == 55);
	free(g.height_m);
	eco_drawing_close(d);
}

/* ---- Extracts of OpenStreetMap ---- */

#define NODE(id, lat, lon) "<node id=\"" #id "\" lat=\"" #lat "\" lon=\"" #lon "\"/>"
#define WAY(id, tags, refs) "<way id=\"" #id "\">" refs tags "</way>"
#define TAG(k, v) "<tag k=\"" k "\" v=\"" v "\"/>"
#define REF(n) "<nd ref=\"" #n "\"/>"
static const char osm[] = "<?xml version=\"1.0\"?><osm version=\"0.6\">" NODE(1, 0, -81) NODE(2, 0, -80.999) NODE(3, .001, -80.999)
	"<node id=\"4\" lat=\".0005\" lon=\"-80.9995\">" TAG("natural", "tree") TAG("species", "Tilia cordata") TAG("height", "12") "</node>"
	"<node id=\"5\" lat=\".0002\" lon=\"-80.9991\">" TAG("amenity", "bench") "</node>"
	WAY(1, TAG("highway", "service") TAG("width", "3"), REF(1) REF(2)) WAY(2, TAG("natural", "tree_row"), REF(2) REF(3))
	WAY(3, TAG("building", "yes") TAG("building:levels", "3"), REF(1) REF(2) REF(3) REF(1)) "</osm>";

UNIT_TEST(an_extract_has_single_trees_lines_and_areas)
{
	char *path = (char *)input_text("drawing", "town.osm", osm);
	static const struct { const char *layer, *column, *value; bool areas; } cases[] = { { NULL, "species", "Tilia cordata", false },
		{ NULL, "building:levels", "3", true }, { "lines", "width", "3", true } };
	for (size_t i = 0; i < 3; i++) {
		struct eco_rows *rows;
		bool more;
		uint32_t column, count = 1;
		assert_good(eco_rows_open(&rows, &(struct eco_rows_source){ .path = path, .layer = cases[i].layer, .areas = cases[i].areas }, &cause));
		assert_good(eco_rows_find_column(rows, path, cases[i].column, &column, &cause));
		assert_good(rows->next(rows, &more, &cause));
		assert_true(more);
		assert_string_equal(rows->fields[column], cases[i].value);
		while (rows->next(rows, &more, &cause) == ECO_OK && more)
			count++;
		assert_int_equal(count, i == 2 ? 2 : 1);
		eco_rows_close(rows);
	}
}

UNIT_TEST(tree_rows_stand_along_lines)
{
	static struct eco_scatter_plant lime = { 0, 1, 1 };
	struct eco_value row = { .text = (char *)"tree_row" };
	struct eco_filter only = { .only = true, .column = (char *)"natural", .value_count = 1, .values = &row };
	const struct eco_scatter_spec spec = { .path = (char *)input_text("drawing", "rows.osm", osm), .layer = (char *)"lines",
		.plants = &lime, .plant_count = 1, .spacing_m = 10, .filters = &only, .filter_count = 1, .height_low_m = NAN, .height_high_m = NAN };
	struct eco_scatter *s;
	struct eco_scatter_place place, last = { 0 };
	uint32_t count = 0;
	assert_good(eco_scatter_open(&s, &spec, &frame, NULL, NULL, &cause));
	for (; eco_scatter_next(s, &place); last = place, count++)
		if (count)
			assert_true(fabs(hypot(place.at[0] - last.at[0], place.at[1] - last.at[1]) - 10) < 0.01);
	assert_int_equal(count, 11);         /* .001 degrees are 110.5 m */
	eco_scatter_close(s);
}
