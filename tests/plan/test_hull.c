/* Hulls: what vertices gain where every pixel is covered. */
#include <math.h>

#include "lod/plan/hull.h"
#include "tests/support/scene_random.h"
#include "tests/support/unit_test.h"

static double detail_of(double octaves, double slack)
{
	struct lod_hull_point point = { .octaves = (float)octaves };
	lod_hull_set_detail(&point, slack, LOD_DETAIL_MOST);
	return point.detail;
}

UNIT_TEST(detail_grows_with_octaves_that_are_seen)
{
	assert_true(detail_of(2, 2) == 0 && detail_of(-3, 0) == 0 && detail_of(1, INFINITY) == 0);
	assert_true(fabs(detail_of(1.25, 0) - 1.25 * LOD_OCTAVE_WEIGHT) < 1e-9);
	assert_true(fabs(detail_of(2, 1) - LOD_OCTAVE_WEIGHT) < 1e-9);
	assert_true(detail_of(50, 0) == LOD_DETAIL_MOST);
}

/* Steps of a ladder whose curve finds nothing wrong, however little is drawn. */
static uint32_t steps(const struct eco_scene *scene, const struct eco_ladder *ladder, double slack)
{
	struct lod_way way;
	struct lod_hull_point points[LOD_HULL_POINTS_MAX];
	struct lod_hull hull = { points, 0, 1, slack, ECO_NONE };
	lod_way_begin(&way, scene, ladder);
	hull.count = lod_hull_sample(points, &way, lod_way_next(&way, 0), way.full, slack);
	lod_hull_reduce(&hull, LOD_HULL_SLOPE_RATIO);
	for (uint32_t i = 1; i < hull.count; i++)
		assert_true(lod_hull_slope(&hull, i) > 0
			&& lod_hull_slope(&hull, i) < lod_hull_slope(&hull, i - 1));
	return hull.count - 1;
}

UNIT_TEST(vertices_gain_where_no_pixel_is_wrong)
{
	static struct scene_builder r;
	uint32_t leaves = 0;
	for (uint64_t seed = 1; seed <= 20; seed++) {
		random_scene_make(&r, seed, 0);
		for (uint32_t i = 0; i < r.scene.curve_count; i++)
			r.curves[i].fp = r.curves[i].fn = 0;
		for (uint32_t i = 0; i < r.scene.ladder_count; i++) {
			const struct eco_ladder *ladder = &r.ladders[i];
			struct lod_way way;
			lod_way_begin(&way, &r.scene, ladder);
			if (!way.has_forms || ladder->organ == ECO_ORGAN_WOOD || !ladder->curve_count
					|| ladder->before || ladder->total < 8)
				continue;
			r.curves[ladder->curve_first].share = 1e-6f;     /* below it some is missing */
			leaves++;
			assert_true(steps(&r.scene, ladder, 0) > 0);
			assert_true(steps(&r.scene, ladder, 40) == 0);   /* smaller than a pixel */
		}
	}
	assert_true(leaves > 20);
}
