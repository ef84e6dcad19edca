/* Writing an index: its tables by columns, each in the way that zlib makes smallest. */
#include "server/publish/index.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include <xxhash.h>
#include <zlib.h>

#include "ecofiles/format/inventory.h"

struct column { const uint8_t *bytes; size_t record, count; uint8_t width; };

/* The planes of a column's values, differences or second differences. */
static void take_planes(const struct column *c, uint8_t *planes, uint8_t way)
{
	const size_t next = way < SRV_INDEX_WHOLE ? 1 : c->width, apart = way < SRV_INDEX_WHOLE ? c->count : 1;
	uint32_t before = 0, step = 0;
	for (size_t i = 0; i < c->count; i++) {
		uint32_t value = 0;
		for (size_t k = 0; k < c->width; k++)
			value |= (uint32_t)c->bytes[i * c->record + k] << 8 * k;
		uint32_t difference = value - before, coded = way % SRV_INDEX_WHOLE == 2 ? difference - step
			: way % SRV_INDEX_WHOLE ? difference : value;
		for (size_t k = 0; k < c->width; k++)
			planes[k * apart + i * next] = (uint8_t)(coded >> 8 * k);
		before = value;
		step = difference;
	}
}

/* The way that zlib makes smallest; its planes are in `planes`. False: no memory. */
static bool find_way(const struct column *c, uint8_t *planes, uint8_t *way)
{
	const size_t size = c->width * c->count;
	uLongf least = ULONG_MAX;
	uint8_t *packed = malloc(compressBound(size));
	for (uint8_t w = 0; packed && w < SRV_INDEX_WAYS && (w < SRV_INDEX_WHOLE || c->width > 1); w++) {
		uLongf bytes = compressBound(size);
		take_planes(c, planes, w);
		if (compress2(packed, &bytes, planes, size, Z_BEST_COMPRESSION) == Z_OK && bytes < least) {
			least = bytes;
			*way = w;
		}
	}
	if (packed)
		take_planes(c, planes, *way);
	free(packed);
	return packed;
}

static bool write_table(struct eco_writer *w, enum eco_section_kind kind, const uint8_t *bytes, uint32_t count)
{
	uint8_t widths[ECO_RECORD_VALUES_MAX], way = 0, *planes = malloc(4 * (size_t)count + 1);
	const uint32_t values = eco_record_widths(kind, widths);
	bool made = planes;
	eco_write_u32(w, count);
	for (uint32_t i = 0, at = 0; made && i < values; at += widths[i++]) {
		const struct column column = { bytes + at, eco_record_bytes(kind), count, widths[i] };
		made = find_way(&column, planes, &way);
		eco_write_u8(w, way);
		eco_write_bytes(w, planes, widths[i] * (size_t)count);
	}
	free(planes);
	return made;
}

/* Compressed. */
static bool pack_all(struct eco_writer *w)
{
	uLongf size = compressBound(w->size);
	uint8_t *packed = malloc(size);
	bool made = packed && !w->failed && compress2(packed, &size, w->bytes, w->size, Z_BEST_COMPRESSION) == Z_OK;
	w->size = 0;
	eco_write_bytes(w, packed, made ? size : 0);
	free(packed);
	return made;
}

/* A pack's chunks as they lie in the chunks' file, without ids; malloc'ed, or NULL. */
static struct eco_chunk *place_chunks(const struct eco_scene *scene, const struct eco_bytes *rows, uint64_t *chunk_bytes)
{
	const struct eco_list *list = eco_inventory_list(scene);
	const uint32_t rows_first = list ? list->chunk_first : scene->chunk_count;
	struct eco_chunk *chunks = malloc((scene->chunk_count + 1) * sizeof *chunks);
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

enum eco_code srv_index_write(struct eco_writer *w, const struct srv_scene *scene, const struct eco_bytes *rows,
	uint64_t *chunk_bytes, struct eco_error *error)
{
	struct eco_scene tables = scene->pack->scene;
	struct eco_chunk *chunks = place_chunks(&scene->pack->scene, rows, chunk_bytes);
	bool made = chunks;
	tables.chunks = chunks;
	eco_write_bytes(w, SRV_INDEX_MAGIC, 8);
	eco_write_u32(w, ECO_PACK_VERSION);
	eco_write_bytes(w, scene->pack->id.bytes, sizeof scene->pack->id.bytes);
	eco_write_u64(w, atomic_load(&scene->typical_work));
	eco_write_u64(w, tables.place_count);
	eco_record_write(w, ECO_SECTION_SCENE, &tables);
	for (enum eco_section_kind kind = 0; kind < ECO_SECTION_KIND_END && made; kind++) {
		bool is_palette = kind == ECO_SECTION_PALETTE;
		struct eco_writer records = { 0 };
		if (!is_palette && !eco_records_are_table(kind))
			continue;
		uint32_t count = is_palette ? tables.palette_count : eco_records_count(&tables, kind);
		if (!is_palette)
			eco_records_write(&records, kind, &tables);
		made = !records.failed && write_table(w, kind, is_palette ? *tables.palette : records.bytes, count);
		eco_writer_free(&records);
	}
	free(chunks);
	if (made && !w->failed)
		eco_write_u64(w, XXH3_64bits(w->bytes, w->size));
	return made && pack_all(w) ? ECO_OK : eco_no_memory(error, "an index");
}
