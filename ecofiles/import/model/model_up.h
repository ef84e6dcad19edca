/* The axis of a model that points up, by shape alone: formats rarely state it, and exporters disagree.
 *
 * A plant shows it from the side. It stands on a narrow foot, under its centre of mass, and spreads from
 * there; seen from above it is about as wide as deep; to the sides both ends are alike, and end in a few
 * leaves. If leaves reach to the ground, its large parts (stems, boughs, pots) still show this. Each of
 * these properties, measured along the file's y and z axes, is a contrast between the two in [-1, 1];
 * their weighted sum decides, and its size is the certainty. The file's zero at one end of one axis only
 * counts a little. */
#ifndef ECO_MODEL_UP_H
#define ECO_MODEL_UP_H

#include "ecofiles/format/model.h"

/* Act on the answer from this certainty on; below it keep the format's convention. */
#define ECO_UP_CERTAIN 0.5

/* ECO_UP_Y or ECO_UP_Z of a soup with the file's axes. Triangles with bad indices or coordinates do not
 * count. `certainty` receives 0 (no idea, and the answer is ECO_UP_Y) to 1. Uses only positions and
 * indices; scale does not matter. Linear in the triangles, and the same answer on every machine. Without
 * memory large parts are not used. */
enum eco_up eco_model_find_up(const struct eco_model *soup, double *certainty);

#endif
