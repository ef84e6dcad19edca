/* Scattered points of summaries: each in 2^n smaller ones around it, with its owner and colour, as far as its
 * ball would reach. Their places follow from the point's number, so they take no bytes; more of them are the
 * same ones and others (ecofiles/format/plan.h; lod/EXPERIMENTS.md, Scattered points). */
#pragma once

#include <stdint.h>

#include "lod/geometry.h"

/* Offset of a part of a point from it along each axis, in radii of the point's ball: in (-1, 1), whole
 * multiples of 1/32, so that floats hold it and shaders find the same (hash.h). */
void lod_scattered_offset(float offset[3], uint32_t point, uint32_t part);

/* Radius of the ball that a point of the list is at an area factor, metres. */
double lod_ball_radius(const struct eco_list *list, float scale);

/* Makes `count` points, beginning with number `first` of its list, 2^halvings as many, in place, where
 * there is room for so many: positions and colours. radius: of each point's ball, metres. */
void lod_scatter(struct lod_geometry *geometry, uint32_t count, uint32_t first, unsigned halvings,
	double radius);
