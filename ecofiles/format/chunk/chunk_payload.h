/* A payload's frame, shared by encoder and decoder: its streams and where they lie. The bytes are in
 * chunk.h. */
#ifndef ECO_CHUNK_PAYLOAD_H
#define ECO_CHUNK_PAYLOAD_H

#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/chunk/chunk_rows.h"

#define ECO_PAYLOAD_STREAMS_MAX 4u

struct eco_stream {
	uint8_t corners;
	bool wide;
	uint8_t uv_shift;
	uint8_t shift;               /* of positions */
	uint16_t predictors;
	bool packed;                 /* as chunk_columns.h says; then it is the only stream */
	uint8_t zeros;               /* SHAPES, packed: bytes at the end that are zero and not stored */
	uint32_t elements;           /* packed: eco_payload_read leaves it 0, the chunk's record says it */
	const uint8_t *bytes;        /* reading: within the payload; writing: malloc'ed */
	size_t size;
};

struct eco_payload {
	uint8_t coder;
	uint32_t stream_count;       /* SHAPES: 1, with only bytes, size and zeros set */
	struct eco_stream streams[ECO_PAYLOAD_STREAMS_MAX];
};

/* Parses and bounds everything except the streams' own bytes. */
enum eco_code eco_payload_read(struct eco_payload *payload, const uint8_t *bytes, size_t size,
	struct eco_error *error);
/* Writes the whole payload; *bytes is malloc'ed. */
enum eco_code eco_payload_write(const struct eco_payload *payload, uint8_t **bytes, size_t *size,
	struct eco_error *error);
void eco_payload_free_streams(struct eco_payload *payload);

/* Primitives of an element with so many corners. */
uint32_t eco_corners_primitives(uint8_t corners);
/* Whether elements of the list may have that many corners. */
bool eco_list_allows_corners(const struct eco_list *list, uint8_t corners);
/* Why kind, coder and attributes do not go together: "its kind is unknown"; NULL: they do. */
const char *eco_list_coding_fault(const struct eco_list *list);
/* Does a list's level mean something to its kind? */
bool eco_list_level_known(const struct eco_list *list);

struct eco_rows_shape eco_payload_shape(const struct eco_list *list, uint8_t coder,
	const struct eco_stream *stream);

/* SHAPES, in chunk_shapes.c. `elements` are in stored order; soup_bits: bits of an element stored as
 * corners. The stream's bytes are malloc'ed. */
struct eco_placed_element { uint32_t element; size_t corner_at; };
enum eco_code eco_shapes_encode(const struct eco_chunk_input *input,
	const struct eco_placed_element *elements, double soup_bits, struct eco_stream *stream,
	struct eco_error *error);
/* Fills the elements in stored order. Their counts say what is expected; their arrays are allocated. */
enum eco_code eco_shapes_decode(const struct eco_list *list, const struct eco_stream *stream,
	struct eco_elements *stored, struct eco_error *error);

/* MESH, in chunk_mesh.c. Encoding sets *fits to false, with ECO_OK, where edgebreaker does not give back
 * every triangle. */
enum eco_code eco_mesh_encode(const struct eco_list *list, const struct eco_elements *elements,
	uint32_t first, uint32_t end, struct eco_payload *payload, bool *fits, struct eco_error *error);
/* Fills position and, if the list has them, uv and extra of `elements`, whose arrays are allocated. */
enum eco_code eco_mesh_decode(const struct eco_list *list, const struct eco_payload *payload,
	struct eco_elements *elements, struct eco_error *error);

#endif
