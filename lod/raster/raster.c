/* The rasteriser's object: buffers, camera, coarse depth, merging. raster.h has the contract, raster_draw.c
 * and raster_fill.c turn triangles into pixels.
 *
 * Positions are doubles until the eye is subtracted: once an object, the difference of its place and the eye
 * is taken in double and folded into one 3 x 4 float matrix. So a plant 500 km from the origin is drawn as
 * exactly as one beside it. */
#include "lod/raster/raster.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/format/view.h"
#include "lod/geometry.h"
#include "lod/raster/raster_state.h"

#define BLOCK (1u << LOD_BLOCK_SHIFT)

void lod_raster_init(struct lod_raster *raster, const struct lod_raster_options *options)
{
	size_t pixels = (size_t)options->width * options->height;
	struct lod_raster_state *state = eco_alloc(1, sizeof *state);
	if (!pixels || options->width > ECO_IMAGE_MAX || options->height > ECO_IMAGE_MAX)
		eco_end("a picture has no pixels, or too many");
	assert(!options->silhouette || (!options->owner && !options->item));
	state->blocks_x = (options->width + BLOCK - 1) >> LOD_BLOCK_SHIFT;
	state->blocks_y = (options->height + BLOCK - 1) >> LOD_BLOCK_SHIFT;
	size_t blocks = (size_t)state->blocks_x * state->blocks_y;
	state->block = eco_alloc(blocks, sizeof *state->block);
	state->stale = eco_alloc(blocks, 1);
	state->place.cosine = state->place.scale = 1;
	state->silhouette = options->silhouette;
	*raster = (struct lod_raster){ .width = options->width, .height = options->height, .state = state,
		.depth = eco_alloc(pixels, sizeof *raster->depth), .cover = eco_alloc(pixels, 1),
		.owner = options->owner ? eco_alloc(pixels, sizeof *raster->owner) : NULL,
		.item = options->item ? eco_alloc(pixels, sizeof *raster->item) : NULL,
		.leaf = options->item ? eco_alloc(pixels, sizeof *raster->leaf) : NULL };
}

void lod_raster_free(struct lod_raster *raster)
{
	if (raster->state) {
		free(raster->state->block);
		free(raster->state->stale);
	}
	eco_free(raster->state, raster->depth, raster->cover, raster->owner, raster->item, raster->leaf);
	memset(raster, 0, sizeof *raster);
}

void lod_raster_clear(struct lod_raster *raster)
{
	size_t pixels = (size_t)raster->width * raster->height;
	size_t blocks = (size_t)raster->state->blocks_x * raster->state->blocks_y;
	memset(raster->depth, 0, pixels * sizeof *raster->depth);
	memset(raster->cover, 0, pixels);
	if (raster->owner)
		memset(raster->owner, 0, pixels * sizeof *raster->owner);
	if (raster->item)
		memset(raster->item, 0, pixels * sizeof *raster->item);
	memset(raster->state->block, 0, blocks * sizeof *raster->state->block);
	memset(raster->state->stale, 0, blocks);
	raster->state->ground = false;
}

/* ---- Camera and object ---- */

/* 1/256 pixels from the picture's middle per unit on the image plane at distance 1; y down. */
static void plane_scale(const struct lod_raster *raster, double scale[3])
{
	scale[0] = (double)raster->width * (LOD_SUBPIXEL / 2) / raster->state->eye.tan_x;
	scale[1] = -((double)raster->height * (LOD_SUBPIXEL / 2) / raster->state->eye.tan_y);
	scale[2] = 1;
}

void lod_raster_camera(struct lod_raster *raster, const struct lod_eye *eye, double near_m)
{
	assert(near_m > 0);
	struct lod_raster_state *state = raster->state;
	state->eye = *eye;
	state->near_m = near_m > 1e-9 ? near_m : 1e-9;
	state->near_w = (float)state->near_m;
	double scale[3];
	plane_scale(raster, scale);
	memset(state->project, 0, sizeof state->project);
	for (int i = 0; i < 3; i++)
		state->project[i][i] = (float)scale[i];
	for (int i = 0; i < 2; i++)
		state->project[i][2] = (float)(0 - eye->middle[i] * scale[i]);
	struct lod_place place = state->place;
	lod_raster_object(raster, &place);
}

