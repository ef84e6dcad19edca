/* Which axis of a model points up, by its shape alone: formats say it seldom, and exporters disagree.
 *
 * What a plant looks like from the side tells it. It stands on a narrow foot, under its centre of mass, and spreads from there, seen
 * from above about as wide as deep; to the sides it is much the same on both ends, and ends in a few leaves. Where leaves reach to the
 * ground, its large parts (stems, boughs, pots) still show this. Measured along the y and the z axis of the file, each of these is a
 * contrast between the two in [-1, 1]; their weighted sum decides, and its size is the certainty. That the file's zero is at one end
 * of one axis, but not of the others, counts a little. */
#ifndef ECO_MODEL_UP_H
#define ECO_MODEL_UP_H

#include "ecofiles/format/model.h"

/* From this certainty on the answer may be acted upon; below it keep the format's convention. */
#define ECO_UP_CERTAIN 0.5

/* ECO_UP_Y or ECO_UP_Z of a soup as the file has it, not turned. Triangles with bad indices or coordinates do not count. `certainty`
 * receives 0 (no idea: the answer is then ECO_UP_Y) to 1. Only positions and indices are looked at; scale does not matter. Linear in
 * the triangles, and the same answer on every machine; without memory for the large parts they do not count. */
enum eco_up eco_model_find_up(const struct eco_model *soup, double *certainty);

#endif
