/* What a graphics card is given for a cut-out image: filtering and mip levels mix clear texels in, whatever
 * colour the file has there. */
#ifndef CLIENT_VIEW_TEXTURE_H
#define CLIENT_VIEW_TEXTURE_H

#include "ecofiles/format/image.h"

/* A copy of the image's pixels (RGBA, width x height, malloc'ed; NULL without memory) in which clear texels,
 * of an alpha below 128, have the colour of the opaque ones nearest to them, as they are in the mean:
 * pull-push (Gortler et al. 1996, section 3.4.1). Alpha stays, and so does an image that is clear all over.
 * An atlas keeps apart what lies far apart: with one mean for all of it, leaves took the colour of bark. */
uint8_t *view_texture_fill(const struct eco_image *image);

#endif
