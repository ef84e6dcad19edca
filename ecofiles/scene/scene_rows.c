/* The entries of "instances" that name an inventory: columns, plants, heights. import_positions.c reads
 * the rows themselves. Longer than 600 lines: every key of an entry is read here. */
#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "ecofiles/scene/scene_parse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/import/places/inventory_text.h"

#define MAP_MAX (1u << 20)
#define VALUE_BYTES 200u
#define VALUES_MAX 4096u
#define COLUMNS_MAX (ECO_FILTERS_MAX / 3)    /* in each of "only", "skip" and "instead" */
#define SOURCES_MAX 16u              /* of height */

#define FIELD(name, kind, low, high, member) ECO_FIELD(name, kind, low, high, positions_spec, member)
#define COLUMN(name, member) FIELD(name, COLUMN, 0, 0, member)
static const struct eco_field row_fields[] = {
	FIELD("from", PATH, 0, 0, path), COLUMN("layer", layer), COLUMN("x", x), COLUMN("y", y), COLUMN("z", z),
	FIELD("unit", UNIT, 0, 0, unit_m), ECO_OTHER("polar"), ECO_OTHER("quadrat"), FIELD("crs", CRS, 0, 0, crs),
	FIELD("vertical", TEXT, 0, 0, vertical), ECO_OTHER("separator"), ECO_OTHER("decimal"),
	ECO_OTHER("thousands"), ECO_OTHER("species"), FIELD("codes", TEXT, 0, 0, codes), ECO_OTHER("map"), ECO_OTHER("plant"),
	ECO_OTHER("only"), ECO_OTHER("skip"), ECO_OTHER("instead"), ECO_OTHER("height_m"), ECO_OTHER("crown_m"), ECO_OTHER("tint"),
	ECO_OTHER("crown_base"),
	FIELD("levels", WHOLE, 1, 1024, levels), COLUMN("scale", scale), COLUMN("yaw_deg", yaw_deg),
	ECO_OTHER("duplicates"), ECO_OTHER("grown"), FIELD("seed", WHOLE, 0, INT64_MAX, seed), ECO_FIELDS_END
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
	ECO_OTHER("column"), FIELD("unit", UNIT, 0, 0, crown.unit_m), ECO_OTHER("is"), ECO_OTHER("otherwise"),
	FIELD("spread", NUMBER, 0, 0.9, crown.spread), ECO_FIELDS_END
};
static const struct eco_field base_fields[] = {
	FIELD("column", COLUMN | ECO_IS_REQUIRED, 0, 0, crown.base), FIELD("unit", UNIT, 0, 0, crown.base_unit_m),
	ECO_OTHER("is"), ECO_FIELDS_END
};
#define RULE(record, member) ECO_FIELD("max", NUMBER, 1.3, 1000, record, member max_m), \
	ECO_FIELD("rate", NUMBER, 1e-9, 1e3, record, member rate), \
	ECO_FIELD("shape", NUMBER, 0.01, 100, record, member shape)
static const struct eco_field rule_fields[] = { RULE(allometry, ), ECO_FIELDS_END };
/* A height's object. */
struct eco_height { struct eco_size size; struct eco_allometry rule; uint32_t levels; };
#define SOURCE(name) ECO_FIELD(name, COLUMN, 0, 0, height, size.column)
static const struct eco_field height_fields[] = {
	ECO_FIELD("unit", UNIT, 0, 0, height, size.unit_m),
	ECO_FIELD("value", NUMBER, 0.001, 1000, height, size.value_m), RULE(height, rule.), ECO_OTHER("per_plant"),
	ECO_FIELD("levels", WHOLE, 1, 1024, height, levels), ECO_OTHER("by"),
	ECO_FIELD("now", NUMBER, 1500, 3000, height, size.now), ECO_FIELD("spread", NUMBER, 0, 0.9, height, size.spread),
	/* at last, so that none is lost where another field stops */
	SOURCE("column"), SOURCE("from_dbh"), SOURCE("from_girth"), SOURCE("from_dbh_mm"), SOURCE("from_dbh_cm"),
	SOURCE("from_dbh_in"), SOURCE("from_age"), SOURCE("from_year"), ECO_FIELDS_END
};

