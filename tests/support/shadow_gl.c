#include "tests/support/shadow_gl.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>

#include "client-min/draw/view_gpu.h"
#include "tests/support/unit_test.h"

static unsigned put_rows(const struct view_shadow *shadow)
{
	unsigned texture = view_gpu_texture(GL_RGBA32UI, 4, 1, GL_NEAREST);
	glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 4, 1, GL_RGBA_INTEGER, GL_UNSIGNED_INT, shadow->row);
	return texture;
}

static float *cast_by_gl(struct view_gl *gl, const struct view_shadow_job *job,
	const struct view_shadow *shadow)
{
	float *depths = malloc(sizeof *depths * job->size * job->size);
	unsigned framebuffer, rows = put_rows(shadow),
		depth = view_gpu_texture(GL_DEPTH_COMPONENT32F, job->size, job->size, GL_NEAREST);
	const unsigned textures[] = { rows, depth };
	struct eco_error error = { 0 };
	glGenFramebuffers(1, &framebuffer);
	glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth, 0);
	struct view_gl_map map = { job->store, job->casters, job->eye, framebuffer, rows, job->size };
	assert_ok(view_gl_cast(gl, &map, &error), error);
	glReadPixels(0, 0, (int)job->size, (int)job->size, GL_DEPTH_COMPONENT, GL_FLOAT, depths);
	glDeleteFramebuffers(1, &framebuffer);
	glDeleteTextures(2, textures);
	return depths;
}

static size_t compare_tops(const struct view_shadow *shadow, const float *depths, const char *name)
{
	size_t covered = 0, apart = 0, count = (size_t)shadow->size * shadow->size;
	for (size_t i = 0; i < count; i++) {
		float top = shadow->top[i], part = 2 * depths[i] - 1;
		bool is = top > -INFINITY, there = depths[i] > 0;
		covered += is || there;
		apart += is != there || (is && fabsf(64 * part / (1 - fabsf(part)) - top) > 0.02f);
	}
	print_message("%s: of %zu texels %zu differ\n", name, covered, apart);
	assert_true(apart * 200 <= covered);
	return covered;
}

size_t shadow_gl_compare(struct view_gl *gl, const struct view_shadow_job *job, const char *name)
{
	struct view_shadow shadow;
	struct eco_error error = { 0 };
	assert_ok(view_shadow_make(&shadow, job, &error), error);
	float *depths = cast_by_gl(gl, job, &shadow);
	size_t covered = compare_tops(&shadow, depths, name);
	free(depths);
	view_shadow_free(&shadow);
	return covered;
}
