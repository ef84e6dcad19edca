/* Plans on the wire: the layout stands in wire.h. One function a field writes and reads it, so that both ways
 * agree. A sorted plan repeats itself, so an item is told by what is expected of it: mostly the item before.
 *
 * A plan has one encoding: numbers are canonical, a field that is said differs from what is expected, and
 * what says nothing is constant. The rest is checked by eco_plan_check. */
#include "ecofiles/format/wire.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/range.h"

struct coder {
	struct eco_writer *w;                    /* NULL: reading */
	struct eco_reader r;
	bool bad;                                /* what was read is out of range */
};

static uint64_t code_number(struct coder *c, uint64_t value)
{
	if (!c->w)
		return eco_read_varint(&c->r);
	eco_write_varint(c->w, value);
	return value;
}

static uint32_t code_u32(struct coder *c, uint32_t value)
{
	uint64_t v = code_number(c, value);
	c->bad |= v > UINT32_MAX;
	return (uint32_t)v;
}

static double code_f64(struct coder *c, double value)
{
	if (!c->w)
		return eco_read_f64(&c->r);
	eco_write_f64(c->w, value);
	return value;
}

/* Which of a row's fields differ from the expected ones, and those from `from` to `to`: by how much, modulo
 * 2^32. */
static uint32_t code_which(struct coder *c, const uint32_t *row, const uint32_t *expected, uint32_t count)
{
	uint32_t differ = 0;
	for (uint32_t i = 0; i < count; i++)
		differ |= (uint32_t)(row[i] != expected[i]) << i;
	differ = code_u32(c, differ);
	c->bad |= differ >> count != 0;
	return differ;
}

static void code_fields(struct coder *c, uint32_t differ, uint32_t *row, const uint32_t *expected, uint32_t from,
	uint32_t to)
{
	for (uint32_t i = from; i < to; i++) {
		uint32_t by = differ >> i & 1 ? code_u32(c, eco_zigzag(row[i] - expected[i])) : 0;
		c->bad |= (differ >> i & 1) && !by;
		row[i] = expected[i] + eco_unzigzag(by);
	}
}

/* ---- Roundings ---- */

#define DROPPED_BITS 17u                 /* of a float's 23 behind the leading one */

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

/* A rounded scale is a small number. */
static uint32_t rotate(uint32_t v, uint32_t left) { return v << left | v >> (32 - left); }

/* A number that travels as a whole one of so many parts; at most `most`. */
struct fixed { double most, parts; };
static const struct fixed pixels_code = { 1e14, 16 }, m16_code = { 1000, 1000 };

static double fixed_round(struct fixed f, double value)
{
	return floor(fmin(fmax(value, 0), f.most) * f.parts + 0.5) / f.parts;
}

double eco_wire_pixels_round(double pixels) { return fixed_round(pixels_code, pixels); }

double eco_wire_m16_round(double m16) { return fixed_round(m16_code, m16); }

static double code_fixed(struct coder *c, struct fixed f, double value)
{
	c->bad |= c->w && !(value >= 0 && value <= f.most);
	uint64_t parts = code_number(c, c->bad ? 0 : (uint64_t)floor(value * f.parts + 0.5));
	c->bad |= parts > (uint64_t)(f.parts * f.most);
	return (double)parts / f.parts;
}

/* ---- Items ---- */

#define MILLIMETRES_MAX INT64_C(1000000000000000)        /* 1e12 m, see eco_view_check */
enum place_field { PLACE_EXACT = 1, PLACE_TURN = 8, PLACE_PATH = 16, PLACE_SCALE = 32, PLACE_SCALE_EXACT = 64 };

/* Division rounds correctly, so a position written with up to three decimals is such a quotient to the
 * last bit. */
static bool whole_millimetres(double v, int64_t *millimetres)
{
	if (!(fabs(v) <= 1e12))
		return false;
	*millimetres = (int64_t)floor(v * 1000 + 0.5);
	return (double)*millimetres / 1000.0 == v && !(v == 0 && signbit(v));
}

