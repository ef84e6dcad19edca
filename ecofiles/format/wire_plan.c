/* Plans on the wire: byte layout in wire.h. Writer and reader stand below in pairs, field by field, in the
 * order of the layout.
 *
 * Most fields are differences to the item before, because a sorted plan repeats itself: from one band to
 * the next a rule changes its end and its scale, and the point half of a blend only its begin.
 *
 * The reader checks what it needs to go on, leaves the rest to eco_plan_check, and finally writes the plan
 * again: bytes that differ from the input were another encoding of the same plan. This comparison replaces
 * a test in each field's reader, and finds any disagreement between writer and reader. */
#include "ecofiles/format/wire.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Scales ---- */

enum scale_form { SCALE_ONE, SCALE_AGAIN, SCALE_SHORT, SCALE_FLOAT };

#define SHORT_DROPPED_BITS 12u                           /* of a float's 23 behind the leading one */
#define SHORT_BASE ((127u - 8u) << (23 - SHORT_DROPPED_BITS))

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
	uint32_t bits = float_bits(scale), half = 1u << (SHORT_DROPPED_BITS - 1);
	if (!isfinite(scale))
		return scale;
	/* to nearest, ties to even; a carry into the exponent is the right result */
	bits += half - 1 + (bits >> SHORT_DROPPED_BITS & 1);
	return bits_float(bits & ~((1u << SHORT_DROPPED_BITS) - 1));
}

static bool short_code(float scale, uint16_t *code)
{
	uint32_t bits = float_bits(scale), shifted = bits >> SHORT_DROPPED_BITS;
	if (shifted << SHORT_DROPPED_BITS != bits || shifted < SHORT_BASE
			|| shifted - SHORT_BASE > UINT16_MAX)
		return false;
	*code = (uint16_t)(shifted - SHORT_BASE);
	return true;
}

static enum scale_form scale_form(float scale, float stated)
{
	uint16_t code;
	if (scale == 1)
		return SCALE_ONE;
	if (float_bits(scale) == float_bits(stated))
		return SCALE_AGAIN;
	return short_code(scale, &code) ? SCALE_SHORT : SCALE_FLOAT;
}

static void write_scale(struct eco_writer *w, enum scale_form form, float scale, float *stated)
{
	uint16_t code = 0;
	if (form < SCALE_SHORT)
		return;
	*stated = scale;
	if (form == SCALE_FLOAT)
		eco_write_f32(w, scale);
	else if (short_code(scale, &code))
		eco_write_u16(w, code);
}

static float read_scale(struct eco_reader *r, enum scale_form form, float *stated)
{
	if (form == SCALE_ONE)
		return 1;
	if (form == SCALE_SHORT)
		*stated = bits_float((eco_read_u16(r) + SHORT_BASE) << SHORT_DROPPED_BITS);
	else if (form == SCALE_FLOAT)
		*stated = eco_read_f32(r);
	return *stated;
}

/* ---- Placements ---- */

#define MILLIMETRES_MAX INT64_C(1000000000000000)        /* 1e12 m, see eco_view_check */
enum { PLACE_TURN = 8, PLACE_PATH = 16, PLACE_SCALE_SHIFT = 5, PLACE_SCALE_F32 = 1, PLACE_SCALE_F64 = 2 };

/* Division rounds correctly, so a position written with up to three decimals is such a quotient to the
 * last bit. */
static bool whole_millimetres(double v, int64_t *millimetres)
{
	if (!(fabs(v) <= 1e12))
		return false;
	*millimetres = (int64_t)floor(v * 1000 + 0.5);
	return (double)*millimetres / 1000.0 == v && !(v == 0 && signbit(v));
}

