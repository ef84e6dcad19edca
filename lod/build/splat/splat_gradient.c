/* One picture of splats, its Q against the plant's, and the gradient of that.
 *
 * A splat is an ellipse on the screen: q = x^T C^-1 x <= 1, C = P A A^T P^T. Its edge is softened to a ramp t
 * = (1 + w - q) / 2w, smoothed by t^2 (3 - 2t), so that a pixel beside it pulls, and the area stays that of
 * the ellipse. The shares that splats leave free are multiplied, so that their order does not matter. */
#include <math.h>
#include <string.h>

#include "lod/build/splat/splat_state.h"
#include "lod/lanes.h"

#define MOST 0.99f               /* of a pixel that one splat may cover: division tells what others cover */
#define LEAST_PX2 0.01f          /* square of a half axis on the screen */

static float dot3(const double a[3], const float *b)
{
	return (float)a[0] * b[0] + (float)a[1] * b[1] + (float)a[2] * b[2];
}

static int32_t clamp_to(float at, uint32_t pixels)
{
	return at <= 0 ? 0 : at >= (float)pixels ? (int32_t)pixels : (int32_t)at;
}

static void project(struct splat_ellipse *e, const struct splat_views *views, const struct splat_view *view,
	const struct splat_params *splat, const struct splat_softness *soft)
{
	float s = views->scale, middle = 0.5f * (float)views->pixels, c[3] = { LEAST_PX2, 0, LEAST_PX2 };
	e->x = middle + s * dot3(view->right, splat->v);
	e->y = middle + s * dot3(view->down, splat->v);
	for (int k = 0; k < 3; k++) {
		e->b[0][k] = s * dot3(view->right, splat->v + SPLAT_AXES + 3 * k);
		e->b[1][k] = s * dot3(view->down, splat->v + SPLAT_AXES + 3 * k);
		c[0] += e->b[0][k] * e->b[0][k];
		c[1] += e->b[0][k] * e->b[1][k];
		c[2] += e->b[1][k] * e->b[1][k];
	}
	memcpy(e->c, c, sizeof c);
	e->det = c[0] * c[2] - c[1] * c[1];
	c[0] += soft->blur_px2;
	c[2] += soft->blur_px2;
	e->soft_det = c[0] * c[2] - c[1] * c[1];
	e->m[0] = c[2] / e->soft_det;
	e->m[1] = -c[1] / e->soft_det;
	e->m[2] = c[0] / e->soft_det;
	float least = LEAST_PX2 * LEAST_PX2;
	e->det = e->det > least ? e->det : least;
	e->amp = sqrtf(e->det / e->soft_det);
	e->alpha = splat->v[SPLAT_OPACITY] * e->amp * MOST;
	float thin = sqrtf(2 * e->soft_det / (c[0] + c[2])), wide = 2 * soft->edge_px / thin;
	wide = wide > soft->least ? wide : soft->least;
	wide = wide < 1 ? wide : 1;
	e->high = (1 + wide) / (2 * wide);
	e->slope = 1 / (2 * wide);
	float half_x = sqrtf(c[0] * (1 + wide)), half_y = sqrtf(c[2] * (1 + wide));
	e->x0 = clamp_to(e->x - half_x + 0.5f, views->pixels);
	e->x1 = clamp_to(e->x + half_x + 0.5f, views->pixels);
	e->y0 = clamp_to(e->y - half_y + 0.5f, views->pixels);
	e->y1 = clamp_to(e->y + half_y + 0.5f, views->pixels);
}

LOD_INLINE lod_f4 ramp(const struct splat_ellipse *e, lod_f4 dx, float dy)
{
	lod_f4 q = (lod_f4_all(e->m[0]) * dx + lod_f4_all(2 * e->m[1] * dy)) * dx
		+ lod_f4_all(e->m[2] * dy * dy);
	lod_f4 t = lod_f4_all(e->high) - lod_f4_all(e->slope) * q;
	return lod_f4_min(lod_f4_max(t, lod_f4_all(0)), lod_f4_all(1));
}

