/* The program: what it prints and how it ends. Skipped if it has not been built. */
#include <fcntl.h>
#include <jansson.h>
#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/base/version.h"
#include "tests/support/cases.h"
#include "tests/support/files.h"
#include "tests/support/scene_packs.h"
#include "tests/support/serve/http_client.h"
#include "tests/support/serve/serve_program.h"
#include "tests/support/unit_test.h"

#define PACK_PATH "build/tmp/test_ecoserve.eco"
#define CUT_PATH "build/tmp/test_ecoserve_cut.eco"
#define DAMAGED_PATH "build/tmp/test_ecoserve_damaged.eco"
#define LATE_PATH "build/tmp/test_ecoserve_late/late.eco"
#define START "--listen", "127.0.0.1:0"
#define ARGUMENTS(...) (const char *const[]){ __VA_ARGS__, NULL }
#define VIEW "eye=50,-30,12&target=50,30,2&width=400&height=300"

static int prepare(void **state)
{
	struct eco_error error = { 0 };
	program_find();
	folder_make("build/tmp");
	if (sample_pack_write(PACK_PATH, &error)) {
		fprintf(stderr, "%s\n", error.text);
		return 1;
	}
	size_t size;
	uint8_t *bytes = file_read(PACK_PATH, &size);
	bytes[100] ^= 1;
	file_write(DAMAGED_PATH, bytes, size);
	free(bytes);
	return 0;
}

UNIT_TEST(arguments_are_checked_and_errors_help)
{
	static const struct { const char *arguments[6]; int status; const char *says; } rows[] = {
		{ { "--version" }, 0, "ecoserve " ECO_VERSION "\n" }, { { "--help" }, 0, "usage: ecoserve" },
		{ { NULL }, 2, "a pack is missing" }, { { "--nonsense" }, 2, "--help" },
		{ { "--listen" }, 2, "--help" }, { { "--listen", "nowhere", PACK_PATH }, 2, "HOST:PORT" },
		{ { "--trust-proxy", "10.0.0.0/40", PACK_PATH }, 2, "'10.0.0.0/40' is not an address" },
		{ { "--connections", "0", PACK_PATH }, 2, "--help" },
		{ { "Bad=" PACK_PATH }, 2, "cannot name a scene" },
		{ { "a=" PACK_PATH, "a=" PACK_PATH }, 2, "two scenes are named 'a'" },
		{ { PACK_PATH, PACK_PATH }, 2, "two scenes are named 'sample'" },
		{ { "build/tmp/none.eco" }, 1, "build/tmp/none.eco" }, { { DAMAGED_PATH }, 1, DAMAGED_PATH },
		{ { "--copies", "build/tmp/no such folder", PACK_PATH }, 1,
			"build/tmp/no such folder: No such file or directory: make room there, name another "
			"folder (--copies DIR)" } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		if (rows[i].status) {
			program_fails(rows[i].arguments, rows[i].status, rows[i].says);
			continue;
		}
		struct program program = program_start(rows[i].arguments, NULL);
		assert_int_equal(program_finish(&program), 0);
		assert_int_equal(strncmp(program.out, rows[i].says, strlen(rows[i].says)), 0);
	}
}

UNIT_TEST(it_says_when_it_is_ready_and_ends_when_asked)
{
	char expected[256];
	for (int which = 0; which < 2; which++) {
		struct program program = program_serve(ARGUMENTS(START, "--log", "text", "a=" PACK_PATH,
			"b=" PACK_PATH), NULL);
		snprintf(expected, sizeof expected, "ecoserve: ready on http://127.0.0.1:%u (2 scenes named "
			"a, b)", program.port);
		assert_int_equal(strncmp(program.line, expected, strlen(expected)), 0);
		http_expect(program.port, "GET", "/v1/scenes/b", "", 200, NULL);
		const int harmless[] = { SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM, SIGIO, SIGPWR, SIGXFSZ,
			SIGRTMIN, SIGRTMAX, SIGWINCH, SIGPIPE };
		for (size_t i = 0; i < sizeof harmless / sizeof *harmless; i++)
			kill(program.pid, harmless[i]);
		kill(program.pid, SIGHUP);       /* a terminal that is closed ends no server */
		http_expect(program.port, "GET", "/v1/scenes/a", "", 200, NULL);
		kill(program.pid, which ? SIGINT : SIGTERM);
		assert_int_equal(program_finish(&program), 0);
		assert_string_equal(program.out, "");
		assert_non_null(strstr(program.err, "127.0.0.1 GET /v1/scenes/b 200"));
		assert_non_null(strstr(program.err, "reload: 0 scenes opened, 2 as they were, 0 gone"));
	}
}