/* ---- "only", "skip" and "instead": the rows wanted ---- */

static void parse_value(const struct eco_json *at, struct eco_value *value)
{
	char folded[VALUE_BYTES + 1];
	if (json_is_number(at->value)) {
		value->number = json_number_value(at->value);
		return;
	}
	if (!json_is_string(at->value) || json_string_length(at->value) > VALUE_BYTES)
		eco_scene_fail(at, "a value is a text of up to %u bytes, with \"*\" for any text, or a number",
			VALUE_BYTES);
	eco_text_fold(json_string_value(at->value), folded, sizeof folded);
	value->text = eco_copy_text(folded);
}

static void parse_filter(const struct eco_json *at, struct eco_filter *filter)
{
	eco_scene_need(!json_is_array(at->value) || eco_json_array(at, VALUES_MAX));
	filter->column = eco_copy_text(at->key);
	filter->values = eco_alloc(eco_scene_several(at), sizeof *filter->values);
	for (size_t i = 0; i < eco_scene_several(at); i++) {
		struct eco_json item = eco_scene_one(at, i);
		filter->value_count++;
		parse_value(&item, &filter->values[i]);
	}
}

static void parse_columns(const struct eco_json *columns, bool only, struct eco_filter *filters, uint32_t *count)
{
	struct eco_json entry = { .file = NULL };
	if (!columns->value)
		return;
	eco_scene_need(eco_json_names(columns, COLUMNS_MAX));
	while (eco_json_next(columns, &entry)) {
		struct eco_filter *filter = &filters[(*count)++];
		filter->only = only;
		parse_filter(&entry, filter);
	}
}

void eco_scene_parse_filters(const struct eco_json *at, struct eco_filter **filters, uint32_t *count)
{
	struct eco_json only = eco_json_member(at, "only"), skip = eco_json_member(at, "skip");
	*filters = eco_alloc(ECO_FILTERS_MAX, sizeof **filters);
	parse_columns(&only, true, *filters, count);
	parse_columns(&skip, false, *filters, count);
}

/* Plant to columns to values. */
static void parse_instead(const struct eco_source *source, const struct eco_json *at, struct eco_positions_spec *spec)
{
	struct eco_json plants = eco_json_member(at, "instead"), entry = { .file = NULL };
	uint32_t columns = 0;
	if (!plants.value)
		return;
	eco_scene_need(eco_json_names(&plants, COLUMNS_MAX));
	while (eco_json_next(&plants, &entry)) {
		uint32_t plant = eco_source_plant_named(source, &entry, entry.key), i = spec->filter_count;
		columns += (uint32_t)json_object_size(entry.value);
		if (columns > COLUMNS_MAX)
			eco_scene_fail(&plants, "more than %u columns", COLUMNS_MAX);
		parse_columns(&entry, false, spec->filters, &spec->filter_count);
		for (; i < spec->filter_count; i++) {
			spec->filters[i].plant = plant;
			spec->filters[i].variant_count = source->plants[plant].variant_count;
		}
	}
}

/* ---- Species ---- */

static void species_set(const struct eco_source *source, const struct eco_json *at, const char *name,
	struct eco_species *species)
{
	species->plant = ECO_NONE;
	species->variant_count = 1;
	if (!json_is_null(at->value)) {
		species->plant = eco_source_plant_of(source, at);
		species->variant_count = source->plants[species->plant].variant_count;
	}
	species->name = eco_copy_text(name);
}

struct folded { char *text; uint32_t key; };

static int compare_folded(const void *a, const void *b)
{
	return strcmp(((const struct folded *)a)->text, ((const struct folded *)b)->text);
}

