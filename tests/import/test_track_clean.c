/* Tracks as recorders leave them: every slip repaired and counted, and degrees brought to the scene's metres.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/track/track.h"
#include "tests/support/track_made.h"
#include "tests/support/unit_test.h"

/* Each fix is where a motion of 10 m/s along x would have it. */
static void assert_even(const struct eco_track *track, double start_x)
{
	for (uint32_t i = 0; i < track->count; i++)
		if (!isnan(track->fixes[i].at[0])
				&& !near(track->fixes[i].at[0], start_x + 10 * track->fixes[i].time_s, 1e-3))
			fail_msg("fix %u at %g s is at %g", i, track->fixes[i].time_s, track->fixes[i].at[0]);
}

static void bogus_backward_equal_and_missing_stamps_are_repaired(void **state)
{
	static const struct { const char *name; struct { uint32_t fix; double time_s; } slips[4];
		uint64_t wrong, missing; } rows[] = {
		{ "1970", { { 0, -1.5e9 } }, 1, 0 }, { "years later", { { 20, 9e8 } }, 1, 0 },
			{ "missing", { { 7, NAN }, { 8, NAN }, { 49, NAN } }, 0, 3 },
		{ "one runs back", { { 30, 110.5 } }, 1, 0 }, { "one runs ahead", { { 30, 1000 } }, 1, 0 },
		{ "first is missing", { { 0, NAN } }, 0, 1 },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct made m = straight(50);
		for (int k = 0; k < 4; k++)
			if (rows[i].slips[k].time_s != 0 || k == 0)
				m.track.fixes[rows[i].slips[k].fix].time_s = rows[i].slips[k].time_s;
		struct eco_track_report report = cleaned(&m.track);
		if (report.stamps_wrong != rows[i].wrong || report.stamps_missing != rows[i].missing
				|| report.kept != 50)
			fail_msg("%s: %lu %lu, %lu kept", rows[i].name, (unsigned long)report.stamps_wrong,
				(unsigned long)report.stamps_missing, (unsigned long)report.kept);
		assert_even(&m.track, 0);
		eco_track_free(&m.track);
	}
}

static void whole_seconds_are_spread_over_their_fixes(void **state)
{
	struct made m = made_track(100);
	for (uint32_t i = 0; i < 100; i++)
		put(&m, floor(i / 10.0), i, 0, 0);
	struct eco_track_report report = cleaned(&m.track);
	assert_int_equal(report.stamps_equal, 90);
	assert_even(&m.track, 0);
	eco_track_free(&m.track);
}

static void reversed_unsorted_and_reset_clocks_are_told_apart(void **state)
{
	struct made reversed = made_track(50), unsorted = made_track(64), reset = straight(50);
	for (uint32_t i = 0; i < 50; i++)
		put(&reversed, 50 - i, 10.0 * (50 - i), 0, 0);
	struct eco_track_report report = cleaned(&reversed.track);
	assert_true(report.sorted);
	assert_even(&reversed.track, 10);
	for (uint32_t i = 0; i < 64; i++)
		put(&unsorted, i * 37 % 64, 10.0 * (i * 37 % 64), 0, 0);
	report = cleaned(&unsorted.track);
	assert_true(report.sorted && report.kept == 64);
	assert_even(&unsorted.track, 0);
	for (uint32_t i = 25; i < 50; i++)
		reset.track.fixes[i].time_s -= 90;
	report = cleaned(&reset.track);
	assert_true(report.stamps_wrong == 25 && report.kept == 50);
	assert_even(&reset.track, 0);
	eco_track_free(&reversed.track);
	eco_track_free(&unsorted.track);
	eco_track_free(&reset.track);
}

static void repeated_fixes_become_even_motion(void **state)
{
	/* 60 records a second, 7 positions a second, in motion; a look in every record */
	struct made m = made_track(600);
	for (uint32_t i = 0; i < 600; i++) {
		double t = i / 60.0, update = floor(t * 7 + 1e-9) / 7;
		put(&m, t, 10 * update, 0, 50)->yaw_deg = t;
	}
	struct eco_track_report report = cleaned(&m.track);
	assert_true(report.kept == 71 && report.repeated == 529);
	assert_int_equal(m.track.count, 600);
	struct eco_flight flight;
	struct eco_error error = { 0 };
	assert_int_equal(eco_flight_make(&flight, &m.track, &track_defaults, &error), ECO_OK);
	for (uint32_t i = 1; i < flight.count; i++) {
		double v = (flight.samples[i].eye[0] - flight.samples[i - 1].eye[0]) / flight.step_s,
			t = i * flight.step_s;
		assert_true(t > 9 || (v > 9.5 && v < 10.5));
		assert_true(near(atan2(flight.samples[i].look[0], flight.samples[i].look[1]) * DEG, t, 0.2));
	}
	eco_flight_free(&flight);
	eco_track_free(&m.track);
}