/* A copy of the program has no viewer beside it. */
UNIT_TEST(without_a_viewer_the_page_says_how_to_get_one)
{
	char found[PATH_MAX], command[PATH_MAX + 64];
	strcpy(found, program_path);
	snprintf(command, sizeof command, "cp '%s' build/tmp/ecoserve_alone", found);
	assert_true(!found[0] || system(command) == 0);
	strcpy(program_path, found[0] ? "build/tmp/ecoserve_alone" : "");
	struct program program = program_serve(ARGUMENTS(START, PACK_PATH), NULL);
	strcpy(program_path, found);
	assert_non_null(strstr(program.line, "(1 scene named sample); the viewer is missing, `make web` "
		"builds it\n"));
	http_expect(program.port, "GET", "/?fbclid=x", "", 404, "<code>make web</code>");
	http_expect(program.port, "GET", "/?fbclid=x", "", 404, "href=\"v1/scenes\"");
	http_expect(program.port, "GET", "/viewer/viewer.mjs", "", 404, "\"status\":404");
	program_stop(&program);
	remove("build/tmp/ecoserve_alone");
}

/* ---- Settings ---- */

#define SETTINGS "build/tmp/test_ecoserve.conf"
#define PIPE_PATH "build/tmp/test_ecoserve.pipe"
#define PIPE_FOLDER "build/tmp/test_ecoserve_pipe"
#define HASH_PATH "build/tmp/test_ecoserve #1#.eco"
#define TOKEN_PATH "build/tmp/test_ecoserve.token"
#define TOKEN "0123456789abcdef"

/* Such lines have no end, or no beginning. */
UNIT_TEST(pipes_and_devices_are_no_settings)
{
	static const char *const rows[][4] = { { "--check-config", "--config=/dev/zero" },
		{ "--check-config", "--config=" PIPE_PATH },
		{ "--check-config", "--admin-token=" PIPE_PATH, PACK_PATH },
		{ "--check-config", "--token=sample=" PIPE_PATH, PACK_PATH },
		{ "--check-config", "--config=build/tmp" },
		{ "--check-config", "--viewer=" PIPE_FOLDER, PACK_PATH },
		{ "--check-config", "--token=sample=/dev/zero", PACK_PATH } };
	unlink(PIPE_PATH);
	assert_int_equal(mkfifo(PIPE_PATH, 0600), 0);
	folder_make(PIPE_FOLDER);
	unlink(PIPE_FOLDER "/index.html");
	assert_int_equal(mkfifo(PIPE_FOLDER "/index.html", 0600), 0);
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		program_fails(rows[i], 2, "from a regular file");
	unlink(PIPE_PATH);
	unlink(PIPE_FOLDER "/index.html");
}

UNIT_TEST(settings_come_from_a_file_the_environment_and_the_command_line)
{
	/* `variable`: NAME=VALUE in the environment; status 0: `says` is on stdout */
	struct settings_case { const char *file, *variable, *option, *status, *says; };
	char name[64];
	file_write_text(TOKEN_PATH, TOKEN "\n");
	assert_good(sample_pack_write(HASH_PATH, &cause));
	uint32_t count;
	const struct settings_case *rows = cases_read("tests/server/cases/settings.tsv", sizeof *rows, &count);
	for (uint32_t i = 0; i < count; i++) {
		const char *variable = rows[i].variable ? rows[i].variable : "ECOSERVE_NOTHING=";
		file_write_text(SETTINGS, rows[i].file);
		snprintf(name, sizeof name, "%.*s", (int)strcspn(variable, "="), variable);
		if (rows[i].variable)
			setenv(name, variable + strlen(name) + 1, 1);
		struct program program = program_start(ARGUMENTS("--check-config", "--config=" SETTINGS,
			rows[i].option), program_sandboxed);
		int status = program_finish(&program);
		unsetenv(name);
		if (status != atoi(rows[i].status) || !strstr(status ? program.err : program.out, rows[i].says))
			fail_msg("row %u: %d\n%s%s", i, status, program.out, program.err);
	}
}

