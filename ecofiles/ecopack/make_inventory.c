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

/* The kept name that equals `name`, or NULL; `before`: a kept one that it often is. False: no memory. */
static bool keep_name(struct make_inventory *in, const char *name, const char *before, const char **kept)
{
	*kept = !name ? NULL : before && strcmp(before, name) == 0 ? before : NULL;
	for (uint32_t i = 0; name && !*kept && i < in->name_count; i++)
		if (strcmp(in->names[i], name) == 0)
			*kept = in->names[i];
	if (!name || *kept)
		return true;
	if (!eco_room(&in->names, &in->name_room, in->name_count, sizeof *in->names) ||
		!(in->names[in->name_count] = strdup(name)))
		return false;
	*kept = in->names[in->name_count++];
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
