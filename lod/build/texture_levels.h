/* The levels of an image of a model, before they are encoded (lod/build/texture.h).
 *
 *   lod_texture_levels_make(&levels, &model, image, &error);
 *   ... levels.levels[0 .. count), smallest first ...
 *   lod_texture_levels_free(&levels);
 *
 * Levels halve until TEXTURE_SMALLEST. Each is as opaque as the finest, everywhere: what its texels would be
 * in part is diffused (Floyd and Steinberg 1976). One threshold for all of it, chosen so that as much is
 * opaque (Castaño 2010, "Computing alpha mipmaps"), lost whole crowns of leaves finer than a texel. Colours
 * are means of light over opaque texels; clear texels take those of the opaque ones around them, by pull-push
 * (Gortler et al. 1996, section 3.4.1), which costs few bytes and bleeds nothing into the rest.
 *
 * Texels that nobody can resolve are left out: the finest level is the coarsest whose texels are no larger
 * than a pixel of a picture 1080 pixels high, of 45 degrees, taken 1 m from the plant. */
#ifndef LOD_TEXTURE_LEVELS_H
#define LOD_TEXTURE_LEVELS_H

#include "ecofiles/format/texture.h"

struct lod_texture_level { struct eco_texture_part outline, colors; };
struct lod_texture_levels {
	struct lod_texture_level levels[ECO_TEXTURE_LEVELS_MAX];
	uint32_t count;
	float texel_area;            /* as of struct lod_texture; 0: no triangle shows the image */
};

enum eco_code lod_texture_levels_make(struct lod_texture_levels *levels, const struct eco_model *model,
	uint32_t image, struct eco_error *error);
void lod_texture_levels_free(struct lod_texture_levels *levels);

#endif
