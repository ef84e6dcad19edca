#include "server/request/json.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/text.h"

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
			snprintf(escape, sizeof escape, length == 1 && *at >= 0x20 && *at < 0x7f ? "\\%c" :
				"\\u%04x", eco_utf8_code(at, length));
			put(json, escape);
		} else {
			eco_write_bytes(&json->out, at, length);
		}
		at += length;
	}
	eco_write_u8(&json->out, '"');
}

static void add_text(struct srv_json *json, const char *text)
{
	before_value(json);
	if (text)
		quote(json, text);
	else
		put(json, "null");
}

static void add_count(struct srv_json *json, uint64_t value)
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
		add_text(json, NULL);
		return;
	}
	if (value >= 0 && value < 1e15 && value == floor(value) && !signbit(value)) {
		add_count(json, (uint64_t)value);
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

/* The value of a conversion that begins at `at`; returns where it ends. */
static const char *add_value(struct srv_json *json, const char *at, va_list *values)
{
	uint64_t count;
	switch (at += *at == 'l', *at) {
	case 's':
		add_text(json, va_arg(*values, const char *));
		break;
	case 'd':
		before_value(json);
		put(json, va_arg(*values, int) ? "true" : "false");
		break;
	case 'u':
		add_count(json, at[-1] == 'l' ? va_arg(*values, uint64_t) : va_arg(*values, unsigned));
		break;
	case 'x':
		count = va_arg(*values, uint64_t);
		if (count == UINT64_MAX)
			add_text(json, NULL);
		else
			add_count(json, count);
		break;
	case '.':
		at += 2;
		add_number(json, va_arg(*values, double), FIGURE);
		break;
	default:
		assert(*at == 'g');
		add_number(json, va_arg(*values, double), DIGITS);
	}
	return at;
}

static size_t word_bytes(const char *text)
{
	size_t size = 0;
	while ((text[size] >= 'a' && text[size] <= 'z') || text[size] == '_' || (size && text[size] >= '0' && text[size] <= '9'))
		size++;
	return size;
}

/* A key, or null. */
static void add_word(struct srv_json *json, const char *word, size_t size)
{
	bool is_key = word[size] == ':';
	before_value(json);
	if (is_key)
		eco_write_u8(&json->out, '"');
	eco_write_bytes(&json->out, word, size);
	if (is_key)
		put(json, "\":");
	json->comma = !is_key;
}

static void add_bracket(struct srv_json *json, char bracket)
{
	bool opens = bracket == '{' || bracket == '[';
	if (opens)
		before_value(json);
	eco_write_u8(&json->out, (uint8_t)bracket);
	json->comma = !opens;
}

void srv_json_add(struct srv_json *json, const char *format, ...)
{
	va_list values;
	va_start(values, format);
	for (const char *at = format; *at; at++) {
		size_t word = word_bytes(at);
		if (word) {
			add_word(json, at, word);
			at += word - (at[word] != ':');
		} else if (*at == '%') {
			at = add_value(json, at + 1, &values);
		} else if (*at != ' ') {
			add_bracket(json, *at);
		}
	}
	va_end(values);
}

/* ---- Problems ---- */

const struct srv_problem_row srv_problem_rows[SRV_PROBLEM_COUNT] = {
	[SRV_PROBLEM_NONE] = { "about:blank", "No problem", 200 },
#define X(name, type, status, title) [SRV_PROBLEM_##name] = { "urn:ecostream:problem:" type, title, status },
	SRV_PROBLEMS(X)
#undef X
};

enum srv_problem srv_problem_of(enum eco_code code)
{
	switch (code) {
	case ECO_OK: return SRV_PROBLEM_NONE;
	case ECO_BAD_INPUT: return SRV_PROBLEM_PARAMETER;
	case ECO_TOO_LARGE: return SRV_PROBLEM_LIMIT;
	case ECO_NO_MEMORY: return SRV_PROBLEM_BUSY;
	case ECO_INTERRUPTED: return SRV_PROBLEM_STOPPING;
	case ECO_DAMAGED: return SRV_PROBLEM_DAMAGED;
	default: return SRV_PROBLEM_INTERNAL;
	}
}

void srv_problem_write(struct srv_json *json, enum srv_problem problem, const char *detail,
	const char *instance)
{
	const struct srv_problem_row *row = &srv_problem_rows[problem];
	srv_json_add(json, "{type:%s title:%s status:%u detail:%s", row->type, row->title, row->status, detail);
	if (instance)
		srv_json_add(json, "instance:%s", instance);
	srv_json_add(json, "}");
}
