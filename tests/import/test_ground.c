/* Ground: rasters as they come, what they lack, and heights exactly on the triangles that are drawn. */
#include <math.h>

#include "ecofiles/import/ground/ground.h"
#include "ecofiles/scene/scene.h"
#include "tests/support/cases.h"
#include "tests/support/model_try.h"
#include "tests/support/raster_files.h"

/* The ground that the test looks at; reading the next frees it. */
static struct eco_ground ground;

/* Reads the ground of a scene with these members. */
static enum eco_code import(const char *scene, uint32_t side_max)
{
	char text[1000];
	struct eco_source source;
	cause = (struct eco_error){ 0 };
	import_said[0] = 0;
	eco_ground_free(&ground);
	snprintf(text, sizeof text, "{%s, \"plants\": {}}", scene);
	ECO_PASS(eco_source_parse(&source, text, strlen(text), "build/tmp/ground/scene.json", false,
		&cause));
	enum eco_code code = eco_ground_import(&ground, &(struct eco_ground_options){ .source = &source.ground,
		.scene_crs = source.crs, .scene_vertical = source.vertical,
		.origin = { source.origin[0], source.origin[1], source.origin[2] }, .side_max = side_max,
		.warn = import_note }, &cause);
	eco_source_free(&source);
	return code;
}

static void import_good(const char *scene, uint32_t side_max)
{
	enum eco_code code = import(scene, side_max);
	if (code)
		fail_msg("%s: %s", scene, cause.text);
}

static double terrain(int x, int y)
{
	return 400 + 3 * sin(x * 0.4) + 2 * cos(y * 0.3 + x * 0.1) + 0.05 * x * y;
}

static double plane(const struct raster_file *r, int x, int y, int band)
{
	return r->of + (r->unit ? x + 4 * y : r->columns == 2 ? 2 * (x + 2 * y) : x);
}
static double by_rows(const struct raster_file *r, int x, int y, int band) { return r->of + y; }
static double steep(const struct raster_file *r, int x, int y, int band) { return 10 * x; }
static double fine(const struct raster_file *r, int x, int y, int band) { return 108 + (x - 0.5) * 0.5; }
static double nine(const struct raster_file *r, int x, int y, int band) { return 9; }
static double map(const struct raster_file *r, int x, int y, int band)
{
	static const double first[] = { 0, 1000, 2000, 65535 };
	return y ? y : first[x];
}
/* -32768 meets nothing but 0, which stands out itself. */
static double within(const struct raster_file *r, int x, int y, int band)
{
	return x < 4 ? -32768 : x < 6 ? 0 : terrain(x, y);
}

static double holes(const struct raster_file *r, int x, int y, int band)
{
	return (x > 10 && x < 15 && y > 20 && y < 30) || (x == 30 && y == 3) ? r->of : terrain(x, y);
}
/* Terrain that goes down to about 0: below the sea's level all is 0. */
static double sea(const struct raster_file *r, int x, int y, int band) { return fmax(terrain(x, y) - 407,
	0); }

#define HOLES_SIDE 40
#define UTM31(north, step) (const double[]){ 500000, 10, 0, north, 0, step }
#define PLACE(west, step, north) (const double[]){ west, step, 0, north, 0, -(step) }
#define SCALED .type = GDT_Int16, .scale = 0.5, .offset = 100, .has_nodata = true, .nodata = -1
static const struct raster_file rasters[] = {
	{ "north.tif", 2, 3, .sample = plane, .of = 2, .place = UTM31(1030, -10), .crs = "EPSG:32631",
		SCALED },
	{ "south.tif", 2, 3, .sample = plane, .of = 2, .place = UTM31(1000, 10), .crs = "EPSG:32631",
		SCALED },
	{ "utm.tif", 40, 30, .sample = steep, .place = UTM31(1300, -10), .crs = "EPSG:32631", SCALED },
	{ "none.tif", 40, 30, .sample = steep, .place = UTM31(1300, -10), SCALED },
	{ "large.tif", 64, 32, .sample = plane, .place = UTM31(1320, -10), SCALED },
	{ "map.png", 4, 4, .sample = map, .type = GDT_UInt16 },
	{ "world.png", 4, 4, .sample = by_rows, .of = 5, .type = GDT_UInt16 },
	{ "feet.tif", 4, 4, .sample = plane, .of = 1000, .type = GDT_Float32, .place = PLACE(0, 10, 40),
		.unit = "US survey foot" },
	{ "bands.tif", 2, 2, 3, GDT_Byte, .sample = by_rows, .of = 1, .place = PLACE(0, 10, 40) },
	{ "within.tif", HOLES_SIDE, HOLES_SIDE, .sample = within, .type = GDT_Float32, .place = PLACE(0, 1,
		HOLES_SIDE) },
	{ "sea.tif", HOLES_SIDE, HOLES_SIDE, .sample = sea, .type = GDT_Float32, .place = PLACE(0, 1,
		HOLES_SIDE) },
	{ "west.tif", 4, 4, .sample = plane, .of = 100, .type = GDT_Float32, .place = PLACE(0, 10, 40) },
	{ "east.tif", 4, 4, .sample = plane, .of = 104, .type = GDT_Float32, .place = PLACE(40, 10, 40) },
	{ "fine.tif", 8, 8, .sample = fine, .type = GDT_Float32, .place = PLACE(80, 5, 40) },
	{ "over.tif", 4, 4, .sample = nine, .type = GDT_Float32, .place = PLACE(0, 10, 40) },
	{ "degrees.tif", 60, 60, .sample = by_rows, .of = 500, .type = GDT_Float32, .place = PLACE(8.99,
		0.001, 48.04),
		.crs = "EPSG:4326" },
	{ "turned.tif", 60, 60, .sample = by_rows, .of = 500, .type = GDT_Float32,
		.place = (const double[]){ 0, 7, 7, 500, 7, -7 } },
};

