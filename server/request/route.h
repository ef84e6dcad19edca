/* The routes: one table of path patterns and methods. A pattern segment in braces is a variable. */
#ifndef SRV_ROUTE_H
#define SRV_ROUTE_H

#include <stdbool.h>

#include "server/request/target.h"

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

#endif
