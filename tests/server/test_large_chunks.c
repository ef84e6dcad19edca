/* Large chunks, which are sent from their pack's private copy: they are what the pack has, on any connection,
 * whole and in parts, also once their scene has been replaced and freed, and however many there are. */
#include <dirent.h>
#include <stdio.h>

#include "tests/support/files.h"
#include "tests/support/serve/serve_daemon.h"

static const uint32_t sizes[] = { 400, (128 << 10) - 1, 128 << 10, 400000 };
#define SIZES 4u

static struct srv_store packs;
static char path[64];

static int start(const char *copies)
{
	struct eco_error error = { 0 };
	folder_make("build/tmp");
	snprintf(path, sizeof path, "build/tmp/large-%d.eco", (int)getpid());
	srv_store_init(&packs);
	packs.copies = copies;
	if (texture_pack_write(path, sizes, SIZES, &error) || srv_store_add(&packs, "sample", path, &error)
			|| srv_daemon_start(&daemon_, &(struct srv_config){ .listen = "127.0.0.1:0" }, &packs,
			&error))
		fail_msg("%s", error.text);
	port = srv_daemon_port(daemon_);
	return 0;
}

static int start_copied(void **state) { return start("build/tmp"); }
static int start_in_place(void **state) { return start(NULL); }

static int stop(void **state)
{
	srv_daemon_stop(daemon_);
	srv_store_free(&packs);
	unlink(path);
	return 0;
}

static const struct eco_pack *pack(void) { return packs.scenes[0]->pack; }

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

static void check_chunk(int fd, uint32_t chunk, const char *more, unsigned status, size_t from, size_t size)
{
	char request[512], id[SRV_ID_TEXT_BYTES];
	srv_format_id(id, &pack()->scene.chunks[chunk].id);
	int length = snprintf(request, sizeof request, "GET " BASE "/chunks/%s HTTP/1.1\r\n" HOST "%s\r\n",
		id, more);
	assert_true(http_send(fd, request, (size_t)length));
	struct http_answer answer = http_receive(fd, false, false);
	assert_int_equal(answer.status, status);
	assert_int_equal(answer.size, size);
	assert_memory_equal(answer.body, pack()->map + pack()->scene.chunks[chunk].offset + from, size);
	http_free(&answer);
}

/* Several connections, so that each thread of the library sends some; twice, as responses are made once.
 */
static void check_all(void)
{
	int fds[6];
	for (int i = 0; i < 6; i++)
		fds[i] = http_connect(port);
	for (int round = 0; round < 2; round++)
		for (uint32_t c = 0; c < SIZES; c++) {
			uint32_t size = pack()->scene.chunks[c].size_bytes;
			assert_int_equal(size, sizes[c]);
			for (int i = 0; i < 6; i++)
				check_chunk(fds[i], c, "", 200, 0, size);
			check_chunk(fds[round], c, "Range: bytes=100-299\r\n", 206, 100, 200);
		}
	for (int i = 0; i < 6; i++)
		close(fds[i]);
}

UNIT_TEST_BETWEEN(large_chunks_come_from_the_copy, start_copied, stop)
{
	assert_true(pack()->file >= 0);
	check_all();
	unlink(path);                            /* nobody else's file is needed */
	check_all();
}

UNIT_TEST_BETWEEN(large_chunks_come_from_the_map_of_a_pack_in_place, start_in_place, stop)
{
	assert_int_equal(pack()->file, -1);
	check_all();
}

UNIT_TEST(descriptors_go_with_the_scene)
{
	uint32_t before = descriptors();
	for (int i = 0; i < 3; i++) {
		start("build/tmp");
		check_all();
		stop(NULL);
		assert_int_equal(descriptors(), before);
	}
}

int main(void)
{
	return unit_tests_run(NULL, NULL);
}
