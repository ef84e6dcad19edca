/* See rank_state.h.
 *
 * The list is cut at several keys, each with its own pictures, scale and values of pixels (Q's gradient). In
 * several sweeps an element takes those of the neighbouring codes and keys with the greatest sum of gains
 * over all keys that draw it, less a price per triangle (at keys of points: per point), which keeps a key's
 * number of triangles. Pictures count how often a pixel is covered, so that an element can be subtracted.
 * Variants: lod/EXPERIMENTS.md, Refining the greedy order. Longer than 600 lines: one search over one set of
 * pictures. */
#include "lod/build/order/rank_state.h"

#include <math.h>
#include <string.h>

#include "ecofiles/format/list.h"
#include "lod/lanes.h"
#include "lod/sort.h"

#define KEYS 20u
#define KEY_LEAST 6u                     /* elements: shorter lists are not refined */
#define PLANES 4u                        /* bits of a pixel's count; a full count stays full */
#define SWEEPS 4u
#define LOOKED 75000u                   /* elements: looks at them in all sweeps but the first */
#define TOGETHER 64u                     /* elements that choose at once, each as if the others stayed */
#define PIECE 8u
#define SECOND 0.06                      /* value of a second layer, relative to the first */
#define PRINTS 64u
#define ROOM (4 * LOD_FOOTPRINT_PIXELS * (LOD_FOOTPRINT_PIXELS / 64))   /* words */
#define APPLY_PIECES 8u
#define RESTS 2                          /* sweeps without a move before an element rests for one */
#define STIFF 20.0                       /* response of a price to a share of triangles in excess */
#define TRIAL_STRIDE 4u                  /* trials of scales use every so many views */

/* A key: its share of the triangles, and whether leaves are points there, as in a pack's beginning of the
 * list (lod/build/measure/curve.c). */
struct place { double share; bool points; };
static const struct place few_points[] = { { 0.0015, true }, { 0.004, false }, { 0.006, true },
	{ 0.012, false }, { 0.02, true }, { 0.03, false },
	{ 0.05, true }, { 0.06, false }, { 0.1, false }, { 0.13, true }, { 0.15, false }, { 0.22, false },
	{ 0.3, false }, { 0.35, true }, { 0.4, false },
	{ 0.5, false }, { 0.6, false }, { 0.7, false }, { 0.8, false }, { 0.9, false } };
static const struct place many_points[] = { { 0.0015, true }, { 0.003, true }, { 0.006, true },
	{ 0.011, true }, { 0.02, true }, { 0.032, true },
	{ 0.05, true }, { 0.085, true }, { 0.13, true }, { 0.2, true }, { 0.27, true }, { 0.3, false },
	{ 0.35, true }, { 0.4, false }, { 0.5, false },
	{ 0.55, true }, { 0.6, false }, { 0.7, false }, { 0.8, false }, { 0.9, false } };
_Static_assert(sizeof few_points == KEYS * sizeof(struct place) && sizeof many_points == sizeof few_points,
	"one key each");

struct key {
	bool points;                 /* leaves are points there, all at the key's scale */
	uint32_t elements;           /* before the refinement */
	uint64_t budget, used;       /* triangles or points */
	double scale;
	struct lod_crown_edges edges;
	double right, wrong, second, price, base_price;
	const struct lod_crown_level *level;
	uint64_t (**planes)[PLANES];         /* per view and word */
	uint64_t (*trial)[2];        /* a view's words, as of a canvas */
	bool drawn;
};

struct refine {
	const struct lod_rank_refining *in;
	struct lod_crown *crown;
	uint32_t count, key_count;
	struct key keys[KEYS];
	/* Per element: the first key that draws it (key_count: none), its growth code. */
	uint8_t *first, *code;
	uint8_t *next_first, *next_code;
	uint8_t *stays;              /* per element: how often in a row it stayed when looked at */
	double *early;               /* per element: its gain one key earlier, per triangle */
	uint32_t *turn;              /* the sequence of elements */
	uint32_t at, end, key_at;    /* range of turns that choose now; first key at work */
	double stretch;              /* factor between two scales of a trial */
};

