/* Lee's table: which leaves to keep under a budget, seen from where the orders were not made for.
 *
 * For a generated crown of 6,143 leaves, as many as Lee's, and models of at least 1,000 (the quick bench takes a few of the data folder's):
 * pixels that are wrong against the picture with all leaves, over the pixels of that picture (wood is whole in both), and pixels that show
 * another leaf. Lee draws leaves as they are; beside it stands the same with leaves scaled, each method by what suits it best on other
 * views. What greedy coverage of the very picture reaches says how much there is to gain.
 *
 * Views lie in cones 12 degrees wide around directions all over the upper sphere. Lists per sector of view are built from 48 directions in
 * a cone and tested with others in it; one static list is built from directions all around. Lee's orders are made anew for each view. */
#include <math.h>
#include <string.h>

#include "ecofiles/list.h"
#include "lod/cell.h"
#include "lod/cover.h"
#include "lod/lee.h"
#include "lod/order.h"
#include "lod/rank.h"
#include "lod/sort.h"
#include "tests/bench/bench.h"
#include "tests/bench/bench_crown.h"
#include "tests/bench/bench_leaves.h"

#define LEAVES_LEAST 1000u
#define MODELS_QUICK 6u          /* of the data folder's, in the quick bench: those with the fewest leaves */
#define PIXELS 256u
#define CONE_RAD (6 * LOD_PI / 180)
#define SECTOR_VIEWS 48u         /* that a sector's list is built from */
#define RANK_VIEWS 24u           /* the same for scaled leaves */
#define STATIC_VIEWS 96u         /* that the one list is */
#define LEAF_PIXELS 8            /* lists are built from larger pictures where leaves would be smaller */
#define CELLS 32u                /* about so many share a plant's leaves */

enum { SHARES = 4 };
static const uint32_t share_percent[SHARES] = { 80, 50, 30, 10 };

enum method { DISTANCE, NORMAL, LAYER, CELL_DISTANCE, CELL_NORMAL, CELL_LAYER, STOCHASTIC, COMBINED, STATIC, SECTOR, BOUND, METHODS };
static const char *const method_names[METHODS] = { "distance", "normal", "layer+normal", "distance (cells)", "normal (cells)",
	"layer+normal (cells)", "stochastic", "combined", "our list", "our lists per sector", "greedy in the view itself" };

struct study {
	struct bench *bench;
	struct bench_leaves leaves;
	struct lod_lee_group *single, *cells;
	uint32_t cell_count, **cell_member;
	uint32_t *fixed[METHODS][2];         /* orders that do not depend on the view: unscaled, scaled */
	uint8_t *growth[METHODS];
	uint32_t *kept, *chosen;
	float *factor;
	struct lod_sights tests, tuning;
	double scale[METHODS][SHARES];
	struct bench_wrong wrong[METHODS][SHARES][2];
	uint64_t other[METHODS][SHARES][2], shown;       /* pixels of another leaf; of the reference */
};

/* ---- Which leaves ---- */

static void sort_by(uint32_t *order, const double *survival, uint32_t count, struct lod_arena *arena)
{
	struct lod_arena_piece *mark = arena->last;
	struct lod_keyed *items = lod_arena_take(arena, count, sizeof *items);
	for (uint32_t i = 0; i < count; i++)
		items[i] = (struct lod_keyed){ lod_sort_key(-survival[i]), i };
	lod_sort(arena, items, count);
	for (uint32_t i = 0; i < count; i++)
		order[i] = items[i].value;
	lod_arena_release(arena, mark);
}

