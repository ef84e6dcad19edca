/* Lee, Peng, Kuo 2007: table I and figure 2, for a generated crown of 6,143 leaves, as many as the paper's
 * tree.
 *
 * Wrong pixels are pixels that differ from the picture with all leaves, over the pixels of that picture; wood
 * is whole in both. The paper draws leaves as they are; beside it stand scaled leaves, each method at the
 * scale that suits it best in other views. Lee's orders are made anew for each view.
 *
 * Sectors are cones around directions all over the upper sphere, 1.5 or 12 degrees wide. The lists of a
 * sector are built from 16 or 24 directions in its cone and tested with others in it. The one list ("our
 * list") is built from directions all around. */
#include <math.h>
#include <string.h>

#include "ecofiles/format/list.h"
#include "lod/build/order/footprint.h"
#include "lod/build/order/rank.h"
#include "lod/build/plant_state.h"
#include "lod/heap.h"
#include "tests/bench/baseline/paper_rules.h"
#include "tests/bench/bench_leaves.h"

#define PIXELS 256u
#define SHARES 4u
#define STATIC_VIEWS 96u         /* of the one list */
#define TUNING_VIEWS 4u
#define VIEWS_MOST 24u
#define SECTORS_MOST 12u
#define CELLS 32u                /* about so many share a plant's leaves */
#define SCALE_MOST 128.0
#define SHARE_LEAST 0.08         /* shorter prefixes of lists for scaled leaves are not refined */
#define LAYER_VIEWS 12u
#define LAYER_SEED 3119u
#define SHOWN 1u                 /* the view of figure 2 */
#define COLUMNS 7u               /* of figure 2: all leaves; three methods with 50 %; with 30 % */

static const uint32_t percent[SHARES] = { 80, 50, 30, 10 };
/* Cones: narrow, wide. More build views make short lists worse. */
static const struct { double degrees; uint32_t build_views; } widths[] = { { 1.5, 16 }, { 12, 24 } };
#define WIDTHS (sizeof widths / sizeof *widths)
static const uint32_t layers[] = { 1, 2, 3, 5, 8, 12, 20, 40 };
#define LAYERS (sizeof layers / sizeof *layers)

enum method { DISTANCE, NORMAL, LAYER, CELL_DISTANCE, CELL_NORMAL, CELL_LAYER, STOCHASTIC, COMBINED, STATIC,
	SECTOR, METHODS };
static const char *const names[METHODS] = { "distance", "normal", "layer+normal", "distance (cells)",
	"normal (cells)", "layer+normal (cells)", "stochastic", "combined", "our list",
		"our lists per sector" };
enum figure { WRONG, SCALED_WRONG, OTHER_LEAF, FIGURES };        /* shares of the reference's pixels */

/* The unit. Layers: wrong pixels over the reference's pixels for each share, then over all pixels of the
 * picture. */
struct figures {
	double table[WIDTHS][METHODS][FIGURES][SHARES], layers[LAYER + LAYERS][2 * SHARES];
};

struct study {
	struct bench *bench;
	struct bench_leaves *leaves;
	struct lod_lee_leaves single, cells;
	uint32_t *member, *first;            /* leaves of cell c: member[first[c] .. first[c + 1]) */
	uint32_t *fixed[METHODS][2];             /* orders that do not depend on the view: unscaled, scaled */
	uint8_t *growth[METHODS];
	uint32_t *kept, *used, *chosen;
	float *factor;
	struct lod_sights tests, tuning;
	struct lod_raster ids;               /* owners: leaves from 1 */
	double scale[METHODS][SHARES];
	struct bench_wrong wrong[METHODS][SHARES][2];
	uint64_t other[METHODS][SHARES], shown;
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
			uint32_t leaf = s->fixed[STOCHASTIC][0][i];
			if ((cells.count ? lod_cells_at(&cells, f->center[leaf]) : 0) == c)
				s->member[at++] = leaf;
		}
		lod_lee_cell_add(&s->cells, f->center, f->normal, s->member + s->first[c], at - s->first[c]);
		s->first[c + 1] = at;
	}
}

/* Leaves that one of Lee's orders keeps, into s->chosen; valid until the next call. layer_count 0: the
 * default. */
