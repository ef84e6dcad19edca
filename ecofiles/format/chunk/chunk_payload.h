/* A payload's frame, shared by encoder and decoder: its streams and where they lie. The bytes are in
 * chunk.h. */
#pragma once

#include "ecofiles/base/bytes.h"
#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/chunk/chunk_rows.h"

#define ECO_PAYLOAD_STREAMS_MAX 4u

struct eco_payload {
	uint8_t coder;
	uint32_t stream_count;       /* SHAPES: 1, with only bytes, size and zeros set */
	struct eco_stream streams[ECO_PAYLOAD_STREAMS_MAX];
};

/* Whether rows are the only stream, which has no record. */
static inline bool eco_payload_alone(const struct eco_payload *payload)
{
	return payload->stream_count == 1 && payload->coder != ECO_CODER_SHAPES && payload->coder != ECO_CODER_MESH;
}
/* Parses and bounds everything except the streams' own bytes. */
enum eco_code eco_payload_read(struct eco_payload *payload, const uint8_t *bytes, size_t size,
	struct eco_error *error);
/* Appends the whole payload; w->failed without memory. */
void eco_payload_write(const struct eco_payload *payload, struct eco_writer *w);
void eco_payload_free_streams(struct eco_payload *payload);

/* Primitives of an element with so many corners. */
uint32_t eco_corners_primitives(uint8_t corners);
/* Whether elements of the list may have that many corners. */
bool eco_list_allows_corners(const struct eco_list *list, uint8_t corners);
/* Why kind, coder and attributes do not go together: "its kind is unknown"; NULL: they do. */
const char *eco_list_coding_fault(const struct eco_list *list);
/* Does a list's level mean something to its kind? */
bool eco_list_level_known(const struct eco_list *list);

/* An element of an encoder's input, to be sorted into stored order. */
struct eco_stored {
	uint8_t corners;
	uint32_t key[3];             /* first corner relative to the chunk's least: small steps */
	int32_t part;                /* MESH: eco_elements.part, else 0 */
	uint32_t element;            /* relative to the input's first */
	size_t corner_at;            /* index of its first corner among all corners */
};

/* SHAPES, in chunk_shapes.c. `elements` are in stored order; soup_bits: bits of an element stored as
 * corners. The stream's bytes are malloc'ed. */
void eco_shapes_encode(const struct eco_chunk_input *input, const struct eco_stored *elements, double soup_bits,
	struct eco_stream *stream);
/* Fills the elements in stored order. Their counts say what is expected; their arrays are allocated. */
enum eco_code eco_shapes_decode(const struct eco_list *list, const struct eco_stream *stream,
	struct eco_elements *stored, struct eco_error *error);

/* MESH, in chunk_mesh.c. False: edgebreaker does not give back every triangle. */
bool eco_mesh_encode(const struct eco_chunk_input *input, struct eco_payload *payload);
/* Fills position and, if the list has them, uv and extra of `elements`, whose arrays are allocated. */
enum eco_code eco_mesh_decode(const struct eco_list *list, const struct eco_payload *payload,
	struct eco_elements *elements, struct eco_error *error);
