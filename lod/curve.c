/* Curves (Neubert 2011, section 2.2): for shares of an organ's vertices from one element up, the area factor s_opt that minimises the
 * distance of (Precision, Recall) to (1, 1), and the wrong pixels that are left.
 *
 * What is measured is what will be drawn: the cut sets of lod/ladder.h, over views all around (probe.h), against the organ's own
 * full detail. Scales are kept relative to Cook's 1/lambda, whose singularity at 0 is thus taken out: s/s_Cook is a slow function
 * of log lambda, so the search starts from the neighbouring share's answer, walks an eighth of an octave at a time and ends with
 * a parabola. From many elements to few, as the error surface of a few elements is rough and that of many is not.
 *
 * Leaves come in several forms, and the same vertices show many elements as points or few as they are. At each share some reaches
 * between these ends are tried, the same numbers of elements at all shares, so that a way may stay at one while vertices go into
 * finer forms; and the way through them is the one of least loss in all on which nothing that was drawn is dropped or coarsened
 * again (dynamic programming over the shares): what a ladder draws at a share is then what was measured there.
 *
 * A complex plant's organ is a coarse list for the whole plant and the rest of the same order in cells. Its curve is measured over
 * the whole: each ladder draws its part of the elements that the share reaches, as when all cells stand at one distance. All these
 * ladders share the curve.
 *
 * Two touches make curves fit for a planner. The scales are smoothed over neighbouring shares, as a scale that jumps would be seen;
 * and the error is made non-increasing by the least-squares monotone fit (pool adjacent violators), as more vertices must never
 * look worse to it. All arithmetic is +, -, *, / and sqrt in fixed order: the same curves on every machine. */
#include "lod/curve.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/grid.h"
#include "lod/ladder.h"
#include "lod/probe.h"

#define SAMPLES_MOST 42u             /* of LOD_CURVE_SAMPLES_MAX: the rest is for levels */
#define STEP_LOW -16                 /* scales are 2^(step/8) times Cook's: 1/4 to 8. Up to 4 some shrubs lose 0.015 of Q and a meadow 0.005; up to
				      * 64 sparse crowns become balloons of a few leaves, and forests lose */
#define STEP_HIGH 24
#define STEPS (STEP_HIGH - STEP_LOW + 1)
#define WRONG_MOST 1.5               /* wrong pixels to each that there is to cover, beyond which each counts as much as all of Q. Minimising
                                      * 1 - Q alone blows a few leaves of a sparse crown (needles, bamboo) up to 8 wrong pixels each;
                                      * others stay below 1.2. With 1, scenes lose, as plants hide each other's wrong pixels */
#define LITTLE 0.001                 /* loss for which a scale gives way to those of its neighbours. On other views of eight plants
                                      * that costs .0003, .004 at most; without this bound .0008, .017 at most; scales that are not
                                      * smoothed vary a quarter more */
#define FEW 64.0                     /* vertices below which a plant is but a dot, and what is best there matters in proportion */
#define HOPELESS 0.04                /* loss more than the best reach's by which another is not looked at further until it is chosen */
#define FORMS_MAX 4
#define WAYS_MAX 12                  /* reaches tried at a share: from all in full detail (0) to all in the coarsest form */

struct way {                         /* one reach at one share */
	uint32_t rung;               /* number of the sample whose vertices, all in the coarsest form, are this reach; ECO_NONE: of full detail */
	double reach, step, loss;    /* step: scale is 2^(step/8) times Cook's */
	double play;                 /* steps by which the scale may differ from the best at little loss */
	double finer[FORMS_MAX];     /* elements in this form or a finer one */
	bool given_up;               /* its scale is not the best */
};

struct sample {
	double share;                /* of the organ's vertices */
	double reach, step, play;
	double fp, fn;
	bool free;                   /* its scale is there to be chosen */
	struct way ways[WAYS_MAX];   uint32_t way_count, chosen;
};

struct organ_curve {                 /* ladders that share one curve */
	struct lod_probe *probe;
	uint32_t *members, member_count;         /* indices of ladders; [0] leads: the whole plant's where there is one */
	bool far_only;               /* FAR ladders: measured against what the organ's others draw */
	bool scaled;                 /* not wood */
	bool forms;                  /* leaves in several forms */
	double unit[FORMS_MAX];      /* forms: mean vertices of an element, coarsest first */
	uint32_t units;
	double elements, full;       /* of all members; vertices */
	struct sample samples[LOD_CURVE_SAMPLES_MAX];
	uint32_t sample_count;
	struct lod_solved solved;
};

