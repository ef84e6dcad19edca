/* Recorded tracks: every format to the number, files that are no tracks, slips of recorders repaired and
 * counted, and degrees brought to the scene's metres. Each format is written out as the small recording
 * that shows it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/track/track.h"
#include "tests/support/cases.h"
#include "tests/support/input_files.h"
#include "tests/support/told.h"
#include "tests/support/track_made.h"
#include "tests/support/unit_test.h"

/* The error names the file, and says so. */
static void fails(const char *text, const char *name, const char *says)
{
	struct eco_track track = { 0 };
	struct eco_error error = { 0 };
	const char *path = input_text(program_invocation_short_name, name, text);
	assert_int_not_equal(eco_track_read(&track, path, &error), ECO_OK);
	assert_null(track.fixes);
	if (!strstr(error.text, says) || !strstr(error.text, name))
		fail_msg("%s\n  wanted ... %s", error.text, says);
}

/* wanted: the first numbers of a fix, as texts */
static void assert_fix(const struct eco_fix *fix, const char *const wanted[7], const char *name)
{
	bool same = true;
	for (int i = 0; i < 7; i++)
		same = same && near(fix->n[i], cases_number(wanted[i]), i ? 1e-9 : 1e-6);
	if (!same)
		fail_msg("%s: t %.9g at %.9g %.9g %.9g above %.9g yaw %.9g pitch %.9g", name, fix->time_s,
			fix->at[0], fix->at[1], fix->at[2], fix->above_m, fix->yaw_deg, fix->pitch_deg);
}

/* ---- Subtitles ---- */

UNIT_TEST(subtitles_of_every_drone_are_read)
{
	struct srt_case { const char *name, *text, *count, *last[7]; };
	uint32_t count;
	const struct srt_case *rows = cases_read("tests/import/cases/track_srt.tsv", sizeof *rows, &count);
	for (uint32_t i = 0; i < count; i++) {
		struct eco_track track = track_of(rows[i].text, "film.SRT");
		assert_int_equal(track.format, ECO_TRACK_SRT);
		assert_true(track.degrees && track.timed);
		assert_int_equal(track.count, (uint32_t)cases_number(rows[i].count));
		assert_fix(&track.fixes[track.count - 1], rows[i].last, rows[i].name);
		eco_track_free(&track);
	}
}

UNIT_TEST(focal_lengths_are_fields_of_view)
{
	static const struct { const char *text; double mm; } rows[] = { { "[focal_len : 240]", 24 },
		{ "[focal_len: 24.00]", 24 }, { "[focal_len: 40.00] [dzoom_ratio: 2.00]", 80 },
		{ "[focal_len : 240] [dzoom_ratio: 10000, delta:0]", 24 }, { "[iso: 100]", NAN } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		char text[300];
		snprintf(text, sizeof text, "1\n00:00:00,000 --> 00:00:00,033\n%s [latitude: 1] [longitude: "
			"2]\n", rows[i].text);
		struct eco_track track = track_of(text, "film.srt");
		assert_true(near(track.fixes[0].fov_y_deg, 2 * atan(10.125 / rows[i].mm) * DEG, 1e-9));
		eco_track_free(&track);
	}
}

/* ---- Through GDAL: files, in the child ---- */

