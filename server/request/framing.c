#include "server/request/framing.h"

#include <string.h>

#include "server/request/query.h"
#include "server/request/target.h"

enum field { FIELD_HOST, FIELD_LENGTH, FIELD_COOKIE, FIELD_TRANSFER, FIELD_EXPECT,
	FIELD_ONCE = FIELD_EXPECT };

/* Headers that count here. Those from FIELD_ONCE on may be given once, for two could be read in two ways. */
static const char *const fields[] = { [FIELD_HOST] = "host", [FIELD_LENGTH] = "content-length",
	[FIELD_COOKIE] = "cookie", [FIELD_TRANSFER] = "transfer-encoding", [FIELD_EXPECT] = "expect",
	"content-type", "range", "if-range", "if-match", "if-none-match", "if-modified-since", "if-unmodified-since",
	"content-range", "authorization" };
#define ENTRY_BYTES 56u
#define FIELD_COUNT (int)(sizeof fields / sizeof *fields)

/* A token of RFC 9110, 5.6.2. */
static bool is_token(char c)
{
	return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9')
		|| (c && strchr("!#$%&'*+-.^_`|~", c));
}

static bool is_printable(char c)
{
	return (unsigned char)c > 0x20 && c != 0x7f;
}

static bool refuse(struct srv_framing *framing, enum srv_problem problem, const char *detail)
{
	framing->state = SRV_AT_PROBLEM;
	framing->problem = problem;
	framing->detail = detail;
	return false;
}

static bool malformed(struct srv_framing *framing, const char *detail)
{
	return refuse(framing, SRV_PROBLEM_FRAMING, detail);
}

/* ---- The request line ---- */

static void begin_head(struct srv_framing *framing)
{
	*framing = (struct srv_framing){ .state = SRV_AT_METHOD,
		.heads = framing->heads,
		.size = framing->size,
		.memory = framing->size };
}

static bool take_method(struct srv_framing *framing, char c)
{
	if (c == ' ' && framing->name_size) {
		framing->is_head = framing->name_size == 4 && memcmp(framing->name, "HEAD", 4) == 0;
		framing->name_size = 0;
		framing->state = SRV_AT_TARGET;
		return true;
	}
	if (!((c >= 'A' && c <= 'Z') || c == '-' || c == '_'))
		return malformed(framing,
			"a request begins with a method in capitals, as GET, and one space");
	if (framing->name_size == sizeof framing->name)
		return malformed(framing, "the method is too long");
	framing->name[framing->name_size++] = c;
	return true;
}

static bool take_target(struct srv_framing *framing, char c)
{
	if (c == ' ' && framing->target_size) {
		framing->state = SRV_AT_VERSION;
		return true;
	}
	if (!is_printable(c))
		return malformed(framing,
			"the request line is METHOD TARGET HTTP/1.1 with one space between, "
			"and a target has neither spaces nor control characters");
	if (++framing->target_size >= SRV_TARGET_BYTES_MAX)
		return refuse(framing, SRV_PROBLEM_TARGET_TOO_LONG, "the request target is too long");
	framing->params += c == '&';
	framing->memory += c == '&' || c == '?' ? ENTRY_BYTES : 0;
	if (framing->params >= SRV_PARAMS_MAX)
		return refuse(framing, SRV_PROBLEM_TARGET, "the target has too many parameters");
	return true;
}

static bool take_version(struct srv_framing *framing, char c)
{
	static const char expected[] = "HTTP/1.x\r\n";
	uint32_t at = framing->name_size++;
	if (at == 7 && (c == '0' || c == '1'))
		framing->is_http_1_0 = c == '0';
	else if (at == 5 && c >= '0' && c <= '9' && c != '1')
		return refuse(framing, SRV_PROBLEM_VERSION, "only HTTP/1.1 and HTTP/1.0 are spoken here");
	else if (c != expected[at])
		return malformed(framing, "the request line must end with HTTP/1.1 or HTTP/1.0 and CRLF");
	if (at == sizeof expected - 2)
		framing->state = SRV_AT_LINE;
	return true;
}

/* ---- Headers ---- */

static int find_field(const struct srv_framing *framing)
{
	for (int i = 0; i < FIELD_COUNT; i++)
		if (strlen(fields[i]) == framing->name_size
				&& memcmp(fields[i], framing->name, framing->name_size) == 0)
			return i;
	return -1;
}

