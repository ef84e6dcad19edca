#include "tests/bench/pictures/bench_billboards_q.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "ecofiles/base/angle16.h"
#include "lod/build/order/order.h"
#include "lod/build/order/rank.h"
#include "lod/sort.h"
#include "tests/bench/baseline/billboard_cloud.h"
#include "tests/bench/bench_leaves.h"

#define VIEW 7u                          /* of pictures, as for splats */
#define PANELS 5u                        /* the whole plant, three caps, Precision and Recall */
#define PIXELS 256u
#define TURN_UP 0.1                      /* the eye's height over the plant's middle, as a slope */
#define TUNING 6u                        /* of the turn's views: scales are chosen in these */
#define STEPS 10                         /* of the search for a number of leaves */
#define SCALES 7

const char *const bench_billboards_kind_names[BENCH_BILLBOARDS_KINDS] = { "billboards", "crosses only",
	"valid faces only" };
const char *const bench_turn_names[BENCH_TURN_METHODS] = { "209 billboards", "stochastic", "combined",
	"greedy" };
const uint32_t bench_billboards_caps[BENCH_BILLBOARDS_CAPS] = { 2, 8, 33, 166, 209, 333 };

struct study {
	struct bench *bench;
	const char *name;
	struct bench_leaves leaves;
	struct bench_splats_pictures pictures;
	struct lod_billboard_plant *plant;
	struct lod_sights turn;
	uint32_t *order;
	struct bench_billboards_q *q;
};

static void draw_cloud(const void *cloud, struct lod_raster *raster)
{
	lod_billboard_cloud_draw(cloud, 1, raster);
}

/* ---- Clouds by cap ---- */

static enum eco_code make_cloud(struct study *s, int kind, uint32_t cap, struct lod_billboard_cloud *cloud,
	struct eco_error *error)
{
	/* the same clouds again, without a search for epsilon */
	double epsilon = kind == BENCH_BILLBOARDS_VALID ? s->q->point[BENCH_BILLBOARDS_ALL][cap].epsilon : 0;
	const struct lod_billboard_options options = { .cap = bench_billboards_caps[cap], .epsilon = epsilon,
		.forms = kind == BENCH_BILLBOARDS_CROSSES ? 1u << LOD_BILLBOARD_CROSS : 0,
		.valid_only = kind == BENCH_BILLBOARDS_VALID };
	struct bench_billboards_point *to = &s->q->point[kind][cap];
	clock_t begun = clock();
	enum eco_code code = lod_billboard_cloud_make(cloud, s->plant, &options, error);
	*to = (struct bench_billboards_point){ cloud->count, cloud->parts, { cloud->forms[0],
		cloud->forms[1], cloud->forms[2] }, cloud->error, cloud->invalid, cloud->epsilon,
		(double)cloud->texels, (double)cloud->texture_bytes,
		(double)(clock() - begun) / CLOCKS_PER_SEC, { .hard = 0 } };
	return code;
}

/* By view: light grey where both are, grey where the cloud is missing, black where only that is (Kratt 2014,
 * figure 3). Both panels are painted; the second is overwritten. */
