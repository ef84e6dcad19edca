/* The frame of ecobench, with sections of this file: units are done once, reports hold all results. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/bench/bench.h"
#include "tests/support/files.h"
#include "tests/support/unit_test.h"

#define ROOT "build/tmp/bench"
#define UNITS 5

/* ---- Sections ---- */

static json_t *make_square(void *ctx)
{
	int i = *(int *)ctx;
	FILE *log = fopen(ROOT "/work.log", "a");        /* in a file, as sections run in a child */
	fprintf(log, "%d\n", i);
	fclose(log);
	return json_pack("{s:f}", "square", (double)i * i);
}

static void run_tiny(struct bench *bench)
{
	struct bench_table *table = bench_table_open(bench, "tiny", "unit,square", true);
	double sum = 0;
	for (int i = 0; i < UNITS; i++) {
		char unit[32];
		snprintf(unit, sizeof unit, "tiny %d", i);
		bench_progress(i / (double)UNITS, unit);
		const json_t *result = bench_unit(bench, unit, "v1", make_square, &i);
		sum += json_number_value(json_object_get(result, "square"));
		bench_table_row(table, "%d,%g", i, json_number_value(json_object_get(result, "square")));
	}
	bench_table_close(table);
	bench_say(bench, "Squares <of> %d & more \"numbers\"", UNITS);
	bench_key(bench, "tiny_sum", sum, "<= 30");
}

static const struct { const char *key, *bar; double value; int reached; } bars[] = { { "more", ">= 3", 2, 0 },
	{ "percent", "at most 5 %", 0.049, 1 }, { "unicode", "\xe2\x89\xa5 76 %", 0.76, 1 }, { "exact", "0",
	0, 1 },
	{ "thousands", "100,000 with FULL=1", 100000, 1 }, { "unmeasured", "<= 1", NAN, 0 },
	{ "shown", "shown", 7, -1 } };
#define BARS (sizeof bars / sizeof *bars)

static void run_keys(struct bench *bench)
{
	for (size_t i = 0; i < BARS; i++)
		bench_key(bench, bars[i].key, bars[i].value, bars[i].bar);
	bench_left_out(bench, "palms");
	bench_left_out(bench, "city");
	bench_left_out(bench, "palms");
}

static void run_failing(struct bench *bench)
{
	bench_say(bench, "before it fails");
	must(ECO_OK);
	must(eco_fail(must_error, ECO_BAD_INPUT, "this section fails <always>"));
	bench_say(bench, "after it fails");
}

static void run_plots(struct bench *bench)
{
	static const double x[] = { 1, 10, NAN, 1000, 1e6 }, y[] = { 0.5, 0, 0.2, -1, NAN };
	static const uint8_t rgb[2 * 3 * 3];
	const struct bench_series series[] = { { "line", x, y, 5, false }, { "points", x, y, 5, true },
		{ "none", x, y, 0, false } };
	bench_plot(bench, &(struct bench_plot){ "lines", "A title", "x", "y", false, false, series, 3 });
	bench_plot(bench, &(struct bench_plot){ "logs", "A title", "x", "y", true, true, series, 3 });
	bench_plot(bench, &(struct bench_plot){ "empty", "Nothing", "x", "y", true, true, series, 0 });
	bench_picture(bench, "picture.png", "black");
	bench_picture_write(bench, "picture.png", 3, 2, rgb);
}

/* The second one fails. */
static void run_commands(struct bench *bench)
{
	bench_command("exit %d", 0);
	bench_say(bench, "before exit 3");
	bench_command("exit %d", 3);
}

static const struct bench_section tiny = { .name = "tiny", .title = "Squares", .run = run_tiny },
	keys = { .name = "keys", .title = "Keys", .run = run_keys },
	failing = { .name = "failing", .title = "Fails", .run = run_failing },
	plots = { .name = "plots", .title = "Plots", .run = run_plots },
	commands = { .name = "commands", .title = "Commands", .run = run_commands };
static const struct bench_section *const all[] = { &tiny, &keys, &failing, &plots, &commands, NULL };

/* ---- Running ---- */

/* ecobench in a child, its folders below ROOT; exit status. */
static int run(const char *const arguments[])
{
	char *argv[24] = { "ecobench" };
	int argc = 1, status;
	while (*arguments)
		argv[argc++] = (char *)(uintptr_t)*arguments++;
	fflush(NULL);
	pid_t child = fork();
	if (child == 0) {
		if (!freopen(ROOT "/stdout", "w", stdout) || !freopen(ROOT "/stderr", "w", stderr))
			_exit(99);
		int code = bench_main(argc, argv, all);
		fflush(NULL);
		_exit(code);
	}
	assert_int_equal(waitpid(child, &status, 0), child);
	assert_true(WIFEXITED(status));
	return WEXITSTATUS(status);
}

