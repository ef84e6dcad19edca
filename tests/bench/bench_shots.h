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
/* An object with vertices, bytes, q, p, r, wrong (pixels), skill, owner_q, colour, soft_q,
 * picture_error (S8), m16, s16, s16_abs, floor_error (F8), one_floor (F1), ceiling, truth_cpu_ms, predicted_q,
 * plan_ms, decode_ms, draw_ms; null where there is no such figure. */
json_t *bench_shot_row(const struct bench_frame *frame);
double bench_shot_number(const json_t *row, const char *key);        /* NaN where there is none */

/* All budgets of one view: an array of rows, in the order of bench_budgets. Borrowed. */
json_t *bench_shots(struct bench *bench, const char *scene, uint32_t method, uint32_t view);

/* ---- First visits, row by row, as sections measure and keep them ----
 *
 *   bench_views_each(bench, quick, study_view, ctx);        every camera of pictures.json's scenes that are there
 *           rows = bench_view_rows(bench, view, &shoot);    within: its rows, made or recalled */

struct bench_view { const char *scene, *camera, *pack; struct eco_view view; };

typedef void bench_view_call(struct bench *bench, void *ctx, const struct bench_view *view);
/* `quick`: how many of the scenes the quick bench looks at. */
void bench_views_each(struct bench *bench, size_t quick, bench_view_call *call, void *ctx);

struct bench_shoot {
	const char *name;            /* of what is kept */
	uint32_t count;
	const uint64_t *vertices;    /* of each row */
	const struct bench_method *method;   /* NULL: ours, whose frames are not timed */
	/* Writes the picture; NULL: none is seen. */
	void (*show)(struct bench *bench, struct bench_client *client, const struct bench_view *view, uint32_t row,
		const struct bench_frame *frame, const struct view_picture *picture);
};
/* An array of rows as bench_shot_row makes them; borrowed. */
json_t *bench_view_rows(struct bench *bench, const struct bench_view *view, const struct bench_shoot *shoot);
