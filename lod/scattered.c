#include "lod/scattered.h"

#include <math.h>

#include "lod/hash.h"
#include "lod/vector.h"

/* An offset is a sum of two numbers of 0 to 31: most parts lie near the point. */
void lod_scattered_offset(float offset[3], uint32_t point, uint32_t part)
{
	uint32_t hash;
	LOD_HASH_SCATTER;
	for (int k = 0; k < 3; k++, hash >>= 10)
		offset[k] = (float)((int)(hash & 31) + (int)(hash >> 5 & 31) - 31) / 32;
}

double lod_ball_radius(const struct eco_list *list, float scale)
{
	return sqrt((double)list->unit_area * scale / LOD_PI);
}

void lod_scatter(struct lod_geometry *geometry, uint32_t count, uint32_t first, unsigned halvings,
	double radius)
{
	float reach = (float)radius;
	for (uint32_t i = count; halvings && i-- > 0;) {     /* from the end: parts lie behind their point */
		const float *p = geometry->position + 3 * (size_t)i, at[3] = { p[0], p[1], p[2] };
		int32_t color = geometry->color ? geometry->color[i] : -1;
		for (uint32_t part = 0; part < 1u << halvings; part++) {
			size_t to = ((size_t)i << halvings) + part;
			float offset[3];
			lod_scattered_offset(offset, first + i, part);
			for (int k = 0; k < 3; k++)
				geometry->position[3 * to + (size_t)k] = at[k] + reach * offset[k];
			if (geometry->color)
				geometry->color[to] = color;
		}
	}
}
