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

/* What the server says of the scene, which is the caller's, and its origin in it. */
static enum eco_code fetch_origin(struct view_fetch *fetch, json_t **about, const json_t **origin,
	struct eco_error *error)
{
	char *text;
	enum eco_code code = view_fetch_scene(fetch, &text, error);
	if (code)
		return code;
	*about = json_loads(text, 0, NULL);
	*origin = json_object_get(*about, "origin");
	free(text);
	return ECO_OK;
}

enum eco_code view_map_fetch(struct view_fetch *fetch, struct view_map *map, struct eco_error *error)
{
	json_t *about;
	const json_t *origin;
	enum eco_code code = fetch_origin(fetch, &about, &origin, error);
	if (code)
		return code;
	const char *crs = json_string_value(json_object_get(origin, "crs"));
	for (size_t i = 0; i < 3; i++)
		map->at[i] = json_number_value(json_array_get(json_object_get(origin, "at"), i));
	if (snprintf(map->crs, sizeof map->crs, "%s", crs ? crs : "") >= (int)sizeof map->crs)
		code = eco_fail(error, ECO_UNSUPPORTED, "the scene's CRS has more than %zu letters; a pack "
			"made with its code, such as \"EPSG:32632\", says the same", sizeof map->crs);
	json_decref(about);
	return code;
}

enum eco_code view_place_fetch(struct view_fetch *fetch, struct view_sun_place *place,
	struct eco_error *error)
{
	json_t *about;
	const json_t *origin;
	enum eco_code code = fetch_origin(fetch, &about, &origin, error);
	if (code)
		return code;
	if (!read_number(origin, "longitude_deg", &place->longitude_deg)
			|| !read_number(origin, "latitude_deg", &place->latitude_deg)
			|| !read_number(origin, "convergence_deg", &place->convergence_deg))
		code = eco_fail(error, ECO_BAD_INPUT,
			"the scene does not say where on Earth it is: it needs a "
			"crs, and a pack made anew");
	json_decref(about);
	return code;
}
