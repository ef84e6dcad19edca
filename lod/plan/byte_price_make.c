/* Bytes of the lists in view (lod/plan/byte_price.h): ladders by steps, tiles, summaries. */
#include "lod/plan/byte_price.h"

#include <math.h>
#include <stdlib.h>

#include "lod/plan/allocation.h"

/* ---- Bytes ---- */

double lod_prices_missing(const struct lod_allocation *m, uint32_t list, uint32_t from, uint32_t to)
{
	const uint32_t held = m->prices->held[list], kept = m->prices->kept[list];
	double sum = 0;
	for (uint32_t c = from > held ? from : held; c < to; c++)
		sum += (c < kept ? 1 : m->prices->factor) * eco_wire_chunk_bytes(m->p->scene, list, c);
	return sum;
}

static double missing_all(const struct lod_allocation *m, uint32_t list)
{
	return lod_prices_missing(m, list, 0, m->p->scene->lists[list].chunk_count);
}

/* ---- Ladders ---- */

static uint32_t list_of(struct ladder_price *l, uint32_t list)
{
	uint32_t i = 0;
	while (i < l->list_count && l->lists[i] != list)
		i++;
	if (i == l->list_count)
		l->lists[l->list_count++] = list;
	return i;
}

/* as: the list that pays for it. */
static void need(const struct lod_allocation *m, struct ladder_price *l, struct chunks *needs, uint32_t as,
	uint32_t list, uint32_t end)
{
	uint32_t i = list_of(l, as), chunks = lod_plan_chunks_for(m->p->scene, list, end);
	needs->of[i] = chunks > needs->of[i] ? chunks : needs->of[i];
}

void lod_prices_add_needs(struct chunks *sum, const struct chunks *more)
{
	for (int i = 0; i < LISTS_OF_LADDER; i++)
		sum->of[i] = more->of[i] > sum->of[i] ? more->of[i] : sum->of[i];
}

double lod_prices_of(const struct ladder_price *l, const struct chunks *needs)
{
	double sum = 0;
	for (uint32_t i = 0; i < l->list_count; i++)
		sum += l->prefixes[i][needs->of[i]];
	return sum;
}

/* Returns the texture of what is drawn, and the share that shows it; ECO_NONE: there is none. */
static uint32_t find_needs(const struct lod_allocation *m, const struct lod_way *way, uint64_t vertices,
	struct ladder_price *l, struct step *step)
{
	struct chunks *needs = &step->needs;
	uint32_t image = ECO_NONE, drawn = 0, textured = 0;
	uint32_t cells[ECO_FRONT_MAX];
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
	step->vertices = vertices;
	if (vertices == 0)
		return ECO_NONE;
	if (vertices == 1 && lod_hull_impostor_levels(way)) {
		need(m, l, needs, way->ladder->impostor, way->ladder->impostor, 1);
		return ECO_NONE;
	}
	uint32_t count = lod_way_cuts(way, vertices, lod_way_density(way, vertices), 0, cuts);
	if (count > 2)
		eco_ladder_front(m->p->scene, way->ladder, cells);
	for (uint32_t i = 0; i < count; i++) {
		/* cells before splats are drawn alike: one list pays for all */
		need(m, l, needs, i && i + 1 < count ? cells[0] : cuts[i].list, cuts[i].list, cuts[i].end);
		drawn += cuts[i].end - cuts[i].first;
		if (m->p->scene->lists[cuts[i].list].image == ECO_NONE)
			continue;
		image = m->p->scene->lists[cuts[i].list].image;
		textured += cuts[i].end - cuts[i].first;
	}
	step->shown = textured ? (double)textured / drawn : 0;
	return image;
}

static uint32_t steps_of(const struct lod_plan_tables_ladder *table)
{
	return table->hull[0].count + table->hull[1].count + 1;
}

