/* Billboard clouds of plants (Kratt, Coconu, Dapper, Schliep, Paar, Deussen 2014: Adaptive Billboard Clouds
 * for Botanical Tree Models). A baseline of ecobench.
 *
 *   plant = lod_billboard_plant_make(&model, &arena)         once a plant: its skeleton and density
 *   lod_billboard_cloud_make(&cloud, plant, cap, &arena)     once a cap: no prefix of another cap's
 *   lod_billboard_cloud_draw(&cloud, owner, &raster)
 *
 * The plant becomes a tree of nodes, found from the mesh alone (3.1; billboard_skeleton.c). A part is a piece
 * of that tree, and stands as the billboards of one generator (3.3; billboard_fit.c). Parts are kept, split
 * and merged by their error (3.2, 3.4; billboard_parts.c) and their billboards get textures
 * (billboard_cloud.c).
 *
 *   valid      a face is valid if each corner lies within epsilon of its nearest billboard
 *   coverage   C = max(0, sum of valid faces' projected areas - sum of invalid ones'), projected on the
 *              billboard that is nearest to the face
 *   sigma      1 where nothing is dense, 0 at the greatest density: mean over the part. The print has d_min,
 *              which is 0 and would make sigma 0 everywhere
 *   error      sigma (1 - C / area of the faces). The print has quality = sigma C, which would replace
 *              hidden parts last and not, as the text says, first
 *
 * The print gives no sizes: BILLBOARD_ constants and the files' own say ours, in shares
 * of the plant's height. Both planes of a cross show the whole part; of planes and strips the one nearest to
 * a face shows it. Only + - * / sqrt and comparisons decide: every machine makes the same cloud. */
#pragma once

#include "lod/arena.h"
#include "ecofiles/base/order.h"
#include "lod/build/weld.h"
#include "lod/sort.h"

struct lod_raster;

enum lod_billboard_form { LOD_BILLBOARD_CROSS, LOD_BILLBOARD_PLANE, LOD_BILLBOARD_STRIP,
	LOD_BILLBOARD_FORMS };

struct lod_billboard {
	struct lod_v3 center, u, v;  /* metres; u, v: half edges, at right angles */
	struct eco_image image;      /* row 0 at center - v, column 0 at center - u; alpha is 0 or 255 */
	uint8_t rgb[3];              /* mean of the opaque texels */
};

struct lod_billboard_cloud {
	struct lod_billboard *items; uint32_t count;
	uint32_t parts, forms[LOD_BILLBOARD_FORMS];      /* parts of each form */
	double error;                /* mean over the area of all faces */
	double invalid;              /* share of the faces' area that no billboard holds within epsilon */
	double epsilon;              /* share of the height */
	uint64_t texels;             /* of the textures */
};

struct lod_billboard_plant;
/* The model may be without triangles; it must outlive the plant. */
struct lod_billboard_plant *lod_billboard_plant_make(const struct eco_model *model, struct lod_arena *arena);
/* At most `cap` billboards, within the least epsilon of a ladder that leaves a mean error of at most .5.
 * Faces that no billboard holds within epsilon are drawn like the others: the paper does not say what becomes
 * of them. */
void lod_billboard_cloud_make(struct lod_billboard_cloud *cloud, const struct lod_billboard_plant *plant,
	uint32_t cap, struct lod_arena *arena);

/* Two triangles a billboard; items are numbered as in the cloud. */
void lod_billboard_cloud_draw(const struct lod_billboard_cloud *cloud, uint64_t owner,
	struct lod_raster *raster);

/* ---- The steps and what they hand on: lengths are shares of the plant's height, around its middle ---- */

#define BILLBOARD_QUADS 4u           /* of a part; sections of a strip before some are merged */
#define BILLBOARD_TOLERANCE 0.001    /* a part's error that is accepted */

/* ---- Cells of space, numbered in 20 bits ---- */

static inline uint64_t billboard_cell(struct lod_v3 p, double side, int dx, int dy, int dz)
{
	const double at[3] = { floor(p.x / side) + dx, floor(p.y / side) + dy, floor(p.z / side) + dz };
	uint64_t key = 0;
	for (int k = 0; k < 3; k++)
		key = key << 21 | (uint64_t)(at[k] + 1048576.0);
	return key;
}
/* The first item whose key is not less. */
static inline uint32_t billboard_find(const struct lod_keyed *items, uint32_t count, uint64_t key)
{
	uint32_t low = 0;
	ECO_LEAST(low, count, i, items[i].key >= key)
	return low;
}

