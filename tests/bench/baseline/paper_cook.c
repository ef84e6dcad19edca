/* Stochastic pruning of whole scenes: Cook, Halstead, Planck, Ryu 2007, and with tables and occlusion
 * Neubert, Pirk, Deussen, Dachsbacher 2011. */
#include <math.h>

#include "lod/ladder.h"
#include "tests/bench/baseline/paper_rules.h"

#define LAMBDA_LEAST 1e-6

double paper_cook_lambda(double r, double full_m)
{
	double x = full_m / r;
	return x >= 1 ? 1 : fmax(LAMBDA_LEAST, x * x);
}

void paper_wood(struct paper *p, const struct lod_slot *slot, uint32_t ladder, double lambda,
	uint32_t share_first, uint32_t share_end)
{
	const struct lod_plan_tables_ladder *table = lod_plan_tables_ladder(p->s->tables, ladder);
	const struct eco_ladder *l = &p->s->scene->ladders[ladder];
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
	double full = l->flags & ECO_LADDER_FAR ? p->s->wood_full[l->plant] : (double)table->way.full;
	uint64_t vertices = lod_way_floor(&table->way, (uint64_t)fmin(lambda * full,
		(double)table->way.full));
	uint32_t count = vertices ? lod_way_cuts(&table->way, vertices, lod_way_density(&table->way,
		vertices), 0, cuts) : 0;
	for (uint32_t i = 0; i < count; i++) {
		cuts[i].share_first = share_first;
		cuts[i].share_end = share_end;
		paper_cut(p, slot, &cuts[i]);
	}
}

void paper_leaves(struct paper *p, const struct lod_slot *slot, const struct eco_ladder *l, double kept,
	double scale, uint32_t share_first, uint32_t share_end)
{
	double own = fmin(kept - l->before, p->s->scene->lists[l->triangles].element_count);
	struct eco_cut cut = { .list = l->triangles, .scale = (float)scale, .share_first = share_first,
		.share_end = share_end };
	if (!(own > 0))
		return;
	if (own < 1 && share_end - share_first == ECO_SHARE_ONE)
		cut.share_end = (uint32_t)fmax(1, own * ECO_SHARE_ONE);
	else if (own < 1 && own * ECO_SHARE_ONE <= share_first)
		return;
	cut.end = paper_triangles(p->s, l->triangles, own < 1 ? 1 : (uint32_t)own);
	paper_cut(p, slot, &cut);
}

struct pruned { double lambda, scale; };

/* The leaves of a plant at distance r. */
static struct pruned prune(const struct paper_cook *cook, uint32_t plant, double r, double full_m, double f)
{
	struct pruned out = { paper_cook_lambda(r, full_m), 1 };
	if (cook->optimal && cook->tables)
		out.lambda = paper_table_optimal(&cook->tables[plant], out.lambda);
	out.lambda *= paper_sight_share(f);
	out.scale = !cook->tables ? 1 / out.lambda : (cook->optimal ? paper_table_scale : paper_table_cook)(
		&cook->tables[plant], out.lambda);
	return out;
}

/* ---- Slots ---- */

static void add_slot(struct paper *p, const struct paper_cook *cook, const struct lod_slot *slot,
	double full_m, double f, uint32_t share_first, uint32_t share_end)
{
	struct pruned at = prune(cook, slot->plant, lod_band_distance_m(slot->band), full_m, f);
	uint32_t count;
	const uint32_t *ladders = lod_plan_tables_anchor(p->s->tables, slot->anchor, &count);
	for (uint32_t k = 0; k < count; k++) {
		const struct eco_ladder *l = &p->s->scene->ladders[ladders[k]];
		if (!paper_applies(p, l, slot))
			continue;
		if (paper_is_leaves(l))
			paper_leaves(p, slot, l, at.lambda * l->total, at.scale, share_first, share_end);
		else if (!(l->flags & ECO_LADDER_WHOLE))
			paper_wood(p, slot, ladders[k], at.lambda, share_first, share_end);
	}
}

/* Each plant is one by its hash: those of a species with the same hash are seen alike. */
struct each { struct paper *p; const struct paper_cook *cook; double full_m; };