static uint32_t triangles_of(const struct refine *r, uint32_t element)
{
	const uint32_t *first = r->crown->foliage->first;
	return first[element + 1] - first[element] - 2;
}

static uint32_t cost_in(const struct refine *r, const struct key *key, uint32_t element)
{
	return key->points ? 1 : triangles_of(r, element);
}

static void run(struct refine *r, uint32_t count, void (*piece)(void *, uint32_t))
{
	lod_each_run(r->in->options->each, r->in->options->ctx, count, piece, r);
}

/* ---- An element in a view ---- */

/* The element's footprints at each edge: pixels of one level, drawn when first needed. */
struct print { uint32_t y, rows, word, words; const uint64_t *bits; };
struct prints {
	struct lod_fan_seen seen;
	const struct lod_eye *eye;
	double area;                 /* of its point */
	uint32_t pixels, count, used;
	/* Slot of an edge, for the leaf and for its point: 1 + its place below, or 0. */
	uint8_t slot[2][LOD_CROWN_EDGES];
	struct print items[PRINTS];
	struct lod_footprint drawn;
	uint64_t room[ROOM];
};

static void see(const struct refine *r, struct prints *prints, uint32_t element, uint32_t view)
{
	lod_crown_see(r->crown, &prints->seen, element, view, false);
	prints->eye = &r->crown->level->sights.eyes[view];
	prints->area = r->crown->foliage->area[element] / 2;
}

/* Points are made on demand, since few keys use them. */
static bool cover(struct lod_footprint *drawn, const struct prints *prints, double edge, uint32_t pixels,
	bool points)
{
	if (!points)
		return lod_fan_cover(drawn, &prints->seen, edge, pixels);
	struct lod_fan_seen point = prints->seen;
	lod_fan_point(&point, prints->area, prints->eye);
	return lod_fan_cover(drawn, &point, edge, pixels);
}

static void forget_prints(struct prints *prints, uint32_t pixels)
{
	prints->pixels = pixels;
	prints->count = prints->used = 0;
	memset(prints->slot, 0, sizeof prints->slot);
}

/* Makes room for the footprints of one key, three codes at most. */
static void make_room(struct prints *prints)
{
	uint32_t largest = prints->pixels * ((prints->pixels + 63) / 64);
	if (prints->count + 3 > PRINTS || prints->used + 3 * largest > ROOM)
		forget_prints(prints, prints->pixels);
}

static const struct print *find_print(struct prints *prints, const struct key *key, uint32_t code)
{
	uint8_t *slot = &prints->slot[key->points][key->edges.step[code]];
	if (*slot)
		return &prints->items[*slot - 1];
	struct lod_footprint *drawn = &prints->drawn;
	struct print *print = &prints->items[prints->count++];
	*slot = (uint8_t)prints->count;
	*print = (struct print){ .bits = prints->room + prints->used };
	if (cover(drawn, prints, key->edges.edge[code], prints->pixels, key->points)) {
		print->y = drawn->y, print->rows = drawn->rows;
		print->word = drawn->word, print->words = drawn->words;
		memcpy(prints->room + prints->used, drawn->bits,
			(size_t)drawn->rows * drawn->words * sizeof *drawn->bits);
		prints->used += drawn->rows * drawn->words;
	}
	return print;
}

/* ---- Counted pictures ---- */

static void count_bits(uint64_t planes[PLANES], uint64_t bits, bool up)
{
	bits &= ~(planes[0] & planes[1] & planes[2] & planes[3]);
	for (uint32_t i = 0; i < PLANES && bits; i++) {
		uint64_t carry = (up ? planes[i] : ~planes[i]) & bits;
		planes[i] ^= bits;
		bits = carry;
	}
}

