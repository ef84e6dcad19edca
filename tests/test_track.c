/* Recorded tracks: every format to the number, every slip of a recorder repaired and counted, and scripts that keep to the track.
 * Long, as each format and each slip is written out as the small recording that shows it. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <dirent.h>
#include <math.h>
#include <proj.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/track.h"
#include "ecofiles/view.h"
#include "tests/input_files.h"

#define DEG 57.29577951308232
#define METRES_PER_DEGREE 111195.0

static struct eco_track track_of(const char *text, const char *path, const struct eco_track_options *options)
{
	struct eco_track track;
	struct eco_error error = { 0 };
	if (eco_track_parse(&track, (const uint8_t *)text, strlen(text), path, options, &error))
		fail_msg("%s: %s", path, error.text);
	return track;
}

static void fails(const char *text, const char *path, const struct eco_track_options *options, const char *says)
{
	struct eco_track track;
	struct eco_error error = { 0 };
	assert_int_not_equal(eco_track_parse(&track, (const uint8_t *)text, strlen(text), path, options, &error), ECO_OK);
	assert_null(track.fixes);
	if (!strstr(error.text, says))
		fail_msg("%s\n  wanted ... %s", error.text, says);
}

static bool near(double a, double b, double most) { return (isnan(a) && isnan(b)) || fabs(a - b) <= most; }

static void assert_fix(const struct eco_fix *fix, const struct eco_fix *wanted, const char *name)
{
	if (!near(fix->time_s, wanted->time_s, 1e-6) || !near(fix->at[0], wanted->at[0], 1e-9) || !near(fix->at[1], wanted->at[1], 1e-9) ||
		!near(fix->at[2], wanted->at[2], 1e-9) || !near(fix->above_m, wanted->above_m, 1e-9) || !near(fix->yaw_deg, wanted->yaw_deg, 1e-9) ||
		!near(fix->pitch_deg, wanted->pitch_deg, 1e-9))
		fail_msg("%s: t %.9g at %.9g %.9g %.9g above %.9g yaw %.9g pitch %.9g", name, fix->time_s, fix->at[0], fix->at[1], fix->at[2], fix->above_m,
			fix->yaw_deg, fix->pitch_deg);
}

static bool says(const struct eco_track *track, const char *text)
{
	for (uint32_t i = 0; i < track->note_count; i++)
		if (strstr(track->notes[i], text))
			return true;
	return false;
}

/* ---- Subtitles ---- */

#define FIX(t, x, y, z, above, yaw, pitch) { .time_s = t, .at = { x, y, z }, .above_m = above, .yaw_deg = yaw, .pitch_deg = pitch }

static void subtitles_of_every_drone_are_read(void **state)
{
	static const struct { const char *name, *text; uint32_t count; struct eco_fix last; } rows[] = {
		{ "brackets, misspelt", "1\n00:00:00,000 --> 00:00:00,016\n<font size=\"36\">FrameCnt : 1, DiffTime : 16ms\n2020-04-02 15:19:58,720,764\n"
			"[iso : 120] [shutter : 1/2500.0] [latitude : 31.452012] [longtitude : 74.398751] [altitude: 213.983002] </font>\n", 1,
			FIX(0, 74.398751, 31.452012, 213.983002, NAN, NAN, NAN) },
		{ "rel_alt, abs_alt, gimbal", "1\r\n00:00:00,000 --> 00:00:00,033\r\n[latitude: 31.2] [longitude: 121.6] [rel_alt: 79.969 abs_alt: 96.474]\r\n"
			"\r\n2\r\n00:00:00,033 --> 00:00:00,066\r\n[latitude: 31.3] [longitude: 121.7] [rel_alt: 80 abs_alt: 97] "
			"[gb_yaw: -67.6 gb_pitch: -30.0 gb_roll: 0.0]\r\n", 2, FIX(0.033, 121.7, 31.3, 97, 80, -67.6, -30) },
		{ "gimbal in brackets of its own", "1\n00:00:01,500 --> 00:00:02,000\n[latitude : 40.7] [longitude : -74.0] [altitude: 150.0]\n"
			"[gb_yaw : 45.2] [gb_pitch : -15.3] [gb_roll : 0.1]</font>\n", 1, FIX(1.5, -74, 40.7, 150, NAN, 45.2, -15.3) },
		{ "HOME and BAROMETER", "1\n00:00:01,000 --> 00:00:02,000\nHOME(149.0251,-20.2532) 2017.08.05 14:11:51\nGPS(149.0251,-20.2533,16) "
			"BAROMETER:1.9\nISO:100 Shutter:60 EV: Fnum:2.2\n", 1, FIX(1, 149.0251, -20.2533, NAN, 1.9, NAN, NAN) },
		{ "Hb, Hs", "1\n00:00:01,000 --> 00:00:02,000\nHOME(149.0251,-20.2532) 2017.8.5 14:11:51\nGPS(149.0251,-20.2533,16) Hb:1.9 Hs:2.5\n", 1,
			FIX(1, 149.0251, -20.2533, NAN, 1.9, NAN, NAN) },
		{ "F.PRY and G.PRY, height of home", "1\n00:00:00,000 --> 00:00:01,000\nF/5.6, SS 400, GPS (-58.85, -34.23, 15), HOME (-58.84, -34.24, "
			"-57.98m), D 698.70m, H 85.80m, H.S 0.00m/s, V.S 0.00m/s, F.PRY (2.7\xc2\xb0, -7.0\xc2\xb0, 110.1\xc2\xb0), G.PRY (-24.4\xc2\xb0, 0.0\xc2\xb0, "
			"110.4\xc2\xb0)\n", 1, FIX(0, -58.85, -34.23, -57.98 + 85.80, 85.80, 110.4, -24.4) },
		{ "RTK in place of GPS", "1\n00:00:35,000 --> 00:00:36,000\nF/6.3, RTK (120.08, 30.21, 28), H 76.19m, H.S n/a, V.S n/a\n", 1,
			FIX(35, 120.08, 30.21, NAN, 76.19, NAN, NAN) },
		{ "latitude first with a capital M", "1\n00:00:00,000 --> 00:00:01,000\n2022.06.21 16:06:17\nGPS(36.6146,-6.1120,0.0M) BAROMETER:0.3M\n", 1,
			FIX(0, -6.1120, 36.6146, NAN, 0.3, NAN, NAN) },
		{ "sides of the world", "1\n00:00:00,000 --> 00:00:01,000\nGPS(W: 121.1, N: 38.2, 100.5m)\n", 1, FIX(0, -121.1, 38.2, 100.5, NAN, NAN, NAN) },
		{ "no time lines", "1\n2017.08.05 14:11:51,393,525\n[latitude : -20.2] [longtitude : 149.0]\n\n2\n2017.08.05 14:11:52,393,525\n"
			"[latitude : -20.3] [longtitude : 149.1]\n", 2, FIX(1501942312.393525, 149.1, -20.3, NAN, NAN, NAN, NAN) },
		{ "no GPS at first, cut off at the end", "1\n00:00:00,000 --> 00:00:01,000\nF/2.8, GPS (n/a, n/a, n/a), H 1.0m\n\n2\n"
			"00:00:01,000 --> 00:00:02,000\n[latitude: 0.000000] [longitude: 0.000000]\n\n3\n00:00:02,000 --> 00:00:03,000\nGPS (8.2, 47.4, 18), H 45.60m"
			"\n\n4\n00:00:03,000 --> 00:0", 1, FIX(2, 8.2, 47.4, NAN, 45.6, NAN, NAN) },
	};
	(void)state;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct eco_track track = track_of(rows[i].text, "film.SRT", NULL);
		assert_int_equal(track.format, ECO_TRACK_SRT);
		assert_true(track.degrees && track.timed);
		assert_int_equal(track.count, rows[i].count);
		assert_fix(&track.fixes[track.count - 1], &rows[i].last, rows[i].name);
		eco_track_free(&track);
	}
}

