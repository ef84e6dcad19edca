/* Elements to bytes. The decoder permutes, so the order inside a chunk is free: elements are stored by
 * corner count and along a Morton curve, which makes the steps between first corners small (12 to 17 % of
 * the size).
 *
 * Small chunks at the start of a list are the exception: there the rows lie so that the decoder's
 * permutation gives the elements in input order, as far as their corner counts allow. Which of the first
 * hundred elements are drawn first matters much, and their bytes little (lod/EXPERIMENTS.md, Order in the
 * first chunks). */
#include "ecofiles/format/chunk/chunk.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk_columns.h"
#include "ecofiles/format/chunk/chunk_payload.h"

#define KEPT_FIRST 96u           /* a chunk that begins before this element keeps its order */
#define KEPT_MOST 64u            /* if it has at most so many elements */

/* An input element, to be sorted into stored order. */
struct stored {
	uint8_t corners;
	uint32_t key[3];             /* first corner relative to the chunk's least: small steps */
	uint32_t element;            /* relative to the input's first */
	size_t corner_at;            /* index of its first corner among all corners */
};

/* Compares along a Morton curve without interleaving bits: the axis whose highest differing bit is highest
 * decides (Chan 2002). */
static int compare_stored(const void *left, const void *right)
{
	const struct stored *a = left, *b = right;
	uint32_t difference = 0;
	int axis = -1;
	if (a->corners != b->corners)
		return a->corners < b->corners ? -1 : 1;
	for (int i = 0; i < 3; i++) {
		uint32_t d = a->key[i] ^ b->key[i];
		if (difference < d && difference < (difference ^ d)) {
			difference = d;
			axis = i;
		}
	}
	if (axis >= 0)
		return a->key[axis] < b->key[axis] ? -1 : 1;
	return a->element < b->element ? -1 : a->element > b->element;
}

static int compare_input(const void *left, const void *right)
{
	const struct stored *a = left, *b = right;
	if (a->corners != b->corners)
		return a->corners < b->corners ? -1 : 1;
	return a->element < b->element ? -1 : a->element > b->element;
}

/* Each row takes the next input element of its corner count, in the order in which the decoder draws the
 * rows. */
static enum eco_code keep_order(struct stored *stored, uint32_t count, uint32_t ordinal,
	struct eco_error *error)
{
	uint32_t *permutation = malloc(count * sizeof *permutation), next[256];
	struct stored *sorted = malloc(count * sizeof *sorted);
	enum eco_code code = permutation && sorted ? ECO_OK
		: eco_fail(error, ECO_NO_MEMORY, "chunk %u: out of memory for %u elements", ordinal, count);

	if (!code) {
		qsort(stored, count, sizeof *stored, compare_input);
		memcpy(sorted, stored, count * sizeof *sorted);
		eco_chunk_permutation(ordinal, count, permutation);
		for (uint32_t row = count; row-- > 0;)
			next[sorted[row].corners] = row;
		for (uint32_t i = 0; i < count; i++)
			stored[permutation[i]] = sorted[next[sorted[permutation[i]].corners]++];
	}
	free(permutation);
	free(sorted);
	return code;
}

static enum eco_code sort_elements(const struct eco_chunk_input *input, struct stored *stored,
	struct eco_error *error)
{
	uint32_t count = input->end - input->first;
	if (input->list->coder == ECO_CODER_ELEMENTS && input->first < KEPT_FIRST && count <= KEPT_MOST)
		return keep_order(stored, count, input->ordinal, error);
	qsort(stored, count, sizeof *stored, compare_stored);
	return ECO_OK;
}

static bool values_fit(const int32_t *values, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (values[i] < -ECO_ROWS_VALUE_MAX || values[i] > ECO_ROWS_VALUE_MAX)
			return false;
	return true;
}

/* Positions must also be within bounds on the finer grid that decoding returns. */
static bool exact_fits(const struct eco_elements *e, size_t corner_at, uint32_t corners)
{
	const int32_t most = ECO_ROWS_VALUE_MAX >> ECO_EXACT_SHIFT;
	for (size_t i = 3 * corner_at; i < 3 * (corner_at + corners); i++)
		if (e->position[i] > most || e->position[i] < -most)
			return false;
	return values_fit(e->exact + 3 * corner_at, 3 * (size_t)corners);
}

