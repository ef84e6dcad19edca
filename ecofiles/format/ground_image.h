/* The picture on the ground (an orthophoto, or colours of classes of land cover) as a quadtree of tiles.
 *
 * A tile is a square of ECO_GROUND_IMAGE_SIDE texels a side, rows from the north, and a list of kind
 * GROUND_IMAGE: its levels are those of a texture (texture.h), smallest first, each half as wide as the next.
 * A coarse prefix is therefore a mip level, and what came for a distant view is filtered with in a near one. A
 * tile's children are its quarters, each with as many texels, half as wide.
 *
 * The list's grid says where it lies: grid_origin is the south-west corner of the tile (scene space, z 0),
 * grid_step the width of a texel of the last level. A cut says how many levels of a tile are shown. The tiles
 * of a plan do not overlap. Where there are none, and where texels are clear, the ground has its plain
 * colour. Towards its border the image fades: levels with texels that are not opaque have alpha. */
#ifndef ECO_GROUND_IMAGE_H
#define ECO_GROUND_IMAGE_H

#include "ecofiles/format/pack.h"

#define ECO_GROUND_IMAGE_SIDE 256u
#define ECO_GROUND_IMAGE_LEVELS 4u       /* 32, 64, 128 and 256 texels a side */

/* Turns the record of a tile into that of one of its quarters, 0 to 3: south-west, south-east, north-west,
 * north-east. */
void eco_ground_image_quarter(struct eco_list *list, uint32_t quarter);

/* Side of a tile, metres; of a texel of its first `levels` levels, 1..ECO_GROUND_IMAGE_LEVELS. */
static inline double eco_ground_image_side_m(const struct eco_list *list)
{
	return ECO_GROUND_IMAGE_SIDE * list->grid_step[0];
}
static inline double eco_ground_image_texel_m(const struct eco_list *list, uint32_t levels)
{
	return list->grid_step[0] * (1u << (ECO_GROUND_IMAGE_LEVELS - levels));
}

#endif