/* ---- 2^(step/8) ---- */

static double scale_of(double step)
{
	static const double eighths[9] = { 1, 1.0905077326652577, 1.189207115002721, 1.2968395546510096, 1.4142135623730951,
		1.5422108254079408, 1.681792830507429, 1.8340080864093424, 2 };
	double scale = 0.25;
	step -= STEP_LOW;
	while (step >= 8) {
		scale *= 2;
		step -= 8;
	}
	int whole = step >= 0 ? (int)step : 0;
	return scale * (eighths[whole] + (step - whole) * (eighths[whole + 1] - eighths[whole]));
}

/* ---- Drawing a share ---- */

static const struct eco_ladder *member(const struct organ_curve *curve, uint32_t i)
{
	return &curve->probe->plant->ladders[curve->members[i]];
}

static uint64_t primitives(const struct organ_curve *curve, uint32_t list)
{
	return list == ECO_NONE ? 0 : curve->probe->lists[list].primitive_count;
}

static enum eco_code add_member(const struct organ_curve *curve, const struct eco_ladder *ladder, const struct eco_curve *sample,
	struct eco_error *error)
{
	struct lod_probe *probe = curve->probe;
	struct eco_curve samples[2] = { *sample, { .share = 1, .scale = 1, .reach = 1 } };
	struct eco_ladder measured = *ladder;
	measured.curve_first = 0;
	measured.curve_count = sample->share < 1 ? 2 : 1;
	probe->scene.curves = samples;
	probe->scene.curve_count = 2;
	uint64_t vertices = lod_ladder_vertices(&probe->scene, &measured, sample->share);
	double density = lod_ladder_density(&probe->scene, &measured, vertices);
	if (curve->forms && density < sample->reach)         /* a whole-plant list: the cells show the rest */
		density = sample->reach;
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
	uint32_t count = lod_ladder_cuts(&probe->scene, &measured, vertices, density, cuts);
	probe->scene.curves = probe->plant->curves;
	probe->scene.curve_count = probe->plant->curve_count;
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < count && !code; i++)
		code = lod_probe_add(probe, &cuts[i], error);
	return code;
}

static enum eco_code draw(const struct organ_curve *curve, double share, double reach, double step, struct eco_error *error)
{
	struct eco_curve sample = { .share = (float)share, .scale = (float)scale_of(step), .reach = (float)reach };
	enum eco_code code = ECO_OK;
	lod_probe_clear(curve->probe);
	for (uint32_t i = 0; i < curve->member_count && !code; i++)
		code = add_member(curve, member(curve, i), &sample, error);
	return code;
}

/* ---- Searching the scale ---- */

struct search { const struct organ_curve *curve; double share, reach; uint32_t stride; double loss[STEPS]; };

static enum eco_code loss_at(struct search *search, int step, double *loss, struct eco_error *error)
{
	double *known = &search->loss[step - STEP_LOW];
	if (*known < 0) {
		enum eco_code code = draw(search->curve, search->share, search->reach, step, error);
		if (code)
			return code;
		struct lod_probe_result result;
		lod_probe_compare(search->curve->probe, search->stride, &result);
		double balloons = result.fp + result.fn - WRONG_MOST;
		*known = result.loss + (balloons > 0 ? balloons : 0);
	}
	*loss = *known;
	return ECO_OK;
}

/* Walks from *best in strides of `stride` while that lowers the loss. */
static enum eco_code walk(struct search *search, int stride, int *best, struct eco_error *error)
{
	double least, loss;
	enum eco_code code = loss_at(search, *best, &least, error);
	for (int way = -1; way <= 1 && !code; way += 2) {
		for (bool moved = false;; moved = true) {
			int next = *best + way * stride;
			if (next < STEP_LOW || next > STEP_HIGH || (code = loss_at(search, next, &loss, error)) || !(loss < least)) {
				if (moved)
					return code;
				break;
			}
			*best = next;
			least = loss;
		}
	}
	return code;
}

