/* What things in view are worth, whatever the price: see lod/plan/allocation.h. */
#include "lod/plan/allocation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/room.h"
#include "lod/ladder.h"

#define PI 3.14159265358979323846
#define BLOCK 4096u              /* amounts taken from memory at once */
#define SHARP_BELOW 40           /* plants in view: fewer change one by one in any case */
#define SMOOTH_BANDS 3           /* on either side count, too, ... */
#define SMOOTH_PLANTS 400.0      /* ... but less where there are more plants than this: of many most are hidden */
#define HIDDEN_WOOD 0.2          /* of wood that leaves cover wholly, this much still counts: leaves are drawn with holes */

/* ---- Room ---- */

static struct lod_amount *take_amounts(struct lod_market *m, uint32_t count)
{
	if (m->block_count == 0 || m->block_used + count > BLOCK) {
		if (!eco_room(&m->blocks, &m->block_capacity, m->block_count, sizeof *m->blocks))
			return NULL;
		if (!(m->blocks[m->block_count] = malloc(BLOCK * sizeof **m->blocks)))
			return NULL;
		m->block_count++;
		m->block_used = 0;
	}
	return m->blocks[m->block_count - 1] + m->block_used;
}

static double extra_of(double bare, double seen)
{
	return seen > 0 ? fmin(1, fmax(LOD_EXTRA_LEAST, bare / seen)) : 1;
}

static bool add_offer(struct lod_market *m, const struct lod_offer *offer)
{
	if (!eco_room(&m->offers, &m->offer_capacity, m->offer_count, sizeof *m->offers))
		return false;
	m->offers[m->offer_count++] = *offer;
	m->p->candidates += offer->steps.count - 1;
	return true;
}

/* ---- Worth ---- */

/* Pixels that one plant's organ would cover at full detail if nothing were before it: random leaves on an ellipse. Wood shows where leaves
 * let it. Only the ratios of a plant's organs and cells matter: how much of all of it is seen is known from the screen. */
static double organ_pixels(const struct lod_market *m, const struct eco_ladder *ladder, uint8_t band)
{
	const struct lod_planning *p = m->p;
	const struct eco_plant *plant = &p->scene->plants[ladder->plant];
	const struct eco_anchor *anchor = &p->scene->anchors[ladder->anchor];
	struct lod_body body = { .area = ladder->area, .crown_across = anchor->radius, .crown_up = anchor->radius };
	if (ladder->anchor == plant->anchor_first) {
		body = lod_tables_bodies(p->tables)[ladder->plant];
		body.area = ladder->area;
	}
	double r = lod_band_distance_m(band), px = 1 / (r * p->visible.eye.pixel_rad);
	double pixels = lod_body_opacity(&body) * PI * body.crown_across * body.crown_up * px * px;
	if (ladder->organ != ECO_ORGAN_WOOD)
		return pixels;
	body = lod_tables_bodies(p->tables)[ladder->plant];
	body.area = fmax(0, plant->area - 2 * (double)ladder->area);
	return pixels * fmax(HIDDEN_WOOD, 1 - lod_body_opacity(&body));
}

static double importance_of(const struct eco_ladder *ladder)
{
	return ladder->importance > 0 ? ladder->importance : 1;
}

/* Of a cell, the share of a ladder's elements that the plant's own list does not draw already. */
static double rest_of(const struct lod_slot *slot, const struct eco_ladder *ladder)
{
	return slot->cell && ladder->total ? 1 - (double)ladder->before / ladder->total : 1;
}

/* Of everything at the slot's anchor; of a cell, the rest of it. */
static double anchor_pixels(const struct lod_market *m, const struct lod_slot *slot)
{
	uint32_t count;
	const uint32_t *ladders = lod_tables_anchor(m->p->tables, slot->anchor, &count);
	double sum = 0;
	for (uint32_t i = 0; i < count; i++) {
		const struct eco_ladder *ladder = &m->p->scene->ladders[ladders[i]];
		sum += rest_of(slot, ladder) * organ_pixels(m, ladder, slot->band);
	}
	return sum;
}

