#include "client-min/web/web_present.h"

#include <GLES3/gl3.h>
#include <stddef.h>
#include <stdlib.h>

/* One triangle that covers the viewport; pictures have their first row at the top. */
static const char vertex_text[] = "#version 300 es\n"
	"out vec2 v_at;\n"
	"void main() {\n"
	"	vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;\n"
	"	v_at = vec2(corner.x, 1.0 - corner.y);\n"
	"	gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);\n"
	"}\n";
static const char fragment_text[] = "#version 300 es\n"
	"precision highp float;\n"
	"uniform sampler2D u_colors;\n"
	"uniform highp sampler2D u_depths;\n"
	"uniform vec3 u_depth;           // a, b, whether there is a sky\n"
	"in vec2 v_at;\n"
	"out vec4 o_color;\n"
	"void main() {\n"
	"	float nearness = texture(u_depths, v_at).r;\n"
	"	if (nearness == 0.0 && u_depth.z == 0.0) discard;\n"
	"	gl_FragDepth = nearness == 0.0 ? 1.0 : clamp(u_depth.x + u_depth.y * nearness, 0.0, 1.0);\n"
	"	o_color = vec4(texture(u_colors, v_at).rgb, 1.0);\n"
	"}\n";

static unsigned compile(unsigned type, const char *text)
{
	unsigned shader = glCreateShader(type);
	glShaderSource(shader, 1, &text, NULL);
	glCompileShader(shader);
	return shader;
}

static bool link(struct web_present *p)
{
	unsigned vertex = compile(GL_VERTEX_SHADER, vertex_text),
		fragment = compile(GL_FRAGMENT_SHADER, fragment_text);
	int linked = 0;
	p->program = glCreateProgram();
	glAttachShader(p->program, vertex);
	glAttachShader(p->program, fragment);
	glLinkProgram(p->program);
	glDeleteShader(vertex);
	glDeleteShader(fragment);
	glGetProgramiv(p->program, GL_LINK_STATUS, &linked);
	glUseProgram(p->program);
	glUniform1i(glGetUniformLocation(p->program, "u_colors"), 0);
	glUniform1i(glGetUniformLocation(p->program, "u_depths"), 1);
	glGenVertexArrays(1, &p->vertex_array);
	return linked;
}

static unsigned make_texture(unsigned format, uint32_t width, uint32_t height, int filter)
{
	unsigned texture;
	glGenTextures(1, &texture);
	glBindTexture(GL_TEXTURE_2D, texture);
	glTexStorage2D(GL_TEXTURE_2D, 1, format, (GLsizei)width, (GLsizei)height);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	return texture;
}

static void free_textures(struct web_present *p)
{
	const unsigned textures[2] = { p->colors, p->depths };
	glDeleteTextures(2, textures);
}

/* Depths of plants alone, for the caller to free; NULL: no memory. */
static float *without_ground(const struct view_picture *picture)
{
	size_t count = (size_t)picture->width * picture->height;
	float *depths = malloc(count * sizeof *depths);
	for (size_t i = 0; depths && i < count; i++)
		depths[i] = picture->cover[i] ? picture->depth[i] : 0;
	return depths;
}

static void upload(struct web_present *p, const struct view_picture *picture, const float *depths)
{
	if (p->width != picture->width || p->height != picture->height) {
		free_textures(p);
		p->colors = make_texture(GL_RGB8, picture->width, picture->height, GL_LINEAR);
		p->depths = make_texture(GL_R32F, picture->width, picture->height, GL_NEAREST);
		p->width = picture->width;
		p->height = picture->height;
	}
	glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
	glActiveTexture(GL_TEXTURE0);
	glBindTexture(GL_TEXTURE_2D, p->colors);
	glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, (GLsizei)p->width, (GLsizei)p->height, GL_RGB,
		GL_UNSIGNED_BYTE, picture->rgb);
	glActiveTexture(GL_TEXTURE1);
	glBindTexture(GL_TEXTURE_2D, p->depths);
	glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, (GLsizei)p->width, (GLsizei)p->height, GL_RED, GL_FLOAT,
		depths);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
}

enum eco_code web_present_draw(struct web_present *p, const struct view_picture *picture,
	const struct web_place *place, struct eco_error *error)
{
	if (!p->program && !link(p))
		return eco_fail(error, ECO_UNSUPPORTED, "the graphics driver does not compile the "
			"shader that shows pictures");
	float *plants = place->ground ? NULL : without_ground(picture);
	if (!place->ground && !plants)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture without its ground");
	upload(p, picture, plants ? plants : picture->depth);
	free(plants);
	glUseProgram(p->program);
	glUniform3f(glGetUniformLocation(p->program, "u_depth"), place->depth[0], place->depth[1],
		place->sky ? 1 : 0);
	glBindVertexArray(p->vertex_array);
	glViewport(place->viewport[0], place->viewport[1], place->viewport[2], place->viewport[3]);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_LEQUAL);
	glDrawArrays(GL_TRIANGLES, 0, 3);
	glBindVertexArray(0);
	return ECO_OK;
}

void web_present_free(struct web_present *p)
{
	free_textures(p);
	glDeleteProgram(p->program);
	glDeleteVertexArrays(1, &p->vertex_array);
	*p = (struct web_present){ 0 };
}
