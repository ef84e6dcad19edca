/* Linking: packs that were built apart, by one machine or a thousand, become one pack that nests them, as
 * if a scene had named their scene files.
 *
 *   plants      plants that several parts share are stored once                           link_plants.c
 *   tiles       a tree over the parts, then the parts' tiles, renumbered
 *   payloads    copied without decoding, except summaries whose plants are renumbered
 *   summaries   of the tiles above the parts, from the parts' own
 *
 * Linking takes about as long as copying. The parts' order is that of an outer scene's children: see
 * eco_sources for the order of tables. */
#include "ecofiles/ecopack/link.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/base/version.h"
#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/ecopack/run.h"
#include "ecofiles/base/text.h"
#include "lod/build/summary.h"

#define ORIGIN_MOST 1e9          /* as in scene files */

/* ---- Parts ---- */

/* Fails with the part's name where the code is not ECO_OK. */
static void check(const struct link_part *part, enum eco_code code, const struct eco_error *why)
{
	if (code)
		eco_stop(code, "%.200s: %s", part->path, why->text);
}

static void open_part(struct link *l, struct link_part *part)
{
	eco_check(eco_pack_open(&part->pack, part->path, l->m.error));
	const struct eco_scene *s = &part->pack->scene;
	part->meta = json_loadb(part->pack->meta, part->pack->meta_size, 0, NULL);
	json_t *origin = json_object_get(part->meta, "origin");
	for (size_t i = 0; i < 3; i++) {
		json_t *v = json_array_get(origin, i);
		if (!json_is_number(v) || !(fabs(json_number_value(v)) <= ORIGIN_MOST))
			eco_stop(ECO_BAD_INPUT, "%s: its place is not stated (META has no crs and origin); "
				"build it again with ecopack make", part->path);
		part->at[i] = json_number_value(v);
	}
	part->plant_of = eco_alloc(s->plant_count, sizeof *part->plant_of);
	part->color_of = eco_alloc(s->palette_count, sizeof *part->color_of);
	part->list_of = eco_alloc(s->list_count + 1u, sizeof *part->list_of);
	memset(part->list_of, 0xFF, (s->list_count + 1u) * sizeof *part->list_of);
	json_t *columns = json_object_get(part->meta, "columns");
	for (uint32_t k = 0; k < ECO_INVENTORY_CELLS; k++) {
		const char *name = json_string_value(json_array_get(columns, k));
		part->cell_of[k] = name ? eco_string_number(&l->m.columns, name) : ECO_NONE;
	}
	if (l->m.columns.count > ECO_INVENTORY_CELLS)
		eco_stop(ECO_TOO_LARGE, "%s: the parts' rows have more than %u columns in all", part->path, ECO_INVENTORY_CELLS);
	const char *crs = json_string_value(json_object_get(part->meta, "crs")),
		*first = json_string_value(json_object_get(l->parts[0].meta, "crs"));
	if ((!crs) != (!first) || (crs && strcmp(crs, first) != 0))
		eco_stop(ECO_BAD_INPUT, "%s is in %s, but %s in %s: build all parts with one \"crs\"", part->path,
			crs ? crs : "plain metres", l->parts[0].path, first ? first : "plain metres");
}

static void open_parts(struct link *l)
{
	double origin[3];
	uint64_t plants = 0;
	l->parts = eco_alloc(l->options->count, sizeof *l->parts);
	for (uint32_t i = 0; i < l->options->count; i++) {
		l->parts[i].path = l->options->parts[i];
		l->count++;
		open_part(l, &l->parts[i]);
		const struct eco_scene *s = &l->parts[i].pack->scene;
		l->plant_room += s->plant_count;
		if (__builtin_add_overflow(plants, s->tiles[s->root].instance_count, &plants))
			eco_stop(ECO_TOO_LARGE, "%s: together with it there are more than 2^64 "
				"plants", l->parts[i].path);
	}
	memcpy(origin, l->parts[0].at, sizeof origin);
	for (uint32_t i = 0; i < l->count; i++)
		for (int axis = 0; axis < 3; axis++)
			l->parts[i].at[axis] -= origin[axis];
	l->known = eco_alloc(l->plant_room + 1u, sizeof *l->known);
	l->m.table = eco_alloc(l->plant_room + 1u, sizeof *l->m.table);
	l->m.plants = eco_alloc(l->plant_room + 1u, sizeof *l->m.plants);
	l->plants = json_array();
}

