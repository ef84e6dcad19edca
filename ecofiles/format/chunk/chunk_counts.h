/* Positions of points whose order is free, by how many of them lie in each half of a cell (Devillers and
 * Gandoin 2000, "Geometric compression for interactive transmission"). Private to chunk_columns.c.
 *
 * For each axis 5 bits, the bits b of its coordinates, and the least coordinate, a number as in
 * chunk_columns.h; then the root cell of all points, which has b bits left along each axis:
 *   one point, or no bits left   each axis of each point: the bits left, as they are
 *   else                         the axis with most bits left (of equals the first) is halved: how many of
 *                                the n points lie in the lower half; then the lower half, then the upper
 *                                one, where there are points in them
 * A count up to 16 points is a tree of 5 bits, with models for each n and axis that begin as if three tenths
 * of the cells had any count and the others a binomial one, and count as 6 seen: a chunk of a dozen points
 * has no time to learn. A larger n of m bits: floor(count 2^m / (n + 1)) as a field of m bits, 3 modelled. */
#ifndef ECO_CHUNK_COUNTS_H
#define ECO_CHUNK_COUNTS_H

#include "ecofiles/base/range.h"
#include "ecofiles/format/chunk/chunk_rows.h"

/* Writes or reads column 0, of 3 components. Writing puts all rows into the order in which they are read. */
void eco_counts_code(struct eco_range *range, struct eco_chunk_rows *rows);

#endif
