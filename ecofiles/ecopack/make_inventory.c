/* Rows of inventories on their way into the pack: a block is coded as soon as it is full, so that only one is
 * held as rows. */
#include "ecofiles/ecopack/make.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"

struct make_inventory {
	struct eco_inventory_row rows[ECO_INVENTORY_PLACES];
	uint32_t count;
	struct eco_bytes *blocks;
	uint32_t block_count, block_room;
	struct eco_string_pool names;
	uint32_t species, file; /* those of the row before */
	bool is_needed;         /* something is to be said of a plant */
};

static enum eco_code no_memory(struct make *m)
{
	return eco_fail(m->error, ECO_NO_MEMORY, "no memory for the rows of inventories");
}

/* The kept name that equals `name`, or NULL; *number: of a kept one that it often is. False: no memory. */
static bool keep_name(struct eco_string_pool *names, const char *name, uint32_t *number, const char **kept)
{
	*kept = NULL;
	if (!name)
		return true;
	bool is_same = *number < names->count && strcmp(names->items[*number], name) == 0;
	if (!is_same && !eco_string_pool_add(names, name, number))
		return false;
	*kept = names->items[*number];
	return true;
}

static enum eco_code close_block(struct make *m)
{
	struct make_inventory *in = m->inventory;
	if (!eco_array_grow(&in->blocks, &in->block_room, in->block_count, sizeof *in->blocks))
		return no_memory(m);
	enum eco_code code =
		eco_inventory_encode(&in->blocks[in->block_count], in->rows, in->count, m->error);
	in->block_count += !code;
	in->count = 0;
	return code;
}

enum eco_code make_inventory_add(struct make *m, uint32_t plant, const struct eco_inventory_row *row)
{
	struct make_inventory *in = m->inventory;
	if (!in && !(in = m->inventory = calloc(1, sizeof *in)))
		return no_memory(m);
	struct eco_inventory_row *kept = &in->rows[in->count];
	*kept = *row;
	if (!keep_name(&in->names, row->species, &in->species, &kept->species) ||
		!keep_name(&in->names, row->file, &in->file, &kept->file))
		return no_memory(m);
	in->is_needed = in->is_needed || kept->species || kept->file;
	enum eco_code code = make_species_count(m, plant, row->species ? row->species : m->table[plant].name);
	return !code && ++in->count == ECO_INVENTORY_PLACES ? close_block(m) : code;
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
	free(in->blocks);
	eco_string_pool_free(&in->names);
	free(in);
	m->inventory = NULL;
}
