/* Tones: a far plant is drawn by the first few of its leaves, enlarged, and orders ignore colours. So the
 * points that stand for leaves get colours whose means, octave by octave of the order, are the mean of the
 * visible surface. Pure and deterministic.
 *
 *   lod_tone_seen(seen, &input, &arena);               pixels of each element, by views from all around
 *   lod_tone_level(rgb, area, seen, count);            colours of one list, in its order */
#pragma once

#include "lod/build/element.h"
#include "lod/raster/raster.h"

struct lod_tone_input {
	const struct lod_mesh *mesh;
	const struct lod_elements *elements;     /* other triangles hide, and count for nothing */
};

/* seen[i]: the number of pixels in which element i is nearest, cut-outs taken as whole. */
void lod_tone_seen(uint32_t *seen, const struct lod_tone_input *input, struct lod_arena *arena);

/* Counts for each item the pixels in which it is nearest, in pictures of a sphere from all around. `draw`
 * draws everything; names: per item, 1 + the number that it counts for, or 0; NULL: its own. */
struct lod_tone_views {
	double center[3], radius;
	void (*draw)(const void *ctx, struct lod_raster *raster);
	const void *ctx;
	const uint32_t *names;
};
void lod_tone_count(uint32_t *seen, const struct lod_tone_views *views);

/* rgb[0..count) in an order; area: of each, at least 0. If there are at most LOD_TONE_COLORS colours the
 * results are among them (assigned with as few changes as the means allow), so that the plant's palette
 * stays. */
#define LOD_TONE_COLORS 32u
void lod_tone_level(uint8_t (*rgb)[3], const double *area, const uint32_t *seen, uint32_t count);