/* Heights by number; "at=x,y,z,most": the ground at (x, y) is within `most` of z; "all=low,high": all heights
 * are between these. */
static void tell(const char *key, uint32_t number, const char *wanted, char *to, size_t size)
{
	double at[4] = { 0 }, z = NAN, low = INFINITY, high = -INFINITY;
	sscanf(wanted, "%lf,%lf,%lf,%lf", &at[0], &at[1], &at[2], &at[3]);
	for (uint32_t i = 0; i < ground.columns * ground.rows; i++) {
		low = fmin(low, (double)ground.height_m[i]);
		high = fmax(high, (double)ground.height_m[i]);
	}
	*to = 0;
	if (strcmp(key, "size") == 0)
		snprintf(to, size, "%u,%u", ground.columns, ground.rows);
	else if (strcmp(key, "place") == 0)
		snprintf(to, size, "%.9g,%.9g,%.9g,%.9g", ground.x_m, ground.y_m, ground.step_x_m,
			ground.step_y_m);
	else if (strcmp(key, "filled") == 0)
		snprintf(to, size, "%u", (unsigned)ground.filled);
	else if (strcmp(key, "z") == 0 && number < ground.columns * ground.rows)
		snprintf(to, size, "%.9g", (double)ground.height_m[number]);
	else if (strcmp(key, "all") == 0)
		snprintf(to, size, low >= at[0] && high <= at[1] ? "%s" : "other than %s", wanted);
	else if (strcmp(key, "at") == 0 && eco_ground_height(&ground, at[0], at[1], &z)
		&& fabs(z - at[2]) <= at[3])
		snprintf(to, size, "%s", wanted);
	else
		snprintf(to, size, "%.9g", z);
}

#define FILE_(name) "build/tmp/ground/" name

UNIT_TEST(rasters_become_ground_or_questions)
{
	struct ground_case { const char *name, *text, *scene, *side, *wanted; };
	char file[64];
	uint32_t count;
	const struct ground_case *rows = cases_read("tests/import/cases/ground.tsv", sizeof *rows, &count);
	for (size_t i = 0; i < sizeof rasters / sizeof *rasters; i++)
		raster_file_write("ground", &rasters[i]);
	remove(FILE_("map.png.aux.xml"));
	remove(FILE_("world.png.aux.xml"));
	input_text("ground", "world.pgw", "2\n0\n0\n-2\n1001\n2007\n");
	for (uint32_t i = 0; i < count; i++) {
		const char *scene = rows[i].scene, *path = strstr(scene, "\"heights\": \"");
		uint32_t side_max = (uint32_t)atoi(rows[i].side);
		print_message("# %s, %s\n", *rows[i].name ? rows[i].name : "...", rows[i].wanted);
		if (rows[i].text && path && sscanf(path, "\"heights\": \"%63[^\"]", file) == 1)
			input_text("ground", file, rows[i].text);
		if (*rows[i].wanted == '?') {
			assert_code(import(scene, side_max), ECO_CODE_COUNT, rows[i].wanted + 1);
			assert_null(ground.height_m);
		} else {
			import_good(scene, side_max);
			expect_told(rows[i].wanted, tell);
		}
	}
}

/* ---- Holes that nothing marks ---- */

static double slope(const struct raster_file *r, int x, int y, int band)
{
	return x > 6 && x < 16 && y > 8 && y < 18 ? r->nodata : 0.5 * x - 0.25 * y;
}

