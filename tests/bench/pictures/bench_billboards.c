/* Billboard clouds (Kratt et al. 2014): Precision and Recall by the number of billboards (figure 3) and
 * pictures of three clouds and of a field (figure 4); beside them splats and impostors at equal vertices; and a
 * turn against pruned leaves of the same mean Q (Neubert 2011, figure 11). The paper prints a diagram without
 * a scale of vertices, and no figures. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/angle16.h"
#include "lod/build/model_draw.h"
#include "lod/build/order/rank.h"
#include "tests/bench/baseline/billboard_cloud.h"
#include "tests/bench/bench_leaves.h"
#include "tests/bench/pictures/bench_billboards.h"

#define PLANTS_MOST 8u
#define PLANTS_QUICK 1u
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

struct study {
	struct bench *bench;
	const char *name;
	struct bench_leaves *leaves;
	double center[3], radius;
	struct lod_eye eyes[VIEWS];
	struct size sizes[SIZES];
	struct lod_billboard_plant *plant;
	struct lod_sights turn;
	uint32_t *order;
	double ours[BENCH_OURS_KINDS][2 * BUDGETS];  /* Q by budget: hard, then soft */
	json_t *clouds, *turns;              /* [of each cap [figures]]; [of each method [...]] */
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

static enum eco_code open_pictures(struct study *s, struct eco_error *error)
{
	float low[3] = { 0 }, high[3] = { 0 };
	lod_model_bounds(&s->leaves->model, low, high);
	s->radius = lod_model_sphere(&s->leaves->model, s->center);
	double height = (double)high[2] - (double)low[2];
	enum eco_code code = height > 0.05 * s->radius ? ECO_OK
		: eco_fail(error, ECO_UNSUPPORTED, "a plant without height");
	place_eyes(s);
	for (uint32_t i = 0; i < SIZES && !code; i++) {
		struct size *size = &s->sizes[i];
		size->side = (uint32_t)ceil(2 * FRAME * s->radius * heights_px[i] / height);
		code = lod_raster_init(&size->raster, &(struct lod_raster_options){ .width = size->side,
			.height = size->side, .item = true }, error);
		code = code ? code : lod_raster_init(&size->fine, &(struct lod_raster_options){ .width = FINE
			* size->side, .height = FINE * size->side, .silhouette = true }, error);
		size->count = lod_arena_take(&s->leaves->arena, size->side, size->side);
		for (uint32_t view = 0; view < VIEWS && !code; view++) {
			size_t pixels = (size_t)size->side * size->side;
			size->whole[view] = lod_arena_take(&s->leaves->arena, pixels, 1);
			size->soft[view] = lod_arena_take(&s->leaves->arena, pixels, 1);
			shoot(s, view, draw_whole, &s->leaves->model, &size->raster);
			memcpy(size->whole[view], size->raster.cover, pixels);
			shoot_fine(s, view, draw_whole, &s->leaves->model, size, size->soft[view]);
		}
	}
	return code;
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
		figure[SOFT] += lod_soft_q(size->count, size->soft[i % VIEWS], (size_t)size->side * size->side)
			/ (SIZES * VIEWS);
	}
}

