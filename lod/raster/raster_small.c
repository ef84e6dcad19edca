/* Filling small triangles, four at a time; nearly all triangles of a plant are small.
 *
 * In a box of at most 8 x 8 pixels every product and sum of an edge function is an integer below 2^24, so
 * single floats hold it exactly and the coverage is that of the integer path (the tests compare them). Edges
 * and depth are set up for four triangles in lanes; a triangle that covers none of its pixels ends there; for
 * the others a row of four pixels takes three additions and a sign mask, without a branch that depends on the
 * shape.
 *
 *   edge functions at any pixel of the box: |dx| |y - y_a| + |dy| |x - x_a| <= 2 (9 * 256)^2 < 2^24 */
#include "lod/bits.h"
#include "lod/raster/raster_state.h"

struct setup {                       /* one triangle a lane; float arrays, so that single lanes can be read */
	float edge[3][4], step_x[3][4], step_y[3][4];
	float z[4], z_step_x[4], z_step_y[4], low[4], high[4];
};

LOD_INLINE lod_f4 to_float(lod_i4 v) { return __builtin_convertvector(v, lod_f4); }

/* The edge function of a -> b at the origin, less one if a centre on the edge does not belong to the
 * triangle. */
LOD_INLINE lod_f4 edge_four(struct setup *setup, int i, lod_f4 ax, lod_f4 ay, lod_f4 bx, lod_f4 by)
{
	const lod_f4 zero = lod_f4_all(0), one = lod_f4_all(1), subpixel = lod_f4_all(LOD_SUBPIXEL);
	lod_f4 dx = bx - ax, dy = by - ay;
	lod_i4 owned = (dy < zero) | ((dy == zero) & (dx > zero));
	/* Adding 0 avoids -0, whose sign would count. */
	lod_f4 at = dy * ax - dx * ay - lod_f4_select(owned, zero, one) + zero;
	lod_f4_store(setup->edge[i], at);
	lod_f4_store(setup->step_x[i], (zero - dy) * subpixel);
	lod_f4_store(setup->step_y[i], dx * subpixel);
	return at;
}

LOD_INLINE void depth_four(struct setup *setup, const lod_f4 x[3], const lod_f4 y[3], const lod_f4 z[3],
	lod_f4 area)
{
	const lod_f4 subpixel = lod_f4_all(LOD_SUBPIXEL);
	lod_f4 part = lod_f4_all(1) / area, ab = z[1] - z[0], ac = z[2] - z[0];
	lod_f4 per_x = (ab * (y[2] - y[0]) - ac * (y[1] - y[0])) * part;
	lod_f4 per_y = (ac * (x[1] - x[0]) - ab * (x[2] - x[0])) * part;
	lod_f4_store(setup->z, z[0] - per_x * x[0] - per_y * y[0]);
	lod_f4_store(setup->z_step_x, per_x * subpixel);
	lod_f4_store(setup->z_step_y, per_y * subpixel);
	lod_f4_store(setup->low, lod_f4_min(lod_f4_min(z[0], z[1]), z[2]));
	lod_f4_store(setup->high, lod_f4_max(lod_f4_max(z[0], z[1]), z[2]));
}

/* Fills *setup relative to the first pixel centre of each box; returns the lanes that may cover a pixel. */
LOD_INLINE unsigned setup_four(struct setup *setup, const struct lod_four *four)
{
	lod_u4 centre_x = (lod_u4)four->first_x * LOD_SUBPIXEL + LOD_SUBPIXEL / 2;
	lod_u4 centre_y = (lod_u4)four->first_y * LOD_SUBPIXEL + LOD_SUBPIXEL / 2;
	lod_f4 x[3], y[3], z[3] = { four->z[0], four->z[1], four->z[2] };
	for (int i = 0; i < 3; i++) {
		x[i] = to_float((lod_i4)((lod_u4)four->x[i] - centre_x));
		y[i] = to_float((lod_i4)((lod_u4)four->y[i] - centre_y));
	}
	lod_f4 area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
	lod_i4 turned = area < lod_f4_all(0);
	lod_f4 swap;
	swap = lod_f4_select(turned, x[2], x[1]), x[2] = lod_f4_select(turned, x[1], x[2]), x[1] = swap;
	swap = lod_f4_select(turned, y[2], y[1]), y[2] = lod_f4_select(turned, y[1], y[2]), y[1] = swap;
	swap = lod_f4_select(turned, z[2], z[1]), z[2] = lod_f4_select(turned, z[1], z[2]), z[1] = swap;
	lod_f4 e0 = edge_four(setup, 0, x[1], y[1], x[2], y[2]),
		e1 = edge_four(setup, 1, x[2], y[2], x[0], y[0]);
	lod_f4 e2 = edge_four(setup, 2, x[0], y[0], x[1], y[1]);
	lod_i4 missed = ((lod_i4)e0 | (lod_i4)e1 | (lod_i4)e2) < 0;
	lod_i4 single = (four->first_x == four->last_x) & (four->first_y == four->last_y);
	depth_four(setup, x, y, z, lod_f4_abs(area));
	return lod_i4_bits((area != lod_f4_all(0)) & ~(missed & single));
}

