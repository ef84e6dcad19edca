/* Billboard clouds (Kratt et al. 2014) against splats, points and impostors at equal vertices, for the plants
 * with leaves of the section `splats` and in its pictures; and over a turn against pruned leaves of the same
 * mean Q (Neubert 2011, figure 11).
 *
 * The paper prints Precision and Recall of levels of a few trees as a diagram without a scale of vertices
 * (figure 3), levels of one tree, and a large scene without figures (figure 4). */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "ecofiles/base/angle16.h"
#include "lod/build/order/rank.h"
#include "tests/bench/baseline/billboard_cloud.h"
#include "tests/bench/bench_leaves.h"
#include "tests/bench/pictures/bench_billboards.h"
#include "tests/bench/pictures/bench_splats.h"

#define PLANTS_MOST 8u
#define PLANTS_QUICK 1u
#define VIEW 7u                          /* of pictures, as for splats */
#define PANELS 5u                        /* the whole plant, three caps, Precision and Recall */
#define PIXELS 256u
#define TURN_VIEWS 36u
#define TURN_UP 0.1                      /* the eye's height over the plant's middle, as a slope */
#define TUNING 6u                        /* of the turn's views: scales are chosen in these */
#define STEPS 10                         /* of the search for a number of leaves */
#define SCALES 7
#define BUDGETS BENCH_SPLATS_BUDGETS

/* ALL: as the method is. CROSSES: the only generator. VALID: faces that no billboard holds are not drawn. */
enum kind { ALL, CROSSES, VALID, KINDS };
static const char *const kind_names[KINDS] = { "billboards", "crosses only", "valid faces only" };
/* The first caps have as many vertices, at 6 each, as bench_splats_budgets; other kinds have no others. Then
 * that of Neubert's figure 11. */
#define CAPS 6u
#define TURNED 4u
static const uint32_t caps[CAPS] = { 2, 8, 33, 166, 209, 333 };
static const size_t field_cap[BENCH_FIELD_LEVELS] = { 5, 3, 2, 1 };
/* A turn: billboards against three orders of leaves that are pruned to the same mean Q, each at its best
 * scale. */
enum turn { BILLBOARDS, STOCHASTIC, COMBINED, GREEDY, TURNS };
static const char *const turn_names[TURNS] = { "209 billboards", "stochastic", "combined", "greedy" };
/* Figures of one cloud. */
enum figure { COUNT, PARTS, FORM_CROSS, FORM_PLANE, FORM_STRIP, ERROR, INVALID, EPSILON, TEXELS, BYTES,
	SECONDS, PRECISION, RECALL, HARD, SOFT };

struct study {
	struct bench *bench;
	const char *name;
	struct bench_leaves *leaves;
	struct bench_splats_pictures pictures;
	struct lod_billboard_plant *plant;
	struct lod_sights turn;
	uint32_t *order;
	json_t *clouds,
		*turns;              /* [of each kind [of each cap [figures]]]; [of each method [...]] */
};

/* ---- Clouds by cap ---- */

static void draw_cloud(const void *cloud, struct lod_raster *raster)
{
	lod_billboard_cloud_draw(cloud, 1, raster);
}

void bench_billboards_color(const struct eco_image *image, uint8_t rgb[3])
{
	double sum[3] = { 0 }, n = 1e-9;
	for (size_t i = 0; i < (size_t)image->width * image->height; i++)
		for (int k = 0; k < 3 && image->rgba[4 * i + 3]; k++) {
			sum[k] += image->rgba[4 * i + (size_t)k];
			n += k == 0;
		}
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)fmin(sum[k] / n, 254);
}

/* By view: light grey where both are, grey where the cloud is missing, black where only that is (figure 3).
 * Both panels are painted; the second is overwritten. */
static void compare_panels(const uint8_t *whole, uint8_t *panel, uint32_t side, uint32_t stride)
{
	for (size_t i = 0; i < (size_t)side * side; i++) {
		size_t at = 3 * (i / side * stride + i % side);
		bool wanted = whole[at] < 255, shown = panel[at] < 255;
		if (wanted || shown)
			memset(panel + at, !wanted ? 0 : shown ? 210 : 130, 3);
	}
}

