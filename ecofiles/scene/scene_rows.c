/* The entries of "instances" that name an inventory: columns, plants, heights. import_positions.c reads
 * the rows themselves. */
#include "ecofiles/scene/scene_parse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/places/inventory_text.h"

#define MAP_MAX (1u << 20)
#define VALUE_BYTES 200u
#define VALUES_MAX 4096u
#define COLUMNS_MAX (ECO_FILTERS_MAX / 2)    /* in each of "only" and "skip" */
#define SOURCES_MAX 16u              /* of height */

static const char *const row_fields[] = { "from", "layer", "x", "y", "z", "unit", "polar",
	"quadrat", "crs", "vertical", "separator", "decimal", "thousands", "species", "map", "plant",
	"only", "skip", "height_m", "crown_m", "levels", "scale", "yaw_deg", "duplicates", "seed", NULL };
static const char *const height_fields[] = { "column", "unit", "value", "from_dbh", "from_girth",
	"from_dbh_mm", "from_dbh_cm", "from_dbh_in", "max", "rate", "shape", "per_plant", "levels", NULL };
static const char *const rule_fields[] = { "max", "rate", "shape", NULL };
static const char *const polar_fields[] = { "azimuth", "distance", "unit", "whole_turn", NULL };
static const char *const quadrat_fields[] = { "column", "size_m", NULL };
static const char *const crown_fields[] = { "column", "unit", "is", NULL };

/* ---- "only" and "skip": the rows wanted ---- */

static bool parse_value(const struct eco_json *at, struct eco_value *value)
{
	char folded[VALUE_BYTES + 1];
	if (json_is_number(at->value)) {
		value->number = json_number_value(at->value);
		return true;
	}
	if (!json_is_string(at->value) || json_string_length(at->value) > VALUE_BYTES)
		return eco_json_fail(at, ECO_BAD_INPUT, "a value is a text of up to %u bytes, with \"*\" "
			"for any text, or a number", VALUE_BYTES);
	eco_text_fold(json_string_value(at->value), folded, sizeof folded);
	value->text = strdup(folded);
	return value->text || eco_json_no_memory(at);
}

static bool parse_filter(const struct eco_json *at, struct eco_filter *filter)
{
	bool several = json_is_array(at->value);
	size_t count = several ? json_array_size(at->value) : 1;
	if (several && !eco_json_array(at, VALUES_MAX))
		return false;
	filter->column = strdup(at->key);
	filter->values = calloc(count + 1, sizeof *filter->values);
	if (!filter->column || !filter->values)
		return eco_json_no_memory(at);
	for (size_t i = 0; i < count; i++) {
		struct eco_json item = several ? eco_json_item(at, i) : *at;
		filter->value_count++;
		if (!parse_value(&item, &filter->values[i]))
			return false;
	}
	return true;
}

static bool parse_columns(const struct eco_json *at, const char *name, struct eco_filter *filters,
	uint32_t *count)
{
	struct eco_json columns = eco_json_member(at, name), entry = { .file = NULL };
	if (!columns.value)
		return true;
	if (!eco_json_names(&columns, COLUMNS_MAX))
		return false;
	while (eco_json_next(&columns, &entry)) {
		struct eco_filter *filter = &filters[(*count)++];
		filter->only = strcmp(name, "only") == 0;
		if (!parse_filter(&entry, filter))
			return false;
	}
	return true;
}

bool eco_scene_parse_filters(const struct eco_json *at, struct eco_filter **filters, uint32_t *count)
{
	*filters = calloc(ECO_FILTERS_MAX, sizeof **filters);
	return *filters ? parse_columns(at, "only", *filters, count)
		&& parse_columns(at, "skip", *filters, count) : eco_json_no_memory(at);
}

/* ---- Species ---- */

