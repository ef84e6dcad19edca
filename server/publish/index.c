/* Reading an index: columns back to records, records to tables, checked as those of a pack. */
#include "server/publish/index.h"

#include <stdlib.h>
#include <string.h>

#include <xxhash.h>

#include "ecofiles/format/chunk/chunk.h"
#include "lod/plan/planner.h"

#define TAIL_BYTES 9u            /* zeros, hash */

#define BAD(...) eco_fail(error, ECO_DAMAGED, "index: " __VA_ARGS__)

/* Table `kind` of the scene; the palette stays bytes. */
static enum eco_code read_table(struct srv_index *index, struct eco_range *range, enum eco_section_kind kind,
	uint32_t count, struct eco_error *error)
{
	struct eco_scene *scene = &index->pack.scene;
	if (count > SRV_INDEX_TABLE_MOST / eco_record_bytes(kind))
		return BAD("%u records of %s are too many", count, eco_section_name(kind));
	struct eco_reader records = { .size = (size_t)eco_record_bytes(kind) * count };
	uint8_t *bytes = malloc(records.size + 1);
	if (!bytes || !srv_index_table(range, kind, bytes, count, NULL)) {
		free(bytes);
		return BAD("its records of %s are impossible, or too many for this memory", eco_section_name(kind));
	}
	records.bytes = bytes;
	if (kind == ECO_SECTION_PALETTE) {
		index->tables[kind] = bytes;
		scene->palette = (const uint8_t (*)[3])(void *)bytes;
		scene->palette_count = count;
		return ECO_OK;
	}
	index->tables[kind] = eco_records_read(&records, kind, count, scene);
	free(bytes);
	if (!index->tables[kind])
		return eco_no_memory(error, "a published scene");
	return records.failed ? BAD("a record of %s has an impossible field", eco_section_name(kind)) : ECO_OK;
}

static enum eco_code read_tables(struct srv_index *index, struct eco_reader *r, struct eco_error *error)
{
	struct eco_range range;
	uint32_t counts[ECO_SECTION_KIND_END];
	enum eco_code code = ECO_OK;
	for (enum eco_section_kind kind = 0; kind < ECO_SECTION_KIND_END; kind++)
		counts[kind] = srv_index_has(kind) ? eco_read_u32(r) : 0;
	if (r->failed || r->size - r->at < TAIL_BYTES)
		return BAD("it is cut short");
	eco_range_read(&range, r->bytes + r->at, r->size - r->at - TAIL_BYTES);
	for (enum eco_section_kind kind = 0; kind < ECO_SECTION_KIND_END && !code; kind++)
		if (srv_index_has(kind))
			code = read_table(index, &range, kind, counts[kind], error);
	return !code && eco_range_end(&range) != r->bytes[r->size - TAIL_BYTES] ? BAD("it is cut short") : code;
}

/* Lists' counts, which are those of their chunks; offsets in the chunks' file. */
static void place_chunks(struct srv_index *index)
{
	struct eco_chunk *chunks = index->tables[ECO_SECTION_CHUNKS];
	uint64_t end = 0;
	for (uint32_t i = 0; i < index->pack.scene.chunk_count; i++) {
		chunks[i].offset = chunks[i].offset ? chunks[i].offset - 1 : end;
		uint64_t own = chunks[i].offset + chunks[i].size_bytes;
		end = own > end ? own : end;
	}
	struct eco_list *lists = index->tables[ECO_SECTION_LISTS];
	uint32_t left = index->pack.scene.chunk_count;   /* lists share none: eco_scene_check refuses more */
	for (uint32_t i = 0; i < index->pack.scene.list_count; i++)
		for (uint64_t c = lists[i].chunk_first, last = c + lists[i].chunk_count;
				c < last && c < index->pack.scene.chunk_count && left > 0; c++, left--) {
			lists[i].primitive_count += chunks[c].primitive_count;
			lists[i].element_count += chunks[c].element_count;
		}
}

static enum eco_code make_places(struct srv_index *index, struct eco_error *error)
{
	struct eco_scene *scene = &index->pack.scene;
	if (scene->place_count >= UINT32_MAX / ECO_PLACE_BYTES)
		return BAD("%llu plants are too many", (unsigned long long)scene->place_count);
	index->places = calloc(scene->place_count + 1, ECO_PLACE_BYTES);
	index->known = calloc(scene->group_count + 1, 1);
	scene->places = index->places;
	return index->places && index->known ? ECO_OK : eco_no_memory(error, "the plants of a published scene");
}

