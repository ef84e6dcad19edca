/* Pictures at small budgets as people see them: picture error (FLIP), colour and contrast of blocks against the
 * truth (view_truth.h), of scenes and cameras that nothing was chosen on (pictures.json). Every picture stands in
 * the report, beside the truth and its error. */
#include <math.h>
#include <string.h>

#include "tests/bench/bench_shots.h"

static const uint64_t budgets[] = { 10000, 100000, 300000, 1000000 };
#define BUDGETS (sizeof budgets / sizeof *budgets)
#define SCBI_FIRST 1u                /* the first of the budgets from which on SCBI's owners have a bar, ... */
#define FINE_VERTICES 100000u        /* ... no point may be wide, and contrast is that of the truth */
#define CONTRAST_NEAR 0.4

static const struct bench_column columns[] = { { "vertices", 0 }, { "bytes", 0 }, { "Q", 4 }, { "owner_q", 4 },
	{ "S1", 4 }, { "S8", 4 }, { "F1", 4 }, { "F8", 4 }, { "B", 4 }, { "m16", 3 }, { "s16", 3 }, { "s16_abs", 3 },
	{ "widest point px", 1 }, { "truth CPU s", 1 }, { "predicted Q", 4 }, { "soft Q", 4 }, { "ceiling", 4 } };
enum { OWNER_Q = 3, S1, S8, F1, F8, M16 = 9, S16, S16_ABS, WIDEST, TRUTH, COLUMNS = 17 };
/* of bench_shot_row */
static const char *const keys[COLUMNS] = { "vertices", "bytes", "q", "owner_q", "one_error", "picture_error", "one_floor",
	"floor_error", "bias_error", "m16", "s16", "s16_abs", "widest_px", "truth_cpu_ms", "predicted_q", "soft_q",
	"ceiling" };

/* floor: the most of F8 / F1; worse: rows whose S8 is not below S1; near, fine: rows of FINE_VERTICES or more whose
 * s16 is within CONTRAST_NEAR, and all of them */
struct study { struct bench_table *table; double sum[COLUMNS], widest, floor, scbi_owner[BUDGETS];
	uint32_t pictures, worse, near, fine; };

static void name_picture(char file[128], const struct bench_view *view, uint32_t budget)
{
	snprintf(file, 128, "pictures-%s-%s-%llu.png", view->scene, view->camera,
		(unsigned long long)budgets[budget]);
}

static void show(struct bench *bench, struct bench_client *client, const struct bench_view *view,
	uint32_t budget, const struct bench_frame *frame, const struct view_picture *picture)
{
	char file[128], ours[160], truth[96], error[128];
	const struct view_measures *m = &frame->measures;
	name_picture(file, view, budget);
	snprintf(ours, sizeof ours, "ours: %llu vertices, %.0f kB, Q %.4f, owner_q %.3f",
		(unsigned long long)frame->vertices, (double)frame->bytes / 1e3, m->score.q, m->score.owner_q);
	snprintf(truth, sizeof truth, "truth: full detail, F8 %.4f, F1 %.4f", frame->truth.floor,
		frame->truth.floor_one);
	snprintf(error, sizeof error, "error: S8 %.4f, S1 %.4f, m16 %.2f, s16 %+.2f, widest point %.1f px",
		m->picture_error, frame->one_error, m->blocks.color, m->blocks.contrast, frame->widest_px);
	bench_client_compare(client, bench, file, picture, (const char *const[]){ ours, truth, error });
}

static void add_row(struct study *s, const struct bench_view *view, size_t b, const json_t *row)
{
	double value[COLUMNS];
	for (size_t i = 0; i < COLUMNS; i++) {
		value[i] = bench_shot_number(row, keys[i]) / (i == TRUTH ? 1000 : 1);
		s->sum[i] += value[i];
	}
	if (!strcmp(view->scene, "scbi") && !strcmp(view->camera, "air"))
		s->scbi_owner[b] = value[OWNER_Q];
	s->floor = fmax(s->floor, value[F8] / value[F1]);
	s->worse += !(value[S8] < value[S1]);
	s->pictures++;
	if (budgets[b] >= FINE_VERTICES) {
		s->widest = fmax(s->widest, value[WIDEST]);
		s->near += fabs(value[S16]) <= CONTRAST_NEAR;
		s->fine++;
	}
	bench_table_values(s->table, value, "%s,%s,%llu", view->scene, view->camera, (unsigned long long)budgets[b]);
}

static void study_view(struct bench *bench, void *ctx, const struct bench_view *view)
{
	static const struct bench_shoot shoot = { .name = "seen", .count = BUDGETS, .vertices = budgets,
		.show = show, .biased = true };
	const json_t *rows = bench_view_rows(bench, view, &shoot);
	for (uint32_t b = 0; b < BUDGETS; b++) {
		char file[128], caption[160];
		add_row(ctx, view, b, json_array_get(rows, b));
		name_picture(file, view, b);
		snprintf(caption, sizeof caption, "%s, %s, at most %llu vertices: ours; truth; error",
			view->scene, view->camera, (unsigned long long)budgets[b]);
		bench_picture(bench, file, caption);
	}
}

static void add_keys(struct bench *bench, const struct study *s)
{
	double rows = s->pictures ? s->pictures : NAN;
	bench_key(bench, "pictures_error", s->sum[S8] / rows, "picture error with 8 samples (S8), mean");
	bench_key(bench, "pictures_m16", s->sum[M16] / rows, "distance of the blocks' colours, mean");
	bench_key(bench, "pictures_s16_abs", s->sum[S16_ABS] / rows, "distance of the blocks' contrasts, mean");
	bench_key(bench, "pictures_s16_near", s->fine ? (double)s->near / s->fine : NAN,
		">= 0.9: share of rows at 100,000 vertices or more whose signed s16 is within .4");
	bench_key(bench, "pictures_floor", s->pictures ? s->floor : NAN, "<= 0.5: F8 over F1, the worst view");
	bench_key(bench, "pictures_samples_worse", s->pictures ? s->worse : NAN, "0: rows whose S8 is not below S1");
	bench_key(bench, "pictures_widest_px", s->widest > 0 ? s->widest : NAN,
		"<= 12: pixels across the widest point at 100,000 vertices or more");
	bench_key(bench, "pictures_scbi_owner_q_1m", s->scbi_owner[BUDGETS - 1],
		">= 0.75: owner_q of SCBI from the air at 1,000,000 vertices");
	bench_key(bench, "pictures_scbi_owner_q_100k", s->scbi_owner[SCBI_FIRST], ">= 0.45: at 100,000");
}

static void run(struct bench *bench)
{
	struct study s = { .scbi_owner = { NAN, NAN, NAN, NAN } };
	bench_say(bench, "Every picture %u x %u, all chunks sent anew, drawn and lit in software. The truth is full "
		"detail with 64 samples a pixel. S1, S8: picture error (FLIP) with 1 and 8 samples; F1, F8: that of full "
		"detail; B: with 64 (FULL=1). m16: distance of the mean colours (CIELAB) of blocks of 16 x 16 pixels; s16: "
		"deviation of L* inside them less the truth's; s16_abs: its absolute. Truth CPU: processor time of "
		"drawing the truth once.", BENCH_SHOT_WIDTH, BENCH_SHOT_HEIGHT);
	s.table = bench_table_described(bench, "pictures", "scene,camera,budget", columns, COLUMNS, true);
	bench_views_each(bench, SIZE_MAX, study_view, &s);
	bench_table_close(s.table);
	add_keys(bench, &s);
}

const struct bench_section bench_pictures = { "pictures", "What people see at small budgets", run };
