/* Orders of leaves that are not scaled: prefixes cover as much as can be, over the wood, in the views that
 * they are for. */
#include <string.h>

#include "lod/build/order/cover.h"
#include "tests/support/cone_views.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

#define MOST 400u
#define VIEWS 12u
#define PIXELS 64u
#define WORDS ((PIXELS + 63) / 64 * PIXELS)

static struct lod_arena arena;
static struct soup dice;
static uint32_t first[MOST + 1], order[MOST], again[MOST];
static float corner[3 * MOST][3], uv[3 * MOST][2], wood[18];
static const struct eco_image *cutout[MOST];
static double around[VIEWS][3];

static void leaf(struct lod_foliage *f, struct lod_v3 at, struct lod_v3 u, struct lod_v3 v)
{
	const struct lod_v3 corners[3] = { lod_v3_add(at, u), lod_v3_add(at, v),
		lod_v3_add(at, lod_v3_scale(lod_v3_add(u, v), -1)) };
	for (int k = 0; k < 3; k++) {
		const float p[3] = { (float)corners[k].x, (float)corners[k].y, (float)corners[k].z };
		memcpy(corner[3 * f->count + k], p, sizeof p);
		uv[3 * f->count + k][0] = k == 0 ? 0.1f : 0.9f;
		uv[3 * f->count + k][1] = k == 1 ? 0.1f : 0.9f;
	}
	cutout[f->count] = NULL;
	f->count++;
	first[f->count] = 3 * f->count;
}

static struct lod_foliage empty(void)
{
	first[0] = 0;
	return (struct lod_foliage){ .first = first, .corner = corner, .uv = uv, .cutout = cutout,
		.wood = wood, .low = { -5, -5, -5 },
		.high = { 5, 5, 5 } };
}

/* Leaves of many sizes all over a ball. */
static struct lod_foliage ball(uint32_t count, uint32_t seed)
{
	struct lod_foliage f = empty();
	dice.state = seed;
	while (f.count < count) {
		struct lod_v3 at = lod_v3_scale(soup_direction(&dice), soup_random(&dice, 0, 4)),
			u = soup_direction(&dice);
		double size = soup_random(&dice, 0.3, 1.5);
		leaf(&f, at, lod_v3_scale(u, size),
			lod_v3_scale(lod_v3_cross(u, soup_direction(&dice)), size));
	}
	return f;
}

static enum eco_code make(uint32_t *out, const struct lod_foliage *f, const double (*directions)[3],
	struct eco_error *error)
{
	enum eco_code code;
	assert_int_equal(setjmp(arena.failed), 0);
	code = lod_cover_order(out, f, &(struct lod_cover_options){ .directions = directions, .views = VIEWS,
		.pixels = PIXELS }, &arena, error);
	assert_null(arena.last);
	return code;
}

static void order_of(uint32_t *out, const struct lod_foliage *f, const double (*directions)[3])
{
	struct eco_error error = { 0 };
	bool seen[MOST] = { false };
	assert_int_equal(make(out, f, directions, &error), ECO_OK);
	for (uint32_t i = 0; i < f->count; i++) {
		assert_true(out[i] < f->count && !seen[out[i]]);
		seen[out[i]] = true;
	}
}

/* Pixels beyond the wood that the first of a list cover, in all views. */
struct measure { struct lod_sights sights; struct lod_raster raster; };

static void measure_open(struct measure *m, const struct lod_foliage *f, const double (*directions)[3])
{
	struct eco_error error = { 0 };
	assert_int_equal(setjmp(arena.failed), 0);
	assert_int_equal(lod_sights_make(&m->sights, f, directions, VIEWS, PIXELS, &arena, &error), ECO_OK);
	assert_int_equal(lod_raster_init(&m->raster,
		&(struct lod_raster_options){ .width = PIXELS, .height = PIXELS, .silhouette = true },
		&error), ECO_OK);
}

static void measure_close(struct measure *m)
{
	lod_raster_free(&m->raster);
	lod_arena_free(&arena);
}

static uint32_t covered(struct measure *m, const uint32_t *list, uint32_t count)
{
	uint32_t sum = 0;
	for (uint32_t view = 0; view < VIEWS; view++) {
		uint64_t mask[WORDS] = { 0 };
		lod_sights_draw(&m->sights, view,
			&(struct lod_sights_drawing){ .order = list, .count = count, .scale = 1 }, &m->raster,
			mask);
		for (uint32_t i = 0; i < WORDS; i++)
			sum += (uint32_t)__builtin_popcountll(mask[i] & ~m->sights.wood[view][i]);
	}
	return sum;
}

/* ---- Tests ---- */

UNIT_TEST(the_first_leaves_cover_most)
{
	struct measure m;
	struct lod_foliage f = ball(MOST, 5);
	order_of(order, &f, around);
	measure_open(&m, &f, around);
	uint32_t last = 0, all = covered(&m, order, MOST), gained = all;
	for (uint32_t count = MOST / 8; count <= MOST; count += MOST / 8) {
		uint32_t now = covered(&m, order, count);
		assert_true(now >= last && now - last <= gained + all / 100);
		gained = now - last;
		last = now;
		for (uint32_t i = 0; i < MOST; i++)
			again[i] = i;
		assert_true(count == MOST || now > covered(&m, again, count));
	}
	assert_true(covered(&m, order, MOST / 2) > all * 97 / 100);
	measure_close(&m);
}