LOD_INLINE lod_f4 smooth(lod_f4 t)
{
	return t * t * (lod_f4_all(3) - lod_f4_all(2) * t);
}

static const lod_f4 steps = { 0, 1, 2, 3 };

/* Two fours at once, the same bits: of pixels x to x + 8 the distances, ramp and smoothed ramp. */
struct eight { lod_f8 dx, t, s; };

LOD_INLINE void look_at_eight(struct eight *at, const struct splat_ellipse *e, int32_t x, float dy)
{
	float a = (float)x + 0.5f - e->x, b = (float)(x + 4) + 0.5f - e->x;
	at->dx = (lod_f8){ 0, 1, 2, 3, 0, 1, 2, 3 } + (lod_f8){ a, a, a, a, b, b, b, b };
	lod_f8 q = (e->m[0] * at->dx + 2 * e->m[1] * dy) * at->dx + e->m[2] * dy * dy,
		t = e->high - e->slope * q;
	t = (lod_f8)((lod_i8)t & (t > 0));
	lod_i8 below = t < 1;
	at->t = (lod_f8)(((lod_i8)t & below) | ((lod_i8)((lod_f8){ 0 } + 1) & ~below));
	at->s = at->t * at->t * (3 - 2 * at->t);
}

static void clear(const struct splat_views *views, float *left)
{
	size_t count = (size_t)views->pixels * views->stride;
	for (size_t i = 0; i < count; i++)
		left[i] = 1;
}

/* The part of a picture that ellipses may touch: columns from and to a multiple of four. */
struct box { uint32_t x0, x1, y0, y1; };

static uint32_t up_to_four(uint32_t x) { return (x + 3) & ~UINT32_C(3); }

static struct box find_box(const struct splat_views *views, const struct splat_ellipse *e, uint32_t count)
{
	int32_t x0 = INT32_MAX, x1 = 0, y0 = INT32_MAX, y1 = 0;
	for (uint32_t i = 0; i < count; i++) {
		if (e[i].x0 >= e[i].x1 || e[i].y0 >= e[i].y1)
			continue;
		x0 = e[i].x0 < x0 ? e[i].x0 : x0, x1 = e[i].x1 > x1 ? e[i].x1 : x1;
		y0 = e[i].y0 < y0 ? e[i].y0 : y0, y1 = e[i].y1 > y1 ? e[i].y1 : y1;
	}
	if (x0 >= x1)
		return (struct box){ 0, 0, 0, 0 };
	uint32_t most = up_to_four(views->pixels), right = up_to_four((uint32_t)x1) + 4;
	return (struct box){ (uint32_t)x0 & ~UINT32_C(3), right < most ? right : most, (uint32_t)y0,
		(uint32_t)y1 };
}

/* Also what lies beside the picture where the box reaches its border. */
LOD_INLINE void clear_box(const struct splat_views *views, const struct box *box, float *left)
{
	uint32_t end = box->x1 + 4 < views->stride ? box->x1 + 4 : views->stride;
	for (uint32_t y = box->y0; y < box->y1; y++)
		for (uint32_t x = box->x0; x < end; x++)
			left[(size_t)y * views->stride + x] = 1;
}

/* Ellipses are copied: what is drawn might else be taken for them. */
LOD_INLINE void draw(const struct splat_ellipse *drawn, float *free, uint32_t stride)
{
	const struct splat_ellipse own = *drawn, *e = &own;
	lod_f4 one = lod_f4_all(1), alpha = lod_f4_all(e->alpha);
	for (int32_t y = e->y0; y < e->y1; y++) {
		float dy = (float)y + 0.5f - e->y, *row = free + (size_t)y * stride;
		int32_t x = e->x0;
		for (; x + 4 < e->x1; x += 8) {
			struct eight at;
			lod_f8 left;
			look_at_eight(&at, e, x, dy);
			memcpy(&left, row + x, sizeof left);
			left *= 1 - e->alpha * at.s;
			memcpy(row + x, &left, sizeof left);
		}
		if (x < e->x1) {
			lod_f4 dx = steps + lod_f4_all((float)x + 0.5f - e->x);
			lod_f4 s = smooth(ramp(e, dx, dy));
			lod_f4_store(row + x, lod_f4_load(row + x) * (one - alpha * s));
		}
	}
}

