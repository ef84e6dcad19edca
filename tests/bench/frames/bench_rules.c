/* The papers' rules on whole scenes, drawn, beside ours.
 *
 *   rules    at as many vertices: Deussen 2002 as printed, with his lists and with ours; Cook's 1 / lambda plain
 *            and corrected; Neubert's lambda_opt, with and without occlusion; Lee's orders of cells
 *   curves   error against processor time, vertices and bytes, with 1 to 16 samples a pixel */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/baseline/paper_rules.h"
#include "tests/bench/bench_fetch.h"
#include "tests/bench/bench_shots.h"

#define VERTICES 100000u
#define EQUAL 0.99 /* a rule that draws fewer than this share is set against ours at its vertices */
#define FRAMES 6u  /* until what plants hide of each other has settled */

static const char *const scenes[] = { "park", "outdoor", "trees5000", "scbi" };
#define SCENES (sizeof scenes / sizeof *scenes)

enum rule {
	DEUSSEN_OURS,
	DEUSSEN_2002,
	COOK,
	COOK_CORRECTED,
	NEUBERT,
	NEUBERT_OCCLUDED,
	LEE_FIRST,
	RULES = LEE_FIRST + LOD_LEE_COUNT
};
static const char *const names[] = { "Deussen's rule on our lists", "Deussen 2002 as printed",
	"Cook 1/lambda", "Cook corrected", "Neubert", "Neubert with occlusion" };

static const char *name_of(uint32_t rule)
{
	return rule < LEE_FIRST ? names[rule] : paper_lee_names[rule - LEE_FIRST];
}

/* Figures of the rule, then the same of ours at its vertices. */
static const struct bench_column columns[] = { { "vertices", 0 }, { "wrong pixels", 0 }, { "Q", 4 }, {
	"owner_q", 4 }, { "S8", 4 }, { "m16", 3 }, { "s16", 3 }, { "vertices of ours", 0 }, { "wrong of ours", 0 },
	{ "Q of ours", 4 }, { "owner_q of ours", 4 }, { "S8 of ours", 4 }, { "m16 of ours", 3 }, { "s16 of ours", 3 },
	{ "fewer wrong by ours %", 1 } };
enum { WRONG = 1, OWNER_Q = 3, OURS = 7, FIGURES = 14, FEWER = FIGURES, COLUMNS };

/* ---- Frames ---- */

struct shot {
	struct bench *bench;
	const char *scene;
	char ours[512], stochastic[512], stamp[640];
	uint32_t view;
	struct eco_request request;
	struct bench_client *client;
	struct paper_scene *papers; /* of the stochastic order */
	struct paper_table *tables;
};

static json_t *row_of(const struct bench_frame *theirs, const struct bench_frame *ours)
{
	double row[FIGURES], *at = row;
	for (const struct bench_frame *f = theirs;; f = ours) {
		const struct view_measures *m = &f->measures;
		*at++ = (double)f->vertices;
		*at++ = (double)(m->score.fp + m->score.fn);
		*at++ = m->score.q;
		*at++ = m->score.owner_q;
		*at++ = m->picture_error;
		*at++ = m->blocks.color;
		*at++ = m->blocks.contrast;
		if (f == ours)
			return bench_reals(row, FIGURES);
	}
}

static void solve(struct shot *shot, paper_rule *rule, void *ctx, struct paper_frame *frame)
{
	double x = 0;
	paper_shoot(shot->papers, &shot->request, rule, ctx, &x, BENCH_SAMPLES, frame);
}

/* The same view some times: f of each comes from the frame before. The last one is judged. */
static void solve_occluded(struct shot *shot, struct paper_frame *frame)
{
	struct paper_cook cook = { .tables = shot->tables, .optimal = true,
		.sight = paper_sight_new(shot->papers) };
	for (uint32_t i = 0; i < FRAMES; i++) {
		double x = 0;
		paper_frame_free(frame);
		paper_shoot(shot->papers, &shot->request, paper_cook, &cook, &x, i + 1 < FRAMES ? 0 : BENCH_SAMPLES,
			frame);
		paper_sight_update(cook.sight, frame, &shot->request.view);
	}
	paper_sight_free(cook.sight);
}

