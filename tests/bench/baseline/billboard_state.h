/* Inside billboard clouds: the steps and what they hand on. billboard_cloud.h has the contract.
 *
 * All lengths here are shares of the plant's height, around its middle. A plant that is lower than a
 * twentieth of its diagonal is measured by its diagonal. */
#ifndef TESTS_BENCH_BASELINE_BILLBOARD_STATE_H
#define TESTS_BENCH_BASELINE_BILLBOARD_STATE_H

#include "lod/arena.h"
#include "lod/build/weld.h"
#include "lod/heap.h"
#include "tests/bench/baseline/billboard_cloud.h"

#define BILLBOARD_QUADS 8u           /* of a part */

/* The heap has room for another item. */
static inline void billboard_heap_push(struct lod_heap_item *heap, uint32_t *count, double key, uint32_t id)
{
	uint32_t at = (*count)++;
	heap[at] = (struct lod_heap_item){ key, id };
	for (; at > 0 && lod_heap_before(heap[at], heap[(at - 1) / 2]); at = (at - 1) / 2) {
		struct lod_heap_item item = heap[at];
		heap[at] = heap[(at - 1) / 2];
		heap[(at - 1) / 2] = item;
	}
}
static inline uint32_t billboard_heap_pop(struct lod_heap_item *heap, uint32_t *count)
{
	uint32_t id = heap[0].id;
	heap[0] = heap[--*count];
	lod_heap_sift(heap, *count, 0);
	return id;
}

/* ---- The skeleton ---- */

/* How a component hangs on the one that bears it: a corner (3 * triangle + k) of each. ECO_NONE: a root. */
struct billboard_link { uint32_t parent, own; };
/* Fills `order` with all components, each after the one that bears it, and a link for each. */
void billboard_attach(const struct lod_mesh *mesh, struct billboard_link *link, uint32_t *order,
	struct lod_arena *arena);

struct billboard_nodes {
	uint32_t count;
	uint32_t *parent;            /* smaller than the node's own number; ECO_NONE for node 0 */
	struct lod_v3 *connector;    /* where it meets its parent */
	uint32_t *of;                /* per triangle */
};
/* Components longer than `length` become chains of nodes of that length along the surface, which fork where
 * the surface forks; all others are one node each. */
void billboard_nodes_make(struct billboard_nodes *nodes, const struct lod_mesh *mesh, double length,
	struct lod_arena *arena);

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
void billboard_tree_make(struct billboard_tree *tree, const struct billboard_nodes *nodes,
	const struct lod_mesh *mesh, struct lod_arena *arena);

struct lod_billboard_plant {
	struct lod_arena arena;
	const struct eco_model *model;
	struct eco_model scaled;     /* the same in shares of its height; owns nothing */
	struct lod_mesh mesh;
	struct billboard_tree tree;
	struct lod_v3 middle;        /* metres */
	double unit;                 /* metres: the height */
};

/* ---- Quality ---- */

/* Half edges are unit u and v times width and height. */
struct billboard_quad { struct lod_v3 center, u, v, normal; double width, height; };

/* From a point to the rectangle. */
double billboard_quad_distance(const struct billboard_quad *quad, struct lod_v3 point);

struct billboard_validity {
	bool valid;
	uint32_t nearest;            /* quad */
	double projected;            /* area on it */
};
void billboard_face_judge(struct billboard_validity *result, const struct billboard_face *face,
	const struct billboard_quad *quads, uint32_t count, double epsilon);

struct billboard_coverage { double valid, invalid, area, area_invalid; };
static inline double billboard_coverage_value(const struct billboard_coverage *c)
{
	double value = c->valid - c->invalid;
	return value > 0 ? value : 0;
}
void billboard_coverage_of(struct billboard_coverage *sum, const struct billboard_face *const *faces,
	uint32_t face_count, const struct billboard_quad *quads, uint32_t count, double epsilon);
/* sigma (1 - C / area); 0 without area */
double billboard_error(const struct billboard_coverage *coverage, double sigma);

/* The sum over all other generators of (1 - (d / radius)^2)^2 within `radius`, at each of them. */
void billboard_density(double *density, const struct lod_v3 *generators, uint32_t count, double radius,
	struct lod_arena *arena);
/* 1 for density <= 0, 0 from `most` on, linear between; 1 if most is not above 0. */
double billboard_sigma(double density, double most);

/* ---- Generators ---- */

struct billboard_fit_input {
	const struct billboard_face *const *faces;
	uint32_t count;              /* at least 1 */
	struct lod_v3 connector;
	uint32_t sections, most;     /* of a strip: before and after merging */
	double bend;                 /* root mean square distance up to which sections merge */
};
/* Eigenvectors of a symmetric matrix (xx, yy, zz, xy, xz, yz) by Jacobi's rotations, the greatest value
 * first: orthonormal for any finite input. */
void billboard_jacobi(const double matrix[6], struct lod_v3 axes[3], double values[3]);
/* The mean of the vectors from the connector to all corners, of length 1; the widest axis where it is 0. */
struct lod_v3 billboard_axis(const struct billboard_fit_input *input);
/* Returns how many quads were written, at most BILLBOARD_QUADS. */
uint32_t billboard_fit(struct billboard_quad *quads, enum lod_billboard_form form,
	const struct billboard_fit_input *input);

/* ---- Parts ---- */

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
	struct lod_billboard_options options;
	double epsilon, price;       /* price: what a billboard more must lower the sum of errors by */
	struct billboard_part *parts;
	uint32_t part_count, quad_count;
	uint32_t *begins;            /* per node of the tree: the part that begins there, or ECO_NONE */
	const struct billboard_face **faces;         /* scratch: of one part */
	double *sum;                 /* scratch, per node */
	uint32_t splits, merges;
};
/* All options are set but for epsilon. */
void billboard_work_open(struct billboard_work *work, const struct lod_billboard_plant *plant,
	const struct lod_billboard_options *options, struct lod_arena *arena);
/* The faces of what begins at `root` into work->faces, at most `most` evenly chosen; returns how many. */
uint32_t billboard_part_faces(struct billboard_work *work, uint32_t root, uint32_t most);
/* Parts from the tips towards the trunk, keep, merge and split until cap and tolerance hold; from scratch. */
void billboard_parts_settle(struct billboard_work *work, double epsilon);
/* Mean error over the area of all faces. */
double billboard_parts_error(const struct billboard_work *work);

/* ---- Textures ---- */

/* Textures for the cloud's billboards from `first` on, which are the part's; adds the area of faces that none
 * of them holds to *invalid. */
enum eco_code billboard_bake(struct lod_billboard_cloud *cloud, uint32_t first, struct billboard_work *work,
	const struct billboard_part *part, double *invalid, struct eco_error *error);

#endif
