#include "client-min/web/web_program.h"

#include <GLES3/gl3.h>
#include <stddef.h>
#include <string.h>

#include "client-min/draw/view_gpu.h"
#include "client-min/draw/view_shader.h"
#include "client-min/draw/view_shadow.h"

#define PARTS_MAX 8

static const char vertex_text[] = "#version 300 es\n"
	"precision highp usampler2D;\n"
	"#define VERTEX\n"
	"#define FLAT flat out\n"
	"out vec2 v_at;\n"
	"void more();\n"
	"void main() {\n"
	"	vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;\n"
	"	v_at = vec2(corner.x, 1.0 - corner.y);\n"
	"	gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);\n"
	"	more();\n"
	"}\n";
static const char fragment_head[] = "#version 300 es\n"
	"precision highp float; precision highp int;\n"
	"precision highp sampler2D; precision highp usampler2D;\n"
	"#define FLAT flat in\n"
	"in vec2 v_at;\n"
#include "build/text/client-min/web/web_common.glsl"
	;

unsigned web_program(const char *more, const char *const *parts, int count, const char *what,
	struct eco_error *error)
{
	const char *vertex_parts[] = { vertex_text, more ? more : "void more() {}\n" },
		*fragment_parts[PARTS_MAX] = { fragment_head };
	for (int i = 0; i < count && i + 1 < PARTS_MAX; i++)
		fragment_parts[i + 1] = parts[i];
	return view_shader_link(&(struct view_shader_text){ vertex_parts, 2, fragment_parts, count + 1 }, what,
		error);
}

void web_program_texture(unsigned program, const char *name, int unit, unsigned texture)
{
	glActiveTexture(GL_TEXTURE0 + (GLenum)unit);
	glBindTexture(GL_TEXTURE_2D, texture);
	glUniform1i(glGetUniformLocation(program, name), unit);
}

void web_program_fill(unsigned vertex_array, const int viewport[4])
{
	glBindVertexArray(vertex_array);
	glViewport(viewport[0], viewport[1], viewport[2], viewport[3]);
	glDrawArrays(GL_TRIANGLES, 0, 3);
	glBindVertexArray(0);
}

/* ==== Shadow maps ==== */

#define TEXT(macro) TEXT_OF(macro)
#define TEXT_OF(value) #value
#define CELLS_WIDE "#define CELLS " TEXT(VIEW_SHADOW_CELLS) "\n"
#define COUNT (VIEW_SHADOW_CELLS * VIEW_SHADOW_CELLS)

static const char cells_text[] =
#include "build/text/client-min/web/web_cells.glsl"
	;

/* ---- Life ---- */

static void make_texture(struct web_shadow *shadow, enum web_shadow_part part, unsigned format,
	uint32_t width, uint32_t height)
{
	unsigned to = part == WEB_SHADOW_TOPS ? GL_DEPTH_ATTACHMENT : GL_COLOR_ATTACHMENT0;
	glDeleteTextures(1, &shadow->textures[part]);
	shadow->textures[part] = view_gpu_texture(format, width, height, GL_NEAREST);
	glBindFramebuffer(GL_FRAMEBUFFER, shadow->framebuffers[part]);
	glFramebufferTexture2D(GL_FRAMEBUFFER, to, GL_TEXTURE_2D, shadow->textures[part], 0);
}

static enum eco_code prepare(struct web_shadow *shadow, struct eco_error *error)
{
	unsigned *cells = &shadow->programs[WEB_SHADOW_CELLS], *rows = &shadow->programs[WEB_SHADOW_ROWS];
	if (shadow->vertex_array)
		return ECO_OK;
	*cells = web_program(NULL, (const char *const[]){ CELLS_WIDE, cells_text }, 2, "what shadows fall on", error);
	*rows = *cells ? web_program(NULL, (const char *const[]){ CELLS_WIDE "#define ROWS\n", cells_text }, 2,
		"where shadows lie", error) : 0;
	if (!*rows) {
		web_shadow_free(shadow);
		shadow->refused = true;
		return ECO_UNSUPPORTED;
	}
	glGenVertexArrays(1, &shadow->vertex_array);
	glGenFramebuffers(WEB_SHADOW_PARTS, shadow->framebuffers);
	make_texture(shadow, WEB_SHADOW_CELLS, GL_RGBA32UI, VIEW_SHADOW_CELLS, VIEW_SHADOW_CELLS);
	make_texture(shadow, WEB_SHADOW_ROWS, GL_RGBA32UI, 4, 1);
	return ECO_OK;
}

static enum eco_code resize(struct web_shadow *shadow, uint32_t size, struct eco_error *error)
{
	GLint most = 0;
	if (shadow->size == size)
		return ECO_OK;
	glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
	if (size > (uint32_t)most)
		return eco_fail(error, ECO_UNSUPPORTED, "a shadow map of %u x %u texels: the graphics driver has "
			"at most %d x %d", size, size, most, most);
	make_texture(shadow, WEB_SHADOW_TOPS, GL_DEPTH_COMPONENT32F, size, size);
	shadow->size = size;
	return ECO_OK;
}