/* Keys of the map that the reader takes for one species must not name different plants. */
static void check_keys(const struct eco_json *at, const struct eco_positions_spec *spec)
{
	struct folded *folded = eco_alloc(spec->map_count, sizeof *folded);
	const struct eco_species *same[2] = { NULL };
	for (uint32_t i = 0; i < spec->map_count; i++) {
		char text[ECO_COLUMN_BYTES];
		eco_text_fold(spec->map[i].name, text, sizeof text);
		folded[i] = (struct folded){ eco_copy_text(text), i };
	}
	qsort(folded, spec->map_count, sizeof *folded, compare_folded);
	for (uint32_t i = 1; !same[0] && i < spec->map_count; i++) {
		const struct eco_species *a = &spec->map[folded[i - 1].key], *b = &spec->map[folded[i].key];
		if (strcmp(folded[i - 1].text, folded[i].text) == 0 && a->plant != b->plant) {
			same[0] = a;
			same[1] = b;
		}
	}
	for (uint32_t i = 0; i < spec->map_count; i++)
		free(folded[i].text);
	free(folded);
	if (same[0])
		eco_scene_fail(at, "\"%.60s\" and \"%.60s\" are one species (capitals and spaces do not count), "
			"with two plants", same[0]->name, same[1]->name);
}

static void parse_map(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	struct eco_json entry = { .file = NULL };
	eco_scene_need(eco_json_names(at, MAP_MAX));
	spec->map = eco_alloc(json_object_size(at->value), sizeof *spec->map);
	while (eco_json_next(at, &entry)) {
		bool fallback = strcmp(entry.key, "*") == 0;
		species_set(source, &entry, entry.key, fallback ? &spec->fallback : &spec->map[spec->map_count]);
		spec->map_count += !fallback;
	}
	check_keys(at, spec);
}

/* Without a map the species' names are the plants' names. */
static void map_of_plants(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	spec->map = eco_alloc(source->plant_count, sizeof *spec->map);
	for (uint32_t i = 0; i < source->plant_count; i += source->plants[i].variant_count) {
		struct eco_species *species = &spec->map[spec->map_count++];
		*species = (struct eco_species){ eco_copy_text(source->plants[i].name), i,
			source->plants[i].variant_count };
	}
	check_keys(at, spec);
}

/* A column, or an array of the genus's, the epithet's and the cultivar's. */
static void parse_species_columns(const struct eco_json *at, char *columns[ECO_SPECIES_COLUMNS])
{
	struct eco_json species = eco_json_member(at, "species");
	size_t count = species.value ? eco_scene_several(&species) : 0;
	eco_scene_need(!species.value || !json_is_array(species.value)
		|| eco_json_array(&species, ECO_SPECIES_COLUMNS));
	if (species.value && count == 0)
		eco_scene_fail(&species, "an array of columns that is empty");
	for (size_t i = 0; i < count; i++) {
		struct eco_json item = eco_scene_one(&species, i);
		eco_scene_copy(&item, ECO_COLUMN_BYTES, &columns[i]);
	}
}

static void parse_species(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	struct eco_json map = eco_json_member(at, "map"), plant = eco_json_member(at, "plant");
	spec->fallback.plant = ECO_NONE;
	parse_species_columns(at, spec->species);
	if (plant.value && (spec->species[0] || map.value))
		eco_scene_fail(&plant, "\"plant\" makes every row this plant: leave out \"species\" and \"map\", or "
			"\"plant\"");
	if (!plant.value && !spec->species[0])
		eco_scene_fail(at, "say what stands there: \"plant\": \"NAME\", or \"species\": \"COLUMN\" and a "
			"\"map\"");
	if (plant.value) {
		eco_scene_need(eco_json_is_text(&plant, sizeof source->plants->name - 1));
		species_set(source, &plant, "*", &spec->fallback);
	} else if (map.value)
		parse_map(source, &map, spec);
	else
		map_of_plants(source, at, spec);
}

/* ---- Heights and crowns ---- */

/* Whether "max" and "rate" are given; both, or neither. */
static bool rule_is_there(const struct eco_json *at, const struct eco_allometry *rule)
{
	if ((rule->max_m > 0) != (rule->rate > 0))
		eco_scene_fail(at, "a height from dbh needs \"max\" (m) and \"rate\" (per mm): h = 1.3 + (max - 1.3) "
			"(1 - exp(-rate * dbh))");
	return rule->max_m > 0;
}

ECO_ORDER(compare_rules, struct eco_allometry, ->plant)

