/* How often a pixel can show the leaf that it should: no list of so many leaves, the same for all views, does better. That is proved, not
 * searched for.
 *
 * owner_q is a concave function of how many pixels of a view are right, so it lies below its tangents; and below a tangent the best list takes
 * the leaves that own most for what they cost. Any tangents give a bound; those at what the list reaches itself give one close to it. What is
 * granted: leaves are drawn so that each shows wherever it should, and wood shows whole. */
#ifndef TESTS_BENCH_OWNERS_H
#define TESTS_BENCH_OWNERS_H

#include <stdint.h>

#include "lod/arena.h"

#define BENCH_OWNERS_VIEWS 12u

struct bench_owners {
	uint32_t leaves, views;      /* at most BENCH_OWNERS_VIEWS */
	uint32_t (*own)[BENCH_OWNERS_VIEWS];                             /* per leaf: pixels of full detail that it owns */
	double wood[BENCH_OWNERS_VIEWS], wanted[BENCH_OWNERS_VIEWS];     /* pixels that wood owns; that anything covers */
};

/* 1 - sqrt((1 - right / shown)^2 + (1 - right / wanted)^2); nothing to show or wanted: that part is 1. */
double bench_owner_q(double right, double shown, double wanted);

/* The most that the mean of owner_q over views can be. shown: pixels covered in each view; vertices: of all leaves drawn; cost: of each leaf,
 * at least 1. */
double bench_owners_most(const struct bench_owners *owners, const double *shown, double vertices, const uint32_t *cost, struct lod_arena *arena);

#endif
