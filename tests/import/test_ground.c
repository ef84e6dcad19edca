/* Ground: rasters as they come, what they lack, and heights exactly on the triangles that are drawn. */
#include <gdal.h>
#include <math.h>
#include <ogr_srs_api.h>

#include "ecofiles/import/ground/ground.h"
#include "tests/support/model_try.h"

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

UNIT_TEST(samples_lie_at_pixel_centres_from_the_south_west)
{
	static const float wanted[] = { 4, 5, 6, 1, 2, 3 };
	import_good(&(struct given){ .path = input_text("ground", "a.asc", GRID "11 12 13\n14.0 15 16\n"),
		.origin = { 90, 190, 10 } });
	assert_int_equal(ground.columns, 3);
	assert_int_equal(ground.rows, 2);
	assert_true(ground.x_m == 15 && ground.y_m == 15 && ground.step_x_m == 10 && ground.step_y_m == 10);
	assert_memory_equal(ground.height_m, wanted, sizeof wanted);
	assert_int_equal(ground.filled, 0);
	import_says("what its heights count from is not said");
}

UNIT_TEST(what_is_missing_grows_in_from_its_neighbours)
{
	import_good(&(struct given){ .path = input_text("ground", "b.asc", "ncols 5\nnrows 3\nxllcorner 0\n"
		"yllcorner 0\ncellsize 1\nNODATA_value -9999\n7 -9999 -9999 -9999 -9999\n7 nan -3.4e38 -9999 "
		"-9999\n7.0 1e6 -9999 -9999 -9999\n") });
	assert_int_equal(ground.filled, 12);
	for (int i = 0; i < 15; i++)
		assert_true(ground.height_m[i] == 7);
	import_says("12 of 15 samples");
	import_good(
		&(struct given){ .path = input_text("ground", "c.asc", GRID "0 -9999 10\n0.0 -9999 10\n") });
	assert_true(ground.height_m[1] == 5 && ground.height_m[4] == 5);
}

/* A slope with a hole is a slope again: no crease where what grew in from two sides meets. */
UNIT_TEST(a_hole_in_a_slope_is_levelled)
{
	enum { SIDE = 24 };
	char text[8192];
	size_t n = (size_t)snprintf(text, sizeof text, "ncols %d\nnrows %d\nxllcorner 0\nyllcorner "
		"0\ncellsize 1\nNODATA_value -9999\n", SIDE, SIDE);
	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++) {
			bool hole = x > 6 && x < 16 && y > 8 && y < 18;
			n += (size_t)snprintf(text + n, sizeof text - n, "%g%c",
				hole ? -9999 : 0.5 * x - 0.25 * y, x + 1 < SIDE ? ' ' : '\n');
		}
	import_good(&(struct given){ .path = input_text("ground", "slope.asc", text) });
	assert_int_equal(ground.filled, 81);
	for (uint32_t y = 1; y + 1 < SIDE; y++)
		for (uint32_t x = 1; x + 1 < SIDE; x++) {
			const float *at = &ground.height_m[y * SIDE + x];
			assert_true(fabs(at[-1] - 2.0 * at[0] + at[1]) < 0.1
				&& fabs(at[-SIDE] - 2.0 * at[0] + at[SIDE]) < 0.1);
		}
}

struct raster {
	const char *driver, *name, *crs, *unit;
	GDALDataType type;
	int columns, rows;
	const double *place;         /* NULL: none */
	const double *samples;
	bool scaled;                 /* height = sample * 0.5 + 100; -1 is none */
};

