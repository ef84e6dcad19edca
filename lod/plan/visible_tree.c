/* The visible part of the tile tree, opened lazily: see lod/plan/visible_tree.h.
 * Longer than 600 lines: one walk, whose boxes and ranges no other file sees. */
#include "lod/plan/visible_tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"
#include "ecofiles/base/angle16.h"
#include "lod/plan/planner.h"

static enum eco_code no_memory(struct eco_error *error)
{
	eco_fail(error, ECO_NO_MEMORY, "planning: no memory for what is in view");
	return ECO_NO_MEMORY;
}

/* ---- Boxes ---- */

struct box { double center[3], half[3], axis[3][3]; }; /* world; half extents along the axes */

static void tile_box(const struct lod_visible_tree *visible, uint32_t tile, uint32_t placement,
	struct box *box)
{
	const struct eco_tile *t = &visible->scene->tiles[tile];
	const struct eco_placement *p = &visible->placements[placement];
	double sine, cosine, middle[3];
	eco_angle16_sincos(p->turn, &sine, &cosine);
	for (int i = 0; i < 3; i++) {
		middle[i] = t->low[i] + (t->high[i] - t->low[i]) * 0.5;
		box->half[i] = (t->high[i] - t->low[i]) * 0.5 * p->scale;
	}
	box->center[0] = p->at[0] + p->scale * (cosine * middle[0] - sine * middle[1]);
	box->center[1] = p->at[1] + p->scale * (sine * middle[0] + cosine * middle[1]);
	box->center[2] = p->at[2] + p->scale * middle[2];
	double axes[3][3] = { { cosine, sine, 0 }, { -sine, cosine, 0 }, { 0, 0, 1 } };
	memcpy(box->axis, axes, sizeof axes);
}

static bool box_seen(const struct lod_eye *eye, const struct box *box)
{
	double from_eye[3] = { box->center[0] - eye->at[0], box->center[1] - eye->at[1],
		box->center[2] - eye->at[2] };
	for (int plane = 0; plane < 5; plane++) {
		const double *normal = plane < 4 ? eye->side[plane] : eye->forward;
		double reach = 0;
		for (int i = 0; i < 3; i++)
			reach += fabs(lod_dot(normal, box->axis[i])) * box->half[i];
		if (lod_dot(normal, from_eye) < -reach * (1.0 + 1e-9))
			return false;
	}
	return true;
}

static double box_distance(const struct lod_eye *eye, const struct box *box)
{
	double from_center[3] = { eye->at[0] - box->center[0], eye->at[1] - box->center[1],
		eye->at[2] - box->center[2] };
	double square = 0;
	for (int i = 0; i < 3; i++) {
		double outside = fabs(lod_dot(from_center, box->axis[i])) - box->half[i];
		if (outside > 0)
			square += outside * outside;
	}
	return sqrt(square);
}

void lod_visible_tree_box(const struct lod_visible_tree *visible, const struct lod_node *node,
	double center[3], double *across, double *up)
{
	struct box box;
	tile_box(visible, node->tile, node->placement, &box);
	memcpy(center, box.center, sizeof box.center);
	*across = (box.half[0] + box.half[1]) / 2;
	*up = box.half[2];
}

/* ---- Nodes and placements ---- */

static enum eco_code add_node(struct lod_visible_tree *visible, uint32_t tile, uint32_t placement,
	struct eco_error *error)
{
	const uint64_t bound = visible->bounds.nodes, most = bound && bound < visible->nodes_max ? bound : visible->nodes_max;
	if (visible->node_count >= most)
		return eco_fail(error, ECO_TOO_LARGE, "this view at this detail opens more than %llu tiles; "
			"ask for fewer vertices", (unsigned long long)most);
	if (!eco_array_grow(&visible->nodes, &visible->node_capacity, visible->node_count, sizeof *visible->nodes))
		return no_memory(error);
	struct lod_node *node = &visible->nodes[visible->node_count++];
	struct box box;
	double scale = visible->placements[placement].scale;
	*node = (struct lod_node){ .tile = tile, .placement = placement };
	tile_box(visible, tile, placement, &box);
	node->seen = box_seen(&visible->eye, &box);
	node->distance = box_distance(&visible->eye, &box);
	node->area = visible->scene->tiles[tile].area * scale * scale;
	return ECO_OK;
}

