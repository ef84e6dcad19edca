/* Writes JSON into a growing buffer by formats that look like it:
 *
 *   srv_json_add(&json, "{scene:%s at:[%g %g] cuts:[", name, x, y);
 *   for (...) srv_json_add(&json, "{list:%u scale:%.9g}", cut->list, cut->scale);
 *   srv_json_add(&json, "]}");
 *
 * A writer of our own, because counts go up to 2^64 and plans have ten thousands of cuts, which a tree of
 * objects would hold twice. Nothing more is written once json.out.failed is set: without memory, beyond
 * `most`, or when it is cancelled. Long loops end then; srv_json_end says why. */
#ifndef SRV_JSON_H
#define SRV_JSON_H

#include <stdatomic.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/base/status.h"

struct srv_json {
	struct eco_writer out;
	bool comma;                  /* the next value or key follows another */
	size_t most;                 /* bytes, about; 0: any number */
	const atomic_bool *cancelled;        /* or NULL */
};

/* Adds what `format` shows: brackets; keys of a-z and '_', with ':'; null; and values:
 *   %s text, NULL is null; bytes that are not UTF-8 become U+FFFD     %d bool
 *   %u, %lu count (unsigned, uint64_t)     %lx the same, null if it is UINT64_MAX
 *   %g the shortest number that reads back the same     %.9g nine digits, in a third of the time
 * Numbers that are not finite are null. Quotes and commas come by themselves; spaces separate words. */
void srv_json_add(struct srv_json *json, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* ECO_INTERRUPTED, ECO_TOO_LARGE or ECO_NO_MEMORY where it is not whole; frees it then. */
enum eco_code srv_json_end(struct srv_json *json);

#endif
