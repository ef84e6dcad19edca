/* Drawing a selection with OpenGL, without a window system.
 *
 *   view_gl_open(&gl, &options, &error);            first hardware device, else Mesa's surfaceless platform
 *   view_gl_draw(gl, &job, &picture, &error);       as often as wanted; what is on the GPU stays there and is
 *                                                   extended, until
 *   view_gl_keep(gl, stores, count);                something of it is held by no store any more
 *   view_gl_close(gl);
 *
 * One pass writes what view_light.h needs; the mask is "owner is not 0", so it cannot depend on shading. No
 * multisampling, depth is near / distance (reversed, infinite far plane), formulas are those of
 * lod/raster/raster.h. One thread. */
#pragma once

#include "client-min/draw/view_light.h"
#include "client-min/draw/view_picture.h"
#include "client-min/view_select.h"

struct view_gl;

struct view_gl_options { uint32_t width, height; };

/* ECO_UNSUPPORTED, with what was tried, if there is no usable OpenGL 4.5. */
enum eco_code view_gl_open(struct view_gl **gl, const struct view_gl_options *options,
	struct eco_error *error);
void view_gl_close(struct view_gl *gl);                          /* NULL is fine */
/* Pictures of another size from now on; all else on the GPU stays. ECO_UNSUPPORTED: nothing can be drawn. */
enum eco_code view_gl_resize(struct view_gl *gl, const struct view_gl_options *options,
	struct eco_error *error);
const char *view_gl_renderer(const struct view_gl *gl);
bool view_gl_hardware(const struct view_gl *gl);
/* bit i: enum view_program i was needed, and compiled */
uint32_t view_gl_programs(const struct view_gl *gl);
/* Compiles, before there is a plan to draw, what draws the lists that are held without leaves. */
enum eco_code view_gl_prepare(struct view_gl *gl, const struct view_store *store, struct eco_error *error);

/* After chunks have gone from a store: frees what is on the GPU of lists that none of these holds. */
void view_gl_keep(struct view_gl *gl, const struct view_store *const *stores, uint32_t count);
uint64_t view_gl_bytes(const struct view_gl *gl);                /* of records on the GPU */

/* `picture` has the size of the target. picture->vertices is summed at the draw calls. */
enum eco_code view_gl_draw(struct view_gl *gl, const struct view_draw_job *job, struct view_picture *picture,
	struct eco_error *error);

/* Its parts, for light on the GPU (web/web_light.h): records what each pixel shows, which stays in textures
 * until the next picture or size; reads that, own colours and no light, into `picture`. The first sample of a
 * picture (lod_eye_sample) stays while others are recorded; `sample` 0 is that one, any other number the one
 * that was recorded last. */
enum eco_code view_gl_record(struct view_gl *gl, const struct view_draw_job *job,
	struct view_picture *picture, struct eco_error *error);
/* Records cuts from *cut on, 0 at first, until there are `most` vertices more; at the selection's cut_count
 * all is there. Nothing else may be recorded meanwhile. */
enum eco_code view_gl_record_part(struct view_gl *gl, const struct view_draw_job *job, uint64_t most,
	uint32_t *cut, struct view_picture *picture, struct eco_error *error);
enum eco_code view_gl_read(struct view_gl *gl, uint32_t sample, struct view_picture *picture,
	struct eco_error *error);
/* A texture of four words a pixel (RGBA32UI), 0 where nothing is:
 *   0  1 + the number of the instance that is seen; 0: the ground; of a summary's point, bits 30..61 of its
 *      owner
 *   1  its surface, as view_light.h has it; the upper byte is VIEW_GL_SUMMARY where it is a summary's point
 *   2  1 / distance, a float
 *   3  its own colour, r | g << 8 | b << 16; the upper byte means nothing */
unsigned view_gl_target(const struct view_gl *gl, uint32_t sample);
#define VIEW_GL_SUMMARY 0x81u            /* a cloud, and bit 24 */

/* A shadow map (view_shadow.h), for who lights pictures on the GPU: its programs are compiled when something
 * first needs them. */
struct view_gl_map {
	const struct view_store *store;
	const struct view_selection *casters;
	const struct lod_eye *eye;
	unsigned framebuffer;            /* size x size depths of floats, which VIEW_SHADOW_DEPTH makes */
	unsigned rows;                   /* a texture of four texels of four words: view_shadow.row */
	uint32_t size;
};
enum eco_code view_gl_cast(struct view_gl *gl, const struct view_gl_map *map, struct eco_error *error);
