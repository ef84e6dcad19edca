/* Each record field by field, in the order of the structs of pack.h and list.h: this file defines the
 * bytes. */
#include "ecofiles/format/pack_record.h"

#include <assert.h>
#include <string.h>

const struct eco_section_info eco_section_info[ECO_SECTION_KIND_END] = {
	[0] = { "none", 0 },
	[ECO_SECTION_META] = { "META", 0 },
	[ECO_SECTION_SCENE] = { "SCENE", 88 },
	[ECO_SECTION_PLANTS] = { "PLANTS", 92 },
	[ECO_SECTION_ANCHORS] = { "ANCHORS", 16 },
	[ECO_SECTION_LADDERS] = { "LADDERS", 84 },
	[ECO_SECTION_CURVES] = { "CURVES", 20 },
	[ECO_SECTION_TILES] = { "TILES", 84 },
	[ECO_SECTION_GROUPS] = { "GROUPS", 20 },
	[ECO_SECTION_CHILDREN] = { "CHILDREN", 40 },
	[ECO_SECTION_LISTS] = { "LISTS", 100 },
	[ECO_SECTION_CHUNKS] = { "CHUNKS", 36 },
	[ECO_SECTION_PALETTE] = { "PALETTE", 3 },
	[ECO_SECTION_PLACES] = { "PLACES", ECO_PLACE_BYTES },
	[ECO_SECTION_GROUND] = { "GROUND", 32 },
	[ECO_SECTION_CHUNK_DATA] = { "CHUNK_DATA", 0 },
};

static void write_zeros(struct eco_writer *w, unsigned count)
{
	while (count-- > 0)
		eco_write_u8(w, 0);
}

static void read_zeros(struct eco_reader *r, unsigned count)
{
	while (count-- > 0)
		if (eco_read_u8(r) != 0)
			r->failed = true;
}

static void write_f64s(struct eco_writer *w, const double *v, unsigned count)
{
	for (unsigned i = 0; i < count; i++)
		eco_write_f64(w, v[i]);
}

static void read_f64s(struct eco_reader *r, double *v, unsigned count)
{
	for (unsigned i = 0; i < count; i++)
		v[i] = eco_read_f64(r);
}

static void write_u32s(struct eco_writer *w, const uint32_t *v, unsigned count)
{
	for (unsigned i = 0; i < count; i++)
		eco_write_u32(w, v[i]);
}

static void read_u32s(struct eco_reader *r, uint32_t *v, unsigned count)
{
	for (unsigned i = 0; i < count; i++)
		v[i] = eco_read_u32(r);
}

/* Names are filled up with zeros, so that equal scenes are equal bytes. */
static void write_name(struct eco_writer *w, const char *name, size_t size)
{
	size_t length = strnlen(name, size - 1);
	eco_write_bytes(w, name, length);
	write_zeros(w, (unsigned)(size - length));
}

static void read_name(struct eco_reader *r, char *name, size_t size)
{
	const uint8_t *bytes = eco_read_bytes(r, size);
	size_t length;
	memset(name, 0, size);
	if (!bytes)
		return;
	length = strnlen((const char *)bytes, size);
	for (size_t i = length; i < size; i++)
		if (bytes[i] != 0)
			r->failed = true;
	if (length == size)
		r->failed = true;
	else
		memcpy(name, bytes, length);
}

void eco_section_write(struct eco_writer *w, const struct eco_section *section)
{
	eco_write_u32(w, section->kind);
	eco_write_u32(w, section->count);
	eco_write_u64(w, section->offset);
	eco_write_u64(w, section->size);
	eco_write_u64(w, section->hash);
	eco_write_u32(w, section->record_bytes);
	eco_write_u32(w, 0);
}

bool eco_section_read(struct eco_reader *r, struct eco_section *section)
{
	section->kind = eco_read_u32(r);
	section->count = eco_read_u32(r);
	section->offset = eco_read_u64(r);
	section->size = eco_read_u64(r);
	section->hash = eco_read_u64(r);
	section->record_bytes = eco_read_u32(r);
	return eco_read_u32(r) == 0 && !r->failed;
}

