#include "server/request/framing.h"

#include <string.h>
#include <strings.h>

#include "server/request/query.h"
#include "server/request/target.h"

enum field { FIELD_HOST, FIELD_LENGTH, FIELD_COOKIE, FIELD_TRANSFER, FIELD_EXPECT,
	FIELD_ONCE = FIELD_EXPECT };

/* Headers that count here. Those from FIELD_ONCE on may be given once, for two could be read in two ways. */
static const char *const fields[] = { [FIELD_HOST] = "host", [FIELD_LENGTH] = "content-length",
	[FIELD_COOKIE] = "cookie", [FIELD_TRANSFER] = "transfer-encoding", [FIELD_EXPECT] = "expect",
	"content-type", "range", "if-range", "if-match", "if-none-match", "if-modified-since",
	"if-unmodified-since", "content-range", "authorization" };
#define FIELD_COUNT (int)(sizeof fields / sizeof *fields)
#define ENTRY_BYTES 56u
#define METHOD_BYTES_MAX 32u

static bool refuse(struct srv_framing *framing, enum srv_problem problem, const char *detail)
{
	if (framing->state <= SRV_AT_REQUEST_LINE)
		framing->is_head = framing->line_size >= 5 && memcmp(framing->line, "HEAD ", 5) == 0;
	framing->problem = problem;
	framing->detail = detail;
	return false;
}

static bool malformed(struct srv_framing *framing, const char *detail)
{
	return refuse(framing, SRV_PROBLEM_FRAMING, detail);
}

/* Memory of the library for `count` entries of a table. */
static bool add_entries(struct srv_framing *framing, uint32_t count, const char *problem)
{
	framing->entries += count;
	return framing->size + framing->entries * ENTRY_BYTES <= SRV_HEAD_MEMORY_MAX ? true
		: refuse(framing, SRV_PROBLEM_HEAD_TOO_LARGE, problem);
}

static bool read_version(struct srv_framing *framing, const char *version)
{
	static const char name[] = "HTTP/";
	char major = version[strncmp(version, name, sizeof name - 1) == 0 ? sizeof name - 1 : 0];
	framing->is_http_1_0 = strcmp(version, "HTTP/1.0") == 0;
	if (framing->is_http_1_0 || strcmp(version, "HTTP/1.1") == 0)
		return true;
	if (major >= '0' && major <= '9' && major != '1')
		return refuse(framing, SRV_PROBLEM_VERSION, "only HTTP/1.1 and HTTP/1.0 are spoken here");
	return malformed(framing, "the request line must end with HTTP/1.1 or HTTP/1.0 and CRLF");
}

static bool read_request_line(struct srv_framing *framing)
{
	size_t method = strspn(framing->line, "ABCDEFGHIJKLMNOPQRSTUVWXYZ-_");
	if (!method || framing->line[method] != ' ')
		return malformed(framing, "a request begins with a method in capitals, as GET, and one space");
	if (method > METHOD_BYTES_MAX)
		return malformed(framing, "the method is too long");
	const char *target = framing->line + method + 1;
	size_t size = strcspn(target, " \t");
	uint32_t params = 0, questions = 0;
	if (size >= SRV_TARGET_BYTES_MAX)
		return refuse(framing, SRV_PROBLEM_TARGET_TOO_LONG, "the request target is too long");
	for (size_t i = 0; i < size; i++) {
		params += target[i] == '&';
		questions += target[i] == '?';
	}
	if (params >= SRV_PARAMS_MAX)
		return refuse(framing, SRV_PROBLEM_TARGET, "the target has too many parameters");
	if (!size || target[size] != ' ')
		return malformed(framing,
			"the request line is METHOD TARGET HTTP/1.1 with one space between, "
			"and a target has neither spaces nor control characters");
	framing->is_head = strncmp(framing->line, "HEAD ", 5) == 0;
	framing->state = SRV_AT_HEADER;
	return add_entries(framing, params + questions, "the request's head is too large")
		&& read_version(framing, target + size + 1);
}

/* ---- Headers ---- */

static int find_field(const char *name, size_t size)
{
	for (int i = 0; i < FIELD_COUNT; i++)
		if (strlen(fields[i]) == size && strncasecmp(fields[i], name, size) == 0)
			return i;
	return -1;
}

static bool read_host(struct srv_framing *framing, const char *value)
{
	size_t size = strlen(value);
	while (size && value[size - 1] == ' ')
		size--;
	return srv_authority_valid(value, size) ? true
		: malformed(framing, "Host is not a name or address, with or without ':' and a port");
}

