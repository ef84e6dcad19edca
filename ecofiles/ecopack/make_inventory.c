/* Rows of inventories on their way into the pack: a block is coded as soon as it is full, so that only one is
 * held as rows. */
#include "ecofiles/ecopack/make.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/room.h"

struct make_inventory {
	struct eco_inventory_row rows[ECO_INVENTORY_PLACES];
	uint32_t count;
	struct eco_bytes *blocks;
	uint32_t block_count, block_room;
	char **names;
	uint32_t name_count, name_room;
	const char *species, *file; /* those of the row before */
	bool is_needed;             /* something is to be said of a plant */
};

static enum eco_code no_memory(struct make *m)
{
	return eco_fail(m->error, ECO_NO_MEMORY, "no memory for the rows of inventories");
}

/* Where a name is, or belongs, among the kept ones. */
static uint32_t find_name(const struct make_inventory *in, const char *name)
{
	uint32_t low = 0, high = in->name_count;
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		if (strcmp(in->names[middle], name) < 0)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

/* The kept name that equals `name`, or NULL; `before`: a kept one that it often is. False: no memory. */
static bool keep_name(struct make_inventory *in, const char *name, const char *before, const char **kept)
{
	*kept = name && before && strcmp(before, name) == 0 ? before : NULL;
	if (!name || *kept)
		return true;
	uint32_t at = find_name(in, name);
	if (at == in->name_count || strcmp(in->names[at], name) != 0) {
		char *copy = eco_room(&in->names, &in->name_room, in->name_count, sizeof *in->names)
			? strdup(name)
			: NULL;
		if (!copy)
			return false;
		memmove(in->names + at + 1, in->names + at, (in->name_count++ - at) * sizeof *in->names);
		in->names[at] = copy;
	}
	*kept = in->names[at];
	return true;
}

static enum eco_code close_block(struct make *m)
{
	struct make_inventory *in = m->inventory;
	if (!eco_room(&in->blocks, &in->block_room, in->block_count, sizeof *in->blocks))
		return no_memory(m);
	enum eco_code code =
		eco_inventory_encode(&in->blocks[in->block_count], in->rows, in->count, m->error);
	in->block_count += !code;
	in->count = 0;
	return code;
}

enum eco_code make_inventory_add(struct make *m, const struct eco_inventory_row *row)
{
	struct make_inventory *in = m->inventory;
	if (!in && !(in = m->inventory = calloc(1, sizeof *in)))
		return no_memory(m);
	struct eco_inventory_row *kept = &in->rows[in->count];
	*kept = *row;
	if (!keep_name(in, row->species, in->species, &kept->species) ||
		!keep_name(in, row->file, in->file, &kept->file))
		return no_memory(m);
	in->species = kept->species ? kept->species : in->species;
	in->file = kept->file ? kept->file : in->file;
	in->is_needed = in->is_needed || kept->species || kept->file;
	return ++in->count == ECO_INVENTORY_PLACES ? close_block(m) : ECO_OK;
}

enum eco_code make_inventory_pack(struct make *m)
{
	struct make_inventory *in = m->inventory;
	struct eco_list list = { .kind = ECO_LIST_INVENTORY,
		.coder = ECO_CODER_BYTES,
		.owner = ECO_NONE,
		.grid_step = { 1, 1, 1 },
		.image = ECO_NONE,
		.partner = ECO_NONE };
	uint32_t id;
	if (!in || !in->is_needed)
		return ECO_OK;
	enum eco_code code = in->count ? close_block(m) : ECO_OK;
	if (!code)
		code = eco_pack_add_bytes(m->writer, &list, in->blocks, in->block_count, &id, m->error);
	return code ? code : make_keep_list(m, id);
}

void make_inventory_free(struct make *m)
{
	struct make_inventory *in = m->inventory;
	if (!in)
		return;
	for (uint32_t i = 0; i < in->block_count; i++)
		free(in->blocks[i].at);
	for (uint32_t i = 0; i < in->name_count; i++)
		free(in->names[i]);
	free(in->blocks);
	free(in->names);
	free(in);
	m->inventory = NULL;
}
