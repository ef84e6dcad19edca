/* Chunks: what is encoded is decoded, whatever the coder; whatever is damaged is refused. Long, as every coder meets every kind of list. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/chunk.h"

#define VALUE_MAX ((1 << 28) - 1)

/* ---- Random elements ---- */

static uint64_t bits(uint64_t *state)
{
	*state = *state * 6364136223846793005u + 1442695040888963407u;
	return *state >> 33;
}

static int32_t between(uint64_t *state, int32_t low, int32_t high)
{
	return low + (int32_t)(bits(state) % ((uint64_t)((int64_t)high - low) + 1));
}

enum pattern { SCATTERED, EQUAL, EXTREME, LEAVES };

struct kind {
	const char *name;
	uint8_t kind, coder, attributes, low_corners, high_corners;
	uint32_t count;
	int32_t low, high;           /* of coordinates */
	enum pattern pattern;
};

static const struct kind kinds[] = {
	{ "one triangle", ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, 0, 3, 3, 1, 0, 4095, SCATTERED },
	{ "one hexagon with everything", ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR | ECO_ATTR_UV, 6, 6, 1, -9, 9, SCATTERED },
	{ "quads", ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR, 4, 4, 500, 0, 4095, LEAVES },
	{ "hexagons", ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, 0, 6, 6, 300, 0, 4095, LEAVES },
	{ "mixed fans", ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR | ECO_ATTR_UV, 3, 6, 700, -5000, 5000, SCATTERED },
	{ "equal quads", ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR, 4, 4, 100, -7, -7, EQUAL },
	{ "18 bits", ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, 0, 3, 6, 100, 0, (1 << 18) - 1, EXTREME },
	{ "all the range", ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, ECO_ATTR_UV, 3, 6, 60, -VALUE_MAX, VALUE_MAX, EXTREME },
	{ "textured quads", ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, ECO_ATTR_UV, 4, 4, 300, 0, 4095, LEAVES },
	{ "lines", ECO_LIST_LINES, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR | ECO_ATTR_WIDTH, 2, 2, 400, -2000, 2000, SCATTERED },
	{ "one point", ECO_LIST_POINTS, ECO_CODER_ELEMENTS, 0, 1, 1, 1, -1, 1, SCATTERED },
	{ "points", ECO_LIST_POINTS, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR, 1, 1, 1000, 0, 4095, SCATTERED },
	{ "one summary point", ECO_LIST_POINTS, ECO_CODER_KD, ECO_ATTR_PLANT, 1, 1, 1, -5, 5, SCATTERED },
	{ "summary", ECO_LIST_POINTS, ECO_CODER_KD, ECO_ATTR_PLANT | ECO_ATTR_COLOR, 1, 1, 900, -3000, 3000, SCATTERED },
	{ "bare kd", ECO_LIST_POINTS, ECO_CODER_KD, 0, 1, 1, 900, 0, 4095, SCATTERED },
	{ "equal kd", ECO_LIST_POINTS, ECO_CODER_KD, ECO_ATTR_PLANT, 1, 1, 300, 12, 12, EQUAL },
	{ "wide kd", ECO_LIST_POINTS, ECO_CODER_KD, ECO_ATTR_COLOR, 1, 1, 100, -VALUE_MAX, VALUE_MAX, EXTREME },
	{ "points in rows", ECO_LIST_POINTS, ECO_CODER_ROWS, ECO_ATTR_COLOR, 1, 1, 50, 0, 99, SCATTERED },
	{ "one instance", ECO_LIST_INSTANCES, ECO_CODER_ROWS, ECO_ATTR_PLACE, 1, 1, 1, -9, 9, SCATTERED },
	{ "instances", ECO_LIST_INSTANCES, ECO_CODER_ROWS, ECO_ATTR_PLACE, 1, 1, 600, -40000, 40000, SCATTERED },
	{ "far instances", ECO_LIST_INSTANCES, ECO_CODER_ROWS, ECO_ATTR_PLACE, 1, 1, 90, -VALUE_MAX, VALUE_MAX, EXTREME },
	{ "ground", ECO_LIST_GROUND, ECO_CODER_ROWS, 0, 1, 1, 600, 0, 4095, SCATTERED },
	{ "far ground", ECO_LIST_GROUND, ECO_CODER_ROWS, 0, 1, 1, 100, -VALUE_MAX, VALUE_MAX, EXTREME },
	{ "one point form", ECO_LIST_POINTS, ECO_CODER_FORM, ECO_ATTR_SIZE, 1, 1, 1, -9, 9, SCATTERED },
	{ "point forms", ECO_LIST_POINTS, ECO_CODER_FORM, ECO_ATTR_COLOR | ECO_ATTR_SIZE, 1, 1, 500, 0, 4095, SCATTERED },
	{ "textured point forms", ECO_LIST_POINTS, ECO_CODER_FORM, ECO_ATTR_UV, 1, 1, 40, 0, 4095, SCATTERED },
	{ "line forms", ECO_LIST_LINES, ECO_CODER_FORM, ECO_ATTR_COLOR | ECO_ATTR_WIDTH, 2, 2, 300, -2000, 2000, SCATTERED },
	{ "triangle forms", ECO_LIST_TRIANGLES, ECO_CODER_FORM, ECO_ATTR_COLOR | ECO_ATTR_GROWTH, 3, 3, 300, 0, 4095, LEAVES },
	{ "quad forms", ECO_LIST_TRIANGLES, ECO_CODER_FORM, ECO_ATTR_UV | ECO_ATTR_GROWTH, 4, 4, 300, 0, 4095, LEAVES },
	{ "far quad forms", ECO_LIST_TRIANGLES, ECO_CODER_FORM, 0, 4, 4, 90, -VALUE_MAX, VALUE_MAX, EXTREME },
	{ "growing fans", ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR | ECO_ATTR_GROWTH, 3, 6, 400, 0, 4095, LEAVES },
	{ "sized points", ECO_LIST_POINTS, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR | ECO_ATTR_SIZE, 1, 1, 400, 0, 4095, SCATTERED },
	{ "sized summary", ECO_LIST_POINTS, ECO_CODER_KD, ECO_ATTR_COLOR | ECO_ATTR_PLANT | ECO_ATTR_SIZE, 1, 1, 400, 0, 4095, SCATTERED },
	{ "one wood triangle", ECO_LIST_TRIANGLES, ECO_CODER_MESH, 0, 3, 3, 1, 0, 50, SCATTERED },
	{ "wood soup", ECO_LIST_TRIANGLES, ECO_CODER_MESH, ECO_ATTR_COLOR | ECO_ATTR_UV, 3, 3, 200, 0, 4095, SCATTERED },
	{ "tangled wood", ECO_LIST_TRIANGLES, ECO_CODER_MESH, ECO_ATTR_COLOR, 3, 3, 400, 0, 5, SCATTERED },
	{ "far wood", ECO_LIST_TRIANGLES, ECO_CODER_MESH, ECO_ATTR_UV, 3, 3, 40, -VALUE_MAX, VALUE_MAX, EXTREME },
};
#define KIND_COUNT (sizeof kinds / sizeof kinds[0])

