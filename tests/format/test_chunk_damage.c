/* Damaged chunks and impossible input: refused, or bounded by what the record says. The hash is left out on
 * purpose: the decoder alone must withstand anything. */
#include "ecofiles/base/memory.h"
#include "tests/support/chunk_kinds.h"

/* Wood is in parts of four. */
static struct eco_elements damage_elements(const struct kind *kind, uint32_t count, uint64_t seed)
{
	struct eco_elements e = kind_elements(kind, count, seed);
	if (kind->coder == ECO_CODER_MESH)
		e.part = eco_alloc(count, sizeof *e.part);
	for (uint32_t i = 0; e.part && i < count; i++)
		e.part[i] = (int32_t)(i / 4);
	return e;
}

UNIT_TEST(every_truncation_is_refused)
{
	for (size_t i = 0; i < KIND_COUNT; i++) {
		const struct eco_list list = kind_list(&kinds[i]);
		uint32_t count = kinds[i].count < 60 ? kinds[i].count : 60;
		struct eco_elements in = damage_elements(&kinds[i], count, 5), out;
		const struct eco_chunk_input input = { &list, &in, 0, count, 1 };
		struct eco_chunk chunk;
		uint8_t *bytes, *copy;
		size_t size;
		assert_int_equal(kind_encode(&input, &bytes, &size, NULL), ECO_OK);
		chunk = kind_chunk(&in, 0, count, size);
		for (size_t cut = 0; cut < size; cut++) {
			struct eco_chunk shorter = chunk;
			copy = malloc(cut > 0 ? cut : 1);
			memcpy(copy, bytes, cut);
			assert_int_not_equal(eco_chunk_decode(&list, &chunk, 1, copy, cut, &out, NULL),
				ECO_OK);
			shorter.size_bytes = (uint32_t)cut;
			assert_int_not_equal(eco_chunk_decode(&list, &shorter, 1, copy, cut, &out, NULL),
				ECO_OK);
			assert_null(out.position);
			free(copy);
		}
		free(bytes);
		eco_elements_free(&in);
	}
}

static void assert_bounded(const struct eco_list *list, const struct eco_chunk *chunk,
	const struct eco_elements *out)
{
	assert_int_equal(out->element_count, chunk->element_count);
	assert_int_equal(out->primitive_count, chunk->primitive_count);
	assert_int_equal(out->extra_count, eco_list_extra_count(list));
	for (size_t i = 0; i < 3 * (size_t)out->corner_count; i++)
		assert_true(abs(out->position[i]) <= VALUE_MAX);
	for (size_t i = 0; out->uv && i < 2 * (size_t)out->corner_count; i++)
		assert_true(abs(out->uv[i]) <= VALUE_MAX);
	for (size_t i = 0; i < (size_t)out->element_count * out->extra_count; i++)
		assert_true(abs(out->extra[i]) <= VALUE_MAX);
}

UNIT_TEST(every_flipped_bit_is_refused_or_bounded)
{
	for (size_t i = 0; i < KIND_COUNT; i++) {
		const struct eco_list list = kind_list(&kinds[i]);
		uint32_t count = kinds[i].count < 10 ? kinds[i].count : 10;
		struct eco_elements in = damage_elements(&kinds[i], count, 6), out;
		const struct eco_chunk_input input = { &list, &in, 0, count, 1 };
		struct eco_chunk chunk;
		FREED_MEMORY uint8_t *bytes;
		size_t size;
		assert_int_equal(kind_encode(&input, &bytes, &size, NULL), ECO_OK);
		chunk = kind_chunk(&in, 0, count, size);
		for (size_t bit = 0; bit < 8 * size; bit++) {
			bytes[bit / 8] ^= (uint8_t)(1 << bit % 8);
			if (eco_chunk_decode(&list, &chunk, 1, bytes, size, &out, NULL) == ECO_OK)
				assert_bounded(&list, &chunk, &out);
			eco_elements_free(&out);
			bytes[bit / 8] ^= (uint8_t)(1 << bit % 8);
		}
		eco_elements_free(&in);
	}
}

/* Counts in the payload are believed only if the chunk's record says the same. */
UNIT_TEST(counts_must_be_those_of_the_record)
{
	const struct kind *k = &kinds[2];
	const struct eco_list list = kind_list(k);
	struct eco_elements in = kind_elements(k, 50, 6), out;
	const struct eco_chunk_input input = { &list, &in, 0, 50, 1 };
	struct eco_list other;
	struct eco_chunk chunk, wrong;
	FREED_MEMORY uint8_t *bytes;
	size_t size;
	assert_int_equal(eco_chunk_encode(&input, &bytes, &size, NULL), ECO_OK);
	chunk = kind_chunk(&in, 0, 50, size);
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
	eco_elements_free(&in);
}

UNIT_TEST(values_out_of_bounds_are_refused)
{
	static const int32_t values[] = { VALUE_MAX + 1, INT32_MIN };
	const struct eco_list list = kind_list(&kinds[11]);
	FREED(eco_elements) in = kind_elements(&kinds[11], 50, 6);
	const struct eco_chunk_input input = { &list, &in, 10, 50, 1 };
	uint8_t *bytes;
	size_t size;
	for (int i = 0; i < 2; i++) {
		in.position[3 * 30] = values[i];
		assert_int_equal(eco_chunk_encode(&input, &bytes, &size, NULL), ECO_TOO_LARGE);
		assert_null(bytes);
	}
}
