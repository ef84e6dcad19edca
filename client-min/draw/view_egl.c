#include "client-min/draw/view_context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <stdio.h>
#include <string.h>

#define DEVICES_MAX 16

static bool create(struct view_context *context, EGLDisplay display)
{
	const EGLint core[] = { EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5,
		EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE };
	if (!eglBindAPI(EGL_OPENGL_API))
		return false;
	EGLContext made = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, core);
	if (made == EGL_NO_CONTEXT)
		return false;
	if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, made)) {
		eglDestroyContext(display, made);
		return false;
	}
	context->display = display;
	context->context = made;
	return true;
}

static bool open_display(struct view_context *context, EGLDisplay display)
{
	EGLint major, minor;
	if (display == EGL_NO_DISPLAY || !eglInitialize(display, &major, &minor))
		return false;
	if (epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context") &&
		(epoxy_has_egl_extension(display, "EGL_KHR_no_config_context") ||
			epoxy_has_egl_extension(display, "EGL_MESA_configless_context")) &&
		create(context, display))
		return true;
	eglTerminate(display);
	return false;
}

static bool is_software(EGLDeviceEXT device)
{
	const char *extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
	return extensions && strstr(extensions, "EGL_MESA_device_software");
}

static bool open_device(struct view_context *context, bool software)
{
	EGLDeviceEXT devices[DEVICES_MAX];
	EGLint count = 0;
	if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device") ||
		!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") ||
		!eglQueryDevicesEXT(DEVICES_MAX, devices, &count))
		return false;
	for (EGLint i = 0; i < count; i++)
		if (is_software(devices[i]) == software &&
			open_display(context,
			eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL)))
			return true;
	return false;
}

static bool open_surfaceless(struct view_context *context)
{
	return epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless") && open_display(
		context, eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL));
}

enum eco_code view_context_open(struct view_context *context, struct eco_error *error)
{
	*context = (struct view_context){ 0 };
	if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base") ||
		!(open_device(context, false) || open_surfaceless(context) || open_device(context, true)))
		return eco_fail(error, ECO_UNSUPPORTED, "no OpenGL 4.5 without a window: "
			"tried EGL devices and Mesa's surfaceless "
			"platform (Debian: libegl1, libgl1-mesa-dri)");
	const char *name = (const char *)glGetString(GL_RENDERER);
	snprintf(context->renderer, sizeof context->renderer, "%s", name ? name : "unknown");
	context->lazy = strstr(context->renderer, "llvmpipe");
	context->hardware = !context->lazy && !strstr(context->renderer, "softpipe")
		&& !strstr(context->renderer, "SwiftShader");
	context->dialect.depth_zero_to_one = true;
	glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
	glEnable(GL_PROGRAM_POINT_SIZE);
	return ECO_OK;
}

void view_context_use(const struct view_context *context)
{
	if (eglGetCurrentContext() != context->context)
		eglMakeCurrent(context->display, EGL_NO_SURFACE, EGL_NO_SURFACE, context->context);
}

/* The display is one for all contexts of a process and is left to it. */
void view_context_close(struct view_context *context)
{
	if (!context->display)
		return;
	eglMakeCurrent(context->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
	eglDestroyContext(context->display, context->context);
	*context = (struct view_context){ 0 };
}
