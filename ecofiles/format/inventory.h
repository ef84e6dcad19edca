/* The inventory row of each plant of a scene: its row there, and its species where
 * the pack's plant has another name: as the row has it, be it a code or a name that the scene's map leads to
 * a model of another; else as the scene names it (plants that share a model, variants, few models).
 *
 *   bytes = eco_inventory_encode(rows, count);     a block of ECO_INVENTORY_PLACES places
 *   struct eco_inventory_block block = { 0 };
 *   eco_inventory_at(&block, pack, place, &row, &error);     of a place of section PLACES; of the next, ...
 *   eco_inventory_free(&block);
 *
 * Nothing that is drawn needs it, so no stream has it: a server reads a block where somebody asks for a
 * plant. A pack keeps it as a list of kind INVENTORY, the last of all, its chunks too, so that the numbers of
 * the others stay; where nothing is to be said of any plant there is none. Chunk k is block k: places [4096
 * k, 4096 (k + 1)). Each has names of its own and its own hash, so that damage ends where its block does.
 *
 *   varint  number of names, and 65536 more for each cell of a row
 *   names   u8 size, from 1 on, and as many bytes of UTF-8
 *   u8      bytes left off at the end
 *   columns as chunk_columns.h says, of one row a place: species, file (0: NULL; i: name i - 1), row and line
 *           less row (0 and 0 where there is no file), then the cells (0: NULL; i: name i - 1)
 *
 * Cells are the row's values of the columns that META names, in their order; a pack has none unless somebody
 * named columns (`ecopack make --columns`). */
#pragma once

#include "ecofiles/format/pack.h"

#define ECO_INVENTORY_PLACES 4096u
#define ECO_INVENTORY_ROW_MAX ((1u << 30) - 1) /* of rows and lines */
#define ECO_INVENTORY_NAME_MAX 255u            /* bytes */
#define ECO_INVENTORY_UNSTATED "?"             /* species of a row that states none */
#define ECO_INVENTORY_CELLS 10u
/* Columns beside those that were named: why a height or a crown's width is no measure; NULL: it is one. */
#define ECO_INVENTORY_HEIGHT_FROM "height_from"
#define ECO_INVENTORY_CROWN_FROM "crown_from"

struct eco_inventory_row {
	const char *species; /* NULL: as the pack's plant is named */
	const char *file;    /* of the inventory, without its folder; NULL: it comes from none */
	uint32_t row;        /* data row from 1 */
	uint32_t line;       /* of the file, where the row begins, from 1; 0: the file has no lines */
	const char *cells[ECO_INVENTORY_CELLS]; /* NULL: empty, or there is no such column */
};

/* Names longer than a block's, or not UTF-8, are cut. The bytes are malloc'ed. At least one row, at most
 * ECO_INVENTORY_PLACES. Without memory it ends the program (memory.h). */
struct eco_bytes eco_inventory_encode(const struct eco_inventory_row *rows, uint32_t count);

struct eco_inventory_block { /* owns what its rows point to */
	uint64_t first;      /* place */
	uint32_t count;
	struct eco_inventory_row *rows;
	char *names;
};
/* Reads `count` rows. ECO_DAMAGED: they are not as written. */
enum eco_code eco_inventory_decode(struct eco_inventory_block *block, const uint8_t *bytes, size_t size,
	uint32_t count, struct eco_error *error);
/* The block of a place below the scene's place_count; of a pack without a list all rows are empty. */
enum eco_code eco_inventory_read(struct eco_inventory_block *block, const struct eco_pack *pack,
	uint64_t place, struct eco_error *error);
/* The row of one place, from the block that was read before or another one, which is then in its place. */
enum eco_code eco_inventory_at(struct eco_inventory_block *block, const struct eco_pack *pack, uint64_t place,
	const struct eco_inventory_row **row, struct eco_error *error);
void eco_inventory_free(struct eco_inventory_block *block); /* a zeroed one is fine */

/* The species of a row of a plant that the pack calls so; NULL: the row states none. */
const char *eco_inventory_species(const struct eco_inventory_row *row, const char *plant);

/* The list, or NULL. */
const struct eco_list *eco_inventory_list(const struct eco_scene *scene);
