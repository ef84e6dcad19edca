/* What the readers of tracks share: a text with a place in it, numbers and dates as people write them, fixes as they come. */
#ifndef ECO_TRACK_READ_H
#define ECO_TRACK_READ_H

#include <math.h>

#include "ecofiles/import/track/track.h"

struct track_input {
	const char *text;            /* ended by 0 beyond size */
	size_t size;
	const char *path;            /* for messages */
	const struct eco_track_options *options;
};

typedef enum eco_code track_reader(struct eco_track *track, const struct track_input *in, struct eco_error *error);
track_reader track_read_srt, track_read_igc, track_read_nmea, track_read_xml, track_read_json, track_read_csv, track_read_colmap,
	track_read_tum, track_read_kitti, track_read_gltf;

/* ---- Fixes ---- */

/* All NaN, at line `line`. */
struct eco_fix track_fix(uint32_t line);
/* Checks and takes: what has no position, or an impossible one, is counted instead. Each call is one record. ECO_TOO_LARGE or
 * ECO_NO_MEMORY. */
enum eco_code track_add(struct eco_track *track, const struct eco_fix *fix, struct eco_error *error);
void track_skip(struct eco_track *track, enum eco_track_skip why, uint32_t line);

/* ---- Lines: [*at, returned) without its end; false after the last ---- */

struct track_line { const char *text, *end; uint32_t number; };
bool track_next_line(const struct track_input *in, struct track_line *line);     /* zeroed before the first */

/* ---- Numbers and times within [text, end) ---- */

/* A decimal number at *text (after spaces), moved behind it; a comma is no decimal point. False, and *text stays, if there is none. No
 * locale, no hexadecimal, no "nan". */
bool track_number(const char **text, const char *end, double *value);
/* The whole text is a number but for spaces. */
bool track_is_number(const char *text, const char *end, double *value);
int track_by_value(const void *a, const void *b);        /* doubles, ascending, for qsort */
/* A date and time in one of the usual forms: 2020-04-02T15:19:58.720Z, with +02:00, 2020/04/02 15:19:58, 2017.8.5 14:11:51,393,525,
 * 02.04.2020 15:19:58. Without a zone it is taken for UTC. Seconds since 1970. *text is moved behind it. */
bool track_date_time(const char **text, const char *end, double *time_s);
/* 15:19:58.72 or 15:19:58,720 or 9:05; seconds since midnight. */
bool track_clock(const char **text, const char *end, double *time_s);
double track_days(int year, int month, int day);         /* since 1970 */
/* Case does not matter. */
bool track_starts(const char *text, const char *end, const char *word);
const char *track_find(const char *text, const char *end, const char *word);
/* So many digits at text, as a whole number; -1 if they are not all digits. */
int track_digits(const char *text, const char *end, int count);

/* ---- Looks ---- */

/* A pose: camera to world, rotation row by row and position, with axes as the format (or the options) have them, Z up afterwards. */
struct track_axes { enum eco_axes axes; enum eco_world world; };
void track_pose(struct eco_fix *fix, const double rotation[9], const double position[3], struct track_axes axes);
struct track_axes track_axes_of(const struct track_input *in, enum eco_axes axes, enum eco_world world);
/* Quaternion x, y, z, w to a rotation, row by row; false if it is zero or not finite. */
bool track_rotation(const double q[4], double rotation[9]);

/* Names with numbers in the order that people mean: frame_2 before frame_10. */
int track_compare_names(const char *a, const char *b);

/* Poses of pictures, whose order is that of their names: files of photogrammetry list them as they were matched. */
struct track_named { char *name; struct eco_fix fix; uint32_t place; };
struct track_names { struct track_named *items; uint32_t count; };
enum eco_code track_names_add(struct track_names *names, const char *name, size_t length, const struct eco_fix *fix, struct eco_error *error);
/* To the track, by name if all have different ones; frees. */
enum eco_code track_names_end(struct track_names *names, struct eco_track *track, struct eco_error *error);

/* Gives fixes without any times i / rate, and says so. */
void track_set_rate(struct eco_track *track, const struct track_input *in, double rate);

#endif