static enum eco_code add_placement(struct lod_visible_tree *visible, uint32_t outer, uint32_t tile,
	uint32_t child, struct eco_error *error)
{
	if (visible->placement_count >= visible->placements_max)
		return eco_fail(error, ECO_TOO_LARGE, "this view at this detail places more than %llu "
			"nested eco files; ask for fewer vertices",
			(unsigned long long)visible->placements_max);
	if (!eco_array_grow(&visible->placements, &visible->placement_capacity, visible->placement_count,
			sizeof *visible->placements))
		return no_memory(error);
	struct eco_placement inside = eco_placement_inside(&visible->placements[outer],
		&visible->scene->children[child]);
	inside.path += eco_owner_step(visible->scene, tile, child);
	visible->placements[visible->placement_count++] = inside;
	return ECO_OK;
}

static enum eco_code expand(struct lod_visible_tree *visible, uint32_t index, struct eco_error *error)
{
	const struct eco_tile *tile = &visible->scene->tiles[visible->nodes[index].tile];
	uint32_t first = visible->node_count, placement = visible->nodes[index].placement;
	for (uint32_t i = 0; i < tile->child_count; i++) {
		const struct eco_child *child = &visible->scene->children[tile->child_first + i];
		uint32_t in = placement;
		if (child->placed) {
			if (add_placement(visible, placement, visible->nodes[index].tile,
					tile->child_first + i, error))
				return error ? error->code : ECO_TOO_LARGE;
			in = visible->placement_count - 1;
		}
		enum eco_code code = add_node(visible, child->tile, in, error);
		if (code)
			return code;
	}
	struct lod_node *node = &visible->nodes[index];
	node->child_first = first;
	node->child_count = tile->child_count;
	node->expanded = true;
	return ECO_OK;
}

/* ---- Slots and tallies ---- */

static uint32_t *slot_entry(const struct lod_visible_tree *visible, uint32_t anchor, uint8_t band)
{
	uint32_t mask = visible->slot_table_size - 1;
	uint32_t at = (anchor * ECO_BANDS + band) * 2654435761u;
	for (at ^= at >> 15;; at++) {
		uint32_t *entry = &visible->slot_table[at & mask];
		if (!*entry)
			return entry;
		const struct lod_slot *slot = &visible->slots[*entry - 1];
		if (slot->anchor == anchor && slot->band == band)
			return entry;
	}
}

uint32_t lod_visible_tree_slot(const struct lod_visible_tree *visible, uint32_t anchor, uint8_t band)
{
	return *slot_entry(visible, anchor, band) - 1;
}

static enum eco_code grow_slot_table(struct lod_visible_tree *visible, struct eco_error *error)
{
	uint32_t size = visible->slot_table_size * 2;
	uint32_t *table = calloc(size, sizeof *table);
	if (!table)
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for %u slots", size);
	free(visible->slot_table);
	visible->slot_table = table;
	visible->slot_table_size = size;
	for (uint32_t i = 0; i < visible->slot_count; i++)
		*slot_entry(visible, visible->slots[i].anchor, visible->slots[i].band) = i + 1;
	return ECO_OK;
}

static enum eco_code find_slot(struct lod_visible_tree *visible, uint32_t plant, struct lod_anchor_band at,
	uint32_t *slot, struct eco_error *error)
{
	uint32_t *entry = slot_entry(visible, at.anchor, at.band);
	if (!*entry) {
		if (visible->slot_count * 2 >= visible->slot_table_size) {
			enum eco_code code = grow_slot_table(visible, error);
			if (code)
				return code;
			entry = slot_entry(visible, at.anchor, at.band);
		}
		if (!eco_array_grow(&visible->slots, &visible->slot_capacity, visible->slot_count,
				sizeof *visible->slots))
			return no_memory(error);
		visible->slots[visible->slot_count++] = (struct lod_slot){ .anchor = at.anchor,
			.plant = plant, .band = at.band, .whole_from = ECO_SHARE_ONE,
			.cell = at.anchor != visible->scene->plants[plant].anchor_first };
		*entry = visible->slot_count;
	}
	*slot = *entry - 1;
	return ECO_OK;
}

