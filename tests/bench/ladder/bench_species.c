/* Geometry saved against Cook's stochastic simplification at equal quality, species by species: Neubert's
 * protocol (2011, section 5) for the orders of that paper and for our greedy one.
 *
 *   d of 20 distances, normalised by the distance at which nothing would be left
 *   lambda_Cook = (1 - d)^2, and the Q that Cook reaches there, seen from where no method was made for
 *   each method: the least lambda whose Q, at the scale that its table has, is no less
 *
 * lambda counts vertices of the foliage as the client draws them, 3 a triangle; wood is drawn whole by all
 * orders and not counted. Packs draw as much wood as their planner chooses; vertices of splats and impostors,
 * which show wood too, all count. A method's table has the scale that is best on one set of views and the Q
 * of that on another; between lambdas both are interpolated, as a client does. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "ecofiles/format/list.h"
#include "lod/build/order/rank.h"
#include "tests/bench/baseline/cook.h"
#include "tests/bench/bench_leaves.h"
#include "tests/bench/ladder/bench_species.h"

#define METHODS BENCH_ORDERS
#define DISTANCES BENCH_DISTANCES
#define TUNING_VIEWS 5u
#define TUNING_SEED 7411u
#define TESTS_MOST 12u
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
#define NOISE_SMALL 0.05         /* "a small amount of randomness" (3.2) */
#define NOISE_MUCH 1.5           /* as much as suits our plants */
#define SPECIES_MOST 256u
#define CLOSED_VERTICES 50000u   /* of leaves; with layers of them, as the paper's crowns */
#define CLOSED_LAYERS 4.0

const double bench_shares[BENCH_SHARES] = { 0.02, 0.05, 0.1, 0.2, 0.3, 0.5 };
const char *const bench_order_names[METHODS] = { "stochastic", "density", "orientation",
	"orientation with much noise", "combined", "combined with much noise", "greedy at one scale",
	"greedy", "packs" };
static const struct { const char *printed; enum lod_order_method order; double noise; } methods[METHODS] = {
	{ "10.1", LOD_ORDER_STOCHASTIC, 0 }, { "17.4", LOD_ORDER_DENSITY, 0 },
	{ "40.7", LOD_ORDER_ORIENTATION, NOISE_SMALL }, { "-", LOD_ORDER_ORIENTATION, NOISE_MUCH },
	{ "30.1", LOD_ORDER_COMBINED, NOISE_SMALL }, { "-", LOD_ORDER_COMBINED, NOISE_MUCH },
	{ .printed = "-" }, { .printed = "-" }, { .printed = "-" } };

/* Scale: Cook's times 2^(step / 8). */
struct row { double lambda, step, count, q; };

struct study {
	struct bench *bench;
	const struct bench_model *model;
	struct bench_leaves *leaves;
	struct lod_sights tuning, tests;
	uint32_t *order[METHODS], n;
	uint64_t *vertices[METHODS];         /* of the first i of the order */
	uint8_t *growth;
	float *factor;
	double share, layers;                /* lod_cook_share of a leaf; layers of leaves */
	struct row rows[METHODS][ROWS_MAX];
	uint32_t row_count;
};

static double cook_lambda(uint32_t i)
{
	double d = (double)i / DISTANCES;
	return (1 - d) * (1 - d);
}

/* ---- Orders ---- */

static void make_orders(struct study *s)
{
	struct lod_rank rank;
	must(lod_rank_make(&rank, &s->leaves->foliage, &(struct lod_rank_options){ .seed = 1, .leaves = true },
		&s->leaves->arena, must_error));
	s->growth = rank.growth;
	for (int m = 0; m < METHODS; m++) {
		s->order[m] = m >= BENCH_PLAIN ? rank.order : bench_leaves_order(s->leaves, methods[m].order,
			methods[m].noise);
		s->vertices[m] = lod_arena_take(&s->leaves->arena, (size_t)s->n + 1, sizeof *s->vertices[m]);
		for (uint32_t k = 0; k < s->n; k++)
			s->vertices[m][k + 1] = s->vertices[m][k]
				+ bench_leaves_vertices(&s->leaves->foliage, s->order[m] + k, 1);
	}
}

/* Depth complexity, for Cook's correction: leaves' projected area over what they cover. */
static void measure_share(struct study *s)
{
	const struct lod_foliage *f = &s->leaves->foliage;
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
		bench_leaves_compare(s->leaves, sights, v, drawing, &sum);
		q = bench_wrong_q(&(struct bench_wrong){ sum.fp, sum.fn, pixels });
	}
	return q;
}

