/* Curves (Neubert 2011, section 2.2): for shares of an organ's vertices from one element up, the area factor
 * s_opt that minimises the distance of (Precision, Recall) to (1, 1), and the remaining wrong pixels.
 *
 * The measured pictures are cuts of plans (lod/ladder.h) all around, against the organ's own full detail; of a
 * ladder for the whole plant, against all organs. Scales are relative to Cook's 1/lambda, which varies slowly, so
 * each search starts at the next larger share's answer. Leaves have several forms: at each share some reaches are
 * tried, and the chosen sequence has the least total loss without dropping or coarsening an element (dynamic
 * programming). Ladders of cells share the curve of the whole. Splats have scale 1 until leaves stand before
 * them; then each share has its own search.
 *
 * When all curves are there the errors that are seen are measured, of samples that are far enough apart (seen.h): of
 * an organ among the others, of a ladder for the whole plant alone. Others lie between.
 *
 * Scales are smoothed over neighbouring shares, and errors made non-increasing (pool adjacent violators). All is
 * +, -, *, / and sqrt in fixed order: the same curves on every machine. Longer than 600 lines: samples, search and
 * smoothing work on the same curves. */
#include "ecofiles/base/memory.h"
#include "lod/build/measure/curve_ways.h"
#include "lod/build/measure/seen.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk.h"
#include "lod/build/grid.h"
#include "lod/build/impostor/impostor_make.h"
#include "lod/build/splat/splat_fit.h"
#include "lod/ladder.h"

#define SAMPLES_MOST 42u             /* of LOD_CURVE_SAMPLES_MAX: the others are for levels */
#define SAMPLES_DRAFT 14u
#define VIEWS_DRAFT 6u
#define PIXELS_DRAFT 96u
/* Errors that are seen lie between those of samples whose shares are so many times apart at most. */
#define SEEN_STEP 1.7f
#define SEEN_STEP_DRAFT 5.0f             /* of organs */
#define SEEN_VIEWS_FEW 2u            /* of drafts */

/* ---- Shares ---- */

static void add_sample(struct lod_curve_organ *curve, double share, bool scale_is_free)
{
	struct lod_curve_sample *last = curve->sample_count ? &curve->samples[curve->sample_count - 1] : NULL;
	scale_is_free &= share < 1;
	if (!(share > 0 && share <= 1) || curve->sample_count == LOD_CURVE_SAMPLES_MAX
			|| (last && !((float)share > (float)last->share)))
		return;
	curve->samples[curve->sample_count++] = (struct lod_curve_sample){ .share = share,
		.free = scale_is_free, .reach = 1 };
}

static double grown(double n, double factor)
{
	return n * factor > n + 1 ? n * factor : n + 1;
}

/* Shares of the numbers of primitives from one to `all`, four an octave, or fewer if that were too many;
 * `per`: share of one. */
static void sample_geometrically(struct lod_curve_organ *curve, double all, double per)
{
	static const double factors[] = { 1.189207115002721, 1.2599210498948732, 1.4142135623730951, 2 };
	size_t f = 0;
	for (; f + 1 < sizeof factors / sizeof factors[0]; f++) {
		uint32_t count = 1;
		for (double n = 1; n < all; count++)
			n = grown(n, factors[f]);
		if (count <= (curve->draft ? SAMPLES_DRAFT : SAMPLES_MOST))
			break;
	}
	for (double n = 1; n < all; n = grown(n, factors[f]))
		if ((double)(uint64_t)(n + 0.5) < all)
			add_sample(curve, (double)(uint64_t)(n + 0.5) * per, curve->scaled);
}

#define MIXED_STEP 1.09              /* of vertices, from a state between two levels to the next */

/* Elements of a cut in limbs below `limb`. */
static uint32_t in_limbs(const int32_t *part, const struct eco_cut *cut, int32_t limb)
{
	uint32_t i = cut->first;
	while (i < cut->end && part[i] < limb)
		i++;
	return i - cut->first;
}

/* Whether decoding leaves the elements before `at` before it: in the midst of a chunk lines may change places. */
static bool may_begin(const struct lod_list_draft *draft, uint32_t at)
{
	uint32_t chunk = 0;
	while (draft->ends[chunk] < at)
		chunk++;
	return draft->list.coder == ECO_CODER_MESH || draft->ends[chunk] == at
		|| eco_chunk_keeps_order(chunk ? draft->ends[chunk - 1] : 0, draft->ends[chunk]);
}