static const char *write_raster(const struct raster *r)
{
	const char *path = input_path("ground", r->name);
	bool copies = strcmp(r->driver, "GTiff") != 0;
	GDALAllRegister();
	remove(path);
	GDALDatasetH file = GDALCreate(GDALGetDriverByName(copies ? "MEM" : r->driver), path, r->columns,
		r->rows, 1, r->type, NULL);
	assert_non_null(file);
	GDALRasterBandH band = GDALGetRasterBand(file, 1);
	if (r->place)
		GDALSetGeoTransform(file, (double *)r->place);
	if (r->crs) {
		OGRSpatialReferenceH reference = OSRNewSpatialReference(NULL);
		OSRSetFromUserInput(reference, r->crs);
		GDALSetSpatialRef(file, reference);
		OSRDestroySpatialReference(reference);
	}
	if (r->scaled) {
		GDALSetRasterNoDataValue(band, -1);
		GDALSetRasterScale(band, 0.5);
		GDALSetRasterOffset(band, 100);
	}
	if (r->unit)
		GDALSetRasterUnitType(band, r->unit);
	assert_int_equal(GDALRasterIO(band, GF_Write, 0, 0, r->columns, r->rows, (void *)r->samples,
				 r->columns, r->rows, GDT_Float64, 0, 0),
		CE_None);
	if (copies)
		GDALClose(
			GDALCreateCopy(GDALGetDriverByName(r->driver), path, file, FALSE, NULL, NULL, NULL));
	GDALClose(file);
	return path;
}

static const char *write_floats(const char *name, int side, const double *samples, const double place[6],
	const char *crs)
{
	return write_raster(
		&(struct raster){ "GTiff", name, crs, NULL, GDT_Float32, side, side, place, samples, false });
}

/* A GeoTIFF of whole numbers with scale and offset; rows from the south if `south_up`. */
static const char *write_tiff(const char *name, bool south_up, int columns, int rows, const double *samples,
	const char *crs)
{
	const double place[6] = { 500000, 10, 0, south_up ? 1000 : 1000 + 10.0 * rows, 0,
		south_up ? 10 : -10 };
	return write_raster(
		&(struct raster){ "GTiff", name, crs, NULL, GDT_Int16, columns, rows, place, samples, true });
}

static const char *write_png(const char *name, const double *samples)
{
	return write_raster(
		&(struct raster){ "PNG", name, NULL, NULL, GDT_UInt16, 4, 4, NULL, samples, false });
}

UNIT_TEST(scale_offset_and_row_order_of_the_file_are_honoured)
{
	static const double samples[] = { 2, 4, 6, 8, 10, 12 };
	struct given o = { .scene_crs = "EPSG:32631", .origin = { 500000, 1000, 100 } };
	o.path = write_tiff("north.tif", false, 2, 3, samples, "EPSG:32631");
	import_good(&o);
	assert_true(ground.x_m == 5 && ground.y_m == 5 && ground.columns == 2 && ground.rows == 3);
	assert_true(ground.height_m[0] == 5 && ground.height_m[1] == 6 && ground.height_m[4] == 1);
	o.path = write_tiff("south.tif", true, 2, 3, samples, "EPSG:32631");
	import_good(&o);
	assert_true(ground.y_m == 5 && ground.height_m[0] == 1 && ground.height_m[5] == 6);
}

UNIT_TEST(a_crs_is_converted_and_never_guessed)
{
	static double samples[40 * 30];
	struct given o = { .scene_crs = "EPSG:32631", .origin = { 500000, 1000, 0 } };
	double z;
	for (int i = 0; i < 40 * 30; i++)
		samples[i] = i % 40 * 10;
	o.path = write_tiff("utm.tif", false, 40, 30, samples, "EPSG:32631");
	o.scene_crs = "EPSG:3857";           /* Mercator: metres too, but another place */
	o.origin[0] = 333958.5;
	o.origin[1] = 1000;
	import_good(&o);
	/* about 20 columns in: 100 m + 0.5 * 10 * 19.5 */
	assert_true(eco_ground_height(&ground, 200, 150, &z));
	assert_true(fabs(z - 197.5) < 5);
	o.crs = "EPSG:32631";                /* stated and contained agree: no warning of that kind */
	import_good(&o);
	assert_null(strstr(import_said, "which is used"));
	o.crs = "EPSG:32632";
	import_good(&o);
	import_says("which is used");

	o = (struct given){ .path = write_tiff("none.tif", false, 40, 30, samples, NULL),
		.scene_crs = "EPSG:32631" };
	import_fails(&o, "the file has no CRS; say it in the scene: \"ground\": {\"heights\": ..., \"crs\": "
		"\"EPSG:32631\"}");
	o.crs = "EPSG:99999999";
	import_fails(&o, "the CRS \"EPSG:99999999\" is not known");
	o.crs = "EPSG:32631";
	o.scene_crs = "EPSG:4326";
	import_fails(&o, "not one in metres");
	import_fails(&(struct given){ .path = "build/tmp/ground/utm.tif" }, "the scene has no CRS");
}

