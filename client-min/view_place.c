#include "client-min/view_place.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>

static bool read_number(const json_t *origin, const char *name, double *value)
{
	const json_t *number = json_object_get(origin, name);
	*value = json_number_value(number);
	return json_is_number(number);
}

enum eco_code view_map_fetch(struct view_fetch *fetch, struct view_map *map, struct eco_error *error)
{
	char *text;
	enum eco_code code = view_fetch_scene(fetch, &text, error);
	if (code)
		return code;
	json_t *about = json_loads(text, 0, NULL);
	const json_t *origin = json_object_get(about, "origin");
	const char *crs = json_string_value(json_object_get(origin, "crs"));
	for (size_t i = 0; i < 3; i++)
		map->at[i] = json_number_value(json_array_get(json_object_get(origin, "at"), i));
	if (snprintf(map->crs, sizeof map->crs, "%s", crs ? crs : "") >= (int)sizeof map->crs)
		code = eco_fail(error, ECO_UNSUPPORTED, "the scene's CRS has more than %zu letters; a pack "
			"made with its code, such as \"EPSG:32632\", says the same", sizeof map->crs);
	json_decref(about);
	free(text);
	return code;
}

enum eco_code view_place_fetch(struct view_fetch *fetch, struct view_sun_place *place,
	struct eco_error *error)
{
	char *text;
	enum eco_code code = view_fetch_scene(fetch, &text, error);
	if (code)
		return code;
	json_t *about = json_loads(text, 0, NULL);
	const json_t *origin = json_object_get(about, "origin");
	if (!read_number(origin, "longitude_deg", &place->longitude_deg)
			|| !read_number(origin, "latitude_deg", &place->latitude_deg)
			|| !read_number(origin, "convergence_deg", &place->convergence_deg))
		code = eco_fail(error, ECO_BAD_INPUT,
			"the scene does not say where on Earth it is: it needs a "
			"crs, and a pack made anew");
	json_decref(about);
	free(text);
	return code;
}
