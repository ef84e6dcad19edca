/* Leaves made in code, for tests of orders: planar fans of some corners, spread in a ball over a stem. */
#ifndef TESTS_FOLIAGE_RANDOM_H
#define TESTS_FOLIAGE_RANDOM_H

#include "lod/build/foliage.h"
#include "lod/sort.h"

struct foliage_random { uint32_t leaves, corners; double radius, leaf; uint64_t seed; };

double foliage_dice(uint64_t *state);
void foliage_random(struct lod_foliage *f, const struct foliage_random *how, struct lod_arena *arena);

#endif