UNIT_TEST(a_raster_that_is_too_large_is_averaged_down)
{
	static double samples[64 * 32];
	for (int i = 0; i < 64 * 32; i++)
		samples[i] = i % 64;
	import_good(&(struct given){ .path = write_tiff("large.tif", false, 64, 32, samples, NULL),
		.side_max = 16,
		.origin = { 500000, 1000, 100 } });
	assert_true(ground.columns == 16 && ground.rows == 16 && ground.step_x_m == 40 &&
		ground.step_y_m == 20 && ground.x_m == 20 && ground.y_m == 10);
	assert_true(fabsf(ground.height_m[0] - 0.75f) < 1e-4f && fabsf(ground.height_m[17] - 2.75f) < 1e-4f);
	import_says("averaged down to 16 x 16");
}

UNIT_TEST(what_is_no_raster_is_refused)
{
	static const struct { const char *name, *text, *says;
	} cases[] = { { "lfs.tif", "version https://git-lfs.github.com/spec/v1\n",
			      "lfs.tif: a pointer of Git LFS" },
		{ "empty.tif", "", "empty.tif: the file is empty" },
		{ "text.tif", "not a raster", "not a raster that GDAL can read" },
		{ "one.asc", "ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n5\n",
			"at least 2 x 2" },
		{ "void.asc", GRID "-9999 -9999 -9999\n-9999 -9999 -9999\n", "no height at all" } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		import_fails(&(struct given){ .path = input_text("ground", cases[i].name, cases[i].text) },
			cases[i].says);
	import_fails(&(struct given){ .path = "build/tmp/ground/gone.tif" }, "gone.tif: No such file");
}

/* ---- Values ---- */

static const double at_zero[6] = { 0, 10, 0, 40, 0, -10 };      /* 4 rows of 10 m */

/* A height map as pictures have it: sixteen bits, no place, no scale. */
UNIT_TEST(a_png_takes_its_meaning_from_the_scene)
{
	static const double samples[16] = { 0, 1000, 2000, 65535, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3 };
	struct given g = { .path = write_png("map.png", samples),
		.no_holes = true };
	remove("build/tmp/ground/map.png.aux.xml");
	import_fails(&g, "add to the ground \"north_west\": [x, y]");
	g.has_place = true;
	g.corner[0] = 100;
	g.corner[1] = 240;
	g.pixel[0] = g.pixel[1] = 10;
	import_good(&g);
	import_says("heights from 0 to 65535 m are not of this Earth");
	assert_true(ground.x_m == 105 && ground.y_m == 205 && ground.height_m[0] == 3 && ground.height_m[15]
		== 65535);
	g.scale = 0.001;
	g.offset = 273.5;
	g.has_offset = true;
	import_good(&g);
	assert_null(strstr(import_said, "not of this Earth"));
	assert_true(fabsf(ground.height_m[13] - 274.5f) < 1e-4f && fabsf(ground.height_m[15] - 339.035f)
		< 1e-4f);
	g.unit_m = 0.3048;                   /* feet: scale and offset first */
	import_good(&g);
	assert_true(fabsf(ground.height_m[13] - 274.5f * 0.3048f) < 1e-4f);
}

UNIT_TEST(a_world_file_says_where_a_picture_lies)
{
	static const double samples[16] = { 5, 5, 5, 5, 6, 6, 6, 6, 7, 7, 7, 7, 8, 8, 8, 8 };
	struct given g = { .path = write_png("world.png", samples) };
	remove("build/tmp/ground/world.png.aux.xml");
	input_text("ground", "world.pgw", "2\n0\n0\n-2\n1001\n2007\n");
	import_good(&g);
	assert_true(ground.x_m == 1001 && ground.y_m == 2001 && ground.step_x_m == 2 && ground.height_m[0]
		== 8);
}

UNIT_TEST(units_of_the_file_are_converted_and_said)
{
	double samples[16];
	for (int i = 0; i < 16; i++)
		samples[i] = 1000 + i;
	const char *path = write_raster(&(struct raster){ "GTiff", "feet.tif", NULL, "US survey foot",
		GDT_Float32, 4, 4, at_zero, samples, false });
	import_good(&(struct given){ .path = path });
	assert_true(fabs((double)ground.height_m[12] - 1000 * 1200.0 / 3937) < 1e-3);
	assert_true(strstr(import_said, "units of 0.304800610 m") || strstr(import_said, "units of 0.30480061 m"));
	import_good(&(struct given){ .path = path, .unit_m = 1 });
	assert_true(ground.height_m[12] == 1000);
}

UNIT_TEST(a_band_is_chosen_and_colours_are_no_heights)
{
	const char *path = input_path("ground", "bands.tif");
	static const uint8_t gray[4] = { 1, 2, 3, 4 };
	GDALDatasetH file;
	GDALAllRegister();
	file = GDALCreate(GDALGetDriverByName("GTiff"), path, 2, 2, 3, GDT_Byte, NULL);
	GDALSetGeoTransform(file, (double *)at_zero);
	for (int b = 1; b <= 3; b++)
		assert_int_equal(GDALRasterIO(GDALGetRasterBand(file, b), GF_Write, 0, 0, 2, 2, (void *)gray,
			2, 2, GDT_Byte, 0, 0), CE_None);
	GDALSetRasterColorInterpretation(GDALGetRasterBand(file, 1), GCI_RedBand);
	GDALClose(file);
	import_fails(&(struct given){ .path = path }, "it holds colours, not heights");
	import_fails(&(struct given){ .path = path, .band = 4 }, "it has 3 bands, not a band 4");
	import_good(&(struct given){ .path = path, .band = 2 });
	assert_true(ground.height_m[0] == 3);
}

/* ---- Holes that nothing marks ---- */

#define HOLES_SIDE 40
static double terrain(int x, int y)
{
	return 400 + 3 * sin(x * 0.4) + 2 * cos(y * 0.3 + x * 0.1) + 0.05 * x * y;
}

/* -32768 meets nothing but 0, which stands out itself. */
UNIT_TEST(holes_within_holes_are_found)
{
	static double samples[HOLES_SIDE * HOLES_SIDE];
	static const double transform[6] = { 0, 1, 0, HOLES_SIDE, 0, -1 };
	for (int i = 0; i < HOLES_SIDE * HOLES_SIDE; i++) {
		int x = i % HOLES_SIDE;
		samples[i] = x < 4 ? -32768 : x < 6 ? 0 : terrain(x, i / HOLES_SIDE);
	}
	import_good(
		&(struct given){ .path = write_floats("within.tif", HOLES_SIDE, samples, transform, NULL) });
	assert_int_equal(ground.filled, 6 * HOLES_SIDE);
	import_says("stand out");
	for (int i = 0; i < HOLES_SIDE * HOLES_SIDE; i++)
		assert_true(ground.height_m[i] > 300 && ground.height_m[i] < 600);
}

UNIT_TEST(constants_that_stand_out_are_holes_and_seas_are_not)
{
	static const struct { double value; bool hole; double base; } cases[] = {
		{ 0, true, 0 }, { -9999, true, 0 }, { -3.4028234663852886e38, true, 0 }, { 32767, true, 0 },
			{ -32768, true, 0 }, { 12345, true, 0 },
		{ -1, true, 0 }, { 65535, true, 0 },
		/* terrain that goes down to about 0: a sea, with beaches */
		{ 0, false, -399 },
	};
	static double samples[HOLES_SIDE * HOLES_SIDE];
	static const double transform[6] = { 0, 1, 0, HOLES_SIDE, 0, -1 };

	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		struct given g = { 0 };
			uint64_t missing = 0;
		for (int y = 0; y < HOLES_SIDE; y++)
			for (int x = 0; x < HOLES_SIDE; x++) {
				double *z = &samples[y * HOLES_SIDE + x];
				bool here = (x > 10 && x < 15 && y > 20 && y < 30) || (x == 30 && y == 3);
				*z = terrain(x, y) + cases[k].base;
				if (cases[k].base != 0)
					*z = *z < 8 ? 0 : *z - 8;        /* below the sea's level all is 0 */
				else if (here)
					*z = cases[k].value;
				missing += here;
			}
		g.path = write_floats("holes.tif", HOLES_SIDE, samples,
			transform, NULL);
		import_good(&g);
		if (!cases[k].hole) {
			assert_int_equal(ground.filled, 0);
			assert_null(strstr(import_said, "stand out"));
			continue;
		}
		assert_int_equal(ground.filled, missing);
		assert_true(fabs(cases[k].value) > 1e6 || strstr(import_said, "stand out"));
		for (int i = 0; i < HOLES_SIDE * HOLES_SIDE; i++)
			assert_true(ground.height_m[i] > 380 && ground.height_m[i] < 500);
		if (fabs(cases[k].value) > 1e6)
			continue;                            /* no height in any case */
		g.no_holes = true;
		import_good(&g);
		assert_int_equal(ground.filled, 0);
		g.no_holes = false;
		g.has_nodata = true;
		g.nodata = cases[k].value;
		import_good(&g);
		assert_int_equal(ground.filled, missing);
		assert_null(strstr(import_said, "stand out"));
	}
}

