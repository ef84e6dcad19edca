/* Flights from tracks: cameras that look where they go and do not jitter, and scripts that keep to the track.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/track/track.h"
#include "ecofiles/format/view.h"
#include "tests/support/track_made.h"
#include "tests/support/unit_test.h"

static struct eco_flight flight_with(const struct eco_track *track, const struct eco_track_options *options)
{
	struct eco_flight flight;
	eco_flight_make(&flight, track, options);
	for (uint32_t i = 0; i < flight.count; i++) {
		const struct eco_sample *s = &flight.samples[i];
		double look = 0, up = 0, dot = 0;
		for (int k = 0; k < 3; k++) {
			look += s->look[k] * s->look[k];
			up += s->up[k] * s->up[k];
			dot += s->look[k] * s->up[k];
		}
		assert_true(near(look, 1, 1e-6) && near(up, 1, 1e-6) && near(dot, 0, 1e-6));
	}
	return flight;
}

static struct eco_flight flight_of(const struct eco_track *track)
{
	return flight_with(track, &track_defaults);
}

static double yaw_of(const struct eco_sample *s) { return atan2(s->look[0], s->look[1]) * DEG; }

UNIT_TEST(rounded_positions_do_not_jitter)
{
	/* a circle of 100 m radius at 5 m/s, once a second, in steps of 11 m east and 8 m north: 4 decimals
	 * of a degree */
	struct made m = made_track(240);
	for (uint32_t i = 0; i < 240; i++) {
		double a = i * 0.05;
		put(&m, i, floor(100 * cos(a) / 11 + 0.5) * 11, floor(100 * sin(a) / 8 + 0.5) * 8,
			floor(30 + 10 * sin(a) + 0.5));
	}
	m.track.still_m = 8;
	struct eco_track_report report = cleaned(&m.track);
	struct eco_flight f = flight_of(&m.track);
	double fastest = 0, slowest = 1e9, turn = 0, back = 0;
	for (uint32_t i = 1; i < f.count; i++) {
		const double *a = f.samples[i - 1].eye, *b = f.samples[i].eye;
		double v = hypot(b[0] - a[0], b[1] - a[1]) / f.step_s, t = i * f.step_s;
		double rate = remainder(yaw_of(&f.samples[i]) - yaw_of(&f.samples[i - 1]), 360) / f.step_s;
		if (t < 15 || t > 220)
			continue;
		fastest = fmax(fastest, v);
		slowest = fmin(slowest, v);
		turn = fmax(turn, fabs(rate));
		back = fmax(back, rate);
		assert_true(near(hypot(b[0], b[1]), 100, 12));
	}
	/* 5 m/s, 2.9 degrees a second to the left */
	assert_true(report.kept > 50 && fastest < 8 && slowest > 2.5 && turn < 7 && back < 1.5);
	eco_flight_free(&f);
	eco_track_free(&m.track);
}

UNIT_TEST(cameras_look_where_they_go_and_wait_without_turning)
{
	struct made m = made_track(90);
	for (uint32_t i = 0; i < 90; i++)
		put(&m, i, i < 30 ? 5.0 * i : 150, i < 60 ? 0 : 5.0 * (i - 60), 20);
	cleaned(&m.track);
	m.track.format = ECO_TRACK_SRT;
	struct eco_flight f = flight_of(&m.track);
	double before = yaw_of(&f.samples[0]);
	assert_true(near(before, 90, 1) && near(yaw_of(&f.samples[f.count - 1]), 0, 1));
	for (uint32_t i = 1; i < f.count; i++) {
		double yaw = yaw_of(&f.samples[i]);
		assert_true(yaw < before + 0.5 && near(asin(f.samples[i].look[2]) * DEG, -15, 0.5));
		before = yaw;
	}
	assert_true(!f.yaw_recorded && f.samples[0].fov_y_deg == 60);
	eco_flight_free(&f);
	eco_track_free(&m.track);
}

UNIT_TEST(recorded_looks_turn_across_north)
{
	struct made m = straight(20);
	for (uint32_t i = 0; i < 20; i++) {
		struct eco_fix *fix = &m.track.fixes[i];
		fix->yaw_deg = fmod(350 + i, 360);
		fix->pitch_deg = -30;
		fix->roll_deg = 5;
		fix->fov_y_deg = 40 + i;
	}
	cleaned(&m.track);
	struct eco_flight f = flight_of(&m.track);
	for (uint32_t i = 0; i < f.count; i++) {
		double t = i * f.step_s;
		assert_true(fabs(remainder(yaw_of(&f.samples[i]) - 350 - t, 360)) < 0.3
			&& near(asin(f.samples[i].look[2]) * DEG, -30, 0.1));
		assert_true(near(f.samples[i].fov_y_deg, 40 + t, 1e-6));
	}
	assert_true(f.yaw_recorded && f.pitch_recorded && f.samples[0].up[2] < cos(30 / DEG));
	eco_flight_free(&f);
	eco_track_free(&m.track);
}