static enum eco_code tally(struct lod_visible_tree *visible, struct lod_node *node, uint32_t plant,
	struct lod_anchor_band at, uint8_t whole_band, double above, uint32_t *in_slot,
	struct eco_error *error)
{
	uint32_t slot;
	enum eco_code code = find_slot(visible, plant, at, &slot, error);
	if (code)
		return code;
	/* neighbours mostly share a slot; an extra tally now and then costs less than a search for its
	 * twin */
	struct lod_slot *s = &visible->slots[slot];
	*in_slot = slot;
	s->above += above;
	s->above_count += 1;
	uint32_t index = (uint32_t)(node - visible->nodes);
	if (s->last_node == index && s->last_tally < node->tally_count && node->tallies[s->last_tally].slot
			== slot && node->tallies[s->last_tally].whole_band == whole_band) {
		node->tallies[s->last_tally].count++;
		return ECO_OK;
	}
	s->last_node = index;
	s->last_tally = node->tally_count;
	if (!eco_array_grow(&node->tallies, &node->tally_capacity, node->tally_count, sizeof *node->tallies))
		return no_memory(error);
	node->tallies[node->tally_count++] = (struct lod_tally){ .slot = slot, .count = 1,
		.whole_band = whole_band };
	return ECO_OK;
}

/* Degree of the view from above onto a plant's middle (lod_seen_above). */
static double seen_above(const struct lod_visible_tree *visible, const struct lod_place *place,
	uint32_t plant)
{
	double center[3], square = 0, d[3];
	lod_place_point(place, visible->scene->anchors[visible->scene->plants[plant].anchor_first].center,
		center);
	for (int k = 0; k < 3; k++) {
		d[k] = visible->eye.at[k] - center[k];
		square += d[k] * d[k];
	}
	return lod_seen_above(d[2], sqrt(square));
}

static bool add_visibility(struct lod_visible_tree *visible, const struct lod_node *node,
	const struct lod_place *place, uint32_t plant, uint32_t slot, uint32_t hash, double above)
{
	const struct eco_plant *p = &visible->scene->plants[plant];
	struct lod_proxy_shape proxy_shape = visible->proxy_shapes[plant];
	double center[3];
	lod_place_point(place, visible->scene->anchors[p->anchor_first].center, center);
	proxy_shape.across *= place->scale * lod_place_width(place);
	proxy_shape.up *= place->scale;
	proxy_shape.area *= place->scale * place->scale * lod_place_width(place);
	proxy_shape.leaf_area *= place->scale * place->scale * lod_place_width(place);
	proxy_shape.stem *= place->scale * lod_place_width(place);
	proxy_shape.crown_across *= place->scale * lod_place_width(place);
	proxy_shape.crown_up *= place->scale;
	proxy_shape.rise *= place->scale;
	struct lod_visibility *visibility = lod_screen_add(visible->screen, center, &proxy_shape);
	if (!visibility)
		return false;
	visibility->node = (uint32_t)(node - visible->nodes);
	visibility->slot = slot;
	visibility->hash = (uint16_t)hash;
	visibility->above = (float)above;
	return true;
}

#define NOTHING_DONE 0xFF        /* gate_done before the plants themselves are counted */

static bool add_seen(struct lod_visible_tree *visible, uint32_t slot, uint32_t index, uint32_t hash)
{
	if (!eco_array_grow(&visible->seen, &visible->seen_capacity, visible->seen_count, sizeof *visible->seen))
		return false;
	visible->seen[visible->seen_count++] = (struct lod_seen){ slot, index, (uint16_t)hash };
	return true;
}