static enum eco_code check_input(const struct eco_chunk_input *input, struct eco_error *error)
{
	const struct eco_list *list = input->list;
	const struct eco_elements *e = input->elements;
	const char *fault = eco_list_coding_fault(list);
	if (fault)
		return eco_fail(error, ECO_DAMAGED, "list: %s", fault);
	if (input->first >= input->end || input->end > e->element_count)
		return eco_fail(error, ECO_BAD_INPUT, "chunk %u: elements [%u, %u) of %u cannot be a chunk",
			input->ordinal, input->first, input->end, e->element_count);
	if (input->end - input->first > ECO_CHUNK_ELEMENTS_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "chunk %u: %u elements, at most %u fit; end chunks "
			"earlier", input->ordinal, input->end - input->first, ECO_CHUNK_ELEMENTS_MAX);
	if (e->extra_count != eco_list_extra_count(list) || (e->extra_count > 0 && !e->extra)
	    || ((list->attributes & ECO_ATTR_UV) && !e->uv))
		return eco_fail(error, ECO_BAD_INPUT, "chunk %u: elements lack attributes that the list has",
			input->ordinal);
	return ECO_OK;
}

/* Allocates `out`, fills it with elements [first, end) in input order, and checks their values. */
static enum eco_code find_elements(const struct eco_chunk_input *input, struct stored **out,
	struct eco_error *error)
{
	const struct eco_elements *e = input->elements;
	uint32_t count = input->end - input->first;
	struct stored *stored = calloc(count, sizeof *stored);
	size_t corner_at = 0;
	int32_t low[3] = { 0 };
	*out = stored;
	if (!stored)
		return eco_fail(error, ECO_NO_MEMORY, "chunk %u: out of memory for %u elements",
			input->ordinal, count);
	for (uint32_t i = 0; i < input->first; i++)
		corner_at += e->corners[i];
	for (uint32_t i = 0; i < count; i++) {
		uint8_t corners = e->corners[input->first + i];
		const int32_t *position = e->position + 3 * corner_at;
		if (!eco_list_allows_corners(input->list, corners))
			return eco_fail(error, ECO_BAD_INPUT, "chunk %u: element %u has %u corners, which "
				"kind %u cannot have", input->ordinal, input->first + i, corners,
				input->list->kind);
		if (!values_fit(position, 3 * (size_t)corners)
				|| (e->exact && !exact_fits(e, corner_at, corners))
		    || (e->uv && !values_fit(e->uv + 2 * corner_at, 2 * (size_t)corners))
		    || (e->extra != NULL
		&& !values_fit(e->extra + (size_t)e->extra_count * (input->first + i), e->extra_count)))
			return eco_fail(error, ECO_TOO_LARGE, "chunk %u: a value of element %u exceeds %d; "
				"choose a coarser grid", input->ordinal, input->first + i,
				ECO_ROWS_VALUE_MAX);
		stored[i] = (struct stored){ .corners = corners, .element = i, .corner_at = corner_at };
		for (int axis = 0; axis < 3; axis++)
			low[axis] = i == 0 || position[axis] < low[axis] ? position[axis] : low[axis];
		corner_at += corners;
	}
	for (uint32_t i = 0; i < count; i++)
		for (int axis = 0; axis < 3; axis++)
			stored[i].key[axis] =
				(uint32_t)(e->position[3 * stored[i].corner_at + (size_t)axis] - low[axis]);
	return ECO_OK;
}

/* Packs the rows where that is smaller than the stream that is there, which must be the only one. */
static enum eco_code try_packed(struct eco_chunk_rows *rows, struct eco_stream *stream,
	struct eco_error *error)
{
	const size_t record = 11;    /* bytes that the streams' records take more */
	uint8_t *bytes, zeros;
	size_t size;
	if (rows->shape.rows > ECO_COLUMNS_ROWS_MAX && rows->shape.order == ECO_DRACO_SEQUENTIAL)
		return ECO_OK;
	enum eco_code code = eco_columns_encode(rows, &bytes, &size, &zeros, error);
	if (code)
		return code;
	if (size >= stream->size + record) {
		free(bytes);
		return ECO_OK;
	}
	free((void *)stream->bytes);
	stream->bytes = bytes;
	stream->size = size;
	stream->zeros = zeros;
	stream->packed = true;
	stream->wide = false;
	return ECO_OK;
}

/* As Draco's rows, or as packed ones. */
static enum eco_code encode_rows(struct eco_chunk_rows *rows, uint8_t coder, struct eco_stream *stream,
	bool alone, struct eco_error *error)
{
	uint8_t *bytes;
	stream->packed = rows->shape.ground_columns;
	enum eco_code code = stream->packed
		? eco_ground_encode(rows, &bytes, &stream->size, &stream->zeros, error)
		: eco_rows_encode(rows, &bytes, &stream->size, error);
	if (code)
		return code;
	stream->bytes = bytes;
	stream->wide = rows->shape.wide;
	stream->uv_shift = rows->shape.uv_shift;
	stream->predictors = rows->shape.predictors;
	/* leaves have SHAPES, which finds more in them */
	bool leaves = rows->shape.corners >= 3 && coder != ECO_CODER_FORM;
	return alone && !leaves && !stream->packed ? try_packed(rows, stream, error) : ECO_OK;
}

