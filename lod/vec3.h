/* Vectors of three floats, by the names that GLSL has for them, or gets before texts such as
 * plant_light.glsl: what these are written in, where C includes them. */
#pragma once

#include <math.h>

typedef struct vec { float x, y, z; } vec3;
#define vec3(...) ((struct vec){ __VA_ARGS__ })

static inline vec3 add(vec3 a, vec3 b) { return vec3(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline vec3 scale(vec3 a, float t) { return vec3(a.x * t, a.y * t, a.z * t); }
static inline vec3 times(vec3 a, vec3 b) { return vec3(a.x * b.x, a.y * b.y, a.z * b.z); }
static inline float dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline vec3 cross(vec3 a, vec3 b)
{
	return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline float length(vec3 a) { return sqrtf(dot(a, a)); }
static inline vec3 unit(vec3 a) { return scale(a, 1 / fmaxf(length(a), 1e-20f)); }
