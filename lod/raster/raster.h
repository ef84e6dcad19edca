/* A deterministic software rasteriser: coverage with depth, cut-outs and owners, for curves, scores, and
 * pictures of full detail.
 *
 *   lod_raster_init(&r, &options);                   once; then lod_raster_clear for each picture
 *   lod_raster_camera(&r, &eye, near_m);             world -> pixels
 *   lod_raster_object(&r, &place);                   object -> world, for the batches that follow
 *   lod_raster_triangles / _lines / _splats          filled by GL's rules
 *
 * It agrees with OpenGL: corners snapped to 1/256 pixel, centre sampling, top-left rule, clipping at the near
 * plane, both sides drawn. The nearer sample wins; at equal depths the smaller owner (ground where owners are
 * not kept), and within one owner the first. Coverage after the snapping is integer, but for splats. No
 * picture depends on the order of drawing. An object is not thread-safe.
 *
 * Another program draws the same by these rules. v(p) is an object point in metres along right, up and forward
 * from the eye; the picture has W x H pixels; w = forward, clipped below near_m; `scale` is the place's.
 *   pixel     x = W/2 + W/2 (v.right / w - middle_x) / tan_x,  y = H/2 - H/2 (v.up / w - middle_y) / tan_y,
 *             rounded to 1/256
 *   line      a, b = v(ends), m = (a + b) / 2, o = cross(b - a, m), o *= width * scale / 2 / |o|:
 *             the quad a-o, b-o, b+o, a+o (two triangles); nothing if |o| is 0
 *   splat     the ellipse of lod/splat.h around the centre's pixel, at the depth of its near side, but no nearer
 *             than near_m; whole or not at all, by its centre's w. Without half axes: a ball whose disc has
 *             the area area * size
 *   impostor  the rays through pixel centres that meet it (lod/impostor.h)
 *   texel     column = floor(u * width) modulo width, row = floor(v * height) modulo height, from the top left;
 *             opaque from alpha 128 on; u, v perspective-correct
 * Samples are compared by 1/w, linear on the screen for triangles and lines; none lies nearer than the
 * nearest corner, or than the ellipsoid. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/format/model.h"
#include "lod/eye.h"

struct lod_raster {
	uint32_t width, height;
	float *depth;                /* 1 / view distance: 0 empty, greater is nearer; row 0 at the top */
	uint64_t *owner; /* of the nearest plant sample; 0: nothing or ground; NULL if not asked for */
	uint8_t *cover;              /* 255 if a plant is nearest, 0 if ground or nothing is */
	uint32_t *item;              /* of the nearest primitive (lod_raster_batch); NULL if not asked for */
	/* leaf_at (lod/leaf.glsl) of the nearest primitive, if it has leaves; NULL if items are not asked for */
	uint32_t *leaf;
	/* private */
	struct lod_raster_state *state;
};
/* silhouette: only `cover` is wanted, and all ground is drawn before any plant. Depth becomes infinite at
 * covered pixels, so they are not tested again; in a dense crown nearly all samples fall on such pixels. */
struct lod_raster_options { uint32_t width, height; bool owner, item, silhouette; };
/* Sides of 1 to ECO_IMAGE_MAX pixels, and memory for them; or the end of the program (memory.h). */
void lod_raster_init(struct lod_raster *raster, const struct lod_raster_options *options);
void lod_raster_free(struct lod_raster *raster);
void lod_raster_clear(struct lod_raster *raster);
void lod_raster_camera(struct lod_raster *raster, const struct lod_eye *eye, double near_m);
void lod_raster_object(struct lod_raster *raster, const struct lod_place *place);
/* Clears the picture and sets the camera, for an object as it is in its own space. */
void lod_raster_look(struct lod_raster *raster, const struct lod_eye *eye, double near_m);

