/* The papers' rules on whole scenes, drawn, beside ours at as many vertices: Deussen 2002 as printed, with
 * his lists and with ours; Cook's 1 / lambda plain and corrected; Neubert's lambda_opt, with and without
 * occlusion; Lee's orders of cells. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/baseline/paper_lee.h"
#include "tests/bench/baseline/paper_neubert.h"
#include "tests/bench/baseline/paper_rules.h"
#include "tests/bench/bench_shots.h"

#define VERTICES 100000u
#define EQUAL 0.99 /* a rule that draws fewer than this share is set against ours at its vertices */
#define FRAMES 6u  /* until what plants hide of each other has settled */

static const char *const scenes[] = { "park", "outdoor", "trees5000", "scbi" };
#define SCENES (sizeof scenes / sizeof *scenes)

enum rule {
	DEUSSEN_OURS,
	DEUSSEN_PLAIN,
	DEUSSEN_2002,
	COOK,
	COOK_CORRECTED,
	NEUBERT,
	NEUBERT_OCCLUDED,
	LEE_FIRST,
	RULES = LEE_FIRST + PAPER_LEE_RULES
};
static const char *const names[] = { "Deussen's rule on our lists", "the same with triangles lines points",
	"Deussen 2002 as printed", "Cook 1/lambda", "Cook corrected", "Neubert", "Neubert with occlusion" };

static const char *name_of(uint32_t rule)
{
	return rule < LEE_FIRST ? names[rule] : paper_lee_names[rule - LEE_FIRST];
}

/* ---- Frames ---- */

struct shot {
	struct bench *bench;
	const char *scene;
	uint32_t view;
	struct eco_request request;
	struct bench_client *client;
	struct paper_scene *ours, *papers; /* packs: of our order, of the stochastic order */
	struct paper_tables *tables;
	struct view_picture base; /* ours */
};

static json_t *row_of(uint32_t rule, const struct bench_frame *frame, const struct bench_frame *ours)
{
	const struct bench_frame *both[2] = { frame, ours };
	json_t *row = json_object();
	json_object_set_new(row, "rule", json_string(name_of(rule)));
	for (int i = 0; i < 2; i++) {
		json_t *half = json_object();
		bench_shot_set(half, "vertices", (double)both[i]->vertices);
		bench_shot_set(half, "wrong", (double)(both[i]->score.fp + both[i]->score.fn));
		bench_shot_set(half, "q", both[i]->score.q);
		bench_shot_set(half, "owner_q", both[i]->score.owner_q);
		bench_shot_set(half, "picture_error", both[i]->picture_error);
		json_object_set_new(row, i ? "ours" : "theirs", half);
	}
	return row;
}

/* The planner's rule for lists of triangles, lines and points alone. */
static enum eco_code plan_plain(struct shot *shot, struct eco_plan *plan, struct eco_error *error)
{
	struct eco_scene scene = *shot->ours->scene;
	struct eco_ladder *ladders = malloc((scene.ladder_count + 1u) * sizeof *ladders);
	if (!ladders)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for ladders");
	memcpy(ladders, scene.ladders, scene.ladder_count * sizeof *ladders);
	for (uint32_t i = 0; i < scene.ladder_count; i++)
		ladders[i].simple = ECO_NONE;
	scene.ladders = ladders;
	enum eco_code code = lod_plan(plan,
		&(struct lod_planner_input){ .scene = &scene,
			.request = &shot->request,
			.rule = lod_rule_deussen },
		error);
	free(ladders);
	return code;
}

static enum eco_code solve(struct shot *shot, paper_rule *rule, void *ctx, double few, double many,
	struct paper_frame *frame, struct eco_error *error)
{
	struct paper paper;
	struct eco_plan plan = { 0 };
	double x;
	enum eco_code code = paper_begin(&paper, shot->papers, &shot->request, error);
	if (!code)
		code = paper_solve(&paper, rule, ctx, few, many, &x, &plan, error);
	paper_end(&paper);
	return code ? code : paper_draw(shot->papers, &plan, &shot->request.view, true, frame, error);
}