/* Between two levels: limbs [0, k) of the finer one with the others of the coarser one. */
static void sample_mixed(struct lod_curve_organ *curve, const struct lod_way *way, uint64_t from, uint64_t to)
{
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX], coarse, fine;
	lod_way_cuts(way, from, 1, 0, cuts);
	coarse = cuts[0];
	lod_way_cuts(way, to, 1, 0, cuts);
	fine = cuts[0];
	const struct lod_list_draft *lists = curve->probe->plant->lists;
	const int32_t *a = lists[fine.list].elements.part, *b = lists[coarse.list].elements.part;
	uint32_t unit = eco_list_vertices(&lists[coarse.list].list);
	double least = MIXED_STEP * (double)from;
	/* levels come after these, and none may lack a sample */
	const uint32_t most = LOD_CURVE_SAMPLES_MAX - ECO_LEVELS_MAX;
	for (int32_t limb = 1; a && b && limb <= a[fine.end - 1] && curve->sample_count < most; limb++) {
		uint32_t drawn = in_limbs(a, &fine, limb),
			left = coarse.end - coarse.first - in_limbs(b, &coarse, limb);
		double v = 3.0 * drawn + (double)unit * left;
		if (v < least || v * MIXED_STEP > (double)to || !drawn || !left
				|| !may_begin(&lists[coarse.list], coarse.end - left))
			continue;
		uint32_t count = curve->sample_count;
		add_sample(curve, v / curve->full, false);
		if (curve->sample_count > count)
			curve->samples[count].reach = (double)drawn / (fine.end - fine.first);
		least = MIXED_STEP * v;
	}
}

/* Lines or points one by one, then each level of the largest ladder. A ladder that shares its curve with none also
 * stands between two levels. */
static void sample_levels(struct lod_curve_organ *curve)
{
	const struct eco_scene *scene = &curve->probe->scene;
	const struct eco_ladder *largest = lod_curve_member(curve, 0);
	for (uint32_t i = 1; i < curve->member_count; i++)
		if (lod_ladder_full(scene, lod_curve_member(curve, i)) > lod_ladder_full(scene, largest))
			largest = lod_curve_member(curve, i);
	struct eco_ladder bare = *largest;
	struct lod_way way;
	bare.curve_count = 0;        /* whole levels alone */
	lod_way_begin(&way, scene, &bare);
	uint64_t first = lod_way_stage_end(&way), unit = lod_way_next(&way, 0);
	if (first)
		sample_geometrically(curve, (double)first / (double)unit, lod_way_share(&way, unit));
	add_sample(curve, lod_way_share(&way, first), curve->scaled);
	for (uint64_t v = first; v < way.full;) {
		uint64_t next = lod_way_next(&way, v);
		if (v && curve->member_count == 1)
			sample_mixed(curve, &way, v, next);
		v = next;
		add_sample(curve, lod_way_share(&way, v), false);
	}
	add_sample(curve, 1, false);
}

/* Factor of vertices, from a number of leaves before splats to the next. */
#define BEFORE_STEP 1.4142135623730951
#define BEFORE_STEP_DRAFT 2.0

/* Splats, then leaves before the last level, whose scale is searched. */
static void sample_splats(struct lod_curve_organ *curve)
{
	struct lod_way way;
	lod_way_begin(&way, &curve->probe->scene, lod_curve_member(curve, 0));
	double splats = (double)lod_way_stage_end(&way),
		step = curve->draft ? BEFORE_STEP_DRAFT : BEFORE_STEP;
	sample_geometrically(curve, splats, 1 / curve->full);
	add_sample(curve, splats / curve->full, false);
	for (double v = step * splats; v < curve->full; v *= step)
		add_sample(curve, v / curve->full, true);
}

static void choose_samples(struct lod_curve_organ *curve)
{
	double unit = curve->unit[0];    /* vertices of the smallest step */
	curve->sample_count = 0;
	if (!curve->forms) {
		(curve->whole ? sample_splats : sample_levels)(curve);
		return;
	}
	sample_geometrically(curve, curve->full / unit, unit / curve->full);
	add_sample(curve, 1, false);
}

