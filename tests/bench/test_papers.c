/* papers.html: what stands beside what, and that papers.json names sections, tables and pictures that there
 * are. */
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/report/bench_papers.h"
#include "tests/bench/bench_state.h"
#include "tests/support/files.h"
#include "tests/support/scratch.h"
#include "tests/support/unit_test.h"

static char *page;

static int open_folder(void **state)
{
	scratch_open("papers");
	return 0;
}

static int close_folder(void **state)
{
	free(page);
	page = NULL;
	scratch_remove(scratch_root);
	return 0;
}

/* How many names match nothing. */
static uint32_t write_page(const char *papers, const char *records)
{
	struct eco_error error = { 0 };
	uint32_t missing = 77;
	struct bench bench = { .out = scratch_root };
	json_t *parsed[2] = { json_loads(papers, 0, NULL), json_loads(records, 0, NULL) };
	assert_non_null(parsed[0]);
	assert_non_null(parsed[1]);
	assert_ok(bench_papers_write(&bench, parsed[0], parsed[1], &missing, &error), error);
	json_decref(parsed[0]);
	json_decref(parsed[1]);
	free(page);
	size_t size;
	page = (char *)file_read(in_root("papers.html"), &size);
	assert_non_null(page);
	return missing;
}

#define ENTRY(show) "[{\"paper\":\"Lee <2007>\",\"title\":\"Trees\",\"entries\":[{\"figure\":\"Table I\"," \
	"\"says\":\"Wrong pixels\",\"section\":\"lee\",\"why\":\"Other trees\",\"show\":" show "}]}]"
#define RECORD "[{\"name\":\"lee\",\"state\":\"done\",\"full\":true,\"items\":[" \
	"{\"kind\":\"table\",\"name\":\"wrong\",\"columns\":\"a,b\",\"rows\":[\"1,2\"],\"show\":false}," \
	"{\"kind\":\"table\",\"name\":\"other\",\"columns\":\"c\",\"rows\":[\"3\"],\"show\":true}," \
	"{\"kind\":\"picture\",\"file\":\"tree-1.png\",\"caption\":\"one\"}," \
	"{\"kind\":\"picture\",\"file\":\"tree-2.png\",\"caption\":\"two\"}]}]"

UNIT_TEST(an_entry_shows_what_it_names_and_nothing_else)
{
	assert_int_equal(write_page(ENTRY("[\"wrong\", \"tree-2\"]"), RECORD), 0);
	assert_non_null(strstr(page, "Lee &lt;2007&gt;"));
	assert_non_null(strstr(page, "<h3>Table I</h3>"));
	assert_non_null(strstr(page, "Wrong pixels."));
	assert_non_null(strstr(page, "Other trees"));
	/* though the report leaves it to its file */
	assert_non_null(strstr(page, "<td class=\"n\">1<td class=\"n\">2"));
	assert_non_null(strstr(page, "tree-2.png"));
	assert_null(strstr(page, "other.csv"));
	assert_null(strstr(page, "tree-1.png"));
}

UNIT_TEST(patterns_show_all_that_match)
{
	assert_int_equal(write_page(ENTRY("[\"tree-*.png\"]"), RECORD), 0);
	assert_non_null(strstr(page, "tree-1.png"));
	assert_non_null(strstr(page, "tree-2.png"));
}

UNIT_TEST(a_section_that_was_not_run_is_named)
{
	assert_int_equal(write_page(ENTRY("[\"wrong\"]"), "[]"), 0);
	assert_non_null(strstr(page, "make bench ONLY=lee"));
	assert_non_null(strstr(page, "Other trees"));
}

UNIT_TEST(what_quick_runs_leave_out_is_told_from_what_was_not_run)
{
	write_page(ENTRY("[\"gone\"]"),
		"[{\"name\":\"lee\",\"state\":\"done\",\"full\":false,\"items\":[]}]");
	assert_non_null(strstr(page, "Left out of quick runs: <code>make bench FULL=1 ONLY=lee"));
	write_page(ENTRY("[\"gone\"]"),
		"[{\"name\":\"lee\",\"state\":\"failed\",\"full\":false,\"items\":[]}]");
	assert_non_null(strstr(page, "Not run yet: <code>make bench ONLY=lee"));
}

