#include "server/caps.h"

#include <string.h>

#include "server/reload.h"
#include "server/request/query.h"

enum eco_code srv_cap_add(struct srv_cap_list *list, const char *argument, enum eco_option_kind kind,
	const char *option, struct eco_error *error)
{
	struct srv_cap cap = { .most = 0 };
	const char *end;
	const char *equals = strchr(argument, '='), *number = equals ? equals + 1 : argument;
	size_t size = equals ? (size_t)(equals - argument) : 0;
	if (size < sizeof cap.scene)
		memcpy(cap.scene, argument, size);
	if ((equals && !srv_name_valid(cap.scene)) || !eco_count_read(number, kind, &cap.most, &end) ||
		*end || !cap.most)
		return eco_fail(error, ECO_BAD_USAGE,
			"--%s %.100s: must be N or SCENE=N, N a whole number above 0, "
			"perhaps with k, M or G behind it, as in 64M",
			option, argument);
	if (list->count == SRV_CAPS_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "more than %u caps: --%s; one without SCENE= is for "
			"all", SRV_CAPS_MAX, option);
	list->items[list->count++] = cap;
	return ECO_OK;
}

static enum eco_code check(const struct srv_cap_list *list, const char *option, const struct srv_store *store,
	const struct srv_sources *sources, struct eco_error *error)
{
	for (uint32_t i = 0; i < list->count; i++)
		if (list->items[i].scene[0] && !srv_store_find(store, list->items[i].scene)
				&& !srv_sources_name(sources, list->items[i].scene))
			return eco_fail(error, ECO_BAD_USAGE, "--%s %s=%llu: there is no scene of this name",
				option, list->items[i].scene, (unsigned long long)list->items[i].most);
	return ECO_OK;
}

enum eco_code srv_caps_check(const struct srv_caps *caps, const struct srv_store *store,
	const struct srv_sources *sources, struct eco_error *error)
{
	if (!caps)
		return ECO_OK;
	enum eco_code code = check(&caps->vertices, "cap-vertices", store, sources, error);
	return code ? code : check(&caps->bytes, "cap-bytes", store, sources, error);
}

static uint64_t most_of(const struct srv_cap_list *list, const char *scene)
{
	uint64_t all = UINT64_MAX, own = 0;
	for (uint32_t i = 0; i < list->count; i++)
		if (!list->items[i].scene[0])
			all = list->items[i].most;
		else if (strcmp(list->items[i].scene, scene) == 0)
			own = list->items[i].most;
	return own ? own : all;
}

struct srv_most srv_caps_of(const struct srv_caps *caps, const char *scene)
{
	return caps ? (struct srv_most){ most_of(&caps->vertices, scene), most_of(&caps->bytes, scene) }
		: (struct srv_most){ UINT64_MAX, UINT64_MAX };
}

void srv_caps_apply(const struct srv_most *most, struct eco_request *request)
{
	if (request->vertices > most->vertices)
		request->vertices = most->vertices;
	if (request->bytes > most->bytes)
		request->bytes = most->bytes;
}
