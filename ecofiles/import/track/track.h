/* Recorded tracks: where a camera, a drone, a glider or a walker was, as files of other programs have it, made into a camera script.
 *
 *   eco_track_read(&track, path, &options, &error);          any format -> fixes, as recorded          track_*.c, one a format
 *   eco_track_place(&track, &frame, &error);                 degrees -> metres                         track_place.c
 *   eco_track_clean(&track, &cleaning, &report, &error);     stamps, jumps, repeats; one part is kept  track_clean.c
 *   eco_flight_make(&flight, &track, &smoothing, &error);    even, smooth motion                       track_flight.c
 *   eco_flight_move(&flight, &move, &ground, ...);           to where the scene is                     track_move.c
 *   eco_script_fit(&script, &flight, &fitting, &error);      the fewest keyframes that keep to it      track_script.c
 *   eco_script_text(&script, &size);                         CAMERA.json (ecofiles/format/view.h)
 *
 * A position and its look are recorded at rates of their own (a GPS with 5 fixes a second in a film with 60 frames), so they are two
 * series until a flight samples both evenly. Angles are a drone's: yaw clockwise from north (+Y), pitch up from the horizon, roll to
 * the right; NaN is what was not recorded, everywhere. Nothing is repaired in silence: each repair has a counter or a note. */
#ifndef ECO_TRACK_H
#define ECO_TRACK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/import/ground/ground.h"
#include "ecofiles/base/status.h"

#define ECO_TRACK_BYTES_MAX (1u << 30)
#define ECO_TRACK_FIXES_MAX (1u << 24)
#define ECO_TRACK_NOTES_MAX 24u
#define ECO_TRACK_NOTE_BYTES 300u

/* ---- As recorded ---- */

enum eco_track_format {
	ECO_TRACK_SRT,               /* subtitles of a drone's film */
	ECO_TRACK_GPX, ECO_TRACK_KML, ECO_TRACK_GEOJSON,     /* through GDAL, which opens the file itself */
	ECO_TRACK_CSV, ECO_TRACK_GLTF,
	ECO_TRACK_SCRIPT,            /* a camera script of our own: no fixes, to be taken as it is */
	ECO_TRACK_FORMATS
};
/* name: what an option calls it; says: for people. */
struct eco_track_kind { const char *name, *says; };
extern const struct eco_track_kind eco_track_kinds[ECO_TRACK_FORMATS];

struct eco_fix {
	double time_s;               /* since 1970 where the file has dates, else since a zero of its own; NaN */
	double at[3];                /* degrees east and north and metres, or metres (x, y, z); NaN only at[2] */
	double above_m;              /* height above take-off; NaN */
	double yaw_deg, pitch_deg, roll_deg, fov_y_deg;      /* each may be NaN */
	uint32_t line;               /* of the file, or number of the record, from 1 */
	uint32_t segment;            /* of the file; fixes of one segment were recorded in one go */
};

enum eco_track_skip {            /* records without a fix, by reason */
	ECO_TRACK_NO_POSITION,       /* none, "n/a", 0/0 before the GPS knew */
	ECO_TRACK_BAD_NUMBER,        /* a coordinate that is no number, or impossible */
	ECO_TRACK_SKIPS
};
extern const char *const eco_track_skip_names[ECO_TRACK_SKIPS];

struct eco_track {
	enum eco_track_format format;
	unsigned degrees : 1;        /* at[0], at[1] are degrees east and north, WGS 84 */
	unsigned timed : 1;          /* some fixes have a time */
	unsigned posed : 1;          /* looks are exact (poses of a camera), so nothing is smoothed unless asked for */
	unsigned has_home : 1;       /* take-off, as at[]; z may be NaN */
	double home[3];
	double still_m;              /* the step in which positions were written (rounding); 0: too small to matter; set by placing */
	double still_z_m;
	struct eco_fix *fixes;       uint32_t count;
	uint64_t records, skipped[ECO_TRACK_SKIPS];
	uint32_t skipped_line[ECO_TRACK_SKIPS];      /* the first */
	char notes[ECO_TRACK_NOTES_MAX][ECO_TRACK_NOTE_BYTES];       uint32_t note_count;
};

