/* What the parts of this room share: texts with numbers and dates as people write them, tables, fixes as they come, distances. */
#ifndef ECO_TRACK_READ_H
#define ECO_TRACK_READ_H

#include <math.h>

#include "ecofiles/import/track/track.h"

struct track_input {
	const char *text;            /* ended by 0 beyond size */
	size_t size;
	const char *path;            /* for messages; GDAL opens it */
	const struct eco_track_options *options;
};

typedef enum eco_code track_reader(struct eco_track *track, const struct track_input *in, struct eco_error *error);
track_reader track_read_srt, track_read_rows, track_read_csv, track_read_gltf;

/* All NaN, at line `line`. */
struct eco_fix track_fix(uint32_t line);
/* Checks and takes: what has no position, or an impossible one, is counted instead. Each call is one record. ECO_TOO_LARGE or
 * ECO_NO_MEMORY. */
enum eco_code track_add(struct eco_track *track, const struct eco_fix *fix, struct eco_error *error);

/* ---- Texts ---- */

struct track_text { const char *text, *end; };   /* not ended by 0 */
struct track_line { const char *text, *end; uint32_t number; };
/* The next line, without its end; false after the last. *line is zeroed before the first. */
bool track_next_line(const struct track_input *in, struct track_line *line);
/* Case does not matter. */
bool track_starts(const char *text, const char *end, const char *word);
bool track_is(const char *text, const char *end, const char *word);
bool track_holds(const char *text, const char *end, const char *word);

/* Each of these moves *text behind what it reads (after spaces), or returns false and leaves it. No locale, no "nan". */
bool track_number(const char **text, const char *end, double *value);
/* 2020-04-02T15:19:58.720Z, with +02:00, 2020/04/02 15:19:58, 2017.8.5 14:11:51,393,525, 02.04.2020 15:19:58, 4/25/2020; without a zone
 * taken for UTC. Seconds since 1970. */
bool track_date_time(const char **text, const char *end, double *time_s);
/* 15:19:58.72 or 15:19:58,720 or 9:05; seconds since midnight. */
bool track_clock(const char **text, const char *end, double *time_s);
/* The whole text is a number but for spaces. */
bool track_is_number(const char *text, const char *end, double *value);

/* ---- Tables: columns by the names that loggers, planners and spreadsheets give them, or as the options say ---- */

enum track_role { TRACK_TIME, TRACK_DATE, TRACK_LON, TRACK_LAT, TRACK_ALT, TRACK_ABOVE, TRACK_X, TRACK_Y, TRACK_Z, TRACK_YAW, TRACK_PITCH,
	TRACK_ROLL, TRACK_QX, TRACK_QY, TRACK_QZ, TRACK_QW, TRACK_FOV, TRACK_ROLES };
#define TRACK_NAME_BYTES 64u

struct track_table {
	const struct track_input *in;
	bool commas;                         /* a comma may be a decimal point */
	int column[TRACK_ROLES];             /* -1: none */
	double unit[TRACK_ROLES];            /* NaN: not stated */
	char label[TRACK_ROLES][TRACK_NAME_BYTES];
	double day_s, last_clock_s;          /* of clocks without a date, which pass midnight */
};

/* Which column means what: by the options, then by name. They fail only for options that do not fit. */
enum eco_code track_find_columns(struct track_table *table, const struct track_text *names, uint32_t count, struct eco_error *error);
bool track_has_degrees(const struct track_table *table);
bool track_has_place(const struct track_table *table);
/* What a row says, in file order; *posed becomes true where it has a quaternion. */
struct eco_fix track_row(struct track_table *table, const struct track_text *fields, uint32_t count, uint32_t line, bool *posed);
void track_say_columns(struct eco_track *track, const struct track_table *table);

/* ---- Cleaning ---- */

/* Every fix gets a time, in file order not descending; see eco_track_clean for how. Positions are metres. */
enum eco_code track_repair_stamps(struct eco_track *track, double pace_m_s, struct eco_track_report *report, struct eco_error *error);
/* Metres; without heights, in the plane. */
double track_distance(const struct eco_fix *a, const struct eco_fix *b);
/* Speeds (in the plane, or with heights) over a second or more, so that rounding and noise do not pass for motion; stands are left out. At
 * most track->count, ascending; returns how many. */
uint32_t track_speeds(const struct eco_track *track, bool flat, double *speeds);
/* Sorts; 0 if there are none. */
double track_quantile(double *values, uint32_t count, double share);

/* ---- Poses ---- */

/* A camera's rotation to the world, row by row, and its position: axes as the options have them, else as stated; Z is up afterwards. */
void track_pose(struct eco_fix *fix, const struct track_input *in, const double rotation[9], const double position[3], enum eco_axes axes,
	enum eco_world world);

#endif
