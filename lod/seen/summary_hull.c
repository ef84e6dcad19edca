/* Errors of summaries: see lod/seen/summary_hull.h. */
#include "lod/seen/summary_hull.h"

#include <math.h>

#include "lod/seen/visibility.h"

/* ---- Errors of a summary ---- */

/* The expected error of the first points of a summary: computed, not measured. Splats hit what they stand for by
 * chance, independently of each other. */

/* Share of an area that n random splats hit, each covering `each` of it; for n < 1 the mean. */
static double hit_share(double each, double area, double n)
{
	double part = each < area ? each / area : 1;
	return n < 1 ? n * part : part >= 1 ? 1 : 1 - lod_exp_minus(-n * lod_log(1 - part));
}

/* Share of a length a inside a length l that holds its middle. */
static double inside_length(double a, double l)
{
	return a < 2 * l ? 1 - a / (4 * l) : l / a;
}

/* Share of a square of side a inside a box that holds its centre. */
static double inside_box(double a, double wide, double high)
{
	return inside_length(a, wide) * inside_length(a, high);
}

/* Share of the tile's part of the picture that splats cover. A distant tile is wide and low there: most of a
 * large splat lies above and below it. */
static double filled(const struct lod_summary_view *view, double splat, double n)
{
	double region = view->wide * view->high;
	return region > 0 ? hit_share(splat * inside_box(sqrt(splat), view->wide, view->high), region,
		LOD_SUMMARY_FILLING * n) : 0;
}

/* Pixels around the tile that the first n points cover, over weight_px. Plants and ground that hide the tile need
 * not hide these splats: those of a tile behind a hill stand out above it. 0 if wide and high are unknown. */
static double summary_outside(const struct lod_summary_view *view, double n)
{
	double region = view->wide * view->high, splat = view->area / n, side = sqrt(splat);
	double ring = (view->wide + side) * (view->high + side) - region;
	return region > 0 ? ring * hit_share(splat * (1 - inside_box(side, view->wide, view->high)), ring,
		n) / view->weight_px : 0;
}

/* Share of the tile's part of the picture that its plants cover. A splat there makes no false
 * positive: each plant that it covers beside its own counts it as the wrong plant. */
static double summary_crowded(const struct lod_summary_view *view)
{
	double region = view->wide * view->high;
	return region > 0 ? 1 - lod_exp_minus(view->covered / region) : 0;
}

/* A splat's centre is on a plant, and each plant has its share of the splats. The part of a splat inside the
 * plant's crown covers the plant and its gaps alike; the rest lies around the crown and hides others. */
static struct eco_curve summary_curve(const struct lod_summary_view *view, double n)
{
	double box = view->box / view->plants > 1e-12 ? view->box / view->plants : 1e-12,
		covered = view->covered / view->plants;
	covered = covered < box ? covered > 1e-3 * box ? covered : 1e-3 * box : box;
	double splat = view->area / n, side = sqrt(splat), width = sqrt(box), each = n / view->plants;
	double inside = inside_box(side, width, width), ring = (width + side) * (width + side) - box;
	double hit = hit_share(splat * inside, box, each) * inside;
	double fp = ((box - covered) * hit + ring * hit_share(splat * (1 - inside), ring, each))
		* (1 - view->crowded);
	/* splats of other plants may hit what its own miss */
	double missed = (1 - hit) * (1 - filled(view, splat, n));
	return (struct eco_curve){ .share = (float)(n / view->points), .scale = 1,
		.fp = (float)(fp / covered), .fn = (float)missed };
}

/* ---- The hull ---- */

/* With splats of `scale` times the area that all leaves have. */
static struct lod_hull_point at_scale(const struct lod_summary_hull *summary, uint64_t vertices, double scale)
{
	struct lod_summary_view view = summary->view;
	struct lod_hull_point sample = { .vertices = vertices };
	double n = summary->part * (double)vertices;
	view.area *= scale;
	struct eco_curve curve = summary_curve(&view, n);
	sample.open = summary->pixels * curve.fp + summary_outside(&view, n);
	sample.alike = summary->pixels * LOD_OWNER_WEIGHT * (1 - curve.fn) + curve.fn;
	return sample;
}

/* Leaves hide each other, the more the denser plants stand: splats with all their area would stand out of a
 * closed forest. */
static double best_scale(const struct lod_summary_hull *summary, uint64_t vertices,
	struct lod_hull_point *best)
{
	double least = INFINITY, scale = 1;
	for (double s = 1; s >= LOD_SUMMARY_SCALE_LEAST; s /= 2) {
		struct lod_hull_point sample = at_scale(summary, vertices, s);
		double error = lod_hull_error(&summary->hull, &sample);
		if (s < 1 && !(error < least))
			break;
		least = error;
		scale = s;
		*best = sample;
	}
	return scale;
}

double lod_summary_hull_scale(const struct lod_summary_hull *summary, uint64_t vertices)
{
	struct lod_hull_point best;
	return vertices ? best_scale(summary, vertices, &best) : 1;
}

void lod_summary_hull_make(struct lod_summary_hull *summary, const struct lod_summary_view *view, double part,
	double pixels, double open, struct lod_hull_point *room)
{
	struct lod_hull *hull = &summary->hull;
	*summary = (struct lod_summary_hull){ .view = *view, .part = part, .pixels = pixels,
		.hull = { .points = room, .count = 1, .open = open, .impostor = ECO_NONE } };
	summary->view.crowded = summary_crowded(view);
	room[0] = (struct lod_hull_point){ .alike = 1 };
	for (uint32_t i = lod_summary_hull_count((uint32_t)view->points) - 1; i-- > 0;)
		best_scale(summary, (uint64_t)view->points >> LOD_SUMMARY_OCTAVES * i, &room[hull->count++]);
	lod_hull_reduce(hull, 1);
}
