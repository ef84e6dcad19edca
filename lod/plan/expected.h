/* Predictions of one view in order: which expects the better picture, and what lies between two of them.
 *
 * Pictures are compared by Q. The number of wrong pixels is another order: where half of a meadow is missed
 * and little is too much, fewer pixels may be wrong than where less is missed and as much is too much, and
 * yet Q is lower. */
#ifndef LOD_EXPECTED_H
#define LOD_EXPECTED_H

#include <stdbool.h>

#include "ecofiles/format/plan.h"

/* No picture is worse. That of zeros has Q 1: none is better. */
#define LOD_EXPECTED_WORST { .fp = 1, .fn = 1 }

/* Is the Q of `a` below that of `b`? */
bool lod_expected_worse(const struct eco_prediction *a, const struct eco_prediction *b);

/* Interpolates by Q between `worse` and `better`; part: 0 to 1. */
struct eco_prediction lod_expected_between(const struct eco_prediction *worse,
	const struct eco_prediction *better, double part);

/* Makes a prediction no worse than `worse` and no better than `better`. */
void lod_expected_clamp(struct eco_prediction *prediction, const struct eco_prediction *worse,
	const struct eco_prediction *better);

#endif
