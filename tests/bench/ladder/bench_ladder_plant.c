/* See bench_ladder_plant.h. */
#include "tests/bench/ladder/bench_ladder_plant.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/build/foliage.h"
#include "lod/build/impostor/impostor_make.h"
#include "lod/build/measure/probe.h"
#include "lod/build/splat/splat_fit.h"
#include "lod/ladder.h"
#include "tests/bench/baseline/cook.h"
#include "tests/bench/bench_leaves.h"
#include "tests/bench/bench.h"

#define PIXELS LOD_IMPOSTOR_PIXELS /* as large as an impostor may be drawn */
#define GRID_BITS 14u
#define TUNING 5u
#define TESTS 8u
#define TUNING_SEED 7411u
#define TEST_SEED 90217u
#define LAMBDA_LEAST 1e-4
#define KNEE 0.3 /* lambdas are a constant step apart above, a constant factor below */
#define STEP 0.04
#define FACTOR 1.3
#define MEAN_COSINE 0.5 /* projected area of leaves that face anywhere, over their area */

const char *const bench_ladder_names[BENCH_LADDER_ROWS] = { "pack's ladder", "lists only",
	"random order all else ours", "random order lists only" };

struct study {
	struct bench *bench;
	struct lod_plant plant;
	struct lod_probe probe;
	double full, elements; /* vertices of the foliage */
	double share;          /* lod_cook_share */
};

/* ---- Pictures ---- */

static bool is_foliage(const struct eco_ladder *ladder)
{
	return ladder->organ != ECO_ORGAN_WOOD && !(ladder->flags & (ECO_LADDER_WHOLE | ECO_LADDER_FAR));
}

static void place_eye(struct lod_probe *probe, struct lod_eye *eye, const double from[3])
{
	struct lod_v3 center = lod_v3_of((const float[3]){ 0, 0, 0 }), up = { 0, 0, 1 };
	struct lod_v3 back = lod_v3_unit((struct lod_v3){ from[0], from[1], from[2] });
	struct lod_v3 right = lod_v3_unit(lod_v3_cross(up, back)), top = lod_v3_cross(back, right);
	center = (struct lod_v3){ probe->center[0], probe->center[1], probe->center[2] };
	double away = lod_v3_distance(center, (struct lod_v3){ eye->at[0], eye->at[1], eye->at[2] });
	const double axis[3][3] = { { right.x, right.y, right.z }, { top.x, top.y, top.z },
		{ back.x, back.y, back.z } };
	for (int k = 0; k < 3; k++) {
		eye->right[k] = axis[0][k];
		eye->up[k] = axis[1][k];
		eye->forward[k] = -axis[2][k];
		eye->at[k] = probe->center[k] + away * axis[2][k];
	}
}

/* Tuning views, then test views; no build has either. */
static void open_probe(struct study *s, const struct eco_model *model)
{
	double directions[TUNING + TESTS][3];
	lod_probe_init(&s->probe, &s->plant, model,
		&(struct lod_probe_options){ .views = TUNING + TESTS, .pixels = PIXELS });
	lod_directions_spread(directions, TUNING, TUNING_SEED);
	lod_directions_spread(directions + TUNING, TESTS, TEST_SEED);
	for (uint32_t v = 0; v < TUNING + TESTS; v++)
		place_eye(&s->probe, &s->probe.eyes[v], directions[v]);
}

static void add_at(struct study *s, const struct eco_ladder *ladder, uint64_t vertices, double reach)
{
	struct lod_way way;
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
	lod_way_begin(&way, &s->probe.scene, ladder);
	double density = fmax(reach, lod_way_density(&way, vertices));
	uint32_t count = lod_way_cuts(&way, vertices, density, 0, cuts);
	for (uint32_t i = 0; i < count; i++)
		lod_probe_add(&s->probe, &cuts[i]);
}

static void add_wood(struct study *s)
{
	lod_probe_clear(&s->probe);
	for (uint32_t i = 0; i < s->plant.ladder_count; i++) {
		const struct eco_ladder *ladder = &s->plant.ladders[i];
		if (ladder->organ == ECO_ORGAN_WOOD && !(ladder->flags & (ECO_LADDER_WHOLE | ECO_LADDER_FAR)))
			add_at(s, ladder, lod_ladder_full(&s->probe.scene, ladder), 1);
	}
}

/* Q over views [first, first + count). */
static double q_of(const struct study *s, uint32_t first, uint32_t count)
{
	struct bench_wrong sum = { 0 };
	for (uint32_t v = first; v < first + count; v++) {
		sum.fp += s->probe.scores[v].fp;
		sum.fn += s->probe.scores[v].fn;
		sum.pixels += s->probe.reference_pixels[v];
	}
	return bench_wrong_q(&sum);
}

/* Scores the picture. */
static struct bench_ladder_point score(struct study *s, double lambda)
{
	struct lod_probe_result result;
	lod_probe_compare(&s->probe, 1, &result);
	return (struct bench_ladder_point){ lambda, q_of(s, 0, TUNING), q_of(s, TUNING, TESTS) };
}

