/* Billboard clouds: what sections and files share. */
#ifndef TESTS_BENCH_BILLBOARDS_H
#define TESTS_BENCH_BILLBOARDS_H

#include "lod/build/splat/splat_fit.h"
#include "lod/raster/raster.h"
#include "tests/bench/bench_leaves.h"

/* Mean of a texture's opaque texels, darker than white. */
void bench_billboards_color(const struct eco_image *image, uint8_t rgb[3]);

/* Our own representations (bench_billboards_ours.c). */
enum bench_ours_kind { BENCH_OURS_OPAQUE, BENCH_OURS_SPLATS, BENCH_OURS_IMPOSTOR, BENCH_OURS_KINDS };
extern const char *const bench_ours_names[BENCH_OURS_KINDS];
/* `score` scores what `draw` draws with at most so many vertices, the best of several: each level of an
 * impostor, which has one vertex whatever the budget. */
typedef void bench_ours_score(void *ctx, enum bench_ours_kind kind, uint32_t budget, bench_draw_call *draw,
	const void *what);
void bench_ours_each(const struct eco_model *model, const uint32_t *budgets, uint32_t count,
	bench_ours_score *score, void *ctx);

/* The state of levels with at most so many vertices: its splats. `to` has room for as many. */
struct bench_splats { struct lod_splat *items; uint32_t count; };
void bench_splats_state(const struct lod_splats *splats, uint32_t vertices, struct bench_splats *to);
bench_draw_call bench_splats_draw;

/* A field of plants whose clouds have fewer billboards the further away they stand (Kratt 2014, figure 4,
 * right), as a picture and a table (bench_billboards_field.c). */
void bench_billboards_field(struct bench *bench, const struct bench_model *model);

#endif
