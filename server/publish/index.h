/* The index of a published scene: all that a planner reads of a pack but for its plants' places, which follow from the
 * lists of instances that a client gets anyway (ecopack publish).
 *
 *   srv_index_write(&writer, scene, &error);             natively, once
 *   srv_index_read(&index, bytes, size, &error);         where there is no server; index->scene can be planned
 *   srv_index_take(index, list, payload, size, &error);  the places of a list's plants
 *   srv_index_free(index);
 *
 * File (little-endian):
 *   0    8  "ECOINDEX"
 *   8    u32 ECO_PACK_VERSION       12  16 the pack's id
 *   28   u64 work of an ordinary plan (server/stream.h)
 *   36   u64 number of places
 *   44   the pack's SCENE record; u32 number of records of each table of ECO_PACK_TABLES and of the palette
 *   .    all records, as one range-coded stream (index_columns.h)
 *   .    u8 zeros that were left off at its end (range.h); u64 XXH3-64 of all before
 * Lists have no counts, chunks no ids. A chunk's offset is 0 where its payload follows those before it, else 1 more
 * than where it lies in the chunks' file, which is the pack's CHUNK_DATA with the published columns of inventories' rows
 * alone, if any.
 */
#pragma once

#include "ecofiles/base/bytes.h"
#include "ecofiles/format/pack_record.h"
#include "server/publish/index_columns.h"
#include "server/store.h"

#define SRV_INDEX_MAGIC "ECOINDEX"
#define SRV_INDEX_TABLE_MOST (1u << 26)  /* bytes of a table's records: a browser holds five times as many to read it */
#define SRV_INDEX_NO_ROWS 1u             /* bytes of blocks that are not published, fewer than any block has */
#define SRV_INDEX_PLAN_TIMES 7u          /* work of a plan, over that of an ordinary one: ecoserve's default */

struct srv_index {
	struct srv_scene scene;          /* holders, files, rows and outlook are not known */
	struct eco_pack pack;            /* that the scene points to; without payloads */
	uint8_t *known;                  /* enum lod_places per group */
	uint8_t *places;
	void *tables[ECO_SECTION_KIND_END];
};

/* Whether an index has this table. */
static inline bool srv_index_has(enum eco_section_kind kind)
{
	return eco_records_are_table(kind) || kind == ECO_SECTION_PALETTE;
}
/* Writes the index of a scene whose typical work is known, and how many bytes the chunks' file has, before its rows:
 * blocks that are published in place of the pack's; NULL: none are. ECO_TOO_LARGE: a table that no page could read. */
enum eco_code srv_index_write(struct eco_writer *w, const struct srv_scene *scene, const struct eco_bytes *rows,
	uint64_t *chunk_bytes, struct eco_error *error);
/* Reads an index. ECO_DAMAGED: something is wrong with it. */
enum eco_code srv_index_read(struct srv_index **index, const uint8_t *bytes, size_t size, struct eco_error *error);
/* Decodes a chunk of a list of instances; the last one makes the places of its groups known. */
enum eco_code srv_index_take(struct srv_index *index, uint32_t list, uint32_t ordinal, const uint8_t *bytes, size_t size,
	struct eco_error *error);
void srv_index_free(struct srv_index *index);            /* NULL is fine */
