/* report.html and papers.html for people and summary.json for programs, from the records that the sections
 * left.
 *
 * summary.json: every key at the top with its figure (null where it could not be reached), and beside them
 * "bars": what each should be, "reached": whether it is, "about": when, where and how. The report is one page
 * without scripts; pictures lie beside it. */
#include "tests/bench/bench_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "tests/bench/report/bench_html.h"
#include "tests/bench/report/bench_papers.h"

#define PATH 1024

/* ---- Bars ---- */

/* "<= 0.01", ">= 65 %", "at most 5 %", "0", "100,000 with FULL=1": what a figure must be, as far as words
 * tell. */
struct bar { enum { BAR_NONE, BAR_MOST, BAR_LEAST, BAR_EXACT } kind; double value; };

static struct bar bar_read(const char *words)
{
	static const struct { const char *word; int kind; } leads[] =
		{ { "<=", BAR_MOST }, { "\xe2\x89\xa4", BAR_MOST }, { "at most", BAR_MOST },
		{ ">=", BAR_LEAST }, { "\xe2\x89\xa5", BAR_LEAST }, { "at least", BAR_LEAST } };
	struct bar bar = { BAR_EXACT, 0 };
	char digits[64];
	size_t n = 0;
	while (*words == ' ')
		words++;
	for (size_t i = 0; i < sizeof leads / sizeof *leads; i++)
		if (!strncmp(words, leads[i].word, strlen(leads[i].word))) {
			bar.kind = leads[i].kind;
			words += strlen(leads[i].word);
			break;
		}
	while (*words == ' ')
		words++;
	for (; *words && strchr("0123456789.,", *words) && n + 1 < sizeof digits; words++)
		if (*words != ',')
			digits[n++] = *words;
	digits[n] = 0;
	if (!n)
		return (struct bar){ BAR_NONE, 0 };
	bar.value = atof(digits);
	while (*words == ' ')
		words++;
	if (*words == '%')
		bar.value /= 100;
	return bar;
}

static json_t *bar_reached(const char *words, json_t *value)
{
	struct bar bar = bar_read(words);
	double v = json_number_value(value), slack = 1e-9 * fabs(bar.value);
	if (bar.kind == BAR_NONE)
		return json_null();
	if (!json_is_number(value))
		return json_false();
	return json_boolean(bar.kind == BAR_MOST ? v <= bar.value + slack : bar.kind == BAR_LEAST
		? v >= bar.value - slack : fabs(v - bar.value) <= slack);
}

/* ---- The machine ---- */

static json_t *about(const struct bench *bench)
{
	char program[17], line[256], model[256] = "", when[64];
	time_t now = time(NULL);
	struct tm utc;
	FILE *info = fopen("/proc/cpuinfo", "r");
	while (info && fgets(line, sizeof line, info)) {
		char *colon = strncmp(line, "model name", 10) ? NULL : strchr(line, ':');
		if (colon && !*model)
			snprintf(model, sizeof model, "%.*s", (int)strcspn(colon + 2, "\n"), colon + 2);
	}
	if (info)
		fclose(info);
	gmtime_r(&now, &utc);
	strftime(when, sizeof when, "%Y-%m-%d %H:%M UTC", &utc);
	bench_objects_stamp(bench, NULL, program);
	return json_pack("{s:s, s:s, s:i, s:b, s:s, s:s*}", "when", when, "processor", model, "cores",
		(int)sysconf(_SC_NPROCESSORS_ONLN), "full", (int)bench->full, "program", program, "data",
		bench->data);
}

/* ---- The page ---- */

static void print_figure(FILE *out, const json_t *value)
{
	double v = json_number_value(value);
	if (!json_is_number(value))
		fputs("not measured", out);
	else if (v == floor(v) && fabs(v) < 1e12)
		fprintf(out, "%.0f", v);
	else
		fprintf(out, "%.4g", v);
}

static void print_key(FILE *out, const json_t *key, const json_t *reached, const char *section)
{
	fputs("<tr><td>", out);
	bench_html_text(out, json_string_value(json_object_get(key, "key")));
	fputs("<td class=\"n\">", out);
	print_figure(out, json_object_get(key, "value"));
	fputs("<td>", out);
	bench_html_text(out, json_string_value(json_object_get(key, "bar")));
	fputs(json_is_true(reached) ? "<td class=\"good\">met" : json_is_false(reached)
		? "<td class=\"bad\">not met" : "<td>", out);
	fputs("<td><a href=\"#", out);
	bench_html_text(out, section);
	fputs("\">", out);
	bench_html_text(out, section);
	fputs("</a>", out);
}

