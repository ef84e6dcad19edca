#include "tests/support/chunk_kinds.h"

#include "tests/support/scene_builder.h"

enum { TRIANGLES = ECO_LIST_TRIANGLES, LINES = ECO_LIST_LINES, POINTS = ECO_LIST_POINTS,
	INSTANCES = ECO_LIST_INSTANCES, GROUND = ECO_LIST_GROUND };
enum { ELEMENTS = ECO_CODER_ELEMENTS, FORM = ECO_CODER_FORM, KD = ECO_CODER_KD, ROWS = ECO_CODER_ROWS,
	MESH = ECO_CODER_MESH };
enum { COLOR = ECO_ATTR_COLOR, UV = ECO_ATTR_UV, WIDTH = ECO_ATTR_WIDTH, PLANT = ECO_ATTR_PLANT,
	PLACE = ECO_ATTR_PLACE, SIZE = ECO_ATTR_SIZE, GROWTH = ECO_ATTR_GROWTH };

const struct kind kinds[KIND_COUNT] = {
	{ "one triangle", TRIANGLES, ELEMENTS, 0, 3, 3, 1, 0, 4095, SCATTERED },
	{ "one hexagon with everything", TRIANGLES, ELEMENTS, COLOR | UV, 6, 6, 1, -9, 9, SCATTERED },
	{ "quads", TRIANGLES, ELEMENTS, COLOR, 4, 4, 500, 0, 4095, LEAVES },
	{ "hexagons", TRIANGLES, ELEMENTS, 0, 6, 6, 300, 0, 4095, LEAVES },
	{ "mixed fans", TRIANGLES, ELEMENTS, COLOR | UV, 3, 6, 700, -5000, 5000, SCATTERED },
	{ "equal quads", TRIANGLES, ELEMENTS, COLOR, 4, 4, 100, -7, -7, EQUAL },
	{ "18 bits", TRIANGLES, ELEMENTS, 0, 3, 6, 100, 0, (1 << 18) - 1, EXTREME },
	{ "all the range", TRIANGLES, ELEMENTS, UV, 3, 6, 60, -VALUE_MAX, VALUE_MAX, EXTREME },
	{ "textured quads", TRIANGLES, ELEMENTS, UV, 4, 4, 300, 0, 4095, LEAVES },
	{ "lines", LINES, ELEMENTS, COLOR | WIDTH, 2, 2, 400, -2000, 2000, SCATTERED },
	{ "one point", POINTS, ELEMENTS, 0, 1, 1, 1, -1, 1, SCATTERED },
	{ "points", POINTS, ELEMENTS, COLOR, 1, 1, 1000, 0, 4095, SCATTERED },
	{ "one summary point", POINTS, KD, PLANT, 1, 1, 1, -5, 5, SCATTERED },
	{ "summary", POINTS, KD, PLANT | COLOR, 1, 1, 900, -3000, 3000, SCATTERED },
	{ "bare kd", POINTS, KD, 0, 1, 1, 900, 0, 4095, SCATTERED },
	{ "equal kd", POINTS, KD, PLANT, 1, 1, 300, 12, 12, EQUAL },
	{ "wide kd", POINTS, KD, COLOR, 1, 1, 100, -VALUE_MAX, VALUE_MAX, EXTREME },
	{ "points in rows", POINTS, ROWS, COLOR, 1, 1, 50, 0, 99, SCATTERED },
	{ "one instance", INSTANCES, ROWS, PLACE, 1, 1, 1, -9, 9, SCATTERED },
	{ "instances", INSTANCES, ROWS, PLACE, 1, 1, 600, -40000, 40000, SCATTERED },
	{ "far instances", INSTANCES, ROWS, PLACE, 1, 1, 90, -VALUE_MAX, VALUE_MAX, EXTREME },
	{ "ground", GROUND, ROWS, 0, 1, 1, 600, 0, 4095, SCATTERED },
	{ "far ground", GROUND, ROWS, 0, 1, 1, 100, -VALUE_MAX, VALUE_MAX, EXTREME },
	{ "one point form", POINTS, FORM, SIZE, 1, 1, 1, -9, 9, SCATTERED },
	{ "point forms", POINTS, FORM, COLOR | SIZE, 1, 1, 500, 0, 4095, SCATTERED },
	{ "textured point forms", POINTS, FORM, UV, 1, 1, 40, 0, 4095, SCATTERED },
	{ "line forms", LINES, FORM, COLOR | WIDTH, 2, 2, 300, -2000, 2000, SCATTERED },
	{ "triangle forms", TRIANGLES, FORM, COLOR | GROWTH, 3, 3, 300, 0, 4095, LEAVES },
	{ "quad forms", TRIANGLES, FORM, UV | GROWTH, 4, 4, 300, 0, 4095, LEAVES },
	{ "far quad forms", TRIANGLES, FORM, 0, 4, 4, 90, -VALUE_MAX, VALUE_MAX, EXTREME },
	{ "growing fans", TRIANGLES, ELEMENTS, COLOR | GROWTH, 3, 6, 400, 0, 4095, LEAVES },
	{ "sized points", POINTS, ELEMENTS, COLOR | SIZE, 1, 1, 400, 0, 4095, SCATTERED },
	{ "sized summary", POINTS, KD, COLOR | PLANT | SIZE, 1, 1, 400, 0, 4095, SCATTERED },
	{ "one wood triangle", TRIANGLES, MESH, 0, 3, 3, 1, 0, 50, SCATTERED },
	{ "wood soup", TRIANGLES, MESH, COLOR | UV, 3, 3, 200, 0, 4095, SCATTERED },
	{ "tangled wood", TRIANGLES, MESH, COLOR, 3, 3, 400, 0, 5, SCATTERED },
	{ "far wood", TRIANGLES, MESH, UV, 3, 3, 40, -VALUE_MAX, VALUE_MAX, EXTREME },
};