static void keep(struct study *s, enum method method, uint32_t layer_count, const struct lod_eye *eye,
	uint32_t budget)
{
	const struct lod_lee_view view = { { eye->at[0], eye->at[1], eye->at[2] },
		{ eye->forward[0], eye->forward[1], eye->forward[2] }, layer_count };
	bool cells = method >= CELL_DISTANCE;
	uint32_t count = lod_lee_keep(s->kept, (enum lod_lee_method)(method - (cells ? CELL_DISTANCE : 0)),
		cells ? &s->cells : &s->single, &view, budget, &s->leaves->arena);
	memset(s->used, 0, LOD_CELLS_MAX * sizeof *s->used);
	for (uint32_t i = 0; i < count; i++)
		s->chosen[i] = cells ? s->member[s->first[s->kept[i]] + s->used[s->kept[i]]++] : s->kept[i];
}

static struct lod_sights_drawing drawing_of(struct study *s, enum method method, const struct lod_eye *eye,
	uint32_t share, bool scaled, double scale)
{
	uint32_t budget = (uint32_t)((uint64_t)s->leaves->foliage.count * percent[share] / 100);
	struct lod_sights_drawing drawing = { .order = s->chosen, .count = budget, .scale = scaled
		? (float)scale
		: 1 };
	if (method >= STOCHASTIC)
		drawing.order = s->fixed[method][scaled];
	else
		keep(s, method, 0, eye, budget);
	if (scaled && s->growth[method]) {
		for (uint32_t i = 0; i < budget; i++)
			s->factor[drawing.order[i]] = eco_growth(s->growth[method][drawing.order[i]],
				(float)scale);
		drawing.factor = s->factor;
	}
	return drawing;
}

/* ---- Scales ---- */

static double wrong_at(struct study *s, enum method method, uint32_t share, double scale)
{
	struct bench_wrong sum = { 0 };
	for (uint32_t v = 0; v < s->tuning.count; v++) {
		struct lod_sights_drawing drawing = drawing_of(s, method, &s->tuning.eyes[v], share, true,
			scale);
		bench_leaves_compare(s->leaves, &s->tuning, v, &drawing, &sum);
	}
	return bench_wrong_share(&sum);
}

/* The best of steps of an octave, and then of half and a quarter of one beside it. */
static double best_scale(struct study *s, enum method method, uint32_t share)
{
	double best = 1, least = wrong_at(s, method, share, 1), next;
	for (double scale = 1.5; scale < SCALE_MOST; scale *= 2) {
		next = wrong_at(s, method, share, scale);
		if (next > 1.5 * least)
			break;
		best = next < least ? scale : best;
		least = fmin(next, least);
	}
	for (double step = 1.41421356; step > 1.1; step = sqrt(step)) {
		double middle = best;
		for (int way = 0; way < 2; way++) {
			double scale = fmax(1, way ? middle / step : middle * step);
			next = wrong_at(s, method, share, scale);
			best = next < least ? scale : best;
			least = fmin(next, least);
		}
	}
	return best;
}

static void tune_scales(struct study *s, enum method method)
{
	for (uint32_t share = 0; share < SHARES; share++)
		s->scale[method][share] = best_scale(s, method, share);
}

/* ---- Our lists for leaves as they are: greedy coverage ----
 *
 * Each time the leaf is next that covers most new pixels over all views, lazily. A pixel counts until LEVELS
 * leaves cover it, each time an eighth of its value before: between two of the pictures the leaf in front may
 * have moved. */

#define LEVELS 4
#define LEVEL_SHIFT 3

struct cover {
	const struct lod_foliage *foliage;
	const struct lod_sights *sights;
	uint64_t *covered[LEVELS];               /* masks of all views: covered by at least so many leaves,
		or by wood */
	struct lod_footprint *print;
};

