/* Wood of a plant's cells, drawn as lines in some cells and as levels of triangles in others: how much of the
 * wood that full detail shows at a pixel or more of width is there?
 *
 * Twelve directions: N, NE, ... NW from 10 degrees above the horizon, N, E, S and W from 45 degrees; 512 pixels
 * around the plant, drawn at twice that. A pixel is covered if wood is drawn within one pixel of it. A cell
 * without lines has none in the state of lines. */
#ifndef TESTS_WOOD_COVER_H
#define TESTS_WOOD_COVER_H

#include "lod/build/plant.h"

#define WOOD_DIRECTIONS 12u
#define WOOD_STATES 4u           /* of a cell: lines, levels from coarse to fine */

struct wood_cover {
	uint32_t cells;              /* that have wood */
	/* Shares of the wide wood covered, means over the directions: all cells in one state; the least of
	 * the mixes. */
	double same[WOOD_STATES], mixed;
	/* The greatest share, in one direction, that each of the states covers and a mix does not. */
	double hole;
	/* The greatest share of a level's edges in one cell that have one triangle, though full detail has no
	 * such edge at their ends. */
	double torn;
};

/* `mixes`: pictures whose cells have a state each, by chance. */
enum eco_code wood_cover_measure(struct wood_cover *cover, const struct lod_plant *plant,
	const struct eco_model *model, uint32_t mixes, struct eco_error *error);

#endif
