/* Lines of wood: along the axes, as wide as the area asks. */
#include "lod/build/bone.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

static struct lod_arena arena;
/* Made by the test under way, until finish. */
static struct soup soup;
static struct { struct lod_mesh mesh; struct lod_organs organs; struct lod_bones bones; double area, length,
	error, surface; } made;

static void make(bool stout)
{
	memset(&made, 0, sizeof made);
	lod_weld(&made.mesh, &soup.model, 16, &arena);
	lod_organs_find(&made.organs, &made.mesh, &soup.model, &arena);
	for (uint32_t c = 0; c < made.mesh.component_count; c++) {  /* what is a tube is decided elsewhere */
		made.organs.components[c].organ = ECO_ORGAN_WOOD;
		made.organs.components[c].stout |= stout;
		made.surface += made.organs.components[c].area;
	}
	lod_bones_make(&made.bones, &made.mesh, &made.organs, &arena);
	for (uint32_t i = 0; i < made.bones.count; i++) {
		const struct lod_bone *b = &made.bones.items[i];
		double length = lod_v3_distance(b->end[0], b->end[1]);
		assert_true(b->width >= 0 && isfinite(b->width) && isfinite(b->error) && b->error >= 0
			&& isfinite(length));
		made.length += length;
		made.area += length * b->width;
		made.error = fmax(made.error, b->error);
	}
}

static void finish(void)
{
	lod_arena_free(&arena);
	soup_free(&soup);
}

UNIT_TEST(a_straight_tube_is_one_line)
{
	static const struct { uint32_t sides, rings; } shapes[] = { { 3, 1 }, { 4, 2 }, { 6, 40 }, { 12, 7 },
		{ 16, 200 } };
	for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
		soup_begin(&soup);
		soup_tube(&soup, soup_material(&soup, 90, 60, 30, ECO_NONE, false),
			(struct lod_v3){ 1, 2, 0 }, (struct lod_v3){ 2, 1, 5 }, 0.1, 0.1, shapes[i].sides,
			shapes[i].rings);
		make(false);
		assert_int_equal(made.bones.count, 1);
		assert_true(fabs(made.length - sqrt(27)) < 0.05);
		assert_true(fabs(made.area * LOD_PI / made.surface - 1) < 0.02);
		assert_true(made.error < 0.06);
		finish();
	}
}

UNIT_TEST(a_stout_stem_that_leans_is_a_line_that_leans)
{
	static const struct { struct lod_v3 foot, top; uint32_t sides; } stems[] = {
		{ { 0, 0, 0 }, { 0, 0, 2 }, 4 }, { { 1, 1, 0 }, { 1.6, 0.7, 2 }, 8 },
			{ { 0, 0, 0 }, { 3, 2, 1 }, 12 },
	};
	for (size_t i = 0; i < sizeof stems / sizeof *stems; i++) {
		soup_begin(&soup);
		soup_tube(&soup, soup_material(&soup, 90, 60, 30, ECO_NONE, false), stems[i].foot,
			stems[i].top, 0.4, 0.4, stems[i].sides, 3);
		make(true);
		assert_int_equal(made.bones.count, 1);
		const struct lod_bone *line = made.bones.items;
		struct lod_v3 along = lod_v3_unit(lod_v3_sub(line->end[1], line->end[0]));
		assert_true(lod_v3_dot(along, lod_v3_unit(lod_v3_sub(stems[i].top, stems[i].foot))) > 0.995);
		assert_true(line->width > 0.6 && line->width < 0.85);
		finish();
	}
}

