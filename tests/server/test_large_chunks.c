/* Large chunks, which are sent from their pack's private copy: they are what the pack has, whole and in
 * parts, and their descriptors go. */
#include <dirent.h>
#include <stdio.h>

#include "tests/support/files.h"
#include "tests/support/serve/serve_daemon.h"

static const uint32_t sizes[] = { 400, (128 << 10) - 1, 128 << 10, 400000 };
#define SIZES 4u

static uint32_t descriptors(void)
{
	uint32_t count = 0;
	DIR *folder = opendir("/proc/self/fd");
	while (folder && readdir(folder))
		count++;
	if (folder)
		closedir(folder);
	return count;
}

static void check_chunk(int fd, const struct eco_pack *pack, uint32_t chunk, const char *more, unsigned
	status, size_t from, size_t size)
{
	char request[512];
	int length = snprintf(request, sizeof request, "GET " BASE "/chunks/%s HTTP/1.1\r\n" HOST "%s\r\n",
		eco_id_text(pack->scene.chunks[chunk].id.bytes).hex, more);
	assert_true(http_send(fd, request, (size_t)length));
	struct http_answer answer = http_receive(fd, false, false);
	assert_true(answer.status == status && answer.size == size);
	assert_memory_equal(answer.body, pack->map + pack->scene.chunks[chunk].offset + from, size);
	http_free(&answer);
}

/* Several connections, so that each thread of the library sends some. */
static void check_all(const struct eco_pack *pack)
{
	for (int i = 0; i < 3; i++) {
		int fd = http_connect(port);
		uint32_t first = pack->scene.lists[SAMPLE_TEXTURE].chunk_first;
		for (uint32_t c = 0; c < SIZES; c++) {
			assert_int_equal(pack->scene.chunks[first + c].size_bytes, sizes[c]);
			check_chunk(fd, pack, first + c, "", 200, 0, sizes[c]);
			check_chunk(fd, pack, first + c, "Range: bytes=100-299\r\n", 206, 100, 200);
		}
		check_chunk(fd, pack, first + 3, "Range: bytes=7-\r\n", 206, 7, sizes[3] - 7);
		close(fd);
	}
}

UNIT_TEST(large_chunks_come_from_the_copy_or_the_map)
{
	static const char path[] = "build/tmp/large_chunks.eco";
	uint32_t before = descriptors();
	folder_make("build/tmp");
	for (int copied = 0; copied < 2; copied++) {
		struct srv_store packs = { .copies = copied ? "build/tmp" : NULL };
		assert_good(sample_pack_write_textured(path, sizes, SIZES, &cause));
		assert_good(srv_store_add(&packs, "sample", path, &cause));
		assert_good(srv_daemon_start(&daemon_, &(struct srv_config){ .listen = "127.0.0.1:0" },
			&packs, &cause));
		port = srv_daemon_port(daemon_);
		assert_int_equal(packs.scenes[0]->pack->file >= 0, copied);
		unlink(path);                    /* nobody else's file is needed */
		check_all(packs.scenes[0]->pack);
		srv_daemon_stop(daemon_);
		srv_store_free(&packs);
		assert_int_equal(descriptors(), before);
	}
}
