/* One plant drawn with few vertices, against the whole plant.
 *
 *   hard Q       one sample a pixel in both pictures
 *   soft Q       shares of pixels, 4 x 4 samples in both
 *
 * Views are those of no fit. Sections on single plants set their methods beside these figures. */
#ifndef TESTS_BENCH_SPLATS_H
#define TESTS_BENCH_SPLATS_H

#include "ecofiles/format/model.h"
#include "lod/build/splat/splat_fit.h"
#include "lod/raster/raster.h"
#include "tests/bench/bench.h"

#define BENCH_SPLATS_VIEWS 24u           /* of elevation -10 to 60 degrees, as good as orthographic */
#define BENCH_SPLATS_SIZES 2u            /* projected heights */

struct bench_splats_size {
	uint32_t side;                   /* pictures of side x side pixels */
	struct lod_raster raster, fine;      /* one sample a pixel; 4 x 4 */
	uint8_t *hard[BENCH_SPLATS_VIEWS], *soft[BENCH_SPLATS_VIEWS];    /* of the whole plant */
	uint8_t *count;                  /* scratch: samples a pixel */
};
struct bench_splats_pictures {
	const struct eco_model *model;
	double center[3], radius;
	struct lod_eye eyes[BENCH_SPLATS_VIEWS];
	struct bench_splats_size sizes[BENCH_SPLATS_SIZES];
};
/* Means over views and sizes; precision and recall are of one sample a pixel. */
struct bench_splats_q { double hard, soft, precision, recall; };

/* Draws the whole plant in all pictures, in which it is that high. */
enum eco_code bench_splats_open(struct bench_splats_pictures *pictures, const struct eco_model *model,
	const double heights_px[BENCH_SPLATS_SIZES], struct eco_error *error);
void bench_splats_close(struct bench_splats_pictures *pictures);

/* Scores what `draw` draws, in one size (0, 1) or all (BENCH_SPLATS_SIZES). */
void bench_splats_score(struct bench_splats_pictures *pictures, uint32_t size,
	void (*draw)(const void *what, struct lod_raster *raster), const void *what,
	struct bench_splats_q *q);
/* The picture of one view, 3 bytes a pixel, row by row with `stride` pixels: white where nothing is, else
 * `rgb` by item, dark grey if it is NULL. `draw` NULL: the whole plant. */
void bench_splats_paint(struct bench_splats_pictures *pictures, uint32_t view,
	void (*draw)(const void *what, struct lod_raster *raster), const void *what, const uint8_t (*rgb)[3],
	uint8_t *to, uint32_t stride);

/* All triangles of a model that import would keep, cut out by their textures. */
void bench_model_draw(const struct eco_model *model, uint64_t owner, struct lod_raster *raster);
/* The state of levels with at most so many vertices: its splats from `items`. `to` has room for as many. */
uint32_t bench_splats_state(const struct lod_splats *splats, uint32_t vertices, struct lod_splat *to);
struct bench_splats_drawn { const struct lod_splat *items; uint32_t count; };
void bench_splats_draw(const void *drawn, struct lod_raster *raster);

/* ---- Figures of our own representations (bench_splats.c) ---- */

#define BENCH_SPLATS_BUDGETS 4u
extern const uint32_t bench_splats_budgets[BENCH_SPLATS_BUDGETS];        /* vertices: 12, 48, 200, 1000 */
extern const double bench_splats_heights_px[BENCH_SPLATS_SIZES];
/* OPAQUE, OPACITY: splats. POINTS: balls of the pack's order, grown by the best of eight factors.
 * IMPOSTOR: the best level, of one vertex. */
enum bench_splats_kind { BENCH_SPLATS_OPAQUE, BENCH_SPLATS_OPACITY, BENCH_SPLATS_POINTS,
	BENCH_SPLATS_IMPOSTOR, BENCH_SPLATS_KINDS };
extern const char *const bench_splats_kind_names[BENCH_SPLATS_KINDS];

/* Whether it is one of the plants with leaves that these figures are compared on. */
bool bench_splats_is_foliage(const struct bench_model *model);
/* Recalls a plant's figures, or measures them; its hard and soft Q by kind and budget. */
enum eco_code bench_splats_of(struct bench *bench, const struct bench_model *model,
	struct bench_splats_q q[BENCH_SPLATS_KINDS][BENCH_SPLATS_BUDGETS], struct eco_error *error);
#define BENCH_OBJECTS_SPLATS "tests/bench/pictures/bench_splats*.o "

#endif
