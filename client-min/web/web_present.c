#include "client-min/web/web_present.h"

#include <GLES3/gl3.h>
#include <stddef.h>

#include "client-min/web/web_program.h"

static const char fragment_text[] = WEB_IS_SUMMARY
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
	p->program = web_program(NULL, (const char *const[]){ fragment_text }, 1, "pictures", error);
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
