/* Writing a pack, all or nothing. Payloads are made first but lie last in the file, behind tables whose size
 * is known only at the end. So they are spooled to an unlinked file in the target's folder (memory stays
 * small, and a full disk is noticed early), and eco_pack_commit copies them behind the tables. The target's
 * name appears only by renaming a complete, synced file. A process that is killed leaves its unfinished file;
 * the next one that writes the same pack removes it. Programs that write packs run once: without memory they
 * end, and what cannot be written stops them (memory.h). */
#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <xxhash.h>

#include "ecofiles/base/array_grow.h"
#include "ecofiles/base/files.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/pack_record.h"

/* ---- Files ---- */

struct eco_pack_writer {
	char *path, *temporary, *folder;
	int file, spool;             /* -1 when closed */
	uint64_t spooled;
	struct eco_list *lists;
	uint32_t list_count, list_capacity;
	struct eco_chunk *chunks;    /* offsets relative to the spool until commit */
	uint32_t chunk_count, chunk_capacity;
	/* by id and size, so that equal payloads are stored once; where in the spool each is */
	struct eco_string_pool payloads;
	uint64_t *offsets;
	uint32_t offset_capacity;
};

/* Says what could not be done, and why (errno). */
static _Noreturn void io_failed(const char *path, const char *what)
{
	int reason = errno;
	eco_stop(ECO_IO, "%.330s: cannot %s: %s%s", path, what, strerror(reason), eco_advice_write(reason));
}

static void write_all(const struct eco_pack_writer *w, int file, const void *bytes, size_t size)
{
	for (size_t done = 0; done < size;) {
		ssize_t written = write(file, (const uint8_t *)bytes + done, size - done);
		if (written == 0 || (written < 0 && errno != EINTR))
			io_failed(w->temporary, "write");
		done += written > 0 ? (size_t)written : 0;
	}
}

static void read_spool(const struct eco_pack_writer *w, uint64_t offset, uint8_t *bytes, size_t size)
{
	for (size_t done = 0; done < size;) {
		ssize_t got = pread(w->spool, bytes + done, size - done, (off_t)(offset + done));
		if (got == 0 || (got < 0 && errno != EINTR))
			io_failed(w->temporary, "read back payloads");
		done += got > 0 ? (size_t)got : 0;
	}
}

/* The folder part of a path, malloc'ed. */
static char *folder_of(const char *path)
{
	const char *slash = strrchr(path, '/');
	if (!slash || slash == path)
		return eco_copy_text(slash ? "/" : ".");
	return eco_copy_part(path, (size_t)(slash - path));
}

