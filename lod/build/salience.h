/* Importance from colours that stand out (Deussen 2002, 4.3: "objects seem to be important if their color is
 * clearly distinguishable from the majority of element colors in a plant"): petals and fruit in a rare colour
 * keep more of their vertices.
 *
 * A group's importance follows from the share of the plant's leaf area that clearly differs from the group's
 * mean colour: 1 up to half, rising to LOD_SALIENCE_MOST at all of it. So a plant of one colour, or of two in
 * equal parts, has no important group. Hue and saturation count more than brightness, which light changes. */
#ifndef LOD_SALIENCE_H
#define LOD_SALIENCE_H

#include <stdint.h>

#define LOD_SALIENCE_MOST 2.0        /* as much as users usually ask for */

/* Area, and the sum of colours weighted by it. Zero at first. */
struct lod_tone { double area, rgb[3]; };
void lod_tone_add(struct lod_tone *tone, const uint8_t rgb[3], double area);

/* All leaves of a plant, in coarse bins of colour. Zero at first. */
#define LOD_SALIENCE_BINS 4096
struct lod_salience { struct lod_tone bins[LOD_SALIENCE_BINS]; double area; };
void lod_salience_add(struct lod_salience *plant, const uint8_t rgb[3], double area);

/* Importance of a group of the plant's leaves, at least 1; 1 if either has no area. */
double lod_salience_of(const struct lod_salience *plant, const struct lod_tone *group);

#endif
