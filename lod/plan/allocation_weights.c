/* Weights, hulls and tiles of an allocation; none depends on lambda: see lod/plan/allocation.h. Longer
 * than 600 lines: all of it is made once, in one order. */
#include "lod/plan/allocation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"
#include "lod/ladder.h"
#include "lod/plan/byte_price.h"
#include "lod/plan/texture_levels.h"

#define PI 3.14159265358979323846

static double open_of(double unoccluded, double seen)
{
	return seen > 0 ? fmin(1, fmax(LOD_OPEN_LEAST, unoccluded / seen)) : 1;
}

static bool add_ladder_choice(struct lod_allocation *m, const struct lod_ladder_choice *choice)
{
	if (!eco_array_grow(&m->ladder_choices, &m->ladder_choice_capacity, m->ladder_choice_count,
			sizeof *m->ladder_choices))
		return false;
	m->ladder_choices[m->ladder_choice_count] = *choice;
	m->ladder_choices[m->ladder_choice_count++].hull_count = choice->hull.count;
	return true;
}

/* ---- Weights ---- */

/* Pixels that one plant's organ would cover at full detail with nothing before it: random leaves on an
 * ellipse. Wood shows where leaves let it. Only the ratios between a plant's organs and cells matter: the
 * screen knows how much of the whole plant is seen. */
static double organ_pixels(const struct lod_allocation *m, const struct eco_ladder *ladder, uint32_t s)
{
	const struct lod_planner *p = m->p;
	const struct eco_plant *plant = &p->scene->plants[ladder->plant];
	const struct eco_anchor *anchor = &p->scene->anchors[ladder->anchor];
	const struct lod_slot_choice *slot_choice = &m->slot_choices[s];
	struct lod_proxy_shape proxy_shape = { .area = ladder->area, .crown_across = anchor->radius,
		.crown_up = anchor->radius };
	if (ladder->anchor == plant->anchor_first) {
		proxy_shape = lod_plan_tables_proxy_shapes(p->tables)[ladder->plant];
		proxy_shape.area = ladder->area;
	}
	double r = lod_band_distance_m(p->visible.slots[s].band), px = 1 / (r * p->visible.eye.pixel_rad);
	double pixels = lod_proxy_shape_opacity(&proxy_shape) * PI * proxy_shape.crown_across
		* proxy_shape.crown_up * px * px;
	if (ladder->organ != ECO_ORGAN_WOOD)
		return pixels;
	proxy_shape = lod_plan_tables_proxy_shapes(p->tables)[ladder->plant];
	proxy_shape.area = slot_choice->wood_behind * fmax(0, plant->area - 2 * (double)ladder->area);
	return pixels * slot_choice->wood_nearer
		* fmax(LOD_WOOD_HIDDEN, 1 - lod_proxy_shape_opacity(&proxy_shape));
}

static double importance_of(const struct eco_ladder *ladder)
{
	return ladder->importance > 0 ? ladder->importance : 1;
}

/* The share of a cell's elements that the plant's own list does not draw already; 1 of whole plants. */
static double rest_of(const struct lod_slot *slot, const struct eco_ladder *ladder)
{
	return slot->cell && ladder->total ? 1 - (double)ladder->before / ladder->total : 1;
}

/* Pixels of all ladders at the slot's anchor; of a cell, without what the plant's own lists draw. */
static double anchor_pixels(const struct lod_allocation *m, uint32_t s)
{
	const struct lod_slot *slot = &m->p->visible.slots[s];
	uint32_t count;
	const uint32_t *ladders = lod_plan_tables_anchor(m->p->tables, slot->anchor, &count);
	double sum = 0;
	for (uint32_t i = 0; i < count; i++) {
		const struct eco_ladder *ladder = &m->p->scene->ladders[ladders[i]];
		sum += rest_of(slot, ladder) * organ_pixels(m, ladder, s);
	}
	return sum;
}

