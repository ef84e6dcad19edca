/* A chunk's elements as rows of the integers that are stored, and the coders that are tried on them.
 *
 *   coders_rows_take(set, list, chunk, ordinal, bytes, &error);      a table for each number of corners
 *   size = coders_known_meshopt(set, &decode_ns);            bytes of the chunk by another coder
 *   coders_set_free(set);
 *
 * Columns of a row: the first corner (3), the other corners less the first (3 each), texture coordinates (2 a
 * corner), the extra values. Elements on the finer grid (ECO_EXACT_SHIFT) are rounded to the list's own,
 * as all coders but SHAPES would store them. */
#ifndef TESTS_BENCH_CODERS_ROWS_H
#define TESTS_BENCH_CODERS_ROWS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/base/status.h"
#include "ecofiles/format/chunk/chunk.h"

#define CODERS_COLUMNS_MAX 48u
#define CODERS_TABLES_MAX 4u
#define CODERS_AXES 3u
#define CODERS_DEPTH_MAX 20u     /* bits of a coordinate */
#define CODERS_FRAME_BYTES 5u    /* a chunk's head, as of packed rows (chunk.h) */
#define CODERS_RECORD_BYTES 12u  /* a stream's record, of coders that need one */

/* `values` row by row; the last `known` of `columns` are known before decoding (a splat's parent). */
struct coders_table { uint32_t rows, columns, known, corners; int32_t *values; };

/* Tables in the stored order of their rows. */
struct coders_set { struct coders_table tables[CODERS_TABLES_MAX]; uint32_t count; };

enum eco_code coders_rows_take(struct coders_set *set, const struct eco_list *list,
	const struct eco_chunk *chunk, uint32_t ordinal, const uint8_t *bytes, struct eco_error *error);
/* Appends the rows of `from` to those of `to` with as many columns. False: out of memory. */
bool coders_set_append(struct coders_set *to, const struct coders_set *from);
void coders_set_free(struct coders_set *set);

/* Rows along a Morton curve of their first corners; false: a coordinate has too many bits, or no memory. */
bool coders_table_sort(struct coders_table *table);
/* The least of each coordinate, and the bits that the largest span takes. */
uint32_t coders_table_box(const struct coders_table *table, int32_t low[CODERS_AXES]);

/* Processor time of this thread, nanoseconds. */
double coders_now_ns(void);

/* ---- Coders: each returns bytes with its frame; SIZE_MAX where it cannot code the rows. *ns is the time of
 * decoding them, the best of a few. ---- */

size_t coders_known_draco_kd(const struct coders_set *set, double *ns);
/* Rows along a Morton curve, each column as values or as differences, as is smaller. */
size_t coders_known_draco_sequential(const struct coders_set *set, double *ns);
/* Meshoptimizer's vertex codec, then zstd at level 19, of rows along a Morton curve. */
size_t coders_known_meshopt(const struct coders_set *set, double *ns);
/* Triangles: corners welded, indices and vertices by meshoptimizer, then zstd. */
size_t coders_known_mesh(const struct coders_set *set, double *ns);

enum coders_places {
	CODERS_OCTREE,               /* occupancy, a point alone in its cell in plain bits */
	CODERS_COUNTS,               /* halves of a kd-tree: how many points lie in the lower */
	CODERS_ORDERED               /* coordinates as other columns, in stored order */
};
/* Adaptive range coder. bits: added to, per column (the first corner's under column 0); or NULL. Checks that
 * decoding gives the same rows: *good is false where it does not, and left alone otherwise. */
size_t coders_own(const struct coders_set *set, enum coders_places places, double *bits, double *ns,
	bool *good);

/* ---- Parts of coders_own: like eco_range, each writes or reads. ---- */

struct eco_range;
/* First corners; reading, rows come in the order in which writing has put them. False: out of memory. */
bool coders_code_octree(struct eco_range *range, struct coders_table *table);
bool coders_code_counts(struct eco_range *range, struct coders_table *table);
/* One number, as likely large as small. */
int32_t coders_code_plain(struct eco_range *range, int32_t value);
/* A column, in the best of several ways. coded: bits of the columns that are known by now. */
void coders_code_column(struct eco_range *range, struct coders_table *table, uint32_t column, uint64_t coded);

#endif
