#include "ecofiles/format/inventory.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/format/chunk/chunk_columns.h"

enum { SPECIES, FILE_NAME, ROW, LINE, COLUMNS };

#define NAMES_MAX ((2 + ECO_INVENTORY_CELLS) * ECO_INVENTORY_PLACES)
#define CELL_UNIT 65536u /* in the number of names, for each cell */

/* ---- The names of a block, in the order in which they come ---- */

/* A name's number, from 1 on; 0: NULL. Names come in runs, so the one before is tried first. */
static uint32_t number_of(struct eco_string_pool *names, const char *name, uint32_t before)
{
	if (!name || (before && strcmp(names->items[before - 1], name) == 0))
		return name ? before : 0;
	return eco_string_number(names, name) + 1;
}

static void write_names(struct eco_writer *w, const struct eco_string_pool *names, uint32_t cells)
{
	eco_write_varint(w, names->count + cells * CELL_UNIT);
	for (uint32_t i = 0; i < names->count; i++) {
		const char *name = names->items[i];
		size_t size = eco_utf8_cut(name, strlen(name), ECO_INVENTORY_NAME_MAX);
		eco_write_u8(w, size ? (uint8_t)size : 1);
		eco_write_bytes(w, size ? name : "?", size ? size : 1);
	}
}

/* Each name with a 0 behind it in `text`; items[i]: where it begins. */
static bool read_names(struct eco_reader *r, char *text, const char **items, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		uint8_t size = eco_read_u8(r);
		const uint8_t *bytes = eco_read_bytes(r, size);
		if (!bytes || size < 1 || !eco_utf8_valid((const char *)bytes, size))
			return false;
		items[i] = memcpy(text, bytes, size);
		text[size] = 0;
		text += size + 1;
	}
	return true;
}

/* ---- Columns ---- */

/* Columns of one value a row each, over `values`: COLUMNS and cells times `count`. */
static struct eco_chunk_rows columns_over(int32_t *values, uint32_t count, uint32_t cells)
{
	struct eco_chunk_rows rows = { .stream = { .elements = count },
		.column_count = COLUMNS + cells };
	for (uint32_t i = 0; i < COLUMNS + cells; i++)
		rows.columns[i] =
			(struct eco_column){ .values = values + (size_t)i * count, .components = 1 };
	return rows;
}

static void fill_columns(int32_t *values, struct eco_string_pool *names, const struct eco_inventory_row *rows,
	uint32_t count, uint32_t cells)
{
	uint32_t species = 0, file = 0, before[ECO_INVENTORY_CELLS] = { 0 };
	for (uint32_t i = 0; i < count; i++) {
		const struct eco_inventory_row *row = &rows[i];
		bool known = row->file && row->row >= 1 && row->row <= ECO_INVENTORY_ROW_MAX,
		     lined = known && row->line >= 1 && row->line <= ECO_INVENTORY_ROW_MAX;
		species = number_of(names, row->species, species);
		file = number_of(names, known ? row->file : NULL, file);
		values[SPECIES * (size_t)count + i] = (int32_t)species;
		values[FILE_NAME * (size_t)count + i] = (int32_t)file;
		values[ROW * (size_t)count + i] = known ? (int32_t)row->row : 0;
		values[LINE * (size_t)count + i] =
			known ? (int32_t)(lined ? row->line : 0) - (int32_t)row->row : 0;
		for (uint32_t k = 0; k < cells; k++) {
			before[k] = number_of(names, row->cells[k], before[k]);
			values[(COLUMNS + k) * (size_t)count + i] = (int32_t)before[k];
		}
	}
}

/* As many as some row has. */
static uint32_t cells_of(const struct eco_inventory_row *rows, uint32_t count)
{
	uint32_t cells = 0;
	for (uint32_t i = 0; i < count; i++)
		for (uint32_t k = cells; k < ECO_INVENTORY_CELLS; k++)
			cells = rows[i].cells[k] ? k + 1 : cells;
	return cells;
}

struct eco_bytes eco_inventory_encode(const struct eco_inventory_row *rows, uint32_t count)
{
	struct eco_string_pool names = { 0 };
	uint32_t cells = cells_of(rows, count);
	int32_t *values = eco_alloc(count, (COLUMNS + cells) * sizeof *values);
	struct eco_chunk_rows columns = columns_over(values, count, cells);
	struct eco_stream coded = { .size = 0 };
	struct eco_writer w = { 0 };
	assert(count >= 1 && count <= ECO_INVENTORY_PLACES);
	fill_columns(values, &names, rows, count, cells);
	eco_columns_encode(&columns, &coded);
	write_names(&w, &names, cells);
	eco_write_u8(&w, coded.zeros);
	eco_write_bytes(&w, coded.bytes, coded.size);
	if (w.failed)
		eco_end("no memory");
	free((void *)coded.bytes);
	eco_string_pool_free(&names);
	free(values);
	return (struct eco_bytes){ w.bytes, w.size };
}

/* ---- Reading ---- */

struct names {
	const char **items;
	uint32_t count, cells;       /* cells: of a row */
};

static bool take_name(const char **name, int32_t number, const struct names *names)
{
	*name = number > 0 && (uint32_t)number <= names->count ? names->items[number - 1] : NULL;
	return *name || number == 0;
}

