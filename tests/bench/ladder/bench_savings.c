/* See bench_savings.h. Each method is tabulated over lambda: the scale (and with simpler leaves how many
 * elements are drawn) that is best on one set of views, and the Q of that on another. Between lambdas both
 * are interpolated, as a client does. */
#include "tests/bench/ladder/bench_savings.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/list.h"
#include "lod/build/order/rank.h"
#include "tests/bench/baseline/cook.h"
#include "tests/bench/collapse/bench_collapse_plant.h"
#include "tests/bench/bench_leaves.h"

#define PIXELS 256u
#define TUNING_VIEWS 5u
#define TUNING_SEED 7411u
#define TEST_SEED 90217u
#define ROWS_MAX 48u
#define LAMBDA_LEAST 1e-4
#define KNEE 0.3                 /* lambdas are a constant factor apart below, a constant step above */
#define FACTOR 1.4
#define STEP 0.05
/* fewer lambdas: between them Q is interpolated below what it is, and savings with it */
#define FACTOR_QUICK 1.6
#define STEP_QUICK 0.07
#define STEPS_MOST 24            /* eighths of an octave about Cook's scale */
#define NOISE_SMALL 0.05         /* "a small amount of randomness" (Neubert 2011, 3.2) */
#define NOISE_MUCH 1.5
#define WAYS 5                   /* from full leaves to triangles only */

const char *const bench_method_names[BENCH_METHODS] = { "stochastic", "density", "orientation",
	"orientation with much noise", "combined", "combined with much noise", "leaf collapse",
	"greedy at one scale", "greedy", "greedy with simpler leaves" };
const double bench_shares[BENCH_SHARES] = { 0.02, 0.05, 0.1, 0.2, 0.3, 0.5 };

/* elements [0, fine) as they are, [fine, count) triangles */
struct row { double lambda, step, count, fine, q; int way; };

struct study {
	struct bench_leaves leaves;
	struct lod_sights tuning, tests;
	uint32_t *order[BENCH_METHODS], n;
	/* vertices of the first i of the order; simple: as triangles */
	uint64_t *full[BENCH_METHODS], *simple;
	uint8_t *growth;
	struct bench_collapse_plant collapse;
	struct lod_simple *triangle, *shape;
	float *factor;
	double share, layers;        /* lod_cook_share of a leaf; layers of leaves */
	struct row rows[BENCH_METHODS][ROWS_MAX];
	uint32_t row_count;
};

double bench_distance(enum bench_spacing spacing, uint32_t i)
{
	return spacing == BENCH_EVEN ? (double)i / BENCH_DISTANCES : i < 10 ? 0.01 * i
		: 0.1 + 0.09 * (i - 10);
}

/* ---- Orders ---- */

static bool rank_goes_on(void *ctx, double share)
{
	struct bench *bench = ctx;
	(void)share;
	return !bench_stopped(bench);
}

static enum eco_code make_orders(struct bench *bench, struct study *s, struct eco_error *error)
{
	static const struct { enum lod_order_method method; double noise; } methods[] = {
		{ LOD_ORDER_STOCHASTIC, 0 }, { LOD_ORDER_DENSITY, 0 }, { LOD_ORDER_ORIENTATION, NOISE_SMALL },
		{ LOD_ORDER_ORIENTATION, NOISE_MUCH }, { LOD_ORDER_COMBINED, NOISE_SMALL },
		{ LOD_ORDER_COMBINED, NOISE_MUCH } };
	const struct lod_foliage *f = &s->leaves.foliage;
	struct lod_arena *arena = &s->leaves.arena;
	for (int m = BENCH_STOCHASTIC; m <= BENCH_COMBINED_NOISY; m++)
		s->order[m] = bench_leaves_order(&s->leaves, methods[m].method, methods[m].noise);
	struct lod_rank_options options = { .seed = 1, .leaves = true, .progress = rank_goes_on,
		.ctx = bench };
	struct lod_rank rank;
	enum eco_code code = lod_rank_make(&rank, f, &options, arena, error);
	if (code)
		return code;
	bench_collapse_make(&s->collapse, f, &(struct bench_collapse_options){ 0 }, arena);
	bench_collapse_extend(&s->collapse, &s->leaves.foliage, arena);
	s->order[BENCH_COLLAPSE] = lod_arena_take(arena, f->count, sizeof *s->order[BENCH_COLLAPSE]);
	s->order[BENCH_PLAIN] = s->order[BENCH_PRUNED] = s->order[BENCH_TRIANGLES] = rank.order;
	s->growth = rank.growth;
	s->triangle = rank.simple;
	return ECO_OK;
}

