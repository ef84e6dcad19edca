/* Bytes to elements, in draw order. Each stored row is written straight to its place in draw order:
 * nothing is copied twice, as decoding is where a client is slowest. */
#include "ecofiles/format/chunk/chunk.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk_payload.h"

#define BAD(...) eco_fail(error, ECO_DAMAGED, __VA_ARGS__)

/* Checks the declared counts before anything is allocated from them. */
static enum eco_code check_expected(const struct eco_list *list, const struct eco_chunk *chunk,
	size_t size_bytes, struct eco_error *error)
{
	const char *fault = eco_list_coding_fault(list);
	if (fault)
		return BAD("list: %s", fault);
	if (list->coder == ECO_CODER_BYTES)
		return eco_fail(error, ECO_UNSUPPORTED, "chunk: a file has no elements to decode");
	if (chunk->element_count < 1 || chunk->element_count > ECO_CHUNK_ELEMENTS_MAX)
		return BAD("chunk: %u elements are not in 1..%u",
			chunk->element_count, ECO_CHUNK_ELEMENTS_MAX);
	if (size_bytes != chunk->size_bytes || size_bytes > ECO_CHUNK_BYTES_MAX)
		return BAD("chunk: %zu bytes instead of %u", size_bytes, chunk->size_bytes);
	return ECO_OK;
}

/* Bounds a SHAPES payload, which declares no counts, by the chunk's record. A fan of n corners has n - 2
 * primitives. */
static enum eco_code check_shapes(const struct eco_chunk *chunk, const struct eco_payload *payload,
	uint32_t *corner_count, struct eco_error *error)
{
	const uint64_t elements = chunk->element_count, most = (ECO_CORNERS_MAX - 2) * elements;
	if (payload->coder != ECO_CODER_SHAPES || chunk->primitive_count < elements
			|| chunk->primitive_count > most)
		return BAD("chunk: %u leaves cannot have %u triangles",
			chunk->element_count, chunk->primitive_count);
	*corner_count = (uint32_t)(chunk->primitive_count + 2 * elements);
	return ECO_OK;
}

/* Checks that the payload is of the list's kind and declares the chunk's counts; *corner_count receives
 * the corners of all elements. */
static enum eco_code check_payload(const struct eco_list *list, const struct eco_chunk *chunk,
	const struct eco_payload *payload, uint32_t *corner_count, struct eco_error *error)
{
	bool plain_mesh = list->coder == ECO_CODER_MESH && payload->coder == ECO_CODER_ELEMENTS;
	bool mesh = list->coder == ECO_CODER_MESH && !plain_mesh;
	uint64_t elements = 0, corners = 0, primitives = 0;
	if (payload->coder == ECO_CODER_SHAPES && list->coder == ECO_CODER_ELEMENTS
			&& list->kind == ECO_LIST_TRIANGLES)
		return check_shapes(chunk, payload, corner_count, error);
	if (payload->coder != list->coder && !plain_mesh)
		return BAD("chunk: coder %u in a list of coder %u", payload->coder, list->coder);
	if (list->coder == ECO_CODER_FORM && payload->stream_count != 1)
		return BAD("chunk: forms of %u corner counts, where all should "
			"have one", payload->stream_count);
	for (uint32_t i = 0; i < payload->stream_count; i++) {
		const struct eco_stream *s = &payload->streams[i];
		bool side = mesh && s->corners == 1;
		bool allowed = side ? (list->attributes != 0) : eco_list_allows_corners(list, s->corners);
		if (!allowed || (mesh && (s->predictors > side || (s->zeros != 0 && !side)))
				|| (s->shift != 0
				&& (mesh || payload->coder == ECO_CODER_KD || payload->coder == ECO_CODER_ROWS))
				|| (s->uv_shift != 0 && (mesh || !(list->attributes & ECO_ATTR_UV))))
			return BAD("chunk: stream %u of %u corners does not belong "
				"to the list", i, s->corners);
		if (side)
			continue;
		elements += s->elements;
		corners += (uint64_t)s->elements * s->corners;
		primitives += (uint64_t)s->elements * eco_corners_primitives(s->corners);
	}
	if (elements != chunk->element_count || primitives != chunk->primitive_count)
		return BAD("chunk: %llu elements and %llu primitives instead of %u "
			"and %u", (unsigned long long)elements, (unsigned long long)primitives,
			chunk->element_count, chunk->primitive_count);
	if (mesh && (payload->stream_count != (list->attributes != 0 ? 2u : 1u)
	    || payload->streams[0].elements != payload->streams[payload->stream_count - 1].elements))
		return BAD("chunk: attributes of the mesh are missing");
	*corner_count = (uint32_t)corners;
	return ECO_OK;
}

