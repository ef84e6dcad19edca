/* Ground: rasters as they come, what they lack, and heights exactly on the triangles that are drawn. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <gdal.h>
#include <math.h>
#include <ogr_srs_api.h>

#include "ecofiles/ground.h"
#include "tests/input_files.h"

static char last_warning[600];

static void note(void *ctx, const char *text)
{
	(void)ctx;
	snprintf(last_warning, sizeof last_warning, "%s", text);
}

static void import_good(struct eco_ground *ground, const struct eco_ground_options *options)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_ground_options with = *options;

	with.warn = note;
	last_warning[0] = 0;
	if (eco_ground_import(ground, &with, &error) != ECO_OK)
		fail_msg("%s", error.text);
}

static void import_fails(const struct eco_ground_options *options, const char *says)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_ground ground;

	assert_int_not_equal(eco_ground_import(&ground, options, &error), ECO_OK);
	assert_null(ground.height_m);
	if (strstr(error.text, says) == NULL)
		fail_msg("%s\n  wanted ... %s", error.text, says);
}

/* 3 x 2 samples of 10 m, first row in the north. */
#define GRID "ncols 3\nnrows 2\nxllcorner 100\nyllcorner 200\ncellsize 10\nNODATA_value -9999\n"

static void samples_lie_at_pixel_centres_from_the_south_west(void **state)
{
	static const float wanted[] = { 4, 5, 6, 1, 2, 3 };
	struct eco_ground g;

	(void)state;
	import_good(&g, &(struct eco_ground_options){ .path = input_text("ground", "a.asc", GRID "11 12 13\n14.0 15 16\n"),
		.origin = { 90, 190, 10 } });
	assert_int_equal(g.columns, 3);
	assert_int_equal(g.rows, 2);
	assert_true(g.x_m == 15 && g.y_m == 15 && g.step_x_m == 10 && g.step_y_m == 10);
	assert_memory_equal(g.height_m, wanted, sizeof wanted);
	assert_int_equal(g.filled, 0);
	assert_string_equal(last_warning, "");
	eco_ground_free(&g);
	assert_null(g.height_m);
}

static void what_is_missing_grows_in_from_its_neighbours(void **state)
{
	struct eco_ground g;

	(void)state;
	import_good(&g, &(struct eco_ground_options){ .path = input_text("ground", "b.asc", "ncols 5\nnrows 3\nxllcorner 0\nyllcorner 0\n"
		"cellsize 1\nNODATA_value -9999\n7 -9999 -9999 -9999 -9999\n7 nan -3.4e38 -9999 -9999\n7.0 1e6 -9999 -9999 -9999\n") });
	assert_int_equal(g.filled, 12);
	for (int i = 0; i < 15; i++)
		assert_true(g.height_m[i] == 7);
	assert_non_null(strstr(last_warning, "12 of 15 samples"));
	eco_ground_free(&g);
	import_good(&g, &(struct eco_ground_options){ .path = input_text("ground", "c.asc", GRID "0 -9999 10\n0.0 -9999 10\n") });
	assert_true(g.height_m[1] == 5 && g.height_m[4] == 5);
	eco_ground_free(&g);
}

/* A GeoTIFF of whole numbers with scale and offset; rows from the south if `south_up`. */
static const char *write_tiff(const char *name, bool south_up, int columns, int rows, const int16_t *samples, const char *crs)
{
	const char *path = input_path("ground", name);
	double transform[6] = { 500000, 10, 0, south_up ? 1000 : 1000 + 10.0 * rows, 0, south_up ? 10 : -10 };
	GDALDatasetH file;
	GDALRasterBandH band;

	GDALAllRegister();
	file = GDALCreate(GDALGetDriverByName("GTiff"), path, columns, rows, 1, GDT_Int16, NULL);
	assert_non_null(file);
	GDALSetGeoTransform(file, transform);
	if (crs != NULL) {
		OGRSpatialReferenceH reference = OSRNewSpatialReference(NULL);

		OSRSetFromUserInput(reference, crs);
		GDALSetSpatialRef(file, reference);
		OSRDestroySpatialReference(reference);
	}
	band = GDALGetRasterBand(file, 1);
	GDALSetRasterNoDataValue(band, -1);
	GDALSetRasterScale(band, 0.5);
	GDALSetRasterOffset(band, 100);
	assert_int_equal(GDALRasterIO(band, GF_Write, 0, 0, columns, rows, (void *)samples, columns, rows, GDT_Int16, 0, 0), CE_None);
	GDALClose(file);
	return path;
}

