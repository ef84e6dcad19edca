/* The entries of "instances" with "extrude": buildings from footprints. */
#include "ecofiles/scene/scene_parse.h"

#include <math.h>
#include <stdlib.h>

#include "ecofiles/base/memory.h"

#define AREA(name, kind, member) ECO_FIELD(name, kind, 0, 0, footprints_spec, member)
static const struct eco_field footprint_fields[] = { AREA("extrude", PATH, path),
	AREA("layer", COLUMN, layer), AREA("crs", CRS, crs), AREA("roof", COLUMN, roof),
	ECO_OTHER("height_m"), ECO_OTHER("only"), ECO_OTHER("skip"), ECO_FIELDS_END };
/* A height's object: one of both columns. */
struct eco_building_height {
	double unit_m, storey_m;
	char *storeys, *column;
};
static const struct eco_field height_fields[] = { ECO_FIELD("unit", UNIT, 0, 0, building_height, unit_m),
	ECO_FIELD("storey_m", NUMBER, 0.5, 100, building_height, storey_m),
	/* at last, so that none is lost where another field stops */
	ECO_FIELD("column", COLUMN, 0, 0, building_height, column),
	ECO_FIELD("storeys", COLUMN, 0, 0, building_height, storeys), ECO_FIELDS_END };

static void parse_object(const struct eco_source *source, const struct eco_json *at,
	struct eco_footprint_height *height)
{
	struct eco_building_height own = { .unit_m = 1, .storey_m = ECO_STOREY_M };
	struct eco_json column = eco_json_member(at, "column"), storeys = eco_json_member(at, "storeys"),
			unit = eco_json_member(at, "unit"), storey = eco_json_member(at, "storey_m");
	if ((column.value != NULL) == (storeys.value != NULL) || (column.value ? storey.value : unit.value))
		eco_scene_fail(at,
			"a height's object is {\"column\": \"Height\", \"unit\": \"ft\"} or {\"storeys\": \"Levels\", "
			"\"storey_m\": 3}");
	eco_scene_fields(source, at, height_fields, &own);
	*height = (struct eco_footprint_height){ own.column ? own.column : own.storeys,
		own.column ? own.unit_m : own.storey_m, .storeys = own.storeys != NULL };
}

static void parse_height(const struct eco_source *source, const struct eco_json *at,
	struct eco_footprint_height *height)
{
	if (json_is_object(at->value)) {
		parse_object(source, at, height);
		return;
	}
	height->unit_m = 1;
	if (json_is_string(at->value)) {
		eco_scene_copy(at, ECO_COLUMN_BYTES, &height->column);
		return;
	}
	height->value_m = json_is_number(at->value) ? json_number_value(at->value) : NAN;
	if (!(height->value_m >= 0.1 && height->value_m <= ECO_BUILDING_MOST_M))
		eco_scene_fail(at,
			"a height is a number of metres between 0.1 and %g, a column of metres such as \"Height\", or an "
			"object such as {\"storeys\": \"Levels\"}",
			ECO_BUILDING_MOST_M);
}

void eco_scene_parse_footprints(const struct eco_source *source, const struct eco_json *at,
	struct eco_footprints_spec *spec)
{
	struct eco_json where = eco_json_member(at, "extrude"), heights = eco_json_member(at, "height_m");
	eco_json_place(&where, &spec->line, &spec->column);
	eco_scene_fields(source, at, footprint_fields, spec);
	eco_scene_need(!heights.value || !json_is_array(heights.value) ||
		eco_json_array(&heights, ECO_FOOTPRINT_HEIGHTS));
	for (size_t i = 0; heights.value && i < eco_scene_several(&heights); i++) {
		struct eco_json item = eco_scene_one(&heights, i);
		parse_height(source, &item, &spec->heights[spec->height_count++]);
	}
	eco_scene_parse_filters(at, &spec->filters, &spec->filter_count);
}

void eco_footprints_spec_free(struct eco_footprints_spec *spec)
{
	eco_scene_fields_free(footprint_fields, spec);
	for (uint32_t i = 0; i < spec->height_count; i++)
		free(spec->heights[i].column);
	eco_filters_free(spec->filters, spec->filter_count);
	*spec = (struct eco_footprints_spec){ .path = NULL };
}