/* One batch: a range of one list. Positions are in object space. */
struct lod_mask;
struct lod_raster_batch {
	uint32_t count;              /* triangles, lines or splats */
	/* 3 per vertex; triangles: 3 vertices each, lines: 2, splats: 1 */
	const float *position;
	const float *uv;             /* triangles only, 2 per vertex, or NULL */
	const struct eco_image *cutout;   /* samples with alpha < 0.5 (nearest texel, wrapping) are left out;
	                                   * NULL: opaque */
	const struct lod_mask *mask; /* the same by bits, which caches hold where they hold no image; or NULL */
	const float *width;          /* lines: full width in object units, one each */
	float area;                  /* balls: area of the disc, object units^2 */
	const float *size;           /* balls: factors of `area`, one each, or NULL: all 1 */
	const float *half, *opacity; /* splats: three half axes (9), and 1, each; NULL: balls; opaque */
	float leaf;                  /* splats, balls: width of the leaves on them, object units; 0: smooth */
	const float *wood;           /* splats: 1 has none all the same, one each; or NULL */
	uint32_t item;               /* number of the first primitive; those after it count on */
	uint64_t owner;              /* 0 draws ground, which hides and is not covered */
};
void lod_raster_triangles(struct lod_raster *raster, const struct lod_raster_batch *batch);
void lod_raster_lines(struct lod_raster *raster, const struct lod_raster_batch *batch);
void lod_raster_splats(struct lod_raster *raster, const struct lod_raster_batch *batch);
/* One impostor (lod/impostor.h); pixels have the items batch->item + cell. As a splat it is drawn whole or
 * not at all, and not where the eye is in the ball around it. Only owner and item of the batch count. */
struct lod_impostor;
void lod_raster_impostor(struct lod_raster *raster, const struct lod_impostor *impostor,
	const struct lod_raster_batch *batch);
/* One of these, by the list's kind; geometry as lod_list_geometry wrote it, `area` for the cut's scale. */
struct lod_geometry;
void lod_raster_list(struct lod_raster *raster, const struct eco_list *list,
	const struct lod_geometry *geometry, const struct lod_raster_batch *batch);

/* True if a world-space sphere is certainly hidden behind what has been drawn (coarse depth, ground included), or
 * outside the picture. It must hold all that would be drawn: also half a line's width, a ball's radius or a
 * splat's longest half axis, times the place's scale. Objects may be up to a thousand radii across. */
bool lod_raster_hides(struct lod_raster *raster, const double center[3], double radius);

/* Merges one finished picture into another of the same size and options by the rule of drawing, so that
 * threads may share a scene. If one owner has items at equal depth, those of `into` stay. */
void lod_raster_merge(struct lod_raster *into, const struct lod_raster *from);

/* Precision and Recall of covered pixels (Neubert 2011, eq. 1 and 4). Owners may be NULL: then owner_q = q.
 *   precision  tp / (tp + fp); 1 if nothing is covered, as nothing was claimed wrongly
 *   recall     tp / (tp + fn); 1 if the reference covers nothing, as nothing was missed
 *   q          1 - sqrt((1-P)^2 + (1-R)^2), in [1 - sqrt 2, 1]; if just one of the two masks is empty, one
 *              of P and R is 0 and the other 1, so q is 0; if both are empty, q is 1
 *   skill      (q - q_on) / (1 - q_on), where q_on is the q of a picture with every pixel covered: the gain
 *              over a plain green card; NaN if q_on is 1
 *   owner_q    q with only the true positives whose owners match (eco_owner_match), over the same
 *              denominators */
struct lod_score {
	uint64_t tp, fp, fn, tp_owner, pixels;
	double precision, recall, q, skill, owner_q;
};
struct lod_score_input {
	uint32_t width, height;
	const uint8_t *cover, *reference;                /* 0 or not 0 */
	const uint64_t *owner, *reference_owner;
};
void lod_score(struct lod_score *score, const struct lod_score_input *input);

/* Q of how much of each pixel is covered, by counts of as many samples a pixel in both pictures: with a and b
 * for a pixel's shares, P = sum min(a, b) / sum a and R = sum min(a, b) / sum b. If all is covered wholly
 * or not at all it is q. */
double lod_soft_q(const uint8_t *count, const uint8_t *reference_count, size_t pixels);
/* The best q that a picture reaches whose geometry does not repeat what single samples of the reference hit
 * by chance: that of the reference's own counts, where the pixels covered most stand for all, about as many
 * as are covered in `reference`. Exact geometry may exceed it. */
double lod_q_ceiling(const uint8_t *reference_count, const uint8_t *reference, size_t pixels);
