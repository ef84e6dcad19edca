/* Motion in pictures that should stand still: slow cameras, a plan for every frame, and beside each picture
 * full detail of the same view (Neubert 2011, section 4.3 has hysteresis against the same, which a
 * stateless server has not).
 *
 *   shimmer   mean change of pixels from one frame to the next, while the camera moves 5 cm
 *   pop       change of whole blocks (lod_blocks_pop), while what the camera looks at moves 1/16 pixel
 *
 * Both are over those of full detail with 16 samples a pixel. Full detail with fewer shimmers more: leaves are finer
 * than a pixel. The cameras are those of pictures.json; they move sideways, so that near and far leaves move against
 * each other. The software rasteriser draws: the same bits everywhere. */
#include <math.h>
#include <string.h>
#include <xxhash.h>

#include "tests/bench/bench_fetch.h"
#include "tests/bench/bench_shots.h"

#define WIDTH 480u
#define HEIGHT 360u
#define STEP_M 0.05
#define STEP_PX 0.0625
#define PAIRS_QUICK 2u                   /* of frames */
#define PAIRS_FULL 12u
#define TRUTH_SIDE 4u                    /* 16 samples */

static const uint64_t budgets[] = { 100000, 300000, ECO_VERTICES_MAX };
enum { FULL = sizeof budgets / sizeof *budgets - 1, ROWS };      /* FULL: full detail */
/* Pictures of a frame; START: without leaves on splats. TRUTH: of full detail alone. */
enum { ONE, START, FINE, TRUTH, SHOWN };
static const struct { uint32_t samples; bool smooth; } shown[TRUTH] = { [ONE] = { 1, false },
	[START] = { 1, true }, [FINE] = { BENCH_SAMPLES, false } };
enum kind { SHIMMER, POP, KINDS };
#define FIGURES (ROWS * KINDS * TRUTH)

struct work { struct bench *bench; const struct bench_view *view; };
/* Two frames of one budget, by their samples. */
struct reel { struct view_store *store; struct view_picture before[SHOWN], after[SHOWN]; };

static void forget(struct view_picture frame[SHOWN])
{
	for (int i = 0; i < SHOWN; i++)
		view_picture_free(&frame[i]);
}

/* `steps` of one kind to the right. */
static struct eco_view moved(const struct eco_view *start, enum kind kind, uint32_t steps)
{
	struct eco_view view = *start;
	struct lod_eye eye;
	double way[3];
	view.width = WIDTH;
	view.height = HEIGHT;
	lod_eye_make(&eye, &view);
	for (int k = 0; k < 3; k++)
		way[k] = view.target[k] - view.eye[k];
	double step = kind == SHIMMER ? STEP_M : STEP_PX * eye.pixel_rad * sqrt(lod_dot(way, way));
	for (int k = 0; k < 3; k++) {
		view.eye[k] += steps * step * eye.right[k];
		view.target[k] += steps * step * eye.right[k];
	}
	return view;
}

static void shoot(struct reel *reel, const struct srv_scene *scene, uint32_t row, const struct eco_view *view,
	const struct view_sky *sky)
{
	struct eco_request request = { .view = *view, .vertices = budgets[row], .bytes = ECO_BYTES_UNBOUNDED,
		.ground_px = row < FULL ? 0 : ECO_GROUND_PX_MIN, .texel_px = row < FULL ? 0 : ECO_TEXEL_PX_MIN };
	struct bench_drawing drawing;
	must(bench_fetch(NULL, scene, &request, reel->store, must_error));
	must(bench_draw(&drawing, reel->store, view, sky, &reel->after[ONE], must_error));
	for (uint32_t i = START; i < SHOWN; i++) {
		must(view_picture_init(&reel->after[i], WIDTH, HEIGHT, must_error));
		drawing.job.samples = i < TRUTH ? shown[i].samples : 1;
		drawing.job.smooth = i < TRUTH && shown[i].smooth;
		if (i < TRUTH)
			must(view_reference_draw(&drawing.job, &reel->after[i], must_error));
		else if (row == FULL)
			must(view_reference_fine(&drawing.job, TRUTH_SIDE, &reel->after[i], must_error));
	}
	view_select_free(&drawing.selection);
}

/* One kind of motion along one camera, all budgets: means over pairs of frames. */
static void run_motion(const struct work *w, struct reel reels[ROWS], const struct srv_scene *scene, enum kind kind,
	double figure[ROWS][KINDS][TRUTH])
{
	const struct reel *full = &reels[FULL];
	uint32_t pairs = w->bench->full ? PAIRS_FULL : PAIRS_QUICK;
	for (uint32_t i = 0; i <= pairs; i++) {
		const struct eco_view view = moved(&w->view->view, kind, i);
		for (uint32_t row = ROWS; row-- > 0;) {
			struct reel *reel = &reels[row];
			forget(reel->before);
			for (int k = 0; k < SHOWN; k++) {
				reel->before[k] = reel->after[k];
				reel->after[k] = (struct view_picture){ 0 };
			}
			shoot(reel, scene, row, &view, &w->bench->sky);
			for (int k = 0; k < TRUTH && i > 0; k++) {
				struct view_motion motion;
				view_measure_motion(WIDTH, HEIGHT,
					(const uint8_t *const[2]){ reel->before[k].rgb, reel->after[k].rgb },
					(const uint8_t *const[2]){ full->before[TRUTH].rgb, full->after[TRUTH].rgb },
					&motion);
				figure[row][kind][k] += (kind == SHIMMER ? motion.shimmer : motion.pop) / pairs;
			}
		}
	}
}

