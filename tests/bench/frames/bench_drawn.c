/* Ours at the quality of Cook's rule, in drawn frames (Neubert 2011). Cook's rule on a pack of the stochastic
 * order draws a frame; ours is planned for fewer and fewer vertices until its Q would fall below that. All of
 * a frame counts, wood and splats alike, and what plants hide of each other.
 *
 *   along the path through 1,276 trees (section 5 and table 2): vertices saved, with Cook's correction of
 *   depth complexity or without, whichever has the higher Q; beside it our rule on the pack of the stochastic
 *   order
 *   5,000 trees (figure 12): times by OpenGL, with the correction */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/sort.h"
#include "tests/bench/baseline/paper_rules.h"
#include "tests/bench/bench_shots.h"

#define LEAST 1e-3 /* of Cook's vertices: where the search begins */

struct rivals {
	struct bench *bench;
	char ours[512], stochastic[512], stamp[128];
	struct eco_request request;
	struct bench_client *client[2]; /* of our order, of the stochastic order */
	struct paper_scene *papers;
	struct paper_table *tables;
};

static enum eco_code find_packs(struct rivals *s, const char *scene, struct eco_error *error)
{
	enum eco_code code = bench_scene(s->bench, scene, NULL, s->ours, error);
	code = code ? code : bench_scene(s->bench, scene, "stochastic", s->stochastic, error);
	int size = snprintf(s->stamp, sizeof s->stamp, "%s", bench_pack_stamp(s->ours));
	snprintf(s->stamp + size, sizeof s->stamp - (size_t)size, " %s", bench_pack_stamp(s->stochastic));
	return code;
}

static enum eco_code open_rivals(struct rivals *s, bool timed, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	if (s->client[0])
		return ECO_OK;
	for (int i = 0; i < 2 && !code; i++) {
		code = bench_client_open(&s->client[i], i ? s->stochastic : s->ours, error);
		if (!code && !timed)
			bench_client_untimed(s->client[i]);
	}
	if (!code)
		code = paper_scene_open(&s->papers, s->stochastic, error);
	return code ? code : paper_tables_make(&s->tables, s->papers, error);
}

static void close_rivals(struct rivals *s)
{
	bench_client_close(s->client[0]);
	bench_client_close(s->client[1]);
	free(s->tables);
	paper_scene_close(s->papers);
}

/* `depth`: with the correction. */
static enum eco_code draw_cook(struct rivals *s, bool depth, bool timed, struct bench_frame *frame,
	struct eco_error *error)
{
	struct paper_cook cook = { .tables = depth ? s->tables : NULL };
	struct paper_frame drawn = { 0 };
	double x = 0;
	enum eco_code code = paper_shoot(s->papers, &s->request, paper_cook, &cook, &x, false, &drawn, error);
	*frame = (struct bench_frame){ .request = s->request, .vertices = drawn.picture.vertices };
	if (!code)
		code = bench_client_reference(s->client[0], &s->request, NULL, error);
	if (!code)
		code = bench_client_score(s->client[0], frame, &drawn.picture, error);
	if (!code && timed)
		frame->draw_ms = bench_gl_ms(s->papers->store, &drawn.selection, &s->request.view);
	paper_frame_free(&drawn);
	return code;
}

/* The fewest vertices of ours whose Q is at least Cook's, from LEAST of Cook's to all of them, by bisection
 * of the logarithm; all of them where none suffices. */
static enum eco_code search(struct rivals *s, int which, const struct bench_frame *cook, uint32_t halvings,
	struct bench_frame *best, struct eco_error *error)
{
	double low = log(LEAST), high = 0;
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i <= halvings && !code; i++) {
		double at = i ? (low + high) / 2 : 0;
		struct bench_frame frame = { .request = s->request };
		frame.request.vertices = (uint64_t)((double)cook->vertices * exp(at) + 0.5);
		code = bench_go_on(s->bench, error);
		code = code ? code : bench_client_frame(s->client[which], &frame, NULL, error);
		if (!i)
			*best = frame;
		if (!code && frame.score.q >= cook->score.q) {
			high = at;
			*best = frame.vertices < best->vertices ? frame : *best;
		} else if (!code && i) {
			low = at;
		} else {
			break; /* not even with as many */
		}
	}
	return code;
}

