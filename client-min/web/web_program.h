/* Programs whose fragments are those of one triangle that covers the viewport. */
#ifndef WEB_PROGRAM_H
#define WEB_PROGRAM_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

/* GLSL: whether what is seen (view_gl_target) is a point of a summary. */
#define WEB_IS_SUMMARY "bool is_summary(uvec4 seen) { return seen.y >> 24 == 129u; }\n"

/* GLSL: what the texts that C compiles, too, are written in, but for what each of them says itself. */
#define WEB_LANGUAGE \
	"#define LIGHT\n" \
	"#define real float\n" \
	"vec3 add(vec3 a, vec3 b) { return a + b; }\n" \
	"vec3 scale(vec3 a, float t) { return a * t; }\n" \
	"vec3 times(vec3 a, vec3 b) { return a * b; }\n" \
	"vec3 blend(vec3 a, vec3 b, float t) { return mix(a, b, t); }\n" \
	"vec3 unit(vec3 a) { return a / max(length(a), 1e-20); }\n"

/* A program of a fragment shader in parts, after its version and precisions; `v_at` is the place in a picture
 * whose first row is the top, [0, 1]. vertex: NULL, or the text of `void more()`, which sets more of a vertex
 * whose gl_Position is set. 0, with *error: the driver refuses it. */
unsigned web_program(const char *vertex, const char *const *parts, int count, const char *what,
	struct eco_error *error);
/* A texture that the program in use reads by that name. */
void web_program_texture(unsigned program, const char *name, int unit, unsigned texture);
/* viewport: x, y, width, height */
void web_program_fill(unsigned vertex_array, const int viewport[4]);

/* ---- A lit picture in the page ---- */

/* A lit picture, put into what the page's context draws to: colours, and depths that hide what the page draws
 * itself, and are hidden by it. */
struct web_present { unsigned program, vertex_array; };          /* zero is empty */

/* The page's depth of a pixel is depth[0] + depth[1] / distance, in [0, 1]; where nothing is, the sky, it is
 * 1, and without `sky` nothing is drawn there, nor without `ground` where no plant is. Into the framebuffer
 * that is bound, all of `viewport`: x, y, width, height. */
struct web_place { float depth[2]; int viewport[4]; bool sky, ground; };
/* Compiles what drawing needs, which that else does itself. */
enum eco_code web_present_prepare(struct web_present *present, struct eco_error *error);
/* Textures: colours (web_light.h), and what was recorded (view_gl_target). */
enum eco_code web_present_draw(struct web_present *present, unsigned lit, unsigned seen,
	const struct web_place *place, struct eco_error *error);
void web_present_free(struct web_present *present);

#endif
