/* The lower convex hull of a ladder's error over its vertices: the hull points are the numbers of vertices
 * worth drawing, and a step is the edge between two of them. Slopes, the error saved per vertex, fall from
 * step to step. A number of vertices that pays only together with the next one is on no hull. A hull depends
 * on no view: in a slot its errors are multiplied by the slot's weight_px.
 *
 * Errors depend on how large a plant is in the picture, and on what it is seen before; both change as a camera
 * moves. So a table keeps the points that are on the hull of some size and weight, and a slot has a hull of its own
 * at its size. With a hull for each weight all plants of a slot would change at once where one hull gives way to
 * the next. So a slot's hull keeps the points that are on the hull of the least weight and on that of the greatest.
 * A slope is linear in the weight, so these points are convex at every weight between.
 *
 * Ladders that show the whole plant have a hull at the slot's weight alone.
 *
 *   hull.count = lod_hull_sample(hull.points, &way, from, to)   points[0] is `from`
 *   lod_hull_reduce(&hull, ratio)                               keeps the hull at hull.open, in place
 *   lod_hull_complete(&hull, to)
 *   x = lod_hull_position(&hull, lambda, near)                  points[floor(x)], and the next point for a
 *                                                               share x - floor(x) of the plants */
#pragma once

#include "lod/seen/tuning.h"
#include "lod/ladder.h"
#include "lod/seen/visibility.h"

#define LOD_HULL_POINTS_MAX 97u  /* one of them is appended by lod_hull_complete */
#define LOD_OPEN_LEAST LOD_OWNER_WEIGHT  /* of hull.open, whose greatest value is 1 */

/* The objective: errors that are seen (struct eco_seen), weighted. Units are wrong pixels: with bytes for texels and for
 * the ground, and with summaries, they compete by these. */
struct lod_seen_error { float alike, open; };    /* before like plants; added before ground and sky */

struct lod_hull_point {
	uint64_t vertices;           /* a value that lod_way_floor returns */
	double alike, open;          /* errors at the hull's size, a pixel */
	struct lod_seen_error seen[ECO_SEEN_SIZES];
	float fp, fn;                /* wrong pixels over covered ones: used only by predictions, ... */
	float above_fp, above_fn;    /* ... as are these, seen from above */
	double alike_slope, open_slope;      /* of the step that ends here */
};

struct lod_hull {
	struct lod_hull_point *points;  uint32_t count; /* count >= 1 */
	double open;                 /* how far plants are seen before ground and sky, LOD_OPEN_LEAST to 1 */
	double size;                 /* of the plant in the picture: an index of eco_seen, or between two */
	uint32_t impostor;           /* level of the ladder's impostor that is one vertex; ECO_NONE: none */
};

/* Samples a ladder from `from` to `to` vertices, both values that lod_way_floor returns. Returns the number
 * of points, at most LOD_HULL_POINTS_MAX - 1. */
uint32_t lod_hull_sample(struct lod_hull_point points[LOD_HULL_POINTS_MAX], const struct lod_way *way,
	uint64_t from, uint64_t to, double size);

/* Errors at `vertices`, a value that lod_way_floor returns; `size` and `impostor` are the hull's. */
struct lod_hull_point lod_hull_point_at(const struct lod_way *way, uint64_t vertices, double size,
	uint32_t impostor);
/* Levels of a ladder's impostor; 0: it has none. */
static inline uint32_t lod_hull_impostor_levels(const struct lod_way *way)
{
	uint32_t list = way->ladder->impostor;
	return list == ECO_NONE ? 0 : way->scene->lists[list].primitive_count;
}
/* The index in eco_seen of plants that are so many pixels across. */
double lod_hull_size(double px);
void lod_hull_set_size(struct lod_hull_point *point, double size);
/* The weighted sum for one size, before ground and sky. */
double lod_seen_worth(const struct eco_seen *seen, uint32_t size);

/* Indices of those of `count` points in ascending vertices that are on the lower convex hull of `errors`;
 * returns their number. Two steps whose slopes are less than `ratio` times apart become one. */
uint32_t lod_hull_lower(const struct lod_hull_point *points, const double *errors, uint32_t count,
	double ratio, uint8_t kept[LOD_HULL_POINTS_MAX]);
/* Reduces points in ascending vertices to their lower convex hull at hull->open, in place. Reduced again at
 * another weight, a hull is convex at both weights and between. */
void lod_hull_reduce(struct lod_hull *hull, double ratio);
/* Appends `to` as the last point, so that a budget for everything draws everything. Needs room for one. */
void lod_hull_complete(struct lod_hull *hull, uint64_t to);

/* Error saved per vertex by the step that ends at points[i]; falls with i. Infinite for [0]; 0 only for the
 * last, which saves nothing and completes what is drawn. */
static inline double lod_hull_slope(const struct lod_hull *hull, uint32_t i)
{
	return hull->points[i].alike_slope + hull->open * hull->points[i].open_slope;
}

/* The error of a point at the hull's weight. */
static inline double lod_hull_error(const struct lod_hull *hull, const struct lod_hull_point *point)
{
	return point->alike + hull->open * point->open;
}

/* Position in [0, count - 1]. All plants take a step whose slope is above LOD_HULL_BLUR * lambda, none take
 * one whose slope is below lambda / LOD_HULL_BLUR, and a growing share of them in between: so a slot changes
 * gradually as lambda does. `near` is any position to start from: successive lambdas lie close together. */
double lod_hull_position(const struct lod_hull *hull, double lambda, double near);