static void focal_lengths_are_fields_of_view(void **state)
{
	static const struct { const char *text; double mm; } rows[] = { { "[focal_len : 240]", 24 }, { "[focal_len: 24.00]", 24 },
		{ "[focal_len: 40.00] [dzoom_ratio: 2.00]", 80 }, { "[focal_len : 240] [dzoom_ratio: 10000, delta:0]", 24 }, { "[iso: 100]", NAN } };
	(void)state;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		char text[300];
		snprintf(text, sizeof text, "1\n00:00:00,000 --> 00:00:00,033\n%s [latitude: 1] [longitude: 2]\n", rows[i].text);
		struct eco_track track = track_of(text, "film.srt", NULL);
		assert_true(near(track.fixes[0].fov_y_deg, 2 * atan(10.125 / rows[i].mm) * DEG, 1e-9));
		eco_track_free(&track);
	}
}

/* ---- Logs ---- */

static void igc_passes_midnight_and_takes_heights_by_satellite(void **state)
{
	static const char log[] = "AXGD000\nHFDTEDATE:270418,01\nI023636LAD3737LOD\nB2359554557816N01343411EA0059600583\nB2359584557815S01343412WV0059400000\n"
		"B0000014557815N01343411EA0059400584123\nB000002XX57815N01343411EA0059400584\nE\n";
	struct eco_track track = track_of(log, "a.txt", NULL);
	(void)state;
	assert_int_equal(track.format, ECO_TRACK_IGC);
	assert_int_equal(track.count, 3);
	assert_true(near(track.fixes[0].at[1], 45 + 57.816 / 60, 1e-9) && near(track.fixes[0].at[0], 13 + 43.411 / 60, 1e-9));
	assert_true(track.fixes[0].time_s == 17648 * 86400.0 + 86395 && track.fixes[2].time_s - track.fixes[0].time_s == 6);
	assert_true(track.fixes[0].at[2] == 583 && track.fixes[1].at[2] == 594 && track.fixes[1].at[0] < 0 && track.fixes[1].at[1] < 0);
	assert_true(near(track.fixes[2].at[1], 45 + 57.8151 / 60, 1e-9) && near(track.fixes[2].at[0], 13 + 43.4112 / 60, 1e-9));
	assert_int_equal(track.skipped[ECO_TRACK_BAD_NUMBER], 1);
	eco_track_free(&track);
	track = track_of(log, "a.igc", &(struct eco_track_options){ .pressure = true });
	assert_true(track.fixes[0].at[2] == 596);
	eco_track_free(&track);
}

static void nmea_checks_sums_and_dates(void **state)
{
	static const char log[] = "$GPRMC,235959.00,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W\n"
		"$GPGGA,235959.00,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,\n$GPGGA,000000.50,4807.040,N,01131.000,W,1,08,0.9,546,M,46.9,M,,\n"
		"$GPGGA,000001.00,4807.040,N,01131.000,W,1,08,0.9,546,M,46.9,M,,*00\n$GPGGA,000002.00,,,,,0,00,,,M,,M,,\n";
	struct eco_track track = track_of(log, "a.log", NULL);
	(void)state;
	assert_int_equal(track.format, ECO_TRACK_NMEA);
	assert_int_equal(track.count, 2);
	assert_true(near(track.fixes[0].at[1], 48 + 7.038 / 60, 1e-9) && near(track.fixes[1].at[0], -(11 + 31.0 / 60), 1e-9));
	assert_true(track.fixes[0].at[2] == 545.4 && track.fixes[0].time_s == 8847 * 86400.0 + 86399);
	assert_true(near(track.fixes[1].time_s - track.fixes[0].time_s, 1.5, 1e-6));
	assert_true(track.skipped[ECO_TRACK_BAD_CHECKSUM] == 1 && track.skipped[ECO_TRACK_NO_POSITION] == 1);
	eco_track_free(&track);
}

/* ---- XML ---- */

static void gpx_tracks_win_over_way_points(void **state)
{
	struct eco_track track = track_of("<?xml version=\"1.0\"?><gpx><wpt lat=\"1\" lon=\"2\"><name>x</name></wpt><rte><rtept lat=\"3\" lon=\"4\"/></rte>"
		"<trk><trkseg></trkseg><trkseg><trkpt lat=\"45.5\" lon=\"14.25\"><ele> 733.6 </ele></trkpt><trkpt lon=\"14.5\" lat=\"45.75\">"
		"<time>2010-10-03T09:36:30Z</time></trkpt></trkseg><trkseg><trkpt lat='46' lon='15'><time>2010-10-03T11:36:31+02:00</time></trkpt></trkseg>"
		"</trk></gpx>", "a.gpx", NULL);
	(void)state;
	assert_int_equal(track.count, 3);
	assert_true(track.fixes[0].at[1] == 45.5 && track.fixes[0].at[0] == 14.25 && track.fixes[0].at[2] == 733.6 && isnan(track.fixes[0].time_s));
	assert_true(track.fixes[1].time_s == 1286098590 && isnan(track.fixes[1].at[2]) && track.fixes[2].time_s == 1286098591);
	assert_true(track.fixes[0].segment == track.fixes[1].segment && track.fixes[1].segment != track.fixes[2].segment);
	assert_true(says(&track, "other points"));
	eco_track_free(&track);
	track = track_of("<gpx><trk><trkseg><trkpt lat='1' lon='2'></trkpt><trkpt lat='1' lon='3'><ele>5", "cut.gpx", NULL);
	assert_true(track.count == 1 && says(&track, "ends before its end"));
	eco_track_free(&track);
	fails("<gpx><trk><trkseg><trkpt lat='1' lon='2'></trk>", "bad.gpx", NULL, "bad.gpx:1:4");
}

static void kml_tracks_lines_and_tours(void **state)
{
	struct eco_track track = track_of("<kml xmlns:gx='x'><Placemark><gx:Track><when>2010-05-28T02:02:09Z</when><when>2010-05-28T02:02:35Z</when>"
		"<gx:coord>-122.2 37.3 156</gx:coord><gx:coord>-122.1 37.4 157</gx:coord><gx:angles>45 0 0</gx:angles><gx:angles>50 0 0</gx:angles>"
		"</gx:Track></Placemark></kml>", "a.kml", NULL);
	(void)state;
	assert_int_equal(track.format, ECO_TRACK_KML);
	assert_true(track.count == 2 && track.fixes[1].at[0] == -122.1 && track.fixes[1].at[2] == 157 && track.fixes[1].yaw_deg == 50);
	assert_true(track.fixes[1].time_s - track.fixes[0].time_s == 26);
	eco_track_free(&track);
	track = track_of("<kml><Placemark><Point><coordinates>9,9,9</coordinates></Point></Placemark><LineString><altitudeMode>relativeToGround"
		"</altitudeMode><coordinates>\n 1,2,3\n 1.5,2.5,4 </coordinates></LineString></kml>", "b.kml", NULL);
	assert_true(track.count == 2 && track.fixes[1].at[0] == 1.5 && track.fixes[1].above_m == 4 && isnan(track.fixes[1].at[2]) && !track.timed);
	eco_track_free(&track);
	track = track_of("<kml><gx:Tour><gx:Playlist><gx:FlyTo><gx:duration>2</gx:duration><Camera><longitude>10</longitude><latitude>50</latitude>"
		"<altitude>100</altitude><heading>90</heading><tilt>80</tilt></Camera></gx:FlyTo><gx:FlyTo><gx:duration>3</gx:duration><LookAt>"
		"<longitude>10</longitude><latitude>50</latitude><altitude>0</altitude><heading>0</heading><tilt>60</tilt><range>1000</range>"
		"<altitudeMode>absolute</altitudeMode></LookAt></gx:FlyTo></gx:Playlist></gx:Tour></kml>", "c.kml", NULL);
	assert_int_equal(track.count, 2);
	assert_true(track.fixes[0].time_s == 2 && track.fixes[0].pitch_deg == -10 && track.fixes[0].yaw_deg == 90);
	assert_true(track.fixes[1].time_s == 5 && near(track.fixes[1].at[2], 500, 1e-9) && near(track.fixes[1].pitch_deg, -30, 1e-9));
	assert_true(near((50 - track.fixes[1].at[1]) * METRES_PER_DEGREE, 866.03, 0.1));
	eco_track_free(&track);
	track = track_of("<TrainingCenterDatabase><Track><Trackpoint><Time>2010-05-28T02:02:09Z</Time><Position><LatitudeDegrees>37</LatitudeDegrees>"
		"<LongitudeDegrees>-122</LongitudeDegrees></Position><AltitudeMeters>12</AltitudeMeters></Trackpoint></Track></TrainingCenterDatabase>",
		"d.tcx", NULL);
	assert_true(track.format == ECO_TRACK_TCX && track.count == 1 && track.fixes[0].at[2] == 12 && track.fixes[0].at[0] == -122);
	eco_track_free(&track);
}