static double code_axis(struct coder *c, bool exact, int64_t *last, double value)
{
	int64_t millimetres = *last;
	if (exact)
		return code_f64(c, value);
	if (c->w)
		whole_millimetres(value, &millimetres);
	int64_t step = millimetres - *last;
	uint64_t zigzag = code_number(c, (uint64_t)step << 1 ^ (step < 0 ? UINT64_MAX : 0));
	c->bad |= zigzag > 4 * (uint64_t)MILLIMETRES_MAX;
	*last += c->bad ? 0 : (int64_t)(zigzag >> 1) ^ -(int64_t)(zigzag & 1);
	c->bad |= *last < -MILLIMETRES_MAX || *last > MILLIMETRES_MAX;
	return (double)*last / 1000.0;
}

static uint32_t place_fields(const struct eco_placement *p)
{
	int64_t unused;
	uint32_t fields = (p->turn ? PLACE_TURN : 0u) | (p->path ? PLACE_PATH : 0u)
		| (p->scale == 1 ? 0u : (double)(float)p->scale == p->scale ? PLACE_SCALE : PLACE_SCALE_EXACT);
	for (int axis = 0; axis < 3; axis++)
		fields |= whole_millimetres(p->at[axis], &unused) ? 0u : (uint32_t)PLACE_EXACT << axis;
	return fields;
}

static void code_placement(struct coder *c, int64_t last[3], struct eco_placement *p)
{
	uint32_t fields = code_u32(c, place_fields(p));
	for (int axis = 0; axis < 3; axis++)
		p->at[axis] = code_axis(c, fields & (uint32_t)PLACE_EXACT << axis, &last[axis], p->at[axis]);
	uint32_t turn = fields & PLACE_TURN ? code_u32(c, p->turn) : 0;
	p->turn = (uint16_t)turn;
	p->path = fields & PLACE_PATH ? code_u32(c, p->path) : 0;
	p->scale = fields & PLACE_SCALE ? (double)bits_float(code_u32(c, float_bits((float)p->scale)))
		: fields & PLACE_SCALE_EXACT ? code_f64(c, p->scale) : 1;
	c->bad |= fields != place_fields(p) || turn > UINT16_MAX;
}

/* `first`: of the first run of the placement before: placements of one nested eco file begin with the same
 * list. */
static void code_run(struct coder *c, const struct eco_run *before, uint32_t *first, struct eco_run *run)
{
	uint32_t placement = before->placement + code_u32(c, run->placement - before->placement);
	bool moved = placement != before->placement;
	const uint32_t expected[] = { moved ? *first : before->list_end, before->list_end - before->list_first,
		before->left };
	uint32_t row[] = { run->list_first, run->list_end - run->list_first, run->left };
	code_fields(c, code_which(c, row, expected, 3), row, expected, 0, 3);
	*run = (struct eco_run){ placement, row[0], row[0] + row[1], row[2] };
	*first = moved ? row[0] : *first;
}

static void code_gate(struct coder *c, const struct eco_gate *before, struct eco_gate *gate)
{
	gate->plant = before->plant + code_u32(c, gate->plant - before->plant);
	gate->end = before->end + eco_unzigzag(code_u32(c, eco_zigzag(gate->end - before->end)));
}

enum cut_field { CUT_LIST, CUT_ANCHOR, CUT_END, CUT_FIRST, CUT_BAND, CUT_SHARE_END, CUT_SHARE, CUT_SCALE, CUT_BANDS,
	CUT_PLACEMENT, CUT_HALVINGS, CUT_FIELDS };
#define CUT_TOLD (CUT_ANCHOR + 1)        /* fields that those behind them are expected by */

/* The number of a level of splats that is the next above `first`: 4, 16, 64, ...; else 0. */
static uint32_t level_above(uint32_t first)
{
	uint64_t level = 1;
	while (level <= first)
		level *= 4;
	return first && level <= UINT32_MAX ? (uint32_t)level : 0;
}

