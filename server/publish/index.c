/* Reading an index: columns back to records, records to tables, checked as those of a pack. */
#include "server/publish/index.h"

#include <stdlib.h>
#include <string.h>

#include <xxhash.h>

#include "ecofiles/format/chunk/chunk.h"
#include "lod/plan/planner.h"

#define BAD(...) eco_fail(error, ECO_DAMAGED, "index: " __VA_ARGS__)

static void take_column(uint8_t *to, size_t record, size_t count, unsigned width, uint8_t way, const uint8_t *planes)
{
	const size_t next = way < SRV_INDEX_WHOLE ? 1 : width, apart = way < SRV_INDEX_WHOLE ? count : 1;
	uint32_t value = 0, step = 0;
	way %= SRV_INDEX_WHOLE;
	for (size_t i = 0; i < count; i++, to += record) {
		uint32_t coded = 0;
		for (unsigned k = 0; k < width; k++)
			coded |= (uint32_t)planes[k * apart + i * next] << 8 * k;
		step = way == 2 ? step + coded : coded;
		value = way ? value + step : coded;
		for (unsigned k = 0; k < width; k++)
			to[k] = (uint8_t)(value >> 8 * k);
	}
}

/* The records of a table, malloc'ed; NULL: no memory, or r->failed. */
static uint8_t *read_columns(struct eco_reader *r, enum eco_section_kind kind, uint32_t count)
{
	uint8_t widths[ECO_RECORD_VALUES_MAX];
	const uint32_t values = eco_record_widths(kind, widths), record = eco_record_bytes(kind);
	r->failed |= count > (r->size - r->at) / record;
	uint8_t *bytes = r->failed ? NULL : malloc((size_t)count * record + 1), *to = bytes;
	for (uint32_t i = 0; bytes && i < values; to += widths[i++]) {
		uint8_t way = eco_read_u8(r);
		const uint8_t *planes = eco_read_bytes(r, widths[i] * (size_t)count);
		r->failed |= way >= SRV_INDEX_WAYS;
		if (!r->failed)
			take_column(to, record, count, widths[i], way, planes);
	}
	if (!r->failed)
		return bytes;
	free(bytes);
	return NULL;
}

/* Table `kind` of the scene; the palette stays bytes. */
static enum eco_code read_table(struct srv_index *index, struct eco_reader *r, enum eco_section_kind kind,
	struct eco_error *error)
{
	struct eco_scene *scene = &index->pack.scene;
	uint32_t count = eco_read_u32(r), record = eco_record_bytes(kind);
	uint8_t *bytes = read_columns(r, kind, count);
	if (!bytes)
		return r->failed ? BAD("%u records of %s are not there", count, eco_section_name(kind))
			: eco_no_memory(error, "a published scene");
	if (kind == ECO_SECTION_PALETTE) {
		index->tables[kind] = bytes;
		scene->palette = (const uint8_t (*)[3])(void *)bytes;
		scene->palette_count = count;
		return ECO_OK;
	}
	struct eco_reader records = { .bytes = bytes, .size = (size_t)record * count };
	index->tables[kind] = eco_records_read(&records, kind, count, scene);
	free(bytes);
	if (!index->tables[kind])
		return eco_no_memory(error, "a published scene");
	return records.failed ? BAD("a record of %s has an impossible field", eco_section_name(kind)) : ECO_OK;
}

/* Offsets in the chunks' file. */
static void place_chunks(struct srv_index *index)
{
	struct eco_chunk *chunks = index->tables[ECO_SECTION_CHUNKS];
	uint64_t end = 0;
	for (uint32_t i = 0; i < index->pack.scene.chunk_count; i++) {
		chunks[i].offset = chunks[i].offset ? chunks[i].offset - 1 : end;
		uint64_t own = chunks[i].offset + chunks[i].size_bytes;
		end = own > end ? own : end;
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
	enum eco_code code = ECO_OK;
	for (enum eco_section_kind kind = 0; kind < ECO_SECTION_KIND_END && !code; kind++)
		if (eco_records_are_table(kind) || kind == ECO_SECTION_PALETTE)
			code = read_table(index, r, kind, error);
	if (!code && (r->failed || r->at + 8 != r->size))
		return BAD("it is cut short");
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
