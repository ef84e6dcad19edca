/* Foliage of colors that no leaf has: how bright it is found to be, and what grading changes. */
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/ecopack/grade.h"
#include "ecofiles/format/pack.h"
#include "tests/support/unit_test.h"

/* A trunk of two triangles and `leaves` of two, which rules name; leaves have the material 1. */
#define LEAVES 60
static struct eco_model plant_of(const uint8_t leaf[3])
{
	struct eco_model m = { .vertex_count = 4 * (LEAVES + 1), .triangle_count = 2 * (LEAVES + 1), .material_count = 2 };
	m.position = eco_alloc(m.vertex_count, 3 * sizeof *m.position);
	m.uv = eco_alloc(m.vertex_count, 2 * sizeof *m.uv);
	m.index = eco_alloc(m.triangle_count, 3 * sizeof *m.index);
	m.material = eco_alloc(m.triangle_count, sizeof *m.material);
	m.organ = eco_alloc(m.triangle_count, 1);
	m.materials = eco_alloc(2, sizeof *m.materials);
	for (int i = 0; i <= LEAVES; i++)
		for (int k = 0; k < 4; k++) {
			float *p = m.position + 3 * (4 * i + k), side = i ? 0.1f : 1;
			p[0] = (float)(i % 8) + (k % 3 ? side : 0);
			p[1] = (float)(i / 8);
			p[2] = (i ? 2 : 0) + (k > 1 ? side : 0);
			m.uv[2 * (4 * i + k)] = 0.5f;
			m.uv[2 * (4 * i + k) + 1] = 0.5f;
		}
	for (uint32_t t = 0; t < m.triangle_count; t++) {
		for (uint32_t k = 0; k < 3; k++)
			m.index[3 * t + k] = 4 * (t / 2) + (t % 2 && k ? k + 1 : k);
		m.material[t] = t > 1;
		m.organ[t] = t > 1 ? ECO_ORGAN_FOLIAGE : ECO_ORGAN_WOOD;
	}
	m.materials[0] = (struct eco_material){ .rgb = { 200, 190, 180 }, .image = ECO_NONE };
	m.materials[1] = (struct eco_material){ .rgb = { leaf[0], leaf[1], leaf[2] }, .image = ECO_NONE };
	return m;
}

static double light_of(const struct eco_model *m)
{
	uint8_t *organ = grade_organs(m);
	double light = grade_light(m, organ);
	free(organ);
	return light;
}

UNIT_TEST(pastel_foliage_is_darkened_and_wood_is_not)
{
	struct eco_model m = plant_of((const uint8_t[]){ 160, 215, 140 });
	double before = light_of(&m);
	grade_foliage(&m);
	const uint8_t *leaf = m.materials[1].rgb;
	print_message("%.3f of light, then %.3f: %u %u %u\n", before, light_of(&m), leaf[0], leaf[1], leaf[2]);
	assert_true(before > 0.5 && light_of(&m) > 0.98 * GRADE_TO && light_of(&m) < 1.02 * GRADE_TO);
	assert_memory_equal(m.materials[0].rgb, ((const uint8_t[]){ 200, 190, 180 }), 3);
	assert_true(leaf[1] > leaf[0] && leaf[0] > leaf[2]);             /* its hue stays */
	grade_foliage(&m);
	assert_memory_equal(leaf, m.materials[1].rgb, 3);                /* once is enough */
	eco_model_free(&m);
}

UNIT_TEST(foliage_of_leaves_color_stays)
{
	struct eco_model m = plant_of((const uint8_t[]){ 81, 115, 47 });
	grade_foliage(&m);
	assert_memory_equal(m.materials[1].rgb, ((const uint8_t[]){ 81, 115, 47 }), 3);
	eco_model_free(&m);
}

UNIT_TEST(images_on_foliage_are_darkened)
{
	struct eco_model m = plant_of((const uint8_t[]){ 255, 255, 255 });
	static const uint8_t texel[4] = { 170, 220, 150, 255 };
	m.images = eco_alloc(1, sizeof *m.images);
	m.image_count = 1;
	m.images[0] = (struct eco_image){ 1, 1, eco_alloc(1, 4) };
	memcpy(m.images[0].rgba, texel, 4);
	m.materials[1].image = 0;
	grade_foliage(&m);
	assert_true(m.images[0].rgba[1] < 130 && m.images[0].rgba[3] == 255);
	assert_true(light_of(&m) > 0.98 * GRADE_TO && light_of(&m) < 1.02 * GRADE_TO);
	eco_model_free(&m);
}

UNIT_MAIN(NULL, NULL)
