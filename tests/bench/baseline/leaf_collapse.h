/* Leaf collapse (Hidalgo, Abad, Camahort, "Simplification for Efficient Rendering of Tree Foliage", 2007):
 * the two leaves whose cost is least become one quad, again and again. A baseline of ecobench.
 *
 *   lod_collapse_make(&forest, 1, &foliage, NULL, &arena);
 *   level = &forest.level[i];
 *   draw forest.place[0 .. level->a) and forest.place[level->b .. level->b + level->c)
 *
 * One array of places holds all levels: the original leaves in [0, leaves), the quads that collapses made in
 * [leaves, leaves + made). A level is two runs of it. The next finer level puts the children of one quad in
 * its place: of the quad that was placed first, not of the one that costs most. Else the quads that are left
 * would not be one run (section 4 of the paper, figure 4).
 *
 * Cost terms are in [0, 1] each, and a cost is their weighted sum (section 3.1):
 *
 *   distance      of the centres, over the greatest one allowed
 *   angle         between the planes, over 90 degrees: a leaf has no back
 *   leaves        |m - n| / (m + n) for leaves that stand for m and n of the original ones
 *   area          |A - B| / (A + B)
 *   interiority   from the point between the centres to the tree's axis, over the crown's radius: inner
 *                 leaves collapse first
 *
 * The paper prints no weights and no cut-offs: lod_collapse_defaults says those that did best on generated
 * plants. The paper leaves two cases open. Normals that oppose each other are turned to one side first. Where
 * the projected centres coincide, the main axis is that of the larger leaf. */
#pragma once

#include "ecofiles/format/list.h"
#include "ecofiles/format/model.h"
#include "lod/arena.h"
#include "lod/build/order/footprint.h"
#include "lod/vector.h"

enum lod_collapse_term { LOD_COLLAPSE_DISTANCE, LOD_COLLAPSE_ANGLE, LOD_COLLAPSE_LEAVES, LOD_COLLAPSE_AREA,
	LOD_COLLAPSE_INTERIORITY, LOD_COLLAPSE_TERMS };

struct lod_collapse_options {
	double weight[LOD_COLLAPSE_TERMS];
	double distance_most;        /* cut-off, over the radius of a ball around the crown; > 0 */
	double angle_most_rad;       /* cut-off, at most pi / 2 */
};
extern const struct lod_collapse_options lod_collapse_defaults;

struct lod_collapse_node {
	struct lod_v3 center, normal;        /* unit, or 0 for a leaf without area */
	double area;                 /* of the polygon */
	uint32_t represents, parent; /* leaves; a node, or ECO_NONE */
	/* Half of the main axis and of the other; a quad's corners are center +- half[0] +- half[1]. */
	struct lod_v3 half[2];
	double opaque_area;          /* the sum of all leaves that it stands for */
	uint32_t child[2];           /* nodes, or ECO_NONE */
	uint8_t tile;                /* of a quad, by lod_collapse_atlas_make */
};

struct lod_collapse_level { uint32_t a, b, c; };

struct lod_collapse {                /* a binary forest; arrays of an arena */
	uint32_t leaves, made;       /* originals; quads, in the order of their collapses */
	const uint32_t *leaf;        /* node i < leaves is that leaf of the input */
	struct lod_collapse_node *node;      /* leaves + made */
	uint32_t *place;                     /* leaves + made nodes, in the order of the vertex array */
	struct lod_collapse_level *level;    /* made + 1, the coarsest first: level i has roots + i leaves */
	uint32_t roots;
};

/* Sectors (section 4.1) have a forest each. Sector 0 holds the innermost leaves, the others are wedges around
 * the axis, that of z. All have as many leaves, within one: so wedges are narrow where the foliage is dense.
 * One sector has the leaves in their order. Costs and cut-offs are over the whole crown. Only first, corner
 * and area of the foliage are read; area NULL: all is opaque. options NULL: lod_collapse_defaults. */
void lod_collapse_make(struct lod_collapse *forests, uint32_t sectors, const struct lod_foliage *leaves,
	const struct lod_collapse_options *options, struct lod_arena *arena);

/* The corners of a node, in turn around it: 4 for a quad. Returns how many. leaves NULL: of a quad. */
uint32_t lod_collapse_corners(const struct lod_collapse *forest, const struct lod_foliage *leaves,
	uint32_t node, struct lod_v3 corner[ECO_CORNERS_MAX]);

/* A leaf, a fan of corners, as a node that is opaque all over. */
void lod_collapse_node_of(struct lod_collapse_node *node, const float (*corner)[3], uint32_t corners);

/* ---- Textures (section 3.3, figure 2; leaf_collapse_atlas.c) ----
 *
 *   first level   quads of two original leaves. The commonest pairs of distance and relative orientation
 *                 get a tile each, that shows two leaves so
 *   below         quads by how many leaves they stand for and how much of them is leaf: the commonest
 *                 densities of each class of counts get a tile each, that shows leaves strewn at that density
 *
 * A tile's leaves are all of one shape, that of a leaf of the tree, and as large as makes the opaque share of
 * the tile the mean density of its quads: the area of the foliage stays. A quad gets the nearest tile. */

#define LOD_COLLAPSE_CLASSES 5u          /* 2, 3 to 4, 5 to 8, 9 to 32 and more leaves */
#define LOD_COLLAPSE_CLASS_TILES 8u      /* of 128 x 128 texels in the first class, 64 x 64 in the others */
#define LOD_COLLAPSE_TILES (LOD_COLLAPSE_CLASSES * LOD_COLLAPSE_CLASS_TILES)

struct lod_collapse_tile {
	uint32_t x, y, side;         /* in texels; side 0: no quad has it */
	double density;              /* wanted: mean of its quads, at most 1 */
	double distance, turn;       /* first level: over the leaves' lengths; radians */
};
struct lod_collapse_atlas {
	struct eco_image image;      /* of the arena; alpha is 0 or 255 */
	struct lod_collapse_tile tile[LOD_COLLAPSE_TILES];       /* class by class */
};
/* The forests of one tree share it. shape: a leaf of the tree; rgb: of the leaves. Sets the quads' tiles. */
void lod_collapse_atlas_make(struct lod_collapse_atlas *atlas, const struct lod_collapse *forests,
	uint32_t sectors, const struct lod_fan *shape, const uint8_t rgb[3], struct lod_arena *arena);

/* Texture coordinates of a quad's corners, in the order of lod_collapse_corners. */
void lod_collapse_atlas_uv(const struct lod_collapse_atlas *atlas, uint32_t tile, float uv[4][2]);