static bool species_set(const struct eco_source *source, const struct eco_json *at, const char *name,
	struct eco_species *species)
{
	species->plant = ECO_NONE;
	species->variant_count = 1;
	if (!json_is_null(at->value)) {
		if (!eco_source_plant_of(source, at, &species->plant))
			return false;
		species->variant_count = source->plants[species->plant].variant_count;
	}
	species->name = strdup(name);
	return species->name || eco_json_no_memory(at);
}

struct folded { char *text; uint32_t key; };

static int compare_folded(const void *a, const void *b)
{
	return strcmp(((const struct folded *)a)->text, ((const struct folded *)b)->text);
}

/* Keys of the map that the reader takes for one species must not name different plants. */
static bool keys_differ(const struct eco_json *at, const struct eco_positions_spec *spec)
{
	struct folded *folded = calloc(spec->map_count + 1u, sizeof *folded);
	bool good = folded != NULL;
	for (uint32_t i = 0; good && i < spec->map_count; i++) {
		char text[ECO_COLUMN_BYTES];
		eco_text_fold(spec->map[i].name, text, sizeof text);
		folded[i] = (struct folded){ strdup(text), i };
		good = folded[i].text != NULL;
	}
	if (!good)
		eco_json_no_memory(at);
	else
		qsort(folded, spec->map_count, sizeof *folded, compare_folded);
	for (uint32_t i = 1; good && i < spec->map_count; i++) {
		const struct eco_species *a = &spec->map[folded[i - 1].key], *b = &spec->map[folded[i].key];
		if (strcmp(folded[i - 1].text, folded[i].text) != 0 || a->plant == b->plant)
			continue;
		eco_json_fail(at, ECO_BAD_INPUT, "\"%.60s\" and \"%.60s\" are one species (capitals and "
			"spaces do not count), with two plants", a->name, b->name);
		good = false;
	}
	for (uint32_t i = 0; folded && i < spec->map_count; i++)
		free(folded[i].text);
	free(folded);
	return good;
}

static bool parse_map(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	struct eco_json entry = { .file = NULL };
	if (!eco_json_names(at, MAP_MAX))
		return false;
	spec->map = calloc(json_object_size(at->value) + 1, sizeof *spec->map);
	if (!spec->map)
		return eco_json_no_memory(at);
	while (eco_json_next(at, &entry)) {
		bool fallback = strcmp(entry.key, "*") == 0;
		if (!species_set(source, &entry, entry.key, fallback ? &spec->fallback
				: &spec->map[spec->map_count]))
			return false;
		spec->map_count += !fallback;
	}
	return keys_differ(at, spec);
}

/* Without a map the species' names are the plants' names. */
static bool map_of_plants(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	spec->map = calloc(source->plant_count + 1u, sizeof *spec->map);
	for (uint32_t i = 0; spec->map && i < source->plant_count; i += source->plants[i].variant_count) {
		struct eco_species *species = &spec->map[spec->map_count];
		*species = (struct eco_species){ strdup(source->plants[i].name), i,
			source->plants[i].variant_count };
		if (!species->name)
			break;
		spec->map_count++;
	}
	if (!spec->map || (spec->map_count == 0 && source->plant_count > 0))
		return eco_json_no_memory(at);
	return keys_differ(at, spec);
}

static bool parse_species(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	struct eco_json map = eco_json_member(at, "map"), plant = eco_json_member(at, "plant");
	spec->fallback.plant = ECO_NONE;
	if (!eco_scene_copy_text(at, "species", ECO_COLUMN_BYTES, &spec->species))
		return false;
	if (plant.value) {
		if (spec->species || map.value)
			return eco_json_fail(&plant, ECO_BAD_INPUT, "\"plant\" makes every row this plant: "
				"leave out \"species\" and \"map\", or \"plant\"");
		return eco_source_plant_of(source, &plant, &spec->fallback.plant)
			&& species_set(source, &plant, "*", &spec->fallback);
	}
	if (!spec->species)
		return eco_json_fail(at, ECO_BAD_INPUT, "say what stands there: \"plant\": \"NAME\", or "
			"\"species\": \"COLUMN\" and a \"map\"");
	return map.value ? parse_map(source, &map, spec) : map_of_plants(source, at, spec);
}

