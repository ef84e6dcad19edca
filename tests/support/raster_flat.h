/* For tests of the rasteriser: random numbers, an eye whose pixels are easy to compute, ways to draw. */
#ifndef TESTS_RASTER_FLAT_H
#define TESTS_RASTER_FLAT_H

#include "lod/raster/raster.h"

/* The state of the two below; each test sets it. */
extern uint64_t rnd_seed;
uint32_t rnd(uint32_t below);
double uniform(double low, double high);

/* An eye at the origin looking along +y, one pixel a unit at distance 1: pixel = middle + x / y, middle - z /
 * y, exactly. */
struct lod_eye flat_eye(uint32_t width, uint32_t height);
/* A raster with owners and items; eye NULL: the flat one. */
void raster_start(struct lod_raster *raster, uint32_t width, uint32_t height, const struct lod_eye *eye);
/* The object-space point that a flat eye sees at (x, y) / 256 pixels at distance w; exact for small integers
 * and powers of two. */
void raster_put(float *p, const struct lod_raster *raster, double x, double y, double w);
/* Opaque triangles. */
void raster_draw(struct lod_raster *raster, const float *position, uint32_t count, uint64_t owner);
uint64_t raster_covered(const struct lod_raster *raster);

#endif
