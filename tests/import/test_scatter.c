/* Scattered plants: numbers, distances, holes, filters; nothing depends on the order of the file. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"
#include "ecofiles/import/land/scatter.h"
#include "tests/support/cases.h"
#include "tests/support/model_try.h"

static const struct eco_frame frame = { .crs = "EPSG:32617" };
static struct eco_scatter_plant two[] = { { 0, 1, 300 }, { 1, 1, 100 } };

struct scattered { struct eco_scatter_place *places; uint32_t count, room; };

static struct scattered scatter(const struct eco_scatter_spec *spec)
{
	struct eco_scatter *s;
	struct eco_scatter_place place;
	struct scattered out = { .count = 0 };
	assert_good(eco_scatter_open(&s, spec, &frame, NULL, NULL, &cause));
	while (eco_scatter_next(s, &place)) {
		assert_true(eco_array_grow(&out.places, &out.room, out.count, sizeof place));
		out.places[out.count++] = place;
	}
	import_said[0] = 0;
	eco_scatter_report(s, import_note, NULL);
	eco_scatter_close(s);
	return out;
}

#define HEAD "{\"type\":\"FeatureCollection\",\"crs\":{\"type\":\"name\"," \
	"\"properties\":{\"name\":\"urn:ogc:def:crs:EPSG::32617\"}},\"features\":["
#define FIELD "{\"type\":\"Feature\",\"properties\":{\"kind\":\"field\",\"n\":77,\"d\":20}," \
	"\"geometry\":{\"type\":\"Polygon\",\"coordinates\":" \
	"[[[0,0],[200,0],[200,100],[0,100],[0,0]],[[50,25],[50,75],[150,75],[150,25],[50,25]]]}}"
#define CORNER "{\"type\":\"Feature\",\"properties\":{\"kind\":\"corner\",\"n\":5,\"d\":400}," \
	"\"geometry\":{\"type\":\"Polygon\",\"coordinates\":" \
	"[[[200,0],[300,0],[200,100],[200,0]]]}}"
#define LINE "{\"type\":\"Feature\",\"properties\":{\"kind\":\"line\"}," \
	"\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[0,0],[9,9]]}}"
#define UNTOLD "{\"type\":\"Feature\",\"properties\":{\"kind\":\"field\"},\"geometry\":{\"type\":\"Polygon\"," \
	"\"coordinates\":[[[0,0],[9,0],[9,9],[0,0]]]}}"
#define NOTHING "{\"type\":\"Feature\",\"properties\":{\"kind\":\"nothing\"},\"geometry\":null}"

static char *areas(const char *name, const char *features)
{
	char text[4096];
	snprintf(text, sizeof text, HEAD "%s]}", features);
	return (char *)input_text("scatter", name, text);
}

static struct eco_scatter_spec spec_of(char *path)
{
	return (struct eco_scatter_spec){ .path = path, .crs = "EPSG:32617", .plants = two, .plant_count = 2,
		.height_low_m = NAN, .height_high_m = NAN,
		.seed = 1 };
}

static size_t count_of(const struct scattered *s, uint32_t plant)
{
	size_t count = 0;
	for (size_t i = 0; i < s->count; i++)
		count += s->places[i].plant == plant;
	return count;
}

static double nearest(const struct scattered *s)
{
	double least = INFINITY;
	for (size_t i = 0; i < s->count; i++)
		for (size_t j = 0; j < i; j++)
			least = fmin(least,
				hypot(s->places[i].at[0] - s->places[j].at[0],
				s->places[i].at[1] - s->places[j].at[1]));
	return least;
}

UNIT_TEST(numbers_are_those_asked_for_and_nothing_stands_in_holes)
{
	struct eco_scatter_spec spec = spec_of(areas("field.geojson", FIELD));
	struct scattered s = scatter(&spec);

	/* 1.5 ha of 400 plants each, three of the first kind for each of the second */
	assert_int_equal(s.count, 600);
	assert_in_range(count_of(&s, 0), 449, 451);
	for (size_t i = 0; i < s.count; i++) {
		double x = s.places[i].at[0], y = s.places[i].at[1];
		assert_true(x >= 0 && x <= 200 && y >= 0 && y <= 100
			&& !(x > 50 && x < 150 && y > 25 && y < 75));
		assert_true(isnan(s.places[i].height_m));
	}
	/* random places would come within 0.2 m */
	assert_true(nearest(&s) > 0.5 * sqrt(2 / (sqrt(3.0) * 0.04)));
	free(s.places);
}

static int place_order(const void *a, const void *b)
{
	return memcmp(((const struct eco_scatter_place *)a)->at, ((const struct eco_scatter_place *)b)->at,
		sizeof ((struct eco_scatter_place *)0)->at);
}

UNIT_TEST(the_order_of_the_file_does_not_matter)
{
	struct eco_scatter_spec first = spec_of(areas("ab.geojson", FIELD "," CORNER)),
		second = spec_of(areas("ba.geojson", CORNER "," FIELD));
	struct scattered a, b;
	first.distance_m = second.distance_m = 3;
	a = scatter(&first);
	b = scatter(&second);
	assert_int_equal(a.count, b.count);
	qsort(a.places, a.count, sizeof *a.places, place_order);
	qsort(b.places, b.count, sizeof *b.places, place_order);
	for (size_t i = 0; i < a.count; i++)
		assert_true(memcmp(a.places[i].at, b.places[i].at, sizeof a.places[i].at) == 0
			&& a.places[i].plant == b.places[i].plant);
	free(a.places);
	free(b.places);
}

