#include "tests/bench/report/bench_papers.h"

#include <fnmatch.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/report/bench_html.h"
#include "tests/bench/bench_state.h"

#define PICTURES_MOST 6u         /* of one pattern */

static const char *word(const json_t *object, const char *key)
{
	const char *text = json_string_value(json_object_get(object, key));
	return text ? text : "";
}

static const json_t *record_of(const json_t *records, const char *section)
{
	size_t i;
	json_t *record;
	json_array_foreach(records, i, record)
		if (!strcmp(word(record, "name"), section))
			return record;
	return NULL;
}

static bool is_named(const json_t *item, const char *pattern)
{
	const char *file = json_string_value(json_object_get(item, "file")),
		*name = file ? file : json_string_value(json_object_get(item, "name"));
	char stem[256];
	if (!name)
		return false;
	snprintf(stem, sizeof stem, "%.*s", (int)(file ? strcspn(file, ".") : strlen(name)), name);
	return !fnmatch(pattern, name, 0) || !fnmatch(pattern, stem, 0);
}

/* How many were found. */
static uint32_t print_matches(FILE *out, const json_t *record, const char *pattern)
{
	size_t i;
	json_t *item;
	uint32_t found = 0;
	json_array_foreach(json_object_get(record, "items"), i, item) {
		if (!is_named(item, pattern) || found++ >= PICTURES_MOST)
			continue;
		json_t *shown = json_copy(item);
		json_object_set_new(shown, "show", json_true());
		bench_html_item(out, shown);
		json_decref(shown);
	}
	if (found > PICTURES_MOST) {
		fprintf(out, "<p class=\"soft\"><small>%u more in <a href=\"report.html#",
			found - PICTURES_MOST);
		bench_html_text(out, word(record, "name"));
		fputs("\">the report</a>.</small></p>\n", out);
	}
	return found;
}

/* A quick run that ended may leave it out. */
static void print_absent(FILE *out, const char *section, const json_t *record)
{
	bool quick = !strcmp(word(record, "state"), "done") && !json_is_true(json_object_get(record, "full"));
	fprintf(out, "<p class=\"note\">%s: <code>make bench %sONLY=", quick ? "Left out of quick runs"
		: "Not run yet", quick ? "FULL=1 " : "");
	bench_html_text(out, section);
	fputs("</code></p>\n", out);
}

static void print_entry(FILE *out, const json_t *entry, const json_t *records, uint32_t *missing)
{
	const char *section = word(entry, "section");
	const json_t *record = record_of(records, section), *names = json_object_get(entry, "show");
	bool whole = !strcmp(word(record, "state"), "done") && json_is_true(json_object_get(record, "full"));
	fputs("<h3>", out);
	bench_html_text(out, word(entry, "figure"));
	fputs("</h3>\n<p>", out);
	bench_html_text(out, word(entry, "says"));
	fputs(".</p>\n", out);
	uint32_t found = 0;
	for (size_t i = 0; record && i < json_array_size(names); i++) {
		uint32_t of_name = print_matches(out, record, json_string_value(json_array_get(names, i)));
		found += of_name;
		*missing += whole && !of_name;
	}
	if (!found)
		print_absent(out, section, record);
	fputs("<p><strong>Why they differ.</strong> ", out);
	bench_html_text(out, word(entry, "why"));
	fputs(" <a class=\"soft\" href=\"report.html#", out);
	bench_html_text(out, section);
	fputs("\">More</a></p>\n", out);
}

static void print_page(FILE *out, const json_t *papers, const json_t *records, uint32_t *missing)
{
	size_t i, k;
	json_t *paper, *entry;
	fprintf(out, "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" "
		"content=\"width=device-width,initial-scale=1\">"
		"<title>The papers beside ecostream</title><style>\n%s</style>\n"
		"<h1>The papers beside ecostream</h1>\n<p>Each table and figure with what ours comes to, "
		"and why they differ. How it was measured stands in the "
		"<a href=\"report.html\">report</a>.</p>\n<nav>",
		bench_html_style);
	json_array_foreach(papers, i, paper) {
		fprintf(out, "<a href=\"#paper%zu\">", i);
		bench_html_text(out, word(paper, "paper"));
		fputs("</a>", out);
	}
	fputs("</nav>\n", out);
	json_array_foreach(papers, i, paper) {
		fprintf(out, "<h2 id=\"paper%zu\">", i);
		bench_html_text(out, word(paper, "paper"));
		fputs("</h2>\n<p class=\"soft\">", out);
		bench_html_text(out, word(paper, "title"));
		fputs("</p>\n", out);
		json_array_foreach(json_object_get(paper, "entries"), k, entry)
			print_entry(out, entry, records, missing);
	}
	fputs("</html>\n", out);
}

enum eco_code bench_papers_write(const struct bench *bench, const json_t *papers, const json_t *records,
	uint32_t *missing, struct eco_error *error)
{
	char path[1024], *bytes = NULL;
	size_t size = 0;
	FILE *out = open_memstream(&bytes, &size);
	*missing = 0;
	if (!out)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a page");
	print_page(out, papers, records, missing);
	fclose(out);
	snprintf(path, sizeof path, "%s/papers.html", bench->out);
	enum eco_code code = bench_file_write(path, bytes, size, error);
	free(bytes);
	return code;
}