/* The place of a slot's plants among the sizes of eco_seen, by the sphere of the whole plant. */
static double slot_size(const struct lod_allocation *m, const struct lod_slot *slot)
{
	const struct eco_scene *scene = m->p->scene;
	double px = 1 / (lod_band_distance_m(slot->band) * m->p->visible.eye.pixel_rad);
	return lod_hull_size(2 * px * (double)scene->anchors[scene->plants[slot->plant].anchor_first].radius);
}

static bool own_points(struct lod_allocation *m, struct lod_hull *hull, const struct lod_hull_point *points)
{
	hull->points = lod_arena_try(&m->memory, hull->count, sizeof *points);
	if (hull->points)
		memcpy(hull->points, points, hull->count * sizeof *points);
	return hull->points;
}

/* The hull of an organ's ladder for a slot, at its size: at both weights and between. */
static bool slot_hull(struct lod_allocation *m, const struct lod_hull *from, const struct lod_slot *slot,
	struct lod_hull *hull)
{
	struct lod_hull_point points[LOD_HULL_POINTS_MAX];
	uint64_t to = from->points[from->count - 1].vertices;
	double size = slot_size(m, slot);
	*hull = (struct lod_hull){ points, from->count, 1, size, ECO_NONE };
	memcpy(points, from->points, from->count * sizeof *points);
	for (uint32_t i = 0; i < from->count; i++)
		lod_hull_set_size(&points[i], size);
	for (int i = 0; i < 2; i++) {
		hull->open = i ? 1 : LOD_OPEN_LEAST;
		lod_hull_reduce(hull, LOD_HULL_SLOPE_RATIO);
	}
	lod_hull_complete(hull, to);
	return own_points(m, hull, points);
}

static bool add_ladder_choices(struct lod_allocation *m, uint32_t s, uint32_t id, double weight_px)
{
	const struct eco_scene *scene = m->p->scene;
	const struct lod_slot *slot = &m->p->visible.slots[s];
	const struct eco_ladder *ladder = &scene->ladders[id];
	const struct lod_plan_tables_ladder *table = lod_plan_tables_ladder(m->p->tables, id);
	if (!table)
		return false;
	struct lod_ladder_choice choice = { .slot = s, .ladder = id, .weight_px = weight_px };
	if (!slot_hull(m, &table->hull[0], slot, &choice.hull))
		return false;
	choice.hull.open = m->slot_choices[s].open;
	choice.when = slot->cell || scene->plants[slot->plant].anchor_count < 2 ? LOD_ALWAYS : LOD_FAR;
	if (!add_ladder_choice(m, &choice))
		return false;
	if (choice.when == LOD_ALWAYS || ladder->flags & ECO_LADDER_FAR)
		return true;
	/* beside cells the same list stands for its own part of the plant alone, and begins where it does */
	choice.when = LOD_NEAR;
	if (!slot_hull(m, &table->hull[1], slot, &choice.hull))
		return false;
	choice.hull.open = m->slot_choices[s].open;
	choice.weight_px = weight_px * lod_way_density(&table->way, table->way.full);
	return add_ladder_choice(m, &choice);
}

/* The hull of a ladder that shows the whole plant, for a slot. At 0 vertices as much is wrong as where nothing of
 * its organs is drawn. Which level of an impostor one vertex is, if any, depends on the band. */
