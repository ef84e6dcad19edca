/* Single plants: what their rows say, and plants by what is said of them. */
#include "server/describe.h"

#include <string.h>
#include <strings.h>

#include "ecofiles/format/inventory.h"
#include "ecofiles/format/legend.h"
#include "ecofiles/format/plan.h"

/* ---- Rows of a list ---- */

uint32_t srv_plants_list(const struct srv_scene *scene, const char *text)
{
	const struct eco_scene *tables = &scene->pack->scene;
	uint64_t list;
	return srv_parse_count(text, &list) && list < tables->list_count &&
			tables->lists[list].kind == ECO_LIST_INSTANCES
		? (uint32_t)list
		: ECO_NONE;
}

static void describe_row(struct srv_json *json, const char *plant, const char *class,
	const struct eco_inventory_row *row)
{
	uint32_t cells = ECO_INVENTORY_CELLS;
	while (cells && !row->cells[cells - 1])
		cells--;
	srv_json_add(json, "species:%s plant:%s", eco_inventory_species(row, plant), plant);
	if (class)
		srv_json_add(json, "class:%s", class);
	if (row->file)
		srv_json_add(json, "file:%s row:%u", row->file, row->row);
	if (row->file && row->line)
		srv_json_add(json, "line:%u", row->line);
	for (uint32_t i = 0; i < cells; i++)
		srv_json_add(json, i ? "%s" : "cells:[%s", row->cells[i]);
	if (cells)
		srv_json_add(json, "]");
	srv_json_add(json, "}");
}

/* Plants [first, end) of the list whose groups begin at `group`. */
static enum eco_code describe_rows(struct srv_json *json, const struct srv_scene *scene,
	const struct eco_group *group, uint32_t first, uint32_t end, struct eco_error *error)
{
	const struct eco_pack *pack = scene->pack;
	struct eco_inventory_block block = { 0 };
	enum eco_code code = ECO_OK;
	for (uint32_t i = first; i < end && !code; i++) {
		while (i >= group->first + group->count)
			group++;
		uint64_t place = group->place_first + (i - group->first);
		const struct eco_inventory_row *row;
		code = eco_inventory_at(&block, pack, place, &row, error);
		if (!code) {
			srv_json_add(json, "{");
			describe_row(json, pack->scene.plants[group->plant].name,
				eco_legend_class(scene->meta, &pack->scene, group->list, place), row);
		}
	}
	eco_inventory_free(&block);
	return code;
}

enum eco_code srv_describe_plants(struct srv_json *json, const struct srv_scene *scene, uint32_t list,
	const struct srv_plants_query *query, struct eco_error *error)
{
	const struct eco_pack *pack = scene->pack;
	uint32_t all = pack->scene.lists[list].primitive_count, first = (uint32_t)query->first;
	if (query->first >= all)
		return eco_fail(error, ECO_BAD_INPUT,
			"parameter 'first': list %u has %u plants, the first is 0", list, all);
	uint32_t end = all - first < query->count ? all : first + (uint32_t)query->count;
	srv_json_add(json, "{pack:%s list:%u first:%u of:%u plants:[", eco_id_text(pack->id.bytes).hex, list, first, all);
	enum eco_code code = describe_rows(json, scene, eco_list_groups(&pack->scene, list), first, end, error);
	srv_json_add(json, "]}");
	return code;
}

/* ---- Finding ---- */

#define NESTED_MOST 32u          /* files within files, of a plant that is found */

struct find {
	const struct srv_scene *scene;
	const struct srv_find_query *query;
	uint8_t *known;              /* enum lod_places per group; NULL: all */
	struct srv_json *json;
	uint64_t row, found;         /* row: 0: the text is no number */
	uint32_t tile;               /* whose placement it is */
	struct eco_placement placement;
	bool wants;                  /* places that are not known are marked; then nothing is said any more */
};

/* Small letters are as capitals, where they are of ASCII. */
static bool has_text(const char *in, const char *text)
{
	size_t size = strlen(text);
	while (in && *in && strncasecmp(in, text, size) != 0)
		in++;
	return in && *in;
}

/* A number is of a row, or a whole cell. */
static bool is_wanted(const struct find *f, const char *plant, const struct eco_inventory_row *row)
{
	const char *text = f->query->text, *species = eco_inventory_species(row, plant);
	bool wanted = f->row ? row->file && row->row == f->row : has_text(plant, text) || has_text(species, text);
	for (uint32_t i = 0; i < ECO_INVENTORY_CELLS && !wanted; i++)
		wanted = row->cells[i] && (f->row ? strcmp(row->cells[i], text) == 0 : has_text(row->cells[i], text));
	return wanted;
}

