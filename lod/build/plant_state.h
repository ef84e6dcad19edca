/* The state between stages of lod_plant_build. Private to plant.c, plant_leaves.c and plant_wood.c. */
#pragma once

#include <setjmp.h>

#include "lod/build/draft.h"
#include "lod/build/foliage.h"

/* Cells of a complex plant (cell.c): an octree of at most two levels over its triangles (Deussen 2002, 6.1),
 * so a leaf of it is a set of the 64 octants of octants. A leaf with next to nothing in it joins the nearest
 * one. */
#define LOD_CELLS_MAX 64u

struct lod_cells {
	uint32_t count;              /* 0: the plant is not divided */
	struct lod_v3 low, size;     /* of the box */
	uint8_t map[LOD_CELLS_MAX];  /* octant of octant (x, y, z in [0,4)) -> cell */
};

struct lod_cells_input {
	struct lod_v3 low, high;
	uint32_t count;
	const struct lod_v3 *center; /* of units that stay together */
	const uint32_t *triangles;   /* of each unit */
	uint32_t limit;              /* a node is split above this many triangles */
};

void lod_cells_make(struct lod_cells *cells, const struct lod_cells_input *input);

/* The cell of a point: less than cells->count. A point outside the box belongs to the nearest octant. */
uint32_t lod_cells_at(const struct lod_cells *cells, struct lod_v3 point);

/* A group: elements, or wood, of one organ, texture and importance that a rule gives. Its members share
 * ladders. */
struct lod_group {
	uint8_t organ;
	uint8_t rule;                /* its number in the model's importances */
	uint32_t image, model_image; /* of the plant and of the model, or ECO_NONE */
	uint32_t first, end;         /* leaves: in build.order */
	bool blades;                 /* leaves: lines beside points */
	uint32_t cover;              /* leaves: eco_list.cover of their points */
	double area;                 /* leaves */
	float importance;
};

struct lod_build {
	struct lod_arena arena;
	struct lod_plant *plant;
	const struct eco_model *model;
	const struct lod_plant_options *options;
	struct eco_error *error;
	enum eco_code code;          /* of a stage that was stopped, and jumped to `stopped` */
	jmp_buf stopped;
	struct lod_mesh mesh;
	struct lod_organs organs;
	struct lod_elements elements;
	struct lod_bones bones, parts;       /* of the plant; those of its cells (lod_wood_split) */
	struct lod_cells cells;
	struct lod_palette palette;
	struct lod_draft draft;
	/* Cells of wood's triangles; other triangles are in the cells of their elements. 0 without cells. */
	uint32_t *cell_of_triangle;
	uint32_t group_count;
	struct lod_group *groups;
	uint32_t *group_of_component;        /* wood's */
	bool *cut;                   /* per component: of several cells */
	int32_t *limb;               /* per bone, ascending; of a plant without cells */

	/* leaves, per element */
	struct lod_v3 *center;
	double *area;
	uint32_t *order;             /* by group, in each the most valuable first */
	uint8_t *growth;             /* growth codes and simple triangles of the greedy order, else NULL */
	struct lod_simple *simple;
	struct lod_line *blade;      /* for groups of blades */
	double *blade_error;
	struct lod_point *point;
};

bool lod_build_whole(const struct lod_component *component); /* whether wood goes to one cell as a whole */
/* 0 without cells. */
uint32_t lod_build_cell(const struct lod_build *build, struct lod_v3 point);
struct eco_ladder *lod_build_ladder(struct lod_build *build, const struct lod_group *group, uint32_t anchor,
	uint8_t flags);

/* Centres, areas, blades' lines, points. Groups must be known. */
void lod_leaves_measure(struct lod_build *build);
void lod_leaves_order(struct lod_build *build);
void lod_leaves_represent(struct lod_build *build);

/* Lines of cells: each is the part of a bone that a cell's triangles lie along, so that a cell's lines,
 * levels and triangles show the same wood, whatever its neighbours draw. */
void lod_wood_split(struct lod_build *build);

/* Whole-plant ladders, then those of cells. */
void lod_leaves_ladders(struct lod_build *build, const struct lod_group *group, bool cells);
void lod_wood_ladders(struct lod_build *build, const struct lod_group *group, bool cells);