static bool whole_hull(struct lod_allocation *m, const struct lod_plan_tables_ladder *table,
	const struct lod_slot_choice *slot_choice, struct lod_hull *hull)
{
	struct lod_hull_point points[LOD_HULL_POINTS_MAX];
	const struct lod_hull *from = &table->hull[0];
	struct lod_hull_point *room = hull->points;  /* of a hull made before */
	uint32_t levels = lod_hull_impostor_levels(&table->way);
	double weight_px = slot_choice->weight_px[0];
	hull->count = 0;
	for (uint32_t i = 0; i < from->count; i++) {
		bool impostor = from->points[i].vertices == 1 && levels;
		if (impostor && hull->impostor == ECO_NONE)
			continue;
		points[hull->count] = impostor ? lod_hull_point_at(&table->way, 1, hull->size, hull->impostor)
			: from->points[i];
		lod_hull_set_size(&points[hull->count++], hull->size);
	}
	points->alike = weight_px > 0 ? slot_choice->nothing.alike / weight_px : LOD_SEEN_NOTHING;
	points->open = weight_px > 0 ? slot_choice->nothing.open / weight_px : 0;
	hull->points = points;
	lod_hull_reduce(hull, LOD_HULL_SLOPE_RATIO);
	lod_hull_complete(hull, lod_way_stage_end(&table->way));
	if (!room)
		room = lod_arena_try(&m->memory, from->count + 1, sizeof *room);
	if (room)
		memcpy(room, points, hull->count * sizeof *points);
	hull->points = room;
	return room;
}

/* Ladders that show the whole plant weigh as much as all its organs together. */
static bool add_whole_choices(struct lod_allocation *m, uint32_t s)
{
	struct lod_slot_choice *slot_choice = &m->slot_choices[s];
	const struct lod_slot *slot = &m->p->visible.slots[s];
	uint32_t count;
	const uint32_t *ladders = lod_plan_tables_whole(m->p->tables, slot->anchor, &count);
	for (uint32_t i = 0; i < count; i++) {
		const struct lod_plan_tables_ladder *table = lod_plan_tables_ladder(m->p->tables, ladders[i]);
		struct lod_ladder_choice choice = { .slot = s, .ladder = ladders[i], .when = LOD_WHOLE,
			.weight_px = slot_choice->weight_px[0], .hull.open = slot_choice->open,
			.hull.size = slot_size(m, slot) };
		if (!table)
			return false;
		choice.hull.impostor = lod_impostor_of_slot(m, slot, &table->way);
		if (!whole_hull(m, table, slot_choice, &choice.hull) || !add_ladder_choice(m, &choice))
			return false;
		m->has_whole = true;
		slot_choice->whole_count++;
		slot_choice->ladder_choice_count++;
	}
	return true;
}

void lod_allocation_set_impostors(struct lod_allocation *m, const double *seen)
{
	if (!m->has_whole)
		return;
	lod_impostor_worth(m, seen);
	for (uint32_t i = 0; i < m->ladder_choice_count; i++) {
		struct lod_ladder_choice *choice = &m->ladder_choices[i];
		if (choice->when != LOD_WHOLE)
			continue;
		const struct lod_slot_choice *slot_choice = &m->slot_choices[choice->slot];
		const struct lod_plan_tables_ladder *table = lod_plan_tables_ladder(m->p->tables,
			choice->ladder);
		uint32_t level = lod_impostor_of_slot(m, &m->p->visible.slots[choice->slot], &table->way);
		if (level == choice->hull.impostor)
			continue;
		choice->hull.impostor = level;
		whole_hull(m, table, slot_choice, &choice->hull);
		choice->hull_count = choice->hull.count;
		choice->position = fmin(choice->position, choice->hull.count - 1);
		lod_allocation_unsettle(m, choice->slot);
	}
}