/* The value of a leaf in all views; `add`: it is taken. */
static uint64_t cover_leaf(struct cover *c, uint32_t leaf, bool add)
{
	uint64_t sum = 0;
	uint32_t row_words = c->sights->words / c->sights->pixels;
	const struct lod_fan fan = lod_foliage_fan(c->foliage, leaf);
	for (uint32_t view = 0; view < c->sights->count; view++) {
		struct lod_fan_seen seen;
		lod_fan_see(&seen, &fan, &c->sights->eyes[view]);
		if (!lod_fan_cover(c->print, &seen, 1, c->sights->pixels))
			continue;
		for (uint32_t i = 0; i < c->print->rows * c->print->words; i++) {
			size_t at = (size_t)view * c->sights->words + (c->print->y + i / c->print->words)
				* row_words
				+ c->print->word + i % c->print->words;
			uint64_t left = c->print->bits[i];
			for (int level = 0; level < LEVELS && left; level++) {
				uint64_t again = left & c->covered[level][at];
				sum += (uint64_t)__builtin_popcountll(left & ~again) << LEVEL_SHIFT
					* (LEVELS - 1 - level);
				c->covered[level][at] |= add ? left : 0;
				left = again;
			}
		}
	}
	return sum;
}

static uint32_t *cover_order(struct study *s, const double (*directions)[3], uint32_t views)
{
	uint32_t count = s->leaves->foliage.count, *order = take(s, count, sizeof *order);
	struct lod_arena_piece *mark = s->leaves->arena.last;
	struct lod_sights sights;
	struct cover c = { .foliage = &s->leaves->foliage, .sights = &sights, .print = take(s, 1,
		sizeof *c.print) };
	struct lod_heap_item *heap = take(s, count, sizeof *heap);
	bench_leaves_sights(s->leaves, &sights, directions, views);
	for (int level = 0; level < LEVELS; level++) {
		c.covered[level] = take(s, (size_t)sights.words * views, sizeof(uint64_t));
		for (uint32_t v = 0; v < views; v++)
			memcpy(c.covered[level] + (size_t)v * sights.words, sights.wood[v],
				sights.words * sizeof(uint64_t));
	}
	for (uint32_t i = 0; i < count; i++)
		heap[i] = (struct lod_heap_item){ (double)cover_leaf(&c, i, false), i };
	lod_heap_make(heap, count);
	for (uint32_t left = count, picked = 0; left;) {
		double gain = (double)cover_leaf(&c, heap[0].id, false);
		if (gain == heap[0].key) {
			cover_leaf(&c, heap[0].id, true);
			order[picked++] = heap[0].id;
			heap[0] = heap[--left];
		} else {
			heap[0].key = gain;
		}
		lod_heap_sift(heap, left, 0);
	}
	lod_arena_release(&s->leaves->arena, mark);
	return order;
}

/* A method's two lists: for leaves as they are from `cover`, for scaled ones from `rank` (NULL: from the
 * views that packs are made with). */
static void make_lists(struct study *s, enum method method, const double (*cover)[3], uint32_t covers,
	const double (*rank)[3], uint32_t ranks)
{
	struct lod_rank made;
	s->fixed[method][0] = cover_order(s, cover, covers);
	must(lod_rank_make(&made, &s->leaves->foliage, &(struct lod_rank_options){ .views = ranks,
		.directions = rank, .seed = 3, .wrong_pixels = true, .from_share = SHARE_LEAST },
		&s->leaves->arena, must_error));
	s->fixed[method][1] = made.order;
	s->growth[method] = made.growth;
}

/* ---- Measuring ---- */

/* As lod_directions_spread, whose heights from -0.2 to 0.95 become those of a cap, inside a cone of half
 * angle `cone_rad` around `axis`. */
static void cone_views(double (*directions)[3], uint32_t count, const double axis[3], double cone_rad,
	uint32_t seed)
{
	struct lod_v3 along = lod_v3_unit((struct lod_v3){ axis[0], axis[1], axis[2] });
	struct lod_v3 other = fabs(along.z) < 0.9 ? (struct lod_v3){ 0, 0, 1 } : (struct lod_v3){ 1, 0, 0 };
	struct lod_v3 u = lod_v3_unit(lod_v3_cross(along, other)), v = lod_v3_cross(along, u);
	lod_directions_spread(directions, count, seed);
	for (uint32_t i = 0; i < count; i++) {
		double *d = directions[i], z = 1 - (1 - cos(cone_rad)) * (d[2] + 0.2) / 1.15,
			turn = sqrt(fmax(0, 1 - z * z)) / hypot(d[0], d[1]);
		struct lod_v3 at = lod_v3_add(lod_v3_scale(along, z),
			lod_v3_add(lod_v3_scale(u, turn * d[0]), lod_v3_scale(v, turn * d[1])));
		d[0] = at.x;
		d[1] = at.y;
		d[2] = at.z;
	}
}