/* ---- Along the path ---- */

#define PATH_SCENE "trees1276"
#define PATH_HALVINGS 9u

static const uint64_t path_budgets[] = { 1000000, 3000000 };
#define PATH_BUDGETS (sizeof path_budgets / sizeof *path_budgets)

/* vertices of Cook, of ours, with the stochastic order */
enum { COOK, OURS, STOCHASTIC, FIGURES };

static enum eco_code shoot_path(void *ctx, json_t **made, struct eco_error *error)
{
	struct rivals *s = ctx;
	struct bench_frame plain, depth, best[2];
	double vertices[2];
	enum eco_code code = open_rivals(s, false, error);
	code = code ? code : draw_cook(s, false, false, &plain, error);
	code = code ? code : draw_cook(s, true, false, &depth, error);
	const struct bench_frame *cook = !code && depth.score.q > plain.score.q ? &depth : &plain;
	for (int i = 0; i < 2 && !code; i++) {
		code = search(s, i, cook, PATH_HALVINGS, &best[i], error);
		vertices[i] = best[i].score.q >= cook->score.q ? fmin((double)best[i].vertices,
			(double)cook->vertices) : (double)cook->vertices;
	}
	if (!code)
		*made = json_pack("[fff]", (double)cook->vertices, vertices[0], vertices[1]);
	return code;
}

/* The mean of values[0..count) and the middle 95 % of the means of `count` values drawn again and again, with
 * a fixed seed (bootstrap). */
struct interval { double mean, low, high; };

#define DRAWS 2000u
#define DRAW_SEED UINT64_C(20111)

static int by_size(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return x < y ? -1 : x > y;
}

static struct interval interval_of(const double *values, uint32_t count)
{
	static double means[DRAWS];
	double sum = 0;
	if (!count)
		return (struct interval){ NAN, NAN, NAN };
	for (uint32_t i = 0; i < count; i++)
		sum += values[i];
	for (uint32_t draw = 0; draw < DRAWS; draw++) {
		means[draw] = 0;
		for (uint32_t i = 0; i < count; i++)
			means[draw] +=
				values[lod_mix(DRAW_SEED + (uint64_t)draw * count + i) % count] / count;
	}
	qsort(means, DRAWS, sizeof *means, by_size);
	return (struct interval){ sum / count, means[DRAWS / 40], means[DRAWS - 1 - DRAWS / 40] };
}

static void write_path(struct bench *bench, struct bench_table *table, uint64_t budget, uint32_t views,
	double value[][FIGURES])
{
	static const char *const names[2] = { "pack's ladder", "stochastic order by our rule" };
	for (int which = 0; which < 2; which++) {
		double saved[BENCH_SHOT_VIEWS_MAX], least = INFINITY, ours = 0, cook = 0;
		for (uint32_t v = 0; v < views; v++) {
			saved[v] = 1 - value[v][OURS + which] / value[v][COOK];
			least = fmin(least, saved[v]);
			ours += value[v][OURS + which];
			cook += value[v][COOK];
		}
		struct interval interval = interval_of(saved, views);
		bench_table_row(table, "%llu,%s,%u,%.1f,%.1f,%.1f,%.1f,%.1f", (unsigned long long)budget,
			names[which], views, 100 * interval.mean, 100 * interval.low, 100 * interval.high,
			100 * least, 100 * (1 - ours / cook));
	}
}

static enum eco_code run_path(struct bench *bench, struct eco_error *error)
{
	struct rivals s = { .bench = bench };
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	double value[BENCH_SHOT_VIEWS_MAX][FIGURES];
	enum eco_code code = find_packs(&s, PATH_SCENE, error);
	uint32_t views = code ? 0 : bench_shot_views(bench, PATH_SCENE, requests);
	struct bench_table *table = bench_table_open(bench, "drawn",
		"Cook's budget,row,frames,saved in the mean %,95 % of means from,to,least,of all vertices %",
		true);
	for (size_t b = 0; b < PATH_BUDGETS && !code; b++) {
		for (uint32_t v = 0; v < views && !code; v++) {
			char name[96];
			json_t *row;
			s.request = requests[v];
			s.request.vertices = path_budgets[b];
			snprintf(name, sizeof name, "drawn-%u-%u-%llu", v, views,
				(unsigned long long)path_budgets[b]);
			bench_progress(bench, (double)v / views, name);
			code = bench_unit(bench, name, s.stamp, shoot_path, &s, &row, error);
			bench_cells(row, value[v], FIGURES);
		}
		if (!code)
			write_path(bench, table, path_budgets[b], views, value);
	}
	bench_table_close(table);
	close_rivals(&s);
	return code;
}

