/* Plans as plain data: their order, their checks, a client's holdings, and the names of plants.
 *
 * Every array has one order, so that a plan has one encoding and neighbours resemble each other: the coder
 * sends mostly differences (ecofiles/format/wire.h). Rules are sorted by anchor, then list, then band:
 * from one band to the next only the end changes.
 *
 * Owners, 64 bits:
 *
 *   63       1 (0 is "nothing")
 *   62       1: a summary point, 0: a plant
 *   46..61   low 16 bits of the key of leaf tile and placements
 *   30..45   low 16 bits of the plant id (the species)
 *   0..29    0 for a summary; else (index + a hash of the key's high 16 bits) modulo 2^30
 *
 * Two plants of one species in one leaf tile never share an owner; two of different tiles do with a chance
 * of about 2^-46. */
#include "ecofiles/format/plan.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/angle16.h"
#include "ecofiles/base/array_grow.h"
#include "ecofiles/base/order.h"

void eco_plan_free(struct eco_plan *plan)
{
	if (!plan)
		return;
	eco_free(plan->placements, plan->runs, plan->gates, plan->cuts);
	*plan = (struct eco_plan){ 0 };
}

/* ---- Order ---- */

/* Runs and gates are numbers alone. */
static int compare(const uint32_t *a, const uint32_t *b, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (a[i] != b[i])
			return a[i] < b[i] ? -1 : 1;
	return 0;
}

static int run_order(const void *a, const void *b)
{
	return compare(a, b, sizeof(struct eco_run) / sizeof(uint32_t));
}

static int gate_order(const void *a, const void *b)
{
	return compare(a, b, sizeof(struct eco_gate) / sizeof(uint32_t));
}

#define CUT_KEYS 10

static void cut_keys(const struct eco_cut *cut, uint32_t keys[CUT_KEYS])
{
	bool summary = cut->anchor == ECO_NONE;
	uint32_t bits;
	memcpy(&bits, &cut->scale, sizeof bits);
	/* ECO_NONE + 1 is 0: summaries come first */
	uint32_t all[CUT_KEYS] = { cut->anchor + 1, summary ? cut->placement : 0, cut->list,
		summary ? 0 : cut->band_first, summary ? 0 : cut->band_end, summary ? 0 : cut->share_first,
		cut->first, cut->end, bits, cut->halvings };
	memcpy(keys, all, sizeof all);
}

static int cut_order(const void *a, const void *b)
{
	uint32_t x[CUT_KEYS], y[CUT_KEYS];
	cut_keys(a, x);
	cut_keys(b, y);
	return compare(x, y, CUT_KEYS);
}

static void sort(void *items, uint32_t count, size_t size, int (*order)(const void *, const void *))
{
	if (count > 1)
		qsort(items, count, size, order);
}

void eco_plan_sort(struct eco_plan *plan)
{
	sort(plan->runs, plan->run_count, sizeof *plan->runs, run_order);
	sort(plan->gates, plan->gate_count, sizeof *plan->gates, gate_order);
	sort(plan->cuts, plan->cut_count, sizeof *plan->cuts, cut_order);
}

/* ---- Checks ---- */

#define BAD(...) eco_fail(error, ECO_DAMAGED, __VA_ARGS__)

static bool within(double v, double low, double high)
{
	return v >= low && v <= high;    /* false for NaN */
}

static enum eco_code check_head(const struct eco_plan *plan, struct eco_error *error)
{
	const struct eco_prediction *p = &plan->prediction;
	if (plan->vertices > ECO_VERTICES_MAX)
		return BAD("the plan has %llu vertices", (unsigned long long)plan->vertices);
	if (!isfinite(plan->sample_distance) || plan->sample_distance < 0)
		return BAD("the plan's sample distance is not a finite number from 0 on");
	if (!isfinite(p->tp) || !isfinite(p->fp) || !isfinite(p->fn) || !isfinite(plan->m16))
		return BAD("the plan's prediction is not finite");
	if (plan->placement_count > ECO_PLAN_ITEMS_MAX || plan->run_count > ECO_PLAN_ITEMS_MAX ||
		plan->gate_count > ECO_PLAN_ITEMS_MAX || plan->cut_count > ECO_PLAN_ITEMS_MAX)
		return eco_fail(error, ECO_TOO_LARGE, "the plan has %u placements, %u runs, %u gates, %u "
			"cuts: at most %u of each", plan->placement_count, plan->run_count, plan->gate_count,
			plan->cut_count, ECO_PLAN_ITEMS_MAX);
	return ECO_OK;
}