static float sum4(lod_f4 v) { return v[0] + v[1] + (v[2] + v[3]); }

/* Adds the lower four, then the upper four, as one after the other. */
#define ADD_EIGHT(sum, eight) do { \
	lod_f8 added = (eight); \
	(sum) += __builtin_shufflevector(added, added, 0, 1, 2, 3); \
	(sum) += __builtin_shufflevector(added, added, 4, 5, 6, 7); \
} while (0)

/* `weight`: derivative of the loss by what is left free, times that. */
LOD_INLINE void pull(const struct splat_ellipse *drawn, const struct splat_views *views,
	const struct splat_view *view, const float *weight, float opacity, struct splat_params *gradient)
{
	const struct splat_ellipse own = *drawn, *e = &own;
	lod_f4 one = lod_f4_all(1), alpha = lod_f4_all(e->alpha), zero = lod_f4_all(0);
	lod_f4 sx = zero, sy = zero, sxx = zero, sxy = zero, syy = zero, so = zero;
	for (int32_t y = e->y0; y < e->y1; y++) {
		float dy = (float)y + 0.5f - e->y;
		const float *row = weight + (size_t)y * views->stride;
		lod_f4 rx = zero, r = zero;
		int32_t x = e->x0;
		for (; x + 4 < e->x1; x += 8) {
			struct eight at;
			lod_f8 u;
			look_at_eight(&at, e, x, dy);
			memcpy(&u, row + x, sizeof u);
			u /= 1 - e->alpha * at.s;
			ADD_EIGHT(so, u * at.s);
			u = u * at.t * (1 - at.t);
			ADD_EIGHT(r, u);
			u *= at.dx;
			ADD_EIGHT(rx, u);
			ADD_EIGHT(sxx, u * at.dx);
		}
		if (x < e->x1) {
			lod_f4 dx = steps + lod_f4_all((float)x + 0.5f - e->x), t = ramp(e, dx, dy),
				s = smooth(t), u = lod_f4_load(row + x) / (one - alpha * s);
			so += u * s;
			u = u * t * (one - t);
			r += u;
			rx += u * dx;
			sxx += u * dx * dx;
		}
		lod_f4 d = lod_f4_all(dy);
		sx += rx;
		sy += r * d;
		sxy += rx * d;
		syy += r * d * d;
	}
	/* w = dL/dq = -6 alpha slope u t (1 - t) */
	float factor = -6 * e->alpha * e->slope, o = sum4(so), x = factor * sum4(sx), y = factor * sum4(sy),
		xx = factor * sum4(sxx), xy = factor * sum4(sxy), yy = factor * sum4(syy);
	const float *m = e->m;
	float gx = -2 * (m[0] * x + m[1] * y), gy = -2 * (m[1] * x + m[2] * y);
	/* G = dL/dC = -M S M, and through the amplitude alpha (C^-1 - M) / 2 */
	float p[2][2] = { { m[0] * xx + m[1] * xy, m[0] * xy + m[1] * yy },
		{ m[1] * xx + m[2] * xy, m[1] * xy + m[2] * yy } };
	float half = 0.5f * e->alpha * o;
	float g[3] = { -(p[0][0] * m[0] + p[0][1] * m[1]) + half * (e->c[2] / e->det - m[0]),
		-(p[0][0] * m[1] + p[0][1] * m[2]) + half * (-e->c[1] / e->det - m[1]),
		-(p[1][0] * m[1] + p[1][1] * m[2]) + half * (e->c[0] / e->det - m[2]) };
	float scale = views->scale;
	for (int k = 0; k < 3; k++) {
		float bx = 2 * scale * (g[0] * e->b[0][k] + g[1] * e->b[1][k]),
			by = 2 * scale * (g[1] * e->b[0][k] + g[2] * e->b[1][k]);
		for (int i = 0; i < 3; i++)
			gradient->v[SPLAT_AXES + 3 * k + i] += bx * (float)view->right[i]
				+ by * (float)view->down[i];
	}
	for (int i = 0; i < 3; i++)
		gradient->v[i] += scale * (gx * (float)view->right[i] + gy * (float)view->down[i]);
	gradient->v[SPLAT_OPACITY] += opacity > 0 ? o * e->alpha / opacity : 0;
}

