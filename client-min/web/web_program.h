/* Programs whose fragments are those of one triangle that covers the viewport. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "client-min/draw/view_gl.h"

/* A program of a fragment shader in parts, after its version, precisions and web_common.glsl; `v_at` is the place
 * in a picture whose first row is the top, [0, 1]. vertex: NULL, or the text of `void more()`, which sets more of
 * a vertex whose gl_Position is set. 0, with *error: the driver refuses it. */
unsigned web_program(const char *vertex, const char *const *parts, int count, const char *what,
	struct eco_error *error);
/* A texture that the program in use reads by that name. */
void web_program_texture(unsigned program, const char *name, int unit, unsigned texture);
/* viewport: x, y, width, height */
void web_program_fill(unsigned vertex_array, const int viewport[4]);

/* ---- Shadow maps on the GPU: as view_shadow.h has them, by the same text (draw/view_shadow.glsl), from what
 * view_gl_record has left in textures, without reading a pixel.
 *
 *   web_shadow_draw(&shadow, gl, &job, size, &error);       once a picture
 *   web_shadow_set(&shadow, program, unit, eye);            web_light.glsl with SHADOW
 *   web_shadow_free(&shadow);
 *
 * The picture becomes cells, these become the map's rows, and casters are drawn by them. Nothing is made,
 * nor compiled, before the first picture with shadows
 * that does not keep the map of an earlier one; where the driver refuses, that fails once, and
 * pictures have none from then on. */

enum web_shadow_part { WEB_SHADOW_CELLS, WEB_SHADOW_ROWS, WEB_SHADOW_TOPS, WEB_SHADOW_PARTS };
struct web_shadow {                      /* zero is empty */
	unsigned programs[WEB_SHADOW_TOPS], textures[WEB_SHADOW_PARTS], framebuffers[WEB_SHADOW_PARTS];
	unsigned vertex_array;
	uint32_t size;                   /* texels a side of the map */
	bool refused;                    /* the driver does not compile what they need */
	/* set by who draws: no map is made, that of an earlier picture is used, if its sun and kind are the same */
	bool keeps;
	struct view_sky of;              /* the map's, once there is one; from where its places are told */
	double eye[3];
};

/* Whether a picture has any: they are asked for and can be had, something casts them, the sun is high enough. */
bool web_shadow_wanted(const struct web_shadow *shadow, const struct view_selection *selection);
/* The map of the picture of that width and height that gl has recorded, of the job's selection. */
enum eco_code web_shadow_draw(struct web_shadow *shadow, struct view_gl *gl, const struct view_draw_job *job,
	const uint32_t picture[2], struct eco_error *error);
void web_shadow_free(struct web_shadow *shadow);

/* Sets the uniforms of web_light.glsl's SHADOW in the program that is in use; takes texture units `unit` and the next. */
void web_shadow_set(const struct web_shadow *shadow, unsigned program, int unit, const double eye[3]);
