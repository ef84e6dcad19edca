/* The seeds of fuzz_chunk decode: a seed that is refused at its first byte shows a fuzzer nothing.
 * WRITE_SEEDS=1 build/tests/test_chunk_seeds writes those of all kinds anew, once payloads have changed. */
#include <dirent.h>
#include <stdio.h>

#include "ecofiles/base/bytes.h"
#include "tests/support/chunk_kinds.h"
#include "tests/support/files.h"

#define FOLDER "tests/fuzz/corpus/chunk/"
#define HEAD 8u                  /* bytes of a seed before its payload: see fuzz_chunk in tests/fuzz */
#define ELEMENTS 12u             /* of a seed, at most */
#define ORDINAL 3u

static void write_seed(const char *name, const struct eco_list *list, const struct eco_elements *e)
{
	const struct eco_chunk_input input = { list, e, 0, e->element_count, ORDINAL };
	const uint8_t head[HEAD] = { list->kind, list->coder, list->attributes, (uint8_t)list->columns,
		(uint8_t)e->element_count, (uint8_t)(e->element_count >> 8),
		(uint8_t)e->primitive_count, (uint8_t)(e->primitive_count >> 8) };
	FREED(eco_writer) w = { 0 };
	FREED_MEMORY uint8_t *bytes;
	char path[128];
	size_t size;
	assert_good(kind_encode(&input, &bytes, &size, &cause));
	eco_write_bytes(&w, head, sizeof head);
	eco_write_bytes(&w, bytes, size);
	snprintf(path, sizeof path, FOLDER "%s", name);
	for (char *space; (space = strchr(path, ' '));)
		*space = '-';
	file_write(path, w.bytes, w.size);
}

/* Connected wood, which no kind has: a strip of bark. */
static void write_bark(void)
{
	const struct kind wood = { "bark", ECO_LIST_TRIANGLES, ECO_CODER_MESH, ECO_ATTR_COLOR | ECO_ATTR_UV, 3, 3,
		200, 0, 9, SCATTERED };
	const struct eco_list list = kind_list(&wood);
	FREED(eco_elements) e = kind_elements(&wood, wood.count, 1);
	for (uint32_t i = 0; i < 3 * wood.count; i++) {
		/* triangles of quads beside each other, five high */
		static const uint8_t corners[6][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 }, { 0, 1 }, { 1, 0 }, { 1, 1 } };
		const uint8_t *c = corners[i % 6];
		int32_t x = (int32_t)(i / 6 / 5) + c[0], y = (int32_t)(i / 6 % 5) + c[1];
		memcpy(e.position + 3 * (size_t)i, (int32_t[3]){ 9 * x, 20 * y, x * x }, 12);
		memcpy(e.uv + 2 * (size_t)i, (int32_t[2]){ 100 * x, 200 * y }, 8);
	}
	memset(e.extra, 0, wood.count * sizeof *e.extra);
	write_seed(wood.name, &list, &e);
}

UNIT_TEST(seeds_decode)
{
	for (size_t i = 0; i < KIND_COUNT && getenv("WRITE_SEEDS"); i++) {
		const struct eco_list list = kind_list(&kinds[i]);
		FREED(eco_elements) e = kind_elements(&kinds[i], kinds[i].count < ELEMENTS ? kinds[i].count : ELEMENTS,
			i + 1);
		write_seed(kinds[i].name, &list, &e);
	}
	if (getenv("WRITE_SEEDS"))
		write_bark();
	uint32_t count = 0;
	DIR *folder = opendir(FOLDER);
	for (struct dirent *entry; folder && (entry = readdir(folder));) {
		char path[512];
		size_t size;
		if (entry->d_name[0] == '.')
			continue;
		snprintf(path, sizeof path, FOLDER "%s", entry->d_name);
		FREED_MEMORY uint8_t *bytes = file_read(path, &size);
		FREED(eco_elements) e;
		struct eco_error error = { 0 };
		assert_true(size > HEAD);
		const struct eco_list list = { .kind = bytes[0], .coder = bytes[1], .attributes = bytes[2],
			.columns = bytes[3] };
		const struct eco_chunk chunk = { .size_bytes = (uint32_t)(size - HEAD),
			.element_count = bytes[4] | (uint32_t)bytes[5] << 8,
			.primitive_count = bytes[6] | (uint32_t)bytes[7] << 8 };
		if (eco_chunk_decode(&list, &chunk, ORDINAL, bytes + HEAD, size - HEAD, &e, &error))
			fail_msg("%s: %s", path, error.text);
		count++;
	}
	if (folder)
		closedir(folder);
	assert_true(count >= KIND_COUNT);
}
