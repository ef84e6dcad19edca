/* view_light.glsl as C, for view_light.c and its test. */
#ifndef VIEW_LIGHT_INLINE_H
#define VIEW_LIGHT_INLINE_H

#include <stdbool.h>

#include "client-min/draw/view_light.h"
#include "client-min/draw/view_vec.h"
#include "client-min/draw/view_glsl.h"

typedef struct { double x, y; } ground_place;    /* on the ground, from its origin */
typedef struct sunlight sunlight;
typedef struct sunny sunny;
typedef struct crown crown;
typedef struct plant plant;
typedef struct face face;
typedef struct footprint footprint;
#define sunny(...) ((struct sunny){ __VA_ARGS__ })
#define crown(...) ((struct crown){ __VA_ARGS__ })
#define face(...) ((struct face){ __VA_ARGS__ })
#define footprint(...) ((struct footprint){ __VA_ARGS__ })

static inline float mix(float a, float b, float t) { return a + (b - a) * t; }
static inline vec3 blend(vec3 a, vec3 b, float t)
{
	return vec3(mix(a.x, b.x, t), mix(a.y, b.y, t), mix(a.z, b.z, t));
}
static inline float smoothstep(float low, float high, float v)
{
	float t = (v - low) / (high - low);
	t = t > 0 ? t < 1 ? t : 1 : 0;
	return t * t * (3 - 2 * t);
}

static inline float noise_at(ground_place at, int which, int finer);

#include "client-min/draw/view_light.glsl"
#include "client-min/draw/view_glsl_end.h"

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

#endif
