/* Tones of an order's beginnings. A far plant is drawn by the first few of its leaves, made larger, and these have to look like all that is
 * seen of it. Orders do not look at colours, but what they put first, leaves inside the crown for instance, often has a colour of its own:
 * then a far forest is darker than a near one. So the points that stand for leaves get colours whose means, octave by octave of the order,
 * are the mean of what is seen of the whole plant.
 *
 *   lod_tone_seen(seen, &input, &arena);               pixels of each element, by views from all around
 *   lod_tone_level(rgb, area, seen, count);            colours of one list, in its order
 *
 * Pure and deterministic. */
#ifndef LOD_TONE_H
#define LOD_TONE_H

#include "lod/build/element.h"
#include "lod/eye.h"

struct lod_tone_input {
	const struct lod_mesh *mesh;
	const struct lod_elements *elements;     /* what belongs to none of them hides, and counts for nothing */
};

/* seen[i]: in how many pixels element i is nearest. What textures cut out counts as there. All 1 where it cannot be found out: no memory, or more
 * elements than a pixel can name. */
void lod_tone_seen(uint32_t *seen, const struct lod_tone_input *input, struct lod_arena *arena);

/* A view of LOD_TONE_PIXELS squared of a sphere from afar; `from`: a unit vector towards the eye, as lod_directions_spread makes them. */
#define LOD_TONE_VIEWS 8u
#define LOD_TONE_PIXELS 160u
#define LOD_TONE_AWAY 16.0       /* radii */
void lod_tone_eye(struct lod_eye *eye, const double from[3], const double center[3], double radius);

/* rgb[0..count) in an order; area: of each, at least 0. Where all have at most LOD_TONE_COLORS colours, the results are among them (which is
 * which is changed by as little as the means ask for), so that a plant's palette stays as it is. */
#define LOD_TONE_COLORS 32u
void lod_tone_level(uint8_t (*rgb)[3], const double *area, const uint32_t *seen, uint32_t count);

#endif
