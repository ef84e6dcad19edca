/* The end of a request, decided by us. The HTTP library accepts Content-Length beside Transfer-Encoding, two
 * lengths, and odd header names; a proxy in front may read such a request in another way, and what one takes
 * for a body the other takes for a second request (smuggling). So: no Transfer-Encoding at all, at most one
 * Content-Length, bodies only where a route takes one; anything else is answered and the connection closed.
 *
 *   struct srv_framing framing = { 0 };
 *   srv_framing_header(&framing, name, name_size, value, value_size);      each header, in order
 *   problem = srv_framing_check(&framing, &error);
 *   problem = srv_framing_body(&framing, takes_body, body_max, &error); */
#ifndef SRV_FRAMING_H
#define SRV_FRAMING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/problem.h"

struct srv_framing {
	uint32_t lengths, transfers, header_count;
	bool bad_name, bad_value, bad_length, repeated;
	uint64_t length;                         /* of the body; 0 without a Content-Length */
	/* Values of the headers that matter, or NULL; 0-terminated, owned by the caller of
	 * srv_framing_header. */
	const char *range, *if_range, *if_none_match, *content_type, *host;
};

/* Names and values are 0-terminated behind their sizes. */
void srv_framing_header(struct srv_framing *framing, const char *name, size_t name_size, const char *value,
	size_t value_size);

/* SRV_PROBLEM_NONE, or what is wrong; every problem found here must close the connection. First whether it is
 * clear where the request ends, whatever it asks for; then whether its body may be there. */
enum srv_problem srv_framing_check(const struct srv_framing *framing, struct eco_error *error);
enum srv_problem srv_framing_body(const struct srv_framing *framing, bool takes_body, uint64_t body_max,
	struct eco_error *error);

#endif