/* ---- Heights and crowns ---- */

/* Reads "unit" unless the key's name gave it as `unit_m`. */
static bool parse_unit(const struct eco_json *at, double *unit_m)
{
	if (!eco_scene_parse_unit(at, unit_m))
		return false;
	if (*unit_m > 0)
		return true;
	return eco_json_fail(at, ECO_BAD_INPUT, "\"unit\" is missing: one of " ECO_UNITS);
}

/* "max", "rate" and "shape"; *there is false, without an error, if neither "max" nor "rate" is given. */
static bool parse_rule(const struct eco_json *at, struct eco_allometry *rule, bool *there)
{
	bool rate = json_object_get(at->value, "rate") != NULL, max = json_object_get(at->value, "max")
		!= NULL;
	*there = rate || max;
	rule->shape = 1;
	if (*there && !(rate && max))
		return eco_json_fail(at, ECO_BAD_INPUT, "a height from dbh needs \"max\" (m) and \"rate\" "
			"(per mm): h = 1.3 + (max - 1.3) (1 - exp(-rate * dbh))");
	return eco_json_number(at, "max", 1.3, 1000, &rule->max_m)
		&& eco_json_number(at, "rate", 1e-9, 1e3, &rule->rate)
		&& eco_json_number(at, "shape", 0.01, 100, &rule->shape);
}

static int compare_rules(const void *a, const void *b)
{
	uint32_t p = ((const struct eco_allometry *)a)->plant, q = ((const struct eco_allometry *)b)->plant;
	return p < q ? -1 : p > q;
}

static bool parse_per_plant(const struct eco_source *source, const struct eco_json *at, struct eco_size *size)
{
	struct eco_json entry = { .file = NULL };
	if (!eco_json_names(at, source->name_count))
		return false;
	while (eco_json_next(at, &entry)) {
		struct eco_allometry *rule = &size->rules[size->rule_count];
		bool there;
		if (!eco_source_plant_named(source, &entry, entry.key, &rule->plant) ||
			!eco_scene_object(&entry, rule_fields) || !parse_rule(&entry, rule, &there))
			return false;
		if (!there)
			return eco_json_required(&entry, "max");
		size->rule_count++;
	}
	return true;
}

static bool parse_allometry(const struct eco_source *source, const struct eco_json *at, struct eco_size *size)
{
	struct eco_json per_plant = eco_json_member(at, "per_plant");
	bool there;
	size->rules = calloc(json_object_size(per_plant.value) + 1, sizeof *size->rules);
	if (!size->rules)
		return eco_json_no_memory(at);
	if (per_plant.value && !parse_per_plant(source, &per_plant, size))
		return false;
	size->rules[size->rule_count].plant = ECO_NONE;
	if (!parse_rule(at, &size->rules[size->rule_count], &there))
		return false;
	size->rule_count += there;
	qsort(size->rules, size->rule_count, sizeof *size->rules, compare_rules);
	if (size->rule_count > 0)
		return true;
	return eco_json_fail(at, ECO_BAD_INPUT, "a height from dbh needs \"max\" (m) and \"rate\" (per mm), "
		"here or \"per_plant\": h = 1.3 + (max - 1.3) (1 - exp(-rate * dbh))");
}

