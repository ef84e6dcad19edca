/* Lists as the shaders read them: records of 16-byte texels, a fixed number a primitive, in draw order.
 * Vertices are pulled by number (gl_VertexID), so that lines and points become quads without a vertex buffer
 * of their own, and a cut's [first, end) is a draw call's range.
 *
 *   triangle   { p0.xyz, colour } { p1.xyz, centre.x } { p2.xyz, centre.y } { centre.z, u0, v0, u1 } and,
 *              with uv, { v1, u2, v2, 0 }
 *   line       { a.xyz, width } { b.xyz, colour }
 *   point      { p.xyz, colour } and, in summaries, { owner low, owner high, key mask, 0 }
 *   splat      { p.xyz, colour } { half axis.xyz, 0 } three times
 *   ground     { column, row, height as whole steps; normal.x, .y as two signed 1/32767 }
 *   impostor   a level, in words of its own: see below
 *
 * A summary point's owner is that of placement path 0; the key's field lies in the high word, where a path is
 * added modulo its mask. Floats are stored as their bits; colour is r | g << 8 | b << 16 | code << 24, sRGB;
 * code is the growth code of the triangle's element (ECO_GROWTH_PLAIN where the list has none), the size code
 * of a point (ECO_SIZE_ONE), the opacity of a splat in 1/16, and VIEW_WOOD of wood. The shader gets the
 * meaning of codes in uniforms that eco_growth and eco_size filled: neither is written twice. */
#pragma once

#include "client-min/view_select.h"

#define VIEW_TEXEL_BYTES 16u
#define VIEW_WOOD 0x80000000u

/* Per primitive; not of impostors, whose levels differ. */
uint32_t view_record_texels(const struct eco_list *list);
/* The texels of chunks [first, end). */
uint64_t view_record_span(const struct view_list *list, uint32_t first_chunk, uint32_t end_chunk);

/* Writes the records of chunks [first, end) of a list: view_record_span * 4 words. */
enum eco_code view_record_write(const struct view_list *list, uint32_t first_chunk, uint32_t end_chunk,
	uint32_t *words, struct eco_error *error);

/* The part of the high word of a summary point's owner that placement path `path` adds. */
uint32_t view_record_path(uint32_t path);

/* ---- Impostors ---- */

/* Levels of impostors:
 *
 *   head       { centre.xyz, radius }
 *              { thick, sides, counts, start of colours }   sides: of texels, depths and colours, and
 *                                                           codes of depths; counts: rings, tiles of
 *                                                           colours, 16 - gaps; a byte each
 *              { start of tiles, of tiles of colours, of texels, of depths }
 *   rings      { sine, cosine, first tile | tiles << 8 | directions << 16, 0 }
 *   tiles      { right.x, up.x, toward.x, right.y } { up.y, toward.y, up.z, toward.z }
 *              the axes of struct lod_impostor_tile; right.z is 0
 *   texels     1 bit each, depths 4 bits, colours 16: red, green << 5, blue << 10. Tile by tile, rows from
 *              the top, in words from the lowest bit up
 *
 * Starts are in texels from the head. All parts begin with a texel. */
uint32_t view_impostor_texels(const struct lod_impostor *impostor);
/* 4 * view_impostor_texels words. */
void view_impostor_write(const struct lod_impostor *impostor, uint32_t *words);
/* The surface of its pixels (view_light.h). */
uint32_t view_impostor_surface(const struct eco_list *list);

/* ---- Instances ---- */

/* Four texels: the rows of object -> view, then the instance's scale, half the width of its plant, rounded to
 * the upper half of a word, over its salt, its width and its tint; plant: NULL for a summary's. */
#define VIEW_INSTANCE_TEXELS 4
void view_instance_write(uint32_t *words, const struct lod_eye *eye, const struct view_instance *instance,
	const struct view_plant *plant);
