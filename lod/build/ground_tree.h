/* The ground as a quadtree of square tiles, each with its error: what lod/ground_choice.h chooses from.
 *
 *   lod_ground_build(&tree, &ground, least_m, &error);                once per scene: tiles with their errors, coarse to fine
 *   lod_ground_elements(&elements, &ground, &tree.tiles[i], ...);     the samples of one of them, for its list
 */
#ifndef LOD_GROUND_TREE_H
#define LOD_GROUND_TREE_H

#include "ecofiles/format/ground_tile.h"
#include "ecofiles/format/heights.h"
#include "lod/build/ground_tree.h"

/* `list` is left 0. Per tile, how many low bits of its heights inside its border are rounded away: a sixteenth of its error at most. */
struct lod_ground_tree { struct eco_ground_tile *tiles; uint8_t *shifts; uint32_t count; };
void lod_ground_tree_free(struct lod_ground_tree *tree);

/* Heights are whole steps of step_m. Tiles whose error is at most `least_m` get no children. At most ECO_GROUND_SIDE_MAX samples a
 * side. */
enum eco_code lod_ground_build(struct lod_ground_tree *tree, const struct eco_ground *ground, double step_m, double least_m,
	struct eco_error *error);

/* The tile's samples with heights as whole steps above low_m; at its border exactly, elsewhere without the low `shift` bits. */
enum eco_code lod_ground_elements(struct eco_elements *elements, const struct eco_ground *ground, const struct eco_ground_tile *tile,
	uint8_t shift, double low_m, double step_m, struct eco_error *error);

#endif
