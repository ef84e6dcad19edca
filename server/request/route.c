#include "server/request/route.h"

#include <string.h>

#define READ (SRV_METHOD_GET | SRV_METHOD_HEAD | SRV_METHOD_OPTIONS)

const struct srv_route srv_routes[SRV_RESOURCE_COUNT] = {
	[SRV_HEALTH] = { "/healthz", "GET, HEAD, OPTIONS", READ },
	[SRV_READY] = { "/readyz", "GET, HEAD, OPTIONS", READ },
	[SRV_METRICS] = { "/metrics", "GET, HEAD, OPTIONS", READ, .is_operators = true },
	[SRV_RELOAD] = { "/v1/admin/reload", "POST, OPTIONS", SRV_METHOD_POST | SRV_METHOD_OPTIONS,
		.is_operators = true },
	[SRV_SCENES] = { "/v1/scenes", "GET, HEAD, OPTIONS", READ },
	[SRV_SCENE] = { "/v1/scenes/{scene}", "GET, HEAD, OPTIONS", READ },
	[SRV_PLAN] = { "/v1/scenes/{scene}/plan", "GET, HEAD, OPTIONS", READ },
	[SRV_STREAM] = { "/v1/scenes/{scene}/stream", "GET, HEAD, POST, OPTIONS", READ | SRV_METHOD_POST },
	[SRV_CHUNK] = { "/v1/scenes/{scene}/chunks/{id}", "GET, HEAD, OPTIONS", READ },
	[SRV_PLANTS] = { "/v1/scenes/{scene}/plants/{list}", "GET, HEAD, OPTIONS", READ },
	[SRV_SPECIES] = { "/v1/scenes/{scene}/species", "GET, HEAD, OPTIONS", READ },
	[SRV_INDEX] = { "/", "GET, HEAD, OPTIONS", READ, .is_page = true },
	[SRV_ICON] = { "/favicon.ico", "GET, HEAD, OPTIONS", READ, .is_page = true },
	[SRV_VIEWER] = { "/viewer/{file}", "GET, HEAD, OPTIONS", READ, .is_page = true },
	[SRV_VIEWER_FILE] = { "/viewer/{version}/{file}", "GET, HEAD, OPTIONS", READ, .is_page = true },
};

enum srv_method srv_method_of(const char *name)
{
	return strcmp(name, "GET") == 0 ? SRV_METHOD_GET : strcmp(name, "HEAD") == 0 ? SRV_METHOD_HEAD
		: strcmp(name, "POST") == 0 ? SRV_METHOD_POST : strcmp(name, "OPTIONS") == 0
		? SRV_METHOD_OPTIONS : SRV_METHOD_OTHER;
}

static bool matches(const char *pattern, const struct srv_target *target, const char *variables[2])
{
	uint32_t segment = 0, variable = 0;
	for (; *pattern == '/' && pattern[1]; segment++) {
		size_t size = strcspn(++pattern, "/");
		if (segment == target->segment_count)
			return false;
		const char *text = target->segments[segment];
		if (*pattern == '{')
			variables[variable++] = text;
		else if (strlen(text) != size || memcmp(text, pattern, size) != 0)
			return false;
		pattern += size;
	}
	return segment == target->segment_count;
}

const struct srv_route *srv_route_find(const struct srv_target *target, const char *variables[2])
{
	for (int i = 0; i < SRV_RESOURCE_COUNT; i++) {
		variables[0] = variables[1] = NULL;
		if (matches(srv_routes[i].pattern, target, variables))
			return &srv_routes[i];
	}
	return NULL;
}