/* ---- Lists ---- */

struct eco_list link_list(const struct link_part *part, uint32_t list)
{
	struct eco_list record = part->pack->scene.lists[list];
	record.image = record.image == ECO_NONE ? ECO_NONE : part->list_of[record.image];
	record.partner = record.partner == ECO_NONE ? ECO_NONE : part->list_of[record.partner];
	record.palette_first = record.palette_count ? part->color_of[record.palette_first] : 0;
	return record;
}

void link_copy(struct link *l, struct link_part *part, uint32_t list, const struct eco_list *record)
{
	struct eco_error why = { 0 };
	check(part, eco_pack_add_copied(l->m.writer, record, part->pack, list, &part->list_of[list], &why), &why);
	make_keep_list(&l->m, part->list_of[list]);
}

/* The same as it is; returns its number in the whole. */
static uint32_t copy_as_is(struct link *l, struct link_part *part, uint32_t list)
{
	const struct eco_list record = link_list(part, list);
	link_copy(l, part, list, &record);
	return part->list_of[list];
}

/* ---- Ground: copied from one part that has rasters, or laid through all plants ---- */

static bool has_rasters(const struct link_part *part)
{
	const char *from = json_string_value(json_object_get(part->meta, "ground"));
	return part->pack->scene.ground_count && !(from && strcmp(from, MAKE_GROUND_THROUGH) == 0);
}

/* The image of the first part that has one and lies where the whole does. */
static void copy_image(struct link *l)
{
	struct make *m = &l->m;
	const struct link_part *from = NULL;
	for (uint32_t i = 0; i < l->count && m->has_ground; i++) {
		struct link_part *part = &l->parts[i];
		const struct eco_scene *s = &part->pack->scene;
		if (!s->ground_image_count)
			continue;
		if (from || part->at[0] != 0 || part->at[1] != 0 || part->at[2] != 0) {
			main_note("%s: the image on its ground is left out; %s", part->path,
				from ? "the whole has that of a part before it"
				     : "it has another origin than the whole");
			continue;
		}
		from = part;
		l->drawn = json_object_get(part->meta, "drawn");
		m->ground_images = eco_alloc(s->ground_image_count, sizeof *m->ground_images);
		for (uint32_t k = 0; k < s->ground_image_count; k++)
			m->ground_images[k] = (struct eco_ground_image){ copy_as_is(l, part, s->ground_images[k].list),
				s->ground_images[k].child_first };
		m->scene.ground_images = m->ground_images;
		m->scene.ground_image_count = s->ground_image_count;
	}
	if (!from)
		m->scene.needs &= ~(uint32_t)(ECO_NEED_GROUND_IMAGE | ECO_NEED_WATER);
}

static void copy_ground(struct link *l)
{
	struct make *m = &l->m;
	uint32_t which = 0;
	while (which < l->count && !has_rasters(&l->parts[which]))
		which++;
	if (which == l->count)
		return;
	struct link_part *part = &l->parts[which];
	const struct eco_scene *s = &part->pack->scene;
	if (part->at[0] != 0 || part->at[1] != 0 || part->at[2] != 0)
		eco_stop(ECO_UNSUPPORTED, "%s has ground but another origin than %s: give it first", part->path,
			l->parts[0].path);
	m->ground_tiles = eco_alloc(s->ground_count, sizeof *m->ground_tiles);
	for (uint32_t i = 0; i < s->ground_count; i++) {
		m->ground_tiles[i] = s->ground[i];
		m->ground_tiles[i].list = copy_as_is(l, part, s->ground[i].list);
		m->ground.step_x_m = s->lists[s->ground[i].list].grid_step[0];
		m->ground.step_y_m = s->lists[s->ground[i].list].grid_step[1];
	}
	m->has_ground = true;
	m->ground.columns = m->scene.ground_columns = s->ground_columns;
	m->ground.rows = m->scene.ground_rows = s->ground_rows;
	m->ground.margin = m->scene.ground_margin = s->ground_margin;
	m->scene.ground = m->ground_tiles;
	m->scene.ground_count = s->ground_count;
	for (uint32_t i = which + 1; i < l->count; i++)
		if (has_rasters(&l->parts[i]))
			main_note("%s: its ground is left out; the ground of %s serves the whole",
				l->parts[i].path, part->path);
}

