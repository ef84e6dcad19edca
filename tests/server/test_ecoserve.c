/* The program: what it prints, how it ends, what it links. Skipped where it has not been built.
 * Longer than 600 lines: all tests share the ways to start it. */
#include <fcntl.h>
#include <jansson.h>
#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/base/version.h"
#include "tests/support/files.h"
#include "tests/support/serve/http_client.h"
#include "tests/support/scene_packs.h"
#include "tests/support/serve/serve_program.h"
#include "tests/support/unit_test.h"

#define PACK_PATH "build/tmp/test_ecoserve.eco"
#define CUT_PATH "build/tmp/test_ecoserve_cut.eco"
#define DAMAGED_PATH "build/tmp/test_ecoserve_damaged.eco"
#define LATE_PATH "build/tmp/test_ecoserve_late/late.eco"
#define DEEP_PATH "build/tmp/test_ecoserve_deep.eco"

static int prepare(void **state)
{
	struct eco_error error = { 0 };
	program_find();
	folder_make("build/tmp");
	if (sample_pack_write(PACK_PATH, &error)) {
		fprintf(stderr, "%s\n", error.text);
		return 1;
	}
	FILE *from = fopen(PACK_PATH, "rb"), *to = fopen(DAMAGED_PATH, "wb");
	for (int c, at = 0; from && to && (c = getc(from)) != EOF; at++)
		putc(at == 100 ? c ^ 1 : c, to);
	return !from || !to || fclose(from) || fclose(to);
}

UNIT_TEST(arguments_are_checked_and_errors_help)
{
	static const struct { const char *arguments[6]; int status; const char *out, *err; } rows[] = {
		{ { "--version" }, 0, "ecoserve " ECO_VERSION "\n", "" },
			{ { "--help" }, 0, "usage: ecoserve", "" },
		{ { NULL }, 2, "", "a pack is missing" }, { { "--nonsense" }, 2, "", "--help" },
		{ { "--listen" }, 2, "", "--help" },
		{ { "--listen", "nowhere", PACK_PATH }, 2, "", "HOST:PORT" },
		{ { "--trust-proxy", "10.0.0.0/40", PACK_PATH }, 2, "", "'10.0.0.0/40' is not an address" },
		{ { "--connections", "0", PACK_PATH }, 2, "", "--help" },
		{ { "Bad=" PACK_PATH }, 2, "", "cannot name a scene" },
		{ { "a=" PACK_PATH, "a=" PACK_PATH }, 2, "", "two scenes are named 'a'" },
		{ { PACK_PATH, PACK_PATH }, 2, "", "two scenes are named 'sample'" },
		{ { "build/tmp/none.eco" }, 1, "", "build/tmp/none.eco" },
		{ { DAMAGED_PATH }, 1, "", DAMAGED_PATH },
		{ { "--copies", "build/tmp/no such folder", PACK_PATH }, 1, "",
			"build/tmp/no such folder: No such file or directory: make room there, name another folder "
			"(--copies DIR)" },
	};
	char out[8192], err[8192];
	if (!program_path[0])
		skip();
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct program process = program_start(rows[i].arguments);
		assert_int_equal(program_finish(&process, out, err), rows[i].status);
		if (strncmp(out, rows[i].out, strlen(rows[i].out)) != 0 || !strstr(err, rows[i].err)
				|| (rows[i].status && out[0]))
			fail_msg("row %zu:\n%s\n%s", i, out, err);
	}
}

UNIT_TEST(it_says_when_it_is_ready_and_ends_when_asked)
{
	static const char *const arguments[] = { "--listen", "127.0.0.1:0", "--log", "text", "a="
		PACK_PATH, "b=" PACK_PATH, NULL };
	char line[256], expected[256], out[8192], err[8192];
	if (!program_path[0])
		skip();
	for (int which = 0; which < 2; which++) {
		struct program process = program_start(arguments);
		uint16_t port = program_ready(&process, line);
		snprintf(expected, sizeof expected, "ecoserve: ready on http://127.0.0.1:%u (2 scenes named "
			"a, b)", port);
		assert_int_equal(strncmp(line, expected, strlen(expected)), 0);
		struct http_answer answer = http_get(port, "/v1/scenes/b");
		assert_int_equal(answer.status, 200);
		http_free(&answer);
		const int harmless[] = { SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGIO, SIGPWR, SIGXFSZ, SIGRTMIN,
			SIGRTMAX, SIGWINCH, SIGPIPE };
		for (size_t i = 0; i < sizeof harmless / sizeof *harmless; i++)
			kill(process.pid, harmless[i]);
		kill(process.pid, SIGHUP);       /* a terminal that is closed ends no server */
		answer = http_get(port, "/v1/scenes/a");
		assert_int_equal(answer.status, 200);
		http_free(&answer);
		kill(process.pid, which ? SIGINT : SIGTERM);
		assert_int_equal(program_finish(&process, out, err), 0);
		assert_string_equal(out, "");
		assert_non_null(strstr(err, "127.0.0.1 GET /v1/scenes/b 200"));
		assert_non_null(strstr(err, "reload: 0 scenes opened, 2 as they were, 0 gone"));
	}
}

