/* Drawing a share of an organ, its best scale, and its best reach. */
#include "lod/build/measure/curve_ways.h"

#include <math.h>

#include "lod/ladder.h"

/* Wrong pixels for each pixel of the reference, beyond which each counts as much as all of Q. Without a bound
 * a few leaves of a sparse crown (needles, bamboo) swell to 8 wrong pixels for each (lod/EXPERIMENTS.md,
 * Bounds on wrong pixels). */
#define WRONG_MOST 2
/* Loss up to which a scale is smoothed towards its neighbours (lod/EXPERIMENTS.md, Smoothing scales). */
#define LITTLE 0.001
/* Vertices below which a plant is but a dot, and its loss counts in proportion. */
#define FEW 64.0
/* A reach that loses so much more than the best is not searched further unless it is chosen. */
#define HOPELESS 0.04
#define STEPS (LOD_CURVE_STEP_HIGH - LOD_CURVE_STEP_LOW + 1)

/* ---- 2^(step/8) ---- */

double lod_curve_scale(double step)
{
	static const double eighths[9] = { 1, 1.0905077326652577, 1.189207115002721, 1.2968395546510096,
		1.4142135623730951, 1.5422108254079408, 1.681792830507429, 1.8340080864093424, 2 };
	double scale = 0.25;
	step -= LOD_CURVE_STEP_LOW;
	while (step >= 8) {
		scale *= 2;
		step -= 8;
	}
	int whole = step >= 0 ? (int)step : 0;
	return scale * (eighths[whole] + (step - whole) * (eighths[whole + 1] - eighths[whole]));
}

/* ---- Drawing a share ---- */

void lod_curve_add(const struct lod_curve_organ *curve, const struct eco_ladder *ladder,
	const struct eco_curve *sample)
{
	struct lod_probe *probe = curve->probe;
	struct eco_curve samples[2] = { *sample, { .share = 1, .scale = 1, .reach = 1 } };
	struct eco_ladder measured = *ladder;
	measured.flags &= (uint8_t)~ECO_LADDER_ABOVE;
	measured.curve_first = 0;
	measured.curve_count = sample->share < 1 ? 2 : 1;
	probe->scene.curves = samples;
	probe->scene.curve_count = 2;
	struct lod_way way;
	lod_way_begin(&way, &probe->scene, &measured);
	uint64_t vertices = lod_way_vertices(&way, sample->share);
	double density = lod_way_density(&way, vertices);
	/* a whole-plant list: the cells show the rest */
	if ((curve->forms || curve->whole) && density < sample->reach)
		density = sample->reach;
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
	uint32_t count = lod_way_cuts(&way, vertices, density, 0, cuts);
	probe->scene.curves = probe->plant->curves;
	probe->scene.curve_count = probe->plant->curve_count;
	for (uint32_t i = 0; i < count; i++)
		lod_probe_add(probe, &cuts[i]);
}

void lod_curve_draw(const struct lod_curve_organ *curve, double share, double reach, double step)
{
	struct eco_curve sample = { .share = (float)share, .scale = (float)lod_curve_scale(step),
		.reach = (float)reach };
	lod_probe_clear(curve->probe);
	for (uint32_t i = 0; i < curve->member_count; i++)
		lod_curve_add(curve, lod_curve_member(curve, i), &sample);
}

/* ---- Searching the scale ---- */

struct search { const struct lod_curve_organ *curve; double share, reach; uint32_t stride; int most;
	double loss[STEPS]; };

static double loss_at(struct search *search, int step)
{
	double *known = &search->loss[step - LOD_CURVE_STEP_LOW];
	if (*known < 0) {
		struct lod_probe_result result;
		lod_curve_draw(search->curve, search->share, search->reach, step);
		lod_probe_compare(search->curve->probe, search->stride, &result);
		double balloons = result.fp + result.fn - WRONG_MOST;
		*known = result.loss + (balloons > 0 ? balloons : 0)
			+ (search->curve->whole ? fabs(result.fp - result.fn) : 0);      /* as much as the plant covers */
	}
	return *known;
}

