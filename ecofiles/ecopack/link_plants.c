/* Plants of parts. A hash of its records and of its chunks' hashes identifies a plant, so that parts that
 * share it store it once, wherever its files lay when the parts were built. */
#include "ecofiles/ecopack/link.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/base/memory.h"
#include "ecofiles/base/text.h"
#include "ecofiles/ecopack/make.h"
#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/pack_record.h"

struct range { uint32_t first, end; };

static bool of_plant(const struct eco_list *list, uint32_t plant)
{
	return list->owner == plant && list->kind != ECO_LIST_INSTANCES && list->kind != ECO_LIST_GROUND
		&& !eco_list_has_texels(list) && !(list->attributes & ECO_ATTR_PLANT);
}

/* A plant's colours are adjacent. */
static struct range colors_of(const struct eco_scene *s, uint32_t plant)
{
	struct range range = { s->palette_count, s->palette_count };
	uint32_t last = 0;           /* colours of summaries follow */
	for (uint32_t i = 0; i < s->list_count; i++) {
		const struct eco_list *list = &s->lists[i];
		bool plants = list->owner != ECO_NONE && of_plant(list, list->owner) && list->palette_count
			> 0;
		if (plants && list->palette_first + list->palette_count > last)
			last = list->palette_first + list->palette_count;
		if (plants && list->owner == plant && list->palette_first < range.first)
			range.first = list->palette_first;
		else if (plants && list->owner > plant && list->palette_first < range.end)
			range.end = list->palette_first;
	}
	range.end = range.end < last ? range.end : last;
	return range.first < range.end ? range : (struct range){ range.end, range.end };
}

static void write_ladder(struct eco_writer *w, const struct eco_scene *s, uint32_t plant,
	const struct eco_ladder *ladder, uint32_t list_first)
{
	struct eco_ladder l = *ladder;
	uint32_t *const lists[] = { &l.points, &l.lines, &l.simple, &l.impostor, &l.triangles };
	for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
		*lists[i] -= *lists[i] == ECO_NONE ? 0 : list_first;
	l.plant = l.curve_first = 0;
	l.anchor -= s->plants[plant].anchor_first;
	eco_record_write(w, ECO_SECTION_LADDERS, &l);
	for (uint32_t i = 0; i < eco_ladder_samples(ladder); i++)
		eco_record_write(w, ECO_SECTION_CURVES, &s->curves[ladder->curve_first + i]);
}

/* Textures are linked before and have the whole's numbers. */
static void write_list(struct eco_writer *w, const struct link_part *part, const struct eco_list *list,
	uint32_t list_first, uint32_t color_first)
{
	struct eco_list l = *list;
	l.owner = 0;
	l.palette_first -= l.palette_count ? color_first : 0;
	l.image = l.image == ECO_NONE ? ECO_NONE : part->list_of[l.image];
	l.partner -= l.partner == ECO_NONE ? 0 : list_first;
	l.chunk_first = 0;
	eco_record_write(w, ECO_SECTION_LISTS, &l);
	for (uint32_t i = list->chunk_first; i < list->chunk_first + list->chunk_count; i++)
		eco_write_bytes(w, part->pack->scene.chunks[i].id.bytes, sizeof(struct eco_chunk_id));
}

