/* Inventories: CSV as it comes, coordinates, species, heights, and what is said about rows that cannot be used. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

#include "ecofiles/model.h"
#include "ecofiles/positions.h"
#include "ecofiles/rows.h"
#include "tests/input_files.h"

static const struct eco_frame plain = { NULL, { 0, 0, 0 } };

static struct eco_positions_spec spec_of(const char *csv)
{
	return (struct eco_positions_spec){ .path = (char *)input_text("positions", "rows.csv", csv), .x = (char *)"x", .y = (char *)"y",
		.fallback = { (char *)"*", 0, 1 } };
}

static struct eco_positions *open_good(const struct eco_positions_spec *spec, const struct eco_frame *frame)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_positions *reader;

	if (eco_positions_open(&reader, spec, frame, &error) != ECO_OK)
		fail_msg("%s", error.text);
	return reader;
}

static bool next_good(struct eco_positions *reader, struct eco_position *record)
{
	struct eco_error error = { .code = ECO_OK };

	if (eco_positions_next(reader, record, &error) != ECO_OK)
		fail_msg("%s", error.text);
	return record->plant != ECO_NONE;
}

static void open_fails(const struct eco_positions_spec *spec, const struct eco_frame *frame, const char *says)
{
	struct eco_error error = { .code = ECO_OK };
	struct eco_positions *reader;

	assert_int_not_equal(eco_positions_open(&reader, spec, frame, &error), ECO_OK);
	assert_null(reader);
	if (strstr(error.text, says) == NULL)
		fail_msg("%s\n  wanted ... %s", error.text, says);
}

/* ---- CSV ---- */

static void quotes_line_breaks_marks_and_endings_are_read(void **state)
{
	static const char csv[] = "\xef\xbb\xbfname, x ,\"y\"\r\n"
		"\"a, \"\"b\"\"\nsecond line\", 1 ,2\r\n\r\n"
		"plain\"quote,3,\"4\"\n"
		",-5.5e1,6.25";
	struct eco_error error = { .code = ECO_OK };
	struct eco_rows *rows;
	bool more;

	(void)state;
	assert_int_equal(eco_rows_open_csv(&rows, input_text("positions", "quotes.csv", csv), ',', &error), ECO_OK);
	assert_int_equal(rows->column_count, 3);
	assert_string_equal(rows->columns[0], "name");
	assert_string_equal(rows->columns[1], "x");
	assert_string_equal(rows->columns[2], "y");
	assert_int_equal(rows->next(rows, &more, &error), ECO_OK);
	assert_string_equal(rows->fields[0], "a, \"b\"\nsecond line");
	assert_string_equal(rows->fields[2], "2");
	assert_int_equal(rows->line, 2);
	assert_int_equal(rows->next(rows, &more, &error), ECO_OK);
	assert_string_equal(rows->fields[0], "plain\"quote");
	assert_int_equal(rows->line, 5);
	assert_int_equal(rows->next(rows, &more, &error), ECO_OK);
	assert_string_equal(rows->fields[0], "");
	assert_int_equal(rows->row, 3);
	assert_int_equal(rows->next(rows, &more, &error), ECO_OK);
	assert_false(more);
	eco_rows_close(rows);
}

static void files_that_are_no_csv_are_refused_with_a_line(void **state)
{
	static const struct { const char *bytes; size_t size; const char *says; } inputs[] = {
		{ "", 0, "empty file" }, { "x,y\n1,\"2", 8, ":2: a quoted field" }, { "x\0,\0y\0\n\0", 8, ":1: a zero byte" },
	};

	(void)state;
	for (size_t i = 0; i < sizeof inputs / sizeof *inputs; i++) {
		struct eco_error error = { .code = ECO_OK };
		struct eco_rows *rows;
		bool more = true;
		enum eco_code code = eco_rows_open_csv(&rows, input_bytes("positions", "bad.csv", inputs[i].bytes, inputs[i].size), ',', &error);

		while (code == ECO_OK && more)
			code = rows->next(rows, &more, &error);
		assert_int_not_equal(code, ECO_OK);
		assert_non_null(strstr(error.text, inputs[i].says));
		eco_rows_close(rows);
	}
}

