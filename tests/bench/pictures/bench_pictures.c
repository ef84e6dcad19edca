/* Pictures at small budgets as people see them: picture error (FLIP), colour and contrast of blocks against
 * the truth (view_measure.h), of scenes and cameras that nothing was chosen on (pictures.json), with shadows and
 * without. Every picture with shadows stands in the report, beside the truth and its error.
 *
 * Each is set against the start: the same plan with one sample a pixel and no leaves on splats. */
#include <math.h>
#include <string.h>

#include "tests/bench/bench_shots.h"

static const uint64_t budgets[] = { 10000, 100000, 300000, 1000000 };
#define BUDGETS (sizeof budgets / sizeof *budgets)
#define SCBI_FIRST 1u                /* the first of the budgets from which on SCBI's owners have a bar, ... */
#define FINE_VERTICES 100000u        /* ... no point may be wide, and contrast is that of the truth */
#define MIDDLE_VERTICES 300000u
#define CONTRAST_NEAR 0.4

static const struct bench_column columns[] = { { "vertices", 0 }, { "bytes", 0 }, { "Q", 4 },
	{ "owner_q", 4 }, { "S1 start", 4 }, { "m16 start", 3 }, { "s16 start", 3 }, { "s16_abs start", 3 },
	{ "S8 smooth", 4 }, { "S8", 4 }, { "m16", 3 }, { "s16", 3 }, { "s16_abs", 3 }, { "B", 4 }, { "F1", 4 },
	{ "F8", 4 }, { "wide", 0 }, { "flat", 0 }, { "flat by chance", 1 }, { "widest point px", 1 }, { "truth CPU s", 1 },
	{ "predicted Q", 4 }, { "soft Q", 4 }, { "ceiling", 4 } };
enum { OWNER_Q = 3, S1, M16_START, S16_START, S16_ABS_START, SMOOTH, S8, M16, S16, S16_ABS, BIAS, F1, F8, WIDE,
	FLAT, CHANCE, WIDEST, TRUTH, COLUMNS = 24 };
/* of bench_shot_row */
static const char *const keys[COLUMNS] = { "vertices", "bytes", "q", "owner_q", "start_error", "start_m16",
	"start_s16", "start_s16_abs", "smooth_error", "picture_error", "m16", "s16", "s16_abs", "bias_error",
	"one_floor", "floor_error", "wide", "flat", "flat_by_chance", "widest_px", "truth_cpu_ms",
	"predicted_q", "soft_q", "ceiling" };

/* A figure over another: the geometric mean of rows of budgets [from, to], and the most of all rows, with
 * bars; INFINITY: no bar. */
static const struct ratio { const char *key, *says; uint32_t figure, over; uint64_t from, to;
	double mean, most; } ratios[] = {
	{ "floor", "F8 over F1", F8, F1, 0, 1000000, INFINITY, 0.5 },
	{ "smooth", "S8 without leaves over S1 of the start", SMOOTH, S1, 300000, 1000000, 0.8, 0.9999 },
	{ "leaves", "S8 over S1 of the start", S8, S1, 300000, 1000000, 0.85, 1.15 },
	{ "m16", "m16 over the start's", M16, M16_START, 100000, 300000, 1.05, 1.2 },
	{ "s16_abs", "s16_abs over the start's", S16_ABS, S16_ABS_START, 100000, 300000, 0.7, INFINITY } };
#define RATIOS (sizeof ratios / sizeof *ratios)

/* near, fine: rows of FINE_VERTICES or more whose s16 is within CONTRAST_NEAR, and all of them; wide, flat: of
 * rows from FINE_VERTICES to MIDDLE_VERTICES */
struct study {
	struct bench_table *table;
	struct found { double logs, most; uint32_t rows; char row[64]; } found[RATIOS];
	double widest, wide, flat, chance, scbi_owner[BUDGETS];
	uint32_t pictures, near, fine;
};

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
	snprintf(error, sizeof error, "error: S8 %.4f, start %.4f, m16 %.2f, s16 %+.2f, %u of %u wide are "
		"flat", m->picture_error, frame->start.picture_error, m->blocks.color, m->blocks.contrast,
		frame->wide.flat, frame->wide.ellipses);
	bench_client_compare(client, bench, file, picture, (const char *const[]){ ours, truth, error });
}

static void add_ratio(const struct ratio *r, struct found *found, const struct bench_view *view, uint64_t budget,
	const double value[COLUMNS])
{
	double ratio = value[r->figure] / value[r->over];
	if (!(ratio > 0 && isfinite(ratio)))
		return;
	if (budget >= r->from && budget <= r->to) {
		found->logs += log(ratio);
		found->rows++;
	}
	if (ratio <= found->most)
		return;
	found->most = ratio;
	snprintf(found->row, sizeof found->row, "%s %s %llu", view->scene, view->camera,
		(unsigned long long)budget);
}

static void add_row(struct study *s, const struct bench_view *view, size_t b, const json_t *row)
{
	double value[COLUMNS];
	for (size_t i = 0; i < COLUMNS; i++)
		value[i] = bench_shot_number(row, keys[i]) / (i == TRUTH ? 1000 : 1);
	for (size_t i = 0; i < RATIOS; i++)
		add_ratio(&ratios[i], &s->found[i], view, budgets[b], value);
	if (!strcmp(view->scene, "scbi") && !strcmp(view->camera, "air"))
		s->scbi_owner[b] = value[OWNER_Q];
	s->pictures++;
	if (budgets[b] >= FINE_VERTICES) {
		s->widest = fmax(s->widest, value[WIDEST]);
		s->near += fabs(value[S16]) <= CONTRAST_NEAR;
		s->fine++;
	}
	if (budgets[b] >= FINE_VERTICES && budgets[b] <= MIDDLE_VERTICES) {
		s->wide += value[WIDE];
		s->flat += value[FLAT];
		s->chance += value[CHANCE];
	}
	bench_table_values(s->table, value, "%s,%s,%llu", view->scene, view->camera, (unsigned long long)budgets[b]);
}

