/* A small pack with every table and every kind of list, for tests and fuzz targets of what reads packs: one plant with a cell, leaves
 * in three forms, wood in two levels, a texture, ground, a summary, instances in a tile of a nested eco file. */
#ifndef TESTS_SCENE_PACK_H
#define TESTS_SCENE_PACK_H

#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/format/chunk.h"
#include "ecofiles/format/ground_tile.h"
#include "ecofiles/format/pack.h"

struct scene_pack {
	struct eco_scene scene;
	struct eco_plant plant;
	struct eco_anchor anchors[2];
	struct eco_ladder ladders[4];
	struct eco_curve curves[3];
	struct eco_tile tiles[2];
	struct eco_group group;
	struct eco_child child;
	struct eco_ground_tile ground[3];
	uint8_t palette[4][3];
	struct eco_writer places;
};

#define SCENE_PACK_PLANTS 7u
#define SCENE_PACK_QUADS 40u
#define SCENE_PACK_GROUND 3u
#define SCENE_PACK_SIMPLE 11u            /* id of the leaves as triangles */

static inline struct eco_list scene_pack_list(uint8_t kind, uint8_t coder, uint8_t attributes, uint32_t owner)
{
	return (struct eco_list){ .kind = kind, .coder = coder, .attributes = attributes, .owner = owner, .plant = ECO_NONE,
		.grid_origin = { -5, -5, 0 }, .grid_step = { 0.01, 0.01, 0.01 }, .unit_area = 0.01f, .image = ECO_NONE,
		.partner = ECO_NONE, .palette_count = attributes & ECO_ATTR_COLOR ? 4 : 0 };
}

/* `count` elements of so many corners, spread over a small grid without a random source; `extra` values are small. */
static inline struct eco_elements scene_pack_elements(uint32_t count, uint8_t corners, uint32_t extra_count, int uv)
{
	struct eco_elements e = { .element_count = count, .corner_count = count * corners,
		.primitive_count = corners < 3 ? count : count * (corners - 2u), .extra_count = extra_count };

	e.corners = malloc(count);
	e.position = malloc((size_t)count * corners * 12);
	e.uv = uv ? malloc((size_t)count * corners * 8) : NULL;
	e.extra = extra_count > 0 ? malloc((size_t)count * extra_count * 4) : NULL;
	memset(e.corners, corners, count);
	for (uint32_t i = 0; i < count * corners; i++) {
		static const int8_t square[4][3] = { { 0, 0, 0 }, { 20, 0, 1 }, { 20, 15, 5 }, { 0, 15, 4 } };
		uint32_t element = i / corners;

		for (int axis = 0; axis < 3; axis++)
			e.position[3 * i + axis] = (int32_t)(element * (37 + 50 * axis) % 1000) + square[i % corners % 4][axis];
		if (uv) {
			e.uv[2 * i] = square[i % corners % 4][0] * 100;
			e.uv[2 * i + 1] = square[i % corners % 4][1] * 100;
		}
	}
	for (uint32_t i = 0; i < count * extra_count; i++)
		e.extra[i] = (int32_t)(i % 3);
	return e;
}

static inline enum eco_code scene_pack_add(struct eco_pack_writer *w, struct eco_list list, struct eco_elements e,
	const struct eco_elements *partner, uint32_t *id, struct eco_error *error)
{
	uint32_t counted = partner != NULL ? partner->element_count : e.element_count;
	const uint32_t ends[2] = { counted / 4 + 1, counted };
	enum eco_code code = eco_pack_add_list(w, &list, &e, counted == 1 ? ends + 1 : ends, counted == 1 ? 1 : 2, partner, id, error);

	eco_elements_free(&e);
	return code;
}

