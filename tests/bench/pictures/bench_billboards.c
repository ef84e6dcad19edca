/* Billboard clouds (Kratt et al. 2014): Precision and Recall by the number of billboards (figure 3) and
 * pictures of three clouds and of a field (figure 4); beside them ours at equal vertices; and a turn against
 * pruned leaves of the same mean Q (Neubert 2011, figure 11). The paper prints a diagram without a scale of
 * vertices, and no figures. */
#include <math.h>
#include <string.h>

#include "ecofiles/base/angle16.h"
#include "lod/build/order/rank.h"
#include "tests/bench/baseline/billboard_cloud.h"
#include "tests/bench/bench_leaves.h"
#include "tests/bench/pictures/bench_billboards.h"

#define PLANTS_MOST 8u
#define VIEWS 24u
#define SEED 90217u
#define VIEW 7u                          /* of the picture */
#define PANELS 5u                        /* the whole plant, three caps, Precision and Recall */
#define TURN_VIEWS 36u
#define TURN_UP 0.1                      /* the eye's height over the plant's middle, as a slope */
#define TUNING 6u                        /* of the turn's views: scales are chosen in these */
#define STEPS 10                         /* of the search for a number of leaves */
#define SCALES 7

/* The first caps have as many vertices, at 6 each, as the budgets of ours. Figure 11 of Neubert has 209. */
#define BUDGETS 4u
static const double budgets[BUDGETS] = { 12, 48, 200, 1000 };
#define CAPS 6u
#define TURNED 4u
static const uint32_t caps[CAPS] = { 2, 8, 33, 166, 209, 333 };
/* A turn: billboards against three orders of leaves that are pruned to the same mean Q, each at its best
 * scale. */
enum turn { BILLBOARDS, STOCHASTIC, COMBINED, GREEDY, TURNS };
static const char *const turn_names[TURNS] = { "209 billboards", "stochastic", "combined", "greedy" };
enum figure { COUNT, PARTS, FORM_CROSS, FORM_PLANE, FORM_STRIP, ERROR, INVALID, EPSILON, TEXELS,
	PRECISION, RECALL, QUALITY, FIGURES };
static const struct bench_column columns[FIGURES] = { { "billboards", 0 }, { "parts", 0 }, { "crosses", 0 },
	{ "planes", 0 }, { "strips", 0 }, { "error", 3 }, { "invalid", 3 }, { "epsilon", 4 },
	{ "thousand texels", 0 }, { "Precision", 3 }, { "Recall", 3 }, { "Q", 3 } };

/* The unit of a plant. */
struct figures {
	double clouds[CAPS][FIGURES];
	/* of a turn: vertices, vertices of wood besides, Q of each view; NaN: the mean is not reached */
	double turns[TURNS][2 + TURN_VIEWS];
	double ours[BUDGETS];                /* Q */
};
#define NUMBERS (sizeof(struct figures) / sizeof(double))

struct study {
	struct bench *bench;
	const struct bench_model *model;
	struct bench_leaves *leaves;
	struct lod_billboard_plant *plant;
	struct lod_sights looks, turn;
	struct figures made;
};

static void draw_cloud(const void *cloud, const struct lod_eye *eye, struct lod_raster *raster)
{
	lod_billboard_cloud_draw(cloud, 1, raster);
}

/* ---- Clouds by cap ---- */

/* One view of a cloud in its mean colours. The panel after the last cloud compares (figure 3): light grey
 * where both are, grey where the cloud is missing, black where only that is. */
static void paint(struct study *s, const struct lod_billboard_cloud *cloud, uint8_t *picture, uint32_t panel)
{
	struct lod_raster ids;
	lod_raster_init(&ids, &(struct lod_raster_options){ .width = BENCH_PIXELS, .height = BENCH_PIXELS,
		.item = true });
	lod_raster_clear(&ids);
	lod_raster_camera(&ids, &s->looks.eyes[VIEW], s->looks.near_m);
	lod_raster_object(&ids, &(struct lod_place){ .cosine = 1, .scale = 1 });
	lod_billboard_cloud_draw(cloud, 1, &ids);
	for (size_t i = 0; i < BENCH_PIXELS * BENCH_PIXELS; i++) {
		uint8_t *at = picture + 3 * ((i / BENCH_PIXELS * PANELS + panel) * BENCH_PIXELS + i % BENCH_PIXELS);
		bool shown = ids.cover[i], wanted = s->looks.reference[VIEW][i / 64] >> i % 64 & 1;
		memset(at, 255, 3);
		if (shown)
			memcpy(at, cloud->items[ids.item[i]].rgb, 3);
		if (panel + 2 == PANELS)
			memset(at + 3 * BENCH_PIXELS, !wanted && !shown ? 255 : !wanted ? 0 : shown ? 210 : 130, 3);
	}
	lod_raster_free(&ids);
}