static bool take_name(struct srv_framing *framing, char c)
{
	if (c == ':' && framing->name_size) {
		framing->field = find_field(framing);
		framing->value_size = 0;
		framing->state = SRV_AT_VALUE;
		if (framing->field == FIELD_TRANSFER)
			return malformed(framing, "Transfer-Encoding is not accepted: send the body with a "
				"Content-Length");
		uint32_t bit =
			framing->field < 0 || framing->field == FIELD_COOKIE ? 0 : 1u << framing->field;
		if (framing->seen & bit)
			return malformed(framing, "a header that may be given once is given twice");
		framing->seen |= bit;
		return true;
	}
	if (!is_token(c))
		return malformed(framing,
			"a header is a name of letters, digits and '-', directly followed by "
			"':', and no line is folded");
	if (framing->name_size < sizeof framing->name)
		framing->name[framing->name_size] = (char)(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
	framing->name_size++;
	return true;
}

static bool take_line(struct srv_framing *framing, char c)
{
	if (c == '\r') {
		framing->state = SRV_AT_END_LF;
		return true;
	}
	framing->memory += ENTRY_BYTES;
	if (framing->header_count++ == SRV_HEADERS_MAX)
		return refuse(framing, SRV_PROBLEM_HEAD_TOO_LARGE, "too many headers");
	framing->name_size = 0;
	framing->state = SRV_AT_NAME;
	return take_name(framing, c);
}

static bool check_value(struct srv_framing *framing)
{
	bool is_length = framing->field == FIELD_LENGTH;         /* the library wants nothing behind digits */
	while (!is_length && framing->value_size && framing->value[framing->value_size - 1] == ' ')
		framing->value_size--;
	framing->value[framing->value_size] = 0;
	if (!is_length && !srv_authority_valid(framing->value, framing->value_size))
		return malformed(framing, "Host is not a name or address, with or without ':' and a port");
	if (is_length && !srv_parse_count(framing->value, &framing->body_left))
		return malformed(framing, "Content-Length is not a decimal number with nothing behind it");
	return true;
}

static bool keep_value(struct srv_framing *framing, char c)
{
	if (!framing->value_size && c == ' ')
		return true;
	if (framing->value_size == sizeof framing->value - 1)
		return malformed(framing, "Host or Content-Length is too long");
	framing->value[framing->value_size++] = c;
	return true;
}

static bool take_value(struct srv_framing *framing, char c)
{
	if (c == '\r') {
		framing->state = SRV_AT_VALUE_LF;
		return framing->field != FIELD_HOST && framing->field != FIELD_LENGTH ? true
			: check_value(framing);
	}
	if (!is_printable(c) && c != ' ' && c != '\t')
		return malformed(framing, "a header's value contains control characters");
	if (framing->field == FIELD_COOKIE) {
		framing->memory += c == ';' || c == ',' ? 1 + ENTRY_BYTES : 1;
		if (framing->memory > SRV_HEAD_MEMORY_MAX)
			return refuse(framing, SRV_PROBLEM_HEAD_TOO_LARGE,
				"too many cookies; none is needed");
	}
	return framing->field != FIELD_HOST && framing->field != FIELD_LENGTH ? true
		: keep_value(framing, c);
}

static bool end_head(struct srv_framing *framing)
{
	if (!framing->is_http_1_0 && !(framing->seen & 1u << FIELD_HOST))
		return malformed(framing, "Host is missing");
	/* the library would send 100, and then, if the next request has begun to arrive, nothing */
	if (framing->seen & 1u << FIELD_EXPECT && !framing->body_left)
		return malformed(framing, "Expect is for requests with a body");
	framing->heads++;
	framing->size = framing->memory = 0;
	framing->state = framing->body_left ? SRV_AT_BODY : SRV_AT_START;
	return true;
}

static bool take_lf(struct srv_framing *framing, char c, enum srv_framing_state next)
{
	framing->state = next;
	return c == '\n' ? true : malformed(framing, "a line must end with CRLF, and CR be nowhere else");
}

/* ---- Bytes ---- */

static bool take_byte(struct srv_framing *framing, char c)
{
	if (++framing->size > SRV_HEAD_BYTES_MAX || ++framing->memory > SRV_HEAD_MEMORY_MAX)
		return refuse(framing, SRV_PROBLEM_HEAD_TOO_LARGE, "the request's head is too large");
	switch (framing->state) {
	case SRV_AT_START:                       /* one empty line before a request is to be ignored */
		if (c == '\r') {
			framing->state = SRV_AT_EMPTY_LF;
			return true;
		}
		begin_head(framing);
		return take_method(framing, c);
	case SRV_AT_EMPTY_LF:
		begin_head(framing);
		return take_lf(framing, c, SRV_AT_METHOD);
	case SRV_AT_METHOD: return take_method(framing, c);
	case SRV_AT_TARGET: return take_target(framing, c);
	case SRV_AT_VERSION: return take_version(framing, c);
	case SRV_AT_LINE: return take_line(framing, c);
	case SRV_AT_NAME: return take_name(framing, c);
	case SRV_AT_VALUE: return take_value(framing, c);
	case SRV_AT_VALUE_LF: return take_lf(framing, c, SRV_AT_LINE);
	case SRV_AT_END_LF: return take_lf(framing, c, SRV_AT_START) && end_head(framing);
	default: return false;
	}
}

size_t srv_framing_scan(struct srv_framing *framing, const char *bytes, size_t size)
{
	size_t at = 0;
	while (at < size) {
		if (framing->state == SRV_AT_BODY) {
			size_t part = framing->body_left < size - at ? (size_t)framing->body_left : size - at;
			framing->body_left -= part;
			framing->state = framing->body_left ? SRV_AT_BODY : SRV_AT_START;
			at += part;
			continue;
		}
		if (!take_byte(framing, bytes[at]))
			break;
		at++;
	}
	return at;
}
