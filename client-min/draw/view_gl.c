/* Longer than 600 lines: uploads, passes and shadow maps all work on struct view_gl, which no other file sees. */
#include "client-min/draw/view_gl.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/draw/view_context.h"
#include "client-min/draw/view_gpu.h"
#include "client-min/view_record.h"
#include "client-min/draw/view_light.h"
#include "client-min/draw/view_shadow.h"
#include "lod/leaf.h"
#include "lod/scattered.h"
#include "lod/tint.h"

#define ELLIPSES (1u << 29)              /* a draw call: more than draw_cut allows of one plant */
#define PART_VERTICES 2500u              /* that lazy software gets at a time */
#define QUADS 16383u                     /* a draw call: 16-bit indices; OpenGL ES keeps the last */

struct view_gl {
	uint32_t width, height;
	struct view_context context;
	struct view_gpu gpu;
	struct view_shader shaders[VIEW_VARIANTS][VIEW_PROGRAM_COUNT];
	unsigned quads;                  /* index buffer: two triangles of four vertices, QUADS times */
	/* of a picture's first sample, and, once there is one, of another: they share depths */
	unsigned framebuffers[2], seen[2], depth;
	unsigned vertex_array;
	float point_max;                 /* pixels across */
	int viewport_max[2];
	struct view_gpu_texels instances, members;
	uint64_t *owners;                /* of the instances that were recorded */
};

struct frame {                           /* of one draw */
	struct view_gl *gl;
	const struct view_draw_job *job;
	struct view_picture *picture;
	const struct view_gl_map *map;   /* NULL: the picture itself is drawn */
	enum view_program bound;
	bool any_bound;
	uint64_t pending;                /* vertices that lazy software has not begun with */
	struct eco_error *error;
};

/* ---- Life ---- */

static unsigned texture_target(unsigned format, uint32_t width, uint32_t height, unsigned attachment)
{
	unsigned texture = view_gpu_texture(format, width, height, GL_NEAREST);
	glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture, 0);
	return texture;
}

static enum eco_code make_target(struct view_gl *gl, bool other, struct eco_error *error)
{
	if (gl->framebuffers[other])
		return ECO_OK;
	glGenFramebuffers(1, &gl->framebuffers[other]);
	glBindFramebuffer(GL_FRAMEBUFFER, gl->framebuffers[other]);
	gl->seen[other] = texture_target(GL_RGBA32UI, gl->width, gl->height, GL_COLOR_ATTACHMENT0);
	if (gl->depth)
		glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, gl->depth, 0);
	else
		gl->depth = texture_target(GL_DEPTH_COMPONENT32F, gl->width, gl->height, GL_DEPTH_ATTACHMENT);
	if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
		return eco_fail(error, ECO_UNSUPPORTED, "the graphics driver cannot draw whole numbers");
	return ECO_OK;
}

static void free_targets(struct view_gl *gl)
{
	glDeleteTextures(2, gl->seen);
	glDeleteTextures(1, &gl->depth);
	glDeleteFramebuffers(2, gl->framebuffers);
	memset(gl->framebuffers, 0, sizeof gl->framebuffers);
	gl->depth = 0;
}

enum eco_code view_gl_resize(struct view_gl *gl, const struct view_gl_options *options,
	struct eco_error *error)
{
	GLint most = 0;
	if (gl->framebuffers[0] && gl->width == options->width && gl->height == options->height)
		return ECO_OK;
	view_context_use(&gl->context);
	free_targets(gl);
	gl->width = options->width;
	gl->height = options->height;
	glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
	if (gl->width > (uint32_t)most || gl->height > (uint32_t)most)
		return eco_fail(error, ECO_UNSUPPORTED, "a picture of %u x %u pixels: the graphics driver "
			"draws at most %d x %d", gl->width, gl->height, most, most);
	return make_target(gl, false, error);
}

static void prepare_points(struct view_gl *gl)
{
	float range[2] = { 0, 0 };
	glGetFloatv(GL_ALIASED_POINT_SIZE_RANGE, range);
	glGetIntegerv(GL_MAX_VIEWPORT_DIMS, gl->viewport_max);
	gl->point_max = range[1];
}

