/* Tracks for tests: of a recording written out here, or made fix by fix in metres. */
#pragma once

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/track/track.h"
#include "tests/support/input_files.h"
#include "tests/support/unit_test.h"

#define DEG 57.29577951308232

static char track_notes[8192];           /* of the track that was read last */

/* The track of a file with this text. */
static inline struct eco_track track_of(const char *text, const char *name)
{
	FILE *notes = fmemopen(track_notes, sizeof track_notes, "w");
	struct eco_track track = { .notes = notes };
	struct eco_error error = { 0 };
	if (eco_track_read(&track, input_text(program_invocation_short_name, name, text), &error))
		fail_msg("%s: %s", name, error.text);
	fclose(notes);
	track.notes = NULL;
	return track;
}

static inline bool near(double a, double b, double most)
{
	return (isnan(a) && isnan(b)) || fabs(a - b) <= most;
}

/* ---- In metres ---- */

struct made { struct eco_track track; uint32_t room; };

static inline struct made made_track(uint32_t room)
{
	struct made m = { .track = { .format = ECO_TRACK_CSV, .timed = true }, .room = room };
	m.track.fixes = calloc(room, sizeof *m.track.fixes);
	assert_non_null(m.track.fixes);
	return m;
}

static inline struct eco_fix *put(struct made *m, double t, double x, double y, double z)
{
	assert_true(m->track.count < m->room);
	struct eco_fix *fix = &m->track.fixes[m->track.count++];
	*fix = (struct eco_fix){ .time_s = t, .at = { x, y, z }, .above_m = NAN, .yaw_deg = NAN,
		.pitch_deg = NAN, .roll_deg = NAN, .fov_y_deg = NAN,
		.line = m->track.count };
	return fix;
}

/* 10 m/s along x for `count` seconds. */
static inline struct made straight(uint32_t count)
{
	struct made m = made_track(count);
	for (uint32_t i = 0; i < count; i++)
		put(&m, 100 + i, 10.0 * i, 0, 50);
	return m;
}

static const struct eco_track_options track_defaults = ECO_TRACK_DEFAULTS;

static inline struct eco_track_report cleaned(struct eco_track *track)
{
	eco_track_clean(track);
	const struct eco_track_report report = track->report;
	assert_int_equal(report.fixes, report.kept + report.repeated + report.jumped);
	assert_true(track->fixes[0].time_s == 0);
	for (uint32_t i = 1; i < track->count; i++)
		assert_true(track->fixes[i].time_s > track->fixes[i - 1].time_s);
	return report;
}
