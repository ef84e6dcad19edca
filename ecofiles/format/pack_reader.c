/* Opening a pack: the file is mapped, its frame and hashes are checked, its tables are parsed into arrays
 * and checked against each other (eco_scene_check); places, palette and payloads stay in the map. A pack
 * never changes after that, so threads share it without locks. The sections must fill the file but for
 * zero padding, so that every byte is covered by a hash or known to be zero. */
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <xxhash.h>

#include "ecofiles/base/files.h"
#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/pack_record.h"

#define BAD(...) eco_fail(error, ECO_DAMAGED, __VA_ARGS__)

/* Owned by an open pack; `pack` comes first. */
struct opened {
	struct eco_pack pack;
	bool mapped;
	struct eco_section sections[ECO_SECTION_KIND_END];     /* by kind; count and size 0 where absent */
	void *tables[ECO_SECTION_KIND_END];
};

static enum eco_code check_section(const struct eco_section *s, uint32_t last_kind, uint64_t at,
	uint64_t file_size, struct eco_error *error)
{
	uint32_t record_bytes;
	if (s->kind <= last_kind || s->kind >= ECO_SECTION_KIND_END)
		return BAD("section kind %u after kind %u", s->kind, last_kind);
	record_bytes = eco_record_bytes(s->kind);
	if (s->record_bytes != record_bytes || s->size == 0 || s->size > file_size
	    || (record_bytes == 0 ? s->count != 0 : s->size != (uint64_t)s->count * record_bytes))
		return BAD("section %s: %u records of %u bytes in %llu bytes", eco_section_name(s->kind),
			s->count, s->record_bytes, (unsigned long long)s->size);
	if (s->offset != (at + ECO_PACK_ALIGN - 1) / ECO_PACK_ALIGN * ECO_PACK_ALIGN || s->offset > file_size
	    || s->size > file_size - s->offset)
		return BAD("section %s: bytes [%llu, +%llu) do not follow byte "
			"%llu of %llu", eco_section_name(s->kind), (unsigned long long)s->offset,
			(unsigned long long)s->size, (unsigned long long)at, (unsigned long long)file_size);
	return ECO_OK;
}

static enum eco_code check_bytes(const uint8_t *map, const struct eco_section *s, uint64_t at,
	struct eco_error *error)
{
	for (; at < s->offset; at++)
		if (map[at] != 0)
			return BAD("padding at byte %llu is not zero", (unsigned long long)at);
	if (s->kind == ECO_SECTION_CHUNK_DATA) {
		if (s->hash != 0)
			return BAD("section CHUNK_DATA has a hash of its own");
	} else if (XXH3_64bits(map + s->offset, s->size) != s->hash) {
		return BAD("section %s, bytes [%llu, +%llu): its hash does not "
			"match", eco_section_name(s->kind), (unsigned long long)s->offset,
			(unsigned long long)s->size);
	}
	return ECO_OK;
}

/* The hash of the header covers the bytes before the hash and the section table behind it. */
static uint64_t header_hash(const uint8_t *map, size_t table_size)
{
	uint8_t hashed[24 + ECO_SECTION_KIND_END * ECO_PACK_SECTION_BYTES];
	memcpy(hashed, map, 24);
	memcpy(hashed + 24, map + ECO_PACK_HEADER_BYTES, table_size);
	return XXH3_64bits(hashed, 24 + table_size);
}

/* Header and section table; fills `sections` and the pack's id. */
static enum eco_code read_frame(struct opened *o, struct eco_error *error)
{
	const uint8_t *map = o->pack.map;
	struct eco_reader r = { .bytes = map, .size = o->pack.map_size };
	const uint8_t *magic = eco_read_bytes(&r, 8);
	uint32_t version = eco_read_u32(&r), count = eco_read_u32(&r), last_kind = 0;
	uint64_t file_size = eco_read_u64(&r), hash = eco_read_u64(&r), at;
	enum eco_code code = ECO_OK;
	if (r.failed || memcmp(magic, ECO_PACK_MAGIC, 8) != 0)
		return BAD("not a pack: it does not begin with %s; ecopack make SCENE.json -o OUT.eco makes "
			"one of a scene", ECO_PACK_MAGIC);
	if (version != ECO_PACK_VERSION)
		return eco_fail(error, ECO_UNSUPPORTED, "a pack of version %u; this program reads version "
			"%u: %s", version, ECO_PACK_VERSION, version < ECO_PACK_VERSION ? "build it again "
			"from its scene, with ecopack make" : "it was built by a newer program");
	if (file_size != o->pack.map_size)
		return BAD("%zu bytes instead of %llu: truncated or extended; "
			"fetch it or build it again", o->pack.map_size, (unsigned long long)file_size);
	if (count < 1 || count >= ECO_SECTION_KIND_END
			|| ECO_PACK_HEADER_BYTES + count * ECO_PACK_SECTION_BYTES > file_size)
		return BAD("%u sections in %llu bytes", count, (unsigned long long)file_size);
	if (header_hash(map, count * ECO_PACK_SECTION_BYTES) != hash)
		return BAD("header: its hash does not match");
	o->pack.id = eco_chunk_hash(map + ECO_PACK_HEADER_BYTES, count * ECO_PACK_SECTION_BYTES);
	at = ECO_PACK_HEADER_BYTES + count * ECO_PACK_SECTION_BYTES;
	for (uint32_t i = 0; i < count && code == ECO_OK; i++) {
		struct eco_section s;
		eco_record_read(&r, ECO_SECTION_NONE, &s);
		if (r.failed)
			return BAD("section record %u does not end with zero", i);
		code = check_section(&s, last_kind, at, file_size, error);
		code = code ? code : check_bytes(map, &s, at, error);
		if (!code) {
			o->sections[s.kind] = s;
			last_kind = s.kind;
			at = s.offset + s.size;
		}
	}
	if (code == ECO_OK && at != file_size)
		return BAD("%llu bytes follow the last section", (unsigned long long)(file_size - at));
	return code;
}