static void scale_offset_and_row_order_of_the_file_are_honoured(void **state)
{
	static const int16_t samples[] = { 2, 4, 6, 8, 10, 12 };
	struct eco_ground_options o = { .scene_crs = "EPSG:32631", .origin = { 500000, 1000, 100 } };
	struct eco_ground g;

	(void)state;
	o.path = write_tiff("north.tif", false, 2, 3, samples, "EPSG:32631");
	import_good(&g, &o);
	assert_true(g.x_m == 5 && g.y_m == 5 && g.columns == 2 && g.rows == 3);
	assert_true(g.height_m[0] == 5 && g.height_m[1] == 6 && g.height_m[4] == 1);
	eco_ground_free(&g);
	o.path = write_tiff("south.tif", true, 2, 3, samples, "EPSG:32631");
	import_good(&g, &o);
	assert_true(g.y_m == 5 && g.height_m[0] == 1 && g.height_m[5] == 6);
	eco_ground_free(&g);
}

static void a_crs_is_converted_and_never_guessed(void **state)
{
	static int16_t samples[40 * 30];
	struct eco_ground_options o = { .scene_crs = "EPSG:32631", .origin = { 500000, 1000, 0 } };
	struct eco_ground g;
	double z;

	(void)state;
	for (int i = 0; i < 40 * 30; i++)
		samples[i] = (int16_t)(i % 40 * 10);
	o.path = write_tiff("utm.tif", false, 40, 30, samples, "EPSG:32631");
	o.scene_crs = "EPSG:3857";           /* Mercator: metres too, but another place */
	o.origin[0] = 333958.5;
	o.origin[1] = 1000;
	import_good(&g, &o);
	assert_true(eco_ground_height(&g, 200, 150, &z));    /* about 20 columns in: 100 m + 0.5 * 10 * 19.5 */
	assert_true(fabs(z - 197.5) < 5);
	eco_ground_free(&g);
	o.crs = "EPSG:32631";                /* stated and contained agree: no warning of that kind */
	import_good(&g, &o);
	assert_null(strstr(last_warning, "which is used"));
	eco_ground_free(&g);
	o.crs = "EPSG:32632";
	import_good(&g, &o);
	assert_non_null(strstr(last_warning, "which is used"));
	eco_ground_free(&g);

	o = (struct eco_ground_options){ .path = write_tiff("none.tif", false, 40, 30, samples, NULL), .scene_crs = "EPSG:32631" };
	import_fails(&o, "the file has no CRS; say it in the scene: \"ground\": {\"heights\": ..., \"crs\": \"EPSG:32631\"}");
	o.crs = "EPSG:99999999";
	import_fails(&o, "the CRS \"EPSG:99999999\" is not known");
	o.crs = "EPSG:32631";
	o.scene_crs = "EPSG:4326";
	import_fails(&o, "not one in metres");
	import_fails(&(struct eco_ground_options){ .path = "build/tmp/ground/utm.tif" }, "the scene has no CRS");
}

