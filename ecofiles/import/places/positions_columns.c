/* Finds the columns of a table; an error suggests what a user could write. */
#include <stdio.h>
#include <string.h>

#include "ecofiles/format/model.h"
#include "ecofiles/import/places/positions_parts.h"
#include "ecofiles/import/places/size_units.h"
#include "ecofiles/import/places/table_columns.h"

static enum eco_code find_column(struct eco_positions *p, uint32_t *column, const char *name,
	struct eco_error *error)
{
	enum eco_code code = eco_rows_find_column(p->rows, p->spec->path, name, column, error);
	if (*column != ECO_NONE && *column >= p->fields_needed)
		p->fields_needed = *column + 1;
	return code;
}

/* A guess at the column that holds a coordinate, for a message only; "...": none. */
static const char *likely_column(const struct eco_rows *rows, enum eco_role role)
{
	const char *likely = "...";
	int best = ECO_COLUMN_ENOUGH - 1;
	for (uint32_t i = 0; i < rows->column_count; i++) {
		int points = eco_column_points(role, rows->columns[i]);
		likely = points > best ? rows->columns[i] : likely;
		best = points > best ? points : best;
	}
	return likely;
}

static enum eco_code no_coordinates(const struct eco_positions *p, struct eco_error *error)
{
	char there[200];

	eco_rows_list_columns(p->rows, there, sizeof there);
	return eco_fail(error, ECO_BAD_INPUT, "%.120s: it has no geometry, so its entry must name the "
		"columns with easting or longitude and northing "
		"or latitude: add \"x\": \"%.40s\", \"y\": \"%.40s\"; there are: %s", p->spec->path,
		likely_column(p->rows, ECO_ROLE_X), likely_column(p->rows, ECO_ROLE_Y), there);
}

/* Names that say another unit than the metres which are meant without a CRS of the entry. */
static enum eco_code check_unit(const struct eco_positions_spec *s, struct eco_error *error)
{
	double metres = 1;
	const char *unit = s->unit_m == 0 && !s->crs && s->x ? eco_unit_of_place(s->x, s->y, &metres) : NULL;
	if (metres == 1)
		return ECO_OK;
	return eco_fail(error, ECO_BAD_INPUT, "%.200s: \"%.40s\" and \"%.40s\" say %s, and coordinates "
		"without a CRS are in metres; add \"unit\": \"%s\" to its entry (\"m\" if they are), or its "
		"\"crs\"", s->path, s->x, s->y, unit, unit);
}

static enum eco_code find_columns(struct eco_positions *p, struct eco_error *error)
{
	const struct eco_positions_spec *s = p->spec;
	bool geometry_z = s->z && strcmp(s->z, "geometry") == 0 && p->rows->has_geometry;
	const char *names[ECO_COLUMN_FIXED] = { s->x, s->y, geometry_z ? NULL : s->z, s->species, s->yaw_deg,
		s->scale, s->crown.column, s->quadrat.column, s->polar.azimuth, s->polar.distance };
	enum eco_code code = check_unit(s, error);
	p->from_geometry = p->rows->has_geometry && !s->x;
	p->at_origin = !s->x && !p->rows->has_geometry && s->polar.azimuth;
	if (!s->x && !p->rows->has_geometry && !p->at_origin)
		return no_coordinates(p, error);
	if (geometry_z && (!p->from_geometry || !p->rows->has_z))
		return eco_fail(error, ECO_BAD_INPUT, "%.200s: \"z\": \"geometry\", but %s; leave \"z\" out, "
			"and the plants stand on the ground", p->spec->path, p->from_geometry
			? "its points have no heights" : "its coordinates come from columns");
	p->use_z = s->z != NULL;
	p->fields_needed = 0;
	for (int i = 0; code == ECO_OK && i < ECO_COLUMN_FIXED; i++)
		code = find_column(p, &p->column[i], names[i], error);
	for (uint32_t i = 0; code == ECO_OK && i < s->height_count; i++)
		code = find_column(p, &p->height_column[i], s->heights[i].column, error);
	for (uint32_t i = 0; code == ECO_OK && i < s->filter_count; i++)
		code = find_column(p, &p->filter_column[i], s->filters[i].column, error);
	return code;
}

enum eco_code eco_positions_open_rows(struct eco_positions *p, struct eco_error *error)
{
	const struct eco_positions_spec *s = p->spec;
	const char *wanted[ECO_COLUMN_FIXED + ECO_HEIGHT_SOURCES_MAX + ECO_FILTERS_MAX];
	const char *fixed[ECO_COLUMN_FIXED] = { s->x, s->y, s->z, s->species, s->yaw_deg, s->scale,
		s->crown.column, s->quadrat.column, s->polar.azimuth, s->polar.distance };
	struct eco_rows_source source = { .path = s->path, .layer = s->layer, .separator = s->separator,
		.wanted = wanted };
	for (int i = 0; i < ECO_COLUMN_FIXED; i++)
		if (fixed[i])
			wanted[source.wanted_count++] = fixed[i];
	for (uint32_t i = 0; i < s->height_count; i++)
		if (s->heights[i].column)
			wanted[source.wanted_count++] = s->heights[i].column;
	for (uint32_t i = 0; i < s->filter_count; i++)
		wanted[source.wanted_count++] = s->filters[i].column;
	eco_rows_close(p->rows);
	p->rows = NULL;
	enum eco_code code = eco_rows_open(&p->rows, &source, error);
	return code == ECO_OK ? find_columns(p, error) : code;
}
