/* See rank_refine.h.
 *
 * Greedy picking cannot take back: who was picked early stays, with the code that was best then. Here the list is looked at where it is cut
 * at some keys. Each key has its own pictures, its scale and what a right and a wrong pixel are worth there (Q's gradient). Elements come in
 * turn, some sweeps long: of the codes and of the keys beside its own an element takes those that bring most, summed over all keys that
 * draw it, less a price per triangle. Prices hold each key's number of triangles where it was. Pictures count how often a pixel is covered,
 * so that an element can be thought away.
 *
 * An aspen of 2,896 leaves and a callistemon of 4,361, saved against Cook at equal Q (mean over uniform distances), other views than those
 * of the making: without this .58 and .71, with it .60 and .75. 24 views: .529 and .726 without; .607 and .742 with it; two sweeps with
 * every code tried in the first .595 and .740, four .608 and .756 for half as much time again; weights halfway to the balance
 * Precision = Recall .588 and .731, all the way .595 and .738; a second layer that counts twice as much .601 and .750, a third as much .608
 * and .741; softer prices .603 and .744. Keys from .05 of the list on alone: .699 on the callistemon, as small lists are left with codes of
 * the large ones. A pine of 4,920 went from .78 to .80 and a coconut palm of 25,158 from .53 to .59 (mean over distances mostly near). */
#include "lod/rank_refine.h"

#include <math.h>
#include <string.h>

#include "ecofiles/list.h"
#include "lod/sort.h"

#define KEYS 14u
#define KEY_LEAST 6u                     /* elements: shorter lists stay as they are */
#define PLANES 4u                        /* bits of a pixel's count; one that is full stays so */
#define SWEEPS 4u
#define LOOKED 75000u                   /* elements: looks at them in all sweeps but the first */
#define TOGETHER 64u                     /* elements that choose at once, each as if the others stayed */
#define PIECE 8u
#define SECOND 0.06                      /* what a second layer counts, of the first */
#define STIFF 20.0                       /* how a price answers to a share of triangles too many */
#define TRIAL_STRIDE 4u                  /* scales are tried on every so manieth view */

static const double key_share[KEYS] = { 0.004, 0.012, 0.03, 0.06, 0.1, 0.15, 0.22, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9 };

struct key {
	uint32_t elements;           /* at first */
	uint64_t budget, used;       /* triangles */
	double scale, edge[ECO_GROWTHS];
	double right, wrong, second, price, base_price;
	const struct lod_crown_level *level;
	uint64_t (**planes)[PLANES];         /* per view and word */
};

struct refine {
	const struct lod_rank_refining *in;
	struct lod_crown *crown;
	uint32_t count, key_count;
	struct key keys[KEYS];
	uint8_t *first, *code;       /* per element: the first key that draws it (key_count: none), how far it grows */
	uint8_t *next_first, *next_code;
	double *early;               /* per element: what it would bring one key earlier, per triangle */
	uint32_t *turn;              /* who is looked at when */
	uint32_t at, end, key_at;    /* who chooses now; which key is the first at work */
	double stretch;              /* of scales that are tried */
};

static uint32_t triangles_of(const struct refine *r, uint32_t element)
{
	const uint32_t *first = r->crown->foliage->first;
	return first[element + 1] - first[element] - 2;
}

static void run(struct refine *r, uint32_t count, void (*piece)(void *, uint32_t))
{
	if (r->in->options->each)
		r->in->options->each(r->in->options->ctx, count, piece, r);
	else
		for (uint32_t i = 0; i < count; i++)
			piece(r, i);
}

/* ---- Counted pictures ---- */

/* Not the builtin: without a flag for newer processors that is a call. */
static inline uint32_t bits_of(uint64_t x)
{
	x -= x >> 1 & UINT64_C(0x5555555555555555);
	x = (x & UINT64_C(0x3333333333333333)) + (x >> 2 & UINT64_C(0x3333333333333333));
	return (uint32_t)(((x + (x >> 4)) & UINT64_C(0x0f0f0f0f0f0f0f0f)) * UINT64_C(0x0101010101010101) >> 56);
}