static enum eco_code tally_group(struct lod_visible_tree *visible, struct lod_node *node, uint32_t group,
	uint8_t gate, uint8_t *done, struct eco_error *error)
{
	const struct eco_scene *scene = visible->scene;
	const struct eco_group *g = &scene->groups[group];
	const struct eco_list *list = &scene->lists[g->list];
	const struct eco_plant *plant = &scene->plants[g->plant];
	bool first_time = *done == NOTHING_DONE;
	visible->places += g->count;
	uint8_t from = first_time ? 0 : *done;
	for (uint32_t i = 0; i < g->count; i++) {
		struct eco_place stored = eco_place_read(scene, g->place_first + i);
		struct lod_place place;
		uint32_t hash = lod_share_hash(visible->placements[node->placement].path, g->list,
			g->first + i);
		lod_place_instance(&place, &visible->placements[node->placement], list, &stored);
		uint32_t n = lod_instance_anchors(&visible->eye, &place, scene->anchors + plant->anchor_first,
			plant->anchor_first, plant->anchor_count, eco_gate_place(gate, 0), hash,
			visible->scratch);
		if (n == 0)
			continue;
		uint8_t whole = visible->scratch[0].band;
		double above = seen_above(visible, &place, g->plant);
		uint32_t slot;
		node->plants += first_time;
		for (uint32_t a = first_time ? 0 : 1; a < n; a++) {
			if (a > 0 && whole < from)
				break;
			enum eco_code code = tally(visible, node, g->plant, visible->scratch[a],
				a ? whole : 0, above, &slot, error);
			if (code)
				return code;
			if (a == 0 && (!add_seen(visible, slot, i, hash) || (visible->screen
					&& !add_visibility(visible, node, &place, g->plant, slot, hash,
					above))))
				return eco_fail(error, ECO_NO_MEMORY,
					"planning: no memory for another plant in view");
		}
	}
	if (first_time)
		node->seen_end[group - scene->tiles[node->tile].group_first] = visible->seen_count;
	*done = gate;
	return ECO_OK;
}

/* A group's plants in view. */
struct seen_range { uint32_t first, end; };

static struct seen_range seen_of(const struct lod_node *node, uint32_t group)
{
	return (struct seen_range){ group ? node->seen_end[group - 1] : node->seen_first,
		node->seen_end[group] };
}

/* Its anchors, into scratch, as lod_instance_anchors finds them; far plants are where they were counted. */
static uint32_t find_anchors(const struct lod_visible_tree *visible, const struct lod_node *node,
	const struct eco_group *group, const struct lod_seen *seen, uint32_t gate)
{
	const struct eco_scene *scene = visible->scene;
	const struct lod_slot *slot = &visible->slots[seen->slot];
	const struct eco_plant *plant = &scene->plants[group->plant];
	if (plant->anchor_count < 2 || eco_gate_place(slot->band, seen->hash) >= gate) {
		visible->scratch[0] = (struct lod_anchor_band){ slot->anchor, slot->band };
		return 1;
	}
	struct eco_place stored = eco_place_read(scene, group->place_first + seen->index);
	struct lod_place place;
	lod_place_instance(&place, &visible->placements[node->placement], &scene->lists[group->list], &stored);
	return lod_instance_anchors(&visible->eye, &place, scene->anchors + plant->anchor_first,
		plant->anchor_first, plant->anchor_count, gate, seen->hash, visible->scratch);
}

static void add_counts(struct lod_visible_tree *visible, const struct lod_node *node, const uint32_t *gates)
{
	for (uint32_t i = 0; i < node->tally_count; i++) {
		const struct lod_tally *t = &node->tallies[i];
		struct lod_slot *slot = &visible->slots[t->slot];
		bool near = eco_gate_place(slot->cell ? t->whole_band : slot->band, 0) < gates[slot->plant];
		slot->count += !slot->cell || near ? t->count : 0;
		slot->near += !slot->cell && near ? t->count : 0;
		slot->whole += !near && slot->whole_from == 0 ? t->count : 0;
	}
	visible->plants += node->plants;
}

/* Must its plants be counted one by one: are some left to its summary, does a gate end among them, or do some
 * of them draw their organs and others not? */
static bool is_split(const struct lod_visible_tree *visible, const struct lod_node *node,
	const uint32_t *gates)
{
	bool split = node->left > 0;
	for (uint32_t i = 0; i < node->tally_count && !split; i++) {
		const struct lod_slot *slot = &visible->slots[node->tallies[i].slot];
		uint32_t gate = gates[slot->plant];
		split = !slot->cell
			&& ((gate % ECO_SHARE_ONE && gate / ECO_SHARE_ONE == slot->band)
			|| (slot->whole_from > 0 && slot->whole_from < ECO_SHARE_ONE));
	}
	return split;
}