/* The tile's first occurrence. Children have greater numbers than their parents. False: it has none. */
static bool place_tile(const struct eco_scene *s, uint32_t tile, struct eco_placement *placement)
{
	const struct eco_child *path[NESTED_MOST];
	uint32_t depth = 0;
	for (uint32_t t = tile; tile != s->root && t-- > 0;)
		for (uint32_t c = 0; c < s->tiles[t].child_count; c++) {
			const struct eco_child *child = &s->children[s->tiles[t].child_first + c];
			if (child->tile != tile)
				continue;
			if (child->placed && depth == NESTED_MOST)
				return false;
			if (child->placed)
				path[depth++] = child;
			tile = t;
			break;
		}
	if (tile != s->root)
		return false;
	*placement = (struct eco_placement){ .scale = 1 };
	while (depth)
		*placement = eco_placement_inside(placement, path[--depth]);
	return true;
}

static void add_found(struct find *f, const struct eco_group *group, uint64_t place, const struct eco_inventory_row *row)
{
	const struct eco_scene *s = &f->scene->pack->scene;
	const struct eco_list *list = &s->lists[group->list];
	struct eco_place stored = eco_place_read(s, place);
	double at[3];
	f->found++;
	if (f->known && f->known[group - s->groups] != LOD_PLACES_KNOWN) {
		f->known[group - s->groups] = LOD_PLACES_WANTED;
		f->wants = true;
	}
	if (f->wants || (group->tile != f->tile && !place_tile(s, group->tile, &f->placement)))
		return;
	f->tile = group->tile;
	for (int k = 0; k < 3; k++)
		at[k] = list->grid_origin[k] + list->grid_step[k] * stored.position[k];
	eco_placement_point(&f->placement, at, at);
	srv_json_add(f->json, "{list:%u index:%u number:%u foot:[%g %g %g] height_m:%g", group->list,
		group->first + (uint32_t)(place - group->place_first), group->plant, at[0], at[1], at[2],
		(double)s->plants[group->plant].height_m * stored.scale / 65536 * f->placement.scale);
	describe_row(f->json, s->plants[group->plant].name, eco_legend_class(f->scene->meta, s, group->list, place), row);
}

/* Plants of a group from place `from` on, up to `end`; returns where it ended. */
static uint64_t find_in(struct find *f, const struct eco_group *group, uint64_t from, uint64_t end,
	struct eco_inventory_block *block, struct eco_error *error)
{
	uint64_t place = from < group->place_first ? group->place_first : from;
	const struct eco_inventory_row *row;
	for (; place < group->place_first + group->count && place < end && f->found < f->query->count; place++) {
		if (eco_inventory_at(block, f->scene->pack, place, &row, error))
			break;
		if (is_wanted(f, f->scene->pack->scene.plants[group->plant].name, row))
			add_found(f, group, place, row);
	}
	return place;
}

enum eco_code srv_describe_found(struct srv_json *json, const struct srv_scene *scene, uint8_t *known,
	const struct srv_find_query *query, struct eco_error *error)
{
	const struct eco_scene *s = &scene->pack->scene;
	struct find f = { .scene = scene, .query = query, .known = known, .json = json, .tile = ECO_NONE };
	struct eco_inventory_block block = { 0 };
	struct eco_error own = { 0 };
	uint64_t next = query->first, left = s->place_count - next, most = SRV_FIND_BLOCKS * (uint64_t)ECO_INVENTORY_PLACES;
	if (next && next >= s->place_count)
		return eco_fail(error, ECO_BAD_INPUT, "parameter 'first': the scene has %llu plants, the first is 0",
			(unsigned long long)s->place_count);
	uint64_t end = next + (left < most ? left : most);
	if (!srv_parse_count(query->text, &f.row))
		f.row = 0;
	srv_json_add(json, "{pack:%s of:%lu plants:[", eco_id_text(scene->pack->id.bytes).hex, s->place_count);
	for (uint32_t g = 0; g < s->group_count && !own.code; g++)
		if (s->groups[g].place_first + s->groups[g].count > next && s->groups[g].place_first < end && f.found < query->count)
			next = find_in(&f, &s->groups[g], next, end, &block, &own);
	next = f.found < query->count ? end : next;
	eco_inventory_free(&block);
	srv_json_add(json, "] next:%lx}", next < s->place_count ? next : UINT64_MAX);
	return own.code ? eco_fail(error, own.code, "%s", own.text) : f.wants ? ECO_INTERRUPTED : ECO_OK;
}
