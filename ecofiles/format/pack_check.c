/* The one place that distrusts a scene's tables: everything after it (planner, wire, client) may index
 * without checks. Work is linear in the tables. Ranges that could overlap are bounded by their sum:
 * otherwise a small file whose ranges all cover one large table would cost the product. Longer than 600
 * lines: one table's checks rely on another's. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/chunk/chunk_payload.h"
#include "ecofiles/format/ground_image.h"
#include "ecofiles/format/ground_tile.h"
#include "ecofiles/format/impostor.h"
#include "ecofiles/format/inventory.h"
#include "ecofiles/format/pack.h"
#include "ecofiles/format/texture.h"

#define METRES_MAX 1e12
#define STEP_MAX 1e9
#define RADIUS_MAX 1e9f
#define AREA_MAX 1e30
#define CURVE_SAMPLES_MAX 1024u
#define SCALE_MAX 1e9f

#define BAD(...) eco_fail(error, ECO_DAMAGED, __VA_ARGS__)

static bool within(double v, double low, double high)
{
	return v >= low && v <= high;        /* false for NaN */
}

static bool range_fits(uint64_t first, uint64_t count, uint64_t total)
{
	return first <= total && count <= total - first;
}

static bool name_ends(const char name[64])
{
	return memchr(name, 0, 64);
}

/* ---- Single records ---- */

enum eco_code eco_anchor_check(const struct eco_anchor *anchor, struct eco_error *error)
{
	for (int i = 0; i < 3; i++)
		if (!within(anchor->center[i], -RADIUS_MAX, RADIUS_MAX))
			return BAD("anchor: its centre is not finite or is beyond %g m", (double)RADIUS_MAX);
	if (!within(anchor->radius, 0, RADIUS_MAX))
		return BAD("anchor: radius %g m is impossible", (double)anchor->radius);
	return ECO_OK;
}

enum eco_code eco_list_check(const struct eco_list *list, struct eco_error *error)
{
	enum eco_code code = eco_list_check_coding(list, error);
	if (code)
		return code;
	if (!eco_list_level_known(list))
		return BAD("list: level %u of kind %u", list->level, list->kind);
	for (int i = 0; i < 3; i++)
		if (!within(list->grid_origin[i], -METRES_MAX, METRES_MAX)
				|| !within(list->grid_step[i], 1e-12, STEP_MAX))
			return BAD("list: grid of axis %d, origin %g and step %g m, is impossible", i,
				list->grid_origin[i], list->grid_step[i]);
	if (!within(list->unit_area, 0, AREA_MAX))
		return BAD("list: unit area %g is impossible", (double)list->unit_area);
	if ((list->attributes & ECO_ATTR_COLOR) && list->palette_count == 0)
		return BAD("list: has colours but no palette");
	if ((list->kind == ECO_LIST_GROUND) != (list->columns != 0))
		return BAD("list: %u columns in kind %u", list->columns, list->kind);
	if (list->columns != 0 && list->primitive_count % list->columns != 0)
		return BAD("list: %u ground samples are not rows of %u", list->primitive_count,
			list->columns);
	if ((list->coder == ECO_CODER_FORM) != (list->partner != ECO_NONE))
		return BAD("list: coder %u with partner %#x", list->coder, list->partner);
	if ((list->kind == ECO_LIST_INSTANCES) != (list->group_count > 0)
			|| list->group_count > list->primitive_count)
		return BAD("list: %u groups of %u primitives in kind %u", list->group_count,
			list->primitive_count, list->kind);
	if ((list->kind == ECO_LIST_GROUND || list->kind == ECO_LIST_GROUND_IMAGE
			|| list->kind == ECO_LIST_INVENTORY) != (list->owner == ECO_NONE) &&
		list->kind != ECO_LIST_IMAGE && list->kind != ECO_LIST_OUTLINE)
		return BAD("list: owner %#x in kind %u", list->owner, list->kind);
	if (list->element_count > list->primitive_count || list->chunk_count > list->element_count
	    || (list->chunk_count == 0) != (list->primitive_count == 0))
		return BAD("list: %u primitives of %u elements in %u chunks are impossible",
			list->primitive_count, list->element_count, list->chunk_count);
	if (list->kind == ECO_LIST_IMPOSTOR && (list->primitive_count > ECO_IMPOSTOR_LEVELS
			|| list->primitive_count != list->chunk_count))
		return BAD("list: %u levels of an impostor in %u chunks; at most %u, a chunk each",
			list->primitive_count, list->chunk_count, ECO_IMPOSTOR_LEVELS);
	if (eco_list_has_texels(list) && (list->primitive_count != list->chunk_count
			|| list->chunk_count > ECO_TEXTURE_LEVELS_MAX))
		return BAD("list: %u levels of a texture in %u chunks; at most %u, a chunk each",
			list->primitive_count, list->chunk_count, ECO_TEXTURE_LEVELS_MAX);
	if (list->coder == ECO_CODER_FORM && list->primitive_count != list->element_count
	    && (list->kind != ECO_LIST_TRIANGLES || list->primitive_count != 2ull * list->element_count))
		return BAD("list: %u forms cannot have %u primitives: all are points, lines, triangles or "
			"quads", list->element_count, list->primitive_count);
	return ECO_OK;
}