/* Hashes everything of a plant, with numbers relative to its own first ones. */
static struct eco_chunk_id fingerprint(const struct link_part *part, uint32_t plant, const struct range *colors)
{
	const struct eco_scene *s = &part->pack->scene;
	struct eco_writer w = { 0 };
	struct eco_plant p = s->plants[plant];
	uint32_t list_first = ECO_NONE;
	memset(p.name, 0, sizeof p.name);
	p.anchor_first = p.ladder_first = 0;
	eco_record_write(&w, ECO_SECTION_PLANTS, &p);
	for (uint32_t i = 0; i < p.anchor_count; i++)
		eco_record_write(&w, ECO_SECTION_ANCHORS, &s->anchors[s->plants[plant].anchor_first + i]);
	for (uint32_t i = 0; i < s->list_count; i++) {
		if (!of_plant(&s->lists[i], plant))
			continue;
		list_first = list_first == ECO_NONE ? i : list_first;
		write_list(&w, part, &s->lists[i], list_first, colors->first);
	}
	for (uint32_t i = 0; i < p.ladder_count; i++)
		write_ladder(&w, s, plant, &s->ladders[s->plants[plant].ladder_first + i], list_first);
	eco_write_bytes(&w, s->palette + colors->first, 3 * (size_t)(colors->end - colors->first));
	if (w.failed)
		eco_end("no memory");
	struct eco_chunk_id id = eco_chunk_hash(w.bytes, w.size);
	eco_writer_free(&w);
	return id;
}

/* Different plants should have different names. */
static void name_plant(struct link *l, struct eco_plant *plant)
{
	char name[sizeof plant->name];
	memcpy(name, plant->name, sizeof name);
	for (uint32_t i = 0; i < l->m.plant_count; i++)
		if (strcmp(l->m.table[i].name, name) == 0) {
			snprintf(plant->name, sizeof plant->name, "%.*s#%u",
				(int)eco_utf8_cut(name, strlen(name), 52), name, l->m.plant_count);
			return;
		}
}

static void copy_colors(struct link *l, struct link_part *part, const struct range *range)
{
	for (uint32_t i = range->first; i < range->end; i++) {
		make_add(&l->m.palette, part->pack->scene.palette[i], 1, 3);
		part->color_of[i] = (uint32_t)l->m.palette.count - 1;
	}
}

/* Ladders of a plant may share curves; all of them are adjacent. */
static struct range curves_of(const struct eco_scene *s, uint32_t plant)
{
	struct range range = { s->curve_count, 0 };
	for (uint32_t i = 0; i < s->plants[plant].ladder_count; i++) {
		const struct eco_ladder *l = &s->ladders[s->plants[plant].ladder_first + i];
		if (l->curve_count == 0)
			continue;
		range.first = l->curve_first < range.first ? l->curve_first : range.first;
		uint32_t end = l->curve_first + eco_ladder_samples(l);
		range.end = end > range.end ? end : range.end;
	}
	return range.first < range.end ? range : (struct range){ 0, 0 };
}

static void copy_tables(struct link *l, struct link_part *part, uint32_t plant)
{
	const struct eco_scene *s = &part->pack->scene;
	struct make *m = &l->m;
	struct eco_plant *whole = &m->table[m->plant_count];
	*whole = s->plants[plant];
	name_plant(l, whole);
	const struct eco_plant *from = &s->plants[plant];
	struct range curves = curves_of(s, plant);
	make_add_plant(m, m->plant_count, &(struct make_tables){
		.anchors = s->anchors + from->anchor_first, .anchor_first = from->anchor_first,
		.curves = s->curves + curves.first, .curve_first = curves.first,
		.curve_count = curves.end - curves.first, .ladders = s->ladders + from->ladder_first,
		.ladder_count = from->ladder_count }, part->list_of);
}

static void keep_meta(struct link *l, struct link_part *part, uint32_t plant)
{
	json_t *old = json_array_get(json_object_get(part->meta, "plants"), plant),
		*copy = json_is_object(old) ? json_deep_copy(old) : json_object();
	if (json_is_object(old))
		json_object_set_new(copy, "name", json_string(l->m.table[l->m.plant_count].name));
	json_array_append_new(l->plants, copy);
}

static void copy_plant(struct link *l, struct link_part *part, uint32_t plant, const struct range *colors)
{
	const struct eco_scene *s = &part->pack->scene;
	copy_colors(l, part, colors);
	for (uint32_t i = 0; i < s->list_count; i++) {
		if (!of_plant(&s->lists[i], plant))
			continue;
		struct eco_list record = link_list(part, i);
		record.owner = l->m.plant_count;
		link_copy(l, part, i, &record);
	}
	copy_tables(l, part, plant);
	keep_meta(l, part, plant);
	l->m.plant_count++;
}

