/* Steps of summaries, as far as they are asked for: see lod/plan/summary_hull.h. */
#include "lod/plan/summary_hull.h"

#include <math.h>

#include "lod/plan/visibility.h"

#define LAST_STEP 64             /* the last step of a summary gains this much less a vertex than all of them do: seldom less */

static bool knows(const struct lod_points *points, uint32_t i) { return points->known >> i & 1; }

static double error_of(const struct lod_points *points, uint32_t i) { return lod_steps_error(&points->steps, &points->samples[i]); }

double lod_points_missed(const struct lod_points *points, double fn)
{
	double missed = (fn / points->pixels - LOD_OWNER_WORTH) / (1 - LOD_OWNER_WORTH);
	return missed < 0 ? 0 : missed < 1 ? missed : 1;
}

uint32_t lod_points_count(double points)
{
	uint32_t count = 1;
	while (count < LOD_POINTS_SAMPLES_MAX && (uint64_t)points >> count)
		count++;
	return count;
}

static void compute(struct lod_points *points, uint32_t i)
{
	struct lod_amount *sample = &points->samples[i];
	double n = points->part * (double)sample->vertices;
	struct eco_curve curve = lod_summary_curve(&points->view, n);
	sample->fp = points->pixels * curve.fp + lod_summary_outside(&points->view, n);
	sample->fn = points->pixels * (curve.fn + LOD_OWNER_WORTH * (1 - curve.fn));
	points->known |= 1u << i;
	++*points->gains;
}

static void make_hull(struct lod_points *points)
{
	struct lod_steps *steps = &points->steps;
	steps->amounts[0] = (struct lod_amount){ .fn = 1 };
	steps->count = 1;
	for (uint32_t i = 0; i < points->count; i++)
		if (knows(points, i))
			steps->amounts[steps->count++] = points->samples[i];
	lod_steps_hull(steps, 1);
}

void lod_points_begin(struct lod_points *points, const struct lod_summary_view *view, double part, double pixels, double extra,
	struct lod_amount *room, uint64_t *gains)
{
	uint32_t count = lod_points_count(view->points);
	*points = (struct lod_points){ .view = *view, .part = part, .pixels = pixels, .samples = room, .count = count,
		.steps = { room + count, 1, extra }, .gains = gains };
	for (uint32_t i = 0; i < count; i++)
		room[i] = (struct lod_amount){ .vertices = (uint64_t)view->points >> (count - 1 - i) };
	compute(points, count - 1);
	make_hull(points);
}

/* The least of what is left wrong and what is paid, of all known amounts. */
static double least_known(const struct lod_points *points, double price)
{
	double least = 1;
	for (uint32_t i = 1; i < points->steps.count; i++) {
		const struct lod_amount *amount = &points->steps.amounts[i];
		least = fmin(least, lod_steps_error(&points->steps, amount) + price * (double)amount->vertices);
	}
	return least;
}

/* Samples [first, end) that are not known, and a bound on what the best of them can come to. */
struct gap { double least; uint32_t first, end; };

/* The one that may hold the least. */
static struct gap best_gap(const struct lod_points *points, double price)
{
	struct gap best = { .least = INFINITY };
	for (uint32_t end = 0, first = 0; end < points->count; end++) {
		if (!knows(points, end))
			continue;
		if (first < end) {
			double least = error_of(points, end) + price * (double)points->samples[first].vertices;
			if (least < best.least)
				best = (struct gap){ least, first, end };
		}
		first = end + 1;
	}
	return best;
}

double lod_points_most(const struct lod_points *points, double price)
{
	return 1 - fmin(best_gap(points, price).least, least_known(points, price));
}

static bool step_at(struct lod_points *points, double price)
{
	struct gap gap = best_gap(points, price);
	if (!(gap.least < least_known(points, price)))
		return false;
	/* few points show worse than nothing: from an eighth of them on it is mostly known that no smaller amount counts */
	compute(points, gap.end - gap.first > 3 ? gap.end - 3 : gap.end - (gap.end - gap.first + 1) / 2);
	make_hull(points);
	return true;
}

/* Steps that are taken in part are those around the price. */
bool lod_points_step(struct lod_points *points, double price)
{
	return price > 0 && (step_at(points, price) || step_at(points, price * LOD_STEPS_BLUR) || step_at(points, price / LOD_STEPS_BLUR));
}

void lod_points_all(struct lod_points *points)
{
	for (uint32_t i = 0; i < points->count; i++)
		if (!knows(points, i))
			compute(points, i);
	make_hull(points);
}

void lod_points_prices(const struct lod_points *points, double *high, double *low)
{
	double saved = fmax(0, 1 - error_of(points, points->count - 1));
	*high = saved / (double)points->samples[0].vertices;
	*low = saved / (double)points->samples[points->count - 1].vertices / LAST_STEP;
}
