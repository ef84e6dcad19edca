/* The command line of ecoview.
 *
 *   view_options_read(argc, argv, &options, &error); */
#pragma once

#include "client-min/view_fetch.h"
#include "client-min/view_select.h"
#include "ecofiles/base/options.h"

enum view_engine { VIEW_ENGINE_NONE, VIEW_ENGINE_AUTO, VIEW_ENGINE_CPU, VIEW_ENGINE_EGL };

struct view_options {
	const char *url, *camera, *dir, *explain, *chunks, *truths;
	uint32_t size[2], width, height;
	uint64_t vertices, bytes, memory, samples;
	double ground_px, texel_px, ahead_s, sun_s, snap_m;
	struct view_sky sky;                     /* but for the sun */
	bool has_frames, compare, digest, owners, geojson, smooth;
	uint64_t frame_first, frame_last;
	enum view_engine reference;
	int tint;                                /* enum view_tint */
	int rule;                                /* of view_rules */
	struct view_marks marks;                 /* of --progressive */
};

extern const struct eco_command view_command;
extern const char *const view_rules[];           /* as the server calls them */

/* ECO_BAD_USAGE says what is wrong. Once in a process. */
enum eco_code view_options_read(int argc, char **argv, struct view_options *options, struct eco_error *error);

/* Reads a time such as 2026-06-21T10:00Z, 2026-06-21T10:00:30Z or 2026-06-21T12:00+02:00 into *unix_s, a
 * double. ECO_BAD_USAGE. */
enum eco_code view_time_read(const char *text, void *unix_s, struct eco_error *error);
