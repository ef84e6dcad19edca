/* Figures of a plant's own leaves that leaves drawn on splats follow (lod/leaf.h). */
#include <math.h>

#include "lod/build/splat/splat_fit.h"

/* The mean by area of the width of the square that a leaf covers as seen from all sides, half its area. */
static double width_of(const struct lod_mesh *mesh, const struct lod_organs *organs)
{
	double area = 0, square = 0;
	for (uint32_t c = 0; c < mesh->component_count; c++) {
		double own = 0;
		for (uint32_t i = mesh->member_first[c]; i < mesh->member_first[c + 1]; i++)
			own += organs->area[mesh->member[i]];
		if (organs->components[c].organ == ECO_ORGAN_WOOD)
			continue;
		area += own;
		square += own * own;
	}
	return area > 0 ? sqrt(0.5 * square / area) : 0;
}

uint8_t lod_splats_level(const struct lod_mesh *mesh, const struct lod_organs *organs)
{
	double square = 0, area = 0;
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		struct lod_v3 n = lod_mesh_area_normal(mesh, t);
		double length = lod_v3_length(n);
		if (organs->components[mesh->component[t]].organ == ECO_ORGAN_WOOD || !(length > 0))
			continue;
		square += n.z * n.z / length;
		area += length;
	}
	return area > 0 ? eco_level_code(square / area) : 0;
}

void lod_plant_set_leaves(struct eco_plant *plant, const struct lod_mesh *mesh, const struct lod_organs *organs)
{
	double width = width_of(mesh, organs) / ECO_LEAF_UNIT_M + 0.5;
	if (width >= 1)
		plant->leaf_width = (uint16_t)(width < UINT16_MAX ? width : UINT16_MAX);
}

void lod_plant_set_tone(struct eco_plant *plant, const struct lod_splats *splats)
{
	double code = splats->tone * ECO_TONE_ONE + 0.5;
	plant->leaf_tone = (uint8_t)(code < UINT8_MAX ? code : UINT8_MAX);
}