static enum eco_code paint(struct study *s, const struct lod_billboard_cloud *cloud, uint8_t *picture,
	uint32_t panel, struct eco_error *error)
{
	uint32_t side = s->pictures.sizes[BENCH_SPLATS_SIZES - 1].side;
	uint8_t (*rgb)[3] = malloc((cloud->count + 1) * sizeof *rgb), *to = picture + 3 * (size_t)panel
		* side;
	if (!rgb)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for colours");
	for (uint32_t i = 0; i < cloud->count; i++)
		bench_billboards_color(&cloud->items[i].image, rgb[i]);
	bench_splats_paint(&s->pictures, VIEW, draw_cloud, cloud, (const uint8_t (*)[3])rgb, to, PANELS
		* side);
	if (panel + 2 == PANELS) {
		to += 3 * (size_t)side;
		bench_splats_paint(&s->pictures, VIEW, draw_cloud, cloud, NULL, to, PANELS * side);
		compare_panels(picture, to, side, PANELS * side);
	}
	free(rgb);
	return ECO_OK;
}

/* VALID: the same clouds as ALL, without a search for epsilon. */
static enum eco_code measure_cap(struct study *s, enum kind kind, uint32_t cap, uint8_t *picture,
	struct eco_error *error)
{
	struct lod_billboard_cloud cloud;
	struct bench_splats_q q;
	const struct lod_billboard_options options = { .cap = caps[cap], .epsilon = kind == VALID
		? bench_cell(json_array_get(json_array_get(s->clouds, ALL), cap), EPSILON) : 0,
		.forms = kind == CROSSES ? 1u << LOD_BILLBOARD_CROSS : 0, .valid_only = kind == VALID };
	clock_t begun = clock();
	enum eco_code code = lod_billboard_cloud_make(&cloud, s->plant, &options, error);
	if (code)
		return code;
	double seconds = (double)(clock() - begun) / CLOCKS_PER_SEC;
	bench_splats_score(&s->pictures, BENCH_SPLATS_SIZES, draw_cloud, &cloud, &q);
	json_array_append_new(json_array_get(s->clouds, kind), json_pack("[iiiiifffIIfffff]",
		(int)cloud.count,
		(int)cloud.parts, (int)cloud.forms[0], (int)cloud.forms[1], (int)cloud.forms[2], cloud.error,
		cloud.invalid, cloud.epsilon, (json_int_t)cloud.texels, (json_int_t)cloud.texture_bytes,
			seconds,
		q.precision, q.recall, q.hard, q.soft));
	if (kind == ALL && cap >= 1 && cap <= 3)
		code = paint(s, &cloud, picture, cap, error);
	lod_billboard_cloud_free(&cloud);
	return code ? code : bench_go_on(s->bench, error);
}

static enum eco_code study_caps(struct study *s, struct eco_error *error)
{
	char file[128];
	uint32_t side = s->pictures.sizes[BENCH_SPLATS_SIZES - 1].side;
	uint8_t *picture = calloc((size_t)PANELS * side * side, 3);
	enum eco_code code = picture ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	if (!code)
		bench_splats_paint(&s->pictures, VIEW, NULL, NULL, NULL, picture, PANELS * side);
	for (enum kind kind = 0; kind < KINDS && !code; kind++) {
		json_array_append_new(s->clouds, json_array());
		for (uint32_t cap = 0; cap < (kind == ALL ? CAPS : BUDGETS) && !code; cap++)
			code = measure_cap(s, kind, cap, picture, error);
	}
	snprintf(file, sizeof file, "billboards-%s.png", s->name);
	code = code ? code : bench_picture_write(s->bench, file, PANELS * side, side, picture, error);
	free(picture);
	return code;
}

/* ---- A turn ---- */

