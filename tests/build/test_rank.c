/* Our order: what prefixes cover on views that it was not made from, and that nothing but the leaves and the
 * seed decides it. */
#include "ecofiles/format/list.h"
#include "lod/build/order/footprint.h"
#include "lod/build/order/rank_state.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

#define PIXELS 128u
#define VIEWS 6u

static struct lod_arena arena;
static struct eco_error error;

static void begin(void)
{
	lod_arena_free(&arena);
}

static struct lod_rank make(const struct lod_foliage *foliage, struct lod_rank_options options)
{
	struct lod_rank rank;
	options.views = options.views ? options.views : 12;
	options.pixels = options.pixels ? options.pixels : 128;
	assert_ok(lod_rank_make(&rank, foliage, &options, &arena, &error), error);
	return rank;
}

/* Q of a prefix on views that no order was made from, each element grown by its code, or all by `scale` where
 * `growth` is NULL. */
static double quality(const struct lod_foliage *foliage, const uint32_t *order, uint32_t count,
	const uint8_t *growth, float scale, const struct lod_simple *shape)
{
	struct lod_sights sights;
	struct lod_raster raster;
	double directions[VIEWS][3];
	uint64_t shown = 0, both = 0, wanted = 0;
	float *factor = lod_arena_take(&arena, foliage->count, sizeof *factor);
	for (uint32_t i = 0; i < foliage->count; i++)
		factor[i] = eco_growth(growth ? growth[i] : ECO_GROWTH_PLAIN, scale);
	lod_directions_spread(directions, VIEWS, 991);
	lod_sights_make(&sights, foliage, (const double (*)[3])directions, VIEWS, PIXELS, &arena);
	lod_raster_init(&raster,
		&(struct lod_raster_options){ .width = PIXELS, .height = PIXELS, .silhouette = true });
	for (uint32_t v = 0; v < VIEWS; v++) {
		uint64_t *mask = lod_arena_take(&arena, sights.words, sizeof *mask);
		lod_sights_draw(&sights, v,
			&(struct lod_sights_drawing){ .order = order, .count = count, .factor = factor,
			.shape = shape }, &raster, mask);
		for (uint32_t w = 0; w < sights.words; w++) {
			shown += (uint64_t)__builtin_popcountll(mask[w]);
			both += (uint64_t)__builtin_popcountll(mask[w] & sights.reference[v][w]);
		}
		wanted += sights.reference_pixels[v];
	}
	lod_raster_free(&raster);
	double p = 1 - (double)both / (double)shown, r = 1 - (double)both / (double)wanted;
	return 1 - sqrt(p * p + r * r);
}

static double best_quality(const struct lod_foliage *foliage, const uint32_t *order, uint32_t count,
	const uint8_t *growth)
{
	double best = -1;
	for (float part = 0.15f; part < 2.6f; part *= 1.35f)
		best = fmax(best,
			quality(foliage, order, count, growth,
			1 + ((float)foliage->count / (float)count - 1) * part, NULL));
	return best;
}

static void assert_permutation(const struct lod_foliage *foliage, const struct lod_rank *rank)
{
	bool *seen = lod_arena_take(&arena, foliage->count, sizeof *seen);
	for (uint32_t i = 0; i < foliage->count; i++) {
		assert_true(rank->order[i] < foliage->count);
		assert_false(seen[rank->order[i]]);
		seen[rank->order[i]] = true;
		assert_true(rank->growth[i] < ECO_GROWTHS);
	}
}

static void assert_shapes(const struct lod_foliage *foliage, const struct lod_rank *rank)
{
	for (uint32_t i = 0; i < foliage->count; i++) {
		assert_int_equal(rank->simple[i].corners, 3);
		for (uint32_t k = 0; k < rank->simple[i].corners; k++)
			for (int a = 0; a < 3; a++)
				assert_true(isfinite(rank->simple[i].corner[k][a]));
	}
}

/* One prefix may be unlucky by what the views happen to be; all from a third of the leaves on together are
 * better by far. */