static enum eco_code make_quads(struct view_gl *gl, struct eco_error *error)
{
	static const uint16_t corner[6] = { 0, 1, 2, 0, 2, 3 };
	uint16_t *indices = malloc(QUADS * sizeof corner);
	if (!indices)
		return eco_no_memory(error, "drawing");
	glGenVertexArrays(1, &gl->vertex_array);
	glBindVertexArray(gl->vertex_array);
	for (uint32_t i = 0; i < QUADS * 6; i++)
		indices[i] = (uint16_t)(i / 6 * 4 + corner[i % 6]);
	glGenBuffers(1, &gl->quads);
	glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, gl->quads);
	glBufferData(GL_ELEMENT_ARRAY_BUFFER, QUADS * sizeof corner, indices, GL_STATIC_DRAW);
	free(indices);
	return ECO_OK;
}

enum eco_code view_gl_open(struct view_gl **out, const struct view_gl_options *options,
	struct eco_error *error)
{
	*out = NULL;
	struct view_gl *gl = calloc(1, sizeof *gl);
	if (!gl)
		return eco_no_memory(error, "drawing");
	enum eco_code code = view_context_open(&gl->context, error);
	if (!code) {
		view_gpu_init(&gl->gpu);
		prepare_points(gl);
		code = view_gl_resize(gl, options, error);
		if (!code)
			code = make_quads(gl, error);
	}
	if (code)
		view_gl_close(gl);
	else
		*out = gl;
	return code;
}

void view_gl_close(struct view_gl *gl)
{
	if (!gl)
		return;
	if (gl->context.display) {
		const unsigned textures[] = { gl->instances.texture, gl->members.texture };
		view_context_use(&gl->context);
		view_gpu_free(&gl->gpu);
		for (int i = 0; i < VIEW_VARIANTS * VIEW_PROGRAM_COUNT; i++)
			glDeleteProgram(gl->shaders[i / VIEW_PROGRAM_COUNT][i % VIEW_PROGRAM_COUNT].program);
		free_targets(gl);
		glDeleteTextures(2, textures);
		glDeleteBuffers(1, &gl->quads);
		glDeleteVertexArrays(1, &gl->vertex_array);
		view_context_close(&gl->context);
	}
	free(gl->owners);
	free(gl);
}

uint32_t view_gl_programs(const struct view_gl *gl)
{
	uint32_t programs = 0;
	for (uint32_t i = 0; i < VIEW_PROGRAM_COUNT; i++)
		programs |= gl->shaders[VIEW_VARIANT_PLAIN][i].program || gl->shaders[VIEW_VARIANT_TINTED][i].program ? 1u << i : 0;
	return programs;
}

const char *view_gl_renderer(const struct view_gl *gl)
{
	return gl->context.renderer;
}

bool view_gl_hardware(const struct view_gl *gl)
{
	return gl->context.hardware;
}

void view_gl_keep(struct view_gl *gl, const struct view_store *const *stores, uint32_t count)
{
	view_context_use(&gl->context);
	view_gpu_keep(&gl->gpu, stores, count);
}

uint64_t view_gl_bytes(const struct view_gl *gl)
{
	return gl->gpu.bytes;
}

/* ---- Instances ---- */

static enum eco_code no_memory(const struct frame *f)
{
	return eco_no_memory(f->error, "the plants in view");
}

static enum eco_code note_owners(struct frame *f)
{
	const struct view_selection *s = f->job->selection;
	uint64_t *owners = realloc(f->gl->owners, s->instance_count * sizeof *owners + 1);
	if (!owners)
		return no_memory(f);
	f->gl->owners = owners;
	for (uint32_t i = 0; i < s->instance_count; i++)
		owners[i] = s->instances[i].owner;
	return ECO_OK;
}

static enum eco_code upload_selection(struct frame *f)
{
	const struct view_selection *s = f->job->selection;
	size_t size = (size_t)s->instance_count * VIEW_INSTANCE_TEXELS * VIEW_TEXEL_BYTES;
	uint32_t *words = malloc(size + 1);
	if (!words)
		return no_memory(f);
	for (uint32_t i = 0; i < s->instance_count; i++) {
		const struct view_instance *p = &s->instances[i];
		view_instance_write(words + (size_t)i * VIEW_INSTANCE_TEXELS * 4, f->job->eye, p,
			p->plant == ECO_NONE ? NULL : view_store_plant(f->job->store, p->plant));
	}
	enum eco_code code = view_gpu_stream(&f->gl->gpu, &f->gl->instances, VIEW_GPU_WORDS, words,
		(uint64_t)s->instance_count * VIEW_INSTANCE_TEXELS, f->error);
	free(words);
	uint32_t pairs = s->cut_count ? s->member_first[s->cut_count] : 0;
	return code ? code : view_gpu_stream(&f->gl->gpu, &f->gl->members, VIEW_GPU_WORD, s->members, pairs,
		f->error);
}

