/* The input of a scatter. Areas come as rows with geometry, through the same child process, columns and filters as
 * inventories. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/format/model.h"
#include "ecofiles/import/places/crs.h"
#include "ecofiles/import/places/rows/rows.h"
#include "ecofiles/import/places/scatter_parts.h"

#define DISTANCE_MAX_M 1e7           /* as for inventories */

/* ---- Areas ---- */

struct reading {
	struct eco_scatter_input *input;
	const struct eco_scatter_spec *spec;
	const char *path;
	struct eco_rows *rows;
	struct eco_crs *crs;
	struct eco_crs_span span;
	uint32_t number_column, filter_column[ECO_FILTERS_MAX];
	bool converted, near;        /* of this feature, so far */
};

static bool convert(void *ctx, double xy[2], struct eco_error *error)
{
	struct reading *r = ctx;
	double xyz[3] = { xy[0], xy[1], 0 };
	const char *why;
	if (eco_crs_convert(r->crs, xyz, &r->converted, &why, error) != ECO_OK)
		return false;
	eco_crs_span_add(&r->span, xy);
	xy[0] = xyz[0];
	xy[1] = xyz[1];
	r->near = fabs(xy[0]) <= DISTANCE_MAX_M && fabs(xy[1]) <= DISTANCE_MAX_M;
	return r->converted && r->near;
}

static void skip(struct reading *r, enum eco_scatter_why why)
{
	if (r->input->skipped[why]++ == 0)
		r->input->first_line[why] = r->rows->line;
}

static bool passes(const struct reading *r)
{
	for (uint32_t i = 0; i < r->spec->filter_count; i++)
		if (!eco_filter_passes(&r->spec->filters[i], r->rows->fields[r->filter_column[i]], '.'))
			return false;
	return true;
}

/* Keeps the number of the area added last. */
static void keep_number(struct reading *r, double number)
{
	const struct eco_areas *areas = &r->input->areas;
	r->input->number = eco_realloc(r->input->number, areas->capacity, sizeof *r->input->number);
	r->input->number[areas->count - 1] = number;
}

static enum eco_code take_row(struct reading *r, struct eco_areas *areas, bool surfaces,
	struct eco_error *error)
{
	const struct eco_rows_place *place = &r->rows->place;
	double number = 0;
	bool kept;
	r->input->features += surfaces;
	if (surfaces && !passes(r))
		return skip(r, ECO_AREA_FILTERED), ECO_OK;
	if (place->kind != ECO_PLACE_AREA)
		return surfaces ? skip(r, ECO_AREA_NO_GEOMETRY) : (void)0, ECO_OK;
	if (r->number_column != ECO_NONE && (!eco_text_number(r->rows->fields[r->number_column], '.', &number)
			|| !(number >= 0)))
		return skip(r, ECO_AREA_NO_NUMBER), ECO_OK;
	r->converted = r->near = true;
	enum eco_code code = eco_areas_add_wkb(areas, place->wkb, place->wkb_bytes, convert, r, &kept, error);
	if (code)
		return code;
	if (!kept)
		return surfaces
			? skip(r, !r->converted ? ECO_AREA_NO_CONVERSION : r->near ? ECO_AREA_NO_GEOMETRY
			: ECO_AREA_TOO_FAR) : (void)0, ECO_OK;
	if (surfaces && areas->items[areas->count - 1].ring_edges == 0) {
		areas->edge_count = areas->items[--areas->count].edge_first;
		return skip(r, ECO_AREA_NOT_A_SURFACE), ECO_OK;
	}
	if (surfaces && r->number_column != ECO_NONE)
		keep_number(r, number);
	return ECO_OK;
}

static enum eco_code read_rows(struct reading *r, struct eco_areas *areas, bool surfaces,
	struct eco_error *error)
{
	const struct eco_scatter_spec *s = r->spec;
	enum eco_code code = ECO_OK;
	bool more = true;
	r->number_column = ECO_NONE;
	if (surfaces)
		code = eco_rows_find_column(r->rows, r->path, s->density_column ? s->density_column
			: s->count_column, &r->number_column, error);
	for (uint32_t i = 0; surfaces && i < s->filter_count && code == ECO_OK; i++)
		code = eco_rows_find_column(r->rows, r->path, s->filters[i].column, &r->filter_column[i],
			error);
	while (code == ECO_OK && more) {
		code = r->rows->next(r->rows, &more, error);
		if (code == ECO_OK && more)
			code = take_row(r, areas, surfaces, error);
	}
	return code;
}

static enum eco_code read_areas(struct eco_scatter_input *input, struct eco_areas *areas,
	const struct eco_scatter_spec *spec, const struct eco_frame *frame, struct eco_error *error)
{
	bool surfaces = areas == &input->areas;
	struct reading r = { .input = input, .spec = spec, .path = surfaces ? spec->path : spec->clear_of };
	struct eco_rows_source source = { .path = r.path, .layer = surfaces ? spec->layer : spec->clear_layer,
		.areas = true };
	enum eco_code code = eco_rows_open(&r.rows, &source, error);
	if (!code)
		code = eco_crs_open(&r.crs, &(struct eco_crs_request){ .path = r.path, .stated = surfaces
			? spec->crs : spec->clear_crs, .of_file = r.rows->crs, 
			.frame = frame, .note = eco_rows_note, .ctx = r.rows }, error);
	if (code == ECO_OK && r.rows->degrees_doubted && !(surfaces ? spec->crs : spec->clear_crs))
		code = eco_fail(error, ECO_BAD_INPUT, "%.200s: its numbers cannot be degrees, as its format "
			"says; add \"%s\": \"EPSG:...\", the CRS that they are in", r.path, surfaces ? "crs" : "clear_crs");
	if (!code)
		code = read_rows(&r, areas, surfaces, error);
	const char *stated = surfaces ? spec->crs : spec->clear_crs;
	enum eco_crs_fit fit;
	char area[80];
	if (!code)
		code = eco_crs_refuse_degrees(&r.span,
			stated ? stated : r.rows->crs,
			false, r.path, &fit, area, error);
	if (!code && fit == ECO_CRS_SWAPPED)
		eco_rows_note(r.rows,
			"its corners lie outside the area of use of their CRS (%s), and inside with their coordinates "
			"swapped: x is easting or longitude, y is northing or latitude",
			area);
	if (!code)
		code = eco_areas_index(areas, surfaces ? 0 : spec->clear_m, error);
	for (uint32_t i = 0; r.rows && i < r.rows->note_count && input->note_count < 2 * ECO_ROWS_NOTES_MAX; i++)
		input->notes[input->note_count++] = eco_copy_text(r.rows->notes[i]);
	eco_crs_close(r.crs);
	eco_rows_close(r.rows);
	return code;
}

/* ---- Both ---- */

enum eco_code eco_scatter_read(struct eco_scatter_input *input, const struct eco_scatter_spec *spec,
	const struct eco_frame *frame, struct eco_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	enum eco_code code = read_areas(input, &input->areas, spec, frame, &own);
	if (code)
		return eco_fail(error, code, "%s%s", own.text, code == ECO_BAD_INPUT && input->features == 0
			? "; a raster of densities becomes polygons by gdal_polygonize.py, with \"density_column\"" : "");
	return spec->clear_of ? read_areas(input, &input->clear, spec, frame, error) : ECO_OK;
}

void eco_scatter_input_free(struct eco_scatter_input *input)
{
	eco_areas_free(&input->areas);
	eco_areas_free(&input->clear);
	free(input->number);
	for (uint32_t i = 0; i < input->note_count; i++)
		free(input->notes[i]);
}
