/* Error against run time: every method at every budget, on whole scenes, with the time to plan, send, decode
 * and draw. The error is that of the covered pixels against full detail of the same view (Neubert 2011,
 * equations 1 and 4), beside measures that a few large blobs cannot win: skill, owner_q, colour, and
 * those of the truth (S8, m16, s16). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/draw/view_picture.h"
#include "ecofiles/base/memory.h"
#include "tests/bench/bench_shots.h"

static const struct { const char *name, *title; } scenes[] = {
	{ "crown", "One tree, crown of 6,143 leaves" },
	{ "outdoor", "Outdoor scene, 120 M triangles" },
	{ "trees5000", "5,000 trees, 1.3 G vertices" },
	{ "scbi", "SCBI, a forest inventory" },
	{ "trees640", "640 trees, 10 M triangles" },
	{ "palms", "1,500 palms, 12 M triangles" },
	{ "sunflowers", "13,000 sunflowers and a maple, 70 M triangles" },
	{ "trees1276", "1,276 trees, 63 M vertices" } };
#define SCENES (sizeof scenes / sizeof *scenes)

static const struct bench_column columns[] = { { "1-Q", 5 }, { "P", 5 }, { "R", 5 }, { "wrong pixels", 0 },
	{ "skill", 4 }, { "owner_q", 4 }, { "soft Q", 4 }, { "ceiling", 4 }, { "S8", 4 }, { "m16", 3 }, { "s16", 3 },
	{ "colour RMS", 4 }, { "predicted Q", 4 }, { "plan ms", 2 }, { "transfer at 10 Mbit/s ms", 2 },
	{ "transfer at 100 Mbit/s ms", 2 }, { "decode ms", 2 }, { "draw ms", 2 }, { "total at 10 Mbit/s ms",
	2 },
	{ "total at 100 Mbit/s ms", 2 }, { "vertices", 0 }, { "bytes", 0 } };
#define COLUMNS (sizeof columns / sizeof *columns)
/* of bench_shots, for each column; NULL: made of others */
static const char *const keys[COLUMNS] = { "q", "p", "r", "wrong", "skill", "owner_q", "soft_q", "ceiling",
	"picture_error", "m16", "s16", "colour", "predicted_q", "plan_ms", NULL, NULL, "decode_ms", "draw_ms",
	NULL, NULL, "vertices", "bytes" };
enum { ERROR = 0, PREDICTED = 12, PLAN, SENT_10, SENT_100, DECODE, DRAW, TOTAL_10, TOTAL_100, VERTICES, BYTES };

static void read_row(const json_t *row, double value[COLUMNS])
{
	for (size_t i = 0; i < COLUMNS; i++)
		value[i] = keys[i] ? bench_shot_number(row, keys[i]) : NAN;
	value[ERROR] = 1 - value[ERROR];
	for (int wide = 0; wide < 2; wide++) {
		value[SENT_10 + wide] = 8 * value[BYTES] / (wide ? 100e3 : 10e3);
		value[TOTAL_10 + wide] = value[PLAN] + value[SENT_10 + wide] + value[DECODE] + value[DRAW];
	}
}

/* ---- All frames of a scene ---- */

struct means { double sum[COLUMNS], mean[COLUMNS]; uint32_t count[COLUMNS]; };   /* over views, without NaN */

/* |predicted Q - Q| of ours, all scenes together. */
struct gap { double sum; uint32_t frames; };

struct study {
	const char *scene;
	uint32_t views, budgets;
	uint64_t vertices[BENCH_BUDGETS_MAX];
	struct means all[BENCH_METHODS][BENCH_BUDGETS_MAX];
	bool done[BENCH_METHODS];
	struct gap *gap;
};

static void add(struct means *means, const double value[COLUMNS])
{
	for (size_t i = 0; i < COLUMNS; i++) {
		means->sum[i] += isnan(value[i]) ? 0 : value[i];
		means->count[i] += !isnan(value[i]);
		means->mean[i] = means->count[i] ? means->sum[i] / means->count[i] : NAN;
	}
}

static void study_method(struct bench *bench, struct study *s, uint32_t method, struct bench_table *table)
{
	for (uint32_t v = 0; v < s->views; v++) {
		char what[96];
		snprintf(what, sizeof what, "%s, %s, view %u", s->scene, bench_methods[method].name, v);
		bench_progress(((double)method + (double)v / s->views) / BENCH_METHODS, what);
		const json_t *rows = bench_shots(bench, s->scene, method, v);
		for (uint32_t b = 0; b < s->budgets; b++) {
			double value[COLUMNS];
			read_row(json_array_get(rows, b), value);
			bench_table_values(table, value, "%s,%s,%u,%llu", s->scene,
				bench_methods[method].name, v, (unsigned long long)s->vertices[b]);
			add(&s->all[method][b], value);
			if (method == BENCH_OURS) {
				s->gap->sum += fabs(value[PREDICTED] - (1 - value[ERROR]));
				s->gap->frames++;
			}
		}
	}
	s->done[method] = true;
}