static enum eco_code allocate(const struct eco_list *list, const struct eco_chunk *chunk,
	uint32_t corner_count, struct eco_elements *elements, struct eco_error *error)
{
	elements->element_count = chunk->element_count;
	elements->primitive_count = chunk->primitive_count;
	elements->corner_count = corner_count;
	elements->extra_count = eco_list_extra_count(list);
	elements->corners = malloc(chunk->element_count);
	elements->position = malloc(sizeof(int32_t) * 3 * corner_count);
	if (list->attributes & ECO_ATTR_UV)
		elements->uv = malloc(sizeof(int32_t) * 2 * corner_count);
	if (elements->extra_count > 0)
		elements->extra = malloc(sizeof(int32_t) * elements->extra_count * chunk->element_count);
	if (!elements->corners || !elements->position || ((list->attributes & ECO_ATTR_UV) && !elements->uv)
	    || (elements->extra_count > 0 && !elements->extra))
		return eco_fail(error, ECO_NO_MEMORY, "chunk: out of memory for %u corners", corner_count);
	return ECO_OK;
}

struct place { uint32_t element, corner; };

/* Maps each stored row to its element in draw order and that element's first corner. On entry `corner`
 * holds each row's number of corners. */
static bool find_places(struct place *places, bool permuted, uint32_t ordinal, uint32_t row_count)
{
	uint32_t *order = malloc(row_count * sizeof *order);
	uint32_t corner = 0;
	if (!order)
		return false;
	if (permuted)
		eco_chunk_permutation(ordinal, row_count, order);
	for (uint32_t i = 0; i < row_count; i++) {
		struct place *place = &places[permuted ? order[i] : i];
		uint32_t corners = place->corner;
		*place = (struct place){ i, corner };
		corner += corners;
	}
	free(order);
	return true;
}

static enum eco_code decode_stream(const struct eco_list *list, const struct eco_payload *payload,
	const struct eco_stream *stream, const struct place *places, struct eco_elements *elements,
	struct eco_error *error)
{
	struct eco_chunk_rows rows;
	enum eco_code code = eco_rows_make(&rows, list, payload->coder, stream, error);
	code = code ? code : eco_rows_decode(&rows, error);
	for (uint32_t i = 0; code == ECO_OK && i < stream->elements; i++) {
		size_t corner = places[i].corner, element = places[i].element;
		struct eco_rows_element row = {
			elements->position + 3 * corner,
			rows.uv ? elements->uv + 2 * corner : NULL,
			rows.extra_count > 0 ? elements->extra + rows.extra_count * element : NULL,
		};

		if (!eco_rows_get(&rows, i, &row))
			code = BAD("chunk: a value of stored row %u is out of bounds", i);
		elements->corners[element] = stream->corners;
	}
	eco_rows_free(&rows);
	return code;
}