static void count_bits(uint64_t planes[PLANES], uint64_t bits, bool up)
{
	bits &= ~(planes[0] & planes[1] & planes[2] & planes[3]);
	for (uint32_t i = 0; i < PLANES && bits; i++) {
		uint64_t carry = (up ? planes[i] : ~planes[i]) & bits;
		planes[i] ^= bits;
		bits = carry;
	}
}

static void draw(const struct refine *r, struct key *key, uint32_t element, uint32_t code, uint32_t stride, bool up)
{
	struct lod_fan fan = lod_foliage_fan(r->crown->foliage, element, r->crown->cutout[element]);
	struct lod_fan_seen seen;
	struct lod_footprint print;
	const struct lod_sights *sights = &key->level->sights;
	for (uint32_t v = 0; v < sights->count; v += stride) {
		lod_fan_see(&seen, &fan, &sights->eyes[v]);
		if (!lod_fan_cover(&print, &seen, key->edge[code], sights->pixels))
			continue;
		const uint64_t *bits = print.bits;
		for (uint32_t y = 0; y < print.rows; y++)
			for (uint32_t w = 0; w < print.words; w++, bits++)
				if (*bits)
					count_bits(key->planes[v][(size_t)(print.y + y) * (sights->words / sights->pixels) + print.word + w], *bits, up);
	}
}

static void redraw(const struct refine *r, struct key *key, uint32_t k, uint32_t stride)
{
	const struct lod_sights *sights = &key->level->sights;
	for (uint32_t v = 0; v < sights->count; v += stride)
		for (uint32_t w = 0; w < sights->words; w++)
			for (uint32_t p = 0; p < PLANES; p++)
				key->planes[v][w][p] = sights->wood[v][w];
	key->used = 0;
	for (uint32_t e = 0; e < r->count; e++)
		if (r->first[e] <= k) {
			draw(r, key, e, r->code[e], stride, true);
			key->used += triangles_of(r, e);
		}
}

/* Q; sets what pixels are worth. */
static double measure(struct key *key, uint32_t stride)
{
	const struct lod_sights *sights = &key->level->sights;
	uint64_t right = 0, wrong = 0, wanted = 0;
	for (uint32_t v = 0; v < sights->count; v += stride) {
		for (uint32_t w = 0; w < sights->words; w++) {
			const uint64_t *p = key->planes[v][w], covered = p[0] | p[1] | p[2] | p[3];
			right += bits_of(covered & sights->reference[v][w]);
			wrong += bits_of(covered & ~sights->reference[v][w]);
		}
		wanted += sights->reference_pixels[v];
	}
	double covered = fmax(1, (double)(right + wrong)), all = fmax(1, (double)wanted);
	double lost_p = (double)wrong / covered, lost_r = 1 - (double)right / all, lost = fmax(1e-6, sqrt(lost_p * lost_p + lost_r * lost_r));
	key->right = lost_p / lost * (double)wrong / covered / covered + lost_r / lost / all;
	key->wrong = lost_p / lost * (double)right / covered / covered;
	key->second = key->right * SECOND;
	return 1 - lost;
}

/* ---- Scales ---- */

static void set_scale(struct key *key, double scale)
{
	key->scale = scale;
	for (uint32_t c = 0; c < ECO_GROWTHS; c++)
		key->edge[c] = sqrt(eco_growth(c, (float)scale));
}

static double try_scale(const struct refine *r, uint32_t k, struct key *key, double scale)
{
	uint32_t stride = key->level->sights.count > 2 * TRIAL_STRIDE ? TRIAL_STRIDE : 1;
	set_scale(key, scale);
	redraw(r, key, k, stride);
	return measure(key, stride);
}

