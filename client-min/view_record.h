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
 *   impostor   a level: see view_impostor.h
 *
 * A summary point's owner is that of placement path 0; the key's field lies in the high word, where a path is
 * added modulo its mask. Floats are stored as their bits; colour is r | g << 8 | b << 16 | code << 24, sRGB;
 * code is the growth code of the triangle's element (ECO_GROWTH_PLAIN where the list has none), the size code
 * of a point (ECO_SIZE_ONE), the opacity of a splat in 1/16. The shader gets the meaning of codes in uniforms
 * that eco_growth and eco_size filled: neither is written twice. */
#ifndef VIEW_RECORD_H
#define VIEW_RECORD_H

#include "client-min/view_store.h"

#define VIEW_TEXEL_BYTES 16u

/* Per primitive; not of impostors, whose levels differ. */
uint32_t view_record_texels(const struct eco_list *list);
/* The texels of chunks [first, end). */
uint64_t view_record_span(const struct view_list *list, uint32_t first_chunk, uint32_t end_chunk);

/* Writes the records of chunks [first, end) of a list: view_record_span * 4 words. */
enum eco_code view_record_write(const struct view_list *list, uint32_t first_chunk, uint32_t end_chunk,
	uint32_t *words, struct eco_error *error);

/* The part of the high word of a summary point's owner that placement path `path` adds. */
uint32_t view_record_path(uint32_t path);

#endif
