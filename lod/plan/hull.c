/* Sampling, reducing and reading of hulls: see lod/plan/hull.h. */
#include "lod/plan/hull.h"

#include <math.h>

#include "ecofiles/format/impostor.h"
#include "ecofiles/format/plan.h"

/* Splats that are as sharp as a texel. A crown's inside is coarser than its outline: cells of depth and
 * colour are 4 texels wide, and four directions are mixed (lod/EXPERIMENTS.md, Impostors in scenes). */
#define SPLATS_PER_TEXEL (1.0 / 64)
#define GROWTH 4u                /* samples grow by a quarter: curves are smooth */

/* Slopes of the step between two points. */
static void set_slopes(const struct lod_hull_point *from, struct lod_hull_point *to)
{
	double vertices = (double)(to->vertices - from->vertices);
	to->fn_slope = (from->fn + from->detail - to->fn - to->detail) / vertices;
	to->fp_slope = (from->fp - to->fp) / vertices;
}

static void reduce(struct lod_hull *hull, double ratio, bool falls)
{
	struct lod_hull_point *a = hull->points;
	uint32_t kept = 1;
	a[0].fn_slope = INFINITY;
	a[0].fp_slope = 0;
	for (uint32_t i = 1; i < hull->count; i++) {
		a[kept] = a[i];
		if (falls) {                 /* what rises is noise of the measurement */
			a[kept].fn = fmin(a[kept].fn, a[kept - 1].fn);
			a[kept].above_fn = fminf(a[kept].above_fn, a[kept - 1].above_fn);
		}
		for (;; kept--, a[kept] = a[kept + 1]) {
			set_slopes(&a[kept - 1], &a[kept]);
			if (kept == 1 || ratio * lod_hull_slope(hull, kept) < lod_hull_slope(hull, kept - 1))
				break;
		}
		kept += lod_hull_slope(hull, kept) > 0;
	}
	hull->count = kept;
}

void lod_hull_reduce(struct lod_hull *hull, double ratio) { reduce(hull, ratio, true); }
void lod_hull_reduce_here(struct lod_hull *hull, double ratio) { reduce(hull, ratio, false); }

/* Share of a whole-plant list that is drawn without cells: all of the list is only a share of the plant,
 * though the curve goes on. */
static double share_alone(const struct lod_way *way, uint64_t vertices)
{
	const struct eco_ladder *ladder = way->ladder;
	double share = lod_way_share(way, vertices), reach = lod_way_density(way, vertices);
	const struct eco_curve *c = way->scene->curves + ladder->curve_first;
	uint32_t i = 0;
	while (i < ladder->curve_count && (double)c[i].reach < reach)
		i++;
	if (reach >= 1 || i == 0 || i == ladder->curve_count)
		return share;
	double part = (reach - (double)c[i - 1].reach) / ((double)c[i].reach - (double)c[i - 1].reach);
	return fmin(share, (double)c[i - 1].share + part * ((double)c[i].share - (double)c[i - 1].share));
}

/* Share of the same list beside cells: at full detail the list stands for all that cells may add, but not
 * without error before they do. */
static double share_beside(const struct lod_way *way, uint64_t vertices)
{
	return lod_way_share(way, vertices < way->full ? vertices : lod_way_floor(way, way->full - 1));
}

double lod_hull_absent(const struct eco_ladder *ladder)
{
	if (ladder->flags & ECO_LADDER_WHOLE)
		return LOD_ABSENT_WEIGHT;
	return ladder->organ != ECO_ORGAN_WOOD && !ladder->before && ladder->curve_count ? LOD_ABSENT_WEIGHT
		: 0;
}

/* Half of the elements, each as large as two, look half an octave coarser. Wood has no such loss: the thinnest
 * twigs go first, and the others keep their width. */
static double octaves_of(const struct lod_way *way, uint64_t vertices)
{
	if (way->has_splats)
		return -lod_octaves((double)vertices);
	double share = way->has_forms ? lod_way_density(way, vertices) : lod_way_share(way, vertices);
	return way->ladder->organ == ECO_ORGAN_WOOD || share >= 1 ? 0 : -lod_octaves(share);
}

void lod_hull_set_detail(struct lod_hull_point *point, double slack, double most)
{
	double seen = (double)point->octaves - slack;
	point->detail = seen > 0 ? fmin(most, LOD_OCTAVE_WEIGHT * seen) : 0;
}

double lod_hull_q(double fp, double fn)
{
	double right = 1 - fn;
	return right > 0 ? eco_predicted_q(&(struct eco_prediction){ right, fp, fn }) : 1 - sqrt(2);
}

