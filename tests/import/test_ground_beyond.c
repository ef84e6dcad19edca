/* Ground where no raster is: beyond the border of one, up to the horizon, and through the feet of plants. */
#include <math.h>

#include "ecofiles/base/random.h"
#include "ecofiles/format/pack.h"
#include "ecofiles/import/ground/ground.h"
#include "tests/support/ground_tiles.h"
#include "tests/support/unit_test.h"

#define HORIZON_M 131072.0

static uint64_t state;

static double unit(void) { return eco_random_unit(eco_random_next(&state)); }

static double hills(double x, double y) { return 30 * sin(x / 90) * cos(y / 70) + 0.2 * x; }
static double cliff(double x, double y) { return x > 150 ? 200 : y / 10; }
static double level(double x, double y) { return 7; }

static const struct { double (*height)(double, double); uint32_t columns, rows; double step; } grounds[] = {
	{ hills, 80, 61, 5 }, { cliff, 200, 20, 2 }, { level, 2, 2, 300 }, { hills, 2, 50, 0.1 },
	{ hills, 700, 3, 30 },
};
#define GROUNDS (sizeof grounds / sizeof *grounds)

static struct eco_ground extended(size_t k, struct eco_ground *inside)
{
	struct eco_ground g = ground_make(grounds[k].columns, grounds[k].rows, -20, 10, grounds[k].step,
		grounds[k].height);
	*inside =
		ground_make(grounds[k].columns, grounds[k].rows, -20, 10, grounds[k].step, grounds[k].height);
	eco_ground_extend(&g);
	return g;
}

static double height(const struct eco_ground *g, double x, double y)
{
	double z;
	eco_ground_height(g, x, y, &z);
	return z;
}

/* ---- Places ---- */

UNIT_TEST(steps_double_from_sample_to_sample_of_a_margin)
{
	static const int32_t places[] = { -7, -3, -1, 0, 1, 2, 3, 5, 9 };
	for (uint32_t i = 0; i < 9; i++) {
		assert_int_equal(eco_ground_place(i, 9, 3), places[i]);
		assert_int_equal(eco_ground_sample_at(places[i], 9, 3), i);
	}
	for (uint32_t margin = 0; margin <= ECO_GROUND_MARGIN_MAX; margin++)
		for (uint32_t i = 0, count = 2 * margin + 5; i < count; i++) {
			int32_t at = eco_ground_place(i, count, margin);
			assert_int_equal(eco_ground_sample_at(at, count, margin), i);
			assert_true(i == 0 || at > eco_ground_place(i - 1, count, margin));
		}
	assert_int_equal(eco_ground_sample_at(-2, 9, 3), ECO_GROUND_SIDE_MAX);
	assert_int_equal(eco_ground_sample_at(4, 9, 3), ECO_GROUND_SIDE_MAX);
	assert_int_equal(eco_ground_sample_at(17, 9, 3), ECO_GROUND_SIDE_MAX);
}

/* ---- Beyond the border ---- */

UNIT_TEST(at_the_border_the_ground_goes_on_without_a_step)
{
	for (size_t k = 0; k < GROUNDS; k++) {
		struct eco_ground inside, g = extended(k, &inside);
		double east = g.x_m + (inside.columns - 1) * g.step_x_m,
		       north = g.y_m + (inside.rows - 1) * g.step_y_m;
		for (int n = 0; n < 500; n++) {
			double x = g.x_m + unit() * (east - g.x_m), y = g.y_m + unit() * (north - g.y_m),
			       e = 1e-7;
			assert_true(fabs(height(&g, x, g.y_m - e) - height(&inside, x, g.y_m)) < 1e-3);
			assert_true(fabs(height(&g, x, north + e) - height(&inside, x, north)) < 1e-3);
			assert_true(fabs(height(&g, g.x_m - e, y) - height(&inside, g.x_m, y)) < 1e-3);
			assert_true(fabs(height(&g, east + e, y) - height(&inside, east, y)) < 1e-3);
		}
		eco_ground_free(&inside);
		eco_ground_free(&g);
	}
}

/* No cliff that the border does not have: between two samples beyond it the ground rises by no more than
 * the border's whole relief over the distance at which it fades, or its own steepest step. */
