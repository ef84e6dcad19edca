/* A chunk's payload: elements <-> bytes. One coder for each kind of list: rows of columns, leaves as placed
 * shapes, connected wood by Draco's edgebreaker.
 *
 * Payload (all little-endian). BYTES: the file itself. Everything else:
 *   0   u8   1; 3 in the low 2 bits: rows of one stream, below
 *   1   u8   coder (enum eco_coder)
 *   2   u8   stream count s: 2..4; MESH 1 or 2; SHAPES 0
 *   3   u8   0, or the bytes left off at the end (SHAPES)
 *   4   s *  { u8 corners, u8 flags, u8 the bytes left off at the end, u16 predictors, u32 elements, u32 bytes }
 *            corners ascending
 *   .   s streams, in that order, nothing after them
 * Rows of one stream, all of a chunk of FORM, KD or ROWS, and of ELEMENTS with one number of corners:
 *   0   u8   3 + 4 coder + 32 corners     1   u8   the bytes left off at the end
 *   2   u8   flags; then u16 predictors if corners > 2; then the stream
 *
 * A stream is range-coded: its columns (chunk_columns.h), or of ground its samples, with flags 0. Flags: bit
 * 0 is 0, bits 1 to 3 `shift`, bits 4 to 7 `uv_shift`.
 *   ELEMENTS  one row an element of that many corners; columns, flags and predictors as in chunk_rows.h
 *   FORM      as ELEMENTS, but the rows are in the stored order of the partner's chunk
 *   ROWS      corners = 1; predictors 0; split columns, but of instances
 *   KD        corners = 1; predictors 0
 *   MESH      corners = 3: the triangles' positions, by edgebreaker. Where the list has COLOR or UV, a stream
 *             of corners = 1 comes before it: one row a triangle in the order that the mesh decodes to;
 *             columns: if predictors is 1 the part of the triangle, less that of the last one: parts follow
 *             each other in draw order, triangles of a part as they decode; uv of each corner (2 values, less
 *             the last uv of the corner's vertex, or else the last uv of all), then the extra values (1 each);
 *             flags 0
 *   SHAPES    no stream records (s = 0). The rest, followed by as many zeros as byte 3 says, is one
 *             range-coded stream of all elements in the stored order of ELEMENTS, read by
 *             eco_shapes_code_head and eco_shapes_code_leaf (chunk_shapes.c). It begins with a table of
 *             shapes. A placed element has its shape's number, its turn, its lengths, the step to its first
 *             corner along the curve, and its extra values. Any other element has its corners, each one
 *             either a corner that was there before or the miss of a prediction, and texture coordinates.
 *             shape.h and chunk_shapes.h define the values.
 *
 * A chunk of an ELEMENTS list of triangles has coder SHAPES where that is smaller. A chunk of a MESH list has
 * coder ELEMENTS (corners = 3, drawn in stored order, which is that of parts) where edgebreaker would lose or
 * alter a triangle, or is larger.
 *
 * A small payload can claim to be huge. So before Draco sees a byte, sizes and counts must match the
 * caller's (from the hashed list and chunk records), each Draco header must have the version, method and
 * flags that our encoder writes, and its counts must equal the declared ones. Check that a payload's hash
 * is its id before eco_chunk_decode. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "ecofiles/format/list.h"

#define ECO_CHUNK_ELEMENTS_MAX (1u << 20)
#define ECO_CHUNK_BYTES_MAX (1u << 26)

/* Encodes elements [first, end) of `elements` as chunk number `ordinal` of `list` (kind, coder and
 * attributes must be set). ELEMENTS and KD sort inside the chunk (by corner count, then Morton; small
 * chunks at the start of a list keep their order, see chunk_encode.c) and the decoder permutes, so
 * decoding gives a permutation of the input. Not for FORM. *bytes is malloc'ed. */
struct eco_chunk_input {
	const struct eco_list *list;
	const struct eco_elements *elements;
	uint32_t first, end, ordinal;
};
enum eco_code eco_chunk_encode(const struct eco_chunk_input *input, uint8_t **bytes, size_t *size_bytes,
	struct eco_error *error);

/* Sets end - first indices: order[i] is the input index, relative to first, of the i-th decoded element. Only for
 * ELEMENTS, and for ROWS, which keep the input's order: the coders KD and MESH decide theirs. Elements that are
 * encoded in this order are decoded in it, but for those whose first corners are the same. */
enum eco_code eco_chunk_order(const struct eco_chunk_input *input, uint32_t *order, struct eco_error *error);

/* Whether elements [first, end) as a chunk of coder ELEMENTS are decoded in the order of the input, if all
 * have the same number of corners. */
bool eco_chunk_keeps_order(uint32_t first, uint32_t end);

/* Encodes another form of the partner's elements [first, end). `partner` is the input that the partner's
 * chunk was encoded from, `list` the form's list (coder FORM). Element i of `forms` is the form of the
 * partner's INPUT element i; all have the same number of corners (1 for points, 2 for lines, 3 or 4 for
 * triangles). Decoded, element i of the form's chunk belongs to element i of the partner's. Any number of
 * forms may share a partner; each is encoded and decoded without the others. */
enum eco_code eco_chunk_encode_form(const struct eco_chunk_input *partner, const struct eco_list *list,
	const struct eco_elements *forms, uint8_t **bytes, size_t *size_bytes, struct eco_error *error);

/* Decodes one payload. `chunk` gives the expected counts and size; `ordinal` the permutation. Fails with
 * ECO_DAMAGED and leaves *elements empty. Positions, uv and extra values of decoded elements are within
 * +-(2^28 - 1). Memory used is at most about 200 bytes a declared corner, and 10 MB for tables. */
enum eco_code eco_chunk_decode(const struct eco_list *list, const struct eco_chunk *chunk, uint32_t ordinal,
	const uint8_t *bytes, size_t size_bytes, struct eco_elements *elements, struct eco_error *error);

/* Fills order[0..count) with the seeded permutation of a chunk: draw position i shows stored element
 * order[i]. */
void eco_chunk_permutation(uint32_t ordinal, uint32_t count, uint32_t *order);

struct eco_chunk_id eco_chunk_hash(const uint8_t *bytes, size_t size_bytes);

/* Chooses chunk ends: fills ends[] with element indices. Chunks start at `smallest` elements and grow with
 * the elements already sent: a first picture soon, then little overhead. Returns the count, at most `max`. */
uint32_t eco_chunk_split(uint32_t element_count, uint32_t smallest, uint32_t *ends, uint32_t max);
