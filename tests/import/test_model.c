/* Models: what a file holds arrives or is counted, and what cannot be read is refused by name. Each oddity of
 * a format is written out as the small file that shows it. */
#include <math.h>

#include "ecofiles/import/model/import_model.h"
#include "ecofiles/import/model/model_import.h"
#include "ecofiles/import/model/model_clean.h"
#include "ecofiles/base/geometry.h"
#include "tests/support/input_files.h"
#include "tests/support/model_try.h"
#include "tests/support/unit_test.h"

UNIT_TEST(objs_are_moved_and_cleaned)
{
	expect_models("model", "tests/import/cases/model.tsv");
	assert_null(m.uv);
}

/* Star-shaped polygons in tilted planes, concave as can be, some with corners in a line or repeated: the
 * triangles' areas, none of them negative, add up to the polygon's. */
UNIT_TEST(any_simple_polygon_is_covered_exactly_once)
{
	uint32_t seed = 1;
	for (uint32_t round = 0; round < 2000; round++) {
		uint32_t n = 3 + round % 30, scratch[32], triangles[96];
		double corners[96], polygon = 0, sum = 0;
		for (uint32_t i = 0; i < n; i++) {
			double angle = 6.283185307 * i / n, radius;
			seed = seed * 1664525u + 1013904223u;
			/* whole numbers: corners in a line occur */
			radius = 1 + (double)(seed >> 28);
			if (round % 7 == 0 && i > 0 && i % 5 == 0) {
				memcpy(&corners[i * 3], &corners[i * 3 - 3], 3 * sizeof *corners);
				continue;
			}
			corners[i * 3] = radius * cos(angle);
			corners[i * 3 + 1] = radius * sin(angle) * (round % 2 ? 1 : -1);
			corners[i * 3 + 2] = round % 3 * corners[i * 3] - 2 * corners[i * 3 + 1];
		}
		for (uint32_t i = 0; i < n; i++) {
			const double *a = &corners[i * 3], *b = &corners[(i + 1) % n * 3];
			polygon += a[0] * b[1] - a[1] * b[0];
		}
		eco_polygon_split(corners, n, scratch, triangles);
		for (uint32_t i = 0; i < n - 2; i++) {
			const double *a = &corners[triangles[i * 3] * 3],
				*b = &corners[triangles[i * 3 + 1] * 3],
				*c = &corners[triangles[i * 3 + 2] * 3];
			double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
			assert_true(area * (polygon < 0 ? -1 : 1) >= -1e-9);
			sum += area;
		}
		assert_true(fabs(sum - polygon) < 1e-6);
	}
}

UNIT_TEST(bad_indices_are_dropped_by_the_last_step_too)
{
	struct eco_model_frame frame = { .unit_m = 1 };
	struct eco_notes notes = { .used = 0 };
	static const float position[] = { 0, 0, 0, 1, 0, 0, 0, 0, 1 };
	static const uint32_t index[] = { 0, 1, 7, 0, 1, 2, ECO_NONE, 1, 2 };
	eco_model_free(&m);
	m = (struct eco_model){ .vertex_count = 3, .triangle_count = 3, .triangles_in = 3,
		.material_count = 1 };
	m.position = malloc(sizeof position);
	m.index = malloc(sizeof index);
	m.material = calloc(3, sizeof *m.material);
	m.materials = calloc(1, sizeof *m.materials);
	m.materials[0].image = ECO_NONE;
	memcpy(m.position, position, sizeof position);
	memcpy(m.index, index, sizeof index);
	assert_int_equal(eco_model_clean(&m, &frame, &(struct eco_model_options){ .height_m = 0 }, "memory",
		&notes, NULL), ECO_OK);
	assert_int_equal(m.triangle_count, 1);
	assert_int_equal(m.dropped[ECO_DROP_BAD_INDEX], 2);
}