UNIT_TEST(gpx_tracks_win_over_way_points)
{
	struct eco_track track = track_of("<?xml version=\"1.0\"?><gpx><wpt lat=\"1\" "
		"lon=\"2\"><name>x</name></wpt><rte><rtept lat=\"3\" "
		"lon=\"4\"/></rte><trk><trkseg></trkseg><trkseg><trkpt lat=\"45.5\" lon=\"14.25\"><ele> "
		"733.6 </ele></trkpt><trkpt lon=\"14.5\" "
		"lat=\"45.75\"><time>2010-10-03T09:36:30.25Z</time><extensions><heading>12.5</heading></exten"
		"sions></trkpt></trkseg><trkseg><trkpt lat='46' "
		"lon='15'><time>2010-10-03T11:36:31+02:00</time></trkpt></trkseg></trk></gpx>", "a.gpx");
	assert_int_equal(track.format, ECO_TRACK_GPX);
	assert_true(track.count == 3 && track.degrees && track.timed);
	assert_true(track.fixes[0].at[1] == 45.5 && track.fixes[0].at[0] == 14.25 && track.fixes[0].at[2]
		== 733.6 && isnan(track.fixes[0].time_s));
	assert_true(track.fixes[1].time_s == 1286098590.25 && isnan(track.fixes[1].at[2])
		&& track.fixes[2].time_s == 1286098591);
	assert_true(track.fixes[1].yaw_deg == 12.5 && isnan(track.fixes[0].yaw_deg));
	eco_track_free(&track);
	track = track_of("<gpx><wpt lat='9' lon='9'/><rte><rtept lat='3' "
		"lon='4'><time>2010-10-03T09:36:30Z</time></rtept></rte></gpx>", "b.gpx");
	assert_true(track.count == 1 && track.fixes[0].at[0] == 4 && track.fixes[0].time_s == 1286098590);
	eco_track_free(&track);
	fails("<gpx version='1.1'><trk><trkseg><trkpt lat='1' lon='2'></trk>", "bad.gpx",
		"GDAL cannot read it");
	fails("<gpx version='1.1'><trk><trkseg><trkpt lat='1' lon='2'></trkpt><trkpt lat='1' "
		"lon='3'><ele>5", "cut.gpx", "GDAL cannot read it");
	fails("<gpx></gpx>", "none.gpx", "no fix found");
}

/* A recorder whose battery died leaves a file without an end. */
UNIT_TEST(gpx_that_breaks_off_is_read_until_there)
{
	const size_t room = 1u << 20;
	char *text = malloc(room);
	size_t used = 0;
	assert_non_null(text);
	used += (size_t)snprintf(text, room, "<gpx><trk><trkseg>");
	for (int i = 0; i < 5000; i++)
		used += (size_t)snprintf(text + used, room - used,
			"<trkpt lat='1.%04d' lon='2'><time>2020-01-01T%02d:%02d:%02dZ</time></trkpt>\n", i,
			i / 3600, i / 60 % 60, i % 60);
	struct eco_track track = track_of(text, "long.gpx");
	assert_true(track.count > 4000 && track.fixes[track.count - 1].time_s - track.fixes[0].time_s
		== track.count - 1 && strstr(track_notes, "breaks off"));
	eco_track_free(&track);
	free(text);
}

/* ---- Tables ---- */

UNIT_TEST(tables_are_read_by_the_names_of_their_columns)
{
	struct csv_case { const char *name, *text, *degrees, *first[7]; };
	uint32_t count;
	const struct csv_case *rows = cases_read("tests/import/cases/track_csv.tsv", sizeof *rows, &count);
	for (uint32_t i = 0; i < count; i++) {
		struct eco_track track = track_of(rows[i].text, "log.csv");
		assert_int_equal(track.format, ECO_TRACK_CSV);
		assert_true(track.degrees == (*rows[i].degrees == '1'));
		assert_fix(&track.fixes[0], rows[i].first, rows[i].name);
		eco_track_free(&track);
	}
}

UNIT_TEST(what_is_no_track_is_said_to_be_none)
{
	struct fault_case { const char *text, *path, *says; };
	uint32_t count;
	const struct fault_case *rows = cases_read("tests/import/cases/track_faults.tsv", sizeof *rows, &count);
	for (uint32_t i = 0; i < count; i++)
		fails(rows[i].text, rows[i].path, rows[i].says);
	struct eco_track track = track_of("{\"keyframes\": []}", "script.json");
	assert_true(track.format == ECO_TRACK_SCRIPT && !track.count);
	eco_track_free(&track);
	assert_code(eco_track_read(&track, "tests", &cause), ECO_IO, "");
	assert_code(eco_track_read(&track, "no/such/file.srt", &cause), ECO_NOT_FOUND, "");
}

