/* Search for the price of bytes: see lod/plan/byte_price.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/plan/byte_price.h"

#define LN_2 0.69314718055994530942

/* 2^octave, the same on every machine. */
static double price_of(double octave)
{
	return octave < 0 ? lod_exp_minus(-LN_2 * octave) : 1 / lod_exp_minus(LN_2 * octave);
}

double lod_price_relax(struct lod_allocation *m, double lambda, double octave, const struct lod_mix *mix)
{
	m->price = price_of(octave);
	m->limited = false;
	lod_allocation_relax(m, lambda);         /* levels of impostors are those of the price, too */
	if (mix && mix->used) {
		lod_kinds_set(m, mix);
		m->limited = true;
		m->relaxed.lambda = NAN;
		lod_allocation_relax(m, lambda);
		lod_prices_levels(m);
		m->relaxed.lambda = NAN;
	}
	m->p->image_price = m->price;
	return lod_prices_bytes(m) + lod_image_bytes(&m->p->image, m->p->scene, m->p->input->holdings, m->price);
}

double lod_price_wrong(const struct lod_allocation *m)
{
	return m->cost.alike + m->cost.open + lod_prices_lost(m);
}

/* Did a lower price need fewer bytes? Limits are no optimum, so bytes may rise with the price. */
static bool is_risen(const struct lod_price_tries *tries, uint32_t i)
{
	for (uint32_t k = 0; k < tries->count; k++)
		if (tries->at[k].lambda == tries->at[i].lambda && tries->at[k].octave < tries->at[i].octave
				&& tries->at[k].bytes < tries->at[i].bytes)
			return true;
	return false;
}

/* A price for all bytes alike, which is remembered. */
static double relax_alike(struct lod_allocation *m, double lambda, double octave)
{
	const double bytes = lod_price_relax(m, lambda, octave, NULL);
	struct lod_price_tries *tries = &m->tries;
	if (tries->count < LOD_PRICE_TRIES) {
		tries->at[tries->count].lambda = lambda;
		tries->at[tries->count].octave = octave;
		tries->at[tries->count++].bytes = bytes;
	}
	return bytes;
}

/* Halves between an octave `low`, at which there are too many bytes, and `high`, at which there are at most `target`,
 * until they are nearly that many or the octaves are close together. */
static double search_price(struct lod_allocation *m, double lambda, double target, double low, double high)
{
	double bytes = 0;
	for (int tries = 0; high - low > LOD_PRICE_STEP && bytes < target * (1 - LOD_PRICE_SLACK)
			&& (tries < LOD_PRICE_SEARCHES || !lod_planner_over(m->p, 4)); tries++) {
		double middle = 0.5 * (low + high), now = relax_alike(m, lambda, middle);
		*(now > target ? &low : &high) = middle;
		bytes = now > target ? bytes : now;
	}
	return high;
}

/* Two such prices, by trying, from one that nearly fits. *high <= *low: everything fits at *low, the lowest. */
static void seek(struct lod_allocation *m, double lambda, double target, double near, double *low,
	double *high)
{
	double step = isnan(near) ? 1 : LOD_PRICE_NEAR;
	*low = *high = isnan(near) ? LOD_PRICE_USUAL : near;
	double bytes = relax_alike(m, lambda, *low);
	while (bytes <= target && *low > LOD_PRICE_LOWEST) {
		*high = *low;
		*low -= step;
		*low = *low < LOD_PRICE_LOW ? LOD_PRICE_LOWEST : *low;
		step *= 2;
		bytes = relax_alike(m, lambda, *low);
	}
	if (bytes <= target)
		*high = *low;
	while (bytes > target && *high <= *low && *high < LOD_PRICE_HIGHEST) {
		*high = fmin(LOD_PRICE_HIGHEST, *high + step);
		step *= 2;
		if (*high < LOD_PRICE_HIGHEST && relax_alike(m, lambda, *high) > target)
			*low = *high;
	}
}

/* The highest price tried at which there are too many bytes, without those where they have risen if only `falls` count,
 * and the next one tried above it. False where one of both is not known. */
static bool recall(const struct lod_allocation *m, double lambda, double target, bool falls, double *low, double *high)
{
	const struct lod_price_tries *tries = &m->tries;
	*low = -INFINITY;
	*high = INFINITY;
	for (uint32_t i = 0; i < tries->count; i++)
		if (tries->at[i].lambda == lambda && tries->at[i].bytes > target && !(falls && is_risen(tries, i)))
			*low = fmax(*low, tries->at[i].octave);
	for (uint32_t i = 0; i < tries->count; i++)
		if (tries->at[i].lambda == lambda && tries->at[i].octave > *low)
			*high = fmin(*high, tries->at[i].octave);
	return *low > -INFINITY && *high < INFINITY;
}

/* A lower price may fit, too, where bytes have risen with the price. */
double lod_price_find(struct lod_allocation *m, double lambda, double target, double near, double *octave)
{
	const struct lod_price_tries *tries = &m->tries;
	double low, high;
	if (!recall(m, lambda, target, false, &low, &high))
		seek(m, lambda, target, near, &low, &high);
	*octave = high > low ? search_price(m, lambda, target, low, high) : low;
	if (recall(m, lambda, target, true, &low, &high) && high < *octave)
		search_price(m, lambda, target, low, high);
	for (uint32_t i = 0; i < tries->count; i++)
		if (tries->at[i].lambda == lambda && tries->at[i].bytes <= target)
			*octave = fmin(*octave, tries->at[i].octave);
	return lod_price_relax(m, lambda, *octave, NULL);
}