/* ---- Programs ---- */

static void set_camera(const struct frame *f, const struct view_shader *s)
{
	const struct lod_eye *eye = f->job->eye;
	const int names[3] = { VIEW_U_RIGHT, VIEW_U_UP, VIEW_U_FORWARD };
	const double *axes[3] = { eye->right, eye->up, eye->forward };
	for (int i = 0; i < 3; i++)
		glUniform3f(s->uniform[names[i]], (float)axes[i][0], (float)axes[i][1], (float)axes[i][2]);
	glUniform4f(s->uniform[VIEW_U_LENS], (float)(1 / eye->tan_x), (float)(1 / eye->tan_y),
		(float)f->job->near_m, 0);
	glUniform2f(s->uniform[VIEW_U_MIDDLE], (float)eye->middle[0], (float)eye->middle[1]);
	glUniform1ui(s->uniform[VIEW_U_SAMPLE], eye->sample);
	glUniform2f(s->uniform[VIEW_U_HALF], 0.5f * (float)f->picture->width,
		0.5f * (float)f->picture->height);
	glUniform1i(s->uniform[VIEW_U_FIRST], 0);
	glUniform1i(s->uniform[VIEW_U_RECORDS], 0);
	glUniform1i(s->uniform[VIEW_U_INSTANCES], 1);
	glUniform1i(s->uniform[VIEW_U_MEMBERS], 2);
	glUniform1i(s->uniform[VIEW_U_TEXTURE], 3);
	glUniform1i(s->uniform[VIEW_U_MAP], 5);
	glUniform4f(s->uniform[VIEW_U_TINT], 0, 0, 0, 0);
	float sides[ECO_SIZES];
	for (uint32_t code = 0; code < ECO_SIZES; code++)
		sides[code] = sqrtf(eco_size(code));
	glUniform1fv(s->uniform[VIEW_U_SIDES], ECO_SIZES, sides);
}

static enum view_variant variant_of(const struct view_store *store, enum view_program which)
{
	return which == VIEW_PROGRAM_GROUND || which == VIEW_PROGRAM_SUMMARY || !(view_store_needs(store) & ECO_NEED_TINTS)
		? VIEW_VARIANT_PLAIN : VIEW_VARIANT_TINTED;
}

static enum eco_code compile(struct view_gl *gl, enum view_program which, enum view_variant variant,
	struct eco_error *error)
{
	struct view_shader *s = &gl->shaders[variant][which];
	return s->program ? ECO_OK : view_shader_compile(s, which, variant, &gl->context.dialect, error);
}

static enum eco_code use(struct frame *f, enum view_program which, const struct view_shader **out)
{
	enum view_variant variant = f->map ? VIEW_VARIANT_SHADOW : variant_of(f->job->store, which);
	struct view_shader *s = &f->gl->shaders[variant][which];
	*out = s;
	if (f->any_bound && f->bound == which)
		return ECO_OK;
	ECO_PASS(compile(f->gl, which, variant, f->error));
	glUseProgram(s->program);
	set_camera(f, s);
	f->bound = which;
	f->any_bound = true;
	return ECO_OK;
}

static void bind(unsigned unit, unsigned texture)
{
	glActiveTexture(GL_TEXTURE0 + unit);
	glBindTexture(GL_TEXTURE_2D, texture);
	glActiveTexture(GL_TEXTURE0 + 15);       /* where uploads may bind what they like */
}

static void bind_records(const struct frame *f, const struct view_shader *s, const struct view_gpu_list *g)
{
	bind(0, g->records.texture);
	glUniform3i(s->uniform[VIEW_U_SHIFT], (int)g->records.shift, (int)f->gl->instances.shift,
		(int)f->gl->members.shift);
}

/* ---- Drawing ---- */

/* Lazy software works on pixels of one part while it gets the vertices of the next, and notes a part
 * where it had noted the one before (lod/EXPERIMENTS.md, A frame's time). */
static void send_part(struct frame *f, uint64_t vertices)
{
	f->pending += vertices;
	if (!f->gl->context.lazy || f->pending < PART_VERTICES)
		return;
	glFlush();
	f->pending = 0;
}

