/* Output of the viewer: figures of frames, report.json, command lines, and the little arithmetic behind them.
 */
#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/view_ask.h"
#include "client-min/view_exchange.h"
#include "client-min/draw/view_picture.h"
#include "client-min/view_query.h"
#include "client-min/view_report.h"
#include "tests/support/files.h"
#include "tests/support/unit_test.h"

static const struct eco_request request =
	{ .view = { { 1.5, -2, 0.1 }, { 0, 0, 1e-9 }, { 0, 0, 1 }, 45, 800, 600 }, .vertices = 1000,
		.bytes = ECO_BYTES_UNBOUNDED };

UNIT_TEST(line_shows_dashes_for_what_is_not_known)
{
	char score[VIEW_SCORE_BYTES];
	assert_string_equal(view_report_score(score, NAN), "-");
	assert_string_equal(view_report_score(score, 0.12345), "0.1235");
	FREED_MEMORY char *text = NULL;
	size_t size;
	struct view_frame f = view_frame_empty(7, 3.5, &request);
	f.vertices = 999;
	f.fetched.bytes = 1234;
	f.measures.score.q = 0.25;
	FILE *out = open_memstream(&text, &size);
	view_report_line(&f, false, out);
	fclose(out);
	assert_string_equal(text, "frame 0007  vertices 999 of 1000  bytes 1234  P -  R -  Q 0.2500  skill "
		"-  owner_q -  soft_q -  ceiling -  picture_error -  m16 -  s16 -\n");
}

static json_t *written(const struct view_report *report)
{
	folder_make("build/tmp/report");
	struct eco_error error = { 0 };
	assert_int_equal(view_report_write(report, "build/tmp/report", &error), ECO_OK);
	json_t *root = json_load_file("build/tmp/report/report.json", 0, NULL);
	assert_non_null(root);
	return root;
}

