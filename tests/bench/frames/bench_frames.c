/* Error against run time: every method at every budget, on whole scenes, with what it costs to plan, send,
 * decode and draw it. The error is that of the covered pixels against full detail of the same view (Neubert
 * 2011, equations 1 and 4), beside measures that a few large blobs cannot win: skill, owner_q, colour. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/draw/view_picture.h"
#include "tests/bench/bench_shots.h"
#include "tests/bench/frames/bench_still.h"

static const struct { const char *name, *title; } scenes[] = {
	{ "crown", "One tree, crown of 6,143 leaves" },
	{ "outdoor", "Outdoor scene, 120 M triangles" },
	{ "trees5000", "5,000 trees, 1.3 G vertices" },
	{ "scbi", "SCBI, a forest inventory" },
	{ "trees640", "640 trees, 10 M triangles" },
	{ "palms", "1,500 palms, 12 M triangles" },
	{ "sunflowers", "13,000 sunflowers and a maple, 70 M triangles" },
	{ "trees1276", "1,276 trees, 63 M vertices" } };
#define SCENES (sizeof scenes / sizeof *scenes)
#define NARROW 10e3              /* bits a millisecond */
#define WIDE 100e3

static double times_of(const json_t *row, double bits_a_ms)
{
	double transfer = 8 * bench_shot_number(row, "bytes") / bits_a_ms;
	return bench_shot_number(row, "plan_ms") + transfer + bench_shot_number(row, "decode_ms")
		+ bench_shot_number(row, "draw_ms");
}

/* ---- All frames of a scene ---- */

enum figure { QUALITY, PRECISION, RECALL, WRONG, SKILL, OWNER, SOFT, CEILING, SEEN, COLOUR, PREDICTED,
	VERTICES, BYTES, PLAN,
	DECODE, DRAW, TOTAL_10, TOTAL_100, SENT_10, SENT_100, FIGURES };
static const char *const figure_keys[FIGURES] = { "q", "p", "r", "wrong", "skill", "owner_q", "soft_q",
	"ceiling",
	"picture_error", "colour",
	"predicted_q", "vertices", "bytes", "plan_ms",
	"decode_ms", "draw_ms", NULL, NULL, NULL, NULL };

/* over views; what is NaN in one does not count */
struct means { double sum[FIGURES]; uint32_t count[FIGURES]; };

struct study {
	const char *scene;
	uint32_t views, budgets;
	uint64_t vertices[BENCH_BUDGETS_MAX];
	bool aerial[BENCH_SHOT_VIEWS_MAX];
	/* from: ours, at eye level and from above */
	struct means all[BENCH_METHODS][BENCH_BUDGETS_MAX], from[2][BENCH_BUDGETS_MAX];
	struct means view[BENCH_METHODS][BENCH_SHOT_VIEWS_MAX][BENCH_BUDGETS_MAX];
	bool done[BENCH_METHODS];
	double share;                /* of the section that is done before this scene */
};

static double mean(const struct means *means, enum figure figure)
{
	return means->count[figure] ? means->sum[figure] / means->count[figure] : NAN;
}

static double value_of(const json_t *row, enum figure figure)
{
	switch (figure) {
	case TOTAL_10: return times_of(row, NARROW);
	case TOTAL_100: return times_of(row, WIDE);
	case SENT_10: return 8 * bench_shot_number(row, "bytes") / NARROW;
	case SENT_100: return 8 * bench_shot_number(row, "bytes") / WIDE;
	default: return bench_shot_number(row, figure_keys[figure]);
	}
}

static void add(struct means *means, const json_t *row)
{
	for (int f = 0; f < FIGURES; f++) {
		double value = value_of(row, (enum figure)f);
		if (!isnan(value)) {
			means->sum[f] += value;
			means->count[f]++;
		}
	}
}

