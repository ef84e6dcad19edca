/* Lee, Peng, Kuo 2007: table I and figure 2, for a generated crown of 6,143 leaves, as many as the paper's
 * tree.
 *
 * Wrong pixels are pixels that differ from the picture with all leaves; wood is whole in both. Lee's orders
 * are made anew for each view, and leaves stay as large as they are. Beside them stand orders that hold for
 * all views: at random, Neubert's combined one, and the greedy one of packs, whose leaves grow by the scale
 * that suits them best in other views. */
#include <math.h>
#include <string.h>

#include "ecofiles/format/list.h"
#include "lod/build/order/rank.h"
#include "tests/bench/baseline/paper_rules.h"
#include "tests/bench/bench_leaves.h"

#define PIXELS 256u
#define SHARES 4u
#define VIEWS 12u
#define SEED 3119u
#define TUNING_VIEWS 4u
#define TUNING_SEED 501u
#define SCALE_MOST 128.0
#define SHARE_LEAST 0.08         /* shorter prefixes of the greedy order are not refined */
#define SHOWN 1u                 /* the view of figure 2 */
#define COLUMNS 7u               /* of figure 2: all leaves; three methods with 50 %; with 30 % */

static const uint32_t percent[SHARES] = { 80, 50, 30, 10 };
static const uint32_t layers[] = { 1, 2, 3, 5, 8, 12, 20, 40 };
#define LAYERS (sizeof layers / sizeof *layers)

/* Rows: distance, normal, layer+normal by the number of layers, and orders for all views. */
enum row { DISTANCE, NORMAL, LAYER, STOCHASTIC = LAYER + LAYERS, COMBINED, GREEDY, ROWS };
static const char *const names[] = { "distance", "normal", "layer+normal" },
	*const fixed_names[] = { "stochastic", "combined", "our list (scaled)" };

struct study {
	struct bench *bench;
	struct bench_leaves *leaves;
	uint32_t *order[ROWS - STOCHASTIC], *kept;
	uint8_t *growth;
	float *factor;
	struct lod_sights tests, tuning;
};

static void *take(struct study *s, size_t size)
{
	return lod_arena_take(&s->leaves->arena, s->leaves->foliage.count, size);
}

static uint32_t budget_of(const struct study *s, uint32_t of_100)
{
	return (uint32_t)((uint64_t)s->leaves->foliage.count * of_100 / 100);
}

/* `layer_count` 0: the default. */
static struct lod_sights_drawing keep(struct study *s, enum lod_lee_method method, uint32_t layer_count,
	uint32_t of_100, const struct lod_eye *eye)
{
	const struct lod_lee_view view = { { eye->at[0], eye->at[1], eye->at[2] },
		{ eye->forward[0], eye->forward[1], eye->forward[2] }, layer_count };
	const struct lod_foliage *f = &s->leaves->foliage;
	uint32_t count = lod_lee_keep(s->kept, method, &(struct lod_lee_leaves){ .count = f->count,
		.center = f->center, .normal = f->normal }, &view, budget_of(s, of_100), &s->leaves->arena);
	return (struct lod_sights_drawing){ .order = s->kept, .count = count, .scale = 1 };
}

static struct lod_sights_drawing prefix(struct study *s, enum row row, uint32_t of_100, double scale)
{
	struct lod_sights_drawing drawing = { .order = s->order[row - STOCHASTIC],
		.count = budget_of(s, of_100), .scale = 1 };
	for (uint32_t i = 0; i < drawing.count && row == GREEDY; i++)
		s->factor[drawing.order[i]] = eco_growth(s->growth[drawing.order[i]], (float)scale);
	drawing.factor = row == GREEDY ? s->factor : NULL;
	return drawing;
}

/* ---- The scale of the greedy order ---- */

static double wrong_at(struct study *s, uint32_t of_100, double scale)
{
	struct bench_wrong sum = { 0 };
	const struct lod_sights_drawing drawing = prefix(s, GREEDY, of_100, scale);
	for (uint32_t v = 0; v < TUNING_VIEWS; v++)
		bench_leaves_compare(s->leaves, &s->tuning, v, &drawing, &sum);
	return bench_wrong_share(&sum);
}

