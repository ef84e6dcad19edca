/* Chunks: what is encoded is decoded, whatever the coder, in the order that was promised; the format is
 * fixed. */
#include "ecofiles/base/order.h"
#include "ecofiles/base/random.h"
#include "tests/support/chunk_kinds.h"

UNIT_TEST(what_goes_in_comes_out)
{
	for (size_t i = 0; i < KIND_COUNT; i++) {
		const struct kind *k = &kinds[i];
		const struct eco_list list = kind_list(k);
		FREED(eco_elements) in = kind_elements(k, k->count + 7, i + 1), out;
		uint32_t first = k->count > 10 ? 5 : 0, end = first + k->count;
		const struct eco_chunk_input input = { &list, &in, first, end, (uint32_t)i };
		FREED_MEMORY uint32_t *order = kind_ordered(k) ? malloc((end - first) * sizeof *order) : NULL;
		struct eco_error error = { 0 };
		struct eco_chunk chunk;
		FREED_MEMORY uint8_t *bytes;
		size_t size;
		if (kind_encode(&input, &bytes, &size, &error) != ECO_OK
				|| (order && eco_chunk_order(&input, order, &error) != ECO_OK))
			fail_msg("%s: %s", k->name, error.text);
		chunk = kind_chunk(&in, first, end, size);
		if (eco_chunk_decode(&list, &chunk, (uint32_t)i, bytes, size, &out, &error) != ECO_OK)
			fail_msg("%s: %s", k->name, error.text);
		assert_int_equal(out.primitive_count, chunk.primitive_count);
		assert_same_elements(k, &in, first, end, &out, order);
	}
}

#define PLACES 128u

static int by_cell(const void *a, const void *b) { return eco_order_cells(a, b, 2); }

/* Bytes of plants at those x, y and z, which come back as they are. */
static size_t bytes_of_places(const uint32_t (*at)[3], bool turned)
{
	const struct eco_list list = { .kind = ECO_LIST_INSTANCES, .coder = ECO_CODER_ROWS,
		.attributes = ECO_ATTR_PLACE, .image = ECO_NONE, .partner = ECO_NONE };
	uint8_t corners[PLACES];
	int32_t position[3 * PLACES], extra[2 * PLACES];
	const struct eco_elements in = { .element_count = PLACES, .corner_count = PLACES,
		.primitive_count = PLACES, .corners = corners, .position = position, .extra = extra, .extra_count = 2 };
	const struct eco_chunk_input input = { &list, &in, 0, PLACES, 0 };
	FREED(eco_elements) out;
	FREED_MEMORY uint8_t *bytes;
	size_t size;
	memset(corners, 1, sizeof corners);
	for (uint32_t i = 0; i < PLACES; i++) {
		memcpy(position + 3 * (size_t)i, at[i], sizeof *at);
		extra[2 * i] = turned ? (uint16_t)(eco_random(2, i) << 10) : eco_place_turn(position + 3 * (size_t)i);
		extra[2 * i + 1] = 65536;
	}
	assert_int_equal(eco_chunk_encode(&input, &bytes, &size, NULL), ECO_OK);
	const struct eco_chunk chunk = kind_chunk(&in, 0, PLACES, size);
	assert_int_equal(eco_chunk_decode(&list, &chunk, 0, bytes, size, &out, NULL), ECO_OK);
	assert_memory_equal(out.position, position, sizeof position);
	assert_memory_equal(out.extra, extra, sizeof extra);
	return size;
}

/* In columns 41 bits: 28 of x and y, of which a free order is worth log2(128!) / 128, 6, and 13 of z, which a
 * slope says. */
UNIT_TEST(places_in_the_order_of_cells_take_few_bits)
{
	uint32_t at[PLACES][3];
	for (uint32_t i = 0; i < PLACES; i++)
		for (uint32_t k = 0; k < 2; k++)
			at[i][k] = (uint32_t)eco_random(1, 2 * i + k) >> 18;
	for (uint32_t i = 0; i < PLACES; i++)
		at[i][2] = 5000 + at[i][0] / 4 - at[i][1] / 8;
	size_t mixed = bytes_of_places(at, false);
	qsort(at, PLACES, sizeof *at, by_cell);
	size_t sorted = bytes_of_places(at, false);
	print_message("%.1f bits a place, %.1f in any order\n", sorted * 8.0 / PLACES, mixed * 8.0 / PLACES);
	assert_true(8 * sorted < 33 * PLACES && 8 * mixed < 36 * PLACES && sorted < mixed);
	assert_in_range(8 * (bytes_of_places(at, true) - sorted), 6 * PLACES, 7 * PLACES);
	for (uint32_t i = 0; i < PLACES; i++)
		memcpy(at[i], (uint32_t[3]){ 7, 7, 7 }, sizeof *at);
	assert_true(bytes_of_places(at, false) < 64);
}