static void make_baselines(struct study *s)
{
	const struct lod_foliage *f = &s->leaves.foliage;
	struct lod_arena *arena = &s->leaves.arena;
	double *survival = lod_arena_take(arena, f->count, sizeof *survival);
	const struct lod_order_input input = { f->count, f->center, f->normal, f->high.z - f->low.z, 1 };
	for (int m = STOCHASTIC; m <= COMBINED; m++) {
		lod_order_survival_by(survival, m == STOCHASTIC ? LOD_ORDER_STOCHASTIC : LOD_ORDER_COMBINED, &input, arena);
		s->fixed[m][0] = s->fixed[m][1] = lod_arena_take(arena, f->count, sizeof(uint32_t));
		sort_by(s->fixed[m][0], survival, f->count, arena);
	}
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
	lod_cells_make(&cells, &(struct lod_cells_input){ f->low, f->high, f->count, f->center, one, f->count / CELLS + 1 });
	s->cell_count = cells.count ? cells.count : 1;
	for (uint32_t c = 0; c < s->cell_count; c++) {
		uint32_t count = 0;
		s->cell_member[c] = lod_arena_take(arena, f->count, sizeof(uint32_t));
		for (uint32_t i = 0; i < f->count; i++) {        /* in stochastic order */
			uint32_t leaf = s->fixed[STOCHASTIC][0][i];
			if ((cells.count ? lod_cells_at(&cells, f->center[leaf]) : 0) == c)
				s->cell_member[c][count++] = leaf;
		}
		lod_lee_group_make(&s->cells[c], f->center, f->normal, s->cell_member[c], count);
	}
}

/* The leaves that a method keeps in a view. Borrowed until the next call. */
static const uint32_t *choose(struct study *s, enum method method, const struct lod_eye *eye, uint32_t budget, bool scaled)
{
	if (method >= STOCHASTIC)
		return s->fixed[method][scaled];
	const struct lod_lee_view view = { { eye->at[0], eye->at[1], eye->at[2] }, { eye->forward[0], eye->forward[1], eye->forward[2] }, 0 };
	bool cells = method >= CELL_DISTANCE;
	uint32_t groups = cells ? s->cell_count : s->leaves.foliage.count, count = 0;
	lod_lee_keep(s->kept, (enum lod_lee_method)(method - (cells ? CELL_DISTANCE : 0)), cells ? s->cells : s->single, groups, &view, budget,
		&s->leaves.arena);
	for (uint32_t g = 0; g < groups; g++)
		for (uint32_t i = 0; i < s->kept[g]; i++)
			s->chosen[count++] = cells ? s->cell_member[g][i] : g;
	return s->chosen;
}

static struct lod_sights_drawing drawing_of(struct study *s, enum method method, const struct lod_eye *eye, uint32_t share, bool scaled,
	double scale)
{
	uint32_t budget = (uint32_t)((uint64_t)s->leaves.foliage.count * share_percent[share] / 100);
	struct lod_sights_drawing drawing = { .order = choose(s, method, eye, budget, scaled), .count = budget, .scale = scaled ? (float)scale : 1 };
	if (scaled && s->growth[method]) {
		for (uint32_t i = 0; i < budget; i++)
			s->factor[drawing.order[i]] = eco_growth(s->growth[method][drawing.order[i]], (float)scale);
		drawing.factor = s->factor;
	}
	return drawing;
}

/* ---- Measuring ---- */

static double wrong_at(struct study *s, enum method method, uint32_t share, double scale)
{
	struct bench_wrong sum = { 0 };
	for (uint32_t v = 0; v < s->tuning.count; v++) {
		struct lod_sights_drawing drawing = drawing_of(s, method, &s->tuning.eyes[v], share, true, scale);
		bench_leaves_compare(&s->leaves, &s->tuning, v, &drawing, &sum);
	}
	return bench_wrong_share(&sum);
}

/* Steps of a quarter octave up from the scale of the share above, as long as they help. */
static void tune_scales(struct study *s, enum method method)
{
	const double step = 1.189207115002721;
	double scale = 1;
	for (uint32_t share = 0; share < SHARES; share++) {
		double least = wrong_at(s, method, share, scale), next;
		while (scale < 64 && (next = wrong_at(s, method, share, scale * step)) < least) {
			least = next;
			scale *= step;
		}
		s->scale[method][share] = scale;
	}
}

static uint64_t count_other(struct study *s, uint32_t view, const struct lod_sights_drawing *drawing, const uint64_t *reference)
{
	size_t pixels = (size_t)PIXELS * PIXELS;
	uint64_t other = 0;
	bench_leaves_ids(&s->leaves, &s->tests, view, drawing);
	for (size_t i = 0; i < pixels; i++)
		other += s->leaves.ids.owner[i] != reference[i];
	return other;
}