enum eco_axes { ECO_AXES_DEFAULT, ECO_AXES_OPENGL, ECO_AXES_OPENCV, ECO_AXES_ROS };
enum eco_world { ECO_WORLD_DEFAULT, ECO_WORLD_Z, ECO_WORLD_Y, ECO_WORLD_MINUS_Y };

struct eco_track_options {       /* zero: all defaults */
	const char *format;          /* name of a kind; NULL: found by content, then by extension */
	const char *columns;         /* of a CSV: "t=GPS Time,lon=X,lat=Y,alt=Z:ft,yaw=3": names or numbers from 1, a unit behind ':' */
	bool latitude_first;         /* GPS(a, b) and columns without names are latitude, longitude */
	bool yaw_from_x;             /* CSV: yaw is counter-clockwise from +X */
	enum eco_axes axes;          /* of the camera in poses; default: glTF's, and OpenCV's (z ahead, y down) for quaternions of a CSV */
	enum eco_world world;        /* which axis of poses points up */
	const char *node;            /* glTF: name of the camera or its node; NULL: the first */
};

/* Reads a file in a child process with limits (guard.h). A file without a usable fix is an error that says what was found instead.
 * format ECO_TRACK_SCRIPT: nothing else is set. Free with eco_track_free, which takes a zeroed one too. */
enum eco_code eco_track_read(struct eco_track *track, const char *path, const struct eco_track_options *options, struct eco_error *error);
/* The same from memory, in this process. Files that a glTF names are looked for beside `path`; GDAL opens `path` itself. */
enum eco_code eco_track_parse(struct eco_track *track, const uint8_t *bytes, size_t size, const char *path,
	const struct eco_track_options *options, struct eco_error *error);
void eco_track_free(struct eco_track *track);

