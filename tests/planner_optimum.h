/* The planner against the best there is, in random scenes so small that everything can be tried: a root and its tiles, each with a summary
 * or its plants, of a few species, each with one list of a few elements and a random curve.
 *
 * The objective is the planner's own: what is seen of each plant and tile is taken from lod/market.h. What can be drawn is tried here: every
 * choice of tiles to open; for these the best use of every budget up to the scene's, offer by offer (a knapsack), where each plant may
 * have an amount of its own. That is more than a plan can say, so no plan is better. A plan is judged by its cuts. */
#ifndef TESTS_PLANNER_OPTIMUM_H
#define TESTS_PLANNER_OPTIMUM_H

#include <assert.h>
#include <math.h>

#include "lod/ladder.h"
#include "lod/market.h"
#include "lod/planner.h"
#include "tests/scene_random.h"

#define OPTIMUM_BUDGET_MOST 240u
#define OPTIMUM_TILES_MOST 4u

struct optimum { double empty, best, plan; uint64_t budget; };        /* what is wrong with nothing drawn, at best, and by the plan */

/* ---- Scenes ---- */

static inline void optimum_species(struct random_scene *r)
{
	struct eco_scene *s = &r->scene;
	uint32_t id = s->plant_count++, elements = 2 + random_below(r, 9);
	float h = (float)random_real(r, 1, 12);
	r->plants[id] = (struct eco_plant){ .height_m = h, .anchor_first = s->anchor_count, .anchor_count = 1, .ladder_first = s->ladder_count,
		.ladder_count = 1, .area = h * h * (float)random_real(r, 0.2, 3) };
	r->anchors[s->anchor_count++] = (struct eco_anchor){ { 0, 0, h / 2 }, h / 2 };
	struct eco_ladder *l = &r->ladders[s->ladder_count++];
	*l = (struct eco_ladder){ .plant = id, .anchor = id, .organ = ECO_ORGAN_FOLIAGE, .points = ECO_NONE, .lines = ECO_NONE, .simple = ECO_NONE,
		.triangles = random_list(r, ECO_LIST_TRIANGLES, elements, id, ECO_NONE), .total = elements, .importance = 1, .area = r->plants[id].area,
		.curve_first = s->curve_count, .curve_count = 5 };
	float fp = (float)random_real(r, 0.1, 0.6), fn = (float)random_real(r, 0.4, 0.9);
	for (int i = 0; i < 5; i++) {
		float share = i == 4 ? 1 : (float)(i + 1) / 6;
		r->curves[s->curve_count++] = (struct eco_curve){ share, 1, share, i == 4 ? 0 : fp, i == 4 ? 0 : fn };
		fp *= (float)random_real(r, 0.4, 1);
		fn *= (float)random_real(r, 0.4, 1);
	}
}

static inline void optimum_tile(struct random_scene *r, uint32_t tile, double x)
{
	struct eco_scene *s = &r->scene;
	struct eco_tile *t = &r->tiles[tile];
	*t = (struct eco_tile){ .low = { x, 0, 0 }, .high = { x + 20, 20, 12 }, .group_first = s->group_count, .summary = ECO_NONE };
	t->group_count = 1 + random_below(r, s->plant_count);
	for (uint32_t g = 0; g < t->group_count; g++) {
		uint32_t count = 1 + random_below(r, 3), list = random_list(r, ECO_LIST_INSTANCES, count, tile, g);
		r->lists[list].grid_origin[0] = x;
		r->groups[s->group_count++] = (struct eco_group){ tile, g, list, s->place_count };
		for (uint32_t i = 0; i < count; i++) {
			uint8_t *at = r->places + ECO_PLACE_BYTES * s->place_count++;
			int32_t p[3] = { (int32_t)random_below(r, 20000), (int32_t)random_below(r, 20000), 0 };
			uint32_t scale = 65536;
			memset(at, 0, ECO_PLACE_BYTES);
			memcpy(at, p, 12);                   /* tests run on little-endian machines */
			memcpy(at + 16, &scale, 4);
		}
		t->instance_count += count;
		t->area += (double)r->plants[g].area * count;
	}
	t->summary = random_list(r, ECO_LIST_POINTS, 4 + random_below(r, 28), tile, ECO_NONE);
}

