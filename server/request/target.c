/* One pass over the bytes: the path is checked and split, then the query is split, decoded and checked in
 * place of a copy. The copy never grows, since decoding only shortens. */
#include "server/request/target.h"

#include <string.h>

#include "ecofiles/base/text.h"

#define HOST_BYTES_MAX 255u

static bool is_segment_byte(char c)
{
	return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_'
		|| c == '-' || c == '.';
}

static int hex_digit(char c)
{
	if (c >= '0' && c <= '9')
		return c - '0';
	if (c >= 'a' && c <= 'f')
		return c - 'a' + 10;
	if (c >= 'A' && c <= 'F')
		return c - 'A' + 10;
	return -1;
}

/* Bytes from outside go into messages only as something that prints. */
static int printable(char c)
{
	return c > 0x20 && c < 0x7f ? c : '?';
}

static size_t name_bytes(const char *text, size_t size)
{
	size_t at = 0;
	while (at < size && (is_segment_byte(text[at]) || text[at] == '~')
			&& !(text[at] == '.' && (at == 0 || text[at - 1] == '.')))
		at++;
	return at <= HOST_BYTES_MAX ? at : 0;
}

/* "[", what an IPv6 address is written with, "]". */
static size_t bracket_bytes(const char *text, size_t size)
{
	size_t at = 1;
	while (at < size && (hex_digit(text[at]) >= 0 || text[at] == ':' || text[at] == '.'))
		at++;
	return at > 2 && at < size && at <= HOST_BYTES_MAX && text[at] == ']' ? at + 1 : 0;
}

bool srv_port_valid(const char *text, size_t size)
{
	unsigned port = 0;
	for (size_t at = 1; at < size; at++) {
		if (text[at] < '0' || text[at] > '9')
			return false;
		port = port * 10 + (unsigned)(text[at] - '0');
	}
	return size > 1 && size <= 6 && text[0] == ':' && port <= 65535;
}

bool srv_authority_valid(const char *text, size_t size)
{
	size_t at = size && text[0] == '[' ? bracket_bytes(text, size) : name_bytes(text, size);
	return at > 0 && (at == size || (at + 1 == size && text[at] == ':') || srv_port_valid(text + at, size - at));
}

/* Absolute-form names the server too; only what follows the authority matters here. */
static enum eco_code skip_authority(const char **raw, size_t *size, struct eco_error *error)
{
	static const char scheme[] = "http://";
	size_t first = sizeof scheme - 1, at = first;
	if (*size < at || memcmp(*raw, scheme, at) != 0)
		return ECO_OK;
	while (at < *size && (*raw)[at] != '/' && (*raw)[at] != '?')
		at++;
	if (!srv_authority_valid(*raw + first, at - first))
		return eco_fail(error, ECO_BAD_INPUT,
			"http:// must be followed by a name or address, with or "
			"without ':' and a port");
	*raw += at;
	*size -= at;
	return ECO_OK;
}

static enum eco_code parse_path(struct srv_target *target, const char *raw, size_t size, char **out,
	struct eco_error *error)
{
	if (size == 0 || raw[0] != '/')
		return eco_fail(error, ECO_BAD_INPUT, "the path must begin with '/'");
	size_t at = 1;
	while (at < size) {
		if (target->segment_count == SRV_SEGMENTS_MAX)
			return eco_fail(error, ECO_BAD_INPUT, "the path has more than %u segments",
				SRV_SEGMENTS_MAX);
		target->segments[target->segment_count++] = *out;
		if (raw[at] == '.')
			return eco_fail(error, ECO_BAD_INPUT, "a path segment may not begin with '.'");
		size_t first = at;
		for (; at < size && raw[at] != '/'; at++) {
			if (!is_segment_byte(raw[at]))
				return eco_fail(error, ECO_BAD_INPUT, "'%c' at offset %zu is not allowed in "
					"a path: paths consist of letters, digits, '.', '_', '-' and '/', "
					"without percent-encoding", printable(raw[at]), at);
			*(*out)++ = raw[at];
		}
		if (at == first)
			return eco_fail(error, ECO_BAD_INPUT, "the path has an empty segment at offset %zu",
				at);
		*(*out)++ = 0;
		if (at < size && ++at == size)
			return eco_fail(error, ECO_BAD_INPUT, "the path ends with '/'");
	}
	return ECO_OK;
}

