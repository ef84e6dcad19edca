/* The picture that a number of bytes shows, and predictions in order of Q: see lod/plan/price_search.h. */

#include <math.h>

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

/* ---- Predictions in order ---- */

#define HALVINGS 24              /* of the way between two predictions: less than a sixteenth of a pixel */

bool lod_expected_worse(const struct eco_prediction *a, const struct eco_prediction *b)
{
	return eco_predicted_q(a) < eco_predicted_q(b);
}

static struct eco_prediction on_the_way(const struct eco_prediction *a, const struct eco_prediction *b,
	double part)
{
	return (struct eco_prediction){ a->tp + part * (b->tp - a->tp), a->fp + part * (b->fp - a->fp),
		a->fn + part * (b->fn - a->fn) };
}

/* Q itself need not rise all the way: what is there at first may lie beside what should be. */
struct eco_prediction lod_expected_between(const struct eco_prediction *worse,
	const struct eco_prediction *better, double part)
{
	double from = eco_predicted_q(worse), q = from + part * (eco_predicted_q(better) - from), low = 0,
		high = 1;
	if (part <= 0 || part >= 1)
		return part <= 0 ? *worse : *better;
	for (int i = 0; i < HALVINGS; i++) {
		double middle = 0.5 * (low + high);
		struct eco_prediction there = on_the_way(worse, better, middle);
		*(eco_predicted_q(&there) < q ? &low : &high) = middle;
	}
	return on_the_way(worse, better, high);
}

void lod_expected_clamp(struct eco_prediction *prediction, const struct eco_prediction *worse,
	const struct eco_prediction *better)
{
	if (lod_expected_worse(prediction, worse))
		*prediction = *worse;
	if (lod_expected_worse(better, prediction))
		*prediction = *better;
}
