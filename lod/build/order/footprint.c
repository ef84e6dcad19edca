#include "lod/build/order/footprint.h"

#include <string.h>

#include "lod/lanes.h"

#define SUBPIXEL 256
#define ROUNDING 1e-9                    /* of the largest turn */
#define EDGE_WHOLE 64.0 /* larger fans may bend another way in perspective, or reach behind the eye */
/* No corner lies further from the picture's middle: the products below stay within 64 bits. */
#define LIMIT (8192 * SUBPIXEL)

struct lod_fan lod_foliage_fan(const struct lod_foliage *foliage, uint32_t element)
{
	uint32_t at = foliage->first[element];
	return (struct lod_fan){ (const float (*)[3])(foliage->corner + at),
		(const float (*)[2])(foliage->uv + at), foliage->first[element + 1] - at,
		foliage->mask ? foliage->mask[element] : NULL };
}

static inline double turn(const double *a, const double *b, const double *c)
{
	return (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
}

/* 1 or -1 if the corners go once around a convex outline, by their direction; 0 otherwise. Stars and spirals
 * turn one way as well, so the fan's triangles must turn the same way and lie on one side of the first edge.
 * Turns by rounding alone count as none. */
static inline int way_around(const double (*p)[2], uint32_t corners)
{
	double low = 0, high = 0;
	for (uint32_t i = 1; i + 1 < corners; i++) {
		double part = turn(p[0], p[i], p[i + 1]);
		low = part < low ? part : low;
		high = part > high ? part : high;
	}
	for (uint32_t i = 0; i < corners && corners > 3; i++) {
		double bend = turn(p[i], p[i + 1 < corners ? i + 1 : 0],
			p[i + 2 < corners ? i + 2 : i + 2 - corners]);
		double side = turn(p[0], p[1], p[i]);
		low = bend < low ? bend : low;
		low = side < low ? side : low;
		high = bend > high ? bend : high;
		high = side > high ? side : high;
	}
	return -low * ROUNDING > high ? -1 : high * ROUNDING > -low ? 1 : 0;
}

/* A corner in units of half pictures, and how far ahead it lies. */
static inline void see_corner(double to[3], const float p[3], const struct lod_eye *eye, double wide,
	double tall)
{
	double d[3] = { p[0] - eye->at[0], p[1] - eye->at[1], p[2] - eye->at[2] };
	to[0] = (d[0] * eye->right[0] + d[1] * eye->right[1] + d[2] * eye->right[2]) * wide;
	to[1] = (d[0] * eye->up[0] + d[1] * eye->up[1] + d[2] * eye->up[2]) * tall;
	to[2] = d[0] * eye->forward[0] + d[1] * eye->forward[1] + d[2] * eye->forward[2];
}

void lod_fan_see(struct lod_fan_seen *seen, const struct lod_fan *fan, const struct lod_eye *eye)
{
	double sum[3] = { 0, 0, 0 }, at[ECO_CORNERS_MAX][2], wide = 1 / eye->tan_x, tall = -1 / eye->tan_y;
	bool solid = !fan->cutout || !fan->uv, before = true;
	seen->fan = *fan;
	for (uint32_t i = 0; i < fan->corners; i++) {
		double *to = seen->corner[i];
		see_corner(to, fan->corner[i], eye, wide, tall);
		before &= to[2] > 0;
		double scale = to[2] > 0 ? 1 / to[2] : 0;
		at[i][0] = to[0] * scale;
		at[i][1] = to[1] * scale;
		for (int k = 0; k < 3; k++)
			sum[k] += to[k];
	}
	seen->way = solid && before ? way_around((const double (*)[2])at, fan->corners) : 0;
	for (int k = 0; k < 3; k++)
		seen->center[k] = sum[k] / fan->corners;
	for (uint32_t i = 0; i < fan->corners; i++)
		for (int k = 0; k < 3; k++)
			seen->corner[i][k] -= seen->center[k];
}

void lod_fan_see_point(struct lod_fan_seen *seen, const struct lod_fan *fan, double area,
	const struct lod_eye *eye)
{
	double sum[3] = { 0, 0, 0 }, to[3], wide = 1 / eye->tan_x, tall = -1 / eye->tan_y;
	for (uint32_t i = 0; i < fan->corners; i++) {
		see_corner(to, fan->corner[i], eye, wide, tall);
		for (int k = 0; k < 3; k++)
			sum[k] += to[k];
	}
	for (int k = 0; k < 3; k++)
		seen->center[k] = sum[k] / fan->corners;
	lod_fan_point(seen, area, eye);
}

void lod_fan_point(struct lod_fan_seen *seen, double area, const struct lod_eye *eye)
{
	double half = sqrt(area) / 2, wide = half / eye->tan_x, tall = half / eye->tan_y;
	*seen = (struct lod_fan_seen){ .fan = { NULL, NULL, 4, NULL },
		.center = { seen->center[0], seen->center[1], seen->center[2] },
		.corner = { { -wide, -tall, 0 }, { wide, -tall, 0 }, { wide, tall, 0 }, { -wide, tall, 0 } },
		.way = 1 };
}

/* ---- Filling ---- */

struct point { int32_t x, y; };          /* 1/256 pixel from the top left */

LOD_INLINE int32_t snap(double at, int32_t middle)
{
	double from = floor(at + 0.5);
	return middle + (int32_t)(from < -LIMIT ? -LIMIT : from > LIMIT ? LIMIT : from);
}

LOD_INLINE int32_t first_centre(int32_t at) { return (at + SUBPIXEL / 2 - 1) >> 8; }
LOD_INLINE int32_t last_centre(int32_t at) { return (at - SUBPIXEL / 2) >> 8; }

/* x of the edge a b, in 1/2^24 pixel, at the centre of row `row`. Integers are divided as doubles, which is
 * faster: below 2^39 by below 2^24 the whole part is the same. */
struct edge { int64_t x, slope; };

LOD_INLINE struct edge edge_make(struct point a, struct point b, int32_t row)
{
	int64_t slope = b.y == a.y ? 0 : (int64_t)((double)(b.x - a.x) * 65536 / (b.y - a.y));
	return (struct edge){ (int64_t)a.x * 65536 + slope * (row * SUBPIXEL + SUBPIXEL / 2 - a.y),
		slope * SUBPIXEL };
}

LOD_INLINE void set_bits(uint64_t *row, int32_t first, int32_t end)
{
	uint32_t a = (uint32_t)first / 64, b = (uint32_t)(end - 1) / 64;
	uint64_t low = ~UINT64_C(0) << ((uint32_t)first % 64),
		high = ~UINT64_C(0) >> (63 - (uint32_t)(end - 1) % 64);
	if (a == b) {
		row[a] |= low & high;
		return;
	}
	row[a] |= low;
	for (uint32_t w = a + 1; w < b; w++)
		row[w] = ~UINT64_C(0);
	row[b] |= high;
}

/* Texture coordinates as a linear function of pixels. */
struct texture { const struct lod_mask *mask; const struct lod_canvas *canvas; double u, v, u_x, u_y, v_x,
	v_y; uint64_t u_step, v_step; };

/* Texels in 1/2^32, so that a step is an addition. */
LOD_INLINE uint64_t texel_of(double at)
{
	return fabs(at) < 1 << 30 ? (uint64_t)(int64_t)(at * 4294967296.0) : 0;
}

LOD_INLINE bool texture_make(struct texture *t, const struct lod_mask *mask, const struct point p[3],
	const float *const uv[3])
{
	double x1 = p[1].x - p[0].x, y1 = p[1].y - p[0].y, x2 = p[2].x - p[0].x, y2 = p[2].y - p[0].y,
		det = x1 * y2 - x2 * y1;
	if (det == 0)
		return false;
	double scale = SUBPIXEL / det, u1 = uv[1][0] - uv[0][0], u2 = uv[2][0] - uv[0][0],
		v1 = uv[1][1] - uv[0][1], v2 = uv[2][1] - uv[0][1];
	*t = (struct texture){ .mask = mask, .u_x = (u1 * y2 - u2 * y1) * scale * mask->width,
		.u_y = (u2 * x1 - u1 * x2) * scale * mask->width,
		.v_x = (v1 * y2 - v2 * y1) * scale * mask->height,
		.v_y = (v2 * x1 - v1 * x2) * scale * mask->height };
	double x = 0.5 - (double)p[0].x / SUBPIXEL, y = 0.5 - (double)p[0].y / SUBPIXEL;
	t->u = (double)uv[0][0] * mask->width + x * t->u_x + y * t->u_y;
	t->v = (double)uv[0][1] * mask->height + x * t->v_x + y * t->v_y;
	t->u_step = texel_of(t->u_x);
	t->v_step = texel_of(t->v_x);
	return true;
}

/* Nearly all coordinates lie in the image and need no division. */
LOD_INLINE uint32_t wrap(uint64_t at, uint32_t size)
{
	if (at >> 32 < size)
		return (uint32_t)(at >> 32);
	int64_t rest = ((int64_t)at >> 32) % (int64_t)size;
	return (uint32_t)(rest < 0 ? rest + (int64_t)size : rest);
}

/* Pixels that can still change a gain. */
LOD_INLINE uint64_t open_pixels(const struct lod_canvas *canvas, size_t at)
{
	return ~canvas->times[at][0] | (~canvas->times[at][1] & canvas->reference[at]);
}

LOD_INLINE void set_opaque(uint64_t *row, uint32_t first, uint32_t end, int32_t y, const struct texture *t)
{
	const struct lod_mask *mask = t->mask;
	uint64_t u = 0, v = 0;
	bool known = false;
	for (uint32_t word = first / 64; word <= (end - 1) / 64; word++) {
		uint64_t bits = 0, wanted = ~UINT64_C(0);
		wanted &= word == first / 64 ? ~UINT64_C(0) << first % 64 : wanted;
		wanted &= word == (end - 1) / 64 ? ~UINT64_C(0) >> (63 - (end - 1) % 64) : wanted;
		if (t->canvas)
			wanted &= open_pixels(t->canvas, (size_t)y * t->canvas->row_words + word);
		if (wanted && !known) {
			u = texel_of(t->u + first * t->u_x + y * t->u_y);
			v = texel_of(t->v + first * t->v_x + y * t->v_y);
			known = true;
		}
		for (; wanted; wanted &= wanted - 1) {
			uint32_t bit = (uint32_t)__builtin_ctzll(wanted), steps = 64 * word + bit - first;
			uint32_t column = wrap(u + steps * t->u_step, mask->width),
				line = wrap(v + steps * t->v_step, mask->height);
			bits |= (mask->opaque[(size_t)line * mask->words + column / 64] >> column % 64 & 1)
				<< bit;
		}
		row[word] |= bits;
	}
}

/* Fills one triangle; `print` is cleared there. */
LOD_INLINE void fill(struct lod_footprint *print, const struct point corner[3], const struct texture *texture,
	int32_t pixels)
{
	struct point p[3] = { corner[0], corner[1], corner[2] };
	for (int i = 0; i < 3; i++)                              /* by y: 0-1, 1-2, 0-1 */
		if (p[i % 2].y > p[i % 2 + 1].y) {
			struct point swap = p[i % 2];
			p[i % 2] = p[i % 2 + 1];
			p[i % 2 + 1] = swap;
		}
	int32_t top = first_centre(p[0].y), bend = first_centre(p[1].y), end = first_centre(p[2].y);
	top = top < 0 ? 0 : top;
	end = end > pixels ? pixels : end;
	if (top >= end)
		return;
	int32_t left_most = (int32_t)print->word * 64, right_most = left_most + (int32_t)print->words * 64;
	right_most = right_most > pixels ? pixels : right_most;
	struct edge whole = edge_make(p[0], p[2], top), part = bend > top ? edge_make(p[0], p[1], top)
		: edge_make(p[1], p[2], top);
	for (int32_t y = top; y < end; y++, whole.x += whole.slope, part.x += part.slope) {
		if (y == bend && bend > top)
			part = edge_make(p[1], p[2], y);
		int64_t left = whole.x < part.x ? whole.x : part.x, right = whole.x < part.x ? part.x
			: whole.x;
		int64_t first = (left + (1 << 23) - 1) >> 24, after = (right + (1 << 23) - 1) >> 24;
		first = first < left_most ? left_most : first; /* rounding may carry long edges beyond */
		after = after > right_most ? right_most : after;
		if (first >= after)
			continue;
		uint64_t *row = print->bits + (size_t)((uint32_t)y - print->y) * print->words - print->word;
		if (texture)
			set_opaque(row, (uint32_t)first, (uint32_t)after, y, texture);
		else
			set_bits(row, (int32_t)first, (int32_t)after);
	}
}

/* Pixels with centres within the corners' bounds. */
struct box { int32_t x0, x1, y0, y1; };

LOD_INLINE bool find_box(struct box *box, const struct point *p, uint32_t corners, int32_t pixels)
{
	struct point low = p[0], high = p[0];
	for (uint32_t i = 1; i < corners; i++) {
		low.x = p[i].x < low.x ? p[i].x : low.x;
		low.y = p[i].y < low.y ? p[i].y : low.y;
		high.x = p[i].x > high.x ? p[i].x : high.x;
		high.y = p[i].y > high.y ? p[i].y : high.y;
	}
	*box = (struct box){ first_centre(low.x), last_centre(high.x), first_centre(low.y),
		last_centre(high.y) };
	box->x0 = box->x0 < 0 ? 0 : box->x0, box->y0 = box->y0 < 0 ? 0 : box->y0;
	box->x1 = box->x1 >= pixels ? pixels - 1 : box->x1, box->y1 = box->y1 >= pixels ? pixels - 1
		: box->y1;
	return box->x0 <= box->x1 && box->y0 <= box->y1;
}

/* Rows y .. y + rows of a picture, between left and right; empty if left >= right. */
struct spans { int32_t y, rows, left[LOD_FOOTPRINT_PIXELS], right[LOD_FOOTPRINT_PIXELS]; };

LOD_INLINE int32_t within(const struct box *box, int64_t x)
{
	x = (x + (1 << 23) - 1) >> 24;
	return (int32_t)(x < box->x0 ? box->x0 : x > box->x1 + 1 ? box->x1 + 1 : x);
}

/* The rows of a triangle lie between its longest edge by height and one of the other two. One loop without
 * branches, since triangles are small and the ends of loops cost the time. */
LOD_INLINE void find_triangle_spans(struct spans *spans,
	const struct box *box, const struct point p[3], int way)
{
	uint32_t top = p[1].y < p[0].y, low = p[2].y >= p[1].y ? 2 : 1;
	top = p[2].y < p[top].y ? 2 : top;
	low = p[low].y >= p[0].y ? low : 0;
	struct point first = p[top], bend = p[3 - top - low], last = p[low];
	bool down = low == (top + 1) % 3;
	int32_t *along = down == (way > 0) ? spans->right : spans->left, *across = down == (way > 0)
		? spans->left : spans->right;
	struct edge whole = edge_make(first, last, box->y0), upper = edge_make(first, bend, box->y0),
		lower = edge_make(bend, last, box->y0);
	int32_t turn = first_centre(bend.y) - box->y0, end = first_centre(last.y) - box->y0;
	end = end > spans->rows ? spans->rows : end;
	for (int32_t y = 0; y < end; y++, whole.x += whole.slope, upper.x += upper.slope,
			lower.x += lower.slope) {
		along[y] = within(box, whole.x);
		across[y] = within(box, y < turn ? upper.x : lower.x);
	}
}

/* The spans of a convex outline, in one pass: each row lies between an edge that goes down and one that goes
 * up. */
LOD_INLINE void find_spans(struct spans *spans, const struct box *box,
	const struct point *p, uint32_t corners, int way)
{
	int32_t top = box->y0, end = box->y1 + 1;
	spans->y = top;
	spans->rows = end - top;
	spans->left[end - top - 1] = spans->right[end - top - 1] = 0;    /* a corner on a centre reaches it
	                                                                  * without covering it */
	if (corners == 3) {
		find_triangle_spans(spans, box, p, way);
		return;
	}
	for (uint32_t i = 0; i < corners; i++) {
		struct point a = p[i], b = p[i + 1 < corners ? i + 1 : 0];
		bool down = a.y < b.y;
		int32_t *side = down == (way > 0) ? spans->right : spans->left;
		int32_t y = first_centre(down ? a.y : b.y), last = first_centre(down ? b.y : a.y);
		y = y < top ? top : y;
		last = last > end ? end : last;
		if (y >= last)
			continue;
		struct edge edge = down ? edge_make(a, b, y) : edge_make(b, a, y);
		for (; y < last; y++, edge.x += edge.slope)
			side[y - top] = within(box, edge.x);
	}
}

LOD_INLINE void project(struct point *p, const struct lod_fan_seen *seen, double edge, uint32_t pixels)
{
	int32_t middle = (int32_t)pixels * (SUBPIXEL / 2);
	for (uint32_t i = 0; i < seen->fan.corners; i++) {
		double w = seen->center[2] + edge * seen->corner[i][2], scale = w > 0 ? middle / w : 0;
		p[i] = (struct point){ snap((seen->center[0] + edge * seen->corner[i][0]) * scale, middle),
			snap((seen->center[1] + edge * seen->corner[i][1]) * scale, middle) };
	}
}

/* Clears the words of the box and fills the fan's triangles; with a canvas, only those pixels of a cut-out
 * that can change a gain. */
LOD_CLONES static void fill_box(struct lod_footprint *print, const struct box *box, const struct point *p,
	const struct lod_fan *fan, int32_t pixels, const struct lod_canvas *canvas)
{
	bool solid = !fan->cutout || !fan->uv;
	print->y = (uint32_t)box->y0;
	print->rows = (uint32_t)(box->y1 - box->y0) + 1;
	print->word = (uint32_t)box->x0 / 64;
	print->words = (uint32_t)box->x1 / 64 - print->word + 1;
	memset(print->bits, 0, (size_t)print->rows * print->words * sizeof *print->bits);
	for (uint32_t t = 0; t + 2 < fan->corners; t++) {
		const struct point corner[3] = { p[0], p[t + 1], p[t + 2] };
		struct texture texture;
		if (!solid) {
			const float *const uv[3] = { fan->uv[0], fan->uv[t + 1], fan->uv[t + 2] };
			if (texture_make(&texture, fan->cutout, corner, uv)) {
				texture.canvas = canvas;
				fill(print, corner, &texture, pixels);
			}
		} else {
			fill(print, corner, NULL, pixels);
		}
	}
}

/* With a canvas, only those pixels of a cut-out that can change a gain. */
LOD_INLINE bool cover(struct lod_footprint *print,
	const struct lod_fan_seen *seen, double edge, uint32_t pixels, const struct lod_canvas *canvas)
{
	struct point p[ECO_CORNERS_MAX] = { { 0, 0 } };
	const struct lod_fan *fan = &seen->fan;
	struct box box;
	project(p, seen, edge, pixels);
	if (!find_box(&box, p, fan->corners, (int32_t)pixels))
		return false;
	if (!seen->way || edge > EDGE_WHOLE) {
		fill_box(print, &box, p, fan, (int32_t)pixels, canvas);
		return true;
	}
	struct spans spans;
	find_spans(&spans, &box, p, fan->corners, seen->way);
	print->y = (uint32_t)box.y0;
	print->rows = (uint32_t)spans.rows;
	print->word = (uint32_t)box.x0 / 64;
	print->words = (uint32_t)box.x1 / 64 - print->word + 1;
	memset(print->bits, 0, (size_t)print->rows * print->words * sizeof *print->bits);
	uint64_t *row = print->bits - print->word;
	for (int32_t y = 0; y < spans.rows; y++, row += print->words)
		if (spans.left[y] < spans.right[y])
			set_bits(row, spans.left[y], spans.right[y]);
	return true;
}

LOD_CLONES bool lod_fan_cover(struct lod_footprint *print, const struct lod_fan_seen *seen, double edge,
	uint32_t pixels)
{
	return cover(print, seen, edge, pixels, NULL);
}

/* ---- Counting ---- */

LOD_INLINE void count(uint64_t bits, const struct lod_canvas *canvas,
	size_t at, struct lod_gain *gain)
{
	const uint64_t *times = canvas->times[at], reference = canvas->reference[at];
	uint64_t fresh = bits & ~times[0];
	gain->right += lod_bits_of(fresh & reference);
	gain->wrong += lod_bits_of(fresh & ~reference);
	gain->second += lod_bits_of(bits & times[0] & ~times[1] & reference);
}

LOD_CLONES void lod_footprint_gain(const struct lod_footprint *print, const struct lod_canvas *canvas,
	struct lod_gain *gain)
{
	const uint64_t *bits = print->bits;
	struct lod_gain sum = *gain;
	for (uint32_t r = 0; r < print->rows; r++) {
		size_t at = (size_t)(print->y + r) * canvas->row_words + print->word;
		for (uint32_t w = 0; w < print->words; w++, bits++)
			if (*bits)
				count(*bits, canvas, at + w, &sum);
	}
	*gain = sum;
}

LOD_CLONES void lod_fan_gain(const struct lod_fan_seen *seen, double edge, uint32_t pixels,
	const struct lod_canvas *canvas, struct lod_gain *gain)
{
	struct point p[ECO_CORNERS_MAX] = { { 0, 0 } };
	const struct lod_fan *fan = &seen->fan;
	struct box box;
	project(p, seen, edge, pixels);
	if (!find_box(&box, p, fan->corners, (int32_t)pixels))
		return;
	if (!seen->way || edge > EDGE_WHOLE) {
		struct lod_footprint print;
		fill_box(&print, &box, p, fan, (int32_t)pixels, canvas);
		lod_footprint_gain(&print, canvas, gain);
		return;
	}
	struct spans spans;
	struct lod_gain sum = *gain;
	find_spans(&spans, &box, p, fan->corners, seen->way);
	for (int32_t y = 0; y < spans.rows; y++) {
		int32_t left = spans.left[y], right = spans.right[y];
		if (left >= right)
			continue;
		uint32_t a = (uint32_t)left / 64, b = (uint32_t)(right - 1) / 64;
		uint64_t low = ~UINT64_C(0) << ((uint32_t)left % 64),
			high = ~UINT64_C(0) >> (63 - (uint32_t)(right - 1) % 64);
		size_t row = (size_t)(spans.y + y) * canvas->row_words;
		if (a == b) {
			count(low & high, canvas, row + a, &sum);
			continue;
		}
		count(low, canvas, row + a, &sum);
		for (uint32_t w = a + 1; w < b; w++)
			count(~UINT64_C(0), canvas, row + w, &sum);
		count(high, canvas, row + b, &sum);
	}
	*gain = sum;
}

LOD_CLONES void lod_fan_add(const struct lod_fan_seen *seen, double edge, uint32_t pixels,
	const struct lod_canvas *canvas)
{
	struct lod_footprint print;
	if (!cover(&print, seen, edge, pixels, canvas))
		return;
	const uint64_t *bits = print.bits;
	for (uint32_t r = 0; r < print.rows; r++) {
		uint64_t (*times)[2] = canvas->times + (size_t)(print.y + r) * canvas->row_words + print.word;
		for (uint32_t w = 0; w < print.words; w++, bits++) {
			times[w][1] |= *bits & times[w][0];
			times[w][0] |= *bits;
		}
	}
}