/* A sentence for the user; beyond ECO_TRACK_NOTES_MAX the last says that there are more. */
void eco_track_note(struct eco_track *track, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* ---- In metres ---- */

struct eco_track_frame {
	const char *crs;             /* to; NULL: metres east and north of the track's middle (or of its own zero, where it is in metres) */
	double origin[3];            /* of the scene, in crs */
	const char *track_crs;       /* of fixes that are metres; NULL: they are metres from the origin. Degrees are WGS 84 */
	bool local;                  /* about the track's middle, whatever `crs` says: it will be moved */
};

/* at[] becomes metres from the origin, yaw counts from the frame's north (which is not true north); still_m is found. Errors: a CRS that
 * is not known, not projected or not in metres; no fix that it holds. */
enum eco_code eco_track_place(struct eco_track *track, const struct eco_track_frame *frame, struct eco_error *error);

/* ---- Clean ---- */

enum eco_track_height {
	ECO_HEIGHTS_DEFAULT,         /* above take-off if recorded, else absolute */
	ECO_HEIGHTS_ABSOLUTE, ECO_HEIGHTS_RELATIVE,
	ECO_HEIGHTS_GROUND           /* what is recorded (relative if it is) counts from the ground below */
};

struct eco_cleaning {
	enum eco_track_height height;
	uint32_t part;               /* 1..; 0: the longest */
	double pace_m_s;             /* of tracks without any time; 0: 10 */
	double pause_s;              /* a longer stand is shortened to it; 0: 60 */
};

struct eco_track_report {
	uint64_t fixes;              /* before cleaning; kept + everything below */
	uint64_t kept, repeated, jumped, other_parts;
	/* repairs of what was kept */
	uint64_t stamps_missing, stamps_bogus, stamps_equal, stamps_backward, sorted, clock_resets, heights_missing, pauses, glides;
	bool reversed, untimed;
	double paused_s, update_s;   /* seconds left out; median time between different positions */
	double jump_m, jump_m_s;     /* the farthest that was taken for a jump */
	uint32_t parts, part;        /* part: the one taken, from 1 */
	enum eco_track_height height;        /* what was taken */
	bool has_height;
};

/* In this order: stamps that cannot be (years from the others) are forgotten; a file written backwards is turned; stamps that run back
 * are forgotten if few, sorted if the file is unsorted, else the clock was set back and goes on; equal stamps are spread; unknown ones
 * are interpolated. A step much faster than the track's own speeds (and its recordings' rounding) is a jump: the fixes beyond are
 * dropped if the track comes back within a few; a short one gets time to be glided over; else the track is split into parts.
 * Repeated positions become one, two where the camera stands. at[2] becomes the height asked for, missing ones interpolated. Times
 * then count from 0 and ascend. Errors: no such part; nothing left. track->home goes along. */
enum eco_code eco_track_clean(struct eco_track *track, const struct eco_cleaning *cleaning, struct eco_track_report *report,
	struct eco_error *error);

/* ---- Smooth ---- */

/* look and up: units, at right angles; all of it as numbers, for what treats them alike */
#define ECO_SAMPLE_NUMBERS 10
struct eco_sample { union { struct { double eye[3], look[3], up[3], fov_y_deg; }; double n[ECO_SAMPLE_NUMBERS]; }; };

struct eco_flight {
	double step_s;               /* sample i is at i * step_s */
	struct eco_sample *samples;  uint32_t count;
	double length_m, smooth_s, moved_m;          /* smoothing took no fix farther than moved_m */
	bool yaw_recorded, pitch_recorded;
	double pitch_deg;            /* taken where none was recorded */
};

struct eco_smoothing {
	double smooth_s;             /* standard deviation of the filter; NaN: by the rounding, rate and speed of the track */
	double pitch_deg;            /* NaN: level, or a little down if the track flies */
	bool pitch_given_wins;       /* pitch_deg replaces what was recorded */
	double fov_y_deg;            /* NaN: as recorded, else 60 */
	bool flies;
};

/* At least one sample. Where no yaw was recorded, the camera looks where it goes; where it stands, as before and after. */
enum eco_code eco_flight_make(struct eco_flight *flight, const struct eco_track *track, const struct eco_smoothing *smoothing,
	struct eco_error *error);
void eco_flight_free(struct eco_flight *flight);
/* The least and the greatest of its eyes. */
void eco_flight_box(const struct eco_flight *flight, double low[3], double high[3]);
double eco_distance(const double a[3], const double b[3]);
double eco_angle_deg(const double a[3], const double b[3]);

/* ---- Move ---- */

struct eco_flight_move {
	double from_s, to_s;         /* of the flight; NaN: its ends */
	double speed, scale;         /* 0: 1 */
	double turn_deg;             /* counter-clockwise, about the first eye (or the centre) */
	bool to_given, centre;       /* the first eye, or the centre of the flight's box, goes to `to` */
	double to[3];                /* z NaN: heights stay */
	bool from_ground;            /* eyes' heights count from the ground */
	const struct eco_ground *ground;     /* NULL: the ground is z = 0 */
	bool has_ground;             /* eyes stay above it */
	double clearance_m;
	bool look_at_given; double look_at[3];
};
struct eco_flight_moved { uint32_t raised; double raised_m; uint32_t off_ground; };

/* In this order: cut, turned and scaled, moved, set on the ground, raised above it, made to look at. Errors: nothing left of it. */
enum eco_code eco_flight_move(struct eco_flight *flight, const struct eco_flight_move *move, struct eco_flight_moved *moved,
	struct eco_error *error);

/* ---- Script ---- */

struct eco_key { double time_s, eye[3], target[3], up[3], fov_y_deg; };

struct eco_script {
	double fps;
	struct eco_key *keys;        uint32_t count;
	uint32_t frames;
	double error_m, error_deg;   /* the script's spline leaves the flight by no more, at any sample */
};

struct eco_fitting {
	double fps;                  /* 0: 30, or less if that were more than ECO_SCRIPT_FRAMES frames */
	uint32_t keys_max;           /* 0: 8000 */
	double error_m, error_deg;   /* wanted; 0: 0.05 m, less if the scene is small; 0.5 degrees, 1 if looks are made up */
};
#define ECO_SCRIPT_FRAMES 20000u

enum eco_code eco_script_fit(struct eco_script *script, const struct eco_flight *flight, const struct eco_fitting *fitting,
	struct eco_error *error);
/* JSON text, malloc'ed; NULL without memory. */
char *eco_script_text(const struct eco_script *script, size_t *size);
void eco_script_free(struct eco_script *script);

#endif
