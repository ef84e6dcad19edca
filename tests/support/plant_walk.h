/* A plant's Q with ever more vertices, as the planner draws it alone.
 *
 *   plant_walk(&walk, pack, number, &(struct plant_walk_options){ .views = 8, .pixels = 128 }, &error);
 *   walk.vertices[i], walk.q[i]                  1, 2, 4, ... vertices and full detail; means over views
 *   walk.fall                                    the most that Q falls with more vertices */
#ifndef TESTS_PLANT_WALK_H
#define TESTS_PLANT_WALK_H

#include "ecofiles/format/pack.h"

#define PLANT_WALK_MAX 33u

/* Views all around, of elevation -10 to 60 degrees, as good as orthographic. */
struct plant_walk_options { uint32_t views, pixels; };

struct plant_walk {
	uint32_t count;
	uint64_t vertices[PLANT_WALK_MAX];
	double q[PLANT_WALK_MAX], soft_q[PLANT_WALK_MAX];
	double fall;                 /* of Q, below the best with fewer vertices */
	uint64_t fall_at;            /* vertices */
};

enum eco_code plant_walk(struct plant_walk *walk, const struct eco_pack *pack, uint32_t number,
	const struct plant_walk_options *options, struct eco_error *error);

#endif
