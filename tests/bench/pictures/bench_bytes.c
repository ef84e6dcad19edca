/* First visits that bytes bound, of at most a million vertices, over the cameras of the section pictures.
 *
 *   bytes        answers that were asked for with budgets from 10 kB to 10 MB
 *   anytime      one answer without a budget, cut after so many bytes, beside one that was asked for with
 *                that budget */
#include <math.h>

#include "tests/bench/bench_shots.h"

#define VERTICES 1000000u
#define NEAR 1.1                 /* picture error of the cut answer over the other's */
#define SEEN_LEAST 5e-4          /* picture errors below are none */

static const uint64_t budgets[] = { 10000, 20000, 100000, 300000, 1000000, 3000000, 10000000 };
#define BUDGETS (sizeof budgets / sizeof *budgets)
static const uint64_t cuts[] = { 20000, 30000, 45000, 70000, 100000, 150000, 230000, 350000, 520000, 800000 };
#define CUTS (sizeof cuts / sizeof *cuts)

static void say_pictures(struct bench *bench, const char *more)
{
	bench_say(bench, "Every picture %u x %u, of a first visit with at most %u vertices%s, drawn and lit in "
		"software.", BENCH_SHOT_WIDTH, BENCH_SHOT_HEIGHT, VERTICES, more);
}

/* ---- Budgets ---- */

/* Sums over rows that bind. */
struct bytes { struct bench_table *table; double used, off; uint32_t binding; };

static void study_bytes(struct bench *bench, void *ctx, const struct bench_view *view)
{
	static const struct bench_shoot shoot = { .name = "bytes", .count = BUDGETS, .bytes = budgets };
	struct bytes *s = ctx;
	const json_t *rows = bench_view_rows(bench, view, &shoot);
	double all = bench_shot_number(json_array_get(rows, BUDGETS - 1), "bytes");
	for (size_t b = 0; b < BUDGETS; b++) {
		const json_t *row = json_array_get(rows, b);
		double bytes = bench_shot_number(row, "bytes"), q = bench_shot_number(row, "q"),
			predicted = bench_shot_number(row, "predicted_q");
		if (all > (double)budgets[b]) {
			s->used += bytes / (double)budgets[b];
			s->off += fabs(predicted - q);
			s->binding++;
		}
		bench_table_row(s->table, "%s,%s,%llu,%.0f,%.0f,%.4f,%.4f,%.4f,%.4f,%.4f", view->scene,
			view->camera, (unsigned long long)budgets[b], bench_shot_number(row, "vertices"),
			bytes, q, bench_shot_number(row, "skill"), bench_shot_number(row, "owner_q"),
			bench_shot_number(row, "picture_error"), predicted);
	}
}

static void run_bytes(struct bench *bench)
{
	struct bytes s = { bench_table_open(bench, "bytes",
		"scene,camera,budget,vertices,bytes,Q,skill,owner_q,"
		"picture error,predicted Q", true), 0, 0, 0 };
	say_pictures(bench, " and so many bytes");
	bench_views_each(bench, BENCH_VIEWS_QUICK, study_bytes, &s);
	bench_table_close(s.table);
	if (s.binding) {
		bench_key(bench, "bytes_used", s.used / s.binding,
			">= 0.95: share of the bytes used where they bind");
		bench_key(bench, "bytes_predicted_off", s.off / s.binding,
			"<= 0.03: predicted Q off by, where they bind");
	}
}

const struct bench_section bench_bytes = { "bytes", "What people see for the bytes of a first visit",
	run_bytes };

/* ---- Cuts ---- */

/* `rows`: those whose answer is longer than the cut; `near`: those of them within NEAR */
struct cuts { struct bench_table *table; uint32_t rows, near; double logs, worst; };

static void study_cuts(struct bench *bench, void *ctx, const struct bench_view *view)
{
	static const struct bench_shoot shoots[] = { { .name = "anytime-cut", .count = CUTS, .cuts = cuts },
		{ .name = "anytime-asked", .count = CUTS, .bytes = cuts } };
	struct cuts *s = ctx;
	const json_t *cut_rows = bench_view_rows(bench, view, &shoots[0]),
		*asked_rows = bench_view_rows(bench, view, &shoots[1]);
	for (size_t c = 0; c < CUTS; c++) {
		const json_t *cut = json_array_get(cut_rows, c), *asked = json_array_get(asked_rows, c);
		double whole = bench_shot_number(cut, "bytes"), seen = bench_shot_number(cut,
			"picture_error"), other = bench_shot_number(asked, "picture_error"),
			ratio = fmax(seen, SEEN_LEAST) / fmax(other, SEEN_LEAST);
		if (whole <= (double)cuts[c])
			continue;
		s->rows++;
		s->near += ratio <= NEAR;
		s->logs += log(ratio);
		s->worst = fmax(s->worst, ratio);
		bench_table_row(s->table, "%s,%s,%llu,%.0f,%.4f,%.4f,%.4f,%.4f,%.3f", view->scene,
			view->camera, (unsigned long long)cuts[c], whole, bench_shot_number(cut, "q"), seen,
			bench_shot_number(asked, "q"), other, ratio);
	}
}

static void run_cuts(struct bench *bench)
{
	struct cuts s = { bench_table_open(bench, "anytime", "scene,camera,cut,whole answer,Q,picture error,"
		"Q asked for,picture error asked for,ratio", true), 0, 0, 0, 0 };
	say_pictures(bench, ": an answer without a budget of bytes, cut after so many of them, beside an answer "
		"that was asked for with so many");
	bench_views_each(bench, BENCH_VIEWS_QUICK, study_cuts, &s);
	bench_table_close(s.table);
	if (s.rows) {
		bench_key(bench, "anytime_ratio", exp(s.logs / s.rows), "picture error of the cut answer "
			"over that of one asked for, geometric mean");
		bench_key(bench, "anytime_worst", s.worst, "<= 1.10");
		bench_key(bench, "anytime_near", (double)s.near / s.rows, "share of rows at most 1.10");
	}
}

const struct bench_section bench_anytime = { "anytime", "One answer, cut at any byte", run_cuts };
