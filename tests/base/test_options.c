/* Command lines: what is read, what is refused and how that is said, and that no line of a help is too long.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/options.h"
#include "tests/support/cases.h"
#include "tests/support/unit_test.h"

static struct {
	const char *scene, *pack;
	struct eco_inputs others;
	uint64_t jobs, vertices, memory;
	double pace, at[3];
	uint32_t size[2];
	int order;
	bool json, quiet, at_given;
	char read[32];
} given;

static enum eco_code read_some(const char *text, void *value, struct eco_error *error)
{
	if (text && strcmp(text, "bad") == 0)
		return eco_fail(error, ECO_BAD_USAGE, "--some bad: cannot be");
	snprintf(value, sizeof given.read, "%s", text ? text : "nothing");
	return ECO_OK;
}

static const char *const orders[] = { "greedy", "stochastic", NULL };

static const struct eco_option table[] = {
	{ "the scene file", 0, ECO_OPTION_INPUT, "SCENE.json", &given.scene, .is_required = true },
	{ "another", 0, ECO_OPTION_INPUTS, "MORE", &given.others, .high = 2, .help = "more of them" },
	{ .help = "What is written" },
	{ "output", 'o', ECO_OPTION_TEXT, "OUT.eco", &given.pack, .help = "the pack", .is_required = true },
	{ "jobs", 'j', ECO_OPTION_COUNT, "N", &given.jobs, 1, 64, .help = "threads" },
	{ "vertices", 0, ECO_OPTION_COUNT, "N", &given.vertices, 0, INT64_MAX, .help = "budget" },
	{ "memory", 0, ECO_OPTION_BYTES, "SIZE", &given.memory, 65536, 1ull << 40, .help = "held" },
	{ "pace", 0, ECO_OPTION_NUMBER, "M", &given.pace, 0.001, 10,
		.help = "metres a second, of which there may be so many that this must be "
		"said in two lines of text" },
	{ "at", 0, ECO_OPTION_NUMBERS, "X,Y,Z", given.at, -10, 10, .count = 3, .given = &given.at_given,
		.help = "where" },
	{ "size", 0, ECO_OPTION_SIZE, "WxH", given.size, 1, 4096, .help = "of pictures" },
	{ "order", 0, ECO_OPTION_CHOICE, "NAME", &given.order, .choices = orders, .help = "of leaves" },
	{ "some-option-with-a-name-that-is-long", 0, ECO_OPTION_READ, "X", given.read, .read = read_some,
		.help = "anything",
		.has_optional_value = true },
	{ "json", 0, ECO_OPTION_FLAG, NULL, &given.json, .help = "for scripts" }, { 0 } };

static const struct eco_option common[] =
	{ { "quiet", 'q', ECO_OPTION_FLAG, NULL, &given.quiet, .help = "no progress" }, { 0 } };

static const struct eco_command command = { .name = "program do", .synopsis = "SCENE.json -o OUT.eco "
	"[--jobs N] [--pace M] [--at X,Y,Z] "
	"[--size WxH] [--order NAME] [--json]", .says = "Does this and that.", .options = table,
	.common = common, .notes = "A note.\n" };

static enum eco_code read_line(const char *line, struct eco_error *error)
{
	static char text[512];
	static char *argv[32];
	int argc = 0;
	snprintf(text, sizeof text, "%s", line);
	for (char *word = strtok(text, " "); word && argc < 32; word = strtok(NULL, " "))
		argv[argc++] = word;
	memset(&given, 0, sizeof given);
	*error = (struct eco_error){ 0 };
	return eco_command_read(&command, argc, argv, error);
}

UNIT_TEST(options_may_stand_anywhere_and_in_four_forms)
{
	static const char *const lines[] = { "a.json -o b.eco --jobs 3", "-j3 -ob.eco a.json",
		"--jobs=3 a.json --output=b.eco",
		"--jobs 9 -j 3 --output b.eco -- a.json" };
	struct eco_error error;
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
		assert_int_equal(read_line(lines[i], &error), ECO_OK);
		assert_string_equal(given.scene, "a.json");
		assert_string_equal(given.pack, "b.eco");
		assert_int_equal(given.jobs, 3);
		assert_false(given.json || given.quiet || given.at_given);
	}
}

UNIT_TEST(every_kind_of_value_arrives)
{
	struct eco_error error;
	assert_int_equal(read_line("a -o b c -q --pace 2.5 --at -1,2,3e0 --size 640x480 d --order "
		"stochastic --json", &error), ECO_OK);
	assert_true(given.pace == 2.5 && given.at[0] == -1 && given.at[1] == 2 && given.at[2] == 3
		&& given.at_given);
	assert_true(given.size[0] == 640 && given.size[1] == 480 && given.order == 1 && given.json
		&& given.quiet);
	assert_int_equal(given.others.count, 2);
	assert_string_equal(given.others.names[0], "c");
	assert_string_equal(given.others.names[1], "d");
	assert_int_equal(read_line("a -o b --some-option-with-a-name-that-is-long -", &error), ECO_OK);
	assert_string_equal(given.read, "nothing");
	assert_string_equal(given.others.names[0], "-");
	assert_int_equal(read_line("a -o b --some-option-with-a-name-that-is-long=x", &error), ECO_OK);
	assert_string_equal(given.read, "x");
	assert_int_equal(read_line("-o b -- --json", &error), ECO_OK);
	assert_string_equal(given.scene, "--json");
}

struct fault { const char *line, *says; };

UNIT_TEST(what_does_not_fit_is_named)
{
	struct eco_error error;
	uint32_t count;
	const struct fault *rows = cases_read("tests/base/cases/option_faults.tsv", sizeof *rows, &count);
	for (uint32_t i = 0; i < count; i++) {
		assert_int_equal(read_line(rows[i].line, &error), ECO_BAD_USAGE);
		if (!strstr(error.text, rows[i].says))
			fail_msg("'%s' says: %s", rows[i].line, error.text);
	}
}

UNIT_TEST(numbers_are_read_whole_or_refused)
{
	uint32_t count;
	const char *const *bad = cases_read("tests/base/cases/option_numbers.tsv", sizeof *bad, &count);
	struct eco_error error;
	char line[64];
	for (size_t i = 0; i < count; i++) {
		snprintf(line, sizeof line, "a -o b --%s", bad[i]);
		if (read_line(line, &error) != ECO_BAD_USAGE)
			fail_msg("%s is taken", line);
	}
	assert_int_equal(read_line("a -o b --size 4096x1 --pace 0.5 --vertices 9223372036854775807", &error),
		ECO_OK);
	assert_true(given.size[0] == 4096 && given.size[1] == 1 && given.pace == 0.5
		&& given.vertices == INT64_MAX);
}

UNIT_TEST(help_names_everything_within_its_columns)
{
	char *text = NULL;
	size_t size;
	FILE *out = open_memstream(&text, &size);
	eco_command_help(&command, out);
	fclose(out);
	assert_int_equal(strncmp(text, "usage: program do SCENE.json -o OUT.eco", 39), 0);
	static const char *const parts[] = { "\nDoes this and that.\n", "\n  MORE                  more of "
		"them\n", "\nWhat is written\n", "\n  -o, --output OUT.eco  the pack\n",
		"[=X]\n                        anything\n", "\n  -q, --quiet",
		"\n  -h, --help", "\n  -V, --version", "\nA note.\nNumbers may end with k, M or G", "\nExit status: 0" };
	for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
		if (!strstr(text, parts[i]))
			fail_msg("no '%s' in:\n%s", parts[i], text);
	for (const char *line = text; *line; line += strcspn(line, "\n") + 1)
		assert_true(strcspn(line, "\n") <= ECO_HELP_COLUMNS);
	free(text);
}
