/* How kinds of plants share bytes (lod/plan/byte_price.h). The lists of a kind come at once, so that no one price
 * may use the bytes. Therefore each kind may have the limits of another price: a multiple-choice knapsack over kinds,
 * whose options are what each leaves wrong, and what it costs, with the limits of some prices around the one that
 * tiles and textures pay. */
#include "lod/plan/byte_price.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/plan/byte_price_state.h"
#include "lod/plan/price_search.h"

#define BINS 256                 /* of the bytes that kinds share */
#define ENOUGH 0.985             /* of the bytes: no other price of tiles is tried */
#define TRIES 5                  /* of a mix: tiles that choose others need bytes, too */
/* octaves of the prices whose limits kinds may have, beside the price of tiles; the first is that price */
static const double around[] = { 0, 1.5, 0.5, -0.125, -0.5, -1, -2 };
#define PRICES (sizeof around / sizeof *around)
const double lod_kinds_levels[] = { 1, 4 };
#define LEVELS (sizeof lod_kinds_levels / sizeof *lod_kinds_levels)
#define OPTIONS (PRICES * LEVELS)
/* octaves beside the same that tiles may pay: with fewer bytes of kinds there may be more of these, and the reverse */
static const double tiles[] = { 0, -0.125, -0.5, -1.5, 0.75 };

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
	struct lod_mix to = { k->limits + price * k->ladders, k->off + price * k->count, k->levels, 0, true };
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

/* Chooses an option for each kind that has a choice: the least that is wrong within so many bytes [K 11.5]. False: none
 * fits, or no memory. */
static bool choose(const struct kinds *k, double room)
{
	double *least = calloc(2 * (BINS + 1), sizeof *least), *next = least + BINS + 1, unit;
	uint8_t *picks = calloc((size_t)k->count * (BINS + 1) + 1, 1);
	bool good = least && picks;
	for (uint32_t i = 0; i < k->count; i++)
		room -= varies(k, i) ? 0 : k->bytes[i];
	unit = room / BINS;
	good &= room > 0;
	for (uint32_t i = 0; good && i < k->count; i++) {
		uint8_t *pick = picks + (size_t)i * (BINS + 1);
		for (int b = 0; b <= BINS; b++)
			next[b] = INFINITY;
		for (size_t j = 0; varies(k, i) && j < OPTIONS; j++) {
			int cost = (int)fmin(BINS + 1, ceil(k->bytes[j * k->count + i] / unit));
			for (int b = cost; b <= BINS; b++)
				if (least[b - cost] + k->wrong[j * k->count + i] < next[b]) {
					next[b] = least[b - cost] + k->wrong[j * k->count + i];
					pick[b] = (uint8_t)j;
				}
		}
		if (varies(k, i))
			memcpy(least, next, (BINS + 1) * sizeof *least);
		lod_planner_work(k->m->p, varies(k, i) ? OPTIONS * BINS / 8 : OPTIONS);
	}
	int left = BINS;
	good = good && least[BINS] < INFINITY;
	memset(k->chosen, 0, k->count);
	for (uint32_t i = k->count; good && i-- > 0;)
		if (varies(k, i)) {
			k->chosen[i] = picks[(size_t)i * (BINS + 1) + left];
			left -= (int)ceil(k->bytes[k->chosen[i] * k->count + i] / unit);
		}
	free(least);
	free(picks);
	return good;
}

static void mix(const struct kinds *k, struct lod_mix *to)
{
	for (uint32_t i = 0; i < k->ladders; i++)
		to->limits[i] = k->limits[k->chosen[lod_prices_kind(k->m, i)] / LEVELS * k->ladders + i];
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

struct shared { double worth, bytes; };      /* worth: wrong pixels, vertices paid */

/* Tries the mix for what tiles at a price leave of the bytes; where tiles choose others then, for less. */
static bool share(const struct kinds *k, double lambda, double target, struct lod_mix *to, struct shared *best)
{
	struct lod_allocation *m = k->m;
	double others = lod_price_relax(m, lambda, to->octave, NULL), room;
	for (size_t i = PRICES; i-- > 0;)
		measure(k, i, lambda);
	others -= sum_first(k->bytes, k->count);
	room = target - others;
	for (int i = 0; i < TRIES && room > 0 && choose(k, room); i++) {
		mix(k, to);
		double now = lod_price_relax(m, lambda, to->octave, to), worth = lod_price_wrong(m)
			+ lambda * m->cost.vertices;
		if (now <= target && worth < best->worth
				&& m->cost.vertices <= (double)m->p->input->request->vertices) {
			*best = (struct shared){ worth, now };
			return true;
		}
		if (now <= target)
			break;
		room -= now - target;
	}
	return false;
}

static void copy(const struct kinds *k, struct lod_mix *to, const struct lod_mix *from)
{
	memcpy(to->limits, from->limits, k->ladders * sizeof *to->limits);
	memcpy(to->off, from->off, k->count);
	memcpy(to->levels, from->levels, k->count);
	to->octave = from->octave;
	to->used = true;
}

double lod_kinds_share(struct lod_allocation *m, double lambda, double target, double octave, struct lod_mix *to)
{
	struct kinds k = { .m = m, .count = m->p->scene->plant_count, .ladders = m->prices->ladder_count };
	struct lod_mix next = { 0 };
	k.limits = malloc(((PRICES + 1) * k.ladders + 1) * sizeof *k.limits);
	k.off = malloc((PRICES + 1) * k.count + 1);
	k.bytes = malloc((2 * OPTIONS * k.count + 1) * sizeof *k.bytes);
	k.chosen = malloc(3 * k.count + 1u);
	to->used = false;
	bool good = k.limits && k.off && k.bytes && k.chosen;
	for (size_t i = PRICES; good && i-- > 0;) {
		lod_price_relax(m, lambda, fmin(LOD_PRICE_HIGHEST, octave + around[i]), NULL);
		note(&k, i);
	}
	double bytes = lod_price_relax(m, lambda, octave, NULL);
	struct shared best = { lod_price_wrong(m) + lambda * m->cost.vertices, bytes };
	for (size_t i = 0; good && i < sizeof tiles / sizeof *tiles && best.bytes < ENOUGH * target
			&& !(i && lod_planner_over(m->p, 3)); i++) {
		k.wrong = k.bytes + OPTIONS * k.count;
		k.levels = k.chosen + k.count;
		next.levels = k.levels + k.count;
		next.limits = k.limits + PRICES * k.ladders;
		next.off = k.off + PRICES * k.count;
		next.octave = fmin(LOD_PRICE_HIGHEST, octave + tiles[i]);
		if (share(&k, lambda, target, &next, &best))
			copy(&k, to, &next);
	}
	free(k.limits);
	free(k.off);
	free(k.bytes);
	free(k.chosen);
	return lod_price_relax(m, lambda, octave, to);
}
