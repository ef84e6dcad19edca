/* See lod/plan/byte_price.h. Longer than 600 lines: limits of lists and of organs are made from one
 * another's. */
#include "lod/plan/byte_price.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/plan/byte_price_state.h"
#include "lod/plan/impostor_worth.h"
#include "lod/plan/plant_uses.h"

#define GROUND_LEAST 0.1         /* share of the ground that shows, at least */
#define DRAWN_LEAST 1e-9         /* plants, below which nobody draws */

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

/* What these cost beside their bytes. */
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

static void add_needs(struct chunks *sum, const struct chunks *more)
{
	for (int i = 0; i < LISTS_OF_LADDER; i++)
		sum->of[i] = more->of[i] > sum->of[i] ? more->of[i] : sum->of[i];
}

static struct price price_of(const struct ladder_price *l, const struct chunks *needs)
{
	struct price sum = { 0 };
	for (uint32_t i = 0; i < l->list_count; i++) {
		sum.bytes += l->prefixes[i][needs->of[i]].bytes;
		sum.waste += l->prefixes[i][needs->of[i]].waste;
	}
	return sum;
}

/* Returns the texture of what is drawn; ECO_NONE: there is none. */
static uint32_t find_needs(const struct lod_allocation *m, const struct lod_way *way, uint64_t vertices,
	struct ladder_price *l, struct chunks *needs)
{
	uint32_t image = ECO_NONE;
	struct eco_cut cuts[LOD_LADDER_CUTS_MAX];
	*needs = (struct chunks){ { 0 } };
	if (vertices == 0)
		return ECO_NONE;
	if (vertices == 1 && lod_hull_impostor_levels(way)) {
		need(m, l, needs, way->ladder->impostor, 1);
		return ECO_NONE;
	}
	uint32_t count = lod_way_cuts(way, vertices, lod_way_density(way, vertices), 0, cuts);
	for (uint32_t i = 0; i < count; i++) {
		need(m, l, needs, cuts[i].list, cuts[i].end);
		if (m->p->scene->lists[cuts[i].list].image != ECO_NONE)
			image = m->p->scene->lists[cuts[i].list].image;
	}
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
			uint32_t image = find_needs(m, &table->way, vertices, l, &l->needs[l->steps]);
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
	if (!prices->vertices || !prices->needs || !prices->gain || !prices->rests)
		return false;
	steps = 0;
	for (uint32_t i = 0; i < prices->ladder_count; i++) {
		struct ladder_price *l = &prices->ladders[i];
		l->vertices = prices->vertices + steps;
		l->needs = prices->needs + steps;
		l->gain = prices->gain + steps;
		l->rests = prices->rests + steps;
		find_steps(m, l);
		steps += l->steps;
	}
	return make_prefixes(m) && lod_images_make(m);
}

/* ---- Tiles ---- */

static bool make_tiles(struct lod_allocation *m)
{
	const struct lod_planner *p = m->p;
	const struct eco_scene *scene = p->scene;
	uint32_t nodes = p->visible.node_count, *occurrences = calloc(scene->tile_count + 1u,
		sizeof *occurrences);
	m->prices->instances = calloc(nodes + 1u, sizeof *m->prices->instances);
	m->prices->instances_waste = calloc(nodes + 1u, sizeof *m->prices->instances_waste);
	m->prices->points = calloc(nodes + 1u, sizeof *m->prices->points);
	if (!occurrences || !m->prices->instances || !m->prices->instances_waste || !m->prices->points) {
		free(occurrences);
		return false;
	}
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
			m->prices->instances_waste[n] += part * waste_all(m, list);
		}
		if (m->tile_choices[n].has_summary)
			m->prices->points[n] = part
				* (missing_all(m, tile->summary) + waste_all(m, tile->summary))
				/ scene->lists[tile->summary].primitive_count;
	}
	free(occurrences);
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

/* Limits are made of what all choices come to, as a relaxation is. */
static void work_limits(struct lod_allocation *m)
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
		prices->kept_lambda = NAN;
		prices->factor = waste;
	}
	bool good = prices && (prices->part = malloc((nodes + 1u) * sizeof *prices->part))
		&& (prices->organs_off = calloc(plants + 1u, sizeof *prices->organs_off))
		&& (prices->organs = calloc(plants + 1u, sizeof *prices->organs))
		&& (prices->noted = calloc(plants + 1u, sizeof *prices->noted))
		&& (prices->saved = malloc((plants + 1u) * sizeof *prices->saved))
		&& (prices->spent = malloc((plants + 1u) * sizeof *prices->spent))
		&& make_ladders(m) && make_tiles(m) && make_room(m);
	work_limits(m);
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
	free(prices->instances);
	free(prices->instances_waste);
	free(prices->points);
	free(prices->room);
	free(prices->room_first);
	free(prices->part);
	free(prices->organs_off);
	free(prices->organs);
	free(prices->noted);
	free(prices->saved);
	free(prices->spent);
	free(prices);
	m->prices = NULL;
	m->tries.count = 0;
	m->relaxed.lambda = m->tiles.lambda = NAN;
}

