/* See lod/plan/price_search.h. */
#include "lod/plan/price_search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/plan/byte_price.h"

#define PRICE_NEAR 0.25          /* the same from a price that nearly fits */
#define PRICE_USUAL -1.0
#define PRICE_LITTLE -12.0       /* octaves: at lower prices hardly anything is left out */
#define PRICE_STEP_FIRST 2.0     /* octaves to the next price tried, then twice as far */
#define LOW_OCTAVES 10           /* no bytes are so far below any */
#define PRICE_STEP 0.1           /* octaves to which a price is searched */
#define PRICE_CLOSE 0.45         /* octaves: nearer than that bytes come at once, and are no line */
#define PRICE_TRIES 5            /* of a search, whatever work is done: the highest price draws nothing */

#define LN_2 0.69314718055994530942

/* 2^octave, the same on every machine. */
static double price_of(double octave)
{
	return octave < 0 ? lod_exp_minus(-LN_2 * octave) : 1 / lod_exp_minus(LN_2 * octave);
}

double lod_price_relax(struct lod_allocation *m, double lambda, const struct lod_price *at)
{
	double lists = price_of(at->lists), tiles = price_of(at->tiles);
	m->price = lists;
	m->limited = false;
	if (tiles == lists || (!lod_allocation_is_relaxed(m, lambda, tiles, lists)
			&& !lod_prices_restore(m, lambda)))
		lod_allocation_relax(m, lambda);
	if (tiles != lists) {
		m->price = tiles;
		m->limited = true;
		lod_allocation_relax(m, lambda);
		lod_prices_levels(m);
	}
	if (m->spares)
		return lod_prices_bytes(m);
	m->p->image_price = lists;
	return lod_prices_bytes(m) + lod_image_bytes(&m->p->image, m->p->scene, m->p->input->holdings, lists);
}

double lod_price_wrong(const struct lod_allocation *m)
{
	return m->cost.alike + m->cost.open + lod_prices_lost(m);
}

static void remember(struct lod_allocation *m, double lambda, double octave, double bytes)
{
	struct lod_price_tries *tries = &m->tries;
	if (memchr(lod_prices_kept(m), true, m->p->scene->plant_count) || tries->count == LOD_PRICE_TRIES)
		return;
	tries->at[tries->count].lambda = lambda;
	tries->at[tries->count].octave = octave;
	tries->at[tries->count++].bytes = bytes;
}

double lod_price_relax_alike(struct lod_allocation *m, double lambda, double octave)
{
	double bytes = lod_price_relax(m, lambda, &(struct lod_price){ octave, octave });
	remember(m, lambda, octave, bytes);
	return bytes;
}

/* How far bytes are from a target, in octaves. */
static double beyond(double bytes, double target)
{
	return bytes > 0 && target > 0 ? fabs(lod_octaves(bytes / target)) : LOW_OCTAVES;
}

/* The same at a price for all bytes alike; 1 where that was not tried. */
static double beyond_at(const struct lod_allocation *m, double lambda, double target, double octave)
{
	for (uint32_t i = 0; i < m->tries.count; i++)
		if (m->tries.at[i].lambda == lambda && m->tries.at[i].octave == octave)
			return beyond(m->tries.at[i].bytes, target);
	return 1;
}

/* How closely a price is searched: octaves; share of the bytes that may be left. */
struct closely { double octaves, slack; };
static const struct closely roughly = { 0.5, 0.1 }, exactly = { PRICE_STEP, LOD_PRICE_SLACK };

/* Prices between an octave `low`, at which there are too many bytes, and `high`, at which there are at most
 * `target`: a secant on bytes, or their middle where that moves one end alone, until they are nearly that
 * many or the octaves are close together. `lists` NAN: the same for what plants share. */
static struct lod_price search_price(struct lod_allocation *m, double lambda, double target, double lists,
	const struct closely *closely, double *low, double high)
{
	bool alike = isnan(lists);
	double over = alike ? beyond_at(m, lambda, target, *low) : 1,
		under = alike ? beyond_at(m, lambda, target, high) : 1, bytes = 0;
	int side = 0;                    /* tries that moved the same end */
	for (int tries = 0; high - *low > closely->octaves && bytes < target * (1 - closely->slack)
			&& (tries < PRICE_TRIES || !lod_planner_over(m->p, 4)); tries++) {
		double part = over / (over + under),
			from = *low < PRICE_LITTLE && high > PRICE_LITTLE + 1 ? PRICE_LITTLE : *low;
		bool halves = high - *low < PRICE_CLOSE || abs(side) > 1;
		part = halves ? 0.5 : part < 0.1 ? 0.1 : part > 0.9 ? 0.9 : part;
		double middle = from + part * (high - from);
		double now = alike ? lod_price_relax_alike(m, lambda, middle)
			: lod_price_relax(m, lambda, &(struct lod_price){ lists, middle });
		if (now > target) {
			*low = middle;
			over = beyond(now, target);
			side = side < 0 ? side - 1 : -1;
		} else {
			high = middle;
			bytes = now;
			under = beyond(now, target);
			side = side > 0 ? side + 1 : 1;
		}
	}
	return (struct lod_price){ alike ? high : lists, high };
}

/* Two such prices, by trying, from one that nearly fits. *high <= *low: everything fits at *low, the lowest.
 */
