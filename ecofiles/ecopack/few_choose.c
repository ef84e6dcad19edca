/* k-medoids, see few.h. */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/ecopack/few.h"

#define SWAPS_MAX 1000u
#define GAIN_LEAST 1e-9              /* of the whole sum: rounding is no gain */

struct choice {
	const double *difference, *weight;
	uint32_t count, kept_count;
	uint32_t *kept;              /* medoids */
	bool *is_kept;
	uint32_t *nearest;           /* per model: index in `kept` */
	double *first, *second;      /* per model: differences from the nearest medoid and the next */
	double *loss;                /* per medoid */
};

static double between(const struct choice *c, uint32_t i, uint32_t k)
{
	return c->difference[(size_t)i * c->count + k];
}

/* Finds each model's nearest medoids. Returns the sum of weighted differences. */
static double assign(struct choice *c)
{
	double sum = 0;
	for (uint32_t i = 0; i < c->count; i++) {
		c->first[i] = c->second[i] = INFINITY;
		c->nearest[i] = ECO_NONE;
		for (uint32_t k = 0; k < c->kept_count; k++) {
			double d = between(c, i, c->kept[k]);
			if (d < c->first[i] || c->kept[k] == i) {
				c->second[i] = fmin(c->first[i], c->second[i]);
				c->first[i] = d;
				c->nearest[i] = k;
			} else {
				c->second[i] = fmin(c->second[i], d);
			}
		}
		sum += c->weight[i] * fmin(c->first[i], 2);
	}
	return sum;
}

static void add(struct choice *c, uint32_t model)
{
	c->kept[c->kept_count++] = model;
	c->is_kept[model] = true;
}

/* BUILD: adds the model that lessens the sum most, until `keep` are kept or none lessens it. */
static void build(struct choice *c, uint32_t keep)
{
	double sum = assign(c);
	while (c->kept_count < keep) {
		double most = 0;
		uint32_t best = ECO_NONE;
		for (uint32_t h = 0; h < c->count; h++) {
			double gain = 0;
			for (uint32_t i = 0; i < c->count && !c->is_kept[h]; i++)
				gain += c->weight[i] * fmax(0, fmin(c->first[i], 2) - between(c, i, h));
			if (gain > most) {
				most = gain;
				best = h;
			}
		}
		if (best == ECO_NONE || !(most > GAIN_LEAST * sum))
			return;
		add(c, best);
		assign(c);
	}
}

/* The medoid whose place model h takes best, and in *change what the sum changes by. Each model that leaves a
 * medoid goes to h or to its second nearest, so that one pass over the models serves all medoids (Schubert
 * and Rousseeuw 2019). */
static uint32_t best_place(struct choice *c, uint32_t h, double *change)
{
	double all = 0;
	uint32_t best = 0;
	memset(c->loss, 0, c->kept_count * sizeof *c->loss);
	for (uint32_t i = 0; i < c->count; i++) {
		double d = between(c, i, h), stays = fmin(c->first[i], d);
		all += c->weight[i] * (stays - c->first[i]);
		c->loss[c->nearest[i]] += c->weight[i] * (fmin(fmin(c->second[i], d), 2) - stays);
	}
	for (uint32_t k = 1; k < c->kept_count; k++)
		best = c->loss[k] < c->loss[best] ? k : best;
	*change = all + c->loss[best];
	return best;
}

/* SWAP: the best exchange of a medoid for another model, as long as one lessens the sum. */
static void swap(struct choice *c)
{
	double sum = assign(c);
	for (uint32_t n = 0; n < SWAPS_MAX && c->kept_count > 0; n++) {
		double least = -GAIN_LEAST * sum;
		uint32_t best = ECO_NONE, place = 0;
		for (uint32_t h = 0; h < c->count; h++) {
			double change = 0;
			uint32_t k = c->is_kept[h] ? 0 : best_place(c, h, &change);
			if (change < least) {
				least = change;
				best = h;
				place = k;
			}
		}
		if (best == ECO_NONE)
			return;
		c->is_kept[c->kept[place]] = false;
		c->is_kept[best] = true;
		c->kept[place] = best;
		sum = assign(c);
	}
}

enum eco_code few_choose(const double *difference, const double *weight, uint32_t count, uint32_t keep,
	uint32_t *stand_in, struct eco_error *error)
{
	size_t n = (size_t)count + 1;
	struct choice c = { difference, weight, count, 0, malloc(n * sizeof *c.kept),
		calloc(n, sizeof *c.is_kept), malloc(n * sizeof *c.nearest), malloc(n * sizeof *c.first),
		malloc(n * sizeof *c.second), malloc(n * sizeof *c.loss) };
	enum eco_code code = ECO_OK;
	if (c.kept && c.is_kept && c.nearest && c.first && c.second && c.loss) {
		build(&c, keep < count ? keep : count);
		if (c.kept_count == 0 && count)      /* nothing weighs anything */
			add(&c, 0);
		swap(&c);
		for (uint32_t i = 0; i < count; i++)
			stand_in[i] = c.kept[c.nearest[i]];
	} else {
		code = eco_fail(error, ECO_NO_MEMORY, "no memory to choose among %u models", count);
	}
	free(c.kept);
	free(c.is_kept);
	free(c.nearest);
	free(c.first);
	free(c.second);
	free(c.loss);
	return code;
}
