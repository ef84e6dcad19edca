/* Curves (Neubert 2011, section 2.2): for shares of an organ's vertices from one primitive up, the area factor s_opt that minimises the
 * distance of (Precision, Recall) to (1, 1), and the wrong pixels that are left.
 *
 * What is measured is what will be drawn: the cut sets of lod/ladder.h, over views all around (probe.h), against the organ's own
 * full detail. Scales are kept relative to Cook's 1/lambda, whose singularity at 0 is thus taken out: s/s_Cook is a slow function
 * of log lambda, so the search starts from the neighbouring share's answer, walks an eighth of an octave at a time and ends with
 * a parabola. From many elements to few, as the error surface of a few elements is rough and that of many is not.
 *
 * A complex plant's organ is a coarse list for the whole plant and the rest of the same order in cells. Its curve is measured over
 * the whole: at density D the coarse list shows its part of the D n points and each cell its own, as when all cells stand at one
 * distance. All these ladders share the curve.
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

#define SAMPLES_FIRST_MAX 38u        /* of the first stage: points, lines or plain triangles */
#define BLEND_SAMPLES 6u
#define STEP_LOW -16                 /* scales are 2^(step/8) times Cook's: 1/4 to 4. Up to 64 was tried: sparse crowns become balloons
				      * of a few leaves, and a forest at 100,000 vertices falls from skill 0.86 to 0.77 (a meadow wins 0.02) */
#define STEP_HIGH 16
#define STEPS (STEP_HIGH - STEP_LOW + 1)

struct sample {
	double share;                /* of the organ's vertices */
	double step;                 /* scale is 2^(step/8) */
	double fp, fn;
	bool free;                   /* its scale is there to be chosen */
};

struct organ_curve {                 /* ladders that share one curve */
	struct lod_probe *probe;
	uint32_t *members, member_count;         /* indices of ladders; [0] leads: the whole plant's where there is one */
	bool far_only;               /* FAR ladders: measured against what the organ's others draw */
	bool scaled;                 /* not wood */
	uint32_t unit;               /* vertices of a first-stage primitive */
	uint64_t first_stage, full;  /* primitives of the first stage, vertices of full detail; all members */
	struct sample samples[LOD_CURVE_SAMPLES_MAX];
	uint32_t sample_count;
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

/* The list of a ladder's first stage. */
static uint32_t first_list(const struct organ_curve *curve, const struct eco_ladder *ladder)
{
	return primitives(curve, ladder->points) ? ladder->points : primitives(curve, ladder->lines) ? ladder->lines : ladder->triangles;
}

/* Share of the organ's vertices that all of the first stage is. */
static double first_stage_share(const struct organ_curve *curve)
{
	return (double)curve->unit * (double)curve->first_stage / (double)curve->full;
}

/* Vertices of one ladder where the first stage shows the density `density` of its region: what the whole plant's list does not. */
static uint64_t first_stage_vertices(const struct organ_curve *curve, const struct eco_ladder *ladder, double density)
{
	uint64_t all = primitives(curve, first_list(curve, ladder)), region = all + ladder->before;
	if (ladder->total > region)
		region = ladder->total;
	double shown = density * (double)region - ladder->before + 0.5;
	uint64_t count = shown >= (double)all ? all : shown >= 1 ? (uint64_t)shown : 0;
	return lod_ladder_floor(&curve->probe->scene, ladder, curve->unit * count);
}

static enum eco_code add_member(const struct organ_curve *curve, const struct eco_ladder *ladder, double share, double scale,
	struct eco_error *error)
{
	struct lod_probe *probe = curve->probe;
	double first_share = first_stage_share(curve);
	double density = share < first_share ? share / first_share : 1;
	uint64_t full = lod_ladder_full(&probe->scene, ladder), vertices = share < first_share
		? first_stage_vertices(curve, ladder, density)
		: lod_ladder_floor(&probe->scene, ladder, (uint64_t)(share * (double)full + 0.5));
	struct eco_curve sample = { .share = 1, .scale = (float)scale };
	struct eco_ladder measured = *ladder;
	measured.curve_first = 0;
	measured.curve_count = 1;
	probe->scene.curves = &sample;
	probe->scene.curve_count = 1;
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
	uint32_t count = lod_ladder_cuts(&probe->scene, &measured, vertices, density, cuts);
	probe->scene.curves = probe->plant->curves;
	probe->scene.curve_count = probe->plant->curve_count;
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < count && !code; i++)
		code = lod_probe_add(probe, &cuts[i], error);
	return code;
}

static enum eco_code draw(const struct organ_curve *curve, double share, double scale, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	lod_probe_clear(curve->probe);
	for (uint32_t i = 0; i < curve->member_count && !code; i++)
		code = add_member(curve, member(curve, i), share, scale, error);
	return code;
}

