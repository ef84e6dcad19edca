/* view_light.glsl as C, for view_light.c and its test. */
#pragma once

#include "client-min/draw/view_light.h"
#include "ecofiles/format/ground_tile.h"
#include "lod/plant_light.h"

typedef struct { double x, y; } ground_place;    /* on the ground, from its origin */
typedef struct footprint footprint;
#define footprint(...) ((struct footprint){ __VA_ARGS__ })

static inline float noise_at(ground_place at, int which, int finer);

#define WATER
#include "lod/glsl.h"
#include "client-min/draw/view_light.glsl"
#include "lod/glsl_end.h"
#undef WATER

static inline float noise_at(ground_place at, int which, int finer)
{
	double p[2];
	view_light_octave(which, (const double[2]){ at.x, at.y }, p);
	p[0] *= finer;
	p[1] *= finer;
	if (!(fabs(p[0]) < 1e15 && fabs(p[1]) < 1e15))
		return 0.5f;
	int64_t i = (int64_t)p[0], j = (int64_t)p[1];
	i -= p[0] < (double)i;
	j -= p[1] < (double)j;
	return noise_in((uint32_t)i, (uint32_t)j, (float)(p[0] - (double)i), (float)(p[1] - (double)j));
}
