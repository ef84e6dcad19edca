/* Textures of the quads that leaf collapse makes (section 3.3 of the paper, figure 2): an atlas of alpha
 * textures, and the tile of each quad.
 *
 *   first level   quads of two original leaves. The commonest pairs of distance and relative orientation
 *                 get a tile each, that shows two leaves so
 *   below         quads by how many leaves they stand for and how much of them is leaf: the commonest
 *                 densities of each class of counts get a tile each, that shows leaves strewn at that density
 *
 * A tile's leaves are all of one shape, that of a leaf of the tree, and as large as makes the opaque share of
 * the tile the mean density of its quads: the area of the foliage stays. A quad gets the nearest tile. */
#ifndef TESTS_BENCH_BASELINE_LEAF_COLLAPSE_ATLAS_H
#define TESTS_BENCH_BASELINE_LEAF_COLLAPSE_ATLAS_H

#include <stdbool.h>

#include "ecofiles/format/model.h"
#include "tests/bench/baseline/leaf_collapse.h"

#define LOD_COLLAPSE_PAIR_TILES 8u       /* of 128 x 128 texels */
#define LOD_COLLAPSE_CLASSES 4u          /* 3 to 4, 5 to 8, 9 to 32 and more leaves */
#define LOD_COLLAPSE_DENSITIES 8u        /* tiles of 64 x 64 texels in each */
#define LOD_COLLAPSE_TILES (LOD_COLLAPSE_PAIR_TILES + LOD_COLLAPSE_CLASSES * LOD_COLLAPSE_DENSITIES)

/* A leaf's silhouette in the rectangle along its longest extent. */
#define LOD_COLLAPSE_SHAPE 64u
struct lod_collapse_shape {
	bool opaque[LOD_COLLAPSE_SHAPE][LOD_COLLAPSE_SHAPE];
	double wide;                 /* the rectangle's width over its length */
};
/* From a fan of corners; `cutout` and uv may be NULL. */
void lod_collapse_shape_make(struct lod_collapse_shape *shape, const float (*corner)[3],
	const float (*uv)[2], uint32_t corners, const struct eco_image *cutout);

struct lod_collapse_tile {
	uint32_t x, y, side;         /* in texels; side 0: no quad has it */
	uint32_t quads;
	double density;              /* wanted: mean of its quads, at most 1 */
	double distance, turn;       /* first level: over the leaves' lengths; radians */
};

struct lod_collapse_atlas {
	struct eco_image image;      /* of the arena; alpha is 0 or 255 */
	struct lod_collapse_tile tile[LOD_COLLAPSE_TILES];
	uint8_t **of;                /* per forest and quad: its tile */
};
/* `count` forests of one tree share it. rgb: of the leaves. */
void lod_collapse_atlas_make(struct lod_collapse_atlas *atlas, const struct lod_collapse *forests,
	uint32_t count, const struct lod_collapse_shape *shape, const uint8_t rgb[3],
	struct lod_arena *arena);

/* Texture coordinates of a quad's corners, in the order of lod_collapse_corners. */
void lod_collapse_atlas_uv(const struct lod_collapse_atlas *atlas, uint32_t tile, float uv[4][2]);
/* The share of a tile that is opaque. */
double lod_collapse_atlas_share(const struct lod_collapse_atlas *atlas, uint32_t tile);

#endif