static void a_row_without_end_is_bounded(void **state)
{
	size_t size = ECO_ROW_BYTES_MAX + 100;
	char *bytes = malloc(size);
	struct eco_error error = { .code = ECO_OK };
	struct eco_rows *rows;

	(void)state;
	memset(bytes, 'a', size);
	assert_int_equal(eco_rows_open_csv(&rows, input_bytes("positions", "long.csv", bytes, size), ',', &error), ECO_TOO_LARGE);
	memset(bytes, ',', size);
	error.code = ECO_OK;
	assert_int_equal(eco_rows_open_csv(&rows, input_bytes("positions", "long.csv", bytes, size), ',', &error), ECO_TOO_LARGE);
	free(bytes);
}

/* ---- Columns, species, coordinates ---- */

static void a_missing_column_is_named_beside_those_there_are(void **state)
{
	struct eco_positions_spec spec = spec_of("X,y,h\n1,2,3\n");

	(void)state;
	open_fails(&spec, &plain, "no column \"x\"; there are: X, y, h");
	spec = spec_of("x;y\n1;2\n");
	open_fails(&spec, &plain, "is \"separator\" another?");
	spec = spec_of("x,y,x\n1,2,3\n");
	open_fails(&spec, &plain, "two columns are named \"x\"");
	spec.path = (char *)"build/tmp/positions/gone.csv";
	open_fails(&spec, &plain, "gone.csv: No such file");
}

static void rows_that_cannot_be_used_are_counted_by_reason(void **state)
{
	struct eco_positions_spec spec = spec_of("sp,x,y\n"
		"oak,1,2\n" "elm,1,2\n" "oak,,2\n" "oak,1,NA\n" "oak,1,2m\n" "oak,0x10,2\n" "oak,nan,2\n" "stump,1,2\n" "oak,1\n" "oak,1e9,2\n"
		"elm,3,3\n" " oak ,7,8\n");
	struct eco_species map[] = { { (char *)"oak", 4, 1 }, { (char *)"stump", ECO_NONE, 1 } };
	struct eco_positions *reader;
	struct eco_position record;
	const struct eco_skipped *s;
	uint64_t rows;

	(void)state;
	spec.species = (char *)"sp";
	spec.map = map;
	spec.map_count = 2;
	spec.fallback = (struct eco_species){ NULL, ECO_NONE, 1 };
	reader = open_good(&spec, &plain);
	assert_true(next_good(reader, &record));
	assert_int_equal(record.plant, 4);
	assert_true(record.at[0] == 1 && record.at[1] == 2 && record.at[2] == 0 && !record.absolute && isnan(record.height_m));
	assert_true(next_good(reader, &record));
	assert_true(record.at[0] == 7);
	assert_int_equal(record.row, 12);
	assert_int_equal(record.line, 13);
	assert_false(next_good(reader, &record));
	s = eco_positions_skipped(reader, &rows);
	assert_int_equal(rows, 12);
	assert_int_equal(s[ECO_SKIP_UNKNOWN_SPECIES].count, 2);
	assert_int_equal(s[ECO_SKIP_UNKNOWN_SPECIES].first_line, 3);
	assert_string_equal(s[ECO_SKIP_UNKNOWN_SPECIES].first_text, "elm");
	assert_int_equal(s[ECO_SKIP_NO_COORDINATES].count, 3);      /* empty, NA, nan */
	assert_int_equal(s[ECO_SKIP_BAD_NUMBER].count, 2);
	assert_int_equal(s[ECO_SKIP_BAD_NUMBER].first_line, 6);
	assert_int_equal(s[ECO_SKIP_LEFT_OUT].count, 1);
	assert_int_equal(s[ECO_SKIP_SHORT_ROW].count, 1);
	assert_int_equal(s[ECO_SKIP_OUTSIDE].count, 1);
	eco_positions_close(reader);
}