static enum eco_code make_slot_choice(struct lod_allocation *m, uint32_t s, struct eco_error *error)
{
	const struct eco_scene *scene = m->p->scene;
	const struct lod_slot *slot = &m->p->visible.slots[s];
	struct lod_slot_choice *slot_choice = &m->slot_choices[s];
	double all = anchor_pixels(m, s);
	uint32_t count;
	const uint32_t *ladders = lod_plan_tables_anchor(m->p->tables, slot->anchor, &count);
	bool good = true;
	slot_choice->open = open_of(slot_choice->unoccluded, slot_choice->seen);
	slot_choice->whole = ECO_NONE;
	slot_choice->lambda = NAN;
	slot_choice->ladder_choice_first = m->ladder_choice_count;
	for (uint32_t i = 0; good && i < count; i++) {
		uint32_t id = ladders[i];
		const struct eco_ladder *ladder = &scene->ladders[id];
		double part = all > 0 ? rest_of(slot, ladder) * organ_pixels(m, ladder, s) / all : 0;
		good = add_ladder_choices(m, s, id, part * slot_choice->seen * importance_of(ladder));
	}
	slot_choice->ladder_choice_count = m->ladder_choice_count - slot_choice->ladder_choice_first;
	for (uint32_t i = slot_choice->ladder_choice_first; good && i < m->ladder_choice_count; i++) {
		const struct lod_ladder_choice *ladder_choice = &m->ladder_choices[i];
		const struct eco_ladder *ladder = &scene->ladders[ladder_choice->ladder];
		slot_choice->weight_px[0] += ladder_choice->when == LOD_NEAR ? 0 : ladder_choice->weight_px;
		slot_choice->weight_px[1] += ladder_choice->when == LOD_FAR ? 0 : ladder_choice->weight_px;
		if (ladder_choice->when != LOD_NEAR) {
			const struct lod_hull_point *none = &ladder_choice->hull.points[0];
			slot_choice->nothing.alike += ladder_choice->weight_px * none->alike;
			slot_choice->nothing.open += ladder_choice->weight_px * none->open;
		}
		slot_choice->own += ladder_choice->when == LOD_NEAR
			? ladder_choice->weight_px / importance_of(ladder) : 0;
	}
	good = good && add_whole_choices(m, s);
	return good ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u ladder choices",
		m->ladder_choice_count);
}

/* ---- Pixels seen ---- */

static double seen_pixels(const struct lod_visibility *visibility)
{
	return (double)(visibility->share * visibility->pixels + visibility->shade);
}

static double unoccluded_pixels(const struct lod_visibility *visibility)
{
	return (double)visibility->unoccluded * visibility->pixels;
}

/* Sets each slot's mean of pixels seen. The mean of a few plants jumps when one plant more crosses a band's
 * border or is hidden. So plants of the bands around it count too, as if they were at the slot's distance,
 * and the less the more plants the slot has itself. Sums are read from `own` and `parts`, numbers of plants
 * from m->scratch. */
static void smooth_plants(struct lod_allocation *m)
{
	const struct lod_visible_tree *visible = &m->p->visible;
	for (uint32_t s = 0; s < visible->slot_count; s++) {
		const struct lod_slot *slot = &visible->slots[s];
		double own = m->scratch[s], seen = 0, unoccluded = 0, sum = 0,
			nominal = lod_band_distance_m(slot->band);
		for (int k = -LOD_SMOOTH_BANDS; !slot->cell && k <= LOD_SMOOTH_BANDS; k++) {
			int band = (int)slot->band + k;
			uint32_t t = band < 0 || band >= (int)ECO_BANDS ? ECO_NONE
				: lod_allocation_slot(m, slot->plant, (uint8_t)band);
			if (t == ECO_NONE || !(m->scratch[t] > 0))
				continue;
			double far = lod_band_distance_m((uint8_t)band) / nominal,
				weight = k == 0 ? 1 : fmin(1, LOD_SMOOTH_PLANTS / own) * ldexp(1, -abs(k));
			seen += weight * far * far * m->slot_choices[t].own;
			unoccluded += weight * far * far * m->slot_choices[t].parts;
			sum += weight * m->scratch[t];
		}
		m->slot_choices[s].seen = own > 0 ? seen / sum : 0;
		m->slot_choices[s].unoccluded = own > 0 ? unoccluded / sum : 0;
	}
	for (uint32_t s = 0; s < visible->slot_count; s++)
		m->slot_choices[s].own = m->slot_choices[s].parts = 0;
}

