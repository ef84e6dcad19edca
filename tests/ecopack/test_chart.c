/* The canvas: round numbers, texts of any bytes, pixels where they were drawn, files that are whole or not
 * there. */
#include <cairo/cairo.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/base/phrase.h"

#include "ecofiles/base/file_write.h"
#include "ecofiles/ecopack/chart.h"
#include "tests/support/files.h"
#include "tests/support/unit_test.h"

#define ROOT "build/tmp/test_chart"

static struct eco_chart *blank(uint32_t width, uint32_t height)
{
	struct eco_chart *chart;
	assert_int_equal(eco_chart_new(&chart, width, height, NULL), ECO_OK);
	return chart;
}

static struct eco_chart_file png_of(struct eco_chart *chart)
{
	struct eco_chart_file file;
	assert_int_equal(eco_chart_png(chart, &file, NULL), ECO_OK);
	eco_chart_free(chart);
	return file;
}

/* Colour 0xRRGGBB of a pixel of a PNG file. */
static uint32_t pixel(const char *path, int x, int y)
{
	cairo_surface_t *picture = cairo_image_surface_create_from_png(path);
	uint32_t rgb;
	assert_int_equal(cairo_surface_status(picture), CAIRO_STATUS_SUCCESS);
	memcpy(&rgb, cairo_image_surface_get_data(picture) + y * cairo_image_surface_get_stride(picture)
		+ 4 * x, 4);
	cairo_surface_destroy(picture);
	return rgb & 0xffffff;
}

UNIT_TEST(test_numbers_are_rounded_down_to_1_2_5)
{
	static const struct { double value, rounded; } cases[] = { { 1, 1 }, { 1.99, 1 }, { 2, 2 },
		{ 4.9, 2 }, { 5, 5 }, { 9.9, 5 }, { 10, 10 },
		{ 0.01, 0.01 }, { 0.049, 0.02 }, { 123456, 100000 }, { 1e-9, 1e-9 }, { 7e12, 5e12 } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		assert_true(fabs(eco_chart_round_below(cases[i].value) / cases[i].rounded - 1) < 1e-9);
}

UNIT_TEST(test_ticks_are_round_few_and_inside)
{
	static const struct { double low, high; uint32_t most; double step; } cases[] =
		{ { 0, 10, 11, 1 }, { 0, 10, 6, 2 }, { 0, 64, 14, 5 },
		{ 747300, 747800, 6, 100 }, { -3, 3, 4, 2 }, { 0.001, 0.0099, 10, 0.001 },
		{ 4308500.4, 4308500.9, 4, 0.2 } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct eco_chart_ticks ticks = eco_chart_ticks(cases[i].low, cases[i].high, cases[i].most);
		assert_true(fabs(ticks.step / cases[i].step - 1) < 1e-6);
		assert_in_range(ticks.count, 1, cases[i].most);
		double last = ticks.first + (ticks.count - 1) * ticks.step, slack = 1e-6 * ticks.step;
		assert_true(ticks.first >= cases[i].low - slack && last <= cases[i].high + slack
			&& last + ticks.step > cases[i].high - slack);
	}
}

UNIT_TEST(test_ticks_of_nothing_end)
{
	static const double cases[][2] = { { 5, 5 }, { 5, 4 }, { 0, INFINITY }, { NAN, 1 },
		{ 1e15, 1e15 + 1 } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		assert_in_range(eco_chart_ticks(cases[i][0], cases[i][1], 5).count, 0, 5);
}

UNIT_TEST(test_counts_and_lengths_are_written_alike_in_every_locale)
{
	static const struct { uint64_t count; const char *text; } counts[] =
		{ { 0, "0" }, { 999, "999" }, { 1000, "1,000" },
		{ 1234567, "1,234,567" }, { UINT64_MAX, "18,446,744,073,709,551,615" } };
	static const struct { double metres; const char *text; } lengths[] =
		{ { 1000, "1 km" }, { 2500, "2.5 km" }, { 50, "50 m" }, { 0.2, "20 cm" },
		{ 0.005, "5 mm" } };
	char text[32];
	setlocale(LC_ALL, "");
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
		assert_string_equal(eco_phrase_count(counts[i].count, text), counts[i].text);
	setlocale(LC_ALL, "C");
	for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++)
		assert_string_equal(eco_chart_length_text(lengths[i].metres, text), lengths[i].text);
}

UNIT_TEST(test_shapes_lie_where_they_were_drawn)
{
	struct eco_chart *chart = blank(40, 30);
	const uint8_t pixels[] = { 10, 20, 30, 255, 0, 0, 0, 0, 200, 100, 50, 255, 1, 2, 3, 255 };
	eco_chart_box(chart, 0, 0, 10, 10, ECO_COLOR(0x123456));
	eco_chart_disc(chart, 30, 15, 6, ECO_COLOR(0x00ff00));
	eco_chart_clip(chart, 0, 20, 5, 10);
	eco_chart_box(chart, 0, 20, 40, 10, ECO_COLOR(0xff0000));
	eco_chart_clip_off(chart);
	eco_chart_pixels(chart, 12, 1, 2, 2, pixels, true);
	struct eco_chart_file file = png_of(chart);
	assert_int_equal(eco_file_write(ROOT "/shapes.png", file.bytes, file.size, NULL), ECO_OK);
	free(file.bytes);
	static const struct { int x, y; uint32_t rgb; } expected[] =
		{ { 5, 5, 0x123456 }, { 11, 5, 0xffffff }, { 30, 15, 0x00ff00 },
		{ 2, 25, 0xff0000 }, { 8, 25, 0xffffff }, { 12, 1, 0x0a141e }, { 13, 1, 0xffffff },
		{ 12, 2, 0xc86432 } };
	for (size_t i = 0; i < sizeof expected / sizeof *expected; i++)
		assert_int_equal(pixel(ROOT "/shapes.png", expected[i].x, expected[i].y), expected[i].rgb);
}

UNIT_TEST(test_text_of_any_bytes_is_drawn)
{
	static const char *const texts[] = { "", "oak", "\xff\xfe", "\xc3", "Ahorn \xc3\xa4", "\xe2\x82",
		"\xf0\x9f\x8c\xb3", "\xed\xa0\x80", "\xc0\x80",
		"\xf4\x90\x80\x80", "a\nb\tc\x7f", "\xd0\xb4\xd1\x83\xd0\xb1" };
	struct eco_chart_style style = { .size = 12, .room = 30, .halo = { 1, 1, 1, 1 } };
	struct eco_chart *chart = blank(100, 100);
	char long_text[5000];
	memset(long_text, 'x', sizeof long_text - 1);
	long_text[sizeof long_text - 1] = 0;
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
		eco_chart_text(chart, 5, 50, &style, texts[i]);
		assert_true(eco_chart_text_width(chart, &style, texts[i]) >= 0);
		eco_chart_paragraph(chart, 5, 50, 10, &style, texts[i]);
	}
	eco_chart_text(chart, 5, 50, &style, long_text);
	eco_chart_paragraph(chart, 5, 50, 10, &style, long_text);
	struct eco_chart_file file = png_of(chart);
	assert_true(file.size > 100);
	free(file.bytes);
}