static void draw(const struct key *key, uint32_t view, const struct print *print, bool up)
{
	const struct lod_canvas *canvas = &key->level->canvas[view];
	const uint64_t *bits = print->bits;
	for (uint32_t y = 0; y < print->rows; y++) {
		uint64_t (*planes)[PLANES] = key->planes[view] + (size_t)(print->y + y) * canvas->row_words
			+ print->word;
		for (uint32_t w = 0; w < print->words; w++, bits++)
			if (*bits)
				count_bits(planes[w], *bits, up);
	}
}

static void redraw(const struct refine *r, struct key *key, uint32_t k)
{
	const struct lod_sights *sights = &key->level->sights;
	struct prints prints;
	for (uint32_t v = 0; v < sights->count; v++) {
		for (uint32_t w = 0; w < sights->words; w++)
			for (uint32_t p = 0; p < PLANES; p++)
				key->planes[v][w][p] = sights->wood[v][w];
		for (uint32_t e = 0; e < r->count; e++) {
			if (r->first[e] > k)
				continue;
			see(r, &prints, e, v);
			forget_prints(&prints, sights->pixels);
			draw(key, v, find_print(&prints, key, r->code[e]), true);
		}
	}
	key->used = 0;
	for (uint32_t e = 0; e < r->count; e++)
		if (r->first[e] <= k)
			key->used += cost_in(r, key, e);
}

/* Pixels covered and in the reference, covered and not in it, in the reference. */
struct tally { uint64_t right, wrong, wanted; };

LOD_CLONES static void count_words(struct tally *tally, uint64_t (*covered)[2], const uint64_t *reference,
	uint32_t words)
{
	for (uint32_t w = 0; w < words; w++) {
		tally->right += lod_bits_of(covered[w][0] & reference[w]);
		tally->wrong += lod_bits_of(covered[w][0] & ~reference[w]);
	}
}

/* 1 - Q; sets the values of pixels. */
static double loss_of(const struct tally *tally, struct key *key)
{
	double covered = fmax(1, (double)(tally->right + tally->wrong)), all = fmax(1, (double)tally->wanted);
	double lost_p = (double)tally->wrong / covered, lost_r = 1 - (double)tally->right / all;
	double lost = fmax(1e-6, sqrt(lost_p * lost_p + lost_r * lost_r));
	key->right = lost_p / lost * (double)tally->wrong / covered / covered + lost_r / lost / all;
	key->wrong = lost_p / lost * (double)tally->right / covered / covered;
	key->second = key->right * SECOND;
	return lost;
}

static double measure(struct key *key, uint32_t stride)
{
	const struct lod_sights *sights = &key->level->sights;
	struct tally tally = { 0 };
	for (uint32_t v = 0; v < sights->count; v += stride) {
		for (uint32_t w = 0; w < sights->words; w++) {
			const uint64_t *p = key->planes[v][w];
			key->trial[w][0] = p[0] | p[1] | p[2] | p[3];
		}
		count_words(&tally, key->trial, sights->reference[v], sights->words);
		tally.wanted += sights->reference_pixels[v];
	}
	return loss_of(&tally, key);
}

/* ---- Scales ---- */

static void set_scale(struct key *key, double scale)
{
	key->scale = scale;
	lod_crown_set_scale(&key->edges, scale, key->points);
}

static uint32_t trial_stride(const struct key *key)
{
	return key->level->sights.count > 2 * TRIAL_STRIDE ? TRIAL_STRIDE : 1;
}

/* A trial needs only whether a pixel is covered: counted pictures stay as they are. */
static double try_scale(const struct refine *r, uint32_t k, struct key *key, double scale)
{
	const struct lod_sights *sights = &key->level->sights;
	struct lod_crown_edges edges;
	struct lod_fan_seen seen;
	struct tally tally = { 0 };
	lod_crown_set_scale(&edges, scale, key->points);
	for (uint32_t v = 0; v < sights->count; v += trial_stride(key)) {
		const struct lod_canvas canvas = { sights->words / sights->pixels, sights->reference[v],
			key->trial };
		for (uint32_t w = 0; w < sights->words; w++)
			key->trial[w][0] = key->trial[w][1] = sights->wood[v][w];
		for (uint32_t e = 0; e < r->count; e++) {
			if (r->first[e] > k)
				continue;
			lod_crown_see(r->crown, &seen, e, v, key->points);
			lod_fan_add(&seen, edges.edge[r->code[e]], sights->pixels, &canvas);
		}
		count_words(&tally, key->trial, sights->reference[v], sights->words);
		tally.wanted += sights->reference_pixels[v];
	}
	return loss_of(&tally, key);
}

