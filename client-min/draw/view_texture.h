/* A texture as software draws it. */
#ifndef CLIENT_VIEW_TEXTURE_H
#define CLIENT_VIEW_TEXTURE_H

#include "ecofiles/format/model.h"

/* The mean light (1/65535) of the opaque texels under a pixel, which in software takes the place of
 * filtering: uv at the pixel's centre, and one pixel to the right and one down. A pixel within a texel mixes
 * it with its neighbours. Where nothing is opaque it is the texel at the centre. */
void view_texture_mean(const struct eco_image *image, const double uv[3][2], double light[3]);

#endif
