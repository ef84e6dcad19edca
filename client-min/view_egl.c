#include "client-min/view_egl.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <stdio.h>
#include <string.h>

#define DEVICES_MAX 16

static bool create(struct view_egl *egl, EGLDisplay display, bool es)
{
	if (!eglBindAPI(es ? EGL_OPENGL_ES_API : EGL_OPENGL_API))
		return false;
	const EGLint core[] = { EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5,
		EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE };
	const EGLint embedded[] = { EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 2, EGL_NONE };
	EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT,
		es ? embedded : core);
	if (context == EGL_NO_CONTEXT)
		return false;
	if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
		eglDestroyContext(display, context);
		return false;
	}
	egl->display = display;
	egl->context = context;
	egl->dialect.es = es;
	return true;
}

static bool open_display(struct view_egl *egl, EGLDisplay display)
{
	EGLint major, minor;
	if (display == EGL_NO_DISPLAY || !eglInitialize(display, &major, &minor))
		return false;
	if (epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context") &&
		(epoxy_has_egl_extension(display, "EGL_KHR_no_config_context") ||
			epoxy_has_egl_extension(display, "EGL_MESA_configless_context")) &&
		(create(egl, display, false) || create(egl, display, true)))
		return true;
	eglTerminate(display);
	return false;
}

static bool is_software(EGLDeviceEXT device)
{
	const char *extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
	return extensions && strstr(extensions, "EGL_MESA_device_software");
}

static bool open_device(struct view_egl *egl, bool software)
{
	EGLDeviceEXT devices[DEVICES_MAX];
	EGLint count = 0;
	if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device") ||
		!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") ||
		!eglQueryDevicesEXT(DEVICES_MAX, devices, &count))
		return false;
	for (EGLint i = 0; i < count; i++)
		if (is_software(devices[i]) == software &&
			open_display(egl,
			eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL)))
			return true;
	return false;
}

static bool open_surfaceless(struct view_egl *egl)
{
	return epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless") && open_display(egl,
		eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL));
}

enum eco_code view_egl_open(struct view_egl *egl, struct eco_error *error)
{
	*egl = (struct view_egl){ 0 };
	if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base") ||
		!(open_device(egl, false) || open_surfaceless(egl) || open_device(egl, true)))
		return eco_fail(error, ECO_UNSUPPORTED, "no OpenGL 4.5 or OpenGL ES 3.2 without a window: "
			"tried EGL devices and Mesa's surfaceless "
			"platform (Debian: libegl1, libgl1-mesa-dri)");
	const char *name = (const char *)glGetString(GL_RENDERER);
	snprintf(egl->renderer, sizeof egl->renderer, "%s", name ? name : "unknown");
	egl->hardware = !strstr(egl->renderer, "llvmpipe") && !strstr(egl->renderer, "softpipe")
		&& !strstr(egl->renderer, "SwiftShader");
	egl->dialect.depth_zero_to_one = egl->dialect.es ? epoxy_has_gl_extension("GL_EXT_clip_control")
		: true;
	return ECO_OK;
}

void view_egl_use(const struct view_egl *egl)
{
	if (eglGetCurrentContext() != egl->context)
		eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, egl->context);
}

/* The display is one for all contexts of a process and is left to it. */
void view_egl_close(struct view_egl *egl)
{
	if (!egl->display)
		return;
	eglMakeCurrent(egl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
	eglDestroyContext(egl->display, egl->context);
	*egl = (struct view_egl){ 0 };
}
