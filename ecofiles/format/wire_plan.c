/* Plans on the wire: what is coded, and against what, stands in wire.h. One function a field writes and
 * reads it (ecofiles/base/range.h), so that both ways agree.
 *
 * Most fields are those of an item before, because a sorted plan repeats itself: from one band to the next
 * a rule changes its end and its scale, and the bands, shares and scales of one organ are those of the next.
 *
 * The reader checks what it needs to go on, leaves the rest to eco_plan_check, and finally writes the plan
 * again: bytes that differ from the input were another encoding of the same plan. */
#include "ecofiles/format/wire.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/range.h"

#define ITEMS_A_BYTE 32u         /* of a plan at most, so that memory is in proportion to bytes */
#define ITEMS_FREE 64u           /* and so many whatever its size is */

/* ---- Numbers ---- */

#define SIZES 64u
#define MODELLED 3u              /* bits below the highest that have models, in numbers of few bits */

struct number { struct eco_bit size[SIZES], low[6][1u << MODELLED]; };

struct coder {
	struct eco_range range;
	bool bad;                                /* what was read is out of range */
};

/* 6 bits for how many there are, then those below the highest; value < 2^63. */
static uint64_t code_number(struct coder *c, struct number *n, uint64_t value)
{
	unsigned bits = eco_bit_length(value);
	bits = eco_range_tree(&c->range, n->size, 6, bits);
	if (bits < 2)
		return bits;
	unsigned below = bits - 1, modelled = below < MODELLED ? below : MODELLED, raw = below - modelled;
	unsigned slot = bits < 7 ? bits - 2 : 5;
	uint64_t high = eco_range_tree(&c->range, n->low[slot], modelled,
		(uint32_t)(value >> raw) & ((1u << modelled) - 1));
	return (1ull << modelled | high) << raw | eco_range_raw(&c->range, raw, value & ((1ull << raw) - 1));
}

static uint32_t code_u32(struct coder *c, struct number *n, uint32_t value)
{
	uint64_t v = code_number(c, n, value);
	c->bad |= v > UINT32_MAX;
	return (uint32_t)v;
}

/* A value by its difference to another, both modulo 2^32. */
static uint32_t code_step(struct coder *c, struct number *n, uint32_t before, uint32_t value)
{
	return before + eco_unzigzag(code_u32(c, n, eco_zigzag(value - before)));
}

static double code_f64(struct coder *c, double value)
{
	uint64_t bits;
	memcpy(&bits, &value, sizeof bits);
	bits = eco_range_raw(&c->range, 64, bits);
	memcpy(&value, &bits, sizeof value);
	return value;
}

static unsigned code_form(struct coder *c, struct eco_bit *models, unsigned bits, unsigned form)
{
	return eco_range_tree(&c->range, models, bits, form);
}

/* ---- Scales ---- */

#define DROPPED_BITS 17u                 /* of a float's 23 behind the leading one */
#define SHORT_BASE ((127u - 8u) << (23 - DROPPED_BITS))
#define SHORT_END ((127u + 24u) << (23 - DROPPED_BITS))

static uint32_t float_bits(float v)
{
	uint32_t bits;
	memcpy(&bits, &v, sizeof bits);
	return bits;
}

static float bits_float(uint32_t bits)
{
	float v;
	memcpy(&v, &bits, sizeof v);
	return v;
}

float eco_wire_scale_round(float scale)
{
	uint32_t bits = float_bits(scale), half = 1u << (DROPPED_BITS - 1);
	if (!isfinite(scale))
		return scale;
	/* to nearest, ties to even; a carry into the exponent is the right result */
	bits += half - 1 + (bits >> DROPPED_BITS & 1);
	return bits_float(bits & ~((1u << DROPPED_BITS) - 1));
}

static bool is_short(float scale)
{
	uint32_t bits = float_bits(scale), code = bits >> DROPPED_BITS;
	return code << DROPPED_BITS == bits && code >= SHORT_BASE && code < SHORT_END;
}

/* ---- Placements ---- */