static int32_t coordinate(const struct kind *k, uint64_t *state)
{
	if (k->pattern == EXTREME)
		return bits(state) & 1 ? k->high : bits(state) & 1 ? k->low : between(state, k->low, k->high);
	return between(state, k->low, k->high);
}

static void fill_corner(const struct kind *k, uint64_t *state, int32_t *position, unsigned corner)
{
	static const int8_t hexagon[6][2] = { { 2, 0 }, { 1, 2 }, { -1, 2 }, { -2, 0 }, { -1, -2 }, { 1, -2 } };

	for (unsigned axis = 0; axis < 3; axis++)
		if (k->pattern == LEAVES && corner > 0)
			position[3 * corner + axis] = position[axis] + 9 * hexagon[corner][axis % 2] + between(state, -1, 1);
		else
			position[3 * corner + axis] = coordinate(k, state);
}

static bool coincide(const int32_t *p)
{
	return memcmp(p, p + 3, 12) == 0 || memcmp(p + 3, p + 6, 12) == 0 || memcmp(p, p + 6, 12) == 0;
}

static struct eco_list list_of(const struct kind *k)
{
	return (struct eco_list){ .kind = k->kind, .coder = k->coder, .attributes = k->attributes,
		.columns = k->kind == ECO_LIST_GROUND ? 25 : 0 };
}

static struct eco_elements make(const struct kind *k, uint32_t count, uint64_t seed)
{
	const struct eco_list list = list_of(k);
	struct eco_elements e = { .element_count = count, .extra_count = eco_list_extra_count(&list) };
	uint64_t state = seed;

	e.corners = malloc(count);
	e.position = malloc((size_t)count * ECO_CORNERS_MAX * 12);
	e.uv = k->attributes & ECO_ATTR_UV ? malloc((size_t)count * ECO_CORNERS_MAX * 8) : NULL;
	e.extra = e.extra_count > 0 ? malloc((size_t)count * e.extra_count * 4) : NULL;
	for (uint32_t i = 0; i < count; i++) {
		uint8_t corners = (uint8_t)between(&state, k->low_corners, k->high_corners);
		int32_t *position = e.position + 3 * (size_t)e.corner_count;

		e.corners[i] = corners;
		do
			for (unsigned c = 0; c < corners; c++)
				fill_corner(k, &state, position, c);
		while (k->coder == ECO_CODER_MESH && coincide(position));
		for (unsigned c = 0; e.uv != NULL && c < 2u * corners; c++)
			e.uv[2 * (size_t)e.corner_count + c] = k->pattern == LEAVES ? (int32_t)(c / 2 + c % 2) % 3 * ECO_UV_ONE
				: between(&state, -100, ECO_UV_ONE);
		for (unsigned c = 0; c < e.extra_count; c++)
			e.extra[(size_t)e.extra_count * i + c] = k->pattern == EQUAL ? 3 : between(&state, 0, 65535 + (int)c);
		e.corner_count += corners;
		e.primitive_count += corners < 3 ? 1 : corners - 2u;
	}
	return e;
}

static struct eco_chunk describe(const struct eco_elements *e, uint32_t first, uint32_t end, size_t size)
{
	struct eco_chunk chunk = { .size_bytes = (uint32_t)size, .element_count = end - first };

	for (uint32_t i = first; i < end; i++)
		chunk.primitive_count += e->corners[i] < 3 ? 1 : e->corners[i] - 2u;
	return chunk;
}

/* Forms are coded as those of triangles that all lie in one place, which keeps their order. */
static enum eco_code encode(const struct eco_chunk_input *input, uint8_t **bytes, size_t *size, uint32_t *order, struct eco_error *error)
{
	const struct eco_list fans = { .kind = ECO_LIST_TRIANGLES, .coder = ECO_CODER_ELEMENTS };
	uint32_t count = input->elements->element_count;
	struct eco_elements of = { .element_count = count, .corner_count = 3 * count, .primitive_count = count };
	const struct eco_chunk_input partner = { &fans, &of, input->first, input->end, input->ordinal };
	enum eco_code code;

