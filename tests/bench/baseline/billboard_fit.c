/* The generators (Kratt 2014, 3.3): two crossed planes, a fitted plane, a strip of fitted planes; and how
 * well billboards stand for faces (3.4). */
#include <math.h>

#include "lod/build/splat/splat_state.h"
#include "tests/bench/baseline/billboard_cloud.h"

#define THIN 1e-6                    /* half edges are at least this */
#define STEEP 0.2                    /* a section rises along the axis at least so fast */
/* sections merge while the distance from their plane, root mean square, is at most this share of epsilon */
#define BEND 0.5

/* Corner i of the part. */
static struct lod_v3 corner_of(const struct billboard_fit_input *in, uint32_t i)
{
	return in->faces[i / 3]->corner[i % 3];
}

/* ---- Axes and quads ---- */

/* Any unit vector at right angles to a. */
static struct lod_v3 across(struct lod_v3 a)
{
	struct lod_v3 other = fabs(a.z) < 0.7 ? (struct lod_v3){ 0, 0, 1 } : (struct lod_v3){ 1, 0, 0 };
	return lod_v3_unit(lod_v3_cross(other, a));
}

static struct lod_v3 mean_corner(const struct billboard_fit_input *in)
{
	struct lod_v3 sum = { 0, 0, 0 };
	for (uint32_t i = 0; i < 3 * in->count; i++)
		sum = lod_v3_add(sum, corner_of(in, i));
	return lod_v3_scale(sum, 1.0 / (3.0 * in->count));
}

/* Principal axes of all corners around a point, in the coordinates of three unit vectors. */
static void widest(const struct billboard_fit_input *in, struct lod_v3 around, const struct lod_v3 *frame,
	struct lod_v3 axes[3])
{
	double m[3][3] = { { 0 } }, value[3], vector[3][3];
	for (uint32_t i = 0; i < 3 * in->count; i++) {
		struct lod_v3 d = lod_v3_sub(corner_of(in, i), around);
		const double at[3] = { lod_v3_dot(d, frame[0]), lod_v3_dot(d, frame[1]), lod_v3_dot(d,
			frame[2]) };
		for (int k = 0; k < 9; k++)
			m[k / 3][k % 3] += at[k / 3] * at[k % 3];
	}
	splat_eigen((const double (*)[3])m, value, vector);
	for (int i = 0; i < 3; i++)
		axes[i] = lod_v3_add(lod_v3_scale(frame[0], vector[i][0]), lod_v3_add(lod_v3_scale(frame[1],
			vector[i][1]), lod_v3_scale(frame[2], vector[i][2])));
}

static const struct lod_v3 world[3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };

/* The mean of the vectors from the connector to all corners, of length 1; the widest axis where it is 0. */
static struct lod_v3 main_axis(const struct billboard_fit_input *in)
{
	struct lod_v3 axes[3], mean = mean_corner(in), axis = lod_v3_sub(mean, in->connector);
	double reach = 0;
	widest(in, mean, world, axes);
	for (uint32_t i = 0; i < in->count; i++)
		reach = fmax(reach, lod_v3_distance(in->faces[i]->corner[0], in->connector));
	return lod_v3_length(axis) > 1e-3 * reach ? lod_v3_unit(axis) : axes[0];
}

/* The direction at right angles to the axis in which the corners lie widest. */
static struct lod_v3 widest_across(const struct billboard_fit_input *in, struct lod_v3 at, struct lod_v3 axis)
{
	const struct lod_v3 x = across(axis), frame[3] = { x, lod_v3_cross(axis, x), { 0, 0, 0 } };
	struct lod_v3 axes[3];
	widest(in, at, frame, axes);
	return lod_v3_length(axes[0]) > 0.5 ? lod_v3_unit(axes[0]) : x;
}

