/* Time of planning, and how it grows: the planner alone, in memory, beside what this machine needs to copy
 * memory. */
#ifndef TESTS_BENCH_TIMES_H
#define TESTS_BENCH_TIMES_H

#include "ecofiles/format/pack.h"
#include "ecofiles/format/view.h"
#include "lod/plan/planner.h"
#include "tests/support/scene_builder.h"

struct bench_plan_time {
	double ms;                   /* median of the repetitions */
	uint64_t candidates, gains, looks, places, vertices;         /* as struct lod_planner_stats says */
	uint32_t cuts, repetitions;
};

/* Plans at least thrice, until `least_ms` have gone by or 200 times. */
enum eco_code bench_plan_time(struct bench_plan_time *time, const struct eco_scene *scene,
	const struct eco_request *request, double least_ms, struct eco_error *error);

/* Median milliseconds to copy 1 GB (10^9 bytes) within memory, block after block of 250 MB; NaN without the
 * memory. */
double bench_copy_ms(void);

/* A scene of `species` plants with one ladder each of about 4,000 leaves, as points and triangles with errors
 * of their own, eight plants of each, spread over leaf tiles of 512 places: as many things to choose between
 * as are asked for. Tables only, no chunks' payloads. The same for the same number. Free with
 * bench_choice_free. */
struct bench_choice {
	struct scene_builder made;
	struct eco_request request;          /* sees all of it; the caller sets vertices */
};
void bench_choice_make(struct bench_choice *choice, uint32_t species);
void bench_choice_free(struct bench_choice *choice);

#endif
