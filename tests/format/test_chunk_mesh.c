/* Connected wood in chunks: small, with its texture, and no triangle of it lost. */
#include "tests/support/chunk_kinds.h"

/* A grid of quads with a seam in its texture, bent; written as single triangles. */
static struct eco_elements make_bark(uint32_t side)
{
	struct eco_elements e = { .element_count = 2 * side * side, .corner_count = 6 * side * side,
		.extra_count = 1 };
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

UNIT_TEST(connected_wood_is_small_and_keeps_its_texture)
{
	const struct kind k = { "bark", ECO_LIST_TRIANGLES, ECO_CODER_MESH, ECO_ATTR_COLOR | ECO_ATTR_UV, 3,
		3, 0, 0, 0, SCATTERED };
	const struct eco_list list = kind_list(&k);
	FREED(eco_elements) in = make_bark(40), out;
	const struct eco_chunk_input input = { &list, &in, 0, in.element_count, 2 };
	struct eco_chunk chunk;
	FREED_MEMORY uint8_t *bytes;
	size_t size;
	assert_good(eco_chunk_encode(&input, &bytes, &size, &cause));
	assert_int_equal(bytes[1], ECO_CODER_MESH);
	/* Under 2 bytes a vertex for the positions and as much for texture and colours. */
	assert_true(size < 41 * 41 * 4);
	chunk = kind_chunk(&in, 0, in.element_count, size);
	assert_good(eco_chunk_decode(&list, &chunk, 2, bytes, size, &out, &cause));
	assert_same_elements(&k, &in, 0, in.element_count, &out, NULL);
}

/* Rows of quads are parts: they come back in their order, whatever edgebreaker makes of the triangles. */
UNIT_TEST(parts_of_wood_keep_their_order)
{
	const struct kind k = { "bark", ECO_LIST_TRIANGLES, ECO_CODER_MESH, ECO_ATTR_COLOR | ECO_ATTR_UV, 3,
		3, 0, 0, 0, SCATTERED };
	const struct eco_list list = kind_list(&k);
	FREED(eco_elements) in = make_bark(40), out;
	const struct eco_chunk_input input = { &list, &in, 0, in.element_count, 2 };
	FREED_MEMORY uint8_t *bytes;
	size_t size, without;
	assert_good(eco_chunk_encode(&input, &bytes, &without, &cause));
	free(bytes);
	in.part = malloc(in.element_count * sizeof *in.part);
	for (uint32_t i = 0; i < in.element_count; i++)
		in.part[i] = (int32_t)(i / 400);
	assert_good(eco_chunk_encode(&input, &bytes, &size, &cause));
	assert_int_equal(bytes[1], ECO_CODER_MESH);
	assert_true(size < without + 200);       /* half a bit a triangle */
	struct eco_chunk chunk = kind_chunk(&in, 0, in.element_count, size);
	assert_good(eco_chunk_decode(&list, &chunk, 2, bytes, size, &out, &cause));
	assert_same_elements(&k, &in, 0, in.element_count, &out, NULL);
	assert_null(out.part);
	for (uint32_t i = 0; i < out.element_count; i++) {
		const int32_t *y = out.position + 9 * (size_t)i + 1;
		int32_t low = y[0] < y[3] ? y[0] : y[3];
		low = low < y[6] ? low : y[6];
		assert_int_equal(low / 50, (int)i / 400);     /* 5 rows of 80 triangles, 10 high each */
	}
}

/* Edgebreaker alone loses duplicates and tangles; the chunk must not. */
UNIT_TEST(no_wood_triangle_is_lost)
{
	static const int32_t corners[4][3] = { { 0, 0, 0 }, { 9, 0, 0 }, { 0, 9, 0 }, { 0, 0, 9 } };
	static const uint8_t cases[][4][3] = {
		{ { 0, 1, 2 }, { 0, 1, 2 }, { 0, 1, 2 }, { 0, 1, 2 } },        /* duplicates */
		{ { 0, 1, 2 }, { 0, 2, 1 }, { 0, 1, 2 }, { 0, 2, 1 } },        /* both sides */
		{ { 0, 1, 2 }, { 0, 1, 3 }, { 1, 0, 2 }, { 1, 0, 3 } },        /* four on one edge */
		{ { 0, 1, 2 }, { 0, 2, 3 }, { 0, 3, 1 }, { 1, 3, 2 } },        /* a tetrahedron */
		{ { 1, 0, 2 }, { 0, 2, 3 }, { 0, 3, 1 }, { 1, 3, 2 } },        /* one face turned */
		{ { 0, 1, 2 }, { 0, 0, 3 }, { 0, 3, 1 }, { 1, 3, 2 } },        /* two corners coincide */
	};

	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		const struct kind k = { "tangle", ECO_LIST_TRIANGLES, ECO_CODER_MESH, ECO_ATTR_COLOR, 3, 3, 0,
			0, 0, SCATTERED };
		const struct eco_list list = kind_list(&k);
		uint8_t threes[4] = { 3, 3, 3, 3 };
		int32_t position[36], color[4] = { 5, 6, 7, 8 };
		int32_t part[4] = { 0, 3, 4, 9 };
		struct eco_elements in = { 4, 12, 4, 1, threes, position, NULL, color, NULL, part }, out;
		const struct eco_chunk_input input = { &list, &in, 0, 4, 0 };
		struct eco_chunk chunk;
		FREED_MEMORY uint8_t *bytes;
		size_t size;
		for (int c = 0; c < 12; c++)
			memcpy(position + 3 * c, corners[cases[i][c / 3][c % 3]], 12);
		assert_good(eco_chunk_encode(&input, &bytes, &size, &cause));
		chunk = kind_chunk(&in, 0, 4, size);
		assert_good(eco_chunk_decode(&list, &chunk, 0, bytes, size, &out, &cause));
		assert_same_elements(&k, &in, 0, 4, &out, NULL);
		assert_memory_equal(out.extra, color, sizeof color);     /* each is a part */
		eco_elements_free(&out);
	}
}
