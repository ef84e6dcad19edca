/* Lee, Peng, Kuo 2007: table I and figure 2, for a generated crown of 6,143 leaves, as many as the paper's
 * tree.
 *
 * Wrong pixels are pixels that differ from the picture with all leaves, over the pixels of that picture; wood
 * is whole in both. The paper draws leaves as they are; beside it stand scaled leaves, each method at the
 * scale that suits it best in other views. Lee's orders are made anew for each view, ours is one list. */
#include <math.h>
#include <string.h>

#include "ecofiles/format/list.h"
#include "lod/build/order/rank.h"
#include "lod/build/plant_state.h"
#include "tests/bench/baseline/paper_rules.h"
#include "tests/bench/bench_leaves.h"

#define SHARES 4u
#define VIEWS 12u
#define SEED 3119u
#define TUNING_VIEWS 4u
#define TUNING_SEED 501u
#define CELLS 32u                /* about so many share a plant's leaves */
#define SCALE_MOST 128.0
#define SHOWN 1u                 /* the view of figure 2 */
#define COLUMNS 7u               /* of figure 2: all leaves; three methods with 50 %; with 30 % */

static const uint32_t percent[SHARES] = { 80, 50, 30, 10 };
static const uint32_t layers[] = { 1, 2, 3, 5, 8, 12, 20, 40 };
#define LAYERS (sizeof layers / sizeof *layers)

enum method { DISTANCE, NORMAL, LAYER, CELL_DISTANCE, CELL_NORMAL, CELL_LAYER, STOCHASTIC, COMBINED, OURS, METHODS };
static const char *const names[METHODS] = { "distance", "normal", "layer+normal", "distance (cells)",
	"normal (cells)", "layer+normal (cells)", "stochastic", "combined", "our list" };

/* The unit: wrong pixels in per cent of the reference's, of leaves as they are and scaled; of layer+normal by
 * the number of layers. filled: the reference's pixels over those of the pictures. */
struct figures { double table[METHODS][2 * SHARES], layers[LAYERS][SHARES], filled; };

struct study {
	struct bench *bench;
	struct bench_leaves *leaves;
	struct lod_lee_leaves single, cells;
	uint32_t layer_count;                /* 0: the default */
	uint32_t *member, *first;            /* leaves of cell c: member[first[c] .. first[c + 1]) */
	uint32_t *fixed[METHODS];            /* orders that do not depend on the view */
	uint8_t *growth;                     /* of ours */
	uint32_t *kept, *used, *chosen;
	float *factor;
	struct lod_sights tests, tuning;
	struct figures made;
};

static void *take(struct study *s, size_t count, size_t size)
{
	return lod_arena_take(&s->leaves->arena, count, size);
}

/* ---- Which leaves ---- */

static void make_cells(struct study *s)
{
	const struct lod_foliage *f = &s->leaves->foliage;
	struct lod_cells cells;
	uint32_t *one = take(s, f->count, sizeof *one), at = 0;
	s->single = (struct lod_lee_leaves){ .count = f->count, .center = f->center, .normal = f->normal };
	s->member = take(s, f->count, sizeof *s->member);
	s->first = take(s, LOD_CELLS_MAX + 1, sizeof *s->first);
	s->kept = take(s, f->count, sizeof *s->kept);
	s->chosen = take(s, f->count, sizeof *s->chosen);
	s->used = take(s, LOD_CELLS_MAX, sizeof *s->used);
	s->factor = take(s, f->count, sizeof *s->factor);
	for (uint32_t i = 0; i < f->count; i++)
		one[i] = 1;
	lod_cells_make(&cells, &(struct lod_cells_input){ f->low, f->high, f->count, f->center, one,
		f->count / CELLS + 1 });
	lod_lee_cells(&s->cells, LOD_CELLS_MAX, &s->leaves->arena);
	for (uint32_t c = 0; c < (cells.count ? cells.count : 1); c++) {
		for (uint32_t i = 0; i < f->count; i++) {        /* in stochastic order */
			uint32_t leaf = s->fixed[STOCHASTIC][i];
			if ((cells.count ? lod_cells_at(&cells, f->center[leaf]) : 0) == c)
				s->member[at++] = leaf;
		}
		lod_lee_cell_add(&s->cells, f->center, f->normal, s->member + s->first[c], at - s->first[c]);
		s->first[c + 1] = at;
	}
}