/* A copy of the program has no viewer beside it. */
UNIT_TEST(without_a_viewer_the_page_says_how_to_get_one)
{
	static const char *const arguments[] = { "--listen", "127.0.0.1:0", PACK_PATH, NULL };
	char line[256], type[64], found[PATH_MAX], command[PATH_MAX + 64], out[8192], err[8192];
	if (!program_path[0])
		skip();
	strcpy(found, program_path);
	snprintf(command, sizeof command, "cp '%s' build/tmp/ecoserve_alone", found);
	assert_int_equal(system(command), 0);
	strcpy(program_path, "build/tmp/ecoserve_alone");
	struct program process = program_start(arguments);
	strcpy(program_path, found);
	uint16_t port = program_ready(&process, line);
	assert_non_null(strstr(line, "(1 scene named sample); the viewer is missing, `make web` builds "
		"it\n"));
	struct http_answer answer = http_get(port, "/?fbclid=x");
	assert_int_equal(answer.status, 404);
	assert_true(http_header(&answer, "Content-Type", type, sizeof type));
	assert_string_equal(type, "text/html; charset=utf-8");
	assert_non_null(strstr(answer.body, "<code>make web</code>"));
	assert_non_null(strstr(answer.body, "href=\"v1/scenes\""));
	http_free(&answer);
	answer = http_get(port, "/viewer/viewer.mjs");
	assert_int_equal(answer.status, 404);
	assert_non_null(strstr(answer.body, "\"status\":404"));
	http_free(&answer);
	kill(process.pid, SIGTERM);
	assert_int_equal(program_finish(&process, out, err), 0);
	remove("build/tmp/ecoserve_alone");
}

static struct http_answer whole_stream(uint16_t port)
{
	return http_get(port, "/v1/scenes/sample/stream?eye=50,-30,12&target=50,30,2&width=400&height=300"
		"&vertices=3000000");
}

/* ---- Settings ---- */

#define SETTINGS "build/tmp/test_ecoserve.conf"
#define PIPE_PATH "build/tmp/test_ecoserve.pipe"
#define PIPE_FOLDER "build/tmp/test_ecoserve_pipe"
#define HASH_PATH "build/tmp/test_ecoserve #1#.eco"
#define TOKEN_PATH "build/tmp/test_ecoserve.token"

static void write_file(const char *path, const char *text)
{
	FILE *file = fopen(path, "w");
	assert_true(file && fputs(text, file) >= 0 && fclose(file) == 0);
}

/* The output of --check-config for a file, the environment ("NAME=VALUE" or NULL) and the command line.
 * */
static int check(const char *file, const char *variable, const char *option, char out[8192], char err[8192])
{
	char name[64] = "";
	const char *arguments[] = { "--check-config", "--config=" SETTINGS, option, NULL };
	write_file(SETTINGS, file);
	if (variable) {
		snprintf(name, sizeof name, "%.*s", (int)strcspn(variable, "="), variable);
		setenv(name, variable + strcspn(variable, "=") + 1, 1);
	}
	struct program process = program_start_in(arguments, program_sandboxed);
	int status = program_finish(&process, out, err);
	if (variable)
		unsetenv(name);
	return status;
}

/* Such lines have no end, or no beginning. */
UNIT_TEST(what_is_no_file_of_settings_is_refused)
{
	static const char *const rows[][4] = { { "--check-config", "--config=/dev/zero" },
		{ "--check-config", "--config=" PIPE_PATH },
		{ "--check-config", "--admin-token=" PIPE_PATH, PACK_PATH },
		{ "--check-config", "--token=sample=" PIPE_PATH, PACK_PATH },
		{ "--check-config", "--config=build/tmp" },
		{ "--check-config", "--viewer=" PIPE_FOLDER, PACK_PATH },
		{ "--check-config", "--token=sample=/dev/zero", PACK_PATH } };
	char out[8192], err[8192];
	unlink(PIPE_PATH);
	assert_int_equal(mkfifo(PIPE_PATH, 0600), 0);
	folder_make(PIPE_FOLDER);
	unlink(PIPE_FOLDER "/index.html");
	assert_int_equal(mkfifo(PIPE_FOLDER "/index.html", 0600), 0);
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct program process = program_start(rows[i]);
		if (program_finish(&process, out, err) != 2 || !strstr(err, "from a regular file"))
			fail_msg("%s: %s", rows[i][1], err);
	}
	unlink(PIPE_PATH);
	unlink(PIPE_FOLDER "/index.html");
}

