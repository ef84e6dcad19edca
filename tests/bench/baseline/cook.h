/* Stochastic simplification with its corrections (Cook, Halstead, Planck, Ryu 2007; Neubert 2011, 2.1): what
 * an order at random is drawn with. The baseline of ecobench.
 *
 *   plain        s = 1 / lambda: the sum of the areas is kept
 *   depth        s so that the area expected to be visible is kept: large elements hide each other and a few
 *                cannot be larger than the crown
 *
 * Depth complexity: n elements, each covering the share a of the crown's outline at a random place, cover 1 -
 * (1 - a)^n of it. Keeping m of them, 1 - (1 - s a)^m is to be the same. For a few per cent and many elements
 * s is 1/lambda to the third digit; it bends where m is so small that s a nears 1, and it never exceeds 1 /
 * a. */
#pragma once

#include <stdint.h>

/* 1 / lambda for kept of count elements; 0 where nothing is kept. */
double lod_cook_scale(uint32_t kept, uint32_t count);

/* With the correction for depth complexity. share: of lod_cook_share. At most lod_cook_scale. Bisection over
 * integer powers: the same on every machine. */
double lod_cook_scale_depth(uint32_t kept, uint32_t count, double share);

/* a: the share of the outline that one element covers, from the sum of the elements' projected areas and what
 * they cover together (same unit, such as pixels, means over views). 0 where they do not overlap, 1 where
 * they all lie on each other. */
double lod_cook_share(uint32_t count, double projected, double covered);

/* Contrast: a pixel that shows fewer elements varies more (the mean of k colours has 1/k of their variance),
 * so colours are drawn in towards their mean: c' = mean + contrast * (c - mean). per_pixel: elements that
 * share a pixel in full detail; what is at least a pixel large on its own is not averaged and needs no
 * correction. In (0, 1]. */
double lod_cook_contrast(uint32_t kept, uint32_t count, double per_pixel);
