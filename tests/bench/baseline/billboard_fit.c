/* The generators (Kratt 2014, 3.3): two crossed planes, a fitted plane, a strip of fitted planes. */
#include <math.h>

#include "tests/bench/baseline/billboard_state.h"

#define SWEEPS 32
#define THIN 1e-6                    /* half edges are at least this */
#define STEEP 0.2                    /* a section rises along the axis at least so fast */

/* ---- Axes ---- */

static void rotate(double m[3][3], double axes[3][3], int p, int q)
{
	double scale = fabs(m[p][p]) + fabs(m[q][q]);
	if (!(fabs(m[p][q]) > 1e-15 * scale) || !(m[p][q] * m[p][q] > 0))
		return;
	double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]),
		t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1)), c = 1 / sqrt(t * t + 1),
		s = t * c, off = m[p][q];
	m[p][p] -= t * off;
	m[q][q] += t * off;
	m[p][q] = m[q][p] = 0;
	int r = 3 - p - q;
	double rp = m[r][p], rq = m[r][q];
	m[r][p] = m[p][r] = c * rp - s * rq;
	m[r][q] = m[q][r] = s * rp + c * rq;
	for (int k = 0; k < 3; k++) {
		double a = axes[k][p], b = axes[k][q];
		axes[k][p] = c * a - s * b;
		axes[k][q] = s * a + c * b;
	}
}

/* Any unit vector at right angles to a. */
static struct lod_v3 across(struct lod_v3 a)
{
	struct lod_v3 other = fabs(a.z) < 0.7 ? (struct lod_v3){ 0, 0, 1 } : (struct lod_v3){ 1, 0, 0 };
	return lod_v3_unit(lod_v3_cross(other, a));
}