	if (input->list->coder != ECO_CODER_FORM)
		return eco_chunk_encode(input, bytes, size, order, error);
	of.corners = malloc(count);
	of.position = calloc(count, 36);
	memset(of.corners, 3, count);
	code = eco_chunk_encode_form(&partner, input->list, input->elements, bytes, size, error);
	eco_elements_free(&of);
	return code;
}

static uint32_t corner_at(const struct eco_elements *e, uint32_t element)
{
	uint32_t at = 0;

	for (uint32_t i = 0; i < element; i++)
		at += e->corners[i];
	return at;
}

/* ---- Comparing ---- */

/* One element as a flat record that can be sorted: corners, positions, uv, extra. */
#define FLAT (1 + 3 * ECO_CORNERS_MAX + 2 * ECO_CORNERS_MAX + 6)

static void flatten(const struct eco_elements *e, uint32_t element, uint32_t corner, bool turn, int32_t *flat)
{
	uint8_t n = e->corners[element];
	unsigned first = 0;

	memset(flat, 0, FLAT * sizeof *flat);
	flat[0] = n;
	if (turn) {                      /* edgebreaker may begin a triangle at another corner */
		for (unsigned c = 1; c < n; c++) {
			const int32_t *a = e->position + 3 * ((size_t)corner + c), *b = e->position + 3 * ((size_t)corner + first);

			if (a[0] != b[0] ? a[0] < b[0] : a[1] != b[1] ? a[1] < b[1] : a[2] < b[2])
				first = c;
		}
	}
	for (unsigned c = 0; c < n; c++) {
		memcpy(flat + 1 + 3 * c, e->position + 3 * ((size_t)corner + (c + first) % n), 12);
		if (e->uv != NULL)
			memcpy(flat + 1 + 3 * ECO_CORNERS_MAX + 2 * c, e->uv + 2 * ((size_t)corner + (c + first) % n), 8);
	}
	if (e->extra_count > 0)
		memcpy(flat + 1 + 5 * ECO_CORNERS_MAX, e->extra + (size_t)e->extra_count * element, 4 * e->extra_count);
}

static int compare_flat(const void *a, const void *b)
{
	return memcmp(a, b, FLAT * sizeof(int32_t));
}

static int32_t *flatten_all(const struct eco_elements *e, uint32_t first, uint32_t end, bool turn)
{
	int32_t *flat = malloc((size_t)(end - first) * FLAT * sizeof *flat);
	uint32_t corner = corner_at(e, first);

	for (uint32_t i = first; i < end; corner += e->corners[i++])
		flatten(e, i, corner, turn, flat + (size_t)(i - first) * FLAT);
	return flat;
}

static void assert_same(const struct kind *k, const struct eco_elements *in, uint32_t first, uint32_t end,
	const struct eco_elements *out, const uint32_t *order)
{
	int32_t *a = flatten_all(in, first, end, k->coder == ECO_CODER_MESH);
	int32_t *b = flatten_all(out, 0, out->element_count, k->coder == ECO_CODER_MESH);
	size_t record = FLAT * sizeof *a;

	assert_int_equal(out->element_count, end - first);
	if (order == NULL) {
		qsort(a, end - first, record, compare_flat);
		qsort(b, end - first, record, compare_flat);
	}
	for (uint32_t i = 0; i < end - first; i++)
		assert_memory_equal(b + (size_t)i * FLAT, a + (size_t)(order == NULL ? i : order[i]) * FLAT, record);
	free(a);
	free(b);
}

static bool ordered(const struct kind *k)
{
	return k->coder == ECO_CODER_ELEMENTS || k->coder == ECO_CODER_ROWS;
}

/* ---- Tests ---- */

static void what_goes_in_comes_out(void **state)
{
	(void)state;
	for (size_t i = 0; i < KIND_COUNT; i++) {
		const struct kind *k = &kinds[i];
		const struct eco_list list = list_of(k);
		struct eco_elements in = make(k, k->count + 7, i + 1), out;
		uint32_t first = k->count > 10 ? 5 : 0, end = first + k->count;
		const struct eco_chunk_input input = { &list, &in, first, end, (uint32_t)i };
		uint32_t *order = ordered(k) ? malloc((end - first) * sizeof *order) : NULL;
		struct eco_error error = { 0 };
		struct eco_chunk chunk;
		uint8_t *bytes;
		size_t size;

		if (encode(&input, &bytes, &size, order, &error) != ECO_OK)
			fail_msg("%s: %s", k->name, error.text);
		chunk = describe(&in, first, end, size);
		if (eco_chunk_decode(&list, &chunk, (uint32_t)i, bytes, size, &out, &error) != ECO_OK)
			fail_msg("%s: %s", k->name, error.text);
		assert_int_equal(out.primitive_count, chunk.primitive_count);
		assert_same(k, &in, first, end, &out, order);
		free(order);
		free(bytes);
		eco_elements_free(&in);
		eco_elements_free(&out);
	}
}