UNIT_TEST(records_without_a_position_are_counted)
{
	struct eco_track track = track_of("1\n00:00:00,000 --> 00:00:01,000\nHOME(8.2,47.4) "
		"GPS(8.2,47.4,12.5m) BAROMETER:3\n\n2\n00:00:01,000 --> 00:00:02,000\nGPS(n/a,n/a,n/a)\n",
		"a.srt");
	assert_true(track.count == 1 && track.records == 2 && track.skipped == 1 && track.skipped_line == 6);
	eco_track_free(&track);
}

/* ---- Cleaning: every slip repaired and counted ---- */

/* Changes of fix i of a motion of 10 m/s along x, from 100 s on. */
#define MOTION(name, change) static void name(uint32_t i, struct eco_fix *fix) { change; }
MOTION(whole_seconds, fix->time_s = floor(i / 10.0); fix->at[0] = i)
MOTION(reversed, fix->time_s = 50 - i; fix->at[0] = 10.0 * (50 - i))
MOTION(unsorted, fix->time_s = i * 37 % 64; fix->at[0] = 10.0 * (i * 37 % 64))
MOTION(set_back, fix->time_s -= i < 25 ? 0 : 90)
MOTION(spikes, fix->at[0] = i == 40 ? -5e6 : fix->at[0]; fix->at[2] = i == 80 ? 5000 : 50;
	fix->at[1] = i == 0 ? 4000 : i == 60 || i == 61 ? 700 : 0)
MOTION(apart, fix->time_s = i; fix->at[0] += i < 40 ? 0 : 12000)
MOTION(corrected, fix->at[0] += i < 50 ? 0 : 100)
MOTION(walk_ride_walk, fix->at[0] = 1.4 * i + 23.6 * fmin(fmax((int)i - 139, 0), 20))
MOTION(gap, fix->time_s = i < 100 ? i : i + 3600; fix->at[0] -= i < 100 ? 0 : 10)
MOTION(untimed, fix->time_s = fix->at[2] = NAN; fix->at[0] = i ? 30 : 0; fix->at[1] = i ? 50.0 * i - 10 : 0)

static const struct { const char *name; uint32_t count; void (*change)(uint32_t i, struct eco_fix *fix);
	struct { uint32_t fix; double time_s; } slips[3]; const char *wanted; } motions[] = {
	{ "1970", 50, NULL, { { 0, -1.5e9 } }, "wrong=1|missing=0|kept=50|even=0" },
	{ "years later", 50, NULL, { { 20, 9e8 } }, "wrong=1|missing=0|kept=50|even=0" },
	{ "missing", 50, NULL, { { 7, NAN }, { 8, NAN }, { 49, NAN } }, "wrong=0|missing=3|kept=50|even=0" },
	{ "one runs back", 50, NULL, { { 30, 110.5 } }, "wrong=1|missing=0|kept=50|even=0" },
	{ "one runs ahead", 50, NULL, { { 30, 1000 } }, "wrong=1|missing=0|kept=50|even=0" },
	{ "first is missing", 50, NULL, { { 0, NAN } }, "wrong=0|missing=1|kept=50|even=0" },
	{ "whole seconds are spread over their fixes", 100, whole_seconds, .wanted = "equal=90|even=0" },
	{ "reversed", 50, reversed, .wanted = "sorted=1|even=10" },
	{ "unsorted", 64, unsorted, .wanted = "sorted=1|kept=64|even=0" },
	{ "a clock that is set back", 50, set_back, .wanted = "wrong=25|kept=50|even=0" },
	{ "isolated jumps are dropped", 100, spikes, .wanted = "jumped=5|kept=95|parts=1|even=10" },
	{ "others split", 100, apart, .wanted = "parts=2|kept=60|jumped=40|even=12400" },
	/* a receiver corrects itself by 100 m: no end, but no flash either */
	{ "corrections", 100, corrected, .wanted = "retimed=1|parts=1|kept=100|even=0" },
	{ "fast stretches are no jumps", 300, walk_ride_walk, .wanted = "kept=300|parts=1|retimed=0" },
	{ "gaps without motion are shortened", 200, gap, .wanted = "retimed=1|last=258" },
	{ "without times a pace is taken", 3, untimed, .wanted = "untimed=1|t1=5|t2=10" },
};