/* `text` is for words of people: UTF-8, with spaces, which forms write as plus signs. */
static enum eco_code parse_value(const char *raw, size_t size, const char *name, char **out,
	struct eco_error *error)
{
	const bool words = strcmp(name, "text") == 0;
	char *first = *out;
	for (size_t at = 0; at < size; at++) {
		char c = raw[at];
		if (c == '%') {
			if (size - at < 3 || hex_digit(raw[at + 1]) < 0 || hex_digit(raw[at + 2]) < 0)
				return eco_fail(error, ECO_BAD_INPUT,
					"parameter '%.40s': '%%' must be followed by two hex digits", name);
			c = (char)(hex_digit(raw[at + 1]) * 16 + hex_digit(raw[at + 2]));
			at += 2;
		} else if (words && c == '+') {
			c = ' ';
		}
		if (words ? (c >= 0 && c < 0x20) || c == 0x7f : c <= 0x20 || c >= 0x7f)
			return eco_fail(error, ECO_BAD_INPUT, "parameter '%.40s': %s", name, words ? "control characters are not allowed"
				: "only printable ASCII without spaces is allowed");
		*(*out)++ = c;
	}
	if (words && !eco_utf8_valid(first, (size_t)(*out - first)))
		return eco_fail(error, ECO_BAD_INPUT, "parameter 'text': it is no UTF-8");
	*(*out)++ = 0;
	return ECO_OK;
}

static enum eco_code parse_param(struct srv_target *target, const char *raw, size_t size, char **out,
	struct eco_error *error)
{
	if (target->param_count == SRV_PARAMS_MAX)
		return eco_fail(error, ECO_BAD_INPUT, "more than %u parameters", SRV_PARAMS_MAX);
	struct srv_param *param = &target->params[target->param_count];
	size_t at = 0;
	param->name = *out;
	for (; at < size && raw[at] != '='; at++) {
		if (!((raw[at] >= 'a' && raw[at] <= 'z') || raw[at] == '_'))
			return eco_fail(error, ECO_BAD_INPUT, "'%c' is not allowed in a parameter's name: "
				"names consist of a-z and '_'", printable(raw[at]));
		*(*out)++ = raw[at];
	}
	*(*out)++ = 0;
	if (at == 0)
		return eco_fail(error, ECO_BAD_INPUT, "a parameter without a name");
	if (at + 1 >= size)
		return eco_fail(error, ECO_BAD_INPUT, "parameter '%.40s' has no value: write %.40s=VALUE",
			param->name, param->name);
	if (srv_target_param(target, param->name))
		return eco_fail(error, ECO_BAD_INPUT, "parameter '%.40s' is given twice", param->name);
	param->value = *out;
	enum eco_code code = parse_value(raw + at + 1, size - at - 1, param->name, out, error);
	if (!code)
		target->param_count++;
	return code;
}

enum eco_code srv_target_parse(struct srv_target *target, const char *raw, size_t size,
	struct eco_error *error)
{
	target->segment_count = target->param_count = 0;
	/* Every part gains a 0 and loses a separator; the path's first '/' pays for the first part's. */
	if (size >= SRV_TARGET_BYTES_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "the request target has %zu bytes; at most %u are "
			"accepted", size, SRV_TARGET_BYTES_MAX - 1);
	ECO_PASS(skip_authority(&raw, &size, error));
	const char *query = memchr(raw, '?', size);
	char *out = target->text;
	enum eco_code code = parse_path(target, raw, query ? (size_t)(query - raw) : size, &out, error);
	if (code || !query)
		return code;
	const char *end = raw + size;
	for (const char *at = query, *next; at && !code; at = next) {
		at++;
		next = memchr(at, '&', (size_t)(end - at));
		code = parse_param(target, at, (size_t)((next ? next : end) - at), &out, error);
	}
	return code;
}

