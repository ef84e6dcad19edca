/* Which folders a make needs: nothing that a scene names is among them unless it lies below its own. */
#include <limits.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/base/confine.h"
#include "ecofiles/ecopack/make.h"

static void folder_of(char folder[PATH_MAX], const char *path)
{
	const char *slash = strrchr(path, '/');
	snprintf(folder, PATH_MAX, "%.*s", slash ? (int)(slash - path + 1) : 1, slash ? path : ".");
}

enum eco_code make_confine(const struct make_options *options, const char *folder, struct eco_error *error)
{
	static char scene[PATH_MAX], pack[PATH_MAX];
	static const char *readable[] = { NULL, NULL }, *writable[] = { pack, NULL, NULL };
	folder_of(scene, options->scene);
	folder_of(pack, options->pack);
	readable[0] = *folder ? folder : scene;
	if (options->cache && *options->cache && main_cache_make(options->cache))
		writable[1] = options->cache;
	const struct eco_confined_paths paths = { .readable = readable, .writable = writable };
	enum eco_code code = eco_confine(&paths, error);
	if (!code && !eco_confined_may_read(options->scene))
		code = eco_fail(error, ECO_BAD_USAGE, "%.200s does not lie below %.200s, to which --confine "
			"keeps reading", options->scene, readable[0]);
	return code;
}