struct sums { double drawn, both, covered; };

static struct box whole(const struct splat_views *views)
{
	return (struct box){ 0, views->pixels, 0, views->pixels };
}

/* The share that a row of a picture draws, and draws rightly. */
struct row { double drawn, both; };

LOD_INLINE struct row count_row(const struct splat_views *views, const struct splat_view *view,
	const float *left, float chance, uint32_t y, const struct box *box)
{
	size_t plane = (size_t)views->pixels * views->stride, first = (size_t)y * views->stride;
	lod_f4 drawn = lod_f4_all(0), both = drawn, one = lod_f4_all(1);
	for (uint32_t x = box->x0; x < box->x1; x += 4) {
		lod_f4 a = one - lod_f4_load(left + first + x);
		drawn += a;
		for (uint32_t k = 0; k < views->planes; k++) {
			lod_f4 b = lod_f4_load(view->cover + k * plane + first + x);
			both += lod_f4_all(1 - chance) * lod_f4_min(a, b) + lod_f4_all(chance) * a * b;
		}
	}
	return (struct row){ sum4(drawn) * (float)views->planes, sum4(both) };
}

LOD_INLINE struct sums count_view(const struct splat_views *views, const struct splat_view *view,
	const float *left, float chance, const struct box *box)
{
	struct sums sums = { 0, 0, view->covered };
	for (uint32_t y = box->y0; y < box->y1; y++) {
		struct row row = count_row(views, view, left, chance, y, box);
		sums.drawn += row.drawn;
		sums.both += row.both;
	}
	return sums;
}

/* Turns what is left free into weights: derivative by it, times it. */
LOD_INLINE void weigh(const struct splat_views *views, const struct splat_view *view,
	const struct splat_picture *picture, const struct box *box, float chance, float by_drawn,
	float by_both)
{
	size_t plane = (size_t)views->pixels * views->stride;
	float all = (float)views->planes * by_drawn;
	for (uint32_t y = box->y0; y < box->y1; y++) {
		size_t row = (size_t)y * views->stride;
		lod_f4 one = lod_f4_all(1);
		for (uint32_t x = box->x0; x < box->x1; x += 4) {
			lod_f4 left = lod_f4_load(picture->free + row + x), share = lod_f4_all(0);
			for (uint32_t k = 0; k < views->planes; k++) {
				lod_f4 b = lod_f4_load(view->cover + k * plane + row + x);
				share += lod_f4_select(one - left < b, lod_f4_all(1 - chance), lod_f4_all(0))
					+ lod_f4_all(chance) * b;
			}
			lod_f4_store(picture->weight + row + x, left
				* (lod_f4_all(all) + lod_f4_all(by_both) * share));
		}
	}
}

/* The plant's own pixels where nothing is in front of an ellipse. */
struct shown { struct lod_light light; double wood, square; };

static void add_shown(const struct splat_ellipse *e, const struct splat_views *views,
	const struct splat_view *view, float *left, struct shown *shown)
{
	for (int32_t y = e->y0; y < e->y1; y++) {
		float dy = (float)y + 0.5f - e->y, *row = left + (size_t)y * views->stride;
		const float *cover = view->cover + (size_t)y * views->stride;
		for (int32_t x = e->x0; x < e->x1; x += 4) {
			lod_f4 dx = steps + lod_f4_all((float)x + 0.5f - e->x), free = lod_f4_load(row + x),
				drawn = free * lod_f4_all(e->alpha) * smooth(ramp(e, dx, dy));
			lod_f4_store(row + x, free - drawn);
			for (int32_t i = 0; i < 4 && x + i < e->x1; i++) {
				double weight = (double)drawn[i] * cover[x + i];
				const float *from = view->light[(size_t)y * views->pixels
					+ (size_t)(x + i)];
				for (int k = 0; k < 3; k++)
					shown->light.sum[k] += weight * from[k];
				shown->light.weight += weight;
				shown->wood += weight * from[3];
				shown->square += weight * from[4];
			}
		}
	}
}

