/* Pictures at small budgets as people see them: picture error (FLIP), colour and contrast of blocks against
 * the truth (view_measure.h), of scenes and cameras that nothing was chosen on (pictures.json). Every picture stands in
 * the report, beside the truth and its error. */
#include <math.h>
#include <string.h>

#include "tests/bench/bench_shots.h"

static const uint64_t budgets[] = { 10000, 100000, 300000, 1000000 };
enum { BUDGETS = sizeof budgets / sizeof *budgets, OF_100K = 1, OF_1M = 3 };
#define CONTRAST_NEAR 0.4

static const struct bench_column columns[] = { { "vertices", 0 }, { "bytes", 0 }, { "Q", 4 }, { "owner_q", 4 },
	{ "S8", 4 }, { "m16", 3 }, { "s16", 3 }, { "s16_abs", 3 }, { "F1", 4 }, { "F8", 4 }, { "truth CPU s", 1 },
	{ "predicted Q", 4 }, { "soft Q", 4 }, { "ceiling", 4 } };
enum { OWNER_Q = 3, S8, M16, S16, S16_ABS, F1, F8, TRUTH, COLUMNS = 14 };
/* of bench_shot_row */
static const char *const keys[COLUMNS] = { "vertices", "bytes", "q", "owner_q", "picture_error", "m16", "s16", "s16_abs",
	"one_floor", "floor_error", "truth_cpu_ms", "predicted_q", "soft_q", "ceiling" };

/* near, fine: rows of 100,000 vertices or more whose s16 is within CONTRAST_NEAR, and all of them */
struct study { struct bench_table *table; double sums[COLUMNS], scbi_owner[BUDGETS]; uint32_t pictures, near, fine; };

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
	snprintf(error, sizeof error, "error: S8 %.4f, m16 %.2f, s16 %+.2f", m->picture_error, m->blocks.color,
		m->blocks.contrast);
	bench_client_compare(client, bench, file, picture, (const char *const[]){ ours, truth, error });
}

static void add_row(struct study *s, const struct bench_view *view, size_t b, const json_t *row)
{
	double value[COLUMNS];
	for (size_t i = 0; i < COLUMNS; i++)
		s->sums[i] += value[i] = bench_shot_number(row, keys[i]) / (i == TRUTH ? 1000 : 1);
	if (!strcmp(view->scene, "scbi") && !strcmp(view->camera, "air"))
		s->scbi_owner[b] = value[OWNER_Q];
	s->pictures++;
	if (b >= OF_100K) {
		s->near += fabs(value[S16]) <= CONTRAST_NEAR;
		s->fine++;
	}
	bench_table_values(s->table, value, "%s,%s,%llu", view->scene, view->camera, (unsigned long long)budgets[b]);
}

static void study_view(struct bench *bench, void *ctx, const struct bench_view *view)
{
	const struct bench_shoot shoot = { .name = "seen", .count = BUDGETS, .vertices = budgets, .show = show };
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

static void run(struct bench *bench)
{
	static const struct { const char *key, *says; uint32_t figure; } means[] = {
		{ "pictures_s8", "S8, mean of all pictures", S8 }, { "pictures_m16", "m16, mean of all pictures", M16 },
		{ "pictures_s16_abs", "s16_abs, mean of all pictures", S16_ABS } };
	struct study s = { .scbi_owner = { NAN, NAN, NAN, NAN } };
	bench_say(bench, "Every picture %u x %u, all chunks sent anew, drawn and lit in software. The truth is "
		"full detail with 64 samples a pixel. S8: picture error (FLIP) with 8 samples; F1, F8: that of full detail with "
		"1 and 8. m16: distance of the mean colours (CIELAB) of blocks of 16 x 16 pixels; s16: deviation of L* inside "
		"them less the truth's; s16_abs: its absolute. Truth CPU: processor time of drawing the truth once.",
		BENCH_SHOT_WIDTH, BENCH_SHOT_HEIGHT);
	s.table = bench_table_described(bench, "pictures", "scene,camera,budget", columns, COLUMNS, true);
	bench_views_each(bench, SIZE_MAX, study_view, &s);
	bench_table_close(s.table);
	for (size_t i = 0; i < sizeof means / sizeof *means; i++)
		bench_key(bench, means[i].key, s.pictures ? s.sums[means[i].figure] / s.pictures : NAN, means[i].says);
	bench_key(bench, "pictures_floor", s.pictures ? s.sums[F8] / s.sums[F1] : NAN, "F8 over F1");
	bench_key(bench, "pictures_s16_near", s.fine ? (double)s.near / s.fine : NAN,
		">= 0.9: share of rows at 100,000 vertices or more whose signed s16 is within .4");
	bench_key(bench, "pictures_scbi_owner_q_1m", s.scbi_owner[OF_1M],
		">= 0.75: owner_q of SCBI from the air at 1,000,000 vertices");
	bench_key(bench, "pictures_scbi_owner_q_100k", s.scbi_owner[OF_100K], ">= 0.45: at 100,000");
}

const struct bench_section bench_pictures = { "pictures", "What people see at small budgets", run };