enum eco_code eco_chunk_check(const struct eco_list *list, const struct eco_chunk *chunk,
	struct eco_error *error)
{
	uint64_t most = (uint64_t)chunk->element_count * (list->kind == ECO_LIST_TRIANGLES
		&& list->coder != ECO_CODER_MESH ? 4 : 1);
	bool form = list->coder == ECO_CODER_FORM;
	if (chunk->element_count < 1 || chunk->element_count > ECO_CHUNK_ELEMENTS_MAX)
		return BAD("chunk: %u elements are not in 1..%u", chunk->element_count,
			ECO_CHUNK_ELEMENTS_MAX);
	if (chunk->primitive_count < chunk->element_count || chunk->primitive_count > most)
		return BAD("chunk: %u elements cannot have %u primitives", chunk->element_count,
			chunk->primitive_count);
	if (form && (uint64_t)chunk->primitive_count * list->element_count
			!= (uint64_t)list->primitive_count * chunk->element_count)
		return BAD("chunk: %u forms of %u primitives in a list of %u of %u", chunk->element_count,
			chunk->primitive_count, list->element_count, list->primitive_count);
	if (chunk->size_bytes < 1 || chunk->size_bytes > ECO_CHUNK_BYTES_MAX)
		return BAD("chunk: %u bytes are not in 1..%u", chunk->size_bytes, ECO_CHUNK_BYTES_MAX);
	if (list->coder == ECO_CODER_BYTES && chunk->element_count != 1)
		return BAD("chunk: a file is one element, not %u", chunk->element_count);
	return ECO_OK;
}

/* ---- Tables against each other ---- */

static enum eco_code check_list_references(const struct eco_scene *s, uint32_t id, struct eco_error *error)
{
	const struct eco_list *list = &s->lists[id];
	bool of_tile = list->kind == ECO_LIST_INSTANCES || (list->attributes & ECO_ATTR_PLANT);
	if (list->owner != ECO_NONE && list->owner >= (of_tile ? s->tile_count : s->plant_count))
		return BAD("list %u: owner %u is not there", id, list->owner);
	if (!range_fits(list->palette_first, list->palette_count, s->palette_count))
		return BAD("list %u: palette [%u, +%u) of %u colours", id, list->palette_first,
			list->palette_count, s->palette_count);
	if (list->image != ECO_NONE
			&& (list->image >= s->list_count || s->lists[list->image].kind
			!= (list->kind == ECO_LIST_IMAGE ? ECO_LIST_OUTLINE : ECO_LIST_IMAGE)))
		return BAD("list %u: image %u is not an image list, or not an outline of this one", id,
			list->image);
	if (list->partner != ECO_NONE) {
		const struct eco_list *partner = list->partner < s->list_count ? &s->lists[list->partner]
			: NULL;
		if (!partner || partner->kind != ECO_LIST_TRIANGLES || partner->coder != ECO_CODER_ELEMENTS)
			return BAD("list %u: partner %u is not a list of fans", id, list->partner);
		if (partner->chunk_count != list->chunk_count || partner->owner != list->owner)
			return BAD("list %u: %u chunks of owner %u, its partner %u has %u of owner %u", id,
				list->chunk_count, list->owner, list->partner, partner->chunk_count,
				partner->owner);
	}
	return ECO_OK;
}

static enum eco_code check_list_chunks(const struct eco_scene *s, uint32_t id, uint64_t *chunks_left,
	struct eco_error *error)
{
	const struct eco_list *list = &s->lists[id];
	uint64_t primitives = 0, elements = 0;
	if (!range_fits(list->chunk_first, list->chunk_count, s->chunk_count)
			|| list->chunk_count > *chunks_left)
		return BAD("list %u: chunks [%u, +%u) of %u, or shared with another list", id,
			list->chunk_first, list->chunk_count, s->chunk_count);
	*chunks_left -= list->chunk_count;
	for (uint32_t i = 0; i < list->chunk_count; i++) {
		const struct eco_chunk *chunk = &s->chunks[list->chunk_first + i];
		if (eco_chunk_check(list, chunk, error) != ECO_OK)
			return ECO_DAMAGED;
		primitives += chunk->primitive_count;
		elements += chunk->element_count;
	}
	if (primitives != list->primitive_count || elements != list->element_count)
		return BAD("list %u: its chunks hold %llu primitives of %llu elements instead of %u of %u",
			id, (unsigned long long)primitives, (unsigned long long)elements,
			list->primitive_count, list->element_count);
	return ECO_OK;
}

/* A form has one element for each of the partner's, chunk by chunk, with no more vertices. The chunk
 * ranges of both have been checked. */
static enum eco_code check_forms(const struct eco_scene *s, uint32_t id, struct eco_error *error)
{
	const struct eco_list *list = &s->lists[id], *partner = &s->lists[list->partner];
	for (uint32_t i = 0; i < list->chunk_count; i++) {
		const struct eco_chunk *own = &s->chunks[list->chunk_first + i],
			*of = &s->chunks[partner->chunk_first + i];
		if (own->element_count != of->element_count)
			return BAD("list %u: chunk %u has %u forms for the %u elements of list %u", id, i,
				own->element_count, of->element_count, list->partner);
		if ((uint64_t)eco_list_vertices(list) * own->primitive_count > 3ull * of->primitive_count)
			return BAD("list %u: chunk %u has %u primitives where list %u has %u triangles: a "
				"form may not be dearer", id, i, own->primitive_count, list->partner,
				of->primitive_count);
	}
	return ECO_OK;
}

