/* How kinds of plants share bytes (lod/plan/byte_price.h). The lists of a kind come at once, so that no one price
 * may use the bytes. Therefore each kind may have the limits of another price: a multiple-choice knapsack over kinds,
 * whose options are what each leaves wrong, and what it costs, with the limits of some prices around the one that
 * tiles and textures pay. */
#include "lod/plan/byte_price.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/plan/knapsack.h"

static const double around[] = LOD_KIND_PRICES;
#define PRICES (sizeof around / sizeof *around)
#define LEVELS LOD_KINDS_LEVELS
#define OPTIONS (uint32_t)(PRICES * LEVELS)

struct kinds {
	struct lod_allocation *m;
	uint32_t count, ladders;             /* plants; ladders in view */
	uint32_t *limits;                    /* per price and ladder, ... */
	bool *off;                           /* ... and per price and plant: no organs are drawn */
	double *bytes, *wrong;               /* per option, a price and a level, and plant */
	uint8_t *chosen;                     /* per plant: an option */
	uint8_t *levels;                     /* per plant: the same for all */
};

static void note(const struct kinds *k, size_t price)
{
	const struct lod_prices *prices = k->m->prices;
	for (uint32_t i = 0; i < k->ladders; i++)
		k->limits[price * k->ladders + i] = prices->ladders[i].limit;
	memcpy(k->off + price * k->count, prices->organs_off, k->count);
}

/* Relaxes plants where tiles stay as they are, and measures what each kind comes to with the limits of a price. */
static void measure(const struct kinds *k, size_t price, double lambda)
{
	struct lod_allocation *m = k->m;
	const struct lod_visible_tree *visible = &m->p->visible;
	double *bytes = k->bytes + price * LEVELS * k->count, *wrong = k->wrong + price * LEVELS * k->count;
	struct lod_mix to = { k->limits + price * k->ladders, k->off + price * k->count, k->levels, true };
	m->limited = true;
	for (size_t level = 0; level < LEVELS; level++, bytes += k->count, wrong += k->count) {
		memset(k->levels, (int)level, k->count);
		lod_kinds_set(m, &to);
		if (!level)
			lod_allocation_relax_plants(m, lambda);
		lod_prices_levels(m);
		for (uint32_t i = 0; i < k->count; i++)
			bytes[i] = wrong[i] = 0;
		lod_prices_of_kinds(m, bytes, wrong);
		for (uint32_t s = 0; s < visible->slot_count; s++) {
			const struct lod_cost *each = &m->uses.each[s];
			wrong[visible->slots[s].plant] += m->uses.seen[s] * (each->alike + each->open)
				+ lambda * m->uses.drawn[s] * each->vertices;
		}
	}
}

/* Do a kind's bytes depend on the option? */
static bool varies(const struct kinds *k, uint32_t kind)
{
	for (size_t j = 1; j < OPTIONS; j++)
		if (k->bytes[j * k->count + kind] != k->bytes[kind])
			return true;
	return false;
}

/* Chooses an option for each kind that has a choice: the least that is wrong within so many bytes. False: none fits, or no
 * memory. */
static bool choose(const struct kinds *k, double room)
{
	struct lod_knapsack_option *options = malloc((OPTIONS * k->count + 1) * sizeof *options);
	struct lod_knapsack_class *classes = malloc((k->count + 1u) * sizeof *classes);
	uint32_t *chosen = malloc((k->count + 1u) * sizeof *chosen), count = 0;
	for (uint32_t i = 0; i < k->count; i++)
		room -= varies(k, i) ? 0 : k->bytes[i];
	bool good = options && classes && chosen && room > 0;
	for (uint32_t i = 0; good && i < k->count; i++)
		if (varies(k, i)) {
			for (uint32_t j = 0; j < OPTIONS; j++)
				options[OPTIONS * count + j] = (struct lod_knapsack_option){ k->wrong[j * k->count + i],
					(uint64_t)fmin(LOD_KIND_BINS + 1, ceil(k->bytes[j * k->count + i] / (room / LOD_KIND_BINS))) };
			classes[count] = (struct lod_knapsack_class){ OPTIONS * count, OPTIONS * (count + 1), 0, false };
			count++;
		}
	good = good && lod_knapsack_solve(k->m->p, options, classes, count, LOD_KIND_BINS, chosen);
	count = 0;
	for (uint32_t i = 0; good && i < k->count; i++)
		k->chosen[i] = varies(k, i) ? (uint8_t)(chosen[count++] % OPTIONS) : 0;
	free(options);
	free(classes);
	free(chosen);
	return good;
}

static void mix(const struct kinds *k, struct lod_mix *to)
{
	for (uint32_t i = 0; i < k->ladders; i++)
		to->limits[i] = k->limits[k->chosen[k->m->prices->ladders[i].plant] / LEVELS * k->ladders + i];
	for (uint32_t i = 0; i < k->count; i++) {
		to->off[i] = k->off[k->chosen[i] / LEVELS * k->count + i];
		to->levels[i] = k->chosen[i] % LEVELS;
	}
	to->used = true;
}

static double sum_first(const double *bytes, uint32_t count)
{
	double sum = 0;
	for (uint32_t i = 0; i < count; i++)
		sum += bytes[i];
	return sum;
}

/* Tries the mix for what tiles leave of the bytes; where tiles choose others then, for less. */
static bool share(const struct kinds *k, double lambda, double target, double octave, struct lod_mix *to)
{
	struct lod_allocation *m = k->m;
	double bytes = lod_price_relax(m, lambda, octave, NULL), worth = lod_price_wrong(m) + lambda * m->cost.vertices;
	if (bytes >= LOD_KIND_ENOUGH * target)
		return false;
	for (size_t i = PRICES; i-- > 0;)
		measure(k, i, lambda);
	double room = target - bytes + sum_first(k->bytes, k->count);
	for (int i = 0; i < LOD_KIND_TRIES && room > 0 && choose(k, room); i++) {
		mix(k, to);
		bytes = lod_price_relax(m, lambda, octave, to);
		if (bytes <= target)
			return lod_price_wrong(m) + lambda * m->cost.vertices < worth
				&& m->cost.vertices <= (double)m->p->input->request->vertices;
		room -= bytes - target;
	}
	return false;
}

double lod_kinds_share(struct lod_allocation *m, double lambda, double target, double octave, struct lod_mix *to)
{
	struct lod_arena a = { 0 };
	struct kinds k = { .m = m, .count = m->p->scene->plant_count, .ladders = m->prices->ladder_count };
	k.limits = lod_arena_try(&a, PRICES * (k.ladders + 1u), sizeof *k.limits);
	k.off = lod_arena_try(&a, PRICES * (k.count + 1u), 1);
	k.bytes = lod_arena_try(&a, OPTIONS * (k.count + 1u), sizeof *k.bytes);
	k.wrong = lod_arena_try(&a, OPTIONS * (k.count + 1u), sizeof *k.wrong);
	k.chosen = lod_arena_try(&a, k.count, 1);
	k.levels = lod_arena_try(&a, k.count, 1);
	for (size_t i = PRICES; !a.failed && i-- > 0;) {
		lod_price_relax(m, lambda, fmin(LOD_PRICE_HIGHEST, octave + around[i]), NULL);
		note(&k, i);
	}
	to->used = !a.failed && share(&k, lambda, target, octave, to);
	lod_arena_free(&a);
	return lod_price_relax(m, lambda, octave, to);
}