#define MILLIMETRES_MAX INT64_C(1000000000000000)        /* 1e12 m, see eco_view_check */
enum place_scale { PLACE_ONE, PLACE_F32, PLACE_F64 };

struct place_models { struct number step, path; struct eco_bit whole, turn, path_there, scale[4]; };

/* Division rounds correctly, so a position written with up to three decimals is such a quotient to the
 * last bit. */
static bool whole_millimetres(double v, int64_t *millimetres)
{
	if (!(fabs(v) <= 1e12))
		return false;
	*millimetres = (int64_t)floor(v * 1000 + 0.5);
	return (double)*millimetres / 1000.0 == v && !(v == 0 && signbit(v));
}

static double code_axis(struct coder *c, struct place_models *m, int64_t *last, double value)
{
	int64_t millimetres = 0;
	if (eco_range_bit(&c->range, &m->whole, !whole_millimetres(value, &millimetres)))
		return code_f64(c, value);
	int64_t step = millimetres - *last;
	uint64_t zigzag = code_number(c, &m->step, (uint64_t)step << 1 ^ (step < 0 ? UINT64_MAX : 0));
	*last += (int64_t)(zigzag >> 1) ^ -(int64_t)(zigzag & 1);
	c->bad |= *last < -MILLIMETRES_MAX || *last > MILLIMETRES_MAX;
	if (c->bad)
		*last = 0;
	return (double)*last / 1000.0;
}

static void code_placement(struct coder *c, struct place_models *m, int64_t last[3], struct eco_placement *p)
{
	enum place_scale form = p->scale == 1 ? PLACE_ONE : (double)(float)p->scale == p->scale ? PLACE_F32
		: PLACE_F64;
	for (int axis = 0; axis < 3; axis++)
		p->at[axis] = code_axis(c, m, &last[axis], p->at[axis]);
	if (eco_range_bit(&c->range, &m->turn, p->turn != 0))
		p->turn = (uint16_t)eco_range_raw(&c->range, 16, p->turn);
	if (eco_range_bit(&c->range, &m->path_there, p->path != 0))
		p->path = (uint32_t)eco_range_raw(&c->range, 32, p->path);
	form = code_form(c, m->scale, 2, form);
	if (form == PLACE_F32)
		p->scale = (double)bits_float((uint32_t)eco_range_raw(&c->range, 32,
			float_bits((float)p->scale)));
	else
		p->scale = form == PLACE_F64 ? code_f64(c, p->scale) : 1;
}

/* ---- Runs and gates ---- */

struct run_models { struct number place, jump, step, size; struct eco_bit moved, left_there, left_again; };

/* `first`: of the first run of the placement before. */
static void code_run(struct coder *c, struct run_models *m, const struct eco_run *before, uint32_t *first,
	struct eco_run *run)
{
	bool moved = !before || run->placement != before->placement;
	if (before)
		moved = eco_range_bit(&c->range, &m->moved, moved);
	if (moved) {             /* placements of one nested eco file begin with the same list */
		uint32_t from = before ? before->placement + 1 : 0;
		run->placement = from + code_u32(c, &m->place, run->placement - from);
		*first = run->list_first = code_step(c, &m->jump, *first, run->list_first);
	} else {
		run->placement = before->placement;
		run->list_first = before->list_end
			+ code_u32(c, &m->step, run->list_first - before->list_end);
	}
	run->list_end = run->list_first + 1 + code_u32(c, &m->size, run->list_end - run->list_first - 1);
	uint32_t last = before ? before->left : 0;
	if (!eco_range_bit(&c->range, &m->left_again, run->left != last))
		run->left = last;
	else if (eco_range_bit(&c->range, &m->left_there, run->left != 0))
		run->left = (uint32_t)eco_range_raw(&c->range, 16, run->left);
	else
		run->left = 0;
}

struct gate_models { struct number plant; struct eco_bit within, band[256]; };