/* `order`: from the nearest to the farthest. */
static void view_shown(const struct splat_views *views, uint32_t view_index, const struct splat_params *splats,
	const struct lod_keyed *order, uint32_t count, const struct splat_picture *picture,
	struct shown *shown)
{
	const struct splat_view *view = &views->items[view_index];
	struct splat_ellipse e;
	clear(views, picture->free);
	for (uint32_t i = 0; i < count; i++) {
		uint32_t at = order[i].value;
		project(&e, views, view, &splats[at], &(struct splat_softness){ .edge_px = 0.5f });
		add_shown(&e, views, view, picture->free, &shown[at]);
	}
}

/* Draws splats over nothing: the share of each pixel that they leave free. */
LOD_CLONES static void view_draw(const struct splat_views *views, uint32_t view,
	const struct splat_params *splats, uint32_t count, const struct splat_softness *soft, float *left)
{
	struct splat_ellipse e;
	clear(views, left);
	for (uint32_t i = 0; i < count; i++) {
		project(&e, views, &views->items[view], &splats[i], soft);
		draw(&e, left, views->stride);
	}
}

LOD_INLINE void draw_back(const struct splat_ellipse *e, float *left, uint32_t stride)
{
	lod_f4 one = lod_f4_all(1), alpha = lod_f4_all(e->alpha);
	for (int32_t y = e->y0; y < e->y1; y++) {
		float dy = (float)y + 0.5f - e->y, *row = left + (size_t)y * stride;
		for (int32_t x = e->x0; x < e->x1; x += 4) {
			lod_f4 dx = steps + lod_f4_all((float)x + 0.5f - e->x);
			lod_f4_store(row + x, lod_f4_load(row + x) / (one - alpha * smooth(ramp(e, dx, dy))));
		}
	}
}

static double loss_of(const struct sums *sums, double *drawn, double *p, double *r)
{
	*drawn = sums->drawn > 1e-3 ? sums->drawn : 1e-3;
	*p = 1 - sums->both / *drawn;
	*r = 1 - sums->both / sums->covered;
	return sqrt(*p * *p + *r * *r);
}

static double score_of(const struct sums *sums)
{
	double drawn, p, r;
	return sums->covered > 0 ? loss_of(sums, &drawn, &p, &r) : 0;
}

/* 1 - Q of that picture, and its rows. */
LOD_CLONES static double view_score(const struct splat_views *views, uint32_t view, const float *left,
	float chance, struct row *rows)
{
	struct sums sums = { 0, 0, views->items[view].covered };
	const struct box box = whole(views);
	for (uint32_t y = 0; y < views->pixels; y++) {
		rows[y] = count_row(views, &views->items[view], left, chance, y, &box);
		sums.drawn += rows[y].drawn;
		sums.both += rows[y].both;
	}
	return score_of(&sums);
}

/* Rows that an ellipse draws in, beside those so far. */
static void reach(const struct splat_ellipse *e, int32_t rows[2])
{
	rows[0] = e->y0 < rows[0] ? e->y0 : rows[0];
	rows[1] = e->y1 > rows[1] ? e->y1 : rows[1];
}

/* Some splats of a picture, at most EXCHANGED, are taken out and others put in. */
#define EXCHANGED 8u
struct exchange { const struct splat_params *out, *in; uint32_t out_count, in_count; };

