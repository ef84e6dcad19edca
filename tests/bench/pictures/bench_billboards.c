/* Billboard clouds (Kratt et al. 2014): Precision and Recall by the number of billboards (figure 3) and
 * pictures of three clouds and of a field (figure 4); beside them splats and impostors at equal vertices; and
 * a turn against pruned leaves of the same mean Q (Neubert 2011, figure 11). The paper prints a diagram
 * without a scale of vertices, and no figures. */
#include <math.h>
#include <string.h>

#include "ecofiles/base/angle16.h"
#include "lod/build/model_draw.h"
#include "lod/build/order/rank.h"
#include "tests/bench/baseline/billboard_cloud.h"
#include "tests/bench/bench_leaves.h"
#include "tests/bench/pictures/bench_billboards.h"

#define PLANTS_MOST 8u
#define VIEW 7u                          /* of the picture */
#define PANELS 5u                        /* the whole plant, three caps, Precision and Recall */
#define VIEWS 24u                        /* of elevation -10 to 60 degrees, as good as orthographic */
#define SIZES 2u
#define AWAY 512.0                       /* of the camera, radii */
#define FRAME 1.02
#define FINE 4u                         /* samples a pixel: FINE x FINE, for shares of pixels */
#define PIXELS 256u
#define TURN_VIEWS 36u
#define TURN_UP 0.1                      /* the eye's height over the plant's middle, as a slope */
#define TUNING 6u                        /* of the turn's views: scales are chosen in these */
#define STEPS 10                         /* of the search for a number of leaves */
#define SCALES 7

static const double heights_px[SIZES] = { 64, 256 };
/* The first caps have as many vertices, at 6 each, as the budgets of ours. Figure 11 of Neubert has 209. */
#define BUDGETS 4u
static const uint32_t budgets[BUDGETS] = { 12, 48, 200, 1000 };
#define CAPS 6u
#define TURNED 4u
static const uint32_t caps[CAPS] = { 2, 8, 33, 166, 209, 333 };
/* A turn: billboards against three orders of leaves that are pruned to the same mean Q, each at its best
 * scale. */
enum turn { BILLBOARDS, STOCHASTIC, COMBINED, GREEDY, TURNS };
static const char *const turn_names[TURNS] = { "209 billboards", "stochastic", "combined", "greedy" };
enum figure { COUNT, PARTS, FORM_CROSS, FORM_PLANE, FORM_STRIP, ERROR, INVALID, EPSILON, TEXELS,
	PRECISION, RECALL, QUALITY, SOFT, FIGURES };
static const struct bench_column columns[FIGURES] = { { "billboards", 0 }, { "parts", 0 }, { "crosses", 0 },
	{ "planes", 0 }, { "strips", 0 }, { "error", 3 }, { "invalid", 3 }, { "epsilon", 4 },
	{ "thousand texels", 0 }, { "Precision", 3 }, { "Recall", 3 }, { "hard", 3 }, { "soft", 3 } };

/* Pictures of side x side pixels, and the whole plant's. */
struct size { uint32_t side; struct lod_raster raster, fine; uint8_t *whole[VIEWS], *soft[VIEWS], *count; };

/* The unit of a plant. */
struct figures {
	double clouds[CAPS][FIGURES];
	/* of a turn: vertices, vertices of wood besides, Q of each view; NaN: the mean is not reached */
	double turns[TURNS][2 + TURN_VIEWS];
	double ours[BENCH_OURS_KINDS][2 * BUDGETS];  /* Q by budget: hard, then soft */
};
#define NUMBERS (sizeof(struct figures) / sizeof(double))

struct study {
	struct bench *bench;
	const char *name;
	struct bench_leaves *leaves;
	double center[3], radius;
	struct lod_eye eyes[VIEWS];
	struct size sizes[SIZES];
	struct lod_billboard_plant *plant;
	struct lod_sights turn;
	struct figures made;
};

/* ---- Pictures ---- */

