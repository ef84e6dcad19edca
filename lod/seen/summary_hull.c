/* Errors of summaries, and their splats on the screen: see lod/seen/summary_hull.h. */
#include "lod/seen/summary_hull.h"

#include <math.h>
#include <stdlib.h>

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

/* ---- Splats on the screen ---- */

/* Box filters by sums of rows and columns (lod/seen/visibility.h). */

#define SIZES 16                 /* from a cell on */
#define SIZES_PER_OCTAVE 2

static size_t cells_of(const struct lod_splat_field *field) { return (size_t)field->columns * field->rows; }

/* Side of a size's splats, over that of a cell. */
static double width_of(int size)
{
	return ldexp(size % SIZES_PER_OCTAVE ? 1.41421356237309504880 : 1, size / SIZES_PER_OCTAVE);
}

float *lod_splat_field_of(struct lod_splat_field *field, double side)
{
	double cells = side / field->cell_x;
	int size = (int)(fmax(0, 2 * lod_octaves(cells)) * SIZES_PER_OCTAVE + 0.5);
	size = size < SIZES ? size : SIZES - 1;
	if (!field->sizes) {
		uint32_t most = field->columns > field->rows ? field->columns : field->rows;
		field->sums = malloc(3 * (most + 1) * sizeof *field->sums);
		field->sizes = field->sums ? calloc(SIZES * cells_of(field), sizeof *field->sizes) : NULL;
		if (!field->sizes)
			return NULL;
	}
	field->used |= 1u << size;
	return field->sizes + (size_t)size * cells_of(field);
}

/* Each becomes the mean of what is within half of `width` around its middle: between sums up to there, which lie
 * as far between two whole cells for all. */
static void blur_line(double *sums, float *line, uint32_t count, uint32_t step, double width)
{
	double reach = fmin(0.5 + 0.5 * width, count), each = 1 / width;
	uint32_t whole = (uint32_t)reach;
	double part = reach - whole, sum = 0;
	for (uint32_t i = 0; i <= whole; i++)
		sums[i] = 0;
	for (uint32_t i = 0; i < count; i++)
		sums[whole + i + 1] = sum += (double)line[i * step];
	for (uint32_t i = 0; i <= whole; i++)
		sums[whole + count + 1 + i] = sum;
	for (uint32_t i = 0; sum > 0 && i < count; i++) {
		const double *low = sums + i, *high = low + 2 * (size_t)whole;
		line[i * step] = (float)(each * (high[0] + part * (high[1] - high[0])
			- low[1] + part * (low[1] - low[0])));
	}
}

static void blur_size(struct lod_splat_field *field, int size)
{
	float *cells = field->sizes + (size_t)size * cells_of(field);
	double width = width_of(size), height = width * field->cell_x / field->cell_y;
	for (uint32_t r = 0; r < field->rows; r++)
		blur_line(field->sums, cells + (size_t)r * field->columns, field->columns, 1, width);
	for (uint32_t c = 0; c < field->columns; c++)
		blur_line(field->sums, cells + c, field->rows, field->columns, height);
	for (size_t i = 0; i < cells_of(field); i++)
		field->sizes[i] += cells[i];
}

const float *lod_splat_field_blur(struct lod_splat_field *field)
{
	for (int size = 1; size < SIZES; size++)
		if (field->used >> size & 1)
			blur_size(field, size);
	return field->used ? field->sizes : NULL;
}

void lod_splat_field_free(struct lod_splat_field *field)
{
	free(field->sizes);
	free(field->sums);
	*field = (struct lod_splat_field){ 0 };
}