/* ---- Smoothing ---- */

/* Smooths twice with [1 2 1]/4 over the samples with a free scale, within each one's play: where leaves
 * change their form the best scale may change fast. Samples are evenly spaced in log share but for the first
 * few. */
static void smooth_steps(struct lod_curve_organ *curve)
{
	double best[LOD_CURVE_SAMPLES_MAX];
	uint32_t n = 0;
	for (; n < curve->sample_count && curve->samples[n].free; n++)
		best[n] = curve->samples[n].step;
	for (int round = 0; round < 2; round++) {
		double before = n ? curve->samples[0].step : 0;
		for (uint32_t i = 0; i + 1 < n; i++) {
			struct lod_curve_sample *sample = &curve->samples[i];
			double here = sample->step,
				smooth = (before + 2 * here + curve->samples[i + 1].step) / 4;
			smooth = smooth < best[i] + sample->play ? smooth : best[i] + sample->play;
			sample->step = smooth > best[i] - sample->play ? smooth : best[i] - sample->play;
			before = here;
		}
	}
}

/* Pool adjacent violators: the non-increasing sequence nearest to `values`. */
static void make_fall(double *values, uint32_t count)
{
	double mean[LOD_CURVE_SAMPLES_MAX], weight[LOD_CURVE_SAMPLES_MAX];
	uint32_t pools = 0;
	for (uint32_t i = 0; i < count; i++) {
		mean[pools] = values[i];
		weight[pools++] = 1;
		for (; pools > 1 && mean[pools - 2] < mean[pools - 1]; pools--) {
			double both = weight[pools - 2] + weight[pools - 1];
			mean[pools - 2] = (mean[pools - 2] * weight[pools - 2] + mean[pools - 1] * weight[pools - 1]) / both;
			weight[pools - 2] = both;
		}
	}
	for (uint32_t pool = 0, i = 0; pool < pools; pool++)
		for (; weight[pool] > 0; weight[pool]--)
			values[i++] = mean[pool];
}

/* fp and fn keep their ratio. */
static void make_monotone(struct lod_curve_organ *curve)
{
	double mean[LOD_CURVE_SAMPLES_MAX];
	for (uint32_t i = 0; i < curve->sample_count; i++)
		mean[i] = curve->samples[i].fp + curve->samples[i].fn;
	make_fall(mean, curve->sample_count);
	for (uint32_t i = 0; i < curve->sample_count; i++) {
		struct lod_curve_sample *sample = &curve->samples[i];
		double error = sample->fp + sample->fn;
		if (error > 0)
			sample->fp *= mean[i] / error, sample->fn *= mean[i] / error;
		else
			sample->fn = mean[i];
	}
}

/* ---- One curve ---- */

/* Full detail of what the curve is measured against, as the probe's drawings. */
static void draw_reference(const struct lod_curve_organ *curve)
{
	const struct lod_plant *plant = curve->probe->plant;
	const struct eco_ladder *first = lod_curve_member(curve, 0);
	const struct eco_curve all = { .share = 1, .scale = 1, .reach = 1 };
	lod_probe_clear(curve->probe);
	for (uint32_t i = 0; i < plant->ladder_count; i++) {
		const struct eco_ladder *ladder = &plant->ladders[i];
		bool full = !(ladder->flags & (ECO_LADDER_FAR | ECO_LADDER_WHOLE));
		if (full && (curve->whole || (curve->far_only && ladder->organ == first->organ)))
			lod_curve_add(curve, ladder, &all);
	}
	if (!curve->far_only && !curve->whole)
		lod_curve_draw(curve, 1, 1, 0);
}

/* Progress of the whole: `done` of `all` samples. */
struct progress { const struct lod_plant_options *options; uint32_t done, all; };

/* False if it is to stop. */
static bool advance(struct progress *progress)
{
	progress->done++;
	return !progress->options->progress || progress->options->progress(progress->options->ctx,
		(double)progress->done / progress->all);
}