UNIT_TEST(settings_come_from_a_file_the_environment_and_the_command_line)
{
	static const struct { const char *file, *variable, *option; int status; const char *says;
	} rows[] = { { "# of two\n\npack = a=" PACK_PATH "   # one\npack=b=" PACK_PATH
		       "\nin-place\nlisten = [::1]:80\n",
			     NULL, NULL, 0, "the configuration is good (2 scenes named a, b)\n" },
		{ "pack = " PACK_PATH "\nlisten = nowhere\n", NULL, NULL, 2, "'nowhere' is not HOST:PORT" },
		{ "pack = " PACK_PATH "\nlisten = nowhere\n", "ECOSERVE_LISTEN=127.0.0.1:1", NULL, 0,
			"is good" },
		{ "pack = " PACK_PATH "\n", "ECOSERVE_LISTEN=nowhere", "--listen=127.0.0.1:1", 0, "is good" },
		{ "pack = " PACK_PATH "\n", "ECOSERVE_PLAN_WORK=0", NULL, 2, "--plan-work 0: must be" },
		{ "pack = " PACK_PATH "\n", "ECOSERVE_IN_PLACE=yes", NULL, 0, "is good" },
		{ "pack = " PACK_PATH "\n", "ECOSERVE_IN_PLACE=perhaps", NULL, 2,
			"ECOSERVE_IN_PLACE=perhaps: must be" },
		{ "", NULL, NULL, 2, "a pack is missing" },
		{ "pack = " PACK_PATH "\nplans-work = 3\n", NULL, NULL, 2,
			SETTINGS ": line 2: there is no 'plans-work'" },
		{ "pack = " PACK_PATH "\nin-place = yes\n", NULL, NULL, 2,
			"line 2: 'in-place' stands alone" },
		{ "listen\n", NULL, PACK_PATH, 2, "line 1: 'listen = HOST:PORT' is meant" },
		{ "pack = " DAMAGED_PATH "\n", NULL, NULL, 1, DAMAGED_PATH },
		{ "pack = " PACK_PATH "\ntoken = sample=" TOKEN_PATH "\n", NULL, NULL, 0, "is good" },
		{ "pack = " PACK_PATH "\ntoken = simple=" TOKEN_PATH "\n", NULL, NULL, 2,
			"there is no scene of this name" },
		{ "pack = " PACK_PATH "\ncap-vertices = 5000\ncap-vertices = sample=9\ncap-bytes = sample=1\n",
			NULL, NULL, 0, "is good" },
		{ "pack = " PACK_PATH "\ncap-bytes = simple=1\n", NULL, NULL, 2,
			"--cap-bytes simple=1: there is no scene of this name" },
		{ "pack = " PACK_PATH "\ncap-vertices = sample=0\n", NULL, NULL, 2,
			"--cap-vertices sample=0: must be N or SCENE=N" },
		{ "pack = " PACK_PATH "\n", "ECOSERVE_CAP_VERTICES=many", NULL, 2,
			"--cap-vertices many: must be N or SCENE=N" },
		{ "pack = " PACK_PATH "\ncors = here\n", NULL, NULL, 2,
			"--cors here: must be * or an origin" },
		{ "pack = " PACK_PATH "\nlog = xml\n", NULL, NULL, 2,
			"--log xml: must be one of text, json" },
		{ "pack = \n", NULL, NULL, 2, "line 1: 'pack =' names nothing" },
		{ "config = " SETTINGS "\npack = " PACK_PATH "\n", NULL, NULL, 2,
			"line 1: a file of settings names no other one" },
		{ "pack = " PACK_PATH "\nuser = nobody-at-all\n", NULL, NULL, 2,
			"there is no user 'nobody-at-all'" },
		{ "pack = a#b=" PACK_PATH "\n", NULL, NULL, 2, "'a#b' cannot name a scene" },
		{ "pack = a=build/tmp/#none.eco\n", NULL, NULL, 1, "build/tmp/#none.eco" },
		{ "pack = a=" HASH_PATH "\n", NULL, NULL, 2, "line 1: a comment begins with '#' and a space" },
		{ "pack = \"a=" HASH_PATH "\" # one\n", NULL, NULL, 0, "named a" },
		{ "pack = \"a=" HASH_PATH "\n", NULL, NULL, 2, "line 1: a value in quotes ends with" },
		{ "  # all\n\t#of it\n#none=\npack = " PACK_PATH " ## and\t# so on\n", NULL, NULL, 0,
			"is good" },
		{ "listen = [::1]:80\npack = " PACK_PATH "\n listen=[::1]:81\n", NULL, NULL, 2,
			"line 3: 'listen' was set before in this file" },
		{ "plans = 7\nplans-per-address = 7\nplans = 7\n", NULL, PACK_PATH, 2,
			"line 3: 'plans' was set" },
		{ "in-place\nin-place\n", NULL, PACK_PATH, 2, "line 2: 'in-place' was set before" },
		{ "trust-proxy = ::1\ntrust-proxy = ::2\n", NULL, PACK_PATH, 2,
			"line 2: 'trust-proxy' was set" },
		{ "cap-bytes = 7\ncap-bytes = sample=7\ncap-bytes = 8\n", NULL, PACK_PATH, 2,
			"line 3: 'cap-bytes' was set before in this file, with this name" },
		{ "cap-bytes = sample=7\ncap-bytes = 8\ncap-bytes = sample=8\n", NULL, PACK_PATH, 2,
			"line 3: 'cap-bytes' was set" },
		{ "cors = https://a.b\ncors = https://c.d\n", NULL, PACK_PATH, 0, "is good" },
		{ "embed = https://a.b\nembed = *\n", NULL, PACK_PATH, 0, "is good" },
		{ "embed = here\n", NULL, PACK_PATH, 2, "--embed here: must be * or an origin" },
		{ "listen = [::1]:80\n", "ECOSERVE_LISTEN=[::1]:81", PACK_PATH, 0, "is good" } };
	char out[8192], err[8192];
	if (!program_path[0])
		skip();
	struct eco_error error = { 0 };
	write_file(TOKEN_PATH, "0123456789abcdef\n");
	assert_ok(sample_pack_write(HASH_PATH, &error), error);
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		int status = check(rows[i].file, rows[i].variable, rows[i].option, out, err);
		if (status != rows[i].status || !strstr(status ? err : out, rows[i].says))
			fail_msg("row %zu: %d\n%s%s", i, status, out, err);
	}
}