/* ---- The skeleton (billboard_skeleton.c) ---- */

struct billboard_face { struct lod_v3 corner[3], normal; double area; uint32_t triangle; };

/* A binary tree: nodes of more than two children have others without faces below them. In preorder, so that
 * what hangs on node i is [i, end[i]). */
struct billboard_tree {
	uint32_t count, *parent, *end;
	uint32_t *face_first;        /* node i has faces [face_first[i], face_first[i + 1]) */
	struct lod_v3 *connector, *center;
	double *area, *sigma;        /* of the node's own faces; center and sigma mean nothing without */
	uint32_t face_count;
	struct billboard_face *faces;
};
/* All but sigma. */
void billboard_tree_make(struct billboard_tree *tree, const struct lod_mesh *mesh, struct lod_arena *arena);

struct lod_billboard_plant {
	const struct eco_model *model;
	const uint8_t (*rgb)[3];     /* per triangle of the model */
	struct lod_mesh mesh;
	struct billboard_tree tree;
	struct lod_v3 middle;        /* metres */
	double unit;                 /* metres: the height */
};

/* ---- Generators and how well they stand for faces (billboard_fit.c) ---- */

/* Half edges are unit u and v times width and height. */
struct billboard_quad { struct lod_v3 center, u, v, normal; double width, height; };

struct billboard_fit_input {
	const struct billboard_face *const *faces;
	uint32_t count;              /* at least 1 */
	struct lod_v3 connector;
	uint32_t most;               /* quads of a strip after merging */
	double epsilon;
};
/* Returns how many quads were written, at most BILLBOARD_QUADS. */
uint32_t billboard_fit(struct billboard_quad *quads, enum lod_billboard_form form,
	const struct billboard_fit_input *input);

/* Whether the face is valid; its nearest quad, and its area projected on that. */
bool billboard_face_judge(const struct billboard_face *face, const struct billboard_quad *quads,
	uint32_t count, double epsilon, uint32_t *nearest, double *projected);
/* 1 - C / area of the faces, in [0, 1]. */
double billboard_uncovered(const struct billboard_fit_input *input, const struct billboard_quad *quads,
	uint32_t count);

/* ---- Parts (billboard_parts.c) ---- */

struct billboard_fit {               /* one generator's billboards for a part */
	uint8_t form;
	uint32_t quad_count;
	struct billboard_quad quads[BILLBOARD_QUADS];
	double area, sigma, error;
};

/* All that hangs on a node of the tree, but for parts that begin farther out. */
struct billboard_part {
	uint32_t root;
	bool kept;                   /* no better by splitting */
	struct billboard_fit fit;
	/* by how much the sum of errors grows, less price, when it is joined with the part that bears it;
	 * known while neither has changed */
	double merge_cost, merge_error;
	bool merge_known;
};

struct billboard_work {              /* of one cloud */
	struct lod_arena *arena;
	const struct lod_billboard_plant *plant;
	uint32_t cap;
	double epsilon, price;       /* price: what a billboard more must lower the sum of errors by */
	struct billboard_part *parts;
	uint32_t part_count, quad_count;
	uint32_t *begins;            /* per node of the tree: the part that begins there, or ECO_NONE */
	uint32_t *roots, root_count; /* of the first parts */
	const struct billboard_face **faces;         /* scratch: of one part */
	double *sum;                 /* scratch, per node */
};
void billboard_work_open(struct billboard_work *work, const struct lod_billboard_plant *plant,
	uint32_t cap, struct lod_arena *arena);
/* The faces of what begins at `root` into work->faces, at most `most` evenly chosen; returns how many. */
uint32_t billboard_part_faces(struct billboard_work *work, uint32_t root, uint32_t most);
/* Parts from the tips towards the trunk, keep, merge and split until cap and tolerance hold; from scratch. */
void billboard_parts_settle(struct billboard_work *work, double epsilon);
/* Mean error over the area of all faces. */
double billboard_parts_error(const struct billboard_work *work);