/* The level of so many leaves. Below the coarsest one there is none: a part of that is drawn. */
static uint32_t collapse_row(const struct study *s, uint32_t count)
{
	const struct lod_collapse *forest = s->collapse.sectors.forest;
	return (uint32_t)(lod_collapse_level_of(forest, count) - forest->level);
}

static void count_collapse(struct study *s)
{
	const struct lod_collapse *forest = s->collapse.sectors.forest;
	uint64_t *full = lod_arena_take(&s->leaves.arena, (size_t)s->n + 1, sizeof *full);
	for (uint32_t k = 0; k <= s->n; k++) {
		uint64_t vertices = s->collapse.vertices[0][collapse_row(s, k)];
		full[k] = k < forest->roots ? vertices * k / forest->roots : vertices;
	}
	s->full[BENCH_COLLAPSE] = full;
}

static void count_vertices(struct study *s)
{
	const uint32_t *first = s->leaves.foliage.first;
	count_collapse(s);
	for (int m = 0; m < BENCH_METHODS; m++) {
		if (m == BENCH_COLLAPSE)
			continue;
		s->full[m] = lod_arena_take(&s->leaves.arena, (size_t)s->n + 1, sizeof *s->full[m]);
		for (uint32_t k = 0; k < s->n; k++)
			s->full[m][k + 1] = s->full[m][k]
				+ 3 * (first[s->order[m][k] + 1] - first[s->order[m][k]] - 2);
	}
	s->simple = lod_arena_take(&s->leaves.arena, (size_t)s->n + 1, sizeof *s->simple);
	for (uint32_t k = 0; k < s->n; k++)
		s->simple[k + 1] = s->simple[k] + 3;
}

/* Depth complexity, for Cook's correction: leaves' projected area over what they cover. */
static void measure_share(struct study *s)
{
	const struct lod_foliage *f = &s->leaves.foliage;
	double projected = 0, covered = 0;
	for (uint32_t v = 0; v < s->tuning.count; v++) {
		const struct lod_eye *eye = &s->tuning.eyes[v];
		struct lod_v3 to = lod_v3_sub(lod_v3_mix(f->low, f->high, 0.5),
			(struct lod_v3){ eye->at[0], eye->at[1], eye->at[2] });
		double away = lod_v3_length(to), pixel = eye->pixel_rad * away;
		for (uint32_t i = 0; i < f->count; i++)
			projected += fabs(lod_v3_dot(f->normal[i], to)) / away / (pixel * pixel);
		for (uint32_t i = 0; i < s->tuning.words; i++)
			covered += __builtin_popcountll(s->tuning.reference[v][i] & ~s->tuning.wood[v][i]);
	}
	s->layers = covered > 0 ? projected / covered : 0;
	s->share = lod_cook_share(s->n, projected / s->tuning.count, covered / s->tuning.count);
}

/* ---- A subset's quality ---- */

static uint32_t whole(double x, uint32_t most)
{
	return x < 1 ? 1 : x > most ? most : (uint32_t)(x + 0.5);
}

/* Cook's scale times so many eighths of an octave; 1 where all leaves are drawn as they are. Quads of leaf
 * collapse are as large as they should be without it. */
static double scale_of(const struct study *s, enum bench_method method, const struct row *row)
{
	double cook = method == BENCH_COLLAPSE ? 1 : s->n / fmin(row->count, s->n);
	return row->fine >= s->n ? 1 : cook * exp2(row->step / 8);
}

/* A level's leaves as they are, and its quads at the scale. */
static struct lod_sights_drawing prepare_collapse(struct study *s, uint32_t count, float scale)
{
	uint32_t row = collapse_row(s, count), *order = s->order[BENCH_COLLAPSE],
		all = bench_collapse_order(&s->collapse, 0, row, order);
	for (uint32_t k = 0; k < all; k++)
		s->factor[order[k]] = order[k] < s->n ? 1 : scale;
	return (struct lod_sights_drawing){ .order = order, .count = count < all ? count : all,
		.factor = s->factor };
}

