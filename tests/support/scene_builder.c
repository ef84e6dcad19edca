#include "tests/support/scene_builder.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/memory.h"
#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/pack_record.h"
#include "lod/build/ground_tree.h"
#include "tests/support/ground_tiles.h"

/* ---- Tables ---- */

/* Room for one row more: it doubles whenever their count is a power of two. */
static void *room_for(void *rows, uint64_t count, size_t size)
{
	if (count & (count - 1))
		return rows;
	rows = realloc(rows, (count ? 2 * count : 1) * size);
	if (!rows)
		abort();
	return rows;
}

#define ADD(table, counter, row) \
	(b->scene.table = b->table = room_for(b->table, b->scene.counter, sizeof *b->table), \
	b->table[b->scene.counter] = (row), b->scene.counter++)

uint32_t scene_add_plant(struct scene_builder *b, struct eco_plant row)
{
	row.anchor_first = b->scene.anchor_count;
	row.ladder_first = b->scene.ladder_count;
	row.anchor_count = row.ladder_count = 0;
	return ADD(plants, plant_count, row);
}

uint32_t scene_add_anchor(struct scene_builder *b, struct eco_anchor row)
{
	b->plants[b->scene.plant_count - 1].anchor_count++;
	return ADD(anchors, anchor_count, row);
}

uint32_t scene_add_ladder(struct scene_builder *b, struct eco_ladder row)
{
	b->plants[row.plant].ladder_count++;
	row.nothing = row.nothing.color[0][0] ? row.nothing : scene_seen(0, 2);
	return ADD(ladders, ladder_count, row);
}

const struct eco_curve scene_falling[5] = { SCENE_CURVE(0.002f, 1, 0.005f, 0.45f, 0.6f),
	SCENE_CURVE(0.02f, 1, 0.05f, 0.3f, 0.4f), SCENE_CURVE(0.1f, 1, 0.3f, 0.2f, 0.2f),
	SCENE_CURVE(0.3f, 1, 0.8f, 0.08f, 0.09f), SCENE_CURVE(1, 1, 1, 0, 0) };

struct eco_seen scene_seen(double fp, double fn)
{
	struct eco_seen seen = { .contrast = { { 0, 0 } } };
	for (uint32_t size = 0; size < ECO_SEEN_SIZES; size++) {
		seen.color[size][0] = (uint16_t)(20 / ECO_SEEN_UNIT * fn);
		seen.color[size][1] = (uint16_t)(20 / ECO_SEEN_UNIT * (fp + fn));
	}
	return seen;
}

uint32_t scene_add_curve(struct scene_builder *b, struct eco_curve row)
{
	row.seen = scene_seen((double)row.fp, (double)row.fn);
	return ADD(curves, curve_count, row);
}

uint32_t scene_add_tile(struct scene_builder *b, struct eco_tile row) { return ADD(tiles, tile_count, row); }

uint32_t scene_add_group(struct scene_builder *b, struct eco_group row)
{
	if (row.tile < b->scene.tile_count) {
		struct eco_tile *tile = &b->tiles[row.tile];
		tile->group_first = tile->group_count++ ? tile->group_first : b->scene.group_count;
	}
	if (b->lists) {
		row.count = row.count ? row.count : b->lists[row.list].primitive_count;
		b->lists[row.list].group_count++;
	}
	return ADD(groups, group_count, row);
}

uint32_t scene_add_child(struct scene_builder *b, uint32_t parent, struct eco_child row)
{
	struct eco_tile *tile = &b->tiles[parent];
	tile->child_first = tile->child_count++ ? tile->child_first : b->scene.child_count;
	return ADD(children, child_count, row);
}

uint32_t scene_add_list(struct scene_builder *b, struct eco_list row)
{
	b->elements = room_for(b->elements, b->scene.list_count, sizeof *b->elements);
	b->elements[b->scene.list_count] = (struct eco_elements){ 0 };
	b->ends = room_for(b->ends, b->scene.list_count, sizeof *b->ends);
	b->ends[b->scene.list_count] = (struct scene_ends){ NULL, 0, NULL };
	return ADD(lists, list_count, row);
}