static bool read_value(struct srv_framing *framing, int field, const char *value)
{
	uint32_t cookies = 0;
	switch (field) {
	case FIELD_TRANSFER:
		return malformed(framing, "Transfer-Encoding is not accepted: send the body with a Content-Length");
	case FIELD_COOKIE:
		for (; *value; value++)
			cookies += *value == ';' || *value == ',';
		/* the library copies their text */
		return add_entries(framing, cookies + framing->line_size / ENTRY_BYTES + 1,
			"too many cookies; none is needed");
	case FIELD_HOST:
		return read_host(framing, value);
	case FIELD_LENGTH:
		return srv_parse_count(value, &framing->length) ? true
			: malformed(framing, "Content-Length is not a decimal number with nothing behind it");
	default:
		return true;
	}
}

static bool read_header(struct srv_framing *framing)
{
	/* a token of RFC 9110, 5.6.2 */
	size_t name = strspn(framing->line, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
		"!#$%&'*+-.^_`|~");
	int field = find_field(framing->line, name);
	uint32_t bit = field < 0 || field == FIELD_COOKIE ? 0 : 1u << field;
	const char *value = framing->line + name + 1;
	if (framing->header_count++ == SRV_HEADERS_MAX)
		return refuse(framing, SRV_PROBLEM_HEAD_TOO_LARGE, "too many headers");
	if (!name || framing->line[name] != ':')
		return malformed(framing,
			"a header is a name of letters, digits and '-', directly followed by "
			"':', and no line is folded");
	if (framing->seen & bit)
		return malformed(framing, "a header that may be given once is given twice");
	framing->seen |= bit;
	return add_entries(framing, 1, "the request's head is too large")
		&& read_value(framing, field, value + strspn(value, " "));
}

static bool check_head(struct srv_framing *framing)
{
	if (!framing->is_http_1_0 && !(framing->seen & 1u << FIELD_HOST))
		return malformed(framing, "Host is missing");
	/* the library would send 100, and then, if the next request has begun to arrive, nothing */
	if (framing->seen & 1u << FIELD_EXPECT && !framing->length)
		return malformed(framing, "Expect is for requests with a body");
	framing->state = SRV_AT_END;
	return true;
}

/* ---- Bytes ---- */

static bool take_cr(struct srv_framing *framing)
{
	framing->line[framing->line_size] = 0;
	framing->after_cr = true;
	if (framing->state == SRV_AT_HEADER)
		return framing->line_size ? read_header(framing) : check_head(framing);
	if (framing->state == SRV_AT_REQUEST_LINE || framing->line_size)
		return read_request_line(framing);
	framing->state = SRV_AT_REQUEST_LINE;    /* one empty line before a request is to be ignored */
	return true;
}

static bool take_lf(struct srv_framing *framing, char c)
{
	if (c != '\n')
		return malformed(framing, "a line must end with CRLF, and CR be nowhere else");
	framing->after_cr = false;
	framing->line_size = 0;
	if (framing->state != SRV_AT_END)
		return true;
	framing->heads++;
	framing->body_left = framing->length;
	framing->length = framing->seen = framing->size = framing->entries = framing->header_count = 0;
	framing->is_head = false;
	framing->state = SRV_AT_START;
	return true;
}

static bool take_byte(struct srv_framing *framing, char c)
{
	if (++framing->size > SRV_HEAD_BYTES_MAX) {
		bool in_target = framing->state <= SRV_AT_REQUEST_LINE && memchr(framing->line, ' ', framing->line_size);
		return refuse(framing, in_target ? SRV_PROBLEM_TARGET_TOO_LONG : SRV_PROBLEM_HEAD_TOO_LARGE,
			in_target ? "the request target is too long" : "the request's head is too large");
	}
	if (framing->after_cr)
		return take_lf(framing, c);
	if (c == '\r')
		return take_cr(framing);
	if (((unsigned char)c < 0x20 && c != '\t') || c == 0x7f)
		return malformed(framing, "a line must end with CRLF, and hold no control characters");
	framing->line[framing->line_size++] = c;
	return true;
}

size_t srv_framing_scan(struct srv_framing *framing, const char *bytes, size_t size)
{
	size_t at = 0;
	while (at < size) {
		if (framing->body_left) {
			size_t part = framing->body_left < size - at ? (size_t)framing->body_left : size - at;
			framing->body_left -= part;
			at += part;
		} else if (take_byte(framing, bytes[at])) {
			at++;
		} else {
			break;
		}
	}
	return at;
}
