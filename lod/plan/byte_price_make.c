/* Bytes of the lists in view (lod/plan/byte_price.h): ladders by steps, tiles, summaries. */
#include "lod/plan/byte_price.h"

#include <math.h>
#include <stdlib.h>

#include "lod/plan/byte_price_state.h"
#include "lod/plan/allocation.h"

#define GROUND_LEAST 0.1         /* share of the ground that shows, at least */

/* ---- Bytes ---- */

static double chunk_bytes(const struct lod_planner *p, uint32_t list, uint32_t ordinal)
{
	const struct eco_list *l = &p->scene->lists[list];
	return (double)p->scene->chunks[l->chunk_first + ordinal].size_bytes + LOD_CHUNK_FRAME_BYTES
		+ (ordinal ? 0 : LOD_LIST_FRAME_BYTES + LOD_GROUP_FRAME_BYTES * (double)l->group_count);
}

/* Chunks [from, to) of a list that the client lacks. */
double lod_prices_missing(const struct lod_allocation *m, uint32_t list, uint32_t from, uint32_t to)
{
	uint32_t held = eco_holdings_chunks(m->p->input->holdings, list);
	double sum = 0;
	for (uint32_t c = from > held ? from : held; c < to; c++)
		sum += chunk_bytes(m->p, list, c);
	return sum;
}

/* Their cost beside their bytes. */
double lod_prices_waste(const struct lod_allocation *m, uint32_t list, uint32_t from, uint32_t to)
{
	uint32_t kept = m->prices->kept ? eco_holdings_chunks(m->prices->kept, list) : to;
	return kept < to ? m->prices->factor * lod_prices_missing(m, list, from > kept ? from : kept, to) : 0;
}

static double missing_all(const struct lod_allocation *m, uint32_t list)
{
	return lod_prices_missing(m, list, 0, m->p->scene->lists[list].chunk_count);
}

static double waste_all(const struct lod_allocation *m, uint32_t list)
{
	return lod_prices_waste(m, list, 0, m->p->scene->lists[list].chunk_count);
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

static void need(const struct lod_allocation *m, struct ladder_price *l, struct chunks *needs, uint32_t list,
	uint32_t end)
{
	uint32_t i = list_of(l, list), chunks = lod_plan_chunks_for(m->p->scene, list, end);
	needs->of[i] = chunks > needs->of[i] ? chunks : needs->of[i];
}

void lod_prices_add_needs(struct chunks *sum, const struct chunks *more)
{
	for (int i = 0; i < LISTS_OF_LADDER; i++)
		sum->of[i] = more->of[i] > sum->of[i] ? more->of[i] : sum->of[i];
}

struct price lod_prices_of(const struct ladder_price *l, const struct chunks *needs)
{
	struct price sum = { 0 };
	for (uint32_t i = 0; i < l->list_count; i++) {
		sum.bytes += l->prefixes[i][needs->of[i]].bytes;
		sum.waste += l->prefixes[i][needs->of[i]].waste;
	}
	return sum;
}

/* Returns the texture of what is drawn, and the share that shows it; ECO_NONE: there is none. */
static uint32_t find_needs(const struct lod_allocation *m, const struct lod_way *way, uint64_t vertices,
	struct ladder_price *l, struct chunks *needs, float *shown)
{
	uint32_t image = ECO_NONE, drawn = 0, textured = 0;
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
	*needs = (struct chunks){ { 0 } };
	*shown = 0;
	if (vertices == 0)
		return ECO_NONE;
	if (vertices == 1 && lod_hull_impostor_levels(way)) {
		need(m, l, needs, way->ladder->impostor, 1);
		return ECO_NONE;
	}
	uint32_t count = lod_way_cuts(way, vertices, lod_way_density(way, vertices), 0, cuts);
	for (uint32_t i = 0; i < count; i++) {
		need(m, l, needs, cuts[i].list, cuts[i].end);
		drawn += cuts[i].end - cuts[i].first;
		if (m->p->scene->lists[cuts[i].list].image == ECO_NONE)
			continue;
		image = m->p->scene->lists[cuts[i].list].image;
		textured += cuts[i].end - cuts[i].first;
	}
	*shown = textured ? (float)textured / (float)drawn : 0;
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
			if (l->steps && vertices <= l->vertices[l->steps - 1])
				continue;
			uint32_t image = find_needs(m, &table->way, vertices, l, &l->needs[l->steps],
				&l->shown[l->steps]);
			if (image != ECO_NONE && l->image == ECO_NONE) {
				l->image = image;
				l->textured = l->steps;
			}
			l->vertices[l->steps++] = vertices;
		}
}

