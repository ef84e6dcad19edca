/* What lies under a triangle of a textured leaf: colours and, for cut-outs, whether there is anything at all. Texels are looked up as
 * the rasteriser does: nearest, wrapping, opaque from alpha 0.5 on. */
#ifndef LOD_TEXEL_H
#define LOD_TEXEL_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/model.h"

/* RGBA at uv (any finite numbers; (0,0) is the top left). */
const uint8_t *lod_texel_at(const struct eco_image *image, double u, double v);

/* True only if no texel that a sample of the triangle could read, however it is rounded or filtered, is opaque: texels are looked
 * at two wide around it. Triangles over too many texels to look at count as visible. uv as in struct lod_mesh. */
bool lod_texel_hidden(const struct eco_image *image, const int32_t uv[6]);

/* Mean colour of the opaque texels under the triangle by 16 samples (all samples where `cutout` is false), times the material's
 * colour. Returns the share of samples that were opaque; 0 leaves rgb the material's colour. */
double lod_texel_mean(const struct eco_image *image, bool cutout, const uint8_t tint[3], const int32_t uv[6], uint8_t rgb[3]);

/* The material's colour times the texel. */
void lod_texel_tint(const uint8_t *texel, const uint8_t tint[3], uint8_t rgb[3]);

#endif
