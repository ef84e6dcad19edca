/* Outlines of ellipsoids against rays that meet them or do not, one by one. */
#include <math.h>

#include "lod/seen/outline.h"
#include "tests/support/unit_test.h"

#define CASES 1000
#define RAYS 200
#define GRID 200                 /* rows and columns of counted pixels */
#define EDGE 1e-3                /* of the outline's radius: nearer to its edge a ray may be either */

static uint64_t state;

static double uniform(double low, double high)
{
	state = state * 6364136223846793005u + 1442695040888963407u;
	return low + (high - low) * (double)(state >> 11) * 0x1p-53;
}

struct drawn { struct lod_eye eye; struct lod_outline outline; double from_eye[3], size[3], ratio; };

/* Positions up to 1e9 m, half axes up to 1e6 : 1, anywhere around the eye. */
static void draw(struct drawn *d)
{
	double place = pow(10, uniform(-3, 9)), size = place * pow(10, uniform(-4, 0.5)), spread = uniform(0, 1),
		to[3];
	d->ratio = pow(10, spread < 0.5 ? uniform(-1, 1) : uniform(-6, 6));
	for (int k = 0; k < 3; k++)
		to[k] = uniform(-1, 1);
	lod_eye_make(&d->eye, &(struct eco_view){ .target = { to[0], to[1], to[2] }, .up = { 0.1, 0.2, 1 },
		.fov_y_deg = 60, .width = 400, .height = 300 });
	for (int k = 0; k < 3; k++)
		d->from_eye[k] = place * uniform(-1, 1);
	d->size[0] = d->size[1] = size * fmin(1, d->ratio);
	d->size[2] = size / fmax(1, d->ratio);
	lod_outline_make(&d->outline, &d->eye, d->from_eye, d->size[0], d->size[2]);
}

/* The squared distance of the ray from the ellipsoid's middle, as a ball of radius 1; 0 where the eye is in
 * it, INFINITY where it lies behind. */
static double apart(const struct drawn *d, double x, double y)
{
	long double m[3], v[3], vv = 0, mm = 0, mv = 0, n = 0;
	for (int k = 0; k < 3; k++) {
		m[k] = (long double)d->from_eye[k] / d->size[k];
		v[k] = ((long double)d->eye.forward[k] + x * (long double)d->eye.right[k]
			+ y * (long double)d->eye.up[k]) / d->size[k];
		vv += v[k] * v[k];
		mm += m[k] * m[k];
		mv += m[k] * v[k];
	}
	for (int k = 0; k < 3; k++) {
		long double c = m[k] * v[(k + 1) % 3] - m[(k + 1) % 3] * v[k];
		n += c * c;
	}
	return mm <= 1 ? 0 : mv <= 0 ? INFINITY : (double)(n / vv);
}

/* In the ellipse's own coordinates, so that a needle's rays are as telling as a ball's. */
static void check_ellipse(const struct drawn *d)
{
	const struct lod_outline *o = &d->outline;
	for (int i = 0; i < RAYS; i++) {
		double u = uniform(-1.3, 1.3), v = uniform(-1.3, 1.3), r = sqrt(u * u + v * v), y = o->y + v * o->high,
			x = o->x + o->lean * v * o->high + u * o->half, low, high;
		bool meets = apart(d, x, y) <= 1, row = lod_outline_row(o, &d->eye, y, &low, &high);
		if (fabs(r - 1) > EDGE && meets != (r < 1))
			fail_msg("ratio %g: a ray at %g of the radius %s", d->ratio, r, meets ? "meets" : "passes");
		if (fabs(r - 1) > EDGE)
			assert_int_equal(row && fabs(u * o->half) <= 0.5 * (high - low) * (1 + 1e-9), r < 1);
	}
}

