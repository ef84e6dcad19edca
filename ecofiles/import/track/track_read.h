/* Shared by the parts of this room: fixes as they come, numbers and clocks in texts, tables, distances. */
#ifndef ECO_TRACK_READ_H
#define ECO_TRACK_READ_H

#include "ecofiles/import/track/track.h"

#define TRACK_DEG 57.29577951308232

/* The end of messages about files of another kind. */
#define TRACK_FORMATS "Read are SRT (a drone writes it beside its film), GPX, KML, GeoJSON, CSV in UTF-8, " \
	"glTF and camera scripts; GPSBabel converts other logs of GPS to GPX"

typedef enum eco_code track_reader(struct eco_track *track, struct eco_error *error);
track_reader track_read_srt, track_read_rows, track_read_gltf;

/* Nothing is known of it yet. */
#define TRACK_FIX(at_line) \
	(struct eco_fix){ .n = { NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN }, .line = at_line }
/* Checks and takes: what has no position, or an impossible one, is counted instead. Each call is one record.
 * ECO_TOO_LARGE or ECO_NO_MEMORY. */
enum eco_code track_add(struct eco_track *track, const struct eco_fix *fix, struct eco_error *error);

/* Each of these moves *text behind what it reads (after spaces), or returns false and leaves it. No "nan". */
bool track_number(const char **text, double *value);
/* 15:19:58.72 or 15:19:58,720,764 or 9:05; seconds since midnight. */
bool track_clock(const char **text, double *time_s);

/* ---- Tables: columns by the names that recorders give them ---- */

/* The first are the numbers of a fix, in their order. */
enum track_role { TRACK_TIME, TRACK_X, TRACK_Y, TRACK_Z, TRACK_ABOVE, TRACK_YAW, TRACK_PITCH, TRACK_ROLL,
	TRACK_FOV, TRACK_LON, TRACK_LAT, TRACK_DATE, TRACK_MODE, TRACK_ROLES };
struct track_table {
	uint32_t column[TRACK_ROLES];        /* ECO_NONE: none */
	double unit[TRACK_ROLES];            /* NaN: not stated */
	bool degrees;                        /* it has longitudes and latitudes */
};
/* The meaning of one name, as drones' logs and spreadsheets have it; TRACK_ROLES: none. rank: how good a name
 * for it, 0 the best; unit: the factor of what the name states, or NaN. */
enum track_role track_role_of(const char *name, uint32_t *rank, double *unit);
/* Which column means what. False if there is no position among them. */
bool track_find_columns(struct track_table *table, const char *const *names, uint32_t count);
struct eco_fix track_row(const struct track_table *table, const char *const *fields, uint32_t count,
	uint32_t line);

/* Metres; without heights, in the plane. */
double track_distance(const struct eco_fix *a, const struct eco_fix *b);
/* Speeds over a second or more, so that rounding and noise do not pass for motion; stands are left out. At
 * most track->count, ascending; returns how many. */
uint32_t track_speeds(const struct eco_track *track, double *speeds);
/* Units at right angles. */
void track_axes(double yaw_deg, double pitch_deg, double roll_deg, double look[3], double up[3]);
/* Sorts; 0 if there are none. */
double track_quantile(double *values, uint32_t count, double share);

#endif
