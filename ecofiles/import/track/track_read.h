/* What the parts of this room share: texts with numbers and dates as people write them, tables, fixes as they
 * come, distances. */
#ifndef ECO_TRACK_READ_H
#define ECO_TRACK_READ_H

#include "ecofiles/import/track/track.h"

#define TRACK_DEG 57.29577951308232

struct track_input {
	const char *text;            /* ended by 0 beyond size */
	size_t size;
	const char *path;            /* for messages; GDAL opens it */
	const char *node;
};

typedef enum eco_code track_reader(struct eco_track *track, const struct track_input *in,
	struct eco_error *error);
track_reader track_read_srt, track_read_rows, track_read_csv, track_read_gltf;

/* All NaN, at line `line`. */
struct eco_fix track_fix(uint32_t line);
/* Checks and takes: what has no position, or an impossible one, is counted instead. Each call is one record.
 * ECO_TOO_LARGE or ECO_NO_MEMORY. */
enum eco_code track_add(struct eco_track *track, const struct eco_fix *fix, struct eco_error *error);

/* ---- Texts ---- */

struct track_text { const char *text, *end; };   /* not ended by 0 */
struct track_line { const char *text, *end; uint32_t number; };
/* The next line, without its end; false after the last. *line is zeroed before the first. */
bool track_next_line(const struct track_input *in, struct track_line *line);
/* Case does not matter. */
bool track_is(const char *text, const char *end, const char *word);
bool track_holds(const char *text, const char *end, const char *word);

/* Each of these moves *text behind what it reads (after spaces), or returns false and leaves it. No locale,
 * no "nan". */
bool track_number(const char **text, const char *end, double *value);
/* 2020-04-02T15:19:58.720Z, with +02:00, 2020/04/02 15:19:58, 2017.8.5 14:11:51,393,525; without a zone taken
 * for UTC. Seconds since 1970. */
bool track_date_time(const char **text, const char *end, double *time_s);
/* 15:19:58.72 or 15:19:58,720,764 or 9:05; seconds since midnight. */
bool track_clock(const char **text, const char *end, double *time_s);

/* ---- Tables: columns by the names that recorders give them ---- */

enum track_role { TRACK_TIME, TRACK_DATE, TRACK_LON, TRACK_LAT, TRACK_X, TRACK_Y, TRACK_UP, TRACK_ABOVE,
	TRACK_YAW, TRACK_PITCH, TRACK_ROLL, TRACK_FOV, TRACK_ROLES };
struct track_table {
	int column[TRACK_ROLES];             /* -1: none */
	double unit[TRACK_ROLES];            /* NaN: not stated */
	bool degrees;                        /* it has longitudes and latitudes */
};
/* Which column means what. False if there is no position among them. */
bool track_find_columns(struct track_table *table, const struct track_text *names, uint32_t count);
struct eco_fix track_row(const struct track_table *table, const struct track_text *fields, uint32_t count,
	uint32_t line);

/* ---- Measures ---- */

/* Metres; without heights, in the plane. */
double track_distance(const struct eco_fix *a, const struct eco_fix *b);
/* Speeds over a second or more, so that rounding and noise do not pass for motion; stands are left out. At
 * most track->count, ascending; returns how many. */
uint32_t track_speeds(const struct eco_track *track, double *speeds);
/* Sorts; 0 if there are none. */
double track_quantile(double *values, uint32_t count, double share);

#endif