/* How many of so many things of so many vertices are drawn at once. */
static uint32_t at_once(const struct frame *f, uint32_t things, uint32_t vertices)
{
	uint32_t part = PART_VERTICES / vertices;
	if (!f->gl->context.lazy || part >= things)
		return things;
	return part ? part : 1;
}

static void set_ground(const struct frame *f, const struct view_shader *s)
{
	const struct view_ground *ground = &f->job->selection->ground;
	const struct lod_eye *eye = f->job->eye;
	const double *o = ground->at, *axes[3] = { eye->right, eye->up, eye->forward };
	float origin[3];
	for (int i = 0; i < 3; i++)
		origin[i] = (float)(axes[i][0] * (o[0] - eye->at[0]) + axes[i][1] * (o[1] - eye->at[1])
			+ axes[i][2] * (o[2] - eye->at[2]));
	glUniform3fv(s->uniform[VIEW_U_ORIGIN], 1, origin);
	glUniform3iv(s->uniform[VIEW_U_ANCHOR], 1, ground->anchor);
	glUniform3fv(s->uniform[VIEW_U_STEP], 1, ground->step);
}

static enum eco_code draw_tile(struct frame *f, const struct view_shader *s,
	const struct view_ground_tile *tile)
{
	const struct view_gpu_list *g;
	ECO_PASS(view_gpu_list(&f->gl->gpu, tile->list, &g, f->error));
	const uint8_t *coarser = tile->seam.coarser;
	bind_records(f, s, g);
	glUniform3i(s->uniform[VIEW_U_COLUMNS], (int)tile->x.count, (int)tile->x.before, (int)tile->y.before);
	glUniform2i(s->uniform[VIEW_U_INNER], (int)tile->x.inner, (int)tile->y.inner);
	glUniform4i(s->uniform[VIEW_U_SEAM], coarser[LOD_GROUND_WEST], coarser[LOD_GROUND_EAST],
		coarser[LOD_GROUND_SOUTH], coarser[LOD_GROUND_NORTH]);
	glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, (GLsizei)(2 * tile->x.inner),
		(GLsizei)(tile->y.inner - 1));
	send_part(f, (uint64_t)2 * tile->x.inner * (tile->y.inner - 1));
	return ECO_OK;
}

static enum eco_code draw_ground(struct frame *f)
{
	const struct view_ground *ground = &f->job->selection->ground;
	const struct view_shader *s;
	enum eco_code code = use(f, VIEW_PROGRAM_GROUND, &s);
	if (!code)
		set_ground(f, s);
	for (uint32_t i = 0; i < ground->count && !code; i++)
		code = draw_tile(f, s, &ground->tiles[i]);
	return code;
}

/* The width of the leaves that are drawn on a plant's splats and points, and the deviation of their tone. */
struct leaves { float width, tone; };

static struct leaves leaves_of(const struct frame *f, const struct eco_list *list, uint32_t plant)
{
	if (f->map || f->job->smooth || plant == ECO_NONE
			|| (list->kind != ECO_LIST_POINTS && list->kind != ECO_LIST_IMPOSTOR))
		return (struct leaves){ 0, 0 };
	const struct eco_plant *p = &view_store_plant(f->job->store, plant)->plant;
	/* the colour of a point is that of its leaf already */
	return (struct leaves){ (float)(p->leaf_width * ECO_LEAF_UNIT_M),
		list->kind == ECO_LIST_IMPOSTOR || list->attributes & ECO_ATTR_SPLAT
			? (float)p->leaf_tone / ECO_TONE_ONE : 0 };
}

static enum view_program program_of(const struct eco_list *list, const struct leaves *leaves)
{
	if (leaves->width > 0 && list->kind == ECO_LIST_IMPOSTOR)
		return VIEW_PROGRAM_LEAFY_IMPOSTORS;
	if (leaves->width > 0)
		return list->attributes & ECO_ATTR_SPLAT ? VIEW_PROGRAM_LEAFY_SPLATS : VIEW_PROGRAM_LEAFY_POINTS;
	switch (list->kind) {
	case ECO_LIST_LINES:
		return VIEW_PROGRAM_LINES;
	case ECO_LIST_POINTS:
		return list->attributes & ECO_ATTR_SPLAT ? VIEW_PROGRAM_SPLATS
			: list->attributes & ECO_ATTR_PLANT ? VIEW_PROGRAM_SUMMARY : VIEW_PROGRAM_POINTS;
	case ECO_LIST_IMPOSTOR:
		return VIEW_PROGRAM_IMPOSTORS;
	default:
		return view_record_texels(list) == 5 ? VIEW_PROGRAM_TEXTURED : VIEW_PROGRAM_TRIANGLES;
	}
}

