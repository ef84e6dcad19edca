/* papers.html: report.py shows tables and pictures beside those of papers.json; papers.json names sections,
 * tables and pictures that exist. */
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/bench.h"
#include "tests/support/files.h"
#include "tests/support/scratch.h"
#include "tests/support/unit_test.h"

static int open_folder(void **state)
{
	scratch_open("papers");
	folder_make(in_root("sections"));
	file_write_text(in_root("run.json"),
		"{\"full\": true, \"program\": \"1\", \"data\": null, \"sections\": [\"lee\"]}");
	file_write_text(in_root("tree-1.png"), "");
	file_write_text(in_root("tree-2.png"), "");
	return 0;
}

#define RECORD(state, full) "{\"name\":\"lee\",\"title\":\"Lee\",\"program\":\"1\",\"state\":\"" state \
	"\",\"full\":" full ",\"seconds\":1,\"keys\":[],\"items\":[" \
	"{\"kind\":\"table\",\"name\":\"wrong\",\"columns\":\"a,b\",\"rows\":[\"1,2\"],\"show\":false}," \
	"{\"kind\":\"table\",\"name\":\"other\",\"columns\":\"c\",\"rows\":[\"3\"],\"show\":true}," \
	"{\"kind\":\"picture\",\"file\":\"tree-1.png\",\"caption\":\"one\"}," \
	"{\"kind\":\"picture\",\"file\":\"tree-2.png\",\"caption\":\"two\"}]}"
#define WHOLE RECORD("done", "true")

/* `says` and `hides`: strings of the page, separated by |; `missing`: whether names are told to match
 * nothing. */
static const struct { const char *show, *record, *says, *hides; bool missing; } pages[] = {
	/* a table is shown even where the report names its file only */
	{ "[\"wrong\", \"tree-2\"]", WHOLE, "Lee &lt;2007&gt;|<h3>Table I</h3>|Wrong pixels.|Other trees|"
		"<td class=\"n\">1<td class=\"n\">2|tree-2.png", "other.csv|tree-1.png", false },
	{ "[\"tree-*.png\"]", WHOLE, "tree-1.png|tree-2.png", "wrong.csv", false },
	{ "[\"wrong\"]", "", "Not run yet: <code>make bench ONLY=lee|Other trees", "wrong.csv", false },
	{ "[\"gone\"]", RECORD("done", "false"), "Left out of quick runs: <code>make bench FULL=1 ONLY=lee",
	"", false },
	{ "[\"gone\"]", RECORD("failed", "false"), "Not run yet: <code>make bench ONLY=lee", "", false },
	{ "[\"wrong\", \"gone\"]", WHOLE, "wrong.csv", "", true },
	{ "[\"gone\"]", RECORD("missing", "true"), "Not run yet", "", false },
};

/* Whether each of the words, separated by |, is in the text or not. */
static void check_words(const char *text, const char *words, bool are_there)
{
	char copy[256], *rest = copy;
	snprintf(copy, sizeof copy, "%s", words);
	for (char *word; *words && (word = strsep(&rest, "|"));)
		if ((strstr(text, word) != NULL) != are_there)
			fail_msg("%s", word);
}

UNIT_TEST(an_entry_shows_what_it_names_and_nothing_else)
{
	for (size_t i = 0; i < sizeof pages / sizeof *pages; i++) {
		char papers[512], command[512];
		size_t size;
		snprintf(papers, sizeof papers,
			"[{\"paper\":\"Lee <2007>\",\"title\":\"Trees\",\"entries\":[{"
			"\"figure\":\"Table I\",\"says\":\"Wrong "
			"pixels\",\"section\":\"lee\",\"why\":\"Other trees\"," "\"show\":%s}]}]",
			pages[i].show);
		file_write_text(in_root("papers.json"), papers);
		file_write_text(in_root("sections/lee.json"), pages[i].record);
		snprintf(command, sizeof command,
			"cd '%s' && \"$OLDPWD\"/tests/bench/report/report.py . . papers.json " "2>told",
			scratch_root);
		assert_int_equal(system(command), 0);
		char *page = (char *)file_read(in_root("papers.html"), &size);
		check_words(page, pages[i].says, true);
		check_words(page, pages[i].hides, false);
		free(page);
		char *told = (char *)file_read(in_root("told"), &size);
		assert_true(pages[i].missing == (strstr(told, "papers.json") != NULL));
		free(told);
	}
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

/* A string that is it; of a pattern, one that begins as it does; or the format that makes it of a scene's name. */
static bool has_string(const char *all, const char *name)
{
	char quoted[128], format[128];
	bool pattern = strpbrk(name, "*?");
	size_t fixed = strcspn(name, pattern ? "-*?" : ".");
	snprintf(quoted, sizeof quoted, "\"%.*s%s", (int)fixed, name, name[fixed] ? "" : "\"");
	snprintf(format, sizeof format, "\"%.*s_%%s\"", (int)strcspn(name, "_"), name);
	return strstr(all, quoted) || strstr(all, format);
}

UNIT_TEST(every_entry_names_a_section_with_such_tables_and_pictures)
{
	json_t *papers = json_load_file("tests/bench/report/papers.json", 0, NULL), *paper, *entry, *name;
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
	assert_true(entries > 15);
	free(all);
	json_decref(papers);
}

UNIT_MAIN(open_folder, scratch_close)