static void row_of_cut(uint32_t row[CUT_FIELDS], const struct eco_cut *cut)
{
	bool once = cut->anchor == ECO_NONE;
	const uint32_t all[CUT_FIELDS] = { [CUT_LIST] = cut->list, [CUT_ANCHOR] = cut->anchor,
		[CUT_END] = cut->end - level_above(cut->first), [CUT_FIRST] = cut->first,
		[CUT_BAND] = once ? 0 : cut->band_first,
		[CUT_BANDS] = once ? ECO_BANDS : (uint32_t)(cut->band_end - cut->band_first),
		[CUT_SHARE] = once ? 0 : cut->share_first, [CUT_SHARE_END] = once ? ECO_SHARE_ONE : cut->share_end,
		[CUT_SCALE] = rotate(float_bits(cut->scale), 32 - DROPPED_BITS),
		[CUT_PLACEMENT] = once ? cut->placement : 0, [CUT_HALVINGS] = cut->halvings };
	memcpy(row, all, sizeof all);
}

/* The cut that is expected behind `before`, by its row and its list; `group`: the first cut of its list. */
static void expect_cut(uint32_t e[CUT_FIELDS], const struct eco_cut *before, const struct eco_cut *group,
	uint32_t list, uint32_t anchor)
{
	bool fresh = list != before->list || anchor != before->anchor, coarse = before->first
		&& before->end == level_above(before->first);
	row_of_cut(e, fresh ? group : before);
	e[CUT_LIST] = before->list;
	e[CUT_ANCHOR] = before->anchor;
	if (fresh || anchor == ECO_NONE)
		return;
	if (coarse) {                    /* the children of those splats of a level that have given way */
		e[CUT_FIRST] = before->end;
		e[CUT_END] = 4 * before->first - level_above(before->end);
		return;
	}
	e[CUT_END] = before->first ? 0 : e[CUT_END];
	e[CUT_SHARE] = before->share_end % ECO_SHARE_ONE;
	e[CUT_SHARE_END] = ECO_SHARE_ONE;
	e[CUT_BAND] = e[CUT_SHARE] ? e[CUT_BAND] : before->band_end;
}

static void code_cut(struct coder *c, const struct eco_cut *before, struct eco_cut *group, struct eco_cut *cut)
{
	uint32_t row[CUT_FIELDS], expected[CUT_FIELDS];
	row_of_cut(row, cut);
	expect_cut(expected, before, group, cut->list, cut->anchor);
	uint32_t differ = code_which(c, row, expected, CUT_FIELDS);
	code_fields(c, differ, row, expected, 0, CUT_TOLD);
	expect_cut(expected, before, group, row[CUT_LIST], row[CUT_ANCHOR]);
	code_fields(c, differ, row, expected, CUT_TOLD, CUT_FIELDS);
	bool once = row[CUT_ANCHOR] == ECO_NONE;
	c->bad |= row[CUT_BAND] > ECO_BANDS || row[CUT_BANDS] > ECO_BANDS - row[CUT_BAND]
		|| row[CUT_HALVINGS] > ECO_HALVINGS_MAX || (!once && row[CUT_PLACEMENT])
		|| (once && (row[CUT_BANDS] != ECO_BANDS || row[CUT_SHARE] || row[CUT_SHARE_END] != ECO_SHARE_ONE));
	*cut = (struct eco_cut){ .list = row[CUT_LIST], .first = row[CUT_FIRST],
		.end = row[CUT_END] + level_above(row[CUT_FIRST]), .scale = bits_float(rotate(row[CUT_SCALE], DROPPED_BITS)),
		.placement = row[CUT_PLACEMENT], .anchor = row[CUT_ANCHOR], .band_first = (uint8_t)row[CUT_BAND],
		.band_end = (uint8_t)(row[CUT_BAND] + row[CUT_BANDS]), .halvings = (uint8_t)row[CUT_HALVINGS],
		.share_first = row[CUT_SHARE], .share_end = row[CUT_SHARE_END] };
	if (cut->list != before->list || cut->anchor != before->anchor)
		*group = *cut;
}

/* ---- The plan ---- */

static void code_head(struct coder *c, struct eco_plan *plan)
{
	uint32_t *const counts[] = { &plan->placement_count, &plan->run_count, &plan->gate_count, &plan->cut_count };
	plan->vertices = code_number(c, plan->vertices);
	plan->prediction.tp = code_fixed(c, pixels_code, plan->prediction.tp);
	plan->prediction.fp = code_fixed(c, pixels_code, plan->prediction.fp);
	plan->prediction.fn = code_fixed(c, pixels_code, plan->prediction.fn);
	plan->m16 = code_fixed(c, m16_code, plan->m16);
	for (int i = 0; i < 4; i++)
		*counts[i] = code_u32(c, *counts[i]);
}

