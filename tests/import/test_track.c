/* Recorded tracks: every format to the number, and what is no track is said to be none. Each format is
 * written out as the small recording that shows it. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/track/track.h"
#include "tests/support/input_files.h"
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

static void assert_fix(const struct eco_fix *fix, const struct eco_fix *wanted, const char *name)
{
	if (!near(fix->time_s, wanted->time_s, 1e-6) || !near(fix->at[0], wanted->at[0], 1e-9)
			|| !near(fix->at[1], wanted->at[1], 1e-9) ||
		!near(fix->at[2], wanted->at[2], 1e-9) || !near(fix->above_m, wanted->above_m, 1e-9)
		|| !near(fix->yaw_deg, wanted->yaw_deg, 1e-9)
		|| !near(fix->pitch_deg, wanted->pitch_deg, 1e-9))
		fail_msg("%s: t %.9g at %.9g %.9g %.9g above %.9g yaw %.9g pitch %.9g", name, fix->time_s,
			fix->at[0], fix->at[1], fix->at[2], fix->above_m, fix->yaw_deg, fix->pitch_deg);
}

/* ---- Subtitles ---- */

#define FIX(t, x, y, z, above, yaw, pitch) { .time_s = t, .at = { x, y, z }, .above_m = above, \
	.yaw_deg = yaw, .pitch_deg = pitch }

static void subtitles_of_every_drone_are_read(void **state)
{
	static const struct { const char *name, *text; uint32_t count; struct eco_fix last; } rows[] = {
		{ "brackets, misspelt", "1\n00:00:00,000 --> 00:00:00,016\n<font size=\"36\">FrameCnt : 1, "
			"DiffTime : 16ms\n2020-04-02 15:19:58,720,764\n"
			"[iso : 120] [shutter : 1/2500.0] [latitude : 31.452012] [longtitude : 74.398751] "
			"[altitude: 213.983002] </font>\n", 1,
			FIX(0, 74.398751, 31.452012, 213.983002, NAN, NAN, NAN) },
		{ "rel_alt, abs_alt, gimbal", "1\r\n00:00:00,000 --> 00:00:00,033\r\n[latitude: 31.2] "
			"[longitude: 121.6] [rel_alt: 79.969 abs_alt: "
			"96.474]\r\n\r\n2\r\n00:00:00,033 --> 00:00:00,066\r\n[latitude: 31.3] [longitude: "
			"121.7] [rel_alt: 80 abs_alt: 97] "
			"[gb_yaw: -67.6 gb_pitch: -30.0 gb_roll: 0.0]\r\n", 2,
			FIX(0.033, 121.7, 31.3, 97, 80, -67.6, -30) },
		{ "gimbal in brackets of its own", "1\n00:00:01,500 --> 00:00:02,000\n[latitude : 40.7] "
			"[longitude : -74.0] [altitude: 150.0]\n"
			"[gb_yaw : 45.2] [gb_pitch : -15.3] [gb_roll : 0.1]</font>\n", 1,
			FIX(1.5, -74, 40.7, 150, NAN, 45.2, -15.3) },
		{ "HOME and BAROMETER", "1\n00:00:01,000 --> 00:00:02,000\nHOME(149.0251,-20.2532) "
			"2017.08.05 14:11:51\nGPS(149.0251,-20.2533,16) "
			"BAROMETER:1.9\nISO:100 Shutter:60 EV: Fnum:2.2\n", 1,
			FIX(1, 149.0251, -20.2533, NAN, 1.9, NAN, NAN) },
		{ "Hb, Hs", "1\n00:00:01,000 --> 00:00:02,000\nHOME(149.0251,-20.2532) 2017.8.5 "
			"14:11:51\nGPS(149.0251,-20.2533,16) Hb:1.9 Hs:2.5\n", 1,
			FIX(1, 149.0251, -20.2533, NAN, 1.9, NAN, NAN) },
		{ "F.PRY and G.PRY", "1\n00:00:00,000 --> 00:00:01,000\nF/5.6, SS 400, GPS "
			"(-58.85, -34.23, 15), HOME (-58.84, -34.24, "
			"-57.98m), D 698.70m, H 85.80m, H.S 0.00m/s, V.S 0.00m/s, F.PRY (2.7\xc2\xb0, "
			"-7.0\xc2\xb0, 110.1\xc2\xb0), G.PRY (-24.4\xc2\xb0, "
			"0.0\xc2\xb0, 110.4\xc2\xb0)\n", 1,
			FIX(0, -58.85, -34.23, NAN, 85.80, 110.4, -24.4) },
		{ "RTK in place of GPS", "1\n00:00:35,000 --> 00:00:36,000\nF/6.3, RTK (120.08, 30.21, 28), "
			"H 76.19m, H.S n/a, V.S n/a\n", 1,
			FIX(35, 120.08, 30.21, NAN, 76.19, NAN, NAN) },
		{ "latitude first with a capital M", "1\n00:00:00,000 --> 00:00:01,000\n2022.06.21 "
			"16:06:17\nGPS(36.6146,-6.1120,0.0M) BAROMETER:0.3M\n", 1,
			FIX(0, -6.1120, 36.6146, NAN, 0.3, NAN, NAN) },
		{ "no GPS at first, cut off at the end", "1\n00:00:00,000 --> 00:00:01,000\nF/2.8, GPS "
			"(n/a, n/a, n/a), H 1.0m\n\n2\n"
			"00:00:01,000 --> 00:00:02,000\n[latitude: 0.000000] [longitude: "
			"0.000000]\n\n3\n00:00:02,000 --> 00:00:03,000\nGPS (8.2, 47.4, 18), "
			"H 45.60m\n\n4\n00:00:03,000 --> 00:0", 1, FIX(2, 8.2, 47.4, NAN, 45.6, NAN, NAN) },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct eco_track track = track_of(rows[i].text, "film.SRT");
		assert_int_equal(track.format, ECO_TRACK_SRT);
		assert_true(track.degrees && track.timed);
		assert_int_equal(track.count, rows[i].count);
		assert_fix(&track.fixes[track.count - 1], &rows[i].last, rows[i].name);
		eco_track_free(&track);
	}
}

