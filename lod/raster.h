/* A small deterministic software rasteriser: coverage with depth, cut-outs and owners. Curves are measured with it while a pack is
 * built, pictures are scored with it, and the full-detail reference can be drawn with it.
 *
 *   lod_raster_init(&r, width, height, with_owner);  lod_raster_clear(&r);
 *   lod_raster_camera(&r, &eye, near_m);             world -> pixels; or lod_raster_matrix for a plain 4x4
 *   lod_raster_object(&r, &place);                   object -> world, for what follows
 *   lod_raster_triangles / _lines / _points          filled by GL's rules
 *
 * Agrees with OpenGL: window coordinates snapped to 1/256 pixel, centre sampling, top-left rule, triangles clipped at the near
 * plane, both sides drawn, depth tested per pixel (nearer wins; equal depth keeps the first). Points are squares of a given
 * world area facing the screen; lines are quads of a given world width around the segment, facing the eye. All coverage decisions
 * after the snapping are integer. Not thread-safe per object; different objects are independent. */
#ifndef LOD_RASTER_H
#define LOD_RASTER_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/model.h"
#include "lod/view.h"

struct lod_raster {
	uint32_t width, height;
	float *depth;                /* reciprocal of view distance: 0 empty, greater is nearer; row 0 at the top */
	uint64_t *owner;             /* of the nearest plant sample; 0 nothing or ground; NULL if not asked for */
	uint8_t *cover;              /* 255 where a plant is nearest, else 0 (ground is nearest, or nothing) */
	uint8_t *rgb;                /* 3 per pixel, or NULL; flat colours, no shading */
	/* private */
	struct lod_raster_state *state;
};
struct lod_raster_options { uint32_t width, height; bool owner, rgb; };
enum eco_code lod_raster_init(struct lod_raster *raster, const struct lod_raster_options *options, struct eco_error *error);
void lod_raster_free(struct lod_raster *raster);
void lod_raster_clear(struct lod_raster *raster);
void lod_raster_camera(struct lod_raster *raster, const struct lod_eye *eye, double near_m);
void lod_raster_object(struct lod_raster *raster, const struct lod_place *place);

/* One batch: all of one list's range. Positions in object space. */
struct lod_raster_batch {
	uint32_t count;              /* triangles, lines or points */
	const float *position;       /* 3 per vertex; triangles: 3 vertices each, lines: 2, points: 1 */
	const float *uv;             /* triangles only, 2 per vertex, or NULL */
	const struct eco_image *cutout;   /* samples with alpha < 0.5 (nearest texel, wrapping) are not there; NULL: opaque */
	const float *width;          /* lines: full width in object units, one each */
	float area;                  /* points: area of the square in object units^2 */
	const uint8_t *rgb;          /* 3 per primitive or NULL */
	uint64_t owner;              /* 0 draws ground: it hides, and is not covered */
};
void lod_raster_triangles(struct lod_raster *raster, const struct lod_raster_batch *batch);
void lod_raster_lines(struct lod_raster *raster, const struct lod_raster_batch *batch);
void lod_raster_points(struct lod_raster *raster, const struct lod_raster_batch *batch);

/* True if a world-space sphere is certainly hidden behind what has been drawn (coarse depth), or outside the picture. Exact in the
 * sense that skipping it changes no pixel. */
bool lod_raster_hides(struct lod_raster *raster, const double center[3], double radius);

/* Precision and Recall of covered pixels (Neubert 2011, eq. 1 and 4). Owners may be NULL: then owner_q = q. */
struct lod_score {
	uint64_t tp, fp, fn, tp_owner, pixels;
	double precision, recall, q, skill, owner_q;     /* skill is NaN where Q of "all covered" is 1; see score.c for empty masks */
};
struct lod_score_input {
	uint32_t width, height;
	const uint8_t *cover, *reference;                /* 0 or not 0 */
	const uint64_t *owner, *reference_owner;
};
void lod_score(struct lod_score *score, const struct lod_score_input *input);

#endif
