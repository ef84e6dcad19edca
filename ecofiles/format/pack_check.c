/* The one place that distrusts a scene's tables: everything after it (planner, wire, client) may index
 * without checks. Work is linear in the tables. Ranges that could overlap are bounded by their sum:
 * otherwise a small file whose ranges all cover one large table would cost the product. Longer than 600
 * lines: one table's checks rely on another's.
 *
 * A function NAME_fault says what is wrong with a record; NULL: nothing. It relies on the checks before it. */
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/chunk/chunk_payload.h"
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

static bool all_within(const double *v, double low, double high)
{
	return within(v[0], low, high) && within(v[1], low, high) && within(v[2], low, high);
}

static bool range_fits(uint64_t first, uint64_t count, uint64_t total)
{
	return first <= total && count <= total - first;
}

static bool name_ends(const char name[64])
{
	return memchr(name, 0, 64);
}

static enum eco_code fail_if(const char *fault, const char *table, uint32_t id, struct eco_error *error)
{
	return fault ? BAD("%s %u: %s", table, id, fault) : ECO_OK;
}

static enum eco_code check_each(const struct eco_scene *s, const char *table, uint32_t count,
	const char *(*fault)(const struct eco_scene *, uint32_t), struct eco_error *error)
{
	for (uint32_t i = 0; i < count; i++)
		ECO_PASS(fail_if(fault(s, i), table, i, error));
	return ECO_OK;
}

/* ---- Single records ---- */

bool eco_anchor_sound(const struct eco_anchor *a)
{
	return all_within((double[3]){ a->center[0], a->center[1], a->center[2] }, -RADIUS_MAX, RADIUS_MAX)
		&& within(a->radius, 0, RADIUS_MAX);
}

static const char *anchor_fault(const struct eco_scene *s, uint32_t id)
{
	return eco_anchor_sound(&s->anchors[id]) ? NULL : "its centre or radius is impossible";
}

const char *eco_list_fault(const struct eco_list *l)
{
	const char *fault = eco_list_coding_fault(l);
	bool form = l->coder == ECO_CODER_FORM, ownerless = l->kind == ECO_LIST_GROUND
		|| l->kind == ECO_LIST_GROUND_IMAGE || l->kind == ECO_LIST_INVENTORY;
	uint32_t levels_max = l->kind == ECO_LIST_IMPOSTOR ? ECO_IMPOSTOR_LEVELS
		: eco_list_has_texels(l) ? ECO_TEXTURE_LEVELS_MAX : 0;
	if (fault)
		return fault;
	if (!eco_list_level_known(l))
		return "its level is unknown";
	if (!all_within(l->grid_origin, -METRES_MAX, METRES_MAX) || !all_within(l->grid_step, 1e-12, STEP_MAX))
		return "its grid is impossible";
	if (!within(l->unit_area, 0, AREA_MAX))
		return "its unit area is impossible";
	if ((l->attributes & ECO_ATTR_COLOR) && !l->palette_count)
		return "it has colours but no palette";
	if (l->kind == ECO_LIST_INSTANCES && l->palette_count > ECO_LIST_TINTS_MAX)
		return "it has too many tints";
	if (l->kind == ECO_LIST_GROUND ? !l->columns || l->primitive_count % l->columns
			: eco_list_is_mixed(l) ? l->wood && !l->palette_count
			: l->cover >= (l->kind == ECO_LIST_POINTS && form ? ECO_COVER_ONE : 1))
		return "its rows of samples, its wood or its cover are impossible";
	if (form != (l->partner != ECO_NONE))
		return "its partner does not go with its coder";
	if ((l->kind == ECO_LIST_INSTANCES) != (l->group_count > 0) || l->group_count > l->primitive_count)
		return "its groups of plants are impossible";
	if (ownerless != (l->owner == ECO_NONE) && l->kind != ECO_LIST_IMAGE && l->kind != ECO_LIST_OUTLINE)
		return "its owner does not go with its kind";
	if (l->element_count > l->primitive_count || (l->chunk_count > l->element_count && !eco_list_has_texels(l))
			|| !l->chunk_count != !l->primitive_count)
		return "its counts are impossible";
	if (levels_max && (l->primitive_count != l->element_count || l->primitive_count > l->chunk_count
			|| l->primitive_count > levels_max))
		return "its levels are too many, or not an element each";
	if (form && l->primitive_count != l->element_count
			&& (l->kind != ECO_LIST_TRIANGLES || l->primitive_count != 2ull * l->element_count))
		return "its forms are not all points, lines, triangles or quads";
	return NULL;
}

