/* report.html for people and summary.json for programs, from the records that the sections left.
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

/* ---- HTML ---- */

static void escape(FILE *out, const char *text, size_t size)
{
	for (size_t i = 0; i < size && text[i]; i++)
		switch (text[i]) {
		case '<': fputs("&lt;", out); break;
		case '>': fputs("&gt;", out); break;
		case '&': fputs("&amp;", out); break;
		case '"': fputs("&quot;", out); break;
		default: fputc(text[i], out);
		}
}

static void escape_all(FILE *out, const char *text)
{
	escape(out, text ? text : "", text ? strlen(text) : 0);
}

static const char style[] =
	":root{color-scheme:light "
	"dark;--ink:#22261f;--soft:#667;--line:#ddd9cf;--page:#fbfaf6;--card:#fff;"
	"--good:#19703a;--bad:#a8322a}\n"
	"@media(prefers-color-scheme:dark){:root{--ink:#e6e4dc;--soft:#9aa;--line:#3a3d38;--page:#181a17;"
	"--card:#20231f;--good:#6cc98a;--bad:#f08a80}}\n"
	"*{box-sizing:border-box}body{font:16px/1.55 system-ui,sans-serif;margin:0 "
	"auto;max-width:62rem;padding:1rem;color:var(--ink);background:var(--page)}\n"
	"h1{font-size:1.6rem;line-height:1.2;margin:.6rem 0}h2{font-size:1.2rem;margin:2.4rem 0 "
	".4rem;padding-top:.8rem;border-top:1px solid var(--line)}\n"
	"h3{font-size:1.02rem;margin:1.6rem 0 .3rem}p{margin:.6rem "
	"0;max-width:46rem}small,.soft{color:var(--soft)}a{color:inherit}\n"
	"nav{display:flex;flex-wrap:wrap;gap:.2rem .9rem;font-size:.9rem;margin:.8rem 0}\n"
	".wide{overflow-x:auto;margin:.7rem "
	"0}"
	"table{border-collapse:collapse;font-size:.86rem;"
	"font-variant-numeric:tabular-nums;background:var(--card)}\n"
	"th,td{padding:.22rem .65rem;border-bottom:1px solid "
	"var(--line);text-align:left;white-space:nowrap}"
	"th{font-weight:600;vertical-align:bottom;white-space:normal}\n"
	"td.n,th.n{text-align:right}.good{color:var(--good);font-weight:600}"
	".bad{color:var(--bad);font-weight:600}\n"
	"figure{margin:1rem "
	"0}img{max-width:100%;height:auto;display:block;border-radius:4px;background:#fff}"
	"figcaption{font-size:.86rem;color:var(--soft);margin-top:.3rem}\n"
	"details{margin:.7rem "
	"0}summary{cursor:pointer;color:var(--soft);font-size:.9rem}.note{border-left:3px solid "
	"var(--bad);padding-left:.7rem}\n";

static bool looks_like_number(const char *cell, size_t size)
{
	bool digit = false;
	for (size_t i = 0; i < size; i++) {
		digit |= cell[i] >= '0' && cell[i] <= '9';
		if (!strchr("0123456789.+-eE% x", cell[i]))
			return false;
	}
	return digit || size == 0 || (size == 1 && *cell == '-');
}

static bool is_nan(const char *cell, size_t size)
{
	return (size == 3 && !strncmp(cell, "nan", 3)) || (size == 4 && !strncmp(cell, "-nan", 4));
}

/* Start of the cell after this one, or NULL. */
static const char *next_cell(const char *at)
{
	at += strcspn(at, ",");
	return *at ? at + 1 : NULL;
}

static void print_cells(FILE *out, const char *line)
{
	for (const char *at = line; at; at = next_cell(at)) {
		size_t size = strcspn(at, ",");
		bool none = is_nan(at, size);
		fputs(none || looks_like_number(at, size) ? "<td class=\"n\">" : "<td>", out);
		if (none)
			fputs("\xe2\x80\x93", out);
		else
			escape(out, at, size);
	}
}

/* Names of columns, those of numbers above their numbers. `row`: one of the table, or NULL. */
static void print_names(FILE *out, const char *columns, const char *row)
{
	for (const char *at = columns; at; at = next_cell(at)) {
		size_t size = row ? strcspn(row, ",") : 0;
		fputs(row && (is_nan(row, size) || looks_like_number(row, size)) ? "<th class=\"n\">"
			: "<th>", out);
		escape(out, at, strcspn(at, ","));
		row = row ? next_cell(row) : NULL;
	}
}

