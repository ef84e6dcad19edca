/* Footprints as people have them: heights in storeys and feet, absurd ones and none; what is left out is counted. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/land/footprints.h"
#include "tests/support/model_try.h"

static const struct eco_frame frame = { .crs = "EPSG:32617" };
static struct eco_footprints read_footprints;

#define HEAD \
	"{\"type\":\"FeatureCollection\",\"crs\":{\"type\":\"name\"," \
	"\"properties\":{\"name\":\"urn:ogc:def:crs:EPSG::32617\"}},\"features\":["
#define SQUARE "{\"type\":\"Polygon\",\"coordinates\":[[[0,0],[9,0],[9,9],[0,9],[0,0]]]}"
#define FEATURE(properties) "{\"type\":\"Feature\",\"properties\":{" properties "},\"geometry\":" SQUARE "}"

static char *features(const char *name, const char *text)
{
	char all[8192];
	snprintf(all, sizeof all, HEAD "%s]}", text);
	return (char *)input_text("footprints", name, all);
}

static struct eco_footprints_spec heights_of(char *path, const struct eco_footprint_height *heights,
	uint32_t count)
{
	struct eco_footprints_spec spec = { .path = path, .roof = "roof", .height_count = count };
	memcpy(spec.heights, heights, count * sizeof *heights);
	return spec;
}

static void take(const struct eco_footprints_spec *spec)
{
	read_footprints = (struct eco_footprints){ .items = NULL };
	assert_good(eco_footprints_read(&read_footprints, spec, &frame, &cause));
	import_said[0] = 0;
	eco_footprints_report(&read_footprints, import_note, NULL);
}

static void assert_footprint(uint32_t i, double height_m, bool to_eaves)
{
	assert_true(fabs(read_footprints.items[i].height_m - height_m) < 1e-9);
	assert_int_equal(read_footprints.items[i].to_eaves, to_eaves);
}

#define ROW(height, levels, roof) FEATURE("\"height\":" height ",\"levels\":" levels ",\"roof\":" roof)

UNIT_TEST(the_first_source_that_tells_a_height_counts)
{
	const struct eco_footprint_height sources[] = { { "height", 1, false, 0 },
		{ "levels", 3.2, true, 0 } };
	char *path = features("sources.geojson",
		ROW("\"12.5\"", "\"2\"", "\"gabled\"") "," ROW("null", "\"4\"",
			"\"flat\"") "," ROW("\"40 ft\"", "null", "null") "," ROW("\"0\"", "\"2\"",
			"\"dome\"") "," ROW("\"-3\"", "null", "null") "," ROW("\"9999\"", "\"0\"",
			"\"hipped\"") "," ROW("\"tall\"", "\"1.5\"", "null"));
	struct eco_footprints_spec spec = heights_of(path, sources, 2);
	take(&spec);
	assert_int_equal(read_footprints.areas.count, 7);
	assert_footprint(0, 12.5, false);
	assert_footprint(1, 12.8, true);
	assert_footprint(2, 40 * 0.3048, false);
	assert_footprint(3, 6.4, true);
	assert_footprint(4, ECO_BUILDING_M, false);
	assert_footprint(5, ECO_BUILDING_M, false);
	assert_footprint(6, 4.8, true);
	assert_int_equal(read_footprints.items[0].roof, ECO_ROOF_GABLED);
	assert_int_equal(read_footprints.items[5].roof, ECO_ROOF_HIPPED);
	assert_int_equal(read_footprints.items[3].roof, ECO_ROOF_FLAT);
	assert_non_null(strstr(import_said, "7 footprints of 7 features"));
	assert_non_null(strstr(import_said, "5 texts are no height of a building"));
	assert_non_null(strstr(import_said, "\"0\", feature 4"));
	assert_non_null(strstr(import_said, "2 of them are told no height: taken for 6 m"));
	assert_non_null(strstr(import_said, "first: \"dome\", feature 4"));
	eco_footprints_free(&read_footprints);
}

UNIT_TEST(columns_have_units_and_a_number_is_for_the_rest)
{
	const struct eco_footprint_height sources[] = { { "height", 0.3048, false, 0 },
		{ NULL, 1, false, 4.5 } };
	struct eco_footprints_spec spec =
		heights_of(features("units.geojson", ROW("30", "1", "null") "," ROW("null", "1", "null")),
			sources, 2);
	take(&spec);
	assert_footprint(0, 9.144, false);
	assert_footprint(1, 4.5, false);
	assert_null(strstr(import_said, "told no height"));
	assert_non_null(strstr(import_said, "1 of them have no height in a column"));
	assert_non_null(strstr(import_said, "is taken (first: feature 2)"));
	eco_footprints_free(&read_footprints);
}

UNIT_TEST(holes_and_parts_are_one_footprint_and_other_features_are_counted)
{
	char *path = features("shapes.geojson",
		"{\"type\":\"Feature\",\"properties\":{\"roof\":null},\"geometry\":{\"type\":\"MultiPolygon\",\"coordinates\":"
		"[[[[0,0],[9,0],[9,9],[0,9],[0,0]],[[2,2],[2,4],[4,4],[4,2],[2,2]]],[[[20,0],[29,0],[29,9],[20,0]]]]}},"
		"{\"type\":\"Feature\",\"properties\":{\"roof\":\"dome\"},\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[0,0],[5,5]]}},"
		"{\"type\":\"Feature\",\"properties\":{\"roof\":null},\"geometry\":null}");
	struct eco_footprints_spec spec = heights_of(path, NULL, 0);
	take(&spec);
	assert_int_equal(read_footprints.areas.count, 1);
	assert_int_equal(read_footprints.areas.items[0].ring_edges, 11);
	assert_footprint(0, ECO_BUILDING_M, false);
	assert_non_null(strstr(import_said, "1 of them are told no height"));
	assert_null(strstr(import_said, "dome")); /* no footprint has that roof */
	assert_non_null(strstr(import_said, "1 feature left out: not a polygon (first: feature 2)"));
	assert_non_null(strstr(import_said, "1 feature left out: no geometry (first: feature 3)"));
	eco_footprints_free(&read_footprints);
}

