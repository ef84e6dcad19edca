/* A request target, taken apart strictly. The HTTP library's own idea of a path turns %00 into an end of
 * string, keeps %zz, and hands /../.. through; here an allow-list decides. Paths are segments of
 * [A-Za-z0-9_-][A-Za-z0-9._-]*, without percent-encoding. Parameters are name=value with a name of [a-z_]+; a
 * value is printable ASCII after percent-decoding ("%2C" is what browsers make of a comma). No parameter may
 * be empty or occur twice. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

#define SRV_TARGET_BYTES_MAX 2048u
#define SRV_SEGMENTS_MAX 8u
#define SRV_PARAMS_MAX 24u

struct srv_param { const char *name, *value; };     /* 0-terminated, inside `text` */

struct srv_target {
	uint32_t segment_count, param_count;
	const char *segments[SRV_SEGMENTS_MAX];
	struct srv_param params[SRV_PARAMS_MAX];
	char text[SRV_TARGET_BYTES_MAX + 1];            /* decoded parts, each ended by a 0 */
};

/* Parses `size` bytes of origin-form ("/v1/scenes?x=1") or absolute-form ("http://host/...") target.
 * ECO_TOO_LARGE beyond the sizes above, ECO_BAD_INPUT for anything malformed. Points into itself: do not
 * copy. */
enum eco_code srv_target_parse(struct srv_target *target, const char *raw, size_t size,
	struct eco_error *error);

/* ":PORT", a number up to 65535 in at most five digits. */
bool srv_port_valid(const char *text, size_t size);
/* Is it a host name or address (IPv6 in brackets), with or without ":port"? No userinfo, no empty name. */
bool srv_authority_valid(const char *text, size_t size);

/* Value of a parameter, or NULL. */
const char *srv_target_param(const struct srv_target *target, const char *name);

/* ---- Routes ---- */

/* One table of path patterns and methods. A pattern segment in braces is a variable. */

enum srv_method { SRV_METHOD_GET = 1, SRV_METHOD_HEAD = 2, SRV_METHOD_POST = 4, SRV_METHOD_OPTIONS = 8,
	SRV_METHOD_OTHER = 0 };
enum srv_resource {
	SRV_HEALTH,
	SRV_READY,
	SRV_METRICS,
	SRV_RELOAD,
	SRV_SCENES,
	SRV_SCENE,
	SRV_PLAN,
	SRV_STREAM,
	SRV_CHUNK,
	SRV_PLANTS,
	SRV_FIND,
	SRV_SPECIES,
	SRV_INDEX,
	SRV_ICON,
	SRV_VIEWER,
	SRV_VIEWER_FILE,
	SRV_RESOURCE_COUNT
};

struct srv_route {
	const char *pattern;
	const char *allow;           /* value of the Allow header */
	unsigned methods;            /* enum srv_method; HEAD goes with GET, OPTIONS with all */
	bool is_operators;           /* and nobody else's */
	bool is_page;                /* for people, whose links may have parameters that others appended */
};
extern const struct srv_route srv_routes[SRV_RESOURCE_COUNT];

enum srv_method srv_method_of(const char *name);

/* The route of a path, or NULL; variables[i] is the i-th variable's text, in the pattern's order (at most 2).
 */
const struct srv_route *srv_route_find(const struct srv_target *target, const char *variables[2]);