void eco_scene_write(struct eco_writer *w, const struct eco_scene *scene)
{
	write_name(w, scene->name, sizeof scene->name);
	eco_write_u32(w, scene->needs);
	eco_write_u32(w, scene->root);
	eco_write_u32(w, scene->ground_columns);
	eco_write_u32(w, scene->ground_rows);
	eco_write_f64(w, scene->near_m);
}

void eco_scene_read(struct eco_reader *r, struct eco_scene *scene)
{
	read_name(r, scene->name, sizeof scene->name);
	scene->needs = eco_read_u32(r);
	scene->root = eco_read_u32(r);
	scene->ground_columns = eco_read_u32(r);
	scene->ground_rows = eco_read_u32(r);
	scene->near_m = eco_read_f64(r);
}

void eco_plant_write(struct eco_writer *w, const struct eco_plant *plant)
{
	write_name(w, plant->name, sizeof plant->name);
	eco_write_f32(w, plant->height_m);
	eco_write_u32(w, plant->anchor_first);
	eco_write_u32(w, plant->anchor_count);
	eco_write_u32(w, plant->ladder_first);
	eco_write_u32(w, plant->ladder_count);
	eco_write_f32(w, plant->area);
	eco_write_u32(w, plant->triangles);
}

void eco_plant_read(struct eco_reader *r, struct eco_plant *plant)
{
	read_name(r, plant->name, sizeof plant->name);
	plant->height_m = eco_read_f32(r);
	plant->anchor_first = eco_read_u32(r);
	plant->anchor_count = eco_read_u32(r);
	plant->ladder_first = eco_read_u32(r);
	plant->ladder_count = eco_read_u32(r);
	plant->area = eco_read_f32(r);
	plant->triangles = eco_read_u32(r);
}

void eco_anchor_write(struct eco_writer *w, const struct eco_anchor *anchor)
{
	for (unsigned i = 0; i < 3; i++)
		eco_write_f32(w, anchor->center[i]);
	eco_write_f32(w, anchor->radius);
}

void eco_anchor_read(struct eco_reader *r, struct eco_anchor *anchor)
{
	for (unsigned i = 0; i < 3; i++)
		anchor->center[i] = eco_read_f32(r);
	anchor->radius = eco_read_f32(r);
}

void eco_ladder_write(struct eco_writer *w, const struct eco_ladder *ladder)
{
	eco_write_u32(w, ladder->plant);
	eco_write_u32(w, ladder->anchor);
	eco_write_u8(w, ladder->organ);
	eco_write_u8(w, ladder->flags);
	eco_write_u8(w, ladder->level_count);
	write_zeros(w, 1);
	eco_write_u32(w, ladder->points);
	eco_write_u32(w, ladder->lines);
	eco_write_u32(w, ladder->simple);
	eco_write_u32(w, ladder->triangles);
	write_u32s(w, ladder->level_end, ECO_LEVELS_MAX);
	eco_write_u32(w, ladder->total);
	eco_write_u32(w, ladder->before);
	eco_write_f32(w, ladder->importance);
	eco_write_f32(w, ladder->area);
	eco_write_f32(w, ladder->length);
	eco_write_f32(w, ladder->epsilon);
	eco_write_u32(w, ladder->curve_first);
	eco_write_u32(w, ladder->curve_count);
}

void eco_ladder_read(struct eco_reader *r, struct eco_ladder *ladder)
{
	ladder->plant = eco_read_u32(r);
	ladder->anchor = eco_read_u32(r);
	ladder->organ = eco_read_u8(r);
	ladder->flags = eco_read_u8(r);
	ladder->level_count = eco_read_u8(r);
	ladder->reserved = 0;
	read_zeros(r, 1);
	ladder->points = eco_read_u32(r);
	ladder->lines = eco_read_u32(r);
	ladder->simple = eco_read_u32(r);
	ladder->triangles = eco_read_u32(r);
	read_u32s(r, ladder->level_end, ECO_LEVELS_MAX);
	ladder->total = eco_read_u32(r);
	ladder->before = eco_read_u32(r);
	ladder->importance = eco_read_f32(r);
	ladder->area = eco_read_f32(r);
	ladder->length = eco_read_f32(r);
	ladder->epsilon = eco_read_f32(r);
	ladder->curve_first = eco_read_u32(r);
	ladder->curve_count = eco_read_u32(r);
}