enum eco_code eco_chunk_check(const struct eco_list *list, const struct eco_chunk *chunk,
	struct eco_error *error)
{
	uint64_t most = (uint64_t)chunk->element_count * (list->kind == ECO_LIST_TRIANGLES
		&& list->coder != ECO_CODER_MESH ? 4 : 1);
	bool form = list->coder == ECO_CODER_FORM;
	if (chunk->element_count < !eco_list_has_texels(list) || chunk->element_count > ECO_CHUNK_ELEMENTS_MAX)
		return BAD("chunk: %u elements are not in 1..%u", chunk->element_count,
			ECO_CHUNK_ELEMENTS_MAX);
	if (chunk->primitive_count < chunk->element_count || chunk->primitive_count > most
			|| (form && (uint64_t)chunk->primitive_count * list->element_count
			!= (uint64_t)list->primitive_count * chunk->element_count))
		return BAD("chunk: %u elements cannot have %u primitives", chunk->element_count,
			chunk->primitive_count);
	if (chunk->size_bytes < 1 || chunk->size_bytes > ECO_CHUNK_BYTES_MAX)
		return BAD("chunk: %u bytes are not in 1..%u", chunk->size_bytes, ECO_CHUNK_BYTES_MAX);
	if (list->coder == ECO_CODER_BYTES && chunk->element_count > 1)
		return BAD("chunk: a file is one element, not %u", chunk->element_count);
	return ECO_OK;
}

/* ---- Lists ---- */

static const char *list_fault(const struct eco_scene *s, uint32_t id)
{
	const struct eco_list *list = &s->lists[id];
	bool of_tile = list->kind == ECO_LIST_INSTANCES || (list->attributes & ECO_ATTR_PLANT);
	const char *fault = eco_list_fault(list);
	if (fault)
		return fault;
	if (list->owner != ECO_NONE && list->owner >= (of_tile ? s->tile_count : s->plant_count))
		return "its owner is not there";
	if (!range_fits(list->palette_first, list->palette_count, s->palette_count))
		return "its palette is not there";
	if (list->image != ECO_NONE
			&& (list->image >= s->list_count || s->lists[list->image].kind
			!= (list->kind == ECO_LIST_IMAGE ? ECO_LIST_OUTLINE : ECO_LIST_IMAGE)))
		return "its image is not an image list, or not an outline of this one";
	if (list->partner == ECO_NONE)
		return NULL;
	const struct eco_list *partner = list->partner < s->list_count ? &s->lists[list->partner] : NULL;
	return !partner || partner->kind != ECO_LIST_TRIANGLES || partner->coder != ECO_CODER_ELEMENTS
		|| partner->chunk_count != list->chunk_count || partner->owner != list->owner
		? "its partner is not a list of as many chunks of fans of its owner" : NULL;
}

static enum eco_code check_list_chunks(const struct eco_scene *s, uint32_t id, uint64_t *chunks_left,
	struct eco_error *error)
{
	const struct eco_list *list = &s->lists[id];
	uint64_t primitives = 0, elements = 0;
	if (!range_fits(list->chunk_first, list->chunk_count, s->chunk_count)
			|| list->chunk_count > *chunks_left)
		return BAD("list %u: its chunks are not there, or are shared with another list", id);
	*chunks_left -= list->chunk_count;
	for (uint32_t i = 0; i < list->chunk_count; i++) {
		const struct eco_chunk *chunk = &s->chunks[list->chunk_first + i];
		ECO_PASS(eco_chunk_check(list, chunk, error));
		primitives += chunk->primitive_count;
		elements += chunk->element_count;
	}
	if (primitives != list->primitive_count || elements != list->element_count)
		return BAD("list %u: its chunks hold other counts than it says", id);
	if (list->chunk_count && !s->chunks[list->chunk_first + list->chunk_count - 1].primitive_count)
		return BAD("list %u: a strip follows its last level", id);
	return ECO_OK;
}

