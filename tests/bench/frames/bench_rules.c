/* The papers' rules on whole scenes, drawn, beside ours at as many vertices: Deussen 2002 as printed, with
 * his lists and with ours; Cook's 1 / lambda plain and corrected; Neubert's lambda_opt, with and without
 * occlusion; Lee's orders of cells. */
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
		paper_shoot(shot->papers, &shot->request, paper_cook, &cook, &x,
			i + 1 < FRAMES ? 0 : BENCH_SAMPLES, frame);
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
