/* Points are counted by squares, on both sides of 0. */
#include <math.h>

#include "ecofiles/base/geometry.h"
#include "tests/support/unit_test.h"

UNIT_TEST(each_square_that_holds_points_is_a_crowd)
{
	double points[][2] = { { 11, 4 }, { -1, 1 }, { 19, 6 }, { -9, 3 }, { 15, 5 }, { 3, -0.5 } };
	struct eco_cluster crowds[6];
	assert_int_equal(eco_clusters_find(points, 6, 10, crowds), 3);
	assert_int_equal(crowds[0].count, 2);
	assert_true(crowds[0].middle[0] == -5 && crowds[0].middle[1] == 2);
	assert_int_equal(crowds[1].count, 1);
	assert_true(crowds[1].middle[0] == 3 && crowds[1].middle[1] == -0.5);
	assert_int_equal(crowds[2].count, 3);
	assert_true(fabs(crowds[2].middle[0] - 15) < 1e-12 && fabs(crowds[2].middle[1] - 5) < 1e-12);
	assert_int_equal(eco_clusters_find(points, 0, 10, crowds), 0);
}

UNIT_TEST(a_near_crowd_is_at_least_half_as_large_as_the_largest)
{
	const struct eco_cluster crowds[] = { { { 90, 0 }, 9 }, { { 50, 0 }, 5 }, { { 10, 0 }, 4 }, { { 60, 0 }, 8 } };
	const double here[2] = { 0, 0 }, there[2] = { 80, 0 };
	assert_ptr_equal(eco_cluster_near(crowds, 4, here), &crowds[1]);
	assert_ptr_equal(eco_cluster_near(crowds, 4, there), &crowds[0]);
	assert_null(eco_cluster_near(crowds, 0, here));
}
