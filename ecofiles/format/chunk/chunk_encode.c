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
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "ecofiles/format/chunk/chunk_columns.h"
#include "ecofiles/format/chunk/chunk_payload.h"

#define KEPT_FIRST 96u           /* a chunk that begins before this element keeps its order */
#define KEPT_MOST 64u            /* if it has at most so many elements */

static int compare_stored(const void *left, const void *right)
{
	const struct eco_stored *a = left, *b = right;
	if (a->corners != b->corners)
		return a->corners < b->corners ? -1 : 1;
	if (a->part != b->part)
		return a->part < b->part ? -1 : 1;
	int order = eco_order_cells(a->key, b->key, 3);
	if (order)
		return order;
	return a->element < b->element ? -1 : a->element > b->element;
}

/* Each row takes the next input element of its corner count, in the order in which the decoder draws the
 * rows. */
static void keep_order(struct eco_stored *stored, uint32_t count, uint32_t ordinal)
{
	uint32_t *permutation = eco_alloc(count, sizeof *permutation), next[256];
	struct eco_stored *sorted = eco_alloc(count, sizeof *sorted);
	for (uint32_t i = 0; i < count; i++)
		memset(stored[i].key, 0, sizeof stored[i].key);
	qsort(stored, count, sizeof *stored, compare_stored);
	memcpy(sorted, stored, count * sizeof *sorted);
	eco_chunk_permutation(ordinal, count, permutation);
	for (uint32_t row = count; row-- > 0;)
		next[sorted[row].corners] = row;
	for (uint32_t i = 0; i < count; i++)
		stored[permutation[i]] = sorted[next[sorted[permutation[i]].corners]++];
	free(permutation);
	free(sorted);
}

bool eco_chunk_keeps_order(uint32_t first, uint32_t end) { return first < KEPT_FIRST && end - first <= KEPT_MOST; }