/* As add_counts, plant by plant. */
static void add_part(struct lod_visible_tree *visible, const struct lod_node *node, const uint32_t *gates)
{
	const struct eco_tile *tile = &visible->scene->tiles[node->tile];
	for (uint32_t g = 0; g < tile->group_count; g++) {
		const struct eco_group *group = &visible->scene->groups[tile->group_first + g];
		struct seen_range range = seen_of(node, g);
		for (uint32_t i = range.first; i < range.end; i++) {
			const struct lod_seen *seen = &visible->seen[i];
			if (lod_open_hash(seen->hash) < node->left)
				continue;
			uint32_t n = find_anchors(visible, node, group, seen, gates[group->plant]);
			for (uint32_t a = 0; a < n; a++) {
				struct lod_slot *slot = &visible->slots[a ? lod_visible_tree_slot(visible,
					visible->scratch[a].anchor, visible->scratch[a].band) : seen->slot];
				bool near = eco_gate_place(slot->band, seen->hash) < gates[group->plant];
				slot->count++;
				slot->near += a == 0 && near;
				slot->whole += a == 0 && !near && seen->hash >= slot->whole_from;
			}
			visible->plants++;
		}
	}
}

static void forget_counts(struct lod_visible_tree *visible)
{
	visible->plants = 0;
	for (uint32_t i = 0; i < visible->slot_count; i++)
		visible->slots[i].count = visible->slots[i].near = visible->slots[i].whole = 0;
}

void lod_visible_tree_recount(struct lod_visible_tree *visible, const uint32_t *gates)
{
	forget_counts(visible);
	for (uint32_t i = 0; i < visible->node_count; i++)
		if (visible->nodes[i].state == LOD_OPEN)
			(is_split(visible, &visible->nodes[i], gates) ? add_part : add_counts)(visible,
				&visible->nodes[i], gates);
}

static enum eco_code count_plants(struct lod_visible_tree *visible, struct lod_node *node,
	const uint32_t *gates, struct eco_error *error)
{
	const struct eco_scene *scene = visible->scene;
	const struct eco_tile *tile = &scene->tiles[node->tile];
	if (!node->gate_done && tile->group_count) {
		node->gate_done = malloc(tile->group_count);
		node->seen_end = malloc(tile->group_count * sizeof *node->seen_end);
		node->seen_first = visible->seen_count;
		if (!node->gate_done || !node->seen_end)
			return eco_fail(error, ECO_NO_MEMORY, "planning: no memory for a tile of %u species",
				tile->group_count);
		memset(node->gate_done, NOTHING_DONE, tile->group_count);
	}
	for (uint32_t i = 0; i < tile->group_count; i++) {
		uint8_t gate = (uint8_t)(gates[scene->groups[tile->group_first + i].plant] / ECO_SHARE_ONE);
		if (node->gate_done[i] != NOTHING_DONE && node->gate_done[i] >= gate)
			continue;
		enum eco_code code = tally_group(visible, node, tile->group_first + i, gate,
			&node->gate_done[i], error);
		if (code)
			return code;
	}
	add_counts(visible, node, gates);
	return ECO_OK;
}

/* ---- The walk ---- */

double lod_summary_points(const struct lod_node *node, double sample_distance)
{
	double extent = node->distance * sample_distance;
	if (!(extent > 0))
		return INFINITY;
	return LOD_SPLAT_FACTOR * node->area / (2.0 * extent * extent);
}

static bool summary_suffices(const struct lod_visible_tree *visible, const struct lod_node *node,
	double sample_distance)
{
	uint32_t list = visible->scene->tiles[node->tile].summary;
	return list != ECO_NONE && lod_summary_points(node, sample_distance)
		<= visible->scene->lists[list].primitive_count;
}

/* Plants of the node that would be looked at for the first time. */
static uint64_t new_places(const struct lod_visible_tree *visible, const struct lod_node *node)
{
	const struct eco_scene *scene = visible->scene;
	const struct eco_tile *tile = &scene->tiles[node->tile];
	uint64_t places = 0;
	for (uint32_t i = 0; !node->gate_done && i < tile->group_count; i++)
		places += scene->groups[tile->group_first + i].count;
	return places;
}

/* Not so the first tile with plants: around the eye summaries draw nothing. */
static bool is_beyond(const struct lod_visible_tree *visible, const struct lod_node *node)
{
	const struct eco_tile *tile = &visible->scene->tiles[node->tile];
	uint64_t nodes = visible->node_count + (node->expanded ? 0 : tile->child_count);
	const struct lod_walk_bounds *b = &visible->bounds;
	return tile->summary != ECO_NONE && ((b->nodes_few && nodes > b->nodes_few) || (b->places_few
		&& visible->places_walked && visible->places_walked + new_places(visible, node) > b->places_few));
}