/* Lays ground through the plants if no part has rasters; parts without any ground stay so. */
static void lay_ground(struct link *l)
{
	bool wanted = false;
	for (uint32_t i = 0; i < l->count; i++)
		wanted |= l->parts[i].pack->scene.ground_count > 0;
	if (wanted)
		make_ground_through(&l->m);
}

/* ---- Tiles ---- */

static void whole_item(const struct link_part *part, struct lod_tile_item *item)
{
	const struct eco_tile *root = &part->pack->scene.tiles[part->pack->scene.root];
	double x = fmax(fabs(root->low[0]), fabs(root->high[0])),
		y = fmax(fabs(root->low[1]), fabs(root->high[1]));
	*item = (struct lod_tile_item){ .at = { part->at[0], part->at[1], part->at[2] },
		.reach = sqrt(x * x + y * y), .below = -root->low[2], .above = root->high[2],
		.plant = ECO_NONE, .weight = make_nested_weight(root->instance_count) };
}

/* Adds the tiles above the parts. */
static void add_outer(struct link *l, const struct lod_tiles *tiles)
{
	struct make *m = &l->m;
	for (uint32_t i = 0; i < tiles->node_count; i++) {
		const struct lod_tile_node *node = &tiles->nodes[i];
		struct eco_tile *tile = make_append(&m->tiles, sizeof *tile);
		*tile = (struct eco_tile){ .summary = ECO_NONE, .child_first = (uint32_t)m->children.count,
			.child_count = node->child_count ? node->child_count : node->item_count };
		memcpy(tile->low, node->low, sizeof tile->low);
		memcpy(tile->high, node->high, sizeof tile->high);
		for (uint32_t c = 0; c < tile->child_count; c++) {
			const struct link_part *part = node->child_count ? NULL
				: &l->parts[tiles->order[node->item_first + c]];
			struct eco_child child = { .placed = part, .scale = 1,
				.tile = part ? part->tile_first + part->pack->scene.root : node->child[c] };
			if (part)
				memcpy(child.at, part->at, sizeof child.at);
			make_add(&m->children, &child, 1, sizeof child);
		}
	}
}

/* Adds the rows of the group's plants. A plant of the whole may have its name from another
 * part. */
static void add_rows(struct link *l, struct link_part *part, const struct eco_group *group)
{
	const struct eco_scene *s = &part->pack->scene;
	const char *own = s->plants[group->plant].name,
		*whole = l->m.table[part->plant_of[group->plant]].name;
	struct eco_error why = { 0 };
	for (uint64_t i = group->place_first; i < group->place_first + group->count; i++) {
		const struct eco_inventory_row *kept;
		check(part, eco_inventory_at(&part->rows, part->pack, i, &kept, &why), &why);
		struct eco_inventory_row row = { kept->species, kept->file, kept->row, kept->line, { NULL } };
		for (uint32_t k = 0; k < ECO_INVENTORY_CELLS; k++)
			if (part->cell_of[k] != ECO_NONE)
				row.cells[part->cell_of[k]] = kept->cells[k];
		row.species = row.species ? row.species : own;
		if (strcmp(row.species, whole) == 0)
			row.species = NULL;
		make_inventory_add(&l->m, part->plant_of[group->plant], &row);
	}
}

/* Neighbours have one palette. */
static uint32_t tint_colors(struct link *l, struct link_part *part, uint32_t list)
{
	const struct eco_list *old = &part->pack->scene.lists[list], *before = part->tinted;
	if (old->palette_count && !(before && before->palette_first == old->palette_first
			&& before->palette_count == old->palette_count)) {
		part->tinted = old;
		part->tint_first = make_add_colors(&l->m, part->pack->scene.palette + old->palette_first, old->palette_count);
	}
	return old->palette_count ? part->tint_first : 0;
}