static enum eco_code check_lists(const struct eco_scene *s, struct eco_error *error)
{
	uint64_t chunks_left = s->chunk_count;
	for (uint32_t i = 0; i < s->list_count; i++) {
		if (eco_list_check(&s->lists[i], error) != ECO_OK || check_list_references(s, i, error)
				!= ECO_OK
		    || check_list_chunks(s, i, &chunks_left, error) != ECO_OK)
			return ECO_DAMAGED;
	}
	for (uint32_t i = 0; i < s->list_count; i++)
		if (s->lists[i].partner != ECO_NONE && check_forms(s, i, error) != ECO_OK)
			return ECO_DAMAGED;
	return ECO_OK;
}

static enum eco_code check_curve(const struct eco_scene *s, uint32_t ladder_id, struct eco_error *error)
{
	const struct eco_ladder *ladder = &s->ladders[ladder_id];
	float last = 0;
	if (ladder->curve_count > CURVE_SAMPLES_MAX
			|| !range_fits(ladder->curve_first, eco_ladder_samples(ladder), s->curve_count))
		return BAD("ladder %u: curve [%u, +%u) of %u samples; at most %u", ladder_id,
			ladder->curve_first, ladder->curve_count, s->curve_count, CURVE_SAMPLES_MAX);
	for (uint32_t i = 0; i < eco_ladder_samples(ladder); i++) {
		const struct eco_curve *c = &s->curves[ladder->curve_first + i],
			*around = i < ladder->curve_count ? NULL : c - ladder->curve_count;
		if (around ? c->share != around->share || c->reach != around->reach
				: !(c->share > last && c->share <= 1))
			return BAD("ladder %u: share %g of curve sample %u does not ascend in (0, 1]",
				ladder_id, (double)c->share, i);
		if (!within(c->scale, 0, SCALE_MAX) || !within(c->reach, 0, 1) || !within(c->fp, 0, SCALE_MAX)
				|| !within(c->fn, 0, SCALE_MAX))
			return BAD("ladder %u: curve sample %u is not finite or negative", ladder_id, i);
		if (c->reach < 1 && eco_ladder_has_splats(s, ladder))
			return BAD("ladder %u: reach %g of curve sample %u of splats is not 1", ladder_id,
				(double)c->reach, i);
		last = c->share;
	}
	return ECO_OK;
}

/* A list named by a ladder must exist, be of that kind, and be the plant's. */
static bool ladder_list_fits(const struct eco_scene *s, uint32_t list, uint8_t kind, uint32_t plant)
{
	if (list == ECO_NONE)
		return true;
	return list < s->list_count && s->lists[list].kind == kind && s->lists[list].owner == plant
		&& !(s->lists[list].attributes & ECO_ATTR_PLANT);
}

/* An impostor is one vertex of a ladder with splats, in place of the first one. */
static bool ladder_impostor_fits(const struct eco_scene *s, const struct eco_ladder *l)
{
	return l->impostor == ECO_NONE || (ladder_list_fits(s, l->impostor, ECO_LIST_IMPOSTOR, l->plant)
		&& s->lists[l->impostor].primitive_count && (l->flags & ECO_LADDER_WHOLE)
		&& eco_ladder_has_splats(s, l)
		&& l->curve_count >= s->lists[l->impostor].primitive_count);
}

/* A list with a partner must be a form of the ladder's triangles. */
static bool ladder_form_fits(const struct eco_scene *s, uint32_t list, uint32_t triangles)
{
	return list == ECO_NONE || s->lists[list].partner == ECO_NONE || s->lists[list].partner == triangles;
}

/* Each level has a whole multiple of the splats of the one before it; together they are the list. */
static enum eco_code check_splat_levels(const struct eco_scene *s, uint32_t id, struct eco_error *error)
{
	const struct eco_ladder *l = &s->ladders[id];
	uint32_t before = 0, first = 0;
	if (l->lines != ECO_NONE || l->simple != ECO_NONE || l->triangles != ECO_NONE)
		return BAD("ladder %u: lists %#x, %#x and %#x beside the splats of list %u", id, l->lines,
			l->simple, l->triangles, l->points);
	for (uint32_t i = 0; i < l->level_count; i++) {
		uint32_t size = l->level_end[i] - first;
		if (before && (size % before != 0 || size == before))
			return BAD("ladder %u: level %u has %u splats for the %u of the level before", id, i,
				size, before);
		before = size;
		first = l->level_end[i];
	}
	if (l->level_count == 0 || first != s->lists[l->points].primitive_count)
		return BAD("ladder %u: its %u levels end at %u of %u splats", id, l->level_count, first,
			s->lists[l->points].primitive_count);
	return ECO_OK;
}

