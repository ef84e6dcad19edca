/* A plant of ecobench as leaves over wood: what subsets of its leaves cover.
 *
 *   bench_leaves_unit(bench, "collapse", model, study, ctx, values, count);
 *       calls study(ctx, leaves):
 *           bench_leaves_look(leaves, &sights, 12, seed);
 *           bench_leaves_compare(leaves, &sights, view, &drawing, &sum); */
#pragma once

#include "lod/build/foliage.h"
#include "lod/build/order/order.h"
#include "tests/bench/bench.h"

#define BENCH_PIXELS 256u        /* of a side of pictures of leaves */

struct bench_leaves {
	struct lod_arena arena;
	struct eco_model model;
	struct lod_foliage foliage;
	struct lod_raster cover;             /* silhouettes */
	uint64_t *mask;                      /* of leaves, of the last comparison */
};

/* Its leaves and wood, as a build finds them. ECO_BAD_INPUT where the model has no leaf. The arena's handler
 * is set by this function while it runs. */
enum eco_code bench_foliage_make(struct lod_foliage *foliage, const struct eco_model *model,
	struct lod_arena *arena, struct eco_error *error);

/* Figures of a model's leaves: a unit "PREFIX-NAME" (bench_unit) that `study` makes as a JSON array of reals;
 * it may take from the leaves' arena. model NULL: the tree of 6,143 leaves. Anew for another file or a full
 * bench. A plant without leaves ends the section. */
typedef json_t *bench_leaves_study(void *ctx, struct bench_leaves *leaves);
void bench_leaves_unit(struct bench *bench, const char *prefix, const struct bench_model *model,
	bench_leaves_study *study, void *ctx, double *values, uint32_t count);

/* Views from such directions, or from `count` directions of lod_directions_spread, at most BENCH_LOOKS. */
#define BENCH_LOOKS 24u
void bench_leaves_sights(struct bench_leaves *leaves, struct lod_sights *sights,
	const double (*directions)[3], uint32_t count);
void bench_leaves_look(struct bench_leaves *leaves, struct lod_sights *sights, uint32_t count, uint32_t seed);

/* Vertices of the first `count` elements of an order, 3 a triangle. NULL: by their numbers. */
uint64_t bench_leaves_vertices(const struct lod_foliage *foliage, const uint32_t *order, uint32_t count);

/* Numbers of the leaves in an order of the literature, of seed 1; in the arena. noise: of lod_order_input. */
uint32_t *bench_leaves_order(struct bench_leaves *leaves, enum lod_order_method method, double noise);

/* Adds the wrong pixels of one view. */
struct bench_wrong { uint64_t fp, fn, pixels; };     /* pixels: of the reference */
void bench_leaves_compare(struct bench_leaves *leaves, const struct lod_sights *sights, uint32_t view,
	const struct lod_sights_drawing *drawing, struct bench_wrong *sum);
/* The same of anything that `draw` draws into an empty raster, wood included. */
typedef void bench_draw_call(const void *what, const struct lod_eye *eye, struct lod_raster *raster);
void bench_leaves_compare_drawn(struct bench_leaves *leaves, const struct lod_sights *sights, uint32_t view,
	bench_draw_call *draw, const void *what, struct bench_wrong *sum);
/* The view as it is drawn, wood over leaves: column `column` of a picture of `columns`. drawing NULL: all leaves. */
void bench_leaves_paint(struct bench_leaves *leaves, const struct lod_sights *sights, uint32_t view,
	const struct lod_sights_drawing *drawing, uint32_t column, uint32_t columns, uint8_t *rgb);
double bench_wrong_share(const struct bench_wrong *wrong);          /* (fp + fn) / pixels */
double bench_wrong_q(const struct bench_wrong *wrong);              /* Q of the sums */
double bench_wrong_precision(const struct bench_wrong *wrong);
double bench_wrong_recall(const struct bench_wrong *wrong);

/* Q of a pack of the plant with at most so many vertices, as the planner draws it. drawn: vertices without
 * those of wood by itself, which splats and impostors include; NULL: not asked for. */
void bench_leaves_ours(struct bench *bench, struct bench_leaves *leaves, const struct bench_model *model,
	const struct lod_sights *sights, const double *vertices, uint32_t count, double *q, double *drawn);

/* ---- Plants ---- */

/* A stamp of a file's bytes; borrowed until the next call. */
const char *must_stamp(const char *path);

/* The plants that a section studies:
 *
 *   struct bench_walk walk = { .bench = bench, .leaves = 500, .most = 12, .quick = 4 };
 *   for (const struct bench_model *model; (model = bench_walk(&walk));)
 *     ... walk.found[model->generated]++; */
struct bench_walk {
	struct bench *bench;
	uint32_t leaves;             /* at least */
	uint32_t most;               /* of the full bench */
	uint32_t quick, quick_made;  /* of the quick bench; quick_made: generated ones apart; 0: together */
	bool (*wants)(const struct bench *bench, const struct bench_model *model);   /* NULL: all */
	uint32_t found[2];           /* those that count: read, generated */
	/* private */
	struct bench_model *models;
	uint32_t count, next;
};
/* NULL after the last; the report names those that the quick bench leaves out. */
const struct bench_model *bench_walk(struct bench_walk *walk);