static void write_row(struct bench_table *table, const struct study *s, uint32_t method, uint32_t view,
	uint32_t budget, const json_t *row)
{
	double bits = 8 * bench_shot_number(row, "bytes");
	bench_table_row(table,
		"%s,%s,%u,%llu,%.5f,%.5f,%.5f,%.0f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.2f,%.2f,%.2f,%.2f,"
		"%.2f,%.2f,%.2f,%.0f,%.0f", s->scene, bench_methods[method].name, view,
		(unsigned long long)s->vertices[budget], 1 - bench_shot_number(row, "q"),
		bench_shot_number(row, "p"), bench_shot_number(row, "r"), bench_shot_number(row, "wrong"),
		bench_shot_number(row, "skill"), bench_shot_number(row, "owner_q"),
		bench_shot_number(row, "soft_q"), bench_shot_number(row, "ceiling"),
		bench_shot_number(row, "picture_error"),
		bench_shot_number(row, "colour"), bench_shot_number(row, "predicted_q"),
		bench_shot_number(row, "plan_ms"), bits / NARROW, bits / WIDE,
		bench_shot_number(row, "decode_ms"), bench_shot_number(row, "draw_ms"), times_of(row, NARROW),
		times_of(row, WIDE), bench_shot_number(row, "vertices"), bench_shot_number(row, "bytes"));
}

static enum eco_code study_method(struct bench *bench, struct study *s, uint32_t method,
	struct bench_table *table, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (uint32_t v = 0; v < s->views && !code; v++) {
		json_t *rows;
		char what[96];
		snprintf(what, sizeof what, "%s, %s, view %u", s->scene, bench_methods[method].name, v);
		bench_progress(bench,
			s->share + ((double)method + (double)v / s->views) / (BENCH_METHODS * (double)SCENES),
			what);
		code = bench_shots(bench, s->scene, method, v, &rows, error);
		for (uint32_t b = 0; b < s->budgets && !code; b++) {
			const json_t *row = json_array_get(rows, b);
			write_row(table, s, method, v, b, row);
			add(&s->all[method][b], row);
			add(&s->view[method][v][b], row);
			if (method == BENCH_OURS)
				add(&s->from[s->aerial[v]][b], row);
		}
	}
	s->done[method] = !code;
	return code;
}

static enum eco_code study_scene(struct bench *bench, struct study *s, struct bench_table *table,
	struct eco_error *error)
{
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	char pack[512];
	enum eco_code code = bench_scene(bench, s->scene, NULL, pack, error);
	if (code)
		return code;
	s->budgets = bench_budgets(bench, s->scene, s->vertices);
	s->views = bench_shot_views(bench, s->scene, requests);
	for (uint32_t v = 0; v < s->views; v++)
		s->aerial[v] = bench_view_aerial(&requests[v].view);
	for (uint32_t m = 0; m < BENCH_METHODS && !code; m++)
		if (bench->full || !bench_methods[m].full_only)
			code = study_method(bench, s, m, table, error);
	return code;
}

/* ---- Tables and plots ---- */

/* One table a scene, budget by budget, so that methods stand below each other. */
static void write_means(struct bench *bench, const struct study *s)
{
	char name[64];
	snprintf(name, sizeof name, "frames_%s", s->scene);
	struct bench_table *table = bench_table_open(bench, name, "budget,method,1-Q,P,R,wrong "
		"pixels,skill,owner_q,soft Q,ceiling,picture error,colour RMS,plan ms,transfer at "
		"10 Mbit/s ms,transfer at 100 Mbit/s ms,decode ms,draw ms,total at 10 Mbit/s ms,total at "
		"100 Mbit/s ms,vertices,bytes,predicted Q", true);
	for (uint32_t b = 0; b < s->budgets; b++)
		for (uint32_t m = 0; m < BENCH_METHODS; m++) {
			const struct means *a = &s->all[m][b];
			if (s->done[m])
				bench_table_row(table,
					"%llu,%s,%.4f,%.4f,%.4f,%.0f,%.3f,%.3f,%.4f,%.4f,%.4f,%.4f,%.1f,"
					"%.1f,%.1f,%.1f,%.1f,%.1f,%.1f,%.0f,%.0f,%.4f",
					(unsigned long long)s->vertices[b], bench_methods[m].name,
					1 - mean(a, QUALITY), mean(a, PRECISION), mean(a, RECALL),
					mean(a, WRONG), mean(a, SKILL), mean(a, OWNER), mean(a, SOFT),
					mean(a, CEILING), mean(a, SEEN), mean(a, COLOUR),
					mean(a, PLAN), mean(a, SENT_10), mean(a, SENT_100), mean(a, DECODE),
					mean(a, DRAW), mean(a, TOTAL_10), mean(a, TOTAL_100),
					mean(a, VERTICES), mean(a, BYTES), mean(a, PREDICTED));
		}
	bench_table_close(table);
}