static void parse_per_plant(const struct eco_source *source, const struct eco_json *at, struct eco_size *size)
{
	struct eco_json entry = { .file = NULL };
	eco_scene_need(eco_json_names(at, source->name_count));
	while (eco_json_next(at, &entry)) {
		struct eco_allometry *rule = &size->rules[size->rule_count++];
		rule->shape = 1;
		rule->plant = eco_source_plant_named(source, &entry, entry.key);
		eco_scene_fields(source, &entry, rule_fields, rule);
		eco_scene_need(rule_is_there(&entry, rule) || eco_json_required(&entry, "max"));
	}
}

static void parse_allometry(const struct eco_source *source, const struct eco_json *at, struct eco_size *size,
	const struct eco_allometry *others)
{
	struct eco_json per_plant = eco_json_member(at, "per_plant");
	size->rules = eco_alloc(json_object_size(per_plant.value) + 1, sizeof *size->rules);
	if (per_plant.value)
		parse_per_plant(source, &per_plant, size);
	size->rules[size->rule_count] = *others;
	size->rule_count += rule_is_there(at, others);
	qsort(size->rules, size->rule_count, sizeof *size->rules, compare_rules);
	if (size->rule_count == 0 && !size->by_species)
		eco_scene_fail(at, "a height from dbh needs \"max\" (m) and \"rate\" (per mm), here or "
			"\"per_plant\", or \"by\": \"species\": h = 1.3 + (max - 1.3) (1 - exp(-rate * dbh))");
}

/* A height's object: one member names its source. */
static void parse_height_object(const struct eco_source *source, const struct eco_json *at,
	struct eco_size *size, uint32_t *levels)
{
	static const struct { const char *key; double unit_m; enum eco_size_kind kind; double factor;
		} from[] = {
		{ "column", 1, ECO_SIZE_COLUMN, 1 }, { "from_dbh", 0, ECO_SIZE_DBH, 1 },
			{ "from_girth", 0, ECO_SIZE_DBH, 1 / M_PI },
		{ "from_dbh_mm", 0.001, ECO_SIZE_DBH, 1 }, { "from_dbh_cm", 0.01, ECO_SIZE_DBH, 1 },
		{ "from_dbh_in", 0.0254, ECO_SIZE_DBH, 1 },
		{ "from_age", 1, ECO_SIZE_AGE, 1 }, { "from_year", 1, ECO_SIZE_YEAR, 1 } };
	static const char *const by[] = { "species", NULL };
	unsigned species = ECO_NONE;
	enum { SOURCES = sizeof from / sizeof *from };
	struct eco_height height = { .rule = { .plant = ECO_NONE, .shape = 1 }, .levels = *levels };
	struct eco_json unit = eco_json_member(at, "unit");
	unsigned kinds = json_object_get(at->value, "value") != NULL, which = SOURCES;
	eco_scene_fields(source, at, height_fields, &height);
	*size = height.size;
	*levels = height.levels;
	eco_scene_choice(at, "by", by, "\"species\"", &species);
	size->by_species = species != ECO_NONE;
	for (unsigned i = 0; i < SOURCES; i++)
		if (json_object_get(at->value, from[i].key)) {
			kinds++;
			which = i;
		}
	if (kinds != 1)
		eco_scene_fail(at, "a height comes from exactly one of column, value, from_dbh, from_girth, from_dbh_mm, from_dbh_cm, from_dbh_in, from_age, from_year");
	size->kind = which < SOURCES ? from[which].kind : ECO_SIZE_NUMBER;
	if (size->kind == ECO_SIZE_NUMBER)
		return;
	if (size->kind == ECO_SIZE_YEAR && size->now == 0)
		eco_scene_fail(at, "\"now\" is missing: the year in which the plants are seen");
	if (size->kind != ECO_SIZE_COLUMN && from[which].unit_m > 0 && unit.value)
		eco_scene_fail(&unit, "\"%s\" says the unit: leave out \"unit\", or write \"from_dbh\"",
			from[which].key);
	size->factor = from[which].factor;
	size->unit_m = unit.value ? size->unit_m : from[which].unit_m;
	if (size->unit_m == 0)
		eco_scene_fail(at, "\"unit\" is missing: one of " ECO_UNITS);
	if (size->kind != ECO_SIZE_COLUMN)
		parse_allometry(source, at, size, &height.rule);
}