static struct lod_sights_drawing prepare(struct study *s, enum bench_method method, const struct row *row)
{
	uint32_t count = whole(row->count, s->n), fine = row->fine < 0.5 ? 0 : whole(row->fine, count);
	float scale = (float)scale_of(s, method, row);
	if (method == BENCH_COLLAPSE)
		return prepare_collapse(s, count, scale);
	struct lod_sights_drawing drawing = { .order = s->order[method], .count = count, .scale = scale };
	if (method >= BENCH_PRUNED) {
		float by_code[ECO_GROWTHS];
		for (uint32_t c = 0; c < ECO_GROWTHS; c++)
			by_code[c] = eco_growth(c, scale);
		for (uint32_t k = 0; k < count; k++)
			s->factor[drawing.order[k]] = by_code[s->growth[drawing.order[k]]];
		drawing.factor = s->factor;
	}
	if (method >= BENCH_TRIANGLES) {
		for (uint32_t k = 0; k < count; k++) {
			uint32_t i = drawing.order[k];
			bool simpler = k >= fine && s->simple[k + 1] - s->simple[k] < s->full[method][k + 1]
				- s->full[method][k];
			s->shape[i] = simpler ? s->triangle[i] : (struct lod_simple){ .corners = 0 };
		}
		drawing.shape = s->shape;
	}
	return drawing;
}

/* Q over all views. If it is not above `least`, any figure that is not either: views that cannot lift it
 * above are not drawn. */
static double q_of(struct study *s, const struct lod_sights *sights, const struct lod_sights_drawing *drawing,
	double least)
{
	struct bench_wrong sum = { 0 };
	double q = 1;
	uint64_t pixels = 0;
	for (uint32_t v = 0; v < sights->count; v++)
		pixels += sights->reference_pixels[v];
	for (uint32_t v = 0; v < sights->count && (v == 0 || q > least); v++) {
		bench_leaves_compare(&s->leaves, sights, v, drawing, &sum);
		q = bench_wrong_q(&(struct bench_wrong){ sum.fp, sum.fn, pixels });
	}
	return q;
}

static double try_row(struct study *s, enum bench_method method, const struct lod_sights *sights,
	const struct row *row, double least)
{
	const struct lod_sights_drawing drawing = prepare(s, method, row);
	return q_of(s, sights, &drawing, least);
}

/* ---- Tables ---- */

/* Elements of a prefix that comes to so many vertices, with parts. */
static double elements_at(const uint64_t *sum, uint32_t n, double vertices)
{
	uint32_t low = 0, high = n;
	while (low < high) {
		uint32_t middle = (low + high + 1) / 2;
		if ((double)sum[middle] <= vertices)
			low = middle;
		else
			high = middle - 1;
	}
	return low >= n ? n : low + (vertices - (double)sum[low]) / (double)(sum[low + 1] - sum[low]);
}

/* Way 0 draws all as they are, WAYS - 1 as many elements as can be with triangles. */
static void place(const struct study *s, enum bench_method method, struct row *row)
{
	double vertices = row->lambda * (double)s->full[method][s->n];
	row->count = row->fine = elements_at(s->full[method], s->n, vertices);
	if (method < BENCH_TRIANGLES || row->way == 0)
		return;
	double most = elements_at(s->simple, s->n, vertices);
	row->count = row->count * pow(most / fmax(row->count, 1e-9), (double)row->way / (WAYS - 1));
	uint32_t count = whole(row->count, s->n), low = 0, high = count;
	/* the most elements as they are that leave the others room */
	while (low < high) {
		uint32_t middle = (low + high + 1) / 2;
		if ((double)(s->full[method][middle] + s->simple[count] - s->simple[middle]) <= vertices)
			low = middle;
		else
			high = middle - 1;
	}
	row->fine = low;
}

/* Climbs from row->step, in strides of four eighths, two and one. No step is tried twice. */
static double climb(struct study *s, enum bench_method method, struct row *row)
{
	bool tried[2 * STEPS_MOST + 1] = { false };
	double best = try_row(s, method, &s->tuning, row, -INFINITY);
	if (row->count >= s->n && row->fine >= s->n)
		return best;
	tried[(int)row->step + STEPS_MOST] = true;
	for (int stride = 4; stride > 0; stride /= 2)
		for (int way = -1; way <= 1; way += 2)
			for (;;) {
				struct row next = *row;
				next.step += way * stride;
				if (fabs(next.step) > STEPS_MOST || tried[(int)next.step + STEPS_MOST])
					break;
				tried[(int)next.step + STEPS_MOST] = true;
				double q = try_row(s, method, &s->tuning, &next, best);
				if (!(q > best))
					break;
				best = q;
				*row = next;
			}
	return best;
}

/* From the row of the next larger lambda on. */
static void fill_row(struct study *s, enum bench_method method, struct row *row, const struct row *larger)
{
	struct row best = { .lambda = row->lambda };
	double best_q = -INFINITY;
	int last = method == BENCH_TRIANGLES ? WAYS - 1 : 0;
	int from = larger && larger->way > 0 ? larger->way - 1 : 0, to = larger && larger->way < last
		? larger->way + 1 : last;
	for (int way = from; way <= to; way++) {
		struct row one = { .lambda = row->lambda, .way = way, .step = larger ? larger->step : 0 };
		place(s, method, &one);
		double q = climb(s, method, &one);
		if (q > best_q) {
			best_q = q;
			best = one;
		}
	}
	*row = best;
	row->q = try_row(s, method, &s->tests, row, -INFINITY);
}