/* Those that should be something, or those that only say something. */
static void print_keys_of(FILE *out, json_t *records, bool barred)
{
	size_t i, k, met = 0, all = 0;
	json_t *record, *key;
	fprintf(out, "<div class=\"wide\"><table><tr><th>figure<th class=\"n\">measured<th>%s<th><th>section",
		barred ? "bar" : "what it is");
	json_array_foreach(records, i, record)
		json_array_foreach(json_object_get(record, "keys"), k, key) {
			const char *bar = json_string_value(json_object_get(key, "bar"));
			json_t *reached = bar_reached(bar ? bar : "", json_object_get(key, "value"));
			if (json_is_boolean(reached) == barred) {
				print_key(out, key, reached,
					json_string_value(json_object_get(record, "name")));
				met += json_is_true(reached);
				all++;
			}
			json_decref(reached);
		}
	fputs("</table></div>\n", out);
	if (barred)
		fprintf(out, "<p>%zu of %zu bars are met.</p>\n", met, all);
}

static void print_keys(FILE *out, json_t *records)
{
	size_t i, count = 0;
	json_t *record;
	fputs("<h2 id=\"bars\">Figures and bars</h2>\n", out);
	json_array_foreach(records, i, record)
		count += json_array_size(json_object_get(record, "keys"));
	if (!count) {
		fputs("<p>None yet: they come when a section is complete.</p>\n", out);
		return;
	}
	print_keys_of(out, records, true);
	fputs("<details><summary>Figures without a bar</summary>", out);
	print_keys_of(out, records, false);
	fputs("</details>\n", out);
}

/* Whether what the section is made of has changed since. */
static bool is_current(const struct bench *bench, const struct bench_section *const *sections,
	const json_t *record)
{
	const char *name = json_string_value(json_object_get(record, "name")),
		*program = json_string_value(json_object_get(record, "program"));
	char now[17];
	while (*sections && (!name || strcmp((*sections)->name, name)))
		sections++;
	if (!*sections || !program)
		return false;
	bench_objects_stamp(bench, (*sections)->objects, now);
	return !strcmp(now, program);
}

static void print_section(FILE *out, const struct bench *bench, const struct bench_section *const *sections,
	const json_t *record)
{
	const char *name = json_string_value(json_object_get(record, "name")),
		*state = json_string_value(json_object_get(record, "state"));
	const char *why = json_string_value(json_object_get(record, "why"));
	size_t i;
	json_t *item;
	fputs("<h2 id=\"", out);
	bench_html_text(out, name);
	fputs("\">", out);
	bench_html_text(out, json_string_value(json_object_get(record, "title")));
	fputs("</h2>\n", out);
	if (state && strcmp(state, "done")) {
		fprintf(out, "<p class=\"note\">This section is not complete (%s)", state);
		if (why && strcmp(why, state)) {
			fputs(": ", out);
			bench_html_text(out, why);
		}
		fputs(".</p>\n", out);
	}
	if (!is_current(bench, sections, record))
		fputs("<p class=\"note\">From an earlier build of the program: run it again for figures of "
			"this one.</p>\n", out);
	if (!json_is_true(json_object_get(record, "full")))
		fputs("<p class=\"soft\"><small>Quick run: fewer frames, plants or methods than with "
			"FULL=1.</small></p>\n", out);
	json_array_foreach(json_object_get(record, "items"), i, item)
		bench_html_item(out, item);
	fprintf(out, "<p class=\"soft\"><small>%.0f s in this run; its pieces of work took %.0f s of "
		"processor time, those of earlier runs included.</small></p>\n",
		json_number_value(json_object_get(record, "seconds")),
		json_number_value(json_object_get(record, "units_cpu_s")));
}