static void focal_lengths_are_fields_of_view(void **state)
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

static void gpx_tracks_win_over_way_points(void **state)
{
	struct eco_track track = track_of("<?xml version=\"1.0\"?><gpx><wpt lat=\"1\" "
		"lon=\"2\"><name>x</name></wpt><rte><rtept lat=\"3\" "
		"lon=\"4\"/></rte>"
		"<trk><trkseg></trkseg><trkseg><trkpt lat=\"45.5\" lon=\"14.25\"><ele> 733.6 "
		"</ele></trkpt><trkpt lon=\"14.5\" lat=\"45.75\">"
		"<time>2010-10-03T09:36:30.25Z</time><extensions><heading>12.5</heading></extensions>"
		"</trkpt></trkseg><trkseg>"
		"<trkpt lat='46' "
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
static void gpx_that_breaks_off_is_read_until_there(void **state)
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

static void kml_points_have_times_and_lines_win_over_points_without(void **state)
{
	struct eco_track track = track_of("<kml "
		"xmlns=\"http://www.opengis.net/kml/2.2\"><Document><Folder><name>way</name><Placemark>"
		"<TimeStamp>"
		"<when>2010-05-28T02:02:09.5Z</when></TimeStamp><Point><altitudeMode>absolute</altitudeMode>"
		"<coordinates>-122.2,37.3,156</coordinates></Point>"
		"</Placemark><Placemark><TimeStamp><when>2010-05-28T04:02:35+02:00</when></TimeStamp><Point>"
		"<coordinates>-122.1,37.4,157</coordinates></Point>"
		"</Placemark></Folder></Document></kml>", "a.kml");
	assert_int_equal(track.format, ECO_TRACK_KML);
	assert_true(track.count == 2 && track.fixes[1].at[0] == -122.1 && track.fixes[1].at[2] == 157);
	assert_true(track.fixes[0].time_s == 1275012129.5 && track.fixes[1].time_s - track.fixes[0].time_s
		== 25.5);
	eco_track_free(&track);
	track = track_of("<kml><Document><Placemark><Point><coordinates>9,9,9</coordinates></Point>"
		"</Placemark><Placemark><LineString><altitudeMode>"
		"relativeToGround</altitudeMode><coordinates>\n 1,2,3\n 1.5,2.5,4 "
		"</coordinates></LineString></Placemark></Document></kml>", "b.kml");
	assert_true(track.count == 2 && track.fixes[1].at[0] == 1.5 && track.fixes[1].above_m == 4
		&& isnan(track.fixes[1].at[2]) && !track.timed);
	assert_true(strstr(track_notes, "positions beside them are left out"));
	eco_track_free(&track);
	/* their times and angles do not arrive */
	fails("<kml xmlns='http://www.opengis.net/kml/2.2' "
		"xmlns:gx='http://www.google.com/kml/ext/2.2'><Placemark><gx:Track>"
		"<when>2010-05-28T02:02:09Z</when><when>2010-05-28T02:02:35Z</when><gx:coord>-122.2 37.3 "
		"156</gx:coord><gx:coord>-122.1 37.4 157</gx:coord>"
		"</gx:Track></Placemark></kml>", "gx.kml", "(of <when>, of a gx:Track) do not arrive through "
		"GDAL; convert it to GPX or CSV");
	fails("<kml xmlns='http://www.opengis.net/kml/2.3'><Placemark><Track>"
		"<when>2010-05-28T02:02:09Z</when><coord>-122.2 37.3 156</coord></Track></Placemark></kml>",
		"track23.kml", "do not arrive");
	fails("<kml xmlns='http://www.opengis.net/kml/2.2'><Placemark><TimeStamp><when>in May</when>"
		"</TimeStamp><Point><coordinates>9,9,9</coordinates></Point></Placemark></kml>", "may.kml",
		"do not arrive");
	fails("<kml xmlns='http://www.opengis.net/kml/2.2' "
		"xmlns:gx='http://www.google.com/kml/ext/2.2'><gx:Tour><gx:Playlist><gx:FlyTo>"
		"<gx:duration>2</gx:duration><Camera><longitude>10</longitude><latitude>50</latitude>"
		"</Camera></gx:FlyTo></gx:Playlist></gx:Tour></kml>", "tour.kml", "gx:FlyTo");
}

static void geojson_lines_with_and_without_times(void **state)
{
	static const char *const lines[] = { "{\"type\":\"FeatureCollection\","
		"\"features\":[{\"type\":\"Feature\",\"properties\":{\"coordTimes\":"
		"[\"2020-01-01T00:00:00Z\",\"2020-01-01T00:00:02Z\"]},\"geometry\":{\"type\":\"LineString\","
		"\"coordinates\":[[10,50,3],[10.1,50,4]]}}]}",
		"{\"type\":\"Feature\","
		"\"properties\":{\"coordinateProperties\":{\"times\":[\"2020-01-01T00:00:00Z\","
		"\"2020-01-01T00:00:02Z\"]}},"
		"\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[10,50,3],[10.1,50,4]]}}" };
	for (size_t i = 0; i < 2; i++) {
		struct eco_track track = track_of(lines[i], "a.json");
		assert_int_equal(track.format, ECO_TRACK_GEOJSON);
		assert_true(track.count == 2 && track.fixes[0].time_s == 1577836800 && track.fixes[1].time_s
			== 1577836802);
		assert_true(track.fixes[0].at[2] == 3 && track.fixes[1].at[2] == 4 && track.fixes[1].at[0]
			== 10.1 && track.degrees);
		eco_track_free(&track);
	}
	struct eco_track track = track_of("{\"type\":\"FeatureCollection\","
		"\"features\":[{\"type\":\"Feature\",\"properties\":{\"timestamp\":"
		"1577836800000,\"heading\":270,\"altitude\":7},\"geometry\":{\"type\":\"Point\","
		"\"coordinates\":[10,50]}},{\"type\":\"Feature\",\"properties\":"
		"{\"timestamp\":1577836801500,\"heading\":271,\"altitude\":8},"
		"\"geometry\":{\"type\":\"Point\",\"coordinates\":[10,51]}}]}", "b.geojson");
	assert_true(track.count == 2 && track.fixes[0].time_s == 1577836800 && track.fixes[1].time_s
		== 1577836801.5);
	assert_true(track.fixes[0].yaw_deg == 270 && track.fixes[0].at[2] == 7);
	eco_track_free(&track);
	track = track_of("{\"type\":\"Feature\","
		"\"properties\":{\"time\":\"2020-01-01T01:00:00.25+01:00\"},\"geometry\":{\"type\":\"Point\","
		"\"coordinates\":[10,50]}}", "t.geojson");
	assert_true(track.count == 1 && track.fixes[0].time_s == 1577836800.25);
	eco_track_free(&track);
	track = track_of("{\"type\":\"LineString\",\"coordinates\":[[500000,5500000],[500001,"
		"5500000]]}", "c.json");
	assert_true(!track.degrees && track.count == 2 && strstr(track_notes, "--track-crs"));
	eco_track_free(&track);
	fails("{\"type\":\"Feature\","
		"\"properties\":{\"coordTimes\":[[\"2020-01-01T00:00:00Z\",\"2020-01-01T00:00:01Z\"]]},"
		"\"geometry\":"
		"{\"type\":\"MultiLineString\",\"coordinates\":[[[10,50],[11,50]]]}}", "nested.json",
		"coordTimes");
	fails("{\"type\":\"Feature\","
		"\"properties\":{\"coordTimes\":[\"2020-01-01T00:00:00Z\"]},"
		"\"geometry\":{\"type\":\"LineString\","
		"\"coordinates\":[[10,50],[11,50]]}}", "short.json", "coordTimes");
	fails("{\"a\": 1}", "d.json", "no track that is known");
	fails("{\"type\": \"LineString\", \"coordinates\": [[1, 2],]}", "e.json", "e.json:1:");
	fails("{\"type\": \"Polygon\", \"coordinates\": [[[0,0],[1,0],[1,1],[0,0]]]}", "f.json",
		"it has 1 record and no usable fix: no position, or one that cannot be; a track is made of points");
}

/* ---- Poses ---- */

static void gltf_cameras_move_with_their_parents(void **state)
{
	/* times 0, 1, 2; the parent goes along x to 10 and turns a quarter to the left; the camera stands 1
	 * behind it */
	static const float numbers[] = { 0, 1, 2, 0, 0, 0, 5, 0, 0, 10, 0, 0, 0, 0, 0, 1, 0, 0.38268343f, 0,
		0.92387953f, 0, 0.70710678f, 0, 0.70710678f };
	char json[2000], base64[200];
	static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	const uint8_t *bytes = (const uint8_t *)numbers;
	for (size_t i = 0, k = 0; i < sizeof numbers; i += 3, base64[k] = 0) {
		uint32_t word = (uint32_t)bytes[i] << 16 | (uint32_t)bytes[i + 1] << 8 | bytes[i + 2];
		for (int n = 0; n < 4; n++)
			base64[k++] = digits[word >> (18 - 6 * n) & 63];
	}
	snprintf(json, sizeof json, "{\"asset\":{\"version\":\"2.0\"},\"cameras\":[{\"type\":\"perspective\","
		"\"perspective\":{\"yfov\":0.7853981633974483,"
		"\"znear\":0.1}}],\"nodes\":[{\"children\":[1]},{\"camera\":0,\"name\":\"eye\","
		"\"translation\":[0,0,1]}],\"scenes\":[{\"nodes\":[0]}],"
		"\"buffers\":[{\"byteLength\":96,\"uri\":\"data:application/octet-stream;base64,%s\"}],"
		"\"bufferViews\":[{\"buffer\":0,\"byteLength\":96}],"
		"\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"SCALAR\"},"
		"{\"bufferView\":0,\"byteOffset\":12,"
			"\"componentType\":5126,"
		"\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":0,\"byteOffset\":48,\"componentType\":5126,"
		"\"count\":3,\"type\":\"VEC4\"}],"
			"\"animations\":[{\"channels\":"
		"[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"translation\"}},{\"sampler\":1,"
		"\"target\":{\"node\":0,\"path\":\"rotation\"}}],"
			"\"samplers\":[{\"input\":0,\"output\":1},{\"input\":0,\"output\":2}]}]}", base64);
	struct eco_track track = track_of(json, "a.gltf");
	const struct eco_fix *last = &track.fixes[track.count - 1];
	assert_true(track.format == ECO_TRACK_GLTF && track.posed && track.count == 121);
	assert_true(near(track.fixes[0].at[0], 0, 1e-5) && near(track.fixes[0].at[1], -1, 1e-5)
		&& near(track.fixes[0].yaw_deg, 0, 1e-4));
	assert_true(near(last->at[0], 11, 1e-5) && near(last->at[1], 0, 1e-5)
		&& near(last->yaw_deg, -90, 1e-4) && last->time_s == 2);
	assert_true(near(last->fov_y_deg, 45, 1e-9));
	eco_track_free(&track);
	fails("{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{}]}", "b.gltf",
		"no node of it has a camera");
}

/* ---- Tables ---- */

static void tables_are_read_by_the_names_of_their_columns(void **state)
{
	static const struct { const char *name, *text; bool degrees; struct eco_fix first; } rows[] = {
		{ "plain", "t,lon,lat,alt\n1,10,50,7\n", true, FIX(1, 10, 50, 7, NAN, NAN, NAN) },
		{ "airdata", "time(millisecond),datetime(utc),latitude,longitude,height_above_takeoff(feet),"
			"altitude_above_seaLevel(feet), "
			"compass_heading(degrees), pitch(degrees), "
			"gimbal_heading(degrees),gimbal_pitch(degrees)\n1500,2020-01-01 "
			"00:00:00,50,10,100,1000,1,2,-170.5,-30\n", true,
			FIX(1.5, 10, 50, 304.8, 30.48, -170.5, -30) },
		{ "metres", "t_s,x_east_m,y_north_m,z_up_m,yaw_deg,pitch_deg,roll_deg\n0.5,1,2,3,110,,\n",
			false, FIX(0.5, 1, 2, 3, NAN, 110, NAN) },
		{ "quoted, tabs, CRLF",
		"\"Latitude\"\t\"Longitude\"\t\"Time\"\r\n\"50\"\t\"10\"\t\"2020-01-01T00:00:00Z\"\r\n", true,
			FIX(1577836800, 10, 50, NAN, NAN, NAN, NAN) },
		{ "date and time", "Date,Time,Lat,Lon\n2020/01/01,00:00:05.5,50,10\n", true,
			FIX(1577836805.5, 10, 50, NAN, NAN, NAN, NAN) },
		{ "thousandths since 1970", "timestamp,lat,lng\n1577836800500,50,10\n", true,
			FIX(1577836800.5, 10, 50, NAN, NAN, NAN, NAN) },
		{ "whole ten-millionths", "t,lat,lon\n0,500000000,100000000\n", true,
			FIX(0, 10, 50, NAN, NAN, NAN, NAN) },
		{ "preamble, comments, spaces", "log of 2020\n# t, east, north, up\n# a comment\n 1.0 , "
			"2.0,3.0 ,4.0\n", false, FIX(1, 2, 3, 4, NAN, NAN, NAN) },
		{ "west in 0 to 360", "t,lon,lat\n0,350,50\n", true, FIX(0, -10, 50, NAN, NAN, NAN, NAN) },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct eco_track track = track_of(rows[i].text, "log.csv");
		assert_int_equal(track.format, ECO_TRACK_CSV);
		assert_true(track.degrees == rows[i].degrees);
		assert_fix(&track.fixes[0], &rows[i].first, rows[i].name);
		eco_track_free(&track);
	}
}

static void what_is_no_track_is_said_to_be_none(void **state)
{
	static const struct { const char *text, *path, *says; } rows[] = {
		{ "", "a.srt", "empty" }, { " \n\n", "a.gpx", "empty" }, { "PK\3\4xxxx", "a.kmz", "unzip" },
		{ "\xff\xfet", "a.csv", "no columns" }, { "\nhello\nworld\n", "a.txt", "a.txt: no format" },
		{ "hello\n", "a.txt", "begins \"hello\"" },
		{ "a,b,c\n1,2,3\n", "a.csv", "name its columns in the first line" },
		{ "t,lon,lat\n1,NA,\n2,500,3\n", "a.csv", "a.csv:2: read as CSV" },
		{ "t,lon,lat\n", "a.csv", "no fix found; it was read as CSV. Read are SRT" },
		{ "1\n", "a.srt", "no fix found" },
		{ "$GPRMC,081836,A,3751.65,S,14507.36,E,000.0,360.0,130998,011.3,E*62\n", "log.nmea",
			"GPSBabel converts other logs" },
		{ "AXXX001\nHFDTE270418\nB1101355206343N00006198WA0058700558\n", "a.igc", "Read are SRT" },
		{ "<html></html>", "a.kml", "a web page, not a track" },
		{ "<osm/>", "a.xml", "neither GPX nor KML" }, { "1 0 0 4 0 1 0 5\n", "00.txt", "name its "
			"columns" },
		{ "{\"frames\": []}", "poses.json", "no track that is known" },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		fails(rows[i].text, rows[i].path, rows[i].says);
	struct eco_track track = { 0 };
	struct eco_error error = { 0 };
	assert_int_equal(eco_track_read(&track, "tests", &error), ECO_IO);
	error = (struct eco_error){ 0 };
	assert_int_equal(eco_track_read(&track, "no/such/file.srt", &error), ECO_NOT_FOUND);
}

static void records_without_a_position_are_counted(void **state)
{
	struct eco_track track = track_of("1\n00:00:00,000 --> 00:00:01,000\nHOME(8.2,47.4) "
		"GPS(8.2,47.4,12.5m) BAROMETER:3\n\n2\n00:00:01,000 --> 00:00:02,000\nGPS(n/a,n/a,n/a)\n",
		"a.srt");
	assert_true(track.count == 1 && track.records == 2 && track.skipped == 1 && track.skipped_line == 6);
	eco_track_free(&track);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(subtitles_of_every_drone_are_read),
		cmocka_unit_test(focal_lengths_are_fields_of_view),
		cmocka_unit_test(gpx_tracks_win_over_way_points),
		cmocka_unit_test(gpx_that_breaks_off_is_read_until_there),
		cmocka_unit_test(kml_points_have_times_and_lines_win_over_points_without),
		cmocka_unit_test(geojson_lines_with_and_without_times),
		cmocka_unit_test(gltf_cameras_move_with_their_parents),
		cmocka_unit_test(tables_are_read_by_the_names_of_their_columns),
		cmocka_unit_test(what_is_no_track_is_said_to_be_none),
		cmocka_unit_test(records_without_a_position_are_counted),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
