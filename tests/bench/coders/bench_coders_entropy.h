/* Zero-order entropy of columns over many chunks: what a simple coder would take with perfect tables. */
#ifndef TESTS_BENCH_CODERS_ENTROPY_H
#define TESTS_BENCH_CODERS_ENTROPY_H

#include "tests/bench/coders/bench_coders_rows.h"

/* What a column is of. */
enum coders_part { CODERS_POSITION, CODERS_CORNERS, CODERS_TEXTURE, CODERS_COLOR, CODERS_WIDTH, CODERS_PLANT,
	CODERS_TILE, CODERS_YAW, CODERS_SCALE, CODERS_GROWTH, CODERS_SIZE, CODERS_AXES_OF, CODERS_TURN,
	CODERS_OPACITY, CODERS_PARTS };
extern const char *const coders_part_names[CODERS_PARTS];
enum coders_part coders_part_of(const struct eco_list *list, uint32_t corners, uint32_t column);

struct coders_values { int32_t *at; size_t count, room; };
/* Values of columns, by number of corners, and their differences from row to row of a chunk. */
struct coders_entropy {
	struct coders_values plain[ECO_CORNERS_MAX + 1][CODERS_COLUMNS_MAX],
		step[ECO_CORNERS_MAX + 1][CODERS_COLUMNS_MAX];
	uint8_t part[ECO_CORNERS_MAX + 1][CODERS_COLUMNS_MAX];
};
/* Adds a chunk's rows in the order in which they stand; the first row's step is from the least of all. False:
 * out of memory. */
bool coders_entropy_add(struct coders_entropy *entropy, const struct eco_list *list,
	const struct coders_set *set);
/* Bits of all by part: of values or of steps, as is less. A part of few different values has their entropy,
 * any other that of its sizes, and the bits below the highest as they are. */
void coders_entropy_bits(struct coders_entropy *entropy, double bits[CODERS_PARTS]);
void coders_entropy_free(struct coders_entropy *entropy);

#endif