static void write_occlusion(struct bench_table *table, const struct study *s)
{
	if (!s->done[BENCH_OURS] || !s->done[BENCH_UNOCCLUDED])
		return;
	for (uint32_t b = 0; b < s->budgets; b++) {
		const struct means *on = &s->all[BENCH_OURS][b], *off = &s->all[BENCH_UNOCCLUDED][b];
		bench_table_row(table, "%s,%llu,%.4f,%.4f,%.0f,%.0f,%.3f,%.3f,%.3f", s->scene,
			(unsigned long long)s->vertices[b], mean(on, QUALITY), mean(off, QUALITY),
			mean(on, WRONG), mean(off, WRONG), mean(off, WRONG) > 0
			? mean(on, WRONG) / mean(off, WRONG) : 1, mean(on, SKILL), mean(off, SKILL));
	}
}

/* ---- At equal Q ---- */

/* how much worse ours is than the stochastic order, in the mean of a scene; the worst scene */
struct lost { double owner, colour; };

/* Our figure in a view at the budget where our Q is `q`, between the two budgets around it. NaN where there
 * is none. */
static double ours_at(const struct study *s, uint32_t view, double q, enum figure figure)
{
	const struct means *m = s->view[BENCH_OURS][view];
	for (uint32_t b = 0; b + 1 < s->budgets; b++) {
		double low = mean(&m[b], QUALITY), high = mean(&m[b + 1], QUALITY);
		if (low <= q && q < high)
			return mean(&m[b], figure)
				+ (q - low) / (high - low) * (mean(&m[b + 1], figure) - mean(&m[b], figure));
	}
	return NAN;
}

/* View by view: a mean of views would set one in which ours has the higher Q against another in which it has
 * the lower. */
static void write_equal(struct bench_table *table, const struct study *s, struct lost *lost)
{
	struct lost sum = { 0 };
	uint32_t count = 0;
	if (!s->done[BENCH_OURS] || !s->done[BENCH_STOCHASTIC])
		return;
	for (uint32_t i = 0; i < s->views * s->budgets; i++) {
		uint32_t v = i / s->budgets;
		const struct means *cook = &s->view[BENCH_STOCHASTIC][v][i % s->budgets];
		double q = mean(cook, QUALITY), owner = ours_at(s, v, q, OWNER),
			colour = ours_at(s, v, q, COLOUR), vertices = ours_at(s, v, q, VERTICES);
		if (isnan(vertices))
			continue;
		bench_table_row(table, "%s,%u,%.4f,%.0f,%.0f,%.1f,%.3f,%.3f,%.4f,%.4f", s->scene, v, q,
			mean(cook, VERTICES), vertices, 100 * (1 - vertices / mean(cook, VERTICES)),
			mean(cook, OWNER), owner, mean(cook, COLOUR), colour);
		sum.owner += mean(cook, OWNER) - owner;
		sum.colour += colour - mean(cook, COLOUR);
		count++;
	}
	if (count) {
		lost->owner = fmax(lost->owner, sum.owner / count);
		lost->colour = fmax(lost->colour, sum.colour / count);
	}
}

#define ERROR_LEAST 1e-4         /* below, a logarithmic axis shows only noise */

static enum eco_code plot_over(struct bench *bench, const struct study *s, enum figure x, const char *kind,
	const char *label, struct eco_error *error)
{
	double at[BENCH_METHODS][BENCH_BUDGETS_MAX], wrong[BENCH_METHODS][BENCH_BUDGETS_MAX];
	struct bench_series series[BENCH_METHODS];
	char name[96], title[128];
	uint32_t count = 0;
	for (uint32_t m = 0; m < BENCH_METHODS; m++) {
		if (!s->done[m])
			continue;
		for (uint32_t b = 0; b < s->budgets; b++) {
			at[m][b] = mean(&s->all[m][b], x);
			wrong[m][b] = fmax(1 - mean(&s->all[m][b], QUALITY), ERROR_LEAST);
		}
		series[count++] = (struct bench_series){ bench_methods[m].name, at[m], wrong[m], s->budgets,
			false };
	}
	snprintf(name, sizeof name, "frames-%s-%s", s->scene, kind);
	snprintf(title, sizeof title, "%s: mean error of %u view%s", s->scene, s->views,
		s->views == 1 ? "" : "s");
	return bench_plot(bench, &(struct bench_plot){ .name = name, .title = title, .x = label, .y = "1 - Q",
		.log_x = true, .log_y = true,
		.series = series, .series_count = count }, error);
}

/* ---- Pictures: ours, full detail, and where they differ ---- */

