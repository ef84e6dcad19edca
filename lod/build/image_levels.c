#include "lod/build/image_levels.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/texture.h"
#include "lod/light.h"

#define SIDE ECO_GROUND_IMAGE_SIDE

/* Half as wide and high, into `to` with rows of `stride` texels. */
static void halve(const uint8_t *from, uint32_t side, uint8_t *to, uint32_t stride)
{
	for (uint32_t y = 0; y < side / 2; y++)
		for (uint32_t x = 0; x < side / 2; x++) {
			uint8_t *out = to + 4 * ((size_t)y * stride + x);
			struct lod_light sum = { .weight = 0 };
			for (uint32_t k = 0; k < 4; k++) {
				const uint8_t *texel =
					from + 4 * ((size_t)(2 * y + k / 2) * side + 2 * x + k % 2);
				lod_light_add(&sum, texel, texel[3]);
			}
			memset(out, 0, 4);
			lod_light_mean(&sum, out);
			out[3] = (uint8_t)((sum.weight + 2) / 4);
		}
}

void lod_image_join(uint8_t *rgba, const uint8_t *const quarters[4])
{
	for (uint32_t q = 0; q < 4; q++)
		halve(quarters[q], SIDE,
			rgba + 4 * (size_t)((q / 2 ? 0 : SIDE / 2) * SIDE + q % 2 * (SIDE / 2)), SIDE);
}

/* Returns how many channels it takes: 3 where all is opaque. */
static uint32_t fill_clear(uint8_t *rgba, uint32_t side)
{
	struct lod_light sum = { .weight = 0 };
	uint8_t mean[3] = { 0, 0, 0 };
	uint32_t channels = 3;
	for (size_t i = 0; i < (size_t)side * side; i++) {
		lod_light_add(&sum, rgba + 4 * i, rgba[4 * i + 3]);
		channels = rgba[4 * i + 3] == 255 ? channels : 4;
	}
	lod_light_mean(&sum, mean);
	for (size_t i = 0; i < (size_t)side * side && channels == 4; i++)
		if (!rgba[4 * i + 3])
			memcpy(rgba + 4 * i, mean, 3);
	return channels;
}

static enum eco_code write_level(struct eco_writer *w, uint8_t *rgba, uint32_t side, struct eco_error *error)
{
	struct eco_texture_part part = { side, side, fill_clear(rgba, side), rgba };
	uint8_t *rgb = part.channels == 3 ? malloc(3 * (size_t)side * side) : rgba;
	if (!rgb)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for %u x %u texels of ground", side, side);
	for (size_t i = 0; i < (size_t)side * side && part.channels == 3; i++)
		memcpy(rgb + 3 * i, rgba + 4 * i, 3);
	part.texels = rgb;
	enum eco_code code = eco_texture_write_colors(w, &part, ECO_TEXTURE_QUALITY, error);
	if (rgb != rgba)
		free(rgb);
	return code;
}

enum eco_code lod_image_levels(struct eco_writer *levels, const uint8_t *rgba, struct eco_error *error)
{
	uint8_t *now = malloc(4 * (size_t)SIDE * SIDE), *next = malloc((size_t)SIDE * SIDE);
	enum eco_code code = now && next ? ECO_OK
		: eco_fail(error, ECO_NO_MEMORY, "no memory for %u x %u texels of ground", SIDE, SIDE);
	uint32_t side = SIDE;
	if (!code)
		memcpy(now, rgba, 4 * (size_t)SIDE * SIDE);
	for (uint32_t i = ECO_GROUND_IMAGE_LEVELS; i-- > 0 && !code; side /= 2) {
		if (i)
			halve(now, side, next, side / 2);
		code = write_level(&levels[i], now, side, error);
		if (i)
			memcpy(now, next, (size_t)side * side);
	}
	free(now);
	free(next);
	return code;
}
