/* Areas and blue noise: what is inside, what is near, what is spread evenly, against brute force. */
#include <math.h>
#include <string.h>

#include "ecofiles/import/land/areas.h"
#include "ecofiles/import/land/scatter_parts.h"
#include "ecofiles/base/random.h"
#include "tests/support/unit_test.h"

struct wkb { uint8_t bytes[65536]; size_t size; };

static void put(struct wkb *w, const void *bytes, size_t size)
{
	assert_true(w->size + size <= sizeof w->bytes);
	memcpy(w->bytes + w->size, bytes, size);
	w->size += size;
}

static void put_head(struct wkb *w, uint32_t kind)
{
	put(w, &(uint8_t){ 1 }, 1);
	put(w, &kind, 4);
}

static void put_path(struct wkb *w, const double (*at)[2], uint32_t count)
{
	put(w, &count, 4);
	put(w, at, count * sizeof *at);
}

static bool as_is(void *ctx, double xy[2], struct eco_error *error)
{
	return true;
}

static void add(struct eco_areas *areas, const struct wkb *w)
{
	bool kept;
	assert_int_equal(eco_areas_add_wkb(areas, w->bytes, w->size, as_is, NULL, &kept, NULL), ECO_OK);
	assert_true(kept);
}

static const double square[5][2] = { { 0, 0 }, { 10, 0 }, { 10, 10 }, { 0, 10 }, { 0, 0 } };
/* open: it is closed for the reader */
static const double hole[4][2] = { { 2, 2 }, { 2, 6 }, { 6, 6 }, { 6, 2 } };
static const double far_square[5][2] = { { 20, 20 }, { 24, 20 }, { 24, 24 }, { 20, 24 }, { 20, 20 } };

UNIT_TEST(holes_and_several_polygons_are_one_area)
{
	struct eco_areas areas = { .items = NULL };
	struct wkb w = { .size = 0 };
	put_head(&w, 6);
	put(&w, &(uint32_t){ 2 }, 4);
	put_head(&w, 3);
	put(&w, &(uint32_t){ 2 }, 4);
	put_path(&w, square, 5);
	put_path(&w, hole, 4);
	put_head(&w, 3);
	put(&w, &(uint32_t){ 1 }, 4);
	put_path(&w, far_square, 5);
	add(&areas, &w);
	assert_int_equal(eco_areas_index(&areas, 0, NULL), ECO_OK);
	assert_int_equal(areas.count, 1);
	assert_true(areas.items[0].size_m2 == 100 - 16 + 16);
	assert_true(eco_area_holds(&areas, 0, 1, 1) && eco_area_holds(&areas, 0, 21, 23)
		&& eco_areas_hold(&areas, 9.9, 9.9));
	assert_false(eco_area_holds(&areas, 0, 3, 3) || eco_area_holds(&areas, 0, 15, 15)
		|| eco_areas_hold(&areas, -1, 5));
	eco_areas_free(&areas);
}