/* 1 - Q of the picture after that. Only rows that these splats reach are looked at. `trial`: scratch. */
LOD_CLONES static double view_replace(const struct splat_views *views, uint32_t view,
	const struct exchange *what, const struct splat_softness *soft, const float *left,
	const struct row *rows, float *trial)
{
	struct splat_ellipse e[EXCHANGED];
	const struct splat_view *seen = &views->items[view];
	struct sums sums = { 0, 0, seen->covered };
	int32_t touched[2] = { (int32_t)views->pixels, 0 };
	const struct box box = whole(views);
	uint32_t count = what->out_count + what->in_count;
	for (uint32_t i = 0; i < count; i++) {
		project(&e[i], views, seen, i < what->out_count ? &what->out[i]
			: &what->in[i - what->out_count], soft);
		reach(&e[i], touched);
	}
	if (touched[0] < touched[1])
		memcpy(trial + (size_t)touched[0] * views->stride, left + (size_t)touched[0] * views->stride,
			(size_t)(touched[1] - touched[0]) * views->stride * sizeof *trial);
	for (uint32_t i = 0; i < count; i++) {
		if (i < what->out_count)
			draw_back(&e[i], trial, views->stride);
		else
			draw(&e[i], trial, views->stride);
	}
	for (int32_t y = 0; y < (int32_t)views->pixels; y++) {
		struct row row = y < touched[0] || y >= touched[1] ? rows[y]
			: count_row(views, seen, trial, soft->chance, (uint32_t)y, &box);
		sums.drawn += row.drawn;
		sums.both += row.both;
	}
	return score_of(&sums);
}

LOD_CLONES double splat_view_loss(const struct splat_views *views, uint32_t view_index,
	const struct splat_params *splats, uint32_t count, uint32_t moving, const struct splat_softness *soft,
	const struct splat_picture *picture, struct splat_params *gradient)
{
	const struct splat_view *view = &views->items[view_index];
	struct splat_ellipse *e = picture->ellipses;
	for (uint32_t i = 0; i < count; i++)
		project(&e[i], views, view, &splats[i], soft);
	const struct box box = find_box(views, e, count);
	clear_box(views, &box, picture->free);
	for (uint32_t i = 0; i < count; i++)
		draw(&e[i], picture->free, views->stride);
	struct sums sums = count_view(views, view, picture->free, soft->chance, &box);
	if (!(sums.covered > 0))
		return 0;
	double drawn, p, r, loss = loss_of(&sums, &drawn, &p, &r), more = sums.drawn / sums.covered - 1,
		factor = 1 + (double)soft->area * more * more;
	if (!(loss > 1e-6))
		return loss;
	weigh(views, view, picture, &box, soft->chance, (float)(factor * p * sums.both / (drawn * drawn) / loss
		+ 2 * (double)soft->area * more / sums.covered * loss),
		(float)(-factor * (p / drawn + r / sums.covered) / loss));
	for (uint32_t i = 0; i < moving; i++)
		pull(&e[i], views, view, picture->weight, splats[i].v[SPLAT_OPACITY], &gradient[i]);
	return factor * loss;
}

/* ---- Gains ---- */

/* The gain of a splat that gives way to its children: the mean of the gain among parents and the gain among
 * children, as it is the less the more its neighbours cover. */
#define VIEW_STEP 4u             /* every fourth view decides */

struct gains {
	const struct splat_views *views;
	const struct splat_params *parents, *level;
	uint32_t count, children;
	struct splat_softness soft;
	float *coarse, *fine, *trial;
	struct row *rows[2];       /* of `fine`, of `coarse` */
	double *gain;
};

static double trial_score(const struct gains *g, uint32_t view, uint32_t parent, bool finer)
{
	const struct splat_params *one = &g->parents[parent], *many = &g->level[(size_t)parent * g->children];
	struct exchange what = finer ? (struct exchange){ one, many, 1, g->children }
		: (struct exchange){ many, one, g->children, 1 };
	return view_replace(g->views, view, &what, &g->soft, finer ? g->coarse : g->fine,
		g->rows[finer], g->trial);
}

static void add_view(const struct gains *g, uint32_t view)
{
	view_draw(g->views, view, g->parents, g->count, &g->soft, g->coarse);
	view_draw(g->views, view, g->level, g->count * g->children, &g->soft, g->fine);
	double coarse = view_score(g->views, view, g->coarse, g->soft.chance, g->rows[1]),
		fine = view_score(g->views, view, g->fine, g->soft.chance, g->rows[0]);
	for (uint32_t i = 0; i < g->count; i++)
		g->gain[i] += coarse - trial_score(g, view, i, true) + trial_score(g, view, i, false) - fine;
}