/* Encodes stored elements of one corner count as the payload's next stream; alone: the only one. */
static enum eco_code add_stream(struct eco_payload *payload, const struct eco_chunk_input *source,
	const struct stored *stored, uint32_t count, bool alone, struct eco_error *error)
{
	const struct eco_elements *e = source->elements;
	struct eco_stream *stream = &payload->streams[payload->stream_count];
	struct eco_chunk_rows rows;
	*stream = (struct eco_stream){ .corners = stored->corners, .elements = count,
		.shift = e->exact ? ECO_EXACT_SHIFT : 0 };
	struct eco_rows_shape shape = eco_payload_shape(source->list, payload->coder, stream);
	enum eco_code code = eco_rows_make(&rows, &shape, error);
	if (code)
		return code;
	for (uint32_t i = 0; i < count; i++) {
		size_t corner = stored[i].corner_at, element = source->first + stored[i].element;
		struct eco_rows_element row = {
			e->position + 3 * corner,
			shape.uv ? e->uv + 2 * corner : NULL,
			e->extra_count > 0 ? e->extra + e->extra_count * element : NULL,
		};

		eco_rows_put(&rows, i, &row);
	}
	code = encode_rows(&rows, payload->coder, stream, alone, error);
	payload->stream_count += stream->bytes != NULL;
	eco_rows_free(&rows);
	return code;
}

/* One stream for each run of equal corner counts. */
static enum eco_code add_streams(struct eco_payload *payload, const struct eco_chunk_input *source,
	const struct stored *stored, uint32_t count, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (uint32_t first = 0, end; code == ECO_OK && first < count; first = end) {
		for (end = first + 1; end < count && stored[end].corners == stored[first].corners; end++)
			;
		code = add_stream(payload, source, stored + first, end - first, end - first == count, error);
	}
	return code;
}

static enum eco_code report_order(const struct eco_chunk_input *input, const struct stored *stored,
	uint32_t *order, struct eco_error *error)
{
	uint32_t count = input->end - input->first;
	bool permuted = input->list->coder == ECO_CODER_ELEMENTS;
	uint32_t *permutation = permuted ? malloc(count * sizeof *permutation) : NULL;
	if (permuted && !permutation)
		return eco_fail(error, ECO_NO_MEMORY, "chunk %u: out of memory for %u elements",
			input->ordinal, count);
	if (permuted)
		eco_chunk_permutation(input->ordinal, count, permutation);
	for (uint32_t i = 0; i < count; i++)
		order[i] = stored[permuted ? permutation[i] : i].element;
	free(permutation);
	return ECO_OK;
}

/* Encodes ELEMENTS as SHAPES and keeps that if it is smaller than `*bytes`. */
static enum eco_code try_shapes(const struct eco_chunk_input *input, const struct stored *stored,
	uint8_t **bytes, size_t *size, struct eco_error *error)
{
	uint32_t count = input->end - input->first;
	struct eco_payload payload = { .coder = ECO_CODER_SHAPES };
	struct eco_placed_element *elements = malloc(count * sizeof *elements);
	uint8_t *smaller = NULL;
	size_t smaller_size = 0;
	enum eco_code code = elements ? ECO_OK
		: eco_fail(error, ECO_NO_MEMORY, "chunk %u: out of memory for the shapes of %u elements",
		input->ordinal, count);

	for (uint32_t i = 0; code == ECO_OK && i < count; i++)
		elements[i] = (struct eco_placed_element){ stored[i].element, stored[i].corner_at };
	if (!code)
		code = eco_shapes_encode(input, elements, 8.0 * (double)*size / count, &payload.streams[0],
			error);
	if (!code) {
		payload.stream_count = 1;
		code = eco_payload_write(&payload, &smaller, &smaller_size, error);
	}
	if (code == ECO_OK && smaller_size < *size) {
		free(*bytes);
		*bytes = smaller;
		*size = smaller_size;
		smaller = NULL;
	}
	free(smaller);
	free(elements);
	eco_payload_free_streams(&payload);
	return code;
}

