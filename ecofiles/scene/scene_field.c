/* Fields that several parts of a scene file have: paths, CRSs, units, texts to keep. */
#include "ecofiles/base/confine.h"
#include "ecofiles/scene/scene_parse.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void eco_scene_fail(const struct eco_json *at, const char *format, ...)
{
	char text[400];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	eco_json_fail(at, ECO_BAD_INPUT, "%s", text);
	eco_check(ECO_BAD_INPUT);
	abort();
}

void eco_scene_need(bool good)
{
	if (!good)
		eco_check(ECO_BAD_INPUT);
}

/* ---- Notes ---- */

#define FIELDS_MAX 32u

static void check_note(const struct eco_json *at)
{
	if (!json_is_string(at->value))
		eco_scene_fail(at, "a note is a text");
}

static void check_notes(const struct eco_json *at)
{
	struct eco_json member = { .file = NULL };
	while (json_is_object(at->value) && eco_json_next(at, &member))
		check_note(&member);
	for (size_t i = 0; !json_is_object(at->value) && i < eco_scene_several(at); i++) {
		struct eco_json item = eco_scene_one(at, i);
		check_note(&item);
	}
}

/* ---- Paths ---- */

static void parse_path(const struct eco_source *source, const struct eco_json *at, char **path)
{
	eco_scene_need(eco_json_is_text(at, ECO_PATH_BYTES));
	const char *relative = json_string_value(at->value), *slash = strrchr(source->path, '/');
	int folder = slash && *relative != '/' ? (int)(slash - source->path) + 1 : 0;
	if (asprintf(path, "%.*s%s", folder, source->path, relative) < 0)
		eco_end("no memory");
	if (!source->on_disk)
		return;
	if (!eco_confined_may_read(*path))
		eco_scene_fail(at, "%.300s lies outside of the folder to which --confine keeps reading", *path);
	if (access(*path, R_OK) != 0)
		eco_scene_need(eco_json_fail(at, errno == ENOENT ? ECO_NOT_FOUND : ECO_IO, "%.300s: %s%s", *path,
			strerror(errno), errno == ENOENT ? "; paths count from the folder of the file that names "
			"them" : eco_advice_read(errno)));
}

void eco_scene_parse_paths(const struct eco_source *source, const struct eco_json *at, const char *what,
	size_t most, char ***paths, uint32_t *count)
{
	size_t size = eco_scene_several(at);
	if (size == 0)
		eco_scene_fail(at, "it names no %s", what);
	eco_scene_need(!json_is_array(at->value) || eco_json_array(at, most));
	*paths = eco_alloc(size, sizeof **paths);
	for (size_t i = 0; i < size; i++) {
		struct eco_json item = eco_scene_one(at, i);
		parse_path(source, &item, &(*paths)[(*count)++]);
	}
}

void eco_scene_paths_free(char **paths, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		free(paths[i]);
	free(paths);
}

/* ---- Values ---- */

size_t eco_scene_several(const struct eco_json *at)
{
	return json_is_array(at->value) ? json_array_size(at->value) : 1;
}

struct eco_json eco_scene_one(const struct eco_json *at, size_t index)
{
	return json_is_array(at->value) ? eco_json_item(at, index) : *at;
}

void eco_scene_copy(const struct eco_json *at, size_t bytes_max, char **out)
{
	free(*out);          /* a column that two fields name */
	*out = NULL;
	eco_scene_need(eco_json_is_text(at, bytes_max));
	*out = eco_copy_text(json_string_value(at->value));
}

static void parse_crs(const struct eco_source *source, const struct eco_json *at, char **crs)
{
	eco_scene_copy(at, ECO_PATH_BYTES, crs);
	if (!source->crs)
		eco_scene_fail(at, "the scene has no CRS to convert to: add \"crs\": \"%.80s\" and \"origin\" to "
			"the scene, or leave this one out", *crs);
}

static void parse_unit(const struct eco_json *at, double *unit_m)
{
	eco_scene_need(eco_json_is_text(at, 16));
	const char *name = json_string_value(at->value);
	if (!eco_unit_metres(name, unit_m))
		eco_scene_fail(at, "unit \"%.20s\" is not one of " ECO_UNITS, name);
}