static bool has_picture(const struct bench *bench, const char *file)
{
	char path[1024];
	snprintf(path, sizeof path, "%s/%s", bench->out, file);
	FILE *in = fopen(path, "rb");
	if (in)
		fclose(in);
	return in;
}

static enum eco_code write_three(struct bench *bench, const char *file, const struct view_picture *ours,
	const struct view_picture *full, struct eco_error *error)
{
	uint32_t w = ours->width, h = ours->height;
	uint8_t *compare = malloc((size_t)w * h * 3), *rgb = malloc((size_t)w * h * 9);
	enum eco_code code = compare && rgb ? ECO_OK
		: eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	if (!code) {
		const uint8_t *parts[3] = { ours->rgb, full->rgb, compare };
		view_picture_compare(ours->cover, full->cover, w * h, compare);
		for (uint32_t y = 0; y < h; y++)
			for (uint32_t i = 0; i < 3; i++)
				memcpy(rgb + ((size_t)y * 3 + i) * w * 3, parts[i] + (size_t)y * w * 3,
					(size_t)w * 3);
		code = bench_picture_write(bench, file, 3 * w, h, rgb, error);
	}
	free(compare);
	free(rgb);
	return code;
}

/* One view at some budgets, by the software rasteriser, which skips what is hidden: full detail of any scene
 * in seconds. */
static enum eco_code draw_pictures(struct bench *bench, const char *scene, const char *pack,
	const struct eco_request *request, const uint64_t *budgets, uint32_t count, const char *view,
	struct eco_error *error)
{
	struct bench_still *still = NULL;
	struct view_picture full = { 0 }, ours = { 0 };
	struct eco_request asked = *request;
	enum eco_code code = bench_still_open(&still, pack, error);
	/* full detail first: the others are compared with it */
	for (uint32_t i = 0; i <= count && !code; i++) {
		uint32_t at = (i + count) % (count + 1);
		char file[128];
		asked.vertices = at == count ? ECO_VERTICES_MAX : budgets[at];
		asked.ground_px = at == count ? ECO_GROUND_PX_MIN : 0;
		asked.texel_px = at == count ? ECO_TEXEL_PX_MIN : 0;
		snprintf(file, sizeof file, "frames-%s-%s-%llu.png", scene, view,
			(unsigned long long)asked.vertices);
		code = bench_still_draw(still, &asked, at == count ? &full : &ours, NULL, error);
		if (!code && at < count)
			code = write_three(bench, file, &ours, &full, error);
	}
	view_picture_free(&full);
	view_picture_free(&ours);
	bench_still_close(still);
	return code;
}

static enum eco_code show_pictures(struct bench *bench, const char *scene, struct eco_error *error)
{
	static const uint64_t many[] = { 1000000, 5000000, 26000000 }, one[] = { 1000000 },
		tree[] = { 10000 };
	struct eco_request requests[BENCH_SHOT_VIEWS_MAX];
	char pack[512], unit[96];
	bool all = strcmp(scene, "trees5000") == 0, scbi = strcmp(scene, "scbi") == 0;
	const uint64_t *budgets = all ? many : strcmp(scene, "crown") == 0 ? tree : one;
	uint32_t count = all ? 3 : 1, views = bench_shot_views(bench, scene, requests);
	enum eco_code code = bench_scene(bench, scene, NULL, pack, error);
	for (uint32_t v = 0; v < views && !code; v += !scbi ? views : 1) {
		const char *kind = bench_view_aerial(&requests[v].view) ? "above" : "eye";
		char name[32], file[128], caption[256];
		snprintf(name, sizeof name, "%s%u", kind, v);
		snprintf(unit, sizeof unit, "pictures-%s-%s", scene, name);
		snprintf(file, sizeof file, "frames-%s-%s-%llu.png", scene, name,
			(unsigned long long)budgets[0]);
		if (!bench_recall(bench, unit, bench_pack_stamp(pack)) || !has_picture(bench, file)) {
			code = draw_pictures(bench, scene, pack, &requests[v], budgets, count, name, error);
			if (!code)
				bench_keep(bench, unit, bench_pack_stamp(pack), json_true());
		}
		for (uint32_t b = 0; b < count && !code; b++) {
			snprintf(file, sizeof file, "frames-%s-%s-%llu.png", scene, name,
				(unsigned long long)budgets[b]);
			snprintf(caption, sizeof caption, "%s at %llu vertices; full detail; light: right, "
				"orange: too much, blue: missing", scene, (unsigned long long)budgets[b]);
			bench_picture(bench, file, caption);
		}
	}
	return code;
}

