/* Welding, and leaves as fans: each triangle exactly once, the same triangles as the source's. */
#include "lod/build/element.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

/* Made by the test under way, until finish. */
static struct soup soup;
static struct { struct lod_arena arena; struct lod_mesh mesh; struct lod_organs organs;
	struct lod_elements elements; } made;

static void make(uint32_t bits)
{
	memset(&made, 0, sizeof made);
	lod_weld(&made.mesh, &soup.model, bits, &made.arena);
	lod_elements_turn_diagonals(&made.mesh, &made.arena);
	lod_organs_find(&made.organs, &made.mesh, &soup.model, &made.arena);
	lod_elements_make(&made.elements, &made.mesh, &made.organs, &made.arena);
}

static void finish(void)
{
	lod_arena_free(&made.arena);
	soup_free(&soup);
}

/* Every drawable triangle that is not wood is in one element, with the same three vertices. */
static void check_elements(void)
{
	const struct lod_mesh *mesh = &made.mesh;
	FREED_MEMORY uint32_t *times = calloc(mesh->triangle_count + 1, sizeof *times);
	for (uint32_t i = 0; i < made.elements.count; i++) {
		const struct lod_element *e = &made.elements.items[i];
		assert_in_range(e->corners, 3, ECO_CORNERS_MAX);
		for (uint32_t k = 0; k + 2 < e->corners; k++) {
			uint32_t fan[3] = { e->vertex[0], e->vertex[k + 1], e->vertex[k + 2] };
			const uint32_t *source = mesh->index + 3 * (size_t)e->triangle[k];
			times[e->triangle[k]]++;
			for (int a = 0; a < 3; a++)
				assert_true(fan[a] == source[0] || fan[a] == source[1]
					|| fan[a] == source[2]);
			assert_true(fan[0] != fan[1] && fan[1] != fan[2] && fan[2] != fan[0]);
			assert_int_equal(mesh->component[e->triangle[k]], mesh->component[e->triangle[0]]);
		}
	}
	for (uint32_t t = 0; t < mesh->triangle_count; t++) {
		bool wood = made.organs.components[mesh->component[t]].organ == ECO_ORGAN_WOOD;
		assert_int_equal(times[t], !wood && !mesh->collapsed[t]);
	}
}

static void check_counts(void)
{
	uint32_t all = made.mesh.triangle_count - made.mesh.unstored;
	for (int d = 0; d < ECO_DROP_COUNT; d++)
		all += made.mesh.dropped[d];
	assert_int_equal(all, soup.model.triangle_count);
}

/* ---- Welding ---- */

/* Two quads side by side, without a common vertex, a hair apart. */
UNIT_TEST(equal_positions_become_one_vertex_and_materials_part_components)
{
	for (uint32_t materials = 1; materials <= 2; materials++) {
		soup_begin(&soup);
		soup_material(&soup, 0, 200, 0, ECO_NONE, false);
		soup_material(&soup, 90, 60, 0, ECO_NONE, false);
		for (uint32_t i = 0; i < 2; i++)
			soup_quad(&soup, i % materials, (struct lod_v3){ i + 1e-7 * i, 0, 0 },
				(struct lod_v3){ 1, 0, 0 }, (struct lod_v3){ 0, 1, 0 });
		make(14);
		assert_int_equal(made.mesh.vertex_count, 6);
		assert_int_equal(made.mesh.component_count, materials);
		assert_int_equal(made.elements.count, materials);
		check_counts();
		check_elements();
		finish();
	}
}

UNIT_TEST(useless_triangles_are_dropped_by_reason)
{
	soup_begin(&soup);
	uint32_t m = soup_material(&soup, 0, 200, 0, ECO_NONE, false),
		cut = soup_material(&soup, 255, 255, 255, soup_disc_image(&soup, 64), true);
	soup_quad(&soup, m, (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 4, 0, 0 },
		(struct lod_v3){ 0, 4, 0 });
	soup_triangle(&soup, m, 2, 1, 0);                                    /* the first one, turned over */
	soup_triangle(&soup, m, 0, 1, 1);
	soup_triangle(&soup, m, 0, 1, 99);
	uint32_t bad = soup_vertex(&soup, (struct lod_v3){ NAN, 0, 0 }, 0, 0);
	soup_triangle(&soup, m, 0, 1, bad);
	uint32_t tiny = soup_vertex(&soup, (struct lod_v3){ 1.00001, 1, 1 }, 0, 0);
	uint32_t near = soup_vertex(&soup, (struct lod_v3){ 1.00002, 1, 1 }, 0, 0),
		third = soup_vertex(&soup, (struct lod_v3){ 1, 1.00002, 1 }, 0, 0);
	/* larger than the welding tolerance, smaller than the grid */
	soup_triangle(&soup, m, tiny, near, third);
	uint32_t c[3];
	for (int i = 0; i < 3; i++)                                          /* in the image's empty corner */
		c[i] = soup_vertex(&soup, (struct lod_v3){ i, 2 + i * i, 1 }, i == 1 ? 0.1 : 0.03,
			i == 2 ? 0.1 : 0.03);
	soup_triangle(&soup, cut, c[0], c[1], c[2]);
	make(12);
	const uint32_t expected[ECO_DROP_COUNT] = { [ECO_DROP_BAD_INDEX] = 1, [ECO_DROP_NOT_FINITE] = 1,
		[ECO_DROP_DEGENERATE] = 1, [ECO_DROP_DUPLICATE] = 1, [ECO_DROP_TRANSPARENT] = 1,
		[ECO_DROP_QUANTIZED] = 1 };
	for (int d = 0; d < ECO_DROP_COUNT; d++)
		assert_int_equal(made.mesh.dropped[d], expected[d]);
	check_counts();
	check_elements();
	finish();
}