static double cloud_q(struct study *s, const struct lod_billboard_cloud *cloud, uint32_t view)
{
	struct bench_wrong sum = { 0 };
	bench_leaves_compare_drawn(s->leaves, &s->turn, view, false, draw_cloud, cloud, &sum);
	return bench_wrong_q(&sum);
}

static double leaves_q(struct study *s, uint32_t count, float scale, uint32_t view)
{
	struct bench_wrong sum = { 0 };
	const struct lod_sights_drawing drawing = { .order = s->order, .count = count, .scale = scale };
	bench_leaves_compare(s->leaves, &s->turn, view, &drawing, &sum);
	return bench_wrong_q(&sum);
}

/* Q of each view of so many leaves at their best scale; returns the mean. */
static double prune(struct study *s, uint32_t count, double q[TURN_VIEWS])
{
	double best = -INFINITY, mean = 0;
	float best_scale = 1;
	for (int i = 0; i < SCALES; i++) {
		float scale = (float)pow((double)s->leaves->foliage.count / count, (double)i / (SCALES - 1));
		double now = 0;
		for (uint32_t v = 0; v < TUNING; v++)
			now += leaves_q(s, count, scale, v * TURN_VIEWS / TUNING);
		best_scale = now > best ? scale : best_scale;
		best = fmax(best, now);
	}
	for (uint32_t v = 0; v < TURN_VIEWS; v++)
		mean += (q[v] = leaves_q(s, count, best_scale, v)) / TURN_VIEWS;
	return mean;
}

/* vertices, vertices of wood besides, Q of each view; null: the mean is not reached */
static void keep_turn(struct study *s, double vertices, double wood, const double q[TURN_VIEWS], bool reached)
{
	double row[2 + TURN_VIEWS] = { vertices, wood };
	for (uint32_t v = 0; v < TURN_VIEWS; v++)
		row[2 + v] = reached ? q[v] : NAN;
	json_array_append_new(s->turns, bench_reals(row, 2 + TURN_VIEWS));
}

/* Prunes to a mean Q as near as can be, which is not reached if wood alone is better. */
static void prune_to(struct study *s, double wanted)
{
	const struct lod_foliage *f = &s->leaves->foliage;
	uint32_t low = 1, high = f->count;
	double q[TURN_VIEWS], vertices = 0;
	for (int i = 0; i < STEPS && low < high && !bench_stopped(s->bench); i++) {
		/* counts are searched by their ratios */
		uint32_t middle = (uint32_t)sqrt((double)low * high);
		if (prune(s, middle, q) < wanted)
			low = middle + 1;
		else
			high = middle;
	}
	double mean = prune(s, high, q);
	for (uint32_t i = 0; i < high; i++)
		vertices += 3 * (f->first[s->order[i] + 1] - f->first[s->order[i]] - 2);
	keep_turn(s, vertices, 3.0 * (double)f->wood_count, q, fabs(mean - wanted) <= 0.02);
}

static bool rank_goes_on(void *ctx, double share)
{
	(void)share;
	return !bench_stopped(ctx);
}

static enum eco_code make_order(struct study *s, enum turn method, struct eco_error *error)
{
	struct lod_rank rank;
	if (method != GREEDY) {
		s->order = bench_leaves_order(s->leaves, method == COMBINED ? LOD_ORDER_COMBINED
			: LOD_ORDER_STOCHASTIC, 0);
		return ECO_OK;
	}
	enum eco_code code = lod_rank_make(&rank, &s->leaves->foliage, &(struct lod_rank_options){ .seed = 1,
		.leaves = true, .progress = rank_goes_on, .ctx = s->bench }, &s->leaves->arena, error);
	s->order = rank.order;
	return code;
}

