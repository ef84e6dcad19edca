/* Lays out a pack: sections in the order of their kinds, then the spooled payloads. The file gets its name
 * once all of it is on the disk. */
#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <xxhash.h>

#include "ecofiles/format/pack_record.h"
#include "ecofiles/format/pack_writer.h"

/* The bytes of a section, owned or borrowed. */
struct body {
	struct eco_section section;
	const uint8_t *bytes;
	struct eco_writer owned;
};

static void add_body(struct body *bodies, uint32_t *count, enum eco_section_kind kind, uint64_t records,
	struct body body)
{
	uint32_t record_bytes = eco_section_info[kind].record_bytes;
	if (!body.bytes) {
		body.bytes = body.owned.bytes;
		body.section.size = body.owned.size;
	}
	if (body.section.size == 0 && !body.owned.failed) {
		eco_writer_free(&body.owned);
		return;
	}
	assert(body.owned.failed || record_bytes == 0 || body.section.size == records * record_bytes);
	body.section.kind = kind;
	body.section.count = record_bytes == 0 ? 0 : (uint32_t)records;
	body.section.record_bytes = record_bytes;
	body.section.hash = !body.bytes ? 0 : XXH3_64bits(body.bytes, body.section.size);
	bodies[(*count)++] = body;
}

/* Makes all sections but CHUNK_DATA, without offsets. The chunk table holds file offsets, so it needs the
 * offset of CHUNK_DATA. */
