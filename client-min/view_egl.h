/* An OpenGL context without a window, a display server or a surface: EGL on a device, or Mesa's surfaceless
 * platform. */
#ifndef VIEW_EGL_H
#define VIEW_EGL_H

#include <stdbool.h>

#include "client-min/view_shader.h"

struct view_egl {
	void *display, *context;
	bool hardware;
	struct view_dialect dialect;
	char renderer[128];
};

/* Tries hardware devices, then the surfaceless platform, then software devices; OpenGL 4.5 core, then OpenGL
 * ES 3.2. The context is current afterwards, on this thread. ECO_UNSUPPORTED names what was tried. */
enum eco_code view_egl_open(struct view_egl *egl, struct eco_error *error);
void view_egl_use(const struct view_egl *egl);    /* makes it current on this thread */
void view_egl_close(struct view_egl *egl);

#endif
