/* Bands of y are the index of both questions: each lists the edges of a surface, the surfaces, or the edges
 * widened by near_m that touch it. Areas come as rows with geometry, through the same child process, columns
 * and filters as inventories. */
#include "ecofiles/import/land/areas.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/import/places/crs.h"
#include "ecofiles/import/places/inventory_text.h"
#include "ecofiles/import/places/rows/rows.h"
#include "ecofiles/import/land/scatter_parts.h"

#define DEPTH_MAX 16
#define STRIPS_MAX (1u << 20)
#define LINKS_MAX (1u << 27)
#define LINKS_EACH 8.0

enum { WKB_POINT = 1, WKB_LINE = 2, WKB_POLYGON = 3, WKB_POINTS = 4, WKB_LINES = 5, WKB_POLYGONS = 6,
	WKB_COLLECTION = 7 };

struct reading {
	struct eco_areas *areas;
	struct eco_reader wkb;
	eco_area_convert *convert;
	void *ctx;
	bool kept, surfaces;         /* this pass takes surfaces; else lines and points */
	struct eco_error *error;
};

static enum eco_code damaged(const struct reading *r)
{
	return eco_fail(r->error, ECO_DAMAGED, "a geometry that does not hold together at byte %zu of %zu",
		r->wkb.at, r->wkb.size);
}

static enum eco_code add_edge(struct reading *r, const double a[2], const double b[2])
{
	struct eco_areas *s = r->areas;
	if (s->edge_count == ECO_AREA_POINTS_MAX)
		return eco_fail(r->error, ECO_TOO_LARGE, "no room for more than %u corners of areas",
			s->edge_count);
	eco_grow(&s->edges, &s->edge_capacity, s->edge_count, sizeof *s->edges);
	s->edges[s->edge_count++] = (struct eco_edge){ { a[0], a[1] }, { b[0], b[1] } };
	return ECO_OK;
}

/* Reads `count` corners; keeps the edges between them in the pass that wants them. */
static enum eco_code take_path(struct reading *r, uint32_t count, bool ring)
{
	double first[2] = { 0, 0 }, last[2] = { 0, 0 };
	enum eco_code code = ECO_OK;
	if (r->wkb.failed || count > (r->wkb.size - r->wkb.at) / 16)
		return damaged(r);
	for (uint32_t i = 0; i < count && code == ECO_OK; i++) {
		double at[2] = { eco_read_f64(&r->wkb), 0 };
		at[1] = eco_read_f64(&r->wkb);
		if (ring != r->surfaces)
			continue;
		r->kept = r->kept && isfinite(at[0]) && isfinite(at[1]) && r->convert(r->ctx, at, r->error)
			&& isfinite(at[0]) && isfinite(at[1]);
		if (!r->kept)
			return r->error && r->error->code != ECO_OK ? r->error->code : ECO_OK;
		if (i > 0 || count == 1)
			code = add_edge(r, i > 0 ? last : at, at);
		else
			memcpy(first, at, sizeof first);
		memcpy(last, at, sizeof last);
	}
	if (code == ECO_OK && ring && r->surfaces && count > 1
			&& (first[0] != last[0] || first[1] != last[1]))
		code = add_edge(r, last, first);
	return code;
}

static enum eco_code take_geometry(struct reading *r, int depth)
{
	uint8_t little = eco_read_u8(&r->wkb);
	uint32_t kind = eco_read_u32(&r->wkb), count = kind == WKB_POINT ? 1 : eco_read_u32(&r->wkb);
	enum eco_code code = ECO_OK;
	if (depth > DEPTH_MAX || r->wkb.failed || little != 1 || kind < WKB_POINT || kind > WKB_COLLECTION)
		return damaged(r);
	if (kind == WKB_POINT || kind == WKB_LINE)
		return take_path(r, count, false);
	if (count > r->wkb.size - r->wkb.at)
		return damaged(r);
	for (uint32_t i = 0; i < count && !code && r->kept; i++)
		code = kind == WKB_POLYGON ? take_path(r, eco_read_u32(&r->wkb), true)
			: take_geometry(r, depth + 1);
	return code;
}