/* Forms are coded in the partner's stored order; twin: the partner's own report of its draw order. */
UNIT_TEST(forms_follow_their_elements)
{
	static const struct { uint8_t low, high, form; } cases[] = {
		{ 3, 3, 1 }, { 3, 6, 1 }, { 6, 6, 1 }, { 3, 6, 3 }, { 5, 6, 4 }, { 4, 4, 4 },
	};
	enum { COUNT = 300, FIRST = 20, END = 270 };

	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		const struct kind fan = { "fans", ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR,
			cases[i].low, cases[i].high, COUNT, 0, 4095, SCATTERED };
		const struct kind form = { "forms", cases[i].form == 1 ? ECO_LIST_POINTS : ECO_LIST_TRIANGLES,
			ECO_CODER_FORM, cases[i].form == 1 ? ECO_ATTR_COLOR | ECO_ATTR_SIZE
			: ECO_ATTR_UV | ECO_ATTR_GROWTH, cases[i].form, cases[i].form, COUNT, 0, 4095,
			SCATTERED };
		const struct eco_list fans = kind_list(&fan), forms = kind_list(&form);
		FREED(eco_elements) in = kind_elements(&fan, COUNT, i),
			other = kind_elements(&form, COUNT, i + 50), out;
		const struct eco_chunk_input input = { &fans, &in, FIRST, END, 9 };
		uint32_t order[END - FIRST];
		struct eco_chunk chunk;
		uint8_t *bytes;
		size_t size;

		assert_good(eco_chunk_order(&input, order, &cause));
		assert_good(eco_chunk_encode_form(&input, &forms, &other, &bytes, &size, &cause));
		chunk = kind_chunk(&other, FIRST, END, size);
		assert_good(eco_chunk_decode(&forms, &chunk, 9, bytes, size, &out, &cause));
		assert_same_elements(&form, &other, FIRST, END, &out, order);
		free(bytes);
	}
}

/* The first chunks are drawn in the order that they came in: of one corner count strictly, else each corner
 * count's elements among themselves. */
UNIT_TEST(first_chunks_keep_their_order)
{
	static const struct { uint8_t low, high; uint32_t first, end; bool kept; } cases[] =
		{ { 4, 4, 0, 32, true }, { 3, 3, 32, 64, true },
		{ 4, 4, 0, 1, true }, { 3, 6, 0, 48, true }, { 4, 4, 64, 128, true },
		{ 4, 4, 200, 250, false }, { 4, 4, 0, 300, false } };

	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		const struct kind k = { "fans", ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR,
			cases[i].low, cases[i].high, 300, 0, 4095, LEAVES };
		const struct eco_list list = kind_list(&k);
		FREED(eco_elements) in = kind_elements(&k, 300, i), out;
		const struct eco_chunk_input input = { &list, &in, cases[i].first, cases[i].end,
			(uint32_t)i };
		uint32_t order[300], last[ECO_CORNERS_MAX + 1] = { 0 }, falls = 0;
		FREED_MEMORY uint8_t *bytes;
		size_t size;
		assert_int_equal(eco_chunk_encode(&input, &bytes, &size, NULL), ECO_OK);
		assert_int_equal(eco_chunk_order(&input, order, NULL), ECO_OK);
		for (uint32_t e = 0; e < cases[i].end - cases[i].first; e++) {
			uint32_t *before = &last[in.corners[cases[i].first + order[e]]];
			falls += order[e] < *before;
			*before = order[e];
		}
		assert_true(cases[i].kept ? falls == 0 : falls > 10);
		struct eco_chunk chunk = kind_chunk(&in, cases[i].first, cases[i].end, size);
		assert_int_equal(eco_chunk_decode(&list, &chunk, (uint32_t)i, bytes, size, &out, NULL),
			ECO_OK);
		assert_same_elements(&k, &in, cases[i].first, cases[i].end, &out, order);
	}
}

/* Whole rows of samples, by their neighbours: smooth, rough, rounded but for the border, with large values,
 * of one row or column. All come back, and what is cut off is refused. */
