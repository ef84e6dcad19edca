#include "server/json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void put(struct srv_json *json, const char *text)
{
	eco_write_bytes(&json->out, text, strlen(text));
}

static void before_value(struct srv_json *json)
{
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

/* Length of the well-formed UTF-8 sequence at `text`, 0 if there is none (RFC 3629: no overlong forms, surrogates, > U+10FFFF). */
static size_t utf8_length(const uint8_t *text)
{
	uint8_t a = text[0], b = a ? text[1] : 0;
	if (a < 0x80)
		return 1;
	size_t length = a >= 0xc2 && a < 0xe0 ? 2 : a >= 0xe0 && a < 0xf0 ? 3 : a >= 0xf0 && a < 0xf5 ? 4 : 0;
	if (!length || (a == 0xe0 && b < 0xa0) || (a == 0xed && b >= 0xa0) || (a == 0xf0 && b < 0x90) || (a == 0xf4 && b >= 0x90))
		return 0;
	for (size_t i = 1; i < length; i++)              /* stops at the terminating 0 too */
		if ((text[i] & 0xc0) != 0x80)
			return 0;
	return length;
}

static void quote(struct srv_json *json, const char *text)
{
	eco_write_u8(&json->out, '"');
	for (const uint8_t *at = (const uint8_t *)text; *at;) {
		size_t length = utf8_length(at);
		char escape[8];
		if (length == 0) {
			put(json, "\\ufffd");
			length = 1;
		} else if (*at == '"' || *at == '\\' || *at < 0x20 || *at == 0x7f) {
			snprintf(escape, sizeof escape, *at == '"' || *at == '\\' ? "\\%c" : "\\u%04x", *at);
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
	char text[24];
	snprintf(text, sizeof text, "%llu", (unsigned long long)value);
	before_value(json);
	put(json, text);
}

static void add_number(struct srv_json *json, double value)
{
	char text[32];
	if (!isfinite(value)) {
		srv_json_null(json);
		return;
	}
	for (int digits = 6; digits <= 17; digits++) {
		snprintf(text, sizeof text, "%.*g", digits, value);
		if (strtod(text, NULL) == value)
			break;
	}
	before_value(json);
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
		add_number(json, value[i]);
	srv_json_close(json, ']');
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
	add_number(json, value);
}

void srv_json_key_bool(struct srv_json *json, const char *key, bool value)
{
	srv_json_key(json, key);
	srv_json_bool(json, value);
}