static void isolated_jumps_are_dropped_others_split(void **state)
{
	struct made spikes = straight(100), apart = made_track(100), glide = straight(100);
	spikes.track.fixes[0].at[1] = 4000;
	spikes.track.fixes[40].at[0] = -5e6;
	spikes.track.fixes[60].at[1] = spikes.track.fixes[61].at[1] = 700;
	spikes.track.fixes[80].at[2] = 5000;
	struct eco_track_report report = cleaned(&spikes.track);
	assert_true(report.jumped == 5 && report.kept == 95 && report.parts == 1);
	assert_even(&spikes.track, 10);
	for (uint32_t i = 0; i < 100; i++)
		put(&apart, i, i < 40 ? 10.0 * i : 12000 + 10 * i, 0, 0);
	report = cleaned(&apart.track);
	assert_true(report.parts == 2 && report.kept == 60 && report.jumped == 40);
	assert_even(&apart.track, 12400);
	/* a receiver corrects itself by 100 m: no end, but no flash either */
	for (uint32_t i = 50; i < 100; i++)
		glide.track.fixes[i].at[0] += 100;
	report = cleaned(&glide.track);
	assert_true(report.retimed == 1 && report.parts == 1 && report.kept == 100);
	assert_even(&glide.track, 0);
	eco_track_free(&spikes.track);
	eco_track_free(&apart.track);
	eco_track_free(&glide.track);
}

static void fast_stretches_are_no_jumps(void **state)
{
	/* a walk, a ride, a walk */
	struct made m = made_track(300);
	double x = 0;
	for (uint32_t i = 0; i < 300; i++, x += i >= 140 && i < 160 ? 25 : 1.4)
		put(&m, i, x, 0, 0);
	struct eco_track_report report = cleaned(&m.track);
	assert_true(report.kept == 300 && report.parts == 1 && report.retimed == 0);
	eco_track_free(&m.track);
}

static void gaps_without_motion_are_shortened(void **state)
{
	struct made m = made_track(200);
	for (uint32_t i = 0; i < 200; i++)
		put(&m, i < 100 ? i : i + 3600, 10.0 * (i < 100 ? i : i - 1), 0, 0);
	struct eco_track_report report = cleaned(&m.track);
	assert_true(report.retimed == 1 && near(m.track.fixes[m.track.count - 1].time_s, 99 + 60 + 99, 1.1));
	eco_track_free(&m.track);
}

static void without_times_a_pace_is_taken(void **state)
{
	struct made m = made_track(3);
	put(&m, NAN, 0, 0, NAN);
	put(&m, NAN, 30, 40, NAN);
	put(&m, NAN, 30, 90, NAN);
	struct eco_track_report report = cleaned(&m.track);
	assert_true(report.untimed && near(m.track.fixes[1].time_s, 5, 1e-9)
		&& near(m.track.fixes[2].time_s, 10, 1e-9));
	eco_track_free(&m.track);
}