static enum eco_code read_all(struct srv_index *index, struct eco_reader *r, struct eco_error *error)
{
	struct eco_pack *pack = &index->pack;
	const uint8_t *magic = eco_read_bytes(r, 8);
	uint32_t version = eco_read_u32(r);
	const uint8_t *id = eco_read_bytes(r, sizeof pack->id.bytes);
	uint64_t work = eco_read_u64(r), places = eco_read_u64(r);
	if (r->failed || memcmp(magic, SRV_INDEX_MAGIC, 8) != 0)
		return BAD("it is none");
	if (version != ECO_PACK_VERSION)
		return eco_fail(error, ECO_UNSUPPORTED, "an index of version %u; this program reads version %u: publish "
			"the scene again", version, ECO_PACK_VERSION);
	memcpy(pack->id.bytes, id, sizeof pack->id.bytes);
	eco_record_read(r, ECO_SECTION_SCENE, &pack->scene);
	pack->scene.place_count = places;
	atomic_init(&index->scene.typical_work, work);
	enum eco_code code = read_tables(index, r, error);
	if (!code)
		place_chunks(index);
	code = code ? code : make_places(index, error);
	code = code ? code : eco_scene_check(&pack->scene, error);
	return code ? code : lod_plan_tables_make(&index->scene.tables, &pack->scene, error);
}

enum eco_code srv_index_read(struct srv_index **out, const uint8_t *bytes, size_t size, struct eco_error *error)
{
	*out = NULL;
	if (size < 64)
		return BAD("%zu bytes are too few", size);
	struct eco_reader hash = { .bytes = bytes + size - 8, .size = 8 }, r = { .bytes = bytes, .size = size };
	if (eco_read_u64(&hash) != XXH3_64bits(bytes, size - 8))
		return BAD("its hash does not match; load the page again");
	struct srv_index *index = calloc(1, sizeof *index);
	if (!index)
		return eco_no_memory(error, "a published scene");
	index->scene.pack = &index->pack;
	index->pack.file = -1;
	enum eco_code code = read_all(index, &r, error);
	if (code)
		srv_index_free(index);
	else
		*out = index;
	return code;
}

void srv_index_free(struct srv_index *index)
{
	if (!index)
		return;
	lod_plan_tables_free(index->scene.tables);
	for (int kind = 0; kind < ECO_SECTION_KIND_END; kind++)
		free(index->tables[kind]);
	free(index->known);
	free(index->places);
	free(index);
}

/* ---- Places ---- */

static void write_place(uint8_t *p, const struct eco_place *place)
{
	const uint32_t words[5] = { (uint32_t)place->position[0], (uint32_t)place->position[1],
		(uint32_t)place->position[2], place->turn | (uint32_t)place->width << 16 | (uint32_t)place->tint << 24,
		place->scale };
	for (unsigned i = 0; i < ECO_PLACE_BYTES; i++)
		p[i] = (uint8_t)(words[i / 4] >> 8 * (i % 4));
}

enum eco_code srv_index_take(struct srv_index *index, uint32_t list, uint32_t ordinal, const uint8_t *bytes, size_t size,
	struct eco_error *error)
{
	const struct eco_scene *scene = &index->pack.scene;
	const struct eco_list *l = &scene->lists[list];
	const struct eco_chunk *chunk = &scene->chunks[l->chunk_first + ordinal];
	const struct eco_group *group = eco_list_groups(scene, list), *end = group + l->group_count;
	struct eco_elements elements = { 0 };
	uint32_t first = 0;
	enum eco_code code = eco_chunk_decode(l, chunk, ordinal, bytes, size, &elements, error);
	const char *fault = code ? NULL : eco_elements_fault(&elements, l, scene->plant_count);
	for (uint32_t c = 0; c < ordinal; c++)
		first += scene->chunks[l->chunk_first + c].element_count;
	for (uint32_t i = 0; i < elements.element_count && !code && !fault && group < end; i++) {
		struct eco_place place = eco_place_of(l, &elements, i);
		while (group < end && first + i >= group->first + group->count)
			group++;
		if (group < end)
			write_place(index->places + (group->place_first + first + i - group->first) * ECO_PLACE_BYTES, &place);
	}
	eco_elements_free(&elements);
	if (fault)
		return BAD("list %u: %s", list, fault);
	for (group = eco_list_groups(scene, list); !code && ordinal + 1 == l->chunk_count && group < end; group++)
		index->known[group - scene->groups] = LOD_PLACES_KNOWN;
	return code;
}
