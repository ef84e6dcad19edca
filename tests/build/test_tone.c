/* Beginnings of orders look like all that is seen; colours stay a plant's own where they are few. */
#include "ecofiles/base/random.h"
#include "lod/light.h"
#include "lod/build/tone.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

#define MOST 4096u

static uint8_t rgb[MOST][3];
static double area[MOST];
static uint32_t seen[MOST];

static void mean_of(uint32_t first, uint32_t end, bool by_seen, double light[3])
{
	struct lod_light sum = { { 0, 0, 0 }, 0 };
	for (uint32_t i = first; i < end; i++)
		lod_light_add(&sum, rgb[i], by_seen ? seen[i] : area[i]);
	for (int k = 0; k < 3; k++)
		light[k] = sum.sum[k] / sum.weight;
}

/* Dark and hidden ones first. colors: how many there are. */
static void dark_first(uint32_t count, uint32_t colors)
{
	for (uint32_t i = 0; i < count; i++) {
		uint32_t random = (uint32_t)(eco_random(7, i) % count), step = (i + random) / 2 * colors / count;
		for (uint32_t k = 0; k < 3; k++)
			rgb[i][k] = (uint8_t)(60 + 20 * k + 110 * step / colors);
		area[i] = 0.5 + (double)(eco_random(8, i) % 100) / 100;
		seen[i] = (uint32_t)(eco_random(9, i) % (1 + 10 * i / count));
	}
}

UNIT_TEST(beginnings_have_the_tone_of_what_is_seen)
{
	static const struct { uint32_t count, colors; double within; } cases[] =
		{ { 4096, 7, 0.06 }, { 4096, 32, 0.06 }, { 4096, 110, 0.06 },
		{ 700, 5, 0.08 }, { 64, 4, 0.1 }, { 64, 60, 0.1 } };
	for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
		double whole[3], part[3];
		dark_first(cases[c].count, cases[c].colors);
		mean_of(0, cases[c].count, true, whole);
		mean_of(0, 16, false, part);
		assert_true(part[1] < 0.8 * whole[1]);
		lod_tone_level(rgb, area, seen, cases[c].count);
		for (uint32_t end = 32; end < cases[c].count; end *= 2) {
			mean_of(0, end, false, part);
			for (int k = 0; k < 3; k++)
				assert_true(fabs(part[k] / whole[k] - 1) < cases[c].within);
		}
		mean_of(0, cases[c].count, true, part);
		for (int k = 0; k < 3; k++)
			assert_true(fabs(part[k] / whole[k] - 1) < 0.02);
	}
}

UNIT_TEST(one_colour_and_nothing_seen_change_nothing)
{
	uint8_t before[MOST][3];
	for (int unseen = 0; unseen < 2; unseen++) {
		dark_first(MOST, unseen ? 60 : 1);
		memcpy(before, rgb, sizeof before);
		for (uint32_t i = 0; unseen && i < MOST; i++)
			seen[i] = 0;
		lod_tone_level(rgb, area, seen, MOST);
		assert_memory_equal(before, rgb, sizeof before);
	}
	lod_tone_level(rgb, area, seen, 0);
}

UNIT_TEST(a_leaf_in_a_box_is_not_seen)
{
	FREED(soup) soup;
	FREED(lod_arena) arena = { 0 };
	struct lod_mesh mesh;
	struct lod_organs organs;
	struct lod_elements elements;
	uint32_t pixels[16];
	soup_begin(&soup);
	uint32_t m = soup_material(&soup, 0, 200, 0, ECO_NONE, false);
	soup_quad(&soup, m, (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 0.2, 0, 0 },
		(struct lod_v3){ 0, 0.2, 0 });
	/* larger than the box, so that no two of them are one component */
	for (int side = -1; side < 2; side += 2) {
		soup_quad(&soup, m, (struct lod_v3){ 0, 0, 0.5 * side }, (struct lod_v3){ 1.1, 0, 0 },
			(struct lod_v3){ 0, 1.1, 0 });
		soup_quad(&soup, m, (struct lod_v3){ 0, 0.5 * side, 0 }, (struct lod_v3){ 1.1, 0, 0 },
			(struct lod_v3){ 0, 0, 1.1 });
		soup_quad(&soup, m, (struct lod_v3){ 0.5 * side, 0, 0 }, (struct lod_v3){ 0, 1.1, 0 },
			(struct lod_v3){ 0, 0, 1.1 });
	}
	lod_weld(&mesh, &soup.model, 14, &arena);
	lod_organs_find(&organs, &mesh, &soup.model, &arena);
	lod_elements_make(&elements, &mesh, &organs, &arena);
	assert_in_range(elements.count, 2, 16);
	lod_tone_seen(pixels, &(struct lod_tone_input){ &mesh, &elements }, &arena);
	uint32_t hidden = 0, all = 0;
	for (uint32_t i = 0; i < elements.count; i++) {
		struct lod_v3 center = lod_element_center(&elements.items[i], &mesh);
		bool inside = fabs(center.x) < 0.2 && fabs(center.y) < 0.2
			&& fabs(center.z - 0.5 * (mesh.high[2] + mesh.low[2])) < 0.2;
		hidden += inside;
		all += pixels[i];
		if (inside)
			assert_int_equal(pixels[i], 0);
	}
	assert_int_equal(hidden, 1);
	assert_true(all > 1000);
}