static void parse_height_source(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	struct eco_size *size = &spec->heights[spec->height_count++];
	if (json_is_object(at->value)) {
		parse_height_object(source, at, size, &spec->levels);
		return;
	}
	if (json_is_string(at->value)) {
		*size = (struct eco_size){ .kind = ECO_SIZE_COLUMN, .unit_m = 1, .factor = 1 };
		eco_scene_copy(at, ECO_COLUMN_BYTES, &size->column);
		return;
	}
	size->kind = ECO_SIZE_NUMBER;
	size->value_m = json_is_number(at->value) ? json_number_value(at->value) : NAN;
	if (!(size->value_m >= 0.001 && size->value_m <= 1000))
		eco_scene_fail(at, "a height is a number of metres between 0.001 and 1000, a column of metres such as "
			"\"Height\", or an object such as {\"column\": \"Height\", \"unit\": \"ft\"}");
}

static void parse_height(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	struct eco_json height = eco_json_member(at, "height_m");
	size_t count = eco_scene_several(&height);
	if (!height.value)
		return;
	eco_scene_need(!json_is_array(height.value) || eco_json_array(&height, SOURCES_MAX));
	if (count == 0)
		eco_scene_fail(&height, "an array of heights that is empty");
	spec->heights = eco_alloc(count, sizeof *spec->heights);
	for (size_t i = 0; i < count; i++) {
		struct eco_json item = eco_scene_one(&height, i);
		parse_height_source(source, &item, spec);
	}
}

/* A column, or several whose mean counts, such as the radii in four directions; polygons; or a guess. */
static void parse_crown(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	static const char *const kinds[] = { "radius", "diameter", "polygon", "area", NULL }, *const others[] = { "species", NULL };
	struct eco_json crown = eco_json_member(at, "crown_m"), column = eco_json_member(&crown, "column");
	unsigned is = ECO_NONE, otherwise = ECO_NONE;
	if (!crown.value)
		return;
	spec->crown.unit_m = 1;
	eco_scene_fields(source, &crown, crown_fields, spec);
	eco_scene_choice(&crown, "is", kinds, "\"radius\", \"diameter\", \"area\" or \"polygon\"", &is);
	eco_scene_choice(&crown, "otherwise", others, "\"species\"", &otherwise);
	eco_scene_need(!column.value || !json_is_array(column.value) || eco_json_array(&column, ECO_CROWN_COLUMNS));
	size_t count = column.value ? eco_scene_several(&column) : 0;
	if ((count > 0) != (is == 0 || is == 1 || is == 3) || (is == ECO_NONE && otherwise == ECO_NONE))
		eco_scene_fail(&crown, "a crown is {\"column\": NAME, \"is\": \"radius\", \"diameter\" or \"area\"}, {\"is\": "
			"\"polygon\"} or {\"otherwise\": \"species\"}");
	for (size_t i = 0; i < count; i++) {
		struct eco_json item = eco_scene_one(&column, i);
		eco_scene_copy(&item, ECO_COLUMN_BYTES, &spec->crown.columns[i]);
	}
	spec->crown.factor = is == 1 ? 0.5 : 1;
	spec->crown.of_geometry = is == 2;
	spec->crown.is_area = is == 3;
	spec->crown.by_species = otherwise == 0;
}

/* ---- Tints ---- */

#define BREAKS_MAX (ECO_TINT_CLASSES_MAX - 1)

static const struct eco_field tint_fields[] = {
	ECO_FIELD("column", COLUMN | ECO_IS_REQUIRED, 0, 0, tint, column), ECO_OTHER("palette"), ECO_OTHER("breaks"),
	ECO_FIELDS_END
};

static void add_class(const struct eco_json *at, const char *name, struct eco_tint *tint)
{
	uint8_t rgb[3];
	if (!json_is_null(at->value))
		eco_scene_color(at, rgb);
	eco_tint_add(tint, name, NULL, json_is_null(at->value) ? NULL : rgb);
}

