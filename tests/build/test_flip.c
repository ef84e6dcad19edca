/* The error that people see: the figures of its authors' own program, and what must hold for any pictures. */
#include <math.h>
#include <string.h>

#include "lod/raster/blocks.h"
#include "lod/raster/flip.h"
#include "tests/support/unit_test.h"

#define WIDTH 256u
#define HEIGHT 192u

static uint8_t a[3 * WIDTH * HEIGHT], b[3 * WIDTH * HEIGHT];

static void put(uint8_t *rgb, uint32_t red, uint32_t green, uint32_t blue)
{
	rgb[0] = (uint8_t)red, rgb[1] = (uint8_t)green, rgb[2] = (uint8_t)blue;
}

static void stripes(uint32_t x, uint32_t y, uint8_t *p, uint8_t *q)
{
	put(p, x, y, x ^ y);
	put(q, x, y + (x >> 4 & 1) * 40, (x ^ y) + ((x / 3 + y / 5) % 7 == 0 ? 90 : 0));
}

static void flat(uint32_t x, uint32_t y, uint8_t *p, uint8_t *q)
{
	put(p, 128, 128, 128);
	put(q, 128, 148, 128);
}

static void shifted(uint32_t x, uint32_t y, uint8_t *p, uint8_t *q)
{
	memset(p, (x / 4 + y / 4) % 2 ? 200 : 60, 3);
	memset(q, ((x + 1) / 4 + y / 4) % 2 ? 200 : 60, 3);
}

static void noisy(uint32_t x, uint32_t y, uint8_t *p, uint8_t *q)
{
	uint32_t h = (7919 * x + 104729 * y) * 1664525u + 1013904223u;
	for (uint32_t c = 0; c < 3; c++) {
		p[c] = (uint8_t)(80 + 30 * c);
		q[c] = (uint8_t)(80 + 30 * c + (h >> (8 + 8 * c)) % 61 - 30);
	}
}

static void make(void (*pattern)(uint32_t, uint32_t, uint8_t *, uint8_t *))
{
	for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
		pattern(i % WIDTH, i / WIDTH, a + 3 * i, b + 3 * i);
}

static double flip(const uint8_t *test, const uint8_t *reference, uint32_t width, uint32_t height,
	float *error)
{
	return lod_flip(&(struct lod_flip_input){ width, height, test, reference, error });
}

UNIT_TEST(means_are_those_of_its_authors)
{
	static const struct pair { void (*pattern)(uint32_t, uint32_t, uint8_t *, uint8_t *); double mean;
		} pairs[] = { { stripes, 0.373118 }, { flat, 0.363236 }, { shifted, 0.214213 },
		{ noisy, 0.119011 } };
	for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
		make(pairs[i].pattern);
		double mean = flip(b, a, WIDTH, HEIGHT, NULL);
		print_message("pair %zu: %.6f, theirs %.6f\n", i + 1, mean, pairs[i].mean);
		assert_true(fabs(mean - pairs[i].mean) < 0.0005);
	}
}

/* Bands and rows of four leave no seams: a part has the errors of the whole, away from its borders. */
UNIT_TEST(error_is_local)
{
	enum { LEFT = 13, TOP = 37, PART = 90, MARGIN = 10 };
	static float whole[WIDTH * HEIGHT], part[PART * PART];
	static uint8_t p[3 * PART * PART], q[3 * PART * PART];
	make(stripes);
	double mean = flip(a, b, WIDTH, HEIGHT, whole), sum = 0;
	for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
		assert_true(whole[i] >= 0 && whole[i] <= 1);
		sum += whole[i];
	}
	assert_true(fabs(sum / (WIDTH * HEIGHT) - mean) < 1e-6);
	for (uint32_t y = 0; y < PART; y++) {
		memcpy(p + 3 * PART * y, a + 3 * ((TOP + y) * WIDTH + LEFT), 3 * PART);
		memcpy(q + 3 * PART * y, b + 3 * ((TOP + y) * WIDTH + LEFT), 3 * PART);
	}
	flip(p, q, PART, PART, part);
	for (uint32_t y = MARGIN; y < PART - MARGIN; y++)
		assert_memory_equal(part + y * PART + MARGIN, whole + (TOP + y) * WIDTH + LEFT + MARGIN,
			(PART - 2 * MARGIN) * sizeof *part);
}

static struct lod_block_error blocks(double *pop)
{
	enum { COUNT = WIDTH / LOD_BLOCK_SIDE * (HEIGHT / LOD_BLOCK_SIDE) };
	struct lod_block test[COUNT], reference[COUNT];
	struct lod_block_error error;
	assert_int_equal(lod_block_count(WIDTH, HEIGHT), COUNT);
	lod_blocks_make(test, WIDTH, HEIGHT, b);
	lod_blocks_make(reference, WIDTH, HEIGHT, a);
	lod_blocks_compare(&error, test, reference, COUNT);
	*pop = lod_blocks_pop(reference, test, COUNT);
	return error;
}

static void noise(uint32_t x, uint32_t y, uint8_t *p, uint8_t *q)
{
	noisy(x, y, p, q);
	memset(p, 128, 3);
	memset(q, q[0] & 1 ? 160 : 87, 3);
}

/* Moved leaves are no error of blocks; another colour is one of colour, and another contrast one of contrast. */
UNIT_TEST(blocks_tell_colour_from_contrast)
{
	double pop;
	make(shifted);
	struct lod_block_error moved = blocks(&pop);
	print_message("moved: %.3f %.3f %.3f\n", moved.color, moved.contrast, moved.contrast_abs);
	assert_true(moved.color < 0.01 && moved.contrast_abs < 0.01 && pop < 0.01);
	make(flat);
	struct lod_block_error colour = blocks(&pop);
	/* CIELAB of (128, 128, 128) and (128, 148, 128): 53.585, 0, 0 and 59.276, -11.148, 8.205 */
	print_message("colour: %.3f %.3f %.3f\n", colour.color, colour.contrast, colour.contrast_abs);
	assert_true(fabs(colour.color - 14.966) < 0.01 && colour.contrast_abs < 1e-3);
	assert_true(fabs(pop - colour.color) < 1e-9);
	make(noise);
	struct lod_block_error contrast = blocks(&pop);
	print_message("contrast: %.3f %.3f %.3f\n", contrast.color, contrast.contrast, contrast.contrast_abs);
	assert_true(contrast.contrast > 13 && contrast.contrast < 16 && contrast.color < 2);
	assert_true(fabs(contrast.contrast - contrast.contrast_abs) < 1e-9);
}