/* A form has one element for each of the partner's, chunk by chunk, with no more vertices. */
static const char *form_fault(const struct eco_scene *s, uint32_t id)
{
	const struct eco_list *list = &s->lists[id], *partner = &s->lists[list->partner];
	for (uint32_t i = 0; list->partner != ECO_NONE && i < list->chunk_count; i++) {
		const struct eco_chunk *own = &s->chunks[list->chunk_first + i],
			*of = &s->chunks[partner->chunk_first + i];
		if (own->element_count != of->element_count
				|| (uint64_t)eco_list_vertices(list) * own->primitive_count > 3ull * of->primitive_count)
			return "a chunk has not one form for each element of its partner, or dearer ones";
	}
	return NULL;
}

static enum eco_code check_lists(const struct eco_scene *s, struct eco_error *error)
{
	uint64_t chunks_left = s->chunk_count;
	enum eco_code code = check_each(s, "list", s->list_count, list_fault, error);
	for (uint32_t i = 0; i < s->list_count && !code; i++)
		code = check_list_chunks(s, i, &chunks_left, error);
	return code ? code : check_each(s, "list", s->list_count, form_fault, error);
}

/* ---- Plants ---- */

static const char *curve_fault(const struct eco_scene *s, const struct eco_ladder *l)
{
	float last = 0;
	if (l->curve_count > CURVE_SAMPLES_MAX || !range_fits(l->curve_first, eco_ladder_samples(l), s->curve_count))
		return "its curve is not there, or is too long";
	for (uint32_t i = 0; i < eco_ladder_samples(l); i++) {
		const struct eco_curve *c = &s->curves[l->curve_first + i],
			*around = i < l->curve_count ? NULL : c - l->curve_count;
		if (around ? c->share != around->share || c->reach != around->reach
				: !(c->share > last && c->share <= 1))
			return "the shares of its curve do not ascend in (0, 1]";
		if (!within(c->scale, 0, SCALE_MAX) || !within(c->reach, 0, 1) || !within(c->fp, 0, SCALE_MAX)
				|| !within(c->fn, 0, SCALE_MAX) || (c->reach < 1 && eco_ladder_has_splats(s, l)))
			return "a sample of its curve is impossible";
		last = c->share;
	}
	return NULL;
}

/* A list that a ladder names is of that kind and the plant's. */
static bool ladder_list_fits(const struct eco_scene *s, uint32_t list, uint8_t kind, uint32_t plant)
{
	return list == ECO_NONE || (list < s->list_count && s->lists[list].kind == kind
		&& s->lists[list].owner == plant && !(s->lists[list].attributes & ECO_ATTR_PLANT));
}

/* An impostor is one vertex of a ladder with splats, in place of the first one. */
static bool ladder_impostor_fits(const struct eco_scene *s, const struct eco_ladder *l)
{
	return l->impostor == ECO_NONE || (ladder_list_fits(s, l->impostor, ECO_LIST_IMPOSTOR, l->plant)
		&& s->lists[l->impostor].primitive_count && (l->flags & ECO_LADDER_WHOLE)
		&& eco_ladder_has_splats(s, l)
		&& l->curve_count >= s->lists[l->impostor].primitive_count);
}

/* A list with a partner is a form of the ladder's triangles. */
static bool ladder_form_fits(const struct eco_scene *s, uint32_t list, uint32_t triangles)
{
	return list == ECO_NONE || s->lists[list].partner == ECO_NONE || s->lists[list].partner == triangles;
}

/* The last of a plant's ladders may go on in its cells, which were checked before it. */
static bool front_fits(const struct eco_scene *s, const struct eco_ladder *l)
{
	const struct eco_plant *p = &s->plants[l->plant];
	uint32_t lists[ECO_FRONT_MAX], own = s->lists[l->triangles].primitive_count, count =
		l + 1 == s->ladders + p->ladder_first + p->ladder_count ? eco_ladder_front(s, l, lists) : 0;
	uint64_t all = own;
	while (count > 0)
		all += s->lists[lists[--count]].primitive_count;
	return l->total <= own || l->total == all;
}