void splat_gains(const struct splat_views *views, const struct splat_params *parents, uint32_t count,
	const struct splat_params *level, uint32_t children, struct lod_arena *arena, double *gain)
{
	const struct lod_arena_piece *mark = arena->last;
	size_t pixels = (size_t)views->pixels * views->stride;
	struct gains g = { .views = views, .parents = parents, .level = level, .count = count,
		.children = children, .soft = { .edge_px = 0.6f, .blur_px2 = 0.2f, .chance = 0.6f },
		.gain = gain };
	g.coarse = lod_arena_take(arena, pixels, sizeof *g.coarse);
	g.fine = lod_arena_take(arena, pixels, sizeof *g.fine);
	g.trial = lod_arena_take(arena, pixels, sizeof *g.trial);
	for (int i = 0; i < 2; i++)
		g.rows[i] = lod_arena_take(arena, views->pixels, sizeof *g.rows[i]);
	memset(gain, 0, count * sizeof *gain);
	for (uint32_t view = 0; view < views->count; view += VIEW_STEP)
		add_view(&g, view);
	lod_arena_release(arena, mark);
}

/* ---- Colours ---- */

static void sort_by_depth(const struct splat_view *view, const struct splat_params *splats, uint32_t count,
	struct lod_arena *arena, struct lod_keyed *order)
{
	for (uint32_t i = 0; i < count; i++) {
		double depth = 0;
		for (int k = 0; k < 3; k++)
			depth += view->forward[k] * (double)splats[i].v[k];
		order[i] = (struct lod_keyed){ lod_sort_key(depth), i };
	}
	lod_sort(arena, order, count);
}

/* The mean deviation of the light of what foliage splats stand for from their colours, over the mean. */
static double tone_of(const struct shown *shown, const struct lod_splat *splats, uint32_t count)
{
	double variance = 0, mean = 0, weight = 0;
	for (uint32_t i = 0; i < count; i++) {
		const struct lod_light *light = &shown[i].light;
		if (splats[i].shape.wood || !(light->weight > 0))
			continue;
		double own = lod_light_gray(light->sum);
		variance += fmax(shown[i].square - own * own / light->weight, 0);
		mean += own;
		weight += light->weight;
	}
	return mean > 0 ? sqrt(variance * weight) / mean : 0;
}

double splat_color_level(const struct splat_views *views, const struct splat_params *splats, uint32_t count,
	const struct lod_splat *parents, uint32_t children, struct lod_arena *arena, struct lod_splat *out)
{
	static const uint8_t grey[3] = { 128, 128, 128 };
	const struct lod_arena_piece *mark = arena->last;
	size_t pixels = (size_t)views->pixels * views->stride;
	struct lod_keyed *order = lod_arena_take(arena, count, sizeof *order);
	struct shown *shown = lod_arena_take(arena, count, sizeof *shown);
	struct splat_picture picture = { lod_arena_take(arena, pixels, sizeof(float)), NULL, NULL };
	for (uint32_t view = 0; view < views->count; view++) {
		sort_by_depth(&views->items[view], splats, count, arena, order);
		view_shown(views, view, splats, order, count, &picture, shown);
	}
	for (uint32_t i = 0; i < count; i++) {
		memcpy(out[i].rgb, parents ? parents[i / children].rgb : grey, 3);
		out[i].wood = parents ? parents[i / children].wood : 0;
		if (shown[i].light.weight > 0.25) {
			lod_light_mean(&shown[i].light, out[i].rgb);
			out[i].wood = (float)(shown[i].wood / shown[i].light.weight);
		}
		out[i].shape.wood = out[i].wood > 0.5f;
		out[i].code[6] += out[i].shape.wood ? (int32_t)ECO_SPLAT_OPACITIES : 0;
	}
	double tone = tone_of(shown, out, count);
	lod_arena_release(arena, mark);
	return tone;
}
