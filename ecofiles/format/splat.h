/* A splat: a point that is drawn as an ellipsoid. In a list of points with ECO_ATTR_SPLAT each point is its
 * centre and has ECO_SPLAT_CODES further values:
 *
 *   0..2  half axes: unit * 2^((code - 64) / 8), code in [0, 128); unit = sqrt(list.unit_area), metres
 *   3..5  turn: the vector part of a unit quaternion with a positive scalar part, times ECO_SPLAT_TURN, and
 *         16 more, in [0, 32). It turns the axes x, y, z to those of the ellipsoid
 *   6     opacity: (code % 16 + 1) / 16, code in [0, 32); 15 is opaque. From 16 on it is wood: no leaf is drawn on it
 *
 * Axes may be swapped and reversed without changing an ellipsoid, so the writer takes the smallest of the
 * 24 turns: then the vector part is below 0.53 and takes 5 bits: about 2 degrees an axis, where lengths are
 * known to 5 %. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#define ECO_SPLAT_CODES 7u
#define ECO_SPLAT_LENGTHS 128u
#define ECO_SPLAT_TURNS 32u
#define ECO_SPLAT_OPACITIES 16u
#define ECO_SPLAT_KINDS 2u       /* foliage, wood */
#define ECO_SPLAT_TURN 28.0f

/* half[k]: vector of the k-th half axis, metres. */
struct eco_splat { float half[3][3]; float opacity; bool wood; };

/* Whether codes are in range. */
bool eco_splat_good(const int32_t code[ECO_SPLAT_CODES]);
/* From codes; out of range they count as the nearest in range. Deterministic: + - * / and square roots. */
void eco_splat_read(struct eco_splat *splat, const int32_t code[ECO_SPLAT_CODES], float unit);
/* The nearest codes of orthogonal half axes. Lengths out of range are clamped. */
void eco_splat_write(int32_t code[ECO_SPLAT_CODES], const struct eco_splat *splat, float unit);
