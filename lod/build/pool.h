/* What a tile's summary takes of a plant: points of equal weight. A summary is drawn where plants are a few pixels wide, and has to look like
 * what is seen of them: a leaf in front counts, the bark behind it does not. So points lie where the plant is seen, by views from all
 * around, each primitive in proportion to the pixels in which it is nearest; in proportion to area where nothing can be seen. */
#ifndef LOD_POOL_H
#define LOD_POOL_H

#include "lod/build/plant.h"

struct lod_pool {                /* owns its arrays */
	uint32_t count;              /* >= 1 */
	float (*position)[3];        /* plant space */
	uint16_t *color;             /* index into the scene's palette */
	uint8_t level;               /* of the plant's leaves, as lists of points have it */
};
/* `palette_first` is where the plant's palette begins in the scene's. In random order. */
enum eco_code lod_pool_make(struct lod_pool *pool, const struct lod_plant *plant, uint32_t palette_first, uint32_t count,
	struct eco_error *error);
void lod_pool_free(struct lod_pool *pool);

#endif