static void measure_plants(struct lod_allocation *m)
{
	struct lod_planner *p = m->p;
	double *counts = m->scratch;
	memset(counts, 0, p->visible.slot_count * sizeof *counts);
	for (uint32_t i = 0; i < p->screen.count; i++) {
		const struct lod_visibility *visibility = &p->screen.visibilities[i];
		if (visibility->slot == ECO_NONE || !m->tile_choices[visibility->node].open)
			continue;
		m->slot_choices[visibility->slot].own += seen_pixels(visibility);
		m->slot_choices[visibility->slot].parts += unoccluded_pixels(visibility);
		m->slot_choices[visibility->slot].wood_nearer += (double)visibility->wood_nearer;
		m->slot_choices[visibility->slot].wood_behind += (double)visibility->wood_behind;
		counts[visibility->slot] += 1;
	}
	for (uint32_t s = 0; s < p->visible.slot_count; s++) {
		const struct lod_slot *slot = &p->visible.slots[s];
		struct lod_slot_choice *slot_choice = &m->slot_choices[s];
		double across = lod_plan_tables_proxy_shapes(p->tables)[slot->plant].crown_across,
			r = lod_band_distance_m(slot->band);
		slot_choice->wood_nearer = counts[s] > 0 ? slot_choice->wood_nearer / counts[s] : 1;
		slot_choice->wood_behind = counts[s] > 0 ? slot_choice->wood_behind / counts[s]
			: r < across ? r / across : 1;
		if (!slot->cell)
			m->slot_of[slot->plant * (size_t)ECO_BANDS + slot->band] = s + 1;
	}
	smooth_plants(m);
}

/* Calls fn for each tally of cells in open tiles, with the slot choice of the cell and that of the whole plants. */
static void each_cell(struct lod_allocation *m, void (*fn)(struct lod_allocation *m,
	const struct lod_tally *tally, struct lod_slot_choice *cell, struct lod_slot_choice *whole))
{
	const struct lod_visible_tree *visible = &m->p->visible;
	for (uint32_t n = 0; n < visible->node_count; n++) {
		const struct lod_node *node = &visible->nodes[n];
		for (uint32_t i = 0; m->tile_choices[n].open && i < node->tally_count; i++) {
			const struct lod_tally *t = &node->tallies[i];
			const struct lod_slot *slot = &visible->slots[t->slot];
			if (slot->cell)
				fn(m, t, &m->slot_choices[t->slot],
					&m->slot_choices[lod_allocation_slot(m, slot->plant, t->whole_band)]);
		}
	}
}

static void sum_parts(struct lod_allocation *m, const struct lod_tally *t, struct lod_slot_choice *cell,
	struct lod_slot_choice *whole)
{
	(void)m;
	whole->parts += t->count * cell->parts;
}

static void add_cell(struct lod_allocation *m, const struct lod_tally *t, struct lod_slot_choice *cell,
	struct lod_slot_choice *whole)
{
	double rest = fmax(0, whole->seen - whole->own) * (double)m->counts[whole - m->slot_choices];
	double part = whole->parts > 0 ? t->count * rest * cell->parts / whole->parts : 0;
	cell->seen += part;
	cell->unoccluded += whole->seen > 0 ? part * whole->unoccluded / whole->seen : 0;
	m->scratch[t->slot] += t->count;
}

/* Pixels of a plant that are seen and are not its own lists' are shared among its cells, in proportion to
 * their pixels. */
static void measure_cells(struct lod_allocation *m)
{
	const struct lod_visible_tree *visible = &m->p->visible;
	memset(m->scratch, 0, visible->slot_count * sizeof *m->scratch);
	for (uint32_t s = 0; s < visible->slot_count; s++)
		if (visible->slots[s].cell)
			m->slot_choices[s].parts = anchor_pixels(m, s);
	each_cell(m, sum_parts);
	each_cell(m, add_cell);
	for (uint32_t s = 0; s < visible->slot_count; s++)
		if (visible->slots[s].cell && m->scratch[s] > 0) {
			m->slot_choices[s].seen /= m->scratch[s];
			m->slot_choices[s].unoccluded /= m->scratch[s];
		}
}

