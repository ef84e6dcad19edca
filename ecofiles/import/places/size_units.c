/* Plants of an inventory spread around typical sizes; a unit's misfit is how far, in logarithms, it moves
 * the middle and the upper end away from these. Units differ by factors of 2.5 and more, inventories of
 * woods, streets and nurseries by about 2. */
#include "ecofiles/import/places/size_units.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "build/words/units.table"
#include "ecofiles/base/order.h"
#include "ecofiles/import/places/words.h"

#define SURE 0.7                 /* so much worse is the next unit, if a guess is to be made */
#define FAR 3.2                  /* a misfit that no usual inventory has */
#define DOUBT 2.2                /* so much better is another unit than the one stated */

#define UNITS (sizeof units_rows / sizeof *units_rows)

/* most_m: middle that a stated unit may give without a doubt: lists of monuments have trunks of 1.5 m */
static const struct { double middle_m, high_m, most_m; const char *says; } typical[] = {
	[ECO_QUANTITY_HEIGHT] = { 10, 22, 0, "height" }, [ECO_QUANTITY_DBH] = { 0.22, 0.75, 2, "trunk diameter" },
	[ECO_QUANTITY_GIRTH] = { 0.7, 2.4, 6.5, "trunk girth" },
	[ECO_QUANTITY_CROWN] = { 6, 15, 0, "crown" } };

/* A wood is high and even, its tallest are half as tall again as its middle; it could be taken for a street
 * in feet only where it is measured in metres. */
#define WOOD_MIDDLE_M 22
#define WOOD_HIGH_M 34
#define WOOD_HIGH 1.5

static double usual_misfit(enum eco_quantity quantity, double unit_m, const struct eco_size_numbers *n)
{
	return fabs(log(n->middle * unit_m / typical[quantity].middle_m))
		+ fabs(log(n->high * unit_m / typical[quantity].high_m));
}

static double misfit(enum eco_quantity quantity, double unit_m, const struct eco_size_numbers *n)
{
	double usual = usual_misfit(quantity, unit_m, n);
	double wood = fabs(log(n->middle * unit_m / WOOD_MIDDLE_M)) + fabs(log(n->high * unit_m / WOOD_HIGH_M))
		+ fabs(log(n->high / n->middle / WOOD_HIGH));
	return quantity == ECO_QUANTITY_HEIGHT && unit_m == 1 ? fmin(usual, wood) : usual;
}

/* The unit that fits best beside `except`; UNITS: no such. */
static size_t best_unit(enum eco_quantity quantity, const struct eco_size_numbers *n, size_t except)
{
	size_t best = UNITS;
	for (size_t i = 0; i < UNITS; i++)
		if (i != except && strcmp(units_rows[i].unit, "dm") != 0 &&
			(best == UNITS ||
				misfit(quantity, units_rows[i].metres, n) <
					misfit(quantity, units_rows[best].metres, n)))
			best = i;
	return best;
}

/* The last unit among the words of a name: "height in m" is in metres. */
static size_t unit_of_name(const char *name)
{
	char words[ECO_WORDS_BYTES], word[ECO_WORD_BYTES];
	size_t found = UNITS, count = 0;
	eco_words_of(name ? name : "", words, sizeof words);
	for (const char *at = words; eco_words_next(&at, word); count++)
		for (size_t i = 0; i < UNITS; i++)
			if (eco_words_have(units_rows[i].words, word) && count > 0)
				found = i;
	return found;
}

/* The unit in which numbers would be far likelier than in unit_m; UNITS: none. */
static size_t doubt(enum eco_quantity quantity, double unit_m, const struct eco_size_numbers *n)
{
	size_t best = best_unit(quantity, n, UNITS);
	double middle_m = n->middle * unit_m;
	if (!(n->middle > 0) || fabs(units_rows[best].metres / unit_m - 1) < 1e-4
			|| (middle_m > typical[quantity].middle_m && middle_m <= typical[quantity].most_m))
		return UNITS;
	return usual_misfit(quantity, unit_m, n) - usual_misfit(quantity, units_rows[best].metres, n) > DOUBT
		? best : UNITS;
}

static void ask(struct eco_unit_guess *guess, enum eco_quantity quantity, size_t a, size_t b,
	const struct eco_size_numbers *n)
{
	guess->unit = NULL;
	guess->other = units_rows[b].unit;
	snprintf(guess->why, sizeof guess->why, "half of them are above %.4g, the largest about %.4g: a %s "
		"of %.3g m if in %s, of %.3g m if in %s", n->middle, n->high, typical[quantity].says,
		n->middle * units_rows[a].metres, units_rows[a].unit, n->middle * units_rows[b].metres,
		units_rows[b].unit);
}