/* The name of one of words/tints.tsv, value -> colour, or colours. */
static void parse_palette(const struct eco_json *at, struct eco_tint *tint)
{
	struct eco_json entry = { .file = NULL };
	char names[200];
	if (json_is_object(at->value)) {
		eco_scene_need(eco_json_names(at, ECO_TINT_CLASSES_MAX));
		while (eco_json_next(at, &entry))
			add_class(&entry, strcmp(entry.key, "*") == 0 ? ECO_TINT_OTHER : *entry.key ? entry.key
				: ECO_TINT_NOT_STATED, tint);
	} else if (json_is_array(at->value)) {
		eco_scene_need(eco_json_array(at, ECO_TINT_CLASSES_MAX));
		for (size_t i = 0; i < eco_scene_several(at); i++) {
			entry = eco_scene_one(at, i);
			add_class(&entry, ECO_TINT_FREE, tint);
		}
	} else if (!json_is_string(at->value) || !eco_tint_palette(tint, json_string_value(at->value)))
		eco_scene_fail(at, "a palette is one of %s; or {\"VALUE\": \"#rrggbb\"}, with null for plants that keep their "
			"colour; or an array of colours", eco_tint_palettes(names, sizeof names));
	if (tint->class_count == 0)
		eco_scene_fail(at, "a palette without a colour");
}

static void parse_breaks(const struct eco_json *at, const struct eco_json *palette, struct eco_tint *tint)
{
	size_t count = eco_scene_several(at);
	eco_scene_need(eco_json_array(at, BREAKS_MAX));
	if (json_is_object(palette->value) || (json_is_array(palette->value) && tint->class_count != count + 1))
		eco_scene_fail(palette, "%zu breaks need the name of a palette, or an array of %zu colours", count, count + 1);
	tint->breaks = eco_alloc(count, sizeof *tint->breaks);
	for (size_t i = 0; i < count; i++) {
		struct eco_json item = eco_scene_one(at, i);
		tint->breaks[i] = json_is_number(item.value) ? json_number_value(item.value) : NAN;
		if (isnan(tint->breaks[i]) || (i && !(tint->breaks[i] > tint->breaks[i - 1])))
			eco_scene_fail(&item, "breaks are numbers that ascend");
	}
	tint->break_count = (uint32_t)count;
	if (count)
		eco_tint_divide(tint);
}

static void parse_tint(const struct eco_source *source, const struct eco_json *at, struct eco_positions_spec *spec)
{
	struct eco_json node = eco_json_member(at, "tint"), palette = eco_json_member(&node, "palette"),
		breaks = eco_json_member(&node, "breaks");
	if (!node.value)
		return;
	eco_scene_fields(source, &node, tint_fields, &spec->tint);
	eco_scene_need(eco_json_required(&node, "palette"));
	spec->tint.decimal = spec->decimal ? spec->decimal : '.';
	parse_palette(&palette, &spec->tint);
	if (breaks.value)
		parse_breaks(&breaks, &palette, &spec->tint);
	eco_tint_close(&spec->tint);
}

static void parse_base(const struct eco_source *source, const struct eco_json *at, struct eco_positions_spec *spec)
{
	static const char *const kinds[] = { "height", "ratio", NULL };
	struct eco_json base = eco_json_member(at, "crown_base");
	unsigned is = 0;
	if (!base.value)
		return;
	spec->crown.base_unit_m = 1;
	eco_scene_fields(source, &base, base_fields, spec);
	eco_scene_choice(&base, "is", kinds, "\"height\" or \"ratio\"", &is);
	spec->crown.base_is_ratio = is == 1;
}

/* ---- The entry ---- */

static void parse_sign(const struct eco_json *at, const char *key, const char *const *signs, const char *says,
	char *sign)
{
	unsigned which = ECO_NONE;
	eco_scene_choice(at, key, signs, says, &which);
	*sign = which == ECO_NONE ? 0 : *signs[which];
}

/* The signs of numbers differ. */
static void parse_signs(const struct eco_json *at, struct eco_positions_spec *spec)
{
	static const char *const parts[] = { ",", ";", "\t", "|", NULL }, *const marks[] = { ".", ",", NULL },
		says[] = "one of \".\" \",\"";
	struct eco_json node = eco_json_member(at, "thousands");
	parse_sign(at, "separator", parts, "one of \",\" \";\" \"\\t\" \"|\"", &spec->separator);
	parse_sign(at, "decimal", marks, says, &spec->decimal);
	parse_sign(at, "thousands", marks, says, &spec->thousands);
	if (spec->thousands && spec->thousands == spec->decimal)
		eco_scene_fail(&node, "\"thousands\" and \"decimal\" are different signs");
	if (spec->thousands)
		spec->decimal = spec->thousands == ',' ? '.' : ',';
}

