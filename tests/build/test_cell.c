/* Cells partition a plant. */
#include "lod/build/plant_state.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

#define MOST 20000
static struct lod_v3 center[MOST];
static uint32_t triangles[MOST];
static struct soup dice;

static void scatter(int shape)
{
	dice.state = 11;
	for (uint32_t i = 0; i < MOST; i++) {
		struct lod_v3 p = { soup_random(&dice, 0, 4), soup_random(&dice, 0, 4),
			soup_random(&dice, 0, 8) };
		if (shape == 1)
			p.x = p.y = 2;                           /* a pole */
		if (shape == 2 && i > 100)
			p = lod_v3_scale(p, 0.1);                /* nearly all in one corner */
		center[i] = p;
		triangles[i] = 1 + i % 4;
	}
}

static uint32_t make(struct lod_cells *cells, uint32_t count, uint32_t limit,
	uint64_t per_cell[LOD_CELLS_MAX])
{
	lod_cells_make(cells, &(struct lod_cells_input){ { 0, 0, 0 }, { 4, 4, 8 }, count, center, triangles,
		limit });
	memset(per_cell, 0, LOD_CELLS_MAX * sizeof *per_cell);
	for (uint32_t i = 0; i < count && cells->count; i++) {
		uint32_t c = lod_cells_at(cells, center[i]);
		assert_in_range(c, 0, cells->count - 1);
		per_cell[c] += triangles[i];
	}
	return cells->count;
}

UNIT_TEST(large_plants_are_divided_twice_at_most)
{
	struct lod_cells cells;
	uint64_t per_cell[LOD_CELLS_MAX];
	scatter(0);
	assert_int_equal(make(&cells, MOST, 50000, per_cell), 0);
	assert_int_equal(make(&cells, 0, 10, per_cell), 0);
	assert_int_equal(make(&cells, MOST, 40000, per_cell), 8);
	assert_int_equal(make(&cells, MOST, 1000, per_cell), 64);
	for (uint32_t c = 0; c < 64; c++)
		assert_in_range(per_cell[c], 400, 1200);
}

UNIT_TEST(no_cell_is_nearly_empty)
{
	struct lod_cells cells;
	uint64_t per_cell[LOD_CELLS_MAX];
	for (int shape = 1; shape < 3; shape++) {
		scatter(shape);
		uint32_t count = make(&cells, MOST, 4000, per_cell);
		assert_true(count >= (shape == 1 ? 4 : 1) || count == 0);
		for (uint32_t c = 0; c < count; c++)
			assert_true(per_cell[c] >= 4000 / 16);
	}
}

UNIT_TEST(a_flat_plant_is_divided_in_its_plane)
{
	struct lod_cells cells;
	scatter(0);
	for (uint32_t i = 0; i < MOST; i++)
		center[i].z = 0;
	lod_cells_make(&cells, &(struct lod_cells_input){ { 0, 0, 0 }, { 4, 4, 0 }, MOST, center, triangles,
		5000 });
	assert_int_equal(cells.count, 16);
}