/* One table a scene, budget by budget, so that methods stand below each other. */
static void write_means(struct bench *bench, const struct study *s)
{
	char name[64];
	snprintf(name, sizeof name, "frames_%s", s->scene);
	struct bench_table *table = bench_table_described(bench, name, "budget,method", columns, COLUMNS,
		true);
	for (uint32_t b = 0; b < s->budgets; b++)
		for (uint32_t m = 0; m < BENCH_METHODS; m++)
			if (s->done[m])
				bench_table_values(table, s->all[m][b].mean, "%llu,%s",
					(unsigned long long)s->vertices[b], bench_methods[m].name);
	bench_table_close(table);
}

#define ERROR_LEAST 1e-4         /* below, a logarithmic axis shows only noise */

static void plot_over(struct bench *bench, const struct study *s, int x, const char *kind, const char *label)
{
	double at[BENCH_METHODS][BENCH_BUDGETS_MAX], wrong[BENCH_METHODS][BENCH_BUDGETS_MAX];
	struct bench_series series[BENCH_METHODS];
	char name[96], title[128];
	uint32_t count = 0;
	for (uint32_t m = 0; m < BENCH_METHODS; m++) {
		for (uint32_t b = 0; b < s->budgets; b++) {
			at[m][b] = s->all[m][b].mean[x];
			wrong[m][b] = fmax(s->all[m][b].mean[ERROR], ERROR_LEAST);
		}
		if (s->done[m])
			series[count++] = (struct bench_series){ bench_methods[m].name, at[m], wrong[m],
				s->budgets, false };
	}
	snprintf(name, sizeof name, "frames-%s-%s", s->scene, kind);
	snprintf(title, sizeof title, "%s: mean error of %u views", s->scene, s->views);
	bench_plot(bench, &(struct bench_plot){ name, title, label, "1 - Q", true, true, series, count });
}

/* ---- A picture of each scene ---- */

/* Ours, the truth, and the error that people see. */
static void show_picture(struct bench *bench, const char *scene, const char *pack,
	const struct eco_request *request)
{
	char file[128], caption[256];
	unsigned long long vertices = strcmp(scene, "crown") == 0 ? 10000 : 1000000;
	struct bench_client *client = NULL;
	struct bench_frame frame = { .request = *request };
	struct view_picture ours = { 0 };
	frame.request.vertices = vertices;
	snprintf(file, sizeof file, "frames-%s-%llu.png", scene, vertices);
	snprintf(caption, sizeof caption, "%s at %llu vertices; truth; error", scene, vertices);
	client = bench_client_open(pack);
	bench_client_see(client, bench);
	bench_client_untimed(client);
	bench_client_frame(client, &frame, &ours);
	bench_client_compare(client, bench, file, &ours,
		(const char *const[]){ "ours", "truth", "error" });
	bench_picture(bench, file, caption);
	view_picture_free(&ours);
	bench_client_close(client);
}

/* ---- The section ---- */

static void run_scene(struct bench *bench, struct study *s, const char *title, struct bench_table *table)
{
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	char pack[512];
	if (!bench_scene_there(bench, s->scene, pack))
		return;
	s->budgets = bench_budgets(bench, s->scene, s->vertices);
	s->views = bench_shot_views(bench, s->scene, requests);
	for (uint32_t m = 0; m < BENCH_METHODS; m++)
		if (bench->full || !bench_methods[m].full_only)
			study_method(bench, s, m, table);
	bench_head(bench, title);
	plot_over(bench, s, TOTAL_100, "time", "plan + transfer at 100 Mbit/s + decode + draw, ms");
	write_means(bench, s);
	plot_over(bench, s, VERTICES, "vertices", "vertices drawn");
	show_picture(bench, s->scene, pack, &requests[0]);
}

static void run(struct bench *bench)
{
	struct gap gap = { 0, 0 };
	bench_say(bench,
		"Every picture %u x %u, all chunks sent anew. Budgets of the literature are among the rows: "
		"Deussen 2002, table 1 (points + 2 lines + 3 triangles): 640 trees 2.10 M, palms 1.76 M, "
		"outdoor 2.48 M, " "sunflowers 2.19 M; Neubert 2011: 5,000 trees 26 M.", BENCH_SHOT_WIDTH,
		BENCH_SHOT_HEIGHT);
	struct bench_table *table = bench_table_described(bench, "frames", "scene,method,view,budget",
		columns, COLUMNS, false);
	for (size_t i = 0; i < SCENES; i++) {
		struct study *s = eco_alloc(1, sizeof *s);
		s->scene = scenes[i].name;
		s->gap = &gap;
		run_scene(bench, s, scenes[i].title, table);
		free(s);
	}
	bench_table_close(table);
	bench_key(bench, "predicted_q_gap", gap.frames ? gap.sum / gap.frames : NAN, "<= 0.03: mean |predicted Q - Q|");
}

const struct bench_section bench_frames = { "frames", "Error against run time", run };
