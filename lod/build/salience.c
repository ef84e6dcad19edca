#include "lod/build/salience.h"

#include <math.h>

/* Distances of colours in bytes: below NEAR they are shades of one colour, beyond CLEAR they are clearly
 * different (lod/EXPERIMENTS.md, Colours that stand out). */
#define NEAR 50.0
#define CLEAR 100.0

void lod_tone_add(struct lod_tone *tone, const uint8_t rgb[3], double area)
{
	tone->area += area;
	for (int k = 0; k < 3; k++)
		tone->rgb[k] += area * rgb[k];
}

void lod_salience_add(struct lod_salience *plant, const uint8_t rgb[3], double area)
{
	plant->area += area;
	lod_tone_add(&plant->bins[(rgb[0] >> 4) << 8 | (rgb[1] >> 4) << 4 | rgb[2] >> 4], rgb, area);
}

/* Brightness, and red and blue relative to it. */
static void opponents(const struct lod_tone *tone, double out[3])
{
	const double r = tone->rgb[0] / tone->area, g = tone->rgb[1] / tone->area,
		b = tone->rgb[2] / tone->area;
	out[0] = (2 * r + 5 * g + b) / 8;
	out[1] = r - out[0];
	out[2] = b - out[0];
}

static double distinct(const struct lod_tone *a, const struct lod_tone *b)
{
	double x[3], y[3];
	opponents(a, x);
	opponents(b, y);
	double light = (x[0] - y[0]) / 2, red = x[1] - y[1], blue = x[2] - y[2];
	return fmin(1, fmax(0, (sqrt(light * light + red * red + blue * blue) - NEAR) / (CLEAR - NEAR)));
}

double lod_salience_of(const struct lod_salience *plant, const struct lod_tone *group)
{
	double differs = 0;
	if (!(plant->area > 0) || !(group->area > 0))
		return 1;
	for (uint32_t i = 0; i < LOD_SALIENCE_BINS; i++)
		if (plant->bins[i].area > 0)
			differs += plant->bins[i].area * distinct(group, &plant->bins[i]);
	return 1 + (LOD_SALIENCE_MOST - 1) * fmax(0, 2 * differs / plant->area - 1);
}
