/* Impostors of one vertex beside splats: rows of the section `splats`. */
#ifndef TESTS_BENCH_IMPOSTORS_H
#define TESTS_BENCH_IMPOSTORS_H

#include "ecofiles/format/impostor.h"
#include "tests/bench/bench.h"
#include "tests/bench/pictures/bench_splats.h"

/* Heights of plants that have few pixels, and how many splats stand beside impostors there. */
#define BENCH_FEW_HEIGHTS 4u             /* 8, 16, 32, 64 pixels */
#define BENCH_FEW_SPLATS 5u              /* 1, 3, 12, 48, 192 */
#define BENCH_FEW_ROWS (BENCH_FEW_SPLATS + ECO_IMPOSTOR_LEVELS)

struct bench_impostor { double shape_bytes, color_bytes, hard, soft; };
/* Figures of one kind of plants. */
#define BENCH_IMPOSTOR_PLANTS 32u        /* at most; others are left out */
struct bench_impostors {
	uint32_t count;
	char name[BENCH_IMPOSTOR_PLANTS][64];
	struct bench_impostor plant[BENCH_IMPOSTOR_PLANTS][ECO_IMPOSTOR_LEVELS];
	double seconds[BENCH_IMPOSTOR_PLANTS];
	double few[BENCH_FEW_ROWS][2 * BENCH_FEW_HEIGHTS];       /* sums: hard and soft Q at each height */
};

/* Appends a row to `few` for each number of splats: hard and soft Q at each height. */
enum eco_code bench_few_splats(const struct eco_model *model, const struct lod_splats *splats, json_t *few,
	struct eco_error *error);
/* Makes impostors of the plant in the pictures; appends a row a level to `result` (bytes of texels and
 * depths, of colours, hard and soft Q, processor seconds of all levels) and to `few`. Writes
 * impostors-NAME.png. */
enum eco_code bench_impostors_study(struct bench *bench, const char *name,
	struct bench_splats_pictures *pictures, json_t *result, json_t *few, struct eco_error *error);

void bench_impostors_add(struct bench_impostors *to, const char *name, json_t *result, json_t *few);
void bench_impostors_write(struct bench *bench, const struct bench_impostors *groups,
	const char *const *names, uint32_t count);
void bench_impostors_keys(struct bench *bench, const struct bench_impostors *foliage);

#endif
