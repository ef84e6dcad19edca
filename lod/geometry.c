#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/splat.h"
#include "lod/geometry.h"

struct target { const struct eco_list *list; const struct eco_elements *elements;
	const struct lod_geometry *out;
	double edge; };

static double edge_of(float area_factor)
{
	return area_factor == 1 ? 1 : sqrt((double)area_factor);
}

/* Value of an attribute that an element has at most once, or `without`. */
static uint32_t extra_of(const struct eco_list *list, const int32_t *extra, enum eco_attr attribute,
	uint32_t without)
{
	return list->attributes & attribute && extra ? (uint32_t)extra[eco_list_extra_at(list, attribute)]
		: without;
}

static double metres(const struct eco_list *list, int axis, int32_t value)
{
	return list->grid_origin[axis] + value * list->grid_step[axis];
}

/* A corner, moved away from the element's centre (the mean of its corners) by the factor of edges. */
static void put_corner(const struct target *t, float *to, const int32_t *corner, const double center[3])
{
	for (int a = 0; a < 3; a++) {
		double p = metres(t->list, a, corner[a]);
		to[a] = (float)(t->edge == 1 ? p : center[a] + t->edge * (p - center[a]));
	}
}

static void find_center(const struct target *t, const int32_t *position, uint32_t corners, double center[3])
{
	for (int a = 0; a < 3; a++) {
		int64_t sum = 0;
		for (uint32_t i = 0; i < corners; i++)
			sum += position[3 * i + a];
		center[a] = t->list->grid_origin[a] + (double)sum / corners * t->list->grid_step[a];
	}
}

static void put_triangle(const struct target *t, uint32_t written, const int32_t *position, const int32_t *uv,
	uint32_t triangle, const double center[3])
{
	const uint32_t corner[3] = { 0, triangle + 1, triangle + 2 };
	for (uint32_t k = 0; k < 3; k++) {
		put_corner(t, t->out->position + 9 * (size_t)written + 3 * k, position + 3 * corner[k],
			center);
		for (uint32_t a = 0; a < 2 && t->out->uv; a++)
			t->out->uv[6 * (size_t)written + 2 * k + a] = uv
				? (float)uv[2 * corner[k] + a] / ECO_UV_ONE : 0;
	}
}

static void put_line(const struct target *t, uint32_t written, const int32_t *position, const int32_t *extra,
	const double center[3])
{
	for (uint32_t k = 0; k < 2; k++)
		put_corner(t, t->out->position + 6 * (size_t)written + 3 * k, position + 3 * k, center);
	if (!t->out->width)
		return;
	double width = (int32_t)extra_of(t->list, extra, ECO_ATTR_WIDTH, 0) * t->list->grid_step[0];
	t->out->width[written] = (float)(width * t->edge);
}

static void put_splat(const struct target *t, uint32_t written, const int32_t *extra)
{
	struct eco_splat splat;
	if (!t->out->half || !(t->list->attributes & ECO_ATTR_SPLAT) || !extra)
		return;
	eco_splat_read(&splat, extra + eco_list_extra_at(t->list, ECO_ATTR_SPLAT),
		sqrtf(t->list->unit_area) * (float)t->edge);
	memcpy(t->out->half + 9 * (size_t)written, splat.half, sizeof splat.half);
	t->out->opacity[written] = splat.opacity;
	t->out->wood[written] = splat.wood;
}

/* Takes the next `each` floats a primitive. */
static float *lay(float **floats, uint32_t count, uint32_t each)
{
	float *at = *floats;
	*floats += (size_t)each * count;
	return each ? at : NULL;
}

void lod_geometry_lay(struct lod_geometry *geometry, const struct eco_list *list, uint32_t count, bool uv,
	float *floats)
{
	bool splats = list->attributes & ECO_ATTR_SPLAT;
	uint32_t vertices = eco_list_vertices(list);
	geometry->position = lay(&floats, count, 3 * vertices);
	geometry->uv = lay(&floats, count, uv ? 2 * vertices : 0);
	geometry->width = lay(&floats, count, list->kind == ECO_LIST_LINES);
	geometry->size = lay(&floats, count, (list->attributes & ECO_ATTR_SIZE) != 0);
	geometry->half = lay(&floats, count, splats ? 9 : 0);
	geometry->opacity = lay(&floats, count, splats || eco_list_opacity(list) < 1);
	geometry->wood = lay(&floats, count, splats);
}

