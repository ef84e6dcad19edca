#include "lod/raster/blocks.h"

#include <math.h>
#include <stdlib.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/order.h"
#include "lod/light.h"
#include "lod/raster/flip.h"

static struct lod_block block_of(const uint8_t *rgb, uint32_t width, uint32_t columns, uint32_t rows)
{
	double light[3] = { 0, 0, 0 }, sum = 0, squares = 0, lab[3], count = (double)columns * rows;
	struct lod_block block = { .pixels = columns * rows };
	for (uint32_t y = 0; y < rows; y++)
		for (uint32_t x = 0; x < columns; x++) {
			const uint8_t *pixel = rgb + 3 * ((size_t)y * width + x);
			double here[3];
			for (int k = 0; k < 3; k++) {
				here[k] = lod_light_of[pixel[k]] / 65535.0;
				light[k] += here[k] / count;
			}
			lod_lab(here, lab);
			sum += lab[0];
			squares += lab[0] * lab[0];
		}
	lod_lab(light, block.lab);
	block.deviation = sqrt(fmax(squares / count - sum / count * (sum / count), 0));
	return block;
}

void lod_blocks_make(struct lod_block *blocks, uint32_t width, uint32_t height, const uint8_t *rgb)
{
	const uint32_t side = LOD_BLOCK_SIDE;
	for (uint32_t y = 0; y < height; y += side)
		for (uint32_t x = 0; x < width; x += side)
			*blocks++ = block_of(rgb + 3 * ((size_t)y * width + x), width, width - x < side ? width - x
				: side, height - y < side ? height - y : side);
}

static double distance(const struct lod_block *a, const struct lod_block *b)
{
	double sum = 0;
	for (int k = 0; k < 3; k++)
		sum += (a->lab[k] - b->lab[k]) * (a->lab[k] - b->lab[k]);
	return sqrt(sum);
}

void lod_blocks_compare(struct lod_block_error *error, const struct lod_block *test,
	const struct lod_block *reference, uint32_t count)
{
	double pixels = 0;
	*error = (struct lod_block_error){ 0 };
	for (uint32_t i = 0; i < count; i++) {
		double n = test[i].pixels, more = test[i].deviation - reference[i].deviation;
		error->color += n * distance(&test[i], &reference[i]);
		error->contrast += n * more;
		error->contrast_abs += n * fabs(more);
		pixels += n;
	}
	error->color /= pixels;
	error->contrast /= pixels;
	error->contrast_abs /= pixels;
}

ECO_ORDER_FALLING(descending, double, [0])

double lod_blocks_pop(const struct lod_block *before, const struct lod_block *after, uint32_t count)
{
	double *apart = eco_alloc(count, sizeof *apart);
	uint32_t whole = 0;
	for (uint32_t i = 0; i < count; i++)
		if (before[i].pixels == LOD_BLOCK_SIDE * LOD_BLOCK_SIDE)
			apart[whole++] = distance(&before[i], &after[i]);
	qsort(apart, whole, sizeof *apart, descending);
	double pop = whole ? apart[whole / 1000] : 0;
	free(apart);
	return pop;
}
