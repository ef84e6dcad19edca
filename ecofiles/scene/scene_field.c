/* Fields that several parts of a scene file have: paths, CRSs, units, texts to keep. */
#include "ecofiles/base/confine.h"
#include "ecofiles/scene/scene_parse.h"
#include "ecofiles/base/utf8.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char *path_beside(const char *base, const char *relative)
{
	const char *slash = strrchr(base, '/');
	size_t folder = slash && *relative != '/' ? (size_t)(slash - base) + 1 : 0;
	char *path = malloc(folder + strlen(relative) + 1);
	if (path) {
		memcpy(path, base, folder);
		strcpy(path + folder, relative);
	}
	return path;
}

/* ---- Notes ---- */

#define FIELDS_MAX 32u

static bool is_note(const struct eco_json *at)
{
	return json_is_string(at->value)
		|| eco_json_fail(at, ECO_BAD_INPUT, "a note is a text");
}

static bool check_notes(const struct eco_json *at)
{
	struct eco_json member = { .file = NULL };
	if (json_is_object(at->value)) {
		while (eco_json_next(at, &member))
			if (!is_note(&member))
				return false;
		return true;
	}
	if (!json_is_array(at->value))
		return is_note(at);
	for (size_t i = 0; i < json_array_size(at->value); i++) {
		struct eco_json item = eco_json_item(at, i);
		if (!is_note(&item))
			return false;
	}
	return true;
}

bool eco_scene_object(const struct eco_json *at, const char *const *fields)
{
	const char *all[FIELDS_MAX + 2];
	size_t count = 0;
	for (; fields[count] && count < FIELDS_MAX; count++)
		all[count] = fields[count];
	all[count++] = "notes";
	all[count] = NULL;
	if (!eco_json_object(at, all))
		return false;
	struct eco_json notes = eco_json_member(at, "notes");
	return !notes.value || check_notes(&notes);
}

/* ---- Paths ---- */

bool eco_scene_parse_path(const struct eco_source *source, const struct eco_json *at, char **path)
{
	if (!eco_json_is_text(at, ECO_PATH_BYTES))
		return false;
	*path = path_beside(source->path, json_string_value(at->value));
	if (!*path)
		return eco_json_no_memory(at);
	if (source->on_disk && !eco_confined_may_read(*path))
		return eco_json_fail(at, ECO_BAD_INPUT, "%.300s lies outside of the folder to which "
			"--confine keeps reading", *path);
	if (!source->on_disk || access(*path, R_OK) == 0)
		return true;
	return eco_json_fail(at, errno == ENOENT ? ECO_NOT_FOUND : ECO_IO, "%.300s: %s%s", *path,
		strerror(errno), errno == ENOENT ? "; paths count from the folder of the file that names them"
		: eco_advice_read(errno));
}

bool eco_scene_parse_paths(const struct eco_source *source, const struct eco_json *at, const char *what,
	size_t most, char ***paths, uint32_t *count)
{
	bool several = json_is_array(at->value);
	size_t size = several ? json_array_size(at->value) : 1;
	if (size == 0)
		return eco_json_fail(at, ECO_BAD_INPUT, "it names no %s", what);
	if (several && !eco_json_array(at, most))
		return false;
	*paths = calloc(size, sizeof **paths);
	if (!*paths)
		return eco_json_no_memory(at);
	for (size_t i = 0; i < size; i++) {
		struct eco_json item = several ? eco_json_item(at, i) : *at;
		if (!eco_scene_parse_path(source, &item, &(*paths)[(*count)++]))
			return false;
	}
	return true;
}

bool eco_scene_parse_crs(const struct eco_source *source, const struct eco_json *at, const char *key,
	char **crs)
{
	struct eco_json node = eco_json_member(at, key);
	if (!eco_scene_copy_text(at, key, ECO_PATH_BYTES, crs))
		return false;
	if (!*crs || source->crs)
		return true;
	return eco_json_fail(&node, ECO_BAD_INPUT, "the scene has no CRS to convert to: add \"crs\": "
		"\"%.80s\" and \"origin\" to the scene, or leave this one out", *crs);
}

bool eco_scene_copy_text(const struct eco_json *at, const char *key, size_t bytes_max, char **out)
{
	const char *text = NULL;
	if (!eco_json_text(at, key, bytes_max, &text))
		return false;
	if (!text)
		return true;
	*out = strdup(text);
	return *out || eco_json_no_memory(at);
}

bool eco_up_of(const char *name, enum eco_up *up)
{
	static const struct { const char *name; enum eco_up up; } axes[] =
		{ { "x", ECO_UP_X }, { "y", ECO_UP_Y }, { "z", ECO_UP_Z } };

	for (size_t i = 0; i < sizeof axes / sizeof *axes; i++)
		if (strcmp(name, axes[i].name) == 0) {
			*up = axes[i].up;
			return true;
		}
	return false;
}

bool eco_unit_metres(const char *name, double *metres)
{
	static const struct { const char *name; double metres; } units[] =
		{ { "m", 1 }, { "cm", 0.01 }, { "mm", 0.001 }, { "in", 0.0254 },
		{ "ft", 0.3048 }, { "US survey ft", 1200.0 / 3937 } };

	for (size_t i = 0; i < sizeof units / sizeof *units; i++)
		if (strcmp(name, units[i].name) == 0) {
			*metres = units[i].metres;
			return true;
		}
	return false;
}

bool eco_scene_parse_unit(const struct eco_json *at, double *unit_m)
{
	struct eco_json unit = eco_json_member(at, "unit");
	const char *name = NULL;
	if (!eco_json_text(at, "unit", 16, &name))
		return false;
	if (!name || eco_unit_metres(name, unit_m))
		return true;
	return eco_json_fail(&unit, ECO_BAD_INPUT, "unit \"%.20s\" is not one of " ECO_UNITS, name);
}

bool eco_source_name_is_fine(const struct eco_json *at, const char *name, size_t bytes)
{
	if (eco_utf8_has_control(name, bytes))
		return eco_json_fail(at, ECO_BAD_INPUT, "a name with a control character in it, or one that "
			"steers the direction or the lines of text");
	if (bytes == 0 || bytes > 63)
		return eco_json_fail(at, ECO_BAD_INPUT, "a name of %zu bytes, it must have 1 to 63", bytes);
	return true;
}