static enum eco_code study_turn(struct study *s, struct eco_error *error)
{
	double to[TURN_VIEWS][3], q[TURN_VIEWS], mean = 0;
	struct lod_billboard_cloud cloud = { 0 };
	for (uint32_t v = 0; v < TURN_VIEWS; v++) {
		double sine, cosine, flat = 1 / sqrt(1 + TURN_UP * TURN_UP);
		eco_angle16_sincos(eco_angle16_from_deg(360.0 * v / TURN_VIEWS), &sine, &cosine);
		to[v][0] = flat * cosine, to[v][1] = flat * sine, to[v][2] = flat * TURN_UP;
	}
	enum eco_code code = lod_sights_make(&s->turn, &s->leaves->foliage, (const double (*)[3])to,
		TURN_VIEWS, PIXELS, &s->leaves->arena, error);
	code = code ? code : lod_billboard_cloud_make(&cloud, s->plant, &(struct lod_billboard_options){
		.cap = caps[TURNED] }, error);
	for (uint32_t v = 0; v < TURN_VIEWS && !code; v++)
		mean += (q[v] = cloud_q(s, &cloud, v)) / TURN_VIEWS;
	if (!code)
		keep_turn(s, 6.0 * cloud.count, 0, q, true);
	lod_billboard_cloud_free(&cloud);
	for (enum turn m = STOCHASTIC; m < TURNS && !code; m++) {
		code = make_order(s, m, error);
		if (!code)
			prune_to(s, mean);
	}
	return code ? code : bench_go_on(s->bench, error);
}

/* ---- One plant ---- */

/* The unit: [clouds, turns]. */
static enum eco_code study_leaves(void *ctx, struct bench_leaves *leaves, json_t **out,
	struct eco_error *error)
{
	struct study *s = ctx;
	s->leaves = leaves;
	enum eco_code code = bench_splats_open(&s->pictures, &leaves->model, bench_splats_heights_px, error);
	if (code)
		return code;
	*out = json_pack("[oo]", s->clouds = json_array(), s->turns = json_array());
	code = lod_billboard_plant_open(&s->plant, &leaves->model, error);
	code = code ? code : study_caps(s, error);
	code = code ? code : study_turn(s, error);
	lod_billboard_plant_close(s->plant);
	bench_splats_close(&s->pictures);
	return code;
}

static enum eco_code measure(struct bench *bench, const struct bench_model *model, json_t **out,
	struct eco_error *error)
{
	char name[96], stamp[32];
	struct study *s = calloc(1, sizeof *s);
	if (!s)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a study of billboards");
	*s = (struct study){ .bench = bench, .name = model->name };
	snprintf(name, sizeof name, "billboards-%s", model->name);
	snprintf(stamp, sizeof stamp, "%016llx", (unsigned long long)bench_file_hash(model->path));
	enum eco_code code = bench_leaves_unit(bench, &(struct bench_leaves_unit){ name, stamp, model, NULL,
		PIXELS, study_leaves, s }, out, error);
	free(s);
	return code;
}

/* ---- Tables ---- */

/* Rows of the comparison: kinds of billboards, what stands beside them, and the best of ours. */
#define OURS ((int)KINDS)
#define BEST (OURS + (int)BENCH_SPLATS_KINDS)
#define ROWS (BEST + 1)

struct section {
	struct bench *bench;
	struct bench_table *caps, *q, *turn;
	uint32_t plants, turned[TURNS];
	double sum[ROWS][2 * BUDGETS];       /* hard Q by budget, then soft */
	double sd[TURNS], cap_error[CAPS], precision[PLANTS_MOST][CAPS], recall[PLANTS_MOST][CAPS];
	char name[PLANTS_MOST][64];
};

static const char *row_name(int row)
{
	return row == BEST ? "best of ours" : row < OURS ? kind_names[row] : bench_splats_kind_names[row
		- OURS];
}

static void write_row(struct section *t, const char *plant, int row, const double q[2 * BUDGETS])
{
	bench_table_row(t->q, "%s,%s,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f", plant, row_name(row), q[0],
		q[1], q[2], q[3], q[4], q[5], q[6], q[7]);
}