static uint64_t covered(const struct study *s)
{
	uint64_t sum = 0;
	for (uint32_t v = 0; v < TUNING; v++)
		sum += s->probe.reference_pixels[v];
	return sum / TUNING;
}

/* Full detail is the reference; counts of the foliage, and how it overlaps. */
static void keep_full(struct study *s)
{
	double area = 0, pixel = s->probe.eyes[0].pixel_rad * 16 * s->probe.radius;
	add_wood(s);
	uint64_t wood = lod_probe_keep(&s->probe) ? covered(s) : 0;
	s->full = s->elements = 0;
	for (uint32_t i = 0; i < s->plant.ladder_count; i++) {
		const struct eco_ladder *ladder = &s->plant.ladders[i];
		if (!is_foliage(ladder))
			continue;
		uint64_t full = lod_ladder_full(&s->probe.scene, ladder);
		s->full += (double)full;
		s->elements += s->probe.lists[ladder->triangles].element_count;
		area += ladder->area;
		add_at(s, ladder, full, 1);
	}
	uint64_t all = lod_probe_keep(&s->probe) ? covered(s) : 0;
	s->share = lod_cook_share((uint32_t)s->elements, area * MEAN_COSINE / (pixel * pixel),
		all > wood ? (double)(all - wood) : 1);
}

/* ---- Rows ---- */

static uint32_t count_of(const struct bench_ladder_curve *curve) { return (uint32_t)curve->count; }

static void add_point(struct bench_ladder_curve *curve, struct bench_ladder_point point)
{
	curve->at[count_of(curve)] = point;
	curve->count++;
}

/* Every foliage ladder at that share of its vertices. */
static struct bench_ladder_point draw_share(struct study *s, double share)
{
	uint64_t vertices = 0;
	add_wood(s);
	for (uint32_t i = 0; i < s->plant.ladder_count; i++) {
		const struct eco_ladder *ladder = &s->plant.ladders[i];
		if (!is_foliage(ladder))
			continue;
		struct lod_way way;
		lod_way_begin(&way, &s->probe.scene, ladder);
		uint64_t here = lod_way_vertices(&way, share);
		vertices += here;
		add_at(s, ladder, here, lod_ladder_curve(&s->probe.scene, ladder, share).reach);
	}
	return score(s, (double)vertices / s->full);
}

/* Q of Cook's order and scale, with the correction of depth complexity or without it, whichever is better. */
static double draw_cook(struct study *s, double lambda)
{
	double q = -INFINITY;
	for (int depth = 0; depth < 2; depth++) {
		add_wood(s);
		for (uint32_t i = 0; i < s->plant.ladder_count; i++) {
			const struct eco_ladder *ladder = &s->plant.ladders[i];
			struct lod_forms forms;
			if (!is_foliage(ladder) || !lod_forms_find(&forms, &s->probe.scene, ladder))
				continue;
			uint32_t n = forms.own, kept = (uint32_t)fmax(1, (uint32_t)(lambda * n + 0.5));
			struct eco_cut cut = { .list = ladder->triangles,
				.end = (uint32_t)lod_forms_range_end(&forms, forms.count - 1, kept) };
			/* the scale is that of the vertices that are drawn */
			double each = (double)lod_ladder_full(&s->probe.scene, ladder) / n;
			kept = (uint32_t)fmax(1, (uint32_t)fmin(n, 3.0 * cut.end / each + 0.5));
			cut.scale = (float)(depth ? lod_cook_scale_depth(kept, n, s->share)
				: lod_cook_scale(kept, n));
			lod_probe_add(&s->probe, &cut);
		}
		q = fmax(q, score(s, lambda).q);
	}
	return q;
}

static void fill(struct study *s, struct bench_ladder_curve *curve)
{
	double least = fmax(LAMBDA_LEAST, 1 / s->full);
	for (double l = 1; l >= least && curve->count < BENCH_LADDER_POINTS;
		l = l > KNEE + STEP / 2 ? l - STEP : l / FACTOR)
		add_point(curve, draw_share(s, l));
}

/* Cook's, at the paper's distances. */
static double lambda_of(uint32_t i)
{
	double left = 1 - (i < 10 ? 0.01 * i : 0.1 + 0.09 * (i - 10));
	return left * left;
}

/* ---- Builds ---- */

static struct lod_plant_options options_of(uint32_t seed, bool random)
{
	return (struct lod_plant_options){ .name = "ladder", .seed = seed, .grid_bits = GRID_BITS,
		.no_splats = true, .random_leaves = random };
}

static void end(struct study *s)
{
	lod_probe_free(&s->probe);
	lod_plant_free(&s->plant);
}

static void measure_order(struct bench *bench, struct bench_ladder *ladder, const struct eco_model *model,
	uint32_t seed, bool random)
{
	struct study s = { .bench = bench };
	struct lod_plant_options options = options_of(seed, random);
	must(lod_plant_build(&s.plant, model, &options, must_error));
	must(lod_plant_measure(&s.plant, model, &options, must_error));
	open_probe(&s, model);
	keep_full(&s);
	ladder->elements = s.elements;
	if (s.full > 0)
		fill(&s, &ladder->kind[random ? BENCH_LADDER_SHUFFLED : BENCH_LADDER_GREEDY]);
	for (uint32_t i = 0; i < BENCH_DISTANCES && s.full > 0 && random; i++)
		ladder->cook_q[i] = draw_cook(&s, lambda_of(i));
	end(&s);
}

