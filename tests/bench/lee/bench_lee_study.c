/* See bench_lee_study.h.
 *
 * Scales are those that suit a method best on other views than those of the measurement and of the making:
 * around the plant for one list, in the sector for lists per sector and for Lee's orders leaf by leaf, which
 * are made anew for each view. */
#include "tests/bench/lee/bench_lee_study.h"

#include <math.h>
#include <string.h>

#include "ecofiles/format/list.h"
#include "lod/build/cell.h"
#include "lod/build/order/cover.h"
#include "lod/build/order/rank.h"
#include "tests/bench/baseline/lee.h"
#include "tests/bench/bench_leaves.h"
#include "tests/support/cone_views.h"

#define LEAVES_LEAST 1000u
#define PIXELS 256u
#define SECTOR_VIEWS_MOST 24u
#define STATIC_VIEWS 96u         /* that the one list is */
#define TUNING_VIEWS 4u
#define SECTORS_MOST 64u
#define VIEWS_MOST 16u
#define LEAF_PIXELS 2            /* lists are built from larger pictures where leaves would be smaller */
#define CELLS 32u                /* about so many share a plant's leaves */
#define SCALE_MOST 128.0
/* of the leaves: what shorter prefixes of the lists for scaled leaves show is not looked at */
#define SHARE_LEAST 0.08

const uint32_t bench_lee_percent[LEE_SHARES] = { 80, 50, 30, 10 };
const double bench_lee_degrees[LEE_WIDTHS] = { 1.5, 12 };
/* That a sector's lists are built from. More make short lists worse: an aspen's over Lee's best at 80, 50, 30
 * and 10 %, scaled, .09 .46 .48 .585 with 16, .08 .45 .49 .59 with 48. */
static const uint32_t sector_views[LEE_WIDTHS] = { 16, SECTOR_VIEWS_MOST };
const char *const bench_lee_methods[LEE_METHODS] = { "distance", "normal", "layer+normal", "distance (cells)",
	"normal (cells)",
	"layer+normal (cells)", "stochastic", "combined", "our list", "our lists per sector" };

struct tally {                           /* of one method: leaves as they are, and scaled */
	struct bench_wrong wrong[LEE_SHARES][2];
	uint64_t other[LEE_SHARES][2];           /* pixels of another leaf */
	double scales[LEE_SHARES];               /* sum over views */
};
struct study {
	struct bench *bench;
	struct bench_leaves leaves;
	struct lod_lee_group *single, *cells;
	uint32_t cell_count, **cell_member, budget[LEE_SHARES];
	uint32_t *fixed[LEE_METHODS][2];         /* orders that do not depend on the view: unscaled, scaled */
	uint8_t *growth[LEE_METHODS];
	uint32_t *kept, *chosen;
	float *factor;
	struct lod_sights tests, tuning;
	double scale[LEE_METHODS][LEE_SHARES];
	enum bench_lee_width width;              /* of the sectors now */
	struct tally tally[LEE_WIDTHS][LEE_METHODS];
	uint64_t shown[LEE_WIDTHS];              /* pixels of the reference */
	uint32_t measured[LEE_WIDTHS];           /* views */
};

/* ---- Which leaves ---- */

static void make_baselines(struct study *s)
{
	for (int m = LEE_STOCHASTIC; m <= LEE_COMBINED; m++)
		s->fixed[m][0] = s->fixed[m][1] = bench_leaves_order(&s->leaves, m == LEE_STOCHASTIC
			? LOD_ORDER_STOCHASTIC : LOD_ORDER_COMBINED, 0);
}

static void make_groups(struct study *s)
{
	const struct lod_foliage *f = &s->leaves.foliage;
	struct lod_arena *arena = &s->leaves.arena;
	struct lod_cells cells;
	uint32_t *one = lod_arena_take(arena, f->count, sizeof *one);
	s->single = lod_arena_take(arena, f->count, sizeof *s->single);
	s->cells = lod_arena_take(arena, LOD_CELLS_MAX, sizeof *s->cells);
	s->cell_member = lod_arena_take(arena, LOD_CELLS_MAX, sizeof *s->cell_member);
	for (uint32_t i = 0; i < f->count; i++) {
		lod_lee_group_make(&s->single[i], f->center, f->normal, &i, 1);
		one[i] = 1;
	}
	lod_cells_make(&cells, &(struct lod_cells_input){ f->low, f->high, f->count, f->center, one,
		f->count / CELLS + 1 });
	s->cell_count = cells.count ? cells.count : 1;
	for (uint32_t c = 0; c < s->cell_count; c++) {
		uint32_t count = 0;
		s->cell_member[c] = lod_arena_take(arena, f->count, sizeof(uint32_t));
		for (uint32_t i = 0; i < f->count; i++) {        /* in stochastic order */
			uint32_t leaf = s->fixed[LEE_STOCHASTIC][0][i];
			if ((cells.count ? lod_cells_at(&cells, f->center[leaf]) : 0) == c)
				s->cell_member[c][count++] = leaf;
		}
		lod_lee_group_make(&s->cells[c], f->center, f->normal, s->cell_member[c], count);
	}
}

