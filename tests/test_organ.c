/* Wood, foliage and flowers by shape and colour. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "lod/organ.h"
#include "tests/plant_models.h"

static struct lod_arena arena;

struct found { struct lod_mesh mesh; struct lod_organs organs; };

static void find(struct found *found, const struct soup *soup)
{
	assert_int_equal(setjmp(arena.failed), 0);
	lod_weld(&found->mesh, &soup->model, 14, &arena);
	lod_organs_find(&found->organs, &found->mesh, &soup->model, &arena);
}

/* Organ of the only component of `material`, or of all of them if they agree. */
static int organ_of(const struct found *found, uint32_t material)
{
	int organ = -1;
	for (uint32_t c = 0; c < found->mesh.component_count; c++)
		if (found->organs.components[c].material == material) {
			assert_true(organ < 0 || organ == found->organs.components[c].organ);
			organ = found->organs.components[c].organ;
		}
	return organ;
}

static void finish(struct soup *soup)
{
	lod_arena_free(&arena);
	soup_free(soup);
}

static void tubes_are_measured_by_their_curvature(void **state)
{
	(void)state;
	struct soup soup;
	struct found found;
	soup_begin(&soup);
	soup_tube(&soup, soup_material(&soup, 100, 70, 40, ECO_NONE, false), (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 1, 1, 4 }, 0.1, 0.1, 16, 20);
	for (uint32_t i = 0; i < soup.model.triangle_count; i += 3) {        /* winding must not matter */
		uint32_t swap = soup.model.index[3 * i];
		soup.model.index[3 * i] = soup.model.index[3 * i + 1];
		soup.model.index[3 * i + 1] = swap;
	}
	find(&found, &soup);
	const struct lod_component *c = &found.organs.components[0];
	assert_true(fabs(c->radius - 0.1) < 0.003);
	assert_true(fabs(c->length - sqrt(18)) < 0.02);
	assert_int_equal(c->organ, ECO_ORGAN_WOOD);
	finish(&soup);
}

static void a_tree_is_told_apart_whatever_its_textures(void **state)
{
	(void)state;
	for (int textured = 0; textured < 2; textured++) {
		struct soup soup;
		struct found found;
		soup_tree(&soup, 400, 30, textured);
		find(&found, &soup);
		assert_int_equal(organ_of(&found, 0), ECO_ORGAN_WOOD);
		assert_int_equal(organ_of(&found, 1), ECO_ORGAN_FOLIAGE);
		assert_int_equal(organ_of(&found, 2), ECO_ORGAN_FLOWER);
		finish(&soup);
	}
}

static void names_do_not_matter(void **state)
{
	(void)state;
	struct soup soup;
	struct found found;
	soup_tree(&soup, 400, 0, false);
	strcpy(soup.material[0].name, "Leaves");
	strcpy(soup.material[1].name, "Bark");
	find(&found, &soup);
	assert_int_equal(organ_of(&found, 0), ECO_ORGAN_WOOD);
	assert_int_equal(organ_of(&found, 1), ECO_ORGAN_FOLIAGE);
	finish(&soup);
}

static void one_material_for_all_is_no_obstacle(void **state)
{
	(void)state;
	struct soup soup;
	struct found found;
	uint32_t wood = 0;
	soup_tree(&soup, 400, 0, false);
	memset(soup.model.material, 0, soup.model.triangle_count * sizeof *soup.model.material);
	find(&found, &soup);
	for (uint32_t c = 0; c < found.mesh.component_count; c++)
		wood += found.organs.components[c].organ == ECO_ORGAN_WOOD;
	assert_int_equal(wood, 13);
	finish(&soup);
}