/* MESH: edgebreaker or plain triangles, whichever loses nothing and is smaller. */
static enum eco_code encode_mesh(const struct eco_chunk_input *input, const struct stored *stored,
	uint8_t **bytes, size_t *size, struct eco_error *error)
{
	struct eco_payload mesh = { .coder = ECO_CODER_MESH }, plain = { .coder = ECO_CODER_ELEMENTS };
	uint8_t *plain_bytes = NULL;
	size_t plain_size = 0;
	bool fits;
	enum eco_code code = eco_mesh_encode(input->list, input->elements, input->first, input->end, &mesh,
		&fits, error);
	if (code == ECO_OK && fits)
		code = eco_payload_write(&mesh, bytes, size, error);
	code = code ? code : add_streams(&plain, input, stored, input->end - input->first, error);
	code = code ? code : eco_payload_write(&plain, &plain_bytes, &plain_size, error);
	if (code == ECO_OK && (!fits || plain_size < *size)) {
		free(*bytes);
		*bytes = plain_bytes;
		*size = plain_size;
		plain_bytes = NULL;
	}
	free(plain_bytes);
	eco_payload_free_streams(&mesh);
	eco_payload_free_streams(&plain);
	return code;
}

enum eco_code eco_chunk_encode(const struct eco_chunk_input *input, uint8_t **bytes, size_t *size_bytes,
	uint32_t *order, struct eco_error *error)
{
	struct eco_payload payload = { .coder = input->list->coder };
	uint32_t count = input->end - input->first;
	struct stored *stored = NULL;
	*bytes = NULL;
	*size_bytes = 0;
	assert(input->list->coder != ECO_CODER_FORM && input->list->coder != ECO_CODER_BYTES);
	assert(!order || input->list->coder == ECO_CODER_ELEMENTS || input->list->coder == ECO_CODER_ROWS);
	enum eco_code code = check_input(input, error);
	code = code ? code : find_elements(input, &stored, error);
	if (code == ECO_OK && (payload.coder == ECO_CODER_ELEMENTS || payload.coder == ECO_CODER_MESH))
		code = sort_elements(input, stored, error);
	if (code == ECO_OK && payload.coder == ECO_CODER_MESH) {
		code = encode_mesh(input, stored, bytes, size_bytes, error);
	} else if (!code) {
		code = add_streams(&payload, input, stored, count, error);
		code = code ? code : eco_payload_write(&payload, bytes, size_bytes, error);
		if (code == ECO_OK && payload.coder == ECO_CODER_ELEMENTS && input->list->kind
				== ECO_LIST_TRIANGLES && input->elements->exact)
			code = try_shapes(input, stored, bytes, size_bytes, error);
	}
	if (code == ECO_OK && order)
		code = report_order(input, stored, order, error);
	if (code) {
		free(*bytes);
		*bytes = NULL;
	}
	eco_payload_free_streams(&payload);
	free(stored);
	return code;
}

/* Checks the form's own values; counts are those of the partner's input. */
static enum eco_code check_forms(const struct eco_chunk_input *partner, const struct eco_list *list,
	const struct eco_elements *forms, struct eco_error *error)
{
	if (list->coder != ECO_CODER_FORM || partner->list->coder != ECO_CODER_ELEMENTS
			|| partner->list->kind != ECO_LIST_TRIANGLES)
		return eco_fail(error, ECO_BAD_INPUT, "chunk %u: only fans have other forms, and only lists "
			"of coder FORM are forms", partner->ordinal);
	if (forms->element_count != partner->elements->element_count)
		return eco_fail(error, ECO_BAD_INPUT, "chunk %u: %u forms for %u elements: one for each is "
			"needed", partner->ordinal, forms->element_count, partner->elements->element_count);
	for (uint32_t i = 0; i < forms->element_count; i++)
		if (forms->corners[i] != forms->corners[0])
			return eco_fail(error, ECO_BAD_INPUT, "chunk %u: form %u has %u corners, the first "
				"has %u: all must have as many", partner->ordinal, i, forms->corners[i],
				forms->corners[0]);
	return ECO_OK;
}

enum eco_code eco_chunk_encode_form(const struct eco_chunk_input *partner, const struct eco_list *list,
	const struct eco_elements *forms, uint8_t **bytes, size_t *size_bytes, struct eco_error *error)
{
	const struct eco_chunk_input own = { list, forms, partner->first, partner->end, partner->ordinal };
	struct eco_payload payload = { .coder = ECO_CODER_FORM };
	uint32_t count = partner->end - partner->first;
	struct stored *stored = NULL, *form = NULL;
	*bytes = NULL;
	*size_bytes = 0;
	enum eco_code code = check_input(partner, error);
	code = code ? code : check_forms(partner, list, forms, error);
	code = code ? code : check_input(&own, error);
	code = code ? code : find_elements(partner, &stored, error);
	code = code ? code : find_elements(&own, &form, error);
	code = code ? code : sort_elements(partner, stored, error);
	if (!code) {
		for (uint32_t i = 0; i < count; i++)
			stored[i] = form[stored[i].element];
		code = add_stream(&payload, &own, stored, count, true, error);
	}
	code = code ? code : eco_payload_write(&payload, bytes, size_bytes, error);
	eco_payload_free_streams(&payload);
	free(stored);
	free(form);
	return code;
}
