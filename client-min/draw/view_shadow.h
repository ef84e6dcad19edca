/* Shadow maps: for a grid of sunbeams, how far towards the sun the first thing reaches that a beam meets.
 *
 *   view_shadow_make(&shadow, &job, &error);        once a picture, when its depths are known
 *   lit = view_shadow_lit(&shadow, to, normal, &texel_m);      at each pixel
 *   view_shadow_free(&shadow);
 *
 * The sun is so far away that a beam is a point of the plane across it. Every map, whatever its perspective,
 * is then a projective map of that plane: a texel is (U, V) / W, where U, V and W are linear in space and
 * constant along a beam; height is in metres along it. The standard map has W = 1: texels of one size. The
 * perspective one is that of Stamminger and Drettakis 2002 (Perspective shadow maps): what a camera sees that
 * stands where the sun is in the eye's space after perspective, and looks at the middle of that cube. Its
 * singular cases, and what becomes of them here:
 *
 *   the sun behind the eye        There the sun becomes a sink, and depths change their order. Heights along
 *                                 beams keep theirs.
 *   casters behind the eye        There they have no picture, and the eye is moved back until they have.
 *                                 Here they lie on the beams of what they darken, where W is positive.
 *   the sun along the view        The map becomes the standard one, as in the paper: nothing is to be gained.
 *   the sun beside the cube       W would reach 0 in what is seen. As much of a map of texels of one size is
 *                                 added as keeps them within a factor of SPREAD (view_shadow.c).
 *   the near plane                It decides how many texels what is near gets. It is that of the picture,
 *                                 pulled back by a part of the root of nearest times farthest, after Wimmer
 *                                 et al. 2004 (Light space perspective shadow maps).
 *
 * Both kinds are fitted to the pixels of the picture, in cells of which the nearest and the farthest count,
 * so that few texels lie where nothing is seen. Nothing is fetched: what casts is what is held. The ground
 * casts no shadow. The place of a map and the look-up in it are one text for C and GLSL (view_shadow.glsl).
 * Casters are drawn in software (view_shadow_cast.c), so that it is the same for every engine of ecoview; in
 * a browser, where no pixel is read, by OpenGL (view_gl_cast). */
#pragma once

#include "client-min/draw/view_picture.h"
#include "client-min/view_select.h"

#define VIEW_SHADOW_CELLS 32             /* of a picture, across and down */
#define VIEW_SHADOW_LOWEST 0.02f         /* of the sun: lower it gives no light that is worth a shadow */
#define VIEW_SHADOW_LEAST_W 1e-4f        /* of what is drawn; the least where something is seen is 1 */

/* GLSL: a height towards the sun as a depth of a map that OpenGL draws, in (0, 1); 0 is nothing. */
#define VIEW_SHADOW_DEPTH \
	"float shadow_depth(float height) { return 0.5 + 0.5 * height / (abs(height) + 64.0); }\n"

struct view_shadow_job {
	const struct view_store *store;
	const struct view_selection *casters;    /* view_select_casters */
	const struct lod_eye *eye;
	const struct view_picture *picture;      /* drawn; lit or not */
	float sun[3];                            /* towards it, unit length */
	enum view_shadows kind;                  /* not NONE */
	uint32_t size;                           /* texels a side, VIEW_SHADOW_SIZE_MIN to _MAX */
	uint32_t threads;                        /* 0: 2 */
};

struct view_shadow {                     /* owns `top`; zero is empty */
	uint32_t size;
	/* U, V and W of texels, metres towards the sun: of (x, y, z, 1), the world's axes from the eye */
	float row[4][4];
	float *top;                      /* size * size; -INFINITY: nothing. NULL: no map, all is lit */
};

/* Without casters, pixels of plants or ground, or a sun above the horizon there is no map. */
enum eco_code view_shadow_make(struct view_shadow *shadow, const struct view_shadow_job *job,
	struct eco_error *error);
void view_shadow_free(struct view_shadow *shadow);

/* Position in the map, in texels, of a place (from the eye, world's axes); false: beyond its edges. */
bool view_shadow_place(const struct view_shadow *shadow, const float to[3], float texel[2]);
/* Share of sunlight that arrives at a place of a surface, the mean of 3 x 3 texels; NULL: of all directions.
 * -1: beyond the map. *texel_m: how large a texel is there. */
float view_shadow_lit(const struct view_shadow *shadow, const float to[3], const float normal[3],
	float *texel_m);

/* Texels of the map for each pixel across, where the ground is nearest to the eye: the median over the
 * nearest tenth of its pixels; below 1 their edges are steps. NaN: there is no ground, or no map. */
double view_shadow_sharpness(const struct view_shadow *shadow, const struct view_picture *picture,
	const struct lod_eye *eye);

/* In view_shadow_cast.c: raises shadow->top, which has been made, to all that the job's casters reach:
 * triangles, with what their textures cut out, lines, points, splats and impostors. */
enum eco_code view_shadow_cast(struct view_shadow *shadow, const struct view_shadow_job *job,
	struct eco_error *error);