/* Climbs from the scale of before. */
static void fit_scale(void *pieces, uint32_t k)
{
	struct refine *r = pieces;
	struct key *key = &r->keys[k += r->key_at];
	double best_scale = key->scale, best = try_scale(r, k, key, best_scale);
	for (int way = 1; way >= -1; way -= 2) {
		bool moved = false;
		for (uint32_t i = 0; i < 8; i++) {
			double scale = 1 + (best_scale - 1) * (way > 0 ? r->stretch : 1 / r->stretch), q = try_scale(r, k, key, scale);
			if (!(q > best))
				break;
			best = q;
			best_scale = scale;
			moved = true;
		}
		if (moved)
			break;
	}
	set_scale(key, best_scale);
	redraw(r, key, k, 1);
	measure(key, 1);
}

/* ---- What an element brings ---- */

struct worth { double of[KEYS][ECO_GROWTHS]; };

static uint64_t bits_at(const struct lod_footprint *print, uint32_t y, uint32_t word)
{
	if (!print || y < print->y || y >= print->y + print->rows || word < print->word || word >= print->word + print->words)
		return 0;
	return print->bits[(size_t)(y - print->y) * print->words + word - print->word];
}

/* `own`: what the element covers now and is to be thought away; or NULL. */
static double gain(const struct key *key, uint32_t view, const struct lod_footprint *print, const struct lod_footprint *own)
{
	const struct lod_canvas *canvas = &key->level->canvas[view];
	const uint64_t *bits = print->bits;
	uint32_t right = 0, wrong = 0, second = 0;
	for (uint32_t y = 0; y < print->rows; y++) {
		size_t at = (size_t)(print->y + y) * canvas->row_words + print->word;
		for (uint32_t w = 0; w < print->words; w++, bits++) {
			if (!*bits)
				continue;
			const uint64_t *p = key->planes[view][at + w], reference = canvas->reference[at + w], many = p[2] | p[3];
			uint64_t mine = bits_at(own, print->y + y, print->word + w), one = p[0] & ~p[1] & ~many, two = p[1] & ~p[0] & ~many;
			uint64_t free = *bits & ((~(p[0] | p[1] | many)) | (one & mine)), once = *bits & ((one & ~mine) | (two & mine)) & reference;
			if (free) {
				right += bits_of(free & reference);
				wrong += bits_of(free & ~reference);
			}
			if (once)
				second += bits_of(once);
		}
	}
	return right * key->right - wrong * key->wrong + second * key->second;
}

static void look(const struct refine *r, uint32_t element, uint32_t low_key, uint32_t low_code, uint32_t high_code, struct worth *worth)
{
	struct lod_fan fan = lod_foliage_fan(r->crown->foliage, element, r->crown->cutout[element]);
	struct lod_fan_seen seen;
	struct lod_footprint own, print;
	uint32_t code = r->code[element];
	memset(worth, 0, sizeof *worth);
	for (uint32_t v = 0; v < r->crown->views; v++) {
		lod_fan_see(&seen, &fan, &r->crown->levels[0].sights.eyes[v]);
		for (uint32_t k = low_key; k < r->key_count; k++) {
			const struct key *key = &r->keys[k];
			bool drawn = r->first[element] <= k && lod_fan_cover(&own, &seen, key->edge[code], key->level->sights.pixels);
			for (uint32_t c = low_code; c <= high_code; c++)
				if (drawn && c == code)
					worth->of[k][c] += gain(key, v, &own, &own);
				else if (lod_fan_cover(&print, &seen, key->edge[c], key->level->sights.pixels))
					worth->of[k][c] += gain(key, v, &print, drawn ? &own : NULL);
		}
	}
}

static void choose(struct refine *r, uint32_t element)
{
	struct worth worth;
	uint32_t first = r->first[element], code = r->code[element], best_first = first, best_code = code;
	uint32_t low_key = first > 0 ? first - 1 : 0, high_key = first < r->key_count ? first + 1 : first;
	uint32_t low_code = code > 0 ? code - 1 : 0, high_code = code + 1 < ECO_GROWTHS ? code + 1 : code;
	double triangles = triangles_of(r, element), best = -INFINITY;
	look(r, element, low_key, low_code, high_code, &worth);
	for (uint32_t c = low_code; c <= high_code; c++) {
		double sum = 0;
		for (uint32_t k = r->key_count + 1; k-- > low_key;) {
			if (k < r->key_count)
				sum += worth.of[k][c] - r->keys[k].price * triangles;
			if (k <= high_key && sum > best) {
				best = sum;
				best_first = k;
				best_code = c;
			}
		}
	}
	r->next_first[element] = (uint8_t)best_first;
	r->next_code[element] = (uint8_t)best_code;
	r->early[element] = worth.of[best_first > low_key ? best_first - 1 : low_key][best_code] / triangles;
}