UNIT_TEST(test_paragraphs_break_at_spaces)
{
	struct eco_chart_style style = { .size = 12, .room = 100 };
	struct eco_chart *chart = blank(200, 200);
	assert_true(eco_chart_paragraph(chart, 0, 0, 10, &style, "one") == 10);
	double lines = eco_chart_paragraph(chart, 0, 0, 10, &style,
		"one two three four five six seven eight nine ten eleven") / 10;
	assert_true(lines >= 3 && lines <= 6);
	assert_true(eco_chart_paragraph(chart, 0, 0, 10, &style, "") == 0);
	eco_chart_free(chart);
}

UNIT_TEST(test_same_drawing_gives_same_bytes)
{
	struct eco_chart_file files[2];
	for (int i = 0; i < 2; i++) {
		struct eco_chart *chart = blank(64, 64);
		eco_chart_text(chart, 3, 30, &(struct eco_chart_style){ .size = 14 }, "maple 12");
		eco_chart_line(chart, 0, 0, 64, 50, 1.3, ECO_COLOR(0x445566));
		files[i] = png_of(chart);
	}
	assert_int_equal(files[0].size, files[1].size);
	assert_memory_equal(files[0].bytes, files[1].bytes, files[0].size);
	free(files[0].bytes);
	free(files[1].bytes);
}

UNIT_TEST(test_only_pictures_are_replaced)
{
	file_write(ROOT "/text", "hello, world", 12);
	file_write(ROOT "/short", "\x89PN", 3);
	file_write(ROOT "/empty", "", 0);
	file_write(ROOT "/png", "\x89PNG\r\n\x1a\n....", 12);
	static const struct { const char *path; bool allowed; } cases[] =
		{ { ROOT "/text", false }, { ROOT "/short", false }, { ROOT "/empty", true },
		{ ROOT "/png", true }, { ROOT "/new", true }, { ROOT, false },
		{ ROOT "/nowhere/x.png", false }, { "", false } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct eco_error error = { 0 };
		assert_int_equal(eco_chart_may_write(cases[i].path, &error) == ECO_OK, cases[i].allowed);
		assert_int_equal(error.text[0] == 0, cases[i].allowed);
	}
}

UNIT_TEST(test_a_file_that_cannot_be_written_leaves_nothing)
{
	struct eco_chart_file file = png_of(blank(4, 4));
	struct eco_error error = { 0 };
	assert_int_equal(eco_file_write(ROOT "/nowhere/x.png", file.bytes, file.size, &error), ECO_IO);
	assert_int_equal(eco_file_write(ROOT, file.bytes, file.size, NULL), ECO_IO);       /* a folder */
	char beside[200];
	snprintf(beside, sizeof beside, ROOT ".tmp-%ld", (long)getpid());
	assert_int_not_equal(access(beside, F_OK), 0);
	free(file.bytes);
}

UNIT_TEST(test_sides_are_bounded)
{
	struct eco_chart *chart;
	assert_int_equal(eco_chart_new(&chart, 0, 5, NULL), ECO_TOO_LARGE);
	assert_int_equal(eco_chart_new(&chart, 5, ECO_CHART_SIDE_MAX + 1, NULL), ECO_TOO_LARGE);
	assert_null(chart);
}

int main(void)
{
	folder_make(ROOT);
	return unit_tests_run(NULL, NULL);
}