/* Climbs from the present scale. */
static void fit_scale(void *pieces, uint32_t k)
{
	struct refine *r = pieces;
	struct key *key = &r->keys[k += r->key_at];
	double best_scale = key->scale, least = key->drawn ? measure(key, trial_stride(key))
		: try_scale(r, k, key, best_scale);
	for (int way = 1; way >= -1; way -= 2) {
		bool moved = false;
		for (uint32_t i = 0; i < 8; i++) {
			double scale = 1 + (best_scale - 1) * (way > 0 ? r->stretch : 1 / r->stretch),
				loss = try_scale(r, k, key, scale);
			if (!(loss < least))
				break;
			least = loss;
			best_scale = scale;
			moved = true;
		}
		if (moved)
			break;
	}
	if (best_scale != key->scale || !key->drawn) {
		set_scale(key, best_scale);
		redraw(r, key, k);
		key->drawn = true;
	}
	measure(key, 1);
}

/* ---- The value of an element ---- */

struct worth { double of[KEYS][ECO_GROWTHS]; };

static inline uint64_t bits_at(const struct print *print, uint32_t y, uint32_t word)
{
	if (!print || y - print->y >= print->rows || word - print->word >= print->words)
		return 0;
	return print->bits[(size_t)(y - print->y) * print->words + word - print->word];
}

/* `own`: the element's present footprint, which is subtracted; or NULL. */
LOD_CLONES static double gain(const struct key *key, uint32_t view, const struct print *print,
	const struct print *own)
{
	const struct lod_canvas *canvas = &key->level->canvas[view];
	const uint64_t *bits = print->bits;
	uint32_t right = 0, wrong = 0, second = 0;
	for (uint32_t y = 0; y < print->rows; y++) {
		size_t at = (size_t)(print->y + y) * canvas->row_words + print->word;
		for (uint32_t w = 0; w < print->words; w++, bits++) {
			if (!*bits)
				continue;
			const uint64_t *p = key->planes[view][at + w], reference = canvas->reference[at + w],
				many = p[2] | p[3];
			uint64_t mine = bits_at(own, print->y + y, print->word + w),
				one = p[0] & ~p[1] & ~many, two = p[1] & ~p[0] & ~many;
			uint64_t free = *bits & ((~(p[0] | p[1] | many)) | (one & mine)),
				once = *bits & ((one & ~mine) | (two & mine)) & reference;
			right += lod_bits_of(free & reference);
			wrong += lod_bits_of(free & ~reference);
			second += lod_bits_of(once);
		}
	}
	return right * key->right - wrong * key->wrong + second * key->second;
}

/* The keys and codes of a look. From `settled` on every choice draws the element, so only codes matter. */
struct look { uint32_t element, low_key, end_key, settled, low_code, high_code; };

static void look_in_key(const struct refine *r, const struct look *l, uint32_t k, uint32_t view,
	struct prints *prints, double worth[ECO_GROWTHS])
{
	const struct key *key = &r->keys[k];
	if (k >= l->settled && key->edges.step[l->low_code] == key->edges.step[l->high_code])
		return;
	make_room(prints);
	const struct print *own = r->first[l->element] <= k ? find_print(prints, key, r->code[l->element])
		: NULL;
	double brings = 0;
	for (uint32_t c = l->low_code; c <= l->high_code; c++) {
		if (c == l->low_code || key->edges.step[c] != key->edges.step[c - 1])
			brings = gain(key, view, find_print(prints, key, c), own);
		worth[c] += brings;
	}
}

