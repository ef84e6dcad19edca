/* More bytes, no worse a picture: twelve budgets of bytes for first visits, over the cameras of the section pictures
 * and many random views of five scenes. Random pictures are small, so that there can be many. */
#include <math.h>
#include <stdlib.h>

#include "tests/bench/bench_shots.h"
#include "tests/support/serve/random_request.h"

#define VERTICES 1000000u
#define WIDTH 400u
#define HEIGHT 300u
#define VIEWS 40u                /* a scene */
#define VIEWS_QUICK 5u
#define SEED 18u
#define WORSE 1.02
#define SEEN_LEAST 2e-3          /* picture errors below are none */

static const char *const scenes[] = { "park", "forest", "nested", "meadow", "tree" };
#define SCENES (sizeof scenes / sizeof *scenes)
static const uint64_t budgets[] = { 10000, 20000, 30000, 50000, 75000, 120000, 200000, 400000, 800000,
	2000000, 5000000, 10000000 };
#define BUDGETS (sizeof budgets / sizeof *budgets)

struct counts { uint32_t rows, binding, worse; double worst, used, off; };
struct study { struct bench_table *table; struct counts all; };

static const struct bench_shoot shoot = { .name = "bytes", .count = BUDGETS, .bytes = budgets };

/* All budgets from where all comes on are the same answer: one row of it counts. */
static void study_view(struct bench *bench, void *ctx, const struct bench_view *view)
{
	struct study *s = ctx;
	const json_t *rows = bench_view_rows(bench, view, &shoot);
	struct counts *counts = &s->all;
	double all = bench_shot_number(json_array_get(rows, BUDGETS - 1), "bytes"), least = INFINITY;
	bool last = false;
	for (size_t b = 0; b < BUDGETS && !last; b++) {
		const json_t *row = json_array_get(rows, b);
		double bytes = bench_shot_number(row, "bytes"), q = bench_shot_number(row, "q"),
			seen = fmax(SEEN_LEAST, bench_shot_number(row, "picture_error")),
			predicted = bench_shot_number(row, "predicted_q");
		if (!json_is_object(row))
			continue;
		last = bytes >= all;
		if (all > (double)budgets[b]) {
			counts->binding++;
			counts->used += bytes / (double)budgets[b];
			counts->off += fabs(predicted - q);
		}
		counts->rows++;
		counts->worse += seen > WORSE * least;
		counts->worst = fmax(counts->worst, seen / least);
		bench_table_row(s->table, "%s,%s,%llu,%.0f,%.4f,%.4f,%.4f,%.3f", view->scene, view->camera,
			(unsigned long long)budgets[b], bytes, q, predicted, seen,
			least < INFINITY ? seen / least : 1);
		least = fmin(least, seen);
	}
}

static void study_scene(struct bench *bench, struct study *s, size_t number)
{
	struct eco_pack *open = NULL;
	char pack[512], camera[32];
	snprintf(pack, sizeof pack, "%s/requests/%s.eco", bench->cache, scenes[number]);
	must(eco_pack_open(&open, pack, must_error));
	for (uint32_t i = 0; i < (bench->full ? VIEWS : VIEWS_QUICK); i++) {
		struct bench_view view = { scenes[number], camera, pack, random_outlook(&open->scene, SEED, i) };
		snprintf(camera, sizeof camera, "random-%u", i);
		view.view.width = WIDTH;
		view.view.height = HEIGHT;
		bench_progress((number + (double)i / VIEWS) / SCENES, scenes[number]);
		study_view(bench, s, &view);
	}
	eco_pack_close(open);
}

static void run(struct bench *bench)
{
	struct study s = { .table = NULL };
	bench_progress(0, "scenes of random views");
	bench_command("BUILD='%s' CACHE='%s/plants' sh tests/bench/request_scenes.sh '%s/requests'", bench->build,
		bench->cache, bench->cache);
	bench_say(bench, "Pictures of %u x %u (random views) and %u x %u, of a first visit with at most %u vertices and so "
		"many bytes, drawn and lit in software. Worse: a picture error more than 2 %% above that of a picture of "
		"the same view with fewer bytes; below %g there is none.", WIDTH, HEIGHT, BENCH_SHOT_WIDTH,
		BENCH_SHOT_HEIGHT, VERTICES, SEEN_LEAST);
	s.table = bench_table_open(bench, "bytes", "scene,camera,budget,bytes,Q,predicted Q,picture error,"
		"over the least of fewer bytes", false);
	bench_views_each(bench, BENCH_VIEWS_QUICK, study_view, &s);
	for (size_t i = 0; i < SCENES; i++)
		study_scene(bench, &s, i);
	bench_table_close(s.table);
	if (s.all.binding) {
		bench_key(bench, "bytes_worse", (double)s.all.worse / s.all.rows, "0: share of the pictures "
			"that are worse than one with fewer bytes");
		bench_key(bench, "bytes_worst", s.all.worst, "<= 1.02: its picture error over the other's");
		bench_key(bench, "bytes_used", s.all.used / s.all.binding,
			">= 0.95: share of the bytes used where they bind");
		bench_key(bench, "bytes_predicted_off", s.all.off / s.all.binding,
			"<= 0.03: predicted Q off by, where they bind");
	}
}

const struct bench_section bench_bytes = { "bytes", "More bytes, no worse a picture", run };
