/* Flowers among the foliage, found by colour (Deussen 2002, 4.3). Private to the finder of organs.
 *
 * Candidates are components of a colour that no leaf has in summer. Pink, violet and blue are not leaf
 * colours in autumn either. Pale and warm colours must stand out against green; warm ones in the majority are
 * autumn leaves if the green ones have the same make. Large components are no flowers: a brown pot, a red
 * crown. A name breaks the tie (organ_name.h). */
#ifndef LOD_ORGAN_FLOWER_H
#define LOD_ORGAN_FLOWER_H

#include "lod/build/organ/organ_name.h"
#include "lod/build/organ/organ_shape.h"

/* Turns foliage into flowers in `organ`; arrays are per component, `fixed` ones stay. `extent`: the plant's
 * largest. */
void lod_flowers_find(uint8_t *organ, const struct lod_shape *shapes, uint32_t count, const bool *fixed,
	const enum lod_hint *hint, double extent);

#endif