/* A wild closed line: the even-odd rule by bands must agree with the rule itself. */
UNIT_TEST(bands_agree_with_every_edge)
{
	enum { CORNERS = 400 };
	double at[CORNERS][2];
	struct eco_areas areas = { .items = NULL };
	struct wkb w = { .size = 0 };
	uint32_t differ = 0;
	for (uint32_t i = 0; i < CORNERS; i++)
		for (int k = 0; k < 2; k++)
			at[i][k] = (double)(eco_random(7, 2 * i + (uint32_t)k) >> 40) / 1000;
	put_head(&w, 3);
	put(&w, &(uint32_t){ 1 }, 4);
	put_path(&w, at, CORNERS);
	add(&areas, &w);
	assert_int_equal(eco_areas_index(&areas, 0, NULL), ECO_OK);
	for (uint32_t i = 0; i < 5000; i++) {
		double x = (double)(eco_random(8, i) >> 40) / 1000, y = (double)(eco_random(9, i) >> 40) / 1000;
		bool inside = false;
		for (uint32_t e = 0; e < CORNERS; e++) {
			const double *a = at[e], *b = at[(e + 1) % CORNERS];
			if ((a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
				inside = !inside;
		}
		differ += inside != eco_area_holds(&areas, 0, x, y);
	}
	assert_int_equal(differ, 0);
	for (uint32_t i = 0; i < 500; i++) {
		double low = (double)(eco_random(10, i) >> 40) / 1000,
			high = low + (double)(eco_random(11, i) >> 40) / 1e5, span[2], least = INFINITY,
			most = -INFINITY;

		for (uint32_t e = 0; e < CORNERS; e++) {
			const double *a = at[e], *b = at[(e + 1) % CORNERS];
			for (int k = 0; k <= 64; k++) {
				double x = a[0] + k / 64.0 * (b[0] - a[0]),
					y = a[1] + k / 64.0 * (b[1] - a[1]);
				least = y >= low && y <= high ? fmin(least, x) : least;
				most = y >= low && y <= high ? fmax(most, x) : most;
			}
		}
		assert_true(eco_area_span(&areas, 0, low, high, span) || least > most);
		assert_true(span[0] <= least && span[1] >= most);
	}
	eco_areas_free(&areas);
}

/* Edges across the whole height: with a band for every fourth of them each would be in thousands. */
UNIT_TEST(the_index_of_long_edges_stays_in_proportion)
{
	enum { LONG = 4000 };
	static double at[LONG][2];
	struct eco_areas areas = { .items = NULL };
	struct wkb line = { .size = 0 };
	for (uint32_t i = 0; i < LONG; i++)
		memcpy(at[i], (double[2]){ i, i % 2 * 1000.0 }, sizeof at[i]);
	put_head(&line, 2);
	put_path(&line, at, LONG);
	add(&areas, &line);
	assert_int_equal(eco_areas_index(&areas, 1, NULL), ECO_OK);
	assert_true(areas.near.first[areas.near.count] <= 10 * areas.edge_count);
	assert_true(eco_areas_near(&areas, 10.5, 500) && !eco_areas_near(&areas, 10.5, 1001.5));
	eco_areas_free(&areas);
}

static double square_to(const double a[2], const double b[2], double x, double y)
{
	double dx = b[0] - a[0], dy = b[1] - a[1], length = dx * dx + dy * dy,
		t = length > 0 ? ((x - a[0]) * dx + (y - a[1]) * dy) / length : 0;
	t = fmin(fmax(t, 0), 1);
	return (a[0] + t * dx - x) * (a[0] + t * dx - x) + (a[1] + t * dy - y) * (a[1] + t * dy - y);
}

UNIT_TEST(nearness_to_lines_and_points_agrees_with_every_edge)
{
	static const double reach[] = { 0.3, 4, 70 };
	for (size_t r = 0; r < sizeof reach / sizeof *reach; r++) {
		double at[60][2];
		struct eco_areas areas = { .items = NULL };
		struct wkb line = { .size = 0 }, point = { .size = 0 };
		uint32_t differ = 0, near = 0;
		for (uint32_t i = 0; i < 60; i++)
			for (int k = 0; k < 2; k++)
				at[i][k] = (double)(eco_random(3, 2 * i + (uint32_t)k) >> 44) / 1000 - 300;
		put_head(&line, 2);
		put_path(&line, at, 59);
		put_head(&point, 1);
		put(&point, at[59], sizeof at[59]);
		add(&areas, &line);
		add(&areas, &point);
		assert_int_equal(eco_areas_index(&areas, reach[r], NULL), ECO_OK);
		for (uint32_t i = 0; i < 4000; i++) {
			double x = (double)(eco_random(4, i) >> 44) / 1000 - 300,
				y = (double)(eco_random(5, i) >> 44) / 1000 - 300;
			double least = square_to(at[59], at[59], x, y);
			for (uint32_t e = 0; e < 58; e++)
				least = fmin(least, square_to(at[e], at[e + 1], x, y));
			differ += (least < reach[r] * reach[r]) != eco_areas_near(&areas, x, y);
			near += least < reach[r] * reach[r];
		}
		assert_int_equal(differ, 0);
		assert_true(near > 0 && near < 4000);
		assert_false(eco_areas_hold(&areas, at[59][0], at[59][1]));    /* no surface */
		eco_areas_free(&areas);
	}
}

UNIT_TEST(truncated_and_impossible_geometries_are_damaged)
{
	struct eco_areas areas = { .items = NULL };
	struct wkb w = { .size = 0 };
	bool kept = true;
	put_head(&w, 3);
	put(&w, &(uint32_t){ 1 }, 4);
	put_path(&w, square, 5);
	for (size_t size = 0; size < w.size; size++) {
		assert_int_equal(eco_areas_add_wkb(&areas, w.bytes, size, as_is, NULL, &kept, NULL),
			ECO_DAMAGED);
		assert_false(kept);
	}
	memcpy(w.bytes + 5, &(uint32_t){ 0xffffffff }, 4);           /* more rings than bytes */
	assert_int_equal(eco_areas_add_wkb(&areas, w.bytes, w.size, as_is, NULL, &kept, NULL), ECO_DAMAGED);
	w.size = 0;
	for (int i = 0; i < 100; i++) {                             /* collections in collections */
		put_head(&w, 7);
		put(&w, &(uint32_t){ 1 }, 4);
	}
	assert_int_equal(eco_areas_add_wkb(&areas, w.bytes, w.size, as_is, NULL, &kept, NULL), ECO_DAMAGED);
	assert_int_equal(areas.count, 0);
	assert_int_equal(areas.edge_count, 0);
	eco_areas_free(&areas);
}

/* The nearest two of n points, as a share of what the densest packing allows: random points come to nearly 0,
 * a hexagonal grid to 1. */
UNIT_TEST(every_beginning_of_the_set_is_spread_evenly)
{
	static uint16_t p[ECO_BLUE_NOISE_POINTS][2];
	eco_blue_noise(p);
	for (uint32_t n = ECO_BLUE_NOISE_POINTS; n >= 8; n = n * 5 / 7) {
		double least = INFINITY;
		for (uint32_t i = 0; i < n; i++)
			for (uint32_t j = 0; j < i; j++) {
				double x = (int16_t)(uint16_t)(p[i][0] - p[j][0]),
					y = (int16_t)(uint16_t)(p[i][1] - p[j][1]);
				least = fmin(least, x * x + y * y);
			}
		assert_true(sqrt(least) > 0.55 * 65536 * sqrt(2 / (sqrt(3.0) * n)));
	}
}