static void code_gate(struct coder *c, struct gate_models *m, const struct eco_gate *before,
	struct eco_gate *gate)
{
	uint32_t from = before ? before->plant + 1 : 0, band = gate->end / ECO_SHARE_ONE,
		share = gate->end % ECO_SHARE_ONE;
	gate->plant = from + code_u32(c, &m->plant, gate->plant - from);
	band = eco_range_tree(&c->range, m->band, 8, band);
	if (eco_range_bit(&c->range, &m->within, share != 0))
		share = (uint32_t)eco_range_raw(&c->range, 16, share);
	else
		share = 0;
	gate->end = band * ECO_SHARE_ONE + share;
}

/* ---- Cuts ---- */

enum bands_form { BANDS_AGAIN, BANDS_NEXT, BANDS_SENT };
enum share_form { SHARE_ZERO, SHARE_FROM_END, SHARE_AGAIN, SHARE_SENT };
enum share_end_form { SHARE_TO_ONE, SHARE_TO_SAME, SHARE_TO_LAST, SHARE_TO_OLDER, SHARE_TO_OTHER };
enum first_form { FIRST_ZERO, FIRST_AGAIN, FIRST_FROM_END, FIRST_OTHER };
enum end_form { END_AGAIN, END_LEVEL, END_FOUR, END_BEFORE_LAST, END_OTHER };
enum scale_form { SCALE_ONE, SCALE_AGAIN, SCALE_OF_BAND, SCALE_NEAR, SCALE_FLOAT };

#define CONTEXTS 16u
struct cut_models {
	struct eco_bit moved[4], other[4], bands[CONTEXTS][4], share[CONTEXTS][4], share_end[CONTEXTS][8],
		first[CONTEXTS][4], end[CONTEXTS][8], scale[CONTEXTS][8], float_bits,
		halvings[ECO_HALVINGS_MAX + 1][8];
	struct number anchor, list[2], band_first[2], band_count[4], first_at, end_at[2], share_bits,
		scale_step;
};

/* Context that codes the next cut. */
struct cut_state {
	struct eco_cut before, older;
	uint32_t group_band;                     /* first band of the list before's first cut */
	float stated;                            /* the last scale but 1 */
	uint32_t end_form;
	struct { uint16_t last, older; float scale; } bands[ECO_BANDS + 1];  /* share ends, a scale */
};

/* The number of a level of splats: 4, 16, 64, ...; the first that is larger. */
static uint32_t level_above(uint32_t first)
{
	uint64_t level = 1;
	while (level <= first)
		level *= 4;
	return level > UINT32_MAX ? 0 : (uint32_t)level;
}

static bool code_owner(struct coder *c, struct cut_models *m, struct cut_state *s, bool once,
	struct eco_cut *cut)
{
	const struct eco_cut *b = &s->before;
	bool moved = once ? cut->placement != b->placement : cut->anchor != b->anchor;
	moved = eco_range_bit(&c->range, &m->moved[b->share_end == ECO_SHARE_ONE], moved);
	if (once) {
		cut->anchor = ECO_NONE;
		cut->placement = moved ? code_step(c, &m->anchor, b->placement, cut->placement)
			: b->placement;
	} else {
		/* the first rule's -1 wraps to 0 here: unsigned on purpose */
		cut->anchor = moved ? b->anchor + 1 + code_u32(c, &m->anchor, cut->anchor - b->anchor - 1)
			: b->anchor;
		cut->placement = 0;
		c->bad |= cut->anchor == ECO_NONE;
	}
	bool other = eco_range_bit(&c->range, &m->other[2 * moved + (b->share_end == ECO_SHARE_ONE)],
		cut->list != b->list);
	cut->list = other ? code_step(c, &m->list[moved], b->list, cut->list) : b->list;
	return moved || other;
}