static uint8_t placement_head(const struct eco_placement *p)
{
	int64_t unused;
	unsigned head = 0;
	for (int axis = 0; axis < 3; axis++)
		head |= whole_millimetres(p->at[axis], &unused) ? 1u << axis : 0;
	head |= p->turn ? PLACE_TURN : 0;
	head |= p->path ? PLACE_PATH : 0;
	if (p->scale != 1)
		head |= ((float)p->scale == p->scale ? PLACE_SCALE_F32 : PLACE_SCALE_F64)
			<< PLACE_SCALE_SHIFT;
	return (uint8_t)head;
}

static void write_placements(struct eco_writer *w, const struct eco_plan *plan)
{
	int64_t last[3] = { 0 }, millimetres;
	eco_write_varint(w, plan->placement_count);
	for (uint32_t i = 0; i < plan->placement_count; i++) {
		const struct eco_placement *p = &plan->placements[i];
		uint8_t head = placement_head(p);
		eco_write_u8(w, head);
		for (int axis = 0; axis < 3; axis++) {
			if (whole_millimetres(p->at[axis], &millimetres)) {
				eco_write_zigzag(w, millimetres - last[axis]);
				last[axis] = millimetres;
			} else {
				eco_write_f64(w, p->at[axis]);
			}
		}
		if (head & PLACE_TURN)
			eco_write_u16(w, p->turn);
		if (head & PLACE_PATH)
			eco_write_u32(w, p->path);
		if (head >> PLACE_SCALE_SHIFT == PLACE_SCALE_F32)
			eco_write_f32(w, (float)p->scale);
		if (head >> PLACE_SCALE_SHIFT == PLACE_SCALE_F64)
			eco_write_f64(w, p->scale);
	}
}

static double read_axis(struct eco_reader *r, bool whole, int64_t *last)
{
	if (!whole)
		return eco_read_f64(r);
	int64_t step = eco_read_zigzag(r);
	if (step < -2 * MILLIMETRES_MAX || step > 2 * MILLIMETRES_MAX
			|| llabs(*last + step) > MILLIMETRES_MAX)
		r->failed = true;
	else
		*last += step;
	return (double)*last / 1000.0;
}

static void read_placements(struct eco_reader *r, struct eco_plan *plan)
{
	int64_t last[3] = { 0 };
	for (uint32_t i = 0; i < plan->placement_count && !r->failed; i++) {
		struct eco_placement *p = &plan->placements[i];
		unsigned head = eco_read_u8(r), scale = head >> PLACE_SCALE_SHIFT;
		for (int axis = 0; axis < 3; axis++)
			p->at[axis] = read_axis(r, head & 1u << axis, &last[axis]);
		p->turn = head & PLACE_TURN ? eco_read_u16(r) : 0;
		p->path = head & PLACE_PATH ? eco_read_u32(r) : 0;
		p->scale = scale == PLACE_SCALE_F32 ? eco_read_f32(r) : scale == PLACE_SCALE_F64
			? eco_read_f64(r) : 1;
	}
}

/* ---- Runs and gates ---- */

static uint64_t zigzag(int64_t v)
{
	return ((uint64_t)v << 1) ^ (v < 0 ? UINT64_MAX : 0);
}

static int64_t unzigzag(uint64_t v)
{
	return (int64_t)(v >> 1) ^ -(int64_t)(v & 1);
}

static void write_runs(struct eco_writer *w, const struct eco_plan *plan)
{
	uint32_t first_of_placement = 0;
	eco_write_varint(w, plan->run_count);
	for (uint32_t i = 0; i < plan->run_count; i++) {
		const struct eco_run *run = &plan->runs[i];
		if (i && run->placement == run[-1].placement) {
			eco_write_varint(w, (uint64_t)(run->list_first - run[-1].list_end) << 1);
		} else {
			/* placements of one nested eco file begin with the same list */
			eco_write_varint(w, zigzag((int64_t)run->list_first - first_of_placement) << 1 | 1);
			eco_write_varint(w, i ? run->placement - run[-1].placement - 1 : run->placement);
			first_of_placement = run->list_first;
		}
		eco_write_varint(w, (uint64_t)(run->list_end - run->list_first - 1) << 1 | (run->left > 0));
		if (run->left)
			eco_write_u16(w, (uint16_t)run->left);
	}
}