static enum eco_code check_ladder_levels(const struct eco_scene *s, uint32_t id, struct eco_error *error)
{
	const struct eco_ladder *l = &s->ladders[id];
	bool splats = eco_ladder_has_splats(s, l);
	uint32_t last = 0, list = splats ? l->points : l->triangles;
	if (l->level_count > ECO_LEVELS_MAX || (l->level_count > 0 && list == ECO_NONE))
		return BAD("ladder %u: %u levels of list %#x", id, l->level_count, list);
	for (uint32_t i = 0; i < ECO_LEVELS_MAX; i++) {
		if (i >= l->level_count && l->level_end[i] != 0)
			return BAD("ladder %u: level %u is not one of its %u but ends at %u", id, i,
				l->level_count, l->level_end[i]);
		if (i < l->level_count
				&& (l->level_end[i] <= last
				|| l->level_end[i] > s->lists[list].primitive_count))
			return BAD("ladder %u: level %u ends at %u of %u %s, the level before at %u", id, i,
				l->level_end[i], s->lists[list].primitive_count,
				splats ? "splats" : "triangles", last);
		last = l->level_end[i];
	}
	return splats ? check_splat_levels(s, id, error) : ECO_OK;
}

/* A ladder that shows the whole plant is at the plant's first anchor, near and far alike. */
static enum eco_code check_ladder_flags(const struct eco_scene *s, uint32_t id, struct eco_error *error)
{
	const struct eco_ladder *l = &s->ladders[id];
	uint32_t place = l->flags & (ECO_LADDER_FAR | ECO_LADDER_NEAR | ECO_LADDER_WHOLE);
	if (l->organ >= ECO_ORGAN_COUNT || l->flags >= 2 * ECO_LADDER_WHOLE || l->reserved != 0
			|| (place & (place - 1)))
		return BAD("ladder %u: organ %u, flags %#x, reserved %u", id, l->organ, l->flags,
			l->reserved);
	if ((l->flags & ECO_LADDER_WHOLE) && l->anchor != s->plants[l->plant].anchor_first)
		return BAD("ladder %u: shows the whole plant %u at anchor %u, which is a cell", id, l->plant,
			l->anchor);
	return ECO_OK;
}

static enum eco_code check_ladder(const struct eco_scene *s, uint32_t id, struct eco_error *error)
{
	const struct eco_ladder *l = &s->ladders[id];
	const struct eco_plant *plant;
	if (l->plant >= s->plant_count)
		return BAD("ladder %u: plant %u is not there", id, l->plant);
	plant = &s->plants[l->plant];
	if (l->anchor < plant->anchor_first || l->anchor - plant->anchor_first >= plant->anchor_count)
		return BAD("ladder %u: anchor %u is not one of plant %u", id, l->anchor, l->plant);
	if (check_ladder_flags(s, id, error) != ECO_OK)
		return ECO_DAMAGED;
	if (!ladder_list_fits(s, l->points, ECO_LIST_POINTS, l->plant)
			|| !ladder_list_fits(s, l->lines, ECO_LIST_LINES, l->plant)
	    || !ladder_list_fits(s, l->simple, ECO_LIST_TRIANGLES, l->plant)
	|| !ladder_list_fits(s, l->triangles, ECO_LIST_TRIANGLES, l->plant))
		return BAD("ladder %u: lists %#x, %#x, %#x, %#x are not points, lines, triangles, triangles "
			"of plant %u", id, l->points, l->lines, l->simple, l->triangles, l->plant);
	if (l->points == ECO_NONE && l->lines == ECO_NONE && l->triangles == ECO_NONE)
		return BAD("ladder %u: has no list", id);
	if (!ladder_form_fits(s, l->points, l->triangles) || !ladder_form_fits(s, l->lines, l->triangles)
	    || !ladder_form_fits(s, l->simple, l->triangles))
		return BAD("ladder %u: of lists %#x, %#x and %#x not all are forms of list %#x", id,
			l->points, l->lines, l->simple, l->triangles);
	if (l->simple != ECO_NONE && s->lists[l->simple].coder != ECO_CODER_FORM)
		return BAD("ladder %u: list %u of simple forms has coder %u", id, l->simple,
			s->lists[l->simple].coder);
	if (!ladder_impostor_fits(s, l))
		return BAD("ladder %u: list %#x is no impostor of plant %u, beside splats and with its "
			"samples", id, l->impostor, l->plant);
	if (l->before > l->total)
		return BAD("ladder %u: %u of %u before it", id, l->before, l->total);
	if (!within(l->importance, 0, SCALE_MAX) || !within(l->area, 0, AREA_MAX)
		|| !within(l->length, 0, AREA_MAX) || !within(l->epsilon, 0, RADIUS_MAX))
		return BAD("ladder %u: importance, area, length or epsilon is not finite or negative", id);
	if (check_ladder_levels(s, id, error) != ECO_OK)
		return ECO_DAMAGED;
	return check_curve(s, id, error);
}

