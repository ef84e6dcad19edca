/* The entries of "instances" that name an inventory: which columns, which plants, which heights. Reading the rows themselves is
 * import_positions.c. */
#include "ecofiles/scene_parse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COLUMN_BYTES 256u
#define MAP_MAX (1u << 20)

static const char *const row_fields[] = { "from", "x", "y", "z", "crs", "separator", "species", "map", "plant", "height_m",
	"yaw_deg", "seed", NULL };
static const char *const height_fields[] = { "from_dbh_mm", "from_dbh_cm", "from_dbh_in", "max", "rate", "column", "unit", "value",
	"levels", NULL };

static bool copy_text(const struct eco_json *at, const char *key, size_t bytes_max, char **out)
{
	const char *text = NULL;

	if (!eco_json_text(at, key, bytes_max, &text))
		return false;
	if (text == NULL)
		return true;
	*out = strdup(text);
	if (*out == NULL)
		eco_json_fail(at, ECO_NO_MEMORY, "out of memory");
	return *out != NULL;
}

/* ---- Species ---- */

static int species_compare(const void *a, const void *b)
{
	return strcmp(((const struct eco_species *)a)->name, ((const struct eco_species *)b)->name);
}

static bool species_set(const struct eco_source *source, const struct eco_json *at, const char *name, struct eco_species *species)
{
	species->plant = ECO_NONE;
	species->variant_count = 1;
	if (!json_is_null(at->value)) {
		if (!eco_source_plant_of(source, at, &species->plant))
			return false;
		species->variant_count = source->plants[species->plant].variant_count;
	}
	species->name = strdup(name);
	if (species->name == NULL)
		eco_json_fail(at, ECO_NO_MEMORY, "out of memory");
	return species->name != NULL;
}

static bool parse_map(const struct eco_source *source, const struct eco_json *at, struct eco_positions_spec *spec)
{
	static const char *const any[] = { NULL };
	struct eco_json entry = { .file = at->file, .parent = at };
	const char *key;
	json_t *value;

	if (!json_is_object(at->value))
		return eco_json_object(at, any);
	if (json_object_size(at->value) > MAP_MAX) {
		eco_json_fail(at, ECO_TOO_LARGE, "more than %u species", MAP_MAX);
		return false;
	}
	spec->map = calloc(json_object_size(at->value) + 1, sizeof *spec->map);
	if (spec->map == NULL) {
		eco_json_fail(at, ECO_NO_MEMORY, "out of memory");
		return false;
	}
	json_object_foreach((json_t *)at->value, key, value) {
		bool fallback = strcmp(key, "*") == 0;

		entry.key = key;
		entry.value = value;
		if (!species_set(source, &entry, key, fallback ? &spec->fallback : &spec->map[spec->map_count]))
			return false;
		spec->map_count += !fallback;
		entry.index++;
	}
	qsort(spec->map, spec->map_count, sizeof *spec->map, species_compare);
	return true;
}

/* Without a map a species is the name of a plant. */
static bool map_of_plants(const struct eco_source *source, const struct eco_json *at, struct eco_positions_spec *spec)
{
	spec->map = calloc(source->plant_count + 1u, sizeof *spec->map);
	for (uint32_t i = 0; spec->map != NULL && i < source->plant_count; i += source->plants[i].variant_count) {
		struct eco_species *species = &spec->map[spec->map_count];

		*species = (struct eco_species){ strdup(source->plants[i].name), i, source->plants[i].variant_count };
		if (species->name == NULL)
			break;
		spec->map_count++;
	}
	if (spec->map == NULL || (spec->map_count == 0 && source->plant_count > 0)) {
		eco_json_fail(at, ECO_NO_MEMORY, "out of memory");
		return false;
	}
	qsort(spec->map, spec->map_count, sizeof *spec->map, species_compare);
	return true;
}