/* One object a line; what looks like a token is not in it; a slow plan says what it tried. */
UNIT_TEST(logs_are_lines_of_json_without_tokens)
{
	static const char *const arguments[] = { "--listen", "127.0.0.1:0", "--log", "json", "--slow", "1",
		"--plan-work", "1000", "--config", SETTINGS, NULL };
	static const char stream[] =
		"/v1/scenes/sample/stream?eye=50,-30,12&target=50,30,2&width=400&height=300"
		"&vertices=3000000&bytes=100000";
	char line[256], out[8192], err[8192];
	unsigned lines = 0, slow = 0, quiet = 0;
	if (!program_path[0])
		skip();
	write_file(TOKEN_PATH, "0123456789abcdef\n");
	write_file(SETTINGS, "pack = " PACK_PATH "\ntoken = sample=" TOKEN_PATH "\n");
	struct program process = program_start(arguments);
	uint16_t port = program_ready(&process, line);
	struct http_answer answer =
		http_ask(port, "GET", stream, "Authorization: Bearer 0123456789abcdef\r\n", NULL, 0);
	assert_int_equal(answer.status, 200);
	http_free(&answer);
	answer = http_get(port, "/v1/scenes?access_token=0123456789abcdef&b=1");
	assert_int_equal(answer.status, 400);
	http_free(&answer);
	kill(process.pid, SIGHUP);
	usleep(100000);
	kill(process.pid, SIGTERM);
	assert_int_equal(program_finish(&process, out, err), 0);
	assert_null(strstr(err, "0123456789abcdef"));
	assert_non_null(strstr(err, "/v1/scenes?access_token=-&b=1"));
	for (char *at = strtok(err, "\n"); at; at = strtok(NULL, "\n"), lines++) {
		json_t *json = json_loads(at, 0, NULL);
		if (!json)
			fail_msg("not JSON: %s", at);
		const char *event = json_string_value(json_object_get(json, "event"));
		assert_int_equal(json_string_length(json_object_get(json, "time")), 24);
		if (strcmp(event, "slow") == 0 && ++slow) {
			assert_true(json_array_size(json_object_get(json, "trace")) >= 1);
			assert_true(json_integer_value(json_object_get(json, "work")) > 1000);
			assert_string_equal(json_string_value(json_object_get(json, "scene")), "sample");
		}
		quiet += strcmp(event, "request") == 0;
		json_decref(json);
	}
	assert_int_equal(slow, 1);
	assert_int_equal(quiet, 1);
	assert_true(lines >= 3);
}

static unsigned status_of(uint16_t port, const char *method, const char *target)
{
	struct http_answer answer = http_ask(port, method, target, "", NULL, 0);
	unsigned status = answer.status;
	http_free(&answer);
	return status;
}

/* Nor does a terminal obey it. */
UNIT_TEST(a_name_of_a_file_makes_no_line_of_the_log)
{
	static const char odd[] = "build/tmp/test_ecoserve\nforged: \033[2J\302\233\342\200\250.eco",
		clean[] = "build/tmp/test_ecoserve?forged: ?[2J?????.eco";
	static const char *const texts[] = { "--listen", "127.0.0.1:0", PACK_PATH, odd, NULL },
				 *const objects[] = { "--listen", "127.0.0.1:0", "--log", "json", PACK_PATH, odd,
		NULL };
	char line[256], out[8192], err[8192];
	if (!program_path[0])
		skip();
	for (int json = 0; json < 2; json++) {
		write_file(odd, "no pack");
		struct program process = program_start(json ? objects : texts);
		uint16_t port = program_ready(&process, line);
		assert_int_equal(status_of(port, "POST", "/v1/admin/reload"), 500);
		assert_int_equal(unlink(odd), 0);
		kill(process.pid, SIGTERM);
		assert_int_equal(program_finish(&process, out, err), 0);
		assert_true(json || strstr(err, clean));
		assert_null(strpbrk(err, "\033\302\342"));
		for (char *at = strtok(err, "\n"); at; at = strtok(NULL, "\n"))
			if (strncmp(at, json ? "{\"time\":" : "ecoserve: ", json ? 8 : 10) != 0)
				fail_msg("a line of its own: %s", at);
	}
}

