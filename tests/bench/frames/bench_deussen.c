/* Deussen 2002 as printed on scenes of his kinds: table 1 with its columns (triangles, lines, points, frames
 * a second), figure 5's sweep of the sample distance d' and the splat factor c_p, and the octree of complex
 * plants (6.1) on and off. Packs are those of the stochastic order, with his lists (paper_scene.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/bench/baseline/paper_rules.h"
#include "tests/bench/bench_shots.h"

/* ---- What was drawn ---- */

struct drawn {
	double triangles, lines, points, vertices, full, wrong, p, r, q, ms, px;
	bool drawn;
};
static const struct {
	const char *key;
	size_t at;
} figures[] = { { "triangles", offsetof(struct drawn, triangles) },
	{ "lines", offsetof(struct drawn, lines) }, { "points", offsetof(struct drawn, points) },
	{ "vertices", offsetof(struct drawn, vertices) },
	{ "full", offsetof(struct drawn, full) }, { "wrong", offsetof(struct drawn, wrong) },
	{ "p", offsetof(struct drawn, p) }, { "r", offsetof(struct drawn, r) },
	{ "q", offsetof(struct drawn, q) }, { "ms", offsetof(struct drawn, ms) },
	{ "px", offsetof(struct drawn, px) } };
#define FIGURES (sizeof figures / sizeof *figures)

static double *figure(struct drawn *drawn, size_t i)
{
	return (double *)((char *)drawn + figures[i].at);
}

static json_t *pack_drawn(struct drawn *drawn)
{
	json_t *row = json_object();
	for (size_t i = 0; i < FIGURES; i++)
		bench_shot_set(row, figures[i].key, *figure(drawn, i));
	return row;
}

static struct drawn read_drawn(const json_t *row)
{
	struct drawn drawn = { 0 };
	for (size_t i = 0; i < FIGURES; i++)
		*figure(&drawn, i) = bench_shot_number(row, figures[i].key);
	return drawn;
}

static void count_kinds(const struct view_store *store, const struct view_selection *selection,
	struct drawn *drawn)
{
	const struct eco_plan *plan = view_store_plan(store);
	for (uint32_t c = 0; c < selection->cut_count; c++) {
		const struct view_list *list = view_store_list(store, plan->cuts[c].list);
		double count = (double)eco_cut_primitives(&plan->cuts[c]) *
			(selection->member_first[c + 1] - selection->member_first[c]);
		switch (list ? eco_list_vertices(&list->list) : 0) {
		case 1: drawn->points += count; break;
		case 2: drawn->lines += count; break;
		case 3: drawn->triangles += count; break;
		default: break;
		}
	}
}

/* ---- A scene ---- */

struct study {
	struct bench *bench;
	struct eco_request request;
	struct bench_client *client;
	struct paper_scene *scene;
	char pack[512], stamp[64];
};

static enum eco_code open_study(struct study *s, struct eco_error *error)
{
	if (s->client)
		return ECO_OK;
	enum eco_code code = bench_client_open(&s->client, s->pack, error);
	if (!code) {
		bench_client_untimed(s->client);
		code = paper_scene_open(&s->scene, s->pack, error);
	}
	return code;
}

static void close_study(struct study *s)
{
	bench_client_close(s->client);
	paper_scene_close(s->scene);
}

static double pixel(const struct eco_view *view)
{
	return 2 * tan(view->fov_y_deg * M_PI / 360) / view->height;
}

