#include "server/request/json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/utf8.h"

#define FIGURE 9
#define DIGITS 15                /* any decimal of so many survives a double */
#define DIGITS_MOST 17

static void put(struct srv_json *json, const char *text)
{
	eco_write_bytes(&json->out, text, strlen(text));
}

static bool is_cancelled(const struct srv_json *json)
{
	return json->cancelled && atomic_load_explicit(json->cancelled, memory_order_relaxed);
}

static bool is_too_large(const struct srv_json *json)
{
	return json->most && json->out.size > json->most;
}

enum eco_code srv_json_end(struct srv_json *json)
{
	enum eco_code code = is_cancelled(json) ? ECO_INTERRUPTED : is_too_large(json) ? ECO_TOO_LARGE
		: json->out.failed ? ECO_NO_MEMORY : ECO_OK;
	if (code)
		eco_writer_free(&json->out);
	return code;
}

static void before_value(struct srv_json *json)
{
	json->out.failed |= is_cancelled(json) || is_too_large(json);
	if (json->comma)
		eco_write_u8(&json->out, ',');
	json->comma = true;
}

void srv_json_open(struct srv_json *json, char bracket)
{
	before_value(json);
	eco_write_u8(&json->out, (uint8_t)bracket);
	json->comma = false;
}

void srv_json_close(struct srv_json *json, char bracket)
{
	eco_write_u8(&json->out, (uint8_t)bracket);
	json->comma = true;
}

/* Bytes from `at` on that stand for themselves. */
static size_t plain_bytes(const char *at)
{
	size_t count = 0;
	while (at[count] >= 0x20 && at[count] < 0x7f && at[count] != '"' && at[count] != '\\')
		count++;
	return count;
}

static void quote(struct srv_json *json, const char *text)
{
	eco_write_u8(&json->out, '"');
	for (const char *at = text, *end = text + strlen(text); at < end;) {
		size_t plain = plain_bytes(at), length;
		char escape[8];
		eco_write_bytes(&json->out, at, plain);
		at += plain;
		if (at == end)
			break;
		length = eco_utf8_bytes(at, (size_t)(end - at));
		if (length == 0) {
			put(json, "\\ufffd");
			length = 1;
		} else if (*at == '"' || *at == '\\' || !eco_utf8_printable(eco_utf8_code(at, length))) {
			snprintf(escape, sizeof escape, length == 1 && *at >= 0x20 && *at < 0x7f ? "\\%c" : "\\u%04x",
				eco_utf8_code(at, length));
			put(json, escape);
		} else {
			eco_write_bytes(&json->out, at, length);
		}
		at += length;
	}
	eco_write_u8(&json->out, '"');
}

void srv_json_key(struct srv_json *json, const char *key)
{
	before_value(json);
	quote(json, key);
	eco_write_u8(&json->out, ':');
	json->comma = false;
}

void srv_json_text(struct srv_json *json, const char *text)
{
	if (!text) {
		srv_json_null(json);
		return;
	}
	before_value(json);
	quote(json, text);
}

void srv_json_count(struct srv_json *json, uint64_t value)
{
	char text[20], *at = text + sizeof text;
	do
		*--at = (char)('0' + value % 10);
	while (value /= 10);
	before_value(json);
	eco_write_bytes(&json->out, at, (size_t)(text + sizeof text - at));
}

/* In so many digits, without zeros at the end, or as many more as read back the same. */
static void add_number(struct srv_json *json, double value, int digits)
{
	char text[32];
	if (!isfinite(value)) {
		srv_json_null(json);
		return;
	}
	if (value >= 0 && value < 1e15 && value == floor(value) && !signbit(value)) {
		srv_json_count(json, (uint64_t)value);
		return;
	}
	before_value(json);
	for (; digits <= DIGITS_MOST; digits++) {
		snprintf(text, sizeof text, "%.*g", digits, value);
		if (digits == FIGURE || strtod(text, NULL) == value)
			break;
	}
	put(json, text);
}

void srv_json_bool(struct srv_json *json, bool value)
{
	before_value(json);
	put(json, value ? "true" : "false");
}

void srv_json_null(struct srv_json *json)
{
	before_value(json);
	put(json, "null");
}

void srv_json_point(struct srv_json *json, const double value[3])
{
	srv_json_open(json, '[');
	for (int i = 0; i < 3; i++)
		add_number(json, value[i], DIGITS);
	srv_json_close(json, ']');
}

void srv_json_key_open(struct srv_json *json, const char *key, char bracket)
{
	srv_json_key(json, key);
	srv_json_open(json, bracket);
}

void srv_json_key_text(struct srv_json *json, const char *key, const char *text)
{
	srv_json_key(json, key);
	srv_json_text(json, text);
}

void srv_json_key_count(struct srv_json *json, const char *key, uint64_t value)
{
	srv_json_key(json, key);
	srv_json_count(json, value);
}

void srv_json_key_number(struct srv_json *json, const char *key, double value)
{
	srv_json_key(json, key);
	add_number(json, value, DIGITS);
}

void srv_json_key_figure(struct srv_json *json, const char *key, double value)
{
	srv_json_key(json, key);
	add_number(json, value, FIGURE);
}

void srv_json_key_bool(struct srv_json *json, const char *key, bool value)
{
	srv_json_key(json, key);
	srv_json_bool(json, value);
}