UNIT_TEST(errors_of_a_start_have_the_form_of_the_log)
{
	static const struct { const char *arguments[6], *variable, *file, *says; int status; } rows[] = {
		{ { "--log", "json", "build/tmp/none.eco" }, NULL, "", "build/tmp/none.eco", 1 },
		{ { "--log=json", "--nonsense" }, NULL, "", "--nonsense", 2 },
		{ { "--nonsense", "--log", "json" }, NULL, "", "--nonsense", 2 },
		{ { PACK_PATH, "--listen", "nowhere" }, "json", "", "HOST:PORT", 2 },
		{ { "--config", SETTINGS }, NULL, "log = json\nlisten = x\n", "a pack is missing", 2 },
		{ { "--config", SETTINGS }, NULL, "log = json\nnonsense = x\n", "line 2", 2 } };
	char out[8192], err[8192];
	if (!program_path[0])
		skip();
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		write_file(SETTINGS, rows[i].file);
		if (rows[i].variable)
			setenv("ECOSERVE_LOG", rows[i].variable, 1);
		struct program process = program_start(rows[i].arguments);
		unsetenv("ECOSERVE_LOG");
		assert_int_equal(program_finish(&process, out, err), rows[i].status);
		json_t *json = json_loads(err, 0, NULL);
		const char *text = json_string_value(json_object_get(json, "text"));
		if (!text || !strstr(text, rows[i].says))
			fail_msg("row %zu: %s", i, err);
		json_decref(json);
	}
}

static int pipe_end;

static void take_pipe(void)
{
	dup2(pipe_end, STDERR_FILENO);
}

/* Starts it with an end of a pipe as stderr. */
static struct program start_on(int end)
{
	static const char *const arguments[] = { "--listen", "127.0.0.1:0", "--log", "text", PACK_PATH,
		"none=build/tmp/none.eco", NULL };
	pipe_end = end;
	return program_start_in(arguments, take_pipe);
}

static uint64_t dropped_lines(uint16_t port)
{
	static const char name[] = "\necoserve_log_lines_dropped_total ";
	struct http_answer answer = http_get(port, "/metrics");
	const char *at = answer.status == 200 ? strstr(answer.body, name) : NULL;
	assert_non_null(at);
	uint64_t count = strtoull(at + strlen(name), NULL, 10);
	http_free(&answer);
	return count;
}

/* The reader of the pipe has gone, or has stopped before the start. */
UNIT_TEST(a_log_that_cannot_be_written_stops_nothing)
{
	enum { REQUESTS = 20 };
	char line[256], out[8192], err[8192], byte = 'x';
	if (!program_path[0])
		skip();
	for (int stopped = 0; stopped < 2; stopped++) {
		int ends[2];
		assert_int_equal(pipe2(ends, O_CLOEXEC | O_NONBLOCK), 0);
		while (stopped && write(ends[1], &byte, 1) == 1)
			continue;
		if (!stopped)
			close(ends[0]);
		assert_int_equal(fcntl(ends[1], F_SETFL, 0), 0);
		struct program process = start_on(ends[1]);
		uint16_t port = program_ready(&process, line);
		for (int i = 0; i < REQUESTS; i++)
			assert_int_equal(status_of(port, "GET", "/none"), 404);
		if (stopped)
			assert_true(dropped_lines(port) >= 1);   /* that a pack is not well */
		while (!stopped && dropped_lines(port) <= REQUESTS)
			usleep(10000);
		kill(process.pid, SIGTERM);
		assert_int_equal(program_finish(&process, out, err), 0);
		if (stopped)
			close(ends[0]);
		close(ends[1]);
	}
}

/* Nobody reads stderr until it has ended. */
UNIT_TEST(a_log_that_nobody_reads_stops_nothing)
{
	static const char *const arguments[] = { "--listen", "127.0.0.1:0", "--log", "json", PACK_PATH, NULL };
	enum { REQUESTS = 2000, LONG = 390 };
	char line[256], out[8192], err[8192], target[LONG + 2] = "/";
	if (!program_path[0])
		skip();
	struct program process = program_start(arguments);
	uint16_t port = program_ready(&process, line);
	memset(target + 1, 'x', LONG);
	for (int i = 0; i < REQUESTS; i++)
		assert_int_equal(status_of(port, "GET", target), 404);
	kill(process.pid, SIGHUP);
	assert_int_equal(status_of(port, "POST", "/v1/admin/reload"), 200);
	/* both buffers and the pipe are full of whole lines */
	assert_in_range(dropped_lines(port), REQUESTS / 4, REQUESTS);
	kill(process.pid, SIGTERM);
	assert_int_equal(program_finish(&process, out, err), 0);
	if (strncmp(err, "{\"time\":", 8) != 0)
		fail_msg("%.300s", err);
}

