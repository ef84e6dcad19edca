/* Drawing batches: from object space to corners on the grid of 1/256 pixel, four triangles at a time; those
 * whose snapped bounding box holds no pixel centre end there. Triangles that cross the near plane or leave
 * the guard band are clipped in doubles. Both paths do the same float operations in the same order on a
 * corner, and clip an edge from its inner end, so neighbours have the same snapped corners. */
#include <assert.h>
#include <math.h>

#include "lod/raster/raster_state.h"

struct soup {                        /* triangles in the space that `matrix` projects from */
	const float (*matrix)[4];
	const float *position, *uv;
	uint32_t count, item, per_item;  /* number of the first triangles' item; triangles that share one */
};

struct screen {                      /* the four-wide constants of a batch */
	lod_f4 matrix[3][4], near_w;
	lod_i4 middle_x, middle_y, width, height;
};

struct lanes { unsigned small, large, clip; };       /* which path each of four triangles takes: a bit each,
                                                      * no bit twice */

static void screen_make(struct screen *screen, const struct lod_raster *raster, const float (*matrix)[4])
{
	for (int i = 0; i < 12; i++)
		screen->matrix[i / 4][i % 4] = lod_f4_all(matrix[i / 4][i % 4]);
	screen->near_w = lod_f4_all(raster->state->near_w);
	screen->middle_x = lod_i4_all((int32_t)raster->width * (LOD_SUBPIXEL / 2));
	screen->middle_y = lod_i4_all((int32_t)raster->height * (LOD_SUBPIXEL / 2));
	screen->width = lod_i4_all((int32_t)raster->width);
	screen->height = lod_i4_all((int32_t)raster->height);
}

static inline lod_f4 row_dot(const lod_f4 row[4], const lod_f4 p[3])
{
	return row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
}

/* The same for one point, operation for operation. */
static void transform(const float (*matrix)[4], const float p[3], float out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = matrix[i][0] * p[0] + matrix[i][1] * p[1] + matrix[i][2] * p[2] + matrix[i][3];
}

static inline void load_four(const float *p, lod_f4 c[9])
{
	for (int i = 0; i < 4; i++) {
		c[i] = lod_f4_load(p + 9 * i);
		c[4 + i] = lod_f4_load(p + 9 * i + 4);
	}
	lod_f4_transpose(c);
	lod_f4_transpose(c + 4);
	c[8] = (lod_f4){ p[8], p[17], p[26], p[35] };
}

static inline lod_f4 f4_min3(const lod_f4 a[3]) { return lod_f4_min(lod_f4_min(a[0], a[1]), a[2]); }
static inline lod_f4 f4_max3(const lod_f4 a[3]) { return lod_f4_max(lod_f4_max(a[0], a[1]), a[2]); }

/* The pixels with centres in [low, high] (from the middle). Rounding is monotone, so snapping the least
 * corner gives the least. */
static inline void centres(lod_f4 low, lod_f4 high, lod_i4 middle, lod_i4 *first, lod_i4 *last)
{
	*first = lod_i4_add(lod_f4_round(low, middle), LOD_SUBPIXEL / 2 - 1) >> 8;
	*last = lod_i4_add(lod_f4_round(high, middle), -LOD_SUBPIXEL / 2) >> 8;
}

static inline struct lanes project_four(const struct screen *screen, const lod_f4 c[9], struct lod_four *four)
{
	const lod_f4 guard = lod_f4_all(LOD_GUARD);
	lod_f4 x[3], y[3];
	lod_i4 inside = lod_i4_all(-1), before = lod_i4_all(0);
	for (int i = 0; i < 3; i++) {
		lod_f4 w = row_dot(screen->matrix[2], c + 3 * i);
		four->z[i] = lod_f4_all(1.0f) / w;
		x[i] = row_dot(screen->matrix[0], c + 3 * i) * four->z[i];
		y[i] = row_dot(screen->matrix[1], c + 3 * i) * four->z[i];
		lod_i4 before_near = w >= screen->near_w;
		inside &= before_near & (lod_f4_abs(x[i]) <= guard) & (lod_f4_abs(y[i]) <= guard);
		before |= before_near;
	}
	centres(f4_min3(x), f4_max3(x), screen->middle_x, &four->first_x, &four->last_x);
	centres(f4_min3(y), f4_max3(y), screen->middle_y, &four->first_y, &four->last_y);
	lod_i4 hit = inside & (four->first_x <= four->last_x) & (four->first_y <= four->last_y);
	struct lanes lanes = { 0, lod_i4_bits(hit), lod_i4_bits(before & ~inside) };
	if (!lanes.large)
		return lanes;
	lod_i4 within = hit & (four->first_x >= 0) & (four->last_x < screen->width) & (four->first_y >= 0)
		& (four->last_y < screen->height);
	lanes.small =
		lod_i4_bits(within & (four->last_x - four->first_x < LOD_SMALL)
		& (four->last_y - four->first_y < LOD_SMALL));
	lanes.large &= ~lanes.small;
	for (int i = 0; i < 3; i++) {
		four->x[i] = lod_f4_round(x[i], screen->middle_x);
		four->y[i] = lod_f4_round(y[i], screen->middle_y);
	}
	return lanes;
}

