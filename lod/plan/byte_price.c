/* See lod/plan/byte_price.h: limits of lists, and of organs, for what is drawn at a price. */
#include "lod/plan/byte_price.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lod/plan/allocation.h"

#define DRAWN_LEAST 1e-9         /* plants, below which nobody draws */

/* ---- What is drawn ---- */

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

/* Pixels of the plants that draw a choice, if all of it is missing. */
double lod_prices_seen(const struct lod_allocation *m, uint32_t id)
{
	const struct lod_ladder_choice *choice = &m->ladder_choices[id];
	return m->uses.seen[choice->slot] * lod_prices_share(m, id, false) * choice->weight_px;
}

/* ---- Limits ---- */

static uint32_t step_of(const struct ladder_price *l, uint64_t vertices)
{
	uint32_t low = 0, high = l->steps - 1;
	while (low < high) {
		uint32_t middle = (low + high) / 2;
		if (l->at[middle].vertices < vertices)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

/* The hull position that lambda alone gives a choice. */
static double free_position(const struct lod_allocation *m, const struct lod_ladder_choice *choice)
{
	struct lod_hull hull = choice->hull;
	hull.count = choice->hull_count;
	return lod_hull_position(&hull, m->lambda / choice->weight_px, choice->position);
}

/* Adds to each step what a choice without a limit saves there at lambda, and pixels that show a texture from
 * there on. */
static void add_gain(struct lod_allocation *m, struct ladder_price *l, uint32_t id, double drawn, double seen)
{
	const struct lod_ladder_choice *choice = &m->ladder_choices[id];
	if (!(seen > 0))
		return;
	const struct lod_hull *hull = &choice->hull;
	double position = free_position(m, choice), before = lod_hull_error(hull, &hull->points[0]);
	l->at[step_of(l, hull->points[(uint32_t)position].vertices)].rests = true;
	l->at[step_of(l, hull->points[(uint32_t)ceil(position)].vertices)].rests = true;
	for (uint32_t k = 1, step = 0; k < choice->hull_count && k < position + 1; k++) {
		const struct lod_hull_point *a = &hull->points[k - 1], *b = &hull->points[k];
		double part = position >= k ? 1 : position - (k - 1), after = lod_hull_error(hull, b),
			saved = seen * (before - after), shown = l->at[step].shown,
			cost = drawn * m->lambda * (double)(b->vertices - a->vertices);
		while (step + 1 < l->steps && l->at[step].vertices < b->vertices)
			step++;
		l->at[step].gain += part * (saved - cost);
		l->at[step].more_px += part * seen * (l->at[step].shown - shown);
		before = after;
	}
}

/* They do not depend on the price. */
static void find_gains(struct lod_allocation *m, struct ladder_price *l, bool all)
{
	for (uint32_t i = 0; i < l->steps; i++) {
		l->at[i].gain = l->at[i].more_px = 0;
		l->at[i].rests = false;
	}
	for (uint32_t i = l->first; i < l->first + l->count; i++) {
		uint32_t id = m->prices->choices[i], slot = m->ladder_choices[id].slot;
		double share = lod_prices_share(m, id, all);
		add_gain(m, l, id, m->uses.drawn[slot] * share, m->uses.seen[slot] * share * m->ladder_choices[id].weight_px);
	}
}

/* Cost of a ladder that is drawn up to a step. */
static double cost_of(const struct ladder_price *l, double bytes, uint32_t step)
{
	return bytes + (step >= l->textured ? l->image_part : 0);
}

void lod_prices_levels(struct lod_allocation *m)
{
	lod_prices_work(m);
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
	double best = 0, sum = 0, cheapest = 0, none = 0, worth = l->bare_lost - l->image_lost;
	find_gains(m, l, all);
	l->limit = 0;
	for (uint32_t i = 0; i < l->steps; i++) {
		struct chunks needs = below;
		lod_prices_add_needs(&needs, &l->at[i].needs);
		double bytes = cost_of(l, lod_prices_of(l, &needs), i);
		sum += l->at[i].gain + worth * l->at[i].more_px;
		none = i ? none : bytes;
		double net = sum - m->price * (bytes - none);
		if (i == 0 || net > best || bytes <= cheapest) {
			best = fmax(best, net);
			l->limit = i;
			cheapest = bytes;
		}
		if (l->at[i].rests)
			below = needs;
	}
}

/* The best of the hull points that a choice may take. */
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
				&& choice->hull.points[count].vertices <= l->at[l->limit].vertices)
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

/* Share of a choice that shows the ladder's texture, as it is drawn now. */
static double shown_of(const struct lod_allocation *m, const struct ladder_price *l, uint32_t id)
{
	const struct lod_ladder_choice *choice = &m->ladder_choices[id];
	const struct lod_hull_point *points = choice->hull.points;
	double whole = floor(choice->position), part = choice->position - whole,
		shown = l->at[step_of(l, points[(uint32_t)whole].vertices)].shown;
	return part > 0 ? shown + part * (l->at[step_of(l, points[(uint32_t)whole + 1].vertices)].shown - shown) : shown;
}

/* Pixels that show a ladder's texture; *bare: that do not. */
static double shown_px(const struct lod_allocation *m, const struct ladder_price *l, double *bare)
{
	double sum = *bare = 0;
	for (uint32_t i = 0; l->textured != ECO_NONE && i < l->count; i++) {
		uint32_t id = m->prices->choices[l->first + i];
		double seen = lod_prices_seen(m, id), shown = seen > 0 ? shown_of(m, l, id) : 0;
		sum += shown * seen;
		*bare += (1 - shown) * seen;
	}
	return sum;
}

/* Sets the last step that some plant draws, 0: none does, and the bytes of what is drawn. Returns that step. */
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
		lod_prices_add_needs(&needs, &l->at[from].needs);
		lod_prices_add_needs(&needs, &l->at[to].needs);
		used = to > used ? to : used;
	}
	l->used = lod_prices_of(l, &needs);
	return l->last = used;
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
	return image->bytes / image->shown;
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
		double bare;
		uint32_t plant = l->plant;
		if (is_whole(m, l))
			continue;
		prices->spent[plant] += l->used + (l->shows ? texture_part(prices, l) : 0);
		prices->saved[plant] += shown_px(m, l, &bare) * (l->bare_lost - l->image_lost);
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
		if (prices->spent[i] > 0
				&& prices->saved[i] < m->price * prices->spent[i])
			prices->organs_off[i] = true;
}