static void a_raster_that_is_too_large_is_averaged_down(void **state)
{
	static int16_t samples[64 * 32];
	struct eco_ground g;

	(void)state;
	for (int i = 0; i < 64 * 32; i++)
		samples[i] = (int16_t)(i % 64);
	import_good(&g, &(struct eco_ground_options){ .path = write_tiff("large.tif", false, 64, 32, samples, NULL), .side_max = 16,
		.origin = { 500000, 1000, 100 } });
	assert_true(g.columns == 16 && g.rows == 16 && g.step_x_m == 40 && g.step_y_m == 20 && g.x_m == 20 && g.y_m == 10);
	assert_true(fabsf(g.height_m[0] - 0.75f) < 1e-4f && fabsf(g.height_m[17] - 2.75f) < 1e-4f);
	assert_non_null(strstr(last_warning, "averaged down to 16 x 16"));
	eco_ground_free(&g);
}

static void what_is_no_raster_is_refused(void **state)
{
	(void)state;
	import_fails(&(struct eco_ground_options){ .path = "build/tmp/ground/gone.tif" }, "gone.tif: No such file");
	import_fails(&(struct eco_ground_options){ .path = input_text("ground", "text.tif", "not a raster") }, "not a raster that GDAL can read");
	import_fails(&(struct eco_ground_options){ .path = input_text("ground", "one.asc", "ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\n"
		"cellsize 1\n5\n") }, "at least 2 x 2");
	import_fails(&(struct eco_ground_options){ .path = input_text("ground", "void.asc", GRID "-9999 -9999 -9999\n-9999 -9999 -9999\n") },
		"no height at all");
}

/* ---- Heights ---- */

static void heights_lie_on_the_triangles_from_south_west_to_north_east(void **state)
{
	float samples[] = { 0, 10, 20, 0, 100, 0 };          /* sw 0, se 10; nw 0, ne 100 in the first cell */
	struct eco_ground g = { .columns = 3, .rows = 2, .x_m = -1, .y_m = 2, .step_x_m = 2, .step_y_m = 4, .height_m = samples };
	static const struct { double x, y, z; bool inside; } cases[] = {
		{ -1, 2, 0, true }, { 1, 2, 10, true }, { 3, 2, 20, true }, { -1, 6, 0, true }, { 1, 6, 100, true }, { 3, 6, 0, true },
		{ 0, 4, 50, true },              /* on the diagonal: mean of its ends, not of four corners */
		{ 0.5, 3, 30, true },            /* u .75, v .25: 0 + .75 * 10 + .25 * 90 */
		{ -0.5, 5, 25, true },           /* u .25, v .75: 0 + .75 * 0 + .25 * 100 */
		{ -9, 2, 0, false }, { 9, 6, 0, false }, { 1, 99, 100, false }, { 1, -99, 10, false },
	};

	(void)state;
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

static void the_shared_terrain_reads(void **state)
{
	const char *data = getenv("ECO_DATA");
	char path[4096];
	struct eco_ground g;

	(void)state;
	snprintf(path, sizeof path, "%s/terrain/scbi_plot_elevation.tif", data != NULL ? data : "");
	if (data == NULL || access(path, R_OK) != 0)
		skip();
	import_good(&g, &(struct eco_ground_options){ .path = path, .crs = "EPSG:26917", .scene_crs = "EPSG:26917",
		.origin = { 747375, 4308510, 0 } });
	assert_true(g.columns == 82 && g.rows == 129 && g.step_x_m == 5);
	for (uint32_t i = 0; i < g.columns * g.rows; i++)
		assert_true(g.height_m[i] > 273 && g.height_m[i] < 338);
	eco_ground_free(&g);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(samples_lie_at_pixel_centres_from_the_south_west),
		cmocka_unit_test(what_is_missing_grows_in_from_its_neighbours),
		cmocka_unit_test(scale_offset_and_row_order_of_the_file_are_honoured),
		cmocka_unit_test(a_crs_is_converted_and_never_guessed),
		cmocka_unit_test(a_raster_that_is_too_large_is_averaged_down),
		cmocka_unit_test(what_is_no_raster_is_refused),
		cmocka_unit_test(heights_lie_on_the_triangles_from_south_west_to_north_east),
		cmocka_unit_test(the_shared_terrain_reads),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
