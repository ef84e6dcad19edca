/* From the texels of a square of ground to the levels of its tile (ecofiles/format/ground_image.h).
 *
 *   lod_image_join(rgba, quarters);                    a tile from its four children, where it has some
 *   lod_image_levels(levels, rgba, &error);            payloads, smallest first
 *
 * Means are means of light over what is opaque. Clear texels take the tile's mean, which costs few bytes. */
#ifndef LOD_IMAGE_LEVELS_H
#define LOD_IMAGE_LEVELS_H

#include "ecofiles/base/bytes.h"
#include "ecofiles/format/ground_image.h"

/* All of ECO_GROUND_IMAGE_SIDE texels a side, rows from the north; quarters as eco_ground_image_quarter
 * says. */
void lod_image_join(uint8_t *rgba, const uint8_t *const quarters[4]);

/* levels: ECO_GROUND_IMAGE_LEVELS writers that are zero; the caller frees them in any case. */
enum eco_code lod_image_levels(struct eco_writer *levels, const uint8_t *rgba, struct eco_error *error);

#endif
