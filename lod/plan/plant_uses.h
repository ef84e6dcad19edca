/* Which plants stand in which open tiles, for sums over all of them at each lambda: the visible tree's
 * tallies, packed, and those of cells summed over tiles. Loops over them are much of a plan's time, and touch
 * only what they need: a cost a slot, not a slot_choice. From one relaxation to the next most slots cost the
 * same and most tiles stay as they are, so only sums are made again of which a part is another one; each is
 * summed in the same order, so that it is the same number as if all were. */
#ifndef LOD_PLANT_USES_H
#define LOD_PLANT_USES_H

#include "lod/plan/allocation.h"

/* After the tiles and slots of the allocation were made. */
enum eco_code lod_uses_make(struct lod_allocation *allocation, struct eco_error *error);
void lod_uses_free(struct lod_uses *uses);

/* Adds up the cells of each slot's whole plants; the sums are 0 before: slot_choice.cells,
 * .cells_weight_px. */
void lod_uses_sum_cells(struct lod_allocation *allocation);
/* Sets near and each, once gates are. */
void lod_uses_set_each(struct lod_allocation *allocation);
/* The cost of a tile's own plants, without bytes and what is seen from above. */
struct lod_cost lod_uses_cost(const struct lod_allocation *allocation, uint32_t node);
/* Sets drawn and seen, once tiles have chosen. */
void lod_uses_sum_drawn(struct lod_allocation *allocation);

#endif