void link_plants(struct link *l, struct link_part *part)
{
	const struct eco_scene *s = &part->pack->scene;
	for (uint32_t plant = 0; plant < s->plant_count; plant++) {
		struct range colors = colors_of(s, plant);
		struct eco_chunk_id id = fingerprint(part, plant, &colors);
		uint32_t same = 0, first = (uint32_t)l->m.palette.count;
		while (same < l->m.plant_count && memcmp(&l->known[same].id, &id, sizeof id) != 0)
			same++;
		part->plant_of[plant] = same;
		if (same == l->m.plant_count) {
			l->known[same].id = id;
			copy_plant(l, part, plant, &colors);
		} else {
			first = l->m.plants[same].palette_first;
			for (uint32_t i = colors.first; i < colors.end; i++)
				part->color_of[i] = first + i - colors.first;
		}
		l->m.plants[same].palette_first = first;
		part->renamed = part->renamed || same != plant;
	}
}

/* ---- Textures ---- */

/* Textures of parts, in the order in which plants of a full build would show them. */

/* A hash of each level's chunks. */
static void hash_levels(const struct eco_scene *s, const struct eco_list *list, struct eco_chunk_id *levels)
{
	struct eco_chunk_id all[2] = { 0 };
	for (uint32_t i = list->chunk_first, k = 0; i < list->chunk_first + list->chunk_count; i++) {
		all[1] = s->chunks[i].id;
		levels[k] = all[0] = eco_chunk_hash((const uint8_t *)all, sizeof all);
		k += s->chunks[i].primitive_count;
	}
}

static struct make_texture describe_texture(struct link_part *part, uint32_t list)
{
	const struct eco_scene *s = &part->pack->scene;
	const struct eco_list *image = &s->lists[list],
		*outline = image->image == ECO_NONE ? NULL : &s->lists[image->image];
	struct make_texture t = { .count = image->primitive_count, .outlined = outline,
		.texel_area = image->unit_area, .from = part, .list = list };
	hash_levels(s, image, t.colors);
	if (outline)
		hash_levels(s, outline, t.outlines);
	return t;
}

/* part->list_of is for now where a texture is in l->m.textures. */
static void find_textures(struct link *l, struct link_part *part)
{
	const struct eco_scene *s = &part->pack->scene;
	for (uint32_t i = 0; i < s->list_count; i++)
		if (s->lists[i].kind == ECO_LIST_IMAGE) {
			struct make_texture texture = describe_texture(part, i);
			part->list_of[i] = make_share_texture(&l->m, &texture);
		}
}

static void copy(struct link *l, uint32_t id)
{
	struct make_texture *shared = (struct make_texture *)l->m.textures.items + id;
	struct link_part *part = shared->from;
	uint32_t image = shared->list, outline = part->pack->scene.lists[image].image;
	const uint32_t lists[] = { outline, image };
	for (int i = outline == ECO_NONE; i < 2; i++) {
		struct eco_list record = link_list(part, lists[i]);
		record.owner = ECO_NONE;
		record.unit_area = shared->texel_area;
		link_copy(l, part, lists[i], &record);
	}
	shared->list = part->list_of[image];
	part->list_of[image] = id;
}

static void refer(const struct link *l, struct link_part *part)
{
	const struct eco_scene *s = &part->pack->scene;
	const struct make_texture *all = l->m.textures.items;
	for (uint32_t i = 0; i < s->list_count; i++)
		if (s->lists[i].kind == ECO_LIST_IMAGE)
			part->list_of[i] = all[part->list_of[i]].list;
}

void link_textures(struct link *l)
{
	for (uint32_t i = l->count; i-- > 0;)
		find_textures(l, &l->parts[i]);
	for (uint32_t i = 0; i < l->m.textures.count; i++)
		copy(l, i);
	for (uint32_t i = 0; i < l->count; i++)
		refer(l, &l->parts[i]);
}