/* The best of steps of an octave, and then of half and a quarter of one beside it. */
static double best_scale(struct study *s, uint32_t of_100)
{
	double best = 1, least = wrong_at(s, of_100, 1), next;
	for (double scale = 1.5; scale < SCALE_MOST; scale *= 2) {
		next = wrong_at(s, of_100, scale);
		if (next > 1.5 * least)
			break;
		best = next < least ? scale : best;
		least = fmin(next, least);
	}
	for (double step = 1.41421356; step > 1.1; step = sqrt(step)) {
		double middle = best;
		for (int way = 0; way < 2; way++) {
			double scale = fmax(1, way ? middle / step : middle * step);
			next = wrong_at(s, of_100, scale);
			best = next < least ? scale : best;
			least = fmin(next, least);
		}
	}
	return best;
}

/* ---- Measuring ---- */

/* Wrong pixels over the reference's pixels for each share, then over all pixels of the picture. */
static json_t *measure_row(struct study *s, enum row row)
{
	double figure[2 * SHARES];
	for (uint32_t share = 0; share < SHARES; share++) {
		struct bench_wrong sum = { 0 };
		double scale = row == GREEDY ? best_scale(s, percent[share]) : 1;
		for (uint32_t v = 0; v < VIEWS; v++) {
			const struct lod_sights_drawing drawing = row >= STOCHASTIC
				? prefix(s, row, percent[share], scale)
				: keep(s, row < LAYER ? (enum lod_lee_method)row : LOD_LEE_LAYER,
				row < LAYER ? 0 : layers[row - LAYER], percent[share], &s->tests.eyes[v]);
			bench_leaves_compare(s->leaves, &s->tests, v, &drawing, &sum);
		}
		figure[share] = bench_wrong_share(&sum);
		figure[SHARES + share] = (double)(sum.fp + sum.fn) / ((double)VIEWS * PIXELS * PIXELS);
	}
	return bench_reals(figure, 2 * SHARES);
}

/* Wood lies over leaves, which are alike in colour. NULL: all leaves. */
static void draw_into(struct study *s, const struct lod_sights_drawing *drawing, uint32_t column,
	uint8_t *rgb)
{
	static const uint8_t colors[3][3] = { { 255, 255, 255 }, { 96, 78, 60 }, { 76, 128, 48 } };
	struct bench_wrong wrong = { 0 };
	const uint64_t *leaves = drawing ? s->leaves->mask : s->tests.reference[SHOWN],
		*wood = s->tests.wood[SHOWN];
	if (drawing)
		bench_leaves_compare(s->leaves, &s->tests, SHOWN, drawing, &wrong);
	for (size_t i = 0; i < (size_t)PIXELS * PIXELS; i++) {
		size_t word = i / PIXELS * (PIXELS / 64) + i % PIXELS / 64;
		int color = leaves[word] & ~wood[word] & UINT64_C(1) << i % 64 ? 2
			: (leaves[word] | wood[word]) >> i % 64 & 1;
		memcpy(rgb + 3 * ((i / PIXELS * COLUMNS + column) * PIXELS + i % PIXELS), colors[color], 3);
	}
}

static enum eco_code draw_figure_2(struct study *s, struct eco_error *error)
{
	uint8_t *rgb = lod_arena_take(&s->leaves->arena, (size_t)COLUMNS * PIXELS * PIXELS, 3);
	draw_into(s, NULL, 0, rgb);
	for (uint32_t i = 0; i < COLUMNS - 1; i++) {
		const struct lod_sights_drawing drawing = keep(s, (enum lod_lee_method)(i % 3), 0, i < 3
			? 50 : 30, &s->tests.eyes[SHOWN]);
		draw_into(s, &drawing, i + 1, rgb);
	}
	return bench_picture_write(s->bench, "lee-figure-2.png", COLUMNS * PIXELS, PIXELS, rgb, error);
}

static enum eco_code look(struct study *s, struct lod_sights *sights, uint32_t count, uint32_t seed,
	struct eco_error *error)
{
	double to[VIEWS][3];
	lod_directions_spread(to, count, seed);
	return lod_sights_make(sights, &s->leaves->foliage, (const double (*)[3])to, count, PIXELS,
		&s->leaves->arena, error);
}

