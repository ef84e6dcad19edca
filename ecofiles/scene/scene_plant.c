/* "plants" of a scene file: the files of a plant, how to read them, and rules about its parts. */
#include "ecofiles/import/model/model_import.h"
#include "ecofiles/scene/scene_parse.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"

#define FOOT_MOST 1e10       /* of a file's numbers: millimetres of a map */
#define PLANTS_MAX 65536u
#define VARIANTS_MAX 256u
#define FILES_MAX 64u
#define SIZES_MAX 16u
#define RULES_MAX 1024u
#define HEIGHT_MAX_M 1000.0

#define IMPORTANCE(name, record, member) \
	ECO_FIELD(name, NUMBER, ECO_IMPORTANCE_LEAST, ECO_IMPORTANCE_MOST, record, member)
static const struct eco_field plant_fields[] = {
	ECO_OTHER("model"), ECO_OTHER("variants"), ECO_OTHER("height_m"),
	ECO_FIELD("unit", UNIT, 0, 0, source_plant, unit_m),
	ECO_OTHER("up"), ECO_OTHER("grade"), ECO_OTHER("foot"), ECO_OTHER("object"), ECO_OTHER("parts"), ECO_OTHER("importance"),
	ECO_FIELDS_END
};
static const struct eco_field library_fields[] = {
	ECO_OTHER("library"), ECO_OTHER("height_m"), ECO_OTHER("crown_m"), ECO_OTHER("base"), ECO_OTHER("genus"),
	ECO_OTHER("season"), ECO_OTHER("individual"), ECO_OTHER("importance"), ECO_FIELDS_END
};
static const struct eco_field importance_fields[] = {
	IMPORTANCE("wood", source_plant, importance[ECO_ORGAN_WOOD]),
	IMPORTANCE("foliage", source_plant, importance[ECO_ORGAN_FOLIAGE]),
	IMPORTANCE("flower", source_plant, importance[ECO_ORGAN_FLOWER]), ECO_FIELDS_END
};
static const struct eco_field rule_fields[] = {
	ECO_FIELD("name", COLUMN, 0, 0, part_rule, name),
	ECO_FIELD("component", WHOLE, 1, UINT32_MAX, part_rule, component),
	ECO_FIELD("size", NUMBERS, 0, 1e9, part_rule, size),
	ECO_OTHER("is"), IMPORTANCE("importance", part_rule, importance), ECO_FIELDS_END
};

/* ---- Names ---- */

static int name_compare(const void *a, const void *b, void *context)
{
	const struct eco_source_plant *plants = context;
	return strcmp(plants[*(const uint32_t *)a].name, plants[*(const uint32_t *)b].name);
}

static void sort_names(struct eco_source *source)
{
	for (uint32_t i = 0; i < source->plant_count; i += source->plants[i].variant_count)
		source->plants_by_name[source->name_count++] = i;
	qsort_r(source->plants_by_name, source->name_count, sizeof *source->plants_by_name, name_compare,
		source->plants);
}

static uint32_t find_plant(const struct eco_source *source, const char *name)
{
	uint32_t low = 0, high = source->name_count;
	while (low < high) {
		uint32_t middle = low + (high - low) / 2, plant = source->plants_by_name[middle];
		int order = strcmp(source->plants[plant].name, name);
		if (order == 0)
			return plant;
		if (order < 0)
			low = middle + 1;
		else
			high = middle;
	}
	return ECO_NONE;
}

uint32_t eco_source_plant_named(const struct eco_source *source, const struct eco_json *at, const char *name)
{
	char known[200] = "";
	uint32_t plant = find_plant(source, name);
	if (plant != ECO_NONE)
		return plant;
	for (uint32_t i = 0; i < source->plant_count; i += source->plants[i].variant_count)
		eco_phrase_add(known, sizeof known, source->plants[i].name);
	eco_scene_fail(at, "plant \"%.63s\" is not among \"plants\": %s", name,
		known[0] != 0 ? known : "there are none");
}