void lod_raster_object(struct lod_raster *raster, const struct lod_place *place)
{
	struct lod_raster_state *state = raster->state;
	const struct lod_eye *eye = &state->eye;
	const double *axes[3] = { eye->right, eye->up, eye->forward };
	double offset[3] = { place->at[0] - eye->at[0], place->at[1] - eye->at[1],
		place->at[2] - eye->at[2] };
	double across = place->scale * lod_place_width(place), sine = place->sine * across,
		cosine = place->cosine * across, scale[3], row[3][4];
	plane_scale(raster, scale);
	state->place = *place;
	state->salt = place->salt;
	for (int i = 0; i < 3; i++) {
		const double *axis = axes[i];
		row[i][0] = axis[0] * cosine + axis[1] * sine;
		row[i][1] = axis[1] * cosine - axis[0] * sine;
		row[i][2] = axis[2] * place->scale;
		row[i][3] = axis[0] * offset[0] + axis[1] * offset[1] + axis[2] * offset[2];
	}
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 4; k++) {
			double shift = i < 2 ? eye->middle[i] * scale[i] * row[2][k] : 0;
			state->view[i][k] = (float)row[i][k];
			state->clip[i][k] = (float)(row[i][k] * scale[i] - shift);
		}
}

void lod_raster_look(struct lod_raster *raster, const struct lod_eye *eye, double near_m)
{
	lod_raster_clear(raster);
	lod_raster_camera(raster, eye, near_m);
	lod_raster_object(raster, &(struct lod_place){ .cosine = 1, .scale = 1 });
}

/* ---- Coarse depth ---- */

/* The least depth in a block. Depths only grow, so an older value remains a lower bound. */
static float block_refresh(struct lod_raster *raster, uint32_t bx, uint32_t by)
{
	struct lod_raster_state *state = raster->state;
	uint32_t x0 = bx << LOD_BLOCK_SHIFT, y0 = by << LOD_BLOCK_SHIFT;
	uint32_t x1 = x0 + BLOCK < raster->width ? x0 + BLOCK : raster->width;
	uint32_t y1 = y0 + BLOCK < raster->height ? y0 + BLOCK : raster->height;
	lod_f4 least4 = lod_f4_all(INFINITY);
	float least = INFINITY;
	for (uint32_t y = y0; y < y1; y++) {
		const float *row = raster->depth + (size_t)y * raster->width;
		uint32_t x = x0;
		for (; x + 4 <= x1; x += 4)
			least4 = lod_f4_min(least4, lod_f4_load(row + x));
		for (; x < x1; x++)
			least = row[x] < least ? row[x] : least;
	}
	for (int i = 0; i < 4; i++)
		least = least4[i] < least ? least4[i] : least;
	size_t block = (size_t)by * state->blocks_x + bx;
	state->stale[block] = 0;
	return state->block[block] = least;
}

/* The tangents from the eye to a sphere, as slopes on the image plane, in the plane of the forward axis and
 * another axis. `z` > r. */
static void sphere_slopes(double x, double z, double r, double slope[2])
{
	double t = sqrt(x * x + z * z - r * r);
	slope[0] = (x * t - r * z) / (z * t + r * x);
	slope[1] = (x * t + r * z) / (z * t - r * x);
}

/* Pixels of [0, size) that [low, high] (pixels) may touch, with a pixel to spare; false if there are none. */
static bool pixel_range(double low, double high, uint32_t size, uint32_t range[2])
{
	low -= 1.5, high += 1.5;
	if (!(high >= 0 && low < size))
		return false;
	range[0] = low > 0 ? (uint32_t)low : 0;
	range[1] = high < size - 1 ? (uint32_t)high : size - 1;
	return true;
}