#define ROWS_OPEN 24u            /* longer tables are folded */

static void print_table(FILE *out, const json_t *item)
{
	const char *name = json_string_value(json_object_get(item, "name"));
	json_t *rows = json_object_get(item, "rows"), *row;
	size_t i;
	if (!json_is_true(json_object_get(item, "show"))) {
		fputs("<p class=\"soft\">Table: <a href=\"", out);
		escape_all(out, name);
		fputs(".csv\">", out);
		escape_all(out, name);
		fputs(".csv</a></p>\n", out);
		return;
	}
	bool folded = json_array_size(rows) > ROWS_OPEN;
	if (folded)
		fprintf(out, "<details><summary>%zu rows</summary>", json_array_size(rows));
	fputs("<div class=\"wide\"><table><tr>", out);
	print_names(out, json_string_value(json_object_get(item, "columns")),
		json_string_value(json_array_get(rows, 0)));
	json_array_foreach(rows, i, row) {
		fputs("<tr>", out);
		print_cells(out, json_string_value(row));
	}
	fputs("</table></div>", out);
	if (folded)
		fputs("</details>", out);
	fputs("<p class=\"soft\"><small>As a file: <a href=\"", out);
	escape_all(out, name);
	fputs(".csv\">", out);
	escape_all(out, name);
	fputs(".csv</a></small></p>\n", out);
}

static void print_item(FILE *out, const json_t *item)
{
	const char *kind = json_string_value(json_object_get(item, "kind"));
	if (!kind)
		return;
	if (!strcmp(kind, "table"))
		print_table(out, item);
	else if (!strcmp(kind, "picture")) {
		fputs("<figure><img loading=\"lazy\" src=\"", out);
		escape_all(out, json_string_value(json_object_get(item, "file")));
		fputs("\" alt=\"", out);
		escape_all(out, json_string_value(json_object_get(item, "caption")));
		fputs("\"><figcaption>", out);
		escape_all(out, json_string_value(json_object_get(item, "caption")));
		fputs("</figcaption></figure>\n", out);
	} else {
		const char *tag = strcmp(kind, "head") ? "p" : "h3";
		fprintf(out, "<%s>", tag);
		escape_all(out, json_string_value(json_object_get(item, "text")));
		fprintf(out, "</%s>\n", tag);
	}
}

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
	escape_all(out, json_string_value(json_object_get(key, "key")));
	fputs("<td class=\"n\">", out);
	print_figure(out, json_object_get(key, "value"));
	fputs("<td>", out);
	escape_all(out, json_string_value(json_object_get(key, "bar")));
	fputs(json_is_true(reached) ? "<td class=\"good\">met" : json_is_false(reached)
		? "<td class=\"bad\">not met" : "<td>", out);
	fputs("<td><a href=\"#", out);
	escape_all(out, section);
	fputs("\">", out);
	escape_all(out, section);
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
	escape_all(out, name);
	fputs("\">", out);
	escape_all(out, json_string_value(json_object_get(record, "title")));
	fputs("</h2>\n", out);
	if (state && strcmp(state, "done")) {
		fprintf(out, "<p class=\"note\">This section is not complete (%s)", state);
		if (why && strcmp(why, state)) {
			fputs(": ", out);
			escape_all(out, why);
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
		print_item(out, item);
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
		style);
	fprintf(out, "<p>%s run, %s, ", bench->full ? "Full" : "Quick",
		json_string_value(json_object_get(machine, "when")));
	escape_all(out, json_string_value(json_object_get(machine, "processor")));
	fprintf(out, ", %d cores. ", (int)json_integer_value(json_object_get(machine, "cores")));
	fputs("Vertices are points + 2 \xc2\xb7 lines + 3 \xc2\xb7 triangles, instances counted. P = "
		"tp/(tp+fp) and R = tp/(tp+fn) over covered pixels; "
		"Q = 1 \xe2\x88\x92 \xe2\x88\x9a((1\xe2\x88\x92P)\xc2\xb2 + (1\xe2\x88\x92R)\xc2\xb2); "
		"skill is what is won over a plain card that covers every pixel; "
		"owner_q counts only pixels that show the right plant.</p>\n<nav><a href=\"#bars\">Figures "
		"and bars</a>", out);
	json_array_foreach(records, i, record) {
		fputs("<a href=\"#", out);
		escape_all(out, json_string_value(json_object_get(record, "name")));
		fputs("\">", out);
		escape_all(out, json_string_value(json_object_get(record, "title")));
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