static void the_same_elements_give_the_same_bytes(void **state)
{
	(void)state;
	for (size_t i = 0; i < KIND_COUNT; i++) {
		const struct eco_list list = list_of(&kinds[i]);
		struct eco_elements in = make(&kinds[i], kinds[i].count, 3);
		const struct eco_chunk_input input = { &list, &in, 0, kinds[i].count, 1 };
		uint8_t *bytes[2];
		size_t size[2];

		for (int pass = 0; pass < 2; pass++)
			assert_int_equal(encode(&input, &bytes[pass], &size[pass], NULL, NULL), ECO_OK);
		assert_int_equal(size[0], size[1]);
		assert_memory_equal(bytes[0], bytes[1], size[0]);
		free(bytes[0]);
		free(bytes[1]);
		eco_elements_free(&in);
	}
}

/* Forms are coded in the partner's stored order; twin: the partner's own report of its draw order. */
static void forms_follow_their_elements(void **state)
{
	static const struct { uint8_t low, high, form; } cases[] = {
		{ 3, 3, 1 }, { 3, 6, 1 }, { 6, 6, 1 }, { 3, 6, 3 }, { 5, 6, 4 }, { 4, 4, 4 },
	};
	enum { COUNT = 300, FIRST = 20, END = 270 };

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		const struct kind fan = { "fans", ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR, cases[i].low, cases[i].high, COUNT, 0,
			4095, SCATTERED };
		const struct kind form = { "forms", cases[i].form == 1 ? ECO_LIST_POINTS : ECO_LIST_TRIANGLES, ECO_CODER_FORM,
			cases[i].form == 1 ? ECO_ATTR_COLOR | ECO_ATTR_SIZE : ECO_ATTR_UV | ECO_ATTR_GROWTH, cases[i].form, cases[i].form, COUNT, 0,
			4095, SCATTERED };
		const struct eco_list fans = list_of(&fan), forms = list_of(&form);
		struct eco_elements in = make(&fan, COUNT, i), other = make(&form, COUNT, i + 50), out;
		const struct eco_chunk_input input = { &fans, &in, FIRST, END, 9 };
		uint32_t order[END - FIRST];
		struct eco_error error = { 0 };
		struct eco_chunk chunk;
		uint8_t *bytes;
		size_t size;

		assert_int_equal(eco_chunk_encode(&input, &bytes, &size, order, &error), ECO_OK);
		free(bytes);
		if (eco_chunk_encode_form(&input, &forms, &other, &bytes, &size, &error) != ECO_OK)
			fail_msg("%s", error.text);
		chunk = describe(&other, FIRST, END, size);
		if (eco_chunk_decode(&forms, &chunk, 9, bytes, size, &out, &error) != ECO_OK)
			fail_msg("%s", error.text);
		assert_same(&form, &other, FIRST, END, &out, order);
		eco_elements_free(&out);
		free(bytes);
		/* one form too few, one of another shape */
		other.element_count--;
		assert_int_equal(eco_chunk_encode_form(&input, &forms, &other, &bytes, &size, &error), ECO_BAD_INPUT);
		other.element_count++;
		other.corners[100] = (uint8_t)(7 - cases[i].form);
		assert_int_equal(eco_chunk_encode_form(&input, &forms, &other, &bytes, &size, NULL), ECO_BAD_INPUT);
		assert_null(bytes);
		eco_elements_free(&in);
		eco_elements_free(&other);
	}
}

/* The first chunks are drawn in the order that they came in: of one corner count strictly, else each corner count's elements among themselves. */
static void first_chunks_keep_their_order(void **state)
{
	static const struct { uint8_t low, high; uint32_t first, end; bool kept; } cases[] = { { 4, 4, 0, 32, true }, { 3, 3, 32, 64, true },
		{ 4, 4, 0, 1, true }, { 3, 6, 0, 48, true }, { 4, 4, 64, 128, true }, { 4, 4, 200, 250, false }, { 4, 4, 0, 300, false } };

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		const struct kind k = { "fans", ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR, cases[i].low, cases[i].high, 300, 0, 4095, LEAVES };
		const struct eco_list list = list_of(&k);
		struct eco_elements in = make(&k, 300, i), out;
		const struct eco_chunk_input input = { &list, &in, cases[i].first, cases[i].end, (uint32_t)i };
		uint32_t order[300], last[ECO_CORNERS_MAX + 1] = { 0 }, falls = 0;
		uint8_t *bytes;
		size_t size;

		assert_int_equal(eco_chunk_encode(&input, &bytes, &size, order, NULL), ECO_OK);
		for (uint32_t e = 0; e < cases[i].end - cases[i].first; e++) {
			uint32_t *before = &last[in.corners[cases[i].first + order[e]]];

			falls += order[e] < *before;
			*before = order[e];
		}
		assert_true(cases[i].kept ? falls == 0 : falls > 10);
		struct eco_chunk chunk = describe(&in, cases[i].first, cases[i].end, size);
		assert_int_equal(eco_chunk_decode(&list, &chunk, (uint32_t)i, bytes, size, &out, NULL), ECO_OK);
		assert_same(&k, &in, cases[i].first, cases[i].end, &out, order);
		eco_elements_free(&out);
		eco_elements_free(&in);
		free(bytes);
	}
}

