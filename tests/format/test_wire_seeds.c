/* The seeds of fuzz_stream are streams and plans of this version of the wire, not of one that is refused at its
 * first frame. WRITE_SEEDS=1 build/tests/test_wire_seeds writes them anew, once the wire has changed. */
#include <stdio.h>
#include <stdlib.h>

#include "tests/support/files.h"
#include "tests/support/unit_test.h"
#include "tests/support/wire_random.h"

#define FOLDER "tests/fuzz/corpus/stream"
#define SEEDS 3u

/* `kind`, and of streams the portion that they come in, less 1: see fuzz_stream. */
enum kind { STREAM, FRAMES, PLAN };

static struct eco_writer seed_begin(enum kind kind, uint32_t number)
{
	struct eco_writer w = { 0 };
	eco_write_u8(&w, (uint8_t)kind);
	if (kind != PLAN)
		eco_write_u8(&w, (uint8_t)(7 + 20 * number));
	return w;
}

static void seed_is(const char *name, uint32_t number, struct eco_writer *w)
{
	char path[64];
	size_t size;
	assert_false(w->failed);
	snprintf(path, sizeof path, FOLDER "/%s-%u", name, number);
	if (getenv("WRITE_SEEDS"))
		file_write(path, w->bytes, w->size);
	uint8_t *bytes = file_read(path, &size);
	if (size != w->size || memcmp(bytes, w->bytes, size) != 0)
		fail_msg("%s is of another version of the wire: WRITE_SEEDS=1 build/tests/test_wire_seeds", path);
	free(bytes);
	eco_writer_free(w);
}

static struct eco_writer stream_of(uint32_t number)
{
	struct wire_random r = { number + 1 };
	struct eco_writer w = { 0 };
	wire_random_stream(&r, &w, number + 1);
	assert_false(w.failed);
	return w;
}

UNIT_TEST(streams)
{
	for (uint32_t i = 0; i < SEEDS; i++) {
		struct eco_writer stream = stream_of(i), seed = seed_begin(STREAM, i);
		eco_write_bytes(&seed, stream.bytes, stream.size);
		seed_is("stream", i, &seed);
		eco_writer_free(&stream);
	}
}

/* Frames without hashes: type, two bytes of length, payload. */
UNIT_TEST(frames)
{
	for (uint32_t i = 0; i < SEEDS; i++) {
		struct eco_writer stream = stream_of(i), seed = seed_begin(FRAMES, i);
		for (size_t at = 0; at < stream.size;) {
			struct eco_reader r = { .bytes = stream.bytes + at, .size = stream.size - at };
			uint8_t type = (uint8_t)eco_read_u32(&r);
			uint32_t size = eco_read_u32(&r);
			at += ECO_FRAME_HEADER_BYTES;
			assert_in_range(size, 0, UINT16_MAX);
			eco_write_u8(&seed, type);
			eco_write_u16(&seed, (uint16_t)size);
			eco_write_bytes(&seed, stream.bytes + at, size);
			at += size;
		}
		seed_is("frames", i, &seed);
		eco_writer_free(&stream);
	}
}

UNIT_TEST(plans)
{
	for (uint32_t i = 0; i < SEEDS; i++) {
		struct wire_random r = { 10 + i };
		struct eco_plan plan = wire_random_plan(&r, 2 + 4 * i, WIRE_RANDOM_LISTS, WIRE_RANDOM_PLANTS);
		struct eco_writer seed = seed_begin(PLAN, i);
		eco_wire_write_plan(&seed, &plan);
		seed_is("plan", i, &seed);
		eco_plan_free(&plan);
	}
}
