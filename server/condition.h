/* Conditional and partial requests for immutable bytes (RFC 9110, sections 13 and 14). The HTTP library has
 * no part in it. */
#ifndef SRV_CONDITION_H
#define SRV_CONDITION_H

#include <stdbool.h>
#include <stdint.h>

/* The values of the request's headers, or NULL; owned by the HTTP library. */
struct srv_conditions { const char *range, *if_range, *if_none_match; };

enum srv_range_kind {
	/* no, a malformed or a multiple range, or another unit: the whole, status 200 */
	SRV_RANGE_ALL,
	SRV_RANGE_PART,          /* [first, end): status 206 */
	SRV_RANGE_OUTSIDE        /* nothing of it exists: status 416 */
};
struct srv_range { enum srv_range_kind kind; uint64_t first, end; };

/* Reads the value of a Range header (NULL: none) for a representation of `size` bytes: "bytes=a-b",
 * "bytes=a-" or "bytes=-n". */
struct srv_range srv_range_parse(const char *value, uint64_t size);

/* Does an If-None-Match value (NULL: false) name `etag` (with its quotes)? A list, "*" and weak tags
 * (W/"...") count. */
bool srv_etag_match(const char *value, const char *etag);

#endif
