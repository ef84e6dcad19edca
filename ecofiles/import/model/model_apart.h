/* Several plants in one file: pieces that stand on the ground with bare ground between them. */
#ifndef ECO_MODEL_APART_H
#define ECO_MODEL_APART_H

#include "ecofiles/format/model.h"

#define ECO_APART_MOST 12u       /* more pieces are a meadow or a hedge */

struct eco_apart {
	uint32_t count; /* of pieces that stand and are at least 0.4 times as high as the highest */
	double at[ECO_APART_MOST][2];        /* their middles, metres */
};

/* Zero where memory ran out. */
struct eco_apart eco_model_apart(const struct eco_model *model);

#endif