/* Lists of the plant, ids 0 to 5: image, leaves, a point for each, wood, its lines, leaves of the cell. */
static inline enum eco_code scene_pack_plant(struct scene_pack *p, struct eco_pack_writer *w, struct eco_error *error)
{
	struct eco_elements quads = scene_pack_elements(SCENE_PACK_QUADS, 4, 2, 1);
	struct eco_list list = scene_pack_list(ECO_LIST_IMAGE, ECO_CODER_BYTES, 0, 0);
	uint32_t id[6] = { 0 };
	enum eco_code code = eco_pack_add_bytes(w, &list, "not really a PNG", 16, &id[0], error);

	list = scene_pack_list(ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, ECO_ATTR_COLOR | ECO_ATTR_UV | ECO_ATTR_GROWTH, 0);
	list.image = id[0];
	if (code == ECO_OK)
		code = scene_pack_add(w, list, scene_pack_elements(SCENE_PACK_QUADS, 4, 2, 1), NULL, &id[1], error);
	list = scene_pack_list(ECO_LIST_POINTS, ECO_CODER_FORM, ECO_ATTR_COLOR | ECO_ATTR_SIZE, 0);
	list.partner = id[1];
	if (code == ECO_OK)
		code = scene_pack_add(w, list, scene_pack_elements(SCENE_PACK_QUADS, 1, 2, 0), &quads, &id[2], error);
	list = scene_pack_list(ECO_LIST_TRIANGLES, ECO_CODER_MESH, ECO_ATTR_COLOR, 0);
	if (code == ECO_OK)
		code = scene_pack_add(w, list, scene_pack_elements(30, 3, 1, 0), NULL, &id[3], error);
	list = scene_pack_list(ECO_LIST_LINES, ECO_CODER_ELEMENTS, ECO_ATTR_WIDTH, 0);
	if (code == ECO_OK)
		code = scene_pack_add(w, list, scene_pack_elements(12, 2, 1, 0), NULL, &id[4], error);
	list = scene_pack_list(ECO_LIST_TRIANGLES, ECO_CODER_ELEMENTS, 0, 0);
	if (code == ECO_OK)
		code = scene_pack_add(w, list, scene_pack_elements(20, 4, 0, 0), NULL, &id[5], error);
	eco_elements_free(&quads);
	p->plant = (struct eco_plant){ .name = "oak", .height_m = 10, .anchor_count = 2, .ladder_count = 4, .area = 5, .triangles = 150 };
	p->anchors[0] = (struct eco_anchor){ { 0, 0, 5 }, 6 };
	p->anchors[1] = (struct eco_anchor){ { 0, 0, 8 }, 2 };
	for (int i = 0; i < 4; i++)
		p->ladders[i] = (struct eco_ladder){ .points = ECO_NONE, .lines = ECO_NONE, .simple = ECO_NONE, .triangles = ECO_NONE, .importance = 1,
			.total = 1, .area = 1, .length = 1 };
	p->ladders[0].organ = p->ladders[1].organ = ECO_ORGAN_FOLIAGE;
	p->ladders[0].points = id[2];
	p->ladders[0].triangles = id[1];
	p->ladders[0].simple = SCENE_PACK_SIMPLE;
	p->ladders[0].total = SCENE_PACK_QUADS;
	p->ladders[0].curve_count = 3;
	p->ladders[1].triangles = id[3];
	p->ladders[1].lines = id[4];
	p->ladders[1].organ = ECO_ORGAN_WOOD;
	p->ladders[1].level_count = 2;
	p->ladders[1].level_end[0] = 8;
	p->ladders[1].level_end[1] = 30;
	p->ladders[2].flags = ECO_LADDER_FAR;
	p->ladders[2].lines = id[4];
	p->ladders[3].flags = ECO_LADDER_NEAR;
	p->ladders[3].anchor = 1;
	p->ladders[3].triangles = id[5];
	p->curves[0] = (struct eco_curve){ 0.1f, 2, 0.1f, 0.5f, 0.5f };
	p->curves[1] = (struct eco_curve){ 0.3f, 1.5f, 0.3f, 0.2f, 0.3f };
	p->curves[2] = (struct eco_curve){ 1, 1, 1, 0, 0 };
	return code;
}

/* Two tiles of 70 x 20 samples and what stands for both, ids 6 to 8. */
static inline enum eco_code scene_pack_ground(struct scene_pack *p, struct eco_pack_writer *w, struct eco_error *error)
{
	enum eco_code code = ECO_OK;

	for (uint32_t i = 0; i < SCENE_PACK_GROUND && code == ECO_OK; i++) {
		struct eco_list list = scene_pack_list(ECO_LIST_GROUND, ECO_CODER_ROWS, 0, ECO_NONE);
		struct eco_ground_tile *t = &p->ground[i];
		struct eco_ground_span x, y;
		struct eco_elements e;
		uint32_t end;

		*t = (struct eco_ground_tile){ .level = i == 0, .column = i == 2, .child_count = i == 0 ? 2 : 0, .child_first = i == 0,
			.error_m = i == 0 ? 0.25f : 0, .low_m = 0, .high_m = 0.5f };
		eco_ground_spans(&x, &y, t, 70, 20);
		list.level = t->level;
		list.columns = x.count;
		end = x.count * y.count;
		e = scene_pack_elements(end, 1, 0, 0);
		for (uint32_t k = 0; k < end; k++) {
			int32_t column = (int32_t)eco_ground_span_at(&x, k % x.count), row = (int32_t)eco_ground_span_at(&y, k / x.count);

			e.position[3 * k] = column;
			e.position[3 * k + 1] = row;
			e.position[3 * k + 2] = column * row % 20;
		}
		code = eco_pack_add_list(w, &list, &e, &end, 1, NULL, &t->list, error);
		eco_elements_free(&e);
	}
	return code;
}

