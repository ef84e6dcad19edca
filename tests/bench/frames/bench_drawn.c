/* Geometry saved along the path through 1,276 trees (Neubert 2011, section 5 and table 2), in drawn frames:
 * Cook's rule on a pack of the stochastic order draws a frame, with his correction of depth complexity or
 * without, whichever has the higher Q; ours is planned for fewer and fewer vertices until its Q would fall
 * below that. Beside it stands our rule on the pack of the stochastic order. All of a frame counts, wood
 * and splats alike, and what plants hide of each other. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/baseline/paper_neubert.h"
#include "tests/bench/baseline/paper_rules.h"
#include "tests/bench/ladder/bench_interval.h"
#include "tests/bench/bench_shots.h"

#define SCENE "trees1276"
#define HALVINGS 9u /* of the logarithm of the vertices, from LEAST of Cook's on */
#define LEAST 1e-3

static const uint64_t budgets[] = { 1000000, 3000000 };
#define BUDGETS (sizeof budgets / sizeof *budgets)

struct scenes {
	struct bench *bench;
	struct bench_client *client[2]; /* of our order, of the stochastic order */
	struct paper_scene *papers;
	struct paper_tables *tables;
};

static enum eco_code open_packs(struct scenes *s, const char *ours, const char *papers,
	struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	if (s->client[0])
		return ECO_OK;
	for (int i = 0; i < 2 && !code; i++) {
		code = bench_client_open(&s->client[i], i ? papers : ours, error);
		if (!code)
			bench_client_untimed(s->client[i]);
	}
	if (!code)
		code = paper_scene_open(&s->papers, papers, error);
	return code ? code : paper_tables_make(&s->tables, s->papers, error);
}

static void close_packs(struct scenes *s)
{
	bench_client_close(s->client[0]);
	bench_client_close(s->client[1]);
	paper_tables_free(s->tables);
	paper_scene_close(s->papers);
}

/* `depth`: with the correction. */
static enum eco_code draw_cook(struct scenes *s, const struct eco_request *request, bool depth,
	struct bench_frame *frame, struct eco_error *error)
{
	struct paper_cook cook = { .tables = depth ? s->tables : NULL };
	struct paper paper;
	struct paper_frame drawn = { 0 };
	struct eco_plan plan = { 0 };
	double x;
	enum eco_code code = paper_begin(&paper, s->papers, request, error);
	if (!code)
		code = paper_solve(&paper, paper_cook, &cook, 1e-3, 1e5, &x, &plan, error);
	paper_end(&paper);
	if (!code)
		code = paper_draw(s->papers, &plan, &request->view, false, &drawn, error);
	*frame = (struct bench_frame){ .request = *request, .vertices = drawn.picture.vertices };
	if (!code)
		code = bench_client_reference(s->client[0], request, NULL, error);
	if (!code)
		code = bench_client_score(s->client[0], frame, &drawn.picture, error);
	paper_frame_free(&drawn);
	return code;
}

/* The fewest vertices of ours whose Q is at least `q`, from LEAST of Cook's to all of them; `q_at_equal`: Q
 * of ours with all of them. */