static uint32_t narrow(struct eco_reader *r, uint64_t v)
{
	if (v > UINT32_MAX)
		r->failed = true;
	return (uint32_t)v;
}

/* base + step; fails the reader where the sum is out of range. */
static uint32_t step_from(struct eco_reader *r, uint32_t base, int64_t step)
{
	if (step < -(int64_t)UINT32_MAX || step > (int64_t)UINT32_MAX) {
		r->failed = true;
		return base;
	}
	return narrow(r, (uint64_t)((int64_t)base + step));
}

static uint32_t read_narrow(struct eco_reader *r)
{
	return narrow(r, eco_read_varint(r));
}

static void read_runs(struct eco_reader *r, struct eco_plan *plan)
{
	uint32_t first_of_placement = 0;
	for (uint32_t i = 0; i < plan->run_count && !r->failed; i++) {
		struct eco_run *run = &plan->runs[i];
		uint64_t head = eco_read_varint(r);
		if (head & 1) {
			run->list_first = step_from(r, first_of_placement, unzigzag(head >> 1));
			uint64_t placement = eco_read_varint(r);
			run->placement = i ? step_from(r, run[-1].placement, (int64_t)(placement & INT64_MAX))
				+ 1 : narrow(r, placement);
			first_of_placement = run->list_first;
		} else if (i) {
			run->placement = run[-1].placement;
			run->list_first = step_from(r, run[-1].list_end, (int64_t)(head >> 1));
		} else {
			r->failed = true;
		}
		uint64_t rest = eco_read_varint(r);
		run->list_end = narrow(r, (uint64_t)run->list_first + 1 + narrow(r, rest >> 1));
		run->left = rest & 1 ? eco_read_u16(r) : 0;
	}
}

static void write_gates(struct eco_writer *w, const struct eco_plan *plan)
{
	eco_write_varint(w, plan->gate_count);
	for (uint32_t i = 0; i < plan->gate_count; i++) {
		const struct eco_gate *gate = &plan->gates[i];
		uint16_t share = (uint16_t)(gate->end % ECO_SHARE_ONE);
		eco_write_varint(w, (uint64_t)(i ? gate->plant - gate[-1].plant - 1 : gate->plant) << 1
			| (share > 0));
		eco_write_u8(w, (uint8_t)(gate->end / ECO_SHARE_ONE));
		if (share)
			eco_write_u16(w, share);
	}
}

static void read_gates(struct eco_reader *r, struct eco_plan *plan)
{
	for (uint32_t i = 0; i < plan->gate_count && !r->failed; i++) {
		struct eco_gate *gate = &plan->gates[i];
		uint64_t head = eco_read_varint(r);
		uint32_t step = narrow(r, head >> 1);
		gate->plant = i ? narrow(r, (uint64_t)gate[-1].plant + 1 + step) : step;
		gate->end = eco_read_u8(r) * ECO_SHARE_ONE;
		gate->end += head & 1 ? eco_read_u16(r) : 0;
	}
}

/* ---- Cuts ---- */

enum { CUT_ANCHOR = 1, CUT_LIST = 2, CUT_BANDS_SHIFT = 2, CUT_SCALE_SHIFT = 4, CUT_MORE = 64,
	CUT_END_AGAIN = 128 };
enum bands_form { BANDS_AGAIN, BANDS_NEXT, BANDS_FROM_END, BANDS_BOTH };
enum first_form { FIRST_ZERO, FIRST_AGAIN, FIRST_SENT };
enum share_form { SHARE_ALL, SHARE_AGAIN, SHARE_REST, SHARE_BOTH };

struct cut_state {
	struct eco_cut before;
	float stated;                    /* the last scale sent */
	bool summaries;
};

/* Before the first rule the anchor is -1 (ECO_NONE), so that the step to anchor 0 is 1, as to any next
 * anchor. */