uint32_t scene_add_chunk(struct scene_builder *b, struct eco_chunk row)
{
	b->payloads = room_for(b->payloads, b->scene.chunk_count, sizeof *b->payloads);
	b->payloads[b->scene.chunk_count] = NULL;
	return ADD(chunks, chunk_count, row);
}

uint32_t scene_add_ground(struct scene_builder *b, struct eco_ground_tile row)
{
	return ADD(ground, ground_count, row);
}

uint32_t scene_add_ground_image(struct scene_builder *b, struct eco_ground_image row)
{
	return ADD(ground_images, ground_image_count, row);
}

void scene_add_colors(struct scene_builder *b, const uint8_t (*colors)[3], uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		b->palette = room_for(b->palette, b->scene.palette_count, sizeof *b->palette);
		memcpy(b->palette[b->scene.palette_count++], colors[i], sizeof *colors);
	}
	b->scene.palette = (const uint8_t(*)[3])b->palette;
}

void scene_add_place(struct scene_builder *b, struct eco_place place)
{
	eco_record_write(&b->places, ECO_SECTION_PLACES, &place);
	b->scene.places = b->places.bytes;
	b->scene.place_count++;
}

struct eco_ladder scene_ladder(uint32_t plant, uint32_t anchor, enum eco_organ organ)
{
	return (struct eco_ladder){ .plant = plant, .anchor = anchor, .organ = (uint8_t)organ,
		.points = ECO_NONE, .lines = ECO_NONE,
		.simple = ECO_NONE, .triangles = ECO_NONE, .impostor = ECO_NONE, .importance = 1 };
}

/* ---- Lists ---- */

struct eco_list scene_list(const struct scene_builder *b, const struct scene_row *row)
{
	struct eco_list list = b->like;
	list.kind = row->kind;
	list.coder = row->coder;
	list.attributes = row->attributes;
	list.owner = row->owner;
	list.image = list.partner = ECO_NONE;
	*(row->coder == ECO_CODER_FORM ? &list.partner : &list.image) = row->other;
	list.palette_count = row->attributes & ECO_ATTR_COLOR ? list.palette_count : 0;
	return list;
}

uint32_t scene_add_made(struct scene_builder *b, struct eco_list list, struct eco_elements e)
{
	list.primitive_count = e.primitive_count;
	list.element_count = e.element_count;
	uint32_t id = scene_add_list(b, list);
	b->elements[id] = e;
	return id;
}

uint32_t scene_add_rows(struct scene_builder *b, const struct scene_row *rows, uint32_t count)
{
	uint32_t first = b->scene.list_count;
	for (uint32_t i = 0; i < count; i++) {
		scene_add_list(b, scene_list(b, &rows[i]));
		if (rows[i].count)
			scene_elements(b, first + i, rows[i].count, rows[i].corners);
	}
	return first;
}

struct eco_elements elements_make(const struct eco_list *list, uint32_t count, uint8_t corners)
{
	struct eco_elements e = { .element_count = count, .corner_count = count * corners,
		.primitive_count = corners < 3 ? count : count * (corners - 2u),
		.extra_count = eco_list_extra_count(list) };
	e.corners = malloc(count);
	e.position = calloc(3 * (size_t)e.corner_count, sizeof *e.position);
	e.uv = list->attributes & ECO_ATTR_UV ? calloc(2 * (size_t)e.corner_count, sizeof *e.uv) : NULL;
	e.extra = e.extra_count ? calloc((size_t)e.extra_count * count, sizeof *e.extra) : NULL;
	memset(e.corners, corners, count);
	return e;
}

void scene_elements(struct scene_builder *b, uint32_t list, uint32_t count, uint8_t corners)
{
	b->elements[list] = elements_make(&b->lists[list], count, corners);
}