const char *eco_unit_of_name(const char *name)
{
	size_t named = unit_of_name(name);
	return named < UNITS ? units_rows[named].unit : NULL;
}

static size_t unit_at_end(const char *name)
{
	char words[ECO_WORDS_BYTES];
	eco_words_of(name, words, sizeof words);
	const char *last = strrchr(words, ' ');
	for (size_t i = 0; last && i < UNITS; i++)
		if (eco_words_have(units_rows[i].words, last + 1))
			return i;
	return UNITS;
}

const char *eco_unit_of_place(const char *x, const char *y, double *metres)
{
	size_t unit = unit_at_end(x);
	bool both = unit < UNITS && unit_at_end(y) == unit;
	*metres = both ? units_rows[unit].metres : 1;
	return both ? units_rows[unit].unit : NULL;
}

static bool is_metric(const char *unit) { return strcmp(unit, "ft") != 0 && strcmp(unit, "in") != 0; }

/* Takes the one of two possible units that belongs to the system of the other sizes. */
static bool decide_beside(struct eco_unit_guess *guess, size_t a, size_t b, const char *beside)
{
	if (!beside || is_metric(units_rows[a].unit) == is_metric(units_rows[b].unit))
		return false;
	guess->unit = is_metric(units_rows[a].unit) == is_metric(beside) ? units_rows[a].unit
		: units_rows[b].unit;
	snprintf(guess->why, sizeof guess->why, "it may be %s or %s by its numbers; other sizes are in %s",
		units_rows[a].unit, units_rows[b].unit, beside);
	return true;
}

struct eco_unit_guess eco_unit_guess(enum eco_quantity quantity, const char *name, const char *beside,
	const struct eco_size_numbers *numbers)
{
	size_t named = unit_of_name(name);
	if (named < UNITS) {
		struct eco_unit_guess guess = { .unit = units_rows[named].unit, .by_name = true };
		size_t better = doubt(quantity, units_rows[named].metres, numbers);
		snprintf(guess.why, sizeof guess.why, "its name says %s", units_rows[named].unit);
		if (better < UNITS)
			ask(&guess, quantity, named, better, numbers);
		return guess;
	}
	size_t best = best_unit(quantity, numbers, UNITS), next = best_unit(quantity, numbers, best);
	double fit = misfit(quantity, units_rows[best].metres, numbers);
	struct eco_unit_guess guess = { .unit = units_rows[best].unit };
	bool sure = misfit(quantity, units_rows[next].metres, numbers) - fit >= SURE;
	if (fit <= FAR && !sure && decide_beside(&guess, best, next, beside))
		return guess;
	if (fit > FAR || !sure)
		ask(&guess, quantity, best, next, numbers);
	else
		snprintf(guess.why, sizeof guess.why, "half of them are above %.4g %s, the largest about "
			"%.4g; in %s half would be above %.3g m", numbers->middle, units_rows[best].unit,
			numbers->high,
			units_rows[next].unit, numbers->middle * units_rows[next].metres);
	return guess;
}

void eco_spread_add(struct eco_spread *spread, double number)
{
	if (!spread->kept) {
		spread->kept = eco_alloc(ECO_SPREAD_KEPT, sizeof *spread->kept);
		spread->stride = 1;
	}
	if (spread->seen++ % spread->stride != 0)
		return;
	if (spread->count == ECO_SPREAD_KEPT) {      /* every second one leaves */
		spread->count /= 2;
		spread->stride *= 2;
		for (uint32_t i = 0; i < spread->count; i++)
			spread->kept[i] = spread->kept[2 * i];
	}
	spread->kept[spread->count++] = (float)number;
	spread->sorted = false;
}

ECO_ORDER(compare, float, [0])

double eco_spread_quantile(struct eco_spread *spread, double share)
{
	if (spread->count == 0)
		return NAN;
	if (!spread->sorted)
		qsort(spread->kept, spread->count, sizeof *spread->kept, compare);
	spread->sorted = true;
	return (double)spread->kept[(uint32_t)lround(share * (spread->count - 1))];
}

void eco_spread_free(struct eco_spread *spread)
{
	free(spread->kept);
	*spread = (struct eco_spread){ 0 };
}