static enum eco_code read_tables(struct opened *o, struct eco_error *error)
{
	struct eco_scene *scene = &o->pack.scene;
	const struct eco_section *s = o->sections;
	struct eco_reader r = { .bytes = o->pack.map + s[ECO_SECTION_SCENE].offset,
		.size = s[ECO_SECTION_SCENE].size };
	if (s[ECO_SECTION_SCENE].count != 1)
		return BAD("section SCENE has %u records instead of 1", s[ECO_SECTION_SCENE].count);
	eco_record_read(&r, ECO_SECTION_SCENE, scene);
	for (enum eco_section_kind kind = 0; kind < ECO_SECTION_KIND_END && !r.failed; kind++) {
		if (!eco_records_are_table(kind))
			continue;
		r = (struct eco_reader){ .bytes = o->pack.map + s[kind].offset, .size = s[kind].size };
		if (!(o->tables[kind] = eco_records_read(&r, kind, s[kind].count, scene)))
			return eco_fail(error, ECO_NO_MEMORY, "section %s: out of memory for %u records",
				eco_section_name(kind), s[kind].count);
	}
	if (r.failed)
		return BAD("a record has an impossible field");
	scene->palette = (const uint8_t (*)[3])(o->pack.map + s[ECO_SECTION_PALETTE].offset);
	scene->palette_count = s[ECO_SECTION_PALETTE].count;
	scene->places = o->pack.map + s[ECO_SECTION_PLACES].offset;
	scene->place_count = s[ECO_SECTION_PLACES].count;
	o->pack.meta = (const char *)o->pack.map + s[ECO_SECTION_META].offset;
	o->pack.meta_size = s[ECO_SECTION_META].size;
	return ECO_OK;
}

/* Every payload must lie in CHUNK_DATA and every byte of CHUNK_DATA in a payload. */
static enum eco_code check_chunk_data(const struct opened *o, struct eco_error *error)
{
	const struct eco_section *data = &o->sections[ECO_SECTION_CHUNK_DATA];
	const struct eco_scene *scene = &o->pack.scene;
	uint64_t end = data->offset;
	for (uint32_t i = 0; i < scene->chunk_count; i++) {
		const struct eco_chunk *c = &scene->chunks[i];
		if (c->offset < data->offset || c->offset > end || c->size_bytes > data->offset + data->size
			- c->offset || (c->offset < end && c->size_bytes > end - c->offset))
			return BAD("chunk %u: bytes [%llu, +%u) neither follow the payloads before nor are "
				"among them", i, (unsigned long long)c->offset, c->size_bytes);
		if (c->offset == end)
			end += c->size_bytes;
	}
	if (end != data->offset + data->size)
		return BAD("section CHUNK_DATA: %llu bytes belong to no chunk",
			(unsigned long long)(data->offset + data->size - end));
	return ECO_OK;
}

static enum eco_code open_bytes(struct eco_pack **pack, const uint8_t *bytes, size_t size, bool mapped,
	struct eco_error *error)
{
	struct opened *o = calloc(1, sizeof *o);
	*pack = NULL;
	if (!o) {
		if (mapped)
			munmap((void *)bytes, size);
		return eco_fail(error, ECO_NO_MEMORY, "out of memory for a pack");
	}
	o->pack.map = bytes;
	o->pack.map_size = size;
	o->pack.file = -1;
	o->mapped = mapped;
	enum eco_code code = read_frame(o, error);
	code = code ? code : read_tables(o, error);
	code = code ? code : check_chunk_data(o, error);
	code = code ? code : eco_scene_check(&o->pack.scene, error);
	if (code)
		eco_pack_close(&o->pack);
	else
		*pack = &o->pack;
	return code;
}

