/* Pictures of leaf collapse: the paper's figures 1, 2, 5 and 6. */
#ifndef TESTS_BENCH_COLLAPSE_DRAW_H
#define TESTS_BENCH_COLLAPSE_DRAW_H

#include "tests/bench/bench.h"
#include "tests/bench/collapse/bench_collapse_plant.h"
#include "tests/bench/bench_leaves.h"

/* Two leaves, and the quad that takes their place, seen straight onto its plane: FILE. */
enum eco_code bench_collapse_draw_pair(struct bench *bench, const char *file, struct eco_error *error);
enum eco_code bench_collapse_draw_atlas(struct bench *bench, const char *file,
	const struct lod_collapse_atlas *atlas, struct eco_error *error);
/* All leaves, then levels of a quarter, a sixteenth and a 64th of the vertices, side by side. */
enum eco_code bench_collapse_draw_levels(struct bench *bench, const char *file, struct bench_leaves *leaves,
	const struct bench_collapse_plant *plant, const struct lod_sights *sights, uint64_t vertices,
	struct eco_error *error);
/* Leaves from above, in the colours of their sectors. */
enum eco_code bench_collapse_draw_sectors(struct bench *bench, const char *file,
	const struct lod_foliage *foliage, const struct lod_collapse_sectors *sectors,
	struct eco_error *error);

#endif