void bench_ladder_measure(struct bench *bench, struct bench_ladder *ladder, const struct eco_model *model,
	uint32_t seed)
{
	*ladder = (struct bench_ladder){ 0 };
	measure_order(bench, ladder, model, seed, true);
	measure_order(bench, ladder, model, seed, false);
}

/* ---- Splats ---- */

static void add_impostor(struct study *s, struct bench_ladder_curve *curve)
{
	struct lod_impostor impostor;
	if (!s->plant.impostor_count)
		return;
	lod_plant_open_impostor(&impostor, &s->plant, s->plant.impostor_count - 1);
	lod_probe_clear(&s->probe);
	lod_probe_add_impostor(&s->probe, &impostor);
	add_point(curve, score(s, 1 / s->full));
	lod_probe_clear(&s->probe);
	lod_impostor_close(&impostor);
}

static void fill_splats(struct study *s, const struct eco_ladder *ladder, struct bench_ladder_curve *curve)
{
	struct lod_way way;
	lod_way_begin(&way, &s->probe.scene, ladder);
	for (uint64_t v = way.full; v > 1 && curve->count + 1 < BENCH_LADDER_POINTS;
			v = lod_way_floor(&way, (uint64_t)((double)v / FACTOR))) {
		lod_probe_clear(&s->probe);
		add_at(s, ladder, v, 0);
		add_point(curve, score(s, (double)v / s->full));
	}
	add_impostor(s, curve);
}

void bench_ladder_splats(struct bench *bench, struct bench_ladder_curve *curve, const struct eco_model *model)
{
	struct study s = { .bench = bench };
	struct lod_plant_options options = options_of(1, true);
	*curve = (struct bench_ladder_curve){ 0 };
	must(lod_plant_build(&s.plant, model, &options, must_error));
	must(lod_plant_add_splats(&s.plant, model, &options, must_error));
	open_probe(&s, model);
	keep_full(&s);
	for (uint32_t i = 0; i < s.plant.ladder_count && s.full > 0; i++)
		if (s.plant.ladders[i].flags & ECO_LADDER_WHOLE)
			fill_splats(&s, &s.plant.ladders[i], curve);
	end(&s);
}

/* ---- Savings ---- */

/* The highest tuned Q of points of at most that lambda; between points linear. */
static double tuned_at(const struct bench_ladder_curve *curve, double lambda)
{
	uint32_t i = 0;
	while (i < count_of(curve) && curve->at[i].lambda > lambda)
		i++;
	if (i == count_of(curve))
		return -INFINITY;
	if (i == 0)
		return curve->at[0].tuned;
	const struct bench_ladder_point *high = &curve->at[i - 1], *low = &curve->at[i];
	double t = (lambda - low->lambda) / (high->lambda - low->lambda);
	return low->tuned + t * (high->tuned - low->tuned);
}

static double reach_one(const struct bench_ladder_curve *curve, const struct bench_ladder_curve *other,
	double q)
{
	double least = 1;
	for (uint32_t i = count_of(curve); i-- > 0;) {
		const struct bench_ladder_point *at = &curve->at[i], *below = at + 1;
		if (at->q < q || (other && tuned_at(other, at->lambda) > at->tuned))
			continue;
		least = at->lambda;
		if (i + 1 < curve->count && below->q < q && at->q > below->q &&
			(!other || tuned_at(other, below->lambda) <= below->tuned))
			least = below->lambda +
				(q - below->q) / (at->q - below->q) * (at->lambda - below->lambda);
		break;
	}
	return least;
}

/* The least lambda of either curve whose Q is at least `q`, 1 if there is none. A point does not count where
 * the other curve has the higher tuned Q at no more vertices. */
static double reach(const struct bench_ladder_curve *lists, const struct bench_ladder_curve *splats, double q)
{
	if (!splats || !count_of(splats))
		return reach_one(lists, NULL, q);
	return fmin(reach_one(lists, splats, q), reach_one(splats, lists, q));
}

double bench_ladder_saving(const struct bench_ladder *ladder, const struct bench_ladder_curve *splats,
	enum bench_ladder_row row, bool total)
{
	const struct bench_ladder_curve *curve = &ladder->kind[row < BENCH_LADDER_RANDOM ? BENCH_LADDER_GREEDY
		: BENCH_LADDER_SHUFFLED];
	bool all = row == BENCH_LADDER_OURS || row == BENCH_LADDER_RANDOM;
	double sum = 0, ours = 0, cook = 0;
	for (uint32_t d = 0; d < BENCH_DISTANCES; d++) {
		double lambda = lambda_of(d), reached = reach(curve, all ? splats : NULL, ladder->cook_q[d]);
		sum += 1 - reached / lambda;
		ours += reached;
		cook += lambda;
	}
	return total ? 1 - ours / cook : sum / BENCH_DISTANCES;
}