/* Each level has a whole multiple of the splats of the one before it; together they are the list. */
static const char *splat_levels_fault(const struct eco_scene *s, const struct eco_ladder *l)
{
	uint32_t before = 0, first = 0;
	if (l->lines != ECO_NONE || l->simple != ECO_NONE)
		return "it has other lists than triangles beside its splats";
	if (l->triangles != ECO_NONE && !front_fits(s, l))
		return "it has fewer triangles before its splats, or more";
	for (uint32_t i = 0; i < l->level_count; i++) {
		uint32_t size = l->level_end[i] - first;
		if (before && (size % before != 0 || size == before))
			return "a level has no whole multiple of the splats before it";
		before = size;
		first = l->level_end[i];
	}
	return l->level_count == 0 || first != s->lists[l->points].primitive_count
		? "its levels are not all of its splats" : NULL;
}

static const char *levels_fault(const struct eco_scene *s, const struct eco_ladder *l)
{
	bool splats = eco_ladder_has_splats(s, l);
	uint32_t last = 0, list = splats ? l->points : l->triangles;
	if (l->level_count > ECO_LEVELS_MAX || (l->level_count > 0 && list == ECO_NONE))
		return "its levels are too many, or of no list";
	for (uint32_t i = 0; i < ECO_LEVELS_MAX; last = l->level_end[i++])
		if (i < l->level_count ? l->level_end[i] <= last || l->level_end[i] > s->lists[list].primitive_count
				: l->level_end[i] != 0)
			return "its levels do not ascend within its list";
	return splats ? splat_levels_fault(s, l) : NULL;
}

static const char *ladder_fault(const struct eco_scene *s, uint32_t id)
{
	const struct eco_ladder *l = &s->ladders[id];
	uint32_t place = l->flags & (ECO_LADDER_FAR | ECO_LADDER_NEAR | ECO_LADDER_WHOLE);
	if (l->plant >= s->plant_count)
		return "its plant is not there";
	const struct eco_plant *plant = &s->plants[l->plant];
	if (l->anchor < plant->anchor_first || l->anchor - plant->anchor_first >= plant->anchor_count)
		return "its anchor is not its plant's";
	if (l->organ >= ECO_ORGAN_COUNT || l->flags >= 2 * ECO_LADDER_WHOLE || l->reserved
			|| (place & (place - 1)))
		return "its organ or its flags are impossible";
	if ((l->flags & ECO_LADDER_WHOLE) && l->anchor != plant->anchor_first)
		return "it shows the whole plant at a cell";
	if (!ladder_list_fits(s, l->points, ECO_LIST_POINTS, l->plant)
			|| !ladder_list_fits(s, l->lines, ECO_LIST_LINES, l->plant)
			|| !ladder_list_fits(s, l->simple, ECO_LIST_TRIANGLES, l->plant)
			|| !ladder_list_fits(s, l->triangles, ECO_LIST_TRIANGLES, l->plant)
			|| (l->points == ECO_NONE && l->lines == ECO_NONE && l->triangles == ECO_NONE))
		return "its lists are not points, lines and triangles of its plant";
	if (!ladder_form_fits(s, l->points, l->triangles) || !ladder_form_fits(s, l->lines, l->triangles)
			|| !ladder_form_fits(s, l->simple, l->triangles)
			|| (l->simple != ECO_NONE && s->lists[l->simple].coder != ECO_CODER_FORM))
		return "its lists are not forms of its triangles";
	if (!ladder_impostor_fits(s, l))
		return "its impostor is not its plant's, beside splats and with its samples";
	if (l->before > l->total || !within(l->importance, 0, SCALE_MAX) || !within(l->area, 0, AREA_MAX)
			|| !within(l->length, 0, AREA_MAX) || !within(l->epsilon, 0, RADIUS_MAX))
		return "a number is impossible";
	const char *fault = levels_fault(s, l);
	return fault ? fault : curve_fault(s, l);
}

static const char *plant_fault(const struct eco_scene *s, uint32_t id)
{
	const struct eco_plant *p = &s->plants[id];
	if (!name_ends(p->name))
		return "its name has no end";
	if (!within(p->height_m, 0, RADIUS_MAX) || !within(p->area, 0, AREA_MAX))
		return "its height or area is impossible";
	return p->anchor_count < 1 || !range_fits(p->anchor_first, p->anchor_count, s->anchor_count)
		|| !range_fits(p->ladder_first, p->ladder_count, s->ladder_count)
		? "its anchors or ladders are not there" : NULL;
}