UNIT_TEST(ground_that_is_all_one_is_said)
{
	import_good(&(struct given){ .path = input_text("ground", "flat.asc", GRID "7 7 7\n7.0 7 7\n") });
	import_says("every height is 7 m");
}

/* ---- Several rasters ---- */

UNIT_TEST(rasters_side_by_side_become_one_ground)
{
	static double west[16], east[16], fine[64];
	static const double east_at[6] = { 40, 10, 0, 40, 0, -10 }, fine_at[6] = { 80, 5, 0, 40, 0, -5 };
	struct given g = { .no_holes = true };
	double z;
	for (int i = 0; i < 16; i++) {
		west[i] = 100 + i % 4;
		east[i] = 104 + i % 4;
	}
	for (int i = 0; i < 64; i++)
		fine[i] = 108 + (i % 8 - 0.5) * 0.5;
	g.paths[0] = write_floats("west.tif", 4, west, at_zero, NULL);
	g.paths[1] = write_floats("east.tif", 4, east, east_at, NULL);
	import_good(&g);
	assert_true(ground.columns == 8 && ground.rows == 4 && ground.step_x_m == 10 && ground.x_m == 5
		&& ground.filled == 0);
	for (uint32_t i = 0; i < 32; i++)
		assert_true(ground.height_m[i] == 100 + (float)(i % 8));
	/* a finer one beside them: all at its resolution, the others resampled */
	g.paths[2] = write_floats("fine.tif", 8, fine, fine_at, NULL);
	import_good(&g);
	assert_true(ground.columns == 24 && ground.rows == 8 && ground.step_x_m == 5);
	for (double x = 10; x < 110; x += 7) {
		eco_ground_height(&ground, x, 20, &z);
		assert_true(fabs(z - (100 + (x - 5) / 10)) < 0.3);
	}
	/* where two have a height, the first counts */
	g.paths[0] = write_floats("over.tif", 4,
		(double[16]){ 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9 }, at_zero, NULL);
	g.paths[1] = write_floats("west.tif", 4, west, at_zero, NULL);
	g.paths[2] = NULL;
	import_good(&g);
	assert_true(ground.height_m[5] == 9);
	g.paths[1] = "build/tmp/ground/gone.tif";
	import_fails(&g, "gone.tif: No such file");
}