/* Creates the unfinished file and locks it; another process may have taken it for left over in between. */
static void open_unfinished(struct eco_pack_writer *w)
{
	eco_unfinished_remove(w->path);
	for (;;) {
		w->file = open(w->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
		if (w->file < 0)
			io_failed(w->path, "create");
		if (eco_unfinished_lock(w->file))
			return;
		close(w->file);
	}
}

/* Only packs and empty files may be replaced: a slip of the hand must not cost a model or an inventory. */
static bool may_replace(const char *path)
{
	char magic[8];
	int file = open(path, O_RDONLY | O_CLOEXEC);
	ssize_t got = file >= 0 ? read(file, magic, sizeof magic) : -1;
	if (file >= 0)
		close(file);
	return got == 0 || (got == sizeof magic && memcmp(magic, ECO_PACK_MAGIC, sizeof magic) == 0);
}

static enum eco_code check_target(const char *path, struct eco_error *error)
{
	struct stat status;
	bool there = stat(path, &status) == 0;
	if (path[0] == 0)
		return eco_fail(error, ECO_BAD_USAGE, "a pack needs a file name");
	if (there && !S_ISREG(status.st_mode))
		return eco_fail(error, ECO_BAD_INPUT, "%s: exists and is not a regular file", path);
	if (there && !may_replace(path))
		return eco_fail(error, ECO_BAD_INPUT, "%s: exists and is not a pack: it is kept; write "
			"elsewhere, or remove it first", path);
	return ECO_OK;
}

static void open_files(void *writer)
{
	struct eco_pack_writer *w = writer;
	open_unfinished(w);
	w->spool = eco_file_nameless(w->folder);
	if (w->spool < 0)
		io_failed(w->folder, "create a file in it");
}

enum eco_code eco_pack_create(struct eco_pack_writer **writer, const char *path, struct eco_error *error)
{
	struct eco_pack_writer *w = *writer = NULL;
	ECO_PASS(check_target(path, error));
	w = eco_alloc(1, sizeof *w);
	w->file = w->spool = -1;
	w->path = eco_copy_text(path);
	w->folder = folder_of(path);
	if (asprintf(&w->temporary, "%s.tmp-%ld", path, (long)getpid()) < 0)
		eco_end("no memory");
	enum eco_code code = eco_try(open_files, w, error);
	if (code)
		eco_pack_abort(w);
	else
		*writer = w;
	return code;
}

void eco_pack_abort(struct eco_pack_writer *w)
{
	if (!w)
		return;
	if (w->file >= 0) {
		unlink(w->temporary);
		close(w->file);
	}
	if (w->spool >= 0)
		close(w->spool);
	eco_free(w->path, w->temporary, w->folder, w->lists, w->chunks);
	eco_string_pool_free(&w->payloads);
	free(w->offsets);
	free(w);
}

/* ---- Chunks and lists ---- */

/* The number of a payload among those that differ. */
static uint32_t payload_number(struct eco_pack_writer *w, const struct eco_chunk *chunk)
{
	char key[2 * sizeof chunk->id.bytes + 12];
	snprintf(key, sizeof key, "%s-%u", eco_id_text(chunk->id.bytes).hex, chunk->size_bytes);
	return eco_string_number(&w->payloads, key);
}

static void add_chunk(struct eco_pack_writer *w, const uint8_t *bytes, size_t size, uint32_t elements,
	uint32_t primitives)
{
	struct eco_chunk chunk = { .id = eco_chunk_hash(bytes, size), .size_bytes = (uint32_t)size,
		.element_count = elements, .primitive_count = primitives };
	uint32_t before = w->payloads.count, number = payload_number(w, &chunk);
	if (number == before) {
		write_all(w, w->spool, bytes, size);
		eco_grow(&w->offsets, &w->offset_capacity, number, sizeof *w->offsets);
		w->offsets[number] = w->spooled;
		w->spooled += size;
	}
	chunk.offset = w->offsets[number];
	eco_grow(&w->chunks, &w->chunk_capacity, w->chunk_count, sizeof *w->chunks);
	w->chunks[w->chunk_count++] = chunk;
}

/* Primitives of elements [first, end). */
static uint32_t count_primitives(const struct eco_elements *elements, uint32_t first, uint32_t end)
{
	uint32_t count = 0;
	for (uint32_t i = first; i < end; i++)
		count += elements->corners[i] < 3 ? 1 : elements->corners[i] - 2u;
	return count;
}

/* As eco_pack_encode; also the forms of `partner`. */
static enum eco_code encode(struct eco_encoded *encoded, const struct eco_list *list,
	const struct eco_elements *elements, const struct eco_elements *partner, uint8_t partner_attributes,
	const uint32_t *ends, uint32_t end_count, struct eco_error *error)
{
	/* The partner's stored order follows from its elements: of its list only kind and coder matter. */
	const struct eco_list fans = { .kind = ECO_LIST_TRIANGLES, .coder = ECO_CODER_ELEMENTS,
		.attributes = partner_attributes };
	enum eco_code code = ECO_OK;
	assert((end_count > 0 ? ends[end_count - 1] : 0) == elements->element_count);
	*encoded = (struct eco_encoded){ .chunks = eco_alloc(end_count, sizeof *encoded->chunks) };
	for (uint32_t first = 0; !code && encoded->count < end_count; first = ends[encoded->count++]) {
		struct eco_encoded_chunk *chunk = &encoded->chunks[encoded->count];
		uint32_t end = ends[encoded->count];
		const struct eco_chunk_input input = { partner ? &fans : list, partner ? partner : elements, first,
			end, encoded->count };
		chunk->elements = end - first;
		chunk->primitives = count_primitives(elements, first, end);
		code = partner ? eco_chunk_encode_form(&input, list, elements, &chunk->bytes, &chunk->size, error)
			: eco_chunk_encode(&input, &chunk->bytes, &chunk->size, error);
	}
	return code;
}

enum eco_code eco_pack_encode(struct eco_encoded *encoded, const struct eco_list *list,
	const struct eco_elements *elements, const uint32_t *ends, uint32_t end_count,
	struct eco_error *error)
{
	return encode(encoded, list, elements, NULL, 0, ends, end_count, error);
}

void eco_encoded_free(struct eco_encoded *encoded)
{
	for (uint32_t i = 0; i < encoded->count; i++)
		free(encoded->chunks[i].bytes);
	free(encoded->chunks);
	*encoded = (struct eco_encoded){ .count = 0 };
}

/* Appends the list, with the chunks since `chunk_first` and their counts; returns its id. */
static uint32_t add_list(struct eco_pack_writer *w, const struct eco_list *list, uint32_t chunk_first)
{
	eco_grow(&w->lists, &w->list_capacity, w->list_count, sizeof *w->lists);
	struct eco_list *stored = &w->lists[w->list_count];
	*stored = *list;
	stored->chunk_first = chunk_first;
	stored->chunk_count = w->chunk_count - chunk_first;
	stored->primitive_count = stored->element_count = 0;
	for (uint32_t i = chunk_first; i < w->chunk_count; i++) {
		stored->primitive_count += w->chunks[i].primitive_count;
		stored->element_count += w->chunks[i].element_count;
	}
	return w->list_count++;
}

uint32_t eco_pack_add_encoded(struct eco_pack_writer *writer, const struct eco_list *list,
	const struct eco_encoded *encoded)
{
	uint32_t chunk_first = writer->chunk_count;
	for (uint32_t i = 0; i < encoded->count; i++) {
		const struct eco_encoded_chunk *chunk = &encoded->chunks[i];
		add_chunk(writer, chunk->bytes, chunk->size, chunk->elements, chunk->primitives);
	}
	return add_list(writer, list, chunk_first);
}

uint32_t eco_pack_add_list(struct eco_pack_writer *writer, const struct eco_list *list,
	const struct eco_elements *elements, const uint32_t *ends, uint32_t end_count,
	const struct eco_elements *partner_elements)
{
	struct eco_encoded encoded;
	struct eco_error why = { ECO_OK };
	bool form = list->coder == ECO_CODER_FORM;
	assert(form == (partner_elements != NULL) && (!form || list->partner < writer->list_count));
	enum eco_code code = encode(&encoded, list, elements, partner_elements,
		form ? writer->lists[list->partner].attributes : 0, ends, end_count, &why);
	if (code)
		eco_stop(code, "%s", why.text);
	uint32_t id = eco_pack_add_encoded(writer, list, &encoded);
	eco_encoded_free(&encoded);
	for (int axis = 0; axis < 3 && elements->exact; axis++)
		writer->lists[id].grid_step[axis] /= 1 << ECO_EXACT_SHIFT;
	return id;
}

uint32_t eco_pack_add_bytes(struct eco_pack_writer *writer, const struct eco_list *list,
	const struct eco_bytes *files, uint32_t file_count)
{
	uint32_t chunk_first = writer->chunk_count;
	assert(list->coder == ECO_CODER_BYTES);
	for (uint32_t i = 0; i < file_count; i++) {
		if (files[i].size < 1 || files[i].size > ECO_CHUNK_BYTES_MAX)
			eco_stop(ECO_TOO_LARGE, "list %u: a file of %zu bytes; 1 to %u fit", writer->list_count,
				files[i].size, ECO_CHUNK_BYTES_MAX);
		add_chunk(writer, files[i].at, files[i].size, 1, 1);
	}
	return add_list(writer, list, chunk_first);
}

enum eco_code eco_pack_add_copied(struct eco_pack_writer *writer, const struct eco_list *list,
	const struct eco_pack *from, uint32_t from_list, uint32_t *list_id, struct eco_error *error)
{
	const struct eco_list *old = &from->scene.lists[from_list];
	uint32_t chunk_first = writer->chunk_count;
	for (uint32_t i = old->chunk_first; i < old->chunk_first + old->chunk_count; i++) {
		const struct eco_chunk *chunk = &from->scene.chunks[i];
		const uint8_t *bytes;
		size_t size;
		ECO_PASS(eco_pack_payload(from, i, &bytes, &size, error));
		add_chunk(writer, bytes, size, chunk->element_count, chunk->primitive_count);
	}
	*list_id = add_list(writer, list, chunk_first);
	return ECO_OK;
}

/* Appends points to points. */
static void join(struct eco_elements *all, const struct eco_elements *part)
{
	size_t before = all->element_count, count = before + part->element_count, extra = part->extra_count;
	all->corners = eco_realloc(all->corners, count, 1);
	all->position = eco_realloc(all->position, count, 3 * sizeof *all->position);
	all->extra = eco_realloc(all->extra, extra * count, sizeof *all->extra);
	memcpy(all->corners + before, part->corners, part->element_count);
	memcpy(all->position + 3 * before, part->position, 3 * (size_t)part->element_count * sizeof *part->position);
	if (extra > 0)
		memcpy(all->extra + extra * before, part->extra, extra * part->element_count * sizeof *part->extra);
	all->element_count = all->corner_count = all->primitive_count = (uint32_t)count;
}

/* All points of a list, whose chunks are in the writer's spool or, without a writer, in the pack. */
static enum eco_code join_chunks(struct eco_elements *points, const struct eco_list *list,
	const struct eco_chunk *chunks, const struct eco_pack_writer *writer, const struct eco_pack *pack,
	struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	*points = (struct eco_elements){ .extra_count = eco_list_extra_count(list) };
	for (uint32_t i = 0; i < list->chunk_count && !code; i++) {
		const struct eco_chunk *chunk = &chunks[list->chunk_first + i];
		uint8_t *spooled = writer ? eco_alloc(chunk->size_bytes, 1) : NULL;
		const uint8_t *bytes = spooled;
		struct eco_elements part = { .element_count = 0 };
		size_t size;
		if (pack)
			code = eco_pack_payload(pack, list->chunk_first + i, &bytes, &size, error);
		else
			read_spool(writer, chunk->offset, spooled, chunk->size_bytes);
		code = code ? code : eco_chunk_decode(list, chunk, i, bytes, chunk->size_bytes, &part, error);
		if (!code)
			join(points, &part);
		eco_elements_free(&part);
		free(spooled);
	}
	if (code)
		eco_elements_free(points);
	return code;
}

enum eco_code eco_pack_read_points(struct eco_pack_writer *writer, uint32_t list_id,
	struct eco_elements *points, struct eco_error *error)
{
	const struct eco_list *list = &writer->lists[list_id];
	assert(list_id < writer->list_count && list->kind == ECO_LIST_POINTS && list->coder == ECO_CODER_KD);
	return join_chunks(points, list, writer->chunks, writer, NULL, error);
}

enum eco_code eco_pack_points(const struct eco_pack *pack, uint32_t list_id, struct eco_elements *points,
	struct eco_error *error)
{
	const struct eco_list *list = &pack->scene.lists[list_id];
	*points = (struct eco_elements){ 0 };
	if (list->kind != ECO_LIST_POINTS || list->coder != ECO_CODER_KD)
		return eco_fail(error, ECO_BAD_INPUT, "list %u is not one of points", list_id);
	return join_chunks(points, list, pack->scene.chunks, NULL, pack, error);
}

const struct eco_list *eco_pack_list(const struct eco_pack_writer *writer, uint32_t list_id)
{
	assert(list_id < writer->list_count);
	return &writer->lists[list_id];
}

/* ---- The file: sections in the order of their kinds, then the spooled payloads ---- */

static uint64_t align(uint64_t at)
{
	return (at + ECO_PACK_ALIGN - 1) / ECO_PACK_ALIGN * ECO_PACK_ALIGN;
}

/* Sections that are there, with their places in the file; returns how many. */
static uint32_t lay_out(struct eco_section sections[ECO_SECTION_KIND_END], const struct eco_pack_writer *w,
	const struct eco_scene *scene, const char *meta_json)
{
	const uint64_t counts[ECO_SECTION_KIND_END] = { [ECO_SECTION_SCENE] = 1,
		[ECO_SECTION_PALETTE] = scene->palette_count, [ECO_SECTION_PLACES] = scene->place_count },
		sizes[ECO_SECTION_KIND_END] = { [ECO_SECTION_META] = meta_json ? strlen(meta_json) : 0,
		[ECO_SECTION_CHUNK_DATA] = w->spooled };
	uint32_t number = 0;
	for (enum eco_section_kind kind = 1; kind < ECO_SECTION_KIND_END; kind++) {
		uint64_t count = eco_records_are_table(kind) ? eco_records_count(scene, kind) : counts[kind];
		struct eco_section s = { .kind = kind, .count = (uint32_t)count,
			.record_bytes = eco_record_bytes(kind), .size = sizes[kind] };
		s.size += count * s.record_bytes;
		if (s.size)
			sections[number++] = s;
	}
	uint64_t at = ECO_PACK_HEADER_BYTES + (uint64_t)number * ECO_PACK_SECTION_BYTES;
	for (uint32_t i = 0; i < number; at = sections[i].offset + sections[i].size, i++)
		sections[i].offset = align(at);
	return number;
}

/* A section's bytes, which `owned` has if they are not borrowed; NULL: payloads, which are in the spool. */
static const uint8_t *bytes_of(const struct eco_section *s, const struct eco_scene *scene, const char *meta_json,
	struct eco_writer *owned)
{
	switch (s->kind) {
	case ECO_SECTION_META: return (const uint8_t *)meta_json;
	case ECO_SECTION_PALETTE: return scene->palette[0];
	case ECO_SECTION_PLACES: return scene->places;
	case ECO_SECTION_CHUNK_DATA: return NULL;
	case ECO_SECTION_SCENE: eco_record_write(owned, s->kind, scene); break;
	default: eco_records_write(owned, s->kind, scene);
	}
	return owned->bytes;
}

static void copy_payloads(const struct eco_pack_writer *w)
{
	const size_t most = 1u << 18;
	uint8_t *buffer = eco_alloc(most, 1);
	for (uint64_t at = 0; at < w->spooled; at += most) {
		size_t size = w->spooled - at < most ? w->spooled - at : most;
		read_spool(w, at, buffer, size);
		write_all(w, w->file, buffer, size);
	}
	free(buffer);
}

/* The hash of the header covers the bytes before the hash and the section table behind it. */
static void write_header(const struct eco_pack_writer *w, const struct eco_section *sections, uint32_t count)
{
	struct eco_writer hashed = { 0 }, all = { 0 };
	eco_write_bytes(&hashed, ECO_PACK_MAGIC, 8);
	eco_write_u32(&hashed, ECO_PACK_VERSION);
	eco_write_u32(&hashed, count);
	eco_write_u64(&hashed, sections[count - 1].offset + sections[count - 1].size);
	size_t before = hashed.size;
	for (uint32_t i = 0; i < count; i++)
		eco_record_write(&hashed, ECO_SECTION_NONE, &sections[i]);
	if (!hashed.failed) {
		eco_write_bytes(&all, hashed.bytes, before);
		eco_write_u64(&all, XXH3_64bits(hashed.bytes, hashed.size));
		eco_write_bytes(&all, hashed.bytes + before, hashed.size - before);
	}
	if (hashed.failed || all.failed)
		eco_end("no memory");
	write_all(w, w->file, all.bytes, all.size);
	eco_writer_free(&hashed);
	eco_writer_free(&all);
}

static void write_file(struct eco_pack_writer *w, const struct eco_scene *scene, const char *meta_json)
{
	static const uint8_t zeros[ECO_PACK_ALIGN];
	struct eco_section sections[ECO_SECTION_KIND_END];
	struct eco_writer owned[ECO_SECTION_KIND_END] = { { 0 } };
	const uint8_t *bytes[ECO_SECTION_KIND_END];
	uint32_t count = lay_out(sections, w, scene, meta_json);
	uint64_t at = ECO_PACK_HEADER_BYTES + (uint64_t)count * ECO_PACK_SECTION_BYTES;
	for (uint32_t i = 0; i < w->chunk_count; i++)        /* payloads are the last section */
		w->chunks[i].offset += sections[count - 1].offset;
	for (uint32_t i = 0; i < count; i++) {
		bytes[i] = bytes_of(&sections[i], scene, meta_json, &owned[i]);
		sections[i].hash = bytes[i] ? XXH3_64bits(bytes[i], sections[i].size) : 0;
		if (owned[i].failed)
			eco_end("no memory");
	}
	write_header(w, sections, count);
	for (uint32_t i = 0; i < count; at = sections[i].offset + sections[i].size, i++) {
		write_all(w, w->file, zeros, sections[i].offset - at);
		if (bytes[i])
			write_all(w, w->file, bytes[i], sections[i].size);
		else
			copy_payloads(w);
		eco_writer_free(&owned[i]);
	}
}

/* After this the pack is there even if the machine stops. */
static void publish(struct eco_pack_writer *w)
{
	if (fsync(w->file) != 0)
		io_failed(w->temporary, "sync");
	if (rename(w->temporary, w->path) != 0)
		io_failed(w->path, "rename the finished file to this name");
	/* The temporary file has been renamed: there is nothing to remove. */
	close(w->file);
	w->file = -1;
	int folder = open(w->folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (folder < 0 || fsync(folder) != 0)
		io_failed(w->folder, "sync the folder");
	close(folder);
}

struct commit {
	struct eco_pack_writer *writer;
	struct eco_scene scene;
	const char *meta_json;
	struct eco_error *error;
};

static void commit(void *ctx)
{
	struct commit *c = ctx;
	struct eco_pack_writer *w = c->writer;
	c->scene.lists = w->lists;
	c->scene.list_count = w->list_count;
	c->scene.chunks = w->chunks;
	c->scene.chunk_count = w->chunk_count;
	if (c->scene.place_count > UINT32_MAX)
		eco_stop(ECO_TOO_LARGE, "%s: %llu places, at most %u fit in a pack", w->path,
			(unsigned long long)c->scene.place_count, UINT32_MAX);
	eco_check(eco_scene_check(&c->scene, c->error));
	write_file(w, &c->scene, c->meta_json);
	publish(w);
}

enum eco_code eco_pack_commit(struct eco_pack_writer *writer, const struct eco_scene *scene,
	const char *meta_json, struct eco_error *error)
{
	struct commit c = { writer, *scene, meta_json, error };
	enum eco_code code = eco_try(commit, &c, error);
	eco_pack_abort(writer);
	return code;
}