/* Spanned by unit u and v through `at`, over all corners. */
static struct billboard_quad quad_over(const struct billboard_fit_input *in, struct lod_v3 at,
	struct lod_v3 u, struct lod_v3 v)
{
	double low[2] = { INFINITY, INFINITY }, high[2] = { -INFINITY, -INFINITY };
	for (uint32_t i = 0; i < 3 * in->count; i++)
		for (int k = 0; k < 2; k++) {
			double x = lod_v3_dot(lod_v3_sub(corner_of(in, i), at), k ? v : u);
			low[k] = fmin(low[k], x);
			high[k] = fmax(high[k], x);
		}
	at = lod_v3_add(at, lod_v3_scale(u, (low[0] + high[0]) / 2));
	at = lod_v3_add(at, lod_v3_scale(v, (low[1] + high[1]) / 2));
	return (struct billboard_quad){ at, u, v, lod_v3_unit(lod_v3_cross(u, v)),
		fmax((high[0] - low[0]) / 2, THIN), fmax((high[1] - low[1]) / 2, THIN) };
}

static uint32_t fit_plane(struct billboard_quad *quads, const struct billboard_fit_input *in)
{
	struct lod_v3 axes[3], mean = mean_corner(in);
	widest(in, mean, world, axes);
	quads[0] = quad_over(in, mean, axes[0], axes[1]);
	return 1;
}

