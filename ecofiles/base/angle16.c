/* Sine and cosine by octants: the angle is brought to [0, 1/8 turn] as an integer, so that symmetric
 * angles give values symmetric to the last bit and quarter turns are exact. Taylor's series to x^17 is
 * within half a unit in the last place there. libm is not used: its results differ between machines, and a
 * plan must not. */
#include "ecofiles/base/angle16.h"

#include <assert.h>
#include <math.h>

#define QUARTER 16384u

static double sine_series(double x)
{
	double y = x * x;
	return x
		* (1.0 + y
		* (-1.0 / 6
		+ y * (1.0 / 120
		+ y * (-1.0 / 5040
		+ y * (1.0 / 362880
		+ y * (-1.0 / 39916800 + y * (1.0 / 6227020800.0 + y * (-1.0 / 1307674368000.0))))))));
}

static double cosine_series(double x)
{
	double y = x * x;
	return 1.0 + y * (-1.0 / 2 + y * (1.0 / 24 + y * (-1.0 / 720 + y * (1.0 / 40320 + y * (-1.0 / 3628800
		+ y * (1.0 / 479001600.0 + y * (-1.0 / 87178291200.0 + y * (1.0 / 20922789888000.0))))))));
}

/* Sine and cosine of `step` / 65536 turns in the first quarter. */
static void quarter_sincos(uint32_t step, double *sine, double *cosine)
{
	const double radians = 1.57079632679489661923 / QUARTER;
	if (step == QUARTER / 2) {
		*sine = *cosine = 0.70710678118654752440;
	} else if (step < QUARTER / 2) {
		*sine = sine_series(step * radians);
		*cosine = cosine_series(step * radians);
	} else {
		*sine = cosine_series((QUARTER - step) * radians);
		*cosine = sine_series((QUARTER - step) * radians);
	}
}

void eco_angle16_sincos(uint16_t turn, double *sine, double *cosine)
{
	double s, c;
	quarter_sincos(turn % QUARTER, &s, &c);
	switch (turn / QUARTER) {
	case 0: *sine = s; *cosine = c; break;
	case 1: *sine = c; *cosine = -s; break;
	case 2: *sine = -s; *cosine = -c; break;
	default: *sine = -c; *cosine = s; break;
	}
}

uint16_t eco_angle16_from_deg(double degrees)
{
	assert(isfinite(degrees));
	/* fmod is exact in IEEE arithmetic, unlike the rest of libm. */
	double steps = floor(fmod(degrees, 360.0) / 360.0 * 65536.0 + 0.5);
	return (uint16_t)(int32_t)steps;
}