static void draw_rule(struct shot *shot, uint32_t rule, struct paper_frame *frame)
{
	struct paper_cook cook = { .tables = rule == COOK ? NULL : shot->tables, .optimal = rule == NEUBERT };
	if (rule >= LEE_FIRST) {
		struct paper_lee lee = { .tables = shot->tables, .method = rule - LEE_FIRST };
		paper_lee_begin(&lee, shot->papers);
		solve(shot, paper_lee, &lee, frame);
		paper_lee_end(&lee);
	} else if (rule == NEUBERT_OCCLUDED) {
		solve_occluded(shot, frame);
	} else if (rule == DEUSSEN_2002) {
		solve(shot, paper_deussen, NULL, frame);
	} else {
		solve(shot, paper_cook, &cook, frame);
	}
}

static json_t *shoot_rule(struct shot *shot, uint32_t rule, const struct bench_frame *base,
	const struct view_picture *base_picture)
{
	struct bench_frame theirs = { .request = shot->request, .rule = lod_rule_deussen }, ours = *base;
	struct paper_frame frame = { 0 };
	struct bench *bench = shot->bench;
	char file[128];
	if (rule == DEUSSEN_OURS) {
		bench_client_frame(shot->client, &theirs, &frame.picture);
	} else {
		draw_rule(shot, rule, &frame);
		theirs.vertices = frame.picture.vertices;
		bench_client_score(shot->client, &theirs, &frame.picture);
	}
	if ((double)theirs.vertices < EQUAL * VERTICES) {
		ours.request.vertices = theirs.vertices;
		bench_client_frame(shot->client, &ours, NULL);
	}
	snprintf(file, sizeof file, "rules-%s-%u-%u.png", shot->scene, shot->view, rule);
	bench_pictures_write(bench, file, frame.picture.width, frame.picture.height,
		(const uint8_t *const[]){ base_picture->rgb, frame.picture.rgb,
		bench_client_full(shot->client)->rgb }, 3);
	paper_frame_free(&frame);
	return row_of(&theirs, &ours);
}

/* ---- Scenes ---- */

/* Packs are opened when the first view is not known yet. */
static void open_packs(struct shot *shot)
{
	if (shot->client)
		return;
	shot->client = bench_client_open(shot->ours);
	bench_client_see(shot->client, shot->bench);
	bench_client_untimed(shot->client);
	must(paper_scene_open(&shot->papers, shot->stochastic, must_error));
	shot->papers->sky = shot->bench->sky;
	shot->tables = paper_tables_make(shot->papers);
}

static json_t *shoot(void *ctx)
{
	struct shot *shot = ctx;
	struct bench_frame base = { .request = shot->request };
	struct view_picture picture = { 0 };
	open_packs(shot);
	bench_client_frame(shot->client, &base, &picture);
	json_t *rows = json_array();
	for (uint32_t r = 0; r < RULES; r++)
		json_array_append_new(rows, shoot_rule(shot, r, &base, &picture));
	view_picture_free(&picture);
	return rows;
}

static void find_packs(struct shot *shot, struct bench *bench, const char *scene)
{
	*shot = (struct shot){ .bench = bench, .scene = scene };
	bench_scene(bench, scene, NULL, shot->ours);
	bench_scene(bench, scene, "stochastic", shot->stochastic);
	int size = snprintf(shot->stamp, sizeof shot->stamp, "%s", bench_pack_stamp(shot->ours));
	snprintf(shot->stamp + size, sizeof shot->stamp - (size_t)size, " %s", bench_pack_stamp(shot->stochastic));
}

static void close_packs(struct shot *shot)
{
	bench_client_close(shot->client);
	free(shot->tables);
	paper_scene_close(shot->papers);
}

/* Means over the views. */
static void study(struct bench *bench, const char *scene, double mean[RULES][COLUMNS])
{
	char name[96];
	struct shot shot;
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	find_packs(&shot, bench, scene);
	uint32_t views = bench_shot_views(bench, scene, requests);
	for (uint32_t v = 0; v < views; v++) {
		json_t *rows;
		snprintf(name, sizeof name, "rules-%s-%u-%u", scene, v, views);
		shot.view = v;
		shot.request = requests[v];
		shot.request.vertices = VERTICES;
		rows = bench_unit(bench, name, shot.stamp, shoot, &shot);
		for (uint32_t i = 0; i < RULES * FIGURES; i++)
			mean[i / FIGURES][i % FIGURES] += bench_cell(json_array_get(rows, i / FIGURES),
				i % FIGURES) / views;
	}
	for (uint32_t r = 0; r < RULES; r++)
		mean[r][FEWER] = 100 * (1 - mean[r][OURS + WRONG] / mean[r][WRONG]);
	close_packs(&shot);
}