/* ---- Logs ---- */

/* One object a line; what looks like a token is not in it; a slow plan says what it tried. */
UNIT_TEST(logs_are_lines_of_json_without_tokens)
{
	unsigned lines = 0, slow = 0, quiet = 0;
	file_write_text(TOKEN_PATH, TOKEN "\n");
	file_write_text(SETTINGS, "pack = " PACK_PATH "\ntoken = sample=" TOKEN_PATH "\n");
	struct program program = program_serve(ARGUMENTS(START, "--log", "json", "--slow", "1", "--plan-work",
		"1000", "--config", SETTINGS), NULL);
	http_expect(program.port, "GET", "/v1/scenes/sample/stream?" VIEW "&vertices=3000000&bytes=100000",
		"Authorization: Bearer " TOKEN "\r\n", 200, NULL);
	http_expect(program.port, "GET", "/v1/scenes?access_token=" TOKEN "&b=1", "", 400, NULL);
	kill(program.pid, SIGHUP);
	usleep(100000);
	program_stop(&program);
	assert_null(strstr(program.err, TOKEN));
	assert_non_null(strstr(program.err, "/v1/scenes?access_token=-&b=1"));
	for (char *at = strtok(program.err, "\n"); at; at = strtok(NULL, "\n"), lines++) {
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
	assert_true(slow == 1 && quiet == 1 && lines >= 3);
}

/* Nor does a terminal obey it. */
UNIT_TEST(a_name_of_a_file_makes_no_line_of_the_log)
{
	static const char odd[] = "build/tmp/test_ecoserve\nforged: \033[2J\302\233\342\200\250.eco",
		clean[] = "build/tmp/test_ecoserve?forged: ?[2J?????.eco";
	for (int json = 0; json < 2; json++) {
		file_write_text(odd, "no pack");
		struct program program = program_serve(ARGUMENTS(START, "--log", json ? "json" : "text",
			PACK_PATH, odd), NULL);
		http_expect(program.port, "POST", "/v1/admin/reload", "", 500, NULL);
		assert_int_equal(unlink(odd), 0);
		program_stop(&program);
		assert_true(json || strstr(program.err, clean));
		assert_null(strpbrk(program.err, "\033\302\342"));
		for (char *at = strtok(program.err, "\n"); at; at = strtok(NULL, "\n"))
			if (strncmp(at, json ? "{\"time\":" : "ecoserve: ", 8) != 0 && strncmp(at,
				"127.0.0.1 ", 10) != 0) fail_msg("a line of its own: %s", at);
	}
}

UNIT_TEST(errors_of_a_start_have_the_form_of_the_log)
{
	static const struct { const char *arguments[6], *variable, *file, *says; int status; } rows[] = {
		{ { "--log", "json", "build/tmp/none.eco" }, NULL, "", "build/tmp/none.eco", 1 },
		{ { "--nonsense", "--log=json" }, NULL, "", "--nonsense", 2 },
		{ { PACK_PATH, "--listen", "nowhere" }, "json", "", "HOST:PORT", 2 },
		{ { "--config", SETTINGS }, NULL, "log = json\nlisten = x\n", "a pack is missing", 2 },
		{ { "--config", SETTINGS }, NULL, "log = json\nnonsense = x\n", "line 2", 2 } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		file_write_text(SETTINGS, rows[i].file);
		if (rows[i].variable)
			setenv("ECOSERVE_LOG", rows[i].variable, 1);
		struct program program = program_start(rows[i].arguments, NULL);
		unsetenv("ECOSERVE_LOG");
		assert_int_equal(program_finish(&program), rows[i].status);
		json_t *json = json_loads(program.err, 0, NULL);
		const char *text = json_string_value(json_object_get(json, "text"));
		if (!text || !strstr(text, rows[i].says))
			fail_msg("row %zu: %s", i, program.err);
		json_decref(json);
	}
}

static int pipe_end;

static void take_pipe(void)
{
	dup2(pipe_end, STDERR_FILENO);
}

static uint64_t dropped_lines(uint16_t port) { return http_metric(port, "log_lines_dropped_total"); }

/* The reader of the pipe has gone, or has stopped before the start. */
UNIT_TEST(a_log_that_cannot_be_written_stops_nothing)
{
	enum { REQUESTS = 20 };
	char byte = 'x';
	for (int stopped = 0; stopped < 2; stopped++) {
		int ends[2];
		assert_int_equal(pipe2(ends, O_CLOEXEC | O_NONBLOCK), 0);
		fcntl(ends[1], F_SETPIPE_SZ, 1 << 20);   /* more than ecoserve makes it */
		while (stopped && write(ends[1], &byte, 1) == 1)
			continue;
		if (!stopped)
			close(ends[0]);
		assert_int_equal(fcntl(ends[1], F_SETFL, 0), 0);
		pipe_end = ends[1];
		struct program program = program_serve(ARGUMENTS(START, "--log", "text", PACK_PATH,
			"none=build/tmp/none.eco"), take_pipe);
		for (int i = 0; i < REQUESTS; i++)
			assert_int_equal(http_status(program.port, "GET", "/none", ""), 404);
		if (stopped)
			assert_true(dropped_lines(program.port) >= 1);   /* that a pack is not well */
		while (!stopped && dropped_lines(program.port) <= REQUESTS)
			usleep(10000);
		program_stop(&program);
		if (stopped)
			close(ends[0]);
		close(ends[1]);
	}
}

/* The log tells who asks. */
UNIT_TEST(the_last_line_of_a_trusted_proxy_says_who_asks)
{
	static const struct { const char *headers, *client; } rows[] = {
		{ "X-Forwarded-For: 6.6.6.6\r\nX-Forwarded-For: 1.2.3.4\r\n", "1.2.3.4" },
		{ "x-forwarded-for: 6.6.6.6\r\nVia: x\r\nX-FORWARDED-FOR: 1.2.3.4:99\r\n", "1.2.3.4" },
		{ "X-Forwarded-For: 6.6.6.6, 7.7.7.7\r\nX-Forwarded-For: 127.0.0.2\r\n", "7.7.7.7" },
		{ "X-Forwarded-For: 6.6.6.6\r\nX-Forwarded-For: \r\n", "127.0.0.1" },
		{ "X-Forwarded-For: \r\nX-Forwarded-For: [2001:db8::5]:1\r\n", "2001:db8::5" },
		{ "X-Forwarded-For: 6.6.6.6\r\n", "6.6.6.6" }, { "", "127.0.0.1" } };
	char line[100];
	struct program program = program_serve(ARGUMENTS(START, "--log", "text", "--trust-proxy",
		"127.0.0.0/8", PACK_PATH), NULL);
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		snprintf(line, sizeof line, "/row-%zu", i);
		http_expect(program.port, "GET", line, rows[i].headers, 404, NULL);
	}
	program_stop(&program);
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		snprintf(line, sizeof line, "%s GET /row-%zu 404", rows[i].client, i);
		const char *at = strstr(program.err, line);
		if (!at || (at > program.err && at[-1] != '\n'))
			fail_msg("no line '%s' in\n%s", line, program.err);
	}
}