/* Smooth ground costs a few bits a sample, wherever the chunk begins in a row. */
static void ground_is_predicted_from_its_neighbours(void **state)
{
	enum { SIDE = 64 };
	static uint8_t corners[SIDE * SIDE];
	static int32_t position[3 * SIDE * SIDE];
	const struct eco_list list = { .kind = ECO_LIST_GROUND, .coder = ECO_CODER_ROWS, .columns = SIDE };
	struct eco_elements in = { SIDE * SIDE, SIDE * SIDE, SIDE * SIDE, 0, corners, position, NULL, NULL, NULL }, out;
	const struct eco_chunk_input input = { &list, &in, 10, SIDE * SIDE, 1 };
	uint32_t count = input.end - input.first;
	struct eco_chunk chunk;
	uint8_t *bytes;
	size_t size;

	(void)state;
	for (int32_t i = 0; i < SIDE * SIDE; i++) {
		corners[i] = 1;
		position[3 * i] = 4 * (i % SIDE);
		position[3 * i + 1] = 4 * (i / SIDE);
		position[3 * i + 2] = (i % SIDE) * (i % SIDE) / 3 - (i / SIDE) * 40 + (i % SIDE) * (i / SIDE) / 5;
	}
	assert_int_equal(eco_chunk_encode(&input, &bytes, &size, NULL, NULL), ECO_OK);
	assert_true(size < count * 3 / 8);
	chunk = (struct eco_chunk){ .size_bytes = (uint32_t)size, .element_count = count, .primitive_count = count };
	assert_int_equal(eco_chunk_decode(&list, &chunk, 1, bytes, size, &out, NULL), ECO_OK);
	assert_memory_equal(out.position, position + 3 * input.first, 12 * count);
	free(bytes);
	eco_elements_free(&out);
}

/* A grid of quads with a seam in its texture, bent; written as single triangles. */
static struct eco_elements make_bark(uint32_t side)
{
	struct eco_elements e = { .element_count = 2 * side * side, .corner_count = 6 * side * side, .extra_count = 1 };
	static const uint8_t corner[6][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 0 }, { 1, 1 }, { 0, 1 } };
	size_t at = 0;

	e.primitive_count = e.element_count;
	e.corners = malloc(e.element_count);
	memset(e.corners, 3, e.element_count);
	e.position = malloc(e.corner_count * 12);
	e.uv = malloc(e.corner_count * 8);
	e.extra = malloc(e.element_count * 4);
	for (uint32_t y = 0; y < side; y++)
		for (uint32_t x = 0; x < side; x++)
			for (unsigned c = 0; c < 6; c++, at++) {
				int32_t u = (int32_t)(x + corner[c][0]), v = (int32_t)(y + corner[c][1]);

				e.position[3 * at] = 10 * u;
				e.position[3 * at + 1] = 10 * v;
				e.position[3 * at + 2] = u * u / 3 + v * u % 4;
				e.uv[2 * at] = 100 * (x >= side / 2 ? u - 5 : u);
				e.uv[2 * at + 1] = 50 * v;
				e.extra[at / 3] = x < 4;
			}
	return e;
}

static void connected_wood_is_small_and_keeps_its_texture(void **state)
{
	const struct kind k = { "bark", ECO_LIST_TRIANGLES, ECO_CODER_MESH, ECO_ATTR_COLOR | ECO_ATTR_UV, 3, 3, 0, 0, 0, SCATTERED };
	const struct eco_list list = list_of(&k);
	struct eco_elements in = make_bark(40), out;
	const struct eco_chunk_input input = { &list, &in, 0, in.element_count, 2 };
	struct eco_error error = { 0 };
	struct eco_chunk chunk;
	uint8_t *bytes;
	size_t size;

	(void)state;
	assert_int_equal(eco_chunk_encode(&input, &bytes, &size, NULL, &error), ECO_OK);
	assert_int_equal(bytes[1], ECO_CODER_MESH);
	/* Under 2 bytes a vertex for the positions and as much for texture and colours. */
	assert_true(size < 41 * 41 * 4);
	chunk = describe(&in, 0, in.element_count, size);
	assert_int_equal(eco_chunk_decode(&list, &chunk, 2, bytes, size, &out, &error), ECO_OK);
	assert_same(&k, &in, 0, in.element_count, &out, NULL);
	free(bytes);
	eco_elements_free(&in);
	eco_elements_free(&out);
}

/* Edgebreaker alone loses duplicates and tangles; the chunk must not. */
static void no_wood_triangle_is_lost(void **state)
{
	static const int32_t corners[4][3] = { { 0, 0, 0 }, { 9, 0, 0 }, { 0, 9, 0 }, { 0, 0, 9 } };
	static const uint8_t cases[][4][3] = {
		{ { 0, 1, 2 }, { 0, 1, 2 }, { 0, 1, 2 }, { 0, 1, 2 } },        /* duplicates */
		{ { 0, 1, 2 }, { 0, 2, 1 }, { 0, 1, 2 }, { 0, 2, 1 } },        /* both sides */
		{ { 0, 1, 2 }, { 0, 1, 3 }, { 1, 0, 2 }, { 1, 0, 3 } },        /* four on one edge */
		{ { 0, 1, 2 }, { 0, 2, 3 }, { 0, 3, 1 }, { 1, 3, 2 } },        /* a tetrahedron */
		{ { 1, 0, 2 }, { 0, 2, 3 }, { 0, 3, 1 }, { 1, 3, 2 } },        /* one face turned */
	};

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		const struct kind k = { "tangle", ECO_LIST_TRIANGLES, ECO_CODER_MESH, ECO_ATTR_COLOR, 3, 3, 0, 0, 0, SCATTERED };
		const struct eco_list list = list_of(&k);
		uint8_t threes[4] = { 3, 3, 3, 3 };
		int32_t position[36], color[4] = { 5, 6, 7, 8 };
		struct eco_elements in = { 4, 12, 4, 1, threes, position, NULL, color, NULL }, out;
		const struct eco_chunk_input input = { &list, &in, 0, 4, 0 };
		struct eco_error error = { 0 };
		struct eco_chunk chunk;
		uint8_t *bytes;
		size_t size;

		for (int c = 0; c < 12; c++)
			memcpy(position + 3 * c, corners[cases[i][c / 3][c % 3]], 12);
		assert_int_equal(eco_chunk_encode(&input, &bytes, &size, NULL, &error), ECO_OK);
		chunk = describe(&in, 0, 4, size);
		assert_int_equal(eco_chunk_decode(&list, &chunk, 0, bytes, size, &out, &error), ECO_OK);
		assert_same(&k, &in, 0, 4, &out, NULL);
		free(bytes);
		eco_elements_free(&out);
		memcpy(position + 3, position, 12);
		assert_int_equal(eco_chunk_encode(&input, &bytes, &size, NULL, &error), ECO_BAD_INPUT);
		assert_non_null(strstr(error.text, "coincide"));
	}
}