static void code_bands(struct coder *c, struct cut_models *m, struct cut_state *s, bool fresh,
	struct eco_cut *cut)
{
	const struct eco_cut *b = &s->before;
	unsigned context = (fresh ? 8 : 0) | (b->share_end == ECO_SHARE_ONE ? 4 : 0) | (b->first > 0 ? 2 : 0)
		| (b->first == s->older.end ? 1 : 0);
	enum bands_form form = cut->band_first == b->band_first && cut->band_end == b->band_end ? BANDS_AGAIN
		: cut->band_first == b->band_end ? BANDS_NEXT : BANDS_SENT;
	form = code_form(c, m->bands[context], 2, form);
	if (form == BANDS_AGAIN) {
		cut->band_first = b->band_first;
		cut->band_end = b->band_end;
		return;
	}
	uint32_t first = form == BANDS_NEXT ? b->band_end : code_step(c, &m->band_first[fresh], fresh
		? s->group_band : b->band_end, cut->band_first);
	uint32_t count = code_u32(c, &m->band_count[2 * fresh + (form == BANDS_NEXT)],
		(uint32_t)(cut->band_end - cut->band_first - 1));
	c->bad |= first >= ECO_BANDS || count >= ECO_BANDS - first;
	if (c->bad)
		first = count = 0;
	cut->band_first = (uint8_t)first;
	cut->band_end = (uint8_t)(first + 1 + count);
}

/* A share's end in (0, ECO_SHARE_ONE): how many bits it has behind the point, then those but the last,
 * which is 1. */
static uint32_t code_share(struct coder *c, struct cut_models *m, uint32_t share)
{
	unsigned bits = share ? 16 - (unsigned)__builtin_ctz(share) : 0;
	bits = (unsigned)code_u32(c, &m->share_bits, bits);
	c->bad |= bits == 0 || bits > 16;
	if (c->bad)
		return 1;
	return ((uint32_t)eco_range_raw(&c->range, bits - 1, share >> (17 - bits)) << 1 | 1) << (16 - bits);
}

static void code_shares(struct coder *c, struct cut_models *m, struct cut_state *s, bool fresh,
	struct eco_cut *cut)
{
	const struct eco_cut *b = &s->before;
	bool same_bands = cut->band_first == b->band_first && cut->band_end == b->band_end;
	unsigned context = (fresh ? 4 : 0) | (b->share_end == ECO_SHARE_ONE ? 2 : 0) | same_bands
		| (b->first > 0 && b->first != s->older.end ? 8 : 0);
	enum share_form form = cut->share_first == 0 ? SHARE_ZERO : cut->share_first == b->share_end
		? SHARE_FROM_END : cut->share_first == b->share_first ? SHARE_AGAIN : SHARE_SENT;
	form = code_form(c, m->share[context], 2, form);
	cut->share_first = form == SHARE_ZERO ? 0 : form == SHARE_FROM_END ? b->share_end
		: form == SHARE_AGAIN ? b->share_first : code_share(c, m, cut->share_first);
	uint16_t *last = &s->bands[cut->band_first].last, *older = &s->bands[cut->band_first].older;
	enum share_end_form to = cut->share_end == ECO_SHARE_ONE ? SHARE_TO_ONE
		: cut->share_end == b->share_end ? SHARE_TO_SAME : cut->share_end == *last ? SHARE_TO_LAST
		: cut->share_end == *older ? SHARE_TO_OLDER : SHARE_TO_OTHER;
	context = form << 2 | same_bands << 1 | (b->share_end == ECO_SHARE_ONE);
	to = code_form(c, m->share_end[context], 3, to);
	c->bad |= to > SHARE_TO_OTHER;
	cut->share_end = to == SHARE_TO_ONE ? ECO_SHARE_ONE : to == SHARE_TO_SAME ? b->share_end
		: to == SHARE_TO_LAST ? *last : to == SHARE_TO_OLDER ? *older
		: code_share(c, m, cut->share_end);
	if (cut->share_end != ECO_SHARE_ONE && cut->share_end != *last) {
		*older = *last;
		*last = (uint16_t)cut->share_end;
	}
}

