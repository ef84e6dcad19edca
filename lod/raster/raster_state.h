/* The inside of the rasteriser, shared by raster.c (cameras, hiding, merging), raster_draw.c and
 * raster_splat.c (batches), raster_fill.c (pixels). */
#pragma once

#include <math.h>

#include "lod/lanes.h"
#include "lod/raster/raster.h"
#include "lod/splat.h"

/* Window coordinates are integers in 1/256 pixel. While they are floats they are counted from the picture's
 * middle: within LOD_GUARD every float rounds safely to an integer below 2^22, and no edge function exceeds
 * 2^48. Triangles that reach further are clipped there, far outside the largest picture. */
#define LOD_SUBPIXEL 256
#define LOD_GUARD 4096000.0f         /* 16,000 pixels */
#define LOD_BLOCK_SHIFT 3            /* coarse depth: blocks of 8 x 8 pixels */

struct lod_raster_state {
	struct lod_eye eye;
	struct lod_place place;
	uint32_t salt;                   /* of the place */
	double near_m;
	float near_w;
	float clip[3][4]; /* object -> x w, y w in 1/256 pixel from the picture's middle (y down), and w */
	float view[3][4];                /* object -> right, up, forward; metres from the eye */
	float project[3][4];             /* view -> as clip */
	uint32_t blocks_x, blocks_y;
	float *block;                    /* lower bound of the depths in a block; exact where not stale */
	uint8_t *stale;
	bool silhouette, ground;         /* ground: some has been drawn */
};

/* The pixels that a batch paints. */
struct lod_paint {
	const struct lod_raster *raster;
	const struct eco_image *cutout;
	const struct lod_mask *mask;     /* of cutout, or NULL */
	uint32_t item;                   /* of the primitive being drawn */
	uint64_t owner;
	uint8_t cover;
	bool silhouette;
	bool plain;                      /* a silhouette without ground: what is there cannot be nearer */
};

/* The paint of the batch's first primitive. */
static inline struct lod_paint lod_paint_make(struct lod_raster *raster, const struct lod_raster_batch *batch)
{
	raster->state->ground |= !batch->owner;
	bool silhouette = raster->state->silhouette && batch->owner;
	return (struct lod_paint){ .raster = raster, .owner = batch->owner, .cover = batch->owner ? 255 : 0,
		.silhouette = silhouette, .plain = silhouette && !raster->state->ground };
}

struct lod_corner { int32_t x, y; float z, u, v; };      /* x, y in 1/256 pixel from the top left; z = 1/w */

/* Four triangles, one a lane; arrays are indexed by corner, as lod_corner. first, last: pixels with centres
 * in the bounding box. */
struct lod_four { lod_i4 x[3], y[3]; lod_f4 z[3]; lod_i4 first_x, last_x, first_y, last_y; };
#define LOD_SMALL 8                  /* pixels */

/* Fills the triangle of three corners, wound either way, by the top-left rule. */
void lod_fill_triangle(const struct lod_paint *paint, const struct lod_corner corners[3]);
/* Fills those lanes of four, without a cut-out, whose boxes are at most LOD_SMALL pixels wide and high and
 * inside the picture. */
void lod_fill_small(const struct lod_paint *paint, const struct lod_four *four, unsigned lanes);
/* Fills pixels [from, to) of a row at depth z; from < to. */
void lod_fill_row(const struct lod_paint *paint, uint32_t row, uint32_t from, uint32_t to, float z);

/* True if all pixels of columns x[0] to x[1] and rows y[0] to y[1] are certainly nearer than 1/nearest. */
bool lod_blocks_hide(struct lod_raster *raster, const uint32_t x[2], const uint32_t y[2], float nearest);

/* The first pixel with its centre at or after `at`, and the last with its centre at or before it. */
static inline int32_t lod_pixel_from(int32_t at) { return (at + LOD_SUBPIXEL / 2 - 1) >> 8; }
static inline int32_t lod_pixel_to(int32_t at) { return (at - LOD_SUBPIXEL / 2) >> 8; }

static inline float lod_depth_clamp(float z, float low, float high)
{
	return z < low ? low : z > high ? high : z;
}

/* The nearer sample wins, of equal ones the smaller owner: a total order, so the order of drawing does not
 * matter. */
static inline bool lod_sample_wins(float z, uint64_t owner, float z_there, uint64_t owner_there)
{
	return z > z_there || (z == z_there && z > 0 && owner < owner_there);
}

/* Paints pixel i if the sample wins over the one there. */
static inline bool lod_paint_pixel(const struct lod_paint *paint, size_t i, float z)
{
	const struct lod_raster *raster = paint->raster;
	if (!(z >= raster->depth[i]))
		return false;
	if (!(raster->owner ? lod_sample_wins(z, paint->owner, raster->depth[i], raster->owner[i])
		: lod_sample_wins(z, paint->cover, raster->depth[i], raster->cover[i])))
		return false;
	raster->depth[i] = paint->silhouette ? INFINITY : z;
	if (raster->owner)
		raster->owner[i] = paint->owner;
	if (raster->item)
		raster->item[i] = paint->item;
	raster->cover[i] = paint->cover;
	return true;
}

/* Pixels [first, end) of row y have become nearer. */
static inline void lod_mark_stale(const struct lod_paint *paint, uint32_t y, uint32_t first, uint32_t end)
{
	struct lod_raster_state *state = paint->raster->state;
	uint8_t *row = state->stale + (size_t)(y >> LOD_BLOCK_SHIFT) * state->blocks_x;
	for (uint32_t b = first >> LOD_BLOCK_SHIFT; b <= (end - 1) >> LOD_BLOCK_SHIFT; b++)
		row[b] = 1;
}