/* A slope with a hole is a slope again: no crease where what grew in from two sides meets. */
UNIT_TEST(a_hole_in_a_slope_is_levelled)
{
	enum { SIDE = 24 };
	raster_file_write("ground", &(struct raster_file){ "slope.tif", SIDE, SIDE, .sample = slope, .type = GDT_Float32,
		.place = PLACE(0, 1, SIDE), .has_nodata = true, .nodata = -9999 });
	import_good("\"ground\": {\"heights\": \"slope.tif\"}", 0);
	assert_int_equal(ground.filled, 81);
	for (uint32_t y = 1; y + 1 < SIDE; y++)
		for (uint32_t x = 1; x + 1 < SIDE; x++) {
			const float *at = &ground.height_m[y * SIDE + x];
			assert_true(fabs(at[-1] - 2.0 * at[0] + at[1]) < 0.1
				&& fabs(at[-SIDE] - 2.0 * at[0] + at[SIDE]) < 0.1);
		}
}

UNIT_TEST(constants_that_stand_out_are_holes)
{
	static const double values[] = { 0, -9999, -3.4028234663852886e38, 32767, -32768, 12345, -1, 65535 };
	for (size_t k = 0; k < sizeof values / sizeof *values; k++) {
		bool absurd = fabs(values[k]) > 1e6;         /* no height in any case */
		char told[100];
		raster_file_write("ground", &(struct raster_file){ "holes.tif", HOLES_SIDE, HOLES_SIDE, .sample = holes,
			.of = values[k], .type = GDT_Float32, .place = PLACE(0, 1, HOLES_SIDE) });
		import_good("\"ground\": {\"heights\": \"holes.tif\"}", 0);
		expect_told(absurd ? "filled=37|all=380,500" : "filled=37|all=380,500|~stand out", tell);
		if (absurd)
			continue;
		import_good("\"ground\": {\"heights\": \"holes.tif\", \"nodata\": null}", 0);
		expect_told("filled=0", tell);
		snprintf(told, sizeof told, "\"ground\": {\"heights\": \"holes.tif\", \"nodata\": %.17g}", values[k]);
		import_good(told, 0);
		expect_told("filled=37|!stand out", tell);
	}
}

/* ---- Heights ---- */

UNIT_TEST(heights_lie_on_the_triangles_from_south_west_to_north_east)
{
	float samples[] = { 0, 10, 20, 0, 100, 0 };          /* sw 0, se 10; nw 0, ne 100 in the first cell */
	struct eco_ground g = { .columns = 3, .rows = 2, .x_m = -1, .y_m = 2, .step_x_m = 2, .step_y_m = 4,
		.height_m = samples };
	static const struct { double x, y, z; bool inside; } cases[] = {
		{ -1, 2, 0, true }, { 1, 2, 10, true }, { 3, 2, 20, true }, { -1, 6, 0, true },
			{ 1, 6, 100, true }, { 3, 6, 0, true },
		{ 0, 4, 50, true },              /* on the diagonal: mean of its ends, not of four corners */
		{ 0.5, 3, 30, true },            /* u .75, v .25: 0 + .75 * 10 + .25 * 90 */
		{ -0.5, 5, 25, true },           /* u .25, v .75: 0 + .75 * 0 + .25 * 100 */
		{ -9, 2, 0, false }, { 9, 6, 0, false }, { 1, 99, 100, false }, { 1, -99, 10, false },
	};

	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		double z = -1;
		assert_int_equal(eco_ground_height(&g, cases[i].x, cases[i].y, &z), cases[i].inside);
		assert_true(z == cases[i].z);
	}
	/* a margin of two samples, 2 and 1 steps wide, around one cell */
	float wide[36];
	struct eco_ground beyond = { .columns = 6, .rows = 6, .margin = 2, .step_x_m = 1, .step_y_m = 1,
		.height_m = wide };
	for (int i = 0; i < 36; i++)
		wide[i] = (float)(10 * (i % 6) * (i / 6) + i % 6);
	static const struct { double x, y, z; bool inside; } rows[] = {
		{ 0.5, 0.25, 60, true },         /* 42 / 2 + 63 / 4 + 93 / 4 */
		{ 3, 2.5, 197, false },          /* 164 / 2 + 205 / 4 + 255 / 4 */
		{ 2.5, 3, 196.75, false },       /* 164 / 2 + 204 / 4 + 255 / 4 */
		{ -2, -2.5, 3, false },          /* 0 / 2 + 1 / 4 + 11 / 4 */
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		double z = -1;
		assert_int_equal(eco_ground_height(&beyond, rows[i].x, rows[i].y, &z), rows[i].inside);
		assert_true(z == rows[i].z);
	}
	for (double v = 0; v <= 1; v += 0.125) {             /* continuous across the cell border */
		double left, right;

		eco_ground_height(&g, 1 - 1e-9, 2 + 4 * v, &left);
		eco_ground_height(&g, 1 + 1e-9, 2 + 4 * v, &right);
		assert_true(fabs(left - right) < 1e-6);
	}
	assert_false(eco_ground_height(&g, NAN, 3, &(double){ 0 }));
}
