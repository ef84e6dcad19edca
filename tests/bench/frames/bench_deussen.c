/* Deussen 2002 as printed on scenes of his kinds: table 1 with its columns (triangles, lines, points, frames
 * a second), figure 5's sweep of the sample distance d' and the splat factor c_p, and the octree of complex
 * plants (6.1) on and off. Packs are those of the stochastic order, with his lists (paper_rules.h). */
#include <math.h>
#include <string.h>

#include "tests/bench/baseline/paper_rules.h"
#include "tests/bench/bench_shots.h"

/* Figures of a frame; FULL: triangles in sight at full detail; PX: d'. */
enum { TRIANGLES, LINES, POINTS, VERTICES, FULL, WRONG, P, R, Q, S8, M16, S16, MS, PX, FIGURES };

/* A scene's pack, and the view at hand. */
struct study {
	struct bench *bench;
	struct eco_request request;
	struct bench_client *client;
	struct paper_scene *scene;
	bool sees;                   /* S8, M16, S16 are measured */
	char pack[512], stamp[64];
};

static uint32_t find_pack(struct study *s, struct bench *bench, const char *scene,
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX])
{
	*s = (struct study){ .bench = bench };
	bench_scene(bench, scene, "stochastic", s->pack);
	snprintf(s->stamp, sizeof s->stamp, "%s", bench_pack_stamp(s->pack));
	return bench_shot_views(bench, scene, requests);
}

static void close_study(struct study *s)
{
	bench_client_close(s->client);
	paper_scene_close(s->scene);
}

static void count_kinds(const struct view_store *store, const struct view_selection *selection,
	double figure[FIGURES])
{
	static const int kinds[4] = { FIGURES, POINTS, LINES, TRIANGLES };
	const struct eco_plan *plan = view_store_plan(store);
	for (uint32_t c = 0; c < selection->cut_count; c++) {
		const struct view_list *list = view_store_list(store, plan->cuts[c].list);
		uint32_t vertices = list ? eco_list_vertices(&list->list) : 0;
		if (vertices > 0 && vertices < 4)
			figure[kinds[vertices]] += (double)eco_cut_primitives(&plan->cuts[c]) *
				(selection->member_first[c + 1] - selection->member_first[c]);
	}
}