/* ---- The slow path: Sutherland-Hodgman in homogeneous coordinates, near plane and guard band ---- */

struct vertex { double x, y, w, u, v; };
#define PLANES 5
#define POLYGON_MAX (3 + PLANES)

static double plane_distance(const struct vertex *p, int plane, double near_w)
{
	switch (plane) {
	case 0: return p->w - near_w;
	case 1: return LOD_GUARD * p->w - p->x;
	case 2: return LOD_GUARD * p->w + p->x;
	case 3: return LOD_GUARD * p->w - p->y;
	default: return LOD_GUARD * p->w + p->y;
	}
}

static struct vertex cross_at(const struct vertex *in, const struct vertex *out, double in_distance,
	double out_distance)
{
	double t = in_distance / (in_distance - out_distance);
	return (struct vertex){ in->x + t * (out->x - in->x), in->y + t * (out->y - in->y),
		in->w + t * (out->w - in->w), in->u + t * (out->u - in->u), in->v + t * (out->v - in->v) };
}

static int clip_polygon(struct vertex *polygon, int count, int plane, double near_w)
{
	struct vertex out[POLYGON_MAX];
	int kept = 0;
	for (int i = 0; i < count; i++) {
		const struct vertex *a = &polygon[i], *b = &polygon[(i + 1) % count];
		double da = plane_distance(a, plane, near_w), db = plane_distance(b, plane, near_w);
		if (da >= 0)
			out[kept++] = *a;
		if (da >= 0 && db < 0)
			out[kept++] = cross_at(a, b, da, db);
		else if (da < 0 && db >= 0)
			out[kept++] = cross_at(b, a, db, da);
	}
	assert(kept <= POLYGON_MAX);
	memcpy(polygon, out, (size_t)kept * sizeof out[0]);
	return kept;
}

static int32_t snap(float at, int32_t middle)
{
	return lod_f4_round(lod_f4_all(at), lod_i4_all(middle))[0];
}

static struct lod_corner corner_of(const struct lod_raster *raster, const struct vertex *p)
{
	float z = 1.0f / (float)p->w;
	return (struct lod_corner){ snap((float)p->x * z, (int32_t)raster->width * (LOD_SUBPIXEL / 2)),
		snap((float)p->y * z, (int32_t)raster->height * (LOD_SUBPIXEL / 2)), z, (float)p->u,
		(float)p->v };
}

static __attribute__((noinline)) void draw_clipped(const struct lod_paint *paint, const struct soup *soup,
	uint32_t triangle)
{
	struct vertex polygon[POLYGON_MAX];
	const struct lod_raster *raster = paint->raster;
	for (uint32_t i = 0; i < 3; i++) {
		float p[3];
		transform(soup->matrix, soup->position + 9 * (size_t)triangle + 3 * i, p);
		if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
			return;
		const float *uv = soup->uv ? soup->uv + 6 * (size_t)triangle + 2 * i : NULL;
		polygon[i] = (struct vertex){ p[0], p[1], p[2], uv ? uv[0] : 0, uv ? uv[1] : 0 };
	}
	int count = 3;
	for (int plane = 0; plane < PLANES && count >= 3; plane++)
		count = clip_polygon(polygon, count, plane, raster->state->near_w);
	for (int i = 2; i < count; i++) {
		struct lod_corner corners[3] = { corner_of(raster, &polygon[0]),
			corner_of(raster, &polygon[i - 1]), corner_of(raster, &polygon[i]) };
		lod_fill_triangle(paint, corners);
	}
}

/* ---- Triangles ---- */

static void draw_lane(const struct lod_paint *paint, const struct soup *soup, const struct lod_four *four,
	unsigned lane, uint32_t triangle)
{
	struct lod_corner corners[3];
	for (int i = 0; i < 3; i++) {
		const float *uv = paint->cutout ? soup->uv + 6 * (size_t)triangle + 2 * i : NULL;
		corners[i] = (struct lod_corner){ four->x[i][lane], four->y[i][lane], four->z[i][lane],
			uv ? uv[0] : 0, uv ? uv[1] : 0 };
	}
	lod_fill_triangle(paint, corners);
}

/* Draws triangle by triangle, for lanes that are not all small and plain. */
static void draw_each(struct lod_paint *paint, const struct soup *soup, const struct lod_four *four,
	struct lanes lanes, uint32_t first)
{
	for (unsigned all = lanes.small | lanes.large | lanes.clip; all; all &= all - 1) {
		unsigned lane = (unsigned)__builtin_ctz(all);
		uint32_t triangle = first + lane;
		paint->item = soup->item + triangle / soup->per_item;
		if (lanes.clip >> lane & 1)
			draw_clipped(paint, soup, triangle);
		else if (lanes.large >> lane & 1 || paint->cutout)
			draw_lane(paint, soup, four, lane, triangle);
		else
			lod_fill_small(paint, four, 1u << lane);
	}
}

