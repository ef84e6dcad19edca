/* Ground: rasters as they come, what they lack, and heights exactly on the triangles that are drawn. */
#include <math.h>

#include "ecofiles/import/ground/ground.h"
#include "tests/support/model_try.h"
#include "tests/support/raster_files.h"

/* A test's ground; the first NULL of `paths` ends them. */
struct given {
	const char *path, *paths[4], *crs, *scene_crs, *vertical, *scene_vertical;
	double origin[3], scale, offset, unit_m, nodata, corner[2], pixel[2];
	bool has_offset, has_nodata, no_holes, has_place;
	uint32_t side_max, band;
};

static enum eco_code import(struct eco_ground *ground, const struct given *g, struct eco_error *error)
{
	char *paths[4] = { (char *)g->path };
	struct eco_ground_source source = { .heights = paths, .height_count = g->path != NULL,
		.crs = (char *)g->crs,
		.vertical = (char *)g->vertical, .band = g->band, .scale = g->scale, .offset = g->offset,
		.unit_m = g->unit_m, .nodata = g->nodata,
		.has_offset = g->has_offset, .has_nodata = g->has_nodata, .no_holes = g->no_holes,
		.has_place = g->has_place,
		.corner = { g->corner[0], g->corner[1] }, .pixel = { g->pixel[0], g->pixel[1] } };
	struct eco_ground_options options = { .source = &source, .scene_crs = g->scene_crs,
		.scene_vertical = g->scene_vertical,
		.origin = { g->origin[0], g->origin[1], g->origin[2] }, .side_max = g->side_max,
		.warn = import_note };

	for (int i = 0; !g->path && i < 4 && g->paths[i]; i++)
		paths[source.height_count++] = (char *)g->paths[i];
	import_said[0] = 0;
	return eco_ground_import(ground, &options, error);
}

/* The ground that the test looks at; reading the next frees it. */
static struct eco_ground ground;

static void import_good(const struct given *g)
{
	eco_ground_free(&ground);
	assert_good(import(&ground, g, &cause));
}

static void import_fails(const struct given *g, const char *says)
{
	eco_ground_free(&ground);
	assert_code(import(&ground, g, &cause), ECO_CODE_COUNT, says);
	assert_null(ground.height_m);
}

/* 3 x 2 samples of 10 m, first row in the north. */
#define GRID "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 10\nNODATA_value -9999\n"

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

/* Wanted: the ground, or with "?" the words of a refusal. */
#define FILE_(name) "build/tmp/ground/" name
#define SCENE31 .scene_crs = "EPSG:32631", .origin = { 500000, 1000, 100 }
#define MAP_PLACE .no_holes = true, .has_place = true, .corner = { 100, 240 }, .pixel = { 10, 10 }
#define VERTICAL(crs_, scene_crs_, vertical_, scene_vertical_) { .path = "v.asc", .crs = crs_, \
	.scene_crs = scene_crs_, .vertical = vertical_, .scene_vertical = scene_vertical_ }