/* Nemhauser, Wolsey, Fisher 1978. */
UNIT_TEST(no_prefix_covers_less_than_63_percent_of_the_best)
{
	enum { LEAVES = 9 };
	for (uint32_t seed = 1; seed <= 4; seed++) {
		struct measure m;
		struct lod_foliage f = ball(LEAVES, 100 + seed);
		uint32_t best[LEAVES + 1] = { 0 };
		order_of(order, &f, around);
		measure_open(&m, &f, around);
		for (uint32_t set = 0; set < 1u << LEAVES; set++) {
			uint32_t count = 0;
			for (uint32_t i = 0; i < LEAVES; i++)
				if (set >> i & 1)
					again[count++] = i;
			uint32_t pixels = covered(&m, again, count);
			best[count] = pixels > best[count] ? pixels : best[count];
		}
		for (uint32_t count = 1; count <= LEAVES; count++)
			assert_true(covered(&m, order, count) >= 0.63 * best[count]);
		measure_close(&m);
	}
}

/* A list for a cone covers more in other views of the cone than the list for all views. */
UNIT_TEST(lists_for_a_sector_serve_the_sector)
{
	double cone[VIEWS][3], others[VIEWS][3];
	const double axis[3] = { 0.9, 0.3, 0.3 };
	struct measure m;
	struct lod_foliage f = ball(MOST, 8);
	cone_views(cone, VIEWS, axis, 0.2, 1);
	cone_views(others, VIEWS, axis, 0.2, 2);
	order_of(order, &f, around);
	order_of(again, &f, (const double (*)[3])cone);
	measure_open(&m, &f, (const double (*)[3])others);
	uint32_t all = covered(&m, order, MOST);
	for (uint32_t percent = 10; percent <= 50; percent += 20)
		assert_true(all - covered(&m, again, MOST * percent / 100)
			< (all - covered(&m, order, MOST * percent / 100)) * 0.9);
	measure_close(&m);
}

/* Leaves that stand in front of a board or show nothing of their picture are worth nothing. */
UNIT_TEST(leaves_that_change_nothing_come_last)
{
	static const uint8_t clear[4 * 4] = { 0 };
	const struct eco_image image = { .width = 2, .height = 2, .rgba = (uint8_t *)(uintptr_t)clear };
	static const float board[18] = { 0, -4, -4, 0, 4, -4, 0, 4, 4, 0, -4, -4, 0, 4, 4, 0, -4, 4 };
	double from_x[VIEWS][3];
	struct lod_foliage f = empty();
	memcpy(wood, board, sizeof board);
	f.wood_count = 2;
	for (uint32_t i = 0; i < 12; i++) {
		bool beside = i % 3 == 0;
		leaf(&f, (struct lod_v3){ 0.1, 0.2 * i - 1, beside ? 5 : 0.1 * i },
			(struct lod_v3){ 0, 0.5, 0 }, (struct lod_v3){ 0, 0, 0.5 });
		cutout[i] = i % 6 == 3 ? &image : NULL;
	}
	cone_views(from_x, VIEWS, (const double[3]){ 1, 0, 0 }, 0.02, 1);
	order_of(order, &f, (const double (*)[3])from_x);
	assert_true(order[0] % 6 == 0 && order[1] % 6 == 0);
	for (uint32_t i = 2; i < 12; i++)
		assert_true(order[i] % 6 != 0);
}

UNIT_TEST(orders_are_repeatable)
{
	struct lod_foliage f = ball(200, 3);
	order_of(order, &f, around);
	order_of(again, &f, around);
	assert_memory_equal(order, again, 200 * sizeof *order);
}

static bool stop(void *ctx, double share)
{
	assert_true(share >= 0 && share <= 1);
	++*(int *)ctx;
	return false;
}

UNIT_TEST(it_stops_when_asked)
{
	int calls = 0;
	struct eco_error error = { 0 };
	struct lod_foliage f = ball(200, 3);
	assert_int_equal(setjmp(arena.failed), 0);
	assert_int_equal(lod_cover_order(order, &f,
		&(struct lod_cover_options){ .directions = around, .views = VIEWS, .pixels = PIXELS,
		.progress = stop, .ctx = &calls }, &arena, &error), ECO_INTERRUPTED);
	assert_int_equal(calls, 1);
	assert_null(arena.last);
}

UNIT_TEST(odd_leaves_are_ordered_too)
{
	const struct lod_v3 zero = { 0, 0, 0 };
	struct lod_foliage f = empty();
	f.wood_count = 0;
	for (uint32_t i = 0; i < 5; i++)
		leaf(&f, zero, zero, zero);                      /* points */
	leaf(&f, zero, (struct lod_v3){ 90, 0, 0 }, (struct lod_v3){ 0, 1e-7, 0 });
	leaf(&f, zero, (struct lod_v3){ 1, 0, 0 }, (struct lod_v3){ 0, 1, 0 });
	order_of(order, &f, around);
	f.count = 1;
	order_of(order, &f, around);
}

int main(void)
{
	lod_directions_spread(around, VIEWS, 1);
	return unit_tests_run(NULL, NULL);
}