/* ---- Fans ---- */

/* A leaf of two quads, bent along the middle, with either diagonal in each. */
static void hexagonal_leaf(struct soup *s, uint32_t material, int first, int second, double bend)
{
	struct lod_v3 p[6] = { { 0, 0, 0 }, { 1, 0, 0 }, { 2, 0, bend }, { 2, 1, bend }, { 1, 1.2, 0 },
		{ 0, 1, 0 } };
	uint32_t v[6];
	for (int i = 0; i < 6; i++)
		v[i] = soup_vertex(s, p[i], 0, 0);
	soup_triangle(s, material, v[0], v[1], first ? v[4] : v[5]);
	soup_triangle(s, material, first ? v[0] : v[1], v[4], v[5]);
	soup_triangle(s, material, v[1], v[2], second ? v[3] : v[4]);
	soup_triangle(s, material, second ? v[1] : v[2], v[3], v[4]);
}

UNIT_TEST(a_leaf_of_two_quads_is_one_fan_whatever_its_diagonals)
{
	for (int which = 0; which < 4; which++) {
		soup_begin(&soup);
		hexagonal_leaf(&soup, soup_material(&soup, 0, 200, 0, ECO_NONE, false), which & 1, which >> 1,
			0.5);
		make(14);
		check_elements();
		assert_int_equal(made.elements.count, 1);
		assert_int_equal(made.elements.items[0].corners, 6);
		double area = 0;
		for (uint32_t t = 0; t < 4; t++)
			area += made.organs.area[t];
		assert_true(fabs(area - (1.1 + 1.1 * sqrt(1.25))) < 1e-6);
		finish();
	}
}

UNIT_TEST(quads_that_are_not_planar_keep_their_diagonal)
{
	soup_begin(&soup);
	hexagonal_leaf(&soup, soup_material(&soup, 0, 200, 0, ECO_NONE, false), 0, 0, 0);
	for (int i = 0; i < 6; i += 2)
		soup.model.position[3 * i + 2] += 0.2f * (float)(i + 1);
	make(14);
	check_elements();
	assert_int_equal(made.elements.count, 2);
	finish();
}

static void sheet(struct soup *s, uint32_t material, uint32_t n, bool seam)
{
	for (uint32_t y = 0; y <= n; y++)
		for (uint32_t x = 0; x <= n; x++)
			soup_vertex(s, (struct lod_v3){ x, y, 0.1 * sin(x) }, (double)x / n, (double)y / n);
	uint32_t copy = s->model.vertex_count;
	for (uint32_t y = 0; y <= n && seam; y++)            /* the right half has a texture of its own */
		for (uint32_t x = 0; x <= n; x++)
			soup_vertex(s, (struct lod_v3){ x, y, 0.1 * sin(x) }, (double)x / n + 0.4,
				(double)y / n);
	for (uint32_t y = 0; y < n; y++)
		for (uint32_t x = 0; x < n; x++) {
			uint32_t a = y * (n + 1) + x + (seam && x >= n / 2 ? copy : 0);
			soup_triangle(s, material, a, a + 1, a + n + 2);
			soup_triangle(s, material, a, a + n + 2, a + n + 1);
		}
}

UNIT_TEST(seams_of_the_texture_part_fans)
{
	soup_begin(&soup);
	sheet(&soup, soup_material(&soup, 255, 255, 255, soup_disc_image(&soup, 16), false), 10, true);
	make(14);
	check_elements();
	assert_int_equal(made.mesh.vertex_count, 121);
	for (uint32_t i = 0; i < made.elements.count; i++) {
		const struct lod_element *e = &made.elements.items[i];
		int32_t uv[2 * ECO_CORNERS_MAX];
		lod_element_uv(e, &made.mesh, uv);
		for (uint32_t k = 0; k + 2 < e->corners; k++)
			/* each fan triangle has its source's texture, but for whole turns */
			for (uint32_t c = 0; c < 3; c++) {
				uint32_t corner = c == 0 ? 0 : k + c, j = 0;
				while (made.mesh.index[3 * e->triangle[k] + j] != e->vertex[corner])
					j++;
				for (int a = 0; a < 2; a++) {
					assert_int_equal((uv[2 * corner + a]
						- made.mesh.uv[6 * e->triangle[k] + 2 * j + a]) % ECO_UV_ONE,
						0);
					assert_true(uv[2 * corner + a] >= 0);
				}
			}
	}
	finish();
}
