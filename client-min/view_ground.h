/* The ground of a plan: its tiles, who their neighbours are, and how their samples become places near the
 * eye.
 *
 * All tiles share one grid of samples. A sample is drawn at (whole number - `anchor`) * `step` from the world
 * position `at`, the sample nearest to the eye: exact where it matters, and the same floats for a sample that
 * two tiles share, so that between them there is no gap of even one pixel. */
#pragma once

#include "client-min/view_store.h"
#include "lod/ground_choice.h"

struct view_ground_tile {
	const struct view_list *list;
	struct eco_ground_span x, y;
	struct lod_ground_seam seam;
};

struct view_ground {                     /* zero is none */
	struct view_ground_tile *tiles; uint32_t count;
	int32_t anchor[3];
	double at[3];
	float step[3];
	double origin[3];                /* of the grid */
};

/* The tiles that the store's plan draws. ECO_DAMAGED where their grids differ. */
enum eco_code view_ground_make(struct view_ground *ground, const struct view_store *store,
	const struct lod_eye *eye, struct eco_error *error);
void view_ground_free(struct view_ground *ground);

/* Index, in its list, of the sample drawn at a corner: column < x.inner, row < y.inner. */
uint32_t view_ground_sample(const struct view_ground_tile *tile, uint32_t column, uint32_t row);

/* A sample's drawn position, from ground->at: in single floats, as OpenGL has them. */
void view_ground_place(const struct view_ground *ground, const struct view_ground_tile *tile, uint32_t sample,
	float out[3]);
/* A cell is two triangles, their diagonal from south-west to north-east: columns and rows of their corners.
 * */
extern const uint32_t view_ground_corners[6][2];
/* Number of a tile's triangles. `out`, unless NULL: their corners as view_ground_place, 9 floats each. */
uint32_t view_ground_triangles(const struct view_ground *ground, const struct view_ground_tile *tile,
	float *out);

/* Upwards, of length 1, at a sample of a ground list: from the samples on either side, which is what a tile's
 * ring is for. */
void view_ground_normal(const struct view_list *list, uint32_t sample, float normal[3]);

/* Height of the ground that is drawn at a place, metres; false where none is drawn. Beside a coarser tile it
 * may be off by what the two differ. */
bool view_ground_height(const struct view_ground *ground, double x, double y, double *height_m);

/* ---- The image on it: a colour for each place ----
 *
 * Light asks for the colour under a pixel; nothing that draws the ground's triangles knows of it. Tiles do
 * not overlap (ecofiles/format/ground_tile.h), and levels that are held are mip levels. A texel beside a
 * tile's border is mixed with that of the next tile, whatever its level. */

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
