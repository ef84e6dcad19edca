#include "client-min/view_owners.h"

#include <stdlib.h>

static uint32_t slot_of(uint64_t owner)
{
	uint32_t h = ((uint32_t)owner ^ (uint32_t)(owner >> 32) * 0x85EBCA77u) * 0x9E3779B1u;
	return h ^ h >> 15;
}

enum eco_code view_owners_make(struct view_owners *owners, const struct view_selection *selection,
	struct eco_error *error)
{
	uint64_t room = 16;
	while (room < 2 * (uint64_t)selection->instance_count)
		room *= 2;
	*owners = (struct view_owners){ selection, calloc(room, sizeof *owners->slots),
		(uint32_t)(room - 1) };
	if (!owners->slots)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for the owners of a picture");
	for (uint32_t i = 0; i < selection->instance_count; i++) {
		uint32_t at = slot_of(selection->instances[i].owner) & owners->mask;
		while (owners->slots[at])
			at = (at + 1) & owners->mask;
		owners->slots[at] = i + 1;
	}
	return ECO_OK;
}

const struct view_instance *view_owners_find(const struct view_owners *owners, uint64_t owner)
{
	const struct view_instance *instances = owners->selection->instances;
	uint32_t at = slot_of(owner) & owners->mask;
	while (owners->slots[at]) {
		const struct view_instance *instance = &instances[owners->slots[at] - 1];
		if (instance->owner == owner)
			return instance;
		at = (at + 1) & owners->mask;
	}
	return NULL;
}

void view_owners_free(struct view_owners *owners)
{
	free(owners->slots);
	*owners = (struct view_owners){ 0 };
}
