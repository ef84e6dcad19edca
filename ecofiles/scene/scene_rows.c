/* The entries of "instances" that name an inventory: columns, plants, heights. import_positions.c reads
 * the rows themselves. */
#include "ecofiles/base/memory.h"
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

#define FIELD(name, kind, low, high, member) ECO_FIELD(name, kind, low, high, positions_spec, member)
#define COLUMN(name, member) FIELD(name, COLUMN, 0, 0, member)
static const struct eco_field row_fields[] = {
	FIELD("from", PATH, 0, 0, path), COLUMN("layer", layer), COLUMN("x", x), COLUMN("y", y), COLUMN("z", z),
	FIELD("unit", UNIT, 0, 0, unit_m), ECO_OTHER("polar"), ECO_OTHER("quadrat"), FIELD("crs", CRS, 0, 0, crs),
	FIELD("vertical", TEXT, 0, 0, vertical), ECO_OTHER("separator"), ECO_OTHER("decimal"),
	ECO_OTHER("thousands"), COLUMN("species", species), ECO_OTHER("map"), ECO_OTHER("plant"),
	ECO_OTHER("only"), ECO_OTHER("skip"), ECO_OTHER("height_m"), ECO_OTHER("crown_m"),
	FIELD("levels", WHOLE, 1, 1024, levels), COLUMN("scale", scale), COLUMN("yaw_deg", yaw_deg),
	ECO_OTHER("duplicates"), FIELD("seed", WHOLE, 0, INT64_MAX, seed), ECO_FIELDS_END
};
static const struct eco_field polar_fields[] = {
	FIELD("azimuth", COLUMN | ECO_IS_REQUIRED, 0, 0, polar.azimuth),
	FIELD("distance", COLUMN | ECO_IS_REQUIRED, 0, 0, polar.distance),
	FIELD("unit", UNIT, 0, 0, polar.unit_m), FIELD("whole_turn", NUMBER, 360, 400, polar.whole_turn),
	ECO_FIELDS_END
};
static const struct eco_field quadrat_fields[] = {
	FIELD("column", COLUMN | ECO_IS_REQUIRED, 0, 0, quadrat.column),
	FIELD("size_m", NUMBER | ECO_IS_REQUIRED, 0.1, 1000, quadrat.size_m), ECO_FIELDS_END
};
static const struct eco_field crown_fields[] = {
	FIELD("column", COLUMN | ECO_IS_REQUIRED, 0, 0, crown.column), FIELD("unit", UNIT, 0, 0, crown.unit_m),
	{ "is", ECO_IS_OTHER | ECO_IS_REQUIRED, 0, 0, 0, 0 }, ECO_FIELDS_END
};
#define RULE(record, member) ECO_FIELD("max", NUMBER, 1.3, 1000, record, member max_m), \
	ECO_FIELD("rate", NUMBER, 1e-9, 1e3, record, member rate), \
	ECO_FIELD("shape", NUMBER, 0.01, 100, record, member shape)
static const struct eco_field rule_fields[] = { RULE(allometry, ), ECO_FIELDS_END };
/* A height's object. */
struct eco_height { struct eco_size size; struct eco_allometry rule; uint32_t levels; };
#define SOURCE(name) ECO_FIELD(name, COLUMN, 0, 0, height, size.column)
static const struct eco_field height_fields[] = {
	SOURCE("column"), ECO_FIELD("unit", UNIT, 0, 0, height, size.unit_m),
	ECO_FIELD("value", NUMBER, 0.001, 1000, height, size.value_m), SOURCE("from_dbh"), SOURCE("from_girth"),
	SOURCE("from_dbh_mm"), SOURCE("from_dbh_cm"), SOURCE("from_dbh_in"), RULE(height, rule.),
	ECO_OTHER("per_plant"), ECO_FIELD("levels", WHOLE, 1, 1024, height, levels), ECO_FIELDS_END
};

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
	value->text = eco_copy_text(folded);
	return true;
}

