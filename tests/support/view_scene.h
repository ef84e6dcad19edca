/* A small scene for tests of the client, and streams of it as a server would write them: a tree with wood,
 * lines, leaves that grow by codes, a point for each, and two cells, one with simple forms too; a bush of
 * textured cut-outs; both planted on a hilly ground, some in a nested placement; a summary. The tree may have
 * an impostor, too.
 *
 *   scene_make(&b, texture, levels);          scene_free(&b)
 *   scene_plan(&b, &view, 1, &plan);          cuts of every kind
 *   store = scene_store(&b, &plan, &error);   what holds that plan, streamed
 *   h = scene_hold(&b); scene_release(&h);    both at once
 *
 * A file's tests share `grove`, which scene_open or scene_open_gl makes and scene_close frees. */
#pragma once

#include "client-min/draw/view_gl.h"
#include "client-min/draw/view_shadow.h"
#include "client-min/view_select.h"
#include "ecofiles/format/wire.h"
#include "tests/support/scene_builder.h"
#include "tests/support/unit_test.h"
#include "tests/support/wire_random.h"

enum { L_WOOD, L_LINES, L_LEAVES, L_POINTS, L_LOW, L_LOW_POINTS, L_HIGH, L_HIGH_POINTS, L_BUSH, L_IMAGE,
	L_TREES, L_BUSHES, L_GROUND, L_SUMMARY, L_SIMPLE, L_IMPOSTOR, L_OUTLINE, L_COUNT };
enum { A_TREE, A_LOW, A_HIGH, A_BUSH, A_COUNT };

/* `texture`: levels of colours and of the outline of the bush, which stay the caller's; NULL: it has none. */
void scene_make(struct scene_builder *b, const struct eco_bytes *const texture[2], uint32_t levels);
/* Gives the tree its impostor, all levels, which is that of another tree of so many leaves. The plan of
 * scene_plan does not draw it. */
void scene_make_impostor(struct scene_builder *b, uint32_t leaves);
struct eco_view scene_view(void);

/* A cut of so many primitives where an anchor is in these bands. */
struct eco_cut scene_rule(uint32_t anchor, uint32_t list, uint32_t first, uint32_t end, float scale,
	uint8_t band_first, uint8_t band_end);
/* Near trees in cells (leaves and points below, simple forms and points above), far ones as points; wood as
 * triangles or lines; half the bushes by share; a nested placement of everything further back; a summary
 * beyond it. `end_share` shortens prefixes. */
void scene_plan(const struct scene_builder *b, const struct eco_view *view, double end_share,
	struct eco_plan *plan);

#define SCENE_RECORD UINT32_MAX
#define SCENE_PLANT (SCENE_RECORD - 1)
/* Frames: SCENE; BUNDLE of plant `a` (SCENE_PLANT), of the record of list `a` (SCENE_RECORD) or of its chunk
 * `b`. */
void scene_frame(struct eco_writer *w, const struct scene_builder *s, enum eco_frame_type type,
	uint32_t *number, uint32_t a, uint32_t b);
/* Chunks of a list that a plan needs. */
uint32_t scene_needs(const struct scene_builder *b, const struct eco_plan *plan, uint32_t id);
/* Everything that `plan` needs and `held` (chunks per list, or NULL) lacks. */
void scene_stream(const struct scene_builder *b, const struct eco_plan *plan, const uint32_t *held,
	struct eco_writer *w);
enum eco_code scene_feed(struct view_store *store, const struct eco_writer *w, struct eco_error *error);
struct view_store *scene_store(const struct scene_builder *b, const struct eco_plan *plan,
	struct eco_error *error);

/* A plan of a view and the store that holds it; `selection` is empty until scene_select. Without one the
 * program ends. */
struct scene_held {
	struct eco_view view;
	struct lod_eye eye;
	struct eco_plan plan;
	struct view_store *store;
	struct view_selection selection;
};
struct scene_held scene_hold_view(const struct scene_builder *b, struct eco_view view, double end_share);
/* From scene_view(), in full. */
struct scene_held scene_hold(const struct scene_builder *b);
void scene_select(struct scene_held *h);
void scene_release(struct scene_held *h);
/* A picture of the selection, lit by its sky: by OpenGL (scene_gl), or in software. The caller frees it. */
struct view_picture scene_draw(const struct scene_held *h, bool by_gl, enum view_tint tint);
/* Shares of all pixels: covered by `a`; of another mask; of another owner or mask; of one owner, but of
 * another depth or colour. Mean differences of bytes, and as people see them (lod_flip). */
struct picture_difference { double covered, masks, owners, depths, colors, bytes, seen; };
struct picture_difference picture_compare(const struct view_picture *a, const struct view_picture *b);
/* As build/tmp/NAME.png, for people. */
void picture_save(const char *name, const struct view_picture *picture);
/* Chunks of each list that a store holds. */
void scene_holdings(const struct view_store *store, uint32_t held[L_COUNT]);

extern struct scene_builder grove;
OWNABLE(view_gl, view_gl_close)
OWNABLE(view_store, view_store_free)
extern struct view_gl *scene_gl;                 /* NULL: there is no OpenGL here */
int scene_open(void **state);
int scene_open_gl(void **state);                 /* with OpenGL for pictures of scene_view */
int scene_close(void **state);

/* Shadow maps by OpenGL and in software. Both maps of a job must have the same heights, but for one texel of
 * 200: OpenGL rounds corners. Returns how many texels are below something. */
size_t shadow_gl_compare(struct view_gl *gl, const struct view_shadow_job *job, const char *name);
