/* paint OUT.jpg SIDE SEED: bark as a photograph has it, with grain that no coder foresees, for scenes that
 * measure what reading textures takes. The same arguments give the same texels. */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <jpeglib.h>

#include "ecofiles/base/random.h"

#define SIDE_MAX 8192u
#define QUALITY 85

static uint8_t sample(double light) { return (uint8_t)fmin(255, fmax(0, light)); }

static void paint_row(uint8_t *row, uint32_t side, uint32_t y, uint64_t *state)
{
	for (uint32_t x = 0; x < side; x++) {
		double ridge = fabs(sin(x * 0.05 + 2 * sin(y * 0.011) + (double)(*state & 1))),
			light = 60 + 80 * ridge + 60 * eco_random_unit(eco_random_next(state));
		row[3 * x] = sample(light * 1.05);
		row[3 * x + 1] = sample(light * 0.85);
		row[3 * x + 2] = sample(light * 0.65);
	}
}

static void paint(FILE *out, uint32_t side, uint64_t state, uint8_t *row)
{
	struct jpeg_error_mgr errors;
	struct jpeg_compress_struct jpeg = { .err = jpeg_std_error(&errors) };
	jpeg_create_compress(&jpeg);
	jpeg_stdio_dest(&jpeg, out);
	jpeg.image_width = jpeg.image_height = side;
	jpeg.input_components = 3;
	jpeg.in_color_space = JCS_RGB;
	jpeg_set_defaults(&jpeg);
	jpeg_set_quality(&jpeg, QUALITY, TRUE);
	jpeg_start_compress(&jpeg, TRUE);
	for (uint32_t y = 0; y < side; y++) {
		paint_row(row, side, y, &state);
		jpeg_write_scanlines(&jpeg, &row, 1);
	}
	jpeg_finish_compress(&jpeg);
	jpeg_destroy_compress(&jpeg);
}

int main(int argc, char **argv)
{
	unsigned long side = argc == 4 ? strtoul(argv[2], NULL, 10) : 0;
	if (side < 1 || side > SIDE_MAX) {
		fprintf(stderr, "usage: paint OUT.jpg SIDE SEED, SIDE from 1 to %u\n", SIDE_MAX);
		return 2;
	}
	FILE *out = fopen(argv[1], "wb");
	uint8_t *row = malloc(3 * side);
	if (out && row)
		paint(out, (uint32_t)side, strtoull(argv[3], NULL, 10), row);
	bool written = out && row && !ferror(out);
	free(row);
	if ((out && fclose(out) != 0) || !written) {
		perror(argv[1]);
		return 1;
	}
	return 0;
}
