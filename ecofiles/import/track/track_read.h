/* Shared by the files of this room. */
#pragma once

#include "ecofiles/import/track/track.h"

#define TRACK_DEG 57.29577951308232

/* Columns of tables. The first are the numbers of a fix, in their order. */
enum track_role { TRACK_TIME, TRACK_X, TRACK_Y, TRACK_Z, TRACK_ABOVE, TRACK_YAW, TRACK_PITCH, TRACK_ROLL,
	TRACK_FOV, TRACK_LON, TRACK_LAT, TRACK_DATE, TRACK_ROLES };
/* Speeds over a second or more, so that rounding and noise do not pass for motion; stands are left out. At
 * most track->count, ascending; returns how many. */
uint32_t track_speeds(const struct eco_track *track, double *speeds);
/* Sorts; 0 if there are none. */
double track_quantile(double *values, uint32_t count, double share);
