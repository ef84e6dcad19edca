/* One component of wood on the way to lines: its surface is cut into slabs along the distance from one end,
 * joints lie between slabs, and a bone leads through each slab from joint to joint (bone.h has the method).
 * Private to tube.c and bone.c. */
#pragma once

#include "lod/build/organ/organ.h"
#include "lod/vector.h"

/* Work on one component. Vertices and triangles are numbered locally. */
struct lod_tube {
	const struct lod_mesh *mesh;
	const struct lod_component *component;
	uint32_t vertex_count, triangle_count;
	uint32_t *global;            /* vertex -> of the mesh */
	uint32_t *corner;            /* 3 per triangle */
	const uint32_t *member;      /* triangle -> of the mesh */
	uint32_t *ring;              /* per vertex: the ring of border that contains it, or ECO_NONE */
	struct lod_v3 *ring_center;  /* per ring */
	double *level;               /* per vertex: distance from the lower end in slabs */
	uint32_t *offset;            /* per triangle: fragments offset[t] .. offset[t + 1), one for each slab
	                              * it reaches into */
	uint32_t *parent;            /* per fragment: union-find; the roots are pieces of slabs */
	double *area;                /* per fragment, summed into roots */
	bool closed_start;           /* distances do not start from a ring of border */
	uint32_t joint_count, bone_count;
	struct lod_joint *joints;
	struct lod_raw_bone *bones;
};

struct lod_joint {
	struct lod_v3 place;
	double ring, open; /* length of the ring (0 at an end); greater than 0 if it is a strip's (open) */
	uint32_t piece[2];           /* below and above; ECO_NONE beyond an end */
	uint32_t slab;               /* of the piece above */
	bool fixed;                  /* the centre of an open end */
	uint32_t degree, bone[2];    /* number of bones; the first two */
	uint32_t longest;            /* bone */
};

struct lod_raw_bone {
	uint32_t joint[2], piece, line;      /* line: the final line that contains it */
	uint32_t merged;             /* into this bone, or ECO_NONE */
	double area;
};

static inline struct lod_v3 lod_tube_place(const struct lod_tube *tube, uint32_t v)
{
	return lod_v3_of(tube->mesh->place + 3 * (size_t)tube->global[v]);
}

/* Component c as a graph of joints and bones. `local` has one entry per vertex of the mesh, of any value. All
 * arrays are from `arena`. */
void lod_tube_make(struct lod_tube *tube, const struct lod_mesh *mesh, const struct lod_organs *organs,
	uint32_t c, uint32_t *local, struct lod_arena *arena);

/* The piece of a slab that contains fragment f, or vertex k of triangle t: less than offset[triangle_count]. */
uint32_t lod_tube_piece(struct lod_tube *tube, uint32_t f);
uint32_t lod_tube_piece_at(struct lod_tube *tube, uint32_t t, uint32_t k);