/* ---- What is drawn ---- */

/* The share of a slot's plants that draw a choice. `all`: of a ladder that shows the whole plant, as if no
 * organs were drawn. */
double lod_prices_share(const struct lod_allocation *m, uint32_t ladder_choice, bool all)
{
	const struct lod_ladder_choice *choice = &m->ladder_choices[ladder_choice];
	const struct lod_slot *slot = &m->p->visible.slots[choice->slot];
	const struct lod_slot_choice *slot_choice = &m->slot_choices[choice->slot];
	if (slot->cell)
		return 1;
	double near = lod_planner_near(m->p, slot->plant, slot->band), whole = slot_choice->whole_count
		? slot_choice->whole_share : 0;
	switch (choice->when) {
	case LOD_WHOLE:
		return all ? 1 : slot_choice->whole == ladder_choice ? (1 - near) * whole : 0;
	case LOD_NEAR:
		return near;
	case LOD_FAR:
		return (1 - near) * (1 - whole);
	default:
		return 1 - whole;
	}
}

/* ---- Limits ---- */

static uint32_t step_of(const struct ladder_price *l, uint64_t vertices)
{
	uint32_t low = 0, high = l->steps - 1;
	while (low < high) {
		uint32_t middle = (low + high) / 2;
		if (l->vertices[middle] < vertices)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

/* Where lambda alone takes a choice. */
static double free_position(const struct lod_allocation *m, struct lod_ladder_choice *choice)
{
	struct lod_hull hull = choice->hull;
	if (choice->free_lambda == m->lambda)
		return choice->free;
	hull.count = choice->hull_count;
	choice->free = lod_hull_position(&hull, m->lambda / choice->weight_px, choice->position);
	choice->free_lambda = m->lambda;
	return choice->free;
}

/* Adds to each step what a choice without a limit saves there at lambda. */
static void add_gain(struct lod_allocation *m, struct ladder_price *l, uint32_t id, double drawn, double seen)
{
	struct lod_ladder_choice *choice = &m->ladder_choices[id];
	if (!(seen > 0))
		return;
	const struct lod_hull *hull = &choice->hull;
	double position = free_position(m, choice), before = lod_hull_error(hull, &hull->points[0]);
	l->rests[step_of(l, hull->points[(uint32_t)position].vertices)] = true;
	l->rests[step_of(l, hull->points[(uint32_t)ceil(position)].vertices)] = true;
	for (uint32_t k = 1, step = 0; k < choice->hull_count && k < position + 1; k++) {
		const struct lod_hull_point *a = &hull->points[k - 1], *b = &hull->points[k];
		double part = position >= k ? 1 : position - (k - 1), after = lod_hull_error(hull, b),
			saved = seen * (before - after),
			cost = drawn * m->lambda * (double)(b->vertices - a->vertices);
		while (step + 1 < l->steps && l->vertices[step] < b->vertices)
			step++;
		l->gain[step] += part * (saved - cost);
		before = after;
	}
}

/* Sets what is drawn of a ladder's choices. Is that what its gains were made of, with the same hulls? */
static bool see_drawn(struct lod_allocation *m, struct ladder_price *l, bool all)
{
	bool same = l->lambda == m->lambda;
	for (uint32_t i = l->first; i < l->first + l->count; i++) {
		uint32_t id = m->prices->choices[i];
		const struct lod_ladder_choice *choice = &m->ladder_choices[id];
		double share = lod_prices_share(m, id, all), drawn = m->uses.drawn[choice->slot] * share,
			seen = m->uses.seen[choice->slot] * share * choice->weight_px;
		struct drawn *before = &m->prices->drawn[i];
		same &= before->drawn == drawn && before->seen == seen
			&& (!(seen > 0) || choice->free_lambda == m->lambda);
		*before = (struct drawn){ drawn, seen };
	}
	l->lambda = m->lambda;
	return same;
}

/* They do not depend on the price. */
static void find_gains(struct lod_allocation *m, struct ladder_price *l, bool all)
{
	if (see_drawn(m, l, all))
		return;
	memset(l->gain, 0, l->steps * sizeof *l->gain);
	memset(l->rests, 0, l->steps * sizeof *l->rests);
	for (uint32_t i = l->first; i < l->first + l->count; i++)
		add_gain(m, l, m->prices->choices[i], m->prices->drawn[i].drawn, m->prices->drawn[i].seen);
}

/* What a ladder costs that is drawn up to a step. */
static double cost_of(const struct ladder_price *l, const struct price *price, uint32_t step)
{
	return price->bytes + price->waste + (step >= l->textured ? l->image_part : 0);
}

void lod_prices_levels(struct lod_allocation *m)
{
	work_limits(m);
	lod_uses_sum_drawn(m);
	lod_images_limit(m);
}

/* Levels of textures and of impostors. */
static void limit_levels(struct lod_allocation *m)
{
	lod_images_limit(m);
	for (uint32_t s = 0; s < m->p->visible.slot_count; s++)
		m->scratch[s] = m->uses.seen[s] * m->slot_choices[s].seen;
	lod_allocation_set_impostors(m, m->scratch);
}

/* The step up to which bytes are worth their price: beside those of the choices that stay below it. */
static void find_limit(struct lod_allocation *m, struct ladder_price *l, bool all)
{
	struct chunks below = { { 0 } };
	double best = 0, sum = 0, cheapest = 0, none = 0;
	find_gains(m, l, all);
	l->limit = 0;
	for (uint32_t i = 0; i < l->steps; i++) {
		struct chunks needs = below;
		add_needs(&needs, &l->needs[i]);
		struct price price = price_of(l, &needs);
		double bytes = cost_of(l, &price, i);
		sum += l->gain[i];
		none = i ? none : bytes;
		double net = sum - m->price * (bytes - none) - (i >= l->textured ? l->image_lost : 0);
		if (i == 0 || net > best || bytes <= cheapest) {
			best = fmax(best, net);
			l->limit = i;
			cheapest = bytes;
		}
		if (l->rests[i])
			below = needs;
	}
}

/* Of the points of its hull that a choice may take. */
static void set_count(struct lod_allocation *m, struct lod_ladder_choice *choice, uint32_t count)
{
	if (choice->hull.count == count)
		return;
	choice->hull.count = count;
	choice->position = fmin(choice->position, count - 1);
	lod_allocation_unsettle(m, choice->slot);
}

static void apply_limit(struct lod_allocation *m, const struct ladder_price *l)
{
	for (uint32_t i = 0; i < l->count; i++) {
		struct lod_ladder_choice *choice = &m->ladder_choices[m->prices->choices[l->first + i]];
		uint32_t count = 1;
		while (count < choice->hull_count
				&& choice->hull.points[count].vertices <= l->vertices[l->limit])
			count++;
		set_count(m, choice, count);
	}
}

static bool is_whole(const struct lod_allocation *m, const struct ladder_price *l)
{
	return m->p->scene->ladders[l->ladder].flags & ECO_LADDER_WHOLE;
}

/* Its impostor is the one step of one vertex. */
static bool draws_impostor(const struct lod_ladder_choice *choice)
{
	const struct lod_hull_point *points = choice->hull.points;
	return choice->hull.impostor != ECO_NONE && (points[(uint32_t)choice->position].vertices == 1
		|| points[(uint32_t)ceil(choice->position)].vertices == 1);
}

/* Levels of its impostor above the first that some plant draws. */
static double levels_bytes(const struct lod_allocation *m, const struct ladder_price *l)
{
	uint32_t list = m->p->scene->ladders[l->ladder].impostor, level = 0;
	for (uint32_t i = 0; list != ECO_NONE && i < l->count; i++) {
		uint32_t id = m->prices->choices[l->first + i];
		const struct lod_ladder_choice *choice = &m->ladder_choices[id];
		if (draws_impostor(choice) && choice->hull.impostor > level
				&& m->uses.drawn[choice->slot] * lod_prices_share(m, id, false) > DRAWN_LEAST)
			level = choice->hull.impostor;
	}
	return level ? lod_prices_missing(m, list, 1, level + 1) : 0;
}

/* The last step that some plant draws; 0: none does. Sets l->used. */
static uint32_t find_used(const struct lod_allocation *m, struct ladder_price *l)
{
	struct chunks needs = { { 0 } };
	uint32_t used = 0;
	for (uint32_t i = 0; i < l->count; i++) {
		uint32_t id = m->prices->choices[l->first + i];
		const struct lod_ladder_choice *choice = &m->ladder_choices[id];
		const struct lod_hull_point *points = choice->hull.points;
		if (m->uses.drawn[choice->slot] * lod_prices_share(m, id, false) < DRAWN_LEAST)
			continue;
		uint32_t from = step_of(l, points[(uint32_t)choice->position].vertices),
			to = step_of(l, points[(uint32_t)ceil(choice->position)].vertices);
		add_needs(&needs, &l->needs[from]);
		add_needs(&needs, &l->needs[to]);
		used = to > used ? to : used;
	}
	l->used = price_of(l, &needs);
	return used;
}

/* Finds what organs draw now, and by how many ladders each texture is shown. */
static void find_drawn(struct lod_allocation *m)
{
	for (uint32_t i = 0; i < m->prices->image_count; i++)
		m->prices->images[i].shown = 0;
	for (uint32_t i = 0; i < m->prices->ladder_count; i++) {
		struct ladder_price *l = &m->prices->ladders[i];
		l->shows = !is_whole(m, l) && find_used(m, l) >= l->textured;
		if (l->shows)
			m->prices->images[l->image].shown++;
	}
}

/* A texture is paid once, by those ladders that show it. */
static double texture_part(const struct lod_prices *prices, const struct ladder_price *l)
{
	const struct image_price *image = &prices->images[l->image];
	return (image->bytes + image->waste) / image->shown;
}

/* Do a plant's organs save what their bytes cost, over the ladder that shows it as a whole? */
static void judge_organs(struct lod_allocation *m)
{
	struct lod_prices *prices = m->prices;
	const struct lod_visible_tree *visible = &m->p->visible;
	uint32_t plants = m->p->scene->plant_count;
	memset(prices->saved, 0, plants * sizeof *prices->saved);
	memset(prices->spent, 0, plants * sizeof *prices->spent);
	find_drawn(m);
	for (uint32_t i = 0; i < prices->ladder_count; i++) {
		const struct ladder_price *l = &prices->ladders[i];
		uint32_t plant = m->p->scene->ladders[l->ladder].plant;
		if (is_whole(m, l))
			continue;
		prices->spent[plant] += l->used.bytes + l->used.waste
			+ (l->shows ? texture_part(prices, l) : 0);
		prices->saved[plant] -= l->shows ? l->image_lost : 0;
	}
	for (uint32_t s = 0; s < visible->slot_count; s++) {
		const struct lod_slot *slot = &visible->slots[s];
		const struct lod_slot_choice *choice = &m->slot_choices[s];
		if (slot->cell)
			continue;
		double near = lod_planner_near(m->p, slot->plant, slot->band),
			each = m->counts[s] ? choice->near_saved / (double)m->counts[s] : 0;
		prices->saved[slot->plant] += m->uses.seen[s] * ((1 - choice->whole_share)
			* fmax(0, choice->organs_saved) + near * fmax(0, each));
	}
	for (uint32_t i = 0; i < plants; i++)
		if (prices->organs[i] != LOD_ORGANS_KEPT && prices->spent[i] > 0
				&& prices->saved[i] < m->price * prices->spent[i])
			prices->organs_off[i] = true;
}

bool lod_prices_organs_off(const struct lod_allocation *m, uint32_t plant)
{
	return m->price > 0 && m->prices->organs_off[plant];
}

static void set_organs(struct lod_allocation *m, uint32_t plant, uint8_t organs)
{
	if (m->prices->organs[plant] == organs)
		return;
	m->prices->organs[plant] = organs;
	m->prices->kept_lambda = m->relaxed.lambda = NAN;
}

uint32_t lod_prices_dearest(struct lod_allocation *m, bool returned)
{
	const struct lod_prices *prices = m->prices;
	uint32_t most = ECO_NONE;
	judge_organs(m);
	for (uint32_t i = 0; i < m->p->scene->plant_count; i++) {
		bool asked = prices->organs[i] == LOD_ORGANS_PRICED && !prices->organs_off[i]
			&& (!returned || prices->noted[i]);
		if (asked && prices->spent[i] > (most == ECO_NONE ? 0 : prices->spent[most]))
			most = i;
	}
	return most;
}

void lod_prices_note_off(struct lod_allocation *m)
{
	memcpy(m->prices->noted, m->prices->organs_off, m->p->scene->plant_count);
}

void lod_prices_set_organs_of(struct lod_allocation *m, uint32_t plant, enum lod_organs organs)
{
	set_organs(m, plant, (uint8_t)organs);
}

const uint8_t *lod_prices_organs(const struct lod_allocation *m) { return m->prices->organs; }

void lod_prices_set_organs(struct lod_allocation *m, const uint8_t *organs)
{
	for (uint32_t i = 0; i < m->p->scene->plant_count; i++)
		set_organs(m, i, organs ? organs[i] : LOD_ORGANS_PRICED);
}

void lod_prices_lift(struct lod_allocation *m)
{
	for (uint32_t i = 0; i < m->p->scene->plant_count; i++)
		m->prices->organs_off[i] = m->prices->organs[i] == LOD_ORGANS_OUT;
	for (uint32_t i = 0; i < m->ladder_choice_count; i++)
		set_count(m, &m->ladder_choices[i], m->ladder_choices[i].hull_count);
}

void lod_prices_limit(struct lod_allocation *m, bool first, bool last)
{
	struct lod_prices *prices = m->prices;
	work_limits(m);
	lod_uses_sum_drawn(m);
	if (!m->spares)
		limit_levels(m);
	if (!first)
		judge_organs(m);
	for (uint32_t i = 0; i < prices->ladder_count; i++) {
		struct ladder_price *l = &prices->ladders[i];
		bool off = prices->organs_off[m->p->scene->ladders[l->ladder].plant];
		if (off && !is_whole(m, l))
			l->limit = 0;
		else
			find_limit(m, l, off || !last);
		apply_limit(m, l);
	}
}

void lod_prices_tighten(struct lod_allocation *m)
{
	work_limits(m);
	lod_uses_sum_drawn(m);
	for (uint32_t i = 0; i < m->prices->ladder_count; i++) {
		m->prices->ladders[i].limit = find_used(m, &m->prices->ladders[i]);
		apply_limit(m, &m->prices->ladders[i]);
	}
}

void lod_prices_keep(struct lod_allocation *m)
{
	m->prices->kept_lambda = m->lambda;
	m->prices->kept_price = m->price;
	for (uint32_t i = 0; i < m->prices->ladder_count; i++)
		m->prices->ladders[i].kept = m->prices->ladders[i].limit;
}

bool lod_prices_restore(struct lod_allocation *m, double lambda)
{
	if (m->prices->kept_lambda != lambda || m->prices->kept_price != m->price)
		return false;
	for (uint32_t i = 0; i < m->prices->ladder_count; i++) {
		m->prices->ladders[i].limit = m->prices->ladders[i].kept;
		apply_limit(m, &m->prices->ladders[i]);
	}
	return true;
}

double lod_prices_lost(const struct lod_allocation *m)
{
	double sum = 0;
	for (uint32_t i = 0; i < m->prices->ladder_count; i++)
		sum += m->prices->ladders[i].limit >= m->prices->ladders[i].textured
			? m->prices->ladders[i].image_lost : 0;
	return sum;
}

void lod_prices_lost_of(const struct lod_allocation *m, double *lost)
{
	memset(lost, 0, m->p->visible.slot_count * sizeof *lost);
	for (uint32_t i = 0; m->price > 0 && i < m->prices->ladder_count; i++) {
		const struct ladder_price *l = &m->prices->ladders[i];
		for (uint32_t k = 0; l->limit >= l->textured && l->textured_px > 0 && k < l->count; k++) {
			uint32_t id = m->prices->choices[l->first + k];
			const struct lod_ladder_choice *choice = &m->ladder_choices[id];
			if (choice->hull.points[(uint32_t)ceil(choice->position)].vertices
					>= l->vertices[l->textured])
				lost[choice->slot] += lod_prices_share(m, id, false) * choice->weight_px
					* l->image_lost / l->textured_px;
		}
	}
}

double lod_prices_lists(const struct lod_allocation *m)
{
	double sum = 0;
	for (uint32_t i = 0; i < m->prices->ladder_count; i++) {
		const struct ladder_price *l = &m->prices->ladders[i];
		sum += l->used.bytes + levels_bytes(m, l);       /* as lod_prices_tighten left them */
	}
	return sum;
}

double lod_prices_bytes(struct lod_allocation *m)
{
	double sum = m->cost.bytes + lod_prices_lists(m);
	for (uint32_t i = 0; i < m->prices->image_count; i++)
		m->prices->images[i].used = false;
	for (uint32_t i = 0; i < m->prices->ladder_count; i++) {
		const struct ladder_price *l = &m->prices->ladders[i];
		if (l->limit < l->textured || m->prices->images[l->image].used)
			continue;
		m->prices->images[l->image].used = true;
		sum += m->prices->images[l->image].bytes;
	}
	return sum;
}
