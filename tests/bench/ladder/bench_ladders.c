/* Whether ladders have gaps: each plant alone, packed in full and as a draft, with budgets of vertices from 4 to full
 * detail. Pictures of all budgets are drawn in a few directions and compared with full detail drawn alike.
 *
 * Two errors: that of the colors of blocks (m16) over that of a picture without the plant, and 1 - soft Q. A budget is
 * unused whether no more fits in it or whatever does is worse by the plant's curves: more vertices bring nothing. */
#include <math.h>
#include <sys/stat.h>

#include "lod/eye.h"
#include "tests/bench/bench_fetch.h"
#include "tests/bench/bench_shots.h"

#define WIDTH 400u
#define HEIGHT 300u
#define VIEWS 3u
#define BUDGETS 24u
#define LEAST 4u                         /* vertices */
#define AWAY 4.0                         /* of the eye, radii */
#define FRAME 0.9                        /* of the picture's height: the plant */
#define RISE_MOST 0.005                  /* of an error that is allowed */
#define UNUSED_MOST 10.0                 /* of a budget, % */
#define QUICK 4u                         /* plants, in the quick bench */

enum { BUDGET, VERTICES, COLOR, MISSED, FIGURES };
typedef double budget_rows[BUDGETS][FIGURES];
static const struct bench_column of_budgets[FIGURES] = { { "budget", 0 }, { "vertices", 0 }, { "color", 4 },
	{ "1 - soft Q", 4 } };
enum { FULL, BYTES, MEAN_COLOR, MEAN_MISSED, RISE, RISE_AT, FALL, FALL_AT, UNUSED, UNUSED_AT, COLUMNS };
static const struct bench_column of_plants[COLUMNS] = { { "full", 0 }, { "bytes", 0 }, { "color", 4 },
	{ "1 - soft Q", 4 }, { "color rises", 4 }, { "at budget", 0 }, { "Q falls", 4 }, { "at budget", 0 },
	{ "unused %", 1 }, { "at budget", 0 } };

/* samples: along each side of a pixel */
struct effort { uint32_t samples, views, budgets; };
static const struct effort quick = { 2, 2, 12 }, thorough = { 4, VIEWS, BUDGETS };

/* ---- One plant ---- */

/* From 5, 25 and 45 degrees above the horizon. */
static void look(struct eco_view *view, const struct eco_anchor *whole, uint32_t number)
{
	static const double from[VIEWS][3] = { { 0.996, 0, 0.087 }, { -0.668, 0.612, 0.423 },
		{ 0.062, -0.704, 0.707 } };
	*view = (struct eco_view){ .up = { 0, 0, 1 }, .fov_y_deg = 2 * atan(1 / (FRAME * AWAY)) * 180 / M_PI,
		.width = WIDTH, .height = HEIGHT };
	for (int k = 0; k < 3; k++) {
		view->target[k] = whole->center[k];
		view->eye[k] = whole->center[k] + AWAY * whole->radius * from[number][k];
	}
}

static void shoot(const struct srv_scene *scene, struct view_store *store, const struct eco_view *view,
	uint64_t vertices, uint32_t samples, struct view_picture *picture)
{
	struct eco_request request = { .view = *view, .vertices = vertices, .bytes = ECO_BYTES_UNBOUNDED };
	struct bench_drawing drawing;
	must(bench_fetch(NULL, scene, &request, store, must_error));
	must(bench_draw(&drawing, store, view, NULL, picture, must_error));
	must(view_reference_fine(&drawing.job, samples, picture, must_error));
	must(view_measure_soft(&drawing.job, picture, must_error));
	view_select_free(&drawing.selection);
}

/* This view's part is added to the rows. */
static void study_view(const struct srv_scene *scene, const struct eco_view *view, const struct effort *effort,
	budget_rows rows)
{
	struct view_store *store;
	struct view_picture full = { 0 }, none = { 0 };
	struct view_measures measures, nothing;
	must(view_store_new(&store, &(struct view_store_options){ .images = true }, must_error));
	shoot(scene, store, view, ECO_VERTICES_MAX, effort->samples, &full);
	shoot(scene, store, view, 0, effort->samples, &none);
	view_measure_pair(&none, &full, NULL, &nothing);
	for (uint32_t i = 0; i < effort->budgets; i++) {
		double most = fmax(1, (double)full.vertices / LEAST), share = i / (effort->budgets - 1.0),
			budget = floor(LEAST * pow(most, share) + 0.5);
		struct view_picture picture = { 0 };
		shoot(scene, store, view, (uint64_t)budget, effort->samples, &picture);
		view_measure_pair(&picture, &full, NULL, &measures);
		rows[i][BUDGET] += budget / effort->views;
		rows[i][VERTICES] += (double)picture.vertices / effort->views;
		rows[i][COLOR] += measures.blocks.color / fmax(nothing.blocks.color, 1e-9) / effort->views;
		rows[i][MISSED] += (1 - measures.soft_q) / effort->views;
		view_picture_free(&picture);
	}
	view_picture_free(&full);
	view_picture_free(&none);
	view_store_free(store);
}

struct work { const char *pack; const struct effort *effort; };

