#include "tests/bench/bench_reference.h"

#include <stdlib.h>
#include <string.h>
#include <xxhash.h>
#include <zstd.h>

#include "tests/bench/bench_state.h"

#define MAGIC 0x3166657265636531u
#define FAST 1 /* zstd's level */

struct head { uint64_t magic, width, height, soft, vertices, summaries; double draw_ms, ceiling; };
struct part { void *bytes; size_t size; };
#define PARTS 6u

/* Soft counts are the last, and may be missing. */
static uint32_t parts_of(const struct view_picture *p, struct part parts[PARTS])
{
	size_t n = (size_t)p->width * p->height;
	const struct part all[PARTS] = { { p->rgb, 3 * n }, { p->cover, n },
		{ p->owner, n * sizeof *p->owner },
		{ p->depth, n * sizeof *p->depth }, { p->surface, n * sizeof *p->surface }, { p->soft, n } };
	memcpy(parts, all, sizeof all);
	return p->soft ? PARTS : PARTS - 1;
}

static size_t size_of(const struct part *parts, uint32_t count)
{
	size_t size = sizeof(struct head);
	for (uint32_t i = 0; i < count; i++)
		size += parts[i].size;
	return size;
}

bool bench_reference_path(const struct bench *bench, const char *pack, const struct eco_view *view, bool sees,
	char path[BENCH_REFERENCE_PATH])
{
	char program[17];
	const char *content = bench_pack_stamp(pack);
	if (strlen(content) <= strlen("pack "))
		return false;
	uint64_t name = XXH3_64bits_withSeed(view, sizeof *view, XXH3_64bits(content, strlen(content)));
	bench_objects_stamp(bench, BENCH_OBJECTS_FRAMES "tests/bench/bench_frame.o", program);
	name = XXH3_64bits_withSeed(program, strlen(program), name + sees);
	snprintf(path, BENCH_REFERENCE_PATH, "%s/references/%016llx", bench->cache, (unsigned long long)name);
	return true;
}

/* ---- Writing ---- */

static uint8_t *join(const struct bench_reference *reference, size_t *size)
{
	const struct view_picture *p = &reference->picture;
	const struct head head = { MAGIC, p->width, p->height, p->soft != NULL, p->vertices,
		reference->summaries, p->draw_ms, reference->ceiling };
	struct part parts[PARTS];
	uint32_t count = parts_of(p, parts);
	uint8_t *bytes = malloc(*size = size_of(parts, count)), *at = bytes + sizeof head;
	if (!bytes)
		return NULL;
	memcpy(bytes, &head, sizeof head);
	for (uint32_t i = 0; i < count; at += parts[i++].size)
		memcpy(at, parts[i].bytes, parts[i].size);
	return bytes;
}

enum eco_code bench_reference_write(const char *path, const struct bench_reference *reference,
	struct eco_error *error)
{
	char folder[BENCH_REFERENCE_PATH];
	size_t size, room;
	uint8_t *bytes = join(reference, &size), *packed = malloc(room = ZSTD_compressBound(size));
	ZSTD_CCtx *coder = ZSTD_createCCtx();
	enum eco_code code = bytes && packed && coder ? ECO_OK
		: eco_fail(error, ECO_NO_MEMORY, "no memory to keep a picture");
	if (!code) {
		ZSTD_CCtx_setParameter(coder, ZSTD_c_compressionLevel, FAST);
		ZSTD_CCtx_setParameter(coder, ZSTD_c_checksumFlag, 1);
		room = ZSTD_compress2(coder, packed, room, bytes, size);
		snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(path, '/') - path), path);
		code = bench_folder_make(folder, error);
	}
	if (!code)
		code = ZSTD_isError(room) ? eco_fail(error, ECO_NO_MEMORY, "%s", ZSTD_getErrorName(room))
			: bench_file_write(path, (const char *)packed, room, error);
	ZSTD_freeCCtx(coder);
	free(packed);
	free(bytes);
	return code;
}

/* ---- Reading ---- */

/* The file's bytes without its frame; NULL where it is none of ours. */
static uint8_t *unpack(FILE *file, size_t *size)
{
	long packed_size = fseek(file, 0, SEEK_END) ? -1 : ftell(file);
	uint8_t *packed = packed_size > 0 ? malloc((size_t)packed_size) : NULL, *bytes = NULL;
	rewind(file);
	if (packed && fread(packed, 1, (size_t)packed_size, file) == (size_t)packed_size) {
		unsigned long long whole = ZSTD_getFrameContentSize(packed, (size_t)packed_size);
		bytes = whole >= sizeof(struct head) && whole < 1ull << 31 ? malloc(whole) : NULL;
		*size = bytes ? ZSTD_decompress(bytes, whole, packed, (size_t)packed_size) : 0;
		if (*size != whole) {
			free(bytes);
			bytes = NULL;
		}
	}
	free(packed);
	return bytes;
}

static bool fill(struct view_picture *picture, const struct head *head, const uint8_t *bytes, size_t size)
{
	struct part parts[PARTS];
	const uint8_t *at = bytes + sizeof *head;
	picture->soft = head->soft ? malloc((size_t)head->width * head->height) : NULL;
	uint32_t count = parts_of(picture, parts);
	if (count != PARTS - !head->soft || size_of(parts, count) != size)
		return false;
	for (uint32_t i = 0; i < count; at += parts[i++].size)
		memcpy(parts[i].bytes, at, parts[i].size);
	picture->vertices = head->vertices;
	picture->draw_ms = head->draw_ms;
	return true;
}

static bool take_apart(struct bench_reference *reference, const uint8_t *bytes, size_t size)
{
	struct head head;
	memcpy(&head, bytes, sizeof head);
	bool fits = head.magic == MAGIC && head.width && head.width <= UINT16_MAX && head.height
		&& head.height <= UINT16_MAX && head.width * head.height < size;
	if (!fits || view_picture_init(&reference->picture, (uint32_t)head.width, (uint32_t)head.height,
			NULL))
		return false;
	reference->ceiling = head.ceiling;
	reference->summaries = (uint32_t)head.summaries;
	if (fill(&reference->picture, &head, bytes, size))
		return true;
	view_picture_free(&reference->picture);
	return false;
}

bool bench_reference_read(const char *path, struct bench_reference *reference)
{
	size_t size;
	FILE *file = fopen(path, "rb");
	if (!file)
		return false;
	*reference = (struct bench_reference){ .summaries = 0 };
	uint8_t *bytes = unpack(file, &size);
	fclose(file);
	bool whole = bytes && take_apart(reference, bytes, size);
	free(bytes);
	return whole;
}