static void code_range(struct coder *c, struct cut_models *m, struct cut_state *s, bool fresh,
	struct eco_cut *cut)
{
	const struct eco_cut *b = &s->before;
	bool pair = cut->band_first == b->band_first && cut->share_first == b->share_first && !fresh;
	unsigned context = (fresh ? 4 : 0) | (b->first > 0 ? 2 : 0) | pair
		| (b->first == s->older.end && !fresh ? 8 : 0);
	enum first_form form = cut->first == 0 ? FIRST_ZERO : cut->first == b->first ? FIRST_AGAIN
		: cut->first == b->end ? FIRST_FROM_END : FIRST_OTHER;
	form = code_form(c, m->first[context], 2, form);
	cut->first = form == FIRST_ZERO ? 0 : form == FIRST_AGAIN ? b->first : form == FIRST_FROM_END ? b->end
		: code_u32(c, &m->first_at, cut->first);
	uint32_t four = 4 * b->first, level = level_above(cut->first);
	enum end_form to = cut->end == b->end ? END_AGAIN : cut->end == level ? END_LEVEL : cut->end == four
		? END_FOUR : cut->end == s->older.end ? END_BEFORE_LAST : END_OTHER;
	to = code_form(c, m->end[form << 2 | pair << 1 | (s->end_form == END_OTHER)], 3, to);
	c->bad |= to > END_OTHER;
	s->end_form = to;
	cut->end = to == END_AGAIN ? b->end : to == END_LEVEL ? level : to == END_FOUR ? four
		: to == END_BEFORE_LAST ? s->older.end
		: cut->first + 1 + code_u32(c, &m->end_at[fresh], cut->end - cut->first - 1);
}

static void code_scale(struct coder *c, struct cut_models *m, struct cut_state *s, bool fresh,
	struct eco_cut *cut)
{
	float stated = s->stated, of_band = s->bands[cut->band_first].scale;
	enum scale_form form = cut->scale == 1 ? SCALE_ONE : float_bits(cut->scale) == float_bits(stated)
		? SCALE_AGAIN : float_bits(cut->scale) == float_bits(of_band) ? SCALE_OF_BAND
		: is_short(cut->scale) ? SCALE_NEAR : SCALE_FLOAT;
	unsigned context = (fresh ? 4 : 0) | (s->before.scale == 1 ? 2 : 0) | (cut->first > 0);
	form = code_form(c, m->scale[context], 3, form);
	c->bad |= form > SCALE_FLOAT;
	if (form == SCALE_NEAR) {
		uint32_t from = float_bits(is_short(stated) ? stated : 1) >> DROPPED_BITS;
		uint32_t code = code_step(c, &m->scale_step, from, float_bits(cut->scale) >> DROPPED_BITS);
		c->bad |= code < SHORT_BASE || code >= SHORT_END;
		cut->scale = c->bad ? 1 : bits_float(code << DROPPED_BITS);
	} else if (form == SCALE_FLOAT) {
		cut->scale = bits_float((uint32_t)eco_range_raw(&c->range, 32, float_bits(cut->scale)));
	} else {
		cut->scale = form == SCALE_ONE ? 1 : form == SCALE_AGAIN ? stated : of_band;
	}
	if (cut->scale != 1)
		s->stated = s->bands[cut->band_first].scale = cut->scale;
}

static void code_cut(struct coder *c, struct cut_models *m, struct cut_state *s, bool once,
	struct eco_cut *cut)
{
	bool fresh = code_owner(c, m, s, once, cut);
	if (once) {
		cut->band_first = 0;
		cut->band_end = ECO_BANDS;
		cut->share_first = 0;
		cut->share_end = ECO_SHARE_ONE;
		cut->halvings = (uint8_t)code_form(c, m->halvings[s->before.halvings], 3, cut->halvings);
		c->bad |= cut->halvings > ECO_HALVINGS_MAX;
	} else {
		cut->halvings = 0;
		code_bands(c, m, s, fresh, cut);
		code_shares(c, m, s, fresh, cut);
	}
	code_range(c, m, s, fresh, cut);
	code_scale(c, m, s, fresh, cut);
	if (fresh)
		s->group_band = cut->band_first;
	s->older = s->before;
	s->before = *cut;
}

/* ---- The plan ---- */

struct models {
	struct place_models place;
	struct run_models run;
	struct gate_models gate;
	struct cut_models once, rule;
	struct number count, pixels;
	struct eco_bit whole;
};

#define PIXELS_MAX 1e14