/* By his rule, at d' = px pixels, or with px 0 at the least d' within the budget. */
static enum eco_code draw(struct study *s, double px, struct paper_deussen how, const char *file,
	struct drawn *drawn, struct eco_error *error)
{
	struct bench_frame frame = { .request = s->request };
	struct paper_frame picture = { 0 };
	struct eco_plan plan = { 0 };
	struct paper paper;
	double one = pixel(&s->request.view), x = px * one;
	enum eco_code code = bench_client_reference(s->client, &s->request, NULL, error);
	code = code ? code : paper_begin(&paper, s->scene, &s->request, error);
	if (code)
		return code;
	if (px > 0) {
		code = paper_deussen(&paper, x, &how, error);
		code = code ? code : paper_finish(&paper, &plan, error);
	} else {
		code = paper_solve(&paper, paper_deussen, &how, 2, 1e-6, &x, &plan, error);
	}
	paper_end(&paper);
	code = code ? code : paper_draw(s->scene, &plan, &s->request.view, false, &picture, error);
	code = code ? code : bench_client_score(s->client, &frame, &picture.picture, error);
	if (!code) {
		const struct lod_score *score = &frame.score;
		*drawn = (struct drawn){ .vertices = (double)picture.picture.vertices, .px = x / one,
			.full = (double)bench_client_full(s->client)->vertices / 3,
			.wrong = (double)(score->fp + score->fn), .p = score->precision, .r = score->recall,
			.q = score->q, .ms = bench_gl_ms(s->scene->store, &picture.selection,
				&s->request.view) };
		count_kinds(s->scene->store, &picture.selection, drawn);
	}
	if (!code && file)
		code = bench_picture_write(s->bench, file, picture.picture.width, picture.picture.height,
			picture.picture.rgb, error);
	paper_frame_free(&picture);
	return code;
}

/* ---- Table 1 ---- */

static const struct printed {
	const char *scene, *name;
	uint64_t vertices;
	const char *row;
} printed[] = {
	{ "trees640", "640 trees", 2100000, "10 M,500000,100000,400000,2100000,9 to 16" },
	{ "palms", "1500 palms as lines", 1760000, "12 M,560000,40000,0,1760000,12 to 20" },
	{ "outdoor", "outdoor scene", 2480000, "120 M,460000,400000,300000,2480000,8 to 10" },
	{ "sunflowers", "13000 sunflowers and a maple", 2190000, "70 M,450000,220000,400000,2190000,3 to 4" },
};
#define SCENES (sizeof printed / sizeof *printed)

static enum eco_code shoot_table(struct study *s, uint32_t view, json_t **row, struct eco_error *error)
{
	char name[96];
	struct drawn drawn;
	snprintf(name, sizeof name, "deussen-%u-%llu", view, (unsigned long long)s->request.vertices);
	strncat(name, strrchr(s->pack, '/'), sizeof name - strlen(name) - 1);
	for (char *at = name; *at; at++)
		*at = *at == '/' ? '-' : *at;
	*row = bench_recall(s->bench, name, s->stamp);
	if (*row)
		return ECO_OK;
	enum eco_code code = open_study(s, error);
	code = code ? code : draw(s, 0, (struct paper_deussen){ 0 }, NULL, &drawn, error);
	if (!code)
		*row = bench_keep(s->bench, name, s->stamp, pack_drawn(&drawn));
	return code;
}

static void write_table_rows(struct bench_table *table, const struct printed *scene, const struct drawn *sum,
	uint32_t views)
{
	struct drawn mean = *sum;
	for (size_t i = 0; i < FIGURES; i++)
		*figure(&mean, i) /= views;
	bench_table_row(table, "%s,Deussen 2002,%s,-,-", scene->name, scene->row);
	bench_table_row(table, "%s,as printed on our plants,%.0f M,%.0f,%.0f,%.0f,%.0f,%.1f,%.3f,%.2f",
		scene->name, mean.full / 1e6, mean.triangles, mean.lines, mean.points, mean.vertices,
		1000 / mean.ms, mean.q, mean.px);
}