/* Steps are all points that the hulls of its slots may have. */
static void find_steps(const struct lod_allocation *m, struct ladder_price *l)
{
	l->image = l->textured = ECO_NONE;
	const struct lod_plan_tables_ladder *table = lod_plan_tables_ladder(m->p->tables, l->ladder);
	l->steps = 0;
	for (int h = 0; h < 3; h++)
		for (uint32_t i = 0; i < (h < 2 ? table->hull[h].count : 1); i++) {
			uint64_t vertices = h < 2 ? table->hull[h].points[i].vertices : table->way.full;
			if (l->steps && vertices <= l->at[l->steps - 1].vertices)
				continue;
			uint32_t image = find_needs(m, &table->way, vertices, l, &l->at[l->steps]);
			if (image != ECO_NONE && l->image == ECO_NONE) {
				l->image = image;
				l->textured = l->steps;
			}
			l->steps++;
		}
}

/* Prices of all prefixes of a ladder's lists. */
static bool find_prefixes(struct lod_allocation *m, struct ladder_price *l)
{
	const struct eco_scene *scene = m->p->scene;
	const struct eco_ladder *ladder = &scene->ladders[l->ladder];
	uint32_t cells[ECO_FRONT_MAX], cell_count = eco_ladder_has_splats(scene, ladder)
		? eco_ladder_front(scene, ladder, cells) : 0;
	for (uint32_t k = 0; k < l->list_count; k++) {
		const uint32_t *lists = &l->lists[k];
		uint32_t count = 1, chunks = 0;
		if (cell_count && *lists == cells[0]) {
			lists = cells;
			count = cell_count;
		}
		for (uint32_t i = 0; i < count; i++)
			chunks = scene->lists[lists[i]].chunk_count > chunks ? scene->lists[lists[i]].chunk_count : chunks;
		double *to = lod_arena_try(&m->prices->memory, chunks + 1u, sizeof *to);
		if (!to)
			return false;
		l->prefixes[k] = to;
		for (uint32_t c = 0; c < chunks; c++) {
			to[c + 1] = to[c];
			for (uint32_t i = 0; i < count; i++)
				if (c < scene->lists[lists[i]].chunk_count)
					to[c + 1] += lod_prices_missing(m, lists[i], c, c + 1);
		}
	}
	return true;
}

static bool make_ladders(struct lod_allocation *m)
{
	struct lod_prices *prices = m->prices;
	struct lod_arena *a = &prices->memory;
	uint32_t *of = lod_arena_try(a, m->p->scene->ladder_count, sizeof *of), first = 0;
	prices->choices = lod_arena_try(a, m->ladder_choice_count, sizeof *prices->choices);
	prices->ladders = lod_arena_try(a, m->ladder_choice_count, sizeof *prices->ladders);
	if (a->failed)
		return false;
	for (uint32_t i = 0; i < m->ladder_choice_count; i++) {
		uint32_t ladder = m->ladder_choices[i].ladder;
		if (!of[ladder]) {
			of[ladder] = ++prices->ladder_count;
			prices->ladders[of[ladder] - 1].ladder = ladder;
			prices->ladders[of[ladder] - 1].plant = m->p->scene->ladders[ladder].plant;
		}
		prices->ladders[of[ladder] - 1].count++;
	}
	for (uint32_t i = 0; i < prices->ladder_count; i++) {
		prices->ladders[i].first = first;
		first += prices->ladders[i].count;
		prices->ladders[i].count = 0;
	}
	for (uint32_t i = 0; i < m->ladder_choice_count; i++) {
		struct ladder_price *l = &prices->ladders[of[m->ladder_choices[i].ladder] - 1];
		prices->choices[l->first + l->count++] = i;
	}
	for (uint32_t i = 0; i < prices->ladder_count; i++) {
		struct ladder_price *l = &prices->ladders[i];
		l->at = lod_arena_try(a, steps_of(lod_plan_tables_ladder(m->p->tables, l->ladder)), sizeof *l->at);
		if (!l->at)
			return false;
		find_steps(m, l);
		if (!find_prefixes(m, l))
			return false;
	}
	return lod_images_make(m);
}

/* ---- Tiles ---- */