UNIT_TEST(report_has_every_figure)
{
	static const char *const names[] = { "frame", "time_s", "budget_vertices", "vertices", "budget_bytes",
		"bytes", "requests", "broken_answers", "cancelled_bytes", "named_chunks", "named_bytes",
		"memory_bytes", "evicted_chunks",
		"refetched_bytes", "precision", "recall",
		"q", "skill", "owner_q", "soft_q", "ceiling", "picture_error", "m16", "s16", "s16_abs",
		"bias_error", "floor_error", "shimmer", "pop", "truth_cpu_ms", "predicted_q", "predicted_m16", "plan_ms",
		"first_byte_ms", "stream_ms", "decode_ms",
		"draw_ms", "shadow_ms", "shadow_texels_per_pixel", "reference_ms",
		"reference_coarse" };
	FREED(view_report) report = { .scene = "park", .renderer = "software", .width = 800, .height = 600,
		.complete = true };
	struct view_measures measures = { .score = { .precision = 0.5, .recall = 0.75, .q = 0.4, .skill = NAN,
		.owner_q = 0.3 }, .soft_q = 0.6, .picture_error = 0.1, .blocks = { .color = 0.2 } };
	for (uint32_t i = 0; i < 3; i++) {
		struct view_frame f = view_frame_empty(i, i / 2.0, &request);
		f.vertices = 900 + i;
		f.fetched.bytes = 10;
		f.fetched.requests = 1 + 2 * i;
		f.fetched.broken = i;
		f.fetched.cancelled = 10 * i;
		f.evictions = 100 * i;
		f.again_bytes = 4 * i;
		if (i < 2)
			f.measures = measures, f.ceiling = 0.9;
		view_frames_add(&report.frames, &f);
	}
	json_t *root = written(&report), *frames = json_object_get(root, "frames"),
		*summary = json_object_get(root, "summary");
	assert_int_equal(json_array_size(frames), 3);
	json_t *first = json_array_get(frames, 0), *last = json_array_get(frames, 2);
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		assert_non_null(json_object_get(first, names[i]));
	assert_int_equal(json_object_size(first), sizeof names / sizeof names[0]);
	assert_true(json_is_null(json_object_get(first, "budget_bytes"))
		&& json_is_null(json_object_get(first, "skill")));
	assert_true(json_is_null(json_object_get(last, "q"))
		&& json_is_null(json_object_get(last, "plan_ms")));
	const struct { const json_t *of; const char *name; double value; } rows[] = { { first, "recall", 0.75 },
		{ first, "soft_q", 0.6 }, { first, "ceiling", 0.9 }, { summary, "mean_q", 0.4 },
		{ summary, "mean_picture_error", 0.1 }, { summary, "mean_m16", 0.2 }, { summary, "total_bytes", 30 },
		{ summary, "evicted_chunks", 300 }, { summary, "refetched_bytes", 12 },
		{ summary, "repeated_requests", 3 }, { summary, "broken_answers", 3 },
		{ summary, "cancelled_bytes", 30 }, { last, "broken_answers", 2 }, { last, "evicted_chunks", 200 } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		assert_true(json_number_value(json_object_get(rows[i].of, rows[i].name)) == rows[i].value);
	assert_true(json_is_null(json_object_get(summary, "mean_skill")));
	assert_true(json_is_null(json_object_get(summary, "memory_max_bytes")));
	assert_string_equal(json_string_value(json_object_get(root, "renderer")), "software");
	assert_true(json_is_null(json_object_get(root, "reference"))
		&& json_is_true(json_object_get(root, "complete")));
	json_decref(root);
}

UNIT_TEST(memory_is_spoken_of_where_something_had_to_go)
{
	static const char *const says[] = { "", "memory  1.5 MiB held at most  7 chunks evicted  50 of 1000 bytes "
		"fetched again  2 requests repeated\n" };
	for (uint64_t i = 0; i < 2; i++) {
		struct view_frame frames[2] = { { .fetched = { .bytes = 600, .requests = 1 } },
			{ .fetched = { .bytes = 400, .requests = 3 }, .evictions = 7 * i, .again_bytes = 50 } };
		struct view_report report = { .frames = { frames, 2, 2 }, .memory_peak_bytes = 3 << 19 };
		FREED_MEMORY char *text = NULL;
		size_t size;
		FILE *out = open_memstream(&text, &size);
		view_report_memory_line(&report, out);
		fclose(out);
		assert_string_equal(text, says[i]);
	}
}

UNIT_TEST(report_of_nothing_is_valid)
{
	struct view_report report = { 0 };
	json_t *root = written(&report);
	assert_int_equal(json_array_size(json_object_get(root, "frames")), 0);
	assert_true(json_is_null(json_object_get(json_object_get(root, "summary"), "mean_vertices")));
	json_decref(root);
	assert_code(view_report_write(&report, "build/tmp/report/none/such", &cause), ECO_IO, "build/tmp/report/none/such/report.json");
}

UNIT_TEST(query_keeps_every_digit)
{
	char text[VIEW_QUERY_BYTES];
	assert_true(view_query_write(&request, NULL, text, sizeof text) == strlen(text));
	assert_string_equal(text, "eye=1.5,-2,0.10000000000000001&target=0,0,1.0000000000000001e-09&up=0,0,"
		"1&fov_y_deg=45&width=800&height=600&vertices=1000");
	struct eco_request most =
		{ .view =
		{ .eye = { -1.2345678901234567e-300, -1.2345678901234567e-300, -1.2345678901234567e-300 } },
		.vertices = ECO_VERTICES_MAX, .bytes = ECO_BYTES_UNBOUNDED - 1 };
	for (int i = 0; i < 3; i++)
		most.view.target[i] = most.view.up[i] = most.view.eye[0];
	most.view.fov_y_deg = most.view.eye[0];
	most.view.width = most.view.height = UINT32_MAX;
	assert_true(view_query_write(&most, &(struct eco_chunk_id){ { 0xab } }, text, sizeof text) < sizeof text);
	assert_non_null(strstr(text, "&bytes=18446744073709551614"));
	assert_true(view_query_write(&most, &(struct eco_chunk_id){ { 0xab } }, text, 50) >= 50);
}

UNIT_TEST(plan_time_is_found_in_its_header)
{
	static const struct { const char *text; double ms; } rows[] = {
		{ " plan;dur=12.5", 12.5 }, { "cache;dur=1, plan;dur=3\r\n", 3 }, { "plan;dur=0", 0 },
			{ "airplan;dur=4", NAN },
		{ "plan;dur=", NAN }, { "plan;dur=-1", NAN }, { "plan;dur=nan", NAN }, { "", NAN },
		{ "total;dur=5", NAN },
	};
	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
		double ms = view_plan_ms_read(rows[i].text);
		assert_true(isnan(rows[i].ms) ? isnan(ms) : ms == rows[i].ms);
	}
}