static void study_caps(struct study *s)
{
	char file[128];
	uint8_t *picture = lod_arena_take(&s->leaves->arena, (size_t)PANELS * BENCH_PIXELS * BENCH_PIXELS, 3);
	bench_leaves_paint(s->leaves, &s->looks, VIEW, NULL, 0, PANELS, picture);
	for (uint32_t cap = 0; cap < CAPS; cap++) {
		struct lod_billboard_cloud cloud;
		struct lod_arena_piece *mark = s->leaves->arena.last;
		struct bench_wrong sum = { 0 };
		lod_billboard_cloud_make(&cloud, s->plant, caps[cap], &s->leaves->arena);
		for (uint32_t v = 0; v < VIEWS; v++)
			bench_leaves_compare_drawn(s->leaves, &s->looks, v, draw_cloud, &cloud, &sum);
		const double figure[FIGURES] = { cloud.count, cloud.parts, cloud.forms[0], cloud.forms[1],
			cloud.forms[2], cloud.error, cloud.invalid, cloud.epsilon, (double)cloud.texels / 1000,
			bench_wrong_precision(&sum), bench_wrong_recall(&sum), bench_wrong_q(&sum) };
		memcpy(s->made.clouds[cap], figure, sizeof figure);
		if (cap >= 1 && cap <= 3)
			paint(s, &cloud, picture, cap);
		lod_arena_release(&s->leaves->arena, mark);
	}
	snprintf(file, sizeof file, "billboards-%s.png", s->model->name);
	bench_picture_write(s->bench, file, PANELS * BENCH_PIXELS, BENCH_PIXELS, picture);
}

/* ---- A turn ---- */

static double leaves_q(struct study *s, const uint32_t *order, uint32_t count, float scale, uint32_t view)
{
	struct bench_wrong sum = { 0 };
	const struct lod_sights_drawing drawing = { .order = order, .count = count, .scale = scale };
	bench_leaves_compare(s->leaves, &s->turn, view, &drawing, &sum);
	return bench_wrong_q(&sum);
}

/* Q of each view of so many leaves at their best scale; returns the mean. */
static double prune(struct study *s, const uint32_t *order, uint32_t count, double q[TURN_VIEWS])
{
	double best = -INFINITY, mean = 0;
	float best_scale = 1;
	for (int i = 0; i < SCALES; i++) {
		float scale = (float)pow((double)s->leaves->foliage.count / count, (double)i / (SCALES - 1));
		double now = 0;
		for (uint32_t v = 0; v < TUNING; v++)
			now += leaves_q(s, order, count, scale, v * TURN_VIEWS / TUNING);
		best_scale = now > best ? scale : best_scale;
		best = fmax(best, now);
	}
	for (uint32_t v = 0; v < TURN_VIEWS; v++)
		mean += (q[v] = leaves_q(s, order, count, best_scale, v)) / TURN_VIEWS;
	return mean;
}

/* Prunes to a mean Q as near as can be, which is not reached if wood alone is better. */
static void prune_to(struct study *s, const uint32_t *order, double wanted, double turn[2 + TURN_VIEWS])
{
	const struct lod_foliage *f = &s->leaves->foliage;
	uint32_t low = 1, high = f->count;
	for (int i = 0; i < STEPS && low < high; i++) {
		/* counts are searched by their ratios */
		uint32_t middle = (uint32_t)sqrt((double)low * high);
		if (prune(s, order, middle, turn + 2) < wanted)
			low = middle + 1;
		else
			high = middle;
	}
	bool reached = fabs(prune(s, order, high, turn + 2) - wanted) <= 0.02;
	for (uint32_t v = 0; v < TURN_VIEWS; v++)
		turn[2 + v] = reached ? turn[2 + v] : NAN;
	turn[0] = (double)bench_leaves_vertices(f, order, high);
	turn[1] = 3.0 * (double)f->wood_count;
}

