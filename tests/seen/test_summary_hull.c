/* The hull of a summary's points, against every power of two of them. */
#include <math.h>

#include "ecofiles/base/random.h"
#include "lod/seen/summary_hull.h"
#include "tests/support/unit_test.h"

#define VIEWS 4000u

static double random_real(uint64_t *state, double from, double to)
{
	return from + (to - from) * eco_random_unit(eco_random(++*state, 7));
}

static struct lod_summary_view random_view(uint64_t *state)
{
	double plants = exp2(random_real(state, 0, 14)), box = exp2(random_real(state, -6, 12));
	struct lod_summary_view view = { .plants = plants, .box = plants * box,
		.covered = plants * box * random_real(state, 0.05, 1),
		.area = plants * box * random_real(state, 0.1, 4),
		.points = floor(fmin(4096, fmax(1, plants * exp2(random_real(state, -3, 3))))),
		.wide = sqrt(plants * box) * random_real(state, 0.5, 4), .weight_px = 2 * plants * box };
	view.high = view.wide * random_real(state, 0.05, 1);
	return view;
}

/* The first `points` save so much at a lambda: those of a summary that has no more. */
static double saved(const struct lod_summary_hull *summary, uint64_t points, double lambda)
{
	struct lod_summary_view view = summary->view;
	struct lod_summary_hull some;
	struct lod_hull_point room[LOD_SUMMARY_HULL_POINTS_MAX];
	view.points = (double)points;
	lod_summary_hull_make(&some, &view, summary->part, summary->pixels, summary->hull.open, room);
	const struct lod_hull_point *last = &room[some.hull.count - 1];
	return last->vertices == points ? 1 - lod_hull_error(&some.hull, last) - lambda * (double)points : 0;
}

static double best_of_hull(const struct lod_hull *hull, double lambda)
{
	double best = 0;
	for (uint32_t i = 0; i < hull->count; i++)
		best = fmax(best, 1 - lod_hull_error(hull, &hull->points[i]) - lambda * (double)hull->points[i].vertices);
	return best;
}

UNIT_TEST(no_number_of_points_is_much_better_than_the_hull)
{
	uint64_t random = 1;
	uint32_t all = 0;
	double sum = 0;      /* by which others are better */
	for (uint32_t v = 0; v < VIEWS; v++) {
		struct lod_summary_view view = random_view(&random);
		struct lod_summary_hull summary;
		struct lod_hull_point room[LOD_SUMMARY_HULL_POINTS_MAX];
		double part = random_real(&random, 0.01, 1), open = random_real(&random, 0, 1);
		lod_summary_hull_make(&summary, &view, part, 1, open, room);
		const uint32_t last = summary.hull.count - 1;
		assert_true(room[0].vertices == 0 && fabs(lod_hull_error(&summary.hull, room) - 1) < 1e-9);
		all += room[last].vertices == (uint64_t)view.points;
		for (uint32_t i = 1; i <= last; i++)
			assert_true(room[i].vertices > room[i - 1].vertices && lod_hull_slope(&summary.hull, i) > 0
				&& lod_hull_slope(&summary.hull, i) <= lod_hull_slope(&summary.hull, i - 1));
		double lambda = exp2(random_real(&random, -24, 2)), best = best_of_hull(&summary.hull, lambda);
		for (uint64_t points = (uint64_t)view.points; points > 0; points /= 2) {
			const double gap = saved(&summary, points, lambda) - best;
			assert_true(gap < 0.25);
			sum += fmax(0, gap);
		}
	}
	assert_in_range(all, VIEWS / 4, VIEWS);
	assert_true(sum < 5e-4 * VIEWS);
}

UNIT_TEST(splats_of_dense_plants_are_smaller)
{
	struct lod_summary_view view = { .plants = 100, .box = 1e4, .covered = 9e3, .area = 8e4, .points = 1024, .wide = 100,
		.high = 100, .weight_px = 1e4 };
	struct lod_summary_hull summary;
	struct lod_hull_point room[LOD_SUMMARY_HULL_POINTS_MAX];
	lod_summary_hull_make(&summary, &view, 1, 1, 1, room);
	const double dense = lod_summary_hull_scale(&summary, 1024);
	summary.view.area = 5e3;
	assert_true(dense > 0 && dense < lod_summary_hull_scale(&summary, 1024));
}
