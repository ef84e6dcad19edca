#include "client-min/web/web_mean.h"

#include <GLES3/gl3.h>
#include <emscripten/html5_webgl.h>

#include "client-min/draw/view_gpu.h"
#include "client-min/web/web_program.h"

static const char text[] =
#include "build/text/client-min/web/web_mean.glsl"
	;

/* WebGL draws floats only where a page asks for these extensions. */
static bool can_sum(struct web_mean *mean)
{
	EMSCRIPTEN_WEBGL_CONTEXT_HANDLE page = emscripten_webgl_get_current_context();
	mean->halves = !emscripten_webgl_enable_extension(page, "EXT_color_buffer_float")
		|| !emscripten_webgl_enable_extension(page, "EXT_float_blend");
	return emscripten_webgl_enable_extension(page, "EXT_color_buffer_float")
		|| emscripten_webgl_enable_extension(page, "EXT_color_buffer_half_float");
}

static void free_sums(struct web_mean *mean)
{
	glDeleteTextures(1, &mean->sums);
	glDeleteFramebuffers(1, &mean->framebuffer);
	mean->sums = mean->framebuffer = 0;
}

static bool make_sums(struct web_mean *mean, uint32_t width, uint32_t height)
{
	free_sums(mean);
	mean->width = width;
	mean->height = height;
	mean->sums = view_gpu_texture(mean->halves ? GL_RGBA16F : GL_RGBA32F, width, height, GL_NEAREST);
	glGenFramebuffers(1, &mean->framebuffer);
	glBindFramebuffer(GL_FRAMEBUFFER, mean->framebuffer);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, mean->sums, 0);
	return glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

bool web_mean_prepare(struct web_mean *mean, const struct web_lit *lit, uint32_t count)
{
	if (!mean->program && !mean->refused && can_sum(mean))
		mean->program = web_program(NULL, (const char *const[]){ text }, 1, "samples", NULL);
	bool made = mean->sums && mean->width == lit->width && mean->height == lit->height;
	mean->refused = !mean->program || (!made && !make_sums(mean, lit->width, lit->height));
	return !mean->refused && !(mean->halves && count > WEB_MEAN_HALVES_MAX);
}

static void draw(const struct web_mean *mean, const struct web_lit *lit, unsigned from, uint32_t count)
{
	glUseProgram(mean->program);
	web_program_texture(mean->program, "u_from", 0, from);
	glUniform1f(glGetUniformLocation(mean->program, "u_count"), (float)count);
	web_program_fill(lit->vertex_array, (const int[4]){ 0, 0, (int)lit->width, (int)lit->height });
}

static void add(const struct web_mean *mean, const struct web_lit *lit)
{
	glBindFramebuffer(GL_FRAMEBUFFER, mean->framebuffer);
	glEnable(GL_BLEND);
	glBlendEquation(GL_FUNC_ADD);
	glBlendFunc(GL_ONE, GL_ONE);
	draw(mean, lit, lit->texture, 0);
	glDisable(GL_BLEND);
}

void web_mean_first(const struct web_mean *mean, const struct web_lit *lit)
{
	glBindFramebuffer(GL_FRAMEBUFFER, mean->framebuffer);
	glClearBufferfv(GL_COLOR, 0, (const float[]){ 0, 0, 0, 0 });
	add(mean, lit);
}

void web_mean_add(const struct web_mean *mean, const struct web_lit *lit, uint32_t count)
{
	add(mean, lit);
	glBindFramebuffer(GL_FRAMEBUFFER, lit->framebuffer);
	draw(mean, lit, mean->sums, count);
}

void web_mean_free(struct web_mean *mean)
{
	free_sums(mean);
	glDeleteProgram(mean->program);
	*mean = (struct web_mean){ 0 };
}
