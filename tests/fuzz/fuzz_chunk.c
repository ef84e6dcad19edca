/* Payloads without their hash: what a decoder must withstand if everything else is forged. The first bytes
 * choose the list and the declared counts: u8 kind, u8 coder, u8 attributes, u8 columns, u16 elements, u16
 * primitives; the rest is the payload. A payload that decodes must keep its promises: counts as declared,
 * values in bounds, and it must encode again. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/chunk_kinds.h"

static void check_elements(const struct eco_list *list, const struct eco_chunk *chunk, const struct eco_elements *e)
{
	const int32_t bound = (1 << 28) - 1;
	uint32_t corners = 0;
	assert(e->element_count == chunk->element_count && e->primitive_count == chunk->primitive_count);
	for (uint32_t i = 0; i < e->element_count; i++)
		corners += e->corners[i];
	assert(corners == e->corner_count);
	for (size_t i = 0; i < 3 * (size_t)corners; i++)
		assert(e->position[i] <= bound && e->position[i] >= -bound);
	assert((e->uv != NULL) == ((list->attributes & ECO_ATTR_UV) != 0));
	for (size_t i = 0; e->uv && i < 2 * (size_t)corners; i++)
		assert(e->uv[i] <= bound && e->uv[i] >= -bound);
	for (size_t i = 0; i < (size_t)e->element_count * e->extra_count; i++)
		assert(e->extra[i] <= bound && e->extra[i] >= -bound);
}

static void encode_again(const struct eco_list *list, const struct eco_elements *e)
{
	const struct eco_chunk_input input = { list, e, 0, e->element_count, 3 };
	struct eco_error error = { 0 };
	uint8_t *bytes;
	size_t size;
	if (kind_encode(&input, &bytes, &size, NULL, &error) != ECO_OK)
		/* A forged mesh may have triangles whose corners coincide. */
		assert(list->coder == ECO_CODER_MESH && error.code == ECO_BAD_INPUT);
	free(bytes);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	struct eco_list list;
	struct eco_chunk chunk;
	struct eco_elements elements;
	if (size < 8)
		return 0;
	list = (struct eco_list){ .kind = bytes[0], .coder = bytes[1], .attributes = bytes[2],
		.columns = bytes[3] };
	chunk = (struct eco_chunk){ .size_bytes = (uint32_t)(size - 8),
		.element_count = bytes[4] | (uint32_t)bytes[5] << 8,
		.primitive_count = bytes[6] | (uint32_t)bytes[7] << 8 };
	if (eco_chunk_decode(&list, &chunk, 3, bytes + 8, size - 8, &elements, NULL) == ECO_OK) {
		check_elements(&list, &chunk, &elements);
		encode_again(&list, &elements);
	}
	eco_elements_free(&elements);
	return 0;
}