static enum eco_code check_plants(const struct eco_scene *s, struct eco_error *error)
{
	uint64_t ladders = 0, anchors = 0;
	for (uint32_t i = 0; i < s->plant_count; i++) {
		const struct eco_plant *p = &s->plants[i];
		if (!name_ends(p->name))
			return BAD("plant %u: its name has no end", i);
		if (!within(p->height_m, 0, RADIUS_MAX) || !within(p->area, 0, AREA_MAX))
			return BAD("plant %u (%s): height %g m or area %g m^2 is impossible", i, p->name,
				(double)p->height_m, (double)p->area);
		if (p->anchor_count < 1 || !range_fits(p->anchor_first, p->anchor_count, s->anchor_count))
			return BAD("plant %u (%s): anchors [%u, +%u) of %u", i, p->name, p->anchor_first,
				p->anchor_count, s->anchor_count);
		if (!range_fits(p->ladder_first, p->ladder_count, s->ladder_count))
			return BAD("plant %u (%s): ladders [%u, +%u) of %u", i, p->name, p->ladder_first,
				p->ladder_count, s->ladder_count);
		ladders += p->ladder_count;
		anchors += p->anchor_count;
	}
	if (ladders != s->ladder_count || anchors > s->anchor_count)
		return BAD("plants: %llu of %u ladders and %llu of %u anchors belong to one",
			(unsigned long long)ladders, s->ladder_count, (unsigned long long)anchors,
			s->anchor_count);
	for (uint32_t i = 0; i < s->anchor_count; i++)
		if (eco_anchor_check(&s->anchors[i], error) != ECO_OK)
			return ECO_DAMAGED;
	for (uint32_t i = 0; i < s->plant_count; i++)
		for (uint32_t k = 0; k < s->plants[i].ladder_count; k++)
			if (s->ladders[s->plants[i].ladder_first + k].plant != i)
				return BAD("plant %u: ladder %u belongs to plant %u", i,
					s->plants[i].ladder_first + k,
					s->ladders[s->plants[i].ladder_first + k].plant);
	for (uint32_t i = 0; i < s->ladder_count; i++)
		if (check_ladder(s, i, error) != ECO_OK)
			return ECO_DAMAGED;
	return ECO_OK;
}

/* `before`: of the same list; NULL: this is its first. */
static enum eco_code check_group(const struct eco_scene *s, uint32_t id, const struct eco_group *before,
	struct eco_error *error)
{
	const struct eco_group *g = &s->groups[id];
	uint32_t first = before ? before->first + before->count : 0, most = s->lists[g->list].primitive_count;
	if (g->plant >= s->plant_count)
		return BAD("group %u: plant %u is not there", id, g->plant);
	if (g->first != first || g->count < 1 || g->count > most - first)
		return BAD("group %u: plants [%u, +%u) of list %u, which has %u and goes on at %u", id,
			g->first, g->count, g->list, most, first);
	if (!range_fits(g->place_first, g->count, s->place_count)
			|| (before && g->place_first != before->place_first + before->count))
		return BAD("group %u: places [%llu, +%u) of %llu, or not behind those of the group before",
			id, (unsigned long long)g->place_first, g->count,
			(unsigned long long)s->place_count);
	return ECO_OK;
}

/* The groups of one list, from `first` on. */
static enum eco_code check_groups(const struct eco_scene *s, uint32_t tile, uint32_t first,
	struct eco_error *error)
{
	const struct eco_tile *t = &s->tiles[tile];
	uint32_t id = s->groups[first].list, left = t->group_first + t->group_count - first;
	if (id >= s->list_count || s->lists[id].kind != ECO_LIST_INSTANCES || s->lists[id].owner != tile)
		return BAD("group %u: list %u does not hold plants of tile %u", first, id, tile);
	const struct eco_list *list = &s->lists[id];
	const struct eco_group *before = NULL;
	if (list->group_count > left)
		return BAD("group %u: list %u has %u groups, tile %u has %u from here on", first, id,
			list->group_count, tile, left);
	for (uint32_t i = first; i < first + list->group_count; before = &s->groups[i++]) {
		if (s->groups[i].tile != tile || s->groups[i].list != id)
			return BAD("group %u: of tile %u and list %u, among those of %u and %u", i,
				s->groups[i].tile, s->groups[i].list, tile, id);
		if (check_group(s, i, before, error) != ECO_OK)
			return ECO_DAMAGED;
	}
	if (before->first + before->count != list->primitive_count)
		return BAD("list %u: its groups hold %u of %u plants", id, before->first + before->count,
			list->primitive_count);
	return ECO_OK;
}

static enum eco_code check_child(const struct eco_scene *s, uint32_t id, uint32_t tile,
	struct eco_error *error)
{
	const struct eco_child *c = &s->children[id];
	if (c->tile >= s->tile_count || c->tile <= tile)
		return BAD("child %u: tile %u is not after its parent %u of %u tiles", id, c->tile, tile,
			s->tile_count);
	for (int i = 0; i < 3; i++)
		if (!within(c->at[i], -METRES_MAX, METRES_MAX))
			return BAD("child %u: position %g is impossible", id, c->at[i]);
	if (!within(c->scale, (double)1e-6f, 1e6))
		return BAD("child %u: scale %g is not in 1e-6..1e6", id, (double)c->scale);
	return ECO_OK;
}

