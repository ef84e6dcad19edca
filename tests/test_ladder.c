/* Ladders: every amount can be drawn to the primitive, amounts ascend, and the blend draws exactly what was asked. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "lod/ladder.h"
#include "tests/scene_random.h"

static struct random_scene scene;

static uint64_t drawn(const struct eco_cut *cuts, uint32_t count)
{
	uint64_t total = 0;
	for (uint32_t i = 0; i < count; i++) {
		uint8_t kind = scene.lists[cuts[i].list].kind;
		total += (uint64_t)(cuts[i].end - cuts[i].first) * (kind == ECO_LIST_TRIANGLES ? 3 : kind == ECO_LIST_LINES ? 2 : 1);
	}
	return total;
}

static void every_step_draws_what_it_says(void **state)
{
	(void)state;
	for (uint64_t seed = 1; seed < 40; seed++) {
		random_scene_make(&scene, seed, 0);
		for (uint32_t l = 0; l < scene.scene.ladder_count; l++) {
			const struct eco_ladder *ladder = &scene.ladders[l];
			uint64_t v = 0, full = lod_ladder_full(&scene.scene, ladder), steps = 0;
			assert_int_equal(lod_ladder_floor(&scene.scene, ladder, 0), 0);
			while (v != full) {
				uint64_t next = lod_ladder_next(&scene.scene, ladder, v);
				struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
				assert_true(next > v && next <= full);
				assert_int_equal(lod_ladder_floor(&scene.scene, ladder, next), next);
				assert_int_equal(lod_ladder_floor(&scene.scene, ladder, next - 1), v);
				uint32_t n = lod_ladder_cuts(&scene.scene, ladder, next, 0.5, cuts);
				assert_int_equal(drawn(cuts, n), next);
				v = next;
				assert_true(++steps < 100000);
			}
			assert_true(lod_ladder_next(&scene.scene, ladder, full) == UINT64_MAX);
			assert_int_equal(lod_ladder_floor(&scene.scene, ladder, UINT64_MAX), full);
		}
	}
}

/* Deussen 2002, 5.3, with k triangles and 2k points. */
static void the_blend_replaces_points_by_their_triangles(void **state)
{
	(void)state;
	random_scene_make(&scene, 3, 0);
	struct eco_scene *s = &scene.scene;
	const uint32_t k = 50;
	struct eco_ladder ladder = { .organ = ECO_ORGAN_FOLIAGE, .lines = ECO_NONE, .total = 2 * k };
	ladder.triangles = random_list(&scene, ECO_LIST_TRIANGLES, k, 0, ECO_NONE);
	ladder.points = random_list(&scene, ECO_LIST_POINTS, 2 * k, 0, ECO_NONE);
	for (uint32_t p = 2 * k + 1; p < 3 * k; p++) {
		struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
		assert_int_equal(lod_ladder_cuts(s, &ladder, p, 1, cuts), 2);
		assert_int_equal(cuts[0].list, ladder.triangles);
		assert_int_equal(cuts[0].first, 0);
		assert_int_equal(cuts[0].end, p - 2 * k);
		assert_int_equal(cuts[1].list, ladder.points);
		assert_int_equal(cuts[1].first, 2 * (p - 2 * k));
		assert_int_equal(cuts[1].end, 2 * k);
	}
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
	assert_int_equal(lod_ladder_cuts(s, &ladder, 3 * k, 1, cuts), 1);
	assert_int_equal(cuts[0].end, k);
}

static void wood_is_never_scaled_and_leaves_are_by_their_curve(void **state)
{
	(void)state;
	random_scene_make(&scene, 3, 0);
	for (uint32_t l = 0; l < scene.scene.ladder_count; l++) {
		struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
		const struct eco_ladder *ladder = &scene.ladders[l];
		uint64_t v = lod_ladder_next(&scene.scene, ladder, 0);
		if (!lod_ladder_cuts(&scene.scene, ladder, v, 0.01, cuts))
			continue;
		if (ladder->organ == ECO_ORGAN_WOOD)
			assert_true(cuts[0].scale == 1);
		else if (v < lod_ladder_full(&scene.scene, ladder) && cuts[0].list != ladder->triangles)
			assert_true(cuts[0].scale > 1);
	}
}

static void a_curve_is_interpolated_and_clamped(void **state)
{
	(void)state;
	random_scene_make(&scene, 5, 0);
	struct eco_curve samples[] = { { 0.1f, 2, 0.2f, 0.4f }, { 0.5f, 1, 0.1f, 0.2f }, { 1, 1, 0, 0 } };
	memcpy(scene.curves, samples, sizeof samples);
	struct eco_ladder ladder = { .curve_first = 0, .curve_count = 3 };
	struct { double share, scale, fn; } rows[] = { { 0, 2, 1 }, { 0.05, 2, 0.7 }, { 0.1, 2, 0.4 }, { 0.3, 1.5, 0.3 }, { 0.5, 1, 0.2 },
		{ 1, 1, 0 }, { 7, 1, 0 } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct eco_curve c = lod_ladder_curve(&scene.scene, &ladder, rows[i].share);
		assert_float_equal(c.scale, rows[i].scale, 1e-5);
		assert_float_equal(c.fn, rows[i].fn, 1e-5);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_step_draws_what_it_says),
		cmocka_unit_test(the_blend_replaces_points_by_their_triangles),
		cmocka_unit_test(wood_is_never_scaled_and_leaves_are_by_their_curve),
		cmocka_unit_test(a_curve_is_interpolated_and_clamped),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