/* They count towards their bound. */
static enum eco_code count_places(struct lod_visible_tree *visible, const struct lod_node *node,
	struct eco_error *error)
{
	visible->places_walked += new_places(visible, node);
	if (visible->bounds.places && visible->places_walked > visible->bounds.places)
		return eco_fail(error, ECO_TOO_LARGE, "this view at this detail looks at more than %llu "
			"plants; ask for fewer vertices", (unsigned long long)visible->bounds.places);
	return ECO_OK;
}

/* Children follow their parents in `nodes`, so one pass in order is the walk: no stack, no recursion. */
static enum eco_code open_tiles(struct lod_visible_tree *visible, double sample_distance,
	struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	visible->nodes[0].state = LOD_OPEN;
	for (uint32_t i = 0; i < visible->node_count && !code; i++) {
		struct lod_node *node = &visible->nodes[i];
		if (node->state != LOD_OPEN)
			continue;
		if (!node->seen) {
			node->state = LOD_CLOSED;
			continue;
		}
		if (summary_suffices(visible, node, sample_distance) || is_beyond(visible, node)) {
			node->state = LOD_SUMMARY;
			node->points = 1;
			continue;
		}
		code = node->expanded ? ECO_OK : expand(visible, i, error);
		if (code)
			break;
		node = &visible->nodes[i]; /* expand may have moved it */
		for (uint32_t c = 0; c < node->child_count; c++)
			visible->nodes[node->child_first + c].state = LOD_OPEN;
		code = count_places(visible, node, error);
	}
	return code;
}

/* Cells of plants in open tiles, if all plants draw theirs; and at most, if some do. */
static enum eco_code count_cells(const struct lod_visible_tree *visible, const uint32_t *gates,
	struct eco_error *error)
{
	const struct eco_scene *scene = visible->scene;
	double cells = 0, most = 0;
	uint64_t all = visible->bounds.cells, bound = all ? all : visible->cells_most;
	for (uint32_t i = 0; bound && i < visible->node_count; i++) {
		const struct eco_tile *tile = &scene->tiles[visible->nodes[i].tile];
		for (uint32_t g = 0; visible->nodes[i].state == LOD_OPEN && g < tile->group_count; g++) {
			const struct eco_group *group = &scene->groups[tile->group_first + g];
			double each = (double)group->count * (scene->plants[group->plant].anchor_count - 1);
			cells += gates[group->plant] == ECO_BANDS * ECO_SHARE_ONE ? each : 0;
			most += gates[group->plant] ? each : 0;
		}
	}
	bool few = (!all || cells <= (double)all)
		&& (!visible->cells_most || most <= (double)visible->cells_most);
	return few ? ECO_OK : eco_fail(error, ECO_TOO_LARGE, "this view at this detail looks at more than "
		"%llu cells of plants; ask for fewer vertices", (unsigned long long)bound);
}

/* Marks groups of open tiles whose places are not known. */
static enum eco_code want_places(struct lod_visible_tree *visible, struct eco_error *error)
{
	uint32_t wanted = 0;
	for (uint32_t i = 0; visible->known && i < visible->node_count; i++) {
		const struct eco_tile *tile = &visible->scene->tiles[visible->nodes[i].tile];
		uint8_t *known = visible->known + tile->group_first;
		for (uint32_t g = 0; visible->nodes[i].state == LOD_OPEN && g < tile->group_count; g++) {
			known[g] = known[g] == LOD_PLACES_KNOWN ? LOD_PLACES_KNOWN : LOD_PLACES_WANTED;
			wanted += known[g] == LOD_PLACES_WANTED;
		}
	}
	return wanted ? eco_fail(error, ECO_INTERRUPTED, "planning: the places of %u groups are missing", wanted)
		: ECO_OK;
}