bool lod_blocks_hide(struct lod_raster *raster, const uint32_t x[2], const uint32_t y[2], float nearest)
{
	struct lod_raster_state *state = raster->state;
	for (uint32_t by = y[0] >> LOD_BLOCK_SHIFT; by <= y[1] >> LOD_BLOCK_SHIFT; by++) {
		for (uint32_t bx = x[0] >> LOD_BLOCK_SHIFT; bx <= x[1] >> LOD_BLOCK_SHIFT; bx++) {
			size_t block = (size_t)by * state->blocks_x + bx;
			if (state->block[block] >= nearest)
				continue;
			if (!state->stale[block] || block_refresh(raster, bx, by) < nearest)
				return false;
		}
	}
	return true;
}

bool lod_raster_hides(struct lod_raster *raster, const double center[3], double radius)
{
	const struct lod_eye *eye = &raster->state->eye;
	double d[3] = { center[0] - eye->at[0], center[1] - eye->at[1], center[2] - eye->at[2] };
	double x = 0, y = 0, z = 0;
	for (int i = 0; i < 3; i++) {
		x += d[i] * eye->right[i];
		y += d[i] * eye->up[i];
		z += d[i] * eye->forward[i];
	}
	/* Room for the rounding of the floats that drawing uses. */
	radius += 4e-6 * (fabs(x) + fabs(y) + fabs(z) + 64 * radius);
	if (z + radius < raster->state->near_m)
		return true;
	if (z - radius <= raster->state->near_m)
		return false;
	double across[2], upward[2], wide = 0.5 * raster->width / eye->tan_x,
		high = 0.5 * raster->height / eye->tan_y,
		middle_x = 0.5 * raster->width - eye->middle[0] * wide,
		middle_y = 0.5 * raster->height + eye->middle[1] * high;
	sphere_slopes(x, z, radius, across);
	sphere_slopes(y, z, radius, upward);
	uint32_t columns[2], rows[2];
	if (!pixel_range(middle_x + wide * across[0], middle_x + wide * across[1], raster->width, columns)
		|| !pixel_range(middle_y - high * upward[1], middle_y - high * upward[0], raster->height, rows))
		return true;
	return lod_blocks_hide(raster, columns, rows, (float)(1.000001 / (z - radius)));
}

/* ---- Merging ---- */

void lod_raster_merge(struct lod_raster *into, const struct lod_raster *from)
{
	assert(into->width == from->width && into->height == from->height);
	assert(!into->owner == !from->owner && !into->item == !from->item);
	size_t pixels = (size_t)into->width * into->height;
	for (size_t i = 0; i < pixels; i++) {
		if (!(into->owner ? lod_sample_wins(from->depth[i], from->owner[i], into->depth[i],
				into->owner[i])
			: lod_sample_wins(from->depth[i], from->cover[i], into->depth[i], into->cover[i])))
			continue;
		into->depth[i] = from->depth[i];
		into->cover[i] = from->cover[i];
		if (into->owner)
			into->owner[i] = from->owner[i];
		if (into->item)
			into->item[i] = from->item[i];
		if (into->leaf)
			into->leaf[i] = from->leaf[i];
	}
	into->state->ground |= from->state->ground;
	memset(into->state->stale, 1, (size_t)into->state->blocks_x * into->state->blocks_y);
}

/* ---- Lists ---- */

void lod_raster_list(struct lod_raster *raster, const struct eco_list *list,
	const struct lod_geometry *geometry, const struct lod_raster_batch *given)
{
	struct lod_raster_batch batch = *given;
	batch.position = geometry->position;
	batch.uv = geometry->uv;
	batch.width = geometry->width;
	batch.size = geometry->size;
	batch.half = geometry->half;
	batch.opacity = geometry->opacity;
	batch.wood = geometry->wood;
	if (list->kind == ECO_LIST_TRIANGLES)
		lod_raster_triangles(raster, &batch);
	else if (list->kind == ECO_LIST_LINES)
		lod_raster_lines(raster, &batch);
	else
		lod_raster_splats(raster, &batch);
}