/* ---- The time of full detail ---- */

#define RATIO_WIDTH 1600u        /* as in Neubert 2011, section 5 */
#define RATIO_HEIGHT 1200u
#define RATIO_VERTICES 26000000u

static enum eco_code time_reference(struct bench *bench, const char *pack, json_t **unit,
	struct eco_error *error)
{
	struct eco_request request;
	struct bench_still *still = NULL;
	struct view_picture picture = { 0 };
	double ms[2] = { 0, 0 }, vertices[2] = { 0, 0 };
	enum eco_code code = bench_scene_views(bench, "trees5000", &request, 1) == 1 ? ECO_OK
		: eco_fail(error, ECO_NOT_FOUND,
		"no view of the 5,000 trees");
	if (!code)
		code = bench_still_open(&still, pack, error);
	request.view.width = RATIO_WIDTH;
	request.view.height = RATIO_HEIGHT;
	request.bytes = ECO_BYTES_UNBOUNDED;
	for (int i = 0; i < 2 && !code; i++) {
		request.vertices = i ? ECO_VERTICES_MAX : RATIO_VERTICES;
		request.ground_px = i ? ECO_GROUND_PX_MIN : 0;
		request.texel_px = i ? ECO_TEXEL_PX_MIN : 0;
		code = bench_still_draw(still, &request, &picture, NULL, error);
		ms[i] = picture.draw_ms;
		vertices[i] = (double)picture.vertices;
	}
	view_picture_free(&picture);
	bench_still_close(still);
	if (!code)
		*unit = bench_keep(bench, "reference-trees5000", bench_pack_stamp(pack),
			json_pack("{s:f, s:f, s:f, s:f}", "frame_ms", ms[0], "full_ms", ms[1], "vertices",
			vertices[0], "full_vertices", vertices[1]));
	return code;
}

static enum eco_code show_reference(struct bench *bench, struct eco_error *error)
{
	char pack[512];
	enum eco_code code = bench_scene(bench, "trees5000", NULL, pack, error);
	json_t *unit = code ? NULL : bench_recall(bench, "reference-trees5000", bench_pack_stamp(pack));
	if (!code && !unit)
		code = time_reference(bench, pack, &unit, error);
	if (code)
		return code;
	double frame = bench_shot_number(unit, "frame_ms"), full = bench_shot_number(unit, "full_ms");
	bench_say(bench, "The 5,000 trees at %u x %u by the software rasteriser: %.0f vertices in view in "
		"%.0f ms, %.0f in %.0f ms.", RATIO_WIDTH, RATIO_HEIGHT,
		bench_shot_number(unit, "full_vertices"), full, bench_shot_number(unit, "vertices"), frame);
	bench_key(bench, "trees5000_reference_ratio", full / frame,
		"<= 10: time of full detail over that of 26 M vertices, rasteriser");
	return ECO_OK;
}

/* ---- Keys ---- */

static uint32_t at_budget(const struct study *s, uint64_t vertices)
{
	for (uint32_t b = 0; b < s->budgets; b++)
		if (s->vertices[b] == vertices)
			return b;
	return UINT32_MAX;
}

static double key_mean(const struct study *s, bool aerial, enum figure figure)
{
	uint32_t b = at_budget(s, 1000000);
	return b < s->budgets ? mean(&s->from[aerial][b], figure) : NAN;
}

static void scbi_keys(struct bench *bench, const struct study *s)
{
	bench_key(bench, "scbi_aerial_q", key_mean(s, true, QUALITY),
		">= 0.92: Q from above at 1,000,000 vertices");
	bench_key(bench, "scbi_aerial_skill", key_mean(s, true, SKILL), ">= 0.6: skill there");
	bench_key(bench, "scbi_eye_q", key_mean(s, false, QUALITY),
		">= 0.88: Q at eye level at 1,000,000 vertices");
	bench_key(bench, "scbi_eye_skill", key_mean(s, false, SKILL), ">= 0.5: skill there");
}

static void trees5000_keys(struct bench *bench, const struct study *s)
{
	static const struct { uint64_t vertices; const char *key; } keys[] =
		{ { 1000000, "trees5000_q_1m" }, { 5000000, "trees5000_q_5m" },
		{ 26000000, "trees5000_q_26m" } };
	for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
		uint32_t b = at_budget(s, keys[i].vertices);
		bench_key(bench, keys[i].key, b < s->budgets ? mean(&s->all[BENCH_OURS][b], QUALITY) : NAN,
			"Q at so many vertices");
	}
}