static void measure(struct study *s, enum method method, uint32_t view, const uint64_t *reference)
{
	for (uint32_t share = 0; share < SHARES; share++)
		for (int scaled = 0; scaled < 2; scaled++) {
			struct lod_sights_drawing drawing = drawing_of(s, method, &s->tests.eyes[view], share, scaled, method == BOUND ? 1 : s->scale[method][share]);
			bench_leaves_compare(&s->leaves, &s->tests, view, &drawing, &s->wrong[method][share][scaled]);
			s->other[method][share][scaled] += count_other(s, view, &drawing, reference);
		}
}

/* The size of pictures to build from. Smaller leaves than pixels come and go by chance between the views. */
static uint32_t build_pixels(const struct lod_foliage *f)
{
	double sum = 0, side = lod_v3_distance(f->low, f->high);
	for (uint32_t i = 0; i < f->count; i++)
		sum += f->area[i];
	return sum / f->count * PIXELS * PIXELS < LEAF_PIXELS * side * side ? 2 * PIXELS : PIXELS;
}

struct list_views { const double (*cover)[3]; uint32_t covers; const double (*rank)[3]; uint32_t ranks; };

/* A method's two lists: for leaves as they are, and for scaled ones (`rank` NULL: from the views that packs are made with). */
static enum eco_code make_lists(struct study *s, enum method method, const struct list_views *from, struct eco_error *error)
{
	const struct lod_foliage *f = &s->leaves.foliage;
	struct lod_arena *arena = &s->leaves.arena;
	struct lod_rank rank;
	s->fixed[method][0] = lod_arena_take(arena, f->count, sizeof(uint32_t));
	enum eco_code code = lod_cover_order(s->fixed[method][0], f, &(struct lod_cover_options){ .directions = from->cover,
		.views = from->covers, .pixels = build_pixels(f) }, arena, error);
	if (!code)
		code = lod_rank_make(&rank, f, &(struct lod_rank_options){ .views = from->ranks, .directions = from->rank, .seed = 3 }, arena, error);
	if (!code) {
		s->fixed[method][1] = rank.order;
		s->growth[method] = rank.growth;
	}
	return code;
}

/* What no list can be much better than: greedy coverage of the very picture that it is measured on. Not scaled. */
static enum eco_code make_bound(struct study *s, const double direction[3], struct eco_error *error)
{
	return lod_cover_order(s->fixed[BOUND][0], &s->leaves.foliage, &(struct lod_cover_options){ .directions = (const double (*)[3])direction,
		.views = 1, .pixels = PIXELS }, &s->leaves.arena, error);
}

static enum eco_code sights_around(struct study *s, struct lod_sights *sights, const double (*directions)[3], uint32_t count,
	struct eco_error *error)
{
	return lod_sights_make(sights, &s->leaves.foliage, directions, count, PIXELS, &s->leaves.arena, error);
}

/* One sector: its own lists, then all methods on test views in it. */
static enum eco_code measure_sector(struct study *s, const double axis[3], uint32_t sector, uint32_t views, struct eco_error *error)
{
	double build[SECTOR_VIEWS][3], rank[RANK_VIEWS][3], test[16][3];
	struct lod_arena_piece *mark = s->leaves.arena.last;
	size_t pixels = (size_t)PIXELS * PIXELS;
	lod_directions_cone(build, SECTOR_VIEWS, axis, CONE_RAD, 2 * sector);
	lod_directions_cone(rank, RANK_VIEWS, axis, CONE_RAD, 2 * sector);
	lod_directions_cone(test, views, axis, CONE_RAD, 2 * sector + 1);
	enum eco_code code = make_lists(s, SECTOR, &(struct list_views){ (const double (*)[3])build, SECTOR_VIEWS, (const double (*)[3])rank,
		RANK_VIEWS }, error);
	if (!code)
		code = sights_around(s, &s->tuning, (const double (*)[3])build, 4, error);
	if (!code)
		code = sights_around(s, &s->tests, (const double (*)[3])test, views, error);
	if (!code) {
		uint64_t *reference = lod_arena_take(&s->leaves.arena, pixels, sizeof *reference);
		tune_scales(s, SECTOR);
		for (uint32_t view = 0; view < views && !code; view++) {
			bench_leaves_ids(&s->leaves, &s->tests, view, NULL);
			memcpy(reference, s->leaves.ids.owner, pixels * sizeof *reference);
			s->shown += s->tests.reference_pixels[view];
			code = make_bound(s, test[view], error);
			for (int m = 0; m < METHODS && !code; m++)
				measure(s, (enum method)m, view, reference);
		}
	}
	lod_arena_release(&s->leaves.arena, mark);
	return code;
}

