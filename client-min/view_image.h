/* The image on the ground as a plan shows it: a colour for each place.
 *
 * Light asks for the colour under a pixel; nothing that draws the ground's triangles knows
 * of it. Tiles do not overlap (ecofiles/format/ground_tile.h), and levels that are held are mip levels. A
 * texel beside a tile's border is mixed with that of the next tile, whatever its level. */
#ifndef VIEW_IMAGE_H
#define VIEW_IMAGE_H

#include "client-min/view_store.h"
#include "ecofiles/format/ground_tile.h"

/* levels: of its parts, that are shown */
struct view_image_tile { const struct view_list *list; uint32_t levels; };

/* A quadtree: words of nodes, the first of them the root. A word is 0 where no tile lies, the number of the
 * first of its four quarters (south-west, south-east, north-west, north-east), or a leaf: VIEW_IMAGE_LEAF, a
 * tile's levels - 1 in bits 29 and 30, and its index. */
#define VIEW_IMAGE_LEAF 0x80000000u
#define VIEW_IMAGE_TILE(leaf) ((leaf) & 0x1fffffffu)
struct view_image {                      /* zero is none */
	struct view_image_tile *tiles; uint32_t count;
	uint32_t *nodes; uint32_t node_count;
	double origin[2], side_m;        /* south-west corner of the root, and its side */
};

/* The tiles that the store's plan shows. ECO_DAMAGED where they are no quadtree. */
enum eco_code view_image_make(struct view_image *image, const struct view_store *store,
	struct eco_error *error);
/* An image of these tiles, which it copies; their lists must outlive it. */
enum eco_code view_image_of(struct view_image *image, const struct view_image_tile *tiles, uint32_t count,
	struct eco_error *error);
void view_image_free(struct view_image *image);

/* The place that a pixel shows: its middle, and half its extents along and across where it is longest,
 * metres. */
struct view_image_spot { double at[2], along[2], across_m; };
/* Light (0 to 1) of red, green and blue, and how much of the ground it covers; the width of the texels there,
 * 0 where none are. Threads may ask at a time. */
struct view_image_color { float light[3], alpha, texel_m; };
struct view_image_color view_image_at(const struct view_image *image, const struct view_image_spot *spot);

#endif