/* The leaves that a method keeps in a view. Borrowed until the next call. */
static const uint32_t *choose(struct study *s, enum bench_lee_method method, const struct lod_eye *eye,
	uint32_t budget, bool scaled)
{
	if (method >= LEE_STOCHASTIC)
		return s->fixed[method][scaled];
	const struct lod_lee_view view = { { eye->at[0], eye->at[1], eye->at[2] },
		{ eye->forward[0], eye->forward[1], eye->forward[2] }, 0 };
	bool cells = method >= LEE_CELL_DISTANCE;
	uint32_t groups = cells ? s->cell_count : s->leaves.foliage.count, count = 0;
	lod_lee_keep(s->kept, (enum lod_lee_method)(method - (cells ? LEE_CELL_DISTANCE : 0)),
		cells ? s->cells : s->single, groups, &view, budget, &s->leaves.arena);
	for (uint32_t g = 0; g < groups; g++)
		for (uint32_t i = 0; i < s->kept[g]; i++)
			s->chosen[count++] = cells ? s->cell_member[g][i] : g;
	return s->chosen;
}

static struct lod_sights_drawing drawing_of(struct study *s, enum bench_lee_method method,
	const struct lod_eye *eye, uint32_t share, bool scaled, double scale)
{
	uint32_t budget = s->budget[share];
	struct lod_sights_drawing drawing = { .order = choose(s, method, eye, budget, scaled),
		.count = budget, .scale = scaled ? (float)scale : 1 };
	if (scaled && s->growth[method]) {
		for (uint32_t i = 0; i < budget; i++)
			s->factor[drawing.order[i]] = eco_growth(s->growth[method][drawing.order[i]],
				(float)scale);
		drawing.factor = s->factor;
	}
	return drawing;
}

/* ---- Scales ---- */

static double wrong_at(struct study *s, enum bench_lee_method method, uint32_t share, double scale)
{
	struct bench_wrong sum = { 0 };
	for (uint32_t v = 0; v < s->tuning.count; v++) {
		struct lod_sights_drawing drawing = drawing_of(s, method, &s->tuning.eyes[v], share, true,
			scale);
		bench_leaves_compare(&s->leaves, &s->tuning, v, &drawing, &sum);
	}
	return bench_wrong_share(&sum);
}

/* The best of steps of an octave, and then of half and a quarter of one beside it. */
static double best_scale(struct study *s, enum bench_lee_method method, uint32_t share)
{
	double best = 1, least = wrong_at(s, method, share, 1), next;
	for (double scale = 1.5; scale < SCALE_MOST; scale *= 2) {
		next = wrong_at(s, method, share, scale);
		if (next < least) {
			least = next;
			best = scale;
		} else if (next > 1.5 * least) {
			break;
		}
	}
	for (double step = 1.41421356; step > 1.1; step = sqrt(step)) {
		double middle = best;
		for (int way = 0; way < 2; way++) {
			double scale = fmax(1, way ? middle / step : middle * step);
			if ((next = wrong_at(s, method, share, scale)) < least) {
				least = next;
				best = scale;
			}
		}
	}
	return best;
}

static void tune_scales(struct study *s, enum bench_lee_method method)
{
	for (uint32_t share = 0; share < LEE_SHARES; share++)
		s->scale[method][share] = best_scale(s, method, share);
}

/* ---- Measuring ---- */

static uint64_t count_other(struct study *s, uint32_t view, const struct lod_sights_drawing *drawing,
	const uint64_t *reference)
{
	size_t pixels = (size_t)PIXELS * PIXELS;
	uint64_t other = 0;
	bench_leaves_ids(&s->leaves, &s->tests, view, drawing);
	for (size_t i = 0; i < pixels; i++)
		other += s->leaves.ids.owner[i] != reference[i];
	return other;
}

static void measure(struct study *s, enum bench_lee_method method, uint32_t view, const uint64_t *reference)
{
	struct tally *t = &s->tally[s->width][method];
	for (uint32_t share = 0; share < LEE_SHARES; share++) {
		t->scales[share] += s->scale[method][share];
		for (int scaled = 0; scaled < 2; scaled++) {
			struct lod_sights_drawing drawing = drawing_of(s, method, &s->tests.eyes[view], share,
				scaled, s->scale[method][share]);
			bench_leaves_compare(&s->leaves, &s->tests, view, &drawing, &t->wrong[share][scaled]);
			t->other[share][scaled] += count_other(s, view, &drawing, reference);
		}
	}
}

