/* A view and a request. World coordinates: metres from the scene's origin, right-handed, Z up, z absolute. */
#pragma once

#include <stddef.h>
#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

#define ECO_IMAGE_MAX 16384u
#define ECO_VERTICES_MAX ((uint64_t)INT64_MAX)
#define ECO_BYTES_UNBOUNDED UINT64_MAX

/* Beyond it pixels are so narrow, or wide, that floats overflow. */
#define ECO_FOV_LEAST_DEG 1e-9

struct eco_view {
	double eye[3], target[3], up[3];
	double fov_y_deg;            /* ECO_FOV_LEAST_DEG to 180 less that */
	uint32_t width, height;      /* pixels, 1..ECO_IMAGE_MAX */
};

/* The default. Measured: see lod/ground_choice.h. */
#define ECO_GROUND_PX 1.0
#define ECO_GROUND_PX_MIN 0.01       /* indistinguishable from full detail */
#define ECO_GROUND_PX_MAX 65536.0

/* The default. Measured: lod/EXPERIMENTS.md, Textures. */
#define ECO_TEXEL_PX 0.03125
#define ECO_TEXEL_PX_MIN 1e-6        /* every texture whole */
#define ECO_TEXEL_PX_MAX 65536.0

/* The same of the image on the ground: the default, and the least, as a picture shows no more. */
#define ECO_GROUND_TEXEL_PX 1.0
#define ECO_GROUND_TEXEL_PX_MIN 0.25

/* From here on fetching a chunk by a request of its own costs little beside its bytes. */
#define ECO_NAME_FROM 1024u

struct eco_request {
	struct eco_view view;
	uint64_t vertices;           /* budget, 0..ECO_VERTICES_MAX; the greatest, with unbounded bytes, asks for
	                              * full detail */
	/* budget of the whole response and of what it names, or ECO_BYTES_UNBOUNDED */
	uint64_t bytes;
	double ground_px;            /* greatest error of the ground, _PX_MIN.._PX_MAX; 0: ECO_GROUND_PX */
	/* greatest width of a texture's texels where it has finer, _PX_MIN.._PX_MAX; 0: ECO_TEXEL_PX,
	 * and ECO_GROUND_TEXEL_PX for the ground's image */
	double texel_px;
	/* chunks of at least so many bytes are named by the answer, not carried; 0: none */
	uint64_t name_from;
	/* where the eye will soon be: what that needs comes after the answer, in what is left of the bytes */
	struct { bool given; double eye[3], target[3]; } next;
};

/* The view at request->next, which is given. */
struct eco_view eco_view_next(const struct eco_request *request);

/* Whether `now`, a view after that of the request, which told a next one, is on its way elsewhere: it looks
 * away from that more than the request's view did, by a quarter of the field of view, or is farther from it
 * by a quarter of the way. */
bool eco_view_turned(const struct eco_request *request, const struct eco_view *now);

/* Moves eye and target to the nearest points of a grid of `step_m` in the scene's frame: each by at most
 * step_m * sqrt(3) / 2. Views that are nearly alike are then the same, and so is their request: one plan
 * answers all of them, from a server's kept answers or any cache before it. Where eye and target would meet,
 * or step_m is 0, the view stays as it is. */
void eco_view_snap(struct eco_view *view, double step_m);
/* The same of the request's view and of its next one. */
void eco_request_snap(struct eco_request *request, double step_m);

/* Refuses views that cannot be drawn: values not finite or beyond 1e12, eye = target, field of view
 * outside (0,180), sizes. `up` parallel to the view direction is accepted (another up is chosen). The text
 * names the field. */
enum eco_code eco_view_check(const struct eco_view *view, struct eco_error *error);

/* Camera scripts: {"fps": 2, "above_ground": false, "keyframes": [{"time_s": 0, "eye": [..], "target": [..],
 * "up": [..], "fov_y_deg": 45}, ...]}. All fields are required but above_ground, which is false then, and
 * up, [0, 0, 1]; fps in [0.001, 1000]; times strictly ascending. Frames at keyframe 0's time + i/fps up to
 * the last keyframe (inclusive, to rounding), at most a million. Between keyframes: monotone-time cubic
 * Hermite (Catmull-Rom with the actual time steps) on every number; one keyframe is one frame. A script that
 * parses gives only frames that pass eco_view_check (but for their size); errors have line and column. */
struct eco_camera;
enum eco_code eco_camera_load(struct eco_camera **camera, const char *path, struct eco_error *error);
enum eco_code eco_camera_parse(struct eco_camera **camera, const char *json, size_t size, const char *name,
	struct eco_error *error);
uint32_t eco_camera_frame_count(const struct eco_camera *camera);
uint32_t eco_camera_key_count(const struct eco_camera *camera);
/* Whether the z of eye and target count from the ground below each of them, in every frame anew, and not from
 * the scene's origin. The drawing client knows the ground: client-min/view_ask.h. */
bool eco_camera_above_ground(const struct eco_camera *camera);
/* returns time_s; leaves size */
double eco_camera_frame(const struct eco_camera *camera, uint32_t frame, struct eco_view *view);
double eco_camera_key(const struct eco_camera *camera, uint32_t key, struct eco_view *view);
/* Gives a request for a frame the view of the first frame that is at least `seconds` later, or of the last
 * one; none if it is the last one itself. */
void eco_camera_ahead(const struct eco_camera *camera, uint32_t frame, double seconds,
	struct eco_request *request);
void eco_camera_free(struct eco_camera *camera);