void web_shadow_free(struct web_shadow *shadow)
{
	glDeleteTextures(WEB_SHADOW_PARTS, shadow->textures);
	glDeleteFramebuffers(WEB_SHADOW_PARTS, shadow->framebuffers);
	glDeleteVertexArrays(1, &shadow->vertex_array);
	for (int i = 0; i < WEB_SHADOW_TOPS; i++)
		glDeleteProgram(shadow->programs[i]);
	*shadow = (struct web_shadow){ 0 };
}

/* ---- Drawing ---- */

static void use(const struct web_shadow *shadow, enum web_shadow_part part, const char *texture, unsigned of)
{
	glUseProgram(shadow->programs[part]);
	web_program_texture(shadow->programs[part], texture, 0, of);
	glBindFramebuffer(GL_FRAMEBUFFER, shadow->framebuffers[part]);
}

static void fill_cells(const struct web_shadow *shadow, unsigned seen)
{
	use(shadow, WEB_SHADOW_CELLS, "u_seen", seen);
	web_program_fill(shadow->vertex_array, (const int[4]){ 0, 0, VIEW_SHADOW_CELLS, VIEW_SHADOW_CELLS });
}

static void find_rows(const struct web_shadow *shadow, const struct view_draw_job *job,
	const struct view_light_sun *sun, const uint32_t picture[2])
{
	const struct lod_eye *eye = job->eye;
	const double *const axes[3] = { eye->right, eye->up, eye->forward };
	unsigned program = shadow->programs[WEB_SHADOW_ROWS];
	float axis[9];
	for (int i = 0; i < 9; i++)
		axis[i] = (float)axes[i / 3][i % 3];
	use(shadow, WEB_SHADOW_ROWS, "u_cells", shadow->textures[WEB_SHADOW_CELLS]);
	glUniform3i(glGetUniformLocation(program, "u_count"), COUNT, (int)picture[0], (int)picture[1]);
	glUniformMatrix3fv(glGetUniformLocation(program, "u_axes"), 1, GL_FALSE, axis);
	glUniform4f(glGetUniformLocation(program, "u_sun"), sun->to[0], sun->to[1], sun->to[2],
		(float)shadow->size);
	glUniform3f(glGetUniformLocation(program, "u_lens"), (float)eye->tan_x, (float)eye->tan_y,
		job->selection->sky.shadows == VIEW_SHADOWS_PERSPECTIVE);
	web_program_fill(shadow->vertex_array, (const int[4]){ 0, 0, 4, 1 });
}

bool web_shadow_wanted(const struct web_shadow *shadow, const struct view_selection *selection)
{
	const struct view_sky *sky = &selection->sky;
	struct view_light_sun sun;
	if (!sky->casters && !selection->instance_count)
		return false;
	view_light_sun(sky, 0, &sun);
	bool same = sky->shadows == shadow->of.shadows && sky->shadow_size == shadow->of.shadow_size
		&& !memcmp(sky->sun, shadow->of.sun, sizeof sky->sun);
	return sky->shadows && !shadow->refused && sun.to[2] > VIEW_SHADOW_LOWEST && (same || !shadow->keeps);
}

enum eco_code web_shadow_draw(struct web_shadow *shadow, struct view_gl *gl, const struct view_draw_job *job,
	const uint32_t picture[2], struct eco_error *error)
{
	const struct view_sky *sky = &job->selection->sky;
	struct view_light_sun sun;
	enum eco_code code = prepare(shadow, error);
	if (!code)
		code = resize(shadow, sky->shadow_size, error);
	if (code)
		return code;
	view_light_sun(sky, 0, &sun);
	shadow->of = *sky;
	memcpy(shadow->eye, job->eye->at, sizeof shadow->eye);
	fill_cells(shadow, view_gl_target(gl, 0));
	find_rows(shadow, job, &sun, picture);
	return view_gl_cast(gl, &(struct view_gl_map){ job->store, sky->casters ? sky->casters : job->selection,
		job->eye, shadow->framebuffers[WEB_SHADOW_TOPS], shadow->textures[WEB_SHADOW_ROWS],
		shadow->size }, error);
}

void web_shadow_set(const struct web_shadow *shadow, unsigned program, int unit, const double eye[3])
{
	glUniform3f(glGetUniformLocation(program, "u_moved"), (float)(eye[0] - shadow->eye[0]),
		(float)(eye[1] - shadow->eye[1]), (float)(eye[2] - shadow->eye[2]));
	web_program_texture(program, "u_rows", unit, shadow->textures[WEB_SHADOW_ROWS]);
	web_program_texture(program, "u_tops", unit + 1, shadow->textures[WEB_SHADOW_TOPS]);
}
