/* view_context.h in a browser: the context that the page made current (GL.makeContextCurrent of emscripten)
 * is taken, and left to it. Depths are from 0 to 1, as ecoview's, where it can say so (eco_layer.mjs does).
 * */
#include <GLES3/gl3.h>
#include <emscripten/html5_webgl.h>
#include <stdio.h>
#include <string.h>

#include "client-min/draw/view_context.h"

#define MASKED "WebKit WebGL"            /* browsers that name no driver but by an extension */
#define UNMASKED_RENDERER 0x9246

enum eco_code view_context_open(struct view_context *context, struct eco_error *error)
{
	*context = (struct view_context){ .dialect.es = true };
	EMSCRIPTEN_WEBGL_CONTEXT_HANDLE current = emscripten_webgl_get_current_context();
	if (!current)
		return eco_fail(error, ECO_UNSUPPORTED, "the page has no WebGL 2");
	memcpy(&context->context, &current, sizeof current);
	context->display = context;
	context->dialect.depth_zero_to_one = emscripten_webgl_enable_extension(current, "EXT_clip_control");
	const char *name = (const char *)glGetString(GL_RENDERER);
	if (name && !strcmp(name, MASKED)
			&& emscripten_webgl_enable_extension(current, "WEBGL_debug_renderer_info"))
		name = (const char *)glGetString(UNMASKED_RENDERER);
	snprintf(context->renderer, sizeof context->renderer, "%s", name ? name : "unknown");
	context->lazy = strstr(context->renderer, "llvmpipe");
	context->hardware = !context->lazy && !strstr(context->renderer, "SwiftShader");
	return ECO_OK;
}

void view_context_use(const struct view_context *context)
{
	EMSCRIPTEN_WEBGL_CONTEXT_HANDLE ours;
	memcpy(&ours, &context->context, sizeof ours);
	emscripten_webgl_make_context_current(ours);
}

void view_context_close(struct view_context *context)
{
	*context = (struct view_context){ 0 };
}
