/* The pixels that a leaf covers at a scale, as bits: for counting what it adds to a cover, millions of times.
 *
 *   lod_fan_see(&seen, &fan, &eye);                      once an element and view
 *   lod_fan_cover(&print, &seen, edge, pixels);          for each scale
 *   lod_footprint_gain(&print, &canvas, &gain);          what it would add
 *   lod_fan_add(&seen, edge, pixels, &canvas);           adds it
 *
 * Corners are snapped to 1/256 pixel and pixels with their centres inside are covered, as in raster.h;
 * results differ from it where an edge passes a centre within a thousandth of a pixel. Integers after the
 * snapping: the same on every machine. */
#pragma once

#include "lod/build/foliage.h"
#include "lod/raster/texel.h"

#define LOD_FOOTPRINT_PIXELS 1024u       /* largest picture */

struct lod_fan {
	const float (*corner)[3], (*uv)[2];      /* uv may be NULL */
	uint32_t corners;            /* 3 to ECO_CORNERS_MAX */
	const struct lod_mask *cutout;           /* or NULL */
};
struct lod_fan lod_foliage_fan(const struct lod_foliage *foliage, uint32_t element);

/* A fan in a view: its middle, and its corners relative to it (scaling multiplies these), in units of half
 * pictures. */
struct lod_fan_seen {
	struct lod_fan fan;
	double center[3], corner[ECO_CORNERS_MAX][3];
	/* 1 or -1 if the corners go around a convex outline, by their direction; 0 otherwise, or with a
	 * cut-out. */
	int way;
};
void lod_fan_see(struct lod_fan_seen *seen, const struct lod_fan *fan, const struct lod_eye *eye);

/* Replaces the fan by its point: a square that faces the eye, with `area` square metres at edge 1, about the
 * same middle. */
void lod_fan_point(struct lod_fan_seen *seen, double area, const struct lod_eye *eye);
/* Both at once, in a part of the time. */
void lod_fan_see_point(struct lod_fan_seen *seen, const struct lod_fan *fan, double area,
	const struct lod_eye *eye);

/* Rows y .. y + rows of 64-bit words word .. word + words of a picture. */
struct lod_footprint {
	uint32_t y, rows, word, words;
	uint64_t bits[LOD_FOOTPRINT_PIXELS * (LOD_FOOTPRINT_PIXELS / 64)];
};
/* `edge`: factor of lengths about the middle. False if no pixel is covered. */
bool lod_fan_cover(struct lod_footprint *print, const struct lod_fan_seen *seen, double edge,
	uint32_t pixels);

/* A picture that is being covered. */
struct lod_canvas {
	uint32_t row_words;
	const uint64_t *reference;   /* pixels to be covered */
	uint64_t (*times)[2];        /* covered at least once, at least twice */
};
/* New pixels that should be covered, new pixels that should not; right pixels covered a second time. */
struct lod_gain { uint32_t right, wrong, second; };
/* Adds to `gain`. */
void lod_footprint_gain(const struct lod_footprint *print, const struct lod_canvas *canvas,
	struct lod_gain *gain);
/* lod_fan_cover and lod_footprint_gain in one. */
void lod_fan_gain(const struct lod_fan_seen *seen, double edge, uint32_t pixels,
	const struct lod_canvas *canvas, struct lod_gain *gain);
/* Covers pixels once more; pixels that make no difference to lod_footprint_gain may be left out. */
void lod_fan_add(const struct lod_fan_seen *seen, double edge, uint32_t pixels,
	const struct lod_canvas *canvas);