/* Leaves that one of Lee's orders keeps, into s->chosen; valid until the next call. */
static void keep(struct study *s, enum method method, const struct lod_eye *eye, uint32_t budget)
{
	const struct lod_lee_view view = { { eye->at[0], eye->at[1], eye->at[2] },
		{ eye->forward[0], eye->forward[1], eye->forward[2] }, s->layer_count };
	bool cells = method >= CELL_DISTANCE;
	uint32_t count = lod_lee_keep(s->kept, (enum lod_lee_method)(method - (cells ? CELL_DISTANCE : 0)),
		cells ? &s->cells : &s->single, &view, budget, &s->leaves->arena);
	memset(s->used, 0, LOD_CELLS_MAX * sizeof *s->used);
	for (uint32_t i = 0; i < count; i++)
		s->chosen[i] = cells ? s->member[s->first[s->kept[i]] + s->used[s->kept[i]]++] : s->kept[i];
}

/* scale 1: leaves as they are. */
static struct lod_sights_drawing drawing_of(struct study *s, enum method method, const struct lod_eye *eye,
	uint32_t share, double scale)
{
	struct lod_sights_drawing drawing = { .order = method < STOCHASTIC ? s->chosen : s->fixed[method],
		.count = (uint32_t)((uint64_t)s->leaves->foliage.count * percent[share] / 100), .scale = (float)scale };
	if (method < STOCHASTIC)
		keep(s, method, eye, drawing.count);
	if (method != OURS || !(scale > 1))
		return drawing;
	for (uint32_t i = 0; i < drawing.count; i++)
		s->factor[drawing.order[i]] = eco_growth(s->growth[drawing.order[i]], drawing.scale);
	drawing.factor = s->factor;
	return drawing;
}

static double wrong_of(struct study *s, enum method method, const struct lod_sights *sights, uint32_t share,
	double scale)
{
	struct bench_wrong sum = { 0 };
	for (uint32_t v = 0; v < sights->count; v++) {
		struct lod_sights_drawing drawing = drawing_of(s, method, &sights->eyes[v], share, scale);
		bench_leaves_compare(s->leaves, sights, v, &drawing, &sum);
	}
	return 100 * bench_wrong_share(&sum);
}

/* ---- Scales ---- */

/* The best of steps of an octave, and then of half and a quarter of one beside it. */
static double best_scale(struct study *s, enum method method, uint32_t share)
{
	double best = 1, least = wrong_of(s, method, &s->tuning, share, 1), next;
	for (double scale = 1.5; scale < SCALE_MOST; scale *= 2) {
		next = wrong_of(s, method, &s->tuning, share, scale);
		if (next > 1.5 * least)
			break;
		best = next < least ? scale : best;
		least = fmin(next, least);
	}
	for (double step = 1.41421356; step > 1.1; step = sqrt(step)) {
		double middle = best;
		for (int way = 0; way < 2; way++) {
			double scale = fmax(1, way ? middle / step : middle * step);
			next = wrong_of(s, method, &s->tuning, share, scale);
			best = next < least ? scale : best;
			least = fmin(next, least);
		}
	}
	return best;
}

static void measure(struct study *s)
{
	for (uint32_t i = 0; i < METHODS * SHARES; i++) {
		uint32_t m = i / SHARES, share = i % SHARES;
		s->made.table[m][share] = wrong_of(s, m, &s->tests, share, 1);
		s->made.table[m][SHARES + share] = wrong_of(s, m, &s->tests, share, best_scale(s, m, share));
	}
	for (uint32_t i = 0; i < LAYERS * SHARES; i++) {
		s->layer_count = layers[i / SHARES];
		s->made.layers[i / SHARES][i % SHARES] = wrong_of(s, LAYER, &s->tests, i % SHARES, 1);
	}
	s->layer_count = 0;
	for (uint32_t v = 0; v < VIEWS; v++)
		s->made.filled += (double)s->tests.reference_pixels[v] / (VIEWS * BENCH_PIXELS * BENCH_PIXELS);
}

static void draw_figure_2(struct study *s)
{
	uint8_t *rgb = take(s, (size_t)COLUMNS * BENCH_PIXELS * BENCH_PIXELS, 3);
	bench_leaves_paint(s->leaves, &s->tests, SHOWN, NULL, 0, COLUMNS, rgb);
	for (uint32_t i = 0; i < COLUMNS - 1; i++) {         /* 50 %, then 30 % */
		const struct lod_sights_drawing drawing = drawing_of(s, i % 3, &s->tests.eyes[SHOWN], 1 + i / 3, 1);
		bench_leaves_paint(s->leaves, &s->tests, SHOWN, &drawing, i + 1, COLUMNS, rgb);
	}
	bench_picture_write(s->bench, "lee-figure-2.png", COLUMNS * BENCH_PIXELS, BENCH_PIXELS, rgb);
}