/* A height's object: one member names its source. */
static bool parse_height_object(const struct eco_source *source, const struct eco_json *at,
	struct eco_size *size, uint32_t *levels)
{
	static const struct { const char *key; double unit_m; enum eco_size_kind kind; double factor;
		} from[] = {
		{ "column", 1, ECO_SIZE_COLUMN, 1 }, { "from_dbh", 0, ECO_SIZE_DBH, 1 },
			{ "from_girth", 0, ECO_SIZE_DBH, 1 / M_PI },
		{ "from_dbh_mm", 0.001, ECO_SIZE_DBH, 1 }, { "from_dbh_cm", 0.01, ECO_SIZE_DBH, 1 },
		{ "from_dbh_in", 0.0254, ECO_SIZE_DBH, 1 } };
	struct eco_json unit = eco_json_member(at, "unit");
	uint64_t count = *levels;
	unsigned kinds = 0, which = 0;
	if (!eco_scene_object(at, height_fields) || !eco_json_whole(at, "levels", 1, 1024, &count))
		return false;
	*levels = (uint32_t)count;
	for (unsigned i = 0; i < sizeof from / sizeof *from; i++)
		if (json_object_get(at->value, from[i].key)) {
			kinds++;
			which = i;
		}
	if (json_object_get(at->value, "value")) {
		size->kind = ECO_SIZE_NUMBER;
		if (kinds++ == 0)
			return eco_json_number(at, "value", 0.001, 1000, &size->value_m);
	}
	if (kinds != 1)
		return eco_json_fail(at, ECO_BAD_INPUT, "a height comes from exactly one of column, value, "
			"from_dbh, from_girth, from_dbh_mm, from_dbh_cm, from_dbh_in");
	if (from[which].kind == ECO_SIZE_DBH && from[which].unit_m > 0 && unit.value)
		return eco_json_fail(&unit, ECO_BAD_INPUT, "\"%s\" says the unit: leave out \"unit\", or "
			"write \"from_dbh\"", from[which].key);
	size->kind = from[which].kind;
	size->factor = from[which].factor;
	size->unit_m = from[which].unit_m;
	return eco_scene_copy_text(at, from[which].key, ECO_COLUMN_BYTES, &size->column)
		&& parse_unit(at, &size->unit_m)
		&& (size->kind != ECO_SIZE_DBH || parse_allometry(source, at, size));
}

static bool parse_height_source(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	struct eco_size *size = &spec->heights[spec->height_count++];
	if (json_is_string(at->value)) {
		*size = (struct eco_size){ .kind = ECO_SIZE_COLUMN, .unit_m = 1, .factor = 1 };
		return eco_json_is_text(at, ECO_COLUMN_BYTES)
			&& ((size->column = strdup(json_string_value(at->value))) || eco_json_no_memory(at));
	}
	if (json_is_object(at->value))
		return parse_height_object(source, at, size, &spec->levels);
	double number = json_is_number(at->value) ? json_number_value(at->value) : NAN;
	size->kind = ECO_SIZE_NUMBER;
	size->value_m = number;
	if (number >= 0.001 && number <= 1000)
		return true;
	return eco_json_fail(at, ECO_BAD_INPUT, "a height is a number of metres between 0.001 and 1000, a "
		"column of metres such as \"Height\", or an object such as {\"column\": \"Height\", "
		"\"unit\": \"ft\"}");
}

static bool parse_height(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	struct eco_json height = eco_json_member(at, "height_m");
	bool several = json_is_array(height.value);
	size_t count = several ? json_array_size(height.value) : 1;
	uint64_t levels = 0;
	if (!eco_json_whole(at, "levels", 1, 1024, &levels))
		return false;
	spec->levels = (uint32_t)levels;
	if (!height.value)
		return true;
	if (several && (!eco_json_array(&height, SOURCES_MAX) || count == 0))
		return eco_json_fail(&height, ECO_BAD_INPUT, "an array of heights that is empty");
	spec->heights = calloc(count, sizeof *spec->heights);
	if (!spec->heights)
		return eco_json_no_memory(at);
	for (size_t i = 0; i < count; i++) {
		struct eco_json item = several ? eco_json_item(&height, i) : height;
		if (!parse_height_source(source, &item, spec))
			return false;
	}
	return true;
}

