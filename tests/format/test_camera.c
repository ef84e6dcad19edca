/* Camera scripts and views: what they mean to the number, and that whatever cannot be drawn is refused by
 * name. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/format/view.h"
#include "tests/support/cases.h"
#include "tests/support/files.h"
#include "tests/support/unit_test.h"

#define KEY(time, x) "{\"time_s\": " time ", \"eye\": [" x ", 0, 2], \"target\": [0, 50, 1], " \
	"\"fov_y_deg\": 45}"
#define SCRIPT(fps, keys) "{\"fps\": " fps ", \"keyframes\": [" keys "]}"

OWNABLE(eco_camera, eco_camera_free)

static struct eco_camera *camera_of(const char *json)
{
	struct eco_camera *camera;
	assert_good(eco_camera_parse(&camera, json, strlen(json), "tour.json", &cause));
	return camera;
}

UNIT_TEST(frames_run_to_the_last_keyframe)
{
	struct row { const char *json; uint32_t frames; double last_s; };
	uint32_t count;
	const struct row *rows = cases_rows("tests/format/cases/camera_frames.tsv", "sud", sizeof *rows,
		&count);
	for (size_t i = 0; i < count; i++) {
		OWNED(eco_camera) *camera = camera_of(rows[i].json);
		struct eco_view view = { .width = 640, .height = 480 };
		assert_int_equal(eco_camera_frame_count(camera), rows[i].frames);
		assert_true(eco_camera_frame(camera, rows[i].frames - 1, &view) == rows[i].last_s);
		assert_true(view.width == 640 && view.height == 480);
		assert_true(eco_camera_key(camera, eco_camera_key_count(camera) - 1, &view) >= rows[i].last_s);
	}
}

UNIT_TEST(a_request_may_be_given_the_view_ahead)
{
	OWNED(eco_camera) *camera = camera_of(SCRIPT("2", KEY("0", "1") "," KEY("3", "2")));
	static const struct { uint32_t frame; double seconds; uint32_t then; } rows[] = { { 0, 1, 2 },
		{ 0, 0.9, 2 }, { 0, 0.1, 1 }, { 4, 1, 6 }, { 4, 100, 6 }, { 6, 1, 6 } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct eco_request request = { .vertices = 7 };
		struct eco_view view = { .width = 0 };
		eco_camera_ahead(camera, rows[i].frame, rows[i].seconds, &request);
		eco_camera_frame(camera, rows[i].then, &view);
		assert_int_equal(request.next.given, rows[i].then > rows[i].frame);
		assert_memory_equal(request.next.eye, view.eye, sizeof view.eye);
		assert_memory_equal(request.next.target, view.target, sizeof view.target);
	}
}

/* Else what is told of the next view parts the requests of clients that are nearly at one place. */
UNIT_TEST(the_next_view_snaps_as_the_view_does)
{
	struct eco_request requests[2] = { { .next.given = true }, { .next.given = true } };
	for (int i = 0; i < 2; i++) {
		struct eco_request *r = &requests[i];
		r->view = (struct eco_view){ .eye = { 10.2 + 0.001 * i, -3.9, 1.7 }, .target = { 60, 0.1, -0.2 } };
		memcpy(r->next.eye, (double[3]){ 12.2, -3.9 - 0.001 * i, 1.7 }, sizeof r->next.eye);
		memcpy(r->next.target, (double[3]){ 60.2, 0.1 + 0.001 * i, -0.2 }, sizeof r->next.target);
		eco_request_snap(r, 0.5);
	}
	assert_memory_equal(&requests[0], &requests[1], sizeof requests[0]);
	assert_true(requests[0].next.given && requests[0].next.eye[0] == 12 && requests[0].next.target[1] == 0);
}