size_t lod_geometry_floats(const struct eco_list *list, uint32_t count, bool uv)
{
	uint32_t vertices = eco_list_vertices(list), each = 3 * vertices + (uv ? 2 * vertices : 0)
		+ (list->kind == ECO_LIST_LINES) + ((list->attributes & ECO_ATTR_SIZE) != 0)
		+ (list->attributes & ECO_ATTR_SPLAT ? 11 : eco_list_opacity(list) < 1);
	return (size_t)each * count;
}

bool lod_geometry_make(struct lod_geometry *geometry, const struct eco_list *list, uint32_t count, bool uv)
{
	float *floats = malloc(lod_geometry_floats(list, count, uv) * sizeof *floats + 1);
	*geometry = (struct lod_geometry){ .color = malloc(count * sizeof *geometry->color + 1) };
	if (floats)
		lod_geometry_lay(geometry, list, count, uv, floats);
	if (floats && geometry->color)
		return true;
	free(floats);
	free(geometry->color);
	*geometry = (struct lod_geometry){ .color = NULL };
	return false;
}

void lod_geometry_free(struct lod_geometry *geometry)
{
	free(geometry->position);
	free(geometry->color);
	*geometry = (struct lod_geometry){ .color = NULL };
}

/* `each` values further on. */
static float *further(float *at, size_t first, uint32_t each) { return at ? at + first * each : NULL; }

struct lod_geometry lod_geometry_from(const struct lod_geometry *geometry, const struct eco_list *list,
	uint32_t first)
{
	uint32_t vertices = eco_list_vertices(list);
	return (struct lod_geometry){ .position = further(geometry->position, first, 3 * vertices),
		.uv = further(geometry->uv, first, 2 * vertices), .width = further(geometry->width, first, 1),
		.size = further(geometry->size, first, 1), .half = further(geometry->half, first, 9),
		.opacity = further(geometry->opacity, first, 1), .wood = further(geometry->wood, first, 1),
		.color = geometry->color ? geometry->color + first : NULL };
}

uint32_t lod_list_geometry(const struct eco_list *list, const struct eco_elements *elements, uint32_t first,
	uint32_t end, float scale, const struct lod_geometry *out)
{
	struct target t = { list, elements, out, edge_of(scale) };
	bool growth = list->attributes & ECO_ATTR_GROWTH;
	uint32_t primitive = 0, written = 0;
	size_t corner = 0;
	assert(first <= end && end <= elements->primitive_count);
	for (uint32_t e = 0; e < elements->element_count && primitive < end; e++) {
		uint32_t corners = elements->corners[e], count = corners < 3 ? 1 : corners - 2;
		const int32_t *position = elements->position + 3 * corner,
			*uv = elements->uv ? elements->uv + 2 * corner : NULL;
		const int32_t *extra = elements->extra ? elements->extra + (size_t)elements->extra_count * e
			: NULL;
		double center[3] = { 0, 0, 0 };
		if (growth)
			t.edge =
				edge_of(eco_growth(extra_of(list, extra, ECO_ATTR_GROWTH, ECO_GROWTH_PLAIN),
				scale));
		if (primitive + count > first && corners > 1 && t.edge != 1)
			find_center(&t, position, corners, center);
		for (uint32_t i = 0; i < count; i++, primitive++) {
			if (primitive < first || primitive >= end)
				continue;
			if (corners == 1) {
				put_corner(&(struct target){ list, elements, out, 1 },
					out->position + 3 * (size_t)written, position, center);
				if (out->opacity)
					out->opacity[written] = eco_list_opacity(list);
				put_splat(&t, written, extra);
			} else if (corners == 2)
				put_line(&t, written, position, extra, center);
			else
				put_triangle(&t, written, position, uv, i, center);
			if (out->size)
				out->size[written] =
					eco_size(extra_of(list, extra, ECO_ATTR_SIZE, ECO_SIZE_ONE));
			if (out->color)
				out->color[written] = list->attributes & ECO_ATTR_COLOR && extra ? extra[0]
					: -1;
			written++;
		}
		corner += corners;
	}
	return written;
}