static enum eco_code write_table(struct bench *bench, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	bench_head(bench, "Elements drawn (table 1)");
	struct bench_table *table = bench_table_open(bench, "deussen_elements",
		"scene,rule,triangles in sight at full detail,triangles,lines,points,vertices,frames/s,"
		"Q,d' px",
		true);
	for (size_t i = 0; i < SCENES && !code; i++) {
		struct study s = { .bench = bench };
		struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
		struct drawn sum = { 0 };
		if (!bench_scene_asked(bench, printed[i].scene))
			continue;
		bench_progress(bench, 0.6 * (double)i / SCENES, printed[i].name);
		code = bench_scene(bench, printed[i].scene, "stochastic", s.pack, error);
		snprintf(s.stamp, sizeof s.stamp, "%s", bench_pack_stamp(s.pack));
		uint32_t views = bench_shot_views(bench, printed[i].scene, requests);
		for (uint32_t v = 0; v < views && !code; v++) {
			json_t *row = NULL;
			s.request = requests[v];
			s.request.vertices = printed[i].vertices;
			code = shoot_table(&s, v, &row, error);
			struct drawn one = read_drawn(row);
			for (size_t f = 0; f < FIGURES; f++)
				*figure(&sum, f) += *figure(&one, f);
		}
		close_study(&s);
		if (!code)
			write_table_rows(table, &printed[i], &sum, views);
	}
	bench_table_close(table);
	bench_say(bench, "The budget is what the paper's elements come to (3 triangles + 2 lines + points); "
		"d' is the least that fits. Frames a second are of OpenGL on this machine, at the second "
		"time; the paper's are of a GeForce3. Triangles are those in sight, not of the whole scene.");
	return code;
}

/* ---- Figure 5 ---- */

static const double distances[] = { 1, 2, 4, 8 }, factors[] = { 0.6, 1, 1.3, 1.5, 2 };
#define DISTANCES (sizeof distances / sizeof *distances)
#define FACTORS (sizeof factors / sizeof *factors)
/* the pictures a, b, c of the figure, by d' and c_p */
static const struct {
	size_t distance, factor;
	const char *file, *caption;
} shown[] = { { 0, 2, "deussen-a.png", "d' of a pixel, c_p 1.3" },
	{ 2, 0, "deussen-b.png", "d' of four pixels and a splat factor of .6, which leaves holes" },
	{ 2, 3, "deussen-c.png", "the same d', c_p 1.5" } };

