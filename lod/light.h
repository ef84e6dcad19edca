/* Colours as bytes are sRGB; means of colours are means of light. The table is rounded from the standard's formula (IEC 61966-2-1), so
 * that no libm decides a byte: sRGB byte -> light in 1/65535. It rises strictly, so a byte survives the way there and back. */
#ifndef LOD_LIGHT_H
#define LOD_LIGHT_H

#include <stdint.h>

extern const uint16_t lod_light_of[256];

/* The byte whose light is nearest; `light` in 1/65535, beyond the ends clamped. */
uint8_t lod_light_byte(double light);

/* A sum of colours by weight, and its mean. */
struct lod_light { double sum[3], weight; };

static inline void lod_light_add(struct lod_light *light, const uint8_t rgb[3], double weight)
{
	for (int k = 0; k < 3; k++)
		light->sum[k] += weight * lod_light_of[rgb[k]];
	light->weight += weight;
}

/* Leaves rgb as it is where nothing was added. */
void lod_light_mean(const struct lod_light *light, uint8_t rgb[3]);

#endif
