/* Convex hulls of ladders' errors: see lod/plan/hull.h. */
#include "lod/plan/hull.h"

#include <math.h>

#define GROWTH 4u                /* amounts that are looked at grow by a quarter: curves are smooth */

/* The step from one amount to the next. */
static void set_prices(const struct lod_amount *from, struct lod_amount *to)
{
	double vertices = (double)(to->vertices - from->vertices);
	to->fn_price = (from->fn - to->fn) / vertices;
	to->fp_price = (from->fp - to->fp) / vertices;
}

void lod_steps_hull(struct lod_steps *steps, double spread)
{
	struct lod_amount *a = steps->amounts;
	uint32_t kept = 1;
	a[0].fn_price = INFINITY;
	a[0].fp_price = 0;
	for (uint32_t i = 1; i < steps->count; i++) {
		a[kept] = a[i];
		a[kept].fn = fmin(a[kept].fn, a[kept - 1].fn);       /* noise */
		a[kept].above_fn = fminf(a[kept].above_fn, a[kept - 1].above_fn);
		for (;; kept--, a[kept] = a[kept + 1]) {
			set_prices(&a[kept - 1], &a[kept]);
			if (kept == 1 || spread * lod_steps_price(steps, kept) < lod_steps_price(steps, kept - 1))
				break;
		}
		kept += lod_steps_price(steps, kept) > 0;
	}
	steps->count = kept;
}

/* A whole-plant list without cells: all of it drawn is a share of the plant, and no more, though the curve goes on. */
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

/* The same list beside cells: once all of it is in full detail it is that for all that cells may add, but not without error before they do. */
static double share_beside(const struct lod_way *way, uint64_t vertices)
{
	return lod_way_share(way, vertices < way->full ? vertices : lod_way_floor(way, way->full - 1));
}

double lod_steps_absent(const struct eco_ladder *ladder)
{
	return ladder->organ != ECO_ORGAN_WOOD && !ladder->before && ladder->curve_count ? LOD_ABSENT_WORTH : 0;
}

struct lod_amount lod_steps_amount(const struct lod_way *way, uint64_t vertices)
{
	const struct eco_scene *scene = way->scene;
	const struct eco_ladder *ladder = way->ladder;
	const struct eco_plant *plant = &scene->plants[ladder->plant];
	bool coarse = plant->anchor_count > 1 && ladder->anchor == plant->anchor_first && !(ladder->flags & ECO_LADDER_FAR);
	bool alone = ladder->anchor == plant->anchor_first && vertices == lod_way_stage_end(way);
	double share = alone ? share_alone(way, vertices) : coarse && way->full ? share_beside(way, vertices) : lod_way_share(way, vertices);
	if (ladder->curve_count == 0)        /* not measured */
		return (struct lod_amount){ .vertices = vertices, .fn = 1 - share, .above_fn = (float)(1 - share) };
	struct eco_curve curve = lod_ladder_curve(scene, ladder, share), above = lod_ladder_curve_seen(scene, ladder, share, 1);
	double absent = vertices == 0 ? lod_steps_absent(ladder) : 0;
	return (struct lod_amount){ .vertices = vertices, .fp = curve.fp, .fn = curve.fn + absent, .above_fp = above.fp,
		.above_fn = (float)(above.fn + absent) };
}

uint32_t lod_steps_sample(struct lod_amount amounts[LOD_STEPS_MAX], const struct lod_way *way, uint64_t from, uint64_t to)
{
	uint64_t stage = lod_way_stage_end(way), at = from;
	uint32_t count = 1;
	amounts[0] = lod_steps_amount(way, from);
	while (at < to && count < LOD_STEPS_MAX - 2) {
		uint64_t next = lod_way_next(way, at), further = lod_way_floor(way, at + at / GROWTH + 1);
		next = further > next ? further : next;
		if (at < stage && next > stage)      /* where a stage ends there is often a bend */
			next = stage;
		at = next < to ? next : to;
		amounts[count++] = lod_steps_amount(way, at);
	}
	if (at < to)
		amounts[count++] = lod_steps_amount(way, to);
	return count;
}

void lod_steps_complete(struct lod_steps *steps, uint64_t to)
{
	const struct lod_amount *last = &steps->amounts[steps->count - 1];
	if (last->vertices < to)
		steps->amounts[steps->count++] = (struct lod_amount){ .vertices = to, .fp = last->fp, .fn = last->fn,
			.above_fp = last->above_fp, .above_fn = last->above_fn };
}

double lod_steps_position(const struct lod_steps *steps, double price, double near)
{
	double taken = price * LOD_STEPS_BLUR;
	/* the last step that all plants have taken */
	uint32_t low = (uint32_t)near;
	while (low + 1 < steps->count && lod_steps_price(steps, low + 1) >= taken)
		low++;
	while (low > 0 && lod_steps_price(steps, low) < taken)
		low--;
	/* steps close to each other overlap: their shares add up */
	double position = low;
	for (uint32_t i = low + 1; i < steps->count && lod_steps_price(steps, i) * LOD_STEPS_BLUR > price; i++)
		position += (lod_steps_price(steps, i) * LOD_STEPS_BLUR / price - 1) / (LOD_STEPS_BLUR * LOD_STEPS_BLUR - 1);
	return position;
}