static void study_turn(struct study *s)
{
	double to[TURN_VIEWS][3], *q = s->made.turns[BILLBOARDS] + 2, mean = 0;
	struct lod_billboard_cloud cloud;
	struct lod_rank rank;
	for (uint32_t v = 0; v < TURN_VIEWS; v++) {
		double sine, cosine, flat = 1 / sqrt(1 + TURN_UP * TURN_UP);
		eco_angle16_sincos(eco_angle16_from_deg(360.0 * v / TURN_VIEWS), &sine, &cosine);
		to[v][0] = flat * cosine, to[v][1] = flat * sine, to[v][2] = flat * TURN_UP;
	}
	bench_leaves_sights(s->leaves, &s->turn, (const double (*)[3])to, TURN_VIEWS);
	lod_billboard_cloud_make(&cloud, s->plant, caps[TURNED], &s->leaves->arena);
	for (uint32_t v = 0; v < TURN_VIEWS; v++) {
		struct bench_wrong sum = { 0 };
		bench_leaves_compare_drawn(s->leaves, &s->turn, v, draw_cloud, &cloud, &sum);
		mean += (q[v] = bench_wrong_q(&sum)) / TURN_VIEWS;
	}
	s->made.turns[BILLBOARDS][0] = 6.0 * cloud.count;
	must(lod_rank_make(&rank, &s->leaves->foliage, &(struct lod_rank_options){ .seed = 1, .leaves = true },
		&s->leaves->arena, must_error));
	prune_to(s, bench_leaves_order(s->leaves, LOD_ORDER_STOCHASTIC, 0), mean, s->made.turns[STOCHASTIC]);
	prune_to(s, bench_leaves_order(s->leaves, LOD_ORDER_COMBINED, 0), mean, s->made.turns[COMBINED]);
	prune_to(s, rank.order, mean, s->made.turns[GREEDY]);
}

/* ---- One plant ---- */

static json_t *study_leaves(void *ctx, struct bench_leaves *leaves)
{
	struct study *s = ctx;
	s->leaves = leaves;
	bench_leaves_look(leaves, &s->looks, VIEWS, SEED);
	s->plant = lod_billboard_plant_make(&leaves->model, &leaves->arena);
	study_caps(s);
	study_turn(s);
	bench_leaves_ours(s->bench, leaves, s->model, &s->looks, budgets, BUDGETS, s->made.ours, NULL);
	return bench_reals((const double *)&s->made, NUMBERS);
}

/* ---- Tables ---- */

/* Rows of the comparison: billboards, ours. */
enum { ROWS = 2 };
static const char *const row_names[ROWS] = { "billboards", "ours" };

struct section {
	struct bench *bench;
	struct bench_table *caps, *q, *turn;
	uint32_t plants, turned[TURNS];
	double sum[ROWS][BUDGETS];           /* Q */
	double sd[TURNS], error[CAPS], precision[PLANTS_MOST][CAPS], recall[PLANTS_MOST][CAPS];
	char name[PLANTS_MOST][64];
};

static void write_rows(struct section *t, const char *plant, double q[ROWS][BUDGETS])
{
	for (int row = 0; row < ROWS; row++)
		bench_table_row(t->q, "%s,%s,%.3f,%.3f,%.3f,%.3f", plant, row_names[row], q[row][0],
			q[row][1], q[row][2], q[row][3]);
}

static void write_turn(struct section *t, const char *plant, struct figures *f)
{
	char name[100], title[160];
	double degrees[TURN_VIEWS];
	struct bench_series series[TURNS];
	for (int m = 0; m < TURNS; m++) {
		const double *q = f->turns[m] + 2;
		double mean = 0, square = 0, least = INFINITY, most = -INFINITY;
		for (uint32_t v = 0; v < TURN_VIEWS; v++) {
			degrees[v] = 360.0 * v / TURN_VIEWS;
			mean += q[v] / TURN_VIEWS;
			least = fmin(least, q[v]);
			most = fmax(most, q[v]);
		}
		for (uint32_t v = 0; v < TURN_VIEWS; v++)
			square += (q[v] - mean) * (q[v] - mean) / TURN_VIEWS;
		bench_table_row(t->turn, "%s,%s,%.0f,%.0f,%.3f,%.3f,%.3f,%.2e,%.4f", plant, turn_names[m],
			f->turns[m][0], f->turns[m][1], mean, least, most, square, sqrt(square));
		t->sd[m] += isfinite(square) ? sqrt(square) : 0;
		t->turned[m] += isfinite(square);
		series[m] = (struct bench_series){ turn_names[m], degrees, q, TURN_VIEWS, false };
	}
	snprintf(name, sizeof name, "billboards_turn_%s", plant);
	snprintf(title, sizeof title, "%s: Q over a turn, equal in the mean", plant);
	bench_plot(t->bench, &(struct bench_plot){ .name = name, .title = title, .x = "degrees",
		.y = "Q", .series = series, .series_count = TURNS });
}