/* ---- Serving ---- */

#define WHOLE "/v1/scenes/sample/stream?" VIEW "&vertices=3000000"
static const char whole_request[] = "GET " WHOLE " HTTP/1.1\r\nHost: t\r\n\r\n";

/* The stated limits hold. */
UNIT_TEST(limits_are_options)
{
	static const char declared[] = "POST /v1/scenes/sample/stream?" VIEW "&vertices=1 HTTP/1.1\r\nHost: "
		"t\r\nContent-Type: application/octet-stream\r\nContent-Length: 101\r\n\r\n";
	struct program program = program_serve(ARGUMENTS(START, "--head-ms", "50", "--body-bytes", "100",
		"--answer-bytes", "1000", "--send-ms", "5000", PACK_PATH), NULL);
	http_expect(program.port, "GET", WHOLE, "", 422, NULL);
	struct http_answer answer = http_raw(program.port, declared, sizeof declared - 1);
	assert_int_equal(answer.status, 413);
	http_free(&answer);
	answer = http_raw(program.port, "", 0);          /* until it is closed */
	assert_true(answer.status == 0 && answer.closed);
	http_free(&answer);
	program_stop(&program);
}

UNIT_TEST(ipv6_is_served_where_there_is_some)
{
	struct program program = program_start(ARGUMENTS("--listen", "[::1]:0", PACK_PATH), NULL);
	bool ready = program_ready(&program);
	kill(program.pid, SIGTERM);
	int status = program_finish(&program);
	if (!ready && status == 1)
		skip();                  /* a machine without IPv6 */
	assert_int_equal(status, 0);
	assert_true(strncmp(program.line, "ecoserve: ready on http://[::1]:", 32) == 0);
}

