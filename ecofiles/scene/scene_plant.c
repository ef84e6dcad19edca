/* "plants" of a scene file: the files of a plant, how to read them, and rules about its parts. */
#include "ecofiles/import/model/model_import.h"
#include "ecofiles/scene/scene_parse.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/phrase.h"

#define PLANTS_MAX 65536u
#define VARIANTS_MAX 256u
#define FILES_MAX 64u
#define RULES_MAX 1024u
#define HEIGHT_MAX_M 1000.0

static const char *const plant_fields[] = { "model", "variants", "height_m", "unit", "up", "parts",
	"importance", NULL };
static const char *const importance_fields[] = { "wood", "foliage", "flower", NULL };
static const char *const rule_fields[] = { "name", "component", "size", "is", "importance", NULL };

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

bool eco_source_plant_named(const struct eco_source *source, const struct eco_json *at, const char *name,
	uint32_t *plant)
{
	char known[200] = "";
	*plant = find_plant(source, name);
	if (*plant != ECO_NONE)
		return true;
	for (uint32_t i = 0; i < source->plant_count; i += source->plants[i].variant_count)
		eco_phrase_add(known, sizeof known, source->plants[i].name);
	return eco_json_fail(at, ECO_BAD_INPUT, "plant \"%.63s\" is not among \"plants\": %s", name,
		known[0] != 0 ? known : "there are none");
}

bool eco_source_plant_of(const struct eco_source *source, const struct eco_json *at, uint32_t *plant)
{
	return eco_json_is_text(at, sizeof source->plants->name - 1)
		&& eco_source_plant_named(source, at, json_string_value(at->value), plant);
}

/* ---- Files ---- */

/* Adds a variant of `plant`, with the files of `files`, to the source's plants. */
static bool add_variant(struct eco_source *source, const struct eco_json *files,
	const struct eco_source_plant *plant)
{
	struct eco_source_plant *slot = &source->plants[source->plant_count++];
	*slot = *plant;
	return eco_scene_parse_paths(source, files, "file", FILES_MAX, &slot->models, &slot->model_count);
}

static bool parse_variants(struct eco_source *source, const struct eco_json *at,
	struct eco_source_plant *plant)
{
	struct eco_json model = eco_json_member(at, "model"), variants = eco_json_member(at, "variants");
	if ((model.value != NULL) == (variants.value != NULL))
		return eco_json_fail(at, ECO_BAD_INPUT, "a plant has either \"model\": \"FILE\" (or several "
			"files that make it up: [\"wood.obj\", \"leaves.obj\"]), or \"variants\": [\"FILE\", "
			"...], one for each instance");
	if (model.value)
		return add_variant(source, &model, plant);
	if (!eco_json_array(&variants, VARIANTS_MAX))
		return false;
	plant->variant_count = (uint32_t)json_array_size(variants.value);
	if (plant->variant_count == 0)
		return eco_json_fail(&variants, ECO_BAD_INPUT, "\"variants\" names no file");
	for (; plant->variant < plant->variant_count; plant->variant++) {
		struct eco_json item = eco_json_item(&variants, plant->variant);
		if (!add_variant(source, &item, plant))
			return false;
	}
	return true;
}

/* ---- How to read the files ---- */

static bool parse_up(const struct eco_json *at, enum eco_up *up)
{
	struct eco_json node = eco_json_member(at, "up");
	const char *name = NULL;
	if (!eco_json_text(at, "up", 8, &name))
		return false;
	if (!name)
		return true;
	if (eco_up_of(name, up))
		return true;
	return eco_json_fail(&node, ECO_BAD_INPUT, "\"up\" is \"x\", \"y\" or \"z\": the axis of the file "
		"that points up");
}

static bool parse_importance(const struct eco_json *at, float importance[ECO_ORGAN_COUNT])
{
	struct eco_json node = eco_json_member(at, "importance");
	for (int i = 0; i < ECO_ORGAN_COUNT; i++)
		importance[i] = 0;
	if (!node.value)
		return true;
	if (!eco_scene_object(&node, importance_fields))
		return false;
	for (int i = 0; i < ECO_ORGAN_COUNT; i++) {
		double number = 1;
		if (!eco_json_number(&node, importance_fields[i], ECO_IMPORTANCE_LEAST,
				ECO_IMPORTANCE_MOST, &number))
			return false;
		importance[i] = (float)number;
	}
	return true;
}

/* ---- Rules about parts ---- */

static bool parse_is(const struct eco_json *at, uint8_t *is)
{
	struct eco_json node = eco_json_member(at, "is");
	const char *name = NULL;
	*is = ECO_ORGAN_FOUND;
	if (!node.value && eco_json_member(at, "importance").value)
		return true;             /* the organ is found, and weighs more or less */
	if (!eco_json_required(at, "is") || !eco_json_text(at, "is", 16, &name))
		return false;
	if (strcmp(name, "left out") == 0) {
		*is = ECO_PART_LEFT_OUT;
		return true;
	}
	for (uint8_t i = 0; i < ECO_ORGAN_COUNT; i++)
		if (strcmp(name, importance_fields[i]) == 0) {
			*is = i;
			return true;
		}
	return eco_json_fail(&node, ECO_BAD_INPUT, "a part is \"wood\", \"foliage\", \"flower\" or \"left "
		"out\"");
}