static void choose_piece(void *pieces, uint32_t i)
{
	struct refine *r = pieces;
	uint32_t begin = r->at + i * PIECE, end = begin + PIECE < r->end ? begin + PIECE : r->end;
	for (uint32_t t = begin; t < end; t++)
		choose(r, r->turn[t]);
}

static void apply(struct refine *r, uint32_t element)
{
	uint32_t first = r->next_first[element], code = r->next_code[element];
	for (uint32_t k = 0; k < r->key_count; k++) {
		struct key *key = &r->keys[k];
		bool was = r->first[element] <= k, is = first <= k, other = code != r->code[element];
		if (was && (!is || other))
			draw(r, key, element, r->code[element], 1, false);
		if (is && (!was || other))
			draw(r, key, element, code, 1, true);
		key->used += (uint64_t)triangles_of(r, element) * is;
		key->used -= (uint64_t)triangles_of(r, element) * was;
	}
	r->first[element] = (uint8_t)first;
	r->code[element] = (uint8_t)code;
}

/* ---- Sweeps ---- */

/* A price is what elements near the end of a key's list bring. */
static void set_price(void *pieces, uint32_t k)
{
	struct refine *r = pieces;
	struct key *key = &r->keys[k += r->key_at];
	uint32_t begin = key->elements - (key->elements + 9) / 10, end = key->elements + key->elements / 10, samples = 0;
	end = end < r->count ? end : r->count;
	double sum = 0;
	for (uint32_t i = begin; i < end; i += (end - begin) / 200 + 1, samples++) {
		struct worth worth;
		uint32_t element = r->in->order[i], code = r->code[element];
		look(r, element, k, code, code, &worth);
		sum += worth.of[k][code] / triangles_of(r, element);
	}
	key->price = key->base_price = sum / samples;
}

static void follow_budgets(struct refine *r)
{
	for (struct key *key = r->keys; key < r->keys + r->key_count; key++) {
		double excess = (double)key->used / (double)key->budget - 1;
		key->price = key->base_price * fmin(3, fmax(0.2, 1 + STIFF * excess));
	}
}

static bool goes_on(const struct refine *r, double share)
{
	const struct lod_rank_options *options = r->in->options;
	return !options->progress || options->progress(options->ctx, LOD_RANK_REFINE_FROM + (1 - LOD_RANK_REFINE_FROM) * share);
}

/* Something for each key, two at a time. */
static bool run_keys(struct refine *r, void (*piece)(void *, uint32_t), double share)
{
	for (r->key_at = 0; r->key_at < r->key_count; r->key_at += 2) {
		run(r, r->key_count - r->key_at < 2 ? 1 : 2, piece);
		if (!goes_on(r, share))
			return false;
	}
	return true;
}

static bool sweep(struct refine *r, uint32_t number, uint32_t sweeps)
{
	uint32_t together = r->count / TOGETHER + 1 < TOGETHER ? r->count / TOGETHER + 1 : TOGETHER;
	for (uint32_t i = r->count; i > 1; i--) {
		uint32_t j = (uint32_t)(lod_mix((uint64_t)number * r->count + i) % i), other = r->turn[i - 1];
		r->turn[i - 1] = r->turn[j];
		r->turn[j] = other;
	}
	for (r->at = 0; r->at < r->count; r->at = r->end) {
		r->end = r->at + together < r->count ? r->at + together : r->count;
		run(r, (r->end - r->at + PIECE - 1) / PIECE, choose_piece);
		for (uint32_t t = r->at; t < r->end; t++)
			apply(r, r->turn[t]);
		follow_budgets(r);
		if (!goes_on(r, (number + (double)r->at / r->count) / sweeps))
			return false;
	}
	for (struct key *key = r->keys; key < r->keys + r->key_count; key++)
		key->base_price += (key->price - key->base_price) * 0.7;         /* what held the budget */
	return true;
}

