/* First visits of at most a million vertices, with budgets from 10 kB to 10 MB, over the cameras of the section
 * pictures. */
#include <math.h>

#include "tests/bench/bench_shots.h"

#define VERTICES 1000000u

static const uint64_t budgets[] = { 10000, 20000, 100000, 300000, 1000000, 3000000, 10000000 };
#define BUDGETS (sizeof budgets / sizeof *budgets)

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
	bench_say(bench, "Every picture %u x %u, of a first visit with at most %u vertices and so many bytes, drawn and lit "
		"in software.", BENCH_SHOT_WIDTH, BENCH_SHOT_HEIGHT, VERTICES);
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