/* Owners of pixels: leaves as they are, over whole wood. NULL draws all. */
static void draw_ids(struct study *s, uint32_t view, const struct lod_sights_drawing *drawing)
{
	const struct lod_foliage *f = &s->leaves->foliage;
	lod_raster_clear(&s->ids);
	lod_raster_camera(&s->ids, &s->tests.eyes[view], s->tests.near_m);
	lod_raster_object(&s->ids, &(struct lod_place){ .cosine = 1, .scale = 1 });
	lod_raster_triangles(&s->ids, &(struct lod_raster_batch){ .count = (uint32_t)f->wood_count,
		.position = f->wood, .owner = UINT64_C(1) << 40 });
	for (uint32_t k = 0; k < (drawing ? drawing->count : f->count); k++) {
		uint32_t i = drawing ? drawing->order[k] : k, at = f->first[i];
		for (uint32_t t = 1; t + 1 < f->first[i + 1] - at; t++) {
			const uint32_t corner[3] = { at, at + t, at + t + 1 };
			float position[9], uv[6];
			for (int c = 0; c < 3; c++) {
				memcpy(position + 3 * c, f->corner[corner[c]], 3 * sizeof *position);
				memcpy(uv + 2 * c, f->uv[corner[c]], 2 * sizeof *uv);
			}
			lod_raster_triangles(&s->ids, &(struct lod_raster_batch){ .count = 1,
				.position = position, .uv = uv, .cutout = f->cutout[i], .owner = i + 1 });
		}
	}
}

static void measure(struct study *s, enum method method, uint32_t view, const uint64_t *reference)
{
	for (uint32_t share = 0; share < SHARES; share++)
		for (int scaled = 0; scaled < 2; scaled++) {
			struct lod_sights_drawing drawing = drawing_of(s, method, &s->tests.eyes[view], share,
				scaled, s->scale[method][share]);
			bench_leaves_compare(s->leaves, &s->tests, view, &drawing,
				&s->wrong[method][share][scaled]);
			if (scaled)
				continue;
			draw_ids(s, view, &drawing);
			for (size_t i = 0; i < (size_t)PIXELS * PIXELS; i++)
				s->other[method][share] += s->ids.owner[i] != reference[i];
		}
}

static bool per_view(enum method method) { return method <= LAYER || method == SECTOR; }

static void measure_view(struct study *s, size_t width, uint32_t view)
{
	struct lod_arena_piece *mark = s->leaves->arena.last;
	size_t pixels = (size_t)PIXELS * PIXELS;
	uint64_t *reference = take(s, pixels, sizeof *reference);
	draw_ids(s, view, NULL);
	memcpy(reference, s->ids.owner, pixels * sizeof *reference);
	s->shown += s->tests.reference_pixels[view];
	for (enum method m = 0; m < METHODS; m++)
		if (width == 0 || per_view(m))
			measure(s, m, view, reference);
	lod_arena_release(&s->leaves->arena, mark);
}

/* One sector: its own lists, then methods in test views in it. */
static void measure_sector(struct study *s, size_t width, const double axis[3], uint32_t sector,
	uint32_t views)
{
	double build[VIEWS_MOST][3], test[VIEWS_MOST][3], tuning[TUNING_VIEWS][3];
	const double (*from)[3] = (const double (*)[3])build;
	double cone = widths[width].degrees / 2 * LOD_PI / 180;
	uint32_t count = widths[width].build_views;
	struct lod_arena_piece *mark = s->leaves->arena.last;
	cone_views(build, count, axis, cone, 3 * sector);
	cone_views(test, views, axis, cone, 3 * sector + 1);
	cone_views(tuning, TUNING_VIEWS, axis, cone, 3 * sector + 2);
	make_lists(s, SECTOR, from, count, from, count);
	bench_leaves_sights(s->leaves, &s->tuning, (const double (*)[3])tuning, TUNING_VIEWS);
	bench_leaves_sights(s->leaves, &s->tests, (const double (*)[3])test, views);
	for (enum method m = 0; m < METHODS; m++)
		if (per_view(m))
			tune_scales(s, m);
	for (uint32_t view = 0; view < views; view++)
		measure_view(s, width, view);
	lod_arena_release(&s->leaves->arena, mark);
}