static bool measure_ways(struct lod_curve_organ *curve, struct progress *progress)
{
	double step = 0;
	uint32_t chosen = 0;
	bool several = curve->forms && curve->units > 1;
	for (uint32_t i = curve->sample_count; i-- > 0;) {
		struct lod_curve_sample *sample = &curve->samples[i];
		if (sample->free && several) {
			lod_curve_try_ways(curve, i, chosen ? &curve->samples[i + 1] : NULL);
			chosen = chosen ? chosen : i + 1;
		} else if (sample->free) {
			struct lod_curve_way way = { .reach = sample->share };
			lod_curve_try_way(curve, sample->share, &way, step, chosen > 0 && !curve->whole, 1e30);
			chosen = chosen ? chosen : i + 1;
			sample->step = way.step;
			step = curve->whole ? 0 : way.step;      /* some have two optima */
			sample->play = way.play;
			sample->reach = curve->forms ? way.reach : 1;
		}
		if (!advance(progress))
			return false;
	}
	if (several)
		lod_curve_settle(curve, chosen);
	return true;
}

static bool measure_errors(struct lod_curve_organ *curve, struct progress *progress)
{
	for (uint32_t i = 0; i < curve->sample_count; i++) {
		struct lod_curve_sample *sample = &curve->samples[i];
		struct lod_probe_result result;
		if (!sample->free)
			sample->step = 0;
		lod_curve_draw(curve, sample->share, sample->reach, sample->step);
		lod_probe_compare(curve->probe, 1, &result);
		sample->fp = result.fp;
		sample->fn = result.fn;
		if (!advance(progress))
			return false;
	}
	return true;
}

/* For other views: the same reach, at the best scale there. */
static bool measure_scales(struct lod_curve_organ *curve, struct progress *progress)
{
	for (uint32_t i = curve->sample_count; i-- > 0;) {
		struct lod_curve_sample *sample = &curve->samples[i];
		struct lod_curve_way way = { .reach = sample->reach };
		if (sample->free) {
			lod_curve_try_way(curve, sample->share, &way, sample->step, true, 1e30);
			sample->step = way.step;
			sample->play = way.play;
		}
		if (!advance(progress))
			return false;
	}
	return true;
}

/* A curve from all around, which also decides reaches; or, after it, the curve from above. */
static bool measure_curve(struct lod_curve_organ *curve, bool above, struct progress *progress)
{
	curve->probe->smooth = !curve->whole;    /* points are about as large as leaves */
	draw_reference(curve);
	if (!lod_probe_keep(curve->probe))
		curve->sample_count = 0;
	if (!(above ? measure_scales : measure_ways)(curve, progress))
		return false;
	for (uint32_t i = 0; i < curve->sample_count; i++)
		if (curve->samples[i].free)
			lod_solved_add(&curve->solved, curve->samples[i].step > LOD_CURVE_STEP_LOW
				&& curve->samples[i].step < LOD_CURVE_STEP_HIGH);
	smooth_steps(curve);
	if (!measure_errors(curve, progress))
		return false;
	make_monotone(curve);
	return true;
}

/* ---- Which ladders share a curve ---- */

static uint32_t image_of(const struct lod_plant *plant, const struct eco_ladder *ladder)
{
	uint32_t list = ladder->triangles != ECO_NONE ? ladder->triangles : ladder->lines != ECO_NONE
		? ladder->lines : ladder->points;
	return list == ECO_NONE ? ECO_NONE : plant->lists[list].list.image;
}

static bool same_curve(const struct lod_plant *plant, const struct eco_ladder *a, const struct eco_ladder *b)
{
	bool far = a->flags & ECO_LADDER_FAR;
	return !((a->flags | b->flags) & ECO_LADDER_WHOLE) && a->organ == b->organ
		&& far == (bool)(b->flags & ECO_LADDER_FAR)
		&& (far || image_of(plant, a) == image_of(plant, b));
}

static bool is_form(const struct lod_curve_organ *curve, uint32_t list)
{
	return lod_curve_primitives(curve, list) && curve->probe->lists[list].coder == ECO_CODER_FORM;
}

static void add_unit(struct lod_curve_organ *curve, uint32_t list)
{
	const struct eco_list *l = &curve->probe->lists[list];
	curve->unit[curve->units++] = eco_list_vertices(l) * (double)l->primitive_count / l->element_count;
}

