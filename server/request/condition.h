/* Conditional and partial requests for immutable bytes (RFC 9110, sections 13 and 14). The HTTP library has
 * no part in it. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

/* The values of the request's headers, or NULL; owned by the HTTP library. */
struct srv_conditions {
	const char *range, *if_range, *if_match, *if_none_match, *if_unmodified_since;
};

enum srv_verdict {
	SRV_VERDICT_GO,
	SRV_VERDICT_NOT_MODIFIED,        /* 304 */
	SRV_VERDICT_FAILED               /* 412 */
};
/* The verdict of the preconditions on an answer with this tag (NULL: it has none), from a pack that was last
 * changed at `modified_s` (seconds since 1970; 0: not known), in the order of RFC 9110, 13.2.2. */
enum srv_verdict srv_conditions_judge(const struct srv_conditions *conditions, const char *etag,
	int64_t modified_s);

#define SRV_DATE_BYTES 30
void srv_date_format(char text[SRV_DATE_BYTES], int64_t at_s);       /* "Sun, 06 Nov 1994 08:49:37 GMT" */

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
/* Is it "*": whatever there is? */
bool srv_etag_any(const char *value);
