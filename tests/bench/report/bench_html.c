#include "tests/bench/report/bench_html.h"

#include <stdbool.h>
#include <string.h>

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

void bench_html_text(FILE *out, const char *text)
{
	escape(out, text ? text : "", text ? strlen(text) : 0);
}

const char bench_html_style[] =
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

#define ROWS_OPEN 32u            /* longer tables are folded */

static void print_table(FILE *out, const json_t *item)
{
	const char *name = json_string_value(json_object_get(item, "name"));
	json_t *rows = json_object_get(item, "rows"), *row;
	size_t i;
	if (!json_is_true(json_object_get(item, "show"))) {
		fputs("<p class=\"soft\">Table: <a href=\"", out);
		bench_html_text(out, name);
		fputs(".csv\">", out);
		bench_html_text(out, name);
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
	bench_html_text(out, name);
	fputs(".csv\">", out);
	bench_html_text(out, name);
	fputs(".csv</a></small></p>\n", out);
}

void bench_html_item(FILE *out, const json_t *item)
{
	const char *kind = json_string_value(json_object_get(item, "kind"));
	if (!kind)
		return;
	if (!strcmp(kind, "table"))
		print_table(out, item);
	else if (!strcmp(kind, "picture")) {
		fputs("<figure><img loading=\"lazy\" src=\"", out);
		bench_html_text(out, json_string_value(json_object_get(item, "file")));
		fputs("\" alt=\"", out);
		bench_html_text(out, json_string_value(json_object_get(item, "caption")));
		fputs("\"><figcaption>", out);
		bench_html_text(out, json_string_value(json_object_get(item, "caption")));
		fputs("</figcaption></figure>\n", out);
	} else {
		const char *tag = strcmp(kind, "head") ? "p" : "h3";
		fprintf(out, "<%s>", tag);
		bench_html_text(out, json_string_value(json_object_get(item, "text")));
		fprintf(out, "</%s>\n", tag);
	}
}