/* Walks from *best in strides of `stride` while that lowers the loss. */
static void walk(struct search *search, int stride, int *best)
{
	for (int way = -1; way <= 1; way += 2) {
		bool moved = false;
		for (int next = *best + way * stride; next >= LOD_CURVE_STEP_LOW && next <= search->most
				&& loss_at(search, next) < loss_at(search, *best); next += way * stride) {
			*best = next;
			moved = true;
		}
		if (moved)
			return;
	}
}

/* The vertex of the parabola through a step and its neighbours, and how far from it the loss stays small. */
static void refine(struct search *search, int best, struct lod_curve_way *way)
{
	way->step = best;
	way->play = 0;
	way->loss = loss_at(search, best);
	if (best == LOD_CURVE_STEP_LOW || best == search->most)
		return;
	double low = loss_at(search, best - 1), high = loss_at(search, best + 1), bend = low - 2 * way->loss + high;
	way->play = bend > LITTLE / 8 ? sqrt(2 * LITTLE / bend) : 4;
	if (bend > 0)
		way->step = best + 0.5 * (low - high) / bend;
}

void lod_curve_try_way(const struct lod_curve_organ *curve, double share, struct lod_curve_way *way,
	double start, bool warm, double most)
{
	struct search search = { .curve = curve, .share = share, .reach = way->reach,
		.stride = curve->draft || curve->probe->views >= 8 ? 2 : 1,
		.most = curve->whole ? 0 : LOD_CURVE_STEP_HIGH };        /* splats behind leaves only shrink */
	for (int i = 0; i < STEPS; i++)
		search.loss[i] = -1;
	int best = (int)(start - LOD_CURVE_STEP_LOW + 0.5) + LOD_CURVE_STEP_LOW;
	way->given_up = false;
	if (warm) {
		way->step = best;
		way->loss = loss_at(&search, best);
		way->given_up = way->loss > most;
	}
	for (int stride = warm ? 1 : 8; stride > 0 && !way->given_up; stride /= 2)
		walk(&search, stride, &best);
	if (!way->given_up)
		refine(&search, best, way);
}

/* ---- Reaches ---- */

/* Number of elements whose cost, all in form `form`, is that of a sample. */
static double elements_in(const struct lod_curve_organ *curve, uint32_t sample, uint32_t form)
{
	double e = curve->samples[sample].share * curve->full / curve->unit[form];
	return e < 1 ? 1 : e < curve->elements ? e : curve->elements;
}

static void add_way(const struct lod_curve_organ *curve, struct lod_curve_sample *sample, uint32_t rung,
	double e)
{
	double vertices = sample->share * curve->full;
	struct lod_curve_way *way = &sample->ways[sample->way_count++];
	*way = (struct lod_curve_way){ .rung = rung, .reach = e / curve->elements };
	uint32_t stage = 0;
	while (stage + 2 < curve->units && e * curve->unit[stage + 1] <= vertices)
		stage++;
	double f = (vertices - e * curve->unit[stage]) / (curve->unit[stage + 1] - curve->unit[stage]);
	f = f < 0 ? 0 : f < e ? f : e;
	for (uint32_t i = 0; i < curve->units; i++)
		way->finer[i] = i <= stage ? e : i == stage + 1 ? f : 0;
}

/* Ways from all in full detail to all in the coarsest form, at every stride-th rung between. Any way can go
 * on: at its rung, or in full detail if that is too few elements for the vertices. */