static void coordinates_are_metres_from_the_origin_in_the_scenes_crs(void **state)
{
	/* 3 degrees east is the central meridian of UTM zone 31, easting 500000 */
	struct eco_positions_spec spec = spec_of("x,y,z\n3,0,100\n3,1,100\n");
	const struct eco_frame utm = { "EPSG:32631", { 499000, -1000, 40 } };
	struct eco_positions *reader;
	struct eco_position record;

	(void)state;
	spec.crs = (char *)"EPSG:4326";
	spec.z = (char *)"z";
	reader = open_good(&spec, &utm);
	assert_true(next_good(reader, &record));
	assert_true(fabs(record.at[0] - 1000) < 0.002 && fabs(record.at[1] - 1000) < 0.002);
	assert_true(record.absolute && record.at[2] == 60);
	assert_true(next_good(reader, &record));
	assert_true(fabs(record.at[1] - 1000 - 110530) < 20);       /* a degree of latitude at scale 0.9996 */
	eco_positions_close(reader);
	spec = spec_of("x,y\n499010.5,-990\n");
	spec.crs = (char *)"epsg:32631";
	reader = open_good(&spec, &utm);
	assert_true(next_good(reader, &record));
	assert_true(record.at[0] == 10.5 && record.at[1] == 10);    /* the same CRS: not converted */
	eco_positions_close(reader);
}

static void a_crs_is_never_guessed(void **state)
{
	const struct eco_frame utm = { "EPSG:32631", { 0, 0, 0 } }, degrees = { "EPSG:4326", { 0, 0, 0 } };
	const struct eco_frame feet = { "EPSG:2261", { 0, 0, 0 } }, nonsense = { "EPSG:99999999", { 0, 0, 0 } };
	struct eco_positions_spec spec = spec_of("x,y\n1,2\n");

	(void)state;
	open_fails(&spec, &utm, "add \"crs\": \"EPSG:32631\"");
	spec.crs = (char *)"EPSG:4326";
	open_fails(&spec, &plain, "the scene has no CRS; add \"crs\": \"EPSG:4326\"");
	open_fails(&spec, &degrees, "not one in metres");
	open_fails(&spec, &feet, "not one in metres");
	open_fails(&spec, &nonsense, "is not known");
	spec.crs = (char *)"EPSG:99999999";
	open_fails(&spec, &utm, "no conversion from CRS \"EPSG:99999999\"");
}

/* ---- Heights and yaw ---- */

static void heights_come_from_dbh_from_a_column_or_from_nowhere(void **state)
{
	struct eco_positions_spec spec = spec_of("x,y,d\n1,1,100\n1,1,0\n1,1,NA\n1,1,1e6\n");
	struct eco_positions *reader;
	struct eco_position record;
	double all[4];

	(void)state;
	spec.height_column = (char *)"d";
	spec.height = ECO_HEIGHT_DBH;
	spec.unit_m = 1;
	spec.max_m = 35;
	spec.rate = 0.004;
	reader = open_good(&spec, &plain);
	for (int i = 0; i < 4; i++) {
		assert_true(next_good(reader, &record));
		all[i] = record.height_m;
	}
	assert_true(fabs(all[0] - (1.3 + 33.7 * (1 - exp(-0.4)))) <= 0.0005);
	assert_true(isnan(all[1]) && isnan(all[2]) && all[3] == 35);
	assert_int_equal(eco_positions_skipped(reader, NULL)[ECO_SKIP_NO_HEIGHT].count, 2);
	eco_positions_close(reader);
	spec.height = ECO_HEIGHT_COLUMN;
	spec.unit_m = 0.3048;
	reader = open_good(&spec, &plain);
	assert_true(next_good(reader, &record));
	assert_true(record.height_m == 30.48);
	eco_positions_close(reader);
}

