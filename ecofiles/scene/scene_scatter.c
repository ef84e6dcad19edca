/* The entries of "instances" with "scatter": areas, numbers of each plant, distances. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/scene/scene_parse.h"

#define KINDS_MAX 4096u
#define DENSITY_MAX 1e8              /* plants a hectare: ten thousand a square metre */

#define FIELD(name, kind, low, high, member) ECO_FIELD(name, kind, low, high, scatter_spec, member)
static const struct eco_field scatter_fields[] = {
	FIELD("scatter", PATH, 0, 0, path), FIELD("layer", COLUMN, 0, 0, layer), FIELD("crs", CRS, 0, 0, crs),
	ECO_OTHER("density_per_ha"), ECO_OTHER("mix"),
	FIELD("density_column", COLUMN, 0, 0, density_column), FIELD("count_column", COLUMN, 0, 0, count_column),
	FIELD("distance_m", NUMBER, 0, 1e5, distance_m), FIELD("clear_of", PATH, 0, 0, clear_of),
	FIELD("clear_layer", COLUMN, 0, 0, clear_layer), FIELD("clear_crs", CRS, 0, 0, clear_crs),
	FIELD("clear_m", NUMBER, 0, 1e5, clear_m), ECO_OTHER("only"), ECO_OTHER("skip"),
	ECO_OTHER("height_m"), FIELD("seed", WHOLE, 0, INT64_MAX, seed), ECO_FIELDS_END
};
static const struct eco_field height_fields[] = {
	FIELD("min", NUMBER | ECO_IS_REQUIRED, 0.001, 1000, height_low_m),
	FIELD("max", NUMBER | ECO_IS_REQUIRED, 0.001, 1000, height_high_m), ECO_FIELDS_END
};

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
	spec->plants = eco_alloc(json_object_size(at->value), sizeof *spec->plants);
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
	if ((density.value != NULL) + (spec->density_column != NULL) + (spec->count_column != NULL) != 1
		|| (density.value != NULL) == (mix.value != NULL))
		return eco_json_fail(at, ECO_BAD_INPUT, "say how many: \"density_per_ha\": {\"oak\": 120, "
			"\"ash\": 40}; or \"mix\": {\"oak\": 3, \"ash\": 1} with "
			"\"density_column\" (plants a hectare) or \"count_column\" (plants in the area)");
	return parse_plants(source, density.value ? &density : &mix, spec);
}

static bool parse_height(const struct eco_source *source, const struct eco_json *at,
	struct eco_scatter_spec *spec)
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
	if (!eco_scene_fields(source, &height, height_fields, spec))
		return false;
	if (spec->height_low_m <= spec->height_high_m)
		return true;
	return eco_json_fail(&height, ECO_BAD_INPUT, "\"min\" is greater than \"max\"");
}

bool eco_scene_parse_scatter(const struct eco_source *source, const struct eco_json *at,
	struct eco_scatter_spec *spec)
{
	struct eco_json where = eco_json_member(at, "scatter");
	eco_json_place(&where, &spec->line, &spec->column);
	return eco_scene_fields(source, at, scatter_fields, spec) && parse_numbers(source, at, spec)
		&& eco_scene_parse_filters(at, &spec->filters, &spec->filter_count)
		&& parse_height(source, at, spec);
}

void eco_scatter_spec_free(struct eco_scatter_spec *spec)
{
	eco_scene_fields_free(scatter_fields, spec);
	eco_filters_free(spec->filters, spec->filter_count);
	free(spec->plants);
	*spec = (struct eco_scatter_spec){ .path = NULL };
}