static bool add_offers(struct lod_market *m, uint32_t s, uint32_t id, double worth)
{
	const struct eco_scene *scene = m->p->scene;
	const struct lod_slot *slot = &m->p->visible.slots[s];
	const struct eco_ladder *ladder = &scene->ladders[id];
	const struct lod_tables_ladder *table = lod_tables_ladder(m->p->tables, id);
	if (!table)
		return false;
	struct lod_offer offer = { .slot = s, .ladder = id, .worth = worth, .steps = table->steps[0] };
	offer.steps.extra = m->lots[s].extra;
	offer.when = slot->cell || scene->plants[slot->plant].anchor_count < 2 ? LOD_ALWAYS : LOD_FAR;
	if (!add_offer(m, &offer))
		return false;
	if (offer.when == LOD_ALWAYS || ladder->flags & ECO_LADDER_FAR)
		return true;
	/* the same list beside cells: its own part of the plant, from where it stands for that and no more */
	offer.when = LOD_NEAR;
	offer.steps = table->steps[1];
	offer.steps.extra = m->lots[s].extra;
	offer.worth = worth * lod_way_density(&table->way, table->way.full);
	return add_offer(m, &offer);
}

static enum eco_code make_lot(struct lod_market *m, uint32_t s, struct eco_error *error)
{
	const struct eco_scene *scene = m->p->scene;
	const struct lod_slot *slot = &m->p->visible.slots[s];
	struct lod_lot *lot = &m->lots[s];
	double all = anchor_pixels(m, slot);
	uint32_t count;
	const uint32_t *ladders = lod_tables_anchor(m->p->tables, slot->anchor, &count);
	bool good = true;
	lot->extra = extra_of(lot->bare, lot->seen);
	lot->offer_first = m->offer_count;
	for (uint32_t i = 0; good && i < count; i++) {
		uint32_t id = ladders[i];
		const struct eco_ladder *ladder = &scene->ladders[id];
		double part = all > 0 ? rest_of(slot, ladder) * organ_pixels(m, ladder, slot->band) / all : 0;
		good = add_offers(m, s, id, part * lot->seen * importance_of(ladder));
	}
	lot->offer_count = m->offer_count - lot->offer_first;
	for (uint32_t i = lot->offer_first; good && i < m->offer_count; i++) {
		const struct lod_offer *offer = &m->offers[i];
		const struct eco_ladder *ladder = &scene->ladders[offer->ladder];
		lot->worth[0] += offer->when == LOD_NEAR ? 0 : offer->worth;
		lot->worth[1] += offer->when == LOD_FAR ? 0 : offer->worth;
		lot->absent += offer->when == LOD_NEAR ? 0 : offer->worth * lod_steps_absent(ladder);
		lot->own += offer->when == LOD_NEAR ? offer->worth / importance_of(ladder) : 0;
	}
	return good ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u amounts", m->offer_count);
}

/* ---- What is seen ---- */

static double seen_pixels(const struct lod_sight *sight)
{
	return (double)sight->share * sight->pixels;
}

static double bare_pixels(const struct lod_sight *sight)
{
	return (double)sight->bare * sight->pixels;
}

/* What is seen of a plant in the mean of its slot. Of a few plants the mean jumps as one more of them crosses a border or is hidden; so those of
 * the bands around it count, too, as if they were at its distance, the less the more it has of its own. Sums are in `own` and `parts`,
 * numbers in m->scratch. */
static void smooth_plants(struct lod_market *m)
{
	const struct lod_visible *visible = &m->p->visible;
	for (uint32_t s = 0; s < visible->slot_count; s++) {
		const struct lod_slot *slot = &visible->slots[s];
		double own = m->scratch[s], seen = 0, bare = 0, sum = 0, nominal = lod_band_distance_m(slot->band);
		for (int k = -SMOOTH_BANDS; !slot->cell && k <= SMOOTH_BANDS; k++) {
			int band = (int)slot->band + k;
			uint32_t t = band < 0 || band >= (int)ECO_BANDS ? ECO_NONE : lod_market_whole(m, slot->plant, (uint8_t)band);
			if (t == ECO_NONE || !(m->scratch[t] > 0))
				continue;
			double far = lod_band_distance_m((uint8_t)band) / nominal, weight = k == 0 ? 1 : fmin(1, SMOOTH_PLANTS / own) * ldexp(1, -abs(k));
			seen += weight * far * far * m->lots[t].own;
			bare += weight * far * far * m->lots[t].parts;
			sum += weight * m->scratch[t];
		}
		m->lots[s].seen = own > 0 ? seen / sum : 0;
		m->lots[s].bare = own > 0 ? bare / sum : 0;
	}
	for (uint32_t s = 0; s < visible->slot_count; s++)
		m->lots[s].own = m->lots[s].parts = 0;
}