/* ---- Tiles ---- */

/* A tile whose plants were not counted is seen as one proxy shape, as dense as the scene's plants are in the
 * mean. */
static void measure_closed(struct lod_allocation *m, const struct lod_visibility *visibility,
	struct lod_tile_choice *choice)
{
	const struct lod_planner *p = m->p;
	const struct lod_node *node = &p->visible.nodes[visibility->node];
	double ratio = lod_plan_tables_ellipse(p->tables),
		px = 1 / ((double)visibility->depth * p->visible.eye.pixel_rad);
	choice->pixels = seen_pixels(visibility);
	choice->weight_px = LOD_SEEN_NOTHING * choice->pixels;
	choice->unoccluded = unoccluded_pixels(visibility);
	choice->plants += (double)p->scene->tiles[node->tile].instance_count;
	choice->view.box += ratio * node->area * px * px;
	choice->view.covered += ratio * node->area * px * px * visibility->opacity;
}

/* Pixels that a summary should cover in place of a plant: the mean of random leaves and of leaves along
 * twigs. With the thinner crown alone summaries seem too wide in closed forests, where gaps lead to other
 * plants; with the denser one alone they seem good near by, where they fill all gaps. */
static double summed_pixels(const struct lod_visibility *visibility)
{
	return 0.5 * (double)(visibility->opacity + visibility->shown) * (double)visibility->ellipse;
}

static void measure_tile_choices(struct lod_allocation *m)
{
	const struct lod_planner *p = m->p;
	for (uint32_t i = 0; i < p->screen.count; i++) {
		const struct lod_visibility *visibility = &p->screen.visibilities[i];
		struct lod_tile_choice *choice = &m->tile_choices[visibility->node];
		if (visibility->slot == ECO_NONE) {
			measure_closed(m, visibility, choice);
			continue;
		}
		if (!choice->open)
			continue;
		choice->view.covered += summed_pixels(visibility);
		choice->view.box += visibility->ellipse;
		choice->plants += 1;
		choice->factor += seen_pixels(visibility);
		choice->unoccluded += unoccluded_pixels(visibility);
		choice->mean_seen += m->slot_choices[visibility->slot].seen;
	}
}

static bool measure_summary(struct lod_allocation *m, uint32_t n)
{
	struct lod_planner *p = m->p;
	const struct lod_node *node = &p->visible.nodes[n];
	struct lod_tile_choice *choice = &m->tile_choices[n];
	uint32_t list = p->scene->tiles[node->tile].summary;
	double center[3], from_eye[3], across, up, square = 0;
	lod_visible_tree_box(&p->visible, node, center, &across, &up);
	/* From within a tile or close to it, splats of one area are of all sizes in the picture. A summary
	 * may be used from where the farthest plant is less than three times as far away as the nearest, and
	 * without limit from twice that distance on: between the two it gives way gradually. */
	double apart = node->distance / fmax(across, up) - 1;
	choice->has_summary = list != ECO_NONE && p->scene->lists[list].primitive_count > 0
		&& choice->pixels > 0 && choice->plants > 0 && apart > 0;
	choice->closed_most = fmin(1, apart);
	if (!choice->has_summary)
		return true;
	for (int i = 0; i < 3; i++) {
		from_eye[i] = center[i] - p->visible.eye.at[i];
		square += from_eye[i] * from_eye[i];
	}
	double r = fmax(node->distance, sqrt(square)), px = 1 / (r * p->visible.eye.pixel_rad);
	/* the summary's points stand for all plants of the tile, in view or not */
	double all = (double)p->scene->tiles[node->tile].instance_count, part = all > choice->plants
		? choice->plants / all : 1;
	struct lod_summary_view view = { .area = 0.5 * node->area * px * px * part,
		.covered = choice->view.covered, .box = choice->view.box,
		.plants = choice->plants, .points = p->scene->lists[list].primitive_count,
		.weight_px = choice->weight_px };
	view.wide = 2 * across * px;
	view.high = 2 * lod_height_seen(across, up, from_eye) * px;
	const uint32_t points = lod_summary_hull_count(p->scene->lists[list].primitive_count);
	struct lod_hull_point *room = lod_arena_try(&m->memory, 2 * (size_t)points, sizeof *room);
	if (!room)
		return false;
	choice->limited.points = room + points;
	lod_summary_hull_make(&choice->summary, &view, part, fmin(1, choice->pixels / choice->weight_px),
		fmin(1, choice->unoccluded / choice->pixels), room);
	lod_planner_work(p, LOD_WORK_SUMMARY);
	return true;
}