static void measure(const struct eco_areas *areas, struct eco_area *area)
{
	const struct eco_edge *edges = areas->edges + area->edge_first;
	for (int k = 0; k < 2; k++) {
		area->low[k] = INFINITY;
		area->high[k] = -INFINITY;
	}
	for (uint32_t i = 0; i < area->edge_count; i++)
		for (int k = 0; k < 2; k++) {
			area->low[k] = fmin(area->low[k], fmin(edges[i].a[k], edges[i].b[k]));
			area->high[k] = fmax(area->high[k], fmax(edges[i].a[k], edges[i].b[k]));
		}
}

enum eco_code eco_areas_add_wkb(struct eco_areas *areas, const uint8_t *wkb, size_t size,
	eco_area_convert *convert, void *ctx, bool *kept, struct eco_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	struct reading r = { .areas = areas, .wkb = { .bytes = wkb, .size = size }, .convert = convert,
		.ctx = ctx, .kept = true, .error = error ? error : &own };
	struct eco_area area = { .edge_first = areas->edge_count };
	enum eco_code code = ECO_OK;

	for (int pass = 0; pass < 2 && !code && r.kept; pass++) {
		r.wkb.at = 0;
		r.surfaces = pass == 0;
		code = take_geometry(&r, 0);
		if (pass == 0)
			area.ring_edges = areas->edge_count - area.edge_first;
	}
	area.edge_count = areas->edge_count - area.edge_first;
	*kept = code == ECO_OK && r.kept && area.edge_count > 0;
	if (!*kept) {
		areas->edge_count = area.edge_first;
		return code;
	}
	eco_grow(&areas->items, &areas->capacity, areas->count, sizeof *areas->items);
	measure(areas, &area);
	areas->items[areas->count++] = area;
	return ECO_OK;
}

/* ---- Surfaces ---- */

static uint32_t strip_of(const struct eco_strips *s, double y)
{
	double at = (y - s->low) / (s->high - s->low) * s->count;
	return !(at > 0) ? 0 : at >= s->count ? s->count - 1 : (uint32_t)at;
}

/* As many bands as a quarter of the items, or fewer where these are so long that each would be in more than LINKS_EACH. */
static uint32_t strips_for(const struct eco_strips *s, uint32_t items,
	void (*range)(const void *ctx, uint32_t item, double y[2]), const void *ctx)
{
	double height = 0, most = fmin(items / 4 + 1, STRIPS_MAX);
	for (uint32_t i = 0; i < items; i++) {
		double y[2];
		range(ctx, i, y);
		height += y[0] <= y[1] ? y[1] - y[0] : 0;
	}
	return (uint32_t)fmax(1, height > 0 ? fmin(most, LINKS_EACH * items * ((s->high - s->low) / height)) : most);
}

/* Puts each item into every band of its range of y; an empty range: none. */
static enum eco_code fill_strips(struct eco_strips *s, uint32_t items,
	void (*range)(const void *ctx, uint32_t item, double y[2]), const void *ctx, struct eco_error *error)
{
	uint64_t total = 0;
	s->count = strips_for(s, items, range, ctx);
	s->first = eco_alloc((size_t)s->count + 2, sizeof *s->first);
	for (int pass = 0; pass < 2; pass++) {
		for (uint32_t i = 0; i < items; i++) {
			double y[2];
			range(ctx, i, y);
			uint32_t strip = strip_of(s, y[0]), end = y[0] <= y[1] ? strip_of(s, y[1]) + 1
				: strip;
			total += pass == 0 ? end - strip : 0;
			for (; strip < end; strip++) {
				if (pass == 0)
					s->first[strip + 2]++;
				else
					s->member[s->first[strip + 1]++] = i;
			}
			if (total > LINKS_MAX)
				return eco_fail(error, ECO_TOO_LARGE, "an area with too many long edges");
		}
		for (uint32_t k = 0; pass == 0 && k < s->count; k++)
			s->first[k + 2] += s->first[k + 1];
		if (pass == 0)
			s->member = eco_alloc(total + 1, sizeof *s->member);
	}
	return ECO_OK;
}

static void edge_range(const void *edges, uint32_t edge, double y[2])
{
	const struct eco_edge *e = (const struct eco_edge *)edges + edge;
	y[0] = fmin(e->a[1], e->b[1]);
	y[1] = fmax(e->a[1], e->b[1]);
}

static void area_range(const void *areas, uint32_t area, double y[2])
{
	const struct eco_area *a = (const struct eco_area *)areas + area;
	y[0] = a->ring_edges > 0 ? a->low[1] : INFINITY;
	y[1] = a->high[1];
}

