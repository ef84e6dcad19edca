/* The entries of "instances" with "scatter": areas, numbers of each plant, distances. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/scene/scene_parse.h"

#define KINDS_MAX 4096u
#define DENSITY_MAX 1e8              /* plants a hectare: ten thousand a square metre */

static const char *const scatter_fields[] = { "scatter", "layer", "crs", "density_per_ha", "mix",
	"density_column", "count_column", "distance_m", "clear_of", "clear_layer", "clear_crs",
	"clear_m", "only", "skip", "height_m", "seed", NULL };
static const char *const height_fields[] = { "min", "max", NULL };

static bool parse_plant(const struct eco_source *source, const struct eco_json *at,
	struct eco_scatter_plant *plant)
{
	if (!eco_source_plant_named(source, at, at->key, &plant->plant))
		return false;
	plant->variant_count = source->plants[plant->plant].variant_count;
	if (!json_is_number(at->value)
			|| !(json_number_value(at->value) > 0 && json_number_value(at->value) <= DENSITY_MAX))
		return eco_json_fail(at, ECO_BAD_INPUT, "a number above 0, at most %g", DENSITY_MAX);
	plant->weight = json_number_value(at->value);
	return true;
}

static bool parse_plants(const struct eco_source *source, const struct eco_json *at,
	struct eco_scatter_spec *spec)
{
	struct eco_json entry = { .file = NULL };
	if (!eco_json_names(at, KINDS_MAX))
		return false;
	if (json_object_size(at->value) == 0)
		return eco_json_fail(at, ECO_BAD_INPUT, "it names no plant; such as {\"oak\": 120, \"ash\": "
			"40}");
	spec->plants = calloc(json_object_size(at->value), sizeof *spec->plants);
	if (!spec->plants)
		return eco_json_no_memory(at);
	while (eco_json_next(at, &entry))
		if (!parse_plant(source, &entry, &spec->plants[spec->plant_count++]))
			return false;
	return true;
}

/* Numbers of plants: per hectare for each kind, or shares of a number in a column. */
static bool parse_numbers(const struct eco_source *source, const struct eco_json *at,
	struct eco_scatter_spec *spec)
{
	struct eco_json density = eco_json_member(at, "density_per_ha"), mix = eco_json_member(at, "mix");
	if (!eco_scene_copy_text(at, "density_column", ECO_COLUMN_BYTES, &spec->density_column)
		|| !eco_scene_copy_text(at, "count_column", ECO_COLUMN_BYTES, &spec->count_column))
		return false;
	if ((density.value != NULL) + (spec->density_column != NULL) + (spec->count_column != NULL) != 1
		|| (density.value != NULL) == (mix.value != NULL))
		return eco_json_fail(at, ECO_BAD_INPUT, "say how many: \"density_per_ha\": {\"oak\": 120, "
			"\"ash\": 40}; or \"mix\": {\"oak\": 3, \"ash\": 1} with "
			"\"density_column\" (plants a hectare) or \"count_column\" (plants in the area)");
	return parse_plants(source, density.value ? &density : &mix, spec);
}

static bool parse_height(const struct eco_json *at, struct eco_scatter_spec *spec)
{
	struct eco_json height = eco_json_member(at, "height_m");
	spec->height_low_m = spec->height_high_m = NAN;
	if (!height.value)
		return true;
	if (!json_is_object(height.value)) {
		if (!eco_json_number(at, "height_m", 0.001, 1000, &spec->height_low_m))
			return false;
		spec->height_high_m = spec->height_low_m;
		return true;
	}
	if (!eco_scene_object(&height, height_fields) || !eco_json_required(&height, "min")
			|| !eco_json_required(&height, "max")
		|| !eco_json_number(&height, "min", 0.001, 1000, &spec->height_low_m)
		|| !eco_json_number(&height, "max", 0.001, 1000, &spec->height_high_m))
		return false;
	if (spec->height_low_m <= spec->height_high_m)
		return true;
	return eco_json_fail(&height, ECO_BAD_INPUT, "\"min\" is greater than \"max\"");
}

static bool parse_clear(const struct eco_source *source, const struct eco_json *at,
	struct eco_scatter_spec *spec)
{
	struct eco_json clear_of = eco_json_member(at, "clear_of");
	return (!clear_of.value || eco_scene_parse_path(source, &clear_of, &spec->clear_of))
		&& eco_scene_copy_text(at, "clear_layer", ECO_COLUMN_BYTES, &spec->clear_layer)
		&& eco_scene_parse_crs(source, at, "clear_crs", &spec->clear_crs)
		&& eco_json_number(at, "clear_m", 0, 1e5, &spec->clear_m);
}

bool eco_scene_parse_scatter(const struct eco_source *source, const struct eco_json *at,
	struct eco_scatter_spec *spec)
{
	struct eco_json where = eco_json_member(at, "scatter");
	eco_json_place(&where, &spec->line, &spec->column);
	return eco_scene_object(at, scatter_fields) && eco_scene_parse_path(source, &where, &spec->path)
		&& eco_scene_copy_text(at, "layer", ECO_COLUMN_BYTES, &spec->layer)
		&& eco_scene_parse_crs(source, at, "crs", &spec->crs) && parse_numbers(source, at, spec)
		&& eco_json_number(at, "distance_m", 0, 1e5, &spec->distance_m)
		&& parse_clear(source, at, spec)
		&& eco_scene_parse_filters(at, &spec->filters, &spec->filter_count) && parse_height(at, spec)
		&& eco_json_whole(at, "seed", 0, INT64_MAX, &spec->seed);
}

void eco_scatter_spec_free(struct eco_scatter_spec *spec)
{
	char *texts[] = { spec->path, spec->layer, spec->crs, spec->density_column, spec->count_column,
		spec->clear_of, spec->clear_layer, spec->clear_crs };

	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
		free(texts[i]);
	eco_filters_free(spec->filters, spec->filter_count);
	free(spec->plants);
	*spec = (struct eco_scatter_spec){ .path = NULL };
}