static void write_caps(struct section *t, const char *plant, const json_t *clouds)
{
	for (size_t i = 0; i < KINDS * CAPS; i++) {
		size_t cap = i % CAPS;
		const json_t *p = json_array_get(json_array_get(clouds, i / CAPS), cap);
		if (!p)
			continue;
		bench_table_row(t->caps,
			"%s,%s,%u,%.0f,%.0f,%.0f,%.0f,%.0f,%.3f,%.3f,%.4f,%.0f,%.0f,%.1f,%.3f,%.3f,"
			"%.3f,%.3f", plant, kind_names[i / CAPS], caps[cap], bench_cell(p, COUNT),
				bench_cell(p, PARTS),
			bench_cell(p, FORM_CROSS), bench_cell(p, FORM_PLANE), bench_cell(p, FORM_STRIP),
				bench_cell(p, ERROR),
			bench_cell(p, INVALID), bench_cell(p, EPSILON), bench_cell(p, TEXELS) / 1000,
				bench_cell(p, BYTES)
				/ 1000,
			bench_cell(p, SECONDS), bench_cell(p, PRECISION), bench_cell(p, RECALL), bench_cell(p,
				HARD),
			bench_cell(p, SOFT));
		if (i >= CAPS)
			continue;
		t->cap_error[cap] += bench_cell(p, ERROR);
		t->precision[t->plants][cap] = bench_cell(p, PRECISION);
		t->recall[t->plants][cap] = bench_cell(p, RECALL);
	}
}

static void write_beside(struct section *t, const char *plant, const json_t *clouds,
	struct bench_splats_q ours[BENCH_SPLATS_KINDS][BUDGETS])
{
	double rows[ROWS][2 * BUDGETS] = { { 0 } };
	for (int row = 0; row < ROWS; row++) {
		for (uint32_t b = 0; b < BUDGETS && row < BEST; b++) {
			const json_t *p = json_array_get(json_array_get(clouds, (size_t)row), b);
			rows[row][b] = row < OURS ? bench_cell(p, HARD) : ours[row - OURS][b].hard;
			rows[row][BUDGETS + b] = row < OURS ? bench_cell(p, SOFT) : ours[row - OURS][b].soft;
		}
		for (uint32_t b = 0; b < 2 * BUDGETS; b++) {
			if (row >= OURS && row < BEST)
				rows[BEST][b] = fmax(rows[BEST][b], rows[row][b]);
			t->sum[row][b] += rows[row][b];
		}
		write_row(t, plant, row, rows[row]);
	}
}

static enum eco_code write_turn(struct section *t, const char *plant, const json_t *turns,
	struct eco_error *error)
{
	char name[100], title[160];
	double degrees[TURN_VIEWS], q[TURNS][TURN_VIEWS];
	struct bench_series series[TURNS];
	for (int m = 0; m < TURNS; m++) {
		const json_t *row = json_array_get(turns, (size_t)m);
		double mean = 0, square = 0, least = INFINITY, most = -INFINITY;
		for (uint32_t v = 0; v < TURN_VIEWS; v++) {
			degrees[v] = 360.0 * v / TURN_VIEWS;
			q[m][v] = bench_cell(row, 2 + v);
			mean += q[m][v] / TURN_VIEWS;
			least = fmin(least, q[m][v]);
			most = fmax(most, q[m][v]);
		}
		for (uint32_t v = 0; v < TURN_VIEWS; v++)
			square += (q[m][v] - mean) * (q[m][v] - mean) / TURN_VIEWS;
		bench_table_row(t->turn, "%s,%s,%.0f,%.0f,%.3f,%.3f,%.3f,%.2e,%.4f", plant, turn_names[m],
			bench_cell(row, 0), bench_cell(row, 1), mean, least, most, square, sqrt(square));
		t->sd[m] += isfinite(square) ? sqrt(square) : 0;
		t->turned[m] += isfinite(square);
		series[m] = (struct bench_series){ turn_names[m], degrees, q[m], TURN_VIEWS, false };
	}
	snprintf(name, sizeof name, "billboards_turn_%s", plant);
	snprintf(title, sizeof title, "%s: Q over a turn, equal in the mean", plant);
	return bench_plot(t->bench, &(struct bench_plot){ .name = name, .title = title, .x = "degrees",
		.y = "Q", .series = series, .series_count = TURNS }, error);
}

