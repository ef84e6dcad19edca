/* Pictures at small budgets as people see them: picture error (FLIP), soft Q and the rest, of scenes and
 * cameras that nothing was chosen on (pictures.json). Every picture stands in the report, beside full detail
 * and its error. */
#include <math.h>
#include <string.h>

#include "tests/bench/bench_shots.h"

static const uint64_t budgets[] = { 10000, 100000, 1000000 };
#define BUDGETS (sizeof budgets / sizeof *budgets)
#define FINE_VERTICES 100000u        /* from here on no point may be wide */

struct study { struct bench_table *table; double seen, widest, scbi_owner[BUDGETS]; uint32_t pictures; };

static void name_picture(char file[128], const struct bench_view *view, uint32_t budget)
{
	snprintf(file, 128, "pictures-%s-%s-%llu.png", view->scene, view->camera,
		(unsigned long long)budgets[budget]);
}

static void show(struct bench *bench, struct bench_client *client, const struct bench_view *view,
	uint32_t budget, const struct bench_frame *frame, const struct view_picture *picture)
{
	char file[128], ours[160], full[96], seen[96];
	const struct lod_score *score = &frame->score;
	name_picture(file, view, budget);
	snprintf(ours, sizeof ours, "%llu vertices, %.0f kB, Q %.4f, soft Q %.4f, owner_q %.3f",
		(unsigned long long)frame->vertices, (double)frame->bytes / 1e3, score->q, frame->soft_q,
		score->owner_q);
	snprintf(full, sizeof full, "full detail, ceiling %.4f", frame->ceiling);
	snprintf(seen, sizeof seen, "picture error %.4f, widest point %.1f px", frame->picture_error,
		frame->widest_px);
	bench_client_compare(client, bench, file, picture, (const char *const[]){ ours, full, seen });
}

static void add_row(struct study *s, const struct bench_view *view, size_t b, const json_t *row)
{
	double owner_q = bench_shot_number(row, "owner_q"), seen = bench_shot_number(row, "picture_error"),
		widest = bench_shot_number(row, "widest_px");
	if (!strcmp(view->scene, "scbi") && !strcmp(view->camera, "air"))
		s->scbi_owner[b] = owner_q;
	s->seen += seen;
	if (budgets[b] >= FINE_VERTICES)
		s->widest = fmax(s->widest, widest);
	s->pictures++;
	bench_table_row(s->table, "%s,%s,%llu,%.0f,%.0f,%.4f,%.4f,%.4f,%.4f,%.5f,%.1f,%.4f", view->scene,
		view->camera, (unsigned long long)budgets[b], bench_shot_number(row, "vertices"),
		bench_shot_number(row, "bytes"), bench_shot_number(row, "q"), bench_shot_number(row,
			"soft_q"),
		owner_q, bench_shot_number(row, "predicted_q"), seen, widest, bench_shot_number(row, "ceiling"));
}

static void study_view(struct bench *bench, void *ctx, const struct bench_view *view)
{
	static const struct bench_shoot shoot = { .name = "seen", .count = BUDGETS, .vertices = budgets,
		.show = show };
	const json_t *rows = bench_view_rows(bench, view, &shoot);
	for (uint32_t b = 0; b < BUDGETS; b++) {
		char file[128], caption[160];
		add_row(ctx, view, b, json_array_get(rows, b));
		name_picture(file, view, b);
		snprintf(caption, sizeof caption, "%s, %s, at most %llu vertices; full detail; error",
			view->scene, view->camera, (unsigned long long)budgets[b]);
		bench_picture(bench, file, caption);
	}
}

static void run(struct bench *bench)
{
	struct study s = { .scbi_owner = { NAN, NAN, NAN } };
	bench_say(bench, "Every picture %u x %u, all chunks sent anew, drawn and lit in software.",
		BENCH_SHOT_WIDTH, BENCH_SHOT_HEIGHT);
	s.table = bench_table_open(bench, "pictures", "scene,camera,budget,vertices,bytes,Q,soft Q,owner_q,"
		"predicted Q,picture error,widest point px,ceiling", true);
	bench_views_each(bench, SIZE_MAX, study_view, &s);
	bench_table_close(s.table);
	bench_key(bench, "pictures_error", s.pictures ? s.seen / s.pictures : NAN, "picture error, mean");
	bench_key(bench, "pictures_widest_px", s.widest > 0 ? s.widest : NAN,
		"<= 12: pixels across the widest point at 100,000 vertices or more");
	bench_key(bench, "pictures_scbi_owner_q_1m", s.scbi_owner[2],
		">= 0.75: owner_q of SCBI from the air at 1,000,000 vertices");
	bench_key(bench, "pictures_scbi_owner_q_100k", s.scbi_owner[1], ">= 0.45: at 100,000");
}

const struct bench_section bench_pictures = { "pictures", "What people see at small budgets", run };
