/* The default rule: the least expected error within budgets of vertices and of bytes (planner_bytes.c).
 *
 * The expected error of what is drawn comes from a ladder's measured curve or a summary's computed one, times
 * the pixels seen. Pixels seen are found once, before any budget (lod/seen/visibility.h). So the objective is
 * a sum, and at a lambda each of its terms is minimised by itself (lod/plan/allocation.h). lod/plan/README.md has the
 * steps, from the search for a lambda to the price of bytes.
 *
 * The prediction is that of the entries: what the screen expects of the positions that the fill has left. */
#include "lod/plan/planner_state.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/plan/byte_price.h"
#include "lod/plan/fill_budget.h"
#include "lod/plan/allocation.h"

#define LAMBDAS_PER_OCTAVE 2

double lod_lambda_at(int index)
{
	if (index >= LOD_LAMBDA_COUNT)
		return 0;
	return ldexp(index % 2 ? 0.70710678118654752440 : 1, LOD_LAMBDA_HIGHEST - index / LAMBDAS_PER_OCTAVE);
}

static void begin_screen(struct lod_planner *p)
{
	lod_screen_init(&p->screen, &p->visible.eye, &p->input->request->view, p->scene->ground_count > 0);
	p->visible.screen = &p->screen;
	p->visible.proxy_shapes = lod_plan_tables_proxy_shapes(p->tables);
}

/* Is half of the work done, at which nothing more is begun that only makes the plan better? */
static bool is_enough(const struct lod_lambda_search *s)
{
	return lod_planner_over(s->allocation->p, 2);
}

/* ---- The search for lambda ---- */

/* From nothing to everything, by halving. Most lambdas are never tried, among them those of much smaller budgets, which
 * take the longest: as long as nothing is chosen at a lambda the next one is much lower. */
enum eco_code lod_search_grid(struct lod_lambda_search *s, uint64_t budget, struct eco_error *error)
{
	struct lod_allocation *m = s->allocation;
	enum eco_code code = ECO_OK;
	s->index = 0;
	s->here = 0;
	for (int next = LOD_LAMBDA_COUNT + 1, at = LOD_LAMBDA_COUNT; !code && at > s->index;) {
		code = lod_planner_check(m->p, error);
		if (code)
			break;
		lod_allocation_relax(m, lod_lambda_at(at));
		if (m->cost.vertices <= (double)budget) {
			s->index = at;
			s->here = fmax(s->here, m->cost.vertices);
		} else {
			next = at;
		}
		const int width = next - s->index;
		at = s->index + (!(s->here > 0) && next < LOD_LAMBDA_COUNT ? 3 * width / 4 : width / 2);
	}
	return code;
}

/* ---- Gates and tiles of a lambda ---- */

static double closed_wrong(const struct lod_allocation *m)
{
	double sum = 0;
	const struct lod_visible_tree *visible = &m->p->visible;
	for (uint32_t n = 0; n < visible->node_count; n++)
		if (visible->nodes[n].state == LOD_CLOSED)
			sum += m->tile_choices[n].weight * m->tile_choices[n].weight_px;
	return sum;
}

/* Wrong pixels left by the gates and tiles of a lambda when filled to the budget: INFINITY where they do not
 * fit. */
static enum eco_code fix_structure(const struct lod_lambda_search *s, double lambda, uint64_t budget,
	struct lod_fill *fill, double *wrong, struct eco_error *error)
{
	lod_allocation_relax(s->allocation, lambda);
	lod_allocation_fix(s->allocation);
	enum eco_code code = lod_fill_make(fill, s->allocation, error);
	if (code)
		return code;
	lod_fill_search(fill, fmin(fmax(lambda, LOD_LAMBDA_LEAST), lod_lambda_at(0)), budget);
	*wrong = fill->vertices <= budget ? fill->wrong + closed_wrong(s->allocation) : INFINITY;
	return ECO_OK;
}

/* The lambda that uses the budget, between two of the grid, by halving; *below: one that uses more, 0: there is no
 * need. From one grid lambda to the next many tiles open and gates rise at once; along this lambda they do so one by
 * one as a camera moves. */
static double exact_lambda(const struct lod_lambda_search *s, uint64_t budget, double *below)
{
	double high = lod_lambda_at(s->index), low = lod_lambda_at(s->index + 1), unused = (double)budget - s->here;
	const double enough = (double)budget;
	for (int i = 0; i < LOD_LAMBDA_TRIES && low > 0 && unused > enough * LOD_LAMBDA_SLACK && !is_enough(s); i++) {
		double middle = sqrt(high * low);
		lod_allocation_relax(s->allocation, middle);
		double left = enough - s->allocation->cost.vertices;
		*(left >= 0 ? &high : &low) = middle;
		unused = left >= 0 ? left : unused;
	}
	*below = unused > enough * LOD_LAMBDA_UNUSED ? low : 0;
	return high;
}