/* Whether a ray from (x, y) towards greater x crosses the edge. */
static bool crosses(const struct eco_edge *e, double x, double y)
{
	return (e->a[1] > y) != (e->b[1] > y)
		&& x < e->a[0] + (y - e->a[1]) / (e->b[1] - e->a[1]) * (e->b[0] - e->a[0]);
}

bool eco_area_holds(const struct eco_areas *areas, uint32_t index, double x, double y)
{
	const struct eco_area *area = &areas->items[index];
	const struct eco_edge *edges = areas->edges + area->edge_first;
	bool inside = false;
	if (area->ring_edges == 0 || x < area->low[0] || x > area->high[0] || y < area->low[1]
			|| y > area->high[1])
		return false;
	uint32_t s = strip_of(&area->strips, y);
	for (uint32_t i = area->strips.first[s]; i < area->strips.first[s + 1]; i++)
		if (crosses(&edges[area->strips.member[i]], x, y))
			inside = !inside;
	return inside;
}

bool eco_area_span(const struct eco_areas *areas, uint32_t index, double low_y, double high_y, double span[2])
{
	const struct eco_area *area = &areas->items[index];
	const struct eco_edge *edges = areas->edges + area->edge_first;
	span[0] = INFINITY;
	span[1] = -INFINITY;
	if (area->ring_edges == 0 || high_y < area->low[1] || low_y > area->high[1])
		return false;
	const struct eco_strips *s = &area->strips;
	for (uint32_t i = s->first[strip_of(s, low_y)]; i < s->first[strip_of(s, high_y) + 1]; i++) {
		const struct eco_edge *e = &edges[s->member[i]];
		double rise = e->b[1] - e->a[1], run = e->b[0] - e->a[0];
		double from = rise != 0 ? (low_y - e->a[1]) / rise : 0,
			to = rise != 0 ? (high_y - e->a[1]) / rise : 1;
		double first = fmax(fmin(from, to), 0), last = fmin(fmax(from, to), 1);
		if (first > last)
			continue;
		span[0] = fmin(span[0], e->a[0] + fmin(first * run, last * run));
		span[1] = fmax(span[1], e->a[0] + fmax(first * run, last * run));
	}
	return span[0] <= span[1];
}

/* By the even-odd rule orientation does not matter: a ring is a hole if it lies within an odd number of
 * the others, which one of its points shows. */
static bool ring_is_hole(const struct eco_areas *areas, const struct eco_area *area, uint32_t first,
	uint32_t end)
{
	const struct eco_edge *edges = areas->edges + area->edge_first;
	double x = (edges[first].a[0] + edges[first].b[0]) / 2,
		y = (edges[first].a[1] + edges[first].b[1]) / 2;
	const struct eco_strips *s = &area->strips;
	bool inside = false;
	for (uint32_t k = strip_of(s, y), i = s->first[k]; i < s->first[k + 1]; i++)
		if ((s->member[i] < first || s->member[i] >= end) && crosses(&edges[s->member[i]], x, y))
			inside = !inside;
	return inside;
}

static double surface_of(const struct eco_areas *areas, const struct eco_area *area)
{
	const struct eco_edge *e = areas->edges + area->edge_first;
	double sum = 0;
	for (uint32_t first = 0, end; first < area->ring_edges; first = end) {
		const double *o = e[first].a;
		double twice = 0;
		for (end = first;
				end == first
				|| (end < area->ring_edges
				&& (e[end - 1].b[0] != o[0] || e[end - 1].b[1] != o[1])); end++)
			twice += (e[end].a[0] - o[0]) * (e[end].b[1] - o[1])
				- (e[end].b[0] - o[0]) * (e[end].a[1] - o[1]);
		sum += (ring_is_hole(areas, area, first, end) ? -0.5 : 0.5) * fabs(twice);
	}
	return fmax(sum, 0);
}

/* ---- Many surfaces ---- */

static void near_range(const void *areas, uint32_t edge, double y[2])
{
	const struct eco_areas *s = areas;
	edge_range(s->edges, edge, y);
	y[0] -= s->near_m;
	y[1] += s->near_m;
}

