#include "client-min/web/web_program.h"

#include <GLES3/gl3.h>
#include <stddef.h>

#include "client-min/draw/view_shader.h"

#define PARTS_MAX 8

static const char vertex_text[] = "#version 300 es\n"
	"precision highp usampler2D;\n"
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
	"in vec2 v_at;\n";

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

/* ---- A lit picture in the page ---- */

static const char present_text[] = WEB_IS_SUMMARY
	"uniform sampler2D u_lit;\n"
	"uniform usampler2D u_seen;      // view_gl_target\n"
	"uniform vec4 u_depth;           // a, b, whether there is a sky and ground\n"
	"out vec4 o_color;\n"
	"void main() {\n"
	"	vec2 size = vec2(textureSize(u_seen, 0));\n"
	"	uvec4 seen = texelFetch(u_seen, ivec2(min(v_at * size, size - 1.0)), 0);\n"
	"	float nearness = uintBitsToFloat(seen.z);\n"
	"	if (u_depth.w == 0.0 && seen.x == 0u && !is_summary(seen)) nearness = 0.0;\n"
	"	if (nearness == 0.0 && u_depth.z == 0.0) discard;\n"
	"	gl_FragDepth = nearness == 0.0 ? 1.0 : clamp(u_depth.x + u_depth.y * nearness, 0.0, 1.0);\n"
	"	o_color = vec4(texture(u_lit, v_at).rgb, 1.0);\n"
	"}\n";

enum eco_code web_present_prepare(struct web_present *p, struct eco_error *error)
{
	if (p->program)
		return ECO_OK;
	p->program = web_program(NULL, (const char *const[]){ present_text }, 1, "pictures", error);
	if (!p->program)
		return ECO_UNSUPPORTED;
	glGenVertexArrays(1, &p->vertex_array);
	return ECO_OK;
}

enum eco_code web_present_draw(struct web_present *p, unsigned lit, unsigned seen,
	const struct web_place *place, struct eco_error *error)
{
	enum eco_code code = web_present_prepare(p, error);
	if (code)
		return code;
	glUseProgram(p->program);
	web_program_texture(p->program, "u_lit", 0, lit);
	web_program_texture(p->program, "u_seen", 1, seen);
	glUniform4f(glGetUniformLocation(p->program, "u_depth"), place->depth[0], place->depth[1],
		place->sky, place->ground);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_LEQUAL);
	web_program_fill(p->vertex_array, place->viewport);
	return ECO_OK;
}

void web_present_free(struct web_present *p)
{
	glDeleteProgram(p->program);
	glDeleteVertexArrays(1, &p->vertex_array);
	*p = (struct web_present){ 0 };
}
