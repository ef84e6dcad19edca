#include "server/framing.h"

#include <string.h>
#include <strings.h>

#include "server/query.h"

#define HEADERS_MAX 100u

/* A token of RFC 9110, 5.6.2. */
static bool is_token(const char *text, size_t size)
{
	for (size_t i = 0; i < size; i++) {
		char c = text[i];
		if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')
				|| (c && strchr("!#$%&'*+-.^_`|~", c))))
			return false;
	}
	return size > 0;
}

static bool is_field_value(const char *text, size_t size)
{
	for (size_t i = 0; i < size; i++)
		if (((unsigned char)text[i] < 0x20 && text[i] != '\t') || text[i] == 0x7f)
			return false;
	return true;
}

static void take_once(struct srv_framing *framing, const char **field, const char *value)
{
	if (*field)
		framing->repeated = true;
	*field = value;
}

void srv_framing_header(struct srv_framing *framing, const char *name, size_t name_size, const char *value,
	size_t value_size)
{
	framing->header_count++;
	if (!is_token(name, name_size)) {
		framing->bad_name = true;
		return;
	}
	if (!value || !is_field_value(value, value_size)) {
		framing->bad_value = true;
		return;
	}
	/* By prefix: libmicrohttpd 0.9.75 appends what follows a folded line to the name,
	 * "Transfer-Encoding:\r\n chunked" arrives as "Transfer-Encodingchunked". */
	if (strncasecmp(name, "content-length", 14) == 0) {
		framing->lengths++;
		if (name_size != 14 || !srv_parse_count(value, &framing->length))
			framing->bad_length = true;
	} else if (strncasecmp(name, "transfer-encoding", 17) == 0) {
		framing->transfers++;
	} else if (strcasecmp(name, "range") == 0) {
		take_once(framing, &framing->range, value);
	} else if (strcasecmp(name, "if-range") == 0) {
		take_once(framing, &framing->if_range, value);
	} else if (strcasecmp(name, "content-type") == 0) {
		take_once(framing, &framing->content_type, value);
	} else if (strcasecmp(name, "host") == 0) {
		take_once(framing, &framing->host, value);
	} else if (strcasecmp(name, "if-none-match") == 0 && !framing->if_none_match) {
		/* may be repeated; the first one alone can only cost a transfer */
		framing->if_none_match = value;
	}
}

static enum srv_problem fail(struct eco_error *error, enum srv_problem problem, const char *text)
{
	eco_fail(error, ECO_BAD_INPUT, "%s", text);
	return problem;
}

enum srv_problem srv_framing_check(const struct srv_framing *framing, struct eco_error *error)
{
	if (framing->bad_name)
		return fail(error, SRV_PROBLEM_FRAMING, "a header name is not a token");
	if (framing->bad_value)
		return fail(error, SRV_PROBLEM_FRAMING, "a header value contains control characters");
	if (framing->repeated)
		return fail(error, SRV_PROBLEM_FRAMING, "Host, Content-Type, Range and If-Range may be "
			"given once");
	if (framing->header_count > HEADERS_MAX)
		return fail(error, SRV_PROBLEM_FRAMING, "too many headers");
	if (framing->transfers)
		return fail(error, SRV_PROBLEM_FRAMING, "Transfer-Encoding is not accepted: send the body "
			"with a Content-Length");
	if (framing->lengths > 1)
		return fail(error, SRV_PROBLEM_FRAMING, "Content-Length is given more than once");
	if (framing->bad_length)
		return fail(error, SRV_PROBLEM_FRAMING, "Content-Length is not a decimal number");
	return SRV_PROBLEM_NONE;
}

enum srv_problem srv_framing_body(const struct srv_framing *framing, bool takes_body, uint64_t body_max,
	struct eco_error *error)
{
	if (!takes_body && framing->length > 0)
		return fail(error, SRV_PROBLEM_FRAMING, "this resource takes no body with this method");
	if (takes_body && !framing->lengths)
		return fail(error, SRV_PROBLEM_LENGTH_REQUIRED, "send the holdings as the body, with a "
			"Content-Length");
	if (takes_body && framing->length > body_max) {
		eco_fail(error, ECO_TOO_LARGE, "the body has %llu bytes; at most %llu are accepted",
			(unsigned long long)framing->length, (unsigned long long)body_max);
		return SRV_PROBLEM_BODY_TOO_LARGE;
	}
	return SRV_PROBLEM_NONE;
}