static void add_plant(void *ctx, const struct lod_anchor_band *anchors, uint32_t count, uint32_t plant,
	uint32_t hash)
{
	struct each *e = ctx;
	double f = paper_sight_of(e->cook->sight, plant, hash);
	for (uint32_t a = 0; a < count; a++) {
		struct lod_slot slot = { .anchor = anchors[a].anchor, .plant = plant,
			.band = anchors[a].band };
		add_slot(e->p, e->cook, &slot, e->full_m, f, hash, hash + 1);
	}
}

/* The band from which on the whole plant's list holds enough leaves. */
static uint32_t gate_of(const struct paper *p, const struct paper_cook *cook, uint32_t plant, double full_m)
{
	const struct eco_scene *scene = p->s->scene;
	const struct eco_plant *of = &scene->plants[plant];
	for (int band = ECO_BANDS - 1; band >= 0 && of->anchor_count > 1; band--) {
		double lambda = prune(cook, plant, lod_band_distance_m((uint8_t)band), full_m, 1).lambda;
		for (uint32_t i = of->ladder_first; i < of->ladder_first + of->ladder_count; i++) {
			const struct eco_ladder *l = &scene->ladders[i];
			if (l->anchor == of->anchor_first && paper_is_leaves(l) &&
				lambda * l->total > scene->lists[l->triangles].element_count)
				return (uint32_t)(band + 1) * ECO_SHARE_ONE;
		}
	}
	return 0;
}

bool paper_cook(struct paper *p, double full_m, void *ctx)
{
	const struct paper_cook *cook = ctx;
	struct each each = { p, cook, full_m };
	for (uint32_t i = 0; i < p->s->scene->plant_count; i++)
		p->p.gates[i] = gate_of(p, cook, i, full_m);
	if (!paper_open(p, 0))
		return false;
	for (uint32_t i = 0; i < p->s->scene->plant_count && cook->sight; i++)
		lod_visible_tree_each(&p->p.visible, i, p->p.gates, add_plant, &each);
	for (uint32_t i = 0; i < p->p.visible.slot_count && !cook->sight; i++)
		if (p->p.visible.slots[i].count)
			add_slot(p, cook, &p->p.visible.slots[i], full_m, 1, 0, ECO_SHARE_ONE);
	return true;
}

#define HALVINGS 60

static double power(double base, uint32_t exponent)
{
	double result = 1;
	for (; exponent; exponent >>= 1, base *= base)
		if (exponent & 1)
			result *= base;
	return result;
}

double lod_cook_scale(uint32_t kept, uint32_t count)
{
	return kept ? (double)count / kept : 0;
}

double lod_cook_scale_depth(uint32_t kept, uint32_t count, double share)
{
	if (kept == 0 || kept >= count || !(share > 0) || share > 1)
		return lod_cook_scale(kept < count ? kept : count, count);
	/* The uncovered share, and not the covered one: in dense crowns the two sides differ in it. */
	double left = power(1 - share, count), low = 1, high = fmin((double)count / kept, 1 / share);
	for (int i = 0; i < HALVINGS; i++) {
		double s = (low + high) / 2;
		if (power(1 - s * share, kept) > left)
			low = s;
		else
			high = s;
	}
	return (low + high) / 2;
}

double lod_cook_share(uint32_t count, double projected, double covered)
{
	if (count == 0 || !(covered > 0) || !(projected > covered))
		return 0;
	/* in units of which `covered` is at least one element */
	double one = projected / count;
	double elements = fmax(1, covered / one), low = 0, high = 1;
	for (int i = 0; i < HALVINGS; i++) {
		double a = (low + high) / 2;
		if ((1 - power(1 - a, count)) / a > elements)
			low = a;
		else
			high = a;
	}
	return (low + high) / 2;
}

double lod_cook_contrast(uint32_t kept, uint32_t count, double per_pixel)
{
	if (kept == 0 || kept >= count)
		return 1;
	double before = fmax(1, per_pixel), after = fmax(1, per_pixel * kept / count);
	return sqrt(after / before);
}
