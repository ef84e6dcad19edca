/* Sampling, reducing and reading of hulls: see lod/seen/hull.h. */
#include "lod/seen/hull.h"

#include <math.h>

/* ---- Errors ---- */

double lod_seen_worth(const struct eco_seen *seen, uint32_t size)
{
	return ECO_SEEN_UNIT * (LOD_SEEN_COLOR * seen->color[size][1] + LOD_SEEN_CONTRAST * seen->contrast[size][1]);
}

static void set_errors(struct lod_hull_point *point, const struct eco_seen *seen)
{
	for (uint32_t size = 0; size < ECO_SEEN_SIZES; size++) {
		double open = lod_seen_worth(seen, size), alike = ECO_SEEN_UNIT * (LOD_SEEN_COLOR
			* seen->color[size][0] + LOD_SEEN_CONTRAST * seen->contrast[size][0]);
		point->seen[size] = (struct lod_seen_error){ (float)alike, (float)(open - alike) };
	}
}

double lod_hull_size(double px)
{
	double size = px > 0 ? lod_octaves(ECO_SEEN_PX(0) / px) : ECO_SEEN_SIZES;
	return size < 0 ? 0 : size > ECO_SEEN_SIZES - 1 ? ECO_SEEN_SIZES - 1 : size;
}

void lod_hull_set_size(struct lod_hull_point *point, double size)
{
	uint32_t whole = (uint32_t)size;
	double part = size - whole;
	const struct lod_seen_error *a = &point->seen[whole], *b = part > 0 ? a + 1 : a;
	point->alike = (double)a->alike + part * ((double)b->alike - (double)a->alike);
	point->open = (double)a->open + part * ((double)b->open - (double)a->open);
}

/* ---- Hulls ---- */

/* Slopes of the step between two points. */
static void set_slopes(const struct lod_hull_point *from, struct lod_hull_point *to)
{
	double vertices = (double)(to->vertices - from->vertices);
	to->alike_slope = (from->alike - to->alike) / vertices;
	to->open_slope = (from->open - to->open) / vertices;
}

uint32_t lod_hull_lower(const struct lod_hull_point *points, const double *errors, uint32_t count,
	double ratio, uint8_t kept[LOD_HULL_POINTS_MAX])
{
	double slopes[LOD_HULL_POINTS_MAX] = { INFINITY }, slope;
	uint32_t last = 0;
	kept[0] = 0;
	for (uint32_t i = 1; i < count; i++) {
		for (;; last--) {
			const uint32_t from = kept[last];
			const uint64_t vertices = points[i].vertices - points[from].vertices;
			slope = (errors[from] - errors[i]) / (double)vertices;
			if (last == 0 || ratio * slope < slopes[last])
				break;
		}
		if (slope > 0) {
			kept[++last] = (uint8_t)i;
			slopes[last] = slope;
		}
	}
	return last + 1;
}

void lod_hull_reduce(struct lod_hull *hull, double ratio)
{
	struct lod_hull_point *a = hull->points;
	double errors[LOD_HULL_POINTS_MAX];
	uint8_t kept[LOD_HULL_POINTS_MAX];
	for (uint32_t i = 0; i < hull->count; i++)
		errors[i] = lod_hull_error(hull, &a[i]);
	hull->count = lod_hull_lower(a, errors, hull->count, ratio, kept);
	a[0].alike_slope = INFINITY;
	a[0].open_slope = 0;
	for (uint32_t i = 1; i < hull->count; i++) {
		a[i] = a[kept[i]];
		set_slopes(&a[i - 1], &a[i]);
	}
}

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

static struct lod_hull_point measured(const struct lod_way *way, double share, uint64_t vertices, double size)
{
	struct eco_curve curve = lod_ladder_curve(way->scene, way->ladder, share),
		above = way->ladder->flags & ECO_LADDER_ABOVE
		? lod_ladder_curve_seen(way->scene, way->ladder, share, 1) : curve;
	struct lod_hull_point point = { .vertices = vertices, .fp = curve.fp, .fn = curve.fn, .above_fp = above.fp,
		.above_fn = above.fn };
	set_errors(&point, &curve.seen);
	lod_hull_set_size(&point, size);
	return point;
}

struct lod_hull_point lod_hull_point_at(const struct lod_way *way, uint64_t vertices, double size,
	uint32_t impostor)
{
	uint32_t levels = lod_hull_impostor_levels(way);
	if (vertices == 1 && impostor < levels) {
		struct lod_hull_point point = measured(way, (impostor + 1.0) / levels / (double)way->full, 1, size);
		for (uint32_t i = 0; i < ECO_SEEN_SIZES; i++)
			point.seen[i] = (struct lod_seen_error){ (float)LOD_IMPOSTOR_WRONG * point.seen[i].alike,
				(float)LOD_IMPOSTOR_WRONG * point.seen[i].open };
		lod_hull_set_size(&point, size);
		return point;
	}
	const struct eco_ladder *ladder = way->ladder;
	const struct eco_plant *plant = &way->scene->plants[ladder->plant];
	bool coarse = plant->anchor_count > 1 && ladder->anchor == plant->anchor_first
		&& !(ladder->flags & (ECO_LADDER_FAR | ECO_LADDER_WHOLE));
	bool alone = ladder->anchor == plant->anchor_first && vertices == lod_way_stage_end(way);
	double share = alone ? share_alone(way, vertices) : coarse && way->full ? share_beside(way, vertices)
		: lod_way_share(way, vertices);
	return measured(way, share, vertices, size);
}

uint32_t lod_hull_sample(struct lod_hull_point points[LOD_HULL_POINTS_MAX], const struct lod_way *way,
	uint64_t from, uint64_t to, double size)
{
	uint64_t stage = lod_way_stage_end(way), at = from;
	uint32_t count = 1;
	points[0] = lod_hull_point_at(way, from, size, ECO_NONE);
	while (at < to && count < LOD_HULL_POINTS_MAX - 2) {
		uint64_t next = lod_way_next(way, at), further = lod_way_floor(way, at + at / LOD_HULL_GROWTH + 1);
		next = further > next ? further : next;
		uint64_t level = lod_way_level_above(way, at);
		if (at < stage && next > stage) /* the curve often bends where a stage or a level ends */
			next = stage;
		next = next < level ? next : level;
		at = next < to ? next : to;
		points[count++] = lod_hull_point_at(way, at, size, ECO_NONE);
	}
	if (at < to)
		points[count++] = lod_hull_point_at(way, to, size, ECO_NONE);
	return count;
}

void lod_hull_complete(struct lod_hull *hull, uint64_t to)
{
	const struct lod_hull_point *last = &hull->points[hull->count - 1];
	if (last->vertices < to) {
		struct lod_hull_point *end = &hull->points[hull->count++];
		*end = *last;
		end->vertices = to;
		end->alike_slope = end->open_slope = 0;
	}
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
