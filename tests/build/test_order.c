/* Orders by name: at random, by density, by orientation, and both. */
#include "lod/build/order/order.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

#define MOST 4000

static struct lod_arena arena;
static struct soup dice;
static struct lod_v3 center[MOST], normal[MOST];
static double survival[MOST], again[MOST];

static const enum lod_order_method baselines[] = { LOD_ORDER_STOCHASTIC, LOD_ORDER_DENSITY,
	LOD_ORDER_ORIENTATION, LOD_ORDER_COMBINED };
#define BASELINES (sizeof baselines / sizeof *baselines)

static void order_with(double *out, enum lod_order_method method, uint32_t count, double height,
	uint32_t seed, double noise)
{
	lod_order_survival_by(out, method, &(struct lod_order_input){ count, center, normal, height, seed,
		noise }, &arena);
	assert_null(arena.last);
}

static void order_by(double *out, enum lod_order_method method, uint32_t count, double height, uint32_t seed)
{
	order_with(out, method, count, height, seed, 0);
	for (uint32_t i = 0; i < count; i++)
		assert_true(out[i] >= 0 && out[i] < 2.5);
}

static void order(double *out, uint32_t count, double height, uint32_t seed)
{
	order_by(out, LOD_ORDER_COMBINED, count, height, seed);
}

static double mean(const double *values, uint32_t first, uint32_t end)
{
	double sum = 0;
	for (uint32_t i = first; i < end; i++)
		sum += values[i];
	return sum / (end - first);
}

static void crown(uint32_t count)
{
	dice.state = 7;
	for (uint32_t i = 0; i < count; i++) {
		center[i] = lod_v3_scale(soup_direction(&dice), 5 * sqrt(soup_random(&dice, 0, 1)));
		normal[i] = soup_direction(&dice);
	}
}

UNIT_TEST(values_are_in_range_and_repeatable)
{
	crown(MOST);
	for (size_t m = 0; m < BASELINES; m++) {
		order_by(survival, baselines[m], MOST, 10, 1);
		order_by(again, baselines[m], MOST, 10, 1);
		assert_memory_equal(survival, again, sizeof survival);
		order_by(again, baselines[m], MOST, 10, 2);
		assert_true(memcmp(survival, again, sizeof survival) != 0);
	}
}

/* On a shell, what lies in the surface (normal along the gradient) outlives what stands across; density does
 * not know. */
UNIT_TEST(what_faces_outwards_survives)
{
	dice.state = 3;
	for (uint32_t i = 0; i < MOST; i++) {
		struct lod_v3 d = soup_direction(&dice);
		center[i] = lod_v3_scale(d, 5);
		normal[i] = i < MOST / 2 ? lod_v3_scale(d, -1) : lod_v3_cross(d, soup_direction(&dice));
	}
	order(survival, MOST, 10, 1);
	assert_true(mean(survival, 0, MOST / 2) > mean(survival, MOST / 2, MOST) + 0.3);
	order_by(survival, LOD_ORDER_ORIENTATION, MOST, 10, 1);
	assert_true(mean(survival, 0, MOST / 2) > mean(survival, MOST / 2, MOST) + 0.3);
	order_by(survival, LOD_ORDER_DENSITY, MOST, 10, 1);
	assert_true(fabs(mean(survival, 0, MOST / 2) - mean(survival, MOST / 2, MOST)) < 0.05);
}

/* How far apart the survivals of what lies in the surface and of what stands across it are, over how much
 * chance adds. */
static double clearness(enum lod_order_method method, double noise)
{
	double spread = 0;
	order_with(survival, method, MOST, 10, 1, noise);
	double high = mean(survival, 0, MOST / 2), low = mean(survival, MOST / 2, MOST);
	for (uint32_t i = 0; i < MOST / 2; i++)
		spread += (survival[i] - high) * (survival[i] - high);
	return (high - low) / sqrt(spread / (MOST / 2));
}

UNIT_TEST(noise_blurs_orientation_but_neither_chance_nor_density)
{
	dice.state = 3;
	for (uint32_t i = 0; i < MOST; i++) {
		struct lod_v3 d = soup_direction(&dice);
		center[i] = lod_v3_scale(d, 5);
		normal[i] = i < MOST / 2 ? lod_v3_scale(d, -1) : lod_v3_cross(d, soup_direction(&dice));
	}
	for (int m = 0; m < 2; m++) {
		enum lod_order_method method = m ? LOD_ORDER_ORIENTATION : LOD_ORDER_COMBINED;
		assert_true(clearness(method, 0.05) > 1.5 * clearness(method, 0.5));
		assert_true(clearness(method, 0.5) > 1.5 * clearness(method, 1.5));
	}
	for (int m = 0; m < 2; m++) {
		order_with(survival, m ? LOD_ORDER_STOCHASTIC : LOD_ORDER_DENSITY, MOST, 10, 1, 0.3);
		order_with(again, m ? LOD_ORDER_STOCHASTIC : LOD_ORDER_DENSITY, MOST, 10, 1, 0);
		assert_memory_equal(survival, again, sizeof again);
	}
}

/* Three quarters of the elements in one corner: the first to go come from there, until density is even. */
UNIT_TEST(dense_regions_are_thinned_first)
{
	dice.state = 5;
	for (uint32_t i = 0; i < MOST; i++) {
		struct lod_v3 p = { soup_random(&dice, 0, 4), soup_random(&dice, 0, 4),
			soup_random(&dice, 0, 4) };
		center[i] = i % 4 ? lod_v3_scale(p, 0.5) : lod_v3_add(p, (struct lod_v3){ 6, 0, 0 });
		normal[i] = (struct lod_v3){ 0, 0, 0 };
	}
	for (int m = 0; m < 2; m++) {
		order_by(survival, m ? LOD_ORDER_DENSITY : LOD_ORDER_COMBINED, MOST, 10, 1);
		uint32_t low[2] = { 0, 0 };
		for (uint32_t i = 0; i < MOST; i++)
			low[i % 4 != 0] += survival[i] < 0.3;
		assert_true(low[1] > 100);
		assert_true(low[0] < low[1] / 20);
	}
}