static const char *plant_ladders_fault(const struct eco_scene *s, uint32_t id)
{
	const struct eco_plant *p = &s->plants[id];
	for (uint32_t k = 0; k < p->ladder_count; k++)
		if (s->ladders[p->ladder_first + k].plant != id)
			return "one of its ladders is another plant's";
	return NULL;
}

static enum eco_code check_plants(const struct eco_scene *s, struct eco_error *error)
{
	uint64_t ladders = 0, anchors = 0;
	enum eco_code code = check_each(s, "plant", s->plant_count, plant_fault, error);
	for (uint32_t i = 0; i < s->plant_count && !code; i++) {
		ladders += s->plants[i].ladder_count;
		anchors += s->plants[i].anchor_count;
	}
	if (!code && (ladders != s->ladder_count || anchors > s->anchor_count))
		code = BAD("plants: not each ladder and anchor belongs to one");
	code = code ? code : check_each(s, "anchor", s->anchor_count, anchor_fault, error);
	code = code ? code : check_each(s, "plant", s->plant_count, plant_ladders_fault, error);
	return code ? code : check_each(s, "ladder", s->ladder_count, ladder_fault, error);
}

/* ---- Tiles ---- */

/* Groups of one list follow each other and are all of it. *plants grows by theirs. */
static const char *groups_fault(const struct eco_scene *s, uint32_t tile, uint64_t *plants)
{
	uint32_t i = s->tiles[tile].group_first, end = i + s->tiles[tile].group_count, left = 0, at = 0;
	for (; i < end; i++) {
		const struct eco_group *g = &s->groups[i];
		if (g->tile != tile || g->list >= s->list_count || s->lists[g->list].kind != ECO_LIST_INSTANCES
				|| s->lists[g->list].owner != tile)
			return "a group is not of it, or of a list that is not";
		const struct eco_list *list = &s->lists[g->list];
		if (left ? g->list != g[-1].list || g->place_first != g[-1].place_first + g[-1].count
				: list->group_count > end - i)
			return "groups of one list do not follow each other";
		at = left ? at : 0;
		left = left ? left - 1 : list->group_count - 1;
		if (g->plant >= s->plant_count || g->first != at || g->count < 1
				|| g->count > list->primitive_count - at
				|| !range_fits(g->place_first, g->count, s->place_count))
			return "a group has no plant, or no such instances or places";
		at += g->count;
		*plants += g->count;
		if (!left && at != list->primitive_count)
			return "the groups of a list are not all of it";
	}
	return NULL;
}

static bool child_sound(const struct eco_scene *s, uint32_t id, uint32_t tile)
{
	const struct eco_child *c = &s->children[id];
	return c->tile < s->tile_count && c->tile > tile && all_within(c->at, -METRES_MAX, METRES_MAX)
		&& within(c->scale, (double)1e-6f, 1e6);
}

static const char *tile_ranges_fault(const struct eco_scene *s, uint32_t id)
{
	const struct eco_tile *t = &s->tiles[id];
	return !range_fits(t->group_first, t->group_count, s->group_count)
		|| !range_fits(t->child_first, t->child_count, s->child_count)
		? "its groups or children are not there" : NULL;
}