/* The unit: figures by budget, kind and samples. */
static json_t *run_camera(void *ctx)
{
	const struct work *w = ctx;
	struct reel reels[ROWS] = { { NULL } };
	double figure[ROWS][KINDS][TRUTH] = { { { 0 } } };
	struct srv_store served;
	srv_store_init(&served);
	must(srv_store_add(&served, "steadiness", w->view->pack, must_error));
	for (int row = 0; row < ROWS; row++)
		must(view_store_new(&reels[row].store, &(struct view_store_options){ .images = true,
			.memory_max = 16ull << 30 }, must_error));
	for (int kind = 0; kind < KINDS; kind++)
		run_motion(w, reels, served.scenes[0], (enum kind)kind, figure);
	for (int row = 0; row < ROWS; row++) {
		forget(reels[row].before);
		forget(reels[row].after);
		view_store_free(reels[row].store);
	}
	srv_store_free(&served);
	return bench_reals(figure[0][0], FIGURES);
}

/* ---- Report ---- */

static const struct bench_column columns[] = { { "shimmer 1 sample", 3 }, { "start", 3 }, { "8", 3 },
	{ "pop 1 sample", 3 }, { "start", 3 }, { "8", 3 }, { "shimmer over full detail's 1 sample", 3 },
	{ "start", 3 }, { "8", 3 } };
enum { OVER = KINDS * TRUTH, COLUMNS = OVER + TRUTH };

/* Cameras that the quick bench looks at. */
static const struct { const char *scene, *camera; } slow[] = { { "park", "45" }, { "grove", "eye" },
	{ "forest", "45" } };
#define SCENES_QUICK 4u                  /* the first of pictures.json, which hold them */

struct study { struct bench_table *table; double least, most, pop; };

static bool asked(const struct bench *bench, const struct bench_view *view)
{
	bool is = bench->full;
	for (size_t i = 0; i < sizeof slow / sizeof *slow; i++)
		is |= !strcmp(slow[i].scene, view->scene) && !strcmp(slow[i].camera, view->camera);
	return is;
}

static void study_view(struct bench *bench, void *ctx, const struct bench_view *view)
{
	struct study *s = ctx;
	double figure[ROWS][KINDS][TRUTH], value[COLUMNS];
	char name[96];
	if (!asked(bench, view))
		return;
	snprintf(name, sizeof name, "steadiness-%s-%s-%016llx-%s", view->scene, view->camera,
		(unsigned long long)XXH3_64bits(&view->view, sizeof view->view), bench->full ? "full" : "quick");
	bench_cells(bench_unit(bench, name, bench_pack_stamp(view->pack), run_camera, &(struct work){ bench, view }),
		figure[0][0], FIGURES);
	for (uint32_t row = 0; row < ROWS; row++) {
		char budget[24] = "full detail";
		if (row < FULL)
			snprintf(budget, sizeof budget, "%llu", (unsigned long long)budgets[row]);
		for (uint32_t i = 0; i < OVER; i++)
			value[i] = figure[row][i / TRUTH][i % TRUTH];
		for (uint32_t i = 0; i < TRUTH; i++)
			value[OVER + i] = value[i] / figure[FULL][SHIMMER][i];
		bench_table_values(s->table, value, "%s,%s,%s", view->scene, view->camera, budget);
		if (row == FULL)
			continue;
		s->least = fmin(s->least, value[OVER + FINE]);
		s->most = fmax(s->most, value[OVER + FINE]);
		s->pop = fmax(s->pop, figure[row][POP][FINE] / figure[row][POP][START]);
	}
}

static void run(struct bench *bench)
{
	struct study s = { .least = NAN, .most = NAN, .pop = NAN };
	s.table = bench_table_described(bench, "steadiness", "scene,camera,vertices", columns, COLUMNS, true);
	bench_views_each(bench, SCENES_QUICK, study_view, &s);
	bench_table_close(s.table);
	bench_say(bench, "Cameras move sideways, %u x %u pixels. Shimmer: mean change of pixels at %g cm a frame; pop: the "
		"largest change of a block of 16 x 16 pixels but for one in a thousand, at 1/16 pixel a frame; both over "
		"those of full detail with 16 samples a pixel. The start has 1 sample and no leaves on splats.",
		WIDTH, HEIGHT, 100 * STEP_M);
	bench_key(bench, "steadiness_shimmer_least", s.least,
		">= 0.85: shimmer over full detail's at 8 samples, the least of any camera");
	bench_key(bench, "steadiness_shimmer_most", s.most, "<= 1.1: the most");
	bench_key(bench, "steadiness_pop", s.pop, "<= 1: pop at 8 samples over the start's, worst camera");
}

const struct bench_section bench_steadiness = { "steadiness", "Steadiness: slow cameras", run };