#define RUN(...) run((const char *const[]){ "--build", ROOT "/programs", "--out", ROOT "/out", __VA_ARGS__, \
	NULL })

static bool says(const char *name, const char *what)
{
	char path[256];
	size_t size;
	snprintf(path, sizeof path, ROOT "/%s", name);
	char *text = (char *)file_read(path, &size);
	bool found = strstr(text, what);
	free(text);
	return found;
}

static int units_done(void)
{
	size_t size;
	char *text = (char *)file_read(ROOT "/work.log", &size);
	int count = 0;
	for (const char *c = text; *c; c++)
		count += *c == '\n';
	free(text);
	return count;
}

static int set_up(void **state)
{
	return system("rm -rf " ROOT " && mkdir -p " ROOT "/programs && cp /bin/true " ROOT
		"/programs/ecopack && : >" ROOT "/work.log") != 0;
}

/* ---- Tests ---- */

UNIT_TEST_BETWEEN(test_command_line_is_checked, set_up, NULL)
{
	static const struct { const char *argument, *value; int status; const char *says; } cases[] = {
		{ "--help", NULL, 0, "--full" }, { "--list", NULL, 0, "Squares" }, { "--nonsense", NULL, 2, ""
			},
		{ "--only", "none", 2, "no section is called none" },
		{ "--only", "tiny,non", 2, "no section is called non" },
		{ "--only", "tin", 2, "no section is called tin" },
		{ "--data", ROOT "/nowhere", 2, "holds models/" },
		{ "--build", ROOT "/nowhere", 2, "ecopack is not there" },
		{ "--out", "/dev/null/x", 1, "this fails: mkdir" }, { "word", NULL, 2, "word" } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		int status = RUN(cases[i].argument, cases[i].value);
		if (status != cases[i].status || !says(status ? "stderr" : "stdout", cases[i].says))
			fail_msg("%s %s: status %d", cases[i].argument, cases[i].value ? cases[i].value : "",
				status);
	}
	assert_int_equal(units_done(), 0);
}

/* Units are kept, but damaged ones and those of another program are done anew. */
UNIT_TEST_BETWEEN(test_a_run_leaves_tables_report_and_summary, set_up, NULL)
{
	static const char *const damages[] = { "true", "truncate -s 9", "sed -i s/result/resalt/",
		"sed -i 's/, v1, ..../, v1, zzzz/'" };
	for (int i = 0; i < 4; i++) {
		char command[256];
		assert_int_equal(RUN("--only", "tiny"), 0);
		assert_int_equal(units_done(), i ? UNITS + i - 1 : UNITS);
		snprintf(command, sizeof command, "%s \"$(grep -l 'tiny 3' " ROOT "/out/cache/units/*)\"",
			damages[i]);
		assert_int_equal(system(command), 0);
	}
	assert_true(says("out/tiny.csv", "unit,square\n0,0\n1,1\n2,4\n3,9\n4,16\n"));
	assert_true(says("out/report.html",
		"<th class=\"n\">unit<th class=\"n\">square<tr><td class=\"n\">0<td"));
	assert_true(says("out/report.html", "Squares &lt;of&gt; 5 &amp; more &quot;numbers&quot;"));
	assert_true(says("out/summary.json", "\"tiny_sum\": 30"));
}

UNIT_TEST_BETWEEN(test_a_failure_does_not_end_the_run, set_up, NULL)
{
	assert_int_equal(RUN("--only", "tiny,keys,failing,plots,commands"), 1);
	assert_true(says("out/report.html", "this section fails &lt;always&gt;"));
	assert_true(says("out/report.html", "before it fails"));
	assert_false(says("out/report.html", "after it fails"));
	assert_true(says("out/report.html", "before exit 3") && says("out/report.html", "this fails: exit 3"));
	assert_true(says("out/report.html", "Left out without FULL=1: palms, city."));
	assert_true(says("out/report.html", "src=\"picture.png\""));
	assert_true(says("stderr", "python3-matplotlib") || (says("out/report.html", "src=\"logs.png\"") &&
		says("out/report.html", "src=\"lines.png\"") && says("out/report.html",
		"src=\"empty.png\"")));
	assert_int_equal(RUN("--list"), 0);
	assert_true(says("stdout", "failed"));
	json_t *summary = json_load_file(ROOT "/out/summary.json", 0, NULL), *reached = json_object_get(summary,
		"reached");
	for (size_t i = 0; i < BARS; i++) {
		json_t *value = json_object_get(reached, bars[i].key);
		if (!value || (json_is_true(value) ? 1 : json_is_false(value) ? 0 : -1) != bars[i].reached)
			fail_msg("%s", bars[i].key);
	}
	assert_true(json_is_null(json_object_get(summary, "unmeasured")));
	json_decref(summary);
}