static const char *tile_fault(const struct eco_scene *s, uint32_t id)
{
	const struct eco_tile *t = &s->tiles[id];
	uint64_t instances = 0;
	if (!all_within(t->low, -METRES_MAX, METRES_MAX) || !all_within(t->high, -METRES_MAX, METRES_MAX)
			|| t->low[0] > t->high[0] || t->low[1] > t->high[1] || t->low[2] > t->high[2]
			|| !within(t->area, 0, AREA_MAX))
		return "its bounds or area are impossible";
	if (t->summary != ECO_NONE
			&& (t->summary >= s->list_count || s->lists[t->summary].kind != ECO_LIST_POINTS
			|| !(s->lists[t->summary].attributes & ECO_ATTR_PLANT) || s->lists[t->summary].owner != id))
		return "its summary is another list";
	const char *fault = groups_fault(s, id, &instances);
	if (fault)
		return fault;
	for (uint32_t i = t->child_first; i < t->child_first + t->child_count; i++)
		if (!child_sound(s, i, id) || __builtin_add_overflow(instances,
				s->tiles[s->children[i].tile].instance_count, &instances))
			return "a child is not a tile after it, or is placed impossibly";
	return instances != t->instance_count ? "its groups and children hold other numbers of plants" : NULL;
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
	enum eco_code code = check_each(s, "tile", s->tile_count, tile_ranges_fault, error);
	for (uint32_t i = 0; i < s->tile_count; i++) {
		groups += s->tiles[i].group_count;
		children += s->tiles[i].child_count;
	}
	if (!code && (groups != s->group_count || children != s->child_count))
		code = BAD("tiles: not each group and child belongs to one");
	code = code ? code : check_each(s, "tile", s->tile_count, tile_fault, error);
	return code ? code : check_openings(s, error);
}

/* ---- Ground ---- */

static bool same_grid(const struct eco_list *a, const struct eco_list *b)
{
	return memcmp(a->grid_origin, b->grid_origin, sizeof a->grid_origin) == 0
		&& memcmp(a->grid_step, b->grid_step, sizeof a->grid_step) == 0;
}

static const char *ground_tile_fault(const struct eco_scene *s, uint32_t id)
{
	const struct eco_ground_tile *t = &s->ground[id];
	struct eco_ground_span x, y;
	if (t->list >= s->list_count || s->lists[t->list].kind != ECO_LIST_GROUND
			|| s->lists[t->list].chunk_count != 1)
		return "its list is not ground of one chunk";
	if (!eco_ground_on_grid(t, s->ground_columns, s->ground_rows))
		return "it does not lie on the ground's grid";
	const struct eco_list *list = &s->lists[t->list];
	eco_ground_spans(&x, &y, t, s->ground_columns, s->ground_rows);
	if (list->level != t->level || list->columns != x.count || list->primitive_count != x.count * y.count
			|| !same_grid(list, &s->lists[s->ground[0].list]))
		return "its list has another level, grid or number of samples";
	return !within(t->error_m, 0, METRES_MAX) || !within(t->low_m, -METRES_MAX, METRES_MAX)
		|| !within(t->high_m, -METRES_MAX, METRES_MAX) || t->low_m > t->high_m
		? "its error or heights are impossible" : NULL;
}

/* Children come in the order south-west, south-east, north-west, north-east, as far as the grid goes. */
static const char *ground_children_fault(const struct eco_scene *s, uint32_t id)
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
			return "its children do not cover it";
		if (c->error_m > t->error_m || c->low_m < t->low_m || c->high_m > t->high_m)
			return "a child has a larger error, or heights beyond its own";
		found++;
	}
	return found == t->child_count ? NULL : "it has too many children";
}

static uint32_t count_lists(const struct eco_scene *s, uint8_t kind)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < s->list_count; i++)
		count += s->lists[i].kind == kind;
	return count;
}

static enum eco_code check_ground(const struct eco_scene *s, struct eco_error *error)
{
	uint32_t next = 1;
	if (!s->ground_count != !s->ground_columns || !s->ground_count != !s->ground_rows
			|| !eco_ground_size_fits(s->ground_columns, s->ground_rows, s->ground_margin)
			|| count_lists(s, ECO_LIST_GROUND) != s->ground_count)
		return BAD("scene: %u ground tiles of %u x %u samples with margins of %u", s->ground_count,
			s->ground_columns, s->ground_rows, s->ground_margin);
	enum eco_code code = check_each(s, "ground tile", s->ground_count, ground_tile_fault, error);
	if (!code && s->ground_count && s->ground[0].level != eco_ground_root_level(s->ground_columns,
			s->ground_rows))
		code = BAD("ground tile 0: it does not cover all samples");
	for (uint32_t i = 0; i < s->ground_count && !code; i++) {
		const struct eco_ground_tile *t = &s->ground[i];
		if (t->child_first != (t->child_count ? next : 0) || t->child_count > s->ground_count - next)
			return BAD("ground tile %u: its children are not the next ones", i);
		next += t->child_count;
		if (t->child_count)
			code = fail_if(ground_children_fault(s, i), "ground tile", i, error);
	}
	return code || next == s->ground_count || !s->ground_count ? code
		: BAD("scene: %u of %u ground tiles have a parent", next, s->ground_count);
}