static void score_ours(void *ctx, enum bench_ours_kind kind, uint32_t budget, bench_draw_call *draw,
	const void *what)
{
	struct study *s = ctx;
	double figure[FIGURES], *hard = s->ours[kind], *soft = hard + BUDGETS;
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

static enum eco_code measure_cap(struct study *s, uint32_t cap, uint8_t *picture, struct eco_error *error)
{
	struct lod_billboard_cloud cloud;
	enum eco_code code = lod_billboard_cloud_make(&cloud, s->plant, caps[cap], error);
	if (code)
		return code;
	double figure[FIGURES] = { cloud.count, cloud.parts, cloud.forms[0], cloud.forms[1], cloud.forms[2],
		cloud.error, cloud.invalid, cloud.epsilon, (double)cloud.texels / 1000 };
	score(s, draw_cloud, &cloud, figure);
	json_array_append_new(s->clouds, bench_reals(figure, FIGURES));
	if (cap >= 1 && cap <= 3)
		paint(s, &cloud, picture, cap);
	lod_billboard_cloud_free(&cloud);
	return bench_go_on(s->bench, error);
}

static enum eco_code study_caps(struct study *s, struct eco_error *error)
{
	char file[128];
	uint32_t side = s->sizes[SIZES - 1].side;
	uint8_t *picture = lod_arena_take(&s->leaves->arena, (size_t)PANELS * side * side, 3);
	enum eco_code code = ECO_OK;
	paint(s, NULL, picture, 0);
	for (uint32_t cap = 0; cap < CAPS && !code; cap++)
		code = measure_cap(s, cap, picture, error);
	snprintf(file, sizeof file, "billboards-%s.png", s->name);
	return code ? code : bench_picture_write(s->bench, file, PANELS * side, side, picture, error);
}

/* ---- A turn ---- */

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

static enum eco_code make_order(struct study *s, enum turn method, struct eco_error *error)
{
	struct lod_rank rank;
	if (method != GREEDY) {
		s->order = bench_leaves_order(s->leaves, method == COMBINED ? LOD_ORDER_COMBINED
			: LOD_ORDER_STOCHASTIC, 0);
		return ECO_OK;
	}
	enum eco_code code = lod_rank_make(&rank, &s->leaves->foliage, &(struct lod_rank_options){ .seed = 1,
		.leaves = true, .progress = bench_goes_on, .ctx = s->bench }, &s->leaves->arena, error);
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
	code = code ? code : lod_billboard_cloud_make(&cloud, s->plant, caps[TURNED], error);
	for (uint32_t v = 0; v < TURN_VIEWS && !code; v++) {
		struct bench_wrong sum = { 0 };
		bench_leaves_compare_drawn(s->leaves, &s->turn, v, false, draw_cloud, &cloud, &sum);
		mean += (q[v] = bench_wrong_q(&sum)) / TURN_VIEWS;
	}
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

/* The unit: [clouds, turns, Q of ours of each kind]. */
static enum eco_code study_leaves(void *ctx, struct bench_leaves *leaves, json_t **out,
	struct eco_error *error)
{
	struct study *s = ctx;
	s->leaves = leaves;
	json_t *ours = json_array();
	*out = json_pack("[ooo]", s->clouds = json_array(), s->turns = json_array(), ours);
	enum eco_code code = open_pictures(s, error);
	code = code ? code : lod_billboard_plant_open(&s->plant, &leaves->model, error);
	code = code ? code : study_caps(s, error);
	code = code ? code : study_turn(s, error);
	lod_billboard_plant_close(s->plant);
	code = code ? code : bench_ours_each(&leaves->model, budgets, BUDGETS, score_ours, s, error);
	for (int kind = 0; kind < BENCH_OURS_KINDS; kind++)
		json_array_append_new(ours, bench_reals(s->ours[kind], 2 * BUDGETS));
	for (uint32_t i = 0; i < SIZES; i++) {
		lod_raster_free(&s->sizes[i].raster);
		lod_raster_free(&s->sizes[i].fine);
	}
	return code;
}

static enum eco_code measure(struct bench *bench, const struct bench_model *model, json_t **out,
	struct eco_error *error)
{
	char name[96], stamp[32];
	struct study s = { .bench = bench, .name = model->name };
	snprintf(name, sizeof name, "billboards-%s", model->name);
	snprintf(stamp, sizeof stamp, "%016llx", (unsigned long long)bench_file_hash(model->path));
	return bench_leaves_unit(bench, &(struct bench_leaves_unit){ name, stamp, model, PIXELS,
		study_leaves, &s, NULL }, out, error);
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

static void write_caps(struct section *t, const char *plant, const json_t *clouds)
{
	for (size_t cap = 0; cap < CAPS; cap++) {
		double figure[FIGURES];
		bench_cells(json_array_get(clouds, cap), figure, FIGURES);
		bench_table_values(t->caps, figure, "%s,%u", plant, caps[cap]);
		t->error[cap] += figure[ERROR];
		t->precision[t->plants][cap] = figure[PRECISION];
		t->recall[t->plants][cap] = figure[RECALL];
	}
}

static const char *row_name(int row)
{
	return row == BEST ? "best of ours" : row ? bench_ours_names[row - 1] : "billboards";
}

static void write_row(struct section *t, const char *plant, int row, const double q[2 * BUDGETS])
{
	bench_table_row(t->q, "%s,%s,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f,%.3f", plant, row_name(row), q[0],
		q[1], q[2], q[3], q[4], q[5], q[6], q[7]);
}

static void write_beside(struct section *t, const char *plant, const json_t *clouds, const json_t *ours)
{
	double rows[ROWS][2 * BUDGETS] = { { 0 } };
	for (size_t row = 0; row < ROWS; row++) {
		if (row && row < BEST)
			bench_cells(json_array_get(ours, row - 1), rows[row], 2 * BUDGETS);
		for (size_t b = 0; b < 2 * BUDGETS; b++) {
			if (!row)
				rows[row][b] = bench_cell(json_array_get(clouds, b % BUDGETS),
					b < BUDGETS ? QUALITY : SOFT);
			else if (row < BEST)
				rows[BEST][b] = fmax(rows[BEST][b], rows[row][b]);
			t->sum[row][b] += rows[row][b];
		}
		write_row(t, plant, (int)row, rows[row]);
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
	char file[100];
	enum eco_code code = measure(t->bench, model, &unit, error);
	if (code)
		return code;
	write_caps(t, model->name, json_array_get(unit, 0));
	write_beside(t, model->name, json_array_get(unit, 0), json_array_get(unit, 2));
	snprintf(t->name[t->plants++], sizeof t->name[0], "%s", model->name);
	snprintf(file, sizeof file, "billboards-%s.png", model->name);
	bench_picture(t->bench, file, "full detail; at most 8, 33, 166 billboards, each in its mean colour; "
		"of the last Precision and Recall: light grey true, grey missing, black too many");
	return write_turn(t, model->name, json_array_get(unit, 1), error);
}

static bool is_foliage(const struct bench_model *model)
{
	static const char *const files[] = { "/eztree_oak_large.", "/eztree_pine_medium.", "/orchids.",
		"/bush.", "/sapling_quaking_aspen_s7.", "/coconutTree." };
	for (size_t i = 0; i < sizeof files / sizeof *files; i++)
		if (!model->generated && strstr(model->path, files[i]))
			return true;
	return false;
}

static enum eco_code study_all(struct section *t, struct eco_error *error)
{
	struct bench *bench = t->bench;
	struct bench_model *models = NULL;
	uint32_t count = 0, last = 0;
	enum eco_code code = bench_models(bench, &models, &count, error);
	for (uint32_t i = 0; i < count && !code && t->plants < PLANTS_MOST; i++) {
		/* without the data folder generated plants stand for those with leaves */
		if (bench->data ? !is_foliage(&models[i]) : t->plants == 2)
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
	if (!code && t->plants)          /* of the plant of most leaves */
		code = bench_billboards_field(bench, &models[last], error);
	free(models);
	return code;
}

static enum eco_code plot(struct section *t, struct eco_error *error)
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
	enum eco_code code = bench_plot(t->bench, &(struct bench_plot){ .name = "billboards",
		.title = "Hard Q at equal vertices, mean over plants", .x = "vertices", .y = "Q",
		.log_x = true, .series = series, .series_count = ROWS }, error);
	series[0] = (struct bench_series){ "error of the mean part", cap, t->error, CAPS, false };
	code = code ? code : bench_plot(t->bench, &(struct bench_plot){ .name = "billboards_error",
		.title = "The method's own error against the cap", .x = "billboards at most",
		.y = "error", .log_x = true, .series = series, .series_count = 1 }, error);
	for (uint32_t i = 0; i < t->plants; i++)
		series[i] = (struct bench_series){ t->name[i], t->recall[i], t->precision[i], CAPS, true };
	return code ? code : bench_plot(t->bench, &(struct bench_plot){ .name = "billboards_pr",
		.title = "Precision and Recall of clouds of 2 to 333 billboards", .x = "Recall",
		.y = "Precision", .series = series, .series_count = t->plants }, error);
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct section t = { .bench = bench };
	t.caps = bench_table_described(bench, "billboards_caps", "plant,cap", columns, FIGURES, true);
	t.q = bench_table_open(bench, "billboards", "plant,kind,hard 12,hard 48,hard 200,hard 1000,soft 12,"
		"soft 48,soft 200,soft 1000", true);
	t.turn = bench_table_open(bench, "billboards_turn",
		"plant,method,vertices,of wood besides,mean Q,least,"
		"most,variance,standard deviation", true);
	enum eco_code code = study_all(&t, error);
	if (!code && t.plants)
		code = plot(&t, error);
	bench_table_close(t.caps);
	bench_table_close(t.q);
	bench_table_close(t.turn);
	if (code || !t.plants)
		return code;
	for (int m = 0; m < TURNS; m++) {
		char key[64];
		snprintf(key, sizeof key, "billboards_turn_sd_%s", m ? turn_names[m] : "billboards");
		bench_key(bench, key, t.turned[m] ? t.sd[m] / t.turned[m] : NAN,
			"standard deviation of Q over a turn, mean over plants");
	}
	bench_say(bench, "A billboard has six vertices, a splat one. A cloud of another cap has other textures, so "
		"that clouds are alternatives and none continues another. Over a turn leaves are pruned over whole "
		"wood.");
	return ECO_OK;
}

const struct bench_section bench_billboards = { "billboards", "Billboard clouds against splats and impostors", run };