/* From the last node to the first: children follow their parents. */
static enum eco_code make_tile_choices(struct lod_allocation *m, struct eco_error *error)
{
	const struct lod_visible_tree *visible = &m->p->visible;
	measure_tile_choices(m);
	for (uint32_t n = visible->node_count; n-- > 0;) {
		const struct lod_node *node = &visible->nodes[n];
		struct lod_tile_choice *tile_choice = &m->tile_choices[n];
		if (node->state == LOD_CLOSED)
			continue;
		tile_choice->factor = tile_choice->mean_seen > 0
			? tile_choice->factor / tile_choice->mean_seen : 1;
		for (uint32_t i = 0; tile_choice->open && i < node->tally_count; i++) {
			const struct lod_slot_choice *slot_choice = &m->slot_choices[node->tallies[i].slot];
			double seen = visible->slots[node->tallies[i].slot].cell ? 0
				: tile_choice->factor * node->tallies[i].count;
			tile_choice->pixels += seen * slot_choice->weight_px[0];
			tile_choice->weight_px += seen * (slot_choice->nothing.alike
				+ slot_choice->open * slot_choice->nothing.open);
		}
		for (uint32_t c = 0; tile_choice->open && c < node->child_count; c++) {
			const struct lod_tile_choice *child = &m->tile_choices[node->child_first + c];
			tile_choice->pixels += child->pixels;
			tile_choice->weight_px += child->weight_px;
			tile_choice->unoccluded += child->unoccluded;
			tile_choice->view.covered += child->view.covered;
			tile_choice->view.box += child->view.box;
			tile_choice->plants += child->plants;
		}
		if (!measure_summary(m, n))
			return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u tiles",
				visible->node_count);
	}
	return ECO_OK;
}

/* ---- Making ---- */

/* Adds to the screen each tile whose plants were not counted, as one proxy shape. */
static enum eco_code add_tiles(struct lod_planner *p, struct eco_error *error)
{
	for (uint32_t n = 0; n < p->visible.node_count; n++) {
		const struct lod_node *node = &p->visible.nodes[n];
		double center[3];
		struct lod_proxy_shape proxy_shape = { .area = node->area, .leaf_area = node->area };
		if (node->state != LOD_SUMMARY)
			continue;
		lod_visible_tree_box(&p->visible, node, center, &proxy_shape.across, &proxy_shape.up);
		proxy_shape.crown_across = proxy_shape.across;
		proxy_shape.crown_up = proxy_shape.up;
		struct lod_visibility *visibility = lod_screen_add(&p->screen, center, &proxy_shape);
		if (visibility) {
			visibility->node = n;
			visibility->slot = ECO_NONE;
		} else
			return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u tiles in view",
				p->visible.node_count);
	}
	return ECO_OK;
}

/* A picture of a few plants that fill it needs as many cells for each as there are: fewer then tell as much.
 * Returns those that all need. */