static void measure_table(struct study *s)
{
	double axes[SECTORS_MOST][3], around[STATIC_VIEWS][3];
	lod_directions_spread(around, STATIC_VIEWS, 3);
	make_lists(s, STATIC, (const double (*)[3])around, STATIC_VIEWS, NULL, 0);
	bench_leaves_look(s->leaves, &s->tuning, TUNING_VIEWS, 501);
	for (enum method m = CELL_DISTANCE; m <= STATIC; m++)        /* of one scale for all views */
		tune_scales(s, m);
	for (size_t width = 0; width < WIDTHS; width++) {
		uint32_t sectors = s->bench->full ? SECTORS_MOST : width ? 1 : 4;
		memset(s->wrong, 0, sizeof s->wrong);
		memset(s->other, 0, sizeof s->other);
		s->shown = 0;
		lod_directions_spread(axes, sectors, 77);
		for (uint32_t i = 0; i < sectors; i++) {
			measure_sector(s, width, axes[i], i, s->bench->full ? 4 : 2);
		}
		for (uint32_t i = 0; i < METHODS * SHARES; i++) {
			uint32_t m = i / SHARES, share = i % SHARES;
			s->made.table[width][m][WRONG][share] = bench_wrong_share(&s->wrong[m][share][0]);
			s->made.table[width][m][SCALED_WRONG][share]
				= bench_wrong_share(&s->wrong[m][share][1]);
			s->made.table[width][m][OTHER_LEAF][share]
				= (double)s->other[m][share] / (double)s->shown;
		}
	}
}

/* ---- The number of layers, and what wrong pixels are a share of ---- */

static struct lod_sights_drawing layer_drawing(struct study *s, enum method method, uint32_t layer_count,
	uint32_t of_100, uint32_t view)
{
	uint32_t budget = (uint32_t)((uint64_t)s->leaves->foliage.count * of_100 / 100);
	keep(s, method, layer_count, &s->tests.eyes[view], budget);
	return (struct lod_sights_drawing){ .order = s->chosen, .count = budget, .scale = 1 };
}