static int32_t between(uint64_t *state, int32_t low, int32_t high)
{
	return low + (int32_t)(lcg_bits(state) % ((uint64_t)((int64_t)high - low) + 1));
}

static int32_t coordinate(const struct kind *k, uint64_t *state)
{
	if (k->pattern == EXTREME)
		return lcg_bits(state) & 1 ? k->high : lcg_bits(state) & 1 ? k->low
			: between(state, k->low, k->high);
	return between(state, k->low, k->high);
}

static void fill_corner(const struct kind *k, uint64_t *state, int32_t *position, unsigned corner)
{
	static const int8_t hexagon[6][2] = { { 2, 0 }, { 1, 2 }, { -1, 2 }, { -2, 0 }, { -1, -2 },
		{ 1, -2 } };
	for (unsigned axis = 0; axis < 3; axis++)
		if (k->pattern == LEAVES && corner > 0)
			position[3 * corner + axis] = position[axis] + 9 * hexagon[corner][axis % 2]
				+ between(state, -1, 1);
		else
			position[3 * corner + axis] = coordinate(k, state);
}

static bool coincide(const int32_t *p)
{
	return memcmp(p, p + 3, 12) == 0 || memcmp(p + 3, p + 6, 12) == 0 || memcmp(p, p + 6, 12) == 0;
}

struct eco_list kind_list(const struct kind *k)
{
	return (struct eco_list){ .kind = k->kind, .coder = k->coder, .attributes = k->attributes,
		.columns = k->kind == ECO_LIST_GROUND };
}

struct eco_elements kind_elements(const struct kind *k, uint32_t count, uint64_t seed)
{
	const struct eco_list list = kind_list(k);
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
		if (k->kind == ECO_LIST_GROUND)  /* a column */
			position[0] = 7;
		for (unsigned c = 0; e.uv && c < 2u * corners; c++)
			e.uv[2 * (size_t)e.corner_count + c] = k->pattern == LEAVES
				? (int32_t)(c / 2 + c % 2) % 3 * ECO_UV_ONE
				: between(&state, -100, ECO_UV_ONE);
		for (unsigned c = 0; c < e.extra_count; c++)
			e.extra[(size_t)e.extra_count * i + c] = k->pattern == EQUAL ? 3
				: between(&state, 0, 65535 + (int)c);
		e.corner_count += corners;
		e.primitive_count += corners < 3 ? 1 : corners - 2u;
	}
	return e;
}

struct eco_chunk kind_chunk(const struct eco_elements *e, uint32_t first, uint32_t end, size_t size)
{
	struct eco_chunk chunk = { .size_bytes = (uint32_t)size, .element_count = end - first };
	for (uint32_t i = first; i < end; i++)
		chunk.primitive_count += e->corners[i] < 3 ? 1 : e->corners[i] - 2u;
	return chunk;
}

enum eco_code kind_encode(const struct eco_chunk_input *input, uint8_t **bytes, size_t *size,
	struct eco_error *error)
{
	const struct eco_list fans = { .kind = ECO_LIST_TRIANGLES, .coder = ECO_CODER_ELEMENTS };
	uint32_t count = input->elements->element_count;
	struct eco_elements of = { .element_count = count, .corner_count = 3 * count,
		.primitive_count = count };
	const struct eco_chunk_input partner = { &fans, &of, input->first, input->end, input->ordinal };
	enum eco_code code;
	if (input->list->coder != ECO_CODER_FORM)
		return eco_chunk_encode(input, bytes, size, error);
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
			const int32_t *a = e->position + 3 * ((size_t)corner + c),
				*b = e->position + 3 * ((size_t)corner + first);
			if (a[0] != b[0] ? a[0] < b[0] : a[1] != b[1] ? a[1] < b[1] : a[2] < b[2])
				first = c;
		}
	}
	for (unsigned c = 0; c < n; c++) {
		memcpy(flat + 1 + 3 * c, e->position + 3 * ((size_t)corner + (c + first) % n), 12);
		if (e->uv)
			memcpy(flat + 1 + 3 * ECO_CORNERS_MAX + 2 * c,
				e->uv + 2 * ((size_t)corner + (c + first) % n), 8);
	}
	if (e->extra_count > 0)
		memcpy(flat + 1 + 5 * ECO_CORNERS_MAX, e->extra + (size_t)e->extra_count * element,
			4 * e->extra_count);
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

void assert_same_elements(const struct kind *k, const struct eco_elements *in, uint32_t first, uint32_t end,
	const struct eco_elements *out, const uint32_t *order)
{
	int32_t *a = flatten_all(in, first, end, k->coder == ECO_CODER_MESH);
	int32_t *b = flatten_all(out, 0, out->element_count, k->coder == ECO_CODER_MESH);
	size_t record = FLAT * sizeof *a;
	assert_int_equal(out->element_count, end - first);
	if (!order) {
		qsort(a, end - first, record, compare_flat);
		qsort(b, end - first, record, compare_flat);
	}
	for (uint32_t i = 0; i < end - first; i++)
		assert_memory_equal(b + (size_t)i * FLAT, a + (size_t)(!order ? i : order[i]) * FLAT, record);
	free(a);
	free(b);
}

bool kind_ordered(const struct kind *k)
{
	return k->coder == ECO_CODER_ELEMENTS || k->coder == ECO_CODER_ROWS;
}