static void look(const struct refine *r, const struct look *l, struct worth *worth)
{
	struct prints prints;
	memset(worth, 0, sizeof *worth);
	for (uint32_t v = 0; v < r->crown->views; v++) {
		see(r, &prints, l->element, v);
		for (uint32_t k = l->low_key; k < l->end_key; k++) {
			const struct key *key = &r->keys[k];
			if (k == l->low_key || key->level != key[-1].level)
				forget_prints(&prints, key->level->sights.pixels);
			look_in_key(r, l, k, v, &prints, worth->of[k]);
		}
	}
}

/* Chooses key and code; keeps the present ones unless others are better. */
static void choose(struct refine *r, uint32_t element)
{
	struct worth worth;
	uint32_t first = r->first[element], code = r->code[element], best_first = first, best_code = code;
	uint32_t low_key = first > 0 ? first - 1 : 0, high_key = first < r->key_count ? first + 1 : first;
	uint32_t low_code = code > 0 ? code - 1 : 0, high_code = code + 1 < ECO_GROWTHS ? code + 1 : code;
	double triangles = triangles_of(r, element), best = -INFINITY;
	look(r, &(struct look){ element, low_key, r->key_count, high_key, low_code, high_code }, &worth);
	for (uint32_t c = low_code; c <= high_code; c++) {
		double sum = 0;
		for (uint32_t k = r->key_count + 1; k-- > low_key;) {
			if (k < r->key_count)
				sum += worth.of[k][c] - r->keys[k].price * cost_in(r, &r->keys[k], element);
			if (k <= high_key && (sum > best || (sum == best && c == code && k == first))) {
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

/* An element that stayed twice rests for one sweep. */
static void look_again(struct refine *r, uint32_t element)
{
	if (r->stays[element] < RESTS) {
		choose(r, element);
		return;
	}
	r->next_first[element] = r->first[element];
	r->next_code[element] = r->code[element];
	r->stays[element] = 0;
}

static void choose_piece(void *pieces, uint32_t i)
{
	struct refine *r = pieces;
	uint32_t begin = r->at + i * PIECE, end = begin + PIECE < r->end ? begin + PIECE : r->end;
	for (uint32_t t = begin; t < end; t++)
		look_again(r, r->turn[t]);
}

static void apply_in_view(const struct refine *r, uint32_t element, uint32_t view, struct prints *prints)
{
	uint32_t first = r->next_first[element], code = r->next_code[element],
		from = first < r->first[element] ? first : r->first[element];
	see(r, prints, element, view);
	for (uint32_t k = from; k < r->key_count; k++) {
		const struct key *key = &r->keys[k];
		bool was = r->first[element] <= k, is = first <= k,
			other = key->edges.step[code] != key->edges.step[r->code[element]];
		if (k == from || key->level != key[-1].level)
			forget_prints(prints, key->level->sights.pixels);
		make_room(prints);
		if (was && (!is || other))
			draw(key, view, find_print(prints, key, r->code[element]), false);
		if (is && (!was || other))
			draw(key, view, find_print(prints, key, code), true);
	}
}

static bool moves(const struct refine *r, uint32_t element)
{
	return r->next_first[element] != r->first[element] || r->next_code[element] != r->code[element];
}

static void apply_piece(void *pieces, uint32_t i)
{
	const struct refine *r = pieces;
	struct prints prints;
	for (uint32_t view = i; view < r->crown->views; view += APPLY_PIECES)
		for (uint32_t t = r->at; t < r->end; t++)
			if (moves(r, r->turn[t]))
				apply_in_view(r, r->turn[t], view, &prints);
}

static void apply(struct refine *r)
{
	run(r, APPLY_PIECES, apply_piece);
	for (uint32_t t = r->at; t < r->end; t++) {
		uint32_t element = r->turn[t];
		for (uint32_t k = 0; k < r->key_count; k++) {
			uint64_t cost = cost_in(r, &r->keys[k], element);
			r->keys[k].used += cost * (r->next_first[element] <= k);
			r->keys[k].used -= cost * (r->first[element] <= k);
		}
		r->stays[element] = moves(r, element) ? 0 : (uint8_t)(r->stays[element] + 1);
		r->first[element] = r->next_first[element];
		r->code[element] = r->next_code[element];
	}
}

/* ---- Sweeps ---- */

/* A key's price: the mean gain of elements near the end of its list. */
static void set_price(void *pieces, uint32_t k)
{
	struct refine *r = pieces;
	struct key *key = &r->keys[k += r->key_at];
	uint32_t begin = key->elements - (key->elements + 9) / 10, end = key->elements + key->elements / 10,
		samples = 0;
	end = end < r->count ? end : r->count;
	double sum = 0;
	for (uint32_t i = begin; i < end; i += (end - begin) / 200 + 1, samples++) {
		struct worth worth;
		uint32_t element = r->in->order[i], code = r->code[element];
		look(r, &(struct look){ element, k, k + 1, KEYS, code, code }, &worth);
		sum += worth.of[k][code] / cost_in(r, key, element);
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
	return !options->progress
		|| options->progress(options->ctx, LOD_RANK_REFINE_FROM + (1 - LOD_RANK_REFINE_FROM) * share);
}

/* Runs a piece for each key, two at a time. */
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
		apply(r);
		follow_budgets(r);
		if (!goes_on(r, (number + (double)r->at / r->count) / sweeps))
			return false;
	}
	for (struct key *key = r->keys; key < r->keys + r->key_count; key++)
		key->base_price += (key->price - key->base_price) * 0.7; /* the price that kept the budget */
	return true;
}

/* ---- In and out ---- */

static void open_keys(struct refine *r, struct lod_arena *arena)
{
	uint64_t total = 0, sum = 0;
	uint32_t i = 0;
	for (uint32_t e = 0; e < r->count; e++)
		total += triangles_of(r, e);
	const struct place *places = r->in->many_points ? many_points : few_points;
	for (const struct place *place = places; place < places + KEYS; place++) {
		struct key *key = &r->keys[r->key_count];
		for (; i + 1 < r->count && (double)sum < place->share * (double)total; i++) {
			sum += triangles_of(r, r->in->order[i]);
			r->first[r->in->order[i]] = (uint8_t)r->key_count;
		}
		if (i < KEY_LEAST || (r->key_count && i == key[-1].elements)
				|| (place->points && r->in->options->leaves))
			continue;
		key->elements = i;
		key->points = place->points;
		key->budget = key->points ? i : sum;
		lod_crown_set_level(r->crown, i);
		key->level = r->crown->level;
		key->planes = lod_arena_take(arena, r->crown->views, sizeof *key->planes);
		for (uint32_t v = 0; v < r->crown->views; v++)
			key->planes[v] = lod_arena_take(arena, key->level->sights.words,
				sizeof *key->planes[v]);
		key->trial = lod_arena_take(arena, key->level->sights.words, sizeof *key->trial);
		double cook = (double)r->count / i;
		set_scale(key, sqrt(cook * (1 + cook) / 2));
		r->key_count++;
	}
	for (; i < r->count; i++)
		r->first[r->in->order[i]] = (uint8_t)r->key_count;
}

/* Sorts by keys, and between two keys by the gain at the first of them. Elements that all keys draw keep
 * their order. */
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
				items[found++] = (struct lod_keyed){ k > 0 ? ~lod_sort_key(r->early[e])
					: old[e], e };
		lod_sort(arena, items, found);
		for (uint32_t i = 0; i < found; i++)
			r->in->order[done++] = items[i].value;
	}
	memcpy(r->in->growth, r->code, r->count);
}

static bool make_sweeps(struct refine *r)
{
	uint32_t most = SWEEPS - 1,
		more = LOOKED / r->count;
	uint32_t sweeps = 1 + (more < most ? more : most);
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
	r.stays = lod_arena_take(arena, r.count, sizeof *r.stays);
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