static enum eco_code search(struct scenes *s, int which, const struct eco_request *request, double q,
	double cook, double *vertices, double *q_at_equal, struct eco_error *error)
{
	double low = log(LEAST), high = 0;
	enum eco_code code = ECO_OK;
	*vertices = cook;
	for (uint32_t i = 0; i <= HALVINGS && !code; i++) {
		double at = i ? (low + high) / 2 : 0;
		struct bench_frame frame = { .request = *request };
		frame.request.vertices = (uint64_t)(cook * exp(at) + 0.5);
		code = bench_stopped(s->bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
					       : bench_client_frame(s->client[which], &frame, NULL, error);
		if (!code && !i)
			*q_at_equal = frame.score.q;
		if (!code && frame.score.q >= q) {
			high = at;
			*vertices = fmin(*vertices, (double)frame.vertices);
		} else if (!code && i) {
			low = at;
		} else {
			break; /* not even with as many */
		}
	}
	return code;
}

static enum eco_code shoot(struct scenes *s, const struct eco_request *request, json_t **made,
	struct eco_error *error)
{
	struct bench_frame plain, depth;
	double vertices[2] = { 0 }, q[2] = { 0 };
	enum eco_code code = draw_cook(s, request, false, &plain, error);
	if (!code)
		code = draw_cook(s, request, true, &depth, error);
	const struct bench_frame *cook = !code && depth.score.q > plain.score.q ? &depth : &plain;
	for (int i = 0; i < 2 && !code; i++)
		code = search(s, i, request, cook->score.q, (double)cook->vertices, &vertices[i], &q[i],
			error);
	if (!code)
		*made = json_pack("{s:f,s:f,s:f,s:f,s:f}", "cook", (double)cook->vertices, "cook_q",
			cook->score.q, "ours", vertices[0], "stochastic", vertices[1], "q", q[0]);
	return code;
}

static enum eco_code study(struct bench *bench, json_t *rows, struct eco_error *error)
{
	struct scenes s = { .bench = bench };
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	char ours[512], papers[512], stamp[192], name[96];
	enum eco_code code = bench_scene(bench, SCENE, NULL, ours, error);
	if (!code)
		code = bench_scene(bench, SCENE, "stochastic", papers, error);
	if (code)
		return code;
	int size = snprintf(stamp, sizeof stamp, "%s", bench_pack_stamp(ours));
	snprintf(stamp + size, sizeof stamp - (size_t)size, " %s", bench_pack_stamp(papers));
	uint32_t views = bench_shot_views(bench, SCENE, requests);
	for (uint32_t i = 0; i < views * BUDGETS && !code; i++) {
		snprintf(name, sizeof name, "drawn-%u-%u-%llu", i % views, views,
			(unsigned long long)budgets[i / views]);
		json_t *row = bench_recall(bench, name, stamp);
		bench_progress(bench, (double)i / (double)(views * BUDGETS), name);
		if (!row) {
			requests[i % views].vertices = budgets[i / views];
			code = open_packs(&s, ours, papers, error);
			code = code ? code : shoot(&s, &requests[i % views], &row, error);
			row = code ? NULL : bench_keep(bench, name, stamp, row);
		}
		if (row)
			json_array_append(rows, row);
	}
	close_packs(&s);
	return code;
}

/* Shares saved by a row in the frames of one budget, and of the vertices of all. */
static double saved_by(const json_t *rows, size_t first, size_t views, const char *row, double *saved)
{
	double ours = 0, cook = 0;
	for (size_t i = 0; i < views; i++) {
		const json_t *of = json_array_get(rows, first + i);
		double x = bench_shot_number(of, row), y = bench_shot_number(of, "cook");
		saved[i] = 1 - x / y;
		ours += x;
		cook += y;
	}
	return 1 - ours / cook;
}

static void write_frames(struct bench *bench, const json_t *rows, size_t views)
{
	struct bench_table *table = bench_table_open(bench, "drawn_frames",
		"Cook's budget,frame,vertices of Cook,Q of Cook,vertices of ours,"
		"vertices with the stochastic order,Q of ours at Cook's vertices",
		false);
	for (size_t i = 0; i < views * BUDGETS; i++) {
		const json_t *row = json_array_get(rows, i);
		bench_table_row(table, "%llu,%u,%.0f,%.4f,%.0f,%.0f,%.4f",
			(unsigned long long)budgets[i / views], (unsigned)(i % views),
			bench_shot_number(row, "cook"), bench_shot_number(row, "cook_q"),
			bench_shot_number(row, "ours"), bench_shot_number(row, "stochastic"),
			bench_shot_number(row, "q"));
	}
	bench_table_close(table);
}

static void write(struct bench *bench, const json_t *rows)
{
	static const char *const names[2][2] = { { "ours", "pack's ladder" },
		{ "stochastic", "stochastic order by our rule" } };
	size_t views = json_array_size(rows) / BUDGETS;
	double saved[BENCH_SHOT_VIEWS_MAX];
	struct bench_table *table = bench_table_open(bench, "drawn",
		"Cook's budget,row,frames,saved in the mean %,95 % of means from,to,least,of all vertices %",
		true);
	for (size_t i = 0; i < 2 * BUDGETS && views; i++) {
		char key[64];
		unsigned long long budget = budgets[i / 2];
		double least = INFINITY, all = saved_by(rows, i / 2 * views, views, names[i % 2][0], saved);
		struct bench_interval interval = bench_interval_of(saved, (uint32_t)views);
		for (size_t v = 0; v < views; v++)
			least = fmin(least, saved[v]);
		bench_table_row(table, "%llu,%s,%u,%.1f,%.1f,%.1f,%.1f,%.1f", budget, names[i % 2][1],
			(unsigned)views, 100 * interval.mean, 100 * interval.low, 100 * interval.high,
			100 * least, 100 * all);
		snprintf(key, sizeof key, "drawn_saved_%llu", budget);
		if (i % 2 == 0)
			bench_key(bench, key, interval.mean,
				"drawn frames of the path: saved at Cook's Q, mean");
	}
	bench_table_close(table);
	write_frames(bench, rows, views);
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	if (!bench_scene_asked(bench, SCENE))
		return ECO_OK;
	json_t *rows = json_array();
	enum eco_code code = study(bench, rows, error);
	if (!code)
		write(bench, rows);
	json_decref(rows);
	return code;
}

const struct bench_section bench_drawn = { "drawn", "Geometry saved along the path, in drawn frames", run,
	.objects = BENCH_OBJECTS_FRAMES "tests-bench-baseline.a tests/bench/bench_frame.o "
					"tests/bench/frames/bench_drawn.o tests/bench/bench_shots.o" };