static void parse_polar(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	struct eco_json node = eco_json_member(at, "polar"), turn = eco_json_member(&node, "whole_turn");
	struct eco_polar *polar = &spec->polar;
	if (!node.value)
		return;
	polar->unit_m = 1;
	polar->whole_turn = 360;
	eco_scene_fields(source, &node, polar_fields, spec);
	if (polar->whole_turn != 360 && polar->whole_turn != 400)
		eco_scene_fail(&turn, "\"whole_turn\" is 360 (degrees) or 400 (gon)");
}

/* Pairs go together; "unit" is that of x and y, which a CRS of theirs says. */
static void parse_place(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	struct eco_json unit = eco_json_member(at, "unit"), quadrat = eco_json_member(at, "quadrat");
	eco_scene_need(!spec->x || eco_json_required(at, "y"));
	eco_scene_need(!(spec->y || quadrat.value) || eco_json_required(at, "x"));
	if (unit.value && (spec->crs || !spec->x))
		eco_scene_fail(&unit, "\"unit\" is that of x and y without a \"crs\", which has its own");
	parse_polar(source, at, spec);
	if (quadrat.value)
		eco_scene_fields(source, &quadrat, quadrat_fields, spec);
}

void eco_scene_parse_rows(const struct eco_source *source, const struct eco_json *at,
	struct eco_positions_spec *spec)
{
	static const char *const duplicates[] = { "keep", "skip", NULL };
	struct eco_json from = eco_json_member(at, "from");
	static const char *const grown[] = { "open", "stand", NULL };
	unsigned skip = 0, stand = 0;
	eco_json_place(&from, &spec->line, &spec->column);
	eco_scene_fields(source, at, row_fields, spec);
	parse_signs(at, spec);
	eco_scene_choice(at, "duplicates", duplicates, "\"keep\" or \"skip\"", &skip);
	eco_scene_choice(at, "grown", grown, "\"open\" or \"stand\"", &stand);
	spec->skip_duplicates = skip;
	spec->stand = stand;
	parse_species(source, at, spec);
	parse_height(source, at, spec);
	parse_crown(source, at, spec);
	parse_tint(source, at, spec);
	parse_base(source, at, spec);
	eco_scene_parse_filters(at, &spec->filters, &spec->filter_count);
	parse_instead(source, at, spec);
	parse_place(source, at, spec);
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
	eco_tint_free(&spec->tint);
	free(spec->fallback.name);
	for (uint32_t i = 0; i < ECO_SPECIES_COLUMNS; i++)
		free(spec->species[i]);
	for (uint32_t i = 0; i < spec->map_count; i++)
		free(spec->map[i].name);
	for (uint32_t i = 0; i < spec->height_count; i++)
		free_size(&spec->heights[i]);
	for (uint32_t i = 0; i < ECO_CROWN_COLUMNS; i++)
		free(spec->crown.columns[i]);
	eco_free(spec->crown.base, spec->map, spec->heights);
	eco_filters_free(spec->filters, spec->filter_count);
	*spec = (struct eco_positions_spec){ .path = NULL };
}

/* ---- The entries with "scatter": areas, numbers of each plant, distances ---- */

#define KINDS_MAX 4096u
#define DENSITY_MAX 1e8              /* plants a hectare: ten thousand a square metre */