/* Pixels that are sixteenths are usual, see eco_wire_pixels_round. */
static double code_pixels(struct coder *c, struct models *m, double value)
{
	bool sent = !(value >= 0 && value <= PIXELS_MAX && value == eco_wire_pixels_round(value)
		&& !(value == 0 && signbit(value)));
	if (eco_range_bit(&c->range, &m->whole, sent))
		return code_f64(c, value);
	return (double)code_number(c, &m->pixels, sent ? 0 : (uint64_t)(value * 16)) / 16;
}

double eco_wire_pixels_round(double pixels)
{
	return pixels >= 0 && pixels <= PIXELS_MAX ? floor(pixels * 16 + 0.5) / 16 : pixels;
}

static void code_head(struct coder *c, struct models *m, struct eco_plan *plan, uint32_t counts[5])
{
	plan->vertices = code_number(c, &m->count, plan->vertices);
	plan->prediction.tp = code_pixels(c, m, plan->prediction.tp);
	plan->prediction.fp = code_pixels(c, m, plan->prediction.fp);
	plan->prediction.fn = code_pixels(c, m, plan->prediction.fn);
	for (int i = 0; i < 5; i++)
		counts[i] = code_u32(c, &m->count, counts[i]);
}

/* Items that `counts` has: placements, runs, gates, cuts drawn once, rules. */
static void code_items(struct coder *c, struct models *m, struct eco_plan *plan, const uint32_t counts[5])
{
	int64_t last[3] = { 0 };
	uint32_t first_of_placement = 0;
	for (uint32_t i = 0; i < counts[0] && !c->bad; i++)
		code_placement(c, &m->place, last, &plan->placements[i]);
	for (uint32_t i = 0; i < counts[1] && !c->bad; i++)
		code_run(c, &m->run, i ? &plan->runs[i - 1] : NULL, &first_of_placement, &plan->runs[i]);
	for (uint32_t i = 0; i < counts[2] && !c->bad; i++)
		code_gate(c, &m->gate, i ? &plan->gates[i - 1] : NULL, &plan->gates[i]);
	/* before the first rule the anchor is -1, so that the step to anchor 0 is 1, as to any next one */
	struct cut_state once = { .before = { .share_end = ECO_SHARE_ONE }, .stated = 1 }, rules = once;
	rules.before.anchor = ECO_NONE;
	for (uint32_t i = 0; i < counts[3] && !c->bad; i++)
		code_cut(c, &m->once, &once, true, &plan->cuts[i]);
	for (uint32_t i = 0; i < counts[4] && !c->bad; i++)
		code_cut(c, &m->rule, &rules, false, &plan->cuts[counts[3] + i]);
}

static uint64_t sum_of(const uint32_t counts[5])
{
	uint64_t sum = 0;
	for (int i = 0; i < 5; i++)
		sum += counts[i];
	return sum;
}

static uint64_t items_max(size_t bytes) { return ITEMS_FREE + ITEMS_A_BYTE * (uint64_t)bytes; }

static void start_models(struct models *m)
{
	eco_bits_start((struct eco_bit *)m, sizeof *m / sizeof(struct eco_bit));
}

static void write_sorted(struct eco_writer *w, struct eco_plan *plan)
{
	struct models models;
	struct coder coder = { .bad = false };
	uint32_t once = 0;
	while (once < plan->cut_count && plan->cuts[once].anchor == ECO_NONE)
		once++;
	uint32_t counts[5] = { plan->placement_count, plan->run_count, plan->gate_count, once,
		plan->cut_count - once };
	size_t start = w->size;
	start_models(&models);
	eco_write_u8(w, 0);
	eco_range_write(&coder.range, w);
	code_head(&coder, &models, plan, counts);
	code_items(&coder, &models, plan, counts);
	uint32_t zeros = eco_range_end(&coder.range);
	while (sum_of(counts) > items_max(w->size - start) && !w->failed)
		eco_write_u8(w, 0);
	if (!w->failed)
		w->bytes[start] = (uint8_t)zeros;
}

static void *copy_of(const void *items, uint32_t count, size_t size)
{
	void *copy = malloc(count ? count * size : 1);
	if (copy && count)
		memcpy(copy, items, count * size);
	return copy;
}