/* Four pixels of a row, where nothing can be nearer; all are in the picture. */
LOD_INLINE void paint_plain(const struct lod_paint *paint, unsigned bits, uint32_t x, uint32_t y)
{
	static const lod_i4 lanes = { 1, 2, 4, 8 };
	size_t at = (size_t)y * paint->raster->width + x;
	lod_f4 there = lod_f4_load(paint->raster->depth + at);
	lod_i4 open = (there < lod_f4_all(INFINITY)) & ((lod_i4_all((int32_t)bits) & lanes) != 0);
	unsigned painted = lod_i4_bits(open);
	if (!painted)
		return;
	lod_f4_store(paint->raster->depth + at, lod_f4_select(open, lod_f4_all(INFINITY), there));
	for (unsigned k = 0; k < 4; k++)
		paint->raster->cover[at + k] |= (uint8_t)-(painted >> k & 1);
	lod_mark_stale(paint, y, x, x + 4);
}

LOD_INLINE void paint_bits(const struct lod_paint *paint, unsigned bits, uint32_t x, uint32_t y, float z,
	float step, float low, float high)
{
	size_t row = (size_t)y * paint->raster->width + x;
	unsigned painted = 0;
	for (; bits; bits &= bits - 1) {
		unsigned k = (unsigned)__builtin_ctz(bits);
		if (lod_paint_pixel(paint, row + k, lod_depth_clamp(z + (float)k * step, low, high)))
			painted |= 1u << k;
	}
	if (painted)
		lod_mark_stale(paint, y, x + (unsigned)__builtin_ctz(painted),
			x + 32 - (unsigned)__builtin_clz(painted));
}

/* Four columns of one lane's box, from its pixel `column` on. */
LOD_INLINE void fill_strip(const struct lod_paint *paint, const struct setup *setup, unsigned lane,
	uint32_t x, uint32_t y, uint32_t column, uint32_t height)
{
	lod_f4 edge[3], down[3];
	for (int i = 0; i < 3; i++) {
		float step = setup->step_x[i][lane];
		edge[i] = lod_f4_all(setup->edge[i][lane] + (float)column * step)
			+ (lod_f4){ 0, 1, 2, 3 } * lod_f4_all(step);
		down[i] = lod_f4_all(setup->step_y[i][lane]);
	}
	float z_step = setup->z_step_x[lane], z = setup->z[lane] + (float)column * z_step;
	bool plain = paint->plain && setup->low[lane] > 0 && x + column + 4 <= paint->raster->width;
	for (uint32_t row = 0; row < height; row++) {
		unsigned bits = lod_i4_bits((lod_i4)edge[0] | (lod_i4)edge[1] | (lod_i4)edge[2]) ^ 15;
		if (bits && plain)
			paint_plain(paint, bits, x + column, y + row);
		else if (bits)
			paint_bits(paint, bits, x + column, y + row, z + (float)row * setup->z_step_y[lane],
				z_step, setup->low[lane], setup->high[lane]);
		for (int i = 0; i < 3; i++)
			edge[i] += down[i];
	}
}

LOD_CLONES void lod_fill_small(const struct lod_paint *paint, const struct lod_four *four, unsigned lanes)
{
	struct setup setup;
	for (lanes &= setup_four(&setup, four); lanes; lanes &= lanes - 1) {
		unsigned lane = (unsigned)__builtin_ctz(lanes);
		uint32_t x = (uint32_t)four->first_x[lane], y = (uint32_t)four->first_y[lane];
		uint32_t width = (uint32_t)four->last_x[lane] - x + 1,
			height = (uint32_t)four->last_y[lane] - y + 1;
		for (uint32_t column = 0; column < width; column += 4)
			fill_strip(paint, &setup, lane, x, y, column, height);
	}
}
