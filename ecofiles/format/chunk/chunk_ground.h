/* Samples of ground in one adaptively coded stream (ecofiles/base/range.h): the packed rows of a chunk of
 * ground, whose samples stand in rows and columns.
 *
 *   s  x of the first row, then y of the first column: each the difference to the step before
 *   4  bits, s: low bits of heights, which are mostly 0: coarse ground is rounded, but for its border
 *   then a sample after the other, row by row:
 *      1 bit, modelled by how near the border is, where s > 0: are any of its low bits set? if so, these
 *      the miss of its height without them, less a prediction: eco_range_near, a kind for each size of the
 *      misses beside it
 *   8  bits 0xa5, as chunk_columns.h
 *
 * The prediction is the mean of several that continue the samples before it, west and north ("north": in the
 * row before), each with the weight 1 / (1 + e)^2, e: the sum of its misses at the six samples beside (as
 * Meyer and Tischer, TMW, 1997, blend predictions, in integers). lod/EXPERIMENTS.md, Ground by its
 * neighbours, says what this saves. */
#ifndef ECO_CHUNK_GROUND_H
#define ECO_CHUNK_GROUND_H

#include "ecofiles/format/chunk/chunk_rows.h"

/* Encodes the columns' values as they were put. *bytes: malloc'ed; *zeros: bytes left off at the end.
 * ECO_BAD_INPUT: samples do not stand in rows and columns. */
enum eco_code eco_ground_encode(const struct eco_chunk_rows *rows, uint8_t **bytes, size_t *size,
	uint8_t *zeros, struct eco_error *error);
/* Fills rows->columns. ECO_DAMAGED where bytes are not as written. */
enum eco_code eco_ground_decode(struct eco_chunk_rows *rows, const uint8_t *bytes, size_t size, uint8_t zeros,
	struct eco_error *error);

#endif