/* The tile and its own lists; children have greater ids, so their instances are counted already. */
static enum eco_code check_tile(const struct eco_scene *s, uint32_t id, struct eco_error *error)
{
	const struct eco_tile *t = &s->tiles[id];
	uint64_t instances = 0;
	for (int i = 0; i < 3; i++)
		if (!within(t->low[i], -METRES_MAX, METRES_MAX)
				|| !within(t->high[i], -METRES_MAX, METRES_MAX) || t->low[i] > t->high[i])
			return BAD("tile %u: bounds of axis %d, %g to %g, are impossible", id, i, t->low[i],
				t->high[i]);
	if (!within(t->area, 0, AREA_MAX))
		return BAD("tile %u: area %g is impossible", id, t->area);
	if (t->summary != ECO_NONE
			&& (t->summary >= s->list_count || s->lists[t->summary].kind != ECO_LIST_POINTS
	    || !(s->lists[t->summary].attributes & ECO_ATTR_PLANT) || s->lists[t->summary].owner != id))
		return BAD("tile %u: list %u is not its summary", id, t->summary);
	for (uint32_t i = t->group_first; i < t->group_first + t->group_count;) {
		if (check_groups(s, id, i, error) != ECO_OK)
			return ECO_DAMAGED;
		const struct eco_list *list = &s->lists[s->groups[i].list];
		instances += list->primitive_count;
		i += list->group_count;
	}
	for (uint32_t i = 0; i < t->child_count; i++) {
		if (check_child(s, t->child_first + i, id, error) != ECO_OK)
			return ECO_DAMAGED;
		if (__builtin_add_overflow(instances,
				s->tiles[s->children[t->child_first + i].tile].instance_count, &instances))
			return BAD("tile %u: more than 2^64 instances", id);
	}
	if (instances != t->instance_count)
		return BAD("tile %u: says %llu instances, its groups and children hold %llu", id,
			(unsigned long long)t->instance_count, (unsigned long long)instances);
	return ECO_OK;
}

/* Tiles and plants that a view must open below a tile that is open. Sums stop at UINT32_MAX. */
struct opening { uint32_t tiles, plants; };

static uint32_t add_saturated(uint32_t a, uint64_t b)
{
	return b > UINT32_MAX - a ? UINT32_MAX : a + (uint32_t)b;
}

static struct opening opening_of(const struct eco_scene *s, const struct eco_tile *t,
	const struct opening *openings)
{
	struct opening sum = { 0, 0 };
	for (uint32_t i = 0; i < t->group_count; i++)
		sum.plants = add_saturated(sum.plants, s->groups[t->group_first + i].count);
	for (uint32_t i = 0; i < t->child_count; i++) {
		uint32_t child = s->children[t->child_first + i].tile;
		bool closes = s->tiles[child].summary != ECO_NONE;
		sum.tiles = add_saturated(sum.tiles, 1ull + (closes ? 0 : openings[child].tiles));
		sum.plants = add_saturated(sum.plants, closes ? 0 : openings[child].plants);
	}
	return sum;
}

/* Tiles and children have been checked: a child's number is greater than its parent's. */
static enum eco_code check_openings(const struct eco_scene *s, struct eco_error *error)
{
	struct opening *openings = malloc((s->tile_count + 1u) * sizeof *openings);
	enum eco_code code = openings ? ECO_OK
		: eco_fail(error, ECO_NO_MEMORY, "scene: no memory for %u tiles", s->tile_count);
	for (uint32_t i = s->tile_count; i-- > 0 && !code;) {
		openings[i] = opening_of(s, &s->tiles[i], openings);
		if (openings[i].tiles > ECO_OPEN_TILES_MAX || openings[i].plants > ECO_OPEN_PLANTS_MAX)
			code = BAD("tile %u: no summary stands for the tiles and plants below it, which are "
				"more than %u or %u, so that no view can be planned; make the pack again", i,
				ECO_OPEN_TILES_MAX, ECO_OPEN_PLANTS_MAX);
	}
	free(openings);
	return code;
}

static enum eco_code check_tiles(const struct eco_scene *s, struct eco_error *error)
{
	uint64_t groups = 0, children = 0;
	for (uint32_t i = 0; i < s->tile_count; i++) {
		const struct eco_tile *t = &s->tiles[i];
		if (!range_fits(t->group_first, t->group_count, s->group_count)
				|| !range_fits(t->child_first, t->child_count, s->child_count))
			return BAD("tile %u: groups [%u, +%u) of %u, children [%u, +%u) of %u", i,
				t->group_first, t->group_count, s->group_count, t->child_first,
				t->child_count, s->child_count);
		groups += t->group_count;
		children += t->child_count;
	}
	if (groups != s->group_count || children != s->child_count)
		return BAD("tiles: list %llu groups and %llu children, there are %u and %u",
			(unsigned long long)groups, (unsigned long long)children, s->group_count,
			s->child_count);
	for (uint32_t i = s->tile_count; i-- > 0;)
		if (check_tile(s, i, error) != ECO_OK)
			return ECO_DAMAGED;
	return check_openings(s, error);
}

/* ---- Ground ---- */

static enum eco_code check_ground_tile(const struct eco_scene *s, uint32_t id, struct eco_error *error)
{
	const struct eco_ground_tile *t = &s->ground[id];
	const struct eco_list *list, *first;
	struct eco_ground_span x, y;
	if (t->list >= s->list_count || s->lists[t->list].kind != ECO_LIST_GROUND
			|| s->lists[t->list].chunk_count != 1)
		return BAD("ground tile %u: list %u is not ground of one chunk", id, t->list);
	if (!eco_ground_on_grid(t, s->ground_columns, s->ground_rows))
		return BAD("ground tile %u: tile %u, %u of level %u is not one of %u x %u samples", id,
			t->column, t->row, t->level, s->ground_columns, s->ground_rows);
	list = &s->lists[t->list];
	first = &s->lists[s->ground[0].list];
	eco_ground_spans(&x, &y, t, s->ground_columns, s->ground_rows);
	if (list->level != t->level || list->columns != x.count || list->primitive_count != x.count * y.count)
		return BAD("ground tile %u: list %u has %u samples in rows of %u, it should have %u x %u at "
			"level %u", id, t->list, list->primitive_count, list->columns, x.count, y.count,
			t->level);
	if (memcmp(list->grid_origin, first->grid_origin, sizeof list->grid_origin) != 0
	    || memcmp(list->grid_step, first->grid_step, sizeof list->grid_step) != 0)
		return BAD("ground tile %u: the grid of list %u is not that of the others", id, t->list);
	if (!within(t->error_m, 0, METRES_MAX) || !within(t->low_m, -METRES_MAX, METRES_MAX)
		|| !within(t->high_m, -METRES_MAX, METRES_MAX) || t->low_m > t->high_m)
		return BAD("ground tile %u: error %g m, heights %g to %g m", id, (double)t->error_m,
			(double)t->low_m, (double)t->high_m);
	return ECO_OK;
}