static enum eco_code fill_tables(struct bench *bench, struct study *s, struct eco_error *error)
{
	double lambda[ROWS_MAX];
	double least = fmax(LAMBDA_LEAST, 1.0 / s->n), step = bench->full ? STEP : STEP_QUICK,
		factor = bench->full ? FACTOR : FACTOR_QUICK;
	for (double l = 1; l > KNEE + step / 2; l -= step)
		lambda[s->row_count++] = l;
	for (double l = KNEE; l > least && s->row_count < ROWS_MAX; l /= factor)
		lambda[s->row_count++] = l;
	for (int m = 0; m < BENCH_METHODS; m++)
		for (uint32_t i = 0; i < s->row_count; i++) {
			s->rows[m][i] = (struct row){ .lambda = lambda[i] };
			fill_row(s, (enum bench_method)m, &s->rows[m][i], i ? &s->rows[m][i - 1] : NULL);
			if (bench_stopped(bench))
				return eco_fail(error, ECO_INTERRUPTED, "interrupted");
		}
	return ECO_OK;
}

/* The least lambda from which on Q is reached; rows are by falling lambda. */
static double reach(const struct row *rows, uint32_t count, double q)
{
	uint32_t i = count - 1;
	while (i > 0 && rows[i].q < q)
		i--;
	if (i + 1 == count || rows[i].q < q)
		return rows[i].lambda;
	const struct row *high = &rows[i], *low = &rows[i + 1];
	double t = high->q > low->q ? (q - low->q) / (high->q - low->q) : 1;
	return low->lambda + t * (high->lambda - low->lambda);
}

/* Q at a share, between the rows around it. */
static double q_at(const struct row *rows, uint32_t count, double lambda)
{
	uint32_t i = 0;
	while (i + 1 < count && rows[i + 1].lambda > lambda)
		i++;
	if (i + 1 == count)
		return rows[i].q;
	double t = (lambda - rows[i + 1].lambda) / (rows[i].lambda - rows[i + 1].lambda);
	return rows[i + 1].q + t * (rows[i].q - rows[i + 1].q);
}

/* ---- Protocol ---- */

/* Cook with the area kept, or with the area kept that is expected to be visible, whichever is better. */
static void measure_cook(struct study *s, enum bench_spacing spacing, uint32_t vertices,
	struct bench_reach *reach)
{
	for (uint32_t d = 0; d < BENCH_DISTANCES; d++) {
		double lambda = (1 - bench_distance(spacing, d)) * (1 - bench_distance(spacing, d));
		uint32_t kept = whole(elements_at(s->full[BENCH_STOCHASTIC], s->n, lambda * vertices), s->n);
		struct lod_sights_drawing drawing = { .order = s->order[BENCH_STOCHASTIC], .count = kept,
			.scale = (float)lod_cook_scale(kept, s->n) };
		double plain = q_of(s, &s->tests, &drawing, -INFINITY);
		drawing.scale = (float)lod_cook_scale_depth(kept, s->n, s->share);
		reach->cook_lambda[d] = lambda;
		reach->cook_q[d] = fmax(plain, q_of(s, &s->tests, &drawing, plain));
	}
}

static enum eco_code run_study(struct bench *bench, struct study *s, struct bench_savings *savings,
	struct eco_error *error)
{
	uint32_t tests = bench->full ? 12 : 6;
	double directions[12][3];
	enum eco_code code = make_orders(bench, s, error);
	if (code)
		return code;
	count_vertices(s);
	s->factor = lod_arena_take(&s->leaves.arena, (size_t)s->n + s->collapse.quads, sizeof *s->factor);
	s->shape = lod_arena_take(&s->leaves.arena, s->n, sizeof *s->shape);
	lod_directions_spread(directions, TUNING_VIEWS, TUNING_SEED);
	code = lod_sights_make(&s->tuning, &s->leaves.foliage, (const double (*)[3])directions, TUNING_VIEWS,
		PIXELS, &s->leaves.arena, error);
	lod_directions_spread(directions, tests, TEST_SEED);
	if (!code)
		code = lod_sights_make(&s->tests, &s->leaves.foliage, (const double (*)[3])directions, tests,
			PIXELS, &s->leaves.arena, error);
	if (code)
		return code;
	savings->vertices = (uint32_t)s->full[0][s->n];
	measure_share(s);
	savings->layers = s->layers;
	for (int g = 0; g < BENCH_SPACINGS; g++)
		measure_cook(s, (enum bench_spacing)g, savings->vertices, &savings->at[g]);
	code = fill_tables(bench, s, error);
	for (int m = 0; m < BENCH_METHODS && !code; m++) {
		for (uint32_t i = 0; i < BENCH_SPACINGS * BENCH_DISTANCES; i++) {
			struct bench_reach *at = &savings->at[i / BENCH_DISTANCES];
			uint32_t d = i % BENCH_DISTANCES;
			at->lambda[m][d] = reach(s->rows[m], s->row_count, at->cook_q[d]);
		}
		for (uint32_t i = 0; i < BENCH_SHARES; i++)
			savings->q[m][i] = q_at(s->rows[m], s->row_count, bench_shares[i]);
	}
	return code;
}

