/* Finished plants as bytes: what is read is what was written; what is cut off is refused. */
#include <stdlib.h>
#include <string.h>

#include "lod/build/plant.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

/* With textured leaves and coloured flowers; cells where there are many. */
static void make_plant(struct lod_plant *plant, uint32_t leaves, uint32_t cell_triangles, bool no_splats)
{
	struct soup soup;
	struct eco_error error = { 0 };
	soup_tree(&soup, leaves, leaves / 10, true);
	const struct lod_plant_options options = { .name = "a name", .seed = 1, .grid_bits = 12,
		.cell_triangles = cell_triangles, .views = 3, .pixels = 48, .no_splats = no_splats };
	if (lod_plant_build(plant, &soup.model, &options, &error)
			|| lod_plant_measure(plant, &soup.model, &options, &error))
		fail_msg("%s", error.text);
	soup_free(&soup);
}

#define SAME(a, b, count) assert_memory_equal(a, b, (size_t)(count) * sizeof *(a))

static void assert_same_list(const struct lod_list_draft *a, const struct lod_list_draft *b)
{
	const struct eco_elements *e = &a->elements, *f = &b->elements;
	assert_int_equal(a->list.element_count, b->list.element_count);
	assert_int_equal(e->uv != NULL, f->uv != NULL);
	assert_int_equal(e->exact != NULL, f->exact != NULL);
	SAME(a->ends, b->ends, a->end_count);
	SAME(e->corners, f->corners, e->element_count);
	SAME(e->position, f->position, 3 * e->corner_count);
	SAME(e->extra, f->extra, e->element_count * e->extra_count);
	if (e->exact)
		SAME(e->exact, f->exact, 3 * e->corner_count);
	if (e->uv)
		SAME(e->uv, f->uv, 2 * e->corner_count);
}

UNIT_TEST(what_is_read_is_what_was_written)
{
	static const struct { uint32_t leaves, cell_triangles; bool no_splats; } rows[] = { { 0, 0, false },
		{ 1, 0, true }, { 60, 0, true }, { 900, 300, false } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct lod_plant plant, again;
		struct eco_writer w = { 0 };
		struct eco_error error = { 0 };
		make_plant(&plant, rows[i].leaves, rows[i].cell_triangles, rows[i].no_splats);
		lod_plant_write(&w, &plant);
		assert_ok(lod_plant_read(&again, w.bytes, w.size, &error), error);
		assert_string_equal(again.plant.name, "");
		assert_int_equal(again.list_count, plant.list_count);
		SAME(again.solved, plant.solved, LOD_SOLVER_COUNT);
		SAME(again.anchors, plant.anchors, plant.plant.anchor_count);
		SAME(again.ladders, plant.ladders, plant.ladder_count);
		SAME(again.curves, plant.curves, plant.curve_count);
		SAME(again.palette, plant.palette, plant.palette_count);
		for (uint32_t l = 0; l < plant.list_count; l++)
			assert_same_list(&plant.lists[l], &again.lists[l]);
		assert_int_equal(plant.impostor_count > 0, !rows[i].no_splats);
		assert_int_equal(again.impostor_count, plant.impostor_count);
		for (uint32_t l = 0; l < plant.impostor_count; l++)
			SAME(again.impostor[l].at, plant.impostor[l].at, plant.impostor[l].size);
		assert_true(rows[i].cell_triangles == 0 || plant.plant.anchor_count > 1);
		lod_plant_free(&plant);
		lod_plant_free(&again);
		eco_writer_free(&w);
	}
}

UNIT_TEST(truncations_are_refused)
{
	struct lod_plant plant, again;
	struct eco_writer w = { 0 };
	make_plant(&plant, 12, 0, true);
	lod_plant_write(&w, &plant);
	for (size_t size = 0; size < w.size; size++) {
		/* exactly as long as said, so that a sanitizer sees a read beyond it */
		uint8_t *part = malloc(size + 1);
		struct eco_error error = { 0 };
		memcpy(part, w.bytes, size);
		part = realloc(part, size ? size : 1);
		assert_int_equal(lod_plant_read(&again, part, size, &error), ECO_DAMAGED);
		assert_true(error.text[0] && !again.lists && !again.impostor);
		free(part);
	}
	eco_writer_free(&w);
	lod_plant_free(&plant);
}
