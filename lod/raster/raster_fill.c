/* Filling: from corners on the grid of 1/256 pixel to pixels, in integers.
 *
 * A pixel is inside if its centre lies on the inner side of all three edges; a centre on an edge belongs to
 * the triangle whose top or left edge it is. Each row of a triangle is one span: found by stepping in narrow
 * boxes and by exact division in wide ones. Depth and uv are floats, computed in one fixed order for each
 * triangle. Depth is 1/w, clamped to the range of the corners, on which the coarse depth behind
 * lod_raster_hides relies. */
#include "lod/lanes.h"
#include "lod/raster/texel.h"
#include "lod/raster/raster_state.h"

#define NARROW 12                    /* pixels; up to here stepping beats dividing */

struct edge { int64_t at, step_x, step_y; };     /* value at the box's first pixel centre, >= 0 inside; change
                                                  * per pixel */

struct slope { /* depth over the box: at the first centre, per pixel; clamped to [low, high] */
	double at, step_x, step_y;
	float low, high;
};

struct texture { /* perspective-correct uv: corner values times 1/w, weighted by the edge functions */
	const struct eco_image *image;
	const struct lod_mask *mask;     /* of it, or NULL */
	double u[3], v[3], z[3];
	int64_t bias[3];                 /* subtracted from each edge function by the top-left rule */
};

/* Paints four pixels that are all nearer. */
static inline void paint_four(const struct lod_paint *paint, size_t i, lod_f4 z)
{
	const struct lod_raster *raster = paint->raster;
	lod_f4_store(raster->depth + i, paint->silhouette ? lod_f4_all(INFINITY) : z);
	memset(raster->cover + i, paint->cover, 4);
	if (raster->owner)
		memcpy(raster->owner + i,
			(const uint64_t[4]){ paint->owner, paint->owner, paint->owner, paint->owner }, 32);
	if (raster->item)
		memcpy(raster->item + i,
			(const uint32_t[4]){ paint->item, paint->item, paint->item, paint->item }, 16);
}

/* Paints `count` pixels from i on where nothing can be nearer. True if one was not covered. */
static bool paint_plain(const struct lod_paint *paint, size_t i, uint32_t count)
{
	float *depth = paint->raster->depth + i;
	lod_i4 open = lod_i4_all(0);
	bool any = false;
	uint32_t k = 0;
	for (; k + 4 <= count; k += 4) {
		open |= lod_f4_load(depth + k) < lod_f4_all(INFINITY);
		lod_f4_store(depth + k, lod_f4_all(INFINITY));
	}
	for (; k < count; k++) {
		any |= depth[k] < INFINITY;
		depth[k] = INFINITY;
	}
	any |= lod_i4_bits(open) != 0;
	if (any)
		memset(paint->raster->cover + i, 255, count);
	return any;
}

/* The depths of four pixels, the first of them `column` pixels from that at which the depth is `base`. */
static inline lod_f4 depths_from(const struct slope *slope, float base, float step, uint32_t column)
{
	float k = (float)column;
	lod_f4 z = lod_f4_all(base) + (lod_f4){ k, k + 1, k + 2, k + 3 } * lod_f4_all(step);
	return lod_f4_min(lod_f4_max(z, lod_f4_all(slope->low)), lod_f4_all(slope->high));
}

/* Paints pixels [first, end) of row y; `left` is the column at which the depth is `base`. */
static void paint_span(const struct lod_paint *paint, uint32_t y, uint32_t left, uint32_t first, uint32_t end,
	float base, float step, const struct slope *slope)
{
	size_t row = (size_t)y * paint->raster->width;
	const float *depth = paint->raster->depth + row;
	bool any = false;
	uint32_t x = first;
	if (paint->plain && slope->low > 0) {
		if (paint_plain(paint, row + first, end - first))
			lod_mark_stale(paint, y, first, end);
		return;
	}
	for (; x + 4 <= end; x += 4) {
		lod_f4 z = depths_from(slope, base, step, x - left);
		lod_f4 there = lod_f4_load(depth + x);
		unsigned may_win = lod_i4_bits(z >= there);
		if (may_win == 15 && lod_i4_bits(z > there) == 15) {
			paint_four(paint, row + x, z);
			any = true;
			continue;
		}
		for (; may_win; may_win &= may_win - 1) {
			unsigned lane = (unsigned)__builtin_ctz(may_win);
			any |= lod_paint_pixel(paint, row + x + lane, z[lane]);
		}
	}
	for (; x < end; x++)
		any |= lod_paint_pixel(paint, row + x,
			lod_depth_clamp(base + (float)(x - left) * step, slope->low, slope->high));
	if (any)
		lod_mark_stale(paint, y, first, end);
}