/* Until a reload finds them well. */
UNIT_TEST(one_good_pack_of_three_is_served)
{
	folder_make("build/tmp/test_ecoserve_late");
	file_write_text(LATE_PATH, "no pack");
	file_write_text(TOKEN_PATH, TOKEN "\n");
	struct program program = program_serve(ARGUMENTS(START, "--token", "late=" TOKEN_PATH, "late="
		LATE_PATH, PACK_PATH, "never=build/tmp/no such folder/none.eco"), program_sandboxed);
	assert_non_null(strstr(program.line, "(1 scene named sample)"));
	http_expect(program.port, "GET", "/v1/scenes/sample", "", 200, NULL);
	http_expect(program.port, "GET", "/readyz", "", 200, "\"bad_packs\":2}");
	assert_int_equal(unlink(LATE_PATH), 0);
	assert_good(sample_pack_write(LATE_PATH, &cause));
	http_expect(program.port, "POST", "/v1/admin/reload", "", 500, "none.eco");      /* the third */
	http_expect(program.port, "GET", "/v1/scenes/late", "Authorization: Bearer " TOKEN "\r\n", 200, NULL);
	http_expect(program.port, "GET", "/readyz", "", 200, "\"bad_packs\":1}");
	program_stop(&program);
	assert_non_null(strstr(program.err, "warning: not served until a reload finds it well: " LATE_PATH));
	assert_non_null(strstr(program.err, "no such folder/none.eco"));
	file_write_text(LATE_PATH, "no pack");
	program_fails(ARGUMENTS("--check-config", "late=" LATE_PATH, PACK_PATH), 1, LATE_PATH);
	/* nobody knows whether the good one is the one that the token is for */
	program_fails(ARGUMENTS("--token", "late=" TOKEN_PATH, LATE_PATH, PACK_PATH), 2,
		"--token late=FILE: there is no scene of this name");
}

/* Zeros in place of its bytes, then nothing: the answers stay those of the pack that was read. */
UNIT_TEST(a_pack_that_is_written_over_is_served_as_it_was)
{
	static const uint8_t zeros[1 << 16];
	assert_good(sample_pack_write(CUT_PATH, &cause));
	struct program program = program_serve(ARGUMENTS(START, CUT_PATH), NULL);
	struct http_answer expected = http_get(program.port, WHOLE);
	assert_int_equal(expected.status, 200);
	program_stop(&program);
	program = program_serve(ARGUMENTS(START, CUT_PATH), NULL);
	for (int round = 0; round < 2; round++) {
		FILE *file = fopen(CUT_PATH, round ? "wb" : "r+b");
		assert_true(file && (round || fwrite(zeros, sizeof zeros, 1, file) == 1) && fclose(file) == 0);
		struct http_answer answer = http_get(program.port, WHOLE);
		assert_true(answer.status == 200 && answer.size == expected.size);
		assert_memory_equal(answer.body, expected.body, expected.size);
		http_free(&answer);
	}
	http_free(&expected);
	program_stop(&program);
}

UNIT_TEST(a_pack_in_place_cut_short_ends_it_with_advice)
{
	assert_good(sample_pack_write(CUT_PATH, &cause));
	struct program program = program_serve(ARGUMENTS("--in-place", START, CUT_PATH), NULL);
	assert_int_equal(truncate(CUT_PATH, 0), 0);
	int fd = http_connect(program.port);
	assert_true(http_send(fd, whole_request, sizeof whole_request - 1));
	assert_int_equal(program_finish(&program), 1);
	assert_non_null(strstr(program.err, "a pack was cut short"));
	close(fd);
}

UNIT_MAIN(prepare, NULL)
