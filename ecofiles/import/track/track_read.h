/* Shared by the parts of this room: fixes as they come, numbers and clocks in texts, tables, distances. */
#ifndef ECO_TRACK_READ_H
#define ECO_TRACK_READ_H

#include "ecofiles/import/track/track.h"

#define TRACK_DEG 57.29577951308232

/* CSV and GPX (track_read.c). `formats` says in errors what is read. */
enum eco_code track_read_rows(struct eco_track *track, const char *formats, struct eco_error *error);

/* Nothing is known of it yet. */
#define TRACK_FIX(at_line) \
	(struct eco_fix){ .n = { NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN }, .line = at_line }
/* Checks and takes: what has no position, or an impossible one, is counted instead. Each call is one record.
 * ECO_TOO_LARGE. */
enum eco_code track_add(struct eco_track *track, const struct eco_fix *fix, struct eco_error *error);

/* Each of these moves *text behind what it reads (after spaces), or returns false and leaves it. No "nan". */
bool track_number(const char **text, double *value);
/* 15:19:58.72 or 15:19:58,720,764 or 9:05; seconds since midnight. */
bool track_clock(const char **text, double *time_s);

/* Columns of tables. The first are the numbers of a fix, in their order. */
enum track_role { TRACK_TIME, TRACK_X, TRACK_Y, TRACK_Z, TRACK_ABOVE, TRACK_YAW, TRACK_PITCH, TRACK_ROLL,
	TRACK_FOV, TRACK_LON, TRACK_LAT, TRACK_DATE, TRACK_ROLES };
/* The meaning of one name, as drones' logs and spreadsheets have it; TRACK_ROLES: none. rank: how good a name
 * for it, 0 the best; unit: the factor of what the name states, or NaN. */
enum track_role track_role_of(const char *name, uint32_t *rank, double *unit);

/* Speeds over a second or more, so that rounding and noise do not pass for motion; stands are left out. At
 * most track->count, ascending; returns how many. */
uint32_t track_speeds(const struct eco_track *track, double *speeds);
/* Sorts; 0 if there are none. */
double track_quantile(double *values, uint32_t count, double share);

#endif