static const char *placement_fault(const struct eco_plan *plan, uint32_t i)
{
	const struct eco_placement *p = &plan->placements[i];
	for (int axis = 0; axis < 3; axis++)
		if (!within(p->at[axis], -1e12, 1e12))
			return "it lies beyond 1e12 m";
	return !within(p->scale, 0, 1e12) || p->scale == 0 ? "its scale is outside (0, 1e12]" : NULL;
}

static const char *run_fault(const struct eco_plan *plan, uint32_t i)
{
	const struct eco_run *run = &plan->runs[i], *before = i ? run - 1 : NULL;
	if (run->placement >= plan->placement_count)
		return "its placement is not there";
	if (run->list_first >= run->list_end || run->left >= ECO_SHARE_ONE)
		return "it is empty, or leaves out all of its plants";
	return before && (run->placement < before->placement ||
		(run->placement == before->placement && run->list_first < before->list_end))
		? "it overlaps the run before it or is out of order" : NULL;
}

static const char *gate_fault(const struct eco_plan *plan, uint32_t i)
{
	const struct eco_gate *gate = &plan->gates[i];
	if (gate->end > ECO_GATE_OPEN)
		return "it ends beyond the last band";
	return i && gate->plant <= gate[-1].plant ? "it is out of order" : NULL;
}

static const char *cut_fault(const struct eco_plan *plan, uint32_t i)
{
	const struct eco_cut *cut = &plan->cuts[i];
	bool summary = cut->anchor == ECO_NONE;
	if (cut->first >= cut->end || cut->list == ECO_NONE)
		return "it is empty, or has no list";
	if (!within(cut->scale, 0, 1e12) || signbit(cut->scale))
		return "its scale is outside [0, 1e12]";
	if (cut->halvings > (summary ? ECO_HALVINGS_MAX : 0))
		return "its points are halved too often";
	if (summary && cut->placement >= plan->placement_count)
		return "its placement is not there";
	if (!summary && (cut->band_first >= cut->band_end || cut->band_end > ECO_BANDS
			|| cut->share_first >= cut->share_end || cut->share_end > ECO_SHARE_ONE))
		return "its bands or its share are none";
	return i && cut_order(cut - 1, cut) >= 0 ? "it repeats the one before it or is out of order" : NULL;
}

static enum eco_code check_each(const struct eco_plan *plan, const char *what, uint32_t count,
	const char *(*fault)(const struct eco_plan *, uint32_t), struct eco_error *error)
{
	const char *found = NULL;
	uint32_t i = 0;
	while (i < count && !(found = fault(plan, i)))
		i++;
	return found ? BAD("%s %u of the plan: %s", what, i, found) : ECO_OK;
}

enum eco_code eco_plan_check(const struct eco_plan *plan, struct eco_error *error)
{
	ECO_PASS(check_head(plan, error));
	ECO_PASS(check_each(plan, "placement", plan->placement_count, placement_fault, error));
	ECO_PASS(check_each(plan, "run", plan->run_count, run_fault, error));
	ECO_PASS(check_each(plan, "gate", plan->gate_count, gate_fault, error));
	return check_each(plan, "cut", plan->cut_count, cut_fault, error);
}

/* ---- Holdings ---- */

ECO_ORDER(holding_order, struct eco_holding, ->list)