/* The same view some times: f of each comes from the frame before. */
static enum eco_code solve_occluded(struct shot *shot, struct paper_frame *frame, struct eco_error *error)
{
	struct paper_cook cook = { .tables = shot->tables, .optimal = true };
	enum eco_code code = paper_sight_new(&cook.sight, shot->papers, error);
	for (uint32_t i = 0; i < FRAMES && !code; i++) {
		paper_frame_free(frame);
		code = solve(shot, paper_cook, &cook, 1e-3, 1e5, frame, error);
		if (!code)
			paper_sight_update(cook.sight, frame, &shot->request.view);
	}
	paper_sight_free(cook.sight);
	return code;
}

static enum eco_code draw_rule(struct shot *shot, uint32_t rule, struct paper_frame *frame,
	struct eco_error *error)
{
	struct paper_cook cook = { .tables = rule == COOK ? NULL : shot->tables, .optimal = rule == NEUBERT };
	struct eco_plan plan = { 0 };
	enum eco_code code;
	switch (rule) {
	case DEUSSEN_PLAIN:
		code = plan_plain(shot, &plan, error);
		return code ? code : paper_draw(shot->ours, &plan, &shot->request.view, true, frame, error);
	case DEUSSEN_2002:
		return solve(shot, paper_deussen, NULL, 2, 1e-6, frame, error);
	case COOK:
	case COOK_CORRECTED:
	case NEUBERT:
		return solve(shot, paper_cook, &cook, 1e-3, 1e5, frame, error);
	case NEUBERT_OCCLUDED:
		return solve_occluded(shot, frame, error);
	default: {
		struct paper_lee lee = { .tables = shot->tables, .rule = rule - LEE_FIRST };
		code = paper_lee_begin(&lee, shot->papers, error);
		code = code ? code : solve(shot, paper_lee, &lee, 1e-3, 1e5, frame, error);
		paper_lee_end(&lee);
		return code;
	}
	}
}

static enum eco_code write_three(const struct shot *shot, uint32_t rule, const struct view_picture *theirs,
	struct eco_error *error)
{
	const struct view_picture *full = bench_client_full(shot->client),
				  *parts[3] = { &shot->base, theirs, full };
	uint32_t w = full->width, h = full->height;
	uint8_t *rgb = malloc((size_t)w * h * 9);
	char file[128], caption[192];
	if (!rgb)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	for (uint32_t y = 0; y < h; y++)
		for (uint32_t i = 0; i < 3; i++)
			memcpy(rgb + ((size_t)y * 3 + i) * w * 3, parts[i]->rgb + (size_t)y * w * 3,
				(size_t)w * 3);
	snprintf(file, sizeof file, "rules-%s-%u-%u.png", shot->scene, shot->view, rule);
	snprintf(caption, sizeof caption, "%s, %u vertices: ours; %s; full detail", shot->scene, VERTICES,
		name_of(rule));
	enum eco_code code = bench_picture_write(shot->bench, file, 3 * w, h, rgb, error);
	free(rgb);
	return code;
}

static enum eco_code shoot_rule(struct shot *shot, uint32_t rule, const struct bench_frame *base,
	json_t *rows, struct eco_error *error)
{
	struct bench_frame theirs = { .request = shot->request, .rule = lod_rule_deussen }, ours = *base;
	struct paper_frame frame = { 0 };
	enum eco_code code = ECO_OK;
	if (rule == DEUSSEN_OURS) {
		code = bench_client_frame(shot->client, &theirs, &frame.picture, error);
	} else {
		code = draw_rule(shot, rule, &frame, error);
		theirs.vertices = frame.picture.vertices;
		if (!code)
			code = bench_client_score(shot->client, &theirs, &frame.picture, error);
	}
	if (!code && (double)theirs.vertices < EQUAL * VERTICES) {
		ours.request.vertices = theirs.vertices;
		code = bench_client_frame(shot->client, &ours, NULL, error);
	}
	if (!code)
		code = write_three(shot, rule, &frame.picture, error);
	if (!code)
		json_array_append_new(rows, row_of(rule, &theirs, &ours));
	paper_frame_free(&frame);
	return code;
}