enum eco_code lod_search_fill(const struct lod_lambda_search *s, double lambda, uint64_t budget,
	struct eco_error *error)
{
	struct lod_allocation *m = s->allocation;
	struct lod_fill fill = { 0 };
	double wrong;
	enum eco_code code = fix_structure(s, lambda, budget, &fill, &wrong, error);
	if (!code && !(wrong < INFINITY)) { /* hull points are whole, so a lambda that fits in the mean may
	                                     * not fit; choosing nothing does */
		lod_fill_free(&fill);
		code = fix_structure(s, LOD_LAMBDA_MOST, budget, &fill, &wrong, error);
	}
	if (!code && s->exact && lambda > 0)
		code = lod_fill_few(&fill, budget, error);
	m->p->converged = fill.converged;
	if (!code)
		code = lod_fill_finish(&fill, budget, error);
	if (!code)
		lod_explain_tiles(&fill);
	if (!code)
		code = lod_fill_predict(&fill, &m->p->prediction, error);
	m->p->cheapest = fill.cheapest;
	m->p->wrong = fill.wrong + closed_wrong(m) + (m->price > 0 ? lod_prices_lost(m) : 0);
	m->p->fill_lambda = fill.lambda;
	lod_fill_free(&fill);
	return code;
}

/* Do plants draw a ladder for the whole plant? */
static bool draws_whole(const struct lod_planner *p)
{
	for (uint32_t s = 0; s < p->visible.slot_count; s++)
		if (p->visible.slots[s].whole)
			return true;
	return false;
}

/* Few plants may leave much of the budget: the tiles and gates of the next lambda, which does not fit with its
 * steps, may be better with fewer of these. */
static enum eco_code fill_budget(struct lod_lambda_search *s, uint64_t budget, struct eco_error *error)
{
	const struct lod_planner *p = s->allocation->p;
	double below = 0;
	s->lambda = s->index == LOD_LAMBDA_COUNT ? lod_lambda_at(s->index) : exact_lambda(s, budget, &below);
	enum eco_code code = lod_search_fill(s, s->lambda, budget, error);
	if (code || !s->exact || !(below > 0) || is_enough(s))
		return code;
	double wrong = p->wrong;
	code = lod_search_fill(s, below, budget, error);
	return code || p->wrong < wrong ? code : lod_search_fill(s, s->lambda, budget, error);
}

/* ---- Levels of detail ---- */

/* Do tiles whose summary puts less right than nothing does, however much of it is drawn, have much of the
 * picture? From afar plants that stand apart are such. */
static bool hides_plants(const struct lod_allocation *m)
{
	const struct lod_planner *p = m->p;
	double hidden_px = 0;
	for (uint32_t n = 0; n < p->visible.node_count; n++)
		if (p->visible.nodes[n].state == LOD_SUMMARY && m->tile_choices[n].summary.hull.count <= 1)
			hidden_px += m->tile_choices[n].weight_px;
	return hidden_px > LOD_HIDDEN_MOST * m->tile_choices[0].weight_px;
}

/* Finds the lambda of one level. */
static enum eco_code search_level(struct lod_lambda_search *s, struct lod_planner *p, struct eco_error *error)
{
	lod_allocation_free(s->allocation);
	enum eco_code code = lod_planner_check(p, error);
	code = code ? code : lod_allocation_make(s->allocation, p, error);
	return code ? code : lod_search_grid(s, p->input->request->vertices, error);
}

/* Entries at one level, within both budgets. */
static enum eco_code fill_level(struct lod_lambda_search *s, struct lod_planner *p, struct eco_error *error)
{
	uint64_t budget = p->input->request->vertices;
	free(p->texture_levels);
	p->texture_levels = NULL;
	s->exact = s->allocation->few_plants && !is_enough(s);
	enum eco_code code = fill_budget(s, budget, error);
	if (!code && p->input->sent && p->input->request->bytes != ECO_BYTES_UNBOUNDED)
		code = lod_bytes_size(p, error);
	if (!code && p->bytes > p->input->request->bytes)
		code = lod_bytes_fit(s, budget, error);
	return code;
}

/* Coarser levels begin with small steps: the work of a level is known only afterwards. */
static int octaves(int level)
{
	return level >= 0 ? -LOD_FINER_OCTAVES * level : level >= -LOD_SMALL_STEPS ? -level
		: LOD_SMALL_STEPS + LOD_FINER_OCTAVES * (-level - LOD_SMALL_STEPS);
}

