/* ecopack camera, as a function. */
#ifndef ECO_MAIN_CAMERA_H
#define ECO_MAIN_CAMERA_H

#include "ecofiles/track.h"

struct camera_options {          /* NaN, 0 or NULL where not given; see the command's help */
	const char *input, *output, *scene, *crs, *track_crs;
	struct eco_track_options read;
	double origin[3], to[3], centre[3], look_at[3];
	bool origin_given, to_given, centre_given, look_at_given;
	double turn_deg, scale, clearance_m, pace, pause, from_s, to_s, smooth_s, pitch_deg, fov_y_deg, fps, speed;
	uint64_t part, keys;
	enum eco_track_height height;
};

enum eco_code camera_make(const struct camera_options *options, struct eco_error *error);

#endif