uint32_t eco_source_plant_of(const struct eco_source *source, const struct eco_json *at)
{
	eco_scene_need(eco_json_is_text(at, sizeof source->plants->name - 1));
	return eco_source_plant_named(source, at, json_string_value(at->value));
}

/* ---- Files ---- */

static void spread_variants(struct eco_source *source, struct eco_source_plant *plant)
{
	source->plant_count += plant->variant_count - 1;
	for (uint32_t i = 1; i < plant->variant_count; i++) {
		plant[i] = *plant;
		plant[i].variant = i;
	}
}

static void parse_variants(struct eco_source *source, const struct eco_json *at,
	struct eco_source_plant *plant)
{
	struct eco_json model = eco_json_member(at, "model"), variants = eco_json_member(at, "variants");
	if ((model.value != NULL) == (variants.value != NULL))
		eco_scene_fail(at, "a plant has either \"model\": \"FILE\" (or several files that make it up: "
			"[\"wood.obj\", \"leaves.obj\"]), or \"variants\": [\"FILE\", ...], one for each "
			"instance, or \"library\": \"round\", a plant of the library");
	if (variants.value) {
		eco_scene_need(eco_json_array(&variants, VARIANTS_MAX));
		plant->variant_count = (uint32_t)json_array_size(variants.value);
	}
	if (plant->variant_count == 0)
		eco_scene_fail(&variants, "\"variants\" names no file");
	spread_variants(source, plant);
	for (uint32_t i = 0; i < plant->variant_count; i++) {
		struct eco_json files = variants.value ? eco_json_item(&variants, i) : model;
		eco_scene_parse_paths(source, &files, "file", FILES_MAX, &plant[i].models, &plant[i].model_count);
	}
}

/* ---- How to read the files ---- */

static void parse_up(const struct eco_json *at, enum eco_up *up)
{
	static const char *const axes[] = { "y", "z", "x", NULL };       /* as in enum eco_up */
	unsigned axis = ECO_NONE;
	eco_scene_choice(at, "up", axes, "\"x\", \"y\" or \"z\": the axis of the file that points up", &axis);
	*up = axis == ECO_NONE ? ECO_UP_FOUND : ECO_UP_Y + axis;
}

static bool parse_flag(const struct eco_json *at, const char *key, const char *says)
{
	struct eco_json node = eco_json_member(at, key);
	if (node.value && !json_is_boolean(node.value))
		eco_scene_fail(&node, "\"%s\" is true or false: whether %s", key, says);
	return json_is_true(node.value);
}

/* Buildings and groups stand where they were drawn. */
static void parse_foot(const struct eco_json *at, struct eco_source_plant *plant)
{
	static const char *const feet[] = { "found", "origin", NULL };
	unsigned foot = 0;
	if (json_is_array(eco_json_member(at, "foot").value)) {
		eco_scene_need(eco_json_numbers(at, "foot", 3, 3, -FOOT_MOST, FOOT_MOST, plant->foot));
		foot = 1;
	} else
		eco_scene_choice(at, "foot", feet, "\"found\" (where the stems stand), \"origin\" (the file's zero) or a point [x, y, z]",
			&foot);
	plant->keep_origin = foot == 1;
}

static void parse_importance(const struct eco_source *source, const struct eco_json *at,
	struct eco_source_plant *plant)
{
	struct eco_json node = eco_json_member(at, "importance");
	for (int i = 0; i < ECO_ORGAN_COUNT; i++)
		plant->importance[i] = node.value ? 1 : 0;
	if (node.value)
		eco_scene_fields(source, &node, importance_fields, plant);
}

/* ---- Rules about parts ---- */