UNIT_TEST(prefixes_beat_chance_on_other_views)
{
	static const struct foliage_random plants[] = { { 500, 6, 1, 0.12, 3 }, { 400, 4, 1, 0.12, 4 },
		{ 300, 3, 1, 0.16, 5 } };
	static const double share[] = { 0.02, 0.1, 0.3, 0.6, 0.9 };
	for (size_t p = 0; p < sizeof plants / sizeof *plants; p++) {
		struct lod_foliage f;
		double won = 0;
		begin();
		/* numbered at random: element i is as good as any */
		foliage_random(&f, &plants[p], &arena);
		struct lod_rank rank = make(&f, (struct lod_rank_options){ .seed = 1, .views = 24 });
		assert_permutation(&f, &rank);
		assert_shapes(&f, &rank);
		/* triangles for leaves of four keep most of the picture */
		assert_true(p > 0 || quality(&f, NULL, f.count, NULL, 1, rank.simple) > 0.8);
		for (size_t k = 0; k < sizeof share / sizeof *share; k++) {
			uint32_t count = (uint32_t)(share[k] * f.count);
			double ours = best_quality(&f, rank.order, count, rank.growth),
				chance = best_quality(&f, NULL, count, NULL);
			if (ours < chance - 0.03)
				fail_msg("plant %zu, %u leaves: Q %.3f, by chance %.3f", p, count, ours,
					chance);
			won += k < 2 ? 0 : (ours - chance) / 3;
		}
		if (won < 0.02)
			fail_msg("plant %zu: better than chance by %.3f", p, won);
	}
}

/* Leaves [0, n) of a sparse plant, [n, 2 n) just behind them, [2 n, 3 n) elsewhere and a third as large. */
static void stack_leaves(struct lod_foliage *f, uint32_t n)
{
	foliage_random(f, &(struct foliage_random){ 3 * n, 4, 1, 0.12, 12 }, &arena);
	for (uint32_t c = 0; c < f->first[n]; c++)
		for (int a = 0; a < 3; a++)
			f->corner[f->first[n] + c][a] = 0.999f * f->corner[c][a];
	for (uint32_t i = n; i < 2 * n; i++)
		f->center[i] = lod_v3_scale(f->center[i - n], 0.999);
	for (uint32_t i = 2 * n; i < 3 * n; i++) {
		f->area[i] *= 0.36;
		for (uint32_t c = f->first[i]; c < f->first[i + 1]; c++) {
			struct lod_v3 p = lod_v3_mix(f->center[i], lod_v3_of(f->corner[c]), 0.6);
			f->corner[c][0] = (float)p.x, f->corner[c][1] = (float)p.y;
			f->corner[c][2] = (float)p.z;
		}
	}
}

UNIT_TEST(a_second_layer_waits_for_smaller_leaves_elsewhere)
{
	enum { N = 60 };
	struct lod_foliage f;
	uint32_t place[3 * N], doubled = 0;
	begin();
	stack_leaves(&f, N);
	struct lod_rank rank = make(&f, (struct lod_rank_options){ .leaves = true, .views = 24 });
	for (uint32_t i = 0; i < 3 * N; i++)
		place[rank.order[i]] = i;
	for (uint32_t i = 0; i < N; i++)
		doubled += place[i] < 2 * N && place[N + i] < 2 * N;
	if (doubled > N / 10)
		fail_msg("%u of %u leaves are there twice, before smaller ones alone", doubled, N);
}

UNIT_TEST(leaves_of_a_sparse_plant_grow_no_further_than_they_are_worth)
{
	struct lod_foliage f;
	double sum = 0;
	begin();
	foliage_random(&f, &(struct foliage_random){ 150, 4, 1, 0.08, 13 }, &arena);
	struct lod_rank rank = make(&f, (struct lod_rank_options){ .leaves = true, .views = 24 });
	for (uint32_t i = 0; i < 30; i++)
		sum += eco_growth(rank.growth[rank.order[i]], 5) / 30;
	if (sum > 0.5 * eco_growth(ECO_GROWTH_PLAIN, 5))
		fail_msg("the first leaves grow %.2f times, where all alike grow 5", sum);
}

