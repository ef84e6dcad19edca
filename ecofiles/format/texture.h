/* Textures: a list of kind IMAGE holds an image in levels, smallest first, each half as wide and high as the
 * next. If texels of it are clear, its own `image` is a list of kind OUTLINE, whose levels say where. So both
 * are prefixes of their own: an outline decides what is covered and takes few bytes, and colours that are
 * coarser than it are seen as little as those of a coarse mip level.
 *
 * A level is a primitive. Its chunks are strips of whole rows, from the top, so that none is large
 * (ECO_TEXTURE_CHUNK_BYTES); the last of them has the level's element and primitive, the others have none.
 *
 *   OUTLINE   a chunk: which texels of a strip are opaque
 *   IMAGE     a chunk: the colours of a strip: a WebP file, lossy, without alpha
 *
 * Outline (little-endian): u32 width, u32 height; nothing more where all texels are opaque, else one
 * range-coded stream (ecofiles/base/range.h), a bit a texel row by row, 1 for opaque, with a model for each
 * state of the ten texels before it that JBIG's three-line template looks at (ITU-T T.82; those outside the
 * image are clear), and at the end a byte: the zeros left off.
 *
 * No chunk needs another to be decoded. Which level a plan draws, its cut of the list says: the last of the
 * cut's prefix. */
#pragma once

#include <stdbool.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/format/model.h"
#include "ecofiles/format/pack.h"

#define ECO_TEXTURE_LEVELS_MAX 16u
#define ECO_TEXTURE_CHUNK_BYTES 16384u           /* a strip of more rows than _STRIP_ROWS has no more */
#define ECO_TEXTURE_STRIP_ROWS 16u
#define ECO_TEXTURE_SIDE_MAX 16383u              /* texels, of a level: WebP has no more */

/* An outline (channels 1: 255 opaque, 0 clear) or colours (channels 3: sRGB; of the ground's image 4, with
 * alpha, once they are read), rows from the top. */
struct eco_texture_part { uint32_t width, height, channels; uint8_t *texels; };
void eco_texture_part_free(struct eco_texture_part *part);
/* Adds the rows of a strip below those of `part`, which may be empty. ECO_DAMAGED: it is not as wide, has
 * other channels, or there are too many texels; *part is as it was. */
enum eco_code eco_texture_part_add(struct eco_texture_part *part, const struct eco_texture_part *strip,
	struct eco_error *error);

/* Appends a payload. Sides are 1 to ECO_TEXTURE_SIDE_MAX, texels at most ECO_PIXELS_MAX. The same texels give
 * the same bytes. */
enum eco_code eco_texture_write_outline(struct eco_writer *w, const struct eco_texture_part *part,
	struct eco_error *error);
enum eco_code eco_texture_write_colors(struct eco_writer *w, const struct eco_texture_part *part,
	struct eco_error *error);
/* Appends a level's strips, each a u32 of its size and its payload: an outline's or colours. */
enum eco_code eco_texture_write_strips(struct eco_writer *w, const struct eco_texture_part *level,
	struct eco_error *error);

/* Decodes the payload of a chunk of a list of kind OUTLINE, IMAGE or GROUND_IMAGE, which alone may have
 * alpha; part->texels is malloc'ed. ECO_DAMAGED: *part is empty. */
enum eco_code eco_texture_read(struct eco_texture_part *part, enum eco_list_kind kind, const uint8_t *bytes,
	size_t size, struct eco_error *error);

/* The same of a level of a pack's list, from its strips. */
enum eco_code eco_texture_read_level(struct eco_texture_part *part, const struct eco_pack *pack,
	const struct eco_list *list, uint32_t level, struct eco_error *error);

/* Texels that a payload says it has; 0 where it cannot be read. */
uint64_t eco_texture_texels(const uint8_t *bytes, size_t size, bool outline);

/* Colours cut out by an outline (NULL: opaque), as large as the larger of the two; texels of the other are
 * repeated. image->rgba is malloc'ed; its alpha is 0 or 255. */
enum eco_code eco_texture_show(struct eco_image *image, const struct eco_texture_part *colors,
	const struct eco_texture_part *outline, struct eco_error *error);