/* Vertex of the parabola through a step and its neighbours, and how far from it the loss is small. */
static enum eco_code refine(struct search *search, int best, struct way *way, struct eco_error *error)
{
	double low = 0, high = 0;
	way->step = best;
	way->play = 0;
	enum eco_code code = loss_at(search, best, &way->loss, error);
	if (code || best == STEP_LOW || best == STEP_HIGH)
		return code;
	code = loss_at(search, best - 1, &low, error);
	if (!code)
		code = loss_at(search, best + 1, &high, error);
	if (code)
		return code;
	double bend = low - 2 * way->loss + high;
	way->play = bend > LITTLE / 8 ? sqrt(2 * LITTLE / bend) : 4;
	if (bend > 0)
		way->step = best + 0.5 * (low - high) / bend;
	return ECO_OK;
}

/* The best scale for one reach, from step `start` on; `warm`: that is near the answer, and is enough where the loss there is more than `most`. */
static enum eco_code try_way(const struct organ_curve *curve, double share, struct way *way, double start, bool warm, double most,
	struct eco_error *error)
{
	struct search search = { .curve = curve, .share = share, .reach = way->reach, .stride = curve->probe->views >= 8 ? 2 : 1 };
	for (int i = 0; i < STEPS; i++)
		search.loss[i] = -1;
	int best = (int)(start - STEP_LOW + 0.5) + STEP_LOW;
	enum eco_code code = ECO_OK;
	way->given_up = warm && !(code = loss_at(&search, best, &way->loss, error)) && way->loss > most;
	if (way->given_up) {
		way->step = best;
		return ECO_OK;
	}
	for (int stride = warm ? 2 : 8; stride > 0 && !code; stride /= 2)
		code = walk(&search, stride, &best, error);
	return code ? code : refine(&search, best, way, error);
}

/* ---- Reaches ---- */

/* Elements that a sample's vertices come to, all in form `form`. */
static double elements_in(const struct organ_curve *curve, uint32_t sample, uint32_t form)
{
	double e = curve->samples[sample].share * curve->full / curve->unit[form];
	return e < 1 ? 1 : e < curve->elements ? e : curve->elements;
}

static void add_way(const struct organ_curve *curve, struct sample *sample, uint32_t rung, double e)
{
	double vertices = sample->share * curve->full;
	struct way *way = &sample->ways[sample->way_count++];
	*way = (struct way){ .rung = rung, .reach = e / curve->elements };
	uint32_t stage = 0;
	while (stage + 2 < curve->units && e * curve->unit[stage + 1] <= vertices)
		stage++;
	double f = (vertices - e * curve->unit[stage]) / (curve->unit[stage + 1] - curve->unit[stage]);
	f = f < 0 ? 0 : f < e ? f : e;
	for (uint32_t i = 0; i < curve->units; i++)
		way->finer[i] = i <= stage ? e : i == stage + 1 ? f : 0;
}

/* From all in full detail to all in the coarsest form; between them every stride-th rung. Any way can go on: at its rung, or, where
 * that is too few elements for the vertices, in full detail. */
static void place_ways(struct organ_curve *curve, uint32_t at)
{
	struct sample *sample = &curve->samples[at];
	double low = elements_in(curve, at, curve->units - 1), high = elements_in(curve, at, 0);
	uint32_t first = 0, stride = 1;
	while (first < at && elements_in(curve, first, 0) <= low)
		first++;
	while ((at - first) / stride + 3 > WAYS_MAX)
		stride++;
	sample->way_count = 0;
	if (low < high)
		add_way(curve, sample, ECO_NONE, low);
	for (uint32_t rung = first; rung < at; rung++)
		if (rung % stride == 0 && elements_in(curve, rung, 0) < high)
			add_way(curve, sample, rung, elements_in(curve, rung, 0));
	add_way(curve, sample, at, high);
}

/* Tries all ways of a sample, each from the scale that was best for the same rung at the next larger share, or from its neighbour's. */
static enum eco_code try_ways(struct organ_curve *curve, uint32_t at, const struct sample *larger, struct eco_error *error)
{
	struct sample *sample = &curve->samples[at];
	enum eco_code code = ECO_OK;
	place_ways(curve, at);
	double least = 1e30;
	for (uint32_t i = sample->way_count; i-- > 0 && !code;) {
		struct way *way = &sample->ways[i];
		bool warm = i + 1 < sample->way_count;
		double start = warm ? sample->ways[i + 1].step : 0;
		for (uint32_t k = 0; larger && k < larger->way_count; k++)
			if (larger->ways[k].rung == way->rung) {
				start = larger->ways[k].step;
				warm = true;
			}
		code = try_way(curve, sample->share, way, start, warm, least + HOPELESS, error);
		least = !code && way->loss < least ? way->loss : least;
	}
	return code;
}