UNIT_TEST(comparison_has_a_colour_for_each_case)
{
	const uint8_t cover[4] = { 0, 255, 0, 255 }, reference[4] = { 0, 0, 255, 255 };
	uint8_t rgb[12];
	view_picture_compare(cover, reference, 4, rgb);
	for (int i = 0; i < 4; i++)
		for (int j = 0; j < i; j++)
			assert_memory_not_equal(rgb + 3 * i, rgb + 3 * j, 3);
	assert_true(rgb[0] == 0 && rgb[1] == 0 && rgb[2] == 0);
}

UNIT_TEST(an_explanation_is_a_table)
{
	const struct view_full none = { .picture = NULL };
	char *text;
	size_t size;
	struct eco_error error = { 0 };
	FILE *out = open_memstream(&text, &size);
	assert_int_equal(view_explain_write(out, 3, "{\"explanation\": {\"lambda\": 0.5, \"omitted\": 0, "
		"\"expected_px\": [1.5, 200], \"rows\": ["
		"{\"list\": 7, \"first\": 0, \"end\": 4, \"plant\": \"oak, \\\"old\\\"\", \"band\": 99, "
		"\"plants\": 2, \"vertices\": 24, \"expected_px\": 8, \"gain_px\": 1.25, "
		"\"why\": \"all\", \"reason\": \"all of it is drawn\"}, {\"tile\": 1, \"plants\": 5, "
		"\"vertices\": 0, \"why\": \"plants\"}]}}", &none, &error), ECO_OK);
	fclose(out);
	assert_string_equal(text, "3,0.5,7,0,4,,\"oak, \"\"old\"\"\",99,,,,2,24,8,,1.25,,all,all of it is "
		"drawn\n3,0.5,,,,1,,,,,,5,0,,,,,plants,\n"
		"3,0.5,,,,,,,0,,,,,1.5,,,,distance,\n3,0.5,,,,,,,8,,,,,200,,,,distance,\n");
	free(text);
	out = open_memstream(&text, &size);
	assert_int_equal(view_explain_write(out, 0, "{\"explanation\": {\"lambda\": -1.5, \"rows\": "
		"[{\"list\": -7, \"plant\": \"=cmd|' /C calc'!A0\", \"why\": \"+1;2\", "
		"\"reason\": \"@a\\r\\n-b\"}, {\"plant\": \"-oak\", \"why\": \"\\t=1\", \"reason\": "
		"\" =1\"}, {\"plant\": \"a=b\", \"why\": \"\", \"reason\": \"\uff1d1\"}]}}",
		&none, &error), ECO_OK);
	fclose(out);
	assert_string_equal(text, "0,-1.5,-7,,,,'=cmd|' /C calc'!A0,,,,,,,,,,,\"'+1;2\",\"'@a\r\n-b\"\n"
		"0,-1.5,,,,,'-oak,,,,,,,,,,,\"'\t=1\",' =1\n0,-1.5,,,,,a=b,,,,,,,,,,,,'\uff1d1\n");
	free(text);
	assert_int_equal(view_explain_write(stdout, 0, "{\"cuts\": []}", &none, &error), ECO_UNSUPPORTED);
	assert_int_equal(view_explain_write(stdout, 0, "no JSON", &none, &(struct eco_error){ 0 }), ECO_UNSUPPORTED);
}