void billboard_jacobi(const double matrix[6], struct lod_v3 axes[3], double values[3])
{
	double m[3][3] = { { matrix[0], matrix[3], matrix[4] }, { matrix[3], matrix[1], matrix[5] },
		{ matrix[4], matrix[5], matrix[2] } },
		columns[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
	int order[3] = { 0, 1, 2 };
	for (int i = 0; i < SWEEPS; i++) {
		rotate(m, columns, 0, 1);
		rotate(m, columns, 0, 2);
		rotate(m, columns, 1, 2);
	}
	for (int i = 0; i < 3; i++)
		for (int k = i + 1; k < 3; k++)
			if (m[order[k]][order[k]] > m[order[i]][order[i]]) {
				int other = order[i];
				order[i] = order[k];
				order[k] = other;
			}
	for (int i = 0; i < 3; i++) {
		values[i] = m[order[i]][order[i]];
		axes[i] = (struct lod_v3){ columns[0][order[i]], columns[1][order[i]], columns[2][order[i]] };
	}
	axes[2] = lod_v3_unit(lod_v3_cross(axes[0], axes[1]));
}

static struct lod_v3 mean_corner(const struct billboard_fit_input *in)
{
	struct lod_v3 sum = { 0, 0, 0 };
	for (uint32_t i = 0; i < in->count; i++)
		for (int k = 0; k < 3; k++)
			sum = lod_v3_add(sum, in->faces[i]->corner[k]);
	return lod_v3_scale(sum, 1.0 / (3.0 * in->count));
}

/* Principal axes of all corners around a point. */
static void widest(const struct billboard_fit_input *in, struct lod_v3 around, struct lod_v3 axes[3])
{
	double m[6] = { 0 }, values[3];
	for (uint32_t i = 0; i < in->count; i++)
		for (int k = 0; k < 3; k++) {
			struct lod_v3 d = lod_v3_sub(in->faces[i]->corner[k], around);
			m[0] += d.x * d.x;
			m[1] += d.y * d.y;
			m[2] += d.z * d.z;
			m[3] += d.x * d.y;
			m[4] += d.x * d.z;
			m[5] += d.y * d.z;
		}
	billboard_jacobi(m, axes, values);
}

struct lod_v3 billboard_axis(const struct billboard_fit_input *in)
{
	struct lod_v3 axes[3], mean = mean_corner(in), axis = lod_v3_sub(mean, in->connector);
	widest(in, mean, axes);
	double reach = 0;
	for (uint32_t i = 0; i < in->count; i++)
		reach = fmax(reach, lod_v3_distance(in->faces[i]->corner[0], in->connector));
	return lod_v3_length(axis) > 1e-3 * reach ? lod_v3_unit(axis) : axes[0];
}

/* ---- Quads ---- */

/* Spanned by unit u and v through `at`, over all corners. */
static struct billboard_quad quad_over(const struct billboard_fit_input *in, struct lod_v3 at,
	struct lod_v3 u, struct lod_v3 v)
{
	double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
	for (uint32_t i = 0; i < in->count; i++)
		for (int k = 0; k < 3; k++) {
			struct lod_v3 d = lod_v3_sub(in->faces[i]->corner[k], at);
			double x = lod_v3_dot(d, u), y = lod_v3_dot(d, v);
			low[0] = fmin(low[0], x);
			high[0] = fmax(high[0], x);
			low[1] = fmin(low[1], y);
			high[1] = fmax(high[1], y);
		}
	at = lod_v3_add(at, lod_v3_scale(u, (low[0] + high[0]) / 2));
	at = lod_v3_add(at, lod_v3_scale(v, (low[1] + high[1]) / 2));
	return (struct billboard_quad){ at, u, v, lod_v3_unit(lod_v3_cross(u, v)),
		fmax((high[0] - low[0]) / 2, THIN), fmax((high[1] - low[1]) / 2, THIN) };
}

static uint32_t fit_plane(struct billboard_quad *quads, const struct billboard_fit_input *in)
{
	struct lod_v3 axes[3], mean = mean_corner(in);
	widest(in, mean, axes);
	quads[0] = quad_over(in, mean, axes[0], axes[1]);
	return 1;
}

/* The direction at right angles to the axis in which the corners lie widest. */
static struct lod_v3 widest_across(const struct billboard_fit_input *in, struct lod_v3 at,
	struct lod_v3 axis)
{
	struct lod_v3 x = across(axis), y = lod_v3_cross(axis, x), axes[3];
	double m[6] = { 0 }, values[3];
	for (uint32_t i = 0; i < in->count; i++)
		for (int k = 0; k < 3; k++) {
			struct lod_v3 d = lod_v3_sub(in->faces[i]->corner[k], at);
			double p = lod_v3_dot(d, x), q = lod_v3_dot(d, y);
			m[0] += p * p;
			m[1] += q * q;
			m[3] += p * q;
		}
	billboard_jacobi(m, axes, values);
	struct lod_v3 u = lod_v3_add(lod_v3_scale(x, axes[0].x), lod_v3_scale(y, axes[0].y));
	return lod_v3_length(u) > 0.5 ? lod_v3_unit(u) : x;
}

/* Both planes hold the axis through the connector. */
static uint32_t fit_cross(struct billboard_quad *quads, const struct billboard_fit_input *in)
{
	struct lod_v3 axis = billboard_axis(in), u = widest_across(in, in->connector, axis);
	quads[0] = quad_over(in, in->connector, u, axis);
	quads[1] = quad_over(in, in->connector, lod_v3_cross(axis, u), axis);
	return 2;
}

/* ---- Strips ----
 *
 * All edges between sections are parallel, at right angles to the axis, so that the section after an edge may
 * only turn about it. Seen along the edges a strip is a line of pieces in (t, h): along the axis and off
 * it. */

struct strip {
	const struct billboard_fit_input *in;
	struct lod_v3 at, axis, edge, off;   /* off = edge x axis */
	double low_t, high_t, low_w, high_w;
	double bound[BILLBOARD_QUADS + 1];   /* sections' ends in t */
	double height[BILLBOARD_QUADS + 1];  /* of the line there */
	uint32_t count;
};

static void point_of(const struct strip *s, const struct billboard_face *face, int k, double *t, double *h)
{
	struct lod_v3 d = lod_v3_sub(face->corner[k], s->at);
	*t = lod_v3_dot(d, s->axis);
	*h = lod_v3_dot(d, s->off);
}

static void frame_strip(struct strip *s, bool turned)
{
	const struct billboard_fit_input *in = s->in;
	s->at = mean_corner(in);
	s->axis = billboard_axis(in);
	s->edge = widest_across(in, s->at, s->axis);
	if (turned)
		s->edge = lod_v3_cross(s->axis, s->edge);
	s->off = lod_v3_cross(s->edge, s->axis);
	struct billboard_quad whole = quad_over(in, s->at, s->axis, s->edge);
	double t = lod_v3_dot(lod_v3_sub(whole.center, s->at), s->axis),
		w = lod_v3_dot(lod_v3_sub(whole.center, s->at), s->edge);
	s->low_t = t - whole.width;
	s->high_t = t + whole.width;
	s->low_w = w - whole.height;
	s->high_w = w + whole.height;
}

/* Slope of the best line through (t0, h0) for the corners in [from, to]; at the first section, of the best
 * line through their middle, which then says h0. */
static double slope_of(const struct strip *s, double from, double to, double t0, double *h0, bool first)
{
	double n = 0, t, h, sum_t = 0, sum_h = 0, tt = 0, th = 0;
	for (int pass = first ? 0 : 1; pass < 2; pass++) {
		double mid_t = first && n > 0 ? sum_t / n : t0, mid_h = first && n > 0 ? sum_h / n : *h0;
		for (uint32_t i = 0; i < s->in->count; i++)
			for (int k = 0; k < 3; k++) {
				point_of(s, s->in->faces[i], k, &t, &h);
				if (t < from || t > to)
					continue;
				n += pass == 0;
				sum_t += pass == 0 ? t : 0;
				sum_h += pass == 0 ? h : 0;
				tt += pass ? (t - mid_t) * (t - mid_t) : 0;
				th += pass ? (t - mid_t) * (h - mid_h) : 0;
			}
	}
	double slope = tt > 0 ? th / tt : 0, steepest = sqrt(1 - STEEP * STEEP) / STEEP;
	slope = slope > steepest ? steepest : slope < -steepest ? -steepest : slope;
	if (first && n > 0)
		*h0 = sum_h / n + slope * (t0 - sum_t / n);
	return slope;
}

static void fit_sections(struct strip *s)
{
	double h = 0;
	for (uint32_t i = 0; i < s->count; i++) {
		double slope = slope_of(s, s->bound[i], s->bound[i + 1], s->bound[i], &h, i == 0);
		if (i == 0)
			s->height[0] = h;
		h += slope * (s->bound[i + 1] - s->bound[i]);
		s->height[i + 1] = h;
	}
}

/* Root mean square distance in t of section i from its line. */
static double section_error(const struct strip *s, uint32_t i)
{
	double n = 0, sum = 0, t, h, width = s->bound[i + 1] - s->bound[i],
		slope = width > 0 ? (s->height[i + 1] - s->height[i]) / width : 0;
	for (uint32_t f = 0; f < s->in->count; f++)
		for (int k = 0; k < 3; k++) {
			point_of(s, s->in->faces[f], k, &t, &h);
			if (t < s->bound[i] || t > s->bound[i + 1])
				continue;
			h -= s->height[i] + slope * (t - s->bound[i]);
			sum += h * h / (1 + slope * slope);
			n++;
		}
	return n > 0 ? sqrt(sum / n) : 0;
}

static struct strip without_bound(const struct strip *s, uint32_t bound)
{
	struct strip less = *s;
	for (uint32_t i = bound; i < s->count; i++)
		less.bound[i] = s->bound[i + 1];
	less.count--;
	fit_sections(&less);
	return less;
}

static double worst_error(const struct strip *s)
{
	double worst = 0;
	for (uint32_t i = 0; i < s->count; i++)
		worst = fmax(worst, section_error(s, i));
	return worst;
}

/* The two sections whose merging leaves the least error, while that is small or there are too many. */
static void merge_sections(struct strip *s)
{
	while (s->count > 1) {
		struct strip best = { .count = 0 };
		double best_error = INFINITY;
		for (uint32_t b = 1; b < s->count; b++) {
			struct strip less = without_bound(s, b);
			double error = worst_error(&less);
			if (error < best_error) {
				best_error = error;
				best = less;
			}
		}
		if (best_error > s->in->bend && s->count <= s->in->most)
			return;
		*s = best;
	}
}

static struct billboard_quad section_quad(const struct strip *s, uint32_t i)
{
	double t = (s->bound[i] + s->bound[i + 1]) / 2, h = (s->height[i] + s->height[i + 1]) / 2,
		w = (s->low_w + s->high_w) / 2, run = s->bound[i + 1] - s->bound[i],
		rise = s->height[i + 1] - s->height[i];
	struct lod_v3 along = lod_v3_unit(lod_v3_add(lod_v3_scale(s->axis, run > 0 ? run : 1),
		lod_v3_scale(s->off, rise))), at = lod_v3_add(s->at, lod_v3_scale(s->axis, t));
	at = lod_v3_add(at, lod_v3_add(lod_v3_scale(s->off, h), lod_v3_scale(s->edge, w)));
	return (struct billboard_quad){ at, s->edge, along, lod_v3_unit(lod_v3_cross(s->edge, along)),
		fmax((s->high_w - s->low_w) / 2, THIN), fmax(sqrt(run * run + rise * rise) / 2, THIN) };
}

/* `turned`: across the direction in which the corners lie widest. */
static struct strip make_strip(const struct billboard_fit_input *in, bool turned)
{
	struct strip s = { .in = in, .count = in->sections };
	s.count = s.count < 1 ? 1 : s.count > BILLBOARD_QUADS ? BILLBOARD_QUADS : s.count;
	frame_strip(&s, turned);
	for (uint32_t i = 0; i <= s.count; i++)
		s.bound[i] = i == s.count ? s.high_t : s.low_t + (s.high_t - s.low_t) * i / s.count;
	fit_sections(&s);
	return s;
}

/* A leaf that bends by more than its width lies widest in its bend, which sections are to follow. */
static uint32_t fit_strip(struct billboard_quad *quads, const struct billboard_fit_input *in)
{
	struct strip s = make_strip(in, false), turned = make_strip(in, true);
	if (worst_error(&turned) < worst_error(&s))
		s = turned;
	merge_sections(&s);
	for (uint32_t i = 0; i < s.count; i++)
		quads[i] = section_quad(&s, i);
	return s.count;
}

uint32_t billboard_fit(struct billboard_quad *quads, enum lod_billboard_form form,
	const struct billboard_fit_input *input)
{
	return form == LOD_BILLBOARD_CROSS ? fit_cross(quads, input) : form == LOD_BILLBOARD_PLANE
		? fit_plane(quads, input) : fit_strip(quads, input);
}