/* ---- JSON ---- */

static void geojson_lines_with_and_without_times(void **state)
{
	struct eco_track track = track_of("{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\",\"properties\":{\"coordTimes\":"
		"[\"2020-01-01T00:00:00Z\",\"2020-01-01T00:00:02Z\"]},\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[10,50,3],[10.1,50]]}}]}",
		"a.json", NULL);
	(void)state;
	assert_int_equal(track.format, ECO_TRACK_GEOJSON);
	assert_true(track.count == 2 && track.fixes[1].time_s - track.fixes[0].time_s == 2 && track.fixes[0].at[2] == 3 && isnan(track.fixes[1].at[2]));
	eco_track_free(&track);
	track = track_of("{\"type\":\"FeatureCollection\",\"features\":[{\"type\":\"Feature\",\"properties\":{\"timestamp\":1577836800000,\"heading\":270,"
		"\"altitude\":7},\"geometry\":{\"type\":\"Point\",\"coordinates\":[10,50]}}]}", "b.geojson", NULL);
	assert_true(track.count == 1 && track.fixes[0].time_s == 1577836800 && track.fixes[0].yaw_deg == 270 && track.fixes[0].at[2] == 7);
	eco_track_free(&track);
	track = track_of("{\"type\":\"LineString\",\"coordinates\":[[500000,5500000],[500001,5500000]]}", "c.json", NULL);
	assert_true(!track.degrees && track.count == 2 && says(&track, "--track-crs"));
	eco_track_free(&track);
	fails("{\"a\": 1}", "d.json", NULL, "no track that is known");
	fails("{\"type\": \"LineString\", \"coordinates\": [[1, 2],]}", "e.json", NULL, "e.json:1:");
	fails("{\"type\": \"Polygon\", \"coordinates\": []}", "f.json", NULL, "no fix found");
}

static void transforms_are_opengl_and_in_the_order_of_their_names(void **state)
{
	/* looks along -z of the camera: the identity looks down, a quarter turn about x looks north */
	struct eco_track track = track_of("{\"fl_y\": 500, \"h\": 1000, \"frames\": ["
		"{\"file_path\": \"images/frame_10.png\", \"transform_matrix\": [[1,0,0,5],[0,1,0,6],[0,0,1,7],[0,0,0,1]]},"
		"{\"file_path\": \"images/frame_9.png\", \"transform_matrix\": [[1,0,0,1],[0,0,-1,2],[0,1,0,3],[0,0,0,1]]},"
		"{\"file_path\": \"images/frame_11.png\", \"transform_matrix\": [[1,0],[0,1]]}]}", "transforms.json", NULL);
	(void)state;
	assert_int_equal(track.format, ECO_TRACK_TRANSFORMS);
	assert_true(track.count == 2 && track.posed && track.skipped[ECO_TRACK_BAD_NUMBER] == 1);
	assert_true(track.fixes[0].at[0] == 1 && track.fixes[0].at[2] == 3 && near(track.fixes[0].yaw_deg, 0, 1e-9) && near(track.fixes[0].pitch_deg, 0, 1e-9));
	assert_true(near(track.fixes[1].pitch_deg, -90, 1e-9) && near(track.fixes[1].yaw_deg, 0, 1e-9));
	assert_true(near(track.fixes[0].fov_y_deg, 90, 1e-9) && track.fixes[1].time_s == 0.5);
	assert_true(says(&track, "order of their pictures' names") && says(&track, "--rate"));
	eco_track_free(&track);
	track = track_of("{\"fps\": 24, \"camera_path\": [{\"camera_to_world\": [1,0,0,1, 0,0,-1,2, 0,1,0,3, 0,0,0,1], \"fov\": 50},"
		"{\"camera_to_world\": [1,0,0,2, 0,0,-1,2, 0,1,0,3, 0,0,0,1], \"fov\": 51}]}", "camera_path.json", NULL);
	assert_true(track.format == ECO_TRACK_CAMERA_PATH && track.count == 2 && track.fixes[1].fov_y_deg == 51 && near(track.fixes[1].time_s, 1 / 24.0, 1e-9));
	eco_track_free(&track);
}

/* ---- Poses ---- */

static void poses_have_the_axes_of_their_formats(void **state)
{
	static const struct { const char *name, *text; struct eco_track_options options; enum eco_track_format format; double at[3], yaw, pitch; } rows[] = {
		/* z ahead, y down, world Z up: a quarter turn about x brings z to the north */
		{ "tum", "# t x y z qx qy qz qw\n1305031449.5 1 2 3 -0.70710678 0 0 0.70710678\n", { 0 }, ECO_TRACK_TUM, { 1, 2, 3 }, 0, 0 },
		{ "tum, ros", "1305031449.5 1 2 3 0 0 0 1\n", { .axes = ECO_AXES_ROS }, ECO_TRACK_TUM, { 1, 2, 3 }, 90, 0 },
		{ "kitti", "1 0 0 4 0 1 0 5 0 0 1 6\n", { 0 }, ECO_TRACK_KITTI, { 4, 6, -5 }, 0, 0 },
		{ "kitti, sixteen", "1 0 0 4 0 1 0 5 0 0 1 6 0 0 0 1\n", { 0 }, ECO_TRACK_KITTI, { 4, 6, -5 }, 0, 0 },
		{ "kitti, numbered", "7 1 0 0 4 0 1 0 5 0 0 1 6\n", { 0 }, ECO_TRACK_KITTI, { 4, 6, -5 }, 0, 0 },
		{ "kitti, z up", "1 0 0 4 0 1 0 5 0 0 1 6\n", { .world = ECO_WORLD_Z }, ECO_TRACK_KITTI, { 4, 5, 6 }, 180, 90 },
		{ "colmap", "# Image list with two lines of data per image:\n#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n1 1 0 0 0 -4 -5 -6 1 a b.jpg"
			"\n\n", { 0 }, ECO_TRACK_COLMAP, { 4, 6, -5 }, 0, 0 },
		{ "euroc", "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n"
			"1403636580838555648,4,5,6,1,0,0,0\n", { .axes = ECO_AXES_ROS }, ECO_TRACK_CSV, { 4, 5, 6 }, 90, 0 },
	};
	(void)state;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct eco_track track = track_of(rows[i].text, "poses.txt", &rows[i].options);
		const struct eco_fix *f = track.fixes;
		assert_int_equal(track.format, rows[i].format);
		if (track.count != 1 || !track.posed || !near(f->at[0], rows[i].at[0], 1e-6) || !near(f->at[1], rows[i].at[1], 1e-6) ||
			!near(f->at[2], rows[i].at[2], 1e-6) || (fabs(rows[i].pitch) < 80 && !near(f->yaw_deg, rows[i].yaw, 1e-5)) ||
			!near(f->pitch_deg, rows[i].pitch, 1e-5))
			fail_msg("%s: %u at %g %g %g yaw %g pitch %g", rows[i].name, track.count, f->at[0], f->at[1], f->at[2], f->yaw_deg, f->pitch_deg);
		eco_track_free(&track);
	}
	struct eco_track track = track_of("1403636580838555648,4,5,6,1,0,0,0\n1403636581838555648 5,5,6,1,0,0,0\n", "p.txt", NULL);
	assert_true(track.format == ECO_TRACK_TUM && near(track.fixes[0].time_s, 1403636580.838555648, 1e-3));
	eco_track_free(&track);
}

