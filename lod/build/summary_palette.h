/* The colours of the summaries of one eco file (summary.h): few, because each summary that is sent brings its
 * colours with it. They are exactly those of the points if these have few, else a palette of them, in which
 * colours weigh what they cover: a plant counts with its area, rounded down to a power of two of the file's.
 * So the colours stay, and with them the summaries, while a few plants come, go or move.
 *
 *   lod_summary_palette_make(&palette, &input, tile_first, tile_count, &error);
 *   input.color_of = palette.color_of;                      lod_summary_make(&summary, &input, ...)
 *   free(palette.color_of);
 *
 * A file takes nested files' colours from their stored summaries only, as it does their points. */
#ifndef LOD_SUMMARY_PALETTE_H
#define LOD_SUMMARY_PALETTE_H

#include "lod/build/summary.h"

#define LOD_SUMMARY_COLORS 32u

struct lod_summary_palette {
	uint8_t rgb[LOD_SUMMARY_COLORS][3];      uint32_t count; /* 0: the tiles show nothing */
	uint16_t *color_of;          /* per colour of the scene: its entry, 0 if no point has it; owned */
};

/* Colours of points in tiles [tile_first, tile_first + tile_count), which are all of one eco file. The tile,
 * its count and color_of of `input` are not read. */
enum eco_code lod_summary_palette_make(struct lod_summary_palette *palette,
	const struct lod_summary_input *input, uint32_t tile_first, uint32_t tile_count,
	struct eco_error *error);

#endif