static const char *ground_image_fault(const struct eco_scene *s, uint32_t id)
{
	uint32_t list = s->ground_images[id].list;
	return list >= s->list_count || s->lists[list].kind != ECO_LIST_GROUND_IMAGE
		|| s->lists[list].primitive_count != ECO_GROUND_IMAGE_LEVELS || s->lists[list].image != ECO_NONE
		|| s->lists[list].grid_step[0] != s->lists[list].grid_step[1]
		? "its list is not an image of the ground, with all levels and square texels" : NULL;
}

static const char *ground_image_children_fault(const struct eco_scene *s, uint32_t id)
{
	for (uint32_t quarter = 0; quarter < 4; quarter++) {
		const struct eco_ground_image *child = &s->ground_images[s->ground_images[id].child_first + quarter];
		struct eco_list there = s->lists[s->ground_images[id].list];
		eco_ground_image_quarter(&there, quarter);
		if (!same_grid(&s->lists[child->list], &there))
			return "a child does not lie where it should";
	}
	return NULL;
}

static enum eco_code check_ground_images(const struct eco_scene *s, struct eco_error *error)
{
	uint32_t next = 1, count = s->ground_image_count;
	if ((count && !s->ground_count) || count_lists(s, ECO_LIST_GROUND_IMAGE) != count)
		return BAD("scene: %u tiles of the image of %u tiles of ground", count, s->ground_count);
	enum eco_code code = check_each(s, "ground image", count, ground_image_fault, error);
	for (uint32_t i = 0; i < count && !code; i++) {
		uint32_t first = s->ground_images[i].child_first;
		if (!first)
			continue;
		if (first != next || count - next < 4)
			return BAD("ground image %u: its children are not the next ones", i);
		next += 4;
		code = fail_if(ground_image_children_fault(s, i), "ground image", i, error);
	}
	return code || next == count || !count ? code
		: BAD("scene: %u of %u tiles of the ground's image have a parent", next, count);
}

/* ---- The scene ---- */

/* The last list alone may hold rows, with a block for each ECO_INVENTORY_PLACES places. */
static const char *inventory_fault(const struct eco_scene *s, uint32_t id)
{
	const struct eco_list *list = &s->lists[id];
	uint64_t blocks = (s->place_count + ECO_INVENTORY_PLACES - 1) / ECO_INVENTORY_PLACES;
	return list->kind == ECO_LIST_INVENTORY && (id + 1 < s->list_count || list->chunk_count != blocks || !blocks
			|| list->chunk_first + list->chunk_count != s->chunk_count)
		? "rows of plants are not the last list and chunks, or not in a block for so many places" : NULL;
}

/* Everything present but impostors must be among the needs: a reader skips what is not listed. */
static enum eco_code check_needs(const struct eco_scene *s, struct eco_error *error)
{
	uint32_t used = 0, known = ECO_NEEDS_ALL & ~(uint32_t)(ECO_NEED_CUTOUTS | ECO_NEED_IMPOSTORS | ECO_NEED_WATER);
	for (uint32_t i = 0; i < s->list_count; i++)
		used |= eco_list_needs(&s->lists[i]);
	for (uint32_t i = 0; i < s->plant_count; i++)
		used |= s->plants[i].anchor_count > 1 ? ECO_NEED_CELLS : 0;
	for (uint32_t i = 0; i < s->child_count; i++)
		used |= s->children[i].placed ? ECO_NEED_PLACEMENTS : 0;
	return used & ~s->needs & known ? BAD("scene: uses %#x beyond its needs (%#x)", used & ~s->needs, s->needs)
		: ECO_OK;
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
	ECO_PASS(check_lists(s, error));
	ECO_PASS(check_plants(s, error));
	ECO_PASS(check_tiles(s, error));
	ECO_PASS(check_ground(s, error));
	ECO_PASS(check_ground_images(s, error));
	ECO_PASS(check_each(s, "list", s->list_count, inventory_fault, error));
	return check_needs(s, error);
}
