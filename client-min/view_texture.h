/* A cut-out image as a graphics card needs it: filtering and mip levels mix clear texels in, whatever colour
 * the file has there. */
#ifndef CLIENT_VIEW_TEXTURE_H
#define CLIENT_VIEW_TEXTURE_H

#include "ecofiles/format/image.h"

/* A copy of the image's pixels (RGBA, width x height, malloc'ed; NULL without memory) in which clear texels,
 * of an alpha below 128, have the colour of the opaque ones nearest to them, as they are in the mean:
 * pull-push (Gortler et al. 1996, section 3.4.1). Alpha stays, and so does an image that is clear all over.
 * An atlas keeps apart what lies far apart: with one mean for all of it, leaves took the colour of bark. */
uint8_t *view_texture_fill(const struct eco_image *image);

/* The mean light (1/65535) of the opaque texels under a pixel, which in software takes the place of
 * filtering: uv at the pixel's centre, and one pixel to the right and one down. A pixel within a texel mixes
 * it with its neighbours. Where nothing is opaque it is the texel at the centre. */
void view_texture_mean(const struct eco_image *image, const double uv[3][2], double light[3]);

#endif
