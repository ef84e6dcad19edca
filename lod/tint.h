/* Tints: colours that rows of an inventory give to plants. A tint takes LOD_TINT_SHARE of a plant's own
 * colour and keeps its shades, so that leaves differ as before, dark plants stay darker than light ones, and
 * two species of one class are told apart (Neubert 2011, section 5: variation within and between plants).
 * Wood keeps its colour where the plant has leaves; splats and impostors mix both, and their colour says how
 * much of it is wood. Colours are sRGB / 255, whose squares are nearly light. The text is shared with shaders
 * (client-min/draw/view_shader.c). */
#pragma once

#include <math.h>
#include <stdint.h>

#define LOD_TINT_SHARE 0.8 /* by eye: with .6 classes of dark and light plants mix, with 1 all leaves have one hue */
/* How light leaves are beside usual ones, 95, 127, 79; dark ones less dark, so that their tint is still seen.
 * r, g, b: their light, without wood's. Linear: the mean of leaves, a splat, has the mean of their shades. */
#define LOD_TINT_SHADE(wood, r, g, b) (0.4 * (1.0 - wood) + 0.6 * (0.96 * r + 3.23 * g + 0.33 * b))
#define LOD_TINT_MIX(root, least, light, leaves, tint, shade) \
	root(least(light - LOD_TINT_SHARE * leaves + LOD_TINT_SHARE * shade * tint * tint, 1.0))

/* The share of a colour that is wood: linear in light, in which wood and leaves mix. Below 0: none, above 1: all. */
#define LOD_TINT_WOOD(share, r, g, b) (share[0] * r + share[1] * g + share[2] * b + share[3])
struct lod_tint_wood { float share[4], light[3]; };      /* light: of wood alone; of a list: eco_list.wood */

/* An instance's tint as one word: 0: none; red in the lowest byte, and this bit: it has no leaves, so wood too. */
#define LOD_TINT_WHOLE (1u << 24)

static inline uint32_t lod_tint_word(const uint8_t rgb[3]) { return rgb[0] | (uint32_t)rgb[1] << 8 | (uint32_t)rgb[2] << 16; }

static inline float lod_tint_light(uint8_t byte) { return byte / 255.0f * (byte / 255.0f); }

/* The code: signed bytes, the factors' lowest. */
#define LOD_TINT_FACTOR 4.0      /* units of a factor and of the constant */
#define LOD_TINT_CONSTANT 16.0
static inline struct lod_tint_wood lod_tint_wood(uint32_t code, const uint8_t rgb[3])
{
	struct lod_tint_wood wood;
	for (int k = 0; k < 4; k++)
		wood.share[k] = (float)((int8_t)(code >> 8 * k) / (k < 3 ? LOD_TINT_FACTOR : LOD_TINT_CONSTANT));
	for (int k = 0; k < 3; k++)
		wood.light[k] = lod_tint_light(rgb[k]);
	return wood;
}

/* Tints rgb. from: the colour that wood is a share of, which a leaf's tone may have changed to rgb. wood: NULL: none. */
static inline void lod_tint_apply(uint32_t word, const struct lod_tint_wood *wood, const uint8_t from[3],
	uint8_t rgb[3])
{
	float of[3], light[3], leaves[3], share = 0;
	for (int k = 0; k < 3; k++)
		of[k] = lod_tint_light(from[k]);
	if (wood)
		share = fminf(fmaxf(LOD_TINT_WOOD(wood->share, of[0], of[1], of[2]), 0), 1);
	for (int k = 0; k < 3; k++) {
		light[k] = lod_tint_light(rgb[k]);
		leaves[k] = light[k] * (share > 0 ? 1 - fminf(share * wood->light[k] / fmaxf(of[k], 1e-4f), 1) : 1);
	}
	float shade = (float)LOD_TINT_SHADE(share, leaves[0], leaves[1], leaves[2]);
	for (int k = 0; k < 3 && word; k++) {
		float tint = (float)(word >> 8 * k & 255) / 255.0f;
		rgb[k] = (uint8_t)(255 * LOD_TINT_MIX(sqrt, fmin, light[k], leaves[k], tint, shade) + 0.5);
	}
}
