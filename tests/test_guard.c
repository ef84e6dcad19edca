/* The child process that reads files of strangers: what it may do, how its death is told, what is left behind. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ecofiles/guard.h"
#include "ecofiles/guard_filter.h"

#if defined(__SANITIZE_ADDRESS__)
#define SANITIZED 1
#else
#define SANITIZED 0
#endif

/* ---- What children do ---- */

enum deed { ANSWER, FAIL, SEGFAULT, EXIT, ABORT, NULL_AFTER_FULL, SAY_NO_MEMORY, SPIN, SLEEP, DEAF, TOO_MUCH, KILLED, STOPPED, INTERRUPTED };

static enum eco_code fill_memory(bool crash, struct eco_error *error)
{
	for (;;) {
		uint8_t *block = malloc(64u << 20);

		if (block == NULL && !crash)
			return eco_fail(error, ECO_NO_MEMORY, "out of memory");
		*(volatile uint8_t *)block = 1;
	}
}

static void spin(void)
{
	volatile uint64_t turns = 0;

	for (;;)
		turns++;
}

static enum eco_code misbehave(void *ctx, FILE *out, struct eco_error *error)
{
	static char block[1u << 20];

	switch (*(const enum deed *)ctx) {
	case ANSWER:
		return fputs("result", out) >= 0 ? ECO_OK : ECO_IO;
	case FAIL:
		return eco_fail(error, ECO_UNSUPPORTED, "as it was said");
	case SEGFAULT:
		signal(SIGSEGV, SIG_DFL);
		raise(SIGSEGV);
		break;
	case EXIT:
		_exit(7);
	case ABORT:
		abort();
	case NULL_AFTER_FULL:
		return fill_memory(true, error);
	case SAY_NO_MEMORY:
		return fill_memory(false, error);
	case SPIN:
		spin();
		break;
	case SLEEP:
		sleep(1000);
		break;
	case DEAF:
		signal(SIGXCPU, SIG_IGN);
		signal(SIGALRM, SIG_IGN);
		signal(SIGTERM, SIG_IGN);
		fclose(out);
		spin();
		break;
	case TOO_MUCH:
		while (fwrite(block, sizeof block, 1, out) == 1)
			;
		break;
	case KILLED:
		raise(SIGKILL);
		break;
	case STOPPED:
		raise(SIGSTOP);
		break;
	case INTERRUPTED:
		raise(SIGINT);
		break;
	}
	return ECO_OK;
}

static const struct eco_guard_limits small = { .memory_bytes = 256u << 20, .cpu_s = 1, .clock_s = 2 };

static int descriptors(void)
{
	DIR *folder = opendir("/proc/self/fd");
	int count = 0;

	assert_non_null(folder);
	while (readdir(folder) != NULL)
		count++;
	closedir(folder);
	return count;
}

static void nothing_is_left(int open_before)
{
	assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
	assert_int_equal(errno, ECHILD);
	assert_int_equal(descriptors(), open_before);
}

/* ---- The ways to end ---- */

static void each_way_to_die_is_told_in_its_own_words(void **state)
{
	static const struct { enum deed deed; enum eco_code code; const char *says; bool sanitized; } ends[] = {
		{ ANSWER, ECO_OK, "", true },
		{ FAIL, ECO_UNSUPPORTED, "as it was said", true },
		{ SEGFAULT, ECO_DAMAGED, "tree.obj: reading it ended with signal 11 (Segmentation fault)", true },
		{ EXIT, ECO_DAMAGED, "tree.obj: reading it ended with exit status 7", true },
		{ ABORT, ECO_DAMAGED, "tree.obj: reading it ended with signal 6", true },
		{ NULL_AFTER_FULL, ECO_TOO_LARGE, "tree.obj: reading it takes more than the 0.268 GB of memory it may have", false },
		{ SAY_NO_MEMORY, ECO_TOO_LARGE, "ECO_IMPORT_MEMORY_GB=2 allows more", false },
		{ SPIN, ECO_TOO_LARGE, "tree.obj: not read within 1 s of processor time; if the file is to be trusted, ECO_IMPORT_SECONDS=4", true },
		{ SLEEP, ECO_TOO_LARGE, "tree.obj: not read within 2 s;", true },
		{ DEAF, ECO_TOO_LARGE, "tree.obj: not read within 2 s;", true },
		{ STOPPED, ECO_TOO_LARGE, "tree.obj: not read within 2 s;", true },
		{ TOO_MUCH, ECO_TOO_LARGE, "tree.obj: it unpacks to more than 0.268 GB", false },
		{ KILLED, ECO_IO, "tree.obj: the process that read it was killed from outside", true },
		{ INTERRUPTED, ECO_INTERRUPTED, "tree.obj: interrupted", true },
	};
	int open_before = descriptors();

	(void)state;
	for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
		struct eco_error error = { .code = ECO_OK };
		enum deed deed = ends[i].deed;
		char text[16] = "";
		FILE *result;

		if (SANITIZED && !ends[i].sanitized)
			continue;
		assert_int_equal(eco_guard_run(misbehave, &deed, "tree.obj", &small, &result, &error), ends[i].code);
		if (strstr(error.text, ends[i].says) == NULL)
			fail_msg("\"%s\" does not say \"%s\"", error.text, ends[i].says);
		assert_int_equal(result != NULL, deed == ANSWER);
		if (result != NULL) {
			assert_int_equal(fread(text, 1, sizeof text - 1, result), 6);
			assert_string_equal(text, "result");
			fclose(result);
		}
		nothing_is_left(open_before);
	}
}