static struct cut_state cut_state(bool summaries)
{
	return (struct cut_state){ .before = { .anchor = ECO_NONE, .share_end = 0 }, .stated = 1,
		.summaries = summaries };
}

static enum bands_form bands_form(const struct eco_cut *cut, const struct eco_cut *before)
{
	if (cut->band_first == before->band_first && cut->band_end == before->band_end)
		return BANDS_AGAIN;
	if (cut->band_first == before->band_end)
		return cut->band_end == cut->band_first + 1 ? BANDS_NEXT : BANDS_FROM_END;
	return BANDS_BOTH;
}

static enum first_form first_form(const struct eco_cut *cut, const struct eco_cut *before)
{
	return cut->first == 0 ? FIRST_ZERO : cut->first == before->first ? FIRST_AGAIN : FIRST_SENT;
}

static enum share_form share_form(const struct eco_cut *cut, const struct eco_cut *before)
{
	if (cut->share_first == 0 && cut->share_end == ECO_SHARE_ONE)
		return SHARE_ALL;
	if (cut->share_first == before->share_first && cut->share_end == before->share_end)
		return SHARE_AGAIN;
	return cut->share_first == before->share_end && cut->share_end == ECO_SHARE_ONE ? SHARE_REST
		: SHARE_BOTH;
}

static void write_bands(struct eco_writer *w, enum bands_form form, const struct eco_cut *cut)
{
	if (form == BANDS_BOTH)
		eco_write_u8(w, cut->band_first);
	if (form == BANDS_BOTH || form == BANDS_FROM_END)
		eco_write_u8(w, cut->band_end);
}

static void read_bands(struct eco_reader *r, enum bands_form form, struct eco_cut *cut,
	const struct eco_cut *before)
{
	cut->band_first = form == BANDS_AGAIN ? before->band_first : form == BANDS_BOTH ? eco_read_u8(r)
		: before->band_end;
	cut->band_end = form == BANDS_AGAIN ? before->band_end : form == BANDS_NEXT
		? (uint8_t)(before->band_end + 1) : eco_read_u8(r);
}

static void write_more(struct eco_writer *w, const struct eco_cut *cut, enum first_form first,
	enum share_form share)
{
	eco_write_u8(w, (uint8_t)(first | share << 2));
	if (first == FIRST_SENT)
		eco_write_varint(w, cut->first);
	if (share == SHARE_BOTH) {
		eco_write_u16(w, (uint16_t)cut->share_first);
		eco_write_u16(w, (uint16_t)(cut->share_end - 1));
	}
}

static void read_more(struct eco_reader *r, bool more, struct eco_cut *cut, const struct eco_cut *before)
{
	unsigned forms = more ? eco_read_u8(r) : 0;
	enum first_form first = forms & 3;
	enum share_form share = forms >> 2 & 3;
	cut->first = first == FIRST_SENT ? read_narrow(r) : first == FIRST_AGAIN ? before->first : 0;
	cut->share_first = share == SHARE_BOTH ? eco_read_u16(r) : share == SHARE_AGAIN
		? before->share_first :
		share == SHARE_REST ? before->share_end : 0;
	cut->share_end = share == SHARE_BOTH ? eco_read_u16(r) + 1u : share == SHARE_AGAIN ? before->share_end
		: ECO_SHARE_ONE;
}