/* ---- In and out ---- */

static void open_keys(struct refine *r, struct lod_arena *arena)
{
	uint64_t total = 0, sum = 0;
	uint32_t i = 0;
	for (uint32_t e = 0; e < r->count; e++)
		total += triangles_of(r, e);
	for (uint32_t share = 0; share < KEYS; share++) {
		struct key *key = &r->keys[r->key_count];
		for (; i + 1 < r->count && (double)sum < key_share[share] * (double)total; i++) {
			sum += triangles_of(r, r->in->order[i]);
			r->first[r->in->order[i]] = (uint8_t)r->key_count;
		}
		if (i < KEY_LEAST || (r->key_count && i == key[-1].elements))
			continue;
		key->elements = i;
		key->budget = sum;
		lod_crown_set_level(r->crown, i);
		key->level = r->crown->level;
		key->planes = lod_arena_take(arena, r->crown->views, sizeof *key->planes);
		for (uint32_t v = 0; v < r->crown->views; v++)
			key->planes[v] = lod_arena_take(arena, key->level->sights.words, sizeof *key->planes[v]);
		double cook = (double)r->count / i;
		set_scale(key, sqrt(cook * (1 + cook) / 2));
		r->key_count++;
	}
	for (; i < r->count; i++)
		r->first[r->in->order[i]] = (uint8_t)r->key_count;
}

/* By keys, and between two by what elements would have brought at the first of them. Who is drawn at every key stays in the order that was. */
static void write_order(const struct refine *r, struct lod_arena *arena)
{
	struct lod_keyed *items = lod_arena_take(arena, r->count, sizeof *items);
	uint32_t *old = lod_arena_take(arena, r->count, sizeof *old), done = 0;
	for (uint32_t i = 0; i < r->count; i++)
		old[r->in->order[i]] = i;
	for (uint32_t k = 0; k <= r->key_count; k++) {
		uint32_t found = 0;
		for (uint32_t e = 0; e < r->count; e++)
			if (r->first[e] == k)
				items[found++] = (struct lod_keyed){ k > 0 ? ~lod_sort_key(r->early[e]) : old[e], e };
		lod_sort(arena, items, found);
		for (uint32_t i = 0; i < found; i++)
			r->in->order[done++] = items[i].value;
	}
	memcpy(r->in->growth, r->code, r->count);
}

static bool make_sweeps(struct refine *r)
{
	uint32_t more = LOOKED / r->count, sweeps = 1 + (more < SWEEPS - 1 ? more : SWEEPS - 1);
	r->stretch = 1.25;
	if (!run_keys(r, fit_scale, 0) || !run_keys(r, set_price, 0))
		return false;
	for (uint32_t s = 0; s < sweeps; s++) {
		if (!sweep(r, s, sweeps))
			return false;
		r->stretch = 1.12;
		if (s + 1 < sweeps && !run_keys(r, fit_scale, (s + 1.0) / sweeps))
			return false;
	}
	return true;
}

bool lod_rank_refine(const struct lod_rank_refining *refining, struct lod_arena *arena)
{
	struct refine r = { .in = refining, .crown = refining->crown, .count = refining->count };
	r.first = lod_arena_take(arena, r.count, sizeof *r.first);
	r.code = lod_arena_take(arena, r.count, sizeof *r.code);
	r.next_first = lod_arena_take(arena, r.count, sizeof *r.next_first);
	r.next_code = lod_arena_take(arena, r.count, sizeof *r.next_code);
	r.early = lod_arena_take(arena, r.count, sizeof *r.early);
	r.turn = lod_arena_take(arena, r.count, sizeof *r.turn);
	memcpy(r.code, refining->growth, r.count);
	for (uint32_t e = 0; e < r.count; e++)
		r.turn[e] = e;
	open_keys(&r, arena);
	if (r.key_count == 0)
		return true;
	if (!make_sweeps(&r))
		return false;
	write_order(&r, arena);
	return true;
}