/* Ours is the list of packs, made for scaled leaves. */
static void make_lists(struct study *s)
{
	struct lod_rank rank;
	must(lod_rank_make(&rank, &s->leaves->foliage, &(struct lod_rank_options){ .seed = 3, .leaves = true },
		&s->leaves->arena, must_error));
	s->fixed[STOCHASTIC] = bench_leaves_order(s->leaves, LOD_ORDER_STOCHASTIC, 0);
	s->fixed[COMBINED] = bench_leaves_order(s->leaves, LOD_ORDER_COMBINED, 0);
	s->fixed[OURS] = rank.order;
	s->growth = rank.growth;
}

static json_t *study_leaves(void *ctx, struct bench_leaves *leaves)
{
	struct study *s = ctx;
	s->leaves = leaves;
	make_lists(s);
	make_cells(s);
	bench_leaves_look(leaves, &s->tuning, TUNING_VIEWS, TUNING_SEED);
	bench_leaves_look(leaves, &s->tests, VIEWS, SEED);
	measure(s);
	draw_figure_2(s);
	return bench_reals((const double *)&s->made, sizeof s->made / sizeof(double));
}

/* ---- Tables ---- */

static void write_table(struct bench *bench, const struct figures *f)
{
	static const struct bench_column columns[2 * SHARES] = { { "at 80 %", 1 }, { "at 50 %", 1 },
		{ "at 30 %", 1 }, { "at 10 %", 1 }, { "scaled: at 80 %", 1 }, { "scaled: at 50 %", 1 },
		{ "scaled: at 30 %", 1 }, { "scaled: at 10 %", 1 } };
	double x[SHARES];
	struct bench_series series[METHODS];
	uint32_t count = 0;
	struct bench_table *table = bench_table_described(bench, "lee_crown", "crown of 6143 leaves: wrong %",
		columns, 2 * SHARES, true);
	for (uint32_t share = 0; share < SHARES; share++)
		x[share] = percent[share];
	for (uint32_t m = 0; m < METHODS; m++) {
		bench_table_values(table, f->table[m], "%s", names[m]);
		if (m < CELL_DISTANCE || m > CELL_LAYER)
			series[count++] = (struct bench_series){ names[m], x, f->table[m], SHARES, false };
	}
	bench_table_close(table);
	bench_plot(bench, &(struct bench_plot){ .name = "lee-crown",
		.title = "Crown of 6,143 leaves, unscaled", .x = "leaves kept, %",
		.y = "wrong pixels, % of the reference", .series = series, .series_count = count });
}

static void write_row(struct bench_table *table, const char *method, const char *layer_count,
	const double wrong[SHARES], double filled)
{
	bench_table_row(table, "%s,%s,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f,%.2f", method, layer_count, wrong[0],
		wrong[1], wrong[2], wrong[3], wrong[0] * filled, wrong[1] * filled, wrong[2] * filled,
		wrong[3] * filled);
}

static void write_layers(struct bench *bench, const struct figures *f)
{
	bench_head(bench, "Layers, and shares of what");
	struct bench_table *table = bench_table_open(bench, "lee_layers",
		"method,G,80 %,50 %,30 %,10 %,of the picture: 80 %,50 % of it,30 % of it,10 % of it", true);
	bench_table_row(table, "%s", "distance (printed),-,3.03,9.09,14.03,18.42,-,-,-,-");
	bench_table_row(table, "%s", "normal (printed),-,5.31,12.87,16.49,19.13,-,-,-,-");
	bench_table_row(table, "%s", "layer+normal (printed),not said,2.86,10.06,15.07,18.75,-,-,-,-");
	for (size_t m = 0; m < LAYER; m++)
		write_row(table, names[m], "-", f->table[m], f->filled);
	for (size_t i = 0; i < LAYERS; i++) {
		char count[16];
		snprintf(count, sizeof count, "%u", layers[i]);
		write_row(table, names[LAYER], count, f->layers[i], f->filled);
	}
	bench_table_close(table);
	bench_picture(bench, "lee-figure-2.png", "All leaves; distance, normal and layer+normal with 50 % "
		"of the leaves; the same with 30 %");
	bench_say(bench, "%u views of %u pixels. Printed figures stay below 20 %% where "
		"a tenth of the leaves is left: no share of the reference's pixels, whose greater part is "
		"missing then, but about the share of a picture that the tree does not fill.", VIEWS, BENCH_PIXELS);
}

static void run(struct bench *bench)
{
	struct figures f;
	struct study s = { .bench = bench };
	bench_progress(0, "crown of 6143 leaves");
	bench_leaves_unit(bench, "lee-crown-6143", NULL, study_leaves, &s, (double *)&f, sizeof f / sizeof(double));
	write_table(bench, &f);
	write_layers(bench, &f);
}

const struct bench_section bench_lee = { "lee", "Which leaves to keep: Lee's orders and ours", run };