static void seek(struct lod_allocation *m, double lambda, double target, double near, double *low,
	double *high)
{
	double step = isnan(near) ? PRICE_STEP_FIRST : PRICE_NEAR;
	*low = *high = isnan(near) ? PRICE_USUAL : near;
	double bytes = lod_price_relax_alike(m, lambda, *low);
	while (bytes <= target && *low > LOD_PRICE_LOWEST) {
		*high = *low;
		*low -= step;
		*low = *low < PRICE_LITTLE ? LOD_PRICE_LOWEST : *low;
		step *= 2;
		bytes = lod_price_relax_alike(m, lambda, *low);
	}
	if (bytes <= target)
		*high = *low;
	while (bytes > target && *high <= *low && *high < LOD_PRICE_HIGHEST) {
		*high = fmin(LOD_PRICE_HIGHEST, *high + step);
		step *= 2;
		if (*high < LOD_PRICE_HIGHEST && lod_price_relax_alike(m, lambda, *high) > target)
			*low = *high;
	}
}

static bool is_better(struct lod_allocation *m, double lambda, double target, const struct lod_price *try,
	double wrong, struct lod_price *at, double *bytes)
{
	double now = lod_price_relax(m, lambda, try);
	if (now > target || lod_price_wrong(m) >= wrong
			|| m->cost.vertices > (double)m->p->input->request->vertices)
		return false;
	*at = *try;
	*bytes = now;
	return true;
}

/* Prices with a plant's organs kept. False, and all is as it was, where that leaves no less wrong. */
static bool keep(struct lod_allocation *m, double lambda, double target, uint32_t plant, double near,
	struct lod_price *at, double *over, double *bytes)
{
	double low, high;
	lod_price_relax(m, lambda, at);
	double wrong = lod_price_wrong(m);
	lod_prices_keep_organs(m, plant, true);
	seek(m, lambda, target, near, &low, &high);
	struct lod_price try = high > low ? search_price(m, lambda, target, NAN, &exactly, &low, high)
		: (struct lod_price){ low, low };
	if (is_better(m, lambda, target, &try, wrong, at, bytes)) {
		*over = low;
		return true;
	}
	lod_prices_keep_organs(m, plant, false);
	return false;
}

/* At the price `over` there are too many bytes, at `at`, little higher, many are left: there lists come that
 * many plants or all tiles draw. Either tiles pay less where these are not, or more where they are; or the
 * dearest organs that come there are kept, and all else pays more, first levels of textures. False where none
 * of it leaves less wrong, or the bytes are used. */
static bool fill_gap(struct lod_allocation *m, double lambda, double target, struct lod_price *at,
	double *over, double *bytes)
{
	double wrong = lod_price_wrong(m), lists = *over, low = LOD_PRICE_LOWEST;
	struct lod_price try = { at->lists, LOD_PRICE_LOWEST };
	bool better = false;
	double most = lod_price_relax(m, lambda, &try);
	if (most > target)
		try = search_price(m, lambda, target, at->lists, &exactly, &low, at->tiles);
	if (most > *bytes)
		better = is_better(m, lambda, target, &try, wrong, at, bytes);
	wrong = better ? lod_price_wrong(m) : wrong;
	try = (struct lod_price){ lists, lists };
	lod_price_relax(m, lambda, &try);
	if (lod_prices_lists(m) < target) {      /* else nothing that tiles and textures give is enough */
		low = lists;
		try = search_price(m, lambda, target, lists, &exactly, &low, LOD_PRICE_HIGHEST);
		better |= is_better(m, lambda, target, &try, wrong, at, bytes);
	}
	if (better && *bytes >= target * (1 - LOD_PRICE_SLACK))
		return false;
	lod_price_relax(m, lambda, at);
	lod_prices_note_off(m);
	lod_price_relax(m, lambda, &(struct lod_price){ lists, lists });
	uint32_t dearest = lod_prices_dearest(m);
	return dearest != ECO_NONE && keep(m, lambda, target, dearest, lists, at, over, bytes);
}

/* The highest price tried at which there are too many bytes, and the next one tried above it, at which there
 * are not. False where one of both is not known. */
static bool recall(const struct lod_allocation *m, double lambda, double target, double *low, double *high)
{
	const struct lod_price_tries *tries = &m->tries;
	*low = -INFINITY;
	*high = INFINITY;
	for (uint32_t i = 0; i < tries->count; i++)
		if (tries->at[i].lambda == lambda && tries->at[i].bytes > target)
			*low = fmax(*low, tries->at[i].octave);
	for (uint32_t i = 0; i < tries->count; i++)
		if (tries->at[i].lambda == lambda && tries->at[i].octave > *low)
			*high = fmin(*high, tries->at[i].octave);
	return *low > -INFINITY && *high < INFINITY;
}

double lod_price_find(struct lod_allocation *m, double lambda, double target,
	const struct lod_price_near *near, struct lod_price *at, double *over)
{
	const struct closely *closely = near->is_enough ? &roughly : &exactly;
	double low, high;
	lod_prices_set_kept(m, NULL);
	if (!recall(m, lambda, target, &low, &high))
		seek(m, lambda, target, near->octave, &low, &high);
	*at = high > low ? search_price(m, lambda, target, NAN, closely, &low, high)
		: (struct lod_price){ low, low };
	*over = low;
	return lod_price_relax(m, lambda, at);
}

double lod_price_fill(struct lod_allocation *m, double lambda, double target, struct lod_price *at,
	double over, int gaps)
{
	double bytes = lod_price_relax(m, lambda, at);
	for (int i = 0; i < gaps && bytes < target * (1 - LOD_PRICE_SLACK) && over > LOD_PRICE_LOWEST;
		i++)
		if (!fill_gap(m, lambda, target, at, &over, &bytes))
			break;
	return lod_price_relax(m, lambda, at);
}