uint32_t eco_holdings_chunks(const struct eco_holdings *holdings, uint32_t list)
{
	const struct eco_holding *found = holdings && holdings->count ? bsearch(&(struct eco_holding){ .list = list },
		holdings->items, holdings->count, sizeof *holdings->items, holding_order) : NULL;
	return found ? found->chunks : 0;
}

/* ---- Owners ---- */

#define OWNER_THERE (UINT64_C(1) << 63)
#define OWNER_SUMMARY (UINT64_C(1) << 62)
#define OWNER_INDEX_BITS 30

/* An odd factor permutes the low 16 bits, so that the first 65536 tiles of an eco file have different
 * keys. */
uint32_t eco_owner_leaf(uint32_t tile)
{
	return tile * 0x9E3779B1u;
}

/* MurmurHash3's finalizer, not a product: sums of products would collide (children 3 and 5 above a tile
 * with 4 and 4). */
uint32_t eco_owner_child(uint32_t number)
{
	uint32_t h = number + 0x68E31DA4u;
	h = (h ^ h >> 16) * 0x85EBCA6Bu;
	h = (h ^ h >> 13) * 0xC2B2AE35u;
	return h ^ h >> 16;
}

uint32_t eco_owner_step(const struct eco_scene *scene, uint32_t tile, uint32_t child)
{
	const struct eco_tile *t = &scene->tiles[tile];
	bool alone = tile == scene->root && t->child_count == 1 && t->group_count == 0;
	if (!scene->children[child].placed || alone)
		return 0;
	return eco_owner_child((scene->children[child].tile - tile) * 0x85EBCA6Bu + (child - t->child_first));
}

static uint64_t owner_common(uint32_t key, uint32_t plant)
{
	return OWNER_THERE | (uint64_t)(key & 0xFFFF) << 46 | (uint64_t)(plant & 0xFFFF) << OWNER_INDEX_BITS;
}

uint64_t eco_owner_instance(uint32_t key, uint32_t plant, uint32_t index)
{
	uint32_t mask = (1u << OWNER_INDEX_BITS) - 1;
	return owner_common(key, plant) | ((index + (key >> 16) * 0x9E3779B1u) & mask);
}

uint64_t eco_owner_summary(uint32_t key, uint32_t plant)
{
	return owner_common(key, plant) | OWNER_SUMMARY;
}

bool eco_owner_match(uint64_t a, uint64_t b)
{
	if (a == 0 || b == 0)
		return false;
	if (!((a | b) & OWNER_SUMMARY))
		return a == b;
	return (a & ~OWNER_SUMMARY) >> OWNER_INDEX_BITS == (b & ~OWNER_SUMMARY) >> OWNER_INDEX_BITS;
}

uint32_t eco_owner_plant(uint64_t owner)
{
	return (uint32_t)(owner >> OWNER_INDEX_BITS) & 0xFFFF;
}

/* ---- Placements ---- */

void eco_placement_point(const struct eco_placement *placement, const double p[3], double world[3])
{
	double sine, cosine, x = p[0], y = p[1];
	eco_angle16_sincos(placement->turn, &sine, &cosine);
	world[0] = placement->at[0] + placement->scale * (cosine * x - sine * y);
	world[1] = placement->at[1] + placement->scale * (sine * x + cosine * y);
	world[2] = placement->at[2] + placement->scale * p[2];
}

struct eco_placement eco_placement_inside(const struct eco_placement *outer, const struct eco_child *child)
{
	struct eco_placement inside = { .turn = (uint16_t)(outer->turn + child->turn),
		.scale = outer->scale * child->scale, .path = outer->path };
	eco_placement_point(outer, child->at, inside.at);
	return inside;
}

/* ---- Predictions ---- */

double eco_predicted_q(const struct eco_prediction *p)
{
	double drawn = p->tp + p->fp, wanted = p->tp + p->fn;
	/* 1 - Precision, 1 - Recall */
	double extra = drawn > 0 ? p->fp / drawn : 0, missed = wanted > 0 ? p->fn / wanted : 0;
	return 1 - sqrt(extra * extra + missed * missed);
}