static void sum_up(struct lod_curve_organ *curve)
{
	const struct eco_ladder *first = lod_curve_member(curve, 0);
	curve->forms = !curve->whole && first->organ != ECO_ORGAN_WOOD && first->level_count == 0
		&& lod_curve_primitives(curve, first->triangles);
	for (uint32_t i = 0; i < curve->member_count; i++) {
		const struct eco_ladder *ladder = lod_curve_member(curve, i);
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

/* Gathers ladders from `first` on that share its curve and have none yet; `done` marks them. */
static void gather(struct lod_curve_organ *curve, struct lod_probe *probe, uint32_t first, bool draft,
	bool *done, uint32_t *members)
{
	const struct lod_plant *plant = probe->plant;
	*curve = (struct lod_curve_organ){ .probe = probe, .members = members, .draft = draft };
	for (uint32_t i = first; i < plant->ladder_count; i++) {
		if (done[i] || (i != first && !same_curve(plant, &plant->ladders[first], &plant->ladders[i])))
			continue;
		done[i] = true;
		curve->members[curve->member_count++] = i;
	}
	curve->far_only = plant->ladders[first].flags & ECO_LADDER_FAR;
	curve->whole = plant->ladders[first].flags & ECO_LADDER_WHOLE;
	curve->scaled = plant->ladders[first].organ != ECO_ORGAN_WOOD && !curve->whole;
	sum_up(curve);
	if (curve->full > 0)
		choose_samples(curve);
}

/* The first samples of a ladder with an impostor are its levels. */
static void append_impostor(struct lod_plant *plant, const struct lod_curve_organ *curve)
{
	struct lod_probe *probe = curve->probe;
	for (uint32_t i = 0; i < plant->impostor_count; i++) {
		struct lod_impostor impostor;
		struct lod_probe_result result;
		lod_plant_open_impostor(&impostor, plant, i);
		lod_probe_clear(probe);
		lod_probe_add_impostor(probe, &impostor);
		lod_probe_compare(probe, 1, &result);
		lod_probe_clear(probe);
		lod_impostor_close(&impostor);
		plant->curves[plant->curve_count++] = (struct eco_curve){ .scale = 1, .reach = 1,
			.share = (float)((i + 1.0) / plant->impostor_count / curve->full),
			.fp = eco_few_bits((float)result.fp), .fn = eco_few_bits((float)result.fn) };
	}
}

static bool has_impostor(const struct lod_curve_organ *curve)
{
	return curve->probe->plant->impostor_count
		&& lod_curve_member(curve, 0)->impostor != ECO_NONE;
}

static void append(struct lod_plant *plant, const struct lod_curve_organ *curve)
{
	uint32_t most = curve->sample_count + plant->impostor_count + 1;
	plant->curves = eco_realloc(plant->curves, plant->curve_count + most, sizeof *plant->curves);
	bool impostor = curve->sample_count && has_impostor(curve);
	if (impostor)
		append_impostor(plant, curve);
	plant->solved[LOD_SOLVER_SCALE].runs += curve->solved.runs;
	plant->solved[LOD_SOLVER_SCALE].converged += curve->solved.converged;
	for (uint32_t i = 0; i < curve->sample_count; i++) {
		const struct lod_curve_sample *s = &curve->samples[i];
		if (impostor && !(s->share * curve->full > 1.5))
			continue;                        /* one splat, which the impostor replaces */
		plant->curves[plant->curve_count++] = (struct eco_curve){ .share = (float)s->share,
			.scale = eco_few_bits((float)lod_curve_scale(s->step)), .reach = (float)s->reach,
			.fp = eco_few_bits((float)s->fp), .fn = eco_few_bits((float)s->fn) };
	}
}

static bool measure_both(struct lod_plant *plant, struct lod_curve_organ *curve, struct progress *progress)
{
	uint32_t first = plant->curve_count, samples;
	if (!measure_curve(curve, false, progress))
		return false;
	append(plant, curve);
	uint32_t count = plant->curve_count - first;
	samples = curve->sample_count;
	lod_probe_look(curve->probe, LOD_PROBE_ABOVE);
	if (!curve->draft && !measure_curve(curve, true, progress))
		return false;
	bool above = !curve->draft && curve->sample_count == samples;
	if (above)
		append(plant, curve);
	lod_probe_look(curve->probe, LOD_PROBE_AROUND);
	for (uint32_t i = 0; i < curve->member_count; i++) {
		struct eco_ladder *ladder = &plant->ladders[curve->members[i]];
		ladder->curve_first = first;
		ladder->curve_count = count;
		ladder->flags |= above && count ? ECO_LADDER_ABOVE : 0;
	}
	return true;
}

/* Full detail of what an organ is seen among: leaves before wood, and wood behind leaves. Leaves of other textures
 * would hide what is wrong with these, though all of them are coarse together. */
static void draw_others(const struct lod_curve_organ *curve)
{
	const struct lod_plant *plant = curve->probe->plant;
	const struct eco_curve all = { .share = 1, .scale = 1, .reach = 1 };
	bool wood = lod_curve_member(curve, 0)->organ == ECO_ORGAN_WOOD;
	lod_probe_clear(curve->probe);
	for (uint32_t i = 0; i < plant->ladder_count && !curve->whole; i++) {
		const struct eco_ladder *ladder = &plant->ladders[i];
		if (!(ladder->flags & (ECO_LADDER_FAR | ECO_LADDER_WHOLE)) && (ladder->organ == ECO_ORGAN_WOOD) != wood)
			lod_curve_add(curve, ladder, &all);
	}
}

/* Sets the samples between two by their numbers, which are even in log share. */
static void see_between(struct eco_curve *from, uint32_t count)
{
	for (uint32_t i = 1; i < count; i++)
		for (uint32_t k = 0; k < 2 * ECO_SEEN_SIZES; k++) {
			uint32_t size = k / 2, open = k % 2;
			const struct eco_seen *a = &from->seen, *b = &from[count].seen;
			from[i].seen.color[size][open] = (uint16_t)((a->color[size][open] * (count - i)
				+ b->color[size][open] * i) / count);
			from[i].seen.contrast[size][open] = (uint16_t)((a->contrast[size][open] * (count - i)
				+ b->contrast[size][open] * i) / count);
		}
}

/* Errors that are seen of a draft fall with each sample: they were measured in few views, and where they are equal but
 * for noise the finer one is better, by the least that can be said. */
static void make_seen_fall(struct eco_curve *samples, uint32_t count)
{
	double value[LOD_CURVE_SAMPLES_MAX];
	for (size_t k = 0; k < sizeof samples->seen / sizeof(uint16_t); k++) {
		uint16_t *of, before = UINT16_MAX;
		for (uint32_t i = 0; i < count; i++)
			value[i] = ((const uint16_t *)&samples[i].seen)[k];
		make_fall(value, count);
		for (uint32_t i = 0; i < count; i++, before = *of) {
			of = (uint16_t *)&samples[i].seen + k;
			*of = (uint16_t)(value[i] + 0.5);
			if (*of >= before)
				*of = before ? (uint16_t)(before - 1) : 0;
		}
	}
}

/* Measures errors that are seen: of the samples of a curve, and of nothing. */
static void see_curve(struct lod_seen *seen, struct lod_plant *plant, const struct lod_curve_organ *curve)
{
	const struct eco_ladder *first = lod_curve_member(curve, 0);
	struct lod_probe *probe = curve->probe;
	struct eco_seen nothing;
	draw_others(curve);
	lod_seen_back(seen);
	draw_reference(curve);
	lod_seen_keep(seen);
	lod_probe_clear(probe);
	lod_seen_compare(seen, &nothing);
	for (uint32_t i = 0; i < curve->member_count; i++)
		plant->ladders[curve->members[i]].nothing = nothing;
	uint32_t levels = has_impostor(curve) ? plant->impostor_count : 0, last = 0;
	float step = curve->draft && !curve->whole ? SEEN_STEP_DRAFT : SEEN_STEP;
	for (uint32_t i = 0; i < first->curve_count; i++) {
		struct eco_curve *sample = &plant->curves[first->curve_first + i];
		struct lod_impostor impostor;
		bool one = i < levels;
		if (i > levels && i + 1 < first->curve_count && sample[1].share
				<= step * plant->curves[first->curve_first + last].share)
			continue;
		lod_probe_clear(probe);
		if (one) {
			lod_plant_open_impostor(&impostor, plant, i);
			lod_probe_add_impostor(probe, &impostor);
		} else
			for (uint32_t k = 0; k < curve->member_count; k++)
				lod_curve_add(curve, lod_curve_member(curve, k), sample);
		lod_seen_compare(seen, &sample->seen);
		if (one)
			lod_impostor_close(&impostor);
		if (i > last + 1)
			see_between(sample - (i - last), i - last);
		last = i;
	}
	if (curve->whole && curve->draft)
		make_seen_fall(plant->curves + first->curve_first + levels, first->curve_count - levels);
	lod_probe_clear(probe);
}

static void see_all(struct lod_plant *plant, struct lod_probe *probe, const struct lod_plant_options *options,
	bool *done, uint32_t *members)
{
	struct lod_seen seen;
	probe->colored = true;
	probe->smooth = false;
	bool few = options->draft || (options->views && options->views < LOD_SEEN_VIEWS_MAX);
	lod_seen_init(&seen, probe, &(struct lod_seen_options){ few ? SEEN_VIEWS_FEW : LOD_SEEN_VIEWS_MAX,
		few ? 1 : 2 });
	memset(done, 0, plant->ladder_count * sizeof *done);
	for (uint32_t i = 0; i < plant->ladder_count; i++) {
		struct lod_curve_organ curve;
		if (done[i])
			continue;
		gather(&curve, probe, i, options->draft, done, members);
		if (lod_curve_member(&curve, 0)->curve_count)
			see_curve(&seen, plant, &curve);
	}
	lod_seen_free(&seen);
	probe->colored = false;
}

static bool measure_all(struct lod_plant *plant, struct lod_probe *probe, struct progress *progress, bool *done,
	uint32_t *members)
{
	for (int pass = 0; pass < 2; pass++) {       /* the first only counts, for progress */
		memset(done, 0, plant->ladder_count * sizeof *done);
		for (uint32_t i = 0; i < plant->ladder_count; i++) {
			struct lod_curve_organ curve;
			if (done[i])
				continue;
			gather(&curve, probe, i, progress->options->draft, done, members);
			if (pass == 0)
				progress->all += (curve.draft ? 2 : 4) * curve.sample_count;
			else if (!measure_both(plant, &curve, progress))
				return false;
		}
	}
	return true;
}

/* Replaces the plant's curves by measured ones and assigns them to the ladders: one for each organ and texture
 * (shared by the whole plant's ladder and those of its cells) and one for each organ's FAR ladders. Each is
 * followed by a curve from above, for the same cuts at their best scale there. */
static enum eco_code measure_plant(struct lod_plant *plant, const struct eco_model *model,
	const struct lod_plant_options *options, struct eco_error *error)
{
	struct lod_probe probe;
	struct lod_probe_options size = { options->views ? options->views : options->draft ? VIEWS_DRAFT : 12,
		options->pixels ? options->pixels : options->draft ? PIXELS_DRAFT : 256, options->each,
		options->ctx };
	lod_probe_init(&probe, plant, model, &size);
	free(plant->curves);
	plant->curves = NULL;
	plant->curve_count = 0;
	plant->solved[LOD_SOLVER_SCALE] = (struct lod_solved){ 0 };
	for (uint32_t i = 0; i < plant->ladder_count; i++) {
		plant->ladders[i].curve_first = plant->ladders[i].curve_count = 0;
		plant->ladders[i].flags &= (uint8_t)~ECO_LADDER_ABOVE;
	}
	struct progress progress = { options, 0, 0 };
	bool *done = eco_alloc(plant->ladder_count + 1u, sizeof *done);
	uint32_t *members = eco_alloc(plant->ladder_count + 1u, sizeof *members);
	bool good = measure_all(plant, &probe, &progress, done, members);
	if (good && plant->curve_count)
		see_all(plant, &probe, options, done, members);
	free(done);
	free(members);
	lod_probe_free(&probe);
	return good ? ECO_OK : eco_fail(error, ECO_INTERRUPTED, "interrupted while measuring curves");
}

enum eco_code lod_plant_measure(struct lod_plant *plant, const struct eco_model *model,
	const struct lod_plant_options *options, struct eco_error *error)
{
	lod_plant_enter(options, LOD_STAGE_CURVES);
	enum eco_code code = options->grid_bits || options->draft || model->object ? ECO_OK
		: lod_grid_choose(plant, model, options, error);
	if (!code && !options->no_splats && !model->object)
		code = lod_plant_add_splats(plant, model, options, error);
	if (!code)
		lod_plant_enter(options, LOD_STAGE_CURVES);
	return code ? code : measure_plant(plant, model, options, error);
}