static void place_eyes(struct study *s)
{
	for (uint32_t i = 0; i < VIEWS; i++) {
		double sine, cosine, up, flat;
		eco_angle16_sincos(eco_angle16_from_deg(i * 137.5 + 31), &sine, &cosine);
		eco_angle16_sincos(eco_angle16_from_deg(-10 + 70 * (i + 0.5) / VIEWS), &up, &flat);
		const double from[3] = { flat * cosine, flat * sine, up };
		s->eyes[i] = (struct lod_eye){ .right = { -sine, cosine, 0 }, .up = { -up * cosine,
			-up * sine, flat }, .tan_x = FRAME / AWAY, .tan_y = FRAME / AWAY };
		for (int k = 0; k < 3; k++) {
			s->eyes[i].at[k] = s->center[k] + AWAY * s->radius * from[k];
			s->eyes[i].forward[k] = -from[k];
		}
	}
}

static void draw_cloud(const void *cloud, struct lod_raster *raster)
{
	lod_billboard_cloud_draw(cloud, 1, raster);
}

static void draw_whole(const void *model, struct lod_raster *raster) { lod_model_draw(model, NULL, raster); }

static void shoot(struct study *s, uint32_t view, bench_draw_call *draw, const void *what,
	struct lod_raster *raster)
{
	struct lod_eye eye = s->eyes[view];
	eye.pixel_rad = 2 * eye.tan_y / raster->height;
	lod_raster_clear(raster);
	lod_raster_camera(raster, &eye, (AWAY - 2) * s->radius);
	lod_raster_object(raster, &(struct lod_place){ .cosine = 1, .scale = 1 });
	draw(what, raster);
}

/* Covered samples of each pixel. */
static void shoot_fine(struct study *s, uint32_t view, bench_draw_call *draw, const void *what,
	struct size *size, uint8_t *count)
{
	uint32_t width = FINE * size->side;
	shoot(s, view, draw, what, &size->fine);
	memset(count, 0, (size_t)size->side * size->side);
	const uint8_t *cover = size->fine.cover;
	for (uint32_t y = 0; y < width; y++)
		for (uint32_t x = 0; x < width; x++)
			count[y / FINE * size->side + x / FINE] += *cover++ & 1;
}

static void open_pictures(struct study *s)
{
	float low[3] = { 0 }, high[3] = { 0 };
	lod_model_bounds(&s->leaves->model, low, high);
	s->radius = lod_model_sphere(&s->leaves->model, s->center);
	double height = (double)high[2] - (double)low[2];
	if (!(height > 0.05 * s->radius))
		must(eco_fail(must_error, ECO_UNSUPPORTED, "a plant without height"));
	place_eyes(s);
	for (uint32_t i = 0; i < SIZES; i++) {
		struct size *size = &s->sizes[i];
		uint32_t side = size->side = (uint32_t)ceil(2 * FRAME * s->radius * heights_px[i] / height);
		lod_raster_init(&size->raster, &(struct lod_raster_options){ .width = side, .height
			= side, .item = true });
		lod_raster_init(&size->fine, &(struct lod_raster_options){ .width = FINE * side,
			.height = FINE * side, .silhouette = true });
		size->count = lod_arena_take(&s->leaves->arena, side, side);
		for (uint32_t view = 0; view < VIEWS; view++) {
			size->whole[view] = lod_arena_take(&s->leaves->arena, side, side);
			size->soft[view] = lod_arena_take(&s->leaves->arena, side, side);
			shoot(s, view, draw_whole, &s->leaves->model, &size->raster);
			memcpy(size->whole[view], size->raster.cover, (size_t)side * side);
			shoot_fine(s, view, draw_whole, &s->leaves->model, size, size->soft[view]);
		}
	}
}

/* Means over views and sizes. */
static void score(struct study *s, bench_draw_call *draw, const void *what, double figure[FIGURES])
{
	figure[PRECISION] = figure[RECALL] = figure[QUALITY] = figure[SOFT] = 0;
	for (uint32_t i = 0; i < SIZES * VIEWS; i++) {
		struct size *size = &s->sizes[i / VIEWS];
		struct lod_score one;
		shoot(s, i % VIEWS, draw, what, &size->raster);
		lod_score(&one, &(struct lod_score_input){ .width = size->side, .height = size->side,
			.cover = size->raster.cover, .reference = size->whole[i % VIEWS] });
		figure[PRECISION] += one.precision / (SIZES * VIEWS);
		figure[RECALL] += one.recall / (SIZES * VIEWS);
		figure[QUALITY] += one.q / (SIZES * VIEWS);
		shoot_fine(s, i % VIEWS, draw, what, size, size->count);
		figure[SOFT] += lod_soft_q(size->count, size->soft[i % VIEWS],
			(size_t)size->side * size->side)
			/ (SIZES * VIEWS);
	}
}

