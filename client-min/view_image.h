/* The image on the ground as a plan shows it: a colour for each place.
 *
 * Whoever lights a picture asks for the colour under a pixel; nothing that draws the ground's triangles knows
 * of it. Tiles do not overlap (ecofiles/format/ground_image.h), and levels that are held are mip levels. A
 * texel beside a tile's border is mixed with that of the next tile, whatever its level. */
#ifndef VIEW_IMAGE_H
#define VIEW_IMAGE_H

#include "client-min/view_store.h"

struct view_image_tile {
	const struct view_list *list;
	uint32_t levels;                 /* of its parts, that are shown */
	uint32_t size;                   /* in view_image.sizes */
	int64_t column, row;             /* in tiles of its size, from the origin */
};

#define VIEW_IMAGE_SIZES 24u
struct view_image {                      /* zero is none */
	struct view_image_tile *tiles; uint32_t count;   /* by size, row, column */
	double origin[2];                /* south-west corner of one of the largest tiles */
	/* widths of texels of their last levels, descending; the first tile of each */
	double texel_m[VIEW_IMAGE_SIZES]; uint32_t first[VIEW_IMAGE_SIZES + 1], size_count;
};

/* The tiles that the store's plan shows. ECO_DAMAGED where they are no quadtree. */
enum eco_code view_image_make(struct view_image *image, const struct view_store *store,
	struct eco_error *error);
void view_image_free(struct view_image *image);

/* What a pixel shows: its middle, and half its extents along and across where it is longest, metres. */
struct view_image_spot { double at[2], along[2], across_m; };
/* Light (0 to 1) of red, green and blue, and how much of the ground it covers. *texel_m: the width of the
 * texels there, or nothing where none are. Threads may ask at a time; `near` is a thread's own: where to look
 * first, 0 at the beginning. */
struct view_image_color { float light[3], alpha; };
struct view_image_color view_image_at(const struct view_image *image, const struct view_image_spot *spot,
	uint32_t *near, double *texel_m);

#endif