void eco_curve_write(struct eco_writer *w, const struct eco_curve *curve)
{
	eco_write_f32(w, curve->share);
	eco_write_f32(w, curve->scale);
	eco_write_f32(w, curve->reach);
	eco_write_f32(w, curve->fp);
	eco_write_f32(w, curve->fn);
}

void eco_curve_read(struct eco_reader *r, struct eco_curve *curve)
{
	curve->share = eco_read_f32(r);
	curve->scale = eco_read_f32(r);
	curve->reach = eco_read_f32(r);
	curve->fp = eco_read_f32(r);
	curve->fn = eco_read_f32(r);
}

void eco_tile_write(struct eco_writer *w, const struct eco_tile *tile)
{
	write_f64s(w, tile->low, 3);
	write_f64s(w, tile->high, 3);
	eco_write_f64(w, tile->area);
	eco_write_u64(w, tile->instance_count);
	eco_write_u32(w, tile->summary);
	eco_write_u32(w, tile->group_first);
	eco_write_u32(w, tile->group_count);
	eco_write_u32(w, tile->child_first);
	eco_write_u32(w, tile->child_count);
}

void eco_tile_read(struct eco_reader *r, struct eco_tile *tile)
{
	read_f64s(r, tile->low, 3);
	read_f64s(r, tile->high, 3);
	tile->area = eco_read_f64(r);
	tile->instance_count = eco_read_u64(r);
	tile->summary = eco_read_u32(r);
	tile->group_first = eco_read_u32(r);
	tile->group_count = eco_read_u32(r);
	tile->child_first = eco_read_u32(r);
	tile->child_count = eco_read_u32(r);
}

void eco_ground_tile_write(struct eco_writer *w, const struct eco_ground_tile *tile)
{
	eco_write_u32(w, tile->list);
	eco_write_u32(w, tile->column);
	eco_write_u32(w, tile->row);
	eco_write_u8(w, tile->level);
	eco_write_u8(w, tile->child_count);
	write_zeros(w, 2);
	eco_write_u32(w, tile->child_first);
	eco_write_f32(w, tile->error_m);
	eco_write_f32(w, tile->low_m);
	eco_write_f32(w, tile->high_m);
}

void eco_ground_tile_read(struct eco_reader *r, struct eco_ground_tile *tile)
{
	tile->list = eco_read_u32(r);
	tile->column = eco_read_u32(r);
	tile->row = eco_read_u32(r);
	tile->level = eco_read_u8(r);
	tile->child_count = eco_read_u8(r);
	read_zeros(r, 2);
	tile->child_first = eco_read_u32(r);
	tile->error_m = eco_read_f32(r);
	tile->low_m = eco_read_f32(r);
	tile->high_m = eco_read_f32(r);
}

void eco_group_write(struct eco_writer *w, const struct eco_group *group)
{
	eco_write_u32(w, group->tile);
	eco_write_u32(w, group->plant);
	eco_write_u32(w, group->list);
	eco_write_u64(w, group->place_first);
}

void eco_group_read(struct eco_reader *r, struct eco_group *group)
{
	group->tile = eco_read_u32(r);
	group->plant = eco_read_u32(r);
	group->list = eco_read_u32(r);
	group->place_first = eco_read_u64(r);
}

void eco_child_write(struct eco_writer *w, const struct eco_child *child)
{
	eco_write_u32(w, child->tile);
	eco_write_u8(w, child->placed);
	write_zeros(w, 3);
	write_f64s(w, child->at, 3);
	eco_write_u16(w, child->turn);
	write_zeros(w, 2);
	eco_write_f32(w, child->scale);
}