UNIT_TEST(flights_are_moved_turned_and_kept_above_ground)
{
	struct made m = straight(11);
	float heights[4] = { 0, 0, 40, 40 };
	struct eco_ground ground = { .columns = 2, .rows = 2, .x_m = -1000, .y_m = 0, .step_x_m = 2000,
		.step_y_m = 100, .height_m = heights };
	cleaned(&m.track);
	struct eco_flight f = flight_of(&m.track);
	struct eco_track_options move = { .speed = 2, .turn_deg = 90, .to_given = true, .to = { 7, 8, 9 },
		.ground = &ground, .has_ground = true,
		.clearance_m = 2 };
	double step_s = f.step_s;
	m.track.has_height = true;
	eco_flight_move(&f, &m.track, &move);
	const struct eco_sample *last = &f.samples[f.count - 1];
	assert_true(near(f.step_s, step_s / 2, 1e-12));
	/* 100 m along x are 100 m along y; the ground rises by 0.4 a metre */
	assert_true(near(f.samples[0].eye[0], 7, 0.3) && near(last->eye[1], 108, 0.5)
		&& near(last->look[1], 1, 1e-3));
	assert_true(near(f.samples[f.count / 2].eye[2], 0.4 * f.samples[f.count / 2].eye[1] + 2, 1e-4)
		&& f.raised > 0);
	move = (struct eco_track_options){ .look_at_given = true, .look_at = { 7, 1000, 20 } };
	eco_flight_move(&f, &m.track, &move);
	assert_true(f.samples[0].look[1] > 0.99);
	eco_flight_free(&f);
	eco_track_free(&m.track);
}

/* ---- Scripts ---- */

UNIT_TEST(scripts_keep_to_the_flight_as_they_say)
{
	/* stands, starts, corners, a gimbal that swings */
	struct made m = made_track(600);
	for (uint32_t i = 0; i < 600; i++) {
		double t = i * 0.2, x = t < 20 ? 0 : t < 60 ? 8 * (t - 20) : 320,
			y = t < 60 ? 0 : 8 * (t - 60);
		struct eco_fix *fix = put(&m, t, x, y, 50 + 20 * sin(t / 7));
		fix->yaw_deg = 180 + 170 * sin(t / 5);
		fix->pitch_deg = -45 + 45 * cos(t / 9);
	}
	cleaned(&m.track);
	struct eco_flight f = flight_of(&m.track);
	struct eco_script script;
	struct eco_camera *camera;
	assert_good(eco_script_fit(&script, &f, &(struct eco_track_options){ .fps = 1 / f.step_s },
		&cause));
	assert_true(script.error_m <= 0.05 && script.error_deg <= 0.5 && script.keys < f.count / 2);
	assert_good(eco_camera_parse(&camera, script.text, script.size, "made", &cause));
	assert_true(eco_camera_frame_count(camera) + 1 >= f.count);
	for (uint32_t i = 0; i < eco_camera_frame_count(camera) && i < f.count; i++) {
		struct eco_view view;
		const struct eco_sample *s = &f.samples[i];
		double d = 0, dot = 0, length = 0;
		eco_camera_frame(camera, i, &view);
		for (int k = 0; k < 3; k++) {
			d += (view.eye[k] - s->eye[k]) * (view.eye[k] - s->eye[k]);
			dot += (view.target[k] - view.eye[k]) * s->look[k];
			length += (view.target[k] - view.eye[k]) * (view.target[k] - view.eye[k]);
		}
		/* four decimals of fps and of metres */
		assert_true(sqrt(d) <= script.error_m + 0.02);
		assert_true(acos(fmin(1, dot / sqrt(length))) * DEG <= script.error_deg + 0.1);
	}
	eco_camera_free(camera);
	free(script.text);
	eco_flight_free(&f);
	eco_track_free(&m.track);
}

UNIT_TEST(still_cameras_are_one_keyframe)
{
	struct eco_track track = track_of("t,x,y,z,yaw,fov\n0,5,6,7,0,45.837\n", "t.csv");
	struct eco_script script;
	cleaned(&track);
	struct eco_flight f = flight_of(&track);
	assert_int_equal(eco_script_fit(&script, &f, &track_defaults, NULL), ECO_OK);
	assert_string_equal(script.text, "{\"fps\": 30, \"keyframes\": [\n  {\"time_s\": 0, \"eye\": [5, 6, "
		"7], \"target\": [5, 16, 7], \"up\": [0, 0, 1], \"fov_y_deg\": 45.837}\n]}\n");
	free(script.text);
	eco_flight_free(&f);
	eco_track_free(&track);
}

/* Looks that turn about between samples have no direction halfway: they go by a side, and the script plays.
 */
UNIT_TEST(cameras_that_turn_about_do_it_by_a_side)
{
	struct made m = made_track(40);
	for (uint32_t i = 0; i < 40; i++)
		put(&m, i * 0.02, i, 0, 20)->yaw_deg = i % 5 < 3 ? 0 : 180;
	cleaned(&m.track);
	struct eco_track_options exact = track_defaults;
	exact.smooth_s = 0;
	struct eco_flight f = flight_with(&m.track, &exact);
	struct eco_script script;
	struct eco_camera *camera;
	double most = 0;
	for (uint32_t i = 1; i < f.count; i++)
		most = fmax(most, eco_angle_deg(f.samples[i - 1].look, f.samples[i].look));
	assert_true(most < 171);
	assert_good(eco_script_fit(&script, &f, &(struct eco_track_options){ .fps = 1000 }, &cause));
	assert_good(eco_camera_parse(&camera, script.text, script.size, "made", &cause));
	eco_camera_free(camera);
	free(script.text);
	eco_flight_free(&f);
	eco_track_free(&m.track);
}
