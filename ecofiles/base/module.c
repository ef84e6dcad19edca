#include "ecofiles/base/module.h"

#include <dlfcn.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Modules are loaded by dlopen, once each, under one lock. The lock is also held while a process forks, so
 * that no child (guard.h) begins while another thread is half way through loading a library. */

static const struct { const char *file, *symbol, *for_what, *package; } modules[ECO_MODULE_COUNT] = {
	[ECO_MODULE_ASSIMP] = { "ecoassimp.so", "eco_assimp_module", "models other than OBJ and glTF",
		"libassimp5" },
	[ECO_MODULE_CAIRO] = { "ecocairo.so", "eco_cairo_module", "maps", "libcairo2" },
	[ECO_MODULE_GDAL] = { "ecogdal.so", "eco_gdal_module", "rasters and tables with geometry",
	"libgdal32" }, [ECO_MODULE_IMAGE] = { "ecoimage.so", "eco_image_module", "pictures",
	"libopenimageio2.4" },
	[ECO_MODULE_PROJ] = { "ecoproj.so", "eco_proj_module", "coordinate reference systems", "libproj25" },
};

static pthread_mutex_t loading = PTHREAD_MUTEX_INITIALIZER;
static const void *loaded[ECO_MODULE_COUNT];

static void lock(void) { pthread_mutex_lock(&loading); }
static void unlock(void) { pthread_mutex_unlock(&loading); }
__attribute__((constructor)) static void hold_over_forks(void) { pthread_atfork(lock, unlock, unlock); }

/* In the build tree, of programs and of tests; and where `make install` puts modules, as seen from programs
 * (ECO_MODULES_INSTALLED, from the Makefile). */
static const char *const places[] = { "", "/..", "/" ECO_MODULES_INSTALLED, NULL };

bool eco_module_find(enum eco_module module, char path[PATH_MAX])
{
	const char *file = modules[module].file, *given = getenv(ECO_MODULES_VARIABLE);
	if (!given || !*given)
		return eco_data_path(places, file, path);
	return snprintf(path, PATH_MAX, "%s/%s", given, file) < PATH_MAX && access(path, F_OK) == 0;
}

static enum eco_code load(enum eco_module module, struct eco_error *error)
{
	const char *file = modules[module].file, *given = getenv(ECO_MODULES_VARIABLE);
	bool chosen = given && *given != 0;
	char path[PATH_MAX];
	if (!eco_module_find(module, path))
		return eco_fail(error, ECO_NOT_FOUND, "%s, needed for %s, is not %s%.200s: make builds it, "
			"make install installs it; " ECO_MODULES_VARIABLE " names the folder that holds it",
			file, modules[module].for_what, chosen ? "in " : "beside the program, in the folder "
			"above nor in " ECO_MODULES_INSTALLED " from there", chosen ? given : "");
	/* lazily: a child that reads a model would spend 50 ms on names that nothing calls */
	void *handle = dlopen(path, RTLD_LAZY | RTLD_LOCAL);
	if (!handle)
		return eco_fail(error, ECO_NOT_FOUND, "%s, needed for %s, cannot be loaded: %.250s (package "
			"%s installed?)", file, modules[module].for_what, dlerror(), modules[module].package);
	const uint32_t *table = dlsym(handle, modules[module].symbol);
	/* the module stays mapped even so: libraries such as these do not survive unloading */
	if (!table || *table != ECO_MODULE_VERSION)
		return eco_fail(error, ECO_NOT_FOUND, "%.200s belongs to another version of the program: "
			"make builds it again", path);
	loaded[module] = table;
	return ECO_OK;
}

const void *eco_module(enum eco_module module, struct eco_error *error)
{
	lock();
	if (!loaded[module])
		load(module, error);
	const void *table = loaded[module];
	unlock();
	return table;
}

bool eco_data_path(const char *const *at, const char *file, char path[PATH_MAX])
{
	char folder[PATH_MAX];
	ssize_t length = readlink("/proc/self/exe", folder, sizeof folder - 1);
	folder[length > 0 ? length : 0] = 0;
	char *slash = strrchr(folder, '/');
	if (!slash)
		return false;
	*slash = 0;
	for (; *at; at++)
		if (snprintf(path, PATH_MAX, "%s%s/%s", folder, *at, file) < PATH_MAX
				&& access(path, F_OK) == 0)
			return true;
	return false;
}