static void score_ours(void *ctx, enum bench_ours_kind kind, uint32_t budget, bench_draw_call *draw,
	const void *what)
{
	struct study *s = ctx;
	double figure[FIGURES], *hard = s->made.ours[kind], *soft = hard + BUDGETS;
	score(s, draw, what, figure);
	for (uint32_t b = budget; b < (kind == BENCH_OURS_IMPOSTOR ? BUDGETS : budget + 1); b++) {
		hard[b] = fmax(hard[b], figure[QUALITY]);
		soft[b] = fmax(soft[b], figure[SOFT]);
	}
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

/* One view, white where nothing is: the plant in dark grey, or billboards in their mean colours. The panel
 * after the last cloud compares (figure 3): light grey where both are, grey where the cloud is missing, black
 * where only that is. */
static void paint(struct study *s, const struct lod_billboard_cloud *cloud, uint8_t *picture, uint32_t panel)
{
	struct size *size = &s->sizes[SIZES - 1];
	uint8_t (*rgb)[3] = lod_arena_take(&s->leaves->arena, cloud ? cloud->count + 1 : 1, sizeof *rgb);
	memset(rgb, 60, sizeof *rgb);
	for (uint32_t i = 0; cloud && i < cloud->count; i++)
		bench_billboards_color(&cloud->items[i].image, rgb[i]);
	shoot(s, VIEW, cloud ? draw_cloud : draw_whole, cloud ? (const void *)cloud : &s->leaves->model,
		&size->raster);
	for (size_t i = 0; i < (size_t)size->side * size->side; i++) {
		uint8_t *at = picture + 3 * ((i / size->side * PANELS + panel) * size->side + i % size->side);
		bool shown = size->raster.cover[i], wanted = size->whole[VIEW][i];
		memset(at, 255, 3);
		if (shown)
			memcpy(at, rgb[cloud ? size->raster.item[i] : 0], 3);
		if (panel + 2 == PANELS)
			memset(at + 3 * (size_t)size->side,
				!wanted && !shown ? 255 : !wanted ? 0 : shown ? 210 : 130, 3);
	}
}

/* ---- Clouds by cap ---- */

static void study_caps(struct study *s)
{
	char file[128];
	uint32_t side = s->sizes[SIZES - 1].side;
	uint8_t *picture = lod_arena_take(&s->leaves->arena, (size_t)PANELS * side * side, 3);
	paint(s, NULL, picture, 0);
	for (uint32_t cap = 0; cap < CAPS; cap++) {
		struct lod_billboard_cloud cloud;
		struct lod_arena_piece *mark = s->leaves->arena.last;
		lod_billboard_cloud_make(&cloud, s->plant, caps[cap], &s->leaves->arena);
		const double figure[PRECISION] = { cloud.count, cloud.parts, cloud.forms[0], cloud.forms[1],
			cloud.forms[2], cloud.error, cloud.invalid, cloud.epsilon,
			(double)cloud.texels / 1000 };
		memcpy(s->made.clouds[cap], figure, sizeof figure);
		score(s, draw_cloud, &cloud, s->made.clouds[cap]);
		if (cap >= 1 && cap <= 3)
			paint(s, &cloud, picture, cap);
		lod_arena_release(&s->leaves->arena, mark);
	}
	snprintf(file, sizeof file, "billboards-%s.png", s->name);
	bench_picture_write(s->bench, file, PANELS * side, side, picture);
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
		bench_leaves_compare_drawn(s->leaves, &s->turn, v, false, draw_cloud, &cloud, &sum);
		mean += (q[v] = bench_wrong_q(&sum)) / TURN_VIEWS;
	}
	s->made.turns[BILLBOARDS][0] = 6.0 * cloud.count;
	must(lod_rank_make(&rank, &s->leaves->foliage, &(struct lod_rank_options){ .seed = 1, .leaves = true }, &s->leaves->arena, must_error));
	prune_to(s, bench_leaves_order(s->leaves, LOD_ORDER_STOCHASTIC, 0), mean, s->made.turns[STOCHASTIC]);
	prune_to(s, bench_leaves_order(s->leaves, LOD_ORDER_COMBINED, 0), mean, s->made.turns[COMBINED]);
	prune_to(s, rank.order, mean, s->made.turns[GREEDY]);
}

/* ---- One plant ---- */

