/* See lod/plan/price_curve.h. */
#include "lod/plan/price_curve.h"

#include <math.h>

#include "lod/plan/expected.h"
#include "lod/plan/price_search.h"

#define GRID_HIGHEST 12.0        /* octaves: nothing is worth so much a byte; the next is 1 lower */
#define MIDDLE 0.25              /* of the highest lambda */
#define GRID_COUNT 24            /* below the last everything is worth its bytes */

struct evaluation {
	int at;
	double bytes, vertices, wrong, lowest;   /* lowest: vertices at the lowest lambda */
	struct eco_prediction prediction;
};

static double octave_at(int at)
{
	return at < GRID_COUNT ? GRID_HIGHEST - at : LOD_PRICE_LOWEST;
}

static double within(double value, double least, double most)
{
	return value < least ? least : value > most ? most : value;
}

/* It is remembered for the search of the price. */
static enum eco_code relax_at(struct lod_allocation *m, double lambda, double octave,
	struct evaluation *result, struct eco_error *error)
{
	result->bytes = lod_price_relax_alike(m, lambda, octave);
	result->vertices = m->cost.vertices;
	result->wrong = lod_price_wrong(m);
	return lod_allocation_predict(m, &result->prediction, error);
}

static double part_of(double value, double from, double to)
{
	return to > from ? within((value - from) / (to - from), 0, 1) : 1;
}

/* If vertices bind too, the result mixes two lambdas, in the parts that use them up: the highest and one below
 * it, or that one and the lowest. */
static enum eco_code evaluate(struct lod_allocation *m, const struct lod_price_bounds *bounds, int at,
	struct evaluation *result, struct eco_error *error)
{
	double octave = octave_at(at);
	enum eco_code code = relax_at(m, bounds->low, octave, result, error);
	result->at = at;
	result->lowest = result->vertices;
	if (code || result->vertices <= bounds->vertices || !(bounds->high > bounds->low))
		return code;
	struct evaluation over = *result, under;
	code = relax_at(m, fmax(bounds->low, MIDDLE * bounds->high), octave, &under, error);
	if (!code && under.vertices > bounds->vertices) {
		over = under;
		code = relax_at(m, bounds->high, octave, &under, error);
	}
	double part = part_of(bounds->vertices, under.vertices, over.vertices);
	result->bytes = under.bytes + part * (over.bytes - under.bytes);
	result->wrong = under.wrong + part * (over.wrong - under.wrong);
	result->prediction = lod_expected_between(&under.prediction, &over.prediction, part);
	return code;
}

/* A result is between those of a higher price and of a lower one. */
static void clamp(struct evaluation *result, const struct evaluation *before, const struct evaluation *after)
{
	result->bytes = within(result->bytes, before->bytes, after->bytes);
	result->wrong = within(result->wrong, after->wrong, before->wrong);
	lod_expected_clamp(&result->prediction, &before->prediction, &after->prediction);
}

enum eco_code lod_price_curve(struct lod_allocation *m, const struct lod_price_bounds *bounds, double bytes,
	struct lod_price_point *point, struct eco_error *error)
{
	struct evaluation here, next, middle;
	enum eco_code code = evaluate(m, bounds, GRID_COUNT, &next, error);
	if (!code)
		code = evaluate(m, bounds, 0, &here, error);
	clamp(&here, &(struct evaluation){ .wrong = INFINITY, .prediction = LOD_EXPECTED_WORST }, &next);
	if (next.bytes <= bytes)
		here = next;
	while (!code && next.at - here.at > 1) {
		code = evaluate(m, bounds, (here.at + next.at) / 2, &middle, error);
		clamp(&middle, &here, &next);
		*(middle.bytes <= bytes ? &here : &next) = middle;
	}
	point->octave = octave_at(here.at);
	point->lowest = here.lowest;
	point->prediction = lod_expected_between(&here.prediction, &next.prediction,
		part_of(bytes, here.bytes, next.bytes));
	return code;
}
