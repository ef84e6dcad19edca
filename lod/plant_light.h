/* lod/plant_light.glsl as C: how light falls on plants and what they show of it. Clients light pictures by it
 * (client-min/draw/view_light.h), and curves measure what is seen in it (lod/build/measure/seen.h). */
#pragma once

#include <stdbool.h>

#include "lod/vec3.h"
#include "lod/glsl.h"

typedef struct sunlight sunlight;
typedef struct sunny sunny;
typedef struct crown crown;
typedef struct plant plant;
typedef struct face face;
#define sunny(...) ((struct sunny){ __VA_ARGS__ })
#define crown(...) ((struct crown){ __VA_ARGS__ })
#define face(...) ((struct face){ __VA_ARGS__ })

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

#include "lod/plant_light.glsl"
#include "lod/glsl_end.h"

/* At ten in the morning of midsummer at a latitude of 50 degrees. */
static const struct sunlight lod_usual_light = { { 0.459f, -0.353f, 0.816f }, { 1.70f, 1.57f, 1.34f },
	{ 0.36f, 0.42f, 0.52f }, { 0.20f, 0.19f, 0.11f }, 1, 0 };

/* A plant of which the sphere around it and the height are known, in its own space: an ellipsoid that stands
 * on the ground. */
static inline struct plant lod_plant_shape(double radius, double height_m)
{
	double half = 0.5 * height_m, square = radius * radius - half * half, least = 0.12 * radius;
	half = half > 0 ? half : radius;
	return (struct plant){ 0, 1, (float)half, (float)(square > least * least ? sqrt(square) : least), (float)half, 0 };
}