static double try_row(struct study *s, enum bench_order method, const struct lod_sights *sights,
	const struct row *row, double least)
{
	struct lod_sights_drawing drawing = { .order = s->order[method], .count = whole(row->count, s->n),
		.scale = (float)(row->count >= s->n ? 1 : s->n / row->count * exp2(row->step / 8)),
		.factor = method >= BENCH_GREEDY ? s->factor : NULL };
	for (uint32_t k = 0; k < drawing.count && method >= BENCH_GREEDY; k++)
		s->factor[drawing.order[k]] = eco_growth(s->growth[drawing.order[k]], drawing.scale);
	return q_of(s, sights, &drawing, least);
}

/* ---- Tables ---- */

/* Elements of a prefix that comes to so many vertices, with parts. */
static double elements_at(const uint64_t *sum, uint32_t n, double vertices)
{
	uint32_t low = 1, high = n + 1;
	ECO_LEAST(low, high, i, (double)sum[i] > vertices)
	low--;
	return low >= n ? n : low + (vertices - (double)sum[low]) / (double)(sum[low + 1] - sum[low]);
}

/* Climbs from row->step, in strides of four eighths, two and one. No step is tried twice. */
static void climb(struct study *s, enum bench_order method, struct row *row)
{
	bool tried[2 * STEPS_MOST + 1] = { false };
	double best = try_row(s, method, &s->tuning, row, -INFINITY);
	if (row->count >= s->n)
		return;
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
}

/* From the scale of the row of the next larger lambda on. */
static void fill_row(struct study *s, enum bench_order method, struct row *row, const struct row *larger)
{
	const uint64_t *sum = s->vertices[method];
	row->count = elements_at(sum, s->n, row->lambda * (double)sum[s->n]);
	row->step = larger ? larger->step : 0;
	climb(s, method, row);
	row->q = try_row(s, method, &s->tests, row, -INFINITY);
}

/* Budgets are shares of all vertices, wood included. */
static void fill_pack(struct study *s, struct row *rows)
{
	double budget[ROWS_MAX] = { 1e15 }, q[ROWS_MAX], drawn[ROWS_MAX], leaves = (double)s->vertices[0][s->n],
		all = leaves + 3 * (double)s->leaves->foliage.wood_count;
	for (uint32_t i = 1; i < s->row_count; i++)
		budget[i] = rows[i].lambda * all;
	bench_leaves_ours(s->bench, s->leaves, s->model, &s->tests, budget, s->row_count, q, drawn);
	for (uint32_t i = 0; i < s->row_count; i++)
		rows[i] = (struct row){ .lambda = fmin(1, drawn[i] / leaves), .q = q[i] };
}