static void write_scene(struct bench *bench, struct bench_table *table, const char *scene,
	double mean[RULES][COLUMNS])
{
	static const struct { const char *scene, *bar; } equal[] = {
		{ "scbi", ">= 0.6: fewer wrong pixels than by Deussen's rule, equal lists" },
		{ "outdoor", ">= 0.25: likewise" }, { "trees5000", ">= 0.08: likewise" } };
	char file[128], caption[192];
	for (uint32_t r = 0; r < RULES; r++) {
		bench_table_values(table, mean[r], "%s,%s", scene, name_of(r));
		if (r != DEUSSEN_2002 && r != COOK_CORRECTED && r != NEUBERT_OCCLUDED)
			continue;
		snprintf(file, sizeof file, "rules-%s-0-%u.png", scene, r);
		snprintf(caption, sizeof caption, "%s at %u vertices: ours; %s; truth", scene, VERTICES,
			name_of(r));
		bench_picture(bench, file, caption);
	}
	for (size_t i = 0; i < sizeof equal / sizeof *equal; i++) {
		char key[64];
		snprintf(key, sizeof key, "rules_deussen_%s", scene);
		if (!strcmp(equal[i].scene, scene))
			bench_key(bench, key, mean[DEUSSEN_OURS][FEWER] / 100, equal[i].bar);
	}
}

static void run_rules(struct bench *bench)
{
	double printed = INFINITY, owner = INFINITY;
	bench_say(bench,
		"Every frame is drawn by the software rasteriser, %u vertices, mean of the views of "
		"`frames`; ours stands beside each rule at the vertices that it drew. Cook, Neubert and "
		"Lee keep lambda = min(1, (r / R)^2) of the leaves at distance R, r by the budget, and draw "
		"the wood of our ladders, from packs of the stochastic order. Cook's contrast is not "
		"corrected: it moves no pixel of the mask.",
		VERTICES);
	struct bench_table *table = bench_table_described(bench, "rules", "scene,rule", columns, COLUMNS,
		true);
	for (size_t i = 0; i < SCENES; i++) {
		double mean[RULES][COLUMNS] = { { 0 } };
		char pack[512];
		bench_progress((double)i / SCENES, scenes[i]);
		if (!bench_scene_there(bench, scenes[i], pack))
			continue;
		study(bench, scenes[i], mean);
		write_scene(bench, table, scenes[i], mean);
		printed = fmin(printed, mean[DEUSSEN_2002][FEWER] / 100);
		for (uint32_t r = COOK; r <= COOK_CORRECTED; r++)
			owner = fmin(owner, mean[r][OURS + OWNER_Q] - mean[r][OWNER_Q]);
	}
	bench_table_close(table);
	if (!isfinite(printed))
		return;
	bench_key(bench, "rules_deussen_2002", printed,
		">= 0.3: fewer wrong pixels than by Deussen 2002 as printed, worst scene");
	bench_key(bench, "rules_cook_owner_q", owner,
		">= 0: owner_q above Cook's at equal vertices, worst scene");
}

const struct bench_section bench_rules = { "rules", "The papers' rules on whole scenes", run_rules };

/* ---- Curves ---- */

#define CURVE_VIEWS_QUICK 1u
#define CURVE_VIEWS_FULL 3u

static const char *const curve_scenes[] = { "park", "scbi", "trees5000" };
#define CURVE_SCENES (sizeof curve_scenes / sizeof *curve_scenes)
static const uint64_t curve_budgets[] = { 30000, 100000, 300000, 1000000 };
#define CURVE_BUDGETS (sizeof curve_budgets / sizeof *curve_budgets)
static const uint32_t curve_samples[] = { 1, 4, 8, 16 };
#define CURVE_SAMPLES (sizeof curve_samples / sizeof *curve_samples)
#define CURVE_SHOWN 2u                       /* the samples of a paper's line in plots: BENCH_SAMPLES */
/* RULES: ours. OURS_BY_BYTES: ours with as many bytes as Cook's lists take. Without a budget of bytes an
 * answer of 300,000 vertices is larger than one of a million: it has splats and coarser steps, and full detail
 * has not. */