static void print_page(FILE *out, const struct bench *bench, const struct bench_section *const *sections,
	json_t *records, const json_t *machine)
{
	size_t i;
	json_t *record;
	fprintf(out, "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" "
		"content=\"width=device-width,initial-scale=1\">"
		"<title>ecobench</title><style>\n%s</style>\n<h1>ecobench: error against run time</h1>\n",
		bench_html_style);
	fprintf(out, "<p>%s run, %s, ", bench->full ? "Full" : "Quick",
		json_string_value(json_object_get(machine, "when")));
	bench_html_text(out, json_string_value(json_object_get(machine, "processor")));
	fprintf(out, ", %d cores. ", (int)json_integer_value(json_object_get(machine, "cores")));
	fputs("Vertices are points + 2 \xc2\xb7 lines + 3 \xc2\xb7 triangles, instances counted. P = "
		"tp/(tp+fp) and R = tp/(tp+fn) over covered pixels; "
		"Q = 1 \xe2\x88\x92 \xe2\x88\x9a((1\xe2\x88\x92P)\xc2\xb2 + (1\xe2\x88\x92R)\xc2\xb2); "
		"skill is what is won over a plain card that covers every pixel; "
		"owner_q counts only pixels that show the right plant.</p>\n<nav><a href=\"#bars\">Figures "
		"and bars</a>", out);
	json_array_foreach(records, i, record) {
		fputs("<a href=\"#", out);
		bench_html_text(out, json_string_value(json_object_get(record, "name")));
		fputs("\">", out);
		bench_html_text(out, json_string_value(json_object_get(record, "title")));
		fputs("</a>", out);
	}
	fputs("</nav>\n", out);
	if (!json_array_size(records))
		fputs("<p>No section has been run yet.</p>\n", out);
	print_keys(out, records);
	json_array_foreach(records, i, record)
		print_section(out, bench, sections, record);
	fputs("</html>\n", out);
}

/* ---- Files ---- */

static json_t *read_records(const struct bench *bench, const struct bench_section *const *sections)
{
	json_t *records = json_array();
	for (; *sections; sections++) {
		char path[PATH];
		snprintf(path, sizeof path, "%s/sections/%s.json", bench->cache, (*sections)->name);
		json_t *record = bench_json_read(path);
		const char *name = json_string_value(json_object_get(record, "name"));
		if (name && !strcmp(name, (*sections)->name)
				&& json_is_array(json_object_get(record, "items")))
			json_array_append(records, record);
		json_decref(record);
	}
	return records;
}

static json_t *summary_of(const struct bench *bench, const struct bench_section *const *sections,
	json_t *records, json_t *machine)
{
	json_t *summary = json_object(), *bars = json_object(), *reached = json_object(),
		*states = json_object(), *record, *key;
	size_t i, k;
	json_array_foreach(records, i, record) {
		bool current = is_current(bench, sections, record);
		json_object_set_new(states, json_string_value(json_object_get(record, "name")),
			json_pack("{s:O?, s:O?, s:b}", "state", json_object_get(record, "state"), "full",
			json_object_get(record, "full"), "this_program", (int)current));
		json_array_foreach(json_object_get(record, "keys"), k, key) {
			const char *name = json_string_value(json_object_get(key, "key")),
				*bar = json_string_value(json_object_get(key, "bar"));
			if (!name || !bar)
				continue;
			json_object_set(summary, name, json_object_get(key, "value"));
			json_object_set_new(bars, name, json_string(bar));
			json_object_set_new(reached, name, bar_reached(bar, json_object_get(key, "value")));
		}
	}
	json_object_set_new(summary, "bars", bars);
	json_object_set_new(summary, "reached", reached);
	json_object_set_new(summary, "sections", states);
	json_object_set(summary, "about", machine);
	return summary;
}

#define PAPERS "tests/bench/report/papers.json"

/* Not where ecobench runs elsewhere than in the source tree. */
static enum eco_code write_papers(const struct bench *bench, const json_t *records, struct eco_error *error)
{
	json_t *papers = bench_json_read(PAPERS);
	uint32_t missing = 0;
	enum eco_code code = papers ? bench_papers_write(bench, papers, records, &missing, error) : ECO_OK;
	if (missing)
		bench_note(bench, "papers.html: %u tables or pictures of " PAPERS " are in no section "
			"that is done", missing);
	json_decref(papers);
	return code;
}

enum eco_code bench_report_write(struct bench *bench, const struct bench_section *const *sections,
	struct eco_error *error)
{
	char path[PATH], *bytes = NULL;
	size_t size = 0;
	json_t *records = read_records(bench, sections), *machine = about(bench),
		*summary = summary_of(bench, sections, records, machine);
	FILE *out = open_memstream(&bytes, &size);
	enum eco_code code = out ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for the report");
	if (out) {
		print_page(out, bench, sections, records, machine);
		fclose(out);
		snprintf(path, sizeof path, "%s/report.html", bench->out);
		code = bench_file_write(path, bytes, size, error);
		free(bytes);
	}
	code = code ? code : write_papers(bench, records, error);
	char *text = json_dumps(summary, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
	snprintf(path, sizeof path, "%s/summary.json", bench->out);
	if (!code && text)
		code = bench_file_write(path, text, strlen(text), error);
	free(text);
	json_decref(summary);
	json_decref(machine);
	json_decref(records);
	return code;
}
