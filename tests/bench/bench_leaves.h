/* A plant of ecobench as leaves over wood: what subsets of its leaves cover.
 *
 *   bench_leaves_open(&leaves, &model, pixels, &error);          takes the model over
 *   bench_leaves_compare(&leaves, &sights, view, &drawing, &sum);
 *   bench_leaves_close(&leaves); */
#ifndef TESTS_BENCH_LEAVES_H
#define TESTS_BENCH_LEAVES_H

#include "lod/build/foliage.h"
#include "lod/build/order/order.h"
#include "tests/bench/bench.h"

struct bench_leaves {
	struct lod_arena arena;
	struct eco_model model;
	struct lod_foliage foliage;
	struct lod_raster cover;             /* silhouettes */
	uint64_t *mask;                      /* of leaves, of the last comparison */
	uint32_t pixels;
};

/* Its leaves and wood, as a build finds them. ECO_BAD_INPUT where the model has no leaf. The arena's handler
 * is set by this function while it runs. */
enum eco_code bench_foliage_make(struct lod_foliage *foliage, const struct eco_model *model,
	struct lod_arena *arena, struct eco_error *error);

/* ECO_BAD_INPUT for a plant without leaves; the model is freed then too. */
enum eco_code bench_leaves_open(struct bench_leaves *leaves, struct eco_model *model, uint32_t pixels,
	struct eco_error *error);
void bench_leaves_close(struct bench_leaves *leaves);

/* A unit (bench_unit) of a model's leaves, made by `study`. It may take from the leaves' arena. */
struct bench_leaves_unit {
	const char *name, *stamp;
	const struct bench_model *model;     /* NULL: `make` makes one */
	uint32_t pixels;
	enum eco_code (*study)(void *ctx, struct bench_leaves *leaves, json_t **out, struct eco_error *error);
	void *ctx;
	enum eco_code (*make)(struct eco_model *model, struct eco_error *error);
};
enum eco_code bench_leaves_unit(struct bench *bench, const struct bench_leaves_unit *unit, json_t **out,
	struct eco_error *error);

/* Numbers of the leaves in an order of the literature, of seed 1; in the arena. noise: of lod_order_input. */
uint32_t *bench_leaves_order(struct bench_leaves *leaves, enum lod_order_method method, double noise);

/* Adds the wrong pixels of one view. */
struct bench_wrong { uint64_t fp, fn, pixels; };     /* pixels: of the reference */
void bench_leaves_compare(struct bench_leaves *leaves, const struct lod_sights *sights, uint32_t view,
	const struct lod_sights_drawing *drawing, struct bench_wrong *sum);
/* The same of anything that is drawn, and of wood if that is whole. */
typedef void bench_draw_call(const void *what, struct lod_raster *raster);
void bench_leaves_compare_drawn(struct bench_leaves *leaves, const struct lod_sights *sights, uint32_t view,
	bool wood, bench_draw_call *draw, const void *what, struct bench_wrong *sum);
double bench_wrong_share(const struct bench_wrong *wrong);          /* (fp + fn) / pixels */
double bench_wrong_q(const struct bench_wrong *wrong);              /* Q of the sums */

#endif
