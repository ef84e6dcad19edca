/* Frames of a scene by a method: what sections on whole pictures have in common, so that none is drawn twice.
 */
#pragma once

#include "tests/bench/bench.h"

#define BENCH_SHOT_WIDTH 800u
#define BENCH_SHOT_HEIGHT 600u
#define BENCH_BUDGETS_MAX 16u
#define BENCH_SHOT_VIEWS_MAX 12u

/* A method to order plants, and to spend the budget. */
struct bench_method {
	const char *name, *order;            /* order NULL: the default */
	lod_rule *rule;
	bool ignore_occlusion;
	bool full_only;
};
enum { BENCH_OURS, BENCH_DEUSSEN_RULE, BENCH_STOCHASTIC, BENCH_UNOCCLUDED, BENCH_COMBINED, BENCH_DEUSSEN_2002,
	BENCH_DENSITY_ORDER, BENCH_ORIENTATION_ORDER, BENCH_METHODS };
extern const struct bench_method bench_methods[BENCH_METHODS];

/* Vertices, ascending: a common grid, and what the literature drew of this scene. */
uint32_t bench_budgets(const struct bench *bench, const char *scene, uint64_t budgets[BENCH_BUDGETS_MAX]);
/* Number of a scene's views that this run looks at, at most BENCH_SHOT_VIEWS_MAX; their requests are those of
 * bench_scene_views, at our size. */
uint32_t bench_shot_views(struct bench *bench, const char *scene,
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX]);
double bench_shot_number(const json_t *row, const char *key);        /* NaN where there is none */

/* All budgets of one view, in the order of bench_budgets: an array of objects with vertices, bytes, q, p, r,
 * wrong (pixels), skill, owner_q, colour, soft_q, picture_error (S8), m16, s16, s16_abs, floor_error (F8),
 * one_floor (F1), ceiling, truth_cpu_ms, predicted_q, plan_ms, decode_ms, draw_ms; null where there is no
 * such figure. Borrowed. */
json_t *bench_shots(struct bench *bench, const char *scene, uint32_t method, uint32_t view);