static void parse_rule(const struct eco_source *source, const struct eco_json *at, struct eco_part_rule *rule)
{
	static const char *const parts[] = { "wood", "foliage", "flower", "left out", NULL };
	struct eco_json size = eco_json_member(at, "size");
	unsigned is = ECO_ORGAN_FOUND;       /* if it only weighs more or less */
	eco_scene_fields(source, at, rule_fields, rule);
	eco_scene_need(rule->importance != 0 || eco_json_required(at, "is"));
	eco_scene_choice(at, "is", parts, "\"wood\", \"foliage\", \"flower\" or \"left out\"", &is);
	if ((rule->name != NULL) + (rule->component > 0) + (size.value != NULL) != 1)
		eco_scene_fail(at, "a rule has exactly one of \"name\": \"pot*\", \"component\": 1, \"size\": "
			"[0, 0.1]");
	rule->is = is == ECO_ORGAN_COUNT ? ECO_PART_LEFT_OUT : (uint8_t)is;
	rule->kind = rule->name ? ECO_PART_NAME : rule->component > 0 ? ECO_PART_COMPONENT : ECO_PART_SIZE;
}

static void parse_rules(const struct eco_source *source, const struct eco_json *at,
	struct eco_source_plant *plant)
{
	struct eco_json node = eco_json_member(at, "parts");
	if (!node.value)
		return;
	eco_scene_need(eco_json_array(&node, RULES_MAX));
	plant->parts = eco_alloc(json_array_size(node.value), sizeof *plant->parts);
	for (size_t i = 0; i < json_array_size(node.value); i++) {
		struct eco_json item = eco_json_item(&node, i);
		parse_rule(source, &item, &plant->parts[plant->part_count++]);
	}
}

static void free_rules(struct eco_source_plant *plant)
{
	for (uint32_t i = 0; i < plant->part_count; i++)
		eco_scene_fields_free(rule_fields, &plant->parts[i]);
	free(plant->parts);
}

/* ---- Plants of the library ---- */

/* Number i of an array, in turn, or the one number there is; absent: `otherwise`. */
static double number_of(const struct eco_json *at, const char *key, size_t i, double otherwise)
{
	struct eco_json node = eco_json_member(at, key), one = node.value ? eco_scene_one(&node, i % eco_scene_several(&node)) : node;
	if (node.value && !json_is_number(one.value))
		eco_scene_fail(&one, "\"%s\" is a number, or an array of up to %u", key, SIZES_MAX);
	return node.value ? json_number_value(one.value) : otherwise;
}

void eco_scene_parse_season(const struct eco_json *at, enum eco_season *season)
{
	unsigned number = *season;
	eco_scene_choice(at, "season", eco_season_names, "\"spring\", \"summer\", \"autumn\" or \"winter\"", &number);
	*season = (enum eco_season)number;
}

static size_t count_numbers(const struct eco_json *at, const char *key)
{
	struct eco_json node = eco_json_member(at, key);
	size_t count = node.value ? eco_scene_several(&node) : 1;
	if (count == 0 || count > SIZES_MAX)
		eco_scene_fail(&node, "\"%s\" has 1 to %u numbers", key, SIZES_MAX);
	return count;
}

