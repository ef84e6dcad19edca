/* Writing an index: its tables by columns, each in the way that takes fewest bytes. */
#include "server/publish/index.h"

#include <stdlib.h>
#include <string.h>

#include <xxhash.h>

#include "ecofiles/format/inventory.h"

#define ROWS_TRIED 4096u         /* the first ones, to find the way of a column */

struct choice { struct srv_index_way way; size_t bytes; };

static void try_way(struct choice *best, const struct srv_index_columns *columns, uint32_t column, struct srv_index_way way)
{
	struct eco_range range;
	eco_range_count(&range);
	srv_index_column(&range, columns, column, &way, columns->rows < ROWS_TRIED ? columns->rows : ROWS_TRIED, best->bytes);
	if (range.size < best->bytes)
		*best = (struct choice){ way, range.size };
}

/* The smallest one, part by part: the guess, models and keys, modelled bits. Columns behind this one are known. */
static struct srv_index_way find_way(const struct srv_index_columns *columns, uint32_t column)
{
	struct choice best = { .bytes = SIZE_MAX };
	struct srv_index_way way = { .top = SRV_INDEX_TOP_STEPS / 2 };
	for (way.base = 0; way.base < SRV_BASES; way.base++)
		for (uint32_t of = column + 1; of <= (way.base < SRV_BASE_SUM ? column + 1 : columns->count - 1); of++) {
			way.of = (uint8_t)(way.base < SRV_BASE_SUM ? 0 : of);
			try_way(&best, columns, column, way);
		}
	way = best.way;
	for (way.slots = 0; way.slots < SRV_SLOT_KINDS; way.slots++)
		for (way.key = 0; way.key < SRV_KEYS; way.key++)
			for (uint32_t by = column + 1; by < columns->count; by++) {
				way.by = (uint8_t)by;
				try_way(&best, columns, column, way);
			}
	way = best.way;
	for (way.top = 0; way.top < SRV_INDEX_TOP_STEPS; way.top++)
		try_way(&best, columns, column, way);
	return best.way;
}

/* A pack's chunks as they lie in the chunks' file, without ids; malloc'ed, or NULL. */
static struct eco_chunk *place_chunks(const struct eco_scene *scene, const struct eco_bytes *rows, uint64_t *chunk_bytes)
{
	const struct eco_list *list = eco_inventory_list(scene);
	const uint32_t rows_first = list ? list->chunk_first : scene->chunk_count;
	struct eco_chunk *chunks = malloc(((size_t)scene->chunk_count + 1) * sizeof *chunks);
	uint64_t base = UINT64_MAX, end = 0;
	*chunk_bytes = 0;
	for (uint32_t i = 0; i < scene->chunk_count; i++)
		base = scene->chunks[i].offset < base ? scene->chunks[i].offset : base;
	for (uint32_t i = 0; chunks && i < scene->chunk_count; i++) {
		uint64_t at = i < rows_first ? scene->chunks[i].offset - base : end;
		chunks[i] = scene->chunks[i];
		memset(&chunks[i].id, 0, sizeof chunks[i].id);
		chunks[i].offset = at == end ? 0 : at + 1;
		if (i >= rows_first)
			chunks[i].size_bytes = rows ? (uint32_t)rows[i - rows_first].size : SRV_INDEX_NO_ROWS;
		end = at + chunks[i].size_bytes > end ? at + chunks[i].size_bytes : end;
		if (i < rows_first)
			*chunk_bytes = end;
	}
	return chunks;
}

static uint32_t count_of(const struct eco_scene *scene, enum eco_section_kind kind)
{
	return kind == ECO_SECTION_PALETTE ? scene->palette_count : eco_records_count(scene, kind);
}

enum eco_code srv_index_write(struct eco_writer *w, const struct srv_scene *scene, const struct eco_bytes *rows,
	uint64_t *chunk_bytes, struct eco_error *error)
{
	struct eco_scene tables = scene->pack->scene;
	for (enum eco_section_kind kind = 0; kind < ECO_SECTION_KIND_END; kind++)
		if (srv_index_has(kind) && count_of(&tables, kind) > SRV_INDEX_TABLE_MOST / eco_record_bytes(kind))
			return eco_fail(error, ECO_TOO_LARGE, "%u records of %s: pages read at most %u bytes of them",
				count_of(&tables, kind), eco_section_name(kind), SRV_INDEX_TABLE_MOST);
	struct eco_chunk *chunks = place_chunks(&scene->pack->scene, rows, chunk_bytes);
	struct eco_list *lists = malloc(((size_t)tables.list_count + 1) * sizeof *lists);
	struct eco_range range;
	bool made = chunks && lists;
	for (uint32_t i = 0; made && i < tables.list_count; i++) {
		lists[i] = tables.lists[i];
		lists[i].primitive_count = lists[i].element_count = 0;
	}
	tables.chunks = chunks;
	tables.lists = lists;
	eco_write_bytes(w, SRV_INDEX_MAGIC, 8);
	eco_write_u32(w, ECO_PACK_VERSION);
	eco_write_bytes(w, scene->pack->id.bytes, sizeof scene->pack->id.bytes);
	eco_write_u64(w, atomic_load(&scene->typical_work));
	eco_write_u64(w, tables.place_count);
	eco_record_write(w, ECO_SECTION_SCENE, &tables);
	for (enum eco_section_kind kind = 0; kind < ECO_SECTION_KIND_END; kind++)
		if (srv_index_has(kind))
			eco_write_u32(w, count_of(&tables, kind));
	eco_range_write(&range, w);
	for (enum eco_section_kind kind = 0; kind < ECO_SECTION_KIND_END && made; kind++) {
		struct eco_writer records = { 0 };
		if (kind == ECO_SECTION_PALETTE)
			eco_write_bytes(&records, *tables.palette, 3 * (size_t)tables.palette_count);
		else if (srv_index_has(kind))
			eco_records_write(&records, kind, &tables);
		made = !records.failed && (!srv_index_has(kind)
			|| srv_index_table(&range, kind, records.bytes, count_of(&tables, kind), find_way));
		eco_writer_free(&records);
	}
	free(chunks);
	free(lists);
	eco_write_u8(w, (uint8_t)eco_range_end(&range));
	eco_write_u64(w, w->failed ? 0 : XXH3_64bits(w->bytes, w->size));
	return made && !w->failed ? ECO_OK : eco_no_memory(error, "an index");
}