static enum eco_code sweep(struct study *s, json_t **rows, struct eco_error *error)
{
	json_t *made = json_array();
	enum eco_code code = open_study(s, error);
	for (size_t d = 0; d < DISTANCES && !code; d++)
		for (size_t f = 0; f < FACTORS && !code; f++) {
			struct drawn drawn = { 0 };
			const char *file = NULL;
			for (size_t i = 0; i < sizeof shown / sizeof *shown; i++)
				file = shown[i].distance == d && shown[i].factor == f ? shown[i].file : file;
			code = bench_stopped(s->bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
				: draw(s, distances[d], (struct paper_deussen){ .splat_factor = factors[f] },
				file, &drawn, error);
			json_array_append_new(made, pack_drawn(&drawn));
		}
	if (code)
		json_decref(made);
	else
		*rows = bench_keep(s->bench, "deussen-sweep", s->stamp, made);
	return code;
}

static enum eco_code write_sweep(struct bench *bench, struct eco_error *error)
{
	struct study s = { .bench = bench };
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	enum eco_code code = bench_scene(bench, "outdoor", "stochastic", s.pack, error);
	if (code)
		return code;
	snprintf(s.stamp, sizeof s.stamp, "%s", bench_pack_stamp(s.pack));
	bench_shot_views(bench, "outdoor", requests);
	s.request = requests[0];
	s.request.vertices = ECO_VERTICES_MAX;
	bench_head(bench, "Sample distance and splat factor (figure 5)");
	bench_progress(bench, 0.6, "sample distances and splat factors");
	json_t *rows = bench_recall(bench, "deussen-sweep", s.stamp);
	if (!rows)
		code = sweep(&s, &rows, error);
	close_study(&s);
	if (code)
		return code;
	struct bench_table *table = bench_table_open(bench, "deussen_sweep",
		"d' px,c_p,triangles,lines,points,vertices,wrong pixels,P,R,Q", true);
	for (size_t i = 0; i < DISTANCES * FACTORS; i++) {
		struct drawn d = read_drawn(json_array_get(rows, i));
		bench_table_row(table, "%g,%g,%.0f,%.0f,%.0f,%.0f,%.0f,%.3f,%.3f,%.3f",
			distances[i / FACTORS], factors[i % FACTORS], d.triangles, d.lines, d.points,
			d.vertices, d.wrong, d.p, d.r, d.q);
	}
	bench_table_close(table);
	for (size_t i = 0; i < sizeof shown / sizeof *shown; i++)
		bench_picture(bench, shown[i].file, shown[i].caption);
	return code;
}

/* ---- The octree of complex plants (6.1) ---- */

static const struct {
	const char *scene;
	uint64_t vertices;
} complex_plants[] = { { "crown", 3000 }, { "crown", 10000 }, { "sunflowers", 300000 },
	{ "sunflowers", 2190000 } };

static enum eco_code compare_cells(struct study *s, const char *name, json_t **rows, struct eco_error *error)
{
	struct drawn with, without;
	*rows = bench_recall(s->bench, name, s->stamp);
	if (*rows)
		return ECO_OK;
	enum eco_code code = open_study(s, error);
	code = code ? code : draw(s, 0, (struct paper_deussen){ 0 }, NULL, &with, error);
	code = code ? code : draw(s, 0, (struct paper_deussen){ .whole = true }, NULL, &without, error);
	if (!code)
		*rows = bench_keep(s->bench, name, s->stamp,
			json_pack("[oo]", pack_drawn(&with), pack_drawn(&without)));
	return code;
}

/* Closer than the scene's cameras: so near to a plant that its cells stand at different distances. */
static void step_closer(struct eco_view *view)
{
	for (int k = 0; k < 3; k++)
		view->eye[k] += 0.6 * (view->target[k] - view->eye[k]);
}

static enum eco_code write_cells(struct bench *bench, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	bench_head(bench, "Cells of complex plants on and off (6.1)");
	struct bench_table *table = bench_table_open(bench, "deussen_cells",
		"scene,vertices,view,Q with cells,Q without,wrong pixels with,wrong pixels without", true);
	for (size_t i = 0; i < sizeof complex_plants / sizeof *complex_plants && !code; i++) {
		struct study s = { .bench = bench };
		struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
		if (!bench_scene_asked(bench, complex_plants[i].scene))
			continue;
		bench_progress(bench, 0.9, complex_plants[i].scene);
		code = bench_scene(bench, complex_plants[i].scene, "stochastic", s.pack, error);
		snprintf(s.stamp, sizeof s.stamp, "%s", bench_pack_stamp(s.pack));
		uint32_t views = bench_shot_views(bench, complex_plants[i].scene, requests);
		for (uint32_t v = 0; v < views && !code; v++) {
			char name[96];
			json_t *rows = NULL;
			s.request = requests[v];
			step_closer(&s.request.view);
			s.request.vertices = complex_plants[i].vertices;
			snprintf(name, sizeof name, "deussen-cells-%s-%llu-%u", complex_plants[i].scene,
				(unsigned long long)s.request.vertices, v);
			code = compare_cells(&s, name, &rows, error);
			if (code)
				break;
			struct drawn with = read_drawn(json_array_get(rows, 0)),
				without = read_drawn(json_array_get(rows, 1));
			bench_table_row(table, "%s,%llu,%u,%.3f,%.3f,%.0f,%.0f", complex_plants[i].scene,
				(unsigned long long)s.request.vertices, v, with.q, without.q, with.wrong,
				without.wrong);
		}
		close_study(&s);
	}
	bench_table_close(table);
	return code;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	enum eco_code code = write_table(bench, error);
	code = code ? code : write_sweep(bench, error);
	return code ? code : write_cells(bench, error);
}

const struct bench_section bench_deussen = { "deussen", "Deussen 2002: elements, sample distance, cells", run,
	.objects = BENCH_OBJECTS_FRAMES "tests-bench-baseline.a tests/bench/bench_frame.o "
	"tests/bench/frames/bench_deussen.o tests/bench/bench_shots.o", .alone = true };
