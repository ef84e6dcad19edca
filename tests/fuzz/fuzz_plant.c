/* Finished plants from a cache, of which nothing is believed. One that is read must be safe to write and to
 * pack. */
#include <assert.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk_payload.h"
#include "lod/build/plant_bytes.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static void touch(const struct lod_plant *plant)
{
	for (uint32_t i = 0; i < plant->list_count; i++) {
		const struct lod_list_draft *draft = &plant->lists[i];
		const struct eco_elements *e = &draft->elements;
		uint64_t corners = 0;
		for (uint32_t k = 0; k < e->element_count; k++)
			corners += e->corners[k];
		assert(corners == e->corner_count && e->extra_count == eco_list_extra_count(&draft->list));
		assert(draft->list.partner == ECO_NONE || draft->list.partner < plant->list_count);
		assert(draft->list.image == ECO_NONE || draft->list.image < plant->image_count);
		for (uint32_t k = 0; k < draft->end_count; k++)
			assert(draft->ends[k] <= e->element_count
				&& (k == 0 || draft->ends[k] > draft->ends[k - 1]));
	}
	for (uint32_t i = 0; i < plant->ladder_count; i++)
		assert(plant->ladders[i].anchor < plant->plant.anchor_count);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
	struct eco_error error = { 0 };
	struct eco_writer again = { 0 };
	struct lod_plant plant;
	if (lod_plant_read(&plant, bytes, size, &error) != ECO_OK) {
		assert(error.text[0] != 0 && plant.list_count == 0);
		return 0;
	}
	touch(&plant);
	lod_plant_write(&again, &plant);
	assert(again.failed || (again.size == size && memcmp(again.bytes, bytes, size) == 0));
	eco_writer_free(&again);
	lod_plant_free(&plant);
	return 0;
}
