/* From the integers of a list to geometry. The rasteriser that measures curves and the client that draws
 * share this code, so that the picture that was measured is the one that is seen. */
#pragma once

#include <stdbool.h>

#include "ecofiles/format/chunk/chunk.h"

/* A list's primitives in object space; what a list has none of is NULL. */
struct lod_geometry {
	float *position;             /* 3 a vertex: 9 a triangle, 6 a line, 3 a point */
	float *uv;                   /* 2 a vertex */
	float *width;                /* of lines */
	float *size;                 /* eco_size of points with SIZE */
	float *half, *opacity;       /* of splats: 3 half axes (9), metres; of them and points that are not opaque: 1 */
	float *wood;                 /* of splats: 1, or 0 */
	int32_t *color;              /* palette index of a primitive, or -1 */
};

/* Room for `count` primitives, in memory of its own; false without memory. uv: also for those of triangles.
 */
bool lod_geometry_make(struct lod_geometry *geometry, const struct eco_list *list, uint32_t count, bool uv);
void lod_geometry_free(struct lod_geometry *geometry);
/* The same without `color`, in lod_geometry_floats floats of the caller. */
size_t lod_geometry_floats(const struct eco_list *list, uint32_t count, bool uv);
void lod_geometry_lay(struct lod_geometry *geometry, const struct eco_list *list, uint32_t count, bool uv,
	float *floats);
/* The part of a geometry that begins at a primitive. */
struct lod_geometry lod_geometry_from(const struct lod_geometry *geometry, const struct eco_list *list,
	uint32_t first);

/* Writes the geometry of primitives [first, end) of a decoded list: fans become triangles, elements are
 * scaled by an area factor about their centre (edges by sqrt(eco_growth(code, scale)), or by sqrt(scale)
 * without GROWTH). If buffers are NULL nothing is written, but for `position`. Returns the number of
 * primitives. */
uint32_t lod_list_geometry(const struct eco_list *list, const struct eco_elements *elements, uint32_t first,
	uint32_t end, float scale, const struct lod_geometry *out);