static void hulls_and_blades_are_foliage(void **state)
{
	(void)state;
	struct soup soup;
	struct found found;
	soup_begin(&soup);
	uint32_t hull = soup_material(&soup, 40, 120, 30, ECO_NONE, false), blade = soup_material(&soup, 40, 120, 30, ECO_NONE, false);
	soup_ball(&soup, hull, (struct lod_v3){ 0, 0, 3 }, 1.5, 12);
	for (int i = 0; i < 9; i++)          /* closed, flat: a lens for a cross-section */
		soup_tube(&soup, blade, (struct lod_v3){ i, 5, 0 }, (struct lod_v3){ i, 5.2, 1 }, 0.03, 0.03, 4, 3);
	for (uint32_t v = 0; v < soup.model.vertex_count; v++)
		if (soup.model.position[3 * v + 1] > 4.5f)
			soup.model.position[3 * v + 1] = 5 + 0.1f * (soup.model.position[3 * v + 1] - 5);
	find(&found, &soup);
	assert_int_equal(organ_of(&found, hull), ECO_ORGAN_FOLIAGE);
	assert_int_equal(organ_of(&found, blade), ECO_ORGAN_FOLIAGE);
	finish(&soup);
}

static void cut_outs_are_never_wood(void **state)
{
	(void)state;
	struct soup soup;
	struct found found;
	soup_begin(&soup);
	uint32_t m = soup_material(&soup, 255, 255, 255, soup_disc_image(&soup, 16), true);
	soup_tube(&soup, m, (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 0, 0, 5 }, 0.1, 0.05, 8, 10);
	find(&found, &soup);
	assert_int_equal(organ_of(&found, m), ECO_ORGAN_FOLIAGE);
	finish(&soup);
}

static void a_patch_inlaid_in_bark_is_bark(void **state)
{
	(void)state;
	struct soup soup;
	struct found found;
	soup_tree(&soup, 50, 0, false);
	uint32_t dark = soup_material(&soup, 10, 10, 10, ECO_NONE, false);
	soup.model.material[20] = soup.model.material[21] = dark;
	find(&found, &soup);
	assert_int_equal(organ_of(&found, dark), ECO_ORGAN_WOOD);
	finish(&soup);
}

static void colours_of_the_majority_are_no_flowers(void **state)
{
	(void)state;
	struct soup soup;
	struct found found;
	soup_tree(&soup, 40, 400, false);    /* autumn: mostly red */
	find(&found, &soup);
	assert_int_equal(organ_of(&found, 2), ECO_ORGAN_FOLIAGE);
	finish(&soup);
}

static void closed_surfaces_count_half(void **state)
{
	(void)state;
	struct soup soup;
	struct found found;
	double area = 0;
	soup_begin(&soup);
	soup_ball(&soup, soup_material(&soup, 0, 200, 0, ECO_NONE, false), (struct lod_v3){ 0, 0, 1 }, 1, 40);
	find(&found, &soup);
	for (uint32_t t = 0; t < found.mesh.triangle_count; t++)
		area += found.organs.area[t];
	assert_true(fabs(area - 2 * LOD_PI) < 0.02);
	finish(&soup);
}

static void transparent_parts_do_not_count(void **state)
{
	(void)state;
	struct soup soup;
	struct found found;
	soup_begin(&soup);
	uint32_t m = soup_material(&soup, 255, 255, 255, soup_disc_image(&soup, 64), true);
	soup_quad(&soup, m, (struct lod_v3){ 0, 0, 0 }, (struct lod_v3){ 1, 0, 0 }, (struct lod_v3){ 0, 1, 0 });
	find(&found, &soup);
	assert_true(fabs(found.organs.area[0] + found.organs.area[1] - 0.16 * LOD_PI) < 0.07);
	assert_in_range(found.organs.rgb[0][0], 40, 90);
	finish(&soup);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(tubes_are_measured_by_their_curvature),
		cmocka_unit_test(a_tree_is_told_apart_whatever_its_textures),
		cmocka_unit_test(names_do_not_matter),
		cmocka_unit_test(one_material_for_all_is_no_obstacle),
		cmocka_unit_test(hulls_and_blades_are_foliage),
		cmocka_unit_test(cut_outs_are_never_wood),
		cmocka_unit_test(a_patch_inlaid_in_bark_is_bark),
		cmocka_unit_test(colours_of_the_majority_are_no_flowers),
		cmocka_unit_test(closed_surfaces_count_half),
		cmocka_unit_test(transparent_parts_do_not_count),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