static bool make_tiles(struct lod_allocation *m)
{
	const struct lod_planner *p = m->p;
	const struct eco_scene *scene = p->scene;
	uint32_t nodes = p->visible.node_count;
	struct lod_arena *a = &m->prices->memory;
	uint32_t *occurrences = lod_arena_try(a, scene->tile_count, sizeof *occurrences);
	m->prices->part = lod_arena_try(a, nodes, sizeof *m->prices->part);
	m->prices->instances = lod_arena_try(a, nodes, sizeof *m->prices->instances);
	m->prices->points = lod_arena_try(a, nodes, sizeof *m->prices->points);
	if (a->failed)
		return false;
	for (uint32_t n = 0; n < nodes; n++)
		occurrences[p->visible.nodes[n].tile]++;
	for (uint32_t n = 0; n < nodes; n++) {
		const struct eco_tile *tile = &scene->tiles[p->visible.nodes[n].tile];
		double part = m->prices->part[n] = 1.0 / occurrences[p->visible.nodes[n].tile];
		for (uint32_t g = 0; m->tile_choices[n].open && g < tile->group_count; g++) {
			uint32_t list = scene->groups[tile->group_first + g].list;
			if (scene->groups[tile->group_first + g].first)
				continue;
			m->prices->instances[n] += part * missing_all(m, list);
		}
		if (m->tile_choices[n].has_summary)
			m->prices->points[n] = part * missing_all(m, tile->summary)
				/ scene->lists[tile->summary].primitive_count;
	}
	return true;
}

struct lod_summary_price lod_prices_summary(const struct lod_allocation *m, uint32_t node, double points)
{
	const struct eco_scene *scene = m->p->scene;
	uint32_t list = scene->tiles[m->p->visible.nodes[node].tile].summary;
	const struct eco_list *l = &scene->lists[list];
	struct lod_summary_price price = { 0 };
	uint32_t chunks = 0;
	while (price.points < points && chunks < l->chunk_count) {
		price.before = price.points;
		price.points += scene->chunks[l->chunk_first + chunks++].primitive_count;
	}
	price.bytes = lod_prices_missing(m, list, 0, chunks) * m->prices->part[node];
	return price;
}

/* ---- Making ---- */

void lod_prices_work(struct lod_allocation *m)
{
	lod_planner_work(m->p, LOD_WORK_CHOICE * (uint64_t)m->ladder_choice_count);
}

/* Chunks per list; `others` of those that have none. NULL: no memory, which the arena knows. */
static uint32_t *chunks_of(struct lod_arena *a, const struct eco_scene *scene, const struct eco_holdings *holdings,
	uint32_t others)
{
	uint32_t *chunks = lod_arena_try(a, scene->list_count, sizeof *chunks);
	for (uint32_t i = 0; chunks && others && i < scene->list_count; i++)
		chunks[i] = others;
	for (uint32_t i = 0; chunks && holdings && i < holdings->count; i++)
		chunks[holdings->items[i].list] = holdings->items[i].chunks;
	return chunks;
}

enum eco_code lod_prices_make(struct lod_allocation *m, const struct eco_holdings *kept, double times,
	struct eco_error *error)
{
	uint32_t nodes = m->p->visible.node_count, plants = m->p->scene->plant_count;
	lod_prices_free(m);
	struct lod_prices *prices = m->prices = calloc(1, sizeof *prices);
	bool good = prices;
	if (prices) {
		struct lod_arena *a = &prices->memory;
		prices->factor = times;
		prices->held = chunks_of(a, m->p->scene, m->p->input->holdings, 0);
		prices->kept = chunks_of(a, m->p->scene, kept, kept ? 0 : UINT32_MAX);
		prices->organs_off = lod_arena_try(a, plants, sizeof *prices->organs_off);
		prices->saved = lod_arena_try(a, plants, sizeof *prices->saved);
		prices->spent = lod_arena_try(a, plants, sizeof *prices->spent);
		good = !a->failed && make_ladders(m) && make_tiles(m);
	}
	lod_prices_work(m);
	const struct eco_view *view = &m->p->input->request->view;
	if (nodes)
		m->p->image.share = fmax(LOD_GROUND_LEAST, 1 - m->tile_choices[0].pixels
			/ ((double)view->width * view->height));
	return good ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "planning: no memory for the bytes of %u tiles",
		nodes);
}

void lod_prices_free(struct lod_allocation *m)
{
	struct lod_prices *prices = m->prices;
	if (!prices)
		return;
	lod_arena_free(&prices->memory);
	free(prices);
	m->prices = NULL;
	m->tries.count = 0;
	m->relaxed.lambda = m->tiles.lambda = NAN;
}