/* Visibilities of tiles are made anew at each level; those of plants stay. */
static void drop_tiles(struct lod_screen *screen)
{
	uint32_t kept = 0;
	for (uint32_t i = 0; i < screen->count; i++)
		if (screen->visibilities[i].slot != ECO_NONE) {
			screen->crowns[kept] = screen->crowns[i];
			screen->visibilities[kept++] = screen->visibilities[i];
		}
	if (kept < screen->count)
		screen->shared = 0;
	screen->count = kept;
}

static enum eco_code open_level(struct lod_planner *p, int level, struct eco_error *error)
{
	double pixel = p->visible.eye.pixel_rad, finer = level >= LOD_FINER_TIMES ? 0 : ldexp(1, octaves(level));
	enum eco_code code = lod_planner_open(p, LOD_TILES_PX * pixel * finer, LOD_CELLS_PX * pixel * finer, error);
	if (!code)
		drop_tiles(&p->screen);
	return code;
}

/* Is everything open? */
static bool complete(const struct lod_planner *p)
{
	for (uint32_t n = 0; n < p->visible.node_count; n++)
		if (p->visible.nodes[n].state == LOD_SUMMARY)
			return false;
	for (uint32_t s = 0; s < p->visible.slot_count; s++) {
		const struct lod_slot *slot = &p->visible.slots[s];
		if (slot->count && !slot->cell && p->scene->plants[slot->plant].anchor_count > 1
				&& eco_gate_place(slot->band, 0) >= p->gates[slot->plant])
			return false;
	}
	return true;
}

static bool within_bytes(const struct lod_planner *p)
{
	return !p->hidden && p->input->request->bytes != ECO_BYTES_UNBOUNDED;
}

/* A budget that binds nothing needs no search: the plan is lambda 0 at the finest level that may be opened. */
static bool is_everything(const struct lod_planner *p)
{
	const struct eco_request *r = p->input->request;
	return r->vertices == ECO_VERTICES_MAX && r->bytes == ECO_BYTES_UNBOUNDED;
}

static uint64_t passes(const struct lod_planner *p)
{
	return is_everything(p) ? LOD_PASSES_EVERYTHING : within_bytes(p) ? LOD_PASSES_BYTES : LOD_PASSES_VERTICES;
}

static uint64_t work_of_node(const struct lod_planner *p)
{
	return (within_bytes(p) ? LOD_NODE_BYTES : 1) * LOD_WORK_NODE * passes(p) + LOD_WORK_SUMMARY;
}

/* Work that the plan of this level is expected to take. Tiles, tallies and choices are gone through once for
 * each lambda, and several times for each price of bytes. Cells of the screen are not counted: a view among
 * plants needs many at any level that shows them. Nothing of this depends on the budget: else a larger one
 * might see a coarser level. */
static uint64_t expected_work(const struct lod_planner *p)
{
	uint64_t nodes = p->visible.node_count, each = LOD_SLOT_CHOICES * LOD_WORK_CHOICE
		* (uint64_t)p->visible.slot_count;
	for (uint32_t n = 0; n < nodes; n++)
		each += LOD_WORK_TALLY * (uint64_t)p->visible.nodes[n].tally_count / LOD_TALLIES_UNCHANGED;
	return each * passes(p) + work_of_node(p) * nodes;
}

/* Is the plan of this level, or of one so many times as large, expected to take no more work than it may? */
static bool is_affordable(const struct lod_planner *p, uint64_t times)
{
	return !p->level_work || expected_work(p) < p->level_work / times;
}

/* Plants that a walk may look at: it may have been in vain. */
static uint64_t places_most(const struct lod_planner *p)
{
	uint64_t most = p->level_work / LOD_PLACES_WALKS / LOD_WORK_PLACE;
	return !p->level_work || most > LOD_PLACES_MOST ? LOD_PLACES_MOST : most + 1;
}

/* Cells that the plants of a level may have, if all draw theirs. */
static uint64_t cells_most(const struct lod_planner *p)
{
	return p->level_work / LOD_CELLS_WORK * LOD_PASSES_VERTICES / passes(p);
}

/* Tiles that a plan of any level may have, whatever else is in view. */
static uint64_t nodes_most(const struct lod_planner *p)
{
	uint64_t most = p->level_work / work_of_node(p);
	return p->level_work && most < p->visible.nodes_max ? most + 1 : p->visible.nodes_max;
}

/* Bounds of a level. If no coarser one follows, what a view must open below a tile that is open
 * (ECO_OPEN_TILES_MAX) comes on top: a pack that needs more is no pack of ecopack's. */