static bool parse_crown(const struct eco_json *at, struct eco_positions_spec *spec)
{
	struct eco_json crown = eco_json_member(at, "crown_m"), is_node;
	const char *is = NULL;
	if (!crown.value)
		return true;
	spec->crown.unit_m = 1;
	if (!eco_scene_object(&crown, crown_fields) || !eco_json_required(&crown, "column")
		|| !eco_json_required(&crown, "is") || !eco_json_text(&crown, "is", 16, &is)
		|| !eco_scene_copy_text(&crown, "column", ECO_COLUMN_BYTES, &spec->crown.column)
		|| !eco_scene_parse_unit(&crown, &spec->crown.unit_m))
		return false;
	spec->crown.kind = ECO_SIZE_COLUMN;
	spec->crown.factor = strcmp(is, "diameter") == 0 ? 0.5 : 1;
	if (strcmp(is, "diameter") == 0 || strcmp(is, "radius") == 0)
		return true;
	is_node = eco_json_member(&crown, "is");
	return eco_json_fail(&is_node, ECO_BAD_INPUT, "\"is\" is \"radius\" or \"diameter\"");
}

/* ---- The entry ---- */

static bool parse_sign(const struct eco_json *at, const char *key, const char *signs, const char *says,
	char *sign)
{
	struct eco_json node = eco_json_member(at, key);
	const char *text = NULL;
	if (!eco_json_text(at, key, 8, &text))
		return false;
	if (!text)
		return true;
	*sign = *text;
	if (strlen(text) == 1 && strchr(signs, *text))
		return true;
	return eco_json_fail(&node, ECO_BAD_INPUT, "\"%s\" is one of %s", key, says);
}

/* The signs of numbers differ. */
static bool parse_signs(const struct eco_json *at, struct eco_positions_spec *spec)
{
	struct eco_json node = eco_json_member(at, "thousands");
	if (!parse_sign(at, "decimal", ".,", "\".\" \",\"", &spec->decimal)
			|| !parse_sign(at, "thousands", ".,", "\".\" \",\"", &spec->thousands))
		return false;
	if (spec->thousands && spec->thousands == spec->decimal)
		return eco_json_fail(&node, ECO_BAD_INPUT, "\"thousands\" and \"decimal\" are different signs");
	if (spec->thousands)
		spec->decimal = spec->thousands == ',' ? '.' : ',';
	return true;
}

static bool parse_duplicates(const struct eco_json *at, struct eco_positions_spec *spec)
{
	struct eco_json node = eco_json_member(at, "duplicates");
	const char *text = "keep";
	if (!eco_json_text(at, "duplicates", 8, &text))
		return false;
	spec->skip_duplicates = strcmp(text, "skip") == 0;
	if (spec->skip_duplicates || strcmp(text, "keep") == 0)
		return true;
	return eco_json_fail(&node, ECO_BAD_INPUT, "\"duplicates\" is \"keep\" or \"skip\"");
}

static bool parse_file(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	struct eco_json from = eco_json_member(at, "from");
	if (!eco_scene_object(at, row_fields))
		return false;
	eco_json_place(&from, &spec->line, &spec->column);
	return eco_scene_parse_path(source, &from, &spec->path)
		&& eco_scene_copy_text(at, "layer", ECO_COLUMN_BYTES, &spec->layer)
		&& parse_sign(at, "separator", ",;\t|", "\",\" \";\" \"\\t\" \"|\"", &spec->separator)
		&& parse_signs(at, spec);
}

static bool parse_polar(const struct eco_json *at, struct eco_polar *polar)
{
	struct eco_json node = eco_json_member(at, "polar"), turn;
	if (!node.value)
		return true;
	polar->unit_m = 1;
	polar->whole_turn = 360;
	if (!eco_scene_object(&node, polar_fields) || !eco_json_required(&node, "azimuth")
			|| !eco_json_required(&node, "distance")
			|| !eco_scene_copy_text(&node, "azimuth", ECO_COLUMN_BYTES, &polar->azimuth)
			|| !eco_scene_copy_text(&node, "distance", ECO_COLUMN_BYTES, &polar->distance)
			|| !eco_scene_parse_unit(&node, &polar->unit_m)
			|| !eco_json_number(&node, "whole_turn", 360, 400, &polar->whole_turn))
		return false;
	turn = eco_json_member(&node, "whole_turn");
	return polar->whole_turn == 360 || polar->whole_turn == 400
		|| eco_json_fail(&turn, ECO_BAD_INPUT, "\"whole_turn\" is 360 (degrees) or 400 (gon)");
}