static void add_groups(struct link *l, struct link_part *part, const struct eco_tile *tile)
{
	const struct eco_scene *s = &part->pack->scene;
	struct make *m = &l->m;
	for (uint32_t g = tile->group_first; g < tile->group_first + tile->group_count; g++) {
		const struct eco_group *from = &s->groups[g];
		struct eco_list record = link_list(part, from->list);
		struct eco_group *group = make_append(&m->groups, sizeof *group);
		make_add(&m->places, s->places + from->place_first * ECO_PLACE_BYTES, from->count, ECO_PLACE_BYTES);
		record.owner += part->tile_first;
		record.palette_first = tint_colors(l, part, from->list);
		if (!from->first)
			link_copy(l, part, from->list, &record);
		add_rows(l, part, from);
		*group = (struct eco_group){ record.owner, part->plant_of[from->plant],
			part->list_of[from->list], m->places.count - from->count, from->first,
			from->count };
	}
}

static void add_tile(struct link *l, struct link_part *part, uint32_t id)
{
	const struct eco_scene *s = &part->pack->scene;
	struct make *m = &l->m;
	struct eco_tile *tile = make_append(&m->tiles, sizeof *tile);
	*tile = s->tiles[id];
	tile->summary = ECO_NONE;
	tile->group_first = (uint32_t)m->groups.count;
	tile->child_first = (uint32_t)m->children.count;
	for (uint32_t c = 0; c < tile->child_count; c++) {
		struct eco_child child = s->children[s->tiles[id].child_first + c];
		child.tile += part->tile_first;
		make_add(&m->children, &child, 1, sizeof child);
	}
	add_groups(l, part, &s->tiles[id]);
}

/* The parts' tables follow the outer one from the last part to the first, as nested files follow the files
 * that name them. */
static void add_tiles(struct link *l)
{
	struct make *m = &l->m;
	struct lod_tile_item *items = eco_alloc(l->count, sizeof *items);
	struct lod_tiles tiles = { 0 };
	for (uint32_t i = 0; i < l->count; i++)
		whole_item(&l->parts[i], &items[i]);
	lod_tiles_build(&tiles, items, l->count, ECO_TILE_INSTANCES);
	uint64_t total = tiles.node_count;
	for (uint32_t i = l->count; i-- > 0;) {
		l->parts[i].tile_first = (uint32_t)total;
		total += l->parts[i].pack->scene.tile_count;
		if (total >= ECO_NONE / 4)
			eco_stop(ECO_TOO_LARGE, "%llu tiles are too many for one pack", (unsigned long long)total);
	}
	add_outer(l, &tiles);
	for (uint32_t i = l->count; i-- > 0;) {
		main_progress("copying plants", l->parts[i].path, 1 - (i + 1.0) / l->count);
		for (uint32_t t = 0; t < l->parts[i].pack->scene.tile_count; t++)
			add_tile(l, &l->parts[i], t);
	}
	make_refer(m);
	make_add_up(m, tiles.node_count);
	lod_tiles_free(&tiles);
	free(items);
}

/* ---- Summaries ---- */

static void add_renamed(struct link *l, struct link_part *part, uint32_t list,
	const struct eco_list *record)
{
	const struct eco_scene *s = &part->pack->scene;
	const struct eco_list *old = &s->lists[list];
	struct eco_elements points = { 0 };
	struct eco_encoded encoded = { 0 };
	uint32_t ends[64], end = 0;
	struct eco_error why = { 0 };
	check(part, old->chunk_count <= 64 ? eco_pack_points(part->pack, list, &points, &why)
		: eco_fail(&why, ECO_DAMAGED, "list %u: a summary of %u chunks", list, old->chunk_count), &why);
	for (uint32_t i = 0; i < old->chunk_count; i++)
		ends[i] = end += s->chunks[old->chunk_first + i].element_count;
	for (uint32_t i = 0; i < points.element_count; i++) {
		int32_t *extra = points.extra + (size_t)points.extra_count * i;
		if ((uint32_t)extra[0] >= old->palette_count || (uint32_t)extra[1] >= s->plant_count)
			eco_stop(ECO_DAMAGED, "%s: list %u names a plant or a colour that is not there", part->path, list);
		extra[1] = (int32_t)part->plant_of[extra[1]];
	}
	eco_check(eco_pack_encode(&encoded, record, &points, ends, old->chunk_count, l->m.error));
	part->list_of[list] = make_add_encoded(&l->m, record, &encoded);
	eco_encoded_free(&encoded);
	eco_elements_free(&points);
}