static json_t *measure(void *ctx)
{
	const struct work *work = ctx;
	struct srv_store store;
	budget_rows rows = { { 0 } };
	srv_store_init(&store);
	must(srv_store_add(&store, "bench", work->pack, must_error));
	const struct eco_scene *scene = &store.scenes[0]->pack->scene;
	for (uint32_t v = 0; v < work->effort->views; v++) {
		struct eco_view view;
		look(&view, &scene->anchors[scene->plants[0].anchor_first], v);
		study_view(store.scenes[0], &view, work->effort, rows);
	}
	srv_store_free(&store);
	return bench_reals(rows[0], work->effort->budgets * FIGURES);
}

/* ---- All plants ---- */

/* The largest rise of a figure above its least with fewer vertices. */
static void find_rise(budget_rows rows, uint32_t count, int figure, double *rise, double *at)
{
	double least = INFINITY;
	for (uint32_t i = 0; i < count; i++) {
		least = fmin(least, rows[i][figure]);
		if (rows[i][figure] - least > *rise) {
			*rise = rows[i][figure] - least;
			*at = rows[i][BUDGET];
		}
	}
}

/* Sums over plants: the two errors; plants whose errors rise, and that leave budget. */
struct sums { double plants, color, missed, rising, falling, unused; };

static void add_plant(struct bench_table *tables[2], struct sums *sums, const char *name, budget_rows rows,
	const struct work *work)
{
	struct stat file;
	uint32_t count = work->effort->budgets;
	double v[COLUMNS] = { [FULL] = rows[count - 1][BUDGET] };
	must(stat(work->pack, &file) ? eco_fail(must_error, ECO_IO, "%s is not there", work->pack) : ECO_OK);
	v[BYTES] = (double)file.st_size;
	find_rise(rows, count, COLOR, &v[RISE], &v[RISE_AT]);
	find_rise(rows, count, MISSED, &v[FALL], &v[FALL_AT]);
	for (uint32_t i = 0; i < count; i++) {
		double unused = 100 * (1 - rows[i][VERTICES] / rows[i][BUDGET]);
		bench_table_values(tables[1], rows[i], "%s", name);
		v[MEAN_COLOR] += rows[i][COLOR] / count;
		v[MEAN_MISSED] += rows[i][MISSED] / count;
		if (unused > v[UNUSED]) {
			v[UNUSED] = unused;
			v[UNUSED_AT] = rows[i][BUDGET];
		}
	}
	bench_table_values(tables[0], v, "%s", name);
	*sums = (struct sums){ sums->plants + 1, sums->color + v[MEAN_COLOR], sums->missed + v[MEAN_MISSED],
		sums->rising + (v[RISE] > RISE_MOST), sums->falling + (v[FALL] > RISE_MOST),
		sums->unused + (v[UNUSED] > UNUSED_MOST) };
}

static void study_kind(struct bench *bench, const struct bench_model *models, uint32_t count, bool draft)
{
	static const char *const keys[2][5] = { { "ladders_color", "ladders_missed", "ladders_rising",
		"ladders_falling", "ladders_unused" }, { "ladders_draft_color", "ladders_draft_missed",
		"ladders_draft_rising", "ladders_draft_falling", "ladders_draft_unused" } };
	static const char *const words[5] = { "error of colors, mean", "1 - soft Q, mean",
		"0: share of plants whose error of colors rises by more than .005",
		"0: share of plants whose soft Q falls by more than .005",
		"0: share of plants that leave more than 10 % of a budget" };
	char pack[512], name[96], stamp[40];
	struct sums s = { 0 };
	struct bench_table *tables[2] = { bench_table_described(bench, draft ? "ladders_draft" : "ladders", "plant",
		of_plants, COLUMNS, true), bench_table_described(bench, draft ? "ladders_draft_budgets"
		: "ladders_budgets", "plant", of_budgets, FIGURES, false) };
	for (uint32_t i = 0; i < count; i++) {
		budget_rows rows;
		struct work work = { pack, bench->full ? &thorough : &quick };
		bench_progress((double)i / count, models[i].name);
		bench_model_pack(bench, &models[i], draft, pack);
		snprintf(name, sizeof name, "ladders-%d-%u-%.64s", draft, work.effort->budgets, models[i].name);
		snprintf(stamp, sizeof stamp, "pack %016llx", (unsigned long long)bench_file_hash(pack));
		bench_cells(bench_unit(bench, name, stamp, measure, &work), rows[0], work.effort->budgets * FIGURES);
		add_plant(tables, &s, models[i].name, rows, &work);
	}
	bench_table_close(tables[0]);
	bench_table_close(tables[1]);
	for (int i = 0; i < 5; i++)
		bench_key(bench, keys[draft][i], (&s.color)[i] / s.plants, words[i]);
}

static void run(struct bench *bench)
{
	uint32_t count = 0;
	const struct bench_model *models = bench_models(bench, &count);
	for (uint32_t i = QUICK; !bench->full && i < count; i++)
		bench_left_out(bench, models[i].name);
	count = bench->full || count < QUICK ? count : QUICK;
	study_kind(bench, models, count, false);
	study_kind(bench, models, count, true);
}

const struct bench_section bench_ladders = { "ladders", "Whether ladders have gaps", run };