/* By his rule, at d' = px pixels, or with px 0 at the least d' within the budget. */
static void draw(struct study *s, double px, struct paper_deussen how, const char *file,
	double figure[FIGURES])
{
	struct bench_frame frame = { .request = s->request };
	struct paper_frame drawn;
	const struct eco_view *view = &s->request.view;
	const struct view_measures *m = &frame.measures;
	double one = 2 * tan(view->fov_y_deg * M_PI / 360) / view->height, x = px * one;
	if (!s->client) {
		s->client = bench_client_open(s->pack);
		bench_client_untimed(s->client);
		must(paper_scene_open(&s->scene, s->pack, must_error));
		if (s->sees) {
			bench_client_see(s->client, s->bench);
			s->scene->sky = s->bench->sky;
		}
	}
	bench_client_reference(s->client, &s->request);
	paper_shoot(s->scene, &s->request, paper_deussen, &how, &x, s->sees ? BENCH_SAMPLES : 0, &drawn);
	bench_client_score(s->client, &frame, &drawn.picture);
	const double figures[FIGURES] = { [VERTICES] = (double)drawn.picture.vertices, [PX] = x / one,
		[FULL] = (double)bench_client_full(s->client)->vertices / 3,
		[WRONG] = (double)(m->score.fp + m->score.fn), [P] = m->score.precision,
		[R] = m->score.recall, [Q] = m->score.q, [S8] = m->picture_error, [M16] = m->blocks.color,
		[S16] = m->blocks.contrast,
		[MS] = bench_gl_ms(s->scene->store, &drawn.selection, view) };
	memcpy(figure, figures, sizeof figures);
	count_kinds(s->scene->store, &drawn.selection, figure);
	if (file)
		bench_picture_write(s->bench, file, drawn.picture.width, drawn.picture.height,
			drawn.picture.rgb);
	paper_frame_free(&drawn);
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

static json_t *shoot(void *ctx)
{
	double figure[FIGURES];
	draw(ctx, 0, (struct paper_deussen){ 0 }, NULL, figure);
	return bench_reals(figure, FIGURES);
}

static void write_table(struct bench *bench)
{
	bench_head(bench, "Elements drawn (table 1)");
	struct bench_table *table = bench_table_open(bench, "deussen_elements",
		"scene,rule,triangles in sight at full detail,triangles,lines,points,vertices,frames/s,Q,d' "
		"px", true);
	for (size_t i = 0; i < SCENES; i++) {
		struct study s;
		struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
		double m[FIGURES] = { 0 };
		if (!bench_scene_asked(bench, printed[i].scene))
			continue;
		bench_progress(0.6 * (double)i / SCENES, printed[i].name);
		uint32_t views = find_pack(&s, bench, printed[i].scene, requests);
		for (uint32_t v = 0; v < views; v++) {
			char name[96];
			s.request = requests[v];
			s.request.vertices = printed[i].vertices;
			snprintf(name, sizeof name, "deussen-%s-%u", printed[i].scene, v);
			const json_t *row = bench_unit(bench, name, s.stamp, shoot, &s);
			for (size_t f = 0; f < FIGURES; f++)
				m[f] += bench_cell(row, f) / views;
		}
		close_study(&s);
		bench_table_row(table, "%s,Deussen 2002,%s,-,-", printed[i].name, printed[i].row);
		bench_table_row(table,
			"%s,as printed on our plants,%.0f M,%.0f,%.0f,%.0f,%.0f,%.1f,%.3f,%.2f",
			printed[i].name, m[FULL] / 1e6, m[TRIANGLES], m[LINES], m[POINTS], m[VERTICES],
			1000 / m[MS], m[Q], m[PX]);
	}
	bench_table_close(table);
	bench_say(bench, "The budget is what the paper's elements come to (3 triangles + 2 lines + points); "
		"d' is the least that fits. Frames a second are of OpenGL on this machine, at the second "
		"time; the paper's are of a GeForce3. Triangles are those in sight, not of the whole scene.");
}

/* ---- Figure 5 ---- */

static const double distances[] = { 1, 2, 4, 8 }, factors[] = { 0.6, 1, 1.3, 1.5, 2 };
#define FACTORS (sizeof factors / sizeof *factors)
#define SWEEP (FACTORS * sizeof distances / sizeof *distances)
/* the pictures a, b, c of the figure, by their place in the sweep */
static const struct { size_t at; const char *file, *caption; } shown[] = {
	{ 2, "deussen-a.png", "d' of a pixel, c_p 1.3" },
	{ 2 * FACTORS, "deussen-b.png", "d' of four pixels and a splat factor of .6, which leaves holes" },
	{ 2 * FACTORS + 3, "deussen-c.png", "the same d', c_p 1.5" } };

static json_t *sweep(void *ctx)
{
	double figure[SWEEP][FIGURES];
	for (size_t i = 0; i < SWEEP; i++) {
		const char *file = NULL;
		for (size_t k = 0; k < sizeof shown / sizeof *shown; k++)
			file = shown[k].at == i ? shown[k].file : file;
		draw(ctx, distances[i / FACTORS], (struct paper_deussen){ .splat_factor
			= factors[i % FACTORS] }, file, figure[i]);
	}
	return bench_reals(*figure, SWEEP * FIGURES);
}

static void write_sweep(struct bench *bench)
{
	struct study s;
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	double figure[SWEEP][FIGURES];
	find_pack(&s, bench, "outdoor", requests);
	s.request = requests[0];
	s.request.vertices = ECO_VERTICES_MAX;
	s.sees = true;
	bench_head(bench, "Sample distance and splat factor (figure 5)");
	bench_progress(0.6, "sample distances and splat factors");
	bench_cells(bench_unit(bench, "deussen-sweep", s.stamp, sweep, &s), *figure, SWEEP * FIGURES);
	close_study(&s);
	struct bench_table *table = bench_table_open(bench, "deussen_sweep",
		"d' px,c_p,triangles,lines,points,vertices,wrong pixels,P,R,Q,S8,m16,s16", true);
	for (size_t i = 0; i < SWEEP; i++) {
		const double *d = figure[i];
		bench_table_row(table, "%g,%g,%.0f,%.0f,%.0f,%.0f,%.0f,%.3f,%.3f,%.3f,%.4f,%.3f,%.3f",
			distances[i / FACTORS], factors[i % FACTORS], d[TRIANGLES], d[LINES], d[POINTS],
			d[VERTICES], d[WRONG], d[P], d[R], d[Q],
			d[S8], d[M16], d[S16]);
	}
	bench_table_close(table);
	for (size_t i = 0; i < sizeof shown / sizeof *shown; i++)
		bench_picture(bench, shown[i].file, shown[i].caption);
}

/* ---- The octree of complex plants (6.1) ---- */

static const struct {
	const char *scene;
	uint64_t vertices;
} complex_plants[] = { { "crown", 3000 }, { "crown", 10000 }, { "sunflowers", 300000 },
	{ "sunflowers", 2190000 } };

static json_t *compare_cells(void *ctx)
{
	double figure[2][FIGURES];
	for (int whole = 0; whole < 2; whole++)
		draw(ctx, 0, (struct paper_deussen){ .whole = whole }, NULL, figure[whole]);
	return bench_reals(*figure, 2 * FIGURES);
}

static void write_cells(struct bench *bench)
{
	bench_head(bench, "Cells of complex plants on and off (6.1)");
	struct bench_table *table = bench_table_open(bench, "deussen_cells",
		"scene,vertices,view,Q with cells,Q without,wrong pixels with,wrong pixels without", true);
	for (size_t i = 0; i < sizeof complex_plants / sizeof *complex_plants; i++) {
		struct study s;
		struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
		const char *scene = complex_plants[i].scene;
		unsigned long long vertices = complex_plants[i].vertices;
		if (!bench_scene_asked(bench, scene))
			continue;
		bench_progress(0.9, scene);
		uint32_t views = find_pack(&s, bench, scene, requests);
		for (uint32_t v = 0; v < views; v++) {
			char name[96];
			double figure[2][FIGURES];
			s.request = requests[v];
			s.request.vertices = vertices;
			/* so near to a plant that its cells stand at different distances */
			for (int k = 0; k < 3; k++)
				s.request.view.eye[k] += 0.6 * (s.request.view.target[k]
					- s.request.view.eye[k]);
			snprintf(name, sizeof name, "deussen-cells-%s-%llu-%u", scene, vertices, v);
			bench_cells(bench_unit(bench, name, s.stamp, compare_cells, &s), *figure, 2 * FIGURES);
			bench_table_row(table, "%s,%llu,%u,%.3f,%.3f,%.0f,%.0f", scene, vertices, v,
				figure[0][Q], figure[1][Q], figure[0][WRONG], figure[1][WRONG]);
		}
		close_study(&s);
	}
	bench_table_close(table);
}

static void run(struct bench *bench)
{
	write_table(bench);
	write_sweep(bench);
	write_cells(bench);
}

const struct bench_section bench_deussen = { "deussen", "Deussen 2002: elements, sample distance, cells",
	run };
