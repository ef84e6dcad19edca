/* The ground at matching detail: a quadtree of square tiles (ecofiles/format/ground_tile.h), and the tiles
 * that a view needs.
 *
 *   lod_ground_select(&choice, scene, &eye, &limits, &error);         per request: tiles that cover the view
 *   lod_ground_seams(seams, tiles, count);                            per picture: levels of their neighbours
 *   lod_ground_corner(&c, &r, seam, &x, &y);                          the sample that a corner is drawn at
 *
 * A tile's error is the largest vertical distance of its triangles from full detail. It is replaced by its
 * children while that may show as more than the tolerance. Beside a coarser tile a border is drawn at the
 * samples that both have, so there are neither gaps nor skirts. */
#pragma once

#include "ecofiles/format/ground_tile.h"
#include "lod/eye.h"

/* ---- Choosing ---- */

#define LOD_GROUND_TILES_MAX 4096u       /* of a plan */

struct lod_ground_limits {
	double tolerance_px;
	uint32_t tiles_max; /* 0: LOD_GROUND_TILES_MAX. The largest error on the screen is refined first; tiles
			     * that touch others too far apart in level are split, even so */
};

struct lod_ground_choice {               /* free tiles */
	uint32_t *tiles; uint32_t count;     /* of scene->ground, ascending; NULL if no ground is in view */
	double error_px; /* the largest that may show: above the tolerance only at the bound on tiles */
};

/* Depends on nothing but scene, view and limits. */
enum eco_code lod_ground_select(struct lod_ground_choice *choice, const struct eco_scene *scene,
	const struct lod_eye *eye, const struct lod_ground_limits *limits, struct eco_error *error);

/* Does a box reach into the view pyramid? May say yes just outside its edges. The least depth that a visible
 * point of it can have; 0 or less where the eye may be within. */
bool lod_box_seen(const struct lod_eye *eye, const double low[3], const double high[3]);
double lod_box_depth(const struct lod_eye *eye, const double low[3], const double high[3]);
/* Sets low[2] and high[2] to bounds of the ground between low and high; the scene has ground. */
void lod_ground_heights(const struct eco_scene *scene, double low[3], double high[3]);

/* ---- Drawing ---- */

enum { LOD_GROUND_WEST, LOD_GROUND_EAST, LOD_GROUND_SOUTH, LOD_GROUND_NORTH };

/* For each side, the number of levels by which the tile beyond it is coarser; 0 if it is not, or if there is
 * none. */
struct lod_ground_seam { uint8_t coarser[4]; };

/* The tiles do not overlap; any order. False without memory. */
bool lod_ground_seams(struct lod_ground_seam *seams, const struct eco_ground_tile *tiles, uint32_t count);

/* Moves column c < x->inner and row r < y->inner (a tile without its ring) to the sample at which they are
 * drawn. */
void lod_ground_corner(uint32_t *c, uint32_t *r, const struct lod_ground_seam *seam,
	const struct eco_ground_span *x, const struct eco_ground_span *y);