/* ---- Ours ---- */

/* The size of pictures to build from. Smaller leaves than pixels come and go by chance between the views. */
static uint32_t build_pixels(const struct lod_foliage *f)
{
	double sum = 0, side = lod_v3_distance(f->low, f->high);
	for (uint32_t i = 0; i < f->count; i++)
		sum += f->area[i];
	return sum / f->count * PIXELS * PIXELS < LEAF_PIXELS * side * side ? 2 * PIXELS : PIXELS;
}

struct list_views { const double (*cover)[3]; uint32_t covers; const double (*rank)[3]; uint32_t ranks,
	pixels; };

/* A method's two lists: for leaves as they are, and for scaled ones (`rank` NULL: from the views that packs
 * are made with). */
static enum eco_code make_lists(struct study *s, enum bench_lee_method method, const struct list_views *from,
	struct eco_error *error)
{
	const struct lod_foliage *f = &s->leaves.foliage;
	struct lod_arena *arena = &s->leaves.arena;
	struct lod_rank rank;
	s->fixed[method][0] = lod_arena_take(arena, f->count, sizeof(uint32_t));
	enum eco_code code = lod_cover_order(s->fixed[method][0], f,
		&(struct lod_cover_options){ .directions = from->cover,
		.views = from->covers, .pixels = from->pixels }, arena, error);
	if (!code)
		code = lod_rank_make(&rank, f,
			&(struct lod_rank_options){ .views = from->ranks, .directions = from->rank, .seed = 3,
			.wrong_pixels = true, .from_share = SHARE_LEAST }, arena, error);
	if (!code) {
		s->fixed[method][1] = rank.order;
		s->growth[method] = rank.growth;
	}
	return code;
}

static enum eco_code sights_around(struct study *s, struct lod_sights *sights, const double (*directions)[3],
	uint32_t count, struct eco_error *error)
{
	return lod_sights_make(sights, &s->leaves.foliage, directions, count, PIXELS, &s->leaves.arena,
		error);
}

/* ---- Sectors ---- */

static bool per_view(enum bench_lee_method method)
{
	return method <= LEE_LAYER || method == LEE_SECTOR;
}

static void measure_view(struct study *s, uint32_t view)
{
	struct lod_arena_piece *mark = s->leaves.arena.last;
	size_t pixels = (size_t)PIXELS * PIXELS;
	uint64_t *reference = lod_arena_take(&s->leaves.arena, pixels, sizeof *reference);
	bench_leaves_ids(&s->leaves, &s->tests, view, NULL);
	memcpy(reference, s->leaves.ids.owner, pixels * sizeof *reference);
	s->shown[s->width] += s->tests.reference_pixels[view];
	s->measured[s->width]++;
	for (int m = 0; m < LEE_METHODS; m++)
		if (s->width == LEE_NARROW || per_view((enum bench_lee_method)m))
			measure(s, (enum bench_lee_method)m, view, reference);
	lod_arena_release(&s->leaves.arena, mark);
}

/* One sector: its own lists, then methods on test views in it. */
static enum eco_code measure_sector(struct study *s, const double axis[3], uint32_t sector, uint32_t views,
	struct eco_error *error)
{
	double build[SECTOR_VIEWS_MOST][3], test[VIEWS_MOST][3], tuning[TUNING_VIEWS][3];
	double cone = bench_lee_degrees[s->width] / 2 * LOD_PI / 180;
	uint32_t from = sector_views[s->width];
	struct lod_arena_piece *mark = s->leaves.arena.last;
	cone_views(build, from, axis, cone, 3 * sector);
	cone_views(test, views, axis, cone, 3 * sector + 1);
	cone_views(tuning, TUNING_VIEWS, axis, cone, 3 * sector + 2);
	enum eco_code code =
		make_lists(s, LEE_SECTOR,
		&(struct list_views){ (const double (*)[3])build, from, (const double (*)[3])build, from,
		build_pixels(&s->leaves.foliage) }, error);
	if (!code)
		code = sights_around(s, &s->tuning, (const double (*)[3])tuning, TUNING_VIEWS, error);
	if (!code)
		code = sights_around(s, &s->tests, (const double (*)[3])test, views, error);
	for (int m = 0; m < LEE_METHODS && !code; m++)
		if (per_view((enum bench_lee_method)m))
			tune_scales(s, (enum bench_lee_method)m);
	for (uint32_t view = 0; view < views && !code; view++)
		measure_view(s, view);
	lod_arena_release(&s->leaves.arena, mark);
	return code;
}

