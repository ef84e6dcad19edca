/* Chunks that are asked for stay in memory, others do not come there: the pack is mapped, nothing of it is
 * copied, and the system's page cache keeps by use. Held against /proc: what of the map lies in this process,
 * and how much memory of its own it takes. */
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "server/stream.h"
#include "tests/support/files.h"
#include "tests/support/ground_tiles.h"
#include "tests/support/scene_packs.h"
#include "tests/support/unit_test.h"

#define PATH "build/tmp/hot_chunks.eco"
#define SIDE 1025u
#define STEP_M 3.0
#define HALF_M (STEP_M * (SIDE - 1) / 2)
#define AROUND_BYTES 65536u              /* that Linux maps around a page that is asked for,
	if it is cached */

static struct srv_store packs;
static struct srv_scene *scene;
static uint64_t opened_bytes;            /* resident after opening */

/* Rough, so that the ground takes most of the pack. */
static double hills(double x, double y)
{
	uint32_t h = (uint32_t)(int32_t)x * 2654435761u ^ (uint32_t)(int32_t)y * 2246822519u;
	return (double)(h >> 24) * 0.1;
}

/* Bytes of the pack that are mapped into this process now. */
static uint64_t resident_bytes(void);

static int open_pack(void **state)
{
	struct eco_ground ground = ground_make(SIDE, SIDE, -HALF_M, -HALF_M, STEP_M, hills);
	struct eco_error error = { 0 };
	folder_make("build/tmp");
	remove(PATH);
	srv_store_init(&packs);
	if (sample_pack_write_on(PATH, &ground, true, &error) || srv_store_add(&packs, "hot", PATH, &error))
		fail_msg("%s", error.text);
	scene = srv_store_find(&packs, "hot");
	opened_bytes = resident_bytes();
	eco_ground_free(&ground);
	return 0;
}

static int close_pack(void **state)
{
	srv_store_free(&packs);
	remove(PATH);
	return 0;
}

static uint64_t resident_bytes(void)
{
	char line[512];
	uint64_t kib = 0;
	unsigned long low = 0, high = 0;
	FILE *file = fopen("/proc/self/smaps", "r");
	while (file && fgets(line, sizeof line, file)) {
		if (sscanf(line, "%lx-%lx ", &low, &high) != 2 || low > (unsigned long)scene->pack->map
				|| high <= (unsigned long)scene->pack->map)
			continue;
		while (fgets(line, sizeof line, file) && sscanf(line, "Rss: %lu", &low) != 1)
			continue;
		kib = low;
		break;
	}
	if (file)
		fclose(file);
	return kib * 1024;
}

/* As when the system takes the pages for others. */
static void give_back(void)
{
	uint64_t size = scene->pack->map_size;
	assert_int_equal(madvise((void *)(uintptr_t)scene->pack->map, size, MADV_DONTNEED), 0);
	assert_int_equal(resident_bytes(), 0);
}

static struct eco_request request_of(double at, uint64_t vertices, double ground_px)
{
	struct eco_request r = { .vertices = vertices, .bytes = ECO_BYTES_UNBOUNDED, .ground_px = ground_px };
	r.view = (struct eco_view){ { at, at, 40 }, { at + 40, at + 20, 10 }, { 0, 0, 1 }, 50, 480, 320 };
	return r;
}

/* The hash of an answer to a client that holds nothing; *sent are its payloads. */
static uint64_t answer(const struct eco_request *request, uint64_t *sent, uint64_t *chunks)
{
	struct srv_stream_input input = { .scene = scene, .request = request };
	struct srv_stream stream;
	struct srv_body body;
	uint64_t hash = 14695981039346656037u;
	assert_int_equal(srv_stream_plan(&stream, &input, NULL), ECO_OK);
	assert_int_equal(srv_stream_write(&stream, &body, NULL), ECO_OK);
	for (uint32_t i = 0; i < body.piece_count; i++)
		for (size_t b = 0; b < body.pieces[i].size; b++)
			hash = (hash ^ ((const uint8_t *)body.pieces[i].bytes)[b]) * 1099511628211u;
	*sent = stream.chunk_bytes;
	*chunks = stream.chunk_count;
	srv_body_free(&body);
	srv_stream_free(&stream);
	return hash;
}

UNIT_TEST(only_what_is_asked_for_comes_into_memory)
{
	struct eco_request near = request_of(-20, 3000, 64);
	uint64_t sent, chunks;
	if (!opened_bytes)
		skip();                          /* no /proc that says so */
	assert_true(opened_bytes < scene->pack->map_size / 2);
	give_back();
	answer(&near, &sent, &chunks);
	uint64_t resident = resident_bytes(), pages = 2 * (uint64_t)sysconf(_SC_PAGESIZE);
	print_message("%llu of %zu bytes of the pack in memory for %llu bytes sent\n",
		(unsigned long long)resident,
		scene->pack->map_size, (unsigned long long)sent);
	assert_true(resident > 0 && resident >= sent / 2);
	assert_true(resident <= sent + chunks * (2 * AROUND_BYTES + pages));
	assert_true(resident < scene->pack->map_size / 2);
	/* the same again touches nothing new */
	answer(&near, &sent, &chunks);
	assert_int_equal(resident_bytes(), resident);
}

UNIT_TEST(answers_are_the_same_after_the_system_took_the_pages)
{
	for (int i = 0; i < 4; i++) {
		struct eco_request request = request_of(-30.0 * i, 20000, 4);
		uint64_t sent, chunks, before = answer(&request, &sent, &chunks);
		give_back();
		assert_true(answer(&request, &sent, &chunks) == before && sent > 0);
	}
}

/* Chunks have no copy on the heap, however often they are sent. */
UNIT_TEST(hot_chunks_take_no_memory_of_the_server)
{
	struct eco_request request = request_of(-20, 30000, 4);
	uint64_t sent, chunks;
	for (int i = 0; i < 4; i++)
		answer(&request, &sent, &chunks);
	struct mallinfo2 before = mallinfo2();
	for (int i = 0; i < 20; i++)
		answer(&request, &sent, &chunks);
	struct mallinfo2 after = mallinfo2();
	assert_true(after.uordblks + after.hblkhd <= before.uordblks + before.hblkhd + 4096);
}

int main(void)
{
	return unit_tests_run(open_pack, close_pack);
}