static void see_plants(struct lod_market *m)
{
	struct lod_planning *p = m->p;
	double *counts = m->scratch;
	memset(counts, 0, p->visible.slot_count * sizeof *counts);
	for (uint32_t i = 0; i < p->screen.count; i++) {
		const struct lod_sight *sight = &p->screen.sights[i];
		if (sight->slot == ECO_NONE || !m->stalls[sight->node].open)
			continue;
		m->lots[sight->slot].own += seen_pixels(sight);
		m->lots[sight->slot].parts += bare_pixels(sight);
		counts[sight->slot] += 1;
	}
	for (uint32_t s = 0; s < p->visible.slot_count; s++) {
		const struct lod_slot *slot = &p->visible.slots[s];
		if (!slot->cell)
			m->slot_of[slot->plant * (size_t)ECO_BANDS + slot->band] = s + 1;
	}
	smooth_plants(m);
}

void lod_market_cells(struct lod_market *m, lod_market_cell_fn fn)
{
	const struct lod_visible *visible = &m->p->visible;
	for (uint32_t n = 0; n < visible->node_count; n++) {
		const struct lod_node *node = &visible->nodes[n];
		for (uint32_t i = 0; m->stalls[n].open && i < node->tally_count; i++) {
			const struct lod_tally *t = &node->tallies[i];
			const struct lod_slot *slot = &visible->slots[t->slot];
			if (slot->cell)
				fn(m, t, &m->lots[t->slot], &m->lots[lod_market_whole(m, slot->plant, t->whole_band)]);
		}
	}
}

static void sum_parts(struct lod_market *m, const struct lod_tally *t, struct lod_lot *cell, struct lod_lot *whole)
{
	(void)m;
	whole->parts += t->count * cell->parts;
}

static void see_cell(struct lod_market *m, const struct lod_tally *t, struct lod_lot *cell, struct lod_lot *whole)
{
	double rest = fmax(0, whole->seen - whole->own) * (double)m->counts[whole - m->lots];
	double part = whole->parts > 0 ? t->count * rest * cell->parts / whole->parts : 0;
	cell->seen += part;
	cell->bare += whole->seen > 0 ? part * whole->bare / whole->seen : 0;
	m->scratch[t->slot] += t->count;
}

/* What is seen of plants and not their own lists' is seen of their cells, in proportion to what these would cover. */
static void see_cells(struct lod_market *m)
{
	const struct lod_visible *visible = &m->p->visible;
	memset(m->scratch, 0, visible->slot_count * sizeof *m->scratch);
	for (uint32_t s = 0; s < visible->slot_count; s++)
		if (visible->slots[s].cell)
			m->lots[s].parts = anchor_pixels(m, &visible->slots[s]);
	lod_market_cells(m, sum_parts);
	lod_market_cells(m, see_cell);
	for (uint32_t s = 0; s < visible->slot_count; s++)
		if (visible->slots[s].cell && m->scratch[s] > 0) {
			m->lots[s].seen /= m->scratch[s];
			m->lots[s].bare /= m->scratch[s];
		}
}

/* ---- Tiles ---- */

/* A tile that is not opened is seen as one body; its plants are taken to be as dense as the scene's are in the mean. */
static void measure_closed(struct lod_market *m, const struct lod_sight *sight, struct lod_stall *stall)
{
	const struct lod_planning *p = m->p;
	const struct lod_node *node = &p->visible.nodes[sight->node];
	double ratio = lod_tables_ellipse(p->tables), px = 1 / ((double)sight->depth * p->visible.eye.pixel_rad);
	stall->pixels = seen_pixels(sight);
	stall->worth = (1 + LOD_ABSENT_WORTH) * stall->pixels;
	stall->bare = bare_pixels(sight);
	stall->plants += (double)p->scene->tiles[node->tile].instance_count;
	stall->look.box += ratio * node->area * px * px;
	stall->look.covered += ratio * node->area * px * px * sight->opacity;
}