/* ---- Searching the scale ---- */

struct search { const struct organ_curve *curve; double share; uint32_t stride; double loss[STEPS]; };

static enum eco_code loss_at(struct search *search, int step, double *loss, struct eco_error *error)
{
	double *known = &search->loss[step - STEP_LOW];
	if (*known < 0) {
		enum eco_code code = draw(search->curve, search->share, scale_of(step), error);
		if (code)
			return code;
		struct lod_probe_result result;
		lod_probe_compare(search->curve->probe, search->stride, &result);
		/* Minimising 1 - Q may accept more wrong pixels than there are to cover (a few leaves of a sparse crown, blown up). Capping
		 * fp + fn at 1 was tried: plants hide each other's false positives, so scenes lose by it (a meadow at 200,000 vertices Q 0.28
		 * instead of 0.30, a forest skill 0.80 instead of 0.84). */
		*known = result.loss;
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

/* Vertex of the parabola through a step and its neighbours. */
static enum eco_code refine(struct search *search, int best, double *step, struct eco_error *error)
{
	double low, middle, high;
	*step = best;
	if (best == STEP_LOW || best == STEP_HIGH)
		return ECO_OK;
	enum eco_code code = loss_at(search, best, &middle, error);
	if (!code)
		code = loss_at(search, best - 1, &low, error);
	if (!code)
		code = loss_at(search, best + 1, &high, error);
	if (code)
		return code;
	double bend = low - 2 * middle + high;
	if (bend > 0)
		*step = best + 0.5 * (low - high) / bend;
	return ECO_OK;
}

static enum eco_code best_step(const struct organ_curve *curve, struct sample *sample, double start, bool warm,
	struct eco_error *error)
{
	struct search search = { .curve = curve, .share = sample->share, .stride = curve->probe->views >= 8 ? 2 : 1 };
	for (int i = 0; i < STEPS; i++)
		search.loss[i] = -1;
	int best = (int)(start - STEP_LOW + 0.5) + STEP_LOW;
	enum eco_code code = ECO_OK;
	for (int stride = warm ? 2 : 8; stride > 0 && !code; stride /= 2)
		code = walk(&search, stride, &best, error);
	return code ? code : refine(&search, best, &sample->step, error);
}

/* ---- Which shares ---- */

static void add_sample(struct organ_curve *curve, double share, bool scale_is_free)
{
	struct sample *last = curve->sample_count ? &curve->samples[curve->sample_count - 1] : NULL;
	scale_is_free &= share < 1;
	if (!(share > 0 && share <= 1) || curve->sample_count == LOD_CURVE_SAMPLES_MAX || (last && !((float)share > (float)last->share)))
		return;
	curve->samples[curve->sample_count++] = (struct sample){ .share = share, .free = scale_is_free };
}

/* Numbers of primitives from one element to all, four an octave, or fewer where that were too many. */
static void sample_first_stage(struct organ_curve *curve)
{
	static const double factors[] = { 1.189207115002721, 1.2599210498948732, 1.4142135623730951, 2 };
	double all = (double)curve->first_stage;
	size_t f = 0;
	for (; f + 1 < sizeof factors / sizeof factors[0]; f++) {
		uint32_t count = 1;
		for (double n = 1; n < all; count++)
			n = n * factors[f] > n + 1 ? n * factors[f] : n + 1;
		if (count <= SAMPLES_FIRST_MAX)
			break;
	}
	double per = (double)curve->unit / (double)curve->full;
	for (double n = 1; n < all; n = n * factors[f] > n + 1 ? n * factors[f] : n + 1) {
		double whole = (double)(uint64_t)(n + 0.5);
		if (whole < all)
			add_sample(curve, whole * per, curve->scaled);
	}
	add_sample(curve, all * per, curve->scaled);
}

/* Beyond the first stage: along the blend, or where a level of the largest ladder begins. */
static void sample_later_stages(struct organ_curve *curve)
{
	const struct eco_scene *scene = &curve->probe->scene;
	double from = first_stage_share(curve);
	if (curve->unit == 1) {
		for (uint32_t i = 1; i < BLEND_SAMPLES; i++)
			add_sample(curve, from + (1 - from) * i / BLEND_SAMPLES, false);
	} else {
		const struct eco_ladder *largest = member(curve, 0);
		for (uint32_t i = 1; i < curve->member_count; i++)
			if (lod_ladder_full(scene, member(curve, i)) > lod_ladder_full(scene, largest))
				largest = member(curve, i);
		uint64_t full = lod_ladder_full(scene, largest), v = lod_ladder_floor(scene, largest, (uint64_t)(from * (double)full));
		for (int i = 0; i < ECO_LEVELS_MAX && (v = lod_ladder_next(scene, largest, v)) < full; i++)
			add_sample(curve, (double)v / (double)full, false);
	}
	add_sample(curve, 1, false);
}

static void choose_samples(struct organ_curve *curve)
{
	curve->sample_count = 0;
	sample_first_stage(curve);
	sample_later_stages(curve);
}

/* ---- Smoothing ---- */

/* Twice [1 2 1]/4 over the samples whose scale is free; the samples are evenly spaced in log share but for the first few. */
static void smooth_steps(struct organ_curve *curve)
{
	uint32_t n = 0;
	while (n < curve->sample_count && curve->samples[n].free)
		n++;
	for (int round = 0; round < 2; round++) {
		double before = n ? curve->samples[0].step : 0;
		for (uint32_t i = 0; i + 1 < n; i++) {
			double here = curve->samples[i].step;
			curve->samples[i].step = (before + 2 * here + curve->samples[i + 1].step) / 4;
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
		code = draw(curve, 1, 1, error);
	} else {
		const struct eco_ladder *far = member(curve, 0);
		lod_probe_clear(curve->probe);
		for (uint32_t i = 0; i < plant->ladder_count && !code; i++) {
			const struct eco_ladder *ladder = &plant->ladders[i];
			if (ladder->organ == far->organ && !(ladder->flags & ECO_LADDER_FAR)) {
				struct organ_curve one = { .probe = curve->probe, .unit = 1, .first_stage = 1, .full = 2 };
				code = add_member(&one, ladder, 1, 1, error);
			}
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

static enum eco_code measure_steps(struct organ_curve *curve, struct progress *progress, struct eco_error *error)
{
	double step = 0;
	bool warm = false;
	enum eco_code code = ECO_OK;
	for (uint32_t i = curve->sample_count; i-- > 0 && !code;) {
		struct sample *sample = &curve->samples[i];
		if (sample->free) {
			code = best_step(curve, sample, step, warm, error);
			step = sample->step;
			warm = true;
		}
		if (!code)
			code = advance(progress, error);
	}
	return code;
}

static enum eco_code measure_errors(struct organ_curve *curve, struct progress *progress, struct eco_error *error)
{
	double step = 0, drawn_first = first_stage_share(curve);
	enum eco_code code = ECO_OK;
	for (uint32_t i = 0; i < curve->sample_count && !code; i++) {
		struct sample *sample = &curve->samples[i];
		if (sample->free)
			step = sample->step;
		else
			sample->step = drawn_first < 1 ? step : 0;      /* a blend's points keep the scale of all points */
		code = draw(curve, sample->share, scale_of(sample->step), error);
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
		code = measure_steps(curve, progress, error);
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

static void sum_up(struct organ_curve *curve)
{
	curve->first_stage = curve->full = 0;
	curve->unit = 3;
	for (uint32_t i = 0; i < curve->member_count; i++) {
		const struct eco_ladder *ladder = member(curve, i);
		uint32_t list = first_list(curve, ladder);
		if (list == ECO_NONE)
			continue;
		uint32_t unit = eco_list_vertices(&curve->probe->lists[list]);
		if (i == 0 || unit < curve->unit)
			curve->unit = unit;
	}
	for (uint32_t i = 0; i < curve->member_count; i++) {
		const struct eco_ladder *ladder = member(curve, i);
		uint32_t list = first_list(curve, ladder);
		bool leveled = ladder->level_count && list == ladder->triangles;
		curve->first_stage += leveled ? 0 : primitives(curve, list);
		curve->full += lod_ladder_full(&curve->probe->scene, ladder);
	}
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
	if (curve->full)
		choose_samples(curve);
}

static enum eco_code append(struct lod_plant *plant, const struct organ_curve *curve, struct eco_error *error)
{
	struct eco_curve *grown = realloc(plant->curves, (plant->curve_count + curve->sample_count + 1) * sizeof *grown);
	if (!grown)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for curves");
	plant->curves = grown;
	for (uint32_t i = 0; i < curve->member_count; i++) {
		plant->ladders[curve->members[i]].curve_first = plant->curve_count;
		plant->ladders[curve->members[i]].curve_count = curve->sample_count;
	}
	for (uint32_t i = 0; i < curve->sample_count; i++) {
		const struct sample *s = &curve->samples[i];
		plant->curves[plant->curve_count++] = (struct eco_curve){ .share = (float)s->share,
			.scale = curve->scaled ? (float)scale_of(s->step) : 1, .fp = (float)s->fp, .fn = (float)s->fn };
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
