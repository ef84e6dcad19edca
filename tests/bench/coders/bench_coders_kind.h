/* Lists of a kind in a pack, by all coders. */
#ifndef TESTS_BENCH_CODERS_KIND_H
#define TESTS_BENCH_CODERS_KIND_H

#include <jansson.h>

#include "ecofiles/format/pack.h"
#include "tests/bench/coders/bench_coders_entropy.h"
#include "tests/bench/coders/bench_coders_rows.h"

enum coders_kind { CODERS_INSTANCES, CODERS_SUMMARIES, CODERS_SPLATS, CODERS_POINTS, CODERS_LINES,
	CODERS_LEAVES, CODERS_SIMPLE, CODERS_WOOD, CODERS_GROUND, CODERS_KINDS };
extern const char *const coders_kind_names[CODERS_KINDS];

enum coders_coder { CODERS_STORED, CODERS_ENTROPY, CODERS_KD, CODERS_SEQUENTIAL, CODERS_MESHOPT,
	CODERS_BY_OCTREE, CODERS_BY_COUNTS, CODERS_BY_ORDER, CODERS_CODERS };
extern const char *const coders_names[CODERS_CODERS];

bool coders_kind_has(enum coders_kind kind, const struct eco_list *list);

struct coders_figures {
	uint64_t chunks, primitives;
	/* bytes of the chunks, of each list as one chunk, nanoseconds of decoding; NaN where a coder does not
	 * fit the kind */
	double bytes[CODERS_CODERS], whole[CODERS_CODERS], ns[CODERS_CODERS];
	/* bits: entropy of all; by counts and in stored order, of `parted` primitives (chunks that keep their
	 * order are not among them) */
	double entropy[CODERS_PARTS], part[2][CODERS_PARTS];
	uint64_t parted;
};

/* Of every `step`-th list of the kind. */
enum eco_code coders_kind_measure(struct coders_figures *figures, const struct eco_pack *pack,
	enum coders_kind kind, uint32_t step, struct eco_error *error);

/* The ladder whose splats are the list; NULL: none. */
const struct eco_ladder *coders_splat_ladder(const struct eco_scene *scene, uint32_t list);
/* Rows of a chunk that begins at splat `first`, less their parents', which become known columns. `whole`: all
 * of the list. False: no memory. */
bool coders_splat_rows(struct coders_set *set, const struct coders_set *whole,
	const struct eco_ladder *ladder, uint32_t first);
/* Ground samples as the misses of what chunk_rows.h predicts; known: how large those beside are. */
bool coders_ground_rows(struct coders_set *set, uint32_t columns);

#endif