static const struct eco_track *told;

/* "even": each fix is where a motion of 10 m/s from there on would have it; "last": the end, to 1.1 s. */
static void tell(const char *key, uint32_t number, const char *wanted, char *to, size_t size)
{
	const struct eco_track_report *r = &told->report;
	const struct { const char *key; double value; } numbers[] = { { "kept", r->kept }, { "jumped", r->jumped },
		{ "parts", r->parts }, { "retimed", r->retimed }, { "sorted", r->sorted }, { "untimed", r->untimed },
		{ "equal", r->stamps_equal }, { "wrong", r->stamps_wrong }, { "missing", r->stamps_missing },
		{ "t", told->fixes[number].time_s } };
	double start = strtod(wanted, NULL), off = told->fixes[told->count - 1].time_s - start;
	for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
		if (strcmp(key, numbers[i].key) == 0)
			snprintf(to, size, "%.10g", numbers[i].value);
	if (strcmp(key, "last") == 0)
		snprintf(to, size, "%.10g", near(off, 0, 1.1) ? start : start + off);
	if (strcmp(key, "even") != 0)
		return;
	snprintf(to, size, "%.10g", start);
	for (uint32_t i = 0; i < told->count; i++)
		if (!isnan(told->fixes[i].at[0]) && !near(told->fixes[i].at[0], start + 10 * told->fixes[i].time_s, 1e-3))
			snprintf(to, size, "fix %u is at %g", i, told->fixes[i].at[0]);
}

UNIT_TEST(every_slip_is_repaired_and_counted)
{
	for (size_t i = 0; i < sizeof motions / sizeof *motions; i++) {
		struct made made = straight(motions[i].count);
		for (uint32_t k = 0; k < motions[i].count && motions[i].change; k++)
			motions[i].change(k, &made.track.fixes[k]);
		for (int k = 0; k < 3; k++)
			if (motions[i].slips[k].time_s != 0)
				made.track.fixes[motions[i].slips[k].fix].time_s = motions[i].slips[k].time_s;
		print_message("# %s\n", motions[i].name);
		cleaned(&made.track);
		told = &made.track;
		expect_told(motions[i].wanted, tell);
		eco_track_free(&made.track);
	}
}

UNIT_TEST(repeated_fixes_become_even_motion)
{
	/* 60 records a second, 7 positions a second, in motion; a look in every record */
	struct made made = made_track(600);
	for (uint32_t i = 0; i < 600; i++) {
		double t = i / 60.0, update = floor(t * 7 + 1e-9) / 7;
		put(&made, t, 10 * update, 0, 50)->yaw_deg = t;
	}
	struct eco_track_report report = cleaned(&made.track);
	assert_true(report.kept == 71 && report.repeated == 529);
	assert_int_equal(made.track.count, 600);
	struct eco_flight flight;
	eco_flight_make(&flight, &made.track, &track_defaults);
	for (uint32_t i = 1; i < flight.count; i++) {
		double v = (flight.samples[i].eye[0] - flight.samples[i - 1].eye[0]) / flight.step_s,
			t = i * flight.step_s;
		assert_true(t > 9 || (v > 9.5 && v < 10.5));
		assert_true(near(atan2(flight.samples[i].look[0], flight.samples[i].look[1]) * DEG, t, 0.2));
	}
	eco_flight_free(&flight);
	eco_track_free(&made.track);
}

