/* The seeds of fuzz_stream are streams and plans of this version of the wire, not of one that is refused at
 * its first frame. WRITE_SEEDS=1 build/tests/test_wire_seeds writes them anew, once the wire has changed. */
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/files.h"
#include "tests/support/unit_test.h"
#include "tests/support/wire_random.h"

#define FOLDER "tests/fuzz/corpus/stream"
#define SEEDS 3u

/* A seed has what follows, and of streams the portion that they come in, less 1: see fuzz_stream in tests/fuzz. */
enum kind { STREAM, FRAMES, PLAN };

/* Frames without hashes: type, two bytes of length, payload. */
static void put_frames(struct eco_writer *seed, const struct eco_writer *stream)
{
	struct eco_reader r = { .bytes = stream->bytes, .size = stream->size };
	while (r.at < r.size) {
		uint8_t type = (uint8_t)eco_read_u32(&r);
		uint32_t size = eco_read_u32(&r);
		eco_read_u64(&r);
		assert_in_range(size, 0, UINT16_MAX);
		eco_write_u8(seed, type);
		eco_write_u16(seed, (uint16_t)size);
		eco_write_bytes(seed, eco_read_bytes(&r, size), size);
	}
}

static struct eco_writer make_seed(enum kind kind, uint32_t number)
{
	struct eco_writer seed = { 0 }, stream = { 0 };
	struct wire_random r = { kind == PLAN ? 10 + number : number + 1 };
	eco_write_u8(&seed, (uint8_t)kind);
	if (kind == PLAN) {
		FREED(eco_plan) plan = wire_random_plan(&r, 2 + 4 * number, WIRE_RANDOM_LISTS,
			WIRE_RANDOM_PLANTS);
		eco_wire_write_plan(&seed, &plan);
		return seed;
	}
	wire_random_stream(&r, &stream, number + 1);
	eco_write_u8(&seed, (uint8_t)(7 + 20 * number));
	if (kind == FRAMES)
		put_frames(&seed, &stream);
	else
		eco_write_bytes(&seed, stream.bytes, stream.size);
	eco_writer_free(&stream);
	return seed;
}

UNIT_TEST(seeds_are_of_this_version)
{
	static const char *const names[] = { "stream", "frames", "plan" };
	for (uint32_t i = 0; i < 3 * SEEDS; i++) {
		FREED(eco_writer) seed = make_seed(i % 3, i / 3);
		char path[64];
		size_t size;
		snprintf(path, sizeof path, FOLDER "/%s-%u", names[i % 3], i / 3);
		if (getenv("WRITE_SEEDS"))
			file_write(path, seed.bytes, seed.size);
		uint8_t *bytes = file_read(path, &size);
		if (seed.failed || size != seed.size || memcmp(bytes, seed.bytes, size) != 0)
			fail_msg("%s is of another version of the wire: WRITE_SEEDS=1 build/tests/test_wire_seeds",
				path);
		free(bytes);
	}
}