/* The hash is left out here on purpose: the decoder alone must withstand anything. */
static void every_truncation_is_refused(void **state)
{
	(void)state;
	for (size_t i = 0; i < KIND_COUNT; i++) {
		const struct eco_list list = list_of(&kinds[i]);
		uint32_t count = kinds[i].count < 60 ? kinds[i].count : 60;
		struct eco_elements in = make(&kinds[i], count, 5), out;
		const struct eco_chunk_input input = { &list, &in, 0, count, 1 };
		struct eco_chunk chunk;
		uint8_t *bytes, *copy;
		size_t size;

		assert_int_equal(encode(&input, &bytes, &size, NULL, NULL), ECO_OK);
		chunk = describe(&in, 0, count, size);
		for (size_t cut = 0; cut < size; cut++) {
			struct eco_chunk shorter = chunk;

			copy = malloc(cut > 0 ? cut : 1);
			memcpy(copy, bytes, cut);
			assert_int_not_equal(eco_chunk_decode(&list, &chunk, 1, copy, cut, &out, NULL), ECO_OK);
			shorter.size_bytes = (uint32_t)cut;
			assert_int_not_equal(eco_chunk_decode(&list, &shorter, 1, copy, cut, &out, NULL), ECO_OK);
			assert_null(out.position);
			free(copy);
		}
		free(bytes);
		eco_elements_free(&in);
	}
}

static void assert_bounded(const struct eco_list *list, const struct eco_chunk *chunk, const struct eco_elements *out)
{
	assert_int_equal(out->element_count, chunk->element_count);
	assert_int_equal(out->primitive_count, chunk->primitive_count);
	assert_int_equal(out->extra_count, eco_list_extra_count(list));
	for (size_t i = 0; i < 3 * (size_t)out->corner_count; i++)
		assert_true(abs(out->position[i]) <= VALUE_MAX);
	for (size_t i = 0; out->uv != NULL && i < 2 * (size_t)out->corner_count; i++)
		assert_true(abs(out->uv[i]) <= VALUE_MAX);
	for (size_t i = 0; i < (size_t)out->element_count * out->extra_count; i++)
		assert_true(abs(out->extra[i]) <= VALUE_MAX);
}

static void every_flipped_bit_is_refused_or_bounded(void **state)
{
	(void)state;
	for (size_t i = 0; i < KIND_COUNT; i++) {
		const struct eco_list list = list_of(&kinds[i]);
		uint32_t count = kinds[i].count < 10 ? kinds[i].count : 10;
		struct eco_elements in = make(&kinds[i], count, 6), out;
		const struct eco_chunk_input input = { &list, &in, 0, count, 1 };
		struct eco_chunk chunk;
		uint8_t *bytes;
		size_t size;

		assert_int_equal(encode(&input, &bytes, &size, NULL, NULL), ECO_OK);
		chunk = describe(&in, 0, count, size);
		for (size_t bit = 0; bit < 8 * size; bit++) {
			bytes[bit / 8] ^= (uint8_t)(1 << bit % 8);
			if (eco_chunk_decode(&list, &chunk, 1, bytes, size, &out, NULL) == ECO_OK)
				assert_bounded(&list, &chunk, &out);
			eco_elements_free(&out);
			bytes[bit / 8] ^= (uint8_t)(1 << bit % 8);
		}
		free(bytes);
		eco_elements_free(&in);
	}
}

/* Leaves that all show the whole picture pay nothing for it, but for a few bytes a chunk. */
static void equal_texture_coordinates_are_free(void **state)
{
	const struct kind *k = &kinds[8];
	struct eco_elements in = make(k, 300, 4);
	size_t size[2];

	(void)state;
	assert_string_equal(k->name, "textured quads");
	for (int textured = 0; textured < 2; textured++) {
		const struct eco_list list = { .kind = k->kind, .coder = k->coder, .attributes = textured ? ECO_ATTR_UV : 0 };
		const struct eco_chunk_input input = { &list, &in, 0, 300, 1 };
		uint8_t *bytes;

		assert_int_equal(eco_chunk_encode(&input, &bytes, &size[textured], NULL, NULL), ECO_OK);
		free(bytes);
	}
	assert_true(size[1] < size[0] + 120);
	eco_elements_free(&in);
}