/* The log tells who asks. */
UNIT_TEST(the_last_line_of_a_trusted_proxy_says_who_asks)
{
	static const char *const arguments[] = { "--listen", "127.0.0.1:0", "--log", "text", "--trust-proxy",
		"127.0.0.0/8", PACK_PATH, NULL };
	static const struct { const char *headers, *client; } rows[] = {
		{ "X-Forwarded-For: 6.6.6.6\r\nX-Forwarded-For: 1.2.3.4\r\n", "1.2.3.4" },
		{ "x-forwarded-for: 6.6.6.6\r\nVia: x\r\nX-FORWARDED-FOR: 1.2.3.4:99\r\n", "1.2.3.4" },
		{ "X-Forwarded-For: 6.6.6.6, 7.7.7.7\r\nX-Forwarded-For: 127.0.0.2\r\n", "7.7.7.7" },
		{ "X-Forwarded-For: 6.6.6.6\r\nX-Forwarded-For: \r\n", "127.0.0.1" },
		{ "X-Forwarded-For: \r\nX-Forwarded-For: [2001:db8::5]:1\r\n", "2001:db8::5" },
		{ "X-Forwarded-For: 6.6.6.6\r\n", "6.6.6.6" }, { "", "127.0.0.1" } };
	char line[256], out[8192], err[8192];
	if (!program_path[0])
		skip();
	struct program process = program_start(arguments);
	uint16_t port = program_ready(&process, line);
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		snprintf(line, sizeof line, "/row-%zu", i);
		struct http_answer answer = http_ask(port, "GET", line, rows[i].headers, NULL, 0);
		assert_int_equal(answer.status, 404);
		http_free(&answer);
	}
	kill(process.pid, SIGTERM);
	assert_int_equal(program_finish(&process, out, err), 0);
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		snprintf(line, sizeof line, "%s GET /row-%zu 404", rows[i].client, i);
		const char *at = strstr(err, line);
		if (!at || (at > err && at[-1] != '\n'))
			fail_msg("no line '%s' in\n%s", line, err);
	}
}

/* The stated limits hold. */
UNIT_TEST(limits_are_options)
{
	static const char *const arguments[] = { "--listen", "127.0.0.1:0", "--head-ms", "50",
		"--body-bytes",
		"100",
		"--answer-bytes", "1000", "--send-ms", "5000", PACK_PATH, NULL };
	static const char declared[] = "POST /v1/scenes/sample/stream?eye=50,-30,12&target=50,30,2&width=400"
		"&height=300&vertices=1 HTTP/1.1\r\nHost: t\r\nContent-Type: application/octet-stream\r\n"
		"Content-Length: 101\r\n\r\n";
	char line[256], out[8192], err[8192];
	if (!program_path[0])
		skip();
	struct program process = program_start(arguments);
	uint16_t port = program_ready(&process, line);
	struct http_answer answer = whole_stream(port);
	if (answer.status != 422)
		fail_msg("%s", answer.head);
	http_free(&answer);
	answer = http_raw(port, declared, sizeof declared - 1);
	assert_int_equal(answer.status, 413);
	http_free(&answer);
	answer = http_raw(port, "", 0);          /* until it is closed */
	assert_true(answer.status == 0 && answer.closed);
	http_free(&answer);
	kill(process.pid, SIGTERM);
	assert_int_equal(program_finish(&process, out, err), 0);
}

UNIT_TEST(ipv6_is_served_where_there_is_some)
{
	static const char *const arguments[] = { "--listen", "[::1]:0", PACK_PATH, NULL };
	char line[256], out[8192], err[8192];
	if (!program_path[0])
		skip();
	struct program process = program_start(arguments);
	bool ready = program_ready(&process, line) != 0;
	kill(process.pid, SIGTERM);
	int status = program_finish(&process, out, err);
	if (!ready && status == 1)
		skip();                  /* a machine without IPv6 */
	assert_int_equal(status, 0);
	assert_true(strncmp(line, "ecoserve: ready on http://[::1]:", 32) == 0);
	assert_non_null(strstr(line, "(1 scene named "));
}

/* Warnings of each start on a system without Landlock, or without a change of user. */
static bool only_warns(const char *err)
{
	static const char warning[] = "ecoserve: warning: ";
	while (strncmp(err, warning, sizeof warning - 1) == 0)
		err += strcspn(err, "\n") + (strchr(err, '\n') ? 1 : 0);
	return !*err;
}

