/* An impostor: one splat with pictures. Parallel pictures of a plant from directions all around show which
 * texels it covers, how deep it lies there, and its colours. What is seen from any direction is put together
 * from the pictures of the nearest directions (lod/impostor.h).
 *
 * The plant stands in an upright cylinder. A picture (tile) of direction d (unit, from the plant to who
 * looks) has the axes
 *   right = (-sin a, cos a, 0)        a: azimuth of d, 0 for d = +z
 *   up    = d x right
 * and reaches from -wide to wide along `right` and from -s to s along `up`, s = high |cos e| + wide |sin e|
 * for the elevation e of d; rows go from the top. Nothing of the plant lies outside.
 *
 * Directions are those of rings of equal elevation, ECO_IMPOSTOR_FEW or _MANY of them, from the horizon up.
 * Seen from the opposite direction a plant covers the same pixels, mirrored: so half a horizon is enough, and
 * nothing is needed below it.
 *
 * Levels are alternatives, each complete in itself, the smallest first:
 *
 *   level  directions  texels     depths           colours (always of ECO_IMPOSTOR_FEW)
 *   0      few         16 x 16    4 x 4 of 8       4 x 4
 *   1      many        32 x 32    8 x 8 of 8       8 x 8
 *   2      many        64 x 64    16 x 16 of 16    16 x 16
 *
 * In a list of impostors a level is a primitive and a chunk (list.h). Bytes of a level:
 *   0         24       the body
 *   24        u8       level | gaps << 4
 *   25        varint   n: bytes of texels and depths
 *   ..        u8       zeros at the end of these that are not stored
 *   ..        n bytes  a range coder's stream (ecofiles/base/range.h)
 *   ..        u8       zeros that are not stored of the colours
 *   ..        the rest: another stream
 *
 * A texel is coded by its neighbours in the same tile and by how the two nearest tiles before it show the
 * point where it lies; depths and colours as differences to what their neighbours predict. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/base/status.h"

#define ECO_IMPOSTOR_LEVELS 3u
#define ECO_IMPOSTOR_TEXELS_MAX 64u      /* a side */
#define ECO_IMPOSTOR_TILES_MAX 95u
#define ECO_IMPOSTOR_RINGS_MAX 7u
#define ECO_IMPOSTOR_COLORS 32u          /* codes of a channel */
#define ECO_IMPOSTOR_GAPS 16u            /* codes of gaps */

/* Shared by all levels, metres in plant space. */
struct eco_impostor_body {
	float center[3], wide, high;     /* of the cylinder; its radius, half its height */
	/* half the plant's thickness in the middle of a tile; it falls off as that of an ellipsoid */
	float thick;
};
#define ECO_IMPOSTOR_BODY_BYTES 24u
bool eco_impostor_body_good(const struct eco_impostor_body *body);
void eco_impostor_body_write(struct eco_writer *w, const struct eco_impostor_body *body);
/* ECO_DAMAGED where bytes end, or say what no plant has. */
enum eco_code eco_impostor_body_read(struct eco_reader *r, struct eco_impostor_body *body,
	struct eco_error *error);
/* Radius of the sphere around the cylinder. */
float eco_impostor_radius(const struct eco_impostor_body *body);

/* ---- Directions ---- */

enum eco_impostor_set { ECO_IMPOSTOR_FEW, ECO_IMPOSTOR_MANY };
struct eco_impostor_ring {
	double sine, cosine;         /* of the elevation */
	uint32_t first, stored;      /* tiles */
	uint32_t count;              /* directions; twice as many as tiles on the horizon */
};
struct eco_impostor_rings { uint32_t count; struct eco_impostor_ring items[ECO_IMPOSTOR_RINGS_MAX]; };
struct eco_impostor_axes { double toward[3], right[3], up[3]; };

uint32_t eco_impostor_tiles(enum eco_impostor_set set);
void eco_impostor_rings(enum eco_impostor_set set, struct eco_impostor_rings *rings);
/* The axes of all tiles. Deterministic. */
void eco_impostor_axes(enum eco_impostor_set set, struct eco_impostor_axes axes[ECO_IMPOSTOR_TILES_MAX]);
/* How far a tile reaches up and down, metres. */
double eco_impostor_reach_up(const struct eco_impostor_body *body, const struct eco_impostor_axes *axes);

/* ---- Levels ---- */

/* texels, depths and colours a side; codes of depths */
struct eco_impostor_size { enum eco_impostor_set set; uint32_t texels, depths, depth_codes, colors; };
extern const struct eco_impostor_size eco_impostor_sizes[ECO_IMPOSTOR_LEVELS];

/* Rows from the top, tile by tile; owns its arrays. */
struct eco_impostor_level {
	uint32_t level;
	uint32_t gaps;               /* the share of a covered texel that shows what is behind, in 1/16 */
	uint8_t *texel;              /* 1: covered, else 0 */
	/* the middle between the nearest and the farthest surface, along `toward` from the centre:
	 * depth_codes from -1 to 1 radius */
	uint8_t *depth;
	uint8_t *color;              /* red, green, blue: sRGB bytes * 31 / 255 */
};

/* Zeroed arrays. ECO_NO_MEMORY leaves nothing to free. */
enum eco_code eco_impostor_level_make(struct eco_impostor_level *level, uint32_t number,
	struct eco_error *error);
void eco_impostor_level_free(struct eco_impostor_level *level);
/* Cells of one kind, depths or a channel of colours: `side` x `side` in each tile, `apart` bytes between
 * neighbours, with so many codes. */
struct eco_impostor_cells { uint8_t *at; uint32_t tiles, side, apart, codes; };
struct eco_impostor_cells eco_impostor_depth_cells(const struct eco_impostor_level *level);
struct eco_impostor_cells eco_impostor_color_cells(const struct eco_impostor_level *level, uint32_t channel);
static inline uint8_t *eco_impostor_cell(const struct eco_impostor_cells *cells, uint32_t tile, uint32_t x,
	uint32_t y)
{
	return cells->at + (((size_t)tile * cells->side + y) * cells->side + x) * cells->apart;
}
/* The code that takes the fewest bytes, by those in the cells before. */
uint8_t eco_impostor_predict(const struct eco_impostor_cells *cells, uint32_t tile, uint32_t x, uint32_t y);

/* Appends the level's bytes; *shape_bytes (or NULL): those that are not colour. Values are trusted to be in
 * range. ECO_NO_MEMORY. */
enum eco_code eco_impostor_level_write(struct eco_writer *w, const struct eco_impostor_body *body,
	const struct eco_impostor_level *level, size_t *shape_bytes, struct eco_error *error);
/* Reads what was written, all `size` bytes, and sets *body. Values are in range whatever the bytes say; what
 * could not have been written is ECO_DAMAGED. */
enum eco_code eco_impostor_level_read(struct eco_impostor_level *level, struct eco_impostor_body *body,
	const uint8_t *bytes, size_t size, struct eco_error *error);

static inline float eco_impostor_depth(uint8_t code, uint32_t depth_codes)
{
	return 2 * (float)code / (float)(depth_codes - 1) - 1;
}
static inline uint8_t eco_impostor_color(uint8_t code) { return (uint8_t)((code * 255u + 15) / 31); }