static enum eco_code study_plant(struct section *t, const struct bench_model *model, struct eco_error *error)
{
	json_t *unit;
	struct bench_splats_q ours[BENCH_SPLATS_KINDS][BUDGETS];
	char file[100];
	enum eco_code code = measure(t->bench, model, &unit, error);
	code = code ? code : bench_splats_of(t->bench, model, ours, error);
	if (code)
		return code;
	write_caps(t, model->name, json_array_get(unit, 0));
	write_beside(t, model->name, json_array_get(unit, 0), ours);
	snprintf(t->name[t->plants++], sizeof t->name[0], "%s", model->name);
	snprintf(file, sizeof file, "billboards-%s.png", model->name);
	bench_picture(t->bench, file, "full detail; at most 8, 33, 166 billboards, each in its mean colour; "
		"of the last Precision and Recall: light grey true, grey missing, black too many");
	return write_turn(t, model->name, json_array_get(unit, 1), error);
}

/* Figure 4, right: many times the plant of most leaves. */
static enum eco_code study_field(struct bench *bench, const struct bench_model *model,
	struct eco_error *error)
{
	char file[128];
	double epsilon[BENCH_FIELD_LEVELS], q[10];
	json_t *known, *field;
	snprintf(file, sizeof file, "billboards_field-%s.png", model->name);
	enum eco_code code = measure(bench, model, &known, error);
	for (size_t i = 0; i < BENCH_FIELD_LEVELS && !code; i++)
		epsilon[i] = bench_cell(json_array_get(json_array_get(json_array_get(known, 0), ALL),
			field_cap[i]), EPSILON);
	code = code ? code : bench_billboards_field(bench, model, file, epsilon, &field, error);
	if (code)
		return code;
	bench_cells(field, q, 10);
	struct bench_table *table = bench_table_open(bench, "billboards_field", "plant,plants in view,"
		"of 333 billboards,of 166,of 33,of 8,vertices,vertices of full detail,Q,Precision,Recall,"
		"owner_q", true);
	bench_table_row(table, "%s,%.0f,%.0f,%.0f,%.0f,%.0f,%.0f,%.0f,%.3f,%.3f,%.3f,%.3f", model->name,
		q[0] + q[1] + q[2] + q[3], q[0], q[1], q[2], q[3], q[4], q[5], q[6], q[7], q[8], q[9]);
	bench_table_close(table);
	bench_picture(bench, file, "a field: full detail; clouds in their billboards' mean colours; "
		"their levels: at most 333 billboards (red), 166 (orange), 33 (green), 8 (blue)");
	return ECO_OK;
}

static enum eco_code plot_means(struct section *t, struct eco_error *error)
{
	double x[BUDGETS], cap[CAPS];
	struct bench_series series[ROWS];
	for (uint32_t b = 0; b < BUDGETS; b++)
		x[b] = bench_splats_budgets[b];
	for (uint32_t i = 0; i < CAPS; i++)
		cap[i] = caps[i];
	for (int row = 0; row < ROWS; row++)
		series[row] = (struct bench_series){ row_name(row), x, t->sum[row], BUDGETS, false };
	enum eco_code code = bench_plot(t->bench, &(struct bench_plot){ .name = "billboards",
		.title = "Hard Q at equal vertices, mean over plants", .x = "vertices", .y = "Q",
		.log_x = true, .series = series, .series_count = ROWS }, error);
	series[0] = (struct bench_series){ "error of the mean part", cap, t->cap_error, CAPS, false };
	code = code ? code : bench_plot(t->bench, &(struct bench_plot){ .name = "billboards_error",
		.title = "The method's own error against the cap", .x = "billboards at most",
		.y = "error", .log_x = true, .series = series, .series_count = 1 }, error);
	for (uint32_t i = 0; i < t->plants; i++)
		series[i] = (struct bench_series){ t->name[i], t->recall[i], t->precision[i], CAPS, true };
	return code ? code : bench_plot(t->bench, &(struct bench_plot){ .name = "billboards_pr",
		.title = "Precision and Recall of clouds of 2 to 333 billboards", .x = "Recall",
		.y = "Precision", .series = series, .series_count = t->plants }, error);
}

