/* The child process that reads files of strangers: what it may do, how its death is told, what is left
 * behind. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <sys/xattr.h>
#include <unistd.h>

#include "ecofiles/import/ground/ground.h"
#include "ecofiles/base/guard.h"
#include "ecofiles/base/memory.h"
#include "tests/support/input_files.h"
#include "tests/support/serve/http_client.h"
#include "tests/support/unit_test.h"

#if defined(__SANITIZE_ADDRESS__)
#define SANITIZED 1
#else
#define SANITIZED 0
#endif

/* ---- What children do ---- */

enum deed { ANSWER, FAIL, SEGFAULT, EXIT, ABORT, NULL_AFTER_FULL, SAY_NO_MEMORY, END_FOR_MEMORY, SPIN, SLEEP, DEAF, TOO_MUCH,
	KILLED, STOPPED, INTERRUPTED };

static enum eco_code fill_memory(bool crash, struct eco_error *error)
{
	for (;;) {
		uint8_t *block = malloc(64u << 20);
		if (!block && !crash)
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
	case END_FOR_MEMORY:
		eco_alloc(1u << 20, 1u << 20);
		break;
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

/* Either the processor's time runs out first or the clock's. */
static const struct eco_guard_limits small = { .memory_bytes = 256u << 20, .cpu_s = 1, .clock_s = 30 },
	brief = { .memory_bytes = 256u << 20, .cpu_s = 30, .clock_s = 1 };

static int descriptors(void)
{
	DIR *folder = opendir("/proc/self/fd");
	int count = 0;
	assert_non_null(folder);
	while (readdir(folder))
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

UNIT_TEST(each_way_to_die_is_told_in_its_own_words)
{
	static const struct { enum deed deed; enum eco_code code; const char *says; bool sanitized; } ends[] =
		{
		{ ANSWER, ECO_OK, "", true },
		{ FAIL, ECO_UNSUPPORTED, "as it was said", true },
		{ SEGFAULT, ECO_DAMAGED, "tree.obj: reading it ended with signal 11 (Segmentation fault)",
			true },
		{ EXIT, ECO_DAMAGED, "tree.obj: reading it ended with exit status 7", true },
		{ ABORT, ECO_DAMAGED, "tree.obj: reading it ended with signal 6", true },
		{ NULL_AFTER_FULL, ECO_TOO_LARGE, "tree.obj: reading it takes more than the 0.268 GB of "
			"memory it may have", false },
		{ SAY_NO_MEMORY, ECO_TOO_LARGE, "ECO_IMPORT_MEMORY_GB=2 allows more", false },
		{ END_FOR_MEMORY, ECO_TOO_LARGE, "tree.obj: reading it takes more than the 0.268 GB of "
			"memory it may have", false },
		{ SPIN, ECO_TOO_LARGE, "tree.obj: not read within 1 s of processor time; if the file is to "
			"be trusted, ECO_IMPORT_SECONDS=4", true },
		{ SLEEP, ECO_TOO_LARGE, "tree.obj: not read within 1 s;", true },
		{ DEAF, ECO_TOO_LARGE, "tree.obj: not read within 1 s;", true },
		{ STOPPED, ECO_TOO_LARGE, "tree.obj: not read within 1 s;", true },
		{ TOO_MUCH, ECO_TOO_LARGE, "tree.obj: it unpacks to more than 0.268 GB", false },
		{ KILLED, ECO_IO, "tree.obj: the process that read it was killed from outside", true },
		{ INTERRUPTED, ECO_INTERRUPTED, "tree.obj: interrupted", true },
	};
	int open_before = descriptors();
	for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
		struct eco_error error = { .code = ECO_OK };
		enum deed deed = ends[i].deed;
		char text[16] = "";
		FILE *result;
		if (SANITIZED && !ends[i].sanitized)
			continue;
		assert_int_equal(eco_guard_run(misbehave, &deed, "tree.obj", deed == SLEEP || deed == DEAF
			|| deed == STOPPED ? &brief : &small, &result, &error), ends[i].code);
		if (!strstr(error.text, ends[i].says))
			fail_msg("\"%s\" does not say \"%s\"", error.text, ends[i].says);
		assert_int_equal(result != NULL, deed == ANSWER);
		if (result) {
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

UNIT_TEST(a_stream_arrives_whole_and_so_does_its_end)
{
	static const struct { struct writing what; enum eco_code code; } streams[] = {
		{ { 0, ECO_OK, false }, ECO_OK }, { { 1, ECO_OK, false }, ECO_OK },
			{ { 3000000, ECO_OK, false }, ECO_OK },
		{ { 100000, ECO_BAD_INPUT, false }, ECO_BAD_INPUT }, { { 70000, ECO_OK, true }, ECO_DAMAGED },
	};
	int open_before = descriptors();
	for (size_t i = 0; i < sizeof streams / sizeof *streams; i++) {
		struct writing what = streams[i].what;
		struct eco_guard *guard;
		uint32_t number, count = 0;
		FILE *stream;
		assert_good(eco_guard_start(&guard, write_numbers, &what, "stems.csv", NULL, &stream,
			&cause));
		for (; fread(&number, sizeof number, 1, stream) == 1; count++)
			if (number != count)
				fail_msg("number %u is %u", count, number);
		assert_int_equal(count, what.count);
		assert_code(eco_guard_finish(guard, &cause), streams[i].code, "");
		nothing_is_left(open_before);
	}
}

UNIT_TEST(a_stream_that_stays_silent_ends_by_the_clock)
{
	static const enum deed deeds[] = { SLEEP, DEAF };
	int open_before = descriptors();
	for (size_t i = 0; i < sizeof deeds / sizeof *deeds; i++) {
		enum deed deed = deeds[i];
		struct eco_guard *guard;
		FILE *stream;
		assert_good(eco_guard_start(&guard, misbehave, &deed, "stems.csv", &brief, &stream,
			&cause));
		assert_int_equal(fgetc(stream), EOF);
		assert_code(eco_guard_finish(guard, &cause), ECO_TOO_LARGE, "stems.csv: not read within 1 s");
		nothing_is_left(open_before);
	}
}

/* ---- What a child may do ---- */

enum attempt { READ_FILE, USE_THREAD, USE_MEMORY, RAISE_ITSELF, ASK_LIMIT, LOOK_AROUND, SOCKET, WRITE_FILE,
	CREATE_FILE, APPEND_FILE, TRUNCATE_FILE, MAKE_FOLDER, REMOVE_FILE, RENAME_FILE, LINK_FILE, OPEN_MODE,
	OPEN_FILE_MODE, OPEN_FILE_OWNER, OPEN_FILE_NOTE, TYPE, NEW_MOUNT,
	EXEC, FORK, KILL_PARENT, KILL_GROUP, RAISE_LIMIT, PARENTS_FILE, ATTEMPTS };

struct trial { enum attempt attempt; int parents_file; bool worked; bool filtered; };

static void *nothing(void *ctx) { return ctx; }

static bool open_for(const char *path, int flags)
{
	int file = open(path, flags, 0666);
	if (file >= 0)
		close(file);
	return file >= 0;
}

/* Whether it worked: nothing here does harm if it does. */
static bool attempt(const struct trial *t)
{
	static const char *const file = "build/tmp/guard-file", *const other = "build/tmp/guard-other";
	struct rlimit core = { 0 };
	pthread_t thread;
	pid_t pid;
	switch (t->attempt) {
	case READ_FILE:
		return open_for(file, O_RDONLY | O_CLOEXEC);
	case USE_THREAD:
		return pthread_create(&thread, NULL, nothing, NULL) == 0 && pthread_join(thread, NULL) == 0;
	case USE_MEMORY:
		free(malloc(32u << 20));
		return true;
	case RAISE_ITSELF:
		signal(SIGUSR1, SIG_IGN);
		return raise(SIGUSR1) == 0 && kill(getpid(), SIGUSR1) == 0;
	case ASK_LIMIT:
		return getrlimit(RLIMIT_NOFILE, &core) == 0;
	case LOOK_AROUND:
		return access(file, R_OK) == 0 && access("build/tmp", R_OK) == 0;
	case SOCKET:
		return socket(AF_INET, SOCK_STREAM, 0) >= 0 || socket(AF_UNIX, SOCK_STREAM, 0) >= 0;
	case WRITE_FILE:
		return open_for(file, O_WRONLY) || open_for(file, O_RDWR);
	case CREATE_FILE:
		return open_for(other, O_RDONLY | O_CREAT) || fopen(other, "w");
	case APPEND_FILE:
		return fopen(file, "a");
	case TRUNCATE_FILE:
		return open_for(file, O_RDONLY | O_TRUNC) || truncate(file, 0) == 0;
	case MAKE_FOLDER:
		return mkdir(other, 0777) == 0;
	case REMOVE_FILE:
		return unlink(file) == 0;
	case RENAME_FILE:
		return rename(file, other) == 0;
	case LINK_FILE:
		return symlink(file, other) == 0 || link(file, other) == 0;
	case OPEN_MODE:
		return chmod(file, 0600) == 0;
	case OPEN_FILE_MODE:             /* 452: fchmodat2, which knows no name here */
		return fchmod(open(file, O_RDONLY), 0600) == 0 || syscall(452, AT_FDCWD, file, 0600, 0) == 0;
	case OPEN_FILE_OWNER:
		return fchown(open(file, O_RDONLY), getuid(), getgid()) == 0;
	case OPEN_FILE_NOTE:
		return fsetxattr(open(file, O_RDONLY), "user.note", "x", 1, 0) == 0;
	case TYPE:                       /* no terminal is another error than no permission */
		return (ioctl(STDIN_FILENO, TIOCSTI, "x") == 0 || errno != EPERM) &&
			(syscall(SYS_ioctl, STDIN_FILENO, 1ull << 32 | TIOCSTI, "x") == 0 || errno != EPERM);
	case NEW_MOUNT:
		return syscall(SYS_fsopen, "tmpfs", 0) >= 0 || syscall(SYS_open_tree, AT_FDCWD, "/", 0) >= 0;
	case EXEC:
		execl("/bin/true", "true", (char *)NULL);
		return false;
	case FORK:
		pid = fork();
		if (pid == 0)
			_exit(0);
		return pid > 0;
	case KILL_PARENT:
		return kill(getppid(), 0) == 0;
	case KILL_GROUP:
		return kill(0, 0) == 0;
	case RAISE_LIMIT:
		return setrlimit(RLIMIT_CORE, &core) == 0;
	case PARENTS_FILE:
		return fcntl(t->parents_file, F_GETFD) >= 0;
	default:
		return false;
	}
}

static enum eco_code try_it(void *ctx, FILE *out, struct eco_error *error)
{
	struct trial trial = *(struct trial *)ctx;
	trial.worked = attempt(&trial);
	trial.filtered = !open_for("/dev/null", O_WRONLY);
	return fwrite(&trial, sizeof trial, 1, out) == 1 ? ECO_OK : eco_fail(error, ECO_IO, "no result");
}

UNIT_TEST(a_child_reads_and_does_nothing_else)
{
	int parents_file, result_file;
	mkdir("build/tmp", 0777);
	result_file = open("build/tmp/guard-file", O_RDWR | O_CREAT | O_TRUNC, 0644);
	assert_true(result_file >= 0 && write(result_file, "kept", 4) == 4);
	parents_file = fcntl(result_file, F_DUPFD, 100);
	unlink("build/tmp/guard-other");
	for (enum attempt a = 0; a < ATTEMPTS; a++) {
		struct trial trial = { .attempt = a, .parents_file = parents_file };
		struct eco_error error = { .code = ECO_OK };
		struct stat file;
		FILE *result;
		if (eco_guard_run(try_it, &trial, "attempt", NULL, &result, &error) != ECO_OK)
			fail_msg("attempt %d: %s", (int)a, error.text);
		assert_int_equal(fread(&trial, sizeof trial, 1, result), 1);
		fclose(result);
		if (a >= SOCKET && a != PARENTS_FILE && !trial.filtered)
			skip();                  /* no filters here: then limits are all there is */
		if (trial.worked != (a < SOCKET))
			fail_msg("attempt %d %s", (int)a, trial.worked ? "worked" : "did not work");
		assert_int_equal(access("build/tmp/guard-other", F_OK), -1);
		assert_int_equal(stat("build/tmp/guard-file", &file), 0);
		assert_int_equal(file.st_size, 4);
		assert_int_equal(file.st_mode & 0777, 0644);
	}
	close(parents_file);
	close(result_file);
}

/* ---- Files that name others ---- */

#define MOSAIC "<VRTDataset rasterXSize=\"3\" rasterYSize=\"2\"><GeoTransform>0, 10, 0, 20, 0, " \
	"-10</GeoTransform>" \
	"<VRTRasterBand dataType=\"Float32\" band=\"1\"><SimpleSource><SourceFilename " \
	"relativeToVRT=\"0\">%s</SourceFilename>" \
	"<SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>"
#define TILED "<GDAL_WMS><Service " \
	"name=\"TMS\"><ServerUrl>%s/${z}/${x}/${y}.png</ServerUrl></Service><DataWindow><UpperLeftX>" \
	"-10</UpperLeftX>" \
	"<UpperLeftY>10</UpperLeftY><LowerRightX>10</LowerRightX><LowerRightY>-10</LowerRightY><TileLevel>" \
	"1</TileLevel></DataWindow>" \
	"<BandsCount>1</BandsCount></GDAL_WMS>"

static enum eco_code import_text(const char *name, const char *format, const char *within,
struct eco_ground *ground, struct eco_error *error)
{
	char text[4096], *path;
	snprintf(text, sizeof text, format, within);
	path = (char *)input_text("guard", name, text);
	return eco_ground_import(ground,
		&(struct eco_ground_options){ .source = &(struct eco_ground_source){ .heights = &path,
		.height_count = 1 } }, error);
}

/* With a server that would hear them. */
UNIT_TEST(files_that_name_servers_reach_nobody)
{
	static const struct { const char *name, *format, *within; } files[] = {
		{ "mosaic.vrt", MOSAIC, "/vsicurl/http://127.0.0.1:%u/dem.tif" },
			{ "stream.vrt", MOSAIC, "/vsicurl_streaming/http://127.0.0.1:%u/dem.tif" },
		{ "packed.vrt", MOSAIC, "/vsizip//vsicurl/http://127.0.0.1:%u/dem.zip" },
		{ "http.vrt", MOSAIC, "http://127.0.0.1:%u/dem.tif" },
		{ "tiles.xml", TILED, "http://127.0.0.1:%u" } };
	uint16_t port;
	int server = http_listen(&port);
	struct pollfd heard = { .fd = server, .events = POLLIN };
	for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
		struct eco_error error = { .code = ECO_OK };
		struct eco_ground ground;
		char within[256];
		snprintf(within, sizeof within, files[i].within, port);
		if (import_text(files[i].name, files[i].format, within, &ground, &error) == ECO_OK)
			fail_msg("%s was read", files[i].name);
		assert_non_null(strstr(error.text, files[i].name));
		if (poll(&heard, 1, 0) != 0)
			fail_msg("%s made a connection", files[i].name);
	}
	close(server);
}

/* Textures and mosaics lie where they lie: whatever the user may read is read. */
UNIT_TEST(files_that_name_other_folders_are_read)
{
	char elsewhere[PATH_MAX];
	struct eco_ground ground;
	assert_non_null(realpath(input_text("guard-elsewhere", "dem.asc",
		"ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2 3\n4 5 6\n"), elsewhere));
	assert_good(import_text("far.vrt", MOSAIC, elsewhere, &ground, &cause));
	assert_int_equal(ground.columns, 3);
	eco_ground_free(&ground);
}

/* ---- Interruptions ---- */

static void *interrupt_soon(void *ctx)
{
	usleep(100000);
	eco_guard_interrupt();
	return NULL;
}

UNIT_TEST(an_interrupted_parent_ends_its_children)
{
	int open_before = descriptors();
	for (int streams = 0; streams < 2; streams++) {
		struct eco_error error = { .code = ECO_OK };
		enum deed deed = SLEEP;
		pthread_t thread;
		FILE *stream;
		assert_int_equal(pthread_create(&thread, NULL, interrupt_soon, NULL), 0);
		if (streams) {
			struct eco_guard *guard;
			assert_int_equal(eco_guard_start(&guard, misbehave, &deed, "tree.obj", NULL, &stream,
				&error), ECO_OK);
			assert_int_equal(fgetc(stream), EOF);
			assert_int_equal(eco_guard_finish(guard, &error), ECO_INTERRUPTED);
		} else
			assert_int_equal(eco_guard_run(misbehave, &deed, "tree.obj", NULL, &stream, &error),
				ECO_INTERRUPTED);
		assert_string_equal(error.text, "tree.obj: interrupted");
		pthread_join(thread, NULL);
		nothing_is_left(open_before);
	}
}

static enum eco_code tell_and_sleep(void *ctx, FILE *out, struct eco_error *error)
{
	pid_t self = getpid();
	fwrite(&self, sizeof self, 1, out);
	fflush(out);
	sleep(1000);
	return ECO_OK;
}

UNIT_TEST(a_parent_that_dies_takes_its_child_along)
{
	int told[2];
	pid_t parent, child = 0;
	assert_int_equal(pipe(told), 0);
	parent = fork();
	if (parent == 0) {
		struct eco_guard *guard;
		FILE *stream;
		if (eco_guard_start(&guard, tell_and_sleep, NULL, "tree.obj", NULL, &stream, NULL) != ECO_OK
			|| fread(&child, sizeof child, 1, stream) != 1 || write(told[1], &child, sizeof child)
			!= sizeof child)
			_exit(1);
		raise(SIGKILL);
	}
	assert_int_equal(read(told[0], &child, sizeof child), sizeof child);
	waitpid(parent, NULL, 0);
	for (int i = 0; i < 500 && kill(child, 0) == 0; i++) {
		char path[64], text[256] = "";
		FILE *stat_file;
		snprintf(path, sizeof path, "/proc/%d/stat", (int)child);
		stat_file = fopen(path, "r");
		if (stat_file && fread(text, 1, sizeof text - 1, stat_file) > 0 && strstr(text, ") Z")
				!= NULL) {
			fclose(stat_file);
			break;               /* dead, and whoever adopted it has not looked yet */
		}
		if (stat_file)
			fclose(stat_file);
		usleep(10000);
		assert_true(i < 499);
	}
	close(told[0]);
	close(told[1]);
}

/* ---- Limits ---- */

UNIT_TEST(the_environment_has_the_last_word_on_limits)
{
	struct eco_guard_limits generous = { .memory_bytes = 8ull << 30, .cpu_s = 600, .clock_s = 600 };
	enum deed deed = SPIN;
	FILE *result;
	setenv(ECO_GUARD_SECONDS_VARIABLE, "1", 1);
	assert_code(eco_guard_run(misbehave, &deed, "tree.obj", &generous, &result, &cause), ECO_TOO_LARGE,
		"ECO_IMPORT_SECONDS=4 allows more");
	unsetenv(ECO_GUARD_SECONDS_VARIABLE);
	if (SANITIZED)
		return;
	setenv(ECO_GUARD_MEMORY_VARIABLE, "0.25", 1);
	deed = SAY_NO_MEMORY;
	assert_code(eco_guard_run(misbehave, &deed, "tree.obj", &generous, &result, &cause), ECO_TOO_LARGE,
		"more than the 0.25 GB of memory");
	unsetenv(ECO_GUARD_MEMORY_VARIABLE);
}

UNIT_TEST(packed_files_are_known_by_their_first_bytes)
{
	static const struct { const char *bytes; size_t size; bool unpacks; } files[] = {
		{ "PK\3\4", 4, true }, { "SQLite format 3\0more", 20, true },
			{ "SQLite format 3", 15, false },
		{ "PK\3", 3, false }, { "x,y\n", 4, false }, { "", 0, false } };
	const char *path = input_path("guard", "head");
	for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
		file_write(path, files[i].bytes, files[i].size);
		assert_int_equal(eco_guard_unpacks(path), files[i].unpacks);
		assert_int_equal(eco_guard_small_memory(&path, 1), (1ull << 30) + 64 * files[i].size);
	}
	remove(path);
	assert_false(eco_guard_unpacks(path) || eco_guard_unpacks("."));
	assert_int_equal(eco_guard_small_memory(&path, 1), 1ull << 30);
}
