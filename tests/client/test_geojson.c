/* The plants of a view as GeoJSON: those that its picture shows, with as many pixels, where they stand on
 * Earth. Their rows: test_geojson.sh. */
#include <math.h>
#include <string.h>

#include "client-min/view_ask.h"
#include "tests/support/unit_test.h"
#include "tests/support/view_scene.h"

static struct scene_held held;
static struct view_picture picture;

static int make_picture(void **state)
{
	scene_open(state);
	held = scene_hold(&grove);
	scene_select(&held);
	picture = scene_draw(&held, false, VIEW_TINT_NONE);
	return 0;
}

static int free_picture(void **state)
{
	view_picture_free(&picture);
	scene_release(&held);
	return scene_close(state);
}

static json_t *make(const struct view_map *map)
{
	json_t *json;
	assert_good(view_geojson_make(&(struct view_geojson_job){ held.store, &held.selection, &picture, map,
					    NULL },
			  &json, &cause));
	return json;
}

static double number(const json_t *array, size_t i)
{
	return json_number_value(json_array_get(array, i));
}

static const json_t *property(const json_t *feature, const char *name)
{
	return json_object_get(json_object_get(feature, "properties"), name);
}

static const json_t *place_of(const json_t *feature)
{
	return json_object_get(json_object_get(feature, "geometry"), "coordinates");
}

UNIT_TEST(plants_are_those_of_the_picture)
{
	json_t *json = make(&(struct view_map){ .crs = "" });
	const json_t *feature;
	size_t i;
	uint64_t sum = (uint64_t)json_integer_value(json_object_get(json, "summary_pixels")),
		last = UINT64_MAX,
		all = 0;
	for (size_t k = 0; k < (size_t)picture.width * picture.height; k++)
		all += picture.owner[k] != 0;
	assert_true(sum > 0);
	json_array_foreach(json_object_get(json, "features"), i, feature)
	{
		uint64_t pixels = (uint64_t)json_integer_value(property(feature, "pixels"));
		assert_true(pixels > 0 && pixels <= last);
		sum += last = pixels;
		assert_true(strlen(json_string_value(property(feature, "drawn_as"))) > 0);
		assert_null(property(feature, "row"));
		/* without a CRS */
		for (size_t k = 0; k < 2; k++)
			assert_true(fabs(number(place_of(feature), k) - number(property(feature, "at_m"),
				k)) < 1e-4);
	}
	assert_true(i > 3);
	assert_int_equal(sum, all);
	json_decref(json);
}

/* On a zone's middle a metre of the map is 1 / 0.9996 of the ellipsoid's, and north is up. */
UNIT_TEST(places_are_longitude_and_latitude)
{
	static const struct view_map map = { .crs = "EPSG:32632", .at = { 500000, 5205000, 0 } };
	json_t *json = make(&map);
	const json_t *features = json_object_get(json, "features"), *feature;
	const double north = 46.999209 * M_PI / 180, e2 = 0.00669438, bend = 1 - e2 * sin(north) * sin(north),
		     east_m = 6378137 / sqrt(bend) * cos(north) * M_PI / 180 * 0.9996,
		     north_m = 6378137 * (1 - e2) / (bend * sqrt(bend)) * M_PI / 180 * 0.9996;
	size_t i;
	json_array_foreach(features, i, feature)
	{
		const json_t *at = property(feature, "at_m"), *degrees = place_of(feature),
			     *first = property(json_array_get(features, 0), "at_m"),
			     *first_degrees = place_of(json_array_get(features, 0));
		assert_true(fabs((number(degrees, 0) - 9) * east_m - number(at, 0)) < 0.01);
		assert_true(fabs(number(degrees, 1) - 46.9992) < 0.01);
		assert_true(fabs((number(degrees, 1) - number(first_degrees, 1)) * north_m -
				    (number(at, 1) - number(first, 1))) < 0.01);
	}
	json_decref(json);
}

UNIT_TEST(a_crs_that_is_none_is_an_error)
{
	static const struct view_map map = { .crs = "EPSG:7" };
	struct eco_error error = { 0 };
	json_t *json;
	const struct view_geojson_job job = { held.store, &held.selection, &picture, &map, NULL };
	assert_int_equal(view_geojson_make(&job, &json, &error), ECO_BAD_INPUT);
	assert_null(json);
	assert_non_null(strstr(error.text, "EPSG:7"));
}

UNIT_MAIN(make_picture, free_picture)