static void parse_library(struct eco_source *source, const struct eco_json *at, struct eco_source_plant *plant)
{
	struct eco_json node = eco_json_member(at, "library");
	const char *habit = NULL, *genus = "";
	size_t sizes = count_numbers(at, "height_m"), crowns = count_numbers(at, "crown_m"),
	       bases = count_numbers(at, "base"), individuals = count_numbers(at, "individual");
	struct eco_error why = { .code = ECO_OK };
	eco_scene_need(eco_json_text(at, "library", sizeof plant->library.habit - 1, &habit)
		&& eco_json_text(at, "genus", sizeof plant->library.genus - 1, &genus));
	if ((crowns > 1 && crowns != sizes) || (bases > 1 && bases != sizes))
		eco_scene_fail(at, "%zu heights with %zu crowns and %zu bases: each has its own, or all have one", sizes, crowns, bases);
	if (*genus && !eco_flora_of(genus, NULL).genus)
		eco_scene_fail(&node, "no genus of \"%.40s\" is known; without \"genus\" a plant has the leaves of its form", genus);
	plant->library.season = source->season;
	eco_scene_parse_season(at, &plant->library.season);
	snprintf(plant->library.habit, sizeof plant->library.habit, "%s", habit);
	snprintf(plant->library.genus, sizeof plant->library.genus, "%s", genus);
	plant->variant_count = (uint32_t)(sizes * individuals);
	spread_variants(source, plant);
	for (uint32_t i = 0; i < plant->variant_count; i++) {
		struct eco_library_plant *own = &plant[i].library;
		double number = number_of(at, "individual", i, 1);
		own->height_m = number_of(at, "height_m", i / individuals, eco_library_height(habit));
		own->crown_m = number_of(at, "crown_m", i / individuals, 0);
		own->base = number_of(at, "base", i / individuals, 0);
		own->individual = number >= 1 && number <= UINT16_MAX ? (uint32_t)number : UINT16_MAX;
		plant[i].height_m = own->height_m;
		if (own->individual != number || eco_library_check(own, &why))
			eco_scene_fail(&node, "%s", why.code ? why.text : "\"individual\" is a whole number from 1 on");
	}
}

/* ---- All ---- */

static void parse_plant(struct eco_source *source, const struct eco_json *at)
{
	struct eco_source_plant *plant = &source->plants[source->plant_count++];
	plant->variant_count = 1;
	eco_source_check_name(at, at->key, strlen(at->key));
	memcpy(plant->name, at->key, strlen(at->key) + 1);
	bool library = eco_json_member(at, "library").value != NULL;
	eco_scene_fields(source, at, library ? library_fields : plant_fields, plant);
	if (library) {
		parse_importance(source, at, plant);
		parse_library(source, at, plant);
		return;
	}
	eco_scene_need(eco_json_number(at, "height_m", 0.001, HEIGHT_MAX_M, &plant->height_m));
	parse_up(at, &plant->up);
	plant->grade = parse_flag(at, "grade", "foliage is darkened to what leaves reflect");
	plant->object = parse_flag(at, "object", "it is no plant, such as a building");
	parse_foot(at, plant);
	parse_importance(source, at, plant);
	parse_rules(source, at, plant);
	parse_variants(source, at, plant);
}

static size_t count_variants(const json_t *plants)
{
	const char *key;
	json_t *plant;
	size_t count = 0;
	json_object_foreach((json_t *)plants, key, plant) {
		static const char *const several[] = { "variants", "height_m", "individual" };
		(void)key;
		uint64_t all = 1;
		for (size_t i = 0; i < 3; i++) {
			size_t own = json_array_size(json_object_get(plant, several[i]));
			all *= own > PLANTS_MAX ? PLANTS_MAX : own > 1 ? own : 1;
		}
		count += all > PLANTS_MAX ? PLANTS_MAX + 1 : (size_t)all;
	}
	return count;
}

void eco_scene_parse_plants(struct eco_source *source, const struct eco_json *top)
{
	struct eco_json node = eco_json_member(top, "plants"), entry = { .file = NULL };
	if (!node.value)
		return;
	eco_scene_need(eco_json_names(&node, SIZE_MAX));
	size_t count = count_variants(node.value);
	if (count > PLANTS_MAX)
		eco_scene_need(eco_json_fail(&node, ECO_TOO_LARGE, "%zu models, at most %u are possible", count,
			PLANTS_MAX));
	source->plants = eco_alloc(count, sizeof *source->plants);
	source->plants_by_name = eco_alloc(count, sizeof *source->plants_by_name);
	while (eco_json_next(&node, &entry))
		parse_plant(source, &entry);
	sort_names(source);
}

void eco_source_plant_free(struct eco_source_plant *plant)
{
	eco_scene_paths_free(plant->models, plant->model_count);
	if (plant->variant == 0)
		free_rules(plant);
}