static bool ascends(const struct way *before, const struct way *after)
{
	const double rounding = 1 - 1e-9;
	for (int form = 0; form < FORMS_MAX; form++)
		if (after->finer[form] < before->finer[form] * rounding)
			return false;
	return true;
}

/* The ascending way of least loss in all: samples count alike, as they lie evenly in log share, but for the first few vertices. */
static void choose_ways(struct organ_curve *curve, uint32_t count)
{
	static const double never = 1e30;
	double sum[LOD_CURVE_SAMPLES_MAX][WAYS_MAX];
	uint8_t next[LOD_CURVE_SAMPLES_MAX][WAYS_MAX];
	uint32_t at = 0;
	for (uint32_t i = count; i-- > 0;) {
		double vertices = curve->samples[i].share * curve->full, weight = vertices < FEW ? vertices / FEW : 1;
		for (uint32_t k = 0; k < curve->samples[i].way_count; k++) {
			const struct way *way = &curve->samples[i].ways[k];
			const struct sample *larger = i + 1 < count ? &curve->samples[i + 1] : NULL;
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

/* What was given up is looked for where it is chosen nevertheless, as what goes before it or comes after it was worth that. It only gets better,
 * so this ends. */
static enum eco_code settle_ways(struct organ_curve *curve, uint32_t count, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (bool settled = false; !settled && !code;) {
		settled = true;
		choose_ways(curve, count);
		for (uint32_t i = 0; i < count && !code; i++) {
			struct sample *sample = &curve->samples[i];
			struct way *way = &sample->ways[sample->chosen];
			if (way->given_up) {
				code = try_way(curve, sample->share, way, way->step, true, 1e30, error);
				settled = false;
			}
			sample->reach = way->reach;
			sample->step = way->step;
			sample->play = way->play;
		}
	}
	return code;
}

/* ---- Which shares ---- */

static void add_sample(struct organ_curve *curve, double share, bool scale_is_free)
{
	struct sample *last = curve->sample_count ? &curve->samples[curve->sample_count - 1] : NULL;
	scale_is_free &= share < 1;
	if (!(share > 0 && share <= 1) || curve->sample_count == LOD_CURVE_SAMPLES_MAX || (last && !((float)share > (float)last->share)))
		return;
	curve->samples[curve->sample_count++] = (struct sample){ .share = share, .free = scale_is_free, .reach = 1 };
}

static double grown(double n, double factor)
{
	return n * factor > n + 1 ? n * factor : n + 1;
}

/* Shares of the numbers of primitives from one to `all`, four an octave, or fewer where that were too many; `per`: share of one. */
static void sample_geometrically(struct organ_curve *curve, double all, double per)
{
	static const double factors[] = { 1.189207115002721, 1.2599210498948732, 1.4142135623730951, 2 };
	size_t f = 0;
	for (; f + 1 < sizeof factors / sizeof factors[0]; f++) {
		uint32_t count = 1;
		for (double n = 1; n < all; count++)
			n = grown(n, factors[f]);
		if (count <= SAMPLES_MOST)
			break;
	}
	for (double n = 1; n < all; n = grown(n, factors[f]))
		if ((double)(uint64_t)(n + 0.5) < all)
			add_sample(curve, (double)(uint64_t)(n + 0.5) * per, curve->scaled);
}

/* Lines or points one by one, then where each level of the largest ladder begins. */
static void sample_levels(struct organ_curve *curve)
{
	const struct eco_scene *scene = &curve->probe->scene;
	const struct eco_ladder *largest = member(curve, 0);
	for (uint32_t i = 1; i < curve->member_count; i++)
		if (lod_ladder_full(scene, member(curve, i)) > lod_ladder_full(scene, largest))
			largest = member(curve, i);
	uint64_t first = lod_ladder_stage_end(scene, largest), full = lod_ladder_full(scene, largest), unit = lod_ladder_next(scene, largest, 0);
	if (first)
		sample_geometrically(curve, (double)first / (double)unit, lod_ladder_share(scene, largest, unit));
	add_sample(curve, lod_ladder_share(scene, largest, first), curve->scaled);
	for (uint64_t v = first; v < full;) {
		v = lod_ladder_next(scene, largest, v);
		add_sample(curve, lod_ladder_share(scene, largest, v), false);
	}
	add_sample(curve, 1, false);
}

static void choose_samples(struct organ_curve *curve)
{
	curve->sample_count = 0;
	if (!curve->forms) {
		sample_levels(curve);
		return;
	}
	sample_geometrically(curve, curve->full / curve->unit[0], curve->unit[0] / curve->full);
	add_sample(curve, 1, false);
}

/* ---- Smoothing ---- */

/* Twice [1 2 1]/4 over the samples whose scale is free, as far as each has play: where leaves turn into another form the best scale may
 * change fast. The samples are evenly spaced in log share but for the first few. */
static void smooth_steps(struct organ_curve *curve)
{
	double best[LOD_CURVE_SAMPLES_MAX];
	uint32_t n = 0;
	for (; n < curve->sample_count && curve->samples[n].free; n++)
		best[n] = curve->samples[n].step;
	for (int round = 0; round < 2; round++) {
		double before = n ? curve->samples[0].step : 0;
		for (uint32_t i = 0; i + 1 < n; i++) {
			struct sample *sample = &curve->samples[i];
			double here = sample->step, smooth = (before + 2 * here + curve->samples[i + 1].step) / 4;
			smooth = smooth < best[i] + sample->play ? smooth : best[i] + sample->play;
			sample->step = smooth > best[i] - sample->play ? smooth : best[i] - sample->play;
			before = here;
		}
	}
}

/* Pool adjacent violators: the non-increasing sequence of errors nearest to the measured one. fp and fn keep their ratio. */
static void make_monotone(struct organ_curve *curve)
{
	double mean[LOD_CURVE_SAMPLES_MAX], weight[LOD_CURVE_SAMPLES_MAX];
	uint32_t ends[LOD_CURVE_SAMPLES_MAX], pools = 0;
	for (uint32_t i = 0; i < curve->sample_count; i++) {
		mean[pools] = curve->samples[i].fp + curve->samples[i].fn;
		weight[pools] = 1;
		ends[pools++] = i + 1;
		while (pools > 1 && mean[pools - 2] < mean[pools - 1]) {
			double both = weight[pools - 2] + weight[pools - 1];
			mean[pools - 2] = (mean[pools - 2] * weight[pools - 2] + mean[pools - 1] * weight[pools - 1]) / both;
			weight[pools - 2] = both;
			ends[pools - 2] = ends[pools - 1];
			pools--;
		}
	}
	for (uint32_t pool = 0, i = 0; pool < pools; pool++) {
		for (; i < ends[pool]; i++) {
			struct sample *sample = &curve->samples[i];
			double error = sample->fp + sample->fn;
			if (error > 0)
				sample->fp *= mean[pool] / error, sample->fn *= mean[pool] / error;
			else
				sample->fn = mean[pool];
		}
	}
}

/* ---- One curve ---- */

static enum eco_code keep_reference(struct organ_curve *curve, bool *any, struct eco_error *error)
{
	const struct lod_plant *plant = curve->probe->plant;
	enum eco_code code = ECO_OK;
	if (!curve->far_only) {
		code = draw(curve, 1, 1, 0, error);
	} else {
		const struct eco_ladder *far = member(curve, 0);
		const struct eco_curve all = { .share = 1, .scale = 1, .reach = 1 };
		lod_probe_clear(curve->probe);
		for (uint32_t i = 0; i < plant->ladder_count && !code; i++) {
			const struct eco_ladder *ladder = &plant->ladders[i];
			if (ladder->organ == far->organ && !(ladder->flags & ECO_LADDER_FAR))
				code = add_member(curve, ladder, &all, error);
		}
	}
	*any = !code && lod_probe_keep(curve->probe);
	return code;
}

/* Progress of the whole: `done` of `all` samples. */
struct progress { const struct lod_plant_options *options; uint32_t done, all; };

static enum eco_code advance(struct progress *progress, struct eco_error *error)
{
	progress->done++;
	if (progress->options->progress && !progress->options->progress(progress->options->ctx, (double)progress->done / progress->all))
		return eco_fail(error, ECO_INTERRUPTED, "interrupted while measuring curves");
	return ECO_OK;
}

static enum eco_code measure_ways(struct organ_curve *curve, struct progress *progress, struct eco_error *error)
{
	double step = 0;
	uint32_t chosen = 0;
	bool several = curve->forms && curve->units > 1;
	enum eco_code code = ECO_OK;
	for (uint32_t i = curve->sample_count; i-- > 0 && !code;) {
		struct sample *sample = &curve->samples[i];
		if (sample->free && several) {
			code = try_ways(curve, i, chosen ? &curve->samples[i + 1] : NULL, error);
			chosen = chosen ? chosen : i + 1;
		} else if (sample->free) {
			struct way way = { .reach = sample->share };
			code = try_way(curve, sample->share, &way, step, chosen > 0, 1e30, error);
			chosen = chosen ? chosen : i + 1;
			sample->step = step = way.step;
			sample->play = way.play;
			sample->reach = curve->forms ? way.reach : 1;
		}
		if (!code)
			code = advance(progress, error);
	}
	return code || !several ? code : settle_ways(curve, chosen, error);
}

static enum eco_code measure_errors(struct organ_curve *curve, struct progress *progress, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < curve->sample_count && !code; i++) {
		struct sample *sample = &curve->samples[i];
		if (!sample->free)
			sample->step = 0;
		code = draw(curve, sample->share, sample->reach, sample->step, error);
		if (code)
			break;
		struct lod_probe_result result;
		lod_probe_compare(curve->probe, 1, &result);
		sample->fp = result.fp;
		sample->fn = result.fn;
		code = advance(progress, error);
	}
	return code;
}

static enum eco_code measure_curve(struct organ_curve *curve, struct progress *progress, struct eco_error *error)
{
	bool any;
	enum eco_code code = keep_reference(curve, &any, error);
	if (!code && !any)
		curve->sample_count = 0;
	if (!code)
		code = measure_ways(curve, progress, error);
	for (uint32_t i = 0; i < curve->sample_count; i++)
		if (curve->samples[i].free)
			lod_solved_add(&curve->solved, curve->samples[i].step > STEP_LOW && curve->samples[i].step < STEP_HIGH);
	smooth_steps(curve);
	if (!code)
		code = measure_errors(curve, progress, error);
	make_monotone(curve);
	return code;
}

/* ---- Which ladders share a curve ---- */

static uint32_t image_of(const struct lod_plant *plant, const struct eco_ladder *ladder)
{
	uint32_t list = ladder->triangles != ECO_NONE ? ladder->triangles : ladder->lines != ECO_NONE ? ladder->lines : ladder->points;
	return list == ECO_NONE ? ECO_NONE : plant->lists[list].list.image;
}

static bool same_curve(const struct lod_plant *plant, const struct eco_ladder *a, const struct eco_ladder *b)
{
	bool far = a->flags & ECO_LADDER_FAR;
	return a->organ == b->organ && far == (bool)(b->flags & ECO_LADDER_FAR) && (far || image_of(plant, a) == image_of(plant, b));
}

static bool is_form(const struct organ_curve *curve, uint32_t list)
{
	return primitives(curve, list) && curve->probe->lists[list].coder == ECO_CODER_FORM;
}

static void add_unit(struct organ_curve *curve, uint32_t list)
{
	const struct eco_list *l = &curve->probe->lists[list];
	curve->unit[curve->units++] = eco_list_vertices(l) * (double)l->primitive_count / l->element_count;
}

static void sum_up(struct organ_curve *curve)
{
	const struct eco_ladder *first = member(curve, 0);
	curve->forms = first->organ != ECO_ORGAN_WOOD && first->level_count == 0 && primitives(curve, first->triangles);
	for (uint32_t i = 0; i < curve->member_count; i++) {
		const struct eco_ladder *ladder = member(curve, i);
		curve->full += (double)lod_ladder_full(&curve->probe->scene, ladder);
		if (curve->forms)
			curve->elements += curve->probe->lists[ladder->triangles].element_count;
	}
	if (!curve->forms)
		return;
	const uint32_t lists[] = { first->points, first->lines, first->simple };
	for (int i = 0; i < 3; i++)
		if (is_form(curve, lists[i]))
			add_unit(curve, lists[i]);
	curve->unit[curve->units++] = curve->full / curve->elements;
}

/* Ladders from `first` on that share its curve and have none yet; `done` marks them. */
static void gather(struct organ_curve *curve, struct lod_probe *probe, uint32_t first, bool *done, uint32_t *members)
{
	const struct lod_plant *plant = probe->plant;
	*curve = (struct organ_curve){ .probe = probe, .members = members };
	for (uint32_t i = first; i < plant->ladder_count; i++) {
		if (done[i] || (i != first && !same_curve(plant, &plant->ladders[first], &plant->ladders[i])))
			continue;
		done[i] = true;
		curve->members[curve->member_count++] = i;
	}
	curve->far_only = plant->ladders[first].flags & ECO_LADDER_FAR;
	curve->scaled = plant->ladders[first].organ != ECO_ORGAN_WOOD;
	sum_up(curve);
	if (curve->full > 0)
		choose_samples(curve);
}

static enum eco_code append(struct lod_plant *plant, const struct organ_curve *curve, struct eco_error *error)
{
	struct eco_curve *grown = realloc(plant->curves, (plant->curve_count + curve->sample_count + 1) * sizeof *grown);
	if (!grown)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for curves");
	plant->curves = grown;
	plant->solved[LOD_SOLVER_SCALE].runs += curve->solved.runs;
	plant->solved[LOD_SOLVER_SCALE].converged += curve->solved.converged;
	for (uint32_t i = 0; i < curve->member_count; i++) {
		plant->ladders[curve->members[i]].curve_first = plant->curve_count;
		plant->ladders[curve->members[i]].curve_count = curve->sample_count;
	}
	for (uint32_t i = 0; i < curve->sample_count; i++) {
		const struct sample *s = &curve->samples[i];
		plant->curves[plant->curve_count++] = (struct eco_curve){ .share = (float)s->share,
			.scale = curve->scaled ? (float)scale_of(s->step) : 1, .reach = (float)s->reach, .fp = (float)s->fp, .fn = (float)s->fn };
	}
	return ECO_OK;
}

static enum eco_code measure_all(struct lod_plant *plant, struct lod_probe *probe, struct progress *progress, bool *done,
	uint32_t *members, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (int pass = 0; pass < 2 && !code; pass++) {       /* first only counts, for progress */
		memset(done, 0, plant->ladder_count * sizeof *done);
		for (uint32_t i = 0; i < plant->ladder_count && !code; i++) {
			struct organ_curve curve;
			if (done[i])
				continue;
			gather(&curve, probe, i, done, members);
			if (pass == 0) {
				progress->all += 2 * curve.sample_count;
				continue;
			}
			code = measure_curve(&curve, progress, error);
			if (!code)
				code = append(plant, &curve, error);
		}
	}
	return code;
}

enum eco_code lod_curve_measure(struct lod_plant *plant, const struct eco_model *model, const struct lod_plant_options *options,
	struct eco_error *error)
{
	struct lod_probe probe;
	struct lod_probe_options size = { options->views ? options->views : 12, options->pixels ? options->pixels : 256, options->each,
		options->ctx };
	enum eco_code code = lod_probe_init(&probe, plant, model, &size, error);
	if (code)
		return code;
	free(plant->curves);
	plant->curves = NULL;
	plant->curve_count = 0;
	plant->solved[LOD_SOLVER_SCALE] = (struct lod_solved){ 0 };
	for (uint32_t i = 0; i < plant->ladder_count; i++)
		plant->ladders[i].curve_first = plant->ladders[i].curve_count = 0;
	struct progress progress = { options, 0, 0 };
	bool *done = calloc(plant->ladder_count + 1, sizeof *done);
	uint32_t *members = calloc(plant->ladder_count + 1, sizeof *members);
	code = done && members ? measure_all(plant, &probe, &progress, done, members, error)
		: eco_fail(error, ECO_NO_MEMORY, "no memory to measure %u ladders", plant->ladder_count);
	free(done);
	free(members);
	lod_probe_free(&probe);
	return code;
}

enum eco_code lod_plant_measure(struct lod_plant *plant, const struct eco_model *model, const struct lod_plant_options *options,
	struct eco_error *error)
{
	if (options->stage)
		options->stage(options->ctx, LOD_STAGE_CURVES);
	enum eco_code code = options->grid_bits ? ECO_OK : lod_grid_choose(plant, model, options, error);
	return code ? code : lod_curve_measure(plant, model, options, error);
}