/* The leaves as one triangle each, id 11: forms need not follow what they are forms of. */
static inline enum eco_code scene_pack_simple(struct eco_pack_writer *w, struct eco_error *error)
{
	struct eco_list list = scene_pack_list(ECO_LIST_TRIANGLES, ECO_CODER_FORM, ECO_ATTR_COLOR, 0);
	struct eco_elements quads = scene_pack_elements(SCENE_PACK_QUADS, 4, 2, 1);
	uint32_t id;
	enum eco_code code;

	list.partner = 1;
	code = scene_pack_add(w, list, scene_pack_elements(SCENE_PACK_QUADS, 3, 1, 0), &quads, &id, error);
	eco_elements_free(&quads);
	return code;
}

/* Ground, summary and instances, ids 6 to 10, and two tiles: the root and a nested eco file. */
static inline enum eco_code scene_pack_tiles(struct scene_pack *p, struct eco_pack_writer *w, struct eco_error *error)
{
	struct eco_elements e = scene_pack_elements(SCENE_PACK_PLANTS, 1, 2, 0);
	struct eco_list list;
	uint32_t summary, instances;
	enum eco_code code;

	code = scene_pack_ground(p, w, error);
	if (code == ECO_OK)
		code = scene_pack_add(w, scene_pack_list(ECO_LIST_POINTS, ECO_CODER_KD, ECO_ATTR_COLOR | ECO_ATTR_PLANT, 1),
			scene_pack_elements(50, 1, 3, 0), NULL, &summary, error);
	for (uint32_t i = 0; i < SCENE_PACK_PLANTS; i++) {
		struct eco_place place;

		e.extra[2 * i] = (int32_t)(9000 * i);
		e.extra[2 * i + 1] = (int32_t)(60000 + 1000 * i);
		place = eco_place_of(&e, i);
		eco_place_write(&p->places, &place);
	}
	list = scene_pack_list(ECO_LIST_INSTANCES, ECO_CODER_ROWS, ECO_ATTR_PLACE, 1);
	list.plant = 0;
	if (code == ECO_OK)
		code = scene_pack_add(w, list, e, NULL, &instances, error);
	else
		eco_elements_free(&e);
	if (code != ECO_OK)
		return code;
	p->tiles[0] = (struct eco_tile){ { -10, -10, 0 }, { 10, 10, 12 }, 70, 2 * SCENE_PACK_PLANTS, ECO_NONE, 0, 0, 0, 2 };
	p->tiles[1] = (struct eco_tile){ { -5, -5, 0 }, { 5, 5, 12 }, 35, SCENE_PACK_PLANTS, summary, 0, 1, 2, 0 };
	p->group = (struct eco_group){ 1, 0, instances, 0 };
	return ECO_OK;
}

/* Writes the pack; with `keep` not NULL leaves the writer there instead of committing. Free with scene_pack_free. */
static inline enum eco_code scene_pack_write(struct scene_pack *p, const char *path, struct eco_pack_writer **keep,
	struct eco_error *error)
{
	static const uint8_t colors[4][3] = { { 10, 90, 20 }, { 20, 120, 30 }, { 90, 60, 30 }, { 255, 255, 0 } };
	static struct eco_child children[2];
	struct eco_pack_writer *w;
	enum eco_code code;

	memset(p, 0, sizeof *p);
	code = eco_pack_create(&w, path, error);
	if (code != ECO_OK)
		return code;
	code = scene_pack_plant(p, w, error);
	if (code == ECO_OK)
		code = scene_pack_tiles(p, w, error);
	if (code == ECO_OK)
		code = scene_pack_simple(w, error);
	if (code != ECO_OK) {
		eco_pack_abort(w);
		return code;
	}
	children[0] = (struct eco_child){ .tile = 1, .scale = 1 };
	children[1] = (struct eco_child){ .tile = 1, .placed = true, .at = { 3, 4, 5 }, .turn = 16384, .scale = 1.5f };
	memcpy(p->palette, colors, sizeof colors);
	p->scene = (struct eco_scene){ .name = "small", .needs = 511, .ground = p->ground, .ground_count = SCENE_PACK_GROUND,
		.ground_columns = 70, .ground_rows = 20, .near_m = 0.1, .plants = &p->plant, .plant_count = 1,
		.anchors = p->anchors, .anchor_count = 2, .ladders = p->ladders, .ladder_count = 4, .curves = p->curves, .curve_count = 3,
		.tiles = p->tiles, .tile_count = 2, .groups = &p->group, .group_count = 1, .children = children, .child_count = 2,
		.palette = p->palette, .palette_count = 4, .places = p->places.bytes, .place_count = SCENE_PACK_PLANTS };
	if (keep != NULL) {
		*keep = w;
		return ECO_OK;
	}
	return eco_pack_commit(w, &p->scene, "{\"name\": \"small\"}", error);
}

static inline void scene_pack_free(struct scene_pack *p)
{
	eco_writer_free(&p->places);
}

#endif
