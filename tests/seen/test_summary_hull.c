/* Steps of summaries that are computed as they are asked for, against all of them. */
#include <math.h>

#include "ecofiles/base/random.h"
#include "lod/seen/summary_hull.h"
#include "tests/support/unit_test.h"

#define VIEWS 4000u

struct pair {
	struct lod_summary_view view;
	struct lod_summary_hull asked, all;
	uint64_t asked_gains, all_gains;
	struct lod_hull_point asked_room[2 * LOD_SUMMARY_HULL_SAMPLES_MAX + 1],
		all_room[2 * LOD_SUMMARY_HULL_SAMPLES_MAX + 1];
	/* the more points, the less is wrong: what is taken for granted */
	bool falls;
};

static double random_real(uint64_t *state, double from, double to)
{
	return from + (to - from) * eco_random_unit(eco_random(++*state, 7));
}

static void begin(struct pair *pair, uint64_t *state)
{
	double plants = exp2(random_real(state, 0, 14)), box = exp2(random_real(state, -6, 12));
	double points = floor(fmin(4096, fmax(1, plants * exp2(random_real(state, -3, 3))))),
		fp_weight = random_real(state, 0, 1), part = random_real(state, 0.01, 1);
	pair->view = (struct lod_summary_view){ .plants = plants, .box = plants * box,
		.covered = plants * box * random_real(state, 0.05, 1),
		.area = plants * box * random_real(state, 0.1, 4), .points = points,
		.wide = sqrt(plants * box) * random_real(state, 0.5, 4), .weight_px = 2 * plants * box };
	pair->view.high = pair->view.wide * random_real(state, 0.05, 1);
	pair->asked_gains = pair->all_gains = 0;
	lod_summary_hull_begin(&pair->asked, &pair->view, part, 1, fp_weight, pair->asked_room,
		&pair->asked_gains);
	lod_summary_hull_begin(&pair->all, &pair->view, part, 1, fp_weight, pair->all_room, &pair->all_gains);
	lod_summary_hull_complete(&pair->all);
	pair->falls = true;
	for (uint32_t i = 1; i < pair->all.count; i++)
		pair->falls = pair->falls && lod_hull_error(&pair->all.hull, &pair->all.samples[i])
			<= lod_hull_error(&pair->all.hull, &pair->all.samples[i - 1])
			&& pair->all.samples[i].alike <= pair->all.samples[i - 1].alike;
}

/* Error left at a lambda, and the vertices. */
static struct lod_hull_point bought(const struct lod_summary_hull *points, double lambda)
{
	double position = lod_hull_position(&points->hull, lambda, 0), part = position - floor(position);
	const struct lod_hull_point *a = &points->hull.points[(uint32_t)position], *b = part > 0 ? a + 1 : a;
	double wrong = lod_hull_error(&points->hull, a), next = lod_hull_error(&points->hull, b);
	return (struct lod_hull_point){ .alike = wrong + part * (next - wrong),
		.alike_slope = (double)a->vertices + part * (double)(b->vertices - a->vertices) };
}

static double saved(const struct lod_summary_hull *points, double lambda)
{
	struct lod_hull_point point = bought(points, lambda);
	return 1 - point.alike - lambda * point.alike_slope;
}

static double random_lambda(uint64_t *state) { return exp2(random_real(state, -24, 2)); }

UNIT_TEST(what_is_asked_for_is_what_all_points_give)
{
	uint64_t random = 1;
	uint32_t falling = 0;
	for (uint32_t v = 0; v < VIEWS; v++) {
		struct pair pair;
		begin(&pair, &random);
		falling += pair.falls;
		for (int i = 0; i < 6; i++) {
			double lambda = random_lambda(&random);
			while (lod_summary_hull_refine(&pair.asked, lambda))
				;
			struct lod_hull_point a = bought(&pair.asked, lambda), b = bought(&pair.all, lambda);
			if (pair.falls)
				assert_true(fabs(a.alike - b.alike) < 1e-9 && fabs(a.alike_slope - b.alike_slope) < 1e-6);
			else
				assert_true(saved(&pair.asked, lambda) > saved(&pair.all, lambda) - 0.05);
			assert_true(lod_summary_hull_gain_bound(&pair.asked, lambda)
				>= saved(&pair.asked, lambda) - 1e-9);
		}
	}
	assert_true(falling > VIEWS / 4);
}