static void study_view(struct bench *bench, void *ctx, const struct bench_view *view)
{
	bool shown = bench->sky.shadows;
	const struct bench_shoot shoot = { .name = "seen", .count = BUDGETS, .vertices = budgets,
		.show = shown ? show : NULL, .compared = true, .biased = shown ? MIDDLE_VERTICES : 0 };
	const json_t *rows = bench_view_rows(bench, view, &shoot);
	for (uint32_t b = 0; b < BUDGETS; b++) {
		char file[128], caption[160];
		add_row(ctx, view, b, json_array_get(rows, b));
		name_picture(file, view, b);
		snprintf(caption, sizeof caption, "%s, %s, at most %llu vertices: ours; truth; error",
			view->scene, view->camera, (unsigned long long)budgets[b]);
		if (shown)
			bench_picture(bench, file, caption);
	}
}

/* `light` ends the key's name; bar INFINITY: it has none. */
static void add_key(struct bench *bench, const char *light, const char *name, double value, double bar,
	const char *says)
{
	char key[96], words[256];
	snprintf(key, sizeof key, "pictures_%s%s", name, light);
	snprintf(words, sizeof words, "<= %g: %s", bar, says);
	bench_key(bench, key, value, isfinite(bar) ? words : says);
}

static void add_keys(struct bench *bench, const struct study *s, const char *light)
{
	char name[96], says[192];
	for (size_t i = 0; i < RATIOS; i++) {
		const struct ratio *r = &ratios[i];
		const struct found *found = &s->found[i];
		snprintf(says, sizeof says, "%s, geometric mean from %llu to %llu vertices", r->says,
			(unsigned long long)r->from, (unsigned long long)r->to);
		add_key(bench, light, r->key, found->rows ? exp(found->logs / found->rows) : NAN, r->mean, says);
		snprintf(name, sizeof name, "%s_worst", r->key);
		snprintf(says, sizeof says, "%s, worst row: %s", r->says, found->row);
		add_key(bench, light, name, found->rows ? found->most : NAN, r->most, says);
	}
	snprintf(name, sizeof name, "pictures_s16_near%s", light);
	bench_key(bench, name, s->fine ? (double)s->near / s->fine : NAN,
		">= 0.9: share of rows at 100,000 vertices or more whose signed s16 is within .4");
	snprintf(says, sizeof says, "ellipses of foliage, of %.0f wider than 12 pixels at 100,000 and 300,000 "
		"vertices, that vary less than half as the truth; by chance %.0f do", s->wide, s->chance);
	add_key(bench, light, "flat", s->pictures ? s->flat : NAN, 0, says);
}

static void study(struct bench *bench, struct study *s, const char *table)
{
	*s = (struct study){ .scbi_owner = { NAN, NAN, NAN, NAN } };
	s->table = bench_table_described(bench, table, "scene,camera,budget", columns, COLUMNS, true);
	bench_views_each(bench, SIZE_MAX, study_view, s);
	bench_table_close(s->table);
}

static void run(struct bench *bench)
{
	struct study s;
	struct bench plain = *bench;
	plain.sky = (struct view_sky){ .shadows = 0 };
	bench_say(bench, "Every picture %u x %u, all chunks sent anew, drawn and lit in software. The truth is "
		"full detail with 64 samples a pixel. S1, S8: picture error (FLIP) with 1 and 8 samples; start: 1 "
		"sample and no leaves on splats; smooth: no leaves; F1, F8: S1 and S8 of full detail; B: with 64 "
		"(FULL=1). m16: distance of the mean colours (CIELAB) of blocks of 16 x 16 pixels; s16: deviation "
		"of L* inside them less the truth's; s16_abs: its absolute. wide: ellipses of foliage wider than %g "
		"pixels; flat: of these, L* inside deviates by less than half of the truth's; by chance: as many are flat "
		"in the truth itself, moved by half an ellipse's width. Truth CPU: processor "
		"time of drawing the truth once.", BENCH_SHOT_WIDTH, BENCH_SHOT_HEIGHT, BENCH_WIDE_PX);
	if (bench->sky.shadows) {
		study(bench, &s, "pictures");
		add_keys(bench, &s, "");
		bench_key(bench, "pictures_widest_px", s.widest > 0 ? s.widest : NAN,
			"<= 12: pixels across the widest point at 100,000 vertices or more");
		bench_key(bench, "pictures_scbi_owner_q_1m", s.scbi_owner[BUDGETS - 1],
			">= 0.75: owner_q of SCBI from the air at 1,000,000 vertices");
		bench_key(bench, "pictures_scbi_owner_q_100k", s.scbi_owner[SCBI_FIRST],
			">= 0.45: at 100,000");
		bench_head(bench, "Without shadows");
	}
	study(&plain, &s, "pictures_plain");
	add_keys(bench, &s, "_plain");
}

const struct bench_section bench_pictures = { "pictures", "What people see at small budgets", run };
