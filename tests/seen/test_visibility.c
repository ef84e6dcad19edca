/* Visibility of plants: hidden by ground, seen from the side and from above, and around the eye. */
#include <math.h>
#include <string.h>

#include "lod/seen/visibility.h"
#include "tests/support/unit_test.h"

static const struct lod_proxy_shape tree = { .across = 2, .up = 5, .area = 60, .leaf_area = 60, .crown_across = 2,
	.crown_up = 4 };

#define PICTURE .up = { 0, 0, 1 }, .width = 800, .height = 600

static void look_at_trees(struct lod_screen *screen, const struct eco_view *view, const double (*feet)[3],
	uint32_t count)
{
	static struct lod_eye eye;
	lod_eye_make(&eye, view);
	lod_screen_init(screen, &eye, view, true);
	for (uint32_t i = 0; i < count; i++) {
		const double center[3] = { feet[i][0], feet[i][1], feet[i][2] + tree.up };
		assert_non_null(lod_screen_add(screen, center, &tree));
	}
	assert_good(lod_screen_shares(screen, true, &cause));
}

UNIT_TEST(what_lies_behind_a_ridge_is_hidden)
{
	/* behind a ridge: below it and above */
	double feet[15][3] = { { 0, 200, -10 }, { 0, 200, 60 } };
	const struct eco_view view = { .eye = { 0, 0, 25 }, .target = { 0, 200, 25 }, .fov_y_deg = 46,
		PICTURE };
	struct lod_screen screen;
	for (int i = 2; i < 15; i++)
		memcpy(feet[i], (const double[3]){ 0.3 * (i - 8), 100, 20 }, sizeof feet[i]);
	look_at_trees(&screen, &view, (const double (*)[3])feet, 15);
	assert_true(screen.visibilities[0].share < 0.01f);
	assert_true(screen.visibilities[1].share > 0.9f);
	lod_screen_free(&screen);
}

/* Trees lower down are farther from the eye and, where the slope rises upwards in the picture, lower on the
 * screen. */
UNIT_TEST(a_slope_seen_from_above_hides_nothing)
{
	/* the eye's distance from what it looks at, along the ground */
	static const double tilts[] = { 0.01, 20, 300 };
	double feet[41][3];
	struct lod_screen screen;
	for (int i = 0; i < 41; i++) {
		const double y = 20.0 * (i - 20);
		memcpy(feet[i], (const double[3]){ 0, y, 0.8 * y }, sizeof feet[i]);
	}
	for (size_t k = 0; k < sizeof tilts / sizeof *tilts; k++) {
		const struct eco_view view = { .eye = { 0, -tilts[k], 1200 }, .target = { 0, 0, 0 },
			.fov_y_deg = 52, PICTURE };
		look_at_trees(&screen, &view, (const double (*)[3])feet, 41);
		for (uint32_t i = 0; i < 41; i++)
			if (!(screen.visibilities[i].share > 0.9f))
				fail_msg("%g m beside: tree %u at row %g shows %g", tilts[k], i,
					(double)screen.visibilities[i].foot,
					(double)screen.visibilities[i].share);
		lod_screen_free(&screen);
	}
}

static struct lod_drawn some_wrong(void *ctx, const struct lod_visibility *visibility)
{
	return (struct lod_drawn){ .wrong = { .fp = 0.2, .fn = 0.1 } };
}

/* However dense its crown is: what is drawn too much of one without gaps lies around it. */
UNIT_TEST(of_a_tree_alone_as_much_is_wrong_as_its_curve_says)
{
	static const double areas[] = { 5, 60, 250, 5000 };
	const struct eco_view view = { .eye = { 0, -30, 5 }, .target = { 0, 0, 5 }, .fov_y_deg = 46,
		PICTURE };
	const double center[3] = { 0, 0, 5 };
	struct lod_eye eye;
	lod_eye_make(&eye, &view);
	for (size_t k = 0; k < sizeof areas / sizeof *areas; k++) {
		struct lod_proxy_shape proxy_shape = tree;
		struct lod_screen screen;
		struct eco_prediction p;
		proxy_shape.leaf_area = areas[k];
		lod_screen_init(&screen, &eye, &view, false);
		assert_non_null(lod_screen_add(&screen, center, &proxy_shape));
		assert_int_equal(lod_screen_shares(&screen, true, NULL), ECO_OK);
		assert_int_equal(lod_screen_expect(&screen, some_wrong, NULL, &p, NULL), ECO_OK);
		assert_float_equal(p.fp / (p.tp + p.fn), 0.2, 0.01);
		assert_float_equal(p.fn / (p.tp + p.fn), 0.1, 0.01);
		lod_screen_free(&screen);
	}
}