UNIT_TEST(ground_in_rows_comes_back_in_fewer_bits)
{
	static const struct { uint32_t columns, rows, rough, rounded; double most_bits; } cases[] = {
		{ 60, 70, 1, 0, 1.2 }, { 67, 67, 16, 0, 5 }, { 67, 67, 1, 5, 1.6 }, { 1, 50, 8, 0, 8 },
		{ 50, 1, 8, 0, 8 }, { 1, 1, 1, 0, 99 }, { 9, 9, 1u << 28, 0, 34 }, { 2, 3, 8, 0, 60 } };
	for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
		uint32_t columns = cases[c].columns, count = columns * cases[c].rows, seed = 1;
		const struct eco_list list = { .kind = ECO_LIST_GROUND, .coder = ECO_CODER_ROWS,
			.columns = columns };
		FREED_MEMORY uint8_t *corners = calloc(count, 1), *bytes;
		FREED_MEMORY int32_t *position = calloc(3 * (size_t)count, sizeof *position);
		struct eco_elements in = { count, count, count, 0, corners, position, NULL, NULL, NULL, NULL }, out;
		for (uint32_t i = 0; i < count; i++) {
			uint32_t x = i % columns, y = i / columns, border = x == 0 || y == 0
				|| x == columns - 1 || y == cases[c].rows - 1;
			seed = seed * 1664525 + 1013904223;
			corners[i] = 1;
			position[3 * i] = (int32_t)(4 * x + (x > 3)) - 30;
			position[3 * i + 1] = (int32_t)(4 * y) - 7;
			position[3 * i + 2] = (int32_t)((seed >> 4) % cases[c].rough) - (int32_t)(x * y / 8)
				- 1000;
			if (!border)
				position[3 * i + 2] &= -(1 << cases[c].rounded);
		}
		const struct eco_chunk_input input = { &list, &in, 0, count, 0 };
		size_t size;
		assert_good(eco_chunk_encode(&input, &bytes, &size, &cause));
		assert_true(8.0 * (double)(size - 5) <= cases[c].most_bits * count + 80);
		struct eco_chunk chunk = { .size_bytes = (uint32_t)size, .element_count = count,
			.primitive_count = count };
		assert_good(eco_chunk_decode(&list, &chunk, 0, bytes, size, &out, &cause));
		assert_memory_equal(out.position, position, 12 * count);
		eco_elements_free(&out);
		for (size_t cut = 0; cut < size; cut++) {
			chunk.size_bytes = (uint32_t)cut;
			FREED_MEMORY uint8_t *exact = malloc(cut + 1);
			memcpy(exact, bytes, cut);
			assert_int_equal(eco_chunk_decode(&list, &chunk, 0, exact, cut, &out, NULL),
				ECO_DAMAGED);
		}
	}
}

UNIT_TEST(splits_start_small_and_grow)
{
	static const struct { uint32_t count, smallest, max; } cases[] = {
		{ 1, 32, 100 }, { 31, 32, 100 }, { 33, 32, 100 }, { 1000, 32, 100 }, { 50000, 32, 100 },
			{ 1000000, 32, 4096 },
		{ 50000, 256, 4 }, { 50000, 256, 1 }, { 5000000, 32, 20 }, { UINT32_MAX, 1, 5000 },
		{ 7, 0, 100 },
	};
	static uint32_t ends[5000];
	assert_int_equal(eco_chunk_split(0, 32, ends, 10), 0);
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		uint32_t n = eco_chunk_split(cases[i].count, cases[i].smallest, ends, cases[i].max), last = 0,
			before = 0;
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
UNIT_TEST(a_small_chunk_is_the_golden_one)
{
	static const uint8_t golden[] = {
		1, 1, 2, 0, 3, 0, 3, 0, 0, 1, 0, 0, 0, 19, 0, 0, 0, 4, 0, 3, 33, 0, 2, 0, 0, 0,
		31, 0, 0, 0, 68, 100, 33, 231, 88, 162, 77, 252, 87, 156, 0, 132, 164, 28, 123, 242, 93, 251, 80, 0, 50, 128,
		0, 0, 0, 0, 0, 0, 218, 63, 208, 107, 254, 247, 0, 0, 4, 2, 63, 208, 124, 254, 245, 240, 4, 12, 35, 192,
		139, 32
	};
	const struct eco_list list = { .kind = ECO_LIST_TRIANGLES, .coder = ECO_CODER_ELEMENTS,
		.attributes = ECO_ATTR_COLOR };
	uint8_t corners[3] = { 4, 3, 4 };
	int32_t position[33] = { 0, 0, 0, 9, 0, 0, 9, 9, 1, 0, 9, 1, 100, 50, -3, 110, 50, -3, 105, 60, 0, 5,
		5, 5, 5, 14, 5, 5, 14, 15, 5, 5, 14 };
	int32_t color[3] = { 2, 0, 1 };
	struct eco_elements in = { 3, 11, 5, 1, corners, position, NULL, color, NULL, NULL }, out;
	const struct eco_chunk_input input = { &list, &in, 0, 3, 0 };
	const struct kind k = { "golden", ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR, 3, 4, 3, 0,
		0, SCATTERED };
	struct eco_chunk chunk;
	uint32_t order[3];
	FREED_MEMORY uint8_t *bytes;
	size_t size;

	assert_int_equal(eco_chunk_encode(&input, &bytes, &size, NULL), ECO_OK);
	assert_int_equal(eco_chunk_order(&input, order, NULL), ECO_OK);
	assert_int_equal(size, sizeof golden);
	assert_memory_equal(bytes, golden, size);
	chunk = kind_chunk(&in, 0, 3, sizeof golden);
	assert_int_equal(eco_chunk_decode(&list, &chunk, 0, golden, sizeof golden, &out, NULL), ECO_OK);
	assert_same_elements(&k, &in, 0, 3, &out, order);
	eco_elements_free(&out);
}