UNIT_TEST(scripts_say_what_heights_count_from)
{
	static const struct {
		const char *json;
		bool above;
	} rows[] = { { SCRIPT("2", KEY("0", "1")), false },
		{ "{\"fps\": 1, \"above_ground\": true, \"keyframes\": [" KEY("0", "1") "]}", true },
		{ "{\"fps\": 1, \"above_ground\": false, \"keyframes\": [" KEY("0", "1") "]}", false } };
	for (size_t i = 0; i < 3; i++) {
		OWNED(eco_camera) *camera = camera_of(rows[i].json);
		assert_int_equal(eco_camera_above_ground(camera), rows[i].above);
	}
}

/* The spline written out in another way, by its Bernstein form (control points a third of the way along the
 * slopes). */
static double bezier(double t, double ta, double tb, double a, double b, double slope_a, double slope_b)
{
	double s = (t - ta) / (tb - ta), h = (tb - ta) / 3, c = a + h * slope_a, d = b - h * slope_b;
	return (1 - s) * (1 - s) * (1 - s) * a + 3 * s * (1 - s) * (1 - s) * c + 3 * s * s * (1 - s) * d
		+ s * s * s * b;
}

UNIT_TEST(between_keyframes_lies_a_catmull_rom_spline)
{
	static const double t[] = { 0, 1, 1.5, 4 }, x[] = { 3, 10, -2, 5 };
	double slope[4] = { (x[1] - x[0]) / (t[1] - t[0]), (x[2] - x[0]) / (t[2] - t[0]),
		(x[3] - x[1]) / (t[3] - t[1]), (x[3] - x[2]) / (t[3] - t[2]) };
	OWNED(eco_camera) *camera =
		camera_of(SCRIPT("50", KEY("0", "3") "," KEY("1", "10") "," KEY("1.5", "-2") "," KEY("4",
		"5")));
	struct eco_view view;
	for (uint32_t i = 0; i < eco_camera_frame_count(camera); i++) {
		double time = eco_camera_frame(camera, i, &view);
		int k = time < 1 ? 0 : time < 1.5 ? 1 : 2;
		double expected = bezier(time, t[k], t[k + 1], x[k], x[k + 1], slope[k], slope[k + 1]);
		assert_true(fabs(view.eye[0] - expected) < 1e-9);
		double bound = 4.0 / 27 * (t[k + 1] - t[k]) * (fabs(slope[k]) + fabs(slope[k + 1])) + 1e-9;
		assert_true(view.eye[0] <= fmax(x[k], x[k + 1]) + bound && view.eye[0] >= fmin(x[k], x[k + 1])
			- bound);
	}
}

UNIT_TEST(impossible_scripts_are_refused_by_name)
{
	struct fault { const char *json, *text; };
	uint32_t count;
	const struct fault *rows = cases_read("tests/format/cases/camera_faults.tsv", sizeof *rows, &count);
	for (uint32_t i = 0; i < count; i++) {
		struct eco_camera *camera = (void *)1;
		struct eco_error error = { 0 };
		enum eco_code code = eco_camera_parse(&camera, rows[i].json, strlen(rows[i].json),
			"tour.json", &error);
		if (code == ECO_OK || code != error.code || camera
				|| strncmp(error.text, rows[i].text, strlen(rows[i].text)) != 0)
			fail_msg("row %u: code %d, \"%s\" where \"%s\" was expected", i, code, error.text,
				rows[i].text);
	}
}

UNIT_TEST(scripts_are_loaded_from_files)
{
	static const char path[] = "build/tmp/test_camera.json";
	struct eco_camera *camera;
	struct eco_error error = { 0 };
	folder_make("build/tmp");
	assert_int_equal(eco_camera_load(&camera, "build/tmp/not-there.json", &error), ECO_NOT_FOUND);
	assert_true(strstr(error.text, "not-there.json") && !camera);
	/* a script of more than one portion of reading */
	FILE *file = fopen(path, "wb");
	assert_non_null(file);
	fputs("{\"fps\": 1, \"keyframes\": [" KEY("0", "1"), file);
	for (int i = 1; i < 300; i++)
		fprintf(file, ", {\"time_s\": %d, \"eye\": [%d, 0, 2], \"target\": [0, 50, 1], \"up\": [0, "
			"0, 1], \"fov_y_deg\": 45}", i, i);
	fputs("]}", file);
	fclose(file);
	assert_int_equal(eco_camera_load(&camera, path, NULL), ECO_OK);
	assert_int_equal(eco_camera_frame_count(camera), 300);
	eco_camera_free(camera);
	eco_camera_free(NULL);
	error.code = ECO_OK;
	assert_int_equal(eco_camera_load(&camera, "build/tmp", &error), ECO_IO);
	remove(path);
}

