/* sRGB bytes and light. A mean of colours is a mean of light, not of bytes. The table is rounded from the
 * standard's formula (IEC 61966-2-1), so that no libm decides a byte. It rises strictly, so a byte survives
 * the way to light and back.
 *
 *   lod_light_of[byte]         light in 1/65535 */
#pragma once

#include <stdint.h>

extern const uint16_t lod_light_of[256];

/* The byte whose light is nearest; `light` is in 1/65535 and clamped. */
uint8_t lod_light_byte(double light);

/* The luminance of light (the standard's weights). */
static inline double lod_light_gray(const double light[3])
{
	return 0.2126 * light[0] + 0.7152 * light[1] + 0.0722 * light[2];
}

/* A sum of colours by weight. */
struct lod_light { double sum[3], weight; };

static inline void lod_light_add(struct lod_light *light, const uint8_t rgb[3], double weight)
{
	for (int k = 0; k < 3; k++)
		light->sum[k] += weight * lod_light_of[rgb[k]];
	light->weight += weight;
}

/* The mean of a sum; leaves rgb as it is if nothing was added. */
void lod_light_mean(const struct lod_light *light, uint8_t rgb[3]);
