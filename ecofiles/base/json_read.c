#include "ecofiles/base/json_read.h"

#include <jansson.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/text.h"

/* The position of a value is found again from its path of ordinal numbers: jansson keeps members in the
 * order of the text, and duplicate keys are refused, so that the n-th member of an object is the n-th key
 * written, whatever its escapes. jansson has accepted the text before, so the scanner below only skips and
 * never judges; the text's end bounds it all the same. */

#define DEPTH_MAX 32

static const char *type_name(const json_t *value)
{
	switch (json_typeof(value)) {
	case JSON_OBJECT: return "an object";
	case JSON_ARRAY: return "an array";
	case JSON_STRING: return "a text";
	case JSON_INTEGER:
	case JSON_REAL: return "a number";
	case JSON_NULL: return "null";
	default: return "true or false";
	}
}

/* Offset behind the byte order mark that some editors write in front of UTF-8. */
static size_t text_start(const struct eco_json_file *file)
{
	return file->size >= 3 && memcmp(file->text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
}

/* Names a file that is not JSON by its first bytes; NULL: not known. */
static const char *other_kind(const struct eco_json_file *file)
{
	static const struct { const char *start, *says; } kinds[] = {
		{ "\xff\xfe", "the text is UTF-16; save it as UTF-8" },
		{ "\xfe\xff", "the text is UTF-16; save it as UTF-8" },
		{ "ECOPACK", "this is a pack, not a JSON file" },
		{ "glTF", "this is a model, not a JSON file; a scene names its models (ecofiles/README.md)" },
		{ "\x89PNG", "this is a picture, not a JSON file" },
	};

	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
		if (file->size >= strlen(kinds[i].start)
				&& memcmp(file->text, kinds[i].start, strlen(kinds[i].start)) == 0)
			return kinds[i].says;
	size_t at = text_start(file);
	while (at < file->size && memchr(" \t\r\n", file->text[at], 4))
		at++;
	return at < file->size && !memchr("{[/#", file->text[at], 4) ? "this is no JSON, which begins with {; "
		"if it is a table of plants, ecopack start makes a scene of it" : NULL;
}

/* A hint for the commonest mistakes; `end` is behind the token that the parser refused. */
static const char *hint(const struct eco_json_file *file, size_t end, const char *says)
{
	size_t at = end > 0 && end <= file->size ? end - 1 : 0;
	char token = at > 0 ? file->text[at] : 0;
	if (token == '/' || token == '#')
		return " (JSON has no comments)";
	while (at > 0 && strchr(" \t\r\n", file->text[at - 1]))
		at--;
	if ((token == '}' || token == ']') && at > 0 && file->text[at - 1] == ',')
		return " (no comma stands before a closing bracket)";
	return strstr(says, "' expected near") && !strstr(says, "end of file")
		&& (strncmp(says, "'}'", 3) == 0 || strncmp(says, "']'", 3) == 0)
		? " (is a comma missing before it?)" : "";
}

json_t *eco_json_open(const struct eco_json_file *file)
{
	json_error_t problem;
	size_t start = text_start(file);
	json_t *root = json_loadb(file->text + start, file->size - start, JSON_REJECT_DUPLICATES, &problem);
	if (!root && other_kind(file))
		eco_fail(file->error, ECO_BAD_INPUT, "%s:1:1: %s", file->name, other_kind(file));
	else if (!root)
		eco_fail(file->error, ECO_BAD_INPUT, "%s:%d:%d: %s%s", file->name,
			problem.line > 0 ? problem.line : 1, problem.column > 0 ? problem.column : 1,
			problem.text, hint(file, problem.position > 0 ? start + (size_t)problem.position : 0,
			problem.text));
	return root;
}

struct eco_json eco_json_root(const struct eco_json_file *file, const json_t *root)
{
	return (struct eco_json){ .file = file, .value = root };
}

struct eco_json eco_json_member(const struct eco_json *object, const char *key)
{
	struct eco_json node = { .file = NULL };
	while (eco_json_next(object, &node))
		if (strcmp(node.key, key) == 0)
			return node;
	node.key = key;
	return node;
}

bool eco_json_next(const struct eco_json *object, struct eco_json *member)
{
	json_t *value = (json_t *)object->value;
	bool first = !member->parent;
	void *at = first ? json_object_iter(value)
		: json_object_iter_next(value, json_object_key_to_iter(member->key));
	*member = (struct eco_json){ object->file, object, json_object_iter_key(at),
		first ? 0 : member->index + 1, json_object_iter_value(at) };
	return at;
}

struct eco_json eco_json_item(const struct eco_json *array, size_t index)
{
	return (struct eco_json){ .file = array->file, .parent = array, .index = index,
		.value = json_array_get(array->value, index) };
}

/* ---- Positions ---- */

static size_t skip_space(const char *text, size_t size, size_t at)
{
	while (at < size && (text[at] == ' ' || text[at] == '\t' || text[at] == '\n' || text[at] == '\r'))
		at++;
	return at;
}

static size_t skip_string(const char *text, size_t size, size_t at)
{
	for (at++; at < size && text[at] != '"'; at++)
		if (text[at] == '\\')
			at++;
	return at < size ? at + 1 : size;
}

static size_t skip_value(const char *text, size_t size, size_t at)
{
	for (size_t depth = 0; at < size;) {
		char c = text[at];
		if (depth == 0 && memchr(",}]", c, 3))
			return at;
		at = c == '"' ? skip_string(text, size, at) : at + 1;
		depth += c == '{' || c == '[';
		depth -= c == '}' || c == ']';
		if (depth == 0 && memchr("\"}]", c, 3))
			return at;
	}
	return size;
}

/* From the opening bracket at `at` to the index-th entry: its key in an object, its value in an array. */
static size_t enter(const char *text, size_t size, size_t at, size_t index, bool object)
{
	at = skip_space(text, size, at + 1);
	for (size_t i = 0; i < index && at < size; i++) {
		if (object)
			at = skip_space(text, size, skip_string(text, size, at)) + 1;
		at = skip_space(text, size, skip_value(text, size, skip_space(text, size, at)));
		at = skip_space(text, size, at + 1);
	}
	return at;
}

static size_t find(const struct eco_json *at, bool key)
{
	const struct eco_json *path[DEPTH_MAX];
	const char *text = at->file->text;
	size_t size = at->file->size, depth = 0, offset = 0;
	if (!at->value && at->parent)
		at = at->parent;
	for (const struct eco_json *node = at; node->parent && depth < DEPTH_MAX; node = node->parent)
		path[depth++] = node;
	offset = skip_space(text, size, text_start(at->file));
	while (depth-- > 0) {
		bool object = json_is_object(path[depth]->parent->value);
		offset = enter(text, size, offset, path[depth]->index, object);
		if (object && !(key && depth == 0))
			offset = skip_space(text, size,
				skip_space(text, size, skip_string(text, size, offset)) + 1);
	}
	return offset < size ? offset : size;
}

static void line_column(const struct eco_json_file *file, size_t offset, uint32_t *line, uint32_t *column)
{
	*line = *column = 1;
	for (size_t i = text_start(file); i < offset; i++) {
		if (file->text[i] == '\n') {
			++*line;
			*column = 1;
		} else if (((unsigned char)file->text[i] & 0xc0) != 0x80) {
			++*column;
		}
	}
}

void eco_json_place(const struct eco_json *at, uint32_t *line, uint32_t *column)
{
	line_column(at->file, find(at, false), line, column);
}

static void fail_at(const struct eco_json *at, bool key, enum eco_code code, const char *text)
{
	uint32_t line, column;
	line_column(at->file, find(at, key), &line, &column);
	eco_fail(at->file->error, code, "%s:%u:%u: %s", at->file->name, line, column, text);
}

bool eco_json_fail(const struct eco_json *at, enum eco_code code, const char *format, ...)
{
	char text[400];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	fail_at(at, false, code, text);
	return false;
}

/* ---- Values ---- */

static bool bad(const struct eco_json *at, const char *wanted)
{
	const char *what = at->key ? at->key : at->parent ? "this" : "the document";
	const char *mark = at->key ? "\"" : "";
	return eco_json_fail(at, ECO_BAD_INPUT, "%s%s%s must be %s, not %s", mark, what, mark, wanted,
		type_name(at->value));
}

bool eco_json_object(const struct eco_json *at, const char *const *fields)
{
	struct eco_json node = { .file = NULL };
	if (!json_is_object(at->value))
		return bad(at, "an object");
	while (eco_json_next(at, &node)) {
		char known[256] = "", text[400];
		size_t i = 0;
		while (fields[i] && strcmp(fields[i], node.key) != 0)
			i++;
		if (fields[i])
			continue;
		for (i = 0; fields[i]; i++)
			eco_phrase_add(known, sizeof known, fields[i]);
		snprintf(text, sizeof text, "unknown field \"%.60s\"; known here: %s", node.key, known);
		fail_at(&node, true, ECO_BAD_INPUT, text);
		return false;
	}
	return true;
}

static bool fits(const struct eco_json *at, size_t count, size_t count_max)
{
	if (count > count_max)
		eco_json_fail(at, ECO_TOO_LARGE, "%zu entries, at most %zu are possible", count, count_max);
	return count <= count_max;
}

bool eco_json_names(const struct eco_json *at, size_t count_max)
{
	return json_is_object(at->value) ? fits(at, json_object_size(at->value), count_max)
		: bad(at, "an object");
}

bool eco_json_array(const struct eco_json *at, size_t count_max)
{
	return json_is_array(at->value) ? fits(at, json_array_size(at->value), count_max)
		: bad(at, "an array");
}

bool eco_json_required(const struct eco_json *object, const char *key)
{
	if (json_object_get(object->value, key))
		return true;
	return eco_json_fail(object, ECO_BAD_INPUT, "\"%s\" is missing", key);
}

static bool number_in(const struct eco_json *at, double low, double high, double *out)
{
	if (!json_is_number(at->value))
		return bad(at, "a number");
	double number = json_number_value(at->value);
	if (!(number >= low && number <= high))
		return eco_json_fail(at, ECO_BAD_INPUT, "%s is %.17g, it must be between %.15g and %.15g",
			at->key ? at->key : "the number", number, low, high);
	*out = number;
	return true;
}

bool eco_json_number(const struct eco_json *object, const char *key, double low, double high, double *out)
{
	struct eco_json at = eco_json_member(object, key);
	return !at.value || number_in(&at, low, high, out);
}

bool eco_json_whole(const struct eco_json *object, const char *key, uint64_t low, uint64_t high,
	uint64_t *out)
{
	struct eco_json at = eco_json_member(object, key);
	if (!at.value)
		return true;
	if (!json_is_integer(at.value))
		return bad(&at, "a whole number");
	if (json_integer_value(at.value) < 0 || (uint64_t)json_integer_value(at.value) < low
		|| (uint64_t)json_integer_value(at.value) > high)
		return eco_json_fail(&at, ECO_BAD_INPUT, "%s is %lld, it must be between %llu and %llu", key,
			(long long)json_integer_value(at.value), (unsigned long long)low,
			(unsigned long long)high);
	*out = (uint64_t)json_integer_value(at.value);
	return true;
}

bool eco_json_flag(const struct eco_json *object, const char *key, bool *out)
{
	struct eco_json at = eco_json_member(object, key);
	if (!at.value)
		return true;
	if (!json_is_boolean(at.value))
		return bad(&at, "true or false");
	*out = json_is_true(at.value);
	return true;
}

bool eco_json_numbers(const struct eco_json *object, const char *key, size_t least, size_t most, double low,
	double high, double *out)
{
	struct eco_json at = eco_json_member(object, key);
	if (!at.value)
		return true;
	if (!json_is_array(at.value))
		return bad(&at, "an array of numbers");
	if (json_array_size(at.value) < least || json_array_size(at.value) > most)
		return eco_json_fail(&at, ECO_BAD_INPUT, "\"%s\" has %zu numbers, it must have %zu%s%.0zu",
			key, json_array_size(at.value), least, least < most ? " or " : "",
			least < most ? most : 0);
	for (size_t i = 0; i < json_array_size(at.value); i++) {
		struct eco_json item = eco_json_item(&at, i);
		if (!number_in(&item, low, high, &out[i]))
			return false;
	}
	return true;
}

bool eco_json_is_text(const struct eco_json *at, size_t bytes_max)
{
	if (!json_is_string(at->value))
		return bad(at, "a text");
	if (json_string_length(at->value) == 0 || json_string_length(at->value) > bytes_max)
		return eco_json_fail(at, ECO_BAD_INPUT, "a text of %zu bytes, it must have 1 to %zu",
			json_string_length(at->value), bytes_max);
	return true;
}

bool eco_json_text(const struct eco_json *object, const char *key, size_t bytes_max, const char **out)
{
	struct eco_json at = eco_json_member(object, key);
	if (!at.value)
		return true;
	if (!eco_json_is_text(&at, bytes_max))
		return false;
	*out = json_string_value(at.value);
	return true;
}

static _Thread_local bool lost;

static void *allocate(size_t size)
{
	void *room = malloc(size);
	lost = lost || !room;
	return room;
}

void eco_json_watch(void)
{
	json_set_alloc_funcs(allocate, free);
}

bool eco_json_lost(void) { return lost; }
