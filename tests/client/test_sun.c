/* The sun: published positions, facts of the year, times as people write them, and shadows that fall
 * away from it. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "client-min/draw/view_light.h"
#include "client-min/view_options.h"
#include "tests/support/unit_test.h"
#include "tests/support/view_scene.h"

#define DEGREES (180 / 3.14159265358979323846)

static double time_of(const char *text)
{
	double unix_s = 0;
	assert_good(view_time_read(text, &unix_s, &cause));
	return unix_s;
}

static double height_deg(const float sun[3]) { return asin((double)sun[2]) * DEGREES; }

/* Clockwise from north. */
static double azimuth_deg(const float sun[3])
{
	return fmod(atan2((double)sun[0], (double)sun[1]) * DEGREES + 360, 360);
}

/* Reda and Andreas 2003, "Solar position algorithm", appendix A.5: zenith 50.11162 (0.017 of it refraction),
 * azimuth 194.34024. */
UNIT_TEST(a_published_position_is_found)
{
	struct view_sun_place place = { -105.1786, 39.742476, 0 };
	float sun[3];
	view_sun_at(&place, time_of("2003-10-17T12:30:30-07:00"), sun);
	assert_true(fabs(height_deg(sun) - (90 - 50.11162 - 0.017)) < 0.03);
	assert_true(fabs(azimuth_deg(sun) - 194.34024) < 0.03);
	double length = 0;
	for (int k = 0; k < 3; k++)
		length += (double)sun[k] * (double)sun[k];
	assert_true(fabs(length - 1) < 1e-6);
}

/* In the forenoon, thus in the east, and about as high as at the same time of any month. */
UNIT_TEST(without_a_time_it_is_a_morning_of_midsummer)
{
	static const struct view_sun_place places[] = { { 10, 50, 0 }, { -120, 38, 0 }, { 150, -34, 0 }, { 0, 70, 0 } };
	for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
		float usual[3], other[3];
		view_sun_usual(&places[i], usual);
		bool south = places[i].latitude_deg < 0;
		assert_true(usual[0] > 0.25f && usual[2] > 0.5f && (usual[1] > 0) == south);
		for (int month = 1; month <= 12; month++) {
			char text[32];
			snprintf(text, sizeof text, "2000-%02d-21T10:00Z", month);
			view_sun_at(&places[i], time_of(text) - places[i].longitude_deg * 240, other);
			assert_true(other[2] < usual[2] + 0.01f);        /* clocks differ from the sun by 14 minutes */
		}
	}
}

UNIT_TEST(a_map_turned_clockwise_sees_the_sun_turned_back)
{
	struct view_sun_place place = { 15, 50, 0 }, turned = { 15, 50, 2.5 };
	float a[3], b[3];
	view_sun_at(&place, time_of("2026-03-20T09:00Z"), a);
	view_sun_at(&turned, time_of("2026-03-20T09:00Z"), b);
	assert_true(fabs(azimuth_deg(a) - azimuth_deg(b) - 2.5) < 1e-3);
	assert_true(fabsf(a[2] - b[2]) < 1e-6f);
}

UNIT_TEST(times_are_read_as_they_are_written)
{
	static const struct { const char *text; double unix_s; } good[] = { { "1970-01-01T00:00Z", 0 },
		{ "2026-06-21T10:00Z", 1782036000 }, { "2026-06-21T12:00+02:00", 1782036000 },
		{ "2026-06-21T04:30:05-05:30", 1782036005 } };
	static const char *const bad[] = { "", "now", "2026-06-21", "2026-06-21T10:00", "2026-13-01T10:00Z",
		"2026-06-21T24:00Z", "2026-06-21T10:61Z", "2026-06-21T10:00Zulu", "2026-06-21T10:00+2",
		"1800-01-01T00:00Z" };
	for (size_t i = 0; i < sizeof good / sizeof *good; i++)
		assert_true(time_of(good[i].text) == good[i].unix_s);
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		double unix_s;
		assert_code(view_time_read(bad[i], &unix_s, &cause), ECO_BAD_USAGE, "2026-06-21T10:00Z");
	}
}

/* The sum of sunlight taken, and its mean place, from the only plant. */
static double shadow_of(const struct scene_held *h, const struct view_selection *selection, double mean[2])
{
	FREED(view_shade) shade;
	const double *at = selection->instances[0].place.at;
	double sum = 0;
	mean[0] = mean[1] = 0;
	assert_good(view_shade_make(&shade, h->store, selection, &cause));
	double texel = shade.size_m / VIEW_SHADE_PIXELS;
	for (int j = 0; j < VIEW_SHADE_PIXELS; j++)
		for (int i = 0; i < VIEW_SHADE_PIXELS; i++) {
			double taken = shade.texels[2 * (j * VIEW_SHADE_PIXELS + i)];
			sum += taken;
			mean[0] += taken * (shade.low[0] + (i + 0.5) * texel - at[0]);
			mean[1] += taken * (shade.low[1] + (j + 0.5) * texel - at[1]);
		}
	return sum;
}

UNIT_TEST(shadows_fall_away_from_the_sun)
{
	static const float suns[][3] = { { 0.6f, 0, 0.8f }, { -0.6f, 0, 0.8f }, { 0, 0.6f, 0.8f },
		{ 0.4f, -0.5f, 0.768f } };
	scene_open(NULL);
	AT_END(scene_release) struct scene_held h = scene_hold(&grove);
	scene_select(&h);
	uint32_t tree = 0;
	while (h.selection.instances[tree].plant != 0)
		tree++;
	struct view_selection alone = { .instances = &h.selection.instances[tree], .instance_count = 1 };
	double mean[2];
	for (size_t i = 0; i < sizeof suns / sizeof *suns; i++) {
		memcpy(alone.sky.sun, suns[i], sizeof alone.sky.sun);
		assert_true(shadow_of(&h, &alone, mean) > 0);
		double along = mean[0] * (double)suns[i][0] + mean[1] * (double)suns[i][1],
			across = mean[0] * (double)suns[i][1] - mean[1] * (double)suns[i][0];
		assert_true(along < 0 && fabs(across) < 0.1 * fabs(along));
	}
	alone.sky = (struct view_sky){ .haze_m = 0 };    /* the usual sun is in the south-east */
	assert_true(shadow_of(&h, &alone, mean) > 0 && mean[0] < 0 && mean[1] > 0);
	memcpy(alone.sky.sun, (const float[3]){ 0.9f, 0.3f, -0.3f }, sizeof alone.sky.sun);
	assert_true(shadow_of(&h, &alone, mean) == 0);
	scene_close(NULL);
}
