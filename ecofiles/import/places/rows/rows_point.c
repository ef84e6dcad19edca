/* Points as text, in tables that have no geometry: well-known text, and pairs of degrees. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/import/places/rows/rows_formats.h"

#define DEGREE_DIGITS 6

/* "POINT (11.5 48.1)", "SRID=4326;POINT Z (11.5 48.1 520)". False if it is another geometry. */
static bool read_wkt_point(const char *text, double at[3])
{
	const char *semicolon = strncasecmp(text, "SRID=", 5) == 0 ? strchr(text, ';') : NULL;
	char number[3][40];
	text = semicolon ? semicolon + 1 : text;
	text += strspn(text, " ");
	if (strncasecmp(text, "POINT", 5) != 0)
		return false;
	text += 5 + strspn(text + 5, " ZzMm");
	int count = sscanf(text, "(%39[0-9.eE+-]%*[ ]%39[0-9.eE+-]%*[ ]%39[0-9.eE+-]", number[0], number[1],
		number[2]);
	for (int k = 0; k < 3; k++)
		if (k >= count || !eco_text_number(number[k], '.', &at[k]))
			at[k] = NAN;
	return count >= 2 && !isnan(at[0]) && !isnan(at[1]);
}

/* The digits behind the point; -1 if it is no number with a point. */
static int read_degrees(const char **text, double *degrees)
{
	char number[40];
	size_t length = strspn(*text, "0123456789.+-");
	const char *point = memchr(*text, '.', length);
	if (!point || length >= sizeof number)
		return -1;
	memcpy(number, *text, length);
	number[length] = 0;
	int digits = (int)(*text + length - point - 1);
	*text += length;
	return eco_text_number(number, '.', degrees) ? digits : -1;
}

/* Latitude and longitude in one field, as portals of open data write them: "48.883980, 2.360000", or in
 * brackets at the end of an address. Returns the digits behind the two points, -1 if it is no such pair. */
static int degree_pair(const char *text, double at[3])
{
	size_t length = strlen(text);
	while (length > 0 && text[length - 1] == ' ')
		length--;
	bool closed = length > 0 && text[length - 1] == ')';
	const char *open = strrchr(text, '(');
	if (closed != (open != NULL))
		return -1;
	text = open ? open + 1 : text;
	text += strspn(text, " ");
	int first = read_degrees(&text, &at[1]);
	text += strspn(text, " ");
	if (first < 0 || *text++ != ',')
		return -1;
	text += strspn(text, " ");
	int second = read_degrees(&text, &at[0]);
	text += strspn(text, " )");
	at[2] = NAN;
	return second >= 0 && *text == 0 && fabs(at[1]) <= 90 && fabs(at[0]) <= 180 ? first + second : -1;
}

static bool read_degree_pair(const char *text, double at[3])
{
	return degree_pair(text, at) >= 0;
}

/* DEGREE_DIGITS tell it from other pairs of numbers. */
static bool is_degree_pair(const char *text, double at[3])
{
	return degree_pair(text, at) >= DEGREE_DIGITS;
}

bool eco_rows_point_find(struct eco_rows *rows, struct eco_rows_point *point)
{
	static const struct {
		bool (*is)(const char *, double[3]), (*read)(const char *, double[3]);
	} forms[] = { { read_wkt_point, read_wkt_point }, { is_degree_pair, read_degree_pair } };
	double at[3];
	for (size_t k = 0; k < sizeof forms / sizeof *forms; k++)
		for (uint32_t i = 0; i < rows->field_count && i < rows->column_count; i++)
			if (forms[k].is(rows->fields[i], at)) {
				*point = (struct eco_rows_point){ i, forms[k].read };
				rows->has_geometry = true;
				rows->has_z = !isnan(at[2]);
				return true;
			}
	return false;
}

enum eco_code eco_rows_point_state(struct eco_rows *rows, const struct eco_rows_point *point,
	const char *path, struct eco_error *error)
{
	if (point->read != read_degree_pair)
		return ECO_OK;
	rows->crs = strdup("EPSG:4326");
	if (!rows->crs)
		return eco_fail(error, ECO_NO_MEMORY, "%.300s: out of memory", path);
	eco_rows_note(rows, "\"%.60s\" has latitude and longitude in one field", rows->columns[point->column]);
	return ECO_OK;
}

void eco_rows_point_take(struct eco_rows *rows, const struct eco_rows_point *point)
{
	struct eco_rows_place *place = &rows->place;
	const char *text = point->column < rows->field_count ? rows->fields[point->column] : "";
	text += strspn(text, " ");
	if (eco_text_is_missing(text) || strcasestr(text, "EMPTY")) {
		place->kind = ECO_PLACE_EMPTY;
	} else if (point->read(text, place->at)) {
		place->kind = ECO_PLACE_POINT;
		rows->has_z |= !isnan(place->at[2]);
	} else {
		place->kind = ECO_PLACE_OTHER;
		snprintf(place->what, sizeof place->what, "%.*s", (int)strcspn(text, " ("), text);
	}
}