static enum eco_code decode_streams(const struct eco_list *list, const struct eco_payload *payload,
	uint32_t ordinal, struct eco_elements *elements, struct eco_error *error)
{
	bool permuted = list->coder == ECO_CODER_ELEMENTS || list->coder == ECO_CODER_FORM
		|| list->coder == ECO_CODER_KD;
	uint32_t row_count = elements->element_count, row = 0;
	struct place *places = malloc(row_count * sizeof *places), *next = places;
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; places && i < payload->stream_count; i++)
		for (uint32_t k = 0; k < payload->streams[i].elements; k++)
			places[row++].corner = payload->streams[i].corners;
	if (!places || !find_places(places, permuted, ordinal, row_count))
		code = eco_fail(error, ECO_NO_MEMORY, "chunk: out of memory for the order of %u elements",
			row_count);
	for (uint32_t i = 0; code == ECO_OK && i < payload->stream_count; i++) {
		code = decode_stream(list, payload, &payload->streams[i], next, elements, error);
		next += payload->streams[i].elements;
	}
	free(places);
	return code;
}

/* ---- Shapes ---- */

/* Moves element i of `stored` to where places[i] says. */
static void put_in_order(const struct eco_elements *stored, const struct place *places,
	struct eco_elements *elements)
{
	size_t from = 0, extra = elements->extra_count;
	for (uint32_t i = 0; i < stored->element_count; i++) {
		size_t corners = stored->corners[i], corner = places[i].corner, element = places[i].element;
		elements->corners[element] = stored->corners[i];
		memcpy(elements->position + 3 * corner, stored->position + 3 * from,
			3 * corners * sizeof *stored->position);
		if (stored->uv)
			memcpy(elements->uv + 2 * corner, stored->uv + 2 * from,
				2 * corners * sizeof *stored->uv);
		if (extra)
			memcpy(elements->extra + extra * element, stored->extra + extra * i,
				extra * sizeof *stored->extra);
		from += corners;
	}
}

/* An element's number of corners is known when it is decoded, its place only when all are: so elements are
 * moved once. */
static enum eco_code decode_shapes(const struct eco_list *list, const struct eco_chunk *chunk,
	const struct eco_payload *payload, uint32_t ordinal, struct eco_elements *elements,
	struct eco_error *error)
{
	struct place *places = malloc(chunk->element_count * sizeof *places);
	struct eco_elements stored = { 0 };
	enum eco_code code = allocate(list, chunk, elements->corner_count, &stored, error);
	if (code == ECO_OK && !places)
		code = eco_fail(error, ECO_NO_MEMORY, "chunk: out of memory for the order of %u elements",
			chunk->element_count);
	code = code ? code : eco_shapes_decode(list, &payload->streams[0], &stored, error);
	for (uint32_t i = 0; code == ECO_OK && i < chunk->element_count; i++)
		places[i].corner = stored.corners[i];
	if (code == ECO_OK && !find_places(places, true, ordinal, chunk->element_count))
		code = eco_fail(error, ECO_NO_MEMORY, "chunk: out of memory for the order of %u elements",
			chunk->element_count);
	if (!code)
		put_in_order(&stored, places, elements);
	eco_elements_free(&stored);
	free(places);
	return code;
}

enum eco_code eco_chunk_decode(const struct eco_list *list, const struct eco_chunk *chunk, uint32_t ordinal,
	const uint8_t *bytes, size_t size_bytes, struct eco_elements *elements, struct eco_error *error)
{
	struct eco_payload payload;
	uint32_t corner_count = 0;
	memset(elements, 0, sizeof *elements);
	enum eco_code code = check_expected(list, chunk, size_bytes, error);
	code = code ? code : eco_payload_read(&payload, bytes, size_bytes, error);
	if (!code && eco_payload_alone(&payload))
		payload.streams[0].elements = chunk->element_count;
	code = code ? code : check_payload(list, chunk, &payload, &corner_count, error);
	code = code ? code : allocate(list, chunk, corner_count, elements, error);
	if (!code)
		code = payload.coder == ECO_CODER_SHAPES ? decode_shapes(list, chunk, &payload, ordinal,
			elements, error)
			: payload.coder == ECO_CODER_MESH ? eco_mesh_decode(list, &payload, elements, error)
			: decode_streams(list, &payload, ordinal, elements, error);
	if (code)
		eco_elements_free(elements);
	return code;
}
