/* Recorded tracks: where a camera, a drone or a walker was, as files of other programs have it, made into a
 * camera script: by eco_track_read, _place, _clean, eco_flight_make, _move and eco_script_fit, in this order.
 *
 * Positions and looks are recorded at rates of their own, so they are two series until a flight samples both
 * evenly. Angles are a drone's: yaw clockwise from north (+Y), pitch up from the horizon, roll to the right;
 * NaN is what was not recorded, everywhere. A counter or a note says each repair. */
#pragma once

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "ecofiles/base/status.h"
#include "ecofiles/import/ground/ground.h"

#define ECO_TRACK_BYTES_MAX (1u << 30)
#define ECO_TRACK_FIXES_MAX (1u << 24)
#define ECO_TRACK_PACE_M_S 10.0          /* of tracks without any time */
#define ECO_SCRIPT_FRAMES 20000u

enum eco_track_height {
	ECO_HEIGHTS_DEFAULT,         /* above take-off if recorded, else above the sea */
	ECO_HEIGHTS_ABSOLUTE, ECO_HEIGHTS_RELATIVE
};

struct eco_track_options {       /* begin with ECO_TRACK_DEFAULTS; NaN: not stated */
	const char *crs;             /* of the scene; NULL: metres from the track's middle, or its own zero */
	double origin[3];            /* of the scene, in crs */
	const char *track_crs;       /* of fixes that are metres; NULL: metres from the origin */
	int height;                  /* enum eco_track_height */
	double smooth_s;             /* NaN: by the rounding, rate and speed of the track */
	double pitch_deg;            /* replaces what was recorded; NaN: that, else level, or a drone's */
	double fov_y_deg;            /* NaN: as recorded, else 60 */
	double speed;                /* 0: 1 */
	bool to_given;               /* the first eye goes to `to`, whatever `crs` says */
	double to[3], turn_deg;      /* counter-clockwise, about the first eye */
	bool has_ground;             /* of a scene: eyes stay clearance_m above it */
	const struct eco_ground *ground;     /* NULL: the ground is z = 0 */
	double clearance_m;
	bool look_at_given; double look_at[3];
	double fps;                  /* 0: 30, or less if that were more than ECO_SCRIPT_FRAMES frames */
};
#define ECO_TRACK_DEFAULTS { .smooth_s = NAN, .pitch_deg = NAN, .fov_y_deg = NAN, .clearance_m = 1.7 }

/* ---- As recorded ---- */

enum eco_track_format {
	ECO_TRACK_SRT,               /* subtitles of a drone's film */
	ECO_TRACK_GPX,               /* through GDAL */
	ECO_TRACK_CSV,
	ECO_TRACK_SCRIPT             /* our own: no fixes, `text` is to be taken as it is */
};

/* time_s: since 1970 where the file has dates, else since a zero of its own. at: degrees east and north and
 * metres, or metres x, y, z; only at[2] may be NaN. above_m: above take-off. */
#define ECO_FIX_NUMBERS 9
struct eco_fix {
	union {
		struct { double time_s, at[3], above_m, yaw_deg, pitch_deg, roll_deg, fov_y_deg; };
		double n[ECO_FIX_NUMBERS];
	};
	uint32_t line;               /* of the file, or number of the record, from 1 */
};

/* Counted by cleaning. */
struct eco_track_report {
	uint32_t fixes, kept, repeated, jumped;      /* before cleaning: kept + repeated + jumped */
	uint32_t stamps_missing, stamps_wrong, stamps_equal, retimed;
	uint32_t parts;              /* between jumps that do not come back: only the longest is kept */
	bool sorted, untimed;
};

struct eco_track {
	enum eco_track_format format;
	bool degrees;                /* at[0], at[1] are degrees east and north, WGS 84 */
	bool timed;                  /* some fixes have a time */
	bool has_height;             /* of the kind `height`, which placing chose */
	enum eco_track_height height;
	bool local;                  /* nothing says where its degrees are in the scene; set by placing */
	double still_m;              /* the step to which positions are rounded; set by placing */
	struct eco_fix *fixes;       uint32_t count, capacity;
	uint32_t records, skipped, skipped_line;     /* without a usable position; the first of them */
	struct eco_track_report report;
	const char *path;            /* for messages; tables are read from it */
	char *text; size_t size;     /* the file's and then its only 0; readers may cut it by zeros */
	FILE *notes;                 /* lines for the user are written there; NULL: nowhere */
};

/* Reads a file; sets all of *track but notes. The file is a stranger's: call this in a child with limits
 * (guard.h). A file without a usable fix is an error that says what was found instead.
 * `path` must outlive the track. Free with eco_track_free, which takes a zeroed one too. */
enum eco_code eco_track_read(struct eco_track *track, const char *path, struct eco_error *error);
void eco_track_free(struct eco_track *track);

/* A sentence for the user, of a struct eco_track. */
void eco_track_note(void *track, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* at[] becomes metres from the origin, of the height asked for; yaw counts from the frame's north (which is
 * not true north); still_m is found. Errors: no height of the kind asked for; a CRS that is not known, not
 * projected or not in metres; no fix that it holds. */
enum eco_code eco_track_place(struct eco_track *track, const struct eco_track_options *options,
	struct eco_error *error);

/* Repairs time stamps, repeated positions, jumps and gaps, and counts what it repairs (track_clean.c). Times
 * then count from 0 and ascend. */
void eco_track_clean(struct eco_track *track);

#define ECO_SAMPLE_NUMBERS 10
struct eco_sample {
	union {                      /* look and up: units, at right angles */
		struct { double eye[3], look[3], up[3], fov_y_deg; };
		double n[ECO_SAMPLE_NUMBERS];
	};
};

struct eco_flight {
	double step_s;               /* sample i is at i * step_s */
	struct eco_sample *samples;  uint32_t count;
	double length_m, smooth_s, moved_m;          /* smoothing took no fix farther than moved_m */
	bool yaw_recorded, pitch_recorded;
	double pitch_deg;            /* taken where none was recorded */
	uint32_t raised, off_ground; double raised_m;        /* samples; by moving */
};

/* At least one sample. A camera without a recorded yaw looks where it goes. */
void eco_flight_make(struct eco_flight *flight, const struct eco_track *track,
	const struct eco_track_options *options);
void eco_flight_free(struct eco_flight *flight);
/* The least and the greatest of its eyes. */
void eco_flight_box(const struct eco_flight *flight, double low[3], double high[3]);
double eco_angle_deg(const double a[3], const double b[3]);

/* Turns and moves it, sets it on the ground, raises it above, and makes it look at a point, in this order. A
 * local track begins at 0, 0. Heights above take-off, and those not recorded, count from the ground there. */
void eco_flight_move(struct eco_flight *flight, const struct eco_track *track,
	const struct eco_track_options *options);

struct eco_script {
	char *text; size_t size;     /* JSON; free */
	double fps, length_s;
	uint32_t keys, frames;
	double error_m, error_deg;   /* the script's spline leaves the flight by no more, at any sample */
};

/* Within 0.05 m (less if the scene is small) and 0.5 degrees (1 if looks are made up), if 8000 keyframes
 * suffice. Fails if they do not suffice to tell from which side the camera turns about. */
enum eco_code eco_script_fit(struct eco_script *script, const struct eco_flight *flight,
	const struct eco_track_options *options, struct eco_error *error);