enum eco_code lod_visible_tree_count(struct lod_visible_tree *visible, double sample_distance,
	const uint32_t *gates, struct eco_error *error)
{
	const uint32_t nodes = visible->node_count, placements = visible->placement_count;
	const uint64_t walked = visible->places_walked;
	struct lod_node *before = malloc(nodes * sizeof *before);
	if (!before)
		return no_memory(error);
	memcpy(before, visible->nodes, nodes * sizeof *before);
	for (uint32_t i = 0; i < nodes; i++) {
		struct lod_node *node = &visible->nodes[i];
		node->state = LOD_CLOSED;
		node->left = 0;
		node->points = 0;
	}
	enum eco_code code = open_tiles(visible, sample_distance, error);
	if (!code)
		code = count_cells(visible, gates, error);
	code = code ? code : want_places(visible, error);
	if (code) {
		memcpy(visible->nodes, before, nodes * sizeof *before);
		visible->node_count = nodes;
		visible->placement_count = placements;
		visible->places_walked = walked;
	}
	free(before);
	if (code)
		return code;
	forget_counts(visible);
	for (uint32_t i = 0; i < visible->node_count && !code; i++)
		if (visible->nodes[i].state == LOD_OPEN)
			code = count_plants(visible, &visible->nodes[i], gates, error);
	return code;
}

void lod_visible_tree_each(struct lod_visible_tree *visible, uint32_t plant, const uint32_t *gates,
	lod_visible_tree_fn fn, void *ctx)
{
	for (uint32_t n = 0; n < visible->node_count; n++) {
		const struct lod_node *node = &visible->nodes[n];
		const struct eco_tile *tile = &visible->scene->tiles[node->tile];
		for (uint32_t g = 0; node->state == LOD_OPEN && g < tile->group_count; g++) {
			const struct eco_group *group = &visible->scene->groups[tile->group_first + g];
			if (group->plant != plant)
				continue;
			struct seen_range range = seen_of(node, g);
			for (uint32_t i = range.first; i < range.end; i++) {
				const struct lod_seen *seen = &visible->seen[i];
				if (lod_open_hash(seen->hash) >= node->left)
					fn(ctx, visible->scratch, find_anchors(visible, node, group, seen,
						gates[plant]), plant, seen->hash);
			}
		}
	}
}

enum eco_code lod_visible_tree_init(struct lod_visible_tree *visible, const struct eco_scene *scene,
	const struct eco_view *view, uint64_t nodes_max, uint64_t placements_max, struct eco_error *error)
{
	*visible = (struct lod_visible_tree){ .scene = scene, .nodes_max = nodes_max,
		.placements_max = placements_max };
	lod_eye_make(&visible->eye, view);
	uint32_t most = 1;
	for (uint32_t i = 0; i < scene->plant_count; i++)
		most = scene->plants[i].anchor_count > most ? scene->plants[i].anchor_count : most;
	visible->slot_table_size = 1024;
	visible->slot_table = calloc(visible->slot_table_size, sizeof *visible->slot_table);
	visible->scratch = malloc(most * sizeof *visible->scratch);
	visible->placements = malloc(sizeof *visible->placements);
	if (!visible->slot_table || !visible->scratch || !visible->placements) {
		lod_visible_tree_free(visible);
		return eco_fail(error, ECO_NO_MEMORY, "planning: no memory");
	}
	visible->placements[0] = (struct eco_placement){ .scale = 1 };
	visible->placement_count = visible->placement_capacity = 1;
	enum eco_code code = add_node(visible, scene->root, 0, error);
	if (code)
		lod_visible_tree_free(visible);
	return code;
}

static void free_nodes(struct lod_visible_tree *visible)
{
	for (uint32_t i = 0; i < visible->node_count; i++) {
		free(visible->nodes[i].tallies);
		free(visible->nodes[i].gate_done);
		free(visible->nodes[i].seen_end);
	}
	visible->node_count = 0;
}

enum eco_code lod_visible_tree_restart(struct lod_visible_tree *visible, struct eco_error *error)
{
	free_nodes(visible);
	visible->placement_count = 1;
	visible->slot_count = visible->seen_count = 0;
	visible->plants = visible->places_walked = 0;
	memset(visible->slot_table, 0, visible->slot_table_size * sizeof *visible->slot_table);
	return add_node(visible, visible->scene->root, 0, error);
}

void lod_visible_tree_free(struct lod_visible_tree *visible)
{
	free_nodes(visible);
	free(visible->nodes);
	free(visible->placements);
	free(visible->slots);
	free(visible->seen);
	free(visible->slot_table);
	free(visible->scratch);
	*visible = (struct lod_visible_tree){ 0 };
}