/* ---- 5,000 trees ---- */

#define SPEED_SCENE "trees5000"
#define SPEED_HALVINGS 11u

static const uint64_t speed_budgets[] = { 300000, 1000000, 3000000 };
#define SPEED_BUDGETS (sizeof speed_budgets / sizeof *speed_budgets)

/* For each budget vertices, Q and ms of Cook, then of ours. */
static enum eco_code shoot_speed(void *ctx, json_t **made, struct eco_error *error)
{
	struct rivals *s = ctx;
	enum eco_code code = open_rivals(s, true, error);
	*made = json_array();
	for (size_t i = 0; i < SPEED_BUDGETS && !code; i++) {
		struct bench_frame cook, ours;
		s->request.vertices = speed_budgets[i];
		code = draw_cook(s, true, true, &cook, error);
		code = code ? code : search(s, 0, &cook, SPEED_HALVINGS, &ours, error);
		if (!code)
			json_array_append_new(*made, json_pack("[ffffff]", (double)cook.vertices,
				cook.score.q, cook.draw_ms, (double)ours.vertices, ours.score.q,
				ours.draw_ms));
	}
	return code;
}

static enum eco_code run_speed(struct bench *bench, struct eco_error *error)
{
	struct rivals s = { .bench = bench };
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	json_t *rows, *row;
	size_t i;
	bench_head(bench, "Speed at equal Q: 5,000 trees (figure 12)");
	enum eco_code code = find_packs(&s, SPEED_SCENE, error);
	if (code)
		return code;
	bench_shot_views(bench, SPEED_SCENE, requests);
	s.request = requests[0];
	bench_progress(bench, 0.6, "5,000 trees at equal Q");
	code = bench_unit(bench, "neubert-race", s.stamp, shoot_speed, &s, &rows, error);
	close_rivals(&s);
	if (code)
		return code;
	struct bench_table *table = bench_table_open(bench, "neubert_speed",
		"rule,vertices,Q,draw ms,frames/s,times as fast", true);
	bench_table_row(table, "%s", "printed: full detail,26000000,1,-,0.8,-");
	bench_table_row(table, "%s", "printed: Cook,-,-,-,9,-");
	bench_table_row(table, "%s", "printed: Neubert,-,-,-,15,1.67");
	json_array_foreach(rows, i, row) {
		double v[6];
		bench_cells(row, v, 6);
		for (int k = 0; k < 6; k += 3)
			bench_table_row(table, "%s,%.0f,%.4f,%.0f,%.1f,%.2f", k ? "ours" : "Cook corrected",
				v[k], v[k + 1], v[k + 2], 1000 / v[k + 2], v[2] / v[k + 2]);
	}
	bench_table_close(table);
	bench_say(bench,
		"Cook draws %u, %u and %u vertices, which the share lambda by distance decides; ours the "
		"fewest at which Q is no less, to a 300th of that. Times are of OpenGL on this machine at "
		"the second frame, %u x %u pixels; the paper's of a GTX 295 at 1600 x 1200.",
		(unsigned)speed_budgets[0], (unsigned)speed_budgets[1], (unsigned)speed_budgets[2],
		BENCH_SHOT_WIDTH, BENCH_SHOT_HEIGHT);
	return ECO_OK;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	enum eco_code code = bench_scene_asked(bench, PATH_SCENE) ? run_path(bench, error) : ECO_OK;
	return !code && bench_scene_asked(bench, SPEED_SCENE) ? run_speed(bench, error) : code;
}

const struct bench_section bench_drawn = { "drawn", "Ours at the quality of Cook's rule, in drawn frames",
	run };