static void write_means(struct section *t)
{
	for (int row = 0; row < ROWS; row++) {
		for (uint32_t b = 0; b < 2 * BUDGETS; b++)
			t->sum[row][b] /= t->plants;
		write_row(t, "mean", row, t->sum[row]);
	}
	for (uint32_t cap = 0; cap < CAPS; cap++)
		t->cap_error[cap] /= t->plants;
	bench_key(t->bench, "billboards_hard_200", t->sum[ALL][2], "Q of at most 200 vertices");
	bench_key(t->bench, "billboards_hard_1000", t->sum[ALL][3], "of at most 1000");
	bench_key(t->bench, "billboards_best_of_ours_hard_200", t->sum[BEST][2], "beside it");
	bench_key(t->bench, "billboards_best_of_ours_hard_1000", t->sum[BEST][3], "beside it");
	for (int m = 0; m < TURNS; m++) {
		char key[64];
		snprintf(key, sizeof key, "billboards_turn_sd_%s", m ? turn_names[m] : "billboards");
		bench_key(t->bench, key, t->turned[m] ? t->sd[m] / t->turned[m] : NAN,
			"standard deviation of Q over a turn, mean over plants");
	}
}

static enum eco_code study_all(struct section *t, struct eco_error *error)
{
	struct bench *bench = t->bench;
	struct bench_model *models = NULL;
	uint32_t count = 0, last = 0;
	enum eco_code code = bench_models(bench, &models, &count, error);
	for (uint32_t i = 0; i < count && !code && t->plants < PLANTS_MOST; i++) {
		/* without the data folder generated plants stand for those with leaves */
		if (bench->data ? !bench_splats_is_foliage(&models[i]) : t->plants == 2)
			continue;
		if (!bench->full && t->plants == PLANTS_QUICK) {
			bench_left_out(bench, models[i].name);
			continue;
		}
		bench_progress(bench, (double)i / count, models[i].name);
		code = study_plant(t, &models[i], error);
		last = i;
		code = code ? code : bench_go_on(bench, error);
	}
	if (!code && t->plants)
		code = study_field(bench, &models[last], error);
	free(models);
	return code;
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct section t = { .bench = bench };
	t.caps = bench_table_open(bench, "billboards_caps",
		"plant,kind,cap,billboards,parts,crosses,planes,strips,"
		"error,invalid,epsilon,thousand texels,PNG kB,CPU s,Precision,Recall,hard,soft", true);
	t.q = bench_table_open(bench, "billboards",
		"plant,kind,hard 12,hard 48,hard 200,hard 1000,soft 12,soft 48,"
		"soft 200,soft 1000", true);
	t.turn = bench_table_open(bench, "billboards_turn",
		"plant,method,vertices,of wood besides,mean Q,least,"
		"most,variance,standard deviation", true);
	enum eco_code code = study_all(&t, error);
	if (!code && t.plants)
		write_means(&t);
	bench_table_close(t.caps);
	bench_table_close(t.q);
	bench_table_close(t.turn);
	if (!code && t.plants)
		code = plot_means(&t, error);
	if (!code)
		bench_say(bench, "A billboard has six vertices, a splat or a point one. Vertices do not "
			"count textures: a cloud of another cap has other ones, so that clouds are "
			"alternatives and none continues another. Over a turn leaves are pruned over whole "
			"wood.");
	return code;
}

const struct bench_section bench_billboards = { "billboards", "Billboard clouds against splats and impostors",
	run, .objects = BENCH_OBJECTS_PLANTS "tests/bench/pictures/bench_billboards*.o "
	"tests/bench/pictures/bench_splats*.o", .alone = true };