/* A level of the ladder's impostor: as sharp as splats that are as many as its cells. */
static struct lod_hull_point impostor_point(const struct lod_way *way, uint32_t level, double slack)
{
	double share = (level + 1.0) / lod_hull_impostor_levels(way) / (double)way->full,
		texels = eco_impostor_sizes[level].texels;
	struct eco_curve curve = lod_ladder_curve(way->scene, way->ladder, share),
		above = lod_ladder_curve_seen(way->scene, way->ladder, share, 1);
	struct lod_hull_point point = { .vertices = 1, .fp = curve.fp, .fn = curve.fn,
		.octaves = (float)-lod_octaves(texels * texels * SPLATS_PER_TEXEL), .above_fp = above.fp,
		.above_fn = above.fn };
	lod_hull_set_detail(&point, slack, LOD_DETAIL_MOST_WHOLE);
	return point;
}

struct lod_hull_point lod_hull_point_at(const struct lod_way *way, uint64_t vertices, double slack,
	uint32_t impostor)
{
	if (vertices == 1 && impostor < lod_hull_impostor_levels(way))
		return impostor_point(way, impostor, slack);
	const struct eco_scene *scene = way->scene;
	const struct eco_ladder *ladder = way->ladder;
	const struct eco_plant *plant = &scene->plants[ladder->plant];
	bool coarse = plant->anchor_count > 1 && ladder->anchor == plant->anchor_first
		&& !(ladder->flags & (ECO_LADDER_FAR | ECO_LADDER_WHOLE));
	bool alone = ladder->anchor == plant->anchor_first && vertices == lod_way_stage_end(way);
	double share = alone ? share_alone(way, vertices) : coarse && way->full ? share_beside(way, vertices)
		: lod_way_share(way, vertices);
	struct eco_curve curve = { .fn = (float)(1 - share) }, above = curve; /* not measured */
	if (ladder->curve_count) {
		curve = lod_ladder_curve(scene, ladder, share);
		above = lod_ladder_curve_seen(scene, ladder, share, 1);
	}
	double absent = vertices == 0 && ladder->curve_count ? lod_hull_absent(ladder) : 0;
	struct lod_hull_point point = { .vertices = vertices, .fp = curve.fp, .fn = curve.fn + absent,
		.octaves = (float)octaves_of(way, vertices), .above_fp = above.fp,
		.above_fn = (float)(above.fn + absent) };
	lod_hull_set_detail(&point, slack, way->has_splats ? LOD_DETAIL_MOST_WHOLE : LOD_DETAIL_MOST);
	return point;
}

uint32_t lod_hull_sample(struct lod_hull_point points[LOD_HULL_POINTS_MAX], const struct lod_way *way,
	uint64_t from, uint64_t to, double slack)
{
	uint64_t stage = lod_way_stage_end(way), at = from;
	uint32_t count = 1;
	points[0] = lod_hull_point_at(way, from, slack, ECO_NONE);
	while (at < to && count < LOD_HULL_POINTS_MAX - 2) {
		uint64_t next = lod_way_next(way, at), further = lod_way_floor(way, at + at / GROWTH + 1);
		next = further > next ? further : next;
		uint64_t level = lod_way_level_above(way, at);
		if (at < stage && next > stage) /* the curve often bends where a stage or a level ends */
			next = stage;
		next = next < level ? next : level;
		at = next < to ? next : to;
		points[count++] = lod_hull_point_at(way, at, slack, ECO_NONE);
	}
	if (at < to)
		points[count++] = lod_hull_point_at(way, to, slack, ECO_NONE);
	return count;
}

void lod_hull_complete(struct lod_hull *hull, uint64_t to)
{
	const struct lod_hull_point *last = &hull->points[hull->count - 1];
	if (last->vertices < to)
		hull->points[hull->count++] = (struct lod_hull_point){ .vertices = to, .fp = last->fp,
			.fn = last->fn, .detail = last->detail, .octaves = last->octaves,
			.above_fp = last->above_fp, .above_fn = last->above_fn };
}

double lod_hull_position(const struct lod_hull *hull, double lambda, double near)
{
	double taken = lambda * LOD_HULL_BLUR;
	/* the last step that all plants take */
	uint32_t low = (uint32_t)near;
	while (low + 1 < hull->count && lod_hull_slope(hull, low + 1) >= taken)
		low++;
	while (low > 0 && lod_hull_slope(hull, low) < taken)
		low--;
	/* nearby steps overlap: their shares add up */
	double position = low;
	for (uint32_t i = low + 1; i < hull->count && lod_hull_slope(hull, i) * LOD_HULL_BLUR > lambda; i++)
		position += (lod_hull_slope(hull, i) * LOD_HULL_BLUR / lambda - 1)
			/ (LOD_HULL_BLUR * LOD_HULL_BLUR - 1);
	return position;
}