/* ---- Streams ---- */

struct writing { uint32_t count; enum eco_code code; bool crash; };

static enum eco_code write_numbers(void *ctx, FILE *out, struct eco_error *error)
{
	const struct writing *w = ctx;

	for (uint32_t i = 0; i < w->count; i++)
		if (fwrite(&i, sizeof i, 1, out) != 1)
			return eco_fail(error, ECO_IO, "nobody reads");
	fflush(out);
	if (w->crash)
		abort();
	return w->code == ECO_OK ? ECO_OK : eco_fail(error, w->code, "after %u numbers", w->count);
}

static void a_stream_arrives_whole_and_so_does_its_end(void **state)
{
	static const struct { struct writing what; enum eco_code code; } streams[] = {
		{ { 0, ECO_OK, false }, ECO_OK }, { { 1, ECO_OK, false }, ECO_OK }, { { 3000000, ECO_OK, false }, ECO_OK },
		{ { 100000, ECO_BAD_INPUT, false }, ECO_BAD_INPUT }, { { 70000, ECO_OK, true }, ECO_DAMAGED },
	};
	int open_before = descriptors();

	(void)state;
	for (size_t i = 0; i < sizeof streams / sizeof *streams; i++) {
		struct writing what = streams[i].what;
		struct eco_error error = { .code = ECO_OK };
		struct eco_guard *guard;
		uint32_t number, count = 0;
		FILE *stream;

		assert_int_equal(eco_guard_start(&guard, write_numbers, &what, "stems.csv", NULL, &stream, &error), ECO_OK);
		for (; fread(&number, sizeof number, 1, stream) == 1; count++)
			if (number != count)
				fail_msg("number %u is %u", count, number);
		assert_int_equal(count, what.count);
		assert_int_equal(eco_guard_finish(guard, &error), streams[i].code);
		nothing_is_left(open_before);
	}
}

static void who_stops_reading_ends_the_child_without_an_error(void **state)
{
	int open_before = descriptors();

	(void)state;
	for (uint32_t wanted = 0; wanted < 3; wanted++) {
		struct writing what = { .count = UINT32_MAX };
		struct eco_error error = { .code = ECO_OK };
		struct eco_guard *guard;
		uint32_t number;
		FILE *stream;

		assert_int_equal(eco_guard_start(&guard, write_numbers, &what, "stems.csv", NULL, &stream, &error), ECO_OK);
		for (uint32_t i = 0; i < wanted; i++)
			assert_int_equal(fread(&number, sizeof number, 1, stream), 1);
		assert_int_equal(eco_guard_finish(guard, &error), ECO_OK);
		assert_int_equal(error.code, ECO_OK);
		nothing_is_left(open_before);
	}
	assert_int_equal(eco_guard_finish(NULL, NULL), ECO_OK);
}

static void a_stream_that_stays_silent_ends_by_the_clock(void **state)
{
	static const enum deed deeds[] = { SLEEP, STOPPED, DEAF };
	int open_before = descriptors();

	(void)state;
	for (size_t i = 0; i < sizeof deeds / sizeof *deeds; i++) {
		struct eco_guard_limits limits = { .cpu_s = 60, .clock_s = 1 };
		struct eco_error error = { .code = ECO_OK };
		enum deed deed = deeds[i];
		struct eco_guard *guard;
		FILE *stream;

		assert_int_equal(eco_guard_start(&guard, misbehave, &deed, "stems.csv", &limits, &stream, &error), ECO_OK);
		assert_int_equal(fgetc(stream), EOF);
		assert_int_equal(eco_guard_finish(guard, &error), ECO_TOO_LARGE);
		assert_non_null(strstr(error.text, "stems.csv: not read within 1 s"));
		nothing_is_left(open_before);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(each_way_to_die_is_told_in_its_own_words),
		cmocka_unit_test(a_stream_arrives_whole_and_so_does_its_end),
		cmocka_unit_test(who_stops_reading_ends_the_child_without_an_error),
		cmocka_unit_test(a_stream_that_stays_silent_ends_by_the_clock),
	};

	return cmocka_run_group_tests_name("guard", tests, NULL, NULL);
}