UNIT_TEST(a_name_that_a_whole_section_has_not_is_counted)
{
	assert_int_equal(write_page(ENTRY("[\"wrong\", \"gone\"]"), RECORD), 1);
	assert_int_equal(write_page(ENTRY("[\"gone\"]"),
		"[{\"name\":\"lee\",\"state\":\"interrupted\",\"full\":true,\"items\":[]}]"), 0);
	assert_int_equal(write_page(ENTRY("[\"gone\"]"), /* a quick run may leave things out */
		"[{\"name\":\"lee\",\"state\":\"done\",\"full\":false,\"items\":[]}]"), 0);
}

/* ---- papers.json ---- */

/* All sources of ecobench, one after the other. */
static char *sources(void)
{
	glob_t found;
	char *all = calloc(1, 1);
	size_t length = 0;
	assert_int_equal(glob("tests/bench/*.c", 0, NULL, &found), 0);
	glob("tests/bench/*/*.c", GLOB_APPEND, NULL, &found);
	for (size_t i = 0; i < found.gl_pathc; i++) {
		size_t size;
		char *text = (char *)file_read(found.gl_pathv[i], &size);
		all = realloc(all, length + size + 1);
		memcpy(all + length, text, size);
		all[length += size] = 0;
		free(text);
	}
	globfree(&found);
	return all;
}

/* A string that is it; of a pattern, one that begins as it does, as such names are made of formats. */
static bool has_string(const char *all, const char *name)
{
	char quoted[128];
	bool pattern = strpbrk(name, "*?");
	size_t fixed = strcspn(name, pattern ? "-*?" : ".");
	snprintf(quoted, sizeof quoted, "\"%.*s%s", (int)fixed, name, name[fixed] ? "" : "\"");
	return strstr(all, quoted);
}

UNIT_TEST(every_entry_names_a_section_with_such_tables_and_pictures)
{
	json_t *papers = bench_json_read("tests/bench/report/papers.json"), *paper, *entry, *name;
	char *all = sources();
	size_t i, k, n, entries = 0;
	assert_non_null(papers);
	json_array_foreach(papers, i, paper)
		json_array_foreach(json_object_get(paper, "entries"), k, entry) {
			static const char *const keys[] = { "figure", "says", "section", "why" };
			char declared[96];
			for (int w = 0; w < 4; w++)
				assert_true(json_string_length(json_object_get(entry, keys[w])) > 0);
			snprintf(declared, sizeof declared, "const struct bench_section bench_%s =",
				json_string_value(json_object_get(entry, "section")));
			assert_non_null(strstr(all, declared));
			assert_true(json_array_size(json_object_get(entry, "show")) > 0);
			json_array_foreach(json_object_get(entry, "show"), n, name) {
				if (!has_string(all, json_string_value(name)))
					fail_msg("no source of ecobench makes %s", json_string_value(name));
			}
			entries++;
		}
	assert_true(entries > 20);
	free(all);
	json_decref(papers);
}

UNIT_TEST(figures_that_ours_does_not_show_are_said_to_be_missing)
{
	json_t *papers = bench_json_read("tests/bench/report/papers.json"), *paper, *entry;
	size_t i, k, found = 0;
	json_array_foreach(papers, i, paper)
		json_array_foreach(json_object_get(paper, "entries"), k, entry)
			if (!strcmp(json_string_value(json_object_get(entry, "figure")), "Figures 9 and 10")) {
				assert_non_null(strstr(json_string_value(json_object_get(entry, "says")),
					"Not shown: "));
				assert_non_null(strstr(json_string_value(json_object_get(entry, "why")),
					"no instance has a tint"));
				found++;
			}
	assert_int_equal(found, 1);
	json_decref(papers);
}

int main(void)
{
	return unit_tests_run(open_folder, close_folder);
}