/* The texel at a wrapped coordinate. NaN and absurdly large coordinates read texel 0. */
static uint32_t wrap_texel(double at, uint32_t size)
{
	double scaled = at * size;
	if (scaled >= 0 && scaled < size)        /* nearly always, and without a division */
		return (uint32_t)scaled;
	if (!(scaled > -9e15 && scaled < 9e15))
		return 0;
	int64_t whole = (int64_t)scaled;
	if ((double)whole > scaled)
		whole--;
	int64_t texel = whole % (int64_t)size;
	return (uint32_t)(texel < 0 ? texel + size : texel);
}

/* The texels of four coordinates, of which `lanes` count: at once where none wraps, as a call for each costs
 * 40 % of the time of a draft of cards. */
static inline __attribute__((always_inline)) lod_i4 texels_of(const lod_d4 *at, uint32_t size, unsigned lanes)
{
	lod_d4 scaled = *at * (double)size;
	lod_i4 texel = __builtin_convertvector((scaled >= 0) & (scaled < (double)size), lod_i4);
	if (lod_i4_bits(texel) == 15)
		return __builtin_convertvector(scaled, lod_i4);
	for (; lanes; lanes &= lanes - 1)
		texel[__builtin_ctz(lanes)] = (int32_t)wrap_texel((*at)[__builtin_ctz(lanes)], size);
	return texel;
}

/* Bits of the opaque ones of four pixels, of which the first has the edge functions `at`. Sums and products
 * of edge functions are integers below 2^53, so doubles hold them exactly. */
static inline __attribute__((always_inline)) unsigned opaque_of_four(const struct texture *texture,
	const double at[3], const double step[3], unsigned lanes)
{
	lod_d4 u = { 0 }, v = { 0 }, z = { 0 };
	for (int i = 0; i < 3; i++) {
		lod_d4 weight = at[i] + (lod_d4){ 0, 1, 2, 3 } * step[i];
		u += weight * texture->u[i];
		v += weight * texture->v[i];
		z += weight * texture->z[i];
	}
	u /= z;
	v /= z;
	unsigned opaque = 0;
	lod_i4 columns = texels_of(&u, texture->image->width, lanes), rows = texels_of(&v, texture->image->height, lanes);
	for (; lanes; lanes &= lanes - 1) {
		unsigned lane = (unsigned)__builtin_ctz(lanes);
		uint32_t column = (uint32_t)columns[lane], row = (uint32_t)rows[lane];
		bool is = texture->mask ? lod_mask_opaque(texture->mask, column, row)
			: texture->image->rgba[4 * ((size_t)row * texture->image->width + column) + 3] >= 128;
		opaque |= (unsigned)is << lane;
	}
	return opaque;
}

/* Most pixels under the cards of a crown are covered already: four at a time are passed over. */
static inline __attribute__((always_inline)) void paint_cutout_span(const struct lod_paint *paint, uint32_t y,
	uint32_t left, uint32_t first, uint32_t end, float base, float step, const struct slope *slope,
	const struct texture *texture, const int64_t row_edge[3], const struct edge edges[3])
{
	size_t row = (size_t)y * paint->raster->width;
	const float *depth = paint->raster->depth + row;
	double steps[3];
	bool any = false;
	for (int i = 0; i < 3; i++)
		steps[i] = (double)edges[i].step_x;
	for (uint32_t x = first; x < end; x += 4) {
		lod_f4 z = depths_from(slope, base, step, x - left), there = lod_f4_all(INFINITY);
		if (x + 4 <= end)
			there = lod_f4_load(depth + x);
		else
			for (uint32_t lane = 0; x + lane < end; lane++)
				there[lane] = depth[x + lane];
		unsigned may_win = lod_i4_bits(z >= there);
		if (!may_win)
			continue;
		double at[3];
		for (int i = 0; i < 3; i++)
			at[i] = (double)(row_edge[i] + texture->bias[i] + (int64_t)(x - left) * edges[i].step_x);
		for (unsigned opaque = opaque_of_four(texture, at, steps, may_win); opaque; opaque &= opaque - 1) {
			unsigned lane = (unsigned)__builtin_ctz(opaque);
			any |= lod_paint_pixel(paint, row + x + lane, z[lane]);
		}
	}
	if (any)
		lod_mark_stale(paint, y, first, end);
}