enum eco_code bench_savings_measure(struct bench *bench, struct bench_savings *savings,
	struct eco_model *model, struct eco_error *error)
{
	struct study *s = calloc(1, sizeof *s);
	*savings = (struct bench_savings){ 0 };
	if (!s) {
		eco_model_free(model);
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a study of savings");
	}
	enum eco_code code = bench_leaves_open(&s->leaves, model, PIXELS, error);
	if (code == ECO_BAD_INPUT) {                         /* no leaves at all */
		free(s);
		return ECO_OK;
	}
	if (!code) {
		savings->elements = s->n = s->leaves.foliage.count;
		if (setjmp(s->leaves.arena.failed))
			code = eco_fail(error, ECO_NO_MEMORY, "no memory for orders of %u leaves",
				s->leaves.foliage.count);
		else if (s->n >= BENCH_ELEMENTS_LEAST)
			code = run_study(bench, s, savings, error);
		bench_leaves_close(&s->leaves);
	}
	free(s);
	return code;
}

/* ---- Units and means ---- */

#define SIZE ((sizeof(struct bench_savings) - offsetof(struct bench_savings, layers)) / sizeof(double))

struct work { struct bench *bench; const char *name, *path; };

/* [elements, vertices, all else in the order of the struct] */
static enum eco_code make_savings(void *ctx, json_t **made, struct eco_error *error)
{
	const struct work *w = ctx;
	struct bench_model file = { .generated = false };
	struct eco_model model;
	struct bench_savings savings;
	snprintf(file.name, sizeof file.name, "%s", w->name);
	snprintf(file.path, sizeof file.path, "%s", w->path);
	enum eco_code code = bench_model_read(w->bench, &file, &model, error);
	code = code ? code : bench_savings_measure(w->bench, &savings, &model, error);
	if (!code)
		*made = json_pack("[iio]", (int)savings.elements, (int)savings.vertices,
			bench_reals(&savings.layers, SIZE));
	return code;
}

enum eco_code bench_savings_of(struct bench *bench, struct bench_savings *savings, const char *name,
	const char *path, struct eco_error *error)
{
	char unit[96], stamp[32];
	struct work work = { bench, name, path };
	json_t *kept;
	/* by what the file holds: the same plant in two scenes is measured once */
	snprintf(unit, sizeof unit, "savings-%016llx", (unsigned long long)bench_file_hash(path));
	snprintf(stamp, sizeof stamp, "%u views", bench->full ? 12 : 6);
	enum eco_code code = bench_unit(bench, unit, stamp, make_savings, &work, &kept, error);
	if (code)
		return code;
	savings->elements = (uint32_t)bench_cell(kept, 0);
	savings->vertices = (uint32_t)bench_cell(kept, 1);
	bench_cells(json_array_get(kept, 2), &savings->layers, SIZE);
	return ECO_OK;
}

double bench_saving_beyond(const struct bench_savings *s, enum bench_spacing spacing,
	enum bench_method method, double least)
{
	const struct bench_reach *at = &s->at[spacing];
	double sum = 0;
	uint32_t count = 0;
	for (uint32_t d = 0; d < BENCH_DISTANCES; d++)
		if (bench_distance(spacing, d) >= least - 1e-9) {
			sum += 1 - at->lambda[method][d] / at->cook_lambda[d];
			count++;
		}
	return sum / count;
}

double bench_saving_total(const struct bench_savings *s, enum bench_spacing spacing, enum bench_method method)
{
	const struct bench_reach *at = &s->at[spacing];
	double ours = 0, cook = 0;
	for (uint32_t d = 0; d < BENCH_DISTANCES; d++) {
		ours += at->lambda[method][d];
		cook += at->cook_lambda[d];
	}
	return 1 - ours / cook;
}
