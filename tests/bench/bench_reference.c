#include "tests/bench/bench_reference.h"

#include <stdlib.h>
#include <string.h>
#include <xxhash.h>
#include <zstd.h>

#include "tests/bench/bench_state.h"

#define MAGIC 0x3166657265636531u
#define FAST 1 /* zstd's level */

struct head { uint64_t magic, width, height, soft, vertices, summaries; double draw_ms, ceiling; };

/* All parts of a picture to or from bytes; soft counts are the last, and may be missing. NULL: their size. */
static size_t move_parts(struct view_picture *p, uint8_t *bytes, bool from)
{
	size_t n = (size_t)p->width * p->height, at = 0;
	const struct { void *bytes; size_t size; } parts[] = { { p->rgb, 3 * n }, { p->cover, n },
		{ p->owner, n * sizeof *p->owner }, { p->depth, n * sizeof *p->depth },
		{ p->surface, n * sizeof *p->surface }, { p->soft, p->soft ? n : 0 } };
	for (size_t i = 0; i < sizeof parts / sizeof *parts; at += parts[i++].size)
		if (bytes && parts[i].size)
			memcpy(from ? parts[i].bytes : bytes + at, from ? bytes + at : parts[i].bytes,
				parts[i].size);
	return at;
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

enum eco_code bench_reference_write(const char *path, const struct bench_reference *reference,
	struct eco_error *error)
{
	struct view_picture p = reference->picture;
	const struct head head = { MAGIC, p.width, p.height, p.soft != NULL, p.vertices, reference->summaries,
		p.draw_ms, reference->ceiling };
	char folder[BENCH_REFERENCE_PATH];
	size_t size = sizeof head + move_parts(&p, NULL, false), room = ZSTD_compressBound(size);
	uint8_t *bytes = malloc(size), *packed = malloc(room);
	ZSTD_CCtx *coder = ZSTD_createCCtx();
	if (!bytes || !packed || !coder)
		abort();
	memcpy(bytes, &head, sizeof head);
	move_parts(&p, bytes + sizeof head, false);
	ZSTD_CCtx_setParameter(coder, ZSTD_c_compressionLevel, FAST);
	ZSTD_CCtx_setParameter(coder, ZSTD_c_checksumFlag, 1);
	room = ZSTD_compress2(coder, packed, room, bytes, size);
	snprintf(folder, sizeof folder, "%.*s", (int)(strrchr(path, '/') - path), path);
	enum eco_code code = bench_folder_make(folder, error);
	if (!code)
		code = ZSTD_isError(room) ? eco_fail(error, ECO_NO_MEMORY, "%s", ZSTD_getErrorName(room))
			: eco_file_write(path, packed, room, error);
	ZSTD_freeCCtx(coder);
	free(packed);
	free(bytes);
	return code;
}

/* The file's bytes without its frame; NULL where it is damaged. */
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

static bool take_apart(struct bench_reference *reference, uint8_t *bytes, size_t size)
{
	struct head head;
	struct view_picture *p = &reference->picture;
	memcpy(&head, bytes, sizeof head);
	if (head.magic != MAGIC || !head.width || head.width > UINT16_MAX || !head.height
		|| head.height > UINT16_MAX
			|| head.width * head.height >= size
			|| view_picture_init(p, (uint32_t)head.width, (uint32_t)head.height, NULL))
		return false;
	p->soft = head.soft ? malloc(head.width * head.height) : NULL;
	p->vertices = head.vertices;
	p->draw_ms = head.draw_ms;
	reference->ceiling = head.ceiling;
	reference->summaries = (uint32_t)head.summaries;
	if ((p->soft != NULL) == (head.soft != 0) && sizeof head + move_parts(p, NULL, true) == size) {
		move_parts(p, bytes + sizeof head, true);
		return true;
	}
	view_picture_free(p);
	return false;
}

bool bench_reference_read(const char *path, struct bench_reference *reference)
{
	size_t size;
	FILE *file = fopen(path, "rb");
	*reference = (struct bench_reference){ .summaries = 0 };
	uint8_t *bytes = file ? unpack(file, &size) : NULL;
	if (file)
		fclose(file);
	bool whole = bytes && take_apart(reference, bytes, size);
	free(bytes);
	return whole;
}