static bool parse_species(const struct eco_source *source, const struct eco_json *at, struct eco_positions_spec *spec)
{
	struct eco_json map = eco_json_member(at, "map"), plant = eco_json_member(at, "plant");

	spec->fallback.plant = ECO_NONE;
	if (!copy_text(at, "species", COLUMN_BYTES, &spec->species))
		return false;
	if (plant.value != NULL) {
		if (spec->species != NULL || map.value != NULL) {
			eco_json_fail(&plant, ECO_BAD_INPUT, "\"plant\" makes every row this plant: leave out \"species\" and \"map\", or \"plant\"");
			return false;
		}
		return eco_source_plant_of(source, &plant, &spec->fallback.plant) && species_set(source, &plant, "*", &spec->fallback);
	}
	if (spec->species == NULL) {
		eco_json_fail(at, ECO_BAD_INPUT, "say what stands there: \"plant\": \"NAME\", or \"species\": \"COLUMN\" and a \"map\"");
		return false;
	}
	return map.value != NULL ? parse_map(source, &map, spec) : map_of_plants(source, at, spec);
}

/* ---- Heights ---- */

static bool parse_dbh(const struct eco_json *at, struct eco_positions_spec *spec, const char *key, double unit_mm)
{
	struct eco_json rate = eco_json_member(at, "rate"), max = eco_json_member(at, "max");

	spec->height = ECO_HEIGHT_DBH;
	spec->unit_m = unit_mm;
	spec->max_m = spec->rate = NAN;
	if (rate.value == NULL || max.value == NULL) {
		eco_json_fail(at, ECO_BAD_INPUT, "\"%s\" needs \"max\" (m) and \"rate\" (per mm): h = 1.3 + (max - 1.3) (1 - exp(-rate * dbh))",
			key);
		return false;
	}
	return copy_text(at, key, COLUMN_BYTES, &spec->height_column) && eco_json_number(at, "max", 1.3, 1000, &spec->max_m)
		&& eco_json_number(at, "rate", 1e-9, 1e3, &spec->rate);
}

bool eco_unit_metres(const char *name, double *metres)
{
	static const struct { const char *name; double metres; } units[] = { { "m", 1 }, { "cm", 0.01 }, { "mm", 0.001 }, { "in", 0.0254 },
		{ "ft", 0.3048 }, { "US survey ft", 1200.0 / 3937 } };

	for (size_t i = 0; i < sizeof units / sizeof *units; i++)
		if (strcmp(name, units[i].name) == 0) {
			*metres = units[i].metres;
			return true;
		}
	return false;
}

static bool parse_unit(const struct eco_json *at, double *unit_m)
{
	struct eco_json unit = eco_json_member(at, "unit");
	const char *name = "m";

	if (!eco_json_text(at, "unit", 16, &name))
		return false;
	if (eco_unit_metres(name, unit_m))
		return true;
	eco_json_fail(&unit, ECO_BAD_INPUT, "unit \"%.20s\" is not one of " ECO_UNITS, name);
	return false;
}

/* {"from_dbh_mm": ..} or {"column": ..} or {"value": ..}: exactly one of them. */
static bool parse_height_object(const struct eco_json *at, struct eco_positions_spec *spec)
{
	static const struct { const char *key; double mm; } dbh[] = { { "from_dbh_mm", 1 }, { "from_dbh_cm", 10 }, { "from_dbh_in", 25.4 } };
	uint64_t levels = 0;
	unsigned kinds = 0;

	if (!eco_json_object(at, height_fields) || !eco_json_whole(at, "levels", 1, 1024, &levels))
		return false;
	spec->levels = (uint32_t)levels;
	for (size_t i = 0; i < 3; i++)
		if (json_object_get(at->value, dbh[i].key) != NULL) {
			kinds++;
			if (kinds == 1 && !parse_dbh(at, spec, dbh[i].key, dbh[i].mm))
				return false;
		}
	if (json_object_get(at->value, "column") != NULL && kinds++ == 0) {
		spec->height = ECO_HEIGHT_COLUMN;
		if (!copy_text(at, "column", COLUMN_BYTES, &spec->height_column) || !parse_unit(at, &spec->unit_m))
			return false;
	}
	if (json_object_get(at->value, "value") != NULL && kinds++ == 0) {
		spec->height = ECO_HEIGHT_NUMBER;
		if (!eco_json_number(at, "value", 0.001, 1000, &spec->height_value_m))
			return false;
	}
	if (kinds != 1)
		eco_json_fail(at, ECO_BAD_INPUT, "a height comes from exactly one of from_dbh_mm, from_dbh_cm, from_dbh_in, column, value");
	return kinds == 1;
}