static const struct { const char *name, *text; struct given given; const char *wanted; } grounds[] = {
	{ "samples_lie_at_pixel_centres_from_the_south_west", GRID "11 12 13\n14.0 15 16\n",
		{ .path = "a.asc", .origin = { 90, 190, 10 } },
			"size=3,2|place=15,15,10,10|z0=4|z1=5|z2=6|z3=1|z4=2|z5=3|"
		"filled=0|~what its heights count from is not said" },
	{ "what_is_missing_grows_in_from_its_neighbours",
		"ncols 5\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1\n"
		"NODATA_value -9999\n7 -9999 -9999 -9999 -9999\n7 nan -3.4e38 -9999 -9999\n7.0 1e6 -9999 -9999 -9999\n",
		{ .path = "b.asc" }, "filled=12|all=7,7|~12 of 15 samples" },
	{ NULL, GRID "0 -9999 10\n0.0 -9999 10\n", { .path = "c.asc" }, "z1=5|z4=5" },
	{ "scale_offset_and_row_order_of_the_file_are_honoured", NULL, { .path = "north.tif", SCENE31 },
		"place=5,5,10,10|size=2,3|z0=5|z1=6|z4=1" },
	{ NULL, NULL, { .path = "south.tif", SCENE31 }, "place=5,5,10,10|z0=1|z5=6" },
	/* Mercator: metres too, but another place; about 20 columns in: 100 m + 0.5 * 10 * 19.5 */
	{ "a_crs_is_converted_and_never_guessed", NULL, { .path = "utm.tif", .scene_crs = "EPSG:3857",
		.origin = { 333958.5, 1000, 0 } }, "at=200,150,197.5,5" },
	/* stated and contained agree: no warning of that kind */
	{ NULL, NULL, { .path = "utm.tif", .crs = "EPSG:32631", .scene_crs = "EPSG:3857",
		.origin = { 333958.5, 1000, 0 } },
		"!which is used" },
	{ NULL, NULL, { .path = "utm.tif", .crs = "EPSG:32632", .scene_crs = "EPSG:3857",
		.origin = { 333958.5, 1000, 0 } },
		"~which is used" },
	{ NULL, NULL, { .path = "none.tif", .scene_crs = "EPSG:32631" },
		"?the file has no CRS; say it in the scene: "
		"\"ground\": {\"heights\": ..., \"crs\": \"EPSG:32631\"}" },
	{ NULL, NULL, { .path = "none.tif", .crs = "EPSG:99999999", .scene_crs = "EPSG:32631" },
		"?the CRS \"EPSG:99999999\" is not known" },
	{ NULL, NULL, { .path = "none.tif", .crs = "EPSG:32631", .scene_crs = "EPSG:4326" },
		"?not one in metres" },
	{ NULL, NULL, { .path = "utm.tif" }, "?the scene has no CRS" },
	{ "a_raster_that_is_too_large_is_averaged_down", NULL, { .path = "large.tif", .side_max = 16,
		.origin = { 500000, 1000, 100 } },
		"size=16,16|place=20,10,40,20|z0=0.75|z17=2.75|~averaged down to 16 x 16" },
	{ "what_is_no_raster_is_refused", "version https://git-lfs.github.com/spec/v1\n",
		{ .path = "lfs.tif" },
		"?lfs.tif: a pointer of Git LFS" },
	{ NULL, "", { .path = "empty.tif" }, "?empty.tif: the file is empty" },
	{ NULL, "not a raster", { .path = "text.tif" }, "?not a raster that GDAL can read" },
	{ NULL, "ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n5\n", { .path = "one.asc" },
		"?at least 2 x 2" },
	{ NULL, GRID "-9999 -9999 -9999\n-9999 -9999 -9999\n", { .path = "void.asc" }, "?no height at all" },
	{ NULL, NULL, { .path = "gone.tif" }, "?gone.tif: No such file" },
	/* a height map as pictures have it: sixteen bits, no place, no scale */
	{ "a_png_takes_its_meaning_from_the_scene", NULL, { .path = "map.png", .no_holes = true },
		"?add to the ground \"north_west\": [x, y]" },
	{ NULL, NULL, { .path = "map.png", MAP_PLACE },
		"~heights from 0 to 65535 m are not of this Earth|place=105,205,10,10|z0=3|z15=65535" },
	{ NULL, NULL, { .path = "map.png", MAP_PLACE, .scale = 0.001, .offset = 273.5, .has_offset = true },
		"!not of this Earth|z13=274.5|z15=339.035" },
	/* feet: scale and offset first */
	{ NULL, NULL, { .path = "map.png", MAP_PLACE, .scale = 0.001, .offset = 273.5, .has_offset = true,
		.unit_m = 0.3048 },
		"z13=83.6676" },
	{ "a_world_file_says_where_a_picture_lies", NULL, { .path = "world.png" },
		"place=1001,2001,2,2|z0=8" },
	{ "units_of_the_file_are_converted_and_said", NULL, { .path = "feet.tif" },
		"z12=304.8006096|~units of 0.3048006" },
	{ NULL, NULL, { .path = "feet.tif", .unit_m = 1 }, "z12=1000" },
	{ "a_band_is_chosen_and_colours_are_no_heights", NULL, { .path = "bands.tif" },
		"?it holds colours, not heights" },
	{ NULL, NULL, { .path = "bands.tif", .band = 4 }, "?it has 3 bands, not a band 4" },
	{ NULL, NULL, { .path = "bands.tif", .band = 2 }, "z0=2" },
	{ "holes_within_holes_are_found", NULL, { .path = "within.tif" },
		"filled=240|all=300,600|~stand out" },
	{ "seas_are_no_holes", NULL, { .path = "sea.tif" }, "filled=0|!stand out" },
	{ "ground_that_is_all_one_is_said", GRID "7 7 7\n7.0 7 7\n", { .path = "flat.asc" },
		"~every height is 7 m" },
	{ "rasters_side_by_side_become_one_ground", NULL, { .paths = { FILE_("west.tif"), FILE_("east.tif") },
		.no_holes = true }, "size=8,4|place=5,5,10,10|filled=0|z0=100|z3=103|z4=104|z7=107|z31=107" },
	/* a finer one beside them: all at its resolution, the others resampled */
	{ NULL, NULL, { .paths = { FILE_("west.tif"), FILE_("east.tif"), FILE_("fine.tif") },
		.no_holes = true },
		"size=24,8|place=2.5,2.5,5,5|at=10,20,100.5,0.3|at=38,20,103.3,0.3|at=45,20,104,0.3|at=80,20,107.5,0.3|"
		"at=108,20,110.3,0.3" },
	/* where two have a height, the first counts */
	{ NULL, NULL, { .paths = { FILE_("over.tif"), FILE_("west.tif") }, .no_holes = true }, "z5=9" },
	{ NULL, NULL, { .paths = { FILE_("over.tif"), FILE_("gone.tif") }, .no_holes = true },
		"?gone.tif: No such file" },
	/* rows from the south, and degrees: the way of most global models; ten rows
	 * are a hundredth of a degree */
	{ "degrees_and_turned_rasters_are_resampled", NULL, { .path = "degrees.tif",
		.scene_crs = "EPSG:32632",
		.origin = { 500000, 5316000, 0 } }, "at=0,0,542.2,0.25|at=0,1112,532.2,0.25" },
	/* its centre */
	{ NULL, NULL, { .path = "turned.tif", .no_holes = true }, "at=420,500,529.5,1" },
	{ "one_vertical_datum_without_the_other_is_an_error", GRID "1 2 3\n4 5 6\n", { .path = "v.asc" },
		"~add \"vertical\" to the scene and to its ground" },
	{ NULL, NULL, VERTICAL(NULL, NULL, "EPSG:5703", NULL),
		"?add \"vertical\": \"EPSG:5703\" to the scene" },
	{ NULL, NULL, VERTICAL(NULL, NULL, "EPSG:5703", "EPSG:5703"), "!vertical" },
	{ NULL, NULL, VERTICAL(NULL, NULL, "NAVD88 height", "EPSG:5703"), "!vertical" },
		    /* the same by name */
	{ NULL, NULL, VERTICAL(NULL, NULL, "EPSG:5773", "EPSG:5703"), "?no conversion is at hand" },
	{ NULL, NULL, VERTICAL(NULL, NULL, NULL, "EPSG:5703"),
		"?add \"vertical\": \"EPSG:5703\" to the ground" },
	/* a compound CRS states one too */
	{ NULL, NULL, VERTICAL("EPSG:32632", "EPSG:32632+5773", NULL, NULL),
		"?add \"vertical\": \"EGM96 height\" to the ground" },
	{ NULL, NULL, VERTICAL("EPSG:32632+5773", "EPSG:32632+5773", NULL, NULL), "!vertical" },
};