/* For a store that holds nothing: programs of whole scenes, from where plants are no triangles. */
static uint32_t programs_of(const struct view_store *store)
{
	uint32_t programs = 0;
	for (uint32_t i = 0; i < view_store_list_count(store); i++) {
		const struct eco_list *list = &view_store_list_at(store, i)->list;
		if (list->kind == ECO_LIST_GROUND)
			programs |= 1u << VIEW_PROGRAM_GROUND;
		else if (list->kind <= ECO_LIST_POINTS || list->kind == ECO_LIST_IMPOSTOR)
			programs |= 1u << program_of(list, &(struct leaves){ 0, 0 });
	}
	return programs ? programs : 1u << VIEW_PROGRAM_GROUND | 1u << VIEW_PROGRAM_SUMMARY | 1u << VIEW_PROGRAM_SPLATS;
}

enum eco_code view_gl_prepare(struct view_gl *gl, const struct view_store *store, struct eco_error *error)
{
	const uint32_t programs = programs_of(store);
	view_context_use(&gl->context);
	for (int i = 0; i < VIEW_PROGRAM_COUNT; i++)
		if (programs & 1u << i)
			ECO_PASS(compile(gl, (enum view_program)i, variant_of(store, (enum view_program)i), error));
	return ECO_OK;
}

static void set_tint(const struct view_shader *s, enum view_role role)
{
	const uint8_t *c = view_tint_colors[role];
	glUniform4f(s->uniform[VIEW_U_TINT], c[0] / 255.0f, c[1] / 255.0f, c[2] / 255.0f, 1);
}

/* Scale as the vertex shader wants it: of edges, by growth code or of a line or splat, or the radius of a
 * point. */
static void set_scale(const struct view_shader *s, const struct eco_list *list, const struct eco_cut *cut)
{
	float scale = ldexpf(cut->scale, -cut->halvings);
	float edges[ECO_GROWTHS];
	for (uint32_t code = 0; code < ECO_GROWTHS; code++)
		edges[code] = sqrtf(eco_growth(code, scale));
	glUniform1fv(s->uniform[VIEW_U_EDGES], ECO_GROWTHS, edges);
	bool ball = list->kind == ECO_LIST_POINTS && !(list->attributes & ECO_ATTR_SPLAT);
	glUniform1f(s->uniform[VIEW_U_SCALE],
		ball ? (float)lod_ball_radius(list, scale) : sqrtf(scale));
	glUniform1ui(s->uniform[VIEW_U_COVER], (unsigned)(16 * eco_list_opacity(list)));
}

static enum eco_code bind_images(struct frame *f, const struct view_list *list)
{
	const struct view_gpu_list *image;
	enum eco_code code = view_gpu_list(&f->gl->gpu, view_store_list(f->job->store, list->list.image),
		&image, f->error);
	if (!code)
		bind(3, image->color);
	return code;
}

/* Lines, and impostors, a plant each: four vertices a primitive, in parts as long as the index buffer. */
static void draw_quads(const struct view_shader *s, uint32_t first, uint32_t end, uint32_t members)
{
	for (uint32_t at = first; at < end; at += QUADS) {
		uint32_t count = end - at < QUADS ? end - at : QUADS;
		glUniform1i(s->uniform[VIEW_U_FIRST], (int)at);
		glDrawElementsInstanced(GL_TRIANGLES, (GLsizei)(count * 6), GL_UNSIGNED_SHORT, NULL,
			(GLsizei)members);
	}
}

/* How wide an ellipse may be that touches the picture and whose half axis is such a part of its distance:
 * 2 / (1 - part^2) <= 8/3 of that, towards the picture's edge and as far beyond it as half the ellipse. */
static double ellipse_px(const struct frame *f, double part)
{
	const struct lod_eye *eye = f->job->eye;
	return part * 8 / 3 * fmax(0.5 * f->picture->width * (1 + 1 / eye->tan_x),
		0.5 * f->picture->height * (1 + 1 / eye->tan_y));
}

/* By which the viewport is larger than the picture while ellipses are points, of which drivers may leave out
 * those whose middle is beside it; half of the largest point. */
static int point_margin(const struct view_gl *gl)
{
	int most = (int)(0.5f * gl->point_max), across = (gl->viewport_max[0] - (int)gl->width) / 2,
		down = (gl->viewport_max[1] - (int)gl->height) / 2, fits = across < down ? across : down;
	return most < fits ? most : fits;
}

