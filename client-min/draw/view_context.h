/* An OpenGL context without a window, a display server or a surface: by view_egl.c EGL on a device, or Mesa's
 * surfaceless platform; in a browser, by web/web_context.c, the page's own. */
#pragma once

#include <stdbool.h>

#include "client-min/draw/view_shader.h"

struct view_context {
	void *display, *context;
	bool hardware;
	bool lazy;                       /* software that begins with a frame when it has all of it */
	struct view_dialect dialect;
	char renderer[128];
};

/* OpenGL 4.5 core of a hardware device, else of the surfaceless platform, else of a software device. The
 * context is current afterwards, on this thread. ECO_UNSUPPORTED names what was tried. */
enum eco_code view_context_open(struct view_context *context, struct eco_error *error);
void view_context_use(const struct view_context *context);    /* makes it current on this thread */
void view_context_close(struct view_context *context);
