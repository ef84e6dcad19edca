/* A plant's Q with ever more vertices, as the planner draws it alone.
 *
 *   plant_walk(&walk, pack, number, &(struct plant_walk_options){ .views = 8, .pixels = 128 }, &error);
 *   walk.vertices[i], walk.q[i]                  1, 2, 4, ... vertices and full detail; means over views
 *   walk.fall                                    the most that Q falls with more vertices
 *   plant_regret(&regret, pack, number, &options, &error);
 *   regret.worst                                 the most that one kind alone, as good as it can be planned,
 *                                                beats what the planner chooses among all kinds */
#ifndef TESTS_PLANT_WALK_H
#define TESTS_PLANT_WALK_H

#include "ecofiles/format/pack.h"

#define PLANT_WALK_MAX 33u

/* Lists that may show a plant: all of its pack, as users see it, or one kind alone. */
enum plant_kind { PLANT_ANY, PLANT_ORGANS, PLANT_SPLATS, PLANT_IMPOSTOR, PLANT_KINDS };

/* Views all around, of elevation -10 to 60 degrees, as good as orthographic. */
struct plant_walk_options { uint32_t views, pixels; enum plant_kind kind; };

struct plant_walk {
	uint32_t count;
	uint64_t vertices[PLANT_WALK_MAX];
	double q[PLANT_WALK_MAX];
	double fall;                 /* of Q, below the best with fewer vertices */
	uint64_t fall_at;            /* vertices */
};

/* Over 8, 16, 32, ... vertices up to half of full detail: how far mean Q lies below that of the best kind. */
#define PLANT_REGRET_LEAST 8u
struct plant_regret {
	uint32_t count, within;      /* budgets; those within PLANT_REGRET_FREE */
	double mean, worst;          /* of Q, 0 where the choice is best */
	uint64_t worst_at;           /* vertices */
	enum plant_kind best;        /* there */
};
#define PLANT_REGRET_FREE 0.005

enum eco_code plant_walk(struct plant_walk *walk, const struct eco_pack *pack, uint32_t number,
	const struct plant_walk_options *options, struct eco_error *error);
/* options->kind is not read. */
enum eco_code plant_regret(struct plant_regret *regret, const struct eco_pack *pack, uint32_t number,
	const struct plant_walk_options *options, struct eco_error *error);

#endif