UNIT_TEST(views_that_cannot_be_drawn_are_refused)
{
	static const struct eco_view good = { { 0, 0, 1 }, { 0, 5, 1 }, { 0, 0, 1 }, 45, 800, 600 };
	assert_int_equal(eco_view_check(&good, NULL), ECO_OK);
	for (int fault = 0; fault < 16; fault++) {
		struct eco_view v = good;
		struct eco_error error = { 0 };
		const char *field = "";
		switch (fault) {
		case 0: v.eye[1] = NAN, field = "eye"; break;
		case 1: v.eye[2] = INFINITY, field = "eye"; break;
		case 2: v.target[0] = -1.1e12, field = "target"; break;
		case 3: v.up[0] = NAN, field = "up"; break;
		case 4: v.target[1] = 0, field = "target"; break;
		case 5: v.fov_y_deg = 0, field = "fov_y_deg"; break;
		case 6: v.fov_y_deg = 180, field = "fov_y_deg"; break;
		case 7: v.fov_y_deg = NAN, field = "fov_y_deg"; break;
		case 8: v.width = 0, field = "width"; break;
		case 9: v.width = ECO_IMAGE_MAX + 1, field = "width"; break;
		case 10: v.height = 0, field = "height"; break;
		case 11: v.height = UINT32_MAX, field = "height"; break;
		case 12: v.fov_y_deg = -45, field = "fov_y_deg"; break;
		case 13: v.eye[0] = 1e13, field = "eye"; break;
		case 14: v.fov_y_deg = 1e-323, field = "fov_y_deg"; break;
		case 15: v.fov_y_deg = nextafter(180, 0), field = "fov_y_deg"; break;
		}
		assert_int_equal(eco_view_check(&v, &error), ECO_BAD_INPUT);
		assert_true(strncmp(error.text, field, strlen(field)) == 0);
	}
	struct eco_view steep = good;
	steep.up[1] = 1, steep.up[2] = 0;        /* along the view: another is chosen */
	assert_int_equal(eco_view_check(&steep, NULL), ECO_OK);
}

/* Somebody walks north, and told that they would look east ten metres on. */
UNIT_TEST(who_looks_or_walks_elsewhere_has_turned)
{
	struct eco_request request = { .view = { { 0, 0, 2 }, { 0, 50, 2 }, { 0, 0, 1 }, 60, 640, 480 },
		.next = { true, { 0, 10, 2 }, { 50, 10, 2 } } };
	static const struct { double eye[2], toward[2]; bool turned; } rows[] = {
		{ { 0, 0 }, { 0, 1 }, false }, { { 0, 5 }, { 0, 1 }, false }, { { 0, 5 }, { 1, 1 }, false },
		{ { 0, 10 }, { 1, 0 }, false }, { { 0, 12 }, { 1, -0.2 }, false },
		{ { 0, 1 }, { -0.2, 1 }, false }, { { 0, 1 }, { -0.3, 1 }, true }, { { 0, 5 }, { -1, 0 }, true },
		{ { 0, -2 }, { 0, 1 }, false }, { { 0, -3 }, { 0, 1 }, true }, { { 9, 0 }, { 1, 1 }, true } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct eco_view now = request.view;
		for (int k = 0; k < 2; k++) {
			now.eye[k] = rows[i].eye[k];
			now.target[k] = rows[i].eye[k] + 7 * rows[i].toward[k];
		}
		assert_int_equal(eco_view_turned(&request, &now), rows[i].turned);
	}
}