/* A fork whose arms share the trunk's end ring vertices: one component. */
UNIT_TEST(a_fork_has_a_line_for_each_arm)
{
	soup_begin(&soup);
	uint32_t m = soup_material(&soup, 90, 60, 30, ECO_NONE, false);
	soup_tube(&soup, m, (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 0, 0, 3 }, 0.1, 0.1, 8, 12);
	uint32_t ring = soup.model.vertex_count - 8;
	for (int arm = 0; arm < 2; arm++) {
		uint32_t first = soup.model.vertex_count;
		soup_tube(&soup, m, (struct lod_v3){ 0, 0, 3 }, (struct lod_v3){ arm ? 2 : -2, 0, 5 }, 0.05,
			0.05, 8, 12);
		for (int k = 0; k < 8; k++)
			soup_triangle(&soup, m, first + (uint32_t)k, first + ((uint32_t)k + 1) % 8,
				ring + (uint32_t)k);
	}
	make(false);
	assert_int_equal(made.mesh.component_count, 1);
	bool left = false, right = false;
	for (uint32_t i = 0; i < made.bones.count; i++)
		for (int e = 0; e < 2; e++) {
			struct lod_v3 p = made.bones.items[i].end[e];
			left = left || lod_v3_distance(p, (struct lod_v3){ -2, 0, 5 }) < 0.1;
			right = right || lod_v3_distance(p, (struct lod_v3){ 2, 0, 5 }) < 0.1;
		}
	assert_true(left && right);
	assert_in_range(made.bones.count, 3, 12);
	assert_true(made.length > 0.9 * (3 + 2 * sqrt(8)) && made.length < 1.2 * (3 + 2 * sqrt(8)));
	assert_true(fabs(made.area * LOD_PI / made.surface - 1) < 0.15);
	finish();
}

/* Bark that is dark below and bright above: each line has the colour of where it runs, not the tree's mean.
 */
UNIT_TEST(lines_have_the_colour_of_the_bark_that_they_replace)
{
	soup_begin(&soup);
	soup.image[0] = (struct eco_image){ 1, 8, calloc(8, 4) };
	soup.model.image_count = 1;
	for (int y = 0; y < 8; y++)
		memcpy(soup.image[0].rgba + 4 * y,
			(uint8_t[4]){ y < 4 ? 40 : 200, y < 4 ? 30 : 190, 20, 255 }, 4);
	soup_tube(&soup, soup_material(&soup, 255, 255, 255, 0, false), (struct lod_v3){ 0, 0, 0 },
		(struct lod_v3){ 0, 0, 8 }, 0.2, 0.01, 8, 60);
	for (uint32_t v = 0; v < soup.model.vertex_count; v++)
		soup.model.uv[2 * v + 1] = soup.model.position[3 * v + 2] / 8;
	make(false);
	uint32_t dark = 0, bright = 0;
	for (uint32_t i = 0; i < made.bones.count; i++) {
		const struct lod_bone *b = &made.bones.items[i];
		double low = fmin(b->end[0].z, b->end[1].z), high = fmax(b->end[0].z, b->end[1].z);
		if (high < 3.9) {
			assert_in_range(b->rgb[0], 38, 42);
			dark++;
		} else if (low > 4.1) {
			assert_in_range(b->rgb[0], 198, 202);
			bright++;
		}
	}
	assert_true(dark > 0 && bright > 0);
	finish();
}

UNIT_TEST(any_soup_has_finite_lines)
{
	for (uint32_t seed = 1; seed <= 60; seed++) {
		soup_begin(&soup);
		soup.state = seed;
		uint32_t m = soup_material(&soup, 90, 60, 30, ECO_NONE, false), n = 4 + seed / 2;
		for (uint32_t v = 0; v < n; v++)
			soup_vertex(&soup,
				(struct lod_v3){ soup_random(&soup, 0, 1), soup_random(&soup, 0, 1),
				seed % 3 ? soup_random(&soup, 0, 2) : 0 }, 0, 0);
		for (uint32_t t = 0; t < 3 * n; t++)
			soup_triangle(&soup, m, (uint32_t)soup_random(&soup, 0, n),
				(uint32_t)soup_random(&soup, 0, n), (uint32_t)soup_random(&soup, 0, n));
		make(false);
		finish();
	}
}