/* What a summary is to cover of a plant. Between leaves at random and along twigs: taken for as thin as a picture shows them, summaries seem too wide
 * in closed forests, where gaps lead to other plants; taken as random, they seem good near by, where they fill all gaps. */
static double summed_pixels(const struct lod_sight *sight)
{
	return 0.5 * ((double)sight->opacity + sight->shown) * (double)sight->ellipse;
}

static void measure_stalls(struct lod_market *m)
{
	const struct lod_planning *p = m->p;
	for (uint32_t i = 0; i < p->screen.count; i++) {
		const struct lod_sight *sight = &p->screen.sights[i];
		struct lod_stall *stall = &m->stalls[sight->node];
		if (sight->slot == ECO_NONE) {
			measure_closed(m, sight, stall);
			continue;
		}
		if (!stall->open)
			continue;
		stall->look.covered += summed_pixels(sight);
		stall->look.box += sight->ellipse;
		stall->plants += 1;
		stall->factor += seen_pixels(sight);
		stall->bare += bare_pixels(sight);
		stall->even += m->lots[sight->slot].seen;
	}
}

static bool measure_summary(struct lod_market *m, uint32_t n)
{
	struct lod_planning *p = m->p;
	const struct lod_node *node = &p->visible.nodes[n];
	struct lod_stall *stall = &m->stalls[n];
	uint32_t list = p->scene->tiles[node->tile].summary;
	double center[3], from_eye[3], across, up, square = 0;
	lod_visible_box(&p->visible, node, center, &across, &up);
	/* from within or close by, splats of the same area are of all sizes: a summary is of no use there, but where the farthest are less than
	 * three times as far away as the nearest, and of full use only from twice as far on: so it goes little by little as a camera comes */
	double apart = node->distance / fmax(across, up) - 1;
	stall->summary = list != ECO_NONE && p->scene->lists[list].primitive_count > 0 && stall->pixels > 0 && stall->plants > 0 && apart > 0;
	stall->shut_most = fmin(1, apart);
	if (!stall->summary)
		return true;
	for (int i = 0; i < 3; i++) {
		from_eye[i] = center[i] - p->visible.eye.at[i];
		square += from_eye[i] * from_eye[i];
	}
	double r = fmax(node->distance, sqrt(square)), px = 1 / (r * p->visible.eye.pixel_rad);
	/* its points are those of all its plants, in view or not */
	double all = (double)p->scene->tiles[node->tile].instance_count, part = all > stall->plants ? stall->plants / all : 1;
	struct lod_summary_view look = { .area = 0.5 * node->area * px * px * part, .covered = stall->look.covered, .box = stall->look.box,
		.plants = stall->plants, .points = p->scene->lists[list].primitive_count, .worth = stall->worth };
	struct lod_tilt tilt = lod_tilt_at(&p->visible.eye, from_eye, 0.25 * fmax(across, up));
	look.wide = 2 * across * px;
	look.high = 2 * lod_tilt_height(&tilt, across, up) * px;
	uint32_t count = lod_points_count(look.points);
	struct lod_amount *room = take_amounts(m, 2 * count + 1);
	if (!room)
		return false;
	m->block_used += 2 * count + 1;
	p->candidates += count;
	lod_points_begin(&stall->points, &look, part, stall->pixels / stall->worth, fmin(1, stall->bare / stall->pixels), room, &p->gains);
	return true;
}

