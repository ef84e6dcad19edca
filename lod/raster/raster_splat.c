/* Drawing splats: see lod/splat.h. Unlike the edges of triangles those of ellipses are decided in single
 * floats, by + - * / and square roots in a fixed order. */
#include "lod/raster/raster_state.h"
#include "lod/splat.h"

struct disc {                        /* a projected splat; pixels from the picture's middle */
	struct lod_ellipse ellipse;
	float x, y, z, opacity;
	uint32_t salt;
};

static float row_of(const float row[4], const float p[3])
{
	return row[0] * p[0] + row[1] * p[1] + row[2] * p[2];
}

static bool project(const struct lod_raster_state *state, const float centre[3], const float half[9],
	struct disc *disc)
{
	const float (*m)[4] = state->clip;
	float w = row_of(m[2], centre) + m[2][3], across[3], down[3];
	if (!(w >= state->near_w))
		return false;
	disc->z = 1 / w;
	float x = (row_of(m[0], centre) + m[0][3]) * disc->z, y = (row_of(m[1], centre) + m[1][3]) * disc->z,
		pixel = disc->z * (1.0f / LOD_SUBPIXEL);
	disc->x = x * (1.0f / LOD_SUBPIXEL);
	disc->y = y * (1.0f / LOD_SUBPIXEL);
	for (int k = 0; k < 3; k++) {
		float nearer = row_of(m[2], half + 3 * k);
		across[k] = (row_of(m[0], half + 3 * k) - nearer * x) * pixel;
		down[k] = (row_of(m[1], half + 3 * k) - nearer * y) * pixel;
	}
	return fabsf(x) < 1e30f && fabsf(y) < 1e30f && lod_ellipse_make(&disc->ellipse, across, down);
}

/* The first pixel whose centre is at or after `at`, from the picture's first, clamped to [0, size]. */
static uint32_t pixel_from(float at, uint32_t size)
{
	float first = ceilf(at + 0.5f * (float)size - 0.5f);
	return first > 0 ? first < (float)size ? (uint32_t)first : size : 0;
}

static void fill_row(const struct lod_paint *paint, const struct disc *disc, uint32_t row, uint32_t from,
	uint32_t to)
{
	if (disc->opacity >= 1) {
		lod_fill_row(paint, row, from, to, disc->z);
		return;
	}
	bool any = false;
	size_t first = (size_t)row * paint->raster->width;
	for (uint32_t x = from; x < to; x++)
		if (lod_splat_covers(disc->salt, x, row, disc->opacity))
			any |= lod_paint_pixel(paint, first + x, disc->z);
	if (any)
		lod_mark_stale(paint, row, from, to);
}

static void fill_disc(const struct lod_paint *paint, const struct disc *disc)
{
	const struct lod_raster *raster = paint->raster;
	uint32_t top = pixel_from(disc->y - disc->ellipse.high, raster->height),
		bottom = pixel_from(disc->y + disc->ellipse.high, raster->height);
	bottom += bottom < raster->height;
	for (uint32_t row = top; row < bottom; row++) {
		float y = (float)row + 0.5f - 0.5f * (float)raster->height - disc->y,
			half = lod_ellipse_row(&disc->ellipse, y), x = disc->x + disc->ellipse.lean * y;
		if (half < 0)
			continue;
		uint32_t from = pixel_from(x - half, raster->width), to = pixel_from(x + half, raster->width);
		if (from < to)
			fill_row(paint, disc, row, from, to);
	}
}

void lod_raster_splats(struct lod_raster *raster, const struct lod_raster_batch *batch)
{
	struct lod_paint paint = lod_paint_make(raster, batch);
	for (uint32_t i = 0; i < batch->count; i++) {
		const float *centre = batch->position + 3 * (size_t)i;
		struct disc disc = { .opacity = batch->opacity[i], .salt = lod_splat_salt(centre) };
		if (!project(raster->state, centre, batch->half + 9 * (size_t)i, &disc))
			continue;
		paint.item = batch->item + i;
		fill_disc(&paint, &disc);
	}
}
