#include "client-min/view_sky.h"

#include <stdbool.h>
#include <string.h>

#include "ecofiles/base/options.h"

enum eco_code view_sky_read_shadows(const char *text, void *sky, struct eco_error *error)
{
	static const char *const names[] = { [VIEW_SHADOWS_STANDARD] = "standard",
		[VIEW_SHADOWS_PERSPECTIVE] = "perspective" };
	struct view_sky *out = sky;
	size_t length = strcspn(text, ",");
	const char *rest = text + length;
	uint64_t size = VIEW_SHADOW_SIZE;
	const char *end;
	for (int i = VIEW_SHADOWS_STANDARD; i <= VIEW_SHADOWS_PERSPECTIVE; i++)
		if (length == strlen(names[i]) && strncmp(text, names[i], length) == 0)
			out->shadows = (enum view_shadows)i;
	bool good = !*rest || (eco_count_read(rest + 1, ECO_OPTION_COUNT, &size, &end) && !*end
		&& size >= VIEW_SHADOW_SIZE_MIN && size <= VIEW_SHADOW_SIZE_MAX);
	if (!out->shadows || !good)
		return eco_fail(error, ECO_BAD_USAGE, "--shadows %.60s: must be standard or perspective, with "
			"or without the map's size of %u to %u texels, such as perspective,2048", text,
			VIEW_SHADOW_SIZE_MIN, VIEW_SHADOW_SIZE_MAX);
	out->shadow_size = (uint32_t)size;
	return ECO_OK;
}