static void write_cut(struct eco_writer *w, const struct eco_cut *cut, struct cut_state *state)
{
	const struct eco_cut *before = &state->before;
	bool moved = state->summaries ? cut->placement != before->placement : cut->anchor != before->anchor;
	enum bands_form bands = state->summaries ? BANDS_AGAIN : bands_form(cut, before);
	enum share_form share = state->summaries ? SHARE_ALL : share_form(cut, before);
	enum first_form first = first_form(cut, before);
	enum scale_form scale = scale_form(cut->scale, state->stated);
	bool more = first != FIRST_ZERO || share != SHARE_ALL;
	eco_write_u8(w,
		(uint8_t)((moved ? CUT_ANCHOR : 0) | (cut->list != before->list ? CUT_LIST : 0) | bands
		<< CUT_BANDS_SHIFT | scale << CUT_SCALE_SHIFT | (more ? CUT_MORE : 0)
		| (cut->end == before->end ? CUT_END_AGAIN : 0)));
	if (moved && state->summaries)
		eco_write_zigzag(w, (int64_t)cut->placement - before->placement);
	else if (moved)
		eco_write_varint(w, (uint32_t)(cut->anchor - before->anchor - 1));
	if (cut->list != before->list)
		eco_write_zigzag(w, (int64_t)cut->list - before->list);
	write_bands(w, bands, cut);
	if (more)
		write_more(w, cut, first, share);
	if (cut->end != before->end)
		eco_write_varint(w, cut->end - cut->first - 1);
	write_scale(w, scale, cut->scale, &state->stated);
	state->before = *cut;
}

static void read_cut(struct eco_reader *r, struct eco_cut *cut, struct cut_state *state)
{
	const struct eco_cut *before = &state->before;
	unsigned head = eco_read_u8(r);
	bool moved = head & CUT_ANCHOR;
	*cut = (struct eco_cut){ .placement = before->placement, .anchor = before->anchor };
	if (moved && state->summaries)
		cut->placement = step_from(r, before->placement, eco_read_zigzag(r));
	else if (moved)
		/* the first rule's -1 wraps to 0 here: unsigned on purpose */
		cut->anchor = narrow(r, (uint64_t)(uint32_t)(before->anchor + 1) + read_narrow(r));
	cut->list = head & CUT_LIST ? step_from(r, before->list, eco_read_zigzag(r)) : before->list;
	read_bands(r, head >> CUT_BANDS_SHIFT & 3, cut, before);
	read_more(r, head & CUT_MORE, cut, before);
	cut->end = head & CUT_END_AGAIN ? before->end : narrow(r, (uint64_t)cut->first + 1 + read_narrow(r));
	cut->scale = read_scale(r, head >> CUT_SCALE_SHIFT & 3, &state->stated);
	if (!state->summaries && cut->anchor == ECO_NONE)
		r->failed = true;
	state->before = *cut;
}

static void write_cuts(struct eco_writer *w, const struct eco_cut *cuts, uint32_t count, bool summaries)
{
	struct cut_state state = cut_state(summaries);
	eco_write_varint(w, count);
	for (uint32_t i = 0; i < count; i++)
		write_cut(w, &cuts[i], &state);
}

static void read_cuts(struct eco_reader *r, struct eco_cut *cuts, uint32_t count, bool summaries)
{
	struct cut_state state = cut_state(summaries);
	for (uint32_t i = 0; i < count && !r->failed; i++)
		read_cut(r, &cuts[i], &state);
	for (uint32_t i = 0; i < count && summaries; i++) {
		cuts[i].band_first = 0;
		cuts[i].band_end = ECO_BANDS;
		cuts[i].share_first = 0;
		cuts[i].share_end = ECO_SHARE_ONE;
	}
}

/* ---- The plan ---- */