/* All ellipses of all plants at once, but for more than a driver counts, or than is a part. */
static void draw_ellipses(struct frame *f, const struct view_shader *s, const struct view_gpu_list *g,
	const struct view_list *list, const struct eco_cut *cut, uint32_t first_member, uint32_t members)
{
	uint32_t count = (cut->end - cut->first) << cut->halvings, most = ELLIPSES / count;
	most = at_once(f, most, count);
	int width = (int)f->picture->width, height = (int)f->picture->height,
		margin = f->map ? 0 : point_margin(f->gl);
	/* leaves reach beyond the ellipse */
	bool points = margin > 0 && (1 + 0.5 * LOD_LEAF_RAGGED) * ellipse_px(f, view_extent_ellipses(f->job->eye, f->job->selection, g, list,
		cut, f->job->selection->members + first_member, members)) <= 2 * margin;
	margin = points ? margin : 0;
	glUniform1i(s->uniform[VIEW_U_CORNERS], points ? 1 : 3);
	glUniform1i(s->uniform[VIEW_U_FIRST], (int)(cut->first << cut->halvings));
	glUniform1i(s->uniform[VIEW_U_COUNT], (int)count);
	glUniform2f(s->uniform[VIEW_U_WINDOW], 0.5f * (float)width + (float)margin,
		0.5f * (float)height + (float)margin);
	glViewport(-margin, -margin, width + 2 * margin, height + 2 * margin);
	for (uint32_t i = 0, now; i < members; i += now) {
		now = members - i < most ? members - i : most;
		glUniform1i(s->uniform[VIEW_U_FIRST_MEMBER], (int)(first_member + i));
		glDrawArrays(points ? GL_POINTS : GL_TRIANGLES, 0, (GLsizei)(count * now * (points ? 1 : 3)));
		send_part(f, (uint64_t)count * now);
	}
	glViewport(0, 0, width, height);
}

/* Plants in turn, and of each its triangles, as the first of equals is seen. */
static void draw_triangles(struct frame *f, const struct view_shader *s, uint32_t first, uint32_t end,
	uint32_t first_member, uint32_t members)
{
	uint32_t now, most = at_once(f, members, 3 * (end - first));
	for (uint32_t i = 0; i < members; i += now) {
		now = members - i < most ? members - i : most;
		uint32_t part = now > 1 ? end - first : at_once(f, end - first, 3);
		glUniform1i(s->uniform[VIEW_U_FIRST_MEMBER], (int)(first_member + i));
		for (uint32_t at = first; at < end; at += part) {
			uint32_t count = end - at < part ? end - at : part;
			glDrawArraysInstanced(GL_TRIANGLES, (GLint)(at * 3), (GLsizei)(count * 3), (GLsizei)now);
			send_part(f, (uint64_t)3 * count * now);
		}
	}
}

static void draw_primitives(struct frame *f, const struct view_shader *s, const struct view_gpu_list *g,
	const struct view_list *list, const struct eco_cut *cut, uint32_t first_member, uint32_t members)
{
	uint32_t first = cut->first << cut->halvings, end = cut->end << cut->halvings;
	if (list->list.kind == ECO_LIST_IMPOSTOR) {
		glUniform1i(s->uniform[VIEW_U_FIRST_RECORD], (int)view_record_span(list, 0, first));
		glUniform1ui(s->uniform[VIEW_U_SURFACE], view_impostor_surface(&list->list));
		draw_quads(s, 0, members, 1);
	} else if (list->list.kind == ECO_LIST_POINTS)
		draw_ellipses(f, s, g, list, cut, first_member, members);
	else if (list->list.kind == ECO_LIST_LINES)
		draw_quads(s, first, end, members);
	else
		draw_triangles(f, s, first, end, first_member, members);
	f->picture->vertices += eco_cut_vertices(cut, &list->list) * members;
	if (list->list.kind == ECO_LIST_IMPOSTOR || list->list.kind == ECO_LIST_LINES)
		send_part(f, (uint64_t)4 * members * (end - first));
}

static void set_wood(const struct view_shader *s, const struct view_list *list)
{
	struct lod_tint_wood wood = view_list_wood(list);
	const float *l = wood.light;
	glUniform4fv(s->uniform[VIEW_U_WOOD], 2, (const float[]){ wood.share[0], wood.share[1], wood.share[2],
		wood.share[3], l[0], l[1], l[2], 0 });
}

