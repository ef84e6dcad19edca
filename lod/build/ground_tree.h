/* The ground as a quadtree of square tiles with their errors, from which lod/ground_choice.h chooses.
 *
 *   lod_ground_build(&tree, &ground, step_m, least_m, &error);        once per scene
 *   lod_ground_elements(&elements, &ground, &tree.tiles[i], ...);     the samples of a tile, for its list */
#pragma once

#include "ecofiles/format/ground_tile.h"
#include "ecofiles/format/heights.h"
#include "lod/build/ground_tree.h"

/* `list` is left 0. shifts: per tile, how many low bits of its inner heights are rounded away: a sixteenth of
 * its error at most. */
struct lod_ground_tree { struct eco_ground_tile *tiles; uint8_t *shifts; uint32_t count; };
void lod_ground_tree_free(struct lod_ground_tree *tree);

/* Heights are whole steps of step_m. A tile with an error of at most `least_m` gets no children, unless its
 * level is above ECO_GROUND_APART_MAX. At most ECO_GROUND_SIDE_MAX samples a side. */
enum eco_code lod_ground_build(struct lod_ground_tree *tree, const struct eco_ground *ground, double step_m,
	double least_m, struct eco_error *error);

/* The tile's samples with heights as whole steps above low_m: exact at its border, inside without the low
 * `shift` bits. */
void lod_ground_elements(struct eco_elements *elements, const struct eco_ground *ground,
	const struct eco_ground_tile *tile, uint8_t shift, double low_m, double step_m);