/* The unit: figures of each row. */
static enum eco_code study_leaves(void *ctx, struct bench_leaves *leaves, json_t **out,
	struct eco_error *error)
{
	struct study *s = ctx;
	const struct lod_foliage *f = &leaves->foliage;
	struct lod_rank rank;
	s->leaves = leaves;
	s->kept = take(s, sizeof *s->kept);
	s->factor = take(s, sizeof *s->factor);
	enum eco_code code = lod_rank_make(&rank, f, &(struct lod_rank_options){ .seed = 3,
		.wrong_pixels = true, .from_share = SHARE_LEAST }, &leaves->arena, error);
	code = code ? code : look(s, &s->tuning, TUNING_VIEWS, TUNING_SEED, error);
	code = code ? code : look(s, &s->tests, VIEWS, SEED, error);
	code = code ? code : draw_figure_2(s, error);
	if (code)
		return code;
	s->order[0] = bench_leaves_order(leaves, LOD_ORDER_STOCHASTIC, 0);
	s->order[1] = bench_leaves_order(leaves, LOD_ORDER_COMBINED, 0);
	s->order[2] = rank.order;
	s->growth = rank.growth;
	*out = json_array();
	for (int row = 0; row < ROWS; row++)
		json_array_append_new(*out, measure_row(s, (enum row)row));
	return ECO_OK;
}

/* ---- The report ---- */

static void write_table(struct bench *bench, const json_t *rows)
{
	struct bench_table *table = bench_table_open(bench, "lee_layers",
		"method,G,80 %,50 %,30 %,10 %,of the picture: 80 %,50 % of it,30 % of it,10 % of it", true);
	bench_table_row(table, "%s", "distance (printed),-,3.03,9.09,14.03,18.42,-,-,-,-");
	bench_table_row(table, "%s", "normal (printed),-,5.31,12.87,16.49,19.13,-,-,-,-");
	bench_table_row(table, "%s", "layer+normal (printed),not said,2.86,10.06,15.07,18.75,-,-,-,-");
	for (size_t row = 0; row < ROWS; row++) {
		double v[2 * SHARES];
		char count[16] = "-";
		const char *name = row >= STOCHASTIC ? fixed_names[row - STOCHASTIC] : names[row < LAYER ? row
			: LAYER];
		if (row >= LAYER && row < STOCHASTIC)
			snprintf(count, sizeof count, "%u", layers[row - LAYER]);
		bench_cells(json_array_get(rows, row), v, 2 * SHARES);
		bench_table_row(table, "%s,%s,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f", name, count,
			100 * v[0],
			100 * v[1], 100 * v[2], 100 * v[3], 100 * v[4], 100 * v[5], 100 * v[6], 100 * v[7]);
	}
	bench_table_close(table);
	bench_picture(bench, "lee-figure-2.png", "All leaves; distance, normal and layer+normal with 50 % "
		"of the leaves; the same with 30 %");
	bench_say(bench, "Incorrect pixels in %% of the reference's pixels, then of the picture's; %u views of "
		"%u pixels. Printed figures stay below 20 %% where a tenth of the leaves is left: no share of the "
		"reference's pixels, whose greater part is missing then, but about the share of a picture that the "
		"tree does not fill.", VIEWS, PIXELS);
}

/* Wrong pixels over those of the best of Lee's. */
static void write_keys(struct bench *bench, const json_t *rows)
{
	static const char *const bars[SHARES] = { "at 80 %", "<= 0.8: at 50 %", "<= 0.7: at 30 %",
		"<= 0.75: at 10 %" };
	for (uint32_t share = 0; share < SHARES; share++) {
		char key[32];
		double best = INFINITY;
		for (size_t row = 0; row < STOCHASTIC; row++)
			best = fmin(best, bench_cell(json_array_get(rows, row), share));
		snprintf(key, sizeof key, "lee_static_%u", percent[share]);
		bench_key(bench, key, bench_cell(json_array_get(rows, GREEDY), share) / best, bars[share]);
	}
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	json_t *rows;
	struct study s = { .bench = bench };
	bench_progress(bench, 0, "crown of 6143 leaves");
	enum eco_code code = bench_leaves_unit(bench, &(struct bench_leaves_unit){ .name = "lee-crown-6143",
		.make = bench_crown_make, .pixels = PIXELS, .study = study_leaves, .ctx = &s }, &rows, error);
	if (code)
		return code;
	write_table(bench, rows);
	write_keys(bench, rows);
	return ECO_OK;
}

const struct bench_section bench_lee = { "lee", "Which leaves to keep: Lee's orders and ours", run };