static inline void optimum_scene(struct random_scene *r, struct eco_request *request, uint64_t seed)
{
	memset(r, 0, sizeof *r);
	r->state = seed;
	struct eco_scene *s = &r->scene;
	*s = (struct eco_scene){ .near_m = 0.01, .plants = r->plants, .anchors = r->anchors, .ladders = r->ladders, .curves = r->curves,
		.tiles = r->tiles, .groups = r->groups, .children = r->children, .lists = r->lists, .chunks = r->chunks, .places = r->places };
	for (uint32_t species = 1 + random_below(r, 3); species > 0; species--)
		optimum_species(r);
	uint32_t tiles = 1 + random_below(r, OPTIMUM_TILES_MOST);
	s->tile_count = 1 + tiles;
	r->tiles[0] = (struct eco_tile){ .high = { 20.0 * tiles, 20, 12 }, .child_count = tiles };
	for (uint32_t i = 0; i < tiles; i++) {
		optimum_tile(r, 1 + i, 20.0 * i);
		r->children[s->child_count++] = (struct eco_child){ .tile = 1 + i, .scale = 1 };
		r->tiles[0].instance_count += r->tiles[1 + i].instance_count;
		r->tiles[0].area += r->tiles[1 + i].area;
	}
	r->tiles[0].summary = random_list(r, ECO_LIST_POINTS, 8 + random_below(r, 24), 0, ECO_NONE);
	*request = (struct eco_request){ .view = { .eye = { 10.0 * tiles, random_real(r, -120, -25), random_real(r, 2, 60) },
		.target = { 10.0 * tiles, 10, 3 }, .up = { 0, 0, 1 }, .fov_y_deg = 60, .width = 640, .height = 480 },
		.vertices = 1 + random_below(r, OPTIMUM_BUDGET_MOST), .bytes = ECO_BYTES_UNBOUNDED };
}

/* ---- The best ---- */

/* Amounts that nothing can draw are infinitely wrong. */
static inline double optimum_offer_error(const struct lod_market *m, const struct lod_offer *o, uint64_t vertices)
{
	const struct eco_scene *scene = m->p->scene;
	const struct eco_ladder *ladder = &scene->ladders[o->ladder];
	if (lod_ladder_floor(scene, ladder, vertices) != vertices)
		return INFINITY;
	struct eco_curve curve = lod_ladder_curve(scene, ladder, lod_ladder_share(scene, ladder, vertices));
	return (double)curve.fn + o->steps->extra * (double)curve.fp;
}

static inline double optimum_summary_error(const struct lod_stall *stall, uint64_t points)
{
	const struct lod_steps *s = &stall->steps;
	uint32_t i = 0;
	while (i + 1 < s->count && s->amounts[i + 1].vertices <= points)
		i++;
	double now = lod_steps_error(s, &s->amounts[i]);
	if (i + 1 == s->count)
		return now;
	double part = (double)(points - s->amounts[i].vertices) / (double)(s->amounts[i + 1].vertices - s->amounts[i].vertices);
	return now + part * (lod_steps_error(s, &s->amounts[i + 1]) - now);
}

/* best[v] becomes the least that v vertices, in both together, leave wrong. */
static inline void optimum_join(double *best, const double *more, uint64_t budget)
{
	for (uint64_t v = budget + 1; v-- > 0;) {
		double least = INFINITY;
		for (uint64_t k = 0; k <= v; k++)
			least = fmin(least, best[v - k] + more[k]);
		best[v] = least;
	}
}

/* With the children in `open` drawn plant by plant and the others by their summaries. */
static inline double optimum_of_tiles(const struct lod_market *m, uint32_t open, uint64_t budget)
{
	const struct lod_visible *visible = &m->p->visible;
	double best[OPTIMUM_BUDGET_MOST + 1] = { 0 }, one[OPTIMUM_BUDGET_MOST + 1], seen[RANDOM_MOST] = { 0 };
	uint64_t counts[RANDOM_MOST] = { 0 };
	for (uint32_t c = 0; c < visible->nodes[0].child_count; c++) {
		uint32_t n = visible->nodes[0].child_first + c;
		const struct lod_node *node = &visible->nodes[n];
		const struct lod_stall *stall = &m->stalls[n];
		for (uint32_t i = 0; open >> c & 1 && i < node->tally_count; i++) {
			counts[node->tallies[i].slot] += node->tallies[i].count;
			seen[node->tallies[i].slot] += node->tallies[i].count * stall->factor;
		}
		if (open >> c & 1)
			continue;
		for (uint64_t v = 0; v <= budget; v++)
			one[v] = stall->worth * (stall->summary ? optimum_summary_error(stall, v) : 1);
		optimum_join(best, one, budget);
	}
	for (uint32_t i = 0; i < m->offer_count; i++) {
		const struct lod_offer *o = &m->offers[i];
		if (counts[o->slot] == 0)
			continue;
		for (uint64_t v = 0; v <= budget; v++)
			one[v] = o->worth * seen[o->slot] / (double)counts[o->slot] * optimum_offer_error(m, o, v);
		for (uint64_t plant = 0; plant < counts[o->slot]; plant++)
			optimum_join(best, one, budget);
	}
	double least = INFINITY;
	for (uint64_t v = 0; v <= budget; v++)
		least = fmin(least, best[v]);
	return least;
}