static uint64_t bound_cells(struct lod_planner *p)
{
	uint64_t cells = lod_screen_cells(&p->screen);
	while (p->input->work_max && cells > p->input->work_max / LOD_CELLS_PART / LOD_WORK_CELL
			&& p->screen.columns * p->screen.rows > LOD_CELLS_LEAST) {
		lod_screen_coarsen(&p->screen);
		cells = lod_screen_cells(&p->screen);
	}
	return cells;
}

enum eco_code lod_allocation_make(struct lod_allocation *m, struct lod_planner *p, struct eco_error *error)
{
	const struct eco_scene *scene = p->scene;
	uint32_t slots = p->visible.slot_count, nodes = p->visible.node_count;
	*m = (struct lod_allocation){ .p = p, .relaxed.lambda = NAN, .tiles.lambda = NAN };
	m->slot_choices = lod_arena_try(&m->memory, slots, sizeof *m->slot_choices);
	m->scratch = lod_arena_try(&m->memory, slots, sizeof *m->scratch);
	m->counts = lod_arena_try(&m->memory, slots, sizeof *m->counts);
	m->tile_choices = lod_arena_try(&m->memory, nodes, sizeof *m->tile_choices);
	m->drawn_by = lod_arena_try(&m->memory, nodes, sizeof *m->drawn_by);
	m->drawn_here = lod_arena_try(&m->memory, nodes, sizeof *m->drawn_here);
	m->slot_wrong = lod_arena_try(&m->memory, slots, sizeof *m->slot_wrong);
	m->slot_of = lod_arena_try(&m->memory, (size_t)scene->plant_count * ECO_BANDS, sizeof *m->slot_of);
	m->gates_counted = lod_arena_try(&m->memory, scene->plant_count, 1);
	m->plant_seen = lod_arena_try(&m->memory, scene->plant_count, sizeof *m->plant_seen);
	m->impostors = lod_arena_try(&m->memory, scene->plant_count, sizeof *m->impostors);
	if (m->memory.failed)
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u slots", slots);
	for (uint32_t i = 0; i < scene->plant_count; i++)
		m->gates_counted[i] = (uint8_t)(p->gates[i] / ECO_SHARE_ONE);
	for (uint32_t s = 0; s < slots; s++)
		m->counts[s] = p->visible.slots[s].count;
	for (uint32_t n = 0; n < nodes; n++)
		if ((m->tile_choices[n].open = p->visible.nodes[n].state == LOD_OPEN))
			m->tallies += p->visible.nodes[n].tally_count;
	enum eco_code code = add_tiles(p, error);
	if (!code)
		m->cells = bound_cells(p);
	if (!code)
		code = lod_screen_shares(&p->screen, !p->input->ignore_occlusion, error);
	if (code)
		return code;
	measure_plants(m);
	for (uint32_t s = 0; s < slots; s++)
		m->scratch[s] = m->slot_choices[s].seen * (double)m->counts[s];
	lod_impostor_worth(m, m->scratch);
	for (uint32_t s = 0; !code && s < slots; s++)
		if (!p->visible.slots[s].cell)
			code = make_slot_choice(m, s, error);
	measure_cells(m);
	for (uint32_t s = 0; !code && s < slots; s++)
		if (p->visible.slots[s].cell)
			code = make_slot_choice(m, s, error);
	if (!code)
		code = make_tile_choices(m, error);
	m->few_plants = m->tile_choices[0].plants < LOD_FEW_PLANTS;
	lod_planner_work(p, LOD_WORK_VISIBILITY * (uint64_t)p->screen.count
		+ LOD_WORK_CELL * m->cells + LOD_WORK_TALLY * m->tallies
		+ 4 * LOD_WORK_CHOICE * (uint64_t)m->ladder_choice_count
		+ 4 * LOD_WORK_NODE * (uint64_t)nodes);
	return code ? code : lod_uses_make(m, error);
}

void lod_allocation_free(struct lod_allocation *m)
{
	lod_prices_free(m);
	free(m->ladder_choices);
	lod_arena_free(&m->memory);
	*m = (struct lod_allocation){ 0 };
}