static void levels_keep_the_tall_few_and_the_relative_error(void **state)
{
	char csv[20000] = "x,y,h\n";
	struct eco_positions_spec spec;
	struct eco_positions *reader;
	struct eco_position record;
	double seen[64];
	uint32_t count = 0, rows = 0;
	size_t used = strlen(csv);

	(void)state;
	for (int i = 0; i < 600; i++)        /* many of 2 to 4 m, one in fifty of 20 to 32 m */
		used += (size_t)snprintf(csv + used, sizeof csv - used, "1,1,%.2f\n", i % 50 == 0 ? 20 + i * 0.02 : 2 + (i * 7 % 200) * 0.01);
	spec = spec_of(csv);
	spec.height_column = (char *)"h";
	spec.height = ECO_HEIGHT_COLUMN;
	spec.unit_m = 1;
	spec.levels = 6;
	reader = open_good(&spec, &plain);
	while (next_good(reader, &record)) {
		int i = (int)rows++;
		double exact = i % 50 == 0 ? 20 + i * 0.02 : 2 + (i * 7 % 200) * 0.01;
		uint32_t k = 0;

		assert_true(fabs(record.height_m / exact - 1) < 0.5);       /* one class spans 16^(1/6) = 1.59 */
		while (k < count && seen[k] != record.height_m)
			k++;
		if (k == count)
			seen[count++] = record.height_m;
	}
	assert_int_equal(rows, 600);
	assert_in_range(count, 3, 6);
	eco_positions_close(reader);
}

static void yaw_is_the_seeds_and_the_rows_alone(void **state)
{
	struct eco_positions_spec spec = spec_of("x,y,r\n1,1,90\n2,2,\n3,bad,\n4,4,\n");
	double first[3], again[3], other[3], *into[] = { first, again, other };
	struct eco_positions *reader;
	struct eco_position record;

	(void)state;
	spec.fallback.variant_count = 3;
	for (int pass = 0; pass < 3; pass++) {
		spec.seed = pass == 2 ? 8 : 7;
		reader = open_good(&spec, &plain);
		for (int i = 0; i < 3; i++) {
			assert_true(next_good(reader, &record));
			assert_in_range(record.plant, 0, 2);
			assert_true(record.yaw_deg >= 0 && record.yaw_deg < 360);
			into[pass][i] = record.yaw_deg;
		}
		eco_positions_close(reader);
	}
	assert_memory_equal(first, again, sizeof first);
	assert_true(first[0] != other[0] && first[0] != first[1]);
	spec.yaw_deg = (char *)"r";
	spec.seed = 7;
	reader = open_good(&spec, &plain);
	assert_true(next_good(reader, &record) && record.yaw_deg == 90);
	assert_true(next_good(reader, &record) && record.yaw_deg == first[1]);
	eco_positions_close(reader);
}

static void a_real_inventory_goes_through_whole(void **state)
{
	const char *data = getenv("ECO_DATA");
	char path[4096];
	struct eco_positions_spec spec = { .x = (char *)"utm17n_e", .y = (char *)"utm17n_n", .crs = (char *)"EPSG:26917",
		.fallback = { (char *)"*", 0, 1 }, .height = ECO_HEIGHT_DBH, .height_column = (char *)"dbh_mm", .unit_m = 1, .max_m = 35,
		.rate = 0.004, .levels = 8 };
	const struct eco_frame frame = { "EPSG:26917", { 747375, 4308510, 0 } };
	struct eco_positions *reader;
	struct eco_position record;
	uint32_t count = 0;

	(void)state;
	snprintf(path, sizeof path, "%s/inventories/scbi_stems_2018_utm17n.csv", data != NULL ? data : "");
	if (data == NULL || access(path, R_OK) != 0)
		skip();
	spec.path = path;
	reader = open_good(&spec, &frame);
	for (; next_good(reader, &record); count++)
		assert_true(record.at[0] > -20 && record.at[0] < 430 && record.at[1] > -20 && record.at[1] < 660);
	assert_int_equal(count, 51253);
	eco_positions_close(reader);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(quotes_line_breaks_marks_and_endings_are_read),
		cmocka_unit_test(files_that_are_no_csv_are_refused_with_a_line),
		cmocka_unit_test(a_row_without_end_is_bounded),
		cmocka_unit_test(a_missing_column_is_named_beside_those_there_are),
		cmocka_unit_test(rows_that_cannot_be_used_are_counted_by_reason),
		cmocka_unit_test(coordinates_are_metres_from_the_origin_in_the_scenes_crs),
		cmocka_unit_test(a_crs_is_never_guessed),
		cmocka_unit_test(heights_come_from_dbh_from_a_column_or_from_nowhere),
		cmocka_unit_test(levels_keep_the_tall_few_and_the_relative_error),
		cmocka_unit_test(yaw_is_the_seeds_and_the_rows_alone),
		cmocka_unit_test(a_real_inventory_goes_through_whole),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