/* Narrows columns [*first, *end) to those with at + column * step >= 0. */
static inline void narrow_by_division(int64_t at, int64_t step, int64_t *first, int64_t *end)
{
	if (at < 0) {
		int64_t enter = step > 0 ? (-at + step - 1) / step : INT64_MAX;
		if (enter > *first)
			*first = enter;
	} else if (step < 0) {
		int64_t leave = at / -step + 1;
		if (leave < *end)
			*end = leave;
	}
}

static inline void find_span(const int64_t at[3], const struct edge edges[3], int64_t width, int64_t *first,
	int64_t *end)
{
	*first = 0, *end = width;
	if (width > NARROW) {
		for (int i = 0; i < 3; i++)
			narrow_by_division(at[i], edges[i].step_x, first, end);
		return;
	}
	int64_t e0 = at[0], e1 = at[1], e2 = at[2], k = 0;
	for (; k < width && (e0 | e1 | e2) < 0; k++)
		e0 += edges[0].step_x, e1 += edges[1].step_x, e2 += edges[2].step_x;
	*first = k;
	for (; k < width && (e0 | e1 | e2) >= 0; k++)
		e0 += edges[0].step_x, e1 += edges[1].step_x, e2 += edges[2].step_x;
	*end = k;
}

/* The edge function of a -> b at (x, y), less one if a centre on the edge does not belong to the triangle. */
static inline struct edge edge_make(const struct lod_corner *a, const struct lod_corner *b, int64_t x,
	int64_t y)
{
	int64_t dx = (int64_t)b->x - a->x, dy = (int64_t)b->y - a->y;
	bool owned = dy < 0 || (dy == 0 && dx > 0);      /* left or top, y down */
	return (struct edge){ dx * (y - a->y) - dy * (x - a->x) - !owned, -dy * LOD_SUBPIXEL,
		dx * LOD_SUBPIXEL };
}

static inline struct slope slope_make(const struct lod_corner *a, const struct lod_corner *b,
	const struct lod_corner *c, int64_t area, int64_t x, int64_t y)
{
	double ab = (double)b->z - a->z, ac = (double)c->z - a->z, part = 1.0 / (double)area;
	double per_x = (ab * (double)(c->y - a->y) - ac * (double)(b->y - a->y)) * part;
	double per_y = (ac * (double)(b->x - a->x) - ab * (double)(c->x - a->x)) * part;
	struct slope slope = { (double)a->z + per_x * (double)(x - a->x) + per_y * (double)(y - a->y),
		per_x * LOD_SUBPIXEL, per_y * LOD_SUBPIXEL, a->z, a->z };
	slope.low = b->z < slope.low ? b->z : slope.low;
	slope.low = c->z < slope.low ? c->z : slope.low;
	slope.high = b->z > slope.high ? b->z : slope.high;
	slope.high = c->z > slope.high ? c->z : slope.high;
	return slope;
}

/* Weight i belongs to corner i: it is the edge function of the opposite edge. */
static void texture_make(struct texture *texture, const struct eco_image *image,
	const struct lod_corner *const corner[3])
{
	texture->image = image;
	for (int i = 0; i < 3; i++) {
		const struct lod_corner *from = corner[(i + 1) % 3], *to = corner[(i + 2) % 3];
		int64_t dx = (int64_t)to->x - from->x, dy = (int64_t)to->y - from->y;
		texture->bias[i] = !(dy < 0 || (dy == 0 && dx > 0));
		texture->z[i] = corner[i]->z;
		texture->u[i] = (double)corner[i]->u * corner[i]->z;
		texture->v[i] = (double)corner[i]->v * corner[i]->z;
	}
}