static void place_ways(struct lod_curve_organ *curve, uint32_t at)
{
	struct lod_curve_sample *sample = &curve->samples[at];
	double low = elements_in(curve, at, curve->units - 1), high = elements_in(curve, at, 0);
	uint32_t first = 0, stride = 1;
	while (first < at && elements_in(curve, first, 0) <= low)
		first++;
	while ((at - first) / stride + 3 > LOD_CURVE_WAYS_MAX)
		stride++;
	sample->way_count = 0;
	if (low < high)
		add_way(curve, sample, ECO_NONE, low);
	for (uint32_t rung = first; rung < at; rung++)
		if (rung % stride == 0 && elements_in(curve, rung, 0) < high)
			add_way(curve, sample, rung, elements_in(curve, rung, 0));
	add_way(curve, sample, at, high);
}

void lod_curve_try_ways(struct lod_curve_organ *curve, uint32_t at, const struct lod_curve_sample *larger)
{
	struct lod_curve_sample *sample = &curve->samples[at];
	place_ways(curve, at);
	double least = 1e30;
	for (uint32_t i = sample->way_count; i-- > 0;) {
		struct lod_curve_way *way = &sample->ways[i];
		bool warm = i + 1 < sample->way_count;
		double start = warm ? sample->ways[i + 1].step : 0;
		for (uint32_t k = 0; larger && k < larger->way_count; k++)
			if (larger->ways[k].rung == way->rung) {
				start = larger->ways[k].step;
				warm = true;
			}
		lod_curve_try_way(curve, sample->share, way, start, warm, least + HOPELESS);
		least = way->loss < least ? way->loss : least;
	}
}

static bool ascends(const struct lod_curve_way *before, const struct lod_curve_way *after)
{
	const double rounding = 1 - 1e-9;
	for (int form = 0; form < LOD_CURVE_FORMS_MAX; form++)
		if (after->finer[form] < before->finer[form] * rounding)
			return false;
	return true;
}

/* The ascending sequence of ways with the least total loss (dynamic programming). Samples weigh alike, as
 * they lie evenly in log share, except those of the first few vertices. */
static void choose_ways(struct lod_curve_organ *curve, uint32_t count)
{
	static const double never = 1e30;
	double sum[LOD_CURVE_SAMPLES_MAX][LOD_CURVE_WAYS_MAX];
	uint8_t next[LOD_CURVE_SAMPLES_MAX][LOD_CURVE_WAYS_MAX];
	uint32_t at = 0;
	for (uint32_t i = count; i-- > 0;) {
		double vertices = curve->samples[i].share * curve->full, weight = vertices < FEW
			? vertices / FEW : 1;
		for (uint32_t k = 0; k < curve->samples[i].way_count; k++) {
			const struct lod_curve_way *way = &curve->samples[i].ways[k];
			const struct lod_curve_sample *larger = i + 1 < count ? &curve->samples[i + 1] : NULL;
			double least = larger ? never : 0;
			next[i][k] = 0;
			for (uint32_t n = 0; larger && n < larger->way_count; n++)
				if (ascends(way, &larger->ways[n]) && sum[i + 1][n] < least) {
					next[i][k] = (uint8_t)n;
					least = sum[i + 1][n];
				}
			sum[i][k] = weight * way->loss + least;
		}
	}
	for (uint32_t k = 1; count && k < curve->samples[0].way_count; k++)
		at = sum[0][k] < sum[0][at] ? k : at;
	for (uint32_t i = 0; i < count; at = next[i++][at])
		curve->samples[i].chosen = at;
}

void lod_curve_settle(struct lod_curve_organ *curve, uint32_t count)
{
	for (bool settled = false; !settled;) {
		settled = true;
		choose_ways(curve, count);
		for (uint32_t i = 0; i < count; i++) {
			struct lod_curve_sample *sample = &curve->samples[i];
			struct lod_curve_way *way = &sample->ways[sample->chosen];
			if (way->given_up) {
				lod_curve_try_way(curve, sample->share, way, way->step, true, 1e30);
				settled = false;
			}
			sample->reach = way->reach;
			sample->step = way->step;
			sample->play = way->play;
		}
	}
}