static void study_plant(struct section *t, const struct bench_model *model)
{
	struct figures f;
	struct study s = { .bench = t->bench, .model = model };
	double q[ROWS][BUDGETS];
	char file[100];
	bench_leaves_unit(t->bench, "billboards", model, study_leaves, &s, (double *)&f, NUMBERS);
	for (size_t cap = 0; cap < CAPS; cap++) {
		bench_table_values(t->caps, f.clouds[cap], "%s,%u", model->name, caps[cap]);
		t->error[cap] += f.clouds[cap][ERROR];
		t->precision[t->plants][cap] = f.clouds[cap][PRECISION];
		t->recall[t->plants][cap] = f.clouds[cap][RECALL];
	}
	for (size_t b = 0; b < BUDGETS; b++) {
		t->sum[0][b] += q[0][b] = f.clouds[b][QUALITY];
		t->sum[1][b] += q[1][b] = f.ours[b];
	}
	write_rows(t, model->name, q);
	snprintf(t->name[t->plants++], sizeof t->name[0], "%s", model->name);
	snprintf(file, sizeof file, "billboards-%s.png", model->name);
	bench_picture(t->bench, file, "full detail; at most 8, 33, 166 billboards, each in its mean colour; "
		"of the last Precision and Recall: light grey true, grey missing, black too many");
	write_turn(t, model->name, &f);
}

/* Without the data folder generated plants stand for those with leaves. */
static bool is_foliage(const struct bench *bench, const struct bench_model *model)
{
	static const char *const files[] = { "/eztree_oak_large.", "/eztree_pine_medium.", "/orchids.",
		"/bush.", "/sapling_quaking_aspen_s7.", "/coconutTree." };
	for (size_t i = 0; i < sizeof files / sizeof *files; i++)
		if (!model->generated && strstr(model->path, files[i]))
			return true;
	return !bench->data;
}

static void plot(struct section *t)
{
	struct bench_series series[PLANTS_MOST];
	double cap[CAPS];
	for (uint32_t i = 0; i < CAPS; i++) {
		cap[i] = caps[i];
		t->error[i] /= t->plants;
	}
	for (uint32_t i = 0; i < ROWS * BUDGETS; i++)
		t->sum[i / BUDGETS][i % BUDGETS] /= t->plants;
	write_rows(t, "mean", t->sum);
	for (int row = 0; row < ROWS; row++)
		series[row] = (struct bench_series){ row_names[row], budgets, t->sum[row], BUDGETS, false };
	bench_plot(t->bench, &(struct bench_plot){ .name = "billboards",
		.title = "Q at equal vertices, mean over plants", .x = "vertices", .y = "Q",
		.log_x = true, .series = series, .series_count = ROWS });
	series[0] = (struct bench_series){ "error of the mean part", cap, t->error, CAPS, false };
	bench_plot(t->bench, &(struct bench_plot){ .name = "billboards_error",
		.title = "The method's own error against the cap", .x = "billboards at most",
		.y = "error", .log_x = true, .series = series, .series_count = 1 });
	for (uint32_t i = 0; i < t->plants; i++)
		series[i] = (struct bench_series){ t->name[i], t->recall[i], t->precision[i], CAPS, true };
	bench_plot(t->bench, &(struct bench_plot){ .name = "billboards_pr",
		.title = "Precision and Recall of clouds of 2 to 333 billboards", .x = "Recall",
		.y = "Precision", .series = series, .series_count = t->plants });
}

static void run(struct bench *bench)
{
	struct section t = { .bench = bench };
	struct bench_model last;             /* of most leaves */
	struct bench_walk walk = { .bench = bench, .most = bench->data ? PLANTS_MOST : 2, .quick = 1,
		.wants = is_foliage };
	t.caps = bench_table_described(bench, "billboards_caps", "plant,cap", columns, FIGURES, true);
	t.q = bench_table_open(bench, "billboards", "plant,kind,Q at 12 vertices,at 48,at 200,at 1000", true);
	t.turn = bench_table_open(bench, "billboards_turn",
		"plant,method,vertices,of wood besides,mean Q,least,"
		"most,variance,standard deviation", true);
	for (const struct bench_model *model; (model = bench_walk(&walk));) {
		study_plant(&t, model);
		walk.found[model->generated]++;
		last = *model;
	}
	if (t.plants) {
		bench_billboards_field(bench, &last);
		plot(&t);
	}
	bench_table_close(t.caps);
	bench_table_close(t.q);
	bench_table_close(t.turn);
	for (int m = 0; m < TURNS && t.plants; m++) {
		char key[64];
		snprintf(key, sizeof key, "billboards_turn_sd_%s", m ? turn_names[m] : "billboards");
		bench_key(bench, key, t.turned[m] ? t.sd[m] / t.turned[m] : NAN,
			"standard deviation of Q over a turn, mean over plants");
	}
	bench_say(bench, "%u views of %u pixels. A billboard has six vertices. A cloud of another cap has "
		"other textures: clouds are alternatives and none continues another. Ours is what a pack shows "
		"with as many vertices, wood included. Over a turn leaves are pruned over whole wood.", VIEWS, BENCH_PIXELS);
}

const struct bench_section bench_billboards = { "billboards", "Billboard clouds beside ours", run };