void eco_child_read(struct eco_reader *r, struct eco_child *child)
{
	uint8_t placed;
	child->tile = eco_read_u32(r);
	placed = eco_read_u8(r);
	if (placed > 1)
		r->failed = true;
	child->placed = placed != 0;
	read_zeros(r, 3);
	read_f64s(r, child->at, 3);
	child->turn = eco_read_u16(r);
	read_zeros(r, 2);
	child->scale = eco_read_f32(r);
}

void eco_list_write(struct eco_writer *w, const struct eco_list *list)
{
	eco_write_u8(w, list->kind);
	eco_write_u8(w, list->coder);
	eco_write_u8(w, list->attributes);
	eco_write_u8(w, list->level);
	eco_write_u32(w, list->owner);
	eco_write_u32(w, list->plant);
	write_f64s(w, list->grid_origin, 3);
	write_f64s(w, list->grid_step, 3);
	eco_write_f32(w, list->unit_area);
	eco_write_u32(w, list->palette_first);
	eco_write_u32(w, list->palette_count);
	eco_write_u32(w, list->image);
	eco_write_u32(w, list->partner);
	eco_write_u32(w, list->columns);
	eco_write_u32(w, list->primitive_count);
	eco_write_u32(w, list->element_count);
	eco_write_u32(w, list->chunk_first);
	eco_write_u32(w, list->chunk_count);
}

void eco_list_read(struct eco_reader *r, struct eco_list *list)
{
	list->kind = eco_read_u8(r);
	list->coder = eco_read_u8(r);
	list->attributes = eco_read_u8(r);
	list->level = eco_read_u8(r);
	list->owner = eco_read_u32(r);
	list->plant = eco_read_u32(r);
	read_f64s(r, list->grid_origin, 3);
	read_f64s(r, list->grid_step, 3);
	list->unit_area = eco_read_f32(r);
	list->palette_first = eco_read_u32(r);
	list->palette_count = eco_read_u32(r);
	list->image = eco_read_u32(r);
	list->partner = eco_read_u32(r);
	list->columns = eco_read_u32(r);
	list->primitive_count = eco_read_u32(r);
	list->element_count = eco_read_u32(r);
	list->chunk_first = eco_read_u32(r);
	list->chunk_count = eco_read_u32(r);
}

void eco_chunk_write(struct eco_writer *w, const struct eco_chunk *chunk)
{
	eco_write_bytes(w, chunk->id.bytes, sizeof chunk->id.bytes);
	eco_write_u64(w, chunk->offset);
	eco_write_u32(w, chunk->size_bytes);
	eco_write_u32(w, chunk->primitive_count);
	eco_write_u32(w, chunk->element_count);
}

void eco_chunk_read(struct eco_reader *r, struct eco_chunk *chunk)
{
	const uint8_t *id = eco_read_bytes(r, sizeof chunk->id.bytes);
	if (id)
		memcpy(chunk->id.bytes, id, sizeof chunk->id.bytes);
	chunk->offset = eco_read_u64(r);
	chunk->size_bytes = eco_read_u32(r);
	chunk->primitive_count = eco_read_u32(r);
	chunk->element_count = eco_read_u32(r);
}

void eco_place_write(struct eco_writer *w, const struct eco_place *place)
{
	for (unsigned i = 0; i < 3; i++)
		eco_write_u32(w, (uint32_t)place->position[i]);
	eco_write_u16(w, place->turn);
	write_zeros(w, 2);
	eco_write_u32(w, place->scale);
}

struct eco_place eco_place_read(const struct eco_scene *scene, uint64_t index)
{
	const uint8_t *p;
	uint32_t word[5];
	assert(index < scene->place_count);
	p = scene->places + index * ECO_PLACE_BYTES;
	for (unsigned i = 0; i < 5; i++)
		word[i] = (uint32_t)p[4 * i] | (uint32_t)p[4 * i + 1] << 8 | (uint32_t)p[4 * i + 2] << 16
			| (uint32_t)p[4 * i + 3] << 24;
	return (struct eco_place){
		.position = { (int32_t)word[0], (int32_t)word[1], (int32_t)word[2] },
		.turn = (uint16_t)word[3],
		.scale = word[4],
	};
}