static bool parse_filter(const struct eco_json *at, struct eco_filter *filter)
{
	if (json_is_array(at->value) && !eco_json_array(at, VALUES_MAX))
		return false;
	filter->column = eco_copy_text(at->key);
	filter->values = eco_alloc(eco_scene_several(at), sizeof *filter->values);
	for (size_t i = 0; i < eco_scene_several(at); i++) {
		struct eco_json item = eco_scene_one(at, i);
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
	*filters = eco_alloc(ECO_FILTERS_MAX, sizeof **filters);
	return parse_columns(at, "only", *filters, count) && parse_columns(at, "skip", *filters, count);
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
	species->name = eco_copy_text(name);
	return true;
}

struct folded { char *text; uint32_t key; };

static int compare_folded(const void *a, const void *b)
{
	return strcmp(((const struct folded *)a)->text, ((const struct folded *)b)->text);
}

/* Keys of the map that the reader takes for one species must not name different plants. */
static bool keys_differ(const struct eco_json *at, const struct eco_positions_spec *spec)
{
	struct folded *folded = eco_alloc(spec->map_count, sizeof *folded);
	bool good = true;
	for (uint32_t i = 0; i < spec->map_count; i++) {
		char text[ECO_COLUMN_BYTES];
		eco_text_fold(spec->map[i].name, text, sizeof text);
		folded[i] = (struct folded){ eco_copy_text(text), i };
	}
	qsort(folded, spec->map_count, sizeof *folded, compare_folded);
	for (uint32_t i = 1; good && i < spec->map_count; i++) {
		const struct eco_species *a = &spec->map[folded[i - 1].key], *b = &spec->map[folded[i].key];
		if (strcmp(folded[i - 1].text, folded[i].text) != 0 || a->plant == b->plant)
			continue;
		eco_json_fail(at, ECO_BAD_INPUT, "\"%.60s\" and \"%.60s\" are one species (capitals and "
			"spaces do not count), with two plants", a->name, b->name);
		good = false;
	}
	for (uint32_t i = 0; i < spec->map_count; i++)
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
	spec->map = eco_alloc(json_object_size(at->value), sizeof *spec->map);
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
	spec->map = eco_alloc(source->plant_count, sizeof *spec->map);
	for (uint32_t i = 0; i < source->plant_count; i += source->plants[i].variant_count) {
		struct eco_species *species = &spec->map[spec->map_count++];
		*species = (struct eco_species){ eco_copy_text(source->plants[i].name), i,
			source->plants[i].variant_count };
	}
	return keys_differ(at, spec);
}

static bool parse_species(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	struct eco_json map = eco_json_member(at, "map"), plant = eco_json_member(at, "plant");
	spec->fallback.plant = ECO_NONE;
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

/* *there is false, without an error, if neither "max" nor "rate" is given. */
static bool rule_is_whole(const struct eco_json *at, const struct eco_allometry *rule, bool *there)
{
	*there = rule->max_m > 0 || rule->rate > 0;
	if (!*there || (rule->max_m > 0 && rule->rate > 0))
		return true;
	return eco_json_fail(at, ECO_BAD_INPUT, "a height from dbh needs \"max\" (m) and \"rate\" "
		"(per mm): h = 1.3 + (max - 1.3) (1 - exp(-rate * dbh))");
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
		rule->shape = 1;
		if (!eco_source_plant_named(source, &entry, entry.key, &rule->plant) ||
			!eco_scene_fields(source, &entry, rule_fields, rule) ||
			!rule_is_whole(&entry, rule, &there))
			return false;
		if (!there)
			return eco_json_required(&entry, "max");
		size->rule_count++;
	}
	return true;
}

static bool parse_allometry(const struct eco_source *source, const struct eco_json *at, struct eco_size *size,
	const struct eco_allometry *others)
{
	struct eco_json per_plant = eco_json_member(at, "per_plant");
	bool there;
	size->rules = eco_alloc(json_object_size(per_plant.value) + 1, sizeof *size->rules);
	if ((per_plant.value && !parse_per_plant(source, &per_plant, size))
			|| !rule_is_whole(at, others, &there))
		return false;
	size->rules[size->rule_count] = *others;
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
	enum { SOURCES = sizeof from / sizeof *from };
	struct eco_height height = { .rule = { .plant = ECO_NONE, .shape = 1 }, .levels = *levels };
	struct eco_json unit = eco_json_member(at, "unit");
	unsigned kinds = json_object_get(at->value, "value") != NULL, which = SOURCES;
	bool good = eco_scene_fields(source, at, height_fields, &height);
	*size = height.size;
	*levels = height.levels;
	for (unsigned i = 0; i < SOURCES; i++)
		if (json_object_get(at->value, from[i].key)) {
			kinds++;
			which = i;
		}
	if (!good || kinds != 1)
		return good && eco_json_fail(at, ECO_BAD_INPUT, "a height comes from exactly one of column, value, "
			"from_dbh, from_girth, from_dbh_mm, from_dbh_cm, from_dbh_in");
	size->kind = which < SOURCES ? from[which].kind : ECO_SIZE_NUMBER;
	if (size->kind == ECO_SIZE_NUMBER)
		return true;
	if (size->kind == ECO_SIZE_DBH && from[which].unit_m > 0 && unit.value)
		return eco_json_fail(&unit, ECO_BAD_INPUT, "\"%s\" says the unit: leave out \"unit\", or "
			"write \"from_dbh\"", from[which].key);
	size->factor = from[which].factor;
	size->unit_m = unit.value ? size->unit_m : from[which].unit_m;
	if (size->unit_m == 0)
		return eco_json_fail(at, ECO_BAD_INPUT, "\"unit\" is missing: one of " ECO_UNITS);
	return size->kind != ECO_SIZE_DBH || parse_allometry(source, at, size, &height.rule);
}

static bool parse_height_source(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	struct eco_size *size = &spec->heights[spec->height_count++];
	if (json_is_string(at->value)) {
		*size = (struct eco_size){ .kind = ECO_SIZE_COLUMN, .unit_m = 1, .factor = 1 };
		return eco_scene_copy(at, ECO_COLUMN_BYTES, &size->column);
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
	size_t count = eco_scene_several(&height);
	if (!height.value)
		return true;
	if (json_is_array(height.value) && !eco_json_array(&height, SOURCES_MAX))
		return false;
	if (count == 0)
		return eco_json_fail(&height, ECO_BAD_INPUT, "an array of heights that is empty");
	spec->heights = eco_alloc(count, sizeof *spec->heights);
	for (size_t i = 0; i < count; i++) {
		struct eco_json item = eco_scene_one(&height, i);
		if (!parse_height_source(source, &item, spec))
			return false;
	}
	return true;
}

static bool parse_crown(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	static const char *const kinds[] = { "radius", "diameter", NULL };
	struct eco_json crown = eco_json_member(at, "crown_m");
	unsigned diameter = 0;
	if (!crown.value)
		return true;
	spec->crown.kind = ECO_SIZE_COLUMN;
	spec->crown.unit_m = 1;
	if (!eco_scene_fields(source, &crown, crown_fields, spec)
			|| !eco_scene_choice(&crown, "is", kinds, "\"radius\" or \"diameter\"", &diameter))
		return false;
	spec->crown.factor = diameter ? 0.5 : 1;
	return true;
}

/* ---- The entry ---- */

static bool parse_sign(const struct eco_json *at, const char *key, const char *const *signs, const char *says,
	char *sign)
{
	unsigned which = ECO_NONE;
	bool good = eco_scene_choice(at, key, signs, says, &which);
	*sign = which == ECO_NONE ? 0 : *signs[which];
	return good;
}

/* The signs of numbers differ. */
static bool parse_signs(const struct eco_json *at, struct eco_positions_spec *spec)
{
	static const char *const parts[] = { ",", ";", "\t", "|", NULL }, *const marks[] = { ".", ",", NULL },
		says[] = "one of \".\" \",\"";
	struct eco_json node = eco_json_member(at, "thousands");
	if (!parse_sign(at, "separator", parts, "one of \",\" \";\" \"\\t\" \"|\"", &spec->separator)
			|| !parse_sign(at, "decimal", marks, says, &spec->decimal)
			|| !parse_sign(at, "thousands", marks, says, &spec->thousands))
		return false;
	if (spec->thousands && spec->thousands == spec->decimal)
		return eco_json_fail(&node, ECO_BAD_INPUT, "\"thousands\" and \"decimal\" are different signs");
	if (spec->thousands)
		spec->decimal = spec->thousands == ',' ? '.' : ',';
	return true;
}

static bool parse_polar(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	struct eco_json node = eco_json_member(at, "polar"), turn = eco_json_member(&node, "whole_turn");
	struct eco_polar *polar = &spec->polar;
	if (!node.value)
		return true;
	polar->unit_m = 1;
	polar->whole_turn = 360;
	if (!eco_scene_fields(source, &node, polar_fields, spec))
		return false;
	return polar->whole_turn == 360 || polar->whole_turn == 400
		|| eco_json_fail(&turn, ECO_BAD_INPUT, "\"whole_turn\" is 360 (degrees) or 400 (gon)");
}

/* Pairs go together; "unit" is that of x and y, which a CRS of theirs says. */
static bool parse_place(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	struct eco_json unit = eco_json_member(at, "unit"), quadrat = eco_json_member(at, "quadrat");
	if ((spec->x && !eco_json_required(at, "y"))
			|| ((spec->y || quadrat.value) && !eco_json_required(at, "x")))
		return false;
	if (unit.value && (spec->crs || !spec->x))
		return eco_json_fail(&unit, ECO_BAD_INPUT, "\"unit\" is that of x and y without a \"crs\", "
			"which has its own");
	return parse_polar(source, at, spec)
		&& (!quadrat.value || eco_scene_fields(source, &quadrat, quadrat_fields, spec));
}

bool eco_scene_parse_rows(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	static const char *const duplicates[] = { "keep", "skip", NULL };
	struct eco_json from = eco_json_member(at, "from");
	unsigned skip = 0;
	eco_json_place(&from, &spec->line, &spec->column);
	if (!eco_scene_fields(source, at, row_fields, spec) || !parse_signs(at, spec)
			|| !eco_scene_choice(at, "duplicates", duplicates, "\"keep\" or \"skip\"", &skip))
		return false;
	spec->skip_duplicates = skip;
	return parse_species(source, at, spec) && parse_height(source, at, spec)
		&& parse_crown(source, at, spec)
		&& eco_scene_parse_filters(at, &spec->filters, &spec->filter_count)
		&& parse_place(source, at, spec);
}

static void free_size(struct eco_size *size)
{
	free(size->column);
	free(size->rules);
}

void eco_positions_spec_free(struct eco_positions_spec *spec)
{
	eco_scene_fields_free(row_fields, spec);
	eco_scene_fields_free(polar_fields, spec);
	eco_scene_fields_free(quadrat_fields, spec);
	free(spec->fallback.name);
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