static void gltf_cameras_move_with_their_parents(void **state)
{
	/* times 0, 1, 2; the parent goes along x to 10 and turns a quarter to the left; the camera stands 1 behind it */
	static const float numbers[] = { 0, 1, 2, 0, 0, 0, 5, 0, 0, 10, 0, 0, 0, 0, 0, 1, 0, 0.38268343f, 0, 0.92387953f, 0, 0.70710678f, 0, 0.70710678f };
	char json[2000], base64[200];
	static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	const uint8_t *bytes = (const uint8_t *)numbers;
	(void)state;
	for (size_t i = 0, k = 0; i < sizeof numbers; i += 3, base64[k] = 0) {
		uint32_t word = (uint32_t)bytes[i] << 16 | (uint32_t)bytes[i + 1] << 8 | bytes[i + 2];
		for (int n = 0; n < 4; n++)
			base64[k++] = digits[word >> (18 - 6 * n) & 63];
	}
	snprintf(json, sizeof json, "{\"asset\":{\"version\":\"2.0\"},\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.7853981633974483,"
		"\"znear\":0.1}}],\"nodes\":[{\"children\":[1]},{\"camera\":0,\"name\":\"eye\",\"translation\":[0,0,1]}],\"scenes\":[{\"nodes\":[0]}],"
		"\"buffers\":[{\"byteLength\":96,\"uri\":\"data:application/octet-stream;base64,%s\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":96}],"
		"\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"SCALAR\"},{\"bufferView\":0,\"byteOffset\":12,\"componentType\":5126,"
		"\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":0,\"byteOffset\":48,\"componentType\":5126,\"count\":3,\"type\":\"VEC4\"}],\"animations\":[{\"channels\":"
		"[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"translation\"}},{\"sampler\":1,\"target\":{\"node\":0,\"path\":\"rotation\"}}],\"samplers\":"
		"[{\"input\":0,\"output\":1},{\"input\":0,\"output\":2}]}]}", base64);
	struct eco_track track = track_of(json, "a.gltf", NULL);
	const struct eco_fix *last = &track.fixes[track.count - 1];
	assert_true(track.format == ECO_TRACK_GLTF && track.posed && track.count == 17);
	assert_true(near(track.fixes[0].at[0], 0, 1e-5) && near(track.fixes[0].at[1], -1, 1e-5) && near(track.fixes[0].yaw_deg, 0, 1e-4));
	assert_true(near(last->at[0], 11, 1e-5) && near(last->at[1], 0, 1e-5) && near(last->yaw_deg, -90, 1e-4) && last->time_s == 2);
	assert_true(near(last->fov_y_deg, 45, 1e-9));
	eco_track_free(&track);
	fails(json, "a.gltf", &(struct eco_track_options){ .node = "other" }, "is called other");
	fails("{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{}]}", "b.gltf", NULL, "no node of it has a camera");
}

/* ---- Tables ---- */

static void tables_are_read_by_the_names_of_their_columns(void **state)
{
	static const struct { const char *name, *text; struct eco_track_options options; bool degrees; struct eco_fix first; } rows[] = {
		{ "plain", "t,lon,lat,alt\n1,10,50,7\n", { 0 }, true, FIX(1, 10, 50, 7, NAN, NAN, NAN) },
		{ "airdata", "time(millisecond),datetime(utc),latitude,longitude,height_above_takeoff(feet),altitude_above_seaLevel(feet), "
			"compass_heading(degrees), pitch(degrees), gimbal_heading(degrees),gimbal_pitch(degrees)\n1500,2020-01-01 00:00:00,50,10,100,1000,1,2,-170.5,-30"
			"\n", { 0 }, true, FIX(1.5, 10, 50, 304.8, 30.48, -170.5, -30) },
		{ "flight log", "sep=,\nOSD.flyTime [s],OSD.latitude,OSD.longitude,OSD.height [m],GIMBAL.pitch,GIMBAL.yaw [360]\n2,50,10,30,-12,350\n", { 0 }, true,
			FIX(2, 10, 50, NAN, 30, 350, -12) },
		{ "German, semicolons", "Zeit;Laenge;Breite;Hoehe\n12:00:01,5;10,5;50,25;7\n", { 0 }, true, FIX(43201.5, 10.5, 50.25, 7, NAN, NAN, NAN) },
		{ "metres", "t_s,x_east_m,y_north_m,z_up_m,yaw_deg,pitch_deg,roll_deg\n0.5,1,2,3,110,,\n", { 0 }, false, FIX(0.5, 1, 2, 3, NAN, 110, NAN) },
		{ "yaw from x", "t,x,y,z,yaw\n0,1,2,3,30\n", { .yaw_from_x = true }, false, FIX(0, 1, 2, 3, NAN, 60, NAN) },
		{ "quoted, tabs, CRLF", "\"Latitude\"\t\"Longitude\"\t\"Time\"\r\n\"50\"\t\"10\"\t\"2020-01-01T00:00:00Z\"\r\n", { 0 }, true,
			FIX(1577836800, 10, 50, NAN, NAN, NAN, NAN) },
		{ "date and time", "Date,Time,Lat,Lon\n2020/01/01,00:00:05.5,50,10\n", { 0 }, true, FIX(1577836805.5, 10, 50, NAN, NAN, NAN, NAN) },
		{ "thousandths since 1970", "timestamp,lat,lng\n1577836800500,50,10\n", { 0 }, true, FIX(1577836800.5, 10, 50, NAN, NAN, NAN, NAN) },
		{ "whole ten-millionths", "t,lat,lon\n0,500000000,100000000\n", { 0 }, true, FIX(0, 10, 50, NAN, NAN, NAN, NAN) },
		{ "as stated", "A,B,C,D\n5,50,10,100\n", { .columns = "t=A,lat=B,lon=C,alt=D:ft" }, true, FIX(5, 10, 50, 30.48, NAN, NAN, NAN) },
		{ "by number, without a header", "5 50 10\n6 51 11\n", { .columns = "t=1,lat=2,lon=3" }, true, FIX(5, 10, 50, NAN, NAN, NAN, NAN) },
		{ "spaces, comment as header", "# t east north up\n 1.0   2.0  3.0   4.0\n", { 0 }, false, FIX(1, 2, 3, 4, NAN, NAN, NAN) },
		{ "west in 0 to 360", "t,lon,lat\n0,350,50\n", { 0 }, true, FIX(0, -10, 50, NAN, NAN, NAN, NAN) },
	};
	(void)state;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct eco_track track = track_of(rows[i].text, "log.csv", &rows[i].options);
		assert_int_equal(track.format, ECO_TRACK_CSV);
		assert_true(track.degrees == rows[i].degrees);
		assert_fix(&track.fixes[0], &rows[i].first, rows[i].name);
		eco_track_free(&track);
	}
}