static enum eco_code draw_cut(struct frame *f, uint32_t index)
{
	const struct view_selection *selection = f->job->selection;
	const struct eco_cut *cut = &selection->plan_cuts[index];
	const struct view_list *list = view_store_list(f->job->store, cut->list);
	uint32_t members = selection->member_first[index + 1] - selection->member_first[index],
		first_member = selection->member_first[index];
	if (!members || cut->first == cut->end)
		return ECO_OK;
	struct leaves leaves = leaves_of(f, &list->list, selection->instances[selection->members[first_member]].plant);
	enum view_program which = program_of(&list->list, &leaves);
	const struct view_gpu_list *g;
	const struct view_shader *s;
	enum eco_code code = view_gpu_list(&f->gl->gpu, list, &g, f->error);
	if (!code)
		code = use(f, which, &s);
	if (code)
		return code;
	bind_records(f, s, g);
	if (which == VIEW_PROGRAM_TEXTURED && (code = bind_images(f, list)))
		return code;
	glUniform1i(s->uniform[VIEW_U_FIRST_MEMBER], (int)first_member);
	set_scale(s, &list->list, cut);
	glUniform2f(s->uniform[VIEW_U_LEAF], leaves.width, f->job->tint == VIEW_TINT_KIND ? 0 : leaves.tone);
	set_wood(s, list);
	if (list->list.kind == ECO_LIST_POINTS)
		glUniform1ui(s->uniform[VIEW_U_LEVEL],
			view_surface_cloud(0, eco_level_share(list->list.level)) >> 16 & 255);
	if (which == VIEW_PROGRAM_SUMMARY) {
		glUniform1ui(s->uniform[VIEW_U_PATH],
			view_record_path(selection->instances[selection->members[first_member]].path));
		glUniform1i(s->uniform[VIEW_U_HALVINGS], cut->halvings);
		glUniform1f(s->uniform[VIEW_U_REACH], (float)lod_ball_radius(&list->list, cut->scale));
	}
	if (f->job->tint == VIEW_TINT_KIND)
		set_tint(s, selection->roles[index]);
	if (((uint64_t)cut->end << cut->halvings) * 4 > INT32_MAX)
		return eco_fail(f->error, ECO_TOO_LARGE, "list %u is too long for the graphics driver: use "
			"--reference=cpu", list->id);
	draw_primitives(f, s, g, list, cut, first_member, members);
	return ECO_OK;
}

static void read_pixel(const struct view_gl *gl, const uint32_t words[4], struct view_picture *picture,
	size_t i)
{
	uint32_t whose = words[0], surface = words[1];
	bool summary = surface >> 24 == VIEW_GL_SUMMARY;
	picture->owner[i] = summary ? eco_owner_summary(whose >> 16, whose)
		: whose ? gl->owners[whose - 1] : 0;
	picture->cover[i] = picture->owner[i] ? 255 : 0;
	picture->surface[i] = summary ? surface & ~(1u << 24) : surface;
	memcpy(&picture->depth[i], &words[2], sizeof picture->depth[i]);
	for (int k = 0; k < 3; k++)
		picture->rgb[3 * i + (size_t)k] = (uint8_t)(words[3] >> 8 * k);
}

enum eco_code view_gl_read(struct view_gl *gl, uint32_t sample, struct view_picture *picture,
	struct eco_error *error)
{
	size_t pixels = (size_t)picture->width * picture->height;
	uint32_t *words = malloc(pixels * 16);
	if (!words)
		return eco_no_memory(error, "a picture");
	view_context_use(&gl->context);
	glBindFramebuffer(GL_FRAMEBUFFER, gl->framebuffers[sample > 0]);
	glPixelStorei(GL_PACK_ALIGNMENT, 1);
	glReadBuffer(GL_COLOR_ATTACHMENT0);
	glReadPixels(0, 0, (GLsizei)picture->width, (GLsizei)picture->height, GL_RGBA_INTEGER,
		GL_UNSIGNED_INT, words);
	for (size_t i = 0; i < pixels; i++)
		read_pixel(gl, words + 4 * i, picture, i);
	free(words);
	GLenum failed = glGetError();
	return failed ? eco_fail(error, ECO_IO, "the graphics driver reports error 0x%x", failed) : ECO_OK;
}