#define AREA(name, kind, low, high, member) ECO_FIELD(name, kind, low, high, scatter_spec, member)
static const struct eco_field scatter_fields[] = {
	AREA("scatter", PATH, 0, 0, path), AREA("layer", COLUMN, 0, 0, layer), AREA("crs", CRS, 0, 0, crs),
	ECO_OTHER("density_per_ha"), ECO_OTHER("mix"),
	AREA("density_column", COLUMN, 0, 0, density_column), AREA("count_column", COLUMN, 0, 0, count_column),
	AREA("spacing_m", NUMBER, 0.05, 1e5, spacing_m), AREA("distance_m", NUMBER, 0, 1e5, distance_m), AREA("clear_of", PATH, 0, 0, clear_of),
	AREA("clear_layer", COLUMN, 0, 0, clear_layer), AREA("clear_crs", CRS, 0, 0, clear_crs),
	AREA("clear_m", NUMBER, 0, 1e5, clear_m), ECO_OTHER("only"), ECO_OTHER("skip"),
	ECO_OTHER("height_m"), AREA("seed", WHOLE, 0, INT64_MAX, seed), ECO_FIELDS_END
};
static const struct eco_field range_fields[] = {
	AREA("min", NUMBER | ECO_IS_REQUIRED, 0.001, 1000, height_low_m),
	AREA("max", NUMBER | ECO_IS_REQUIRED, 0.001, 1000, height_high_m), ECO_FIELDS_END
};

/* Numbers of plants: per hectare for each kind, or shares of a number in a column. */
static void parse_numbers(const struct eco_source *source, const struct eco_json *at,
	struct eco_scatter_spec *spec)
{
	struct eco_json density = eco_json_member(at, "density_per_ha"), mix = eco_json_member(at, "mix"),
		*kinds = density.value ? &density : &mix, entry = { .file = NULL };
	if ((density.value != NULL) + (spec->density_column != NULL) + (spec->count_column != NULL) + (spec->spacing_m > 0) != 1
		|| (density.value != NULL) == (mix.value != NULL))
		eco_scene_fail(at, "say how many: \"density_per_ha\": {\"oak\": 120, \"ash\": 40}; or \"mix\": {\"oak\": "
			"3, \"ash\": 1} with \"density_column\" (plants a hectare), \"count_column\" (plants in the "
			"area) or \"spacing_m\" (between plants along lines)");
	eco_scene_need(eco_json_names(kinds, KINDS_MAX));
	if (json_object_size(kinds->value) == 0)
		eco_scene_fail(kinds, "it names no plant; such as {\"oak\": 120, \"ash\": 40}");
	spec->plants = eco_alloc(json_object_size(kinds->value), sizeof *spec->plants);
	while (eco_json_next(kinds, &entry)) {
		struct eco_scatter_plant *plant = &spec->plants[spec->plant_count++];
		plant->plant = eco_source_plant_named(source, &entry, entry.key);
		plant->variant_count = source->plants[plant->plant].variant_count;
		plant->weight = json_is_number(entry.value) ? json_number_value(entry.value) : 0;
		if (!(plant->weight > 0 && plant->weight <= DENSITY_MAX))
			eco_scene_fail(&entry, "a number above 0, at most %g", DENSITY_MAX);
	}
}

static void parse_range(const struct eco_source *source, const struct eco_json *at,
	struct eco_scatter_spec *spec)
{
	struct eco_json height = eco_json_member(at, "height_m");
	spec->height_low_m = spec->height_high_m = NAN;
	if (height.value && !json_is_object(height.value)) {
		eco_scene_need(eco_json_number(at, "height_m", 0.001, 1000, &spec->height_low_m));
		spec->height_high_m = spec->height_low_m;
	} else if (height.value) {
		eco_scene_fields(source, &height, range_fields, spec);
		if (!(spec->height_low_m <= spec->height_high_m))
			eco_scene_fail(&height, "\"min\" is greater than \"max\"");
	}
}

void eco_scene_parse_scatter(const struct eco_source *source, const struct eco_json *at,
	struct eco_scatter_spec *spec)
{
	struct eco_json where = eco_json_member(at, "scatter");
	eco_json_place(&where, &spec->line, &spec->column);
	eco_scene_fields(source, at, scatter_fields, spec);
	parse_numbers(source, at, spec);
	eco_scene_parse_filters(at, &spec->filters, &spec->filter_count);
	parse_range(source, at, spec);
}

void eco_scatter_spec_free(struct eco_scatter_spec *spec)
{
	eco_scene_fields_free(scatter_fields, spec);
	eco_filters_free(spec->filters, spec->filter_count);
	free(spec->plants);
	*spec = (struct eco_scatter_spec){ .path = NULL };
}