static enum eco_code run_study(struct study *s, uint32_t sectors, uint32_t views, struct eco_error *error)
{
	struct lod_arena *arena = &s->leaves.arena;
	uint32_t count = s->leaves.foliage.count;
	double axes[64][3], tuning[6][3], around[STATIC_VIEWS][3];
	s->kept = lod_arena_take(arena, count, sizeof *s->kept);
	s->chosen = lod_arena_take(arena, count, sizeof *s->chosen);
	s->factor = lod_arena_take(arena, count, sizeof *s->factor);
	make_baselines(s);
	make_groups(s);
	s->fixed[BOUND][0] = s->fixed[BOUND][1] = lod_arena_take(arena, count, sizeof(uint32_t));
	lod_directions_spread(tuning, 6, 501);
	lod_directions_spread(axes, sectors, 77);
	lod_directions_spread(around, STATIC_VIEWS, 3);
	enum eco_code code = make_lists(s, STATIC, &(struct list_views){ (const double (*)[3])around, STATIC_VIEWS, NULL, 0 }, error);
	if (!code)
		code = sights_around(s, &s->tuning, (const double (*)[3])tuning, 6, error);
	for (int m = 0; m < SECTOR && !code; m++)
		tune_scales(s, (enum method)m);
	for (uint32_t i = 0; i < sectors && !code; i++)
		code = bench_stopped(s->bench) ? eco_fail(error, ECO_INTERRUPTED, "interrupted") : measure_sector(s, axes[i], i, views, error);
	return code;
}

/* ---- Units ---- */

static json_t *result(const struct study *s)
{
	json_t *methods = json_array();
	for (int m = 0; m < METHODS; m++) {
		json_t *rows = json_array();
		for (uint32_t share = 0; share < SHARES; share++) {
			const struct bench_wrong *w = s->wrong[m][share];
			double shown = s->shown ? (double)s->shown : 1;
			json_array_append_new(rows, json_pack("[fffff]", bench_wrong_share(&w[0]), (double)s->other[m][share][0] / shown,
				m == BOUND ? 1 : s->scale[m][share], bench_wrong_share(&w[1]), (double)s->other[m][share][1] / shown));
		}
		json_array_append_new(methods, rows);
	}
	return json_pack("{sisiso}", "leaves", (int)s->leaves.foliage.count, "cells", (int)s->cell_count, "methods", methods);
}

static enum eco_code study_model(struct bench *bench, struct eco_model *model, uint32_t sectors, uint32_t views, json_t **out,
	struct eco_error *error)
{
	struct study *s = calloc(1, sizeof *s);
	if (!s) {
		eco_model_free(model);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a study of leaves");
	}
	s->bench = bench;
	enum eco_code code = bench_leaves_open(&s->leaves, model, PIXELS, error);
	if (!code) {
		if (setjmp(s->leaves.arena.failed))
			code = eco_fail(error, ECO_NO_MEMORY, "no memory for orders of %u leaves", s->leaves.foliage.count);
		else if (s->leaves.foliage.count >= LEAVES_LEAST)
			code = run_study(s, sectors, views, error);
		if (!code)
			*out = result(s);
		bench_leaves_close(&s->leaves);
	}
	free(s);
	return code;
}

/* `model` NULL: the crown. */
static enum eco_code unit(struct bench *bench, const struct bench_model *model, json_t **out, struct eco_error *error)
{
	uint32_t sectors = bench->full ? 12 : 2, views = bench->full ? 4 : 3;
	char name[96], stamp[64];
	snprintf(name, sizeof name, "lee-%s", model ? model->name : "crown-6143");
	snprintf(stamp, sizeof stamp, "%u sectors %u views %016llx", sectors, views, (unsigned long long)(model ? bench_file_hash(model->path) : 0));
	if ((*out = bench_recall(bench, name, stamp)))
		return ECO_OK;
	struct eco_model read;
	enum eco_code code = model ? bench_model_read(bench, model, &read, error) : bench_crown_make(&read, error);
	if (!code)
		code = study_model(bench, &read, sectors, views, out, error);
	if (!code)
		*out = bench_keep(bench, name, stamp, *out);
	return code;
}

