#include "client-min/view_rows.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define DEGREE_M (6371008.8 * M_PI / 180)
#define EXACT_M 0.05 /* the file has centimetres */
#define HEIGHT_EXACT 0.01

struct row {
	double degrees[2];
	const json_t *properties;
};
struct view_rows {
	json_t *json;
	struct row *items;
	size_t count;
}; /* from south to north */

static int by_latitude(const void *a, const void *b)
{
	const struct row *x = a, *y = b;
	return x->degrees[1] < y->degrees[1] ? -1 : x->degrees[1] > y->degrees[1];
}

static void add_row(struct view_rows *rows, const json_t *feature)
{
	const json_t *at = json_object_get(json_object_get(feature, "geometry"), "coordinates"),
		     *x = json_array_get(at, 0), *y = json_array_get(at, 1);
	if (json_is_number(x) && json_is_number(y))
		rows->items[rows->count++] = (struct row){ { json_number_value(x), json_number_value(y) },
			json_object_get(feature, "properties") };
}

enum eco_code view_rows_load(struct view_rows **out, const char *path, struct eco_error *error)
{
	struct view_rows *rows = calloc(1, sizeof *rows);
	json_error_t why = { .text = "no memory" };
	*out = rows;
	if (rows)
		rows->json = json_load_file(path, 0, &why);
	const json_t *features = rows ? json_object_get(rows->json, "features") : NULL, *feature;
	size_t i;
	if (rows && rows->json && !json_is_array(features))
		snprintf(why.text, sizeof why.text, "it has no features");
	if (features)
		rows->items = calloc(json_array_size(features) + 1, sizeof *rows->items);
	if (!rows || !rows->items || !json_is_array(features))
		return eco_fail(error, ECO_BAD_INPUT,
			"--rows %.200s: %.150s; `ecopack map SCENE.json -o "
			"plants.geojson` makes such a file",
			path, why.text);
	json_array_foreach(features, i, feature) add_row(rows, feature);
	qsort(rows->items, rows->count, sizeof *rows->items, by_latitude);
	return ECO_OK;
}

void view_rows_free(struct view_rows *rows)
{
	if (!rows)
		return;
	json_decref(rows->json);
	free(rows->items);
	free(rows);
}

/* The first row that is not south of a latitude. */
static size_t first_from(const struct view_rows *rows, double latitude)
{
	size_t low = 0, high = rows->count;
	while (low < high) {
		size_t middle = low + (high - low) / 2;
		if (rows->items[middle].degrees[1] < latitude)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

static bool is_as_high(const json_t *properties, const struct view_plant_place *plant)
{
	const json_t *height = json_object_get(properties, "height_m");
	return !json_is_number(height) ||
		fabs(json_number_value(height) / plant->height_m - 1) <= HEIGHT_EXACT;
}

static bool is_named(const json_t *properties, const char *species)
{
	const char *own = json_string_value(json_object_get(properties, "species"));
	return own && strcmp(own, species) == 0;
}

const json_t *view_rows_find(const struct view_rows *rows, const struct view_plant_place *plant)
{
	const double *at = plant->degrees, reach = EXACT_M / DEGREE_M, shrink = cos(at[1] * M_PI / 180);
	const json_t *found = NULL;
	double nearest = reach;
	for (size_t i = first_from(rows, at[1] - reach); i < rows->count; i++) {
		const struct row *row = &rows->items[i];
		double apart = hypot((row->degrees[0] - at[0]) * shrink, row->degrees[1] - at[1]);
		if (row->degrees[1] > at[1] + reach)
			break;
		bool named = is_named(row->properties, plant->species);
		if (apart > nearest || (found && apart == nearest && !named) ||
			!is_as_high(row->properties, plant))
			continue;
		found = row->properties;
		nearest = apart;
	}
	return found;
}
