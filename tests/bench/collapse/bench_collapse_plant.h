/* A plant's foliage with the quads of leaf collapse behind its leaves, so that one level is drawn as any
 * other choice of elements is (lod/build/foliage.h).
 *
 *   bench_collapse_make(&plant, &foliage, &options, &arena);
 *   bench_collapse_extend(&plant, &foliage, &arena);     element n + k is quad k; foliage.count stays n
 *   row = bench_collapse_row(&plant, 0, vertices);
 *   count = bench_collapse_order(&plant, 0, row, order); */
#ifndef TESTS_BENCH_COLLAPSE_PLANT_H
#define TESTS_BENCH_COLLAPSE_PLANT_H

#include "lod/build/foliage.h"
#include "tests/bench/baseline/leaf_collapse.h"

struct bench_collapse_options {
	uint32_t sectors;            /* 0: one forest */
	bool solid;                  /* quads without textures */
};

struct bench_collapse_plant {
	struct lod_collapse_sectors sectors;
	struct lod_collapse_atlas atlas;
	bool solid;
	uint32_t leaves, quads;
	uint32_t *base;              /* per sector: the element of its first quad */
	/* per sector and level: vertices, 3 a triangle */
	uint64_t **vertices;
};

/* The foliage has leaves. */
void bench_collapse_make(struct bench_collapse_plant *plant, const struct lod_foliage *foliage,
	const struct bench_collapse_options *options, struct lod_arena *arena);
void bench_collapse_extend(const struct bench_collapse_plant *plant, struct lod_foliage *foliage,
	struct lod_arena *arena);

/* The finest level of a sector of at most so many vertices; the coarsest if all have more. */
uint32_t bench_collapse_row(const struct bench_collapse_plant *plant, uint32_t sector, double vertices);
/* Elements of a sector's level: its leaves, then its quads. Returns how many. */
uint32_t bench_collapse_order(const struct bench_collapse_plant *plant, uint32_t sector, uint32_t row,
	uint32_t *order);
/* shown[leaf] of the sector's leaves becomes the element that stands for it. */
void bench_collapse_shown(const struct bench_collapse_plant *plant, uint32_t sector, uint32_t row,
	uint32_t *shown, struct lod_arena *arena);

#endif
