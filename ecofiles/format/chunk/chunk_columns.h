/* Columns of rows in one adaptively coded stream (ecofiles/base/range.h): in chunks of few rows tables of
 * symbols would take more bytes than the rows.
 *
 * Component by component, columns in the order of chunk_rows.h (of a kd-tree without positions, which come
 * first, as said below), each with a head:
 *   3 bits   way: VALUES 0, DIFFERENCES 1, STEPS 2, RECENT 3, GIVEN 4
 *   number   the first row, of DIFFERENCES and STEPS: their other rows are coded as the difference to the row
 *            before
 *   7 bits   of GIVEN: an earlier component
 *   3 bits   n: the highest 2n bits of a field are modelled, those below are as good as random
 *   6 bits   b: fields lie in [low, low + 2^(b + s)), b + s <= 32
 *   1 bit    0: s is 0; 1: 4 bits, s: low bits that are 0 in every field less low, and not coded
 *   1 bit    0: low is 0; 1: a number, low
 * (of STEPS only way and first row), then the rows: VALUES and DIFFERENCES a field each, less low in b bits.
 * STEPS: eco_range_number. RECENT: how many other values came since this one came last, at most 64; where it
 * is none of them, as many as there are, and a field. GIVEN: a field with models of its own for each of the
 * first 15 values of the earlier component. A number is 6 bits n <= 32, then n bits of its zigzag code. Sums
 * and differences are modulo 2^32, so every row comes back as it was. At the end stand the 8 bits 0xa5: what
 * is cut off reads as zeros, and zeros could be rows. */
#pragma once

#include "ecofiles/base/range.h"
#include "ecofiles/format/chunk/chunk_rows.h"

/* Encodes the columns as they stand in rows->columns; sets the stream's bytes, size and zeros. Rows of a
 * kd-tree are put into the order in which they are decoded. Without memory it ends the program (memory.h). */
void eco_columns_encode(struct eco_chunk_rows *rows, struct eco_stream *stream);
/* Fills rows->columns from rows->stream. ECO_DAMAGED where bytes are not as written. */
enum eco_code eco_columns_decode(struct eco_chunk_rows *rows, struct eco_error *error);

/* Samples of ground in one adaptively coded stream (ecofiles/base/range.h): the rows of a chunk of
 * ground, whose samples stand in rows and columns.
 *
 *   s  x of the first row, then y of the first column: each the difference to the step before
 *   4  bits, s: low bits of heights, which are mostly 0: coarse ground is rounded, but for its border
 *   then a sample after the other, row by row:
 *      1 bit, modelled by how near the border is, where s > 0: are any of its low bits set? if so, these
 *      the miss of its height without them, less a prediction: eco_range_near, a kind for each size of the
 *      misses beside it
 *   8  bits 0xa5, as above
 *
 * The prediction is the mean of several that continue the samples before it, west and north ("north": in the
 * row before), each with the weight 1 / (1 + e)^2, e: the sum of its misses at the six samples beside (as
 * Meyer and Tischer, TMW, 1997, blend predictions, in integers). lod/EXPERIMENTS.md, Ground by its
 * neighbours, says what this saves. */

/* The same of ground, whose samples stand in rows and columns: sets rows->stream. */
void eco_ground_encode(struct eco_chunk_rows *rows);
enum eco_code eco_ground_decode(struct eco_chunk_rows *rows, struct eco_error *error);

/* Positions of points whose order is free, by how many of them lie in each half of a cell (Devillers and
 * Gandoin 2000, "Geometric compression for interactive transmission").
 *
 * For each axis 5 bits, the bits b of its coordinates, and the least coordinate, a number as
 * above; then the root cell of all points, which has b bits left along each axis:
 *   one point, or no bits left   each axis of each point: the bits left, as they are
 *   else                         the axis with most bits left (of equals the first) is halved: how many of
 *                                the n points lie in the lower half; then the lower half, then the upper
 *                                one, where there are points in them
 * A count up to 16 points is a tree of 5 bits, with models for each n and axis that begin as if three tenths
 * of the cells had any count and the others a binomial one, and count as 6 seen: a chunk of a dozen points
 * has no time to learn. A larger n of m bits: floor(count 2^m / (n + 1)) as a field of m bits, 3 modelled. */

/* Places of plants: instances keep their order, but what is in the order of cells takes fewer bits.
 *
 *   for x and y: 5 bits, s: low bits that are 0 in all less the least; 5 bits, b: others; the least, a number
 *   then runs of rows in the order of cells, as long as each is (eco_order_cells): how many rows it has less
 *   1 (eco_range_size, 5 bits), then x and y by counts, as above, from the cell of all rows on
 *   z of the first row, a number; of each other row the miss of a guess: eco_range_near. The guess is the
 *   plane through up to 128 rows before, each with the weight 1 / (1 + d^2), d: its distance in x and y
 *   1 bit   0: turns are those of eco_place_turn and not in a column; 1: they are
 *   then the other columns */
