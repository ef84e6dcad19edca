/* What sections on the cameras of pictures.json have in common: the scenes, a first visit for each budget,
 * and figures that are kept.
 *
 *   json_t *file; scenes = bench_views_load(&file, &error);
 *   bench_views_each(bench, scenes, quick, study_view, ctx, &error);    every camera of scenes that are there
 *           bench_view_rows(bench, view, &shoot, &rows, &error);    within: its rows, made or recalled
 *   json_decref(file); */
#ifndef TESTS_BENCH_VIEWS_H
#define TESTS_BENCH_VIEWS_H

#include "client-min/draw/view_picture.h"
#include "tests/bench/bench_shots.h"

struct bench_view { const char *scene, *camera, *pack; struct eco_view view; };

/* Its array of scenes, borrowed from *file; NULL: an error. */
const json_t *bench_views_load(json_t **file, struct eco_error *error);

/* Scenes, the first of pictures.json, that sections with many budgets a view look at without FULL=1. */
#define BENCH_VIEWS_QUICK 1u
typedef enum eco_code bench_view_call(struct bench *bench, void *ctx, const struct bench_view *view,
	struct eco_error *error);
/* `quick`: how many of the scenes the quick bench looks at. */
enum eco_code bench_views_each(struct bench *bench, const json_t *scenes, size_t quick, bench_view_call *call,
	void *ctx, struct eco_error *error);

/* Stamp of its pack and camera. */
void bench_view_stamp(const struct bench_view *view, char stamp[256]);

/* First visits of a view, budget by budget. */
struct bench_view_shoot {
	const char *name;            /* of what is kept */
	uint32_t count;              /* budgets */
	void (*ask)(uint32_t budget, struct bench_frame *frame);         /* its view is set */
	/* Shows the picture, if it is to be seen, and makes its row. */
	enum eco_code (*take)(struct bench *bench, struct bench_client *client, const struct bench_view *view,
		uint32_t budget, const struct bench_frame *frame, const struct view_picture *picture,
		json_t **row, struct eco_error *error);
};
/* An array of a row for each budget, null where no answer has so few bytes; borrowed. */
enum eco_code bench_view_rows(struct bench *bench, const struct bench_view *view,
	const struct bench_view_shoot *shoot, json_t **rows, struct eco_error *error);

#endif