enum eco_code eco_pack_open_memory(struct eco_pack **pack, const uint8_t *bytes, size_t size,
	struct eco_error *error)
{
	return open_bytes(pack, bytes, size, false, error);
}

/* Maps a regular file, or a private copy of it in `copies`, which *copy is then. */
static enum eco_code map_file(void **map, size_t *size, int file, int *copy, const char *path,
	const char *copies, const atomic_bool *cancelled, struct eco_error *error)
{
	struct stat status;
	if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode))
		return eco_fail(error, ECO_BAD_INPUT, "%s: not a regular file", path);
	if (status.st_size < (off_t)ECO_PACK_HEADER_BYTES)
		return BAD("%s: %lld bytes are too few for a pack", path, (long long)status.st_size);
	ECO_PASS(copies ? eco_private_copy(copy, file, path, copies, cancelled, error) : ECO_OK);
	*size = (size_t)status.st_size;
	*map = mmap(NULL, *size, PROT_READ, MAP_SHARED, copies ? *copy : file, 0);
	if (*map == MAP_FAILED)
		return eco_fail(error, ECO_IO, "%s: cannot map %lld bytes: %s", path,
			(long long)status.st_size, strerror(errno));
	return ECO_OK;
}

static enum eco_code open_file(struct eco_pack **pack, const char *path, const char *copies,
	const atomic_bool *cancelled, struct eco_error *error)
{
	struct eco_error inner = { 0 };
	void *map = NULL;
	size_t size = 0;
	int copy = -1, file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	*pack = NULL;
	if (file < 0)
		return eco_fail(error, errno == ENOENT ? ECO_NOT_FOUND : ECO_IO, "%.330s: cannot open: "
			"%s%s", path, strerror(errno), eco_advice_read(errno));
	enum eco_code code = map_file(&map, &size, file, &copy, path, copies, cancelled, error);
	close(file);
	code = code ? code : open_bytes(pack, map, size, true, &inner);
	if (!code)
		(*pack)->file = copy;
	else if (copy >= 0)
		close(copy);
	return code ? eco_fail(error, code, "%s: %s", path, inner.text) : ECO_OK;
}

enum eco_code eco_pack_open(struct eco_pack **pack, const char *path, struct eco_error *error)
{
	return open_file(pack, path, NULL, NULL, error);
}

enum eco_code eco_pack_open_private(struct eco_pack **pack, const char *path, const char *folder,
	const atomic_bool *cancelled, struct eco_error *error)
{
	return open_file(pack, path, folder, cancelled, error);
}

void eco_pack_close(struct eco_pack *pack)
{
	struct opened *o = (struct opened *)pack;
	if (!o)
		return;
	for (int kind = 0; kind < ECO_SECTION_KIND_END; kind++)
		free(o->tables[kind]);
	if (o->mapped)
		munmap((void *)o->pack.map, o->pack.map_size);
	if (o->pack.file >= 0)
		close(o->pack.file);
	free(o);
}

/* The list that a chunk belongs to, for messages. */
static uint32_t list_of_chunk(const struct eco_scene *scene, uint32_t chunk)
{
	for (uint32_t i = 0; i < scene->list_count; i++)
		if (chunk >= scene->lists[i].chunk_first && chunk - scene->lists[i].chunk_first
				< scene->lists[i].chunk_count)
			return i;
	return ECO_NONE;
}

enum eco_code eco_pack_payload(const struct eco_pack *pack, uint32_t chunk, const uint8_t **bytes,
	size_t *size_bytes, struct eco_error *error)
{
	const struct eco_scene *scene = &pack->scene;
	*bytes = NULL;
	*size_bytes = 0;
	if (chunk >= scene->chunk_count)
		return eco_fail(error, ECO_NOT_FOUND, "chunk %u of %u is not there", chunk,
			scene->chunk_count);
	const struct eco_chunk *c = &scene->chunks[chunk];
	struct eco_chunk_id id = eco_chunk_hash(pack->map + c->offset, c->size_bytes);
	if (memcmp(id.bytes, c->id.bytes, sizeof id.bytes) != 0)
		return BAD("chunk %u of list %u, bytes [%llu, +%u): its hash does "
			"not match; restore the pack", chunk, list_of_chunk(scene, chunk),
			(unsigned long long)c->offset, c->size_bytes);
	*bytes = pack->map + c->offset;
	*size_bytes = c->size_bytes;
	return ECO_OK;
}