UNIT_TEST(a_client_that_leaves_does_no_harm)
{
	static const char *const arguments[] = { "--listen", "127.0.0.1:0", PACK_PATH, NULL };
	static const char request[] = "GET "
		"/v1/scenes/sample/stream?eye=50,-30,12&target=50,30,"
		"2&width=400&height=300&vertices=3000000 HTTP/1.1\r\n"
		"Host: t\r\n\r\n";
	char line[256], out[8192], err[8192];
	if (!program_path[0])
		skip();
	struct program process = program_start(arguments);
	uint16_t port = program_ready(&process, line);
	for (int i = 0; i < 40; i++) {
		int fd = http_connect(port);
		assert_true(http_send(fd, request, i % 2 ? sizeof request - 1 : 50));
		char some[10];
		if (i % 4 == 1)
			assert_true(recv(fd, some, sizeof some, 0) > 0);
		close(fd);
	}
	struct http_answer answer = http_get(port, "/healthz");
	assert_int_equal(answer.status, 200);
	http_free(&answer);
	kill(process.pid, SIGTERM);
	assert_int_equal(program_finish(&process, out, err), 0);
	assert_true(only_warns(err));
}

/* A view would have to open all of its tiles, without end. */
UNIT_TEST(a_pack_that_no_view_can_be_planned_of_is_refused)
{
	static const char *const arguments[] = { "--listen", "127.0.0.1:0", DEEP_PATH, NULL };
	static const char says[] = "no summary stands for the tiles and plants below it";
	char line[256], out[8192], err[8192];
	struct eco_error error = { 0 };
	struct eco_pack *pack;
	if (!program_path[0])
		skip();
	assert_ok(deep_pack_write(DEEP_PATH, false, &error), error);
	struct program process = program_start(arguments);
	uint16_t port = program_ready(&process, line);
	assert_true(port);
	assert_ok(deep_pack_write(DEEP_PATH ".new", true, &error), error);
	assert_int_equal(rename(DEEP_PATH ".new", DEEP_PATH), 0);
	assert_int_equal(eco_pack_open(&pack, DEEP_PATH, &error), ECO_DAMAGED);
	assert_non_null(strstr(error.text, says));
	kill(process.pid, SIGHUP);
	assert_int_equal(status_of(port, "POST", "/v1/admin/reload"), 500);
	struct http_answer answer = http_get(port, "/v1/scenes/deep/stream?eye=50,-30,12&target=50,30,2&"
		"width=400&height=300&vertices=1000");
	assert_int_equal(answer.status, 200);
	http_free(&answer);
	kill(process.pid, SIGTERM);
	assert_int_equal(program_finish(&process, out, err), 0);
	assert_non_null(strstr(err, says));
	process = program_start(arguments);
	assert_int_equal(program_finish(&process, out, err), 1);
	assert_non_null(strstr(err, says));
}

static int64_t bad_packs(uint16_t port)
{
	struct http_answer answer = http_get(port, "/readyz");
	assert_int_equal(answer.status, 200);
	json_t *json = json_loads(answer.body, 0, NULL);
	assert_true(json_is_integer(json_object_get(json, "bad_packs")));
	int64_t count = json_integer_value(json_object_get(json, "bad_packs"));
	json_decref(json);
	http_free(&answer);
	return count;
}

/* Until a reload finds them well. */
UNIT_TEST(one_good_pack_of_three_is_served)
{
	static const char *const arguments[] = { "--listen", "127.0.0.1:0", "--token", "late=" TOKEN_PATH,
		"late=" LATE_PATH, PACK_PATH, "never=build/tmp/no such folder/none.eco", NULL };
	static const char *const unnamed[] = { "--token", "late=" TOKEN_PATH, LATE_PATH, PACK_PATH, NULL };
	static const char *const checks[] = { "--check-config", "late=" LATE_PATH, PACK_PATH, NULL };
	char line[256], out[8192], err[8192];
	struct eco_error error = { 0 };
	if (!program_path[0])
		skip();
	folder_make("build/tmp/test_ecoserve_late");
	write_file(LATE_PATH, "no pack");
	write_file(TOKEN_PATH, "0123456789abcdef\n");
	struct program process = program_start_in(arguments, program_sandboxed);
	uint16_t port = program_ready(&process, line);
	assert_true(port && strstr(line, "(1 scene named sample)"));
	assert_int_equal(status_of(port, "GET", "/v1/scenes/sample"), 200);
	assert_int_equal(bad_packs(port), 2);
	assert_int_equal(unlink(LATE_PATH), 0);
	assert_ok(sample_pack_write(LATE_PATH, &error), error);
	assert_int_equal(status_of(port, "POST", "/v1/admin/reload"), 500);      /* of the third */
	struct http_answer answer = http_ask(port, "GET", "/v1/scenes/late",
		"Authorization: Bearer 0123456789abcdef\r\n", NULL, 0);
	assert_int_equal(answer.status, 200);
	http_free(&answer);
	assert_int_equal(bad_packs(port), 1);
	kill(process.pid, SIGTERM);
	assert_int_equal(program_finish(&process, out, err), 0);
	assert_non_null(strstr(err, "warning: not served until a reload finds it well: " LATE_PATH));
	assert_non_null(strstr(err, "no such folder/none.eco"));
	write_file(LATE_PATH, "no pack");
	process = program_start(checks);
	assert_int_equal(program_finish(&process, out, err), 1);
	assert_non_null(strstr(err, LATE_PATH));
	/* nobody knows whether the good one is the one that the token is for */
	process = program_start(unnamed);
	assert_int_equal(program_finish(&process, out, err), 2);
	assert_non_null(strstr(err, "--token late=FILE: there is no scene of this name"));
}

