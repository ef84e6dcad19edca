/* Programs whose fragments are those of one triangle that covers the viewport. */
#ifndef WEB_PROGRAM_H
#define WEB_PROGRAM_H

#include <stdbool.h>
#include <stdint.h>

#include "client-min/draw/view_gl.h"

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

/* GLSL: light of sRGB colours, in [0, 1], and sRGB colours of light. */
#define WEB_SRGB \
	"vec3 light_of_bytes(vec3 c) {\n" \
	"	return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c));\n" \
	"}\n" \
	"vec3 bytes_of_light(vec3 c) {\n" \
	"	return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));\n" \
	"}\n"

/* A program of a fragment shader in parts, after its version and precisions; `v_at` is the place in a picture
 * whose first row is the top, [0, 1]. vertex: NULL, or the text of `void more()`, which sets more of a vertex
 * whose gl_Position is set. 0, with *error: the driver refuses it. */
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
 *   web_shadow_set(&shadow, program, unit, eye);            a program with web_shadow_text
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

/* For fragment shaders: vec2 cast_at(vec3 to, vec3 n, bool facet), the share of sunlight that arrives at a
 * place from the eye, -1 beyond the map, and how large a texel is there. facet: the surface has that one
 * normal. */
extern const char web_shadow_text[];
/* Sets its uniforms in the program that is in use; takes texture units `unit` and the next. */
void web_shadow_set(const struct web_shadow *shadow, unsigned program, int unit, const double eye[3]);

#endif
