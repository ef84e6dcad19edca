/* Finished plants as bytes: what is read is what was written, and what is cut off or changed is refused or
 * harmless. */
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/impostor.h"
#include "lod/build/plant_bytes.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

/* A stem, coloured leaves and textured ones; cells where there are many. */
static void make_plant_with(struct lod_plant *plant, uint32_t leaves, uint32_t cell_triangles, bool no_splats)
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
		.cell_triangles = cell_triangles, .views = 3, .pixels = 48, .no_splats = no_splats };
	if (lod_plant_build(plant, &soup.model, &options, &error)
			|| lod_plant_measure(plant, &soup.model, &options, &error))
		fail_msg("%s", error.text);
	soup_free(&soup);
}

static void make_plant(struct lod_plant *plant, uint32_t leaves, uint32_t cell_triangles)
{
	make_plant_with(plant, leaves, cell_triangles, false);
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
		assert_true(plant.impostor_count > 0);
		assert_int_equal(again.impostor_count, plant.impostor_count);
		assert_int_equal(again.impostor_level, plant.impostor_level);
		for (uint32_t l = 0; l < plant.impostor_count; l++) {
			assert_int_equal(again.impostor[l].size, plant.impostor[l].size);
			assert_memory_equal(again.impostor[l].at, plant.impostor[l].at,
				plant.impostor[l].size);
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

/* A changed byte is refused, or makes another plant that can be written. Returns the number refused. */
static uint32_t change_bytes(const struct lod_plant *plant, size_t from, int changes, int in_order)
{
	struct lod_plant again;
	struct eco_writer w = { 0 };
	uint64_t random = 9;
	uint32_t refused = 0;
	lod_plant_write(&w, plant);
	assert_true(from < w.size);
	for (int i = 0; i < changes; i++) {
		random = lod_mix(random);
		size_t at = from + (i < in_order ? (size_t)i : (size_t)random) % (w.size - from);
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
			assert_null(again.impostor);
		}
		lod_plant_free(&again);
		w.bytes[at] = before;
	}
	eco_writer_free(&w);
	return refused;
}

/* Thousands of changes without the impostor, as its levels take long to read; then some within these, which
 * come last. */
UNIT_TEST(changed_bytes_are_refused_or_harmless)
{
	struct lod_plant plant;
	struct eco_writer w = { 0 };
	make_plant(&plant, 40, 0);
	struct eco_ladder *whole = &plant.ladders[plant.ladder_count - 1];
	uint32_t levels = plant.impostor_count, list = whole->impostor;
	assert_true(levels > 0 && list == plant.list_count);
	plant.impostor_count = 0;
	whole->impostor = ECO_NONE;
	lod_plant_write(&w, &plant);
	assert_true(change_bytes(&plant, 0, 20000, 6000) > 1000);
	plant.impostor_count = levels;
	whole->impostor = list;
	assert_true(change_bytes(&plant, w.size, 400, 100) > 200);
	eco_writer_free(&w);
	lod_plant_free(&plant);
}

/* ---- Impostors ---- */

static struct eco_ladder *whole_of(const struct lod_plant *plant)
{
	struct eco_ladder *last = &plant->ladders[plant->ladder_count - 1];
	assert_true(last->flags & ECO_LADDER_WHOLE);
	return last;
}

/* Each breaks the plant before it is written; the pointers that it writes over are kept by the caller. */
static void swap_levels(struct lod_plant *p)
{
	struct eco_bytes first = p->impostor[0];
	p->impostor[0] = p->impostor[1];
	p->impostor[1] = first;
}
static void repeat_level(struct lod_plant *p) { p->impostor[1] = p->impostor[0]; }
static void number_level(struct lod_plant *p) { p->impostor[1].at[24] = ECO_IMPOSTOR_LEVELS; }
static void cut_level(struct lod_plant *p) { p->impostor[1].size--; }
static void empty_level(struct lod_plant *p) { p->impostor[0].size = 0; }
static void drop_levels(struct lod_plant *p) { p->impostor_count = 0; }
static void name_splats(struct lod_plant *p) { whole_of(p)->impostor = whole_of(p)->points; }
static void name_nothing(struct lod_plant *p) { whole_of(p)->impostor = p->list_count + 1; }
static void drop_samples(struct lod_plant *p) { whole_of(p)->curve_count = 0; }
static void drop_sample(struct lod_plant *p) { whole_of(p)->curve_count = p->impostor_count - 1; }

static const struct { void (*apply)(struct lod_plant *plant); const char *says; } breaks[] = {
	{ swap_levels, "level 0 of an impostor is level 1" },
	{ repeat_level, "level 1 of an impostor is level 0" },
	{ number_level, "impostor" },
	{ cut_level, "impostor: level 1 is damaged" },
	{ empty_level, "impostor" },
	{ drop_levels, "a ladder of an impostor that is not there" },
	{ name_splats, "a ladder of an impostor that is not there" },
	{ name_nothing, "a ladder of an impostor that is not there" },
	{ drop_samples, "or without its samples" },
	{ drop_sample, "or without its samples" },
};

UNIT_TEST(impostors_that_do_not_fit_are_refused)
{
	struct lod_plant plant, again;
	make_plant(&plant, 200, 0);
	assert_int_equal(plant.impostor_count, 2);       /* a draft's */
	struct eco_bytes kept[2] = { plant.impostor[0], plant.impostor[1] };
	struct eco_ladder whole = *whole_of(&plant);
	uint8_t number = kept[1].at[24];
	for (size_t i = 0; i < sizeof breaks / sizeof *breaks; i++) {
		struct eco_writer w = { 0 };
		struct eco_error error = { 0 };
		breaks[i].apply(&plant);
		lod_plant_write(&w, &plant);
		enum eco_code code = lod_plant_read(&again, w.bytes, w.size, &error);
		if (code != ECO_DAMAGED || !strstr(error.text, breaks[i].says))
			fail_msg("row %zu: code %d, '%s'", i, code, error.text);
		assert_true(!again.impostor && !again.impostor_count && !again.lists);
		eco_writer_free(&w);
		plant.impostor_count = 2;
		memcpy(plant.impostor, kept, sizeof kept);
		plant.impostor[1].at[24] = number;
		*whole_of(&plant) = whole;
	}
	lod_plant_free(&plant);
}

/* The number of levels is the last of seven. */
UNIT_TEST(no_number_of_levels_is_believed)
{
	static const uint32_t numbers[] = { 0, 1, 3, 4, 1000, UINT32_MAX };
	struct lod_plant plant, again;
	struct eco_writer w = { 0 };
	make_plant(&plant, 200, 0);
	lod_plant_write(&w, &plant);
	assert_int_equal(w.bytes[24], plant.impostor_count);
	for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
		struct eco_error error = { 0 };
		for (int k = 0; k < 4; k++)
			w.bytes[24 + k] = (uint8_t)(numbers[i] >> 8 * k);
		assert_int_equal(lod_plant_read(&again, w.bytes, w.size, &error), ECO_DAMAGED);
		assert_true(error.text[0] && !again.impostor);
	}
	eco_writer_free(&w);
	lod_plant_free(&plant);
}

UNIT_TEST(plants_without_splats_have_no_impostor)
{
	struct lod_plant plant, again;
	struct eco_writer w = { 0 };
	struct eco_error error = { 0 };
	make_plant_with(&plant, 60, 0, true);
	assert_true(!plant.impostor_count && plant.ladder_count > 0);
	for (uint32_t i = 0; i < plant.ladder_count; i++)
		assert_int_equal(plant.ladders[i].impostor, ECO_NONE);
	lod_plant_write(&w, &plant);
	assert_ok(lod_plant_read(&again, w.bytes, w.size, &error), error);
	assert_int_equal(again.impostor_count, 0);
	lod_plant_free(&again);
	lod_plant_free(&plant);
	eco_writer_free(&w);
}