static enum eco_code index_areas(struct eco_areas *areas, struct eco_error *error)
{
	areas->strips.low = INFINITY;
	areas->strips.high = -INFINITY;
	for (uint32_t i = 0; i < areas->count; i++) {
		areas->strips.low = fmin(areas->strips.low, areas->items[i].low[1]);
		areas->strips.high = fmax(areas->strips.high, areas->items[i].high[1]);
	}
	areas->near.low = areas->strips.low - areas->near_m;
	areas->near.high = areas->strips.high + areas->near_m;
	enum eco_code code = fill_strips(&areas->strips, areas->count, area_range, areas->items, error);
	return code || !(areas->near_m > 0) ? code
		: fill_strips(&areas->near, areas->edge_count, near_range, areas, error);
}

bool eco_areas_hold(const struct eco_areas *areas, double x, double y)
{
	const struct eco_strips *s = &areas->strips;
	if (areas->count == 0)
		return false;
	for (uint32_t k = strip_of(s, y), i = s->first[k]; i < s->first[k + 1]; i++)
		if (eco_area_holds(areas, s->member[i], x, y))
			return true;
	return false;
}

/* ---- Nearness ---- */

static double square_to(const struct eco_edge *e, double x, double y)
{
	double dx = e->b[0] - e->a[0], dy = e->b[1] - e->a[1], length = dx * dx + dy * dy;
	double t = length > 0 ? ((x - e->a[0]) * dx + (y - e->a[1]) * dy) / length : 0;
	t = t < 0 ? 0 : t > 1 ? 1 : t;
	dx = e->a[0] + t * dx - x;
	dy = e->a[1] + t * dy - y;
	return dx * dx + dy * dy;
}

bool eco_areas_near(const struct eco_areas *areas, double x, double y)
{
	const struct eco_strips *s = &areas->near;
	if (!s->first)
		return false;
	for (uint32_t k = strip_of(s, y), i = s->first[k]; i < s->first[k + 1]; i++)
		if (square_to(&areas->edges[s->member[i]], x, y) < areas->near_m * areas->near_m)
			return true;
	return false;
}

/* Parts an edge from a box by its own direction; the axes' are looked at before. */
static bool passes_by(const struct eco_edge *e, const double low[2], const double high[2], double near_m)
{
	double dx = e->b[0] - e->a[0], dy = e->b[1] - e->a[1], x = (low[0] + high[0]) / 2 - e->a[0],
	       y = (low[1] + high[1]) / 2 - e->a[1];
	return fabs(x * dy - y * dx) > (fabs(dy) * (high[0] - low[0]) + fabs(dx) * (high[1] - low[1])) / 2 + near_m * sqrt(dx * dx + dy * dy);
}

bool eco_areas_near_box(const struct eco_areas *areas, const double low[2], const double high[2])
{
	const struct eco_strips *s = &areas->near;
	const double m = areas->near_m;
	if (!s->first || high[1] < s->low || low[1] > s->high)
		return false;
	for (uint32_t i = s->first[strip_of(s, low[1])]; i < s->first[strip_of(s, high[1]) + 1]; i++) {
		const struct eco_edge *e = &areas->edges[s->member[i]];
		bool apart = false;
		for (int k = 0; k < 2; k++)
			apart |= fmin(e->a[k], e->b[k]) - m > high[k] || fmax(e->a[k], e->b[k]) + m < low[k];
		if (!apart && !passes_by(e, low, high, m))
			return true;
	}
	return false;
}

enum eco_code eco_areas_index(struct eco_areas *areas, double near_m, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	areas->near_m = near_m;
	for (uint32_t i = 0; i < areas->count && code == ECO_OK; i++) {
		struct eco_area *area = &areas->items[i];
		area->strips.low = area->low[1];
		area->strips.high = area->high[1];
		code = fill_strips(&area->strips, area->ring_edges, edge_range,
			areas->edges + area->edge_first, error);
		area->size_m2 = code ? 0 : surface_of(areas, area);
	}
	if (code == ECO_OK && areas->count > 0)
		code = index_areas(areas, error);
	return code;
}

void eco_areas_free(struct eco_areas *areas)
{
	for (uint32_t i = 0; i < areas->count; i++) {
		free(areas->items[i].strips.first);
		free(areas->items[i].strips.member);
	}
	eco_free(areas->strips.first, areas->strips.member, areas->items, areas->edges, areas->near.first,
		areas->near.member);
	*areas = (struct eco_areas){ .items = NULL };
}

/* ---- Rows as areas ---- */

#define DISTANCE_MAX_M 1e7           /* as for inventories */

