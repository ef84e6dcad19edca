#include "tests/bench/baseline/cook.h"

#include <math.h>

#define HALVINGS 60

static double power(double base, uint32_t exponent)
{
	double result = 1;
	for (; exponent; exponent >>= 1, base *= base)
		if (exponent & 1)
			result *= base;
	return result;
}

double lod_cook_scale(uint32_t kept, uint32_t count)
{
	return kept ? (double)count / kept : 0;
}

double lod_cook_scale_depth(uint32_t kept, uint32_t count, double share)
{
	if (kept == 0 || kept >= count || !(share > 0) || share > 1)
		return lod_cook_scale(kept < count ? kept : count, count);
	/* The uncovered share, and not the covered one: in dense crowns the two sides differ in it. */
	double left = power(1 - share, count), low = 1, high = fmin((double)count / kept, 1 / share);
	for (int i = 0; i < HALVINGS; i++) {
		double s = (low + high) / 2;
		if (power(1 - s * share, kept) > left)
			low = s;
		else
			high = s;
	}
	return (low + high) / 2;
}

double lod_cook_share(uint32_t count, double projected, double covered)
{
	if (count == 0 || !(covered > 0) || !(projected > covered))
		return 0;
	/* in units of which `covered` is at least one element */
	double one = projected / count;
	double elements = fmax(1, covered / one), low = 0, high = 1;
	for (int i = 0; i < HALVINGS; i++) {
		double a = (low + high) / 2;
		if ((1 - power(1 - a, count)) / a > elements)
			low = a;
		else
			high = a;
	}
	return (low + high) / 2;
}

double lod_cook_contrast(uint32_t kept, uint32_t count, double per_pixel)
{
	if (kept == 0 || kept >= count)
		return 1;
	double before = fmax(1, per_pixel), after = fmax(1, per_pixel * kept / count);
	return sqrt(after / before);
}