#define OURS_BY_BYTES (RULES + 1)
#define CURVE_BYTES 2u                       /* Cook's */
static const uint32_t curve_rules[] = { RULES, DEUSSEN_2002, COOK_CORRECTED, OURS_BY_BYTES, NEUBERT_OCCLUDED,
	LEE_FIRST + LOD_LEE_LAYER };
#define CURVES (sizeof curve_rules / sizeof *curve_rules)

/* The first three are axes. */
static const struct bench_column curve_columns[] = { { "CPU ms", 1 }, { "vertices", 0 }, { "bytes", 0 }, { "S", 4 },
	{ "m16", 3 }, { "abs s16", 3 }, { "1 - Q", 4 } };
enum { CPU, DRAWN, BYTES, AXES, CURVE_COLUMNS = 7 };

/* By samples. */
struct curve_point { double figure[CURVE_SAMPLES][CURVE_COLUMNS]; };
struct curve { struct curve_point points[CURVE_BUDGETS]; };
struct sampling { const struct bench_client *client; struct curve_point *point; };

static void sample_job(void *ctx, const struct view_draw_job *job)
{
	const struct sampling *s = ctx;
	for (size_t k = 0; k < CURVE_SAMPLES; k++) {
		struct view_measures m;
		double cpu_ms = bench_client_sample(s->client, job, curve_samples[k], &m);
		const double figures[CURVE_COLUMNS] = { cpu_ms, 0, 0, m.picture_error, m.blocks.color,
			m.blocks.contrast_abs, 1 - m.score.q };
		memcpy(s->point->figure[k], figures, sizeof figures);
	}
}

/* NaN where no answer has so few bytes. */
static void sample_ours(struct shot *shot, uint64_t bytes, struct curve_point *point)
{
	struct sampling sampling = { shot->client, point };
	struct bench_frame ours = { .request = shot->request, .look = sample_job, .ctx = &sampling };
	ours.request.bytes = bytes;
	bool drawn = bench_client_frame(shot->client, &ours, NULL);
	for (size_t k = 0; k < CURVE_SAMPLES; k++) {
		for (size_t i = 0; i < CURVE_COLUMNS && !drawn; i++)
			point->figure[k][i] = NAN;
		point->figure[k][DRAWN] = drawn ? (double)ours.vertices : NAN;
		point->figure[k][BYTES] = drawn ? (double)ours.bytes : NAN;
	}
}

static void sample_rule(struct shot *shot, uint32_t rule, struct curve_point *point)
{
	struct sampling sampling = { shot->client, point };
	struct paper_frame theirs = { .bytes = NAN };
	struct lod_eye eye;
	draw_rule(shot, rule, &theirs);
	lod_eye_make(&eye, &shot->request.view);
	sample_job(&sampling, &(struct view_draw_job){ .store = shot->papers->store, .eye = &eye,
		.selection = &theirs.selection, .near_m = bench_near_m(shot->papers->store) });
	for (size_t k = 0; k < CURVE_SAMPLES; k++) {
		point->figure[k][DRAWN] = (double)theirs.picture.vertices;
		point->figure[k][BYTES] = theirs.bytes;
	}
	paper_frame_free(&theirs);
}

/* The unit: figures by curve, budget and samples. */
#define CURVE_NUMBERS (CURVES * sizeof(struct curve) / sizeof(double))

static json_t *sample_view(void *ctx)
{
	struct shot *shot = ctx;
	struct curve curves[CURVES];
	open_packs(shot);
	bench_client_reference(shot->client, &shot->request);
	for (size_t b = 0; b < CURVE_BUDGETS; b++) {
		shot->request.vertices = curve_budgets[b];
		for (size_t c = 0; c < CURVES; c++) {
			bench_progress(((double)b + (double)c / CURVES) / CURVE_BUDGETS, shot->scene);
			if (curve_rules[c] < RULES)
				sample_rule(shot, curve_rules[c], &curves[c].points[b]);
			else
				sample_ours(shot, curve_rules[c] == RULES ? ECO_BYTES_UNBOUNDED : (uint64_t)
					curves[CURVE_BYTES].points[b].figure[0][BYTES], &curves[c].points[b]);
		}
	}
	return bench_reals(curves[0].points[0].figure[0], CURVE_NUMBERS);
}