bool lod_prices_organs_off(const struct lod_allocation *m, uint32_t plant)
{
	return m->price > 0 && m->prices->organs_off[plant];
}

void lod_kinds_set(struct lod_allocation *m, const struct lod_mix *mix)
{
	memcpy(m->prices->organs_off, mix->off, m->p->scene->plant_count);
	for (uint32_t i = 0; i < m->prices->image_count; i++)
		m->prices->images[i].level = mix->levels[m->prices->images[i].plant];
	for (uint32_t i = 0; i < m->prices->ladder_count; i++) {
		m->prices->ladders[i].limit = mix->limits[i];
		apply_limit(m, &m->prices->ladders[i]);
	}
}

void lod_prices_lift(struct lod_allocation *m)
{
	memset(m->prices->organs_off, 0, m->p->scene->plant_count * sizeof *m->prices->organs_off);
	for (uint32_t i = 0; i < m->ladder_choice_count; i++)
		set_count(m, &m->ladder_choices[i], m->ladder_choices[i].hull_count);
}

void lod_prices_limit(struct lod_allocation *m, bool first, bool last)
{
	struct lod_prices *prices = m->prices;
	lod_prices_work(m);
	lod_uses_sum_drawn(m);
	limit_levels(m);
	if (!first)
		judge_organs(m);
	for (uint32_t i = 0; i < prices->ladder_count; i++) {
		struct ladder_price *l = &prices->ladders[i];
		bool off = prices->organs_off[l->plant];
		if (off && !is_whole(m, l))
			l->limit = 0;
		else
			find_limit(m, l, off || !last);
		apply_limit(m, l);
	}
}

void lod_prices_tighten(struct lod_allocation *m)
{
	lod_prices_work(m);
	lod_uses_sum_drawn(m);
	for (uint32_t i = 0; i < m->prices->ladder_count; i++) {
		m->prices->ladders[i].limit = find_used(m, &m->prices->ladders[i]);
		apply_limit(m, &m->prices->ladders[i]);
	}
}

static double ladder_lost(const struct lod_allocation *m, const struct ladder_price *l)
{
	double bare, shown = shown_px(m, l, &bare);
	return l->whole_lost + bare * l->bare_lost + shown * l->image_lost;
}

double lod_prices_lost(const struct lod_allocation *m)
{
	double sum = 0;
	for (uint32_t i = 0; i < m->prices->ladder_count; i++)
		sum += ladder_lost(m, &m->prices->ladders[i]);
	return sum;
}

static void forget_images(struct lod_allocation *m)
{
	for (uint32_t i = 0; i < m->prices->image_count; i++)
		m->prices->images[i].used = false;
}

/* Bytes of a ladder, as find_used left it; the first of those that show a texture pays for it. */
static double ladder_bytes(const struct lod_allocation *m, const struct ladder_price *l)
{
	const double sum = l->used + levels_bytes(m, l);
	if (l->last < l->textured || m->prices->images[l->image].used)
		return sum;
	m->prices->images[l->image].used = true;
	return sum + m->prices->images[l->image].bytes;
}

void lod_prices_of_kinds(struct lod_allocation *m, double *bytes, double *wrong)
{
	forget_images(m);
	for (uint32_t i = 0; i < m->prices->ladder_count; i++) {
		find_used(m, &m->prices->ladders[i]);
		bytes[m->prices->ladders[i].plant] += ladder_bytes(m, &m->prices->ladders[i]);
		wrong[m->prices->ladders[i].plant] += ladder_lost(m, &m->prices->ladders[i]);
	}
}

double lod_prices_bytes(struct lod_allocation *m)
{
	double sum = m->cost.bytes;
	forget_images(m);
	for (uint32_t i = 0; i < m->prices->ladder_count; i++)
		sum += ladder_bytes(m, &m->prices->ladders[i]);
	return sum;
}