static json_t *study_leaves(void *ctx, struct bench_leaves *leaves)
{
	struct study *s = ctx;
	s->leaves = leaves;
	open_pictures(s);
	s->plant = lod_billboard_plant_make(&leaves->model, &leaves->arena);
	study_caps(s);
	study_turn(s);
	bench_ours_each(&leaves->model, budgets, BUDGETS, score_ours, s);
	for (uint32_t i = 0; i < SIZES; i++) {
		lod_raster_free(&s->sizes[i].raster);
		lod_raster_free(&s->sizes[i].fine);
	}
	return bench_reals((const double *)&s->made, NUMBERS);
}

/* ---- Tables ---- */

/* Rows of the comparison: billboards, ours, and the best of ours. */
#define BEST (1 + (int)BENCH_OURS_KINDS)
#define ROWS (BEST + 1)

struct section {
	struct bench *bench;
	struct bench_table *caps, *q, *turn;
	uint32_t plants, turned[TURNS];
	double sum[ROWS][2 * BUDGETS];       /* hard Q by budget, then soft */
	double sd[TURNS], error[CAPS], precision[PLANTS_MOST][CAPS], recall[PLANTS_MOST][CAPS];
	char name[PLANTS_MOST][64];
};

static const char *row_name(int row)
{
	return row == BEST ? "best of ours" : row ? bench_ours_names[row - 1] : "billboards";
}

static void write_row(struct section *t, const char *plant, int row, const double q[2 * BUDGETS])
{
	bench_table_row(t->q, "%s,%s,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f", plant, row_name(row), q[0],
		q[1], q[2], q[3], q[4], q[5], q[6], q[7]);
}

static void write_beside(struct section *t, const char *plant, const struct figures *f)
{
	double rows[ROWS][2 * BUDGETS] = { { 0 } };
	memcpy(rows[1], f->ours, sizeof f->ours);
	for (int row = 0; row < ROWS; row++) {
		for (size_t b = 0; b < 2 * BUDGETS; b++) {
			if (!row)
				rows[row][b] = f->clouds[b % BUDGETS][b < BUDGETS ? QUALITY : SOFT];
			else if (row < BEST)
				rows[BEST][b] = fmax(rows[BEST][b], rows[row][b]);
			t->sum[row][b] += rows[row][b];
		}
		write_row(t, plant, row, rows[row]);
	}
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
	struct study s = { .bench = t->bench, .name = model->name };
	char file[100];
	bench_cells(bench_leaves_unit(t->bench, "billboards", NULL, model, PIXELS, study_leaves, &s),
		(double *)&f, NUMBERS);
	for (size_t cap = 0; cap < CAPS; cap++) {
		bench_table_values(t->caps, f.clouds[cap], "%s,%u", model->name, caps[cap]);
		t->error[cap] += f.clouds[cap][ERROR];
		t->precision[t->plants][cap] = f.clouds[cap][PRECISION];
		t->recall[t->plants][cap] = f.clouds[cap][RECALL];
	}
	write_beside(t, model->name, &f);
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
	double x[BUDGETS], cap[CAPS];
	for (uint32_t i = 0; i < BUDGETS; i++)
		x[i] = budgets[i];
	for (uint32_t i = 0; i < CAPS; i++) {
		cap[i] = caps[i];
		t->error[i] /= t->plants;
	}
	for (int row = 0; row < ROWS; row++) {
		for (uint32_t b = 0; b < 2 * BUDGETS; b++)
			t->sum[row][b] /= t->plants;
		write_row(t, "mean", row, t->sum[row]);
		series[row] = (struct bench_series){ row_name(row), x, t->sum[row], BUDGETS, false };
	}
	bench_plot(t->bench, &(struct bench_plot){ .name = "billboards",
		.title = "Hard Q at equal vertices, mean over plants", .x = "vertices", .y = "Q",
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
	t.q = bench_table_open(bench, "billboards", "plant,kind,hard 12,hard 48,hard 200,hard 1000,soft 12,"
		"soft 48,soft 200,soft 1000", true);
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
	bench_say(bench, "A billboard has six vertices, a splat one. A cloud of another cap has other "
		"textures: clouds are alternatives and none continues another. Over a turn leaves are "
		"pruned over whole wood.");
}

const struct bench_section bench_billboards = { "billboards", "Billboard clouds against splats and impostors",
	run };