/* Children come in the order south-west, south-east, north-west, north-east, as far as the grid goes. */
static enum eco_code check_ground_children(const struct eco_scene *s, uint32_t id, struct eco_error *error)
{
	const struct eco_ground_tile *t = &s->ground[id];
	uint32_t found = 0;
	for (uint32_t quarter = 0; quarter < 4 && t->level > 0; quarter++) {
		const struct eco_ground_tile *c = &s->ground[t->child_first + found];
		struct eco_ground_tile there = { .level = (uint8_t)(t->level - 1),
			.column = 2 * t->column + quarter % 2, .row = 2 * t->row + quarter / 2 };

		if (!eco_ground_on_grid(&there, s->ground_columns, s->ground_rows))
			continue;
		if (found == t->child_count || c->level != there.level || c->column != there.column
				|| c->row != there.row)
			return BAD("ground tile %u: its children do not cover it", id);
		if (c->error_m > t->error_m || c->low_m < t->low_m || c->high_m > t->high_m)
			return BAD("ground tile %u: its child %u has a larger error, or heights beyond its "
				"own", id, t->child_first + found);
		found++;
	}
	return found == t->child_count ? ECO_OK : BAD("ground tile %u: %u children at level %u", id,
		t->child_count, t->level);
}

static enum eco_code check_ground(const struct eco_scene *s, struct eco_error *error)
{
	uint32_t next = 1, lists = 0;
	if ((s->ground_count == 0) != (s->ground_columns == 0)
			|| (s->ground_count == 0) != (s->ground_rows == 0))
		return BAD("scene: %u ground tiles of %u x %u samples", s->ground_count, s->ground_columns,
			s->ground_rows);
	if (!eco_ground_size_fits(s->ground_columns, s->ground_rows, s->ground_margin))
		return BAD("scene: ground of %u x %u samples with margins of %u", s->ground_columns,
			s->ground_rows, s->ground_margin);
	for (uint32_t i = 0; i < s->list_count; i++)
		lists += s->lists[i].kind == ECO_LIST_GROUND;
	if (lists != s->ground_count)
		return BAD("scene: %u ground tiles of %u lists", s->ground_count, lists);
	for (uint32_t i = 0; i < s->ground_count; i++)
		if (check_ground_tile(s, i, error) != ECO_OK)
			return ECO_DAMAGED;
	if (s->ground_count > 0 && s->ground[0].level != eco_ground_root_level(s->ground_columns,
			s->ground_rows))
		return BAD("ground tile 0: level %u does not cover %u x %u samples", s->ground[0].level,
			s->ground_columns, s->ground_rows);
	for (uint32_t i = 0; i < s->ground_count; i++) {
		const struct eco_ground_tile *t = &s->ground[i];
		if (t->child_first != (t->child_count > 0 ? next : 0) || t->child_count > s->ground_count
				- next)
			return BAD("ground tile %u: children [%u, +%u) of %u tiles", i, t->child_first,
				t->child_count, s->ground_count);
		next += t->child_count;
		if (t->child_count > 0 && check_ground_children(s, i, error) != ECO_OK)
			return ECO_DAMAGED;
	}
	return next == s->ground_count || s->ground_count == 0 ? ECO_OK
		: BAD("scene: %u of %u ground tiles have a parent", next, s->ground_count);
}

/* ---- The ground's image ---- */

static enum eco_code check_ground_image(const struct eco_scene *s, uint32_t id, struct eco_error *error)
{
	const struct eco_ground_image *t = &s->ground_images[id];
	if (t->list >= s->list_count || s->lists[t->list].kind != ECO_LIST_GROUND_IMAGE
			|| s->lists[t->list].chunk_count != ECO_GROUND_IMAGE_LEVELS)
		return BAD("ground image %u: list %u is not an image of the ground in %u levels", id, t->list,
			ECO_GROUND_IMAGE_LEVELS);
	if (s->lists[t->list].image != ECO_NONE)
		return BAD("ground image %u: list %u has an image of its own", id, t->list);
	if (s->lists[t->list].grid_step[0] != s->lists[t->list].grid_step[1])
		return BAD("ground image %u: the texels of list %u are not square", id, t->list);
	return ECO_OK;
}