static double pixels_of(const struct lod_visibility *visibility)
{
	return (double)visibility->share * (double)visibility->pixels;
}

/* Those that the eye is in hide each other and what stands behind them: together they show no more than the
 * picture has. */
UNIT_TEST(plants_around_the_eye_hide_each_other)
{
	static const double feet[6][3] = { { 0, 25, -5 }, { 0, -0.5, -5 }, { 0.6, -0.3, -5 },
		{ -0.7, -0.1, -5 }, { 0.2, -0.8, -5 }, { -0.3, -0.4, -5 } };
	const struct eco_view view = { .eye = { 0, 0, 0 }, .target = { 0, 1, 0 }, .fov_y_deg = 50,
		PICTURE };
	struct lod_screen screen;
	look_at_trees(&screen, &view, feet, 1);
	float alone = screen.visibilities[0].share;
	lod_screen_free(&screen);
	look_at_trees(&screen, &view, feet, 6);
	double seen = 0;
	for (uint32_t i = 0; i < 6; i++)
		seen += pixels_of(&screen.visibilities[i]);
	assert_true(screen.crowns[1].inside && screen.crowns[5].inside);
	assert_true(seen < 800 * 600);
	assert_true(screen.visibilities[0].share < 0.2f * alone);
	lod_screen_free(&screen);
}

/* Anywhere around and among them, whatever their sizes: each is lit by what others leave. */
UNIT_TEST(plants_show_no_more_pixels_than_the_picture_has)
{
	struct rng { uint64_t s; } r = { 7 };
	for (int scene = 0; scene < 60; scene++) {
		struct lod_screen screen;
		struct lod_eye eye;
		double seen = 0, number[4];
		const struct eco_view view = { .eye = { 0, 0, 2 }, .target = { 0, 10, 2 }, .fov_y_deg = 55, PICTURE };
		lod_eye_make(&eye, &view);
		lod_screen_init(&screen, &eye, &view, scene % 2);
		for (int i = 0; i < 80; i++) {
			for (int k = 0; k < 4; k++) {
				r.s = r.s * 6364136223846793005u + 1442695040888963407u;
				number[k] = (double)(r.s >> 11) * 0x1p-53;
			}
			struct lod_proxy_shape shape = { .across = 0.2 + 5 * number[0], .up = 0.2 + 8 * number[1], .area = 100 };
			shape.leaf_area = 200 * number[2];
			shape.crown_across = shape.across;
			shape.crown_up = 0.7 * shape.up;
			shape.rise = 0.3 * shape.up;
			shape.stem = 0.3 * number[3];
			const double center[3] = { 30 * number[3] - 15, 40 * number[2] - 10, shape.up };
			assert_non_null(lod_screen_add(&screen, center, &shape));
		}
		assert_good(lod_screen_shares(&screen, true, &cause));
		for (uint32_t i = 0; i < screen.count; i++) {
			assert_true(screen.visibilities[i].share > 0 && screen.visibilities[i].share <= 1);
			seen += pixels_of(&screen.visibilities[i]);
		}
		assert_true(seen > 0 && seen < 1.02 * 800 * 600);
		lod_screen_free(&screen);
	}
}

/* Past the eye, one and two radii aside, or through it. Plants beside the eye are not in the picture; a plant
 * around the eye is. */