static void what_is_no_track_is_said_to_be_none(void **state)
{
	static const struct { const char *text, *path, *says; struct eco_track_options options; } rows[] = {
		{ "", "a.srt", "empty", { 0 } }, { " \n\n", "a.gpx", "empty", { 0 } },
		{ "PK\3\4xxxx", "a.kmz", "unzip", { 0 } }, { "hello\nworld\n", "a.txt", "begins \"hello\"", { 0 } },
		{ "a,b,c\n1,2,3\n", "a.csv", "--columns", { 0 } }, { "a,b,c\n1,2,3\n", "a.csv", "no column \"q\"", { .columns = "lon=a,lat=q" } },
		{ "a,b,c\n1,2,3\n", "a.csv", "must be ROLE=COLUMN", { .columns = "nonsense" } },
		{ "t,lon,lat\n1,NA,\n2,500,3\n", "a.csv", "no usable fix", { 0 } }, { "t,lon,lat\n", "a.csv", "no fix found", { 0 } },
		{ "1\n", "a.srt", "no fix found", { 0 } }, { "x", "a", "no format is called fit", { .format = "fit" } },
		{ "<html></html>", "a.kml", "no fix found", { 0 } },
		{ "{\"fps\": 1, \"keyframes\": []}", "a.json", "no keyframes", { 0 } },
	};
	(void)state;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		fails(rows[i].text, rows[i].path, &rows[i].options, rows[i].says);
	struct eco_track track;
	struct eco_error error = { 0 };
	assert_int_equal(eco_track_read(&track, "tests", NULL, &error), ECO_BAD_INPUT);
	error = (struct eco_error){ 0 };
	assert_int_equal(eco_track_read(&track, "no/such/file.srt", NULL, &error), ECO_IO);
}

static void files_are_read_in_a_child_to_the_same_track(void **state)
{
	static const char text[] = "1\n00:00:00,000 --> 00:00:01,000\nHOME(8.2,47.4) GPS(8.2,47.4,12.5m) BAROMETER:3\n\n2\n00:00:01,000 --> 00:00:02,000\n"
		"GPS(n/a,n/a,n/a)\n";
	struct eco_track track, same = track_of(text, "a.srt", NULL);
	struct eco_error error = { 0 };
	(void)state;
	if (eco_track_read(&track, input_text("track", "a.srt", text), NULL, &error))
		fail_msg("%s", error.text);
	assert_true(track.count == same.count && track.records == 2 && track.skipped[ECO_TRACK_NO_POSITION] == 1 && track.has_home);
	assert_memory_equal(track.fixes, same.fixes, sizeof *same.fixes);
	assert_memory_equal(track.home, same.home, 2 * sizeof *same.home);
	eco_track_free(&track);
	eco_track_free(&same);
}

/* ---- Cleaning: tracks in metres made here ---- */

struct made { struct eco_track track; uint32_t room; };

static struct made made_track(uint32_t room)
{
	struct made m = { .track = { .timed = true }, .room = room };
	m.track.fixes = calloc(room, sizeof *m.track.fixes);
	assert_non_null(m.track.fixes);
	return m;
}

static struct eco_fix *put(struct made *m, double t, double x, double y, double z)
{
	assert_true(m->track.count < m->room);
	struct eco_fix *fix = &m->track.fixes[m->track.count++];
	*fix = (struct eco_fix){ .time_s = t, .at = { x, y, z }, .above_m = NAN, .yaw_deg = NAN, .pitch_deg = NAN, .roll_deg = NAN, .fov_y_deg = NAN,
		.line = m->track.count };
	return fix;
}

/* 10 m/s along x for `count` seconds. */
static struct made straight(uint32_t count)
{
	struct made m = made_track(count);
	for (uint32_t i = 0; i < count; i++)
		put(&m, 100 + i, 10.0 * i, 0, 50);
	return m;
}

static struct eco_track_report cleaned(struct eco_track *track, const struct eco_cleaning *cleaning)
{
	struct eco_track_report report;
	struct eco_error error = { 0 };
	if (eco_track_clean(track, cleaning, &report, &error))
		fail_msg("%s", error.text);
	assert_int_equal(report.fixes, report.kept + report.repeated + report.jumped + report.other_parts);
	assert_true(track->fixes[0].time_s == 0);
	for (uint32_t i = 1; i < track->count; i++)
		assert_true(track->fixes[i].time_s > track->fixes[i - 1].time_s);
	return report;
}

/* Each fix is where a motion of 10 m/s along x would have it. */
static void assert_even(const struct eco_track *track, double start_x)
{
	for (uint32_t i = 0; i < track->count; i++)
		if (!isnan(track->fixes[i].at[0]) && !near(track->fixes[i].at[0], start_x + 10 * track->fixes[i].time_s, 1e-3))
			fail_msg("fix %u at %g s is at %g", i, track->fixes[i].time_s, track->fixes[i].at[0]);
}

static void bogus_backward_equal_and_missing_stamps_are_repaired(void **state)
{
	static const struct { const char *name; struct { uint32_t fix; double time_s; } slips[4]; uint64_t bogus, backward, missing; } rows[] = {
		{ "1970", { { 0, -1.5e9 } }, 1, 0, 0 }, { "years later", { { 20, 9e8 } }, 1, 0, 0 }, { "missing", { { 7, NAN }, { 8, NAN }, { 49, NAN } }, 0, 0, 3 },
		{ "one runs back", { { 30, 110.5 } }, 0, 1, 0 }, { "one runs ahead", { { 30, 1000 } }, 0, 1, 0 }, { "first is missing", { { 0, NAN } }, 0, 0, 1 },
	};
	(void)state;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct made m = straight(50);
		for (int k = 0; k < 4; k++)
			if (rows[i].slips[k].time_s != 0 || k == 0)
				m.track.fixes[rows[i].slips[k].fix].time_s = rows[i].slips[k].time_s;
		struct eco_track_report report = cleaned(&m.track, &(struct eco_cleaning){ 0 });
		if (report.stamps_bogus != rows[i].bogus || report.stamps_backward != rows[i].backward || report.stamps_missing != rows[i].missing ||
			report.kept != 50)
			fail_msg("%s: %lu %lu %lu, %lu kept", rows[i].name, (unsigned long)report.stamps_bogus, (unsigned long)report.stamps_backward,
				(unsigned long)report.stamps_missing, (unsigned long)report.kept);
		assert_even(&m.track, 0);
		eco_track_free(&m.track);
	}
}

static void whole_seconds_are_spread_over_their_fixes(void **state)
{
	struct made m = made_track(100);
	(void)state;
	for (uint32_t i = 0; i < 100; i++)
		put(&m, floor(i / 10.0), i, 0, 0);
	struct eco_track_report report = cleaned(&m.track, &(struct eco_cleaning){ 0 });
	assert_int_equal(report.stamps_equal, 90);
	assert_even(&m.track, 0);
	eco_track_free(&m.track);
}

