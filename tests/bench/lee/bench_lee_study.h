/* One plant of Lee's table: what each way to keep leaves gets wrong, in views that nothing was built or tuned
 * with.
 *
 * Lists per sector of view are made for sectors of two widths, and measured in views all over them; Lee's
 * three beside them in the same views. In those of the narrow sectors all other methods are measured, too. */
#ifndef TESTS_BENCH_LEE_STUDY_H
#define TESTS_BENCH_LEE_STUDY_H

#include "tests/bench/bench.h"

enum { LEE_SHARES = 4 };
extern const uint32_t bench_lee_percent[LEE_SHARES];

enum bench_lee_method {
	LEE_DISTANCE, LEE_NORMAL, LEE_LAYER, LEE_CELL_DISTANCE, LEE_CELL_NORMAL, LEE_CELL_LAYER,
	LEE_STOCHASTIC, LEE_COMBINED, LEE_STATIC, LEE_SECTOR, LEE_METHODS
};
extern const char *const bench_lee_methods[LEE_METHODS];

/* Sectors of view are cones so wide. */
enum bench_lee_width { LEE_NARROW, LEE_WIDE, LEE_WIDTHS };
extern const double bench_lee_degrees[LEE_WIDTHS];

struct bench_lee_extent { uint32_t sectors[LEE_WIDTHS], views; };    /* of each width; views in each */

/* Takes the model over. `out` becomes (leaves alone count where they are fewer than a thousand)
 *   leaves, cells, lists: [of each width, how many lists it takes to see the plant from the side and from
 *   above]
 *   widths: [of each width [of each method [of each share [wrong, other leaf, scale, wrong scaled, other leaf
 *   scaled]]]], shares of pixels of
 *     the reference; of wide sectors Lee's three and ours alone */
enum eco_code bench_lee_study(struct bench *bench, struct eco_model *model,
	const struct bench_lee_extent *extent, json_t **out, struct eco_error *error);

#endif