/* Counts in the payload are believed only if the chunk's record says the same. */
static void counts_must_be_those_of_the_record(void **state)
{
	const struct kind *k = &kinds[2];
	const struct eco_list list = list_of(k);
	struct eco_elements in = make(k, 50, 6), out;
	const struct eco_chunk_input input = { &list, &in, 0, 50, 1 };
	struct eco_list other;
	struct eco_chunk chunk, wrong;
	uint8_t *bytes;
	size_t size;

	(void)state;
	assert_int_equal(eco_chunk_encode(&input, &bytes, &size, NULL, NULL), ECO_OK);
	chunk = describe(&in, 0, 50, size);
	wrong = chunk;
	wrong.element_count++;
	assert_int_equal(eco_chunk_decode(&list, &wrong, 1, bytes, size, &out, NULL), ECO_DAMAGED);
	wrong = chunk;
	wrong.primitive_count--;
	assert_int_equal(eco_chunk_decode(&list, &wrong, 1, bytes, size, &out, NULL), ECO_DAMAGED);
	wrong = chunk;
	wrong.element_count = UINT32_MAX;
	assert_int_equal(eco_chunk_decode(&list, &wrong, 1, bytes, size, &out, NULL), ECO_DAMAGED);
	/* A stream with other columns than the list's. */
	other = list;
	other.attributes = 0;
	assert_int_equal(eco_chunk_decode(&other, &chunk, 1, bytes, size, &out, NULL), ECO_DAMAGED);
	other.attributes = ECO_ATTR_UV;
	assert_int_equal(eco_chunk_decode(&other, &chunk, 1, bytes, size, &out, NULL), ECO_DAMAGED);
	other = list;
	other.kind = ECO_LIST_LINES;
	assert_int_equal(eco_chunk_decode(&other, &chunk, 1, bytes, size, &out, NULL), ECO_DAMAGED);
	free(bytes);
	eco_elements_free(&in);
}

static void impossible_input_is_refused(void **state)
{
	const struct kind *k = &kinds[11];
	struct eco_list list = list_of(k);
	struct eco_elements in = make(k, 50, 6);
	struct eco_chunk_input input = { &list, &in, 10, 10, 1 };
	struct eco_error error = { 0 };
	uint8_t *bytes;
	size_t size;

	(void)state;
	assert_int_equal(eco_chunk_encode(&input, &bytes, &size, NULL, &error), ECO_BAD_INPUT);
	input.end = 51;
	assert_int_equal(eco_chunk_encode(&input, &bytes, &size, NULL, NULL), ECO_BAD_INPUT);
	input.end = 50;
	in.corners[30] = 2;
	assert_int_equal(eco_chunk_encode(&input, &bytes, &size, NULL, NULL), ECO_BAD_INPUT);
	in.corners[30] = 1;
	in.position[3 * 30] = VALUE_MAX + 1;
	assert_int_equal(eco_chunk_encode(&input, &bytes, &size, NULL, NULL), ECO_TOO_LARGE);
	in.position[3 * 30] = INT32_MIN;
	assert_int_equal(eco_chunk_encode(&input, &bytes, &size, NULL, NULL), ECO_TOO_LARGE);
	in.position[3 * 30] = 0;
	list.attributes = ECO_ATTR_COLOR | ECO_ATTR_UV;
	assert_int_equal(eco_chunk_encode(&input, &bytes, &size, NULL, NULL), ECO_BAD_INPUT);
	list.attributes = 0xff;
	assert_int_not_equal(eco_chunk_encode(&input, &bytes, &size, NULL, NULL), ECO_OK);
	assert_null(bytes);
	eco_elements_free(&in);
}

static void permutations_are_fair_and_fixed(void **state)
{
	static const uint32_t golden[8] = { 6, 5, 0, 2, 1, 4, 7, 3 };
	uint32_t order[1000], seen[1000] = { 0 }, first[10] = { 0 };

	(void)state;
	eco_chunk_permutation(3, 8, order);
	assert_memory_equal(order, golden, sizeof golden);
	eco_chunk_permutation(0, 1000, order);
	for (int i = 0; i < 1000; i++)
		seen[order[i]]++;
	for (int i = 0; i < 1000; i++)
		assert_int_equal(seen[i], 1);
	for (uint32_t ordinal = 0; ordinal < 10000; ordinal++) {
		eco_chunk_permutation(ordinal, 10, order);
		first[order[0]]++;
	}
	for (int i = 0; i < 10; i++)
		assert_true(first[i] > 850 && first[i] < 1150);       /* 5 standard deviations */
}

static void splits_start_small_and_grow(void **state)
{
	static const struct { uint32_t count, smallest, max; } cases[] = {
		{ 1, 32, 100 }, { 31, 32, 100 }, { 33, 32, 100 }, { 1000, 32, 100 }, { 50000, 32, 100 }, { 1000000, 32, 4096 },
		{ 50000, 256, 4 }, { 50000, 256, 1 }, { 5000000, 32, 20 }, { UINT32_MAX, 1, 5000 }, { 7, 0, 100 },
	};
	static uint32_t ends[5000];

	(void)state;
	assert_int_equal(eco_chunk_split(0, 32, ends, 10), 0);
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		uint32_t n = eco_chunk_split(cases[i].count, cases[i].smallest, ends, cases[i].max), last = 0, before = 0;

		assert_true(n >= 1 && n <= cases[i].max);
		assert_int_equal(ends[n - 1], cases[i].count);
		for (uint32_t k = 0; k < n; k++) {
			uint32_t size = ends[k] - last;

			assert_true(ends[k] > last && size <= ECO_CHUNK_ELEMENTS_MAX);
			if (k + 1 == n && n > 1)
				assert_true(2 * (uint64_t)size >= before);
			before = size;
			last = ends[k];
		}
	}
	/* The stated growth, where the bound does not bind. */
	assert_int_equal(eco_chunk_split(50000, 32, ends, 100), 31);
	assert_int_equal(ends[0], 32);
	assert_int_equal(ends[4], 160);
	assert_int_equal(ends[5], 200);
}