static void measure_row(struct study *s, enum method method, uint32_t layer_count, double row[2 * SHARES])
{
	for (uint32_t share = 0; share < SHARES; share++) {
		struct bench_wrong sum = { 0 };
		for (uint32_t v = 0; v < LAYER_VIEWS; v++) {
			const struct lod_sights_drawing drawing = layer_drawing(s, method, layer_count,
				percent[share], v);
			bench_leaves_compare(s->leaves, &s->tests, v, &drawing, &sum);
		}
		row[share] = bench_wrong_share(&sum);
		row[SHARES + share] = (double)(sum.fp + sum.fn) / ((double)LAYER_VIEWS * PIXELS * PIXELS);
	}
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

static void draw_figure_2(struct study *s)
{
	uint8_t *rgb = take(s, (size_t)COLUMNS * PIXELS * PIXELS, 3);
	draw_into(s, NULL, 0, rgb);
	for (uint32_t i = 0; i < COLUMNS - 1; i++) {
		const struct lod_sights_drawing drawing = layer_drawing(s, (enum method)(i % 3), 0, i < 3
			? 50 : 30, SHOWN);
		draw_into(s, &drawing, i + 1, rgb);
	}
	bench_picture_write(s->bench, "lee-figure-2.png", COLUMNS * PIXELS, PIXELS, rgb);
}

static json_t *study_leaves(void *ctx, struct bench_leaves *leaves)
{
	struct study *s = ctx;
	s->leaves = leaves;
	for (enum method m = STOCHASTIC; m <= COMBINED; m++)
		s->fixed[m][0] = s->fixed[m][1] = bench_leaves_order(leaves, m == STOCHASTIC
			? LOD_ORDER_STOCHASTIC : LOD_ORDER_COMBINED, 0);
	make_cells(s);
	lod_raster_init(&s->ids, &(struct lod_raster_options){ .width = PIXELS, .height = PIXELS,
		.owner = true });
	measure_table(s);
	bench_leaves_look(leaves, &s->tests, LAYER_VIEWS, LAYER_SEED);
	draw_figure_2(s);
	for (uint32_t row = 0; row < LAYER + LAYERS; row++)
		measure_row(s, row < LAYER ? (enum method)row : LAYER, row < LAYER ? 0 : layers[row - LAYER],
			s->made.layers[row]);
	lod_raster_free(&s->ids);
	return bench_reals((const double *)&s->made, sizeof s->made / sizeof(double));
}

/* ---- Tables ---- */

static void write_table(struct bench *bench, const struct figures *f)
{
	double x[SHARES], y[METHODS][SHARES];
	struct bench_series series[METHODS];
	uint32_t count = 0;
	struct bench_table *table = bench_table_open(bench, "lee_crown",
		"crown of 6143 leaves: wrong %,at 80 %,at 50 %,at 30 %,at 10 %,scaled: at 80 %,"
		"scaled: at 50 %,scaled: at 30 %,scaled: at 10 %,other leaf: at 80 %,other leaf: at 50 "
		"%,other leaf: at 30 %,other leaf: at 10 %", true);
	for (uint32_t row = 0; row <= METHODS; row++) {
		uint32_t method = row < METHODS ? row : SECTOR;
		char text[256];
		int at = snprintf(text, sizeof text, "%s%s", names[method], row < METHODS ? ""
			: " (12 degrees)");
		for (uint32_t i = 0; i < FIGURES * SHARES; i++)
			at += snprintf(text + at, sizeof text - (size_t)at, ",%.1f",
				100 * f->table[row == METHODS][method][i / SHARES][i % SHARES]);
		bench_table_row(table, "%s", text);
		if ((row >= CELL_DISTANCE && row <= CELL_LAYER) || row == METHODS)
			continue;
		for (uint32_t share = 0; share < SHARES; share++) {
			x[share] = percent[share];
			y[row][share] = 100 * f->table[0][row][WRONG][share];
		}
		series[count++] = (struct bench_series){ names[row], x, y[row], SHARES, false };
	}
	bench_table_close(table);
	bench_plot(bench, &(struct bench_plot){ .name = "lee-crown",
		.title = "Crown of 6,143 leaves, unscaled", .x = "leaves kept, %",
		.y = "wrong pixels, % of the reference", .series = series, .series_count = count });
}

static void write_layers(struct bench *bench, const struct figures *f)
{
	bench_head(bench, "Layers, and shares of what");
	struct bench_table *table = bench_table_open(bench, "lee_layers",
		"method,G,80 %,50 %,30 %,10 %,of the picture: 80 %,50 % of it,30 % of it,10 % of it", true);
	bench_table_row(table, "%s", "distance (printed),-,3.03,9.09,14.03,18.42,-,-,-,-");
	bench_table_row(table, "%s", "normal (printed),-,5.31,12.87,16.49,19.13,-,-,-,-");
	bench_table_row(table, "%s", "layer+normal (printed),not said,2.86,10.06,15.07,18.75,-,-,-,-");
	for (size_t row = 0; row < LAYER + LAYERS; row++) {
		char text[256], count[16] = "-";
		if (row >= LAYER)
			snprintf(count, sizeof count, "%u", layers[row - LAYER]);
		int at = snprintf(text, sizeof text, "%s,%s", names[row < LAYER ? row : LAYER], count);
		for (size_t i = 0; i < 2 * SHARES; i++)
			at += snprintf(text + at, sizeof text - (size_t)at, ",%.2f",
				100 * f->layers[row][i]);
		bench_table_row(table, "%s", text);
	}
	bench_table_close(table);
	bench_picture(bench, "lee-figure-2.png", "All leaves; distance, normal and layer+normal with 50 % "
		"of the leaves; the same with 30 %");
	bench_say(bench, "Leaves as they are, %u views of %u pixels. Printed figures stay below 20 %% where "
		"a tenth of the leaves is left: no share of the reference's pixels, whose greater part is "
		"missing then, but about the share of a picture that the tree does not fill.", LAYER_VIEWS,
			PIXELS);
}

static void run(struct bench *bench)
{
	struct figures f;
	struct study s = { .bench = bench };
	bench_progress(bench, 0, "crown of 6143 leaves");
	bench_cells(bench_leaves_unit(bench, "lee-crown-6143", NULL, NULL, PIXELS, study_leaves, &s),
		(double *)&f, sizeof f / sizeof(double));
	write_table(bench, &f);
	write_layers(bench, &f);
}

const struct bench_section bench_lee = { "lee", "Which leaves to keep: Lee's orders and ours", run };