static void code_items(struct coder *c, struct eco_plan *plan)
{
	const struct eco_run no_run = { .placement = ECO_NONE };
	const struct eco_gate no_gate = { 0 };
	const struct eco_cut no_cut = { .anchor = ECO_NONE, .scale = 1, .end = 1 };
	struct eco_cut group = no_cut;
	int64_t last[3] = { 0 };
	uint32_t first = 0;
	for (uint32_t i = 0; i < plan->placement_count && !c->bad; i++)
		code_placement(c, last, &plan->placements[i]);
	for (uint32_t i = 0; i < plan->run_count && !c->bad; i++)
		code_run(c, i ? &plan->runs[i - 1] : &no_run, &first, &plan->runs[i]);
	for (uint32_t i = 0; i < plan->gate_count && !c->bad; i++)
		code_gate(c, i ? &plan->gates[i - 1] : &no_gate, &plan->gates[i]);
	for (uint32_t i = 0; i < plan->cut_count && !c->bad; i++)
		code_cut(c, i ? &plan->cuts[i - 1] : &no_cut, &group, &plan->cuts[i]);
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
	struct coder coder = { .w = w };
	struct eco_plan sorted = *plan;
	sorted.placements = copy_of(plan->placements, plan->placement_count, sizeof *plan->placements);
	sorted.runs = copy_of(plan->runs, plan->run_count, sizeof *plan->runs);
	sorted.gates = copy_of(plan->gates, plan->gate_count, sizeof *plan->gates);
	sorted.cuts = copy_of(plan->cuts, plan->cut_count, sizeof *plan->cuts);
	bool good = sorted.placements && sorted.runs && sorted.gates && sorted.cuts;
	if (good) {
		eco_plan_sort(&sorted);
		good = eco_plan_check(&sorted, NULL) == ECO_OK;
	}
	if (good) {
		code_head(&coder, &sorted);
		code_items(&coder, &sorted);
	}
	w->failed |= !good || coder.bad;
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

static bool room_for(struct eco_plan *plan)
{
	plan->placements = calloc(plan->placement_count + (size_t)1, sizeof *plan->placements);
	plan->runs = calloc(plan->run_count + (size_t)1, sizeof *plan->runs);
	plan->gates = calloc(plan->gate_count + (size_t)1, sizeof *plan->gates);
	plan->cuts = calloc(plan->cut_count + (size_t)1, sizeof *plan->cuts);
	return plan->placements && plan->runs && plan->gates && plan->cuts;
}

static enum eco_code read_fields(struct coder *c, struct eco_plan *plan, struct eco_error *error)
{
	size_t size = c->r.size;
	code_head(c, plan);
	/* an item takes a byte at least: memory is in proportion to bytes */
	uint64_t items = (uint64_t)plan->placement_count + plan->run_count + plan->gate_count + plan->cut_count;
	if (c->bad || c->r.failed || items > size)
		return eco_fail(error, ECO_DAMAGED, "the plan ends early, or a number in it is out of range: "
			"%llu items in %zu bytes", (unsigned long long)items, size);
	if (!room_for(plan))
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a plan of %zu bytes", size);
	code_items(c, plan);
	if (c->bad || c->r.failed || c->r.at != size)
		return eco_fail(error, ECO_DAMAGED, "a number in the plan is out of range, or it ends early, near its "
			"byte %zu of %zu", c->r.at, size);
	return eco_plan_check(plan, error);
}

enum eco_code eco_wire_read_plan(struct eco_reader *r, struct eco_plan *plan, struct eco_error *error)
{
	size_t size = r->size - r->at;
	struct coder coder = { .r = { .bytes = eco_read_bytes(r, size), .size = size } };
	*plan = (struct eco_plan){ 0 };
	enum eco_code code = read_fields(&coder, plan, error);
	if (code)
		eco_plan_free(plan);
	return code;
}
