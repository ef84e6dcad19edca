/* A crown of leaf collapse: its leaves, and behind them the quads of all sectors, so that one level is drawn
 * as any other choice of elements is (lod/build/foliage.h). */
#ifndef TESTS_BENCH_COLLAPSE_H
#define TESTS_BENCH_COLLAPSE_H

#include "lod/build/foliage.h"
#include "tests/bench/baseline/leaf_collapse.h"

#define BENCH_WEDGES 9u                  /* sectors: the innermost, and eight wedges */

struct bench_collapse {
	uint32_t sectors;
	struct lod_collapse forest[BENCH_WEDGES];
	struct lod_collapse_atlas atlas;
	uint32_t base[BENCH_WEDGES];         /* per sector: the element of its first quad */
	uint64_t *vertices[BENCH_WEDGES];    /* per sector and level, 3 a triangle */
};

/* Extends the foliage, whose count stays. `solid`: quads are drawn without textures. */
void bench_collapse_grow(struct bench_collapse *c, uint32_t sectors, bool solid, struct lod_foliage *foliage,
	struct lod_arena *arena);
/* Adds the finest level of a sector of at most so many vertices to the order, the coarsest if all have more.
 * Returns its vertices. */
uint64_t bench_collapse_level(const struct bench_collapse *c, uint32_t sector, double vertices,
	uint32_t *order, uint32_t *count);

#endif
