/* First visits from the cameras of pictures.json, budget by budget, as sections measure and keep them.
 *
 *   bench_views_each(bench, quick, study_view, ctx, &error);           every camera of scenes that are there
 *           bench_view_rows(bench, view, &shoot, &rows, &error);       within: its rows, made or recalled */
#ifndef TESTS_BENCH_VIEWS_H
#define TESTS_BENCH_VIEWS_H

#include "client-min/draw/view_picture.h"
#include "tests/bench/bench_shots.h"

struct bench_view { const char *scene, *camera, *pack; struct eco_view view; };

/* Scenes, the first of pictures.json, that sections with many budgets a view look at without FULL=1. */
#define BENCH_VIEWS_QUICK 1u
typedef enum eco_code bench_view_call(struct bench *bench, void *ctx, const struct bench_view *view,
	struct eco_error *error);
/* `quick`: how many of the scenes the quick bench looks at. */
enum eco_code bench_views_each(struct bench *bench, size_t quick, bench_view_call *call, void *ctx,
	struct eco_error *error);

struct bench_view_shoot {
	const char *name;            /* of what is kept */
	uint32_t count;              /* budgets */
	void (*ask)(uint32_t budget, struct bench_frame *frame);         /* its view is set */
	/* Writes the picture; NULL: none is seen. */
	enum eco_code (*show)(struct bench *bench, struct bench_client *client, const struct bench_view *view,
		uint32_t budget, const struct bench_frame *frame, const struct view_picture *picture,
		struct eco_error *error);
};
/* An array of rows as bench_shot_row makes them, one a budget, null where no answer has so few bytes;
 * borrowed. */
enum eco_code bench_view_rows(struct bench *bench, const struct bench_view *view,
	const struct bench_view_shoot *shoot, json_t **rows, struct eco_error *error);

/* ---- The path of a flight (bench_flight.c) ---- */

#define BENCH_FLIGHT_FPS 10u
#define BENCH_FLIGHT_S 60u               /* a whole flight */
#define BENCH_FLIGHT_FRAMES (BENCH_FLIGHT_FPS * BENCH_FLIGHT_S)

/* The views of `count` frames from frame `first` of BENCH_FLIGHT_FRAMES on: from the air down to eye level in
 * a third of the time, then along the longer side of the scene's bounds through it. The caller frees *views. */
enum eco_code bench_flight_path(const char *pack, uint32_t first, uint32_t count, struct eco_view **views,
	struct eco_error *error);

#endif
