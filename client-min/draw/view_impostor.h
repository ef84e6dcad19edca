/* Levels of impostors as the shaders read them: 16-byte texels (view_record.h), of words a level's own:
 *
 *   head       { centre.xyz, radius }
 *              { thick, sides, counts, start of colours }   sides: of texels, depths and colours, and
 *                                                           codes of depths; counts: rings, tiles of
 *                                                           colours; a byte each
 *              { start of tiles, of tiles of colours, of texels, of depths }
 *   rings      { sine, cosine, first tile | tiles << 8 | directions << 16, 0 }
 *   tiles      { right.x, up.x, toward.x, right.y } { up.y, toward.y, up.z, toward.z }
 *              the axes of struct lod_impostor_tile; right.z is 0
 *   texels     1 bit each, depths 4 bits, colours 16: red, green << 5, blue << 10. Tile by tile, rows from
 *              the top, in words from the lowest bit up
 *
 * Starts are in texels from the head. All parts begin with a texel. */
#ifndef VIEW_IMPOSTOR_H
#define VIEW_IMPOSTOR_H

#include "ecofiles/format/list.h"
#include "lod/impostor.h"

uint32_t view_impostor_texels(const struct lod_impostor *impostor);
/* 4 * view_impostor_texels words. */
void view_impostor_write(const struct lod_impostor *impostor, uint32_t *words);

/* The surface of its pixels (view_light.h): points as large as texels. */
uint32_t view_impostor_surface(const struct eco_list *list, const struct lod_impostor *impostor);

#endif
