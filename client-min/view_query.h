/* A request as the query string of a URL: what view_fetch.h and a browser ask a server. */
#pragma once

#include "ecofiles/format/pack.h"
#include "ecofiles/format/view.h"

/* Without '?': numbers with 17 digits, so that the server sees the same doubles. pack: of what is held, or
 * NULL. Returns the length; nothing is written beyond `room`, for which VIEW_QUERY_BYTES are always enough.
 * */
#define VIEW_QUERY_BYTES 960
size_t view_query_write(const struct eco_request *request, const struct eco_chunk_id *pack, char *out,
	size_t room);
