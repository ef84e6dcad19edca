/* Q of leaf collapse and of splats at equal vertices, for one plant: what the section `collapse` measures
 * beside the orders of bench_savings.h. */
#ifndef TESTS_BENCH_COLLAPSE_Q_H
#define TESTS_BENCH_COLLAPSE_Q_H

#include "tests/bench/ladder/bench_savings.h"

/* PRINTED: quads as large as the paper has them. SOLID: opaque quads, at the scale that is best in other
 * views. SECTORS: quads of the printed size; each sector has a level, the finer the more it faces the eye.
 * SPLATS: of the whole plant, as many as there are vertices; wood is whole there, too. */
enum bench_collapse_kind { BENCH_COLLAPSE_PRINTED, BENCH_COLLAPSE_SOLID, BENCH_COLLAPSE_SECTORS,
	BENCH_COLLAPSE_SPLATS, BENCH_COLLAPSE_KINDS };
extern const char *const bench_collapse_kind_names[BENCH_COLLAPSE_KINDS];

/* Heights of the picture and shares of the leaves, for levels at distances. */
#define BENCH_COLLAPSE_SIZES 4u
#define BENCH_COLLAPSE_LEVELS 8u
extern const uint32_t bench_collapse_pixels[BENCH_COLLAPSE_SIZES];
#define BENCH_COLLAPSE_WEDGES 9u         /* sectors: the innermost, and eight wedges */

struct bench_collapse_level {    /* of half as many leaves as the one before */
	uint32_t a, b, c;
	uint64_t vertices;
	double q[BENCH_COLLAPSE_SIZES];
};
struct bench_collapse_q {
	uint32_t leaves, quads, roots, level_count;
	double seconds;              /* of processor time: forest and textures */
	double q[BENCH_COLLAPSE_KINDS][BENCH_SHARES];        /* at bench_shares of all vertices */
	double least;                /* share of all vertices that the coarsest level has */
	struct bench_collapse_level level[BENCH_COLLAPSE_LEVELS];
};

/* Takes the model over. Writes pictures NAME-*.png: atlas, levels, sectors from above. */
enum eco_code bench_collapse_measure(struct bench *bench, const char *name, struct bench_collapse_q *q,
	struct eco_model *model, struct eco_error *error);

#endif