static void compare_panels(const uint8_t *whole, uint8_t *panel, uint32_t side, uint32_t stride)
{
	for (uint32_t y = 0; y < side; y++)
		for (uint32_t x = 0; x < side; x++) {
			size_t at = 3 * ((size_t)y * stride + x);
			bool wanted = whole[at] < 255, shown = panel[at] < 255;
			if (wanted || shown)
				memset(panel + at, !wanted ? 0 : shown ? 210 : 130, 3);
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

static enum eco_code paint(struct study *s, const struct lod_billboard_cloud *cloud, uint8_t *picture,
	uint32_t panel, struct eco_error *error)
{
	uint32_t side = s->pictures.sizes[BENCH_SPLATS_SIZES - 1].side;
	uint8_t (*rgb)[3] = malloc((cloud->count + 1) * sizeof *rgb);
	if (!rgb)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for colours");
	for (uint32_t i = 0; i < cloud->count; i++)
		bench_billboards_color(&cloud->items[i].image, rgb[i]);
	uint8_t *to = picture + 3 * (size_t)panel * side;
	bench_splats_paint(&s->pictures, VIEW, draw_cloud, cloud, (const uint8_t (*)[3])rgb, to,
		PANELS * side);
	if (panel + 2 == PANELS) {
		to += 3 * (size_t)side;
		bench_splats_paint(&s->pictures, VIEW, draw_cloud, cloud, NULL, to, PANELS * side);
		compare_panels(picture, to, side, PANELS * side);
	}
	free(rgb);
	return ECO_OK;
}

static enum eco_code measure_caps(struct study *s, uint8_t *picture, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < BENCH_BILLBOARDS_KINDS * BENCH_BILLBOARDS_CAPS && !code; i++) {
		uint32_t cap = i % BENCH_BILLBOARDS_CAPS;
		int kind = (int)(i / BENCH_BILLBOARDS_CAPS);
		struct lod_billboard_cloud cloud;
		if (!bench_billboards_has(kind, cap))
			continue;
		code = make_cloud(s, kind, cap, &cloud, error);
		if (code)
			return code;
		bench_splats_score(&s->pictures, BENCH_SPLATS_SIZES, draw_cloud, &cloud,
			&s->q->point[kind][cap].q);
		if (kind == BENCH_BILLBOARDS_ALL && cap >= 1 && cap <= 3)
			code = paint(s, &cloud, picture, cap, error);
		lod_billboard_cloud_free(&cloud);
		if (!code && bench_stopped(s->bench))
			code = eco_fail(error, ECO_INTERRUPTED, "interrupted");
	}
	return code;
}

static enum eco_code study_caps(struct study *s, struct eco_error *error)
{
	char file[128];
	uint32_t side = s->pictures.sizes[BENCH_SPLATS_SIZES - 1].side;
	uint8_t *picture = calloc((size_t)PANELS * side * side, 3);
	if (!picture)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a picture");
	bench_splats_paint(&s->pictures, VIEW, NULL, NULL, NULL, picture, PANELS * side);
	enum eco_code code = measure_caps(s, picture, error);
	snprintf(file, sizeof file, "billboards-%s.png", s->name);
	if (!code)
		code = bench_picture_write(s->bench, file, PANELS * side, side, picture, error);
	free(picture);
	return code;
}

/* ---- A turn ---- */

static double cloud_q(struct study *s, const struct lod_billboard_cloud *cloud, uint32_t view)
{
	const struct lod_sights *sights = &s->turn;
	struct lod_raster *raster = &s->leaves.cover;
	struct bench_wrong sum = { .pixels = sights->reference_pixels[view] };
	uint32_t row_words = sights->words / sights->pixels;
	lod_raster_clear(raster);
	lod_raster_camera(raster, &sights->eyes[view], sights->near_m);
	lod_raster_object(raster, &(struct lod_place){ .cosine = 1, .scale = 1 });
	lod_billboard_cloud_draw(cloud, 1, raster);
	for (size_t i = 0; i < (size_t)PIXELS * PIXELS; i++) {
		uint64_t word = sights->reference[view][i / PIXELS * row_words + i % PIXELS / 64];
		bool shown = raster->cover[i], wanted = word >> (i % PIXELS % 64) & 1;
		sum.fp += shown && !wanted;
		sum.fn += wanted && !shown;
	}
	return bench_wrong_q(&sum);
}

static double leaves_q(struct study *s, uint32_t count, float scale, uint32_t view)
{
	struct bench_wrong sum = { 0 };
	const struct lod_sights_drawing drawing = { .order = s->order, .count = count, .scale = scale };
	bench_leaves_compare(&s->leaves, &s->turn, view, &drawing, &sum);
	return bench_wrong_q(&sum);
}

/* Q of each view of so many leaves at their best scale; returns the mean. */
static double prune(struct study *s, uint32_t count, double q[BENCH_TURN_VIEWS])
{
	double best = -INFINITY, mean = 0;
	float best_scale = 1;
	for (int i = 0; i < SCALES; i++) {
		float scale = (float)pow((double)s->leaves.foliage.count / count, (double)i / (SCALES - 1));
		double now = 0;
		for (uint32_t v = 0; v < TUNING; v++)
			now += leaves_q(s, count, scale, v * BENCH_TURN_VIEWS / TUNING);
		best_scale = now > best ? scale : best_scale;
		best = fmax(best, now);
	}
	for (uint32_t v = 0; v < BENCH_TURN_VIEWS; v++)
		mean += (q[v] = leaves_q(s, count, best_scale, v)) / BENCH_TURN_VIEWS;
	return mean;
}

/* Prunes to a mean Q as near as can be; views are NaN if wood alone is better. */
static void prune_to(struct study *s, enum bench_turn method, double wanted)
{
	const struct lod_foliage *f = &s->leaves.foliage;
	uint32_t low = 1, high = f->count;
	double *q = s->q->turn[method], vertices = 0;
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
	s->q->vertices[method] = vertices;
	for (uint32_t v = 0; v < BENCH_TURN_VIEWS && fabs(mean - wanted) > 0.02; v++)
		q[v] = NAN;
}

static bool rank_goes_on(void *ctx, double share)
{
	(void)share;
	return !bench_stopped(ctx);
}

static enum eco_code make_order(struct study *s, enum bench_turn method, struct eco_error *error)
{
	const struct lod_foliage *f = &s->leaves.foliage;
	struct lod_arena *arena = &s->leaves.arena;
	struct lod_rank rank;
	if (method == BENCH_TURN_GREEDY) {
		const struct lod_rank_options options = { .seed = 1, .leaves = true,
			.progress = rank_goes_on, .ctx = s->bench };
		enum eco_code code = lod_rank_make(&rank, f, &options, arena, error);
		s->order = rank.order;
		return code;
	}
	double *survival = lod_arena_take(arena, f->count, sizeof *survival);
	struct lod_keyed *items = lod_arena_take(arena, f->count, sizeof *items);
	lod_order_survival_by(survival, method == BENCH_TURN_COMBINED ? LOD_ORDER_COMBINED
		: LOD_ORDER_STOCHASTIC, &(struct lod_order_input){ .count = f->count, .center = f->center,
		.normal = f->normal, .height = f->high.z - f->low.z, .seed = 1 }, arena);
	for (uint32_t i = 0; i < f->count; i++)
		items[i] = (struct lod_keyed){ ~lod_sort_key(survival[i]), i };
	lod_sort(arena, items, f->count);
	s->order = lod_arena_take(arena, f->count, sizeof *s->order);
	for (uint32_t i = 0; i < f->count; i++)
		s->order[i] = items[i].value;
	return ECO_OK;
}

static enum eco_code study_turn(struct study *s, struct eco_error *error)
{
	double directions[BENCH_TURN_VIEWS][3], mean = 0;
	struct lod_billboard_cloud cloud;
	for (uint32_t v = 0; v < BENCH_TURN_VIEWS; v++) {
		double sine, cosine, flat = 1 / sqrt(1 + TURN_UP * TURN_UP);
		eco_angle16_sincos(eco_angle16_from_deg(360.0 * v / BENCH_TURN_VIEWS), &sine, &cosine);
		directions[v][0] = flat * cosine, directions[v][1] = flat * sine;
		directions[v][2] = flat * TURN_UP;
	}
	enum eco_code code = lod_sights_make(&s->turn, &s->leaves.foliage, (const double (*)[3])directions,
		BENCH_TURN_VIEWS, PIXELS, &s->leaves.arena, error);
	if (!code)
		code = lod_billboard_cloud_make(&cloud, s->plant, &(struct lod_billboard_options){
			.cap = bench_billboards_caps[BENCH_BILLBOARDS_TURNED] }, error);
	if (code)
		return code;
	s->q->vertices[BENCH_TURN_BILLBOARDS] = 6.0 * cloud.count;
	s->q->wood_vertices = 3.0 * (double)s->leaves.foliage.wood_count;
	for (uint32_t v = 0; v < BENCH_TURN_VIEWS; v++) {
		double q = cloud_q(s, &cloud, v);
		s->q->turn[BENCH_TURN_BILLBOARDS][v] = q;
		mean += q / BENCH_TURN_VIEWS;
	}
	lod_billboard_cloud_free(&cloud);
	for (int m = BENCH_TURN_STOCHASTIC; m < BENCH_TURN_METHODS && !code; m++) {
		code = make_order(s, (enum bench_turn)m, error);
		if (!code)
			prune_to(s, (enum bench_turn)m, mean);
	}
	return !code && bench_stopped(s->bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted") : code;
}

/* ---- All of it ---- */

static enum eco_code run_study(struct study *s, struct eco_error *error)
{
	const struct eco_model *model = &s->leaves.model;
	enum eco_code code = bench_splats_open(&s->pictures, model, bench_splats_heights_px, error);
	if (code)
		return code;
	code = lod_billboard_plant_open(&s->plant, model, &(struct lod_billboard_options){ 0 }, error);
	if (!code)
		code = study_caps(s, error);
	if (!code && setjmp(s->leaves.arena.failed))
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for a turn");
	else if (!code)
		code = study_turn(s, error);
	lod_billboard_plant_close(s->plant);
	bench_splats_close(&s->pictures);
	return code;
}

enum eco_code bench_billboards_measure(struct bench *bench, const char *name, struct bench_billboards_q *q,
	struct eco_model *model, struct eco_error *error)
{
	struct study *s = calloc(1, sizeof *s);
	memset(q, 0, sizeof *q);
	if (!s) {
		eco_model_free(model);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a study of billboards");
	}
	*s = (struct study){ .bench = bench, .name = name, .q = q };
	enum eco_code code = bench_leaves_open(&s->leaves, model, PIXELS, error);
	if (!code) {
		code = run_study(s, error);
		bench_leaves_close(&s->leaves);
	}
	free(s);
	return code;
}