static bool parse_quadrat(const struct eco_json *at, struct eco_quadrat *quadrat)
{
	struct eco_json node = eco_json_member(at, "quadrat");
	if (!node.value)
		return true;
	return eco_scene_object(&node, quadrat_fields) && eco_json_required(&node, "column")
		&& eco_json_required(&node, "size_m") && eco_json_required(at, "x")
		&& eco_scene_copy_text(&node, "column", ECO_COLUMN_BYTES, &quadrat->column)
		&& eco_json_number(&node, "size_m", 0.1, 1000, &quadrat->size_m);
}

/* "unit" of x and y, which a CRS of theirs says. */
static bool parse_place_unit(const struct eco_json *at, struct eco_positions_spec *spec)
{
	struct eco_json unit = eco_json_member(at, "unit");
	if (!eco_scene_parse_unit(at, &spec->unit_m))
		return false;
	if (unit.value && (spec->crs || !spec->x))
		return eco_json_fail(&unit, ECO_BAD_INPUT, "\"unit\" is that of x and y without a \"crs\", "
			"which has its own");
	return true;
}

static bool parse_place(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	if (json_object_get(at->value, "x") && !eco_json_required(at, "y"))
		return false;
	if (json_object_get(at->value, "y") && !eco_json_required(at, "x"))
		return false;
	return eco_scene_copy_text(at, "x", ECO_COLUMN_BYTES, &spec->x)
		&& eco_scene_copy_text(at, "y", ECO_COLUMN_BYTES, &spec->y)
		&& eco_scene_copy_text(at, "z", ECO_COLUMN_BYTES, &spec->z)
		&& eco_scene_copy_text(at, "vertical", ECO_PATH_BYTES, &spec->vertical)
		&& eco_scene_parse_crs(source, at, "crs", &spec->crs)
		&& parse_place_unit(at, spec) && parse_polar(at, &spec->polar)
		&& parse_quadrat(at, &spec->quadrat);
}

bool eco_scene_parse_rows(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	if (!parse_file(source, at, spec)
			|| !eco_scene_copy_text(at, "yaw_deg", ECO_COLUMN_BYTES, &spec->yaw_deg)
		|| !eco_scene_copy_text(at, "scale", ECO_COLUMN_BYTES, &spec->scale)
		|| !eco_json_whole(at, "seed", 0, INT64_MAX, &spec->seed) || !parse_duplicates(at, spec)
		|| !parse_species(source, at, spec) || !parse_height(source, at, spec)
		|| !parse_crown(at, spec))
		return false;
	return eco_scene_parse_filters(at, &spec->filters, &spec->filter_count)
		&& parse_place(source, at, spec);
}

static void free_size(struct eco_size *size)
{
	free(size->column);
	free(size->rules);
}

void eco_positions_spec_free(struct eco_positions_spec *spec)
{
	char *texts[] = { spec->path, spec->layer, spec->x, spec->y, spec->z, spec->crs, spec->vertical,
		spec->species, spec->yaw_deg, spec->scale, spec->fallback.name, spec->polar.azimuth,
		spec->polar.distance, spec->quadrat.column };

	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
		free(texts[i]);
	for (uint32_t i = 0; i < spec->map_count; i++)
		free(spec->map[i].name);
	for (uint32_t i = 0; i < spec->height_count; i++)
		free_size(&spec->heights[i]);
	free_size(&spec->crown);
	free(spec->map);
	free(spec->heights);
	eco_filters_free(spec->filters, spec->filter_count);
	*spec = (struct eco_positions_spec){ .path = NULL };
}