/* ---- One list ---- */

static enum eco_code make_static(struct study *s, struct eco_error *error)
{
	double tuning[TUNING_VIEWS][3], around[STATIC_VIEWS][3];
	lod_directions_spread(tuning, TUNING_VIEWS, 501);
	lod_directions_spread(around, STATIC_VIEWS, 3);
	enum eco_code code =
		make_lists(s, LEE_STATIC,
		&(struct list_views){ (const double (*)[3])around, STATIC_VIEWS, NULL, 0,
		build_pixels(&s->leaves.foliage) }, error);
	if (!code)
		code = sights_around(s, &s->tuning, (const double (*)[3])tuning, TUNING_VIEWS, error);
	for (int m = LEE_CELL_DISTANCE; m <= LEE_STATIC && !code; m++)
		tune_scales(s, (enum bench_lee_method)m);
	return code;
}

static enum eco_code run_study(struct study *s, const struct bench_lee_extent *extent,
	struct eco_error *error)
{
	struct lod_arena *arena = &s->leaves.arena;
	uint32_t count = s->leaves.foliage.count;
	double axes[SECTORS_MOST][3];
	s->kept = lod_arena_take(arena, count, sizeof *s->kept);
	s->chosen = lod_arena_take(arena, count, sizeof *s->chosen);
	s->factor = lod_arena_take(arena, count, sizeof *s->factor);
	for (uint32_t share = 0; share < LEE_SHARES; share++)
		s->budget[share] = (uint32_t)((uint64_t)count * bench_lee_percent[share] / 100);
	make_baselines(s);
	make_groups(s);
	enum eco_code code = make_static(s, error);
	for (int width = 0; width < LEE_WIDTHS; width++) {
		s->width = (enum bench_lee_width)width;
		lod_directions_spread(axes, extent->sectors[width], 77);
		for (uint32_t i = 0; i < extent->sectors[width] && !code; i++)
			code = bench_stopped(s->bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted")
				: measure_sector(s, axes[i], i, extent->views, error);
	}
	return code;
}

/* ---- Result ---- */

/* Cones that cover all directions which lod_directions_spread gives, as a honeycomb does. */
static double lists_of(double degrees)
{
	double sphere = 1.15 / 2, cone = (1 - cos(degrees / 2 * LOD_PI / 180)) / 2;
	return ceil(1.2092 * sphere / cone);
}

static json_t *methods_of(const struct study *s, int width)
{
	json_t *methods = json_array();
	double shown = s->shown[width] ? (double)s->shown[width] : 1, views = s->measured[width]
		? s->measured[width] : 1;
	for (int m = 0; m < LEE_METHODS; m++) {
		const struct tally *t = &s->tally[width][m];
		json_t *rows = json_array();
		for (uint32_t share = 0; share < LEE_SHARES; share++)
			json_array_append_new(rows,
				json_pack("[fffff]", bench_wrong_share(&t->wrong[share][0]),
				(double)t->other[share][0] / shown, t->scales[share] / views,
				bench_wrong_share(&t->wrong[share][1]), (double)t->other[share][1] / shown));
		json_array_append_new(methods, rows);
	}
	return methods;
}

static json_t *result(const struct study *s)
{
	json_t *widths = json_array(), *lists = json_array();
	for (int width = 0; width < LEE_WIDTHS; width++) {
		json_array_append_new(widths, methods_of(s, width));
		json_array_append_new(lists, json_real(lists_of(bench_lee_degrees[width])));
	}
	return json_pack("{sisisoso}", "leaves", (int)s->leaves.foliage.count, "cells", (int)s->cell_count,
		"widths", widths, "lists", lists);
}

enum eco_code bench_lee_study(struct bench *bench, struct eco_model *model,
	const struct bench_lee_extent *extent, json_t **out, struct eco_error *error)
{
	struct study *s = calloc(1, sizeof *s);
	*out = NULL;
	if (!s) {
		eco_model_free(model);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a study of leaves");
	}
	s->bench = bench;
	enum eco_code code = bench_leaves_open(&s->leaves, model, PIXELS, error);
	if (!code) {
		if (setjmp(s->leaves.arena.failed))
			code = eco_fail(error, ECO_NO_MEMORY, "no memory for orders of %u leaves",
				s->leaves.foliage.count);
		else if (s->leaves.foliage.count >= LEAVES_LEAST)
			code = run_study(s, extent, error);
		if (!code)
			*out = result(s);
		bench_leaves_close(&s->leaves);
	}
	free(s);
	return code;
}
