/* Splats of grass, turf and reeds: plants of many blades, each thinner than a pixel. */
#include "lod/build/splat/splat_fit.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

static const struct lod_splats_options quick = { .views = 20, .pixels = 160 };

struct field { uint32_t count; double height, spread, width, lean; };

/* Blades of three triangles around the foot of a disc; their upper halves bend down. */
static void make_blades(struct soup *soup, const struct field *field)
{
	soup_begin(soup);
	uint32_t material = soup_material(soup, 60, 100, 40, ECO_NONE, false);
	for (uint32_t i = 0; i < field->count; i++) {
		double turn = soup_random(soup, 0, 6.28), r = field->spread * sqrt(soup_random(soup, 0, 1)),
			high = field->height * soup_random(soup, 0.6, 1), lean = field->lean * high;
		struct lod_v3 foot = { r * cos(turn), r * sin(turn), 0 },
			out = { cos(3 * turn + i), sin(3 * turn + i), 0 }, side = { -out.y, out.x, 0 },
			up = { 0, 0, 0.6 * high };
		side = lod_v3_scale(side, field->width / 2);
		struct lod_v3 middle = lod_v3_add(lod_v3_add(foot, up), lod_v3_scale(out, 0.2 * lean)),
			tip = lod_v3_add(lod_v3_add(foot, lod_v3_scale(up, 1.5)), lod_v3_scale(out, lean));
		uint32_t v[5] = { soup_vertex(soup, lod_v3_sub(foot, side), 0, 0),
			soup_vertex(soup, lod_v3_add(foot, side), 1, 0),
			soup_vertex(soup, lod_v3_add(middle, side), 1, 0.5),
			soup_vertex(soup, lod_v3_sub(middle, side), 0, 0.5),
			soup_vertex(soup, tip, 0.5, 1) };
		soup_triangle(soup, material, v[0], v[1], v[2]);
		soup_triangle(soup, material, v[0], v[2], v[3]);
		soup_triangle(soup, material, v[3], v[2], v[4]);
	}
}

static void fit(struct lod_splats *splats, const struct eco_model *model,
	const struct lod_splats_options *options)
{
	struct eco_error error = { 0 };
	assert_ok(lod_splats_fit(splats, model, options, &error), error);
}

static uint32_t size_of(const struct lod_splats *splats, uint32_t level)
{
	return splats->level_end[level] - lod_splats_first(splats, level);
}

static void check_sizes(const struct lod_splats *splats)
{
	assert_in_range(splats->level_count, 3, LOD_SPLAT_LEVELS);
	assert_int_equal(splats->level_end[0], 1);
	for (uint32_t level = 1; level < splats->level_count; level++) {
		uint32_t size = size_of(splats, level), before = size_of(splats, level - 1);
		assert_int_equal(size % before, 0);
		assert_in_range(size / before, 2, 4);
	}
}

/* The share of a level's splats that are four times as long as wide. */
static double long_share(const struct lod_splats *splats, uint32_t level)
{
	uint32_t first = lod_splats_first(splats, level), count = 0;
	for (uint32_t i = first; i < splats->level_end[level]; i++) {
		double most = 0, second = 0;
		for (int k = 0; k < 3; k++) {
			const float *half = splats->items[i].shape.half[k];
			double length = sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]);
			second = length > most ? most : length > second ? length : second;
			most = length > most ? length : most;
		}
		count += most > 4 * second;
	}
	return (double)count / (splats->level_end[level] - first);
}

UNIT_TEST(a_level_has_a_splat_for_each_blade)
{
	static const struct field fields[] = { { 48, 1.5, 0.3, 0.02, 0.2 }, { 100, 0.5, 0.4, 0.015, 0.6 },
		{ 250, 0.3, 0.8, 0.01, 0.4 } };
	for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
		struct soup soup;
		struct lod_splats splats;
		make_blades(&soup, &fields[i]);
		fit(&splats, &soup.model, &quick);
		check_sizes(&splats);
		uint32_t level = 0;
		while (level + 1 < splats.level_count && size_of(&splats, level) < fields[i].count)
			level++;
		assert_in_range(size_of(&splats, level), fields[i].count, 2 * fields[i].count - 1);
		assert_int_equal(size_of(&splats, level), 2 * size_of(&splats, level - 1));
		assert_true(long_share(&splats, level) > 0.8);
		assert_true(splats.loss[level] < 0.95 * splats.loss[level - 2]);
		lod_splats_free(&splats);
		soup_free(&soup);
	}
}

/* A sample or two is all that shows of such blades. */
UNIT_TEST(blades_that_hardly_show_are_a_plant)
{
	struct soup soup;
	struct lod_splats splats;
	make_blades(&soup, &(struct field){ 300, 0.5, 20, 0.002, 0.4 });
	fit(&splats, &soup.model, &(struct lod_splats_options){ .views = 4, .pixels = 16 });
	for (uint32_t i = 0; splats.level_count && i < splats.level_end[splats.level_count - 1]; i++)
		assert_true(eco_splat_good(splats.items[i].code));
	lod_splats_free(&splats);
	soup_free(&soup);
}