uint32_t scene_add_bare(struct scene_builder *b, const struct scene_row *row, uint32_t primitives,
	uint32_t elements)
{
	struct eco_list list = scene_list(b, row);
	list.primitive_count = primitives;
	list.element_count = elements;
	list.chunk_count = 1;
	list.chunk_first =
		scene_add_chunk(b,
		(struct eco_chunk){ .size_bytes = 8 * elements, .primitive_count = primitives,
		.element_count = elements });
	return scene_add_list(b, list);
}

void scene_add_instances(struct scene_builder *b, uint32_t list, uint32_t plant)
{
	const struct eco_elements *e = &b->elements[list];
	scene_add_group(b, (struct eco_group){ b->lists[list].owner, plant, list,
		b->scene.place_count, 0, e->element_count });
	for (uint32_t i = 0; i < e->element_count; i++)
		scene_add_place(b, eco_place_of(&b->lists[list], e, i));
}

enum eco_code scene_add_heights(struct scene_builder *b, const struct eco_ground *ground,
	struct eco_error *error)
{
	struct lod_ground_tree tree;
	enum eco_code code = lod_ground_build(&tree, ground, GROUND_TILES_STEP_M, GROUND_TILES_STEP_M, error);
	for (uint32_t i = 0; i < tree.count && !code; i++) {
		tree.tiles[i].list = scene_add_list(b, ground_list(ground, &tree.tiles[i]));
		b->elements[tree.tiles[i].list] = ground_elements(ground, &tree.tiles[i], tree.shifts[i]);
		scene_add_ground(b, tree.tiles[i]);
	}
	b->scene.ground_columns = ground->columns;
	b->scene.ground_rows = ground->rows;
	lod_ground_tree_free(&tree);
	return code;
}

/* ---- Chunks ---- */

static void *copy_of(const void *rows, size_t size)
{
	void *copy = malloc(size + 1);
	if (!copy)
		abort();
	return size ? memcpy(copy, rows, size) : copy;
}

static struct scene_ends ends_of(const struct scene_builder *b, uint32_t id)
{
	static uint32_t ends[SCENE_CHUNKS_MAX];
	const struct eco_list *list = &b->lists[id];
	uint32_t count = b->elements[list->coder == ECO_CODER_FORM ? list->partner : id].element_count;
	if (b->ends[id].count)
		return b->ends[id];
	ends[0] = count;
	return (struct scene_ends){ ends, b->split && list->kind != ECO_LIST_GROUND ? b->split(count, ends)
		: 1, NULL };
}

static void put_chunk(struct scene_builder *b, uint32_t list, uint8_t *payload, size_t size,
	uint32_t primitives, uint32_t elements)
{
	uint32_t id =
		scene_add_chunk(b, (struct eco_chunk){ eco_chunk_hash(payload, size), 0, (uint32_t)size,
		primitives, elements });
	b->payloads[id] = payload;
	b->lists[list].chunk_count++;
	b->lists[list].primitive_count += primitives;
	b->lists[list].element_count += elements;
}

static void encode_list(struct scene_builder *b, uint32_t id)
{
	const struct eco_list *list = &b->lists[id];
	const struct eco_elements *e = &b->elements[id];
	struct scene_ends ends = ends_of(b, id);
	uint32_t like = list->coder == ECO_CODER_FORM ? list->partner : id;
	for (uint32_t i = 0; i < ends.count; i++) {
		struct eco_chunk_input input = { &b->lists[like], &b->elements[like], i ? ends.ends[i - 1]
			: 0, ends.ends[i], i };
		uint32_t elements = ends.ends[i] - input.first;
		uint8_t *payload;
		size_t size;
		if (like == id ? eco_chunk_encode(&input, &payload, &size, NULL)
				: eco_chunk_encode_form(&input, list, e, &payload, &size, NULL))
			abort();
		put_chunk(b, id, payload, size, e->corners[0] > 2 ? elements * (e->corners[0] - 2u)
			: elements, elements);
	}
}

static const struct eco_bytes *levels_of(const struct scene_builder *b, uint32_t id)
{
	uint8_t kind = b->lists[id].kind;
	return kind == ECO_LIST_IMAGE ? b->texture[0] : kind == ECO_LIST_OUTLINE ? b->texture[1] : NULL;
}

