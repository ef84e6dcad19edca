/* Points of summaries in parts: around their point, and the first parts stay where there are more. */
#include <stdlib.h>
#include <string.h>

#include "lod/scattered.h"
#include "tests/support/unit_test.h"

#define POINTS 50u
#define FIRST 7u

static void make(struct lod_geometry *g, unsigned halvings)
{
	g->position = malloc(sizeof *g->position * 3 * ((size_t)POINTS << halvings));
	g->color = malloc(sizeof *g->color * ((size_t)POINTS << halvings));
	for (uint32_t i = 0; i < POINTS; i++) {
		for (uint32_t k = 0; k < 3; k++)
			g->position[3 * i + k] = (float)(100 * k + i);
		g->color[i] = (int32_t)i;
	}
	lod_scatter(g, POINTS, FIRST, halvings, 2.5);
}

static void release(struct lod_geometry *g)
{
	free(g->position);
	free(g->color);
}

UNIT_TEST(each_part_keeps_its_points_colour_and_more_parts_add_to_those_before)
{
	struct lod_geometry some = { 0 }, more = { 0 };
	make(&some, 2);
	make(&more, 3);
	for (uint32_t i = 0; i < POINTS; i++)
		for (uint32_t part = 0; part < 8; part++) {
			const float *at = more.position + 3 * (8 * (size_t)i + part);
			float offset[3];
			lod_scattered_offset(offset, FIRST + i, part);
			for (uint32_t k = 0; k < 3; k++)
				assert_true(at[k] == (float)(100 * k + i) + 2.5f * offset[k]);
			assert_int_equal(more.color[8 * i + part], i);
			assert_true(part >= 4 || !memcmp(at, some.position + 3 * (4 * (size_t)i + part),
				3 * sizeof *at));
		}
	release(&some);
	release(&more);
}