/* The format: these bytes must be read by every later version, and written by this one. */
static void a_small_chunk_is_the_golden_one(void **state)
{
	static const uint8_t golden[] = {
		1, 1, 2, 0, 3, 0, 0, 0, 1, 0, 0, 0, 84, 0, 0, 0, 4, 0, 33, 0, 2, 0, 0, 0, 113, 0, 0, 0, 68, 82, 65, 67, 79, 2,
		3, 0, 0, 0, 0, 1, 0, 0, 0, 1, 4, 0, 5, 3, 0, 0, 4, 5, 3, 0, 1, 4, 5, 3, 0, 2, 4, 5, 1, 0, 3, 1, 1, 1, 1, 254,
		1, 0, 9, 31, 1, 64, 1, 0, 200, 100, 5, 254, 1, 0, 6, 19, 1, 64, 1, 0, 20, 0, 254, 1, 0, 6, 19, 1, 64, 1, 0,
		138, 26, 254, 1, 1, 3, 1, 1, 64, 1, 0, 68, 82, 65, 67, 79, 2, 3, 0, 0, 0, 0, 2, 0, 0, 0, 1, 5, 0, 5, 3, 0, 0,
		4, 5, 3, 0, 1, 4, 5, 3, 0, 2, 4, 5, 3, 0, 3, 4, 5, 1, 0, 4, 1, 1, 1, 1, 1, 254, 1, 1, 4, 11, 1, 32, 35, 1, 32,
		3, 0, 248, 143, 254, 1, 1, 4, 19, 173, 42, 67, 85, 21, 3, 58, 149, 138, 254, 1, 0, 6, 19, 1, 64, 1, 0, 0, 80,
		32, 5, 254, 1, 0, 2, 3, 1, 64, 1, 0, 4, 254, 1, 1, 4, 5, 7, 1, 32, 3, 1, 32, 3, 0, 208, 128
	};
	const struct eco_list list = { .kind = ECO_LIST_TRIANGLES, .coder = ECO_CODER_ELEMENTS, .attributes = ECO_ATTR_COLOR };
	uint8_t corners[3] = { 4, 3, 4 };
	int32_t position[33] = { 0, 0, 0, 9, 0, 0, 9, 9, 1, 0, 9, 1, 100, 50, -3, 110, 50, -3, 105, 60, 0, 5, 5, 5, 5, 14, 5, 5, 14, 15,
		5, 5, 14 };
	int32_t color[3] = { 2, 0, 1 };
	struct eco_elements in = { 3, 11, 5, 1, corners, position, NULL, color, NULL }, out;
	const struct eco_chunk_input input = { &list, &in, 0, 3, 0 };
	const struct kind k = { "golden", ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR, 3, 4, 3, 0, 0, SCATTERED };
	struct eco_chunk chunk;
	uint32_t order[3];
	uint8_t *bytes;
	size_t size;

	(void)state;
	assert_int_equal(eco_chunk_encode(&input, &bytes, &size, order, NULL), ECO_OK);
	assert_int_equal(size, sizeof golden);
	assert_memory_equal(bytes, golden, size);
	chunk = describe(&in, 0, 3, sizeof golden);
	assert_int_equal(eco_chunk_decode(&list, &chunk, 0, golden, sizeof golden, &out, NULL), ECO_OK);
	assert_same(&k, &in, 0, 3, &out, order);
	free(bytes);
	eco_elements_free(&out);
}

static void names_are_xxh3_of_the_payload(void **state)
{
	/* XXH3-128 of no bytes, as the xxhsum program prints it. */
	static const uint8_t empty[16] = { 0x99, 0xaa, 0x06, 0xd3, 0x01, 0x47, 0x98, 0xd8, 0x60, 0x01, 0xc3, 0x24, 0x46, 0x8d, 0x49, 0x7f };
	struct eco_chunk_id id = eco_chunk_hash((const uint8_t *)"", 0);

	(void)state;
	assert_memory_equal(id.bytes, empty, sizeof empty);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_goes_in_comes_out),
		cmocka_unit_test(the_same_elements_give_the_same_bytes),
		cmocka_unit_test(forms_follow_their_elements),
		cmocka_unit_test(first_chunks_keep_their_order),
		cmocka_unit_test(ground_is_predicted_from_its_neighbours),
		cmocka_unit_test(connected_wood_is_small_and_keeps_its_texture),
		cmocka_unit_test(no_wood_triangle_is_lost),
		cmocka_unit_test(every_truncation_is_refused),
		cmocka_unit_test(every_flipped_bit_is_refused_or_bounded),
		cmocka_unit_test(equal_texture_coordinates_are_free),
		cmocka_unit_test(counts_must_be_those_of_the_record),
		cmocka_unit_test(impossible_input_is_refused),
		cmocka_unit_test(permutations_are_fair_and_fixed),
		cmocka_unit_test(splits_start_small_and_grow),
		cmocka_unit_test(a_small_chunk_is_the_golden_one),
		cmocka_unit_test(names_are_xxh3_of_the_payload),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
