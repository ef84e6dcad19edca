/* Splats hit what they stand for by chance, independently of each other: see lod/plan/summary_curve.h. */
#include "lod/plan/summary_curve.h"

#include <math.h>

#include "lod/plan/visibility.h"

#define FILLING 0.5              /* splats lie where plants do: they fill gaps like half as many at random */

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
		FILLING * n) : 0;
}

double lod_summary_outside(const struct lod_summary_view *view, double n)
{
	double region = view->wide * view->high, splat = view->area / n, side = sqrt(splat);
	double ring = (view->wide + side) * (view->high + side) - region;
	return region > 0 ? ring * hit_share(splat * (1 - inside_box(side, view->wide, view->high)), ring,
		n) / view->weight_px : 0;
}

/* Share of the tile's part of the picture that its plants cover. What a splat covers there is no false
 * positive: of the plants that it covers beside its own each counts it as covered by the wrong plant. */
double lod_summary_crowded(const struct lod_summary_view *view)
{
	double region = view->wide * view->high;
	return region > 0 ? 1 - lod_exp_minus(view->covered / region) : 0;
}

/* A splat's centre is on a plant, and each plant has its share of the splats. The part of a splat inside the
 * plant's crown covers the plant and its gaps alike; the rest lies around the crown and hides others. */
struct eco_curve lod_summary_curve(const struct lod_summary_view *view, double n)
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