UNIT_TEST(rasters_become_ground_or_questions)
{
	const char *name = "";
	for (size_t i = 0; i < sizeof rasters / sizeof *rasters; i++)
		raster_file_write("ground", &rasters[i]);
	remove(FILE_("map.png.aux.xml"));
	remove(FILE_("world.png.aux.xml"));
	input_text("ground", "world.pgw", "2\n0\n0\n-2\n1001\n2007\n");
	for (size_t i = 0; i < sizeof grounds / sizeof *grounds; i++) {
		struct given g = grounds[i].given;
		name = grounds[i].name ? grounds[i].name : name;
		print_message("# %s, %s\n", name, grounds[i].wanted);
		if (grounds[i].text)
			input_text("ground", g.path, grounds[i].text);
		g.path = g.path ? input_path("ground", g.path) : NULL;
		if (*grounds[i].wanted == '?') {
			import_fails(&g, grounds[i].wanted + 1);
			continue;
		}
		import_good(&g);
		expect_told(grounds[i].wanted, tell);
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
	import_good(&(struct given){ .path = raster_file_write("ground", &(struct raster_file){ "slope.tif",
		SIDE, SIDE,
		.sample = slope, .type = GDT_Float32, .place = PLACE(0, 1, SIDE), .has_nodata = true,
		.nodata = -9999 }) });
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
		const char *path = raster_file_write("ground", &(struct raster_file){ "holes.tif", HOLES_SIDE,
			HOLES_SIDE,
			.sample = holes, .of = values[k], .type = GDT_Float32, .place = PLACE(0, 1,
			HOLES_SIDE) });
		import_good(&(struct given){ .path = path });
		expect_told(absurd ? "filled=37|all=380,500" : "filled=37|all=380,500|~stand out", tell);
		if (absurd)
			continue;
		import_good(&(struct given){ .path = path, .no_holes = true });
		expect_told("filled=0", tell);
		import_good(&(struct given){ .path = path, .has_nodata = true, .nodata = values[k] });
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
