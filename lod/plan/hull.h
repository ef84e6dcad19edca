/* The lower convex hull of a ladder's error over its vertices: the hull points are the numbers of vertices
 * worth drawing, and a step is the edge between two of them. Slopes, the error saved per vertex, fall from
 * step to step. A number of vertices that pays only together with the next one is on no hull. A hull depends
 * on no view: in a slot its errors are multiplied by the slot's weight_px.
 *
 * A hull does not depend on fp_weight either, the weight of a false positive, which differs from slot to slot
 * and changes as a camera moves. With a hull for each weight all plants of a slot would change at once where
 * one hull gives way to the next. So a hull keeps the points that are on the hull of the least weight and on
 * that of the greatest. A slope is linear in the weight, so these points are convex at every weight between.
 *
 * Elements smaller than a pixel lose no detail, and how large they are depends on the band: there a hull is
 * made again, of points of the table's.
 *
 * Ladders that show the whole plant trade one error for the other, so each slot has a hull of its own, at its
 * weight.
 *
 *   hull.count = lod_hull_sample(hull.points, &way, from, to)   points[0] is `from`
 *   lod_hull_reduce(&hull, ratio)                               keeps the hull at hull.fp_weight, in place
 *   lod_hull_complete(&hull, to)
 *   x = lod_hull_position(&hull, lambda, near)                  points[floor(x)], and the next point for a
 *                                                               share x - floor(x) of the plants */
#ifndef LOD_HULL_H
#define LOD_HULL_H

#include "lod/ladder.h"
#include "lod/plan/visibility.h"

#define LOD_HULL_POINTS_MAX 97u  /* one of them is appended by lod_hull_complete */
#define LOD_FP_WEIGHT_LEAST LOD_OWNER_WEIGHT /* of fp_weight, whose greatest value is 1 */

/* Error added where nothing of a plant's foliage is drawn, over its pixels: a tree without leaves is another
 * tree. Without it thin crowns, in which coarse leaves cover more gaps than leaves, stay bare until there are
 * vertices for fine ones (lod/EXPERIMENTS.md, Weight of an absent crown). */
#define LOD_ABSENT_WEIGHT 1.0

struct lod_hull_point {
	uint64_t vertices;           /* a value that lod_way_floor returns */
	double fp, fn;               /* errors over covered pixels; neither fn nor fn + fp_weight * fp rises;
	                              * points[0] includes lod_hull_absent */
	double detail;               /* lost in colour and texture, at the hull's slack */
	float octaves;               /* how much wider than in full detail elements are, log2; of splats: one
	                              * of n over the only one */
	float above_fp, above_fn;    /* the same seen from above: used only by predictions */
	double fn_slope, fp_slope;   /* of the step that ends here; fn_slope with detail */
};

struct lod_hull {
	struct lod_hull_point *points;  uint32_t count; /* count >= 1 */
	double fp_weight;            /* weight of a false positive; a false negative weighs 1 */
	double slack;                /* octaves that nobody sees: up to the width of a pixel, or of full
	                              * detail */
	uint32_t impostor;           /* level of the ladder's impostor that is one vertex; ECO_NONE: none */
};

/* Samples a ladder from `from` to `to` vertices, both values that lod_way_floor returns. Returns the number
 * of points, at most LOD_HULL_POINTS_MAX - 1. */
uint32_t lod_hull_sample(struct lod_hull_point points[LOD_HULL_POINTS_MAX], const struct lod_way *way,
	uint64_t from, uint64_t to, double slack);

/* Error added at 0 vertices: LOD_ABSENT_WEIGHT or 0. For a ladder that shows the whole plant it is the most
 * that it can be; what it is depends on the plant's organs as they are seen (allocation_weights.c). */
double lod_hull_absent(const struct eco_ladder *ladder);
/* Errors at `vertices`, a value that lod_way_floor returns; `slack` and `impostor` are the hull's. */
struct lod_hull_point lod_hull_point_at(const struct lod_way *way, uint64_t vertices, double slack,
	uint32_t impostor);