static bool parse_rule(const struct eco_json *at, struct eco_part_rule *rule)
{
	struct eco_json size = eco_json_member(at, "size");
	const char *name = NULL;
	uint64_t component = 0;
	double importance = 0;
	if (!eco_scene_object(at, rule_fields) || !parse_is(at, &rule->is)
			|| !eco_json_number(at, "importance", ECO_IMPORTANCE_LEAST, ECO_IMPORTANCE_MOST,
				&importance)
			|| !eco_json_text(at, "name", 255, &name)
		|| !eco_json_whole(at, "component", 1, UINT32_MAX, &component)
		|| !eco_json_numbers(at, "size", 2, 2, 0, 1e9, rule->size))
		return false;
	if ((name != NULL) + (component > 0) + (size.value != NULL) != 1)
		return eco_json_fail(at, ECO_BAD_INPUT, "a rule has exactly one of \"name\": \"pot*\", "
			"\"component\": 1, \"size\": [0, 0.1]");
	rule->kind = name ? ECO_PART_NAME : component > 0 ? ECO_PART_COMPONENT : ECO_PART_SIZE;
	rule->component = (uint32_t)component;
	rule->importance = (float)importance;
	rule->name = name ? strdup(name) : NULL;
	return !name || rule->name || eco_json_no_memory(at);
}

static bool parse_rules(const struct eco_json *at, struct eco_source_plant *plant)
{
	struct eco_json node = eco_json_member(at, "parts");
	if (!node.value)
		return true;
	if (!eco_json_array(&node, RULES_MAX))
		return false;
	plant->parts = calloc(json_array_size(node.value) + 1, sizeof *plant->parts);
	if (!plant->parts)
		return eco_json_no_memory(&node);
	for (size_t i = 0; i < json_array_size(node.value); i++) {
		struct eco_json item = eco_json_item(&node, i);
		if (!parse_rule(&item, &plant->parts[plant->part_count++]))
			return false;
	}
	return true;
}

static void free_rules(struct eco_source_plant *plant)
{
	for (uint32_t i = 0; i < plant->part_count; i++)
		free(plant->parts[i].name);
	free(plant->parts);
}

/* ---- All ---- */

static bool parse_plant(struct eco_source *source, const struct eco_json *at)
{
	struct eco_source_plant plant = { .variant_count = 1 };
	uint32_t before = source->plant_count;
	bool good = eco_source_name_is_fine(at, at->key, strlen(at->key)) &&
		eco_scene_object(at, plant_fields) &&
		eco_json_number(at, "height_m", 0.001, HEIGHT_MAX_M, &plant.height_m) &&
		eco_scene_parse_unit(at, &plant.unit_m) && parse_up(at, &plant.up) &&
		parse_importance(at, plant.importance) && parse_rules(at, &plant);

	if (good) {
		memcpy(plant.name, at->key, strlen(at->key) + 1);
		good = parse_variants(source, at, &plant);
	}
	if (source->plant_count == before)   /* the rules have no owner yet */
		free_rules(&plant);
	return good;
}

static size_t count_variants(const json_t *plants)
{
	const char *key;
	json_t *plant;
	size_t count = 0;
	json_object_foreach((json_t *)plants, key, plant) {
		size_t variants = json_array_size(json_object_get(plant, "variants"));
		(void)key;
		count += variants > 1 ? variants : 1;
	}
	return count;
}

bool eco_scene_parse_plants(struct eco_source *source, const struct eco_json *top)
{
	struct eco_json node = eco_json_member(top, "plants"), entry = { .file = NULL };
	if (!node.value)
		return true;
	if (!json_is_object(node.value))
		return eco_scene_object(&node, plant_fields);
	size_t count = count_variants(node.value);
	if (count > PLANTS_MAX)
		return eco_json_fail(&node, ECO_TOO_LARGE, "%zu models, at most %u are possible", count,
			PLANTS_MAX);
	source->plants = calloc(count + 1, sizeof *source->plants);
	source->plants_by_name = calloc(count + 1, sizeof *source->plants_by_name);
	if (!source->plants || !source->plants_by_name)
		return eco_json_no_memory(&node);
	while (eco_json_next(&node, &entry))
		if (!parse_plant(source, &entry))
			return false;
	sort_names(source);
	return true;
}

void eco_source_plant_free(struct eco_source_plant *plant)
{
	for (uint32_t i = 0; i < plant->model_count; i++)
		free(plant->models[i]);
	free(plant->models);
	if (plant->variant == 0)
		free_rules(plant);
}