static void write_sorted(struct eco_writer *w, const struct eco_plan *plan)
{
	uint32_t summaries = 0;
	while (summaries < plan->cut_count && plan->cuts[summaries].anchor == ECO_NONE)
		summaries++;
	eco_write_varint(w, plan->vertices);
	eco_write_varint(w, plan->visible_plants);
	eco_write_f64(w, plan->sample_distance);
	eco_write_f64(w, plan->prediction.tp);
	eco_write_f64(w, plan->prediction.fp);
	eco_write_f64(w, plan->prediction.fn);
	write_placements(w, plan);
	write_runs(w, plan);
	write_gates(w, plan);
	write_cuts(w, plan->cuts, summaries, true);
	write_cuts(w, plan->cuts ? plan->cuts + summaries : NULL, plan->cut_count - summaries, false);
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

/* Reads a count and allocates its items, if the reader still has `least` bytes for each. */
static void *read_items(struct eco_reader *r, uint32_t *count, size_t least, size_t size, bool *no_memory)
{
	uint64_t wanted = eco_read_varint(r);
	*count = 0;
	if (r->failed || wanted > ECO_PLAN_ITEMS_MAX || wanted > (r->size - r->at) / least) {
		r->failed = true;
		return NULL;
	}
	void *items = calloc(wanted ? wanted : 1, size);
	if (items)
		*count = (uint32_t)wanted;
	else
		*no_memory = r->failed = true;
	return items;
}

/* Cuts drawn once and rules are two counted arrays on the wire and one in the plan. */
static void read_all_cuts(struct eco_reader *r, struct eco_plan *plan, bool *no_memory)
{
	uint32_t summaries, rules;
	struct eco_cut *cuts = read_items(r, &summaries, 2, sizeof *cuts, no_memory);
	plan->cuts = cuts;
	plan->cut_count = summaries;
	if (r->failed)
		return;
	read_cuts(r, cuts, summaries, true);
	uint64_t wanted = eco_read_varint(r);
	if (r->failed || wanted > ECO_PLAN_ITEMS_MAX - summaries || wanted > r->size - r->at) {
		r->failed = true;
		return;
	}
	rules = (uint32_t)wanted;
	cuts = realloc(cuts, ((size_t)summaries + rules + 1) * sizeof *cuts);
	if (!cuts) {
		*no_memory = r->failed = true;
		return;
	}
	memset(cuts + summaries, 0, rules * sizeof *cuts);
	plan->cuts = cuts;
	plan->cut_count = summaries + rules;
	read_cuts(r, cuts + summaries, rules, false);
}

static void read_fields(struct eco_reader *r, struct eco_plan *plan, bool *no_memory)
{
	plan->vertices = eco_read_varint(r);
	plan->visible_plants = eco_read_varint(r);
	plan->sample_distance = eco_read_f64(r);
	plan->prediction.tp = eco_read_f64(r);
	plan->prediction.fp = eco_read_f64(r);
	plan->prediction.fn = eco_read_f64(r);
	plan->placements = read_items(r, &plan->placement_count, 4, sizeof *plan->placements, no_memory);
	read_placements(r, plan);
	plan->runs = read_items(r, &plan->run_count, 2, sizeof *plan->runs, no_memory);
	read_runs(r, plan);
	plan->gates = read_items(r, &plan->gate_count, 2, sizeof *plan->gates, no_memory);
	read_gates(r, plan);
	read_all_cuts(r, plan, no_memory);
}

static enum eco_code check_spelling(const uint8_t *bytes, size_t size, const struct eco_plan *plan,
	struct eco_error *error)
{
	struct eco_writer again = { 0 };
	write_sorted(&again, plan);
	bool failed = again.failed, same = again.size == size && memcmp(again.bytes, bytes, size) == 0;
	eco_writer_free(&again);
	if (failed)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a plan of %zu bytes", size);
	if (!same)
		return eco_fail(error, ECO_DAMAGED, "the plan is not in its one encoding");
	return ECO_OK;
}

enum eco_code eco_wire_read_plan(struct eco_reader *r, struct eco_plan *plan, struct eco_error *error)
{
	size_t start = r->at;
	bool no_memory = false;
	enum eco_code code;
	*plan = (struct eco_plan){ 0 };
	read_fields(r, plan, &no_memory);
	if (no_memory)
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for a plan of %zu bytes", r->size - start);
	else if (r->failed)
		code = eco_fail(error, ECO_DAMAGED, "the plan ends early, or a number in it is out of "
			"range, near its byte %zu", r->at - start);
	else
		code = eco_plan_check(plan, error);
	if (!code)
		code = check_spelling(r->bytes + start, r->at - start, plan, error);
	if (code)
		eco_plan_free(plan);
	return code;
}