/* The row of place i; false: impossible. */
static bool take_row(struct eco_inventory_row *row, const int32_t *values, uint32_t count, uint32_t i,
	const struct names *names)
{
	int32_t value[COLUMNS];
	for (uint32_t k = 0; k < COLUMNS; k++)
		value[k] = values[k * (size_t)count + i];
	int64_t line = (int64_t)value[ROW] + value[LINE], most = ECO_INVENTORY_ROW_MAX;
	*row = (struct eco_inventory_row){ .row = (uint32_t)value[ROW], .line = (uint32_t)line };
	bool possible = take_name(&row->species, value[SPECIES], names) && take_name(&row->file, value[FILE_NAME], names)
		&& (value[FILE_NAME] > 0) == (value[ROW] > 0) && value[ROW] <= most && line >= 0 && line <= most
		&& (value[FILE_NAME] || !line);
	for (uint32_t k = 0; k < names->cells && possible; k++)
		possible = take_name(&row->cells[k], values[(COLUMNS + k) * (size_t)count + i], names);
	return possible;
}

static bool take_rows(struct eco_inventory_block *block, struct eco_reader *r, const struct names *names,
	int32_t *values)
{
	struct eco_chunk_rows columns = columns_over(values, block->count, names->cells);
	columns.stream.zeros = eco_read_u8(r);
	columns.stream.bytes = r->bytes + r->at;
	columns.stream.size = r->size - r->at;
	if (r->failed || eco_columns_decode(&columns, NULL))
		return false;
	for (uint32_t i = 0; i < block->count; i++)
		if (!take_row(&block->rows[i], values, block->count, i, names))
			return false;
	return true;
}

enum eco_code eco_inventory_decode(struct eco_inventory_block *block, const uint8_t *bytes, size_t size,
	uint32_t count, struct eco_error *error)
{
	struct eco_reader r = { .bytes = bytes, .size = size };
	uint64_t name_count = eco_read_varint(&r);
	uint32_t cells = name_count / CELL_UNIT <= ECO_INVENTORY_CELLS ? (uint32_t)(name_count / CELL_UNIT) : 0;
	name_count -= cells * (uint64_t)CELL_UNIT;
	uint32_t few = name_count <= NAMES_MAX ? (uint32_t)name_count : 0;
	struct names names = { .items = calloc(few + 1u, sizeof *names.items), .count = few, .cells = cells };
	int32_t *values = calloc((COLUMNS + cells) * (size_t)count, sizeof *values);
	*block = (struct eco_inventory_block){ .count = count,
		.rows = calloc(count, sizeof *block->rows),
		.names = malloc(size + 1) }; /* a size goes for each 0 that comes */
	enum eco_code code = ECO_OK;
	if (!names.items || !values || !block->rows || !block->names)
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for the rows of %u plants", count);
	else if (r.failed || few != name_count || !read_names(&r, block->names, names.items, few))
		code = eco_fail(error, ECO_DAMAGED, "rows of plants: their names are cut short or no UTF-8");
	if (!code && !take_rows(block, &r, &names, values))
		code = eco_fail(error, ECO_DAMAGED, "rows of plants: they are cut short or impossible");
	free(values);
	free(names.items);
	if (code)
		eco_inventory_free(block);
	return code;
}

const char *eco_inventory_species(const struct eco_inventory_row *row, const char *plant)
{
	const char *species = row->species ? row->species : plant;
	return strcmp(species, ECO_INVENTORY_UNSTATED) == 0 ? NULL : species;
}

const struct eco_list *eco_inventory_list(const struct eco_scene *scene)
{
	const struct eco_list *last = scene->list_count ? &scene->lists[scene->list_count - 1] : NULL;
	return last && last->kind == ECO_LIST_INVENTORY ? last : NULL;
}

enum eco_code eco_inventory_read(struct eco_inventory_block *block, const struct eco_pack *pack,
	uint64_t place, struct eco_error *error)
{
	const struct eco_scene *scene = &pack->scene;
	const struct eco_list *list = eco_inventory_list(scene);
	uint64_t first = place - place % ECO_INVENTORY_PLACES, left = scene->place_count - first;
	uint32_t count = left < ECO_INVENTORY_PLACES ? (uint32_t)left : ECO_INVENTORY_PLACES;
	const uint8_t *bytes;
	size_t size;
	assert(place < scene->place_count);
	*block = (struct eco_inventory_block){ 0 };
	enum eco_code code = ECO_OK;
	if (!list)
		block->rows = calloc(count, sizeof *block->rows);
	else
		code = eco_pack_payload(pack, list->chunk_first + (uint32_t)(place / ECO_INVENTORY_PLACES),
			&bytes, &size, error);
	if (!code && list)
		code = eco_inventory_decode(block, bytes, size, count, error);
	else if (!code && !block->rows)
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for the rows of %u plants", count);
	block->first = first;
	block->count = count;
	return code;
}

enum eco_code eco_inventory_at(struct eco_inventory_block *block, const struct eco_pack *pack, uint64_t place,
	const struct eco_inventory_row **row, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	if (!block->rows || place < block->first || place - block->first >= block->count) {
		eco_inventory_free(block);
		code = eco_inventory_read(block, pack, place, error);
	}
	*row = code ? NULL : &block->rows[place - block->first];
	return code;
}

void eco_inventory_free(struct eco_inventory_block *block)
{
	free(block->rows);
	free(block->names);
	*block = (struct eco_inventory_block){ 0 };
}
