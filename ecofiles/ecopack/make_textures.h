/* Textures of a pack belong to no plant: models that show one image, at whatever size, share its lists, and
 * a stream sends them once. Levels halve from the image (lod/build/texture.h), so fewer levels are the first
 * ones of more: the most that a plant needs serve all. */
#ifndef ECO_MAIN_MAKE_TEXTURES_H
#define ECO_MAIN_MAKE_TEXTURES_H

#include "ecofiles/ecopack/make.h"
#include "ecofiles/format/texture.h"

struct make_texture {
	uint32_t count;              /* of levels */
	bool outlined;
	struct eco_chunk_id colors[ECO_TEXTURE_LEVELS_MAX], outlines[ECO_TEXTURE_LEVELS_MAX];
	float texel_area;            /* of the last level, on the plant where it is largest */
	void *from;                  /* the caller's: where its levels come from */
	uint32_t list;               /* in the pack, once it is there; before, the caller's */
};

/* Where a texture is in m->textures, which it joins, or makes finer, if need be. */
enum eco_code make_share_texture(struct make *m, const struct make_texture *texture, uint32_t *at);

/* Packs the textures of all plants, and sets their `images`. */
enum eco_code make_textures(struct make *m);

#endif