/* All that drawing relies on: a page's context is not ours alone. */
static void begin(const struct view_gl *gl, unsigned framebuffer, const struct view_picture *picture)
{
	glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
	glBindVertexArray(gl->vertex_array);
	glViewport(0, 0, (GLsizei)picture->width, (GLsizei)picture->height);
	glDisable(GL_DITHER);
	glDisable(GL_BLEND);
	glDisable(GL_SCISSOR_TEST);
	glDisable(GL_STENCIL_TEST);
	glDisable(GL_CULL_FACE);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_GREATER);                 /* nearer wins; of equals, the first */
	glDepthMask(GL_TRUE);
	glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
	glActiveTexture(GL_TEXTURE0 + 15);
}

/* From *cut on, until there are `most` vertices. */
static enum eco_code draw_cuts(struct frame *f, uint64_t most, uint32_t *cut)
{
	uint64_t before = f->picture->vertices;
	bind(1, f->gl->instances.texture);
	bind(2, f->gl->members.texture);
	while (*cut < f->job->selection->cut_count && f->picture->vertices - before < most)
		ECO_PASS(draw_cut(f, (*cut)++));
	return view_gpu_check(&f->gl->gpu, f->error);
}

static enum eco_code begin_record(struct frame *f)
{
	f->picture->vertices = 0;
	glClearBufferuiv(GL_COLOR, 0, (const unsigned[]){ 0, 0, 0, 0 });
	glClearBufferfv(GL_DEPTH, 0, (const float[]){ 0 });
	ECO_PASS(note_owners(f));
	ECO_PASS(upload_selection(f));
	return f->job->selection->ground.count ? draw_ground(f) : ECO_OK;
}

enum eco_code view_gl_record_part(struct view_gl *gl, const struct view_draw_job *job, uint64_t most,
	uint32_t *cut, struct view_picture *picture, struct eco_error *error)
{
	struct frame f = { .gl = gl, .job = job, .picture = picture, .error = error };
	if (picture->width != gl->width || picture->height != gl->height)
		return eco_fail(error, ECO_BAD_USAGE, "the picture is %u x %u, the target %u x %u",
			picture->width, picture->height, gl->width, gl->height);
	view_context_use(&gl->context);
	ECO_PASS(make_target(gl, job->eye->sample > 0, error));
	begin(gl, gl->framebuffers[job->eye->sample > 0], picture);
	if (!*cut)
		ECO_PASS(begin_record(&f));
	return draw_cuts(&f, most, cut);
}

enum eco_code view_gl_record(struct view_gl *gl, const struct view_draw_job *job,
	struct view_picture *picture, struct eco_error *error)
{
	uint32_t cut = 0;
	return view_gl_record_part(gl, job, UINT64_MAX, &cut, picture, error);
}

enum eco_code view_gl_cast(struct view_gl *gl, const struct view_gl_map *map, struct eco_error *error)
{
	/* axes of the world, in which rows are; half a picture is a map's half */
	struct lod_eye eye = { .right = { 1, 0, 0 }, .up = { 0, 1, 0 }, .forward = { 0, 0, 1 },
		.tan_x = 0.5 * map->size, .tan_y = 0.5 * map->size };
	struct view_draw_job job = { .store = map->store, .selection = map->casters, .eye = &eye,
		.near_m = (double)VIEW_SHADOW_LEAST_W };
	struct view_picture picture = { .width = map->size, .height = map->size };
	struct frame f = { .gl = gl, .job = &job, .picture = &picture, .map = map, .error = error };
	memcpy(eye.at, map->eye->at, sizeof eye.at);
	view_context_use(&gl->context);
	begin(gl, map->framebuffer, &picture);
	glClearBufferfv(GL_DEPTH, 0, (const float[]){ 0 });
	bind(5, map->rows);
	enum eco_code code = upload_selection(&f);
	uint32_t cut = 0;
	return code ? code : draw_cuts(&f, UINT64_MAX, &cut);
}

unsigned view_gl_target(const struct view_gl *gl, uint32_t sample)
{
	return gl->seen[sample > 0];
}

static enum eco_code record(void *ctx, const struct view_draw_job *job, struct view_picture *picture,
	struct eco_error *error)
{
	struct view_gl *gl = ctx;
	enum eco_code code = view_gl_record(gl, job, picture, error);
	return code ? code : view_gl_read(gl, job->eye->sample, picture, error);
}

enum eco_code view_gl_draw(struct view_gl *gl, const struct view_draw_job *job, struct view_picture *picture,
	struct eco_error *error)
{
	return view_light_samples(job, record, gl, picture, error);
}