struct row_reading {
	struct eco_areas *areas;
	const struct eco_areas_request *request;
	struct eco_areas_report *report;
	struct eco_rows *rows;
	struct eco_crs *crs;
	struct eco_crs_span span;
	uint32_t column[ECO_AREAS_COLUMNS], filter_column[ECO_FILTERS_MAX];
	bool converted, near;        /* of this feature, so far */
};

static bool convert(void *ctx, double xy[2], struct eco_error *error)
{
	struct row_reading *r = ctx;
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

static void skip(struct row_reading *r, enum eco_area_why why)
{
	if (r->request->surfaces && r->report->skipped[why]++ == 0)
		r->report->first_line[why] = r->rows->line;
}

static bool passes(const struct row_reading *r)
{
	for (uint32_t i = 0; i < r->request->filter_count; i++)
		if (!eco_filter_passes(&r->request->filters[i], r->rows->fields[r->filter_column[i]], '.'))
			return false;
	return true;
}

/* Words and numbers of the area added last. */
static bool take_texts(const struct row_reading *r)
{
	const char *texts[ECO_AREAS_COLUMNS] = { NULL };
	for (uint32_t i = 0; i < r->request->column_count; i++)
		texts[i] = r->column[i] == ECO_NONE ? NULL : r->rows->fields[r->column[i]];
	return !r->request->take || r->request->take(r->request->ctx, r->areas->count - 1, r->rows, texts);
}

static enum eco_code take_row(struct row_reading *r, struct eco_error *error)
{
	const struct eco_rows_place *place = &r->rows->place;
	struct eco_areas *areas = r->areas;
	bool kept;
	r->report->features += r->request->surfaces;
	if (!passes(r))
		return skip(r, ECO_AREA_FILTERED), ECO_OK;
	if (place->kind != ECO_PLACE_AREA)
		return skip(r, ECO_AREA_NO_GEOMETRY), ECO_OK;
	r->converted = r->near = true;
	ECO_PASS(eco_areas_add_wkb(areas, place->wkb, place->wkb_bytes, convert, r, &kept, error));
	if (!kept)
		return skip(r, !r->converted ? ECO_AREA_NO_CONVERSION : r->near ? ECO_AREA_NO_GEOMETRY
			: ECO_AREA_TOO_FAR), ECO_OK;
	bool surface = !r->request->surfaces || r->request->lines || areas->items[areas->count - 1].ring_edges > 0;
	if (!surface || !take_texts(r)) {
		areas->edge_count = areas->items[--areas->count].edge_first;
		skip(r, surface ? ECO_AREA_NO_NUMBER : ECO_AREA_NOT_A_SURFACE);
	}
	return ECO_OK;
}

static enum eco_code read_rows(struct row_reading *r, struct eco_error *error)
{
	const struct eco_areas_request *q = r->request;
	enum eco_code code = ECO_OK;
	bool more = true;
	for (uint32_t i = 0; i < q->column_count && code == ECO_OK; i++)
		code = eco_rows_find_column(r->rows, q->path, q->columns[i], &r->column[i], error);
	for (uint32_t i = 0; i < q->filter_count && code == ECO_OK; i++)
		code = eco_rows_find_column(r->rows, q->path, q->filters[i].column, &r->filter_column[i], error);
	while (code == ECO_OK && more) {
		code = r->rows->next(r->rows, &more, error);
		if (code == ECO_OK && more)
			code = take_row(r, error);
	}
	return code;
}

enum eco_code eco_areas_read(struct eco_areas *areas, const struct eco_areas_request *request,
	const struct eco_frame *frame, struct eco_areas_report *report, struct eco_error *error)
{
	struct row_reading r = { .areas = areas, .request = request, .report = report };
	struct eco_rows_source source = { .path = request->path, .layer = request->layer, .areas = true };
	enum eco_crs_fit fit;
	char area[80];
	enum eco_code code = eco_rows_open(&r.rows, &source, error);
	if (!code)
		code = eco_crs_open(&r.crs, &(struct eco_crs_request){ .path = request->path, .stated = request->crs,
			.of_file = r.rows->crs, .frame = frame, .note = eco_rows_note, .ctx = r.rows }, error);
	if (code == ECO_OK && r.rows->degrees_doubted && !request->crs)
		code = eco_fail(error, ECO_BAD_INPUT, "%.200s: its numbers cannot be degrees, as its format "
			"says; add \"%s\": \"EPSG:...\", the CRS that they are in", request->path,
			request->surfaces ? "crs" : "clear_crs");
	if (!code)
		code = read_rows(&r, error);
	if (!code)
		code = eco_crs_refuse_degrees(&r.span, request->crs ? request->crs : r.rows->crs, false, request->path,
			&fit, area, error);
	if (!code && fit == ECO_CRS_SWAPPED)
		eco_rows_note(r.rows,
			"its corners lie outside the area of use of their CRS (%s), and inside with their coordinates "
			"swapped: x is easting or longitude, y is northing or latitude",
			area);
	if (!code)
		code = eco_areas_index(areas, fmax(request->near_m, areas->near_m), error);
	for (uint32_t i = 0; r.rows && i < r.rows->note_count && report->note_count < 2 * ECO_ROWS_NOTES_MAX; i++)
		report->notes[report->note_count++] = eco_copy_text(r.rows->notes[i]);
	eco_crs_close(r.crs);
	eco_rows_close(r.rows);
	return code;
}

void eco_areas_report_say(const struct eco_areas_report *report, void (*say)(void *ctx, const char *text), void *ctx)
{
	static const char *const why[ECO_AREA_WHY_COUNT] = { [ECO_AREA_NOT_A_SURFACE] = "not a polygon",
		[ECO_AREA_NO_GEOMETRY] = "no geometry",
		[ECO_AREA_NO_CONVERSION] = "cannot be converted to the scene's CRS",
		[ECO_AREA_TOO_FAR] = "more than 10,000 km from the origin",
		[ECO_AREA_NO_NUMBER] = "no usable number in its column",
		[ECO_AREA_FILTERED] = "left out by only or skip" };
	char line[512];
	for (int i = 0; i < ECO_AREA_WHY_COUNT; i++)
		if (report->skipped[i] > 0) {
			snprintf(line, sizeof line, "  %llu feature%s left out: %s (first: feature %llu)",
				(unsigned long long)report->skipped[i], report->skipped[i] == 1 ? "" : "s",
				i == ECO_AREA_NO_NUMBER && report->refused ? report->refused : why[i],
				(unsigned long long)report->first_line[i]);
			say(ctx, line);
		}
}

void eco_areas_report_free(struct eco_areas_report *report)
{
	for (uint32_t i = 0; i < report->note_count; i++)
		free(report->notes[i]);
	*report = (struct eco_areas_report){ .features = 0 };
}

/* ---- Input of a scatter ---- */

/* Keeps the number of an area. */
static bool take_number(void *ctx, uint32_t area, const struct eco_rows *rows, const char *const *texts)
{
	struct eco_scatter_input *input = ctx;
	double number = 0;
	(void)rows;
	if (texts[0] && (!eco_text_number(texts[0], '.', &number) || !(number >= 0)))
		return false;
	input->number = eco_realloc(input->number, area + 1u, sizeof *input->number);
	input->number[area] = number;
	return true;
}

enum eco_code eco_scatter_read(struct eco_scatter_input *input, const struct eco_scatter_spec *spec,
	const struct eco_frame *frame, struct eco_error *error)
{
	struct eco_error own = { .code = ECO_OK };
	const char *number = spec->density_column ? spec->density_column : spec->count_column;
	const struct eco_areas_request areas = { .path = spec->path, .layer = spec->layer, .crs = spec->crs,
		.filters = spec->filters, .filter_count = spec->filter_count, .columns = &number, .column_count = 1,
		.take = take_number, .ctx = input, .surfaces = true, .lines = spec->spacing_m > 0 },
		clear = { .path = spec->clear_of, .layer = spec->clear_layer, .crs = spec->clear_crs, .near_m = spec->clear_m };
	enum eco_code code = eco_areas_read(&input->areas, &areas, frame, &input->report, &own);
	if (code)
		return eco_fail(error, code, "%s%s", own.text, code == ECO_BAD_INPUT && input->report.features == 0
			? "; a raster of densities becomes polygons by gdal_polygonize.py, with \"density_column\"" : "");
	return spec->clear_of ? eco_areas_read(&input->clear, &clear, frame, &input->report, error) : ECO_OK;
}

void eco_scatter_input_free(struct eco_scatter_input *input)
{
	eco_areas_free(&input->areas);
	eco_areas_free(&input->clear);
	free(input->number);
	eco_areas_report_free(&input->report);
}