static void reversed_unsorted_and_reset_clocks_are_told_apart(void **state)
{
	struct made reversed = made_track(50), unsorted = made_track(64), reset = straight(50);
	(void)state;
	for (uint32_t i = 0; i < 50; i++)
		put(&reversed, 50 - i, 10.0 * (50 - i), 0, 0);
	struct eco_track_report report = cleaned(&reversed.track, &(struct eco_cleaning){ 0 });
	assert_true(report.reversed);
	assert_even(&reversed.track, 10);
	for (uint32_t i = 0; i < 64; i++)
		put(&unsorted, i * 37 % 64, 10.0 * (i * 37 % 64), 0, 0);
	report = cleaned(&unsorted.track, &(struct eco_cleaning){ 0 });
	assert_true(report.sorted > 0 && report.kept == 64);
	assert_even(&unsorted.track, 0);
	for (uint32_t i = 25; i < 50; i++)
		reset.track.fixes[i].time_s -= 90;
	report = cleaned(&reset.track, &(struct eco_cleaning){ 0 });
	assert_true(report.clock_resets == 1 && report.kept == 50);
	assert_even(&reset.track, 0);
	eco_track_free(&reversed.track);
	eco_track_free(&unsorted.track);
	eco_track_free(&reset.track);
}

static void repeated_fixes_become_even_motion(void **state)
{
	/* 60 records a second, 7 positions a second, in motion; a look in every record */
	struct made m = made_track(600);
	(void)state;
	for (uint32_t i = 0; i < 600; i++) {
		double t = i / 60.0, update = floor(t * 7 + 1e-9) / 7;
		put(&m, t, 10 * update, 0, 50)->yaw_deg = t;
	}
	struct eco_track_report report = cleaned(&m.track, &(struct eco_cleaning){ 0 });
	assert_true(report.kept == 71 && report.repeated == 529 && near(report.update_s, 1 / 7.0, 0.02));
	assert_int_equal(m.track.count, 600);
	struct eco_flight flight;
	struct eco_error error = { 0 };
	assert_int_equal(eco_flight_make(&flight, &m.track, &(struct eco_smoothing){ .smooth_s = NAN, .pitch_deg = NAN, .fov_y_deg = NAN }, &error), ECO_OK);
	for (uint32_t i = 1; i < flight.count; i++) {
		double v = (flight.samples[i].eye[0] - flight.samples[i - 1].eye[0]) / flight.step_s, t = i * flight.step_s;
		assert_true(t > 9 || (v > 9.5 && v < 10.5));
		assert_true(near(atan2(flight.samples[i].look[0], flight.samples[i].look[1]) * DEG, t, 0.2));
	}
	eco_flight_free(&flight);
	eco_track_free(&m.track);
}

static void isolated_jumps_are_dropped_others_split(void **state)
{
	struct made spikes = straight(100), apart = made_track(100), glide = straight(100);
	struct eco_error error = { 0 };
	struct eco_track_report report;
	(void)state;
	spikes.track.fixes[0].at[1] = 4000;
	spikes.track.fixes[40].at[0] = -5e6;
	spikes.track.fixes[60].at[1] = spikes.track.fixes[61].at[1] = 700;
	spikes.track.fixes[80].at[2] = 5000;
	report = cleaned(&spikes.track, &(struct eco_cleaning){ 0 });
	assert_true(report.jumped == 5 && report.kept == 95 && report.parts == 1);
	assert_even(&spikes.track, 10);
	for (uint32_t i = 0; i < 100; i++)
		put(&apart, i, i < 40 ? 10.0 * i : 12000 + 10 * i, 0, 0);
	assert_int_equal(eco_track_clean(&apart.track, &(struct eco_cleaning){ .part = 3 }, &report, &error), ECO_NOT_FOUND);
	eco_track_free(&apart.track);
	for (uint32_t part = 0; part <= 2; part++) {
		apart = made_track(100);
		for (uint32_t i = 0; i < 100; i++)
			put(&apart, i, i < 40 ? 10.0 * i : 12000 + 10 * i, 0, 0);
		report = cleaned(&apart.track, &(struct eco_cleaning){ .part = part });
		assert_true(report.parts == 2 && report.part == (part == 1 ? 1 : 2) && report.kept == (part == 1 ? 40 : 60));
		assert_true(says(&apart.track, "part 2 of 2: 60 positions, 590 m"));
		assert_even(&apart.track, part == 1 ? 0 : 12400);
		eco_track_free(&apart.track);
	}
	/* a receiver corrects itself by 100 m: no end, but no flash either */
	for (uint32_t i = 50; i < 100; i++)
		glide.track.fixes[i].at[0] += 100;
	report = cleaned(&glide.track, &(struct eco_cleaning){ 0 });
	assert_true(report.glides == 1 && report.parts == 1 && report.kept == 100);
	assert_even(&glide.track, 0);
	eco_track_free(&spikes.track);
	eco_track_free(&glide.track);
}

static void fast_stretches_are_no_jumps(void **state)
{
	/* a walk, a ride, a walk */
	struct made m = made_track(300);
	double x = 0;
	(void)state;
	for (uint32_t i = 0; i < 300; i++, x += i >= 140 && i < 160 ? 25 : 1.4)
		put(&m, i, x, 0, 0);
	struct eco_track_report report = cleaned(&m.track, &(struct eco_cleaning){ 0 });
	assert_true(report.kept == 300 && report.parts == 1 && report.glides == 0);
	eco_track_free(&m.track);
}

static void long_stands_are_shortened(void **state)
{
	struct made m = made_track(200);
	(void)state;
	for (uint32_t i = 0; i < 200; i++)
		put(&m, i < 100 ? i : i + 3600, 10.0 * (i < 100 ? i : i - 1), 0, 0);
	struct eco_track_report report = cleaned(&m.track, &(struct eco_cleaning){ .pause_s = 5 });
	assert_true(report.pauses == 1 && near(report.paused_s, 3596, 1) && near(m.track.fixes[m.track.count - 1].time_s, 99 + 5 + 99, 1.1));
	eco_track_free(&m.track);
}

static void without_times_a_pace_is_taken(void **state)
{
	struct made m = made_track(3);
	(void)state;
	put(&m, NAN, 0, 0, NAN);
	put(&m, NAN, 30, 40, NAN);
	put(&m, NAN, 30, 90, NAN);
	struct eco_track_report report = cleaned(&m.track, &(struct eco_cleaning){ .pace_m_s = 5 });
	assert_true(report.untimed && !report.has_height && near(m.track.fixes[1].time_s, 10, 1e-9) && near(m.track.fixes[2].time_s, 20, 1e-9));
	eco_track_free(&m.track);
}

static void heights_are_absolute_relative_or_interpolated(void **state)
{
	static const struct { enum eco_track_height wanted, taken; double first; } rows[] = { { ECO_HEIGHTS_DEFAULT, ECO_HEIGHTS_RELATIVE, 5 },
		{ ECO_HEIGHTS_ABSOLUTE, ECO_HEIGHTS_ABSOLUTE, 305 }, { ECO_HEIGHTS_GROUND, ECO_HEIGHTS_GROUND, 5 } };
	(void)state;
	for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
		struct made m = straight(10);
		for (uint32_t i = 0; i < 10; i++) {
			m.track.fixes[i].at[2] = i == 4 ? NAN : 305 + i;
			m.track.fixes[i].above_m = i == 4 ? NAN : 5 + i;
		}
		struct eco_track_report report = cleaned(&m.track, &(struct eco_cleaning){ .height = rows[k].wanted });
		assert_true(report.height == rows[k].taken && report.heights_missing == 1 && m.track.fixes[0].at[2] == rows[k].first);
		eco_track_free(&m.track);
	}
	struct made m = straight(10);
	struct eco_track_report report = cleaned(&m.track, &(struct eco_cleaning){ .height = ECO_HEIGHTS_RELATIVE });
	assert_true(report.height == ECO_HEIGHTS_RELATIVE && m.track.fixes[0].at[2] == 0);
	eco_track_free(&m.track);
}