static bool is_ours(const struct eco_list *summary)
{
	return summary->kind == ECO_LIST_POINTS && summary->coder == ECO_CODER_KD && summary->attributes
		== (ECO_ATTR_COLOR | ECO_ATTR_PLANT);
}

/* Adds the part's summaries, with their colours; plants are renumbered. */
static void part_summaries(struct link *l, struct link_part *part)
{
	const struct eco_scene *s = &part->pack->scene;
	const struct eco_list *before = NULL;        /* neighbours have one palette */
	uint32_t colors = 0;
	for (uint32_t i = 0; i < s->list_count; i++) {
		if (!(s->lists[i].attributes & ECO_ATTR_PLANT))
			continue;
		if (!is_ours(&s->lists[i]))
			eco_stop(ECO_UNSUPPORTED, "%s: list %u is a summary that ecopack did not make", part->path, i);
		struct eco_list record = s->lists[i];
		if (!before || before->palette_first != record.palette_first
				|| before->palette_count != record.palette_count)
			colors = make_add_colors(&l->m, s->palette + record.palette_first, record.palette_count);
		before = &s->lists[i];
		record.owner += part->tile_first;
		record.palette_first = colors;
		(part->renamed ? add_renamed : link_copy)(l, part, i, &record);
		((struct eco_tile *)l->m.tiles.items)[record.owner].summary = part->list_of[i];
		if (i % 256 == 0)
			main_progress("copying summaries", part->path, (double)i / s->list_count);
	}
}

static void add_summaries(struct link *l)
{
	struct make_summing summing;
	make_summing_begin(&summing, &l->m);
	for (uint32_t i = 0; i < l->count; i++) {
		part_summaries(l, &l->parts[i]);
		make_refer(&l->m);
		make_summing_keep(&summing, l->parts[i].tile_first + l->parts[i].pack->scene.root);
	}
	if (l->m.palette.count)
		make_summing_run(&summing, 0, l->parts[l->count - 1].tile_first);
	make_summing_end(&summing);
	make_refer(&l->m);
}

/* ---- META ---- */

/* Sums a count of all parts' META; it lies in objects `outer` and `inner` (NULL: none). */
static json_int_t sum_of(const struct link *l, const char *outer, const char *inner, const char *name)
{
	uint64_t sum = 0;
	for (uint32_t i = 0; i < l->count; i++) {
		const json_t *object = l->parts[i].meta;
		object = outer ? json_object_get(object, outer) : object;
		object = inner ? json_object_get(object, inner) : object;
		sum += (uint64_t)json_integer_value(json_object_get(object, name));
	}
	return (json_int_t)sum;
}

static json_t *rows_json(const struct link *l)
{
	json_t *skipped = json_object();
	for (int k = 0; k < ECO_SKIP_COUNT; k++) {
		json_int_t count = sum_of(l, "rows", "skipped", eco_skip_name(k));
		if (count)
			json_object_set_new(skipped, eco_skip_name(k), json_integer(count));
	}
	return json_pack("{s:I, s:o}", "read", sum_of(l, "rows", NULL, "read"), "skipped", skipped);
}

/* In the order of the tables: see add_tiles. */
static void say_tints(const struct link *l, json_t *meta)
{
	for (uint32_t i = l->count; i-- > 0;) {
		json_t *tint, *class;
		size_t t, c;
		json_array_foreach(json_object_get(l->parts[i].meta, "tints"), t, tint)
			json_array_foreach(json_object_get(tint, "classes"), c, class) {
				const char *column = json_string_value(json_object_get(tint, "column")),
					*name = json_string_value(json_object_get(class, "name"));
				json_t *color = json_object_get(class, "color");
				if (column && name && color)
					make_tint_say(meta, column, name, json_incref(color),
						(uint64_t)json_integer_value(json_object_get(class, "plants")));
			}
	}
}

/* A whole of which a part is a draft is one. */
static bool has_draft(const struct link *l)
{
	bool any = false;
	for (uint32_t i = 0; i < l->count; i++)
		any = any || json_is_true(json_object_get(l->parts[i].meta, "draft"));
	return any;
}

/* A text that all parts have; where they differ "first - last" in order of their bytes, or nothing. A part that was
 * linked itself may have such a range. */