static bool parse_height(const struct eco_json *at, struct eco_positions_spec *spec)
{
	struct eco_json height = eco_json_member(at, "height_m");

	if (height.value == NULL)
		return true;
	if (json_is_object(height.value))
		return parse_height_object(&height, spec);
	spec->height = ECO_HEIGHT_NUMBER;
	return eco_json_number(at, "height_m", 0.001, 1000, &spec->height_value_m);
}

/* ---- The entry ---- */

static bool parse_separator(const struct eco_json *at, struct eco_positions_spec *spec)
{
	struct eco_json separator = eco_json_member(at, "separator");
	const char *text = ",";

	if (!eco_json_text(at, "separator", 8, &text))
		return false;
	if (strlen(text) != 1 || strchr(",;\t|", *text) == NULL) {
		eco_json_fail(&separator, ECO_BAD_INPUT, "\"separator\" is one of \",\" \";\" \"\\t\" \"|\"");
		return false;
	}
	spec->separator = *text;
	return true;
}

bool eco_scene_parse_rows(const struct eco_source *source, const struct eco_json *at, struct eco_positions_spec *spec)
{
	struct eco_json from = eco_json_member(at, "from"), crs = eco_json_member(at, "crs");
	const char *path = NULL;

	if (!eco_json_object(at, row_fields) || !eco_json_text(at, "from", ECO_PATH_BYTES, &path) || !eco_json_required(at, "x")
		|| !eco_json_required(at, "y"))
		return false;
	eco_json_place(&from, &spec->line, &spec->column);
	spec->path = eco_path_beside(source->path, path);
	if (spec->path == NULL) {
		eco_json_fail(&from, ECO_NO_MEMORY, "out of memory");
		return false;
	}
	if (!eco_source_has_file(source, &from, spec->path))
		return false;
	if (!copy_text(at, "x", COLUMN_BYTES, &spec->x) || !copy_text(at, "y", COLUMN_BYTES, &spec->y)
		|| !copy_text(at, "z", COLUMN_BYTES, &spec->z) || !copy_text(at, "crs", ECO_PATH_BYTES, &spec->crs)
		|| !copy_text(at, "yaw_deg", COLUMN_BYTES, &spec->yaw_deg) || !eco_json_whole(at, "seed", 0, INT64_MAX, &spec->seed)
		|| !parse_separator(at, spec) || !parse_species(source, at, spec) || !parse_height(at, spec))
		return false;
	if (source->crs != NULL && spec->crs == NULL) {
		eco_json_fail(at, ECO_BAD_INPUT, "\"crs\" is missing: the scene is in %.80s, so these rows need theirs, such as \"crs\": \"%.80s\"",
			source->crs, source->crs);
		return false;
	}
	if (source->crs == NULL && spec->crs != NULL) {
		eco_json_fail(&crs, ECO_BAD_INPUT, "the scene has no CRS to convert to: add \"crs\": \"%.80s\" and \"origin\" to the scene, "
			"or leave this one out", spec->crs);
		return false;
	}
	return true;
}

void eco_positions_spec_free(struct eco_positions_spec *spec)
{
	free(spec->path);
	free(spec->x);
	free(spec->y);
	free(spec->z);
	free(spec->crs);
	free(spec->species);
	free(spec->height_column);
	free(spec->yaw_deg);
	free(spec->fallback.name);
	for (uint32_t i = 0; i < spec->map_count; i++)
		free(spec->map[i].name);
	free(spec->map);
	*spec = (struct eco_positions_spec){ .path = NULL };
}