static struct lod_walk_bounds bounds_of(const struct lod_planner *p, int level, bool last)
{
	const uint64_t nodes = nodes_most(p), places = places_most(p), cells = level > 0 ? cells_most(p) : 0;
	if (!last)
		return (struct lod_walk_bounds){ .nodes = nodes, .places = places, .cells = cells };
	return p->level_work ? (struct lod_walk_bounds){ nodes + ECO_OPEN_TILES_MAX, places + ECO_OPEN_PLANTS_MAX, nodes, places,
		cells } : (struct lod_walk_bounds){ .cells = cells };
}

/* Opens the finest level from `level` towards coarser ones that is within bounds. At eye height there may be
 * millions of plants up to the horizon, nearly all hidden or smaller than a pixel: their tiles are opened
 * only as far as the bounds allow, of plants and of work. At the coarsest level tiles beyond them show their
 * summaries: where a million plants stand at one place, all of their tiles are around the eye. */
static enum eco_code open_possible(struct lod_planner *p, int *level, struct eco_error *error)
{
	for (;; --*level) {
		struct eco_error local = { 0 };
		bool bound = *level > LOD_COARSEST && (p->scene->needs & ECO_NEED_SUMMARIES);
		p->visible.bounds = bounds_of(p, *level, !bound);
		enum eco_code code = open_level(p, *level, &local);
		bool affordable = code || !bound || is_affordable(p, 1);
		if ((code != ECO_TOO_LARGE && affordable) || *level <= LOD_COARSEST)
			return code ? eco_fail(error, code, "%s", local.text) : ECO_OK;
		p->screen.count = p->screen.stem_count = p->screen.shared = 0;
		code = lod_visible_tree_restart(&p->visible, error);
		if (code)
			return code;
	}
}

enum eco_code lod_planner_open_level(struct lod_planner *p, uint32_t level, struct eco_error *error)
{
	begin_screen(p);
	return open_level(p, (int)level + LOD_COARSEST, error);
}

/* Opens the next finer level, if it is within bounds; else all is as it was. */
static enum eco_code open_finer(struct lod_planner *p, int *level, bool *opened, struct eco_error *error)
{
	const bool summaries = p->scene->needs & ECO_NEED_SUMMARIES;
	struct eco_error local = { 0 };
	p->visible.bounds = (struct lod_walk_bounds){ .nodes = summaries ? nodes_most(p) : 0, .cells = cells_most(p),
		.places = summaries ? places_most(p) * LOD_PASSES_VERTICES / passes(p) : 0 };
	enum eco_code code = open_level(p, *level + 1, &local);
	*opened = !code;
	*level += *opened;
	return code && code != ECO_TOO_LARGE ? eco_fail(error, code, "%s", local.text) : ECO_OK;
}

/* Plans level by level, until one has steps left or everything is open. If all of a level fits, or it
 * hides plants, only the next one is filled. A plan of everything has one level, the finest possible. */
static enum eco_code plan_levels(struct lod_lambda_search *s, struct lod_planner *p, struct eco_error *error)
{
	const bool bytes = p->input->request->bytes != ECO_BYTES_UNBOUNDED, everything = is_everything(p);
	int level = everything ? LOD_FINER_TIMES : 0;
	bool opened = true;
	enum eco_code code = open_possible(p, &level, error);
	while (!code && opened) {
		bool may = !everything && !complete(p) && level < LOD_FINER_TIMES,
			finer = may && is_affordable(p, LOD_FINER_WORK);
		p->level = (uint32_t)(level - LOD_COARSEST);
		code = search_level(s, p, error);
		opened = false;
		p->hidden = !code && may && hides_plants(s->allocation);
		if (!code && (p->hidden ? is_affordable(p, LOD_FINER_WORK)
				: finer && !bytes && s->index == LOD_LAMBDA_COUNT)) {
			code = open_finer(p, &level, &opened, error);
			finer = false;
		}
		if (!code && !opened)
			code = fill_level(s, p, error);
		if (!code && finer && p->cheapest == UINT64_MAX && !draws_whole(p) && !(p->price > 0))
			code = open_finer(p, &level, &opened, error);
	}
	return code;
}

enum eco_code lod_rule_optimal(struct lod_planner *p, struct eco_error *error)
{
	struct lod_lambda_search *s = p->search = calloc(1, sizeof *s);
	s = s && (s->allocation = calloc(1, sizeof *s->allocation)) ? s : NULL;
	if (!s)
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for a search");
	begin_screen(p);
	return plan_levels(s, p, error);
}

void lod_search_free(struct lod_lambda_search *s)
{
	if (s && s->allocation)
		lod_allocation_free(s->allocation);
	free(s ? s->allocation : NULL);
	free(s);
}
