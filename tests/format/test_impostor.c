/* Impostors: levels survive their bytes, strangers' bytes do no harm, directions are those of the format. */
#include "ecofiles/format/impostor.h"

#include <xxhash.h>

#include "tests/support/unit_test.h"

static const struct eco_impostor_body body = { { 0.5f, -1, 4 }, 3, 4, 0.75f };
static uint32_t state;

static uint32_t number(uint32_t below)
{
	state = state * 1664525u + 1013904223u;
	return (state >> 8) % below;
}

/* A disc with random holes in each tile, on a slope. */
static void fill(struct eco_impostor_level *level, uint32_t which, uint32_t holes)
{
	assert_good(eco_impostor_level_make(level, which, &cause));
	const struct eco_impostor_size *size = &eco_impostor_sizes[which];
	uint32_t tiles = eco_impostor_tiles(size->set), side = size->texels;
	state = 7 + which;
	level->gaps = number(ECO_IMPOSTOR_GAPS);
	for (uint32_t i = 0; i < tiles * side * side; i++) {
		double x = (i % side + 0.5) / side - 0.5, y = (i / side % side + 0.5) / side - 0.5;
		level->texel[i] = x * x + y * y < 0.2 && number(16) >= holes;
	}
	for (uint32_t i = 0; i < tiles * size->depths * size->depths; i++)
		level->depth[i] = (uint8_t)((i % size->depths + number(2)) * (size->depth_codes - 1)
			/ size->depths);
	for (uint32_t i = 0; i < 3 * eco_impostor_tiles(ECO_IMPOSTOR_FEW) * size->colors * size->colors; i++)
		level->color[i] = (uint8_t)(i % 3 * 8 + number(5));
}

static void write(struct eco_writer *w, const struct eco_impostor_level *level)
{
	size_t shape = 0;
	assert_good(eco_impostor_level_write(w, &body, level, &shape, &cause));
	assert_in_range(shape, 4, w->size);
}

static void assert_same(const struct eco_impostor_level *a, const struct eco_impostor_level *b)
{
	assert_int_equal(a->level, b->level);
	assert_int_equal(a->gaps, b->gaps);
	const struct eco_impostor_size *size = &eco_impostor_sizes[a->level];
	size_t tiles = eco_impostor_tiles(size->set), few = eco_impostor_tiles(ECO_IMPOSTOR_FEW);
	assert_memory_equal(a->texel, b->texel, tiles * size->texels * size->texels);
	assert_memory_equal(a->depth, b->depth, tiles * size->depths * size->depths);
	assert_memory_equal(a->color, b->color, few * size->colors * size->colors * 3);
}

UNIT_TEST(levels_survive_their_bytes)
{
	for (uint32_t which = 0; which < ECO_IMPOSTOR_LEVELS; which++)
		for (uint32_t holes = 0; holes <= 16; holes += 4) {
			FREED(eco_impostor_level) level, back;
			struct eco_impostor_body read;
			FREED(eco_writer) w = { 0 };
			fill(&level, which, holes);
			eco_write_u8(&w, 99);                /* what is there before stays */
			write(&w, &level);
			assert_good(eco_impostor_level_read(&back, &read, w.bytes + 1, w.size - 1, &cause));
			assert_int_equal(w.bytes[0], 99);
			assert_same(&level, &back);
		}
}

/* Whatever is read is in range. */
static void assert_in_bounds(const struct eco_impostor_level *level)
{
	const struct eco_impostor_size *size = &eco_impostor_sizes[level->level];
	uint32_t tiles = eco_impostor_tiles(size->set);
	for (uint32_t i = 0; i < tiles * size->texels * size->texels; i++)
		assert_in_range(level->texel[i], 0, 1);
	for (uint32_t i = 0; i < tiles * size->depths * size->depths; i++)
		assert_in_range(level->depth[i], 0, size->depth_codes - 1);
	for (uint32_t i = 0; i < 3 * eco_impostor_tiles(ECO_IMPOSTOR_FEW) * size->colors * size->colors; i++)
		assert_in_range(level->color[i], 0, ECO_IMPOSTOR_COLORS - 1);
}

static bool try_read(const uint8_t *bytes, size_t size)
{
	struct eco_impostor_level level;
	struct eco_impostor_body read;
	struct eco_error error = { 0 };
	enum eco_code code = eco_impostor_level_read(&level, &read, bytes, size, &error);
	if (code) {
		assert_int_equal(code, ECO_DAMAGED);
		assert_true(error.text[0] && !level.texel && !level.depth && !level.color);
		return false;
	}
	assert_in_bounds(&level);
	eco_impostor_level_free(&level);
	return true;
}

UNIT_TEST(damaged_bytes_are_named_or_harmless)
{
	for (uint32_t which = 0; which < 3; which++) {
		FREED(eco_impostor_level) level;
		FREED(eco_writer) w = { 0 };
		uint32_t read = 0;
		fill(&level, which, 3);
		write(&w, &level);
		for (size_t size = 0; size < w.size; size += 1 + size / 16)
			read += try_read(w.bytes, size);
		assert_int_equal(read, 0);
		for (uint32_t i = 0; i < 300; i++) {
			size_t at = i < 8 ? i : number((uint32_t)w.size);
			uint8_t before = w.bytes[at];
			w.bytes[at] ^= (uint8_t)(1u << number(8));
			try_read(w.bytes, w.size);
			w.bytes[at] = before;
		}
		eco_write_u8(&w, 0);
		assert_false(try_read(w.bytes, w.size));
	}
	for (uint32_t i = 0; i < 300; i++) {
		uint8_t bytes[64];
		for (size_t k = 0; k < sizeof bytes; k++)
			bytes[k] = (uint8_t)number(k ? 256 : ECO_IMPOSTOR_LEVELS + 1);
		bytes[1] &= 63;
		try_read(bytes, number(sizeof bytes + 1));
	}
}