/* ---- Report ---- */

static double figure(const json_t *unit, int method, int share, int column)
{
	const json_t *rows = json_array_get(json_object_get(unit, "methods"), (size_t)method);
	return json_number_value(json_array_get(json_array_get(rows, (size_t)share), (size_t)column));
}

/* Wrong pixels of a method over those of the best of Lee's three, leaves unscaled or scaled in both. */
static double ratio(const json_t *unit, int method, int share, bool scaled)
{
	int column = scaled ? 3 : 0;
	double lee = fmin(figure(unit, DISTANCE, share, column), fmin(figure(unit, NORMAL, share, column), figure(unit, LAYER, share, column)));
	double ours = figure(unit, method, share, column);
	return lee > 0 ? ours / lee : ours > 0 ? INFINITY : 1;
}

/* The worst ratios over plants: of lists per sector and of the one list, leaves unscaled and scaled; and whose they are. */
static const struct { enum method method; bool scaled; const char *key, *name, *bars[SHARES]; } contests[] = {
	{ SECTOR, true, "lee_ratio", "lists per sector (leaves scaled)", { "<= 0.5", "<= 0.5", "<= 0.5", "<= 0.6" } },
	{ SECTOR, false, "lee_unscaled_ratio", "lists per sector (leaves unscaled)", { "<= 0.5", "<= 0.5", "<= 0.5", "<= 0.6" } },
	{ STATIC, true, "lee_static", "one list (leaves scaled)", { "", "<= 0.8", "<= 0.7", "<= 0.75" } },
	{ STATIC, false, "lee_unscaled_static", "one list (leaves unscaled)", { "", "<= 0.8", "<= 0.7", "<= 0.75" } },
	{ BOUND, false, "lee_unscaled_bound", "greedy in the very view (leaves unscaled)", { "", "", "", "" } },
};
#define CONTESTS (sizeof contests / sizeof *contests)

struct worst { double ratio[SHARES], sum[SHARES]; char of[SHARES][64]; uint32_t count; };

static void note_worst(struct worst *worst, const char *name, const json_t *unit)
{
	for (size_t c = 0; c < CONTESTS; c++) {
		for (int share = 0; share < SHARES; share++) {
			double now = ratio(unit, contests[c].method, share, contests[c].scaled);
			worst[c].sum[share] += now;
			if (worst[c].count && now <= worst[c].ratio[share])
				continue;
			worst[c].ratio[share] = now;
			snprintf(worst[c].of[share], sizeof worst[c].of[share], "%s", name);
		}
		worst[c].count++;
	}
}

static void write_rows(struct bench_table *table, struct bench_table *ratios, const char *name, const json_t *unit)
{
	int leaves = (int)json_integer_value(json_object_get(unit, "leaves"));
	for (int m = 0; m < METHODS; m++)
		for (int share = 0; share < SHARES; share++)
			bench_table_row(table, "%s,%d,%s,%u,%.2f,%.2f,%.2f,%.2f,%.2f,%.3f,%.3f", name, leaves, method_names[m], share_percent[share],
				100 * figure(unit, m, share, 0), 100 * figure(unit, m, share, 1), figure(unit, m, share, 2), 100 * figure(unit, m, share, 3),
				100 * figure(unit, m, share, 4), ratio(unit, m, share, false), ratio(unit, m, share, true));
	for (size_t c = 0; c < CONTESTS; c++)
		bench_table_row(ratios, "%s,%d,%s,%.3f,%.3f,%.3f,%.3f", name, leaves, contests[c].name,
			ratio(unit, contests[c].method, 0, contests[c].scaled), ratio(unit, contests[c].method, 1, contests[c].scaled),
			ratio(unit, contests[c].method, 2, contests[c].scaled), ratio(unit, contests[c].method, 3, contests[c].scaled));
}

