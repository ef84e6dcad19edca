/* See lod/plan/expected.h. */
#include "lod/plan/expected.h"

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