static uint32_t make_bodies(const struct eco_scene *s, const char *meta_json, uint64_t chunk_data,
	struct body *bodies)
{
	uint32_t count = 0;
	struct body body;
	add_body(bodies, &count, ECO_SECTION_META, 0, (struct body){ .bytes = (const uint8_t *)meta_json,
		.section.size = !meta_json ? 0 : strlen(meta_json) });
	body = (struct body){ 0 };
	eco_scene_write(&body.owned, s);
	add_body(bodies, &count, ECO_SECTION_SCENE, 1, body);
#define TABLE(kind, table, name) \
	body = (struct body){ 0 }; \
	for (uint32_t i = 0; i < s->name##_count; i++) \
		eco_##name##_write(&body.owned, &s->table[i]); \
	add_body(bodies, &count, ECO_SECTION_##kind, s->name##_count, body);
	ECO_PACK_TABLES(TABLE)
	body = (struct body){ 0 };
	for (uint32_t i = 0; i < s->chunk_count; i++) {
		struct eco_chunk chunk = s->chunks[i];
		chunk.offset += chunk_data;
		eco_chunk_write(&body.owned, &chunk);
	}
	add_body(bodies, &count, ECO_SECTION_CHUNKS, s->chunk_count, body);
	add_body(bodies, &count, ECO_SECTION_PALETTE, s->palette_count,
		(struct body){ .bytes = (const uint8_t *)s->palette,
		.section.size = 3 * (uint64_t)s->palette_count });
	add_body(bodies, &count, ECO_SECTION_PLACES, s->place_count, (struct body){ .bytes = s->places,
		.section.size = ECO_PLACE_BYTES * s->place_count });
	body = (struct body){ 0 };
	for (uint32_t i = 0; i < s->ground_count; i++)
		eco_ground_tile_write(&body.owned, &s->ground[i]);
	add_body(bodies, &count, ECO_SECTION_GROUND, s->ground_count, body);
	TABLE(GROUND_IMAGES, ground_images, ground_image)
#undef TABLE
	return count;
}

static void free_bodies(struct body *bodies, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++)
		eco_writer_free(&bodies[i].owned);
}

static uint64_t align(uint64_t at)
{
	return (at + ECO_PACK_ALIGN - 1) / ECO_PACK_ALIGN * ECO_PACK_ALIGN;
}

/* Sets the sections' offsets; returns the end of the last. */
static uint64_t place_bodies(struct body *bodies, uint32_t count, uint32_t section_count)
{
	uint64_t at = ECO_PACK_HEADER_BYTES + (uint64_t)section_count * ECO_PACK_SECTION_BYTES;
	for (uint32_t i = 0; i < count; i++) {
		bodies[i].section.offset = align(at);
		at = bodies[i].section.offset + bodies[i].section.size;
	}
	return at;
}

static enum eco_code write_padding(struct eco_pack_writer *w, uint64_t at, uint64_t offset,
	struct eco_error *error)
{
	static const uint8_t zeros[ECO_PACK_ALIGN];
	return eco_pack_write_all(w->file, w->temporary, zeros, offset - at, error);
}

static enum eco_code copy_payloads(struct eco_pack_writer *w, struct eco_error *error)
{
	size_t size = 1u << 18;
	uint8_t *buffer = malloc(size);
	enum eco_code code = ECO_OK;
	if (!buffer)
		return eco_fail(error, ECO_NO_MEMORY, "%s: out of memory for copying", w->path);
	for (uint64_t at = 0; code == ECO_OK && at < w->spooled;) {
		ssize_t got = pread(w->spool, buffer, w->spooled - at < size ? w->spooled - at : size,
			(off_t)at);
		if (got < 0 && errno == EINTR)
			continue;
		if (got <= 0)
			code = eco_pack_io_failed(w->temporary, "read back payloads", error);
		else
			code = eco_pack_write_all(w->file, w->temporary, buffer, (size_t)got, error);
		at += got > 0 ? (uint64_t)got : 0;
	}
	free(buffer);
	return code;
}

static enum eco_code write_header(struct eco_pack_writer *w, const struct body *bodies, uint32_t count,
	uint64_t file_size, struct eco_error *error)
{
	struct eco_writer start = { 0 }, table = { 0 }, hashed = { 0 };
	enum eco_code code;
	for (uint32_t i = 0; i < count; i++)
		eco_section_write(&table, &bodies[i].section);
	eco_write_bytes(&start, ECO_PACK_MAGIC, 8);
	eco_write_u32(&start, ECO_PACK_VERSION);
	eco_write_u32(&start, count);
	eco_write_u64(&start, file_size);
	eco_write_bytes(&hashed, start.bytes, start.size);
	eco_write_bytes(&hashed, table.bytes, table.size);
	eco_write_u64(&start, hashed.failed ? 0 : XXH3_64bits(hashed.bytes, hashed.size));
	eco_write_bytes(&start, table.bytes, table.size);
	if (start.failed || table.failed || hashed.failed)
		code = eco_fail(error, ECO_NO_MEMORY, "%s: out of memory for the header", w->path);
	else
		code = eco_pack_write_all(w->file, w->temporary, start.bytes, start.size, error);
	eco_writer_free(&start);
	eco_writer_free(&table);
	eco_writer_free(&hashed);
	return code;
}

static enum eco_code write_file(struct eco_pack_writer *w, const struct eco_scene *scene,
	const char *meta_json, struct eco_error *error)
{
	struct body bodies[ECO_SECTION_KIND_END];
	uint32_t count = make_bodies(scene, meta_json, 0, bodies),
		section_count = count + (w->spooled > 0 ? 1 : 0);
	uint64_t at, end = place_bodies(bodies, count, section_count), chunk_data = align(end), file_size;
	enum eco_code code = ECO_OK;

	/* Sizes do not depend on the offset of CHUNK_DATA, only the chunk table does: make it again with
	 * the true offset. */
	free_bodies(bodies, count);
	count = make_bodies(scene, meta_json, chunk_data, bodies);
	place_bodies(bodies, count, section_count);
	file_size = end;
	for (uint32_t i = 0; i < count; i++)
		if (bodies[i].owned.failed)
			code = eco_fail(error, ECO_NO_MEMORY, "%s: out of memory for section %s", w->path,
				eco_section_info[bodies[i].section.kind].name);
	if (w->spooled > 0) {
		bodies[count] = (struct body){ .section = { .kind = ECO_SECTION_CHUNK_DATA,
			.offset = chunk_data, .size = w->spooled } };
		file_size = chunk_data + w->spooled;
	}
	if (!code)
		code = write_header(w, bodies, section_count, file_size, error);
	at = ECO_PACK_HEADER_BYTES + (uint64_t)section_count * ECO_PACK_SECTION_BYTES;
	for (uint32_t i = 0; code == ECO_OK && i < count; i++) {
		code = write_padding(w, at, bodies[i].section.offset, error);
		if (!code)
			code = eco_pack_write_all(w->file, w->temporary, bodies[i].bytes,
				bodies[i].section.size, error);
		at = bodies[i].section.offset + bodies[i].section.size;
	}
	if (code == ECO_OK && w->spooled > 0)
		code = write_padding(w, at, chunk_data, error);
	if (!code)
		code = copy_payloads(w, error);
	free_bodies(bodies, count);
	return code;
}

/* After this the pack is there even if the machine stops. */
static enum eco_code publish(struct eco_pack_writer *w, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	int folder;
	if (fsync(w->file) != 0)
		return eco_pack_io_failed(w->temporary, "sync", error);
	if (rename(w->temporary, w->path) != 0)
		return eco_pack_io_failed(w->path, "rename the finished file to this name", error);
	folder = open(w->folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (folder < 0 || fsync(folder) != 0)
		code = eco_pack_io_failed(w->folder, "sync the folder", error);
	if (folder >= 0)
		close(folder);
	/* The temporary file has been renamed: there is nothing to remove. */
	close(w->file);
	w->file = -1;
	return code;
}

enum eco_code eco_pack_commit(struct eco_pack_writer *writer, const struct eco_scene *scene,
	const char *meta_json, struct eco_error *error)
{
	struct eco_scene whole = *scene;
	enum eco_code code = ECO_OK;
	whole.lists = writer->lists;
	whole.list_count = writer->list_count;
	whole.chunks = writer->chunks;
	whole.chunk_count = writer->chunk_count;
	if (whole.place_count > UINT32_MAX)
		code = eco_fail(error, ECO_TOO_LARGE, "%s: %llu places, at most %u fit in a pack",
			writer->path, (unsigned long long)whole.place_count, UINT32_MAX);
	if (!code)
		code = eco_scene_check(&whole, error);
	if (!code)
		code = write_file(writer, &whole, meta_json, error);
	if (!code)
		code = publish(writer, error);
	eco_pack_abort(writer);
	return code;
}