const char *srv_target_param(const struct srv_target *target, const char *name)
{
	for (uint32_t i = 0; i < target->param_count; i++)
		if (strcmp(target->params[i].name, name) == 0)
			return target->params[i].value;
	return NULL;
}

/* ---- Routes ---- */

#define READ (SRV_METHOD_GET | SRV_METHOD_HEAD | SRV_METHOD_OPTIONS)

const struct srv_route srv_routes[SRV_RESOURCE_COUNT] = {
	[SRV_HEALTH] = { "/healthz", "GET, HEAD, OPTIONS", READ },
	[SRV_READY] = { "/readyz", "GET, HEAD, OPTIONS", READ },
	[SRV_METRICS] = { "/metrics", "GET, HEAD, OPTIONS", READ, .is_operators = true },
	[SRV_RELOAD] = { "/v1/admin/reload", "POST, OPTIONS", SRV_METHOD_POST | SRV_METHOD_OPTIONS,
		.is_operators = true },
	[SRV_SCENES] = { "/v1/scenes", "GET, HEAD, OPTIONS", READ },
	[SRV_SCENE] = { "/v1/scenes/{scene}", "GET, HEAD, OPTIONS", READ },
	[SRV_PLAN] = { "/v1/scenes/{scene}/plan", "GET, HEAD, OPTIONS", READ },
	[SRV_STREAM] = { "/v1/scenes/{scene}/stream", "GET, HEAD, POST, OPTIONS", READ | SRV_METHOD_POST },
	[SRV_CHUNK] = { "/v1/scenes/{scene}/chunks/{id}", "GET, HEAD, OPTIONS", READ },
	[SRV_PLANTS] = { "/v1/scenes/{scene}/plants/{list}", "GET, HEAD, OPTIONS", READ },
	[SRV_FIND] = { "/v1/scenes/{scene}/find", "GET, HEAD, OPTIONS", READ },
	[SRV_SPECIES] = { "/v1/scenes/{scene}/species", "GET, HEAD, OPTIONS", READ },
	[SRV_INDEX] = { "/", "GET, HEAD, OPTIONS", READ, .is_page = true },
	[SRV_ICON] = { "/favicon.ico", "GET, HEAD, OPTIONS", READ, .is_page = true },
	[SRV_VIEWER] = { "/viewer/{file}", "GET, HEAD, OPTIONS", READ, .is_page = true },
	[SRV_VIEWER_FILE] = { "/viewer/{version}/{file}", "GET, HEAD, OPTIONS", READ, .is_page = true },
};

enum srv_method srv_method_of(const char *name)
{
	return strcmp(name, "GET") == 0 ? SRV_METHOD_GET : strcmp(name, "HEAD") == 0 ? SRV_METHOD_HEAD
		: strcmp(name, "POST") == 0 ? SRV_METHOD_POST : strcmp(name, "OPTIONS") == 0
		? SRV_METHOD_OPTIONS : SRV_METHOD_OTHER;
}

static bool matches(const char *pattern, const struct srv_target *target, const char *variables[2])
{
	uint32_t segment = 0, variable = 0;
	for (; *pattern == '/' && pattern[1]; segment++) {
		size_t size = strcspn(++pattern, "/");
		if (segment == target->segment_count)
			return false;
		const char *text = target->segments[segment];
		if (*pattern == '{')
			variables[variable++] = text;
		else if (strlen(text) != size || memcmp(text, pattern, size) != 0)
			return false;
		pattern += size;
	}
	return segment == target->segment_count;
}

const struct srv_route *srv_route_find(const struct srv_target *target, const char *variables[2])
{
	for (int i = 0; i < SRV_RESOURCE_COUNT; i++) {
		variables[0] = variables[1] = NULL;
		if (matches(srv_routes[i].pattern, target, variables))
			return &srv_routes[i];
	}
	return NULL;
}