UNIT_TEST(beyond_the_border_it_is_graded_to_the_horizon)
{
	for (size_t k = 0; k < GROUNDS; k++) {
		struct eco_ground inside, g = extended(k, &inside);
		double low = INFINITY, high = -INFINITY, step = grounds[k].step;
		for (uint32_t r = 0; r < inside.rows; r++)
			for (uint32_t c = 0; c < inside.columns;
				c += r % (inside.rows - 1) ? inside.columns - 1 : 1) {
				low = fmin(low, (double)inside.height_m[r * inside.columns + c]);
				high = fmax(high, (double)inside.height_m[r * inside.columns + c]);
			}
		double fade = step * (inside.columns + inside.rows) / 4;
		for (int n = 0; n < 400; n++) {
			double angle = 6.2831853 * unit(), last = NAN, before = 0;
			for (double out = 1000 * step; out < 1.4 * HORIZON_M; out *= 1.1) {
				double z = height(&g, cos(angle) * out, sin(angle) * out);
				assert_true(z >= low - 1e-3 && z <= high + 1e-3);
				assert_true(isnan(last) ||
					fabs(z - last) <= (high - low) * (out - before) / fade + 1e-3);
				last = z;
				before = out;
			}
		}
		double reach = (ldexp(1, (int)g.margin) - 1) * step;
		assert_true(reach >= HORIZON_M && reach >= 3.9 * step * inside.columns);
		assert_true(reach < 2 * fmax(HORIZON_M, 4 * step * fmax(inside.columns, inside.rows)) + step);
		for (uint32_t c = 0; c < g.columns; c++)         /* the outermost ring is level */
			assert_true(g.height_m[c] == g.height_m[0]
				&& g.height_m[(size_t)(g.rows - 1) * g.columns + c] == g.height_m[0]);
		eco_ground_free(&inside);
		eco_ground_free(&g);
	}
}

/* ---- Through plants ---- */

static struct eco_ground through(const double (*at)[3], uint32_t count, double size)
{
	struct eco_ground g;
	struct eco_ground_feet feet = { .at = at, .count = count, .low = { -5, -5 },
		.high = { size + 5, size / 2 + 5 } };
	eco_ground_through(&g, &feet);
	return g;
}

static double plane(double x, double y) { return 3 + 0.3 * x - 0.1 * y; }

UNIT_TEST(plants_on_a_plane_or_on_hills_stand_on_the_ground)
{
	static double at[3000][3];
	static const struct {
		double (*height)(double, double);
		uint32_t count;
		double size, within;
	} cases[] = { { plane, 3, 80, 0.002 }, { plane, 500, 400, 0.002 }, { hills, 40, 900, 0.011 },
		{ hills, 3000, 900, 0.011 }, { cliff, 200, 300, 0.011 } };
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		state = 10 + k;
		for (uint32_t i = 0; i < cases[k].count; i++) {
			/* at least 3 m apart, as trees are: a place of its own in a grid */
			uint32_t row = (uint32_t)ceil(sqrt(2.0 * cases[k].count));
			double cell = cases[k].size / row;
			at[i][0] = (i % row + 0.8 * unit()) * cell;
			at[i][1] = (i / row + 0.8 * unit()) * cell;
			at[i][2] = cases[k].height(at[i][0], at[i][1]);
		}
		struct eco_ground g = through((const double (*)[3])at, cases[k].count, cases[k].size);
		assert_true((g.columns == 2) == (cases[k].height == plane));
		for (uint32_t i = 0; i < cases[k].count; i++) {
			double off = fabs(height(&g, at[i][0], at[i][1]) - at[i][2]);
			if (off > cases[k].within)
				fail_msg("case %zu: plant %u is %g m off the ground", k, i, off);
		}
		eco_ground_free(&g);
	}
}

UNIT_TEST(plants_in_a_row_and_at_one_place_have_ground_too)
{
	double row[30][3];
	for (int i = 0; i < 30; i++)
		row[i][0] = 3 * i, row[i][1] = 4, row[i][2] = 0.5 * i;
	struct eco_ground g = through((const double (*)[3])row, 30, 100);
	for (int i = 0; i < 30; i++)
		assert_true(fabs(height(&g, row[i][0], row[i][1]) - row[i][2]) < 0.01);
	assert_true(fabs(height(&g, 45, 20) - height(&g, 45, 4)) < 1);     /* level across the row */
	eco_ground_free(&g);
	static const double twins[][3] = { { 5, 5, 1 }, { 5, 5, 3 }, { 60, 20, 2 } };
	g = through(twins, 3, 100);
	assert_true(fabs(height(&g, 5, 5) - 2) < 0.01 && fabs(height(&g, 60, 20) - 2) < 0.01);
	eco_ground_free(&g);
}