static inline int32_t min3(int32_t a, int32_t b, int32_t c)
{
	int32_t m = a < b ? a : b;
	return m < c ? m : c;
}
static inline int32_t max3(int32_t a, int32_t b, int32_t c)
{
	int32_t m = a > b ? a : b;
	return m > c ? m : c;
}

struct box { int32_t left, top, right, bottom; };        /* pixels, inclusive */

static inline bool box_clamp(struct box *box, const struct lod_raster *raster)
{
	if (box->left < 0) box->left = 0;
	if (box->top < 0) box->top = 0;
	if (box->right >= (int32_t)raster->width) box->right = (int32_t)raster->width - 1;
	if (box->bottom >= (int32_t)raster->height) box->bottom = (int32_t)raster->height - 1;
	return box->left <= box->right && box->top <= box->bottom;
}

LOD_CLONES void lod_fill_triangle(const struct lod_paint *paint, const struct lod_corner corners[3])
{
	const struct lod_corner *a = &corners[0], *b = &corners[1], *c = &corners[2];
	int64_t area = (int64_t)(b->x - a->x) * (c->y - a->y) - (int64_t)(c->x - a->x) * (b->y - a->y);
	if (area == 0)
		return;
	if (area < 0) {
		b = &corners[2], c = &corners[1];
		area = -area;
	}
	struct box box = { lod_pixel_from(min3(a->x, b->x, c->x)), lod_pixel_from(min3(a->y, b->y, c->y)),
		lod_pixel_to(max3(a->x, b->x, c->x)), lod_pixel_to(max3(a->y, b->y, c->y)) };
	if (!box_clamp(&box, paint->raster))
		return;
	int64_t x = (int64_t)box.left * LOD_SUBPIXEL + LOD_SUBPIXEL / 2,
		y = (int64_t)box.top * LOD_SUBPIXEL + LOD_SUBPIXEL / 2;
	struct edge edges[3] = { edge_make(b, c, x, y), edge_make(c, a, x, y), edge_make(a, b, x, y) };
	int64_t width = box.right - box.left + 1;
	if (width == 1 && box.top == box.bottom && (edges[0].at | edges[1].at | edges[2].at) < 0)
		return;
	struct slope slope = slope_make(a, b, c, area, x, y);
	struct texture texture = { 0 };
	texture.mask = paint->mask;
	if (paint->cutout)
		texture_make(&texture, paint->cutout, (const struct lod_corner *const[3]){ a, b, c });
	for (int32_t row = box.top; row <= box.bottom; row++) {
		int64_t down = row - box.top, first, end;
		int64_t at[3] = { edges[0].at + down * edges[0].step_y, edges[1].at + down * edges[1].step_y,
			edges[2].at + down * edges[2].step_y };
		find_span(at, edges, width, &first, &end);
		if (first >= end)
			continue;
		uint32_t left = (uint32_t)box.left, from = left + (uint32_t)first, to = left + (uint32_t)end;
		float base = (float)(slope.at + (double)down * slope.step_y), step = (float)slope.step_x;
		if (paint->cutout)
			paint_cutout_span(paint, (uint32_t)row, left, from, to, base, step, &slope, &texture,
				at, edges);
		else
			paint_span(paint, (uint32_t)row, left, from, to, base, step, &slope);
	}
}

void lod_fill_row(const struct lod_paint *paint, uint32_t row, uint32_t from, uint32_t to, float z)
{
	paint_span(paint, row, from, from, to, z, 0, &(struct slope){ z, 0, 0, z, z });
}

/* ---- Small triangles ---- */

/* In a box of at most 8 x 8 pixels every product and sum of an edge function is an integer below 2^24 (|dx|
 * |y - y_a| + |dy| |x - x_a| <= 2 (9 * 256)^2), so single floats hold it exactly. Edges and depth are set up
 * for four triangles in lanes; then a row of four pixels takes three additions and a sign mask. */
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
LOD_INLINE void paint_strip_plain(const struct lod_paint *paint, unsigned bits, uint32_t x, uint32_t y)
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
			paint_strip_plain(paint, bits, x + column, y + row);
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