/* Rows from the south, and degrees: the way of most global models. */
UNIT_TEST(degrees_and_turned_rasters_are_resampled)
{
	static double samples[60 * 60];
	static const double degrees[6] = { 8.99, 0.001, 0, 48.04, 0, -0.001 },
		turned[6] = { 0, 7, 7, 500, 7, -7 };
	struct given g = { .scene_crs = "EPSG:32632", .origin = { 500000, 5316000, 0 } };
	double z, far_z = 0;
	for (int i = 0; i < 3600; i++)
		samples[i] = 500 + i / 60;           /* falls to the north: 500 in the first row */
	g.path = write_floats("degrees.tif", 60, samples, degrees, "EPSG:4326");
	import_good(&g);
	assert_true(ground.step_x_m > 60 && ground.step_x_m < 120);
	assert_true(eco_ground_height(&ground, 0, 0, &z) && eco_ground_height(&ground, 0, 1112, &far_z));
	assert_true(fabs(z - far_z - 10) < 0.5);     /* a hundredth of a degree, ten rows */
	g = (struct given){ .path = write_floats("turned.tif", 60, samples, turned,
		NULL), .no_holes = true };
	import_good(&g);
	/* its centre */
	assert_true(eco_ground_height(&ground, 0 + 30 * 7 + 30 * 7, 500 + 30 * 7 - 30 * 7, &z)
		&& fabs(z - 529.5) < 1);
}