/* Children follow their parents: backwards, each is done before it is added up. */
static enum eco_code make_stalls(struct lod_market *m, struct eco_error *error)
{
	const struct lod_visible *visible = &m->p->visible;
	measure_stalls(m);
	for (uint32_t n = visible->node_count; n-- > 0;) {
		const struct lod_node *node = &visible->nodes[n];
		struct lod_stall *stall = &m->stalls[n];
		if (node->state == LOD_CLOSED)
			continue;
		stall->factor = stall->even > 0 ? stall->factor / stall->even : 1;
		for (uint32_t i = 0; stall->open && i < node->tally_count; i++) {
			const struct lod_lot *lot = &m->lots[node->tallies[i].slot];
			double seen = visible->slots[node->tallies[i].slot].cell ? 0 : stall->factor * node->tallies[i].count;
			stall->pixels += seen * lot->worth[0];
			stall->worth += seen * (lot->worth[0] + lot->absent);
		}
		for (uint32_t c = 0; stall->open && c < node->child_count; c++) {
			const struct lod_stall *child = &m->stalls[node->child_first + c];
			stall->pixels += child->pixels;
			stall->worth += child->worth;
			stall->bare += child->bare;
			stall->look.covered += child->look.covered;
			stall->look.box += child->look.box;
			stall->plants += child->plants;
		}
		if (!measure_summary(m, n))
			return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u tiles", visible->node_count);
	}
	return ECO_OK;
}

/* ---- Making ---- */

/* Tiles that are not opened are seen as wholes. */
static enum eco_code add_tiles(struct lod_planning *p, struct eco_error *error)
{
	for (uint32_t n = 0; n < p->visible.node_count; n++) {
		const struct lod_node *node = &p->visible.nodes[n];
		double center[3];
		struct lod_body body = { .area = node->area };
		if (node->state != LOD_SUMMARY)
			continue;
		lod_visible_box(&p->visible, node, center, &body.across, &body.up);
		body.crown_across = body.across;
		body.crown_up = body.up;
		struct lod_sight *sight = lod_screen_add(&p->screen, center, &body);
		if (sight) {
			sight->node = n;
			sight->slot = ECO_NONE;
		} else
			return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u tiles in view", p->visible.node_count);
	}
	return ECO_OK;
}

enum eco_code lod_market_make(struct lod_market *m, struct lod_planning *p, struct eco_error *error)
{
	const struct eco_scene *scene = p->scene;
	uint32_t slots = p->visible.slot_count, nodes = p->visible.node_count;
	*m = (struct lod_market){ .p = p };
	m->lots = calloc(slots + 1, sizeof *m->lots);
	m->scratch = calloc(slots + 1, sizeof *m->scratch);
	m->counts = calloc(slots + 1, sizeof *m->counts);
	m->stalls = calloc(nodes + 1, sizeof *m->stalls);
	m->drawn_by = calloc(nodes + 1, sizeof *m->drawn_by);
	m->slot_of = calloc((size_t)scene->plant_count * ECO_BANDS + 1, sizeof *m->slot_of);
	m->gates_most = malloc(scene->plant_count + 1u);
	m->gates_held = calloc(scene->plant_count + 1u, sizeof *m->gates_held);
	if (!m->lots || !m->scratch || !m->counts || !m->stalls || !m->drawn_by || !m->slot_of || !m->gates_most || !m->gates_held)
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u slots", slots);
	for (uint32_t i = 0; i < scene->plant_count; i++)
		m->gates_most[i] = (uint8_t)(p->gates[i] / ECO_SHARE_ONE);
	for (uint32_t s = 0; s < slots; s++)
		m->counts[s] = p->visible.slots[s].count;
	for (uint32_t n = 0; n < nodes; n++)
		m->stalls[n].open = p->visible.nodes[n].state == LOD_OPEN;
	enum eco_code code = add_tiles(p, error);
	if (!code)
		code = lod_screen_shares(&p->screen, !p->input->ignore_occlusion, error);
	if (code)
		return code;
	see_plants(m);
	for (uint32_t s = 0; !code && s < slots; s++)
		if (!p->visible.slots[s].cell)
			code = make_lot(m, s, error);
	see_cells(m);
	for (uint32_t s = 0; !code && s < slots; s++)
		if (p->visible.slots[s].cell)
			code = make_lot(m, s, error);
	if (!code)
		code = make_stalls(m, error);
	m->sharp = m->stalls[0].plants < SHARP_BELOW;
	return code;
}

void lod_market_free(struct lod_market *m)
{
	for (uint32_t i = 0; i < m->block_count; i++)
		free(m->blocks[i]);
	free(m->blocks);
	free(m->lots);
	free(m->scratch);
	free(m->counts);
	free(m->stalls);
	free(m->drawn_by);
	free(m->offers);
	free(m->slot_of);
	free(m->gates_most);
	free(m->gates_held);
	*m = (struct lod_market){ 0 };
}