UNIT_TEST(degrees_become_metres_and_numbers_that_are_none_are_refused)
{
	struct eco_footprints_spec spec = {
		.path = (char *)input_text("footprints", "degrees.geojson",
			"{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"Polygon\","
			"\"coordinates\":[[[-81,38],[-80.999,38],[-80.999,38.001],[-81,38.001],[-81,38]]]}}]}")
	};
	take(&spec);
	const struct eco_area *area = &read_footprints.areas.items[0];
	assert_true(
		fabs(area->high[0] - area->low[0] - 88) < 2 && fabs(area->high[1] - area->low[1] - 111) < 1);
	eco_footprints_free(&read_footprints);
	spec.path = (char *)input_text("footprints", "no-degrees.geojson",
		"{\"type\":\"FeatureCollection\",\"features\":[" FEATURE(
			"") ",{\"type\":\"Feature\",\"properties\":{},\"geometry\":"
			    "{\"type\":\"Polygon\",\"coordinates\":[[[500000,4200000],[500009,4200000],[500009,4200009],[500000,4200000]]]}},"
			    "{\"type\":\"Feature\",\"properties\":{},\"geometry\":"
			    "{\"type\":\"Polygon\",\"coordinates\":[[[500000,4200000],[500009,4200000],[500009,4200009],[500000,4200000]]]}}]}");
	assert_code(eco_footprints_read(&read_footprints, &spec, &frame, &cause), ECO_BAD_INPUT,
		"cannot be degrees");
	eco_footprints_free(&read_footprints);
}

UNIT_TEST(a_file_without_polygons_or_columns_is_an_error_that_says_so)
{
	struct eco_footprints_spec spec = {
		.path = features("lines.geojson",
			"{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[0,0],[5,5]]}}")
	};
	assert_code(eco_footprints_read(&read_footprints, &spec, &frame, &cause), ECO_BAD_INPUT,
		"buildings are polygons");
	eco_footprints_free(&read_footprints);
	const struct eco_footprint_height source = { "hoehe", 1, false, 0 };
	spec = heights_of(features("columns.geojson", ROW("1", "1", "null")), &source, 1);
	assert_code(eco_footprints_read(&read_footprints, &spec, &frame, &cause), ECO_BAD_INPUT, "hoehe");
	eco_footprints_free(&read_footprints);
}

UNIT_MAIN(NULL, NULL)