/* ---- The section ---- */

struct tables { struct bench_table *frames, *occlusion, *equal; };

static enum eco_code run_scene(struct bench *bench, size_t index, const struct tables *tables,
	struct lost *lost, struct eco_error *error)
{
	const char *scene = scenes[index].name;
	struct study *s = calloc(1, sizeof *s);
	if (!s)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for the figures of %s", scene);
	s->scene = scene;
	s->share = (double)index / SCENES;
	char pack[512];
	enum eco_code code;
	bool found = bench_shot_scene(bench, scene, pack, &code, error);
	if (!code && found)
		code = study_scene(bench, s, tables->frames, error);
	if (!code && found) {
		bench_head(bench, scenes[index].title);
		write_occlusion(tables->occlusion, s);
		write_equal(tables->equal, s, lost);
		code = plot_over(bench, s, TOTAL_100, "time", "plan + transfer at 100 Mbit/s + decode + "
			"draw, ms", error);
		write_means(bench, s);
	}
	if (!code && found)
		code = plot_over(bench, s, VERTICES, "vertices", "vertices drawn", error);
	if (!code && found)
		code = show_pictures(bench, scene, error);
	if (!code && strcmp(scene, "scbi") == 0)
		scbi_keys(bench, s);
	if (!code && strcmp(scene, "trees5000") == 0)
		trees5000_keys(bench, s);
	if (!code && found && strcmp(scene, "trees5000") == 0)
		code = show_reference(bench, error);
	free(s);
	return code;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	bench_say(bench, "Every picture %u x %u, all chunks sent anew. Budgets of the literature are among "
		"the rows: Deussen 2002, table 1 (points + "
		"2 lines "
		"+ 3 triangles): 640 trees 2.10 M, palms 1.76 M, outdoor 2.48 M, sunflowers 2.19 M; Neubert "
		"2011: 5,000 trees 26 M.", BENCH_SHOT_WIDTH, BENCH_SHOT_HEIGHT);
	struct tables tables = { .frames = bench_table_open(bench, "frames", "scene,method,view,budget,1-Q,"
		"P,R,wrong pixels,skill,owner_q,soft Q,ceiling,picture error,colour RMS,"
		"predicted Q,plan ms,transfer at 10 Mbit/s ms,transfer at 100 Mbit/s ms,decode ms,draw "
		"ms,total at 10 Mbit/s ms,total at 100 Mbit/s ms,"
		"vertices,bytes", false) };
	bench_head(bench, "Occlusion on and off, at equal vertices");
	tables.occlusion = bench_table_open(bench, "frames_occlusion",
		"scene,vertices,Q with occlusion,Q without,wrong with,wrong without,ratio,skill "
		"with,skill without", true);
	bench_head(bench, "At the Q of the stochastic order (Cook)");
	bench_say(bench, "The same scenes by the same planner, from packs whose leaves come in that order. "
		"Ours is between two budgets that have a "
		"lower and a higher Q in the same view. An owner is a plant.");
	tables.equal = bench_table_open(bench, "frames_equal", "scene,view,Q,vertices,vertices of "
		"ours,fewer %,owner_q,owner_q of ours,"
		"colour RMS,colour RMS of ours", true);
	struct lost lost = { -INFINITY, -INFINITY };
	for (size_t i = 0; i < SCENES && !code; i++)
		code = run_scene(bench, i, &tables, &lost, error);
	bench_table_close(tables.frames);
	bench_table_close(tables.occlusion);
	bench_table_close(tables.equal);
	if (!code && isfinite(lost.owner)) {
		bench_key(bench, "frames_owner_q_lost", fmax(0, lost.owner),
			"<= 0: owner Q below the stochastic order's at equal Q, mean of the "
			"worst scene");
		bench_key(bench, "frames_colour_lost", fmax(0, lost.colour),
			"<= 0: colour RMS above it, likewise");
	}
	return code;
}

const struct bench_section bench_frames = { "frames", "Error against run time", run,
	.objects = BENCH_OBJECTS_FRAMES "tests/bench/bench_frame.o tests/bench/bench_sh*.o "
	"tests/bench/frames/bench_frames.o tests/bench/frames/bench_st*.o" };
