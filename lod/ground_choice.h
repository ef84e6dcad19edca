/* The ground at matching detail: a quadtree of square tiles (ecofiles/format/pack.h), and which of them a view needs.
 *
 *   lod_ground_select(&choice, scene, &eye, &limits, &error);         per request: which tiles cover what is in view
 *   lod_ground_seams(seams, tiles, count);                            per picture: who their neighbours are
 *   lod_ground_corner(&c, &r, seam, &x, &y);                          which sample a corner of a cell is drawn at
 *
 * A tile's error is the largest vertical distance between its triangles and those of the full detail, measured at every sample, not
 * estimated. Inside its border it is stored as exactly as that deserves; at the border exactly, as others share that. A tile is
 * replaced by its children while its error may show as more than the tolerance. Seams: a tile that touches a coarser one draws the
 * samples of that border at the nearest sample that the other has too. Both then draw the very same vertices there, so that there
 * is neither a gap nor a skirt to hide one, whatever the levels are. Next to such a border the error is up to the neighbour's.
 *
 * ECO_GROUND_PX, the tolerance: plants stand on the full detail, so that a stem is off the ground drawn by up to so much. Measured
 * from eye level to 900 m above on fractal ground of 1025 x 1025 samples, rougher than any real one, against its full detail: at
 * 1 pixel Q differs by less than 0.0004, at 4 by up to 0.0015, at 16 by 0.002; from 4 on hillsides lose their relief. */
#ifndef LOD_GROUND_CHOICE_H
#define LOD_GROUND_CHOICE_H

#include "ecofiles/format/ground_tile.h"
#include "lod/eye.h"

/* ---- Choosing ---- */

#define LOD_GROUND_TILES_MAX 4096u       /* of a plan */

struct lod_ground_limits {
	double tolerance_px;
	uint32_t tiles_max;          /* 0: LOD_GROUND_TILES_MAX. What shows most is refined first */
};

struct lod_ground_choice {               /* free tiles */
	uint32_t *tiles; uint32_t count;     /* of scene->ground, ascending; none where no ground is in view */
	double error_px;             /* the largest that may show: above the tolerance only at the bound on tiles */
};

/* Depends on nothing but scene, view and limits: no history. */
enum eco_code lod_ground_select(struct lod_ground_choice *choice, const struct eco_scene *scene, const struct lod_eye *eye,
	const struct lod_ground_limits *limits, struct eco_error *error);

/* ---- Drawing ---- */

enum { LOD_GROUND_WEST, LOD_GROUND_EAST, LOD_GROUND_SOUTH, LOD_GROUND_NORTH };

/* Per side, by how many levels the tile drawn beyond it is coarser; 0 where it is not, or where there is none. */
struct lod_ground_seam { uint8_t coarser[4]; };

/* Tiles that do not overlap, in any order. False without memory. */
bool lod_ground_seams(struct lod_ground_seam *seams, const struct eco_ground_tile *tiles, uint32_t count);

/* Column c < x->inner and row r < y->inner of a tile without its ring become those at which they are drawn. */
void lod_ground_corner(uint32_t *c, uint32_t *r, const struct lod_ground_seam *seam, const struct eco_ground_span *x,
	const struct eco_ground_span *y);

#endif