/* Zeros in place of its bytes, then nothing: the answers stay those of the pack that was read. */
UNIT_TEST(a_pack_that_is_written_over_is_served_as_it_was)
{
	static const char *const arguments[] = { "--listen", "127.0.0.1:0", CUT_PATH, NULL };
	static const char *const others[] = { "--listen", "127.0.0.1:0", PACK_PATH, NULL };
	static const uint8_t zeros[4096];
	char line[256], out[8192], err[8192];
	struct eco_error error = { 0 };
	if (!program_path[0])
		skip();
	assert_int_equal(sample_pack_write(CUT_PATH, &error), ECO_OK);
	struct program process = program_start(arguments), untouched = program_start(others);
	uint16_t port = program_ready(&process, line);
	struct http_answer expected = whole_stream(program_ready(&untouched, line));
	assert_int_equal(expected.status, 200);
	for (int round = 0; round < 2; round++) {
		FILE *file = fopen(CUT_PATH, round ? "wb" : "r+b");
		assert_non_null(file);
		for (int i = 0; i < 16 && !round; i++)
			assert_int_equal(fwrite(zeros, sizeof zeros, 1, file), 1);
		assert_int_equal(fclose(file), 0);
		struct http_answer answer = whole_stream(port);
		assert_int_equal(answer.status, 200);
		assert_int_equal(answer.size, expected.size);
		assert_memory_equal(answer.body, expected.body, expected.size);
		http_free(&answer);
	}
	http_free(&expected);
	kill(untouched.pid, SIGTERM);
	assert_int_equal(program_finish(&untouched, out, err), 0);
	kill(process.pid, SIGTERM);
	assert_int_equal(program_finish(&process, out, err), 0);
	assert_true(only_warns(err));
}

UNIT_TEST(a_pack_in_place_cut_short_ends_it_with_advice)
{
	static const char *const arguments[] = { "--in-place", "--listen", "127.0.0.1:0", CUT_PATH, NULL };
	static const char request[] = "GET "
		"/v1/scenes/sample/stream?eye=50,-30,12&target=50,30,"
		"2&width=400&height=300&vertices=3000000 HTTP/1.1\r\n"
		"Host: t\r\n\r\n";
	char line[256], out[8192], err[8192];
	struct eco_error error = { 0 };
	if (!program_path[0])
		skip();
	assert_int_equal(sample_pack_write(CUT_PATH, &error), ECO_OK);
	struct program process = program_start(arguments);
	uint16_t port = program_ready(&process, line);
	assert_int_equal(truncate(CUT_PATH, 0), 0);
	int fd = http_connect(port);
	assert_true(http_send(fd, request, sizeof request - 1));
	assert_int_equal(program_finish(&process, out, err), 1);
	assert_non_null(strstr(err, "a pack was cut short"));
	close(fd);
}

/* Importers and decoders are hostile ground: none of them is in the daemon, neither as a library nor linked
 * in. */
UNIT_TEST(it_links_no_importer_and_no_decoder)
{
	static const char *const libraries[] = { "draco", "OpenImageIO", "assimp", "gdal", "meshoptimizer",
		"libEGL", "libcurl" };
	char command[PATH_MAX + 64], line[1024];
	if (!program_path[0])
		skip();
	snprintf(command, sizeof command, "ldd '%s'", program_path);
	FILE *lines = popen(command, "r");
	unsigned count = 0;
	assert_non_null(lines);
	while (fgets(line, sizeof line, lines)) {
		count++;
		for (size_t i = 0; i < sizeof libraries / sizeof *libraries; i++)
			if (strstr(line, libraries[i]) && !strstr(line, "san.so"))
				fail_msg("ecoserve links %s", line);
	}
	assert_int_equal(pclose(lines), 0);
	assert_true(count > 2);
	FILE *file = fopen(program_path, "rb");
	assert_non_null(file);
	static const char mangled[] = "_ZN5draco";
	for (size_t matched = 0, c; (c = (size_t)getc(file)) != (size_t)EOF;) {
		matched = c == (unsigned char)mangled[matched] ? matched + 1 : c == '_';
		if (matched == sizeof mangled - 1)
			fail_msg("ecoserve contains Draco");
	}
	fclose(file);
}

int main(void)
{
	return unit_tests_run(prepare, NULL);
}
