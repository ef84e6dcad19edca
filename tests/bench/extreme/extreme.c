/* Runs extreme cases, and makes their page of the report. */
#include "tests/bench/extreme/extreme.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "tests/bench/bench.h"

const struct extreme_kind extreme_kinds[EXTREME_KINDS] = { { "place", extreme_place }, { "camera",
	extreme_camera },
	{ "stiff", extreme_stiff }, { "geometry", extreme_geometry }, { "quantization",
	extreme_quantization },
	{ "time", extreme_time } };

/* ---- Cases ---- */

void extreme_run(const struct extreme_case *row, bool quick, struct extreme *x)
{
	*x = (struct extreme){ .made = row->made, .quick = quick };
	if (!setjmp(x->failure))
		row->run(x);
}

void extreme_say(struct extreme *x, const char *format, ...)
{
	size_t used = strlen(x->measured);
	va_list arguments;
	if (used > 0 && used + 3 < sizeof x->measured) {
		strcat(x->measured, "; ");
		used += 2;
	}
	va_start(arguments, format);
	vsnprintf(x->measured + used, sizeof x->measured - used, format, arguments);
	va_end(arguments);
}

void extreme_must(struct extreme *x, bool holds, const char *format, ...)
{
	va_list arguments;
	if (holds)
		return;
	va_start(arguments, format);
	vsnprintf(x->measured, sizeof x->measured, format, arguments);
	va_end(arguments);
	x->failed = true;
	longjmp(x->failure, 1);
}

void extreme_most(struct extreme *x, const char *what, double value, double most)
{
	extreme_must(x, value <= most, "%s: %.9g, at most %.9g", what, value, most);
}

void extreme_least(struct extreme *x, const char *what, double value, double least)
{
	extreme_must(x, value >= least, "%s: %.9g, at least %.9g", what, value, least);
}

void extreme_same(struct extreme *x, const char *what, uint64_t value, uint64_t expected)
{
	extreme_must(x, value == expected, "%s: %llu, not %llu", what, (unsigned long long)value,
		(unsigned long long)expected);
}

void extreme_good(struct extreme *x, enum eco_code code)
{
	extreme_must(x, code == ECO_OK, "%s", x->error.text);
}

/* ---- The section ---- */

/* Commas end a column. */
static const char *without_commas(const char *text, char room[400])
{
	snprintf(room, 400, "%s", text);
	for (char *c = room; *c; c++)
		*c = *c == ',' ? ';' : *c == '\n' ? ' ' : *c;
	return room;
}

static void run(struct bench *bench)
{
	struct bench_table *table = bench_table_open(bench, "extreme",
		"family,case,what must hold,measured,pass", true);
	uint32_t done = 0, failed = 0;
	for (uint32_t k = 0; k < EXTREME_KINDS; k++)
		for (const struct extreme_case *row = extreme_kinds[k].cases; row->name; row++) {
			struct extreme x;
			char name[400], must[400], measured[400];
			bench_progress((double)done++ / EXTREME_CASES, row->name);
			extreme_run(row, false, &x);
			bench_table_row(table, "%s,%s,%s,%s,%s", extreme_kinds[k].name,
				without_commas(row->name, name), without_commas(row->must, must),
				without_commas(x.measured, measured), x.failed ? "NO" : "yes");
			failed += x.failed;
		}
	bench_table_close(table);
	bench_say(bench, "%u cases, %u of them passed; none was left out.", done, done - failed);
	bench_key(bench, "extreme_cases", done, "of the table");
	bench_key(bench, "extreme_failed", failed, "<= 0: cases that do not hold");
	must(failed ? eco_fail(must_error, ECO_DAMAGED, "%u of %u extreme cases failed", failed, done) : ECO_OK);
}

const struct bench_section bench_extreme = { "extreme", "Numerical stability", run };
