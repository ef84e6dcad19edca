/* A chunk's payload: elements <-> bytes, through Draco.
 *
 * Payload (all little-endian). BYTES: the file itself. Everything else:
 *   0   u8   1 (version)
 *   1   u8   coder (enum eco_coder)
 *   2   u8   stream count s, 1..4, or 0 (SHAPES)
 *   3   u8   0, or the bytes left off at the end (SHAPES)
 *   4   s *  { u8 corners, u8 flags, u16 predictors, u32 elements, u32 bytes }    corners ascending
 *   .   s Draco bitstreams, in that order, nothing after them
 *
 * What a stream holds (flags: bit 0 `wide`, bits 1 to 3 `shift`, bits 4 to 7 `uv_shift`):
 *   ELEMENTS  one row an element of that many corners; columns, flags and predictors as in chunk_rows.h
 *   FORM      one stream; as ELEMENTS, but the rows are in the stored order of the partner's chunk
 *   KD, ROWS  one stream, corners = 1; flags (KD: never wide), predictors 0; ROWS: split columns
 *   MESH      corners = 3: the triangles' positions, by edgebreaker. Where the list has COLOR or UV, before it corners = 1: one row
 *             a triangle in the order that the mesh decodes to; columns uv of each corner (2 values, less the uv that the
 *             corner's vertex had when it was last seen, or else the last uv), then the extra values (1 each, difference to the
 *             row before); flags and predictors 0.
 *   SHAPES    no stream records (s = 0): the rest, followed by as many zeros as byte 3 says, is one range-coded stream of all elements
 *             in stored order, as of ELEMENTS, read by eco_shapes_code_head and eco_shapes_code_leaf (chunk_shapes.c): a table of
 *             shapes, then for each element which shape it is, how it is turned, its lengths, the step to its first corner along the
 *             curve, its extra values; or that it is none, and its corners, each one that was there before or what is left after a
 *             prediction, and texture coordinates. What the values mean is in shape.h and chunk_corners.h.
 * A chunk of an ELEMENTS list of triangles may say coder SHAPES: it does where that is smaller. A chunk of a MESH list may say coder
 * ELEMENTS: one stream of corners = 3, drawn in stored order. It does where edgebreaker would lose or alter a triangle, or is larger.
 *
 * Decoding is a bomb by nature. Before Draco sees a byte: sizes and counts must match what the caller expects (from the hashed
 * list and chunk records), each Draco header must be the version, method and flags that our encoder writes, and its own counts
 * must equal the declared ones. A payload whose hash is not its id must not reach eco_chunk_decode. */
#ifndef ECO_CHUNK_H
#define ECO_CHUNK_H

#include <stddef.h>
#include <stdint.h>

#include "ecofiles/format/list.h"

#define ECO_CHUNK_ELEMENTS_MAX (1u << 20)
#define ECO_CHUNK_BYTES_MAX (1u << 26)

/* Encodes elements [first, end) of `elements` as chunk number `ordinal` of `list` (kind, coder and attributes must be set). ELEMENTS
 * and KD sort inside the chunk (corner count, then Morton; but small chunks at the start of a list keep their order, see chunk_encode.c)
 * and the decoder permutes, so what comes back is a permutation of what
 * went in. `order`, if not NULL, receives end - first indices: order[i] is the input index, relative to first, of the i-th element
 * that decoding will give (for KD and MESH, whose order Draco decides, it must be NULL). Not for FORM. *bytes is malloc'ed. */
struct eco_chunk_input {
	const struct eco_list *list;
	const struct eco_elements *elements;
	uint32_t first, end, ordinal;
};
enum eco_code eco_chunk_encode(const struct eco_chunk_input *input, uint8_t **bytes, size_t *size_bytes, uint32_t *order,
	struct eco_error *error);

/* Encodes another form of elements [first, end) of the partner: `partner` is the input that the partner's chunk was encoded from, `list`
 * the form's (coder FORM), and element i of `forms` the form of the partner's INPUT element i, all with the same number of corners (1
 * for points, 2 for lines, 3 or 4 for triangles). Decoded, element i of the form's chunk belongs to element i of the partner's. Any
 * number of forms may share a partner; each is encoded and decoded without the others. */
enum eco_code eco_chunk_encode_form(const struct eco_chunk_input *partner, const struct eco_list *list,
	const struct eco_elements *forms, uint8_t **bytes, size_t *size_bytes, struct eco_error *error);

/* Decodes one payload. `chunk` gives the expected counts and size; `ordinal` the permutation. Fails with ECO_DAMAGED and leaves
 * *elements empty. Positions, uv and extra values of decoded elements are within +-(2^28 - 1). Memory used is at most about 200
 * bytes a declared corner, and 10 MB for tables. */
enum eco_code eco_chunk_decode(const struct eco_list *list, const struct eco_chunk *chunk, uint32_t ordinal,
	const uint8_t *bytes, size_t size_bytes, struct eco_elements *elements, struct eco_error *error);

/* Fills order[0..count) with the seeded permutation of a chunk: draw position i shows stored element order[i]. */
void eco_chunk_permutation(uint32_t ordinal, uint32_t count, uint32_t *order);

struct eco_chunk_id eco_chunk_hash(const uint8_t *bytes, size_t size_bytes);

/* Where to end chunks: fills ends[] with element indices so that chunk sizes start at `smallest` elements and grow with what was
 * already sent: a first picture soon, then chunks that cost little each. Returns the count; at most `max`. */
uint32_t eco_chunk_split(uint32_t element_count, uint32_t smallest, uint32_t *ends, uint32_t max);

#endif
