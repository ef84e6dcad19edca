/* Tints: colours that rows of an inventory give to plants. A tint takes LOD_TINT_SHARE of a plant's own colour and keeps
 * its shades, so that leaves differ as before, dark plants stay darker than light ones, and two species of one class are
 * told apart (Neubert 2011, section 5: variation within and between plants). Wood keeps its colour where the plant has
 * leaves; splats and impostors hold both, and only splats know what is wood. Colours are sRGB / 255, whose squares
 * are nearly light. The text is shared with shaders (client-min/draw/view_shader.c). */
#ifndef LOD_TINT_H
#define LOD_TINT_H

#include <math.h>
#include <stdint.h>

#define LOD_TINT_SHARE 0.8       /* by eye: with .6 classes of dark and light plants mix, with 1 all leaves have one hue */
/* How light a colour is beside usual leaves, 95, 127, 79; dark ones less dark, so that their tint is still seen. Linear in
 * light: the mean of leaves, a splat, has the mean of their shades */
#define LOD_TINT_SHADE(r, g, b) (0.4 + 0.6 * (0.96 * r * r + 3.23 * g * g + 0.33 * b * b))
#define LOD_TINT_MIX(root, least, own, tint, shade) \
	root(least((1.0 - LOD_TINT_SHARE) * own * own + LOD_TINT_SHARE * shade * tint * tint, 1.0))

/* An instance's tint as one word: 0: none; red in the lowest byte, and this bit: it has no leaves, so wood too. */
#define LOD_TINT_WHOLE (1u << 24)

static inline uint32_t lod_tint_word(const uint8_t rgb[3]) { return rgb[0] | (uint32_t)rgb[1] << 8 | (uint32_t)rgb[2] << 16; }

static inline void lod_tint_apply(uint32_t word, uint8_t rgb[3])
{
	float own[3] = { rgb[0] / 255.0f, rgb[1] / 255.0f, rgb[2] / 255.0f };
	float shade = (float)LOD_TINT_SHADE(own[0], own[1], own[2]);
	for (int k = 0; k < 3 && word; k++)
		rgb[k] = (uint8_t)(255 * LOD_TINT_MIX(sqrt, fmin, own[k], (float)(word >> 8 * k & 255) / 255.0f, shade) + 0.5);
}

#endif