/* ---- Vertical datum ---- */

UNIT_TEST(one_vertical_datum_without_the_other_is_an_error)
{
	static const struct { const char *crs, *scene_crs, *vertical, *scene_vertical, *fails;
	} cases[] = { { NULL, NULL, "EPSG:5703", NULL, "add \"vertical\": \"EPSG:5703\" to the scene" },
		{ NULL, NULL, "EPSG:5703", "EPSG:5703", NULL },
		{ NULL, NULL, "NAVD88 height", "EPSG:5703", NULL }, /* the same by name */
		{ NULL, NULL, "EPSG:5773", "EPSG:5703", "no conversion is at hand" },
		{ NULL, NULL, NULL, "EPSG:5703", "add \"vertical\": \"EPSG:5703\" to the ground" },
		/* a compound CRS states one too */
		{ "EPSG:32632", "EPSG:32632+5773", NULL, NULL,
			"add \"vertical\": \"EGM96 height\" to the ground" },
		{ "EPSG:32632+5773", "EPSG:32632+5773", NULL, NULL, NULL } };
	struct given g = { .path = input_text("ground", "v.asc", GRID "1 2 3\n4 5 6\n") };
	import_good(&g);
	assert_true(strstr(import_said, "add \"vertical\" to the scene and to its ground"));
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		g = (struct given){ .path = g.path, .crs = cases[i].crs, .scene_crs = cases[i].scene_crs,
			.vertical = cases[i].vertical, .scene_vertical = cases[i].scene_vertical };
		if (cases[i].fails) {
			import_fails(&g, cases[i].fails);
			continue;
		}
		import_good(&g);
		assert_null(strstr(import_said, "vertical"));
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
	for (double v = 0; v <= 1; v += 0.125) {             /* continuous across the cell border */
		double left, right;

		eco_ground_height(&g, 1 - 1e-9, 2 + 4 * v, &left);
		eco_ground_height(&g, 1 + 1e-9, 2 + 4 * v, &right);
		assert_true(fabs(left - right) < 1e-6);
	}
	assert_false(eco_ground_height(&g, NAN, 3, &(double){ 0 }));
}