UNIT_TEST(what_passes_the_eye_goes_little_by_little)
{
	const struct eco_view view = { .eye = { 0, 0, 5 }, .target = { 0, 10, 5 }, .fov_y_deg = 50,
		PICTURE };
	struct lod_screen screen;
	double before[3] = { 0 };
	for (int step = 0; step <= 400; step++) {
		const double y = 5 - 0.025 * step, feet[3][3] = { { 0, y, 0 }, { 2, y, 0 }, { 4, y, 0 } };
		look_at_trees(&screen, &view, feet, 3);
		for (int i = 0; i < 3; i++) {
			double seen = pixels_of(&screen.visibilities[i]);
			if (step && fabs(before[i] - seen) > 0.12 * 800 * 600)
				fail_msg("tree %d, step %d: %g pixels after %g", i, step, seen, before[i]);
			before[i] = seen;
		}
		assert_true(y > 1 || before[2] < 0.01 * 800 * 600);
		lod_screen_free(&screen);
	}
	assert_true(before[0] < 0.005 * 800 * 600 && before[1] < 0.005 * 800 * 600);   /* their shadows */
}

/* A crown overhead covers the top of the picture, as far as it hangs into it: what stands behind, lower,
 * shows all of itself. */
UNIT_TEST(a_crown_overhead_hides_nothing_below_it)
{
	static const double middles[2][3] = { { 0, 40, 5 }, { 0, 4, 9 } };
	const struct eco_view view = { .eye = { 0, 0, 1.7 }, .target = { 0, 40, 1.7 }, .fov_y_deg = 50, PICTURE };
	struct lod_screen screen;
	struct lod_eye eye;
	lod_eye_make(&eye, &view);
	lod_screen_init(&screen, &eye, &view, false);
	for (int i = 0; i < 2; i++)
		assert_non_null(lod_screen_add(&screen, middles[i], &tree));
	assert_good(lod_screen_shares(&screen, true, &cause));
	assert_true(screen.visibilities[0].share > 0.9f);
	assert_true(pixels_of(&screen.visibilities[1]) < 0.1 * 800 * 600);
	lod_screen_free(&screen);
}

/* Wood on the tree's axis, slice by slice, over the same at the distance of the tree's middle. */
static double wood_of(const double eye[3])
{
	double thick = 0.1 * tree.crown_across, level2 = eye[0] * eye[0] + eye[1] * eye[1] + thick * thick, sum = 0,
		middle = level2 + (eye[2] - tree.up) * (eye[2] - tree.up);
	for (int i = 0; i < 100000; i++) {
		double z = 2 * tree.up * (i + 0.5) / 100000 - eye[2], apart = level2 + z * z;
		sum += sqrt(level2) / (apart * sqrt(apart)) / 100000;
	}
	return middle * sum;
}

/* A trunk is as large as it is near; leaves hide less of it to an eye within the crown. */
UNIT_TEST(a_trunk_shows_by_its_nearness)
{
	static const double foot[1][3] = { { 0, 0, 0 } };
	/* nearer: than before, in the next four */
	static const struct { double eye[3], behind; bool nearer; } cases[] = { { { 0, -2000, 2 }, 1, true },
		{ { 0, -40, 5 }, 1, true }, { { 0, -8, 1.7 }, 1, true }, { { 1, -2, 1.7 }, 1, true },
		{ { 0, -0.3, 1.7 }, 0.15, true }, { { 0, -30, 1.7 }, 1, false }, { { 0, -2, 1.7 }, 1, false },
		{ { 0, -1, 1.7 }, 0.5, false }, { { 0, 0, 1.7 }, 0, false }, { { 0, 0.001, 7 }, 0.5, false },
		{ { 0, 0.001, 9 }, 1, false }, { { 0, 0.001, 60 }, 1, false } };
	float before = 0;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		const double *at = cases[i].eye;
		const struct eco_view view = { .eye = { at[0], at[1], at[2] }, .target = { 0, 100, at[2] },
			.fov_y_deg = 50, PICTURE };
		struct lod_screen screen;
		look_at_trees(&screen, &view, foot, 1);
		float nearer = screen.visibilities[0].wood_nearer;
		assert_float_equal(screen.visibilities[0].wood_behind, cases[i].behind, 0.001);
		assert_float_equal(nearer, fmax(1, wood_of(at)), 0.001 * (double)nearer);
		assert_true(i > 0 || nearer < 1.001f);
		assert_true(!cases[i].nearer || nearer >= before);
		assert_true(!cases[i].nearer || cases[i + 1].nearer || nearer > 5);
		before = nearer;
		lod_screen_free(&screen);
	}
}