void eco_wire_write_plan(struct eco_writer *w, const struct eco_plan *plan)
{
	struct eco_plan sorted = *plan;
	sorted.placements = copy_of(plan->placements, plan->placement_count, sizeof *plan->placements);
	sorted.runs = copy_of(plan->runs, plan->run_count, sizeof *plan->runs);
	sorted.gates = copy_of(plan->gates, plan->gate_count, sizeof *plan->gates);
	sorted.cuts = copy_of(plan->cuts, plan->cut_count, sizeof *plan->cuts);
	if (sorted.placements && sorted.runs && sorted.gates && sorted.cuts) {
		eco_plan_sort(&sorted);
		if (eco_plan_check(&sorted, NULL) == ECO_OK)
			write_sorted(w, &sorted);
		else
			w->failed = true;
	} else {
		w->failed = true;
	}
	eco_plan_free(&sorted);
}

uint64_t eco_wire_plan_bytes(const struct eco_plan *plan)
{
	struct eco_writer w = { 0 };
	eco_wire_write_plan(&w, plan);
	uint64_t size = w.size;
	eco_writer_free(&w);
	return size;
}

static bool room_for(struct eco_plan *plan, const uint32_t counts[5])
{
	plan->placements = calloc(counts[0] + (size_t)1, sizeof *plan->placements);
	plan->runs = calloc(counts[1] + (size_t)1, sizeof *plan->runs);
	plan->gates = calloc(counts[2] + (size_t)1, sizeof *plan->gates);
	plan->cuts = calloc(counts[3] + (size_t)counts[4] + 1, sizeof *plan->cuts);
	plan->placement_count = counts[0];
	plan->run_count = counts[1];
	plan->gate_count = counts[2];
	plan->cut_count = counts[3] + counts[4];
	return plan->placements && plan->runs && plan->gates && plan->cuts;
}

static enum eco_code read_fields(const uint8_t *bytes, size_t size, struct eco_plan *plan,
	struct eco_error *error)
{
	struct models models;
	struct coder coder = { .bad = false };
	uint32_t counts[5] = { 0 };
	start_models(&models);
	eco_range_read(&coder.range, bytes + 1, size - 1);
	code_head(&coder, &models, plan, counts);
	if (coder.bad || sum_of(counts) > items_max(size) || sum_of(counts) > ECO_PLAN_ITEMS_MAX)
		return eco_fail(error, ECO_DAMAGED, "the plan ends early, or a number in it is out of range: "
			"%llu items in %zu bytes", (unsigned long long)sum_of(counts), size);
	if (!room_for(plan, counts))
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a plan of %zu bytes", size);
	code_items(&coder, &models, plan, counts);
	if (coder.bad)
		return eco_fail(error, ECO_DAMAGED, "a number in the plan is out of range, near its byte %zu",
			coder.range.at);
	return ECO_OK;
}

static enum eco_code check_spelling(const uint8_t *bytes, size_t size, struct eco_plan *plan,
	struct eco_error *error)
{
	struct eco_writer again = { 0 };
	write_sorted(&again, plan);
	bool failed = again.failed, same = again.size == size && memcmp(again.bytes, bytes, size) == 0;
	eco_writer_free(&again);
	if (failed)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a plan of %zu bytes", size);
	return same ? ECO_OK : eco_fail(error, ECO_DAMAGED, "the plan is not in its one encoding");
}

enum eco_code eco_wire_read_plan(struct eco_reader *r, struct eco_plan *plan, struct eco_error *error)
{
	size_t size = r->size - r->at;
	const uint8_t *bytes = eco_read_bytes(r, size);
	*plan = (struct eco_plan){ 0 };
	if (!bytes || size == 0)
		return eco_fail(error, ECO_DAMAGED, "the plan ends early: it has %zu bytes", size);
	enum eco_code code = read_fields(bytes, size, plan, error);
	code = code ? code : eco_plan_check(plan, error);
	code = code ? code : check_spelling(bytes, size, plan, error);
	if (code)
		eco_plan_free(plan);
	return code;
}