/* Length of a ray in the ellipsoid, in front of the eye. */
static double way(const struct drawn *d, double x, double y)
{
	long double vv = 0, mm = -1, mv = 0;
	for (int k = 0; k < 3; k++) {
		long double m = (long double)d->from_eye[k] / d->size[k], v = ((long double)d->eye.forward[k]
			+ x * (long double)d->eye.right[k] + y * (long double)d->eye.up[k]) / d->size[k];
		vv += v * v;
		mm += m * m;
		mv += m * v;
	}
	long double rest = mv * mv - vv * mm, root = rest > 0 ? sqrtl(rest) : 0, to = (mv + root) / vv,
		from = (mv - root) / vv;
	return (double)((to > 0 ? to : 0) - (from > 0 ? from : 0)) * sqrt(1 + x * x + y * y);
}

static void check_around(const struct drawn *d)
{
	for (int i = 0; i < RAYS; i++) {
		double x = uniform(-2, 2), y = uniform(-2, 2), low, high, r = sqrt(apart(d, x, y));
		bool row = lod_outline_row(&d->outline, &d->eye, y, &low, &high) && x >= low && x <= high;
		if (fabs(r - 1) > EDGE && row != (r < 1))
			fail_msg("ratio %g, around: a ray at %g of the radius: row says %d", d->ratio, r, row);
		double length = way(d, x, y);
		if (fabs(r - 1) > EDGE)
			assert_float_equal(lod_outline_way(&d->outline, &d->eye, x, y), length, 1e-5 * length);
	}
}

UNIT_TEST(a_row_holds_the_rays_that_meet)
{
	uint32_t kinds[4] = { 0 };
	state = 1;
	for (int i = 0; i < 10 * CASES; i++) {
		struct drawn d;
		draw(&d);
		const struct lod_outline *o = &d.outline;
		bool behind = !o->around && !(o->high > 0);
		kinds[behind ? 0 : !o->around ? 1 : o->inside ? 2 : 3]++;
		assert_true(!behind || lod_dot(d.eye.forward, d.from_eye) < 0);
		if (o->around)
			check_around(&d);
		else if (!behind)
			check_ellipse(&d);
	}
	for (int k = 0; k < 4; k++)
		assert_true(kinds[k] > CASES / 10);
}

/* Pixels of the box around the ellipse. */
UNIT_TEST(an_area_is_that_of_counted_pixels)
{
	state = 2;
	for (int i = 0; i < CASES;) {
		struct drawn d;
		uint32_t count = 0;
		draw(&d);
		const struct lod_outline *o = &d.outline;
		double box = 4 * o->wide * o->high, area = lod_outline_area(o);
		if (o->around || !(area > 0.05 * box))   /* too thin to count */
			continue;
		for (int k = 0; k < GRID * GRID; k++)
			count += apart(&d, o->x + o->wide * (2 * (k % GRID + 0.5) / GRID - 1),
				o->y + o->high * (2 * (k / GRID + 0.5) / GRID - 1)) <= 1;
		if (fabs((double)count / (GRID * GRID) - area / box) > 0.004)
			fail_msg("ratio %g: %g counted, %g of the box", d.ratio, (double)count / (GRID * GRID), area / box);
		i++;
	}
}

/* From afar past the eye and away behind it, and along a tangent: a row changes little by little, as far as
 * the picture reaches, but where the eye leaves the ellipsoid. */
UNIT_TEST(an_outline_passes_the_eye_little_by_little)
{
	static const double aside[] = { 0, 1, 1.999, 2, 2.001, 3 };
	struct lod_eye eye;
	lod_eye_make(&eye, &(struct eco_view){ .target = { 0, 1, 0 }, .up = { 0, 0, 1 }, .fov_y_deg = 60, .width = 400,
		.height = 300 });
	for (size_t i = 0; i < sizeof aside / sizeof *aside; i++) {
		double before = 0;
		bool inside = false;
		for (int step = 0; step <= 20000; step++) {
			struct lod_outline o;
			double low, high, length = 0;
			lod_outline_make(&o, &eye, (const double[]){ aside[i], 10 - 1e-3 * step, 0.3 }, 2, 5);
			if (lod_outline_row(&o, &eye, 0.1, &low, &high))
				length = fmax(0, fmin(1, high) - fmax(-1, low));
			if (step && fabs(length - before) > 0.1 && o.inside == inside)
				fail_msg("%g aside, step %d: %g after %g", aside[i], step, length, before);
			before = length;
			inside = o.inside;
		}
		assert_true(before <= 0);
	}
}