static void heights_are_absolute_relative_or_interpolated(void **state)
{
	static const struct { enum eco_track_height wanted, taken; double first; } rows[] =
		{ { ECO_HEIGHTS_DEFAULT, ECO_HEIGHTS_RELATIVE, 5 },
		{ ECO_HEIGHTS_ABSOLUTE, ECO_HEIGHTS_ABSOLUTE, 305 } };
	for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
		struct made m = straight(10);
		for (uint32_t i = 0; i < 10; i++) {
			m.track.fixes[i].at[2] = i == 4 ? NAN : 305 + i;
			m.track.fixes[i].above_m = i == 4 ? NAN : 5 + i;
		}
		struct eco_track_options options = track_defaults;
		options.height = rows[k].wanted;
		m.track.notes = fmemopen(track_notes, sizeof track_notes, "w");
		assert_int_equal(eco_track_place(&m.track, &options, NULL), ECO_OK);
		fclose(m.track.notes);
		assert_true(m.track.height == rows[k].taken && strstr(track_notes, "1 fixes have no height")
			&& m.track.fixes[0].at[2] == rows[k].first);
		eco_track_free(&m.track);
	}
	struct made m = straight(10), flat = made_track(1);
	struct eco_track_options options = track_defaults;
	options.height = ECO_HEIGHTS_RELATIVE;
	assert_int_equal(eco_track_place(&m.track, &options, NULL), ECO_OK);
	assert_true(m.track.height == ECO_HEIGHTS_RELATIVE && m.track.fixes[0].at[2] == 0);
	put(&flat, 0, 0, 0, NAN);
	assert_int_equal(eco_track_place(&flat.track, &options, NULL), ECO_BAD_INPUT);
	assert_int_equal(eco_track_place(&flat.track, &track_defaults, NULL), ECO_OK);
	assert_true(!flat.track.has_height);
	eco_track_free(&m.track);
	eco_track_free(&flat.track);
}

/* ---- Places ---- */

static void degrees_become_metres_of_the_scene(void **state)
{
	struct eco_track track = track_of("t,lon,lat,alt,yaw\n0,15,50,300,0\n1,15.001,50,301,0\n", "a.csv"),
		grid = track_of("t,lon,lat,yaw\n0,16.5,50,0\n", "b.csv"),
		metres = track_of("t,x,y\n0,500010,5538630\n", "c.csv");
	struct eco_track_options utm = { .crs = "EPSG:32633", .origin = { 500000, 5538630, 290 } };
	struct eco_error error = { 0 };
	if (eco_track_place(&track, &utm, &error))
		fail_msg("%s", error.text);
	/* zone 33 has its meridian at 15 degrees; 50 degrees north are 5538630.70 m */
	assert_true(near(track.fixes[0].at[0], 0, 1e-3) && near(track.fixes[0].at[1], 0.70, 0.01)
		&& track.fixes[0].at[2] == 10);
	assert_true(near(track.fixes[1].at[0], 71.67, 0.05) && near(track.fixes[0].yaw_deg, 0, 1e-3)
		&& near(track.still_m, 71.5, 0.3));
	/* a degree and a half east of it grid north is turned by about 1.5 sin 50 */
	assert_int_equal(eco_track_place(&grid, &utm, &error), ECO_OK);
	assert_true(near(grid.fixes[0].yaw_deg, -1.149, 0.01));
	struct eco_track_options far = utm;
	far.track_crs = "EPSG:32633";
	assert_int_equal(eco_track_place(&metres, &far, &error), ECO_OK);
	assert_true(near(metres.fixes[0].at[0], 10, 1e-6) && near(metres.fixes[0].at[1], 0, 1e-6));
	eco_track_free(&grid);
	grid = track_of("t,lon,lat\n0,16.5,50\n1,16.5,50.001\n", "b.csv");
	assert_int_equal(eco_track_place(&grid, &(struct eco_track_options){ .crs = "EPSG:4326" }, &error),
		ECO_BAD_INPUT);
	assert_non_null(strstr(error.text, "not one in metres"));
	error = (struct eco_error){ 0 };
	assert_int_equal(eco_track_place(&grid, &(struct eco_track_options){ .crs = NULL }, &error), ECO_OK);
	assert_true(near(grid.fixes[1].at[1] - grid.fixes[0].at[1], 111.23, 0.05));
	eco_track_free(&track);
	eco_track_free(&grid);
	eco_track_free(&metres);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(bogus_backward_equal_and_missing_stamps_are_repaired),
		cmocka_unit_test(whole_seconds_are_spread_over_their_fixes),
		cmocka_unit_test(reversed_unsorted_and_reset_clocks_are_told_apart),
		cmocka_unit_test(repeated_fixes_become_even_motion),
		cmocka_unit_test(isolated_jumps_are_dropped_others_split),
		cmocka_unit_test(fast_stretches_are_no_jumps),
		cmocka_unit_test(gaps_without_motion_are_shortened),
		cmocka_unit_test(without_times_a_pace_is_taken),
		cmocka_unit_test(heights_are_absolute_relative_or_interpolated),
		cmocka_unit_test(degrees_become_metres_of_the_scene),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
