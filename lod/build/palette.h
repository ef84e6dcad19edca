/* A few colours for many, such as a plant's: exactly these if they are few, else by median cut, each the mean
 * light of the colours that it replaces. A pure function of the colours. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "lod/arena.h"

#define LOD_PALETTE_MAX 64u
#define LOD_PALETTE_NONE UINT16_MAX

struct lod_palette {
	uint32_t count;
	uint8_t rgb[LOD_PALETTE_MAX][3];
	uint16_t bin[32768]; /* by the upper five bits of red, green, blue: the entry, or LOD_PALETTE_NONE */
	bool exact;
};

/* At most `most` (1 to LOD_PALETTE_MAX) entries; weights[i] is how often colour i is used (0 counts as 1). */
void lod_palette_make(struct lod_palette *palette, uint32_t most, const uint8_t (*rgb)[3],
	const uint32_t *weights, uint32_t count, struct lod_arena *arena);
/* The entry of a colour that the palette was made of; the nearest entry for any other. */
uint32_t lod_palette_index(const struct lod_palette *palette, const uint8_t rgb[3]);