/* ---- The same whatever runs it ---- */

static void backwards(void *ctx, uint32_t count, void (*piece)(void *pieces, uint32_t i), void *pieces)
{
	while (count)
		piece(pieces, --count);
}

UNIT_TEST(threads_decide_nothing)
{
	struct lod_foliage f;
	begin();
	foliage_random(&f, &(struct foliage_random){ 700, 5, 1, 0.1, 9 }, &arena);
	struct lod_rank a = make(&f, (struct lod_rank_options){ .seed = 4 });
	struct lod_rank b = make(&f, (struct lod_rank_options){ .seed = 4, .each = backwards });
	struct lod_rank c = make(&f, (struct lod_rank_options){ .seed = 5 });
	assert_memory_equal(a.order, b.order, f.count * sizeof *a.order);
	assert_memory_equal(a.growth, b.growth, f.count);
	assert_true(memcmp(a.order, c.order, f.count * sizeof *a.order) != 0);
	for (uint32_t i = 0; i < f.count; i++)
		assert_memory_equal(a.simple[i].corner, b.simple[i].corner,
			a.simple[i].corners * sizeof a.simple[i].corner[0]);
}

/* ---- Odd plants ---- */

UNIT_TEST(odd_plants_are_ordered_too)
{
	static const struct foliage_random odd[] = { { 1, 4, 0, 0.1, 1 }, { 2, 3, 0, 0.1, 1 },
		{ 40, 6, 0, 0, 1 }, { 40, 5, 0, 0.2, 1 },
		{ 50, 4, 1e-6, 1e-7, 1 }, { 50, 4, 1e5, 1, 1 }, { 30, 6, 1, 1e-9, 1 }, { 5, 6, 0.01, 5, 1 } };
	for (size_t k = 0; k < sizeof odd / sizeof *odd; k++)
		for (uint32_t flat = 0; flat < 2; flat++) {
			struct lod_foliage f;
			begin();
			foliage_random(&f, &odd[k], &arena);
			for (uint32_t i = 0; i < f.first[f.count] && flat; i++)
				f.corner[i][2] = 0;
			struct lod_rank rank =
				make(&f, (struct lod_rank_options){ .views = 5, .pixels = 64 });
			assert_permutation(&f, &rank);
			assert_shapes(&f, &rank);
		}
}

/* ---- Simpler leaves ---- */

UNIT_TEST(a_triangle_for_a_cut_out_is_fitted_to_what_is_opaque)
{
	const float corner[5][3] = { { -1, -1, 0 }, { 1, -1, 0 }, { 1, 1, 0 }, { 0, 1, 0 }, { -1, 1, 0 } };
	const float uv[5][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0.5f, 1 }, { 0, 1 } };
	uint64_t opaque[16];
	struct lod_simple simple;
	for (uint32_t y = 0; y < 16; y++)
		opaque[y] = y >= 4 && y < 12 ? 0x0ff0 : 0;
	struct lod_mask mask = { 16, 16, 1, opaque };
	lod_simple_fit(&simple, &(struct lod_fan){ corner, uv, 5, &mask });
	assert_int_equal(simple.corners, 3);
	const float (*c)[3] = (const float (*)[3])simple.corner;
	float area =
		fabsf((c[1][0] - c[0][0]) * (c[2][1] - c[0][1]) - (c[2][0] - c[0][0]) * (c[1][1] - c[0][1]))
		/ 2;
	/* the opaque square in the middle has 1, the whole card 4 */
	assert_true(area > 0.7f && area < 1.2f);
	for (int a = 0; a < 2; a++)
		assert_true(fabsf(c[0][a] + c[1][a] + c[2][a]) < 0.6f);
}

static int end(void **state)
{
	lod_arena_free(&arena);
	return 0;
}

UNIT_MAIN(NULL, end)
