/* Which foliage is flowers, by colour (Deussen 2002, 4.3). Private to the finder of organs.
 *
 * Components are candidates whose colour no leaf has in summer. Pink, violet and blue are no leaf's in autumn either. Pale and warm colours
 * need something green to stand out from; warm ones in the majority are autumn leaves if the green ones are made like them. Large
 * ones are none: a brown pot, a red crown. A name breaks the tie (organ_name.h). */
#ifndef LOD_ORGAN_FLOWER_H
#define LOD_ORGAN_FLOWER_H

#include "lod/build/organ_name.h"
#include "lod/build/organ_shape.h"

/* Makes flowers of foliage in `organ`; all arrays are per component, `fixed` ones stay. `extent` is the plant's largest. */
void lod_flowers_find(uint8_t *organ, const struct lod_shape *shapes, uint32_t count, const bool *fixed, const enum lod_hint *hint,
	double extent);

#endif