static inline double optimum_best(const struct lod_market *m, uint64_t budget)
{
	const struct lod_node *root = &m->p->visible.nodes[0];
	double best = m->stalls[0].worth;
	if (m->stalls[0].summary)
		for (uint64_t v = 0; v <= budget; v++)
			best = fmin(best, m->stalls[0].worth * optimum_summary_error(&m->stalls[0], v));
	for (uint32_t open = 0; open < 1u << root->child_count; open++) {
		bool possible = true;
		for (uint32_t c = 0; c < root->child_count; c++)
			possible = possible && (!(open >> c & 1) || m->stalls[root->child_first + c].open);
		if (possible)
			best = fmin(best, optimum_of_tiles(m, open, budget));
	}
	return best;
}

/* ---- The plan ---- */

static inline uint64_t optimum_drawn(const struct lod_market *m, const struct eco_plan *plan, const struct lod_offer *o, uint32_t hash)
{
	const struct lod_slot *slot = &m->p->visible.slots[o->slot];
	const struct eco_ladder *ladder = &m->p->scene->ladders[o->ladder];
	uint64_t sum = 0;
	for (uint32_t i = 0; i < plan->cut_count; i++) {
		const struct eco_cut *c = &plan->cuts[i];
		if (c->anchor == slot->anchor && c->list == ladder->triangles && slot->band >= c->band_first && slot->band < c->band_end
				&& hash >= c->share_first && hash < c->share_end)
			sum += 3 * (uint64_t)(c->end - c->first);
	}
	return sum;
}

/* -1: its plants are drawn; else what it leaves wrong. */
static inline double optimum_of_node(const struct lod_market *m, const struct eco_plan *plan, uint32_t n)
{
	const struct lod_planning *p = m->p;
	const struct eco_tile *tile = &p->scene->tiles[p->visible.nodes[n].tile];
	for (uint32_t i = 0; i < plan->cut_count; i++)
		if (plan->cuts[i].anchor == ECO_NONE && plan->cuts[i].list == tile->summary)
			return m->stalls[n].worth * optimum_summary_error(&m->stalls[n], plan->cuts[i].end);
	for (uint32_t i = 0; i < plan->run_count && tile->group_count; i++) {
		uint32_t list = p->scene->groups[tile->group_first].list;
		if (list >= plan->runs[i].list_first && list < plan->runs[i].list_end)
			return -1;
	}
	return m->stalls[n].worth;
}

/* Plants of a slot count alike, as much as they are seen in the mean: which of them have more is left to their hashes. */
static inline double optimum_of_plan(const struct lod_market *m, const struct eco_plan *plan)
{
	const struct lod_planning *p = m->p;
	double wrong = optimum_of_node(m, plan, 0), seen[RANDOM_MOST] = { 0 }, counts[RANDOM_MOST] = { 0 };
	bool open[RANDOM_MOST] = { false };
	if (wrong < m->stalls[0].worth)
		return wrong;
	wrong = 0;
	for (uint32_t n = 1; n < p->visible.node_count; n++) {
		double own = optimum_of_node(m, plan, n);
		open[n] = own < 0;
		wrong += open[n] ? 0 : own;
		for (uint32_t i = 0; open[n] && i < p->visible.nodes[n].tally_count; i++) {
			const struct lod_tally *t = &p->visible.nodes[n].tallies[i];
			seen[t->slot] += t->count * m->stalls[n].factor;
			counts[t->slot] += t->count;
		}
	}
	for (uint32_t i = 0; i < p->screen.count; i++) {
		const struct lod_sight *sight = &p->screen.sights[i];
		for (uint32_t k = 0; open[sight->node] && sight->slot != ECO_NONE && k < m->offer_count; k++)
			if (m->offers[k].slot == sight->slot)
				wrong += m->offers[k].worth * seen[sight->slot] / counts[sight->slot]
					* optimum_offer_error(m, &m->offers[k], optimum_drawn(m, plan, &m->offers[k], sight->hash));
	}
	return wrong;
}

/* `r` is room for the scene. False where nothing of it is in view, or it is too far away to be opened. */
static inline bool optimum_find(struct optimum *o, struct random_scene *r, uint64_t seed)
{
	struct eco_request request;
	struct eco_error error = { 0 };
	struct lod_planning p;
	struct lod_market m;
	struct eco_plan plan;
	optimum_scene(r, &request, seed);
	struct lod_planner_stats stats;
	struct lod_planner_input input = { .scene = &r->scene, .request = &request, .stats = &stats };
	assert(!lod_plan(&plan, &input, &error));
	assert(!lod_planning_begin(&p, &input, &error) && !lod_planning_look(&p, stats.level, &error) && !lod_market_make(&m, &p, &error));
	bool usable = m.stalls[0].open && m.stalls[0].worth > 0;
	if (usable)
		*o = (struct optimum){ m.stalls[0].worth, optimum_best(&m, request.vertices), optimum_of_plan(&m, &plan), request.vertices };
	eco_plan_free(&plan);
	lod_market_free(&m);
	lod_planning_end(&p);
	return usable;
}

#endif