/* Levels of a ladder's impostor; 0: it has none. */
static inline uint32_t lod_hull_impostor_levels(const struct lod_way *way)
{
	uint32_t list = way->ladder->impostor;
	return list == ECO_NONE ? 0 : way->scene->lists[list].primitive_count;
}
/* Sets detail from octaves and slack: each octave that is seen costs LOD_OCTAVE_WEIGHT of a pixel, all of
 * them at most `most`. Splats for a whole plant may be many octaves wider than leaves, the elements of an
 * organ are few (lod/EXPERIMENTS.md, Impostors in scenes). */
#define LOD_OCTAVE_WEIGHT 0.1
#define LOD_DETAIL_MOST 0.15       /* of an organ, or a summary */
#define LOD_DETAIL_MOST_WHOLE 0.4  /* of a ladder that shows the whole plant */
void lod_hull_set_detail(struct lod_hull_point *point, double slack, double most);

/* Reduces points in ascending vertices to their lower convex hull at hull->fp_weight, in place. Two steps
 * whose slopes are less than `ratio` times apart become one. Reduced again at another weight, a hull is
 * convex at both weights and between. */
void lod_hull_reduce(struct lod_hull *hull, double ratio);
/* The same where false negatives may become more as false positives become fewer, as with splats: a hull at
 * hull->fp_weight alone. */
void lod_hull_reduce_here(struct lod_hull *hull, double ratio);
#define LOD_HULL_SLOPE_RATIO 1.25 /* for ladders: where a curve is nearly straight more points save nothing,
                                   * but more plants change as a camera moves */
/* Appends `to` as the last point, so that a budget for everything draws everything. Needs room for one. */
void lod_hull_complete(struct lod_hull *hull, uint64_t to);

/* Error saved per vertex by the step that ends at points[i]; falls with i. Infinite for [0]; 0 only for the
 * last, which saves nothing and completes what is drawn. */
static inline double lod_hull_slope(const struct lod_hull *hull, uint32_t i)
{
	return hull->points[i].fn_slope + hull->fp_weight * hull->points[i].fp_slope;
}

/* The error of a point at the hull's fp_weight. */
static inline double lod_hull_error(const struct lod_hull *hull, const struct lod_hull_point *point)
{
	return point->fn + point->detail + hull->fp_weight * point->fp;
}
static inline double lod_hull_uncovered(const struct lod_hull *hull, const struct lod_hull_point *point)
{
	return point->fn + hull->fp_weight * point->fp; /* without detail */
}
/* eco_predicted_q, from wrong pixels over all that should be covered; the least, 1 - sqrt(2), where none of
 * them is. */
double lod_hull_q(double fp, double fn);
/* Q where false positives count in full. fp_weight supposes less, as some of them lie outside the picture or
 * over other plants, but those of a few large splats lie around the crown. */
static inline double lod_hull_own_q(const struct lod_hull_point *point)
{
	return lod_hull_q(point->fp, point->fn);
}
/* Curves of an impostor and of splats are off by up to so much, each by an error of its own: splats that come
 * after an impostor must be better by that. Those that come after splats may be as much worse as noise is: so
 * much of Q, and of the error, which then counts as no worse. */
#define LOD_HULL_Q_MORE 0.01
#define LOD_HULL_Q_FALL 0.005
#define LOD_HULL_NOISE 0.01
/* Errors of foliage and flowers count so often for that: organs drawn together are more wrong than the sum of
 * each drawn alone, those of a palm by a third (lod/EXPERIMENTS.md, Impostors in scenes). */
#define LOD_ORGANS_MORE 1.2
static inline double lod_hull_more(const struct eco_ladder *ladder)
{
	return ladder->organ == ECO_ORGAN_WOOD || (ladder->flags & ECO_LADDER_WHOLE) ? 1 : LOD_ORGANS_MORE;
}

#define LOD_HULL_BLUR 1.25
/* Position in [0, count - 1]. All plants take a step whose slope is above LOD_HULL_BLUR * lambda, none take
 * one whose slope is below lambda / LOD_HULL_BLUR, and a growing share of them in between: so a slot changes
 * gradually as lambda does. `near` is any position to start from: successive lambdas lie close together. */
double lod_hull_position(const struct lod_hull *hull, double lambda, double near);

#endif
