/* Runs extreme cases, and makes their page of the report. */
#include "tests/bench/extreme/extreme.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "tests/bench/bench.h"

const char *const extreme_kind_names[EXTREME_KINDS] = { "place", "camera", "stiff", "geometry",
	"quantization", "time" };

/* ---- Cases ---- */

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

bool extreme_must(struct extreme *x, bool holds, const char *format, ...)
{
	char text[sizeof x->measured];
	va_list arguments;
	if (holds || x->failed)
		return holds;
	va_start(arguments, format);
	vsnprintf(text, sizeof text, format, arguments);
	va_end(arguments);
	x->failed = true;
	memcpy(x->measured, text, sizeof text);
	return false;
}

bool extreme_good(struct extreme *x, enum eco_code code, const struct eco_error *error)
{
	return extreme_must(x, code == ECO_OK, "%s", error->text);
}

uint32_t extreme_run(enum extreme_kind kind, bool quick, extreme_told *told, void *ctx)
{
	uint32_t failed = 0;
	for (const struct extreme_case *row = extreme_cases; row < extreme_cases + EXTREME_CASES; row++) {
		struct extreme x = { .made = row->made, .quick = quick };
		bool run = !quick || !row->lengthy;
		if (row->kind != kind)
			continue;
		if (run)
			row->run(&x);
		failed += x.failed;
		told(ctx, row, &x, run);
	}
	return failed;
}

/* ---- The section ---- */

static double now_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Commas end a column. */
static const char *without_commas(const char *text, char *room, size_t size)
{
	snprintf(room, size, "%s", text);
	for (char *c = room; *c; c++)
		*c = *c == ',' ? ';' : *c == '\n' ? ' ' : *c;
	return room;
}

static json_t *run_case(struct bench *bench, const struct extreme_case *row)
{
	char name[256], must[400];
	snprintf(name, sizeof name, "extreme-%s-%s", extreme_kind_names[row->kind], row->name);
	json_t *unit = bench_recall(bench, name, without_commas(row->must, must, sizeof must));
	if (unit)
		return unit;
	double from = now_s();
	struct extreme x = { .made = row->made };
	row->run(&x);
	return bench_keep(bench, name, must,
		json_pack("{s:b, s:s, s:f}", "pass", !x.failed, "measured", x.measured, "seconds",
		now_s() - from));
}

static bool tell_case(struct bench_table *table, const struct extreme_case *row, json_t *unit)
{
	char name[200], must[400], measured[400];
	bool pass = json_is_true(json_object_get(unit, "pass"));
	bench_table_row(table, "%s,%s,%s,%s,%s", extreme_kind_names[row->kind],
		without_commas(row->name, name, sizeof name), without_commas(row->must, must, sizeof must),
		without_commas(json_string_value(json_object_get(unit, "measured")), measured,
		sizeof measured), pass ? "yes" : "NO");
	return pass;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct bench_table *table = bench_table_open(bench, "extreme",
		"family,case,what must hold,measured,pass", true);
	uint32_t done = 0, failed = 0;
	char names[160] = "";
	for (; done < EXTREME_CASES && !bench_stopped(bench); done++) {
		const struct extreme_case *row = &extreme_cases[done];
		bench_progress(bench, (double)done / EXTREME_CASES, row->name);
		if (!tell_case(table, row, run_case(bench, row)) && failed++ < 4)
			snprintf(names + strlen(names), sizeof names - strlen(names), "%s%s",
				*names ? "; " : "", row->name);
	}
	bench_table_close(table);
	if (done < EXTREME_CASES)
		return eco_fail(error, ECO_INTERRUPTED, "interrupted");
	bench_say(bench, "%u cases, %u of them passed; none was left out.", done, done - failed);
	bench_say(bench, "Every loop has a bound: searches have a tolerance and a number of tries, and say "
		"which of the two ended them (lod/solver.h: "
		"plans by lod_planner_stats and ECO_TRACE=plan, grids and scales in a pack's META); "
		"everything else makes a fixed number of passes. "
		"Tests trap floating-point errors around lod/. Packs and plans of gcc -O0, gcc -O3 and "
		"clang, and plans under valgrind, are compared by make determinism.");
	bench_key(bench, "extreme_cases", done, "of the table");
	bench_key(bench, "extreme_failed", failed, "<= 0: cases that do not hold");
	return failed ? eco_fail(error, ECO_DAMAGED, "%u of %u extreme cases failed: %s", failed, done, names)
		: ECO_OK;
}

const struct bench_section bench_extreme = { "extreme", "Numerical stability", run,
	BENCH_OBJECTS_FRAMES "tests/bench/extreme/*.o tests-support.a", false };