static const char *curve_name(size_t c)
{
	return curve_rules[c] < RULES ? name_of(curve_rules[c]) : curve_rules[c] == RULES ? "ours"
		: "ours at Cook's bytes";
}

static void plot_curves(struct bench *bench, const char *scene, const struct curve curves[CURVES], uint32_t x, uint32_t y)
{
	struct bench_series series[CURVES + CURVE_SAMPLES];
	double at[CURVES + CURVE_SAMPLES][2][CURVE_BUDGETS];
	char labels[CURVES + CURVE_SAMPLES][96], name[96], title[128];
	uint32_t count = 0;
	for (size_t c = 0; c < CURVES; c++)
		for (uint32_t k = 0; k < CURVE_SAMPLES; k++) {
			if (c > 0 && k != CURVE_SHOWN)
				continue;
			for (size_t b = 0; b < CURVE_BUDGETS; b++) {
				at[count][0][b] = curves[c].points[b].figure[k][x];
				at[count][1][b] = curves[c].points[b].figure[k][y];
			}
			snprintf(labels[count], sizeof *labels, "%s, %u sample%s", curve_name(c), curve_samples[k],
				k ? "s" : "");
			series[count] = (struct bench_series){ labels[count], at[count][0], at[count][1],
				CURVE_BUDGETS, false };
			count++;
		}
	snprintf(name, sizeof name, "curves-%s-%u-%u", scene, y - AXES, x);
	snprintf(title, sizeof title, "%s: %s over %s", scene, curve_columns[y].head, curve_columns[x].head);
	bench_plot(bench, &(struct bench_plot){ name, title, curve_columns[x].head, curve_columns[y].head, true, true,
		series, count });
}

static void study_curves(struct bench *bench, const char *scene, struct bench_table *table)
{
	struct shot shot;
	struct curve mean[CURVES] = { { { { { { 0 } } } } } };
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	double *sum = mean[0].points[0].figure[0];
	uint32_t most = bench->full ? CURVE_VIEWS_FULL : CURVE_VIEWS_QUICK;
	find_packs(&shot, bench, scene);
	uint32_t views = bench_shot_views(bench, scene, requests);
	views = views < most ? views : most;
	for (uint32_t v = 0; v < views; v++) {
		char name[96];
		snprintf(name, sizeof name, "curves-%s-%u-%u", scene, v, views);
		shot.request = requests[v];
		const json_t *row = bench_unit(bench, name, shot.stamp, sample_view, &shot);
		for (uint32_t i = 0; i < CURVE_NUMBERS; i++)
			sum[i] += bench_cell(row, i) / views;
	}
	close_packs(&shot);
	for (size_t c = 0; c < CURVES; c++)
		for (size_t k = 0; k < CURVE_SAMPLES; k++)
			for (size_t b = 0; b < CURVE_BUDGETS; b++)
				bench_table_values(table, mean[c].points[b].figure[k], "%s,%s,%u,%llu", scene,
					curve_name(c), curve_samples[k], (unsigned long long)curve_budgets[b]);
	for (uint32_t y = AXES; y < CURVE_COLUMNS; y++)
		for (uint32_t x = 0; x < AXES; x++)
			plot_curves(bench, scene, mean, x, y);
}

static void run_curves(struct bench *bench)
{
	struct bench_table *table = bench_table_described(bench, "curves", "scene,method,samples,budget", curve_columns,
		CURVE_COLUMNS, true);
	bench_say(bench, "Errors against the truth of frames drawn in software with 1, 4, 8 and 16 samples a pixel; "
		"plots show the papers' at %u. CPU: processor time of drawing, all samples. Bytes of ours are a whole "
		"first answer with its coarser steps, without a budget of bytes and with Cook's bytes as one; "
		"those of Cook, Neubert and Lee the chunks that their lists need and the plan. Deussen's points and "
		"lines are in no pack: he has no bytes. S is the picture error.",
		BENCH_SAMPLES);
	for (size_t i = 0; i < CURVE_SCENES; i++) {
		char pack[512];
		if (bench_scene_there(bench, curve_scenes[i], pack))
			study_curves(bench, curve_scenes[i], table);
	}
	bench_table_close(table);
}

const struct bench_section bench_curves = { "curves", "Error against run time by samples", run_curves };