UNIT_TEST(heights_are_absolute_relative_or_interpolated)
{
	static const struct { enum eco_track_height wanted, taken; double first; } rows[] =
		{ { ECO_HEIGHTS_DEFAULT, ECO_HEIGHTS_RELATIVE, 5 },
		{ ECO_HEIGHTS_ABSOLUTE, ECO_HEIGHTS_ABSOLUTE, 305 } };
	for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
		struct made made = straight(10);
		for (uint32_t i = 0; i < 10; i++) {
			made.track.fixes[i].at[2] = i == 4 ? NAN : 305 + i;
			made.track.fixes[i].above_m = i == 4 ? NAN : 5 + i;
		}
		struct eco_track_options options = track_defaults;
		options.height = rows[k].wanted;
		made.track.notes = fmemopen(track_notes, sizeof track_notes, "w");
		assert_int_equal(eco_track_place(&made.track, &options, NULL), ECO_OK);
		fclose(made.track.notes);
		assert_true(made.track.height == rows[k].taken && strstr(track_notes, "1 fixes have no height")
			&& made.track.fixes[0].at[2] == rows[k].first);
		eco_track_free(&made.track);
	}
	struct made made = straight(10), flat = made_track(1);
	struct eco_track_options options = track_defaults;
	options.height = ECO_HEIGHTS_RELATIVE;
	assert_int_equal(eco_track_place(&made.track, &options, NULL), ECO_OK);
	assert_true(made.track.height == ECO_HEIGHTS_RELATIVE && made.track.fixes[0].at[2] == 0);
	put(&flat, 0, 0, 0, NAN);
	assert_int_equal(eco_track_place(&flat.track, &options, NULL), ECO_BAD_INPUT);
	assert_int_equal(eco_track_place(&flat.track, &track_defaults, NULL), ECO_OK);
	assert_true(!flat.track.has_height);
	eco_track_free(&made.track);
	eco_track_free(&flat.track);
}

/* ---- Places ---- */

UNIT_TEST(degrees_become_metres_of_the_scene)
{
	struct eco_track track = track_of("t,lon,lat,alt,yaw\n0,15,50,300,0\n1,15.001,50,301,0\n", "a.csv"),
		grid = track_of("t,lon,lat,yaw\n0,16.5,50,0\n", "b.csv"),
		metres = track_of("t,x,y\n0,500010,5538630\n", "c.csv");
	struct eco_track_options utm = { .crs = "EPSG:32633", .origin = { 500000, 5538630, 290 } };
	assert_good(eco_track_place(&track, &utm, &cause));
	/* zone 33 has its meridian at 15 degrees; 50 degrees north are 5538630.70 m */
	assert_true(near(track.fixes[0].at[0], 0, 1e-3) && near(track.fixes[0].at[1], 0.70, 0.01)
		&& track.fixes[0].at[2] == 10);
	assert_true(near(track.fixes[1].at[0], 71.67, 0.05) && near(track.fixes[0].yaw_deg, 0, 1e-3)
		&& near(track.still_m, 71.5, 0.3));
	/* a degree and a half east of it grid north is turned by about 1.5 sin 50 */
	assert_good(eco_track_place(&grid, &utm, &cause));
	assert_true(near(grid.fixes[0].yaw_deg, -1.149, 0.01));
	struct eco_track_options far = utm;
	far.track_crs = "EPSG:32633";
	assert_good(eco_track_place(&metres, &far, &cause));
	assert_true(near(metres.fixes[0].at[0], 10, 1e-6) && near(metres.fixes[0].at[1], 0, 1e-6));
	eco_track_free(&grid);
	grid = track_of("t,lon,lat\n0,16.5,50\n1,16.5,50.001\n", "b.csv");
	assert_code(eco_track_place(&grid, &(struct eco_track_options){ .crs = "EPSG:4326" }, &cause),
		ECO_BAD_INPUT, "not one in metres");
	assert_good(eco_track_place(&grid, &(struct eco_track_options){ .crs = NULL }, &cause));
	assert_true(near(grid.fixes[1].at[1] - grid.fixes[0].at[1], 111.23, 0.05));
	eco_track_free(&track);
	eco_track_free(&grid);
	eco_track_free(&metres);
}