void scene_encode(struct scene_builder *b)
{
	for (uint32_t id = 0; id < b->scene.list_count; id++) {
		b->lists[id].chunk_first = b->scene.chunk_count;
		b->lists[id].chunk_count = b->lists[id].primitive_count = b->lists[id].element_count = 0;
		if (b->lists[id].coder != ECO_CODER_BYTES)
			encode_list(b, id);
		else if (levels_of(b, id))
			scene_add_files(b, id, levels_of(b, id), b->texture_levels);
	}
}

void scene_add_files(struct scene_builder *b, uint32_t list, const struct eco_bytes *files, uint32_t count)
{
	b->lists[list].chunk_first = b->scene.chunk_count;
	for (uint32_t i = 0; i < count; i++)
		put_chunk(b, list, copy_of(files[i].at, files[i].size), files[i].size, 1, 1);
}

struct writing { struct scene_builder *builder; struct eco_pack_writer *writer; };

static void write_lists(void *ctx)
{
	struct writing *writing = ctx;
	struct scene_builder *b = writing->builder;
	for (uint32_t id = 0; id < b->scene.list_count; id++) {
		const struct eco_list *list = &b->lists[id];
		struct scene_ends ends = ends_of(b, id);
		if (list->kind == ECO_LIST_IMAGE || list->kind == ECO_LIST_OUTLINE)
			eco_pack_add_bytes(writing->writer, list, levels_of(b, id), b->texture_levels);
		else if (list->kind == ECO_LIST_IMPOSTOR || list->kind == ECO_LIST_GROUND_IMAGE
				|| list->kind == ECO_LIST_INVENTORY)
			eco_pack_add_bytes(writing->writer, list, ends.files, ends.count);
		else
			eco_pack_add_list(writing->writer, list, &b->elements[id], ends.ends, ends.count,
				list->coder == ECO_CODER_FORM ? &b->elements[list->partner] : NULL);
	}
}

enum eco_code scene_write(struct scene_builder *b, const char *path, const char *meta,
	struct eco_pack_writer **keep, struct eco_error *error)
{
	struct writing writing = { b, NULL };
	enum eco_code code = eco_pack_create(&writing.writer, path, error);
	code = code ? code : eco_try(write_lists, &writing, error);
	if (code)
		eco_pack_abort(writing.writer);
	else if (keep)
		*keep = writing.writer;
	else
		code = eco_pack_commit(writing.writer, &b->scene, meta, error);
	return code;
}

void scene_copy(struct scene_builder *b, const struct eco_scene *scene)
{
	*b = (struct scene_builder){ .scene = *scene };
#define COPY(table, counter) b->scene.table = b->table = \
	copy_of(scene->table, scene->counter * sizeof *scene->table)
	COPY(plants, plant_count);
	COPY(anchors, anchor_count);
	COPY(ladders, ladder_count);
	COPY(curves, curve_count);
	COPY(tiles, tile_count);
	COPY(groups, group_count);
	COPY(children, child_count);
	COPY(lists, list_count);
	COPY(chunks, chunk_count);
	COPY(ground, ground_count);
	COPY(ground_images, ground_image_count);
#undef COPY
}

void scene_free(struct scene_builder *b)
{
	void *tables[] = { b->plants, b->anchors, b->ladders, b->curves, b->tiles, b->groups, b->children,
		b->lists, b->chunks, b->ground, b->ground_images, b->palette, b->elements, b->ends,
		b->payloads };
	for (uint32_t i = 0; i < b->scene.list_count && b->elements; i++)
		eco_elements_free(&b->elements[i]);
	for (uint32_t i = 0; i < b->scene.chunk_count && b->payloads; i++)
		free(b->payloads[i]);
	for (size_t i = 0; i < sizeof tables / sizeof *tables; i++)
		free(tables[i]);
	eco_writer_free(&b->places);
	*b = (struct scene_builder){ 0 };
}

uint32_t lcg_bits(uint64_t *state)
{
	*state = *state * 6364136223846793005u + 1442695040888963407u;
	return (uint32_t)(*state >> 33);
}
