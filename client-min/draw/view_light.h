/* Light: from what is seen in each pixel (its own colour, its surface, its depth, its owner) to the colours
 * of a picture. All that draws, OpenGL and software, ends here, so that a plan looks the same in every
 * program that draws it.
 *
 * A sun and a sky. A leaf reflects on its lit side and lets light through on the other, always seen from the
 * visible side; a crown shades itself towards its dark side and its inside. A point or line stands for leaves
 * of every direction, so it gets the mean of the same expressions over directions, and a plant keeps its tone
 * when its representation changes; a summary's point, which does not know where in a crown it is, gets the
 * mean over a crown as well, and so does a point as large as a crown (lod/EXPERIMENTS.md, Normals of
 * summaries). Sun, haze and shadow maps are those of the selection's view_sky. Masks and scores know
 * nothing of it.
 *
 * Only +, -, *, / and square roots of floats in a fixed order: the same pixels give the same bytes
 * everywhere. */
#pragma once

#include <signal.h>

#include "client-min/draw/view_picture.h"
#include "client-min/view_select.h"

/* A pixel's surface, in plant space (the ground's is the world's), as 32 bits; the vertex shaders in
 * view_shader.c write the same:
 *
 *   30..31   0 facet, 1 axis (what is round about it: blades, bark), 2 cloud (leaves of all directions),
 *            3 ball (leaves around a middle: on their sunny side they are lit more)
 *    0..29   facet, axis: direction, either way, as an octahedron's x and y: 15 bits each, [-1, 1]
 *            ball: the same with 10 bits each; 20..24 its radius over half the width of its plant, at most 1 (31),
 *            25..29 the share of leaves that lie level (30: all), or 31: one of its leaves, whose direction it is
 *            cloud: 0..15 half its side over half the width of its plant, at most 1 (65535), 16..23 the share
 *            of leaves that lie level (255: all), 24 its summary's (view_gl.h), 25 what it stands for is behind it */
enum view_surface { VIEW_FACET, VIEW_AXIS, VIEW_CLOUD, VIEW_BALL };
/* The direction may have any length; a cloud has none. */
uint32_t view_surface_direction(enum view_surface kind, const float direction[3]);
uint32_t view_surface_ball(double reach, double level, const float direction[3]);
uint32_t view_surface_leaf(double reach, const float direction[3]);
uint32_t view_surface_cloud(double reach, double level);
#define VIEW_NEAR_SIDE (1u << 25)

/* By representation; or in their own colours without light, before a gray ground and a black sky. */
enum view_tint { VIEW_TINT_NONE, VIEW_TINT_KIND, VIEW_TINT_OWN };
#define VIEW_OWN_GROUND 96               /* sRGB */
extern const uint8_t view_tint_colors[VIEW_ROLE_COUNT][3];       /* sRGB, for VIEW_TINT_KIND */

struct view_draw_job {                   /* of drawing by OpenGL or in software, and of light */
	const struct view_store *store;
	const struct view_selection *selection;
	const struct lod_eye *eye;
	double near_m;
	uint32_t threads;                        /* 0: 2 */
	const volatile sig_atomic_t *stop;       /* software: not 0: end with ECO_INTERRUPTED; may be NULL */
	enum view_tint tint;
	uint32_t samples;                        /* of each pixel's colour, 1 to LOD_SAMPLES_MAX; 0: 1 */
	bool smooth;                             /* no leaves on splats and points (lod/leaf.h) */
};

/* Light of the pictures of one view: the sun, and the shadows that `first`, drawn by the job, needs. */
struct view_lamp;
enum eco_code view_lamp_make(struct view_lamp **lamp, const struct view_draw_job *job,
	struct view_picture *first, struct eco_error *error);
/* Replaces the own colours in picture->rgb, drawn from `eye`, by what is seen. The ground needs none: it has
 * its own. By several threads (view_thread_count); others may use the lamp. */
void view_lamp_light(const struct view_lamp *lamp, const struct lod_eye *eye, struct view_picture *picture,
	uint32_t threads);
void view_lamp_free(struct view_lamp *lamp);                     /* NULL is fine */

/* record draws own colours, surfaces, depths and owners of a picture, without light. */
typedef enum eco_code view_record(void *ctx, const struct view_draw_job *job, struct view_picture *picture,
	struct eco_error *error);
/* Draws and lights the job's samples. Colours are the mean of their light, all else is that of the first. */
enum eco_code view_light_samples(const struct view_draw_job *job, view_record *record, void *ctx,
	struct view_picture *picture, struct eco_error *error);

/* Inputs of the same light on the GPU, where view_light.glsl is a part of a shader (web/web_light.h):
 * sunlight with its haze, plants, and where the octaves of the ground's noise have a place of the ground. */
struct view_light_sun { float to[3], color[3], sky[3], earth[3], day, glow, haze_m; };
void view_light_sun(const struct view_sky *sky, double eye_z, struct view_light_sun *out);
struct view_light_plant { float sine, cosine, center_z, half_width, half_height, tone; };
/* instance: NULL for a point of a summary. */
void view_light_plant(const struct view_store *store, const struct view_instance *instance, uint64_t owner,
	struct view_light_plant *out);
#define VIEW_OCTAVES 6
/* Linear in `at`, metres from the ground's origin. */
void view_light_octave(int which, const double at[2], double out[2]);

/* ---- Shapes, and shadows without a map ---- */

/* A plant for shading, in plant space. */
struct view_shape { float center_z, half_width, half_height; };          /* plant space, metres */
struct view_shape view_shape_of(const struct view_plant *plant);

/* Without a shadow map: soft discs thrown along the sun's direction into a map over the part of the scene
 * that is near. Pictures only; masks and scores know nothing of it. */
#define VIEW_SHADE_PIXELS 1024
struct view_shade {
	double low[2], size_m;           /* a square of the world */
	uint8_t *texels;                 /* 2 per pixel: sunlight taken, skylight taken; row 0 is the south */
};
enum eco_code view_shade_make(struct view_shade *shade, const struct view_store *store,
	const struct view_selection *selection, struct eco_error *error);
/* Shares of sunlight and skylight taken at a place, bilinear; none outside the square, or without texels. */
void view_shade_at(const struct view_shade *shade, const double world[2], float taken[2]);
void view_shade_free(struct view_shade *shade);

/* Metres after which haze hides all but 1/e, where it is `sea_m` at z = 0: air thins with height, so from far
 * above all of it is looked through within the last kilometres. */
double view_shade_haze_m(double sea_m, double eye_z);