/* Those of four triangles whose boxes have an uncovered pixel. */
static unsigned uncovered(const struct lod_paint *paint, const struct lod_four *four, unsigned lanes)
{
	struct lod_raster *raster = (struct lod_raster *)paint->raster;
	int32_t right = (int32_t)raster->width - 1, bottom = (int32_t)raster->height - 1;
	unsigned kept = 0;
	for (unsigned rest = lanes; rest; rest &= rest - 1) {
		unsigned lane = (unsigned)__builtin_ctz(rest);
		int32_t x0 = four->first_x[lane], x1 = four->last_x[lane], y0 = four->first_y[lane],
			y1 = four->last_y[lane];
		if (x0 > right || y0 > bottom || x1 < 0 || y1 < 0)
			continue;
		const uint32_t x[2] = { (uint32_t)(x0 < 0 ? 0 : x0), (uint32_t)(x1 > right ? right : x1) };
		const uint32_t y[2] = { (uint32_t)(y0 < 0 ? 0 : y0), (uint32_t)(y1 > bottom ? bottom : y1) };
		if (!lod_blocks_hide(raster, x, y, INFINITY))
			kept |= 1u << lane;
	}
	return kept;
}

static void draw_soup(struct lod_paint *paint, const struct soup *soup)
{
	struct screen screen;
	screen_make(&screen, paint->raster, soup->matrix);
	bool plain = !paint->cutout && !paint->raster->item;
	for (uint32_t first = 0; first < soup->count; first += 4) {
		const float *position = soup->position + 9 * (size_t)first;
		uint32_t here = soup->count - first < 4 ? soup->count - first : 4;
		float padded[36] = { 0 };
		if (here < 4)
			position = memcpy(padded, position, 9 * here * sizeof(float));
		lod_f4 c[9];
		struct lod_four four;
		load_four(position, c);
		struct lanes lanes = project_four(&screen, c, &four);
		unsigned used = (1u << here) - 1;
		lanes.small &= used, lanes.large &= used, lanes.clip &= used;
		if (paint->silhouette) {
			lanes.small = uncovered(paint, &four, lanes.small);
			lanes.large = uncovered(paint, &four, lanes.large);
		}
		if (plain && !(lanes.large | lanes.clip)) {
			if (lanes.small)
				lod_fill_small(paint, &four, lanes.small);
		} else {
			draw_each(paint, soup, &four, lanes, first);
		}
	}
}

void lod_raster_triangles(struct lod_raster *raster, const struct lod_raster_batch *batch)
{
	struct lod_paint paint = lod_paint_make(raster, batch);
	struct soup soup = { .matrix = raster->state->clip, .position = batch->position,
		.count = batch->count, .item = batch->item, .per_item = 1 };
	if (batch->cutout && batch->uv && batch->cutout->width && batch->cutout->height) {
		paint.cutout = batch->cutout;
		paint.mask = batch->mask;
		soup.uv = batch->uv;
	}
	draw_soup(&paint, &soup);
}

/* ---- Lines ---- */

#define LINES_AT_ONCE 32u

/* The quad of a line in view space as two triangles; false if there is none (no length, seen end on, or not
 * finite). */
static bool line_quad(const struct lod_raster_state *state, const float *ends, float width, float soup[18])
{
	float a[3], b[3];
	transform(state->view, ends, a);
	transform(state->view, ends + 3, b);
	double along[3], to[3], side[3], length2 = 0;
	for (int i = 0; i < 3; i++) {
		along[i] = (double)b[i] - a[i];
		to[i] = 0.5 * ((double)a[i] + b[i]);
	}
	for (int i = 0; i < 3; i++) {
		side[i] = along[(i + 1) % 3] * to[(i + 2) % 3] - along[(i + 2) % 3] * to[(i + 1) % 3];
		length2 += side[i] * side[i];
	}
	double half = 0.5 * width * state->place.scale;
	if (!(length2 > 0 && length2 < INFINITY && half > 0))
		return false;
	double part = half / sqrt(length2);
	for (int i = 0; i < 3; i++) {
		float offset = (float)(side[i] * part);
		soup[i] = soup[9 + i] = a[i] - offset;
		soup[3 + i] = b[i] - offset;
		soup[6 + i] = soup[12 + i] = b[i] + offset;
		soup[15 + i] = a[i] + offset;
	}
	return true;
}

/* A line that has no quad gets one at the eye, which the near plane takes away: so items count on. */
void lod_raster_lines(struct lod_raster *raster, const struct lod_raster_batch *batch)
{
	struct lod_paint paint = lod_paint_make(raster, batch);
	float quads[LINES_AT_ONCE * 18];
	for (uint32_t first = 0; first < batch->count; first += LINES_AT_ONCE) {
		uint32_t here = batch->count - first < LINES_AT_ONCE ? batch->count - first : LINES_AT_ONCE;
		for (uint32_t i = 0; i < here; i++)
			if (!line_quad(raster->state, batch->position + 6 * (size_t)(first + i),
					batch->width[first + i], quads + 18 * i))
				memset(quads + 18 * i, 0, 18 * sizeof *quads);
		struct soup soup = { .matrix = raster->state->project, .position = quads, .count = 2 * here,
			.item = batch->item + first, .per_item = 2 };
		draw_soup(&paint, &soup);
	}
}