/* Both planes hold the axis through the connector. */
static uint32_t fit_cross(struct billboard_quad *quads, const struct billboard_fit_input *in)
{
	struct lod_v3 axis = main_axis(in), u = widest_across(in, in->connector, axis);
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

static double t_of(const struct strip *s, uint32_t i)
{
	return lod_v3_dot(lod_v3_sub(corner_of(s->in, i), s->at), s->axis);
}

static double h_of(const struct strip *s, uint32_t i)
{
	return lod_v3_dot(lod_v3_sub(corner_of(s->in, i), s->at), s->off);
}

/* Slope of the best line through (t0, h0) for the corners in [from, to]; at the first section, of the best
 * line through their middle, which then says h0. */
static double slope_of(const struct strip *s, double from, double to, double *h0, bool first)
{
	double n = 0, sum_t = 0, sum_h = 0, tt = 0, th = 0, t0 = from;
	for (uint32_t i = 0; i < 3 * s->in->count && first; i++) {
		double t = t_of(s, i);
		if (t < from || t > to)
			continue;
		n++;
		sum_t += t;
		sum_h += h_of(s, i);
	}
	double mid_t = n > 0 ? sum_t / n : t0, mid_h = n > 0 ? sum_h / n : *h0;
	for (uint32_t i = 0; i < 3 * s->in->count; i++) {
		double t = t_of(s, i);
		if (t < from || t > to)
			continue;
		tt += (t - mid_t) * (t - mid_t);
		th += (t - mid_t) * (h_of(s, i) - mid_h);
	}
	double slope = tt > 0 ? th / tt : 0, steepest = sqrt(1 - STEEP * STEEP) / STEEP;
	slope = slope > steepest ? steepest : slope < -steepest ? -steepest : slope;
	if (n > 0)
		*h0 = mid_h + slope * (t0 - mid_t);
	return slope;
}

static void fit_sections(struct strip *s)
{
	double h = 0;
	for (uint32_t i = 0; i < s->count; i++) {
		double slope = slope_of(s, s->bound[i], s->bound[i + 1], &h, i == 0);
		s->height[i] = h;
		h += slope * (s->bound[i + 1] - s->bound[i]);
	}
	s->height[s->count] = h;
}

/* The worst root mean square distance of a section from its line. */
static double worst_error(const struct strip *s)
{
	double worst = 0;
	for (uint32_t k = 0; k < s->count; k++) {
		double n = 0, sum = 0, width = s->bound[k + 1] - s->bound[k],
			slope = width > 0 ? (s->height[k + 1] - s->height[k]) / width : 0;
		for (uint32_t i = 0; i < 3 * s->in->count; i++) {
			double t = t_of(s, i);
			if (t < s->bound[k] || t > s->bound[k + 1])
				continue;
			double h = h_of(s, i) - (s->height[k] + slope * (t - s->bound[k]));
			sum += h * h / (1 + slope * slope);
			n++;
		}
		worst = fmax(worst, n > 0 ? sqrt(sum / n) : 0);
	}
	return worst;
}

/* The two sections whose merging leaves the least error, while that is small or there are too many. */
static void merge_sections(struct strip *s)
{
	while (s->count > 1) {
		struct strip best = { .count = 0 };
		double best_error = INFINITY;
		for (uint32_t b = 1; b < s->count; b++) {
			struct strip less = *s;
			less.count--;
			for (uint32_t i = b; i < s->count; i++)
				less.bound[i] = s->bound[i + 1];
			fit_sections(&less);
			double error = worst_error(&less);
			if (error < best_error) {
				best_error = error;
				best = less;
			}
		}
		if (best_error > BEND * s->in->epsilon && s->count <= s->in->most)
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
	struct strip s = { .in = in, .count = BILLBOARD_QUADS, .at = mean_corner(in), .axis = main_axis(in) };
	s.edge = widest_across(in, s.at, s.axis);
	if (turned)
		s.edge = lod_v3_cross(s.axis, s.edge);
	s.off = lod_v3_cross(s.edge, s.axis);
	struct billboard_quad whole = quad_over(in, s.at, s.axis, s.edge);
	double t = lod_v3_dot(lod_v3_sub(whole.center, s.at), s.axis),
		w = lod_v3_dot(lod_v3_sub(whole.center, s.at), s.edge);
	s.low_t = t - whole.width;
	s.high_t = t + whole.width;
	s.low_w = w - whole.height;
	s.high_w = w + whole.height;
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

/* ---- Validity and coverage (3.4) ---- */

/* From a point to the nearest rectangle. */
static double distance_to(const struct billboard_quad *quads, uint32_t count, struct lod_v3 point,
	uint32_t *nearest)
{
	double best = INFINITY;
	for (uint32_t i = 0; i < count; i++) {
		const struct billboard_quad *quad = &quads[i];
		struct lod_v3 d = lod_v3_sub(point, quad->center);
		double x = fmax(0, fabs(lod_v3_dot(d, quad->u)) - quad->width),
			y = fmax(0, fabs(lod_v3_dot(d, quad->v)) - quad->height), z = lod_v3_dot(d,
				quad->normal),
			away = sqrt(x * x + y * y + z * z);
		if (away < best) {
			best = away;
			*nearest = i;
		}
	}
	return best;
}

bool billboard_face_judge(const struct billboard_face *face, const struct billboard_quad *quads,
	uint32_t count, double epsilon, uint32_t *nearest, double *projected)
{
	struct lod_v3 middle = lod_v3_scale(lod_v3_add(face->corner[0],
		lod_v3_add(face->corner[1], face->corner[2])), 1.0 / 3);
	bool valid = true;
	*nearest = 0;
	for (int k = 0; k < 3; k++)
		valid = distance_to(quads, count, face->corner[k], nearest) <= epsilon && valid;
	*nearest = 0;
	distance_to(quads, count, middle, nearest);
	*projected = count ? face->area * fabs(lod_v3_dot(face->normal, quads[*nearest].normal)) : 0;
	return valid;
}

double billboard_uncovered(const struct billboard_fit_input *in, const struct billboard_quad *quads,
	uint32_t count)
{
	double valid = 0, invalid = 0, area = 0;
	for (uint32_t i = 0; i < in->count; i++) {
		uint32_t nearest;
		double projected;
		bool is_valid = billboard_face_judge(in->faces[i], quads, count, in->epsilon, &nearest,
			&projected);
		*(is_valid ? &valid : &invalid) += projected;
		area += in->faces[i]->area;
	}
	/* sums may pass the area by their last digit */
	return area > 0 ? fmax(0, 1 - fmax(0, valid - invalid) / area) : 0;
}
