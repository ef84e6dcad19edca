/* From the integers of a list to what is drawn. The rasteriser that measures curves and the client that draws share this, so that what was
 * measured is what is seen. */
#ifndef LOD_GEOMETRY_H
#define LOD_GEOMETRY_H

#include "ecofiles/format/chunk.h"

/* Object-space geometry of a range of a decoded list as the rasteriser and the GL client draw it: fans to triangles, elements
 * scaled by the area factor about their centre (edges by sqrt(eco_growth(their code, scale)), or sqrt(scale) without GROWTH). Buffers
 * are the caller's: 9 floats a triangle, 6 a line (and one width), 3 a point; uv (6 a triangle) may be NULL, as may `size`: one
 * eco_size a point, 1 without SIZE. Returns primitives written. Colours: palette index per primitive, or NULL. */
struct lod_geometry { float *position, *uv, *width; int32_t *color; float *size; };
uint32_t lod_list_geometry(const struct eco_list *list, const struct eco_elements *elements, uint32_t first, uint32_t end,
	float scale, struct lod_geometry *out);

#endif
