/* Vectors of three doubles, and the arc cosine, which libm must not decide. */
#pragma once

#include <math.h>

#define LOD_PI 3.14159265358979323846

struct lod_v3 { double x, y, z; };

static inline struct lod_v3 lod_v3_of(const float *p) { return (struct lod_v3){ p[0], p[1], p[2] }; }
static inline struct lod_v3 lod_v3_add(struct lod_v3 a, struct lod_v3 b)
{
	return (struct lod_v3){ a.x + b.x, a.y + b.y, a.z + b.z };
}
static inline struct lod_v3 lod_v3_sub(struct lod_v3 a, struct lod_v3 b)
{
	return (struct lod_v3){ a.x - b.x, a.y - b.y, a.z - b.z };
}
static inline struct lod_v3 lod_v3_scale(struct lod_v3 a, double s)
{
	return (struct lod_v3){ a.x * s, a.y * s, a.z * s };
}
static inline struct lod_v3 lod_v3_mix(struct lod_v3 a, struct lod_v3 b, double t) {
	return lod_v3_add(a, lod_v3_scale(lod_v3_sub(b, a), t));
}
static inline double lod_v3_dot(struct lod_v3 a, struct lod_v3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline struct lod_v3 lod_v3_cross(struct lod_v3 a, struct lod_v3 b) {
	return (struct lod_v3){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}
static inline double lod_v3_length(struct lod_v3 a) { return sqrt(lod_v3_dot(a, a)); }
static inline double lod_v3_distance(struct lod_v3 a, struct lod_v3 b)
{
	return lod_v3_length(lod_v3_sub(a, b));
}
static inline double lod_v3_axis(struct lod_v3 a, int axis)
{
	return axis == 0 ? a.x : axis == 1 ? a.y : a.z;
}
static inline struct lod_v3 lod_v3_unit(struct lod_v3 a) {
	double length = lod_v3_length(a);
	return length > 0 ? lod_v3_scale(a, 1 / length) : (struct lod_v3){ 0, 0, 0 };
}

/* Turns a unit vector of the plane by a golden angle, to the next direction of a Fibonacci spiral. */
static inline void lod_turn_golden(double *x, double *y)
{
	const double turn_x = -0.7373688780783197, turn_y = 0.6754902942615238;
	double next = *x * turn_x - *y * turn_y;
	*y = *x * turn_y + *y * turn_x;
	*x = next;
}

/* Arc cosine within 1e-4 (Abramowitz and Stegun 4.4.45): the last bit of libm's may differ from machine to
 * machine. */
static inline double lod_arc_cosine(double c)
{
	double x = c < 0 ? -c : c;
	x = x > 1 ? 1 : x;
	double angle = sqrt(1 - x) * (1.5707288 + x * (-0.2121144 + x * (0.0742610 - x * 0.0187293)));
	return c < 0 ? LOD_PI - angle : angle;
}