void eco_scene_choice(const struct eco_json *at, const char *key, const char *const *names, const char *says,
	unsigned *which)
{
	struct eco_json node = eco_json_member(at, key);
	const char *name = NULL;
	unsigned i = 0;
	eco_scene_need(eco_json_text(at, key, 16, &name));
	while (name && names[i] && strcmp(name, names[i]) != 0)
		i++;
	if (name && !names[i])
		eco_scene_fail(&node, "\"%s\" is %s", key, says);
	if (name)
		*which = i;
}

/* ---- Objects ---- */

static void parse_field(const struct eco_source *source, const struct eco_json *at, const struct eco_field *f,
	void *to)
{
	struct eco_json node = eco_json_member(at, f->name);
	uint64_t whole = 0;
	double number = 0;
	if (!node.value) {
		eco_scene_need(!(f->kind & ECO_IS_REQUIRED) || eco_json_required(at, f->name));
		return;
	}
	switch (f->kind & ~(unsigned)ECO_IS_REQUIRED) {
	case ECO_IS_COLUMN: eco_scene_copy(&node, ECO_COLUMN_BYTES, to); break;
	case ECO_IS_TEXT: eco_scene_copy(&node, ECO_PATH_BYTES, to); break;
	case ECO_IS_CRS: parse_crs(source, &node, to); break;
	case ECO_IS_PATH: parse_path(source, &node, to); break;
	case ECO_IS_UNIT: parse_unit(&node, to); break;
	case ECO_IS_NUMBERS:
		eco_scene_need(eco_json_numbers(at, f->name, 2, f->bytes / sizeof(double), f->low, f->high, to));
		break;
	case ECO_IS_NUMBER:
		eco_scene_need(eco_json_number(at, f->name, f->low, f->high, &number));
		if (f->bytes == sizeof(float))
			*(float *)to = (float)number;
		else
			*(double *)to = number;
		break;
	case ECO_IS_WHOLE:
		eco_scene_need(eco_json_whole(at, f->name, (uint64_t)f->low, (uint64_t)f->high, &whole));
		if (f->bytes == sizeof(uint32_t))
			*(uint32_t *)to = (uint32_t)whole;
		else
			*(uint64_t *)to = whole;
		break;
	default: break;
	}
}

void eco_scene_fields(const struct eco_source *source, const struct eco_json *at, const struct eco_field *fields,
	void *to)
{
	const char *names[FIELDS_MAX + 2];
	size_t count = 0;
	for (; fields[count].name && count < FIELDS_MAX; count++)
		names[count] = fields[count].name;
	names[count] = "notes";
	names[count + 1] = NULL;
	eco_scene_need(eco_json_object(at, names));
	struct eco_json notes = eco_json_member(at, "notes");
	if (notes.value)
		check_notes(&notes);
	for (const struct eco_field *f = fields; f->name; f++)
		parse_field(source, at, f, (char *)to + f->at);
}

void eco_scene_fields_free(const struct eco_field *fields, void *of)
{
	for (; fields->name; fields++) {
		unsigned kind = fields->kind & ~(unsigned)ECO_IS_REQUIRED;
		if (kind >= ECO_IS_COLUMN && kind <= ECO_IS_PATH)
			free(*(char **)(void *)((char *)of + fields->at));
	}
}

/* ---- Names ---- */

bool eco_up_of(const char *name, enum eco_up *up)
{
	static const char axes[] = "yzx";        /* as in enum eco_up */
	if (strlen(name) != 1 || !strchr(axes, *name))
		return false;
	*up = ECO_UP_Y + (unsigned)(strchr(axes, *name) - axes);
	return true;
}

bool eco_unit_metres(const char *name, double *metres)
{
	static const struct { const char *name; double metres; } units[] =
		{ { "m", 1 }, { "dm", 0.1 }, { "cm", 0.01 }, { "mm", 0.001 }, { "in", 0.0254 },
		{ "ft", 0.3048 }, { "US survey ft", 1200.0 / 3937 } };

	for (size_t i = 0; i < sizeof units / sizeof *units; i++)
		if (strcmp(name, units[i].name) == 0) {
			*metres = units[i].metres;
			return true;
		}
	return false;
}

void eco_source_check_name(const struct eco_json *at, const char *name, size_t bytes)
{
	if (eco_utf8_has_control(name, bytes))
		eco_scene_fail(at, "a name with a control character in it, or one that steers the direction or the "
			"lines of text");
	if (bytes == 0 || bytes > 63)
		eco_scene_fail(at, "a name of %zu bytes, it must have 1 to 63", bytes);
}