static void say_common(const struct link *l, json_t *meta, const char *name, bool range)
{
	const char *low = NULL, *high = NULL;
	for (uint32_t i = 0; i < l->count; i++) {
		const char *text = json_string_value(json_object_get(l->parts[i].meta, name)), *to = text ? strstr(text, " - ") : NULL;
		if (!text)
			return;
		to = to ? to + 3 : text;
		low = low && strcmp(low, text) <= 0 ? low : text;
		high = high && strcmp(high, to) >= 0 ? high : to;
	}
	const char *end = strstr(low, " - ");
	size_t first = end ? (size_t)(end - low) : strlen(low);
	bool same = strlen(high) == first && strncmp(low, high, first) == 0;
	if (same || range)
		json_object_set_new(meta, name, same ? json_string(high) : json_sprintf("%.*s - %s", (int)first, low, high));
}

static json_t *whole_meta(const struct link *l)
{
	json_t *first = l->parts[0].meta, *order = json_object_get(first, "order");
	make_species_say(&l->m, l->plants);
	json_t *root = json_pack("{s:s, s:O*, s:s, s:O*, s:O*, s:O*, s:I, s:I, s:I, s:s, s:I, s:o, s:O}",
		"generator", "ecopack " ECO_VERSION, "order", order, "name", l->m.scene.name, "crs",
		json_object_get(first, "crs"), "origin", json_object_get(first, "origin"),
		"place", json_object_get(first, "place"), "eco_files",
		sum_of(l, NULL, NULL, "eco_files") + 1, "instances",
		(json_int_t)l->m.scene.tiles[0].instance_count, "tiles", (json_int_t)l->m.scene.tile_count,
		"ground", make_ground_origin(&l->m), "off_ground", sum_of(l, NULL, NULL, "off_ground"),
		"rows", rows_json(l), "plants", l->plants);
	say_tints(l, root);
	if (l->drawn)
		json_object_set(root, "drawn", l->drawn);
	make_columns_say(&l->m, root);
	if (has_draft(l))
		json_object_set_new(root, "draft", json_true());
	say_common(l, root, "season", false);
	say_common(l, root, "date", true);
	return root;
}

/* ---- The whole ---- */

/* A pack's name up to its first dot. */
static void name_whole(struct link *l, const char *path)
{
	const char *slash = strrchr(path, '/'), *from = slash ? slash + 1 : path;
	size_t size = eco_utf8_cut(from, strcspn(from, "."), sizeof l->m.scene.name - 1);
	snprintf(l->m.scene.name, sizeof l->m.scene.name, "%.*s", size ? (int)size : 63,
		size ? from : "linked");
	eco_utf8_tame(l->m.scene.name, "", '_');
}

static void run(void *link)
{
	struct link *l = link;
	struct make *m = &l->m;
	open_parts(l);
	make_create(m);
	link_textures(l);
	for (uint32_t i = l->count; i-- > 0;) {
		m->scene.needs |= l->parts[i].pack->scene.needs;
		link_plants(l, &l->parts[i]);
	}
	m->scene.plants = m->table;
	m->scene.plant_count = m->plant_count;
	m->scene.needs |= ECO_NEED_PLACEMENTS;
	copy_ground(l);
	add_tiles(l);
	add_summaries(l);
	lay_ground(l);
	copy_image(l);
	make_inventory_pack(m);
	name_whole(l, l->options->pack);
	make_commit(m, whole_meta(l));
}

static void link_free(struct link *l)
{
	for (uint32_t i = 0; i < l->count; i++) {
		eco_inventory_free(&l->parts[i].rows);
		eco_pack_close(l->parts[i].pack);
		json_decref(l->parts[i].meta);
		eco_free(l->parts[i].plant_of, l->parts[i].color_of, l->parts[i].list_of);
	}
	make_tables_free(&l->m);
	json_decref(l->plants);
	free(l->known);
	free(l->parts);
}

enum eco_code link_packs(const struct link_options *options, struct eco_error *error)
{
	struct eco_error own = { 0 };
	struct make_options make = { .pack = options->pack, .jobs = options->jobs };
	struct link l = { .m = { .options = &make, .error = error ? error : &own }, .options = options };
	enum eco_code code = eco_try(run, &l, l.m.error);
	main_progress_end();
	link_free(&l);
	return code;
}