/* ---- Flights ---- */

static struct eco_flight flight_of(const struct eco_track *track, const struct eco_smoothing *smoothing)
{
	static const struct eco_smoothing usual = { .smooth_s = NAN, .pitch_deg = NAN, .fov_y_deg = NAN };
	struct eco_flight flight;
	struct eco_error error = { 0 };
	if (eco_flight_make(&flight, track, smoothing ? smoothing : &usual, &error))
		fail_msg("%s", error.text);
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

static double yaw_of(const struct eco_sample *s) { return atan2(s->look[0], s->look[1]) * DEG; }

static void rounded_positions_do_not_jitter(void **state)
{
	/* a circle of 100 m radius at 5 m/s, once a second, in steps of 11 m east and 8 m north: 4 decimals of a degree */
	struct made m = made_track(240);
	(void)state;
	for (uint32_t i = 0; i < 240; i++) {
		double a = i * 0.05;
		put(&m, i, floor(100 * cos(a) / 11 + 0.5) * 11, floor(100 * sin(a) / 8 + 0.5) * 8, floor(30 + 10 * sin(a) + 0.5));
	}
	m.track.still_m = 8;
	m.track.still_z_m = 1;
	struct eco_track_report report = cleaned(&m.track, &(struct eco_cleaning){ 0 });
	struct eco_flight f = flight_of(&m.track, NULL);
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

static void cameras_look_where_they_go_and_wait_without_turning(void **state)
{
	struct made m = made_track(90);
	(void)state;
	for (uint32_t i = 0; i < 90; i++)
		put(&m, i, i < 30 ? 5.0 * i : 150, i < 60 ? 0 : 5.0 * (i - 60), 20);
	cleaned(&m.track, &(struct eco_cleaning){ 0 });
	struct eco_flight f = flight_of(&m.track, &(struct eco_smoothing){ .smooth_s = NAN, .pitch_deg = NAN, .fov_y_deg = NAN, .flies = true });
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

static void recorded_looks_turn_across_north(void **state)
{
	struct made m = straight(20);
	(void)state;
	for (uint32_t i = 0; i < 20; i++) {
		struct eco_fix *fix = &m.track.fixes[i];
		fix->yaw_deg = fmod(350 + i, 360);
		fix->pitch_deg = -30;
		fix->roll_deg = 5;
		fix->fov_y_deg = 40 + i;
	}
	cleaned(&m.track, &(struct eco_cleaning){ 0 });
	struct eco_flight f = flight_of(&m.track, NULL);
	for (uint32_t i = 0; i < f.count; i++) {
		double t = i * f.step_s;
		assert_true(fabs(remainder(yaw_of(&f.samples[i]) - 350 - t, 360)) < 0.3 && near(asin(f.samples[i].look[2]) * DEG, -30, 0.1));
		assert_true(near(f.samples[i].fov_y_deg, 40 + t, 1e-6));
	}
	assert_true(f.yaw_recorded && f.pitch_recorded && f.fov_recorded && f.samples[0].up[2] < cos(30 / DEG));
	eco_flight_free(&f);
	eco_track_free(&m.track);
}

static void flights_are_moved_turned_and_kept_above_ground(void **state)
{
	struct made m = straight(11);
	float heights[4] = { 0, 0, 40, 40 };
	struct eco_ground ground = { .columns = 2, .rows = 2, .x_m = -1000, .y_m = 0, .step_x_m = 2000, .step_y_m = 100, .height_m = heights };
	struct eco_flight_moved moved;
	struct eco_error error = { 0 };
	(void)state;
	cleaned(&m.track, &(struct eco_cleaning){ 0 });
	struct eco_flight f = flight_of(&m.track, NULL);
	struct eco_flight_move move = { .from_s = 2, .to_s = 8, .speed = 2, .scale = 0.5, .turn_deg = 90, .to_given = true, .to = { 7, 8, 9 },
		.ground = &ground, .has_ground = true, .clearance_m = 2 };
	double step_s = f.step_s;
	assert_int_equal(eco_flight_move(&f, &move, &moved, &error), ECO_OK);
	const struct eco_sample *last = &f.samples[f.count - 1];
	assert_true(near(f.step_s, step_s / 2, 1e-12) && near((f.count - 1) * step_s, 6, 2 * step_s));
	/* 60 m along x are 30 m along y; the ground rises by 0.4 a metre */
	assert_true(near(f.samples[0].eye[0], 7, 0.3) && near(last->eye[1], 38, 0.5) && near(last->look[1], 1, 1e-3));
	assert_true(near(last->eye[2], 0.4 * last->eye[1] + 2, 1e-4) && moved.raised > 0 && moved.off_ground == 0);
	move = (struct eco_flight_move){ .from_s = 100, .to_s = NAN };
	assert_int_equal(eco_flight_move(&f, &move, &moved, &error), ECO_BAD_INPUT);
	move = (struct eco_flight_move){ .from_s = NAN, .to_s = NAN, .look_at_given = true, .look_at = { 7, 1000, 20 } };
	assert_int_equal(eco_flight_move(&f, &move, &moved, NULL), ECO_OK);
	assert_true(f.samples[0].look[1] > 0.99);
	eco_flight_free(&f);
	eco_track_free(&m.track);
}

/* ---- Scripts ---- */

static void scripts_keep_to_the_flight_as_they_say(void **state)
{
	/* stands, starts, corners, a gimbal that swings */
	struct made m = made_track(600);
	(void)state;
	for (uint32_t i = 0; i < 600; i++) {
		double t = i * 0.2, x = t < 20 ? 0 : t < 60 ? 8 * (t - 20) : 320, y = t < 60 ? 0 : 8 * (t - 60);
		struct eco_fix *fix = put(&m, t, x, y, 50 + 20 * sin(t / 7));
		fix->yaw_deg = 180 + 170 * sin(t / 5);
		fix->pitch_deg = -45 + 45 * cos(t / 9);
	}
	cleaned(&m.track, &(struct eco_cleaning){ 0 });
	struct eco_flight f = flight_of(&m.track, NULL);
	for (uint32_t keys = 0; keys <= 40; keys += 20) {
		struct eco_script script;
		struct eco_camera *camera;
		struct eco_error error = { 0 };
		size_t size;
		assert_int_equal(eco_script_fit(&script, &f, &(struct eco_fitting){ .keys_max = keys, .fps = 1 / f.step_s }, &error), ECO_OK);
		assert_true(keys ? script.count <= keys && script.error_m > 0.05 : script.error_m <= 0.05 && script.error_deg <= 0.5 && script.count < f.count / 2);
		char *text = eco_script_text(&script, &size);
		if (eco_camera_parse(&camera, text, size, "made", &error))
			fail_msg("%s", error.text);
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
		eco_script_free(&script);
		free(text);
	}
	eco_flight_free(&f);
	eco_track_free(&m.track);
}

static void still_cameras_are_one_keyframe(void **state)
{
	struct eco_track track = track_of("{\"camera_angle_x\": 0.8, \"frames\": [{\"transform_matrix\": [[1,0,0,5],[0,0,-1,6],[0,1,0,7],[0,0,0,1]]}]}", "t.json",
		NULL);
	struct eco_script script;
	size_t size;
	(void)state;
	cleaned(&track, &(struct eco_cleaning){ 0 });
	struct eco_flight f = flight_of(&track, NULL);
	assert_int_equal(eco_script_fit(&script, &f, &(struct eco_fitting){ 0 }, NULL), ECO_OK);
	char *text = eco_script_text(&script, &size);
	assert_string_equal(text, "{\"fps\": 30, \"keyframes\": [\n  {\"time_s\": 0, \"eye\": [5, 6, 7], \"target\": [5, 16, 7], \"fov_y_deg\": 45.837}\n]}\n");
	free(text);
	eco_script_free(&script);
	eco_flight_free(&f);
	eco_track_free(&track);
}

/* ---- Places ---- */

static void degrees_become_metres_of_the_scene(void **state)
{
	struct eco_track track = track_of("t,lon,lat,alt,yaw\n0,15,50,300,0\n1,15.001,50,301,0\n", "a.csv", NULL), grid = track_of("t,lon,lat,yaw\n0,16.5,50,0\n",
		"b.csv", NULL), metres = track_of("t,x,y\n0,500010,5538630\n", "c.csv", NULL);
	struct eco_track_frame utm = { .crs = "EPSG:32633", .origin = { 500000, 5538630, 290 } };
	struct eco_error error = { 0 };
	(void)state;
	if (eco_track_place(&track, &utm, &error))
		fail_msg("%s", error.text);
	/* zone 33 has its meridian at 15 degrees; 50 degrees north are 5538630.70 m */
	assert_true(near(track.fixes[0].at[0], 0, 1e-3) && near(track.fixes[0].at[1], 0.70, 0.01) && track.fixes[0].at[2] == 10);
	assert_true(near(track.fixes[1].at[0], 71.67, 0.05) && near(track.fixes[0].yaw_deg, 0, 1e-3) && near(track.still_m, 71.5, 0.3));
	/* a degree and a half east of it grid north is turned by about 1.5 sin 50 */
	assert_int_equal(eco_track_place(&grid, &utm, &error), ECO_OK);
	assert_true(near(grid.fixes[0].yaw_deg, -1.149, 0.01));
	struct eco_track_frame far = utm;
	far.track_crs = "EPSG:32633";
	assert_int_equal(eco_track_place(&metres, &far, &error), ECO_OK);
	assert_true(near(metres.fixes[0].at[0], 10, 1e-6) && near(metres.fixes[0].at[1], 0, 1e-6));
	eco_track_free(&grid);
	grid = track_of("t,lon,lat\n0,16.5,50\n1,16.5,50.001\n", "b.csv", NULL);
	assert_int_equal(eco_track_place(&grid, &(struct eco_track_frame){ .crs = "EPSG:4326" }, &error), ECO_BAD_INPUT);
	assert_non_null(strstr(error.text, "not one in metres"));
	error = (struct eco_error){ 0 };
	assert_int_equal(eco_track_place(&grid, &(struct eco_track_frame){ .crs = NULL }, &error), ECO_OK);
	assert_true(near(grid.fixes[1].at[1] - grid.fixes[0].at[1], 111.23, 0.05));
	eco_track_free(&track);
	eco_track_free(&grid);
	eco_track_free(&metres);
}

/* ---- Recordings, where they are at hand: each beside a table of its positions ---- */

static double nearest(const struct eco_flight *f, double x, double y)
{
	double least = INFINITY;
	for (uint32_t i = 0; i < f->count; i++)
		least = fmin(least, hypot(f->samples[i].eye[0] - x, f->samples[i].eye[1] - y));
	return least;
}

static void compare_with_table(const char *folder, const char *name)
{
	char path[1000], table[1000];
	struct eco_track track, wanted;
	struct eco_track_report report;
	struct eco_error error = { 0 };
	uint32_t within = 0, seen = 0;
	snprintf(path, sizeof path, "%s/%s", folder, name);
	snprintf(table, sizeof table, "%s/%s.csv", folder, name);
	if (eco_track_read(&track, path, NULL, &error) || eco_track_read(&wanted, table, NULL, &error) ||
		eco_track_place(&track, &(struct eco_track_frame){ .crs = NULL }, &error) || eco_track_clean(&track, &(struct eco_cleaning){ 0 }, &report, &error))
		fail_msg("%s", error.text);
	struct eco_flight f = flight_of(&track, NULL);
	/* the table's zero is the file's first fix, which may lie in another part */
	double zero[2] = { 0 };
	if (report.part == 1)
		memcpy(zero, f.samples[0].eye, sizeof zero);
	for (uint32_t i = 0; report.part == 1 && i < wanted.count && i < report.kept; i++, seen++)
		within += nearest(&f, zero[0] + wanted.fixes[i].at[0], zero[1] + wanted.fixes[i].at[1]) <= fmax(3, 0.8 * track.still_m) +
			0.002 * hypot(wanted.fixes[i].at[0], wanted.fixes[i].at[1]);     /* tables count on a sphere */
	if (within < 0.9 * seen)
		fail_msg("%s: %u of %u positions are near the path", name, within, seen);
	eco_flight_free(&f);
	eco_track_free(&track);
	eco_track_free(&wanted);
}

static void recordings_keep_near_their_positions(void **state)
{
	const char *data = getenv("ECO_DATA");
	char folder[900];
	(void)state;
	if (!data)
		skip();
	snprintf(folder, sizeof folder, "%s/cameras", data);
	DIR *files = opendir(folder);
	if (!files)
		skip();
	for (const struct dirent *file; (file = readdir(files)) != NULL; ) {
		char recording[300];
		size_t length = strlen(file->d_name);
		if (length < 8 || strcmp(file->d_name + length - 4, ".csv") != 0)
			continue;
		snprintf(recording, sizeof recording, "%.*s", (int)length - 4, file->d_name);
		compare_with_table(folder, recording);
	}
	closedir(files);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(subtitles_of_every_drone_are_read), cmocka_unit_test(focal_lengths_are_fields_of_view),
		cmocka_unit_test(igc_passes_midnight_and_takes_heights_by_satellite), cmocka_unit_test(nmea_checks_sums_and_dates),
		cmocka_unit_test(gpx_tracks_win_over_way_points), cmocka_unit_test(kml_tracks_lines_and_tours),
		cmocka_unit_test(geojson_lines_with_and_without_times), cmocka_unit_test(transforms_are_opengl_and_in_the_order_of_their_names),
		cmocka_unit_test(poses_have_the_axes_of_their_formats), cmocka_unit_test(gltf_cameras_move_with_their_parents),
		cmocka_unit_test(tables_are_read_by_the_names_of_their_columns), cmocka_unit_test(what_is_no_track_is_said_to_be_none),
		cmocka_unit_test(files_are_read_in_a_child_to_the_same_track),
		cmocka_unit_test(bogus_backward_equal_and_missing_stamps_are_repaired), cmocka_unit_test(whole_seconds_are_spread_over_their_fixes),
		cmocka_unit_test(reversed_unsorted_and_reset_clocks_are_told_apart), cmocka_unit_test(repeated_fixes_become_even_motion),
		cmocka_unit_test(isolated_jumps_are_dropped_others_split), cmocka_unit_test(fast_stretches_are_no_jumps),
		cmocka_unit_test(long_stands_are_shortened), cmocka_unit_test(without_times_a_pace_is_taken),
		cmocka_unit_test(heights_are_absolute_relative_or_interpolated), cmocka_unit_test(rounded_positions_do_not_jitter),
		cmocka_unit_test(cameras_look_where_they_go_and_wait_without_turning), cmocka_unit_test(recorded_looks_turn_across_north),
		cmocka_unit_test(flights_are_moved_turned_and_kept_above_ground), cmocka_unit_test(scripts_keep_to_the_flight_as_they_say),
		cmocka_unit_test(still_cameras_are_one_keyframe), cmocka_unit_test(degrees_become_metres_of_the_scene),
		cmocka_unit_test(recordings_keep_near_their_positions),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
