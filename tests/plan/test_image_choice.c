/* The part of the ground's image that a plan shows: leaves of its tree, fewer bytes at a higher price. */
#include <math.h>

#include "ecofiles/format/ground_tile.h"
#include "lod/plan/image_choice.h"
#include "tests/support/scene_random.h"
#include "tests/support/unit_test.h"

#define SEEDS 40u

struct looked {
	struct random_pack *pack;
	struct eco_view view;
	struct lod_eye eye;
	struct lod_image image;
};

static const struct eco_scene *look(struct looked *l, uint64_t seed, double texel_px)
{
	l->pack = random_pack_make(seed, 1, 3);
	l->view = random_view(&l->pack->r);
	lod_eye_make(&l->eye, &l->view);
	assert_good(lod_image_see(&l->image, &l->pack->pack.scene, &l->eye, &l->view, texel_px, &cause));
	return &l->pack->pack.scene;
}

static void look_away(struct looked *l)
{
	lod_image_free(&l->image);
	random_pack_free(l->pack);
}

static bool overlap(const struct eco_list *a, const struct eco_list *b)
{
	bool apart = false;
	for (int k = 0; k < 2; k++)
		apart |= a->grid_origin[k] + eco_ground_image_side_m(a) <= b->grid_origin[k]
			|| b->grid_origin[k] + eco_ground_image_side_m(b) <= a->grid_origin[k];
	return !apart;
}

/* Sum of the cuts' payloads that are not held, and of what stands beside them. */
static uint64_t payloads(const struct eco_scene *s, const struct eco_cut *cuts, uint32_t count)
{
	uint64_t sum = 0;
	for (uint32_t i = 0; i < count; i++)
		for (uint32_t c = 0; c < cuts[i].end; c++)
			sum += s->chunks[s->lists[cuts[i].list].chunk_first + c].size_bytes;
	return sum;
}

UNIT_TEST(tiles_do_not_overlap_and_a_higher_price_never_sends_more)
{
	uint32_t several = 0, fell = 0;
	for (uint64_t seed = 1; seed <= SEEDS; seed++) {
		struct looked l;
		const struct eco_scene *s = look(&l, seed, 0.25);
		struct eco_cut cuts[9];
		double before = INFINITY;
		for (double price = 0; price < 1e8; price = price > 0 ? 1.7 * price : 1e-6) {
			double bytes = lod_image_bytes(&l.image, s, NULL, price);
			uint32_t count = lod_image_cuts(&l.image, s, NULL, price, cuts);
			assert_true(count <= l.image.count && count <= 9);
			for (uint32_t i = 0; i < count; i++) {
				assert_int_equal(s->lists[cuts[i].list].kind, ECO_LIST_GROUND_IMAGE);
				assert_true(cuts[i].end >= 1 && cuts[i].end <= ECO_GROUND_IMAGE_LEVELS);
				for (uint32_t k = 0; k < i; k++)
					assert_false(overlap(&s->lists[cuts[i].list], &s->lists[cuts[k].list]));
			}
			assert_true(bytes <= before && bytes >= (double)payloads(s, cuts, count));
			several += count > 1;
			fell += bytes < before && isfinite(before);
			before = bytes;
		}
		assert_true(before == 0);
		look_away(&l);
	}
	assert_true(several > SEEDS && fell > 2 * SEEDS);
}

/* If bytes do not count, all that is in view comes in all detail: no tile stands for its quarters. */
UNIT_TEST(without_a_price_all_detail_is_shown)
{
	uint32_t whole = 0, coarse = 0;
	for (uint64_t seed = 1; seed <= 5 * SEEDS; seed++) {
		struct looked l;
		const struct eco_scene *s = look(&l, 500 + seed, 1e-6);
		struct eco_cut cuts[9];
		uint32_t count = lod_image_cuts(&l.image, s, NULL, 0, cuts);
		for (uint32_t i = 0; i < count; i++)
			for (uint32_t t = 0; t < s->ground_image_count; t++)
				if (s->ground_images[t].list == cuts[i].list)
					*(s->ground_images[t].child_first ? &coarse : &whole) += 1;
		look_away(&l);
	}
	print_message("%u tiles in all detail, %u in less\n", whole, coarse);
	assert_true(whole > 5 * SEEDS && 20 * coarse < whole);
}

UNIT_TEST(all_that_is_held_costs_nothing_and_no_bytes_are_worth_any_price)
{
	for (uint64_t seed = 1; seed <= SEEDS; seed++) {
		struct looked l;
		const struct eco_scene *s = look(&l, 300 + seed, 0.25);
		struct eco_cut cuts[9], again[9];
		struct eco_holding held[9];
		uint32_t count = lod_image_cuts(&l.image, s, NULL, 0, cuts);
		double most = lod_image_bytes(&l.image, s, NULL, 0);
		for (uint32_t i = 0; i < count; i++)
			held[i] = (struct eco_holding){ cuts[i].list, cuts[i].end };
		const struct eco_holdings holdings = { held, count };
		assert_true(lod_image_bytes(&l.image, s, &holdings, 1e-3) == 0);
		assert_int_equal(lod_image_cuts(&l.image, s, &holdings, 1e-3, again), count);
		for (uint32_t i = 0; i < count; i++)
			assert_true(again[i].list == cuts[i].list && again[i].end == cuts[i].end);
		for (int octave = -20; octave <= 20; octave++) {
			const double bytes = lod_image_bytes(&l.image, s, NULL, ldexp(1, octave));
			assert_true(bytes <= most);
			most = bytes;
		}
		assert_true(most == 0);
		look_away(&l);
	}
}
