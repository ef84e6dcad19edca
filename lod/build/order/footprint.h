/* Which pixels a leaf covers at a scale, as bits: for counting what it adds to what is covered already, millions of times.
 *
 *   lod_fan_see(&seen, &fan, &eye);                      once an element and view
 *   lod_fan_cover(&print, &seen, edge, pixels);          for each scale that is tried
 *   lod_footprint_gain(&print, &canvas, &gain);          what it would add
 *   lod_fan_add(&seen, edge, pixels, &canvas);           adds it
 *
 * Corners are snapped to 1/256 pixel and pixels whose centres lie inside are covered, as in raster.h, from which it differs where an edge
 * passes a centre within a thousandth of a pixel. Integers after the snapping: the same on every machine. */
#ifndef LOD_FOOTPRINT_H
#define LOD_FOOTPRINT_H

#include "lod/build/foliage.h"
#include "lod/raster/mask.h"

#define LOD_FOOTPRINT_PIXELS 1024u       /* largest picture */

struct lod_fan {
	const float (*corner)[3], (*uv)[2];      /* uv may be NULL */
	uint32_t corners;            /* 3 to ECO_CORNERS_MAX */
	const struct lod_mask *cutout;           /* or NULL */
};
struct lod_fan lod_foliage_fan(const struct lod_foliage *foliage, uint32_t element, const struct lod_mask *cutout);

/* A fan in a view: its middle, and its corners from there, in units of half pictures; what is scaled are the latter. */
struct lod_fan_seen {
	struct lod_fan fan;
	double center[3], corner[ECO_CORNERS_MAX][3];
	int way;                     /* 1 or -1 where corners go around something convex, by the way they go; 0 otherwise, or with a cut-out */
};
void lod_fan_see(struct lod_fan_seen *seen, const struct lod_fan *fan, const struct lod_eye *eye);

/* Puts the point that stands for it in its place: a square that faces the eye, of `area` at edge 1, in square metres, about the same middle. */
void lod_fan_point(struct lod_fan_seen *seen, double area, const struct lod_eye *eye);

/* Rows y .. y + rows of 64-bit words word .. word + words of a picture. */
struct lod_footprint {
	uint32_t y, rows, word, words;
	uint64_t bits[LOD_FOOTPRINT_PIXELS * (LOD_FOOTPRINT_PIXELS / 64)];
};
/* `edge`: what lengths are multiplied by about the middle. False where no pixel is covered. */
bool lod_fan_cover(struct lod_footprint *print, const struct lod_fan_seen *seen, double edge, uint32_t pixels);

/* A picture that is being covered. */
struct lod_canvas {
	uint32_t row_words;
	const uint64_t *reference;   /* what is to be covered */
	uint64_t (*times)[2];        /* covered at least once, at least twice */
};
struct lod_gain { uint32_t right, wrong, second; };      /* pixels newly covered that should be, that should not; right ones covered a second time */
/* Adds to `gain`. */
void lod_footprint_gain(const struct lod_footprint *print, const struct lod_canvas *canvas, struct lod_gain *gain);
/* lod_fan_cover and lod_footprint_gain in one. */
void lod_fan_gain(const struct lod_fan_seen *seen, double edge, uint32_t pixels, const struct lod_canvas *canvas, struct lod_gain *gain);
/* Covers pixels once more; those that make no difference to what lod_footprint_gain counts may be left out. */
void lod_fan_add(const struct lod_fan_seen *seen, double edge, uint32_t pixels, const struct lod_canvas *canvas);

#endif
