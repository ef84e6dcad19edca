/* Samples of a ground tile: the rule that the builder, the checks, the server and every client share.
 *
 *   eco_ground_spans(&x, &y, &tile, columns, rows);     the tile's samples along both axes
 *   eco_ground_span_at(&x, i)                           its i-th column, as a sample of the full grid
 *   eco_ground_place(sample, ...)                       where that lies, in steps of the grid (heights.h)
 *   eco_ground_tile_of(&tile, &list, &elements, ...)    the inverse: the tile of a decoded list, or an error
 *
 * Along an axis a tile of level L covers ECO_GROUND_CELLS << L samples, fewer where the grid ends. It
 * holds one sample every 2^L, and the last that it covers. On either side where the grid goes on it holds
 * one more, the ring, which is not drawn: with it the normals at the border are the same in both tiles.
 * Samples are those of the full grid, neither averaged nor moved, so tiles of any two levels agree
 * wherever both have a sample. */
#pragma once

#include <stdbool.h>

#include "ecofiles/format/heights.h"
#include "ecofiles/format/pack.h"

struct eco_ground_span {
	uint32_t low, high;          /* first and last sample covered */
	uint32_t stride;
	uint32_t inner;              /* samples held in [low, high]: at least 2 */
	uint32_t count;              /* samples held, with the ring */
	uint32_t before;             /* 1 if a sample of the ring comes first, else 0 */
	uint32_t last;               /* last sample of the grid */
};

/* Whether a scene can have such a grid: none at all, or at least two samples inside the margins. */
bool eco_ground_size_fits(uint32_t columns, uint32_t rows, uint32_t margin);

/* Requires that the tile lies on the grid (eco_ground_on_grid). */
void eco_ground_spans(struct eco_ground_span *x, struct eco_ground_span *y,
	const struct eco_ground_tile *tile, uint32_t columns, uint32_t rows);
uint32_t eco_ground_span_at(const struct eco_ground_span *span, uint32_t i);      /* i < count */

/* Whether level, column and row name a tile that covers at least one cell. */
bool eco_ground_on_grid(const struct eco_ground_tile *tile, uint32_t columns, uint32_t rows);

/* The lowest level at which one tile covers everything. */
uint8_t eco_ground_root_level(uint32_t columns, uint32_t rows);

/* Finds level, column and row of a whole decoded list; every sample must be in its place. `columns`,
 * `rows`, `margin`: of the full grid. */
enum eco_code eco_ground_tile_of(struct eco_ground_tile *tile, const struct eco_list *list,
	const struct eco_elements *elements, uint32_t columns, uint32_t rows, uint32_t margin,
	struct eco_error *error);

/* The picture on the ground (an orthophoto, or colours of classes of land cover) as a quadtree of tiles.
 *
 * A tile is a square of ECO_GROUND_IMAGE_SIDE texels a side, rows from the north, and a list of kind
 * GROUND_IMAGE: its levels are those of a texture (texture.h), smallest first, each half as wide as the next.
 * A coarse prefix is therefore a mip level, and what came for a distant view is filtered with in a near one.
 * A tile's children are its quarters, each with as many texels, half as wide.
 *
 * The list's grid says where it lies: grid_origin is the south-west corner of the tile (scene space, z 0),
 * grid_step the width of a texel of the last level. A cut says how many levels of a tile are shown. The tiles
 * of a plan do not overlap. Ground without a tile or under clear texels has its plain colour. Towards its
 * border the image fades: levels with texels that are not opaque have alpha. */

#define ECO_GROUND_IMAGE_SIDE 256u
#define ECO_GROUND_WATER 252     /* alpha of water, which clients let shine if the scene has ECO_NEED_WATER */
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