static enum eco_code shoot(struct shot *shot, json_t **rows, struct eco_error *error)
{
	struct bench_frame base = { .request = shot->request };
	enum eco_code code = bench_client_frame(shot->client, &base, &shot->base, error);
	json_t *made = json_array();
	for (uint32_t r = 0; r < RULES && !code; r++)
		code = bench_stopped(shot->bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
						  : shoot_rule(shot, r, &base, made, error);
	view_picture_free(&shot->base);
	if (code)
		json_decref(made);
	else
		*rows = made;
	return code;
}

/* ---- Scenes ---- */

/* Packs are opened when the first view is not known yet. */
static enum eco_code open_packs(struct shot *shot, const char *ours, const char *papers,
	struct eco_error *error)
{
	if (shot->client)
		return ECO_OK;
	enum eco_code code = bench_client_open(&shot->client, ours, error);
	if (!code) {
		bench_client_see(shot->client);
		bench_client_keep(shot->client, shot->bench);
		bench_client_untimed(shot->client);
		code = paper_scene_open(&shot->ours, ours, error);
	}
	if (!code)
		code = paper_scene_open(&shot->papers, papers, error);
	return code ? code : paper_tables_make(&shot->tables, shot->papers, error);
}

static void close_packs(struct shot *shot)
{
	bench_client_close(shot->client);
	paper_tables_free(shot->tables);
	paper_scene_close(shot->ours);
	paper_scene_close(shot->papers);
}

struct sums {
	double theirs[5], ours[5];
	uint32_t views;
};
static const char *const figures[5] = { "vertices", "wrong", "q", "owner_q", "picture_error" };

static void add_rows(struct sums *sums, const json_t *rows)
{
	for (uint32_t r = 0; r < RULES; r++) {
		const json_t *row = json_array_get(rows, r), *theirs = json_object_get(row, "theirs"),
			     *ours = json_object_get(row, "ours");
		for (int f = 0; f < 5; f++) {
			sums[r].theirs[f] += bench_shot_number(theirs, figures[f]);
			sums[r].ours[f] += bench_shot_number(ours, figures[f]);
		}
		sums[r].views++;
	}
}

static enum eco_code study(struct bench *bench, const char *scene, struct sums *sums, struct eco_error *error)
{
	struct shot shot = { .bench = bench, .scene = scene };
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	char ours[512], papers[512], stamp[192], name[96];
	enum eco_code code = bench_scene(bench, scene, NULL, ours, error);
	if (!code)
		code = bench_scene(bench, scene, "stochastic", papers, error);
	if (code)
		return code;
	int size = snprintf(stamp, sizeof stamp, "%s", bench_pack_stamp(ours));
	snprintf(stamp + size, sizeof stamp - (size_t)size, " %s", bench_pack_stamp(papers));
	uint32_t views = bench_shot_views(bench, scene, requests);
	for (uint32_t v = 0; v < views && !code; v++) {
		snprintf(name, sizeof name, "rules-%s-%u-%u", scene, v, views);
		json_t *rows = bench_recall(bench, name, stamp);
		shot.view = v;
		shot.request = requests[v];
		shot.request.vertices = VERTICES;
		if (!rows) {
			code = open_packs(&shot, ours, papers, error);
			code = code ? code : shoot(&shot, &rows, error);
			rows = code ? NULL : bench_keep(bench, name, stamp, rows);
		}
		if (!code)
			add_rows(sums, rows);
	}
	close_packs(&shot);
	return code;
}

/* ---- Tables ---- */

static double mean(const struct sums *s, bool ours, int figure)
{
	return (ours ? s->ours : s->theirs)[figure] / s->views;
}

static void write_scene(struct bench *bench, struct bench_table *table, const char *scene,
	const struct sums *sums)
{
	char file[128], caption[192];
	for (uint32_t r = 0; r < RULES; r++) {
		const struct sums *s = &sums[r];
		bench_table_row(table, "%s,%s,%.0f,%.0f,%.4f,%.4f,%.4f,%.0f,%.0f,%.4f,%.4f,%.4f,%.1f", scene,
			name_of(r), mean(s, false, 0), mean(s, false, 1), mean(s, false, 2),
			mean(s, false, 3), mean(s, false, 4), mean(s, true, 0), mean(s, true, 1),
			mean(s, true, 2), mean(s, true, 3), mean(s, true, 4),
			100 * (1 - mean(s, true, 1) / mean(s, false, 1)));
		if (r == DEUSSEN_2002 || r == COOK_CORRECTED || r == NEUBERT_OCCLUDED) {
			snprintf(file, sizeof file, "rules-%s-0-%u.png", scene, r);
			snprintf(caption, sizeof caption, "%s at %u vertices: ours; %s; full detail", scene,
				VERTICES, name_of(r));
			bench_picture(bench, file, caption);
		}
	}
}

struct bars {
	double printed, owner;
};

static void write_bars(struct bench *bench, const char *scene, const struct sums *sums, struct bars *bars)
{
	static const struct {
		const char *scene;
		const char *bar;
	} equal[] = { { "scbi", ">= 0.6: fewer wrong pixels than by Deussen's rule, equal lists" },
		{ "outdoor", ">= 0.25: likewise" }, { "trees5000", ">= 0.08: likewise" } };
	for (size_t i = 0; i < sizeof equal / sizeof *equal; i++) {
		char key[64];
		snprintf(key, sizeof key, "rules_deussen_%s", scene);
		if (!strcmp(equal[i].scene, scene))
			bench_key(bench, key,
				1 - mean(&sums[DEUSSEN_OURS], true, 1) / mean(&sums[DEUSSEN_OURS], false, 1),
				equal[i].bar);
	}
	bars->printed = fmin(bars->printed,
		1 - mean(&sums[DEUSSEN_2002], true, 1) / mean(&sums[DEUSSEN_2002], false, 1));
	for (uint32_t r = COOK; r <= COOK_CORRECTED; r++)
		bars->owner = fmin(bars->owner, mean(&sums[r], true, 3) - mean(&sums[r], false, 3));
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct bars bars = { INFINITY, INFINITY };
	enum eco_code code = ECO_OK;
	bench_say(bench,
		"Every frame is drawn by the software rasteriser, %u vertices, mean of the views of "
		"`frames`; ours stands beside each rule at the vertices that it drew. Cook, Neubert and "
		"Lee keep lambda = min(1, (r / R)^2) of the leaves at distance R, r by the budget, and draw "
		"the wood of our ladders, from packs of the stochastic order. Cook's contrast is not "
		"corrected: it moves no pixel of the mask.",
		VERTICES);
	struct bench_table *table = bench_table_open(bench, "rules",
		"scene,rule,vertices,wrong pixels,Q,owner_q,picture error,vertices of ours,wrong of ours,"
		"Q of ours,owner_q of ours,picture error of ours,fewer wrong by ours %",
		true);
	for (size_t i = 0; i < SCENES && !code; i++) {
		struct sums sums[RULES] = { { { 0 }, { 0 }, 0 } };
		char pack[512];
		bench_progress(bench, (double)i / SCENES, scenes[i]);
		if (!bench_shot_scene(bench, scenes[i], pack, &code, error))
			continue;
		code = code ? code : study(bench, scenes[i], sums, error);
		if (code)
			break;
		write_scene(bench, table, scenes[i], sums);
		write_bars(bench, scenes[i], sums, &bars);
	}
	bench_table_close(table);
	if (code || !isfinite(bars.printed))
		return code;
	bench_key(bench, "rules_deussen_2002", bars.printed,
		">= 0.3: fewer wrong pixels than by Deussen 2002 as printed, worst scene");
	bench_key(bench, "rules_cook_owner_q", bars.owner,
		">= 0: owner_q above Cook's at equal vertices, worst scene");
	return ECO_OK;
}

const struct bench_section bench_rules = { "rules", "The papers' rules on whole scenes", run,
	.objects = BENCH_OBJECTS_FRAMES
	"tests-bench-baseline.a tests/bench/bench_frame.o tests/bench/frames/bench_rules.o "
	"tests/bench/bench_shots.o" };
