/* Finished plants as bytes: what is read is what was written, and what is cut off or changed is refused or
 * harmless. */
#include <stdlib.h>
#include <string.h>

#include "lod/build/plant_bytes.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

/* A stem, coloured leaves and textured ones; cells where there are many. */
static void make_plant(struct lod_plant *plant, uint32_t leaves, uint32_t cell_triangles)
{
	struct soup soup;
	struct eco_error error = { 0 };
	soup_begin(&soup);
	soup.state = 5;
	uint32_t brown = soup_material(&soup, 90, 60, 30, ECO_NONE, false),
		green = soup_material(&soup, 40, 130, 20, ECO_NONE, false);
	uint32_t disc = soup_material(&soup, 255, 255, 255, soup_disc_image(&soup, 8), true);
	for (int side = 0; side < 4; side++)
		soup_quad(&soup, brown,
			(struct lod_v3){ side % 2 ? 0 : side ? 0.1 : -0.1, side % 2 ? side - 2 ? 0.1 : -0.1
			: 0, 1 }, (struct lod_v3){ side % 2 ? 0.1 : 0, side % 2 ? 0 : 0.1, 0 },
			(struct lod_v3){ 0, 0, 1 });
	for (uint32_t i = 0; i < leaves; i++) {
		struct lod_v3 at = { soup_random(&soup, -1, 1), soup_random(&soup, -1, 1),
			soup_random(&soup, 1, 3) };
		soup_quad(&soup, i % 3 ? green : disc, at,
			(struct lod_v3){ 0.05, soup_random(&soup, -0.05, 0.05), 0 },
			(struct lod_v3){ 0, soup_random(&soup, -0.05, 0.05), 0.05 });
	}
	const struct lod_plant_options options = { .name = "a name", .seed = 1, .grid_bits = 12,
		.cell_triangles = cell_triangles, .views = 3, .pixels = 48 };
	if (lod_plant_build(plant, &soup.model, &options, &error)
			|| lod_plant_measure(plant, &soup.model, &options, &error))
		fail_msg("%s", error.text);
	soup_free(&soup);
}

UNIT_TEST(what_is_read_is_what_was_written)
{
	static const uint32_t rows[][2] = { { 0, 0 }, { 1, 0 }, { 60, 0 }, { 900, 300 } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		struct lod_plant plant, again;
		struct eco_writer first = { 0 }, second = { 0 };
		struct eco_error error = { 0 };
		make_plant(&plant, rows[i][0], rows[i][1]);
		lod_plant_write(&first, &plant);
		if (lod_plant_read(&again, first.bytes, first.size, &error))
			fail_msg("%u leaves: %s", rows[i][0], error.text);
		assert_string_equal(again.plant.name, "");
		assert_int_equal(again.plant.anchor_count, plant.plant.anchor_count);
		assert_int_equal(again.list_count, plant.list_count);
		assert_memory_equal(again.solved, plant.solved, sizeof plant.solved);
		for (uint32_t l = 0; l < plant.list_count; l++) {
			const struct eco_elements *a = &plant.lists[l].elements,
				*b = &again.lists[l].elements;
			assert_memory_equal(a->position, b->position,
				3 * (size_t)a->corner_count * sizeof *a->position);
			assert_int_equal(a->extra_count, b->extra_count);
			assert_int_equal(a->uv != NULL, b->uv != NULL);
		}
		assert_true(rows[i][1] == 0 || plant.plant.anchor_count > 1);
		lod_plant_write(&second, &again);
		assert_int_equal(first.size, second.size);
		assert_memory_equal(first.bytes, second.bytes, first.size);
		lod_plant_free(&plant);
		lod_plant_free(&again);
		eco_writer_free(&first);
		eco_writer_free(&second);
	}
}

UNIT_TEST(every_truncation_is_refused)
{
	struct lod_plant plant, again;
	struct eco_writer w = { 0 };
	make_plant(&plant, 12, 0);
	lod_plant_write(&w, &plant);
	for (size_t size = 0; size <= w.size + 1; size++) {
		/* exactly as long as said, so that a sanitizer sees a read beyond it */
		uint8_t *part = calloc(size + 1, 1);
		struct eco_error error = { 0 };
		memcpy(part, w.bytes, size < w.size ? size : w.size);
		part = realloc(part, size ? size : 1);
		enum eco_code code = lod_plant_read(&again, part, size, &error);
		assert_int_equal(code, size == w.size ? ECO_OK : ECO_DAMAGED);
		assert_int_equal(error.text[0] != 0, code != ECO_OK);
		lod_plant_free(&again);
		free(part);
	}
	eco_writer_free(&w);
	lod_plant_free(&plant);
}

/* A changed byte is refused, or makes another plant that can be written. */
UNIT_TEST(changed_bytes_are_refused_or_harmless)
{
	struct lod_plant plant, again;
	struct eco_writer w = { 0 };
	uint64_t random = 9;
	uint32_t refused = 0;
	make_plant(&plant, 40, 0);
	lod_plant_write(&w, &plant);
	for (int i = 0; i < 20000; i++) {
		random = lod_mix(random);
		size_t at = i < 6000 ? (size_t)i % w.size : random % w.size;
		uint8_t before = w.bytes[at];
		w.bytes[at] = (uint8_t)(random >> 40);
		if (lod_plant_read(&again, w.bytes, w.size, NULL) == ECO_OK) {
			struct eco_writer copy = { 0 };
			lod_plant_write(&copy, &again);
			assert_int_equal(copy.size, w.size);
			assert_memory_equal(copy.bytes, w.bytes, w.size);
			eco_writer_free(&copy);
		} else {
			refused++;
			assert_null(again.lists);
		}
		lod_plant_free(&again);
		w.bytes[at] = before;
	}
	assert_true(refused > 1000);
	eco_writer_free(&w);
	lod_plant_free(&plant);
}
