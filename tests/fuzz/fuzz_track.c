/* Recorded tracks: whatever the bytes, an error or a track; and whatever the track, a flight and a script
 * that plays. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "ecofiles/import/track/track.h"
#include "ecofiles/format/view.h"

#define FIXES_MAX 300u                   /* longer tracks only make it slower, and so do scripts */
#define FRAMES_MAX 1000u

/* In place of PROJ, which takes longer than all else together. */
static void to_metres(struct eco_track *track)
{
	for (uint32_t i = 0; track->degrees && i < track->count; i++)
		for (int axis = 0; axis < 2; axis++)
			track->fixes[i].at[axis] *= 111195;
	track->degrees = false;
	track->still_m = 0.1;
}

static void play(const struct eco_script *script)
{
	struct eco_camera *camera;
	struct eco_view view = { .width = 4, .height = 3 };
	struct eco_error error = { 0 };
	/* what lasts for years has times that are too large; nothing else may be wrong */
	if (script->frames <= FRAMES_MAX && script->length_s < 1e8) {
		enum eco_code code = eco_camera_parse(&camera, script->text, script->size, "made.json",
			&error);
		assert(code == ECO_OK);
		eco_camera_frame(camera, eco_camera_frame_count(camera) - 1, &view);
		assert(eco_view_check(&view, NULL) == ECO_OK);
		eco_camera_free(camera);
	}
}

static void fly(struct eco_track *track)
{
	struct eco_flight flight;
	struct eco_script script = { 0 };
	struct eco_track_options defaults = ECO_TRACK_DEFAULTS;
	defaults.fps = 2;                /* so that scripts of minutes are played, too */
	to_metres(track);
	eco_track_clean(track);
	const struct eco_track_report report = track->report;
	assert(report.fixes == report.kept + report.repeated + report.jumped && report.kept > 0);
	for (uint32_t i = 1; i < track->count; i++)
		assert(track->fixes[i].time_s > track->fixes[i - 1].time_s);
	eco_flight_make(&flight, track, &defaults);
	for (uint32_t i = 0; i < flight.count; i++)
		for (int k = 0; k < 3; k++)
			assert(isfinite(flight.samples[i].eye[k]) && isfinite(flight.samples[i].look[k])
				&& isfinite(flight.samples[i].up[k]));
	if (flight.count <= FIXES_MAX && eco_script_fit(&script, &flight, &defaults, NULL) == ECO_OK)
		play(&script);
	free(script.text);
	eco_flight_free(&flight);
}

static int file_of(const uint8_t *bytes, size_t size, char path[64])
{
	int file = memfd_create("track", 0);
	assert(file >= 0 && write(file, bytes, size) == (ssize_t)size);
	snprintf(path, 64, "/proc/self/fd/%d", file);
	return file;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	struct eco_track track = { 0 };
	struct eco_error error = { 0 };
	char path[64];
	int file = file_of(bytes, size, path);
	enum eco_code code = eco_track_read(&track, path, &error);
	close(file);
	assert(code == error.code && (code == ECO_OK || !track.fixes));
	for (uint32_t i = 0; i < track.count; i++)
		assert(isfinite(track.fixes[i].at[0]) && isfinite(track.fixes[i].at[1]));
	if (code == ECO_OK && track.count > 0 && track.count <= FIXES_MAX)
		fly(&track);
	eco_track_free(&track);
	return 0;
}
