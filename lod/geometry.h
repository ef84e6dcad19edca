/* From the integers of a list to geometry. The rasteriser that measures curves and the client that draws
 * share this code, so that the picture that was measured is the one that is seen. */
#ifndef LOD_GEOMETRY_H
#define LOD_GEOMETRY_H

#include "ecofiles/format/chunk.h"

/* Object-space geometry of primitives [first, end) of a decoded list: fans become triangles, elements are
 * scaled by an area factor about their centre (edges by sqrt(eco_growth(code, scale)), or by sqrt(scale)
 * without GROWTH). The caller's buffers: 9 floats a triangle, 6 a line (and one width), 3 a point. uv (6 a
 * triangle), `size` (one eco_size a point, 1 without SIZE) and `color` (a palette index a primitive) may be
 * NULL. Returns the number of primitives written. */
struct lod_geometry { float *position, *uv, *width; int32_t *color; float *size; };
uint32_t lod_list_geometry(const struct eco_list *list, const struct eco_elements *elements, uint32_t first,
	uint32_t end, float scale, struct lod_geometry *out);

#endif