static enum eco_code plot_crown(struct bench *bench, const json_t *unit, struct eco_error *error)
{
	static const int shown[] = { DISTANCE, NORMAL, LAYER, STOCHASTIC, COMBINED, STATIC, SECTOR };
	double x[SHARES], y[METHODS][SHARES];
	struct bench_series series[METHODS];
	uint32_t count = 0;
	for (size_t i = 0; i < sizeof shown / sizeof *shown; i++) {
		for (int share = 0; share < SHARES; share++) {
			x[share] = share_percent[share];
			y[i][share] = 100 * figure(unit, shown[i], share, 0);
		}
		series[count++] = (struct bench_series){ method_names[shown[i]], x, y[i], SHARES, false };
	}
	return bench_plot(bench, &(struct bench_plot){ .name = "lee-crown", .title = "Crown of 6,143 leaves, unscaled", .x = "leaves kept, %",
		.y = "wrong pixels, % of the reference", .series = series, .series_count = count }, error);
}

static void write_keys(struct bench *bench, const struct worst *worst)
{
	for (size_t c = 0; c < CONTESTS; c++) {
		const struct worst *w = &worst[c];
		for (int share = 0; share < SHARES; share++) {
			char key[48];
			snprintf(key, sizeof key, "%s_%u", contests[c].key, share_percent[share]);
			bench_key(bench, key, w->ratio[share], contests[c].bars[share]);
		}
		bench_say(bench, "Wrong pixels over those of the best of Lee's three at 80, 50, 30 and 10 %% of the leaves, %s: mean over %u plants %.2f, "
			"%.2f, %.2f, %.2f; worst %.2f (%s), %.2f (%s), %.2f (%s), %.2f (%s).", contests[c].name, w->count, w->sum[0] / w->count,
			w->sum[1] / w->count, w->sum[2] / w->count, w->sum[3] / w->count, w->ratio[0], w->of[0], w->ratio[1], w->of[1], w->ratio[2],
			w->of[2], w->ratio[3], w->of[3]);
	}
}

static enum eco_code run(struct bench *bench, struct eco_error *error)
{
	struct bench_model *models = NULL;
	uint32_t count = 0;
	struct worst worst[CONTESTS] = { 0 };
	enum eco_code code = bench_models(bench, &models, &count, error);
	if (code)
		return code;
	struct bench_table *table = bench_table_open(bench, "lee", "plant,leaves,method,kept %,wrong %,other leaf %,scale,scaled wrong %,"
		"scaled other leaf %,wrong over Lee's best,scaled wrong over Lee's best", false);
	struct bench_table *ratios = bench_table_open(bench, "lee_ratios", "plant,leaves,wrong over Lee's best,80 %,50 %,30 %,10 %", true);
	for (uint32_t i = 0, found = 0; i <= count && !code && (bench->full || found <= MODELS_QUICK); i++) {
		json_t *one;
		const struct bench_model *model = i ? &models[i - 1] : NULL;
		const char *name = model ? model->name : "crown of 6143 leaves";
		if (model && (model->leaves < LEAVES_LEAST || (model->generated && !bench->full && bench->data)))
			continue;
		bench_progress(bench, (double)i / (count + 1), name);
		code = unit(bench, model, &one, error);
		if (code || json_integer_value(json_object_get(one, "leaves")) < (json_int_t)LEAVES_LEAST)
			continue;
		found++;
		note_worst(worst, name, one);
		write_rows(table, ratios, name, one);
		if (i == 0)
			code = plot_crown(bench, one, error);
	}
	bench_table_close(table);
	bench_table_close(ratios);
	free(models);
	if (!code) {
		bench_say(bench, "Lee, Peng and Kuo print, for a tree of 6,143 leaves at 80, 50, 30 and 10 %%: distance 3.03, 9.09, 14.03, 18.42; "
			"normal 5.31, 12.87, 16.49, 19.13; layer+normal 2.86, 10.06, 15.07, 18.75 %% incorrect pixels, without saying of what. Ours are "
			"of the reference's pixels; layers: %u.", LOD_LEE_LAYERS);
		write_keys(bench, worst);
	}
	return code;
}

const struct bench_section bench_lee = { "lee", "Which leaves to keep: Lee's orders and ours", run,
	.objects = BENCH_OBJECTS_PLANTS "tests/bench/bench_lee.o tests/bench/bench_crown.o" };