static void fill_tables(struct study *s)
{
	double lambda[ROWS_MAX], least = fmax(LAMBDA_LEAST, 1.0 / s->n),
		step = s->bench->full ? STEP : STEP_QUICK, factor = s->bench->full ? FACTOR : FACTOR_QUICK;
	for (double l = 1; l > KNEE + step / 2; l -= step)
		lambda[s->row_count++] = l;
	for (double l = KNEE; l > least && s->row_count < ROWS_MAX; l /= factor)
		lambda[s->row_count++] = l;
	for (int m = 0; m < METHODS; m++)
		for (uint32_t i = 0; i < s->row_count; i++) {
			struct row *row = &s->rows[m][i];
			*row = (struct row){ .lambda = lambda[i] };
			if (m < BENCH_PACK)
				fill_row(s, (enum bench_order)m, row, i ? row - 1 : NULL);
		}
	fill_pack(s, s->rows[BENCH_PACK]);
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
static double cook_q(struct study *s, double lambda)
{
	const uint64_t *vertices = s->vertices[BENCH_STOCHASTIC];
	uint32_t kept = whole(elements_at(vertices, s->n, lambda * (double)vertices[s->n]), s->n);
	struct lod_sights_drawing drawing = { .order = s->order[BENCH_STOCHASTIC], .count = kept,
		.scale = (float)lod_cook_scale(kept, s->n) };
	double plain = q_of(s, &s->tests, &drawing, -INFINITY);
	drawing.scale = (float)lod_cook_scale_depth(kept, s->n, s->share);
	return fmax(plain, q_of(s, &s->tests, &drawing, plain));
}

#define ROW (DISTANCES + BENCH_SHARES)

/* The unit: [elements, vertices, layers, for each method lambdas over Cook's and Q]; of few elements their
 * number. */
static json_t *study_leaves(void *ctx, struct bench_leaves *leaves)
{
	struct study *s = ctx;
	double values[3 + METHODS * ROW], q[ROW], *at = values;
	s->leaves = leaves;
	s->n = leaves->foliage.count;
	*at++ = s->n;
	if (s->n < BENCH_ELEMENTS_LEAST)
		return bench_reals(values, 1);
	s->factor = lod_arena_take(&leaves->arena, s->n, sizeof *s->factor);
	make_orders(s);
	bench_leaves_look(leaves, &s->tuning, TUNING_VIEWS, TUNING_SEED);
	bench_leaves_look(leaves, &s->tests, s->bench->full ? TESTS_MOST : TESTS_MOST / 2, TEST_SEED);
	measure_share(s);
	fill_tables(s);
	*at++ = (double)s->vertices[0][s->n];
	*at++ = s->layers;
	for (uint32_t i = 0; i < DISTANCES; i++)
		q[i] = cook_q(s, cook_lambda(i));
	for (int m = 0; m < METHODS; m++) {
		for (uint32_t i = 0; i < DISTANCES; i++)
			*at++ = reach(s->rows[m], s->row_count, q[i]) / cook_lambda(i);
		for (uint32_t i = 0; i < BENCH_SHARES; i++)
			*at++ = q_at(s->rows[m], s->row_count, bench_shares[i]);
	}
	return bench_reals(values, sizeof values / sizeof *values);
}

/* ---- All species ---- */

/* Savings of a method: mean over the distances, over those beyond the half, of all vertices together. */
enum { MEAN, FAR, TOTAL, KINDS };
struct species { struct bench_model model; struct bench_savings s; double saved[METHODS][KINDS]; bool closed; };
struct all { struct species of[SPECIES_MOST]; uint32_t count; };

void bench_savings_of(struct bench *bench, struct bench_savings *savings, const struct bench_model *model)
{
	struct study *s = eco_alloc(1, sizeof *s);
	double values[3 + METHODS * ROW], *at = values + 3;
	struct bench_model file = *model;
	s->bench = bench;
	s->model = &file;
	/* by what the file holds: the same plant in two scenes is measured once */
	snprintf(file.name, sizeof file.name, "%s", must_stamp(model->path));
	bench_leaves_unit(bench, "savings", &file, study_leaves, s, values,
		sizeof values / sizeof *values);
	free(s);
	*savings = (struct bench_savings){ (uint32_t)values[0], .vertices = values[1], .layers = values[2] };
	for (size_t m = 0; m < METHODS; m++, at += ROW) {
		memcpy(savings->ratio[m], at, sizeof savings->ratio[m]);
		memcpy(savings->q[m], at + DISTANCES, sizeof savings->q[m]);
	}
}

static void measure(struct bench *bench, const struct bench_model *model, struct species *one)
{
	*one = (struct species){ .model = *model };
	bench_savings_of(bench, &one->s, model);
	one->closed = one->s.vertices >= CLOSED_VERTICES && one->s.layers >= CLOSED_LAYERS;
	for (size_t m = 0; m < METHODS; m++) {
		double ours = 0, cook = 0;
		for (uint32_t d = 0; d < DISTANCES; d++) {
			double ratio = one->s.ratio[m][d], saved = 1 - ratio;
			one->saved[m][MEAN] += saved / DISTANCES;
			one->saved[m][FAR] += d >= DISTANCES / 2 ? saved / (DISTANCES / 2) : 0;
			ours += ratio * cook_lambda(d);
			cook += cook_lambda(d);
		}
		one->saved[m][TOTAL] = 1 - ours / cook;
	}
}

ECO_ORDER(ascending, double, [0])

/* In per cent, over all species or those with closed crowns. */
static double median(const struct all *all, int method, int kind, bool closed)
{
	double values[SPECIES_MOST];
	uint32_t count = 0;
	for (uint32_t i = 0; i < all->count; i++)
		if (!closed || all->of[i].closed)
			values[count++] = 100 * all->of[i].saved[method][kind];
	qsort(values, count, sizeof *values, ascending);
	return count ? (values[(count - 1) / 2] + values[count / 2]) / 2 : NAN;
}

static void write_tables(struct bench *bench, const struct all *all)
{
	uint32_t closed = 0;
	struct bench_column columns[2 * METHODS];
	char heads[2 * METHODS][64];
	for (size_t i = 0; i < 2 * METHODS; i++) {
		snprintf(heads[i], sizeof heads[i], "%s%s %%", bench_order_names[i / 2], i % 2 ? " at d >= .5" : "");
		columns[i] = (struct bench_column){ heads[i], 1 };
	}
	struct bench_table *layers = bench_table_described(bench, "species_layers",
		"plant,vertices of leaves,layers of leaves", columns, 2 * METHODS, true);
	for (uint32_t i = 0; i < all->count; i++) {
		const struct species *one = &all->of[i];
		double saved[2 * METHODS];
		for (size_t k = 0; k < 2 * METHODS; k++)
			saved[k] = 100 * one->saved[k / 2][k % 2 ? FAR : MEAN];
		bench_table_values(layers, saved, "%s,%.0f,%.1f", one->model.name, one->s.vertices, one->s.layers);
		closed += one->closed;
	}
	bench_table_close(layers);
	struct bench_table *table = bench_table_open(bench, "species_medians",
		"order (each with its best scale),median of savings %,at d >= .5 %,closed crowns: median %,"
		"closed crowns: at d >= .5 %,Neubert 2011 table 2 %", true);
	for (int m = 0; m < METHODS; m++)
		bench_table_row(table, "%s,%.1f,%.1f,%.1f,%.1f,%s", bench_order_names[m],
			median(all, m, MEAN, false), median(all, m, FAR, false), median(all, m, MEAN, true),
			median(all, m, FAR, true), methods[m].printed);
	bench_table_close(table);
	bench_say(bench, "Medians over %u plants, %u of them with closed crowns: %u vertices of leaves or "
		"more in %g layers or more. The paper's plants have 50,000 to 260,000, and its four rows "
		"are of one camera path through 1,276 trees; its Cook keeps areas only. Here Cook has the "
		"better of 1/lambda and of the scale that corrects for depth complexity. Density and "
		"orientation (the paper's \"silhouette\") take whole regions out: on crowns in which every "
		"leaf shows that opens holes.",
		all->count, closed, CLOSED_VERTICES, CLOSED_LAYERS);
}

/* Figures of the data folder's species. */
static void write_keys(struct bench *bench, const struct all *all)
{
	double x[DISTANCES], y[METHODS][DISTANCES] = { { 0 } }, mean[METHODS] = { 0 }, total[METHODS] = { 0 };
	struct bench_series series[METHODS];
	uint32_t count = 0;
	for (uint32_t i = 0; i < all->count; i++)
		count += !all->of[i].model.generated;
	for (uint32_t i = 0; i < all->count; i++) {
		const struct species *one = &all->of[i];
		if (one->model.generated)
			continue;
		for (int m = 0; m < METHODS; m++) {
			mean[m] += one->saved[m][MEAN] / count;
			total[m] += one->saved[m][TOTAL] / count;
		}
		for (uint32_t k = 0; k < METHODS * DISTANCES; k++)
			y[k / DISTANCES][k % DISTANCES] +=
				100 * (1 - one->s.ratio[k / DISTANCES][k % DISTANCES]) / count;
	}
	bench_key(bench, "saving_pruned_mean", count ? mean[BENCH_GREEDY] : NAN,
		">= 0.76: mean over species, leaves as they are");
	bench_key(bench, "saving_pruned_total", count ? total[BENCH_GREEDY] : NAN,
		">= 0.60: of all vertices, leaves as they are");
	bench_key(bench, "saving_packs_mean", count ? mean[BENCH_PACK] : NAN, "mean over species, packs");
	bench_key(bench, "saving_packs_total", count ? total[BENCH_PACK] : NAN, "of all vertices, packs");
	bench_key(bench, "saving_species", count, "species that count");
	for (uint32_t d = 0; d < DISTANCES; d++)
		x[d] = (double)d / DISTANCES;
	for (int m = 0; m < METHODS; m++)
		series[m] = (struct bench_series){ bench_order_names[m], x, y[m], DISTANCES, false };
	if (count)
		bench_plot(bench, &(struct bench_plot){ .name = "species-savings",
			.title = "Geometry saved against Cook at equal Q, mean over species",
			.x = "distance d; Cook draws (1-d)^2 of the vertices", .y = "saved, %", .series
			= series, .series_count = METHODS });
}

/* The quick bench takes the plants with the fewest leaves. */
static void run(struct bench *bench)
{
	struct all *all = eco_alloc(1, sizeof *all);
	struct bench_walk walk = { .bench = bench, .leaves = BENCH_ELEMENTS_LEAST, .most = SPECIES_MOST,
		.quick = 3, .quick_made = 1 };
	for (const struct bench_model *model; (model = bench_walk(&walk));) {
		measure(bench, model, &all->of[all->count++]);
		walk.found[model->generated]++;
	}
	if (all->count) {
		write_tables(bench, all);
		write_keys(bench, all);
	}
	free(all);
}

const struct bench_section bench_species = { "species", "Geometry saved against Cook at equal quality", run };