static void sort_elements(const struct eco_chunk_input *input, struct eco_stored *stored)
{
	uint32_t count = input->end - input->first;
	if (input->list->coder == ECO_CODER_ELEMENTS && eco_chunk_keeps_order(input->first, input->end))
		keep_order(stored, count, input->ordinal);
	else
		qsort(stored, count, sizeof *stored, compare_stored);
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

static void check_input(const struct eco_chunk_input *input)
{
	const struct eco_elements *e = input->elements;
	assert(!eco_list_coding_fault(input->list));
	assert(input->first < input->end && input->end <= e->element_count);
	assert(input->end - input->first <= ECO_CHUNK_ELEMENTS_MAX);
	assert(e->extra_count == eco_list_extra_count(input->list) && (e->extra || !e->extra_count));
	assert(e->uv || !(input->list->attributes & ECO_ATTR_UV));
}

/* Whether all values of element i, whose first corner is the corner_at-th, are within bounds. */
static bool element_fits(const struct eco_elements *e, uint32_t i, size_t corner_at)
{
	size_t corners = e->corners[i];
	return values_fit(e->position + 3 * corner_at, 3 * corners)
		&& (!e->exact || exact_fits(e, corner_at, e->corners[i]))
		&& (!e->uv || values_fit(e->uv + 2 * corner_at, 2 * corners))
		&& (!e->extra || values_fit(e->extra + (size_t)e->extra_count * i, e->extra_count));
}

/* Allocates `out`, fills it with elements [first, end) in input order, and checks their values. */
static enum eco_code find_elements(const struct eco_chunk_input *input, struct eco_stored **out,
	struct eco_error *error)
{
	const struct eco_elements *e = input->elements;
	uint32_t count = input->end - input->first;
	struct eco_stored *stored = *out = eco_alloc(count, sizeof *stored);
	size_t corner_at = 0;
	int32_t low[3] = { 0 };
	check_input(input);
	for (uint32_t i = 0; i < input->first; i++)
		corner_at += e->corners[i];
	for (uint32_t i = 0; i < count; i++) {
		uint8_t corners = e->corners[input->first + i];
		const int32_t *position = e->position + 3 * corner_at;
		assert(eco_list_allows_corners(input->list, corners));
		if (!element_fits(e, input->first + i, corner_at))
			return eco_fail(error, ECO_TOO_LARGE, "chunk %u: a value of element %u exceeds %d; "
				"choose a coarser grid", input->ordinal, input->first + i,
				ECO_ROWS_VALUE_MAX);
		stored[i] = (struct eco_stored){ .corners = corners, .element = i, .corner_at = corner_at,
			.part = e->part && input->list->coder == ECO_CODER_MESH ? e->part[input->first + i] : 0 };
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

/* Encodes stored elements of one corner count as the payload's next stream. */
static void add_stream(struct eco_payload *payload, const struct eco_chunk_input *source,
	const struct eco_stored *stored, uint32_t count)
{
	const struct eco_elements *e = source->elements;
	struct eco_stream stream = { .corners = stored->corners, .elements = count,
		.shift = e->exact ? ECO_EXACT_SHIFT : 0 };
	struct eco_chunk_rows rows;
	if (eco_rows_make(&rows, source->list, payload->coder, &stream, NULL))
		eco_end("no memory");
	for (uint32_t i = 0; i < count; i++) {
		size_t corner = stored[i].corner_at, element = source->first + stored[i].element;
		struct eco_rows_element row = {
			e->position + 3 * corner,
			rows.uv ? e->uv + 2 * corner : NULL,
			e->extra_count > 0 ? e->extra + e->extra_count * element : NULL,
		};

		eco_rows_put(&rows, i, &row);
	}
	(rows.ground_columns ? eco_ground_encode : eco_rows_encode)(&rows);
	payload->streams[payload->stream_count++] = rows.stream;
	eco_rows_free(&rows);
}

/* One stream for each run of equal corner counts. */
static void add_streams(struct eco_payload *payload, const struct eco_chunk_input *source,
	const struct eco_stored *stored)
{
	uint32_t count = source->end - source->first;
	for (uint32_t first = 0, end; first < count; first = end) {
		for (end = first + 1; end < count && stored[end].corners == stored[first].corners; end++)
			;
		add_stream(payload, source, stored + first, end - first);
	}
}

/* The payload's bytes in `best`, if nothing is there or they are fewer. Frees its streams. */
static void keep_smaller(struct eco_writer *best, struct eco_payload *payload)
{
	struct eco_writer w = { 0 };
	eco_payload_write(payload, &w);
	if (w.failed)
		eco_end("no memory");
	eco_payload_free_streams(payload);
	if (!best->bytes || w.size < best->size) {
		struct eco_writer larger = *best;
		*best = w;
		w = larger;
	}
	eco_writer_free(&w);
}

/* Elements as ELEMENTS, and as SHAPES or MESH where the list allows that. */
static void encode_elements(const struct eco_chunk_input *input, const struct eco_stored *stored,
	struct eco_writer *w)
{
	const struct eco_list *list = input->list;
	bool is_mesh = list->coder == ECO_CODER_MESH;
	struct eco_payload plain = { .coder = is_mesh ? ECO_CODER_ELEMENTS : list->coder },
		mesh = { .coder = ECO_CODER_MESH }, shapes = { .coder = ECO_CODER_SHAPES, .stream_count = 1 };
	if (is_mesh && eco_mesh_encode(input, &mesh))
		keep_smaller(w, &mesh);
	eco_payload_free_streams(&mesh);
	add_streams(&plain, input, stored);
	keep_smaller(w, &plain);
	if (list->coder == ECO_CODER_ELEMENTS && list->kind == ECO_LIST_TRIANGLES && input->elements->exact) {
		eco_shapes_encode(input, stored, 8.0 * (double)w->size / (input->end - input->first),
			&shapes.streams[0]);
		keep_smaller(w, &shapes);
	}
}

static enum eco_code give(struct eco_writer *w, uint8_t **bytes, size_t *size_bytes, struct eco_error *error)
{
	*bytes = w->bytes;
	*size_bytes = w->size;
	if (w->size <= ECO_CHUNK_BYTES_MAX)
		return ECO_OK;
	eco_writer_free(w);
	*bytes = NULL;
	return eco_fail(error, ECO_TOO_LARGE, "chunk: no room for a payload of more than %u bytes",
		ECO_CHUNK_BYTES_MAX);
}

enum eco_code eco_chunk_order(const struct eco_chunk_input *input, uint32_t *order, struct eco_error *error)
{
	struct eco_stored *stored;
	uint32_t count = input->end - input->first;
	enum eco_code code = find_elements(input, &stored, error);
	for (uint32_t i = 0; i < count; i++)
		order[i] = i;
	if (!code && input->list->coder == ECO_CODER_ELEMENTS) {
		sort_elements(input, stored);
		eco_chunk_permutation(input->ordinal, count, order);
		for (uint32_t i = 0; i < count; i++)
			order[i] = stored[order[i]].element;
	}
	free(stored);
	return code;
}

enum eco_code eco_chunk_encode(const struct eco_chunk_input *input, uint8_t **bytes, size_t *size_bytes,
	struct eco_error *error)
{
	uint8_t coder = input->list->coder;
	struct eco_stored *stored;
	struct eco_writer w = { 0 };
	assert(coder != ECO_CODER_FORM && coder != ECO_CODER_BYTES);
	enum eco_code code = find_elements(input, &stored, error);
	if (!code) {
		if (coder == ECO_CODER_ELEMENTS || coder == ECO_CODER_MESH)
			sort_elements(input, stored);
		encode_elements(input, stored, &w);
	}
	free(stored);
	enum eco_code given = give(&w, bytes, size_bytes, error);
	return code ? code : given;
}

enum eco_code eco_chunk_encode_form(const struct eco_chunk_input *partner, const struct eco_list *list,
	const struct eco_elements *forms, uint8_t **bytes, size_t *size_bytes, struct eco_error *error)
{
	const struct eco_chunk_input own = { list, forms, partner->first, partner->end, partner->ordinal };
	struct eco_payload payload = { .coder = ECO_CODER_FORM };
	struct eco_stored *stored, *form;
	struct eco_writer w = { 0 };
	assert(list->coder == ECO_CODER_FORM && partner->list->coder == ECO_CODER_ELEMENTS
		&& partner->list->kind == ECO_LIST_TRIANGLES
		&& forms->element_count == partner->elements->element_count);
	enum eco_code code = find_elements(partner, &stored, error), own_code = find_elements(&own, &form, error);
	code = code ? code : own_code;
	if (!code) {
		sort_elements(partner, stored);
		for (uint32_t i = 0; i < partner->end - partner->first; i++) {
			stored[i] = form[stored[i].element];
			assert(stored[i].corners == stored[0].corners);
		}
		add_stream(&payload, &own, stored, partner->end - partner->first);
		keep_smaller(&w, &payload);
	}
	free(stored);
	free(form);
	enum eco_code given = give(&w, bytes, size_bytes, error);
	return code ? code : given;
}
