/* One answer without a budget of bytes, cut after so many of them, beside an answer that was asked for with
 * that budget: first visits of at most a million vertices, over the cameras of the section pictures. */
#include <math.h>
#include <stdlib.h>

#include "tests/bench/pictures/bench_views.h"

#define VERTICES 1000000u
#define NEAR 1.1                 /* picture error of the cut one over the other's */
#define SEEN_LEAST 5e-4          /* picture errors below are none */

static const uint64_t cuts[] = { 20000, 30000, 45000, 70000, 100000, 150000, 230000, 350000, 520000, 800000 };
#define CUTS (sizeof cuts / sizeof *cuts)

struct study {
	struct bench_table *table;
	uint32_t rows, near;         /* rows whose answer is longer than the cut; those within NEAR */
	double logs, worst;
};

/* Rows are in pairs: cut, asked for. */
static void ask(uint32_t row, struct bench_frame *frame)
{
	frame->request.vertices = VERTICES;
	frame->request.bytes = row % 2 ? cuts[row / 2] : ECO_BYTES_UNBOUNDED;
	frame->cut = row % 2 ? 0 : cuts[row / 2];
}

static enum eco_code take(struct bench *bench, struct bench_client *client, const struct bench_view *view,
	uint32_t row, const struct bench_frame *frame, const struct view_picture *picture, json_t **kept,
	struct eco_error *error)
{
	(void)bench, (void)client, (void)view, (void)row, (void)picture, (void)error;
	*kept = json_object();
	bench_shot_set(*kept, "bytes", (double)frame->bytes);
	bench_shot_set(*kept, "q", frame->score.q);
	bench_shot_set(*kept, "picture_error", frame->picture_error);
	return ECO_OK;
}

static const struct bench_view_shoot shoot = { "anytime", 2 * CUTS, ask, take };

static void add_row(struct study *s, const struct bench_view *view, size_t c, const json_t *rows)
{
	const json_t *cut = json_array_get(rows, 2 * c), *asked = json_array_get(rows, 2 * c + 1);
	double whole = bench_shot_number(cut, "bytes"), seen = bench_shot_number(cut, "picture_error"),
		other = bench_shot_number(asked, "picture_error");
	double ratio = (seen < SEEN_LEAST ? SEEN_LEAST : seen) / (other < SEEN_LEAST ? SEEN_LEAST : other);
	if (whole <= (double)cuts[c])
		return;
	s->rows++;
	s->near += ratio <= NEAR;
	s->logs += log(ratio);
	s->worst = fmax(s->worst, ratio);
	bench_table_row(s->table, "%s,%s,%llu,%.0f,%.4f,%.4f,%.4f,%.4f,%.3f", view->scene, view->camera,
		(unsigned long long)cuts[c], whole, bench_shot_number(cut, "q"), seen,
		bench_shot_number(asked, "q"), other, ratio);
}

static enum eco_code plot(struct bench *bench, const struct bench_view *view, const json_t *rows,
	struct eco_error *error)
{
	double x[CUTS], y[2][CUTS];
	char name[96], title[160];
	for (size_t c = 0; c < CUTS; c++) {
		x[c] = (double)cuts[c];
		for (size_t k = 0; k < 2; k++)
			y[k][c] = bench_shot_number(json_array_get(rows, 2 * c + k), "picture_error");
	}
	const struct bench_series series[] = { { "an answer without budget, cut", x, y[0], CUTS, false },
		{ "asked for with that budget", x, y[1], CUTS, false } };
	snprintf(name, sizeof name, "anytime-%s-%s", view->scene, view->camera);
	snprintf(title, sizeof title, "%s, camera %s: what people see wrong after so many bytes",
		view->scene, view->camera);
	return bench_plot(bench, &(struct bench_plot){ .name = name, .title = title, .x = "bytes",
		.y = "picture error", .log_x = true, .series = series, .series_count = 2 }, error);
}

static enum eco_code study_view(struct bench *bench, void *ctx, const struct bench_view *view,
	struct eco_error *error)
{
	json_t *rows;
	enum eco_code code = bench_view_rows(bench, view, &shoot, &rows, error);
	for (size_t c = 0; c < CUTS && !code; c++)
		add_row(ctx, view, c, rows);
	return code ? code : plot(bench, view, rows, error);
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	json_t *views;
	const json_t *scenes = bench_views_load(&views, error);
	struct study s = { 0 };
	if (!scenes) {
		json_decref(views);
		return ECO_BAD_INPUT;
	}
	bench_say(bench, "Every picture %u x %u, of a first visit with at most %u vertices, drawn and lit in "
		"software: what is there once so many bytes of an answer without a budget of bytes have "
		"come, and what an answer shows that was asked for with so many.", BENCH_SHOT_WIDTH,
		BENCH_SHOT_HEIGHT, VERTICES);
	s.table = bench_table_open(bench, "anytime", "scene,camera,cut,whole answer,Q,picture error,"
		"Q asked for,picture error asked for,ratio", true);
	enum eco_code code = bench_views_each(bench, scenes, BENCH_VIEWS_QUICK, study_view, &s, error);
	bench_table_close(s.table);
	if (!code && s.rows) {
		bench_key(bench, "anytime_ratio", exp(s.logs / s.rows), "picture error of the cut answer "
			"over that of one asked for, geometric mean");
		bench_key(bench, "anytime_worst", s.worst, "<= 1.10");
		bench_key(bench, "anytime_near", (double)s.near / s.rows, "share of rows at most 1.10");
	}
	json_decref(views);
	return code;
}

const struct bench_section bench_anytime = { "anytime", "One answer, cut at any byte", run,
	.objects = BENCH_OBJECTS_FRAMES "tests/bench/bench_frame.o "
	"tests/bench/pictures/bench_anytime.o tests/bench/pictures/bench_views.o "
	"tests/bench/pictures/bench_widest.o" };
