/* Branch and bound over the samples of a summary: see lod/plan/summary_hull.h. */
#include "lod/plan/summary_hull.h"

#include <math.h>

#include "lod/plan/visibility.h"

#define SCALE_LEAST 0.01
#define LAST_STEP 64             /* the last step's slope is seldom less than the mean slope over this */

static bool is_evaluated(const struct lod_summary_hull *summary, uint32_t i)
{
	return summary->evaluated >> i & 1;
}

static uint64_t vertices_of(const struct lod_summary_hull *summary, uint32_t i)
{
	return (uint64_t)summary->view.points >> (summary->count - 1 - i);
}

static double error_of(const struct lod_summary_hull *summary, uint32_t i)
{
	return summary->errors[summary->count - 1 - i];
}

uint32_t lod_summary_hull_count(double points)
{
	uint32_t count = 1;
	while (count < LOD_SUMMARY_HULL_SAMPLES_MAX && (uint64_t)points >> count)
		count++;
	return count;
}

/* With splats of `scale` times the area that all leaves have. */
static struct lod_hull_point at_scale(const struct lod_summary_hull *summary, uint64_t vertices, double scale)
{
	struct lod_summary_view view = summary->view;
	struct lod_hull_point sample = { .vertices = vertices };
	double n = summary->part * (double)vertices;
	view.area *= scale;
	struct eco_curve curve = lod_summary_curve(&view, n);
	sample.fp = summary->pixels * curve.fp + lod_summary_outside(&view, n);
	/* a crown that no splat covers is absent */
	sample.fn = summary->pixels * LOD_OWNER_WEIGHT * (1 - curve.fn) + curve.fn;
	sample.octaves = (float)lod_octaves(view.area / n);
	lod_hull_set_detail(&sample, 0, LOD_DETAIL_MOST_WHOLE);
	sample.detail *= summary->pixels;
	return sample;
}

/* Leaves hide each other, the more the denser plants stand: splats with all their area would stand out of a
 * closed forest. */
static double best_scale(const struct lod_summary_hull *summary, uint64_t vertices,
	struct lod_hull_point *best)
{
	double least = INFINITY, scale = 1;
	for (double s = 1; s >= SCALE_LEAST; s /= 2) {
		struct lod_hull_point sample = at_scale(summary, vertices, s);
		double error = lod_hull_error(&summary->hull, &sample);
		if (s < 1 && !(error < least))
			break;
		least = error;
		scale = s;
		*best = sample;
	}
	return scale;
}

double lod_summary_hull_scale(const struct lod_summary_hull *summary, uint64_t vertices)
{
	struct lod_hull_point best;
	return vertices ? best_scale(summary, vertices, &best) : 1;
}

static void evaluate(struct lod_summary_hull *summary, uint32_t i)
{
	best_scale(summary, vertices_of(summary, i), &summary->samples[i]);
	summary->errors[summary->count - 1 - i] = lod_hull_error(&summary->hull, &summary->samples[i]);
	summary->evaluated |= 1u << i;
	++*summary->gains;
}

static void make_hull(struct lod_summary_hull *summary)
{
	struct lod_hull *hull = &summary->hull;
	hull->points[0] = (struct lod_hull_point){ .fn = 1 };
	hull->count = 1;
	for (uint32_t i = 0; i < summary->count; i++)
		if (is_evaluated(summary, i))
			hull->points[hull->count++] = summary->samples[i];
	lod_hull_reduce(hull, 1);
}

void lod_summary_hull_begin(struct lod_summary_hull *summary, const struct lod_summary_view *view,
	double part, double pixels, double fp_weight, struct lod_hull_point *room, uint64_t *gains)
{
	uint32_t count = lod_summary_hull_count(view->points);
	*summary = (struct lod_summary_hull){ .view = *view, .part = part, .pixels = pixels, .samples = room,
		.count = count,
		.hull = { .points = room + count, .count = 1, .fp_weight = fp_weight },
		.gains = gains };
	summary->view.crowded = lod_summary_crowded(view);
	evaluate(summary, count - 1);
	make_hull(summary);
}

/* The least Lagrangian, error + lambda * vertices, of the empty sample and the hull's points. */
static double least_evaluated(const struct lod_summary_hull *summary, double lambda)
{
	double least = 1;
	for (uint32_t i = 1; i < summary->hull.count; i++) {
		const struct lod_hull_point *point = &summary->hull.points[i];
		least = fmin(least, lod_hull_error(&summary->hull, point) + lambda * (double)point->vertices);
	}
	return least;
}

/* Samples [first, end) that are not evaluated, and a lower bound of their Lagrangians. */
struct gap { double least; uint32_t first, end; };

/* The gap with the least bound. */
static struct gap best_gap(const struct lod_summary_hull *summary, double lambda)
{
	struct gap best = { .least = INFINITY };
	uint32_t first = 0;
	for (uint32_t left = summary->evaluated; left; left &= left - 1) {
		uint32_t end = (uint32_t)__builtin_ctz(left);
		if (first < end) {
			double least = error_of(summary, end) + lambda * (double)vertices_of(summary, first);
			if (least < best.least)
				best = (struct gap){ least, first, end };
		}
		first = end + 1;
	}
	return best;
}

double lod_summary_hull_gain_bound(const struct lod_summary_hull *summary, double lambda)
{
	return 1 - fmin(best_gap(summary, lambda).least, least_evaluated(summary, lambda));
}

static bool refine_at(struct lod_summary_hull *summary, double lambda)
{
	struct gap gap = best_gap(summary, lambda);
	if (!(gap.least < least_evaluated(summary, lambda)))
		return false;
	/* few points are worse than none: a sample of an eighth mostly rules out all smaller ones */
	evaluate(summary, gap.end - gap.first > 3 ? gap.end - 3 : gap.end - (gap.end - gap.first + 1) / 2);
	make_hull(summary);
	return true;
}

/* Steps around lambda are taken in part, so the hull must hold there too. */
bool lod_summary_hull_refine(struct lod_summary_hull *summary, double lambda)
{
	return lambda > 0 && (refine_at(summary, lambda) || refine_at(summary, lambda * LOD_HULL_BLUR)
		|| refine_at(summary, lambda / LOD_HULL_BLUR));
}

void lod_summary_hull_complete(struct lod_summary_hull *summary)
{
	for (uint32_t i = 0; i < summary->count; i++)
		if (!is_evaluated(summary, i))
			evaluate(summary, i);
	make_hull(summary);
}

void lod_summary_hull_lambda_range(const struct lod_summary_hull *summary, double *high, double *low)
{
	double saved = fmax(0, 1 - error_of(summary, summary->count - 1));
	*high = saved / (double)vertices_of(summary, 0);
	*low = saved / (double)vertices_of(summary, summary->count - 1) / LAST_STEP;
}