/* Lists of tiles that have been checked. */
static enum eco_code check_ground_image_children(const struct eco_scene *s, uint32_t id,
	struct eco_error *error)
{
	const struct eco_list *parent = &s->lists[s->ground_images[id].list];
	for (uint32_t quarter = 0; quarter < 4; quarter++) {
		const struct eco_list *list =
			&s->lists[s->ground_images[s->ground_images[id].child_first + quarter].list];
		struct eco_list there = *parent;
		eco_ground_image_quarter(&there, quarter);
		if (memcmp(list->grid_origin, there.grid_origin, sizeof there.grid_origin) != 0
				|| memcmp(list->grid_step, there.grid_step, sizeof there.grid_step) != 0)
			return BAD("ground image %u: its child %u does not lie where it should", id,
				s->ground_images[id].child_first + quarter);
	}
	return ECO_OK;
}

static enum eco_code check_ground_images(const struct eco_scene *s, struct eco_error *error)
{
	uint32_t next = 1, lists = 0;
	if (s->ground_image_count && !s->ground_count)
		return BAD("scene: an image on ground that is not there");
	for (uint32_t i = 0; i < s->list_count; i++)
		lists += s->lists[i].kind == ECO_LIST_GROUND_IMAGE;
	if (lists != s->ground_image_count)
		return BAD("scene: %u tiles of the ground's image in %u lists", s->ground_image_count, lists);
	for (uint32_t i = 0; i < s->ground_image_count; i++)
		if (check_ground_image(s, i, error) != ECO_OK)
			return ECO_DAMAGED;
	for (uint32_t i = 0; i < s->ground_image_count; i++) {
		uint32_t first = s->ground_images[i].child_first;
		if (!first)
			continue;
		if (first != next || s->ground_image_count - next < 4)
			return BAD("ground image %u: children [%u, +4) of %u tiles", i, first,
				s->ground_image_count);
		next += 4;
		if (check_ground_image_children(s, i, error) != ECO_OK)
			return ECO_DAMAGED;
	}
	return next == s->ground_image_count || !s->ground_image_count
		? ECO_OK
		: BAD("scene: %u of %u tiles of the ground's image have a parent", next,
			  s->ground_image_count);
}

/* The last list alone may be one, with a block for each ECO_INVENTORY_PLACES places. */
static enum eco_code check_inventory(const struct eco_scene *s, struct eco_error *error)
{
	uint64_t blocks = (s->place_count + ECO_INVENTORY_PLACES - 1) / ECO_INVENTORY_PLACES;
	for (uint32_t i = 0; i < s->list_count; i++)
		if (s->lists[i].kind == ECO_LIST_INVENTORY
				&& (i + 1 < s->list_count || s->lists[i].chunk_count != blocks))
			return BAD("list %u: rows of plants are the last list, in a block for each %u of "
				"%llu places, not in %u", i, ECO_INVENTORY_PLACES,
				(unsigned long long)s->place_count, s->lists[i].chunk_count);
	return ECO_OK;
}

/* Everything present must be among the needs: a reader skips what is not listed. */
static enum eco_code check_needs(const struct eco_scene *s, struct eco_error *error)
{
	static const struct { uint32_t need; const char *name; } names[] = {
		{ ECO_NEED_POINTS, "points" }, { ECO_NEED_LINES, "lines" },
			{ ECO_NEED_TRIANGLES, "triangles" },
		{ ECO_NEED_TEXTURES, "textures" }, { ECO_NEED_GROUND, "ground" }, { ECO_NEED_CELLS, "cells" },
		{ ECO_NEED_SUMMARIES, "summaries" }, { ECO_NEED_PLACEMENTS, "placements" },
		{ ECO_NEED_SPLATS, "splats" }, { ECO_NEED_GROUND_IMAGE, "an image on the ground" },
	};
	uint32_t used = 0;

	for (uint32_t i = 0; i < s->list_count; i++)
		used |= eco_list_needs(&s->lists[i]);
	for (uint32_t i = 0; i < s->plant_count; i++)
		used |= s->plants[i].anchor_count > 1 ? ECO_NEED_CELLS : 0;
	for (uint32_t i = 0; i < s->child_count; i++)
		used |= s->children[i].placed ? ECO_NEED_PLACEMENTS : 0;
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
		if (used & ~s->needs & names[i].need)
			return BAD("scene: uses %s but does not list them among its needs (%#x)",
				names[i].name, s->needs);
	return ECO_OK;
}

enum eco_code eco_scene_check(const struct eco_scene *s, struct eco_error *error)
{
	if (!name_ends(s->name))
		return BAD("scene: its name has no end");
	if (s->needs > ECO_NEEDS_ALL)
		return eco_fail(error, ECO_UNSUPPORTED, "scene: needs %#x that this program does not know",
			s->needs);
	if (!within(s->near_m, 1e-9, METRES_MAX))
		return BAD("scene: near plane at %g m is impossible", s->near_m);
	if (s->root >= s->tile_count)
		return BAD("scene: root tile %u of %u is not there", s->root, s->tile_count);
	if (check_lists(s, error) != ECO_OK || check_plants(s, error) != ECO_OK)
		return ECO_DAMAGED;
	enum eco_code code = check_tiles(s, error);
	if (code)
		return code;
	if (check_ground(s, error) != ECO_OK || check_ground_images(s, error) != ECO_OK
			|| check_inventory(s, error) != ECO_OK)
		return ECO_DAMAGED;
	return check_needs(s, error);
}
