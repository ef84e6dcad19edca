/* Steps of summaries that are computed as they are asked for, against all of them. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>

#include "ecofiles/base/mix.h"
#include "lod/plan/summary_hull.h"

#define VIEWS 4000u

struct pair {
	struct lod_summary_view view;
	struct lod_points asked, all;
	uint64_t asked_gains, all_gains;
	struct lod_amount asked_room[2 * LOD_POINTS_SAMPLES_MAX + 1], all_room[2 * LOD_POINTS_SAMPLES_MAX + 1];
	bool falls;                          /* the more points, the less is wrong: what is taken for granted */
};

static double random_real(uint64_t *state, double from, double to)
{
	return from + (to - from) * eco_mix_unit(eco_mix(++*state, 7));
}

static void begin(struct pair *pair, uint64_t *state)
{
	double plants = exp2(random_real(state, 0, 14)), box = exp2(random_real(state, -6, 12));
	double points = floor(fmin(4096, fmax(1, plants * exp2(random_real(state, -3, 3))))), extra = random_real(state, 0, 1),
		part = random_real(state, 0.01, 1);
	pair->view = (struct lod_summary_view){ .plants = plants, .box = plants * box, .covered = plants * box * random_real(state, 0.05, 1),
		.area = plants * box * random_real(state, 0.1, 4), .points = points, .wide = sqrt(plants * box) * random_real(state, 0.5, 4) };
	pair->view.high = pair->view.wide * random_real(state, 0.05, 1);
	pair->asked_gains = pair->all_gains = 0;
	lod_points_begin(&pair->asked, &pair->view, part, 1, extra, pair->asked_room, &pair->asked_gains);
	lod_points_begin(&pair->all, &pair->view, part, 1, extra, pair->all_room, &pair->all_gains);
	lod_points_all(&pair->all);
	pair->falls = true;
	for (uint32_t i = 1; i < pair->all.count; i++)
		pair->falls = pair->falls && lod_steps_error(&pair->all.steps, &pair->all.samples[i]) <= lod_steps_error(&pair->all.steps,
			&pair->all.samples[i - 1])
			&& pair->all.samples[i].fn <= pair->all.samples[i - 1].fn;
}

/* What is left wrong at a price, and the vertices. */
static struct lod_amount bought(const struct lod_points *points, double price)
{
	double position = lod_steps_position(&points->steps, price, 0), part = position - floor(position);
	const struct lod_amount *a = &points->steps.amounts[(uint32_t)position], *b = part > 0 ? a + 1 : a;
	double wrong = lod_steps_error(&points->steps, a), next = lod_steps_error(&points->steps, b);
	return (struct lod_amount){ .fn = wrong + part * (next - wrong), .fn_price = (double)a->vertices + part * (double)(b->vertices - a->vertices) };
}

static double saved(const struct lod_points *points, double price)
{
	struct lod_amount amount = bought(points, price);
	return 1 - amount.fn - price * amount.fn_price;
}

static double random_price(uint64_t *state) { return exp2(random_real(state, -24, 2)); }

static void what_is_asked_for_is_what_all_amounts_give(void **state)
{
	uint64_t random = 1;
	uint32_t falling = 0;
	(void)state;
	for (uint32_t v = 0; v < VIEWS; v++) {
		struct pair pair;
		begin(&pair, &random);
		falling += pair.falls;
		for (int i = 0; i < 6; i++) {
			double price = random_price(&random);
			while (lod_points_step(&pair.asked, price))
				;
			struct lod_amount a = bought(&pair.asked, price), b = bought(&pair.all, price);
			if (pair.falls)
				assert_true(fabs(a.fn - b.fn) < 1e-9 && fabs(a.fn_price - b.fn_price) < 1e-6);
			else
				assert_true(saved(&pair.asked, price) > saved(&pair.all, price) - 0.05);
			assert_true(lod_points_most(&pair.asked, price) >= saved(&pair.asked, price) - 1e-9);
		}
	}
	assert_true(falling > VIEWS / 4);
}

static void what_can_be_saved_is_bounded_before_it_is_computed(void **state)
{
	uint64_t random = 2;
	(void)state;
	for (uint32_t v = 0; v < VIEWS; v++) {
		struct pair pair;
		begin(&pair, &random);
		double price = random_price(&random), least = saved(&pair.all, price), before = INFINITY;
		do {
			double most = lod_points_most(&pair.asked, price);
			assert_true(!pair.falls || most <= before + 1e-9);
			assert_true(!pair.falls || most >= least - 1e-9);
			before = most;
		} while (lod_points_step(&pair.asked, price));
	}
}

static void few_amounts_are_computed_for_a_price(void **state)
{
	uint64_t random = 3, asked = 0, all = 0;
	(void)state;
	for (uint32_t v = 0; v < VIEWS; v++) {
		struct pair pair;
		begin(&pair, &random);
		double price = random_price(&random);
		while (lod_points_step(&pair.asked, price))
			;
		assert_true(pair.asked_gains <= pair.all_gains && pair.all_gains == pair.all.count);
		asked += pair.asked_gains;
		all += pair.all_gains;
	}
	print_message("          %.2f amounts of %.2f\n", (double)asked / VIEWS, (double)all / VIEWS);
	assert_true(2 * asked < all);
}

static void amounts_are_halves_down_to_one_point(void **state)
{
	static const struct { double points; uint32_t count; } cases[] = { { 1, 1 }, { 2, 2 }, { 3, 2 }, { 4, 3 }, { 4096, 13 }, { 4294967295.0, 32 } };
	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct lod_summary_view view = { .area = 100, .covered = 50, .box = 100, .plants = 10, .points = cases[i].points };
		struct lod_amount room[2 * LOD_POINTS_SAMPLES_MAX + 1];
		struct lod_points points;
		uint64_t gains = 0;
		double high, low;
		assert_int_equal(lod_points_count(cases[i].points), cases[i].count);
		lod_points_begin(&points, &view, 1, 1, 0.5, room, &gains);
		assert_int_equal(points.count, cases[i].count);
		assert_true(points.samples[0].vertices == 1 && points.samples[points.count - 1].vertices == (uint64_t)cases[i].points);
		assert_int_equal(gains, 1);
		lod_points_prices(&points, &high, &low);
		assert_true(high >= low && low >= 0);
		lod_points_all(&points);
		assert_int_equal(gains, cases[i].count);
		for (uint32_t k = 1; k < points.steps.count; k++)
			assert_true(lod_steps_price(&points.steps, k) <= high * (1 + 1e-9));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(what_is_asked_for_is_what_all_amounts_give),
		cmocka_unit_test(what_can_be_saved_is_bounded_before_it_is_computed),
		cmocka_unit_test(few_amounts_are_computed_for_a_price),
		cmocka_unit_test(amounts_are_halves_down_to_one_point),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