/* Prices of all prefixes of the lists of all ladders. */
static bool make_prefixes(struct lod_allocation *m)
{
	struct lod_prices *prices = m->prices;
	size_t count = 0;
	for (uint32_t i = 0; i < prices->ladder_count; i++)
		for (uint32_t k = 0; k < prices->ladders[i].list_count; k++)
			count += m->p->scene->lists[prices->ladders[i].lists[k]].chunk_count + 1u;
	struct price *to = prices->prefixes = malloc((count + 1) * sizeof *to);
	for (uint32_t i = 0; to && i < prices->ladder_count; i++)
		for (uint32_t k = 0; k < prices->ladders[i].list_count; k++) {
			uint32_t list = prices->ladders[i].lists[k];
			uint32_t chunks = m->p->scene->lists[list].chunk_count;
			prices->ladders[i].prefixes[k] = to;
			*to++ = (struct price){ 0 };
			for (uint32_t c = 0; c < chunks; c++, to++) {
				to->bytes = to[-1].bytes + lod_prices_missing(m, list, c, c + 1);
				to->waste = to[-1].waste + lod_prices_waste(m, list, c, c + 1);
			}
		}
	return prices->prefixes;
}

static bool make_ladders(struct lod_allocation *m)
{
	struct lod_prices *prices = m->prices;
	uint32_t *of = calloc(m->p->scene->ladder_count + 1u, sizeof *of), steps = 0, first = 0;
	prices->choices = malloc((m->ladder_choice_count + 1u) * sizeof *prices->choices);
	prices->drawn = calloc(m->ladder_choice_count + 1u, sizeof *prices->drawn);
	prices->ladders = calloc(m->ladder_choice_count + 1u, sizeof *prices->ladders);
	if (!of || !prices->choices || !prices->drawn || !prices->ladders) {
		free(of);
		return false;
	}
	for (uint32_t i = 0; i < m->ladder_choice_count; i++) {
		uint32_t ladder = m->ladder_choices[i].ladder;
		if (!of[ladder]) {
			of[ladder] = ++prices->ladder_count;
			prices->ladders[of[ladder] - 1].ladder = ladder;
			prices->ladders[of[ladder] - 1].lambda = NAN;
			steps += steps_of(lod_plan_tables_ladder(m->p->tables, ladder));
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
	free(of);
	prices->vertices = malloc((steps + 1u) * sizeof *prices->vertices);
	prices->needs = malloc((steps + 1u) * sizeof *prices->needs);
	prices->gain = malloc((steps + 1u) * sizeof *prices->gain);
	prices->rests = malloc((steps + 1u) * sizeof *prices->rests);
	prices->more_px = malloc((steps + 1u) * sizeof *prices->more_px);
	prices->shown = malloc((steps + 1u) * sizeof *prices->shown);
	if (!prices->vertices || !prices->needs || !prices->gain || !prices->rests || !prices->more_px
			|| !prices->shown)
		return false;
	steps = 0;
	for (uint32_t i = 0; i < prices->ladder_count; i++) {
		struct ladder_price *l = &prices->ladders[i];
		l->vertices = prices->vertices + steps;
		l->needs = prices->needs + steps;
		l->gain = prices->gain + steps;
		l->rests = prices->rests + steps;
		l->more_px = prices->more_px + steps;
		l->shown = prices->shown + steps;
		find_steps(m, l);
		steps += l->steps;
	}
	return make_prefixes(m) && lod_images_make(m);
}

/* ---- Tiles ---- */

/* Sets the part that each occurrence of a tile in view pays, and the nodes that pay only a part. */
static bool make_parts(struct lod_allocation *m)
{
	const struct lod_visible_tree *visible = &m->p->visible;
	uint32_t tiles = m->p->scene->tile_count, *first = calloc(tiles + 2u, sizeof *first);
	m->prices->part = malloc((visible->node_count + 1u) * sizeof *m->prices->part);
	m->prices->shared = malloc((visible->node_count + 1u) * sizeof *m->prices->shared);
	bool good = first && m->prices->part && m->prices->shared;
	for (uint32_t n = 0; good && n < visible->node_count; n++)
		first[visible->nodes[n].tile + 2]++;
	for (uint32_t n = 0; good && n < visible->node_count; n++)
		m->prices->part[n] = 1.0 / first[visible->nodes[n].tile + 2];
	for (uint32_t t = 2; good && t < tiles + 2; t++)
		first[t] = first[t - 1] + (first[t] > 1 ? first[t] : 0);
	for (uint32_t n = 0; good && n < visible->node_count; n++)
		if (m->prices->part[n] < 1)
			m->prices->shared[first[visible->nodes[n].tile + 1]++] = n;
	m->prices->shared_count = good ? first[tiles + 1] : 0;
	free(first);
	return good;
}

static bool make_tiles(struct lod_allocation *m)
{
	const struct lod_planner *p = m->p;
	const struct eco_scene *scene = p->scene;
	uint32_t nodes = p->visible.node_count;
	m->prices->instances = calloc(nodes + 1u, sizeof *m->prices->instances);
	m->prices->instances_waste = calloc(nodes + 1u, sizeof *m->prices->instances_waste);
	m->prices->points = calloc(nodes + 1u, sizeof *m->prices->points);
	if (!make_parts(m) || !m->prices->instances || !m->prices->instances_waste || !m->prices->points)
		return false;
	for (uint32_t n = 0; n < nodes; n++) {
		const struct eco_tile *tile = &scene->tiles[p->visible.nodes[n].tile];
		double part = m->prices->part[n];
		for (uint32_t g = 0; m->tile_choices[n].open && g < tile->group_count; g++) {
			uint32_t list = scene->groups[tile->group_first + g].list;
			if (scene->groups[tile->group_first + g].first)
				continue;
			m->prices->instances[n] += part * missing_all(m, list);
			m->prices->instances_waste[n] += part * waste_all(m, list);
		}
		if (m->tile_choices[n].has_summary)
			m->prices->points[n] = part
				* (missing_all(m, tile->summary) + waste_all(m, tile->summary))
				/ scene->lists[tile->summary].primitive_count;
	}
	return true;
}

/* A hull of a summary has its samples and the empty one. */
static bool make_room(struct lod_allocation *m)
{
	uint32_t nodes = m->p->visible.node_count, room = 0;
	m->prices->room_first = malloc((nodes + 1u) * sizeof *m->prices->room_first);
	for (uint32_t n = 0; m->prices->room_first && n < nodes; n++) {
		m->prices->room_first[n] = room;
		room += m->tile_choices[n].has_summary ? m->tile_choices[n].summary.count + 1 : 0;
	}
	m->prices->room = malloc((room + 1u) * sizeof *m->prices->room);
	return m->prices->room_first && m->prices->room;
}

struct lod_hull_point *lod_prices_room(struct lod_allocation *m, uint32_t node)
{
	return m->prices->room + m->prices->room_first[node];
}

void lod_prices_instances(const struct lod_allocation *m, uint32_t node, struct lod_cost *cost)
{
	cost->bytes += m->prices->instances[node];
	cost->waste += m->prices->instances_waste[node];
}
double lod_prices_point(const struct lod_allocation *m, uint32_t node) { return m->prices->points[node]; }

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
	price.waste = lod_prices_waste(m, list, 0, chunks) * m->prices->part[node];
	return price;
}

/* ---- Making ---- */

void lod_prices_work(struct lod_allocation *m)
{
	lod_planner_work(m->p, LOD_WORK_CHOICE * (uint64_t)m->ladder_choice_count);
}

enum eco_code lod_prices_make(struct lod_allocation *m, const struct eco_holdings *kept, double waste,
	struct eco_error *error)
{
	uint32_t nodes = m->p->visible.node_count, plants = m->p->scene->plant_count;
	lod_prices_free(m);
	struct lod_prices *prices = m->prices = calloc(1, sizeof *prices);
	if (prices) {
		prices->kept = kept;
		prices->factor = waste;
	}
	bool good = prices && (prices->organs_off = calloc(plants + 1u, sizeof *prices->organs_off))
		&& (prices->saved = malloc((plants + 1u) * sizeof *prices->saved))
		&& (prices->spent = malloc((plants + 1u) * sizeof *prices->spent))
		&& make_ladders(m) && make_tiles(m) && make_room(m);
	lod_prices_work(m);
	const struct eco_view *view = &m->p->input->request->view;
	if (nodes)
		m->p->image.share = fmax(GROUND_LEAST, 1 - m->tile_choices[0].pixels
			/ ((double)view->width * view->height));
	return good ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "planning: no memory for the bytes of %u tiles",
		nodes);
}

void lod_prices_free(struct lod_allocation *m)
{
	struct lod_prices *prices = m->prices;
	if (!prices)
		return;
	free(prices->ladders);
	free(prices->images);
	free(prices->choices);
	free(prices->drawn);
	free(prices->vertices);
	free(prices->prefixes);
	free(prices->needs);
	free(prices->gain);
	free(prices->rests);
	free(prices->more_px);
	free(prices->shown);
	free(prices->instances);
	free(prices->instances_waste);
	free(prices->points);
	free(prices->room);
	free(prices->room_first);
	free(prices->part);
	free(prices->shared);
	free(prices->organs_off);
	free(prices->saved);
	free(prices->spent);
	free(prices);
	m->prices = NULL;
	m->tries.count = 0;
	m->relaxed.lambda = m->tiles.lambda = NAN;
}