UNIT_TEST(what_is_to_be_clear_is_clear)
{
	struct eco_scatter_spec spec = spec_of(areas("clear.geojson", FIELD));
	struct scattered s;
	spec.clear_of = areas("road.geojson", "{\"type\":\"Feature\",\"properties\":{},"
		"\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[0,10],[200,10]]}},"
		"{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"Polygon\","
		"\"coordinates\":[[[0,80],[20,80],[20,100],[0,100],[0,80]]]}}");
	spec.clear_m = 5;
	spec.height_low_m = 2;
	spec.height_high_m = 3;
	s = scatter(&spec);
	/* 600, less by the strip of 200 m x 10 m and the corner of 25 m x 25 m without its rounding, of
	 * 15,000 m2 */
	assert_in_range(s.count, 600 - 80 - 25 - 10, 600 - 80 - 25 + 10);
	for (size_t i = 0; i < s.count; i++) {
		assert_true(fabs(s.places[i].at[1] - 10) >= 5);
		assert_false(s.places[i].at[0] < 25 && s.places[i].at[1] > 75
			&& hypot(fmax(s.places[i].at[0] - 20, 0), fmax(80 - s.places[i].at[1], 0)) < 5);
		assert_true(s.places[i].height_m >= 2 && s.places[i].height_m <= 3);
	}
	free(s.places);
	spec.count_column = "n";
	s = scatter(&spec);
	assert_int_equal(s.count, 77);               /* a number is meant for the whole area */
	free(s.places);
}

UNIT_TEST(errors_say_what_to_do)
{
	struct row { const char *name, *text, *says; };
	uint32_t count;
	const struct row *wrong = cases_rows("tests/import/cases/scatter_faults.tsv", "sss", sizeof *wrong,
		&count);
	struct eco_scatter *s;
	for (size_t i = 0; i < count; i++) {
		struct eco_scatter_spec spec =
			spec_of((char *)input_text("scatter", wrong[i].name, wrong[i].text));
		struct eco_error error = { .code = ECO_OK };
		assert_int_not_equal(eco_scatter_open(&s, &spec, &frame, NULL, NULL, &error), ECO_OK);
		assert_null(s);
		assert_int_equal(eco_scatter_check(&spec, &frame, NULL), error.code);
		if (!strstr(error.text, wrong[i].says))
			fail_msg("%s: %s", wrong[i].name, error.text);
	}
}

#define POLYGON(corners) "{\"type\":\"Feature\",\"properties\":{},\"geometry\":{\"type\":\"Polygon\"," \
	"\"coordinates\":[[" corners "]]}}"
#define ALL FIELD "," CORNER "," LINE "," NOTHING

static struct eco_value values[] = { { "field", 0 }, { "li*", 0 }, { "nothing", 0 } };
static struct eco_filter only = { "kind", true, values, 3, 0, 0 };

static const struct { const char *name, *features, *count_column, *density_column; struct eco_filter *filter; double distance_m;
	uint32_t low, high; const char *says; } rows[] = {
	{ "columns_say_how_many", ALL, "n", NULL, NULL, 0, 82, 82,
		"~82 plants of 82 wanted|~1 feature left out: not a polygon (first: feature 3)" },
	{ NULL, ALL "," UNTOLD, "n", NULL, NULL, 0, 82, 82,
		"~1 feature left out: no usable number in its column (first: feature 5)" },
	/* 1.5 ha of 20, half a hectare of 400 */
	{ NULL, ALL, NULL, "d", NULL, 0, 229, 231, "" },
	{ "what_is_left_out_is_counted_by_reason", ALL, NULL, NULL, &only, 0, 600, 600, "~1 feature left out: not a polygon "
		"(first: feature 3)|~1 feature left out: no geometry (first: feature 4)|~1 feature left out: left out by only "
		"or skip (first: feature 2)" },
	{ "distances_hold_and_what_has_no_room_is_said", FIELD "," CORNER, NULL, NULL, NULL, 4, 501, 800, "" },
	{ NULL, FIELD "," CORNER, NULL, NULL, NULL, 30, 10, 60, "~2 areas have no room" },
	{ "what_is_too_far_is_said", FIELD "," POLYGON("[0,0],[1e200,0],[0,1e200],[0,0]"), NULL, NULL, NULL, 0, 600, 600,
		"~1 feature left out: more than 10,000 km from the origin (first: feature 2)" },
};

UNIT_TEST(areas_get_the_plants_that_are_wanted_and_fit)
{
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct eco_scatter_spec spec = spec_of(areas("rows.geojson", rows[i].features));
		spec.count_column = (char *)rows[i].count_column;
		spec.density_column = (char *)rows[i].density_column;
		spec.filters = rows[i].filter;
		spec.filter_count = rows[i].filter != NULL;
		spec.distance_m = rows[i].distance_m;
		struct scattered s = scatter(&spec);
		assert_in_range(s.count, rows[i].low, rows[i].high);
		assert_true(nearest(&s) >= rows[i].distance_m);
		expect_told(rows[i].says, NULL);
		free(s.places);
	}
}

UNIT_TEST(what_is_too_much_is_refused)
{
	struct eco_scatter_spec spec = spec_of(areas("large.geojson", POLYGON("[0,0],[9e6,0],[9e6,9e6],[0,0]")));
	struct eco_scatter *none;
	assert_code(eco_scatter_open(&none, &spec, &frame, NULL, NULL, &cause), ECO_TOO_LARGE,
		"more than 100000000 plants; take lower densities");
}
