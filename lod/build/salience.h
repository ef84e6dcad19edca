/* Importance from colours that stand out (Deussen 2002, 4.3: "objects seem to be important if their color is clearly distinguishable from
 * the majority of element colors in a plant"): petals and fruit of a colour that few leaves have keep more of their vertices.
 *
 * What stands out is told by how much of the plant's leaf area differs clearly from a group's mean colour: 1 up to half of it, rising to
 * LOD_SALIENCE_MOST where nearly all of it does. So a plant of one colour, or of two in equal parts, has nothing that is important. Hue and
 * saturation count for more than brightness, which light changes. */
#ifndef LOD_SALIENCE_H
#define LOD_SALIENCE_H

#include <stdint.h>

#define LOD_SALIENCE_MOST 2.0        /* as much as is usual to ask for by hand */

/* Area, and colours by area. Zero at first. */
struct lod_tone { double area, rgb[3]; };
void lod_tone_add(struct lod_tone *tone, const uint8_t rgb[3], double area);

/* All leaves of a plant, in coarse bins of colour. Zero at first. */
#define LOD_SALIENCE_BINS 4096
struct lod_salience { struct lod_tone bins[LOD_SALIENCE_BINS]; double area; };
void lod_salience_add(struct lod_salience *plant, const uint8_t rgb[3], double area);

/* Of a group of the plant's leaves, from 1 on. 1 where either has nothing. */
double lod_salience_of(const struct lod_salience *plant, const struct lod_tone *group);

#endif
