/* Outlines of ellipsoids: see lod/seen/outline.h. */
#include "lod/seen/outline.h"

#include <math.h>

#define PI 3.14159265358979323846
#define FLATTEST 1e-9            /* of the largest half axis: a flat or thin ellipsoid has some extent for a ray */

/* From half axes in the picture, linearly at the centre: `a` to the right, `b` up, `f` farther away, over the
 * distance. */
static void set_ellipse(struct lod_outline *o, const double a[3], const double b[3], const double f[3])
{
	double c[3], s[3];           /* s: cross products of (x, y) with each half axis */
	lod_cross(a, b, c);
	lod_cross(c, f, s);
	const double part = 1 / (1 - lod_dot(f, f)), x = lod_dot(a, f), y = lod_dot(b, f);
	double xy = (lod_dot(a, b) + x * y * part) * part, yy = (lod_dot(b, b) + y * y * part) * part,
		area = sqrt(lod_dot(c, c) + part * lod_dot(s, s)) * part;
	o->x -= x * part;
	o->y -= y * part;
	o->wide = sqrt((lod_dot(a, a) + x * x * part) * part);
	o->high = sqrt(yy);
	o->lean = yy > 0 ? xy / yy : 0;
	o->half = yy > 0 ? area / o->high : 0;
}

void lod_outline_make(struct lod_outline *o, const struct lod_eye *eye, const double from_eye[3], double across,
	double up)
{
	const double least = FLATTEST * fmax(across, up), w = lod_dot(eye->forward, from_eye);
	double a[3], b[3], f[3], ahead = 0, apart = 0;
	*o = (struct lod_outline){ .size = { fmax(across, least), fmax(across, least), fmax(up, least) } };
	for (int k = 0; k < 3; k++) {
		o->middle[k] = from_eye[k];
		ahead += o->size[k] * o->size[k] * eye->forward[k] * eye->forward[k];
		apart += from_eye[k] / o->size[k] * (from_eye[k] / o->size[k]);
	}
	o->around = !(ahead < w * w * (1 - 1e-9));
	o->inside = apart <= 1;
	if (o->around || w <= 0)
		return;
	o->x = lod_dot(eye->right, from_eye) / w;
	o->y = lod_dot(eye->up, from_eye) / w;
	for (int k = 0; k < 3; k++) {
		f[k] = o->size[k] * eye->forward[k] / w;
		a[k] = o->size[k] * eye->right[k] / w - o->x * f[k];
		b[k] = o->size[k] * eye->up[k] / w - o->y * f[k];
	}
	set_ellipse(o, a, b, f);
}

double lod_outline_area(const struct lod_outline *o) { return PI * o->half * o->high; }

/* With the ellipsoid as a unit ball around m, the ray v = p + x q meets it where |v|^2 >= |m x v|^2 and m v > 0:
 * a quadratic in x. */
static bool ray_row(const struct lod_outline *o, const struct lod_eye *eye, double y, double *low, double *high)
{
	double m[3], p[3], q[3], mp[3], mq[3];
	for (int k = 0; k < 3; k++) {
		m[k] = o->middle[k] / o->size[k];
		p[k] = (eye->forward[k] + y * eye->up[k]) / o->size[k];
		q[k] = eye->right[k] / o->size[k];
	}
	lod_cross(m, p, mp);
	lod_cross(m, q, mq);
	const double a = lod_dot(q, q) - lod_dot(mq, mq), b = lod_dot(p, q) - lod_dot(mp, mq),
		c = lod_dot(p, p) - lod_dot(mp, mp), rest = b * b - a * c;
	if (!(rest > 0))
		return false;
	const double root = -b - (b > 0 ? sqrt(rest) : -sqrt(rest)), first = root / a, second = c / root;
	*low = first < second ? first : second;
	*high = first < second ? second : first;
	if (!(a < 0) && lod_dot(m, q) > 0) {
		*low = *high;
		*high = INFINITY;
	} else if (!(a < 0)) {
		*high = *low;
		*low = -INFINITY;
	} else if (!(lod_dot(m, p) + 0.5 * (*low + *high) * lod_dot(m, q) > 0)) {
		return false;
	}
	return *low <= *high;
}

bool lod_outline_row(const struct lod_outline *o, const struct lod_eye *eye, double y, double *low, double *high)
{
	*low = -INFINITY;
	*high = INFINITY;
	if (o->inside)
		return true;
	if (o->around)
		return ray_row(o, eye, y, low, high);
	double v = o->high > 0 ? (y - o->y) / o->high : 2, rest = 1 - v * v,
		middle = o->x + o->lean * (y - o->y), reach = rest > 0 ? o->half * sqrt(rest) : 0;
	*low = middle - reach;
	*high = middle + reach;
	return rest >= 0;
}

double lod_outline_way(const struct lod_outline *o, const struct lod_eye *eye, double x, double y)
{
	double m[3], v[3], mv[3];
	for (int k = 0; k < 3; k++) {
		m[k] = o->middle[k] / o->size[k];
		v[k] = (eye->forward[k] + x * eye->right[k] + y * eye->up[k]) / o->size[k];
	}
	lod_cross(m, v, mv);
	const double along = lod_dot(m, v), vv = lod_dot(v, v), rest = vv - lod_dot(mv, mv),
		root = rest > 0 ? sqrt(rest) : 0;
	return (fmax(0, along + root) - fmax(0, along - root)) / vv * sqrt(1 + x * x + y * y);
}
